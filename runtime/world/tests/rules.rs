//! What each command comes to, as tables: lines before, the line in question, the status, and what holds after.

#![allow(clippy::unwrap_used)]

mod support;
mod wishes;

use std::sync::Arc;

use cohabit_cdf::{Catalog, Color, Fluid, Mission, ObjectRequest, Property, RoomId, StateFlag};
use cohabit_world::{Action, BodyId, Ending, Event, GoToTarget, ObjectId, Status, Verb};
use support::{Player, build, plain_mission};
use wishes::{OK, check, flags, fluid, inside, player, request};

const ON_TABLE: &str = "Apple_1 in TableRound_02_1";

#[test]
fn hands() {
    let table = "TableRound_02_1 emptied";
    for (wishes, lines, expected) in [
        (&[table, ON_TABLE][..], &["goto Apple_1", "pickup Apple_1"][..], OK),
        (&[table, ON_TABLE], &["goto Apple_1", "pickup Apple_1", "pickup Apple_1"], Status::AlreadyHoldingObject),
        (&[table], &["goto TableRound_02_1", "pickup TableRound_02_1"], Status::UnsupportedAction),
        (&[table], &["goto TableRound_02_1", "place TableRound_02_1"], Status::ObjectNotPickedUp),
        (&[table, ON_TABLE], &["room Warehouse", "pickup Apple_1"], Status::TargetOutOfRange),
        (
            &["FridgeLower_02_1", "Apple_1 in FridgeLower_02_1"],
            &["goto FridgeLower_02_1", "pickup Apple_1"],
            Status::ReceptacleIsClosed,
        ),
        (
            &[table, ON_TABLE],
            &["goto Apple_1", "pickup Apple_1", "goto FridgeLower_02_10000", "place FridgeLower_02_10000"],
            Status::ReceptacleIsClosed,
        ),
        (
            &[table, ON_TABLE],
            &["goto Apple_1", "pickup Apple_1", "goto Toaster_02", "place Toaster_02"],
            Status::UnsupportedAction,
        ),
        (
            &[table, "FoodPlate_01_1 in TableRound_02_1", "Apple_1 in FoodPlate_01_1"],
            &["goto FoodPlate_01_1", "pickup FoodPlate_01_1", "place Apple_1"],
            Status::InvalidCommand,
        ),
        (
            &[table, "FoodPlate_01_1 in TableRound_02_1"],
            &["goto FoodPlate_01_1", "pickup FoodPlate_01_1", "place FoodPlate_01_1"],
            Status::InvalidCommand,
        ),
        (
            &[table, ON_TABLE, "Microwave_01_1 emptied +Opened", "Bowl_01_1 in Microwave_01_1"],
            &["goto Apple_1", "pickup Apple_1", "goto Microwave_01_1", "place Microwave_01_1"],
            Status::ReceptacleIsFull,
        ),
    ] {
        check(wishes, lines, expected);
    }
}

#[test]
fn what_stands_on_what_is_carried_comes_along() {
    let wishes = ["TableRound_02_1 emptied", "FoodPlate_01_1 in TableRound_02_1", "Apple_1 in FoodPlate_01_1"];
    let player = check(&wishes, &["goto FoodPlate_01_1", "pickup FoodPlate_01_1", "room MainOffice"], OK);
    let apple = player.world.object(player.id("Apple_1")).unwrap();
    assert_eq!(apple.parent, Some(player.id("FoodPlate_01_1")));
    assert_eq!(apple.room, RoomId::MAIN_OFFICE);
    assert!(apple.position_m.distance(player.world.body(BodyId(0)).unwrap().position_m) < 1.2);
}

#[test]
fn doors_and_lids() {
    for (wishes, lines, expected) in [
        (&["FridgeLower_02_1 -Opened"][..], &["goto FridgeLower_02_1", "open FridgeLower_02_1"][..], OK),
        (&["FridgeLower_02_1 +Opened"], &["goto FridgeLower_02_1", "open FridgeLower_02_1"], Status::InvalidCommand),
        (
            &["FridgeLower_02_1 +Locked"],
            &["goto FridgeLower_02_1", "open FridgeLower_02_1"],
            Status::ActionExecutionError,
        ),
        (&["FridgeLower_02_1 +Opened"], &["goto FridgeLower_02_1", "close FridgeLower_02_1"], OK),
        (&[], &["goto TableRound_02_1", "open TableRound_02_1"], Status::UnsupportedAction),
        (&["Door_01_3 -Opened +Locked"], &["room Warehouse"], Status::UnsupportedNavigation),
    ] {
        check(wishes, lines, expected);
    }
    // A shut door that is not locked is opened in passing.
    let player = check(&["Door_01_3 -Opened"], &["room Warehouse"], OK);
    assert!(flags(&player, "Door_01_3").has(StateFlag::Opened));
}

