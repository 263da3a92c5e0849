//! The rules: what each command does to the world as it stands, as pure functions from facts to a ruling.
//!
//! What an action needs, changes and answers stands in the table of actions and devices; here it is evaluated. Nothing here
//! changes anything; `apply` does.

mod doors;
mod effects;
mod machine;
mod places;
mod press;
mod view;
mod work;

use self::effects::effects_of;
pub(crate) use self::{
    doors::{doors_of_buttons, is_doorway_clear},
    machine::works,
    places::keyed_anchors,
    view::Observer,
    work::{effects_of_work, on_power, powered},
};

use cohabit_cdf::{
    Action, ActionKind, BodyId, ObjectId, StateFlag, Status,
    catalog::table::{Change, Judgement, Need, Range, Scope, Term, Test},
};

use crate::{
    effect::Effect,
    facts::Facts,
    reach::Barrier,
    report::SoundKind,
    works::{self as machines, portal},
};

/// How far a hand reaches, level, m.
pub(crate) const REACH_M: f32 = Range::Hand.metres();

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

/// What people call the things of these classes, each once: `the laser tip or the control panel`.
fn names_of(facts: &Facts<'_>, classes: &[String]) -> String {
    let mut names: Vec<String> = Vec::new();
    for class in classes.iter().filter_map(|class| facts.catalog.find(class)) {
        let name = facts.catalog.class(class).name.to_lowercase();
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names.join(" or ")
}

/// Rules an action of the hand; other actions are motions, and have no rule.
pub(crate) fn rule(facts: &Facts<'_>, body: BodyId, action: &Action) -> Ruling {
    match ActionKind::of(action) {
        None | Some((ActionKind::GoTo, _)) => Ruling::done("done", Vec::new()),
        Some((kind, object)) => {
            Scene { facts, body, beside: action.beside() }.rule(kind, object).unwrap_or_else(|refusal| refusal)
        }
    }
}

/// What an action is about, if it is about an object.
pub(crate) fn object_of(action: &Action) -> Option<ObjectId> {
    match *action {
        Action::PickUp { object } | Action::Interact { object, .. } | Action::Highlight { object } => Some(object),
        Action::Place { receptacle } | Action::PlaceBeside { receptacle, .. } => Some(receptacle),
        _ => None,
    }
}

/// The facts as one body acts on them.
struct Scene<'a> {
    facts: &'a Facts<'a>,
    body: BodyId,
    /// What it is to put something beside.
    beside: Option<ObjectId>,
}

