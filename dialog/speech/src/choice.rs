//! Which of the readings of what was said is meant, and whether it had better be asked about before it is done.
//!
//! Who understands the language says what each reading comes to ([`Meaning`]); nothing of the language is known here.

use crate::{Hypothesis, Recognition, bias};

/// So many readings are tried: each takes as long as understanding a sentence.
const MOST_TRIED: usize = 8;
/// How much likelier a reading must be that makes less sense, as a logarithm: where it is not quite clear, where it is vague, where
/// it makes none; and more for words that nobody told the recogniser of. Chosen on one half of the commands of the bench.
const LESS: [f32; 4] = [6.0, 4.0, 1.5, 0.0];
const STRANGE: f32 = 4.0;
/// So little speaks for what something is done about.
const IDLE: f32 = 0.1;
/// A deed that is less likely to be meant is asked about before it is done.
const SURE: f32 = 0.75;
/// What speaks for a deed, as the logarithm of its odds: a logistic regression over what came of the commands of the bench. Fitted
/// to either half of them, it tells as much of the other.
const ODDS: Odds = Odds { base: 3.6, fit: 2.6, lead: 0.26, share: 1.36, length: -1.36 };
/// A deed that leads by more is not said to be likelier for it; one that leads by less is asked about at any odds.
const FAR: f32 = 8.0;
const NEAR: f32 = 2.0;
/// So is one whose reading fits the sound less well.
const DIM: f32 = 0.3;
/// What fits the sound less well, and makes no sense, is nothing that anybody said.
const NOISE: f32 = 0.25;

/// How much sense a reading makes to who hears it, the more the higher.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub enum Sense {
    /// It is not known what that is.
    None,
    /// Nearly all of it has to be asked about.
    Vague,
    /// Something has to be asked about it, or it cannot be.
    Asks,
    /// It is done, or answered.
    Clear,
}

/// What a reading comes to.
#[derive(Clone, Debug, PartialEq)]
pub struct Meaning<D> {
    /// How much sense it makes.
    pub sense: Sense,
    /// What would be done; `None` where nothing would.
    pub deed: Option<D>,
}

/// The reading that is meant.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice<D> {
    /// Its words.
    pub text: String,
    /// What they mean.
    pub meaning: Meaning<D>,
    /// Whether it is to be asked about before anything is done.
    pub is_doubtful: bool,
}

/// A reading that was tried.
struct Tried<'a, D> {
    reading: &'a Hypothesis,
    text: String,
    meaning: Meaning<D>,
    value: f32,
}

/// How much each sign says for a deed.
struct Odds {
    base: f32,
    /// How well its reading fits the sound, as a logarithm.
    fit: f32,
    /// How much likelier it is than the next deed, as a logarithm.
    lead: f32,
    /// Its readings' share of how likely all are.
    share: f32,
    /// How many words the reading has, as a logarithm.
    length: f32,
}

/// The reading that is meant: the likeliest, where what makes less sense must be likelier. `None` if nobody seems to have said
/// anything.
///
/// Where a recogniser hears pauses says little: each reading is tried without the marks within it first, then with them.
pub fn choose<D: PartialEq>(heard: &Recognition, mut mean: impl FnMut(&str) -> Meaning<D>) -> Option<Choice<D>> {
    let mut tried: Vec<Tried<'_, D>> = Vec::new();
    for reading in heard.hypotheses.iter().take(MOST_TRIED) {
        let plain = without_marks(&reading.text);
        let as_heard = Some(&reading.text).filter(|text| **text != plain).cloned();
        for text in [plain].into_iter().chain(as_heard) {
            let meaning = mean(&text);
            let strange = if reading.strange > 0 { STRANGE } else { 0.0 };
            // Of the same words, those that something is done about.
            let idle = if meaning.deed.is_none() { IDLE } else { 0.0 };
            let less = (LESS[meaning.sense as usize] + strange).min(LESS[0]) + idle;
            tried.push(Tried { reading, text, meaning, value: reading.score - less });
        }
    }
    let best =
        tried.iter().enumerate().reduce(|best, other| if other.1.value > best.1.value { other } else { best })?.0;
    if tried[best].meaning.sense == Sense::None {
        // What means nothing is told as it sounded.
        let Tried { text, meaning, .. } = tried.swap_remove(best);
        let text = if heard.raw.is_empty() { text } else { heard.raw.clone() };
        return (heard.confidence() >= NOISE).then_some(Choice { text, meaning, is_doubtful: false });
    }
    let is_unsure = is_unsure(&tried, best);
    let Tried { text, meaning, .. } = tried.swap_remove(best);
    let is_doubtful = meaning.deed.is_some() && is_unsure;
    Some(Choice { text, meaning, is_doubtful })
}

