//! All ways to understand an utterance: what the grammar makes of it, what the learned parser does, the plain requests that it is like,
//! and each of the things that one of these would have to ask about.

use cohabit_cdf::{Action, ClassId, GoToTarget, ObjectId, Property, RoomId, Verb};
use cohabit_parser::Reranker;

use crate::{
    ask,
    clause::Clause,
    context::Context,
    conversation::Conversation,
    describe,
    evidence::{Evidence, Feature, Fit, FitFeature, Weights},
    open_goals,
    parsed::{Worth, worth},
    phrase::{Phrase, Place},
    readers::of_grammar,
    said::{Named, Said, share},
    search::Search,
    token,
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
    /// What speaks for it whatever the words, nats.
    pub(crate) prior: f32,
    /// What it comes to, in plain words.
    pub paraphrase: String,
    /// What the re-ranker says of it; nothing, if it was too unlikely to be read.
    pub fit: Option<Fit>,
    /// What was named that it is not about: `the fridge`.
    pub(crate) leaves_out: Vec<String>,
    /// The conversation after it.
    pub(crate) context: Context,
}

/// What a way to understand an utterance is about: things, with what they stand on or in, their colors, and rooms.
#[derive(Default)]
struct About {
    classes: Vec<ClassId>,
    rooms: Vec<RoomId>,
    colors: Vec<String>,
}

/// From which probability on the parser is sure of a reading.
const SURE_READING: f32 = 0.4;

/// Words besides pauses that part what is asked for from what is said beside it.
const PARTERS: [&str; 8] = ["because", "cause", "cos", "coz", "before", "so", "but", "until"];
/// Words that a statement begins with.
const SUBJECTS: [&str; 14] =
    ["i", "we", "he", "she", "it", "they", "that", "this", "there", "you", "who", "my", "our", "somebody"];

