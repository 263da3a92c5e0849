//! One room's faces, and the frames in its walls.

use cohabit_cdf::layout::{Finish, OpeningKind, Room};
use cohabit_cdf::model::{Material, Shape};
use glam::{Mat3, Vec3};

use super::light::{GRID_M, Lamps, RoomLight};
use super::outline::{WallRun, walls};
use super::{Gap, HALF_WALL_M, Plan, RoomSurface, rooms_of};
use crate::color;
use crate::kit::{self, Detail, Precision, Solid};
use crate::mesh::{Paint, Surface};
use crate::pattern::Pattern;

/// How high the wainscot reaches, m.
const WAINSCOT_M: f32 = 1.0;
/// Height and depth of the skirting, m.
const SKIRTING_M: [f32; 2] = [0.09, 0.016];
/// How far before a corner skirting and rails end, m.
const TRIM_END_M: f32 = 0.002;
/// How wide a frame is, and how far it stands out of the wall, m.
const FRAME_M: [f32; 2] = [0.075, 0.018];

/// Adds everything of `room`, which has that index, to the plan.
pub(super) fn build(plan: &mut Plan, room: &Room, index: u8) {
    let lamps: Vec<Lamps> = room.rects_m.iter().map(|rect| Lamps::new(*rect)).collect();
    let light = RoomLight { rects: &room.rects_m, lamps: &lamps, height_m: plan.height_m };
    let bit = 1 << index;
    let floor = floor_surface(&room.floor);
    let ceiling = flat(Pattern::Ceiling, [236, 235, 230]);
    for (surface, finish) in [(RoomSurface::Floor, floor), (RoomSurface::Ceiling, ceiling)] {
        plan.begin(index, bit, surface);
        let first = plan.mesh.positions.len();
        for rect in &room.rects_m {
            let z = if surface == RoomSurface::Floor { 0.0 } else { plan.height_m };
            plan.mesh.push(&sheet(*rect, z, surface == RoomSurface::Ceiling), |_| finish);
        }
        if surface == RoomSurface::Floor {
            seams(plan, bit, finish);
        }
        bake(plan, first, &light);
        plan.end();
    }
    for run in walls(&room.rects_m) {
        let surface = match (run.runs_x, run.inside_above) {
            (true, true) => RoomSurface::SouthWall,
            (true, false) => RoomSurface::NorthWall,
            (false, true) => RoomSurface::WestWall,
            (false, false) => RoomSurface::EastWall,
        };
        plan.begin(index, bit, surface);
        wall(plan, (room, bit), &run, &light);
        plan.end();
    }
    plan.begin(index, bit, RoomSurface::Lamp);
    for lamps in &lamps {
        panels(plan, lamps);
    }
    plan.end();
}

/// A strip under every door and passage, once for both rooms: their floors meet there, divided differently, and rounding
/// leaves a pixel between them now and then.
fn seams(plan: &mut Plan, bit: u64, finish: Surface) {
    /// How far the strip reaches under the floors, and how far it lies below them, m.
    const STRIP_M: [f32; 2] = [0.06, 0.003];
    for gap in plan.gaps.clone() {
        let is_first = gap.rooms & gap.rooms.wrapping_neg() == bit && gap.rooms != bit;
        if !is_first || gap.bounds.min.z > 0.0 {
            continue;
        }
        let (min, max) = (gap.bounds.min, gap.bounds.max);
        let rect = [min.x - STRIP_M[0], min.y - STRIP_M[0], max.x + STRIP_M[0], max.y + STRIP_M[0]];
        plan.mesh.push(&sheet(rect, -STRIP_M[1], false), |_| finish);
    }
}

fn flat(pattern: Pattern, srgb: [u8; 3]) -> Surface {
    Surface { paint: Paint::Fixed(color::from_srgb(srgb)), pattern, u: (Vec3::X, 0.0), v: (Vec3::Y, 0.0), opacity: 1.0 }
}

fn paint(finish: &Finish) -> Paint {
    Paint::Fixed(color::parse_hex(&finish.color).unwrap_or(color::from_srgb([200, 198, 190])))
}

