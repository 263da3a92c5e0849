//! The generator: drafts drawn, certified, and kept once.

use std::{
    collections::{BTreeMap, BTreeSet},
    convert::Infallible,
    sync::Arc,
};

use cohabit_cdf::{ActionKind, Catalog, Layout, LayoutError};
use serde_json::{Value, json};

use crate::{
    certify::{Certificate, certify},
    chance::Chance,
    draft::{Blocker, Draft, Drawn, with_lock},
    side_by_side::side_by_side,
    spec::{BlockerKind, MissionType, Spec},
    splits::Facets,
};

/// Drafts of one mission that are tried before it is given up.
const MOST_DRAFTS: usize = 60;
/// Missions in a row that are given up, or made before, until there seem to be no more.
const MOST_MISSES: usize = 100;
/// Missions that the workers take at a time.
const BATCH: usize = 64;

/// Why no missions could be made.
#[derive(Debug, thiserror::Error)]
pub enum GenerateError {
    /// A floor plan cannot be had.
    #[error("make missions: {0}")]
    Layout(#[from] LayoutError),
    /// A type has no missions that can be solved, or no new ones.
    #[error(
        "make missions: after {made} of them no new one of the type `{kind}` was found in {MOST_DRAFTS} drafts: {reason}; \
         leave it out, or widen its pools"
    )]
    Exhausted {
        /// How many were made.
        made: usize,
        /// The type.
        kind: String,
        /// Why the last draft was given up.
        reason: String,
    },
}

/// What is to be made.
#[derive(Clone, Copy, Debug)]
pub struct Order {
    /// How many missions.
    pub count: usize,
    /// What all draws follow from.
    pub seed: u64,
    /// Threads that work at it; they do not change what comes of it.
    pub workers: usize,
}

/// Missions of a type that were given up.
#[derive(Clone, Debug, Default, Eq, PartialEq)]
pub struct GivenUp {
    /// How many.
    pub count: usize,
    /// Why the last one was.
    pub reason: String,
}

/// A mission with its certificate.
#[derive(Clone, Debug)]
pub struct Generated {
    /// Its name: the type, and its number.
    pub id: String,
    /// Its type.
    pub kind: String,
    /// The mission file.
    pub cdf: Value,
    /// What stands in the way of its goals, if anything was put there.
    pub blocker: Option<Blocker>,
    /// The classes of the things that were drawn for its goals.
    pub things: Vec<String>,
    /// The classes of things that its goals name themselves, as in `Carrot_01_* isPickedUp=true`.
    pub named: Vec<String>,
    /// That, and how, it is solved.
    pub certificate: Certificate,
}

impl Generated {
    /// As a line of a file of missions, which `eval` and `check` read.
    #[must_use]
    pub fn as_line(&self) -> Value {
        let Certificate { plan, rooms, expanded, .. } = &self.certificate;
        let deeds = plan.iter().filter(|step| step.action != "go_to").count();
        let said: Vec<&str> = plan.iter().map(|step| step.said.as_str()).collect();
        json!({
            "id": self.id,
            "type": self.kind,
            "layout": self.cdf["scene"]["layoutOverride"],
            "preparation_utterances": [],
            "utterances": said,
            "difficulty": { "actions": deeds, "walks": plan.len() - deeds, "rooms": rooms.len(), "expanded": expanded },
            "blockers": self.blocker.iter().collect::<Vec<_>>(),
            "things": self.all_things(),
            "rooms": rooms.iter().map(|room| room.id()).collect::<Vec<_>>(),
            "plan": plan,
            "certificate": self.certificate,
            "cdf": self.cdf,
        })
    }

    /// What tells it from others where missions are parted for training and tests.
    #[must_use]
    pub fn facets(&self) -> Facets {
        Facets {
            kind: self.kind.clone(),
            floor_plan: self.cdf["scene"]["layoutOverride"].as_str().unwrap_or_default().to_owned(),
            rooms: self.certificate.rooms.iter().map(|room| room.id().to_owned()).collect(),
            things: self.all_things(),
        }
    }

    /// The classes of all things that its goals are about.
    fn all_things(&self) -> Vec<String> {
        let all: BTreeSet<&String> = self.things.iter().chain(&self.named).collect();
        all.into_iter().cloned().collect()
    }
}

/// Makes missions, all types in turn, and hands each over in order; says what was given up, by type.
///
/// # Errors
/// [`GenerateError`].
pub fn generate(
    spec: &Spec,
    catalog: &Arc<Catalog>,
    order: Order,
    take: &mut dyn FnMut(Generated),
) -> Result<BTreeMap<String, GivenUp>, GenerateError> {
    let ids: Vec<String> =
        if spec.pools.layouts.is_empty() { Layout::builtin_ids() } else { spec.pools.layouts.clone() };
    let layouts = ids.iter().map(|id| Layout::find(id, catalog)).collect::<Result<Vec<_>, _>>()?;
    let maker = Maker { spec, catalog, layouts, seed: order.seed };
    let (mut seen, mut made, mut misses, mut next) = (BTreeSet::new(), 0, 0, 0);
    let mut given_up = BTreeMap::<String, GivenUp>::new();
    while made < order.count {
        let size = BATCH.min(order.count - made).max(order.workers);
        let batch = maker.batch(next, size, order.workers);
        for (number, drawn) in (next..).zip(batch) {
            if made == order.count {
                break;
            }
            let kind = maker.kind(number);
            let (is_new, reason) = match &drawn {
                Ok(mission) => (seen.insert(content(&mission.cdf)), "all that were drawn were made before".to_owned()),
                Err(reason) => (false, reason.clone()),
            };
            match drawn {
                Ok(mission) if is_new => {
                    misses = 0;
                    take(Generated { id: format!("{}-{made:05}", kind.name), ..mission });
                    made += 1;
                }
                _ if misses >= MOST_MISSES || made == 0 && misses >= spec.types.len() => {
                    return Err(GenerateError::Exhausted { made, kind: kind.name.clone(), reason });
                }
                _ => {
                    misses += 1;
                    let noted = given_up.entry(kind.name.clone()).or_default();
                    *noted = GivenUp { count: noted.count + 1, reason };
                }
            }
        }
        next += size;
    }
    Ok(given_up)
}

