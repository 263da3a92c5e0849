//! A mission of a world pack is solved by what is said in it, in the pack's own words; its log names the pack, and is replayed
//! with that pack alone. A device that an entry of a pack's table adds works, is planned with, and is known by what people ask for.

#![allow(clippy::unwrap_used)]

#[allow(dead_code, reason = "shared with the tests of the engine")]
#[path = "../../engine/tests/twenty_rooms/mod.rs"]
mod twenty_rooms;

use std::{fs, sync::Arc};

use cohabit_cdf::{Catalog, PackFile, WorldData, WorldPack, world_pack::template};
use cohabit_dialog::Knows;
use cohabit_engine::replay::replay;
use cohabit_eval::{Line, Settings, Task, play};
use cohabit_generate::certify;
use cohabit_language::Language;
use cohabit_record::Log;

/// A kettle stand that warms what is put on it, by a work of its own: no code knows of it.
const KETTLE: [(&str, &str); 3] = [
    (
        "objects/kettle.toml",
        r#"
[[object]]
id = "Soup_01"
name = "Soup"
properties = ["PICKUPABLE", "HEATABLE", "CHILLABLE"]
size_m = [0.14, 0.14, 0.08]
mass_kg = 0.6
color = "orange"
model = "Wrench_01"
stands = "on_surface"

[[object]]
id = "KettleStand_01"
name = "Kettle Stand"
properties = ["RECEPTACLE", "TOGGLEABLE", "POWERABLE"]
size_m = [0.60, 0.70, 0.88]
mass_kg = 20.0
color = "black"
model = "Degreaser_01"
stands = "on_floor"
receptacle = { surface = [{ center_m = [0.0, 0.0, 0.88], size_m = [0.48, 0.58], anchors = [1, 2], clearance_m = 0.60 }] }
"#,
    ),
    (
        "table/kettle.toml",
        r#"
[[device]]
class = ["KettleStand_01"]
needs = [["it is occupied", "ActionExecutionError", "{it} is empty: something has to be put on it first"]]
press = ["run it"]
work = "simmer"
work_s = 1.0
moment_s = 2.0

[[work]]
name = "simmer"
over = "contents"
effects = [{ if = ["thing affords HEATABLE"], do = ["set thing Hot", "clear thing Cold"] }]
"#,
    ),
    (
        "layouts/Galley.toml",
        r#"
base = "Workshop"
placement = [{ instance = "KettleStand_01_1", room = "Workshop", at_m = [5.60, 1.2, 0.0], yaw_deg = 180.0 }]
"#,
    ),
];

/// The template as a pack, with a line more in its head where that is to be another one, and with more files.
fn world(more: &str, files: &[(&str, &str)]) -> WorldData {
    let own = template("my-lab").into_iter().map(|(path, text)| {
        let text = if path == "world.toml" { format!("{more}{text}") } else { text };
        PackFile { path: path.to_owned(), bytes: text.into_bytes() }
    });
    let added = files.iter().map(|(path, text)| PackFile { path: (*path).to_owned(), bytes: text.as_bytes().to_vec() });
    WorldData::layered(vec![WorldPack::parse("my-lab", own.chain(added).collect()).unwrap()]).unwrap()
}

fn task(id: &str, cdf: &str, said: &[&str]) -> Task {
    Task {
        id: id.to_owned(),
        family: None,
        cdf: cdf.to_owned(),
        preparation: Vec::new(),
        script: said.iter().map(|text| Line::utterance(text)).collect(),
    }
}

#[test]
fn what_is_said_in_the_words_of_a_pack_is_done_and_replayed_with_it_alone() {
    let world = world("", &[]);
    let folder = std::env::temp_dir().join(format!("cohabit-eval-world-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let (name, text) = world.packs()[0].missions().next().unwrap();
    assert!(name.ends_with("clean_wrench.json"));
    let said = ["go to the workshop", "pick up the spanner", "put it on the degreaser", "turn on the degreaser"];
    let task = task("clean_wrench", text, &said);
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
    let other = self::world("# another one\n", &[]);
    let error = replay(&log, Arc::clone(other.catalog())).unwrap_err().to_string();
    assert!(error.contains(&id.digest) && error.contains(&other.packs()[0].id().digest), "{error}");
}

/// The mission of the template, about soup and the kettle stand.
fn warm_soup(world: &WorldData) -> String {
    let (_, text) = world.packs()[0].missions().next().unwrap();
    [
        ("Wrench_01_1", "Soup_01_1"),
        ("Degreaser_01_1", "KettleStand_01_1"),
        (", {\"isDirty\": \"true\"}", ""),
        ("isDirty=false", "isHot=true"),
        ("\"layoutOverride\": \"Workshop\"", "\"layoutOverride\": \"Galley\""),
    ]
    .into_iter()
    .fold(text.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    })
}

#[test]
fn a_device_of_a_pack_is_one_entry_of_its_table() {
    let world = world("", &KETTLE);
    let text = warm_soup(&world);
    let certificate = certify("warm_soup.json", &text, world.catalog(), 1).unwrap();
    let steps: Vec<_> = certificate.plan.iter().map(|step| (step.action, step.object.as_str())).collect();
    assert_eq!(steps.last(), Some(&("toggle", "KettleStand_01_1")), "{steps:?}");

    let settings = Settings { seed: 1, knows: Knows::Everything, ..Settings::default() };
    let language = Language::new(Arc::clone(world.catalog()));
    for said in ["warm the soup with the kettle stand", "heat the soup"] {
        let played = play(&task("warm_soup", &text, &[said]), &settings, &language).unwrap();
        assert!(played.success, "{said}: {:?} {:#?}", played.first_trouble, played.transcript);
    }
    // Nothing happens while it is empty.
    let played = play(&task("warm_soup", &text, &["turn on the kettle stand"]), &settings, &language).unwrap();
    assert!(!played.success, "{:#?}", played.transcript);
}

#[test]
fn a_thing_is_taken_from_a_device_once_its_work_is_done() {
    let world = world("", &[]);
    let (_, text) = world.packs()[0].missions().next().unwrap();
    let settings = Settings { seed: 1, knows: Knows::Everything, ..Settings::default() };
    let language = Language::new(Arc::clone(world.catalog()));
    let played = play(&task("clean_wrench", text, &["clean the wrench"]), &settings, &language).unwrap();
    assert!(played.success, "{:?} {:#?}", played.first_trouble, played.transcript);
}

#[test]
fn a_pack_of_twenty_rooms_is_spoken_of_in_its_own_words() {
    let world = twenty_rooms::world();
    let (_, text) = world.packs()[0].missions().next().unwrap();
    let said = ["go to the music room", "which room are you in?", "go to the winter garden", "which room are you in?"];
    let task = task("tour", text, &said);
    let settings = Settings { seed: 1, knows: Knows::Everything, ..Settings::default() };
    let played = play(&task, &settings, &Language::new(Arc::clone(world.catalog()))).unwrap();
    assert_eq!(played.first_trouble, None, "{:#?}", played.transcript);
    for (place, room) in [(1, "music room"), (3, "sun lounge")] {
        let replies = &played.transcript[place].replies;
        assert!(replies.iter().any(|reply| reply.contains(room)), "{room}: {replies:?}");
    }
}
