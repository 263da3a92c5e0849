//! What a participant does in a session, as its bus tells it: for tutorials.

use cohabit_bus::message::{CommandMessage, DialogKind, PlanStep};
use cohabit_cdf::Action;
use cohabit_study::Activity;

/// What a participant has done in a session since it was last taken.
#[derive(Debug, Default)]
pub struct Activities {
    new: Vec<Activity>,
    /// Whether the last that the robot said is a question.
    is_asked: bool,
}

impl Activities {
    /// Takes in a message of the conversation, which may be a plan that stops the robot.
    pub fn hear(&mut self, kind: DialogKind, stops: bool) {
        match kind {
            DialogKind::Utterance => {
                self.note(Activity::Say);
                if std::mem::take(&mut self.is_asked) {
                    self.note(Activity::Answer);
                }
            }
            DialogKind::Question => self.is_asked = true,
            DialogKind::Reply => self.is_asked = false,
            DialogKind::Plan if stops => self.note(Activity::Stop),
            DialogKind::Pointed => self.note(Activity::Point),
            _ => {}
        }
    }

    /// Takes in that something was done.
    pub fn note(&mut self, activity: Activity) {
        if !self.new.contains(&activity) {
            self.new.push(activity);
        }
    }

    /// What is new since this was last asked, each once.
    pub fn take(&mut self) -> Vec<Activity> {
        std::mem::take(&mut self.new)
    }
}

/// Whether a plan stops the robot.
pub fn stops(steps: &[PlanStep]) -> bool {
    steps.iter().any(|step| matches!(Action::try_from(step.action), Ok(Action::Stop)))
}

/// What somebody does who drives a body by these commands.
pub fn of_inputs(inputs: &[CommandMessage]) -> Vec<Activity> {
    let of_one = |input: &CommandMessage| match Action::try_from(input.action) {
        Ok(Action::Drive { forward_m_s, turn_rad_s, pitch_rad_s }) => [
            (forward_m_s != 0.0).then_some(Activity::Move),
            (turn_rad_s != 0.0 || pitch_rad_s != 0.0).then_some(Activity::Look),
        ],
        _ => [None, None],
    };
    inputs.iter().flat_map(of_one).flatten().collect()
}

#[cfg(test)]
mod tests {
    use cohabit_bus::message::DialogKind::{Plan, Pointed, Question, Reply, StepEnded, Utterance};

    use super::*;

    #[test]
    fn an_answer_is_what_is_said_to_a_question() {
        let check = |kinds: &[DialogKind], expected: &[Activity]| {
            let mut activities = Activities::default();
            kinds.iter().for_each(|kind| activities.hear(*kind, true));
            assert_eq!(activities.take(), expected, "{kinds:?}");
            assert_eq!(activities.take(), []);
        };
        check(&[Utterance, Reply, Utterance], &[Activity::Say]);
        check(&[Utterance, Question, Plan, StepEnded, Utterance], &[Activity::Say, Activity::Stop, Activity::Answer]);
        check(&[Question, Reply, Utterance], &[Activity::Say]);
        check(&[Pointed, Pointed], &[Activity::Point]);
        check(&[Question, StepEnded], &[]);
    }

    #[test]
    fn held_keys_move_a_body_or_turn_it() {
        let drive = |forward_m_s: f32, turn_rad_s: f32, pitch_rad_s: f32| {
            CommandMessage::act(1, 0, 1, Action::Drive { forward_m_s, turn_rad_s, pitch_rad_s })
        };
        assert_eq!(of_inputs(&[drive(0.0, 0.0, 0.0), CommandMessage::act(2, 1, 0, Action::Stop)]), []);
        assert_eq!(of_inputs(&[drive(1.0, 0.0, 0.0)]), [Activity::Move]);
        let all = [drive(-1.0, 0.0, 0.2), drive(0.0, 1.0, 0.0)];
        assert_eq!(of_inputs(&all), [Activity::Move, Activity::Look, Activity::Look]);
    }
}
