//! The press of a device: what it sets going, how it sounds, what is said of it.

use cohabit_cdf::{
    ObjectId, StateFlag,
    catalog::table::{Change, Device, Scope, Site, Term, View as _},
};

use super::{Observer, doors, works};
use crate::{
    effect::Effect,
    report::SoundKind,
    run::{Run, Work},
    works::portal,
};

/// The start of a device that is on for a moment, to do its work at its site; `drives` is on as long.
pub(super) fn start(observer: &Observer<'_>, object: ObjectId, drives: Option<ObjectId>) -> Effect {
    let facts = observer.facts;
    let device = facts.catalog.table().device(&facts.class(object).id);
    let machine = observer.machine(object);
    let site = match device.at {
        Site::It => Some(object),
        Site::Machine => machine,
        Site::Target => machine.and_then(|machine| works(facts, machine)),
    };
    let work = device.work.as_ref().filter(|_| site.is_some());
    let run = Run {
        since: facts.state.tick,
        work: work.map_or(Work::Nothing, |name| Work::named(facts.catalog, name)),
        site: site.or(machine).unwrap_or(object),
        drives,
    };
    Effect::Start(object, run)
}

/// How the changes of a press sound.
pub(super) fn sounds(observer: &Observer<'_>, object: ObjectId, device: &Device, changes: &[&Change]) -> Vec<Effect> {
    let sounds = |change: &&Change| match change {
        Change::Flip(..) => vec![Effect::sound(SoundKind::Click, object)],
        Change::Fill(..) => vec![Effect::sound(SoundKind::Pour, object)],
        Change::Run(..) => {
            let kind = if device.alarm { SoundKind::Alarm } else { SoundKind::Machine };
            let ray = observer.machine(object).filter(|_| device.ray);
            let ray = ray.map(|machine| Effect::sound(SoundKind::Ray, machine));
            std::iter::once(Effect::sound(kind, object)).chain(ray).collect()
        }
        _ => Vec::new(),
    };
    changes.iter().flat_map(sounds).collect()
}

/// What is said of a press with these changes.
pub(super) fn told(observer: &Observer<'_>, object: ObjectId, device: &Device, changes: &[&Change]) -> String {
    let facts = observer.facts;
    let name = facts.name(object);
    let machine = observer.machine(object);
    for change in changes {
        match change {
            Change::SwingDoors => {
                let opens = doors::opens(facts, &doors::doors_of_buttons(facts));
                return format!("I {} the doors", if opens { "opened" } else { "closed" });
            }
            Change::Flip(term, _) => return flipped(observer, object, *term),
            _ => {}
        }
    }
    let fired = machine.filter(|_| device.ray).map(|machine| facts.name(machine));
    let runs = changes.iter().any(|change| matches!(change, Change::Run(..)));
    match (fired, runs) {
        (Some(machine), true) => format!("I fired {machine}"),
        (Some(machine), false) => format!("I switched {machine} off"),
        (None, _) => format!("I switched {name} on"),
    }
}

/// What is said where a press flips what the term means.
fn flipped(observer: &Observer<'_>, object: ObjectId, term: Term) -> String {
    let facts = observer.facts;
    let meant = Scope::of(object).get(observer, term);
    let on = !meant.is_some_and(|id| facts.is(id, StateFlag::Toggled));
    let gate = observer.machine(object).and_then(|machine| facts.state.portals.get(&machine));
    match (gate, on) {
        (Some(gate), true) => format!("I opened the portal to the {}", portal::era_word(gate.way().era)),
        (Some(_), false) => "I closed the portal".to_owned(),
        (None, _) => format!("I switched {} {}", facts.name(object), if on { "on" } else { "off" }),
    }
}
