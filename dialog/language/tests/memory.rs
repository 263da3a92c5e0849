//! What the robot remembers of what it saw, and how it looks for the rest, in the small office.

use std::sync::Arc;

use crate::support::{catalog, scene, step_text};
use cohabit_cdf::{
    Action, Catalog, GoToTarget, Layout, ObjectId, RoomId, StateFlag, Status, Verb, WorldData, WorldPack,
    layout::{Finish, Opening, OpeningKind, Room, Viewpoint},
    model::{Axis, Material},
};
use cohabit_language::{
    Clarification, Context, FloorPlan, Gaze, Known, KnownObject, KnownRobot, Language, Lessons, Memory, Step,
    Understanding,
};

const ROOMS: [(RoomId, [f32; 4]); 5] = [
    (RoomId::BREAK_ROOM, [-5.0, -4.0, 7.0, 4.0]),
    (RoomId::MAIN_OFFICE, [7.0, -4.0, 16.0, 4.0]),
    (RoomId::LAB1, [3.0, 8.0, 14.0, 15.0]),
    (RoomId::LAB2, [18.0, 8.0, 26.0, 15.0]),
    (RoomId::HALLWAY, [7.0, 4.0, 26.0, 8.0]),
];
const GATES: [([RoomId; 2], [f32; 2]); 4] = [
    ([RoomId::BREAK_ROOM, RoomId::MAIN_OFFICE], [7.0, 0.0]),
    ([RoomId::MAIN_OFFICE, RoomId::HALLWAY], [10.0, 4.0]),
    ([RoomId::HALLWAY, RoomId::LAB1], [8.0, 8.0]),
    ([RoomId::HALLWAY, RoomId::LAB2], [20.0, 8.0]),
];

fn plan() -> Arc<FloorPlan> {
    let finish = || Finish { material: Material::Plain, color: "#ffffff".to_owned() };
    let room = |(id, rect): (RoomId, [f32; 4])| Room {
        id,
        rects_m: vec![rect],
        floor: finish(),
        wall: finish(),
        wainscot: None,
        circuit: 0,
    };
    let gate = |(between, at_m)| Opening {
        kind: OpeningKind::Passage,
        door: (between == [RoomId::BREAK_ROOM, RoomId::MAIN_OFFICE]).then(|| "Door_01_1".to_owned()),
        between,
        at_m,
        width_m: 1.0,
        wall_runs: Axis::Y,
    };
    let viewpoints = ROOMS.iter().flat_map(|(room, [west, south, east, north])| {
        let y = (south + north) / 2.0;
        [(1, west + 1.0), (2, east - 1.0)].map(|(number, x)| Viewpoint {
            room: *room,
            number,
            at_m: [x, y + 1.0],
            yaw_deg: 0.0,
        })
    });
    Arc::new(FloorPlan::new(&Layout {
        id: "Small".to_owned(),
        wall_height_m: 2.8,
        rooms: ROOMS.map(room).to_vec(),
        openings: GATES.map(gate).to_vec(),
        placements: Vec::new(),
        viewpoints: viewpoints.collect(),
        note_places: Vec::new(),
    }))
}

/// A robot that knows what it saw, in a world that does at once what it is told.
struct Robot {
    catalog: Arc<Catalog>,
    language: Language,
    world: Known,
    memory: Memory,
    context: Context,
    /// The floor plan, where that is not the small office.
    home: Option<Layout>,
    pitch_rad: f32,
}

/// How far down it looks where it has not lowered its head.
const OFFICE_PITCH_RAD: f32 = -0.2;

impl Robot {
    fn new(marks: &[&str]) -> Self {
        let catalog = catalog();
        let mut world = scene(&catalog, marks);
        hide(&mut world, &catalog);
        let language = Language::new(Arc::clone(&catalog));
        let (memory, context) = (Memory::new(plan()), Context::default());
        let mut robot = Self { language, world, memory, context, catalog, home: None, pitch_rad: OFFICE_PITCH_RAD };
        robot.look(false);
        robot
    }

