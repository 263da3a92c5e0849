//! A benchmark played by an agent.

use std::{
    path::Path,
    sync::{Mutex, PoisonError},
};

use cohabit_generate::side_by_side;

use crate::{
    benchmark::Benchmark,
    draft::{Draft, write},
    episode::{Episode, Recording},
    error::RunError,
    mission::Mission,
    replay::play_again,
    submission::{Header, Submission},
    totals::totals,
};

/// How a mission is played: gives what the agent did, or why it could not play, in words.
pub type Play<'a> = dyn Fn(&Mission) -> Result<Recording, String> + Sync + 'a;

/// Has an agent play the splits that the header names, `workers` missions at a time; gives the header with all figures. `done` is
/// told of each mission that is played. A run that was interrupted goes on; one that is finished is not played again.
///
/// # Errors
/// [`RunError`].
pub fn run(
    benchmark: &Benchmark,
    header: Header,
    out: &Path,
    workers: usize,
    play: &Play<'_>,
    done: &(dyn Fn() + Sync),
) -> Result<Header, RunError> {
    if out.exists() {
        return finished(out, &header);
    }
    let splits = header.splits.clone();
    let missions: Vec<&Mission> = benchmark.of(&splits).collect();
    let draft = Draft::open(out, header)?;
    let (played, left): (Vec<&Mission>, Vec<&Mission>) =
        missions.iter().copied().partition(|mission| draft.has(&mission.id));
    played.iter().for_each(|_| done());
    let draft = Mutex::new(draft);
    let mut workers = vec![(); workers.clamp(1, left.len().max(1))];
    side_by_side(&mut workers, 0..left.len(), |(), number| {
        let episode = episode(benchmark, left[number], play)?;
        draft.lock().unwrap_or_else(PoisonError::into_inner).push(episode)?;
        done();
        Ok::<_, RunError>(())
    })?;
    let draft = draft.into_inner().unwrap_or_else(PoisonError::into_inner);
    let (header, episodes) = draft.into_parts(missions.iter().map(|mission| mission.id.as_str()));
    let header = Header { totals: Some(totals(benchmark, &episodes)), ..header };
    write(out, &header, &episodes)?;
    Ok(header)
}

/// The header of a submission that is whole already.
fn finished(out: &Path, header: &Header) -> Result<Header, RunError> {
    match Submission::read(out) {
        Ok(submission) if submission.header.is_same_run(header) => Ok(submission.header),
        _ => Err(RunError::Exists { path: out.to_owned() }),
    }
}

/// Has a mission played; what came of it follows from the commands alone, in a world of their own.
fn episode(benchmark: &Benchmark, mission: &Mission, play: &Play<'_>) -> Result<Episode, RunError> {
    let failed = |reason: String| RunError::Mission { mission: mission.id.clone(), reason };
    let recording = play(mission).map_err(failed)?;
    let episode = play_again(benchmark, mission, &recording).map_err(failed)?;
    let differs = episode.taken.iter().zip(&recording.taken).find(|(here, recorded)| here != recorded);
    match differs {
        Some((here, _)) => Err(RunError::Differs { mission: mission.id.clone(), tick: here.tick }),
        None => Ok(episode),
    }
}