#[test]
fn the_freezer_chills_once_it_is_closed() {
    let wishes = ["FridgeUpper_02_1 emptied +Opened", "CanSodaNew_01_1 in FridgeUpper_02_1 +Hot"];
    let mut player = check(&wishes, &["goto FridgeUpper_02_1"], OK);
    assert!(flags(&player, "CanSodaNew_01_1").has(StateFlag::Hot));
    player.must(&["close FridgeUpper_02_1"]);
    let can = flags(&player, "CanSodaNew_01_1");
    assert!(can.has(StateFlag::Cold) && !can.has(StateFlag::Hot));
}

#[test]
fn a_hand_holds_one_thing_whatever_the_rules_say() {
    // As a world pack may have it: without the need `not held exists`.
    let rule = "[[rule]]\nname = \"grab\"\naction = \"pick_up\"\nneeds = []\neffects = [\"take it\"]\n";
    let files = [&[("grab.toml", rule)][..], Catalog::builtin_table()].concat();
    let catalog = Arc::new(Catalog::builtin().with_table(&files).unwrap());
    let objects = Vec::from(["TableRound_02_1 emptied", ON_TABLE, "Bowl_01_1 in TableRound_02_1"].map(request));
    let mut player = Player::new(build(&catalog, Mission { objects, ..plain_mission(RoomId::BREAK_ROOM) }, 5));
    player.must(&["goto Apple_1", "pickup Apple_1", "goto Bowl_01_1", "pickup Bowl_01_1"]);
    let held = player.world.body(BodyId(0)).unwrap().held;
    assert_eq!(held, Some(player.id("Bowl_01_1")));
    assert!(!flags(&player, "Apple_1").has(StateFlag::PickedUp), "it was let go");
}

#[test]
fn fluids() {
    const SINK: &str = "KitchenCounterSink_01_10000";
    let wishes = ["TableRound_02_1 emptied", "CoffeeMug_Boss_1 in TableRound_02_1", "Bowl_01_1 in TableRound_02_1"];
    let take = ["goto CoffeeMug_Boss_1", "pickup CoffeeMug_Boss_1", "goto KitchenCounterSink_01_10000"];
    let line = |verb: &str| format!("{verb} {SINK}");
    let mut player = check(&wishes, &take, OK);
    assert_eq!(player.run(&line("fill")).status, Status::ActionExecutionError);
    player.must(&[&line("toggle"), &line("fill")]);
    assert_eq!(fluid(&player, "CoffeeMug_Boss_1"), Fluid::Water);
    assert_eq!(player.run(&line("fill")).status, Status::ActionExecutionError);
    assert_eq!(player.run(&line("clean")).status, Status::UnsupportedAction);
    player.must(&["goto Bowl_01_1", "pour Bowl_01_1"]);
    assert_eq!((fluid(&player, "CoffeeMug_Boss_1"), fluid(&player, "Bowl_01_1")), (Fluid::None, Fluid::Water));
    assert_eq!(player.run("pour Bowl_01_1").status, Status::ActionExecutionError);
}

#[test]
fn a_plate_is_cleaned_under_running_water() {
    let wishes = ["TableRound_02_1 emptied", "FoodPlate_01_1 in TableRound_02_1 +Dirty"];
    let sink = "KitchenCounterSink_01_10000";
    let mut player = check(&wishes, &["goto FoodPlate_01_1", "pickup FoodPlate_01_1", &format!("goto {sink}")], OK);
    assert_eq!(player.run(&format!("clean {sink}")).status, Status::ActionExecutionError);
    player.must(&[&format!("toggle {sink}"), &format!("clean {sink}")]);
    assert!(!flags(&player, "FoodPlate_01_1").has(StateFlag::Dirty));
}

