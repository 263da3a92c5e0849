//! Toggling: what the table says that a device needs, and what it sets going.

use cohabit_cdf::{
    ActionKind, ObjectId, StateFlag,
    catalog::table::{Change, Device, Scope, Site, Term, View as _},
};

use super::{Ruling, Scene, Verdict, view::Observer};
use crate::{
    effect::Effect,
    facts::Facts,
    report::SoundKind,
    works::{Run, Work, portal},
};

pub(super) fn toggle(scene: &Scene<'_>, object: ObjectId) -> Verdict {
    let judgement = scene.check(ActionKind::Toggle, object)?;
    let facts = scene.facts;
    let device = facts.catalog.table().device(&facts.class(object).id);
    let press = Press { facts, object, device, observer: Observer { facts, body: Some(scene.body) } };
    let scope = Scope::of(object);
    let changes = scope.changes(&press.observer, &device.press);
    let mut effects: Vec<Effect> = changes.iter().flat_map(|change| press.effects(change)).collect();
    effects.extend(changes.iter().flat_map(|change| press.sounds(change)));
    let always = scope.changes(&press.observer, &judgement.rule.effects);
    effects.extend(always.into_iter().flat_map(|change| press.effects(change)));
    Ok(Ruling::done(press.detail(&changes), effects))
}

/// One press of one device.
struct Press<'a> {
    facts: &'a Facts<'a>,
    object: ObjectId,
    device: &'a Device,
    observer: Observer<'a>,
}

impl Press<'_> {
    fn meant(&self, term: Term) -> Option<ObjectId> {
        Scope::of(self.object).get(&self.observer, term)
    }

    fn is_on(&self, term: Term) -> bool {
        self.meant(term).is_some_and(|id| self.facts.is(id, StateFlag::Toggled))
    }

    fn effects(&self, change: &Change) -> Vec<Effect> {
        let of = |term: &Term| self.meant(*term);
        match change {
            Change::Set(term, flag, value) => of(term).map(|id| Effect::Set(id, *flag, *value)).into_iter().collect(),
            Change::Fill(term, fluid) => of(term).map(|id| Effect::Fill(id, *fluid)).into_iter().collect(),
            Change::Paint(term, color) => of(term).map(|id| Effect::Paint(id, *color)).into_iter().collect(),
            Change::Turn(term) => of(term).map(Effect::Turn).into_iter().collect(),
            Change::Flip(term, other) => {
                let on = !self.is_on(*term);
                let both = of(term).into_iter().chain(other.as_ref().and_then(of));
                both.map(|id| Effect::Set(id, StateFlag::Toggled, on)).collect()
            }
            Change::Feed(term, by) => {
                let circuit = of(term).and_then(|id| self.facts.object(id).feeds);
                circuit.map(|circuit| Effect::Feed(circuit, !self.is_on(*by))).into_iter().collect()
            }
            Change::Run(_, other) => vec![Effect::Start(self.object, self.run(other.as_ref().and_then(of)))],
            Change::SwingDoors => self.swing(),
            // The table takes nothing else for a press.
            _ => Vec::new(),
        }
    }

    /// The run of the device for a moment, to do its work at its site.
    fn run(&self, drives: Option<ObjectId>) -> Run {
        let machine = self.observer.machine(self.object);
        let site = match self.device.at {
            Site::It => Some(self.object),
            Site::Machine => machine,
            Site::Target => machine.and_then(|machine| works(self.facts, machine)),
        };
        let work = self.device.work.as_ref().filter(|_| site.is_some());
        Run {
            since: self.facts.state.tick,
            work: work.map_or(Work::Nothing, |name| Work::named(self.facts.catalog, name)),
            site: site.or(machine).unwrap_or(self.object),
            drives,
        }
    }

    fn swing(&self) -> Vec<Effect> {
        let doors = doors_of_buttons(self.facts);
        let open = self.opens(&doors);
        let sound = if open { SoundKind::Open } else { SoundKind::Close };
        doors
            .iter()
            .flat_map(|door| [Effect::Set(*door, StateFlag::Opened, open), Effect::sound(sound, *door)])
            .collect()
    }

    fn opens(&self, doors: &[ObjectId]) -> bool {
        doors.iter().any(|door| !self.facts.is(*door, StateFlag::Opened))
    }

    fn sounds(&self, change: &Change) -> Vec<Effect> {
        match change {
            Change::Flip(..) => vec![Effect::sound(SoundKind::Click, self.object)],
            Change::Fill(..) => vec![Effect::sound(SoundKind::Pour, self.object)],
            Change::Run(..) => {
                let kind = if self.device.alarm { SoundKind::Alarm } else { SoundKind::Machine };
                let ray = self.observer.machine(self.object).filter(|_| self.device.ray);
                let ray = ray.map(|machine| Effect::sound(SoundKind::Ray, machine));
                std::iter::once(Effect::sound(kind, self.object)).chain(ray).collect()
            }
            _ => Vec::new(),
        }
    }

    /// What is said of it.
    fn detail(&self, changes: &[&Change]) -> String {
        let name = self.facts.name(self.object);
        let machine = self.observer.machine(self.object);
        let gate = machine.and_then(|machine| self.facts.state.portals.get(&machine));
        for change in changes {
            match change {
                Change::SwingDoors => {
                    let opens = self.opens(&doors_of_buttons(self.facts));
                    return format!("I {} the doors", if opens { "opened" } else { "closed" });
                }
                Change::Flip(term, _) => {
                    let on = !self.is_on(*term);
                    return match (gate, on) {
                        (Some(gate), true) => {
                            format!("I opened the portal to the {}", portal::era_word(gate.way().era))
                        }
                        (Some(_), false) => "I closed the portal".to_owned(),
                        (None, _) => format!("I switched {name} {}", if on { "on" } else { "off" }),
                    };
                }
                _ => {}
            }
        }
        let fired = machine.filter(|_| self.device.ray).map(|machine| self.facts.name(machine));
        let runs = changes.iter().any(|change| matches!(change, Change::Run(..)));
        match (fired, runs) {
            (Some(machine), true) => format!("I fired {machine}"),
            (Some(machine), false) => format!("I switched {machine} off"),
            (None, _) => format!("I switched {name} on"),
        }
    }
}

/// The doors that security buttons work: those of secured rooms, such as the reception.
pub(crate) fn doors_of_buttons(facts: &Facts<'_>) -> Vec<ObjectId> {
    let rooms = facts.catalog.rooms();
    let secured = facts.floor.gaps.iter().filter(|gap| gap.between.iter().any(|room| rooms.is_secured(*room)));
    secured.filter_map(|gap| gap.door_object).filter(|door| facts.object(*door).exists()).collect()
}

/// What a device works, or aims at: as the layout says, else the nearest of its kind in the room.
pub(crate) fn works(facts: &Facts<'_>, object: ObjectId) -> Option<ObjectId> {
    let told = facts.object(object).works.filter(|id| facts.object(*id).exists());
    told.or_else(|| {
        let device = facts.catalog.table().device(&facts.class(object).id);
        let room = facts.object(object).room;
        let here = facts.object(object).pose.position;
        let classes = device.works.iter().chain(&device.aims);
        classes.flat_map(|class| facts.of_class_in(class, room)).min_by(|one, two| {
            let distance = |id: &ObjectId| facts.object(*id).pose.position.distance(here);
            distance(one).total_cmp(&distance(two))
        })
    })
}
