//! What may help after a step failed: one table for what the robot offers and for what `yes` then does.

use cohabit_cdf::{
    Action, ActionKind, ClassId, Fluid, ObjectId, Property, StateFlag, Status, Verb,
    table::{ClassPattern, Condition, Term, Test},
};

use crate::{
    known::{KnownObject, describe, imagine, symbols},
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
        Status::ActionExecutionError | Status::ObjectNotPickedUp => return by_table(&planner, step, status),
        _ => return None,
    };
    Some(Remedy { question, steps: planner.steps })
}

/// The remedy for what the step lacks by the table of actions: of what may hold for it, the first that the robot can bring about.
fn by_table(planner: &Planner<'_>, step: &Step, status: Status) -> Option<Remedy> {
    let (kind, it) = ActionKind::of(&step.action)?;
    let devices = planner.devices;
    let need = symbols::lack(&planner.scene, kind, it, &devices.catalog).filter(|need| need.status == status)?;
    need.any.iter().find_map(|condition| brought_about(planner, condition, kind, it))
}

/// What brings it about that a condition of an action holds.
fn brought_about(planner: &Planner<'_>, condition: &Condition, kind: ActionKind, it: ObjectId) -> Option<Remedy> {
    let Planner { catalog, devices, habits, judge, .. } = *planner;
    let mut planner = Planner::new(catalog, devices, habits, judge, &planner.scene, planner.focus.clone());
    let of = match condition.term {
        Term::It => Some(it),
        Term::Held => planner.scene.robot.held,
        Term::Machine => planner.scene.object(it)?.works,
        Term::Holder | Term::Basin | Term::Thing => None,
    };
    let is_switched = kind == ActionKind::Toggle;
    let first = match (&condition.test, condition.negated) {
        (Test::Filled, false) if is_switched => {
            let vessel = vessel_of(&planner, of?)?;
            planner.fill_first(vessel).ok()?;
            format!("fill {}", planner.the(vessel))
        }
        (Test::Filled, true) => {
            planner.empty(of?).ok()?;
            format!("empty {}", planner.the(of?))
        }
        (Test::Is(StateFlag::Opened), true) if is_switched => {
            planner.interact(Verb::Close, of?, "closing");
            "close it".to_owned()
        }
        (Test::Is(StateFlag::Toggled), false) if !is_switched => {
            planner.interact(Verb::Toggle, of?, "turning on");
            format!("turn on {}", planner.the(of?))
        }
        (Test::HoldsA(pattern), false) => {
            let part = nearest_of(&planner, pattern)?;
            planner.hold(part).ok()?;
            planner.place_on(of?);
            format!("put {} in", planner.the(part))
        }
        (Test::IsA(pattern), false) if condition.term == Term::Held => {
            let tool = nearest_of(&planner, pattern)?;
            planner.hold(tool).ok()?;
            format!("take {}", planner.the(tool))
        }
        _ => return None,
    };
    Some(Remedy { question: format!("Shall I {first} first?"), steps: planner.steps })
}

/// What is to be filled for a machine: itself, if it can be carried to where there is water, or else what stands in it.
fn vessel_of(planner: &Planner<'_>, machine: ObjectId) -> Option<ObjectId> {
    let is_empty_vessel = |object: &&KnownObject| {
        let is_vessel = [Property::Pickupable, Property::Fillable].iter().all(|needed| planner.has(object.id, *needed));
        is_vessel && object.fluid == Fluid::None
    };
    let own = planner.scene.object(machine).filter(is_empty_vessel);
    own.or_else(|| planner.scene.contents(machine).find(is_empty_vessel)).map(|object| object.id)
}

/// The nearest thing of the classes that a condition names.
fn nearest_of(planner: &Planner<'_>, pattern: &ClassPattern) -> Option<ObjectId> {
    let classes: Vec<ClassId> = pattern.0.iter().filter_map(|id| planner.catalog.find(id)).collect();
    planner.nearest(&classes)
}

fn closed_place(planner: &Planner<'_>, action: &Action) -> Option<ObjectId> {
    let object = imagine::object_of(action)?;
    let is_place = action.receptacle().is_some();
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
