//! What there is to see: a floor plan, and instances in it.

use std::sync::{Arc, PoisonError, RwLock, RwLockReadGuard};

use cohabit_cdf::layout::Layout;
use cohabit_cdf::model::When;
use cohabit_cdf::room::MOST_ROOMS;
use cohabit_cdf::{Fluid, RoomId, StateFlag};
use glam::{Mat3, Quat, Vec3};

use crate::color;
use crate::instance::{Highlight, Instance, Look};
use crate::library::MeshLibrary;
use crate::mesh::Aabb;
use crate::placed::{Placed, Transform};
use crate::plan::{HALF_WALL_M, Plan};
use crate::pose::{self, Pose};
use crate::rig::{self, Drives};
use crate::shadow::ShadowMap;
use crate::signs::{SIGNS, Sign};
use crate::weather::Weather;

/// What is left of the light where the lamps are off.
const UNLIT: Vec3 = Vec3::new(0.13, 0.15, 0.20);

/// A floor plan and the instances in it.
#[derive(Debug)]
pub struct Scene {
    pub(crate) meshes: Arc<MeshLibrary>,
    pub(crate) plan: Arc<Plan>,
    instances: Vec<Instance>,
    /// For each instance its body, and signs of its states; nothing while it is hidden.
    placed: Vec<Placing>,
    /// Simulated time, ns.
    nanos: u64,
    /// By the index of rooms.
    pub(crate) lit: [bool; MOST_ROOMS],
    pub(crate) highlights: Vec<Highlight>,
    /// Brought up to date by the first renderer that wants shadows after a change.
    pub(crate) shadows: RwLock<ShadowMap>,
}

impl Scene {
    /// An empty office: the layout's rooms and openings, no instances, all lamps on.
    #[must_use]
    pub fn new(meshes: Arc<MeshLibrary>, layout: &Layout) -> Self {
        let plan = Arc::new(Plan::new(layout, meshes.rooms()));
        let shadows = RwLock::new(ShadowMap::new(plan.bounds));
        Self {
            meshes,
            plan,
            instances: Vec::new(),
            placed: Vec::new(),
            nanos: 0,
            lit: [true; MOST_ROOMS],
            highlights: Vec::new(),
            shadows,
        }
    }

    /// Takes over all instances, each time all of them, in an order that stays; costs little where little changed.
    pub fn set_instances(&mut self, instances: &[Instance]) {
        let shadows = self.shadows.get_mut().unwrap_or_else(PoisonError::into_inner);
        for placing in self.placed.iter().skip(instances.len()) {
            placing.soil(shadows);
        }
        self.placed.truncate(instances.len());
        self.instances.truncate(instances.len());
        for (index, instance) in instances.iter().enumerate() {
            if self.instances.get(index) == Some(instance) {
                continue;
            }
            let placing = place(&self.meshes, &self.plan, instance, self.nanos);
            placing.soil(shadows);
            match self.placed.get_mut(index) {
                Some(known) => {
                    known.soil(shadows);
                    *known = placing;
                    self.instances[index] = instance.clone();
                }
                None => {
                    self.placed.push(placing);
                    self.instances.push(instance.clone());
                }
            }
        }
    }

    /// Sets simulated time: what runs, steams or sparks moves with it. Costs nothing where nothing does.
    pub fn set_time(&mut self, nanos: u64) {
        if self.nanos == nanos {
            return;
        }
        self.nanos = nanos;
        // Shadows stay: nothing that moves with time alone casts one.
        for (placing, instance) in self.placed.iter_mut().zip(&self.instances).filter(|(placing, _)| placing.moves) {
            *placing = place(&self.meshes, &self.plan, instance, nanos);
        }
    }

    /// Switches a room's lamps.
    pub fn set_lights(&mut self, room: RoomId, lit: bool) {
        self.lit[usize::from(self.plan.index_of(room))] = lit;
    }

    /// Takes over all highlights.
    pub fn set_highlights(&mut self, highlights: &[Highlight]) {
        self.highlights = highlights.to_vec();
    }

    /// Whether anything looks different at another time.
    #[must_use]
    pub fn moves(&self) -> bool {
        self.placed.iter().any(|placing| placing.moves)
    }

    /// The light in a room, as a factor.
    pub(crate) fn light(&self, room: u8) -> Vec3 {
        if self.is_lit(room) { Vec3::ONE } else { UNLIT }
    }

    /// Whether the lamps of a room are on.
    pub(crate) fn is_lit(&self, room: u8) -> bool {
        self.lit[usize::from(room)]
    }