/// How many ways are read together with what was said.
const SHORTLIST: usize = 8;

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
        if let Some(named) = self.with_lab_named(&wording) {
            return self.alternatives(&named, context);
        }
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
        if self.is_agreed(&by_grammar, &said, context) {
            return vec![Alternative { probability: 1.0, ..by_grammar }];
        }
        let mut found = self.in_one(by_grammar, &said, context);
        found.extend(self.in_parts(&said, context));
        found.extend(self.of_names(&said, context));
        found.extend(self.of_previous(&said, context));
        found.extend(self.of_others(&said, context));
        found.extend(self.of_question(&said, context));
        if self.names_other(&wording.words) {
            found.retain(|one| !repeats_deeds(&one.understanding, context));
        }
        self.reranked(self.weighed(found, &said, context), &said, context)
    }

    /// Whether the parser surely reads the same as the grammar does to the last word: then nobody else is asked.
    fn is_agreed(&self, by_grammar: &Alternative, said: &Said<'_>, context: &Context) -> bool {
        let is_clear = said.is_plain && !said.is_forbidden && worth(&by_grammar.understanding) >= Worth::Answered;
        let first = said.readings.first().filter(|first| is_clear && first.probability > SURE_READING);
        let reading = first.and_then(|first| self.of_reading(first, true, said, context));
        reading.is_some_and(|reading| is_same(&reading.understanding, &by_grammar.understanding))
    }

    /// The likeliest of these read together with what was said; all others behind them.
    fn reranked(&self, mut ranked: Vec<Alternative>, said: &Said<'_>, context: &Context) -> Vec<Alternative> {
        if let Some(plain) = ranked.iter().skip(SHORTLIST).position(Alternative::is_plain) {
            ranked[SHORTLIST - 1..=SHORTLIST + plain].rotate_right(1);
        }
        let none = 1.0 - ranked.iter().map(|one| one.probability).sum::<f32>();
        let mut others = ranked.split_off(SHORTLIST.min(ranked.len()));
        ranked.iter_mut().for_each(|one| one.paraphrase = self.paraphrase(one));
        let paraphrases: Vec<&str> = ranked.iter().map(|one| one.paraphrase.as_str()).collect();
        let scores = Reranker::builtin().scores(said.wording.utterance, &lines(context), &paraphrases);
        let fits = Fit::of_scores(&scores).into_iter().zip(&ranked);
        let fits = fits.map(|(fit, one)| (one.fit(fit.with_first(one.probability, none)), one.evidence, one.prior));
        let fits: Vec<(Fit, Evidence, f32)> = fits.collect();
        let probabilities = Weights::builtin().fit_probabilities(&fits);
        for ((one, (fit, ..)), probability) in ranked.iter_mut().zip(fits).zip(probabilities) {
            (one.fit, one.probability) = (Some(fit), probability);
        }
        others.iter_mut().for_each(|one| one.probability = 0.0);
        ranked.sort_by(|one, other| other.probability.total_cmp(&one.probability));
        ranked.extend(others);
        ranked
    }

    /// What the grammar makes of it, and the others; but not its parts.
    fn in_one(&self, by_grammar: Alternative, said: &Said<'_>, context: &Context) -> Vec<Alternative> {
        let is_reason = worth(&by_grammar.understanding) > Worth::None;
        let read = said.readings.iter().enumerate();
        let read = read.flat_map(|(at, one)| {
            let ways = std::iter::once(one.clone()).chain(self.with_antecedents(one, said));
            ways.filter_map(move |one| self.of_reading(&one, at == 0, said, context))
        });
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
        let counts = |one: &Alternative| {
            !matches!(one.understanding, Understanding::Stop { .. }) && !does_twice(&one.understanding)
        };
        for mut one in found.into_iter().filter(counts) {
            self.describe(&mut one, said, context);
            let is_known = |other: &&mut Alternative| {
                other.context.later.is_empty() == one.context.later.is_empty()
                    && match (other.begun_search(), one.begun_search()) {
                        (Some(other), Some(one)) => other.comes_to(one),
                        (None, None) => is_same(&other.understanding, &one.understanding),
                        _ => false,
                    }
            };
            match all.iter_mut().find(is_known) {
                Some(known) => {
                    known.evidence.join(&one.evidence);
                    // `repair the bowl` says more than `repair it`.
                    let says_less = |way: &Alternative| way.begun_search().is_some_and(Search::has_pronoun);
                    if says_less(known) && !says_less(&one) {
                        (known.understanding, known.context) = (one.understanding, one.context);
                    }
                }
                None => all.push(one),
            }
        }
        all.iter_mut().for_each(cross);
        let evidence: Vec<(Evidence, f32)> = all.iter().map(|one| (one.evidence, one.prior)).collect();
        let probabilities = Weights::builtin().probabilities(&evidence);
        all.iter_mut().zip(probabilities).for_each(|(one, probability)| one.probability = probability);
        all.sort_by(|one, other| other.probability.total_cmp(&one.probability));
        all
    }

    /// The ways to understand a part of an utterance, the likeliest first.
    pub(crate) fn likely_of_part(&self, part: &str, context: &Context) -> Vec<Alternative> {
        let wording = self.wording(part);
        let by_grammar = self.read(part, context);
        let is_known = worth(&by_grammar.understanding) > Worth::None && self.is_plain(&wording);
        if is_known || self.speaks_for_itself(&wording, &by_grammar) {
            return vec![Alternative { probability: 1.0, ..by_grammar }];
        }
        let said = self.said(&wording, context);
        let found = self.in_one(by_grammar, &said, context);
        self.weighed(found, &said, context)
    }

    /// What may be said of a way without knowing who found it.
    fn describe(&self, one: &mut Alternative, said: &Said<'_>, before: &Context) {
        let unheard = share(self.unheard_about(one, said.wording).len());
        let (understanding, evidence) = (&one.understanding, &mut one.evidence);
        match understanding {
            Understanding::Plan { steps, .. } => {
                evidence.set(Feature::Plan, 1.0);
                evidence.set_if(Feature::PlanAsked, said.is_asked);
                evidence.set_if(Feature::PlanForbidden, said.is_forbidden);
                evidence.set(Feature::PlanUnheard, unheard);
                evidence.set_if(Feature::PlanUnknown, said.has_unknown);
                evidence.set_if(Feature::PlanLasting, steps.iter().any(Step::is_lasting));
                evidence.set_if(Feature::PlanOfMission, self.is_of_mission(&one.context.later));
                one.prior = open_goals::prior(&said.goals, steps, &one.context.request);
                if one.context.search.as_ref().is_some_and(|search| self.seeks_nonsense(search)) {
                    one.prior = NONSENSE;
                }
                evidence.set_if(Feature::PlanRepeats, repeats_deeds(understanding, before));
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
                evidence.set_if(Feature::AnswerIdleAsked, one.context.is_met && said.is_asked);
                evidence.set(Feature::AnswerUnheard, said.unheard);
            }
            Understanding::Refusal { .. } => evidence.set(Feature::Refusal, 1.0),
            Understanding::Stop { .. } => {}
        }
        // What comes later is about more than what is done first.
        let later = &one.context.later;
        evidence.set_if(Feature::Later, !later.is_empty() && !self.is_of_mission(later));
        if !later.is_empty() {
            return;
        }
        let about = self.about(understanding, &one.context);
        let opens = matches!(understanding, Understanding::Plan { steps, .. } if steps.iter().any(opens_or_closes));
        // `close the door` of what it opens.
        let is_door = |class: &ClassId| {
            let class = self.catalog.class(*class);
            class.has(Property::Openable) && !class.has(Property::Receptacle)
        };
        let is_missing = |name: &&Named| match name {
            Named::Thing(classes) if opens && classes.iter().all(is_door) => false,
            name => !about.has(name),
        };
        let is_done = matches!(understanding, Understanding::Plan { .. } | Understanding::Answer { .. });
        // A condition may name what nothing is done with.
        if is_done && !said.is_conditional {
            let missing = said.named.iter().filter(is_missing).count();
            evidence.set(Feature::Missing, share(missing));
            evidence.set_if(Feature::MissingAny, missing > 0);
            let left_out = said.mentions.iter().filter(|mention| is_missing(&&mention.named));
            one.leaves_out = left_out.map(|mention| mention.words.clone()).collect();
        }
        let is_named = |class: &&ClassId| {
            said.named.iter().any(|name| matches!(name, Named::Thing(classes) if classes.contains(class)))
        };
        if !about.classes.is_empty() {
            let named = about.classes.iter().filter(is_named).count();
            let unnamed = 1.0 - named as f32 / about.classes.len() as f32;
            evidence.set(Feature::Unnamed, unnamed);
            evidence.set(Feature::UnnamedUnheard, unnamed * unheard);
            let points = matches!(understanding, Understanding::Answer { highlight, .. } if !highlight.is_empty());
            evidence.set(Feature::AnswerUnnamed, if points { unnamed } else { 0.0 });
        }
    }

    /// Whether all that is to be done later is left of the mission.
    pub(crate) fn is_of_mission(&self, later: &[String]) -> bool {
        let is_goal = |text: &String| self.scene.goals.iter().any(|goal| goal.text == *text);
        !later.is_empty() && later.iter().all(is_goal)
    }

    /// The words that nobody ever met which may say something of this way: not those of what is said beside it.
    pub(crate) fn unheard_about(&self, one: &Alternative, wording: &Wording<'_>) -> Vec<String> {
        if wording.unheard.is_empty() {
            return Vec::new();
        }
        let about = self.about(&one.understanding, &one.context);
        let ends = |word: &String| token::is_punctuation(word) || PARTERS.contains(&word.as_str());
        let part = |part: &[String]| {
            let named = self.names_in(part);
            let is_about = named.iter().any(|(_, name)| about.has(name));
            let stands = |word: &String| self.lexicon.pronouns.exact(std::slice::from_ref(word)).is_some();
            let first = part.iter().find(|word| !matches!(word.as_str(), "and" | "then" | "just" | "now"));
            let is_statement = first.is_some_and(|first| SUBJECTS.contains(&first.as_str()));
            let counts = |word: &String| {
                is_about || Some(word) == first || named.is_empty() && !is_statement && part.iter().any(stands)
            };
            let unheard = part.iter().filter(|word| wording.unheard.contains(*word));
            unheard.filter(|word| counts(word)).cloned().collect::<Vec<_>>()
        };
        wording.words.split(ends).flat_map(part).collect()
    }

    /// What it is about, with what a search looks for, which does nothing yet with that.
    fn about(&self, understanding: &Understanding, context: &Context) -> About {
        let mut about = self.about_now(understanding);
        if context.search.is_some() {
            context.request.iter().for_each(|clause| about.add_clause(clause));
        }
        about
    }

    fn about_now(&self, understanding: &Understanding) -> About {
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

impl About {
    fn has(&self, name: &Named) -> bool {
        match name {
            Named::Thing(classes) => self.classes.iter().any(|class| classes.contains(class)),
            Named::Room(room) => self.rooms.contains(room),
            Named::Color(color) => self.colors.contains(color),
        }
    }

    fn add_clause(&mut self, clause: &Clause) {
        clause.objects.iter().for_each(|phrase| self.add_phrase(phrase));
        self.colors.extend(clause.color.clone());
        for (_, place) in &clause.places {
            match place {
                Place::Room(room) | Place::Viewpoint(room, _) => self.rooms.push(*room),
                Place::Object(phrase) => self.add_phrase(phrase),
                Place::Viewpoints(_) | Place::Side(_) | Place::Here => {}
            }
        }
    }

    fn add_phrase(&mut self, phrase: &Phrase) {
        self.classes.extend(phrase.namings.iter().map(|naming| naming.class));
        self.rooms.extend(phrase.room);
        self.colors.extend(phrase.color.clone());
        phrase.relations.iter().for_each(|relation| self.add_phrase(&relation.to));
    }
}

impl Alternative {
    pub(crate) const fn new(understanding: Understanding, context: Context, evidence: Evidence) -> Self {
        Self {
            understanding,
            probability: 0.0,
            evidence,
            prior: 0.0,
            paraphrase: String::new(),
            fit: None,
            leaves_out: Vec::new(),
            context,
        }
    }

    /// The search that it begins, if it does.
    const fn begun_search(&self) -> Option<&Search> {
        match self.understanding {
            Understanding::Plan { .. } => self.context.search.as_ref(),
            _ => None,
        }
    }

    /// Whether the grammar reads it to the last word.
    pub(crate) fn is_plain(&self) -> bool {
        self.evidence.get(Feature::GrammarPlain) > 0.0
    }

    /// What the re-ranker says of it, by what it is.
    fn fit(&self, mut fit: Fit) -> Fit {
        let feature = match &self.understanding {
            Understanding::Question { .. } => FitFeature::ScoreOfQuestion,
            Understanding::Answer { .. } => FitFeature::ScoreOfAnswer,
            Understanding::Refusal { .. } => FitFeature::ScoreOfRefusal,
            _ => return fit,
        };
        fit.set(feature, fit.get(FitFeature::Score));
        fit
    }

    /// How sure who found it is of it.
    pub(crate) fn sureness(&self) -> f32 {
        [Feature::Parser, Feature::Likeness, Feature::GrammarQuestion]
            .iter()
            .fold(0.0, |most, feature| self.evidence.get(*feature).max(most))
    }
}

/// What was said before.
pub(crate) fn lines(context: &Context) -> Vec<cohabit_parser::Said<'_>> {
    context.lines.iter().map(|(by_robot, text)| cohabit_parser::Said { by_robot: *by_robot, text }).collect()
}

