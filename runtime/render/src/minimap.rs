//! A floor plan drawn from above as people draw one: coloured rooms with their names, walls, openings, furniture.

use cohabit_cdf::layout::{Layout, Opening, OpeningKind, Room};
use cohabit_cdf::model::Axis;
use cohabit_cdf::{Catalog, RoomId};

use crate::color;
use crate::gallery::Picture;
use crate::ink::{Ink, Paper};
use crate::kit;
use crate::plan::{HALF_WALL_M, walls};

/// What is left free around the plan, m.
const MARGIN_M: f32 = 0.6;
/// The most pixels of a side.
const LONGEST_PX: f32 = 8192.0;

const WALL: Ink = Ink([58, 66, 74], 1.0);
const FURNITURE: Ink = Ink([255, 255, 255], 0.55);
const OUTLINE: Ink = Ink([96, 104, 112], 0.8);
const SILL: Ink = Ink([166, 128, 92], 1.0);
const GLASS: Ink = Ink([150, 200, 226], 1.0);
const LETTERS: Ink = Ink([38, 46, 54], 1.0);

/// Height of a capital letter of a room's name where there is room for it, m.
const CAPITAL_M: f32 = 0.62;
/// From line to line, in heights of a capital.
const LINE: f32 = 1.55;
/// How thick letters are, and the edge that keeps them legible, in heights of a capital.
const STROKE: f32 = 0.16;
const EDGE: f32 = 0.62;

/// A schematic picture of a floor plan.
#[derive(Clone, Debug)]
pub struct Minimap {
    /// What it looks like; transparent beyond the walls.
    pub picture: Picture,
    /// Its left edge in the world, m.
    pub west_m: f32,
    /// Its upper edge in the world, m.
    pub north_m: f32,
    /// Its scale.
    pub pixels_per_m: f32,
}

impl Minimap {
    /// Where in the picture a place of the world lies, in pixels from its upper left corner.
    #[must_use]
    pub fn pixel_of(&self, [x_m, y_m]: [f32; 2]) -> [f32; 2] {
        [(x_m - self.west_m) * self.pixels_per_m, (self.north_m - y_m) * self.pixels_per_m]
    }
}

/// Draws a floor plan, north up, at most as large as a picture may be (8192 pixels a side).
#[must_use]
pub fn minimap(layout: &Layout, catalog: &Catalog, pixels_per_m: f32) -> Minimap {
    let [west, south, east, north] = if layout.rooms.is_empty() { [0.0; 4] } else { layout.bounds_m() };
    let sides_m = [east - west, north - south].map(|side| side + 2.0 * MARGIN_M);
    let most = LONGEST_PX / sides_m[0].max(sides_m[1]);
    let scale = if pixels_per_m > 0.0 { pixels_per_m.min(most) } else { 1.0 };
    let origin_m = [west - MARGIN_M, north + MARGIN_M];
    let mut paper = Paper::new(sides_m, origin_m, scale);
    for room in &layout.rooms {
        for rect in &room.rects_m {
            paper.rect(*rect, tint(catalog, room.id));
        }
    }
    for corners in layout.furniture_outlines_m(catalog) {
        paper.polygon(corners, FURNITURE);
        paper.outline(corners, 1.0_f32.max(scale * 0.035) / scale, OUTLINE);
    }
    for room in &layout.rooms {
        draw_walls(&mut paper, room, scale);
    }
    for opening in &layout.openings {
        draw_opening(&mut paper, (layout, catalog), opening, scale);
    }
    for room in &layout.rooms {
        write_name(&mut paper, room, catalog);
    }
    let [width, height] = paper.size();
    let picture = Picture { width, height, rgba: paper.into_rgba() };
    Minimap { picture, west_m: origin_m[0], north_m: origin_m[1], pixels_per_m: scale }
}

/// A colour for each room, the same in every plan: the one that the world gives it, or a light one of its own.
fn tint(catalog: &Catalog, room: RoomId) -> Ink {
    let given = catalog.rooms().get(room).and_then(|entry| color::srgb_of_hex(entry.color.as_deref()?));
    Ink(given.unwrap_or_else(|| own_tint(catalog.room_index(room).unwrap_or_default())), 1.0)
}

