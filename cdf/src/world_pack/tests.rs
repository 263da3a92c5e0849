#![allow(clippy::unwrap_used)]

use super::*;
use crate::{mission::read_mission, room::RoomId};

fn file(path: &str, text: &str) -> PackFile {
    PackFile { path: path.to_owned(), bytes: text.as_bytes().to_vec() }
}

/// The template's files, with these in the place of those of the same path, or beside them.
fn files(name: &str, more: &[(&str, &str)]) -> Vec<PackFile> {
    let kept = template(name).into_iter().filter(|(path, _)| more.iter().all(|(other, _)| other != path));
    let kept: Vec<PackFile> = kept.map(|(path, text)| file(path, &text)).collect();
    kept.into_iter().chain(more.iter().map(|(path, text)| file(path, text))).collect()
}

fn world(packs: Vec<Vec<PackFile>>) -> Result<WorldData, PackErrors> {
    let folders = ["first", "second", "third"];
    let packs = packs.into_iter().zip(folders).map(|(files, folder)| WorldPack::parse(folder, files));
    WorldData::layered(packs.collect::<Result<_, _>>()?)
}

const HEAD_OF_OTHER: &str = "name = \"other\"\nversion = \"1\"\nlicence = \"MIT\"\ndescription = \"Another one\"\n";

#[test]
fn the_template_is_a_world_without_faults() {
    let world = world(vec![files("my-lab", &[])]).unwrap();
    let catalog = world.catalog();
    assert_eq!(catalog.packs()[0].name, "my-lab");
    assert!(catalog.find("Wrench_01").is_some() && catalog.table().is_device("Degreaser_01"));
    let plan = Layout::find("Workshop", catalog).unwrap();
    let faults = plan.faults(catalog);
    assert!(faults.is_empty(), "{faults:?}");
    let workshop = RoomId::new("Workshop").unwrap();
    assert_eq!((workshop.name_in(catalog), catalog.room_index(workshop)), ("workshop", Some(8)));
    assert_eq!((catalog.room_at(8), catalog.room_at(9)), (Some(workshop), None));
    assert_eq!(plan.rooms[0].id, workshop);
    assert_eq!(RoomId::HALLWAY.name_in(catalog), "hallway");
    for (name, text) in world.packs()[0].missions() {
        let checked = read_mission(name, text, catalog).unwrap();
        assert!(checked.warnings.is_empty(), "{:?}", checked.warnings);
        assert_eq!(checked.mission.layout, "Workshop");
    }
    assert!(world.missions().any(|(name, _)| name == "clean_wrench.json"));
}

#[test]
fn without_packs_it_is_what_is_built_in() {
    let (layered, builtin) = (world(vec![]).unwrap(), Catalog::builtin());
    assert_eq!(layered.catalog().classes(), builtin.classes());
    assert_eq!(Layout::ids(layered.catalog()), Layout::builtin_ids());
}

#[test]
fn a_later_pack_may_add_to_an_earlier_one() {
    let spare = "base = \"Workshop\"\nplacement = [{ instance = \"TrashCan_01_1\", room = \"Hallway\", at_m = [0.4, 7.6, 0.0] }]";
    let other = vec![file("world.toml", HEAD_OF_OTHER), file("layouts/Spare.toml", spare)];
    let world = world(vec![files("my-lab", &[]), other]).unwrap();
    let plan = Layout::find("Spare", world.catalog()).unwrap();
    assert!(plan.placement("TrashCan_01_1").is_some() && plan.placement("Degreaser_01_1").is_some());
}

#[test]
fn the_hash_follows_from_all_files_and_not_from_their_order() {
    let digest = |files: Vec<PackFile>| WorldPack::parse("pack", files).unwrap().id().digest.clone();
    let plain = digest(files("my-lab", &[]));
    let mut turned = files("my-lab", &[]);
    turned.reverse();
    assert_eq!(digest(turned), plain);
    assert_ne!(digest(files("my-lab", &[("README.md", "a note")])), plain);
    assert_ne!(digest(files("my-lab", &[("missions/clean_wrench.script", "stop")])), plain);
    assert_ne!(digest(files("your-lab", &[])), plain);
}

