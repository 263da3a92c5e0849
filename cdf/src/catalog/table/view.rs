//! The table evaluated over a state: any that can answer for its things.

use std::sync::LazyLock;

use super::{
    ActionKind, ActionTable, Device, Need, Rule,
    change::{Change, Effect},
    condition::{Condition, Content, Range, Term, Test},
};
use crate::{
    action::{ObjectId, Status},
    catalog::{Catalog, ObjectClass, Property},
    state::{Fluid, StateFlag},
};

/// A state as one body acts on it. What an observer cannot tell it takes to be as it would like it: the world rules.
pub trait View {
    /// The catalogue that its classes are of.
    fn catalog(&self) -> &Catalog;
    /// Whether there is such a thing.
    fn exists(&self, id: ObjectId) -> bool;
    /// Its class.
    fn class(&self, id: ObjectId) -> &ObjectClass;
    /// Whether a flag is set.
    fn is(&self, id: ObjectId, flag: StateFlag) -> bool;
    /// What fills it.
    fn fluid(&self, id: ObjectId) -> Fluid;
    /// What the body holds.
    fn held(&self) -> Option<ObjectId>;
    /// What a thing is in or on.
    fn parent(&self, id: ObjectId) -> Option<ObjectId>;
    /// All that is directly in or on it.
    fn children(&self, id: ObjectId) -> Vec<ObjectId>;
    /// The same, less what stands on the top of what has a door.
    fn inside(&self, id: ObjectId) -> Vec<ObjectId> {
        self.children(id)
    }
    /// Whether another body holds it.
    fn is_in_another_hand(&self, id: ObjectId) -> bool;
    /// What a device works, or aims at: as the floor plan says, or the nearest of its kind.
    fn machine(&self, id: ObjectId) -> Option<ObjectId>;
    /// A sink that a hand reaches.
    fn basin(&self) -> Option<ObjectId>;

    /// The nearest shut thing that it is in.
    fn cover(&self, id: ObjectId) -> Option<ObjectId> {
        let mut inner = id;
        while let Some(outer) = self.parent(inner) {
            if self.is_shut(outer) && self.inside(outer).contains(&inner) {
                return Some(outer);
            }
            inner = outer;
        }
        None
    }
    /// Whether its contents are behind a door that is closed.
    fn is_shut(&self, id: ObjectId) -> bool {
        let class = self.class(id);
        let enclosed = class.receptacle.as_ref().is_some_and(|kind| kind.enclosed);
        enclosed && class.has(Property::Openable) && !self.is(id, StateFlag::Opened)
    }
    /// Whether it is near enough.
    fn within(&self, _id: ObjectId, _range: Range) -> bool {
        true
    }
    /// Whether nothing stands between.
    fn is_accessible(&self, _id: ObjectId) -> bool {
        true
    }
    /// Whether it is in a slot of a vending machine.
    fn is_behind_glass(&self, _id: ObjectId) -> bool {
        false
    }
    /// Whether there is a way to it.
    fn is_on_the_way(&self, _id: ObjectId) -> bool {
        true
    }
    /// Whether a place is free in it that a hand can put something at.
    fn has_room(&self, _id: ObjectId) -> bool {
        true
    }
    /// Whether such a place fits another thing.
    fn has_room_for(&self, _id: ObjectId, _thing: ObjectId) -> bool {
        true
    }
    /// Whether any place is free in it.
    fn has_free_place(&self, _id: ObjectId) -> bool {
        true
    }
    /// Whether something is in it that says what it prints.
    fn has_cartridge(&self, id: ObjectId) -> bool {
        self.children(id).into_iter().any(|child| self.catalog().table().prints(&self.class(child).id).is_some())
    }
    /// What is in a slot of a vending machine.
    fn sells(&self, _id: ObjectId, _slot: u16) -> bool {
        true
    }
    /// Whether it switches a circuit.
    fn feeds(&self, _id: ObjectId) -> bool {
        true
    }
    /// Whether it is a portal, and whether that is open.
    fn gate(&self, _id: ObjectId) -> Option<bool> {
        None
    }
    /// Whether a portal lets that pass.
    fn lets_pass(&self, _gate: ObjectId, _thing: ObjectId) -> bool {
        true
    }
    /// Whether nobody stands in its doorway.
    fn is_clear(&self, _id: ObjectId) -> bool {
        true
    }
    /// Whether the doors that buttons work can move now.
    fn doors_are_clear(&self) -> bool {
        true
    }

