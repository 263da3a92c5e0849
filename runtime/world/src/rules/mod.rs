//! The rules: what each command does to the world as it stands, as pure functions from facts to a ruling.
//!
//! Nothing here changes anything; `apply` does. One file a family of commands.

mod fluid;
mod hand;
mod opening;
mod toggle;
mod tool;
mod view;

pub(crate) use self::{
    hand::keyed_anchors,
    opening::is_doorway_clear,
    toggle::{doors_of_buttons, works},
    view::Observer,
};

use cohabit_cdf::{
    Action, ActionKind, BodyId, ObjectId, StateFlag, Status, Verb,
    catalog::table::{Judgement, Scope, Term},
};

use crate::{effect::Effect, facts::Facts, reach::Barrier, report::SoundKind, works as machines};

/// How far a hand reaches, level, m.
pub(crate) const REACH_M: f32 = 1.6;
/// How far things can be looked at closely or scanned, m.
const LOOK_CLOSELY_M: f32 = 3.0;

/// What comes of a command.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Ruling {
    pub status: Status,
    /// One short sentence for people.
    pub detail: String,
    pub effects: Vec<Effect>,
}

/// A ruling, or the refusal that ends its making early.
type Verdict = Result<Ruling, Ruling>;

impl Ruling {
    fn done(detail: impl Into<String>, effects: Vec<Effect>) -> Self {
        Self { status: Status::ActionSuccessful, detail: detail.into(), effects }
    }

    fn refusal(status: Status, detail: impl Into<String>) -> Self {
        Self { status, detail: detail.into(), effects: Vec::new() }
    }

    /// Whether it refuses, with nothing to be played out.
    pub fn is_plain_refusal(&self) -> bool {
        !self.status.is_success() && self.effects.is_empty()
    }
}

/// A refusal, as an error.
fn refuse<T>(status: Status, detail: impl Into<String>) -> Result<T, Ruling> {
    Err(Ruling::refusal(status, detail))
}

/// What is said of something shut.
fn closed(facts: &Facts<'_>, shut: ObjectId) -> String {
    let locked = if facts.is(shut, StateFlag::Locked) { "locked" } else { "closed: it has to be opened first" };
    format!("{} is {locked}", facts.name(shut))
}

/// Rules an action of the hand; other actions are motions, and have no rule.
pub(crate) fn rule(facts: &Facts<'_>, body: BodyId, action: &Action) -> Ruling {
    let scene = Scene { facts, body };
    let verdict = match *action {
        Action::PickUp { object } => hand::pick_up(&scene, object),
        Action::Place { receptacle } => hand::place(&scene, receptacle),
        Action::Interact { verb, object } => match verb {
            Verb::Open => opening::open(&scene, object),
            Verb::Close => opening::close(&scene, object),
            Verb::Break => tool::break_or_cut(&scene, object),
            Verb::Scan => tool::scan(&scene, object),
            Verb::Examine => tool::examine(&scene, object),
            Verb::Pour => fluid::pour(&scene, object),
            Verb::Fill => fluid::fill(&scene, object),
            Verb::Clean => fluid::clean(&scene, object),
            Verb::Toggle => toggle::toggle(&scene, object),
            Verb::Throw => hand::throw(&scene, object),
        },
        Action::Move { .. }
        | Action::Rotate { .. }
        | Action::Look { .. }
        | Action::LookAround
        | Action::GoTo { .. }
        | Action::Highlight { .. }
        | Action::Stop
        | Action::Drive { .. } => Ok(Ruling::done("done", Vec::new())),
    };
    let mut ruling = verdict.unwrap_or_else(|refusal| refusal);
    if let (true, Some(object)) = (ruling.status.is_success(), object_of(action)) {
        ruling.effects.push(Effect::Touch(object));
    }
    ruling
}

/// What an action is about, if it is about an object.
pub(crate) fn object_of(action: &Action) -> Option<ObjectId> {
    match *action {
        Action::PickUp { object } | Action::Interact { object, .. } | Action::Highlight { object } => Some(object),
        Action::Place { receptacle } => Some(receptacle),
        _ => None,
    }
}

/// The facts as one body acts on them.
struct Scene<'a> {
    facts: &'a Facts<'a>,
    body: BodyId,
}