#[test]
fn no_rule_puts_a_thing_into_itself() {
    // As a world pack may have it: without the need `not it is in held`.
    let rule = "[[rule]]\nname = \"stack\"\naction = \"place\"\nneeds = []\neffects = [\"put held it\"]\n";
    let files = [&[("stack.toml", rule)][..], Catalog::builtin_table()].concat();
    let catalog = Arc::new(Catalog::builtin().with_table(&files).unwrap());
    let wishes = ["TableRound_02_1 emptied", "FoodPlate_01_1 in TableRound_02_1", "Apple_1 in FoodPlate_01_1"];
    let objects = wishes.iter().map(|line| request(line)).collect();
    let mut player = Player::new(build(&catalog, Mission { objects, ..plain_mission(RoomId::BREAK_ROOM) }, 5));
    player.must(&["goto FoodPlate_01_1", "pickup FoodPlate_01_1"]);
    assert_eq!(player.run("place FoodPlate_01_1").status, Status::InvalidCommand);
    assert_eq!(player.run("place Apple_1").status, Status::InvalidCommand);
    player.must(&["place TableRound_02_1"]);
}

#[test]
fn tools() {
    let wishes = ["TableRound_02_1 emptied", "Hammer_1 in TableRound_02_1", "Bowl_01_1 in TableRound_02_1"];
    check(&wishes, &["goto Bowl_01_1", "break Bowl_01_1"], Status::ObjectNotPickedUp);
    check(&wishes, &["goto TableRound_02_1", "break TableRound_02_1"], Status::UnsupportedAction);
    let player = check(&wishes, &["goto Hammer_1", "pickup Hammer_1", "goto Bowl_01_1", "break Bowl_01_1"], OK);
    assert!(flags(&player, "Bowl_01_1").has(StateFlag::Broken));
    assert!(flags(&player, "Hammer_1").has(StateFlag::Used));
    let wishes = ["TableRound_02_1 emptied", "Knife_01_1 in TableRound_02_1", "BreadLoaf_1 in TableRound_02_1"];
    let player = check(&wishes, &["goto Knife_01_1", "pickup Knife_01_1", "goto BreadLoaf_1", "break BreadLoaf_1"], OK);
    assert!(flags(&player, "BreadLoaf_1").has(StateFlag::Cut));
    assert!(player.events.iter().any(|event| matches!(event, Event::Spawned { .. })));
}

#[test]
fn notes_are_read_and_things_scanned() {
    let mission = Mission {
        objects: vec![ObjectRequest {
            text: Some("Mind the step.".into()),
            room: Some(RoomId::LAB1),
            ..request("StickyNote_1")
        }],
        ..plain_mission(RoomId::LAB1)
    };
    let mut player = Player::new(build(&Arc::new(Catalog::builtin()), mission, 5));
    player.must(&["goto StickyNote_1", "examine StickyNote_1", "scan StickyNote_1"]);
    let read = Event::NoteRead { object: player.id("StickyNote_1"), text: "Mind the step.".into() };
    assert!(player.events.contains(&read));
    assert!(flags(&player, "StickyNote_1").has(StateFlag::Examined));
    assert!(flags(&player, "StickyNote_1").has(StateFlag::Scanned));
}

#[test]
fn the_time_machine_undoes() {
    let open = "YesterdayMachine_01_1 +Opened";
    for (thing, flag) in
        [("Bowl_01_1", StateFlag::Broken), ("Apple_1", StateFlag::Eaten), ("BreadSlice_01_1", StateFlag::Cooked)]
    {
        let wish = format!("{thing} in YesterdayMachine_01_1 +{flag:?}");
        let player = check(
            &[open, &wish],
            &["goto YesterdayMachine_01_1", "close YesterdayMachine_01_1", "toggle YesterdayMachine_01_1", "wait 20"],
            OK,
        );
        assert!(!flags(&player, thing).has(flag), "{thing}");
        assert!(flags(&player, "YesterdayMachine_01_1").has(StateFlag::Toggled));
    }
    let wishes =
        [open, "Carrot_01_1 in YesterdayMachine_01_1 yesterday Donut_01", "Donut_01_1 unique in TableRound_02_1"];
    let machine = "YesterdayMachine_01_1";
    let steps = ["goto", "close", "toggle"].map(|verb| format!("{verb} {machine}"));
    check(&wishes, &[&steps[0], &steps[2]], Status::ActionExecutionError);
    let player = check(&wishes, &[&steps[0], &steps[1], &steps[2], "wait 140"], OK);
    assert!(player.world.find("Carrot_01_1").is_none());
    assert_eq!(player.world.object(player.id("Donut_01_2")).unwrap().parent, Some(player.id("YesterdayMachine_01_1")));
    assert!(!flags(&player, "YesterdayMachine_01_1").has(StateFlag::Toggled));
    check(
        &["YesterdayMachine_01_1"],
        &["goto YesterdayMachine_01_1", "toggle YesterdayMachine_01_1"],
        Status::ActionExecutionError,
    );
}

