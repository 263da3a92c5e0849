//! The floor that a body can walk on: the mesh, paths over it, and where to stand to reach something.

use cohabit_cdf::{ObjectId, Property, RoomId, StateFlag, catalog::Stands};
use glam::Vec2;
use polyanya::{Mesh, Triangulation};

use crate::{
    body::RADIUS_M,
    entity::Support,
    facts::Facts,
    geometry::{Footprint, GRID_M, direction},
    push::is_pushable,
};

/// How far, level, a body stands at most from what it was sent to, m.
const STAND_WITHIN_M: f32 = 1.3;
/// How far a body may be off the mesh (beside a corner, after a push) and still find back, m.
const SNAP_M: f32 = 0.6;
/// What is lower than this is stepped over, m.
const STEP_OVER_M: f32 = 0.1;
/// What begins higher than this is walked under, m.
const WALK_UNDER_M: f32 = 1.0;
/// Added to the radius of a body on the mesh, so that rounding never makes a path touch.
const MARGIN_M: f32 = 0.005;

/// The walkable floor at one moment.
pub(crate) struct Navigation {
    mesh: Mesh,
    blockers: Blockers,
    /// The floors of the rooms, `[west, south, east, north]`, m: the mesh goes on outside.
    rooms: Vec<[f32; 4]>,
    /// Whether bodies push open doors and drawers of furniture aside on it.
    pushes_leaves: bool,
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

/// A place to stand at, and the way there.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Approach {
    pub path: Vec<Vec2>,
    /// Whether what was asked for cannot be reached from there.
    pub alternate: bool,
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
        let between_rooms = |id: &ObjectId| facts.floor.gaps.iter().any(|gap| gap.door_object == Some(*id));
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

    /// The way to a point; to one nearby, if it is taken.
    pub fn approach_point(&self, from: Vec2, to: Vec2) -> Option<Approach> {
        const NEARBY_M: f32 = 1.0;
        let end = self.snap(to, NEARBY_M)?;
        let (path, _) = self.path(from, end)?;
        Some(Approach { path, alternate: end.distance(to) > 0.05 })
    }

    /// The way into a room: to its first named viewpoint that can be reached, else to its middle.
    pub fn approach_room(&self, facts: &Facts<'_>, from: Vec2, room: RoomId, viewpoints: &[Vec2]) -> Option<Approach> {
        let middles = facts
            .floor
            .rects(room)
            .map(|[west, south, east, north]| Vec2::new((west + east) / 2.0, (south + north) / 2.0));
        viewpoints.iter().copied().chain(middles).find_map(|point| {
            let approach = self.approach_point(from, point)?;
            let end = approach.path.last().copied()?;
            (facts.floor.room_at(end) == Some(room)).then_some(Approach { alternate: false, ..approach })
        })
    }

    /// The way to a place from which `object` is in reach, in front of it and in sight if possible.
    pub fn approach_object(&self, facts: &Facts<'_>, from: Vec2, object: ObjectId) -> Option<Approach> {
        let sweep = Sweep::before(facts, object);
        let cost = |place| place_cost(facts, object, place) + sweep.cost(place);
        let mut places: Vec<(f32, Vec2)> = standing_places(facts, object)
            .filter(|place| self.is_walkable(*place) && self.is_before(facts, object, *place))
            .map(|place| (cost(place), place))
            .collect();
        let near = !self.is_walkable(from) || facts.reach_to(object, from) < STAND_WITHIN_M;
        if near && self.is_before(facts, object, from) {
            places.push((cost(from), from));
        }
        // No way is shorter than the straight line: the best place is found long before all are tried.
        const WAY_COST: f32 = 0.3;
        let mut bounded: Vec<(f32, f32, Vec2)> =
            places.into_iter().map(|(cost, place)| (cost + from.distance(place) * WAY_COST, cost, place)).collect();
        bounded.sort_by(|one, two| one.0.total_cmp(&two.0));
        let mut best: Option<(f32, Vec<Vec2>)> = None;
        for (bound, cost, place) in bounded {
            if best.as_ref().is_some_and(|(least, _)| bound >= *least) {
                break;
            }
            let Some((path, length)) = self.path(from, place) else { continue };
            let total = cost + length * WAY_COST;
            if best.as_ref().is_none_or(|(least, _)| total < *least) {
                best = Some((total, path));
            }
        }
        let (_, path) = best?;
        Some(Approach { path, alternate: false })
    }

    /// Whether nothing stands between a place and an object, or nothing that does not swing aside for who stands there.
    fn is_before(&self, facts: &Facts<'_>, object: ObjectId, place: Vec2) -> bool {
        let mut around = std::iter::once(object).chain(facts.state.ancestors(object));
        let swings_aside = self.pushes_leaves
            && around.any(|id| facts.leaves_at(id, 1.0).any(|leaf| leaf.print.distance(place) < RADIUS_M));
        swings_aside || !facts.walled_off(object, place)
    }
}

