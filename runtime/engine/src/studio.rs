//! Renders the newest moment of the world for those who watch, on a thread of its own, so that the world never waits.

use std::{
    sync::{Arc, Condvar, Mutex, PoisonError},
    time::{Duration, Instant},
};

use cohabit_bus::{
    BusError, CameraId, Publisher, Topic, Transport,
    message::{FrameHeader, FrameLayout, Plane},
    monotonic_nanos,
};
use cohabit_cdf::{Catalog, Layout};
use cohabit_render::{Camera, Instance, Look, MeshLibrary, Planes, Renderer, Scene};

use crate::{
    camera_rig::{CameraRig, Tall},
    scene::Moment,
};

/// Pixels of an egocentric frame, both ways.
const EGOCENTRIC_SIZE: u32 = 300;
/// The size of a frame for people.
pub const SPECTATOR_SIZE: [u32; 2] = [854, 480];
/// At most so often for people.
const SPECTATOR_EVERY: Duration = Duration::from_millis(33);
/// At most so often for a body.
const EGOCENTRIC_EVERY: Duration = Duration::from_millis(100);

/// Where the tick leaves moments and the studio takes them: holds one, the newest.
#[derive(Default)]
pub struct Desk {
    slot: Mutex<Slot>,
    changed: Condvar,
}

#[derive(Default)]
struct Slot {
    moment: Option<Moment>,
    closed: bool,
}

impl Desk {
    /// Leaves a moment; one that was not taken yet is dropped.
    pub fn leave(&self, moment: Moment) {
        self.slot.lock().unwrap_or_else(PoisonError::into_inner).moment = Some(moment);
        self.changed.notify_one();
    }

    /// Tells the studio to go home.
    pub fn close(&self) {
        self.slot.lock().unwrap_or_else(PoisonError::into_inner).closed = true;
        self.changed.notify_all();
    }

    fn take(&self) -> Option<Moment> {
        let slot = self.slot.lock().unwrap_or_else(PoisonError::into_inner);
        let wait = self.changed.wait_while(slot, |slot| slot.moment.is_none() && !slot.closed);
        let mut slot = wait.unwrap_or_else(PoisonError::into_inner);
        if slot.closed { None } else { slot.moment.take() }
    }
}

/// The cameras of one session.
pub struct Studio {
    scene: Scene,
    renderer: Box<dyn Renderer>,
    layout: Arc<Layout>,
    catalog: Arc<Catalog>,
    crews: Vec<Crew>,
}

/// The cameras of one body.
struct Crew {
    rig: CameraRig,
    spectator: Post,
    egocentric: Post,
}

impl Crew {
    fn new(bus: &dyn Transport, body: u8) -> Result<Self, BusError> {
        Ok(Self {
            rig: CameraRig::default(),
            spectator: Post::new(bus, CameraId::Spectator(body), SPECTATOR_EVERY)?,
            egocentric: Post::new(bus, CameraId::Egocentric(body), EGOCENTRIC_EVERY)?,
        })
    }
}

/// A camera's publisher and when it last sent.
struct Post {
    publisher: Box<dyn Publisher>,
    every: Duration,
    sent: Option<Instant>,
}

impl Post {
    fn new(bus: &dyn Transport, camera: CameraId, every: Duration) -> Result<Self, BusError> {
        Ok(Self { publisher: bus.publisher(Topic::Frames(camera))?, every, sent: None })
    }

    /// Whether a frame is due, and how long after the one before.
    fn due(&mut self) -> Option<Duration> {
        let now = Instant::now();
        let since = self.sent.map_or(self.every, |sent| now - sent);
        if since + Duration::from_millis(4) < self.every || self.publisher.subscribers() == 0 {
            return None;
        }
        self.sent = Some(now);
        Some(since)
    }
}

impl Studio {
    /// The studio of a floor plan, with cameras for so many bodies.
    ///
    /// # Errors
    /// [`BusError`].
    pub fn new(
        meshes: Arc<MeshLibrary>,
        layout: Arc<Layout>,
        catalog: Arc<Catalog>,
        renderer: Box<dyn Renderer>,
        bodies: usize,
        bus: &dyn Transport,
    ) -> Result<Self, BusError> {
        let ids = (0..=u8::MAX).take(bodies);
        Ok(Self {
            scene: Scene::new(meshes, &layout),
            renderer,
            layout,
            catalog,
            crews: ids.map(|body| Crew::new(bus, body)).collect::<Result<_, _>>()?,
        })
    }

