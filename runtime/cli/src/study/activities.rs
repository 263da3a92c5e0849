//! What participants do in a session, as its bus tells it: for tutorials.

use cohabit_bus::message::{CommandMessage, DialogKind, PlanStep};
use cohabit_cdf::Action;
use cohabit_study::Activity;

/// What participants have done in a session since it was last taken, each at their seat; of one without seats, at the only one.
#[derive(Debug)]
pub struct Activities {
    seats: Vec<Seat>,
    /// Whether there are seats, by which people are told apart.
    has_seats: bool,
    /// Whether the last that the robot said is a question.
    is_asked: bool,
    /// Who said something last: what is planned follows from that.
    said_by: Doer,
}

#[derive(Debug, Default)]
struct Seat {
    new: Vec<Activity>,
    /// The avatar that is driven from it.
    body: Option<u32>,
}

/// Who does something.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Doer {
    /// Whoever's page has a number, from 1: that of their seat.
    Page(u32),
    /// Whoever drives a body.
    Body(u32),
    /// All who take part.
    All,
}

impl Doer {
    /// Whoever's page has that number; 0 is nobody's in particular.
    pub const fn at_page(number: u32) -> Self {
        if number == 0 { Self::All } else { Self::Page(number) }
    }
}

impl Activities {
    /// Of a session with so many seats; 0 if it has none, and all pages are the participant's.
    pub fn new(seats: usize) -> Self {
        let all = std::iter::repeat_with(Seat::default).take(seats.max(1)).collect();
        Self { seats: all, has_seats: seats > 0, is_asked: false, said_by: Doer::All }
    }

    /// A seat's number, from 1, and the avatar that is driven from it.
    pub fn seat(&mut self, number: usize, body: u32) {
        if let Some(seat) = number.checked_sub(1).and_then(|at| self.seats.get_mut(at)) {
            seat.body = Some(body);
        }
    }

    /// Takes in a message of the conversation, which may be a plan that stops the robot.
    pub fn hear(&mut self, kind: DialogKind, doer: Doer, stops: bool) {
        match kind {
            DialogKind::Utterance => {
                self.said_by = doer;
                self.note(doer, Activity::Say);
                if std::mem::take(&mut self.is_asked) {
                    self.note(doer, Activity::Answer);
                }
            }
            DialogKind::Question => self.is_asked = true,
            DialogKind::Reply => self.is_asked = false,
            DialogKind::Plan if stops => self.note(self.said_by, Activity::Stop),
            DialogKind::Pointed => self.note(doer, Activity::Point),
            _ => {}
        }
    }

    /// Takes in that something was done.
    pub fn note(&mut self, doer: Doer, activity: Activity) {
        let has_seats = self.has_seats;
        for (number, seat) in (1..).zip(&mut self.seats) {
            let is_theirs = match doer {
                Doer::Page(page) => page == number,
                Doer::Body(body) => seat.body == Some(body),
                Doer::All => true,
            };
            if (is_theirs || !has_seats) && !seat.new.contains(&activity) {
                seat.new.push(activity);
            }
        }
    }

    /// What is new at a seat, from 0, since this was last asked, each once.
    pub fn take(&mut self, seat: usize) -> Vec<Activity> {
        self.seats.get_mut(seat).map(|seat| std::mem::take(&mut seat.new)).unwrap_or_default()
    }
}

/// Whether a plan stops the robot.
pub fn stops(steps: &[PlanStep]) -> bool {
    steps.iter().any(|step| matches!(Action::try_from(step.action), Ok(Action::Stop)))
}

/// What people do who drive bodies by these commands.
pub fn of_inputs(inputs: &[CommandMessage]) -> Vec<(Doer, Activity)> {
    let of_one = |input: &CommandMessage| match Action::try_from(input.action) {
        Ok(Action::Drive { forward_m_s, turn_rad_s, pitch_rad_s }) => [
            (forward_m_s != 0.0).then_some(Activity::Move),
            (turn_rad_s != 0.0 || pitch_rad_s != 0.0).then_some(Activity::Look),
        ],
        _ => [None, None],
    };
    let by_body = |input: &CommandMessage| {
        let body = input.body;
        of_one(input).into_iter().flatten().map(move |activity| (Doer::Body(body), activity))
    };
    inputs.iter().flat_map(by_body).collect()
}

#[cfg(test)]
mod tests {
    use cohabit_bus::message::DialogKind::{Plan, Pointed, Question, Reply, StepEnded, Utterance};

    use super::*;

    fn drive(body: u32, forward_m_s: f32, turn_rad_s: f32, pitch_rad_s: f32) -> CommandMessage {
        CommandMessage::act(1, 0, body, Action::Drive { forward_m_s, turn_rad_s, pitch_rad_s })
    }

    #[test]
    fn an_answer_is_what_is_said_to_a_question() {
        let check = |kinds: &[DialogKind], expected: &[Activity]| {
            let mut activities = Activities::new(0);
            kinds.iter().for_each(|kind| activities.hear(*kind, Doer::at_page(7), true));
            assert_eq!(activities.take(0), expected, "{kinds:?}");
            assert_eq!(activities.take(0), []);
        };
        check(&[Utterance, Reply, Utterance], &[Activity::Say]);
        check(&[Utterance, Question, Plan, StepEnded, Utterance], &[Activity::Say, Activity::Stop, Activity::Answer]);
        check(&[Question, Reply, Utterance], &[Activity::Say]);
        check(&[Pointed, Pointed], &[Activity::Point]);
        check(&[Question, StepEnded], &[]);
    }

    #[test]
    fn held_keys_move_a_body_or_turn_it() {
        let check = |inputs: &[CommandMessage], expected: &[Activity]| {
            let mut activities = Activities::new(0);
            of_inputs(inputs).into_iter().for_each(|(doer, activity)| activities.note(doer, activity));
            assert_eq!(activities.take(0), expected, "{inputs:?}");
        };
        check(&[drive(1, 0.0, 0.0, 0.0), CommandMessage::act(2, 1, 0, Action::Stop)], &[]);
        check(&[drive(1, 1.0, 0.0, 0.0)], &[Activity::Move]);
        check(&[drive(1, -1.0, 0.0, 0.2), drive(1, 0.0, 1.0, 0.0)], &[Activity::Move, Activity::Look]);
    }

    #[test]
    fn what_one_of_two_does_is_theirs_and_a_goal_is_both_theirs() {
        let mut activities = Activities::new(2);
        activities.seat(1, 4);
        activities.seat(2, 5);
        activities.hear(Utterance, Doer::at_page(2), false);
        activities.hear(Plan, Doer::All, true);
        // Whoever has no seat looks on.
        activities.hear(Pointed, Doer::at_page(3), false);
        let driven = of_inputs(&[drive(4, 1.0, 0.0, 0.0), drive(0, 1.0, 1.0, 0.0)]);
        driven.into_iter().for_each(|(doer, activity)| activities.note(doer, activity));
        activities.note(Doer::All, Activity::Goal);
        assert_eq!(activities.take(0), [Activity::Move, Activity::Goal]);
        assert_eq!(
            (activities.take(1), activities.take(1)),
            (vec![Activity::Say, Activity::Stop, Activity::Goal], Vec::new())
        );
    }
}
