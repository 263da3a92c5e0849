//! What people say, and what the robot knows, in; actions, a question, a highlight or a reply out.
//!
//! Pure: no I/O, no clock, no thread, no randomness. The same utterance in the same scene and conversation always has
//! the same meaning. It never knows the world itself, only what the robot knows of it ([`Known`]).
//!
//! On the way: words ([`Language::understand`] repairs their spelling) → clauses, each one verb with its objects and
//! places → referring expressions → objects → steps, every clause grounded on what the steps before it will have
//! done. What remains open is asked for, and the request waits in the [`Context`] for the answer. What is not said
//! plainly a rewriter ([`Language::with_rewriter`]) says again in plain requests, which go the same way.
//!
//! The modules form layers, each a folder that uses only those before it:
//!
//! - `words`: tables of words, spelling, sound, English; then `stop`, and the types of `understanding`
//! - `read`: words → phrases, clauses, questions
//! - `known`: what the robot knows of its world, and how it speaks of that
//! - `ground`: phrases → objects, and whether to ask
//! - `say`: questions, replies and reports of the robot
//! - `plan`: clauses → steps
//! - `context`: the conversation so far
//! - `answer`: questions → answers
//! - `talk`: one turn, from all of these
//!
//! ```
//! use std::sync::Arc;
//! use cohabit_cdf::{Catalog, RoomId};
//! use cohabit_language::{Context, Known, KnownRobot, Language, Understanding};
//!
//! let language = Language::new(Arc::new(Catalog::parse(&[], &[])?));
//! let robot = KnownRobot { position_m: [0.0; 3], yaw_rad: 0.0, room: RoomId::LAB1, held: None };
//! let (mission, goals, rooms) = (String::new(), vec![], vec![]);
//! let scene = Known { robot, objects: vec![], mission, goals, rooms, floor: None, person: None };
//! let meant = language.understand("Could you go to the kitchen, please?", &scene, &mut Context::default());
//! assert!(matches!(meant, Understanding::Plan { steps, .. } if steps.len() == 1));
//! # Ok::<(), cohabit_cdf::CatalogError>(())
//! ```

mod answer;
mod context;
mod ground;
mod known;
mod plan;
mod read;
mod say;
mod setting;
mod stop;
mod talk;
mod understanding;
mod words;

use std::sync::Arc;

use cohabit_cdf::{Action, Catalog, ObjectId, Status};

pub use context::Context;
pub use ground::confidence::{Doubt, Features, Referent, Referents};
pub use known::{
    Known, KnownGoal, KnownObject, KnownPerson, KnownRobot,
    floor::{Floor, FloorPlan},
    memory::{Knows, Lessons, Memory},
    sight::Gaze,
    within_half_turn,
};
pub use say::oracle::Oracle;
pub use stop::{Stop, find_stop, mentions_stop, said::Firmness};
pub use talk::{
    conversation::Rewrite,
    evidence::Evidence,
    interpret::{Consulting, Interpreted, Interpreter, Meant, Unclear},
    spoken::{SpokenNames, says_stop, says_stop_already},
};
pub use understanding::{Alternative, Asking, Clarification, Effort, Step, Understanding};
pub use words::address::{Addressed, Roster};

use crate::{
    ground::{
        confidence::Weights,
        focus::Focus,
        judge::{Costs, Judge},
    },
    known::{describe, habits::Habits, imagine, process::Devices, surroundings},
    plan::{Planner, remedy},
    say::{ask, report, worded},
    talk::conversation::Conversation,
    words::{lexicon::Lexicon, prose},
};

/// The robot's language: its words, what it knows of devices, and when it asks.
///
/// It takes milliseconds to make, and nothing to clone: clones share all but when they ask.
#[derive(Clone, Debug)]
pub struct Language {
    catalog: Arc<Catalog>,
    lexicon: Arc<Lexicon>,
    devices: Arc<Devices>,
    habits: Arc<Habits>,
    weights: Arc<Weights>,
    costs: Arc<Costs>,
    asking: Asking,
    rewriter: Option<Rewrite>,
}

