//! The floor that a body can walk on: what blocks it, the mesh that is left, and paths over it. Never knows what a
//! path is for.

use cohabit_cdf::{ObjectId, Property, StateFlag, catalog::Stands};
use glam::Vec2;
use polyanya::{Mesh, Triangulation};

use crate::{
    body::RADIUS_M,
    entity::Support,
    facts::Facts,
    geometry::{Footprint, GRID_M, direction},
    pushable::is_pushable,
};

/// How far a body may be off the mesh (beside a corner, after a push) and still find back, m.
const SNAP_M: f32 = 0.6;
/// What is lower than this is stepped over, m.
const STEP_OVER_M: f32 = 0.1;
/// What begins higher than this is walked under, m.
pub(crate) const WALK_UNDER_M: f32 = 1.0;
/// Added to the radius of a body on the mesh, so that rounding never makes a path touch.
pub(crate) const MARGIN_M: f32 = 0.005;

/// The walkable floor at one moment.
pub(crate) struct Navigation {
    mesh: Mesh,
    blockers: Blockers,
    /// The floors of the rooms, `[west, south, east, north]`, m: the mesh goes on outside.
    rooms: Vec<[f32; 4]>,
    /// Whether bodies push open doors and drawers of furniture aside on it.
    pub pushes_leaves: bool,
    /// The floor's version that this is of.
    pub version: u64,
    /// Area a body's middle can be on, grown by its radius, m².
    pub area_m2: f64,
}

/// All that the mesh leaves out.
#[derive(Clone, Debug, PartialEq)]
struct Blockers {
    /// What stands fast, and the walls, which are no object.
    fast: Vec<(Footprint, Option<ObjectId>)>,
    /// What can be pushed.
    pushable: Vec<Footprint>,
    /// Open doors and drawers.
    leaves: Vec<Footprint>,
    /// What has doors or drawers that a body could run into.
    swinging: Vec<ObjectId>,
}

impl Blockers {
    fn of(facts: &Facts<'_>) -> Self {
        let mut blockers = Self::but_for_locks(facts);
        blockers.fast.extend(locked_doors(facts).map(|(door, print)| (print, Some(door))));
        blockers
    }

    /// The same, were no door locked.
    fn but_for_locks(facts: &Facts<'_>) -> Self {
        let swinging: Vec<ObjectId> =
            facts.state.existing().map(|(id, _)| id).filter(|id| swings_at_body_height(facts, *id)).collect();
        let (pushable, mut fast) = standing(facts);
        fast.extend(facts.floor.walls.iter().map(|wall| (*wall, None)));
        let leaves = swinging.iter().flat_map(|id| resting_leaves(facts, *id)).collect();
        Self { fast, pushable, leaves, swinging }
    }

    fn all(&self) -> impl Iterator<Item = &Footprint> {
        self.fast.iter().map(|(print, _)| print).chain(&self.pushable).chain(&self.leaves)
    }
}

impl Navigation {
    /// Works out the walkable floor.
    pub fn new(facts: &Facts<'_>) -> Self {
        Self::over(facts, Blockers::of(facts), &[])
    }

    /// Brings it up to date; the mesh stays, if nothing came into the way or went out of it.
    pub fn renew(&mut self, facts: &Facts<'_>) {
        let blockers = Blockers::of(facts);
        if blockers == self.blockers {
            self.version = facts.state.floor_version;
        } else {
            *self = Self::over(facts, blockers, &[]);
        }
    }

    /// The floor as it would be if no door were locked; `None` if none is.
    pub fn but_for_locks(facts: &Facts<'_>) -> Option<Self> {
        locked_doors(facts).next()?;
        Some(Self::over(facts, Blockers::but_for_locks(facts), &[]))
    }

    /// The floor as it would be if the open doors and drawers of furniture were pushed aside; `None` if none is open.
    pub fn but_for_leaves(facts: &Facts<'_>) -> Option<Self> {
        let mut blockers = Blockers::of(facts);
        let between_rooms = |id: &ObjectId| facts.is_room_door(*id);
        let doors = blockers.swinging.iter().filter(|id| between_rooms(id));
        let hard: Vec<Footprint> = doors.flat_map(|id| resting_leaves(facts, *id)).collect();
        if hard.len() == blockers.leaves.len() {
            return None;
        }
        blockers.leaves = hard;
        Some(Self { pushes_leaves: true, ..Self::over(facts, blockers, &[]) })
    }

    /// A walkable floor with more that the middle of a body has to keep out of.
    pub fn around(facts: &Facts<'_>, closed: &[Vec<Vec2>]) -> Self {
        Self::over(facts, Blockers::of(facts), closed)
    }

