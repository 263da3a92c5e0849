//! What people wrote, in the episodes of the data set: `episode.json` gets a member `human`, which is its last one, and no other byte of
//! it changes. Exported again, the same annotations give the same bytes.

#[cfg(test)]
mod tests;

use std::{
    collections::BTreeMap,
    fs, io,
    path::{Path, PathBuf},
};

use cohabit_convert::native::Dataset;
use cohabit_durable::{Readers, write_whole};
use serde::Serialize;
use serde_json::Value;

use crate::{
    assign::Board,
    error::{AnnotateError, at},
    journal::Journal,
    journal_path,
    task::{Annotation, Task},
};

/// What stands before it: in a file with a line for each member, no text has this in it.
const MEMBER: &str = ",\n  \"human\": ";
/// How `episode.json` ends.
const END: &str = "\n}\n";
/// What is around the part of the data card that is about it.
const CARD_MARKS: [&str; 2] = ["\n<!-- what people wrote -->\n", "<!-- end of what people wrote -->\n"];
/// What the members are.
const CARD: &str = include_str!("../data/card.md");

/// What was exported.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Exported {
    /// Episodes that have any of it.
    pub episodes: usize,
    /// Instructions.
    pub instructions: usize,
    /// Questions.
    pub questions: usize,
    /// Answers.
    pub answers: usize,
    /// Texts about steps that the data set does not have.
    pub left_out: usize,
}

/// What people wrote about an episode.
#[derive(Debug, Default, Serialize)]
struct Human<'a> {
    instructions: Vec<Instruction<'a>>,
    questions: Vec<Question<'a>>,
}

#[derive(Debug, Serialize)]
struct Instruction<'a> {
    annotator: &'a str,
    first_step: usize,
    end_step: usize,
    text: &'a str,
}

#[derive(Debug, Serialize)]
struct Question<'a> {
    annotator: &'a str,
    first_step: usize,
    end_step: usize,
    /// The step before which it was asked.
    moment_step: usize,
    /// The instruction that was read, as it was then.
    instruction: &'a str,
    text: &'a str,
    answers: Vec<Answer<'a>>,
}

#[derive(Debug, Serialize)]
struct Answer<'a> {
    annotator: &'a str,
    /// The question that was read, as it was then.
    question: &'a str,
    text: &'a str,
}

/// Writes all texts of a data set's journal into its episodes, and into its card how many they are.
///
/// # Errors
/// [`AnnotateError`]. A file is whole in any case; the same call goes on.
pub fn export(folder: &Path) -> Result<Exported, AnnotateError> {
    let dataset = Dataset::open(folder)?;
    let board = Board::of_record(Journal::read(&journal_path(folder))?);
    let mut by_episode: BTreeMap<&str, Vec<&Annotation>> = BTreeMap::new();
    for annotation in board.annotations().filter(|one| one.text().is_some()) {
        by_episode.entry(annotation.task.segment().episode.as_str()).or_default().push(annotation);
    }
    let all: usize = by_episode.values().map(Vec::len).sum();
    let mut exported = Exported::default();
    let mut files = Vec::new();
    for episode in &dataset.episodes {
        let texts = by_episode.get(episode.folder.as_str()).map(Vec::as_slice).unwrap_or_default();
        let human = human(texts, episode.steps);
        let answers: usize = human.questions.iter().map(|asked| asked.answers.len()).sum();
        exported.instructions += human.instructions.len();
        exported.questions += human.questions.len();
        exported.answers += answers;
        exported.episodes += usize::from(!human.is_empty());
        let path = dataset.path(episode, "episode.json");
        let before = fs::read_to_string(&path).map_err(at(&path))?;
        let after = with_member(&before, &human).ok_or_else(|| damaged(&path))?;
        if after != before {
            files.push((path, after));
        }
    }
    let written = exported.instructions + exported.questions + exported.answers;
    exported.left_out = all.saturating_sub(written);
    let path = folder.join("README.md");
    let before = card(&path)?;
    let after = with_part(&before, &part(exported));
    if after != before {
        files.push((path, after));
    }
    // Nothing is written before all of it is known to be sound.
    files.iter().try_for_each(|(path, text)| write_whole(path, text.as_bytes(), Readers::All).map_err(at(path)))?;
    Ok(exported)
}

