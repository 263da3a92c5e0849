//! What was said, how long answers took, and what the robot asks about.

use cohabit_cdf::{Action, ObjectId};
use cohabit_record::{AnswerEntry, DialogEntry};
use re_sdk_types::{
    archetypes::{Scalars, SeriesLines, SeriesPoints, StateChange, TextLog},
    components::{MarkerShape, TextLogLevel},
};

use crate::{
    deeds::colored,
    recording::{Recording, Side},
};

/// Where each kind of speech goes, how it is marked, and its colour.
struct Voice {
    kind: &'static str,
    path: &'static str,
    level: &'static str,
    color: [u8; 3],
}

const VOICES: [Voice; 3] = [
    Voice { kind: "Utterance", path: "dialog/person", level: "PERSON", color: [125, 170, 255] },
    Voice { kind: "Reply", path: "dialog/robot", level: TextLogLevel::INFO, color: [140, 215, 150] },
    Voice { kind: "Question", path: "dialog/robot", level: "QUESTION", color: [255, 196, 61] },
];

/// What is measured of a turn.
struct Measure {
    /// The kind of entry that has its stamps.
    kind: &'static str,
    /// From which of them to which.
    between: [usize; 2],
    path: &'static str,
    name: &'static str,
    color: [u8; 3],
}

const MEASURES: [Measure; 6] = [
    Measure::new("Spoken", [1, 2], "latency/heard", "words, after speech", [190, 160, 255]),
    Measure::new("Latency", [0, 1], "latency/understood", "understood", [125, 170, 255]),
    Measure::new("Latency", [0, 2], "latency/moved", "first motion", [140, 215, 150]),
    Measure::new("Latency", [0, 3], "latency/framed", "first changed frame", [255, 196, 61]),
    Measure::new("Latency", [0, 4], "latency/shown", "shown by a page", [236, 64, 122]),
    Measure::new("Spoken", [3, 4], "latency/sounded", "first sound, after understanding", [120, 220, 220]),
];

impl Measure {
    const fn new(
        kind: &'static str,
        between: [usize; 2],
        path: &'static str,
        name: &'static str,
        color: [u8; 3],
    ) -> Self {
        Self { kind, between, path, name, color }
    }
}

/// The colours of what speech sounded like, and of answers to questionnaires.
const HEARD: [u8; 3] = [150, 150, 150];
const ANSWERED: [u8; 3] = [190, 160, 255];

/// What the robot is about, in its lane.
const LANE: &str = "states/conversation";
/// What that may be, and its colours.
const ABOUT: [(&str, [u8; 3]); 3] =
    [("understands", [90, 130, 200]), ("asks", [190, 140, 30]), ("acts", [60, 130, 140])];

/// The conversation of one session.
#[derive(Debug, Default)]
pub struct Talk {
    /// What was last said, if that was a question: its turn.
    question: Option<u64>,
    asked: Vec<ObjectId>,
    /// What was measured of the newest turn, and told.
    told: (u64, [bool; MEASURES.len()]),
    /// The newest turn of which it was told what it sounded like.
    heard: u64,
}

impl Talk {
    /// A conversation in which nothing was said yet; tells how its plots look.
    pub fn new(recording: &Recording) -> anyhow::Result<Self> {
        for Measure { path, name, color, .. } in MEASURES {
            recording.log_line(path, name, color, SeriesLines::new().with_widths([1.5]))?;
            recording.log_always(path, &points(recording.side, name, color))?;
        }
        recording.log_always(LANE, &colored(&ABOUT))?;
        Ok(Self::default())
    }

    /// The objects that the question is about which waits for an answer.
    pub fn asked(&self) -> &[ObjectId] {
        &self.asked
    }

    /// Tells a message of the dialog. Whether what is asked about changed.
    pub fn hear(&mut self, recording: &Recording, entry: &DialogEntry) -> anyhow::Result<bool> {
        if let Some(voice) = VOICES.iter().find(|voice| voice.kind == entry.kind) {
            let text = TextLog::new(entry.text.as_str()).with_level(voice.level).with_color(voice.color);
            recording.log(voice.path, &text)?;
        }
        let before = self.asked.len();
        match entry.kind.as_str() {
            "Utterance" => {
                (self.question, self.asked) = (None, Vec::new());
                recording.log(LANE, &StateChange::single("understands"))?;
            }
            "Question" => {
                self.question = Some(entry.turn);
                recording.log(LANE, &StateChange::single("asks"))?;
            }
            // What a question is about is pointed out.
            "Plan" if self.question.is_some() && entry.steps.iter().all(is_pointing) => {
                self.asked = entry.steps.iter().filter_map(pointed).collect();
            }
            "Plan" => {
                self.question = None;
                recording.log(LANE, &StateChange::single("acts"))?;
            }
            "Reply" | "PlanEnded" if self.question.is_none() => recording.log(LANE, &StateChange::single(""))?,
            "Latency" => self.measure(recording, entry)?,
            "Spoken" => {
                self.sounded(recording, entry)?;
                self.measure(recording, entry)?;
            }
            _ => {}
        }
        Ok(self.asked.len() != before)
    }

    fn measure(&mut self, recording: &Recording, entry: &DialogEntry) -> anyhow::Result<()> {
        if self.told.0 != entry.turn {
            self.told = (entry.turn, [false; MEASURES.len()]);
        }
        for (measure, told) in MEASURES.iter().zip(&mut self.told.1).filter(|(measure, _)| measure.kind == entry.kind) {
            let [from, to] = measure.between.map(|stamp| entry.stamps[stamp]);
            if from != 0 && to != 0 && !*told {
                *told = true;
                recording.log(measure.path, &Scalars::single(to.saturating_sub(from) as f64 * 1e-6))?;
            }
        }
        Ok(())
    }

    /// Tells what a spoken turn sounded like, once.
    fn sounded(&mut self, recording: &Recording, entry: &DialogEntry) -> anyhow::Result<()> {
        if self.heard == entry.turn || entry.text.is_empty() {
            return Ok(());
        }
        self.heard = entry.turn;
        let text = TextLog::new(format!("“{}”", entry.text)).with_level("HEARD").with_color(HEARD);
        recording.log("dialog/heard", &text)
    }

    /// Tells what a person answered to a question of a questionnaire.
    pub fn answered(recording: &Recording, entry: &AnswerEntry) -> anyhow::Result<()> {
        let AnswerEntry { questionnaire, item, question, text, value, .. } = entry;
        let answer = match value {
            Some(value) if text.is_empty() => value.to_string(),
            Some(value) => format!("{value}: {text}"),
            None => text.clone(),
        };
        let said = TextLog::new(format!("{questionnaire} {item}. {question} — {answer}"));
        recording.log("dialog/questionnaires", &said.with_level("ANSWER").with_color(ANSWERED))
    }
}

/// The points of a plot, which two sessions have in different shapes.
fn points(side: Side, name: &str, color: [u8; 3]) -> SeriesPoints {
    let shape = if side == Side::B { MarkerShape::Diamond } else { MarkerShape::Circle };
    let points = SeriesPoints::new().with_names([side.name(name)]).with_colors([side.color(color)]);
    points.with_markers([shape]).with_marker_sizes([3.0])
}

const fn is_pointing(action: &Action) -> bool {
    matches!(action, Action::Highlight { .. })
}

const fn pointed(action: &Action) -> Option<ObjectId> {
    match action {
        Action::Highlight { object } => Some(*object),
        _ => None,
    }
}
