//! What the processes of a measurement do, whatever carries the messages.

use std::error::Error;
use std::hint::black_box;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::sleep;
use std::time::{Duration, Instant};

use rustix::time::{ClockId, clock_gettime};

use crate::board::Board;
use crate::case::Case;

/// What can go wrong.
pub type Failure = Box<dyn Error + Send + Sync>;

/// Sends messages of the case's length, each written by `write`, to all subscribers.
pub trait Outlet {
    /// Sends one.
    fn send(&mut self, write: &mut dyn FnMut(&mut [u8])) -> Result<(), Failure>;
}

/// Sees a message: its bytes, in as many parts as its carrier holds them in.
pub type Look = Box<dyn FnMut(&[&[u8]]) + Send>;

/// Hands each message to `look` as soon as it is there, until the board says that it is done or the sender is gone.
pub trait Inlet {
    /// Does so.
    fn listen(self: Box<Self>, look: Look, board: &'static Board) -> Result<(), Failure>;
}

/// Sent again and again until all have seen one.
const PROBE: u64 = 1;
/// Messages before any is measured: they find memory mapped and caches warm.
const WARM_UP: u64 = 20;
/// How long a message may stay away before it counts as lost.
const PATIENCE: Duration = Duration::from_secs(2);
/// How long all may take to find each other.
const MEETING: Duration = Duration::from_secs(20);
/// Messages under way at once when they are sent as fast as they are taken.
const WINDOW: u64 = 2;
const LINE: usize = 64;

/// Nanoseconds of the clock that all processes share.
fn now() -> u64 {
    nanos(ClockId::Monotonic)
}

/// Processor time of this process, all threads, ns.
fn cpu() -> u64 {
    nanos(ClockId::ProcessCPUTime)
}

fn nanos(clock: ClockId) -> u64 {
    let time = clock_gettime(clock);
    time.tv_sec as u64 * 1_000_000_000 + time.tv_nsec as u64
}

/// Does one process's part and prints what came of it as one line.
pub fn work(
    arguments: &[String],
    outlet: impl FnOnce(&str, &Case, &Board) -> Result<Box<dyn Outlet>, Failure>,
    inlet: impl FnOnce(&str, &Case, &Board) -> Result<Box<dyn Inlet>, Failure>,
) -> Result<(), Failure> {
    let [role, carrier, rest @ ..] = arguments else { return Err("a role and a carrier are missing".into()) };
    let case = Case::parse(rest).ok_or("not a case")?;
    let board = Board::open(&case.file("board"))?;
    match role.strip_prefix("receive-") {
        None => send(&case, board, &mut *outlet(carrier, &case, board)?),
        Some(index) => receive(&case, board, index.parse()?, inlet(carrier, &case, board)?),
    }
}

struct Sending<'a> {
    case: &'a Case,
    board: &'a Board,
    outlet: &'a mut dyn Outlet,
    sequence: u64,
}

impl Sending<'_> {
    fn send(&mut self, sequence: u64) -> Result<(), Failure> {
        let touched = self.case.touched;
        self.sequence = sequence;
        self.outlet.send(&mut |message| {
            if touched {
                message.iter_mut().step_by(LINE).for_each(|byte| *byte = sequence as u8);
            }
            message[..8].copy_from_slice(&sequence.to_le_bytes());
            message[8..16].copy_from_slice(&now().to_le_bytes());
        })
    }

    fn next(&mut self) -> Result<(), Failure> {
        self.send(self.sequence + 1)
    }

    fn is_seen(&self) -> bool {
        self.board.all_saw(self.case.subscribers, self.sequence)
    }

    fn wait(&self, sequence: u64) -> bool {
        self.board.wait_until_all_saw(self.case.subscribers, sequence, PATIENCE)
    }
}