/// How much less likely it is that somebody names a thing by words that name nothing, nats.
const NONSENSE: f32 = -2.0;

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

const fn opens_or_closes(step: &Step) -> bool {
    matches!(step.action, Action::Interact { verb: Verb::Open | Verb::Close, .. })
}

/// Whether two ways come to the same.
pub(crate) fn is_same(one: &Understanding, other: &Understanding) -> bool {
    match (one, other) {
        (Understanding::Plan { steps: one, .. }, Understanding::Plan { steps: other, .. }) => {
            deeds(one).eq(deeds(other))
        }
        (Understanding::Answer { text: one, highlight, .. }, Understanding::Answer { text, highlight: other, .. }) => {
            highlight == other && without_yes_or_no(one) == without_yes_or_no(text)
        }
        (one, other) => one == other,
    }
}

/// What these steps come to: who goes to a thing and then takes it, takes it.
fn deeds(steps: &[Step]) -> impl Iterator<Item = &Action> {
    let is_on_the_way = |at: usize| match steps[at].action {
        Action::GoTo { target: GoToTarget::Object(object) } => {
            steps[at + 1..].iter().any(|step| step.object() == Some(object))
        }
        _ => false,
    };
    (0..steps.len()).filter(move |at| !is_on_the_way(*at)).map(|at| &steps[at].action)
}

