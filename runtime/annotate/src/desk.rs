//! A data set that is annotated: its films, its board and its journal, and what a page may ask of them.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use serde::Deserialize;
use serde_json::{Value, json};

use crate::{
    assign::{Board, Claim, Settings},
    error::AnnotateError,
    film::{Cut, Films},
    journal::Journal,
    journal_path,
    links::Links,
    links_path,
    task::{Annotation, Reason, Task, What},
};

/// The longest text, in characters: five long sentences.
const LONGEST_TEXT: usize = 500;
/// How many of their own annotations somebody sees at most, the newest ones.
const MOST_OWN: usize = 20;
/// Why people write nothing, in words.
const REASONS: [(Reason, &str); 3] = [
    (Reason::CannotTell, "I cannot tell"),
    (Reason::Unclear, "What I had to read makes no sense"),
    (Reason::Pictures, "The pictures are missing or broken"),
];

/// Why something is not saved, for whoever wrote it.
#[derive(Debug, thiserror::Error)]
pub enum Refused {
    /// There is no text.
    #[error("Please write something, or say why you skip this.")]
    Empty,
    /// There is too much text.
    #[error("Nothing was saved: this text has {0} characters, and {most} are the most.", most = LONGEST_TEXT)]
    TooLong(usize),
    /// The task is somebody else's now.
    #[error("This task has gone to somebody else meanwhile, so nothing was saved. Please go on with the next one.")]
    Late,
    /// There is no such annotation of theirs.
    #[error("There is no such text of yours; nothing was saved.")]
    NotYours,
    /// The disk does not take it.
    #[error(
        "Nothing was saved: the computer that keeps the texts has a problem. Your text is still here; please tell whoever gave you \
         the link, and try again."
    )]
    NotSaved(#[source] AnnotateError),
}

/// What somebody sends.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Sent {
    /// What came of the task that they have taken under this number.
    Annotation { claim: u64, what: What },
    /// A better text for one that they wrote.
    Correction { id: u64, text: String },
}

/// A data set that is annotated.
#[derive(Debug)]
pub struct Desk {
    films: Films,
    board: Board,
    journal: Journal,
    links: Links,
    /// The task that each annotator sent last.
    sent: BTreeMap<String, u64>,
}

impl Desk {
    /// Opens a data set for these annotators and those who have a link already. `now_ms` is the time, ms since 1970.
    ///
    /// # Errors
    /// [`AnnotateError`].
    pub fn open(
        folder: &Path,
        names: &[String],
        cut: Cut,
        settings: Settings,
        now_ms: u64,
    ) -> Result<Self, AnnotateError> {
        let films = Films::open(folder)?;
        let (journal, annotations) = Journal::open(&journal_path(folder))?;
        let links = Links::open(&links_path(folder), names)?;
        if links.annotators.len() < settings.per_segment {
            return Err(AnnotateError::Annotators(format!(
                "each segment is to be annotated by {} people, and there are {}: add annotators, or lower `--per-segment`",
                settings.per_segment,
                links.annotators.len()
            )));
        }
        let mut board = Board::new(settings, films.segments(cut), links.annotators.len(), now_ms);
        annotations.into_iter().for_each(|annotation| board.note(annotation));
        Ok(Self { films, board, journal, links, sent: BTreeMap::new() })
    }

    /// Who may annotate, and by which tokens.
    #[must_use]
    pub const fn links(&self) -> &Links {
        &self.links
    }

    /// How many segments there are.
    #[must_use]
    pub fn segments(&self) -> usize {
        self.board.segments()
    }

    /// What is there so far.
    #[must_use]
    pub const fn board(&self) -> &Board {
        &self.board
    }

    /// Where the picture before a step is.
    pub(crate) fn picture_path(&self, episode: usize, step: usize) -> Option<PathBuf> {
        self.films.picture_path(episode, step)
    }

