//! Missions written in short lines, and tables that check what one command comes to.

#![allow(clippy::unwrap_used, dead_code)]

use std::sync::Arc;

use cohabit_cdf::{Catalog, Color, Fluid, Mission, ObjectRequest, RoomId, StateFlag, StateFlags, mission::DinoFood};
use cohabit_world::Status;

use crate::support::{Player, build, plain_mission};

pub const OK: Status = Status::ActionSuccessful;

/// `Instance`, or `Instance in Receptacle`, or `Instance at Room`; then words, and `+flag` and `-flag`.
pub fn request(line: &str) -> ObjectRequest {
    let mut words = line.split(' ');
    let mut request = ObjectRequest { instance: words.next().unwrap().to_owned(), ..ObjectRequest::default() };
    while let Some(word) = words.next() {
        let mut next = || words.next().unwrap().to_owned();
        match word {
            "in" => request.inside = Some(next()),
            "at" => request.room = RoomId::new(&next()),
            "yesterday" => request.yesterday = Some(next()),
            "prints" => request.prints = Some(next()),
            "filled" => request.fluid = Fluid::from_name(&next()),
            "colored" => request.color = Color::from_name(&next()),
            "circuit" => request.circuit = next().parse().ok(),
            "feeds" => request.generates_circuit = next().parse().ok(),
            "power" => request.generates_power = next().parse().ok(),
            "portal" => request.current_portal = Some(next()),
            "past" => request.past_portals.push(next()),
            "future" => request.future_portals.push(next()),
            "eats" => request.dino_food = Some(DinoFood::Class(next())),
            "unique" => request.unique = true,
            "emptied" => request.remove_initial_contents = true,
            "empty" => request.empty = true,
            "blacklisted" => request.blacklisted = true,
            "removed" => request.removed = true,
            flag => {
                let value = flag.starts_with('+');
                let found = StateFlag::ALL.into_iter().find(|known| format!("{known:?}") == flag[1..]);
                request.flags.push((found.unwrap_or_else(|| panic!("what is `{flag}`?")), value));
            }
        }
    }
    request
}

/// A mission in the first floor plan.
pub fn mission(room: RoomId, wishes: &[&str]) -> Mission {
    Mission { objects: wishes.iter().map(|line| request(line)).collect(), ..plain_mission(room) }
}

pub fn player(room: RoomId, wishes: &[&str]) -> Player {
    play(mission(room, wishes))
}

pub fn play(mission: Mission) -> Player {
    Player::new(build(&Arc::new(Catalog::builtin()), mission, 5))
}

/// Runs `lines`, of which the last must come to `expected`; all before must succeed.
pub fn check(wishes: &[&str], lines: &[&str], expected: Status) -> Player {
    let mut player = player(RoomId::BREAK_ROOM, wishes);
    let (last, before) = lines.split_last().unwrap();
    player.must(before);
    let outcome = player.run(last);
    assert_eq!(outcome.status, expected, "{wishes:?} {lines:?}: {}", outcome.detail);
    assert!(outcome.command == 0 || !outcome.detail.is_empty());
    player
}

/// Goes to `device`, presses it, and waits until it has done its work; the press must come to `expected`.
pub fn press(wishes: &[&str], device: &str, expected: Status) -> Player {
    let lines = [format!("goto {device}"), format!("toggle {device}")];
    let mut player = check(wishes, &lines.each_ref().map(String::as_str), expected);
    player.run("wait 20");
    player
}

pub fn flags(player: &Player, instance: &str) -> StateFlags {
    player.world.object(player.id(instance)).unwrap().flags
}

pub fn is(player: &Player, instance: &str, flag: StateFlag) -> bool {
    flags(player, instance).has(flag)
}

pub fn fluid(player: &Player, instance: &str) -> Fluid {
    player.world.object(player.id(instance)).unwrap().fluid
}

/// The instance of what something is in or on.
pub fn inside(player: &Player, instance: &str) -> Option<String> {
    let parent = player.world.object(player.id(instance)).unwrap().parent?;
    Some(player.world.object(parent).unwrap().instance.to_owned())
}
