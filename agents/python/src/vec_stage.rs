//! Many worlds in this process that are stepped in one call: what vectors of environments are made of.

use std::{
    collections::BTreeSet,
    sync::{Arc, Mutex, PoisonError},
};

use cohabit_bus::{
    CameraId,
    message::{Plane, Thing},
};
use cohabit_cdf::ObjectId;
use cohabit_engine::CameraPlan;
use cohabit_render::CpuRenderer;
use pyo3::{prelude::*, types::PyBytes};

use crate::{
    action::PyAction,
    book::{Book, Layout},
    choice::Choice,
    crew::Crew,
    error::bad_argument,
    frame::Frame,
    library::Library,
    mission_file::MissionFile,
    outcome::Outcome,
    part::{Part, Shown, Sizes, Told},
    senses::{Filling, Sensed},
    stage::read_all,
    state::State,
    theatre::{Cast, Request, Theatre, ending_name},
};

/// The body that is played in each world.
const BODY: u32 = 0;
/// Points of the score that a reward of 1 stands for.
const POINTS: f64 = 100.0;
/// The bytes of a choice and a slot.
const PAIR_BYTES: usize = 2 * size_of::<i64>();

/// Worlds that are stepped together by threads of their own.
///
/// A world is mostly stepped by the same thread, but by another one that is free sooner: all of it may be sent there.
#[pyclass(frozen, module = "cohabit._native")]
pub struct VecStage {
    troupe: Mutex<Troupe>,
    library: Arc<Library>,
    worlds: usize,
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
    /// Whether it is noted what bodies have seen in the episode.
    remembers: bool,
}

/// One world.
struct Seat {
    theatre: Theatre,
    steps: u64,
    told: Told,
    /// The numbers of the objects that its body has seen in this episode, if that is noted.
    known: BTreeSet<u32>,
}

/// What a world is to do in a turn.
enum Job {
    /// Begin anew, with another mission if one is given.
    Begin { seed: u64, file: Option<MissionFile> },
    /// Have its body do what was chosen.
    Choose { choice: Choice, slot: usize },
    /// Have its body do something that was said in words.
    Act(Request),
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
        self.known.clear();
        self.note(Vec::new());
        self.told.reward = 0.0;
        Ok(())
    }

    /// Goes on by a step in which its body does that, or nothing.
    fn step(&mut self, request: Option<Request>, rules: &Rules) {
        let outcomes = self.theatre.carry_out(request.into_iter().collect(), rules.ticks);
        self.steps += 1;
        self.note(outcomes);
        self.told.truncated = !self.told.terminated && self.steps >= rules.most_steps;
    }

    /// Notes how the world is, and what came of the body's command.
    fn note(&mut self, outcomes: Vec<Outcome>) {
        let world = self.theatre.world();
        let ending = world.finished();
        let outcome = outcomes.into_iter().find(|outcome| outcome.body == BODY);
        let (status, detail) = outcome.map(|outcome| (outcome.status, outcome.detail)).unwrap_or_default();
        self.told = Told {
            tick: world.tick(),
            score: world.score(),
            reward: (f64::from(world.score()) - f64::from(self.told.score)) / POINTS,
            terminated: ending.is_some(),
            truncated: false,
            goals: world.goals_met().collect(),
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
        if rules.remembers {
            self.remember(&sensed, frame.as_ref());
        }
        let shown = Shown { frame: frame.as_ref(), sensed: &sensed, told: &self.told };
        parts.iter().zip(rows).for_each(|(part, row)| part.write(row, shown));
        Ok(())
    }

    /// Notes what is in the body's slots, in its picture and in its hand.
    fn remember(&mut self, sensed: &Sensed, frame: Option<&Frame>) {
        let object = |id: u32| match Thing::of_id(id) {
            Thing::Object(ObjectId(object)) => Some(object),
            _ => None,
        };
        let in_picture = frame.map_or_else(Vec::new, Frame::records);
        self.known.extend(in_picture.iter().filter_map(|record| object(record.id)));
        self.known.extend(sensed.objects().iter().map(|object| object.0));
        self.known.extend(sensed.body.held);
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
                Job::Choose { choice, slot } => {
                    let request = seat.theatre.chosen(BODY, choice, slot);
                    seat.step(request, rules);
                }
                Job::Act(request) => seat.step(Some(request), rules),
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

    /// A job for each world: those of `beginnings` begin anew, the others do what `other` says of their place.
    fn jobs(&self, beginnings: Vec<Beginning>, mut other: impl FnMut(usize) -> PyResult<Job>) -> PyResult<Vec<Job>> {
        let mut begun: Vec<Option<Job>> = (0..self.worlds).map(|_| None).collect();
        for (world, seed, named) in beginnings {
            let file = named.map(|(name, text)| MissionFile::given(name, text, &self.library)).transpose()?;
            let place = begun.get_mut(world).ok_or_else(|| bad_argument(format!("there is no world {world}")))?;
            *place = Some(Job::Begin { seed, file });
        }
        begun.into_iter().enumerate().map(|(place, job)| job.map_or_else(|| other(place), Ok)).collect()
    }

    /// Has all worlds do their jobs.
    fn play<'py>(&self, py: Python<'py>, jobs: Vec<Job>) -> PyResult<Turn<'py>> {
        let (mut statuses, mut details, mut endings) = (Vec::new(), Vec::new(), Vec::new());
        self.with(py, |troupe| {
            troupe.turn(jobs)?;
            for Told { status, detail, ending, .. } in troupe.seats.iter().map(|seat| &seat.told) {
                statuses.push(status.clone());
                details.push(detail.clone());
                endings.push(*ending);
            }
            Ok(())
        })?;
        let pages = self.troupe.lock().unwrap_or_else(PoisonError::into_inner).book.arrays(py)?;
        Ok((pages, statuses, details, endings))
    }

    fn check_count(&self, actions: usize) -> PyResult<()> {
        let worlds = self.worlds;
        if actions == worlds {
            return Ok(());
        }
        Err(bad_argument(format!("{actions} actions for {worlds} worlds: one for each")))
    }
}

