//! All ways to understand an utterance: what the grammar makes of it, what the learned parser does, the plain requests that it is like,
//! and each of the things that one of these would have to ask about.

use cohabit_cdf::{Action, ClassId, GoToTarget, ObjectId, RoomId};
use cohabit_parser::{
    Reading,
    request::{Act, Relation, Request},
};

use crate::{
    answer::HINT,
    ask,
    clause::{self, Part},
    condition,
    context::{Consent, Context, Pending},
    conversation::Conversation,
    describe,
    evidence::{Evidence, Feature, Weights},
    imagine,
    likeness::{Likeness, SHARPNESS},
    parsed::{self, Worth, worth},
    question, reply,
    understanding::{Step, Understanding},
    wording::Wording,
};

/// A way to understand an utterance.
#[derive(Clone, Debug)]
pub struct Alternative {
    /// What it would mean.
    pub understanding: Understanding,
    /// How likely it is the one that is meant; 0, until all are known.
    pub probability: f32,
    /// What speaks for it.
    pub evidence: Evidence,
    /// The conversation after it.
    pub(crate) context: Context,
}

/// What is known of an utterance, whatever it means.
struct Said<'a> {
    wording: &'a Wording<'a>,
    readings: Vec<Reading>,
    is_partial: bool,
    is_guessed: bool,
    is_asked: bool,
    is_forbidden: bool,
    is_conditional: bool,
    is_pending: bool,
    /// How many words nobody ever met, of 3 at most.
    unheard: f32,
    named: Vec<Named>,
    /// How many words there are, of 20 at most.
    length: f32,
    /// How many requests the parser sees, and how likely one replaces what was asked before.
    requests: f32,
    instead: f32,
    /// How many requests the grammar sees.
    clauses: f32,
}

/// What a name may mean.
#[derive(PartialEq)]
enum Named {
    Thing(Vec<ClassId>),
    Room(RoomId),
    Color(String),
}

/// What a way to understand an utterance is about: things, with what they stand on or in, their colors, and rooms.
#[derive(Default)]
struct About {
    classes: Vec<ClassId>,
    rooms: Vec<RoomId>,
    colors: Vec<String>,
}

/// Into how many parts an utterance is taken apart at most.
const MOST_PARTS: usize = 5;