    /// At a viewpoint of a family's house, with this thing in or on the nearest of class `parent` in that room.
    fn at_home((room, number): (&str, u8), thing: &str, parent: &str) -> Self {
        let catalog = Arc::clone(WorldData::layered(vec![WorldPack::builtin("homes").unwrap()]).unwrap().catalog());
        let layout = Layout::find("House_Family", &catalog).unwrap();
        let room = RoomId::new(room).unwrap();
        let robot = KnownRobot { position_m: [0.0; 3], yaw_rad: 0.0, room, held: None };
        let mut world = Known::new(robot, KnownObject::furniture(&catalog, &layout));
        let kind = catalog.find(parent).unwrap();
        let place = world.objects.iter().find(|object| object.room == room && object.class == kind).unwrap();
        let (place, [x, y, z]) = (place.id, place.position_m);
        let id = ObjectId(world.objects.iter().map(|object| object.id.0 + 1).max().unwrap());
        let class = catalog.class_of_instance(thing).unwrap();
        let object = KnownObject::new(id, thing.to_owned(), class, room, [x, y, z + 0.03]);
        world.objects.push(KnownObject { parent: Some(place), in_mission: true, ..object });
        hide(&mut world, &catalog);
        let (language, memory) = (Language::new(Arc::clone(&catalog)), Memory::new(Arc::new(FloorPlan::new(&layout))));
        let (context, home) = (Context::default(), Some(layout));
        let mut robot = Self { language, world, memory, context, catalog, home, pitch_rad: 0.0 };
        robot.stand(room, robot.viewpoint(room, number), 0.0);
        robot.look(false);
        robot
    }

    fn viewpoint(&self, room: RoomId, number: u8) -> [f32; 2] {
        if let Some(home) = &self.home {
            let is_it = |viewpoint: &&Viewpoint| viewpoint.room == room && viewpoint.number == number;
            return home.viewpoints.iter().find(is_it).unwrap().at_m;
        }
        let [west, south, east, north] = ROOMS.iter().find(|(id, _)| *id == room).unwrap().1;
        [if number == 1 { west + 1.0 } else { east - 1.0 }, (south + north) / 2.0 + 1.0]
    }

    fn look(&mut self, is_around: bool) {
        let robot = &self.world.robot;
        let [x, y, _] = robot.position_m;
        let pitch_rad = self.pitch_rad;
        let gaze = Gaze { eye_m: [x, y, 1.3], room: robot.room, yaw_rad: robot.yaw_rad, pitch_rad, is_around };
        self.memory.take_in(&self.catalog, &self.world, gaze);
    }

    fn id(&self, instance: &str) -> ObjectId {
        self.world.objects.iter().find(|object| object.instance == instance).unwrap().id
    }

    fn knows(&self, instance: &str) -> bool {
        self.memory.known().unwrap().objects.iter().any(|object| object.instance == instance)
    }

    /// Says something, and does what comes of it, `legs` plans at most. Gives what was done and said.
    fn say(&mut self, utterance: &str, legs: usize) -> (Vec<String>, Vec<String>) {
        let (mut done, mut said) = (Vec::new(), Vec::new());
        let known = self.memory.known().unwrap();
        let mut next = Some(self.language.understand(utterance, &known, &mut self.context));
        for _ in 0..legs {
            let steps = match next.take() {
                Some(Understanding::Plan { steps, reply }) => {
                    said.push(reply);
                    steps
                }
                Some(other) => {
                    said.push(crate::support::text(&other, &known));
                    break;
                }
                None => break,
            };
            for step in &steps {
                done.push(step_text(step, &self.world));
                self.carry_out(step);
            }
            // What was written down and read again is the same conversation.
            self.context = serde_json::from_str(&serde_json::to_string(&self.context).unwrap()).unwrap();
            next = self.language.carry_on(&self.memory.known().unwrap(), &mut self.context);
        }
        said.retain(|text| !text.is_empty());
        (done, said)
    }

    fn carry_out(&mut self, step: &Step) {
        match step.action {
            Action::GoTo { target: GoToTarget::Viewpoint(room, number) } => {
                self.stand(room, self.viewpoint(room, number), 0.0);
            }
            Action::Look { pitch_rad } => self.pitch_rad += pitch_rad,
            Action::GoTo { target: GoToTarget::Room(room) } => {
                let [west, south, east, north] = ROOMS.iter().find(|(id, _)| *id == room).unwrap().1;
                self.stand(room, [(west + east) / 2.0, (south + north) / 2.0], 0.0);
            }
            Action::GoTo { target: GoToTarget::Object(id) } => self.go_to(id),
            Action::PickUp { object } => {
                self.go_to(object);
                self.world.robot.held = Some(object);
                self.object(object).parent = None;
            }
            Action::Place { receptacle } | Action::PlaceBeside { receptacle, .. } => {
                self.go_to(receptacle);
                let held = self.world.robot.held.take().unwrap();
                let place = self.world.object(receptacle).unwrap().clone();
                let object = self.object(held);
                (object.parent, object.room, object.position_m) = (Some(receptacle), place.room, place.position_m);
            }
            Action::Interact { verb, object } => {
                self.go_to(object);
                match verb {
                    Verb::Open => self.object(object).flags.set(StateFlag::Opened, true),
                    Verb::Close => self.object(object).flags.set(StateFlag::Opened, false),
                    _ => {}
                }
            }
            _ => {}
        }
        hide(&mut self.world, &self.catalog);
        self.context.note_outcome(step, Status::ActionSuccessful);
        self.look(matches!(step.action, Action::LookAround));
        self.memory.take_in_deed(&step.action, &self.world);
    }

