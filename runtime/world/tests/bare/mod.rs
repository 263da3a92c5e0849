//! Bare floors for single questions: a few rooms written out in the test, with the bodies and things that it needs.

#![allow(clippy::unwrap_used, dead_code)]

use std::sync::Arc;

use cohabit_cdf::{Catalog, Layout, Mission, ObjectRequest, RoomId, StateFlag};
use cohabit_world::{Action, BodyId, BodyKind, BodyView, Event, Input, ObjectId, Outcome, Status, Vec3, World};

/// Two rooms of 6 m by 5 m, one north of the other, with a door in the middle of the wall between them; it opens north.
pub const TWO_ROOMS: &str = r##"
room = [
  { id = "Reception", rects_m = [[0.0, 0.0, 6.0, 5.0]], floor = { material = "wood", color = "#888888" }, wall = { material = "plain", color = "#eeeeee" }, circuit = 1 },
  { id = "Hallway", rects_m = [[0.0, 5.0, 6.0, 10.0]], floor = { material = "wood", color = "#888888" }, wall = { material = "plain", color = "#eeeeee" }, circuit = 1 },
]
opening = [{ kind = "door", door = "Door_01_1", between = ["Reception", "Hallway"], at_m = [3.0, 5.0], width_m = 1.0, wall_runs = "x" }]
viewpoint = [
  { room = "Reception", number = 1, at_m = [1.0, 2.5], yaw_deg = 0.0 },
  { room = "Reception", number = 2, at_m = [5.0, 2.5], yaw_deg = 180.0 },
  { room = "Reception", number = 3, at_m = [3.0, 4.4], yaw_deg = 90.0 },
  { room = "Hallway", number = 1, at_m = [3.0, 7.5], yaw_deg = -90.0 },
  { room = "Hallway", number = 2, at_m = [1.0, 9.0], yaw_deg = -90.0 },
  { room = "Hallway", number = 3, at_m = [3.1, 5.7], yaw_deg = -90.0 },
]
"##;

/// A corridor of this width, 10 m long from west to east, between two rooms.
pub fn corridor(width_m: f32) -> String {
    let (south, north) = (3.0 - width_m / 2.0, 3.0 + width_m / 2.0);
    format!(
        r##"
room = [
  {{ id = "Reception", rects_m = [[0.0, 0.0, 4.0, 6.0]], floor = {{ material = "wood", color = "#888888" }}, wall = {{ material = "plain", color = "#eeeeee" }}, circuit = 1 }},
  {{ id = "Hallway", rects_m = [[4.0, {south:?}, 14.0, {north:?}]], floor = {{ material = "wood", color = "#888888" }}, wall = {{ material = "plain", color = "#eeeeee" }}, circuit = 1 }},
  {{ id = "Warehouse", rects_m = [[14.0, 0.0, 18.0, 6.0]], floor = {{ material = "wood", color = "#888888" }}, wall = {{ material = "plain", color = "#eeeeee" }}, circuit = 1 }},
]
opening = [
  {{ kind = "passage", between = ["Reception", "Hallway"], at_m = [4.0, 3.0], width_m = {width_m:?}, wall_runs = "y" }},
  {{ kind = "passage", between = ["Hallway", "Warehouse"], at_m = [14.0, 3.0], width_m = {width_m:?}, wall_runs = "y" }},
]
viewpoint = [
  {{ room = "Reception", number = 1, at_m = [2.0, 3.0], yaw_deg = 0.0 }},
  {{ room = "Reception", number = 2, at_m = [1.0, 1.0], yaw_deg = 0.0 }},
  {{ room = "Hallway", number = 1, at_m = [9.0, 3.0], yaw_deg = 0.0 }},
  {{ room = "Hallway", number = 2, at_m = [5.0, 3.0], yaw_deg = 0.0 }},
  {{ room = "Hallway", number = 3, at_m = [13.0, 3.0], yaw_deg = 180.0 }},
  {{ room = "Warehouse", number = 1, at_m = [16.0, 3.0], yaw_deg = 180.0 }},
  {{ room = "Warehouse", number = 2, at_m = [17.0, 1.0], yaw_deg = 180.0 }},
]
"##
    )
}

/// A floor with what stands on it, `placements` in the words of a floor plan, and the objects that a mission wants:
/// `Instance +Flag -Flag`.
pub fn floor(plan: &str, placements: &str, wishes: &[&str], start: RoomId) -> World {
    let text = format!("{plan}\nplacement = [\n{placements}\n]\n");
    let layout = Layout::parse("Bare", &[("Bare.toml", &text)]).unwrap();
    let objects = wishes.iter().map(|line| request(line, start)).collect();
    let mission = Mission {
        name: "bare".to_owned(),
        layout: "Bare".to_owned(),
        seed: Some(0),
        start_room: start,
        objects,
        ..Mission::default()
    };
    World::new(Arc::new(Catalog::builtin()), Arc::new(layout), Arc::new(mission), 1).unwrap()
}

