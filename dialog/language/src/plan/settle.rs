//! Decides what each prepositional phrase of a clause belongs to: the object (`the mug on the desk`), the place to go to
//! (`put it on the desk`), or the tool (`with the hammer`).

use crate::{
    ground::want::{Miss, Want},
    plan::Planner,
    read::{
        clause::Clause,
        phrase::{Phrase, Place},
        slot::Role,
    },
    words::{
        intent::Intent,
        lexicon::{Manner, Preposition, Pronoun, Side},
    },
};

/// A clause whose phrases have found their places.
#[derive(Clone, Debug)]
pub(crate) struct Settled {
    pub(crate) intent: Intent,
    pub(crate) objects: Vec<Phrase>,
    pub(crate) goal: Option<Goal>,
    pub(crate) tool: Option<(Phrase, Role)>,
    pub(crate) color: Option<String>,
    pub(crate) fluid: Option<cohabit_cdf::Fluid>,
    /// Whether it is to go into something that was made for it.
    pub(crate) is_inserted: bool,
    /// Whether it is to go back to where it was taken from.
    pub(crate) is_back: bool,
    /// Whether to be rid of it.
    pub(crate) is_away: bool,
    /// Whether it is to go where such things are kept.
    pub(crate) is_stored: bool,
    /// Whether it is to be left, somewhere or as it is.
    pub(crate) is_left: bool,
    /// Whether it was wished for.
    pub(crate) is_wish: bool,
    /// Whether it is done by who goes out.
    pub(crate) is_leaving: bool,
}

/// Where the object is to go, or where it is to be done.
#[derive(Clone, Debug)]
pub(crate) struct Goal {
    pub(crate) preposition: Preposition,
    pub(crate) place: Place,
    pub(crate) role: Role,
}

/// Verbs whose objects go somewhere, or are worked on somewhere.
const fn has_goal(intent: Intent) -> bool {
    intent.is_about_held() || matches!(intent, Intent::Use | Intent::Print | Intent::Tea)
}

/// Verbs done `with` something.
const fn has_tool(intent: Intent) -> bool {
    !matches!(
        intent,
        Intent::Place
            | Intent::Bring
            | Intent::PickUp
            | Intent::Find
            | Intent::Highlight
            | Intent::Examine
            | Intent::LookIn
            | Intent::LookUnder
    )
}

/// Settles a clause.
pub(crate) fn settle(planner: &Planner<'_>, clause: &Clause) -> Settled {
    let mut settled = Settled {
        intent: clause.intent,
        objects: clause.objects.clone(),
        goal: None,
        tool: None,
        color: clause.color.clone(),
        fluid: clause.fluid,
        is_wish: clause.is_wish,
        is_leaving: clause.is_leaving,
        is_left: clause.manner == Some(Manner::Leave),
        is_inserted: clause.manner == Some(Manner::Insert),
        is_back: clause.manner == Some(Manner::Back),
        is_away: clause.manner == Some(Manner::Away),
        is_stored: clause.manner == Some(Manner::Store),
    };
    for (index, (preposition, place)) in clause.places.iter().enumerate() {
        let role = Role::Place(index);
        match (preposition, place) {
            (Preposition::With, Place::Object(phrase)) if has_tool(clause.intent) => {
                settled.tool = Some((phrase.clone(), role));
            }
            // `put it into the fridge with it`: said twice.
            (Preposition::With, Place::Object(phrase))
                if matches!(clause.intent, Intent::Place | Intent::Bring) && phrase.is_bare_pronoun() => {}
            // `shut the door behind you`: from where the robot is then, and not the door at its back.
            (_, Place::Side(Side::Behind)) if clause.intent == Intent::Close => {}
            // `fill it from the tap`
            (Preposition::From, Place::Object(_)) if clause.intent == Intent::Fill => {
                settled.take_place(planner, Preposition::At, place, role);
            }
            // `switch the laser on from its computer`
            (Preposition::From, Place::Object(_))
                if matches!(clause.intent, Intent::TurnOn | Intent::TurnOff | Intent::Toggle) => {}
            (Preposition::From, _) => settled.describe_object(Preposition::From, place),
            // `put away everything on the table`
            (Preposition::On | Preposition::In, Place::Object(_))
                if settled.is_stored && settled.is_of_everything() =>
            {
                settled.describe_object(*preposition, &found(planner, place));
            }
            _ if has_goal(clause.intent) => settled.take_place(planner, *preposition, place, role),
            _ => settled.describe_object(*preposition, place),
        }
    }
    settled.name_goal(planner);
    settled
}