    /// Renders what `desk` is given, until it is closed.
    ///
    /// # Errors
    /// [`BusError`].
    pub fn run(mut self, desk: &Desk) -> Result<(), BusError> {
        while let Some(moment) = desk.take() {
            self.shoot(&moment)?;
        }
        Ok(())
    }

    fn shoot(&mut self, moment: &Moment) -> Result<(), BusError> {
        let due: Vec<_> = self.crews.iter_mut().map(|crew| (crew.spectator.due(), crew.egocentric.due())).collect();
        if due.iter().all(|(spectator, egocentric)| spectator.is_none() && egocentric.is_none()) {
            return Ok(());
        }
        self.set_up(moment);
        let Self { scene, renderer, layout, catalog, crews } = self;
        let tall: Vec<Tall> = moment.instances.iter().filter_map(|instance| tall(instance, catalog, layout)).collect();
        for (body, (crew, (spectator, egocentric))) in crews.iter_mut().zip(due).enumerate() {
            let Some(standing) = moment.bodies.get(body) else { continue };
            if let Some(since) = spectator {
                let followed = crew.rig.follow(standing, layout, &tall, since.as_secs_f32().min(0.5), SPECTATOR_SIZE);
                let camera = moment.shot.unwrap_or(followed);
                publish(
                    &mut **renderer,
                    scene,
                    &camera,
                    body,
                    moment,
                    &[Plane::Color],
                    &mut *crew.spectator.publisher,
                )?;
            }
            if egocentric.is_some()
                && let Some(camera) = moment.egocentric(body, EGOCENTRIC_SIZE, EGOCENTRIC_SIZE)
            {
                publish(&mut **renderer, scene, &camera, body, moment, &Plane::ALL, &mut *crew.egocentric.publisher)?;
            }
        }
        Ok(())
    }

    fn set_up(&mut self, moment: &Moment) {
        self.scene.set_time(moment.tick * cohabit_world::DT_NANOS);
        self.scene.set_instances(&moment.instances);
        self.scene.set_highlights(&moment.highlights);
        for (room, lit) in cohabit_cdf::RoomId::ALL.into_iter().zip(moment.lit) {
            self.scene.set_lights(room, lit);
        }
    }
}

/// What keeps cameras off: furniture, but neither bodies nor the doors that they pass.
fn tall(instance: &Instance, catalog: &Catalog, layout: &Layout) -> Option<Tall> {
    /// How far a door's middle may be from that of its opening, m.
    const DOOR_M: f32 = 0.7;
    let [x, y, _] = instance.position_m;
    let is_door = |at_m: [f32; 2]| (at_m[0] - x).abs() < DOOR_M && (at_m[1] - y).abs() < DOOR_M;
    match instance.look {
        Look::Object(class) | Look::Gate { class, .. }
            if !layout.openings.iter().any(|opening| is_door(opening.at_m)) =>
        {
            Tall::of(instance, catalog.class(class).size_m)
        }
        _ => None,
    }
}

/// Renders a frame straight into the sample that is sent.
fn publish(
    renderer: &mut dyn Renderer,
    scene: &Scene,
    camera: &Camera,
    body: usize,
    moment: &Moment,
    planes: &[Plane],
    publisher: &mut dyn Publisher,
) -> Result<(), BusError> {
    let layout = FrameLayout::new(camera.width, camera.height, planes);
    publisher.send(moment.tick, layout.bytes(), &mut |payload| {
        let began = monotonic_nanos();
        let (header, [color, depth, normals, ids]) = layout.split_mut(payload);
        renderer.render(
            scene,
            camera,
            &mut Planes {
                color,
                depth_m: depth.map(bytemuck::cast_slice_mut),
                normals: normals.map(bytemuck::cast_slice_mut),
                ids: ids.map(bytemuck::cast_slice_mut),
            },
        );
        *header = FrameHeader {
            width: camera.width,
            height: camera.height,
            planes: layout.plane_bits(),
            body: u32::try_from(body).unwrap_or(0),
            position_m: camera.position_m,
            yaw_rad: camera.yaw_rad,
            pitch_rad: camera.pitch_rad,
            fov_y_rad: camera.fov_y_rad,
            render_nanos: monotonic_nanos() - began,
            command: moment.command,
            seen_nanos: moment.seen_nanos,
            reserved: [0; 8],
        };
    })?;
    Ok(())
}