fn floor_surface(finish: &Finish) -> Surface {
    let pattern = match finish.material {
        Material::Wood => Pattern::Planks,
        Material::Tile | Material::Ceramic => Pattern::Tile,
        Material::Carpet | Material::Fabric => Pattern::Carpet,
        Material::Brick => Pattern::Brick,
        _ => Pattern::Concrete,
    };
    Surface { paint: paint(finish), pattern, u: (Vec3::X, 0.0), v: (Vec3::Y, 0.0), opacity: 1.0 }
}

fn wall_surface(finish: &Finish, along: Vec3, low: bool) -> Surface {
    let pattern = match finish.material {
        Material::Brick => Pattern::Brick,
        Material::Tile | Material::Ceramic => Pattern::Tile,
        Material::Wood => {
            if low {
                Pattern::Panels
            } else {
                Pattern::Wood
            }
        }
        Material::Carpet | Material::Fabric => Pattern::Carpet,
        _ if low => Pattern::Panels,
        _ => Pattern::Wall,
    };
    Surface { paint: paint(finish), pattern, u: (along, 0.0), v: (Vec3::Z, 0.0), opacity: 1.0 }
}

/// Lines that divide a length: close together at the ends, where the light changes.
fn divisions(from: f32, to: f32, extra: &[f32]) -> Vec<f32> {
    let mut stops = vec![from, to];
    for inset in [0.12, 0.35] {
        if to - from > 2.5 * inset {
            stops.extend([from + inset, to - inset]);
        }
    }
    let count = ((to - from) / 0.8).ceil().max(1.0);
    stops.extend((1..count as u32).map(|i| from + (to - from) * i as f32 / count));
    stops.sort_by(f32::total_cmp);
    // Exact lines win over neighbours that are only there for the light.
    stops.retain(|stop| *stop == from || *stop == to || extra.iter().all(|exact| (exact - stop).abs() > 0.06));
    stops.extend(extra.iter().copied().filter(|exact| *exact > from && *exact < to));
    stops.sort_by(f32::total_cmp);
    stops.dedup();
    stops
}

fn sheet([west, south, east, north]: [f32; 4], z: f32, faces_down: bool) -> Solid {
    let mut solid = Solid::default();
    let (xs, ys) = (divisions(west, east, &[]), divisions(south, north, &[]));
    for x in xs.windows(2) {
        for y in ys.windows(2) {
            let [a, b, c, d] =
                [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]].map(|[x, y]| Vec3::new(x, y, z));
            solid.face(if faces_down { [d, c, b, a] } else { [a, b, c, d] });
        }
    }
    solid
}

fn bake(plan: &mut Plan, first: usize, light: &RoomLight<'_>) {
    plan.ambient.resize(plan.mesh.positions.len(), 1.0);
    for corner in first..plan.mesh.positions.len() {
        plan.ambient[corner] = light.at(plan.mesh.positions[corner], plan.mesh.normals[corner]);
    }
}

impl WallRun {
    /// A point of the face: along the wall, up, and out into the room.
    fn point(&self, along: f32, z: f32, out: f32) -> Vec3 {
        let across = self.line_m + if self.inside_above { out } else { -out };
        if self.runs_x { Vec3::new(along, across, z) } else { Vec3::new(across, along, z) }
    }

    /// Whether who looks at the face sees the axis grow to the right.
    fn grows_right(&self) -> bool {
        self.runs_x != self.inside_above
    }

    /// The holes in it: from, to, low, high.
    fn holes(&self, gaps: &[Gap]) -> Vec<[f32; 4]> {
        let hole = |gap: &Gap| {
            let (along, across) = if self.runs_x { (0, 1) } else { (1, 0) };
            let here = gap.runs_x == self.runs_x && (gap.bounds.center()[across] - self.line_m).abs() < 0.15;
            let (from, to) = (gap.bounds.min[along] - 0.01, gap.bounds.max[along] + 0.01);
            let [low, high] = hole_levels(gap);
            (here && from < self.to_m && to > self.from_m).then_some([from, to, low, high])
        };
        gaps.iter().filter_map(hole).collect()
    }
}

/// From where to where the hole for a gap reaches.
fn hole_levels(gap: &Gap) -> [f32; 2] {
    let low = if gap.bounds.min.z > 0.0 { gap.bounds.min.z - 0.01 } else { 0.0 };
    [low, gap.bounds.max.z + 0.01]
}

