#![allow(clippy::unwrap_used)]

use std::sync::Arc;

use cohabit_cdf::{Action, Catalog, GoToTarget, Verb};
use cohabit_world::{Input, Report};

use super::*;
use crate::build::SessionPlan;

/// A bowl and milk on a table, an apple in the microwave, a pear in the fridge.
const MISSION: &str = r#"{ "scene": { "scene_id": "pours", "floor_plan": "0", "layoutOverride": "OfficeLayout1",
  "roomLocation": ["BreakRoom"], "required_objects": [
    { "name": "TableRound_02_1", "roomLocation": ["BreakRoom"] },
    { "name": "Bowl_01_1", "roomLocation": ["BreakRoom"], "location": [{ "TableRound_02_1": "on" }] },
    { "name": "MilkCarton_01_1", "roomLocation": ["BreakRoom"], "location": [{ "TableRound_02_1": "on" }],
      "state": [{ "isFilled": "Milk" }] },
    { "name": "Apple_1", "roomLocation": ["BreakRoom"], "location": [{ "Microwave_01_1": "in" }] },
    { "name": "Pear_01_1", "roomLocation": ["BreakRoom"], "location": [{ "FridgeLower_02_1": "in" }] }] },
  "task_goals": [{ "goal_id": 0, "description": "", "object_states": [{ "Bowl_01_1": "isFilled=Milk" }],
    "object_states_relation": "and" }] }"#;

fn world() -> World {
    SessionPlan::new("pours.json", MISSION, Arc::new(Catalog::builtin()), 0).unwrap().build().unwrap()
}

/// Steps until a command ends; the report of that tick.
fn play(world: &mut World, motion: &mut Motion, action: Action) -> Report {
    let mut inputs = vec![Input { command: world.tick() + 1, body: BodyId(0), action }];
    for _ in 0..7200 {
        let report = world.step(&inputs);
        inputs.clear();
        motion.note(world, &report);
        if let Some(outcome) = report.outcomes.first() {
            assert!(outcome.status.is_success(), "{outcome:?}");
            return report;
        }
    }
    panic!("{action:?} never ended");
}

/// All instances, with what is poured.
fn shown(world: &World, motion: &Motion) -> Vec<Instance> {
    let mut instances: Vec<Instance> = furnishings(world).collect();
    motion.pours().iter().for_each(|pour| show_pour(world, pour, &mut instances));
    instances
}

#[test]
fn milk_is_seen_to_flow_into_the_bowl() {
    let (mut world, mut motion) = (world(), Motion::default());
    let [bowl, milk] = ["Bowl_01_1", "MilkCarton_01_1"].map(|name| world.find(name).unwrap());
    for action in [
        Action::GoTo { target: GoToTarget::Object(milk) },
        Action::PickUp { object: milk },
        Action::GoTo { target: GoToTarget::Object(bowl) },
    ] {
        play(&mut world, &mut motion, action);
    }
    assert!(motion.pours().is_empty() && motion.gait(BodyId(0)).way_m > 0.0);
    play(&mut world, &mut motion, Action::Interact { verb: Verb::Pour, object: bowl });
    let (mut flowing, mut tilted) = (0, 0);
    for _ in 0..70 {
        let instances = shown(&world, &motion);
        let streams = instances.iter().filter(|one| matches!(one.look, Look::Stream { .. }));
        let streams: Vec<&Instance> = streams.collect();
        if let [stream] = streams[..] {
            flowing += 1;
            assert_eq!(stream.fluid, Fluid::Milk);
            let aside = Vec3::from_array(stream.position_m) - world.object(bowl).unwrap().position_m;
            assert!(aside.truncate().length() < 0.01 && aside.z > 0.1, "{aside}");
        }
        let carton = instances.iter().find(|one| one.id == object_instance_id(milk)).unwrap();
        tilted += usize::from((Quat::from_array(carton.rotation) * Vec3::Z).z < 0.5);
        assert!(instances.iter().all(|one| one.id != 0));
        let report = world.step(&[]);
        motion.note(&world, &report);
    }
    assert!((20..60).contains(&flowing) && tilted >= flowing / 2, "{flowing} {tilted}");
    assert!(motion.pours().is_empty() && shown(&world, &motion).len() == furnishings(&world).count());
}

#[test]
fn what_lies_behind_a_clear_door_is_seen_and_behind_another_is_not() {
    let world = world();
    let instance = |name: &str| {
        let id = object_instance_id(world.find(name).unwrap());
        furnishings(&world).find(|one| one.id == id).unwrap()
    };
    assert!(world.object(world.find("Apple_1").unwrap()).unwrap().hidden);
    assert!(instance("Apple_1").visible);
    assert!(!instance("Pear_01_1").visible);
}
