//! What building, stepping, digesting and snapshotting a world cost on this machine.

use std::{sync::Arc, time::Instant};

use cohabit_cdf::{Catalog, Layout, RoomId, mission};
use cohabit_world::{Action, BodyId, GoToTarget, Input, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let catalog = Arc::new(Catalog::builtin());
    let (name, text) = mission::builtin().first().ok_or("there is no built-in mission")?;
    let checked = mission::read_mission(name, text, &catalog).map_err(|problems| problems.0[0].to_string())?;
    let layout = Arc::new(Layout::builtin(&checked.mission.layout)?);
    let begin = Instant::now();
    let mut world = World::new(catalog, layout, Arc::new(checked.mission), 1)?;
    println!("build {:?}, {} objects", begin.elapsed(), world.objects().len());
    let mut steps = Vec::new();
    let mut digests = Vec::new();
    for tick in 0..3000 {
        let room = RoomId::from_index((tick / 600) % 8).ok_or("eight rooms")?;
        let walk =
            Input { command: tick.into(), body: BodyId(0), action: Action::GoTo { target: GoToTarget::Room(room) } };
        let inputs: &[Input] = if tick % 600 == 0 { &[walk] } else { &[] };
        let begin = Instant::now();
        world.step(inputs);
        steps.push(begin.elapsed());
        let begin = Instant::now();
        std::hint::black_box(world.digest());
        digests.push(begin.elapsed());
    }
    for (what, mut times) in [("step", steps), ("digest", digests)] {
        times.sort();
        println!("{what} p50 {:?}, p99 {:?}, most {:?}", times[1500], times[2970], times[2999]);
    }
    let begin = Instant::now();
    let snapshot = world.snapshot();
    println!("snapshot {:?}, {} bytes", begin.elapsed(), snapshot.len());
    let begin = Instant::now();
    world.restore(&snapshot)?;
    println!("restore {:?}", begin.elapsed());
    Ok(())
}
