//! A study as it was checked: its texts, factors, blocks and settings.

use std::collections::{BTreeMap, BTreeSet};

use cohabit_cdf::PackId;
use cohabit_dialog::{PageTexts, Questionnaire};
use serde::{Deserialize, Serialize};

use crate::{
    instrument::Instrument,
    pair::{PAIR_SIZE, Pairing},
    probe::Probe,
    settings::{Settings, has_wizard, merged, response_delay_ms},
    tutorial::Exercise,
    wizard::Wizard,
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
    /// How two of them go together, if a session is of two; else it is of one.
    pub pairing: Option<Pairing>,
    /// How the order of within-participant conditions is assigned.
    pub assignment: Assignment,
    /// Participants of a block, or pairs of one, in which each between-participants condition is as frequent.
    pub block_size: usize,
    /// How between-participants conditions are assigned, if not in blocks.
    pub minimisation: Option<Minimisation>,
    /// The missions of the block of missions.
    pub missions: Vec<String>,
    /// The world packs of all sessions, in their order.
    pub worlds: Vec<StudyWorld>,
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
    /// How a wizard takes part in the sessions that have one.
    pub wizard: Wizard,
    /// What the experimenter notes by a key.
    pub codes: Vec<Code>,
    /// What participants read on their pages, beside the study's own texts.
    pub page_texts: PageTexts,
    /// Where those lie, if in a file of the study.
    pub page_texts_file: Option<String>,
    /// What participants read at the end, in Markdown.
    pub debriefing: Option<String>,
    /// The last day on which data of participants are kept, such as `2031-12-31`, if the study says so.
    pub keep_until: Option<String>,
    /// What shows that somebody took part.
    pub completion: Option<Completion>,
    /// The questionnaires that blocks ask, each once.
    pub questionnaires: Vec<Questionnaire>,
    /// What is known of these, by their names.
    pub instruments: BTreeMap<String, Instrument>,
    /// The texts of all files that it names, by their names.
    pub files: BTreeMap<String, String>,
}

/// A world pack of a study.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct StudyWorld {
    /// Its folder, from that of the study's file.
    pub folder: String,
    /// Its name, version and hash.
    pub id: PackId,
}

impl StudyWorld {
    /// The arguments of `cohabit play` by which a session has it, and no other one.
    #[must_use]
    pub fn arguments(&self) -> [String; 2] {
        [format!("--world={}", self.folder), format!("--world-hash={}", self.id.digest)]
    }
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

/// Something that the experimenter notes by a key.
#[derive(Clone, Debug, Eq, PartialEq, Serialize)]
pub struct Code {
    /// The key: a small letter or a digit.
    pub key: char,
    /// The note.
    pub text: String,
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
    /// Each participant one of them; of a pair, both the same.
    #[default]
    Between,
    /// Each participant all of them.
    Within,
    /// Each participant one of them, whatever that of their partner is.
    #[serde(skip)]
    Own,
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
        /// Of a tutorial, which is for practice: what is to be tried.
        exercises: Vec<Exercise>,
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

    /// How many participants a session is of.
    #[must_use]
    pub const fn session_size(&self) -> u32 {
        if self.pairing.is_some() { PAIR_SIZE } else { 1 }
    }

    /// What conditions are assigned to: participants, or pairs of them.
    #[must_use]
    pub const fn unit(&self) -> &'static str {
        if self.pairing.is_some() { "pair" } else { "participant" }
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

    /// The missions that a block plays.
    #[must_use]
    pub fn missions_of<'a>(&'a self, block: &'a Block) -> &'a [String] {
        match block {
            Block::Mission { mission, .. } => std::slice::from_ref(mission),
            Block::Missions(_) => &self.missions,
            Block::Questionnaires(_) | Block::Break { .. } => &[],
        }
    }

    /// The settings of all sessions of participants: those of each block under each of its conditions.
    #[must_use]
    pub fn all_settings(&self) -> Vec<Settings> {
        let of_block = |block: &Block| {
            let all = conditions_of(self, block);
            all.into_iter().map(|(between, within)| self.settings_of(block, &between, &within)).collect::<Vec<_>>()
        };
        self.blocks.iter().flat_map(of_block).collect()
    }

    /// Whether a wizard takes part in any session.
    #[must_use]
    pub fn has_wizard(&self) -> bool {
        self.all_settings().iter().any(has_wizard)
    }

    /// What is to be known of the conditions with a wizard and without before anybody comes, if anything: whether latencies tell them
    /// apart.
    #[must_use]
    pub fn wizard_note(&self) -> Option<String> {
        let all = self.all_settings();
        let delays = |wizard: bool| -> BTreeSet<u64> {
            all.iter().filter(|settings| has_wizard(settings) == wizard).map(response_delay_ms).collect()
        };
        let (with, without) = (delays(true), delays(false));
        if with.is_empty() || without.is_empty() {
            return None;
        }
        if with != without {
            let listed = |all: &BTreeSet<u64>| all.iter().map(u64::to_string).collect::<Vec<_>>().join(" and ");
            return Some(format!(
                "answers come {} ms after the words with a wizard and {} ms without: set `response-delay-ms` alike in both, so that \
                 participants cannot tell them apart by it",
                listed(&with),
                listed(&without)
            ));
        }
        let is_slower = with.iter().all(|delay| *delay == 0);
        is_slower.then(|| {
            "a wizard takes longer than the robot alone: set `response-delay-ms`, such as 3000, in both conditions, so that \
             participants cannot tell them apart by it"
                .to_owned()
        })
    }

    /// The names, versions and hashes of its world packs.
    #[must_use]
    pub fn world_ids(&self) -> Vec<PackId> {
        self.worlds.iter().map(|world| world.id.clone()).collect()
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

/// The conditions, of both kinds, under which the sessions of a block are played.
pub(crate) fn conditions_of(study: &Study, block: &Block) -> Vec<(Condition, Condition)> {
    let of = |kind| study.conditions(kind);
    match block {
        Block::Mission { is_practice: true, .. } => vec![(Condition::default(), Condition::default())],
        Block::Mission { .. } => {
            of(FactorKind::Between).into_iter().map(|between| (between, Condition::default())).collect()
        }
        Block::Missions(_) => {
            let within = of(FactorKind::Within);
            let with_all = |between: Condition| within.clone().into_iter().map(move |one| (between.clone(), one));
            of(FactorKind::Between).into_iter().flat_map(with_all).collect()
        }
        Block::Questionnaires(_) | Block::Break { .. } => Vec::new(),
    }
}
