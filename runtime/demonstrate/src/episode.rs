//! One episode: a mission played by the expert, and written down as it goes.

use std::{
    collections::BTreeMap,
    fs::{self, File},
    io::{BufWriter, Write as _},
    path::{Path, PathBuf},
    sync::Arc,
};

use cohabit_bus::message::{FrameView, Plane};
use cohabit_cdf::{Action, BodyId};
use cohabit_engine::{Appearance, SessionPlan};
use cohabit_planner::{Executor, GivenUp, Limits, Next};
use cohabit_render::MeshLibrary;
use cohabit_world::{Input, Outcome, World};

use crate::{
    camera::Camera,
    dataset::Recipe,
    error::{DemonstrateError, at},
    objects::Objects,
    picture,
    question::Asker,
    step::{PoseEntry, StepEntry},
};

/// The body that plays.
const BODY: BodyId = BodyId(0);
const TICKS_PER_SECOND: f32 = 60.0;
/// The longest that one action may take: two simulated minutes.
const PATIENCE_TICKS: u32 = 60 * 120;
/// What a search for a plan may take; no time, so that no machine makes another data set.
const LIMITS: Limits = Limits::of_states(4_000);

/// What came of an episode.
pub(crate) enum Played {
    /// All goals were met.
    Solved(Totals),
    /// Not all were, for this reason: it is no demonstration.
    Unsolved(String),
}

/// The sums of an episode.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Totals {
    pub steps: usize,
    pub failed: usize,
    pub questions: usize,
    pub frames: usize,
    pub ticks: u64,
    pub digest: [u8; 32],
}

/// Plays a mission, and writes it down in a folder that is there and empty; `number` is that of the episode.
pub(crate) fn play(
    number: u64,
    plan: &SessionPlan,
    world: World,
    meshes: &Arc<MeshLibrary>,
    recipe: &Recipe,
    folder: &Path,
) -> Result<Played, DemonstrateError> {
    let camera = if recipe.planes().is_empty() {
        None
    } else {
        fs::create_dir(folder.join("frames")).map_err(at(folder))?;
        Some(Camera::new(plan, Arc::clone(meshes), recipe.lens(), recipe.planes())?)
    };
    let path = folder.join("steps.jsonl");
    let lines = BufWriter::new(File::create(&path).map_err(at(&path))?);
    let executor = Executor::new(Arc::clone(&plan.mission), LIMITS, TICKS_PER_SECOND);
    let mut episode = Episode {
        world,
        appearance: Appearance::default(),
        executor,
        asker: recipe.has_questions().then(|| Asker::new(BODY, recipe.seed(), number)),
        camera,
        planes: recipe.planes(),
        folder,
        path,
        lines,
        objects: Objects::default(),
        commands: 0,
        totals: Totals::default(),
    };
    episode.run()
}

struct Episode<'a> {
    world: World,
    appearance: Appearance,
    executor: Executor,
    /// Who asks about instructions, if anybody does.
    asker: Option<Asker>,
    camera: Option<Camera>,
    planes: &'a [Plane],
    folder: &'a Path,
    path: PathBuf,
    lines: BufWriter<File>,
    objects: Objects,
    commands: u64,
    totals: Totals,
}