    fn object(&mut self, id: ObjectId) -> &mut KnownObject {
        self.world.objects.iter_mut().find(|object| object.id == id).unwrap()
    }

    fn go_to(&mut self, id: ObjectId) {
        let target = self.world.object(id).unwrap().clone();
        let [x, y, _] = target.position_m;
        self.stand(target.room, [x - 1.0, y], 0.0);
    }

    fn stand(&mut self, room: RoomId, [x, y]: [f32; 2], yaw_rad: f32) {
        (self.world.robot.room, self.world.robot.position_m, self.world.robot.yaw_rad) = (room, [x, y, 0.0], yaw_rad);
        self.pitch_rad = if self.home.is_some() { 0.0 } else { OFFICE_PITCH_RAD };
    }
}

/// Marks what is behind closed doors.
fn hide(world: &mut Known, catalog: &Catalog) {
    let shut: Vec<ObjectId> = world
        .objects
        .iter()
        .filter(|object| {
            let class = catalog.class(object.class);
            class.receptacle.as_ref().is_some_and(|kind| kind.enclosed) && !object.flags.has(StateFlag::Opened)
        })
        .map(|object| object.id)
        .collect();
    for object in &mut world.objects {
        let is_carried = catalog.class(object.class).has(cohabit_cdf::Property::Pickupable);
        object.is_hidden = is_carried && object.parent.is_some_and(|parent| shut.contains(&parent));
    }
}

#[test]
fn it_knows_what_it_saw_and_nothing_else() {
    let mut robot = Robot::new(&[]);
    let ahead = ["TableRound_02_1", "CoffeeMug_Boss_1"];
    let aside = ["CoffeeMaker_01_1", "KitchenCabinet_02_1", "YesterdayMachine_01_1"];
    let elsewhere = ["Hammer_1", "Desk_01_1", "MilkCarton_01_1", "BreadSlice_01_1"];
    for instance in ahead {
        assert!(robot.knows(instance), "{instance}");
    }
    for instance in aside.iter().chain(&elsewhere) {
        assert!(!robot.knows(instance), "{instance}");
    }
    robot.look(true);
    for instance in aside {
        assert!(robot.knows(instance), "{instance}");
    }
    for instance in elsewhere {
        assert!(!robot.knows(instance), "{instance}");
    }
    // What stands on what is seen was seen on it.
    let known = robot.memory.known().unwrap();
    let mug = known.object(robot.id("CoffeeMug_Boss_1")).unwrap();
    assert_eq!(mug.parent, Some(robot.id("TableRound_02_1")));
}

#[test]
fn what_it_cannot_see_changes_nothing_of_what_it_knows() {
    let mut robot = Robot::new(&[]);
    robot.look(true);
    let before = robot.memory.known().unwrap();
    for instance in ["Hammer_1", "MilkCarton_01_1", "BreadSlice_01_1", "Desk_01_1"] {
        let id = robot.id(instance);
        let object = robot.object(id);
        object.flags.set(StateFlag::Broken, true);
        object.position_m[2] += 0.2;
    }
    robot.world.objects.retain(|object| object.instance != "Trophy01_1");
    robot.look(true);
    assert_eq!(robot.memory.known().unwrap(), before);
}

