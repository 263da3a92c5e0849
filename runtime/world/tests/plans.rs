//! Every floor plan can be walked and worked in.

#![allow(clippy::unwrap_used)]

mod support;

use std::sync::Arc;

use cohabit_cdf::{Catalog, Layout, Mission, Property, RoomId};
use cohabit_world::{Action, GoToTarget};
use support::{Player, build, plain_mission};

#[test]
fn every_viewpoint_can_be_reached_in_every_plan() {
    let catalog = Arc::new(Catalog::builtin());
    for layout in Layout::builtin_ids() {
        let mission = Mission { layout: layout.clone(), ..plain_mission(RoomId::Reception) };
        let mut player = Player::new(build(&catalog, mission, 1));
        let viewpoints = Layout::builtin(&layout).unwrap().viewpoints;
        for viewpoint in viewpoints.iter().step_by(4) {
            let target = GoToTarget::Viewpoint(viewpoint.room, viewpoint.number);
            let outcome = player.play(Action::GoTo { target });
            assert!(outcome.status.is_success(), "{layout}: {target:?}: {}", outcome.detail);
        }
        let area = player.world.navigable_area_m2();
        assert!(area > 150.0, "{layout}: {area} m2");
        println!("{layout}: {area:.0} m2, {} objects", player.world.objects().len());
    }
}

#[test]
fn everything_that_works_can_be_walked_up_to() {
    let catalog = Arc::new(Catalog::builtin());
    let mut lost = Vec::new();
    for layout in Layout::builtin_ids() {
        let mission = Mission { layout: layout.clone(), ..plain_mission(RoomId::Reception) };
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