/// A place as the one thing that it means, if it means one.
fn found(planner: &Planner<'_>, place: &Place) -> Place {
    let Place::Object(phrase) = place else { return place.clone() };
    let chosen = planner.ground().one(phrase, &Want::place(Intent::Place, &[], None)).ok();
    Place::Object(Phrase { chosen, ..phrase.clone() })
}

impl Settled {
    /// Whether it is about all things, whatever they are.
    pub(crate) fn is_of_everything(&self) -> bool {
        self.objects.last().is_some_and(|object| object.is_all && object.pronoun == Some(Pronoun::Thing))
    }

    /// `from the green desk to the red one`, `the red apple next to the green one`: one of those named before it.
    fn name_goal(&mut self, planner: &Planner<'_>) {
        let Some(object) = self.objects.last() else { return };
        let mut before = object.relations.last().map_or(&object.namings, |relation| &relation.to.namings).clone();
        // `take it off the green desk and put it on the blue one`, `the thing on the green desk, put it on the blue one`
        if before.is_empty() {
            before = planner.origin_kind();
        }
        if before.is_empty() {
            before = planner.place_kind(object, self.intent);
        }
        let before = planner.of_kind(&before);
        if let Some(Goal { place: Place::Object(phrase), .. }) = &mut self.goal
            && phrase.pronoun == Some(Pronoun::One)
            && phrase.namings.is_empty()
            && !before.is_empty()
        {
            phrase.namings = before;
        }
    }

    /// The same with nowhere to go, which says where the thing is if it is there: `throw away the donut on the table`.
    pub(crate) fn without_goal(&self, planner: &Planner<'_>) -> Self {
        let mut settled = Self { goal: None, ..self.clone() };
        if let Some(Goal { preposition, place: place @ Place::Object(phrase), .. }) = &self.goal
            && self.stands_there(planner, phrase)
        {
            settled.describe_object(*preposition, place);
        }
        settled
    }

    fn is_generic(&self) -> bool {
        let is_thing = |phrase: &Phrase| phrase.pronoun == Some(Pronoun::Thing) && phrase.text.starts_with("the ");
        self.objects.last().is_some_and(is_thing)
    }

    fn describe_object(&mut self, preposition: Preposition, place: &Place) {
        if let Some(object) = self.objects.last_mut() {
            object.attach(preposition, place.clone());
        }
    }

