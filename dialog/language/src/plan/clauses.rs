//! The steps of each clause.

use cohabit_cdf::{Action, ObjectId, Property, Verb, state::StateFlag};

use crate::{
    ground::want::{Miss, Want},
    known::{Known, describe},
    plan::{
        Fault, Planner,
        settle::{self, Settled},
    },
    read::{
        clause::Clause,
        phrase::{Phrase, Place},
        slot::{self, Role},
    },
    say::report,
    words::{
        intent::Intent,
        lexicon::{Manner, Preposition, Side},
        prose,
    },
};

/// Whether a clause is about what another one does something to, or does something to where that puts things: `put the bread in the toaster,
/// turn on the toaster`. To put two things in the same place is no such matter.
fn is_about_same(own: &Clause, other: &Clause) -> bool {
    let is_among = |phrase: &Phrase, others: &[&Phrase]| others.iter().any(|one| one.text == phrase.text);
    let (own_named, other_named) = (slot::named(own), slot::named(other));
    own.objects.iter().any(|phrase| is_among(phrase, &other_named))
        || other.objects.iter().any(|phrase| is_among(phrase, &own_named))
}

/// What falls with a clause that cannot be done: itself, and what comes after it and is about the same, or says `it` of that. Nothing, where
/// that cannot be told: then nothing of the request is done.
fn falls_with(clauses: &[Clause], index: usize) -> Option<Vec<usize>> {
    let own = &clauses[index];
    let says_it = |clause: &Clause| slot::named(clause).iter().any(|phrase| phrase.pronoun.is_some());
    let takes = |clause: &Clause| clause.intent == Intent::PickUp || clause.intent.is_about_held();
    if slot::named(own).is_empty() || says_it(own) || clauses[..index].iter().any(|clause| is_about_same(own, clause)) {
        return None;
    }
    let mut fallen = vec![index];
    for (at, clause) in clauses.iter().enumerate().skip(index + 1) {
        let goes_on = fallen.last() == Some(&(at - 1)) && (says_it(clause) || clause.is_means);
        if goes_on || is_about_same(own, clause) {
            fallen.push(at);
        } else if says_it(clause) && takes(clause) && !takes(&clauses[at - 1]) {
            // `take the plant, open the cupboard and put it in`: `it` may be what could not be taken.
            return None;
        }
    }
    Some(fallen)
}