#[test]
fn what_is_not_there_any_more_is_forgotten_once_that_is_seen() {
    let mut robot = Robot::new(&["FridgeLower_02_1 open"]);
    robot.look(true);
    let (mug, milk, fridge) = (robot.id("CoffeeMug_Boss_1"), robot.id("MilkCarton_01_1"), robot.id("FridgeLower_02_1"));
    assert!(robot.knows("CoffeeMug_Boss_1") && robot.knows("MilkCarton_01_1"));
    // Somebody takes both away, and shuts the fridge.
    robot.world.objects.retain(|object| object.id != mug && object.id != milk);
    robot.object(fridge).flags.set(StateFlag::Opened, false);
    let world = robot.world.clone();
    let place = |id| robot.memory.mistaken_place(&Action::PickUp { object: id }, &world);
    assert_eq!(place(mug), Some((mug, [3.0, 0.4])));
    assert_eq!(place(robot.id("Banana_01_1")), None);
    robot.stand(RoomId::BREAK_ROOM, [0.0, 0.0], 2.0);
    robot.look(false);
    assert!(robot.knows("CoffeeMug_Boss_1"), "it looked another way");
    robot.look(true);
    assert!(!robot.knows("CoffeeMug_Boss_1"));
    assert!(robot.knows("MilkCarton_01_1"), "the fridge is shut: it may be there yet");
    robot.object(fridge).flags.set(StateFlag::Opened, true);
    robot.look(true);
    assert!(!robot.knows("MilkCarton_01_1"));
}

#[test]
fn it_knows_what_is_in_its_hand_and_what_it_did() {
    let mut robot = Robot::new(&[]);
    robot.say("pick up the red mug", 3);
    robot.stand(RoomId::LAB2, [20.0, 9.0], 0.0);
    robot.look(false);
    let known = robot.memory.known().unwrap();
    assert_eq!(known.robot.held, Some(robot.id("CoffeeMug_Boss_1")));
    assert!(robot.knows("CoffeeMug_Boss_1"));
    robot.stand(RoomId::BREAK_ROOM, [0.0, 0.0], 0.0);
    robot.look(true);
    robot.say("open the fridge", 1);
    let known = robot.memory.known().unwrap();
    assert!(known.object(robot.id("FridgeLower_02_1")).unwrap().flags.has(StateFlag::Opened));
}

#[test]
fn it_looks_for_what_it_does_not_know_and_goes_on() {
    let mut robot = Robot::new(&[]);
    let (done, said) = robot.say("pick up the hammer", 60);
    assert_eq!(done.last().unwrap(), "take Hammer_1", "{done:?}");
    assert_eq!(said[0], "I have not seen a hammer yet, so I look for it.");
    let last = said.last().unwrap();
    assert!(last.starts_with("I found the hammer on the blue desk."), "{last}");
    assert_eq!(done[0], "look around", "{done:?}");
    assert!(done.len() < 25, "{done:?}");
}

#[test]
fn what_it_asks_the_place_of_it_looks_for_when_told_to() {
    for answer in ["yes", "find it", "you look", "I forgot where it is", "look around"] {
        let mut robot = Robot::new(&[]);
        // A hammer holds no water: perhaps something else is meant.
        let (_, said) = robot.say("fill the hammer", 1);
        assert!(said[0].starts_with("? I have not seen a hammer. Where is it"), "{said:?}");
        let (done, said) = robot.say(answer, 80);
        assert!(done.contains(&"take Hammer_1".to_owned()), "{answer}: {done:?} {said:?}");
    }
    let mut robot = Robot::new(&[]);
    robot.say("fill the hammer", 1);
    let (done, _) = robot.say("it is in the main office", 80);
    assert!(done[0].starts_with("go MainOffice"), "{done:?}");
    assert!(done.contains(&"take Hammer_1".to_owned()), "{done:?}");
}

#[test]
fn the_same_search_in_other_words_is_no_other_choice() {
    for said in [
        "Hiya pal! There's a hammer on the round table, could you pick that up for me please? Mind yer fingers.",
        "Just the hammer on the round table, pal",
        "There should be a hammer on the round table. Could you pick it up for me?",
    ] {
        let (_, replies) = Robot::new(&[]).say(said, 1);
        let is_choice = replies.iter().any(|reply| reply.starts_with("? ") && reply.matches('"').count() > 2);
        assert!(!is_choice, "{said}: {replies:?}");
    }
}

#[test]
fn what_is_kept_nowhere_is_put_away_on_another_surface() {
    let mut robot = Robot::new(&[]);
    robot.say("pick up the trophy", 80);
    let (done, said) = robot.say("put it away", 80);
    assert!(done.iter().any(|step| step.starts_with("put ")), "{done:?} {said:?}");
}

#[test]
fn a_thing_that_is_in_something_unseen_is_looked_for_there() {
    let mut robot = Robot::new(&[]);
    let (_, said) = robot.say("pick up the purple thing on the green desk", 1);
    assert!(said[0].starts_with("I have not seen a green desk"), "{said:?}");
}

