//! How two states of one mission differ, in words.

use crate::{body::Body, entity::Object, state::State};

/// What differs, objects first.
pub(crate) fn between(one: &State, other: &State) -> Vec<String> {
    let mut found = Vec::new();
    if one.objects.len() != other.objects.len() {
        found.push(format!("there are {} objects, or {}", one.objects.len(), other.objects.len()));
    }
    for (object, counterpart) in one.objects.iter().zip(&other.objects).filter(|(object, other)| object != other) {
        found.push(format!("{}: {}", object.instance, of_object(object, counterpart)));
    }
    for (number, (body, counterpart)) in one.bodies.iter().zip(&other.bodies).enumerate() {
        if body != counterpart {
            found.push(format!("body {number}: {}", of_body(body, counterpart)));
        }
    }
    let mission = [
        ("the circuits", one.circuits != other.circuits),
        ("the goals", one.goals != other.goals || one.occasions != other.occasions),
        ("the portals", one.portals != other.portals || one.passes != other.passes),
        ("the dinosaurs", one.dinosaurs != other.dinosaurs),
        ("what is away", one.away != other.away),
        ("how it ended", one.ended != other.ended),
        ("what blocks the way", one.floor_version != other.floor_version),
        ("what flies", !one.physics.moving().eq(other.physics.moving())),
    ];
    found.extend(differing(&mission).map(str::to_owned));
    found
}

fn of_object(one: &Object, other: &Object) -> String {
    listed(&[
        ("class", one.class != other.class),
        ("room", one.room != other.room),
        ("what holds it", one.support != other.support),
        ("place", one.pose != other.pose),
        ("states", one.flags != other.flags || one.fluid != other.fluid || one.color != other.color),
        ("how far it is open", one.opened != other.opened),
        ("what it does", one.running != other.running || one.run != other.run),
    ])
}

fn of_body(one: &Body, other: &Body) -> String {
    listed(&[
        ("place", one.position != other.position || one.room != other.room),
        ("heading", one.yaw_rad != other.yaw_rad || one.head_pitch_rad != other.head_pitch_rad),
        ("pace", one.speed_m_s != other.speed_m_s || one.turn_rad_s != other.turn_rad_s),
        ("hand", one.held != other.held || one.arm != other.arm),
        ("states", one.flags != other.flags || one.alive != other.alive),
        ("what it is doing", one.task != other.task),
    ])
}

fn differing<'a>(parts: &'a [(&'a str, bool)]) -> impl Iterator<Item = &'a str> {
    parts.iter().filter(|(_, differs)| *differs).map(|(part, _)| *part)
}

fn listed(parts: &[(&str, bool)]) -> String {
    let names: Vec<_> = differing(parts).collect();
    if names.is_empty() { "something else of it".to_owned() } else { names.join(", ") }
}
