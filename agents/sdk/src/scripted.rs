//! An agent that does what a script says.

use std::sync::Arc;

use cohabit_bus::message::{BodyRecord, DialogKind, DialogMessage, NONE, ObjectRecord, StateView};
use cohabit_cdf::{Action, Catalog, ClassId, GoToTarget, ObjectId};

use crate::{
    agent::{Agent, Deed, Heard, Now, Senses, TICKS_PER_SECOND},
    errand::{Errand, Progress},
    memory::level_m,
    script::{Deal, Line, Named, Order, Script},
};

/// It goes on so long after a failure, in ticks, that nobody is flooded with commands in vain.
const PAUSE_AFTER_FAILURE: u64 = TICKS_PER_SECOND;
/// While there is nothing to decide it looks so often, in ticks.
const IDLE: u64 = 5 * TICKS_PER_SECOND;

/// Does the lines of a [`Script`] one after the other, and walks to what each one needs. It knows the whole state of
/// the world: a script names things that its body may not see.
pub struct Scripted {
    body: u32,
    script: Script,
    catalog: Arc<Catalog>,
    errand: Errand,
    next: usize,
    waits_until: u64,
    commands: bool,
    stopped: bool,
    tick: u64,
}

impl Scripted {
    /// An agent that has that body do what `script` says.
    #[must_use]
    pub fn new(body: u32, script: Script) -> Self {
        Self::with_catalog(Arc::new(Catalog::builtin()), body, script)
    }

    /// The same in a world with this catalogue.
    #[must_use]
    pub fn with_catalog(catalog: Arc<Catalog>, body: u32, script: Script) -> Self {
        Self {
            body,
            script,
            catalog,
            errand: Errand::default(),
            next: 0,
            waits_until: 0,
            commands: true,
            stopped: false,
            tick: 0,
        }
    }

    fn live(&mut self, now: &Now<'_>, deeds: &mut Vec<Deed>) {
        self.tick = now.tick;
        while self.commands && !self.stopped && !self.errand.is_under_way() && now.tick >= self.waits_until {
            let (Some(own), Some(state)) = (now.own, now.state) else { break };
            match self.script.lines.get(self.next).cloned() {
                Some(line) => {
                    self.next += 1;
                    self.obey(&line, own, state, deeds);
                }
                None if self.script.loops => {
                    self.next = 0;
                    // Other things happen in between.
                    self.waits_until = now.tick + 1;
                }
                None => self.stopped = true,
            }
        }
        let idle = if self.stopped || self.errand.is_under_way() { IDLE } else { 1 };
        deeds.push(Deed::Rest(idle.max(self.waits_until.saturating_sub(now.tick))));
    }

    fn obey(&mut self, line: &Line, own: &BodyRecord, state: StateView<'_>, deeds: &mut Vec<Deed>) {
        let action = match &line.order {
            Order::Act(action) => *action,
            Order::Say(words) => return deeds.push(self.say(words)),
            Order::Wait(ticks) => {
                self.waits_until = self.tick + ticks;
                return;
            }
            Order::Handle(deal, named) => match self.find(*deal, named, own, state) {
                Some(object) => deal.on(object),
                None => {
                    let what = match named {
                        Named::Instance(name) => name.as_str(),
                        Named::Class(class) => &self.catalog.class(*class).id,
                    };
                    let detail = format!("there is no `{what}` here");
                    return self.fail(&detail, deeds);
                }
            },
        };
        deeds.push(Deed::Act { turn: 0, action: self.errand.begin(action) });
    }

    /// The thing that is meant: the one of that id, or the nearest of that class that is not in the way of being meant.
    fn find(&self, deal: Deal, named: &Named, own: &BodyRecord, state: StateView<'_>) -> Option<ObjectId> {
        let class = match named {
            Named::Instance(name) => {
                if let Some(object) = state.objects.iter().find(|object| object.instance.as_str() == name) {
                    return Some(ObjectId(object.object));
                }
                self.catalog.find(name)?
            }
            Named::Class(class) => *class,
        };
        let is_meant = |object: &&ObjectRecord| {
            ClassId(object.class) == class && object.hidden == 0 && (deal != Deal::PickUp || object.held_by == NONE)
        };
        let nearest = state.objects.iter().filter(is_meant).min_by(|one, other| {
            let far = |object: &ObjectRecord| level_m(object.position_m, own.position_m);
            far(one).total_cmp(&far(other)).then(one.object.cmp(&other.object))
        });
        nearest.map(|object| ObjectId(object.object))
    }

    fn fail(&mut self, detail: &str, deeds: &mut Vec<Deed>) {
        let Some(line) = self.next.checked_sub(1).and_then(|index| self.script.lines.get(index)) else { return };
        let place = format!("{}:{}", self.script.file, line.number);
        let goes_on = line.goes_on;
        if goes_on {
            tracing::info!("{place}: {detail}; the script goes on");
        } else {
            tracing::warn!("{place}: {detail}; the script ends here (`on-failure continue` would go on)");
            deeds.push(self.say(&format!("I stop at line {} of my script: {detail}.", line.number)));
        }
        self.stopped = !goes_on;
        self.waits_until = self.tick + PAUSE_AFTER_FAILURE;
    }

    fn say(&self, words: &str) -> Deed {
        Deed::Tell(Box::new(DialogMessage::new(DialogKind::Reply, self.body, 0, words)))
    }
}

impl Deal {
    const fn on(self, object: ObjectId) -> Action {
        match self {
            Self::GoTo => Action::GoTo { target: GoToTarget::Object(object) },
            Self::PickUp => Action::PickUp { object },
            Self::Place => Action::Place { receptacle: object },
            Self::Highlight => Action::Highlight { object },
            Self::Do(verb) => Action::Interact { verb, object },
        }
    }
}

impl Agent for Scripted {
    fn senses(&self) -> Senses {
        Senses { sight: false, state: true }
    }

    fn hear(&mut self, heard: &Heard<'_>, deeds: &mut Vec<Deed>) {
        match *heard {
            Heard::Now(now) => self.live(now, deeds),
            Heard::Outcome { status, detail } => match self.errand.hear(status) {
                Some(Progress::Then(action)) => deeds.push(Deed::Act { turn: 0, action }),
                Some(Progress::Over) if !status.is_success() => self.fail(detail, deeds),
                _ => {}
            },
            Heard::Commands(commands) => {
                // The line that was cut short is done again when the body comes back.
                if self.errand.is_under_way() {
                    self.next = self.next.saturating_sub(1);
                }
                self.errand.give_up();
                self.commands = commands;
            }
            // A script is not talked out of what it says.
            Heard::Plan { .. } => {}
        }
    }
}