#[test]
fn kitchen_machines() {
    let player = check(
        &["Microwave_01_1 emptied", "Bowl_01_1 in Microwave_01_1 +Cold"],
        &["goto Microwave_01_1", "toggle Microwave_01_1", "wait 20"],
        OK,
    );
    let bowl = flags(&player, "Bowl_01_1");
    assert!(bowl.has(StateFlag::Hot) && !bowl.has(StateFlag::Cold));
    let player = check(&["BreadSlice_01_1 in Toaster_02"], &["goto Toaster_02", "toggle Toaster_02", "wait 20"], OK);
    assert!(flags(&player, "BreadSlice_01_1").has(StateFlag::Cooked));
    let wishes = ["CoffeeMaker_01_1 emptied filled Water", "CoffeeMug_Boss_1 in CoffeeMaker_01_1"];
    let player = check(&wishes, &["goto CoffeeMaker_01_1", "toggle CoffeeMaker_01_1", "wait 20"], OK);
    assert_eq!(fluid(&player, "CoffeeMug_Boss_1"), Fluid::Coffee);
    assert!(flags(&player, "CoffeeMug_Boss_1").has(StateFlag::Hot));
    let wishes = ["CoffeeMaker_01_1 emptied", "CoffeeMug_Boss_1 in CoffeeMaker_01_1"];
    check(&wishes, &["goto CoffeeMaker_01_1", "toggle CoffeeMaker_01_1"], Status::ActionExecutionError);
    let player = check(
        &["CoffeeUnMaker_01_1 filled Coffee"],
        &["goto CoffeeUnMaker_01_1", "toggle CoffeeUnMaker_01_1", "wait 20"],
        OK,
    );
    assert_eq!(fluid(&player, "CoffeeUnMaker_01_1"), Fluid::None);
    assert!(player.world.find("CoffeeUnMaker_01_1_Spawned_CoffeeBeans_01_1").is_some());
    let wishes = ["Microwave_01_1 emptied", "Floppy_Virus_1 in Microwave_01_1"];
    let player = check(&wishes, &["goto Microwave_01_1", "toggle Microwave_01_1", "wait 20"], OK);
    assert!(flags(&player, "Floppy_Virus_1").has(StateFlag::Broken));
}