    /// Whether it needs no power, or has it.
    fn is_powered(&self, id: ObjectId) -> bool {
        !self.class(id).has(Property::Powerable) || self.is(id, StateFlag::Powered)
    }
    /// All in it at any depth, nearest first.
    fn contents(&self, id: ObjectId) -> Vec<ObjectId> {
        let mut found = self.inside(id);
        let mut next = 0;
        while next < found.len() {
            let deeper = self.inside(found[next]);
            found.extend(deeper);
            next += 1;
        }
        found
    }
    /// Whether it is what is held, or in or on that.
    fn is_in_held(&self, id: ObjectId) -> bool {
        self.held().is_some_and(|held| std::iter::successors(Some(id), |id| self.parent(*id)).any(|id| id == held))
    }
}

/// Who is meant by the terms of conditions and changes.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Scope {
    /// What the action is done to.
    pub it: Option<ObjectId>,
    /// What a work is done to.
    pub thing: Option<ObjectId>,
    /// What does the work.
    pub machine: Option<ObjectId>,
}

impl Scope {
    /// An action on an object.
    #[must_use]
    pub const fn of(it: ObjectId) -> Self {
        Self { it: Some(it), thing: None, machine: None }
    }

    /// Who is meant by a term.
    pub fn get(&self, view: &impl View, term: Term) -> Option<ObjectId> {
        match term {
            Term::It => self.it,
            Term::Held => view.held(),
            Term::Holder => self.it.and_then(|it| view.parent(it)),
            Term::Machine => self.machine.or_else(|| self.it.and_then(|it| view.machine(it))),
            Term::Basin => view.basin(),
            Term::Thing => self.thing,
        }
    }

    /// Whether a condition holds. Of what is not there nothing holds.
    pub fn holds(&self, view: &impl View, condition: &Condition) -> bool {
        let found = match condition.test {
            Test::Never => false,
            Test::DoorsClear => view.doors_are_clear(),
            _ => self.get(view, condition.term).is_some_and(|id| passes(view, id, &condition.test)),
        };
        found != condition.negated
    }

    /// Whether all hold.
    pub fn all_hold(&self, view: &impl View, conditions: &[Condition]) -> bool {
        conditions.iter().all(|condition| self.holds(view, condition))
    }

    /// The first need that is not met.
    pub fn lacks<'t>(&self, view: &impl View, needs: &'t [Need]) -> Option<&'t Need> {
        needs.iter().find(|need| !need.any.iter().any(|condition| self.holds(view, condition)))
    }

    /// Whether changes that follow would put a thing into itself, or into what is in or on it.
    fn puts_into_itself(&self, view: &impl View, effects: &[Effect]) -> bool {
        effects.iter().any(|effect| {
            let into_itself = |change: &Change| {
                let Change::Put(thing, place) = change else { return false };
                let (Some(thing), Some(place)) = (self.get(view, *thing), self.get(view, *place)) else { return false };
                std::iter::successors(Some(place), |id| view.parent(*id)).any(|id| id == thing)
            };
            effect.changes.iter().any(into_itself) && self.all_hold(view, &effect.when)
        })
    }

    /// The changes that follow.
    pub fn changes<'t>(&self, view: &impl View, effects: &'t [Effect]) -> Vec<&'t Change> {
        let follow = effects.iter().filter(|effect| self.all_hold(view, &effect.when));
        follow.flat_map(|effect| &effect.changes).collect()
    }
}