impl<'a> Scene<'a> {
    /// What the table says of an action, or the refusal that it comes to.
    fn check(&self, action: ActionKind, object: ObjectId) -> Result<Judgement<'a>, Ruling> {
        let observer = Observer { facts: self.facts, body: Some(self.body) };
        let Some(judgement) = self.facts.catalog.table().judge(&observer, action, object) else {
            return refuse(Status::UnsupportedAction, "the table of actions has no rule for that");
        };
        let Some(need) = judgement.lack else { return Ok(judgement) };
        if need.is_of_access() {
            // Of what is in the way more can be said than a table knows.
            match action {
                ActionKind::Scan | ActionKind::Examine => self.near(object, LOOK_CLOSELY_M)?,
                _ => self.touch(object)?,
            }
        }
        refuse(need.status, self.told(&need.words, object))
    }

    /// Words of the table, with the names of those that they mean.
    fn told(&self, words: &str, object: ObjectId) -> String {
        let observer = Observer { facts: self.facts, body: Some(self.body) };
        let scope = Scope::of(object);
        Term::ALL.into_iter().fold(words.to_owned(), |words, term| {
            let mark = format!("{{{}}}", term.name());
            match scope.get(&observer, term).filter(|_| words.contains(&mark)) {
                Some(id) => words.replace(&mark, &self.facts.name(id)),
                None => words,
            }
        })
    }

    /// A sink that the hand reaches.
    fn basin(&self) -> Option<ObjectId> {
        let sinks = self.facts.state.existing().map(|(id, _)| id);
        let basin = self.facts.catalog.table().basin();
        sinks.filter(|id| self.facts.class(*id).id == basin).find(|sink| self.touch(*sink).is_ok())
    }

    /// What the body holds.
    fn held(&self) -> Option<ObjectId> {
        self.facts.state.bodies[self.body.0 as usize].held
    }

    /// What the body holds, or the refusal for an empty hand.
    fn held_or_refuse(&self) -> Result<ObjectId, Ruling> {
        let empty = "my hand is empty: I have to pick something up first";
        self.held().map_or_else(|| refuse(Status::ObjectNotPickedUp, empty), Ok)
    }

    /// Refuses what is out of reach, behind a wall, shut away, or deadly to touch.
    fn touch(&self, object: ObjectId) -> Result<(), Ruling> {
        self.near(object, REACH_M)?;
        let facts = self.facts;
        if let Some(machine) = machines::behind_glass(facts, object) {
            let detail = format!(
                "{} is behind the glass of {}: its button brings it out",
                facts.name(object),
                facts.name(machine)
            );
            return refuse(Status::TargetInaccessible, detail);
        }
        if facts.is(object, StateFlag::Sparking) {
            let detail = format!("{} was live: the shock was deadly", facts.name(object));
            return Err(Ruling {
                status: Status::KilledByHazard,
                detail,
                effects: vec![Effect::sound(SoundKind::Spark, object), Effect::Kill(self.body)],
            });
        }
        Ok(())
    }

    /// Refuses what is further away than `within` m, behind a wall, or shut away.
    fn near(&self, object: ObjectId, within: f32) -> Result<(), Ruling> {
        let facts = self.facts;
        let name = facts.name(object);
        if !facts.object(object).exists() {
            return refuse(Status::InvalidObjectClass, format!("{name} is no longer there"));
        }
        if let Some(holder) = facts.object(object).held_by() {
            if holder == self.body {
                return Ok(());
            }
            return refuse(Status::TargetInaccessible, format!("somebody else is holding {name}"));
        }
        if let Some(shut) = facts.shut_around(object) {
            return refuse(Status::ReceptacleIsClosed, closed(facts, shut));
        }
        let from = facts.state.bodies[self.body.0 as usize].position;
        if facts.reach_to(object, from) > within {
            return refuse(Status::TargetOutOfRange, format!("{name} is too far away: I have to go there first"));
        }
        match facts.barrier(object, from) {
            None => Ok(()),
            Some(Barrier::Wall) => refuse(Status::TargetInaccessible, format!("there is a wall between me and {name}")),
            Some(Barrier::Door(door)) if facts.is_room_door(door) => {
                refuse(Status::TargetInaccessible, format!("{} is between me and {name}", facts.name(door)))
            }
            Some(Barrier::Door(door)) => {
                let detail = format!("the open door of {} is between me and {name}", facts.name(door));
                refuse(Status::TargetInaccessible, detail)
            }
            Some(Barrier::Side(hollow)) => {
                let detail = format!("I must stand in front of {} to reach {name}", facts.name(hollow));
                refuse(Status::TargetInaccessible, detail)
            }
        }
    }

    /// Refuses what does not afford something.
    fn needs(&self, object: ObjectId, property: cohabit_cdf::Property, what: &str) -> Result<(), Ruling> {
        if self.facts.has(object, property) {
            return Ok(());
        }
        refuse(Status::UnsupportedAction, format!("{} cannot be {what}", self.facts.name(object)))
    }
}