    /// The map of shadows, brought up to date.
    pub(crate) fn clean_shadows(&self) -> RwLockReadGuard<'_, ShadowMap> {
        // Who only reads never waits for others who do.
        let soiled = self.shadows.read().unwrap_or_else(PoisonError::into_inner).is_soiled();
        if soiled {
            let mut shadows = self.shadows.write().unwrap_or_else(PoisonError::into_inner);
            shadows.clean(&self.meshes, self.placed());
        }
        self.shadows.read().unwrap_or_else(PoisonError::into_inner)
    }

    /// Everything placed, in the order of the instances.
    pub(crate) fn placed(&self) -> impl Iterator<Item = &Placed> + Clone {
        self.placed.iter().flat_map(|placing| &placing.placed)
    }
}

/// What is drawn for an instance.
#[derive(Debug, Default)]
struct Placing {
    placed: Vec<Placed>,
    /// Whether it looks different at another time.
    moves: bool,
}

impl Placing {
    /// Has the shadows redrawn that it casts.
    fn soil(&self, shadows: &mut ShadowMap) {
        self.placed.iter().filter(|placed| placed.casts_shadow).for_each(|placed| shadows.soil(placed.bounds));
    }
}

/// What of a look decides how it is placed.
struct Figure {
    model: usize,
    tint: Vec3,
    needs_power: bool,
    pose: Option<Pose>,
    stretch: Vec3,
}

fn figure(meshes: &MeshLibrary, look: Look) -> Option<Figure> {
    let bodies = meshes.bodies();
    let plain = |model| Figure { model, tint: Vec3::ONE, needs_power: false, pose: None, stretch: Vec3::ONE };
    Some(match look {
        Look::Object(class) | Look::Gate { class, .. } => {
            let own = meshes.class(class)?;
            Figure { tint: own.tint, needs_power: own.needs_power, ..plain(own.model) }
        }
        Look::Robot { head_pitch_rad, arm, holds, rolled_m } => {
            let pose = Some(pose::robot(head_pitch_rad, arm, holds, rolled_m));
            Figure { tint: color::from_srgb([232, 232, 228]), pose, ..plain(bodies.robot) }
        }
        Look::Person { outfit, head_pitch_rad, arm, holds, walked_m, pace } => {
            let model = bodies.people[outfit as usize % bodies.people.len()];
            Figure { pose: Some(pose::person(head_pitch_rad, arm, holds, walked_m, pace)), ..plain(model) }
        }
        Look::Stream { height_m } => {
            Figure { stretch: Vec3::new(1.0, 1.0, height_m.clamp(0.01, 3.0)), ..plain(bodies.stream) }
        }
        Look::Note {} => Figure { tint: color::from_srgb([246, 222, 106]), ..plain(bodies.note) },
    })
}

fn place(meshes: &MeshLibrary, plan: &Plan, instance: &Instance, nanos: u64) -> Placing {
    let Some(figure) = figure(meshes, instance.look).filter(|_| instance.visible) else { return Placing::default() };
    let mesh = meshes.model(figure.model);
    let flags = instance.flags;
    let rotation = Quat::from_array(instance.rotation);
    let rotation = if rotation.length_squared() > 1e-6 { rotation.normalize() } else { Quat::IDENTITY };
    let scale = Vec3::from_array(instance.scale) * figure.stretch;
    let mut scaled = Mat3::from_quat(rotation) * Mat3::from_diagonal(scale);
    if flags.has(StateFlag::Broken) && !mesh.shows(When::Broken) {
        scaled *= slumped();
    }
    if flags.has(StateFlag::Eaten) && !mesh.shows(When::Eaten) {
        scaled *= Mat3::from_diagonal(LEFT_OVER);
    }
    let offset = Vec3::from_array(instance.position_m);
    let running = instance.running.clamp(0.0, 1.0);
    let drives = Drives { opened: instance.opened.clamp(0.0, 1.0), running, pose: figure.pose.as_ref(), nanos };
    let transforms: Vec<Transform> = std::iter::once(Transform::new(scaled, offset))
        .chain(
            rig::transforms(&mesh.joints, &drives)
                .into_iter()
                .map(|(turn, slide)| Transform::new(scaled * turn, scaled * slide + offset)),
        )
        .collect();
    let (mut still, mut moving) = (Vec::new(), Vec::new());
    for (index, piece) in mesh.levels[0].pieces.iter().enumerate() {
        if piece.when.is_none_or(|when| shown(when, instance, figure.needs_power)) {
            let cycles = piece.joint.is_some_and(|joint| rig::cycles(&mesh.joints, joint));
            let pieces = if cycles { &mut moving } else { &mut still };
            pieces.push((index as u16, piece.joint.map_or(0, |joint| u16::from(joint) + 1)));
        }
    }
    let bounds = transforms[0].bounds(mesh.reach);
    let weather = Weather {
        dirty: flags.has(StateFlag::Dirty) && !mesh.shows(When::Dirty),
        cold: flags.has(StateFlag::Cold),
        infected: flags.has(StateFlag::Infected),
    };
    let casts_shadow = !matches!(instance.look, Look::Stream { .. });
    let body = Placed {
        tint: color::of_color(instance.color).unwrap_or(figure.tint),
        weather,
        casts_shadow,
        ..finish(plan, instance, figure.model, transforms, still, bounds)
    };
    let mut all = Placing { placed: Vec::new(), moves: false };
    if !moving.is_empty() {
        // What never rests casts no shadow, or the map of shadows would never rest either.
        all.placed.push(Placed { pieces: moving, casts_shadow: false, ..body.clone() });
        all.moves = mesh.joints.iter().any(|rig| rig.cycle.is_some() && rig.is_driven(&drives));
    }
    all.placed.insert(0, body);
    signs_of(meshes, plan, instance, figure.model, nanos, &mut all);
    all
}

