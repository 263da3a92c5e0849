//! Connects an agent to a session's bus.

use std::{
    sync::atomic::{AtomicBool, Ordering},
    time::Duration,
};

use cohabit_bus::{
    BusError, Publisher, Topic, Transport, Wake,
    message::{self, CommandMessage, DialogKind, DialogView, EventKind, EventMessage, Malformed},
    monotonic_nanos,
};

use crate::{
    agent::{Agent, Deed, Heard},
    past::Past,
};

/// How long a late joiner listens to what was before it takes anything up: all publishers have greeted it by then, and
/// a short command that is under way has ended.
const SETTLE_NANOS: u64 = 600_000_000;

/// Why an agent left its session.
#[derive(Debug, thiserror::Error)]
pub enum PeerError {
    /// The bus failed.
    #[error(transparent)]
    Bus(#[from] BusError),
    /// A peer sent nonsense.
    #[error(transparent)]
    Malformed(#[from] Malformed),
}

/// Runs `agent` for that body on `bus` until `stop`. One that joins in the middle of a plan carries on with it.
///
/// # Errors
/// [`PeerError`].
pub fn run(agent: &mut dyn Agent, body: u32, bus: &dyn Transport, stop: &AtomicBool) -> Result<(), PeerError> {
    let mut listener = bus.listener(Wake::Talk)?;
    let mut dialog = bus.subscriber(Topic::Dialog)?;
    let mut events = bus.subscriber(Topic::Events)?;
    let mut mouth = Mouth {
        body,
        commands: bus.publisher(Topic::Commands)?,
        dialog: bus.publisher(Topic::Dialog)?,
        count: 0,
        base: first_command(),
    };
    let joined_nanos = monotonic_nanos();
    let mut past = Some(Past::default());
    let mut deeds = Vec::new();
    while !stop.load(Ordering::Relaxed) {
        listener.wait(Duration::from_millis(100))?;
        while let Some(sample) = events.receive()? {
            let event: EventMessage = message::read(sample.payload())?;
            let (Some(EventKind::Outcome), Some(status)) = (event.kind(), event.status()) else { continue };
            if let Some(past) = past.as_mut().filter(|_| event.body == body) {
                past.note_outcome(event.turn, status, event.text.as_str());
            } else if event.command == mouth.latest() {
                agent.hear(&Heard::Outcome { status, detail: event.text.as_str() }, &mut deeds);
                mouth.carry_out(&mut deeds)?;
            }
        }
        while let Some(sample) = dialog.receive()? {
            let view = DialogView::new(sample.payload())?;
            if view.header.kind() != Some(DialogKind::Plan) || view.header.body != body {
                continue;
            }
            let is_new = sample.envelope().sent_nanos >= joined_nanos;
            match &mut past {
                Some(past) if !is_new => past.note_plan(view.header.turn, view.steps),
                None if !is_new => {}
                _ => {
                    past = None;
                    agent.hear(&Heard::Plan { turn: view.header.turn, steps: view.steps }, &mut deeds);
                    mouth.carry_out(&mut deeds)?;
                }
            }
        }
        if monotonic_nanos() - joined_nanos > SETTLE_NANOS
            && let Some(past) = past.take()
        {
            deeds.extend(past.relive(agent));
            mouth.carry_out(&mut deeds)?;
        }
    }
    Ok(())
}

/// A number unlike that of other agents, in the upper bits of what JSON can hold exactly.
fn first_command() -> u64 {
    let mixed = monotonic_nanos() ^ (u64::from(std::process::id()) << 7);
    (mixed & 0xf_ffff) << 32
}

struct Mouth {
    body: u32,
    commands: Box<dyn Publisher>,
    dialog: Box<dyn Publisher>,
    count: u64,
    base: u64,
}

impl Mouth {
    const fn latest(&self) -> u64 {
        self.base + self.count
    }

    fn carry_out(&mut self, deeds: &mut Vec<Deed>) -> Result<(), BusError> {
        for deed in deeds.drain(..) {
            match deed {
                Deed::Act { turn, action } => {
                    self.count += 1;
                    let command = self.base + self.count;
                    let message = CommandMessage { command, turn, body: self.body, reserved: 0, action: action.into() };
                    self.commands.send(0, size_of::<CommandMessage>(), &mut |bytes| {
                        bytes.copy_from_slice(bytemuck::bytes_of(&message));
                    })?;
                }
                Deed::Tell(message) => {
                    self.dialog.send(0, message.bytes(), &mut |bytes| message.write(bytes))?;
                }
            }
        }
        Ok(())
    }
}
