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
//! one level of detail; which of them it leaves out, and how, is its own affair. What it does not deliver costs it nothing.

#[path = "../frames/buffers.rs"]
mod buffers;
mod contender;
#[path = "../frames/machine.rs"]
mod machine;
#[path = "../frames/office.rs"]
mod office;
mod python;
mod stage;

use std::error::Error;
use std::io;
use std::path::{Path, absolute};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use cohabit_cdf::Catalog;
use cohabit_gpu::{Adapter, GpuRenderer, Wanted};
use cohabit_render::{CpuRenderer, MeshLibrary, Renderer};

use contender::{Contender, Frame, Kind, Own, Peer, short};
use office::Office;
use stage::Stage;

const VERSION: &str = env!("CARGO_PKG_VERSION");
/// The floor plan looked at.
const PLAN: &str = "OfficeLayout1";
/// The levels of detail at which others draw it, whatever is near or far; this project chooses by distance.
const LEVELS: [usize; 2] = [0, 2];
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
    meshes.bake_all(&AtomicBool::new(false));
    let office = Office::new(PLAN, &catalog, &meshes);
    let cameras = office.cameras(1, 1, false, STEP);
    let viewpoints = cameras.len();
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("peers");
    let mut stages = Vec::new();
    for level in LEVELS {
        stages.push(Stage::write(&folder.join(format!("{PLAN}-{level}")), &office, &cameras, level)?);
    }
    println!("machine: {}", machine::describe());
    println!("scene: {}, {} objects, {viewpoints} viewpoints; shadows are on", office.id, stages[0].ids.len());
    for (stage, level) in stages.iter().zip(["finest", "coarsest"]) {
        println!("at the {level} level: {} triangles in {} meshes", stage.triangles, stage.meshes);
    }
    let own = |name: &str, renderer: Box<dyn Renderer>| -> Box<dyn Contender> {
        let name = format!("{name} {VERSION}");
        Box::new(Own { name, renderer, scene: &office.scene, cameras: cameras.clone(), stage: &stages[0] })
    };
    let mut contenders = vec![own("cohabit-render", Box::new(CpuRenderer::new(1)))];
    match Adapter::find(Wanted::Any).and_then(|adapter| GpuRenderer::new(&adapter, 1)) {
        Ok(renderer) => {
            println!("cohabit-gpu draws on {}", renderer.describe());
            contenders.push(own("cohabit-gpu", Box::new(renderer)));
        }
        Err(error) => println!("cohabit-gpu is not measured: {error}"),
    }
    let save_in = arguments.iter().find_map(|argument| argument.strip_prefix("save="));
    match python::environment(&folder.join("venv")) {
        Ok(python) => {
            if let Some(folder) = save_in {
                contenders.extend(boxed(python::start(&python, &stages[0])));
                return Ok(save(&absolute(folder)?, &python, &mut contenders, viewpoints)?);
            }
            contenders.extend(stages.iter().flat_map(|stage| boxed(python::start(&python, stage))));
        }
        Err(error) => println!("no peers are measured: {error}"),
    }
    let rounds = if arguments.iter().any(|argument| argument == "quick") { QUICK_ROUNDS } else { ROUNDS };
    println!(
        "a frame: mean over the viewpoints of the median of {rounds} rounds; ratio: of CPU time, median of the rounds"
    );
    for kind in &KINDS {
        measure(kind, rounds, &mut contenders)?;
    }
    Ok(())
}

fn boxed<'a>(peers: Vec<Peer>) -> impl Iterator<Item = Box<dyn Contender + 'a>> {
    peers.into_iter().map(|peer| Box::new(peer) as Box<dyn Contender>)
}

/// Keeps what everybody sees.
fn save(folder: &Path, python: &Path, contenders: &mut [Box<dyn Contender + '_>], viewpoints: usize) -> io::Result<()> {
    std::fs::create_dir_all(folder)?;
    let kind = Kind { size: [400, 300], all: true };
    let [width, height] = kind.size;
    let mut arguments =
        vec![folder.display().to_string(), width.to_string(), height.to_string(), viewpoints.to_string()];
    for contender in contenders {
        contender.draw_all(&kind, Some(folder))?;
        arguments.push(short(contender.name()).to_owned());
    }
    python::run_script(python, "sheet.py", &arguments)
}

/// Lets all draw in turn, round by round, and says what it took them.
fn measure(kind: &Kind, rounds: usize, contenders: &mut [Box<dyn Contender + '_>]) -> io::Result<()> {
    let mut taken: Vec<Vec<Vec<Frame>>> = contenders.iter().map(|_| Vec::new()).collect();
    for round in 0..rounds {
        // Whoever comes first in one round comes later in the next.
        for turn in 0..contenders.len() {
            let who = (round + turn) % contenders.len();
            taken[who].push(contenders[who].draw_all(kind, None)?);
        }
    }
    println!("\n{:38}  triangles  {:27}    CPU ms   wall ms   ratio", size_of(kind), "modalities");
    let in_round = |who: usize, round: usize| taken[who][round].iter().map(|frame| frame.cpu_ms).sum::<f64>();
    for (who, contender) in contenders.iter().enumerate() {
        let ratio = median((0..rounds).map(|round| in_round(who, round) / in_round(0, round)).collect());
        println!(
            "{:38}  {:9}  {:27}  {:8.2}  {:8.2}  {ratio:6.1}",
            contender.name(),
            contender.triangles(),
            if kind.all { contender.modalities() } else { "colour" },
            typical(&taken[who], |frame| frame.cpu_ms),
            typical(&taken[who], |frame| frame.wall_ms),
        );
    }
    Ok(())
}

fn size_of(kind: &Kind) -> String {
    format!("{}x{}", kind.size[0], kind.size[1])
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
