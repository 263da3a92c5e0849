//! Referring expressions: `the red mug on the desk`, `it`, `the second one`.

use cohabit_cdf::{ClassId, Fluid, ObjectId, RoomId};
use serde::{Deserialize, Serialize};

use crate::words::lexicon::{NamedRoom, Naming, Preposition, Pronoun, Side, StateWord};

/// Between two colours of one thing.
pub(crate) const BOTH: &str = " and ";

/// What somebody said about an object.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub(crate) struct Phrase {
    /// Its words, as they were said.
    pub(crate) text: String,
    pub(crate) pronoun: Option<Pronoun>,
    pub(crate) namings: Vec<Naming>,
    /// An instance id, lower case.
    pub(crate) instance: Option<String>,
    pub(crate) fluid: Option<Fluid>,
    /// Whether it is the floor: no thing, but what lies on nothing lies on it.
    #[serde(default)]
    pub(crate) is_floor: bool,
    pub(crate) color: Option<String>,
    pub(crate) states: Vec<StateWord>,
    /// What it is more so than others of its kind: `the tall lamp`.
    #[serde(default)]
    pub(crate) sizes: Vec<Side>,
    pub(crate) side: Option<Side>,
    pub(crate) ordinal: Option<i32>,
    pub(crate) room: Option<RoomId>,
    pub(crate) is_here: bool,
    pub(crate) is_all: bool,
    /// Of all of them, so many: `two of the mugs`.
    #[serde(default)]
    pub(crate) count: Option<u8>,
    /// Whether any of them will do.
    #[serde(default)]
    pub(crate) is_any: bool,
    /// Where it is, in terms of other objects.
    pub(crate) relations: Vec<Relation>,
    /// What it is not: `the mug that is not yellow`.
    #[serde(default)]
    pub(crate) not: Vec<Phrase>,
    /// Whether its look was said after it, by `that is`, and so perhaps of what stands before it.
    #[serde(default)]
    pub(crate) is_look_late: bool,
    /// Where somebody thinks that it is: one of these, or somewhere else.
    #[serde(default)]
    pub(crate) hints: Vec<Phrase>,
    /// Words in it that mean nothing to the robot.
    pub(crate) unknown: Vec<String>,
    /// What it was found to mean when the robot asked.
    pub(crate) chosen: Option<ObjectId>,
    /// What it was found not to mean.
    #[serde(default)]
    pub(crate) excluded: Vec<ObjectId>,
}

/// How an object relates to another.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct Relation {
    pub(crate) kind: RelationKind,
    pub(crate) to: Phrase,
}

/// Kinds of relations.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub(crate) enum RelationKind {
    /// On or in it.
    Inside,
    /// Beside it.
    Near,
    /// Has it on or in itself.
    Has,
    /// Works it, or is needed for it.
    For,
    /// Beside it, and farther left as the robot looks at it.
    LeftOf,
    /// Beside it, and farther right as the robot looks at it.
    RightOf,
}

impl RelationKind {
    /// Whether it says that the object is beside another one.
    pub(crate) const fn is_beside(self) -> bool {
        matches!(self, Self::Near | Self::LeftOf | Self::RightOf)
    }
}

/// What stands after a preposition.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[allow(clippy::large_enum_variant, reason = "a request has one or two")]
pub(crate) enum Place {
    Room(NamedRoom),
    Viewpoint(NamedRoom, u8),
    Viewpoints(u8),
    Object(Phrase),
    Side(Side),
    Here,
}

impl Phrase {
    /// Whether it says anything by which an object could be found.
    pub(crate) fn is_empty(&self) -> bool {
        self.pronoun.is_none()
            && self.namings.is_empty()
            && self.instance.is_none()
            && self.fluid.is_none()
            && !self.is_floor
            && self.chosen.is_none()
    }

    /// Whether it says something about an object, if only its colour or side.
    pub(crate) fn says_something(&self) -> bool {
        !self.is_empty()
            || self.color.is_some()
            || !self.states.is_empty()
            || self.side.is_some()
            || self.ordinal.is_some()
            || self.room.is_some()
            || self.is_here
            || self.is_all
            || !self.relations.is_empty()
            || !self.not.is_empty()
    }