fn request(line: &str, room: RoomId) -> ObjectRequest {
    let mut words = line.split(' ');
    let instance = words.next().unwrap().to_owned();
    let flags = words.map(|word| {
        let flag = StateFlag::ALL.into_iter().find(|flag| format!("{flag:?}") == word[1..]).unwrap();
        (flag, word.starts_with('+'))
    });
    ObjectRequest { instance, room: Some(room), flags: flags.collect(), ..ObjectRequest::default() }
}

/// A world that is played with several bodies at once.
pub struct Play {
    pub world: World,
    pub events: Vec<Event>,
    next: u64,
}

impl Play {
    pub fn new(world: World) -> Self {
        Self { world, events: Vec::new(), next: 1 }
    }

    pub fn id(&self, instance: &str) -> ObjectId {
        self.world.find(instance).unwrap_or_else(|| panic!("there is no `{instance}`"))
    }

    pub fn at(&self, instance: &str) -> Vec3 {
        self.world.object(self.id(instance)).unwrap().position_m
    }

    pub fn body(&self, id: u32) -> BodyView {
        self.world.body(BodyId(id)).unwrap()
    }

    pub fn join(&mut self, kind: BodyKind, room: RoomId) -> BodyId {
        self.world.add_body(kind, room).unwrap()
    }

    /// Tells a body to do something, and goes on by a tick.
    pub fn tell(&mut self, body: u32, action: Action) -> u64 {
        self.tell_all(&[(body, action)])
    }

    /// Tells several bodies something at the same tick; returns the id of the first command.
    pub fn tell_all(&mut self, orders: &[(u32, Action)]) -> u64 {
        let first = self.next;
        let inputs: Vec<Input> = orders
            .iter()
            .zip(first..)
            .map(|((body, action), command)| Input { command, body: BodyId(*body), action: *action })
            .collect();
        self.next += orders.len() as u64;
        let report = self.world.step(&inputs);
        assert!(report.outcomes.iter().all(|outcome| outcome.status.is_success()), "{:?}", report.outcomes);
        self.events.extend(report.events);
        first
    }

    /// Runs one command to its outcome.
    pub fn run(&mut self, body: u32, action: Action) -> Outcome {
        self.run_all(&[(body, action)]).remove(0)
    }

    /// Gives several bodies one command each at the same tick, and runs until all have ended, in the order given.
    pub fn run_all(&mut self, orders: &[(u32, Action)]) -> Vec<Outcome> {
        self.run_watched(orders, |_| {})
    }

    /// The same, with a look at the world after every tick.
    pub fn run_watched(&mut self, orders: &[(u32, Action)], mut watch: impl FnMut(&World)) -> Vec<Outcome> {
        /// No command takes two minutes.
        const LONGEST_TICKS: u32 = 60 * 120;
        let first = self.next;
        let mut inputs: Vec<Input> = orders
            .iter()
            .zip(first..)
            .map(|((body, action), command)| Input { command, body: BodyId(*body), action: *action })
            .collect();
        self.next += orders.len() as u64;
        let mut ended: Vec<Outcome> = Vec::new();
        for _ in 0..LONGEST_TICKS {
            let report = self.world.step(&inputs);
            inputs.clear();
            self.events.extend(report.events);
            ended.extend(report.outcomes.into_iter().filter(|outcome| outcome.command >= first));
            watch(&self.world);
            if ended.len() == orders.len() {
                ended.sort_by_key(|outcome| outcome.command);
                return ended;
            }
        }
        panic!("{orders:?} never came to an end: {ended:?}");
    }

    /// Runs one command that must succeed.
    pub fn must(&mut self, body: u32, action: Action) -> Outcome {
        let outcome = self.run(body, action);
        let here = self.body(body).position_m;
        assert!(outcome.status.is_success(), "{action:?}: {:?}: {} (at {here})", outcome.status, outcome.detail);
        outcome
    }

    /// Runs one command that must come to `status`; returns what it says.
    pub fn refused(&mut self, body: u32, action: Action, status: Status) -> String {
        let outcome = self.run(body, action);
        assert_eq!(outcome.status, status, "{action:?}: {}", outcome.detail);
        outcome.detail
    }

    pub fn wait(&mut self, ticks: u32) {
        for _ in 0..ticks {
            let report = self.world.step(&[]);
            self.events.extend(report.events);
        }
    }
}
