//! Every floor plan can be walked and worked in.

#![allow(clippy::unwrap_used)]

mod support;

use std::sync::Arc;

use cohabit_cdf::{Catalog, Layout, Mission, Property, RoomId};
use cohabit_world::{Action, GoToTarget, ObjectId, Status};
use support::{Player, build, plain_mission};

/// Walkable floor that a plan has at least, and that all have on average, m².
const AREA_M2: (f64, f64) = (170.0, 190.0);

/// The machines of the labs, the kitchen and the offices, by class; the first of each class is walked to.
const MACHINES: [&str; 26] = [
    "CoffeeMaker_01",
    "CoffeeUnMaker_01",
    "ColorChangerStation",
    "EAC_Machine",
    "Embiggenator",
    "ForkLift",
    "FreezeRay",
    "FridgeLower_02",
    "FuseBox_01",
    "FuseBox_02",
    "GravityPad",
    "KitchenCounterSink_01",
    "Laser",
    "Microwave_01",
    "PortalGenerator",
    "Printer_3D",
    "RoboticArm_01",
    "Security_Button",
    "TAMPrototypeHead_01",
    "Toaster_02",
    "V_Monitor_Embiggenator",
    "V_Monitor_FreezeRay",
    "V_Monitor_Laser",
    "V_Monitor_Portal",
    "VendingMachine_01",
    "YesterdayMachine_01",
];

#[test]
fn every_viewpoint_can_be_reached_in_every_plan() {
    let catalog = Arc::new(Catalog::builtin());
    let (mut areas, mut missed) = (Vec::new(), Vec::new());
    for layout in Layout::builtin_ids() {
        let mission = Mission { layout: layout.clone(), ..plain_mission(RoomId::RECEPTION) };
        let mut player = Player::new(build(&catalog, mission, 1));
        for viewpoint in &Layout::builtin(&layout).unwrap().viewpoints {
            let target = GoToTarget::Viewpoint(viewpoint.room, viewpoint.number);
            let outcome = player.play(Action::GoTo { target });
            // On the mesh itself, not only near it.
            if outcome.status != Status::ActionSuccessful {
                missed.push(format!("{layout}: {target:?}: {}", outcome.detail));
            }
        }
        let area_m2 = player.world.navigable_area_m2();
        println!("{layout}: {area_m2:.0} m2, {} objects", player.world.objects().len());
        areas.push((layout, area_m2));
    }
    assert!(missed.is_empty(), "{missed:#?}");
    let (least_m2, average_m2) = AREA_M2;
    for (layout, area_m2) in &areas {
        assert!(*area_m2 >= least_m2, "{layout}: {area_m2} m2");
    }
    let average = areas.iter().map(|(_, area_m2)| area_m2).sum::<f64>() / areas.len() as f64;
    assert!(average >= average_m2, "{average} m2 on average");
}

#[test]
fn every_machine_can_be_reached_from_every_room() {
    reach_machines(|layout| !layout.ends_with("_mirror"));
}

#[test]
fn every_machine_can_be_reached_from_every_room_of_the_mirrored_plans() {
    reach_machines(|layout| layout.ends_with("_mirror"));
}

fn reach_machines(is_meant: impl Fn(&str) -> bool) {
    let catalog = Arc::new(Catalog::builtin());
    let mut lost = Vec::new();
    for layout in Layout::builtin_ids().into_iter().filter(|layout| is_meant(layout)) {
        let mission = Mission { layout: layout.clone(), ..plain_mission(RoomId::RECEPTION) };
        let mut player = Player::new(build(&catalog, mission, 1));
        let machine = |class: &&str| {
            let class = catalog.find(class).unwrap();
            let found = player.world.objects().find(|view| view.class == class);
            found.map_or_else(|| panic!("{layout} has no {class:?}"), |view| (view.id, view.instance.to_owned()))
        };
        let machines: Vec<(ObjectId, String)> = MACHINES.iter().map(machine).collect();
        for room in RoomId::BUILTIN {
            let outcome = player.play(Action::GoTo { target: GoToTarget::Room(room) });
            assert!(outcome.status.is_success(), "{layout}: {room:?}: {}", outcome.detail);
            let in_the_room = player.world.snapshot();
            for (machine, instance) in &machines {
                let outcome = player.play(Action::GoTo { target: GoToTarget::Object(*machine) });
                if !outcome.status.is_success() {
                    lost.push(format!("{layout}: {instance} from {room:?}: {}", outcome.detail));
                }
                player.world.restore(&in_the_room).unwrap();
            }
        }
    }
    assert!(lost.is_empty(), "{lost:#?}");
}

#[test]
fn everything_that_works_can_be_walked_up_to() {
    let catalog = Arc::new(Catalog::builtin());
    let mut lost = Vec::new();
    for layout in Layout::builtin_ids() {
        let mission = Mission { layout: layout.clone(), ..plain_mission(RoomId::RECEPTION) };
        let mut player = Player::new(build(&catalog, mission, 1));
        let operable = [Property::Openable, Property::Toggleable, Property::Pickupable, Property::Receptacle];
        let things: Vec<_> = player
            .world
            .objects()
            .filter(|view| operable.iter().any(|property| catalog.class(view.class).has(*property)))
            .map(|view| (view.id, view.instance.to_owned()))
            .collect();
        for (object, instance) in things {
            let outcome = player.play(Action::GoTo { target: GoToTarget::Object(object) });
            if !outcome.status.is_success() {
                lost.push(format!("{layout}: {instance}: {}", outcome.detail));
            }
        }
    }
    assert!(lost.is_empty(), "{lost:#?}");
}