/// What a rewriter makes of one utterance: the same with what was not seen yet, in three ways none of which is likely enough.
fn three_ways(said: &str, _: &[(bool, String)], _: &str) -> Vec<(String, f32)> {
    let ways = [
        ("put the hammer on the green desk", 0.4),
        ("pick up the hammer; put the hammer on the green desk", 0.3),
        ("pick up the hammer; put it on the green desk", 0.2),
    ];
    let is_it = said == "whack the whacker down yonder where the boss sits";
    ways.iter().filter(|_| is_it).map(|(text, share)| ((*text).to_owned(), *share)).collect()
}

#[test]
fn what_is_put_somewhere_is_the_same_whether_it_is_picked_up_first() {
    let mut robot = Robot::new(&[]);
    robot.language = robot.language.with_rewriter(three_ways);
    let (done, said) = robot.say("whack the whacker down yonder where the boss sits", 80);
    assert!(done.len() > 1 && !said[0].starts_with("I am not sure"), "{done:?} {said:?}");
}

/// What a rewriter makes of one utterance: a thing is to be found, or taken.
fn found_or_taken(said: &str, _: &[(bool, String)], _: &str) -> Vec<(String, f32)> {
    let ways = [("find the hammer", 0.5), ("pick up the hammer", 0.45)];
    let is_it = said == "whack the whacker down yonder where the chief sits";
    ways.iter().filter(|_| is_it).map(|(text, share)| ((*text).to_owned(), *share)).collect()
}

#[test]
fn what_is_taken_has_to_be_found_first() {
    let mut robot = Robot::new(&[]);
    robot.language = robot.language.with_rewriter(found_or_taken);
    let (done, said) = robot.say("whack the whacker down yonder where the chief sits", 80);
    assert!(said[0].ends_with("Shall I also pick up the hammer?"), "{said:?}");
    assert_eq!(done.last().map(String::as_str), Some("go Hammer_1"), "{done:?} {said:?}");
    assert_eq!(said.last().map(String::as_str), Some("? Shall I also pick up the hammer?"), "{said:?}");
    let (done, said) = robot.say("yes", 2);
    assert_eq!(done.last().map(String::as_str), Some("take Hammer_1"), "{said:?}");
}

#[test]
fn a_named_room_is_searched_and_no_other() {
    let mut robot = Robot::new(&[]);
    let (done, _) = robot.say("pick up the trophy in the main office", 60);
    assert!(done[0].starts_with("go MainOffice"), "{done:?}");
    assert_eq!(done.last().unwrap(), "take Trophy01_1");
    let mut robot = Robot::new(&[]);
    let (done, said) = robot.say("pick up the trophy in the quantum lab", 60);
    let strays = done.iter().any(|step| !step.contains("Lab2") && step != "look around");
    assert!(!strays, "{done:?}");
    assert_eq!(
        said.last().unwrap(),
        "! I have looked everywhere I could, and found no trophy in the quantum lab.",
        "{done:?}"
    );
}

#[test]
fn what_somebody_thinks_of_where_it_is_says_where_to_look_first() {
    for said in [
        "pick up the hammer. I think it is in the quantum lab.",
        "pick up the hammer, it should be in the quantum lab",
        "Pick up the hammer! I'm pretty sure I left it in the quantum lab.",
    ] {
        let mut robot = Robot::new(&[]);
        let (done, said) = robot.say(said, 80);
        assert!(done[0].starts_with("go Lab2"), "{done:?}");
        assert_eq!(done.last().unwrap(), "take Hammer_1", "who is wrong has it found elsewhere: {said:?}");
    }
    // What was asked about is looked for there, too.
    let mut robot = Robot::new(&[]);
    let (_, said) = robot.say("do you see a hammer? It might be in the main office", 1);
    assert!(said[0].ends_with("Shall I look for it?"), "{said:?}");
    let (done, _) = robot.say("yes please", 80);
    assert!(done[0].starts_with("go MainOffice"), "{done:?}");
    // And while it looks.
    let mut robot = Robot::new(&[]);
    robot.say("pick up the hammer", 1);
    let (done, said) = robot.say("it should be in the quantum lab", 1);
    assert!(done.last().unwrap().starts_with("go Lab2") && said[0].starts_with("All right."), "{done:?} {said:?}");
}

#[test]
fn of_several_the_one_is_meant_that_is_where_somebody_thinks_that_it_is() {
    let marks = ["CoffeeMug_Boss_1 in KitchenCounterTop_02_1"];
    for (place, mug) in [("table", "CoffeeMug_Yellow_1"), ("counter", "CoffeeMug_Boss_1")] {
        let mut robot = Robot::new(&marks);
        robot.look(true);
        let (done, said) = robot.say(&format!("grab a mug, I think it's on the {place}"), 1);
        assert_eq!(done, [format!("take {mug}")], "{said:?}");
    }
}

