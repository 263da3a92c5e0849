//! Worlds in lock-step, and who observes them.

#![allow(clippy::unwrap_used)]

use std::sync::Arc;

use cohabit_cdf::{Catalog, Layout, RoomId, mission};
use cohabit_generate::{ExpertPlay, Observer, carry_out};
use cohabit_world::{Action, BodyId, GoToTarget, Input, Report, World};

/// Counts ticks and outcomes, up to so many ticks.
#[derive(Default)]
struct Count {
    ticks: u64,
    outcomes: usize,
    last: Option<u64>,
}

impl Observer for Count {
    type Error = u64;

    fn note(&mut self, world: &World, _: &[Input], report: &Report) -> Result<(), u64> {
        self.ticks += 1;
        self.outcomes += report.outcomes.len();
        assert_eq!(world.tick(), self.ticks);
        self.last.filter(|last| *last == self.ticks).map_or(Ok(()), Err)
    }
}

/// The world of a built-in mission.
fn world(mission: &str) -> World {
    let catalog = Arc::new(Catalog::builtin());
    let (name, text) = mission::builtin().iter().find(|(name, _)| name.starts_with(mission)).unwrap();
    let mission = mission::read_mission(name, text, &catalog).unwrap().mission;
    let layout = Arc::new(Layout::builtin(&mission.layout).unwrap());
    World::new(catalog, layout, Arc::new(mission), 1).unwrap()
}

#[test]
fn the_expert_meets_all_goals_and_each_tick_is_noted() {
    let mut expert = ExpertPlay::begin(world("make_cereal"), Count::default()).unwrap();
    let mut actions = 0;
    while let Some(action) = expert.decide().unwrap() {
        let (outcome, ended_at) = expert.act(action).unwrap().unwrap();
        actions += 1;
        assert_eq!((outcome.command, ended_at + 1), (actions, expert.world.tick()));
    }
    assert!(expert.world.finished().is_some() && expert.given_up().is_empty());
    assert_eq!((expert.observer.ticks, expert.observer.outcomes as u64), (expert.world.tick(), actions));
}

#[test]
fn a_world_goes_no_further_than_what_can_be_noted() {
    let mut world = world("make_cereal");
    let action = Action::GoTo { target: GoToTarget::Room(RoomId::WAREHOUSE) };
    let command = Input { command: 7, body: BodyId(0), action };
    let error = carry_out(&mut world, &mut Count { last: Some(10), ..Count::default() }, command).unwrap_err();
    assert_eq!((error, world.tick()), (10, 10));
}

#[test]
fn a_command_gives_its_outcome() {
    let mut world = world("make_cereal");
    let command = Input { command: 7, body: BodyId(0), action: Action::LookAround };
    let Ok(outcome) = carry_out(&mut world, &mut (), command);
    assert!(outcome.is_some_and(|outcome| outcome.command == 7 && outcome.status.is_success()));
}
