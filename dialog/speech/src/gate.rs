//! Whether what a language model makes of the sound may stand for what was heard without it.
//!
//! Without a gate, whatever is said becomes something likely ("play some jazz music please" → "place").

use crate::{bias, distance, ngram::NGram};

/// The most that the words may differ from those heard, as a share of these; from measurements on off-domain speech.
const FARTHEST: f32 = 0.6;
/// The shortest they may be, as a share of those heard.
const SHORTEST: f32 = 0.6;

/// Whether `domain` may stand for `raw`: the model knows what it has of other words, it is near enough, and not much shorter.
pub(crate) fn is_open(model: &NGram, domain: &str, raw: &str) -> bool {
    let (domain, raw) = (bias::words(domain), bias::words(raw));
    let (length, heard) = (domain.len() as f32, raw.len() as f32);
    length > 0.0
        && domain.iter().all(|word| model.knows(word) || raw.contains(word))
        && length >= SHORTEST * heard
        && distance::words(&domain, &raw) as f32 <= FARTHEST * heard
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::Bias;

    #[test]
    fn only_what_is_near_passes() {
        let bias =
            Bias::of(["go to the break room and pick up the bowl", "place it on the table", "turn right", "stop"]);
        let model = NGram::of(&bias).unwrap();
        let check = |domain: &str, raw: &str, expected: bool| {
            assert_eq!(is_open(&model, domain, raw), expected, "{domain} for {raw}");
        };
        check("Go to the break room.", "Go to the brake room.", true);
        check("Turn right.", "Turn light", true);
        check("Place.", "Play some jazz music please.", false);
        check("Pick up the bowl.", "Pick up the zebra and the bowl and the other one", false);
        check("Go to the jazz room", "Go to the chess room", false);
        check("Go to the jazz room and stop", "Go to the jazz room and top", true);
        check("stop", "", false);
        check("", "Stop", false);
        check("stop", "stop", true);
        check("stop", "top", false);
    }
}
