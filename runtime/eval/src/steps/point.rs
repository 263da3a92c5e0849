//! Where a session goes on otherwise.

use cohabit_record::{DialogEntry, InputEntry, Log};

use super::{Instead, Step};
use crate::lock_step::BODY;

/// What stands for a command in what people are told.
const EXAMPLE: &str = r#"{"GoTo": {"target": {"Room": "BreakRoom"}}}"#;

/// A point of a recorded session.
pub(super) struct Point {
    /// The newest tick before it.
    pub tick: u64,
    /// How many entries of the log's dialog are before it.
    pub dialog: usize,
    /// The command that another one takes the place of, if it is one.
    pub input: Option<InputEntry>,
}

impl Point {
    /// That of a step; or why something of that kind cannot take its place.
    pub fn of(log: &Log, step: &Step, instead: &Instead) -> Result<Self, String> {
        if log.session.format < 2 {
            return Err("the log is of a version that is too old to be gone on from".to_owned());
        }
        match (&step.did, instead) {
            (None, Instead::Said(_)) => Self::of_words(log, step),
            (Some(did), Instead::Did(_)) => Self::of_command(log, step, did.command),
            (None, Instead::Did(_)) => Err("something was said there: words take its place, and no command".to_owned()),
            (Some(_), Instead::Said(_)) => {
                Err(format!("a command was given there: one takes its place, as JSON, such as {EXAMPLE}"))
            }
        }
    }

    fn of_words(log: &Log, step: &Step) -> Result<Self, String> {
        if step.body != BODY.0 {
            let (body, own) = (step.body, BODY.0);
            return Err(format!("it was said to body {body}; only what is said to body {own} can be something else"));
        }
        let is_it =
            |entry: &DialogEntry| entry.kind == "Utterance" && Some(entry.turn) == step.turn && entry.body == step.body;
        let dialog = log.dialog.iter().position(is_it).ok_or("the log does not have it")?;
        Ok(Self { tick: step.tick, dialog, input: None })
    }

    fn of_command(log: &Log, step: &Step, command: u64) -> Result<Self, String> {
        let mut inputs = log.ticks.iter().filter(|entry| entry.tick == step.tick + 1).flat_map(|entry| &entry.inputs);
        let is_it = |input: &&InputEntry| input.command == command && input.body == step.body;
        let input = inputs.find(is_it).cloned().ok_or("the log does not have it")?;
        let dialog = log.dialog.iter().take_while(|entry| entry.tick <= step.tick).count();
        Ok(Self { tick: step.tick, dialog, input: Some(input) })
    }

    /// Whether a command is the one that another one takes the place of.
    pub fn replaces(&self, input: &InputEntry) -> bool {
        self.input.as_ref().is_some_and(|own| own.command == input.command && own.body == input.body)
    }
}
