//! Missions parted for training, and for tests of what was never seen in training.
//!
//! Some floor plans, rooms, objects and compositions are held out: no mission that is trained with plays on such a floor plan, has a
//! plan that leads to such a room, or a goal about such an object. The object may stand about in it all the same: as something that
//! no goal is about, or as a part of the floor plan. A composition is a type of missions with a class of object, both of which are
//! trained with, but not together.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use crate::chance::Chance;

/// The draws of splits; missions have lower streams of their own.
const STREAM: u64 = u64::MAX;
/// How much more than asked a part may get: values come whole.
const SLACK: f64 = 1.5;

/// What tells a mission from others.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Facets {
    /// Its type.
    pub kind: String,
    /// Its floor plan.
    pub floor_plan: String,
    /// The rooms that its plan leads to.
    pub rooms: Vec<String>,
    /// The classes of the things that its goals are about.
    pub things: Vec<String>,
}

impl Facets {
    /// The values that it has of what is held out in a part.
    fn values(&self, part: Part) -> Vec<String> {
        match part {
            Part::UnseenFloorPlan => vec![self.floor_plan.clone()],
            Part::UnseenRoom => self.rooms.clone(),
            Part::UnseenObject => self.things.clone(),
            Part::UnseenComposition => self.things.iter().map(|thing| format!("{} {thing}", self.kind)).collect(),
            Part::Train | Part::Seen | Part::UnseenSeveral => Vec::new(),
        }
    }

    fn has_any(&self, part: Part, held_out: &[String]) -> bool {
        self.values(part).iter().any(|value| held_out.contains(value))
    }
}

/// One of the sets that missions are parted into.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Part {
    /// For training.
    Train,
    /// For tests of what was seen in training: other missions of the same kinds.
    Seen,
    /// An object that no goal of the training is about; it may stand about there.
    UnseenObject,
    /// A room that no plan of the training leads to.
    UnseenRoom,
    /// A floor plan that the training has not.
    UnseenFloorPlan,
    /// A type with an object that it does not have in the training, though both are there.
    UnseenComposition,
    /// More than one of these at once.
    UnseenSeveral,
}

impl Part {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Train,
        Self::Seen,
        Self::UnseenObject,
        Self::UnseenRoom,
        Self::UnseenFloorPlan,
        Self::UnseenComposition,
        Self::UnseenSeveral,
    ];

    /// Those of which something is held out, in the order in which it is chosen.
    const UNSEEN: [Self; 4] = [Self::UnseenFloorPlan, Self::UnseenRoom, Self::UnseenObject, Self::UnseenComposition];

    /// Its name, as in names of files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Train => "train",
            Self::Seen => "seen",
            Self::UnseenObject => "unseen-object",
            Self::UnseenRoom => "unseen-room",
            Self::UnseenFloorPlan => "unseen-floor-plan",
            Self::UnseenComposition => "unseen-composition",
            Self::UnseenSeveral => "unseen-several",
        }
    }
}

/// What no mission of the training has, by part; a part of which there were too few values has nothing.
pub type HeldOut = BTreeMap<Part, Vec<String>>;

/// Missions, parted.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Parted {
    /// What is held out.
    pub held_out: HeldOut,
    /// The part of each mission, in their order.
    pub parts: Vec<Part>,
}

/// Parts missions. Each part but the training gets about that share of them, from 0 to 1, as far as values can be held out; the
/// same seed parts them the same.
#[must_use]
pub fn part(missions: &[Facets], share: f64, seed: u64) -> Parted {
    let mut chance = Chance::new(seed, STREAM);
    let mut held_out = HeldOut::new();
    for part in Part::UNSEEN {
        let left: Vec<&Facets> = missions.iter().filter(|mission| unseen(mission, &held_out).is_empty()).collect();
        let chosen = hold_out(part, &left, share * missions.len() as f64, &mut chance);
        held_out.insert(part, chosen);
    }
    let parts = missions.iter().map(|mission| match unseen(mission, &held_out).as_slice() {
        [] if chance.is(share) => Part::Seen,
        [] => Part::Train,
        [one] => *one,
        _ => Part::UnseenSeveral,
    });
    let parts = parts.collect();
    Parted { held_out, parts }
}

/// The parts of which a mission has something that is held out.
fn unseen(mission: &Facets, held_out: &HeldOut) -> Vec<Part> {
    held_out.iter().filter(|(part, values)| mission.has_any(**part, values)).map(|(part, _)| *part).collect()
}

