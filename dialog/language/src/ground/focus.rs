//! What a conversation is about: what `it`, `there` and such may stand for.

use cohabit_cdf::{Action, GoToTarget, ObjectId, RoomId};
use serde::{Deserialize, Serialize};

use crate::{
    known::{Known, ON_FLOOR_M},
    read::phrase::Phrase,
};

/// How many objects a pronoun may reach back.
const MEMORY: usize = 8;

/// Of how many things it is remembered where they were at first: those of a long session.
const FIRSTS: usize = 120;

/// What the conversation is about.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub(crate) struct Focus {
    /// The objects spoken of, the latest first.
    pub(crate) recent: Vec<ObjectId>,
    /// Several that were spoken of together.
    #[serde(default)]
    pub(crate) group: Vec<ObjectId>,
    /// The last thing gone to, opened or put things into.
    pub(crate) place: Option<ObjectId>,
    /// The room spoken of last, if it was spoken of after that.
    #[serde(default)]
    pub(crate) room: Option<RoomId>,
    /// What was taken, and from where, the latest first.
    pub(crate) origins: Vec<(ObjectId, ObjectId)>,
    /// What was taken from the floor, and of which room, the latest first.
    #[serde(default)]
    pub(crate) off_floor: Vec<(ObjectId, RoomId)>,
    /// Where each thing was before it was taken for the first time; nothing, where it lay on the floor.
    #[serde(default)]
    pub(crate) firsts: Vec<(ObjectId, Option<ObjectId>)>,
    /// What was put somewhere last.
    pub(crate) placed: Option<ObjectId>,
    /// Where the robot stood when it last set out, m.
    pub(crate) start_m: Option<[f32; 2]>,
    /// What was spoken of last, if that has not been seen: what `it` then stands for.
    #[serde(default)]
    pub(crate) unseen: Option<Phrase>,
}

impl Focus {
    pub(crate) fn mention(&mut self, object: ObjectId) {
        self.recent.retain(|known| *known != object);
        self.recent.insert(0, object);
        self.unseen = None;
        self.recent.truncate(MEMORY);
    }

    /// Remembers what is taken from where, and what is put down, before the step is done.
    pub(crate) fn remember(&mut self, scene: &Known, action: &Action) {
        match *action {
            Action::PickUp { object } => {
                let Some(taken) = scene.object(object) else { return };
                // What somebody else holds is on nothing either.
                if taken.parent.is_none() && taken.position_m[2] > ON_FLOOR_M {
                    return;
                }
                if self.firsts.iter().all(|(other, _)| *other != object) {
                    self.firsts.insert(0, (object, taken.parent));
                    self.firsts.truncate(FIRSTS);
                }
                self.origins.retain(|(other, _)| *other != object);
                self.off_floor.retain(|(other, _)| *other != object);
                match taken.parent {
                    Some(origin) => self.origins.insert(0, (object, origin)),
                    None => self.off_floor.insert(0, (object, taken.room)),
                }
                self.origins.truncate(MEMORY);
                self.off_floor.truncate(MEMORY);
            }
            Action::Place { .. } | Action::PlaceBeside { .. } => self.placed = scene.robot.held,
            _ => {}
        }
    }

    /// `them` are the things that were taken together, where no others were spoken of together.
    pub(crate) fn group_taken<'a>(&mut self, actions: impl Iterator<Item = &'a Action>) {
        let mut taken: Vec<ObjectId> = Vec::new();
        for action in actions {
            if let Action::PickUp { object } = action
                && !taken.contains(object)
            {
                taken.push(*object);
            }
        }
        if taken.len() > 1 && self.group.len() < 2 {
            self.group = taken;
        }
    }

    /// Follows what a step is about.
    pub(crate) fn follow(&mut self, action: &Action) {
        match *action {
            Action::GoTo { target: GoToTarget::Object(object) } => {
                self.mention(object);
                (self.place, self.room) = (Some(object), None);
            }
            Action::GoTo { target: GoToTarget::Room(room) } => (self.place, self.room) = (None, Some(room)),
            Action::GoTo { .. } => (self.place, self.room) = (None, None),
            Action::Place { receptacle } | Action::PlaceBeside { receptacle, .. } => {
                (self.place, self.room) = (Some(receptacle), None);
            }
            Action::PickUp { object } | Action::Highlight { object } => {
                if !self.group.contains(&object) {
                    self.group.clear();
                }
                self.mention(object);
            }
            Action::Interact { verb, object } => {
                self.mention(object);
                if matches!(verb, cohabit_cdf::Verb::Open) {
                    self.place = Some(object);
                }
            }
            Action::Move { .. }
            | Action::Rotate { .. }
            | Action::Look { .. }
            | Action::LookAround
            | Action::Stop
            | Action::Drive { .. } => {}
        }
    }
}
