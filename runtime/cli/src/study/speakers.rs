//! Missions with simulated people in them: played headless, as `cohabit eval --user simulated` plays them, and as fast as the machine
//! can.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    sync::{Arc, OnceLock},
};

use clap::Parser;
use cohabit_cdf::{BodyRequest, WorldData};
use cohabit_dialog::{Asking, Effort, Knows, Language};
use cohabit_engine::SessionPlan;
use cohabit_eval::{Line, Settings, Style, Task, play, solve};
use cohabit_record::Log;
use cohabit_study::{
    SimulatedMission, SimulatedPlayer, SimulatedSession,
    pair::PAIR_SIZE,
    settings::{Setting, Settings as StudySettings, WIZARD, arguments, has_wizard},
};
use cohabit_tables::Chance;

use super::{
    synthetic_log::{Facts, Pace, SyntheticLog},
    wishes::wishes,
};
use crate::{
    minds::MindRequest,
    mission_file::MissionFile,
    peers::{Listening, NAME_OF, Timing},
    play::SEATS,
};

/// The settings of sessions that a dry run acts out: those that make a difference without a page, a sound or a picture.
const HEEDED: [&str; 13] = [
    AGENT,
    "ask",
    "body",
    "edit-heard",
    "knows",
    "name",
    "response-delay-ms",
    "response_delay_ms",
    "seed",
    "speed",
    "understanding",
    "voice-delay",
    "voice-errors",
];
/// The setting by which bodies have minds.
const AGENT: &str = "agent";
/// The body that people speak to.
const BODY: u32 = 0;
/// How logs note that each proposal counts as accepted, since nobody decides.
const ACCEPTED: &str = "accepted";

/// Plays missions with simulated people.
pub struct Speakers {
    /// Where names of files in the study start from.
    folder: PathBuf,
    /// Where logs lie until the study keeps them; goes with this.
    scratch: PathBuf,
    world: WorldData,
    fast: OnceLock<Language>,
    full: OnceLock<Language>,
}

/// These settings as a command line.
#[derive(Parser)]
#[command(no_binary_name = true)]
struct HeededLine {
    #[command(flatten)]
    listening: Listening,
    #[command(flatten)]
    timing: Timing,
    #[arg(long)]
    seed: Option<u64>,
    #[arg(long = "body")]
    bodies: Vec<BodyRequest>,
    #[arg(long = "agent")]
    minds: Vec<MindRequest>,
}

/// What a session's settings say about how it is played.
struct Conditions {
    asking: Asking,
    knows: Knows,
    effort: Effort,
    /// Whether the robot plays the mission by itself, and nobody speaks to it.
    is_expert: bool,
    /// What the robot is called.
    name: Option<String>,
    /// How many times as fast as real time the world goes.
    speed: f32,
    /// How long after they were received words are answered, ms.
    delay_ms: u64,
    /// The share of words that are heard wrong of who speaks aloud.
    errors: f32,
    /// How much later words are understood that were said aloud, s.
    aloud_s: f64,
    seed: Option<u64>,
    bodies: Vec<BodyRequest>,
    /// Whether the session has a wizard, each proposal to whom counts as accepted.
    has_wizard: bool,
}

impl Speakers {
    /// Those of a study in that folder, which is played in that world.
    ///
    /// # Errors
    /// Of the file system.
    pub fn new(folder: &Path, world: WorldData) -> std::io::Result<Self> {
        let scratch = std::env::temp_dir().join(format!("cohabit-simulate-{}", std::process::id()));
        fs::create_dir_all(&scratch)?;
        Ok(Self { folder: folder.to_owned(), scratch, world, fast: OnceLock::new(), full: OnceLock::new() })
    }

    fn language(&self, effort: Effort) -> &Language {
        let cell = match effort {
            Effort::Fast => &self.fast,
            Effort::Full => &self.full,
        };
        cell.get_or_init(|| cohabit_dialog::language(Arc::clone(self.world.catalog()), effort))
    }

