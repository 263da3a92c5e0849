//! The text format of the corpus: dialogs of people with a robot, each utterance labelled with what it asks for.
//!
//! The format is described in `dialog/parser/corpus/README.md`.

use std::fmt;

use crate::request::{Request, RequestError};

/// One dialog.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Dialog {
    /// Where it takes place, for readers.
    pub scene: String,
    /// What was said, in order.
    pub lines: Vec<Line>,
}

/// One line of a dialog.
#[derive(Clone, Debug, PartialEq)]
pub enum Line {
    /// What the robot said or did.
    Robot(String),
    /// What the person said.
    Person {
        /// In their words.
        text: String,
        /// What it means; nothing, where only the utterance is known.
        requests: Vec<Request>,
    },
}

/// What is wrong with a text of the corpus, and where.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct CorpusError {
    /// Counted from 1.
    pub line: usize,
    /// What is wrong there.
    pub problem: CorpusProblem,
}

/// What can be wrong with a line.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum CorpusProblem {
    /// It begins with none of the marks.
    NoMark,
    /// It has a mark, and nothing after it.
    Empty,
    /// It stands before the first dialog.
    NoDialog,
    /// A label that follows no utterance.
    NoUtterance,
    /// An utterance without a label.
    NoLabel,
    /// A label that is no request.
    Request(RequestError),
}

impl Dialog {
    /// Reads all dialogs of a text.
    ///
    /// # Errors
    /// The first line that is wrong.
    pub fn parse_all(text: &str) -> Result<Vec<Self>, CorpusError> {
        let mut dialogs: Vec<Self> = Vec::new();
        let mut unlabelled: Option<String> = None;
        for (at, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
            let fail = |problem| CorpusError { line: at + 1, problem };
            let mark = line.chars().next().unwrap_or(' ');
            let content = line[mark.len_utf8()..].trim();
            if content.is_empty() {
                return Err(fail(CorpusProblem::Empty));
            }
            if unlabelled.is_some() && mark != '=' {
                return Err(fail(CorpusProblem::NoLabel));
            }
            if mark == '#' {
                dialogs.push(Self { scene: content.to_owned(), lines: Vec::new() });
                continue;
            }
            let dialog = dialogs.last_mut().ok_or_else(|| fail(CorpusProblem::NoDialog))?;
            match mark {
                '<' => dialog.lines.push(Line::Robot(content.to_owned())),
                '~' => dialog.lines.push(Line::Person { text: content.to_owned(), requests: Vec::new() }),
                '>' => unlabelled = Some(content.to_owned()),
                '=' => {
                    let text = unlabelled.take().ok_or_else(|| fail(CorpusProblem::NoUtterance))?;
                    let requests = Request::parse_all(content).map_err(|error| fail(CorpusProblem::Request(error)))?;
                    dialog.lines.push(Line::Person { text, requests });
                }
                _ => return Err(fail(CorpusProblem::NoMark)),
            }
        }
        match unlabelled {
            Some(_) => Err(CorpusError { line: text.lines().count(), problem: CorpusProblem::NoLabel }),
            None => Ok(dialogs),
        }
    }
}

impl fmt::Display for CorpusError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "line {}: ", self.line)?;
        match &self.problem {
            CorpusProblem::NoMark => formatter.write_str("begins with none of `#`, `<`, `>`, `=`, `~`"),
            CorpusProblem::Empty => formatter.write_str("has nothing after its mark"),
            CorpusProblem::NoDialog => formatter.write_str("stands before the first dialog (`# scene`)"),
            CorpusProblem::NoUtterance => formatter.write_str("is a label (`=`) that follows no utterance (`>`)"),
            CorpusProblem::NoLabel => formatter.write_str("follows an utterance (`>`) that lacks its label (`=`)"),
            CorpusProblem::Request(error) => error.fmt(formatter),
        }
    }
}

impl std::error::Error for CorpusError {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dialogs_are_read_line_by_line() {
        let text =
            "# kitchen\n> get the mug\n= pick up the mug\n< Which mug?\n\n> the red one\n= answer: the red one\n";
        let dialogs = Dialog::parse_all(text).unwrap();
        assert_eq!(dialogs.len(), 1);
        assert_eq!(dialogs[0].scene, "kitchen");
        assert_eq!(dialogs[0].lines[1], Line::Robot("Which mug?".to_owned()));
        let Line::Person { requests, .. } = &dialogs[0].lines[2] else { panic!("{dialogs:?}") };
        assert_eq!(requests[0].to_string(), "answer: the red one");
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        for (text, line, problem) in [
            ("> hi\n", 1, CorpusProblem::NoDialog),
            ("# a\nhello\n", 2, CorpusProblem::NoMark),
            ("# a\n>\n", 2, CorpusProblem::Empty),
            ("# a\n= stop\n", 2, CorpusProblem::NoUtterance),
            ("# a\n> hi\n> ho\n", 3, CorpusProblem::NoLabel),
            ("# a\n> hi\n", 2, CorpusProblem::NoLabel),
            ("# a\n> hi\n= jump\n", 3, CorpusProblem::Request(RequestError::NoForm("jump".to_owned()))),
        ] {
            assert_eq!(Dialog::parse_all(text), Err(CorpusError { line, problem }), "{text}");
        }
    }
}
