//! Meshes: points and triangles as they are given, with fewer of them where nobody looks closely.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use glam::Vec3;

use super::{Detail, Precision, Solid};

/// Triangles that meet at less than this look round, unless the mesh says otherwise, degrees.
const SMOOTH_DEG: f32 = 40.0;
/// The side of a cell within which points become one, in tolerances: their mean lies much nearer to a smooth surface than that.
const CELL: f32 = 3.0;
/// Normals that differ by less than one part of so many are one.
const NORMAL_STEPS: f32 = 1024.0;
/// What is added for rounding where the cosines of two angles are compared.
const ROUNDING: f32 = 1e-5;

/// The triangles with normals. They are sound: see [`cohabit_cdf::model::check_mesh`].
pub(super) fn build(
    points: &[[f32; 3]],
    triangles: &[[u32; 3]],
    smooth_deg: Option<f32>,
    precision: &Precision,
) -> Solid {
    let points: Vec<Vec3> = points.iter().copied().map(Vec3::from_array).collect();
    let least = libm::cosf(smooth_deg.unwrap_or(SMOOTH_DEG).to_radians());
    match precision.detail {
        Detail::Fine => with_normals(&points, triangles, least),
        Detail::Medium | Detail::Coarse => {
            let (points, triangles) = gather(&points, triangles, CELL * precision.tolerance_m);
            with_normals(&points, &triangles, least)
        }
    }
}

/// Makes one point of all that lie in the same cell of a grid, and leaves out the triangles that then have no area.
fn gather(points: &[Vec3], triangles: &[[u32; 3]], cell_m: f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let borders = borders(points.len(), triangles);
    let mut cells: BTreeMap<[i32; 3], u32> = BTreeMap::new();
    let (mut sums, mut merged_of) = (Vec::new(), Vec::with_capacity(points.len()));
    for (point, is_border) in points.iter().zip(borders) {
        let cell = (*point / cell_m).floor();
        let merged = *cells.entry(whole(cell)).or_insert(sums.len() as u32);
        if merged as usize == sums.len() {
            sums.push((Vec3::ZERO, 0_u32, None));
        }
        let (sum, count, fixed) = &mut sums[merged as usize];
        *sum += *point;
        *count += 1;
        // Where parts of a model meet, each moves its points to the same place, so that no gap opens.
        if is_border {
            *fixed = Some((cell + 0.5) * cell_m);
        }
        merged_of.push(merged);
    }
    let points = sums.into_iter().map(|(sum, count, fixed)| fixed.unwrap_or(sum / count as f32)).collect();
    let mut known = BTreeSet::new();
    let merged = triangles.iter().map(|triangle| triangle.map(|corner| merged_of[corner as usize]));
    let kept = merged.filter(|[a, b, c]| a != b && b != c && c != a).filter(|triangle| known.insert(turned(*triangle)));
    (points, kept.collect())
}

fn whole(vector: Vec3) -> [i32; 3] {
    vector.to_array().map(|value| value as i32)
}