/// Whether it does several things and then the same again, such as putting a thing into a machine and taking it out.
fn does_twice(understanding: &Understanding) -> bool {
    let Understanding::Plan { steps, .. } = understanding else { return false };
    let actions: Vec<&Action> = deeds(steps).collect();
    let takes = |actions: &[&Action]| actions.iter().any(|action| matches!(action, Action::PickUp { .. }));
    (2..=actions.len() / 2).any(|length| {
        actions.windows(2 * length).any(|window| {
            let (first, second) = window.split_at(length);
            first == second && takes(first)
        })
    })
}

/// Whether it is what was done just before.
fn repeats_deeds(understanding: &Understanding, before: &Context) -> bool {
    matches!(understanding, Understanding::Plan { steps, .. } if deeds(steps).eq(deeds(&before.last_plan)))
}

/// Whether it asks what the robot asked last.
fn repeats(understanding: &Understanding, context: &Context) -> bool {
    let asked = context.lines.iter().rev().find(|(by_robot, _)| *by_robot);
    matches!(understanding, Understanding::Question { text, .. } if asked.is_some_and(|(_, last)| last == text))
}

pub(crate) fn without_yes_or_no(text: &str) -> String {
    let rest = text.strip_prefix("Yes, ").or_else(|| text.strip_prefix("No, "));
    rest.map_or_else(|| text.to_owned(), describe::sentence)
}
