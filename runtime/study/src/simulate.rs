//! A dry run: a whole study with simulated people, before anybody comes. Everything goes through the same assignment, checks,
//! journals, tables and folder as with people, and is marked synthetic; its times are those of a year long gone.

mod pair_walk;
mod people;
mod person;
mod walk;

use std::{
    collections::BTreeMap,
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
};

use cohabit_tables::Chance;
use serde::Serialize;

use crate::{
    design::{Covariate, CovariateSource, Minimisation, Study},
    folder::{Folder, FolderError},
    pair::pair_of,
    progress::{Event, Phase, Progress, Refused},
    registry::{Clock, Registry, StudyFault, Who},
    tables::{self, TablesError},
    web::{Sent, newcomers_event, participants_event},
};
use pair_walk::PairWalk;
pub use people::{Answering, Leaving, People, PeopleError, Shift, Speaking};
use person::Person;
use walk::{Setting, Walk};
pub use walk::{SimulatedMission, SimulatedPlayer, SimulatedSession};

/// When the first simulated person comes, ms since 1970: with the year 2000, in which nobody took part.
const FIRST_MS: u64 = 946_684_800_000;
/// One comes so long after the other, ms.
const EVERY_MS: u64 = 3_600_000;
/// The share that ticks a box that is optional.
const TICKS: f64 = 0.5;

/// A dry run, as its folder notes it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DryRun {
    /// How many simulated people come.
    pub participants: u32,
    /// The seed of all that they do.
    pub seed: u64,
    /// How they are.
    pub people: People,
    /// The version of the program.
    pub program: String,
}

/// What came of a dry run.
#[derive(Clone, Debug, Default, Eq, PartialEq)]
pub struct Simulated {
    /// Who consented.
    pub consented: usize,
    /// Who finished.
    pub finished: usize,
    /// Whose data were removed.
    pub withdrawn: usize,
    /// Who was excluded.
    pub excluded: usize,
    /// Who stopped in the middle.
    pub stopped: usize,
    /// Missions that were played.
    pub missions: usize,
}

/// Why a study could not be simulated.
#[derive(Debug, thiserror::Error)]
pub enum SimulateError {
    /// Its folder failed.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// Its tables could not be written.
    #[error(transparent)]
    Tables(#[from] TablesError),
    /// A session could not be played.
    #[error("simulate session {session}: {reason}")]
    Session {
        /// Which.
        session: String,
        /// Why.
        reason: String,
    },
    /// Something happened to somebody that could not: a bug.
    #[error("simulate {participant}: {event} cannot happen: {refused}")]
    Refused {
        /// To whom.
        participant: String,
        /// What.
        event: String,
        /// Why not.
        refused: Refused,
    },
    /// The study did not take what a simulated person sent.
    #[error("simulate participant {number}: {fault}")]
    Fault {
        /// Who, by the order in which they came.
        number: u32,
        /// Why.
        fault: StudyFault,
    },
}

/// Plays a study with simulated people in its folder, which [`Folder::begin_synthetic`] gave; on so many threads. `done` is told
/// whenever somebody's way is over.
///
/// # Errors
/// [`SimulateError`].
pub fn simulate(
    mut study: Study,
    folder: Folder,
    run: &DryRun,
    player: &dyn SimulatedPlayer,
    threads: usize,
    done: &(dyn Fn() + Sync),
) -> Result<Simulated, SimulateError> {
    study.participants = study.participants.max(run.participants);
    let mut registry = Registry::new(study, folder)?;
    let people: Vec<Person<'_>> =
        (1..=run.participants).map(|number| Person::new(&run.people, run.seed, number)).collect();
    let mut here = Vec::new();
    for (number, person) in (1..).zip(&people) {
        registry.clock = Clock::Simulated(comes_ms(number));
        let place = come(&mut registry, person).map_err(|fault| SimulateError::Fault { number, fault })?;
        if let Some(place) = place {
            answer_first(&mut registry, person, place, &run.people.speaking, player)?;
        }
        let progress = place.and_then(|place| Some(registry.participants.get(&place)?.progress.clone()));
        here.extend(progress.map(|progress| (number, person, progress)));
    }
    let ways = {
        let (study, logs) = (&registry.study, &registry.folder);
        let setting = Setting { study, speaking: &run.people.speaking, logs, player };
        let way = |party: &Vec<&Member<'_>>| {
            let walks = party.iter().map(|(_, person, progress)| Walk::new(&setting, person, progress.clone()));
            let events = match study.pairing {
                Some(pairing) => PairWalk::new(&setting, pairing, walks.collect()).run(),
                None => walks.map(Walk::run).collect(),
            };
            party.iter().for_each(|_| done());
            events
        };
        on_threads(&parties(study, &here), threads, &way)?
    };
    for ((number, _, progress), events) in here.iter().zip(ways.into_iter().flatten()) {
        write_down(&mut registry, progress.plan().place, events)
            .map_err(|fault| SimulateError::Fault { number: *number, fault })?;
    }
    let progress: Vec<Progress> = registry.participants.values().map(|one| one.progress.clone()).collect();
    tables::write(&registry.study, &progress, &registry.folder)?;
    Ok(Simulated { withdrawn: here.len() - progress.len(), consented: here.len(), ..counts(&progress) })
}

/// Somebody who has come: which of all, who, and where they are.
type Member<'a> = (u32, &'a Person<'a>, Progress);

