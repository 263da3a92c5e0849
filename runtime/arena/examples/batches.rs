//! How many batches a second an arena answers on this machine: `cargo run --release -p cohabit-arena --example batches`.

use std::{error::Error, sync::Arc, time::Instant};

use cohabit_arena::{Arena, Settings};
use cohabit_cdf::{Catalog, mission};
use cohabit_render::{CpuRenderer, MeshLibrary};
use serde_json::{Value, json};

/// Batches of each kind.
const ROUNDS: usize = 200;

fn main() -> Result<(), Box<dyn Error>> {
    let catalog = Arc::new(Catalog::builtin());
    let meshes = Arc::new(MeshLibrary::build(&catalog)?);
    meshes.bake_all(&std::sync::atomic::AtomicBool::new(false));
    let logs = std::env::temp_dir().join(format!("cohabit-batches-{}", std::process::id()));
    std::fs::create_dir_all(&logs)?;
    let name = "batches".to_owned();
    let settings = Settings { catalog, meshes, seed: 1, bodies: Vec::new(), logs: logs.clone(), name };
    let mut arena = Arena::new(settings, Box::new(CpuRenderer::new(2)));
    let began = Instant::now();
    let (file, text) = mission::builtin().first().ok_or("there are missions")?;
    arena.launch(file, text);
    println!("launched in {:.1} ms", began.elapsed().as_secs_f64() * 1e3);
    let rotate = |degrees: f32| json!([{"commandType": "Rotate", "magnitude": degrees}]);
    let go = |room: &str| json!([{"commandType": "GoTo", "goToCommand": {"officeRoom": room}}]);
    measure(&mut arena, "no command, one view", &[json!([])])?;
    measure(&mut arena, "Rotate by 1 degree, one view", &[rotate(1.0)])?;
    measure(&mut arena, "Rotate by 90 degrees, one view", &[rotate(90.0)])?;
    measure(&mut arena, "LookAround, four views", &[json!([{"commandType": "LookAround"}])])?;
    measure(&mut arena, "GoTo another room, one view", &[go("Warehouse"), go("BreakRoom")])?;
    arena.finish();
    std::fs::remove_dir_all(logs)?;
    Ok(())
}

fn measure(arena: &mut Arena, what: &str, batches: &[Value]) -> Result<(), Box<dyn Error>> {
    let messages: Vec<Vec<u8>> = batches.iter().map(serde_json::to_vec).collect::<Result<_, _>>()?;
    let mut bytes = 0;
    let began = Instant::now();
    for message in messages.iter().cycle().take(ROUNDS) {
        bytes += arena.answer(message, false).ok_or("a batch is answered")?.len();
    }
    let seconds = began.elapsed().as_secs_f64();
    println!("{what}: {:.0} batches/s, {} kB a reply", ROUNDS as f64 / seconds, bytes / ROUNDS / 1000);
    Ok(())
}
