//! A world pack from its first file to a replay.

use std::path::Path;

use cohabit_tests::{Scratch, run};

use crate::COHABIT;

/// What a command prints, and its exit code.
fn told(arguments: &[&str]) -> (String, Option<i32>) {
    let output = run(COHABIT, arguments).unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    (text, output.status.code())
}

#[test]
fn a_new_world_is_checked_played_and_replayed_with_its_pack_alone() {
    let scratch = Scratch::new("world");
    let (into, logs) = (scratch.path("packs"), scratch.path("logs"));
    std::fs::create_dir_all(&into).unwrap();
    let (text, code) = told(&["new", "world", "my-lab", "--into", &into]);
    assert_eq!(code, Some(0), "{text}");
    let pack = format!("{into}/my-lab");
    let (text, code) = told(&["check", "--world", &pack]);
    assert_eq!(code, Some(0), "{text}");
    assert!(text.contains("2 of 2 floor plans and missions are playable"), "{text}");

    let (text, code) = told(&["catalog", "classes", "--json", "--world", &pack]);
    assert_eq!(code, Some(0), "{text}");
    assert!(text.contains("\"id\": \"Wrench_01\"") && text.contains("\"id\": \"Bowl_01\""), "{text}");
    let (text, _) = told(&["catalog", "rooms", "--world", &pack]);
    assert!(text.lines().any(|line| line.contains("workshop") && line.contains("Workshop")), "{text}");

    let mission = format!("{pack}/missions/clean_wrench.json");
    let how = ["--understanding", "fast", "--knows", "everything", "--workers", "1"];
    let what = ["eval", mission.as_str(), "--world", pack.as_str(), "--record", logs.as_str()];
    let (text, code) = told(&[what.as_slice(), how.as_slice()].concat());
    assert_eq!(code, Some(0), "{text}");
    assert!(!text.contains("not solved"), "{text}");

    let log = format!("{logs}/clean_wrench.mcap");
    assert!(Path::new(&log).is_file(), "{text}");
    let (text, code) = told(&["replay", &log, "--world", &pack]);
    assert_eq!(code, Some(0), "{text}");
    assert!(text.contains("no tick differs"), "{text}");
    let (text, code) = told(&["replay", &log]);
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("`my-lab` 0.1.0 with hash"), "{text}");
}

/// A pyramid of four points: 10 cm wide, 20 cm high and 30 cm deep.
const PYRAMID: &str = concat!(
    r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"#,
    r#""meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],"#,
    r#""materials":[{"pbrMetallicRoughness":{"baseColorFactor":[1,0,0,1],"metallicFactor":0}}],"#,
    r#""animations":[{"channels":[],"samplers":[]}],"#,
    r#""accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},"#,
    r#"{"bufferView":1,"componentType":5121,"count":12,"type":"SCALAR"}],"#,
    r#""bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],"#,
    r#""buffers":[{"byteLength":60,"uri":"data:application/octet-stream;base64,"#,
    "AAAAAAAAAAAAAAAAzczMPQAAAAAAAAAAAAAAAM3MTD4AAAAAAAAAAAAAAACamZk+AAIBAAEDAQIDAgAD",
    r#""}]}"#
);