#[test]
fn what_is_wrong_is_named_with_its_file_its_place_and_what_would_be_right() {
    let head = |line: &str| format!("{HEAD_OF_OTHER}{line}\n");
    let object = |line: &str| {
        let class = "[[object]]\nid = \"Box_99\"\nname = \"Crate\"\ncolor = \"red\"\nmodel = \"Wrench_01\"\n";
        format!("{class}{line}\n")
    };
    let many = format!(
        "[[model]]\nid = \"M\"\npart = [{}]",
        "{ shape = \"sphere\", radii = [1, 1, 1], repeat = { count = 5000, step = [0, 0, 0] } }"
    );
    let many_rooms: String =
        (0..57).map(|number| format!("[[room]]\nid = \"Room{number}\"\nname = \"room {number}\"\n")).collect();
    let huge = "room = [{ id = \"Hallway\", rects_m = [[0.0, 0.0, 5000.0, 2.0]], floor = { material = \"tile\", color = \"#ffffff\" }, wall = { material = \"plain\", color = \"#eeeeee\" }, circuit = 1 }]";
    let itself = "base = \"Workshop\"\nplacement = [{ instance = \"Desk_01_1\", room = \"Workshop\", on = \"Degreaser_01_1\" }, { instance = \"Degreaser_01_1\", room = \"Workshop\", on = \"Desk_01_1\" }]";
    let alone = "base = \"Workshop\"\nroom = [{ id = \"Workshop\", rects_m = [[4.0, 0.0, 6.0, 5.0]], floor = { material = \"tile\", color = \"#ffffff\" }, wall = { material = \"plain\", color = \"#eeeeee\" }, circuit = 1 }, { id = \"Lab1\", rects_m = [[0.0, 0.0, 4.0, 5.0]], floor = { material = \"tile\", color = \"#ffffff\" }, wall = { material = \"plain\", color = \"#eeeeee\" }, circuit = 1 }]";
    let mesh = |rest: &str| {
        let points = "points = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]";
        format!("[[model]]\nid = \"M\"\n[[model.part]]\nshape = \"mesh\"\n{points}\n{rest}\n")
    };
    let fan = format!("triangles = [{}]\nmirror = \"x\"", "[0, 1, 2],".repeat(4000));
    let cases: &[(&str, String, &[&str])] = &[
        (
            "models/more.toml",
            mesh("triangles = [[0, 1, 3]]"),
            &["first/models/more.toml: model `M`: part 1: `triangles[0]` names point 3 of 3: ", "from 0"],
        ),
        ("models/more.toml", mesh("triangles = []"), &["`triangles` has 0 items: write from 1 to 4096"]),
        ("models/more.toml", mesh("triangles = [[0, -1, 2]]"), &["first/models/more.toml: ", "-1"]),
        ("models/more.toml", mesh("triangles = [[0, 1, 2]]\nsmooth_deg = 500"), &["`smooth_deg` is 500: ", "180"]),
        (
            "models/more.toml",
            mesh(&format!("{fan}\nrepeat = {{ count = 3, step = [1, 0, 0] }}")),
            &["model `M`: part: 24000 triangles of meshes: at most 20000"],
        ),
        ("../world.toml", String::new(), &["first: ", "`../world.toml`", "within the pack"]),
        ("/etc/objects.toml", String::new(), &["within the pack"]),
        ("objects/..\\x.toml", String::new(), &["within the pack"]),
        ("object/things.toml", String::new(), &["first/object/things.toml: ", "put it into objects"]),
        ("world.toml", "name = 1".to_owned(), &["first/world.toml: ", "name = 1"]),
        ("world.toml", HEAD_OF_OTHER.replace("other", "../other"), &["first/world.toml: name: ", "small letter"]),
        ("world.toml", HEAD_OF_OTHER.replace("MIT", ""), &["first/world.toml: licence: "]),
        ("world.toml", head("[[room]]\nid = \"the attic\"\nname = \"attic\""), &["`the attic`", "1 to 24 letters"]),
        (
            "world.toml",
            head("[[room]]\nid = \"Workroom\"\nname = \"quantum lab\""),
            &["first/world.toml: room[0].name: ", "`Lab2`", "another name"],
        ),
        (
            "world.toml",
            head("[[room]]\nid = \"Attic\"\nname = \"attic\"\n[[room]]\nid = \"ATTIC\"\nname = \"loft\""),
            &["room[1].id: ", "`ATTIC`", "capital letters"],
        ),
        ("world.toml", head(&many_rooms), &["room[56].id: ", "one room too many", "at most 64"]),
        (
            "world.toml",
            head("[[room]]\nid = \"Attic\"\nname = \"attic\"\ncolor = \"red\""),
            &["room[0].color: ", "#rrggbb"],
        ),
        ("world.toml", HEAD_OF_OTHER.to_owned(), &["first/layouts/Workshop.toml: room `Workshop`: ", "[[room]]"]),
        ("world.toml", head("[[room]]\nid = \"Lab1\"\nname = \"<b>\""), &["room[0]: ", "small letters"]),
        ("objects/more.toml", object("mass_kg = nan\nsize_m = [1, 1, 1]"), &["more.toml: object[0].mass_kg: ", "NaN"]),
        ("objects/more.toml", object("mass_kg = 1\nsize_m = [inf, 1, 1]"), &["object[0].size_m[0]: ", "inf"]),
        (
            "objects/more.toml",
            object("mass_kg = 1\nsize_m = [90, 1, 1]"),
            &["object `Box_99`: size_m: ", "at most 10 m"],
        ),
        ("objects/more.toml", object("mass_kg = 0\nsize_m = [1, 1, 1]"), &["object `Box_99`: mass_kg: "]),
        (
            "objects/more.toml",
            object(
                "mass_kg = 1\nsize_m = [1, 1, 1]\nreceptacle = { surface = [{ center_m = [0, 0, 1], size_m = [1, 1], anchors = [900, 900], clearance_m = 1 }] }",
            ),
            &["object `Box_99`: receptacle: ", "from 1 to 32"],
        ),
        (
            "objects/more.toml",
            object("mass_kg = 1\nsize_m = [1, 1, 1]\ntint = \"red\""),
            &["first/objects/more.toml: object `Box_99`: tint: `red` is no colour: write it as #rrggbb"],
        ),
        (
            "models/more.toml",
            "[[model]]\nid = \"M\"\npart = [{ shape = \"sphere\", radii = [1, 1, 1], color = \"red\" }]".to_owned(),
            &["first/models/more.toml: model `M`: part 1: color: `red` is no colour: write it as #rrggbb, `tint` or"],
        ),
        (
            "layouts/More.toml",
            "base = \"Workshop\"\nfinish = [{ room = \"Workshop\", floor = { material = \"wood\", color = \"brown\" } }]"
                .to_owned(),
            &["first/layouts/More.toml: room `Workshop`: floor.color: `brown` is no colour: write it as #rrggbb"],
        ),
        (
            "objects/more.toml",
            object("mass_kg = 1\nsize_m = [1, 1, 1]").replace("Box_99", "Bowl_01"),
            &["more.toml: `Bowl_01`", "things.toml"],
        ),
        (
            "objects/more.toml",
            object("mass_kg = 1\nsize_m = [1, 1, 1]").replace("model = \"Wrench_01\"", ""),
            &["`Box_99` has no model"],
        ),
        ("models/more.toml", many, &["model `M`: part: ", "5000 shapes"]),
        (
            "models/more.toml",
            "[[model]]\nid = \"Wrench_01\"\npart = [{ shape = \"sphere\", radii = [1, 1, 1] }]".to_owned(),
            &["first/models/things.toml", "first/models/more.toml", "`Wrench_01`"],
        ),
        (
            "table/more.toml",
            "[[device]]\nclass = [\"Microwave_01\"]\n".to_owned(),
            &["first/table/more.toml: ", "the built-in devices.toml"],
        ),
        ("table/more.toml", "[[device]]\nclass = [\"Nothing_01\"]\n".to_owned(), &["`Nothing_01` is no class"]),
        (
            "table/more.toml",
            "[[device]]\nclass = [\"Wrench_01\"]\nwork = \"degrease\"\npress = [\"flip it\"]\n".to_owned(),
            &["first/table/more.toml: no press of the device `Wrench_01` begins its work `degrease`: ", "run it"],
        ),
        (
            "table/more.toml",
            "[[rule]]\nname = \"oil\"\naction = \"clean\"\nneeds = [[\"it exists\", \"ActionExecutonError\", \"no\"]]\n"
                .to_owned(),
            &["first/table/more.toml: `ActionExecutonError` is no status (did you mean `ActionExecutionError`?)"],
        ),
        ("table/more.toml", "[times]\nwork_s = 1\nmoment_s = 2\n".to_owned(), &["first/table/more.toml: times: "]),
        (
            "table/more.toml",
            "power_work = \"degrease\"\n".to_owned(),
            &["first/table/more.toml: power_work: ", "shut_work"],
        ),
        (
            "table/more.toml",
            "[[work]]\nname = \"grab\"\nover = \"inside\"\neffects = [\"take thing\"]\n".to_owned(),
            &["first/table/more.toml: ", "the work `grab` changes what no machine can", "make it a rule or a press"],
        ),
        (
            "layouts/OfficeLayout1.toml",
            "base = \"Workshop\"".to_owned(),
            &["the built-in OfficeLayout1.toml", "first/layouts/OfficeLayout1.toml"],
        ),
        ("layouts/Circle.toml", "base = \"Circle\"".to_owned(), &["first/layouts/Circle.toml: its bases lead back"]),
        ("layouts/More.toml", "base = \"../Workshop\"".to_owned(), &["there is no layout `../Workshop`"]),
        ("layouts/More.toml", itself.to_owned(), &["stands on itself"]),
        ("layouts/More.toml", huge.to_owned(), &["first/layouts/More.toml: room: ", "at most 100 m"]),
        ("layouts/More.toml", String::new(), &["first/layouts/More.toml: room: there is none"]),
        (
            "layouts/More.toml",
            alone.to_owned(),
            &["More.toml: room: Lab1 cannot be reached: no door", "[\"Lab1\", \"Hallway\"], at_m = [2.00, 5.00]"],
        ),
        ("layouts/More.toml", "base = \"Workshap\"".to_owned(), &["`Workshap` (did you mean `Workshop`?)"]),
        (
            "layouts/More.toml",
            "base = \"Workshop\"\nremove = [\"Degreaser_1_1\"]".to_owned(),
            &["More.toml: there is no `Degreaser_1_1` (did you mean `Degreaser_01_1`?)"],
        ),
        (
            "objects/more.toml",
            object("mass_kg = 1\nsize_m = [1, 1, 1]\nreceptacle = { surface = [], keys = [\"Wrench_1\"] }"),
            &["first/objects/more.toml: object `Box_99`: receptacle: ", "`Wrench_1`: did you mean `Wrench_01`?"],
        ),
        (
            "objects/more.toml",
            object("mass_kg = 1\nsize_m = [1, 1, 1]").replace("model = \"Wrench_01\"", "model = \"Wrench_1\""),
            &["first/objects/more.toml: object `Box_99` has no model", "did you mean `Wrench_01`?"],
        ),
        (
            "table/more.toml",
            "[[device]]\nclass = [\"Wrench_1\"]\n".to_owned(),
            &["first/table/more.toml: `Wrench_1` is no class of the catalogue (did you mean `Wrench_01`?)"],
        ),
        (
            "missions/clean_wrnch.script",
            "stop".to_owned(),
            &["first/missions/clean_wrnch.script: there is no mission", "did you mean `clean_wrench`?"],
        ),
        (
            "layouts/Workshop_mirror.toml",
            "base = \"Workshop\"".to_owned(),
            &["first/layouts/Workshop_mirror.toml: ", "another name"],
        ),
        (
            "missions/make_cereal.json",
            "{}".to_owned(),
            &["the built-in make_cereal.json", "first/missions/make_cereal.json"],
        ),
    ];
    for (path, text, expected) in cases {
        let error = world(vec![files("my-lab", &[(*path, text.as_str())])]).unwrap_err().to_string();
        for part in *expected {
            assert!(error.contains(part), "{path}: {part:?} is not in {error}");
        }
    }
}

