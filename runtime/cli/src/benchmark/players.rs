//! Who plays the benchmark: the agents that `eval` has, chance, and whoever left session logs.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    sync::Arc,
};

use clap::ValueEnum as _;
use cohabit_benchmark::{AgentCard, Benchmark, Mission, Recording, Recordings, Split, random, recording, recordings};
use cohabit_dialog::{Asking, Effort, Knows, Language};
use cohabit_eval::{Caps, Line, Settings, Task, play, solve};
use cohabit_record::Log;

use crate::failure::{bad_input, environment};

/// Who plays, and how.
#[derive(clap::Args)]
pub struct Asked {
    /// Who plays: `dialog`, the robot that does what is said; `expert`, a planner that plays from the goals alone and knows what
    /// the simulator knows; or `random`, which does anything that is allowed
    #[arg(long, value_name = "KIND", default_value = "dialog")]
    agent: AgentKind,
    /// Score sessions that were recorded before, instead of playing: a folder with one session log (.mcap) for each mission. Name the
    /// agent that played them by `--name`. `--agent`, `--knows`, `--ask` and `--understanding` cannot be given with it
    #[arg(long, value_name = "DIR", conflicts_with_all = ["agent", "knows", "ask", "understanding"], requires = "name")]
    logs: Option<PathBuf>,
    /// The agent's name in tables; that of its kind, if absent
    #[arg(long)]
    name: Option<String>,
    /// The agent's version; that of this program, if it plays and none is given
    #[arg(long, value_name = "VERSION")]
    agent_version: Option<String>,
    /// What the agent is, in a sentence
    #[arg(long, value_name = "TEXT", default_value = "")]
    description: String,
    /// The questions of who left the logs were answered
    #[arg(long, requires = "logs")]
    questions: bool,
    /// The seed of what `--agent random` draws. `dialog` and `expert` draw nothing; the missions and their worlds follow from the seed
    /// in the benchmark's file, whatever is given here
    #[arg(long, default_value_t = 1, conflicts_with = "logs")]
    seed: u64,
    /// What the robot may know: `everything` there is, or what it has `seen` so far
    #[arg(long, default_value_t)]
    knows: Knows,
    /// When the robot asks: `never`, when it is `unsure`, or `always`; its questions are answered
    #[arg(long, value_name = "WHEN", default_value_t)]
    ask: Asking,
    /// How much work goes into what people say: `full`, as in `play`, or `fast`
    #[arg(long, value_name = "EFFORT", default_value_t)]
    understanding: Effort,
}

/// Agents that are built in.
#[derive(Clone, Copy, Debug, Eq, PartialEq, clap::ValueEnum)]
enum AgentKind {
    /// The robot that does what is said.
    Dialog,
    /// A planner that knows everything.
    Expert,
    /// Chance.
    Random,
}

impl AgentKind {
    fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }
}

impl Asked {
    /// Whether there are logs, if logs are to be scored: which missions they are of shows once the missions are made.
    pub fn check(&self) -> anyhow::Result<()> {
        let Some(folder) = &self.logs else { return Ok(()) };
        let failed = |error| bad_input(format!("{}: {error}", folder.display()));
        let mut entries = fs::read_dir(folder).map_err(failed)?.flatten();
        if entries.any(|entry| entry.path().extension().is_some_and(|ending| ending == "mcap")) {
            return Ok(());
        }
        Err(bad_input(format!(
            "{}: there are no session logs (*.mcap) in it: play the missions that `benchmark missions` writes, with `--log`",
            folder.display()
        )))
    }

    /// What a submission says of who plays.
    pub fn card(&self) -> AgentCard {
        let is_recorded = self.logs.is_some();
        let own = if is_recorded { "" } else { env!("CARGO_PKG_VERSION") };
        AgentCard {
            name: self.name.clone().unwrap_or_else(|| self.agent.name()),
            version: self.agent_version.clone().unwrap_or_else(|| own.to_owned()),
            description: self.description.clone(),
            questions: if is_recorded { self.questions } else { self.asks() },
            settings: if is_recorded { BTreeMap::new() } else { self.noted() },
        }
    }

    fn asks(&self) -> bool {
        self.agent == AgentKind::Dialog && self.ask != Asking::Never
    }

    fn noted(&self) -> BTreeMap<String, String> {
        let settings = match self.agent {
            AgentKind::Dialog => vec![
                ("knows", self.knows.to_string()),
                ("ask", self.ask.to_string()),
                ("understanding", self.understanding.to_string()),
            ],
            AgentKind::Expert => vec![("knows", Knows::Everything.to_string())],
            AgentKind::Random => vec![("knows", Knows::Everything.to_string()), ("seed", self.seed.to_string())],
        };
        settings.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
    }
}

