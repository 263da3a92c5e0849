//! What there is to see: a floor plan, and instances in it.

use std::sync::{Arc, RwLock};

use cohabit_cdf::layout::Layout;
use cohabit_cdf::model::When;
use cohabit_cdf::{Fluid, RoomId, StateFlag};
use glam::{Mat3, Quat, Vec3};

use crate::color;
use crate::instance::{Highlight, Instance, Look};
use crate::library::MeshLibrary;
use crate::mesh::Aabb;
use crate::plan::{HALF_WALL_M, Plan};
use crate::rig::Driver;
use crate::shadow::ShadowMap;

/// From an instance's frame, or a moving part's, to the world, and back.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Transform {
    pub rotation: Mat3,
    pub offset: Vec3,
    pub inverse: Mat3,
}

impl Transform {
    pub(crate) const IDENTITY: Self = Self { rotation: Mat3::IDENTITY, offset: Vec3::ZERO, inverse: Mat3::IDENTITY };

    fn new(rotation: Mat3, offset: Vec3) -> Self {
        let inverse = if rotation.determinant().abs() > 1e-12 { rotation.inverse() } else { Mat3::ZERO };
        Self { rotation, offset, inverse }
    }

    fn bounds(&self, own: Aabb) -> Aabb {
        own.corners().iter().fold(Aabb::EMPTY, |all, corner| all.with(self.rotation * *corner + self.offset))
    }
}

/// What states do to every surface of an instance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Weather {
    pub dirty: bool,
    pub cold: bool,
    pub infected: bool,
}

impl Weather {
    pub(crate) fn any(self) -> bool {
        self != Self::default()
    }
}

/// An instance, ready to be drawn.
#[derive(Clone, Debug)]
pub(crate) struct Placed {
    pub id: u32,
    pub model: usize,
    /// The body's, then each joint's.
    pub transforms: Vec<Transform>,
    /// Pieces shown, each with the transform that moves it.
    pub pieces: Vec<(u16, u16)>,
    pub center: Vec3,
    pub radius: f32,
    pub bounds: Aabb,
    /// Rooms it touches, as bits.
    pub rooms: u8,
    pub room: RoomId,
    pub tint: Vec3,
    pub fluid: Vec3,
    pub weather: Weather,
    pub casts_shadow: bool,
}

/// A floor plan and the instances in it.
#[derive(Debug)]
pub struct Scene {
    pub(crate) meshes: Arc<MeshLibrary>,
    pub(crate) plan: Plan,
    instances: Vec<Instance>,
    /// For each instance its body, and signs of its states; nothing while it is hidden.
    placed: Vec<Vec<Placed>>,
    pub(crate) lit: [bool; 8],
    pub(crate) highlights: Vec<Highlight>,
    /// Brought up to date by the first renderer that wants shadows after a change.
    pub(crate) shadows: RwLock<ShadowMap>,
}

impl Scene {
    /// An empty office: the layout's rooms and openings, no instances, all lamps on.
    #[must_use]
    pub fn new(meshes: Arc<MeshLibrary>, layout: &Layout) -> Self {
        let plan = Plan::new(layout);
        let shadows = RwLock::new(ShadowMap::new(plan.bounds));
        Self {
            meshes,
            plan,
            instances: Vec::new(),
            placed: Vec::new(),
            lit: [true; 8],
            highlights: Vec::new(),
            shadows,
        }
    }

    /// Takes over all instances, each time all of them, in an order that stays; costs little where little changed.
    pub fn set_instances(&mut self, instances: &[Instance]) {
        let shadows = self.shadows.get_mut().unwrap_or_else(std::sync::PoisonError::into_inner);
        for index in instances.len()..self.placed.len() {
            self.placed[index].iter().for_each(|placed| shadows.soil(placed.bounds));
        }
        self.placed.truncate(instances.len());
        self.instances.truncate(instances.len());
        for (index, instance) in instances.iter().enumerate() {
            if self.instances.get(index) == Some(instance) {
                continue;
            }
            let placed = place(&self.meshes, &self.plan, instance);
            placed.iter().for_each(|placed| shadows.soil(placed.bounds));
            match self.placed.get_mut(index) {
                Some(known) => {
                    known.iter().for_each(|placed| shadows.soil(placed.bounds));
                    *known = placed;
                    self.instances[index] = instance.clone();
                }
                None => {
                    self.placed.push(placed);
                    self.instances.push(instance.clone());
                }
            }
        }
    }

    /// Switches a room's lamps.
    pub fn set_lights(&mut self, room: RoomId, lit: bool) {
        self.lit[room as usize] = lit;
    }

    /// Takes over all highlights.
    pub fn set_highlights(&mut self, highlights: &[Highlight]) {
        self.highlights = highlights.to_vec();
    }

    /// Everything placed, in the order of the instances.
    pub(crate) fn placed(&self) -> impl Iterator<Item = &Placed> + Clone {
        self.placed.iter().flatten()
    }
}

