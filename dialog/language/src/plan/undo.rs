//! Taking back what was done last, step by step from the end, as far as steps can be taken back.

use cohabit_cdf::{Action, GoToTarget, ObjectId, Property, Verb};

use crate::{
    known::describe,
    plan::{Fault, Planner},
    understanding::Step,
    words::intent::Intent,
};

impl Planner<'_> {
    /// Adds the reverse of `done`, its last step first. What cannot be undone is said, where anything can.
    pub(crate) fn undo(&mut self, done: &[Step]) -> Result<(), Fault> {
        let mut faults = Vec::new();
        for step in done.iter().rev() {
            match self.undo_step(step) {
                Err(Fault::Cannot(text)) => faults.push((step, text)),
                undone => undone?,
            }
        }
        match faults.into_iter().next() {
            Some((_, text)) if self.steps.is_empty() => Err(Fault::Cannot(text)),
            Some((step, _)) => {
                self.notes.push(format!("I cannot undo {}", step.says));
                Ok(())
            }
            None => Ok(()),
        }
    }

    fn undo_step(&mut self, step: &Step) -> Result<(), Fault> {
        match step.action {
            Action::Move { distance_m } => self.walk(-distance_m)?,
            Action::Rotate { yaw_rad } => self.rotate(-yaw_rad.to_degrees(), false),
            Action::GoTo { .. } => self.go_back()?,
            Action::PickUp { object } if self.scene.robot.held == Some(object) => self.put_back(object)?,
            Action::Place { receptacle } | Action::PlaceBeside { receptacle, .. } => {
                let last = self.focus.placed.filter(|placed| self.is_in(*placed, receptacle));
                let placed = last.ok_or_else(|| self.cannot_undo(step))?;
                // Where it was taken from at first is where it goes back to.
                let origins = self.focus.origins.clone();
                self.pick_up(placed, false)?;
                self.focus.origins = origins;
            }
            // What was unfolded is folded again, not closed.
            Action::Interact { verb: Verb::Open, object } => {
                let does = if step.by_hand() == Some(Intent::Unfold) { Intent::Fold.doing() } else { "closing" };
                self.interact(Verb::Close, object, does);
            }
            Action::Interact { verb: Verb::Close, object } => {
                let does = if step.by_hand() == Some(Intent::Fold) { Intent::Unfold.doing() } else { "opening" };
                self.interact(Verb::Open, object, does);
            }
            Action::Interact { verb: Verb::Toggle, object } if self.stays_on(object) => {
                self.interact(Verb::Toggle, object, "switching back");
            }
            // Nothing was changed by looking.
            Action::Look { .. }
            | Action::LookAround
            | Action::Highlight { .. }
            | Action::Stop
            | Action::Drive { .. }
            | Action::Interact { verb: Verb::Examine | Verb::Scan, .. } => {}
            Action::PickUp { .. } | Action::Interact { .. } => return Err(self.cannot_undo(step)),
        }
        Ok(())
    }

    fn cannot_undo(&self, step: &Step) -> Fault {
        Fault::Cannot(format!("I cannot undo {}. Tell me what to do instead.", step.says))
    }

    fn is_in(&self, object: ObjectId, receptacle: ObjectId) -> bool {
        self.scene.object(object).is_some_and(|object| object.parent == Some(receptacle))
    }

    fn stays_on(&self, object: ObjectId) -> bool {
        self.scene.object(object).is_some_and(|object| self.devices.stays_on(object.class))
    }

    /// Goes to where the robot stood before it last set out: for this plan, if it is under way by then.
    pub(crate) fn go_back(&mut self) -> Result<(), Fault> {
        let sets_out = self.scene.robot.position_m[..2] != self.from_m;
        let Some(start) = sets_out.then_some(self.from_m).or(self.focus.start_m) else {
            return Err(Fault::Cannot("I have not been anywhere else yet. Tell me where to go.".to_owned()));
        };
        self.push(Action::GoTo { target: GoToTarget::Point(start) }, "going back to where I was".to_owned());
        Ok(())
    }

    /// Puts an object where it was taken from, or says that it does not know where that was.
    pub(crate) fn put_back(&mut self, object: ObjectId) -> Result<(), Fault> {
        let known = self.focus.origins.iter().find(|(taken, _)| *taken == object).map(|(_, origin)| *origin);
        let origin = known.filter(|origin| self.has(*origin, Property::Receptacle));
        let Some(origin) = origin else {
            let the = self.the(object);
            if self.focus.off_floor.iter().any(|(taken, _)| *taken == object) {
                return Err(Fault::Cannot(format!(
                    "I took {the} from the floor, and I can put things only on or into something. Tell me where to put it."
                )));
            }
            return Err(Fault::Cannot(format!("I do not remember where {the} was. Tell me where to put it.")));
        };
        self.put_at(object, origin)
    }

    /// Puts an object where it was before it was taken: what it was only put into to have something done to it is no such place.
    pub(crate) fn put_where_it_was(&mut self, object: ObjectId) -> Result<(), Fault> {
        let last = self.focus.origins.iter().find(|(taken, _)| *taken == object).map(|(_, last)| *last);
        let first = self.focus.firsts.iter().find(|(taken, _)| *taken == object).and_then(|(_, first)| *first);
        match first.filter(|first| self.has(*first, Property::Receptacle)) {
            Some(first) if last.is_some_and(|last| self.is_station(last)) => self.put_at(object, first),
            _ => self.put_back(object),
        }
    }

    /// Whether things are put there to have something done to them: a machine that works on what it holds, or a basin.
    fn is_station(&self, place: ObjectId) -> bool {
        self.scene.object(place).is_some_and(|known| {
            let (table, class) = (self.catalog.table(), &self.catalog.class(known.class).id);
            table.device(class).work.is_some() || table.is_basin(class)
        })
    }

    fn put_at(&mut self, object: ObjectId, origin: ObjectId) -> Result<(), Fault> {
        if self.is_in(object, origin) {
            let place = describe::full(self.catalog, &self.scene, object);
            self.notes.push(format!("{place} is where I took it from"));
            return Ok(());
        }
        self.hold(object)?;
        self.place_on(origin);
        Ok(())
    }
}