    fn task(&self, wanted: &SimulatedMission) -> Result<(MissionFile, Task), String> {
        let beside = self.folder.join(&wanted.mission);
        let name = if beside.is_file() { beside.to_string_lossy().into_owned() } else { wanted.mission.clone() };
        let file = MissionFile::find_in(Some(&name), &self.world).map_err(|error| format!("{error:#}"))?;
        let [world, people] = wanted.seeds;
        let catalog = self.world.catalog();
        let plan = SessionPlan::new(&file.name, &file.text, Arc::clone(catalog), world);
        let plan = plan.map_err(|error| error.to_string())?;
        // How somebody speaks follows from the task's name.
        let id = format!("{}#{people:x}", wanted.name);
        let of_one = |seed| wishes(&plan.mission, catalog, wanted.speaking.own_words, &mut Chance::new(seed, 0));
        let mut script = match wanted.partner {
            Some(partner) => in_turn(of_one(people), of_one(partner)),
            None => of_one(people),
        };
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
        let HeededLine { listening, timing, seed, bodies, minds } = line;
        Ok(Self {
            asking: listening.ask,
            knows: listening.knows,
            effort: listening.understanding,
            is_expert: minds.iter().any(|mind| mind.is_expert(BODY)),
            name: listening.names.iter().find(|one| one.body == BODY).map(|one| one.name.clone()),
            speed: timing.speed(),
            delay_ms: listening.wizard.response_delay_ms,
            errors: listening.voice.errors(),
            aloud_s: listening.voice.later_s(),
            has_wizard: has_wizard(settings),
            seed,
            bodies,
        })
    }

    /// How time goes by for somebody who takes so long for a line, s, and says it aloud or writes it.
    fn pace(&self, line_s: f64, is_heard: bool) -> Pace {
        let aloud_s = if is_heard { self.aloud_s } else { 0.0 };
        Pace { line_s: line_s + aloud_s + self.delay_ms as f64 / 1000.0, speed: f64::from(self.speed) }
    }

    /// As logs note them.
    fn noted(&self) -> BTreeMap<String, String> {
        let wizard = if self.has_wizard { ACCEPTED } else { "no" };
        let agents = if self.is_expert { "expert@0" } else { "dialog@0" };
        let noted = [
            ("agents", agents.to_owned()),
            ("ask", self.asking.to_string()),
            ("knows", self.knows.to_string()),
            ("response_delay_ms", self.delay_ms.to_string()),
            ("timing", format!("real time, {} times", self.speed)),
            ("understanding", self.effort.to_string()),
            ("voice_errors", self.errors.to_string()),
            (WIZARD, wizard.to_owned()),
        ];
        let name = self.name.iter().map(|name| (format!("{NAME_OF}{BODY}"), name.clone()));
        noted.into_iter().map(|(name, value)| (name.to_owned(), value)).chain(name).collect()
    }
}

/// What two people say who ask for one thing after the other in turn: every other line of each.
fn in_turn(first: Vec<Line>, second: Vec<Line>) -> Vec<Line> {
    let both = first.into_iter().zip(second).enumerate();
    both.map(|(number, (own, others))| if number.is_multiple_of(2) { own } else { others }).collect()
}

/// Those of a study's settings that a dry run cannot act out.
pub fn unheeded<'a>(all: impl IntoIterator<Item = &'a StudySettings>) -> Vec<String> {
    let of_one = |settings: &'a StudySettings| settings.iter().filter(|(name, setting)| !acts_out(name, setting));
    let mut names: Vec<String> = all.into_iter().flat_map(of_one).map(|(name, _)| name.clone()).collect();
    names.sort();
    names.dedup();
    names
}

/// Whether a dry run acts a setting out. Of minds it has that which does what people say and the expert, in the body that people
/// speak to.
fn acts_out(name: &str, setting: &Setting) -> bool {
    let is_acted = |mind: &String| {
        let mind = mind.parse::<MindRequest>();
        mind.is_ok_and(|mind| mind.is_expert(BODY) || mind.spoken_to() == Some(BODY))
    };
    match (name, setting) {
        (AGENT, Setting::Value(mind)) => is_acted(mind),
        (AGENT, Setting::Values(minds)) => minds.iter().all(is_acted),
        _ => name == WIZARD || HEEDED.contains(&name),
    }
}