#[test]
fn laboratory_machines() {
    let player = check(
        &["EAC_Machine_1", "Apple_1 in EAC_Machine_1"],
        &["goto EAC_Machine_1", "toggle EAC_Machine_1", "wait 20"],
        OK,
    );
    assert!(player.world.find("EAC_Machine_1_Spawned_Carrot_01_1").is_some() && player.world.find("Apple_1").is_none());
    for (cartridge, product) in
        [("Figure", "ActionFigure"), ("Hammer", "Hammer"), ("Lever", "FuseBox_01_Lever"), ("Mug", "CoffeeMug_Yellow")]
    {
        let wish = format!("Printer_Cartridge_{cartridge}_1 in Printer_3D_1");
        let player = check(&["Printer_3D_1", &wish], &["goto Printer_3D_1", "toggle Printer_3D_1", "wait 20"], OK);
        let made = player.world.find(&format!("Printer_3D_1_Spawned_{product}_1")).unwrap();
        assert_eq!(player.world.object(made).unwrap().parent, Some(player.id("Printer_3D_1")));
        assert!(player.world.find(&format!("Printer_Cartridge_{cartridge}_1")).is_some());
    }
    for (button, color) in [("Red", Color::Red), ("Green", Color::Green), ("Blue", Color::Blue)] {
        let press = format!("ColorChanger_Button_{button}_10000");
        let lines = [format!("goto {press}"), format!("toggle {press}"), "wait 20".to_owned()];
        let player = check(&["Bowl_01_1 in ColorChangerStation_1"], &lines.each_ref().map(String::as_str), OK);
        assert_eq!(player.world.object(player.id("Bowl_01_1")).unwrap().color, color);
    }
    check(
        &[],
        &["goto ColorChanger_Button_Red_10000", "toggle ColorChanger_Button_Red_10000"],
        Status::ActionExecutionError,
    );
    let player = check(
        &["Apple_1 in Embiggenator_10000"],
        &["goto V_Monitor_Embiggenator_10000", "toggle V_Monitor_Embiggenator_10000", "wait 20"],
        OK,
    );
    assert!(flags(&player, "Apple_1").has(StateFlag::Embiggenated));
    assert!(player.world.object(player.id("Apple_1")).unwrap().scale[0] > 1.5);
    let mut player = check(&["Apple_1 in GravityPad_1"], &["goto V_Monitor_Gravity_10000"], OK);
    let low = player.world.object(player.id("Apple_1")).unwrap().position_m.z;
    player.must(&["toggle V_Monitor_Gravity_10000", "wait 90"]);
    assert!(player.world.object(player.id("Apple_1")).unwrap().position_m.z > low + 0.3);
    check(&["Laser_1"], &["goto Laser_1", "toggle Laser_1"], Status::UnsupportedAction);
    check(
        &["Laser_1 emptied"],
        &["goto V_Monitor_Laser_10000", "toggle V_Monitor_Laser_10000"],
        Status::ActionExecutionError,
    );
}

#[test]
fn rays_do_their_work_on_their_shelves() {
    let parts = ["Laser_Tip_1 in Laser_1", "Laser_CircuitBoard_1 in Laser_1", "Laser_ControlPanel_1 in Laser_1"];
    let hot = ["Bowl_01_1 in AP_Prop_Shelf_Wall_Laser_10000"];
    let wishes: Vec<&str> = parts.into_iter().chain(hot).collect();
    let player = check(&wishes, &["goto V_Monitor_Laser_10000", "toggle V_Monitor_Laser_10000", "wait 20"], OK);
    assert!(flags(&player, "Bowl_01_1").has(StateFlag::Hot) && flags(&player, "Laser_1").has(StateFlag::Toggled));
    let player = check(
        &["Bowl_01_1 in AP_Prop_Shelf_Wall_04_10000"],
        &["goto V_Monitor_FreezeRay_10000", "toggle V_Monitor_FreezeRay_10000", "wait 20"],
        OK,
    );
    assert!(flags(&player, "Bowl_01_1").has(StateFlag::Cold));
}

#[test]
fn disks_infect_and_clean() {
    let wishes = ["TableRound_02_1 emptied", "Floppy_Virus_1 in TableRound_02_1"];
    let lines =
        ["goto Floppy_Virus_1", "pickup Floppy_Virus_1", "goto Computer_Monitor_01_1", "place Computer_Monitor_01_1"];
    let player = check(&wishes, &lines, OK);
    assert!(flags(&player, "Computer_Monitor_01_1").has(StateFlag::Infected));
    let wishes =
        ["TableRound_02_1 emptied", "Floppy_AntiVirus_1 in TableRound_02_1", "Computer_Monitor_01_1 +Infected"];
    let lines = [
        "goto Floppy_AntiVirus_1",
        "pickup Floppy_AntiVirus_1",
        "goto Computer_Monitor_01_1",
        "place Computer_Monitor_01_1",
    ];
    let player = check(&wishes, &lines, OK);
    assert!(!flags(&player, "Computer_Monitor_01_1").has(StateFlag::Infected));
}

