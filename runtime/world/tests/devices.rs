//! Every device that can be toggled: when it answers, and what it does.

#![allow(clippy::unwrap_used)]

mod support;
mod wishes;

use cohabit_cdf::{Color, Fluid, Property, RoomId, StateFlag};
use cohabit_world::{Event, SoundKind, Status};
use support::Player;
use wishes::{OK, check, flags, fluid, inside, is, player, press};

const CLOSED: Status = Status::ReceptacleIsClosed;
const FAILS: Status = Status::ActionExecutionError;
const NEVER: Status = Status::UnsupportedAction;
const UNPOWERED: Status = Status::ObjectUnpowered;
const FULL: Status = Status::ReceptacleIsFull;

/// The laser with all its parts.
const PARTS: [&str; 3] =
    ["Laser_Tip_1 in Laser_1", "Laser_CircuitBoard_1 in Laser_1", "Laser_ControlPanel_1 in Laser_1"];

fn on(player: &Player, instance: &str) -> bool {
    is(player, instance, StateFlag::Toggled)
}

#[test]
fn switches_flip() {
    for (wishes, device) in [
        (&["ForkLift_1 -Toggled"][..], "ForkLift_1"),
        (&["KitchenCounterSink_01_1 -Toggled"], "KitchenCounterSink_01_1"),
        (&["RoboticArm_01_1 -Toggled"], "RoboticArm_01_1"),
        (&["LightSwitch_01_1 -Toggled"], "LightSwitch_01_1"),
        (&["TeslaCoil_1 at Lab1"], "TeslaCoil_1"),
        (&["TAMPrototypeHead_01_1"], "TAMPrototypeHead_01_1"),
        (&["Radio_01_1 in TableRound_02_1"], "Radio_01_1"),
        (&["V_Monitor_Gravity_10000 -Toggled"], "V_Monitor_Gravity_10000"),
        (&["V_Monitor_Portal_10000 -Toggled"], "V_Monitor_Portal_10000"),
        (&["FuseBox_01_1 +Opened"], "FuseBox_01_Lever_10000"),
    ] {
        let before = on(&player(RoomId::BREAK_ROOM, wishes), device);
        let mut player = press(wishes, device, OK);
        assert_eq!(on(&player, device), !before, "{device}");
        player.must(&["wait 130"]);
        assert_eq!(on(&player, device), !before, "{device} stays as it is");
        player.must(&[&format!("toggle {device}")]);
        assert_eq!(on(&player, device), before, "{device}");
        assert!(is(&player, device, StateFlag::Used));
    }
}

#[test]
fn some_devices_are_on_for_a_moment() {
    let microwave: &[&str] = &["Microwave_01_1 emptied"];
    for (wishes, device) in [
        (&[][..], "FireAlarm_01_10000"),
        (microwave, "Microwave_01_1"),
        (&[], "Toaster_02"),
        (&[], "CoffeeUnMaker_01_1"),
        (&["Apple_1 in EAC_Machine_1"], "EAC_Machine_1"),
        (&["Apple_1 in YesterdayMachine_01_1"], "YesterdayMachine_01_1"),
        (&["Printer_Cartridge_Mug_1 in Printer_3D_1"], "Printer_3D_1"),
        (&["Bowl_01_1 in ColorChangerStation_1"], "ColorChanger_Button_Blue_10000"),
        (&[], "V_Monitor_FreezeRay_10000"),
    ] {
        let mut player = press(wishes, device, OK);
        assert!(on(&player, device), "{device} is on");
        player.must(&["wait 110"]);
        assert!(!on(&player, device), "{device} is off again");
    }
    let player = press(&[], "FireAlarm_01_10000", OK);
    let alarm = Event::Sound { kind: SoundKind::Alarm, object: player.id("FireAlarm_01_10000") };
    assert!(player.events.contains(&alarm));
}

