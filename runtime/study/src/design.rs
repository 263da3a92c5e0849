//! A study as it was checked: its texts, factors, blocks and settings.

use std::collections::BTreeMap;

use cohabit_dialog::Questionnaire;
use serde::{Deserialize, Serialize};

use crate::{
    instrument::Instrument,
    probe::Probe,
    settings::{Settings, merged},
};

/// A study.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Study {
    /// What participants read above each page.
    pub title: String,
    /// Whom they can ask.
    pub contact: String,
    /// The seed of the assignment and of all worlds.
    pub seed: u64,
    /// How many participants are planned.
    pub participants: u32,
    /// How the order of within-participant conditions is assigned.
    pub assignment: Assignment,
    /// Participants of a block in which each between-participants condition is as frequent.
    pub block_size: usize,
    /// How between-participants conditions are assigned, if not in blocks.
    pub minimisation: Option<Minimisation>,
    /// The missions of the block of missions.
    pub missions: Vec<String>,
    /// Settings of all sessions.
    pub settings: Settings,
    /// What participants read first.
    pub information: Sheet,
    /// What they agree to.
    pub consent: Sheet,
    /// The boxes of the consent form.
    pub consents: Vec<ConsentBox>,
    /// The factors of the design.
    pub factors: Vec<Factor>,
    /// What is done, in order.
    pub blocks: Vec<Block>,
    /// Questions during missions.
    pub probes: Vec<Probe>,
    /// What participants read at the end, in Markdown.
    pub debriefing: Option<String>,
    /// What shows that somebody took part.
    pub completion: Option<Completion>,
    /// The questionnaires that blocks ask, each once.
    pub questionnaires: Vec<Questionnaire>,
    /// What is known of these, by their names.
    pub instruments: BTreeMap<String, Instrument>,
    /// The texts of all files that it names, by their names.
    pub files: BTreeMap<String, String>,
}

/// A text with its version.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sheet {
    /// Its version.
    pub version: String,
    /// Markdown.
    pub text: String,
}

/// A box of the consent form.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct ConsentBox {
    /// What participants agree to.
    pub text: String,
    /// Whether they have to, in order to take part.
    pub is_required: bool,
    /// Whether who agrees to it may be heard by a microphone.
    pub audio: bool,
}

/// How the order of within-participant conditions is assigned.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, PartialEq)]
#[serde(rename_all = "snake_case")]
pub enum Assignment {
    /// By rows of Latin squares.
    LatinSquare,
    /// By rows of Latin squares that are balanced for what comes before.
    BalancedLatinSquare,
    /// At random for each participant.
    #[default]
    BlockRandom,
}

/// How between-participants conditions are assigned by what participants are like.
#[derive(Clone, Debug, PartialEq)]
pub struct Minimisation {
    /// What they are to be spread by.
    pub covariates: Vec<Covariate>,
    /// How probable it is that somebody gets a condition that spreads best, 0.5 to 1.
    pub certainty: f64,
}

/// Something that participants differ in.
#[derive(Clone, Debug, PartialEq)]
pub struct Covariate {
    /// What it is called in tables.
    pub name: String,
    /// How it is known.
    pub from: CovariateSource,
}

/// How a covariate is known.
#[derive(Clone, Debug, PartialEq)]
pub enum CovariateSource {
    /// From a parameter of the link by which somebody comes.
    Link {
        /// Its name.
        parameter: String,
        /// Its values.
        levels: Vec<String>,
    },
    /// From an answer that is given before any condition.
    Answer {
        /// The questionnaire.
        questionnaire: String,
        /// Which of its items, from 0.
        item: usize,
        /// Where a scale is cut into levels, each from there on.
        cuts: Vec<i32>,
    },
}

/// A factor.
#[derive(Clone, Debug, PartialEq)]
pub struct Factor {
    /// What it is called in tables.
    pub name: String,
    /// Who meets its levels.
    pub kind: FactorKind,
    /// Its levels.
    pub levels: Vec<Level>,
}

/// Who meets the levels of a factor.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, PartialEq)]
#[serde(rename_all = "snake_case")]
pub enum FactorKind {
    /// Each participant one of them.
    #[default]
    Between,
    /// Each participant all of them.
    Within,
}

/// A level of a factor.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// What it is called in tables.
    pub name: String,
    /// What makes it.
    pub settings: Settings,
}