#[test]
fn an_object_is_imported_from_a_gltf_file_once() {
    let scratch = Scratch::new("import-model");
    let into = scratch.path("packs");
    std::fs::create_dir_all(&into).unwrap();
    let (text, code) = told(&["new", "world", "my-lab", "--into", &into]);
    assert_eq!(code, Some(0), "{text}");
    let (pack, file) = (format!("{into}/my-lab"), scratch.path("pyramid.gltf"));
    std::fs::write(&file, PYRAMID).unwrap();
    let import = |rest: &[&str]| told(&[&["import-model", file.as_str(), "--into", pack.as_str()], rest].concat());

    let (text, code) = import(&[
        "--id",
        "Pyramid_Lab",
        "--name",
        "Lab pyramid",
        "--front",
        "-x",
        "--tint",
        "--properties",
        "PICKUPABLE",
    ]);
    assert_eq!(code, Some(0), "{text}");
    for expected in
        ["4 of 4 triangles", "called Lab pyramid, red", "1 × animation", "2 of 2 floor plans", "--only Pyramid_Lab"]
    {
        assert!(text.contains(expected), "{expected}: {text}");
    }
    let objects = std::fs::read_to_string(format!("{pack}/objects/imported.toml")).unwrap();
    assert!(objects.contains("size_m = [0.1, 0.3, 0.2]") && objects.contains("tint = \"#ff0000\""), "{objects}");
    let (text, code) = told(&["catalog", "classes", "--json", "--world", &pack]);
    assert_eq!(code, Some(0), "{text}");
    assert!(text.contains("\"id\": \"Pyramid_Lab\""), "{text}");

    // What is there already stays as it is.
    for (id, expected) in
        [("Pyramid_Lab", "models/Pyramid_Lab.toml: exists already"), ("Bowl_01", "`Bowl_01` is defined twice")]
    {
        let (text, code) = import(&["--id", id]);
        assert_eq!(code, Some(2), "{text}");
        assert!(text.contains(expected), "{text}");
    }
    assert_eq!(std::fs::read_to_string(format!("{pack}/objects/imported.toml")).unwrap(), objects);
    assert!(!Path::new(&format!("{pack}/models/Bowl_01.toml")).exists());
    let (text, code) = import(&["--id", "Small_Lab", "--height-m", "0.05"]);
    assert_eq!(code, Some(0), "{text}");
}

#[test]
fn nothing_is_imported_into_a_pack_that_comes_with_the_program() {
    let scratch = Scratch::new("import-builtin");
    let file = scratch.write("pyramid.gltf", PYRAMID);
    let mut command = std::process::Command::new(COHABIT);
    command.args(["import-model", file.as_str(), "--id", "Pyramid_Lab", "--into", "homes"]);
    let output = command.current_dir(scratch.path("")).output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(text.contains("homes: there is no such folder: write a pack by `cohabit new world"), "{text}");
    // A folder of that name would stand in the way of the pack for ever.
    assert!(!Path::new(&scratch.path("homes")).exists(), "{text}");
}

#[test]
fn a_room_without_a_door_is_refused_with_its_name_and_what_to_write() {
    let scratch = Scratch::new("no-door");
    let into = scratch.path("packs");
    std::fs::create_dir_all(&into).unwrap();
    let (text, code) = told(&["new", "world", "shut", "--into", &into]);
    assert_eq!(code, Some(0), "{text}");
    let pack = format!("{into}/shut");
    let plan = format!("{pack}/layouts/Workshop.toml");
    let whole = std::fs::read_to_string(&plan).unwrap();
    let check = |kept: &dyn Fn(&&str) -> bool, expected: &str| {
        let text: String = whole.lines().filter(kept).map(|line| format!("{line}\n")).collect();
        std::fs::write(&plan, text).unwrap();
        for what in ["check", "catalog"] {
            let (text, code) = told(&[what, "--world", pack.as_str()]);
            assert_eq!(code, Some(2), "{text}");
            assert!(text.contains(expected), "{text}");
        }
    };
    check(&|line| !line.contains("kind = \"door\""), "Workshop cannot be reached: no door or passage leads into it");
    // A viewpoint alone that is missing is found by `check`.
    let text: String =
        whole.lines().filter(|line| !line.contains("number = 7")).map(|line| format!("{line}\n")).collect();
    std::fs::write(&plan, text).unwrap();
    let (text, code) = told(&["check", "--world", &pack]);
    assert!(code == Some(2) && text.contains("Hallway has no viewpoint 7; each room has viewpoints 1 to 8"), "{text}");
}

