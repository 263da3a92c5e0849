//! `swap the mug and the bowl`: two things, each of which is to be where the other is.

use cohabit_cdf::ObjectId;

use crate::{
    ground::want::Want,
    plan::{Fault, Planner},
    read::{clause::Clause, slot},
    words::intent::Intent,
};

impl Planner<'_> {
    pub(crate) fn swap(&mut self, clause: &Clause) -> Result<(), Fault> {
        let mut found: Vec<ObjectId> = Vec::new();
        for (role, phrase) in slot::phrases(clause) {
            let want = Want {
                held_first: phrase.pronoun.is_some(),
                exclude: found.first().copied(),
                ..Want::object(Intent::Swap)
            };
            found.extend(self.find_each(phrase, &want, Some(role))?);
        }
        match found[..] {
            [one, other] if one != other => self.swap_two(one, other),
            _ => Err(Fault::Cannot("I can swap two things. Tell me which two.".to_owned())),
        }
    }

    fn swap_two(&mut self, one: ObjectId, other: ObjectId) -> Result<(), Fault> {
        let place = |id: ObjectId| self.scene.object(id).and_then(|object| object.parent);
        let (place_of_one, place_of_other) = (place(one), place(other));
        match self.scene.robot.held {
            Some(held) if held == one => return self.swap_held(place_of_other, other),
            Some(held) if held == other => return self.swap_held(place_of_one, one),
            _ => {}
        }
        let (Some(place_of_one), Some(place_of_other)) = (place_of_one, place_of_other) else {
            let loose = if place_of_one.is_none() { one } else { other };
            return Err(Fault::Cannot(format!("I cannot put anything where {} is.", self.the(loose))));
        };
        if place_of_one == place_of_other {
            let at = format!("{} {}", self.preposition(place_of_one), self.the(place_of_one));
            self.notes.push(format!("{} and {} are both {at}", self.the(one), self.the(other)));
            return Ok(());
        }
        self.hold(one)?;
        self.place_on(place_of_other);
        self.hold(other)?;
        self.place_on(place_of_one);
        Ok(())
    }

    /// What is in the hand goes where the other is, which is in the hand then.
    fn swap_held(&mut self, place: Option<ObjectId>, other: ObjectId) -> Result<(), Fault> {
        match place {
            Some(place) => self.place_on(place),
            None => self.put_down(Some(other))?,
        }
        self.pick_up(other, false)
    }
}