    fn over(facts: &Facts<'_>, blockers: Blockers, closed: &[Vec<Vec2>]) -> Self {
        let [west, south, east, north] = facts.floor.bounds.map(|edge| (edge / GRID_M).round() * GRID_M);
        let corners = [(west, south), (east, south), (east, north), (west, north)];
        let mut triangulation = Triangulation::from_outer_edges(&corners.map(|(x, y)| Vec2::new(x, y)));
        let outlines = blockers.all().map(|print| print.inflated(RADIUS_M + MARGIN_M));
        triangulation.add_obstacles(outlines.chain(closed.iter().cloned()));
        let mut mesh = triangulation.as_navmesh();
        let area_m2 = walkable_area(&mesh, facts);
        mesh.merge_polygons();
        mesh.set_search_delta(0.001);
        mesh.bake();
        let rooms = facts.floor.all_rects().collect();
        Self { mesh, blockers, rooms, pushes_leaves: false, version: facts.state.floor_version, area_m2 }
    }

    /// The corners of all that the mesh leaves out, m.
    pub fn outlines(&self) -> impl Iterator<Item = [Vec2; 4]> + '_ {
        self.blockers.all().map(Footprint::corners)
    }

    /// What has doors or drawers that a body could run into.
    pub fn swinging(&self) -> &[ObjectId] {
        &self.blockers.swinging
    }

    /// Whether the middle of a body may be at `point`.
    pub fn is_walkable(&self, point: Vec2) -> bool {
        let inside = |[west, south, east, north]: &[f32; 4]| {
            point.x >= *west && point.x <= *east && point.y >= *south && point.y <= *north
        };
        self.rooms.iter().any(inside) && self.mesh.point_in_mesh(point)
    }

    /// What stands fast and a body of this radius that goes from one point to another comes closer to than it may (a
    /// wall is no object); one that is too close already may still part from it.
    pub fn barrier(&self, from: Vec2, to: Vec2, radius: f32) -> Option<Option<ObjectId>> {
        let met = self.blockers.fast.iter().find(|(print, _)| {
            let distance = print.distance(to);
            distance < radius && distance < print.distance(from)
        });
        met.map(|(_, object)| *object)
    }

    /// Whether something that stands fast reaches further into a rectangle than into the one it was.
    pub fn is_wedged(&self, was: &Footprint, is: &Footprint) -> bool {
        self.blockers.fast.iter().any(|(print, _)| print.penetration(is) > print.penetration(was) + 1e-4)
    }

    /// Whether a body can still walk along these points, as far as what stands on the floor goes.
    pub fn is_open(&self, way: &[Vec2]) -> bool {
        let kept = RADIUS_M - MARGIN_M;
        way.windows(2).all(|stretch| !self.blockers.all().any(|print| print.distance_to(stretch[0], stretch[1]) < kept))
    }

    /// The walkable point nearest to `point`, no further than `within` m.
    pub fn snap(&self, point: Vec2, within: f32) -> Option<Vec2> {
        rings(point, within).find(|candidate| self.is_walkable(*candidate))
    }

    /// The walkable point nearest to where a body is, with nothing in between.
    fn step_onto(&self, from: Vec2) -> Option<Vec2> {
        rings(from, SNAP_M).find(|point| {
            self.is_walkable(*point)
                && (*point == from || !self.blockers.fast.iter().any(|(print, _)| print.cut_by(from, *point)))
        })
    }

    /// The way between two points and its length, m; both may be a little off the mesh.
    pub fn path(&self, from: Vec2, to: Vec2) -> Option<(Vec<Vec2>, f32)> {
        let start = self.step_onto(from)?;
        let end = self.snap(to, RADIUS_M)?;
        let first = (start != from).then_some(start);
        if start.distance(end) < 1e-3 {
            return Some((first.into_iter().chain([end]).collect(), from.distance(end)));
        }
        let found = self.mesh.path(start, end)?;
        Some((first.into_iter().chain(found.path).collect(), found.length + from.distance(start)))
    }
}

/// A point, and points around it in rings further and further out.
pub(crate) fn rings(middle: Vec2, within: f32) -> impl Iterator<Item = Vec2> {
    const RING_M: f32 = 0.05;
    const SPOKES: u32 = 24;
    let rings = (within / RING_M) as u32;
    let around = (1..=rings).flat_map(|ring| (0..SPOKES).map(move |spoke| (ring, spoke))).map(move |(ring, spoke)| {
        let angle = spoke as f32 * (std::f32::consts::TAU / SPOKES as f32);
        middle + direction(angle) * (ring as f32 * RING_M)
    });
    std::iter::once(middle).chain(around)
}

