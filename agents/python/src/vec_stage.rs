//! Many worlds in this process that are stepped in one call: what vectors of environments are made of.

use std::sync::{Mutex, PoisonError};

use cohabit_bus::{CameraId, message::Plane};
use cohabit_engine::{CameraPlan, report};
use pyo3::{prelude::*, types::PyBytes};

use crate::{
    book::{Book, Layout},
    choice::Choice,
    crew::Crew,
    error::bad_argument,
    frame::Frame,
    mission_file::MissionFile,
    outcome::Outcome,
    part::{Part, Shown, Sizes, Told},
    senses::Filling,
    stage::read_all,
    state::State,
    theatre::{Cast, Theatre, ending_name},
};

/// The body that is played in each world.
const BODY: u32 = 0;
/// Points of the score that a reward of 1 stands for.
const POINTS: f64 = 100.0;

/// Worlds that are stepped together by threads of their own.
///
/// A world is stepped by whichever thread is free: all of it may be sent from one to another.
#[pyclass(frozen, module = "cohabit._native")]
pub struct VecStage {
    troupe: Mutex<Troupe>,
}

struct Troupe {
    seats: Vec<Seat>,
    rules: Rules,
    book: Book,
    crew: Crew,
}

/// What holds for all worlds.
struct Rules {
    /// The camera that the body sees by.
    eyes: Option<CameraId>,
    slots: usize,
    filling: Filling,
    /// How long a step lasts; until the command came to its outcome, if not said.
    ticks: Option<u64>,
    /// Steps after which an episode is cut off.
    most_steps: u64,
}

/// One world.
struct Seat {
    theatre: Theatre,
    steps: u64,
    told: Told,
}

/// What a world is to do in a turn.
enum Job {
    /// Begin anew, with another mission if one is given.
    Begin { seed: u64, file: Option<MissionFile> },
    /// Have its body do something.
    Step { choice: usize, slot: usize },
    /// Stay as it is.
    Keep,
}

/// A mission that a world begins with: a name, and a text unless it can be found by its name.
type Named = (Option<String>, Option<String>);
/// A world that begins anew: its place, its seed, and its mission, if it is another one.
type Beginning = (usize, u64, Option<Named>);
/// The newest pages, and of each world the status and the detail of its command, and its ending.
type Turn<'py> = (Vec<Bound<'py, PyAny>>, Vec<String>, Vec<String>, Vec<&'static str>);

impl Seat {
    fn begin(&mut self, seed: u64, file: Option<&MissionFile>) -> PyResult<()> {
        self.theatre.reset(seed, file)?;
        self.steps = 0;
        self.told = Told::default();
        self.note(&[]);
        self.told.reward = 0.0;
        Ok(())
    }

    fn step(&mut self, choice: usize, slot: usize, rules: &Rules) -> PyResult<()> {
        let outcomes = self.theatre.choose(&[(BODY, choice, slot)], rules.ticks)?;
        self.steps += 1;
        self.note(&outcomes);
        self.told.truncated = !self.told.terminated && self.steps >= rules.most_steps;
        Ok(())
    }

    /// Notes how the world is, and what came of the body's command.
    fn note(&mut self, outcomes: &[Outcome]) {
        let world = self.theatre.world();
        let ending = world.finished();
        let outcome = outcomes.iter().find(|outcome| outcome.body == BODY);
        let outcome = outcome.map(|outcome| (outcome.status.clone(), outcome.detail.clone()));
        let (status, detail) = outcome.unwrap_or_default();
        self.told = Told {
            tick: world.tick(),
            score: world.score(),
            reward: (f64::from(world.score()) - f64::from(self.told.score)) / POINTS,
            terminated: ending.is_some(),
            truncated: false,
            goals: world.goals().iter().map(|goal| goal.met).collect(),
            status,
            detail,
            ending: ending_name(ending),
        };
    }

