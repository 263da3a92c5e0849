//! A world in this process that goes on only when it is told to: what an environment is made of.

use std::sync::{Arc, Mutex, PoisonError};

use cohabit_bus::CameraId;
use cohabit_render::CpuRenderer;
use pyo3::{prelude::*, types::PyBytes};

use crate::{
    action::PyAction,
    choice::Choice,
    error::bad_argument,
    frame::Frame,
    library::Library,
    mission_file::MissionFile,
    outcome::Outcome,
    senses::{Filling, Senses},
    state::State,
    theatre::{Cast, Moment, Request, Theatre, ending_name},
};

/// A world that is stepped, its cameras, and what its bodies were shown last.
#[pyclass(frozen, module = "cohabit._native")]
pub struct Stage {
    theatre: Mutex<Theatre>,
    library: Arc<Library>,
    bodies: Vec<String>,
    cameras: Vec<String>,
    threads: usize,
    randomize: bool,
}

/// The arguments of [`Stage::new`].
type MadeOf = (String, String, Vec<String>, Vec<String>, u64, usize, bool, Vec<String>);
/// A [`Moment`] as Python keeps it.
type Saved<'py> = (Bound<'py, PyBytes>, u64, Vec<(u64, u32, Option<String>)>, Vec<Vec<u32>>);