fn passes(view: &impl View, id: ObjectId, test: &Test) -> bool {
    let class = || view.class(id);
    match test {
        Test::Exists => view.exists(id),
        Test::Free => !view.is_in_another_hand(id),
        Test::PutDown => view.held() != Some(id) && !view.is_in_another_hand(id),
        // What is in the own hand is at hand.
        Test::Uncovered => view.held() == Some(id) || view.cover(id).is_none(),
        Test::Within(range) => (view.held() == Some(id) && *range != Range::Throw) || view.within(id, *range),
        Test::Accessible => view.held() == Some(id) || view.is_accessible(id),
        Test::BehindGlass => view.is_behind_glass(id),
        Test::OnTheWay => view.is_on_the_way(id),
        Test::Affords(property) => class().has(*property),
        Test::Is(flag) => view.is(id, *flag),
        Test::IsA(pattern) => pattern.matches(&class().id),
        Test::Held => view.held() == Some(id),
        Test::InHeld => view.is_in_held(id),
        Test::Filled => view.fluid(id) != Fluid::None,
        Test::Holds(fluid) => view.fluid(id) == *fluid,
        Test::HoldsA(pattern) => view.children(id).into_iter().any(|child| pattern.matches(&view.class(child).id)),
        Test::HoldsWhole(pattern) => {
            let is_it =
                |child: &ObjectId| pattern.matches(&view.class(*child).id) && !view.is(*child, StateFlag::Broken);
            view.children(id).iter().any(is_it)
        }
        Test::Contains(content) => view.contents(id).into_iter().any(|inner| match content {
            Content::Filled => view.fluid(inner) != Fluid::None,
            Content::Fluid(fluid) => view.fluid(inner) == *fluid,
            Content::Class(pattern) => pattern.matches(&view.class(inner).id),
        }),
        Test::Shut => view.is_shut(id),
        Test::Powered => view.is_powered(id),
        Test::Occupied => !view.inside(id).is_empty(),
        Test::TakesHeld => view.held().is_some_and(|held| takes(class(), &view.class(held).id)),
        Test::Keyed => class().receptacle.as_ref().is_some_and(|kind| !kind.keys.is_empty()),
        Test::HasRoom => view.has_room(id),
        Test::HasRoomForHeld => view.held().is_some_and(|held| view.has_room_for(id, held)),
        Test::HasFreePlace => view.has_free_place(id),
        Test::HasCartridge => view.has_cartridge(id),
        Test::Sells(slot) => view.sells(id, *slot),
        Test::Feeds => view.feeds(id),
        Test::Gate => view.gate(id).is_some(),
        Test::OpenGate => view.gate(id) == Some(true),
        Test::LetsHeldPass => view.held().is_some_and(|held| view.lets_pass(id, held)),
        Test::AnswersAlways => view.catalog().table().device(&class().id).answers_always,
        Test::Clear => view.is_clear(id),
        Test::DoorsClear | Test::Never => false,
    }
}

/// Whether a receptacle of one class takes things of another.
#[must_use]
pub fn takes(receptacle: &ObjectClass, class: &str) -> bool {
    receptacle.receptacle.as_ref().is_some_and(|kind| {
        (kind.keys.is_empty() || kind.keys.iter().any(|key| key == class))
            && !kind.refuses.iter().any(|refused| refused == class)
    })
}

/// What the table says of one action in one state.
#[derive(Clone, Copy, Debug)]
pub struct Judgement<'t> {
    /// The rule that counts.
    pub rule: &'t Rule,
    /// The device that is pressed, if one is.
    pub device: Option<&'t Device>,
    /// What it lacks; nothing, if it is allowed.
    pub lack: Option<&'t Need>,
}

impl Judgement<'_> {
    /// Whether the action is allowed.
    #[must_use]
    pub const fn is_allowed(&self) -> bool {
        self.lack.is_none()
    }

    /// The status of a refusal.
    #[must_use]
    pub fn refusal(&self) -> Option<Status> {
        self.lack.map(|need| need.status)
    }
}

/// What every rule needs, whether it says so or not: there is no place for a thing in itself.
static NOT_INTO_ITSELF: LazyLock<Need> = LazyLock::new(|| Need {
    any: vec![Condition { negated: true, term: Term::It, test: Test::InHeld }],
    status: Status::InvalidCommand,
    words: "nothing can be put into itself".to_owned(),
});

impl ActionTable {
    /// Judges an action on a thing; none, if there is no rule for it.
    pub fn judge(&self, view: &impl View, action: ActionKind, it: ObjectId) -> Option<Judgement<'_>> {
        let scope = Scope::of(it);
        let rule = self.rules().iter().find(|rule| rule.action == action && scope.all_hold(view, &rule.when))?;
        let device = (action == ActionKind::Toggle).then(|| self.device(&view.class(it).id));
        let lack = scope.lacks(view, &rule.needs);
        let lack = lack.or_else(|| device.and_then(|device| scope.lacks(view, &device.needs)));
        let lack = lack.or_else(|| scope.puts_into_itself(view, &rule.effects).then(|| &*NOT_INTO_ITSELF));
        Some(Judgement { rule, device, lack })
    }
}
