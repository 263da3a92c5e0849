//! A mission of a world pack is solved by what is said in it, in the pack's own words; its log names the pack, and is replayed
//! with that pack alone.

#![allow(clippy::unwrap_used)]

#[allow(dead_code, reason = "shared with the tests of the engine")]
#[path = "../../engine/tests/twenty_rooms/mod.rs"]
mod twenty_rooms;

use std::{fs, sync::Arc};

use cohabit_cdf::{Catalog, PackFile, WorldData, WorldPack, world_pack::template};
use cohabit_dialog::Knows;
use cohabit_engine::replay::replay;
use cohabit_eval::{Line, Settings, Task, play};
use cohabit_language::Language;
use cohabit_record::Log;

/// The template as a pack, with a line more in its head where that is to be another one.
fn world(more: &str) -> WorldData {
    let files = template("my-lab").into_iter().map(|(path, text)| {
        let text = if path == "world.toml" { format!("{more}{text}") } else { text };
        PackFile { path: path.to_owned(), bytes: text.into_bytes() }
    });
    WorldData::layered(vec![WorldPack::parse("my-lab", files.collect()).unwrap()]).unwrap()
}

#[test]
fn what_is_said_in_the_words_of_a_pack_is_done_and_replayed_with_it_alone() {
    let world = world("");
    let folder = std::env::temp_dir().join(format!("cohabit-eval-world-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let (name, text) = world.packs()[0].missions().next().unwrap();
    assert!(name.ends_with("clean_wrench.json"));
    let said = ["go to the workshop", "pick up the spanner", "put it on the degreaser", "turn on the degreaser"];
    let task = Task {
        id: "clean_wrench".to_owned(),
        family: None,
        cdf: text.to_owned(),
        preparation: Vec::new(),
        script: said.map(Line::utterance).into(),
    };
    let settings = Settings { seed: 1, knows: Knows::Everything, record: Some(folder.clone()), ..Settings::default() };
    let played = play(&task, &settings, &Language::new(Arc::clone(world.catalog()))).unwrap();
    assert!(played.success, "{:?} {:?} {:#?}", played.ended_early, played.first_trouble, played.transcript);
    let replies: Vec<&String> = played.transcript[0].replies.iter().collect();
    assert!(replies.iter().any(|reply| reply.contains("workshop")), "{replies:?}");

    let log = Log::open(&played.log.unwrap()).unwrap();
    fs::remove_dir_all(folder).unwrap();
    let id = world.packs()[0].id();
    assert_eq!(log.session.packs, std::slice::from_ref(id));
    assert!(log.session.settings["world"].contains(&id.digest), "{:?}", log.session.settings);
    assert_eq!(replay(&log, Arc::clone(world.catalog())).unwrap().difference, None);

    let absent = replay(&log, Arc::new(Catalog::builtin())).unwrap_err().to_string();
    assert!(absent.contains("`my-lab`") && absent.contains(&id.digest) && absent.contains("--world"), "{absent}");
    let other = self::world("# another one\n");
    let error = replay(&log, Arc::clone(other.catalog())).unwrap_err().to_string();
    assert!(error.contains(&id.digest) && error.contains(&other.packs()[0].id().digest), "{error}");
}

#[test]
fn a_pack_of_twenty_rooms_is_spoken_of_in_its_own_words() {
    let world = twenty_rooms::world();
    let (_, text) = world.packs()[0].missions().next().unwrap();
    let said = ["go to the music room", "which room are you in?", "go to the winter garden", "which room are you in?"];
    let task = Task {
        id: "tour".to_owned(),
        family: None,
        cdf: text.to_owned(),
        preparation: Vec::new(),
        script: said.map(Line::utterance).into(),
    };
    let settings = Settings { seed: 1, knows: Knows::Everything, ..Settings::default() };
    let played = play(&task, &settings, &Language::new(Arc::clone(world.catalog()))).unwrap();
    assert_eq!(played.first_trouble, None, "{:#?}", played.transcript);
    for (place, room) in [(1, "music room"), (3, "sun lounge")] {
        let replies = &played.transcript[place].replies;
        assert!(replies.iter().any(|reply| reply.contains(room)), "{room}: {replies:?}");
    }
}