impl Language {
    /// The language of a world with these classes of objects. It asks where it is unsure.
    #[must_use]
    pub fn new(catalog: Arc<Catalog>) -> Self {
        Self {
            lexicon: Arc::new(Lexicon::new(&catalog)),
            devices: Arc::new(Devices::new(&catalog)),
            habits: Arc::new(Habits::new(&catalog)),
            weights: Arc::new(Weights::builtin()),
            costs: Arc::new(Costs::new(&catalog)),
            asking: Asking::default(),
            rewriter: None,
            catalog,
        }
    }

    /// The classes of objects that it speaks of.
    #[must_use]
    pub const fn catalog(&self) -> &Arc<Catalog> {
        &self.catalog
    }

    /// The same, asking at other times.
    #[must_use]
    pub fn asking(self, asking: Asking) -> Self {
        Self { asking, ..self }
    }

    /// The same without a rewriter: the grammar alone.
    #[must_use]
    pub fn without_rewriter(self) -> Self {
        Self { rewriter: None, ..self }
    }

    /// The same with a rewriter, for what the grammar does not read to the last word: some tenths of a second each time. It is fetched when it is
    /// first needed.
    #[must_use]
    pub fn with_rewriter(self, rewriter: Rewrite) -> Self {
        Self { rewriter: Some(rewriter), ..self }
    }

    /// Whether a language model may take some tenths of a second over an utterance; what it made of one is kept.
    #[must_use]
    pub const fn may_think_long(&self) -> bool {
        self.rewriter.is_some()
    }

    /// Whether it asks at all.
    #[must_use]
    pub fn may_ask(&self) -> bool {
        self.asking != Asking::Never
    }

    /// What `utterance` means in `scene`, given the conversation so far. Any text is taken; none panics.
    #[must_use]
    pub fn understand(&self, utterance: &str, scene: &Known, context: &mut Context) -> Understanding {
        context.credit_goals(scene);
        let understanding = self.conversation(scene).understand(utterance, context);
        if let Understanding::Refusal { text, is_lost: false } = &understanding {
            context.refused = Some(text.clone());
        }
        context.note_said(false, utterance);
        context.note_said(true, understanding.reply());
        understanding
    }

    /// What is left to do once a plan has ended, other than by being interrupted: a search goes on, and ends in the
    /// request that it is for; then comes what else was asked for. Nothing, if that was all.
    #[must_use]
    pub fn carry_on(&self, scene: &Known, context: &mut Context) -> Option<Understanding> {
        context.credit_goals(scene);
        self.conversation(scene).carry_on(context)
    }

    /// Goes on with what was put off, if its time has come or what it waits for is so; nothing before that, or while there is something else to
    /// do. To be called now and then while [`Context::awaits`] holds, with the time, s, by any clock: the wait begins with the first call.
    #[must_use]
    pub fn wake(&self, now_s: f64, scene: &Known, context: &mut Context) -> Option<Understanding> {
        let understanding = self.conversation(scene).wake(now_s, context)?;
        context.note_said(true, understanding.reply());
        Some(understanding)
    }

    /// What the robot asks that finds a thing gone from where it remembers it; `yes` then means to look for it, and to go
    /// on with what was asked. The thing is to be forgotten next.
    #[must_use]
    pub fn report_missing(&self, id: ObjectId, scene: &Known, context: &mut Context) -> Understanding {
        let the = describe::short(&self.catalog, scene, id);
        context.await_search();
        let gone = prose::sentence(&format!("{the} {} not there any more", prose::is(&the)));
        ask::confirmation(format!("{gone} Shall I look for {}?", prose::it(&the)))
    }

    /// What it means that somebody points at `object`: the answer to a question of the robot's, or what is spoken of
    /// from now on.
    #[must_use]
    pub fn choose(&self, object: ObjectId, scene: &Known, context: &mut Context) -> Understanding {
        let later = context.later.clone();
        let understanding = self.conversation(scene).chosen(object, context);
        context.keep(later, understanding)
    }

