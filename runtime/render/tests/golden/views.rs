//! A furnished floor plan, and what is looked at in it.

use std::sync::Arc;

use cohabit_cdf::layout::{Layout, Viewpoint};
use cohabit_cdf::{Catalog, RoomId, StateFlag};
use cohabit_render::{Camera, Highlight, Instance, Look, MeshLibrary, Scene, furnish, gallery};

/// Height of the robot's eye, m.
const EYE_M: f32 = 1.3;
/// The moment at which all is seen: what moves is somewhere in between.
const NANOS: u64 = 1_370_000_000;
/// Viewpoints in a room.
const VIEWPOINTS: usize = 8;
/// Pixels a metre from above.
const ABOVE_PX_M: f32 = 14.0;
/// The robot's id.
const ROBOT: u32 = 9000;

/// What the office is like while a view is drawn.
#[derive(Clone, Copy, PartialEq)]
pub enum Setting {
    /// As it is furnished.
    Usual,
    /// Half of the rooms without light.
    Dark,
    /// Every thing in one of its states, in turn.
    States,
    /// The robot and two people before a viewpoint; some things outlined.
    Bodies(Viewpoint),
}

/// One picture.
pub struct View {
    pub name: String,
    pub setting: Setting,
    pub camera: Camera,
}

/// A floor plan with everything in it.
pub struct Office {
    pub scene: Scene,
    layout: Layout,
    usual: Vec<Instance>,
    states: Vec<Instance>,
    setting: Option<Setting>,
}

impl Office {
    pub fn new(catalog: &Catalog, meshes: &Arc<MeshLibrary>, layout: Layout) -> Self {
        let mut scene = Scene::new(Arc::clone(meshes), &layout);
        scene.set_time(NANOS);
        let usual = furnish(catalog, &layout);
        let states = usual.iter().enumerate().map(|(index, own)| in_some_state(catalog, own, index)).collect();
        Self { scene, layout, usual, states, setting: None }
    }

    /// Has the office be so.
    pub fn set(&mut self, setting: Setting) {
        if self.setting == Some(setting) {
            return;
        }
        self.setting = Some(setting);
        let mut instances = if setting == Setting::States { self.states.clone() } else { self.usual.clone() };
        let mut highlights = Vec::new();
        if let Setting::Bodies(at) = setting {
            instances.extend(bodies(&at));
            let every_fifth = self.usual.iter().step_by(5).map(|instance| instance.id);
            highlights.extend(every_fifth.chain([ROBOT]).map(|id| Highlight { id, color: [255, 190, 60] }));
        }
        self.scene.set_instances(&instances);
        self.scene.set_highlights(&highlights);
        for (index, room) in self.layout.rooms.iter().enumerate() {
            self.scene.set_lights(room.id, setting != Setting::Dark || index % 2 == 1);
        }
    }

    /// All views; which viewpoints they are from varies with the plan's index. Those of one setting follow each other.
    pub fn views(&self, index: usize) -> Vec<View> {
        let rooms = self.layout.rooms.len();
        let mut views = Vec::new();
        let mut add = |kind: &str, setting: fn(Viewpoint) -> Setting, room: usize, turn: usize, size: [u32; 2]| {
            let at = self.viewpoint(room % rooms, index + turn);
            let for_people = size[0] > size[1];
            let name = format!("{kind}-{:?}-{}", at.room, at.number);
            let camera = camera(&at, size, for_people);
            let hide = (kind == "own").then_some(ROBOT);
            views.push(View { name, setting: setting(at), camera: Camera { hide, ..camera } });
        };
        for room in 0..rooms {
            add("300", |_| Setting::Usual, room, room * 3, [300, 300]);
        }
        for room in 0..rooms {
            add("84", |_| Setting::Usual, room, room * 3 + 4, [84, 84]);
        }
        add("people", |_| Setting::Usual, index, 1, [854, 480]);
        add("dark", |_| Setting::Dark, index, 2, [300, 300]);
        add("dark", |_| Setting::Dark, index + 1, 2, [300, 300]);
        for room in [index + 2, index + 4, index + 6] {
            add("states", |_| Setting::States, room, 5, [300, 300]);
        }
        add("bodies", Setting::Bodies, index + 3, 6, [300, 300]);
        add("own", Setting::Bodies, index + 3, 6, [300, 300]);
        add("outlined", Setting::Bodies, index + 3, 6, [854, 480]);
        let camera = Camera::above(self.layout.bounds_m(), 1.0, ABOVE_PX_M);
        views.push(View { name: "above".to_owned(), setting: Setting::States, camera });
        views
    }