#[test]
fn some_devices_need_something_in_them() {
    for (wishes, device, expected) in [
        (&["YesterdayMachine_01_1"][..], "YesterdayMachine_01_1", FAILS),
        (&["YesterdayMachine_01_1 +Opened", "Apple_1 in YesterdayMachine_01_1"], "YesterdayMachine_01_1", FAILS),
        (&["EAC_Machine_1"], "EAC_Machine_1", FAILS),
        (&["CoffeeMaker_01_1 emptied"], "CoffeeMaker_01_1", FAILS),
        (&["CoffeeMaker_01_1 emptied filled Water"], "CoffeeMaker_01_1", FAILS),
        (&["CoffeeMaker_01_1 emptied", "CoffeeMug_Boss_1 in CoffeeMaker_01_1"], "CoffeeMaker_01_1", FAILS),
        (&["CoffeeMaker_01_1 emptied filled Water", "CoffeeMug_Boss_1 in CoffeeMaker_01_1"], "CoffeeMaker_01_1", OK),
        (&["CoffeeMaker_01_1 emptied", "CoffeeBeans_01_1 in CoffeeMaker_01_1"], "CoffeeMaker_01_1", OK),
        (&["ColorChangerStation_1"], "ColorChanger_Button_Red_10000", FAILS),
        (&["Printer_3D_1 emptied"], "Printer_3D_1", FAILS),
        (&["Printer_3D_1"], "Printer_3D_1", OK),
        (
            &["Printer_Cartridge_Mug_1 in Printer_3D_1", "Printer_Cartridge_Lever_1 in Printer_3D_1"],
            "Printer_3D_1",
            FULL,
        ),
        (&["Embiggenator_10000"], "V_Monitor_Embiggenator_10000", FAILS),
        (&["Apple_1 in Embiggenator_10000"], "V_Monitor_Embiggenator_10000", OK),
        (&["VendingMachine_01 emptied"], "VendingMachine_01_B4_Button_10000", FAILS),
    ] {
        press(wishes, device, expected);
    }
}

#[test]
fn some_devices_are_worked_by_others() {
    for device in [
        "GravityPad_1",
        "Laser_1",
        "FreezeRay_1",
        "ColorChangerStation_1",
        "PortalGenerator_10000",
        "FuseBox_01_1",
        "FuseBox_02_1",
        "Embiggenator_10000",
    ] {
        press(&[], device, NEVER);
    }
    let mut player = player(RoomId::LAB1, &["Laser_1"]);
    player.must(&["goto Laser_1"]);
    assert!(player.run("toggle Laser_1").detail.contains("red computer"));
}

#[test]
fn nothing_works_without_power() {
    let devices = [
        "Microwave_01_1",
        "Toaster_02",
        "CoffeeMaker_01_1",
        "CoffeeUnMaker_01_1",
        "YesterdayMachine_01_1",
        "EAC_Machine_1",
        "Printer_3D_1",
        "RoboticArm_01_1",
        "V_Monitor_Laser_10000",
        "V_Monitor_FreezeRay_10000",
        "V_Monitor_Gravity_10000",
        "V_Monitor_Portal_10000",
        "V_Monitor_Embiggenator_10000",
        "LightSwitch_01_1",
        "Security_Button_10000",
    ];
    for device in devices {
        let cut = format!("{device} -Powered");
        press(&[&cut], device, UNPOWERED);
        let overloaded = format!("{device} +Overloaded");
        press(&[&overloaded], device, Status::ObjectOverloaded);
    }
    // What a monitor or button works needs power as well.
    let parts = |machine: &'static str| PARTS.into_iter().chain([machine]).collect::<Vec<_>>();
    press(&parts("Laser_1 -Powered"), "V_Monitor_Laser_10000", UNPOWERED);
    press(&["FreezeRay_1 -Powered"], "V_Monitor_FreezeRay_10000", UNPOWERED);
    press(&["GravityPad_1 -Powered"], "V_Monitor_Gravity_10000", UNPOWERED);
    press(&["PortalGenerator_10000 -Powered"], "V_Monitor_Portal_10000", UNPOWERED);
    press(
        &["ColorChangerStation_1 -Powered", "Bowl_01_1 in ColorChangerStation_1"],
        "ColorChanger_Button_Red_10000",
        UNPOWERED,
    );
    press(&["VendingMachine_01 -Powered"], "VendingMachine_01_B4_Button_10000", UNPOWERED);
    // No circuit at all feeds nothing.
    press(&["Security_Button_10000 circuit -1"], "Security_Button_10000", UNPOWERED);
}

