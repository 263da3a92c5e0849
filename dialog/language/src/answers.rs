//! What the robot's own question may be answered with: yes, no, each of what it asked about. Each is a way to understand whatever is said
//! then, and is weighed with all others.

use crate::{
    alternatives::Alternative,
    asked::Open,
    context::{Consent, Context, Pending},
    conversation::Conversation,
    evidence::{Evidence, Feature, shares},
    lexicon::Small,
    likeness::{Likeness, SHARPNESS},
    reply,
    said::Said,
    token,
    understanding::Understanding,
};

/// How many of those that it asked about may be the one that is meant.
const MOST_CANDIDATES: usize = 6;

/// What sounds in words like an answer.
struct Tone {
    agrees: bool,
    denies: bool,
}

impl Conversation<'_> {
    /// Each answer to the robot's own question, whatever the words.
    pub(crate) fn of_question(&self, said: &Said<'_>, context: &Context) -> Vec<Alternative> {
        let Some(pending) = &context.pending else { return Vec::new() };
        let tone = self.tone(&said.wording.words);
        let takes = self.taken(pending, said, context);
        let is_only = takes.len() == 1;
        let takes = takes.into_iter().map(|(like, understanding, then)| {
            let mut evidence = Evidence::default();
            evidence.set(Feature::Reply, 1.0);
            evidence.set_if(Feature::ReplyOnly, is_only);
            evidence.set(Feature::ReplyLike, if is_only { 0.0 } else { like });
            evidence.set_if(Feature::ReplyAgrees, tone.agrees);
            evidence.set_if(Feature::ReplyDenies, tone.denies);
            evidence.set_if(Feature::ReplyNames, !said.named.is_empty());
            evidence.set(Feature::ReplyLong, said.length);
            evidence.set(Feature::ReplyAsks, said.requests.min(1.0));
            Alternative::new(understanding, then, evidence)
        });
        takes.chain([self.left(&tone, context)]).collect()
    }

    /// What comes of each thing that may be agreed to, and how much the words are like it.
    fn taken(&self, pending: &Pending, said: &Said<'_>, context: &Context) -> Vec<(f32, Understanding, Context)> {
        let mut found = Vec::new();
        let before = Context { pending: None, ..context.at_new_utterance() };
        let mut take = |like: f32, what: &dyn Fn(&mut Context) -> Understanding| {
            let mut then = before.clone();
            let understanding = what(&mut then);
            let understanding = then.keep(before.later.clone(), understanding);
            found.push((like, understanding, then));
        };
        match pending {
            Pending::Offer { plans } => {
                let names: Vec<String> = plans.iter().map(|steps| reply::plan_in_words(steps)).collect();
                for (steps, like) in plans.iter().zip(likenesses(said, &names)) {
                    take(like, &|then| self.go(steps.clone(), then));
                }
            }
            Pending::Guess { guesses } => {
                let names: Vec<String> = guesses.iter().map(|guess| guess.name.clone()).collect();
                for (guess, like) in guesses.iter().zip(likenesses(said, &names)) {
                    take(like, &|then| self.go_as_guessed(guess.clone(), then));
                }
            }
            Pending::Which { clauses, slot, candidates, consent } => {
                if self.lexicon.all.occurs_in(&said.wording.words) {
                    let open = || Open { clauses: clauses.clone(), slot: *slot, consent: *consent };
                    take(1.0, &|then| self.settle_all(open(), candidates, then));
                }
                let mut likely = self.likely_candidates(said.wording.utterance, candidates);
                likely.sort_by(|(_, one), (_, other)| other.total_cmp(one));
                for (object, like) in likely.into_iter().take(MOST_CANDIDATES) {
                    take(like, &|then| {
                        then.pending = Some(pending.clone());
                        self.chosen(object, then)
                    });
                }
            }
            Pending::PutDown { clauses } => {
                let consent = Consent { may_put_down: true, is_agreed: true };
                take(1.0, &|then| self.plan(clauses.clone(), consent, then));
            }
            Pending::Search { clauses } => take(1.0, &|then| self.plan(clauses.clone(), Consent::default(), then)),
            Pending::Where { clauses, slot, consent } => {
                take(1.0, &|then| self.look_for(clauses.clone(), *slot, *consent, then));
            }
            // These have no answer that may be guessed.
            Pending::Look { .. } | Pending::Direction { .. } | Pending::Lab { .. } => {}
        }
        found.retain(|(_, understanding, _)| matches!(understanding, Understanding::Plan { .. }));
        found
    }

    /// That none of it is to be done.
    fn left(&self, tone: &Tone, context: &Context) -> Alternative {
        let mut evidence = Evidence::default();
        evidence.set(Feature::ReplyLeaves, 1.0);
        evidence.set_if(Feature::ReplyLeavesDenied, tone.denies);
        let then = Context { pending: None, ..context.at_new_utterance() };
        Alternative::new(Understanding::answer(LEAVES), then, evidence)
    }

    /// Whether any part of it is a yes or a no by itself, or any word of it.
    fn tone(&self, words: &[String]) -> Tone {
        let parts = || words.split(|word| token::is_punctuation(word)).filter(|part| !part.is_empty());
        let has = |kinds: &[Small]| {
            let is = |part: &[String]| self.small(part).iter().any(|small| kinds.contains(small));
            parts().any(is) || words.iter().any(|word| is(std::slice::from_ref(word)))
        };
        let denies = || self.lexicon.negation.occurs_in(words) || self.lexicon.denials.occurs_in(words);
        Tone { agrees: has(&[Small::Yes]), denies: has(&[Small::No, Small::Neither]) || denies() }
    }
}

/// What it says when it leaves something.
pub(crate) const LEAVES: &str = "All right, I leave it.";

/// How much the words are like each of these names, as shares of 1.
fn likenesses(said: &Said<'_>, names: &[String]) -> Vec<f32> {
    let likeness = Likeness::builtin();
    let of_said = likeness.of(said.wording.utterance);
    let utilities = names.iter().map(|name| of_said.likeness(&likeness.of(name)) / SHARPNESS);
    shares(&utilities.collect::<Vec<_>>(), f32::NEG_INFINITY)
}