    fn viewpoint(&self, room: usize, turn: usize) -> Viewpoint {
        let room = self.layout.rooms[room].id;
        let all: Vec<&Viewpoint> = self.layout.viewpoints.iter().filter(|at| at.room == room).collect();
        *all[turn % all.len().min(VIEWPOINTS)]
    }
}

fn camera(at: &Viewpoint, [width, height]: [u32; 2], for_people: bool) -> Camera {
    Camera {
        position_m: [at.at_m[0], at.at_m[1], EYE_M],
        yaw_rad: at.yaw_deg.to_radians(),
        pitch_rad: -0.25,
        fov_y_rad: 60_f32.to_radians(),
        width,
        height,
        hide: None,
        for_people,
        ceiling: true,
    }
}

/// The `turn`-th state of its class, where it stands.
fn in_some_state(catalog: &Catalog, own: &Instance, turn: usize) -> Instance {
    let Look::Object(class) = own.look else { return own.clone() };
    let mut states = gallery::states(catalog, class);
    let state = states.swap_remove(turn % states.len()).instance;
    let scale = [0, 1, 2].map(|axis| own.scale[axis] * state.scale[axis]);
    let Instance { id, position_m, rotation, room, .. } = *own;
    Instance { id, position_m, rotation, room, scale, ..state }
}

/// The robot and two people, some way before a viewpoint.
fn bodies(at: &Viewpoint) -> [Instance; 3] {
    let yaw_rad = at.yaw_deg.to_radians();
    let body = |id, look, ahead_m: f32, aside_m: f32, turn_rad: f32, mood| {
        let (sin, cos) = libm::sincosf(yaw_rad);
        let (half_sin, half_cos) = libm::sincosf((yaw_rad + turn_rad) * 0.5);
        let [x, y] = at.at_m;
        let position_m = [x + cos * ahead_m - sin * aside_m, y + sin * ahead_m + cos * aside_m, 0.0];
        plain(id, look, position_m, [0.0, 0.0, half_sin, half_cos], at.room, mood)
    };
    let robot = Look::Robot { head_pitch_rad: 0.2, arm: 0.6, holds: true, rolled_m: 0.3 };
    let person =
        |outfit, walked_m, pace| Look::Person { outfit, head_pitch_rad: -0.2, arm: 0.3, holds: false, walked_m, pace };
    [
        body(ROBOT, robot, 1.2, 0.3, 2.5, StateFlag::Happy),
        body(ROBOT + 1, person(2, 0.25, 1.0), 2.2, -0.4, 2.0, StateFlag::Angry),
        body(ROBOT + 2, person(4, 0.0, 0.0), 3.0, 0.0, 3.4, StateFlag::Neutral),
    ]
}

fn plain(id: u32, look: Look, position_m: [f32; 3], rotation: [f32; 4], room: RoomId, mood: StateFlag) -> Instance {
    let flags = cohabit_cdf::StateFlags::default().with(StateFlag::Powered).with(mood);
    Instance {
        id,
        look,
        position_m,
        rotation,
        scale: [1.0; 3],
        flags,
        fluid: cohabit_cdf::Fluid::None,
        color: cohabit_cdf::Color::Original,
        opened: 0.0,
        running: 0.0,
        room,
        visible: true,
    }
}
