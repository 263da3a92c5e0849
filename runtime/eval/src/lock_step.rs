//! World, conversation and agent in one thread, one tick after the other.

use std::path::Path;

use cohabit_agent::{Agent, Deed, Heard, PlanFollower};
use cohabit_bus::message::{DialogKind, DialogMessage, StateView};
use cohabit_cdf::{Action, BodyId};
use cohabit_dialog::{Asked, Conversation, Knowledge, Outgoing, TurnEnd, known};
use cohabit_engine::{SessionPlan, report};
use cohabit_generate::tick;
use cohabit_language::Known;
use cohabit_record::{LogError, SessionFacts};
use cohabit_world::{Input, Outcome, World};

use crate::trace::Recording;

/// The body that is spoken to.
pub(crate) const BODY: BodyId = BodyId(0);

/// A session whose world waits for everybody: what follows from a tick is said and decided before the next.
pub struct LockStep {
    world: World,
    conversation: Conversation,
    knowledge: Knowledge,
    agent: PlanFollower,
    /// The newest number that a command was given here.
    commands: u64,
    /// The newest command of the body.
    newest: u64,
    waiting: Vec<Input>,
    noted: Noted,
    recording: Recording,
}

/// What is noted of a session until somebody takes it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Noted {
    /// Commands that ended.
    pub outcomes: Vec<Outcome>,
    /// What the robot said, with its kind.
    pub said: Vec<(DialogKind, String)>,
    /// Turns that ended.
    pub turns: Vec<(u64, TurnEnd)>,
}

impl LockStep {
    /// A session at its first tick, in which nothing was said yet.
    #[must_use]
    pub fn new(world: World, conversation: Conversation, knowledge: Knowledge) -> Self {
        Self {
            world,
            conversation,
            knowledge,
            agent: PlanFollower::new(BODY.0),
            commands: 0,
            newest: 0,
            waiting: Vec::new(),
            noted: Noted::default(),
            recording: Recording::default(),
        }
    }

    /// The same session where something happened already: with the mind that followed it, the newest command of the body, a number that no
    /// command has reached, and what was recorded.
    pub(crate) fn going_on(self, agent: PlanFollower, newest: u64, commands: u64, recording: Recording) -> Self {
        Self { agent, newest, commands, recording, ..self }
    }

    /// Records all that follows in a new log.
    ///
    /// # Errors
    /// [`LogError`].
    pub fn record(&mut self, path: &Path, facts: &SessionFacts, plan: &SessionPlan) -> Result<(), LogError> {
        self.recording.begin(path, facts, plan)
    }

    /// The world as it is.
    #[must_use]
    pub const fn world(&self) -> &World {
        &self.world
    }

    /// All that was noted since this was last asked.
    pub fn take_noted(&mut self) -> Noted {
        std::mem::take(&mut self.noted)
    }

    /// Somebody says something to the robot; gives the turn's number.
    ///
    /// # Errors
    /// [`LogError`].
    pub fn say(&mut self, text: &str) -> Result<u64, LogError> {
        self.say_called(text, text)
    }

    /// The same, of which `text` is said to the robot: all but its name.
    ///
    /// # Errors
    /// [`LogError`].
    pub fn say_called(&mut self, said: &str, text: &str) -> Result<u64, LogError> {
        self.look();
        let (turn, outbox) = self.conversation.hear_called(said, text, 0, &self.knowledge);
        self.deliver(outbox)?;
        Ok(turn)
    }

    /// Commands the body, past dialog and agent.
    pub fn command(&mut self, action: Action) {
        self.act(0, action);
    }

    /// Gives a command that has a number already, of any body, past dialog and agent.
    pub(crate) fn give(&mut self, input: Input, turn: u64) {
        if input.body == BODY {
            self.newest = input.command;
        }
        self.recording.turns.insert(input.command, turn);
        self.waiting.push(input);
    }

    /// Whether the body has nothing to do, and no plan.
    pub(crate) fn is_at_rest(&self) -> bool {
        let is_busy = self.world.body(BODY).is_some_and(|body| body.busy);
        !is_busy && self.waiting.is_empty() && self.conversation.plan_under_way().is_none()
    }