impl Conversation<'_> {
    /// What the grammar makes of it.
    pub(crate) fn read(&self, utterance: &str, context: &Context) -> Alternative {
        let mut then = context.at_new_utterance();
        let understanding = self.understand_said(utterance, &mut then);
        Alternative::new(understanding, then, Evidence::default())
    }

    /// All ways to understand it, the likeliest first; the one of the grammar alone, if that speaks for itself.
    pub(crate) fn alternatives(&self, utterance: &str, context: &Context) -> Vec<Alternative> {
        let wording = self.wording(utterance);
        let by_grammar = self.read(utterance, context);
        if self.speaks_for_itself(&wording, &by_grammar) {
            return vec![Alternative { probability: 1.0, ..by_grammar }];
        }
        self.alternatives_to(by_grammar, &wording, context)
    }

    /// What the grammar makes of it, and all else, the likeliest first.
    pub(crate) fn alternatives_to(
        &self,
        by_grammar: Alternative,
        wording: &Wording<'_>,
        context: &Context,
    ) -> Vec<Alternative> {
        let said = self.said(wording, context);
        let mut found = self.in_one(by_grammar, &said, context);
        found.extend(self.in_parts(&said, context));
        self.weighed(found, &said, context)
    }

    /// What the grammar makes of it, and the others; but not its parts.
    fn in_one(&self, by_grammar: Alternative, said: &Said<'_>, context: &Context) -> Vec<Alternative> {
        let is_reason = worth(&by_grammar.understanding) > Worth::None;
        let read = said.readings.iter().enumerate();
        let read = read.filter_map(|(at, one)| self.of_reading(one, at == 0, said, context));
        let mut others: Vec<Alternative> = read.chain(self.of_likeness(said, context)).collect();
        // Why the grammar thinks that it cannot be done says more than why another reading cannot.
        others.retain(|one| !is_reason || worth(&one.understanding) != Worth::Refused);
        let mut found = vec![of_grammar(by_grammar, said)];
        found.extend(others);
        let settle = |one: &Alternative| self.of_candidates(one, said).into_iter().chain(self.agreed(one, said));
        let settled: Vec<Alternative> = found.iter().flat_map(settle).collect();
        found.extend(settled);
        found
    }

    /// These with their probabilities, the likeliest first; the same in several ways counts as one.
    fn weighed(&self, found: Vec<Alternative>, said: &Said<'_>, context: &Context) -> Vec<Alternative> {
        let mut all: Vec<Alternative> = Vec::with_capacity(found.len());
        for mut one in found.into_iter().filter(|one| !matches!(one.understanding, Understanding::Stop { .. })) {
            self.describe(&mut one, said, context);
            let is_known = |other: &&mut Alternative| {
                is_same(&other.understanding, &one.understanding)
                    && other.context.later.is_empty() == one.context.later.is_empty()
            };
            match all.iter_mut().find(is_known) {
                Some(known) => known.evidence.join(&one.evidence),
                None => all.push(one),
            }
        }
        all.iter_mut().for_each(cross);
        let evidence: Vec<Evidence> = all.iter().map(|one| one.evidence).collect();
        let probabilities = Weights::builtin().probabilities(&evidence);
        all.iter_mut().zip(probabilities).for_each(|(one, probability)| one.probability = probability);
        all.sort_by(|one, other| other.probability.total_cmp(&one.probability));
        all
    }

    /// The likeliest way to understand a part of an utterance.
    fn likeliest_of_part(&self, part: &str, context: &Context) -> Option<Alternative> {
        let wording = self.wording(part);
        let by_grammar = self.read(part, context);
        if self.speaks_for_itself(&wording, &by_grammar) {
            return Some(Alternative { probability: 1.0, ..by_grammar });
        }
        let said = self.said(&wording, context);
        let found = self.in_one(by_grammar, &said, context);
        self.weighed(found, &said, context).into_iter().next()
    }

    fn said<'a>(&self, wording: &'a Wording<'a>, context: &Context) -> Said<'a> {
        let readings = self.readings(wording.utterance, context);
        let parts = clause::parts(self.lexicon, self.catalog, &wording.tidied);
        let all: f32 = readings.iter().map(|reading| reading.probability).sum::<f32>().max(f32::MIN_POSITIVE);
        let mean = |of: &dyn Fn(&Reading) -> f32| {
            readings.iter().map(|reading| reading.probability * of(reading)).sum::<f32>() / all
        };
        Said {
            wording,
            is_partial: self.leaves_words_out(wording),
            is_guessed: self.takes_for_question(wording),
            is_asked: wording.ends_as_question() || question::read(self.lexicon, &wording.tidied).is_some(),
            is_forbidden: parts.iter().any(|part| matches!(part, Part::Forbidden(_))),
            is_conditional: condition::is_conditional(self.lexicon, &wording.words),
            is_pending: context.pending.is_some(),
            unheard: share(wording.unheard.len()),
            length: wording.words.len().min(20) as f32 / 20.0,
            named: self.names_in(&wording.words),
            requests: mean(&|reading| count(&reading.requests)),
            instead: mean(&|reading| f32::from(u8::from(replaces(&reading.requests)))),
            clauses: parts.iter().filter(|part| matches!(part, Part::Clause(_) | Part::Forbidden(_))).count().max(1)
                as f32,
            readings,
        }
    }

    /// What the words name: things, and rooms.
    fn names_in(&self, words: &[String]) -> Vec<Named> {
        let mut named = Vec::new();
        let mut at = 0;
        while at < words.len() {
            let rest = &words[at..];
            let is_in_scene = |class: &ClassId| self.scene.objects.iter().any(|object| object.class == *class);
            let (room, things) = (self.lexicon.rooms.longest(rest), self.lexicon.classes.longest(rest));
            let length_of_room = room.map_or(0, |(length, _)| length);
            let length = things.as_ref().map_or(0, |(length, _)| *length);
            let color = self.lexicon.colors.exact(&rest[..1]).map(|color| Named::Color(color.clone()));
            let name = match (room, things) {
                (Some((_, room)), _) if length_of_room >= length => Some(Named::Room(*room)),
                (_, Some((_, namings))) => {
                    let mut classes: Vec<ClassId> = namings.iter().map(|one| one.class).collect();
                    // What has not been seen is meant where nothing that has been is called so.
                    if classes.iter().any(is_in_scene) {
                        classes.retain(is_in_scene);
                    }
                    Some(Named::Thing(classes))
                }
                _ => color,
            };
            named.extend(name.filter(|name| !named.contains(name)));
            at += length.max(length_of_room).max(1);
        }
        named
    }

    fn of_reading(&self, reading: &Reading, is_first: bool, said: &Said<'_>, context: &Context) -> Option<Alternative> {
        // Stops were heard before.
        if reading.requests.iter().any(parsed::stops) {
            return None;
        }
        // What is asked only on a condition is not done without it.
        if said.is_conditional && reading.requests.iter().all(|request| request.conditions.is_empty()) {
            return None;
        }
        let mut then = context.at_new_utterance();
        let (understanding, certainty) = self.understand_reading(reading, said.wording.utterance, &mut then)?;
        let mut evidence = Evidence::default();
        let leaves_out = reading.requests.iter().any(|request| parsed::unknown_words(request).is_some());
        let replies = reading.requests.iter().any(|request| matches!(request.act, Act::Answer(_)));
        evidence.set(Feature::Parser, reading.probability * certainty);
        evidence.set_if(Feature::ParserFirst, is_first);
        evidence.set_if(Feature::ParserLeftOut, leaves_out);
        evidence.set_if(Feature::ParserReply, replies && said.is_pending);
        count_requests(&mut evidence, count(&reading.requests), said);
        let kept = if replaces(&reading.requests) { 0.0 } else { said.instead };
        evidence.set(Feature::NotInstead, kept);
        Some(Alternative::new(understanding, then, evidence))
    }

    fn of_likeness(&self, said: &Said<'_>, context: &Context) -> Vec<Alternative> {
        let mut found = Vec::new();
        // A single plain request would leave a condition out, and likeness does not tell a deed from its contrary.
        if said.is_conditional || said.is_forbidden {
            return found;
        }
        for (at, likely) in self.likely_requests(said.wording.utterance).into_iter().enumerate() {
            let mut then = context.at_new_utterance();
            let understanding = match likely.request.strip_prefix("social: ") {
                Some(kind) => match parsed::social(kind) {
                    Some(social) => Understanding::answer(parsed::small_talk(social)),
                    None => continue,
                },
                None if likely.request == self.scene.mission => self.pursue(&mut then),
                None if likely.request == "nothing" => {
                    Understanding::refusal(format!("That is nothing that I can do. {HINT}"))
                }
                None => as_it_is(self.understand_said(&likely.request, &mut then)),
            };
            let mut evidence = Evidence::default();
            evidence.set(Feature::Likeness, likely.probability);
            evidence.set_if(Feature::LikenessFirst, at == 0);
            evidence.set(Feature::LikenessOfSeveral, share((said.requests - 1.0).round() as usize));
            evidence.set(Feature::LikenessOfLong, said.length);
            evidence.set_if(Feature::LikenessPending, said.is_pending);
            count_requests(&mut evidence, 1.0, said);
            evidence.set(Feature::NotInstead, said.instead);
            found.push(Alternative::new(understanding, then, evidence));
        }
        found
    }

    /// What its parts mean one after the other, where each is something to do or nothing to do with it.
    fn in_parts(&self, said: &Said<'_>, context: &Context) -> Option<Alternative> {
        let parts = clause::segments(self.lexicon, &said.wording.words);
        if parts.len() < 2 || parts.len() > MOST_PARTS || said.is_conditional || said.is_forbidden {
            return None;
        }
        let (mut scene, mut then) = (self.scene.clone(), context.at_new_utterance());
        let (mut steps, mut probability) = (Vec::new(), 1.0);
        for part in parts {
            let there = Conversation { scene: &scene, ..*self };
            let likeliest = there.likeliest_of_part(&part.join(" "), &then)?;
            probability *= likeliest.probability;
            match likeliest.understanding {
                Understanding::Plan { steps: next, .. } => {
                    next.iter().for_each(|step| imagine::apply(&mut scene, &step.action, self.devices));
                    then = likeliest.context;
                    steps.extend(next);
                }
                Understanding::Answer { holds: None, .. } if !likeliest.context.is_met => {}
                _ => return None,
            }
        }
        if steps.is_empty() {
            return None;
        }
        then.begin(&steps);
        let mut evidence = Evidence::default();
        evidence.set(Feature::Parts, probability);
        evidence.set(Feature::NotInstead, said.instead);
        let reply = reply::plan_reply(&steps, &[]);
        Some(Alternative::new(Understanding::Plan { steps, reply }, then, evidence))
    }

    /// What is to be done with each thing that one way would have to ask about.
    fn of_candidates(&self, asked: &Alternative, said: &Said<'_>) -> Vec<Alternative> {
        let Understanding::Question { candidates, .. } = &asked.understanding else { return Vec::new() };
        if asked.context.pending.is_none() {
            return Vec::new();
        }
        let likely = self.likely_candidates(said.wording.utterance, candidates);
        let chosen = likely.into_iter().filter_map(|(id, probability)| {
            let mut then = asked.context.clone();
            let understanding = self.chosen(id, &mut then);
            let mut evidence = Evidence::default();
            evidence.set(Feature::Candidate, probability * asked.sureness());
            evidence.set_if(Feature::CandidateOnly, candidates.len() == 1);
            evidence.take_over(&asked.evidence);
            matches!(understanding, Understanding::Plan { .. }).then(|| Alternative::new(understanding, then, evidence))
        });
        chosen.collect()
    }

    /// What is to be done with what is in the hand put down first, where one way would ask whether to: who corrects what was taken agrees.
    fn agreed(&self, asked: &Alternative, said: &Said<'_>) -> Option<Alternative> {
        let Some(Pending::PutDown { clauses }) = &asked.context.pending else { return None };
        let mut then = asked.context.clone();
        let consent = Consent { may_put_down: true, is_agreed: false };
        let understanding = self.plan(clauses.clone(), consent, &mut then);
        let mut evidence = Evidence::default();
        evidence.set(Feature::Agreed, asked.sureness());
        evidence.set(Feature::AgreedInstead, asked.sureness() * said.instead);
        evidence.take_over(&asked.evidence);
        Some(Alternative::new(understanding, then, evidence))
    }

    /// How likely the words mean each of these, if they mean any.
    pub(crate) fn likely_candidates(&self, said: &str, candidates: &[ObjectId]) -> Vec<(ObjectId, f32)> {
        let likeness = Likeness::builtin();
        let said = likeness.of(said);
        let names = describe::apart(self.catalog, self.scene, candidates);
        let utility = |(id, name): (&ObjectId, &String)| {
            let class = self.scene.object(*id)?.class;
            let like = likeness.to_class(&said, self.catalog, class) + said.likeness(&likeness.of(name));
            Some((*id, like / (2.0 * SHARPNESS)))
        };
        let utilities: Vec<(ObjectId, f32)> = candidates.iter().zip(&names).filter_map(utility).collect();
        let highest = utilities.iter().map(|(_, utility)| *utility).fold(f32::NEG_INFINITY, f32::max);
        let whole: f32 = utilities.iter().map(|(_, utility)| (utility - highest).exp()).sum();
        utilities.into_iter().map(|(id, utility)| (id, (utility - highest).exp() / whole)).collect()
    }

    /// What may be said of a way without knowing who found it.
    fn describe(&self, one: &mut Alternative, said: &Said<'_>, before: &Context) {
        let (understanding, evidence) = (&one.understanding, &mut one.evidence);
        match understanding {
            Understanding::Plan { steps, .. } => {
                evidence.set(Feature::Plan, 1.0);
                evidence.set_if(Feature::PlanAsked, said.is_asked);
                evidence.set_if(Feature::PlanForbidden, said.is_forbidden);
                evidence.set(Feature::PlanUnheard, said.unheard);
                evidence.set(Feature::Steps, share(steps.len() / 2));
                evidence.set_if(Feature::Looks, steps.iter().all(Step::only_looks));
            }
            Understanding::Question { candidates, .. } => {
                evidence.set(Feature::Question, 1.0);
                if candidates.len() > 1 {
                    let likely = self.likely_candidates(said.wording.utterance, candidates);
                    evidence.set(Feature::QuestionDecided, likely.iter().map(|(_, share)| *share).fold(0.0, f32::max));
                    evidence.set(Feature::QuestionOpen, 1.0);
                }
                evidence.set_if(Feature::Mismatch, ask::is_mismatch(understanding));
                evidence.set_if(Feature::Repeated, repeats(understanding, before));
                evidence.set(Feature::QuestionUnheard, said.unheard);
            }
            Understanding::Answer { holds, .. } => {
                evidence.set(Feature::Answer, 1.0);
                evidence.set_if(Feature::AnswerWhether, holds.is_some());
                evidence.set_if(Feature::AnswerAsked, said.is_asked);
                evidence.set_if(Feature::AnswerIdle, one.context.is_met);
            }
            Understanding::Refusal { .. } => evidence.set(Feature::Refusal, 1.0),
            Understanding::Stop { .. } => {}
        }
        // What comes later is about more than what is done first.
        if !one.context.later.is_empty() {
            return;
        }
        let about = self.about(understanding);
        let is_missing = |name: &&Named| match name {
            Named::Thing(classes) => !about.classes.iter().any(|class| classes.contains(class)),
            Named::Room(room) => !about.rooms.contains(room),
            Named::Color(color) => !about.colors.contains(color),
        };
        let is_done = matches!(understanding, Understanding::Plan { .. } | Understanding::Answer { .. });
        // A condition may name what nothing is done with.
        if is_done && !said.is_conditional {
            let missing = said.named.iter().filter(is_missing).count();
            evidence.set(Feature::Missing, share(missing));
            evidence.set_if(Feature::MissingAny, missing > 0);
        }
        let is_named = |class: &&ClassId| {
            said.named.iter().any(|name| matches!(name, Named::Thing(classes) if classes.contains(class)))
        };
        if !about.classes.is_empty() {
            let named = about.classes.iter().filter(is_named).count();
            evidence.set(Feature::Unnamed, 1.0 - named as f32 / about.classes.len() as f32);
        }
    }

    fn about(&self, understanding: &Understanding) -> About {
        let mut about = About::default();
        let objects: Vec<ObjectId> = match understanding {
            Understanding::Plan { steps, .. } => {
                about.rooms.extend(steps.iter().filter_map(|step| match step.action {
                    Action::GoTo { target: GoToTarget::Room(room) } => Some(room),
                    _ => None,
                }));
                steps.iter().filter_map(Step::object).collect()
            }
            Understanding::Answer { highlight, .. } => highlight.clone(),
            _ => Vec::new(),
        };
        for object in objects.iter().flat_map(|id| self.scene.object(*id).into_iter().chain(self.scene.ancestors(*id)))
        {
            if !about.classes.contains(&object.class) {
                about.classes.push(object.class);
            }
            about.rooms.push(object.room);
            about.colors.push(describe::color(self.catalog, object));
        }
        about
    }
}

