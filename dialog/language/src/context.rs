//! What was said, meant and done before.

pub(crate) mod awaited;
mod deeds;
pub(crate) mod failure;
pub(crate) mod search;

use cohabit_cdf::{ObjectId, Status};
use serde::{Deserialize, Serialize};

use crate::{
    context::{
        awaited::Awaited,
        deeds::Deeds,
        failure::Failure,
        search::{Consent, Search},
    },
    ground::focus::Focus,
    known::Known,
    read::{clause::Clause, hint::Hint, question::Question, slot::Slot},
    say::reply,
    understanding::{Step, Understanding},
    words::{prose, question_kind::QuestionKind},
};

/// How many lines of the dialog are remembered.
const LINES: usize = 4;

/// The conversation so far; [`Default`] is its beginning. It can be written down, and read again by the same build.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct Context {
    pub(crate) focus: Focus,
    pub(crate) pending: Option<Pending>,
    /// The plan under way, what is left of it.
    pub(crate) running: Vec<Step>,
    /// The last plan, whole.
    pub(crate) last_plan: Vec<Step>,
    /// How many of its steps were left when it was stopped.
    #[serde(default)]
    pub(crate) left_undone: usize,
    /// What was under way when it was stopped, if nothing else was begun since.
    #[serde(default)]
    pub(crate) halted: Option<Guess>,
    /// What failed last, with what was to follow it.
    pub(crate) failed: Option<Failure>,
    /// Why what was asked for last is done: `you asked me to open the fridge`, `you said "thirsty"`.
    #[serde(default)]
    pub(crate) reason: String,
    /// Why the last plan was made.
    #[serde(default)]
    pub(crate) planned_for: String,
    /// Why what was asked for last cannot be done.
    #[serde(default)]
    pub(crate) refused: Option<String>,
    /// The request that cannot be done for that reason.
    #[serde(default)]
    pub(crate) impossible: Vec<Clause>,
    /// What of the last request is not done by its plan, and why.
    #[serde(default)]
    pub(crate) left_out: Option<String>,
    /// The request that the last plan is for.
    pub(crate) request: Vec<Clause>,
    /// What was asked last, if nothing was asked for since.
    #[serde(default)]
    pub(crate) question: Option<QuestionKind>,
    /// What was listed last, and how many of it were named.
    #[serde(default)]
    pub(crate) list: Option<(Question, usize)>,
    /// What it did.
    #[serde(default)]
    pub(crate) deeds: Deeds,
    /// The goals that were met before it did anything.
    #[serde(default)]
    pub(crate) met_before: Vec<String>,
    /// The request that waits until what it names is found.
    pub(crate) search: Option<Search>,
    /// What is to be done or answered once the plan under way has ended, each as somebody would say it. A goal that is met by then is
    /// left out.
    #[serde(default)]
    pub(crate) later: Vec<String>,
    /// What was offered besides the plan under way and agreed to: it is done once that has ended.
    #[serde(default)]
    pub(crate) agreed: Option<Guess>,
    /// What is done after waits.
    #[serde(default)]
    pub(crate) awaited: Vec<Awaited>,
    /// Whether it goes where the person goes.
    #[serde(default)]
    pub(crate) follows: bool,
    /// Whether it went where the person goes when they said this: what was said decides whether it still does.
    #[serde(default)]
    pub(crate) followed: bool,
    /// Where the person and the robot stood when it last went after them, m.
    #[serde(default)]
    pub(crate) gone_after: Option<[[f32; 2]; 2]>,
    /// What it waited for last, in words.
    #[serde(default)]
    pub(crate) waited: Option<String>,
    /// Where somebody thinks that what is asked for is, while that is understood.
    #[serde(default)]
    pub(crate) hint: Option<Hint>,
    /// What was answered before what is to be done is told.
    #[serde(default)]
    pub(crate) answered: String,
    /// What was asked about and may be otherwise than when the robot last saw it.
    #[serde(default)]
    pub(crate) unwatched: Option<ObjectId>,
    /// Whether what was asked for last was found to be so already.
    #[serde(default)]
    pub(crate) is_met: bool,
    /// What was taken for the thing that was meant, where what was said last says that another one was.
    #[serde(default)]
    pub(crate) mistaken: Option<ObjectId>,
    /// What was said last, the latest last: whether the robot said it, and what.
    #[serde(default)]
    pub(crate) lines: Vec<(bool, String)>,
    /// How likely what was understood last is what was meant.
    #[serde(default)]
    pub(crate) sureness: f32,
}

