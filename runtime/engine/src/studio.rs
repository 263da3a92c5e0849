//! Renders the newest moment of the world for those who watch, on a thread of its own, so that the world never waits.

use std::{
    sync::{Arc, Condvar, Mutex, PoisonError},
    time::{Duration, Instant},
};

use cohabit_bus::{
    BusError, CameraId, Publisher, Topic, Transport,
    message::{FrameLayout, NONE, Plane},
    monotonic_nanos,
};
use cohabit_cdf::{Catalog, Layout};
use cohabit_render::{Camera, Classes, Instance, Lens, Look, MeshLibrary, Renderer, Scene, SeenTable};

use crate::{
    camera_plan::{CameraPlan, Mount},
    camera_rig::{CameraRig, Tall},
    exposure::{Darkroom, Take},
    scene::{Moment, body_instance_id},
    standing::Standing,
};

/// What a camera above the whole plan, or above a body, is to scale at, m above the floor.
const TABLE_M: f32 = 0.8;
/// What a camera above a body sees from south to north, if nothing else is said, m.
const ROUND_A_BODY_M: f32 = 9.0;

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
    posts: Vec<Post>,
    classes: Classes,
    table: SeenTable,
}

/// A camera with its publisher, and when it last sent.
struct Post {
    plan: CameraPlan,
    publisher: Box<dyn Publisher>,
    rig: CameraRig,
    /// Those of its last moment.
    leaps: u64,
    sent: Option<Instant>,
}

impl Post {
    fn new(bus: &dyn Transport, plan: CameraPlan) -> Result<Self, BusError> {
        let publisher = bus.publisher(Topic::Frames(plan.id))?;
        Ok(Self { plan, publisher, rig: CameraRig::default(), leaps: 0, sent: None })
    }

    /// Whether a frame is due, and how long after the one before.
    fn due(&mut self) -> Option<Duration> {
        let (now, every) = (Instant::now(), self.plan.every());
        let since = self.sent.map_or(every, |sent| now - sent);
        if since + Duration::from_millis(4) < every || self.publisher.subscribers() == 0 {
            return None;
        }
        self.sent = Some(now);
        Some(since)
    }

    /// A camera for each picture of its frame; none if its body is not there.
    fn aim(&mut self, moment: &Moment, layout: &Layout, tall: &[Tall], since: Duration) -> Vec<Camera> {
        let lens = self.plan.lens;
        if std::mem::replace(&mut self.leaps, moment.leaps) != moment.leaps {
            self.rig = CameraRig::default();
        }
        let standing = |body: u8| moment.bodies.get(usize::from(body));
        let own = |body: u8| body_instance_id(cohabit_cdf::BodyId(u32::from(body)));
        let cameras = match self.plan.mount {
            Mount::Head { body } => standing(body).map(|Standing { eye_m, yaw_rad, head_pitch_rad, .. }| {
                vec![Camera::egocentric(lens, *eye_m, *yaw_rad, *head_pitch_rad, own(body))]
            }),
            Mount::Panorama { body } => standing(body).map(|Standing { eye_m, yaw_rad, head_pitch_rad, .. }| {
                Camera::panorama(lens, *eye_m, *yaw_rad, *head_pitch_rad, own(body)).to_vec()
            }),
            Mount::Behind { body } => standing(body).map(|standing| {
                let followed = self.rig.follow(standing, layout, tall, since.as_secs_f32().min(0.5), lens);
                vec![moment.shot.map_or(followed, |shot| shot.camera(lens))]
            }),
            Mount::Fixed { at_m, yaw_deg, pitch_deg } => {
                Some(vec![Camera::fixed(lens, at_m, yaw_deg.to_radians(), pitch_deg.to_radians())])
            }
            Mount::Above { body: Some(body), span_m } => standing(body).map(|standing| {
                let [x, y, _] = standing.position_m;
                vec![Camera::top_down(lens.size(), [x, y], TABLE_M, span_m.unwrap_or(ROUND_A_BODY_M))]
            }),
            Mount::Above { body: None, span_m } => {
                let bounds @ [west, south, east, north] = layout.bounds_m();
                let middle = [f32::midpoint(west, east), f32::midpoint(south, north)];
                Some(vec![span_m.map_or_else(
                    || Camera::top_down_on(lens.size(), bounds, TABLE_M),
                    |span_m| Camera::top_down(lens.size(), middle, TABLE_M, span_m),
                )])
            }
        };
        let mut cameras = cameras.unwrap_or_default();
        for camera in &mut cameras {
            camera.for_people = self.plan.for_people;
        }
        cameras
    }
}

