//! What robots have just said aloud, which microphones hear too.

use std::collections::VecDeque;

/// Sound is played, and comes back, so much later than it was sent at most, ns.
const LATE_NANOS: u64 = 700_000_000;
/// So many sayings are remembered.
const REMEMBERED: usize = 8;
/// What is heard is an echo if at least this share of its words was said, in their order.
const ALIKE: f32 = 0.6;
/// Fewer words than this must all have been said.
const FEW: usize = 3;

/// What was said aloud, and when.
#[derive(Debug, Default)]
pub struct Echo {
    said: VecDeque<Said>,
}

#[derive(Debug)]
struct Said {
    words: Vec<String>,
    from: u64,
    until: u64,
}

impl Echo {
    /// A text is said from then until then, ns.
    pub fn note(&mut self, text: &str, from: u64, until: u64) {
        self.said.push_back(Said { words: words(text), from, until });
        while self.said.len() > REMEMBERED {
            self.said.pop_front();
        }
    }

    /// What is being said lasts until then.
    pub fn lasts_until(&mut self, until: u64) {
        if let Some(said) = self.said.back_mut() {
            said.until = until;
        }
    }

    /// Nothing more is said after then.
    pub fn cut(&mut self, at: u64) {
        for said in &mut self.said {
            said.until = said.until.min(at);
        }
    }

    /// Whether a text that was heard from `began` until `ended` is what was being said then. What begins after that, and goes on
    /// when all of it has sounded, is somebody's who answers in its words.
    pub fn is_echo(&self, heard: &str, [began, ended]: [u64; 2]) -> bool {
        let heard = words(heard);
        let may_be = |said: &&Said| began <= said.until || ended <= said.until.saturating_add(LATE_NANOS);
        let mut said = self.during(began).filter(may_be);
        !heard.is_empty() && said.any(|said| resembles(&heard, &said.words))
    }

    /// Whether what was being said then was such a text.
    pub fn says(&self, began: u64, is_such: impl Fn(&str) -> bool) -> bool {
        self.during(began).any(|said| is_such(&said.words.join(" ")))
    }

    fn during(&self, at: u64) -> impl Iterator<Item = &Said> {
        self.said.iter().filter(move |said| said.from <= at && at <= said.until.saturating_add(LATE_NANOS))
    }
}

fn words(text: &str) -> Vec<String> {
    let words = text.split(|c: char| !c.is_alphanumeric() && c != '\'').filter(|word| !word.is_empty());
    words.map(str::to_lowercase).collect()
}

/// The share of the words that are among the others in the same order.
fn resembles(heard: &[String], said: &[String]) -> bool {
    let mut row = vec![0_usize; said.len() + 1];
    for word in heard {
        let mut before = 0;
        for (at, other) in said.iter().enumerate() {
            let here = row[at + 1];
            row[at + 1] = if word == other { before + 1 } else { here.max(row[at]) };
            before = here;
        }
    }
    let common = row[said.len()] as f32;
    let needed = if heard.len() < FEW { 1.0 } else { ALIKE };
    common >= needed * heard.len() as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    const S: u64 = 1_000_000_000;

    #[test]
    fn the_robots_own_words_are_known_while_they_sound() {
        let mut echo = Echo::default();
        echo.note("OK, going to the break room and then picking up the bowl.", 10 * S, 14 * S);
        let check = |heard: &str, at: u64, expected: bool| {
            assert_eq!(echo.is_echo(heard, [at, at + S]), expected, "{heard}");
        };
        check("going to the break room", 11 * S, true);
        check("okay going to the brake room and then picking up the bowl", 10 * S, true);
        check("picking up the ball", 13 * S, true);
        check("going to the break room", 16 * S, false);
        check("going to the break room", 9 * S, false);
        check("open the fridge", 12 * S, false);
        check("stop", 12 * S, false);
        check("the bowl", 12 * S, true);
        check("a bowl", 12 * S, false);
        check("", 12 * S, false);
    }

    #[test]
    fn who_answers_a_question_in_its_words_is_heard() {
        let mut echo = Echo::default();
        echo.note("Which one do you mean: the red mug or the blue mug?", 10 * S, 14 * S);
        let check = |heard: &str, tenths: [u64; 2], expected: bool| {
            assert_eq!(echo.is_echo(heard, tenths.map(|at| at * S / 10)), expected, "{heard}");
        };
        // Half a second after the question; the silence before it is counted, too.
        check("the red mug", [142, 155], false);
        check("red", [142, 149], false);
        // The end of the question, as late as that may come back.
        check("blue mug", [142, 146], true);
        check("the red mug or the blue mug", [125, 146], true);
        // Who answers while it still sounds cannot be told from it.
        check("the blue mug", [135, 155], true);
    }

    #[test]
    fn what_was_broken_off_sounds_no_more() {
        let mut echo = Echo::default();
        echo.note("The fridge is closed. Shall I open it?", 10 * S, 13 * S);
        echo.cut(11 * S);
        assert!(echo.is_echo("the fridge is closed", [10 * S, 11 * S]));
        assert!(!echo.is_echo("shall i open it", [12 * S, 13 * S]));
    }
}
