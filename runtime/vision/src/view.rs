//! Where a camera stands and looks: on the free floor of a room, at any height, at something in it or anywhere.

use std::f32::consts::{PI, TAU};

use cohabit_cdf::{Layout, RoomId};
use cohabit_generate::Chance;
use cohabit_render::{Camera, Lens};
use cohabit_world::{ObjectView, Vec2, Vec3, World};

/// Places that are tried.
const TRIES: usize = 60;
/// The share of views that are of something, and of those the share of things that were placed or changed.
const AIMED: f64 = 0.75;
const AT_PLACED: f64 = 0.7;
/// How high the eye is, and from how far it looks at something, m.
const HEIGHT_M: [f32; 2] = [0.4, 2.0];
const AWAY_M: [f32; 2] = [0.5, 3.5];
/// How far a view of something is off its middle, to the sides and up and down, rad.
const OFF_RAD: [f32; 2] = [0.3, 0.2];
/// How far up other views look, and any view at all, rad.
const PITCH_RAD: [f32; 2] = [-0.6, 0.2];
const STEEPEST_RAD: f32 = 1.2;
/// How far the eye is from the box around anything, m.
const CLEAR_M: f32 = 0.12;

/// Draws a camera that stands free; none if no such place was found.
pub(crate) fn draw(world: &World, room: RoomId, lens: Lens, chance: &mut Chance) -> Option<Camera> {
    let targets = Targets::of(world, room);
    for _ in 0..TRIES {
        let is_aimed = chance.is(AIMED);
        let target = if is_aimed { targets.pick(chance) } else { None };
        let drawn = match target {
            Some(target) => Some(towards(target, chance)),
            None => anywhere(world.layout(), room, chance),
        };
        let Some(view) = drawn.filter(|view| view.is_free(world, room)) else { continue };
        let camera = Camera::fixed(lens, view.eye.to_array(), view.yaw_rad, view.pitch_rad);
        // Exactly what is there: no outlines, no edges that are of two things.
        return Some(Camera { for_people: false, ..camera });
    }
    None
}

/// The middles of what can be looked at, m.
struct Targets {
    /// What was placed, or whose state was drawn.
    placed: Vec<Vec3>,
    all: Vec<Vec3>,
}

impl Targets {
    fn of(world: &World, room: RoomId) -> Self {
        let (mut placed, mut all) = (Vec::new(), Vec::new());
        for object in world.objects().filter(|object| object.room == room && !object.hidden) {
            let middle = object.position_m + object.rotation * Vec3::Z * (size_m(world, &object).z / 2.0);
            all.push(middle);
            if object.in_mission {
                placed.push(middle);
            }
        }
        Self { placed, all }
    }

    fn pick(&self, chance: &mut Chance) -> Option<Vec3> {
        let from = if chance.is(AT_PLACED) { &self.placed } else { &self.all };
        chance.pick(from).copied()
    }
}

struct View {
    eye: Vec3,
    yaw_rad: f32,
    pitch_rad: f32,
}

impl View {
    /// Whether the eye is in the room, above floor that can be walked on, and in nothing.
    fn is_free(&self, world: &World, room: RoomId) -> bool {
        let floor = self.eye.truncate();
        world.layout().room_at(floor.x, floor.y) == Some(room)
            && world.is_walkable(floor)
            && !world.objects().any(|object| world.exists(object.id) && surrounds(world, &object, self.eye))
    }
}

/// Looks at a point from around it.
fn towards(target: Vec3, chance: &mut Chance) -> View {
    let angle_rad = chance.between(-PI, PI);
    let away_m = chance.between(AWAY_M[0], AWAY_M[1]);
    let floor = target.truncate() - Vec2::new(libm::cosf(angle_rad), libm::sinf(angle_rad)) * away_m;
    let eye = floor.extend(chance.between(HEIGHT_M[0], HEIGHT_M[1]));
    let pitch_rad = libm::atan2f(target.z - eye.z, away_m) + chance.between(-OFF_RAD[1], OFF_RAD[1]);
    View {
        eye,
        yaw_rad: angle_rad + chance.between(-OFF_RAD[0], OFF_RAD[0]),
        pitch_rad: pitch_rad.clamp(-STEEPEST_RAD, STEEPEST_RAD),
    }
}

/// Looks anywhere from anywhere in the room.
fn anywhere(layout: &Layout, room: RoomId, chance: &mut Chance) -> Option<View> {
    let [west, south, east, north] = *chance.pick(&layout.room(room)?.rects_m)?;
    let floor = Vec2::new(chance.between(west, east), chance.between(south, north));
    Some(View {
        eye: floor.extend(chance.between(HEIGHT_M[0], HEIGHT_M[1])),
        yaw_rad: chance.between(0.0, TAU),
        pitch_rad: chance.between(PITCH_RAD[0], PITCH_RAD[1]),
    })
}

/// Whether a point is in the box around an object, or too near to it.
fn surrounds(world: &World, object: &ObjectView<'_>, point: Vec3) -> bool {
    let size = size_m(world, object);
    let local = object.rotation.inverse() * (point - object.position_m);
    local.x.abs() < size.x / 2.0 + CLEAR_M
        && local.y.abs() < size.y / 2.0 + CLEAR_M
        && local.z > -CLEAR_M
        && local.z < size.z + CLEAR_M
}

/// The extent of an object along its own axes, m.
fn size_m(world: &World, object: &ObjectView<'_>) -> Vec3 {
    Vec3::from_array(world.catalog().class(object.class).size_m) * Vec3::from_array(object.scale)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use cohabit_cdf::Catalog;

    use super::*;
    use crate::arrange::Arrangement;

    #[test]
    fn eyes_stand_free_in_their_rooms() {
        let catalog = Arc::new(Catalog::builtin());
        let layout = Arc::new(Layout::builtin("OfficeLayout1").unwrap());
        let lens = Lens::new(64, 64, 60.0).unwrap();
        let mut found = 0;
        for stream in 0..6 {
            let mut chance = Chance::new(11, stream);
            let Arrangement { room, mission, seed } = Arrangement::draw(&catalog, &layout, &mut chance);
            let world = World::new(Arc::clone(&catalog), Arc::clone(&layout), Arc::new(mission), seed);
            let Ok(world) = world else { continue };
            let Some(camera) = draw(&world, room, lens, &mut chance) else { continue };
            found += 1;
            let [x, y, z] = camera.position_m;
            assert_eq!(layout.room_at(x, y), Some(room));
            assert!(world.is_walkable(Vec2::new(x, y)) && (HEIGHT_M[0]..=HEIGHT_M[1]).contains(&z));
            let eye = Vec3::new(x, y, z);
            let around = world.objects().filter(|object| world.exists(object.id));
            assert_eq!(around.filter(|object| surrounds(&world, object, eye)).count(), 0);
        }
        assert!(found >= 3, "{found}");
    }
}
