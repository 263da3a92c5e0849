//! Missions with simulated people in them: played headless, as `cohabit eval --user simulated` plays them, and as fast as the machine
//! can.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    sync::{Arc, OnceLock},
};

use clap::Parser;
use cohabit_cdf::Catalog;
use cohabit_dialog::{Asking, Effort, Knows, Language};
use cohabit_engine::SessionPlan;
use cohabit_eval::{Settings, Style, Task, play};
use cohabit_record::Log;
use cohabit_study::{
    SimulatedMission, SimulatedPlayer, SimulatedSession,
    settings::{Settings as StudySettings, WIZARD, arguments, has_wizard},
};
use cohabit_tables::Chance;

use super::{
    synthetic_log::{Facts, SyntheticLog},
    wishes::wishes,
};
use crate::{mission_file::MissionFile, peers::Listening};

/// The settings of sessions that make a difference without a page, a voice or a picture.
const HEEDED: [&str; 3] = ["ask", "knows", "understanding"];
/// How logs note that each proposal counts as accepted, since nobody decides.
const ACCEPTED: &str = "accepted";

/// Plays missions with simulated people.
pub struct Speakers {
    /// Where names of files in the study start from.
    folder: PathBuf,
    /// Where logs lie until the study keeps them; goes with this.
    scratch: PathBuf,
    catalog: Arc<Catalog>,
    fast: OnceLock<Language>,
    full: OnceLock<Language>,
}

/// These settings as a command line.
#[derive(Parser)]
#[command(no_binary_name = true)]
struct HeededLine {
    #[command(flatten)]
    listening: Listening,
}

/// What a session's settings say about how it is played.
struct Conditions {
    asking: Asking,
    knows: Knows,
    effort: Effort,
    /// Whether the session has a wizard, each proposal to whom counts as accepted.
    has_wizard: bool,
}

impl Speakers {
    /// Those of a study in that folder.
    ///
    /// # Errors
    /// Of the file system.
    pub fn new(folder: &Path) -> std::io::Result<Self> {
        let scratch = std::env::temp_dir().join(format!("cohabit-simulate-{}", std::process::id()));
        fs::create_dir_all(&scratch)?;
        let catalog = Arc::new(Catalog::builtin());
        Ok(Self { folder: folder.to_owned(), scratch, catalog, fast: OnceLock::new(), full: OnceLock::new() })
    }

    fn language(&self, effort: Effort) -> &Language {
        let cell = match effort {
            Effort::Fast => &self.fast,
            Effort::Full => &self.full,
        };
        cell.get_or_init(|| cohabit_dialog::language(Arc::clone(&self.catalog), effort))
    }

    fn task(&self, wanted: &SimulatedMission) -> Result<(MissionFile, Task), String> {
        let beside = self.folder.join(&wanted.mission);
        let name = if beside.is_file() { beside.to_string_lossy().into_owned() } else { wanted.mission.clone() };
        let file = MissionFile::find(Some(&name)).map_err(|error| format!("{error:#}"))?;
        let [world, people] = wanted.seeds;
        let plan = SessionPlan::new(&file.name, &file.text, Arc::clone(&self.catalog), world);
        let plan = plan.map_err(|error| error.to_string())?;
        // How somebody speaks follows from the task's name.
        let id = format!("{}#{people:x}", wanted.name);
        let mut script = wishes(&plan.mission, &self.catalog, wanted.speaking.own_words, &mut Chance::new(people, 0));
        if wanted.gives_up {
            // Half of what they would say first: the other half of all goals stays open.
            script.truncate(plan.mission.goals.len().div_ceil(2).min(plan.mission.goals.len().saturating_sub(1)));
        }
        let task = Task { id, family: None, cdf: file.text.clone(), preparation: Vec::new(), script };
        Ok((file, task))
    }
}

impl Conditions {
    fn of(settings: &StudySettings) -> Result<Self, String> {
        let mut heeded = settings.clone();
        heeded.retain(|name, _| HEEDED.contains(&name.as_str()));
        let line = HeededLine::try_parse_from(arguments(&heeded)).map_err(|error| error.to_string())?;
        let listening = line.listening;
        let has_wizard = has_wizard(settings);
        Ok(Self { asking: listening.ask, knows: listening.knows, effort: listening.understanding, has_wizard })
    }

    /// As logs note them.
    fn noted(&self) -> BTreeMap<String, String> {
        let values = [self.asking.to_string(), self.knows.to_string(), self.effort.to_string()];
        let wizard = if self.has_wizard { ACCEPTED } else { "no" };
        let heeded = HEEDED.into_iter().map(str::to_owned).zip(values);
        heeded.chain([(WIZARD.to_owned(), wizard.to_owned())]).collect()
    }
}

/// Those of a study's settings that a dry run passes over.
pub fn unheeded<'a>(all: impl IntoIterator<Item = &'a StudySettings>) -> Vec<String> {
    let mut names: Vec<String> = all.into_iter().flat_map(|settings| settings.keys().cloned()).collect();
    names.retain(|name| !HEEDED.contains(&name.as_str()) && name != WIZARD);
    names.sort();
    names.dedup();
    names
}

impl SimulatedPlayer for Speakers {
    fn play(&self, wanted: &SimulatedMission) -> Result<SimulatedSession, String> {
        let conditions = Conditions::of(&wanted.settings)?;
        let (file, task) = self.task(wanted)?;
        let is_file = self.folder.join(&wanted.mission).is_file();
        let speaking = &wanted.speaking;
        let settings = Settings {
            seed: wanted.seeds[0],
            knows: conditions.knows,
            asking: conditions.asking,
            style: Some(Style { vagueness: speaking.vagueness, typos: speaking.typos, mistakes: speaking.mistakes }),
            caps: None,
            record: Some(self.scratch.clone()),
        };
        let played = play(&task, &settings, self.language(conditions.effort)).map_err(|error| error.to_string())?;
        let raw = match (&played.log, &played.ended_early) {
            (Some(raw), _) => raw,
            (None, why) => return Err(why.clone().unwrap_or_else(|| "it left no log".to_owned())),
        };
        let log = Log::open(raw).map_err(|error| error.to_string())?;
        let log = SyntheticLog::new(log, speaking.line_s, wanted.ends_by_s);
        let facts = Facts {
            session: wanted.name.clone(),
            participant: wanted.participant.clone(),
            mission_file: if is_file { wanted.mission.clone() } else { file.name },
            settings: conditions.noted(),
            has_wizard: conditions.has_wizard,
            began_ms: wanted.began_ms,
        };
        log.write(&wanted.log, facts).map_err(|error| error.to_string())?;
        let _ = fs::remove_file(raw);
        Ok(log.session())
    }
}

impl Drop for Speakers {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.scratch);
    }
}
