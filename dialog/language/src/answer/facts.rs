//! What the robot can tell of a thing: how it is, what it is for, what is wrong with it, and whether it is dangerous.

use cohabit_cdf::{Catalog, ClassId, Fluid, ObjectId, Property, state::StateFlag};

use crate::{
    known::{Known, KnownObject, afforded, describe, memory, process::Devices},
    words::prose,
};

/// What answers draw on.
#[derive(Clone, Copy)]
pub(crate) struct Facts<'a> {
    pub(crate) catalog: &'a Catalog,
    pub(crate) devices: &'a Devices,
    pub(crate) scene: &'a Known,
}

/// States worth telling of a single thing.
const STATES: [(StateFlag, &str); 13] = [
    (StateFlag::Broken, "broken"),
    (StateFlag::Dirty, "dirty"),
    (StateFlag::Hot, "hot"),
    (StateFlag::Cold, "cold"),
    (StateFlag::Cooked, "cooked"),
    (StateFlag::Cut, "cut"),
    (StateFlag::Eaten, "eaten"),
    (StateFlag::Infected, "infected with a virus"),
    (StateFlag::Sparking, "throwing sparks"),
    (StateFlag::Embiggenated, "large"),
    (StateFlag::Wet, "wet"),
    (StateFlag::Creased, "creased"),
    (StateFlag::Folded, "folded"),
];

/// What is wrong with a thing in such a state.
const WRONGS: [(StateFlag, &str); 7] = [
    (StateFlag::Broken, "it is broken"),
    (StateFlag::Dirty, "it is dirty"),
    (StateFlag::Eaten, "it is eaten"),
    (StateFlag::Infected, "it has a virus"),
    (StateFlag::Sparking, "it throws sparks, and is deadly to touch"),
    (StateFlag::Overloaded, "it is overloaded"),
    (StateFlag::Locked, "it is locked"),
];

