//! The table of what wizards decided (Wizard of Oz).

use cohabit_record::{DialogEntry, WizardDecision};

use crate::{
    played::{Played, seconds},
    table::{
        Cell, Field,
        Kind::{Flag, Real, Text, Whole},
        Table,
    },
};

const FIELDS: [Field; 26] = [
    Field::new("session", Text, "", "the session, as in the table of sessions"),
    Field::new("turn", Whole, "", "the turn that was answered; of what was unprompted, the one before"),
    Field::new("body", Whole, "", "the robot's body"),
    Field::new("tick", Whole, "", "the newest tick when it took effect"),
    Field::new("time_s", Real, "s", "simulated time when it took effect"),
    Field::new(
        "outcome",
        Text,
        "",
        "accepted, edited, replaced, dismissed, timed_out (the robot did what it had proposed), stopped (the person said stop \
         first), unprompted, or undecided (the session ended first)",
    ),
    Field::new("intervention", Flag, "", "whether the robot did something else than it would have done by itself"),
    Field::new("late", Flag, "", "whether the time-out passed before the wizard had decided"),
    Field::new("said", Text, "", "what the person said"),
    Field::new("proposed", Text, "", "what the robot proposed: a plan, a question, an answer, a refusal or a stop"),
    Field::new("proposed_steps", Text, "", "the steps of the plan that it proposed, line by line"),
    Field::new("proposed_reply", Text, "", "what it would have said"),
    Field::new("edits", Text, "", "what the wizard had understood in place of what was said, line by line"),
    Field::new("edit_count", Whole, "", "how often they edited it"),
    Field::new("spoke", Text, "", "what the wizard had the robot say"),
    Field::new("phrase", Text, "", "the key of the canned phrase that this was"),
    Field::new("ordered", Text, "", "what the wizard had the robot do, as a plain request"),
    Field::new(
        "clicked",
        Text,
        "",
        "what the wizard clicked: point, look, go_to_room, go_to_point, turn, move, or what was done to the object",
    ),
    Field::new("object", Whole, "", "the object that was clicked"),
    Field::new("expression", Text, "", "what the wizard had the robot's face show"),
    Field::new("injected", Flag, "", "whether the wizard injected a planned error"),
    Field::new("planned_error", Text, "", "its name"),
    Field::new("chosen_ms", Real, "ms", "wall time from the click on a thing to the choice of what is done with it"),
    Field::new("decided_ms", Real, "ms", "wall time from the proposal to the wizard's decision"),
    Field::new("answered_ms", Real, "ms", "wall time from the words to the robot's answer"),
    Field::new("simulated", Flag, "", "whether a program played the session, so that no wizard decided it"),
];

/// All decisions of these sessions.
pub fn table(played: &[Played]) -> Table {
    let of_one = |played: &Played| -> Vec<Vec<Cell>> {
        let entries = played.log.dialog.iter();
        entries.filter_map(|entry| Some(row(played, entry, &WizardDecision::of(entry)?))).collect()
    };
    Table {
        name: "decisions",
        meaning: "something that a wizard decided",
        fields: FIELDS.into(),
        rows: played.iter().flat_map(of_one).collect(),
    }
}

fn row(played: &Played, entry: &DialogEntry, decision: &WizardDecision) -> Vec<Cell> {
    let proposed = decision.proposed.clone().unwrap_or_default();
    vec![
        Cell::text(&played.name),
        Cell::whole(entry.turn),
        Cell::whole(entry.body),
        Cell::whole(entry.tick),
        Cell::Real(seconds(entry.tick)),
        Cell::text(decision.outcome.name()),
        Cell::Flag(decision.outcome.is_intervention()),
        Cell::Flag(decision.is_late),
        Cell::text(&decision.said),
        Cell::text(&proposed.kind),
        Cell::text(proposed.steps.join("\n")),
        Cell::text(&proposed.reply),
        Cell::text(decision.edits.join("\n")),
        Cell::whole(decision.edits.len()),
        Cell::text(&decision.spoke),
        Cell::maybe(decision.phrase, |key| Cell::text(key.to_string())),
        Cell::text(&decision.ordered),
        Cell::text(decision.clicked.as_deref().unwrap_or_default()),
        Cell::maybe(decision.object, Cell::whole),
        Cell::text(decision.expression.as_deref().unwrap_or_default()),
        Cell::Flag(decision.injected.is_some()),
        Cell::text(decision.injected.as_deref().unwrap_or_default()),
        Cell::maybe(decision.chosen_ms, Cell::Real),
        Cell::maybe(decision.decided_ms, Cell::Real),
        Cell::maybe(decision.answered_ms, Cell::Real),
        Cell::Flag(decision.synthetic),
    ]
}