impl Alternative {
    const fn new(understanding: Understanding, context: Context, evidence: Evidence) -> Self {
        Self { understanding, probability: 0.0, evidence, context }
    }

    /// How sure who found it is of it.
    fn sureness(&self) -> f32 {
        [Feature::Parser, Feature::Likeness, Feature::GrammarQuestion]
            .iter()
            .fold(0.0, |most, feature| self.evidence.get(*feature).max(most))
    }
}

/// What the grammar makes of it, with what speaks for that.
fn of_grammar(by_grammar: Alternative, said: &Said<'_>) -> Alternative {
    let Alternative { understanding, mut evidence, .. } = by_grammar;
    let [kind, partial] = match &understanding {
        Understanding::Plan { .. } => [Feature::GrammarPlan, Feature::GrammarPlanPartial],
        Understanding::Question { .. } => [Feature::GrammarQuestion, Feature::GrammarQuestionPartial],
        Understanding::Answer { .. } => [Feature::GrammarAnswer, Feature::GrammarAnswerPartial],
        _ => [Feature::GrammarRefusal, Feature::GrammarRefusalPartial],
    };
    evidence.set(kind, 1.0);
    evidence.set_if(partial, said.is_partial);
    let is_plan = matches!(understanding, Understanding::Plan { .. });
    evidence.set(Feature::GrammarPlanLong, if is_plan { said.length } else { 0.0 });
    evidence.set_if(Feature::GrammarPlanReply, is_plan && said.is_pending);
    evidence.set_if(Feature::GrammarMismatch, ask::is_mismatch(&understanding));
    evidence.set_if(
        Feature::GrammarAnswerGuessed,
        said.is_guessed && matches!(understanding, Understanding::Answer { .. }),
    );
    count_requests(&mut evidence, said.clauses + by_grammar.context.later.len() as f32, said);
    evidence.set(Feature::NotInstead, said.instead);
    Alternative { understanding, evidence, ..by_grammar }
}

