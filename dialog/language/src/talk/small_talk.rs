//! What is a whole utterance by itself: yes and no, thanks, a greeting, again, undo.

use crate::{
    context::{Context, search::Consent},
    read::{clause::Part, parts, question, tidy::plain},
    talk::conversation::Conversation,
    understanding::Understanding,
    words::{lexicon::Small, question_kind::QuestionKind, token::MAX_CHARS},
};

/// What is said to who has it go on, while it does so, and where there is nothing to go on with.
const GOES_ON: &str = "I am still at it.";
const NOTHING_HALTED: &str = "There is nothing that I could go on with. What shall I do?";

impl Conversation<'_> {
    /// The reply to what asks for nothing to be done.
    pub(crate) fn chat(&self, words: &[String]) -> Option<&str> {
        self.lexicon.chat.exact(&plain(words)).map(String::as_str)
    }

    pub(crate) fn small(&self, words: &[String]) -> Vec<Small> {
        let words = plain(words);
        let known = |words: &[String]| self.lexicon.small.exact(words).map(|smalls| smalls.iter().copied().collect());
        let plainly = || -> Vec<String> {
            words.iter().filter(|word| !self.lexicon.fillers.adverbs.contains(*word)).cloned().collect()
        };
        let several = || self.several_smalls(&words).and_then(known);
        known(&words).or_else(several).or_else(|| known(&plainly())).unwrap_or_default()
    }

    /// `neither, leave it`, `ok, once more please`: the first of several that make up all of it.
    fn several_smalls<'w>(&self, words: &'w [String]) -> Option<&'w [String]> {
        let (mut at, mut first) = (0, None);
        while at < words.len() {
            let rest = &words[at..];
            let small = self.lexicon.small.longest(rest).map_or(0, |(length, _)| length);
            let polite = matches!(
                rest[0].as_str(),
                "please" | "ok" | "okay" | "well" | "hmm" | "oh" | "then" | "and" | "so" | "which"
            );
            if small == 0 && !polite {
                return None;
            }
            if small > 0 && !(polite && small == 1) {
                first = first.or(Some(&rest[..small]));
            }
            at += small.max(1);
        }
        first
    }

    /// Whether the words are a yes or a no, alone or before something else: `yes, please open it`.
    pub(crate) fn small_at_start(&self, words: &[String], small: Small) -> bool {
        let exact = self.small(words);
        if !exact.is_empty() {
            return exact.contains(&small);
        }
        words.first().is_some_and(|word| match small {
            Small::Yes => matches!(word.as_str(), "yes" | "yeah" | "yep" | "yup" | "sure"),
            Small::No => matches!(word.as_str(), "no" | "nope" | "nah"),
            _ => false,
        })
    }

    pub(crate) fn small_talk(&self, words: &[String], context: &mut Context) -> Option<Understanding> {
        let small = self.small(words);
        let is = |kind| small.contains(&kind);
        // `go on then` agrees, too.
        if is(Small::Resume) && (context.halted.is_some() || !is(Small::Yes)) {
            return Some(self.resume(context));
        }
        if is(Small::Again) && !context.last_plan.is_empty() {
            // `repeat that`, after an answer; `do it again` is of a deed.
            if context.question.is_some() && words.iter().any(|word| word == "repeat") {
                return Some(self.answerer(context, 0).said());
            }
            let steps = match context.failed.take() {
                Some(failure) => failure.again(self.scene),
                // As things are now: what is switched on already is not switched once more.
                None if !context.request.is_empty() => {
                    let consent = Consent { is_agreed: true, ..Consent::default() };
                    return Some(self.plan(context.request.clone(), consent, context));
                }
                None => context.last_plan.clone(),
            };
            return Some(self.go(steps, context));
        }
        // `why not?` asks, where the robot did not.
        let is_why = || question::read(self.lexicon, words).is_some_and(|asked| asked.kind == QuestionKind::Why);
        if (is(Small::Yes) || is(Small::No)) && !is_why() {
            let failure = context.failed.take();
            return Some(match failure {
                Some(failure) if is(Small::Yes) => self.mend(&failure, context),
                _ if is(Small::Yes) => Understanding::answer("OK. What shall I do?"),
                _ => Understanding::answer("All right."),
            });
        }
        if is(Small::Goal) {
            return Some(self.next_goal(context));
        }
        if is(Small::Mission) {
            return Some(self.pursue(context));
        }
        if is(Small::Follow) || self.asks_to_follow(words) {
            return Some(self.follow(context));
        }
        if is(Small::Aside) {
            return Some(self.step_aside(context));
        }
        if is(Small::Undo) || self.is_undo(words) {
            return Some(self.undo(context));
        }
        if is(Small::Thanks) {
            return Some(Understanding::answer("You are welcome!"));
        }
        if is(Small::Hello) {
            return Some(Understanding::answer("Hello! What can I do for you?"));
        }
        // `come here`: who is there is come to.
        let comes = |part: &Part| matches!(part, Part::Clause(clause) if clause.verb == "come");
        let is_called =
            || self.scene.person.is_some() && parts::parts(self.lexicon, self.catalog, words).iter().any(comes);
        self.chat(words).filter(|_| !is_called()).map(Understanding::answer)
    }

    /// Goes on with what was stopped.
    fn resume(&self, context: &mut Context) -> Understanding {
        if context.is_busy() {
            return Understanding::answer(GOES_ON);
        }
        let goes_on = match context.take_halted() {
            Some(halted) if halted.steps.is_empty() => self.carry_on(context),
            Some(halted) => Some(self.go_as_guessed(halted, context)),
            None => None,
        };
        goes_on.unwrap_or_else(|| Understanding::answer(NOTHING_HALTED))
    }

    /// `do not follow me any more`, to a robot that follows.
    pub(crate) fn lets_go(&self, utterance: &str) -> bool {
        let is_short = utterance.chars().nth(MAX_CHARS).is_none();
        is_short && self.small(&self.lexicon.normalise(utterance).0).contains(&Small::Unfollow)
    }

    /// `undo the previous command`.
    fn is_undo(&self, words: &[String]) -> bool {
        let words = plain(words);
        let spare = |word: &String| self.lexicon.undone.exact(std::slice::from_ref(word)).is_some();
        let (verb, rest) = words.split_first().map_or(("", &[][..]), |(verb, rest)| (verb.as_str(), rest));
        matches!(verb, "undo" | "revert" | "reverse") && !rest.is_empty() && rest.iter().all(spare)
    }
}
