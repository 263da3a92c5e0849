//! The walls around a room made of rectangles.

use super::HALF_WALL_M;

/// One straight wall face of a room.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WallRun {
    /// Whether it runs east-west.
    pub runs_x: bool,
    /// Where the wall's middle lies on the other axis, m.
    pub line_m: f32,
    /// Whether the room lies towards greater values of the other axis.
    pub inside_above: bool,
    /// From where to where its face reaches, m.
    pub from_m: f32,
    /// The other end.
    pub to_m: f32,
}

/// All wall faces of the union of `rects`.
pub(crate) fn walls(rects: &[[f32; 4]]) -> Vec<WallRun> {
    let xs = stops(rects.iter().flat_map(|rect| [rect[0], rect[2]]));
    let ys = stops(rects.iter().flat_map(|rect| [rect[1], rect[3]]));
    let inside = |i: isize, j: isize| {
        let between = |stops: &[f32], k: isize| match usize::try_from(k) {
            Ok(k) if k + 1 < stops.len() => Some((stops[k] + stops[k + 1]) * 0.5),
            _ => None,
        };
        let (Some(x), Some(y)) = (between(&xs, i), between(&ys, j)) else { return false };
        rects.iter().any(|rect| rect[0] < x && x < rect[2] && rect[1] < y && y < rect[3])
    };
    let mut runs = Vec::new();
    for runs_x in [true, false] {
        let (along, across) = if runs_x { (&xs, &ys) } else { (&ys, &xs) };
        let cell = |a: isize, c: isize| if runs_x { inside(a, c) } else { inside(c, a) };
        for (line, line_m) in across.iter().enumerate() {
            for inside_above in [true, false] {
                let (own, other) =
                    (line as isize - isize::from(!inside_above), line as isize - isize::from(inside_above));
                let wall = |a: isize| cell(a, own) && !cell(a, other);
                let mut a = 0;
                while a < along.len() as isize {
                    if !wall(a) {
                        a += 1;
                        continue;
                    }
                    let start = a;
                    while wall(a) {
                        a += 1;
                    }
                    // A wall ends either where another meets it, or goes round a corner that juts into the room.
                    let trim = |beyond: isize| if cell(beyond, own) { -HALF_WALL_M } else { HALF_WALL_M };
                    runs.push(WallRun {
                        runs_x,
                        line_m: *line_m,
                        inside_above,
                        from_m: along[start as usize] + trim(start - 1),
                        to_m: along[a as usize] - trim(a),
                    });
                }
            }
        }
    }
    runs
}

fn stops(values: impl Iterator<Item = f32>) -> Vec<f32> {
    let mut stops: Vec<f32> = values.collect();
    stops.sort_by(f32::total_cmp);
    stops.dedup_by(|a, b| (*a - *b).abs() < 1e-3);
    stops
}