#[test]
fn power() {
    let lines = ["goto Microwave_01_1", "toggle Microwave_01_1"];
    check(&["Microwave_01_1 -Powered"], &lines, Status::ObjectUnpowered);
    check(&["Microwave_01_1 +Overloaded"], &lines, Status::ObjectOverloaded);
    let player = check(&["Microwave_01_1 +Sparking"], &lines, Status::KilledByHazard);
    assert_eq!(player.world.finished(), Some(Ending::KilledByHazard));
    assert!(!player.world.body(BodyId(0)).unwrap().alive);
    let mut player = check(&[], &["wait 1"], OK);
    assert!(player.world.room_lit(RoomId::BREAK_ROOM));
    let switches: Vec<ObjectId> = player
        .world
        .objects()
        .filter(|view| view.instance.starts_with("LightSwitch_01") && view.room == RoomId::BREAK_ROOM)
        .map(|view| view.id)
        .collect();
    for switch in switches {
        assert!(player.play(Action::GoTo { target: GoToTarget::Object(switch) }).status.is_success());
        let press = Action::Interact { verb: Verb::Toggle, object: switch };
        assert!(player.play(press).status.is_success());
    }
    assert!(!player.world.room_lit(RoomId::BREAK_ROOM));
}

#[test]
fn a_lever_cycles_its_circuit() {
    let mut player = check(&["FuseBox_01_1 +Opened", "FuseBox_01_Lever_1 in FuseBox_01_1"], &["goto FuseBox_01_1"], OK);
    let room = player.world.object(player.id("FuseBox_01_1")).unwrap().room;
    let lit = |player: &Player| player.world.room_lit(room);
    assert!(lit(&player));
    player.must(&["toggle FuseBox_01_Lever_1"]);
    assert!(!lit(&player));
    player.must(&["toggle FuseBox_01_Lever_1"]);
    assert!(lit(&player));
}

#[test]
fn nonsense_is_refused() {
    let mut player = player(RoomId::BREAK_ROOM, &[]);
    for (action, expected) in [
        (Action::Move { distance_m: f32::NAN }, Status::IncorrectActionFormat),
        (Action::Rotate { yaw_rad: 1e9 }, Status::IncorrectActionFormat),
        (Action::PickUp { object: ObjectId(100_000) }, Status::InvalidObjectClass),
        (Action::GoTo { target: GoToTarget::Viewpoint(RoomId::LAB1, 99) }, Status::InvalidCommand),
        (Action::GoTo { target: GoToTarget::Point([500.0, 500.0]) }, Status::UnsupportedNavigation),
    ] {
        assert_eq!(player.play(action).status, expected, "{action:?}");
    }
}

