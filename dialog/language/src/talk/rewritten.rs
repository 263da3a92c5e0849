//! What a rewriter makes of an utterance: plain requests, which the grammar understands.

use std::sync::LazyLock;

use crate::{
    answer::claim::asked_state,
    context::Context,
    known::surroundings,
    read::{chatter, clause::Part, parts, segments},
    say::reply,
    talk::{
        cache::Cache,
        conversation::Conversation,
        evidence::{self, Edit, Evidence, Hypothesis, NBest},
        faithful::{TALK, is_talk},
        source::Source,
        way::Way,
        wording::Wording,
    },
    understanding::{Clarification, Understanding},
    words::{intent::Intent, lexicon::StateWord, token},
};

/// How likely ways are at most where the grammar does not read the likeliest: enough to be proposed.
const DOUBTFUL: f32 = 0.4;
/// What a rewriter writes of what nobody could tell the meaning of.
const CANNOT_TELL: &str = "?";
/// How likely it is at least that something is asked for beside a stop.
const LIKELY: f32 = 0.3;
/// What is said to talk of no known kind.
const SEEN: &str = "I see. I am here when you need me.";
const AGREED: &str = "OK.";
/// What is said to who wants nothing done for now.
pub(crate) const WAITS: &str = "OK, I wait. Tell me when to go on.";

