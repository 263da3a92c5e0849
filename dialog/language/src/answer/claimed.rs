//! Whether what is claimed of a thing is so.
//!
//! What the robot cannot tell is neither true nor false: it says so, and what it knows of the thing instead.

use cohabit_cdf::{ClassId, Fluid, ObjectId, Property, state::StateFlag};

use crate::{
    answer::{
        Answerer,
        claim::{Claim, Filling, asked_either},
        state::may_be,
    },
    ground::want::{Miss, Want},
    known::{KnownObject, contents, describe},
    read::{
        phrase::{Phrase, RelationKind},
        question::Question,
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
        let is_one = !meant.is_any && !meant.is_all && !meant.is_many();
        if let Some(either) = asked_either(self.lexicon, &question.rest).filter(|_| is_one) {
            return self.with_object_that(may_be(either[0].0), &meant, |id| self.which_state(id, &either));
        }
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
            Claim::Done => self.with_known(&meant, |object| {
                let asks_for_parts = self.lexicon.yes_no.says_whole(&question.rest);
                self.is_whole(object).filter(|_| asks_for_parts).unwrap_or_else(|| self.is_done(object))
            }),
            Claim::Back => self.with_known(&bare, |object| self.is_back(object)),
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

    pub(crate) fn told(&self, holds: bool, text: &str, id: ObjectId) -> Understanding {
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

    pub(crate) fn has_work(&self, object: &KnownObject) -> bool {
        self.catalog.table().device(&self.catalog.class(object.class).id).work.is_some()
    }

    /// Whether a machine has all parts that it is not worked without, and what it lacks; nothing, where it needs none.
    fn is_whole(&self, object: &KnownObject) -> Option<Understanding> {
        let lacked = self.facts().lacked(object)?;
        let (the, lacked) =
            (self.short(object.id), lacked.iter().map(|part| format!("its {part}")).collect::<Vec<_>>());
        let text = match lacked.is_empty() {
            true => format!("{the} is complete: nothing is missing in it"),
            false => format!("{the} is not complete: it lacks {}", prose::list(&lacked, "and")),
        };
        Some(self.told(lacked.is_empty(), &text, object.id))
    }

    /// Whether a machine has run its time, or what is to be warm is so; what is in a machine is done when that is.
    fn is_done(&self, object: &KnownObject) -> Understanding {
        let (class, the) = (self.catalog.class(object.class), self.short(object.id));
        let around = || {
            let machine = self.machine_around(object)?;
            let is_worked_on = machine.has(StateFlag::Toggled) || self.context.deeds.did(Intent::TurnOn, machine.id);
            is_worked_on.then_some(machine)
        };
        let is_on = object.has(StateFlag::Toggled);
        let has_run = self.has_work(object) && self.context.deeds.did(Intent::TurnOn, object.id);
        match () {
            () if has_run && !is_on && object.has(StateFlag::Hot) && object.fluid != Fluid::None => {
                let fills = object.fluid.name().to_lowercase();
                self.told(true, &format!("the {fills} in {the} is hot"), object.id)
            }
            () if class.has(Property::Toggleable) => {
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

    /// Whether a thing is where it was before the robot took it, for the first time or the last.
    fn is_back(&self, object: &KnownObject) -> Understanding {
        let (id, place, focus) = (object.id, self.place_sentence(object.id), &self.context.focus);
        let Some((_, first)) = focus.firsts.iter().find(|(taken, _)| *taken == id) else {
            return Understanding::about(format!("I have not taken {} anywhere: {place}.", self.short(id)), vec![id]);
        };
        let is_at = |from: Option<ObjectId>| match from {
            Some(place) => object.parent == Some(place),
            None => self.scene.is_on_floor(object),
        };
        let is_at_last = focus.origins.iter().any(|(taken, from)| *taken == id && is_at(Some(*from)));
        self.told(is_at(*first) || is_at_last, &place, id)
    }

    fn can_be_filled(&self, object: &KnownObject) -> bool {
        self.catalog.class(object.class).has(Property::Fillable)
    }

    /// The same, of a question whose beginning does not tell that it wants a yes or a no: `does the radio work`.
    pub(crate) fn claim_told(&self, phrase: &Phrase, question: &Question) -> Option<Understanding> {
        let claim = Claim::read(self.lexicon, phrase, &question.rest);
        matches!(claim, Claim::Sound(_) | Claim::Full(_) | Claim::Color(_)).then(|| self.claim(phrase, question))
    }
}
