//! What was said, how long answers took, and what the robot asks about.

use cohabit_cdf::{Action, ObjectId};
use cohabit_record::DialogEntry;
use re_sdk_types::{
    archetypes::{Scalars, SeriesLines, SeriesPoints, StateChange, TextLog},
    components::TextLogLevel,
};

use crate::{deeds::colored, recording::Recording};

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

/// What is measured of a turn, in the order of its stamps after the first.
const LATENCIES: [(&str, &str, [u8; 3]); 4] = [
    ("latency/understood", "understood", [125, 170, 255]),
    ("latency/moved", "first motion", [140, 215, 150]),
    ("latency/framed", "first changed frame", [255, 196, 61]),
    ("latency/shown", "shown by a page", [236, 64, 122]),
];

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
    /// Latencies told already, by turn.
    told: (u64, [bool; 4]),
}

impl Talk {
    /// A conversation in which nothing was said yet; tells how its plots look.
    pub fn new(recording: &Recording) -> anyhow::Result<Self> {
        for (path, name, color) in LATENCIES {
            recording
                .log_always(path, &SeriesLines::new().with_names([name]).with_colors([color]).with_widths([1.5]))?;
            recording.log_always(
                path,
                &SeriesPoints::new().with_names([name]).with_colors([color]).with_marker_sizes([3.0]),
            )?;
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
            _ => {}
        }
        Ok(self.asked.len() != before)
    }

    fn measure(&mut self, recording: &Recording, entry: &DialogEntry) -> anyhow::Result<()> {
        if self.told.0 != entry.turn {
            self.told = (entry.turn, [false; 4]);
        }
        let [received, later @ ..] = entry.stamps;
        for (((path, ..), stamp), told) in LATENCIES.into_iter().zip(later).zip(&mut self.told.1) {
            if stamp != 0 && !*told {
                *told = true;
                recording.log(path, &Scalars::single(stamp.saturating_sub(received) as f64 * 1e-6))?;
            }
        }
        Ok(())
    }
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
