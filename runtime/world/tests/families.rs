//! The families of real missions, each solved by following the utterances that its users gave.

#![allow(clippy::unwrap_used)]

mod support;

use std::{collections::BTreeMap, path::PathBuf};

use cohabit_cdf::{Catalog, mission::read_mission};
use cohabit_world::{Action, GoToTarget, ObjectId, World};
use serde_json::Value;
use support::{Player, build};

/// The missions of the reference data, one JSON object a line.
fn missions() -> Vec<Value> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/arena/missions-dev.jsonl");
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// What a word of an utterance stands for, where the class has another name.
const WORDS: &[(&str, &str)] = &[
    ("fridge", "FridgeLower_02"),
    ("freezer", "FridgeUpper_02"),
    ("cabinet", "KitchenCabinet_02"),
    ("sink", "KitchenCounterSink_01"),
    ("coffee unmaker", "CoffeeUnMaker_01"),
    ("time machine", "YesterdayMachine_01"),
    ("carrot maker", "EAC_Machine"),
    ("color changer", "ColorChangerStation"),
    ("red button", "ColorChanger_Button_Red"),
    ("green button", "ColorChanger_Button_Green"),
    ("blue button", "ColorChanger_Button_Blue"),
    ("printer cartridge", "Printer_Cartridge"),
    ("printer", "Printer_3D"),
    ("microwave", "Microwave_01"),
    ("gravity pad", "GravityPad"),
    ("blue desk", "AP_Prop_Desk_Blue"),
    ("green desk", "AP_Prop_Desk_Green"),
    ("red desk", "AP_Prop_Desk_Red"),
    ("robot arm", "RoboticArm_01"),
];

const ROOMS: &[(&str, &str)] = &[
    ("breakroom", "BreakRoom"),
    ("robotics lab", "Lab1"),
    ("quantum lab", "Lab2"),
    ("main office", "MainOffice"),
    ("warehouse", "Warehouse"),
    ("reception", "Reception"),
    ("small office", "SmallOffice"),
];

/// The object a noun means: one the mission asked for, else the first of that kind; the colour said decides.
fn meant(world: &World, requested: &[String], noun: &str) -> Option<ObjectId> {
    let colors = ["red", "green", "blue", "white", "yellow"];
    let said = colors.iter().find(|color| noun.starts_with(**color));
    let class = WORDS.iter().find(|(word, _)| noun.contains(word)).map(|(_, class)| *class);
    let bare = said.map_or(noun, |said| noun[said.len()..].trim());
    let names = |id: ObjectId| {
        let view = world.object(id).unwrap();
        let found = world.catalog().class(view.class);
        let own = [found.name.to_lowercase(), view.instance.to_lowercase()];
        (found.id.clone(), found.words.iter().cloned().chain(own).collect::<Vec<_>>())
    };
    let exactly = |id: ObjectId| match class {
        Some(class) => names(id).0.starts_with(class),
        None => names(id).1.iter().any(|name| name == bare),
    };
    let roughly = |id: ObjectId| names(id).1.iter().any(|name| name.split(' ').any(|word| word == bare));
    let painted = |id: ObjectId| world.object(id).unwrap().color.name().to_lowercase();
    let spawned = world.objects().filter(|view| view.instance.contains("_Spawned_")).map(|view| view.id);
    let asked: Vec<ObjectId> = requested.iter().filter_map(|instance| world.find(instance)).chain(spawned).collect();
    let everything: Vec<ObjectId> = world.objects().map(|view| view.id).filter(|id| world.exists(*id)).collect();
    let of = |pool: &[ObjectId], fits: &dyn Fn(ObjectId) -> bool| -> Vec<ObjectId> {
        pool.iter().copied().filter(|id| fits(*id)).collect()
    };
    let all = [of(&asked, &exactly), of(&asked, &roughly), of(&everything, &exactly)].concat();
    let wanted = said.filter(|said| ["red", "green", "blue"].contains(*said)).copied().unwrap_or("original");
    all.iter().find(|id| painted(**id) == wanted).or(all.first()).copied()
}

