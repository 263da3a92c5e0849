//! Answers about where things are, and what is somewhere.

use cohabit_cdf::{ObjectId, Property, RoomId, state::StateFlag};

use crate::{
    answer::{Answerer, NEIGHBOURS},
    ground::{self, want::Want},
    known::{KnownObject, contents, describe, floor, memory},
    read::{phrase::Phrase, question::Question, saying},
    understanding::Understanding,
    words::{
        intent::Intent,
        lexicon::{Pronoun, Side, StateWord},
        prose,
    },
};

impl Answerer<'_> {
    pub(crate) fn holder(&self, id: ObjectId) -> Understanding {
        let is_held = self.scene.robot.held == Some(id);
        let place = self.place_sentence(id);
        let text = match is_held {
            true => format!("I have {}: {place}.", prose::it(&self.short(id))),
            false => format!("Nobody that I know of: {place}."),
        };
        Understanding::about(text, vec![id])
    }

    /// Where it was taken from, or where it is, if it was not taken.
    pub(crate) fn origin(&self, id: ObjectId) -> Understanding {
        let taken = self.context.focus.origins.iter().find(|(taken, _)| *taken == id);
        let off_floor = self.context.focus.off_floor.iter().find(|(taken, _)| *taken == id);
        match (taken, off_floor) {
            (Some((_, from)), _) => {
                let text = format!("I took {} from {}.", self.short(id), self.full(*from));
                Understanding::about(text, vec![*from])
            }
            (None, Some((_, room))) => {
                let text = format!("I took {} from the floor of the {}.", self.short(id), room.name_in(self.catalog));
                Understanding::about(text, vec![id])
            }
            (None, None) => Understanding::about(prose::sentence(&self.place_sentence(id)), vec![id]),
        }
    }

    pub(crate) fn seeing(&self) -> Understanding {
        let visible: Vec<&KnownObject> = self.scene.objects.iter().filter(|object| object.visible).collect();
        let here: Vec<&KnownObject> =
            self.scene.objects.iter().filter(|object| object.room == self.scene.robot.room).collect();
        let (list, start) = if visible.is_empty() { (here, "Around me there is") } else { (visible, "I see") };
        if list.is_empty() {
            return Understanding::whether(false, "I see nothing of note here.", Vec::new());
        }
        let listed = contents::of_room(self.catalog, self.scene, &list, self.told);
        Understanding::answer(format!("{start} {listed}."))
    }

    /// Which rooms there are, and in which of them it is.
    pub(crate) fn rooms(&self) -> Understanding {
        let here = self.scene.robot.room.name_in(self.catalog).to_lowercase();
        let names = self.scene.room_names(self.catalog).map(str::to_lowercase).filter(|name| *name != here);
        let others: Vec<String> = names.map(|name| format!("the {name}")).collect();
        Understanding::answer(match others.as_slice() {
            [] => format!("There is only the {here}, as far as I know, and I am in it."),
            [other] => format!("I am in the {here}. Besides, there is {other}."),
            others => format!("I am in the {here}. Besides, there are {}.", prose::list(others, "and")),
        })
    }

    /// How many rooms there are, and which.
    pub(crate) fn room_count(&self) -> Understanding {
        let count = self.scene.room_names(self.catalog).count();
        let rooms = if count == 1 { "one room".to_owned() } else { format!("{count} rooms") };
        self.rooms().after(&format!("I know of {rooms}."))
    }

    /// The room that words name.
    pub(crate) fn room_in(&self, words: &[String]) -> Option<RoomId> {
        (0..words.len()).find_map(|at| self.lexicon.rooms.longest(&words[at..]).map(|(_, room)| *room))
    }

    pub(crate) fn way_to(&self, room: RoomId) -> String {
        let name = room.name_in(self.catalog);
        if room == self.scene.robot.room {
            return format!("This is the {name}.");
        }
        format!("I know the way to the {name}: say \"go to the {name}\", and I will show you.")
    }

    pub(crate) fn place_of(&self, phrase: &Phrase) -> Understanding {
        let want = Want::place(Intent::Find, &[], None);
        let others = self.others(phrase);
        if let Some((known, others)) = &others
            && others.is_empty()
        {
            let noun = saying::noun_or_thing(phrase);
            let noun = noun.strip_prefix("other ").unwrap_or(noun);
            let text = format!("I know of no other {noun}: {}.", self.place_sentence(*known));
            return Understanding::whether(false, text, vec![*known]);
        }
        let found = match (others, phrase.side) {
            (Some((_, others)), _) => Ok(others),
            (None, Some(Side::Nearest | Side::Farthest)) => self.ground().one(phrase, &want).map(|id| vec![id]),
            (None, _) => self.ground().plausible(phrase, &want),
        };
        let Ok(found) = found else { return self.elsewhere(phrase) };
        let (fitting, others): (Vec<ObjectId>, Vec<ObjectId>) =
            found.into_iter().partition(|id| self.is_as_told(phrase, *id));
        let places = |ids: &[ObjectId]| {
            let places: Vec<String> = ids.iter().take(contents::LIST).map(|id| self.place_sentence(*id)).collect();
            prose::list(&places, "and")
        };
        // `is there a clean plate`, where all are dirty.
        if fitting.is_empty() {
            let text = format!("I know of no {}: {}.", saying::noun_or_thing(phrase), places(&others));
            return Understanding::whether(false, text, others);
        }
        Understanding::whether(true, prose::sentence(&places(&fitting)), fitting)
    }

    /// Where the things of a kind are; of a place at which none is known, that, and where others are.
    pub(crate) fn of_kind(&self, phrase: &Phrase) -> Understanding {
        let want = Want::place(Intent::Find, &[], None);
        let places = |ids: &[ObjectId]| {
            let mut told: Vec<String> = ids.iter().take(contents::LIST).map(|id| self.place_sentence(*id)).collect();
            told.dedup();
            prose::list(&told, "and")
        };
        if let Some(found) = self.ground().everywhere(phrase, &want).ok().filter(|found| !found.is_empty()) {
            return Understanding::whether(true, prose::sentence(&places(&found)), found);
        }
        let noun = saying::noun_or_thing(phrase);
        let is_here = phrase.is_here || phrase.room == Some(self.scene.robot.room);
        let there = if is_here { "here" } else { "there" };
        let bare = Phrase { room: None, is_here: false, relations: Vec::new(), ..phrase.clone() };
        match self.ground().everywhere(&bare, &want) {
            Ok(others) if bare != *phrase && !others.is_empty() => {
                Understanding::whether(false, format!("I know of no {noun} {there}: {}.", places(&others)), others)
            }
            _ if bare != *phrase => {
                Understanding::whether(false, format!("I have seen no {noun} {there}."), Vec::new())
            }
            _ => Understanding::whether(false, format!("I have seen no {noun} yet."), Vec::new()),
        }
    }

    /// `is there another cup`: the one in the hand, or else that which was spoken of last, and those beside it; nothing, where none is in
    /// question.
    fn others(&self, phrase: &Phrase) -> Option<(ObjectId, Vec<ObjectId>)> {
        let is_another = phrase.side == Some(Side::Other) || phrase.text.split(' ').next() == Some("another");
        if !is_another {
            return None;
        }
        let side = phrase.side.filter(|side| *side != Side::Other);
        let all =
            self.ground().everywhere(&Phrase { side, ..phrase.clone() }, &Want::place(Intent::Find, &[], None)).ok()?;
        let mut in_question = self.scene.robot.held.into_iter().chain(self.context.focus.recent.iter().copied());
        let known = in_question.find(|id| all.contains(id))?;
        Some((known, all.into_iter().filter(|id| *id != known).collect()))
    }

    /// Whether a thing is in all the states that it was said to be in. What is big is a matter of taste.
    fn is_as_told(&self, phrase: &Phrase, id: ObjectId) -> bool {
        let is_so = |state: &StateWord| {
            matches!(state, StateWord::Flag(StateFlag::Embiggenated, _))
                || self.scene.object(id).is_some_and(|object| self.is_so(object, *state))
        };
        phrase.states.iter().all(is_so)
    }

    /// What is not where it was asked for may be known to be somewhere else.
    fn elsewhere(&self, phrase: &Phrase) -> Understanding {
        let bare = Phrase { room: None, is_here: false, relations: Vec::new(), ..phrase.clone() };
        let want = Want::place(Intent::Find, &[], None);
        match self.ground().plausible(&bare, &want) {
            Ok(found) if bare != *phrase && !found.is_empty() => {
                let places: Vec<String> =
                    found.iter().take(contents::LIST).map(|id| self.place_sentence(*id)).collect();
                Understanding::whether(false, format!("No, but {}.", prose::list(&places, "and")), found)
            }
            _ => self.unseen(phrase),
        }
    }

    pub(crate) fn place_sentence(&self, id: ObjectId) -> String {
        let (place, the) = (describe::location(self.catalog, self.scene, id), self.short(id));
        if !place.is_empty() {
            return format!("{the} {} {place}", prose::is(&the));
        }
        let side = self.scene.object(id).map_or("", |object| {
            let bearing = self.scene.bearing_rad(object);
            match bearing {
                _ if bearing.abs() < 0.6 => "in front of me",
                _ if bearing.abs() > 2.4 => "behind me",
                _ if bearing > 0.0 => "to my left",
                _ => "to my right",
            }
        });
        format!("{the} {} here in the {}, {side}", prose::is(&the), self.scene.robot.room.name_in(self.catalog))
    }

    pub(crate) fn room_contents(&self, room: RoomId) -> Understanding {
        let there: Vec<&KnownObject> = self.scene.objects.iter().filter(|object| object.room == room).collect();
        let place = format!("in the {}", room.name_in(self.catalog));
        if there.is_empty() {
            return Understanding::whether(false, format!("I have seen nothing {place} yet."), Vec::new());
        }
        let listed = contents::of_room(self.catalog, self.scene, &there, self.told);
        let verb = contents::verb(there.len(), &listed);
        let text = format!("{} there {verb} {listed}.", prose::sentence(&place).trim_end_matches('.'));
        Understanding::whether(true, text, Vec::new())
    }

    /// What it can pick up in this room, or in the room or at the place that was named.
    pub(crate) fn carried(&self, about: Option<&Phrase>, question: &Question) -> Understanding {
        let here = self.scene.robot.room;
        let room = self.room_in(&question.rest).unwrap_or(here);
        let want = Want::place(Intent::Find, &[Property::Receptacle], None);
        let is_place = |id: &ObjectId| {
            self.scene.object(*id).is_some_and(|object| self.catalog.class(object.class).has(Property::Receptacle))
        };
        let named = about.filter(|phrase| !phrase.namings.is_empty() || phrase.pronoun == Some(Pronoun::Place));
        let at = named.and_then(|phrase| self.ground().one(phrase, &want).ok()).filter(is_place);
        let is_there = |object: &&KnownObject| {
            let is_carried = self.catalog.class(object.class).has(Property::Pickupable);
            is_carried
                && self.scene.robot.held != Some(object.id)
                && match at {
                    Some(place) => self.scene.ancestors(object.id).any(|outer| outer.id == place),
                    None => object.room == room,
                }
        };
        let there: Vec<&KnownObject> = self.scene.objects.iter().filter(is_there).collect();
        let place = match at {
            Some(id) => format!("{} {}", describe::preposition(self.catalog, self.scene, id), self.short(id)),
            None if room == here => "here".to_owned(),
            None => format!("in the {}", room.name_in(self.catalog)),
        };
        if there.is_empty() {
            let text = format!("I know of nothing {place} that I could pick up.");
            return Understanding::whether(false, text, Vec::new());
        }
        let text = prose::sentence(&format!("{place} I can pick up {}", self.listed(&there)));
        Understanding::whether(true, text, there.iter().map(|object| object.id).collect())
    }

    /// Whether a question is about the floor, and not about a floor lamp.
    pub(crate) fn is_about_floor(&self, question: &Question) -> bool {
        let rest = &question.rest;
        let is_floor = |at: usize| {
            let is_name = self.lexicon.classes.longest(&rest[at..]).is_some_and(|(length, _)| length > 1);
            !is_name && self.lexicon.yes_no.says_floor(&rest[at..=at])
        };
        (0..rest.len()).any(is_floor)
    }

    /// What lies about on the floor of a room, or of this one.
    pub(crate) fn on_floor(&self, room: Option<RoomId>) -> Understanding {
        let here = self.scene.robot.room;
        let room = room.unwrap_or(here);
        let place = if room == here { "here".to_owned() } else { format!("in the {}", room.name_in(self.catalog)) };
        let lies = |object: &&KnownObject| {
            let is_carried = self.catalog.class(object.class).has(Property::Pickupable);
            is_carried && self.scene.is_on_floor(object) && object.room == room
        };
        let there: Vec<&KnownObject> = self.scene.objects.iter().filter(lies).collect();
        let ids = there.iter().map(|object| object.id).collect();
        let listed = self.listed(&there);
        let verb = contents::verb(there.len(), &listed);
        match there.is_empty() {
            true => Understanding::whether(false, format!("I see nothing on the floor {place} but furniture."), ids),
            false if room == here => Understanding::whether(true, format!("On the floor there {verb} {listed}."), ids),
            false => Understanding::whether(true, format!("On the floor {place} there {verb} {listed}."), ids),
        }
    }

    /// What lies under a thing or behind it, as far as it knows.
    pub(crate) fn under(&self, id: ObjectId) -> Understanding {
        match contents::under(self.catalog, self.scene, id) {
            Some(text) => Understanding::whether(true, prose::sentence(&text), vec![id]),
            None => {
                let text = format!("I know of nothing under {} or behind it.", self.short(id));
                Understanding::whether(false, text, vec![id])
            }
        }
    }

    pub(crate) fn contents(&self, id: ObjectId) -> Understanding {
        if let Some(text) = contents::inside(self.catalog, self.scene, id, self.told) {
            let highlight = self.scene.contents(id).map(|object| object.id).collect();
            return Understanding::whether(true, prose::sentence(&text), highlight);
        }
        if let Some(note) = self.scene.object(id).filter(|object| !object.text.is_empty()) {
            return self.read_out(note);
        }
        if let Some(shut) = self.unopened(id) {
            return shut;
        }
        let place = self.short(id);
        if let Some(filling) = self.fillings(id) {
            return Understanding::whether(true, format!("There is {filling} in {place}."), vec![id]);
        }
        let is_vessel = |object: &KnownObject| {
            let class = self.catalog.class(object.class);
            class.has(Property::Fillable) && class.has(Property::Pickupable)
        };
        if self.scene.object(id).is_some_and(is_vessel) {
            return Understanding::whether(false, prose::sentence(&format!("{place} is empty")), vec![id]);
        }
        // `what is on the screen of the computer?`
        let carries = |object: &&KnownObject| self.catalog.class(object.class).receptacle.is_some();
        match self.scene.object(id).filter(|object| !carries(object)) {
            Some(object) => {
                let purpose = if self.facts().has_use(object) { self.facts().purpose(object) } else { String::new() };
                let text = format!("There is nothing on {place} that I could read or take. {purpose}");
                Understanding::whether(false, text.trim(), vec![id])
            }
            None => {
                let preposition = describe::preposition(self.catalog, self.scene, id);
                Understanding::whether(false, format!("I know of nothing {preposition} {place}."), Vec::new())
            }
        }
    }

    /// That it has not looked into a thing, which is shut, and an offer to.
    pub(crate) fn unopened(&self, id: ObjectId) -> Option<Understanding> {
        let is_shut = self.scene.object(id).is_some_and(|object| memory::is_shut(self.catalog, object));
        let the = self.short(id);
        let text = format!("{} I have not looked into it yet. Shall I?", prose::sentence(&format!("{the} is closed")));
        // Who has opened it knows what was in it.
        let has_looked = self.context.deeds.did(Intent::Open, id);
        (is_shut && !has_looked && self.scene.floor.is_some()).then(|| crate::say::ask::confirmation(text))
    }

    /// What is before a thing: what it aims at by the table of devices, and what is there; of what aims at nothing, what is next to it.
    pub(crate) fn before(&self, id: ObjectId) -> Understanding {
        let Some(target) = self.scene.object(id).and_then(|object| self.aim_of(object)) else {
            return self.neighbours(id);
        };
        let aims = prose::sentence(&format!("{} aims at {}", self.short(id), self.short(target)));
        self.contents(target).after(&aims)
    }

    /// The nearest thing in its room of those that a machine aims at.
    fn aim_of(&self, machine: &KnownObject) -> Option<ObjectId> {
        let aims = &self.catalog.table().device(&self.catalog.class(machine.class).id).aims;
        let is_aim = |object: &&KnownObject| {
            object.room == machine.room && aims.iter().any(|class| *class == self.catalog.class(object.class).id)
        };
        let apart_m = |object: &KnownObject| floor::distance_m(object.position_m, machine.position_m);
        let aims = self.scene.objects.iter().filter(is_aim);
        aims.min_by(|one, other| apart_m(one).total_cmp(&apart_m(other)).then(one.id.cmp(&other.id))).map(|aim| aim.id)
    }

    /// What is next to a thing, the nearest first.
    pub(crate) fn neighbours(&self, id: ObjectId) -> Understanding {
        let Some(object) = self.scene.object(id) else { return self.hint() };
        let apart_m = |other: &KnownObject| floor::distance_m(object.position_m, other.position_m);
        let is_free = |other: &&KnownObject| {
            let is_within = |inner: ObjectId, outer: ObjectId| self.scene.ancestors(inner).any(|one| one.id == outer);
            other.id != id
                && other.room == object.room
                && self.scene.robot.held != Some(other.id)
                && !is_within(other.id, id)
                && !is_within(id, other.id)
                && apart_m(other) < ground::NEAR_M
        };
        let mut near: Vec<&KnownObject> = self.scene.objects.iter().filter(is_free).collect();
        near.sort_by(|one, other| apart_m(one).total_cmp(&apart_m(other)).then(one.id.cmp(&other.id)));
        near.truncate(NEIGHBOURS);
        let the = self.short(id);
        if near.is_empty() {
            return Understanding::whether(false, format!("I know of nothing next to {the}."), Vec::new());
        }
        let names: Vec<String> = near.iter().map(|other| self.short(other.id)).collect();
        let verb = if near.len() > 1 { "are" } else { "is" };
        let text = format!("Next to {the} {verb} {}.", prose::list(&names, "and"));
        Understanding::whether(true, text, near.iter().map(|other| other.id).collect())
    }

    pub(crate) fn distance(&self, id: ObjectId) -> Understanding {
        let Some(object) = self.scene.object(id) else { return self.hint() };
        let meters = self.scene.distance_m(object);
        let text = format!("{} is {meters:.1} m away from me.", self.short(id));
        Understanding::about(prose::sentence(&text), vec![id])
    }
}
