//! What the robot says when a plan has finished or a step has failed.

use cohabit_cdf::{Action, Catalog, GoToTarget, ObjectId, Status, Verb, state::StateFlag};

use crate::{
    known::{Known, contents, describe, process::Devices},
    understanding::Step,
    words::prose,
};

/// How a step that looks under a thing or behind it is called.
pub(crate) const LOOKS_UNDER: &str = "looking under";

/// What is said after success: what is so now.
pub(crate) fn success(catalog: &Catalog, devices: &Devices, scene: &Known, step: &Step, status: Status) -> String {
    let the = |id: ObjectId| describe::short(catalog, scene, id);
    if status == Status::AlternateNavigationUsed && step.action.receptacle().is_none() {
        return "I got as close as I could.".to_owned();
    }
    let text = match step.action {
        Action::PickUp { object } => format!("I have {}{}", the(object), warmth(scene, object, &the(object))),
        Action::Place { receptacle } => match scene.contents(receptacle).last() {
            Some(_) => {
                let what = step.says.strip_prefix("putting ").unwrap_or_default();
                let place = format!("{} {}", describe::preposition(catalog, scene, receptacle), the(receptacle));
                format!("done, {} {} {place} now", prose::they(what), prose::is(what))
            }
            None => "done".to_owned(),
        },
        Action::PlaceBeside { receptacle, beside } if status == Status::AlternateNavigationUsed => {
            let preposition = describe::preposition(catalog, scene, receptacle);
            format!("there was no room next to {}, so it is {preposition} {} now", the(beside), the(receptacle))
        }
        Action::PlaceBeside { beside, .. } => format!("done, it is next to {} now", the(beside)),
        Action::GoTo { target: GoToTarget::Room(room) } => format!("I am in the {}", room.name_in(catalog)),
        Action::GoTo { target: GoToTarget::Point(_) } => match step.says.strip_prefix("bringing you ") {
            Some(what) => format!("here is {what}"),
            None if matches!(step.says.as_str(), "coming to you" | "following you") => "here I am".to_owned(),
            None => "I am back".to_owned(),
        },
        Action::GoTo { target: GoToTarget::Object(object) } => format!("I am at {}", the(object)),
        Action::GoTo { .. } => "I am there".to_owned(),
        Action::Interact { verb, object } => interaction(&the(object), catalog, devices, scene, step, verb, object),
        Action::Highlight { object } => format!("this is {}", describe::full(catalog, scene, object)),
        Action::LookAround => "I have looked around".to_owned(),
        Action::Stop => "I have stopped".to_owned(),
        Action::Drive { .. } => "done".to_owned(),
        Action::Move { .. } | Action::Rotate { .. } | Action::Look { .. } if step.says.is_empty() => "done".to_owned(),
        Action::Move { .. } | Action::Rotate { .. } | Action::Look { .. } => format!("I am done {}", step.says),
    };
    prose::sentence(&text)
}

/// What nobody sees of a thing in the hand: that it is hot or cold.
fn warmth(scene: &Known, id: ObjectId, name: &str) -> String {
    let state = match scene.object(id) {
        Some(object) if object.has(StateFlag::Hot) => "hot",
        Some(object) if object.has(StateFlag::Cold) => "cold",
        _ => return String::new(),
    };
    format!(", and {} {} {state}", prose::they(name), prose::is(name))
}

fn interaction(
    the: &str,
    catalog: &Catalog,
    devices: &Devices,
    scene: &Known,
    step: &Step,
    verb: Verb,
    object: ObjectId,
) -> String {
    if let Some(by_hand) = step.by_hand() {
        let done = by_hand.doing().replace("ing", "ed");
        return format!("{the} {} {done}", prose::is(the));
    }
    let is = prose::is(the);
    let held = scene.robot.held.map_or_else(String::new, |held| describe::short(catalog, scene, held));
    match verb {
        Verb::Open => format!("{the} {is} open"),
        Verb::Close => match scene.robot.held.filter(|held| *held != object) {
            Some(_) => format!("{the} {is} closed, and I have {held}"),
            None => format!("{the} {is} closed"),
        },
        Verb::Break if scene.object(object).is_some_and(|object| object.has(StateFlag::Cut)) => {
            format!("{the} {is} cut")
        }
        Verb::Break => format!("{the} {is} broken"),
        Verb::Scan => format!("I have scanned {the}"),
        Verb::Pour => format!("I have poured it into {the}"),
        Verb::Toggle => toggled(the, catalog, devices, scene, step, object),
        Verb::Throw => {
            let what = step.says.strip_prefix("throwing ").unwrap_or_default();
            format!("I have thrown {} at {the}", prose::it(what))
        }
        Verb::Fill => format!("{} {} full now", prose::they(&held), prose::is(&held)),
        Verb::Clean => format!("{} {} clean now", prose::they(&held), prose::is(&held)),
        Verb::Examine if step.says.starts_with(LOOKS_UNDER) => match contents::under(catalog, scene, object) {
            Some(found) => found,
            None => format!("I see nothing under {the} or behind it"),
        },
        Verb::Examine => found(catalog, scene, object)
            .unwrap_or_else(|| format!("I have had a close look at {the}, and there is nothing to read on it")),
    }
}