/// A light colour for the room with this index: hues that follow each other at the golden angle are apart.
fn own_tint(index: u8) -> [u8; 3] {
    const GOLDEN_TURN: f32 = 0.618_034;
    let turn = (f32::from(index) * GOLDEN_TURN).fract();
    [0.0, 1.0 / 3.0, 2.0 / 3.0].map(|shift| {
        let away = ((turn + shift).fract() - 0.5).abs() * 2.0;
        (200.0 + 45.0 * away) as u8
    })
}

/// Half a wall's thickness as it is drawn, m: never too thin to be seen.
fn half_wall_m(scale: f32) -> f32 {
    HALF_WALL_M.max(0.75 / scale)
}

fn draw_walls(paper: &mut Paper, room: &Room, scale: f32) {
    let half = half_wall_m(scale);
    for run in walls(&room.rects_m) {
        let (from, to) = (run.from_m - HALF_WALL_M - half, run.to_m + HALF_WALL_M + half);
        let rect = if run.runs_x {
            [from, run.line_m - half, to, run.line_m + half]
        } else {
            [run.line_m - half, from, run.line_m + half, to]
        };
        paper.rect(rect, WALL);
    }
}

fn draw_opening(paper: &mut Paper, (layout, catalog): (&Layout, &Catalog), opening: &Opening, scale: f32) {
    let [x, y] = opening.at_m;
    let (half, thick) = (opening.width_m / 2.0, half_wall_m(scale));
    let rect = |half_across: f32| match opening.wall_runs {
        Axis::X => [x - half, y - half_across, x + half, y + half_across],
        _ => [x - half_across, y - half, x + half_across, y + half],
    };
    match opening.kind {
        OpeningKind::Window => paper.rect(rect(thick * 0.5), GLASS),
        OpeningKind::Door | OpeningKind::Passage => {
            // Each room's floor reaches half-way into the gap.
            let [own, other] = opening.between.map(|id| tint(catalog, id));
            let (low, high) = match opening.wall_runs {
                Axis::X => ([x - half, y - thick - 0.01, x + half, y], [x - half, y, x + half, y + thick + 0.01]),
                _ => ([x - thick - 0.01, y - half, x, y + half], [x, y - half, x + thick + 0.01, y + half]),
            };
            // The first room is the southern or western one, unless the plan is mirrored.
            let first_is_low = layout.room(opening.between[0]).is_some_and(|room| {
                let aside = if opening.wall_runs == Axis::X { [x, y - 0.3] } else { [x - 0.3, y] };
                room.has(aside[0], aside[1])
            });
            paper.rect(low, if first_is_low { own } else { other });
            paper.rect(high, if first_is_low { other } else { own });
            if opening.kind == OpeningKind::Door {
                paper.rect(rect(thick * 0.4), SILL);
            }
        }
    }
}

/// A room's name in the middle of its largest rectangle: broken into lines, turned or smaller where it is narrow.
fn write_name(paper: &mut Paper, room: &Room, catalog: &Catalog) {
    let area = |[west, south, east, north]: &[f32; 4]| (east - west) * (north - south);
    let Some([west, south, east, north]) = room.rects_m.iter().max_by(|a, b| area(a).total_cmp(&area(b))) else {
        return;
    };
    let (wide, high) = (east - west - 0.5, north - south - 0.5);
    let middle = [f32::midpoint(*west, *east), f32::midpoint(*south, *north)];
    let words: Vec<String> = room.id.name_in(catalog).split(' ').map(str::to_uppercase).collect();
    let upright = fit(&words, wide, high);
    let turned = fit(&words, high, wide);
    // Upright reads better: it is turned only where that makes it much larger.
    let ((lines, capital), is_turned) = if turned.1 > upright.1 * 1.3 { (turned, true) } else { (upright, false) };
    let mut strokes = Vec::new();
    for (index, line) in lines.iter().enumerate() {
        let row = (lines.len() as f32 - 1.0) * 0.5 - index as f32;
        let own = kit::line_of_text(line);
        let width = width_of(&own);
        let place = |[along, up]: [f32; 2]| {
            let (along, up) = ((along - width * 0.5) * capital, (up - 0.5 + row * LINE) * capital);
            if is_turned { [middle[0] - up, middle[1] + along] } else { [middle[0] + along, middle[1] + up] }
        };
        strokes.extend(own.into_iter().map(|[a, b]| [place(a), place(b)]));
    }
    paper.strokes(&strokes, capital * EDGE, Ink(tint(catalog, room.id).0, 0.82));
    paper.strokes(&strokes, capital * STROKE, LETTERS);
}

