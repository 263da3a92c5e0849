//! Fewer triangles: edges are collapsed, each time the one that changes the surface the least.
//!
//! Errors are quadrics (Garland and Heckbert 1997): sums of squared distances to the planes of the triangles that were there. Edges
//! of the surface, and edges between groups, have planes of their own that stand upright on them, so that they stay.

use std::{
    cmp::Ordering,
    collections::{BTreeMap, BinaryHeap},
};

use glam::Vec3;

use crate::weld::{Welded, weld};

/// How much more edges of the surface count than its inside.
const EDGE_WEIGHT: f64 = 8.0;
/// A triangle that turns by more than what this is the cosine of has flipped.
const FLIPPED: f32 = 0.2;
/// Of a triangle, at least: four roots of three times its area by the sum of its squared sides, which is 1 where all are alike.
const LEAST_QUALITY: f32 = 0.02;

/// A point of more triangles stays until it has fewer: what moves it looks at all of them.
const MOST_AROUND: u32 = 128;
/// Candidates that are out of date are thrown away once there are so many to each triangle that is left.
const CANDIDATES: usize = 12;

/// The squared distance of a point to planes, summed up, as the upper half of a symmetric matrix.
#[derive(Clone, Copy, Debug, Default)]
struct Quadric([f64; 10]);

impl Quadric {
    /// Of the plane through a point.
    fn plane(normal: Vec3, through: Vec3, weight: f64) -> Self {
        let [a, b, c] = normal.to_array().map(f64::from);
        let [x, y, z] = through.to_array().map(f64::from);
        let d = -(a * x + b * y + c * z);
        Self([a * a, a * b, a * c, a * d, b * b, b * c, b * d, c * c, c * d, d * d].map(|value| value * weight))
    }

    fn add(&mut self, other: &Self) {
        for (own, other) in self.0.iter_mut().zip(other.0) {
            *own += other;
        }
    }

    fn error(&self, point: Vec3) -> f64 {
        let [x, y, z] = point.to_array().map(f64::from);
        let [aa, ab, ac, ad, bb, bc, bd, cc, cd, dd] = self.0;
        let squares = aa * x * x + bb * y * y + cc * z * z + dd;
        (squares + 2.0 * (ab * x * y + ac * x * z + bc * y * z + ad * x + bd * y + cd * z)).max(0.0)
    }

    /// The point with the least error, where there is one.
    fn least(&self) -> Option<Vec3> {
        let [aa, ab, ac, ad, bb, bc, bd, cc, cd, _] = self.0;
        let (first, second, third) = (bb * cc - bc * bc, bc * ac - ab * cc, ab * bc - bb * ac);
        let determinant = aa * first + ab * second + ac * third;
        let scale = (aa + bb + cc) / 3.0;
        if determinant.abs() <= 1e-4 * scale * scale * scale {
            return None;
        }
        let x = first * ad + second * bd + third * cd;
        let y = second * ad + (aa * cc - ac * ac) * bd + (ab * ac - aa * bc) * cd;
        let z = third * ad + (ab * ac - aa * bc) * bd + (aa * bb - ab * ab) * cd;
        Some(Vec3::from_array([x, y, z].map(|value| (-value / determinant) as f32)))
    }
}

/// An edge that may go, and where its points would go.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    error: f64,
    points: [u32; 2],
    /// How often each of them had changed.
    versions: [u32; 2],
    target: Vec3,
}