impl<'a> Scene<'a> {
    const fn observer(&self) -> Observer<'a> {
        Observer { facts: self.facts, body: Some(self.body), beside: self.beside }
    }

    /// What an action on an object comes to.
    fn rule(&self, action: ActionKind, object: ObjectId) -> Verdict {
        let Judgement { rule, device, .. } = self.check(action, object)?;
        let (observer, scope) = (self.observer(), Scope::of(object));
        let pressed = device.map_or_else(Vec::new, |device| scope.changes(&observer, &device.press));
        let changes = scope.changes(&observer, &rule.effects);
        let mut effects = effects_of(&observer, &scope, &pressed);
        effects.extend(device.into_iter().flat_map(|device| press::sounds(&observer, object, device, &pressed)));
        effects.extend(effects_of(&observer, &scope, &changes));
        if let Some(need) = scope.lacks(&observer, &rule.but) {
            return Ok(Ruling { status: need.status, detail: self.told(&need.words, object), effects });
        }
        effects.push(Effect::Touch(object));
        let detail = match device {
            Some(device) => press::told(&observer, object, device, &pressed),
            None => self.read(object, &changes).unwrap_or_else(|| self.told(&rule.done, object)),
        };
        Ok(self.put_beside(Ruling::done(detail, effects)))
    }

    /// The same, where something was to be put beside another thing: it says whether it stands there, or where there was room.
    fn put_beside(&self, ruling: Ruling) -> Ruling {
        let facts = self.facts;
        let Some(other) = self.beside else { return ruling };
        let Some(is_beside) = places::is_put_beside(facts, &ruling.effects, other) else { return ruling };
        let (other, held) = (facts.name(other), self.held().map_or_else(|| "it".to_owned(), |held| facts.name(held)));
        if is_beside {
            return Ruling { detail: format!("I put {held} beside {other}"), ..ruling };
        }
        let detail = format!("there is no room beside {other}, so I put {held} where there is some");
        Ruling { status: Status::AlternateNavigationUsed, detail, ..ruling }
    }

    /// What the table says of an action, or the refusal that it comes to.
    fn check(&self, action: ActionKind, object: ObjectId) -> Result<Judgement<'a>, Ruling> {
        let Some(judgement) = self.facts.catalog.table().judge(&self.observer(), action, object) else {
            return refuse(Status::UnsupportedAction, "the table of actions has no rule for that");
        };
        let Some(need) = judgement.lack else { return Ok(judgement) };
        if need.is_of_access() {
            // Of what is in the way more can be said than a table knows.
            match action {
                ActionKind::Scan | ActionKind::Examine => self.near(object, Range::Sight.metres())?,
                ActionKind::Throw => {}
                _ => self.touch(object)?,
            }
        }
        refuse(need.status, self.more(need, object).unwrap_or_else(|| self.told(&need.words, object)))
    }

    /// What can be said of a need beyond the words of the table: which lock, keys or time it is about.
    fn more(&self, need: &Need, object: ObjectId) -> Option<String> {
        let facts = self.facts;
        let held = || self.held().map(|held| facts.name(held));
        let test = need.any.iter().find(|condition| condition.term == Term::It).map(|condition| &condition.test);
        match test? {
            Test::Shut => facts.is_shut(object).then(|| closed(facts, object)),
            Test::TakesHeld => {
                let keys = &facts.class(object).receptacle.as_ref().filter(|kind| !kind.keys.is_empty())?.keys;
                let (name, held, keys) = (facts.name(object), held()?, names_of(facts, keys));
                Some(format!("{name} does not take {held}: it only takes {keys}"))
            }
            Test::LetsHeldPass => {
                let era = portal::era_word(facts.state.portals.get(&object)?.way().era);
                Some(format!("{} does not go through the portal to the {era}", held()?))
            }
            _ => None,
        }
    }

    /// What is written on a thing that these changes read.
    fn read(&self, object: ObjectId, changes: &[&Change]) -> Option<String> {
        let text = &self.facts.object(object).text;
        let is_read = changes.iter().any(|change| matches!(change, Change::Read(_))) && !text.is_empty();
        is_read.then(|| format!("{} says: {text}", self.facts.name(object)))
    }

    /// Words of the table, with the names of those that they mean.
    fn told(&self, words: &str, object: ObjectId) -> String {
        let (observer, scope) = (self.observer(), Scope::of(object));
        let fluid = self.held().map_or("", |held| self.facts.object(held).fluid.name());
        let words = words.replace("{fluid}", &fluid.to_lowercase());
        Term::ALL.into_iter().fold(words, |words, term| {
            let mark = format!("{{{}}}", term.name());
            // Some terms are looked for among all objects.
            match words.contains(&mark).then(|| scope.get(&observer, term)).flatten() {
                Some(id) => words.replace(&mark, &self.facts.name(id)),
                None => words,
            }
        })
    }

    /// A sink that the hand reaches: of several one whose water runs, such as a washbasin beside a bathtub.
    fn basin(&self) -> Option<ObjectId> {
        let sinks = self.facts.state.existing().map(|(id, _)| id);
        let table = self.facts.catalog.table();
        let sinks = sinks.filter(|id| table.is_basin(&self.facts.class(*id).id) && self.touch(*id).is_ok());
        sinks.min_by_key(|sink| !self.facts.is(*sink, StateFlag::Toggled))
    }

    /// What the body holds.
    fn held(&self) -> Option<ObjectId> {
        self.facts.state.bodies[self.body.0 as usize].held
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
}