#[test]
fn doors_are_opened_only_where_looking_did_not_find_it_and_closed_again() {
    let mut robot = Robot::new(&[]);
    let (done, _) = robot.say("take the milk", 80);
    assert_eq!(done.last().unwrap(), "take MilkCarton_01_1", "{done:?}");
    assert_eq!(done[0], "look around");
    let opened: Vec<&String> = done.iter().filter(|step| step.starts_with("open ")).collect();
    let closed = done.iter().filter(|step| step.starts_with("close ")).count();
    assert_eq!((opened.last().unwrap().as_str(), closed), ("open FridgeLower_02_1", opened.len() - 1), "{done:?}");
    let mut robot = Robot::new(&[]);
    let (done, _) = robot.say("take the milk from the fridge", 80);
    assert!(done.contains(&"open FridgeLower_02_1".to_owned()), "{done:?}");
    let others = done.iter().filter(|step| step.starts_with("open ")).count();
    assert_eq!(others, 1, "{done:?}");
}

#[test]
fn what_a_question_kept_it_from_looking_into_it_looks_into_afterwards() {
    // The step that it was at ends so, or all that is told is that it turned to point something out.
    let turn = Step { action: Action::Rotate { yaw_rad: 1.0 }, says: String::new() };
    looks_into_the_fridge_after(|step| (step, Status::Interrupted));
    looks_into_the_fridge_after(|_| (turn, Status::ActionSuccessful));
}

fn looks_into_the_fridge_after(comes_between: impl FnOnce(Step) -> (Step, Status)) {
    let mut robot = Robot::new(&[]);
    let known = robot.memory.known().unwrap();
    let looks = robot.language.understand("take the milk from the fridge", &known, &mut robot.context);
    let Understanding::Plan { steps, .. } = looks else { panic!("{looks:?}") };
    robot.carry_out(&steps[0]);
    let known = robot.memory.known().unwrap();
    let Some(Understanding::Plan { steps, .. }) = robot.language.carry_on(&known, &mut robot.context) else {
        panic!("it goes on looking");
    };
    assert_eq!(step_text(&steps[0], &robot.world), "open FridgeLower_02_1");
    let asked = robot.language.understand("is the fridge closed now?", &known, &mut robot.context);
    assert!(matches!(asked, Understanding::Answer { .. }), "{asked:?}");
    let (step, status) = comes_between(steps[0].clone());
    robot.context.note_outcome(&step, status);
    let Some(Understanding::Plan { steps, .. }) = robot.language.carry_on(&known, &mut robot.context) else {
        panic!("it goes on looking");
    };
    assert_eq!(step_text(&steps[0], &robot.world), "open FridgeLower_02_1");
}

#[test]
fn what_is_dropped_is_not_looked_for_any_longer_whatever_else_is_said() {
    for said in [
        "never mind the hammer, where is the banana?",
        "where is the banana? never mind the hammer",
        "forget it, which mug is red?",
        "actually leave that, what is on the table?",
        "never mind the hammer",
    ] {
        let mut robot = Robot::new(&[]);
        robot.say("bring me the hammer", 2);
        assert!(robot.context.is_searching(), "{said}");
        let known = robot.memory.known().unwrap();
        let understood = robot.language.understand(said, &known, &mut robot.context);
        assert!(matches!(understood, Understanding::Stop { .. }), "{said}: {understood:?}");
        assert!(!robot.context.is_searching() && !robot.context.awaits_more(), "{said}");
    }
    let mut robot = Robot::new(&[]);
    robot.say("bring me the hammer", 2);
    let known = robot.memory.known().unwrap();
    let instead = "forget about the hammer, go to the main office instead";
    let understood = robot.language.understand(instead, &known, &mut robot.context);
    assert!(matches!(understood, Understanding::Stop { then: Some(_), .. }), "{understood:?}");
    assert!(!robot.context.is_searching());
    // A question in between leaves the search.
    let mut robot = Robot::new(&[]);
    robot.say("bring me the hammer", 2);
    let known = robot.memory.known().unwrap();
    let answer = robot.language.understand("where is the banana?", &known, &mut robot.context);
    assert!(matches!(answer, Understanding::Answer { .. }) && robot.context.is_searching());
}

#[test]
fn the_beginning_of_a_request_is_done_before_its_rest_is_looked_for() {
    let mut robot = Robot::new(&[]);
    let (done, _) = robot.say("go to the main office, pick up the hammer and put it on the green desk", 60);
    assert_eq!(done[0], "go MainOffice", "{done:?}");
    assert_eq!(done[done.len() - 2..], ["take Hammer_1", "put AP_Prop_Desk_Green_1"], "{done:?}");
}

