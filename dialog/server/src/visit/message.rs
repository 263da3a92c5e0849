//! What a page sends.

use serde::Deserialize;

use crate::{affordances::Deed, questionnaire::Given};

/// What a page sends.
#[derive(Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub(super) enum FromPage {
    /// Somebody said something.
    Say { text: String },
    /// Somebody has typed this so far. It counts for nothing until it is said.
    Typing { text: String },
    /// The page has shown its first frame.
    Shown,
    /// The page has shown a frame in which the robot first moves as it was told to in this turn.
    Drawn { turn: u64 },
    /// Somebody wants to look through another camera.
    View { camera: String },
    /// Somebody chose one of the objects that a question offers.
    Choose { object: u32 },
    /// Somebody points at something in the picture: how far from the left and from the top, 0 to 1.
    Point { camera: String, tick: u64, x: f32, y: f32 },
    /// Somebody wants to drive a body.
    DriveBody { body: u32 },
    /// Somebody gives the body back.
    Release,
    /// The keys as they are held now, as speeds: along the heading, turning, and the head's pitch.
    Drive { forward_m_s: f32, turn_rad_s: f32, pitch_rad_s: f32 },
    /// Somebody answers a questionnaire: an answer a question; `finished`, if they say that they have done what they could
    /// of a mission that is not over.
    Answer {
        questionnaire: String,
        answers: Vec<Option<Given>>,
        #[serde(default)]
        finished: bool,
    },
    /// Somebody does something to an object with the body's hand.
    Act { deed: Deed, object: u32 },
    /// Sound comes from a microphone, as binary messages of so many 16-bit samples a second; while `held`, no pause ends what
    /// is said.
    Listen { rate: u32, held: bool },
    /// What was said is all.
    Listened,
    /// What was heard is meant, perhaps in other words, or is to be forgotten; `sure`, if somebody read it and said so.
    Heard { number: u64, text: Option<String>, sure: bool },
    /// Somebody wants to hear what robots say, or not.
    Aloud { on: bool },
    /// The page plays the first sound of an answer.
    Sounded { turn: u64 },
    /// The page says a text with its browser's voice, from now on; or no more.
    OwnVoice { text: Option<String> },
}
