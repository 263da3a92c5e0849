//! In lock-step the world waits for its recorder too, lest it runs ahead of what the bus keeps.

use std::time::Duration;

use cohabit_bus::{
    BusError, Inbox, Publisher, Topic, Transport,
    message::{CommandKind, CommandMessage, NONE, StepView},
};

/// The world goes so far ahead: of what a tick may bring, the bus keeps more.
const TICKS: u64 = 32;
/// The disk may take so long.
const PATIENCE: Duration = Duration::from_secs(5);

/// The turns of a recorder.
pub(crate) struct Turns {
    commands: Box<dyn Publisher>,
    steps: Inbox,
}

impl Turns {
    /// To be had before [`Self::attend`].
    pub fn new(bus: &dyn Transport) -> Result<Self, BusError> {
        Ok(Self { steps: Inbox::new(bus, Topic::Steps)?, commands: bus.publisher(Topic::Commands)? })
    }

    /// Has the world wait from now on.
    pub fn attend(&mut self) -> Result<(), BusError> {
        let nanos = u64::try_from(PATIENCE.as_nanos()).unwrap_or(0);
        self.send(&CommandMessage::new(CommandKind::Attend, NONE).with(nanos))
    }

    /// Whether the world waits now: all that was published so far is to be taken down then.
    pub fn has_come(&mut self) -> Result<bool, BusError> {
        let run = self.commands.run();
        let mut come = false;
        while let Some((_, due)) = self.steps.next(|sample| Ok(StepView::new(sample.payload())?.due.contains(&run)))? {
            come |= due;
        }
        Ok(come)
    }

    /// Has the world go on.
    pub fn end(&mut self) -> Result<(), BusError> {
        self.send(&CommandMessage::new(CommandKind::Ready, NONE).with(TICKS))
    }

    fn send(&mut self, message: &CommandMessage) -> Result<(), BusError> {
        self.commands.send_record(0, message).map(drop)
    }
}