#[test]
fn the_laser_needs_all_its_parts_and_stops_at_a_second_press() {
    for missing in 0..PARTS.len() {
        let rest: Vec<&str> =
            PARTS.into_iter().enumerate().filter(|(index, _)| *index != missing).map(|(_, part)| part).collect();
        let wishes: Vec<&str> = ["Laser_1 emptied"].into_iter().chain(rest).collect();
        press(&wishes, "V_Monitor_Laser_10000", FAILS);
    }
    let bowl = "Bowl_01_1 in AP_Prop_Shelf_Wall_Laser_10000 +Cold";
    let wishes: Vec<&str> = PARTS.into_iter().chain([bowl]).collect();
    let mut player = press(&wishes, "V_Monitor_Laser_10000", OK);
    assert!(is(&player, "Bowl_01_1", StateFlag::Hot) && !is(&player, "Bowl_01_1", StateFlag::Cold));
    assert!(on(&player, "Laser_1") && on(&player, "V_Monitor_Laser_10000"));
    player.must(&["toggle V_Monitor_Laser_10000"]);
    assert!(!on(&player, "Laser_1") && !on(&player, "V_Monitor_Laser_10000"));
}

#[test]
fn the_freeze_ray_chills_its_shelf_and_stops_at_a_second_press() {
    let mut player = press(&["Bowl_01_1 in AP_Prop_Shelf_Wall_04_1 +Hot"], "V_Monitor_FreezeRay_10000", OK);
    assert!(is(&player, "Bowl_01_1", StateFlag::Cold) && !is(&player, "Bowl_01_1", StateFlag::Hot));
    player.must(&["toggle V_Monitor_FreezeRay_10000"]);
    assert!(!on(&player, "FreezeRay_1"));
}

#[test]
fn heat_and_cold_come_many_ways() {
    let laser: Vec<&str> = PARTS.into_iter().chain(["CoffeeMug_Boss_1 in AP_Prop_Shelf_Wall_Laser_10000"]).collect();
    for (wishes, device, flag) in [
        (&["Microwave_01_1 emptied", "CoffeeMug_Boss_1 in Microwave_01_1"][..], "Microwave_01_1", StateFlag::Hot),
        (&laser, "V_Monitor_Laser_10000", StateFlag::Hot),
        (
            &["CoffeeMaker_01_1 emptied filled Water", "CoffeeMug_Boss_1 in CoffeeMaker_01_1"],
            "CoffeeMaker_01_1",
            StateFlag::Hot,
        ),
        (&["CoffeeMug_Boss_1 in AP_Prop_Shelf_Wall_04_1"], "V_Monitor_FreezeRay_10000", StateFlag::Cold),
    ] {
        assert!(is(&press(wishes, device, OK), "CoffeeMug_Boss_1", flag), "{device}");
    }
    // What cannot get hot does not; what stands on something gets as hot as that.
    let wishes = ["Microwave_01_1 emptied", "Apple_1 in Microwave_01_1"];
    assert!(!is(&press(&wishes, "Microwave_01_1", OK), "Apple_1", StateFlag::Hot));
}

#[test]
fn the_freezer_chills_only_shut_and_with_power() {
    for (freezer, cold) in
        [("FridgeUpper_02_1 emptied +Opened", true), ("FridgeUpper_02_1 emptied +Opened -Powered", false)]
    {
        let wishes = [freezer, "CanSodaNew_01_1 in FridgeUpper_02_1 +Hot"];
        let player = check(&wishes, &["goto FridgeUpper_02_1", "wait 60", "close FridgeUpper_02_1"], OK);
        assert_eq!(is(&player, "CanSodaNew_01_1", StateFlag::Cold), cold, "{freezer}");
        assert_eq!(is(&player, "CanSodaNew_01_1", StateFlag::Hot), !cold, "{freezer}");
    }
    // The fridge below it is no freezer.
    let wishes = ["FridgeLower_02_1 emptied +Opened", "CanSodaNew_01_1 in FridgeLower_02_1"];
    let player = check(&wishes, &["goto FridgeLower_02_1", "close FridgeLower_02_1"], OK);
    assert!(!is(&player, "CanSodaNew_01_1", StateFlag::Cold));
}

