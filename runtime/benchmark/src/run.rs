//! A benchmark played by an agent.

use std::{
    io,
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
};

use cohabit_generate::side_by_side;

use crate::{
    benchmark::Benchmark,
    draft::{Draft, write},
    episode::{Episode, Recording},
    mission::Mission,
    replay::play_again,
    submission::{Header, Submission},
    totals::totals,
};

/// Why a submission was not made.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// A file cannot be read or written.
    #[error("{path}: {source}")]
    File {
        /// Which.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// There is another file.
    #[error("{path}: it is there already, and is not of this run; name another file, or remove it")]
    Exists {
        /// Which.
        path: PathBuf,
    },
    /// What was interrupted was another run.
    #[error(
        "{path}: what was begun here is of another agent, other settings, another benchmark or another version of the program; \
         name another file, or remove it"
    )]
    OtherRun {
        /// Its file.
        path: PathBuf,
    },
    /// What was interrupted is damaged.
    #[error("{path}:{line}: not as it was written: {reason}; remove the file to begin anew")]
    Damaged {
        /// Its file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What is wrong.
        reason: String,
    },
    /// A mission was not played.
    #[error("{mission}: {reason}")]
    Mission {
        /// Which.
        mission: String,
        /// Why.
        reason: String,
    },
    /// A recording does not lead to where it did when it was made.
    #[error(
        "{mission}: at tick {tick} its state is not the recorded one; it was recorded by another program: play it with this one"
    )]
    Differs {
        /// The mission.
        mission: String,
        /// The tick.
        tick: u64,
    },
}

impl RunError {
    /// Whether another call would mend it, rather than the same one later.
    #[must_use]
    pub const fn is_bad_input(&self) -> bool {
        match self {
            Self::Exists { .. } | Self::OtherRun { .. } | Self::Damaged { .. } | Self::Differs { .. } => true,
            Self::File { .. } | Self::Mission { .. } => false,
        }
    }
}

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
