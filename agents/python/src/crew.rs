//! Threads that share out the worlds of one call.

use std::sync::{Mutex, PoisonError};

use rayon::{ThreadPool, ThreadPoolBuilder};

/// Some threads, of which the one that calls is the first; the others wait for it.
pub struct Crew {
    others: Option<ThreadPool>,
}

impl Crew {
    /// So many threads, from 1 to 256; fewer, if the machine gives no more.
    pub fn new(threads: usize) -> Self {
        let others = threads.clamp(1, 256) - 1;
        let name = |index| format!("world-{index}");
        let build = || ThreadPoolBuilder::new().num_threads(others).thread_name(name).build();
        Self { others: (others > 0).then(build).and_then(Result::ok) }
    }

    /// Does every job once, and gives the first error that came up, if any did. A job goes to whichever thread is free.
    ///
    /// # Errors
    /// Those of `work`.
    pub fn share_out<J: Send, E: Send>(&self, jobs: Vec<J>, work: impl Fn(J) -> Result<(), E> + Sync) -> Result<(), E> {
        let Some(others) = self.others.as_ref().filter(|_| jobs.len() > 1) else {
            return jobs.into_iter().try_for_each(work);
        };
        let helpers = others.current_num_threads().min(jobs.len() - 1);
        let (queue, error) = (Mutex::new(jobs.into_iter()), Mutex::new(None));
        let next = || queue.lock().unwrap_or_else(PoisonError::into_inner).next();
        let drain = || {
            while let Some(job) = next() {
                if let Err(failed) = work(job) {
                    error.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(failed);
                }
            }
        };
        others.in_place_scope(|scope| {
            for _ in 0..helpers {
                scope.spawn(|_| drain());
            }
            drain();
        });
        error.into_inner().unwrap_or_else(PoisonError::into_inner).map_or(Ok(()), Err)
    }
}