#[test]
fn the_freezer_is_shut_once_it_was_closed() {
    let wishes = ["FridgeUpper_02_1 emptied", "CanSodaNew_01_1 in FridgeUpper_02_1"];
    let lines = [
        "goto FridgeUpper_02_1",
        "open FridgeUpper_02_1",
        "wait 120",
        "goto CanSodaNew_01_1",
        "pickup CanSodaNew_01_1",
        "wait 60",
        "close FridgeUpper_02_1",
        "wait 120",
    ];
    let player = check(&wishes, &lines, OK);
    let freezer = player.world.objects().find(|object| object.instance == "FridgeUpper_02_1").unwrap();
    assert!(freezer.opened < 0.01, "the robot stands in the swing of its door: {}", freezer.opened);
}

#[test]
fn a_hot_disk_breaks_and_does_nothing_any_more() {
    let wishes = ["Microwave_01_1 emptied", "Floppy_Virus_1 in Microwave_01_1"];
    let mut player = press(&wishes, "Microwave_01_1", OK);
    assert!(is(&player, "Floppy_Virus_1", StateFlag::Broken));
    player.must(&[
        "open Microwave_01_1",
        "pickup Floppy_Virus_1",
        "goto V_Monitor_Laser_10000",
        "place V_Monitor_Laser_10000",
    ]);
    assert!(!is(&player, "V_Monitor_Laser_10000", StateFlag::Infected));
}

#[test]
fn disks_infect_and_clean_every_kind_of_computer() {
    for computer in
        ["Computer_Monitor_01_1", "V_Monitor_Laser_10000", "V_Monitor_Portal_10000", "V_Monitor_Gravity_10000"]
    {
        let steps = |disk: &str| {
            [format!("goto {disk}"), format!("pickup {disk}"), format!("goto {computer}"), format!("place {computer}")]
        };
        let table = "TableRound_02_1 emptied";
        let infect = steps("Floppy_Virus_1");
        let player = check(&[table, "Floppy_Virus_1 in TableRound_02_1"], &infect.each_ref().map(String::as_str), OK);
        assert!(is(&player, computer, StateFlag::Infected), "{computer}");
        let clean = steps("Floppy_AntiVirus_1");
        let infected = format!("{computer} +Infected");
        let wishes = [table, "Floppy_AntiVirus_1 in TableRound_02_1", &infected];
        let player = check(&wishes, &clean.each_ref().map(String::as_str), OK);
        assert!(!is(&player, computer, StateFlag::Infected), "{computer}");
        // Without power the disk is in, but not read, until the power comes.
        let unpowered = format!("{computer} -Powered");
        let wishes = [table, "Floppy_Virus_1 in TableRound_02_1", &unpowered];
        let player = check(&wishes, &infect.each_ref().map(String::as_str), Status::PostProcessError);
        assert_eq!(inside(&player, "Floppy_Virus_1").as_deref(), Some(computer));
        assert!(!is(&player, computer, StateFlag::Infected), "{computer}");
    }
    let player = player(RoomId::LAB1, &["V_Monitor_Laser_10000", "Floppy_Virus_1 in V_Monitor_Laser_10000"]);
    assert!(is(&player, "V_Monitor_Laser_10000", StateFlag::Infected), "a disk that starts in it was read");
}

#[test]
fn the_toaster_makes_toast() {
    let wishes = ["BreadSlice_01_1 in Toaster_02", "Donut_01_1 in TableRound_02_1", "TableRound_02_1 emptied"];
    let mut player = press(&wishes, "Toaster_02", OK);
    assert!(is(&player, "BreadSlice_01_1", StateFlag::Cooked));
    player.must(&["goto Donut_01_1", "pickup Donut_01_1", "goto Toaster_02"]);
    assert_eq!(player.run("place Toaster_02").status, NEVER, "it takes bread alone");
}