#[test]
fn all_that_is_wrong_is_said_at_once() {
    let crate_of =
        |id: &str, rest: &str| format!("[[object]]\nid = \"{id}\"\nname = \"Crate\"\ncolor = \"red\"\n{rest}\n");
    let check = |more: &[(&str, &str)], expected: &[&str]| {
        let errors = world(vec![files("my-lab", more)]).unwrap_err();
        let text = errors.to_string();
        for part in expected {
            assert!(text.contains(part), "{part:?} is not in {text}");
        }
        assert_eq!(errors.iter().count(), expected.len(), "{text}");
    };
    let small = crate_of("Box_98", "model = \"Wrench_01\"\nmass_kg = 0\nsize_m = [0, 1, 1]");
    check(
        &[("objects/more.toml", &small), ("models/more.toml", "model = 1"), ("missions/none.script", "stop")],
        &["`Box_98`: size_m: ", "`Box_98`: mass_kg: ", "first/models/more.toml: ", "first/missions/none.script: "],
    );
    let plain = "mass_kg = 1\nsize_m = [1, 1, 1]";
    let without = [crate_of("Box_98", plain), crate_of("Box_99", plain)].concat();
    let device = "[[device]]\nclass = [\"Nothing_01\"]\nneeds = [[\"it is Sleepy\", \"ActionExecutionError\", \"no\"]]\n\
                  [[device]]\nclass = [\"Nothing_02\"]\nwork = \"nap\"\npress = [\"run it\"]\n";
    check(
        &[("objects/more.toml", &without), ("table/more.toml", device)],
        &["`Box_98` has no model", "`Box_99` has no model", "`it is Sleepy`", "`Nothing_02` is no class", "does `nap`"],
    );
    check(
        &[("layouts/One.toml", "base = \"Nowhere\""), ("layouts/Two.toml", "base = \"Two\"")],
        &["`Nowhere`", "first/layouts/Two.toml: its bases lead back"],
    );
}

