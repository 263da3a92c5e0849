//! Missions of all types, made and certified.

#![allow(clippy::unwrap_used)]

use std::{collections::BTreeMap, sync::Arc};

use cohabit_cdf::Catalog;
use cohabit_generate::{BlockerKind, GenerateError, Generated, Order, Part, Spec, certify, generate, part};
use serde_json::Value;

fn lines(spec: &Spec, count: usize, seed: u64, workers: usize) -> Vec<Value> {
    let catalog = Arc::new(Catalog::builtin());
    let mut lines = Vec::new();
    generate(spec, &catalog, Order { count, seed, workers }, &mut |mission| lines.push(mission.as_line())).unwrap();
    lines
}

#[test]
fn every_type_has_missions_that_are_solved() {
    let catalog = Arc::new(Catalog::builtin());
    let spec = Spec::builtin(&catalog);
    let count = 2 * spec.types().count();
    let (mut made, order) = (BTreeMap::<String, usize>::new(), Order { count, seed: 1, workers: 2 });
    let given_up = generate(&spec, &catalog, order, &mut |mission| {
        assert!(!mission.certificate.digest.is_empty());
        *made.entry(mission.kind).or_default() += 1;
    })
    .unwrap();
    let never: Vec<_> = spec.types().filter(|kind| !made.contains_key(*kind)).collect();
    assert!(never.is_empty(), "{never:?} of {given_up:#?}");
}

#[test]
fn the_same_seed_makes_the_same_missions_with_any_number_of_workers() {
    let spec = Spec::builtin(&Catalog::builtin());
    assert_eq!(lines(&spec, 12, 7, 1), lines(&spec, 12, 7, 3));
    assert_ne!(lines(&spec, 4, 7, 2), lines(&spec, 4, 8, 2));
}

#[test]
fn a_certificate_holds_for_whoever_plays_again() {
    let spec = Spec::builtin(&Catalog::builtin());
    let catalog = Arc::new(Catalog::builtin());
    for line in lines(&spec, 3, 5, 2) {
        let seed = line["certificate"]["seed"].as_u64().unwrap();
        let again = certify("again", &line["cdf"].to_string(), &catalog, seed).unwrap();
        assert_eq!(line["certificate"]["digest"], again.digest);
    }
}

#[test]
fn what_cannot_be_made_is_said() {
    let catalog = Arc::new(Catalog::builtin());
    let text =
        "[[type]]\nname = \"sparks\"\nvars = [{ name = \"a\", class = [\"Apple\"] }]\ngoals = [\"a isSparking=true\"]";
    let spec = Spec::parse("spec.toml", text, &catalog).unwrap();
    let order = Order { count: 2, seed: 1, workers: 1 };
    let error = generate(&spec, &catalog, order, &mut |_| ()).unwrap_err();
    assert!(matches!(&error, GenerateError::Exhausted { made: 0, kind, .. } if kind == "sparks"), "{error}");
}

fn missions(spec: &Spec, count: usize) -> Vec<Generated> {
    let catalog = Arc::new(Catalog::builtin());
    let mut missions = Vec::new();
    let order = Order { count, seed: 3, workers: 2 };
    generate(spec, &catalog, order, &mut |mission| missions.push(mission)).unwrap();
    missions
}

/// Whether the plan of a mission does something with a thing.
fn uses(mission: &Generated, instance: &str) -> bool {
    mission.certificate.plan.iter().any(|step| step.object == instance)
}

#[test]
fn what_stands_in_the_way_is_dealt_with() {
    let catalog = Catalog::builtin();
    let apple = "{ name = \"it\", class = [\"Apple\"] }";
    let mug = "{ name = \"it\", class = [\"CoffeeMug_Boss\"] }";
    let device =
        "{ name = \"it\", kind = \"device\", affords = [\"TOGGLEABLE\", \"POWERABLE\"], without = [\"PICKUPABLE\"] }";
    for (kind, expected, var, goal) in [
        ("closed", BlockerKind::Closed, apple, "it isPickedUp=true"),
        ("unpowered", BlockerKind::Unpowered, device, "it isToggledOn=true"),
        ("locked", BlockerKind::Locked, mug, "it isHot=true"),
    ] {
        let pools = format!("[pools]\nblockers = 1.0\nblocker_kinds = [\"{kind}\"]\n");
        let text = format!("{pools}[[type]]\nname = \"one\"\nvars = [{var}]\ngoals = [\"{goal}\"]");
        let spec = Spec::parse("spec.toml", &text, &catalog).unwrap();
        let missions = missions(&spec, 4);
        let blocked: Vec<_> =
            missions.iter().filter_map(|mission| Some((mission, mission.blocker.as_ref()?))).collect();
        // Whether there is another way than the one that is locked is the floor plan's affair.
        let is_locked = expected == BlockerKind::Locked;
        assert!(is_locked || !blocked.is_empty(), "{kind}: none of {} missions", missions.len());
        for (mission, blocker) in blocked {
            assert_eq!(blocker.kind, expected);
            assert_eq!(uses(mission, &blocker.instance), !is_locked, "{kind}: {:?}", mission.certificate.plan);
        }
    }
}

#[test]
fn a_mission_may_have_several_robots() {
    let text = "[[type]]\nname = \"two\"\nrobots = 2\n\
        vars = [{ name = \"thing\", class = [\"Apple\"] }]\ngoals = [\"thing isPickedUp=true\"]";
    let spec = Spec::parse("spec.toml", text, &Catalog::builtin()).unwrap();
    for mission in missions(&spec, 3) {
        assert_eq!(mission.cdf["scene"]["simbot_init"].as_array().unwrap().len(), 2);
    }
}

#[test]
fn missions_are_parted_by_what_they_have() {
    let spec = Spec::builtin(&Catalog::builtin());
    let missions = missions(&spec, 96);
    let facets: Vec<_> = missions.iter().map(Generated::facets).collect();
    assert!(facets.iter().all(|facets| !facets.floor_plan.is_empty() && !facets.rooms.is_empty()), "{facets:?}");
    let parted = part(&facets, 0.1, 3);
    let plans = &parted.held_out[&Part::UnseenFloorPlan];
    assert!(!plans.is_empty());
    for (facets, part) in facets.iter().zip(&parted.parts) {
        let is_held_out = plans.contains(&facets.floor_plan);
        assert!(!is_held_out || matches!(part, Part::UnseenFloorPlan | Part::UnseenSeveral), "{facets:?}");
    }
}

#[test]
fn a_thing_that_a_type_names_itself_is_one_that_its_goals_are_about() {
    let spec = Spec::builtin(&Catalog::builtin()).of_types("builtin", &["carrotAndBack".to_owned()]).unwrap();
    for mission in missions(&spec, 3) {
        let things = mission.facets().things;
        assert!(things.contains(&"Carrot_01".to_owned()), "{things:?}");
        assert_eq!(mission.as_line()["things"], serde_json::json!(things));
    }
}
