//! Whether things are in a state: what was seen, what the robot did since, and what it cannot tell.

use cohabit_cdf::{
    Fluid, ObjectId, Property,
    state::StateFlag,
    table::{Change, Condition, Effect, Site, Term, Test},
};

use crate::{
    answer::{Answerer, claim::asked_state},
    ground::{
        has_state,
        want::{Miss, Want},
    },
    known::{KnownObject, contents},
    read::{phrase::Phrase, question::Question, reader::Reader, saying},
    understanding::Understanding,
    words::{intent::Intent, lexicon::StateWord, prose},
};

impl Answerer<'_> {
    pub(crate) fn is_in_state(&self, id: ObjectId, state: StateWord, words: &[String]) -> Understanding {
        if let Some(answer) = self.is_never_so(id, state) {
            return answer;
        }
        if let StateWord::Filled(is_full) = state
            && let Some(answer) = self.is_stocked(id, is_full)
        {
            return answer;
        }
        let holds = self.scene.object(id).is_some_and(|object| self.is_so(object, state));
        let (the, words) = (self.short(id), words.join(" "));
        let is_lit = self.scene.object(id).is_some_and(|object| self.devices.is_lit(object.class));
        let is_switched = matches!(state, StateWord::Flag(StateFlag::Toggled, _));
        let filling = self.fillings(id).filter(|filling| !the.contains(filling.as_str()));
        let filling = filling.filter(|_| matches!(state, StateWord::Filled(_)));
        let text = if let Some(filling) = filling {
            format!("there is {filling} in {the}")
        } else if is_switched && is_lit {
            let state = if holds { "" } else { "not " };
            format!("{the} is {state}{words}: it runs for a moment only, and its screen stays lit")
        } else if holds {
            format!("{the} {} {words}", prose::is(&the))
        } else if let Some(machine) = self.made_so_in(id, state) {
            let machine = self.short(machine);
            let text = format!("{the} should be {words} by now: {machine} has run with {}", prose::it(&the));
            return self.told(true, &text, id);
        } else if self.may_have_changed(id, state) {
            format!("{the} {} not {words} when I last saw {}", prose::was(&the), prose::it(&the))
        } else {
            format!("{the} {} not {words}", prose::is(&the))
        };
        self.told(holds, &text, id)
    }

    /// In which of two states a thing is, where that is asked: no yes or no tells it.
    pub(crate) fn which_state(&self, id: ObjectId, either: &[(StateWord, &[String]); 2]) -> Understanding {
        let Some(object) = self.scene.object(id) else { return self.hint() };
        let otherwise = either.iter().find_map(|(state, _)| match state {
            StateWord::Filled(is_full) => self.is_stocked(id, *is_full),
            state => self.is_never_so(id, *state),
        });
        if let Some(answer) = otherwise {
            return answer;
        }
        let so: Vec<String> =
            either.iter().filter(|(state, _)| self.is_so(object, *state)).map(|(_, words)| words.join(" ")).collect();
        let state = match so.as_slice() {
            [] => format!("neither {} nor {}", either[0].1.join(" "), either[1].1.join(" ")),
            so => prose::list(so, "and"),
        };
        let the = self.short(id);
        let text = match either.iter().any(|(state, _)| self.may_have_changed(id, *state)) {
            true => format!("{the} {} {state} when I last saw {}", prose::was(&the), prose::it(&the)),
            false => format!("{the} {} {state}", prose::is(&the)),
        };
        Understanding::whether(self.is_so(object, either[0].0), prose::sentence(&text), vec![id])
    }

    /// That nobody can switch a thing, or open it: it would be off, or closed, for ever.
    pub(crate) fn is_never_so(&self, id: ObjectId, state: StateWord) -> Option<Understanding> {
        let may = match state {
            StateWord::Flag(StateFlag::Toggled, false) => "switched on or off",
            StateWord::Flag(StateFlag::Opened, false) => "opened or closed",
            _ => return None,
        };
        let object = self.scene.object(id).filter(|object| !self.can_be(object, state))?;
        Some(Understanding::about(prose::sentence(&format!("{} cannot be {may}", self.short(object.id))), vec![id]))
    }

    /// Whether what things are put into, and nothing is poured, is full or empty, where more is asked than whether anything is in it:
    /// what it has not looked into may be either, and how much more goes in nobody told.
    pub(crate) fn is_stocked(&self, id: ObjectId, is_full: bool) -> Option<Understanding> {
        let class = self.catalog.class(self.scene.object(id)?.class);
        if class.receptacle.is_none() || class.has(Property::Fillable) {
            return None;
        }
        match contents::inside(self.catalog, self.scene, id, 0) {
            None => self.unopened(id),
            Some(inside) => is_full.then(|| {
                let text = format!("I cannot tell whether {} is full: {inside}.", self.short(id));
                Understanding::about(text, vec![id])
            }),
        }
    }

    /// Whether all of several are in a state, and which are not.
    pub(crate) fn are_in_state(&self, phrase: &Phrase, state: StateWord, words: &[String]) -> Understanding {
        let Ok(all) = self.each_meant(phrase, state) else { return self.unseen(phrase) };
        let is_not = |id: &&ObjectId| !self.scene.object(**id).is_some_and(|object| self.is_so(object, state));
        let others: Vec<ObjectId> = all.iter().filter(is_not).copied().collect();
        let (words, named) = (words.join(" "), |ids: &[ObjectId]| {
            prose::list(&ids.iter().take(contents::LIST).map(|id| self.full(*id)).collect::<Vec<_>>(), "and")
        });
        let text = match (others.len(), all.len()) {
            (_, 1) => return self.is_in_state(all[0], state, &[words]),
            (0, _) => format!("Yes, they are all {words}."),
            (1, _) => format!("No, {} {} not {words}.", named(&others), prose::is(&self.short(others[0]))),
            (count, total) if count == total => format!("No, none of them is {words}."),
            _ => format!("No, {} are not {words}.", named(&others)),
        };
        Understanding::whether(others.is_empty(), text, all)
    }

    /// Whether any of several is in a state, and which are: `is any plate dirty`.
    pub(crate) fn any_in_state(&self, phrase: &Phrase, state: StateWord, words: &[String]) -> Understanding {
        let Ok(all) = self.each_meant(phrase, state) else { return self.unseen(phrase) };
        let is_in = |id: &ObjectId| self.scene.object(*id).is_some_and(|object| self.is_so(object, state));
        let found: Vec<ObjectId> = all.iter().copied().filter(is_in).collect();
        if found.is_empty() {
            let noun = saying::noun_or_thing(phrase);
            let text = format!("No, I know of no {noun} that {} {}.", prose::is(noun), words.join(" "));
            return Understanding::whether(false, text, all);
        }
        let named: Vec<String> = found.iter().take(contents::LIST).map(|id| self.full(*id)).collect();
        Understanding::whether(true, format!("Yes: {}.", prose::list(&named, "and")), found)
    }

    /// All that are meant, wherever they are: `they` are those that were spoken of together, `both` are those at hand.
    pub(crate) fn each_meant(&self, phrase: &Phrase, state: StateWord) -> Result<Vec<ObjectId>, Miss> {
        let (ground, want) = (self.ground(), Want::place(Intent::Find, may_be(state), None));
        match () {
            () if phrase.is_many() => ground.plausible(phrase, &want),
            () if phrase.text.starts_with("both ") => ground.all(phrase, &want),
            () => ground.everywhere(phrase, &want),
        }
    }

    /// The state that is asked for behind what is named, and nothing else: `lights still on`.
    pub(crate) fn state_after_name<'q>(&'q self, question: &'q Question) -> Option<(StateWord, &'q [String])> {
        let said = &self.lexicon.yes_no;
        let mut reader = Reader::new(self.lexicon, &question.rest);
        reader.phrase_with_place()?;
        let left = said.without_fillers(reader.rest());
        let (state, words) = asked_state(self.lexicon, left).filter(|(_, words)| left.ends_with(words))?;
        said.is_filler(&left[..left.len() - words.len()]).then_some((state, words))
    }

    /// What is in a state here: `is anything broken`.
    pub(crate) fn all_in_state(&self, state: StateWord, words: &[String], is_whether: bool) -> Understanding {
        let is_in = |object: &&KnownObject| {
            object.room == self.scene.robot.room && self.can_be(object, state) && self.is_so(object, state)
        };
        let found: Vec<ObjectId> = self.scene.objects.iter().filter(is_in).map(|object| object.id).collect();
        if found.is_empty() {
            let start = if is_whether { "No, " } else { "" };
            let text = prose::sentence(&format!("{start}I know of nothing {} here", words.join(" ")));
            return Understanding::whether(false, text, Vec::new());
        }
        let named: Vec<String> = found.iter().take(contents::LIST).map(|id| self.full(*id)).collect();
        let start = if is_whether { "yes: " } else { "" };
        let text = prose::sentence(&format!("{start}{}", prose::list(&named, "and")));
        Understanding::whether(true, text, found)
    }

    /// Whether it is worth saying that a thing is so: a table is not closed, nor a lamp dry. What is so needs no leave to be so.
    pub(crate) fn can_be(&self, object: &KnownObject, state: StateWord) -> bool {
        let changed_by: &[Intent] = match state {
            StateWord::Flag(_, true) => return true,
            StateWord::Flag(StateFlag::Wet, _) => &[Intent::Dry, Intent::Water],
            StateWord::Flag(StateFlag::Creased, _) => &[Intent::Iron],
            StateWord::Flag(StateFlag::Folded, _) => &[Intent::Fold],
            _ => &[],
        };
        let (class, may) = (self.catalog.class(object.class), may_be(state));
        if changed_by.is_empty() {
            return may.is_empty() || may.iter().any(|property| class.has(*property));
        }
        let mut processes = self.devices.processes.iter();
        processes.any(|process| changed_by.contains(&process.intent) && process.of.contains(&object.class))
    }

    /// The machine in which a thing is, if it works on what is in it.
    pub(crate) fn machine_around(&self, object: &KnownObject) -> Option<&KnownObject> {
        self.scene.ancestors(object.id).find(|outer| self.has_work(outer))
    }

    /// The machine that the robot has had run with a thing in it, and has not looked into since, if that makes such things so. Who knows
    /// everything knows what came of it.
    pub(crate) fn made_so_in(&self, id: ObjectId, state: StateWord) -> Option<ObjectId> {
        let StateWord::Flag(flag, value) = state else { return None };
        let object = self.scene.object(id).filter(|_| self.scene.floor.is_some())?;
        let machine = self.machine_around(object)?;
        let (table, class) = (self.catalog.table(), self.catalog.class(object.class));
        let device =
            Some(table.device(&self.catalog.class(machine.class).id)).filter(|device| device.at == Site::It)?;
        let work = table.work(device.work.as_deref()?)?;
        let is_for_it = |condition: &Condition| {
            let is_so = match &condition.test {
                Test::Affords(property) => class.has(*property),
                Test::IsA(classes) => classes.matches(&class.id),
                _ => return true,
            };
            condition.term != Term::Thing || is_so != condition.negated
        };
        let makes_so = |effect: &Effect| {
            effect.changes.contains(&Change::Set(Term::Thing, flag, value)) && effect.when.iter().all(is_for_it)
        };
        let has_run = self.context.deeds.has_switched_since(machine.id, id);
        (has_run && work.effects.iter().any(makes_so)).then_some(machine.id)
    }

    /// Whether a thing is in a state as people say it: coffee that is no longer hot is cold.
    pub(crate) fn is_so(&self, object: &KnownObject, state: StateWord) -> bool {
        match state {
            StateWord::Flag(StateFlag::Cold, is_cold) if object.fluid == Fluid::Coffee => {
                object.has(StateFlag::Hot) != is_cold
            }
            // What things stand in is not empty.
            StateWord::Filled(is_full) if self.scene.contents(object.id).next().is_some() => is_full,
            StateWord::Filled(is_full) if contents::has_cereal(self.catalog, object) => is_full,
            StateWord::Flag(StateFlag::Broken, is_broken) => self.facts().is_broken(object) == is_broken,
            state => has_state(object, state),
        }
    }

    pub(crate) fn cannot_tell(&self, object: &KnownObject) -> Understanding {
        self.all_known(object, "I cannot tell")
    }

    /// Whether it may be otherwise by now: hot or cold, or in a machine that has done its work, since the robot saw it.
    pub(crate) fn may_have_changed(&self, id: ObjectId, state: StateWord) -> bool {
        let is_warmth = matches!(state, StateWord::Flag(StateFlag::Hot | StateFlag::Cold, _));
        let holder = self.scene.object(id).and_then(|object| self.scene.object(object.parent?));
        let is_in_machine = holder.is_some_and(|holder| {
            let device = self.catalog.table().device(&self.catalog.class(holder.class).id);
            device.work.is_some() && matches!(state, StateWord::Flag(..))
        });
        let is_seen = self.scene.robot.held == Some(id) || self.scene.object(id).is_some_and(|object| object.visible);
        (is_warmth || is_in_machine) && !is_seen
    }
}

/// What things afford that may be in a state.
pub(crate) const fn may_be(state: StateWord) -> &'static [Property] {
    match state {
        StateWord::Flag(StateFlag::Dirty, _) => &[Property::Dirtyable],
        StateWord::Flag(StateFlag::Broken, _) => &[Property::Breakable],
        StateWord::Flag(StateFlag::Opened, _) => &[Property::Openable],
        StateWord::Flag(StateFlag::Toggled, _) => &[Property::Toggleable, Property::Powerable],
        StateWord::Filled(_) => &[Property::Fillable],
        StateWord::Flag(..) => &[],
    }
}
