//! The steps of a session as its log has them.

use cohabit_engine::replay::TICK_S;
use cohabit_tables::{Deed, Played, Turn};

use super::{Did, Goal, Outcome, Said, Step};

/// The steps of a session, as far as they are known without going through it.
#[must_use]
pub fn listed(played: &Played) -> Vec<Step> {
    let said = played.turns().iter().map(said);
    let did = played.actions().iter().map(did);
    let mut steps: Vec<Step> = said.chain(did).collect();
    // What is said stands before what is done at the same moment.
    steps.sort_by_key(|step| step.tick);
    for (number, step) in (1..).zip(&mut steps) {
        step.step = number;
        step.time_s = step.tick as f64 * TICK_S;
    }
    note_goals(played, &mut steps);
    steps
}

fn said(turn: &Turn) -> Step {
    let said = Said {
        person: turn.person,
        text: turn.said.clone(),
        heard: turn.heard.clone(),
        understood: None,
        replies: turn.replies.clone(),
        questions: turn.questions.clone(),
        plan: turn.plan.clone(),
        ended: turn.ended,
    };
    Step { tick: turn.tick, turn: Some(turn.number), body: turn.body, said: Some(said), ..Step::default() }
}

fn did(deed: &Deed) -> Step {
    let outcome = deed.outcome.as_ref().map(|(tick, status, detail)| Outcome {
        status: *status,
        success: status.is_success(),
        detail: detail.clone(),
        tick: *tick,
        duration_s: tick.saturating_sub(deed.began) as f64 * TICK_S,
    });
    let did = Did { command: deed.number, action: deed.action, target: None, outcome };
    let turn = (deed.turn != 0).then_some(deed.turn);
    Step { tick: deed.began.saturating_sub(1), turn, body: deed.body, did: Some(did), ..Step::default() }
}

/// A goal is met by what was done last, or said last, if nothing was done.
fn note_goals(played: &Played, steps: &mut [Step]) {
    for event in played.log().events.iter().filter(|event| event.kind == "GoalMet") {
        let is_before = |step: &Step| step.tick < event.tick;
        let done = steps.iter().rposition(|step| step.did.is_some() && is_before(step));
        let Some(at) = done.or_else(|| steps.iter().rposition(is_before)) else { continue };
        let number = event.goal.unwrap_or_default();
        steps[at].goals_met.push(Goal { number, description: event.text.clone(), tick: event.tick });
    }
}
