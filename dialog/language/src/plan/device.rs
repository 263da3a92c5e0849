//! Plans with machines and tools: switching them, and using one on something.

use cohabit_cdf::{Action, ClassId, ObjectId, Property, Verb, state::StateFlag};

use crate::{
    ground::want::{Miss, Want},
    plan::{
        Fault, Planner,
        settle::{Goal, Settled},
    },
    read::{
        phrase::{Phrase, Place},
        slot::Role,
    },
    words::intent::Intent,
};

impl Planner<'_> {
    pub(crate) fn add_toggle(&mut self, settled: &Settled) -> Result<(), Fault> {
        let want = Want { affordances: &[Property::Toggleable, Property::Powerable], ..Want::object(settled.intent) };
        if let Some(machine) = self.machine_of_button(settled) {
            return self.switch(machine, settled.intent);
        }
        for object in self.find_objects(settled, &want)? {
            self.switch(object, settled.intent)?;
        }
        Ok(())
    }

    /// `approach the printer, press the red button`: where no button is in the room, it is the machine's own.
    fn machine_of_button(&self, settled: &Settled) -> Option<ObjectId> {
        let phrase = settled.objects.first()?;
        let is_button = !phrase.namings.is_empty() && phrase.namings.iter().all(|naming| self.is_button(naming.class));
        let has_buttons = || {
            let mut here = self.scene.objects.iter().filter(|object| object.room == self.scene.robot.room);
            here.any(|object| phrase.naming(object.class).is_some())
        };
        if is_button && let [relation] = phrase.relations.as_slice() {
            let want = Want::place(Intent::Toggle, &[Property::Toggleable], None);
            let machine = self.ground().one(&relation.to, &want).ok()?;
            let has_own = self.scene.objects.iter().any(|object| {
                let is_near =
                    object.works == Some(machine) || self.ground().narrow(phrase, &[object.id]) == [object.id];
                self.is_button(object.class) && is_near
            });
            return (!has_own && self.has(machine, Property::Toggleable)).then_some(machine);
        }
        let machine = self.focus.place.filter(|place| self.has(*place, Property::Toggleable))?;
        (is_button && phrase.room.is_none() && !has_buttons()).then_some(machine)
    }

    /// Switches a machine by whatever works it.
    pub(crate) fn switch(&mut self, object: ObjectId, intent: Intent) -> Result<(), Fault> {
        let worker = self.worker(object)?;
        if worker == object && !self.has(object, Property::Toggleable) {
            return Err(Fault::Cannot(format!("I cannot switch {}.", self.the(object))));
        }
        let is_on = [object, worker]
            .into_iter()
            .filter_map(|id| self.scene.object(id))
            .any(|known| known.has(StateFlag::Toggled));
        let wanted = match intent {
            Intent::TurnOn => Some(true),
            Intent::TurnOff => Some(false),
            _ => None,
        };
        if wanted == Some(is_on) {
            let state = if is_on { "on" } else { "off" };
            self.focus.mention(object);
            self.notes.push(self.already(object, state));
            return Ok(());
        }
        // `I want to see the laser fire, turn it on`
        let toggles = Action::Interact { verb: Verb::Toggle, object: worker };
        if wanted == Some(true) && self.steps.last().is_some_and(|step| step.action == toggles) {
            return Ok(());
        }
        if wanted != Some(false) {
            self.fill_to_run(worker)?;
            self.shut_to_run(worker);
        }
        let participle = match wanted {
            Some(true) => "turning on",
            Some(false) => "turning off",
            None if self.scene.object(worker).is_some_and(|known| self.is_button(known.class)) => "pressing",
            None => "switching",
        };
        self.interact(Verb::Toggle, worker, participle);
        if worker != object {
            self.focus.mention(object);
        }
        Ok(())
    }

    /// That it is so already. A machine that runs for a moment was on a moment ago, and its screen may be lit yet.
    fn already(&self, object: ObjectId, state: &str) -> String {
        let the = self.the(object);
        let is_lit = self.scene.object(object).is_some_and(|known| self.devices.is_lit(known.class));
        if is_lit && state == "off" {
            return format!("{the} is off: it runs for a moment only, and its screen stays lit");
        }
        format!("{the} is already {state}")
    }

    fn is_button(&self, class: ClassId) -> bool {
        self.catalog.class(class).name.ends_with("Button")
    }

    /// A microwave runs with its door shut: the wish to run it implies closing it.
    fn shut_to_run(&mut self, machine: ObjectId) {
        let is_open = self
            .scene
            .object(machine)
            .is_some_and(|known| self.devices.must_be_shut(known.class) && known.has(StateFlag::Opened));
        if is_open {
            // What this very plan opens is no news.
            let opens = Action::Interact { verb: Verb::Open, object: machine };
            if !self.steps.iter().any(|step| step.action == opens) {
                self.notes.push(format!("{} is open, so I close it first", self.the(machine)));
            }
            self.interact(Verb::Close, machine, "closing");
        }
    }

    /// What must be switched to run a machine: its monitor, lever or button, or itself.
    fn worker(&self, object: ObjectId) -> Result<ObjectId, Fault> {
        let Some(known) = self.scene.object(object) else { return Ok(object) };
        let Some(classes) = self.devices.workers(known.class) else { return Ok(object) };
        let mut workers: Vec<ObjectId> =
            self.scene.objects.iter().filter(|other| other.works == Some(object)).map(|other| other.id).collect();
        if workers.is_empty() && self.may_find(classes) {
            return Err(self.need(classes, format!("I do not know what works {}.", self.the(object))));
        }
        if workers.is_empty() {
            let fits = |class: &&ClassId| self.scene.objects.iter().any(|other| other.class == **class);
            workers = classes.iter().filter(fits).filter_map(|class| self.nearest(&[*class])).collect();
        }
        match workers.as_slice() {
            [] => Ok(object),
            [one] => Ok(*one),
            _ => {
                let phrase = Phrase { text: self.the(object), ..Phrase::default() };
                Err(self.miss(&phrase, Miss::Several(workers), Intent::Toggle, Some(Role::Object(0))))
            }
        }
    }

    /// `use the hammer on the mug`, `use the microwave`.
    pub(crate) fn add_use(&mut self, settled: &Settled) -> Result<(), Fault> {
        let Some(phrase) = settled.objects.first() else { return Ok(()) };
        let Some(Goal { place: Place::Object(target), role, .. }) = &settled.goal else {
            let settled = Settled { intent: Intent::TurnOn, ..settled.clone() };
            return self.add_toggle(&settled);
        };
        let tool = self.find_one(phrase, &Want::place(Intent::Use, &[], None), Some(Role::Object(0)))?;
        let class = self.scene.object(tool).map(|known| known.class);
        let is_one_of = |tools: &[ClassId]| class.is_some_and(|class| tools.contains(&class));
        let process = class.and_then(|class| self.devices.processes.iter().find(|process| process.is_done_at(class)));
        let intent = match process {
            _ if is_one_of(&self.devices.hammers) => Intent::Break,
            _ if is_one_of(&self.devices.knives) => Intent::Cut,
            Some(process) => process.intent,
            // `use the antivirus disk on the computer`
            None => Intent::Place,
        };
        if intent == Intent::Place {
            return self.add_place(&Settled { intent, ..settled.clone() });
        }
        let object = self.find_one(target, &Want::object(intent), Some(*role))?;
        let chosen = |id: ObjectId, phrase: &Phrase| Phrase { chosen: Some(id), ..phrase.clone() };
        let settled = Settled {
            intent,
            objects: vec![chosen(object, target)],
            goal: None,
            tool: Some((chosen(tool, phrase), Role::Object(0))),
            ..settled.clone()
        };
        if matches!(intent, Intent::Break | Intent::Cut) {
            self.add_break(&settled)
        } else {
            self.add_process(&settled)
        }
    }
}
