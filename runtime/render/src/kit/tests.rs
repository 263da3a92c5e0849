#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;

use proptest::prelude::*;

use super::*;

fn fine() -> Precision {
    Precision::of(Detail::Fine, 0.1)
}

/// For each corner the first that lies at the same place, but for rounding.
fn weld(solid: &Solid) -> Vec<usize> {
    let near = |a: Vec3, b: Vec3| (a - b).abs().max_element() < 1e-5;
    solid.positions.iter().map(|own| solid.positions.iter().position(|first| near(*first, *own)).unwrap()).collect()
}

/// How much oftener each edge between welded corners is walked one way than the other.
fn edges(solid: &Solid) -> BTreeMap<[usize; 2], i32> {
    let welded = weld(solid);
    let mut edges = BTreeMap::new();
    for triangle in &solid.triangles {
        for side in 0..3 {
            let (a, b) = (welded[triangle[side] as usize], welded[triangle[(side + 1) % 3] as usize]);
            if a == b {
                continue;
            }
            let (pair, step) = if a < b { ([a, b], 1) } else { ([b, a], -1) };
            *edges.entry(pair).or_insert(0) += step;
        }
    }
    edges
}

fn volume(solid: &Solid) -> f32 {
    let corner = |index: u32| solid.positions[index as usize];
    solid.triangles.iter().map(|t| corner(t[0]).dot(corner(t[1]).cross(corner(t[2])))).sum::<f32>() / 6.0
}

/// Every edge is walked as often one way as the other, and the surface faces outwards.
fn check_closed(shape: &Shape) {
    for detail in Detail::ALL.into_iter().map(|detail| Precision::of(detail, 0.5)) {
        let solid = build(shape, &detail).unwrap();
        assert!(!solid.triangles.is_empty(), "{shape:?} at {detail:?} is empty");
        let open = edges(&solid).into_iter().filter(|(_, walked)| *walked != 0).count();
        assert_eq!(open, 0, "{shape:?} at {detail:?} has {open} open edges");
        assert!(volume(&solid) > 0.0, "{shape:?} at {detail:?} is inside out");
        for (position, normal) in solid.positions.iter().zip(&solid.normals) {
            assert!(position.is_finite() && (normal.length() - 1.0).abs() < 1e-3, "{shape:?}: {position} {normal}");
        }
    }
}

#[test]
fn shapes_are_closed() {
    let shapes = [
        Shape::Box { size: [1.0, 0.5, 0.2], bevel: None },
        Shape::Box { size: [1.0, 0.5, 0.2], bevel: Some(0.0) },
        Shape::Box { size: [0.6, 0.5, 0.2], bevel: Some(0.09) },
        Shape::Box { size: [2.562_399_9, 1.562_309_3, 2.858_778_7], bevel: Some(0.558_969_6) },
        Shape::Cylinder { radius: 0.1, top_radius: None, height: 0.4, bevel: None },
        Shape::Cylinder { radius: 0.2, top_radius: Some(0.0), height: 0.4, bevel: Some(0.01) },
        Shape::Cylinder { radius: 0.005, top_radius: Some(1.3e-5), height: 1.7, bevel: None },
        Shape::Sphere { radii: [0.1, 0.2, 0.3] },
        Shape::Lathe { profile: vec![[0.0, 0.0], [0.1, 0.0], [0.12, 0.1], [0.1, 0.1], [0.08, 0.02], [0.0, 0.02]] },
        Shape::Lathe { profile: vec![[0.1, 0.0], [0.2, 0.3]] },
        Shape::Lathe { profile: vec![[0.2, 0.0], [0.3, 0.0], [0.3, 0.1], [0.2, 0.1], [0.2, 0.0]] },
        Shape::Tube { path: vec![[0.0; 3], [0.0, 0.0, 0.3], [0.3, 0.0, 0.3]], radius: 0.02, closed: false },
        Shape::Tube {
            path: vec![[0.0; 3], [0.4, 0.0, 0.0], [0.4, 0.4, 0.1], [0.0, 0.4, 0.0]],
            radius: 0.02,
            closed: true,
        },
        Shape::Extrude { outline: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.5, 0.4]], height: 0.1, bevel: None },
        Shape::Extrude {
            outline: vec![[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]],
            height: 0.1,
            bevel: Some(0.02),
        },
        Shape::Mesh {
            points: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
            smooth_deg: None,
        },
    ];
    for shape in &shapes {
        check_closed(shape);
    }
}

#[test]
fn bad_shapes_are_refused() {
    let bad = [
        Shape::Box { size: [1.0, 0.0, 1.0], bevel: None },
        Shape::Sphere { radii: [f32::NAN, 1.0, 1.0] },
        Shape::Tube { path: vec![[0.0; 3]], radius: 0.1, closed: false },
        Shape::Extrude { outline: vec![[0.0, 0.0], [1.0, 0.0]], height: 0.1, bevel: None },
        Shape::Extrude { outline: vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]], height: 0.1, bevel: None },
        Shape::Lathe { profile: vec![[0.1, f32::INFINITY], [0.1, 0.0]] },
        Shape::Mesh { points: vec![[0.0; 3]; 3], triangles: vec![[0, 1, 3]], smooth_deg: None },
    ];
    for shape in &bad {
        assert!(build(shape, &fine()).is_err(), "{shape:?}");
    }
}

#[test]
fn text_reads_from_left_to_right() {
    // The reader stands in front (+x) and looks along -x: the right hand points along +y.
    let solid = build(&Shape::Text { text: "L".to_owned(), height: 0.6, around: None }, &fine()).unwrap();
    let upright = solid.positions.iter().filter(|p| p.z > 0.2);
    assert!(upright.clone().count() > 0);
    assert!(upright.into_iter().all(|p| p.y < 0.0), "the upright of an L is on the left");
    assert!(solid.normals.iter().all(|normal| normal.x > 0.99));
}

proptest! {
    #[test]
    fn boxes_fill_their_size(x in 0.01_f32..3.0, y in 0.01_f32..3.0, z in 0.01_f32..3.0, bevel in prop::option::of(0.0_f32..1.0)) {
        let shape = Shape::Box { size: [x, y, z], bevel };
        check_closed(&shape);
        let solid = build(&shape, &fine()).unwrap();
        let low = solid.positions.iter().copied().reduce(Vec3::min).unwrap();
        let high = solid.positions.iter().copied().reduce(Vec3::max).unwrap();
        prop_assert!((low - Vec3::new(-x / 2.0, -y / 2.0, 0.0)).length() < 1e-4);
        prop_assert!((high - Vec3::new(x / 2.0, y / 2.0, z)).length() < 1e-4);
    }

    #[test]
    fn cylinders_are_closed(radius in 0.005_f32..1.0, top in 0.0_f32..1.0, height in 0.005_f32..2.0) {
        check_closed(&Shape::Cylinder { radius, top_radius: Some(top), height, bevel: None });
    }
}