impl Conversation<'_> {
    /// What the rewriter takes an utterance for, the likeliest first; nothing, where the likeliest names something that nobody
    /// knows: others are mere guesses then. What the grammar takes it for is likelier.
    pub(crate) fn rewritten(&self, wording: &Wording<'_>, context: &Context, by_grammar: Option<&Way>) -> Vec<Way> {
        let (n_best, evidence) = match self.n_best(wording, context, by_grammar) {
            Ok(n_best) => n_best,
            Err(asked) => return asked.map(|way| *way).into_iter().collect(),
        };
        self.weighed(n_best, &evidence, wording, context).into_iter().map(|(_, way)| way).collect()
    }

    /// The ways of an n-best list, each behind the requests that were written for it, with how likely it is meant; the likeliest first.
    pub(crate) fn weighed(
        &self,
        n_best: NBest,
        evidence: &[Evidence],
        wording: &Wording<'_>,
        context: &Context,
    ) -> Vec<(String, Way)> {
        let prior = self.prior(&n_best.hypotheses, wording, context);
        let utilities: Vec<f32> = evidence.iter().zip(prior).map(|(one, prior)| one.utility() + prior.ln()).collect();
        let most = if n_best.is_first_unread { DOUBTFUL } else { 1.0 };
        let weighed = |(one, share): (Hypothesis, f32)| (one.text, Way { probability: share.min(most), ..one.way });
        let mut ways: Vec<(String, Way)> =
            n_best.hypotheses.into_iter().zip(evidence::probabilities(&utilities)).map(weighed).collect();
        ways.sort_by(|(_, one), (_, other)| other.probability.total_cmp(&one.probability));
        ways
    }

    /// All that the rewriter writes of an utterance, with what speaks for each way to take it; or what the robot asks, where the likeliest names
    /// something that nobody knows.
    pub(crate) fn n_best(
        &self,
        wording: &Wording<'_>,
        context: &Context,
        by_grammar: Option<&Way>,
    ) -> Result<(NBest, Vec<Evidence>), Option<Box<Way>>> {
        let around = self.around();
        let source = Source::new(self.lexicon, &wording.words, context.lines(), &around);
        let rewritings = self.with_question(wording.utterance, context, &around);
        let all = rewritings.iter().map(|(_, probability)| probability).sum::<f32>().max(f32::MIN_POSITIVE);
        let mut n_best = NBest { hypotheses: Vec::new(), all, is_first_unread: false };
        for (at, (text, probability)) in rewritings.iter().enumerate() {
            let text = self.with_back(&self.with_both_things(text, &source), wording, &source, context);
            let text = self.with_counts(&text, wording);
            for (nth, (edit, text)) in self.edited(&text, &source).into_iter().enumerate() {
                let is_likeliest = at == 0 && nth == 0;
                let Some(way) = self.of_rewriting(&text, *probability, wording, context) else {
                    if is_likeliest && self.names_unknown(&text) {
                        return Err(self.asked_about(&text, *probability, context).map(Box::new));
                    }
                    n_best.is_first_unread |= is_likeliest;
                    continue;
                };
                match n_best
                    .hypotheses
                    .iter_mut()
                    .find(|other| other.way.is_same(&way) || self.comes_to(other, &way, &text))
                {
                    Some(other) if nth == 0 => other.probability += probability,
                    Some(_) => {}
                    None => {
                        let is_unfaithful = self.is_unfaithful(&text, &source);
                        let outcome = self.becomes(&way);
                        let unnamed = self.unnamed(&text, &source);
                        let unspoken = self.unspoken(&text, &source);
                        n_best.hypotheses.push(Hypothesis {
                            way,
                            text,
                            probability: *probability,
                            edit,
                            outcome,
                            is_unfaithful,
                            unnamed,
                            unspoken,
                        });
                    }
                }
            }
        }
        n_best.hypotheses.sort_by(|one, other| other.probability.total_cmp(&one.probability));
        let evidence = self.evidence(&n_best, &source, by_grammar);
        Ok((n_best, evidence))
    }

    /// Whether a way by this text is to do the same as another one, where not all of it is planned yet.
    fn comes_to(&self, other: &Hypothesis, way: &Way, text: &str) -> bool {
        let is_open = |way: &Way| way.context.search.is_some() || !way.context.later.is_empty();
        let are_plans = other.way.steps().is_some() && way.steps().is_some();
        are_plans && (is_open(&other.way) || is_open(way)) && self.asks_the_same(&other.text, text)
    }

    /// What the rewriter wrote, without what it cannot know, and what else may be meant by that.
    fn edited(&self, text: &str, source: &Source) -> Vec<(Edit, String)> {
        let text = self.with_either(&self.with_rooms_there(text, source), source);
        let text = self.without_invented_denial(&text, source);
        let known = |text: &str| self.with_this_room(&self.without_invention(text, source), source);
        let renamed = self.with_things_meant(&self.with_things_said(&text, source), source);
        let first = (if renamed == text { Edit::Kept } else { Edit::Renamed }, known(&renamed));
        let swapped = self.with_thing_swapped(&text, source).map(|text| (Edit::Swapped, known(&text)));
        let without_means = (Edit::WithoutMeans, self.without_means(&first.1, source));
        let others = swapped.into_iter().chain([without_means]).filter(|(_, text)| *text != first.1);
        std::iter::once(first.clone()).chain(others).collect()
    }

    /// What the rewriter makes of an utterance; where that is talk alone, and a question stands in it, what it makes of the question.
    fn with_question(&self, utterance: &str, context: &Context, around: &str) -> Vec<(String, f32)> {
        let all = self.rewritings(utterance, context, around);
        let is_talk_alone = |all: &[(String, f32)]| all.first().is_some_and(|(text, _)| asks_nothing(text));
        let Some(question) = is_talk_alone(&all).then(|| question_among(utterance)).flatten() else { return all };
        let asked = self.rewritings(&question, context, around);
        if is_talk_alone(&asked) { all } else { asked }
    }

    /// Whether it is rather a request or a question than anything else.
    pub(crate) fn is_rewritten_as_request(&self, utterance: &str, context: &Context) -> bool {
        let all = self.rewritings(utterance, context, &self.around());
        let asks = |text: &str| !asks_nothing(text) && !matches!(asking(text).as_str(), CANNOT_TELL | "stop" | "wait");
        let asked: f32 = all.iter().filter(|(text, _)| asks(text)).map(|(_, probability)| probability).sum();
        let rest: f32 = all.iter().filter(|(text, _)| !asks(text)).map(|(_, probability)| probability).sum();
        asked > rest.max(LIKELY)
    }

    /// Whether plain requests name something that nobody knows; of the verb they begin with another one may be meant.
    fn names_unknown(&self, text: &str) -> bool {
        let parts = parts::parts(self.lexicon, self.catalog, &self.wording(text).tidied);
        let is_unclear = |part: &Part| matches!(part, Part::Clause(clause) if !chatter::is_clear(clause));
        let is_unheard = |(_, named): (&str, &str)| !self.wording(named).unheard.is_empty();
        parts.iter().any(is_unclear) || text.split("; ").filter_map(|request| request.split_once(' ')).any(is_unheard)
    }

    /// What the robot asks about plain requests that it does not know all words of, such as what a thing looks like.
    fn asked_about(&self, text: &str, probability: f32, context: &Context) -> Option<Way> {
        let mut then = context.at_new_utterance();
        let understanding = self.understand_said(&text.replace("; ", ". "), &mut then);
        let asks = matches!(understanding, Understanding::Question { kind: Clarification::Appearance, .. });
        asks.then(|| Way { understanding, probability: probability.sqrt(), context: then })
    }

    fn of_rewriting(&self, text: &str, probability: f32, wording: &Wording<'_>, context: &Context) -> Option<Way> {
        let mut then = context.at_new_utterance();
        let in_order = self.with_first_first(text, wording);
        let understanding = match asking(&in_order).as_str() {
            CANNOT_TELL => return None,
            "none" => Understanding::answer(AGREED),
            talk if is_talk(talk) => self.reply_to_talk(talk, wording),
            "stop" => self.stopped("", &mut then),
            "wait" => {
                self.stopped("", &mut then);
                Understanding::Stop { reply: WAITS.to_owned(), then: None }
            }
            requests if token::words(requests) == token::words(wording.utterance) => {
                self.understand_said(wording.utterance, &mut then)
            }
            requests if let Some(named) = said_twice(requests) => {
                self.requested(&format!("where is {named}?"), &mut then)?.without_yes().after("Yes.")
            }
            requests => {
                if let Some(rest) = requests.strip_prefix("stop; ") {
                    let stopped = self.stopped("", &mut then);
                    let rest = self.requested(rest, &mut then)?;
                    Understanding::Stop { reply: stopped.reply().to_owned(), then: Some(Box::new(rest)) }
                } else {
                    self.requested(requests, &mut then)?
                }
            }
        };
        // `is it in one piece?`, told as whether it is broken: what is so is said, and no yes or no to another question.
        let understanding =
            if self.asks_other_state(text, wording) { understanding.without_yes() } else { understanding };
        then.reason = then.reason.replacen(reply::ASKED_TO, reply::UNDERSTOOD_TO, 1);
        Some(Way { understanding, probability, context: then })
    }

    /// Plain requests, of which the one that was said to be done first stands before the others.
    fn with_first_first(&self, requests: &str, wording: &Wording<'_>) -> String {
        let words = &wording.tidied;
        let cuts = segments::cuts(self.lexicon, words);
        let Some(first) = segments::done_first(self.lexicon, words, &cuts) else { return requests.to_owned() };
        let said = self.asked_for(&words[cuts[first.start].start..cuts[first.end - 1].end]);
        let mut all: Vec<&str> = requests.split("; ").collect();
        let is_said = |request: &str| {
            let asked = self.asked_for(&self.wording(request).tidied);
            asked.iter().any(|intent| said.contains(intent))
        };
        let found: Vec<usize> = (0..all.len()).filter(|at| is_said(all[*at])).collect();
        if let [at] = found[..] {
            let request = all.remove(at);
            let after_stop = all.first().is_some_and(|request| *request == "stop");
            all.insert(usize::from(after_stop), request);
        }
        all.join("; ")
    }

    /// What these words ask for, as the grammar reads them.
    fn asked_for(&self, words: &[String]) -> Vec<Intent> {
        let parts = parts::parts(self.lexicon, self.catalog, words);
        let intent = |part: &Part| if let Part::Clause(clause) = part { Some(clause.intent) } else { None };
        parts.iter().filter_map(intent).collect()
    }

    /// Whether plain words ask for a state by a word whose meaning was not said.
    fn asks_other_state(&self, text: &str, wording: &Wording<'_>) -> bool {
        let (asked, _) = self.lexicon.normalise(text);
        let is_one = text.ends_with('?') && !text.contains(';');
        let Some((state, words)) = asked_state(self.lexicon, &asked).filter(|_| is_one) else { return false };
        if words.iter().all(|word| wording.words.contains(word)) {
            return false;
        }
        let is_said = |at: usize| {
            let (_, said) = self.lexicon.states.longest(&wording.words[at..])?;
            (*said == state).then_some(())
        };
        matches!(state, StateWord::Flag(..)) && (0..wording.words.len()).find_map(is_said).is_none()
    }

    /// What is said to who asks for nothing: thanks, praise and such have a reply.
    fn reply_to_talk(&self, talk: &str, wording: &Wording<'_>) -> Understanding {
        let chat = segments::segments(self.lexicon, &wording.words).into_iter().find_map(|part| self.chat(part));
        let of_kind = || {
            let kind = self.lexicon.talk_replies.get(talk.strip_prefix(TALK)?.strip_prefix(": ")?)?;
            let asked = kind.asked.as_ref().filter(|_| wording.utterance.trim_end().ends_with('?'));
            Some(asked.unwrap_or(&kind.reply).as_str())
        };
        Understanding::answer(chat.or_else(of_kind).unwrap_or(SEEN))
    }

    /// What is around the robot, for a rewriter.
    fn around(&self) -> String {
        let has_rewriter = self.rewriter.is_some();
        if has_rewriter { surroundings::surroundings(self.catalog, self.scene) } else { String::new() }
    }

    fn rewritings(&self, utterance: &str, context: &Context, around: &str) -> Vec<(String, f32)> {
        // The same words are often heard again: as an answer that a question offers, or when a setting is tried.
        static WRITTEN: LazyLock<Cache<Vec<(String, f32)>>> = LazyLock::new(Cache::default);
        let Some(rewrite) = self.rewriter else { return Vec::new() };
        let lines = context.lines();
        let all = format!("{around}\n{}", transcript(utterance, lines));
        WRITTEN.get_or_insert_with(&all, || rewrite(utterance, lines, around))
    }
}