    /// Writes what the body senses into the world's rows.
    fn write(&mut self, rules: &Rules, parts: &[Part], rows: Vec<&mut [u8]>) -> PyResult<()> {
        let frame = match rules.eyes {
            Some(camera) => self.theatre.look(&[camera])?.pop(),
            None => None,
        };
        let sensed = self.theatre.sense(BODY, rules.slots, rules.filling, frame.as_ref())?;
        let shown = Shown { frame: frame.as_ref(), sensed: &sensed, told: &self.told };
        parts.iter().zip(rows).for_each(|(part, row)| part.write(row, shown));
        Ok(())
    }
}

impl Troupe {
    /// Has each world do its job, and writes down what comes of it.
    fn turn(&mut self, jobs: Vec<Job>) -> PyResult<()> {
        let Self { seats, rules, book, crew } = self;
        let (parts, mut fresh) = (book.parts(), book.fresh());
        let rows = book.rows(&mut fresh);
        let work: Vec<_> = seats.iter_mut().enumerate().zip(jobs).zip(rows).collect();
        crew.share_out(work, |(((world, seat), job), rows)| {
            match job {
                Job::Begin { seed, file } => seat.begin(seed, file.as_ref())?,
                Job::Step { choice, slot } => seat.step(choice, slot, rules)?,
                Job::Keep => {
                    rows.into_iter().zip(book.written(world)).for_each(|(row, written)| row.copy_from_slice(written));
                    return Ok(());
                }
            }
            seat.write(rules, &parts, rows)
        })?;
        book.turn(fresh);
        Ok(())
    }

    fn seat(&mut self, world: usize) -> PyResult<&mut Seat> {
        let last = self.seats.len() - 1;
        self.seats.get_mut(world).ok_or_else(|| bad_argument(format!("there is no world {world}: 0 to {last}")))
    }
}

impl VecStage {
    fn with<T: Send>(&self, py: Python<'_>, work: impl FnOnce(&mut Troupe) -> PyResult<T> + Send) -> PyResult<T> {
        py.detach(|| work(&mut self.troupe.lock().unwrap_or_else(PoisonError::into_inner)))
    }
}

/// The jobs of a turn: worlds of `beginnings` begin anew, others do what was chosen for them, or nothing, if nothing was.
fn jobs(worlds: usize, choices: Vec<Option<[usize; 2]>>, beginnings: Vec<Beginning>) -> PyResult<Vec<Job>> {
    if choices.len() != worlds {
        return Err(bad_argument(format!("{} actions for {worlds} worlds: one for each", choices.len())));
    }
    let job = |choice: Option<[usize; 2]>| choice.map_or(Job::Keep, |[choice, slot]| Job::Step { choice, slot });
    let mut jobs: Vec<Job> = choices.into_iter().map(job).collect();
    for (world, seed, named) in beginnings {
        let file = named.map(|(name, text)| MissionFile::given(name, text)).transpose()?;
        let job = jobs.get_mut(world).ok_or_else(|| bad_argument(format!("there is no world {world}")))?;
        *job = Job::Begin { seed, file };
    }
    // Before any world is changed.
    for job in &jobs {
        if let Job::Step { choice, .. } = job {
            Choice::numbered(*choice)?;
        }
    }
    Ok(jobs)
}

/// The sizes of rows where bodies see by that camera.
fn sizes(eyes: Option<&CameraPlan>, slots: usize) -> Sizes {
    let [width, height] = eyes.map_or([1, 1], |eyes| eyes.lens.size());
    let views = eyes.map_or(1, CameraPlan::views);
    Sizes { views: views as usize, height: height as usize, width: width as usize, slots }
}