fn wall(plan: &mut Plan, (room, bit): (&Room, u64), run: &WallRun, light: &RoomLight<'_>) {
    let holes = run.holes(&plan.gaps);
    let along = if run.runs_x { Vec3::X } else { Vec3::Y };
    let upper = wall_surface(&room.wall, along, false);
    let lower = room.wainscot.as_ref().map_or(upper, |finish| wall_surface(finish, along, true));
    // The same for all walls of a room: where two meet, their corners do too, and nothing shines through between them.
    let gaps = plan.gaps.iter().filter(|gap| gap.rooms & bit != 0);
    let mut levels: Vec<f32> = gaps.flat_map(hole_levels).filter(|z| *z > 0.0).collect();
    if room.wainscot.is_some() {
        levels.push(WAINSCOT_M);
    }
    let edges: Vec<f32> = holes.iter().flat_map(|hole| [hole[0], hole[1]]).collect();
    let (stops, heights) = (divisions(run.from_m, run.to_m, &edges), divisions(0.0, plan.height_m, &levels));
    let (mut high, mut low) = (Solid::default(), Solid::default());
    for s in stops.windows(2) {
        for z in heights.windows(2) {
            let (middle, level) = ((s[0] + s[1]) * 0.5, (z[0] + z[1]) * 0.5);
            if holes.iter().any(|h| h[0] < middle && middle < h[1] && h[2] < level && level < h[3]) {
                continue;
            }
            let (left, right) = if run.grows_right() { (s[0], s[1]) } else { (s[1], s[0]) };
            let corner = |along: f32, z: f32| run.point(along, z, HALF_WALL_M);
            let target = if level < WAINSCOT_M { &mut low } else { &mut high };
            target.face([corner(left, z[0]), corner(right, z[0]), corner(right, z[1]), corner(left, z[1])]);
        }
    }
    let first = plan.mesh.positions.len();
    plan.mesh.push(&low, |_| lower);
    plan.mesh.push(&high, |_| upper);
    bake(plan, first, light);
    // The wall's upper side shows where there is no ceiling.
    let mut cap = Solid::default();
    let (left, right) = if run.grows_right() { (run.from_m, run.to_m) } else { (run.to_m, run.from_m) };
    let top = plan.height_m;
    cap.face([
        run.point(left, top, HALF_WALL_M),
        run.point(right, top, HALF_WALL_M),
        run.point(right, top, 0.0),
        run.point(left, top, 0.0),
    ]);
    plan.mesh.push(&cap, |_| flat(Pattern::Plain, [92, 92, 96]));
    trim(plan, room, run, &holes);
}

/// Skirting along the floor, and a rail on top of the wainscot, except where there are holes.
fn trim(plan: &mut Plan, room: &Room, run: &WallRun, holes: &[[f32; 4]]) {
    let white = flat(Pattern::Panels, [226, 223, 214]);
    let white = Surface { pattern: Pattern::Plain, ..white };
    let mut bars = vec![(0.0, SKIRTING_M)];
    if room.wainscot.is_some() {
        bars.push((WAINSCOT_M - 0.02, [0.045, 0.022]));
    }
    // Bars that meet in a corner are not equally high, and end before the other wall's face: no two lie in one plane.
    let lower_m = if run.runs_x { 0.0015 } else { 0.0 };
    for (base, [height, depth]) in bars {
        let height = height - lower_m;
        let mut blocked: Vec<[f32; 2]> = holes
            .iter()
            .filter(|hole| hole[2] < base + height && hole[3] > base)
            .map(|hole| [hole[0] - FRAME_M[0], hole[1] + FRAME_M[0]])
            .collect();
        blocked.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let last = run.to_m - TRIM_END_M;
        let mut from = run.from_m + TRIM_END_M;
        for [start, end] in blocked.into_iter().chain([[last, last]]) {
            if start - from > 0.02 {
                // Sunk into the wall, so that it stands on nothing coplanar.
                let size = along_size(run, start - from, depth + 0.02, height);
                let middle = run.point((start + from) * 0.5, base, HALF_WALL_M + depth * 0.5 - 0.01);
                let first = plan.mesh.normals.len();
                push_box(plan, size, middle, white);
                // Thinner than a pixel from a few metres on, a bar is lit as if it were round: no side of it flickers.
                let lit = (run.point(0.0, 0.35, 1.0) - run.point(0.0, 0.0, 0.0)).normalize();
                plan.mesh.normals[first..].fill(lit);
            }
            from = from.max(end);
        }
    }
}

