//! Tokens of a model, and the text that they spell.

use std::{fs, path::Path};

use crate::{SpeechError, model_file::file, onnx, vocabulary::Vocabulary};

/// The file that they stand in.
const TABLE: &str = "tokenizer.bin";
/// What stands for the space before a word in Moonshine's tables.
const SPACE: &str = "▁";
/// Tokens that begin and end an utterance of Moonshine.
pub(crate) const BEGIN: i64 = 1;
pub(crate) const END: i64 = 2;
/// Its tokens of single bytes, after `<unk>`, `<s>` and `</s>`.
const BYTES: std::ops::Range<usize> = 3..259;

/// What each token spells.
pub(crate) struct Tokens {
    table: Vec<Spelt>,
    end: i64,
}

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
    comes: Comes,
}

/// Where a token may come.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Comes {
    #[default]
    Anywhere,
    /// Anywhere but first.
    Later,
    Never,
}

impl Tokens {
    /// A table of what tokens spell, and the token that ends an utterance.
    pub(crate) fn new(table: Vec<Spelt>, end: i64) -> Self {
        Self { table, end }
    }

    /// Those of a Moonshine model: its own table, or, where there is none, that of a tokenizer.
    pub(crate) fn of_moonshine(folder: &Path) -> Result<Self, SpeechError> {
        match (file(folder, TABLE), Vocabulary::open(folder)?) {
            (Err(_), Some(vocabulary)) => Self::of_pieces(&vocabulary),
            (table, _) => Self::open(&table?),
        }
    }

    /// Reads a table: for each token its length (a byte, or two if the first is 128 or more) and its text.
    fn open(path: &Path) -> Result<Self, SpeechError> {
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
            tokens.push(piece(tokens.len(), text));
            rest = behind;
        }
        (tokens.len() > BYTES.end).then_some(Self::new(tokens, END))
    }

    /// The same pieces as a tokenizer has them, where single bytes are written `<0x41>`.
    fn of_pieces(vocabulary: &Vocabulary) -> Result<Self, SpeechError> {
        let byte = |name: &str| u8::from_str_radix(name.strip_prefix("<0x")?.strip_suffix('>')?, 16).ok();
        let names = vocabulary.names();
        if names.len() <= BYTES.end || !names[BYTES].iter().all(|name| byte(name).is_some()) {
            return Err(vocabulary.other("a Moonshine model"));
        }
        let text = |name: &&str| byte(name).map_or_else(|| name.as_bytes().to_vec(), |byte| vec![byte]);
        let table = names.iter().enumerate().map(|(token, name)| piece(token, &text(name))).collect();
        Ok(Self::new(table, END))
    }

    pub(crate) fn len(&self) -> usize {
        self.table.len()
    }

    /// The token that ends an utterance.
    pub(crate) fn end(&self) -> i64 {
        self.end
    }

    pub(crate) fn get(&self, token: i64) -> Option<&Spelt> {
        usize::try_from(token).ok().and_then(|token| self.table.get(token))
    }

    /// Whether a token may come, as the first of all or later.
    pub(crate) fn may_come(&self, token: usize, is_first: bool) -> bool {
        self.table.get(token).is_some_and(|spelt| match spelt.comes {
            Comes::Anywhere => true,
            Comes::Later => !is_first,
            Comes::Never => false,
        })
    }

    /// The text that tokens spell.
    pub(crate) fn text(&self, tokens: &[i64]) -> String {
        let spelt = tokens.iter().filter_map(|token| self.get(*token));
        let bytes: Vec<u8> = spelt.flat_map(|spelt| spelt.bytes.iter().copied()).collect();
        String::from_utf8_lossy(&bytes).split_whitespace().collect::<Vec<_>>().join(" ")
    }
}

impl Spelt {
    /// What a token of these bytes spells, of which the first may be the space before a word.
    pub(crate) fn new(bytes: Vec<u8>, comes: Comes) -> Self {
        let text = String::from_utf8_lossy(&bytes);
        let begins_word = text.starts_with(' ');
        let word = text.trim_start().to_lowercase();
        let is_letter = |c: char| c.is_alphanumeric() || c == '\'';
        let letters: String = word.chars().take_while(|c| is_letter(*c)).collect();
        let ends_word = letters.len() < word.len();
        let is_plain = text.chars().all(|c| c.is_alphanumeric() || " '’.,?!".contains(c));
        Self { begins_word, letters, ends_word, is_plain, comes, bytes }
    }

    /// A token that spells nothing.
    pub(crate) fn mark(comes: Comes) -> Self {
        Self { comes, ..Self::default() }
    }
}

/// A token of a Moonshine model.
fn piece(token: usize, text: &[u8]) -> Spelt {
    let is_mark = token < BYTES.start || text.starts_with(b"<<");
    if is_mark {
        return Spelt::mark(Comes::Anywhere);
    }
    if BYTES.contains(&token) {
        return Spelt { bytes: text.to_vec(), ..Spelt::default() };
    }
    Spelt::new(String::from_utf8_lossy(text).replace(SPACE, " ").into_bytes(), Comes::Anywhere)
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
