//! Data sets, made, made again, and gone on with.

#![allow(clippy::unwrap_used)]

use std::{
    fs,
    path::{Path, PathBuf},
    sync::atomic::{AtomicUsize, Ordering},
};

use cohabit_bus::message::Plane;
use cohabit_cdf::mission;
use cohabit_demonstrate::{DemonstrateError, MissionText, Recipe, Summary, demonstrate};
use cohabit_tests::files;
use serde_json::Value;

/// A folder that is not there yet.
fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("cohabit-demonstrate-{name}-{}", std::process::id()));
    let _ = fs::remove_dir_all(&folder);
    folder
}

/// The built-in missions of these names; one that cannot be solved is called `sparks`.
fn missions(names: &[&str]) -> Vec<MissionText> {
    let named = |name: &&str| {
        let wanted = if *name == "sparks" { "cold_soda" } else { *name };
        let (_, text) = mission::builtin().iter().find(|(file, _)| file.starts_with(wanted)).unwrap();
        let mut cdf: Value = serde_json::from_str(text).unwrap();
        if *name == "sparks" {
            cdf["task_goals"][0]["object_states"] = serde_json::json!([{ "TableRound_02_1": "isSparking=true" }]);
        }
        MissionText { id: (*name).to_owned(), cdf: cdf.to_string() }
    };
    names.iter().map(named).collect()
}

fn make(names: &[&str], folder: &Path, planes: &[Plane], workers: usize) -> Result<Summary, DemonstrateError> {
    let recipe = Recipe::new(5, [64, 48], planes).unwrap();
    demonstrate(&missions(names), folder, &recipe, workers, &|| {})
}

fn steps(folder: &Path, episode: usize) -> Vec<Value> {
    let text = fs::read_to_string(folder.join(format!("episodes/{episode:06}/steps.jsonl"))).unwrap();
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn an_episode_has_what_the_expert_did_and_what_the_robot_saw() {
    let folder = folder("whole");
    let summary = make(&["make_cereal"], &folder, &Plane::ALL, 1).unwrap();
    assert_eq!((summary.episodes, summary.left_out.len()), (1, 0));
    let card = fs::read_to_string(folder.join("README.md")).unwrap();
    assert!(card.contains("| seed | 5 |") && card.contains(&format!("| steps | {} |", summary.steps)), "{card}");
    let mission = fs::read_to_string(folder.join("episodes/000000/mission.json")).unwrap();
    assert_eq!(mission, missions(&["make_cereal"])[0].cdf);
    let steps = steps(&folder, 0);
    assert_eq!(steps.len(), summary.steps + 1);
    assert!(steps[0]["objects"].as_array().unwrap().len() > 100, "the first line has all objects");
    let (last, before) = steps.split_last().unwrap();
    let mut goals = last["goals"].as_object().unwrap().values();
    assert!(last["action"].is_null() && goals.all(|met| met.as_bool() == Some(true)), "{last}");
    for step in before {
        let action = &step["action"];
        assert!(!action["object"].as_str().unwrap().is_empty(), "{step}");
        assert!(step["instructions"]["polite"].as_str().unwrap().starts_with("please "), "{step}");
        let status = step["outcome"]["status"].as_str().unwrap();
        assert!(["ActionSuccessful", "AlternateNavigationUsed"].contains(&status), "{step}");
        let seen = step["seen"].as_array().unwrap();
        assert_eq!(action["is_seen"], seen.iter().any(|one| one["id"] == action["id"]), "{step}");
        for name in ["color", "depth", "normals", "ids"] {
            let file = folder.join("episodes/000000").join(step["frames"][name].as_str().unwrap());
            assert!(fs::read(&file).unwrap().starts_with(b"\x89PNG"), "{}", file.display());
        }
    }
    assert!(before.iter().any(|step| step["action"]["is_seen"] == true), "who acts on something sees it");
    fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn a_mission_that_is_not_solved_is_left_out_with_the_reason() {
    let folder = folder("left-out");
    let summary = make(&["sparks", "make_cereal"], &folder, &[], 2).unwrap();
    assert_eq!(summary.episodes, 1);
    let (id, reason) = &summary.left_out[0];
    assert!(id == "sparks" && reason.contains("cannot be reached"), "{reason}");
    assert!(!folder.join("episodes/000000").exists() && !folder.join("episodes/000000.part").exists());
    let manifest: Value = serde_json::from_str(&fs::read_to_string(folder.join("manifest.json")).unwrap()).unwrap();
    assert_eq!(manifest["left_out"][0]["id"], "sparks");
    assert_eq!(manifest["episodes"][0]["folder"], "episodes/000001");
    fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn the_same_recipe_makes_the_same_bytes_with_any_number_of_workers() {
    let names = ["make_cereal", "cold_soda", "warm_coffee"];
    let (one, other) = (folder("one"), folder("other"));
    make(&names, &one, &[Plane::Color, Plane::Depth], 1).unwrap();
    make(&names, &other, &[Plane::Color, Plane::Depth], 3).unwrap();
    assert!(files(&one) == files(&other));
    // What a killed worker has left is made anew, and what is whole stays.
    fs::remove_file(other.join("manifest.json")).unwrap();
    fs::rename(other.join("episodes/000001"), other.join("episodes/000001.part")).unwrap();
    fs::write(other.join("episodes/000001.part/steps.jsonl"), "{\"step\": 0").unwrap();
    let played = AtomicUsize::new(0);
    let recipe = Recipe::new(5, [64, 48], &[Plane::Depth, Plane::Color]).unwrap();
    demonstrate(&missions(&names), &other, &recipe, 2, &|| {
        played.fetch_add(1, Ordering::Relaxed);
    })
    .unwrap();
    assert_eq!(played.into_inner(), 3);
    assert!(files(&one) == files(&other));
    // Nobody mixes two data sets.
    let error = make(&names, &one, &[Plane::Color], 1).unwrap_err();
    assert!(matches!(error, DemonstrateError::OtherRecipe { .. }), "{error}");
    fs::remove_dir_all(&one).unwrap();
    fs::remove_dir_all(&other).unwrap();
}

#[test]
fn what_others_added_to_the_card_of_a_whole_data_set_stays() {
    let folder = folder("card");
    make(&["make_cereal"], &folder, &[], 1).unwrap();
    let card = folder.join("README.md");
    let with_more = format!("{}\n# What people wrote\n", fs::read_to_string(&card).unwrap());
    fs::write(&card, &with_more).unwrap();
    make(&["make_cereal"], &folder, &[], 1).unwrap();
    assert_eq!(fs::read_to_string(&card).unwrap(), with_more);
    // An episode that was made anew is the same one; a card that is gone is written again.
    fs::remove_dir_all(folder.join("episodes/000000")).unwrap();
    make(&["make_cereal"], &folder, &[], 1).unwrap();
    assert_eq!(fs::read_to_string(&card).unwrap(), with_more);
    fs::remove_file(&card).unwrap();
    make(&["make_cereal"], &folder, &[], 1).unwrap();
    assert!(fs::read_to_string(&card).unwrap().starts_with("# Demonstrations"));
    fs::remove_dir_all(&folder).unwrap();
}
