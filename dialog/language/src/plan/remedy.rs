//! What may help after a step failed: one table for what the robot offers and for what `yes` then does.

use cohabit_cdf::{Action, ObjectId, Status, Verb};

use crate::{
    known::{KnownObject, describe, imagine},
    plan::Planner,
    understanding::Step,
};

/// An offer: the question, and the steps to take before trying again.
pub(crate) struct Remedy {
    pub(crate) question: String,
    pub(crate) steps: Vec<Step>,
}

/// The remedy for a failed step, if there is one.
pub(crate) fn remedy(mut planner: Planner<'_>, step: &Step, status: Status) -> Option<Remedy> {
    let question = match status {
        Status::ReceptacleIsClosed => {
            let closed = closed_place(&planner, &step.action)?;
            planner.interact(Verb::Open, closed, "opening");
            "Shall I open it?".to_owned()
        }
        Status::AlreadyHoldingObject => {
            let held = planner.scene.robot.held?;
            let wanted = imagine::object_of(&step.action);
            planner.put_down(wanted).ok()?;
            format!("Shall I put {} down first?", planner.the(held))
        }
        Status::ObjectUnpowered | Status::ObjectOverloaded => {
            let lever = power_lever(&planner, imagine::object_of(&step.action)?)?;
            let question = format!("Shall I try {}?", describe::full(planner.catalog, &planner.scene, lever));
            planner.interact(Verb::Toggle, lever, "switching");
            question
        }
        Status::TargetOutOfRange => {
            planner.go_to_object(imagine::object_of(&step.action)?);
            "Shall I go closer and try again?".to_owned()
        }
        _ => return None,
    };
    Some(Remedy { question, steps: planner.steps })
}

fn closed_place(planner: &Planner<'_>, action: &Action) -> Option<ObjectId> {
    let object = imagine::object_of(action)?;
    let is_place = matches!(action, Action::Place { .. });
    planner
        .around(object)
        .into_iter()
        .find(|id| planner.is_shut(*id))
        .or_else(|| (is_place && planner.is_shut(object)).then_some(object))
}

/// The nearest lever that feeds a circuit, in the machine's room.
fn power_lever(planner: &Planner<'_>, machine: ObjectId) -> Option<ObjectId> {
    let room = planner.scene.object(machine)?.room;
    let is_fixed = |object: &&KnownObject| {
        planner.devices.levers.contains(&object.class)
            && object.parent.is_some()
            && planner.scene.robot.held != Some(object.id)
    };
    let known = planner.scene.objects.iter().filter(is_fixed);
    known.min_by_key(|object| (object.room != room, object.id)).map(|object| object.id)
}
