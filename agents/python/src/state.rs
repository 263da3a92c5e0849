//! The state of the world, as it was published: typed objects by name, and all of it as arrays.

use std::sync::Arc;

use cohabit_bus::message::{BodyRecord, GoalRecord, Malformed, NONE, ObjectRecord, StateParts, StateView};
use cohabit_cdf::{BodyKind, Catalog, Color, Fluid, StateFlags};
use pyo3::{exceptions::PyKeyError, prelude::*, types::PyBytes};

use crate::{
    around::Records,
    error::bad_argument,
    library::Library,
    memory::{Memory, Owner},
};

/// The world at one tick. It is a copy: keep as many as you like.
#[pyclass(frozen, module = "cohabit._native")]
pub struct State {
    library: Arc<Library>,
    words: Arc<[u64]>,
    bytes: usize,
    tick: u64,
}

/// A robot or a person.
#[pyclass(frozen, get_all, module = "cohabit._native")]
pub struct Body {
    /// Its number.
    pub id: u32,
    /// `robot` or `person`.
    pub kind: &'static str,
    /// Its room's id.
    pub room: String,
    /// The number of the object that it holds.
    pub held: Option<u32>,
    /// Whether it carries out a command.
    pub busy: bool,
    /// The command that it carries out; 0 is none.
    pub command: u64,
    /// The run of whoever commands it; 0 is nobody.
    pub commander: u64,
    /// On the floor, m.
    pub position: (f32, f32, f32),
    /// Heading, rad, counter-clockwise from east.
    pub yaw_rad: f32,
    /// Pitch of its head, rad, up positive.
    pub head_pitch_rad: f32,
    /// Where its camera is, m.
    pub eye: (f32, f32, f32),
    /// The states that it shows, of `FLAGS`.
    pub flags: Vec<String>,
}

/// An object.
#[pyclass(frozen, get_all, module = "cohabit._native")]
pub struct Object {
    /// Its number.
    pub id: u32,
    /// Its instance id, such as `Bowl_01_1`.
    pub instance: String,
    /// The id of its class, such as `Bowl_01`.
    pub class_id: String,
    /// What people call it.
    pub name: String,
    /// Its room's id.
    pub room: String,
    /// The states it is in, of `FLAGS`.
    pub flags: Vec<String>,
    /// One of `COLORS`.
    pub color: &'static str,
    /// One of `FLUIDS`.
    pub fluid: &'static str,
    /// Whether it cannot be seen: in something closed.
    pub hidden: bool,
    /// Whether it is there for the mission's sake, or was made since.
    pub in_mission: bool,
    /// The number of what it stands on or in.
    pub parent: Option<u32>,
    /// The number of the body that holds it.
    pub held_by: Option<u32>,
    /// The number of the object that it works.
    pub works: Option<u32>,
    /// Its origin, m.
    pub position: (f32, f32, f32),
    /// Its rotation as a quaternion, x, y, z, w.
    pub rotation: (f32, f32, f32, f32),
}

/// A goal of the mission.
#[pyclass(frozen, get_all, module = "cohabit._native")]
pub struct Goal {
    /// Its number in the mission.
    pub number: i64,
    /// Whether it is met.
    pub met: bool,
    /// Whether people do not see it yet.
    pub hidden: bool,
    /// What people read.
    pub description: String,
}

#[pymethods]
impl Body {
    fn __repr__(&self) -> String {
        let (x, y, _) = self.position;
        format!("Body({}, {}, {} at {x:.2}, {y:.2})", self.id, self.kind, self.room)
    }
}

#[pymethods]
impl Object {
    fn __repr__(&self) -> String {
        format!("Object({}, {:?}, {})", self.id, self.instance, self.room)
    }
}

#[pymethods]
impl Goal {
    fn __repr__(&self) -> String {
        format!("Goal({}, met={}, {:?})", self.number, self.met, self.description)
    }
}

fn some(index: u32) -> Option<u32> {
    (index != NONE).then_some(index)
}

fn room_id(index: u32, catalog: &Catalog) -> String {
    catalog.rooms().at(index).map_or_else(String::new, |room| room.id().to_owned())
}

fn flag_names(bits: u32) -> Vec<String> {
    StateFlags(bits).iter().map(|flag| format!("{flag:?}")).collect()
}

impl Body {
    fn of(record: &BodyRecord, catalog: &Catalog) -> Self {
        Self {
            id: record.body,
            kind: record.kind().map_or("", BodyKind::name),
            room: room_id(record.room, catalog),
            held: some(record.held),
            busy: record.busy != 0,
            command: record.command,
            commander: record.commander,
            position: record.position_m.into(),
            yaw_rad: record.yaw_rad,
            head_pitch_rad: record.head_pitch_rad,
            eye: record.eye_m.into(),
            flags: flag_names(record.flags),
        }
    }
}