/// What is done for a while.
#[derive(Clone, Debug, PartialEq)]
pub enum Block {
    /// Questionnaires, by name, one after the other.
    Questionnaires(Vec<String>),
    /// One mission outside the within-participant conditions.
    Mission {
        /// Which.
        mission: String,
        /// Whether it is for practice: under no condition at all, and no data of the study's question.
        is_practice: bool,
        /// Its own settings.
        settings: Settings,
        /// How long.
        limits: Limits,
        /// What participants read before it, in Markdown.
        text: String,
    },
    /// The study's missions, under all within-participant conditions.
    Missions(Missions),
    /// A break.
    Break {
        /// The longest that it lasts, s.
        limit_s: Option<f64>,
        /// What participants read, in Markdown.
        text: String,
    },
}

/// The block of missions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Missions {
    /// In what order.
    pub order: MissionOrder,
    /// Its own settings.
    pub settings: Settings,
    /// How long each lasts.
    pub limits: Limits,
    /// Questionnaires after each mission.
    pub after_mission: Vec<String>,
    /// Questionnaires after the last mission of each condition.
    pub after_condition: Vec<String>,
    /// What participants read before each, in Markdown.
    pub text: String,
}

/// In what order missions are played.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, PartialEq)]
#[serde(rename_all = "snake_case")]
pub enum MissionOrder {
    /// As they stand in the file.
    #[default]
    Fixed,
    /// In a random order for each participant.
    Random,
    /// So that each meets each condition, and stands at each position, equally often.
    Balanced,
}

/// How long a mission is played.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct Limits {
    /// The most that it is played, s.
    pub limit_s: Option<f64>,
    /// When it may be skipped, s; never, if absent.
    pub skip_after_s: Option<f64>,
}

/// What shows that somebody took part.
#[derive(Clone, Debug, Eq, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Completion {
    /// A code.
    Code(String),
    /// An address to go to.
    Return(String),
}

/// A factor's level that somebody meets.
#[derive(Clone, Debug, Deserialize, Eq, Ord, PartialEq, PartialOrd, Serialize)]
pub struct Choice {
    /// The factor.
    pub factor: String,
    /// The level.
    pub level: String,
}

/// A level of each factor of a kind, and the settings that they make.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Condition {
    /// The levels.
    pub choices: Vec<Choice>,
    /// Their settings.
    pub settings: Settings,
}

impl Study {
    /// All combinations of levels of the factors of a kind; an empty one alone, if there are none.
    #[must_use]
    pub fn conditions(&self, kind: FactorKind) -> Vec<Condition> {
        let factors = self.factors.iter().filter(|factor| factor.kind == kind);
        factors.fold(vec![Condition::default()], |conditions, factor| {
            let with = |condition: &Condition, level: &Level| Condition {
                choices: [
                    condition.choices.clone(),
                    vec![Choice { factor: factor.name.clone(), level: level.name.clone() }],
                ]
                .concat(),
                settings: merged(&[&condition.settings, &level.settings]),
            };
            let all =
                conditions.iter().flat_map(|condition| factor.levels.iter().map(move |level| with(condition, level)));
            all.collect()
        })
    }

    /// The settings of a session of a block, under a condition of each kind. Those of levels count more than those of the
    /// block of missions, which they are compared in; all others count less than a block's own.
    #[must_use]
    pub fn settings_of(&self, block: &Block, between: &Condition, within: &Condition) -> Settings {
        match block {
            Block::Mission { is_practice: true, settings, .. } => merged(&[&self.settings, settings]),
            Block::Mission { settings, .. } => merged(&[&self.settings, &between.settings, settings]),
            Block::Missions(missions) => {
                merged(&[&self.settings, &missions.settings, &between.settings, &within.settings])
            }
            Block::Questionnaires(_) | Block::Break { .. } => Settings::new(),
        }
    }

    /// The questionnaire of that name.
    #[must_use]
    pub fn questionnaire(&self, name: &str) -> Option<&Questionnaire> {
        self.questionnaires.iter().find(|one| one.name == name)
    }

    /// What is known of the questionnaire of that name.
    #[must_use]
    pub fn instrument(&self, name: &str) -> Option<&Instrument> {
        self.instruments.get(name)
    }

    /// The block of missions, if there is one.
    #[must_use]
    pub fn missions_block(&self) -> Option<&Missions> {
        self.blocks.iter().find_map(|block| match block {
            Block::Missions(missions) => Some(missions),
            _ => None,
        })
    }
}