impl Human<'_> {
    const fn is_empty(&self) -> bool {
        self.instructions.is_empty() && self.questions.is_empty()
    }
}

/// What is to stand in an episode of so many steps. Questions have the answers to them.
fn human<'a>(texts: &[&'a Annotation], steps: usize) -> Human<'a> {
    let mut human = Human::default();
    let mut places: BTreeMap<u64, usize> = BTreeMap::new();
    for annotation in texts.iter().copied() {
        let (segment, annotator) = (annotation.task.segment(), annotation.annotator.as_str());
        let (first_step, end_step) = (segment.first_step, segment.end_step);
        let Some(text) = annotation.text().filter(|_| first_step < end_step && end_step <= steps) else { continue };
        match &annotation.task {
            Task::Instruction { .. } => {
                human.instructions.push(Instruction { annotator, first_step, end_step, text });
            }
            Task::Question { moment_step, instruction, .. } => {
                places.insert(annotation.id, human.questions.len());
                let (moment_step, instruction) = (*moment_step, instruction.text.as_str());
                human.questions.push(Question {
                    annotator,
                    first_step,
                    end_step,
                    moment_step,
                    instruction,
                    text,
                    answers: Vec::new(),
                });
            }
            Task::Answer { question, .. } => {
                if let Some(place) = places.get(&question.id).copied() {
                    human.questions[place].answers.push(Answer { annotator, question: &question.text, text });
                }
            }
        }
    }
    human
}

/// An `episode.json` with this member, or without any where nobody wrote anything; `None`, if it is no such file.
fn with_member(text: &str, human: &Human<'_>) -> Option<String> {
    let body = text.strip_suffix(END)?;
    let bare = body.find(MEMBER).map_or(body, |at| &body[..at]);
    // What stands there must be this member alone.
    let mut known: Value = serde_json::from_str(text).ok()?;
    known.as_object_mut()?.remove("human");
    if serde_json::from_str::<Value>(&format!("{bare}{END}")).ok()? != known {
        return None;
    }
    if human.is_empty() {
        return Some(format!("{bare}{END}"));
    }
    // A line within the file is two spaces further to the right.
    let member = serde_json::to_string_pretty(human).ok()?.replace('\n', "\n  ");
    Some(format!("{bare}{MEMBER}{member}{END}"))
}

fn damaged(path: &Path) -> AnnotateError {
    AnnotateError::Damaged {
        path: PathBuf::from(path),
        reason: "this is not as `cohabit demonstrate` and `cohabit annotate` write it, so nothing was exported; put it back as it was, or \
                 remove the episode's folder, and `cohabit demonstrate` makes it anew"
            .to_owned(),
    }
}

/// The data card; a data set is whole without it.
fn card(path: &Path) -> Result<String, AnnotateError> {
    match fs::read_to_string(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(String::new()),
        read => read.map_err(at(path)),
    }
}

/// What the card says of it; nothing, where there is nothing.
fn part(exported: Exported) -> String {
    let Exported { episodes, instructions, questions, answers, .. } = exported;
    if episodes == 0 {
        return String::new();
    }
    CARD.replace("{episodes}", &episodes.to_string())
        .replace("{instructions}", &instructions.to_string())
        .replace("{questions}", &questions.to_string())
        .replace("{answers}", &answers.to_string())
}

/// A card with this part instead of the one that it may have.
fn with_part(card: &str, part: &str) -> String {
    let [begin, end] = CARD_MARKS;
    let (before, after) = match card.split_once(begin) {
        Some((before, rest)) => (before, rest.split_once(end).map_or("", |(_, after)| after)),
        None => (card, ""),
    };
    let part = if part.is_empty() { String::new() } else { format!("{begin}{part}{end}") };
    format!("{before}{part}{after}")
}