/// The least likelihood that counts.
const LEAST: f32 = 0.01;

/// Evidence that follows from the rest: how likely it is on a logarithmic scale, and how sure parser and likeness are of what is no plan.
fn cross(one: &mut Alternative) {
    let logarithm = |feature| 1.0 - one.evidence.get(feature).clamp(LEAST, 1.0).ln() / LEAST.ln();
    let [parser, likeness, candidate, parts] =
        [Feature::Parser, Feature::Likeness, Feature::Candidate, Feature::Parts].map(logarithm);
    let grammar = [Feature::GrammarPlan, Feature::GrammarQuestion, Feature::GrammarAnswer, Feature::GrammarRefusal];
    let agreed = logarithm(Feature::Agreed);
    let grammar = grammar.into_iter().map(|feature| one.evidence.get(feature)).fold(0.0, f32::max);
    let most = [parser, likeness, candidate, parts, agreed, grammar].into_iter().fold(0.0, f32::max);
    one.evidence.set(Feature::ParserLog, parser);
    one.evidence.set(Feature::LikenessLog, likeness);
    one.evidence.set(Feature::CandidateLog, candidate);
    one.evidence.set(Feature::Supported, most);
    let [parser, likeness] = match one.understanding {
        Understanding::Question { .. } => [Feature::ParserOfQuestion, Feature::LikenessOfQuestion],
        Understanding::Answer { .. } => [Feature::ParserOfAnswer, Feature::LikenessOfAnswer],
        Understanding::Refusal { .. } => [Feature::ParserOfRefusal, Feature::LikenessOfRefusal],
        _ => return,
    };
    one.evidence.set(parser, one.evidence.get(Feature::Parser));
    one.evidence.set(likeness, one.evidence.get(Feature::Likeness));
}

