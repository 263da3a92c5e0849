//! `cohabit eval`: are missions solved by what is said in them, or by the expert?

use std::{
    io::{self, Write as _},
    path::{Path, PathBuf},
    process::Command,
    str::FromStr,
    sync::Arc,
    time::Instant,
};

use cohabit_cdf::Catalog;
use cohabit_dialog::{Asking, Effort, Knows, Language};
use cohabit_eval::{
    Caps, Played, Report, Settings, Style, Tally, Task, generate, play, pool, read_missions, read_tasks, solve,
};
use cohabit_tables::{Align, columns};
use indicatif::{ProgressBar, ProgressStyle};

use crate::{
    failure::{bad_input, environment},
    terminal::{shown, shown_lines},
    world::WorldPacks,
};

/// Plays missions headless and in lock-step, through the real dialog and agent code or by the expert, and reports what came of
/// them.
#[derive(clap::Args)]
pub struct Eval {
    /// A .jsonl of missions with utterances, a data set of sessions, a mission (CDF), or a folder of missions
    #[arg(required_unless_present = "user")]
    file: Option<PathBuf>,
    /// Plays missions made up at random instead, with somebody who says what they want in their own words
    #[arg(long, value_name = "KIND", conflicts_with = "file")]
    user: Option<UserKind>,
    #[command(flatten)]
    made_up: MadeUp,
    /// Who plays: `dialog`, the robot that does what is said; or `expert`, a planner that plays from the goals alone and knows
    /// what the simulator knows, whatever `--knows`, `--ask` and `--script` say
    #[arg(long, value_name = "KIND", default_value = "dialog")]
    agent: AgentKind,
    /// What to say and do: in a mission in the place of the .script beside it, in a folder in the missions that have none
    #[arg(long, value_name = "FILE")]
    script: Option<PathBuf>,
    /// Play only missions whose name contains this
    #[arg(long, value_name = "TEXT")]
    only: Option<String>,
    /// Worker processes; one for each core if not given
    #[arg(long, value_name = "N")]
    workers: Option<usize>,
    /// Give a mission up beyond so many actions, or at so many failed ones
    #[arg(long, value_name = "ACTIONS,FAILED", num_args = 0..=1, default_missing_value = "50,10", require_equals = true)]
    caps: Option<CapsText>,
    /// Where missions leave it to chance
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// What the robot may know: `everything` there is, or what it has `seen` so far
    #[arg(long, default_value_t)]
    knows: Knows,
    /// When the robot asks: `never`, when it is `unsure`, or `always`, and before it does anything
    #[arg(long, value_name = "WHEN", default_value_t)]
    ask: Asking,
    /// How much work goes into what people say: `full`, as in `play`, or `fast`, without the language model that rewrites it in
    /// plain requests
    #[arg(long, value_name = "EFFORT", default_value_t)]
    understanding: Effort,
    /// Write a session log of each mission into this folder, which must not have logs of them yet
    #[arg(long, value_name = "DIR")]
    record: Option<PathBuf>,
    /// Write all results to this file, as JSON
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
    #[command(flatten)]
    packs: WorldPacks,
    /// Play the missions that come in, write their results out
    #[arg(long, hide = true)]
    worker: bool,
}

/// Who speaks in missions that are made up.
#[derive(Clone, Copy, clap::ValueEnum)]
enum UserKind {
    /// A program that speaks like people do.
    Simulated,
}

/// Who plays missions.
#[derive(Clone, Copy, Eq, PartialEq, clap::ValueEnum)]
enum AgentKind {
    /// The robot that does what is said.
    Dialog,
    /// A planner that knows everything.
    Expert,
}

/// Missions that are made up, and how their people speak.
#[derive(clap::Args)]
struct MadeUp {
    /// How many missions are made up
    #[arg(long, value_name = "N", default_value_t = 240, requires = "user")]
    missions: usize,
    /// The share of things that are named by their noun alone, though there are others of that name
    #[arg(long, value_name = "SHARE", default_value_t = Style::default().vagueness, value_parser = share, requires = "user")]
    vagueness: f64,
    /// The share of words that are mistyped
    #[arg(long, value_name = "SHARE", default_value_t = Style::default().typos, value_parser = share, requires = "user")]
    typos: f64,
    /// The share of descriptions that are wrong in one point
    #[arg(long, value_name = "SHARE", default_value_t = Style::default().mistakes, value_parser = share, requires = "user")]
    mistakes: f64,
    /// Write the missions to this file, a line each, with the expert's words
    #[arg(long, value_name = "FILE", requires = "user")]
    save: Option<PathBuf>,
}

