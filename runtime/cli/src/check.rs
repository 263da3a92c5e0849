//! `cohabit check`: what is wrong in mission files, and where. A mission that can be read is laid out as `play` does, too.

use std::{
    collections::BTreeMap,
    fs,
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
    sync::Arc,
};

use cohabit_cdf::{
    Catalog, Layout, WorldData,
    layout::LayoutFault,
    mission::{self, Checked, Pointer, Problem, Severity, Source},
};
use cohabit_render::MeshLibrary;
use cohabit_world::{BuildError, World};
use serde_json::{Value, json};

use crate::{
    failure::bad_input,
    mission_file::MissionFile,
    terminal::{shown, shown_json},
    world::WorldPacks,
};

/// Endings of the files that are looked for in folders.
const ENDINGS: [&str; 2] = ["json", "jsonl"];

/// How deep folders are looked through.
const DEEPEST: usize = 16;

/// The most bytes of a file, which may hold many missions: some ten thousand of the usual size.
const LARGEST_FILE: usize = 256 << 20;

/// The seed of a mission that leaves it to chance: one of those that `play` may take.
const SEED: u64 = 0;

/// Prints every problem with its file, line and column, its place, what is wrong and what would be right. What can be read
/// is laid out, too, as `play` does it: a mission for whose objects there is no room is not playable
#[derive(clap::Args)]
pub struct Check {
    /// Mission files (CDF), files of many missions (JSON lines, or an object of records), folders of these, or names of
    /// built-in missions or those of world packs; if none is named, all that is in the world packs that are given, or else all of
    /// the built-in missions
    files: Vec<String>,
    #[command(flatten)]
    packs: WorldPacks,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
    /// Print the JSON Schema of mission files, and nothing else
    #[arg(long, exclusive = true)]
    schema: bool,
    /// Print no verdict for what is playable
    #[arg(long, short)]
    quiet: bool,
}

/// What is said of one mission.
struct Verdict {
    file: String,
    id: Option<String>,
    playable: bool,
    problems: Vec<Problem>,
}

impl Check {
    /// The check of all that is in world packs.
    pub fn of_world(packs: WorldPacks) -> Self {
        Self { files: Vec::new(), packs, json: false, schema: false, quiet: false }
    }

    /// Checks all files; fails if any has an error.
    pub fn run(&self) -> anyhow::Result<()> {
        match self.report() {
            // Who reads has read enough.
            Err(error)
                if error.downcast_ref::<io::Error>().is_some_and(|error| error.kind() == io::ErrorKind::BrokenPipe) =>
            {
                Ok(())
            }
            done => done,
        }
    }

    fn report(&self) -> anyhow::Result<()> {
        let mut out = BufWriter::new(io::stdout().lock());
        if self.schema {
            writeln!(out, "{:#}", mission::schema::schema(&Catalog::builtin()))?;
            return Ok(out.flush()?);
        }
        let world = self.packs.read()?;
        let mut checker = Checker { catalog: Arc::clone(world.catalog()), world: &world, layouts: BTreeMap::new() };
        let of_packs = if self.is_of_packs() { checker.of_packs() } else { Vec::new() };
        let names = if self.is_of_packs() { Vec::new() } else { self.names()? };
        let mut report = Vec::new();
        let (mut all, mut bad) = (0, 0);
        let what = if self.is_of_packs() { "floor plans and missions" } else { "missions" };
        for verdict in of_packs.into_iter().chain(names.iter().flat_map(|name| checker.verdicts(name))) {
            all += 1;
            bad += usize::from(!verdict.playable);
            if self.json {
                report.push(verdict.value());
            } else {
                verdict.print(self.quiet, &mut out)?;
            }
        }
        if self.json {
            writeln!(out, "{}", shown_json(format_args!("{:#}", Value::Array(report))))?;
        } else if all > 1 {
            writeln!(out, "{} of {all} {what} are playable", all - bad)?;
        }
        out.flush()?;
        if bad > 0 { Err(bad_input(format!("{bad} of {all} {what} are not playable"))) } else { Ok(()) }
    }