/// A point, and points around it in rings further and further out.
fn rings(middle: Vec2, within: f32) -> impl Iterator<Item = Vec2> {
    const RING_M: f32 = 0.05;
    const SPOKES: u32 = 24;
    let rings = (within / RING_M) as u32;
    let around = (1..=rings).flat_map(|ring| (0..SPOKES).map(move |spoke| (ring, spoke))).map(move |(ring, spoke)| {
        let angle = spoke as f32 * (std::f32::consts::TAU / SPOKES as f32);
        middle + direction(angle) * (ring as f32 * RING_M)
    });
    std::iter::once(middle).chain(around)
}

/// Points around an object where a body could stand to reach it.
fn standing_places<'a>(facts: &'a Facts<'a>, object: ObjectId) -> impl Iterator<Item = Vec2> + 'a {
    const SPOKES: u32 = 32;
    const RINGS_M: [f32; 6] = [0.35, 0.5, 0.65, 0.8, 1.0, 1.2];
    let print = facts.footprint(object);
    let aim = facts.aim_point(object).truncate();
    let around = (0..SPOKES).flat_map(move |spoke| {
        let away = direction(spoke as f32 * (std::f32::consts::TAU / SPOKES as f32));
        let rim = print.closest(print.center + away * 10.0);
        RINGS_M.into_iter().flat_map(move |ring| [aim + away * ring, rim + away * ring])
    });
    // Before a wide front there is more than the spokes from its middle find.
    let along = (-4_i8..=4).flat_map(move |side| {
        RINGS_M
            .into_iter()
            .map(move |ring| print.world(Vec2::new(print.half.x + ring, print.half.y * f32::from(side) / 4.0)))
    });
    around.chain(along).filter(move |place| facts.reach_to(object, *place) <= STAND_WITHIN_M)
}

/// The space that doors and drawers of an object take as they open.
pub(crate) struct Sweep(Vec<Footprint>);

impl Sweep {
    /// That of an object.
    pub fn of(facts: &Facts<'_>, id: ObjectId) -> Self {
        const STAGES: u8 = 8;
        let stages = (0..=STAGES).flat_map(|stage| facts.leaves_at(id, f32::from(stage) / f32::from(STAGES)));
        Self(stages.filter(|leaf| leaf.low_m < WALK_UNDER_M).map(|leaf| leaf.print).collect())
    }

    /// That of all around an object that is still to be opened.
    fn before(facts: &Facts<'_>, object: ObjectId) -> Self {
        let around = std::iter::once(object).chain(facts.state.ancestors(object));
        let shut = around.filter(|id| facts.has(*id, Property::Openable) && !facts.is(*id, StateFlag::Opened));
        Self(shut.flat_map(|id| Self::of(facts, id).0).collect())
    }

    /// How far a point is from it, m; far, if nothing swings.
    pub fn distance(&self, point: Vec2) -> f32 {
        self.0.iter().map(|print| print.distance(point)).fold(f32::MAX, f32::min)
    }

    /// What it costs to stand in it, in metres of way.
    fn cost(&self, place: Vec2) -> f32 {
        if self.distance(place) < RADIUS_M + MARGIN_M { 2.0 } else { 0.0 }
    }
}

/// How poor a place is to work on an object from, in metres of way.
fn place_cost(facts: &Facts<'_>, object: ObjectId, place: Vec2) -> f32 {
    const GOOD_DISTANCE_M: f32 = 0.75;
    // What an object stands in decides the side to come from.
    let front =
        facts.state.ancestors(object).find(|parent| !facts.has(*parent, Property::Pickupable)).unwrap_or(object);
    let faced = facts.footprint(front);
    let out = (place - faced.closest(place)).normalize_or_zero();
    let has_front = !facts.has(front, Property::Pickupable);
    let side = if has_front { 1.0 - out.dot(faced.axis) } else { 0.0 };
    let distance = facts.aim_point(object).truncate().distance(place);
    (distance - GOOD_DISTANCE_M).abs() * 1.5 + side * if needs_front(facts, front) { 3.0 } else { 0.4 }
}

/// Whether it can only be worked from its front.
fn needs_front(facts: &Facts<'_>, object: ObjectId) -> bool {
    let class = facts.class(object);
    class.has(Property::Openable) || class.has(Property::Toggleable) || class.stands == Stands::OnWall
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
    let between_rooms = facts.floor.gaps.iter().any(|gap| gap.door_object == Some(id));
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
