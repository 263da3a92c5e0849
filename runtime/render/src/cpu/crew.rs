//! Threads that share work out among themselves.

use std::sync::{Mutex, PoisonError};

use rayon::{ThreadPool, ThreadPoolBuilder};

/// Some threads, of which the one that has work to share out is the first; the others wait for it.
#[derive(Debug)]
pub(crate) struct Crew {
    threads: usize,
    others: Option<ThreadPool>,
}

/// Pictures can wait for whoever has a deadline, such as the tick of the world that they show.
fn give_way() {
    let _ = rustix::process::setpriority_process(None, 10);
}

impl Crew {
    /// So many threads, from 1 to 64; fewer, if the machine gives no more.
    pub(crate) fn new(threads: usize) -> Self {
        let threads = threads.clamp(1, 64);
        let others = (threads > 1).then(|| {
            let name = |index| format!("render-{index}");
            ThreadPoolBuilder::new().num_threads(threads - 1).thread_name(name).start_handler(|_| give_way()).build()
        });
        let others = others.and_then(Result::ok);
        Self { threads: if others.is_some() { threads } else { 1 }, others }
    }

    /// How many there are.
    pub(crate) fn threads(&self) -> usize {
        self.threads
    }

    /// Runs every job once, on as many threads, at most all.
    pub(crate) fn share_out<J: Send>(&self, threads: usize, jobs: Vec<J>, work: impl Fn(J) + Sync) {
        let Some(others) = self.others.as_ref().filter(|_| threads > 1 && jobs.len() > 1) else {
            jobs.into_iter().for_each(work);
            return;
        };
        let helpers = threads.min(jobs.len()) - 1;
        let queue = Mutex::new(jobs.into_iter());
        let drain = || {
            loop {
                let next = queue.lock().unwrap_or_else(PoisonError::into_inner).next();
                match next {
                    Some(job) => work(job),
                    None => break,
                }
            }
        };
        others.in_place_scope(|scope| {
            for _ in 0..helpers {
                scope.spawn(|_| drain());
            }
            drain();
        });
    }
}
