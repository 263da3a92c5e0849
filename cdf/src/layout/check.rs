//! What is wrong with a floor plan, beyond its syntax: a plan without faults can be lived and worked in.

use std::collections::HashSet;

use super::footprint::{Footprint, is_clear_of_walls};
use super::{FreeFloor, Layout, Opening, OpeningKind, Placement, Room, RoomId};
use crate::catalog::{Catalog, ObjectClass, Property};
use crate::model::Axis;

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
/// Radius of the robot, m.
const ROBOT_RADIUS_M: f32 = 0.25;
/// Half the width of what stands on an anchor, m.
const ANCHOR_RADIUS_M: f32 = 0.06;
/// Viewpoints a room has.
const VIEWPOINTS: u8 = 8;
/// Places for sticky notes a room has at least.
const NOTE_PLACES: usize = 4;

/// Something wrong with a floor plan.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LayoutFault {
    /// No class fits the instance id.
    #[error("`{instance}` is of no class in the catalogue")]
    UnknownClass {
        /// The instance.
        instance: String,
    },
    /// Two placements share an id.
    #[error("`{instance}` is placed twice")]
    Repeated {
        /// The instance.
        instance: String,
    },
    /// An object reaches into a wall or out of its room.
    #[error("`{instance}` leaves {room:?}")]
    OutsideRoom {
        /// The instance.
        instance: String,
        /// Its room.
        room: RoomId,
    },
    /// Two objects fill the same space.
    #[error("`{instance}` overlaps `{other}`")]
    Overlap {
        /// One.
        instance: String,
        /// The other.
        other: String,
    },
    /// A gap is not in a wall that its two rooms share, or a window not in an outside wall of its one room.
    #[error("the {kind:?} at {at_m:?} is in no wall between {between:?}")]
    OpeningOffWall {
        /// The gap's kind.
        kind: OpeningKind,
        /// Its middle.
        at_m: [f32; 2],
        /// Its rooms.
        between: [RoomId; 2],
    },
    /// An object stands in the way before a door or passage, or hangs in a window.
    #[error("`{instance}` blocks the {kind:?} at {at_m:?}")]
    BlocksOpening {
        /// The instance.
        instance: String,
        /// The gap's kind.
        kind: OpeningKind,
        /// Its middle.
        at_m: [f32; 2],
    },
    /// An object that does something cannot be walked up to.
    #[error("no walkway leads to `{instance}`")]
    Unreachable {
        /// The instance.
        instance: String,
    },
    /// What stands on a receptacle leaves less than half of its anchors.
    #[error("`{instance}` has {taken} of its {anchors} anchors taken")]
    Crowded {
        /// The receptacle.
        instance: String,
        /// Anchors covered or used.
        taken: usize,
        /// Anchors it has.
        anchors: usize,
    },
    /// An object's `works` or `on` names nothing in its room.
    #[error("`{instance}` names `{other}`, which is not in its room")]
    LooseLink {
        /// The instance.
        instance: String,
        /// What it names.
        other: String,
    },
    /// A viewpoint is missing, or not on free floor of its room.
    #[error("viewpoint {number} of {room:?} is not on floor that can be walked to")]
    Viewpoint {
        /// The room.
        room: RoomId,
        /// Its number.
        number: u8,
    },
    /// A room has too few places for notes, or one of them is not on a wall.
    #[error("{room:?} needs {NOTE_PLACES} places for notes, on its walls")]
    NotePlaces {
        /// The room.
        room: RoomId,
    },
}

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
                None => faults.push(LayoutFault::UnknownClass { instance }),
                Some(class) => {
                    let class = catalog.class(class);
                    solids.push(Solid { placement, class, print: Footprint::of(self, placement, class) });
                }
            }
        }
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

    fn check_links(&self, faults: &mut Vec<LayoutFault>) {
        for placement in &self.placements {
            for other in [&placement.on, &placement.works].into_iter().flatten() {
                if self.placement(other).is_none_or(|found| found.room != placement.room) {
                    let instance = placement.instance.clone();
                    faults.push(LayoutFault::LooseLink { instance, other: other.clone() });
                }
            }
        }
    }

    fn check_openings(&self, faults: &mut Vec<LayoutFault>) {
        for opening in &self.openings {
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
            let fits = self.room(*room).is_some_and(|room| solid.print.fits(room, margin_m));
            let is_low = solid.print.height_m[1] <= self.wall_height_m + SLACK_M;
            if !fits || !is_low {
                faults.push(LayoutFault::OutsideRoom { instance: instance.clone(), room: *room });
            }
        }
    }

    fn check_floor(&self, catalog: &Catalog, solids: &[Solid<'_>], faults: &mut Vec<LayoutFault>) {
        let walkways = FreeFloor::new(self, catalog, WALKWAY_RADIUS_M);
        for solid in solids.iter().filter(|solid| solid.is_operable() && solid.placement.on.is_none()) {
            let near = |(room, point): (RoomId, [f32; 2])| {
                room == solid.placement.room && solid.print.distance_m(point) <= REACH_M
            };
            if !walkways.points_m().any(near) && !self.is_door(solid.placement) {
                faults.push(LayoutFault::Unreachable { instance: solid.placement.instance.clone() });
            }
        }
        let standing = FreeFloor::new(self, catalog, ROBOT_RADIUS_M);
        for room in &self.rooms {
            for number in 1..=VIEWPOINTS {
                let view = self.viewpoints.iter().find(|view| (view.room, view.number) == (room.id, number));
                if !view.is_some_and(|view| room.has(view.at_m[0], view.at_m[1]) && standing.has(view.at_m)) {
                    faults.push(LayoutFault::Viewpoint { room: room.id, number });
                }
            }
        }
    }

    fn check_notes(&self, faults: &mut Vec<LayoutFault>) {
        for room in &self.rooms {
            let places = self.note_places.iter().filter(|note| note.room == room.id);
            let is_on_wall = |[x, y, _]: [f32; 3]| {
                is_clear_of_walls(room, [x, y], HALF_WALL_M) && !is_clear_of_walls(room, [x, y], HALF_WALL_M + 0.05)
            };
            let are_on_walls = places.clone().all(|note| is_on_wall(note.at_m));
            if places.count() < NOTE_PLACES || !are_on_walls {
                faults.push(LayoutFault::NotePlaces { room: room.id });
            }
        }
    }
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
