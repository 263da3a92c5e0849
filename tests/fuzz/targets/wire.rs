//! Any bytes from a client, in pieces: every message but a mission is answered by JSON with a status, and a game, once there
//! is one, goes on.

#![no_main]

use std::sync::{Arc, LazyLock, Mutex};

use cohabit_arena::{Arena, Inbox, Settings};
use cohabit_cdf::{Catalog, mission};
use cohabit_render::{CpuRenderer, MeshLibrary};
use libfuzzer_sys::fuzz_target;

/// An arena in the middle of a game; missions that are found are recorded where nobody looks for them.
static ARENA: LazyLock<Mutex<Arena>> = LazyLock::new(|| {
    let logs = std::env::temp_dir().join(format!("cohabit-fuzz-wire-{}", std::process::id()));
    std::fs::create_dir_all(&logs).expect("a temporary folder");
    let catalog = Arc::new(Catalog::builtin());
    let meshes = Arc::new(MeshLibrary::build(&catalog).expect("the project's own models"));
    let settings = Settings { catalog, meshes, seed: 1, bodies: Vec::new(), logs, name: "fuzz".to_owned() };
    let mut arena = Arena::new(settings, Box::new(CpuRenderer::new(1)));
    let (file, text) = mission::builtin().first().expect("there are missions");
    arena.launch(file, text);
    Mutex::new(arena)
});

fuzz_target!(|bytes: &[u8]| {
    let Some((piece, rest)) = bytes.split_first() else { return };
    let mut arena = ARENA.lock().expect("no panic before");
    let mut inbox = Inbox::default();
    for piece in rest.chunks(usize::from(*piece).max(1)) {
        inbox.push(piece);
        loop {
            match inbox.next() {
                Ok(Some(message)) => check(arena.answer(&message, false)),
                Ok(None) => break,
                Err(error) => return check(Some(Arena::answer_to_too_long(error))),
            }
        }
    }
    // The same as one message, so that what is in it need not be found behind a length.
    check(arena.answer(rest, false));
});

fn check(answer: Option<Vec<u8>>) {
    let Some(answer) = answer else { return };
    let reply: serde_json::Value = serde_json::from_slice(&answer).expect("a reply is JSON");
    assert!(reply["lastActionSuccess"].as_str().is_some_and(|status| !status.is_empty()));
}
