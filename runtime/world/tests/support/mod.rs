//! Plays a world by short lines of text: one command each, run to its outcome.

#![allow(clippy::unwrap_used, dead_code)]

pub mod chance;
pub mod play;
pub mod script;
pub mod sound;
pub mod stage;
pub mod trial;
pub mod walls;

use std::sync::Arc;

use cohabit_cdf::{Catalog, Layout, Mission, RoomId, mission::read_mission};
use cohabit_world::{Action, BodyId, Event, GoToTarget, Input, ObjectId, Outcome, Status, Verb, World};

/// Ticks after which a command counts as hung: two simulated minutes.
const LONGEST: u32 = 60 * 120;

pub struct Player {
    pub world: World,
    pub events: Vec<Event>,
    next: u64,
}

/// The world of a mission file.
pub fn world(file: &str, text: &str, seed: u64) -> World {
    let catalog = Arc::new(Catalog::builtin());
    let mission = match read_mission(file, text, &catalog) {
        Ok(checked) => checked.mission,
        Err(problems) => panic!("{file}: {:#?}", problems.iter().map(ToString::to_string).collect::<Vec<_>>()),
    };
    build(&catalog, mission, seed)
}

pub fn build(catalog: &Arc<Catalog>, mission: Mission, seed: u64) -> World {
    let layout =
        Arc::new(Layout::builtin(&mission.layout).unwrap_or_else(|_| Layout::builtin("OfficeLayout1").unwrap()));
    let name = mission.name.clone();
    World::new(Arc::clone(catalog), layout, Arc::new(mission), seed).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// A mission without any wishes, in the first floor plan.
pub fn plain_mission(start_room: RoomId) -> Mission {
    Mission {
        name: "plain".to_owned(),
        layout: "OfficeLayout1".to_owned(),
        seed: Some(0),
        start_room,
        ..Mission::default()
    }
}

impl Player {
    pub fn new(world: World) -> Self {
        Self { world, events: Vec::new(), next: 1 }
    }

    pub fn id(&self, instance: &str) -> ObjectId {
        self.world.find(instance).unwrap_or_else(|| panic!("there is no `{instance}`"))
    }

    /// `verb instance`, such as `goto Bowl_01_1` or `place Desk_01_1`; `room Lab1`; `wait 60`.
    pub fn action(&self, line: &str) -> Action {
        Self::action_in(&self.world, line)
    }

    /// The same in any world.
    pub fn action_in(world: &World, line: &str) -> Action {
        let (verb, what) = line.split_once(' ').unwrap();
        let id = |what: &str| world.find(what).unwrap_or_else(|| panic!("there is no `{what}`"));
        let interact = |verb| Action::Interact { verb, object: id(what) };
        match verb {
            "goto" => Action::GoTo { target: GoToTarget::Object(id(what)) },
            "room" => Action::GoTo { target: GoToTarget::Room(RoomId::new(what).unwrap()) },
            "pickup" => Action::PickUp { object: id(what) },
            "place" => Action::Place { receptacle: id(what) },
            "open" => interact(Verb::Open),
            "close" => interact(Verb::Close),
            "toggle" => interact(Verb::Toggle),
            "pour" => interact(Verb::Pour),
            "fill" => interact(Verb::Fill),
            "clean" => interact(Verb::Clean),
            "break" => interact(Verb::Break),
            "throw" => interact(Verb::Throw),
            "scan" => interact(Verb::Scan),
            "examine" => interact(Verb::Examine),
            other => panic!("unknown word `{other}`"),
        }
    }

    /// Runs one line to its outcome.
    pub fn run(&mut self, line: &str) -> Outcome {
        if let Some(ticks) = line.strip_prefix("wait ") {
            for _ in 0..ticks.parse::<u32>().unwrap() {
                let report = self.world.step(&[]);
                self.events.extend(report.events);
            }
            return Outcome { command: 0, body: BodyId(0), status: Status::ActionSuccessful, detail: String::new() };
        }
        let action = self.action(line);
        self.play(action)
    }

    pub fn play(&mut self, action: Action) -> Outcome {
        let command = self.next;
        self.next += 1;
        let mut inputs = vec![Input { command, body: BodyId(0), action }];
        for _ in 0..LONGEST {
            let report = self.world.step(&inputs);
            inputs.clear();
            self.events.extend(report.events);
            if let Some(outcome) = report.outcomes.into_iter().find(|outcome| outcome.command == command) {
                return outcome;
            }
        }
        panic!("{action:?} never came to an outcome");
    }

    /// Runs lines that must all succeed.
    pub fn must(&mut self, lines: &[&str]) {
        for line in lines {
            let outcome = self.run(line);
            let view = self.world.body(BodyId(0)).unwrap();
            assert!(
                outcome.status.is_success(),
                "`{line}`: {:?}: {} (at {})",
                outcome.status,
                outcome.detail,
                view.position_m
            );
        }
    }

    pub fn all_met(&self) -> bool {
        self.world.goals().iter().all(|goal| goal.met)
    }
}