    fn take_place(&mut self, planner: &Planner<'_>, preposition: Preposition, place: &Place, role: Role) {
        let goal = || Some(Goal { preposition, place: place.clone(), role });
        let is_generic = self.intent == Intent::Bring && self.is_generic();
        let is_beside = |phrase: &Phrase| self.stands_beside(planner, preposition, phrase, Preposition::To);
        let is_described = self.intent == Intent::Bring && matches!(place, Place::Object(phrase) if is_beside(phrase));
        match (&mut self.goal, place) {
            // `put it in the kitchen on the table`
            (Some(Goal { place: Place::Room(room), .. }), Place::Object(phrase)) => {
                let phrase = Phrase { room: Some(room.id), ..phrase.clone() };
                self.goal = Some(Goal { preposition, place: Place::Object(phrase), role });
            }
            (Some(Goal { preposition: first, place: Place::Object(phrase), .. }), Place::Object(_))
                if first.is_beside() && !preposition.is_beside() =>
            {
                let (before, first) = (phrase.clone(), *first);
                // `put the cup next to the sink on the table`
                if self.stands_beside(planner, first, &before, preposition) && !is_there(planner, &before, place) {
                    self.describe_object(first, &Place::Object(before));
                    self.goal = goal();
                } else {
                    phrase_of(&mut self.goal).into_iter().for_each(|phrase| phrase.attach(preposition, place.clone()));
                }
            }
            (Some(Goal { place: Place::Object(phrase), .. }), _) if preposition.is_beside() => {
                phrase.attach(preposition, place.clone());
            }
            (Some(Goal { place: Place::Object(phrase), .. }), Place::Object(_)) => {
                let before = phrase.clone();
                if self.stands_there(planner, &before) {
                    let inner = self.goal.take();
                    inner.into_iter().for_each(|goal| self.describe_object(goal.preposition, &goal.place));
                    self.goal = goal();
                } else {
                    phrase_of(&mut self.goal).into_iter().for_each(|phrase| phrase.attach(preposition, place.clone()));
                }
            }
            (Some(Goal { place: Place::Object(phrase), .. }), _) => phrase.attach(preposition, place.clone()),
            // `bring it here`
            (None, Place::Here) if self.objects.last().is_some_and(|object| object.is_bare_pronoun()) => {}
            (Some(_), _) | (None, Place::Side(_) | Place::Here) => self.describe_object(preposition, place),
            // `fill the bowl in the kitchen` says where the bowl is, `put it in the kitchen` where it goes.
            (None, Place::Room(_)) if !matches!(self.intent, Intent::Place | Intent::Bring | Intent::Drop) => {
                self.describe_object(preposition, place);
            }
            // `wash the shirt on the floor`: nothing is done on the floor.
            (None, Place::Object(phrase))
                if phrase.is_floor && !matches!(self.intent, Intent::Place | Intent::Drop | Intent::Throw) =>
            {
                self.describe_object(preposition, place);
            }
            // `bring me the cup next to the sink`
            (None, Place::Object(_)) if is_described => self.describe_object(preposition, place),
            // `bring me the thing on the desk`
            (None, _) if is_generic && preposition != Preposition::To => {
                self.describe_object(preposition, place);
            }
            (None, _) => self.goal = goal(),
        }
    }

    /// Whether the object is known to be on or in what `place` means.
    fn stands_there(&self, planner: &Planner<'_>, place: &Phrase) -> bool {
        let Some(object) = self.objects.last().filter(|object| object.pronoun.is_none() || object.is_all) else {
            return false;
        };
        let mut there = object.clone();
        there.attach(Preposition::On, Place::Object(place.clone()));
        matches!(planner.ground().one(&there, &Want::object(self.intent)), Ok(_) | Err(Miss::Several(_)))
    }

    /// Whether the object is known to be beside what `place` means, so that `next to the sink` may say which one it is, and what
    /// stands after that where it goes.
    fn stands_beside(&self, planner: &Planner<'_>, beside: Preposition, place: &Phrase, then: Preposition) -> bool {
        if !beside.is_beside() || !matches!(then, Preposition::On | Preposition::In | Preposition::To) {
            return false;
        }
        let Some(object) = self.objects.last().filter(|object| object.pronoun.is_none()) else { return false };
        let mut there = object.clone();
        there.attach(beside, Place::Object(place.clone()));
        matches!(planner.ground().one(&there, &Want::object(self.intent)), Ok(_) | Err(Miss::Several(_)))
    }
}

/// Whether what `phrase` means is known to be on or in a place: `the plate on the table`.
fn is_there(planner: &Planner<'_>, phrase: &Phrase, place: &Place) -> bool {
    let mut there = phrase.clone();
    there.attach(Preposition::On, place.clone());
    let want = Want::place(Intent::Place, &[], None);
    matches!(planner.ground().one(&there, &want), Ok(_) | Err(Miss::Several(_)))
}

fn phrase_of(goal: &mut Option<Goal>) -> Option<&mut Phrase> {
    match goal {
        Some(Goal { place: Place::Object(phrase), .. }) => Some(phrase),
        _ => None,
    }
}
