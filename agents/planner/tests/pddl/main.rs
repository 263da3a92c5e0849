//! Exported missions are well-formed, and the planner's own plans reach their goals by the book.

#![allow(clippy::unwrap_used)]

mod domain;
#[path = "../support/mod.rs"]
mod support;

use std::sync::Arc;

use cohabit_cdf::{Catalog, Layout, mission::read_mission};
use cohabit_planner::{
    Limits,
    pddl::{self, Pddl},
};
use cohabit_world::{BodyId, World};
use domain::Domain;
use serde_json::Value;
use support::{mission, object};

const ME: BodyId = BodyId(0);

fn exported(name: &str, text: &str) -> Pddl {
    let catalog = Arc::new(Catalog::builtin());
    let checked = read_mission(name, text, &catalog).unwrap_or_else(|problems| panic!("{name}: {}", problems.0[0]));
    let layout = Layout::builtin(&checked.mission.layout).unwrap();
    let mut world = World::new(catalog, Arc::new(layout), Arc::new(checked.mission), 11).unwrap();
    world.step(&[]);
    let met: Vec<bool> = world.goals().iter().map(|goal| goal.met).collect();
    pddl::export(name, &world.symbols(ME), world.mission(), &met, &Limits::of_states(20_000))
}

/// Carries the planner's own plan out in the exported files.
fn check(name: &str, text: &str) {
    let Pddl { domain, problem, plan } = exported(name, text);
    let domain = Domain::read(&domain, &problem);
    let plan = plan.unwrap_or_else(|error| panic!("{name}: {error}"));
    let mut state = domain.init.clone();
    domain.settle(&mut state);
    for line in plan.lines() {
        let action = line.trim_start_matches('(').trim_end_matches(')');
        assert!(domain.act(action, &mut state), "{name}: {action} cannot be done, of {plan}");
        domain.settle(&mut state);
    }
    assert!(domain.is_done(&state), "{name}: the goal is not reached by {plan}");
    assert!(domain.actions() >= plan.lines().count(), "{name}");
    let read = pddl::read_plan(&plan).unwrap();
    assert_eq!(read.len(), plan.lines().count());
}

#[test]
fn the_missions_of_the_project_are_exported_whole() {
    for (name, text) in cohabit_cdf::mission::builtin() {
        check(name, text);
    }
}

#[test]
fn goals_of_many_kinds_are_exported_whole() {
    for can_reset in [false, true] {
        for (objects, instance, state) in [
            (&["CoffeeMug_Boss_1"][..], "CoffeeMug_Boss_1", "isHot=true"),
            (&["Bowl_01_1"][..], "Bowl_01_1", "isFilled=Water"),
            (&["BreadLoaf_1", "Knife_01_1"][..], "BreadSlice_01_*", "isPickedUp=true"),
            (&["CoffeeMug_Boss_1"][..], "CoffeeMug_Boss_1", "isEmbiggenated=true"),
            (&["CoffeeMug_Boss_1"][..], "CoffeeMug_Boss_1", "isCold=true"),
            (&["CoffeeMug_Boss_1"][..], "TableRound_02_1", "Contains=CoffeeMug_Boss_1"),
        ] {
            let objects: Vec<Value> = objects.iter().map(|name| object(name, &[])).collect();
            check(state, &mission(&objects, instance, state, can_reset));
        }
    }
}

#[test]
fn a_goal_that_cannot_be_reached_has_no_plan() {
    let text = mission(&[object("Bowl_01_1", &[])], "Bowl_01_1", "isSparking=true", false);
    let Pddl { domain, problem, plan } = exported("sparks", &text);
    let domain = Domain::read(&domain, &problem);
    assert!(plan.is_err(), "{plan:?}");
    assert!(!domain.is_done(&domain.init));
}