/// What a close look at a thing finds: what is written on it, or what is in it or on it.
fn found(catalog: &Catalog, scene: &Known, id: ObjectId) -> Option<String> {
    let written = scene.object(id).filter(|object| !object.text.is_empty());
    written.map(|object| format!("it says: \"{}\"", object.text)).or_else(|| contents::inside(catalog, scene, id, 0))
}

/// Whether a step was a close look that found nothing to tell.
pub(crate) fn finds_nothing(catalog: &Catalog, scene: &Known, step: &Step) -> bool {
    match step.action {
        Action::Interact { verb: Verb::Examine, object } if !step.says.starts_with(LOOKS_UNDER) => {
            found(catalog, scene, object).is_none()
        }
        _ => false,
    }
}

/// What was switched, what that works, and that it is on where it stays so.
fn toggled(the: &str, catalog: &Catalog, devices: &Devices, scene: &Known, step: &Step, id: ObjectId) -> String {
    let device = scene.object(id).and_then(|object| object.works);
    let is_on = [Some(id), device]
        .into_iter()
        .flatten()
        .filter_map(|id| scene.object(id))
        .any(|object| object.has(StateFlag::Toggled) && devices.stays_on(object.class));
    let did = [("turning on", "turned on"), ("turning off", "turned off"), ("pressing", "pressed")]
        .into_iter()
        .find_map(|(doing, done)| step.says.starts_with(doing).then_some(done));
    let works = device.map_or_else(String::new, |id| format!(", which works {}", describe::short(catalog, scene, id)));
    match did {
        Some("turned on") | None if is_on => format!("{the} {} on", prose::is(the)),
        done => format!("I have {} {the}{works}", done.unwrap_or("switched")),
    }
}

/// What is said after a failure: the world's own sentence, which may end in `: ` and what would help, or else what the
/// status means; and what would help, unless an `offer` follows.
pub(crate) fn failure(
    catalog: &Catalog,
    scene: &Known,
    step: &Step,
    status: Status,
    detail: &str,
    offer: Option<&str>,
) -> String {
    if status == Status::Interrupted {
        return "I stopped.".to_owned();
    }
    let detail = if detail.trim().is_empty() { cause(status) } else { detail };
    let (cause, remedy) = detail.split_once(": ").map_or((detail, None), |(cause, remedy)| (cause, Some(remedy)));
    let help = match (offer, remedy) {
        (Some(offer), _) => offer.to_owned(),
        (None, Some(remedy)) => prose::sentence(remedy),
        (None, None) => help(catalog, scene, step, status),
    };
    format!("{} {help}", prose::sentence(cause)).trim().to_owned()
}

pub(crate) const fn cause(status: Status) -> &'static str {
    match status {
        Status::ActionSuccessful | Status::AlternateNavigationUsed => "that worked",
        Status::UnsupportedAction => "that does not work with it",
        Status::UnsupportedNavigation => "I find no way there",
        Status::AlreadyHoldingObject => "my hand is full",
        Status::ReceptacleIsFull => "there is no room left",
        Status::ReceptacleIsClosed => "it is closed",
        Status::TargetInaccessible => "something is in the way",
        Status::KilledByHazard => "ouch, that was dangerous and it ended the mission",
        Status::TargetOutOfRange => "it is too far away",
        Status::ObjectUnpowered => "it has no power",
        Status::ObjectOverloaded => "it is overloaded",
        Status::InvalidCommand => "that makes no sense here",
        Status::ObjectNotPickedUp => "my hand is empty",
        Status::ArenaUnavailable => "the world is not running",
        Status::IncorrectActionFormat | Status::InvalidObjectClass => "I do not know how to do that",
        Status::ActionExecutionError | Status::PostProcessError => "that did not work",
        Status::Interrupted => "I was interrupted",
    }
}

fn help(catalog: &Catalog, scene: &Known, step: &Step, status: Status) -> String {
    match (status, &step.action) {
        (Status::ReceptacleIsFull, _) => "Tell me another place, or what to take away.".to_owned(),
        (Status::ObjectNotPickedUp, Action::Interact { verb: Verb::Break, .. }) => {
            "I need the hammer for that.".to_owned()
        }
        (Status::ObjectNotPickedUp, _) => "Tell me what to pick up first.".to_owned(),
        (Status::TargetInaccessible, Action::Move { .. }) => "Tell me another way.".to_owned(),
        (Status::ObjectUnpowered, _) => "The room's power must be switched on at the fuse box.".to_owned(),
        (Status::ObjectOverloaded, _) => {
            "Switching the room's power off and on at the fuse box clears that.".to_owned()
        }
        (Status::UnsupportedAction, Action::Interact { object, .. }) => {
            let place = describe::location(catalog, scene, *object);
            if place.is_empty() {
                String::new()
            } else {
                format!("I tried it with {}.", describe::full(catalog, scene, *object))
            }
        }
        _ => String::new(),
    }
}
