//! What comes in: commands, who commands and who is waited for, and how time is to go by.

use std::collections::VecDeque;

use cohabit_bus::{
    BusError, Inbox, Topic, Transport,
    message::{self, CommandKind, CommandMessage, Control, ControlMessage, EventKind, EventMessage, NONE},
};
use cohabit_cdf::{Action, Status};

use crate::{
    attendance::Attendance,
    commanders::{Commander, Commanders},
};

/// Commands that one tick takes in at most; the rest wait for the next.
const MOST_INPUTS: usize = 64;
/// Commands that wait at most; those beyond are refused.
const MOST_WAITING: usize = 512;

/// Where messages to the simulator arrive, and are sorted.
pub(crate) struct Intake {
    commands: Inbox,
    control: Inbox,
    waiting: VecDeque<CommandMessage>,
    /// Who commands which body.
    pub commanders: Commanders,
    /// Who is waited for in lock-step.
    pub attendance: Attendance,
    /// What is asked of the clock, in order.
    pub controls: Vec<Control>,
}

impl Intake {
    pub fn new(bus: &dyn Transport) -> Result<Self, BusError> {
        Ok(Self {
            commands: Inbox::new(bus, Topic::Commands)?,
            control: Inbox::new(bus, Topic::Control)?,
            waiting: VecDeque::new(),
            commanders: Commanders::default(),
            attendance: Attendance::default(),
            controls: Vec::new(),
        })
    }

    /// Commands that were lost because too many came at once.
    pub fn lost(&self) -> u64 {
        self.commands.lost() + self.control.lost()
    }

    /// Takes in all that has arrived until `tick` in a world of so many bodies. Gives what is to be told about it.
    pub fn take_in(&mut self, tick: u64, bodies: usize) -> Result<Vec<EventMessage>, BusError> {
        let mut told = Vec::new();
        while let Some((_, control)) =
            self.control.next(|sample| Control::try_from(message::read::<ControlMessage>(sample.payload())?))?
        {
            self.controls.push(control);
        }
        while let Some((run, kind, message)) = self.next_command()? {
            self.sort(run, kind, message, tick, bodies, &mut told);
        }
        let cut_off = self.commands.newly_cut_off().chain(self.control.newly_cut_off());
        told.extend(cut_off.map(|nonsense| EventMessage::new(EventKind::CutOff).saying(&nonsense.to_string())));
        Ok(told)
    }

    fn next_command(&mut self) -> Result<Option<(u64, CommandKind, CommandMessage)>, BusError> {
        let next = self.commands.next(|sample| {
            let message: CommandMessage = message::read(sample.payload())?;
            Ok((message.kind()?, message))
        })?;
        Ok(next.map(|(sample, (kind, message))| (sample.envelope().run, kind, message)))
    }

    fn sort(
        &mut self,
        run: u64,
        kind: CommandKind,
        message: CommandMessage,
        tick: u64,
        bodies: usize,
        told: &mut Vec<EventMessage>,
    ) {
        let body = message.body;
        let outcome = |status, detail: &str| EventMessage::outcome(message.command, message.turn, body, status, detail);
        let takes_turns = matches!(kind, CommandKind::Attend | CommandKind::Leave | CommandKind::Ready);
        if body as usize >= bodies && !(takes_turns && body == NONE) {
            told.push(outcome(Status::InvalidCommand, &format!("there is no body {body}")));
            return;
        }
        match kind {
            CommandKind::Act => match self.admit(run, message) {
                Ok(()) => self.waiting.push_back(message),
                Err((status, detail)) => told.push(outcome(status, &detail)),
            },
            CommandKind::Claim | CommandKind::TakeOver => {
                let claimant = Commander { run, peer: message.peer() };
                match self.commanders.claim(body, claimant, kind == CommandKind::TakeOver) {
                    Ok(how) => {
                        told.push(commander(body, run, &how));
                        told.push(outcome(Status::ActionSuccessful, &how));
                    }
                    Err(why) => told.push(outcome(Status::InvalidCommand, &why)),
                }
            }
            CommandKind::Release => {
                let released = self.commanders.release(body, run);
                told.extend(released.map(|how| commander(body, self.commander(body), &how)));
            }
            CommandKind::Attend => self.attendance.attend(run, body, message.argument),
            CommandKind::Leave => self.attendance.leave(run),
            CommandKind::Ready => self.attendance.ready(run, tick, message.argument),
        }
    }

    fn admit(&self, run: u64, message: CommandMessage) -> Result<(), (Status, String)> {
        self.commanders.obeys(message.body, run).map_err(|why| (Status::InvalidCommand, why))?;
        Action::try_from(message.action).map_err(|malformed| (Status::IncorrectActionFormat, malformed.to_string()))?;
        if self.waiting.len() >= MOST_WAITING {
            return Err((Status::ArenaUnavailable, format!("{MOST_WAITING} commands are waiting already")));
        }
        Ok(())
    }

    /// The commands of the next tick: body by body, each body's in the order in which they came.
    pub fn commands(&mut self) -> Vec<CommandMessage> {
        let mut commands: Vec<_> = self.waiting.drain(..self.waiting.len().min(MOST_INPUTS)).collect();
        commands.sort_by_key(|command| command.body);
        commands
    }

    /// Forgets commanders whose processes are gone. Gives what is to be told about it.
    pub fn bury(&mut self) -> Vec<EventMessage> {
        let buried = self.commanders.bury_all();
        buried.into_iter().map(|(body, how)| commander(body, self.commander(body), &how)).collect()
    }

    /// The run of a body's commander; 0 if it has none.
    pub fn commander(&self, body: u32) -> u64 {
        self.commanders.of(body).map_or(0, |commander| commander.run)
    }
}

/// Another commands a body.
fn commander(body: u32, run: u64, how: &str) -> EventMessage {
    let mut event = EventMessage::new(EventKind::Commander).saying(how);
    (event.body, event.number) = (body, run.cast_signed());
    event
}
