//! A file on a desk: its history, and what of it is on the disk.

use std::{fs, io, path::PathBuf, sync::Arc};

use cohabit_durable::{Readers, write_whole};
use serde::Deserialize;
use serde_json::{Value, json};

use crate::{document::Document, history::History};

/// The largest file, bytes.
const LARGEST: usize = 1 << 20;

/// What a page asks for, beside edits.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq)]
#[serde(rename_all = "snake_case")]
pub enum Wish {
    /// Back to the text before.
    Undo,
    /// On to the text that was undone.
    Redo,
    /// On to the disk.
    Save,
}

/// An edit, of the text with a number.
#[derive(Clone, Debug, Deserialize)]
pub struct Sent {
    /// The number of the text that the page shows.
    pub revision: u64,
    /// What is to be done to it.
    pub edit: Value,
}

/// A file that is edited.
pub struct Desk {
    path: PathBuf,
    document: Arc<dyn Document>,
    history: History,
    /// What the file was when it was read or written last; none, while there is no file.
    on_disk: Option<String>,
}

impl Desk {
    /// The file at a path, which has this text, or is none yet: then it begins with that of `begun`.
    #[must_use]
    pub fn new(path: PathBuf, document: Arc<dyn Document>, text: Option<String>, begun: &str) -> Self {
        let present = text.clone().unwrap_or_else(|| begun.to_owned());
        Self { path, document, history: History::new(present), on_disk: text }
    }

    /// All that a page shows.
    #[must_use]
    pub fn state(&self) -> Value {
        let text = self.history.text();
        let mut state = self.document.shown(text);
        state["kind"] = json!(self.document.kind());
        state["revision"] = json!(self.history.revision());
        state["is_saved"] = json!(self.on_disk.as_deref() == Some(text));
        state["has_past"] = json!(self.history.has_past());
        state["has_future"] = json!(self.history.has_future());
        state["text"] = json!(text);
        state
    }

    /// What a page offers whatever the text is.
    #[must_use]
    pub fn choices(&self) -> Value {
        let mut choices = self.document.choices();
        choices["file"] = json!(self.path.file_name().unwrap_or_default().to_string_lossy());
        choices
    }

    /// The present text, and what can be made of it, for who does not keep others waiting meanwhile.
    #[must_use]
    pub fn present(&self) -> (Arc<dyn Document>, String) {
        (Arc::clone(&self.document), self.history.text().to_owned())
    }

    /// Changes the text.
    ///
    /// # Errors
    /// Why that cannot be, in words; the text is then as it was.
    pub fn edit(&mut self, sent: Sent) -> Result<(), String> {
        if sent.revision != self.history.revision() {
            return Err("this was changed on another page meanwhile: look at it, and do it again".to_owned());
        }
        let text = self.document.edited(self.history.text(), sent.edit)?;
        if text.len() > LARGEST {
            return Err(format!("the file would have more than {LARGEST} bytes, the most that are read"));
        }
        self.history.change(text);
        Ok(())
    }

    /// Does what a page wishes.
    ///
    /// # Errors
    /// Why that cannot be, in words.
    pub fn fulfil(&mut self, wish: Wish) -> Result<(), String> {
        match wish {
            Wish::Undo => self.history.undo(),
            Wish::Redo => self.history.redo(),
            Wish::Save => self.save()?,
        }
        Ok(())
    }

    /// Writes the file. What somebody else has written meanwhile is not lost without a word.
    fn save(&mut self) -> Result<(), String> {
        let at = |error: io::Error| format!("{}: {error}", self.path.display());
        let found = match fs::read_to_string(&self.path) {
            Ok(text) => Some(text),
            Err(error) if error.kind() == io::ErrorKind::NotFound => None,
            Err(error) => return Err(at(error)),
        };
        if found != self.on_disk {
            // Who saves again has read this.
            self.on_disk = found;
            return Err(
                "another program has changed the file: save once more to write over that, or open it anew".to_owned()
            );
        }
        if let Some(folder) = self.path.parent() {
            fs::create_dir_all(folder).map_err(at)?;
        }
        let text = self.history.text().to_owned();
        write_whole(&self.path, text.as_bytes(), Readers::All).map_err(at)?;
        self.on_disk = Some(text);
        Ok(())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use cohabit_tests::Scratch;

    use super::*;
    use crate::document::Drawn;

    /// A file of any text, which takes all but "no".
    struct Plain;

    impl Document for Plain {
        fn kind(&self) -> &'static str {
            "plain"
        }

        fn edited(&self, _: &str, edit: Value) -> Result<String, String> {
            edit.as_str().filter(|text| *text != "no").map(str::to_owned).ok_or_else(|| "no".to_owned())
        }

        fn shown(&self, _: &str) -> Value {
            json!({})
        }

        fn choices(&self) -> Value {
            json!({})
        }

        fn drawn(&self, _: &str) -> Option<Drawn> {
            None
        }

        fn is_sound(&self, _: &str) -> bool {
            true
        }

        fn mission(&self, text: &str) -> String {
            text.to_owned()
        }
    }

    #[test]
    fn what_is_saved_is_on_the_disk_and_what_others_saved_is_not_lost() {
        let scratch = Scratch::new("edit-desk");
        let path = PathBuf::from(scratch.path("layouts/Flat.toml"));
        let mut desk = Desk::new(path.clone(), Arc::new(Plain), None, "new");
        let is_saved = |desk: &Desk| desk.state()["is_saved"].as_bool().unwrap();
        assert!(!is_saved(&desk) && desk.choices()["file"] == "Flat.toml");
        let sent = |revision, text: &str| Sent { revision, edit: json!(text) };
        desk.edit(sent(0, "one")).unwrap();
        assert_eq!(desk.edit(sent(1, "no")).unwrap_err(), "no");
        assert!(desk.edit(sent(0, "two")).unwrap_err().contains("another page"));
        desk.fulfil(Wish::Save).unwrap();
        assert!(is_saved(&desk) && fs::read_to_string(&path).unwrap() == "one");
        desk.fulfil(Wish::Undo).unwrap();
        assert!(!is_saved(&desk) && desk.present().1 == "new");
        fs::write(&path, "others").unwrap();
        assert!(desk.fulfil(Wish::Save).unwrap_err().contains("another program"));
        assert_eq!(fs::read_to_string(&path).unwrap(), "others");
        desk.fulfil(Wish::Save).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
    }
}