impl Ord for Candidate {
    /// The least error is the greatest candidate.
    fn cmp(&self, other: &Self) -> Ordering {
        other.error.total_cmp(&self.error).then_with(|| other.points.cmp(&self.points))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Candidate {}

struct Reducing {
    points: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    is_left: Vec<bool>,
    quadrics: Vec<Quadric>,
    /// The triangles of each point, some of which may be gone.
    around: Vec<Vec<u32>>,
    /// How many triangles of each point are left.
    counts: Vec<u32>,
    versions: Vec<u32>,
    heap: BinaryHeap<Candidate>,
    left: usize,
}

/// The same surface with at most so many triangles, or with as few as it takes to keep it whole.
pub(crate) fn reduce(mesh: &Welded, most: usize) -> Welded {
    if mesh.triangles.len() <= most {
        return mesh.clone();
    }
    let mut reducing = Reducing::new(mesh);
    while reducing.left > most {
        let Some(candidate) = reducing.heap.pop() else { break };
        reducing.collapse(&candidate);
    }
    let left = (0..mesh.triangles.len()).filter(|triangle| reducing.is_left[*triangle]);
    let corners = |triangle: usize| reducing.triangles[triangle].map(|corner| reducing.points[corner as usize]);
    weld(left.map(|triangle| (corners(triangle), mesh.groups[triangle])), f32::EPSILON)
}

impl Reducing {
    fn new(mesh: &Welded) -> Self {
        let count = mesh.points.len();
        let mut own = Self {
            points: mesh.points.clone(),
            triangles: mesh.triangles.clone(),
            is_left: vec![true; mesh.triangles.len()],
            quadrics: vec![Quadric::default(); count],
            around: vec![Vec::new(); count],
            counts: vec![0; count],
            versions: vec![0; count],
            heap: BinaryHeap::new(),
            left: mesh.triangles.len(),
        };
        // Of each edge: its triangles, and whether they are of one group.
        let mut edges: BTreeMap<[u32; 2], (u32, u32, bool)> = BTreeMap::new();
        for (triangle, corners) in mesh.triangles.iter().enumerate() {
            let [a, b, c] = mesh.corners(triangle);
            let normal = (b - a).cross(c - a);
            let plane = Quadric::plane(normal.normalize_or_zero(), a, f64::from(normal.length()));
            for corner in corners {
                own.quadrics[*corner as usize].add(&plane);
                own.around[*corner as usize].push(triangle as u32);
                own.counts[*corner as usize] += 1;
            }
            for edge in sides(*corners) {
                let (first, count, alike) = edges.entry(edge).or_insert((triangle as u32, 0, true));
                *count += 1;
                *alike &= mesh.groups[*first as usize] == mesh.groups[triangle];
            }
        }
        for (edge, (triangle, count, alike)) in &edges {
            if *count == 1 || !alike {
                let [a, b, c] = mesh.corners(*triangle as usize);
                let normal = (b - a).cross(c - a).normalize_or_zero();
                let [from, to] = edge.map(|point| mesh.points[point as usize]);
                let upright = (to - from).cross(normal).normalize_or_zero();
                let weight = EDGE_WEIGHT * f64::from((to - from).length_squared());
                let plane = Quadric::plane(upright, from, weight);
                edge.iter().for_each(|point| own.quadrics[*point as usize].add(&plane));
            }
        }
        for edge in edges.keys() {
            own.consider(*edge);
        }
        own
    }

    /// Puts an edge among those that may go.
    fn consider(&mut self, points: [u32; 2]) {
        let [a, b] = points.map(|point| point as usize);
        if self.counts[a].max(self.counts[b]) > MOST_AROUND {
            return;
        }
        [a, b].into_iter().for_each(|point| self.tidy(point));
        let mut quadric = self.quadrics[a];
        quadric.add(&self.quadrics[b]);
        let (from, to) = (self.points[a], self.points[b]);
        let near = |point: &Vec3| point.distance_squared((from + to) / 2.0) <= from.distance_squared(to);
        let places = [quadric.least().filter(near), Some((from + to) / 2.0), Some(from), Some(to)];
        let errors = places.into_iter().flatten().map(|place| (quadric.error(place), place));
        if let Some((error, target)) = errors.min_by(|one, other| one.0.total_cmp(&other.0)) {
            // Where nothing changes, short edges go first.
            let error = error + 1e-9 * f64::from(from.distance_squared(to)) * f64::from(from.distance_squared(to));
            let versions = [self.versions[a], self.versions[b]];
            self.heap.push(Candidate { error, points, versions, target });
        }
    }

    /// Forgets triangles of a point that are gone, once they are many.
    fn tidy(&mut self, point: usize) {
        if self.around[point].len() > 2 * self.counts[point] as usize + 8 {
            let is_left = &self.is_left;
            self.around[point].retain(|triangle| is_left[*triangle as usize]);
        }
    }

    fn is_current(versions: &[u32], candidate: &Candidate) -> bool {
        candidate.points.map(|point| versions[point as usize]) == candidate.versions
    }

    /// The triangles of a point that are left.
    fn triangles_of(&self, point: u32) -> impl Iterator<Item = u32> + '_ {
        self.around[point as usize].iter().copied().filter(|triangle| self.is_left[*triangle as usize])
    }

    fn collapse(&mut self, candidate: &Candidate) {
        let [kept, gone] = candidate.points;
        if !Self::is_current(&self.versions, candidate) {
            return;
        }
        if !self.may_go(candidate.points, candidate.target) {
            // The best place may lie beyond a neighbour where the middle does not: that is for later, by its own error.
            let target = (self.points[kept as usize] + self.points[gone as usize]) / 2.0;
            let error = self.quadrics[kept as usize].error(target) + self.quadrics[gone as usize].error(target);
            if candidate.target != target {
                self.heap.push(Candidate { error, target, ..*candidate });
            }
            return;
        }
        let quadric = self.quadrics[gone as usize];
        self.quadrics[kept as usize].add(&quadric);
        self.points[kept as usize] = candidate.target;
        for triangle in std::mem::take(&mut self.around[gone as usize]) {
            let at = triangle as usize;
            if !self.is_left[at] {
                continue;
            }
            if self.triangles[at].contains(&kept) {
                self.is_left[at] = false;
                self.left -= 1;
                for corner in self.triangles[at] {
                    self.counts[corner as usize] -= 1;
                }
            } else {
                self.triangles[at] = self.triangles[at].map(|corner| if corner == gone { kept } else { corner });
                self.around[kept as usize].push(triangle);
                self.counts[kept as usize] += 1;
            }
        }
        let is_left = &self.is_left;
        self.around[kept as usize].retain(|triangle| is_left[*triangle as usize]);
        self.versions[gone as usize] += 1;
        self.versions[kept as usize] += 1;
        for neighbour in self.neighbours(kept) {
            self.consider([kept.min(neighbour), kept.max(neighbour)]);
        }
        if self.heap.len() > CANDIDATES * self.left + 1024 {
            let versions = &self.versions;
            self.heap.retain(|candidate| Self::is_current(versions, candidate));
        }
    }

    /// The points that share an edge with a point, in order.
    fn neighbours(&self, point: u32) -> Vec<u32> {
        let corners = self.triangles_of(point).flat_map(|triangle| self.triangles[triangle as usize]);
        let mut all: Vec<u32> = corners.filter(|corner| *corner != point).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Whether the surface stays whole, and none of its triangles flips or becomes a needle.
    fn may_go(&self, [kept, gone]: [u32; 2], target: Vec3) -> bool {
        let shared =
            self.triangles_of(gone).filter(|triangle| self.triangles[*triangle as usize].contains(&kept)).count();
        let others = self.neighbours(gone);
        let common = self.neighbours(kept).iter().filter(|point| others.binary_search(point).is_ok()).count();
        // More neighbours in common than triangles: two sheets would become one.
        if shared == 0 || common > shared {
            return false;
        }
        [kept, gone].into_iter().all(|point| {
            let other = if point == kept { gone } else { kept };
            let mut own = self.triangles_of(point).map(|triangle| self.triangles[triangle as usize]);
            own.all(|triangle| triangle.contains(&other) || self.stays(triangle, point, target))
        })
    }

    fn stays(&self, triangle: [u32; 3], moved: u32, target: Vec3) -> bool {
        let before = triangle.map(|corner| self.points[corner as usize]);
        let after = triangle.map(|corner| if corner == moved { target } else { self.points[corner as usize] });
        let normal = |[a, b, c]: [Vec3; 3]| (b - a).cross(c - a);
        let (was, is) = (normal(before), normal(after));
        let turned = was.normalize_or_zero().dot(is.normalize_or_zero());
        turned > FLIPPED && quality(after) > LEAST_QUALITY.min(quality(before))
    }
}

/// How far a triangle is from a needle: 1 where all its sides are alike.
fn quality([a, b, c]: [Vec3; 3]) -> f32 {
    let sides = a.distance_squared(b) + b.distance_squared(c) + c.distance_squared(a);
    2.0 * 3.0_f32.sqrt() * (b - a).cross(c - a).length() / sides.max(f32::MIN_POSITIVE)
}

fn sides([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [(a, b), (b, c), (c, a)].map(|(one, other)| [one.min(other), one.max(other)])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square sheet of many small squares; the left half is of another group, and `height` bends it.
    fn sheet(side: u16, height: impl Fn(f32, f32) -> f32) -> Welded {
        let at = |x: u16, y: u16| {
            let [x, y] = [x, y].map(|place| f32::from(place) / f32::from(side));
            Vec3::new(x, y, height(x, y))
        };
        let squares = (0..side).flat_map(|x| (0..side).map(move |y| (x, y)));
        let faces = squares.flat_map(|(x, y)| {
            let group = usize::from(2 * x >= side);
            let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
            [([a, b, c], group), ([a, c, d], group)]
        });
        weld(faces.collect::<Vec<_>>().into_iter(), 1e-5)
    }

    fn area(mesh: &Welded, group: usize) -> f32 {
        (0..mesh.triangles.len()).filter(|at| mesh.groups[*at] == group).map(|at| mesh.area(at)).sum()
    }

    #[test]
    fn a_flat_sheet_keeps_its_outline_and_its_groups() {
        let flat = sheet(20, |_, _| 0.0);
        let few = reduce(&flat, 16);
        assert!(few.triangles.len() <= 16, "{}", few.triangles.len());
        for group in [0, 1] {
            assert!((area(&few, group) - 0.5).abs() < 1e-3, "{}", area(&few, group));
        }
        assert_eq!(reduce(&flat, 16), few);
        assert_eq!(reduce(&flat, 800), flat);
    }

    #[test]
    fn a_ball_stays_round_and_closed() {
        let corner = |u: usize, v: usize| {
            let is_pole = v.is_multiple_of(20);
            let (u, v) = (std::f32::consts::TAU * (u % 40) as f32 / 40.0, std::f32::consts::PI * v as f32 / 20.0);
            let ring = if is_pole { 0.0 } else { libm::sinf(v) };
            Vec3::new(ring * libm::cosf(u), ring * libm::sinf(u), libm::cosf(v))
        };
        let squares = (0..40).flat_map(|u| (0..20).map(move |v| (u, v)));
        let faces = squares.flat_map(|(u, v)| {
            let [a, b, c, d] = [corner(u, v), corner(u, v + 1), corner(u + 1, v + 1), corner(u + 1, v)];
            [([a, b, c], 0), ([a, c, d], 0)]
        });
        let ball = weld(faces.collect::<Vec<_>>().into_iter(), 1e-5);
        let full = 4.0 / 3.0 * std::f32::consts::PI;
        assert!((ball.volume() - full).abs() < 0.1, "{}", ball.volume());
        for most in [600, 200, 80] {
            let few = reduce(&ball, most);
            assert!(few.triangles.len() <= most && few.triangles.len() + 4 > most, "{}", few.triangles.len());
            assert!((few.volume() - full).abs() < 0.6, "{most}: {}", few.volume());
            let with_backs = few.with_backs(|_| true);
            assert_eq!(with_backs.triangles.len(), few.triangles.len(), "it is not closed any more");
        }
    }

    #[test]
    fn a_point_of_many_triangles_takes_no_longer_than_others() {
        let rim = |step: u32| {
            let angle = std::f32::consts::TAU * step as f32 / 100_000.0;
            Vec3::new(100.0 * libm::cosf(angle), 100.0 * libm::sinf(angle), 0.0)
        };
        let fan = weld((0..100_000).map(|step| ([Vec3::ZERO, rim(step), rim(step + 1)], 0)), 1e-5);
        let few = reduce(&fan, 64);
        assert!(few.triangles.len() <= 64, "{}", few.triangles.len());
        assert!((area(&few, 0) / 31_415.9 - 1.0).abs() < 0.01, "{}", area(&few, 0));
    }

    #[test]
    fn what_is_bent_keeps_more_than_what_is_flat() {
        let bent = sheet(24, |x, _| if x > 0.5 { 0.1 * libm::sinf(40.0 * x) } else { 0.0 });
        let few = reduce(&bent, 300);
        let right = few.groups.iter().filter(|group| **group == 1).count();
        assert!(
            few.triangles.len() <= 300 && right * 10 > few.triangles.len() * 7,
            "{right} of {}",
            few.triangles.len()
        );
    }
}
