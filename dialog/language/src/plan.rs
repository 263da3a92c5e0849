//! From clauses to steps: each clause is grounded on the scene as the steps before it are expected to leave it.

mod beside;
mod breakage;
mod carry;
mod clauses;
mod device;
mod fixed;
mod motion;
mod pour;
mod process;
pub(crate) mod remedy;
pub(crate) mod settle;
mod storage;
mod swap;
mod undo;

use cohabit_cdf::{Action, Catalog, ClassId, ObjectId, Property, Verb, state::StateFlag};

use crate::{
    ground::{
        Ground,
        focus::Focus,
        judge::Judge,
        want::{Miss, Want},
    },
    known::{Known, KnownObject, describe, habits::Habits, imagine, process::Devices, sight},
    read::{
        phrase::Phrase,
        slot::{Role, Slot},
    },
    understanding::Step,
    words::{intent::Intent, lexicon::Pronoun},
};

/// How near what is seen is taken without another look, m.
const AT_HAND_M: f32 = 2.0;
/// The share of a room that was looked at by who has looked around in it.
const LOOKED_AT: f32 = 0.6;
/// What is said where something is asked of the floor, which is no thing.
const NOTHING_WITH_FLOOR: &str = "I can do nothing with the floor itself.";

/// Why there is no plan.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Fault {
    /// A phrase could not be grounded.
    Miss { slot: Option<Slot>, phrase: Box<Phrase>, miss: Miss, intent: Intent },
    /// Something else is in the hand.
    HandFull { held: ObjectId, wanted: ObjectId },
    /// Something of these classes is needed, and none is known; `text` says so.
    Need { classes: Vec<ClassId>, text: String },
    /// Nobody said which way to turn.
    Direction,
    /// It cannot be done, but this could.
    Offer { text: String, steps: Vec<Step> },
    /// It cannot be done, for this reason.
    Cannot(String),
}

/// Builds a plan.
pub(crate) struct Planner<'a> {
    pub(crate) catalog: &'a Catalog,
    pub(crate) devices: &'a Devices,
    pub(crate) habits: &'a Habits,
    pub(crate) judge: Judge<'a>,
    pub(crate) scene: Known,
    pub(crate) focus: Focus,
    /// Where the robot stands before the first step, m.
    pub(crate) from_m: [f32; 2],
    pub(crate) steps: Vec<Step>,
    /// What the robot should say beyond the steps: what it does unasked, what is done already.
    pub(crate) notes: Vec<String>,
    /// What this request would have it carry that cannot be carried.
    pub(crate) fixed: Vec<ObjectId>,
    /// What it does not do of this request, and why.
    pub(crate) left_out: Option<String>,
    /// Whether it may put down what it holds to take something else.
    pub(crate) may_put_down: bool,
    /// Whether it has looked around for this request.
    pub(crate) has_looked: bool,
    pub(crate) clause: usize,
    /// What was done already to which thing: nobody wants it repaired twice.
    pub(crate) brought_about: Vec<(Intent, ObjectId)>,
    /// Which steps turn off what the request has not asked for to be off.
    pub(crate) turned_off: Vec<usize>,
    /// The steps, and what was spoken of, when that clause was begun.
    pub(crate) begun: (usize, Focus),
}

impl<'a> Planner<'a> {
    /// One at the present state of the scene.
    pub(crate) fn new(
        catalog: &'a Catalog,
        devices: &'a Devices,
        habits: &'a Habits,
        judge: Judge<'a>,
        scene: &Known,
        focus: Focus,
    ) -> Self {
        Self {
            catalog,
            devices,
            habits,
            judge,
            scene: scene.clone(),
            from_m: [scene.robot.position_m[0], scene.robot.position_m[1]],
            begun: (0, focus.clone()),
            focus,
            steps: Vec::new(),
            notes: Vec::new(),
            fixed: Vec::new(),
            left_out: None,
            may_put_down: false,
            has_looked: false,
            clause: 0,
            brought_about: Vec::new(),
            turned_off: Vec::new(),
        }
    }

    /// Adds a step and imagines its effect.
    pub(crate) fn push(&mut self, action: Action, says: String) {
        self.focus.remember(&self.scene, &action);
        imagine::apply(&mut self.scene, &action, self.devices);
        self.focus.follow(&action);
        self.steps.push(Step { action, says });
    }

    pub(crate) fn interact(&mut self, verb: Verb, object: ObjectId, participle: &str) {
        let says = format!("{participle} {}", self.the(object));
        self.push(Action::Interact { verb, object }, says);
    }

    pub(crate) fn the(&self, object: ObjectId) -> String {
        describe::short(self.catalog, &self.scene, object)
    }

