//! One episode: a mission played by the expert, and written down as it goes.

use std::{
    collections::BTreeMap,
    convert::Infallible,
    fs::{self, File},
    io::{BufWriter, Write as _},
    path::{Path, PathBuf},
    sync::Arc,
};

use cohabit_bus::message::{FrameView, Plane};
use cohabit_cdf::{Action, BodyId};
use cohabit_engine::{Appearance, SessionPlan};
use cohabit_generate::{ExpertPlay, Observer};
use cohabit_render::MeshLibrary;
use cohabit_world::{Input, Report, World};

use crate::{
    camera::Camera,
    error::{DemonstrateError, at},
    objects::Objects,
    picture,
    question::Asker,
    recipe::Recipe,
    step::{PoseEntry, StepEntry},
};

/// The body that plays.
const BODY: BodyId = BodyId(0);

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
    let Ok(expert) = ExpertPlay::begin(world, Looks(Appearance::default()));
    let mut episode = Episode {
        expert,
        asker: recipe.has_questions().then(|| Asker::new(BODY, recipe.seed(), number)),
        camera,
        planes: recipe.planes(),
        folder,
        path,
        lines,
        objects: Objects::default(),
        totals: Totals::default(),
    };
    episode.run()
}

/// What is shown besides the world, as ticks change it.
struct Looks(Appearance);

impl Observer for Looks {
    type Error = Infallible;

    fn note(&mut self, world: &World, inputs: &[Input], report: &Report) -> Result<(), Infallible> {
        self.0.note(world, inputs, report);
        Ok(())
    }
}

struct Episode<'a> {
    expert: ExpertPlay<Looks>,
    /// Who asks about instructions, if anybody does.
    asker: Option<Asker>,
    camera: Option<Camera>,
    planes: &'a [Plane],
    folder: &'a Path,
    path: PathBuf,
    lines: BufWriter<File>,
    objects: Objects,
    totals: Totals,
}

impl Episode<'_> {
    fn run(&mut self) -> Result<Played, DemonstrateError> {
        while let Ok(Some(action)) = self.expert.decide() {
            if let Err(reason) = self.step(action)? {
                return Ok(Played::Unsolved(reason));
            }
        }
        let last = self.before()?;
        self.write(&last)?;
        self.lines.flush().map_err(at(&self.path))?;
        (self.totals.ticks, self.totals.digest) = (self.expert.world.tick(), self.expert.world.digest());
        Ok(self.verdict())
    }

    fn verdict(&self) -> Played {
        let open = self.expert.world.goals().iter().filter(|goal| !goal.met).count();
        let given_up = self.expert.given_up();
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
        entry.with_action(&self.expert.world, action);
        let asked = self.asker.as_mut().and_then(|asker| asker.ask(&self.expert.world, action));
        let Ok(Some((outcome, tick))) = self.expert.act(action) else {
            return Ok(Err(format!("{action:?} never came to an end")));
        };
        entry.with_outcome(&outcome, tick);
        entry.questions = asked.map_or_else(Vec::new, |asked| asked.answered(&self.expert.world));
        self.write(&entry)?;
        self.totals.steps += 1;
        self.totals.failed += usize::from(outcome.status.is_failure());
        self.totals.questions += entry.questions.len();
        Ok(Ok(()))
    }

    /// The state as it is now, with what the robot sees.
    fn before(&mut self) -> Result<StepEntry, DemonstrateError> {
        let (world, Looks(appearance)) = (&self.expert.world, &self.expert.observer);
        let (objects, gone) = self.objects.changed(world);
        let mut entry = StepEntry {
            step: self.totals.steps,
            tick: world.tick(),
            action: None,
            instructions: BTreeMap::new(),
            questions: Vec::new(),
            outcome: None,
            pose: PoseEntry::of(world, BODY),
            goals: world.goals().iter().map(|goal| (goal.id, goal.met)).collect(),
            objects,
            gone,
            frames: BTreeMap::new(),
            camera: None,
            seen: Vec::new(),
        };
        if let Some(camera) = &mut self.camera {
            let (planes, folder) = (self.planes, self.folder);
            camera.look(world, appearance, |frame| {
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