/// The same triangle with its least corner first.
fn turned([a, b, c]: [u32; 3]) -> [u32; 3] {
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

/// Whether each point lies at an edge of one triangle alone.
fn borders(points: usize, triangles: &[[u32; 3]]) -> Vec<bool> {
    let mut edges: HashMap<[u32; 2], u32> = HashMap::with_capacity(2 * triangles.len());
    for [a, b, c] in triangles {
        for (one, other) in [(a, b), (b, c), (c, a)] {
            *edges.entry([*one.min(other), *one.max(other)]).or_insert(0) += 1;
        }
    }
    let mut borders = vec![false; points];
    for (edge, _) in edges.into_iter().filter(|(_, count)| *count == 1) {
        edge.into_iter().for_each(|point| borders[point as usize] = true);
    }
    borders
}

/// Gives each corner the mean normal of the triangles around its point that look nearly the same way.
fn with_normals(points: &[Vec3], triangles: &[[u32; 3]], least: f32) -> Solid {
    // As long as twice the area, so that large triangles count for more.
    let faces: Vec<Vec3> = triangles
        .iter()
        .map(|triangle| {
            let [a, b, c] = triangle.map(|corner| points[corner as usize]);
            (b - a).cross(c - a)
        })
        .collect();
    let mut around: Vec<Vec<usize>> = vec![Vec::new(); points.len()];
    for (face, triangle) in triangles.iter().enumerate() {
        triangle.iter().for_each(|corner| around[*corner as usize].push(face));
    }
    let mut solid = Solid::default();
    let mut known: HashMap<(u32, [i32; 3]), u32> = HashMap::new();
    for (triangle, face) in triangles.iter().zip(&faces) {
        let outward = face.normalize_or_zero();
        if outward == Vec3::ZERO {
            continue;
        }
        let corners = triangle.map(|point| {
            let near = around[point as usize].iter().map(|other| faces[*other]);
            let alike = near.filter(|other| other.normalize_or_zero().dot(outward) >= least - ROUNDING);
            let normal = alike.sum::<Vec3>().normalize_or(outward);
            let key = (point, whole((normal * NORMAL_STEPS).round()));
            *known.entry(key).or_insert_with(|| solid.corner(points[point as usize], normal))
        });
        solid.triangle(corners);
    }
    solid
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    /// A ball of many triangles, with one point at each place.
    fn ball(rows: u32) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
        let columns = 2 * rows;
        let place = |latitude: f32, column: u32| {
            let longitude = core::f32::consts::TAU * column as f32 / columns as f32;
            let (ring, z) = (0.1 * libm::cosf(latitude), 0.1 * libm::sinf(latitude));
            [ring * libm::cosf(longitude), ring * libm::sinf(longitude), z]
        };
        let mut points = vec![[0.0, 0.0, -0.1], [0.0, 0.0, 0.1]];
        for row in 1..rows {
            let latitude = core::f32::consts::PI * (row as f32 / rows as f32 - 0.5);
            points.extend((0..columns).map(|column| place(latitude, column)));
        }
        let at = |row: u32, column: u32| 2 + (row - 1) * columns + column % columns;
        let mut triangles = Vec::new();
        for column in 0..columns {
            triangles.push([0, at(1, column + 1), at(1, column)]);
            triangles.push([1, at(rows - 1, column), at(rows - 1, column + 1)]);
            for row in 1..rows - 1 {
                let [a, b] = [at(row, column), at(row, column + 1)];
                let [c, d] = [at(row + 1, column + 1), at(row + 1, column)];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        (points, triangles)
    }

    fn levels(points: &[[f32; 3]], triangles: &[[u32; 3]], smooth_deg: Option<f32>) -> Vec<Solid> {
        let level = |detail| build(points, triangles, smooth_deg, &Precision::of(detail, 0.1));
        Detail::ALL.into_iter().map(level).collect()
    }

    #[test]
    fn a_ball_is_smooth_and_has_fewer_triangles_from_afar() {
        let (points, triangles) = ball(40);
        let levels = levels(&points, &triangles, None);
        assert_eq!((levels[0].triangles.len(), levels[0].positions.len()), (triangles.len(), points.len()));
        for (position, normal) in levels[0].positions.iter().zip(&levels[0].normals) {
            assert!(position.normalize().dot(*normal) > 0.999, "{position}: {normal}");
        }
        let counts: Vec<usize> = levels.iter().map(|level| level.triangles.len()).collect();
        assert!(counts[1] < counts[0] && 4 * counts[2] < counts[0] && counts[2] > 50, "{counts:?}");
        for position in &levels[2].positions {
            assert!((position.length() - 0.1).abs() < 0.01, "{position}");
        }
    }

    #[test]
    fn edges_are_as_sharp_as_the_angle_says() {
        // Two sides of a roof that meet at a right angle.
        let points = [[0.0, 0.0, 0.1], [0.0, 0.1, 0.1], [-0.1, 0.0, 0.0], [0.1, 0.0, 0.0]];
        let triangles = [[0, 1, 2], [1, 0, 3]];
        let corners = |smooth_deg| levels(&points, &triangles, smooth_deg)[0].positions.len();
        assert_eq!((corners(None), corners(Some(89.0)), corners(Some(91.0))), (6, 6, 4));
    }

    #[test]
    fn no_gap_opens_between_parts_of_a_coarse_model() {
        let strip = |y: f32| {
            let points: Vec<[f32; 3]> =
                (0..40_u16).flat_map(|i| [y, 0.031].map(|y| [f32::from(i) * 0.003, y, 0.002])).collect();
            let triangles: Vec<[u32; 3]> =
                (0..39).map(|i| 2 * i).flat_map(|i| [[i, i + 2, i + 1], [i + 1, i + 2, i + 3]]).collect();
            let coarse = levels(&points, &triangles, None).pop().unwrap();
            let mut shared: Vec<[i32; 3]> = coarse.positions.iter().map(|p| whole((*p * 1e5).round())).collect();
            shared.sort_unstable();
            shared.dedup();
            shared
        };
        let (one, other) = (strip(0.0), strip(0.09));
        let shared = one.iter().filter(|place| other.contains(place)).count();
// At each of eight cells along the line where they meet.
        assert_eq!(shared, 8, "{one:?} {other:?}");
    }

    #[test]
    fn what_has_no_area_is_left_out() {
        let points = [[0.0; 3], [0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.05, 0.0, 0.0]];
        let levels = levels(&points, &[[0, 1, 2], [0, 3, 1], [0, 0, 2]], None);
        assert!(levels.iter().all(|level| level.triangles.len() == 1), "{levels:?}");
    }
}