/// A question of the robot's that waits for its answer.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(crate) enum Pending {
    /// Which object is meant; the request waits.
    Which { clauses: Vec<Clause>, slot: Slot, candidates: Vec<ObjectId>, consent: Consent },
    /// Where the object is that nobody has seen.
    Where { clauses: Vec<Clause>, slot: Slot, consent: Consent },
    /// What the object looks like whose name means nothing.
    Look { clauses: Vec<Clause>, slot: Slot, consent: Consent },
    /// Which way to turn; the clause that turns.
    Direction { clauses: Vec<Clause>, clause: usize },
    /// Which lab is meant; these words wait, the lab stands at `at`.
    Lab { words: Vec<String>, at: usize },
    /// Whether to put down what is held, to do what was asked.
    PutDown { clauses: Vec<Clause> },
    /// Whether to look for what was asked about.
    Search { clauses: Vec<Clause> },
    /// Which of these to do, or whether to do the only one.
    Offer { plans: Vec<Vec<Step>> },
    /// The same of what was only guessed at.
    Guess { guesses: Vec<Guess> },
    /// Whether to do this, too, besides the plan under way; whether that was asked once more when it had ended.
    Also { guess: Box<Guess>, question: String, is_asked: bool },
}

impl Pending {
    /// Whether it asks which of several plans is meant.
    pub(crate) const fn offers_several(&self) -> bool {
        match self {
            Self::Offer { plans } => plans.len() > 1,
            Self::Guess { guesses } => guesses.len() > 1,
            _ => false,
        }
    }
}

/// A plan that the robot asks about, with what is to follow it.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(crate) struct Guess {
    /// What it comes to, in words.
    pub(crate) name: String,
    pub(crate) steps: Vec<Step>,
    pub(crate) search: Option<Search>,
    later: Vec<String>,
    request: Vec<Clause>,
    reason: String,
}

impl Guess {
    /// What is to follow it, which it then has no longer.
    pub(crate) fn take_later(&mut self) -> Vec<String> {
        std::mem::take(&mut self.later)
    }

    /// The same in other words.
    pub(crate) fn called(self, name: String) -> Self {
        Self { name, ..self }
    }

    fn begins_with(&self, step: &Step) -> bool {
        self.steps.first().is_some_and(|first| first.action == step.action)
    }
}

impl Context {
    /// The same before anything is made of a new utterance.
    pub(crate) fn at_new_utterance(&self) -> Self {
        Self { is_met: false, answered: String::new(), unwatched: None, mistaken: None, ..self.clone() }
    }

    /// Takes note of what the robot or a person said. [`crate::Language::understand`] notes what it is told and replies; this is for what
    /// else is said, such as that a plan has ended. A line that repeats the last one is not noted twice.
    pub fn note_said(&mut self, by_robot: bool, text: &str) {
        if text.is_empty() || self.lines.last().is_some_and(|(by, last)| *by == by_robot && last == text) {
            return;
        }
        self.lines.push((by_robot, text.to_owned()));
        let surplus = self.lines.len().saturating_sub(LINES);
        self.lines.drain(..surplus);
    }

    /// What was said last, the latest last: whether the robot said it, and what.
    #[must_use]
    pub fn lines(&self) -> &[(bool, String)] {
        &self.lines
    }

    /// How likely what [`crate::Language::understand`] understood last is what was meant, from 0 to 1; 0 where it only asks what is.
    #[must_use]
    pub const fn sureness(&self) -> f32 {
        self.sureness
    }

    /// What the robot did last has met the goals that are met now and were not before.
    pub(crate) fn credit_goals(&mut self, scene: &Known) {
        let met = || scene.goals.iter().filter(|goal| goal.met).map(|goal| goal.text.as_str());
        if self.deeds.is_empty() {
            self.met_before = met().map(str::to_owned).collect();
        }
        let Self { deeds, met_before, .. } = self;
        deeds.credit(met().filter(|goal| !met_before.iter().any(|known| known == goal)));
    }