fn width_of(strokes: &[[[f32; 2]; 2]]) -> f32 {
    strokes.iter().flatten().fold(0.0, |most, [along, _]| most.max(*along))
}

/// Words as one line, or as a line each, whichever can be larger in so much room; and how high its capitals are, m.
fn fit(words: &[String], wide_m: f32, high_m: f32) -> (Vec<String>, f32) {
    let size = |lines: &[String]| {
        let longest = lines.iter().map(|line| width_of(&kit::line_of_text(line))).fold(0.1, f32::max);
        let rows = (lines.len() as f32 - 1.0) * LINE + 1.0;
        (wide_m / longest).min(high_m / rows).clamp(0.01, CAPITAL_M)
    };
    let (one, each) = (vec![words.join(" ")], words.to_vec());
    let (large, small) = (size(&one), size(&each));
    if small > large { (each, small) } else { (one, large) }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn rgba(map: &Minimap, at_m: [f32; 2]) -> [u8; 4] {
        let [x, y] = map.pixel_of(at_m).map(|place| place as usize);
        let start = (y * map.picture.width as usize + x) * 4;
        map.picture.rgba[start..start + 4].try_into().unwrap()
    }

    #[test]
    fn rooms_walls_and_gaps_are_where_the_plan_has_them() {
        let catalog = Catalog::builtin();
        for id in Layout::builtin_ids() {
            let layout = Layout::builtin(&id).unwrap();
            let bare = Layout { placements: Vec::new(), ..layout.clone() };
            let map = minimap(&bare, &catalog, 24.0);
            assert_eq!(rgba(&map, [map.west_m + 0.05, map.north_m - 0.05])[3], 0, "{id}: beyond the walls");
            for room in &layout.rooms {
                let Ink([red, green, blue], _) = tint(&catalog, room.id);
                let [west, south, ..] = room.rects_m[0];
                assert_eq!(rgba(&map, [west + 0.3, south + 0.3]), [red, green, blue, 255], "{id} {:?}", room.id);
                let corner = [west, south + 0.2];
                let is_near = |at_m: [f32; 2]| (at_m[0] - corner[0]).hypot(at_m[1] - corner[1]) < 2.0;
                let is_solid = !layout.openings.iter().any(|opening| is_near(opening.at_m));
                if room.rects_m.len() == 1 && is_solid {
                    assert_eq!(rgba(&map, corner)[..3], WALL.0, "{id} {:?}", room.id);
                }
            }
            for opening in &layout.openings {
                assert_ne!(rgba(&map, opening.at_m)[..3], WALL.0, "{id} {opening:?}");
            }
        }
    }

    #[test]
    fn furniture_is_drawn_and_size_follows_scale() {
        let (catalog, layout) = (Catalog::builtin(), Layout::builtin("OfficeLayout1").unwrap());
        let bare = Layout { placements: Vec::new(), ..layout.clone() };
        let (with, without) = (minimap(&layout, &catalog, 20.0), minimap(&bare, &catalog, 20.0));
        assert_ne!(with.picture.rgba, without.picture.rgba);
        assert_eq!(with.picture.width, (with.picture.rgba.len() / 4) as u32 / with.picture.height);
        let large = minimap(&layout, &catalog, 1e9);
        assert!(large.picture.width <= 8192 && large.picture.height <= 8192);
        assert!(minimap(&Layout { rooms: Vec::new(), ..bare }, &catalog, f32::NAN).picture.width > 0);
    }
}