fn share(text: &str) -> Result<f64, String> {
    let share = text.parse().ok().filter(|share| (0.0..=1.0).contains(share));
    share.ok_or_else(|| "a number from 0 to 1".to_owned())
}

/// `50,10`.
#[derive(Clone, Copy)]
struct CapsText(Caps);

impl FromStr for CapsText {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let numbers = text.split_once(',').and_then(|(actions, failed)| {
            Some(Caps { actions: actions.trim().parse().ok()?, failed: failed.trim().parse().ok()? })
        });
        numbers.map(Self).ok_or_else(|| "two numbers with a comma, such as 50,10".to_owned())
    }
}

impl Eval {
    /// Plays them all; that some are not solved is a result, not a failure.
    pub fn run(&self) -> anyhow::Result<()> {
        if self.worker {
            return self.serve();
        }
        // What is wrong with a world pack is said once, before workers read it.
        self.packs.read()?;
        let tasks = self.tasks()?;
        if let Some(folder) = &self.record {
            std::fs::create_dir_all(folder).map_err(|error| bad_input(format!("{}: {error}", folder.display())))?;
            self.check_logs(&tasks)?;
        }
        // Before an hour of work, not after it.
        let out = self.report.as_ref().map(|path| create(path)).transpose()?;
        let report = self.play(&tasks)?;
        print(&report);
        if let (Some(path), Some(mut out)) = (&self.report, out) {
            let written = serde_json::to_writer_pretty(&mut out, &report).map_err(io::Error::from);
            // A buffer that is dropped says nothing of a disk that is full.
            written.and_then(|()| out.flush()).map_err(|error| failed(path, &error))?;
        }
        Ok(())
    }

    fn tasks(&self) -> anyhow::Result<Vec<Task>> {
        let mut tasks = match &self.file {
            Some(file) if self.agent == AgentKind::Expert => read_missions(file).map_err(bad_input)?,
            Some(file) => read_tasks(file, self.script.as_deref()).map_err(bad_input)?,
            None => self.make_up()?,
        };
        if let Some(only) = &self.only {
            tasks.retain(|task| task.id.contains(only.as_str()));
            if tasks.is_empty() {
                return Err(bad_input(format!("{}: no mission's name contains `{only}`", self.source())));
            }
        }
        Ok(tasks)
    }

    /// No log is written over: what the folder has of these missions is said before they are played, and not by worker after worker
    /// that ends of it.
    fn check_logs(&self, tasks: &[Task]) -> anyhow::Result<()> {
        let settings = self.settings();
        match tasks.iter().filter_map(|task| settings.log(&task.id)).find(|path| path.exists()) {
            Some(path) => Err(bad_input(format!(
                "{}: there is a log of this mission already; name another folder by `--record`, or remove it",
                path.display()
            ))),
            None => Ok(()),
        }
    }

    /// Where the missions are from, in a report.
    fn source(&self) -> String {
        self.file.as_ref().map_or_else(|| "missions made up".to_owned(), |file| file.display().to_string())
    }

    fn make_up(&self) -> anyhow::Result<Vec<Task>> {
        if self.made_up.missions == 0 {
            return Err(bad_input("--missions 0: at least one"));
        }
        let language = self.language(Arc::clone(self.packs.read()?.catalog()));
        let tasks = generate(self.made_up.missions, self.seed, &language).map_err(bad_input)?;
        if let Some(path) = &self.made_up.save {
            let mut out = create(path)?;
            let written = tasks.iter().try_for_each(|task| writeln!(out, "{}", task.as_line()));
            written.and_then(|()| out.flush()).map_err(|error| failed(path, &error))?;
        }
        Ok(tasks)
    }

    /// How those speak who use their own words.
    fn style(&self) -> Option<Style> {
        let MadeUp { vagueness, typos, mistakes, .. } = self.made_up;
        self.user.map(|UserKind::Simulated| Style { vagueness, typos, mistakes })
    }

    fn settings(&self) -> Settings {
        Settings {
            seed: self.seed,
            knows: self.knows,
            asking: self.ask,
            style: self.style(),
            caps: self.caps.map(|caps| caps.0),
            record: self.record.clone(),
            ..Settings::default()
        }
    }

    /// The robot's language, of that catalogue.
    fn language(&self, catalog: Arc<Catalog>) -> Language {
        cohabit_dialog::language(catalog, self.understanding)
    }

