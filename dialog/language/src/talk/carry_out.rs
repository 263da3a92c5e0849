//! What is asked for is done: the plan, or the question or the refusal that stands in its way.

use cohabit_cdf::ObjectId;

use crate::{
    context::{
        Context, Guess, Pending,
        failure::Failure,
        search::{Consent, Search},
    },
    ground::want::Miss,
    known::describe,
    plan::{Fault, Planner, remedy},
    read::{clause::Clause, phrase::Phrase},
    say::{ask, reply},
    talk::conversation::Conversation,
    understanding::{Asking, Step, Understanding},
    words::intent::Intent,
};

impl Conversation<'_> {
    /// Takes back the last plan.
    pub(crate) fn undo(&self, context: &mut Context) -> Understanding {
        let done = context.last_plan.len().saturating_sub(context.left_undone);
        if done == 0 {
            return Understanding::answer("There is nothing to undo yet.");
        }
        if !context.running.is_empty() {
            return self.stopped("", context);
        }
        if context.failed.is_some() {
            return Understanding::answer("That was not finished, so I cannot undo it. Tell me what to do instead.");
        }
        let mut planner = self.planner(context.focus.clone());
        match planner.undo(&context.last_plan[..done]) {
            Ok(()) => {
                context.focus = planner.focus;
                if planner.steps.is_empty() {
                    return Understanding::answer("There is nothing to undo: I only looked.");
                }
                let reply = reply::plan_reply(&planner.steps, &planner.notes);
                context.begin(&planner.steps);
                Understanding::Plan { steps: planner.steps, reply }
            }
            Err(Fault::Cannot(text)) => Understanding::refusal(text),
            Err(_) => Understanding::refusal("I cannot undo that. Tell me what to do instead."),
        }
    }

    pub(crate) fn plan(&self, clauses: Vec<Clause>, consent: Consent, context: &mut Context) -> Understanding {
        let request = reply::request_in_words(&clauses);
        if !request.is_empty() {
            context.reason = format!("{}{request}", reply::ASKED_TO);
        }
        self.proceed(Search::new(clauses, consent), context)
    }

    /// What was planned is done, or agreed upon first; `found` is said before.
    pub(crate) fn planned(
        &self,
        planner: Planner<'_>,
        consent: Consent,
        found: Option<String>,
        context: &mut Context,
    ) -> Understanding {
        let notes: Vec<String> = found.into_iter().chain(planner.notes).collect();
        if self.judge.asking == Asking::Always && !consent.is_agreed && planner.steps.iter().any(Step::commits) {
            let question = ask::shall_i(&planner.steps, &notes);
            context.pending = Some(Pending::Offer { plans: vec![planner.steps] });
            return question;
        }
        context.focus = planner.focus;
        self.remember_start(&planner.steps, context);
        let text = reply::plan_reply(&planner.steps, &notes);
        context.is_met = planner.steps.is_empty();
        if context.is_met {
            (context.pending, context.search) = (None, None);
            return Understanding::answer(text);
        }
        context.begin(&planner.steps);
        context.left_out = planner.left_out;
        Understanding::Plan { steps: planner.steps, reply: text }
    }

    /// Where the robot stands, if it is about to leave.
    pub(crate) fn remember_start(&self, steps: &[Step], context: &mut Context) {
        if steps.iter().any(Step::commits) {
            let [x, y, _] = self.scene.robot.position_m;
            context.focus.start_m = Some([x, y]);
        }
    }

    /// A question, where an answer would help; a refusal with its reason otherwise.
    pub(crate) fn fault(
        &self,
        fault: Fault,
        mut clauses: Vec<Clause>,
        consent: Consent,
        context: &mut Context,
    ) -> Understanding {
        if let Fault::Miss { slot: Some(slot), .. } = &fault {
            slot.make_room(&mut clauses);
        }
        (context.pending, context.search) = (None, None);
        let asks = self.judge.asking != Asking::Never;
        match fault {
            // What nothing makes was perhaps not to be made.
            Fault::Need { classes, text } if classes.is_empty() => Understanding::lost(text),
            Fault::Cannot(text) | Fault::Need { text, .. } => {
                context.impossible = clauses;
                Understanding::refusal(text)
            }
            Fault::Offer { text, steps } if asks => {
                context.pending = Some(Pending::Offer { plans: vec![steps] });
                ask::confirmation(text)
            }
            Fault::Offer { text, .. } => Understanding::refusal(text),
            // To put down what it holds is little, and easily undone.
            Fault::HandFull { held, .. }
                if !consent.may_put_down
                    && self.judge.asking != Asking::Always
                    && (self.scene.robot.held == Some(held) || !only_takes(&clauses)) =>
            {
                self.proceed(Search::new(clauses, Consent { may_put_down: true, ..consent }), context)
            }
            Fault::HandFull { held, .. } => {
                context.pending = Some(Pending::PutDown { clauses });
                // What is asked for before may have it take that first.
                let holds = if self.scene.robot.held == Some(held) { "I am holding" } else { "I will be holding" };
                let held = describe::short(self.catalog, self.scene, held);
                ask::confirmation(format!("{holds} {held}. Shall I put it down first?"))
            }
            Fault::Direction => {
                context.pending = Some(Pending::Direction { clauses, clause: 0 });
                ask::direction()
            }
            Fault::Miss { slot: Some(slot), phrase, miss: Miss::Several(candidates), intent } => {
                let question = self.which(&phrase, &candidates, intent);
                context.pending = Some(Pending::Which { clauses, slot, candidates, consent });
                question
            }
            Fault::Miss { slot: Some(slot), phrase, miss: Miss::Mismatch(others), .. } => {
                let candidates = self.look_different(others);
                let question = self.ask().instead(&phrase, candidates.clone());
                context.pending = Some(Pending::Which { clauses, slot, candidates, consent });
                question
            }
            Fault::Miss { slot: Some(slot), phrase, miss: Miss::Unseen, .. } if asks && phrase.unknown.is_empty() => {
                context.pending = Some(Pending::Where { clauses, slot, consent });
                ask::location(&phrase)
            }
            Fault::Miss { slot: Some(slot), phrase, miss: miss @ (Miss::NoReferent | Miss::Unknown), intent }
                if asks && phrase.unknown.is_empty() =>
            {
                context.pending = Some(Pending::Look { clauses, slot, consent });
                ask::referent(reply::miss(&phrase, &miss, intent, Some(slot.role)))
            }
            Fault::Miss { slot: Some(slot), phrase, .. }
                if asks && phrase.namings.is_empty() && !phrase.unknown.is_empty() =>
            {
                context.pending = Some(Pending::Look { clauses, slot, consent });
                ask::appearance(&phrase)
            }
            Fault::Miss { phrase, miss, intent, .. } => {
                let text = reply::miss(&phrase, &miss, intent, None);
                if phrase.unknown.is_empty() { Understanding::refusal(text) } else { Understanding::lost(text) }
            }
        }
    }

    fn which(&self, phrase: &Phrase, candidates: &[ObjectId], intent: Intent) -> Understanding {
        if let [one] = candidates
            && let Some(object) = self.scene.object(*one)
            && self.judge.is_for_good(intent, object.class)
        {
            return self.ask().for_good(Some(phrase), intent.verb(), *one);
        }
        self.ask().which(Some(phrase), candidates)
    }

    /// The first few of these that do not look alike.
    fn look_different(&self, objects: Vec<ObjectId>) -> Vec<ObjectId> {
        let mut different: Vec<ObjectId> = Vec::new();
        for other in objects {
            let looks_new = different.iter().all(|seen| match (self.scene.object(*seen), self.scene.object(other)) {
                (Some(seen), Some(other)) => !describe::look_alike(self.catalog, seen, other),
                _ => false,
            });
            if looks_new && different.len() < ask::ASKED {
                different.push(other);
            }
        }
        different
    }

    /// The remedy that was offered after a failure, then the failed step again, then the rest.
    pub(crate) fn mend(&self, failure: &Failure, context: &mut Context) -> Understanding {
        let planner = self.planner(context.focus.clone());
        let remedy = remedy::remedy(planner, &failure.step, failure.status);
        let mut steps = remedy.map(|remedy| remedy.steps).unwrap_or_default();
        steps.extend(failure.again(self.scene));
        self.go(steps, context)
    }

    pub(crate) fn go_as_guessed(&self, guess: Guess, context: &mut Context) -> Understanding {
        let steps = guess.steps.clone();
        self.remember_start(&steps, context);
        if guess.search.is_none() {
            steps.iter().for_each(|step| context.focus.follow(&step.action));
        }
        context.begin_guessed(guess);
        Understanding::Plan { reply: reply::plan_reply(&steps, &[]), steps }
    }

    pub(crate) fn go(&self, steps: Vec<Step>, context: &mut Context) -> Understanding {
        self.remember_start(&steps, context);
        steps.iter().for_each(|step| context.focus.follow(&step.action));
        context.begin(&steps);
        Understanding::Plan { reply: reply::plan_reply(&steps, &[]), steps }
    }
}

/// Whether nothing is wanted but that things are in the hand.
fn only_takes(clauses: &[Clause]) -> bool {
    clauses.iter().all(|clause| clause.intent == Intent::PickUp)
}