fn place(meshes: &MeshLibrary, plan: &Plan, instance: &Instance) -> Vec<Placed> {
    if !instance.visible {
        return Vec::new();
    }
    let bodies = meshes.bodies();
    let (model, tint, needs_power, own_dirt) = match instance.look {
        Look::Object(class) => match meshes.class(class) {
            Some(look) => (look.model, look.tint, look.needs_power, look.own_dirt),
            None => return Vec::new(),
        },
        Look::Robot { .. } => (bodies.robot, color::from_srgb([232, 232, 228]), false, false),
        Look::Human { .. } => (bodies.human, human_tint(instance.id), false, false),
        Look::Note {} => (bodies.note, color::from_srgb([246, 222, 106]), false, false),
    };
    let mesh = meshes.model(model);
    let rotation = Quat::from_array(instance.rotation);
    let rotation = if rotation.length_squared() > 1e-6 { rotation.normalize() } else { Quat::IDENTITY };
    let scaled = Mat3::from_quat(rotation) * Mat3::from_diagonal(Vec3::from_array(instance.scale));
    let offset = Vec3::from_array(instance.position_m);
    let mut transforms = vec![Transform::new(scaled, offset)];
    for rig in &mesh.joints {
        let (turn, slide) = rig.moved(drive(instance, rig.driver));
        transforms.push(Transform::new(scaled * turn, scaled * slide + offset));
    }
    let mut pieces = Vec::new();
    for (index, piece) in mesh.levels[0].pieces.iter().enumerate() {
        if piece.when.is_none_or(|when| shown(when, instance, needs_power)) {
            pieces.push((index as u16, piece.joint.map_or(0, |joint| u16::from(joint) + 1)));
        }
    }
    let flags = instance.flags;
    let weather = Weather {
        dirty: flags.has(StateFlag::Dirty) && !own_dirt,
        cold: flags.has(StateFlag::Cold),
        infected: flags.has(StateFlag::Infected),
    };
    let bounds = transforms[0].bounds(mesh.reach);
    let body = finish(plan, instance, model, transforms, pieces, bounds);
    let body = Placed { tint: color::of_color(instance.color).unwrap_or(tint), weather, ..body };
    let mut all = vec![body];
    for (flag, sign) in [(StateFlag::Hot, bodies.steam), (StateFlag::Sparking, bodies.sparks)] {
        if flags.has(flag) {
            all.push(sign_over(meshes, plan, instance, sign, transforms_bounds(&all[0], mesh.bounds)));
        }
    }
    all
}

fn transforms_bounds(body: &Placed, own: Aabb) -> Aabb {
    body.transforms[0].bounds(own)
}

/// Steam or sparks above an instance's box.
fn sign_over(meshes: &MeshLibrary, plan: &Plan, instance: &Instance, sign: usize, over: Aabb) -> Placed {
    let mesh = meshes.model(sign);
    let wide = over.size().x.max(over.size().y).clamp(0.06, 0.5);
    let scale = Vec3::new(wide, wide, (wide * 0.9).clamp(0.08, 0.25));
    let foot = over.center().with_z(over.max.z);
    let transforms = vec![Transform::new(Mat3::from_diagonal(scale), foot)];
    let pieces = (0..mesh.levels[0].pieces.len()).map(|piece| (piece as u16, 0)).collect();
    let bounds = transforms[0].bounds(mesh.reach);
    Placed { casts_shadow: false, ..finish(plan, instance, sign, transforms, pieces, bounds) }
}

fn finish(
    plan: &Plan,
    instance: &Instance,
    model: usize,
    transforms: Vec<Transform>,
    pieces: Vec<(u16, u16)>,
    bounds: Aabb,
) -> Placed {
    let rect = [bounds.min.x, bounds.min.y, bounds.max.x, bounds.max.y];
    let touched = plan.rooms_touching(rect, HALF_WALL_M);
    Placed {
        id: instance.id,
        model,
        transforms,
        pieces,
        center: bounds.center(),
        radius: bounds.size().length() * 0.5,
        bounds,
        // What stands outside of all rooms is seen from everywhere.
        rooms: if touched == 0 { 0xFF } else { touched },
        room: instance.room,
        tint: Vec3::ONE,
        fluid: color::of_fluid(instance.fluid),
        weather: Weather::default(),
        casts_shadow: true,
    }
}

fn drive(instance: &Instance, driver: Driver) -> f32 {
    match (driver, instance.look) {
        (Driver::Opened, _) => instance.opened.clamp(0.0, 1.0),
        (Driver::Running, _) => instance.running.clamp(0.0, 1.0),
        (Driver::Head, Look::Robot { head_pitch_rad, .. }) => head_pitch_rad.clamp(-1.2, 1.2),
        (Driver::Arm, Look::Robot { arm, .. } | Look::Human { arm }) => arm.clamp(0.0, 1.0),
        (Driver::Head | Driver::Arm, _) => 0.0,
    }
}

fn shown(when: When, instance: &Instance, needs_power: bool) -> bool {
    let has = |flag| instance.flags.has(flag);
    let powered = !needs_power || has(StateFlag::Powered);
    match when {
        When::On => has(StateFlag::Toggled),
        When::Off => !has(StateFlag::Toggled),
        When::Broken => has(StateFlag::Broken),
        When::Whole => !has(StateFlag::Broken),
        When::Filled => instance.fluid != Fluid::None,
        When::Cereal => has(StateFlag::Cereal),
        When::Dirty => has(StateFlag::Dirty),
        When::Hot => has(StateFlag::Hot),
        When::Cold => has(StateFlag::Cold),
        When::Infected => has(StateFlag::Infected),
        When::Powered => powered,
        When::Unpowered => !powered,
        When::Cooked => has(StateFlag::Cooked),
        When::Raw => !has(StateFlag::Cooked),
        When::Eaten => has(StateFlag::Eaten),
        When::Uneaten => !has(StateFlag::Eaten),
    }
}

/// People's shirts, so that two are told apart.
fn human_tint(id: u32) -> Vec3 {
    const SHIRTS: [[u8; 3]; 6] =
        [[84, 122, 150], [168, 96, 74], [104, 138, 96], [196, 168, 96], [122, 100, 148], [208, 206, 198]];
    color::from_srgb(SHIRTS[id as usize % SHIRTS.len()])
}