impl Object {
    fn of(record: &ObjectRecord, catalog: &Catalog) -> Self {
        let class = catalog.classes().get(usize::from(record.class));
        Self {
            id: record.object,
            instance: record.instance.as_str().to_owned(),
            class_id: class.map_or_else(String::new, |class| class.id.clone()),
            name: class.map_or_else(String::new, |class| class.name.clone()),
            room: room_id(u32::from(record.room), catalog),
            flags: flag_names(record.flags),
            color: Color::ALL.get(usize::from(record.color)).map_or("", |color| color.name()),
            fluid: Fluid::ALL.get(usize::from(record.fluid)).map_or("", |fluid| fluid.name()),
            hidden: record.hidden != 0,
            in_mission: record.in_mission != 0,
            parent: some(record.parent),
            held_by: some(record.held_by),
            works: some(record.works),
            position: record.position_m.into(),
            rotation: record.rotation.into(),
        }
    }
}

impl From<&GoalRecord> for Goal {
    fn from(record: &GoalRecord) -> Self {
        Self {
            number: record.number,
            met: record.met != 0,
            hidden: record.hidden != 0,
            description: record.description.as_str().to_owned(),
        }
    }
}

impl State {
    /// The state that a world would publish that is made of what a library has.
    pub fn of(parts: &StateParts, tick: u64, library: &Arc<Library>) -> Self {
        let bytes = parts.bytes();
        let mut words = vec![0_u64; bytes.div_ceil(size_of::<u64>())];
        parts.write(&mut bytemuck::cast_slice_mut(&mut words)[..bytes]);
        Self { library: Arc::clone(library), words: words.into(), bytes, tick }
    }

    /// Its bodies and objects.
    pub fn around(&self) -> Records<'_> {
        let StateView { bodies, objects, .. } = self.view();
        Records { bodies, objects, library: &self.library }
    }

    fn payload(&self) -> &[u8] {
        &bytemuck::cast_slice(&self.words)[..self.bytes]
    }

    /// What was checked when it was made.
    fn view(&self) -> StateView<'_> {
        StateView::new(self.payload()).expect("invariant: checked when it was made")
    }

    /// The object that a name means to a body: that instance, else the nearest of that class that can be seen.
    fn meant(&self, name: &str, body: u32) -> Option<&ObjectRecord> {
        let view = self.view();
        if let Some(record) = view.objects.iter().find(|record| record.instance.as_str() == name) {
            return Some(record);
        }
        let classes = self.library.catalog().classes();
        let is_called = |class: u16| {
            let class = &classes[usize::from(class)];
            class.id == name || class.name.eq_ignore_ascii_case(name)
        };
        let classes: Vec<bool> = (0..).take(classes.len()).map(is_called).collect();
        let from = view.bodies.iter().find(|record| record.body == body).map_or([0.0; 3], |record| record.position_m);
        let far = |record: &ObjectRecord| -> f32 {
            record.position_m.iter().zip(from).map(|(one, other)| (one - other) * (one - other)).sum()
        };
        let of_class = |record: &&ObjectRecord| classes.get(usize::from(record.class)).copied().unwrap_or(false);
        view.objects.iter().filter(of_class).min_by(|one, other| {
            let key = |record: &ObjectRecord| (record.hidden, far(record));
            let ((hidden, far), (other_hidden, other_far)) = (key(one), key(other));
            hidden.cmp(&other_hidden).then(far.total_cmp(&other_far))
        })
    }
}

#[pymethods]
impl State {
    /// The state in the bytes of another one, of that tick, in a world with the packs in these folders.
    #[staticmethod]
    #[pyo3(signature = (payload, tick, world=Vec::new()))]
    fn of_payload(payload: &[u8], tick: u64, world: Vec<String>) -> PyResult<Self> {
        let state = Self::try_from((payload, tick)).map_err(bad_argument)?;
        Ok(Self { library: Library::with_packs(&world)?, ..state })
    }

    /// The folders of the world's packs.
    #[getter]
    fn world(&self) -> Vec<String> {
        self.library.folders().to_vec()
    }

