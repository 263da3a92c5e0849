//! Places to begin at: furnished worlds in which somebody stands by something and holds something.
//!
//! A world takes milliseconds to build and a walk hundreds of ticks; going back to a snapshot costs neither.

use std::sync::Arc;

use cohabit_cdf::{Catalog, Layout, Property, RoomId, mission};
use cohabit_world::{Action, BodyId, BodyKind, GoToTarget, Input, ObjectId, World};
use serde_json::{Value, json};

use super::{Player, walls::Walls};

/// How many times the end of an errand is kept.
const READY_STAGES: usize = 4;

/// A world, and its states to begin from.
pub struct Scene {
    pub name: String,
    pub world: World,
    pub walls: Walls,
    pub stages: Vec<Stage>,
}

/// A state to begin from.
pub struct Stage {
    pub name: String,
    pub snapshot: Vec<u8>,
}

impl Scene {
    /// The kitchen, full of things to cook with.
    pub fn kitchen(catalog: &Arc<Catalog>, layout: &str) -> Self {
        Self::new("kitchen", kitchen(catalog, layout), KITCHEN_ERRANDS)
    }

    /// A laboratory, with parts for its machines.
    pub fn laboratory(catalog: &Arc<Catalog>, layout: &str) -> Self {
        Self::new("laboratory", laboratory(catalog, layout), LABORATORY_ERRANDS)
    }

    fn new(room: &str, world: World, errands: &[&[&str]]) -> Self {
        let walls = Walls::new(world.layout());
        let name = format!("{room} of {}", world.layout().id);
        let mut scene = Self { name, world, walls, stages: Vec::new() };
        let start = scene.keep("start");
        for errand in errands {
            scene.restore(start);
            scene.run(errand);
        }
        scene.restore(start);
        scene.walk_about();
        scene
    }

    /// Goes back to a stage.
    pub fn restore(&mut self, stage: usize) {
        self.world.restore(&self.stages[stage].snapshot).unwrap();
    }

    fn keep(&mut self, name: &str) -> usize {
        self.stages.push(Stage { name: name.to_owned(), snapshot: self.world.snapshot() });
        self.stages.len() - 1
    }

    /// Runs `verb class` lines with the first body, and keeps a stage after each that succeeds; what a plan lacks is
    /// left out. At the end the second body comes near.
    fn run(&mut self, lines: &[&str]) {
        let mut last = None;
        for line in lines {
            let (word, class) = line.split_once(' ').unwrap();
            let Some(id) = first_of(&self.world, class) else { continue };
            let instance = self.world.object(id).unwrap().instance.to_owned();
            let action = Player::action_in(&self.world, &format!("{word} {instance}"));
            if !finish(&mut self.world, 0, action) {
                continue;
            }
            self.keep(line);
            last = Some(id);
        }
        // Where everything is ready most can be done: such stages come up more often.
        for _ in 0..READY_STAGES {
            self.keep(lines[lines.len() - 1]);
        }
        let follow = last.map(|id| Action::GoTo { target: GoToTarget::Object(id) });
        if follow.is_some_and(|action| finish(&mut self.world, 1, action)) {
            self.keep("somebody else comes");
        }
    }

    /// Sends the first body to a spread of things everywhere.
    fn walk_about(&mut self) {
        /// Every so many operable objects one stage.
        const EVERY: usize = 40;
        let catalog = Arc::clone(self.world.catalog());
        let operable = [Property::Openable, Property::Toggleable, Property::Pickupable, Property::Receptacle];
        let wanted = self
            .world
            .objects()
            .filter(|view| operable.iter().any(|property| catalog.class(view.class).has(*property)) && !view.hidden);
        let things: Vec<(ObjectId, String)> =
            wanted.map(|view| (view.id, view.instance.to_owned())).step_by(EVERY).collect();
        for (id, instance) in things {
            if finish(&mut self.world, 0, Action::GoTo { target: GoToTarget::Object(id) }) {
                self.keep(&instance);
            }
        }
    }
}