#[test]
fn what_lies_low_beside_it_is_looked_for_before_it_leaves_the_room() {
    for (room, viewpoint, thing, parent, said) in [
        ("UtilityRoom", 5, "Shirt_1", "Laundry_Basket", "pick up the shirt"),
        ("UtilityRoom", 1, "Shirt_1", "Laundry_Basket", "take the shirt please"),
    ] {
        let mut robot = Robot::at_home((room, viewpoint), thing, parent);
        assert!(!robot.knows(thing), "it looks over it");
        let (done, said) = robot.say(said, 20);
        let took = done.iter().position(|step| *step == format!("take {thing}"));
        let took = took.unwrap_or_else(|| panic!("{done:?} {said:?}"));
        let leaves = done[..took].iter().any(|step| step.starts_with("go ") && !step.contains(room));
        assert!(!leaves && took < 16, "{done:?}");
    }
}

#[test]
fn it_raises_its_head_again_that_it_lowered_and_lowers_it_for_no_tall_thing() {
    let mut robot = Robot::at_home(("UtilityRoom", 5), "Shirt_1", "Laundry_Basket");
    let (done, _) = robot.say("pick up the shirt", 20);
    let looks = |done: &[String], way: &str| done.iter().filter(|step| *step == way).count();
    assert_eq!(looks(&done, "look -34"), looks(&done, "look 34"), "{done:?}");
    let mut robot = Robot::at_home(("UtilityRoom", 5), "Shirt_1", "Laundry_Basket");
    let (done, _) = robot.say("find the wardrobe", 20);
    assert_eq!(looks(&done, "look -34"), 0, "{done:?}");
}

#[test]
fn who_shuts_a_door_on_the_way_out_is_out_then() {
    for said in [
        "close the door on your way out",
        "leave the room and close the door",
        "close the door on your way out, I'm going to lunch",
        "I have to run. Shut the door on your way out!",
    ] {
        let mut robot = Robot::new(&["Door_01_1 open"]);
        robot.look(true);
        let (done, replies) = robot.say(said, 3);
        assert_eq!(done, ["go MainOffice", "close Door_01_1"], "{said}: {replies:?}");
    }
    let mut robot = Robot::new(&["Door_01_1 open"]);
    robot.look(true);
    assert_eq!(robot.say("shut the door with you on the inside", 3).0, ["close Door_01_1"]);
}

#[test]
fn a_device_is_looked_for_too() {
    let mut robot = Robot::new(&["Microwave_01_1 in KitchenCounterTop_02_1"]);
    let (done, said) = robot.say("heat the red mug", 60);
    assert!(done.contains(&"toggle Microwave_01_1".to_owned()), "{done:?} {said:?}");
}

#[test]
fn a_search_stops_at_once_and_is_not_endless() {
    let mut robot = Robot::new(&["without Hammer_1"]);
    robot.say("find the hammer", 2);
    let (done, said) = robot.say("stop", 10);
    assert!(done.is_empty(), "{done:?}");
    assert_eq!(said, ["stop!"]);
    assert!(robot.language.carry_on(&robot.memory.known().unwrap(), &mut robot.context).is_none());
    let (done, said) = robot.say("find the hammer", 1000);
    assert!(done.len() < 100, "{}", done.len());
    assert_eq!(said.last().unwrap(), "! I have looked everywhere I could, and found no hammer.");
}

#[test]
fn what_was_done_before_a_search_that_is_stopped_is_not_undone() {
    let mut robot = Robot::new(&["without Hammer_1"]);
    robot.look(true);
    let (done, _) = robot.say("open the microwave", 1);
    assert_eq!(done, ["open Microwave_01_1"]);
    robot.say("find the hammer", 2);
    robot.say("stop", 1);
    let known = robot.memory.known().unwrap();
    let undone = crate::support::text(&robot.language.understand("undo that", &known, &mut robot.context), &known);
    assert!(!undone.contains("Microwave"), "{undone}");
}

#[test]
fn a_question_is_answered_from_memory() {
    let mut robot = Robot::new(&[]);
    let (_, said) = robot.say("where is the red mug?", 1);
    assert_eq!(said, ["= The red mug is on the table."]);
    let (_, said) = robot.say("where is the milk?", 1);
    assert_eq!(said, ["? I have not seen any milk yet. Shall I look for it?"]);
    let (done, _) = robot.say("yes", 80);
    assert_eq!(done.last().unwrap(), "go MilkCarton_01_1", "{done:?}");
}