/// Doors that are shut and locked, and the gaps that they shut.
fn locked_doors(facts: &Facts<'_>) -> impl Iterator<Item = (ObjectId, Footprint)> {
    facts.floor.gaps.iter().filter_map(move |gap| {
        let door = gap.door_object?;
        let locked =
            facts.object(door).exists() && facts.is(door, StateFlag::Locked) && !facts.is(door, StateFlag::Opened);
        locked.then_some((door, gap.print))
    })
}

/// What stands on the floor now: what can be pushed, and what cannot.
fn standing(facts: &Facts<'_>) -> (Vec<Footprint>, Vec<(Footprint, Option<ObjectId>)>) {
    let doors: Vec<ObjectId> = facts.floor.gaps.iter().filter_map(|gap| gap.door_object).collect();
    let on_the_move: Vec<ObjectId> =
        facts.state.bodies.iter().filter_map(|body| body.task.as_ref()).flat_map(|task| task.pushing.clone()).collect();
    let (mut pushable, mut fast) = (Vec::new(), Vec::new());
    for (id, _) in facts.state.existing() {
        if doors.contains(&id) || on_the_move.contains(&id) || !blocks_the_way(facts, id) {
            continue;
        }
        if is_pushable(facts, id) {
            pushable.push(facts.footprint(id));
        } else {
            fast.push((facts.footprint(id), Some(id)));
        }
    }
    (pushable, fast)
}

/// Whether an object has moving parts that a body could run into.
fn swings_at_body_height(facts: &Facts<'_>, id: ObjectId) -> bool {
    facts.leaves_at(id, 0.0).any(|leaf| leaf.low_m < WALK_UNDER_M)
}

/// The open doors and drawers of an object, once they rest; doors between rooms are opened in passing.
fn resting_leaves<'a>(facts: &Facts<'a>, id: ObjectId) -> impl Iterator<Item = Footprint> + 'a {
    let between_rooms = facts.is_room_door(id);
    let open = facts.is(id, StateFlag::Opened) || (between_rooms && !facts.is(id, StateFlag::Locked));
    let leaves = open.then(|| facts.leaves_at(id, 1.0)).into_iter().flatten();
    leaves.filter(|leaf| leaf.low_m < WALK_UNDER_M).map(|leaf| leaf.print)
}

/// Whether an object stands in the way of bodies.
pub(crate) fn blocks_the_way(facts: &Facts<'_>, id: ObjectId) -> bool {
    let object = facts.object(id);
    let base = object.pose.position.z;
    let top = base + facts.size(id).z;
    let placed = match object.support {
        Support::Fixed => true,
        Support::On { .. } => facts.class(id).stands == Stands::OnFloor,
        _ => false,
    };
    let live = facts.is(id, StateFlag::Sparking) && base < STEP_OVER_M;
    placed && !facts.has(id, Property::Pickupable) && base < WALK_UNDER_M && (top > STEP_OVER_M || live)
}

fn walkable_area(mesh: &Mesh, facts: &Facts<'_>) -> f64 {
    mesh.layers
        .iter()
        .flat_map(|layer| layer.polygons.iter().map(move |polygon| (layer, polygon)))
        .map(|(layer, polygon)| {
            let points: Vec<Vec2> =
                polygon.vertices.iter().map(|index| layer.vertices[*index as usize].coords).collect();
            let middle = points.iter().copied().sum::<Vec2>() / points.len() as f32;
            let twice: f64 =
                (0..points.len()).map(|at| f64::from(points[at].perp_dot(points[(at + 1) % points.len()]))).sum();
            if facts.floor.room_at(middle).is_some() { twice.abs() / 2.0 } else { 0.0 }
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Nothing that stands anywhere, flush, crossing or crooked, breaks the triangulation.
        #[test]
        fn any_clutter_gives_a_mesh(
            things in prop::collection::vec(((0_u32..40, 0_u32..40), (0.01_f32..1.5, 0.01_f32..1.5), 0_u32..16), 1..60),
            crooked in any::<bool>(),
        ) {
            let corners = [(0.0, 0.0), (20.0, 0.0), (20.0, 20.0), (0.0, 20.0)];
            let mut triangulation = Triangulation::from_outer_edges(&corners.map(|(x, y)| Vec2::new(x, y)));
            triangulation.add_obstacles(things.into_iter().map(|((x, y), half, turn)| {
                // Half of all furniture stands in line with the rest, some of it off by a rounding error.
                let yaw = if crooked { turn as f32 * 0.41 } else { turn as f32 * std::f32::consts::FRAC_PI_2 };
                let center = Vec2::new(x as f32 * 0.5, y as f32 * 0.5);
                Footprint::new(center, half.into(), yaw).inflated(RADIUS_M + MARGIN_M)
            }));
            let mut mesh = triangulation.as_navmesh();
            mesh.merge_polygons();
            mesh.bake();
            mesh.path(Vec2::new(0.1, 0.1), Vec2::new(19.9, 19.9));
        }
    }
}