/// The situations that lead to each status, and whether something would help that the sentence must name.
const SITUATIONS: &[(Status, bool, &[&str], &[&str])] = &[
    (Status::ActionSuccessful, false, &[], &["goto TableRound_02_1"]),
    (Status::UnsupportedAction, false, &[], &["goto TableRound_02_1", "pickup TableRound_02_1"]),
    (Status::UnsupportedAction, true, &["Laser_1"], &["goto Laser_1", "toggle Laser_1"]),
    (
        Status::UnsupportedAction,
        true,
        &["TableRound_02_1 emptied", ON_TABLE],
        &["goto Apple_1", "pickup Apple_1", "goto Toaster_02", "place Toaster_02"],
    ),
    (Status::UnsupportedNavigation, false, &["Door_01_3 -Opened +Locked"], &["room Warehouse"]),
    (
        Status::AlreadyHoldingObject,
        true,
        &["TableRound_02_1 emptied", ON_TABLE, "Bowl_01_1 in TableRound_02_1"],
        &["goto Apple_1", "pickup Apple_1", "pickup Bowl_01_1"],
    ),
    (
        Status::ReceptacleIsFull,
        true,
        &["TableRound_02_1 emptied", ON_TABLE, "Microwave_01_1 emptied +Opened", "Bowl_01_1 in Microwave_01_1"],
        &["goto Apple_1", "pickup Apple_1", "goto Microwave_01_1", "place Microwave_01_1"],
    ),
    (
        Status::ReceptacleIsFull,
        true,
        &["Printer_Cartridge_Mug_1 in Printer_3D_1"],
        &["goto Printer_3D_1", "toggle Printer_3D_1", "wait 130", "toggle Printer_3D_1"],
    ),
    (
        Status::ReceptacleIsClosed,
        true,
        &["FridgeLower_02_1", "Apple_1 in FridgeLower_02_1"],
        &["goto FridgeLower_02_1", "pickup Apple_1"],
    ),
    (
        Status::TargetInaccessible,
        true,
        &["VendingMachine_01 +Opened emptied", "Apple_1 in VendingMachine_01"],
        &["goto VendingMachine_01", "pickup Apple_1"],
    ),
    (Status::KilledByHazard, false, &["Microwave_01_1 +Sparking"], &["goto Microwave_01_1", "toggle Microwave_01_1"]),
    (Status::TargetOutOfRange, true, &["TableRound_02_1 emptied", ON_TABLE], &["room Warehouse", "pickup Apple_1"]),
    (Status::ObjectUnpowered, true, &["Microwave_01_1 -Powered"], &["goto Microwave_01_1", "toggle Microwave_01_1"]),
    (
        Status::ObjectOverloaded,
        true,
        &["Microwave_01_1 +Overloaded"],
        &["goto Microwave_01_1", "toggle Microwave_01_1"],
    ),
    (Status::InvalidCommand, false, &["FridgeLower_02_1 +Opened"], &["goto FridgeLower_02_1", "open FridgeLower_02_1"]),
    (Status::ObjectNotPickedUp, true, &[], &["goto TableRound_02_1", "place TableRound_02_1"]),
    (
        Status::ActionExecutionError,
        true,
        &["KitchenCounterSink_01_1 -Toggled", "TableRound_02_1 emptied", "Bowl_01_1 in TableRound_02_1"],
        &["goto Bowl_01_1", "pickup Bowl_01_1", "goto KitchenCounterSink_01_1", "fill KitchenCounterSink_01_1"],
    ),
    (
        Status::ActionExecutionError,
        true,
        &["Laser_1 emptied"],
        &["goto V_Monitor_Laser_10000", "toggle V_Monitor_Laser_10000"],
    ),
    (
        Status::ActionExecutionError,
        true,
        &["FridgeLower_02_1 +Locked"],
        &["goto FridgeLower_02_1", "open FridgeLower_02_1"],
    ),
    (Status::ActionExecutionError, true, &["EAC_Machine_1"], &["goto EAC_Machine_1", "toggle EAC_Machine_1"]),
    (
        Status::PostProcessError,
        true,
        &["TableRound_02_1 emptied", "Floppy_Virus_1 in TableRound_02_1", "V_Monitor_Laser_10000 -Powered"],
        &["goto Floppy_Virus_1", "pickup Floppy_Virus_1", "goto V_Monitor_Laser_10000", "place V_Monitor_Laser_10000"],
    ),
];

/// A sentence for people: not empty, without ids, and with what would help after a colon.
fn check_sentence(detail: &str, helps: bool, status: Status) {
    assert!(!detail.trim().is_empty(), "{status:?} says nothing");
    assert!(!detail.contains('_') && !detail.contains(|letter: char| letter.is_ascii_digit()), "{status:?}: {detail}");
    let (cause, help) = detail.split_once(": ").unwrap_or((detail, ""));
    assert!(!cause.is_empty() && (!helps || help.len() > 5), "{status:?} names no remedy: {detail}");
}

#[test]
fn every_status_has_its_situation_and_its_sentence() {
    for (status, helps, wishes, lines) in SITUATIONS {
        let mut player = player(RoomId::BREAK_ROOM, wishes);
        let (last, before) = lines.split_last().unwrap();
        player.must(before);
        let outcome = player.run(last);
        assert_eq!(outcome.status, *status, "{wishes:?} {lines:?}: {}", outcome.detail);
        check_sentence(&outcome.detail, *helps, *status);
    }
    let mut player = player(RoomId::BREAK_ROOM, &[]);
    for (action, status) in [
        (Action::Move { distance_m: f32::INFINITY }, Status::IncorrectActionFormat),
        (Action::PickUp { object: ObjectId(u32::MAX) }, Status::InvalidObjectClass),
    ] {
        let outcome = player.play(action);
        assert_eq!(outcome.status, status);
        check_sentence(&outcome.detail, false, status);
    }
    // Whoever is told something else while at it was interrupted; a place in a wall is gone to as near as can be.
    let walk = Action::GoTo { target: GoToTarget::Room(RoomId::WAREHOUSE) };
    let input = |command, action| cohabit_world::Input { command, body: BodyId(0), action };
    let report = player.world.step(&[input(900, walk), input(901, Action::Stop)]);
    let interrupted = report.outcomes.iter().find(|outcome| outcome.command == 900).unwrap();
    assert_eq!(interrupted.status, Status::Interrupted);
    check_sentence(&interrupted.detail, false, interrupted.status);
    let table = player.world.object(player.id("TableRound_02_1")).unwrap().position_m;
    let outcome = player.play(Action::GoTo { target: GoToTarget::Point([table.x, table.y]) });
    assert_eq!(outcome.status, Status::AlternateNavigationUsed, "{}", outcome.detail);
    check_sentence(&outcome.detail, false, outcome.status);
    // `ArenaUnavailable` alone is never a world's: it says that there is none.
    let told = SITUATIONS.iter().map(|(status, ..)| *status);
    let elsewhere = [
        Status::IncorrectActionFormat,
        Status::InvalidObjectClass,
        Status::Interrupted,
        Status::AlternateNavigationUsed,
        Status::ArenaUnavailable,
    ];
    let all: Vec<Status> = told.chain(elsewhere).collect();
    assert!(Status::ALL.iter().all(|status| all.contains(status)));
}