#[test]
fn a_word_of_two_rooms_is_refused_with_both() {
    let room = |id: &str, words: &str| format!("[[room]]\nid = \"{id}\"\nname = \"{}\"\n{words}\n", id.to_lowercase());
    let refused = |rooms: &[String]| {
        let head = format!("{HEAD_OF_OTHER}{}", rooms.concat());
        world(vec![vec![file("world.toml", &head)]]).map(drop).map_err(|errors| errors.to_string())
    };
    let of_builtin = refused(&[room("Attic", "words = [\"store  room\"]")]).unwrap_err();
    assert!(of_builtin.contains("first/world.toml: room[0].words: ") && of_builtin.contains("`Attic` and `Warehouse`"));
    let of_pack = [room("Attic", "words = [\"loft\"]"), room("Annex", "words = [\"loft\"]")];
    let of_pack = refused(&of_pack).unwrap_err();
    assert!(of_pack.contains("room[1].words: the rooms `Annex` and `Attic` are both called `loft`"), "{of_pack}");
    assert_eq!(of_pack.lines().count(), 1, "{of_pack}");
    let of_name = refused(&[room("Attic", "words = [\"annex\"]"), room("Annex", "")]).unwrap_err();
    assert!(of_name.contains("room[0].words: the rooms `Attic` and `Annex`"), "{of_name}");
    // A room that is called as another one may be is meant by its name.
    assert_eq!(refused(&[room("Kitchen", "words = [\"cookery\"]")]), Ok(()));
}

