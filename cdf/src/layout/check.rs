//! What is wrong with a floor plan, beyond its syntax: a plan without faults can be lived and worked in.

use std::collections::{BTreeMap, HashSet};

use super::fault::{LayoutFault, NOTE_PLACES, NoStand, NoWay, VIEWPOINTS};
use super::floor::{FreeFloor, is_obstacle};
use super::footprint::{Footprint, is_clear_of_walls};
use super::ways::Ways;
use super::{Layout, Opening, OpeningKind, Placement, Room, RoomId, Viewpoint};
use crate::catalog::{Catalog, ObjectClass, Property, Stands};
use crate::model::Axis;
use crate::nearest::nearest;

/// Half the thickness of walls, m.
const HALF_WALL_M: f32 = 0.06;
/// Rounding in plan files, m.
const SLACK_M: f32 = 0.002;
/// Kept free before doors and passages, m.
const CLEAR_BEFORE_DOORS_M: f32 = 0.9;
/// Half the width of a walkway, m.
const WALKWAY_RADIUS_M: f32 = 0.4;
/// The farthest that a walkway may end from what is worked from it, m.
const REACH_M: f32 = 0.85;
/// The farthest that a robot may stand from what it works over furniture, m; a little less than the world lets it.
const REACH_OVER_M: f32 = 1.25;
/// Radius of the robot, m.
const ROBOT_RADIUS_M: f32 = 0.25;
/// Half the width of what stands on an anchor, m.
const ANCHOR_RADIUS_M: f32 = 0.06;
/// A viewpoint that is proposed is so far from all others, m.
const APART_M: f32 = 0.5;
impl Layout {
    /// All that is wrong with this plan, given the sizes of things.
    #[must_use]
    pub fn faults(&self, catalog: &Catalog) -> Vec<LayoutFault> {
        let mut faults = Vec::new();
        let mut solids = Vec::new();
        let mut seen = HashSet::new();
        for placement in &self.placements {
            let instance = placement.instance.clone();
            if !seen.insert(placement.instance.as_str()) {
                faults.push(LayoutFault::Repeated { instance: instance.clone() });
            }
            match catalog.class_of_instance(&instance) {
                None => faults.push(LayoutFault::UnknownClass { near: catalog.near(&instance), instance }),
                Some(class) => {
                    let class = catalog.class(class);
                    solids.push(Solid { placement, class, print: Footprint::of(self, placement, class) });
                }
            }
        }
        self.check_names_of_rooms(&mut faults);
        self.check_links(&mut faults);
        self.check_openings(&mut faults);
        self.check_rooms(&solids, &mut faults);
        check_space(self, &solids, &mut faults);
        check_receptacles(&solids, &mut faults);
        self.check_floor(catalog, &solids, &mut faults);
        self.check_notes(&mut faults);
        faults
    }

    /// Whether a placement is the door of an opening.
    #[must_use]
    pub fn is_door(&self, placement: &Placement) -> bool {
        self.openings.iter().any(|opening| opening.door.as_ref() == Some(&placement.instance))
    }

    /// What names a room that is not there.
    fn check_names_of_rooms(&self, faults: &mut Vec<LayoutFault>) {
        let placed = self.placements.iter().filter(|placement| !self.is_door(placement));
        let placed = placed.map(|placement| (format!("`{}`", placement.instance), placement.room));
        let opened = self.openings.iter().flat_map(|Opening { kind, at_m, between, .. }| {
            between.map(|room| (format!("the {kind:?} at {at_m:?}"), room))
        });
        let viewed = self.viewpoints.iter().map(|view| (format!("viewpoint {}", view.number), view.room));
        let noted = self.note_places.iter().map(|note| (format!("the place for notes at {:?}", note.at_m), note.room));
        for (what, room) in placed.chain(opened).chain(viewed).chain(noted) {
            if self.room(room).is_none() {
                faults.push(LayoutFault::NoRoom { what, room });
            }
        }
    }

    fn check_links(&self, faults: &mut Vec<LayoutFault>) {
        for placement in &self.placements {
            for other in [&placement.on, &placement.works].into_iter().flatten() {
                if self.placement(other).is_none_or(|found| found.room != placement.room) {
                    let (instance, other) = (placement.instance.clone(), other.clone());
                    let own = self.placements.iter().filter(|own| own.room == placement.room);
                    let own = own.map(|own| own.instance.as_str()).filter(|own| *own != instance);
                    let near = nearest(&other, own).map(str::to_owned);
                    faults.push(LayoutFault::LooseLink { instance, other, near });
                }
            }
        }
    }

