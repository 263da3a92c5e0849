//! Text to speech.

use std::ops::ControlFlow;

use crate::SpeechError;

/// Turns text into speech.
pub trait Synthesizer: Send {
    /// Samples a second of what it speaks.
    fn rate(&self) -> u32;

    /// Speaks a text: gives chunks of samples at [`Synthesizer::rate`] as they are made, the first one soon. Breaking off ends it.
    ///
    /// # Errors
    /// [`SpeechError::Engine`], [`SpeechError::Program`] or [`SpeechError::Server`] if it cannot work.
    fn speak(&mut self, text: &str, chunk: &mut dyn FnMut(&[i16]) -> ControlFlow<()>) -> Result<(), SpeechError>;

    /// What it is, for people.
    fn name(&self) -> &str;
}

/// Longer sentences are parted at a comma or a space, so that the first sound does not wait: letters.
const LONGEST: usize = 160;

/// The sentences of a text, each with its mark at the end; what has no letter or digit is left out.
///
/// A point within a number or before a lower-case word ends none (`1.5`, `e.g. this`).
#[must_use]
pub fn sentences(text: &str) -> Vec<String> {
    let chars: Vec<char> = text.chars().collect();
    let (mut found, mut from) = (Vec::new(), 0);
    for at in 0..chars.len() {
        if is_end(&chars, at) || (at - from >= LONGEST && matches!(chars[at], ',' | ';' | ' ')) {
            found.push(chars[from..=at].iter().collect::<String>());
            from = at + 1;
        }
    }
    found.push(chars[from..].iter().collect());
    let spoken = found.into_iter().map(|sentence| sentence.split_whitespace().collect::<Vec<_>>().join(" "));
    spoken.filter(|sentence| sentence.chars().any(char::is_alphanumeric)).collect()
}

fn is_end(chars: &[char], at: usize) -> bool {
    let rest = &chars[at + 1..];
    match chars[at] {
        '\n' => true,
        '.' | '!' | '?' | '…' => {
            let next = rest.iter().find(|c| !c.is_whitespace());
            rest.first().is_some_and(|c| c.is_whitespace()) && !next.is_some_and(|c| c.is_lowercase())
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_parted_into_sentences() {
        let check = |text: &str, expected: &[&str]| assert_eq!(sentences(text), expected, "{text}");
        check("The fridge is closed. Shall I open it?", &["The fridge is closed.", "Shall I open it?"]);
        check("It is 1.5 m away", &["It is 1.5 m away"]);
        check("Done!\n- the mug\n", &["Done!", "- the mug"]);
        check("Yes...  ?!", &["Yes..."]);
        check(" …", &[]);
    }

    #[test]
    fn a_long_sentence_is_parted_too() {
        let parts = sentences(&"a word ".repeat(100));
        assert!(parts.len() > 3 && parts.iter().all(|part| part.len() <= LONGEST + 5), "{parts:?}");
        assert_eq!(parts.join(" ").split(' ').count(), 200);
    }
}
