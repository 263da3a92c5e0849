//! Any bytes as a file of a world pack, beside those of a sound one: the pack is refused in words, or its floor plans and missions
//! are checked.

#![no_main]

use cohabit_cdf::{Layout, PackFile, WorldData, WorldPack, mission::read_mission, world_pack::template};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Some((place, rest)) = bytes.split_first() else { return };
    let files = template("fuzzed").into_iter();
    let files = files.map(|(path, text)| PackFile { path: path.to_owned(), bytes: text.into_bytes() });
    let mut files: Vec<PackFile> = files.collect();
    let place = usize::from(*place) % files.len();
    files[place].bytes = rest.to_vec();
    let read = WorldPack::parse("fuzzed", files).and_then(|pack| WorldData::layered(vec![pack]));
    let world = match read {
        Ok(world) => world,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    for pack in world.packs() {
        for id in pack.plans() {
            let plan = Layout::find(id, world.catalog()).expect("a plan that was read before");
            plan.faults(world.catalog()).iter().for_each(|fault| assert!(!fault.to_string().is_empty()));
        }
        for (file, text) in pack.missions() {
            let _ = read_mission(file, text, world.catalog());
        }
    }
});