/// What makes two missions the same: where it plays, what is there, what is wanted.
fn content(cdf: &Value) -> String {
    let scene = &cdf["scene"];
    format!(
        "{} {} {} {} {}",
        scene["layoutOverride"],
        scene["roomLocation"],
        scene["required_objects"],
        cdf["task_goals"],
        cdf["stateconditions"]
    )
}

struct Maker<'a> {
    spec: &'a Spec,
    catalog: &'a Arc<Catalog>,
    layouts: Vec<Layout>,
    seed: u64,
}

impl Maker<'_> {
    fn kind(&self, number: usize) -> &MissionType {
        &self.spec.types[number % self.spec.types.len()]
    }

    /// The missions of these numbers, in order; workers take one after the other.
    fn batch(&self, first: usize, count: usize, workers: usize) -> Vec<Result<Generated, String>> {
        let mut workers = vec![(); workers.clamp(1, count.max(1))];
        let Ok(missions) =
            side_by_side(&mut workers, first..first + count, |(), number| Ok::<_, Infallible>(self.one(number)));
        missions
    }

    fn one(&self, number: usize) -> Result<Generated, String> {
        let kind = self.kind(number);
        let mut chance = Chance::new(self.seed, number as u64);
        let mut reason = "what chance chose did not go together".to_owned();
        let wanted = self.blocker(&mut chance);
        for draft in 0..MOST_DRAFTS {
            let layout = &self.layouts[chance.below(self.layouts.len())];
            // Where nothing that is put in the way is in anybody's way, the mission goes without.
            let blocker = wanted.filter(|_| draft < MOST_DRAFTS / 2);
            let Some(drawn) = Draft::new(self.catalog, layout, &self.spec.pools, &mut chance).draw(kind, blocker)
            else {
                continue;
            };
            match self.certified(kind, drawn, blocker) {
                Ok(mission) => return Ok(mission),
                Err(why) => reason = why,
            }
        }
        Err(reason)
    }

    /// What is to stand in the way of a mission, if anything is.
    fn blocker(&self, chance: &mut Chance) -> Option<BlockerKind> {
        let pools = &self.spec.pools;
        // Without blockers nothing is drawn: the missions of a seed stay the same.
        if pools.blockers == 0.0 || !chance.is(pools.blockers) {
            return None;
        }
        let all: &[BlockerKind] = &BlockerKind::ALL;
        let kinds = if pools.blocker_kinds.is_empty() { all } else { pools.blocker_kinds.as_slice() };
        chance.pick(kinds).copied()
    }

    /// The mission of a draft: as long as asked, and with its blocker in the way.
    fn certified(&self, kind: &MissionType, drawn: Drawn, wanted: Option<BlockerKind>) -> Result<Generated, String> {
        let Drawn { mut cdf, mut blocker, things, named } = drawn;
        let mut certificate = self.certify(kind, &cdf)?;
        if wanted == Some(BlockerKind::Locked) {
            let opened = certificate.plan.iter().find(|step| step.action == ActionKind::Open.name());
            let instance = opened.ok_or("its plan opens nothing that could be locked")?.object.clone();
            cdf = with_lock(&cdf, &instance);
            certificate = self.certify(kind, &cdf)?;
            blocker = Some(Blocker { kind: BlockerKind::Locked, instance });
        }
        if !is_as_long_as_asked(kind, &certificate) {
            return Err("plans are shorter or longer than `steps` asks".to_owned());
        }
        if self.spec.pools.all_open && certificate.met_at_first > 0 {
            return Err("a goal is met as the mission begins".to_owned());
        }
        let is_in_the_way = blocker
            .as_ref()
            .is_none_or(|blocker| (blocker.kind == BlockerKind::Locked) != uses(&certificate, &blocker.instance));
        if !is_in_the_way {
            return Err("what was put in the way was in nobody's way".to_owned());
        }
        Ok(Generated { id: String::new(), kind: kind.name.clone(), cdf, blocker, things, named, certificate })
    }

    fn certify(&self, kind: &MissionType, cdf: &Value) -> Result<Certificate, String> {
        certify(&kind.name, &cdf.to_string(), self.catalog, self.seed)
    }
}

/// Whether a plan does anything with a thing.
fn uses(certificate: &Certificate, instance: &str) -> bool {
    certificate.plan.iter().any(|step| step.object == instance)
}

fn is_as_long_as_asked(kind: &MissionType, certificate: &Certificate) -> bool {
    let deeds = certificate.plan.iter().filter(|step| step.action != "go_to").count();
    // What is met from the beginning is no mission.
    deeds > 0 && kind.steps.is_none_or(|[fewest, most]| (fewest..=most).contains(&deeds))
}
