//! The floor that a body can walk on: the mesh, paths over it, and where to stand to reach something.

use cohabit_cdf::{ObjectId, Property, RoomId, StateFlag, catalog::Stands};
use glam::Vec2;
use polyanya::{Mesh, Triangulation};

use crate::{
    body::RADIUS_M,
    entity::Support,
    facts::Facts,
    geometry::{Footprint, GRID_M, direction},
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
    /// All that stands on the floor, walls too.
    pub obstacles: Vec<Footprint>,
    /// The floor's version that this is of.
    pub version: u64,
    /// Area a body's middle can be on, grown by its radius, m².
    pub area_m2: f64,
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
        let obstacles = obstacles(facts);
        let [west, south, east, north] = facts.floor.bounds.map(|edge| (edge / GRID_M).round() * GRID_M);
        let corners = [(west, south), (east, south), (east, north), (west, north)];
        let mut triangulation = Triangulation::from_outer_edges(&corners.map(|(x, y)| Vec2::new(x, y)));
        triangulation.add_obstacles(obstacles.iter().map(|print| print.inflated(RADIUS_M + MARGIN_M)));
        let mut mesh = triangulation.as_navmesh();
        let area_m2 = walkable_area(&mesh, facts);
        mesh.merge_polygons();
        mesh.set_search_delta(0.001);
        mesh.bake();
        Self { mesh, obstacles, version: facts.state.floor_version, area_m2 }
    }

    /// Whether the middle of a body may be at `point`.
    pub fn is_walkable(&self, point: Vec2) -> bool {
        self.mesh.point_in_mesh(point)
    }

    /// Whether a body at `point` touches nothing that stands on the floor.
    pub fn is_clear(&self, point: Vec2) -> bool {
        self.obstacles.iter().all(|print| print.distance(point) >= RADIUS_M)
    }

    /// The walkable point nearest to `point`, no further than `within` m.
    pub fn snap(&self, point: Vec2, within: f32) -> Option<Vec2> {
        const RING_M: f32 = 0.05;
        const SPOKES: u32 = 24;
        if self.is_walkable(point) {
            return Some(point);
        }
        let rings = (within / RING_M) as u32;
        (1..=rings)
            .flat_map(|ring| (0..SPOKES).map(move |spoke| (ring, spoke)))
            .map(|(ring, spoke)| {
                let angle = spoke as f32 * (std::f32::consts::TAU / SPOKES as f32);
                point + direction(angle) * (ring as f32 * RING_M)
            })
            .find(|candidate| self.is_walkable(*candidate))
    }

    /// The way between two points and its length, m; both may be a little off the mesh.
    pub fn path(&self, from: Vec2, to: Vec2) -> Option<(Vec<Vec2>, f32)> {
        let start = self.snap(from, SNAP_M)?;
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
        let mut places: Vec<(f32, Vec2)> = standing_places(facts, object)
            .filter(|place| self.is_walkable(*place) && !facts.walled_off(object, *place))
            .map(|place| (place_cost(facts, object, place), place))
            .collect();
        if !self.is_walkable(from) || facts.reach_to(object, from) < STAND_WITHIN_M {
            places.push((place_cost(facts, object, from), from));
        }
        let (_, path) = places
            .into_iter()
            .filter(|(_, place)| *place != from || !facts.walled_off(object, from))
            .filter_map(|(cost, place)| self.path(from, place).map(|(path, length)| (cost + length * 0.3, path)))
            .min_by(|one, two| one.0.total_cmp(&two.0))?;
        Some(Approach { path, alternate: false })
    }
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

/// All that a body cannot walk through now: walls, locked doors, and what stands on the floor.
fn obstacles(facts: &Facts<'_>) -> Vec<Footprint> {
    let shut_doors = facts.floor.gaps.iter().filter(|gap| {
        gap.door_object.is_some_and(|door| {
            facts.object(door).exists() && facts.is(door, StateFlag::Locked) && !facts.is(door, StateFlag::Opened)
        })
    });
    let doors: Vec<ObjectId> = facts.floor.gaps.iter().filter_map(|gap| gap.door_object).collect();
    let furniture = facts
        .state
        .existing()
        .map(|(id, _)| id)
        .filter(|id| !doors.contains(id) && blocks_the_way(facts, *id))
        .map(|id| facts.footprint(id));
    facts.floor.walls.iter().copied().chain(shut_doors.map(|gap| gap.print)).chain(furniture).collect()
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