/// Whether what the best reading comes to may well not be meant.
fn is_unsure<D: PartialEq>(tried: &[Tried<'_, D>], best: usize) -> bool {
    let Tried { reading, text, meaning, value } = &tried[best];
    let is_same = |other: &&Tried<'_, D>| other.meaning.deed == meaning.deed;
    let others = tried.iter().filter(|other| other.meaning.deed.is_some() && !is_same(other));
    let lead = others.map(|other| value - other.value).fold(FAR, f32::min);
    let likely = |tried: &Tried<'_, D>| (tried.reading.score - reading.score).exp();
    let share = tried.iter().filter(is_same).map(likely).sum::<f32>() / tried.iter().map(likely).sum::<f32>();
    let (fit, length) = (reading.confidence.max(1e-3).ln(), (bias::words(text).len() as f32 + 1.0).ln());
    let odds = ODDS.base + ODDS.fit * fit + ODDS.lead * lead + ODDS.share * share + ODDS.length * length;
    let chance = 1.0 / (1.0 + (-odds).exp());
    reading.strange > 0 || reading.confidence < DIM || lead < NEAR || chance < SURE
}

/// A text without marks between its words; the one at its end stays.
fn without_marks(text: &str) -> String {
    let is_mark = |c: char| matches!(c, ',' | ';' | ':' | '.' | '!' | '?' | '…');
    let last = text.chars().next_back().filter(|c| matches!(c, '.' | '!' | '?'));
    let words = text.split_whitespace().map(|word| word.trim_end_matches(is_mark)).filter(|word| !word.is_empty());
    let mut plain = words.collect::<Vec<_>>().join(" ");
    plain.extend(last);
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Somebody who knows of lefts and rights, and of the fridge.
    fn mean(text: &str) -> Meaning<&'static str> {
        let has = |word: &str| text.contains(word);
        let deed = match () {
            () if has("thirty degrees") && !has(",") => "turn a bit",
            () if has("right") => "turn right",
            () if has("left") => "turn left",
            () if has("fridge") => "open the fridge",
            () => return Meaning { sense: if has("pen") { Sense::Vague } else { Sense::None }, deed: None },
        };
        Meaning { sense: Sense::Clear, deed: Some(deed) }
    }

    fn heard(readings: &[(&str, f32, f32, usize)]) -> Recognition {
        let reading = |&(text, score, confidence, strange): &(&str, f32, f32, usize)| Hypothesis {
            text: text.to_owned(),
            score,
            confidence,
            strange,
        };
        Recognition { hypotheses: readings.iter().map(reading).collect(), raw: readings[0].0.to_owned() }
    }

    fn check(readings: &[(&str, f32, f32, usize)], text: &str, is_doubtful: bool) {
        let choice = choose(&heard(readings), mean);
        let found = choice.as_ref().map(|choice| (choice.text.as_str(), choice.is_doubtful));
        assert_eq!(found, Some((text, is_doubtful)), "{readings:?}");
    }

    #[test]
    fn the_reading_that_makes_sense_is_meant() {
        check(&[("Turn light.", -5.0, 0.9, 0), ("Turn right.", -7.0, 0.8, 0)], "Turn right.", false);
        check(&[("Open the bridge.", -5.0, 0.9, 0), ("Open the fridge.", -8.0, 0.8, 0)], "Open the fridge.", false);
        check(&[("Open the bridge.", -5.0, 0.9, 0), ("Open the fridge.", -9.5, 0.8, 0)], "Open the bridge.", false);
        check(&[("Open the fridge pole", -5.0, 0.9, 1), ("Open the fridge", -8.0, 0.8, 0)], "Open the fridge", false);
    }

    #[test]
    fn what_is_in_doubt_is_asked_about() {
        check(&[("Turn right.", -5.0, 0.9, 0)], "Turn right.", false);
        check(&[("Turn right.", -5.0, 0.25, 0)], "Turn right.", true);
        check(&[("Turn right, Hal.", -5.0, 0.9, 1)], "Turn right Hal.", true);
        check(&[("Turn right.", -5.0, 0.9, 0), ("Turn left.", -6.5, 0.9, 0)], "Turn right.", true);
        check(&[("Turn right.", -5.0, 0.9, 0), ("Turn left.", -7.5, 0.9, 0)], "Turn right.", false);
        check(&[("Turn right.", -5.0, 0.9, 0), ("Turned right.", -5.5, 0.9, 0)], "Turn right.", false);
        // Of many words, more must fit.
        let long = "Turn right as far as you can and then go on with what you were about to do.";
        check(&[(long, -5.0, 0.9, 0)], long, false);
        check(&[(long, -5.0, 0.45, 0)], long, true);
        // Not what does nothing.
        check(&[("Open that.", -5.0, 0.25, 0)], "Open that.", false);
    }

    #[test]
    fn pauses_that_were_heard_mean_little() {
        check(&[("Turn right, thirty degrees.", -5.0, 0.9, 0)], "Turn right thirty degrees.", true);
        assert_eq!(
            without_marks("Step one, open it. Move 0.5 meters, please!"),
            "Step one open it Move 0.5 meters please!"
        );
        assert_eq!(without_marks("Go,"), "Go");
        assert_eq!(without_marks(" … "), "");
    }

    #[test]
    fn what_makes_no_sense_is_told_as_it_sounded_or_is_noise() {
        check(&[("Play some jazz, please.", -5.0, 0.9, 2)], "Play some jazz, please.", false);
        assert_eq!(choose(&heard(&[("You.", -1.0, 0.1, 0)]), mean), None);
        assert_eq!(choose(&Recognition::default(), mean), None);
    }
}
