//! The names of a model's tokens, as tokenizers of Hugging Face keep them: `tokenizer.json`, or `vocab.json` with `added_tokens.json`.

use std::{
    collections::HashMap,
    fs,
    path::{Path, PathBuf},
};

use serde::{Deserialize, de::DeserializeOwned};

use crate::{SpeechError, onnx};

/// The file that has them all.
pub(crate) const TOKENIZER: &str = "tokenizer.json";

/// More tokens has no model; a number beyond is a mistake.
const MOST: usize = 1 << 20;

/// Names of tokens and their numbers.
pub(crate) struct Vocabulary {
    ids: HashMap<String, usize>,
    path: PathBuf,
}

#[derive(Deserialize)]
struct Tokenizer {
    #[serde(default)]
    added_tokens: Vec<Added>,
    model: Model,
}

#[derive(Deserialize)]
struct Added {
    id: usize,
    content: String,
}

#[derive(Deserialize)]
struct Model {
    vocab: HashMap<String, usize>,
}

impl Vocabulary {
    /// That of a folder; none if no such file is there.
    ///
    /// # Errors
    /// [`SpeechError::Broken`] for a file that holds something else.
    pub(crate) fn open(folder: &Path) -> Result<Option<Self>, SpeechError> {
        let [whole, names, added] = [TOKENIZER, "vocab.json", "added_tokens.json"].map(|name| folder.join(name));
        if whole.is_file() {
            let Tokenizer { added_tokens, model } = read(&whole)?;
            let added = added_tokens.into_iter().map(|added| (added.content, added.id));
            return Self::new(model.vocab.into_iter().chain(added), whole).map(Some);
        }
        if !names.is_file() {
            return Ok(None);
        }
        let mut ids: HashMap<String, usize> = read(&names)?;
        if added.is_file() {
            ids.extend(read::<HashMap<String, usize>>(&added)?);
        }
        Self::new(ids, names).map(Some)
    }

    fn new(ids: impl IntoIterator<Item = (String, usize)>, path: PathBuf) -> Result<Self, SpeechError> {
        let ids: HashMap<String, usize> = ids.into_iter().collect();
        match ids.iter().find(|(_, id)| **id >= MOST) {
            Some((name, id)) => Err(broken(&path, format!("its token {name:?} has the number {id}"))),
            None => Ok(Self { ids, path }),
        }
    }

    /// The number of a token.
    pub(crate) fn id(&self, name: &str) -> Option<i64> {
        self.ids.get(name).map(|id| *id as i64)
    }

    /// The names of all tokens in order; empty where a number has none.
    pub(crate) fn names(&self) -> Vec<&str> {
        let mut names = vec![""; self.ids.values().max().map_or(0, |last| last + 1)];
        for (name, id) in &self.ids {
            names[*id] = name;
        }
        names
    }

    /// That its tokens are not those of a kind of model.
    pub(crate) fn other(&self, of: &str) -> SpeechError {
        broken(&self.path, format!("its {} tokens are not those of {of}", self.ids.len()))
    }
}

fn read<T: DeserializeOwned>(path: &Path) -> Result<T, SpeechError> {
    let text = fs::read_to_string(path).map_err(|error| broken(path, error.to_string()))?;
    serde_json::from_str(&text).map_err(|error| broken(path, format!("it holds no tokens: {error}")))
}

fn broken(path: &Path, why: String) -> SpeechError {
    SpeechError::Broken { path: path.into(), why, remedy: onnx::remedy(path) }
}

/// The bytes that a token of a byte-level table spells; none if its name has a character that stands for none.
///
/// Bytes that can be printed stand for themselves, the others for the characters from 256 on (GPT-2, `bytes_to_unicode`).
pub(crate) fn bytes(name: &str) -> Option<Vec<u8>> {
    let byte = |c: char| match c {
        '!'..='~' | '¡'..='¬' | '®'..='ÿ' => Some(c as u8),
        '\u{100}'..='\u{120}' => Some((c as u32 - 0x100) as u8),
        '\u{121}'..='\u{142}' => Some((c as u32 - 0x121) as u8 + 127),
        '\u{143}' => Some(173),
        _ => None,
    };
    name.chars().map(byte).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn names_of_a_byte_level_table_are_read() {
        let check = |name: &str, expected: &[u8]| assert_eq!(bytes(name).as_deref(), Some(expected), "{name}");
        check("Ġmug", b" mug");
        check("CafÃ©", "Café".as_bytes());
        check("âĻ", &[0xE2, 0x99]);
        check("ĀĊŃ", &[0, b'\n', 173]);
        assert_eq!(bytes("<|en|> 好"), None);
        let all: Vec<u8> =
            (0..0x144).filter_map(char::from_u32).filter_map(|c| bytes(&c.to_string())).flatten().collect();
        let mut each = all.clone();
        each.sort_unstable();
        assert_eq!(each, (0..=255).collect::<Vec<u8>>());
    }

    /// A folder with these files, gone when it is done with.
    struct Folder(PathBuf);

    impl Folder {
        fn of(name: &str, files: &[(&str, &str)]) -> Self {
            let folder = std::env::temp_dir().join(format!("cohabit-vocabulary-{name}-{}", std::process::id()));
            fs::create_dir_all(&folder).unwrap();
            files.iter().for_each(|(name, text)| fs::write(folder.join(name), text).unwrap());
            Self(folder)
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn both_ways_to_keep_tokens_are_read() {
        let whole = r#"{"model": {"type": "BPE", "vocab": {"a": 0, "Ġb": 2}}, "added_tokens": [{"id": 3, "content": "<|en|>"}]}"#;
        let whole = Folder::of("whole", &[("tokenizer.json", whole)]);
        let parts = [("vocab.json", r#"{"a": 0, "Ġb": 2}"#), ("added_tokens.json", r#"{"<|en|>": 3}"#)];
        let parts = Folder::of("parts", &parts);
        for folder in [whole, parts] {
            let vocabulary = Vocabulary::open(&folder.0).unwrap().unwrap();
            assert_eq!(vocabulary.names(), ["a", "", "Ġb", "<|en|>"]);
            assert_eq!((vocabulary.id("<|en|>"), vocabulary.id("<|de|>")), (Some(3), None));
        }
        assert!(Vocabulary::open(Path::new("/nowhere")).unwrap().is_none());
    }

    #[test]
    fn what_is_no_vocabulary_is_named() {
        let check = |name: &str, text: &str, expected: &str| {
            let folder = Folder::of("broken", &[(name, text)]);
            let error = Vocabulary::open(&folder.0).err().unwrap().to_string();
            assert!(error.contains(name) && error.contains(expected), "{error}");
        };
        check("tokenizer.json", "{", "line 1");
        check("tokenizer.json", r#"{"added_tokens": []}"#, "model");
        check("vocab.json", r#"{"a": -1}"#, "no tokens");
        check("vocab.json", r#"{"a": 99999999}"#, "99999999");
    }
}
