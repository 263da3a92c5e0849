//! Toggling: what is needed for a device to answer, and what it sets going.

use cohabit_cdf::{Fluid, ObjectId, Property, RoomId, StateFlag, Status};

use super::{
    Ruling, Scene, Verdict,
    device::{Device, Toggling, of_class},
    opening::clear_doorway,
    refuse,
};
use crate::{
    effect::Effect,
    facts::Facts,
    power::lacks_power,
    report::SoundKind,
    works::{self, Run, Work, portal},
};

pub(super) fn toggle(scene: &Scene<'_>, object: ObjectId) -> Verdict {
    let facts = scene.facts;
    let device = of_class(&facts.class(object).id);
    if !device.toggling.answers_always() {
        scene.needs(object, Property::Toggleable, "switched on or off")?;
    }
    scene.touch(object)?;
    let press = Press { facts, object, device, name: facts.name(object) };
    press.check_power(object)?;
    let mut ruling = press.rule()?;
    ruling.effects.push(Effect::Set(object, StateFlag::Used, true));
    Ok(ruling)
}

/// One press of one device.
struct Press<'a> {
    facts: &'a Facts<'a>,
    object: ObjectId,
    device: Device,
    name: String,
}

impl Press<'_> {
    fn rule(&self) -> Verdict {
        match self.device.toggling {
            Toggling::Flips => Ok(self.flip(&[])),
            Toggling::Runs => Ok(self.run_water()),
            Toggling::FlipsBoth => {
                let machine = self.machine()?;
                self.check_power(machine)?;
                Ok(self.flip(&[machine]))
            }
            Toggling::Portal => self.portal(),
            Toggling::Moment => Ok(self.start(self.object, None)),
            Toggling::MomentWithContents => {
                self.check_shut()?;
                self.check_contents(self.object)?;
                Ok(self.start(self.object, None))
            }
            Toggling::MomentWithFluid => self.brew(),
            Toggling::Prints => self.print(),
            Toggling::MomentAt => {
                let machine = self.machine()?;
                self.check_power(machine)?;
                self.check_contents(machine)?;
                Ok(self.start(machine, Some(machine)))
            }
            Toggling::Vends(slot) => self.vend(slot),
            Toggling::Fires { parts } => self.fire(parts),
            Toggling::Breaker => self.breaker(),
            Toggling::Doors => self.doors(),
            Toggling::Sparks => Ok(self.spark()),
            Toggling::WorkedBy(what) => {
                let detail = format!("{} has no switch of its own: {what} works it", self.name);
                refuse(Status::UnsupportedAction, detail)
            }
        }
    }

    fn is_on(&self) -> bool {
        self.facts.is(self.object, StateFlag::Toggled)
    }

    /// Flips the device, and others to the same state.
    fn flip(&self, others: &[ObjectId]) -> Ruling {
        let on = !self.is_on();
        let mut effects = vec![Effect::Set(self.object, StateFlag::Toggled, on)];
        for other in others {
            effects.extend([StateFlag::Toggled, StateFlag::Used].map(|flag| {
                let value = on || flag == StateFlag::Used;
                Effect::Set(*other, flag, value)
            }));
        }
        effects.push(Effect::sound(SoundKind::Click, self.object));
        Ruling::done(format!("I switched {} {}", self.name, if on { "on" } else { "off" }), effects)
    }

    /// A sink fills while its tap runs, and drains when that is turned off.
    fn run_water(&self) -> Ruling {
        let water = if self.is_on() { Fluid::None } else { Fluid::Water };
        let mut ruling = self.flip(&[]);
        ruling.effects.extend([Effect::Fill(self.object, water), Effect::sound(SoundKind::Pour, self.object)]);
        ruling
    }

    /// Opens or closes a portal; once closed, it leads elsewhere the next time.
    fn portal(&self) -> Verdict {
        let facts = self.facts;
        let generator = self.machine()?;
        self.check_power(generator)?;
        let open = facts.is(generator, StateFlag::Toggled);
        let mut ruling = self.flip(&[generator]);
        // Monitor and generator agree, however they stood before.
        ruling.effects[0] = Effect::Set(self.object, StateFlag::Toggled, !open);
        ruling.effects[1] = Effect::Set(generator, StateFlag::Toggled, !open);
        if open {
            ruling.effects.push(Effect::Turn(generator));
            return Ok(Ruling { detail: "I closed the portal".to_owned(), ..ruling });
        }
        let era = facts.state.portals.get(&generator).map_or("unknown", |gate| portal::era_word(gate.way().era));
        Ok(Ruling { detail: format!("I opened the portal to the {era}"), ..ruling })
    }

    /// Starts the device for a moment, to do its work at `site`.
    fn start(&self, site: ObjectId, drives: Option<ObjectId>) -> Ruling {
        let run = Run { since: self.facts.state.tick, work: self.device.work, site, drives };
        let kind = if self.device.class == "FireAlarm_01" { SoundKind::Alarm } else { SoundKind::Machine };
        let mut effects = vec![Effect::Start(self.object, run), Effect::sound(kind, self.object)];
        effects.extend(drives.map(|driven| Effect::Set(driven, StateFlag::Used, true)));
        Ruling::done(format!("I switched {} on", self.name), effects)
    }

    fn check_power(&self, machine: ObjectId) -> Result<(), Ruling> {
        let name = self.facts.name(machine);
        if lacks_power(self.facts, machine) {
            return refuse(
                Status::ObjectUnpowered,
                format!("{name} has no power: the lever in the fuse box switches it on"),
            );
        }
        if self.facts.is(machine, StateFlag::Overloaded) {
            return refuse(
                Status::ObjectOverloaded,
                format!("{name} is overloaded: its power has to be switched off and on at the fuse box"),
            );
        }
        Ok(())
    }

    fn check_contents(&self, machine: ObjectId) -> Result<(), Ruling> {
        if self.facts.held_in(machine).is_empty() {
            return refuse(
                Status::ActionExecutionError,
                format!("{} is empty: something has to be put in first", self.facts.name(machine)),
            );
        }
        Ok(())
    }

    fn check_shut(&self) -> Result<(), Ruling> {
        let facts = self.facts;
        let has_door = facts.has(self.object, Property::Openable);
        if has_door && facts.is(self.object, StateFlag::Opened) {
            let detail = format!("{} is open: it has to be closed first", self.name);
            return refuse(Status::ActionExecutionError, detail);
        }
        Ok(())
    }

    /// What it works: as the layout says, else the one of its kind in the room.
    fn machine(&self) -> Result<ObjectId, Ruling> {
        linked(self.facts, self.object, &self.device)
            .map_or_else(|| refuse(Status::ActionExecutionError, format!("{} is connected to nothing", self.name)), Ok)
    }

    fn brew(&self) -> Verdict {
        let facts = self.facts;
        self.check_contents(self.object)?;
        if !works::can_brew(facts, self.object) {
            return refuse(
                Status::ActionExecutionError,
                format!("{} has neither water nor beans: I have to fill it first", self.name),
            );
        }
        Ok(self.start(self.object, None))
    }

    fn print(&self) -> Verdict {
        if works::cartridge(self.facts, self.object).is_none() {
            return refuse(
                Status::ActionExecutionError,
                format!("{} has no cartridge: one has to be put in first", self.name),
            );
        }
        if works::product_anchor(self.facts, self.object).is_none() {
            return refuse(
                Status::ReceptacleIsFull,
                format!("{} has no room to print: something has to be taken out first", self.name),
            );
        }
        Ok(self.start(self.object, None))
    }

    fn vend(&self, slot: u16) -> Verdict {
        let machine = self.machine()?;
        self.check_power(machine)?;
        if works::vended(self.facts, machine, slot).is_none() {
            return refuse(Status::ActionExecutionError, format!("the slot of {} is sold out", self.name));
        }
        if works::tray_anchor(self.facts, machine).is_none() {
            return refuse(
                Status::ReceptacleIsFull,
                format!("the tray of {} is full: something has to be taken out first", self.facts.name(machine)),
            );
        }
        Ok(self.start(machine, None))
    }

    fn fire(&self, parts: &[&str]) -> Verdict {
        let facts = self.facts;
        let machine = self.machine()?;
        let machine_name = facts.name(machine);
        self.check_power(machine)?;
        if facts.is(machine, StateFlag::Toggled) {
            let off = [self.object, machine].map(|id| Effect::Set(id, StateFlag::Toggled, false));
            return Ok(Ruling::done(format!("I switched {machine_name} off"), off.to_vec()));
        }
        let inside: Vec<&str> = facts.state.children(machine).map(|child| facts.class(child).id.as_str()).collect();
        if let Some(part) = parts.iter().find(|part| !inside.contains(part)) {
            let part = facts.catalog.find(part).map_or(*part, |class| facts.catalog.class(class).name.as_str());
            let detail = format!("{machine_name} lacks its {0}: the {0} has to be put in first", part.to_lowercase());
            return refuse(Status::ActionExecutionError, detail);
        }
        let shelf = linked(facts, machine, &of_class(&facts.class(machine).id));
        let mut ruling = self.start(shelf.unwrap_or(machine), Some(machine));
        if shelf.is_none() {
            ruling.effects[0] = Effect::Start(
                self.object,
                Run { since: facts.state.tick, work: Work::Nothing, site: machine, drives: Some(machine) },
            );
        }
        ruling.effects.push(Effect::sound(SoundKind::Ray, machine));
        Ok(Ruling { detail: format!("I fired {machine_name}"), ..ruling })
    }

    fn breaker(&self) -> Verdict {
        let facts = self.facts;
        let Some(circuit) = facts.object(self.object).parent().and_then(|fuse_box| facts.object(fuse_box).feeds) else {
            return refuse(
                Status::ActionExecutionError,
                format!("{} is in no fuse box: it has to be put into one first", self.name),
            );
        };
        let mut ruling = self.flip(&[]);
        let fuse_box = facts.object(self.object).parent();
        ruling.effects.extend(fuse_box.map(|id| Effect::Set(id, StateFlag::Toggled, !self.is_on())));
        ruling.effects.push(Effect::Feed(circuit, !self.is_on()));
        Ok(ruling)
    }

    fn doors(&self) -> Verdict {
        let facts = self.facts;
        let doors: Vec<ObjectId> = facts
            .floor
            .gaps
            .iter()
            .filter(|gap| gap.between.contains(&RoomId::Reception))
            .filter_map(|gap| gap.door_object)
            .filter(|door| facts.object(*door).exists())
            .collect();
        let open = doors.iter().any(|door| !facts.is(*door, StateFlag::Opened));
        if !open {
            doors.iter().try_for_each(|door| clear_doorway(facts, *door))?;
        }
        let mut ruling = self.start(self.object, None);
        for door in doors {
            ruling.effects.push(Effect::Set(door, StateFlag::Opened, open));
            ruling.effects.push(Effect::sound(if open { SoundKind::Open } else { SoundKind::Close }, door));
        }
        Ok(Ruling { detail: format!("I {} the doors", if open { "opened" } else { "closed" }), ..ruling })
    }

    fn spark(&self) -> Ruling {
        let mut ruling = self.flip(&[]);
        ruling.effects.push(Effect::Set(self.object, StateFlag::Sparking, !self.is_on()));
        ruling
    }
}

/// What a device works: as the layout says, else the nearest of its kind in the room.
fn linked(facts: &Facts<'_>, object: ObjectId, device: &Device) -> Option<ObjectId> {
    let told = facts.object(object).works.filter(|id| facts.object(*id).exists());
    told.or_else(|| {
        let room = facts.object(object).room;
        let here = facts.object(object).pose.position;
        device.works.iter().flat_map(|class| facts.of_class_in(class, room)).min_by(|one, two| {
            let distance = |id: &ObjectId| facts.object(*id).pose.position.distance(here);
            distance(one).total_cmp(&distance(two))
        })
    })
}