#[test]
fn coffee_is_made_of_water_or_beans_and_unmade() {
    let wishes = [
        "TableRound_02_1 emptied",
        "CoffeeBeans_01_1 in TableRound_02_1",
        "CoffeeMaker_01_1 emptied",
        "CoffeeMug_Boss_1 in CoffeeMaker_01_1",
    ];
    let mut player = check(&wishes, &["goto CoffeeBeans_01_1", "pickup CoffeeBeans_01_1", "goto CoffeeMaker_01_1"], OK);
    player.must(&["pour CoffeeMaker_01_1", "goto TableRound_02_1", "place TableRound_02_1", "goto CoffeeMaker_01_1"]);
    player.must(&["toggle CoffeeMaker_01_1", "wait 130", "pickup CoffeeMug_Boss_1"]);
    assert_eq!(fluid(&player, "CoffeeMug_Boss_1"), Fluid::Coffee);
    assert!(is(&player, "CoffeeMug_Boss_1", StateFlag::Hot));
    assert_eq!(fluid(&player, "CoffeeMaker_01_1"), Fluid::None);
    player.must(&["goto CoffeeUnMaker_01_1", "pour CoffeeUnMaker_01_1", "toggle CoffeeUnMaker_01_1", "wait 20"]);
    let beans = "CoffeeUnMaker_01_1_Spawned_CoffeeBeans_01_1";
    assert_eq!(inside(&player, beans).as_deref(), Some("CoffeeUnMaker_01_1"));
    assert_eq!(fluid(&player, "CoffeeUnMaker_01_1"), Fluid::None);
}

#[test]
fn a_sink_fills_while_it_runs_and_drains_when_it_stops() {
    let mut player = press(&["KitchenCounterSink_01_1 -Toggled"], "KitchenCounterSink_01_1", OK);
    assert_eq!(fluid(&player, "KitchenCounterSink_01_1"), Fluid::Water);
    player.must(&["toggle KitchenCounterSink_01_1"]);
    assert_eq!(fluid(&player, "KitchenCounterSink_01_1"), Fluid::None);
}

#[test]
fn what_the_time_machine_undoes() {
    let machine = "YesterdayMachine_01_1";
    for (thing, flag) in [
        ("Bowl_01_1", StateFlag::Broken),
        ("Apple_1", StateFlag::Eaten),
        ("BreadSlice_01_1", StateFlag::Cooked),
        ("BreadLoaf_1", StateFlag::Cut),
        ("Floppy_Virus_1", StateFlag::Broken),
    ] {
        let wish = format!("{thing} in {machine} +{flag:?}");
        assert!(!is(&press(&[&wish], machine, OK), thing, flag), "{thing}");
    }
    for (thing, was) in [
        ("Laser_Tip_Broken_1", "Laser_Tip_1"),
        ("Radio_01_Broken_1", "Radio_01_1"),
        ("Toast_02_1", "BreadSlice_01"),
        ("Carrot_01_1 yesterday Donut_01", "Donut_01"),
        ("Carrot_01_1 yesterday CoffeeMug_Yellow", "CoffeeMug_Yellow"),
    ] {
        let (instance, rest) = thing.split_once(' ').unwrap_or((thing, ""));
        let wish = format!("{instance} in {machine} {rest}");
        let player = press(&[wish.trim()], machine, OK);
        assert!(player.world.find(instance).is_none(), "{thing} is gone");
        let there = player.world.objects().find(|view| view.parent == Some(player.id(machine))).unwrap();
        assert!(there.instance.starts_with(was), "{thing} became {}", there.instance);
    }
    // A plain carrot was a carrot yesterday, too.
    assert!(press(&["Carrot_01_1 in YesterdayMachine_01_1"], machine, OK).world.find("Carrot_01_1").is_some());
}

