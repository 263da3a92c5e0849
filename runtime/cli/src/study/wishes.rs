//! What a simulated person asks the robot for: the goals of their mission, one after the other, in their own words where these are
//! known, or else as the mission has them.

use cohabit_cdf::{
    Catalog, Color, Fluid, Mission, StateFlag,
    goal::{Expression, GoalState, Predicate},
};
use cohabit_eval::{Line, Meaning};
use cohabit_tables::Chance;

/// How often somebody asks for each goal: what was not understood, or not done, is asked for once more.
const ROUNDS: usize = 2;
/// What somebody says when the robot asks whether, or which, or how, and they only read out their goals: as often as it asks.
const ANSWER: &str = "yes";
/// So often they answer.
const ANSWERS: usize = 4;

/// What they say in a mission, `own_words` being the share of goals that are asked for in their own words at first.
pub fn wishes(mission: &Mission, catalog: &Catalog, own_words: f64, drawn: &mut Chance) -> Vec<Line> {
    let mut lines = Vec::new();
    for round in 0..ROUNDS {
        for goal in &mission.goals {
            let is_own = drawn.is(own_words) == (round == 0);
            let meant: Vec<Meaning> = goal.states.iter().flat_map(|state| meant(state, mission, catalog)).collect();
            let text = if goal.description.trim().is_empty() { &mission.goal_text } else { &goal.description };
            if !meant.is_empty() && (is_own || text.trim().is_empty()) {
                lines.extend(meant.into_iter().map(Line::Meant));
            } else if !text.trim().is_empty() {
                lines.push(read_out(text));
            }
        }
    }
    lines
}

fn read_out(text: &str) -> Line {
    let answers = vec![serde_json::json!({ "question": "", "text": ANSWER }); ANSWERS];
    let line = serde_json::json!({ "Utterance": { "text": text, "answers": answers } });
    serde_json::from_value(line).unwrap_or_else(|_| Line::utterance(text))
}

/// What somebody wants who wants that state, if it can be said.
fn meant(state: &GoalState, mission: &Mission, catalog: &Catalog) -> Vec<Meaning> {
    if state.instance.is_wildcard() {
        return Vec::new();
    }
    let object = state.instance.0.clone();
    let one = match &state.predicate {
        Predicate::Flag(StateFlag::PickedUp, true) => Meaning::PickUp { object },
        Predicate::Flag(StateFlag::Toggled, true) => Meaning::TurnOn { device: object },
        Predicate::Flag(StateFlag::Broken, true) => Meaning::Break { object },
        Predicate::Flag(StateFlag::Broken, false) => Meaning::Repair { object },
        Predicate::Flag(StateFlag::Dirty, false) => Meaning::Clean { object },
        Predicate::Flag(StateFlag::Hot, true) => Meaning::Heat { object },
        Predicate::Flag(StateFlag::Cold, true) => Meaning::Cool { object },
        Predicate::Flag(StateFlag::Scanned, true) => Meaning::Scan { object },
        Predicate::Filled(Fluid::Water) => Meaning::Fill { object },
        Predicate::Color(color) => Meaning::Color { object, color: *color },
        Predicate::Contains(thing) if !thing.is_wildcard() => into(&thing.0, &object, catalog),
        Predicate::Condition(name, true) => return of_color(name, &object, mission).into_iter().collect(),
        _ => return Vec::new(),
    };
    vec![one]
}

/// To have a thing on something, or in the machine that needs it.
fn into(thing: &str, place: &str, catalog: &Catalog) -> Meaning {
    let class = catalog.class_of_instance(place).map(|id| catalog.class(id));
    let is_machine = class.and_then(|class| class.receptacle.as_ref()).is_some_and(|takes| !takes.keys.is_empty());
    let object = thing.to_owned();
    if is_machine {
        Meaning::Insert { object, device: place.to_owned() }
    } else {
        Meaning::Place { object, receptacle: place.to_owned() }
    }
}

/// A condition that says nothing but a colour.
fn of_color(name: &str, context: &str, mission: &Mission) -> Option<Meaning> {
    match &mission.condition(name, context)?.expression {
        Expression::HasColor { target, color, .. } if !target.is_wildcard() => {
            let color: Color = *color;
            Some(Meaning::Color { object: target.0.clone(), color })
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use cohabit_engine::SessionPlan;

    use super::*;
    use crate::mission_file::MissionFile;

    fn lines(mission: &str, own_words: f64) -> Vec<String> {
        let (file, catalog) = (MissionFile::find(Some(mission)).expect("a mission"), Arc::new(Catalog::builtin()));
        let plan = SessionPlan::new(&file.name, &file.text, Arc::clone(&catalog), 0).expect("a plan");
        let wishes = wishes(&plan.mission, &catalog, own_words, &mut Chance::new(1, 0));
        wishes
            .iter()
            .map(|line| format!("{}: {line}", if matches!(line, Line::Meant(_)) { "own" } else { "read" }))
            .collect()
    }

    #[test]
    fn goals_are_asked_for_in_own_words_or_as_they_stand() {
        let own = lines("laser_lab", 1.0);
        assert_eq!(own[0], "own: put Laser_ControlPanel_1 in Laser_1");
        assert_eq!(own[3], "read: Put the control panel into the laser", "what was not done is said otherwise");
        assert!(lines("laser_lab", 0.0)[..3].iter().all(|line| line.starts_with("read: ")));
        // What is in the bowl has no words of its own.
        assert!(lines("make_cereal", 1.0).contains(&"read: Pour cereal into the mended bowl".to_owned()));
    }
}
