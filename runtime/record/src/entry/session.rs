//! What was played, and how.

use std::collections::BTreeMap;

use cohabit_bus::{CameraId, Envelope, message::MissionMessage};
use cohabit_cdf::{BodyRequest, Catalog, Layout, PackId};
use serde::{Deserialize, Serialize};

use super::{Entry, fingerprint, is_zero, run};

/// What was played: the first entry, repeated further behind.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct SessionEntry {
    /// Counts changes of this format.
    pub format: u32,
    /// The version of the program that wrote it.
    pub program: String,
    /// The build of it, as its linker named it; empty if it did not.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub build: String,
    /// The version of the messages on its bus.
    #[serde(default)]
    pub messages: u32,
    /// The session's name.
    pub session: String,
    /// The mission file's name.
    pub mission_file: String,
    /// The mission file's text.
    pub mission_text: String,
    /// The seed of all that was random.
    pub seed: u64,
    /// Bodies beside those of the mission.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bodies: Vec<BodyRequest>,
    /// The simulator's run, unlike that of any other; 0 where there was none.
    #[serde(default, with = "run", skip_serializing_if = "is_zero")]
    pub run: u64,
    /// Stands for the catalogue of objects that it was played with; empty if that was not noted.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub catalog: String,
    /// Stands for its floor plan.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub layout: String,
    /// The world packs that it was played with, in their order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub packs: Vec<PackId>,
    /// What the participant is called in the study: a label, not a name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub participant: Option<String>,
    /// How it was played, by the names of the options.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub settings: BTreeMap<String, String>,
    /// The cameras beside those of the bodies, as `--camera` has them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cameras: Vec<String>,
    /// The cameras whose frames are in the log.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub frames: Vec<String>,
    /// Whether what was said aloud is in the log.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub audio: bool,
    /// The session that it went on from, if it did not begin at the beginning.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub branched: Option<Branch>,
}

/// A point of another session.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Branch {
    /// The other session's name.
    pub session: String,
    /// Its simulator's run.
    #[serde(default, with = "run", skip_serializing_if = "is_zero")]
    pub run: u64,
    /// The tick after which this one goes on.
    pub tick: u64,
}

/// What is noted of a session besides what is told on its bus.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SessionFacts {
    /// Its name.
    pub session: String,
    /// The build of the program that plays it.
    pub build: String,
    /// What the participant is called in the study.
    pub participant: Option<String>,
    /// How it is played, by the names of the options.
    pub settings: BTreeMap<String, String>,
    /// The cameras beside those of the bodies, as `--camera` has them.
    pub cameras: Vec<String>,
    /// The cameras whose frames are recorded.
    pub frames: Vec<CameraId>,
    /// Whether what is said aloud is recorded: people agreed to it.
    pub audio: bool,
    /// The session that it goes on from.
    pub branched: Option<Branch>,
}

impl SessionFacts {
    /// A session of that name, of which nothing more is known.
    #[must_use]
    pub fn named(session: &str) -> Self {
        Self { session: session.to_owned(), ..Self::default() }
    }
}

impl SessionEntry {
    /// The format this build writes: 2 since segments are sealed, and digests tell the parts of the state apart; 3 since
    /// this entry is repeated, and channels have fixed numbers.
    pub const FORMAT: u32 = 3;

    /// The entry of a mission as a simulator published it.
    #[must_use]
    pub fn new(facts: &SessionFacts, mission: &MissionMessage) -> Self {
        let SessionFacts { session, build, participant, settings, cameras, frames, audio, branched } = facts.clone();
        Self {
            format: Self::FORMAT,
            program: env!("CARGO_PKG_VERSION").to_owned(),
            build,
            messages: Envelope::VERSION,
            session,
            mission_file: mission.header.file.as_str().to_owned(),
            mission_text: mission.text.clone(),
            seed: mission.header.seed,
            bodies: mission.bodies.clone(),
            run: 0,
            catalog: String::new(),
            layout: String::new(),
            packs: Vec::new(),
            participant,
            settings,
            cameras,
            frames: frames.iter().map(ToString::to_string).collect(),
            audio,
            branched,
        }
    }

    /// The same with what stands for the catalogue and the floor plan that it is played with, and with their world packs.
    #[must_use]
    pub fn with(mut self, catalog: &Catalog, layout: &Layout) -> Self {
        let packs = catalog.packs().to_vec();
        if !packs.is_empty() {
            let named: Vec<String> = packs.iter().map(ToString::to_string).collect();
            self.settings.insert("world".to_owned(), named.join("; "));
        }
        Self { catalog: fingerprint(catalog.classes()), layout: fingerprint(layout), packs, ..self }
    }
}

impl Entry for SessionEntry {
    const TOPIC: &'static str = "/session";
    const SCHEMA: &'static str = r#"{"title":"Session","type":"object","properties":{"format":{"type":"integer"},"program":{"type":"string"},"build":{"type":"string"},"messages":{"type":"integer"},"session":{"type":"string"},"mission_file":{"type":"string"},"mission_text":{"type":"string"},"seed":{"type":"integer"},"bodies":{"type":"array","items":{"type":"object"}},"run":{"type":"string"},"catalog":{"type":"string"},"layout":{"type":"string"},"packs":{"type":"array","items":{"type":"object"}},"participant":{"type":"string"},"settings":{"type":"object"},"cameras":{"type":"array","items":{"type":"string"}},"frames":{"type":"array","items":{"type":"string"}},"audio":{"type":"boolean"},"branched":{"type":"object"}}}"#;
}
