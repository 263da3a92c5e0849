//! The texts that a file had: what can be undone, and done again.

/// The most texts that are kept.
const MOST: usize = 200;

/// A text, those before it, and those that were undone.
#[derive(Clone, Debug)]
pub struct History {
    past: Vec<String>,
    present: String,
    future: Vec<String>,
    /// Grows with each change of the present text.
    revision: u64,
}

impl History {
    /// A history that begins with this text.
    #[must_use]
    pub const fn new(text: String) -> Self {
        Self { past: Vec::new(), present: text, future: Vec::new(), revision: 0 }
    }

    /// The present text.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.present
    }

    /// The number of the present text: another one is another number.
    #[must_use]
    pub const fn revision(&self) -> u64 {
        self.revision
    }

    /// Whether there is something to undo.
    #[must_use]
    pub const fn has_past(&self) -> bool {
        !self.past.is_empty()
    }

    /// Whether there is something to do again.
    #[must_use]
    pub const fn has_future(&self) -> bool {
        !self.future.is_empty()
    }

    /// Another text. The same one changes nothing.
    pub fn change(&mut self, text: String) {
        if text == self.present {
            return;
        }
        self.past.push(std::mem::replace(&mut self.present, text));
        if self.past.len() > MOST {
            self.past.remove(0);
        }
        self.future.clear();
        self.revision += 1;
    }

    /// Goes back to the text before, if there is one.
    pub fn undo(&mut self) {
        if let Some(before) = self.past.pop() {
            self.future.push(std::mem::replace(&mut self.present, before));
            self.revision += 1;
        }
    }

    /// Goes on to the text that was undone last, if there is one.
    pub fn redo(&mut self) {
        if let Some(after) = self.future.pop() {
            self.past.push(std::mem::replace(&mut self.present, after));
            self.revision += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_undone_can_be_done_again_until_something_else_is_done() {
        let mut history = History::new("a".to_owned());
        for text in ["b", "b", "c"] {
            history.change(text.to_owned());
        }
        assert_eq!((history.text(), history.revision()), ("c", 2));
        history.undo();
        history.undo();
        history.undo();
        assert_eq!((history.text(), history.has_past(), history.has_future()), ("a", false, true));
        history.redo();
        assert_eq!(history.text(), "b");
        history.change("d".to_owned());
        history.redo();
        assert_eq!((history.text(), history.has_future()), ("d", false));
        for number in 0..2 * MOST {
            history.change(number.to_string());
        }
        assert_eq!(history.past.len(), MOST);
    }
}
