//! Text as people and peers give it, made fit to be shown, logged and recorded.

use crate::limits::LONGEST_TEXT_CHARS;

/// Text in one line: control characters that are spaces become spaces, all others go.
pub fn in_one_line(text: &str) -> String {
    text.chars().filter_map(|letter| shown(letter, false)).collect()
}

/// Text that may have several lines.
pub fn in_lines(text: &str) -> String {
    text.replace("\r\n", "\n").chars().filter_map(|letter| shown(letter, true)).collect()
}

const fn shown(letter: char, keeps_lines: bool) -> Option<char> {
    match letter {
        '\n' | '\r' if keeps_lines => Some('\n'),
        '\t'..='\r' | '\u{85}' => Some(' '),
        '\0'..='\u{1f}' | '\u{7f}'..='\u{9f}' => None,
        _ => Some(letter),
    }
}

/// Whether text is within what may be said or written at once.
pub fn is_within_limit(text: &str) -> bool {
    text.chars().nth(LONGEST_TEXT_CHARS).is_none()
}

/// How much longer it is than that, for the person who wrote it.
pub fn too_long(text: &str) -> String {
    format!("It has {} characters; {LONGEST_TEXT_CHARS} at most, please.", text.chars().count())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_not_passed_on() {
        let text = "go\u{1b}[31m to\tthe\r\nlab\0\u{7f}\u{9b}2J naïve 语 😀\u{200d}";
        assert_eq!(in_one_line(text), "go[31m to the  lab2J naïve 语 😀\u{200d}");
        assert_eq!(in_lines(text), "go[31m to the\nlab2J naïve 语 😀\u{200d}");
    }

    #[test]
    fn the_limit_is_counted_in_characters() {
        for letter in ["a", "я", "語", "😀"] {
            let longest = letter.repeat(LONGEST_TEXT_CHARS);
            assert!(is_within_limit(&longest), "{letter}");
            let longer = format!("{longest}{letter}");
            assert!(!is_within_limit(&longer) && too_long(&longer).contains("2001 characters; 2000"), "{letter}");
        }
    }
}
