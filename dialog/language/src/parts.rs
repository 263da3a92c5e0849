//! The parts of an utterance: what they mean one after the other, each in the scene and the conversation that those before it lead to.

use crate::{
    alternatives::Alternative,
    clause,
    context::Context,
    conversation::Conversation,
    evidence::{Evidence, Feature},
    imagine,
    known::Known,
    reply,
    said::Said,
    token,
    understanding::{Step, Understanding},
    wording::Wording,
};

/// Into how many parts an utterance is taken apart at most.
const MOST_PARTS: usize = 6;
/// How many ways to take a part are followed, and how many ways to take all parts so far.
const MOST_OF_PART: usize = 2;
const MOST_SEQUENCES: usize = 2;
/// How likely a part asks for nothing, at least.
const LEAST_SKIPPED: f32 = 0.02;
/// How likely the parser must take what is left for later for a request.
const LEAST_WANTED: f32 = 0.2;
/// How likely the rest is meant where nothing is made of a sentence.
const IF_LOST: f32 = 0.7;

/// The parts of an utterance so far, one after the other.
#[derive(Clone)]
struct Sequence {
    /// What they come to together, and how likely they are meant so.
    steps: Vec<Step>,
    probability: f32,
    /// The scene and the conversation after them.
    scene: Known,
    context: Context,
    /// What is done or asked first, before all that is left, where that is no plain plan.
    begun: Option<Understanding>,
    /// Whether all that is left is to be done later.
    is_complete: bool,
}

impl Sequence {
    const fn new(scene: Known, context: Context) -> Self {
        Self { steps: Vec::new(), probability: 1.0, scene, context, begun: None, is_complete: false }
    }

    /// Leaves these texts for later, after what was there to do later.
    fn complete(&mut self, mut context: Context, later: Vec<String>) {
        context.later.extend(later);
        (self.context, self.is_complete) = (context, true);
    }

    /// All of it as one way to understand the utterance; nothing, where nothing is to be done.
    fn alternative(self, said: &Said<'_>) -> Option<Alternative> {
        let mut evidence = Evidence::default();
        evidence.set(Feature::Parts, self.probability);
        evidence.set(Feature::NotInstead, said.instead);
        let (understanding, context) = self.understanding()?;
        Some(Alternative::new(understanding, context, evidence))
    }

    fn understanding(self) -> Option<(Understanding, Context)> {
        let Self { steps, mut context, begun, is_complete, .. } = self;
        let understanding = match begun {
            Some(understanding) => understanding,
            None if steps.is_empty() => return None,
            None => {
                let mut reply = reply::plan_reply(&steps, &[]);
                if is_complete {
                    reply.push_str(&format!(" Then: \"{}\".", context.later.join("; ")));
                } else {
                    context.begin(&steps);
                }
                Understanding::Plan { steps, reply }
            }
        };
        Some((understanding, context))
    }
}

