//! What a body can be told to do, as tools that a language model calls: their names and descriptions follow from the table of
//! actions. In which form a model is told of them is no matter here.

use cohabit_cdf::{ActionKind, ActionTable};

/// The most reasons for a refusal that a description has: first those of the action's own, such as the tool that it takes, then those
/// of getting at a thing, which are alike for all actions. Of either, those that come up first stand first in the table.
const MOST_REFUSALS: usize = 8;

/// What the names in the table's sentences stand for, and what all others do.
const NAMES: [(&str, &str); 4] =
    [("it", "the object"), ("held", "what is held"), ("cover", "what covers it"), ("holder", "what holds it")];
const OTHER_NAME: &str = "it";

/// What a tool has a body do.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum ToolDeed {
    /// Move along its heading.
    Move,
    /// Turn on the spot.
    Turn,
    /// Turn once around, looking.
    LookAround,
    /// An action of the table on an object.
    Handle(ActionKind),
}

/// What a tool is called with, if with anything.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ToolArgument {
    /// The object that it is done to.
    Object,
    /// A number between two others.
    Number {
        /// What it is called, with its unit.
        name: &'static str,
        /// The lowest.
        low: f64,
        /// The highest.
        high: f64,
    },
}

/// A tool of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Tool {
    /// What it has the body do.
    pub deed: ToolDeed,
    /// What it does, what people say for it, and why it is refused.
    pub description: String,
}

impl ToolDeed {
    /// The name of the tool.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Move => "move",
            Self::Turn => "turn",
            Self::LookAround => "look_around",
            Self::Handle(kind) => kind.name(),
        }
    }

    /// What it is called with.
    #[must_use]
    pub const fn argument(self) -> Option<ToolArgument> {
        match self {
            Self::Move => Some(ToolArgument::Number { name: "distance_m", low: -10.0, high: 10.0 }),
            Self::Turn => Some(ToolArgument::Number { name: "yaw_rad", low: -6.3, high: 6.3 }),
            Self::LookAround => None,
            Self::Handle(_) => Some(ToolArgument::Object),
        }
    }

    fn summary(self) -> String {
        let summary = match self {
            Self::Move => "Move along the heading, by a distance in metres; a negative one is backwards.",
            Self::Turn => {
                "Turn on the spot, by an angle in radians (1.57 is a quarter turn); a positive one is to the left."
            }
            Self::LookAround => "Turn once around, looking.",
            Self::Handle(ActionKind::GoTo) => "Walk to an object, so that it is within reach, or into a room.",
            Self::Handle(ActionKind::PickUp) => "Take an object into the empty hand.",
            Self::Handle(ActionKind::Place) => "Put what is held onto or into a receptacle.",
            Self::Handle(ActionKind::Break) => "Break an object with the hammer in the hand, or cut it with the knife.",
            Self::Handle(ActionKind::Pour) => "Pour what is in the held thing into or onto an object.",
            Self::Handle(ActionKind::Fill) => {
                "Fill what is held, at the object that gives water; or an object that is held or stands in the sink."
            }
            Self::Handle(ActionKind::Clean) => {
                "Clean what is held, at the object that gives water; or an object that is held or lies in the sink."
            }
            Self::Handle(ActionKind::Throw) => "Throw what is held at an object: the object is the target.",
            Self::Handle(kind) => {
                return format!("{} an object, with the hand or with what it holds.", capitalized(kind.name()));
            }
        };
        summary.to_owned()
    }
}

/// All tools of a body in a world with this table.
#[must_use]
pub fn tools(table: &ActionTable) -> Vec<Tool> {
    let motions = [ToolDeed::Move, ToolDeed::Turn, ToolDeed::LookAround];
    let deeds = motions.into_iter().chain(ActionKind::ALL.map(ToolDeed::Handle));
    deeds.map(|deed| Tool { deed, description: description(deed, table) }).collect()
}

