//! The world of a session stands still for as long as its study wants it to.

use std::time::{Duration, Instant};

use cohabit_bus::{
    BusError, Inbox, Publisher, Sample, Topic, Transport,
    message::{Control, ControlMessage, StateView},
};

/// So long the world may take to do what it was asked for, before it is asked again.
const ASK_AGAIN: Duration = Duration::from_secs(1);

/// Asks the world for it, and sees whether it is so.
pub struct Pausing {
    states: Inbox,
    /// Kept as long as the session: what is sent is lost with its publisher, if the simulator has not noticed that one yet.
    controls: Box<dyn Publisher>,
    /// Whether the world stands still, as it says.
    stands_still: bool,
    /// Whether it was ever asked to: one that stands still for another reason is left alone.
    was_asked: bool,
    asked_at: Option<Instant>,
}

impl Pausing {
    /// Of the session on that bus.
    pub fn new(bus: &dyn Transport) -> Result<Self, BusError> {
        Ok(Self {
            states: Inbox::new(bus, Topic::State)?,
            controls: bus.publisher(Topic::Control)?,
            stands_still: false,
            was_asked: false,
            asked_at: None,
        })
    }

    /// Has the world stand still, or go on; to be called again and again, since nobody answers.
    pub fn keep(&mut self, stands_still: bool) -> Result<(), BusError> {
        let is_paused = |sample: &Sample| Ok(StateView::new(sample.payload())?.header.paused == 1);
        if let Some((_, paused)) = self.states.latest(is_paused)? {
            self.stands_still = paused;
        }
        let is_anothers = !stands_still && !self.was_asked;
        let is_asked = self.asked_at.is_some_and(|at| at.elapsed() < ASK_AGAIN);
        if self.stands_still == stands_still || is_anothers || is_asked {
            return Ok(());
        }
        let control = if stands_still { Control::Pause } else { Control::Resume };
        self.controls.send_record(0, &ControlMessage::from(control))?;
        self.was_asked |= stands_still;
        self.asked_at = Some(Instant::now());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use cohabit_bus::{Local, message};

    use super::*;

    #[test]
    fn a_world_that_nobody_asked_to_stand_still_is_left_alone() {
        let bus = Local::new(1);
        let mut controls = Inbox::new(&bus, Topic::Control).expect("an inbox");
        let mut heard = || {
            let read = |sample: &Sample| message::read::<ControlMessage>(sample.payload());
            let found = controls.next(read).expect("a bus");
            found.map(|(_, control)| Control::try_from(control).expect("a control"))
        };
        let mut pausing = Pausing::new(&bus).expect("a publisher");
        pausing.keep(false).expect("a bus");
        assert_eq!(heard(), None);
        pausing.keep(true).expect("a bus");
        assert_eq!(heard(), Some(Control::Pause));
        // It is not asked over and over, and asked again when it does not.
        pausing.keep(true).expect("a bus");
        assert_eq!(heard(), None);
        pausing.asked_at = None;
        pausing.keep(true).expect("a bus");
        assert_eq!(heard(), Some(Control::Pause));
        (pausing.stands_still, pausing.asked_at) = (true, None);
        pausing.keep(false).expect("a bus");
        assert_eq!(heard(), Some(Control::Resume));
    }
}
