//! What a log holds, as JSON messages of MCAP channels.

use std::collections::BTreeMap;

use cohabit_bus::{
    CameraId, Envelope,
    message::{
        AnswerKind, AnswerMessage, CommandMessage, DialogKind, DialogView, EventMessage, MissionMessage, PlanStep,
        TickView,
    },
};
use cohabit_cdf::{Action, BodyRequest, Catalog, Layout, Status};
use serde::{Deserialize, Serialize};

/// The kinds of entries, each on its own channel.
pub(crate) trait Entry: Serialize + for<'de> Deserialize<'de> {
    /// The channel's topic.
    const TOPIC: &'static str;
    /// The JSON Schema of the entries, for other tools.
    const SCHEMA: &'static str;
}

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
            participant,
            settings,
            cameras,
            frames: frames.iter().map(ToString::to_string).collect(),
            audio,
            branched,
        }
    }

    /// The same with what stands for the catalogue and the floor plan that it is played with.
    #[must_use]
    pub fn with(self, catalog: &Catalog, layout: &Layout) -> Self {
        Self { catalog: fingerprint(catalog.classes()), layout: fingerprint(layout), ..self }
    }
}

/// Stands for a value: another one has another.
#[must_use]
pub fn fingerprint(value: &(impl std::fmt::Debug + ?Sized)) -> String {
    hex(&blake3::hash(format!("{value:?}").as_bytes()).as_bytes()[..8])
}

impl Entry for SessionEntry {
    const TOPIC: &'static str = "/session";
    const SCHEMA: &'static str = r#"{"title":"Session","type":"object","properties":{"format":{"type":"integer"},"program":{"type":"string"},"build":{"type":"string"},"messages":{"type":"integer"},"session":{"type":"string"},"mission_file":{"type":"string"},"mission_text":{"type":"string"},"seed":{"type":"integer"},"bodies":{"type":"array","items":{"type":"object"}},"run":{"type":"string"},"catalog":{"type":"string"},"layout":{"type":"string"},"participant":{"type":"string"},"settings":{"type":"object"},"cameras":{"type":"array","items":{"type":"string"}},"frames":{"type":"array","items":{"type":"string"}},"audio":{"type":"boolean"},"branched":{"type":"object"}}}"#;
}

/// One tick: what went in, and the digest of what came out.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct TickEntry {
    /// Its number.
    pub tick: u64,
    /// The digest of the simulated state after it, in hexadecimal: 16 digits for each part of the state.
    pub digest: String,
    /// Wall time of its start, ns since 1970: the time of the message that holds the entry.
    #[serde(default, skip_serializing)]
    pub wall_nanos: u64,
    /// What it took in.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub inputs: Vec<InputEntry>,
}

/// One input.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct InputEntry {
    /// The command's number.
    pub command: u64,
    /// The dialog turn it belongs to; 0 is none.
    pub turn: u64,
    /// Which body.
    pub body: u32,
    /// What to do.
    pub action: Action,
}

impl TickEntry {
    /// The entry of a tick as published.
    #[must_use]
    pub fn new(tick: u64, view: TickView<'_>) -> Self {
        let inputs = view.inputs.iter().filter_map(InputEntry::new).collect();
        Self { tick, digest: hex(&view.header.digest), wall_nanos: view.header.wall_nanos, inputs }
    }
}

impl InputEntry {
    /// The entry of a command; `None` if its action is malformed (no world took it then).
    #[must_use]
    pub fn new(message: &CommandMessage) -> Option<Self> {
        let action = Action::try_from(message.action).ok()?;
        Some(Self { command: message.command, turn: message.turn, body: message.body, action })
    }
}

fn is_zero<N: Default + PartialEq>(number: &N) -> bool {
    *number == N::default()
}

/// Format 1 had four, and not when the frame was shown.
fn stamps<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<[u64; 5], D::Error> {
    let found = Vec::<u64>::deserialize(deserializer)?;
    Ok(std::array::from_fn(|index| found.get(index).copied().unwrap_or(0)))
}

