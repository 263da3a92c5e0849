//! Simulated pedestrians of a session: their schedule, and the floor that they walk on.

use std::{
    fs,
    path::Path,
    sync::{Arc, atomic::AtomicBool},
};

use cohabit_agent::{Crowd, Floor, Schedule, wait_for_mission};
use cohabit_bus::Transport;
use cohabit_cdf::{BodyKind, Catalog, Layout};
use cohabit_engine::SessionPlan;
use cohabit_world::{Vec2, World};

use crate::failure::bad_input;

/// The schedule in a file, for a world with this catalogue.
pub fn read_schedule(file: Option<&Path>, catalog: &Catalog) -> anyhow::Result<Schedule> {
    let file = file.ok_or_else(|| bad_input("pedestrians need a schedule: `--script FILE`, or in play `=FILE`"))?;
    let name = file.display();
    let text = fs::read_to_string(file).map_err(|error| bad_input(format!("{name}: {error}")))?;
    Schedule::parse(&name.to_string(), &text, catalog).map_err(bad_input)
}

/// Says what is wrong with a schedule in a session of bodies of these kinds on that floor plan; nothing, if all is right.
pub fn fault(schedule: &Schedule, kinds: &[BodyKind], layout: &Layout) -> Option<String> {
    let remedy = "`--body person` adds a person, and bodies count from 0";
    if let Some(absent) = schedule.bodies().into_iter().find(|body| *body as usize >= kinds.len()) {
        let last = kinds.len().saturating_sub(1);
        return Some(format!("there is no body {absent}: the session has bodies 0 to {last}; {remedy}"));
    }
    let robot = schedule.people().find(|body| kinds[*body as usize] != BodyKind::Person);
    let robot = robot.map(|robot| format!("body {robot} is a robot, and a schedule is for people; {remedy}"));
    robot.or_else(|| schedule.misplaced(layout))
}

/// The pedestrians of a schedule, for the session on `bus`; `None` if `stop` comes before its mission is known.
pub fn crowd(
    catalog: &Arc<Catalog>,
    file: Option<&Path>,
    seed: u64,
    bus: &dyn Transport,
    stop: &AtomicBool,
) -> anyhow::Result<Option<Crowd>> {
    let schedule = read_schedule(file, catalog)?;
    let Some(mission) = wait_for_mission(bus, stop)? else { return Ok(None) };
    let plan = SessionPlan::new(mission.header.file.as_str(), &mission.text, Arc::clone(catalog), mission.header.seed)?;
    let world = plan.with_bodies(mission.bodies).build()?;
    let kinds: Vec<BodyKind> = world.bodies().map(|body| body.kind).collect();
    match fault(&schedule, &kinds, world.layout()) {
        Some(fault) => Err(bad_input(format!("{}: {fault}", file.unwrap_or(Path::new("the schedule")).display()))),
        None => Ok(Some(Crowd::new(&schedule, floor(world), seed))),
    }
}

/// The floor of a world as it is now.
fn floor(world: World) -> Floor {
    let layout = world.layout();
    let viewpoints = layout.viewpoints.iter().map(|own| (own.room, own.number, Vec2::from(own.at_m))).collect();
    let doors = layout.openings.iter().filter_map(|own| Some((own.door.clone()?, Vec2::from(own.at_m)))).collect();
    Floor {
        obstacles: world.obstacles(),
        viewpoints,
        doors,
        path: Box::new(move |from: Vec2, to: Vec2| world.path(from, to).map(|(way, _)| way)),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn bodies_of_a_schedule_are_people_of_the_session() {
        let catalog = Catalog::builtin();
        let layout = Layout::builtin("OfficeLayout1").unwrap();
        let check =
            |text: &str, kinds: &[BodyKind]| fault(&Schedule::parse("a.toml", text, &catalog).unwrap(), kinds, &layout);
        let text = "[[entry]]\nperson = 1\nmeet = 2";
        let (robot, person) = (BodyKind::Robot, BodyKind::Person);
        assert_eq!(check(text, &[robot, person, robot]), None);
        let absent = check(text, &[robot, person]).unwrap();
        assert!(absent.contains("no body 2") && absent.contains("bodies 0 to 1"), "{absent}");
        let wrong = check(text, &[robot, robot, person]).unwrap();
        assert!(wrong.contains("body 1 is a robot") && wrong.contains("--body person"), "{wrong}");
    }

    #[test]
    fn places_of_a_schedule_are_those_of_the_floor_plan() {
        let catalog = Catalog::builtin();
        let mut layout = Layout::builtin("OfficeLayout1").unwrap();
        layout.rooms.retain(|room| room.id.id() != "BreakRoom");
        let check = |place: &str| {
            let text = format!("[[entry]]\nperson = 1\nstay_s = 1\n[[entry]]\nperson = 1\ngo_to = \"{place}\"");
            let schedule = Schedule::parse("a.toml", &text, &catalog).unwrap();
            fault(&schedule, &[BodyKind::Robot, BodyKind::Person], &layout)
        };
        for there in ["Lab1", "Lab1_3", "4.0 15.5"] {
            assert_eq!(check(there), None, "{there}");
        }
        for (absent, part) in [
            ("BreakRoom", "entry 2: the floor plan OfficeLayout1 has no room BreakRoom: write one of its own ("),
            ("BreakRoom_3", "has no room BreakRoom"),
            ("4.0 100.5", "entry 2: 4 100.5 is outside of the floor plan OfficeLayout1"),
        ] {
            let fault = check(absent).unwrap();
            assert!(fault.contains(part), "{fault}");
        }
    }
}