/// Who plays, ready to.
pub enum Player {
    /// The robot that does what is said.
    Dialog(Box<Language>, Settings, Scratch),
    /// A planner.
    Expert(Settings, Scratch),
    /// Chance, of a seed.
    Random(u64),
    /// Somebody else, who has played.
    Recorded(BTreeMap<String, Recording>),
}

impl Player {
    /// Who was asked for; whoever has played must have played all of these missions.
    pub fn new(asked: &Asked, benchmark: &Benchmark, missions: &[&Mission]) -> anyhow::Result<Self> {
        if let Some(folder) = &asked.logs {
            return recorded(folder, benchmark, missions);
        }
        let caps = Some(Caps { actions: benchmark.caps.actions, failed: benchmark.caps.failed });
        Ok(match asked.agent {
            AgentKind::Random => Self::Random(asked.seed),
            AgentKind::Expert => Self::Expert(Settings { caps, ..Settings::expert(benchmark.seed) }, Scratch::new()?),
            AgentKind::Dialog => {
                let (seed, knows, asking) = (benchmark.seed, asked.knows, asked.ask);
                let settings = Settings { seed, knows, asking, caps, ..Settings::default() };
                let language = cohabit_dialog::language(Arc::clone(&benchmark.catalog), asked.understanding);
                Self::Dialog(Box::new(language), settings, Scratch::new()?)
            }
        })
    }

    /// Plays a mission; gives what was done, or why it could not be played, in words.
    pub fn play(&self, benchmark: &Benchmark, mission: &Mission) -> Result<Recording, String> {
        let played = match self {
            Self::Dialog(language, settings, scratch) => play(&task(mission), &scratch.logging(settings), language),
            Self::Expert(settings, scratch) => solve(&task(mission), &scratch.logging(settings), &benchmark.catalog),
            Self::Random(seed) => return random(benchmark, mission, *seed),
            Self::Recorded(recordings) => {
                return recordings.get(&mission.id).cloned().ok_or_else(|| "it has no log".to_owned());
            }
        };
        let played = played.map_err(|error| error.to_string())?;
        let Some(path) = played.log else {
            return Err(played.ended_early.unwrap_or_else(|| "it left no log".to_owned()));
        };
        let log = Log::open(&path).map_err(|error| error.to_string())?;
        // Thousands of them would fill the disk; what is needed of it is in the submission.
        let _ = fs::remove_file(&path);
        recording(&log, benchmark)
    }
}

/// Whoever left logs of these missions.
fn recorded(folder: &Path, benchmark: &Benchmark, missions: &[&Mission]) -> anyhow::Result<Player> {
    let Recordings { by_mission, others } = recordings(folder, benchmark).map_err(bad_input)?;
    let missing: Vec<&Mission> =
        missions.iter().copied().filter(|mission| !by_mission.contains_key(&mission.id)).collect();
    let Some(first) = missing.first() else { return Ok(Player::Recorded(by_mission)) };
    let whole = |split: &Split| {
        let is_of_it = |mission: &&Mission| mission.split == *split;
        missions.iter().any(is_of_it) && !missing.iter().any(is_of_it)
    };
    let remedy = match (Split::PLAYED.into_iter().find(whole), others.first()) {
        (Some(split), _) => {
            format!("all of the split `{0}` have one: score that alone, by `--split {0}`", split.name())
        }
        (None, Some(other)) => format!(
            "{} logs are of missions that this benchmark does not have, such as {}: give the `--benchmark` and the `--world` that \
             they were written with by `benchmark missions`",
            others.len(),
            other.display()
        ),
        (None, None) => "play them, or name one `--split`".to_owned(),
    };
    Err(bad_input(format!(
        "{}: {} of {} missions have no log in it, such as {}; {remedy}",
        folder.display(),
        missing.len(),
        missions.len(),
        first.id
    )))
}

/// A mission with what is said in it.
fn task(mission: &Mission) -> Task {
    Task {
        id: mission.id.clone(),
        family: Some(mission.kind.clone()),
        cdf: mission.cdf.to_string(),
        preparation: Vec::new(),
        script: mission.instructions.iter().map(|said| Line::answered(&said.text, &said.answer)).collect(),
    }
}

/// Where logs lie until they are read; goes with this.
pub struct Scratch(PathBuf);

impl Scratch {
    fn new() -> anyhow::Result<Self> {
        let folder = std::env::temp_dir().join(format!("cohabit-benchmark-run-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).map_err(|error| environment(format!("{}: {error}", folder.display())))?;
        Ok(Self(folder))
    }

    /// These settings, with logs that come here.
    fn logging(&self, settings: &Settings) -> Settings {
        Settings { record: Some(self.0.clone()), ..settings.clone() }
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}
