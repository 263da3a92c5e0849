//! Text into words: lower case, without apostrophes, punctuation as words of its own.

/// Longest utterance taken, in characters; what people type is ten times shorter.
pub(crate) const MAX_CHARS: usize = 1000;

/// Digits as they are said.
pub(crate) const NUMBERS: [&str; 10] = ["zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine"];

/// Whether a word is punctuation that ends a sentence.
pub(crate) fn ends_sentence(word: &str) -> bool {
    matches!(word, "." | "!" | "?" | ";" | ":")
}

/// Whether a word is punctuation.
pub(crate) fn is_punctuation(word: &str) -> bool {
    word == "," || ends_sentence(word)
}

/// The words of a text. `2m` and `3d` are two words; `FoodPlate_01_1` and `2.5` are one; hyphens part words.
pub(crate) fn words(text: &str) -> Vec<String> {
    let lower = text.to_lowercase();
    let characters: Vec<char> = lower.chars().collect();
    let mut words = Vec::new();
    let mut word = String::new();
    for (at, &character) in characters.iter().enumerate() {
        let next = characters.get(at + 1).copied().unwrap_or(' ');
        match character {
            '\'' | '’' | '‘' | '`' => {}
            '.' if is_number(&word) && next.is_ascii_digit() => word.push('.'),
            '.' | '!' | '?' | ';' | ':' | ',' => {
                finish(&mut word, &mut words);
                words.push(character.to_string());
            }
            '&' | '+' => {
                finish(&mut word, &mut words);
                words.push("and".to_owned());
            }
            '°' => {
                finish(&mut word, &mut words);
                words.push("degrees".to_owned());
            }
            _ if character.is_alphanumeric() || character == '_' => {
                if character.is_alphabetic() && is_number(&word) {
                    finish(&mut word, &mut words);
                }
                word.push(character);
            }
            _ => finish(&mut word, &mut words),
        }
    }
    finish(&mut word, &mut words);
    words
}

/// The number that a word of digits stands for, if it is one.
pub(crate) fn digits(word: &str) -> Option<f32> {
    if is_number(word) { word.parse().ok().filter(|value: &f32| value.is_finite()) } else { None }
}

fn is_number(word: &str) -> bool {
    word.starts_with(|first: char| first.is_ascii_digit())
        && word.chars().all(|character| character.is_ascii_digit() || character == '.')
}

fn finish(word: &mut String, words: &mut Vec<String>) {
    if !word.is_empty() {
        words.push(std::mem::take(word));
    }
}

/// The words as a sentence: `go to the lab, then stop`.
pub(crate) fn sentence(words: &[String]) -> String {
    let mut sentence = String::new();
    for word in words {
        if !sentence.is_empty() && !is_punctuation(word) {
            sentence.push(' ');
        }
        sentence.push_str(word);
    }
    sentence.trim_end_matches(|end: char| !end.is_alphanumeric()).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_lower_case_and_plain() {
        let check = |text: &str, expected: &[&str]| assert_eq!(words(text), expected, "{text:?}");
        check("Pick up the Mug!", &["pick", "up", "the", "mug", "!"]);
        check("don't, it's the manager’s", &["dont", ",", "its", "the", "managers"]);
        check("go 2.5m. Then 90°", &["go", "2.5", "m", ".", "then", "90", "degrees"]);
        check("the 3-D printer", &["the", "3", "d", "printer"]);
        check("FoodPlate_01_1", &["foodplate_01_1"]);
        check("\u{0}\u{7}\t\n", &[]);
    }
}