/// Those who play together, in the order of their places: pairs, or each alone.
fn parties<'m, 'a>(study: &Study, all: &'m [Member<'a>]) -> Vec<Vec<&'m Member<'a>>> {
    let pair = |(.., progress): &Member<'_>| pair_of(progress.plan().place);
    let are_together = |one: &Member<'_>, other: &Member<'_>| study.pairing.is_some() && pair(one) == pair(other);
    all.chunk_by(are_together).map(|party| party.iter().collect()).collect()
}

fn comes_ms(number: u32) -> u64 {
    FIRST_MS + u64::from(number) * EVERY_MS
}

/// Whose condition depends on what they answer first answers that, before the next one comes.
fn answer_first(
    registry: &mut Registry,
    person: &Person<'_>,
    place: u32,
    speaking: &Speaking,
    player: &dyn SimulatedPlayer,
) -> Result<(), SimulateError> {
    let Some(progress) = registry.participants.get(&place).map(|one| one.progress.clone()) else { return Ok(()) };
    if !progress.plan().awaits_assignment {
        return Ok(());
    }
    let events = {
        let setting = Setting { study: &registry.study, speaking, logs: &registry.folder, player };
        Walk::new(&setting, person, progress).run()?
    };
    write_down(registry, place, events).map_err(|fault| SimulateError::Fault { number: place, fault })
}

/// Somebody comes, reads, and consents or does not; gives their place.
fn come(registry: &mut Registry, person: &Person<'_>) -> Result<Option<u32>, StudyFault> {
    let token = registry.sign_up()?;
    let Some(Who::Newcomer(index)) = registry.who(&token) else { return Ok(None) };
    let mut drawn = person.coming();
    let parameters = link(registry.study.minimisation.as_ref(), &mut drawn);
    registry.tell(index, &parameters);
    newcomers_event(registry, index, &Event::Read)?;
    if !person.consents {
        newcomers_event(registry, index, &Event::Declined)?;
        return Ok(None);
    }
    let boxes = registry.study.consents.iter().enumerate();
    let ticked = boxes.filter(|(_, one)| one.is_required || drawn.is(TICKS)).map(|(number, _)| number).collect();
    let version = registry.study.consent.version.clone();
    newcomers_event(registry, index, &Event::Consented { version, ticked, audio: false })?;
    let Some(Who::Participant(place)) = registry.who(&token) else { return Ok(None) };
    Ok(Some(place))
}

/// The parameters of the link by which somebody comes: any of the levels of each.
fn link(minimisation: Option<&Minimisation>, drawn: &mut Chance) -> BTreeMap<String, String> {
    let told = |covariate: &Covariate| match &covariate.from {
        CovariateSource::Link { parameter, levels } => Some((parameter.clone(), drawn.pick(levels)?.clone())),
        CovariateSource::Answer { .. } => None,
    };
    minimisation.iter().flat_map(|all| &all.covariates).filter_map(told).collect()
}

/// What each of them does, in their order, so many at a time.
fn on_threads<T: Sync, R: Send>(
    all: &[T],
    threads: usize,
    work: &(dyn Fn(&T) -> Result<R, SimulateError> + Sync),
) -> Result<Vec<R>, SimulateError> {
    let next = AtomicUsize::new(0);
    let results = Mutex::new(all.iter().map(|_| None).collect::<Vec<_>>());
    thread::scope(|scope| {
        let each = || {
            while let Some((number, one)) = {
                let number = next.fetch_add(1, Ordering::Relaxed);
                all.get(number).map(|one| (number, one))
            } {
                let result = work(one);
                if result.is_err() {
                    next.store(all.len(), Ordering::Relaxed);
                }
                results.lock().unwrap_or_else(PoisonError::into_inner)[number] = Some(result);
            }
        };
        (0..threads.max(1)).for_each(|_| drop(scope.spawn(each)));
    });
    // After a failure the rest was left out.
    results.into_inner().unwrap_or_else(PoisonError::into_inner).into_iter().flatten().collect()
}

/// Has all of it happen in the study.
fn write_down(registry: &mut Registry, place: u32, events: Vec<(u64, Event)>) -> Result<(), StudyFault> {
    for (at_ms, event) in events {
        registry.clock = Clock::Simulated(at_ms);
        let step = registry.participants.get(&place).and_then(|one| one.progress.step_now()).map(|(step, ..)| step + 1);
        let is_theirs =
            matches!(event, Event::Answered { .. } | Event::GoesOn | Event::ProbeAnswered { .. } | Event::Withdrew);
        let withdraws = event == Event::Withdrew;
        if is_theirs {
            participants_event(registry, place, &Sent { step, event })?;
        } else {
            registry.apply(place, &event)?;
        }
        // No session runs that could start or end.
        registry.to_start.clear();
        if withdraws {
            registry.remove(place)?;
        }
    }
    Ok(())
}

fn counts(all: &[Progress]) -> Simulated {
    let of = |phase: &Phase| all.iter().filter(|one| one.phase() == phase).count();
    let (finished, excluded) = (of(&Phase::Finished), of(&Phase::Excluded));
    let missions = all.iter().map(|one| one.done().iter().filter(|done| done.ending.is_some()).count()).sum();
    Simulated { finished, excluded, stopped: all.len() - finished - excluded, missions, ..Simulated::default() }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
