//! A running session, joined: what its simulator publishes, and what is said in it.

use std::{
    collections::{BTreeMap, VecDeque},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

use cohabit_bus::{
    BusError, CameraId, Publisher, Session as Name, Shm, Subscriber, Topic, Transport, Wake,
    message::{
        self, CommandMessage, DialogKind, DialogMessage, DialogView, EventKind, EventMessage, MissionMessage, NONE,
    },
    monotonic_nanos,
};
use cohabit_cdf::Status;
use pyo3::{exceptions::PyTimeoutError, prelude::*};

use crate::{
    action::PyAction,
    error::{bad_argument, failed},
    frame::Frame,
    outcome::Outcome,
    state::State,
};

/// The longest that Python is kept from looking whether Ctrl-C was pressed.
const NAP: Duration = Duration::from_millis(50);
/// What was heard and not asked for: the oldest is forgotten beyond it.
const MOST_HEARD: usize = 1024;

/// A session that this process takes part in.
#[pyclass(frozen, module = "cohabit._native")]
pub struct Session {
    bus: Arc<Shm>,
    name: String,
    mission: MissionMessage,
    state: Mutex<Latest>,
    cameras: Mutex<BTreeMap<CameraId, Arc<Mutex<Box<dyn Subscriber>>>>>,
    talk: Arc<Mutex<Talk>>,
    mouth: Mutex<Mouth>,
}

/// What this process publishes.
struct Mouth {
    commands: Box<dyn Publisher>,
    dialog: Box<dyn Publisher>,
    /// The number of the latest command.
    command: u64,
}

/// A command that was given.
#[pyclass(frozen, module = "cohabit._native")]
pub struct Command {
    session: Py<Session>,
    body: u32,
    number: u64,
}

/// The newest state.
struct Latest {
    states: Box<dyn Subscriber>,
    newest: Option<(Arc<Vec<u8>>, u64)>,
}

/// What is told and said.
struct Talk {
    joined_nanos: u64,
    events: Box<dyn Subscriber>,
    dialog: Box<dyn Subscriber>,
    heard: VecDeque<Heard>,
    /// Of commands that were given here and have no outcome yet, nothing; else what came of them.
    outcomes: BTreeMap<u64, Option<(Status, String)>>,
}

/// Something that was told or said in a session.
#[pyclass(frozen, get_all, module = "cohabit._native")]
#[derive(Clone)]
pub struct Heard {
    /// What it is: an event (`outcome`, `started`, `goal_met`, `sound`, …) or dialog (`utterance`, `reply`, …).
    pub kind: String,
    /// The tick at which it happened; 0 of dialog.
    pub tick: u64,
    /// The body concerned.
    pub body: Option<u32>,
    /// The object concerned.
    pub object: Option<u32>,
    /// The command concerned; 0 is none.
    pub command: u64,
    /// The dialog turn that it belongs to; 0 is none.
    pub turn: u64,
    /// A goal's number, or how long something is shown.
    pub number: i64,
    /// Of an outcome, one of `STATUSES`.
    pub status: String,
    /// A sentence for people.
    pub text: String,
}

#[pymethods]
impl Heard {
    fn __repr__(&self) -> String {
        format!("Heard({}, body={:?}, {:?})", self.kind, self.body, self.text)
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn some(index: u32) -> Option<u32> {
    (index != NONE).then_some(index)
}

/// `GoalMet` as `goal_met`.
fn snake(name: &str) -> String {
    let mut snake = String::new();
    for letter in name.chars() {
        if letter.is_uppercase() && !snake.is_empty() {
            snake.push('_');
        }
        snake.extend(letter.to_lowercase());
    }
    snake
}

impl Heard {
    fn event(event: &EventMessage, kind: EventKind, tick: u64) -> Self {
        let status = if kind == EventKind::Outcome { event.status() } else { None };
        Self {
            kind: snake(&format!("{kind:?}")),
            tick,
            body: some(event.body),
            object: some(event.object),
            command: event.command,
            turn: event.turn,
            number: event.number,
            status: status.map_or_else(String::new, |status| format!("{status:?}")),
            text: event.text.as_str().to_owned(),
        }
    }

    fn dialog(view: &DialogView<'_>, kind: DialogKind) -> Self {
        let ended = matches!(kind, DialogKind::StepEnded | DialogKind::PlanEnded);
        let status = view.header.status().filter(|_| ended);
        Self {
            kind: snake(&format!("{kind:?}")),
            tick: 0,
            body: some(view.header.body),
            object: None,
            command: 0,
            turn: view.header.turn,
            number: i64::from(view.header.step),
            status: status.map_or_else(String::new, |status| format!("{status:?}")),
            text: view.header.text.as_str().to_owned(),
        }
    }
}

impl Talk {
    /// Takes in all that came.
    fn pump(&mut self) -> PyResult<()> {
        while let Some(sample) = self.events.receive().map_err(failed)? {
            let event: EventMessage = message::read(sample.payload()).map_err(failed)?;
            if let Some(kind) = event.kind().filter(|_| sample.envelope().sent_nanos >= self.joined_nanos) {
                if kind == EventKind::Outcome {
                    self.note(&event);
                }
                self.hear(Heard::event(&event, kind, sample.envelope().tick));
            }
        }
        while let Some(sample) = self.dialog.receive().map_err(failed)? {
            let view = DialogView::new(sample.payload()).map_err(failed)?;
            if let Some(kind) = view.header.kind().filter(|_| sample.envelope().sent_nanos >= self.joined_nanos) {
                self.hear(Heard::dialog(&view, kind));
            }
        }
        Ok(())
    }

    /// Notes the outcome of a command that was given here.
    fn note(&mut self, event: &EventMessage) {
        if let (Some(status), Some(outcome)) = (event.status(), self.outcomes.get_mut(&event.command)) {
            *outcome = Some((status, event.text.as_str().to_owned()));
        }
    }

    fn hear(&mut self, heard: Heard) {
        if self.heard.len() == MOST_HEARD {
            self.heard.pop_front();
        }
        self.heard.push_back(heard);
    }
}

/// A time-out in seconds; none is for ever.
fn deadline(timeout_s: Option<f64>) -> PyResult<Option<Instant>> {
    let Some(timeout_s) = timeout_s else { return Ok(None) };
    let timeout = Duration::try_from_secs_f64(timeout_s)
        .map_err(|_| bad_argument(format!("a time-out of {timeout_s} s: it must be 0 or more seconds")))?;
    Ok(Instant::now().checked_add(timeout))
}

impl Session {
    /// Sleeps until `look` finds something, woken by a group of topics; nothing once it is too late. Other Python threads
    /// run meanwhile.
    fn wait_for<T: Send>(
        &self,
        py: Python<'_>,
        wake: Wake,
        until: Option<Instant>,
        mut look: impl FnMut() -> PyResult<Option<T>> + Send,
    ) -> PyResult<Option<T>> {
        if let Some(found) = py.detach(&mut look)? {
            return Ok(Some(found));
        }
        let mut listener = self.bus.listener(wake).map_err(failed)?;
        loop {
            let found = py.detach(|| -> PyResult<Option<T>> {
                // What came while nobody listened yet.
                if let Some(found) = look()? {
                    return Ok(Some(found));
                }
                let left = until.map_or(NAP, |until| until.saturating_duration_since(Instant::now()));
                listener.wait(left.min(NAP)).map_err(failed)?;
                look()
            })?;
            py.check_signals()?;
            if found.is_some() || until.is_some_and(|until| Instant::now() >= until) {
                return Ok(found);
            }
        }
    }

    fn camera(&self, name: &str) -> PyResult<(CameraId, Arc<Mutex<Box<dyn Subscriber>>>)> {
        let known = || {
            let names = self.mission.cameras.iter().filter_map(|camera| camera.camera());
            names.map(|camera| camera.to_string()).collect::<Vec<_>>().join(", ")
        };
        let camera: CameraId = name.parse().map_err(bad_argument)?;
        if !self.mission.cameras.iter().any(|record| record.camera() == Some(camera)) {
            return Err(bad_argument(format!("session `{}` has no camera `{name}`: {}", self.name, known())));
        }
        let mut cameras = lock(&self.cameras);
        if let Some(frames) = cameras.get(&camera) {
            return Ok((camera, Arc::clone(frames)));
        }
        let frames = Arc::new(Mutex::new(self.bus.subscriber(Topic::Frames(camera)).map_err(failed)?));
        cameras.insert(camera, Arc::clone(&frames));
        Ok((camera, frames))
    }
}

/// The newest frame that was not seen yet.
fn newest_frame(frames: &mut dyn Subscriber) -> PyResult<Option<Frame>> {
    let mut newest = None;
    loop {
        match frames.receive() {
            Ok(Some(sample)) => newest = Some(sample),
            Ok(None) => break,
            // One more cannot be held; the next call says so, if nothing is let go of until then.
            Err(BusError::Receive { .. }) if newest.is_some() => break,
            Err(error) => return Err(failed(error)),
        }
    }
    newest.map(Frame::new).transpose().map_err(failed)
}

#[pymethods]
impl Session {
    /// Joins a session of this machine, and waits up to `timeout` seconds for its simulator.
    #[new]
    fn new(py: Python<'_>, name: String, timeout: f64) -> PyResult<Self> {
        let session = Name::new(&name).map_err(bad_argument)?;
        let bus = Arc::new(py.detach(|| Shm::join(&session)).map_err(failed)?);
        let mut missions = bus.subscriber(Topic::Mission).map_err(failed)?;
        let talk = Talk {
            joined_nanos: monotonic_nanos(),
            events: bus.subscriber(Topic::Events).map_err(failed)?,
            dialog: bus.subscriber(Topic::Dialog).map_err(failed)?,
            heard: VecDeque::new(),
            outcomes: BTreeMap::new(),
        };
        let mouth = Mouth {
            commands: bus.publisher(Topic::Commands).map_err(failed)?,
            dialog: bus.publisher(Topic::Dialog).map_err(failed)?,
            command: first_command(),
        };
        let latest = Latest { states: bus.subscriber(Topic::State).map_err(failed)?, newest: None };
        let mut joined = Self {
            bus,
            name,
            mission: MissionMessage::default(),
            state: Mutex::new(latest),
            cameras: Mutex::default(),
            talk: Arc::new(Mutex::new(talk)),
            mouth: Mutex::new(mouth),
        };
        let until = deadline(Some(timeout))?;
        let mission = joined.wait_for(py, Wake::State, until, || {
            let Some(sample) = missions.latest().map_err(failed)? else { return Ok(None) };
            MissionMessage::read(sample.payload()).map(Some).map_err(failed)
        })?;
        joined.mission = mission.ok_or_else(|| {
            let name = &joined.name;
            failed(format!("session `{name}` has told no mission for {timeout} s: does its simulator run?"))
        })?;
        Ok(joined)
    }

    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    /// The name of the mission's file.
    #[getter]
    fn mission(&self) -> &str {
        self.mission.header.file.as_str()
    }

    /// The seed of all that is random in it.
    #[getter]
    const fn seed(&self) -> u64 {
        self.mission.header.seed
    }

    /// Whether its world waits for those who take part in lock-step.
    #[getter]
    const fn lock_step(&self) -> bool {
        self.mission.header.lock_step != 0
    }

    /// Its cameras: `(name, kind, width, height, planes)`.
    #[getter]
    fn cameras(&self) -> Vec<(String, &'static str, u32, u32, Vec<&'static str>)> {
        let told = self.mission.cameras.iter().filter_map(|record| {
            let planes = message::Plane::ALL.into_iter().filter(|plane| record.has(*plane));
            let planes = planes.map(message::Plane::name).collect();
            Some((record.camera()?.to_string(), record.kind()?.name(), record.width, record.height, planes))
        });
        told.collect()
    }

    /// The newest state; waits up to `timeout` seconds for the first one.
    #[pyo3(signature = (timeout=5.0))]
    fn state(&self, py: Python<'_>, timeout: f64) -> PyResult<State> {
        let newest = self.wait_for(py, Wake::State, deadline(Some(timeout))?, || {
            let mut latest = lock(&self.state);
            if let Some(sample) = latest.states.latest().map_err(failed)? {
                latest.newest = Some((Arc::new(sample.payload().to_vec()), sample.envelope().tick));
            }
            Ok(latest.newest.clone())
        })?;
        let (payload, tick) = newest.ok_or_else(|| {
            let name = &self.name;
            PyTimeoutError::new_err(format!("session `{name}` has told no state for {timeout} s"))
        })?;
        State::try_from((&payload[..], tick)).map_err(failed)
    }

    /// The newest frame of a camera that was not handed out yet; waits for one up to `timeout` seconds.
    #[pyo3(signature = (camera, timeout=5.0))]
    fn look(&self, py: Python<'_>, camera: &str, timeout: f64) -> PyResult<Frame> {
        let (id, frames) = self.camera(camera)?;
        let until = deadline(Some(timeout))?;
        let frame = self.wait_for(py, Wake::Frames(id), until, || newest_frame(&mut **lock(&frames)))?;
        frame
            .ok_or_else(|| PyTimeoutError::new_err(format!("camera `{camera}` has delivered no frame for {timeout} s")))
    }

    /// Lets go of a camera: it is not rendered any more for this process. Frames that were handed out stay.
    fn close_camera(&self, camera: &str) -> PyResult<()> {
        let camera: CameraId = camera.parse().map_err(bad_argument)?;
        lock(&self.cameras).remove(&camera);
        Ok(())
    }

    /// The next thing that is told or said, since the session was joined; `None` after `timeout` seconds.
    #[pyo3(signature = (timeout=None))]
    fn hear(&self, py: Python<'_>, timeout: Option<f64>) -> PyResult<Option<Heard>> {
        self.wait_for(py, Wake::Talk, deadline(timeout)?, || {
            let mut talk = lock(&self.talk);
            talk.pump()?;
            Ok(talk.heard.pop_front())
        })
    }

    /// Has a body do something. Whatever it was doing ends.
    fn act(slf: &Bound<'_, Self>, body: u32, action: &Bound<'_, PyAction>) -> PyResult<Command> {
        let this = slf.get();
        let mut mouth = lock(&this.mouth);
        mouth.command += 1;
        let number = mouth.command;
        lock(&this.talk).outcomes.insert(number, None);
        let message = CommandMessage { command: number, turn: 0, body, reserved: 0, action: action.get().0.into() };
        let write = &mut |bytes: &mut [u8]| bytes.copy_from_slice(bytemuck::bytes_of(&message));
        mouth.commands.send(0, size_of::<CommandMessage>(), write).map_err(failed)?;
        Ok(Command { session: slf.clone().unbind(), body, number })
    }

    /// Says something as a body: to the log, and to all who listen.
    fn say(&self, py: Python<'_>, body: u32, text: &str) -> PyResult<()> {
        let message = DialogMessage::new(DialogKind::Reply, body, 0, text);
        py.detach(|| {
            let dialog = &mut lock(&self.mouth).dialog;
            dialog.send(0, message.bytes(), &mut |bytes| message.write(bytes)).map_err(failed)
        })?;
        Ok(())
    }

    fn __repr__(&self) -> String {
        format!("Session({:?}, mission={:?})", self.name, self.mission.header.file.as_str())
    }
}

#[pymethods]
impl Command {
    /// Its number in the session.
    #[getter]
    const fn number(&self) -> u64 {
        self.number
    }

    /// What came of it; waits up to `timeout` seconds, for ever if none is given. Raises `TimeoutError`.
    #[pyo3(signature = (timeout=None))]
    fn wait(&self, py: Python<'_>, timeout: Option<f64>) -> PyResult<Outcome> {
        let session = self.session.get();
        let end = session.wait_for(py, Wake::Talk, deadline(timeout)?, || {
            let mut talk = lock(&session.talk);
            talk.pump()?;
            Ok(talk.outcomes.get(&self.number).cloned().flatten())
        })?;
        let (status, detail) = end.ok_or_else(|| {
            let waited = timeout.unwrap_or_default();
            PyTimeoutError::new_err(format!("command {} has no outcome after {waited} s", self.number))
        })?;
        Ok(Outcome::new(self.number, self.body, status, &detail))
    }

    fn __repr__(&self) -> String {
        format!("Command({}, body={})", self.number, self.body)
    }
}

impl Drop for Command {
    fn drop(&mut self) {
        // Nobody can ask for it any more.
        lock(&self.session.get().talk).outcomes.remove(&self.number);
    }
}

/// A number unlike that of other peers, in the upper bits of what JSON can hold exactly.
fn first_command() -> u64 {
    let mixed = monotonic_nanos() ^ (u64::from(std::process::id()) << 7);
    (mixed & 0xf_ffff) << 32
}