fn along_size(run: &WallRun, along: f32, across: f32, height: f32) -> Vec3 {
    if run.runs_x { Vec3::new(along, across, height) } else { Vec3::new(across, along, height) }
}

fn push_box(plan: &mut Plan, size: Vec3, base: Vec3, surface: Surface) {
    if size.min_element() <= 0.0 {
        return;
    }
    // Sharp: a rounded edge here is narrower than a pixel nearly everywhere, and would only flicker.
    let shape = Shape::Box { size: size.to_array(), bevel: Some(0.0) };
    if let Ok(mut solid) = kit::build(&shape, &Precision::of(Detail::Fine, 1.0)) {
        solid.transform(Mat3::IDENTITY, base);
        plan.mesh.push(&solid, |_| surface);
    }
}

fn panels(plan: &mut Plan, lamps: &Lamps) {
    let rim = flat(Pattern::Plain, [222, 222, 220]);
    let glow = flat(Pattern::Lamp, [255, 252, 244]);
    let size = if lamps.along_y { [GRID_M, 2.0 * GRID_M] } else { [2.0 * GRID_M, GRID_M] };
    for corner in &lamps.corners {
        let center = Vec3::new(corner.x + size[0] * 0.5, corner.y + size[1] * 0.5, plan.height_m);
        let frame = Vec3::new(size[0] - 0.01, size[1] - 0.01, 0.04);
        push_box(plan, frame, center - Vec3::Z * 0.022, rim);
        let lamp = Vec3::new(size[0] - 0.06, size[1] - 0.06, 0.03);
        push_box(plan, lamp, center - Vec3::Z * 0.03, glow);
    }
}

/// The frames in all gaps, and the sky behind those that lead outside.
pub(super) fn frames(plan: &mut Plan) {
    for gap in plan.gaps.clone() {
        let Some(room) = rooms_of(gap.rooms).next() else { continue };
        plan.begin(room as u8, gap.rooms, RoomSurface::Frame);
        frame(plan, &gap);
        plan.end();
    }
}

fn frame(plan: &mut Plan, gap: &Gap) {
    let white = flat(Pattern::Plain, [232, 229, 221]);
    let [wide, out] = FRAME_M;
    let depth = 2.0 * (HALF_WALL_M + out);
    let (center, size) = (gap.bounds.center(), gap.bounds.size());
    let width = if gap.runs_x { size.x } else { size.y };
    let (low, high) = (gap.bounds.min.z, gap.bounds.max.z);
    let oriented = |along: f32, across: f32, z: f32| {
        if gap.runs_x { Vec3::new(along, across, z) } else { Vec3::new(across, along, z) }
    };
    let base = |along: f32, z: f32| oriented(along, 0.0, z) + Vec3::new(center.x, center.y, 0.0);
    let foot = if low > 0.0 { low - wide } else { 0.0 };
    for side in [-1.0, 1.0] {
        // A hair outside the gap, so that a door never lies in its plane.
        let along = side * (width * 0.5 + wide * 0.5 + 0.002);
        push_box(plan, oriented(wide, depth, high - foot + 0.002), base(along, foot), white);
    }
    push_box(plan, oriented(width + 2.0 * wide, depth + 0.008, wide), base(0.0, high + 0.002), white);
    if gap.kind == OpeningKind::Window {
        push_box(plan, oriented(width + 2.0 * wide, depth + 0.06, 0.035), base(0.0, low - 0.037), white);
        push_box(plan, oriented(0.035, 0.045, high - low), base(0.0, low), white);
        push_box(plan, oriented(width, 0.04, 0.03), base(0.0, low + (high - low) * 0.5), white);
    }
    if gap.rooms.count_ones() < 2 {
        let sky = Surface { u: (Vec3::Z, -low), ..flat(Pattern::Sky, [188, 208, 226]) };
        push_box(plan, oriented(width, 0.01, high - low), base(0.0, low), sky);
    }
}