    /// Whether world packs are checked, and no files besides.
    fn is_of_packs(&self) -> bool {
        self.files.is_empty() && !self.packs.is_empty()
    }

    /// The files meant, those of folders in the order of their names.
    fn names(&self) -> anyhow::Result<Vec<String>> {
        if self.files.is_empty() {
            return Ok(mission::builtin().iter().map(|(name, _)| (*name).to_owned()).collect());
        }
        let mut names = Vec::new();
        for file in &self.files {
            let path = Path::new(file);
            if !path.is_dir() {
                names.push(file.clone());
                continue;
            }
            let mut found = Vec::new();
            gather(path, DEEPEST, &mut found).map_err(|error| bad_input(format!("{file}: {error}")))?;
            if found.is_empty() {
                return Err(bad_input(format!("{file}: there is no .json or .jsonl file in this folder")));
            }
            found.sort();
            names.extend(found.into_iter().map(|path| path.to_string_lossy().into_owned()));
        }
        Ok(names)
    }
}

fn gather(folder: &Path, deeper: usize, found: &mut Vec<PathBuf>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            if deeper > 0 && !path.is_symlink() {
                gather(&path, deeper - 1, found)?;
            }
        } else if path.extension().is_some_and(|ending| ENDINGS.iter().any(|known| ending == *known)) {
            found.push(path);
        }
    }
    Ok(())
}

/// What missions are checked against.
struct Checker<'a> {
    catalog: Arc<Catalog>,
    world: &'a WorldData,
    /// The floor plans that were needed so far.
    layouts: BTreeMap<String, Arc<Layout>>,
}

impl Checker<'_> {
    /// One for each floor plan and each mission of the world packs, and one for models that cannot be drawn.
    fn of_packs(&mut self) -> Vec<Verdict> {
        let (world, mut verdicts) = (self.world, Vec::new());
        for pack in world.packs() {
            verdicts.extend(pack.plans().map(|id| self.plan(id, pack.plan_file(id).unwrap_or(id))));
            for (file, text) in pack.missions() {
                verdicts.extend(mission::sources(file, text).iter().map(|source| self.verdict(source)));
            }
        }
        verdicts.extend(self.undrawn());
        verdicts
    }

    /// What of the models a session could not draw, and would end at; nothing, if it draws all of them.
    fn undrawn(&self) -> Option<Verdict> {
        let error = MeshLibrary::build(&self.catalog).err()?;
        let packs: Vec<&str> = self.world.packs().iter().map(|pack| pack.id().name.as_str()).collect();
        Some(Verdict::unread(&packs.join(", "), &error.to_string()))
    }

    /// Whether people can live and robots work in a floor plan.
    fn plan(&self, id: &str, file: &str) -> Verdict {
        let layout = match Layout::find(id, &self.catalog) {
            Ok(layout) => layout,
            Err(error) => return Verdict::unread(file, &error.to_string()),
        };
        let problem = |fault: &LayoutFault| Problem {
            severity: Severity::Error,
            file: file.to_owned(),
            position: None,
            pointer: Pointer::default(),
            message: fault.to_string(),
            remedy: Some(fault.remedy()),
        };
        let problems: Vec<Problem> = layout.faults(&self.catalog).iter().map(problem).collect();
        Verdict { file: file.to_owned(), id: None, playable: problems.is_empty(), problems }
    }

    /// One for each mission in a file; one for the file if it cannot be read.
    fn verdicts(&mut self, name: &str) -> Vec<Verdict> {
        let known: Vec<(&str, &str)> = self.world.missions().collect();
        match MissionFile::find_up_to(Some(name), LARGEST_FILE, &known) {
            Ok(file) => {
                let sources = mission::sources(&file.name, &file.text);
                if sources.is_empty() {
                    return vec![Verdict::unread(name, "there is no mission in this file")];
                }
                sources.iter().map(|source| self.verdict(source)).collect()
            }
            Err(error) => {
                let text = format!("{error:#}");
                let prefix = format!("{name}: ");
                vec![Verdict::unread(name, text.strip_prefix(&prefix).unwrap_or(&text))]
            }
        }
    }

    fn verdict(&mut self, source: &Source<'_>) -> Verdict {
        let (playable, problems) = match source.read(&self.catalog) {
            Ok(checked) => match self.lay_out(&checked) {
                Ok(()) => (true, checked.warnings),
                Err((at, message)) => {
                    let problem = Problem {
                        severity: Severity::Error,
                        file: source.file.clone(),
                        position: None,
                        pointer: source.pointer.join(&at),
                        message,
                        remedy: None,
                    };
                    (false, checked.warnings.into_iter().chain([problem]).collect())
                }
            },
            Err(problems) => (false, problems.0),
        };
        let file = match source.position.0 {
            1 => source.file.clone(),
            line => format!("{}:{line}", source.file),
        };
        Verdict { file, id: source.id.clone(), playable, problems }
    }

    /// Builds the world of a mission, as a session does; where that fails, the place in the file and why.
    fn lay_out(&mut self, checked: &Checked) -> Result<(), (Pointer, String)> {
        let mission = &checked.mission;
        let layout = match self.layouts.get(&mission.layout) {
            Some(known) => Arc::clone(known),
            None => {
                let found = Layout::find(&mission.layout, &self.catalog)
                    .map_err(|error| (Pointer::default().key("scene").key("layoutOverride"), error.to_string()))?;
                let found = Arc::new(found);
                self.layouts.insert(mission.layout.clone(), Arc::clone(&found));
                found
            }
        };
        let built = World::new(Arc::clone(&self.catalog), layout, Arc::new(mission.clone()), SEED);
        built.map(drop).map_err(|error| (place(checked, &error), error.to_string()))
    }
}

