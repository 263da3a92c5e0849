//! Plans of processes: getting things heated, cooled, cleaned, dried, ironed, watered, repaired, coloured and printed, by a machine or by hand.

use cohabit_cdf::{Action, ActionKind, ClassId, Fluid, ObjectId, Property, Verb, state::StateFlag};

use crate::{
    ground::want::{Miss, Want},
    known::{
        KnownObject, describe,
        process::{Act, Process},
    },
    plan::{
        Fault, Planner,
        settle::{Goal, Settled},
    },
    read::{
        phrase::{Phrase, Place, RelationKind},
        slot::Role,
    },
    words::{intent::Intent, prose},
};

impl Planner<'_> {
    /// Heating, cooling, cleaning and all else that takes several steps at a device.
    pub(crate) fn add_process(&mut self, settled: &Settled) -> Result<(), Fault> {
        let mut settled = settled.clone();
        self.describe_by_goal(&mut settled);
        if settled.objects.is_empty() && settled.intent == Intent::Brew {
            settled.objects.push(Phrase::default());
        }
        for index in 0..settled.objects.len() {
            if self.is_plain_switch(&settled, index)? {
                continue;
            }
            // Each of several in its turn: there is but one hand.
            if settled.objects[index].is_all || self.is_group(&settled.objects[index]) {
                let want = Want { held_first: false, ..Want::object(settled.intent) };
                let phrase = settled.objects[index].clone();
                for id in self.find_each(&phrase, &want, Some(Role::Object(index)))? {
                    let one = Phrase { chosen: Some(id), is_all: false, ..phrase.clone() };
                    self.add_process(&Settled { objects: vec![one], ..settled.clone() })?;
                }
                continue;
            }
            let object = self.process_object(&settled, index)?;
            if settled.intent == Intent::Fill && settled.fluid == Some(Fluid::Milk) {
                let cartons: Vec<ClassId> = self.catalog.find("MilkCarton_01").into_iter().collect();
                let milk = self.milk().ok_or_else(|| self.need(&cartons, "I do not know where any milk is."))?;
                self.pour(milk, object)?;
                continue;
            }
            if settled.intent == Intent::Fill
                && !self.has(object, Property::Fillable)
                && self.has(object, Property::Dirtyable)
            {
                // Water over a plate: it is to be washed.
                settled.intent = Intent::Clean;
            }
            // `fill the bowl with it`, of what can be carried
            if settled.intent == Intent::Fill
                && let Some((phrase, role)) = &settled.tool
                && let Ok(source) = self.find_one(phrase, &Want::object(Intent::Pour), Some(*role))
                && source != object
                && self.has(source, Property::Pickupable)
            {
                self.pour(source, object)?;
                continue;
            }
            let is_big = self.scene.object(object).is_some_and(|object| object.has(StateFlag::Embiggenated));
            if settled.intent == Intent::Resize && is_big {
                self.notes.push(format!("{} is big already", self.the(object)));
                continue;
            }
            if settled.intent == Intent::Shrink && !is_big {
                let text =
                    format!("{} has its usual size, and no machine that I know of makes it smaller.", self.the(object));
                return Err(Fault::Cannot(prose::sentence(&text)));
            }
            let is_once = matches!(settled.intent, Intent::Repair | Intent::Clean | Intent::Heat | Intent::Cool);
            if is_once && self.brought_about.contains(&(settled.intent, object)) {
                continue;
            }
            let chosen = self.choose_process(&settled, object);
            // Who names a machine wants it to run.
            let process = chosen.as_ref().ok().map(|(process, _)| process);
            let is_put_in = process.is_some_and(|process| process.steps.contains(&Act::Place));
            let fluid = settled.fluid.or_else(|| process.and_then(|process| process.fluid));
            let is_named = settled.goal.is_some() || settled.tool.is_some();
            if let Some(state) = self.is_so_already(settled.intent, fluid, object).filter(|_| !(is_named && is_put_in))
            {
                let the = self.the(object);
                self.notes.push(format!("{the} {} {state} already", prose::is(&the)));
                self.focus.mention(object);
                continue;
            }
            self.brought_about.push((settled.intent, object));
            let (process, place) = chosen?;
            self.carry_out(&process, object, place, settled.color.as_deref())?;
        }
        Ok(())
    }

    /// What a thing is already that is asked for: there is nothing to do about it, and what is tried all the same fails. Of what cannot be
    /// carried why not is told instead.
    fn is_so_already(&self, intent: Intent, fluid: Option<Fluid>, object: ObjectId) -> Option<&'static str> {
        let known = self.scene.object(object).filter(|_| self.has(object, Property::Pickupable))?;
        match intent {
            // What is in it is to be rinsed out.
            Intent::Clean if !known.has(StateFlag::Dirty) && known.fluid == Fluid::None => Some("clean"),
            Intent::Dry if !known.has(StateFlag::Wet) => Some("dry"),
            Intent::Fold if known.has(StateFlag::Folded) => Some("folded"),
            Intent::Fill if known.fluid != Fluid::None && fluid.is_none_or(|fluid| fluid == known.fluid) => {
                Some("full")
            }
            _ => None,
        }
    }

    /// Turns off what was turned on for what is done now, and need not be if it is turned on again next.
    fn turn_off_again(&mut self, place: ObjectId) {
        self.turned_off.push(self.steps.len());
        self.interact(Verb::Toggle, place, "turning off");
    }

    /// `heat the mug on the table`: the table is no device, so it says where the mug is.
    fn describe_by_goal(&self, settled: &mut Settled) {
        let Some(Goal { preposition, place: Place::Object(phrase), .. }) = &settled.goal else { return };
        let is_made = self.devices.made.iter().any(|class| phrase.naming(*class).is_some());
        if settled.intent == Intent::Carrot && is_made {
            settled.goal = None;
            return;
        }
        let names_device = self.processes(settled.intent, settled.fluid).any(|process| {
            process.at.iter().chain(&process.also).chain(&process.start).any(|class| phrase.naming(*class).is_some())
        });
        let is_described = !names_device && phrase.chosen.is_none() && phrase.instance.is_none();
        if is_described && let Some(object) = settled.objects.last_mut() {
            object.attach(*preposition, Place::Object(phrase.clone()));
            settled.goal = None;
        }
    }

    /// `fill the sink`, `wash the sink`: the water is turned on, and that is all.
    fn is_plain_switch(&mut self, settled: &Settled, index: usize) -> Result<bool, Fault> {
        let sinks: Vec<ClassId> = self
            .processes(Intent::Fill, None)
            .filter(|process| process.steps.contains(&Act::Run))
            .flat_map(|process| process.at.clone())
            .collect();
        let phrase = &settled.objects[index];
        let is_sink = matches!(settled.intent, Intent::Fill | Intent::Clean)
            && sinks.iter().any(|class| phrase.naming(*class).is_some());
        if is_sink {
            let want = Want { classes: &sinks, ..Want::place(Intent::TurnOn, &[], None) };
            let sink = self.find_one(phrase, &want, Some(Role::Object(index)))?;
            self.switch(sink, Intent::TurnOn)?;
        }
        Ok(is_sink)
    }

    fn process_object(&self, settled: &Settled, index: usize) -> Result<ObjectId, Fault> {
        let (phrase, role) = (&settled.objects[index], Some(Role::Object(index)));
        let want = Want::object(settled.intent);
        if settled.intent == Intent::Brew {
            let cups: Vec<ClassId> =
                self.processes(Intent::Brew, None).flat_map(|process| process.object.clone()).collect();
            let held = self.scene.robot.held.filter(|held| self.has(*held, Property::Fillable));
            let cup = held.or_else(|| self.nearest(&cups));
            return cup.ok_or_else(|| self.need(&cups, "I do not know where a mug is."));
        }
        if settled.intent == Intent::Print {
            return self.cartridge(phrase, role);
        }
        // `boil the water in the kettle`: the kettle, with what is in it.
        let vessel = phrase.relations.iter().find(|relation| relation.kind == RelationKind::Inside);
        let vessel = vessel.filter(|_| phrase.fluid.is_some()).map(|relation| &relation.to);
        if vessel.is_none()
            && settled.intent == Intent::Heat
            && phrase.fluid == Some(Fluid::Water)
            && let Some(boiler) = self.boiler()
        {
            return Ok(boiler);
        }
        let object = self.find_one(vessel.unwrap_or(phrase), &want, role)?;
        if !self.has(object, Property::Pickupable) && !Intent::BY_HAND.contains(&settled.intent) {
            let (verb, the) = (settled.intent.verb(), self.the(object));
            return Err(Fault::Cannot(format!("I cannot {verb} {the}: I cannot carry it.")));
        }
        Ok(object)
    }

    /// The cartridge that prints what was asked for.
    fn cartridge(&self, phrase: &Phrase, role: Option<Role>) -> Result<ObjectId, Fault> {
        let printed = phrase.namings.iter().flat_map(|naming| self.devices.cartridges(naming.class));
        let mut classes: Vec<ClassId> = printed.collect();
        let all = phrase.namings.iter().map(|naming| naming.class);
        // `print the hammer cartridge`: the cartridge itself was named.
        classes.extend(all.filter(|class| self.devices.printed_by(*class).is_some()));
        if phrase.namings.is_empty() {
            return self.find_one(phrase, &Want::object(Intent::Print), role);
        }
        self.nearest(&classes).ok_or_else(|| {
            let said = crate::read::saying::said(phrase);
            let it = prose::it(&said);
            self.need(&classes, format!("I do not know how to make {said}: I have seen no cartridge for {it}."))
        })
    }

    fn milk(&self) -> Option<ObjectId> {
        let filled = self.scene.objects.iter().filter(|object| object.fluid == Fluid::Milk);
        let carton = self.catalog.find("MilkCarton_01").and_then(|class| self.nearest(&[class]));
        carton.or_else(|| filled.map(|object| object.id).next())
    }

    fn processes(&self, intent: Intent, fluid: Option<Fluid>) -> impl Iterator<Item = &Process> {
        let fits = move |process: &&Process| {
            process.intent == intent && (fluid.is_none() || process.fluid.is_none() || process.fluid == fluid)
        };
        self.devices.processes.iter().filter(fits)
    }

    /// The device that was named, or the first that is known.
    fn choose_process(&self, settled: &Settled, object: ObjectId) -> Result<(Process, ObjectId), Fault> {
        let named = match (&settled.goal, &settled.tool) {
            (Some(Goal { place: Place::Object(phrase), role, .. }), _) => Some((phrase, *role)),
            (_, Some((phrase, role))) => Some((phrase, *role)),
            _ => None,
        };
        let Some((phrase, role)) = named else {
            return self.first_process(settled.intent, settled.fluid, object);
        };
        let processes: Vec<&Process> = self.processes(settled.intent, settled.fluid).collect();
        // `water the plant with the jug`: no tool of any kind, but whatever carries water.
        if processes.iter().any(|process| process.is_by_vessel()) {
            let (process, _) = self.first_process(settled.intent, settled.fluid, object)?;
            let want = Want::place(Intent::Use, &[Property::Fillable], None);
            return Ok((process, self.find_one(phrase, &want, Some(role))?));
        }
        let classes: Vec<ClassId> =
            processes.iter().flat_map(|process| process.at.iter().chain(&process.also)).copied().collect();
        let want = Want { classes: &classes, ..Want::place(Intent::Use, &[], None) };
        let device = self.find_one(phrase, &want, Some(role)).or_else(|fault| self.nearest_alike(fault))?;
        let class = self.scene.object(device).map(|known| known.class).unwrap_or_default();
        let verb = settled.intent.verb();
        let cannot = || Fault::Cannot(format!("I cannot {verb} things with {}.", self.the(device)));
        let process = processes.into_iter().find(|process| process.is_done_at(class)).ok_or_else(cannot)?;
        let place = if process.at.contains(&class) { Some(device) } else { self.nearest(&process.at) };
        match (place, cannot()) {
            (Some(place), _) => Ok((process.clone(), place)),
            (None, Fault::Cannot(text)) => Err(self.need(&process.at, text)),
            (None, fault) => Err(fault),
        }
    }

    /// Of several devices of a kind any will do.
    fn nearest_alike(&self, fault: Fault) -> Result<ObjectId, Fault> {
        let Fault::Miss { miss: Miss::Several(candidates), .. } = &fault else { return Err(fault) };
        let known = || candidates.iter().filter_map(|id| self.scene.object(*id));
        let class = known().next().map(|object| object.class);
        let is_alike = known().all(|object| Some(object.class) == class);
        self.nearest_of(known()).filter(|_| is_alike).ok_or(fault)
    }

    fn first_process(
        &self,
        intent: Intent,
        fluid: Option<Fluid>,
        object: ObjectId,
    ) -> Result<(Process, ObjectId), Fault> {
        let class = self.scene.object(object).map(|known| known.class).unwrap_or_default();
        let all: Vec<&Process> = self.processes(intent, fluid).collect();
        let fits = |process: &&Process| process.is_for(class) && self.takes(process, class);
        let mut fitting: Vec<&Process> = all.iter().copied().filter(fits).collect();
        fitting.sort_by_key(|process| (!process.at.is_empty(), !process.suits.contains(&class)));
        if fitting.is_empty() && !all.is_empty() {
            return Err(Fault::Cannot(self.misfit(&all, intent, object)));
        }
        let place = |process: &Process| match process.at.as_slice() {
            [] => Some(object),
            places => self.nearest(places),
        };
        let mut known = fitting.iter().filter_map(|process| Some(((*process).clone(), place(process)?)));
        known.next().ok_or_else(|| {
            let classes: Vec<ClassId> = fitting.iter().flat_map(|process| process.at.clone()).collect();
            self.need(&classes, format!("I do not know of anything here to {} it with.", intent.verb()))
        })
    }

    /// That something cannot be done to a thing, and why: what the machine for it takes alone, and that a slice of the thing is such.
    fn misfit(&self, all: &[&Process], intent: Intent, object: ObjectId) -> String {
        let (verb, the) = (intent.verb(), self.the(object));
        let places = all.iter().filter(|process| process.steps.contains(&Act::Place)).flat_map(|process| &process.at);
        let mut keyed = places.filter_map(|place| {
            let keys = &self.catalog.class(*place).receptacle.as_ref()?.keys;
            let mut keys: Vec<ClassId> = keys.iter().filter_map(|key| self.catalog.find(key)).collect();
            keys.dedup();
            Some((self.nearest(&[*place])?, keys)).filter(|(_, keys)| !keys.is_empty())
        });
        let Some((machine, keys)) = keyed.next() else { return format!("I cannot {verb} {the}.") };
        let names: Vec<String> = keys.iter().map(|key| prose::plural(&describe::name(self.catalog, *key))).collect();
        let why = format!("I cannot {verb} {the}: {} takes only {}.", self.the(machine), prose::list(&names, "and"));
        let class = self.scene.object(object).map(|known| known.class).unwrap_or_default();
        let slice =
            self.catalog.table().slice(&self.catalog.class(class).id).and_then(|slice| self.catalog.find(slice));
        match slice.filter(|slice| keys.contains(slice)) {
            Some(_) => format!("{why} Tell me to cut {}, and I can {verb} a slice of it.", prose::it(&the)),
            None => why,
        }
    }

    /// Ways in which things bring something about in themselves, as a kettle boils its water.
    pub(crate) fn in_itself(&self, intent: Intent) -> impl Iterator<Item = &Process> {
        self.processes(intent, None).filter(|process| process.at.is_empty())
    }

    /// What boils water, for `boil some water`, where nothing that can be carried has any in it yet.
    fn boiler(&self) -> Option<ObjectId> {
        let has_water = |known: &KnownObject| known.fluid == Fluid::Water && self.has(known.id, Property::Pickupable);
        if self.scene.objects.iter().any(has_water) {
            return None;
        }
        let boilers: Vec<ClassId> = self.in_itself(Intent::Tea).flat_map(|process| process.of.clone()).collect();
        self.nearest(&boilers)
    }

    /// Has a kettle boil its water.
    pub(crate) fn boil(&mut self, kettle: ObjectId) -> Result<(), Fault> {
        let class = self.scene.object(kettle).map(|known| known.class).unwrap_or_default();
        let process = self.in_itself(Intent::Tea).find(|process| process.is_for(class)).cloned();
        process.map_or(Ok(()), |process| self.carry_out(&process, kettle, kettle, None))
    }

    /// Whether what a thing is put into for it takes such things: a toaster takes bread alone.
    fn takes(&self, process: &Process, class: ClassId) -> bool {
        let (table, thing) = (self.catalog.table(), self.catalog.class(class));
        let takes = |place: &ClassId| table.affords(ActionKind::Place, self.catalog.class(*place), Some(thing));
        !process.steps.contains(&Act::Place) || process.at.iter().any(takes)
    }

    /// Fills something with `fluid` wherever that is done.
    pub(crate) fn fill(&mut self, vessel: ObjectId, fluid: Fluid) -> Result<(), Fault> {
        let (process, place) = self.first_process(Intent::Fill, Some(fluid), vessel)?;
        self.carry_out(&process, vessel, place, None)
    }

    fn carry_out(
        &mut self,
        process: &Process,
        object: ObjectId,
        place: ObjectId,
        color: Option<&str>,
    ) -> Result<(), Fault> {
        // What hangs somewhere and is wet is hung up again: it dries as it is hung up.
        let is_hung = process.steps == [Act::Hold, Act::Place];
        let is_inside = !is_hung && self.scene.object(object).is_some_and(|known| known.parent == Some(place));
        let mut runs_for_it = false;
        for act in &process.steps {
            match act {
                // What is in the device already stays there, unless it must be in the hand for what follows.
                Act::Hold if is_inside && process.steps.contains(&Act::Place) => {}
                Act::Hold => self.hold(object)?,
                Act::Place if is_inside => {}
                Act::Place => self.place_on(place),
                Act::Open => self.open_quietly(place),
                Act::Close => self.close_quietly(place),
                Act::Start => self.start(process, place, color)?,
                Act::Run => runs_for_it = self.run_water(place),
                // What lies before a ray, and was not put there for it, stays.
                Act::Take if is_inside && !self.has(place, Property::Openable) => {}
                Act::Take => self.take(object),
                Act::Fill => self.interact(Verb::Fill, place, "filling it at"),
                Act::Clean => self.interact(Verb::Clean, place, "washing it in"),
                Act::FillFirst => self.fill_first(object)?,
                Act::Tool => self.hold(place)?,
                Act::Vessel(fluid) => {
                    let named = Some(place).filter(|place| *place != object);
                    self.hold_vessel(*fluid, named, &process.of)?;
                }
                Act::Do(verb) => {
                    self.open_around(object, false);
                    self.interact(*verb, object, process.intent.doing());
                }
                Act::Rest => {
                    self.turn_off_again(place);
                    // What it was done to is spoken of, not the tool.
                    self.focus.mention(object);
                }
                // What ran before is left running.
                Act::RunNoMore if runs_for_it => {
                    self.turn_off_again(place);
                    self.focus.mention(object);
                }
                Act::RunNoMore => {}
            }
        }
        Ok(())
    }

    /// A kettle boils nothing while it is empty: the wish to run it implies filling it.
    pub(super) fn fill_to_run(&mut self, machine: ObjectId) -> Result<(), Fault> {
        let Some(known) = self.scene.object(machine).filter(|known| known.fluid == Fluid::None) else { return Ok(()) };
        let is_filled_for_it =
            |process: &Process| process.steps.contains(&Act::FillFirst) && process.of.contains(&known.class);
        if self.devices.processes.iter().any(is_filled_for_it) {
            let the = self.the(machine);
            self.fill_first(machine)?;
            self.notes.push(format!("{the} is empty, so I fill it first"));
        }
        Ok(())
    }

    /// Fills what is empty, and puts it back where it was.
    pub(super) fn fill_first(&mut self, object: ObjectId) -> Result<(), Fault> {
        if self.scene.object(object).is_none_or(|known| known.fluid != Fluid::None) {
            return Ok(());
        }
        let stood_on = self.taken_from(object);
        self.fill(object, Fluid::Water)?;
        stood_on.into_iter().for_each(|place| self.place_on(place));
        Ok(())
    }

    fn open_quietly(&mut self, place: ObjectId) {
        if self.is_shut(place) {
            self.interact(Verb::Open, place, "opening");
        }
    }

    fn close_quietly(&mut self, place: ObjectId) {
        let is_open = self.scene.object(place).is_some_and(|known| known.has(StateFlag::Opened));
        if is_open {
            self.interact(Verb::Close, place, "closing");
        }
    }

    fn take(&mut self, object: ObjectId) {
        let says = format!("taking {}", self.the(object));
        self.push(Action::PickUp { object }, says);
    }

    /// Lets the water run, if it does not run yet; whether that was to be done.
    fn run_water(&mut self, sink: ObjectId) -> bool {
        let runs = self.scene.object(sink).is_some_and(|known| known.has(StateFlag::Toggled));
        if !runs {
            self.interact(Verb::Toggle, sink, "turning on");
        }
        !runs
    }

    fn start(&mut self, process: &Process, place: ObjectId, color: Option<&str>) -> Result<(), Fault> {
        if let Some(color) = color {
            let class: Vec<ClassId> = self.devices.button(color).into_iter().collect();
            let button = self.nearest(&class).ok_or_else(|| {
                let text = format!("I cannot make things {color}: the colour changer has red, green and blue.");
                self.need(&class, text)
            })?;
            self.interact(Verb::Toggle, button, "pressing");
            return Ok(());
        }
        if !process.start.is_empty() && self.may_find(&process.start) {
            return Err(self.need(&process.start, format!("I do not know what works {}.", self.the(place))));
        }
        let starter = if process.start.is_empty() { Some(place) } else { self.nearest(&process.start) };
        self.interact(Verb::Toggle, starter.unwrap_or(place), "turning on");
        Ok(())
    }
}

impl Process {
    fn is_for(&self, class: ClassId) -> bool {
        self.of.is_empty() || self.of.contains(&class)
    }

    /// Whether it is done with whatever has something in it.
    fn is_by_vessel(&self) -> bool {
        self.steps.iter().any(|act| matches!(act, Act::Vessel(_)))
    }

    pub(super) fn is_done_at(&self, class: ClassId) -> bool {
        self.at.contains(&class) || self.also.contains(&class) || self.start.contains(&class)
    }
}
