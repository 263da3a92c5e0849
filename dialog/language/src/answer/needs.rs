//! What a step of a plan was needed for: what the table of devices says of its thing, or what was done after it.

use cohabit_cdf::{Action, ObjectId, Verb};

use crate::{
    answer::Answerer,
    known::KnownObject,
    read::question::Question,
    say::reply,
    understanding::Step,
    words::{intent::Intent, prose},
};

impl Answerer<'_> {
    /// Why it did something of that kind last, to this thing or with it where one is named: what that was needed for, and what was asked
    /// for. Nothing, where no deed could tell.
    pub(crate) fn why_done(&self, intent: Option<Intent>, id: Option<ObjectId>) -> Option<String> {
        self.context.deeds.why(intent, id, self.needed_for(intent, id).as_deref())
    }

    /// What that deed was needed for: `it has to be closed before it runs`.
    fn needed_for(&self, intent: Option<Intent>, id: Option<ObjectId>) -> Option<String> {
        let deeds = &self.context.deeds;
        let deed = deeds.asked_about(intent, id).filter(|deed| deed.step.by_hand().is_none())?;
        let object = self.scene.object(deed.step.object()?)?;
        let mut then = deeds.followed_by(deed).map(|next| &next.step);
        match deed.step.action {
            Action::Interact { verb: Verb::Close, .. } => {
                let runs = self.devices.must_be_shut(object.class) && then.any(|step| switches(step, object.id));
                runs.then(|| "it has to be closed before it runs".to_owned())
            }
            Action::Interact { verb: Verb::Open, .. } => {
                let next = then.next().filter(|step| goes_through_door(step, object.id))?;
                Some(format!("it had to be open for {}", next.says))
            }
            Action::Interact { verb: Verb::Toggle, .. } => self.has_no_switch(object),
            Action::PickUp { .. } => {
                let next = then.find(|step| is_done_with_held(step))?;
                Some(format!("I needed {} in my hand for {}", prose::it(&self.short(object.id)), next.says))
            }
            _ => None,
        }
    }

    /// That what a computer or a button works is switched by that alone.
    fn has_no_switch(&self, worker: &KnownObject) -> Option<String> {
        let machine = worker.works.and_then(|id| self.scene.object(id))?;
        let is_worker = self.devices.workers(machine.class).is_some_and(|classes| classes.contains(&worker.class));
        is_worker.then(|| format!("{} has no switch of its own", self.short(machine.id)))
    }

    /// Whether it is asked why it did what it has only just understood so, and what neither a goal nor a step after it needed: that was
    /// perhaps not meant.
    pub(crate) fn may_be_mistaken(&self, question: &Question) -> bool {
        let (intent, object) = self.asked_why(question.about.as_ref(), question);
        let context = self.context;
        let deed = intent.and_then(|_| context.deeds.asked_about(intent, object));
        let is_mistaken = deed.is_some_and(|deed| {
            deed.step.changes()
                && context.last_plan.contains(&deed.step)
                && deed.reason.starts_with(reply::UNDERSTOOD_TO)
                && context.deeds.goals_of(&deed.reason).is_empty()
        });
        is_mistaken && self.needed_for(intent, object).is_none()
    }
}

fn switches(step: &Step, id: ObjectId) -> bool {
    step.action == Action::Interact { verb: Verb::Toggle, object: id }
}

/// Whether a step right after a door was opened puts something in there, or takes what is there.
fn goes_through_door(step: &Step, id: ObjectId) -> bool {
    match step.action {
        Action::Place { receptacle } => receptacle == id,
        Action::PickUp { object } => object != id,
        _ => false,
    }
}

/// Whether a step is done with what is in the hand.
const fn is_done_with_held(step: &Step) -> bool {
    matches!(
        step.action,
        Action::Place { .. }
            | Action::Interact {
                verb: Verb::Pour | Verb::Throw | Verb::Fill | Verb::Clean | Verb::Break | Verb::Scan,
                ..
            }
    )
}