/// What is left of a thing that was eaten and has no looks for that.
const LEFT_OVER: Vec3 = Vec3::new(0.7, 0.7, 0.4);

/// How a thing stands that is broken and has no looks for that.
fn slumped() -> Mat3 {
    let (sin, cos) = libm::sincosf(0.14);
    let sunk = Mat3::from_diagonal(Vec3::new(1.0, 1.0, 0.86));
    Mat3::from_cols(Vec3::X, Vec3::new(0.0, cos, sin), Vec3::new(0.0, -sin, cos)) * sunk
}

/// Adds signs of the states that an instance's model does not show.
fn signs_of(meshes: &MeshLibrary, plan: &Plan, instance: &Instance, model: usize, nanos: u64, all: &mut Placing) {
    let (body, shows) = (&all.placed[0], meshes.model(model));
    let (turn, offset, tint) = (body.transforms[0].rotation, body.transforms[0].offset, body.tint);
    let over = body.transforms[0].bounds(shows.bounds);
    let needed = |sign: &Sign| instance.flags.has(sign.flag) && !sign.unless.is_some_and(|own| shows.shows(own));
    for (sign, frames) in SIGNS.iter().zip(&meshes.bodies().signs).filter(|(sign, _)| needed(sign)) {
        let model = frames[sign.frame(nanos)];
        let mesh = meshes.model(model);
        let (fit, foot) = sign.fit.place(shows.bounds, turn, offset, over);
        let drives = Drives { opened: 0.0, running: 1.0, pose: None, nanos };
        let joints = rig::transforms(&mesh.joints, &drives);
        let transforms: Vec<Transform> = std::iter::once(Transform::new(fit, foot))
            .chain(joints.into_iter().map(|(turn, slide)| Transform::new(fit * turn, fit * slide + foot)))
            .collect();
        let joint = |joint: Option<u8>| joint.map_or(0, |joint| u16::from(joint) + 1);
        let pieces = mesh.levels[0].pieces.iter().enumerate();
        let pieces = pieces.map(|(index, piece)| (index as u16, joint(piece.joint))).collect();
        let bounds = transforms[0].bounds(mesh.reach);
        all.moves |= frames.len() > 1 || mesh.joints.iter().any(|rig| rig.cycle.is_some());
        all.placed.push(Placed {
            tint,
            casts_shadow: false,
            ..finish(plan, instance, model, transforms, pieces, bounds)
        });
    }
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
    let room = plan.index_of(instance.room);
    Placed {
        id: instance.id,
        model,
        transforms,
        pieces,
        center: bounds.center(),
        radius: bounds.size().length() * 0.5,
        bounds,
        // What stands outside of all rooms is seen from everywhere.
        rooms: if touched == 0 { u64::MAX } else { touched },
        room,
        shadow_room: plan.shadow_room(room),
        tint: Vec3::ONE,
        fluid: color::of_fluid(instance.fluid),
        weather: Weather::default(),
        casts_shadow: true,
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
        When::Cut => has(StateFlag::Cut),
        When::Uncut => !has(StateFlag::Cut),
        When::Past => has(StateFlag::Toggled) && !leads_to_the_future(instance.look),
        When::Future => has(StateFlag::Toggled) && leads_to_the_future(instance.look),
        When::Neutral => !StateFlag::MOODS.into_iter().any(|mood| mood != StateFlag::Neutral && has(mood)),
        When::Happy => has(StateFlag::Happy),
        When::Sad => has(StateFlag::Sad),
        When::Angry => has(StateFlag::Angry),
        When::Scared => has(StateFlag::Scared),
    }
}

fn leads_to_the_future(look: Look) -> bool {
    matches!(look, Look::Gate { future: true, .. })
}
