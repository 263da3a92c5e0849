//! Requests that make sense in a scene, by how like they are to what was said.

use std::{collections::HashMap, sync::LazyLock};

use cohabit_cdf::{ObjectId, Property, RoomId};
use serde::Deserialize;

use crate::{
    conversation::Conversation,
    ground::fitting_state,
    intent::Intent,
    known::KnownObject,
    likeness::{Likeness, SHARPNESS, UNLIKE},
};

static REQUESTS: LazyLock<Requests> = LazyLock::new(|| {
    toml::from_str(include_str!("../data/requests.toml"))
        .expect("invariant: the built-in requests parse, which a test holds")
});

/// `data/requests.toml`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Requests {
    others: Vec<String>,
    of_things: Vec<OfThing>,
}

/// What may be asked of any thing that affords it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct OfThing {
    request: String,
    #[serde(default)]
    affords: Vec<Property>,
    intent: Option<Intent>,
}

/// What speaks for a thing beside its likeness.
const SAME_ROOM: f32 = 0.4;
const IN_MISSION: f32 = 0.4;
const IS_GOAL: f32 = 0.5;
const STATE_FITS: f32 = 0.5;
const STATE_IS_SO: f32 = -1.0;
const SPOKEN_OF: f32 = 2.0;
/// How many requests are told at most.
const MOST: usize = 6;

/// A request that may be meant.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Likely {
    /// In plain words.
    pub(crate) request: String,
    /// How likely it is the one that is meant, if any of them is.
    pub(crate) probability: f32,
}

/// All plain requests of things with this name and these properties.
pub(crate) fn of_thing(name: &str, has: impl Fn(Property) -> bool) -> impl Iterator<Item = (Option<Intent>, String)> {
    let afforded = REQUESTS
        .of_things
        .iter()
        .filter(move |entry| entry.affords.is_empty() || entry.affords.iter().any(|property| has(*property)));
    afforded.map(move |entry| (entry.intent, entry.request.replace("{}", name)))
}

/// Plain requests that name no thing of a scene.
pub(crate) fn others() -> impl Iterator<Item = String> {
    let rooms = RoomId::ALL.iter().map(|room| format!("go to the {}", room.name()));
    REQUESTS.others.iter().cloned().chain(rooms)
}

impl Conversation<'_> {
    /// The requests that are most like what was said, the likeliest first; `spoken_of` is what may be left unnamed in it.
    pub(crate) fn likely_requests(&self, utterance: &str, spoken_of: &[ObjectId]) -> Vec<Likely> {
        if !utterance.contains(char::is_alphanumeric) {
            return Vec::new();
        }
        let likeness = Likeness::builtin();
        let said = likeness.of(utterance);
        let utility = |request: &str| likeness.to_request(&said, request) / SHARPNESS;
        let mut ranked: Vec<(f32, String)> = others().map(|request| (utility(&request), request)).collect();
        for (name, objects) in self.things_by_name() {
            let Some(first) = objects.first() else { continue };
            let class = self.catalog.class(first.class);
            let of_thing = of_thing(name, |property| class.has(property));
            let is_spoken_of = objects.iter().any(|object| spoken_of.contains(&object.id));
            let spoken = if is_spoken_of { SPOKEN_OF } else { 0.0 };
            let utility = |(intent, request): (Option<Intent>, String)| {
                (utility(&request) + self.fit(intent, &objects) + spoken, request)
            };
            ranked.extend(of_thing.map(utility));
        }
        let mission = Some(&self.scene.mission).filter(|mission| !mission.is_empty());
        let goals = self.open_goals().chain(mission.map(String::as_str));
        ranked.extend(goals.map(|goal| (utility(goal) + IS_GOAL, goal.to_owned())));
        ranked.sort_by(|(one, a), (other, b)| other.total_cmp(one).then_with(|| a.cmp(b)));
        let highest = ranked.first().map_or(0.0, |(utility, _)| *utility);
        let unlike = (UNLIKE / SHARPNESS - highest).exp();
        let whole: f32 = ranked.iter().map(|(utility, _)| (utility - highest).exp()).sum::<f32>() + unlike;
        let likely = ranked
            .into_iter()
            .take(MOST)
            .map(|(utility, request)| Likely { request, probability: (utility - highest).exp() / whole });
        likely.collect()
    }

    /// The things of the scene, those of one name together.
    pub(crate) fn things_by_name(&self) -> Vec<(&str, Vec<&KnownObject>)> {
        let mut things: Vec<(&str, Vec<&KnownObject>)> = Vec::new();
        let mut places: HashMap<&str, usize> = HashMap::new();
        for object in &self.scene.objects {
            let name = self.catalog.names(object.class).plain.as_str();
            let place = *places.entry(name).or_insert_with(|| {
                things.push((name, Vec::new()));
                things.len() - 1
            });
            things[place].1.push(object);
        }
        things
    }

    /// What speaks for a request beside its words.
    fn fit(&self, intent: Option<Intent>, objects: &[&KnownObject]) -> f32 {
        let fits: Vec<Option<bool>> = objects.iter().map(|object| fitting_state(intent?, object)).collect();
        let by_state = match fits.as_slice() {
            fits if fits.contains(&Some(true)) => STATE_FITS,
            fits if fits.contains(&None) => 0.0,
            _ => STATE_IS_SO,
        };
        by_state + self.nearness(objects)
    }

    /// What speaks for the nearest of some things.
    pub(crate) fn nearness(&self, objects: &[&KnownObject]) -> f32 {
        let is_here = objects.iter().any(|object| object.room == self.scene.robot.room);
        let in_mission = objects.iter().any(|object| object.in_mission);
        SAME_ROOM * f32::from(u8::from(is_here)) + IN_MISSION * f32::from(u8::from(in_mission))
    }
}