    fn check_openings(&self, faults: &mut Vec<LayoutFault>) {
        let has_rooms = |opening: &&Opening| opening.between.iter().all(|id| self.room(*id).is_some());
        for opening in self.openings.iter().filter(has_rooms) {
            let [first, second] = opening.between;
            let has_wall = |id| self.room(id).is_some_and(|room| has_wall_at(room, opening));
            let is_outside = self.rooms.iter().filter(|room| has_wall_at(room, opening)).count() == 1;
            let fits = has_wall(first) && has_wall(second) && (first != second || is_outside);
            if !fits {
                let Opening { kind, at_m, between, .. } = opening.clone();
                faults.push(LayoutFault::OpeningOffWall { kind, at_m, between });
            }
        }
    }

    fn check_rooms(&self, solids: &[Solid<'_>], faults: &mut Vec<LayoutFault>) {
        for solid in solids.iter().filter(|solid| !self.is_door(solid.placement)) {
            let Placement { instance, room, .. } = solid.placement;
            let margin_m = HALF_WALL_M - SLACK_M;
            let leaves = self.room(*room).is_some_and(|room| !solid.print.fits(room, margin_m));
            let is_low = solid.print.height_m[1] <= self.wall_height_m + SLACK_M;
            if leaves || !is_low {
                faults.push(LayoutFault::OutsideRoom { instance: instance.clone(), room: *room });
            }
        }
    }

    fn check_floor(&self, catalog: &Catalog, solids: &[Solid<'_>], faults: &mut Vec<LayoutFault>) {
        let standing = FreeFloor::new(self, catalog, ROBOT_RADIUS_M);
        let ways = Ways::of(self, catalog);
        let is_reached = |room: &Room| {
            let margin_m = HALF_WALL_M + ROBOT_RADIUS_M;
            standing.points_m().any(|(id, point)| id == room.id && is_clear_of_walls(room, point, margin_m))
        };
        // Nothing is said of what is in a room that cannot be reached: its door is what is missing.
        let (reached, out_of_reach): (Vec<&Room>, Vec<&Room>) = self.rooms.iter().partition(|room| is_reached(room));
        let fault = |room: &&Room| {
            let why = ways.no_way_into(room.id).unwrap_or(NoWay::Blocked);
            LayoutFault::OutOfReach { room: room.id, why }
        };
        faults.extend(out_of_reach.iter().map(fault));
        let mut walkways: BTreeMap<RoomId, Vec<[f32; 2]>> = BTreeMap::new();
        for (room, point) in FreeFloor::new(self, catalog, WALKWAY_RADIUS_M).points_m() {
            walkways.entry(room).or_default().push(point);
        }
        for solid in solids.iter().filter(|solid| solid.is_operable() && solid.placement.on.is_none()) {
            let is_near = |point: &[f32; 2]| solid.print.distance_m(*point) <= REACH_M;
            let is_walked_to = walkways.get(&solid.placement.room).is_some_and(|points| points.iter().any(is_near));
            let is_at_hand = |(room, point): (RoomId, [f32; 2])| {
                room == solid.placement.room && solid.print.distance_m(point) <= REACH_OVER_M
            };
            let is_walked_to = is_walked_to || (solid.is_worked_over() && standing.points_m().any(is_at_hand));
            let is_of_reached = reached.iter().any(|room| room.id == solid.placement.room);
            if is_of_reached && !is_walked_to && !self.is_door(solid.placement) {
                faults.push(LayoutFault::Unreachable { instance: solid.placement.instance.clone() });
            }
        }
        for room in &self.rooms {
            self.check_viewpoints(room, solids, reached.contains(&room).then_some(&standing), faults);
        }
    }

    /// The viewpoints of a room; whether they can be walked to, if `standing` is where a robot can.
    fn check_viewpoints(
        &self,
        room: &Room,
        solids: &[Solid<'_>],
        standing: Option<&FreeFloor>,
        faults: &mut Vec<LayoutFault>,
    ) {
        let own: Vec<&Viewpoint> = self.viewpoints.iter().filter(|view| view.room == room.id).collect();
        let numbers: Vec<u8> =
            (1..=VIEWPOINTS).filter(|number| own.iter().all(|view| view.number != *number)).collect();
        if !numbers.is_empty() {
            let is_apart = |point: [f32; 2]| {
                own.iter().all(|view| libm::hypotf(view.at_m[0] - point[0], view.at_m[1] - point[1]) >= APART_M)
            };
            let mut free = standing.into_iter().flat_map(FreeFloor::points_m);
            let free_m = free.find(|(id, point)| *id == room.id && is_apart(*point)).map(|(_, point)| point);
            faults.push(LayoutFault::NoViewpoint { room: room.id, numbers, free_m });
        }
        for view in own.into_iter().filter(|view| (1..=VIEWPOINTS).contains(&view.number)) {
            if let Some(why) = no_stand(room, view.at_m, solids, standing) {
                faults.push(LayoutFault::Viewpoint { room: room.id, number: view.number, at_m: view.at_m, why });
            }
        }
    }

    fn check_notes(&self, faults: &mut Vec<LayoutFault>) {
        for room in &self.rooms {
            let places: Vec<[f32; 3]> =
                self.note_places.iter().filter(|note| note.room == room.id).map(|note| note.at_m).collect();
            let is_on_wall = |[x, y, _]: [f32; 3]| {
                is_clear_of_walls(room, [x, y], HALF_WALL_M) && !is_clear_of_walls(room, [x, y], HALF_WALL_M + 0.05)
            };
            let off_wall = places.iter().filter(|at_m| !is_on_wall(**at_m));
            faults.extend(off_wall.map(|at_m| LayoutFault::NoteOffWall { room: room.id, at_m: *at_m }));
            if places.len() < NOTE_PLACES {
                faults.push(LayoutFault::NotePlaces { room: room.id, count: places.len() });
            }
        }
    }
}

/// Why nobody can stand at a point of a room, if so.
fn no_stand(room: &Room, at_m: [f32; 2], solids: &[Solid<'_>], standing: Option<&FreeFloor>) -> Option<NoStand> {
    if !room.has(at_m[0], at_m[1]) {
        return Some(NoStand::OutsideRoom);
    }
    if standing.is_none_or(|standing| standing.has(at_m)) {
        return None;
    }
    if !is_clear_of_walls(room, at_m, HALF_WALL_M + ROBOT_RADIUS_M) {
        return Some(NoStand::NearWall);
    }
    let on_floor = solids.iter().filter(|solid| solid.placement.on.is_none() && is_obstacle(&solid.print));
    let mut near = on_floor.filter(|solid| solid.print.distance_m(at_m) < ROBOT_RADIUS_M);
    Some(near.next().map_or(NoStand::NoWay, |solid| NoStand::Near(solid.placement.instance.clone())))
}

/// A placement with its class and the space it fills.
struct Solid<'a> {
    placement: &'a Placement,
    class: &'a ObjectClass,
    print: Footprint,
}

impl Solid<'_> {
    fn is_operable(&self) -> bool {
        use Property::{Openable, Powerable, Receptacle, Toggleable, Usable};
        [Openable, Powerable, Receptacle, Toggleable, Usable].into_iter().any(|property| self.class.has(property))
    }

    /// Whether a hand works it over what stands below: it hangs on a wall, and nothing is put into it.
    fn is_worked_over(&self) -> bool {
        self.class.stands == Stands::OnWall && !self.class.has(Property::Receptacle)
    }

    /// A button on its machine belongs there.
    fn belongs_to(&self, other: &Self) -> bool {
        self.placement.works.as_ref() == Some(&other.placement.instance)
    }
}

/// Whether a straight wall of `room` holds the whole opening.
fn has_wall_at(room: &Room, opening: &Opening) -> bool {
    let (across, along) = if opening.wall_runs == Axis::X { (1, 0) } else { (0, 1) };
    let half_m = opening.width_m / 2.0;
    room.rects_m.iter().any(|rect| {
        let on_line =
            [rect[across], rect[across + 2]].into_iter().any(|at| (at - opening.at_m[across]).abs() < SLACK_M);
        on_line && opening.at_m[along] - half_m >= rect[along] && opening.at_m[along] + half_m <= rect[along + 2]
    })
}

/// No two things in one place, nothing before doors.
fn check_space(layout: &Layout, solids: &[Solid<'_>], faults: &mut Vec<LayoutFault>) {
    let apart: Vec<_> =
        solids.iter().filter(|solid| solid.placement.on.is_none() && !layout.is_door(solid.placement)).collect();
    for (index, solid) in apart.iter().enumerate() {
        let instance = &solid.placement.instance;
        for other in &apart[..index] {
            let belongs = solid.belongs_to(other) || other.belongs_to(solid);
            if !belongs && solid.print.overlaps(&other.print, SLACK_M) {
                let other = other.placement.instance.clone();
                faults.push(LayoutFault::Overlap { instance: instance.clone(), other });
            }
        }
        for opening in layout.openings.iter().filter(|opening| solid.print.overlaps(&kept_free(opening), SLACK_M)) {
            let (kind, at_m) = (opening.kind, opening.at_m);
            faults.push(LayoutFault::BlocksOpening { instance: instance.clone(), kind, at_m });
        }
    }
}

/// The space in and before an opening that must stay free.
fn kept_free(opening: &Opening) -> Footprint {
    let (depth_m, from_m, to_m) = match opening.kind {
        OpeningKind::Door | OpeningKind::Passage => (CLEAR_BEFORE_DOORS_M, 0.0, 2.1),
        OpeningKind::Window => (HALF_WALL_M + 0.06, 1.02, 2.2),
    };
    let half_m =
        if opening.wall_runs == Axis::X { [opening.width_m / 2.0, depth_m] } else { [depth_m, opening.width_m / 2.0] };
    let mut space = Footprint::upright(opening.at_m, half_m, to_m);
    space.height_m[0] = from_m;
    space
}

/// Missions put things on receptacles: half of the anchors stay free.
fn check_receptacles(solids: &[Solid<'_>], faults: &mut Vec<LayoutFault>) {
    for holder in solids {
        let Some(receptacle) = holder.class.receptacle.as_ref().filter(|receptacle| receptacle.keys.is_empty()) else {
            continue;
        };
        let instance = &holder.placement.instance;
        let contents = || solids.iter().filter(|solid| solid.placement.on.as_ref() == Some(instance));
        let anchors: Vec<_> =
            receptacle.surfaces.iter().flat_map(|surface| anchor_points(surface, holder.placement.scale)).collect();
        let covered = anchors.iter().filter(|anchor| contents().any(|thing| covers(holder, thing, **anchor))).count();
        let taken = covered + contents().filter(|thing| thing.placement.anchor).count();
        if anchors.len() > 1 && taken * 2 > anchors.len() {
            faults.push(LayoutFault::Crowded { instance: instance.clone(), taken, anchors: anchors.len() });
        }
    }
}

/// The anchors of a surface, in the holder's frame, m.
fn anchor_points(surface: &crate::catalog::Surface, scale: [f32; 3]) -> Vec<[f32; 3]> {
    let spread = |axis: usize, index: u32| {
        let [count, index] = [surface.anchors[axis], index].map(|n| u16::try_from(n).map_or(1.0, f32::from));
        (surface.center_m[axis] + surface.size_m[axis] * ((index + 0.5) / count - 0.5)) * scale[axis]
    };
    let z = surface.center_m[2] * scale[2];
    let columns = 0..surface.anchors[0];
    columns
        .flat_map(|x| (0..surface.anchors[1]).map(move |y| (x, y)))
        .map(|(x, y)| [spread(0, x), spread(1, y), z])
        .collect()
}

/// Whether a thing put at a place of its own leaves no room on an anchor.
fn covers(holder: &Solid<'_>, thing: &Solid<'_>, [x, y, z]: [f32; 3]) -> bool {
    let Placement { at_m, anchor: false, .. } = thing.placement else { return false };
    let turn = (thing.placement.yaw_deg - holder.placement.yaw_deg).to_radians();
    let (cos, sin) = (libm::cosf(turn).abs(), libm::sinf(turn).abs());
    let [depth, width, _] = thing.class.size_m;
    let half = [(depth * cos + width * sin) / 2.0, (depth * sin + width * cos) / 2.0];
    (at_m[0] - x).abs() < half[0] + ANCHOR_RADIUS_M
        && (at_m[1] - y).abs() < half[1] + ANCHOR_RADIUS_M
        && (at_m[2] - z).abs() < 0.02
}
