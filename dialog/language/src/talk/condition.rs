//! Requests with a condition: "if the fridge is open, close it", "turn it off if it is on", "unless it is broken, take it".
//!
//! What does not hold is not carried out, and said so; where the condition cannot be told, the robot asks.

use cohabit_cdf::Property;

use crate::{
    answer::claim,
    context::{Context, Pending},
    read::{
        chatter,
        clause::{Clause, Part},
        parts,
        phrase::Phrase,
        question::{self, Question},
        slot,
    },
    say::ask,
    talk::conversation::Conversation,
    understanding::{Asking, Understanding},
    words::{lexicon::Lexicon, prose, question_kind::QuestionKind, table::PhraseTable, token},
};

/// A request that depends on something.
#[derive(Debug, PartialEq)]
struct Conditional {
    /// What is said before and after the sentence, and in it besides.
    before: Vec<String>,
    after: Vec<String>,
    condition: Vec<String>,
    /// Whether the request is for when the condition holds.
    holds: bool,
    request: Vec<String>,
    otherwise: Vec<String>,
}

/// Whether a condition holds.
pub(crate) enum Truth {
    Holds,
    /// It does not: what the robot says to that.
    Fails(String),
    Unknown,
}

impl Conversation<'_> {
    /// What was said, if it is a request with a condition.
    pub(crate) fn on_condition(&self, words: &[String], context: &mut Context) -> Option<Understanding> {
        let words = &with_copula(self.lexicon, words);
        let Conditional { before, after, condition, holds, request, otherwise } = self.conditional(words, context)?;
        let said = |part: Vec<String>| {
            let parts = [before.clone(), part, after.clone()];
            parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(&".".to_owned())
        };
        let is_there = condition.first().is_some_and(|word| word == "there");
        match self.truth(&condition, &request, holds, context) {
            Truth::Holds => {
                self.speak_of(&condition, &request, context);
                Some(self.understand_all(said(request), context))
            }
            // `if there is milk in the fridge, bring it`: who does that finds out.
            Truth::Unknown if is_there && holds && self.finds_out(&condition, &request) => {
                Some(self.understand_all(said(request), context))
            }
            Truth::Fails(text) => {
                let rest = said(otherwise);
                if rest.is_empty() {
                    return Some(Understanding::answer(format!("{text} So I leave that.")));
                }
                Some(self.understand_all(rest, context).after(&text))
            }
            Truth::Unknown if self.judge.asking == Asking::Never => None,
            Truth::Unknown => {
                // What hangs on another condition is not agreed to with this one.
                let has_more = condition_at(self.lexicon, &after).is_some();
                let clauses = self.clauses(&if has_more { request } else { said(request) });
                context.pending = Some(Pending::Search { clauses });
                let condition = token::sentence(&condition);
                Some(ask::confirmation(format!("I cannot tell whether {condition}. Shall I do it all the same?")))
            }
        }
    }

    /// Whether a request is about what its condition says is there.
    fn finds_out(&self, condition: &[String], request: &[String]) -> bool {
        let Some((question, is_negated)) = self.question_of(condition, request) else { return false };
        let is_named = |about: &Phrase| {
            let is_it = |phrase: &&Phrase| {
                phrase.pronoun.is_some() || about.namings.iter().any(|naming| phrase.naming(naming.class).is_some())
            };
            self.clauses(request).iter().any(|clause| slot::named(clause).iter().any(&is_it))
        };
        // Who is in another room nobody finds out by doing something else.
        !is_negated && question.kind != QuestionKind::People && question.about.as_ref().is_none_or(is_named)
    }

    /// What a condition is about is what `it` stands for after it.
    pub(crate) fn speak_of(&self, condition: &[String], request: &[String], context: &mut Context) {
        if let Some((question, _)) = self.question_of(condition, request) {
            let _ = self.answer(&question, context);
            (context.pending, context.question) = (None, None);
        }
    }

    /// Whether it is nothing but a plain request with a plain condition.
    pub(crate) fn is_plain_conditional(&self, words: &[String], context: &Context) -> bool {
        self.conditional(&with_copula(self.lexicon, words), context).is_some_and(|said| {
            said.before.is_empty()
                && said.after.is_empty()
                && self.question_of(&said.condition, &said.request).is_some()
                && self.reads_all(&self.wording(&token::sentence(&said.request)))
        })
    }

    fn clauses(&self, words: &[String]) -> Vec<Clause> {
        let parts = parts::parts(self.lexicon, self.catalog, words);
        parts.into_iter().filter_map(|part| if let Part::Clause(clause) = part { Some(clause) } else { None }).collect()
    }

    pub(crate) fn is_request(&self, words: &[String]) -> bool {
        self.clauses(words).iter().any(chatter::is_clear)
    }

    /// The parts of a sentence with a condition.
    fn conditional(&self, words: &[String], context: &Context) -> Option<Conditional> {
        let (at, length, holds) = condition_at(self.lexicon, words)?;
        let start = words[..at].iter().rposition(|word| token::ends_sentence(word)).map_or(0, |end| end + 1);
        let end = words[at..].iter().position(|word| token::ends_sentence(word)).map_or(words.len(), |end| at + end);
        let mut conditional = Conditional {
            before: trimmed(&words[..start]).to_vec(),
            after: trimmed(&words[end..]).to_vec(),
            condition: Vec::new(),
            holds,
            request: Vec::new(),
            otherwise: Vec::new(),
        };
        let (first, rest) = (trimmed(&words[start..at]).to_vec(), &words[at + length..end]);
        let (rest, mut otherwise) = self.parted(rest);
        let is_first = !self.is_request(&first);
        let split = if is_first {
            self.split(&rest, trimmed_end(&first), holds, context)?
        } else {
            let comma = rest.iter().position(|word| word == ",").unwrap_or(rest.len());
            let next = (1..comma).find(|at| rest[*at] == "and" && self.is_request(&rest[at + 1..comma]));
            let end = next.unwrap_or(comma);
            let more = trimmed(&rest[end..]).to_vec();
            if !more.is_empty() {
                conditional.after = [more, conditional.after]
                    .into_iter()
                    .filter(|part| !part.is_empty())
                    .collect::<Vec<_>>()
                    .join(&".".to_owned());
            }
            (rest[..end].to_vec(), first)
        };
        if otherwise.is_empty()
            && let Some(length) = self.otherwise_at(&conditional.after)
        {
            let end =
                conditional.after.iter().position(|word| token::ends_sentence(word)).unwrap_or(conditional.after.len());
            otherwise = trimmed(&conditional.after[length..end]).to_vec();
            conditional.after = trimmed(&conditional.after[end..]).to_vec();
        }
        (conditional.condition, conditional.request, conditional.otherwise) = (split.0, split.1, otherwise);
        self.is_request(&conditional.request).then_some(conditional)
    }

    /// How many words at the start say that what follows is done otherwise.
    fn otherwise_at(&self, words: &[String]) -> Option<usize> {
        self.lexicon.ifs.otherwise.longest(words).map(|(length, ())| length)
    }

    /// What is to be done, and what otherwise.
    fn parted(&self, words: &[String]) -> (Vec<String>, Vec<String>) {
        let found = (1..words.len()).find_map(|at| Some((at, self.otherwise_at(&words[at..])?)));
        let Some((at, length)) = found else { return (words.to_vec(), Vec::new()) };
        (trimmed(&words[..at]).to_vec(), trimmed(&words[at + length..]).to_vec())
    }

    /// A condition and the request after it: at a comma or `then`, or else where the one makes sense and the other too.
    fn split(
        &self,
        words: &[String],
        lead: &[String],
        holds: bool,
        context: &Context,
    ) -> Option<(Vec<String>, Vec<String>)> {
        let request = |at: usize| [lead, trimmed(&words[at..])].concat();
        let told = words.iter().position(|word| word == "," || word == "then").filter(|at| *at > 0);
        if let Some(at) = told {
            return self.is_request(&request(at + 1)).then(|| (words[..at].to_vec(), request(at + 1)));
        }
        let makes_sense = |at: &usize| {
            let (condition, request) = (&words[..*at], request(*at));
            self.is_request(&request) && !matches!(self.truth(condition, &request, holds, context), Truth::Unknown)
        };
        // The longest condition that can be told: `the fridge is open`, not `the fridge is`.
        let at = (1..words.len()).rev().find(makes_sense)?;
        Some((words[..at].to_vec(), request(at)))
    }

    /// Whether a condition of a request is as it has to be.
    pub(crate) fn truth(&self, condition: &[String], request: &[String], holds: bool, context: &Context) -> Truth {
        let asked = |condition: &[String]| {
            let (question, is_negated) = self.question_of(condition, request)?;
            match self.answerer(context, 0).answer(&question) {
                Understanding::Answer { text, holds: Some(is_so), .. } => Some((text, is_so != is_negated)),
                _ => None,
            }
        };
        match asked(condition) {
            Some((_, is_so)) if is_so == holds => Truth::Holds,
            Some((text, _)) => Truth::Fails(prose::without_yes(&text)),
            None => Truth::Unknown,
        }
    }

    /// The question whether a condition holds, and whether it is denied.
    pub(crate) fn question_of(&self, condition: &[String], request: &[String]) -> Option<(Question, bool)> {
        let (asked, is_negated) = self.as_question(condition, request)?;
        let question = question::read(self.lexicon, &asked)?;
        let can_tell = match question.kind {
            // Where a thing is says nothing of whether it is heavy.
            QuestionKind::State => claim::can_be_told(self.lexicon, &question),
            QuestionKind::Where
            | QuestionKind::Holding
            | QuestionKind::Contents
            | QuestionKind::Under
            | QuestionKind::Danger
            | QuestionKind::People => true,
            _ => false,
        };
        can_tell.then_some((question, is_negated))
    }

    /// A condition as the words of that question, and whether it is denied: `it is not on` as `is the laser on`.
    fn as_question(&self, condition: &[String], request: &[String]) -> Option<(Vec<String>, bool)> {
        let words = &self.lexicon.ifs;
        let mut condition: Vec<String> =
            condition.iter().filter(|word| !token::is_punctuation(word)).cloned().collect();
        let nobody = (0..condition.len()).find_map(|at| Some((at, words.nobody.longest(&condition[at..])?.0)));
        if let Some((at, length)) = nobody {
            condition.splice(at..at + length, ["anybody".to_owned()]);
        }
        let before = condition.len();
        condition.retain(|word| !matches!(word.as_str(), "not" | "no"));
        let is_negated = (before == condition.len() + 1) != nobody.is_some();
        // `the microwave stops`: it is done then.
        let becomes = (1..condition.len()).find_map(|at| {
            let (length, state) = words.becomes.longest(&condition[at..])?;
            (at + length == condition.len()).then_some((at, state))
        });
        if let Some((at, state)) = becomes {
            let state = state.split(' ').map(str::to_owned);
            condition.splice(at.., std::iter::once("is".to_owned()).chain(state));
        }
        condition.retain(|word| !words.adverbs.contains(word));
        if let Some((length, ())) = words.own.longest(&condition) {
            let are = ["are", "you", "holding"].map(str::to_owned);
            return Some(([are.as_slice(), &condition[length..]].concat(), is_negated));
        }
        let says_done = self.lexicon.yes_no.says_done(&condition);
        let named = || self.named_in(request, says_done);
        let copula = condition.iter().position(|word| words.copulas.contains(word));
        let (subject, verb, rest) = match copula {
            Some(0) | None => (named()?, "is".to_owned(), condition[copula.map_or(0, |at| at + 1)..].to_vec()),
            Some(at) if at == 1 && words.pronouns.contains(&condition[0]) => (
                named().unwrap_or_else(|| condition[..1].to_vec()),
                condition[at].clone(),
                condition[at + 1..].to_vec(),
            ),
            Some(at) => (condition[..at].to_vec(), condition[at].clone(), condition[at + 1..].to_vec()),
        };
        if rest.is_empty() {
            return None;
        }
        Some(([vec![verb], subject, rest].concat(), is_negated))
    }

    /// What a request is about, in its own words; where `it` is to be done by then, only what is ever done: not the shirt of
    /// `when it is done, take out the shirt`.
    fn named_in(&self, request: &[String], says_done: bool) -> Option<Vec<String>> {
        const DONE: [Property; 3] = [Property::Toggleable, Property::Eatable, Property::Cookable];
        let clauses = self.clauses(request);
        let is_ever_done = |phrase: &Phrase| {
            let mut classes = phrase.namings.iter().map(|naming| self.catalog.class(naming.class));
            phrase.fluid.is_some() || classes.any(|class| DONE.into_iter().any(|property| class.has(property)))
        };
        let is_named = |phrase: &&Phrase| {
            phrase.pronoun.is_none() && !phrase.text.is_empty() && (!says_done || is_ever_done(phrase))
        };
        let phrase = clauses.first()?.objects.first().filter(is_named)?;
        let the = phrase.text.split(' ').map(str::to_owned);
        Some(std::iter::once("the".to_owned()).chain(the.filter(|word| word != "the" && word != "a")).collect())
    }
}