/// Does what one utterance says; false if it makes no sense.
fn follow(player: &mut Player, requested: &[String], line: &str, trouble: &mut Vec<String>) {
    let lower = line.to_lowercase();
    let (verb, rest) = [
        "pick up the ",
        "go to the ",
        "find the ",
        "put the ",
        "place the ",
        "open the ",
        "close the ",
        "toggle the ",
        "turn on the ",
        "turn off the ",
        "press the ",
        "fill the ",
        "clean the ",
        "pour the ",
        "break the ",
    ]
    .iter()
    .find_map(|verb| lower.strip_prefix(verb).map(|rest| (verb.split(' ').next().unwrap(), rest.to_owned())))
    .unwrap_or_else(|| panic!("what does `{line}` mean?"));
    let nouns: Vec<&str> = [" in the ", " on the ", " into the ", " from the ", " with the "]
        .iter()
        .find_map(|between| rest.split_once(between))
        .map_or(vec![rest.as_str()], |(one, two)| vec![one, two]);
    let target = match verb {
        "put" | "place" | "fill" | "clean" | "pour" => *nouns.last().unwrap(),
        _ => nouns[0],
    };
    if let Some((_, room)) = ROOMS.iter().find(|(word, _)| verb == "go" && target == *word) {
        player.must(&[&format!("room {room}")]);
        return;
    }
    // What comes out of a machine is what is in it now.
    let from = (verb == "pick").then(|| nouns.get(1)).flatten();
    let machine = from.and_then(|machine| meant(&player.world, requested, machine));
    let taken = player
        .world
        .objects()
        .find(|view| view.parent.is_some() && view.parent == machine && !view.instance.contains("Cartridge"))
        .map(|view| view.id);
    let Some(id) = taken.or_else(|| meant(&player.world, requested, target)) else {
        trouble.push(format!("{line}: no {target}"));
        return;
    };
    let instance = player.world.object(id).unwrap().instance.to_owned();
    let walk = player.play(Action::GoTo { target: GoToTarget::Object(id) });
    if !walk.status.is_success() {
        trouble.push(format!("{line}: {instance}: {}", walk.detail));
    }
    let word = match verb {
        "pick" => "pickup",
        "put" | "place" => "place",
        "turn" | "press" | "toggle" => "toggle",
        "go" | "find" => return,
        other => other,
    };
    let outcome = player.run(&format!("{word} {instance}"));
    if !outcome.status.is_success() {
        trouble.push(format!("{line}: {instance}: {}", outcome.detail));
    }
    if word == "toggle" {
        player.run("wait 150");
    }
}

#[test]
#[cfg_attr(not(reference_data), ignore = "needs the reference data in ../shared/arena")]
fn every_real_mission_is_solved_by_what_its_users_said() {
    let missions = missions();
    let catalog = std::sync::Arc::new(Catalog::builtin());
    let mut unsolved: BTreeMap<String, String> = BTreeMap::new();
    for mission in &missions {
        let id = mission["id"].as_str().unwrap().to_owned();
        let checked = read_mission(&id, &mission["cdf"].to_string(), &catalog);
        let checked = checked.unwrap_or_else(|problems| panic!("{id}: {}", problems.0[0]));
        let requested: Vec<String> = checked
            .mission
            .objects
            .iter()
            .filter(|object| !object.blacklisted)
            .map(|object| object.instance.clone())
            .collect();
        let mut player = Player::new(build(&catalog, checked.mission, 11));
        let mut trouble = Vec::new();
        let said = |key: &str| mission[key].as_array().unwrap().iter().map(|line| line.as_str().unwrap().to_owned());
        for line in said("preparation_utterances").chain(said("utterances")).collect::<Vec<_>>() {
            follow(&mut player, &requested, &line, &mut trouble);
        }
        if !player.all_met() {
            let missing = player.world.goals().iter().filter(|goal| !goal.met).map(|goal| goal.id).collect::<Vec<_>>();
            unsolved.insert(id, format!("{} goals {missing:?} {trouble:?}", player.world.layout().id));
        }
    }
    for (id, why) in &unsolved {
        eprintln!("{id}: {why}");
    }
    assert!(!missions.is_empty());
    assert!(unsolved.is_empty(), "{} of {} unsolved", unsolved.len(), missions.len());
}