/// A run's number, in hexadecimal: it has more bits than numbers of JSON hold exactly.
mod run {
    use serde::{Deserialize as _, Deserializer, Serializer, de::Error as _};

    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks so")]
    pub fn serialize<S: Serializer>(run: &u64, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(&format_args!("{run:x}"))
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u64, D::Error> {
        let text = std::borrow::Cow::<str>::deserialize(deserializer)?;
        u64::from_str_radix(&text, 16).map_err(D::Error::custom)
    }
}

/// A digest as a log writes it.
#[must_use]
pub fn hex(bytes: &[u8]) -> String {
    use std::fmt::Write as _;
    bytes.iter().fold(String::with_capacity(2 * bytes.len()), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

impl Entry for TickEntry {
    const TOPIC: &'static str = "/ticks";
    const SCHEMA: &'static str = r#"{"title":"Tick","type":"object","properties":{"tick":{"type":"integer"},"digest":{"type":"string"},"inputs":{"type":"array","items":{"type":"object"}}}}"#;
}

/// Something that happened.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct EventEntry {
    /// When.
    pub tick: u64,
    /// What kind of event.
    pub kind: String,
    /// The body concerned.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub body: Option<u32>,
    /// The command concerned.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub command: Option<u64>,
    /// The dialog turn concerned.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub turn: Option<u64>,
    /// The goal concerned.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub goal: Option<i64>,
    /// The object concerned.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub object: Option<u32>,
    /// An outcome's status.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub status: Option<Status>,
    /// A sentence for people.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub text: String,
    /// Whose run sent it; 0 where none did.
    #[serde(default, with = "run", skip_serializing_if = "is_zero")]
    pub run: u64,
    /// That run's count of events, from 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub sequence: u64,
}

impl EventEntry {
    /// The entry of an event as published; `None` if it is of no known kind.
    #[must_use]
    pub fn new(envelope: &Envelope, message: &EventMessage) -> Option<Self> {
        use cohabit_bus::message::{EventKind, NONE};
        let kind = message.kind()?;
        let goal = matches!(kind, EventKind::GoalMet | EventKind::GoalReset).then_some(message.number);
        let status = if kind == EventKind::Outcome { message.status() } else { None };
        let present = |value: u32| (value != NONE).then_some(value);
        Some(Self {
            tick: envelope.tick,
            kind: format!("{kind:?}"),
            body: present(message.body),
            command: (message.command != 0).then_some(message.command),
            turn: (message.turn != 0).then_some(message.turn),
            goal,
            object: present(message.object),
            status,
            text: message.text.as_str().to_owned(),
            run: envelope.run,
            sequence: envelope.sequence,
        })
    }
}

impl Entry for EventEntry {
    const TOPIC: &'static str = "/events";
    const SCHEMA: &'static str = r#"{"title":"Event","type":"object","properties":{"tick":{"type":"integer"},"kind":{"type":"string"},"body":{"type":"integer"},"command":{"type":"integer"},"turn":{"type":"integer"},"goal":{"type":"integer"},"object":{"type":"integer"},"status":{"type":"string"},"text":{"type":"string"},"run":{"type":"string"},"sequence":{"type":"integer"}}}"#;
}

/// Something that was said, planned or done about a turn.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct DialogEntry {
    /// The newest tick that was recorded before it.
    #[serde(default)]
    pub tick: u64,
    /// What kind of dialog message.
    pub kind: String,
    /// The turn; 0 is none.
    pub turn: u64,
    /// The body spoken to, or speaking.
    pub body: u32,
    /// The number of the page at which a person said it; 0 where none did.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub person: u32,
    /// Which step of the turn's plan.
    pub step: u32,
    /// How the step went.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub status: Option<Status>,
    /// When it was sent, ns of the machine's monotonic clock.
    pub sent_nanos: u64,
    /// Received, understood, first motion, first changed frame, that frame shown by a page: ns of the same clock, 0
    /// where it did not happen (yet). A turn's last entry knows most.
    #[serde(deserialize_with = "stamps")]
    pub stamps: [u64; 5],
    /// What was said.
    pub text: String,
    /// A plan's steps.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub steps: Vec<Action>,
    /// The answers that a question offers.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub offers: Vec<OfferEntry>,
    /// Whose run sent it; 0 where none did.
    #[serde(default, with = "run", skip_serializing_if = "is_zero")]
    pub run: u64,
    /// That run's count of dialog messages, from 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub sequence: u64,
}

/// An answer that a question offers.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct OfferEntry {
    /// What it says.
    pub text: String,
    /// The object that it means, if it means one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub object: Option<u32>,
}

impl OfferEntry {
    fn new(offer: &PlanStep) -> Self {
        let object = match Action::try_from(offer.action) {
            Ok(Action::Highlight { object }) => Some(object.0),
            _ => None,
        };
        Self { text: offer.says.as_str().to_owned(), object }
    }
}

impl DialogEntry {
    /// The entry of a dialog message as published when `tick` was the newest; `None` if it is of no known kind.
    #[must_use]
    pub fn new(tick: u64, envelope: &Envelope, view: DialogView<'_>) -> Option<Self> {
        let kind = view.header.kind()?;
        let asks = kind == DialogKind::Question;
        let action = |step: &PlanStep| Action::try_from(step.action).ok();
        Some(Self {
            tick,
            kind: format!("{kind:?}"),
            turn: view.header.turn,
            body: view.header.body,
            person: view.header.person,
            step: view.header.step,
            status: view.header.status(),
            sent_nanos: envelope.sent_nanos,
            stamps: view.header.stamps,
            text: view.header.text.as_str().to_owned(),
            steps: if asks { Vec::new() } else { view.steps.iter().filter_map(action).collect() },
            offers: if asks { view.steps.iter().map(OfferEntry::new).collect() } else { Vec::new() },
            run: envelope.run,
            sequence: envelope.sequence,
        })
    }
}

