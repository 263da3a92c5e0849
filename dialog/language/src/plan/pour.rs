//! Plans of pouring.

use cohabit_cdf::{Action, ClassId, Fluid, ObjectId, Property, StateFlag, Verb};

use crate::{
    ground::want::{Miss, Want},
    known::{KnownObject, contents},
    plan::{
        Fault, Planner,
        carry::TAKES,
        settle::{Goal, Settled},
    },
    read::{
        phrase::{Phrase, Place, RelationKind},
        slot::Role,
    },
    words::{intent::Intent, lexicon::Preposition, prose},
};

impl Planner<'_> {
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

    /// `make tea`: boils water, and pours it into a cup.
    pub(crate) fn add_tea(&mut self, settled: &Settled) -> Result<(), Fault> {
        let kettles: Vec<ClassId> = self.in_itself(Intent::Tea).flat_map(|process| process.of.clone()).collect();
        let kettle = self.nearest(&kettles).ok_or_else(|| self.need(&kettles, "I do not know where a kettle is."))?;
        let named = match (&settled.goal, settled.objects.first()) {
            (Some(Goal { preposition: Preposition::In, place: Place::Object(phrase), role }), _) => {
                Some((phrase, *role))
            }
            (_, Some(phrase)) => Some((phrase, Role::Object(0))),
            _ => None,
        };
        let named = named.map(|(phrase, role)| self.vessel(phrase, role, kettle)).transpose()?;
        // `make tea in the kettle`: its water is boiled there.
        let cup = named.filter(|cup| *cup != kettle).map_or_else(|| self.cup(kettle), Ok)?;
        let is_hot = self.scene.object(kettle).is_some_and(|one| one.has(StateFlag::Hot) && one.fluid == Fluid::Water);
        if !is_hot {
            self.boil(kettle)?;
        }
        self.pour(kettle, cup)
    }

    /// Something empty that tea is made in.
    fn cup(&self, kettle: ObjectId) -> Result<ObjectId, Fault> {
        let cups: Vec<ClassId> = self.in_itself(Intent::Tea).flat_map(|process| process.object.clone()).collect();
        let is_cup = |one: &&KnownObject| cups.contains(&one.class) && one.fluid == Fluid::None && one.id != kettle;
        let is_fit = |one: &&KnownObject| is_cup(one) && !one.has(StateFlag::Broken) && !one.has(StateFlag::Dirty);
        let cup = self.nearest_of(self.scene.objects.iter().filter(is_fit));
        cup.ok_or_else(|| self.need(&cups, "I do not know where a clean cup is."))
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
        let is_cereal = |known: &KnownObject| Some(known.class) == self.catalog.find(contents::CEREAL_BOX);
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
        if self.is_full(target) && self.has(source, Property::Fillable) {
            return self.offer_to_empty(source, target);
        }
        self.tip(source, target)
    }

    /// Whether nothing more goes into it; what is poured into a basin runs off.
    fn is_full(&self, target: ObjectId) -> bool {
        let is_basin = |class| self.catalog.table().is_basin(&self.catalog.class(class).id);
        self.scene.object(target).is_some_and(|known| known.fluid != Fluid::None && !is_basin(known.class))
    }

    /// That something is full already, and what it takes to pour into it all the same.
    fn offer_to_empty(&mut self, source: ObjectId, target: ObjectId) -> Result<(), Fault> {
        let full = prose::sentence(&format!("{} is full already", self.the(target)));
        if !self.has(target, Property::Pickupable) {
            return Err(Fault::Cannot(full));
        }
        self.empty(target)?;
        self.tip(source, target)?;
        let text = format!("{full} Shall I empty it first?");
        Err(Fault::Offer { text, steps: std::mem::take(&mut self.steps) })
    }

    /// Pours away what is in a vessel, and has that back where it was, and in the hand what was there before.
    pub(super) fn empty(&mut self, vessel: ObjectId) -> Result<(), Fault> {
        let (held, stood_on) = (self.scene.robot.held, self.taken_from(vessel));
        let sink = self.nearest_sink()?;
        self.tip(vessel, sink)?;
        if held == Some(vessel) {
            return Ok(());
        }
        stood_on.into_iter().for_each(|place| self.place_on(place));
        held.map_or(Ok(()), |held| self.hold(held))
    }

    /// Takes something, and pours what is in it into something else.
    fn tip(&mut self, source: ObjectId, target: ObjectId) -> Result<(), Fault> {
        self.hold(source)?;
        self.open_around(target, false);
        let says = format!("pouring {} into {}", self.what_is_in(source), self.the(target));
        self.push(Action::Interact { verb: Verb::Pour, object: target }, says);
        Ok(())
    }

    /// Takes something with `fluid` in it in the hand, and fills it first if there is none: what was named for it, or else nothing of the
    /// classes `but`.
    pub(crate) fn hold_vessel(&mut self, fluid: Fluid, named: Option<ObjectId>, but: &[ClassId]) -> Result<(), Fault> {
        if let Some(vessel) = named {
            return match self.scene.object(vessel).map_or(Fluid::None, |known| known.fluid) {
                inside if inside == fluid => self.hold(vessel),
                Fluid::None => self.fill(vessel, fluid),
                other => {
                    let text = format!("There is {} in {}.", other.name().to_lowercase(), self.the(vessel));
                    Err(Fault::Cannot(text))
                }
            };
        }
        let carries = |object: &&KnownObject| {
            let class = self.catalog.class(object.class);
            let takes = class.has(Property::Fillable) && class.has(Property::Pickupable);
            takes && !but.contains(&object.class) && !object.has(StateFlag::Broken)
        };
        let with = |inside: Fluid| self.scene.objects.iter().filter(carries).filter(move |one| one.fluid == inside);
        let held = |one: &&KnownObject| Some(one.id) == self.scene.robot.held;
        let pick = |inside: Fluid| {
            let in_hand = with(inside).find(held).map(|one| one.id);
            let made_for_it =
                || self.nearest_of(with(inside).filter(|one| self.devices.watering_cans.contains(&one.class)));
            in_hand.or_else(made_for_it).or_else(|| self.nearest_of(with(inside)))
        };
        if let Some(full) = pick(fluid) {
            return self.hold(full);
        }
        let name = fluid.name().to_lowercase();
        let Some(empty) = pick(Fluid::None) else {
            return Err(
                self.need(&self.devices.watering_cans, format!("I do not know of anything to carry {name} in."))
            );
        };
        self.fill(empty, fluid)
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
}