#[pymethods]
impl VecStage {
    /// A world for each of `missions`. `bodies` and `cameras` are those of each world, and `eyes` is the name of the camera that
    /// body 0 sees by, whose `planes` are told; slots are filled with what is `seen`, `near`, or `all`.
    #[new]
    #[pyo3(signature = (
        missions, bodies, cameras, eyes, planes, slots, filling, ticks, most_steps, threads, randomize
    ))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python<'_>,
        missions: Vec<Named>,
        bodies: Vec<String>,
        cameras: Vec<String>,
        eyes: Option<String>,
        planes: Vec<String>,
        slots: usize,
        filling: &str,
        ticks: Option<u64>,
        most_steps: u64,
        threads: usize,
        randomize: bool,
    ) -> PyResult<Self> {
        if missions.is_empty() {
            return Err(bad_argument("0 worlds: at least 1"));
        }
        let files = missions.into_iter().map(|(name, text)| MissionFile::given(name, text));
        let files = files.collect::<PyResult<Vec<_>>>()?;
        let cast = Cast { bodies: read_all(&bodies)?, cameras: read_all(&cameras)?, randomize };
        let eyes = eyes.map(|eyes| eyes.parse::<CameraId>().map_err(bad_argument)).transpose()?;
        let plan = eyes.and_then(|eyes| cast.cameras.iter().find(|camera| camera.id == eyes));
        let is_told = |plane: &Plane| planes.iter().any(|name| name == plane.name());
        let planes: Vec<Part> = Plane::ALL.into_iter().filter(is_told).map(Part::Plane).collect();
        let book = Book::new(&planes, sizes(plan, slots), files.len());
        let rules = Rules { eyes, slots, filling: Filling::named(filling)?, ticks, most_steps };
        py.detach(|| {
            let crew = Crew::new(threads.min(files.len()));
            let mut seats: Vec<Option<Seat>> = files.iter().map(|_| None).collect();
            crew.share_out(seats.iter_mut().zip(&files).collect(), |(seat, file)| {
                // Worlds are many, so each draws its pictures with the thread that steps it.
                let theatre = Theatre::new(file, cast.clone(), 0, 1)?;
                *seat = Some(Seat { theatre, steps: 0, told: Told::default() });
                PyResult::Ok(())
            })?;
            let seats = seats.into_iter().flatten().collect();
            Ok(Self { troupe: Mutex::new(Troupe { seats, rules, book, crew }) })
        })
    }

    /// Where arrays are in pages: `(name, page, first byte, shape, type)`.
    fn layout(&self, py: Python<'_>) -> PyResult<Vec<Layout>> {
        self.with(py, |troupe| Ok(troupe.book.layout()))
    }

    /// One turn of all worlds: those of `beginnings`, `(world, seed, mission)` each, begin anew; the others do what was chosen
    /// for them, `[choice, slot]`, or stay as they are where that is `None`.
    ///
    /// Gives the pages that say how all worlds are then, which nobody changes while they are referred to, and of each world
    /// the status and the detail of its command, and its ending.
    fn turn<'py>(
        &self,
        py: Python<'py>,
        choices: Vec<Option<[usize; 2]>>,
        beginnings: Vec<Beginning>,
    ) -> PyResult<Turn<'py>> {
        let told = self.with(py, |troupe| {
            let jobs = jobs(troupe.seats.len(), choices, beginnings)?;
            troupe.turn(jobs)?;
            Ok(troupe.seats.iter().map(|seat| seat.told.clone()).collect::<Vec<_>>())
        })?;
        let (mut statuses, mut details, mut endings) = (Vec::new(), Vec::new(), Vec::new());
        for Told { status, detail, ending, .. } in told {
            statuses.push(status);
            details.push(detail);
            endings.push(ending);
        }
        let pages = self.troupe.lock().unwrap_or_else(PoisonError::into_inner).book.arrays(py)?;
        Ok((pages, statuses, details, endings))
    }

    /// What a camera of a world sees now.
    fn look(&self, py: Python<'_>, world: usize, camera: &str) -> PyResult<Frame> {
        let camera: CameraId = camera.parse().map_err(bad_argument)?;
        let frame = self.with(py, |troupe| Ok(troupe.seat(world)?.theatre.look(&[camera])?.pop()))?;
        frame.ok_or_else(|| bad_argument(format!("there is no camera `{camera}` here")))
    }

    /// The state of a world.
    fn state(&self, py: Python<'_>, world: usize) -> PyResult<State> {
        self.with(py, |troupe| {
            let world = troupe.seat(world)?.theatre.world();
            Ok(State::of(&report::state(world), world.tick()))
        })
    }

    /// What the whole simulated state of a world comes down to.
    fn digest<'py>(&self, py: Python<'py>, world: usize) -> PyResult<Bound<'py, PyBytes>> {
        let digest = self.with(py, |troupe| Ok(troupe.seat(world)?.theatre.world().digest()))?;
        Ok(PyBytes::new(py, &digest))
    }
}
