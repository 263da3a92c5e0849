//! How long a message takes, and what it costs, beside what one could use instead: the same messages, the same machine,
//! in turn.
//!
//! ```text
//! cargo bench -p cohabit-bus --bench peers              # measures: about a quarter of an hour
//! cargo bench -p cohabit-bus --bench peers -- quick     # measures less, in about a minute
//! cargo bench -p cohabit-bus --bench peers -- own       # without peers that must be built
//! ```
//!
//! A sender and each subscriber are processes of their own, so sixteen subscribers share what cores there are. The
//! sender stamps a message when it is written and nothing is left but to send it; a subscriber stamps it when it has it
//! or, where it is touched, has read every cache line of it. Messages go at a pace, and one more is only sent once all
//! have the last one; then as fast as all take them, two under way at once. Processor time is that of all processes of
//! a message.
//!
//! Peers from elsewhere are built into the target folder on the first run, from a package and a lock file of their own,
//! so that nobody else compiles them.

mod board;
mod case;
mod contender;
mod measure;
mod own;
mod plain;
mod sheet;
mod sockets;
mod work;

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use case::Case;
use contender::Contender;
use sheet::Row;
use work::Failure;

/// A command; a small camera's frame; a robot's frame with all planes, 300x300; a large camera's, 1280x720.
const SIZES: [usize; 4] = [64, 270_000, 1_440_000, 14_745_600];
const PACE: Duration = Duration::from_nanos(1_000_000_000 / 60);

/// How much is measured.
struct Extent {
    subscribers: &'static [usize],
    /// Those with whom messages are also touched.
    touched: &'static [usize],
    count: u64,
    rush: Duration,
}

const FULL: Extent =
    Extent { subscribers: &[1, 4, 16], touched: &[1, 4, 16], count: 300, rush: Duration::from_millis(1_000) };
const QUICK: Extent = Extent { subscribers: &[1, 4], touched: &[4], count: 30, rush: Duration::from_millis(150) };

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [first, rest @ ..] = &arguments[..]
        && first == "work"
    {
        return work_as(rest);
    }
    let has = |word: &str| arguments.iter().any(|argument| argument == word);
    let extent = if has("quick") { &QUICK } else { &FULL };
    let mut contenders = contender::own()?;
    if !has("own") {
        contenders.extend(contender::foreign(&Path::new(env!("CARGO_TARGET_TMPDIR")).join("peers")));
    }
    println!("machine: {}; load before: {}", machine(), load());
    let rows = run(extent, &contenders)?;
    sheet::print_summary(&rows, &contenders);
    println!("load after: {}", load());
    Ok(())
}

fn work_as(arguments: &[String]) -> Result<(), Failure> {
    work::work(
        arguments,
        |carrier, case, board| match carrier {
            "own" => own::outlet(case),
            "iceoryx2" => plain::outlet(case),
            "unix" => sockets::unix_outlet(case),
            "tcp" => sockets::tcp_outlet(case, board),
            _ => Err("an unknown carrier".into()),
        },
        |carrier, case, board| match carrier {
            "own" => own::inlet(case),
            "iceoryx2" => plain::inlet(case),
            "unix" => sockets::unix_inlet(case),
            "tcp" => sockets::tcp_inlet(case, board),
            _ => Err("an unknown carrier".into()),
        },
    )
}

fn run(extent: &Extent, contenders: &[Contender]) -> Result<Vec<Row>, Failure> {
    let mut rows: Vec<Row> = Vec::new();
    for touched in [false, true] {
        for bytes in SIZES {
            for &subscribers in if touched { extent.touched } else { extent.subscribers } {
                let Extent { count, rush, .. } = *extent;
                let case = Case { bytes, subscribers, touched, count, beat: PACE, rush, folder: PathBuf::new() };
                let row = measure_all(case, contenders, rows.len());
                row.print(contenders);
                rows.push(row);
            }
        }
    }
    Ok(rows)
}

/// Whoever comes first in one case comes later in the next.
fn measure_all(case: Case, contenders: &[Contender], turn: usize) -> Row {
    let mut figures = vec![None; contenders.len()];
    for place in 0..contenders.len() {
        let who = (turn + place) % contenders.len();
        match measure::measure(&contenders[who], &case) {
            Ok(measured) => figures[who] = Some(measured),
            Err(error) => println!("{}: {error}", contenders[who].title),
        }
    }
    Row { case, figures }
}

/// The processor, and how many cores of it may be used.
fn machine() -> String {
    let processor = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = processor.lines().find_map(|line| line.strip_prefix("model name")).unwrap_or(": unknown");
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    format!("{}, {cores} cores", model.trim_start_matches([' ', '\t', ':']))
}

/// How many processes wanted a core over the last minute.
fn load() -> String {
    let text = fs::read_to_string("/proc/loadavg").unwrap_or_default();
    text.split(' ').next().unwrap_or("unknown").to_owned()
}