fn send(case: &Case, board: &Board, outlet: &mut dyn Outlet) -> Result<(), Failure> {
    let mut sending = Sending { case, board, outlet, sequence: 0 };
    let began = Instant::now();
    sending.send(PROBE)?;
    while !sending.is_seen() {
        if began.elapsed() > MEETING {
            return Err("not all subscribers came".into());
        }
        sleep(Duration::from_millis(20));
        if !sending.is_seen() {
            sending.send(PROBE)?;
        }
    }
    for _ in 0..WARM_UP {
        sending.next()?;
        sending.wait(sending.sequence);
    }
    let (cpu_ns, left_out) = pace(&mut sending)?;
    let (rushed, rush_ns) = rush(&mut sending)?;
    board.end();
    println!("result cpu={cpu_ns} left-out={left_out} rushed={rushed} rush={rush_ns}");
    Ok(())
}

/// Sends at the pace; gives the processor time and how many beats were left out, because a message was still under way.
fn pace(sending: &mut Sending<'_>) -> Result<(u64, u64), Failure> {
    let most = PATIENCE.as_nanos() / sending.case.beat.as_nanos().max(1);
    let (began, mut beats, mut left_out) = (cpu(), 0u32, 0);
    let first = Instant::now();
    for _ in 0..sending.case.count {
        let mut waited = 0;
        loop {
            beats += 1;
            sleep((first + sending.case.beat * beats).saturating_duration_since(Instant::now()));
            if sending.is_seen() || waited > most {
                break;
            }
            waited += 1;
            left_out += 1;
        }
        sending.next()?;
    }
    let spent = cpu() - began;
    sending.wait(sending.sequence);
    Ok((spent, left_out))
}

/// Sends as fast as all take it; gives how many messages, and in how many nanoseconds.
fn rush(sending: &mut Sending<'_>) -> Result<(u64, u64), Failure> {
    let (began, before) = (Instant::now(), sending.sequence);
    while began.elapsed() < sending.case.rush {
        sending.next()?;
        if !sending.wait(sending.sequence + 1 - WINDOW) {
            return Err(format!("message {} was not seen by all", sending.sequence + 1 - WINDOW).into());
        }
    }
    sending.wait(sending.sequence);
    Ok((sending.sequence - before, u64::try_from(began.elapsed().as_nanos())?))
}

/// What a subscriber has measured.
#[derive(Default)]
struct Measured {
    latencies_ns: Vec<u64>,
    cpu_before: u64,
    cpu_after: u64,
}

fn receive(case: &Case, board: &'static Board, index: usize, inlet: Box<dyn Inlet>) -> Result<(), Failure> {
    let measured = Arc::new(Mutex::new(Measured::default()));
    let filled = Arc::clone(&measured);
    let (touched, warm) = (case.touched, PROBE + WARM_UP);
    let last = warm + case.count;
    let look = move |parts: &[&[u8]]| {
        let head = parts.first().copied().unwrap_or_default();
        let word = |at: usize| {
            head.get(at..at + 8).map_or(0, |bytes| bytes.iter().rfold(0, |sum, b| sum << 8 | u64::from(*b)))
        };
        let (sequence, stamp) = (word(0), word(8));
        if touched {
            let lines = parts.iter().flat_map(|part| part.iter().step_by(LINE));
            black_box(lines.fold(0u64, |sum, byte| sum + u64::from(*byte)));
        }
        let arrived = now();
        let mut measured = filled.lock().unwrap_or_else(PoisonError::into_inner);
        if sequence > warm && sequence <= last {
            measured.latencies_ns.push(arrived.saturating_sub(stamp));
            measured.cpu_after = cpu();
        } else if sequence <= warm {
            measured.cpu_before = cpu();
        }
        drop(measured);
        board.saw(index, sequence);
    };
    inlet.listen(Box::new(look), board)?;
    let measured = measured.lock().unwrap_or_else(PoisonError::into_inner);
    let cpu_ns = measured.cpu_after.saturating_sub(measured.cpu_before);
    let latencies: Vec<_> = measured.latencies_ns.iter().map(u64::to_string).collect();
    println!("result cpu={cpu_ns} latencies={}", latencies.join(","));
    Ok(())
}