    /// Takes note of what came of a step: `yes` after a failure then means the remedy that
    /// [`crate::Language::report`] offered.
    pub fn note_outcome(&mut self, step: &Step, status: Status) {
        let done = self.running.iter().position(|planned| planned.action == step.action);
        let before = self.done_of_plan(done);
        // Something else was done in between, such as pointing out what a question is about.
        if (done.is_none() || status == Status::Interrupted)
            && let (Some(search), Some(leg)) = (&mut self.search, self.running.get(done.unwrap_or(0)))
        {
            search.take_back(leg);
        }
        let rest = done.map_or_else(Vec::new, |at| self.running.split_off(at + 1));
        if status.is_success() {
            self.deeds.add(step, &self.reason);
            // What was done although it was stopped is not done again.
            if let Some(halted) = self.halted.as_mut().filter(|halted| halted.begins_with(step)) {
                halted.steps.remove(0);
            }
            self.running = rest;
            return;
        }
        if done.is_some() && !self.search.as_ref().is_some_and(Search::is_under_way) {
            self.deeds.cut_short(&self.reason);
        }
        self.running.clear();
        self.later.clear();
        self.agreed = None;
        // What goes on from what failed is offered no longer: a yes now means the remedy.
        self.pending.take_if(|pending| matches!(pending, Pending::Also { .. }));
        self.follows = false;
        if let Some(search) = self.search.as_mut().filter(|search| search.is_under_way()) {
            search.note_failure(step, status);
            return;
        }
        self.search = None;
        self.failed = (status != Status::Interrupted)
            .then(|| Failure::new(step.clone(), status, &self.last_plan[..before], rest));
    }

    /// How many steps of the last plan were done before the one that stands at this place in what is left of it.
    fn done_of_plan(&self, at: Option<usize>) -> usize {
        let is_of_plan = !self.running.is_empty() && self.last_plan.ends_with(&self.running);
        at.filter(|_| is_of_plan).map_or(0, |at| self.last_plan.len() - self.running.len() + at)
    }

    /// Takes note of a plan that is about to be carried out.
    pub(crate) fn begin(&mut self, steps: &[Step]) {
        self.question = None;
        self.focus.group_taken(steps.iter().map(|step| &step.action));
        self.running = steps.to_vec();
        self.last_plan = steps.to_vec();
        (self.left_undone, self.halted) = (0, None);
        self.planned_for.clone_from(&self.reason);
        (self.refused, self.left_out) = (None, None);
        self.impossible.clear();
        self.request.clear();
        self.later.clear();
        self.agreed = None;
        self.pending = None;
        self.failed = None;
        self.search = None;
    }

    /// What is to be done later stays so after an understanding that goes on with what was asked for, unless that came to nothing.
    pub(crate) fn keep(&mut self, later: Vec<String>, understanding: Understanding) -> Understanding {
        if matches!(understanding, Understanding::Plan { .. } | Understanding::Question { .. }) {
            self.later = later;
        }
        understanding
    }

    /// The same after an answer to `open`, which may have left more for later by itself; a guess has with it what was to follow.
    pub(crate) fn keep_both(
        &mut self,
        later: Vec<String>,
        open: Option<&Pending>,
        understanding: Understanding,
    ) -> Understanding {
        let own = std::mem::take(&mut self.later);
        // What is under way goes on, whatever is said of what is offered besides.
        if matches!(open, Some(Pending::Also { .. })) {
            self.later = later.into_iter().chain(own).collect();
            return understanding;
        }
        let is_guess = matches!(open, Some(Pending::Guess { .. }));
        let all = if is_guess { own } else { later.into_iter().chain(own).collect() };
        self.keep(all, understanding)
    }

    /// What this conversation is about to do with these steps, to be asked about first.
    pub(crate) fn guess(&self, steps: &[Step]) -> Guess {
        let Self { search, later, request, reason, .. } = self.clone();
        let name = reply::told_in_words(&self.told(steps));
        Guess { name, steps: steps.to_vec(), search, later, request, reason }
    }

    /// The same in words, part by part.
    pub(crate) fn told(&self, steps: &[Step]) -> Vec<reply::Told> {
        // A search says no more than where it begins: what it is for does.
        let sought: Vec<String> = self.search.iter().flat_map(|_| reply::doings(&self.request)).collect();
        let is_done_first = self.search.as_ref().is_none_or(|search| !search.is_under_way());
        let first = if is_done_first || sought.is_empty() { steps } else { &[] };
        let later = self.later.iter().flat_map(|text| prose::doings(text));
        first.iter().map(reply::Told::of_step).chain(sought.into_iter().chain(later).map(reply::Told::then)).collect()
    }

    /// Takes note that a guess was right, and is about to be carried out.
    pub(crate) fn begin_guessed(&mut self, guess: Guess) {
        self.begin(&guess.steps);
        (self.search, self.later) = (guess.search, guess.later);
        (self.request, self.planned_for) = (guess.request, guess.reason.clone());
        self.reason = guess.reason;
    }

