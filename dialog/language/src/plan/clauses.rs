//! The steps of each clause.

use cohabit_cdf::{Action, ObjectId, Property, Verb, state::StateFlag};

use crate::{
    ground::want::{Miss, Want},
    known::Known,
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
    },
};

/// Whether a clause has nothing to do with those beside it: where it cannot be done, they can.
fn is_apart(clauses: &[Clause], index: usize) -> bool {
    let own = slot::named(&clauses[index]);
    let says_it = |phrase: &&Phrase| phrase.pronoun.is_some();
    let others = || clauses.iter().enumerate().filter(|(at, _)| *at != index).map(|(_, clause)| clause);
    let shares = |clause: &Clause| slot::named(clause).iter().any(|other| own.iter().any(|one| one.text == other.text));
    let refers_back = clauses[index + 1..].iter().any(|clause| slot::named(clause).iter().any(says_it));
    let is_deed = |clause: &Clause| clause.intent != Intent::Mention;
    others().any(is_deed) && !own.is_empty() && !own.iter().any(says_it) && !refers_back && !others().any(shares)
}

impl Planner<'_> {
    /// Adds the steps of all clauses.
    pub(crate) fn run(&mut self, clauses: &[Clause]) -> Result<(), Fault> {
        let mut impossible: Vec<String> = Vec::new();
        for (index, clause) in clauses.iter().enumerate() {
            self.clause = index;
            self.begun = (self.steps.len(), self.focus.clone());
            let is_apart = is_apart(clauses, index);
            let before = (clause.is_means || is_apart).then(|| self.scene.clone());
            match (self.add(clause), clauses.get(index + 1)) {
                // `take it, take the knife`: what was meant was said at once.
                (Err(Fault::Miss { miss: Miss::NoReferent, .. }), Some(next)) if next.intent == clause.intent => {}
                (Err(Fault::Cannot(why)), _) if is_apart => {
                    self.steps.truncate(self.begun.0);
                    self.focus = self.begun.1.clone();
                    before.into_iter().for_each(|scene| self.scene = scene);
                    impossible.push(why);
                    continue;
                }
                (result, _) => result?,
            }
            before.filter(|_| clause.is_means).into_iter().for_each(|scene| self.drop_known_means(scene));
        }
        if !impossible.is_empty() && self.steps.is_empty() {
            return Err(Fault::Cannot(impossible.join(" ")));
        }
        self.notes.extend(impossible.iter().map(|why| why.trim_end_matches('.').to_owned()));
        Ok(())
    }

    /// `switch the power on by pulling the lever`: what the request comes to anyway is not done twice.
    fn drop_known_means(&mut self, scene: Known) {
        let (asked, means) = self.steps.split_at(self.begun.0);
        if means.iter().all(|step| asked.iter().any(|other| other.action == step.action)) {
            self.steps.truncate(self.begun.0);
            self.scene = scene;
        }
    }

    pub(crate) fn add(&mut self, clause: &Clause) -> Result<(), Fault> {
        match clause.intent {
            Intent::Stop => self.push(Action::Stop, "stopping".to_owned()),
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
            found.extend(self.find_each(phrase, want, Some(Role::Object(index)))?);
        }
        if found.len() > 1 {
            self.focus.group.clone_from(&found);
        }
        Ok(found)
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
        let wants_change =
            |place: &ObjectId| self.scene.object(*place).is_some_and(|place| place.has(StateFlag::Opened) != opens);
        let objects = match self.place_with_door(settled).filter(wants_change) {
            Some(place) => vec![place],
            None => self.find_objects(settled, &Want::object(settled.intent))?,
        };
        for object in objects {
            let is_open = self.scene.object(object).is_some_and(|object| object.has(StateFlag::Opened));
            if is_open == opens && self.has(object, Property::Openable) {
                let state = if opens { "open" } else { "closed" };
                self.focus.mention(object);
                self.notes.push(format!("{} is already {state}", self.the(object)));
            } else if opens {
                self.interact(Verb::Open, object, "opening");
            } else {
                self.interact(Verb::Close, object, "closing");
            }
        }
        Ok(())
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