/// Runs one command of one body to its end; whether it succeeded.
fn finish(world: &mut World, body: u32, action: Action) -> bool {
    /// No command of a stage takes longer: one simulated minute.
    const LONGEST_TICKS: u32 = 3600;
    let command = u64::MAX - u64::from(body);
    let mut inputs = vec![Input { command, body: BodyId(body), action }];
    for _ in 0..LONGEST_TICKS {
        let report = world.step(&inputs);
        inputs.clear();
        if let Some(outcome) = report.outcomes.iter().find(|outcome| outcome.command == command) {
            return outcome.status.is_success();
        }
    }
    panic!("{action:?} never came to an outcome");
}

/// The nearest thing of a class to the first body.
fn first_of(world: &World, class: &str) -> Option<ObjectId> {
    let here = world.body(BodyId(0))?.position_m;
    let of_class = |id| world.catalog().class(id).id == class;
    let things = world.objects().filter(|view| world.exists(view.id) && of_class(view.class));
    let distance = |position: cohabit_world::Vec3| position.distance(here);
    things.min_by(|one, two| distance(one.position_m).total_cmp(&distance(two.position_m))).map(|view| view.id)
}

/// A class with how many there are to be, and the states they start in.
type Thing = (&'static str, u32, &'static [(&'static str, &'static str)]);

const KITCHEN: &[Thing] = &[
    ("Hammer", 1, &[]),
    ("Knife_01", 1, &[]),
    ("Bowl_01", 2, &[]),
    ("CoffeeMug_Boss", 1, &[]),
    ("CoffeeMug_Yellow", 1, &[]),
    ("FoodPlate_01", 2, &[("isDirty", "true")]),
    ("MilkCarton_01", 1, &[]),
    ("Cereal_Box_01", 1, &[]),
    ("BreadLoaf", 1, &[]),
    ("BreadSlice_01", 1, &[]),
    ("Cake_02", 1, &[]),
    ("Apple", 1, &[]),
    ("CoffeeBeans_01", 1, &[]),
    ("CandyBar_01", 1, &[]),
    ("YesterdayMachine_01", 1, &[]),
    ("CoffeeUnMaker_01", 1, &[("isFilled", "Coffee")]),
    ("CableFrayed_01", 1, &[("isToggledOn", "true")]),
];

const KITCHEN_ERRANDS: &[&[&str]] = &[
    &["goto Bowl_01", "pickup Bowl_01", "goto KitchenCounterSink_01", "toggle KitchenCounterSink_01"],
    &["goto Bowl_01", "pickup Bowl_01", "goto KitchenCounterSink_01", "toggle KitchenCounterSink_01", "fill Bowl_01"],
    &["goto FoodPlate_01", "pickup FoodPlate_01", "goto KitchenCounterSink_01", "toggle KitchenCounterSink_01"],
    &["goto Hammer", "pickup Hammer", "goto Bowl_01", "goto CoffeeMug_Boss", "goto FoodPlate_01"],
    &["goto Knife_01", "pickup Knife_01", "goto BreadLoaf", "goto Cake_02"],
    &["goto MilkCarton_01", "pickup MilkCarton_01", "goto Bowl_01"],
    &["goto Cereal_Box_01", "pickup Cereal_Box_01", "goto Bowl_01"],
    &[
        "goto Apple",
        "pickup Apple",
        "goto YesterdayMachine_01",
        "open YesterdayMachine_01",
        "place YesterdayMachine_01",
    ],
    &["goto CoffeeMug_Boss", "pickup CoffeeMug_Boss", "goto Microwave_01", "open Microwave_01", "place Microwave_01"],
    &["goto BreadSlice_01", "pickup BreadSlice_01", "goto Toaster_02", "place Toaster_02"],
    &["goto CoffeeBeans_01", "pickup CoffeeBeans_01", "goto CoffeeMaker_01", "place CoffeeMaker_01"],
    &["goto CoffeeUnMaker_01"],
    &["goto FridgeLower_02", "open FridgeLower_02", "goto FridgeUpper_02", "open FridgeUpper_02"],
];

