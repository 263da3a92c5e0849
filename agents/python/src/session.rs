//! A running session, joined: what its simulator publishes, and what is said in it.

mod command;
mod heard;
mod talk;

use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex},
    time::{Duration, Instant},
};

use cohabit_bus::{
    BusError, CameraId, Inbox, Session as Name, Shm, Subscriber, Topic, Transport, Wake,
    message::{self, DialogKind, DialogMessage, MissionMessage},
};
use pyo3::{exceptions::PyTimeoutError, prelude::*};

use self::talk::{Talk, keep_beating, lock};
pub use self::{command::Command, heard::Heard};
use crate::{
    action::PyAction,
    error::{bad_argument, failed},
    frame::Frame,
    senses::{Filling, Sensed, Senses},
    state::State,
};

/// The longest that Python is kept from looking whether Ctrl-C was pressed.
const NAP: Duration = Duration::from_millis(50);
/// How long the first state may take where something else is wanted, s.
const SENSE_S: f64 = 5.0;

/// The frames of one camera.
type Frames = Arc<Mutex<Box<dyn Subscriber>>>;

/// A session that this process takes part in.
#[pyclass(frozen, module = "cohabit._native")]
pub struct Session {
    bus: Arc<Shm>,
    name: String,
    mission: MissionMessage,
    state: Mutex<Latest>,
    cameras: Mutex<BTreeMap<CameraId, Frames>>,
    talk: Arc<Mutex<Talk>>,
}

/// The newest state.
struct Latest {
    states: Box<dyn Subscriber>,
    newest: Option<(Arc<Vec<u8>>, u64)>,
}

fn seconds(seconds: f64) -> PyResult<Duration> {
    Duration::try_from_secs_f64(seconds).map_err(|_| bad_argument(format!("{seconds} s: it must be 0 or more seconds")))
}