/// The choice and the slot in their bytes.
fn pair(bytes: &[u8; PAIR_BYTES]) -> [i64; 2] {
    bytemuck::cast(*bytes)
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
    /// body 0 sees by, whose `planes` are told; slots are filled with what is `seen`, `near`, or `all`. With `remembers`, it is
    /// noted what bodies have seen. `world` are the folders of world packs.
    #[new]
    #[pyo3(signature = (
        missions, bodies, cameras, eyes, planes, slots, filling, ticks, most_steps, threads, randomize, remembers=false,
        world=Vec::new()
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
        remembers: bool,
        world: Vec<String>,
    ) -> PyResult<Self> {
        if missions.is_empty() {
            return Err(bad_argument("0 worlds: at least 1"));
        }
        let library = Library::with_packs(&world)?;
        let files = missions.into_iter().map(|(name, text)| MissionFile::given(name, text, &library));
        let files = files.collect::<PyResult<Vec<_>>>()?;
        let cast =
            Cast { library: Arc::clone(&library), bodies: read_all(&bodies)?, cameras: read_all(&cameras)?, randomize };
        let eyes = eyes.map(|eyes| eyes.parse::<CameraId>().map_err(bad_argument)).transpose()?;
        let plan = eyes.and_then(|eyes| cast.cameras.iter().find(|camera| camera.id == eyes));
        let is_told = |plane: &Plane| planes.iter().any(|name| name == plane.name());
        let planes: Vec<Part> = Plane::ALL.into_iter().filter(is_told).map(Part::Plane).collect();
        let book = Book::new(&planes, sizes(plan, slots), files.len());
        let rules = Rules { eyes, slots, filling: Filling::named(filling)?, ticks, most_steps, remembers };
        py.detach(|| {
            let crew = Crew::new(threads.min(files.len()));
            // Worlds are many, so each draws its pictures with the thread that steps it.
            let renderer = CpuRenderer::new(1);
            let mut seats: Vec<Option<Seat>> = files.iter().map(|_| None).collect();
            crew.share_out(seats.iter_mut().zip(&files).collect(), |(seat, file)| {
                let theatre = Theatre::new(file, cast.clone(), 0, &renderer)?;
                *seat = Some(Seat { theatre, steps: 0, told: Told::default(), known: BTreeSet::new() });
                PyResult::Ok(())
            })?;
            let seats: Vec<Seat> = seats.into_iter().flatten().collect();
            let worlds = seats.len();
            Ok(Self { troupe: Mutex::new(Troupe { seats, rules, book, crew }), library, worlds })
        })
    }

    /// Where arrays are in pages: `(name, page, first byte, shape, type)`.
    fn layout(&self, py: Python<'_>) -> PyResult<Vec<Layout>> {
        self.with(py, |troupe| Ok(troupe.book.layout()))
    }

    /// One turn of all worlds: those of `beginnings`, `(world, seed, mission)` each, begin anew; of the others those go on that
    /// `steps` has a truth for, a byte each, and do what was chosen: `choices` are the bytes of `[worlds, 2]` `i8`, choice and
    /// slot.
    ///
    /// Gives the pages that say how all worlds are then, which nobody changes while they are referred to, and of each world
    /// the status and the detail of its command, and its ending.
    fn turn<'py>(
        &self,
        py: Python<'py>,
        choices: &[u8],
        steps: &[u8],
        beginnings: Vec<Beginning>,
    ) -> PyResult<Turn<'py>> {
        let (pairs, _) = choices.as_chunks::<PAIR_BYTES>();
        self.check_count(pairs.len())?;
        self.check_count(steps.len())?;
        let jobs = self.jobs(beginnings, |place| {
            if steps[place] == 0 {
                return Ok(Job::Keep);
            }
            let [choice, slot] = pair(&pairs[place]);
            // A slot that there is not is empty.
            Ok(Job::Choose { choice: Choice::numbered(choice)?, slot: usize::try_from(slot).unwrap_or(usize::MAX) })
        })?;
        self.play(py, jobs)
    }

    /// The same with an action in words for each world.
    fn act<'py>(&self, py: Python<'py>, actions: Vec<Py<PyAction>>, beginnings: Vec<Beginning>) -> PyResult<Turn<'py>> {
        self.check_count(actions.len())?;
        let jobs = self.jobs(beginnings, |place| {
            let PyAction { action, unknown } = actions[place].get();
            Ok(Job::Act(Request { body: BODY, action: *action, unknown: unknown.clone() }))
        })?;
        self.play(py, jobs)
    }

    /// The numbers of the objects that the body of a world has seen in this episode, if that is noted.
    fn known(&self, py: Python<'_>, world: usize) -> PyResult<Vec<u32>> {
        self.with(py, |troupe| Ok(troupe.seat(world)?.known.iter().copied().collect()))
    }

    /// What a camera of a world sees now.
    fn look(&self, py: Python<'_>, world: usize, camera: &str) -> PyResult<Frame> {
        let camera: CameraId = camera.parse().map_err(bad_argument)?;
        let frame = self.with(py, |troupe| Ok(troupe.seat(world)?.theatre.look(&[camera])?.pop()))?;
        frame.ok_or_else(|| bad_argument(format!("there is no camera `{camera}` here")))
    }

    /// The state of a world.
    fn state(&self, py: Python<'_>, world: usize) -> PyResult<State> {
        self.with(py, |troupe| Ok(troupe.seat(world)?.theatre.state()))
    }

    /// What the whole simulated state of a world comes down to.
    fn digest<'py>(&self, py: Python<'py>, world: usize) -> PyResult<Bound<'py, PyBytes>> {
        let digest = self.with(py, |troupe| Ok(troupe.seat(world)?.theatre.world().digest()))?;
        Ok(PyBytes::new(py, &digest))
    }
}
