//! How likely ways to understand an utterance are by what is open: the robot's own question, and what is left of the mission.

use cohabit_cdf::{Action, Color, Fluid, GoToTarget, ObjectId, Property, StateFlag, StateFlags, Verb};

use crate::{
    context::Context,
    known::{Known, KnownObject, imagine},
    talk::{conversation::Conversation, evidence::Hypothesis, way::Way, wording::Wording},
    understanding::Step,
    words::intent::Intent,
};

/// How many times likelier a way is that the robot has just asked about, one that meets the next open goal or leads to it, and one for a later
/// goal. By judgement: labelled utterances have no goals.
const ASKED_ABOUT: f32 = 4.0;
const FOR_NEXT_GOAL: f32 = 3.0;
const FOR_LATER_GOAL: f32 = 1.5;
/// The same of one that turns round what was said. By judgement, too: few labelled utterances deny anything.
const UNFAITHFUL: f32 = 0.2;
/// The same of one that names what nobody spoke of, where a likelier one asks for the same with what was said.
const UNSPOKEN: f32 = 0.2;
/// The same of one that does no more than go to a thing, where nobody asked for that, and another was named, too: who wants a bowl of
/// fruit is not helped by a robot that stands at an apple.
const ONLY_WALKS: f32 = 0.03;

/// What becomes of the scene by a way.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Outcome {
    /// It does what is so already.
    InVain,
    /// It goes to a room and acts in another.
    Astray,
    /// Anything else.
    Usual,
}