    /// What the page of an annotator shows: their task, and what they wrote before.
    pub(crate) fn page(&mut self, annotator: &str, now_ms: u64) -> Value {
        let claim = self.board.take(annotator, now_ms);
        let task = claim.as_ref().and_then(|claim| self.task(claim));
        let own = self.board.annotations().rev().filter(|one| one.annotator == annotator);
        let texts = own.clone().filter_map(|one| {
            Some(json!({ "id": one.id, "kind": one.task.unit().kind().name(), "text": one.text()? }))
        });
        json!({
            "annotator": annotator,
            "task": task,
            "done": own.count(),
            "own": texts.take(MOST_OWN).collect::<Vec<_>>(),
            "longest_text": LONGEST_TEXT,
            "reasons": REASONS.map(|(reason, text)| json!({ "reason": reason, "text": text })),
            "problem": null,
        })
    }

    /// A task as a page shows it; none, where the data set lost its episode.
    fn task(&self, claim: &Claim) -> Option<Value> {
        let segment = claim.task.segment();
        let (instruction, question) = match &claim.task {
            Task::Instruction { .. } => (None, None),
            Task::Question { instruction, .. } => (Some(&instruction.text), None),
            Task::Answer { instruction, question, .. } => (Some(&instruction.text), Some(&question.text)),
        };
        Some(json!({
            "claim": claim.number,
            "kind": claim.task.unit().kind().name(),
            "episode": self.films.number(segment)?,
            "first_step": segment.first_step,
            "last_step": claim.task.last_step(),
            "instruction": instruction,
            "question": question,
        }))
    }

    /// Saves what somebody sends. What is sent twice counts once.
    pub(crate) fn receive(&mut self, annotator: &str, sent: Sent, now_ms: u64) -> Result<(), Refused> {
        let mut finished = None;
        let annotation = match sent {
            Sent::Annotation { claim, .. } if self.sent.get(annotator) == Some(&claim) => return Ok(()),
            Sent::Annotation { claim, what } => {
                finished = Some(claim);
                let what = match what {
                    What::Text(text) => What::Text(checked(&text)?),
                    What::Skipped(reason) => What::Skipped(reason),
                };
                let claim = self.board.claim(annotator, claim, now_ms).ok_or(Refused::Late)?;
                let Claim { task, taken_ms, .. } = claim.clone();
                self.annotation(annotator, task, what, taken_ms, now_ms)
            }
            Sent::Correction { id, text } => {
                let text = checked(&text)?;
                let own = self.board.annotation(id).filter(|one| one.annotator == annotator);
                let own = own.filter(|one| one.text().is_some()).ok_or(Refused::NotYours)?.clone();
                if own.text() == Some(text.as_str()) {
                    return Ok(());
                }
                let what = What::Text(text);
                Annotation { corrects: Some(id), ..self.annotation(annotator, own.task, what, own.taken_ms, now_ms) }
            }
        };
        self.journal.append(&annotation).map_err(Refused::NotSaved)?;
        self.board.note(annotation);
        if let Some(claim) = finished {
            self.sent.insert(annotator.to_owned(), claim);
        }
        Ok(())
    }

    fn annotation(&self, annotator: &str, task: Task, what: What, taken_ms: u64, at_ms: u64) -> Annotation {
        let (id, annotator) = (self.board.next_id(), annotator.to_owned());
        Annotation { id, annotator, task, what, taken_ms, at_ms, corrects: None }
    }
}

/// A text in one line, if it can be saved.
fn checked(text: &str) -> Result<String, Refused> {
    let words: Vec<String> = text
        .split_whitespace()
        .map(|word| word.chars().filter(|letter| !letter.is_control()).collect::<String>())
        .filter(|word| !word.is_empty())
        .collect();
    let text = words.join(" ");
    match text.chars().count() {
        0 => Err(Refused::Empty),
        count if count > LONGEST_TEXT => Err(Refused::TooLong(count)),
        _ => Ok(text),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_one_line_of_bounded_length() {
        assert_eq!(checked("  get\nthe \u{7}bowl\t").unwrap(), "get the bowl");
        assert!(matches!(checked(" \n\u{7} "), Err(Refused::Empty)));
        assert!(checked(&"ä".repeat(LONGEST_TEXT)).is_ok());
        assert!(matches!(checked(&"ä".repeat(LONGEST_TEXT + 1)), Err(Refused::TooLong(501))));
    }
}