/// How many requests fewer or more these are than the parser sees.
fn count_requests(evidence: &mut Evidence, requests: f32, said: &Said<'_>) {
    evidence.set(Feature::Fewer, ((said.requests - requests) / 3.0).clamp(0.0, 1.0));
    evidence.set(Feature::More, ((requests - said.requests) / 3.0).clamp(0.0, 1.0));
}

/// A count as a share of 3, which stands for many.
fn share(count: usize) -> f32 {
    count.min(3) as f32 / 3.0
}

fn count(requests: &[Request]) -> f32 {
    requests.iter().filter(|request| parsed::asks(request)).count() as f32
}

fn replaces(requests: &[Request]) -> bool {
    requests.iter().any(|request| request.relation == Relation::Instead)
}

/// Whether two ways come to the same.
fn is_same(one: &Understanding, other: &Understanding) -> bool {
    match (one, other) {
        (Understanding::Plan { steps: one, .. }, Understanding::Plan { steps: other, .. }) => {
            one.iter().map(|step| &step.action).eq(other.iter().map(|step| &step.action))
        }
        (Understanding::Answer { text: one, highlight, .. }, Understanding::Answer { text, highlight: other, .. }) => {
            highlight == other && without_yes_or_no(one) == without_yes_or_no(text)
        }
        (one, other) => one == other,
    }
}

/// Whether it asks what the robot asked last.
fn repeats(understanding: &Understanding, context: &Context) -> bool {
    let asked = context.lines.iter().rev().find(|(by_robot, _)| *by_robot);
    matches!(understanding, Understanding::Question { text, .. } if asked.is_some_and(|(_, last)| last == text))
}

/// The answer without its yes or no: what was asked may have been the contrary.
fn as_it_is(understanding: Understanding) -> Understanding {
    match &understanding {
        Understanding::Answer { text, highlight, .. } if without_yes_or_no(text) != *text => {
            Understanding::about(without_yes_or_no(text), highlight.clone())
        }
        _ => understanding,
    }
}

fn without_yes_or_no(text: &str) -> String {
    let rest = text.strip_prefix("Yes, ").or_else(|| text.strip_prefix("No, "));
    rest.map_or_else(|| text.to_owned(), describe::sentence)
}
