//! What must hold of every world at every tick, judged from outside.

use std::collections::BTreeSet;

use cohabit_cdf::{Property, StateFlag, catalog::Stands};
use cohabit_world::{ObjectId, ObjectView, Vec2, Vec3, World};

use super::walls::Walls;

/// How far bodies may press into each other or into a wall, m.
const PRESS_M: f32 = 0.03;
/// How far things on the outer walls may stick out of the plan, m.
const OUTSIDE_M: f32 = 0.3;

/// Everything about bodies: cheap, for every tick.
pub fn check_bodies(world: &World, walls: &Walls) -> Result<(), String> {
    let bodies: Vec<_> = world.bodies().collect();
    for body in &bodies {
        let here = body.position_m.truncate();
        let numbers = [here.x, here.y, body.yaw_rad, body.head_pitch_rad, body.speed_m_s];
        if !numbers.iter().all(|number| number.is_finite()) || !(0.0..=1.0).contains(&body.arm) {
            return Err(format!("body {} is nowhere: {body:?}", body.id.0));
        }
        if world.layout().room_at(here.x, here.y).is_none() {
            return Err(format!("body {} left the building: {here}", body.id.0));
        }
        let distance = walls.distance(here);
        if distance < body.radius_m - PRESS_M {
            return Err(format!("body {} is in a wall: {distance} m from its middle at {here}", body.id.0));
        }
        for other in &bodies[..body.id.0 as usize] {
            let distance = other.position_m.truncate().distance(here);
            if distance < body.radius_m + other.radius_m - PRESS_M {
                return Err(format!("bodies {} and {} are in each other: {distance} m", other.id.0, body.id.0));
            }
        }
        if let Some(held) = body.held
            && world.object(held).is_none_or(|view| view.held_by != Some(body.id))
        {
            return Err(format!("body {} holds {held:?}, which is not held by it", body.id.0));
        }
    }
    Ok(())
}

/// Everything about objects.
pub fn check_objects(world: &World) -> Result<(), String> {
    let mut places: Vec<(ObjectId, Vec3)> = Vec::new();
    for view in world.objects() {
        let fault = |what: String| Err(format!("{}: {what}", view.instance));
        if !world.exists(view.id) {
            if !view.hidden || view.parent.is_some() || view.held_by.is_some() {
                return fault("it is gone, but somewhere".to_owned());
            }
            continue;
        }
        check_place(world, &view).or_else(fault)?;
        check_holder(world, &view).or_else(fault)?;
        if let Some(parent) = view.parent {
            places.push((parent, view.position_m));
        }
    }
    for (index, (parent, at)) in places.iter().enumerate() {
        if places[..index].iter().any(|(other, there)| other == parent && there.distance(*at) < 1e-3) {
            let parent = world.object(*parent).map_or("?", |view| view.instance);
            return Err(format!("{parent}: two things are at one place of it: {at}"));
        }
    }
    let names: BTreeSet<&str> = world.objects().map(|view| view.instance).collect();
    if names.len() != world.objects().len() {
        return Err("two objects share an id".to_owned());
    }
    Ok(())
}

fn check_place(world: &World, view: &ObjectView<'_>) -> Result<(), String> {
    let at = view.position_m;
    if !at.is_finite() || !view.rotation.is_finite() || !view.scale.iter().all(|scale| *scale > 0.0) {
        return Err(format!("it is nowhere: {at} {} {:?}", view.rotation, view.scale));
    }
    if (view.rotation.length() - 1.0).abs() > 1e-3 {
        return Err(format!("its rotation is none: {}", view.rotation));
    }
    let [west, south, east, north] = world.layout().bounds_m();
    let inside = (west - OUTSIDE_M..=east + OUTSIDE_M).contains(&at.x)
        && (south - OUTSIDE_M..=north + OUTSIDE_M).contains(&at.y)
        && (-0.05..=world.layout().wall_height_m + 0.05).contains(&at.z);
    if !inside {
        return Err(format!("it left the building: {at}"));
    }
    if !(0.0..=1.0).contains(&view.opened) || !(0.0..=1.0).contains(&view.running) {
        return Err(format!("it is open or running beyond all measure: {} {}", view.opened, view.running));
    }
    Ok(())
}

fn check_holder(world: &World, view: &ObjectView<'_>) -> Result<(), String> {
    if view.flags.has(StateFlag::PickedUp) != view.held_by.is_some() {
        return Err(format!("picked up or not? it is held by {:?}", view.held_by));
    }
    if let Some(body) = view.held_by
        && world.body(body).is_none_or(|body| body.held != Some(view.id))
    {
        return Err(format!("it is held by {body:?}, who does not hold it"));
    }
    let Some(parent) = view.parent else { return Ok(()) };
    if view.held_by.is_some() {
        return Err("it is in two places: held, and on something".to_owned());
    }
    if !world.exists(parent) {
        return Err("it is in something that is gone".to_owned());
    }
    let above = |id: &ObjectId| world.object(*id).and_then(|view| view.parent);
    if std::iter::successors(Some(parent), above).take(world.objects().len()).any(|id| id == view.id) {
        return Err("it is in itself".to_owned());
    }
    let Some(holder) = world.object(parent) else { return Ok(()) };
    let (class, own) = (world.catalog().class(holder.class), world.catalog().class(view.class));
    let Some(receptacle) = &class.receptacle else { return Ok(()) };
    let keys = &receptacle.keys;
    // A printer is keyed to its cartridges, and holds what it printed.
    if !keys.is_empty() && !keys.contains(&own.id) && !view.instance.contains("_Spawned_") {
        return Err(format!("{} is not for it", holder.instance));
    }
    let shut = receptacle.enclosed
        && class.has(Property::Openable)
        && !holder.flags.has(StateFlag::Opened)
        && holder.opened <= 0.0;
    // What stands on the top of a cupboard is not in it.
    let top = holder.position_m.z + class.size_m[2] * holder.scale[2] - 0.03;
    if shut && view.position_m.z < top && !view.hidden {
        return Err(format!("{} is shut around it, but it can be seen", holder.instance));
    }
    Ok(())
}

/// Whether anybody stands in something that stands on the floor.
pub fn check_standing(world: &World) -> Result<(), String> {
    for view in world.objects().filter(|view| world.exists(view.id) && view.parent.is_none() && view.held_by.is_none())
    {
        let class = world.catalog().class(view.class);
        let [x, y, z] = std::array::from_fn(|axis| class.size_m[axis] * view.scale[axis]);
        let low = class.stands == Stands::OnFloor && view.position_m.z < 0.5 && z > 0.15;
        if !low || class.has(Property::Pickupable) || class.id.starts_with("Door_") {
            continue;
        }
        for body in world.bodies() {
            let local = view.rotation.inverse() * (body.position_m - view.position_m);
            let inside = Vec2::new(x, y) / 2.0 - local.truncate().abs();
            if inside.min_element() > 0.0 {
                return Err(format!("body {} stands in {}: {}", body.id.0, view.instance, body.position_m));
            }
        }
    }
    Ok(())
}