#[test]
fn what_a_pack_declares_is_known_to_be_of_it() {
    let world = world(vec![files("my-lab", &[])]).unwrap();
    let pack = |entry, id| world.pack_of(entry, id).map(|pack| pack.id().name.as_str());
    for (entry, id) in [
        (PackEntry::Class, "Wrench_01"),
        (PackEntry::Device, "Degreaser_01"),
        (PackEntry::Room, "Workshop"),
        (PackEntry::Plan, "Workshop"),
    ] {
        assert_eq!(pack(entry, id), Some("my-lab"), "{id}");
    }
    assert_eq!((pack(PackEntry::Class, "Bowl_01"), pack(PackEntry::Room, "Hallway")), (None, None));
}

#[test]
fn two_packs_with_one_id_are_refused_with_both_files() {
    let check = |more: &[PackFile], expected: &[&str]| {
        let error = world(vec![files("my-lab", &[]), more.to_vec()]).unwrap_err().to_string();
        for part in expected {
            assert!(error.contains(part), "{part:?} is not in {error}");
        }
    };
    let head = file("world.toml", HEAD_OF_OTHER);
    check(&files("my-lab", &[]), &["first/world.toml", "second/world.toml", "`my-lab`"]);
    check(&files("other", &[]), &["first/world.toml", "second/world.toml", "`Workshop`"]);
    let plan = file("layouts/Workshop.toml", "base = \"OfficeLayout1\"");
    check(&[head.clone(), plan], &["first/layouts/Workshop.toml", "second/layouts/Workshop.toml"]);
    let mission = file("missions/clean_wrench.json", "{}");
    check(&[head, mission], &["first/missions/clean_wrench.json", "second/missions/clean_wrench.json"]);
}

#[test]
fn bytes_that_are_no_text_and_folders_without_a_head_are_refused() {
    let mut broken = files("my-lab", &[]);
    broken.push(PackFile { path: "objects/more.toml".to_owned(), bytes: vec![b'#', 0xff] });
    let error = world(vec![broken]).unwrap_err().to_string();
    assert!(error.contains("first/objects/more.toml: byte 1: no UTF-8"), "{error}");
    let error = world(vec![vec![]]).unwrap_err().to_string();
    assert!(error.contains("first: there is no `world.toml`"), "{error}");
}