    /// What is around the robot, as a rewriter reads it: `break room with couch, 6 kitchen stools; on the counter banana, dirty plate`.
    #[must_use]
    pub fn surroundings(&self, scene: &Known) -> String {
        surroundings::surroundings(&self.catalog, scene)
    }

    /// What people would call `object` in `scene`: `the red mug on the desk`.
    #[must_use]
    pub fn name(&self, object: ObjectId, scene: &Known) -> String {
        describe::full(&self.catalog, scene, object)
    }

    /// An action as the step of a plan of its own: `picking up the milk`.
    #[must_use]
    pub fn step(&self, action: Action, scene: &Known) -> Step {
        let says = worded::says(&self.catalog, scene, &action);
        Step { action, says }
    }

    /// The scene as these steps are expected to leave it.
    #[must_use]
    pub fn expected(&self, scene: &Known, steps: &[Step]) -> Known {
        let mut then = scene.clone();
        steps.iter().for_each(|step| imagine::apply(&mut then, &step.action, &self.devices));
        then
    }

    /// What the first referring expression of `utterance` may mean, with features and probabilities; `None` where it has
    /// none, or names nothing that is known.
    #[must_use]
    pub fn referents(&self, utterance: &str, scene: &Known, context: &Context) -> Option<Referents> {
        self.conversation(scene).referents(utterance, context)
    }

    /// What a plan that failed left open or on and would have closed or turned off itself, to be closed and turned off now; nothing, where it
    /// left nothing so. What was offered after the failure stays offered: [`Context::note_outcome`] need not be told of the failure of this.
    #[must_use]
    pub fn put_right(&self, scene: &Known, context: &Context) -> Option<Understanding> {
        let steps = context.failed.as_ref()?.put_right(scene);
        let says: Vec<String> = steps.iter().map(|step| step.says.clone()).collect();
        let reply = prose::sentence(&format!("I am {} again", prose::list(&says, "and")));
        (!steps.is_empty()).then_some(Understanding::Plan { steps, reply })
    }

    /// The ways to take an utterance by what its rewriter writes, with what speaks for each: what weights are fitted to.
    #[must_use]
    pub fn ways(&self, utterance: &str, scene: &Known, context: &Context) -> Vec<(String, Understanding, Evidence)> {
        self.conversation(scene).all_ways(utterance, context)
    }

    /// All ways to take an utterance, with how likely each is the one that is meant: that of the grammar, then those of the rewriter, the
    /// likeliest first.
    #[must_use]
    pub fn alternatives(&self, utterance: &str, scene: &Known, context: &Context) -> Vec<Alternative> {
        self.conversation(scene).alternatives(utterance, context)
    }

    /// Whether what came of the last step of a plan is worth a sentence: that a close look found nothing to read is not, where it was only
    /// taken to answer a question.
    #[must_use]
    pub fn is_worth_telling(&self, step: &Step, scene: &Known, context: &Context) -> bool {
        !(context.answers_next() && report::finds_nothing(&self.catalog, scene, step))
    }

    fn conversation<'a>(&'a self, scene: &'a Known) -> Conversation<'a> {
        let Self { catalog, lexicon, devices, habits, .. } = self;
        Conversation { catalog, lexicon, devices, habits, scene, judge: self.judge(), rewriter: self.rewriter }
    }

    fn judge(&self) -> Judge<'_> {
        Judge { weights: &self.weights, costs: &self.costs, asking: self.asking, repairs: 0 }
    }

    /// What the robot says after a whole plan has finished (`step` is its last) or after `step` failed; `detail` is
    /// the world's own sentence. Where something may help it offers that, and `yes` means it, once
    /// [`Context::note_outcome`] was told.
    #[must_use]
    pub fn report(&self, step: &Step, status: Status, detail: &str, scene: &Known) -> String {
        if status.is_success() {
            return report::success(&self.catalog, &self.devices, scene, step, status);
        }
        let planner = Planner::new(&self.catalog, &self.devices, &self.habits, self.judge(), scene, Focus::default());
        let remedy = remedy::remedy(planner, step, status);
        let offer = remedy.as_ref().map(|remedy| remedy.question.as_str());
        report::failure(&self.catalog, scene, step, status, detail, offer)
    }
}