/// The end of a time in seconds; none is for ever.
fn deadline(timeout_s: Option<f64>) -> PyResult<Option<Instant>> {
    Ok(timeout_s.map(seconds).transpose()?.and_then(|timeout| Instant::now().checked_add(timeout)))
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

    fn newest_state(&self, py: Python<'_>, timeout: f64) -> PyResult<(Arc<Vec<u8>>, u64)> {
        let newest = self.wait_for(py, Wake::State, deadline(Some(timeout))?, || {
            let mut latest = lock(&self.state);
            if let Some(sample) = latest.states.latest().map_err(failed)? {
                latest.newest = Some((Arc::new(sample.payload().to_vec()), sample.envelope().tick));
            }
            Ok(latest.newest.clone())
        })?;
        newest.ok_or_else(|| {
            let name = &self.name;
            PyTimeoutError::new_err(format!("session `{name}` has told no state for {timeout} s"))
        })
    }

    fn camera(&self, name: &str) -> PyResult<(CameraId, Frames)> {
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
    /// Joins a session of this machine for one body, and waits up to `timeout` seconds for its simulator.
    #[new]
    fn new(py: Python<'_>, name: String, body: u32, timeout: f64) -> PyResult<Self> {
        let until = deadline(Some(timeout))?;
        let session = Name::new(&name).map_err(bad_argument)?;
        let bus = Arc::new(py.detach(|| Shm::join(&session)).map_err(failed)?);
        let mut missions = Inbox::new(&*bus, Topic::Mission).map_err(failed)?;
        let talk = Talk::join(&*bus, body)?;
        let latest = Latest { states: bus.subscriber(Topic::State).map_err(failed)?, newest: None };
        let talk = Arc::new(Mutex::new(talk));
        keep_beating(&talk);
        let mut joined = Self {
            bus,
            name,
            mission: MissionMessage::default(),
            state: Mutex::new(latest),
            cameras: Mutex::default(),
            talk,
        };
        let mission = joined.wait_for(py, Wake::State, until, || {
            let next = missions.next(|sample| MissionMessage::read(sample.payload())).map_err(failed)?;
            Ok(next.map(|(_, mission)| mission))
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

    /// The text of the mission's file.
    #[getter]
    fn mission_text(&self) -> &str {
        &self.mission.text
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
        let (payload, tick) = self.newest_state(py, timeout)?;
        State::try_from((&payload[..], tick)).map_err(failed)
    }

    /// What the body senses besides pictures, in the newest state, once its slots are filled anew: with what is `seen` in
    /// `frame`, `near`, or `all`.
    #[pyo3(signature = (slots, filling, frame=None))]
    fn sense(&self, py: Python<'_>, slots: usize, filling: &str, frame: Option<&Bound<'_, Frame>>) -> PyResult<Senses> {
        let filling = Filling::named(filling)?;
        let state = self.state(py, SENSE_S)?;
        let body = self.body();
        let sensed = Sensed::of(&state.around(), body, slots, filling, frame.map(Bound::get));
        sensed.ok_or_else(|| bad_argument(format!("there is no body {body} in this session")))?.into_python(py)
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

    /// Looks through a camera from now on: it is rendered.
    fn open_camera(&self, camera: &str) -> PyResult<()> {
        self.camera(camera).map(drop)
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

    /// The body.
    #[getter]
    fn body(&self) -> u32 {
        lock(&self.talk).client.body()
    }

    /// Whether it commands the body, as far as it has heard.
    #[getter]
    fn commands_body(&self) -> PyResult<bool> {
        let mut talk = lock(&self.talk);
        talk.pump()?;
        Ok(talk.client.commands_body())
    }

    /// Asks to command the body, from whoever does if it is to be taken over. The outcome says whether that was granted.
    fn claim(slf: &Bound<'_, Self>, take_over: bool) -> PyResult<Command> {
        let mut talk = lock(&slf.get().talk);
        let number = talk.client.claim(take_over).map_err(failed)?;
        Ok(Command { session: slf.clone().unbind(), number: talk.expect(number), unknown: None })
    }

    /// Lets go of the body: it goes back to whom it was taken from.
    fn release(&self) -> PyResult<()> {
        lock(&self.talk).client.release().map_err(failed)
    }

    /// Has the body do something. Whatever it was doing ends.
    fn act(slf: &Bound<'_, Self>, action: &Bound<'_, PyAction>) -> PyResult<Command> {
        let mut talk = lock(&slf.get().talk);
        let PyAction { action, unknown } = action.get();
        let number = talk.client.act(0, *action).map_err(failed)?;
        Ok(Command { session: slf.clone().unbind(), number: talk.expect(number), unknown: unknown.clone() })
    }

    /// In lock-step: has the world wait for this peer, for `patience` seconds a turn at most; else for ever.
    #[pyo3(signature = (patience=None))]
    fn attend(&self, patience: Option<f64>) -> PyResult<()> {
        let patience = patience.map(seconds).transpose()?;
        let mut talk = lock(&self.talk);
        talk.attends = true;
        talk.client.attend(patience).map_err(failed)
    }

    /// In lock-step: has the world wait for this peer no more.
    fn leave(&self) -> PyResult<()> {
        let mut talk = lock(&self.talk);
        talk.attends = false;
        talk.client.leave().map_err(failed)
    }

    /// In lock-step: its turn is over, and the next comes so many ticks later, or with an outcome of its body.
    fn ready(&self, ticks: u64) -> PyResult<()> {
        lock(&self.talk).client.ready(ticks).map_err(failed)
    }

    /// In lock-step: waits up to `timeout` seconds for its turn; gives the tick.
    #[pyo3(signature = (timeout=None))]
    fn turn(&self, py: Python<'_>, timeout: Option<f64>) -> PyResult<u64> {
        let tick = self.wait_for(py, Wake::Talk, deadline(timeout)?, || {
            let mut talk = lock(&self.talk);
            talk.pump()?;
            talk.client.turn().map_err(failed)
        })?;
        tick.ok_or_else(|| {
            let (name, waited) = (&self.name, timeout.unwrap_or_default());
            PyTimeoutError::new_err(format!(
                "it was not its turn in session `{name}` for {waited} s: the world is paused, or waits for another agent"
            ))
        })
    }

    /// Says something as the body: to the log, and to all who listen.
    fn say(&self, text: &str) -> PyResult<()> {
        let mut talk = lock(&self.talk);
        let message = DialogMessage::new(DialogKind::Reply, talk.client.body(), 0, text);
        talk.mouth.send(0, message.bytes(), &mut |bytes| message.write(bytes)).map_err(failed)?;
        Ok(())
    }

    fn __repr__(&self) -> String {
        format!("Session({:?}, mission={:?})", self.name, self.mission.header.file.as_str())
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        let mut talk = lock(&self.talk);
        if talk.attends {
            // The world would wait for it for as long as this process lives. If the session is gone, nobody waits.
            let _ = talk.client.leave();
        }
    }
}
