//! What comes after the plan under way: the search that it is a part of, the rest of what was said, and what is left of the mission.

use crate::{
    context::{Context, Guess, Pending},
    read::{clause::Clause, reader::Reader, tidy},
    say::ask,
    talk::{condition::trimmed, conversation::Conversation},
    understanding::{Step, Understanding},
    words::{lexicon::Small, prose, token},
};

/// What it says of what has nothing to do with what failed.
const ALL_THE_SAME: &str = "I do the rest all the same.";
/// What it says that does at once what it offered.
const AGREED: &str = "OK.";

impl Conversation<'_> {
    /// `take the hammer and follow me`: once that is done.
    pub(crate) fn follows_then(&self, words: &[String], context: &mut Context) -> Option<Understanding> {
        let is_joint = |word: &String| token::is_punctuation(word) || matches!(word.as_str(), "and" | "then");
        let at = (1..words.len()).find(|at| is_joint(&words[at - 1]) && self.asks_to_follow(&words[*at..]))?;
        let before = trimmed(&words[..at]);
        if !self.is_request(before) {
            return None;
        }
        let understanding = self.understand_all(tidy::tidied(self.lexicon, before), context);
        Some(match &understanding {
            Understanding::Answer { text, .. } => self.follow(context).after(text),
            _ => context.keep(vec![token::sentence(&words[at..])], understanding),
        })
    }

    /// `follow me`, `follow me to the kitchen`: where somebody goes, they are gone after.
    pub(crate) fn asks_to_follow(&self, words: &[String]) -> bool {
        let words = tidy::plain(words);
        let Some((length, small)) = self.lexicon.small.longest(&words) else { return false };
        let mut reader = Reader::new(self.lexicon, &words[length..]);
        // `let us go to the kitchen` names where to go.
        let is_way = matches!(words[length - 1].as_str(), "me" | "us") && reader.place().is_some();
        reader.skip(|lexicon| &lexicon.trail);
        small.contains(&Small::Follow) && (is_way || length > 1) && reader.is_done()
    }

    /// What is left to do once a plan has ended: what was offered besides and agreed to, the search that it is a part of, or what is next.
    /// What was offered and not answered is then asked once more.
    pub(crate) fn carry_on(&self, context: &mut Context) -> Option<Understanding> {
        if let Some(steps) = context.failed.as_mut().and_then(|failure| failure.take_apart(self.scene)) {
            return Some(self.go_without(steps, context));
        }
        if context.search.is_none()
            && let Some(guess) = context.agreed.take()
        {
            return Some(self.go_as_agreed(guess, context));
        }
        let offer = context.pending.take_if(|pending| matches!(pending, Pending::Also { .. }));
        let next = self.carry_on_with_next(context);
        let Some(Pending::Also { guess, question, is_asked }) = offer.filter(|_| context.pending.is_none()) else {
            return next;
        };
        // What was not found is done nothing with.
        if matches!(next, Some(Understanding::Refusal { .. })) {
            return next;
        }
        let is_asked_now = next.is_none() && !is_asked;
        context.pending = Some(Pending::Also { guess, question: question.clone(), is_asked: is_asked || is_asked_now });
        if is_asked_now { Some(ask::confirmation(question)) } else { next }
    }

    /// Does what has nothing to do with what failed; what was offered for that stays offered.
    fn go_without(&self, steps: Vec<Step>, context: &mut Context) -> Understanding {
        let failed = context.failed.take();
        let understanding = self.go(steps, context).after(ALL_THE_SAME);
        context.failed = failed;
        understanding
    }

    /// Somebody wants what was offered, too: once what is under way has ended.
    pub(crate) fn agreed_to_more(&self, mut guess: Guess, context: &mut Context) -> Understanding {
        if !context.is_busy() {
            return self.go_as_agreed(guess, context);
        }
        let reply = format!("OK, {} after that.", guess.name);
        if guess.steps.is_empty() && guess.search.is_none() {
            context.later.extend(guess.take_later());
        } else {
            context.agreed = Some(guess);
        }
        Understanding::answer(reply)
    }

    fn go_as_agreed(&self, mut guess: Guess, context: &mut Context) -> Understanding {
        let mut later = std::mem::take(&mut context.later);
        later.extend(guess.take_later());
        if !guess.steps.is_empty() {
            let understanding = self.go_as_guessed(guess, context);
            return context.keep(later, understanding);
        }
        if let Some(search) = guess.search {
            let understanding = self.plan(search.clauses, search.consent, context);
            return context.keep(later, understanding);
        }
        context.later = later;
        self.carry_on_with_next(context).unwrap_or_else(|| Understanding::answer(AGREED))
    }

    fn carry_on_with_next(&self, context: &mut Context) -> Option<Understanding> {
        let later = context.later.clone();
        let mut said = None;
        if let Some(search) = context.search.take() {
            let understanding = self.proceed(search, context);
            match &understanding {
                // It was so already: what is next is done.
                Understanding::Answer { text, .. } if !later.is_empty() => said = Some(text.clone()),
                Understanding::Refusal { .. } => {
                    context.later.clear();
                    return Some(understanding);
                }
                _ => return Some(context.keep(later, understanding)),
            }
        }
        // Who is asked something answers first.
        if context.pending.is_some() {
            return None;
        }
        let is_met = |text: &String| self.scene.goals.iter().any(|goal| goal.met && goal.text == *text);
        let left: Vec<String> = later.into_iter().filter(|text| !is_met(text)).collect();
        context.later.clear();
        let next = self.one_after_the_other(left, context, |text, context| self.understand_later(text, context));
        match (said, next) {
            (Some(said), Some(next)) => Some(next.after(&said)),
            (Some(said), None) => Some(Understanding::answer(said)),
            (None, next) => next,
        }
    }

    /// What was left for later; nothing, where it is not understood: nobody is asked what a remark might want.
    fn understand_later(&self, text: &str, context: &mut Context) -> Option<Understanding> {
        let wording = self.wording(text);
        let understanding = if self.reads_all(&wording) {
            self.understand_said(text, context)
        } else {
            self.understand_whole(text, context).0
        };
        let is_guess = matches!(context.pending, Some(Pending::Guess { .. }));
        (!understanding.is_lost() && (!is_guess || self.names_anything(&wording.words))).then_some(understanding)
    }

    /// Whether the mission, or what is left of it, speaks of the same things.
    pub(crate) fn is_of_mission(&self, clause: &Clause) -> bool {
        let is_named = |words: &[String]| {
            let found = self.lexicon.classes.longest(words);
            let mut classes = found.into_iter().flat_map(|(_, namings)| namings).map(|naming| naming.class);
            classes.any(|class| clause.objects.iter().any(|phrase| phrase.naming(class).is_some()))
        };
        let names = |text: &str| {
            let (words, _) = self.lexicon.normalise(text);
            (0..words.len()).any(|at| is_named(&words[at..]))
        };
        self.open_goals().next().is_some() && (names(&self.scene.mission) || self.open_goals().any(names))
    }

    /// Does what is left of the mission, one goal after the other.
    pub(crate) fn pursue(&self, context: &mut Context) -> Understanding {
        let goals: Vec<String> = self.open_goals().map(str::to_owned).collect();
        let understanding = self.next_goal(context);
        let Some((_, later)) = goals.split_first().filter(|(_, later)| !later.is_empty()) else { return understanding };
        match &understanding {
            Understanding::Plan { .. } | Understanding::Question { .. } => {
                let named: Vec<String> = goals.iter().map(|goal| goal.trim_end_matches('.').to_owned()).collect();
                let said = prose::sentence(&format!("I do these one after the other: {}", named.join("; ")));
                context.keep(later.to_vec(), understanding.after(&said))
            }
            _ => understanding,
        }
    }

    pub(crate) fn open_goals(&self) -> impl Iterator<Item = &str> {
        self.scene.goals.iter().filter(|goal| !goal.met && !goal.text.is_empty()).map(|goal| goal.text.as_str())
    }

    /// What a goal says, as if the person had said it.
    pub(crate) fn words_of_goal(&self, goal: &str) -> Vec<String> {
        tidy::tidied(self.lexicon, &self.lexicon.normalise(goal).0)
    }

    /// Does what the next goal says, as if the person had said it.
    pub(crate) fn next_goal(&self, context: &mut Context) -> Understanding {
        let Some(goal) = self.open_goals().next() else {
            return Understanding::answer("There is nothing left to do that I know of.");
        };
        let words = self.words_of_goal(goal);
        let lost = || {
            let text = goal.trim_end_matches('.');
            Understanding::lost(format!("The next goal is: {text}. Tell me what to do for it, step by step."))
        };
        let small = self.small(&words);
        if small.contains(&Small::Goal) || small.contains(&Small::Mission) {
            return lost();
        }
        match self.understand_words(words, context) {
            Understanding::Refusal { is_lost: true, .. } | Understanding::Answer { .. } => lost(),
            understanding => understanding,
        }
    }
}
