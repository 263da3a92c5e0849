//! An agent that plays a mission to its goals with a planner.

use std::sync::Arc;

use cohabit_bus::message::{DialogKind, DialogMessage, StateView};
use cohabit_cdf::{Action, Mission, symbolic::SymbolicState};
use cohabit_planner::{Executor, Limits, Next};

use crate::{
    agent::{Agent, Deed, Heard, Now, Senses, TICKS_PER_SECOND},
    symbols::Symbols,
};

/// While there is nothing to decide it looks so often, in ticks.
const IDLE: u64 = 5 * TICKS_PER_SECOND;
/// What a search for a plan may take. No limit of time: what it does must not depend on the machine.
const LIMITS: Limits = Limits::of_states(4_000);

/// Plays a mission to its goals: plans, does one step after the other, and plans anew when an action fails or the world is not
/// what the plan expects. It knows what the simulator knows, whatever its body sees, and heeds no plans of others. What cannot be
/// reached it says once, with the reason, and does the rest.
pub struct Expert {
    body: u32,
    symbols: Symbols,
    executor: Executor,
    commands: bool,
    acting: Option<Action>,
    waits_until: u64,
    /// How many goals it has said that it gave up, once it has said that it is done.
    said: Option<usize>,
}

impl Expert {
    /// An expert that commands that body in a mission; `first` is the world as it began.
    #[must_use]
    pub fn new(body: u32, mission: Arc<Mission>, first: SymbolicState) -> Self {
        Self {
            body,
            symbols: Symbols::new(body, first),
            executor: Executor::new(mission, LIMITS, TICKS_PER_SECOND as f32),
            commands: true,
            acting: None,
            waits_until: 0,
            said: None,
        }
    }

    fn live(&mut self, now: &Now<'_>, deeds: &mut Vec<Deed>) {
        let rest = match now.state {
            Some(state) if self.commands && self.acting.is_none() && now.tick >= self.waits_until => {
                self.decide(now.tick, state, deeds)
            }
            _ if self.commands && self.acting.is_none() => self.waits_until.saturating_sub(now.tick).max(1),
            _ => IDLE,
        };
        deeds.push(Deed::Rest(rest));
    }

    /// Decides what to do, and gives for how many ticks there is nothing more to decide.
    fn decide(&mut self, tick: u64, state: StateView<'_>, deeds: &mut Vec<Deed>) -> u64 {
        self.symbols.take_in(state);
        let met: Vec<bool> = state.goals.iter().map(|goal| goal.met == 1).collect();
        match self.executor.next(self.symbols.state(), &met) {
            Next::Act(action) => {
                self.said = None;
                self.acting = Some(action);
                deeds.push(Deed::Act { turn: 0, action });
                IDLE
            }
            Next::Wait(ticks) => {
                self.waits_until = tick + u64::from(ticks);
                u64::from(ticks)
            }
            Next::Over => {
                self.conclude(deeds);
                IDLE
            }
        }
    }

    /// Says what came of it, once.
    fn conclude(&mut self, deeds: &mut Vec<Deed>) {
        let given_up = self.executor.given_up();
        if self.said.replace(given_up.len()) == Some(given_up.len()) {
            return;
        }
        if given_up.is_empty() {
            deeds.push(self.say("All goals are met."));
        }
        for one in given_up {
            tracing::warn!("{one}");
            deeds.push(self.say(&format!("I give up: {one}.")));
        }
    }

    fn say(&self, words: &str) -> Deed {
        Deed::Tell(Box::new(DialogMessage::new(DialogKind::Reply, self.body, 0, words)))
    }
}

impl Agent for Expert {
    fn senses(&self) -> Senses {
        Senses { sight: false, state: true }
    }

    fn hear(&mut self, heard: &Heard<'_>, deeds: &mut Vec<Deed>) {
        match *heard {
            Heard::Now(now) => self.live(now, deeds),
            Heard::Outcome { status, detail } => {
                if let Some(action) = self.acting.take() {
                    if status.is_success() {
                        self.symbols.did(action);
                    }
                    self.executor.outcome(status, detail);
                }
            }
            Heard::Commands(commands) => {
                self.commands = commands;
                self.acting = None;
                self.executor.forget();
            }
            // It has goals of its own.
            Heard::Plan { .. } => {}
        }
    }
}
