//! What was said aloud: which of its readings is meant, and whether the robot had better ask.

use cohabit_language::{Language, Understanding};

/// What somebody said aloud, as it was heard.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spoken {
    /// What it may be, the likeliest first, each with the logarithm of how likely it is, a token.
    pub readings: Vec<(String, f32)>,
    /// What it sounds like by itself.
    pub raw: String,
    /// How far the first reading is to be trusted, 0 to 1.
    pub confidence: f32,
    /// When it began, when it ended, and when its text was there, ns.
    pub began_nanos: u64,
    /// See [`Spoken::began_nanos`].
    pub ended_nanos: u64,
    /// See [`Spoken::began_nanos`].
    pub text_nanos: u64,
}

/// So many readings are tried.
const MOST_TRIED: usize = 5;
/// A reading that is less likely than the first one by more than this is not what was said.
const MARGIN: f32 = 0.6;
/// What is trusted less is asked about before it is done.
pub const SURE: f32 = 0.5;
/// What is trusted less and makes no sense is nothing that anybody said.
const NOISE: f32 = 0.25;

/// What a reading makes of the robot's day, the better the higher.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub enum Sense {
    /// It does not know what that is.
    None,
    /// It knows, and cannot.
    Refused,
    /// It has to ask.
    Asks,
    /// It does that, or answers.
    Clear,
}

/// The reading that is meant.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Its words.
    pub text: String,
    /// What they mean here.
    pub sense: Sense,
    /// Whether something would be done about it.
    pub acts: bool,
}

impl Reading {
    /// The reading of `spoken` that makes sense, as `understand` does it: the likeliest that is clear, else the likeliest that
    /// makes any sense, else what it sounds like by itself. `None` if nobody seems to have said anything.
    pub fn of(spoken: &Spoken, understand: impl Fn(&str) -> Understanding) -> Option<Self> {
        let (_, best_score) = spoken.readings.first()?;
        let near = spoken.readings.iter().filter(|(_, score)| *score >= best_score - MARGIN);
        let mut best: Option<Self> = None;
        for (text, _) in near.take(MOST_TRIED) {
            let reading = Self::new(text, &understand(text));
            if reading.sense == Sense::Clear {
                return Some(reading);
            }
            if best.as_ref().is_none_or(|best| reading.sense > best.sense) {
                best = Some(reading);
            }
        }
        let best = best.filter(|best| best.sense > Sense::None).unwrap_or_else(|| Self {
            text: if spoken.raw.is_empty() { spoken.readings[0].0.clone() } else { spoken.raw.clone() },
            sense: Sense::None,
            acts: false,
        });
        (best.sense > Sense::None || spoken.confidence >= NOISE).then_some(best)
    }

    fn new(text: &str, understanding: &Understanding) -> Self {
        let sense = match understanding {
            Understanding::Plan { .. } | Understanding::Stop { .. } | Understanding::Answer { .. } => Sense::Clear,
            Understanding::Question { .. } => Sense::Asks,
            Understanding::Refusal { is_lost: false, .. } => Sense::Refused,
            Understanding::Refusal { is_lost: true, .. } => Sense::None,
        };
        Self { text: text.to_owned(), sense, acts: matches!(understanding, Understanding::Plan { .. }) }
    }

    /// Whether the robot asks before it does it.
    pub fn is_doubtful(&self, confidence: f32, language: &Language) -> bool {
        self.acts && confidence < SURE && language.may_ask()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::sync::Arc;

    use cohabit_cdf::{Catalog, RoomId};
    use cohabit_language::{Asking, Context, Known, KnownRobot};

    use super::*;

    fn read(readings: &[(&str, f32)], raw: &str, confidence: f32) -> Option<Reading> {
        let language = Language::new(Arc::new(Catalog::builtin()));
        let robot = KnownRobot { position_m: [0.0; 3], yaw_rad: 0.0, room: RoomId::Lab1, held: None };
        let scene = Known { robot, objects: vec![], goals: vec![], floor: None, person: None };
        let readings = readings.iter().map(|(text, score)| ((*text).to_owned(), *score)).collect();
        let spoken = Spoken { readings, raw: raw.to_owned(), confidence, ..Spoken::default() };
        Reading::of(&spoken, |text| language.understand(text, &scene, &mut Context::default()))
    }

    #[test]
    fn the_reading_that_makes_sense_is_meant() {
        let meant =
            read(&[("vote bored zebra", -0.1), ("go to the break room", -0.3)], "vote bored zebra", 0.9).unwrap();
        assert_eq!((meant.text.as_str(), meant.sense, meant.acts), ("go to the break room", Sense::Clear, true));
        let first = read(&[("turn left", -0.1), ("turn right", -0.2)], "turn left", 0.9).unwrap();
        assert_eq!(first.text, "turn left");
    }

    #[test]
    fn what_is_far_less_likely_is_not_taken_for_it() {
        let said = "play some jazz music please";
        let meant = read(&[(said, -0.1), ("go to the break room", -2.0)], said, 0.8).unwrap();
        assert_eq!((meant.text.as_str(), meant.acts), (said, false));
        let meant = read(&[("blorp the zargle", -0.1)], "blorp the zargle", 0.8).unwrap();
        assert_eq!(meant.sense, Sense::None);
    }

    #[test]
    fn what_makes_no_sense_and_is_not_trusted_is_nothing() {
        assert_eq!(read(&[("you", -0.5)], "you", 0.1), None);
        assert_eq!(read(&[], "", 0.0), None);
    }

    #[test]
    fn a_doubtful_request_is_asked_about_unless_nothing_is_to_be() {
        let language = Language::new(Arc::new(Catalog::builtin()));
        let meant = read(&[("go to the break room", -0.1)], "", 0.3).unwrap();
        assert!(meant.is_doubtful(0.3, &language) && !meant.is_doubtful(0.9, &language));
        assert!(!meant.is_doubtful(0.3, &language.clone().asking(Asking::Never)));
        let question = read(&[("what is left?", -0.1)], "", 0.3).unwrap();
        assert!(!question.is_doubtful(0.3, &language));
    }
}