    /// Whether more is said of it than what it is called.
    pub(crate) fn is_described(&self) -> bool {
        !self.relations.is_empty()
            || self.room.is_some()
            || self.color.is_some()
            || self.is_here
            || !self.not.is_empty()
            || self.pronoun == Some(Pronoun::Thing) && !self.states.is_empty()
    }

    /// `the mug on the table that is yellow`: the same, where the mug is.
    pub(crate) fn with_late_look(&self) -> Option<Self> {
        let mut phrase = self.clone();
        let late = phrase.relations.iter_mut().find(|relation| relation.to.is_look_late)?;
        late.to.is_look_late = false;
        let (color, states) = (late.to.color.take(), std::mem::take(&mut late.to.states));
        phrase.color = phrase.color.or(color);
        phrase.states.extend(states);
        Some(phrase)
    }

    /// Whether it is `it` or `them`, and no more.
    pub(crate) fn is_bare_pronoun(&self) -> bool {
        matches!(self.text.as_str(), "it" | "them" | "that" | "this" | "those" | "these")
    }

    /// Whether it is one of a kind that was named before it: `the yellow one`.
    pub(crate) fn is_one_of_kind(&self) -> bool {
        self.pronoun == Some(Pronoun::One) && self.namings.is_empty()
    }

    /// Whether it stands for several: `them`.
    pub(crate) fn is_many(&self) -> bool {
        self.pronoun == Some(Pronoun::Things)
    }

    /// How much it means this class; nothing, if it does not.
    pub(crate) fn naming(&self, class: ClassId) -> Option<f32> {
        self.namings.iter().find(|naming| naming.class == class).map(|naming| naming.weight)
    }
}

impl Place {
    /// The place in words, for questions about it.
    pub(crate) fn text(&self, preposition: Preposition) -> String {
        match self {
            Self::Room(room) | Self::Viewpoint(room, _) => format!("in the {}", room.name),
            Self::Here => "here".to_owned(),
            Self::Side(side) => format!("on the {}", format!("{side:?}").to_lowercase()),
            Self::Viewpoints(number) => format!("at viewpoint {number}"),
            Self::Object(phrase) => {
                let word = match preposition {
                    Preposition::In => "in",
                    Preposition::Near | Preposition::At => "near",
                    Preposition::With => "with",
                    Preposition::From => "from",
                    Preposition::For => "for",
                    Preposition::LeftOf => "left of",
                    Preposition::RightOf => "right of",
                    _ => "on",
                };
                format!("{word} {}", phrase.text)
            }
        }
    }
}

impl Phrase {
    /// Takes what a preposition says as a description of where it is.
    pub(crate) fn attach(&mut self, preposition: Preposition, place: Place) {
        self.text = format!("{} {}", self.text, place.text(preposition)).trim().to_owned();
        match place {
            Place::Room(room) | Place::Viewpoint(room, _) => self.room = Some(room.id),
            Place::Here => self.is_here = true,
            Place::Side(side) => self.side = Some(side),
            Place::Viewpoints(_) => {}
            Place::Object(mut to) => {
                // `the ball on the kitchen floor`: the ball is in that room.
                if to.is_floor {
                    self.room = self.room.or(to.room.take());
                }
                // `the thing next to the computer that is not the cartridge`: no cartridge is a computer.
                let nots = std::mem::take(&mut to.not);
                let is_same = |not: &Self| not.namings.iter().any(|naming| to.naming(naming.class).is_some());
                let (inner, outer): (Vec<Self>, Vec<Self>) =
                    nots.into_iter().partition(|not| not.namings.is_empty() || is_same(not));
                to.not = inner;
                self.not.extend(outer);
                let kind = match preposition {
                    Preposition::Near | Preposition::At => RelationKind::Near,
                    Preposition::With => RelationKind::Has,
                    Preposition::For => RelationKind::For,
                    Preposition::LeftOf => RelationKind::LeftOf,
                    Preposition::RightOf => RelationKind::RightOf,
                    _ => RelationKind::Inside,
                };
                // `all that is on the desk with the trophy`
                let inner = self.relations.last_mut().filter(|_| kind == RelationKind::Has && self.is_all);
                match inner {
                    Some(inner) => inner.to.relations.push(Relation { kind, to }),
                    None => self.relations.push(Relation { kind, to }),
                }
            }
        }
    }
}
