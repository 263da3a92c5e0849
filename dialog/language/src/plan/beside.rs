//! Where a thing is to be put, and what it is to stand beside there.

use cohabit_cdf::{Action, ObjectId, Property};

use crate::{
    ground::want::Want,
    known::{KnownObject, floor},
    plan::{
        Fault, Planner,
        carry::{TAKES, is_table},
        settle::{Goal, Settled},
    },
    read::phrase::{Phrase, Place},
    words::{intent::Intent, lexicon::Preposition, prose},
};

/// How far the edge of a table may be from the middle of what is then beside it, m.
const CLOSE_M: f32 = 1.0;

impl Planner<'_> {
    /// Puts what is held on or into a receptacle, beside something if that was said.
    pub(super) fn place_beside(&mut self, receptacle: ObjectId, beside: Option<ObjectId>) {
        self.open_around(receptacle, true);
        let says = self.putting(self.scene.robot.held, receptacle, beside);
        self.push(Action::place(receptacle, beside), says);
    }

    /// `putting the mug on the table`, `putting the mug next to the plate`
    fn putting(&self, object: Option<ObjectId>, receptacle: ObjectId, beside: Option<ObjectId>) -> String {
        let put = object.map_or_else(|| "it".to_owned(), |object| self.the(object));
        match beside {
            Some(beside) => format!("putting {put} {} {}", Preposition::Near.word(), self.the(beside)),
            None => format!("putting {put} {} {}", self.preposition(receptacle), self.the(receptacle)),
        }
    }

    /// Whether a thing is where it is to go, and nothing is to be done; of the last step it is then said what it is to stand beside.
    pub(super) fn is_put_there(
        &mut self,
        object: ObjectId,
        place: ObjectId,
        beside: Option<ObjectId>,
        is_of_all: bool,
    ) -> bool {
        let is_there = self.scene.object(object).is_some_and(|known| known.parent == Some(place));
        // `bring it to the microwave and put it in` is one errand.
        let is_last = is_there && self.steps.last().is_some_and(|step| step.action.receptacle() == Some(place));
        if beside.is_none() {
            return is_last || is_there && is_of_all;
        }
        // `put it on the table, next to the plate`
        let is_errand = is_last && self.focus.placed == Some(object);
        let says = self.putting(Some(object), place, beside);
        if let Some(last) = self.steps.last_mut().filter(|_| is_errand) {
            (last.action, last.says) = (Action::place(place, beside), says);
        }
        is_errand
    }

    /// Where to put it, and beside what; `next to the lamp` is where the lamp stands.
    pub(super) fn find_target(
        &self,
        phrase: &Phrase,
        goal: &Goal,
        object: ObjectId,
        settled: &Settled,
    ) -> Result<(ObjectId, Option<ObjectId>), Fault> {
        let is_beside = goal.preposition.is_beside();
        let affordances: &[Property] = if is_beside { &[] } else { TAKES };
        // `on the counter` is its top, rather than one with doors.
        let open = match goal.preposition {
            Preposition::On => self.classes(|class| !self.catalog.class(class).has(Property::Openable)),
            _ => Vec::new(),
        };
        let origin = self.taken_from(object).filter(|_| !is_beside && !settled.is_back);
        let want = Want { classes: &open, origin, ..Want::place(settled.intent, affordances, Some(object)) };
        let target = self.find_one(phrase, &want, Some(goal.role))?;
        if !is_beside && target == object {
            return Err(Fault::Cannot(prose::sentence(&format!("I cannot put {} into itself", self.the(object)))));
        }
        if !is_beside {
            return Ok((target, self.named_beside(phrase, target, object, settled.intent)));
        }
        // Of all things the one that they are put beside stays where it is.
        if target == object {
            return Ok((self.scene.object(object).and_then(|known| known.parent).unwrap_or(target), None));
        }
        Ok(match self.stand_of(target, object) {
            Some(stand) => (stand, Some(target)),
            // Where it stands is known once it was put down.
            None => (target, Some(target).filter(|target| self.scene.robot.held == Some(*target))),
        })
    }

    /// `on the table next to the plate`: the plate, if it stands on that table; else it only says which table.
    fn named_beside(&self, phrase: &Phrase, place: ObjectId, object: ObjectId, intent: Intent) -> Option<ObjectId> {
        let relation = phrase.relations.iter().find(|relation| relation.kind.is_beside())?;
        let mut there = relation.to.clone();
        // Of several plates the one on that table.
        if there.pronoun.is_none() {
            let on = Phrase { chosen: Some(place), text: phrase.text.clone(), ..Phrase::default() };
            there.attach(Preposition::On, Place::Object(on));
        }
        let other = self.ground().one(&there, &Want::place(intent, &[], Some(object))).ok()?;
        let is_there = self.scene.ancestors(other).any(|under| under.id == place);
        (is_there && other != object).then_some(other)
    }

    /// What a thing stands on or in, so that another can be put beside it; of a machine or the like that stands on nothing, a table
    /// close to it. Nothing, of a table.
    pub(super) fn stand_of(&self, id: ObjectId, object: ObjectId) -> Option<ObjectId> {
        let known = self.scene.object(id)?;
        if known.parent.is_some() {
            let holds = |under: &&KnownObject| under.id != object && self.has(under.id, Property::Receptacle);
            return self.scene.ancestors(id).find(holds).map(|under| under.id).or(known.parent);
        }
        if self.scene.robot.held == Some(id) || is_table(self.catalog.class(known.class)) {
            return None;
        }
        let apart_m = |table: &KnownObject| {
            let [wide, deep, _] = self.catalog.class(table.class).size_m;
            floor::distance_m(table.position_m, known.position_m) - wide.max(deep) / 2.0
        };
        let is_close =
            |table: &&KnownObject| table.room == known.room && self.is_table(table) && apart_m(table) < CLOSE_M;
        let close = self.scene.objects.iter().filter(is_close);
        close.min_by(|a, b| apart_m(a).total_cmp(&apart_m(b)).then(a.id.cmp(&b.id))).map(|table| table.id)
    }
}