/// Where in its file a mission asks for what a world cannot have.
fn place(checked: &Checked, error: &BuildError) -> Pointer {
    let objects = checked.raw.scene.known().and_then(|scene| scene.required_objects.known());
    let named = |name: &str| {
        objects?.iter().position(|object| {
            object.known().and_then(|object| object.name.known()).is_some_and(|scalar| scalar.text() == name)
        })
    };
    let scene = Pointer::default().key("scene");
    match named(error.object()) {
        Some(index) => scene.key("required_objects").item(index),
        None => scene,
    }
}

impl Verdict {
    fn unread(file: &str, message: &str) -> Self {
        let problem = Problem {
            severity: Severity::Error,
            file: file.to_owned(),
            position: None,
            pointer: mission::Pointer::default(),
            message: message.to_owned(),
            remedy: None,
        };
        Self { file: file.to_owned(), id: None, playable: false, problems: vec![problem] }
    }

    fn print(&self, quiet: bool, out: &mut impl Write) -> io::Result<()> {
        for problem in &self.problems {
            writeln!(out, "{}", shown(problem))?;
        }
        if quiet && self.playable {
            return Ok(());
        }
        let id = self.id.as_ref().map_or_else(String::new, |id| format!(" ({id})"));
        let verdict = if self.playable { "playable" } else { "not playable" };
        let count = |severity| self.problems.iter().filter(|problem| problem.severity == severity).count();
        let counts = [(count(Severity::Error), "error"), (count(Severity::Warning), "warning")];
        let counts = counts.iter().filter(|(count, _)| *count > 0);
        let counts: Vec<_> =
            counts.map(|(count, word)| format!("{count} {word}{}", if *count == 1 { "" } else { "s" })).collect();
        let counts = if counts.is_empty() { String::new() } else { format!(": {}", counts.join(", ")) };
        writeln!(out, "{}", shown(format_args!("{}{id}: {verdict}{counts}", self.file)))
    }

    fn value(&self) -> Value {
        let problem = |problem: &Problem| {
            let (line, column) = problem.position.unzip();
            json!({
                "severity": problem.severity,
                "file": problem.file,
                "line": line,
                "column": column,
                "pointer": problem.pointer,
                "message": problem.message,
                "remedy": problem.remedy,
            })
        };
        json!({
            "file": self.file,
            "id": self.id,
            "playable": self.playable,
            "problems": self.problems.iter().map(problem).collect::<Vec<_>>(),
        })
    }
}
