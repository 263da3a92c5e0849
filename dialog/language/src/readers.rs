//! The readers of an utterance, each with what it takes it for: the grammar, the learned parser, the likeness to plain requests, and the
//! things that it names. [`crate::parts`] has its parts.

use cohabit_cdf::{ClassId, ObjectId, Property};
use cohabit_parser::{
    Reading,
    request::{Act, Command},
};

use crate::{
    alternatives::{Alternative, without_yes_or_no},
    answer::HINT,
    ask,
    context::{Consent, Context, Pending},
    conversation::Conversation,
    describe,
    evidence::{Evidence, Feature, shares},
    likeness::{Likeness, SHARPNESS},
    parsed,
    said::{Mention, Named, Said, count, replaces, share},
    understanding::Understanding,
};

/// Up to how many words are few.
const SHORT: usize = 6;
/// For how many things that are named a pronoun may stand.
const MOST_ANTECEDENTS: usize = 2;
/// How many things that are named without a verb are carried at most.
const MOST_CARRIED: usize = 3;

impl Conversation<'_> {
    pub(crate) fn of_reading(
        &self,
        reading: &Reading,
        is_first: bool,
        said: &Said<'_>,
        context: &Context,
    ) -> Option<Alternative> {
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

    /// The same with each thing that was named instead of a pronoun: `I think the bowl is broken, can you fix it?`
    pub(crate) fn with_antecedents(&self, reading: &Reading, said: &Said<'_>) -> Vec<Reading> {
        let is_pronoun = |argument: &String| self.lexicon.pronouns.exact(&self.lexicon.normalise(argument).0).is_some();
        let first = reading.requests.iter().position(parsed::asks);
        let Some(Act::Do(Command::Known { arguments, .. })) = first.map(|at| &reading.requests[at].act) else {
            return Vec::new();
        };
        let Some(place) = arguments.iter().position(is_pronoun) else { return Vec::new() };
        let is_free =
            |mention: &&Mention| matches!(mention.named, Named::Thing(_)) && !arguments.contains(&mention.words);
        let named = said.mentions.iter().filter(is_free).take(MOST_ANTECEDENTS);
        let replaced = named.filter_map(|mention| {
            let mut reading = reading.clone();
            match &mut reading.requests[first?].act {
                Act::Do(Command::Known { arguments, .. }) => arguments[place].clone_from(&mention.words),
                _ => return None,
            }
            Some(reading)
        });
        replaced.collect()
    }

    pub(crate) fn of_likeness(&self, said: &Said<'_>, context: &Context) -> Vec<Alternative> {
        let mut found = Vec::new();
        // A single plain request would leave a condition out, and likeness does not tell a deed from its contrary.
        if said.is_conditional || said.is_forbidden {
            return found;
        }
        for (at, likely) in
            self.likely_requests(said.wording.utterance, &self.spoken_of(said, context)).into_iter().enumerate()
        {
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

    /// What may be meant without being named, where nothing is: what is in the hand, and what was spoken of last.
    fn spoken_of(&self, said: &Said<'_>, context: &Context) -> Vec<ObjectId> {
        if !said.mentions.is_empty() {
            return Vec::new();
        }
        let recent = context.focus.recent.iter().take(MOST_ANTECEDENTS);
        self.scene.robot.held.iter().chain(recent).copied().collect()
    }

    /// What the things that are named may be asked for without a verb: `mug in the sink`, `golf ball to the reception`.
    pub(crate) fn of_names(&self, said: &Said<'_>, context: &Context) -> Option<Alternative> {
        let is_carried = |class: &ClassId| self.is_carried(*class);
        let holds = |class: &ClassId| self.catalog.class(*class).has(Property::Receptacle) && !is_carried(class);
        let (mut carried, mut places) = (Vec::new(), Vec::new());
        for Mention { words, named } in &said.mentions {
            match named {
                Named::Room(_) => places.push((words, "bring", "to")),
                Named::Thing(classes) if classes.iter().any(is_carried) => carried.push(words.as_str()),
                Named::Thing(classes) if classes.iter().any(holds) => {
                    let is_closed = classes.iter().any(|class| self.catalog.class(*class).has(Property::Openable));
                    places.push((words, "put", if is_closed { "in" } else { "on" }));
                }
                _ => {}
            }
        }
        if carried.is_empty() && self.scene.robot.held.is_some() {
            carried.push("it");
        }
        let [(place, verb, preposition)] = places.as_slice() else { return None };
        if said.is_conditional || said.is_forbidden || !(1..=MOST_CARRIED).contains(&carried.len()) {
            return None;
        }
        let requests = carried.iter().map(|thing| format!("{verb} {thing} {preposition} {place}"));
        let way = self.of_named(&requests.collect::<Vec<_>>().join(". "), said, context);
        Some(way).filter(|way| matches!(way.understanding, Understanding::Plan { .. }))
    }

    /// What the grammar makes of a text that was made of what is named.
    fn of_named(&self, text: &str, said: &Said<'_>, context: &Context) -> Alternative {
        let mut evidence = Evidence::default();
        evidence.set(Feature::Names, 1.0);
        evidence.set(Feature::NotInstead, said.instead);
        let mut then = context.at_new_utterance();
        Alternative::new(self.understand_said(text, &mut then), then, evidence)
    }

    fn is_carried(&self, class: ClassId) -> bool {
        self.catalog.class(class).has(Property::Pickupable)
    }

    /// What is to be done with each thing that one way would have to ask about.
    pub(crate) fn of_candidates(&self, asked: &Alternative, said: &Said<'_>) -> Vec<Alternative> {
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
    pub(crate) fn agreed(&self, asked: &Alternative, said: &Said<'_>) -> Option<Alternative> {
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
        let (known, utilities): (Vec<ObjectId>, Vec<f32>) = candidates.iter().zip(&names).filter_map(utility).unzip();
        known.into_iter().zip(shares(&utilities, f32::NEG_INFINITY)).collect()
    }
}

/// What the grammar makes of it, with what speaks for that.
pub(crate) fn of_grammar(by_grammar: Alternative, said: &Said<'_>) -> Alternative {
    let Alternative { understanding, mut evidence, .. } = by_grammar;
    let [kind, partial] = match &understanding {
        Understanding::Plan { .. } => [Feature::GrammarPlan, Feature::GrammarPlanPartial],
        Understanding::Question { .. } => [Feature::GrammarQuestion, Feature::GrammarQuestionPartial],
        Understanding::Answer { .. } => [Feature::GrammarAnswer, Feature::GrammarAnswerPartial],
        _ => [Feature::GrammarRefusal, Feature::GrammarRefusalPartial],
    };
    evidence.set(kind, 1.0);
    evidence.set_if(partial, said.is_partial);
    evidence.set_if(Feature::GrammarPlain, said.is_plain);
    evidence.set(Feature::GrammarPlainLong, if said.is_plain { said.length } else { 0.0 });
    evidence.set_if(Feature::GrammarPlainShort, said.is_plain && said.wording.words.len() <= SHORT);
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

/// How many requests fewer or more these are than the parser sees.
fn count_requests(evidence: &mut Evidence, requests: f32, said: &Said<'_>) {
    evidence.set(Feature::Fewer, ((said.requests - requests) / 3.0).clamp(0.0, 1.0));
    evidence.set(Feature::More, ((requests - said.requests) / 3.0).clamp(0.0, 1.0));
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
