//! Whether what is claimed of a thing is so.
//!
//! What the robot cannot tell is neither true nor false: it says so, and what it knows of the thing instead.

use cohabit_cdf::{ClassId, Fluid, ObjectId, Property, state::StateFlag};

use crate::{
    answer::{
        Answerer,
        claim::{Claim, Filling, asked_state},
    },
    ground::{
        has_state,
        want::{Miss, Want},
    },
    known::{KnownObject, contents, describe},
    read::{
        phrase::{Phrase, RelationKind},
        question::Question,
        reader::Reader,
        saying,
    },
    understanding::Understanding,
    words::{
        intent::Intent,
        lexicon::{Naming, StateWord},
        prose,
    },
};

impl Answerer<'_> {
    /// Whether what is asked of a thing is so.
    pub(crate) fn claim(&self, phrase: &Phrase, question: &Question) -> Understanding {
        let claim = Claim::read(self.lexicon, phrase, &question.rest);
        let bare = Phrase { relations: Vec::new(), room: None, ..phrase.clone() };
        if let (Claim::Placed | Claim::Present | Claim::Done, Some(filling)) =
            (&claim, Filling::named(self.lexicon, phrase))
        {
            let made = matches!(claim, Claim::Done).then(|| self.is_made(phrase, filling)).flatten();
            if let Some(answer) = made.or_else(|| self.filled(phrase, filling)) {
                return answer.with_yes_or_no(matches!(claim, Claim::Done));
            }
        }
        if bare.is_empty() {
            return Understanding::lost("I do not know what you mean.");
        }
        // `is the kitchen light on`, `is the plate in the sink dirty`: that one, if there is one where it is said to be.
        let is_placed = phrase.room.is_some() || !phrase.relations.is_empty();
        let is_there = || {
            let found = self.ground().one(phrase, &Want::place(Intent::Find, &[], None));
            matches!(found, Ok(_) | Err(Miss::Several(_)))
        };
        let meant = if is_placed && is_there() { phrase.clone() } else { bare.clone() };
        let meant = match claim {
            Claim::State(StateWord::Flag(StateFlag::Toggled, _), _) => self.flowing_from(phrase).unwrap_or(meant),
            _ => meant,
        };
        match claim {
            Claim::State(state, words) if meant.is_any => self.any_in_state(&meant, state, words),
            Claim::State(state, words) if meant.is_all || meant.is_many() => self.are_in_state(&meant, state, words),
            Claim::State(state, words) => {
                self.with_object_that(may_be(state), &meant, |id| self.is_in_state(id, state, words))
            }
            Claim::Full(filling) => self.with_known(&meant, |object| self.is_filled(object, filling)),
            Claim::Color(asked) => {
                let color = meant.color.clone().filter(|color| color != asked);
                let colorless = Phrase { color, ..meant };
                self.with_known(&colorless, |object| self.is_of_color(object, asked))
            }
            Claim::Sound(is_asked) => self.with_known(&meant, |object| {
                let trouble = self.facts().trouble(object);
                let the = self.short(object.id);
                let text = match &trouble {
                    Some(_) if describe::bare(self.catalog, self.scene, object.id).contains("broken") => {
                        format!("{the} does not work")
                    }
                    Some(trouble) => format!("there is something wrong with {the}: {trouble}"),
                    None => format!("I see nothing wrong with {the}"),
                };
                self.told(trouble.is_none() == is_asked, &text, object.id)
            }),
            // `is it done?`, of nothing that is ever done: what the mission wants.
            Claim::Done if question.rest.iter().any(|word| word == "done") && self.is_never_done(&meant) => {
                Understanding::answer(self.goals().reply())
            }
            Claim::Done => self.with_known(&meant, |object| self.is_done(object)),
            Claim::For => self.with_known(&bare, |object| {
                if object.works.is_none() {
                    return self.cannot_tell(object);
                }
                let holds = self.ground().narrow(phrase, &[object.id]) == [object.id];
                let start = if holds { "Yes" } else { "No, as far as I know" };
                let text = format!("{start}: {}", prose::within_sentence(&self.facts().purpose(object)));
                Understanding::whether(holds, text, vec![object.id])
            }),
            Claim::Same(described, named) => self.is_same(&described, &named),
            Claim::Placed => match self.ground().one(&bare, &Want::place(Intent::Find, &[], None)) {
                Err(Miss::Unseen) => match self.absent(phrase) {
                    Some((text, place)) => Understanding::whether(false, format!("No, {text}"), vec![place]),
                    None => self.unseen(&bare),
                },
                _ => self.with_object(&bare, |id| {
                    let holds = self.ground().narrow(phrase, &[id]) == [id];
                    self.told(holds, &self.place_sentence(id), id)
                }),
            },
            Claim::Present => self.place_of(&bare),
            Claim::Untold => self.with_known(&meant, |object| self.cannot_tell(object)),
        }
    }

    fn told(&self, holds: bool, text: &str, id: ObjectId) -> Understanding {
        let start = if holds { "Yes" } else { "No" };
        Understanding::whether(holds, format!("{start}, {text}."), vec![id])
    }

    /// Whether what is described is what is named; or where the latter is, if nothing is known that fits the description.
    fn is_same(&self, described: &Phrase, named: &Phrase) -> Understanding {
        let want = Want::place(Intent::Find, &[], None);
        let Ok(id) = self.ground().one(described, &want) else { return self.place_of(named) };
        if self.ground().narrow(named, &[id]) == [id] {
            return self.told(true, &format!("that is {}", self.full(id)), id);
        }
        let instead = match self.ground().one(named, &want) {
            Ok(other) => format!(", and {}", self.place_sentence(other)),
            Err(_) => String::new(),
        };
        self.told(false, &format!("that is {}{instead}", self.short(id)), id)
    }

    /// What is meant by something that flows, where it is asked whether that is on or off: `is the water off?` is asked of the tap, and of
    /// no glass of water. The tap that was spoken of, or else any that is described.
    fn flowing_from(&self, phrase: &Phrase) -> Option<Phrase> {
        let fluid = phrase.fluid?;
        let fills = self.devices.processes.iter();
        let fills = fills.filter(|process| process.intent == Intent::Fill && process.fluid == Some(fluid));
        let sources: Vec<ClassId> = fills.flat_map(|process| process.at.iter().copied()).collect();
        let is_source = |id: ObjectId| self.scene.object(id).is_some_and(|object| sources.contains(&object.class));
        if !self.scene.objects.iter().any(|object| is_source(object.id)) {
            return None;
        }
        let spoken = self.context.focus.recent.iter().copied().find(|id| is_source(*id));
        let chosen = phrase.chosen.or_else(|| spoken.filter(|_| !phrase.is_described()));
        let namings = sources.iter().map(|class| Naming { class: *class, weight: 1.0 }).collect();
        Some(Phrase { fluid: None, namings, chosen, ..phrase.clone() })
    }

    fn is_in_state(&self, id: ObjectId, state: StateWord, words: &[String]) -> Understanding {
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
        let text = if is_switched && is_lit {
            let state = if holds { "" } else { "not " };
            format!("{the} is {state}{words}: it runs for a moment only, and its screen stays lit")
        } else if holds {
            format!("{the} {} {words}", prose::is(&the))
        } else if self.may_have_changed(id, state) {
            format!("{the} {} not {words} when I last saw {}", prose::was(&the), prose::it(&the))
        } else {
            format!("{the} {} not {words}", prose::is(&the))
        };
        self.told(holds, &text, id)
    }

    /// That nobody can switch a thing, or open it: it would be off, or closed, for ever.
    fn is_never_so(&self, id: ObjectId, state: StateWord) -> Option<Understanding> {
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
    fn is_stocked(&self, id: ObjectId, is_full: bool) -> Option<Understanding> {
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
    fn are_in_state(&self, phrase: &Phrase, state: StateWord, words: &[String]) -> Understanding {
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
    fn each_meant(&self, phrase: &Phrase, state: StateWord) -> Result<Vec<ObjectId>, Miss> {
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

    fn is_of_color(&self, object: &KnownObject, asked: &str) -> Understanding {
        let color = describe::color(self.catalog, object);
        if color.is_empty() {
            return self.cannot_tell(object);
        }
        let the = format!("the {}", describe::name(self.catalog, object.class));
        self.told(color.contains(asked), &format!("{the} {} {color}", prose::is(&the)), object.id)
    }

    /// Whether something poured is in what is named, or anywhere; nothing, where it is spoken of as a thing: `is the milk in the fridge`.
    pub(crate) fn filled(&self, phrase: &Phrase, filling: Filling) -> Option<Understanding> {
        let fills = filling.name();
        let Some(relation) = phrase.relations.iter().find(|relation| relation.kind == RelationKind::Inside) else {
            let is_thing = !phrase.namings.is_empty() || phrase.room.is_some();
            let found = || self.scene.objects.iter().filter(|object| filling.is_in(object)).map(|object| object.id);
            let full: Vec<String> = found().take(contents::LIST).map(|id| self.full(id)).collect();
            return (!is_thing).then(|| match full.is_empty() {
                true => Understanding::whether(false, format!("I have seen no {fills}."), Vec::new()),
                false => {
                    let text = format!("Yes, there is {fills} in {}.", prose::list(&full, "and"));
                    Understanding::whether(true, text, found().collect())
                }
            });
        };
        let id = self.ground().one(&relation.to, &Want::place(Intent::Find, &[], None)).ok()?;
        let object = self.scene.object(id)?;
        let is_thing =
            !phrase.namings.is_empty() && (!self.can_be_filled(object) || self.scene.contents(id).next().is_some());
        (!is_thing).then(|| self.is_filled(object, filling))
    }

    fn is_filled(&self, object: &KnownObject, filling: Filling) -> Understanding {
        let (id, fills) = (object.id, filling.name());
        let within = self.scene.contents(id).find(|inner| filling.is_in(inner));
        if let Some(full) = std::iter::once(object).find(|object| filling.is_in(object)).or(within) {
            let text = format!("there is {fills} in {}", self.short(full.id));
            return self.told(true, &text, full.id);
        }
        if !self.can_be_filled(object) {
            return self.cannot_tell(object);
        }
        let instead = match self.fillings(id) {
            None => "it is empty".to_owned(),
            Some(other) => format!("there is {other} in it"),
        };
        self.told(false, &format!("there is no {fills} in {}: {instead}", self.short(id)), id)
    }

    /// Whether `it` stands for nothing that comes to an end, or for nothing at all.
    fn is_never_done(&self, phrase: &Phrase) -> bool {
        let found = self.ground().one(phrase, &Want::place(Intent::Find, &[], None)).ok();
        let ends = found.and_then(|id| self.scene.object(id)).is_some_and(|object| {
            let class = self.catalog.class(object.class);
            let may_end = [Property::Toggleable, Property::Heatable].into_iter().any(|property| class.has(property));
            may_end || self.machine_around(object).is_some()
        });
        phrase.is_bare_pronoun() && !ends
    }

    /// Whether what flows is made that a machine makes, or boils: `is the coffee ready?` while the coffee maker runs, `is the water ready?` of
    /// the kettle. Nothing, where no machine is at it.
    fn is_made(&self, phrase: &Phrase, filling: Filling) -> Option<Understanding> {
        let Filling::Fluid(fluid) = filling else { return None };
        let (processes, is_water) = (&self.devices.processes, fluid == Fluid::Water);
        let is_maker = |object: &&KnownObject| {
            processes.iter().any(|process| match process.intent {
                Intent::Tea => is_water && process.of.contains(&object.class),
                Intent::Brew => !is_water && process.at.contains(&object.class) && self.brews(object, fluid),
                _ => false,
            })
        };
        if phrase.is_described() {
            return None;
        }
        let makers: Vec<&KnownObject> = self.scene.objects.iter().filter(is_maker).collect();
        let running = makers.iter().find(|maker| maker.has(StateFlag::Toggled));
        let boiler = makers.iter().find(|maker| is_water && maker.fluid == fluid);
        let maker = running.or(boiler)?;
        if !is_water || maker.has(StateFlag::Toggled) {
            return Some(self.is_done(maker));
        }
        let not = if maker.has(StateFlag::Hot) { "" } else { "not " };
        let text = format!("the water in {} is {not}hot", self.short(maker.id));
        Some(self.told(not.is_empty(), &text, maker.id))
    }

    fn brews(&self, maker: &KnownObject, fluid: Fluid) -> bool {
        let mut fills = self.devices.processes.iter().filter(|process| process.intent == Intent::Fill);
        fills.any(|process| process.fluid == Some(fluid) && process.at.contains(&maker.class))
    }

    /// `is dinner ready?`: whether the machine that it switched on last to cook is done.
    pub(crate) fn meal(&self) -> Understanding {
        let cooks = |object: &&KnownObject| {
            let is_cooking = |intent: Intent| matches!(intent, Intent::Heat | Intent::Toast);
            let mut processes = self.devices.processes.iter();
            processes.any(|process| is_cooking(process.intent) && process.at.contains(&object.class))
        };
        let last = self.context.deeds.last_done_to(Intent::TurnOn).and_then(|id| self.scene.object(id));
        match last.filter(cooks) {
            Some(cooker) => self.is_done(cooker),
            None => Understanding::whether(false, "No, I have cooked nothing that I know of.", Vec::new()),
        }
    }

    /// The machine in which a thing is, if it works on what is in it.
    fn machine_around(&self, object: &KnownObject) -> Option<&KnownObject> {
        self.scene.ancestors(object.id).find(|outer| self.has_work(outer))
    }

    fn has_work(&self, object: &KnownObject) -> bool {
        self.catalog.table().device(&self.catalog.class(object.class).id).work.is_some()
    }

    /// Whether a machine has run its time, or what is to be warm is so; what is in a machine is done when that is.
    fn is_done(&self, object: &KnownObject) -> Understanding {
        let (class, the) = (self.catalog.class(object.class), self.short(object.id));
        let around = || {
            let machine = self.machine_around(object)?;
            let is_worked_on = machine.has(StateFlag::Toggled) || self.context.deeds.did(Intent::TurnOn, machine.id);
            is_worked_on.then_some(machine)
        };
        match () {
            () if class.has(Property::Toggleable) => {
                let is_on = object.has(StateFlag::Toggled);
                let has_run = self.has_work(object) && self.context.deeds.did(Intent::TurnOn, object.id);
                let state = match (is_on, has_run) {
                    (true, _) => "still on",
                    (false, true) => "done",
                    (false, false) => "off",
                };
                self.told(!is_on, &format!("{the} {} {state}", prose::is(&the)), object.id)
            }
            () if let Some(machine) = around() => self.is_done(machine),
            () if class.has(Property::Heatable) => {
                let is_warm = object.has(StateFlag::Hot) || object.has(StateFlag::Cooked);
                let not = if is_warm { "" } else { "not " };
                self.told(is_warm, &format!("{the} {} {not}warm", prose::is(&the)), object.id)
            }
            () => self.cannot_tell(object),
        }
    }

    fn can_be_filled(&self, object: &KnownObject) -> bool {
        self.catalog.class(object.class).has(Property::Fillable)
    }

    /// The same, of a question whose beginning does not tell that it wants a yes or a no: `does the radio work`.
    pub(crate) fn claim_told(&self, phrase: &Phrase, question: &Question) -> Option<Understanding> {
        let claim = Claim::read(self.lexicon, phrase, &question.rest);
        matches!(claim, Claim::Sound(_) | Claim::Full(_) | Claim::Color(_)).then(|| self.claim(phrase, question))
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

    fn cannot_tell(&self, object: &KnownObject) -> Understanding {
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
const fn may_be(state: StateWord) -> &'static [Property] {
    match state {
        StateWord::Flag(StateFlag::Dirty, _) => &[Property::Dirtyable],
        StateWord::Flag(StateFlag::Broken, _) => &[Property::Breakable],
        StateWord::Flag(StateFlag::Opened, _) => &[Property::Openable],
        StateWord::Flag(StateFlag::Toggled, _) => &[Property::Toggleable, Property::Powerable],
        StateWord::Filled(_) => &[Property::Fillable],
        StateWord::Flag(..) => &[],
    }
}