    pub(crate) fn ground(&self) -> Ground<'_> {
        Ground { catalog: self.catalog, scene: &self.scene, focus: &self.focus, judge: self.judge }
    }

    /// Grounds a phrase, and says where it stands if that fails.
    pub(crate) fn find_one(&self, phrase: &Phrase, want: &Want<'_>, role: Option<Role>) -> Result<ObjectId, Fault> {
        if phrase.is_floor {
            return Err(Fault::Cannot(NOTHING_WITH_FLOOR.to_owned()));
        }
        let is_held = want.held_first && self.scene.robot.held.is_some();
        let is_it = phrase.pronoun == Some(Pronoun::Thing) && !phrase.is_described() && phrase.chosen.is_none();
        let phrase = self.focus.unseen.as_ref().filter(|_| is_it && !is_held).unwrap_or(phrase);
        let found = match self.ground().one(phrase, want) {
            Ok(id) if self.is_hasty(phrase, id, want.intent) => Err(Miss::Hasty),
            // One that is too doubtful to act on: perhaps the one that is meant is behind its back.
            Err(Miss::Several(ids)) if matches!(ids[..], [id] if self.has_yet_to_look(id)) => Err(Miss::Hasty),
            // It has looked, and there is no other: to ask would not help.
            Err(Miss::Several(ids)) => match ids[..] {
                [id] if self.is_settled(id, want.intent) => Ok(id),
                _ => Err(Miss::Several(ids)),
            },
            found => found,
        };
        found.map_err(|miss| self.miss(phrase, miss, want.intent, role))
    }

    /// Whether a look around has settled that this one is meant, where a mistake could be undone.
    fn is_settled(&self, id: ObjectId, intent: Intent) -> bool {
        let is_for_good = |object: &KnownObject| self.judge.is_for_good(intent, object.class);
        self.has_looked && !self.scene.object(id).is_none_or(is_for_good)
    }

    /// Whether to look around before this is taken for what was meant: it is nothing that the mission is about, it is
    /// not at hand, and most of the room was not looked at yet.
    fn is_hasty(&self, phrase: &Phrase, id: ObjectId, intent: Intent) -> bool {
        let Some(object) = self.scene.object(id) else { return false };
        let is_told = phrase.chosen.is_some() || phrase.pronoun.is_some() || phrase.instance.is_some();
        let is_at_hand = self.scene.robot.held == Some(id)
            || object.visible && self.scene.distance_m(object) < AT_HAND_M
            || self.focus.recent.contains(&id);
        let is_elsewhere = phrase.room.is_some_and(|named| named != self.scene.robot.room);
        let is_searched = self.has(id, Property::Pickupable) || intent == Intent::Find;
        !is_told && !is_at_hand && !object.in_mission && !is_elsewhere && is_searched && self.has_yet_to_look(id)
    }

    /// Whether such things may be in this room without its having seen them, and it has not looked around.
    fn has_yet_to_look(&self, id: ObjectId) -> bool {
        let Some((floor, object)) = self.scene.floor.as_ref().zip(self.scene.object(id)) else { return false };
        let reach_m = sight::reach_of(self.catalog.class(object.class));
        !self.has_looked && floor.share_looked_at(self.scene.robot.room, reach_m) < LOOKED_AT
    }

    pub(crate) fn miss(&self, phrase: &Phrase, miss: Miss, intent: Intent, role: Option<Role>) -> Fault {
        let slot = role.map(|role| Slot { clause: self.clause, role });
        Fault::Miss { slot, phrase: Box::new(phrase.clone()), miss, intent }
    }

    /// That something of these classes is needed.
    pub(crate) fn need(&self, classes: &[ClassId], text: impl Into<String>) -> Fault {
        Fault::Need { classes: classes.to_vec(), text: text.into() }
    }

    /// Whether all that it can do about what it has not seen is to look around.
    fn looks_about(&self) -> bool {
        self.scene.floor.is_none() && !self.has_looked
    }

    /// Whether one of these classes is needed that may be found yet.
    pub(crate) fn may_find(&self, classes: &[ClassId]) -> bool {
        self.scene.floor.is_some() && !self.scene.objects.iter().any(|object| classes.contains(&object.class))
    }

    pub(crate) fn find_each(
        &self,
        phrase: &Phrase,
        want: &Want<'_>,
        role: Option<Role>,
    ) -> Result<Vec<ObjectId>, Fault> {
        if self.is_group(phrase) {
            return Ok(self.focus.group.clone());
        }
        if phrase.is_all {
            return self.ground().all(phrase, want).map_err(|miss| self.miss(phrase, miss, want.intent, role));
        }
        Ok(vec![self.find_one(phrase, want, role)?])
    }

    /// `them`, of several that were spoken of together.
    fn is_group(&self, phrase: &Phrase) -> bool {
        phrase.pronoun == Some(Pronoun::Things) && phrase.chosen.is_none() && self.focus.group.len() > 1
    }

    pub(crate) fn has(&self, object: ObjectId, property: Property) -> bool {
        self.scene.object(object).is_some_and(|object| self.catalog.class(object.class).has(property))
    }

    /// Opens what encloses an object, from the outside in, and says so.
    pub(crate) fn open_around(&mut self, object: ObjectId, with_itself: bool) {
        let mut around = self.around(object);
        around.extend(with_itself.then_some(object));
        for id in around {
            if self.is_shut(id) {
                self.notes.push(format!("{} is closed, so I open it first", self.the(id)));
                self.interact(Verb::Open, id, "opening");
            }
        }
    }

    /// What an object is in, from the outside in. A machine that cannot be carried stands on its parent: a microwave on
    /// a cupboard is not in the cupboard.
    pub(crate) fn around(&self, object: ObjectId) -> Vec<ObjectId> {
        let mut around = Vec::new();
        let mut child = object;
        for parent in self.scene.ancestors(object) {
            if !self.has(child, Property::Pickupable) {
                break;
            }
            around.push(parent.id);
            child = parent.id;
        }
        around.reverse();
        around
    }

    /// Whether its door keeps things in and could be opened.
    pub(crate) fn is_shut(&self, id: ObjectId) -> bool {
        self.scene.object(id).is_some_and(|object| {
            let class = self.catalog.class(object.class);
            let encloses = class.receptacle.as_ref().is_some_and(|receptacle| receptacle.enclosed);
            encloses
                && class.has(Property::Openable)
                && !object.has(StateFlag::Opened)
                && !object.has(StateFlag::Locked)
        })
    }
}
