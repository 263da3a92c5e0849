//! A simulated person: says what the expert's plan wants in words of their own, vaguely, wrongly or mistyped now and
//! then, and answers what the robot asks.

mod phrases;
mod refer;
mod typing;

use std::sync::Arc;

use cohabit_cdf::{Catalog, Layout, ObjectId};
use cohabit_dialog::Asked;
use cohabit_generate::Chance;
use cohabit_language::{Clarification, Known, Oracle};
use serde::{Deserialize, Serialize};

use crate::meaning::Meaning;

/// How a simulated person speaks; shares are from 0 to 1.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub struct Style {
    /// The share of things that are named by their noun alone, though there are others of that name.
    pub vagueness: f64,
    /// The share of words that are mistyped.
    pub typos: f64,
    /// The share of descriptions that are wrong in one point.
    pub mistakes: f64,
}

impl Default for Style {
    fn default() -> Self {
        Self { vagueness: 0.5, typos: 0.03, mistakes: 0.03 }
    }
}

/// The expert's words for it: they mean one thing alone.
#[must_use]
pub fn expert(meaning: &Meaning) -> String {
    phrases::exact(meaning)
}

/// A simulated person.
pub struct User {
    style: Style,
    chance: Chance,
    catalog: Arc<Catalog>,
    layout: Arc<Layout>,
    /// What was spoken of last.
    last: Option<ObjectId>,
}

impl User {
    /// A person who speaks in that style; the same seed says the same.
    #[must_use]
    pub fn new(style: Style, seed: u64, catalog: Arc<Catalog>, layout: Arc<Layout>) -> Self {
        Self { style, chance: Chance::new(seed, 0), catalog, layout, last: None }
    }

    /// What they say for the robot to do it, who see the world as it is.
    pub fn say(&mut self, meaning: &Meaning, truth: &Known) -> String {
        let style = self.style;
        let text = self.phrase(meaning, truth, style);
        let opener = if self.chance.is(0.2) { self.chance.pick(&phrases::OPENERS).copied() } else { None };
        let text = format!("{}{text}", opener.unwrap_or_default());
        typing::mistyped(&text, style.typos, &mut self.chance)
    }

    /// The same once more, as clearly as they can.
    pub fn say_clearly(&mut self, meaning: &Meaning, truth: &Known) -> String {
        self.last = None;
        self.phrase(meaning, truth, Style { vagueness: 0.0, typos: 0.0, mistakes: 0.0 })
    }

    fn phrase(&mut self, meaning: &Meaning, truth: &Known, style: Style) -> String {
        let way = self.chance.pick(phrases::ways(meaning)).copied().unwrap_or_default();
        let object = self.refer(meaning.object(), truth, style);
        let target = self.refer(meaning.target(), truth, style);
        let rest = match meaning {
            Meaning::GoTo { name, .. } => name.clone(),
            Meaning::Color { color, .. } => color.name().to_lowercase(),
            _ => String::new(),
        };
        self.last = find(meaning.object(), truth);
        way.replace("{o}", &object).replace("{t}", &target).replace("{r}", &rest)
    }

    fn refer(&mut self, instance: Option<&str>, truth: &Known, style: Style) -> String {
        let Some(object) = find(instance, truth) else { return "it".to_owned() };
        let is_held = truth.robot.held == Some(object);
        let is_spoken_of = self.last == Some(object) || is_held;
        if is_spoken_of && style.vagueness > 0.0 && self.chance.is(0.5) {
            return "it".to_owned();
        }
        // Of what it holds nobody says where it is.
        let style = if is_held { Style { vagueness: 1.0, ..style } } else { style };
        refer::describe(object, truth, &self.catalog, style, &mut self.chance)
    }

    /// What they answer to a question that came of `meaning`.
    pub fn answer(&mut self, asked: &Asked, meaning: &Meaning, truth: &Known) -> String {
        let Some(meant) = self.meant(asked, meaning, truth) else {
            return match asked.kind {
                Clarification::Confirmation => "yes".to_owned(),
                Clarification::Reference => "none of them".to_owned(),
                _ => self.say_clearly(meaning, truth),
            };
        };
        let oracle = Oracle::new(&self.catalog, truth);
        match asked.kind {
            Clarification::Reference => match asked.candidates.iter().position(|candidate| *candidate == meant) {
                Some(place) if self.chance.is(0.3) => format!("the {} one", ORDINALS[place.min(ORDINALS.len() - 1)]),
                _ => oracle.reference(meant),
            },
            Clarification::Location => oracle.location(meant, &self.layout),
            Clarification::Appearance => oracle.appearance(meant),
            Clarification::Direction => oracle.direction(meant),
            Clarification::Confirmation if asked.candidates.is_empty() || asked.candidates.contains(&meant) => {
                "yes".to_owned()
            }
            Clarification::Confirmation => format!("no, {}", oracle.reference(meant).to_lowercase()),
            Clarification::Request => self.say_clearly(meaning, truth),
        }
    }

    /// Which of the things that are wanted a question is about: the one that it names, or is of its kind.
    fn meant(&self, asked: &Asked, meaning: &Meaning, truth: &Known) -> Option<ObjectId> {
        let wanted = [meaning.object(), meaning.target()].map(|instance| find(instance, truth));
        let wanted: Vec<ObjectId> = wanted.into_iter().flatten().collect();
        let is_like = |id: &ObjectId| {
            let name = |id| truth.object(id).map(|object| &self.catalog.class(object.class).name);
            asked.candidates.iter().any(|candidate| name(*candidate) == name(*id))
        };
        let named = wanted.iter().find(|id| asked.candidates.contains(id));
        named.or_else(|| wanted.iter().find(|id| is_like(id))).or_else(|| wanted.first()).copied()
    }
}

const ORDINALS: [&str; 8] = ["first", "second", "third", "fourth", "fifth", "sixth", "seventh", "last"];

fn find(instance: Option<&str>, truth: &Known) -> Option<ObjectId> {
    let instance = instance?;
    truth.objects.iter().find(|object| object.instance == instance).map(|object| object.id)
}