/// Tick, score, ending, and goals by their numbers, with whether they are met.
type Progress = (u64, u32, &'static str, Vec<(i64, bool)>);

/// Reads all of them as they are written on the command line.
///
/// # Errors
/// A `ValueError` that says what is wrong with the first that is none.
pub fn read_all<T: std::str::FromStr<Err: std::fmt::Display>>(texts: &[String]) -> PyResult<Vec<T>> {
    texts.iter().map(|text| text.parse().map_err(bad_argument)).collect()
}

impl Stage {
    fn with<T: Send>(&self, py: Python<'_>, work: impl FnOnce(&mut Theatre) -> PyResult<T> + Send) -> PyResult<T> {
        py.detach(|| work(&mut self.theatre.lock().unwrap_or_else(PoisonError::into_inner)))
    }
}

#[pymethods]
impl Stage {
    /// A world. `mission` is a path or the name of a mission, unless its `text` is given; `bodies` and `cameras` are written as
    /// on the command line. With `randomize`, a mission's own seed gives way to that of each beginning. `world` are the
    /// folders of world packs.
    #[new]
    #[pyo3(signature = (
        mission=None, text=None, bodies=Vec::new(), cameras=Vec::new(), seed=0, threads=1, randomize=false,
        world=Vec::new()
    ))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python<'_>,
        mission: Option<String>,
        text: Option<String>,
        bodies: Vec<String>,
        cameras: Vec<String>,
        seed: u64,
        threads: usize,
        randomize: bool,
        world: Vec<String>,
    ) -> PyResult<Self> {
        let library = Library::with_packs(&world)?;
        let file = MissionFile::given(mission, text, &library)?;
        let cast =
            Cast { library: Arc::clone(&library), bodies: read_all(&bodies)?, cameras: read_all(&cameras)?, randomize };
        py.detach(|| {
            let theatre = Mutex::new(Theatre::new(&file, cast, seed, &CpuRenderer::new(threads))?);
            Ok(Self { theatre, library, bodies, cameras, threads, randomize })
        })
    }

    /// Begins anew, with that seed where the mission leaves something to chance; with another mission, if one is given by a
    /// path, its name, or its `text`.
    #[pyo3(signature = (seed, mission=None, text=None))]
    fn reset(&self, py: Python<'_>, seed: u64, mission: Option<String>, text: Option<String>) -> PyResult<()> {
        let is_given = mission.is_some() || text.is_some();
        let file = is_given.then(|| MissionFile::given(mission, text, &self.library)).transpose()?;
        self.with(py, |theatre| theatre.reset(seed, file.as_ref()))
    }

    /// The arguments of a stage that is the same at its beginning.
    fn made_of(&self, py: Python<'_>) -> PyResult<MadeOf> {
        self.with(py, |theatre| {
            let plan = theatre.plan();
            let (bodies, cameras, world) = (self.bodies.clone(), self.cameras.clone(), self.library.folders().to_vec());
            Ok((plan.file.clone(), plan.text.clone(), bodies, cameras, plan.seed, self.threads, self.randomize, world))
        })
    }

    /// This moment, for `load`.
    fn save<'py>(&self, py: Python<'py>) -> PyResult<Saved<'py>> {
        let Moment { state, commanded, pending, slots } = self.with(py, |theatre| Ok(theatre.save()))?;
        Ok((PyBytes::new(py, &state), commanded, pending, slots))
    }

    /// Goes on from a moment of a stage that was made of the same.
    fn load(
        &self,
        py: Python<'_>,
        state: &[u8],
        commanded: u64,
        pending: Vec<(u64, u32, Option<String>)>,
        slots: Vec<Vec<u32>>,
    ) -> PyResult<()> {
        let moment = Moment { state: state.to_vec(), commanded, pending, slots };
        self.with(py, |theatre| theatre.load(moment))
    }

    /// Has bodies carry out actions, `(body, action)` each, until all have ended, or for `ticks` ticks.
    #[pyo3(signature = (actions, ticks=None))]
    fn act(&self, py: Python<'_>, actions: Vec<(u32, Py<PyAction>)>, ticks: Option<u64>) -> PyResult<Vec<Outcome>> {
        let request = |(body, action): &(u32, Py<PyAction>)| {
            let PyAction { action, unknown } = action.get();
            Request { body: *body, action: *action, unknown: unknown.clone() }
        };
        let requests = actions.iter().map(request).collect();
        self.with(py, |theatre| Ok(theatre.carry_out(requests, ticks)))
    }

    /// The same with choices, `(body, choice, slot)` each; what is in the slots is what `sense` said last.
    #[pyo3(signature = (choices, ticks=None))]
    fn choose(&self, py: Python<'_>, choices: Vec<(u32, i64, i64)>, ticks: Option<u64>) -> PyResult<Vec<Outcome>> {
        // A slot that there is not is empty.
        let choice = |(body, choice, slot): (u32, i64, i64)| {
            Choice::numbered(choice).map(|choice| (body, choice, usize::try_from(slot).unwrap_or(usize::MAX)))
        };
        let choices = choices.into_iter().map(choice).collect::<PyResult<Vec<_>>>()?;
        self.with(py, |theatre| {
            let chosen = choices.into_iter().filter_map(|(body, choice, slot)| theatre.chosen(body, choice, slot));
            let requests = chosen.collect();
            Ok(theatre.carry_out(requests, ticks))
        })
    }

    /// What these cameras see now.
    fn look(&self, py: Python<'_>, cameras: Vec<String>) -> PyResult<Vec<Frame>> {
        let cameras = read_all::<CameraId>(&cameras)?;
        self.with(py, |theatre| theatre.look(&cameras))
    }

    /// What bodies sense besides pictures, once their slots are filled anew: with what is `seen` in each one's frame, `near`,
    /// or `all`.
    fn sense(
        &self,
        py: Python<'_>,
        bodies: Vec<u32>,
        slots: usize,
        filling: &str,
        frames: Vec<Bound<'_, Frame>>,
    ) -> PyResult<Vec<Senses>> {
        let filling = Filling::named(filling)?;
        let frames: Vec<&Frame> = frames.iter().map(Bound::get).collect();
        let sensed = self.with(py, |theatre| {
            let sense = |(place, body): (usize, u32)| theatre.sense(body, slots, filling, frames.get(place).copied());
            bodies.into_iter().enumerate().map(sense).collect::<PyResult<Vec<_>>>()
        })?;
        sensed.into_iter().map(|sensed| sensed.into_python(py)).collect()
    }

    /// `(tick, score, ending, goals)`: the ending is `running`, `complete` or `failed`, and a goal `(number, met)`.
    fn progress(&self, py: Python<'_>) -> PyResult<Progress> {
        self.with(py, |theatre| {
            let world = theatre.world();
            let ending = ending_name(world.finished());
            let numbers = world.mission().goals.iter().map(|goal| goal.id);
            let goals = numbers.zip(world.goals_met()).collect();
            Ok((world.tick(), world.score(), ending, goals))
        })
    }

    /// The state of the world.
    fn state(&self, py: Python<'_>) -> PyResult<State> {
        self.with(py, |theatre| Ok(theatre.state()))
    }

    /// What the whole simulated state comes down to: equal digests are equal worlds.
    fn digest<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let digest = self.with(py, |theatre| Ok(theatre.world().digest()))?;
        Ok(PyBytes::new(py, &digest))
    }

    /// The kinds of all bodies, by their numbers.
    fn kinds(&self, py: Python<'_>) -> PyResult<Vec<&'static str>> {
        self.with(py, |theatre| Ok(theatre.world().bodies().map(|body| body.kind.name()).collect()))
    }

    /// The mission's name and its seed.
    fn mission(&self, py: Python<'_>) -> PyResult<(String, u64)> {
        self.with(py, |theatre| Ok((theatre.plan().file.clone(), theatre.plan().seed)))
    }
}
