//! The generator: drafts drawn, certified, and kept once.

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::{
        Arc, Mutex,
        atomic::{AtomicUsize, Ordering},
    },
};

use cohabit_cdf::{Catalog, Layout, LayoutError};
use serde_json::{Value, json};

use crate::{
    certify::{Certificate, certify},
    chance::Chance,
    draft::Draft,
    spec::{MissionType, Spec},
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
            "difficulty": { "actions": deeds, "walks": plan.len() - deeds, "rooms": rooms, "expanded": expanded },
            "plan": plan,
            "certificate": self.certificate,
            "cdf": self.cdf,
        })
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
        if spec.pools.layouts.is_empty() { Layout::builtin_ids().to_vec() } else { spec.pools.layouts.clone() };
    let layouts = ids.iter().map(|id| Layout::builtin(id)).collect::<Result<Vec<_>, _>>()?;
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
        let taken = AtomicUsize::new(0);
        let done = Mutex::new(Vec::new());
        std::thread::scope(|scope| {
            for _ in 0..workers.clamp(1, count.max(1)) {
                scope.spawn(|| {
                    loop {
                        let number = taken.fetch_add(1, Ordering::Relaxed);
                        if number >= count {
                            break;
                        }
                        let mission = self.one(first + number);
                        if let Ok(mut done) = done.lock() {
                            done.push((number, mission));
                        }
                    }
                });
            }
        });
        let mut done = done.into_inner().unwrap_or_default();
        done.sort_by_key(|(number, _)| *number);
        done.into_iter().map(|(_, mission)| mission).collect()
    }

    fn one(&self, number: usize) -> Result<Generated, String> {
        let kind = self.kind(number);
        let mut chance = Chance::new(self.seed, number as u64);
        let mut reason = "what chance chose did not go together".to_owned();
        for _ in 0..MOST_DRAFTS {
            let layout = &self.layouts[chance.below(self.layouts.len())];
            let Some(cdf) = Draft::new(self.catalog, layout, &self.spec.pools, &mut chance).draw(kind) else {
                continue;
            };
            match certify(&kind.name, &cdf.to_string(), self.catalog, self.seed) {
                Ok(certificate) if is_as_long_as_asked(kind, &certificate) => {
                    let (id, kind) = (String::new(), kind.name.clone());
                    return Ok(Generated { id, kind, cdf, certificate });
                }
                Ok(_) => reason = "plans are shorter or longer than `steps` asks".to_owned(),
                Err(why) => reason = why,
            }
        }
        Err(reason)
    }
}

fn is_as_long_as_asked(kind: &MissionType, certificate: &Certificate) -> bool {
    let deeds = certificate.plan.iter().filter(|step| step.action != "go_to").count();
    // What is met from the beginning is no mission.
    deeds > 0 && kind.steps.is_none_or(|[fewest, most]| (fewest..=most).contains(&deeds))
}
