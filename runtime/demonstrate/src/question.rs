//! Questions about instructions, and an oracle's answers: the four types of Alexa Arena's trajectory data set (Gao et al. 2023,
//! "Questions Generation" and "Oracle Answers").
//!
//! Only what an instruction leaves open is asked: which thing of that name it means, where that is or what it looks like if it is not
//! in front of the robot, and which way to go to it. Of those questions a share is drawn. Which thing is meant, and what it looks
//! like, is asked once in an episode.

use std::collections::BTreeSet;

use cohabit_cdf::{Action, ActionKind, BodyId, Catalog, ObjectId};
use cohabit_generate::Chance;
use cohabit_language::{Known, KnownObject, Oracle};
use cohabit_world::World;
use serde::Serialize;

use crate::truth;

/// The share of open questions that are asked.
const ASKED: f64 = 0.5;

/// What is asked of the thing that an instruction names.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd, Serialize)]
#[serde(rename_all = "snake_case")]
enum QuestionType {
    /// Where it is.
    Location,
    /// What it looks like.
    Appearance,
    /// Which way to go.
    Direction,
    /// Which one it is.
    Reference,
}

impl QuestionType {
    const ALL: [Self; 4] = [Self::Location, Self::Appearance, Self::Direction, Self::Reference];
}

/// A question, and what the oracle answers.
#[derive(Debug, Serialize)]
pub(crate) struct QuestionEntry {
    r#type: QuestionType,
    /// The instance id of what it is about.
    object: String,
    question: String,
    answer: String,
}

/// Who hears instructions, and asks.
pub(crate) struct Asker {
    body: BodyId,
    chance: Chance,
    /// What need not be asked again.
    answered: BTreeSet<(QuestionType, ObjectId)>,
}

/// Questions about a step, with all that is true before it.
pub(crate) struct Asked {
    body: BodyId,
    truth: Known,
    object: ObjectId,
    types: Vec<QuestionType>,
}

impl Asker {
    /// Who asks in the place of that body; the same seed and episode ask the same.
    pub fn new(body: BodyId, seed: u64, episode: u64) -> Self {
        Self { body, chance: Chance::new(seed, episode), answered: BTreeSet::new() }
    }

    /// The questions about a step, before it is done.
    pub fn ask(&mut self, world: &World, action: Action) -> Option<Asked> {
        let (kind, id) = ActionKind::of(&action).filter(|(kind, _)| is_named(*kind))?;
        let truth = truth::everything(world, self.body)?;
        let mut types = open(kind, truth.object(id)?, &truth, world.catalog());
        types.retain(|kind| !self.answered.contains(&(*kind, id)) && self.chance.is(ASKED));
        let lasting = |kind: &&QuestionType| matches!(kind, QuestionType::Appearance | QuestionType::Reference);
        self.answered.extend(types.iter().filter(lasting).map(|kind| (*kind, id)));
        Some(Asked { body: self.body, truth, object: id, types })
    }
}

impl Asked {
    /// The questions with their answers, in the world as it is after the step: which way to go is told by where it has led.
    pub fn answered(&self, world: &World) -> Vec<QuestionEntry> {
        let (Some(object), Some(body)) = (self.truth.object(self.object), world.body(self.body)) else {
            return Vec::new();
        };
        let oracle = Oracle::new(world.catalog(), &self.truth);
        let noun = world.catalog().class(object.class).name.to_lowercase();
        let entry = |kind: &QuestionType| {
            let (question, answer) = match kind {
                QuestionType::Location => (format!("Where is the {noun}?"), oracle.location(object.id, world.layout())),
                QuestionType::Appearance => (format!("What does the {noun} look like?"), oracle.appearance(object.id)),
                QuestionType::Direction => {
                    let end_m = [body.position_m.x, body.position_m.y];
                    ("Which direction should I turn to?".to_owned(), oracle.way(end_m))
                }
                QuestionType::Reference => (format!("Which {noun} are you referring to?"), oracle.reference(object.id)),
            };
            QuestionEntry { r#type: *kind, object: object.instance.clone(), question, answer }
        };
        self.types.iter().map(entry).collect()
    }
}

/// Whether an instruction for it names its object: `fill the mug` names no sink.
const fn is_named(kind: ActionKind) -> bool {
    !matches!(kind, ActionKind::Fill | ActionKind::Clean)
}

/// What an instruction to do that to a thing leaves open.
fn open(kind: ActionKind, object: &KnownObject, truth: &Known, catalog: &Catalog) -> Vec<QuestionType> {
    let name = |of: &KnownObject| catalog.class(of.class).name.as_str();
    let is_namesake = |other: &KnownObject| other.id != object.id && name(other).eq_ignore_ascii_case(name(object));
    let is_open = |asked: &QuestionType| match asked {
        QuestionType::Location | QuestionType::Appearance => !object.visible,
        QuestionType::Direction => kind == ActionKind::GoTo && !object.visible,
        QuestionType::Reference => truth.objects.iter().any(is_namesake),
    };
    // Of what it holds nobody asks anything.
    let is_held = truth.robot.held == Some(object.id);
    QuestionType::ALL.into_iter().filter(|asked| !is_held && is_open(asked)).collect()
}