impl Episode<'_> {
    fn run(&mut self) -> Result<Played, DemonstrateError> {
        // What is met as the mission begins is met before anybody plans.
        self.tick(&[]);
        while self.world.finished().is_none() {
            let met: Vec<bool> = self.world.goals().iter().map(|goal| goal.met).collect();
            match self.executor.next(&self.world.symbols(BODY), &met) {
                Next::Act(action) => {
                    if let Err(reason) = self.step(action)? {
                        return Ok(Played::Unsolved(reason));
                    }
                }
                Next::Wait(ticks) => (0..ticks).for_each(|_| drop(self.tick(&[]))),
                Next::Over => break,
            }
        }
        let last = self.before()?;
        self.write(&last)?;
        self.lines.flush().map_err(at(&self.path))?;
        (self.totals.ticks, self.totals.digest) = (self.world.tick(), self.world.digest());
        Ok(self.verdict())
    }

    fn verdict(&self) -> Played {
        let open = self.world.goals().iter().filter(|goal| !goal.met).count();
        let given_up: Vec<String> = self.executor.given_up().iter().map(GivenUp::to_string).collect();
        match open {
            0 if self.totals.steps > 0 => Played::Solved(self.totals),
            0 => Played::Unsolved("all goals are met from the beginning".to_owned()),
            _ if given_up.is_empty() => Played::Unsolved(format!("{open} goals are open in the end")),
            _ => Played::Unsolved(given_up.join("; ")),
        }
    }

    /// Does a step, and writes it down; says why it never came to an end, if it did not.
    fn step(&mut self, action: Action) -> Result<Result<(), String>, DemonstrateError> {
        let mut entry = self.before()?;
        entry.with_action(&self.world, action);
        let asked = self.asker.as_mut().and_then(|asker| asker.ask(&self.world, action));
        let Some(outcome) = self.act(action) else {
            return Ok(Err(format!("{action:?} never came to an end")));
        };
        self.executor.outcome(outcome.status, &outcome.detail);
        entry.with_outcome(&outcome, self.world.tick());
        entry.questions = asked.map_or_else(Vec::new, |asked| asked.answered(&self.world));
        self.write(&entry)?;
        self.totals.steps += 1;
        self.totals.failed += usize::from(outcome.status.is_failure());
        self.totals.questions += entry.questions.len();
        // What follows from it is there a tick later.
        self.tick(&[]);
        Ok(Ok(()))
    }

    fn act(&mut self, action: Action) -> Option<Outcome> {
        self.commands += 1;
        let command = self.commands;
        let mut inputs = vec![Input { command, body: BODY, action }];
        for _ in 0..PATIENCE_TICKS {
            let outcomes = self.tick(&inputs);
            inputs.clear();
            if let Some(outcome) = outcomes.into_iter().find(|outcome| outcome.command == command) {
                return Some(outcome);
            }
        }
        None
    }

    fn tick(&mut self, inputs: &[Input]) -> Vec<Outcome> {
        let report = self.world.step(inputs);
        self.appearance.note(&self.world, inputs, &report);
        report.outcomes
    }

    /// The state as it is now, with what the robot sees.
    fn before(&mut self) -> Result<StepEntry, DemonstrateError> {
        let (objects, gone) = self.objects.changed(&self.world);
        let mut entry = StepEntry {
            step: self.totals.steps,
            tick: self.world.tick(),
            action: None,
            instructions: BTreeMap::new(),
            questions: Vec::new(),
            outcome: None,
            pose: PoseEntry::of(&self.world, BODY),
            goals: self.world.goals().iter().map(|goal| (goal.id, goal.met)).collect(),
            objects,
            gone,
            frames: BTreeMap::new(),
            camera: None,
            seen: Vec::new(),
        };
        if let Some(camera) = &mut self.camera {
            let (world, planes, folder) = (&self.world, self.planes, self.folder);
            camera.look(world, &self.appearance, |frame| {
                entry.with_frame(world, frame);
                entry.frames = pictures(frame, planes, folder, entry.step)?;
                Ok(())
            })?;
            self.totals.frames += 1;
        }
        Ok(entry)
    }

    fn write(&mut self, entry: &StepEntry) -> Result<(), DemonstrateError> {
        let line = serde_json::to_string(entry).map_err(|error| at(&self.path)(error.into()))?;
        writeln!(self.lines, "{line}").map_err(at(&self.path))
    }
}

/// Writes the planes of a frame; gives the file of each, in the folder of the episode.
fn pictures(
    frame: &FrameView<'_>,
    planes: &[Plane],
    folder: &Path,
    step: usize,
) -> Result<BTreeMap<&'static str, String>, DemonstrateError> {
    let mut files = BTreeMap::new();
    for plane in planes {
        let name = format!("frames/{step:04}-{}.png", plane.name());
        if picture::write(&folder.join(&name), frame, *plane)? {
            files.insert(plane.name(), name);
        }
    }
    Ok(files)
}