impl Conversation<'_> {
    /// What becomes of the scene by a way.
    pub(crate) fn becomes(&self, way: &Way) -> Outcome {
        match way.steps() {
            None if way.context.is_met => Outcome::InVain,
            Some(steps) if self.is_in_vain(steps) => Outcome::InVain,
            Some(steps) if self.goes_astray(steps) => Outcome::Astray,
            _ => Outcome::Usual,
        }
    }

    /// How many times likelier each way is in the light of what is open, and of what was denied.
    pub(crate) fn prior(&self, hypotheses: &[Hypothesis], wording: &Wording<'_>, context: &Context) -> Vec<f32> {
        // Who forbids something may well mean what is open.
        let is_denied = self.lexicon.negation.occurs_in(&wording.words);
        let goals = if is_denied { Vec::new() } else { self.goals_as_ways(context) };
        let for_goal = |one: &Hypothesis| match goals.iter().position(|goal| one.way.leads_to(goal)) {
            _ if is_denied || one.outcome != Outcome::Usual => 1.0,
            _ if one.way.is_asked_about(context) => ASKED_ABOUT,
            Some(0) => FOR_NEXT_GOAL,
            Some(_) => FOR_LATER_GOAL,
            None => 1.0,
        };
        // What `it` or `there` stands for is named by nobody.
        let says_it = self.lexicon.pronouns.occurs_in(&wording.tidied);
        let is_named_otherwise = |one: &Hypothesis| {
            let names_it = |other: &Hypothesis| {
                other.unspoken < one.unspoken && other.probability >= one.probability && verbs(other).eq(verbs(one))
            };
            !says_it && hypotheses.iter().any(names_it)
        };
        let asks_to_go = (0..wording.words.len()).any(|at| self.asks_to_go(&wording.words[at..]));
        let only_walks = |one: &Hypothesis| !asks_to_go && one.way.only_goes() && one.unnamed > 0;
        let of = |one: &Hypothesis| {
            let walk = if only_walks(one) { ONLY_WALKS } else { 1.0 };
            let faithful = if one.is_unfaithful { UNFAITHFUL } else { 1.0 };
            let spoken = if is_named_otherwise(one) { UNSPOKEN } else { 1.0 };
            for_goal(one) * faithful * spoken * walk
        };
        hypotheses.iter().map(of).collect()
    }

    /// Whether words begin with a verb of going somewhere, of finding or of looking.
    fn asks_to_go(&self, words: &[String]) -> bool {
        let is_going = |intent: &Intent| {
            matches!(
                intent,
                Intent::GoTo | Intent::Find | Intent::Look | Intent::LookAround | Intent::Examine | Intent::Highlight
            )
        };
        self.lexicon.verbs.longest(words).is_some_and(|(_, intents)| intents.iter().any(is_going))
    }

    /// Whether a step leaves what it works on as it is: cereal is poured into a bowl of cereal; or things are taken and put, and in the
    /// end all is as before: what was just thrown away is thrown away.
    fn is_in_vain(&self, steps: &[Step]) -> bool {
        let mut scene = self.scene.clone();
        let changes_nothing = |step: &Step| {
            let held = scene.robot.held;
            let state = |scene: &Known| {
                let of = |id: Option<ObjectId>| id.and_then(|id| scene.object(id));
                let worked_on = of(step.object()).map(|object| (object.flags, object.fluid));
                (scene.robot.held, worked_on, of(held).map(|object| object.fluid))
            };
            // What comes out of a vessel that is not known to be full nobody knows.
            let is_unknown = held.and_then(|held| scene.object(held)).is_some_and(|object| {
                object.fluid == Fluid::None && self.catalog.class(object.class).has(Property::Fillable)
            });
            let before = state(&scene);
            imagine::apply(&mut scene, &step.action, self.devices);
            let changes = matches!(
                step.action,
                Action::Interact { verb: Verb::Break | Verb::Close | Verb::Open | Verb::Pour, .. }
            );
            let pours_unknown = is_unknown && matches!(step.action, Action::Interact { verb: Verb::Pour, .. });
            changes && !pours_unknown && state(&scene) == before
        };
        let moves = |step: &Step| matches!(step.action, Action::PickUp { .. } | Action::Place { .. });
        // What is put beside another thing stands elsewhere, be it on the same table.
        let is_moved = steps.iter().any(|step| step.action.beside().is_some());
        steps.iter().any(changes_nothing)
            || !is_moved && steps.iter().any(moves) && lasting(&scene) == lasting(self.scene)
    }

    /// Whether it goes to a room to act on what is in another one.
    fn goes_astray(&self, steps: &[Step]) -> bool {
        steps.windows(2).any(|pair| {
            let Action::GoTo { target: GoToTarget::Room(room) } = pair[0].action else { return false };
            let acted_on = pair[1].object().filter(|id| self.scene.robot.held != Some(*id));
            acted_on.and_then(|id| self.scene.object(id)).is_some_and(|object| object.room != room)
        })
    }

    /// What the goals that are open ask for.
    fn goals_as_ways(&self, context: &Context) -> Vec<Way> {
        let goals = self.open_goals().map(|goal| {
            let mut then = Context { pending: None, ..context.at_new_utterance() };
            let understanding = self.understand_words(self.words_of_goal(goal), &mut then);
            Way { understanding, probability: 1.0, context: then }
        });
        goals.filter(|way| way.steps().is_some()).collect()
    }
}

/// The verbs of what a rewriter wrote.
fn verbs(one: &Hypothesis) -> impl Iterator<Item = &str> {
    one.text.split("; ").filter_map(|request| request.split(' ').next())
}

/// What a thing is in or on, what fills it, its colour and its states.
type Lasting = (Option<ObjectId>, Fluid, Color, StateFlags);

/// What is in the hand, and of each thing where it is and what it is like, but for what says only that it was used.
fn lasting(scene: &Known) -> (Option<ObjectId>, Vec<Lasting>) {
    let of = |object: &KnownObject| {
        let mut flags = object.flags;
        flags.set(StateFlag::PickedUp, false);
        flags.set(StateFlag::Used, false);
        (object.parent, object.fluid, object.color, flags)
    };
    (scene.robot.held, scene.objects.iter().map(of).collect())
}
