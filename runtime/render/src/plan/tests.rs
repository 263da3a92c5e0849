#![allow(clippy::unwrap_used)]

use super::outline::walls;

#[test]
fn a_rectangle_has_four_walls() {
    let runs = walls(&[[0.0, 0.0, 4.0, 3.0]]);
    assert_eq!(runs.len(), 4);
    let total: f32 = runs.iter().map(|run| run.to_m - run.from_m).sum();
    assert!((total - (14.0 - 8.0 * 0.06)).abs() < 1e-4, "{total}");
}

#[test]
fn an_l_has_six_walls_and_none_inside() {
    let runs = walls(&[[0.0, 0.0, 4.0, 2.0], [0.0, 2.0, 2.0, 4.0]]);
    assert_eq!(runs.len(), 6, "{runs:?}");
    // Five corners shorten their two walls; the one that juts in lengthens its two.
    let total: f32 = runs.iter().map(|run| run.to_m - run.from_m).sum();
    assert!((total - (16.0 - 10.0 * 0.06 + 2.0 * 0.06)).abs() < 1e-4, "{total}");
}
