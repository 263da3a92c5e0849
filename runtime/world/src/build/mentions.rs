//! The objects that a mission names anywhere, without asking for them.

use cohabit_cdf::{
    Expression, GoalState, InstancePattern, Mission, Occasion, Predicate,
    mission::{CameraView, MessageTime},
};

/// All instance ids that are named, wildcards left out, in the order of the mission; with what a machine makes, the
/// machine.
pub(super) fn mentions(mission: &Mission) -> Vec<String> {
    let mut names = Names(Vec::new());
    for request in &mission.objects {
        names.0.extend(request.inside.clone());
        request.condition.iter().for_each(|occasion| names.occasion(occasion));
    }
    for goal in &mission.goals {
        goal.states.iter().for_each(|state| names.state(state));
        names.0.extend(goal.unlocked_by.clone());
    }
    for condition in &mission.conditions {
        names.0.push(condition.context.clone());
        names.expression(&condition.expression);
    }
    let times = mission.messages.iter().map(|message| &message.when);
    for when in times.chain(mission.camera_movements.iter().map(|movement| &movement.when)) {
        if let MessageTime::Occasion(occasion) = when {
            names.occasion(occasion);
        }
    }
    for movement in &mission.camera_movements {
        if let CameraView::Object(pattern) = &movement.view {
            names.pattern(pattern);
        }
    }
    names.0
}

struct Names(Vec<String>);

impl Names {
    fn pattern(&mut self, pattern: &InstancePattern) {
        match pattern.0.split_once("_Spawned_") {
            Some((machine, _)) => self.0.push(machine.to_owned()),
            None if pattern.is_wildcard() => {}
            None => self.0.push(pattern.0.clone()),
        }
    }

    fn state(&mut self, state: &GoalState) {
        self.pattern(&state.instance);
        if let Predicate::Contains(contained) = &state.predicate {
            self.pattern(contained);
        }
    }

    fn occasion(&mut self, occasion: &Occasion) {
        match occasion {
            Occasion::States(states, _) => states.iter().for_each(|state| self.state(state)),
            Occasion::Expression(expression) => self.expression(expression),
        }
    }

    fn expression(&mut self, expression: &Expression) {
        expression.for_each_named(&mut |pattern| self.pattern(pattern));
    }
}
