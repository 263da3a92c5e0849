//! Tokens of a Moonshine model, and the text that they spell.

use std::{fs, path::Path};

use crate::{SpeechError, onnx};

/// What stands for the space before a word.
const SPACE: &str = "▁";
/// Tokens that begin and end an utterance.
pub(crate) const BEGIN: i64 = 1;
pub(crate) const END: i64 = 2;
/// Tokens of single bytes, after `<unk>`, `<s>` and `</s>`.
const BYTES: std::ops::Range<usize> = 3..259;

/// What each token spells.
pub(crate) struct Tokens(Vec<Spelt>);

/// A token's text.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Spelt {
    bytes: Vec<u8>,
    /// Whether a word begins with it.
    pub(crate) begins_word: bool,
    /// Letters, digits and apostrophes of it, lower case, up to its end or what ends the word.
    pub(crate) letters: String,
    /// Whether a word ends within it, as with punctuation.
    pub(crate) ends_word: bool,
    /// Whether it is part of what is spoken: no note of music, no dash, no byte of one.
    pub(crate) is_plain: bool,
}

impl Tokens {
    /// Reads a table: for each token its length (a byte, or two if the first is 128 or more) and its text.
    pub(crate) fn open(path: &Path) -> Result<Self, SpeechError> {
        let broken = |why: String| SpeechError::Broken { path: path.into(), why, remedy: onnx::remedy(path) };
        let table = fs::read(path).map_err(|error| broken(error.to_string()))?;
        Self::parse(&table).ok_or_else(|| broken(format!("it is no table of tokens ({} bytes)", table.len())))
    }

    fn parse(table: &[u8]) -> Option<Self> {
        let (mut rest, mut tokens) = (table, Vec::new());
        while let Some((&low, behind)) = rest.split_first() {
            let (length, behind) = match low {
                0..128 => (usize::from(low), behind),
                _ => {
                    let (&high, behind) = behind.split_first()?;
                    (usize::from(high) * 128 + usize::from(low) - 128, behind)
                }
            };
            let (text, behind) = behind.split_at_checked(length)?;
            tokens.push(Spelt::new(tokens.len(), text));
            rest = behind;
        }
        (tokens.len() > BYTES.end).then_some(Self(tokens))
    }

    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    pub(crate) fn get(&self, token: i64) -> Option<&Spelt> {
        usize::try_from(token).ok().and_then(|token| self.0.get(token))
    }

    /// The text that tokens spell.
    pub(crate) fn text(&self, tokens: &[i64]) -> String {
        let spelt = tokens.iter().filter_map(|token| self.get(*token));
        let bytes: Vec<u8> = spelt.flat_map(|spelt| spelt.bytes.iter().copied()).collect();
        String::from_utf8_lossy(&bytes).split_whitespace().collect::<Vec<_>>().join(" ")
    }
}

impl Spelt {
    fn new(token: usize, text: &[u8]) -> Self {
        let is_mark = token < BYTES.start || text.starts_with(b"<<");
        if is_mark {
            return Self::default();
        }
        if BYTES.contains(&token) {
            return Self { bytes: text.to_vec(), ..Self::default() };
        }
        let text = String::from_utf8_lossy(text).replace(SPACE, " ");
        let begins_word = text.starts_with(' ');
        let word = text.trim_start().to_lowercase();
        let is_letter = |c: char| c.is_alphanumeric() || c == '\'';
        let letters: String = word.chars().take_while(|c| is_letter(*c)).collect();
        let ends_word = letters.len() < word.len();
        let is_plain = text.chars().all(|c| c.is_alphanumeric() || " '’.,?!".contains(c));
        Self { bytes: text.into_bytes(), begins_word, letters, ends_word, is_plain }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A table of these tokens, after those of every model.
    pub(crate) fn table(texts: &[&str]) -> Vec<u8> {
        let marks = ["<unk>", "<s>", "</s>"].map(|mark| mark.as_bytes().to_vec());
        let bytes = (0..=255u8).map(|byte| vec![byte]);
        let texts = texts.iter().map(|text| text.replace(' ', SPACE).into_bytes());
        let tokens = marks.into_iter().chain(bytes).chain(texts);
        tokens
            .flat_map(|token| match token.len() {
                short @ 0..128 => [vec![short as u8], token].concat(),
                long => [vec![(long % 128 + 128) as u8, (long / 128) as u8], token].concat(),
            })
            .collect()
    }

    pub(crate) fn tokens(texts: &[&str]) -> Tokens {
        Tokens::parse(&table(texts)).expect("a table")
    }

    #[test]
    fn tokens_spell_a_text() {
        let long = format!(" {}", "a".repeat(200));
        let tokens = tokens(&[" Pick", " up", " the", " mug", ".", &long, " don't,"]);
        assert_eq!(tokens.len(), 266);
        assert_eq!(tokens.text(&[BEGIN, 259, 260, 261, 262, 263, END]), "Pick up the mug.");
        assert_eq!(tokens.text(&[264]).len(), 200);
        assert_eq!(tokens.text(&[262, 3 + 0xC3, 3 + 0xA9, 99_999, -1]), "mugé");
        let spelt = tokens.get(265).expect("a token");
        assert!(spelt.begins_word && spelt.ends_word && spelt.letters == "don't");
        let spelt = tokens.get(263).expect("a token");
        assert!(!spelt.begins_word && spelt.ends_word && spelt.letters.is_empty());
    }

    #[test]
    fn what_is_no_table_is_refused() {
        let whole = table(&[" Pick"]);
        for wrong in [&whole[..whole.len() - 1], &whole[..40], &[200], &[]] {
            assert!(Tokens::parse(wrong).is_none());
        }
        let error = Tokens::open(Path::new("/nowhere/tokenizer.bin")).err().map(|error| error.to_string());
        assert!(error.is_some_and(|error| error.contains("/nowhere/tokenizer.bin")));
    }
}