    /// Takes note of the first part of a search, before which nothing of its request was done: what was done before is no part of it, and
    /// not what is undone next.
    pub(crate) fn begin_search(&mut self, steps: &[Step]) {
        self.last_plan = steps.to_vec();
        self.left_undone = 0;
        self.planned_for.clone_from(&self.reason);
        self.begin_leg(steps);
    }

    /// Takes note of a part of a search that is about to be carried out.
    pub(crate) fn begin_leg(&mut self, steps: &[Step]) {
        self.running = steps.to_vec();
        self.halted = None;
        self.pending = None;
        self.failed = None;
    }

    /// Takes note of what is under way, which is about to be stopped.
    pub(crate) fn halt(&mut self) {
        if self.is_busy() {
            self.deeds.cut_short(&self.reason);
            self.halted = Some(self.guess(&self.running));
        }
    }

    /// What was under way when it was stopped. Between two parts of a search no step is left of it: that is looked for again.
    pub(crate) fn take_halted(&mut self) -> Option<Guess> {
        let halted = self.halted.take()?;
        if halted.steps.is_empty() {
            (self.search, self.later) = (halted.search.clone(), halted.later.clone());
        }
        Some(halted)
    }

    /// What a `yes` now means is the last request again: what it is about has to be looked for.
    pub(crate) fn await_search(&mut self) {
        self.search = None;
        self.running.clear();
        self.pending = Some(Pending::Search { clauses: self.request.clone() });
    }

    /// Whether a question of the robot's must be answered before anything else is done.
    pub(crate) const fn must_be_answered(&self) -> bool {
        !matches!(self.pending, None | Some(Pending::Also { .. }))
    }

    /// Whether a plan or a search is under way.
    pub(crate) const fn is_busy(&self) -> bool {
        !self.running.is_empty() || self.search.is_some()
    }

    /// Whether something is put off, or somebody followed: [`crate::Language::wake`] knows when there is something to do.
    #[must_use]
    pub const fn awaits(&self) -> bool {
        !self.awaited.is_empty() || self.follows
    }

    /// Whether there is more to do after the plan under way: [`crate::Language::carry_on`] knows what.
    #[must_use]
    pub const fn awaits_more(&self) -> bool {
        let is_offered = matches!(self.pending, Some(Pending::Also { is_asked: false, .. }));
        let is_left = matches!(&self.failed, Some(failure) if failure.has_apart());
        self.search.is_some() || !self.later.is_empty() || self.agreed.is_some() || is_offered || is_left
    }

    /// Whether a question is answered next.
    pub(crate) fn answers_next(&self) -> bool {
        self.search.is_none() && self.later.first().is_some_and(|next| next.trim_end().ends_with('?'))
    }

    /// Whether the robot is looking for something or follows somebody: how the parts of that end is not worth telling.
    #[must_use]
    pub fn is_searching(&self) -> bool {
        self.follows || self.search.as_ref().is_some_and(Search::is_under_way)
    }
}

#[cfg(test)]
mod tests {
    use cohabit_cdf::Action;

    use super::*;
    use crate::read::phrase::Phrase;

    #[test]
    fn what_was_guessed_right_goes_on_as_it_would_have() {
        let steps = [Step { action: Action::LookAround, says: "looking around".to_owned() }];
        let mut looking = Context { reason: "you asked me to mend the mug".to_owned(), ..Context::default() };
        looking.begin(&steps);
        (looking.search, looking.later) = (Some(Search::new(Vec::new(), Consent::default())), vec!["stop".to_owned()]);
        looking.request = vec![Clause::find(Phrase { text: "the mug".to_owned(), ..Phrase::default() })];
        let guess = looking.guess(&steps);
        assert_eq!(guess.name, "looking around, finding the mug and then stopping", "all that is to follow is named");
        let plate = Clause::find(Phrase { text: "the plate".to_owned(), ..Phrase::default() });
        let both = Context { request: [looking.request.clone(), vec![plate]].concat(), ..looking };
        assert_eq!(both.guess(&steps).name, "looking around, finding the mug, finding the plate and then stopping");
        let mut asked = Context::default();
        asked.begin_guessed(guess);
        assert_eq!(asked.planned_for, "you asked me to mend the mug");
        assert!(asked.search.is_some() && asked.later == ["stop"] && asked.running == steps);
    }
}
