//! Steps of a session as people read them.

use std::fmt::Write as _;

use cohabit_cdf::{Action, Status};
use cohabit_eval::steps::{Did, Referent, Said, Step, Understood};

use crate::session_time::SessionTime;

/// The most readings and things that are told of what was said; JSON has all.
const MOST: usize = 4;

/// All of a step, several lines.
pub fn block(step: &Step) -> String {
    let mut text = format!("{:>4}  {}  {}\n", step.step, SessionTime { tick: step.tick }, brief(step));
    let mut note = |line: String| {
        let _ = writeln!(text, "          {line}");
    };
    if let Some(said) = &step.said {
        said.understood.iter().flat_map(understood).chain(answered(said)).for_each(&mut note);
    }
    if let Some(did) = &step.did {
        ended(did).into_iter().for_each(&mut note);
    }
    for goal in &step.goals_met {
        note(format!("goal {} met: {}", goal.number, goal.description));
    }
    text
}

/// What differs between two sessions from a step on: `-` is the first, `+` the second, and what is the same has neither.
pub fn difference(before: &[Step], after: &[Step]) -> String {
    let line = |steps: &[Step], at: usize| steps.get(at).map(with_end);
    let mut text = String::new();
    for at in 0..before.len().max(after.len()) {
        let (one, other) = (line(before, at), line(after, at));
        if one == other {
            text.extend(one.map(|line| format!("  {line}\n")));
        } else {
            text.extend(one.map(|line| format!("- {line}\n")));
            text.extend(other.map(|line| format!("+ {line}\n")));
        }
    }
    text
}

/// What was said or done.
fn brief(step: &Step) -> String {
    let said = step.said.iter().map(|said| format!("to body {}: \"{}\"", step.body, said.text));
    let did = step.did.iter().map(|did| format!("body {}: {}", step.body, command(did)));
    said.chain(did).collect()
}

/// The same in one line with what came of it.
fn with_end(step: &Step) -> String {
    let ended: Option<Status> = match (&step.said, &step.did) {
        (Some(said), _) => said.ended,
        (None, Some(did)) => did.outcome.as_ref().map(|outcome| outcome.status),
        (None, None) => None,
    };
    let goals: String = step.goals_met.iter().map(|goal| format!("; goal {} met", goal.number)).collect();
    let ended = ended.map_or_else(String::new, |status| format!(": {status:?}"));
    format!("{:>4}  {}{ended}{goals}", step.step, brief(step))
}

/// A command: what it does to what, or as it is written for `--instead`.
fn command(did: &Did) -> String {
    let whole = format!("{:?}", did.action);
    let name = match did.action {
        Action::Interact { verb, .. } => format!("{verb:?}"),
        _ => whole.split(' ').next().unwrap_or_default().to_owned(),
    };
    match &did.target {
        Some(target) => format!("{name} {} in {}", target.instance, target.room),
        None => serde_json::to_string(&did.action).unwrap_or(whole),
    }
}

fn understood(understood: &Understood) -> Vec<String> {
    let Understood { meaning, sureness, readings, referents, as_recorded } = understood;
    let mut lines = vec![format!("understood: {meaning} ({sureness:.2} sure)")];
    for reading in readings.iter().take(MOST) {
        lines.push(format!("  {:.2} {} \"{}\": {}", reading.probability, reading.by, reading.text, reading.meaning));
    }
    let named = |one: &Referent| format!("{:.2} {}", one.probability, one.name);
    let meant: Vec<String> = referents.iter().take(MOST).map(named).collect();
    if !meant.is_empty() {
        lines.push(format!("  meant: {}", meant.join(", ")));
    }
    if !as_recorded {
        lines.push("  the log has another plan than follows from this".to_owned());
    }
    lines
}

fn answered(said: &Said) -> Vec<String> {
    let replies = said.replies.iter().map(|reply| format!("says: {reply}"));
    let questions = said.questions.iter().map(|question| format!("asks: {question}"));
    let ended = said.ended.map(|status| format!("{} steps planned, ended: {status:?}", said.plan.len()));
    replies.chain(questions).chain(ended).collect()
}

fn ended(did: &Did) -> Vec<String> {
    let mask = did.target.as_ref().and_then(|target| target.mask);
    let mask = mask.map(|mask| format!("its mask: {} pixels, in {:?}", mask.pixels, mask.r#box));
    let outcome = did.outcome.as_ref().map(|outcome| {
        let detail = if outcome.detail.is_empty() { String::new() } else { format!(": {}", outcome.detail) };
        format!("{:?} after {:.1} s{detail}", outcome.status, outcome.duration_s)
    });
    mask.into_iter().chain(outcome).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(step: usize, text: &str) -> Step {
        Step { step, said: Some(Said { text: text.to_owned(), ..Said::default() }), ..Step::default() }
    }

    #[test]
    fn what_is_the_same_in_two_sessions_is_told_once() {
        let [before, after] = ["pick up the bowl", "pick up the box"].map(|text| [said(4, text), said(5, "stop")]);
        let text = difference(&before, &after[..]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(
            lines,
            [
                "-    4  to body 0: \"pick up the bowl\"",
                "+    4  to body 0: \"pick up the box\"",
                "     5  to body 0: \"stop\""
            ]
        );
        assert_eq!(difference(&before[..1], &[]), "-    4  to body 0: \"pick up the bowl\"\n");
    }

    #[test]
    fn a_step_is_told_with_what_came_of_it() {
        let did = Did { command: 1, action: Action::Stop, target: None, outcome: None };
        let step = Step { step: 2, tick: 90, did: Some(did), ..Step::default() };
        assert_eq!(block(&step), "   2  0:01.5  body 0: \"Stop\"\n");
    }
}
