//! A mission of a world pack is solved as any other, and missions are made on its floor plan.

#![allow(clippy::unwrap_used)]

use cohabit_cdf::{PackFile, WorldData, WorldPack, world_pack::template};
use cohabit_generate::{Order, Spec, certify, generate};

fn world() -> WorldData {
    let files = template("my-lab").into_iter();
    let files = files.map(|(path, text)| PackFile { path: path.to_owned(), bytes: text.into_bytes() });
    WorldData::layered(vec![WorldPack::parse("my-lab", files.collect()).unwrap()]).unwrap()
}

#[test]
fn the_mission_of_the_template_is_certified_by_the_planner() {
    let world = world();
    let (name, text) = world.packs()[0].missions().next().unwrap();
    let certificate = certify(name, text, world.catalog(), 1).unwrap();
    let steps: Vec<_> = certificate.plan.iter().map(|step| (step.action, step.object.as_str())).collect();
    assert!(steps.contains(&("pick_up", "Wrench_01_1")), "{steps:?}");
    assert_eq!(steps.last(), Some(&("toggle", "Degreaser_01_1")), "{steps:?}");
}

#[test]
fn what_a_pack_calls_an_action_is_said_so() {
    let world = WorldData::layered(vec![WorldPack::builtin("homes").unwrap()]).unwrap();
    let text = r#"
[pools]
layouts = ["House_Family"]

[[type]]
name = "fold"
vars = [{ name = "a", class = ["Shirt"] }]
goals = ["a isFolded=true"]
"#;
    let spec = Spec::parse("spec.toml", text, world.catalog()).unwrap();
    let mut made = Vec::new();
    let order = Order { count: 1, seed: 1, workers: 1 };
    generate(&spec, world.catalog(), order, &mut |mission| made.push(mission.as_line())).unwrap();
    let said = made[0]["utterances"].as_array().unwrap();
    assert!(said.iter().any(|text| text == "fold the shirt"), "{said:?}");
}

#[test]
fn missions_are_made_with_the_objects_of_a_pack_on_its_floor_plan() {
    let world = world();
    let text = r#"
[pools]
layouts = ["Workshop"]

[[type]]
name = "clean"
vars = [{ name = "a", class = ["Wrench_01"], state = ["isDirty=true"] }]
goals = ["a isDirty=false"]
"#;
    let spec = Spec::parse("spec.toml", text, world.catalog()).unwrap();
    let mut made = Vec::new();
    let order = Order { count: 1, seed: 1, workers: 1 };
    generate(&spec, world.catalog(), order, &mut |mission| made.push(mission.as_line())).unwrap();
    let scene = &made[0]["cdf"]["scene"];
    assert_eq!(scene["layoutOverride"], "Workshop");
    let names = scene["required_objects"].as_array().unwrap().iter().filter_map(|object| object["name"].as_str());
    let doors: Vec<&str> = names.filter(|name| name.starts_with("Door_01_")).collect();
    assert_eq!(doors, ["Door_01_1"], "the floor plan has no other door, and none is made");
}