impl Facts<'_> {
    fn the(&self, id: ObjectId) -> String {
        describe::short(self.catalog, self.scene, id)
    }

    /// What it is for: what it does, what it belongs to, and who says something about it.
    pub(crate) fn purpose(&self, object: &KnownObject) -> String {
        let the = self.the(object.id);
        let belongs = self.key_of(object.class).map(|place| {
            let place = describe::name(self.catalog, place);
            format!("{the} belongs in the {place}")
        });
        let prints = self.devices.printed_by(object.class).map(|printed| {
            let printed = prose::indefinite(&describe::name(self.catalog, printed));
            format!("{the} makes the printer print {printed}")
        });
        let first = self.use_of(object).or(prints).or(belongs).unwrap_or_else(|| self.affords(object));
        let told = self.switched_by(object).into_iter().chain(self.told_of(object));
        std::iter::once(first).chain(told).map(|text| prose::sentence(&text)).collect::<Vec<_>>().join(" ")
    }

    /// What it does, or what the machine does that it switches, where that is known.
    pub(crate) fn use_of(&self, object: &KnownObject) -> Option<String> {
        let the = self.the(object.id);
        let does = self.devices.uses.of(object.class).map(|does| format!("{the} {does}"));
        let works = || {
            let worked = self.worked_by(object)?;
            let machine = describe::name(self.catalog, worked);
            Some(match self.devices.uses.of(worked) {
                Some(does) => format!("{the} switches the {machine}, which {does}"),
                None => format!("{the} switches the {machine}"),
            })
        };
        does.or_else(works)
    }

    /// What a machine is switched by that has no switch of its own.
    fn switched_by(&self, machine: &KnownObject) -> Option<String> {
        let classes = self.devices.workers(machine.class)?;
        let works = |one: &&KnownObject| one.works == Some(machine.id) && classes.contains(&one.class);
        let known: Vec<String> = self.scene.objects.iter().filter(works).map(|one| self.the(one.id)).collect();
        (!known.is_empty()).then(|| format!("it has no switch of its own: {} works it", prose::list(&known, "or")))
    }

    /// What a kind of thing is for, where that is known.
    pub(crate) fn purpose_of_kind(&self, class: ClassId) -> Option<String> {
        let belongs = || Some(format!("belongs in the {}", describe::name(self.catalog, self.key_of(class)?)));
        let does = self.devices.uses.of(class).map(str::to_owned).or_else(belongs)?;
        let name = prose::indefinite(&describe::name(self.catalog, class));
        Some(prose::sentence(&format!("{name} {does}")))
    }

    /// Whether more is known of its use than what can be done with it.
    pub(crate) fn has_use(&self, object: &KnownObject) -> bool {
        self.devices.uses.of(object.class).is_some() || self.worked_by(object).is_some()
    }

    /// The class that it switches.
    fn worked_by(&self, object: &KnownObject) -> Option<ClassId> {
        let is_lever = self.catalog.class(object.class).has(Property::Pickupable);
        let known = object.works.and_then(|id| self.scene.object(id)).map(|worked| worked.class);
        known.or_else(|| self.devices.worked_by(object.class)).filter(|_| !is_lever)
    }

    /// The class that it is a part of, or goes into: what has a slot for it.
    fn key_of(&self, class: ClassId) -> Option<ClassId> {
        let id = &self.catalog.class(class).id;
        let has_slot = |place: &ClassId| {
            let receptacle = self.catalog.class(*place).receptacle.as_ref();
            receptacle.is_some_and(|receptacle| receptacle.keys.contains(id))
        };
        self.scene.objects.iter().map(|object| object.class).find(has_slot)
    }

    /// What I can do with it.
    fn affords(&self, object: &KnownObject) -> String {
        let the = self.the(object.id);
        let it = prose::it(&the);
        let carry = self.catalog.class(object.class).has(Property::Pickupable).then(|| format!("carry {it}"));
        let can: Vec<String> = carry.into_iter().chain(afforded::afforded(self.devices, object.class, it)).collect();
        match can.as_slice() {
            [] => {
                format!("{the} {} there to be looked at: there is nothing that I could do with {it}", prose::is(&the))
            }
            can => format!("I know of no special use for {the}: I can {}", prose::list(can, "and")),
        }
    }

    /// The goal that needs it, and what is written about it.
    fn told_of(&self, object: &KnownObject) -> impl Iterator<Item = String> {
        let goal = self.scene.goals.iter().find(|goal| !goal.met && self.speaks_of(&goal.text, object));
        let it = prose::it(&self.the(object.id));
        let goal = goal.map(|goal| format!("The mission needs {it}: {}", goal.text));
        goal.into_iter().chain(self.written_of(object))
    }

    /// A note that speaks of it.
    pub(crate) fn written_of(&self, object: &KnownObject) -> Option<String> {
        let note = self.scene.objects.iter().find(|note| note.id != object.id && self.speaks_of(&note.text, object))?;
        let the = prose::sentence(&self.the(note.id));
        Some(format!("{} says: \"{}\"", the.trim_end_matches('.'), note.text))
    }

    fn speaks_of(&self, text: &str, object: &KnownObject) -> bool {
        let names = [describe::name(self.catalog, object.class), describe::bare(self.catalog, self.scene, object.id)];
        let text = text.to_lowercase();
        names.iter().any(|name| text.contains(name.as_str()))
    }

    /// How it is, and where: `the mug is red, dirty and empty; it is on the table`.
    pub(crate) fn description(&self, object: &KnownObject) -> String {
        let class = self.catalog.class(object.class);
        let color = describe::color(self.catalog, object);
        let bare = describe::bare(self.catalog, self.scene, object.id);
        let mut said: Vec<String> = Vec::new();
        if !color.is_empty() && !bare.contains(&color) {
            said.push(color);
        }
        said.extend(STATES.iter().filter(|(flag, _)| object.has(*flag)).map(|(_, state)| (*state).to_owned()));
        if class.has(Property::Openable) {
            said.push(if object.has(StateFlag::Opened) { "open" } else { "closed" }.to_owned());
        }
        if class.has(Property::Toggleable) && self.devices.stays_on(object.class) {
            said.push(if object.has(StateFlag::Toggled) { "on" } else { "off" }.to_owned());
        }
        match object.fluid {
            Fluid::None if object.has(StateFlag::Cereal) => said.push("full of cereal".to_owned()),
            Fluid::None if class.has(Property::Fillable) && class.has(Property::Pickupable) => {
                said.push("empty".to_owned());
            }
            Fluid::None => {}
            fluid => said.push(format!("full of {}", fluid.name().to_lowercase())),
        }
        let place = describe::location(self.catalog, self.scene, object.id);
        let place = if place.is_empty() { format!("here in the {}", object.room.name_in(self.catalog)) } else { place };
        if said.is_empty() {
            return format!("the {bare} {} {place}", prose::is(&bare));
        }
        let (is, they, said) = (prose::is(&bare), prose::they(&bare), prose::list(&said, "and"));
        format!("the {bare} {is} {said}; {they} {is} {place}")
    }

    /// Whether it is broken: its state says so, or its class, which is of broken things.
    pub(crate) fn is_broken(&self, object: &KnownObject) -> bool {
        object.has(StateFlag::Broken) || self.catalog.class(object.class).name.to_lowercase().contains("broken")
    }

    /// What is wrong with it, as far as can be seen.
    pub(crate) fn trouble(&self, object: &KnownObject) -> Option<String> {
        let class = self.catalog.class(object.class);
        let is_so = |flag| if flag == StateFlag::Broken { self.is_broken(object) } else { object.has(flag) };
        let wrong = WRONGS.iter().filter(|(flag, _)| is_so(*flag)).map(|(_, wrong)| (*wrong).to_owned());
        // Where nothing has power, nobody told.
        let is_told = self.scene.objects.iter().any(|other| other.has(StateFlag::Powered));
        let has_no_power = is_told && class.has(Property::Powerable) && !object.has(StateFlag::Powered);
        let no_power = has_no_power.then(|| "it has no power".to_owned());
        let lacks = self.parts_lacked(object).map(|part| format!("it lacks its {part}"));
        let wrong: Vec<String> = wrong.chain(no_power).chain(lacks).collect();
        (!wrong.is_empty()).then(|| prose::list(&wrong, "and"))
    }

    /// The names of parts that a machine lacks, as far as can be seen; nothing, of what is worked without any.
    pub(crate) fn lacked(&self, object: &KnownObject) -> Option<Vec<String>> {
        self.catalog.table().parts_needed(&self.catalog.class(object.class).id).next()?;
        Some(self.parts_lacked(object).collect())
    }

    /// The names of parts that it is not worked without, and that are not in it as far as can be seen.
    fn parts_lacked(&self, object: &KnownObject) -> impl Iterator<Item = String> {
        let is_hidden = memory::is_shut(self.catalog, object);
        let parts = self.catalog.table().parts_needed(&self.catalog.class(object.class).id);
        parts.filter(move |_| !is_hidden).filter_map(|part| {
            let is_part = |inner: &KnownObject| part.matches(&self.catalog.class(inner.class).id);
            let name = |class| describe::name(self.catalog, class);
            let is_there = self.scene.contents(object.id).any(is_part);
            if is_there { None } else { part.0.iter().find_map(|class| self.catalog.find(class)).map(name) }
        })
    }

    /// Whether to touch it is deadly, or may be; nothing, where no danger is known.
    pub(crate) fn danger(&self, object: &KnownObject) -> Option<String> {
        let the = self.the(object.id);
        if object.has(StateFlag::Sparking) {
            return Some(format!("{the} throws sparks: who touches it now is killed"));
        }
        let warns = |text: &str| self.devices.uses.of(object.class).is_some_and(|does| does.contains(text));
        (warns("deadly") || warns("beam"))
            .then(|| format!("{the} {}", self.devices.uses.of(object.class).unwrap_or_default()))
    }
}
