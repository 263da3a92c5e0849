//! `study.toml` as it stands in its file. What is wrong with its shape was said before: here what is missing is empty.

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Spanned;

use crate::{
    design::{Assignment, FactorKind, MissionOrder},
    pair::{PartnerAbsent, SkippedBy},
    settings::Setting,
};

/// Words with their places in the text.
pub(crate) type Words = Vec<Spanned<String>>;

/// Flags with their places in the text.
pub(crate) type WrittenSettings = BTreeMap<Spanned<String>, Spanned<toml::Value>>;

#[derive(Default, Deserialize)]
#[serde(default)]
pub(crate) struct Written {
    pub title: String,
    pub contact: String,
    pub language: Option<Spanned<String>>,
    pub page_texts: Option<Spanned<String>>,
    pub seed: u64,
    pub participants: Option<Spanned<u32>>,
    pub participants_per_session: Option<Spanned<u32>>,
    pub pair: Option<Spanned<WrittenPair>>,
    pub assignment: Option<Spanned<Assignment>>,
    pub block_size: Option<Spanned<usize>>,
    pub minimisation: Option<Spanned<WrittenMinimisation>>,
    pub missions: Option<Spanned<Words>>,
    pub world: Option<Words>,
    pub settings: WrittenSettings,
    pub keep_until: Option<Spanned<String>>,
    pub completion_code: Option<Spanned<String>>,
    pub return_url: Option<Spanned<String>>,
    pub information: WrittenSheet,
    pub consent: WrittenSheet,
    pub factor: Vec<Spanned<WrittenFactor>>,
    pub block: Vec<Spanned<WrittenBlock>>,
    pub probe: Vec<Spanned<WrittenProbe>>,
    pub wizard: Option<Spanned<WrittenWizard>>,
    pub code: Vec<Spanned<WrittenCode>>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(crate) struct WrittenCode {
    pub key: Option<Spanned<String>>,
    pub text: Option<Spanned<String>>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(crate) struct WrittenPair {
    pub partner_absent: PartnerAbsent,
    pub partner_minutes: Option<Spanned<f64>>,
    pub skip: SkippedBy,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(crate) struct WrittenWizard {
    pub timeout_s: Option<Spanned<f64>>,
    pub on_timeout: Option<Spanned<String>>,
    pub moment: Option<Spanned<String>>,
    pub phrase: Vec<Spanned<WrittenPhrase>>,
    pub error: Vec<Spanned<WrittenError>>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(crate) struct WrittenError {
    pub name: Option<Spanned<String>>,
    pub say: Option<Spanned<String>>,
    #[serde(rename = "do")]
    pub order: Option<Spanned<String>>,
    pub step: Option<Spanned<u8>>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(crate) struct WrittenPhrase {
    pub key: Option<Spanned<String>>,
    pub text: Option<Spanned<String>>,
    pub waits: bool,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(crate) struct WrittenMinimisation {
    pub certainty: Option<Spanned<f64>>,
    pub covariate: Vec<Spanned<WrittenCovariate>>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(crate) struct WrittenCovariate {
    pub name: Option<Spanned<String>>,
    pub parameter: Option<Spanned<String>>,
    pub levels: Option<Words>,
    pub questionnaire: Option<Spanned<String>>,
    pub item: Option<Spanned<usize>>,
    pub cuts: Option<Vec<Spanned<i32>>>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(crate) struct WrittenProbe {
    pub questionnaire: Option<Spanned<String>>,
    pub at: Option<Spanned<String>>,
    pub minutes: Option<Spanned<f64>>,
    pub pause: bool,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(crate) struct WrittenSheet {
    pub file: Option<Spanned<String>>,
    pub version: String,
    pub required: Vec<WrittenBox>,
    pub optional: Vec<WrittenBox>,
}

/// A box of the consent form: its sentence, or that with what it is about.
#[derive(Deserialize)]
#[serde(untagged)]
pub(crate) enum WrittenBox {
    Sentence(String),
    Marked {
        #[serde(default)]
        text: String,
        #[serde(default)]
        audio: bool,
    },
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(crate) struct WrittenFactor {
    pub name: Option<Spanned<String>>,
    pub kind: FactorKind,
    pub unit: Option<Spanned<Unit>>,
    pub level: Vec<Spanned<WrittenLevel>>,
}

/// To what the levels of a factor between participants are assigned.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Unit {
    Pair,
    Participant,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(crate) struct WrittenLevel {
    pub name: Option<Spanned<String>>,
    pub settings: WrittenSettings,
}

#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, PartialEq)]
#[serde(rename_all = "snake_case")]
pub(crate) enum BlockKind {
    #[default]
    Questionnaire,
    Mission,
    Practice,
    Tutorial,
    Missions,
    Break,
    Debriefing,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(crate) struct WrittenBlock {
    pub kind: BlockKind,
    pub questionnaires: Option<Words>,
    pub mission: Option<Spanned<String>>,
    pub settings: Option<WrittenSettings>,
    pub order: Option<MissionOrder>,
    pub minutes: Option<Spanned<f64>>,
    pub skip_after_minutes: Option<Spanned<f64>>,
    pub exercise: Option<Vec<Spanned<WrittenExercise>>>,
    pub after_mission: Option<Words>,
    pub after_condition: Option<Words>,
    pub file: Option<Spanned<String>>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
pub(crate) struct WrittenExercise {
    pub what: Option<Spanned<String>>,
    pub text: Option<Spanned<String>>,
}

impl BlockKind {
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Questionnaire => "questionnaire",
            Self::Mission => "mission",
            Self::Practice => "practice",
            Self::Tutorial => "tutorial",
            Self::Missions => "missions",
            Self::Break => "break",
            Self::Debriefing => "debriefing",
        }
    }
}

impl WrittenBlock {
    /// The keys that it has besides its kind.
    pub(crate) fn keys(&self) -> Vec<&'static str> {
        let all = [
            ("questionnaires", self.questionnaires.is_some()),
            ("mission", self.mission.is_some()),
            ("settings", self.settings.is_some()),
            ("order", self.order.is_some()),
            ("minutes", self.minutes.is_some()),
            ("skip_after_minutes", self.skip_after_minutes.is_some()),
            ("exercise", self.exercise.is_some()),
            ("after_mission", self.after_mission.is_some()),
            ("after_condition", self.after_condition.is_some()),
            ("file", self.file.is_some()),
        ];
        all.into_iter().filter_map(|(name, is_there)| is_there.then_some(name)).collect()
    }
}

/// The setting itself.
pub(crate) fn setting(value: &toml::Value) -> Setting {
    match value {
        toml::Value::Boolean(is_on) => Setting::Switch(*is_on),
        toml::Value::Array(values) => Setting::Values(values.iter().map(text).collect()),
        other => Setting::Value(text(other)),
    }
}

fn text(value: &toml::Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}
