//! Threads that share out the worlds of one call.
//!
//! Each thread has a batch of its own, the same worlds in each call, so that they stay in its caches; who is done early helps
//! others. Between two calls threads stay awake for a moment: a step of many small worlds is over before a thread that sleeps
//! has woken up.

use std::{
    collections::VecDeque,
    hint,
    panic::{AssertUnwindSafe, catch_unwind, resume_unwind},
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    thread::{self, JoinHandle, Thread},
    time::{Duration, Instant},
};

/// How long a thread waits awake: some times as long as Python takes between the steps of a loop that does nothing else.
const AWAKE: Duration = Duration::from_micros(200);
/// Looks at what is waited for before others may run on this core.
const LOOKS: usize = 64;
/// The bit of [`Shared::gate`] that says that nobody may join the round any more; the others count who has.
const CLOSED: usize = 1 << (usize::BITS - 1);

/// Some threads, of which the one that calls is the first.
pub struct Crew {
    shared: Arc<Shared>,
    helpers: Vec<JoinHandle<()>>,
}

/// What all threads see.
struct Shared {
    /// Counts rounds, and so says that another one has begun.
    rounds: AtomicUsize,
    /// How many helpers are in this round, and whether it is [`CLOSED`].
    gate: AtomicUsize,
    /// What is done in this round.
    work: Mutex<Option<Work>>,
    /// Whether helpers are to end.
    ends: AtomicBool,
}

/// What is done in a round.
#[derive(Clone)]
struct Work {
    /// Is told which thread it runs on. It is borrowed from the caller, who waits for all that have joined the round.
    run: &'static (dyn Fn(usize) + Sync),
    caller: Thread,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Waits until something is so, first awake, then asleep: whoever has it be so unparks this thread.
fn wait_until(is_so: impl Fn() -> bool) {
    let since = Instant::now();
    loop {
        for _ in 0..LOOKS {
            if is_so() {
                return;
            }
            hint::spin_loop();
        }
        if since.elapsed() > AWAKE {
            break;
        }
        thread::yield_now();
    }
    while !is_so() {
        thread::park();
    }
}

impl Shared {
    /// Has a helper take part in the round, unless it is over.
    fn join(&self, thread: usize) {
        let joined = |gate: usize| (gate & CLOSED == 0).then_some(gate + 1);
        if self.gate.fetch_update(Ordering::AcqRel, Ordering::Acquire, joined).is_err() {
            return;
        }
        let work = lock(&self.work).clone();
        if let Some(work) = &work {
            (work.run)(thread);
        }
        let is_last = self.gate.fetch_sub(1, Ordering::AcqRel) == CLOSED + 1;
        if let Some(Work { caller, .. }) = work.filter(|_| is_last) {
            caller.unpark();
        }
    }

    /// Takes part in one round after the other.
    fn help(&self, thread: usize) {
        let mut seen = 0;
        loop {
            wait_until(|| self.rounds.load(Ordering::Acquire) != seen);
            seen = self.rounds.load(Ordering::Acquire);
            if self.ends.load(Ordering::Acquire) {
                return;
            }
            self.join(thread);
        }
    }
}

impl Crew {
    /// So many threads, from 1 to 256; fewer, if the machine gives no more.
    pub fn new(threads: usize) -> Self {
        let shared = Arc::new(Shared {
            rounds: AtomicUsize::new(0),
            gate: AtomicUsize::new(CLOSED),
            work: Mutex::new(None),
            ends: AtomicBool::new(false),
        });
        let start = |thread: usize| {
            let shared = Arc::clone(&shared);
            thread::Builder::new().name(format!("world-{thread}")).spawn(move || shared.help(thread)).ok()
        };
        let helpers = (1..threads.clamp(1, 256)).map_while(start).collect();
        Self { shared, helpers }
    }

    /// Does every job once, and gives the first error that came up, if any did.
    ///
    /// # Errors
    /// Those of `work`.
    pub fn share_out<J: Send, E: Send>(
        &mut self,
        jobs: Vec<J>,
        work: impl Fn(J) -> Result<(), E> + Sync,
    ) -> Result<(), E> {
        let threads = (self.helpers.len() + 1).min(jobs.len());
        if threads < 2 {
            return jobs.into_iter().try_for_each(work);
        }
        let (batches, error) = (batches(jobs, threads), Mutex::new(None));
        self.round(&|thread| {
            while let Some(job) = next(&batches, thread) {
                if let Err(failed) = work(job) {
                    lock(&error).get_or_insert(failed);
                }
            }
        });
        error.into_inner().unwrap_or_else(PoisonError::into_inner).map_or(Ok(()), Err)
    }

    /// Has this thread and all helpers that are there in time run `work`, each once; returns when nobody runs it any more.
    fn round(&mut self, work: &(dyn Fn(usize) + Sync)) {
        let panicked = Mutex::new(None);
        let run = |thread: usize| {
            if let Err(panic) = catch_unwind(AssertUnwindSafe(|| work(thread))) {
                lock(&panicked).get_or_insert(panic);
            }
        };
        let run: &(dyn Fn(usize) + Sync) = &run;
        // SAFETY: helpers call it between joining the round and leaving it alone. Nobody joins once the gate is closed, and this
        // function neither returns nor unwinds before the gate is closed and all who joined have left: `run` catches panics, and
        // nothing else panics between here and there. One round is over before the next begins: `self` is borrowed for it alone.
        let lent = unsafe { std::mem::transmute::<&(dyn Fn(usize) + Sync), &'static (dyn Fn(usize) + Sync)>(run) };
        let Shared { rounds, gate, work, .. } = &*self.shared;
        *lock(work) = Some(Work { run: lent, caller: thread::current() });
        gate.store(0, Ordering::Release);
        rounds.fetch_add(1, Ordering::Release);
        self.helpers.iter().for_each(|helper| helper.thread().unpark());
        run(0);
        gate.fetch_or(CLOSED, Ordering::AcqRel);
        wait_until(|| gate.load(Ordering::Acquire) == CLOSED);
        *lock(work) = None;
        if let Some(panic) = panicked.into_inner().unwrap_or_else(PoisonError::into_inner) {
            resume_unwind(panic);
        }
    }
}

impl Drop for Crew {
    fn drop(&mut self) {
        self.shared.ends.store(true, Ordering::Release);
        self.shared.rounds.fetch_add(1, Ordering::Release);
        // They end by themselves: in a process that was forked off they are not there, and would be waited for in vain.
        self.helpers.iter().for_each(|helper| helper.thread().unpark());
    }
}

/// The jobs of each thread.
fn batches<J>(jobs: Vec<J>, threads: usize) -> Vec<Mutex<VecDeque<J>>> {
    let (count, mut jobs) = (jobs.len(), jobs.into_iter());
    let size = |thread: usize| (thread + 1) * count / threads - thread * count / threads;
    (0..threads).map(|thread| Mutex::new(jobs.by_ref().take(size(thread)).collect())).collect()
}

/// The next job of a thread: the first of its own batch, or the last that is left of another's.
fn next<J>(batches: &[Mutex<VecDeque<J>>], thread: usize) -> Option<J> {
    let own = batches.get(thread).and_then(|own| lock(own).pop_front());
    own.or_else(|| batches.iter().find_map(|other| lock(other).pop_back()))
}