#[test]
fn a_pack_with_a_model_that_cannot_be_drawn_is_not_playable() {
    let scratch = Scratch::new("undrawn");
    let (text, code) = told(&["new", "world", "odd", "--into", &scratch.path("")]);
    assert_eq!(code, Some(0), "{text}");
    let pack = scratch.path("odd");
    let model = "[[model]]\nid = \"Flat_01\"\npart = [{ shape = \"sphere\", radii = [1.0, 0.0, 1.0] }]\n";
    std::fs::write(format!("{pack}/models/flat.toml"), model).unwrap();
    let (text, code) = told(&["check", "--world", &pack]);
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("odd: not playable") && text.contains("model `Flat_01`, part 1: `radii` is 0"), "{text}");
}

#[test]
fn floor_plans_made_at_random_are_a_world_pack_in_which_missions_are_solved() {
    let scratch = Scratch::new("generate-world");
    let pack = scratch.path("flats");
    let make = |folder: &str, workers: &str| {
        let how = ["--kind", "home", "--rooms", "5", "--seed", "7", "--count", "3", "--workers", workers];
        told(&[&["generate-world", "--name", "flats", "--out", folder], how.as_slice()].concat())
    };
    let (text, code) = make(&pack, "2");
    assert_eq!(code, Some(0), "{text}");
    assert!(text.contains(&format!("cohabit check --world homes --world {pack}")), "{text}");
    let (text, code) = told(&["check", "--world", "homes", "--world", &pack]);
    assert_eq!(code, Some(0), "{text}");
    for number in 0..3 {
        assert!(text.contains(&format!("layouts/Home5_7_00{number}.toml: playable")), "{text}");
    }
    let (text, _) = told(&["catalog", "rooms", "--world", "homes", "--world", &pack]);
    assert!(text.contains("living room") && text.contains("LivingRoom"), "{text}");

    let other = scratch.path("again");
    let (text, code) = make(&other, "1");
    assert_eq!(code, Some(0), "{text}");
    for file in ["world.toml", "layouts/Home5_7_000.toml", "layouts/Home5_7_002.toml"] {
        let read = |folder: &str| std::fs::read(format!("{folder}/{file}")).unwrap();
        assert!(read(&pack) == read(&other), "{file} depends on the number of workers");
    }

    let spec = scratch.write(
        "spec.toml",
        "pools = { layouts = [\"Home5_7_000\", \"Home5_7_001\", \"Home5_7_002\"] }\n\
         [[type]]\nname = \"bring\"\nvars = [{ name = \"thing\", class = [\"Apple\", \"Bowl_01\"] }, \
         { name = \"place\", kind = \"surface\" }]\ngoals = [\"place Contains=thing\"]\n",
    );
    let missions = scratch.path("missions.jsonl");
    let worlds = ["--world", "homes", "--world", &pack];
    let (text, code) = told(&[&["generate", &spec, "--count", "3", "--out", &missions], worlds.as_slice()].concat());
    assert_eq!(code, Some(0), "{text}");
    let (text, code) = told(&[&["eval", &missions, "--agent", "expert", "--workers", "1"], worlds.as_slice()].concat());
    assert_eq!(code, Some(0), "{text}");
    assert!(!text.contains("not solved"), "{text}");
}

#[test]
fn floor_plans_that_cannot_be_made_are_refused_with_what_would_be_right() {
    let scratch = Scratch::new("no-plans");
    let out = scratch.path("flats");
    let check = |arguments: &[&str], expected: &str| {
        let (text, code) = told(&[&["generate-world", "--out", &out], arguments].concat());
        assert_eq!(code, Some(2), "{text}");
        assert!(text.contains(expected), "{text}");
        assert!(!Path::new(&out).exists(), "{text}");
    };
    check(&["--kind", "castle"], "write `office` or `home`");
    check(&["--kind", "home", "--rooms", "0"], "from 1 to 12");
    check(&["--kind", "office", "--rooms", "200"], "from 1 to 12");
    check(&["--kind", "home", "--count", "1000"], "from 1 to 990");
    check(&["--kind", "home", "--name", "My Homes"], "is no name of a world pack");
    check(&["--kind", "home", "--name", "homes"], "the name of a world pack that comes with the program");
}

