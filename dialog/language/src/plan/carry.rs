//! Plans with the hand: picking up, putting somewhere, throwing.

use cohabit_cdf::{Action, ClassId, ObjectClass, ObjectId, Property, RoomId, Verb};

use crate::{
    ground::want::Want,
    known::{KnownObject, vending},
    plan::{
        Fault, Planner,
        settle::{Goal, Settled},
    },
    read::{
        phrase::{Phrase, Place},
        slot::Role,
    },
    understanding::Step,
    words::{
        intent::Intent,
        lexicon::{Naming, Preposition},
    },
};

/// The least area that is a place to put things down, m².
const TABLE_M2: f32 = 0.15;

/// What is said where something is to be put on the floor.
const NOT_ON_FLOOR: &str = "I cannot put things on the floor, only on or into something.";

/// What can take an object: a receptacle, or something to pour into.
pub(crate) const TAKES: &[Property] = &[Property::Receptacle, Property::Fillable];

impl Planner<'_> {
    pub(crate) fn add_pick_up(&mut self, settled: &Settled) -> Result<(), Fault> {
        if self.is_several(settled) {
            return self.one_at_a_time(settled);
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

    /// There is but one hand: of several that can be carried it says so, and offers the first of them.
    fn one_at_a_time(&mut self, settled: &Settled) -> Result<(), Fault> {
        let found = self.find_objects(settled, &Want::object(settled.intent))?;
        let named = found.len();
        let carried = self.carried(found)?;
        if let [only] = carried[..]
            && named > 1
        {
            return self.pick_up(only, self.may_put_down);
        }
        let Some(first) = carried.into_iter().find(|id| self.scene.robot.held != Some(*id)) else {
            return Err(Fault::Cannot("I can only carry one thing at a time.".to_owned()));
        };
        let offer = format!("I can only carry one thing at a time. Shall I begin with {}?", self.the(first));
        let left_out = self.why_left_out(Vec::new()).map(|why| format!("{why} ")).unwrap_or_default();
        self.pick_up(first, true)?;
        Err(Fault::Offer { text: format!("{left_out}{offer}"), steps: std::mem::take(&mut self.steps) })
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
                return Err(self.not_carried(&[object]));
            }
            Some(held) if !may_put_down => return Err(Fault::HandFull { held, wanted: object }),
            Some(held) => {
                self.notes.push(format!("I put {} down first", self.the(held)));
                self.put_down(Some(object))?;
            }
            None => {}
        }
        self.bring_out(object);
        self.open_around(object, false);
        let says = format!("picking up {}", self.the(object));
        self.push(Action::PickUp { object }, says);
        Ok(())
    }

    /// What stands behind the glass of a vending machine no hand gets at: its button brings it out.
    fn bring_out(&mut self, object: ObjectId) {
        let thing = self.scene.object(object);
        let button = thing.and_then(|thing| vending::button_for(self.catalog, &self.scene, thing));
        if let Some(button) = button.map(|button| button.id) {
            self.notes.push(format!("{} is behind the glass, so I press its button first", self.the(object)));
            self.interact(Verb::Toggle, button, "pressing");
        }
    }

    /// Holds the object for what comes next, without a word if it is in the hand already.
    pub(crate) fn hold(&mut self, object: ObjectId) -> Result<(), Fault> {
        if self.scene.robot.held == Some(object) { Ok(()) } else { self.pick_up(object, true) }
    }

    /// Puts what is held on the best surface near by.
    pub(crate) fn put_down(&mut self, beside: Option<ObjectId>) -> Result<(), Fault> {
        let Some(surface) = self.surface(beside, None) else {
            let tables: Vec<ClassId> = self.classes(|class| is_table(self.catalog.class(class)));
            return Err(self.need(&tables, "I see no place where I could put this down."));
        };
        self.place_on(surface);
        Ok(())
    }

    pub(crate) fn place_on(&mut self, receptacle: ObjectId) {
        self.place_beside(receptacle, None);
    }

    pub(crate) fn preposition(&self, receptacle: ObjectId) -> &'static str {
        crate::known::describe::preposition(self.catalog, &self.scene, receptacle)
    }

    /// What a thing is to be put into that nobody said where: what takes only such things, or else what was spoken of.
    fn made_for(&self, object: ObjectId) -> Option<ObjectId> {
        let id = &self.catalog.class(self.scene.object(object)?.class).id;
        let keys = |class: &ObjectClass| class.receptacle.as_ref().is_some_and(|kind| kind.keys.contains(id));
        let keyed = self.classes(|class| keys(self.catalog.class(class)));
        let spoken = self.focus.place.filter(|place| self.has(*place, Property::Receptacle) && *place != object);
        self.nearest(&keyed).or(spoken)
    }

    /// A table, desk or counter with room left, other than `except`: where `beside` stands, or else the nearest.
    pub(crate) fn surface(&self, beside: Option<ObjectId>, except: Option<ObjectId>) -> Option<ObjectId> {
        let stands_on = beside.and_then(|id| self.scene.object(id)).and_then(|object| object.parent);
        let fits: Vec<&KnownObject> =
            self.scene.objects.iter().filter(|object| self.is_table(object) && Some(object.id) != except).collect();
        let cost = |object: &KnownObject| {
            let elsewhere = if object.room == self.scene.robot.room { 0.0 } else { 100.0 };
            let known_place = if Some(object.id) == stands_on { -2.0 } else { 0.0 };
            self.scene.distance_m(object) + elsewhere + known_place
        };
        fits.into_iter().min_by(|a, b| cost(a).total_cmp(&cost(b)).then(a.id.cmp(&b.id))).map(|object| object.id)
    }

    pub(super) fn is_table(&self, object: &KnownObject) -> bool {
        is_table(self.catalog.class(object.class)) && self.has_room(object)
    }

    /// Whether there is a place left in or on it.
    pub(crate) fn has_room(&self, object: &KnownObject) -> bool {
        let surfaces = self.catalog.class(object.class).receptacle.iter().flat_map(|receptacle| &receptacle.surfaces);
        let anchors: u32 = surfaces.map(|surface| surface.anchors[0] * surface.anchors[1]).sum();
        u32::try_from(self.scene.contents(object.id).count()).is_ok_and(|taken| taken < anchors)
    }

    /// The classes of the catalogue for which `fits` holds.
    pub(super) fn classes(&self, fits: impl Fn(ClassId) -> bool) -> Vec<ClassId> {
        (0..).map(ClassId).take(self.catalog.classes().len()).filter(|class| fits(*class)).collect()
    }

    pub(crate) fn add_place(&mut self, settled: &Settled) -> Result<(), Fault> {
        let held = self.scene.robot.held;
        let is_held =
            |phrase: &Phrase| held.is_some() && self.ground().one(phrase, &Want::object(settled.intent)).ok() == held;
        // `leave the apple`, `bring the mug but leave the apple`
        if settled.is_left
            && settled.goal.is_none()
            && !settled.objects.is_empty()
            && !settled.objects.iter().any(is_held)
        {
            self.notes.push("I leave that as it is".to_owned());
            return Ok(());
        }
        if self.is_several(settled) {
            return self.add_places(settled);
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
            None if settled.is_back => self.put_where_it_was(object),
            None if settled.is_stored => self.put_away(&[object]),
            None if settled.intent == Intent::Bring => {
                let is_held = self.scene.robot.held == Some(object);
                let here = self.scene.robot.room;
                let is_elsewhere = self.scene.object(object).is_some_and(|known| known.room != here);
                self.pick_up(object, self.may_put_down)?;
                let says = format!("bringing you {}", self.the(object));
                // Where nobody is seen, it is brought to where the robot was asked for it.
                let comes_back = is_held || is_elsewhere;
                if !self.go_to_person(&says) && comes_back && self.go_back().is_ok() && is_held {
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
        let found = self.find_objects(settled, &want)?;
        let objects = self.carried(found)?;
        // `put them back`: each where it was taken from.
        if settled.is_back && settled.goal.is_none() {
            return objects.into_iter().try_for_each(|object| self.put_where_it_was(object));
        }
        if settled.is_stored && settled.goal.is_none() {
            self.ask_what_is_cleared(settled)?;
            return self.put_away(&objects);
        }
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
        let puts_down = |step: &Step| {
            step.action.receptacle().is_some() || matches!(step.action, Action::Interact { verb: Verb::Throw, .. })
        };
        self.scene.robot.held.is_none() && self.steps.iter().any(puts_down)
    }

    /// That there is nothing to put down: now, or once this plan has come so far.
    fn empty_handed(&self) -> Fault {
        let text =
            if self.has_put_down() { "I will not be holding anything then." } else { "I am not holding anything." };
        Fault::Cannot(text.to_owned())
    }

    fn place_at(&mut self, object: ObjectId, goal: &Goal, settled: &Settled) -> Result<(), Fault> {
        // Where it would go is not worth looking for.
        if !self.has(object, Property::Pickupable) {
            return Err(self.not_carried(&[object]));
        }
        match &goal.place {
            Place::Object(phrase) if phrase.is_floor => self.offer_surface(object),
            Place::Object(phrase) => {
                let (target, beside) = self.find_target(phrase, goal, object, settled)?;
                let is_of_all = settled.objects.iter().any(|phrase| phrase.is_all);
                if self.is_put_there(object, target, beside, is_of_all) {
                    return Ok(());
                }
                if target == object && self.scene.robot.held == Some(object) {
                    // `place on plate`, of the plate: where it is to go was left out.
                    return self.put_down(None);
                }
                if target == object {
                    return Err(Fault::Cannot(format!("I cannot put {} on itself.", self.the(object))));
                }
                if beside.is_none() && !self.has(target, Property::Receptacle) && self.has(target, Property::Fillable) {
                    return self.pour(object, target);
                }
                self.hold(object)?;
                // What was in the hand stands somewhere now.
                let stand = beside.filter(|other| *other == target).and_then(|other| self.stand_of(other, object));
                let target = stand.unwrap_or(target);
                self.place_beside(target, beside.filter(|other| *other != target));
                Ok(())
            }
            Place::Room(room) if !self.scene.may_have_room(room.id) => {
                Err(Fault::Cannot(format!("There is no {} here.", room.name)))
            }
            Place::Room(room) | Place::Viewpoint(room, _) => self.bring_to_room(object, room.id, settled.intent),
            Place::Here | Place::Side(_) | Place::Viewpoints(_) => {
                self.hold(object)?;
                self.put_down(None)
            }
        }
    }

    /// `put it on the floor`: no action does that, so the nearest surface is offered instead.
    fn offer_surface(&mut self, object: ObjectId) -> Result<(), Fault> {
        if self.scene.object(object).is_some_and(|known| self.scene.is_on_floor(known)) {
            self.notes.push(format!("{} is on the floor already", self.the(object)));
            return Ok(());
        }
        let stands_on = self.scene.object(object).and_then(|known| known.parent);
        let Some(surface) = self.surface(None, stands_on) else {
            return Err(Fault::Cannot(NOT_ON_FLOOR.to_owned()));
        };
        let (the, place) = (self.the(object), self.the(surface));
        let offer = format!("{NOT_ON_FLOOR} Shall I put {the} {} {place}?", self.preposition(surface));
        self.hold(object)?;
        self.place_on(surface);
        Err(Fault::Offer { text: offer, steps: std::mem::take(&mut self.steps) })
    }

    fn bring_to_room(&mut self, object: ObjectId, room: RoomId, intent: Intent) -> Result<(), Fault> {
        self.hold(object)?;
        self.go_to_room(room);
        if intent == Intent::Bring { Ok(()) } else { self.put_down(None) }
    }

    /// What a thing is on or in, or was when it was taken.
    pub(crate) fn taken_from(&self, object: ObjectId) -> Option<ObjectId> {
        if self.scene.robot.held != Some(object) {
            return self.scene.object(object)?.parent;
        }
        self.focus.origins.iter().find(|(taken, _)| *taken == object).map(|(_, origin)| *origin)
    }

    /// The nearest object of these classes: of the first class that is known at all in this room, then anywhere.
    pub(crate) fn nearest(&self, classes: &[cohabit_cdf::ClassId]) -> Option<ObjectId> {
        let of_class = |class: &cohabit_cdf::ClassId| {
            self.nearest_of(self.scene.objects.iter().filter(|object| object.class == *class))
        };
        classes.iter().find_map(of_class)
    }

    /// The nearest of these; what is in another room is further than all here.
    pub(crate) fn nearest_of<'k>(&self, objects: impl Iterator<Item = &'k KnownObject>) -> Option<ObjectId> {
        let way_m = |object: &KnownObject| {
            let elsewhere = if object.room == self.scene.robot.room { 0.0 } else { 100.0 };
            self.scene.distance_m(object) + elsewhere
        };
        let nearest = objects.min_by(|a, b| way_m(a).total_cmp(&way_m(b)).then(a.id.cmp(&b.id)));
        nearest.map(|object| object.id)
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
            let found = self.find_objects(settled, &want)?;
            return self.carried(found)?.into_iter().try_for_each(|object| self.throw_away(object));
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

    /// `throw away the donut on the table`: where it lies; but what is thrown into another bin goes there.
    pub(crate) fn add_discard(&mut self, settled: &Settled) -> Result<(), Fault> {
        let bin = settled.goal.as_ref().and_then(|goal| {
            let Place::Object(phrase) = &goal.place else { return None };
            let target = self.find_one(phrase, &Want::place(settled.intent, &[], None), Some(goal.role)).ok()?;
            self.scene.object(target).filter(|known| self.devices.bins.contains(&known.class))
        });
        match bin {
            Some(_) => self.add_throw(settled),
            None => {
                let settled = settled.without_goal(self);
                self.add_throw(&settled)
            }
        }
    }

    fn throw_away(&mut self, object: ObjectId) -> Result<(), Fault> {
        let bins = &self.devices.bins;
        let Some(bin) = self.nearest(bins) else {
            return Err(self.need(bins, format!("Tell me what to throw {} at.", self.the(object))));
        };
        self.hold(object)?;
        self.place_on(bin);
        Ok(())
    }
}

/// A table, desk or counter: open, of some size, and no machine.
pub(super) fn is_table(class: &ObjectClass) -> bool {
    let is_machine = [Property::Pickupable, Property::Toggleable, Property::Powerable, Property::Openable]
        .into_iter()
        .any(|property| class.has(property));
    let Some(receptacle) = class.receptacle.as_ref().filter(|_| !is_machine && class.has(Property::Receptacle)) else {
        return false;
    };
    let area: f32 = receptacle.surfaces.iter().map(|surface| surface.size_m[0] * surface.size_m[1]).sum();
    !receptacle.enclosed && receptacle.keys.is_empty() && area > TABLE_M2
}
