//! Triangles that share their points.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use glam::Vec3;

/// Points, and triangles of them, each of a group: those of a group look alike.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Welded {
    pub points: Vec<Vec3>,
    /// Counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// By triangle.
    pub groups: Vec<usize>,
}

/// Makes one point of those that round to the same multiples of `step`; leaves out what then has no area, or is there twice.
pub(crate) fn weld(faces: impl Iterator<Item = ([Vec3; 3], usize)>, step: f32) -> Welded {
    let mut welded = Welded::default();
    let mut known: HashMap<[i64; 3], u32> = HashMap::new();
    let mut seen: BTreeSet<[u32; 3]> = BTreeSet::new();
    for (corners, group) in faces {
        let indices = corners.map(|corner| {
            let key = (corner / step).round().to_array().map(|coordinate| coordinate as i64);
            *known.entry(key).or_insert_with(|| {
                welded.points.push(corner);
                welded.points.len() as u32 - 1
            })
        });
        let [a, b, c] = indices.map(|index| welded.points[index as usize]);
        let has_area = (b - a).cross(c - a).length_squared() > 0.0;
        if has_area && seen.insert(first_least(indices)) {
            welded.triangles.push(indices);
            welded.groups.push(group);
        }
    }
    welded
}

/// The same triangle with its least corner first.
fn first_least([a, b, c]: [u32; 3]) -> [u32; 3] {
    match a.min(b).min(c) {
        least if least == a => [a, b, c],
        least if least == b => [b, c, a],
        _ => [c, a, b],
    }
}

impl Welded {
    /// The corners of a triangle.
    pub(crate) fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|corner| self.points[corner as usize])
    }

    /// All triangles with their groups.
    pub(crate) fn faces(&self) -> impl Iterator<Item = ([Vec3; 3], usize)> + '_ {
        (0..self.triangles.len()).map(|triangle| (self.corners(triangle), self.groups[triangle]))
    }

    /// The area of a triangle.
    pub(crate) fn area(&self, triangle: usize) -> f32 {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(c - a).length() / 2.0
    }

    /// How much room lies within; less than that where the surface has holes.
    pub(crate) fn volume(&self) -> f32 {
        let middle = self.points.iter().copied().sum::<Vec3>() / self.points.len().max(1) as f32;
        let of = |[a, b, c]: [Vec3; 3]| (a - middle).dot((b - middle).cross(c - middle)) / 6.0;
        (0..self.triangles.len()).map(|triangle| of(self.corners(triangle))).sum::<f32>().abs()
    }

    /// The same with the backs of those triangles whose group shows them, where one can look behind the surface.
    pub(crate) fn with_backs(&self, is_two_sided: impl Fn(usize) -> bool) -> Self {
        let open = self.open();
        let backs =
            (0..self.triangles.len()).filter(|triangle| open[*triangle] && is_two_sided(self.groups[*triangle]));
        let mut all = self.clone();
        for triangle in backs {
            let [a, b, c] = self.triangles[triangle];
            all.triangles.push([a, c, b]);
            all.groups.push(self.groups[triangle]);
        }
        all
    }

    /// Whether each triangle is of a surface with an edge.
    fn open(&self) -> Vec<bool> {
        let mut joined: Vec<u32> = (0..self.points.len() as u32).collect();
        let mut edges: BTreeMap<[u32; 2], u32> = BTreeMap::new();
        for [a, b, c] in &self.triangles {
            for (one, other) in [(*a, *b), (*b, *c), (*c, *a)] {
                *edges.entry([one.min(other), one.max(other)]).or_insert(0) += 1;
                let (one, other) = (root(&mut joined, one), root(&mut joined, other));
                joined[one.max(other) as usize] = one.min(other);
            }
        }
        let mut open = vec![false; self.points.len()];
        for ([one, _], _) in edges.into_iter().filter(|(_, count)| *count == 1) {
            open[root(&mut joined, one) as usize] = true;
        }
        self.triangles.iter().map(|[a, ..]| open[root(&mut joined, *a) as usize]).collect()
    }
}

fn root(joined: &mut [u32], mut point: u32) -> u32 {
    while joined[point as usize] != point {
        let above = joined[joined[point as usize] as usize];
        joined[point as usize] = above;
        point = above;
    }
    point
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f32, y: f32) -> Vec3 {
        Vec3::new(x, y, 0.0)
    }

    #[test]
    fn points_become_one_and_what_has_no_area_goes() {
        let faces = [
            [at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0)],
            [at(1.000_001, 0.0), at(1.0, 1.0), at(0.0, 1.0)],
            [at(0.0, 0.0), at(0.0, 0.0), at(1.0, 0.0)],
            [at(0.0, 0.0), at(0.5, 0.0), at(1.0, 0.0)],
            [at(0.0, 1.0), at(0.0, 0.0), at(1.0, 0.0)],
        ];
        let welded = weld(faces.into_iter().zip([7, 8, 7, 7, 7]), 1e-4);
        assert_eq!((welded.points.len(), &welded.triangles[..]), (5, &[[0, 1, 2], [1, 3, 2]][..]));
        assert_eq!((&welded.groups[..], welded.area(0)), (&[7, 8][..], 0.5));
    }

    #[test]
    fn backs_are_added_where_a_surface_is_open() {
        let [a, b, c] = [at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0)];
        let d = Vec3::Z;
        let closed = [[a, c, b], [a, b, d], [b, c, d], [c, a, d]].map(|face| (face, 0));
        let sheet = [a, b, c].map(|corner| corner + 5.0);
        let all = weld(closed.into_iter().chain([(sheet, 0), (sheet.map(|corner| corner + 5.0), 1)]), 1e-4);
        let with_backs = all.with_backs(|group| group == 0);
        assert_eq!((all.triangles.len(), with_backs.triangles.len()), (6, 7));
        assert_eq!(with_backs.triangles[6], [4, 6, 5]);
        let solid = weld(closed.into_iter(), 1e-4);
        assert!((solid.volume() - 1.0 / 6.0).abs() < 1e-6);
    }
}