    /// All of it as bytes.
    #[pyo3(name = "payload")]
    fn bytes_of_payload<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, self.payload())
    }

    /// When it was so.
    #[getter]
    const fn tick(&self) -> u64 {
        self.tick
    }

    /// Points left or won: 1000, less one a second down to 100, and 100 for each goal met.
    #[getter]
    fn score(&self) -> u32 {
        self.view().header.score
    }

    /// `running`, `complete` or `failed`.
    #[getter]
    fn ending(&self) -> &'static str {
        match self.view().header.ending {
            0 => "running",
            1 => "complete",
            _ => "failed",
        }
    }

    /// Whether the world waits.
    #[getter]
    fn paused(&self) -> bool {
        self.view().header.paused != 0
    }

    /// The ids of the rooms whose lights are on.
    #[getter]
    fn lit_rooms(&self) -> Vec<String> {
        let bits = self.view().header.lit_rooms;
        let rooms = (0_u64..).zip(self.library.catalog().rooms().ids());
        rooms.filter(|(index, _)| bits >> index & 1 == 1).map(|(_, room)| room.id().to_owned()).collect()
    }

    /// All bodies, by their numbers.
    #[getter]
    fn bodies(&self) -> Vec<Body> {
        self.view().bodies.iter().map(|record| Body::of(record, self.library.catalog())).collect()
    }

    /// All objects that are in the world, by their numbers.
    #[getter]
    fn objects(&self) -> Vec<Object> {
        self.view().objects.iter().map(|record| Object::of(record, self.library.catalog())).collect()
    }

    /// The mission's goals, in its order.
    #[getter]
    fn goals(&self) -> Vec<Goal> {
        self.view().goals.iter().map(Goal::from).collect()
    }

    /// What the sticky notes say: `(object's number, text, whether it was read)`.
    #[getter]
    fn notes(&self) -> Vec<(u32, String, bool)> {
        let notes = self.view().notes;
        notes.iter().map(|note| (note.object, note.text.as_str().to_owned(), note.read != 0)).collect()
    }

    /// The object of that number or that name.
    ///
    /// A name is an instance id (`Bowl_01_1`), or a class by its id or by what people call it (`Bowl_01`, `bowl`): then
    /// the nearest to body `near`, those first that are not hidden. Raises `KeyError` if there is none.
    #[pyo3(signature = (name, near=0))]
    fn find(&self, name: &Bound<'_, PyAny>, near: u32) -> PyResult<Object> {
        let found = if let Ok(number) = name.extract::<u32>() {
            self.view().objects.iter().find(|record| record.object == number)
        } else {
            self.meant(&name.extract::<String>()?, near)
        };
        let missing = || PyKeyError::new_err(format!("there is no object {} in this world", name));
        found.map(|record| Object::of(record, self.library.catalog())).ok_or_else(missing)
    }

    /// The records of `bodies`, `objects` or `goals` as they were published: `(bytes a record, [count * bytes] u1)`.
    fn records<'py>(&self, py: Python<'py>, list: &str) -> PyResult<(usize, Bound<'py, PyAny>)> {
        let view = self.view();
        let (list, record): (&[u8], usize) = match list {
            "bodies" => (bytemuck::cast_slice(view.bodies), size_of::<BodyRecord>()),
            "objects" => (bytemuck::cast_slice(view.objects), size_of::<ObjectRecord>()),
            "goals" => (bytemuck::cast_slice(view.goals), size_of::<GoalRecord>()),
            _ => return Err(bad_argument(format!("there are no records `{list}`: bodies, objects or goals"))),
        };
        let from = list.as_ptr() as usize - self.payload().as_ptr() as usize;
        let array = Memory::array(py, &Owner::Bytes(Arc::clone(&self.words)), from, vec![list.len()], "|u1")?;
        Ok((record, array))
    }

    fn __repr__(&self) -> String {
        let StateView { header, bodies, objects, goals, .. } = self.view();
        let met = goals.iter().filter(|goal| goal.met != 0).count();
        let (bodies, objects, goals) = (bodies.len(), objects.len(), goals.len());
        let (tick, score) = (self.tick, header.score);
        format!("State(tick={tick}, {bodies} bodies, {objects} objects, {met} of {goals} goals met, score={score})")
    }
}

impl TryFrom<(&[u8], u64)> for State {
    type Error = Malformed;

    /// A copy of a state message of a session, and its tick.
    fn try_from((payload, tick): (&[u8], u64)) -> Result<Self, Malformed> {
        StateView::new(payload)?;
        let mut words = vec![0_u64; payload.len().div_ceil(size_of::<u64>())];
        bytemuck::cast_slice_mut(&mut words)[..payload.len()].copy_from_slice(payload);
        Ok(Self { library: Arc::clone(Library::builtin()), words: words.into(), bytes: payload.len(), tick })
    }
}