#[test]
fn what_it_has_opened_it_has_looked_into() {
    let mut robot = Robot::new(&[]);
    robot.look(true);
    let (_, said) = robot.say("what is in the microwave?", 1);
    assert_eq!(said, ["? The microwave is closed. I have not looked into it yet. Shall I?"]);
    robot.say("no", 1);
    robot.say("open the microwave", 1);
    robot.say("close the microwave", 1);
    let (_, said) = robot.say("what is in the microwave?", 1);
    assert_eq!(said, ["= I know of nothing in the microwave."]);
}

#[test]
fn what_a_machine_did_behind_its_door_is_told_by_what_such_machines_do() {
    let mut robot = Robot::new(&["CoffeeMug_Boss_1 coffee"]);
    robot.say("put the red mug in the microwave and close it", 8);
    let told = |robot: &mut Robot| robot.say("is the coffee hot?", 1).1.join(" ");
    let before = told(&mut robot);
    assert!(before.starts_with("= No, "), "{before}");
    robot.say("turn on the microwave", 2);
    let after = told(&mut robot);
    assert!(after.starts_with("= Yes, the ") && after.contains("should be hot by now: the microwave"), "{after}");
    // What it sees counts more.
    robot.say("open the microwave", 1);
    let seen = told(&mut robot);
    assert!(!seen.contains("should be hot"), "{seen}");
}

#[test]
fn what_it_has_not_looked_into_may_not_be_empty() {
    let mut robot = Robot::new(&[]);
    robot.look(true);
    let (_, said) = robot.say("is the fridge empty?", 1);
    assert_eq!(said, ["? The fridge is closed. I have not looked into it yet. Shall I?"]);
    let (done, _) = robot.say("yes", 5);
    assert!(done.contains(&"open FridgeLower_02_1".to_owned()), "{done:?}");
    let (_, said) = robot.say("is the fridge empty?", 1);
    assert_eq!(said, ["= No, the fridge is not empty."]);
}

#[test]
fn of_two_things_that_it_has_not_seen_it_looks_for_both() {
    let mut robot = Robot::new(&[]);
    let (_, said) = robot.say("where are the milk and the hammer?", 1);
    assert_eq!(said, ["? I have not seen any milk or a hammer yet. Shall I look for them?"]);
    let (done, _) = robot.say("yes", 150);
    let finds = |instance: &str| done.iter().any(|step| *step == format!("go {instance}"));
    assert!(finds("MilkCarton_01_1") && finds("Hammer_1"), "{done:?}");
}

#[test]
fn what_is_gone_is_asked_about_and_looked_for() {
    let mut robot = Robot::new(&[]);
    robot.say("pick up the red mug", 1);
    let known = robot.memory.known().unwrap();
    let id = robot.id("CoffeeMug_Boss_1");
    let asked = robot.language.report_missing(id, &known, &mut robot.context);
    let Understanding::Question { kind: Clarification::Confirmation, text, options, .. } = asked else {
        panic!("{asked:?}");
    };
    assert_eq!(text, "The red mug is not there any more. Shall I look for it?");
    assert_eq!(options, ["yes", "no"]);
    robot.memory.forget(id);
    let (done, said) = robot.say("yes", 60);
    assert!(done.len() > 1 && said[0].starts_with("I have not seen a red mug yet"), "{done:?} {said:?}");
}

#[test]
fn what_one_learnt_another_studies() {
    let mut robot = Robot::new(&[]);
    robot.look(true);
    let mut past: Lessons = robot.memory.take_lessons().unwrap();
    robot.say("pick up the red mug", 3);
    robot.say("find the trophy", 60);
    past.add(robot.memory.take_lessons().unwrap());
    assert!(robot.memory.take_lessons().is_none());
    let read: Lessons = serde_json::from_str(&serde_json::to_string(&past).unwrap()).unwrap();
    let mut next = Memory::new(plan());
    next.study(&read);
    assert!(next.known().is_none(), "it has not looked yet");
    let Known { objects, .. } = robot.memory.known().unwrap();
    std::mem::swap(&mut robot.memory, &mut next);
    robot.look(false);
    let again = robot.memory.known().unwrap().objects;
    let instances = |objects: &[KnownObject]| -> Vec<String> {
        objects.iter().map(|object| format!("{} {:?}", object.instance, object.parent)).collect()
    };
    assert_eq!(instances(&again), instances(&objects));
}
