//! What the state of a world looks like: its bodies and objects as the renderer knows them.

use std::collections::BTreeMap;

use cohabit_bus::message::{BodyRecord, NONE, ObjectRecord, StateView};
use cohabit_cdf::{BodyId, BodyKind, Catalog, ClassId, Color, Fluid, ObjectId, RoomId, StateFlag, StateFlags};
use cohabit_engine::{body_instance_id, object_instance_id};
use cohabit_render::{Instance, Look};

/// An unhurried pace, m/s: at this speed a person's legs swing fully.
const PACE_M_S: f32 = 1.3;
/// How much larger the embiggenator makes things.
const EMBIGGENED: f32 = cohabit_cdf::table::GROWTH;

/// How far bodies have come: their wheels turn and their legs swing with it.
#[derive(Debug, Default)]
pub struct Gaits(BTreeMap<u32, Gait>);

#[derive(Clone, Copy, Debug)]
struct Gait {
    at_m: [f32; 3],
    tick: u64,
    way_m: f32,
    pace: f32,
}

impl Gaits {
    fn note(&mut self, tick: u64, body: &BodyRecord) -> Gait {
        let still = Gait { at_m: body.position_m, tick, way_m: 0.0, pace: 0.0 };
        let gait = self.0.entry(body.body).or_insert(still);
        let [dx, dy] = [0, 1].map(|axis| body.position_m[axis] - gait.at_m[axis]);
        let step_m = dx.hypot(dy);
        let passed_s = tick.saturating_sub(gait.tick) as f32 * (cohabit_world::DT_NANOS as f32 * 1e-9);
        if passed_s > 0.0 {
            let pace = (step_m / passed_s / PACE_M_S).min(1.0);
            *gait = Gait { at_m: body.position_m, tick, way_m: gait.way_m + step_m, pace };
        }
        *gait
    }
}

/// All instances of a state, bodies first.
pub fn instances(tick: u64, state: &StateView<'_>, gaits: &mut Gaits, catalog: &Catalog) -> Vec<Instance> {
    let bodies = state.bodies.iter().map(|body| self::body(body, gaits.note(tick, body), catalog));
    bodies.chain(state.objects.iter().map(|record| object(record, catalog))).collect()
}

fn body(record: &BodyRecord, gait: Gait, catalog: &Catalog) -> Instance {
    let (head_pitch_rad, holds, arm) = (record.head_pitch_rad, record.held != NONE, 0.0);
    let look = if kind(record) == BodyKind::Robot {
        Look::Robot { head_pitch_rad, arm, holds, rolled_m: gait.way_m }
    } else {
        let Gait { way_m, pace, .. } = gait;
        Look::Person { outfit: record.body, head_pitch_rad, arm, holds, walked_m: way_m, pace }
    };
    let (sin, cos) = (record.yaw_rad / 2.0).sin_cos();
    Instance {
        id: body_instance_id(BodyId(record.body)),
        look,
        position_m: record.position_m,
        rotation: [0.0, 0.0, sin, cos],
        scale: [1.0; 3],
        flags: StateFlags(record.flags),
        fluid: Fluid::None,
        color: Color::Original,
        opened: 0.0,
        running: 0.0,
        room: room(record.room, catalog),
        visible: true,
    }
}

fn object(record: &ObjectRecord, catalog: &Catalog) -> Instance {
    let flags = StateFlags(record.flags);
    let share = |flag| f32::from(u8::from(flags.has(flag)));
    Instance {
        id: object_instance_id(ObjectId(record.object)),
        look: Look::Object(ClassId(record.class)),
        position_m: record.position_m,
        rotation: record.rotation,
        scale: [if flags.has(StateFlag::Embiggenated) { EMBIGGENED } else { 1.0 }; 3],
        flags,
        fluid: Fluid::ALL.get(usize::from(record.fluid)).copied().unwrap_or(Fluid::None),
        color: Color::ALL.get(usize::from(record.color)).copied().unwrap_or(Color::Original),
        opened: share(StateFlag::Opened),
        running: share(StateFlag::Toggled),
        room: room(u32::from(record.room), catalog),
        visible: record.hidden == 0,
    }
}

/// What a body is.
pub fn kind(record: &BodyRecord) -> BodyKind {
    record.kind().unwrap_or(BodyKind::Robot)
}

/// What a body is called in paths, such as `robot_0`.
pub fn body_name(record: &BodyRecord) -> String {
    format!("{}_{}", kind(record).name(), record.body)
}

fn room(index: u32, catalog: &Catalog) -> RoomId {
    catalog.room_at(index).unwrap_or(RoomId::BREAK_ROOM)
}

/// The states of an object in words, such as `opened, dirty, milk`; empty where nothing has happened to it.
pub fn states(record: &ObjectRecord) -> String {
    let flags =
        StateFlags(record.flags).iter().filter(|flag| is_told(*flag)).map(|flag| format!("{flag:?}").to_lowercase());
    let fluid = Fluid::ALL.get(usize::from(record.fluid)).filter(|fluid| **fluid != Fluid::None);
    let color = Color::ALL.get(usize::from(record.color)).filter(|color| **color != Color::Original);
    let others = fluid.map(|fluid| fluid.name()).into_iter().chain(color.map(|color| color.name()));
    flags.chain(others.map(str::to_lowercase)).collect::<Vec<_>>().join(", ")
}

/// What is so of most things most of the time is not told.
fn is_told(flag: StateFlag) -> bool {
    !matches!(flag, StateFlag::Powered | StateFlag::Neutral)
}
