//! A submission checked: every episode is played again, and every figure worked out again.

use std::{
    collections::{BTreeMap, BTreeSet},
    convert::Infallible,
};

use cohabit_cdf::PackId;
use cohabit_generate::side_by_side;

use crate::{
    benchmark::Benchmark,
    episode::Episode,
    mission::{Mission, Split},
    replay::play_again,
    submission::{Header, Submission},
    totals::{Tally, Totals, totals},
};

/// Something in a submission that is not so.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Difference {
    /// It is of another benchmark; nothing else is compared.
    #[error("{field} of the benchmark: {claimed} in the file, {found} here")]
    Benchmark {
        /// What of it differs.
        field: &'static str,
        /// As the file has it.
        claimed: String,
        /// As it is here.
        found: String,
    },
    /// A line is no episode.
    #[error("line {number}: not an episode: {reason}")]
    Line {
        /// Which, from 1.
        number: usize,
        /// What is wrong.
        reason: String,
    },
    /// A mission was not played.
    #[error("{mission}: missing")]
    Missing {
        /// Which.
        mission: String,
    },
    /// A mission is there more than once.
    #[error("{mission}: more than once, again on line {number}")]
    Doubled {
        /// Which.
        mission: String,
        /// The line, from 1.
        number: usize,
    },
    /// An episode is of a mission that was not to be played.
    #[error("{mission}: no mission of the splits that were played (line {number})")]
    Unknown {
        /// Which.
        mission: String,
        /// The line, from 1.
        number: usize,
    },
    /// A mission has no world here.
    #[error("{mission}: cannot be played again: {reason}")]
    Unplayable {
        /// Which.
        mission: String,
        /// Why.
        reason: String,
    },
    /// What came of an episode.
    #[error("{mission}: {field}: {claimed} in the file, {found} when played again")]
    Field {
        /// The mission.
        mission: String,
        /// What of it differs.
        field: &'static str,
        /// As the file has it.
        claimed: String,
        /// As it is.
        found: String,
    },
    /// A figure of several episodes.
    #[error("totals of {place}: {claimed} in the file, {found} when worked out again")]
    Totals {
        /// Of which.
        place: String,
        /// As the file has them.
        claimed: String,
        /// As they are.
        found: String,
    },
}

/// All that is not so in a submission, in its order; nothing, if it holds. So many episodes are played at a time; `done` is told of
/// each.
#[must_use]
pub fn verify(
    benchmark: &Benchmark,
    submission: &Submission,
    workers: usize,
    done: &(dyn Fn() + Sync),
) -> Vec<Difference> {
    let header = &submission.header;
    let mut differences = of_benchmark(benchmark, header);
    if !differences.is_empty() {
        return differences;
    }
    let claimed = sorted(benchmark, submission, &mut differences);
    let mut threads = vec![(); workers.clamp(1, claimed.len().max(1))];
    let Ok(played) = side_by_side(&mut threads, 0..claimed.len(), |(), number| {
        let (mission, episode) = claimed[number];
        let again = play_again(benchmark, mission, &episode.recording());
        done();
        Ok::<_, Infallible>(again)
    });
    let mut episodes = Vec::new();
    for ((_, claimed), played) in claimed.into_iter().zip(played) {
        match played {
            Ok(found) => {
                differences.extend(of_episode(claimed, &found));
                episodes.push(found);
            }
            Err(reason) => differences.push(Difference::Unplayable { mission: claimed.mission.clone(), reason }),
        }
    }
    differences.extend(of_totals(header.totals.as_ref(), &totals(benchmark, &episodes)));
    differences
}

/// How the benchmark that was played differs from this one.
fn of_benchmark(benchmark: &Benchmark, header: &Header) -> Vec<Difference> {
    let named = |packs: &[PackId]| match packs {
        [] => "none".to_owned(),
        packs => packs.iter().map(ToString::to_string).collect::<Vec<_>>().join(", "),
    };
    let fields = [
        ("version", header.benchmark.to_string(), benchmark.version.to_string()),
        ("digest", header.missions.clone(), benchmark.digest.clone()),
        ("world packs", named(&header.world), named(benchmark.catalog.packs())),
    ];
    let differ = fields.into_iter().filter(|(_, claimed, found)| claimed != found);
    let mut differences: Vec<Difference> =
        differ.map(|(field, claimed, found)| Difference::Benchmark { field, claimed, found }).collect();
    if header.splits.is_empty() || header.splits.contains(&Split::Train) {
        let names = |splits: &[Split]| splits.iter().map(|split| split.name()).collect::<Vec<_>>().join(", ");
        let (claimed, found) = (names(&header.splits), names(&Split::PLAYED));
        differences.push(Difference::Benchmark { field: "splits", claimed, found });
    }
    differences
}

