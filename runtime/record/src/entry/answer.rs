//! What people answered to questionnaires.

use cohabit_bus::{
    Envelope,
    message::{AnswerKind, AnswerMessage},
};
use serde::{Deserialize, Serialize};

use super::{Entry, is_zero, run};

/// What a person answered to a question of a questionnaire; the newest to a question counts.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct AnswerEntry {
    /// The newest tick that was recorded before it.
    pub tick: u64,
    /// The number of the person's page.
    pub person: u32,
    /// The questionnaire's name.
    pub questionnaire: String,
    /// Which question, from 1.
    pub item: u32,
    /// What was asked.
    pub question: String,
    /// What kind of answer it is.
    pub kind: String,
    /// The number that was chosen.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value: Option<i32>,
    /// The lowest and the highest number of its scale.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<[i32; 2]>,
    /// Whether a high number means little of what the questionnaire measures.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub reversed: bool,
    /// The words, or what was chosen says.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub text: String,
    /// Whose run sent it; 0 where none did.
    #[serde(default, with = "run", skip_serializing_if = "is_zero")]
    pub run: u64,
    /// That run's count of answers, from 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub sequence: u64,
}

impl AnswerEntry {
    /// The entry of an answer as published when `tick` was the newest; `None` if it is of no known kind.
    #[must_use]
    pub fn new(tick: u64, envelope: &Envelope, message: &AnswerMessage) -> Option<Self> {
        let kind = message.kind()?;
        Some(Self {
            tick,
            person: message.person,
            questionnaire: message.questionnaire.as_str().to_owned(),
            item: message.item,
            question: message.question.as_str().to_owned(),
            kind: format!("{kind:?}"),
            value: (kind != AnswerKind::Words).then_some(message.value),
            scale: (kind == AnswerKind::Scale).then_some([message.least, message.most]),
            reversed: message.reversed != 0,
            text: message.text.as_str().to_owned(),
            run: envelope.run,
            sequence: envelope.sequence,
        })
    }
}

impl Entry for AnswerEntry {
    const TOPIC: &'static str = "/answers";
    const SCHEMA: &'static str = r#"{"title":"Answer","type":"object","properties":{"tick":{"type":"integer"},"person":{"type":"integer"},"questionnaire":{"type":"string"},"item":{"type":"integer"},"question":{"type":"string"},"kind":{"type":"string"},"value":{"type":"integer"},"scale":{"type":"array","items":{"type":"integer"}},"reversed":{"type":"boolean"},"text":{"type":"string"},"run":{"type":"string"},"sequence":{"type":"integer"}}}"#;
}