impl Planner<'_> {
    /// Adds the steps of all clauses. Where one cannot be done, what has nothing to do with it is done all the same.
    pub(crate) fn run(&mut self, clauses: &[Clause]) -> Result<(), Fault> {
        let (mut impossible, mut fallen): (Vec<String>, Vec<usize>) = (Vec::new(), Vec::new());
        for (index, clause) in clauses.iter().enumerate() {
            if fallen.contains(&index) {
                continue;
            }
            self.clause = index;
            self.begun = (self.steps.len(), self.focus.clone());
            let falls = falls_with(clauses, index);
            let before = (clause.is_means || falls.is_some()).then(|| self.scene.clone());
            let fixed = self.fixed.len();
            match (self.add(clause), clauses.get(index + 1)) {
                // `take it, take the knife`: what was meant was said at once.
                (Err(Fault::Miss { miss: Miss::NoReferent, .. }), Some(next)) if next.intent == clause.intent => {}
                (Err(Fault::Cannot(why)), _) => {
                    // What cannot be carried is said of all such things together.
                    if self.fixed.len() == fixed || why != self.why_not_carried(&self.fixed[fixed..]) {
                        impossible.push(why);
                    }
                    let Some(falls) = falls else {
                        return Err(self.impossible(impossible, &clauses[index + 1..]));
                    };
                    self.take_back_to(self.begun.0);
                    self.focus = self.begun.1.clone();
                    before.into_iter().for_each(|scene| self.scene = scene);
                    fallen.extend(falls);
                    continue;
                }
                (result, _) => result?,
            }
            before.filter(|_| clause.is_means).into_iter().for_each(|scene| self.drop_known_means(scene));
        }
        if self.steps.is_empty() && (!impossible.is_empty() || !self.fixed.is_empty()) {
            return Err(self.impossible(impossible, &[]));
        }
        self.leave_running();
        self.left_out = self.why_left_out(impossible);
        self.notes.extend(self.left_out.iter().map(|why| why.trim_end_matches('.').to_owned()));
        Ok(())
    }

    /// Drops all steps but the first few.
    fn take_back_to(&mut self, count: usize) {
        self.steps.truncate(count);
        self.turned_off.retain(|at| *at < count);
    }

    /// `wash the mug and fill it`: what would be turned off and at once on again is left running.
    fn leave_running(&mut self) {
        // From the last on, so that those before keep their places.
        for at in std::mem::take(&mut self.turned_off).into_iter().rev() {
            if let Some([off, on, ..]) = self.steps.get(at..)
                && off.action == on.action
            {
                self.steps.drain(at..at + 2);
            }
        }
    }

    /// That none of a request can be done: why, of the clauses that follow, too, where things cannot be carried.
    fn impossible(&mut self, why: Vec<String>, rest: &[Clause]) -> Fault {
        if !self.fixed.is_empty() {
            self.note_fixed(rest);
        }
        Fault::Cannot(self.why_left_out(why).unwrap_or_default())
    }

    /// `switch the power on by pulling the lever`: what the request comes to anyway is not done twice.
    fn drop_known_means(&mut self, scene: Known) {
        let (asked, means) = self.steps.split_at(self.begun.0);
        if means.iter().all(|step| asked.iter().any(|other| other.action == step.action)) {
            self.take_back_to(self.begun.0);
            self.scene = scene;
        }
    }

    pub(crate) fn add(&mut self, clause: &Clause) -> Result<(), Fault> {
        match clause.intent {
            Intent::Stop => self.push(Action::Stop, "stopping".to_owned()),
            Intent::Look | Intent::LookAround if let Some(room) = clause.looked_over() => return self.look_over(room),
            Intent::LookAround => self.push(Action::LookAround, "looking around".to_owned()),
            Intent::GoTo => return self.go_to(clause),
            Intent::Find => return self.find(clause),
            Intent::Travel => return self.travel(clause),
            Intent::Turn => return self.turn(clause),
            Intent::Look => self.look(clause),
            Intent::Mention => self.mention(clause),
            Intent::Swap => return self.swap(clause),
            Intent::Impossible => {
                let things = if clause.objects.is_empty() { "" } else { " things" };
                return Err(Fault::Cannot(format!("I cannot {}{things}, I am afraid.", clause.verb)));
            }
            _ => return self.add_object_clause(clause),
        }
        Ok(())
    }

    fn add_object_clause(&mut self, clause: &Clause) -> Result<(), Fault> {
        let settled = settle::settle(self, clause);
        if shifts(clause)
            && let [phrase] = clause.objects.as_slice()
        {
            let object = self.find_one(phrase, &Want::object(clause.intent), Some(Role::Object(0)))?;
            return Err(Fault::Cannot(format!(
                "I can put {} on something else, but I cannot shift it about.",
                self.the(object)
            )));
        }
        if clause.intent == Intent::Color && clause.color.is_none() && clause.places.is_empty() {
            return Err(Fault::Cannot("Which color shall it be? Say, for example, \"paint it red\".".to_owned()));
        }
        match clause.intent {
            Intent::PickUp => self.add_pick_up(&settled),
            Intent::Place | Intent::Bring | Intent::Drop => self.add_place(&settled),
            Intent::Pour => self.add_pour(&settled),
            Intent::Tea => self.add_tea(&settled),
            Intent::Throw => self.add_throw(&settled),
            Intent::Discard => self.add_discard(&settled),
            Intent::Break | Intent::Cut => self.add_break(&settled),
            Intent::Open | Intent::Close => self.add_door(&settled),
            Intent::Toggle | Intent::TurnOn | Intent::TurnOff => self.add_toggle(&settled),
            Intent::Use => self.add_use(&settled),
            Intent::Scan => self.add_simple(&settled, Verb::Scan, "scanning"),
            Intent::Examine => self.add_simple(&settled, Verb::Examine, "looking at"),
            Intent::LookIn => self.add_look_in(&settled),
            Intent::LookUnder => self.add_simple(&settled, Verb::Examine, report::LOOKS_UNDER),
            Intent::Highlight => self.add_highlight(&settled),
            _ => self.add_process(&settled),
        }
    }

    /// What was spoken of in passing is what `it` and `there` may stand for.
    pub(crate) fn mention(&mut self, clause: &Clause) {
        let want = Want::place(Intent::Find, &[], None);
        if let Some(Phrase { room: Some(room), .. }) = clause.objects.first().filter(|phrase| phrase.is_empty()) {
            (self.focus.room, self.focus.place) = (Some(*room), None);
        }
        let Some(phrase) = clause.objects.first() else { return };
        let Ok(object) = self.ground().one(phrase, &want) else {
            self.focus.unseen = Some(phrase.clone()).filter(|phrase| !phrase.namings.is_empty());
            return;
        };
        self.focus.mention(object);
        if !self.has(object, Property::Pickupable) {
            self.focus.place = Some(object);
        }
    }

    /// The objects of a clause: one each, or all of a kind.
    pub(crate) fn find_objects(&mut self, settled: &Settled, want: &Want<'_>) -> Result<Vec<ObjectId>, Fault> {
        let mut found = Vec::new();
        for (index, phrase) in settled.objects.iter().enumerate() {
            let each = self.find_each(phrase, want, Some(Role::Object(index)))?;
            self.note_too_few(phrase, &each);
            found.extend(each);
        }
        if found.len() > 1 {
            self.focus.group.clone_from(&found);
        }
        Ok(found)
    }

    /// That it knows of fewer than were asked for: those it does, and more it looks for if somebody says so.
    fn note_too_few(&mut self, phrase: &Phrase, found: &[ObjectId]) {
        let is_enough = phrase.count.is_none_or(|count| found.len() >= usize::from(count));
        let first = found.first().and_then(|id| self.scene.object(*id)).filter(|_| !is_enough);
        if let Some(first) = first {
            let name = describe::name(self.catalog, first.class);
            let known = if found.len() == 1 { format!("one {name}") } else { prose::counted(&name, found.len()) };
            self.notes.push(format!("I know of only {known}: tell me to look for another"));
        }
    }

    /// Whether a clause is about more than one object.
    pub(crate) fn is_several(&self, settled: &Settled) -> bool {
        settled.objects.len() > 1 || settled.objects.iter().any(|phrase| phrase.is_all || self.is_group(phrase))
    }

    fn add_simple(&mut self, settled: &Settled, verb: Verb, participle: &str) -> Result<(), Fault> {
        for object in self.find_objects(settled, &Want::object(settled.intent))? {
            self.interact(verb, object, participle);
        }
        Ok(())
    }

    fn add_look_in(&mut self, settled: &Settled) -> Result<(), Fault> {
        for object in self.find_objects(settled, &Want::object(settled.intent))? {
            self.open_around(object, true);
            self.interact(Verb::Examine, object, &format!("looking {}", self.preposition(object)));
        }
        Ok(())
    }

    fn add_highlight(&mut self, settled: &Settled) -> Result<(), Fault> {
        for object in self.find_objects(settled, &Want::object(settled.intent))? {
            let says = format!("pointing at {}", self.the(object));
            self.push(Action::Highlight { object }, says);
        }
        Ok(())
    }

    fn add_door(&mut self, settled: &Settled) -> Result<(), Fault> {
        let opens = settled.intent == Intent::Open;
        // Nobody leaves by the door of a fridge.
        let wants_change = |place: &ObjectId| {
            let is_other = self.scene.object(*place).is_some_and(|place| place.has(StateFlag::Opened) != opens);
            is_other && !settled.is_leaving
        };
        let objects = match self.place_with_door(settled).filter(wants_change) {
            Some(place) => vec![place],
            None => self.find_objects(settled, &Want::object(settled.intent))?,
        };
        for object in objects {
            if !self.has(object, Property::Openable) {
                return Err(Fault::Cannot(self.why_not_a_door(object, settled.intent)));
            }
            let is_open = self.scene.object(object).is_some_and(|object| object.has(StateFlag::Opened));
            if is_open == opens {
                let state = if opens { "open" } else { "closed" };
                self.focus.mention(object);
                self.notes.push(format!("{} is already {state}", self.the(object)));
            } else if opens {
                self.interact(Verb::Open, object, "opening");
            } else {
                if settled.is_leaving {
                    self.leave_by(object);
                }
                self.interact(Verb::Close, object, "closing");
            }
        }
        Ok(())
    }

    /// Why this is neither opened nor closed: the world would refuse it.
    fn why_not_a_door(&self, object: ObjectId, intent: Intent) -> String {
        let the = self.the(object);
        let they = if prose::is(&the) == "is" { "it is" } else { "they are" };
        format!("I cannot {} {the}: {they} not made to be opened and closed.", intent.verb())
    }

    /// Goes out by a door: it is shut from the room where the robot is then.
    fn leave_by(&mut self, door: ObjectId) {
        let here = self.scene.robot.room;
        let known = self.scene.object(door).zip(self.scene.floor.as_ref());
        match known.and_then(|(door, floor)| floor.plan.beyond(&door.instance, here)) {
            Some(room) => self.go_to_room(room),
            None => self.notes.push("I do not know what is behind that door, so I close it from here".to_owned()),
        }
    }

    /// `put it in the microwave and shut the door`: the microwave's.
    fn place_with_door(&self, settled: &Settled) -> Option<ObjectId> {
        let [phrase] = settled.objects.as_slice() else { return None };
        let door = self.catalog.find("Door_01")?;
        let is_bare = phrase.color.is_none() && phrase.side.is_none() && phrase.room.is_none() && !phrase.is_all;
        // `the door on it`
        let is_of_it = phrase.relations.iter().all(|relation| relation.to.is_bare_pronoun());
        let is_door = phrase.naming(door).is_some() && is_bare && is_of_it;
        let place = self.focus.place.filter(|place| self.has(*place, Property::Openable))?;
        is_door.then_some(place)
    }
}

/// `move the bowl a bit to the left`: to nowhere that could be named.
fn shifts(clause: &Clause) -> bool {
    let is_way = |place: &(Preposition, Place)| matches!(place.1, Place::Side(Side::Left | Side::Right | Side::Middle));
    clause.manner == Some(Manner::Shift) && !clause.places.is_empty() && clause.places.iter().all(is_way)
}