const LABORATORY: &[Thing] = &[
    ("Laser_Tip", 1, &[]),
    ("Laser_CircuitBoard", 1, &[]),
    ("Laser_ControlPanel", 1, &[]),
    ("Printer_Cartridge_Mug", 1, &[]),
    ("Printer_Cartridge_Hammer", 1, &[]),
    ("Floppy_Virus", 1, &[]),
    ("Floppy_AntiVirus", 1, &[]),
    ("Donut_01", 1, &[]),
    ("Trophy01", 1, &[]),
    ("Bowl_01", 1, &[]),
    ("CoffeeMug_Boss", 1, &[("isFilled", "Coffee")]),
];

const LABORATORY_ERRANDS: &[&[&str]] = &[
    &["goto Printer_Cartridge_Mug", "pickup Printer_Cartridge_Mug", "goto Printer_3D", "place Printer_3D"],
    &["goto Donut_01", "pickup Donut_01", "goto EAC_Machine", "place EAC_Machine"],
    &["goto Bowl_01", "pickup Bowl_01", "goto ColorChangerStation", "place ColorChangerStation"],
    &["goto Trophy01", "pickup Trophy01", "goto Embiggenator", "place Embiggenator", "goto V_Monitor_Embiggenator"],
    &["goto CoffeeMug_Boss", "pickup CoffeeMug_Boss", "goto GravityPad", "place GravityPad", "goto V_Monitor_Gravity"],
    &["goto Laser_Tip", "pickup Laser_Tip", "goto V_Monitor_Laser"],
    &["goto Floppy_Virus", "pickup Floppy_Virus", "goto Computer_Monitor_01"],
    &["goto FuseBox_01", "open FuseBox_01", "pickup FuseBox_01_Lever"],
    &["goto V_Monitor_FreezeRay"],
    &["goto V_Monitor_Portal"],
    &["goto VendingMachine_01_B4_Button"],
    &["goto Security_Button"],
    &["goto Door_01", "close Door_01"],
];

/// The world of [`Scene::kitchen`].
pub fn kitchen(catalog: &Arc<Catalog>, layout: &str) -> World {
    furnished(catalog, layout, RoomId::BREAK_ROOM, KITCHEN)
}

/// The world of [`Scene::laboratory`].
pub fn laboratory(catalog: &Arc<Catalog>, layout: &str) -> World {
    furnished(catalog, layout, RoomId::LAB1, LABORATORY)
}

/// A world of a mission that asks for these things in a room, with another robot there, and a person in the main office.
fn furnished(catalog: &Arc<Catalog>, layout: &str, room: RoomId, things: &[Thing]) -> World {
    let numbered = things.iter().flat_map(|(class, count, states)| (1..=*count).map(move |n| (class, n, states)));
    let objects: Vec<Value> = numbered
        .map(|(class, number, states)| {
            let states: Vec<Value> = states.iter().map(|(key, value)| json!({ *key: value })).collect();
            json!({"name": format!("{class}_{number}"), "state": states, "roomLocation": [room.id()]})
        })
        .collect();
    let text = mission_text(layout, room, &objects);
    let file = format!("{}.json", room.id());
    let mission = match mission::read_mission(&file, &text, catalog) {
        Ok(checked) => checked.mission,
        Err(problems) => panic!("{:#?}", problems.iter().map(ToString::to_string).collect::<Vec<_>>()),
    };
    let layout = Arc::new(Layout::builtin(layout).unwrap());
    let mut world = World::new(Arc::clone(catalog), layout, Arc::new(mission), 5).unwrap();
    world.add_body(BodyKind::Person, RoomId::MAIN_OFFICE).unwrap();
    world.add_body(BodyKind::Robot, room).unwrap();
    world
}

fn mission_text(layout: &str, room: RoomId, objects: &[Value]) -> String {
    let object_states: Vec<Value> = Vec::new();
    let text = json!({
        "task_description": "Anything at all.",
        "goal_text": "Anything at all",
        "scene": {
            "floor_plan": "5",
            "scene_id": "anything",
            "roomLocation": [room.id()],
            "required_objects": objects,
            "sticky_notes": [{"name": "StickyNote_1", "text": "Read me.", "room": room.id(), "location": 0}],
            "layoutOverride": layout,
        },
        "task_goals": object_states,
        "stateconditions": object_states,
    });
    text.to_string()
}