#[test]
fn what_is_put_beside_a_thing_stands_next_to_it() {
    let [plate, bowl] = ["FoodPlate_01_1 in TableRound_02_1", "Bowl_01_1 in TableRound_02_1"];
    let things = ["TableRound_02_1 emptied", ON_TABLE, plate, bowl];
    let mut player = player(RoomId::BREAK_ROOM, &things);
    let (table, apple) = (player.id("TableRound_02_1"), player.id("Apple_1"));
    for other in ["FoodPlate_01_1", "Bowl_01_1"] {
        player.must(&["goto Apple_1", "pickup Apple_1"]);
        let beside = player.id(other);
        let outcome = player.play(Action::PlaceBeside { receptacle: table, beside });
        assert_eq!(outcome.status, OK, "{other}: {}", outcome.detail);
        assert!(outcome.detail.contains("beside"), "{}", outcome.detail);
        let [one, two] = [apple, beside].map(|id| player.world.object(id).unwrap().position_m);
        assert!(one.distance(two) < 0.32, "{other}: {one} {two}");
        assert_eq!(inside(&player, "Apple_1").as_deref(), Some("TableRound_02_1"));
    }
}

#[test]
fn what_cannot_stand_beside_a_thing_is_put_where_there_is_room() {
    let mut player = player(RoomId::BREAK_ROOM, &["TableRound_02_1 emptied", ON_TABLE]);
    let (table, fridge) = (player.id("TableRound_02_1"), player.id("FridgeLower_02_10000"));
    player.must(&["goto Apple_1", "pickup Apple_1"]);
    let nobody = player.play(Action::PlaceBeside { receptacle: table, beside: ObjectId(u32::MAX) });
    assert_eq!(nobody.status, Status::InvalidObjectClass);
    let outcome = player.play(Action::PlaceBeside { receptacle: table, beside: fridge });
    assert_eq!(outcome.status, Status::AlternateNavigationUsed, "{}", outcome.detail);
    assert_eq!(inside(&player, "Apple_1").as_deref(), Some("TableRound_02_1"));
}

#[test]
fn decor_can_only_be_looked_at() {
    let mut player = player(RoomId::MAIN_OFFICE, &[]);
    let catalog = player.world.catalog().clone();
    let decor = |view: &cohabit_world::ObjectView<'_>| catalog.class(view.class).properties == [Property::Decor];
    let room = RoomId::MAIN_OFFICE;
    let found =
        player.world.objects().find(|view| decor(view) && view.room == room && view.position_m.z < 1.5).unwrap();
    let (id, instance) = (found.id, found.instance.to_owned());
    player.must(&[&format!("goto {instance}"), &format!("examine {instance}")]);
    for action in [
        Action::PickUp { object: id },
        Action::Interact { verb: Verb::Open, object: id },
        Action::Interact { verb: Verb::Close, object: id },
        Action::Interact { verb: Verb::Toggle, object: id },
        Action::Interact { verb: Verb::Break, object: id },
    ] {
        let outcome = player.play(action);
        assert_eq!(outcome.status, Status::UnsupportedAction, "{action:?} {instance}");
        check_sentence(&outcome.detail, false, outcome.status);
    }
}