impl Studio {
    /// The studio of a floor plan, with these cameras.
    ///
    /// # Errors
    /// [`BusError`].
    pub fn new(
        meshes: Arc<MeshLibrary>,
        layout: Arc<Layout>,
        catalog: Arc<Catalog>,
        renderer: Box<dyn Renderer>,
        cameras: &[CameraPlan],
        bus: &dyn Transport,
    ) -> Result<Self, BusError> {
        Ok(Self {
            scene: Scene::new(meshes, &layout),
            renderer,
            layout,
            catalog,
            posts: cameras.iter().map(|plan| Post::new(bus, plan.clone())).collect::<Result<_, _>>()?,
            classes: Classes::default(),
            table: SeenTable::default(),
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
        let due: Vec<(usize, Duration)> =
            self.posts.iter_mut().enumerate().filter_map(|(index, post)| Some((index, post.due()?))).collect();
        if due.is_empty() { Ok(()) } else { self.expose(moment, due) }
    }

    /// Renders and sends a frame of each camera that somebody subscribes to, but for the eyes of bodies whose turn it is
    /// not; the moment is captured if there is any.
    ///
    /// # Errors
    /// [`BusError`].
    pub fn shoot_watched(&mut self, bodies: &[u32], capture: &dyn Fn(u64) -> Moment) -> Result<(), BusError> {
        /// What the world's own time brings between two frames is no matter to cameras for minds.
        const SINCE: Duration = Duration::from_millis(100);
        let looks = |post: &Post| match post.plan.id {
            CameraId::Egocentric(body) => bodies.contains(&u32::from(body)),
            _ => true,
        };
        let watched = self.posts.iter().enumerate().filter(|(_, post)| looks(post) && post.publisher.subscribers() > 0);
        let watched: Vec<_> = watched.map(|(index, _)| (index, SINCE)).collect();
        if watched.is_empty() { Ok(()) } else { self.expose(&capture(monotonic_nanos()), watched) }
    }

    /// Renders and sends a frame of one camera, due or not; with another lens than its own, if one is given.
    ///
    /// # Errors
    /// [`BusError`].
    pub fn shoot_now(&mut self, moment: &Moment, camera: CameraId, lens: Option<Lens>) -> Result<(), BusError> {
        let Some(index) = self.posts.iter().position(|post| post.plan.id == camera) else { return Ok(()) };
        let post = &mut self.posts[index];
        // Nobody has seen where it was before: it need not come from there.
        post.rig = CameraRig::default();
        let own = post.plan.lens;
        post.plan.lens = lens.unwrap_or(own);
        let shot = self.expose(moment, vec![(index, Duration::from_secs(1))]);
        self.posts[index].plan.lens = own;
        shot
    }

    /// Renders and sends a frame of one camera, so long after its last one.
    ///
    /// # Errors
    /// [`BusError`].
    pub fn shoot_after(&mut self, moment: &Moment, camera: CameraId, since: Duration) -> Result<(), BusError> {
        match self.posts.iter().position(|post| post.plan.id == camera) {
            Some(index) => self.expose(moment, vec![(index, since)]),
            None => Ok(()),
        }
    }

    /// Renders and sends a frame of each of these cameras, due or not.
    ///
    /// # Errors
    /// [`BusError`].
    pub fn shoot_all_now(&mut self, moment: &Moment, cameras: &[CameraId]) -> Result<(), BusError> {
        let mut due = Vec::new();
        for (index, post) in self.posts.iter_mut().enumerate().filter(|(_, post)| cameras.contains(&post.plan.id)) {
            post.rig = CameraRig::default();
            due.push((index, Duration::from_secs(1)));
        }
        self.expose(moment, due)
    }

    /// Renders and sends the frames of these cameras, each given by its place and the time since its last frame.
    fn expose(&mut self, moment: &Moment, due: Vec<(usize, Duration)>) -> Result<(), BusError> {
        self.set_up(moment);
        let Self { scene, renderer, layout, catalog, posts, classes, table } = self;
        let any_is = |is: fn(&CameraPlan) -> bool| due.iter().any(|(index, _)| is(&posts[*index].plan));
        if any_is(|plan| plan.planes.contains(&Plane::Ids)) {
            classes.set(&moment.instances);
        }
        // What a camera must keep off matters to those alone that follow a body from behind.
        let instances: &[Instance] =
            if any_is(|plan| matches!(plan.mount, Mount::Behind { .. })) { &moment.instances } else { &[] };
        let tall: Vec<Tall> = instances.iter().filter_map(|instance| tall(instance, catalog, layout)).collect();
        let rooms = layout.rooms.len();
        let mut due = due.into_iter().peekable();
        let mut takes = Vec::new();
        for (index, post) in posts.iter_mut().enumerate() {
            let Some((_, since)) = due.next_if(|(due, _)| *due == index) else { continue };
            let cameras = post.aim(moment, layout, &tall, since);
            if !cameras.is_empty() {
                let Post { plan, publisher, .. } = post;
                let layout = frame_layout(plan, classes, rooms);
                let body = plan.body().map_or(NONE, u32::from);
                takes.push(Take { publisher: &mut **publisher, layout, cameras, body });
            }
        }
        Darkroom { renderer: &mut **renderer, scene, classes, table, moment }.expose(&mut takes)
    }

    fn set_up(&mut self, moment: &Moment) {
        self.scene.set_time(moment.tick * cohabit_world::DT_NANOS);
        self.scene.set_instances(&moment.instances);
        self.scene.set_highlights(&moment.highlights);
        for (room, lit) in &moment.lit {
            self.scene.set_lights(*room, *lit);
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

/// Where the parts of a camera's frames lie: with room for all that may be seen, if ids are.
fn frame_layout(plan: &CameraPlan, classes: &Classes, rooms: usize) -> FrameLayout {
    let ([width, height], views) = (plan.lens.size(), plan.views());
    let most = classes.most(rooms).min((width * height) as usize);
    let room = if plan.planes.contains(&Plane::Ids) { u32::try_from(most).unwrap_or(u32::MAX) * views } else { 0 };
    FrameLayout::new(width, height, views, &plan.planes, room)
}