    fn serve(&self) -> anyhow::Result<()> {
        let catalog = Arc::clone(self.packs.read()?.catalog());
        let (settings, input, output) = (self.settings(), io::stdin().lock(), io::stdout().lock());
        let served = match self.agent {
            AgentKind::Expert => {
                pool::serve(input, output, |task| solve(task, &settings, &catalog).map_err(io::Error::other))
            }
            AgentKind::Dialog => {
                let language = self.language(catalog);
                pool::serve(input, output, |task| play(task, &settings, &language).map_err(io::Error::other))
            }
        };
        Ok(served?)
    }

    fn play(&self, tasks: &[Task]) -> anyhow::Result<Report> {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let workers = self.workers.unwrap_or(cores).clamp(1, tasks.len());
        let bar = ProgressBar::new(tasks.len() as u64).with_style(
            ProgressStyle::with_template("{bar:30} {pos}/{len} played, {elapsed} ({eta} left) {msg}")
                .unwrap_or_else(|_| ProgressStyle::default_bar()),
        );
        let program = std::env::current_exe()?;
        let start = || {
            let mut command = Command::new(&program);
            // What missions warn of is what `check` is for.
            command.args(std::env::args_os().skip(1)).arg("--worker").env("COHABIT_LOG", "error");
            command
        };
        let began = Instant::now();
        let results = pool::run(tasks, workers, &start, &|| bar.inc(1))?;
        bar.finish_and_clear();
        let wall_s = began.elapsed().as_secs_f64();
        let lost =
            |task: &Task, why: String| Played { id: task.id.clone(), ended_early: Some(why), ..Played::default() };
        let missions =
            tasks.iter().zip(results).map(|(task, result)| result.unwrap_or_else(|why| lost(task, why))).collect();
        let caps = self.caps.map(|caps| caps.0);
        Ok(Report::new(&self.source(), self.seed, caps, workers, wall_s, missions))
    }
}

fn create(path: &Path) -> anyhow::Result<io::BufWriter<std::fs::File>> {
    let file = std::fs::File::create(path).map_err(|error| bad_input(format!("{}: {error}", path.display())))?;
    Ok(io::BufWriter::new(file))
}

/// A file that could not be written.
fn failed(path: &Path, error: &io::Error) -> anyhow::Error {
    environment(format!("{}: {error}", path.display()))
}

/// Unsolved missions that are printed at most; the report has all.
const MOST_PRINTED: usize = 30;

fn print(report: &Report) {
    let unsolved: Vec<&Played> = report.missions.iter().filter(|task| !task.success).collect();
    for task in unsolved.iter().take(MOST_PRINTED) {
        println!("not solved: {}", shown_lines(why(task)));
    }
    if unsolved.len() > MOST_PRINTED {
        println!("... and {} more; `--report FILE` has them all", unsolved.len() - MOST_PRINTED);
    }
    let head = ["family", "missions", "solved", "rate", "95 % interval", "goals met", "actions", "failed", "questions"];
    let families = report.families.iter().map(|(name, tally)| {
        let name = if name.is_empty() { "not played" } else { name };
        row(&shown(name).to_string(), tally)
    });
    let all = row("all", &report.total);
    let rows: Vec<Vec<String>> =
        std::iter::once(Vec::from(head.map(str::to_owned))).chain(families).chain([all]).collect();
    print!("{}", columns(&rows, Align::Right));
    let ticks: u64 = report.missions.iter().map(|task| task.ticks).sum();
    println!(
        "{} ticks in {:.1} s with {} workers: {:.0} times real time",
        ticks,
        report.wall_s,
        report.workers,
        ticks as f64 * cohabit_engine::replay::TICK_S / report.wall_s.max(1e-9)
    );
}

fn row(name: &str, tally: &Tally) -> Vec<String> {
    let [low, high] = tally.interval_95;
    vec![
        name.to_owned(),
        tally.missions.to_string(),
        tally.solved.to_string(),
        format!("{:.1}", tally.success_rate * 100.0),
        format!("{:.1} – {:5.1}", low * 100.0, high * 100.0),
        format!("{}/{}", tally.goals_met, tally.goals),
        format!("{:.1}", tally.mean_actions),
        format!("{:.1}", tally.mean_failed_actions),
        format!("{:.1}", tally.mean_questions),
    ]
}

fn why(task: &Played) -> String {
    // What is wrong in a mission may have several lines, its name has one.
    let mut parts = vec![shown(&task.id).to_string()];
    parts.extend(task.ended_early.clone());
    parts.extend(task.first_trouble.as_ref().map(|trouble| format!("\"{}\" {}", trouble.line, trouble.why)));
    parts.extend(task.open_goals.iter().map(|goal| format!("open goal {goal}")));
    parts.join("; ")
}
