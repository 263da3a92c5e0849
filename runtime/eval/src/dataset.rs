//! The reference's trajectory data set: missions with the words of several people, and an expert's commands.

use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;

use crate::task::{Answer, Line, Task};

/// One mission of the data set.
#[derive(Deserialize)]
struct Session {
    #[serde(rename = "CDF")]
    cdf: Value,
    #[serde(default)]
    human_annotations: Vec<Annotation>,
    #[serde(default)]
    synthetic_annotations: Vec<Annotation>,
    #[serde(default)]
    actions: Vec<Value>,
}

/// What one person said in it.
#[derive(Deserialize)]
struct Annotation {
    instructions: Vec<Instruction>,
}

#[derive(Deserialize)]
struct Instruction {
    instruction: String,
    #[serde(default)]
    question_answers: Vec<QuestionAnswer>,
}

#[derive(Deserialize)]
struct QuestionAnswer {
    question: String,
    answer: String,
}

/// A task for each person's words, for each synthetic annotation, and for the expert's commands: `…#human1`,
/// `…#synthetic1`, `…#expert`.
///
/// # Errors
/// What is wrong with the text.
pub fn read(text: &str) -> Result<Vec<Task>, serde_json::Error> {
    let sessions: BTreeMap<String, Session> = serde_json::from_str(text)?;
    let mut tasks = Vec::new();
    for (id, session) in sessions {
        let cdf = session.cdf.to_string();
        let mut add = |who: String, script: Vec<Line>| {
            tasks.push(Task {
                id: format!("{id}#{who}"),
                family: None,
                cdf: cdf.clone(),
                preparation: Vec::new(),
                script,
            });
        };
        for (number, annotation) in (1..).zip(session.human_annotations) {
            add(format!("human{number}"), annotation.lines());
        }
        for (number, annotation) in (1..).zip(session.synthetic_annotations) {
            add(format!("synthetic{number}"), annotation.lines());
        }
        if !session.actions.is_empty() {
            add("expert".to_owned(), session.actions.into_iter().map(Line::Action).collect());
        }
    }
    Ok(tasks)
}

/// A task for each mission, by its name: for who plays it from its goals alone, whatever people say in it.
///
/// # Errors
/// What is wrong with the text.
pub fn missions(text: &str) -> Result<Vec<Task>, serde_json::Error> {
    let sessions: BTreeMap<String, Session> = serde_json::from_str(text)?;
    let task = |(id, session): (String, Session)| Task {
        id,
        family: None,
        cdf: session.cdf.to_string(),
        preparation: Vec::new(),
        script: Vec::new(),
    };
    Ok(sessions.into_iter().map(task).collect())
}

impl Annotation {
    fn lines(self) -> Vec<Line> {
        let line = |instruction: Instruction| {
            let answer = |pair: QuestionAnswer| Answer { question: pair.question, text: pair.answer };
            let answers = instruction.question_answers.into_iter().map(answer).collect();
            Line::Utterance { text: instruction.instruction, answers }
        };
        self.instructions.into_iter().map(line).collect()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn a_mission_for_which_several_people_have_words_is_one_mission() {
        let said = r#"[{"instructions": [{"instruction": "go"}]}, {"instructions": [{"instruction": "walk"}]}]"#;
        let text = format!(
            r#"{{"a": {{"CDF": {{}}, "human_annotations": {said}, "actions": [{{"type": "Dialog"}}]}}, "b": {{"CDF": {{}}}}}}"#
        );
        let ids = |tasks: Vec<Task>| tasks.into_iter().map(|task| task.id).collect::<Vec<_>>();
        assert_eq!(ids(read(&text).unwrap()), ["a#human1", "a#human2", "a#expert"]);
        assert_eq!(ids(missions(&text).unwrap()), ["a", "b"]);
    }
}