/// Chooses values to hold out, so that about so many of the missions have one.
fn hold_out(part: Part, missions: &[&Facets], wanted: f64, chance: &mut Chance) -> Vec<String> {
    let values: BTreeSet<String> = missions.iter().flat_map(|mission| mission.values(part)).collect();
    let mut values: Vec<String> = values.into_iter().collect();
    shuffle(&mut values, chance);
    let count = |chosen: &[String]| missions.iter().filter(|mission| mission.has_any(part, chosen)).count();
    let mut chosen = Vec::new();
    for value in &values {
        if count(&chosen) as f64 >= wanted {
            break;
        }
        chosen.push(value.clone());
        let fits = count(&chosen) as f64 <= wanted * SLACK;
        if !fits || !leaves_enough(part, missions, &chosen) {
            chosen.pop();
        }
    }
    if chosen.is_empty() {
        // The rarest one, if all are common: better more than asked than none.
        let rarest = values.iter().min_by_key(|value| count(std::slice::from_ref(*value)));
        chosen.extend(rarest.filter(|value| leaves_enough(part, missions, std::slice::from_ref(*value))).cloned());
    }
    chosen.sort_unstable();
    chosen
}

/// Whether there is something left to train with; of a composition, both its halves.
fn leaves_enough(part: Part, missions: &[&Facets], chosen: &[String]) -> bool {
    let left: Vec<&&Facets> = missions.iter().filter(|mission| !mission.has_any(part, chosen)).collect();
    if part != Part::UnseenComposition {
        return !left.is_empty();
    }
    chosen.iter().all(|value| {
        let Some((kind, thing)) = value.rsplit_once(' ') else { return false };
        left.iter().any(|mission| mission.kind == kind)
            && left.iter().any(|mission| mission.things.iter().any(|one| one == thing))
    })
}

fn shuffle(values: &mut [String], chance: &mut Chance) {
    for last in (1..values.len()).rev() {
        values.swap(last, chance.below(last + 1));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn missions() -> Vec<Facets> {
        let name = |stem: &str, number: usize| format!("{stem}{number}");
        let mission = |number: usize| Facets {
            kind: name("type", number % 5),
            floor_plan: name("plan", number % 7),
            rooms: vec![name("room", number % 6), name("room", (number / 6) % 6)],
            things: vec![name("thing", number % 11)],
        };
        (0..2000).map(mission).collect()
    }

    #[test]
    fn nothing_that_is_held_out_is_trained_with() {
        let missions = missions();
        let Parted { held_out, parts } = part(&missions, 0.1, 7);
        for (mission, part) in missions.iter().zip(&parts) {
            let unseen = unseen(mission, &held_out);
            match part {
                Part::Train | Part::Seen => assert!(unseen.is_empty(), "{mission:?}"),
                Part::UnseenSeveral => assert!(unseen.len() > 1, "{mission:?}"),
                one => assert_eq!(unseen, [*one], "{mission:?}"),
            }
        }
        for one in Part::ALL {
            let count = parts.iter().filter(|part| **part == one).count();
            assert!(count > 0, "{one:?} has no missions: {held_out:?}");
        }
    }

    #[test]
    fn both_halves_of_a_composition_are_trained_with() {
        let missions = missions();
        let Parted { held_out, parts } = part(&missions, 0.1, 3);
        let compositions = &held_out[&Part::UnseenComposition];
        assert!(!compositions.is_empty());
        let trained: Vec<&Facets> =
            missions.iter().zip(&parts).filter(|(_, part)| **part == Part::Train).map(|(mission, _)| mission).collect();
        for composition in compositions {
            let (kind, thing) = composition.split_once(' ').unwrap_or_default();
            assert!(trained.iter().any(|mission| mission.kind == kind), "{composition}");
            assert!(trained.iter().any(|mission| mission.things.contains(&thing.to_owned())), "{composition}");
        }
    }

    #[test]
    fn the_same_seed_parts_them_the_same() {
        let missions = missions();
        assert_eq!(part(&missions, 0.1, 7), part(&missions, 0.1, 7));
        assert_ne!(part(&missions, 0.1, 7), part(&missions, 0.1, 8));
    }

    #[test]
    fn what_there_is_one_of_is_not_held_out() {
        let one = Facets {
            kind: "type".to_owned(),
            floor_plan: "plan".to_owned(),
            rooms: vec!["room".to_owned()],
            things: vec!["thing".to_owned()],
        };
        let Parted { held_out, parts } = part(&[one.clone(), one], 0.1, 1);
        assert!(held_out.values().all(Vec::is_empty), "{held_out:?}");
        assert!(parts.iter().all(|part| matches!(part, Part::Train | Part::Seen)));
        assert!(part(&[], 0.1, 1).parts.is_empty());
    }
}