impl Entry for DialogEntry {
    const TOPIC: &'static str = "/dialog";
    const SCHEMA: &'static str = r#"{"title":"Dialog","type":"object","properties":{"tick":{"type":"integer"},"kind":{"type":"string"},"turn":{"type":"integer"},"body":{"type":"integer"},"person":{"type":"integer"},"step":{"type":"integer"},"status":{"type":"string"},"sent_nanos":{"type":"integer"},"stamps":{"type":"array","items":{"type":"integer"}},"text":{"type":"string"},"steps":{"type":"array","items":{"type":["object","string"]}},"offers":{"type":"array","items":{"type":"object"}},"run":{"type":"string"},"sequence":{"type":"integer"}}}"#;
}

/// What a person answered to a question of a questionnaire; the newest to a question counts.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct AnswerEntry {
    /// The newest tick that was recorded before it.
    pub tick: u64,
    /// The number of the person's page.
    pub person: u32,
    /// The questionnaire's name.
    pub questionnaire: String,
    /// Which question, from 1.
    pub item: u32,
    /// What was asked.
    pub question: String,
    /// What kind of answer it is.
    pub kind: String,
    /// The number that was chosen.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value: Option<i32>,
    /// The lowest and the highest number of its scale.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<[i32; 2]>,
    /// Whether a high number means little of what the questionnaire measures.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub reversed: bool,
    /// The words, or what was chosen says.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub text: String,
    /// Whose run sent it; 0 where none did.
    #[serde(default, with = "run", skip_serializing_if = "is_zero")]
    pub run: u64,
    /// That run's count of answers, from 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub sequence: u64,
}

impl AnswerEntry {
    /// The entry of an answer as published when `tick` was the newest; `None` if it is of no known kind.
    #[must_use]
    pub fn new(tick: u64, envelope: &Envelope, message: &AnswerMessage) -> Option<Self> {
        let kind = message.kind()?;
        Some(Self {
            tick,
            person: message.person,
            questionnaire: message.questionnaire.as_str().to_owned(),
            item: message.item,
            question: message.question.as_str().to_owned(),
            kind: format!("{kind:?}"),
            value: (kind != AnswerKind::Words).then_some(message.value),
            scale: (kind == AnswerKind::Scale).then_some([message.least, message.most]),
            reversed: message.reversed != 0,
            text: message.text.as_str().to_owned(),
            run: envelope.run,
            sequence: envelope.sequence,
        })
    }
}

impl Entry for AnswerEntry {
    const TOPIC: &'static str = "/answers";
    const SCHEMA: &'static str = r#"{"title":"Answer","type":"object","properties":{"tick":{"type":"integer"},"person":{"type":"integer"},"questionnaire":{"type":"string"},"item":{"type":"integer"},"question":{"type":"string"},"kind":{"type":"string"},"value":{"type":"integer"},"scale":{"type":"array","items":{"type":"integer"}},"reversed":{"type":"boolean"},"text":{"type":"string"},"run":{"type":"string"},"sequence":{"type":"integer"}}}"#;
}

/// What nobody took down in time: the recorder was away, or its disk slow, for longer than the bus keeps messages.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, PartialEq, Serialize)]
pub struct GapEntry {
    /// The newest tick when that was noticed.
    pub tick: u64,
    /// Ticks that are missing before it.
    pub ticks: u64,
    /// Events that are missing.
    pub events: u64,
    /// Dialog messages that are missing.
    pub dialog: u64,
    /// Answers to questionnaires that are missing.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub answers: u64,
}

impl GapEntry {
    /// Messages missing in all.
    #[must_use]
    pub const fn messages(&self) -> u64 {
        self.ticks.saturating_add(self.events).saturating_add(self.dialog).saturating_add(self.answers)
    }
}

impl std::fmt::Display for GapEntry {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { tick, ticks, events, dialog, answers } = self;
        write!(
            f,
            "{ticks} ticks, {events} events, {dialog} dialog messages and {answers} answers before tick {tick} "
        )?;
        f.write_str("are missing: its recorder was away, or its disk slow, for too long")
    }
}

impl Entry for GapEntry {
    const TOPIC: &'static str = "/gaps";
    const SCHEMA: &'static str = r#"{"title":"Gap","type":"object","properties":{"tick":{"type":"integer"},"ticks":{"type":"integer"},"events":{"type":"integer"},"dialog":{"type":"integer"},"answers":{"type":"integer"}}}"#;
}