    /// One tick, and all that is said and decided about it.
    ///
    /// # Errors
    /// [`LogError`].
    pub fn tick(&mut self) -> Result<(), LogError> {
        let outcomes = tick(&mut self.world, &mut self.recording, &std::mem::take(&mut self.waiting))?;
        let now = self.world.tick();
        let body = self.world.body(BODY).map(|body| (body.position_m.to_array(), body.yaw_rad));
        if body.is_some_and(|(position_m, yaw_rad)| self.knowledge.is_due(now, position_m, yaw_rad)) {
            self.look();
        }
        for outcome in outcomes {
            self.end_command(outcome)?;
        }
        Ok(())
    }

    /// Has the robot look at the state as it would be published.
    fn look(&mut self) {
        let Self { world, knowledge, .. } = self;
        with_state(world, |state| knowledge.look(state, world.tick()));
    }

    /// All that is true, as somebody would know it who is everywhere.
    #[must_use]
    pub fn truth(&self) -> Option<Known> {
        truth(&self.world)
    }

    /// What the robot asks, if it waits for an answer.
    #[must_use]
    pub const fn asked(&self) -> Option<&Asked> {
        self.conversation.asked()
    }

    /// Ends the log.
    ///
    /// # Errors
    /// [`LogError`].
    pub fn finish(&mut self) -> Result<(), LogError> {
        self.recording.finish()
    }

    fn end_command(&mut self, outcome: Outcome) -> Result<(), LogError> {
        let turn = self.recording.turns.remove(&outcome.command).unwrap_or(0);
        if outcome.body == BODY && outcome.command == self.newest && turn != 0 {
            let mut deeds = Vec::new();
            self.agent.hear(&Heard::Outcome { status: outcome.status, detail: &outcome.detail }, &mut deeds);
            self.carry_out(deeds)?;
        }
        self.noted.outcomes.push(outcome);
        Ok(())
    }

    /// What the agent decided.
    pub(crate) fn carry_out(&mut self, deeds: Vec<Deed>) -> Result<(), LogError> {
        for deed in deeds {
            match deed {
                Deed::Act { turn, action } => self.act(turn, action),
                Deed::Rest(_) => {}
                Deed::Tell(message) => {
                    self.recording.dialog(self.world.tick(), &message)?;
                    if matches!(message.header.kind(), Some(DialogKind::StepEnded | DialogKind::PlanEnded)) {
                        self.look();
                    }
                    let Self { knowledge, conversation, .. } = self;
                    if let Some(action) = conversation.deed(&message.header) {
                        knowledge.note_deed(&action);
                    }
                    let outbox = conversation.follow(&message.header, knowledge);
                    self.deliver(outbox)?;
                }
            }
        }
        Ok(())
    }

    /// Passes on what the conversation lets happen, and takes down which turns ended.
    fn deliver(&mut self, outbox: Vec<Outgoing>) -> Result<(), LogError> {
        for item in outbox {
            if let Some(message) = item.message(BODY.0) {
                self.pass_on(&message)?;
            }
            if let Outgoing::TurnEnded { turn, end } = item {
                self.noted.turns.push((turn, end));
            }
        }
        Ok(())
    }

    fn pass_on(&mut self, message: &DialogMessage) -> Result<(), LogError> {
        self.recording.dialog(self.world.tick(), message)?;
        match message.header.kind() {
            Some(DialogKind::Plan) => {
                let mut deeds = Vec::new();
                self.agent.hear(&Heard::Plan { turn: message.header.turn, steps: &message.steps }, &mut deeds);
                self.carry_out(deeds)
            }
            Some(kind @ (DialogKind::Reply | DialogKind::Question)) => {
                self.noted.said.push((kind, message.header.text.as_str().to_owned()));
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn act(&mut self, turn: u64, action: Action) {
        self.commands += 1;
        self.newest = self.commands;
        self.recording.turns.insert(self.commands, turn);
        self.waiting.push(Input { command: self.commands, body: BODY, action });
    }
}

/// All that is true in a world, as somebody would know it who is everywhere.
pub(crate) fn truth(world: &World) -> Option<Known> {
    with_state(world, |state| known::everything(state, BODY, world.catalog())).flatten()
}

/// Looks at the state of the world as it would be published.
pub(crate) fn with_state<T>(world: &World, look: impl FnOnce(StateView<'_>) -> T) -> Option<T> {
    let parts = report::state(world);
    let mut words = vec![0_u64; parts.bytes().div_ceil(size_of::<u64>())];
    let bytes = &mut bytemuck::cast_slice_mut(&mut words)[..parts.bytes()];
    parts.write(bytes);
    StateView::new(bytes).ok().map(look)
}