impl SimulatedPlayer for Speakers {
    fn play(&self, wanted: &SimulatedMission) -> Result<SimulatedSession, String> {
        let conditions = Conditions::of(&wanted.settings)?;
        let (file, task) = self.task(wanted)?;
        let is_file = self.folder.join(&wanted.mission).is_file();
        let speaking = &wanted.speaking;
        let settings = Settings {
            seed: conditions.seed.unwrap_or(wanted.seeds[0]),
            name: conditions.name.clone(),
            mishears: if wanted.is_heard { conditions.errors } else { 0.0 },
            bodies: conditions.bodies.clone(),
            knows: conditions.knows,
            asking: conditions.asking,
            // Who speaks aloud mistypes nothing.
            style: Some(Style {
                vagueness: speaking.vagueness,
                typos: if wanted.is_heard { 0.0 } else { speaking.typos },
                mistakes: speaking.mistakes,
            }),
            caps: None,
            record: Some(self.scratch.clone()),
        };
        let played = if conditions.is_expert {
            solve(&task, &settings, self.world.catalog())
        } else {
            play(&task, &settings, self.language(conditions.effort))
        };
        let played = played.map_err(|error| error.to_string())?;
        let raw = match (&played.log, &played.ended_early) {
            (Some(raw), _) => raw,
            (None, why) => return Err(why.clone().unwrap_or_else(|| "it left no log".to_owned())),
        };
        let log = Log::open(raw).map_err(|error| error.to_string())?;
        let pace = conditions.pace(speaking.line_s, wanted.is_heard);
        let log = SyntheticLog::new(log, pace, wanted.ends_by_s);
        let mut noted = conditions.noted();
        if wanted.partner.is_some() {
            noted.insert(SEATS.to_owned(), PAIR_SIZE.to_string());
        }
        let facts = Facts {
            session: wanted.name.clone(),
            participant: wanted.participant.clone(),
            mission_file: if is_file { wanted.mission.clone() } else { file.name },
            settings: noted,
            has_wizard: conditions.has_wizard,
            people: if wanted.partner.is_some() { PAIR_SIZE } else { 0 },
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

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(all: &[(&str, &str)]) -> StudySettings {
        all.iter().map(|(name, value)| ((*name).to_owned(), Setting::Value((*value).to_owned()))).collect()
    }

    #[test]
    fn what_can_be_acted_out_is_and_the_rest_is_said() {
        let all = [
            settings(&[("ask", "never"), ("hide", "score"), ("agent", "expert"), ("wizard", "yes")]),
            settings(&[("name", "0=Rosie"), ("renderer", "gpu"), ("hide", "figures")]),
        ];
        assert_eq!(unheeded(&all), ["hide", "renderer"]);
        for (mind, expected) in [("dialog", true), ("expert@0", true), ("helper", false), ("dialog@1", false)] {
            assert_eq!(acts_out(AGENT, &Setting::Value(mind.to_owned())), expected, "{mind}");
        }
        assert!(!acts_out("clock", &Setting::Switch(true)));
        let minds = Setting::Values(vec!["dialog".to_owned(), "random@1".to_owned()]);
        assert!(!acts_out(AGENT, &minds));
    }

    #[test]
    fn settings_are_read_as_play_reads_them() {
        let all = settings(&[
            ("agent", "expert"),
            ("name", "0=Rosie"),
            ("response_delay_ms", "1500"),
            ("seed", "9"),
            ("speed", "2"),
            ("voice-delay", "0.5"),
            ("voice-errors", "0.25"),
            ("clock", "of the pages"),
        ]);
        let conditions = Conditions::of(&all).expect("settings");
        assert!(conditions.is_expert && conditions.seed == Some(9) && conditions.bodies.is_empty());
        let noted = conditions.noted();
        for (name, value) in [
            ("agents", "expert@0"),
            ("response_delay_ms", "1500"),
            ("timing", "real time, 2 times"),
            ("voice_errors", "0.25"),
            (&format!("{NAME_OF}0"), "Rosie"),
        ] {
            assert_eq!(noted.get(name).map(String::as_str), Some(value), "{noted:?}");
        }
        let [written, aloud] = [false, true].map(|is_heard| conditions.pace(10.0, is_heard));
        assert!((written.line_s - 11.5).abs() < 1e-6 && (aloud.line_s - 13.2).abs() < 1e-6, "{aloud:?}");
        assert!((aloud.speed - 2.0).abs() < 1e-9);
        let usual = Conditions::of(&StudySettings::new()).expect("settings");
        assert!(!usual.is_expert && usual.name.is_none());
    }
}