#[test]
fn a_carrot_becomes_the_very_thing_that_it_was() {
    let wishes = ["EAC_Machine_1", "Bowl_01_1 in EAC_Machine_1 colored Red +Broken", "YesterdayMachine_01_1 +Opened"];
    let mut player = press(&wishes, "EAC_Machine_1", OK);
    let carrot = "EAC_Machine_1_Spawned_Carrot_01_1";
    assert!(player.world.find("Bowl_01_1").is_none());
    assert_eq!(inside(&player, carrot).as_deref(), Some("EAC_Machine_1"));
    player.must(&[
        "wait 120",
        &format!("pickup {carrot}"),
        "goto YesterdayMachine_01_1",
        "place YesterdayMachine_01_1",
        "close YesterdayMachine_01_1",
        "toggle YesterdayMachine_01_1",
        "wait 130",
    ]);
    assert!(player.world.find(carrot).is_none());
    assert_eq!(inside(&player, "Bowl_01_1").as_deref(), Some("YesterdayMachine_01_1"));
    assert_eq!(player.world.object(player.id("Bowl_01_1")).unwrap().color, Color::Red);
    assert!(is(&player, "Bowl_01_1", StateFlag::Broken), "yesterday it was broken already");
    player.must(&["toggle YesterdayMachine_01_1", "wait 20"]);
    assert!(!is(&player, "Bowl_01_1", StateFlag::Broken));
}

#[test]
fn all_that_goes_into_the_carrot_machine_is_one_carrot() {
    let wishes = ["FoodPlate_01_1 in EAC_Machine_1", "Apple_1 in FoodPlate_01_1"];
    let player = press(&wishes, "EAC_Machine_1", OK);
    let carrots = player.world.objects().filter(|view| view.parent == Some(player.id("EAC_Machine_1"))).count();
    assert_eq!(carrots, 1);
    assert!(player.world.find("Apple_1").is_none() && player.world.find("FoodPlate_01_1").is_none());
}

#[test]
fn the_printer_prints_what_its_cartridge_says() {
    for (cartridge, product) in [
        ("Printer_Cartridge_Figure_1", "ActionFigure"),
        ("Printer_Cartridge_Hammer_1", "Hammer"),
        ("Printer_Cartridge_Lever_1", "FuseBox_01_Lever"),
        ("Printer_Cartridge_Mug_1", "CoffeeMug_Yellow"),
        ("Printer_Cartridge_1", "CoffeeMug_Yellow"),
        ("Printer_Cartridge_1 prints Donut_01", "Donut_01"),
    ] {
        let (instance, rest) = cartridge.split_once(' ').unwrap_or((cartridge, ""));
        let wish = format!("{instance} in Printer_3D_1 {rest}");
        let mut player = press(&[wish.trim()], "Printer_3D_1", OK);
        let made = |number: u32| format!("Printer_3D_1_Spawned_{product}_{number}");
        assert_eq!(inside(&player, &made(1)).as_deref(), Some("Printer_3D_1"));
        assert_eq!(inside(&player, instance).as_deref(), Some("Printer_3D_1"), "the cartridge stays");
        // There is no room for a second one until the first is taken away.
        player.must(&["wait 120"]);
        assert_eq!(player.run("toggle Printer_3D_1").status, FULL);
        player.must(&[&format!("pickup {}", made(1)), "toggle Printer_3D_1", "wait 20"]);
        assert!(player.world.find(&made(2)).is_some());
    }
}

#[test]
fn the_embiggenator_makes_large_and_small() {
    let plate = "FoodPlate_01_1 in Embiggenator_10000";
    let wishes = [
        plate,
        "Apple_1 in TableRound_02_1 +Embiggenated",
        "TableRound_02_1 emptied",
        "Microwave_01_1 emptied +Opened",
    ];
    let monitor = "V_Monitor_Embiggenator_10000";
    let mut player = press(&wishes, monitor, OK);
    let scale = |player: &Player, instance: &str| player.world.object(player.id(instance)).unwrap().scale[0];
    assert!(is(&player, "FoodPlate_01_1", StateFlag::Embiggenated) && scale(&player, "FoodPlate_01_1") > 1.5);
    assert!(scale(&player, "Apple_1") > 1.5, "what starts embiggenated is large");
    // A large plate does not fit where a small one does.
    player.must(&["wait 120", "goto FoodPlate_01_1", "pickup FoodPlate_01_1", "goto Microwave_01_1"]);
    assert_eq!(player.run("place Microwave_01_1").status, NEVER);
    player.must(&[
        "goto Embiggenator_10000",
        "place Embiggenator_10000",
        &format!("goto {monitor}"),
        &format!("toggle {monitor}"),
    ]);
    player.must(&["wait 20"]);
    assert!(!is(&player, "FoodPlate_01_1", StateFlag::Embiggenated));
    assert!((scale(&player, "FoodPlate_01_1") - 1.0).abs() < 1e-5);
}

