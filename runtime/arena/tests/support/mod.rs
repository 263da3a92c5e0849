//! An arena to send messages to, and missions to launch in it.

#![allow(clippy::unwrap_used, dead_code)]

use std::{
    path::{Path, PathBuf},
    sync::{
        Arc, OnceLock,
        atomic::{AtomicU32, Ordering},
    },
};

use cohabit_arena::{Arena, Settings};
use cohabit_cdf::Catalog;
use cohabit_render::{CpuRenderer, MeshLibrary};
use serde_json::{Value, json};

/// A folder of its own for each test, gone when dropped.
pub struct Folder(pub PathBuf);

impl Folder {
    pub fn new() -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let name = format!("cohabit-arena-{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        let path = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    /// The logs of games in it, in the order of the games.
    pub fn logs(&self) -> Vec<PathBuf> {
        let mut logs: Vec<PathBuf> = std::fs::read_dir(&self.0).unwrap().map(|entry| entry.unwrap().path()).collect();
        logs.sort();
        logs
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// An arena without a game, whose logs go into that folder.
pub fn arena(logs: &Path) -> Arena {
    static PARTS: OnceLock<(Arc<Catalog>, Arc<MeshLibrary>)> = OnceLock::new();
    let (catalog, meshes) = PARTS.get_or_init(|| {
        let catalog = Arc::new(Catalog::builtin());
        let meshes = Arc::new(MeshLibrary::build(&catalog).unwrap());
        (catalog, meshes)
    });
    let settings = Settings {
        catalog: Arc::clone(catalog),
        meshes: Arc::clone(meshes),
        seed: 1,
        bodies: Vec::new(),
        logs: logs.to_owned(),
        name: "test".to_owned(),
    };
    Arena::new(settings, Box::new(CpuRenderer::new(1)))
}

/// The text of a mission of the project's own.
pub fn builtin(name: &str) -> &'static str {
    cohabit_cdf::mission::builtin().iter().find(|(file, _)| file.starts_with(name)).unwrap().1
}

/// A mission in the first floor plan that asks for these objects.
pub fn mission(objects: Value) -> String {
    json!({"goal_text": "g", "task_description": "d", "scene": {"floor_plan": "0", "scene_id": "s", "simbot_init": [],
        "roomLocation": ["BreakRoom"], "layoutOverride": "OfficeLayout1", "required_objects": objects,
        "sticky_notes": null}, "task_goals": [], "stateconditions": []})
    .to_string()
}

/// An object of a mission: in or on what, if anything, and its states.
pub fn object(name: &str, location: Value, state: Value) -> Value {
    json!({"name": name, "state": state, "location": location, "roomLocation": [], "colors": []})
}

/// An arena, with what a client needs to talk to it.
pub struct Client {
    pub arena: Arena,
    pub folder: Folder,
    sent: bool,
}

impl Client {
    pub fn new() -> Self {
        let folder = Folder::new();
        Self { arena: arena(&folder.0), folder, sent: false }
    }

    /// With a game of that mission.
    pub fn launched(cdf: &str) -> Self {
        let mut client = Self::new();
        assert!(client.send(cdf.as_bytes()).is_none());
        client
    }

    pub fn send(&mut self, message: &[u8]) -> Option<Value> {
        let first = !std::mem::replace(&mut self.sent, true);
        self.arena.answer(message, first).map(|answer| serde_json::from_slice(&answer).unwrap())
    }

    /// The reply to these commands.
    pub fn batch(&mut self, commands: &[Value]) -> Value {
        self.send(Value::from(commands).to_string().as_bytes()).unwrap()
    }

    /// Does what a line of short words says, such as `goto Bowl_01_1`, and finds that status.
    pub fn check(&mut self, line: &str, status: &str) -> Value {
        let reply = self.batch(&[command(line)]);
        assert_eq!(reply["lastActionSuccess"], status, "{line}: {}", reply["message"]);
        reply
    }

    pub fn must(&mut self, lines: &[&str]) {
        for line in lines {
            let status = self.batch(&[command(line)])["lastActionSuccess"].clone();
            assert!(
                ["ActionSuccessful", "AlternateNavigationUsed"].contains(&status.as_str().unwrap()),
                "{line}: {status}"
            );
        }
    }
}

/// The command that a line of short words says.
pub fn command(line: &str) -> Value {
    let words: Vec<&str> = line.split(' ').collect();
    let hand = |kind: &str, id: &str| json!({"commandType": kind, "pickUpOrPlaceCommand": {"destinationObjectID": id}});
    let go = |field: &str, id: &str| json!({"commandType": "GoTo", "goToCommand": {field: id}});
    match words[..] {
        ["goto", id] => go("instanceIdOfObject", id),
        ["room", id] => go("officeRoom", id),
        ["point", id] => go("goToPoint", id),
        ["pickup", id] => hand("PickUp", id),
        ["place", id] => hand("Place", id),
        ["rotate", degrees] => json!({"commandType": "Rotate", "magnitude": degrees.parse::<f32>().unwrap()}),
        ["forward", metres] => json!({"commandType": "MoveForward", "magnitude": metres.parse::<f32>().unwrap()}),
        [verb, id] => interact(verb, "TAM_1", id),
        [verb, source, id] => interact(verb, source, id),
        _ => panic!("{line}"),
    }
}

fn interact(verb: &str, source: &str, destination: &str) -> Value {
    json!({"commandType": "Interact", "interactCommand": {"sourceObjectID": source, "destinationObjectID": destination,
        "verb": verb.to_uppercase()}})
}