/// `if its open`, which has lost its apostrophe: `if it is open`.
fn with_copula(lexicon: &Lexicon, words: &[String]) -> Vec<String> {
    let begins = |at: usize| {
        let ends =
            |table: &PhraseTable<()>| (1..=at.min(4)).any(|length| table.exact(&words[at - length..at]).is_some());
        ends(&lexicon.ifs.holds) || ends(&lexicon.ifs.fails)
    };
    let spelt = |(at, word): (usize, &String)| match word.as_str() {
        "its" if begins(at) => vec!["it".to_owned(), "is".to_owned()],
        _ => vec![word.clone()],
    };
    words.iter().enumerate().flat_map(spelt).collect()
}

fn condition_at(lexicon: &Lexicon, words: &[String]) -> Option<(usize, usize, bool)> {
    let ifs = &lexicon.ifs;
    (0..words.len()).find_map(|at| {
        let rest = &words[at..];
        let holds = ifs.holds.longest(rest).map_or(0, |(length, ())| length);
        let fails = ifs.fails.longest(rest).map_or(0, |(length, ())| length);
        let length = holds.max(fails);
        let told = rest.get(length..)?;
        let is_courtesy = ifs.courtesies.longest(told).is_some() && ifs.own.longest(told).is_none();
        // `if it is, …`, of what was asked before.
        let is_elliptic = matches!(told, [subject, copula, end, ..] if ifs.pronouns.contains(subject) && ifs.copulas.contains(copula) && (token::is_punctuation(end) || end == "then"));
        let is_asked = at > 0 && ifs.asks.contains(&words[at - 1]);
        (length > 0 && !told.is_empty() && !is_courtesy && !is_asked && !is_elliptic).then_some((at, length, holds >= fails))
    })
}

/// Without the words at both ends that only join.
pub(crate) fn trimmed(words: &[String]) -> &[String] {
    let start = words.iter().position(|word| !is_joint(word)).unwrap_or(words.len());
    trimmed_end(&words[start..])
}

fn trimmed_end(words: &[String]) -> &[String] {
    let end = words.iter().rposition(|word| !is_joint(word)).map_or(0, |end| end + 1);
    &words[..end]
}

fn is_joint(word: &str) -> bool {
    token::is_punctuation(word) || matches!(word, "and" | "then" | "but")
}

/// Whether a condition is told in full: `if the coffee is cold`, not `if so`.
pub(crate) fn has_condition(lexicon: &Lexicon, words: &[String]) -> bool {
    condition_at(lexicon, &with_copula(lexicon, words)).is_some()
}

/// Whether something is asked for on a condition.
pub(crate) fn is_conditional(lexicon: &Lexicon, words: &[String]) -> bool {
    condition_at(lexicon, words).is_some() || lexicon.conditions.occurs_in(words)
}