/// What `is the time machine the time machine?` names: what was described is taken for what was named.
fn said_twice(request: &str) -> Option<&str> {
    let both = request.strip_prefix("is ")?.strip_suffix('?')?;
    let (one, other) = both.split_at_checked(both.len() / 2)?;
    let (one, other) = (one.trim(), other.trim());
    (one == other && !one.is_empty()).then_some(one)
}

/// Plain requests without talk beside them.
fn asking(text: &str) -> String {
    let asks = |request: &&str| *request != "none" && !is_talk(request);
    let requests: Vec<&str> = text.split("; ").filter(asks).collect();
    if requests.is_empty() { text.to_owned() } else { requests.join("; ") }
}

/// Whether a rewriting is talk alone, or nothing to a robot.
fn asks_nothing(text: &str) -> bool {
    text.split("; ").all(|request| request == "none" || is_talk(request))
}

/// The sentences of an utterance that ask, where others do not.
fn question_among(utterance: &str) -> Option<String> {
    let sentences = || utterance.split_inclusive(['.', '!', '?', '\n']).map(str::trim).filter(|one| one.len() > 1);
    let asked: Vec<&str> = sentences().filter(|one| one.ends_with('?')).collect();
    (!asked.is_empty() && asked.len() < sentences().count()).then(|| asked.join(" "))
}

/// An utterance behind the lines before it, as text.
fn transcript(utterance: &str, lines: &[(bool, String)]) -> String {
    let before = lines.iter().map(|(by_robot, text)| format!("{}{text}\n", if *by_robot { '<' } else { '>' }));
    before.chain([utterance.to_owned()]).collect()
}