fn description(deed: ToolDeed, table: &ActionTable) -> String {
    let mut text = deed.summary();
    let ToolDeed::Handle(kind) = deed else { return text };
    let (mut spoken, mut refusals) = (Vec::new(), Vec::new());
    for rule in table.rules().iter().filter(|rule| rule.action == kind) {
        for word in &rule.words {
            if !spoken.contains(word) {
                spoken.push(word.clone());
            }
        }
        for need in &rule.needs {
            let refusal = (need.is_of_access(), need.status, need.words.as_str());
            if !refusals.contains(&refusal) {
                refusals.push(refusal);
            }
        }
    }
    if !spoken.is_empty() {
        text += &format!(" People say `{}`.", spoken.join("`, `"));
    }
    if !refusals.is_empty() {
        refusals.sort_by_key(|(is_of_access, ..)| *is_of_access);
        let sentences: Vec<String> = refusals.iter().take(MOST_REFUSALS).map(|(.., words)| sentence(words)).collect();
        text += &format!(" It is refused with: {}", sentences.join(" "));
    }
    text
}

/// A refusal of the table as a sentence, with words for names.
fn sentence(words: &str) -> String {
    let mut text = String::new();
    let mut rest = words;
    while let Some((before, after)) = rest.split_once('{') {
        let (name, behind) = after.split_once('}').unwrap_or((after, ""));
        text.push_str(before);
        text.push_str(NAMES.iter().find(|(known, _)| *known == name).map_or(OTHER_NAME, |(_, words)| *words));
        rest = behind;
    }
    text.push_str(rest);
    format!("{}.", capitalized(text.trim_end_matches('.')))
}

fn capitalized(text: &str) -> String {
    let mut letters = text.chars();
    let first: String = letters.next().map(|first| first.to_uppercase().collect()).unwrap_or_default();
    first + letters.as_str()
}

#[cfg(test)]
mod tests {
    use cohabit_cdf::Catalog;

    use super::*;

    #[test]
    fn every_action_of_the_table_is_a_tool_that_says_what_it_does() {
        let catalog = Catalog::builtin();
        let tools = tools(catalog.table());
        assert_eq!(tools.len(), 3 + ActionKind::ALL.len());
        for tool in &tools {
            assert!(tool.description.ends_with('.') && !tool.description.contains('{'), "{tool:?}");
        }
        let described = |name: &str| {
            let tool = tools.iter().find(|tool| tool.deed.name() == name).unwrap();
            tool.description.as_str()
        };
        assert!(described("move").contains("in metres") && described("turn").contains("in radians"));
        assert!(described("pick_up").starts_with("Take an object into the empty hand. People say `"));
        assert!(described("pick_up").contains("`grab`"), "{}", described("pick_up"));
        let refusal = " It is refused with: The object is in a hand. I find no way to the object.";
        assert!(described("go_to").contains(refusal), "{}", described("go_to"));
        // What an action needs of its own is not crowded out by what all need.
        for (name, need) in [
            ("break", "I have to hold the hammer"),
            ("break", "I have to hold the knife"),
            ("fill", "it has to be turned on first"),
            ("clean", "it has to be turned on first"),
            ("toggle", "The object has no power"),
            ("pick_up", "The object is too far away"),
        ] {
            assert!(described(name).contains(need), "{name}: {}", described(name));
        }
        assert!(described("throw").starts_with("Throw what is held at an object"), "{}", described("throw"));
        assert!(described("scan").starts_with("Scan an object, with the hand or with what it holds."));
    }

    #[test]
    fn sentences_have_words_for_names() {
        for (words, expected) in [
            ("{it} is no longer there", "The object is no longer there."),
            ("{held} cannot go into {cover}.", "What is held cannot go into what covers it."),
            ("the {fluid} is gone", "The it is gone."),
            ("my hand is empty", "My hand is empty."),
            ("", "."),
        ] {
            assert_eq!(sentence(words), expected, "{words}");
        }
    }
}