/// The episodes of the missions that were to be played, each once; notes what else there is, and what there is not.
fn sorted<'a>(
    benchmark: &'a Benchmark,
    submission: &'a Submission,
    differences: &mut Vec<Difference>,
) -> Vec<(&'a Mission, &'a Episode)> {
    let missions: BTreeMap<&str, &Mission> =
        benchmark.of(&submission.header.splits).map(|mission| (mission.id.as_str(), mission)).collect();
    let (mut seen, mut claimed) = (BTreeSet::new(), Vec::new());
    for line in &submission.lines {
        let number = line.number;
        match &line.episode {
            Err(reason) => differences.push(Difference::Line { number, reason: reason.clone() }),
            Ok(episode) => match missions.get(episode.mission.as_str()) {
                None => differences.push(Difference::Unknown { mission: episode.mission.clone(), number }),
                Some(_) if !seen.insert(episode.mission.as_str()) => {
                    differences.push(Difference::Doubled { mission: episode.mission.clone(), number });
                }
                Some(mission) => claimed.push((*mission, episode)),
            },
        }
    }
    let missing = missions.keys().filter(|id| !seen.contains(*id));
    differences.extend(missing.map(|id| Difference::Missing { mission: (*id).to_owned() }));
    claimed
}

fn of_episode(claimed: &Episode, found: &Episode) -> Vec<Difference> {
    let word = |episode: &Episode| serde_json::to_string(&episode.end).unwrap_or_default().replace('"', "");
    let fields = [
        ("success", claimed.success.to_string(), found.success.to_string()),
        ("goals_met", claimed.goals_met.to_string(), found.goals_met.to_string()),
        ("goals", claimed.goals.to_string(), found.goals.to_string()),
        ("actions", claimed.actions.to_string(), found.actions.to_string()),
        ("failed_actions", claimed.failed_actions.to_string(), found.failed_actions.to_string()),
        ("end", word(claimed), word(found)),
        ("ticks", claimed.ticks.to_string(), found.ticks.to_string()),
        ("digest", claimed.digest.clone(), found.digest.clone()),
    ];
    let commands = commands_that_differ(claimed, found).map(|[claimed, found]| ("taken", claimed, found));
    let differ = fields.into_iter().filter(|(_, claimed, found)| claimed != found).chain(commands);
    let mission = &found.mission;
    differ
        .map(|(field, claimed, found)| Difference::Field { mission: mission.clone(), field, claimed, found })
        .collect()
}

/// The first tick with commands that differs, as it is in the file and as it is.
fn commands_that_differ(claimed: &Episode, found: &Episode) -> Option<[String; 2]> {
    let most = claimed.taken.len().max(found.taken.len());
    let at = (0..most).find(|at| claimed.taken.get(*at) != found.taken.get(*at))?;
    let told = |episode: &Episode| {
        episode.taken.get(at).map_or_else(
            || "no more commands".to_owned(),
            |taken| format!("{} commands at tick {} with the digest {}", taken.inputs.len(), taken.tick, taken.digest),
        )
    };
    Some([told(claimed), told(found)])
}

/// How figures differ from those that follow from the episodes.
fn of_totals(claimed: Option<&Totals>, found: &Totals) -> Vec<Difference> {
    let Some(claimed) = claimed else {
        let (claimed, found) = ("none".to_owned(), format!("those of {} splits", found.len()));
        return vec![Difference::Totals { place: "all".to_owned(), claimed, found }];
    };
    let (claimed, found) = (rows(claimed), rows(found));
    let places: BTreeSet<&String> = claimed.keys().chain(found.keys()).collect();
    let differ = places.into_iter().filter(|place| claimed.get(*place) != found.get(*place));
    differ
        .map(|place| Difference::Totals {
            place: place.clone(),
            claimed: told(claimed.get(place)),
            found: told(found.get(place)),
        })
        .collect()
}

fn rows(totals: &Totals) -> BTreeMap<String, Tally> {
    let mut rows = BTreeMap::new();
    for (split, totals) in totals {
        rows.insert(split.name().to_owned(), totals.all);
        // A part and a type may have one name: neither stands for the other.
        for (of, tallies) in [("part", &totals.parts), ("type", &totals.types)] {
            for (name, tally) in tallies {
                rows.insert(format!("{}, {of} {name}", split.name()), *tally);
            }
        }
    }
    rows
}

fn told(tally: Option<&Tally>) -> String {
    tally.map_or_else(|| "none".to_owned(), |tally| serde_json::to_string(tally).unwrap_or_default())
}
