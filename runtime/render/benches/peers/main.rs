//! What a frame costs beside renderers that one could pick instead: the same office, the same cameras, the same machine,
//! in turn.
//!
//! ```text
//! cargo bench -p cohabit-render --bench peers                  # measures
//! cargo bench -p cohabit-render --bench peers -- quick         # measures less long
//! cargo bench -p cohabit-render --bench peers -- save=FOLDER   # keeps pictures side by side instead
//! ```
//!
//! Peers are installed into a virtual environment under the target folder on the first run. Each draws all triangles at
//! the finest level; which of them it leaves out, and how, is its own affair. What it does not deliver costs it nothing.

#[path = "../frames/buffers.rs"]
mod buffers;
mod contender;
#[path = "../frames/machine.rs"]
mod machine;
#[path = "../frames/office.rs"]
mod office;
mod python;
mod sheet;
mod stage;

use std::error::Error;
use std::path::{Path, absolute};
use std::sync::Arc;

use cohabit_cdf::Catalog;
use cohabit_render::{CpuRenderer, MeshLibrary};

use contender::{Contender, Frame, Kind, Own};
use office::Office;
use stage::Stage;

/// The floor plan looked at.
const PLAN: &str = "OfficeLayout1";
/// Every so many-th of its viewpoints is taken.
const STEP: usize = 7;
/// Every contender draws once from every viewpoint in each round.
const ROUNDS: usize = 7;
const QUICK_ROUNDS: usize = 2;

const KINDS: [Kind; 3] =
    [Kind { size: [84, 84], all: true }, Kind { size: [300, 300], all: true }, Kind { size: [1280, 720], all: false }];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let catalog = Catalog::builtin();
    let meshes = Arc::new(MeshLibrary::build(&catalog)?);
    let office = Office::new(PLAN, &catalog, &meshes);
    let cameras = office.cameras(1, 1, false, STEP);
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("peers");
    let stage = Stage::write(&folder.join(PLAN), &office, &cameras, 0)?;
    let count = cameras.len();
    let own = Own {
        name: format!("cohabit-render {} (CPU, 1 thread)", env!("CARGO_PKG_VERSION")),
        renderer: Box::new(CpuRenderer::new(1)),
        scene: &office.scene,
        cameras,
        ids: &stage.ids,
    };
    let mut contenders: Vec<Box<dyn Contender>> = vec![Box::new(own)];
    for peer in python::start(&folder, &stage.folder) {
        contenders.push(Box::new(peer));
    }
    println!("machine: {}", machine::describe());
    println!(
        "scene: {}, {} objects of {} meshes, {} triangles, {count} viewpoints; shadows are on",
        office.id,
        stage.ids.len(),
        stage.meshes,
        stage.triangles,
    );
    if let Some(folder) = arguments.iter().find_map(|argument| argument.strip_prefix("save=")) {
        return Ok(save(&absolute(folder)?, &mut contenders, count)?);
    }
    let rounds = if arguments.iter().any(|argument| argument == "quick") { QUICK_ROUNDS } else { ROUNDS };
    println!("a frame: mean over the viewpoints of the median of {rounds} rounds; ratio: median over the rounds\n");
    println!(
        "{:>9}  {:38}  {:27}  {:>8}  {:>8}  {:>6}",
        "size", "renderer", "modalities", "CPU ms", "wall ms", "ratio"
    );
    for kind in &KINDS {
        measure(kind, rounds, &mut contenders)?;
    }
    Ok(())
}

/// Keeps what everybody sees.
fn save(folder: &Path, contenders: &mut [Box<dyn Contender + '_>], cameras: usize) -> std::io::Result<()> {
    std::fs::create_dir_all(folder)?;
    let kind = Kind { size: [400, 300], all: true };
    for contender in &mut *contenders {
        contender.draw_all(&kind, Some(folder))?;
    }
    let names: Vec<String> = contenders.iter().map(|contender| contender.name().to_owned()).collect();
    sheet::write(folder, &names, cameras, kind.size)
}

/// Lets all draw in turn, round by round, and says what it took them.
fn measure(kind: &Kind, rounds: usize, contenders: &mut [Box<dyn Contender + '_>]) -> std::io::Result<()> {
    let mut taken: Vec<Vec<Vec<Frame>>> = contenders.iter().map(|_| Vec::new()).collect();
    for round in 0..rounds {
        // Whoever comes first in one round comes later in the next.
        for turn in 0..contenders.len() {
            let who = (round + turn) % contenders.len();
            taken[who].push(contenders[who].draw_all(kind, None)?);
        }
    }
    let in_round = |who: usize, round: usize| taken[who][round].iter().map(|frame| frame.cpu_ms).sum::<f64>();
    for (who, contender) in contenders.iter().enumerate() {
        let ratio = median((0..rounds).map(|round| in_round(who, round) / in_round(0, round)).collect());
        println!(
            "{:>9}  {:38}  {:27}  {:8.2}  {:8.2}  {ratio:6.1}",
            format!("{}x{}", kind.size[0], kind.size[1]),
            contender.name(),
            if kind.all { contender.modalities() } else { "colour" },
            typical(&taken[who], |frame| frame.cpu_ms),
            typical(&taken[who], |frame| frame.wall_ms),
        );
    }
    println!();
    Ok(())
}

/// The mean over the viewpoints of the median over the rounds.
fn typical(rounds: &[Vec<Frame>], time: impl Fn(&Frame) -> f64) -> f64 {
    let viewpoints = rounds[0].len();
    let of = |viewpoint: usize| median(rounds.iter().map(|frames| time(&frames[viewpoint])).collect());
    (0..viewpoints).map(of).sum::<f64>() / viewpoints as f64
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_unstable_by(f64::total_cmp);
    times[times.len() / 2]
}