/// A house in the format of ProcTHOR.
const HOUSE: &str = include_str!("../../runtime/houses/tests/data/flat.json");

#[test]
fn houses_of_procthor_are_a_world_pack_beside_homes() {
    let scratch = Scratch::new("import-house");
    let house: serde_json::Value = serde_json::from_str(HOUSE).unwrap();
    let lines = scratch.write("houses.jsonl", &format!("{house}\n\n{{\"rooms\": 7}}\n{house}\n"));
    let pack = scratch.path("thor");
    let (text, code) = told(&["import-house", &lines, "--into", &pack, "--prefix", "Flat"]);
    assert_eq!(code, Some(0), "{text}");
    assert!(text.contains("2 of 3 houses") && text.contains("houses.jsonl:3: /rooms: it is no list"), "{text}");
    assert!(
        text.contains("Flat0000: 4 rooms, 4 doors, 2 windows") && text.contains("left out: 1 AlienProbe"),
        "{text}"
    );
    let (text, code) = told(&["check", "--world", "homes", "--world", &pack]);
    assert_eq!(code, Some(0), "{text}");
    let (text, _) = told(&["catalog", "--world", "homes", "--world", &pack]);
    assert!(text.contains("Flat0000") && text.contains("Flat0002"), "{text}");

    let file = scratch.write("house.json", HOUSE);
    let (text, code) = told(&["import-house", &file, "--into", &scratch.path("one"), "--json"]);
    assert_eq!(code, Some(0), "{text}");
    let report: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!((&report[0]["plan"], &report[0]["report"]["rooms"]), (&"Thor0000".into(), &4.into()), "{text}");
}

#[test]
fn what_is_no_house_is_refused_and_leaves_no_folder() {
    let scratch = Scratch::new("no-house");
    let out = scratch.path("thor");
    let check = |file: &str, more: &[&str], expected: &str| {
        let (text, code) = told(&[&["import-house", file, "--into", &out], more].concat());
        assert_eq!(code, Some(2), "{text}");
        assert!(text.contains(expected) && !Path::new(&out).exists(), "{text}");
    };
    let house = scratch.write("house.json", HOUSE);
    check(&house, &["--count", "0"], "from 1 to 990");
    check(&house, &["--prefix", "a/b"], "cannot begin the ids of floor plans");
    check(&house, &["--name", "My Houses"], "is no name of a world pack");
    check(&scratch.path("none.json"), &[], "none.json");
    check(&scratch.write("empty.jsonl", "\n\n"), &[], "there is no house in it");
    check(&scratch.write("list.json", "[]"), &[], "list.json: the house: it is no object");
}

#[test]
fn what_is_no_world_is_refused() {
    let scratch = Scratch::new("no-world");
    let into = scratch.path("packs");
    std::fs::create_dir_all(&into).unwrap();
    for name in ["../x", "X", "", "homes"] {
        let (text, code) = told(&["new", "world", name, "--into", &into]);
        assert_eq!(code, Some(2), "{text}");
    }
    assert!(!Path::new(&format!("{into}/homes")).exists());
    let (text, code) = told(&["check", "--world", &into]);
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("there is no `world.toml`"), "{text}");
    let (text, code) = told(&["new", "world", "twice", "--into", &into]);
    assert_eq!(code, Some(0), "{text}");
    let (text, code) = told(&["new", "world", "twice", "--into", &into]);
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("exists already"), "{text}");
    let pack = format!("{into}/twice");
    let (text, code) = told(&["check", "--world", &pack, "--world", &pack]);
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("the world pack `twice` is in "), "{text}");
}
