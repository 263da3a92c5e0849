//! What cannot be carried: why, and what can be done with it.

use cohabit_cdf::{ObjectId, Property};

use crate::{
    ground::want::Want,
    known::afforded,
    plan::{Fault, Planner},
    read::clause::Clause,
    words::{intent::Intent, prose},
};

impl Planner<'_> {
    /// Those of these that can be carried; the others are taken note of. There is nothing to do where that is all of them.
    pub(crate) fn carried(&mut self, objects: Vec<ObjectId>) -> Result<Vec<ObjectId>, Fault> {
        let (carried, fixed): (Vec<ObjectId>, Vec<ObjectId>) =
            objects.into_iter().partition(|object| self.has(*object, Property::Pickupable));
        if carried.is_empty() && !fixed.is_empty() {
            return Err(self.not_carried(&fixed));
        }
        self.fixed.extend(fixed);
        Ok(carried)
    }

    /// That it cannot take these in its hand, which it says of all such things of a request together.
    pub(crate) fn not_carried(&mut self, fixed: &[ObjectId]) -> Fault {
        self.fixed.extend_from_slice(fixed);
        Fault::Cannot(self.why_not_carried(fixed))
    }

    /// Why it cannot take these in its hand, and what it can do with the one, where it is one.
    pub(crate) fn why_not_carried(&self, fixed: &[ObjectId]) -> String {
        let mut names: Vec<String> = fixed.iter().map(|id| self.the(*id)).collect();
        names.dedup();
        let they = match names.as_slice() {
            [one] if prose::is(one) == "is" => "it is",
            _ => "they are",
        };
        let is_decor = fixed.iter().all(|id| self.has(*id, Property::Decor));
        let reason =
            if is_decor { "there to be looked at, and not made to be carried" } else { "not made to be carried" };
        let text = format!("I cannot pick up {}: {they} {reason}.", prose::list(&names, "or"));
        let can = match (fixed, names.as_slice()) {
            ([id], [name]) => self.afforded(*id, prose::it(name)),
            _ => Vec::new(),
        };
        if can.is_empty() { text } else { format!("{text} I can {}.", prose::list(&can, "and")) }
    }

    fn afforded(&self, id: ObjectId, it: &str) -> Vec<String> {
        let class = self.scene.object(id).map(|object| object.class);
        class.map_or_else(Vec::new, |class| afforded::afforded(self.devices, class, it))
    }

    /// Takes note of what else clauses would have it carry that cannot be carried.
    pub(crate) fn note_fixed(&mut self, clauses: &[Clause]) {
        const CARRY: [Intent; 4] = [Intent::PickUp, Intent::Place, Intent::Bring, Intent::Drop];
        for clause in clauses.iter().filter(|clause| CARRY.contains(&clause.intent)) {
            let want = Want::object(clause.intent);
            let named = clause.objects.iter().filter(|phrase| phrase.pronoun.is_none());
            let found: Vec<ObjectId> = named.filter_map(|phrase| self.ground().one(phrase, &want).ok()).collect();
            for id in found {
                if !self.has(id, Property::Pickupable) && !self.fixed.contains(&id) {
                    self.fixed.push(id);
                }
            }
        }
    }

    /// What it does not do of a request, as sentences: first what it cannot carry, then `others`; nothing, where it does all.
    pub(crate) fn why_left_out(&self, others: Vec<String>) -> Option<String> {
        let fixed = (!self.fixed.is_empty()).then(|| self.why_not_carried(&self.fixed));
        let all: Vec<String> = fixed.into_iter().chain(others).collect();
        (!all.is_empty()).then(|| all.join(" "))
    }
}
