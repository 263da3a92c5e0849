//! What a simulated person asks the robot for: the goals of their mission, one after the other, in their own words where these are
//! known, or else as the mission has them.

use cohabit_cdf::{Catalog, Mission};
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
            let meant: Vec<Meaning> =
                goal.states.iter().filter_map(|state| Meaning::of_goal(state, mission, catalog)).collect();
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

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use cohabit_cdf::WorldData;
    use cohabit_engine::SessionPlan;

    use super::*;
    use crate::mission_file::MissionFile;

    fn lines(mission: &str, own_words: f64) -> Vec<String> {
        let world = WorldData::builtin();
        let file = MissionFile::find_in(Some(mission), &world).expect("a mission");
        let plan = SessionPlan::new(&file.name, &file.text, Arc::clone(world.catalog()), 0).expect("a plan");
        let wishes = wishes(&plan.mission, world.catalog(), own_words, &mut Chance::new(1, 0));
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