impl Conversation<'_> {
    /// What its parts mean one after the other: parts that begin with a verb, or all that stands between commas.
    pub(crate) fn in_parts(&self, said: &Said<'_>, context: &Context) -> Vec<Alternative> {
        if said.is_conditional {
            return Vec::new();
        }
        let words = &said.wording.words;
        let by_verbs = clause::segments(self.lexicon, words);
        let by_breaks = clause::between_breaks(words);
        let ways = if by_breaks.len() == by_verbs.len() { vec![by_verbs] } else { vec![by_verbs, by_breaks] };
        // Who forbids something may well forbid what comes after it too.
        let forbids = |part: &[String]| clause::forbid(&clause::parts(self.lexicon, self.catalog, part));
        let is_fit = |parts: &Vec<&[String]>| {
            (2..=MOST_PARTS).contains(&parts.len())
                && !(said.is_forbidden && parts[..parts.len() - 1].iter().any(|part| forbids(part)))
        };
        ways.into_iter().filter(is_fit).flat_map(|parts| self.one_after_the_other(&parts, said, context)).collect()
    }

    /// The likeliest ways to take its parts one after the other.
    fn one_after_the_other(&self, parts: &[&[String]], said: &Said<'_>, context: &Context) -> Vec<Alternative> {
        let parts: Vec<String> = parts.iter().map(|part| part.join(" ")).collect();
        let mut sequences = vec![Sequence::new(self.scene.clone(), context.at_new_utterance())];
        for (at, part) in parts.iter().enumerate() {
            let next = sequences.into_iter().flat_map(|sequence| self.continued(sequence, part, &parts[at + 1..]));
            sequences = next.collect();
            sequences.sort_by(|one, other| other.probability.total_cmp(&one.probability));
            sequences.truncate(MOST_SEQUENCES);
        }
        sequences.into_iter().filter_map(|sequence| sequence.alternative(said)).collect()
    }

    /// The utterance without parts that name nothing, or are no requests, of whose words some are in no vocabulary, such as
    /// `no need to be stingy`; and those of these words that something may be asked in. Nothing, where there are none.
    pub(crate) fn without_asides(&self, wording: &Wording<'_>, context: &Context) -> Option<(String, Vec<String>)> {
        if wording.unheard.is_empty() {
            return None;
        }
        let parts: Vec<&[String]> = wording.words.split_inclusive(|word| token::is_punctuation(word)).collect();
        let asks = |part: &[String]| self.parser_sees_request(&token::sentence(part), context);
        let stands_for_thing = |word: &String| self.lexicon.pronouns.exact(std::slice::from_ref(word)).is_some();
        let is_empty = |part: &[String]| self.names_in(part).is_empty() && !part.iter().any(stands_for_thing);
        let is_unheard = |word: &&String| wording.unheard.contains(word);
        let is_aside = |part: &&[String]| part.iter().any(|word| is_unheard(&word)) && (is_empty(part) || !asks(part));
        let (asides, left): (Vec<&[String]>, Vec<&[String]>) = parts.into_iter().partition(is_aside);
        let asked = asides.iter().filter(|part| asks(part)).flat_map(|part| part.iter().filter(is_unheard));
        (!asides.is_empty() && left.iter().any(|part| asks(part)))
            .then(|| (left.concat().join(" "), asked.cloned().collect()))
    }

    /// What comes first of what is asked for, where only what comes after it is not understood: that is left for later.
    pub(crate) fn first_of(&self, wording: &Wording<'_>, context: &mut Context) -> Option<(Understanding, f32)> {
        let parts = clause::segments(self.lexicon, &wording.words);
        let is_clear = |part: &&[String]| !part.iter().any(|word| wording.unheard.contains(word));
        let clear = parts.iter().take_while(|part| is_clear(part)).count();
        if clear == 0 || clear == parts.len() {
            return None;
        }
        let mut then = context.clone();
        let (understanding, sureness) = self.understand_weighed(&parts[..clear].concat().join(" "), &mut then);
        matches!(understanding, Understanding::Plan { .. }).then(|| {
            then.later.push(token::sentence(&parts[clear..].concat()));
            *context = then;
            (understanding, sureness)
        })
    }

    /// The conversation in the scene that a sequence leads to.
    fn after<'s>(&'s self, sequence: &'s Sequence) -> Conversation<'s> {
        Conversation { scene: &sequence.scene, ..*self }
    }

    /// A sequence with what the next part likely means, or without it; `rest` follows that part.
    fn continued(&self, sequence: Sequence, part: &str, rest: &[String]) -> Vec<Sequence> {
        // `not on the desk` says what is not meant by what was said before.
        let first = part.split(' ').next().map(str::to_owned);
        if sequence.is_complete || self.lexicon.denials.exact(first.as_slice()).is_some() {
            return vec![sequence];
        }
        let likely = self.after(&sequence).likely_of_part(part, &sequence.context);
        let skipped = 1.0 - likely.iter().map(|one| one.probability).sum::<f32>();
        let taken = likely.into_iter().take(MOST_OF_PART).filter_map(|way| self.with(&sequence, way, part, rest));
        let mut next: Vec<Sequence> = taken.collect();
        // Not all that is said asks for something.
        next.push(Sequence { probability: sequence.probability * skipped.max(LEAST_SKIPPED), ..sequence });
        next
    }

    /// A sequence with one way to take the next part: something to do, nothing, or what can only be said once the steps so far are done,
    /// as all that follows it. Nothing, where that cannot be done.
    fn with(&self, sequence: &Sequence, way: Alternative, part: &str, rest: &[String]) -> Option<Sequence> {
        let Alternative { understanding, probability, context, .. } = way;
        let mut longer = Sequence { probability: sequence.probability * probability, ..sequence.clone() };
        // A remark is not left for later.
        let wants = |part: &&String| {
            self.likely_request(part, &context) >= LEAST_WANTED || self.is_question(&self.wording(part))
        };
        let rest: Vec<String> = rest.iter().filter(wants).cloned().collect();
        let waits = context.search.is_some() || !context.later.is_empty();
        match understanding {
            Understanding::Plan { steps, .. } if !waits => {
                steps.iter().for_each(|step| imagine::apply(&mut longer.scene, &step.action, self.devices));
                longer.context = context;
                longer.steps.extend(steps);
            }
            Understanding::Answer { .. } if context.is_met || !self.is_question(&self.wording(part)) => {}
            Understanding::Plan { .. } | Understanding::Question { .. } if longer.steps.is_empty() => {
                longer.complete(context, rest);
                longer.begun = Some(understanding);
            }
            Understanding::Plan { .. } | Understanding::Question { .. } | Understanding::Answer { .. } => {
                let mut then = longer.context.clone();
                then.begin(&longer.steps);
                longer.complete(then, [vec![part.to_owned()], rest].concat());
            }
            Understanding::Refusal { .. } | Understanding::Stop { .. } => return None,
        }
        Some(longer)
    }

    /// What the sentences of an utterance mean, each by itself, with what is said of those that nothing is made of, as likely as all of
    /// them are meant so; nothing, where nothing is made of any.
    pub(crate) fn by_sentences(&self, wording: &Wording<'_>, context: &Context) -> Option<Alternative> {
        let ended = wording.words.split_inclusive(|word| token::ends_sentence(word));
        let sentences: Vec<String> = ended
            .filter(|words| words.iter().any(|word| !token::is_punctuation(word)))
            .map(|words| words.join(" "))
            .collect();
        if !(2..=MOST_PARTS).contains(&sentences.len()) {
            return None;
        }
        let mut sequence = Sequence::new(self.scene.clone(), context.at_new_utterance());
        let (mut answers, mut lost) = (Vec::new(), Vec::new());
        let mut probability = 1.0;
        for (at, sentence) in sentences.iter().enumerate() {
            let there = self.after(&sequence);
            let mut then = sequence.context.clone();
            let (understanding, sureness) = there.understand_weighed(sentence, &mut then);
            probability *= if matches!(understanding, Understanding::Refusal { .. }) { IF_LOST } else { sureness };
            if probability == 0.0 {
                return None;
            }
            let is_question = || there.is_question(&there.wording(sentence));
            match &understanding {
                Understanding::Answer { text, .. } if sequence.steps.is_empty() && is_question() => {
                    answers.push(text.clone());
                }
                // A remark is none that it fails to carry out.
                Understanding::Refusal { .. } if !there.parser_sees_request(sentence, &sequence.context) => {}
                Understanding::Refusal { .. } => {
                    lost.push(sentence.trim_end_matches(|end: char| !end.is_alphanumeric()));
                }
                _ => {
                    let way = Alternative::new(understanding, then, Evidence::default());
                    sequence = self.with(&sequence, way, sentence, &sentences[at + 1..]).unwrap_or(sequence);
                }
            }
            if sequence.is_complete {
                break;
            }
        }
        let (understanding, context) = sequence.understanding()?;
        let lost = lost.iter().map(|lost| format!("I do not know what to do about \"{lost}\"."));
        let said: Vec<String> = answers.into_iter().chain(lost).collect();
        let understanding = if said.is_empty() { understanding } else { understanding.after(&said.join(" ")) };
        Some(Alternative { probability, ..Alternative::new(understanding, context, Evidence::default()) })
    }
}