#[test]
fn the_colour_changer_paints() {
    for (button, color) in [("Red", Color::Red), ("Green", Color::Green), ("Blue", Color::Blue)] {
        let player = press(&["Bowl_01_1 in ColorChangerStation_1"], &format!("ColorChanger_Button_{button}_10000"), OK);
        assert_eq!(player.world.object(player.id("Bowl_01_1")).unwrap().color, color);
    }
}

#[test]
fn the_vending_machine_gives_what_is_in_the_slot() {
    let buttons = ["B4", "E5", "E7", "M8"].map(|name| format!("VendingMachine_01_{name}_Button_10000"));
    let goods = ["CandyBar_01_1", "CanSodaNew_01_1", "Apple_1", "Donut_01_1"];
    let lines: Vec<String> = goods.iter().map(|item| format!("{item} in VendingMachine_01")).collect();
    let wishes: Vec<&str> =
        ["VendingMachine_01 emptied +Opened"].into_iter().chain(lines.iter().map(String::as_str)).collect();
    let mut player = player(RoomId::BREAK_ROOM, &wishes);
    player.must(&["goto VendingMachine_01"]);
    let behind = player.run("pickup Apple_1");
    assert_eq!(behind.status, Status::TargetInaccessible, "{}", behind.detail);
    for (button, item) in buttons.iter().zip(goods).take(3) {
        player.must(&[&format!("goto {button}"), &format!("toggle {button}"), "wait 130"]);
        player.must(&[
            &format!("goto {item}"),
            &format!("pickup {item}"),
            "goto TableRound_02_1",
            "place TableRound_02_1",
        ]);
        player.must(&[&format!("goto {button}")]);
        assert_eq!(player.run(&format!("toggle {button}")).status, FAILS, "{item} is sold out");
    }
    // What is put in goes into the tray, and the flap must be open for that.
    player.must(&["goto Apple_1", "pickup Apple_1", "goto VendingMachine_01", "place VendingMachine_01"]);
    player.must(&["pickup Apple_1", "close VendingMachine_01"]);
    assert_eq!(player.run("place VendingMachine_01").status, CLOSED);
}

#[test]
fn the_gravity_pad_lifts_what_stands_in_its_field() {
    let mut player = player(RoomId::LAB2, &["Apple_1 in GravityPad_1"]);
    let height = |player: &Player| player.world.object(player.id("Apple_1")).unwrap().position_m.z;
    let low = height(&player);
    player.must(&["goto V_Monitor_Gravity_10000", "toggle V_Monitor_Gravity_10000", "wait 90"]);
    assert!(height(&player) > low + 0.3 && on(&player, "GravityPad_1"));
    player.must(&["toggle V_Monitor_Gravity_10000", "wait 90"]);
    assert!((height(&player) - low).abs() < 1e-3 && !on(&player, "GravityPad_1"));
}

#[test]
fn the_security_button_works_all_doors_of_the_reception() {
    let doors = |player: &Player| -> Vec<bool> {
        let layout = player.world.layout();
        let of_reception = layout.openings.iter().filter(|opening| opening.between.contains(&RoomId::RECEPTION));
        let doors: Vec<&str> = of_reception.filter_map(|opening| opening.door.as_deref()).collect();
        assert_eq!(doors.len(), 2);
        doors.into_iter().map(|door| is(player, door, StateFlag::Opened)).collect()
    };
    let mut player = player(RoomId::RECEPTION, &["Security_Button_10000"]);
    let before = doors(&player);
    player.must(&["goto Security_Button_10000", "toggle Security_Button_10000"]);
    let after = doors(&player);
    assert_eq!(after, before.iter().map(|open| !open).collect::<Vec<_>>());
    player.must(&["wait 130", "toggle Security_Button_10000"]);
    assert_eq!(doors(&player), before);
}

