//! What kind of task a mission is, by what its goals ask for.

use std::collections::BTreeSet;

use cohabit_cdf::{
    Mission, StateFlag,
    goal::{Expression, Predicate},
};

/// Words for what goals ask for, in the order in which a family names them.
const WORDS: &[(Asked, &str)] = &[
    (Asked::Flag(StateFlag::PickedUp, true), "pickup"),
    (Asked::Flag(StateFlag::Toggled, true), "toggle"),
    (Asked::Flag(StateFlag::Toggled, false), "toggle"),
    (Asked::Flag(StateFlag::Used, true), "use"),
    (Asked::Flag(StateFlag::Powered, true), "power"),
    (Asked::Flag(StateFlag::Powered, false), "power"),
    (Asked::Flag(StateFlag::Opened, true), "open"),
    (Asked::Flag(StateFlag::Opened, false), "close"),
    (Asked::Flag(StateFlag::Broken, true), "break"),
    (Asked::Flag(StateFlag::Broken, false), "repair"),
    (Asked::Flag(StateFlag::Eaten, false), "repair"),
    (Asked::Flag(StateFlag::Dirty, false), "clean"),
    (Asked::Flag(StateFlag::Hot, true), "heat"),
    (Asked::Flag(StateFlag::Cold, true), "freeze"),
    (Asked::Flag(StateFlag::Cooked, true), "cook"),
    (Asked::Flag(StateFlag::Cut, true), "cut"),
    (Asked::Flag(StateFlag::Infected, true), "infect"),
    (Asked::Flag(StateFlag::Infected, false), "disinfect"),
    (Asked::Flag(StateFlag::Embiggenated, true), "embiggen"),
    (Asked::Flag(StateFlag::Scanned, true), "scan"),
    (Asked::Flag(StateFlag::Examined, true), "examine"),
    (Asked::Fill, "fill"),
    (Asked::Color, "color"),
    (Asked::Feed, "feed"),
    (Asked::See, "find"),
    (Asked::Deliver, "deliver"),
];

#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
enum Asked {
    Flag(StateFlag, bool),
    Fill,
    Color,
    Feed,
    See,
    Deliver,
}

/// The family of a mission: `clean&deliver`, `pickup`, ….
pub fn family(mission: &Mission) -> String {
    let mut asked = BTreeSet::new();
    for state in mission.goals.iter().flat_map(|goal| &goal.states) {
        match &state.predicate {
            Predicate::Flag(flag, value) => note(&mut asked, Asked::Flag(*flag, *value)),
            Predicate::Filled(_) | Predicate::FilledWithAny => note(&mut asked, Asked::Fill),
            Predicate::Color(_) => note(&mut asked, Asked::Color),
            Predicate::Contains(_) | Predicate::ContainsCereal(_) | Predicate::Empty(_) => {
                note(&mut asked, Asked::Deliver);
            }
            Predicate::Condition(name, value) => {
                if let Some(condition) = mission.condition(name, &state.instance.0) {
                    walk(&condition.expression, *value, &mut asked);
                }
            }
        }
    }
    let mut words: Vec<&str> = WORDS.iter().filter(|(kind, _)| asked.contains(kind)).map(|(_, word)| *word).collect();
    words.dedup();
    if words.is_empty() { "other".to_owned() } else { words.join("&") }
}

fn walk(expression: &Expression, wanted: bool, asked: &mut BTreeSet<Asked>) {
    match expression {
        Expression::And(parts) | Expression::Or(parts) => parts.iter().for_each(|part| walk(part, wanted, asked)),
        Expression::Not(inner) => walk(inner, !wanted, asked),
        Expression::Flag { flag, value, .. } => note(asked, Asked::Flag(*flag, *value == wanted)),
        Expression::FilledWith { .. } | Expression::FilledWithAny { .. } => note(asked, Asked::Fill),
        Expression::HasColor { .. } => note(asked, Asked::Color),
        Expression::DinoFed { .. } => note(asked, Asked::Feed),
        Expression::CanBeSeen { .. } | Expression::InRange { .. } => note(asked, Asked::See),
        Expression::Contains { .. } | Expression::IsReceptacle { .. } | Expression::IsFull { .. } => {
            note(asked, Asked::Deliver);
        }
    }
}

fn note(asked: &mut BTreeSet<Asked>, kind: Asked) {
    asked.insert(kind);
}
