//! Plans with the hand: picking up, putting somewhere, pouring, throwing, breaking.

use cohabit_cdf::{Action, ClassId, Fluid, ObjectClass, ObjectId, Property, RoomId, StateFlag, Verb};

use crate::{
    context::Role,
    ground::{Miss, Want},
    intent::Intent,
    known::KnownObject,
    lexicon::{Naming, Preposition, Pronoun},
    phrase::{Phrase, Place, RelationKind},
    plan::{Fault, Planner},
    settle::{Goal, Settled},
    understanding::Step,
};

/// The least area that is a place to put things down, m².
const TABLE_M2: f32 = 0.15;

/// What can take an object: a receptacle, or something to pour into.
const TAKES: &[Property] = &[Property::Receptacle, Property::Fillable];

/// What is poured though it holds nothing.
const CEREAL: &str = "Cereal_Box_01";

impl Planner<'_> {
    pub(crate) fn add_pick_up(&mut self, settled: &Settled) -> Result<(), Fault> {
        if self.is_several(settled) {
            return Err(self.one_at_a_time(settled)?);
        }
        for object in self.find_objects(settled, &Want::object(settled.intent))? {
            // `I want some light`
            if settled.is_wish && !self.has(object, Property::Pickupable) && self.has(object, Property::Toggleable) {
                self.switch(object, Intent::TurnOn)?;
                continue;
            }
            self.pick_up(object, self.may_put_down)?;
        }
        Ok(())
    }

    /// The kind of what the thing in the hand was taken from.
    pub(crate) fn origin_kind(&self) -> Vec<Naming> {
        let origin = self.focus.origins.first().map(|(_, origin)| *origin);
        self.kind_of(origin)
    }

    /// The kind of what a thing is on or in.
    pub(crate) fn place_kind(&self, phrase: &Phrase, intent: Intent) -> Vec<Naming> {
        let thing = self.ground().one(phrase, &Want::object(intent)).ok();
        self.kind_of(thing.and_then(|id| self.scene.object(id)?.parent))
    }

    fn kind_of(&self, id: Option<ObjectId>) -> Vec<Naming> {
        let class = id.and_then(|id| self.scene.object(id)).map(|object| object.class);
        class.map_or_else(Vec::new, |class| self.of_kind(&[Naming { class, weight: 1.0 }]))
    }

    /// All classes that have the same name as one of these: of the green desk, all desks.
    pub(crate) fn of_kind(&self, namings: &[Naming]) -> Vec<Naming> {
        let names: Vec<&String> = namings.iter().map(|naming| &self.catalog.class(naming.class).name).collect();
        let same = self.classes(|class| names.contains(&&self.catalog.class(class).name));
        same.into_iter().map(|class| Naming { class, weight: 1.0 }).collect()
    }

    /// There is but one hand: says so, and offers the first of them.
    fn one_at_a_time(&mut self, settled: &Settled) -> Result<Fault, Fault> {
        let found = self.find_objects(settled, &Want::object(settled.intent))?;
        let Some(first) = found.into_iter().find(|id| self.scene.robot.held != Some(*id)) else {
            return Ok(Fault::Cannot("I can only carry one thing at a time.".to_owned()));
        };
        let text = format!("I can only carry one thing at a time. Shall I begin with {}?", self.the(first));
        self.pick_up(first, true)?;
        Ok(Fault::Offer { text, steps: std::mem::take(&mut self.steps) })
    }

    /// Has the object in the hand; what is held is put down first if it may be.
    pub(crate) fn pick_up(&mut self, object: ObjectId, may_put_down: bool) -> Result<(), Fault> {
        match self.scene.robot.held {
            Some(held) if held == object => {
                // What it takes for a request before this one goes without saying.
                if self.steps.is_empty() {
                    self.notes.push(format!("I already have {}", self.the(object)));
                }
                return Ok(());
            }
            _ if !self.has(object, Property::Pickupable) => {
                return Err(Fault::Cannot(format!("I cannot pick up {}.", self.the(object))));
            }
            Some(held) if !may_put_down => return Err(Fault::HandFull { held, wanted: object }),
            Some(held) => {
                self.notes.push(format!("I put {} down first", self.the(held)));
                self.put_down(Some(object))?;
            }
            None => {}
        }
        self.open_around(object, false);
        let says = format!("picking up {}", self.the(object));
        self.push(Action::PickUp { object }, says);
        Ok(())
    }

    /// Holds the object for what comes next, without a word if it is in the hand already.
    pub(crate) fn hold(&mut self, object: ObjectId) -> Result<(), Fault> {
        if self.scene.robot.held == Some(object) { Ok(()) } else { self.pick_up(object, true) }
    }

    /// Puts what is held on the best surface near by.
    pub(crate) fn put_down(&mut self, beside: Option<ObjectId>) -> Result<(), Fault> {
        let Some(surface) = self.surface(beside) else {
            let tables: Vec<ClassId> = self.classes(|class| is_table(self.catalog.class(class)));
            return Err(self.need(&tables, "I see no place where I could put this down."));
        };
        self.place_on(surface);
        Ok(())
    }

    pub(crate) fn place_on(&mut self, receptacle: ObjectId) {
        self.open_around(receptacle, true);
        let held = self.scene.robot.held.map_or_else(|| "it".to_owned(), |held| self.the(held));
        let says = format!("putting {held} {} {}", self.preposition(receptacle), self.the(receptacle));
        self.push(Action::Place { receptacle }, says);
    }

    pub(crate) fn preposition(&self, receptacle: ObjectId) -> &'static str {
        crate::describe::preposition(self.catalog, &self.scene, receptacle)
    }

    /// What a thing is to be put into that nobody said where: what takes only such things, or else what was spoken of.
    fn made_for(&self, object: ObjectId) -> Option<ObjectId> {
        let id = &self.catalog.class(self.scene.object(object)?.class).id;
        let keys = |class: &ObjectClass| class.receptacle.as_ref().is_some_and(|kind| kind.keys.contains(id));
        let keyed = self.classes(|class| keys(self.catalog.class(class)));
        let spoken = self.focus.place.filter(|place| self.has(*place, Property::Receptacle) && *place != object);
        self.nearest(&keyed).or(spoken)
    }

    /// A table, desk or counter with room left: where `beside` stands, or else the nearest.
    fn surface(&self, beside: Option<ObjectId>) -> Option<ObjectId> {
        let stands_on = beside.and_then(|id| self.scene.object(id)).and_then(|object| object.parent);
        let fits: Vec<&KnownObject> = self.scene.objects.iter().filter(|object| self.is_table(object)).collect();
        let cost = |object: &KnownObject| {
            let elsewhere = if object.room == self.scene.robot.room { 0.0 } else { 100.0 };
            let known_place = if Some(object.id) == stands_on { -2.0 } else { 0.0 };
            self.scene.distance_m(object) + elsewhere + known_place
        };
        fits.into_iter().min_by(|a, b| cost(a).total_cmp(&cost(b)).then(a.id.cmp(&b.id))).map(|object| object.id)
    }

    fn is_table(&self, object: &KnownObject) -> bool {
        let class = self.catalog.class(object.class);
        let surfaces = class.receptacle.iter().flat_map(|receptacle| &receptacle.surfaces);
        let anchors: u32 = surfaces.map(|surface| surface.anchors[0] * surface.anchors[1]).sum();
        let taken = self.scene.contents(object.id).count();
        is_table(class) && u32::try_from(taken).is_ok_and(|taken| taken < anchors)
    }

    /// The classes of the catalogue for which `fits` holds.
    fn classes(&self, fits: impl Fn(ClassId) -> bool) -> Vec<ClassId> {
        (0..).map(ClassId).take(self.catalog.classes().len()).filter(|class| fits(*class)).collect()
    }

    pub(crate) fn add_place(&mut self, settled: &Settled) -> Result<(), Fault> {
        if self.is_several(settled) {
            return self.add_places(settled);
        }
        // `leave the apple`
        if settled.is_left && settled.goal.is_none() && !settled.objects.is_empty() && self.scene.robot.held.is_none() {
            self.notes.push("I leave that as it is".to_owned());
            return Ok(());
        }
        let is_it = |phrase: &Phrase| phrase.pronoun.is_some();
        if settled.intent == Intent::Drop && self.scene.robot.held.is_none() && settled.objects.iter().all(is_it) {
            // `put it on the table, so that your hands are free`: they are, once that is done.
            return if self.has_put_down() { Ok(()) } else { Err(self.empty_handed()) };
        }
        let object = self.what_to_place(settled)?;
        // Taken before the goal is grounded: `put it on the table` means a table near where it is.
        let is_inserted = settled.is_inserted && settled.goal.is_none() && !settled.is_back;
        if let Some(place) = is_inserted.then(|| self.made_for(object)).flatten() {
            self.hold(object)?;
            self.place_on(place);
            return Ok(());
        }
        match &settled.goal {
            None if settled.is_back => self.put_back(object),
            None if settled.intent == Intent::Bring => {
                let is_held = self.scene.robot.held == Some(object);
                self.pick_up(object, self.may_put_down)?;
                let says = format!("bringing you {}", self.the(object));
                // Where nobody is seen, what is in the hand is brought to where the robot was asked to fetch it.
                if !self.go_to_person(&says) && is_held && self.go_back().is_ok() {
                    self.notes.pop();
                }
                Ok(())
            }
            None if self.scene.robot.held != Some(object) && settled.intent == Intent::Drop => {
                Err(Fault::Cannot(format!("I am not holding {}.", self.the(object))))
            }
            None => {
                self.hold(object)?;
                self.put_down(None)
            }
            Some(goal) => self.place_at(object, goal, settled),
        }
    }

    /// Several things one after the other, each carried to the same place.
    fn add_places(&mut self, settled: &Settled) -> Result<(), Fault> {
        let want = Want { held_first: false, ..Want::object(settled.intent) };
        let objects = self.find_objects(settled, &want)?;
        let Some(goal) = &settled.goal else {
            return Err(Fault::Cannot("I can only carry one thing at a time. Tell me where to put them.".to_owned()));
        };
        let before = self.steps.len();
        for object in objects {
            self.place_at(object, goal, settled)?;
        }
        if self.steps.len() == before {
            self.notes.push("all of that is there already".to_owned());
        }
        Ok(())
    }

    fn what_to_place(&self, settled: &Settled) -> Result<ObjectId, Fault> {
        if let Some(phrase) = settled.objects.first() {
            return self.find_one(phrase, &Want::object(settled.intent), Some(Role::Object(0)));
        }
        // `the milk, put on the counter`
        let spoken = self.focus.recent.first().copied().filter(|id| self.has(*id, Property::Pickupable));
        let meant = self.scene.robot.held.or(spoken);
        meant.ok_or_else(|| self.empty_handed())
    }

    /// Whether this plan empties the hand.
    fn has_put_down(&self) -> bool {
        let puts_down =
            |step: &Step| matches!(step.action, Action::Place { .. } | Action::Interact { verb: Verb::Throw, .. });
        self.scene.robot.held.is_none() && self.steps.iter().any(puts_down)
    }

    /// That there is nothing to put down: now, or once this plan has come so far.
    fn empty_handed(&self) -> Fault {
        let text =
            if self.has_put_down() { "I will not be holding anything then." } else { "I am not holding anything." };
        Fault::Cannot(text.to_owned())
    }

    fn place_at(&mut self, object: ObjectId, goal: &Goal, settled: &Settled) -> Result<(), Fault> {
        match &goal.place {
            Place::Object(phrase) => {
                let target = self.find_target(phrase, goal, object, settled)?;
                let is_there = self.scene.object(object).is_some_and(|known| known.parent == Some(target));
                // `bring it to the microwave and put it in` is one errand.
                let is_done = is_there
                    && self.steps.last().is_some_and(|step| step.action == Action::Place { receptacle: target });
                if is_done || is_there && settled.objects.iter().any(|phrase| phrase.is_all) {
                    return Ok(());
                }
                if target == object && self.scene.robot.held == Some(object) {
                    // `place on plate`, of the plate: where it is to go was left out.
                    return self.put_down(None);
                }
                if target == object {
                    return Err(Fault::Cannot(format!("I cannot put {} on itself.", self.the(object))));
                }
                if !self.has(target, Property::Receptacle) && self.has(target, Property::Fillable) {
                    return self.pour(object, target);
                }
                self.hold(object)?;
                self.place_on(target);
                Ok(())
            }
            Place::Room(room) | Place::Viewpoint(room, _) => self.bring_to_room(object, room.id, settled.intent),
            Place::Here | Place::Side(_) | Place::Viewpoints(_) => {
                self.hold(object)?;
                self.put_down(None)
            }
        }
    }

    fn bring_to_room(&mut self, object: ObjectId, room: RoomId, intent: Intent) -> Result<(), Fault> {
        self.hold(object)?;
        self.go_to_room(room);
        if intent == Intent::Bring { Ok(()) } else { self.put_down(None) }
    }

    /// Where to put it; `next to the lamp` is where the lamp stands.
    fn find_target(
        &self,
        phrase: &Phrase,
        goal: &Goal,
        object: ObjectId,
        settled: &Settled,
    ) -> Result<ObjectId, Fault> {
        let is_beside = matches!(goal.preposition, Preposition::Near | Preposition::LeftOf | Preposition::RightOf);
        let affordances: &[Property] = if is_beside { &[] } else { TAKES };
        // `on the counter` is its top, rather than one with doors.
        let open = match goal.preposition {
            Preposition::On => self.classes(|class| !self.catalog.class(class).has(Property::Openable)),
            _ => Vec::new(),
        };
        let origin = self.taken_from(object).filter(|_| !is_beside && !settled.is_back);
        let want = Want { classes: &open, origin, ..Want::place(settled.intent, affordances, Some(object)) };
        let target = self.find_one(phrase, &want, Some(goal.role))?;
        let parent = self.scene.object(target).and_then(|target| target.parent);
        Ok(parent.filter(|_| is_beside).unwrap_or(target))
    }

    /// What a thing is on or in, or was when it was taken.
    fn taken_from(&self, object: ObjectId) -> Option<ObjectId> {
        if self.scene.robot.held != Some(object) {
            return self.scene.object(object)?.parent;
        }
        self.focus.origins.iter().find(|(taken, _)| *taken == object).map(|(_, origin)| *origin)
    }

    pub(crate) fn add_pour(&mut self, settled: &Settled) -> Result<(), Fault> {
        let held = self.scene.robot.held;
        // `pour in the bowl`, of the milk in the hand
        let full = held.filter(|held| self.scene.object(*held).is_some_and(|held| held.fluid != Fluid::None));
        if let (Some(full), [phrase], None) = (full, settled.objects.as_slice(), &settled.goal)
            && phrase.pronoun.is_none()
            && phrase.fluid.is_none()
        {
            let want = Want::place(Intent::Use, &TAKES[1..], None);
            let target = self.find_one(phrase, &want, Some(Role::Object(0)))?;
            if target != full {
                return self.pour(full, target);
            }
        }
        let source = match settled.objects.first() {
            // `pour it`, `pour the milk`, `pour`: what is held, if it is that.
            Some(phrase) => self.find_one(phrase, &Want::object(Intent::Pour), Some(Role::Object(0)))?,
            None => held.ok_or_else(|| Fault::Cannot("I am not holding anything to pour.".to_owned()))?,
        };
        if !self.has(source, Property::Pickupable) {
            return Err(Fault::Cannot("I have nothing of that to pour. Tell me what to fill first.".to_owned()));
        }
        if !self.can_be_poured(source) {
            return Err(Fault::Cannot(format!("I cannot pour {}.", self.the(source))));
        }
        let target = match &settled.goal {
            Some(Goal { place: Place::Object(phrase), role, .. }) => self.vessel(phrase, *role, source)?,
            _ if settled.is_away => self.nearest_sink()?,
            _ => self.vessel_spoken_of(source)?,
        };
        self.pour(source, target)
    }

    /// What a phrase says to pour something into.
    fn vessel(&self, phrase: &Phrase, role: Role, source: ObjectId) -> Result<ObjectId, Fault> {
        // `pour it in there`: into what holds it, of all that was spoken of.
        let takes = if phrase.pronoun.is_some() { &TAKES[1..] } else { TAKES };
        let want = Want::place(Intent::Use, takes, Some(source));
        let found = self.find_one(phrase, &want, Some(role)).map(|target| self.vessel_with(target));
        // `over the cereal in the bowl`: what was poured is no thing any more, but what it is in is.
        let around = phrase.relations.iter().find(|relation| relation.kind == RelationKind::Inside);
        found.or_else(|fault| around.map_or(Err(fault), |around| self.find_one(&around.to, &want, Some(role))))
    }

    /// Whether there is anything to it that flows.
    fn can_be_poured(&self, source: ObjectId) -> bool {
        let is_cereal = |known: &KnownObject| Some(known.class) == self.catalog.find(CEREAL);
        self.has(source, Property::Fillable) || self.scene.object(source).is_some_and(is_cereal)
    }

    /// Whether it is empty, and of the kind of what it is to be poured into: `the bowl into the bowl`.
    fn is_empty_twin(&self, source: ObjectId, target: ObjectId) -> bool {
        let [source, target] = [source, target].map(|id| self.scene.object(id));
        source.zip(target).is_some_and(|(source, target)| source.class == target.class && source.fluid == Fluid::None)
    }

    /// Whether it can be filled, or lets what is poured into it run off.
    fn can_be_poured_into(&self, target: ObjectId) -> bool {
        let drains = |class| {
            self.devices.processes.iter().any(|process| process.intent == Intent::Clean && process.at.contains(&class))
        };
        self.has(target, Property::Fillable) || self.scene.object(target).is_some_and(|known| drains(known.class))
    }

    /// `over the cereal`: what that was poured into.
    fn vessel_with(&self, target: ObjectId) -> ObjectId {
        let is_vessel = TAKES.iter().any(|takes| self.has(target, *takes));
        let filled = self.scene.objects.iter().find(|object| object.has(StateFlag::Cereal));
        filled.filter(|_| !is_vessel).map_or(target, |filled| filled.id)
    }

    /// What was spoken of last that can be filled; a question, if nothing was.
    fn vessel_spoken_of(&self, source: ObjectId) -> Result<ObjectId, Fault> {
        let spoken = self.focus.place.iter().chain(&self.focus.recent).copied();
        let vessel = spoken
            .filter(|id| *id != source && self.has(*id, Property::Fillable))
            .find(|id| self.scene.object(*id).is_some_and(|object| object.fluid == Fluid::None));
        vessel.ok_or_else(|| self.miss(&Phrase::default(), Miss::NoReferent, Intent::Pour, Some(Role::Place(0))))
    }

    pub(crate) fn pour(&mut self, source: ObjectId, target: ObjectId) -> Result<(), Fault> {
        if source == target || !self.can_be_poured_into(target) {
            let (what, into) = (self.the(source), self.the(target));
            return Err(Fault::Cannot(format!("I cannot pour {what} into {into}.")));
        }
        if self.is_empty_twin(source, target) {
            return Err(Fault::Cannot(format!("There is nothing in {} to pour.", self.the(source))));
        }
        self.hold(source)?;
        self.open_around(target, false);
        let says = format!("pouring {} into {}", self.what_is_in(source), self.the(target));
        self.push(Action::Interact { verb: Verb::Pour, object: target }, says);
        Ok(())
    }

    /// What comes out of a thing that is poured: `the coffee`, `the cereal`.
    fn what_is_in(&self, source: ObjectId) -> String {
        let fluid = self.scene.object(source).map_or(Fluid::None, |object| object.fluid);
        let the = self.the(source);
        match fluid {
            Fluid::None => the.strip_suffix(" box").map_or(the.clone(), str::to_owned),
            fluid => format!("the {}", fluid.name().to_lowercase()),
        }
    }

    fn nearest_sink(&self) -> Result<ObjectId, Fault> {
        let sinks = self.devices.processes.iter().filter(|process| process.intent == Intent::Clean).flat_map(|p| &p.at);
        let classes: Vec<_> = sinks.copied().collect();
        self.nearest(&classes).ok_or_else(|| self.need(&classes, "Tell me what to pour it into."))
    }

    /// The nearest object of these classes: of the first class that is known at all in this room, then anywhere.
    pub(crate) fn nearest(&self, classes: &[cohabit_cdf::ClassId]) -> Option<ObjectId> {
        let cost = |object: &KnownObject| {
            let elsewhere = if object.room == self.scene.robot.room { 0.0 } else { 100.0 };
            self.scene.distance_m(object) + elsewhere
        };
        classes.iter().find_map(|class| {
            let same = self.scene.objects.iter().filter(|object| object.class == *class);
            same.min_by(|a, b| cost(a).total_cmp(&cost(b)).then(a.id.cmp(&b.id))).map(|object| object.id)
        })
    }

    pub(crate) fn add_throw(&mut self, settled: &Settled) -> Result<(), Fault> {
        let is_put = settled.goal.as_ref().is_some_and(|goal| {
            matches!(goal.place, Place::Object(_)) && matches!(goal.preposition, Preposition::In | Preposition::On)
        });
        if is_put && self.is_several(settled) {
            return self.add_places(settled);
        }
        if settled.goal.is_none() && self.is_several(settled) {
            let want = Want { held_first: false, ..Want::object(settled.intent) };
            let objects = self.find_objects(settled, &want)?;
            return objects.into_iter().try_for_each(|object| self.throw_away(object));
        }
        let object = self.what_to_place(settled)?;
        let Some(goal) = &settled.goal else {
            return self.throw_away(object);
        };
        let Place::Object(phrase) = &goal.place else { return self.place_at(object, goal, settled) };
        if matches!(goal.preposition, Preposition::In | Preposition::On) {
            return self.place_at(object, goal, settled);
        }
        let target = self.find_one(phrase, &Want::place(settled.intent, &[], Some(object)), Some(goal.role))?;
        self.hold(object)?;
        let says = format!("throwing {} at {}", self.the(object), self.the(target));
        self.push(Action::Interact { verb: Verb::Throw, object: target }, says);
        Ok(())
    }

    fn throw_away(&mut self, object: ObjectId) -> Result<(), Fault> {
        let bins: Vec<_> = ["TrashCan_01"].iter().filter_map(|id| self.catalog.find(id)).collect();
        let Some(bin) = self.nearest(&bins) else {
            return Err(self.need(&bins, format!("Tell me what to throw {} at.", self.the(object))));
        };
        self.hold(object)?;
        self.place_on(bin);
        Ok(())
    }

    pub(crate) fn add_break(&mut self, settled: &Settled) -> Result<(), Fault> {
        let objects = self.objects_to_break(settled)?;
        let tool = match &settled.tool {
            Some((phrase, role)) if phrase.pronoun != Some(Pronoun::Place) => {
                Some(self.find_one(phrase, &Want::place(Intent::Use, &[], None), Some(*role))?)
            }
            _ if self.may_find(&self.devices.hammers) => {
                return Err(self.need(&self.devices.hammers, "I need the hammer for that."));
            }
            _ => self.hammer(),
        };
        for object in objects {
            if let Some(tool) = tool.filter(|tool| *tool != object) {
                self.hold(tool)?;
            }
            self.open_around(object, false);
            self.interact(Verb::Break, object, "breaking");
        }
        Ok(())
    }

    /// What is to be broken. Who names a tool means to break it: the only thing that it may be is not asked about again.
    fn objects_to_break(&mut self, settled: &Settled) -> Result<Vec<ObjectId>, Fault> {
        let names_tool = settled.tool.as_ref().is_some_and(|(phrase, _)| !phrase.is_empty());
        match self.find_objects(settled, &Want::object(Intent::Break)) {
            Err(Fault::Miss { miss: Miss::Several(ids), .. }) if names_tool && ids.len() == 1 => Ok(ids),
            found => found,
        }
    }

    /// A hammer: the one in the hand, or the nearest.
    fn hammer(&self) -> Option<ObjectId> {
        let held = self.scene.robot.held.and_then(|held| self.scene.object(held));
        let held = held.filter(|held| self.devices.hammers.contains(&held.class)).map(|held| held.id);
        held.or_else(|| self.nearest(&self.devices.hammers))
    }
}

/// A table, desk or counter: open, of some size, and no machine.
fn is_table(class: &ObjectClass) -> bool {
    let is_machine = [Property::Pickupable, Property::Toggleable, Property::Powerable, Property::Openable]
        .into_iter()
        .any(|property| class.has(property));
    let Some(receptacle) = class.receptacle.as_ref().filter(|_| !is_machine && class.has(Property::Receptacle)) else {
        return false;
    };
    let area: f32 = receptacle.surfaces.iter().map(|surface| surface.size_m[0] * surface.size_m[1]).sum();
    !receptacle.enclosed && receptacle.keys.is_empty() && area > TABLE_M2
}