#[test]
fn a_lever_cuts_and_feeds_its_circuit_and_clears_what_is_wrong() {
    let wishes = ["FuseBox_01_1 +Opened", "Broken_Cord_01_1 +Toggled", "V_Monitor_Laser_10000 +Overloaded"];
    let mut player = player(RoomId::WAREHOUSE, &wishes);
    let circuit = |instance: &str, player: &Player| {
        let room = player.world.object(player.id(instance)).unwrap().room;
        player.world.layout().rooms.iter().find(|plan| plan.id == room).unwrap().circuit
    };
    let lab = circuit("V_Monitor_Laser_10000", &player);
    let boxes = ["FuseBox_01_1", "FuseBox_01_2", "FuseBox_02_1"];
    let fuse_box = boxes.into_iter().find(|instance| circuit(instance, &player) == lab).unwrap();
    let lever =
        player.world.objects().find(|view| view.parent == Some(player.id(fuse_box))).unwrap().instance.to_owned();
    assert!(is(&player, "Broken_Cord_01_1", StateFlag::Sparking));
    player.must(&[&format!("goto {fuse_box}")]);
    if !is(&player, fuse_box, StateFlag::Opened) {
        assert_eq!(player.run(&format!("toggle {lever}")).status, CLOSED);
        player.must(&[&format!("open {fuse_box}")]);
    }
    player.must(&[&format!("toggle {lever}")]);
    assert!(!is(&player, "Broken_Cord_01_1", StateFlag::Sparking));
    assert!(!is(&player, "V_Monitor_Laser_10000", StateFlag::Powered));
    assert!(is(&player, "V_Monitor_Laser_10000", StateFlag::Overloaded));
    assert!(!on(&player, fuse_box) && !player.world.room_lit(RoomId::LAB1));
    player.must(&[&format!("toggle {lever}")]);
    assert!(!is(&player, "Broken_Cord_01_1", StateFlag::Sparking), "it stays off until it is switched on");
    assert!(is(&player, "V_Monitor_Laser_10000", StateFlag::Powered));
    assert!(!is(&player, "V_Monitor_Laser_10000", StateFlag::Overloaded));
    assert!(on(&player, fuse_box) && player.world.room_lit(RoomId::LAB1));
}

#[test]
fn machines_stop_when_the_power_goes() {
    let mut player = player(
        RoomId::LAB1,
        &["RoboticArm_01_1 +Toggled", "FuseBox_01_1 +Opened", "FuseBox_01_2 +Opened", "FuseBox_02_1 +Opened"],
    );
    for lever in ["FuseBox_01_Lever_10000", "FuseBox_01_Lever_10001", "FuseBox_01_Lever_10002"] {
        player.must(&[&format!("goto {lever}"), &format!("toggle {lever}")]);
    }
    assert!(!on(&player, "RoboticArm_01_1"));
    assert!(RoomId::BUILTIN.iter().all(|room| !player.world.room_lit(*room)));
    let switches = player.world.objects().filter(|view| view.instance.starts_with("LightSwitch_01"));
    assert!(switches.into_iter().all(|view| view.flags.has(StateFlag::Toggled)), "switches stay as they are");
}

#[test]
fn every_device_of_the_catalogue_answers_a_press() {
    // Whatever can be toggled comes to a status that the reference gives for a press, and says something.
    let world = player(RoomId::BREAK_ROOM, &[]).world;
    let catalog = world.catalog().clone();
    let devices: Vec<String> = world
        .objects()
        .filter(|view| catalog.class(view.class).has(Property::Toggleable) && !view.hidden)
        .map(|view| view.instance.to_owned())
        .collect();
    assert!(devices.len() > 30, "{devices:?}");
    for device in devices {
        let mut player = player(RoomId::BREAK_ROOM, &[]);
        player.must(&[&format!("goto {device}")]);
        let outcome = player.run(&format!("toggle {device}"));
        let known = [OK, FAILS, NEVER, FULL, CLOSED, Status::TargetInaccessible];
        assert!(known.contains(&outcome.status) && !outcome.detail.is_empty(), "{device}: {outcome:?}");
        assert_eq!(flags(&player, &device).has(StateFlag::Used), outcome.status.is_success(), "{device}");
    }
}
