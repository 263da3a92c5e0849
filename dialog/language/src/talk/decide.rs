//! What an utterance means: what the grammar reads to the last word, or what the rewriter makes of it. What is likely enough is carried out; of what
//! is less likely the robot asks.

use cohabit_cdf::RoomId;

use crate::{
    context::{Context, Guess, Pending},
    read::{question, tail},
    say::{
        ask,
        reply::{self, Told},
    },
    stop,
    talk::{
        conversation::Conversation,
        evidence::{Evidence, Hypothesis},
        rewritten::WAITS,
        room_kind,
        way::Way,
        wording::Wording,
    },
    understanding::{Alternative, Asking, Clarification, Understanding},
    words::{prose, token},
};

/// How likely steps must be meant for them to be taken without a question, where what they change is not simply put back and where it is.
const TO_CHANGE: f32 = 0.72;
const TO_MOVE: f32 = 0.72;
/// The same where nothing but the robot itself is moved.
const TO_LOOK: f32 = 0.45;
/// The same where somebody says that another thing was meant than the one that was taken, and there is one plan only: who was misunderstood
/// once need not say it a third time.
const TO_CORRECT: f32 = 0.45;
/// How likely what is said must be the right reply, where nothing is done.
const TO_REPLY: f32 = 0.2;
/// How likely steps must be meant to be proposed, and to be taken where nothing may be asked.
const TO_PROPOSE: f32 = 0.05;
const TO_GUESS: f32 = 0.3;
/// The same of a stop, where the robot is busy: to stop is the lesser mistake.
const TO_STOP: f32 = 0.6;
/// What is proposed beside the likeliest is at least so likely, of that.
const RIVAL: f32 = 0.25;
/// How many times likelier a plan is than the first part of it, for all of it to be done, and no more than that part asked about.
const MUCH_LIKELIER: f32 = 2.0;
/// How many plans are proposed at most.
const MOST_PROPOSED: usize = 3;
/// Below this, what is done is said to be what the robot thinks.
const SURELY: f32 = 0.7;
const UNSURE: &str = "If I understand you right:";
/// What is said of a stop when all is done.
const DONE_ALREADY: &str = "I have done that already. Shall I undo it?";
const AT_REST: &str = "I am not doing anything now.";
/// How likely that is meant of which the grammar leaves words out.
const BY_GRAMMAR: f32 = 0.7;
/// One in so many words that nobody ever met is too much to guess at: an unknown verb is no deed, and of another language nothing is guessed.
const STRANGE: usize = 6;
/// Up to how many words a refusal, or a question what shall be done, is believed, and an answer to the robot's question is likely nothing else.
const SHORT: usize = 5;
const LONGEST_ANSWER: usize = 24;
/// From how many words on the rewriter may be right where the grammar reads something else, from how many on it rather is, and how sure it must be
/// for the one and the other.
const SOME: usize = 4;
const LONG: usize = 10;
const TO_OVERRULE_SHORT: f32 = 0.94;
const TO_OVERRULE: f32 = 0.7;

/// How much of an utterance the grammar reads.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Reading {
    /// As much as anybody could.
    Sure,
    /// All of it, some words: it may be meant otherwise.
    Short,
    /// All of it, but it is long: some of it is rather meant otherwise.
    Long,
    /// Not all of it.
    Partial,
}

impl Reading {
    /// How likely another reading must be meant to count instead.
    const fn to_overrule(self) -> f32 {
        match self {
            Self::Short => TO_OVERRULE_SHORT,
            Self::Long => TO_OVERRULE,
            Self::Sure | Self::Partial => 0.0,
        }
    }
}

impl Conversation<'_> {
    /// What an utterance means, and how likely it is what was meant.
    pub(crate) fn understand_whole(&self, utterance: &str, context: &mut Context) -> (Understanding, f32) {
        if let Some(rest) = self.without_remark(utterance) {
            return self.understand_whole(&rest, context);
        }
        if let Some(understanding) = self.meant_instead(utterance, context) {
            return (understanding, 1.0);
        }
        let wording = self.wording(utterance);
        let room = room_kind::beside(self.lexicon, &wording.words).or_else(|| self.room_acted_in(&wording, context));
        if let Some(named) = self.with_room_named(&wording, room) {
            return self.understand_whole(&named, context);
        }
        let is_plain = self.is_plain(&wording);
        let by_grammar = self.by_grammar(&wording, is_plain, context);
        let reading = self.reading(&wording, is_plain, &by_grammar, context);
        if reading == Reading::Sure {
            return by_grammar.taken(context);
        }
        let mut ways = self.rewritten(&wording, context, Some(&by_grammar));
        if stop::denies_stop(utterance) {
            ways.retain(|way| !way.stops());
        }
        // Who asks something else while the robot waits for an answer is told: that chooses nothing.
        if context.must_be_answered() && self.only_asks(&wording.tidied) {
            ways.retain(|way| way.steps().is_none() || way.only_looks());
        }
        // Who asks why it does something orders nothing by that.
        if self.asked_why(&wording.tidied).or_else(|| self.asked_why(&wording.words)).is_some() {
            ways.retain(|way| way.steps().is_none() || !way.context.answered.is_empty());
        }
        // A robot that does nothing, and asks nothing, need not stop.
        if !context.is_busy() && context.pending.is_none() {
            let is_stop =
                |way: &Way| matches!(&way.understanding, Understanding::Stop { then: None, reply } if reply != WAITS);
            let (stops, others): (Vec<Way>, Vec<Way>) = ways.into_iter().partition(is_stop);
            ways = others;
            let is_all = ways.first().is_none_or(|way| way.probability < way.least());
            if is_all && reading == Reading::Partial && stops.iter().any(|stop| stop.probability >= TO_MOVE) {
                return (self.too_late(context), 1.0);
            }
        }
        let stops = |way: &&Way| way.stops() && way.probability >= TO_STOP && context.is_busy();
        if let Some(stop) = ways.iter().find(stops) {
            return stop.taken(context);
        }
        if let Some(settled) = settled(&ways) {
            return settled.taken(context);
        }
        // Questions have more shades than plain ones: of what is short, only another deed is rather meant.
        if reading == Reading::Short {
            ways.retain(|way| way.steps().is_some());
        }
        // Of a word that nobody knows the robot asks, rather than to guess at what it may stand for.
        let is_about_word = wording.length() <= SHORT
            && matches!(by_grammar.understanding, Understanding::Question { kind: Clarification::Appearance, .. });
        let to_overrule = if is_about_word { TO_OVERRULE_SHORT } else { reading.to_overrule() };
        // Who wants something of a thing may only have been understood to want it found.
        if reading == Reading::Partial
            && ways.first().is_some_and(Way::only_looks)
            && let Some(understanding) = self.begin(&ways, context)
        {
            return understanding;
        }
        let least = |way: &Way| way.least().max(to_overrule);
        if let Some(likeliest) = ways.first().filter(|likeliest| likeliest.probability >= least(likeliest)) {
            // What the grammar reads whole has what a rewriter leaves out: beside what a thing is put.
            if reading != Reading::Partial && likeliest.is_same(&by_grammar) {
                return Way { probability: likeliest.probability, ..by_grammar }.taken(context);
            }
            return likeliest.taken(context);
        }
        if reading == Reading::Partial
            && self.judge.asking != Asking::Always
            && !context.last_plan.is_empty()
            && self.lexicon.corrections.occurs_in(&wording.words)
            && let Some(meant) = only_plan(&ways)
        {
            return meant.taken(context);
        }
        if reading == Reading::Partial
            && let Some(understanding) = self.begin(&ways, context)
        {
            return understanding;
        }
        if is_about_word {
            return by_grammar.taken(context);
        }
        // What the grammar leaves words out of is a guess too.
        let has_plan = ways.iter().any(|way| way.steps().is_some());
        let guesses = if has_plan { ways.as_slice() } else { std::slice::from_ref(&by_grammar) };
        if reading == Reading::Partial
            && self.rewriter.is_some()
            && let Some(question) = self.proposed(guesses, context)
        {
            return (question, 0.0);
        }
        by_grammar.taken(context)
    }

    /// The ways to take an utterance by what the rewriter writes, with what speaks for each.
    pub(crate) fn all_ways(&self, utterance: &str, context: &Context) -> Vec<(String, Understanding, Evidence)> {
        let wording = self.wording(utterance);
        let by_grammar = self.by_grammar(&wording, self.is_plain(&wording), context);
        let Ok((n_best, evidence)) = self.n_best(&wording, context, Some(&by_grammar)) else { return Vec::new() };
        let of = |(one, evidence): (Hypothesis, Evidence)| (one.text, one.way.understanding, evidence);
        n_best.hypotheses.into_iter().zip(evidence).map(of).collect()
    }

    /// All ways to take an utterance: that of the grammar, then those of the rewriter, the likeliest first.
    pub(crate) fn alternatives(&self, utterance: &str, context: &Context) -> Vec<Alternative> {
        let wording = self.wording(utterance);
        let own = self.by_grammar(&wording, self.is_plain(&wording), context);
        let written = match self.n_best(&wording, context, Some(&own)) {
            Ok((n_best, evidence)) => self.weighed(n_best, &evidence, &wording, context),
            Err(asked) => asked.map(|way| (utterance.to_owned(), *way)).into_iter().collect(),
        };
        let of = |by_grammar: bool, text: String, way: Way| {
            let Way { understanding, probability, .. } = way;
            Alternative { text, by_grammar, understanding, probability }
        };
        let first = of(true, utterance.to_owned(), own);
        std::iter::once(first).chain(written.into_iter().map(|(text, way)| of(false, text, way))).collect()
    }

    /// What is said to who stops what has been done already: that it can be undone.
    fn too_late(&self, context: &mut Context) -> Understanding {
        match self.undo(&mut context.at_new_utterance()) {
            Understanding::Plan { steps, .. } if self.judge.asking != Asking::Never => {
                context.pending = Some(Pending::Offer { plans: vec![steps] });
                ask::confirmation(DONE_ALREADY.to_owned())
            }
            _ => Understanding::answer(AT_REST),
        }
    }

    /// What the grammar makes of it.
    fn by_grammar(&self, wording: &Wording<'_>, is_plain: bool, context: &Context) -> Way {
        let mut then = context.at_new_utterance();
        let understanding = self.understand_said(wording.utterance, &mut then);
        let probability = if is_plain { 1.0 } else { BY_GRAMMAR };
        Way { understanding, probability, context: then }
    }

    /// How much of it the grammar reads.
    fn reading(&self, wording: &Wording<'_>, is_plain: bool, by_grammar: &Way, context: &Context) -> Reading {
        // A rewriter drops on which side of a door the robot is in the end.
        if is_plain && by_grammar.steps().is_some() && self.lexicon.exits.occurs_in(&wording.tidied) {
            return Reading::Sure;
        }
        let said = wording.length();
        let asks_for_lab = |context: &Context| matches!(context.pending, Some(Pending::Lab { .. }));
        // Not `slab`, of which the spelling makes a lab.
        let names_lab = matches!(&by_grammar.context.pending, Some(Pending::Lab { words, at }) if
            words.get(*at).is_some_and(|lab| token::words(wording.utterance).contains(lab)));
        let is_of_lab = names_lab && !asks_for_lab(context);
        let is_strange = context.pending.is_none() && is_strange(wording);
        let is_too_long = wording.utterance.chars().nth(token::MAX_CHARS).is_some();
        let is_conditional = by_grammar.is_understood() && self.is_plain_conditional(&wording.tidied, context);
        // What is offered besides a plan may be agreed to, or left, without another plan.
        let is_taken = by_grammar.steps().is_some() || matches!(context.pending, Some(Pending::Also { .. }));
        let is_answer = is_taken && said <= LONGEST_ANSWER && self.answers(&wording.tidied, context);
        // Which one `the other one` is the rewriter has from what was said alone.
        let is_correction =
            context.pending.is_none() && by_grammar.is_understood() && by_grammar.context.mistaken.is_some();
        let is_wait = by_grammar.is_understood() && self.is_plain_wait(&wording.words);
        if is_of_lab || is_strange || is_too_long || is_conditional || is_answer || is_correction || is_wait {
            return Reading::Sure;
        }
        // `pour the milk`: where to; `drop it`: nothing is there.
        let is_known = matches!(
            by_grammar.understanding,
            Understanding::Refusal { is_lost: false, .. }
                | Understanding::Question { kind: Clarification::Request, .. }
        );
        // `the other one` is none that was just taken.
        let is_done = by_grammar.repeats(&context.last_plan) && self.small(&wording.tidied).is_empty();
        // What `it` is the rewriter has from what was said alone.
        let is_it = |at: usize| {
            self.lexicon.pronouns.longest(&wording.tidied[at..]).is_some_and(|(_, pronoun)| tail::is_thing(*pronoun))
        };
        let speaks_of_it = (0..wording.tidied.len()).any(is_it);
        let is_alone = is_plain && by_grammar.is_understood() && self.asked_alone(&wording.tidied).is_some();
        let is_short = said < LONG || self.questions_asked(&wording.tidied).is_some();
        match is_plain && !is_done && (by_grammar.is_understood() || is_known && said <= SHORT) {
            true if is_alone || said < SOME || is_short && (speaks_of_it || !by_grammar.changes_or_asks_which()) => {
                Reading::Sure
            }
            true if said < LONG => Reading::Short,
            true => Reading::Long,
            false => Reading::Partial,
        }
    }

    /// The room that a question about `the lab` means, asked in none of them: the one in which the robot did something last.
    fn room_acted_in(&self, wording: &Wording<'_>, context: &Context) -> Option<RoomId> {
        let kind = room_kind::bare(self.lexicon, self.scene, &wording.words)?;
        let asks = question::read(self.lexicon, &wording.tidied).is_some();
        if !asks || kind.here(self.scene.robot.room).is_some() {
            return None;
        }
        context.deeds.things().find_map(|id| kind.has(self.scene.object(id)?.room))
    }

    /// The utterance with the name of the room that `the lab` means: one that is named besides, or that the robot is in.
    pub(crate) fn with_room_named(&self, wording: &Wording<'_>, named: Option<RoomId>) -> Option<String> {
        let kind = room_kind::bare(self.lexicon, self.scene, &wording.words)?;
        let room = named.and_then(|room| kind.has(room)).or_else(|| kind.here(self.scene.robot.room))?;
        let is_told = kind.described(self.lexicon, self.scene, kind.after(&wording.words)).is_some();
        let mark = if wording.utterance.trim_end().ends_with('?') { "?" } else { "" };
        (!is_told).then(|| format!("{}{mark}", token::sentence(&kind.named(&wording.words, room, self.catalog))))
    }

    /// Begins with what several ways have in common, and offers how the likeliest of these goes on.
    fn begin(&self, ways: &[Way], context: &mut Context) -> Option<(Understanding, f32)> {
        let (begun, left) = begun(ways)?;
        let (understanding, probability) = begun.taken(context);
        let Some(left) = left.filter(|_| self.judge.asking != Asking::Never) else {
            return Some((understanding, probability));
        };
        context.pending = left.offer.map(|guess| {
            let question = left.said.clone();
            Pending::Also { guess: Box::new(guess), question, is_asked: false }
        });
        Some((understanding.before(&left.said), probability))
    }

    /// Asks which of the likeliest plans is meant, instead of carrying any out; nothing, where none is likely at all.
    fn proposed(&self, ways: &[Way], context: &mut Context) -> Option<Understanding> {
        let mut plans = ways.iter().filter_map(|way| Some((way, way.steps()?))).peekable();
        let (likeliest, _) = *plans.peek().filter(|(way, _)| way.probability >= TO_PROPOSE)?;
        // Who is asked about it and says it again means it.
        let may_ask = self.judge.asking != Asking::Never && !likeliest.is_asked_about(context);
        if !may_ask {
            return (likeliest.probability >= TO_GUESS).then(|| likeliest.taken(context).0);
        }
        let is_rival = |way: &Way| {
            // To look for what is known already is no other plan.
            if likeliest.context.search.is_none() && way.context.search.is_some() {
                return false;
            }
            way.probability >= likeliest.probability * RIVAL && !likeliest.is_part_or_whole(way)
        };
        let rivals = plans.filter(|(way, _)| is_rival(way));
        let mut guesses: Vec<Guess> = Vec::new();
        let mut plans: Vec<Vec<Told>> = Vec::new();
        for (way, steps) in rivals.take(MOST_PROPOSED) {
            let guess = way.context.guess(steps);
            if guesses.iter().all(|other| other.name != guess.name) {
                guesses.push(guess);
                plans.push(way.context.told(steps));
            }
        }
        let question = if let [only] = guesses.as_slice() {
            ask::is_it(&only.name)
        } else {
            let apart = reply::apart(&plans);
            guesses.iter_mut().zip(apart.names).for_each(|(guess, name)| guess.name = name);
            // What is called alike nobody can choose between.
            let mut told: Vec<String> = Vec::new();
            guesses.retain(|guess| {
                let is_new = !told.contains(&guess.name);
                told.push(guess.name.clone());
                is_new
            });
            let names: Vec<&str> = guesses.iter().map(|guess| guess.name.as_str()).collect();
            match names.as_slice() {
                [_] => ask::is_it(&reply::told_in_words(&plans[0])),
                names => ask::which_plan(names, &apart.head, &apart.tail),
            }
        };
        context.pending = Some(Pending::Guess { guesses });
        Some(match likeliest.context.answered.as_str() {
            "" => question,
            answered => question.after(answered),
        })
    }
}

/// The plan of a way beside which the likeliest only asks which thing is meant: other words for the same leave no doubt.
fn settled(ways: &[Way]) -> Option<Way> {
    let (asking, others) = ways.split_first()?;
    if !matches!(asking.understanding, Understanding::Question { kind: Clarification::Reference, .. }) {
        return None;
    }
    let plan = others.iter().find(|way| way.steps().is_some())?;
    let probability = plan.probability + asking.probability;
    let settled = Way { probability, ..plan.clone() };
    (plan.probability >= TO_GUESS && probability >= settled.least()).then_some(settled)
}

/// The likeliest plan, if it is simply put back, and no other one is nearly as likely.
fn only_plan(ways: &[Way]) -> Option<&Way> {
    let mut plans = ways.iter().filter(|way| way.steps().is_some());
    let likeliest = plans.next().filter(|way| way.probability >= TO_CORRECT && !way.is_lasting())?;
    let is_rival = |way: &Way| way.probability >= likeliest.probability * RIVAL;
    (!plans.any(is_rival)).then_some(likeliest)
}

/// How ways go on from a plan that all of them do.
struct Left {
    /// What is said of that.
    said: String,
    /// What is offered, where one way is rather meant than others.
    offer: Option<Guess>,
}

/// A plan that several ways do, together likely enough to be carried out, and how they go on.
fn begun(ways: &[Way]) -> Option<(Way, Option<Left>)> {
    ways.iter().find_map(|way| {
        let longer: Vec<_> =
            ways.iter().filter_map(|other| other.left_after(way).map(|(guess, says)| (other, guess, says))).collect();
        // Probabilities of ways are as their shares of what the rewriter writes.
        let all: f32 = longer.iter().map(|(one, ..)| one.probability).sum();
        let begun = Way { probability: way.probability + all, ..way.clone() };
        let (likeliest, guess, more) = longer.into_iter().next()?;
        // What goes on is rather meant than what only begins.
        let goes_on =
            likeliest.probability >= MUCH_LIKELIER * way.probability && !more.iter().any(|one| one.contains('?'));
        if goes_on && begun.probability >= likeliest.least() {
            return Some((Way { probability: begun.probability, ..likeliest.clone() }, None));
        }
        // To look around as well does no harm.
        if likeliest.only_looks() && begun.probability >= begun.least() {
            return Some((Way { probability: begun.probability, ..likeliest.clone() }, None));
        }
        let left = match likeliest.probability > all / 2.0 {
            // Nobody wants a question that they never asked, and what is not to be done is not done.
            _ if more.iter().any(|one| one.contains('?') || one.starts_with("not ")) => None,
            true => {
                let to_do: Vec<String> = more.iter().map(|one| prose::to_do(one)).collect();
                Some(Left { said: format!("Shall I also {}?", prose::list(&to_do, "and then")), offer: Some(guess) })
            }
            // Each goes on otherwise.
            false => Some(Left { said: "I am not sure what else you want: tell me, please.".to_owned(), offer: None }),
        };
        (begun.probability >= begun.least()).then_some((begun, left))
    })
}

/// Whether it has no words, or too many that nobody ever met.
fn is_strange(wording: &Wording<'_>) -> bool {
    let said = wording.length();
    said == 0 || !wording.unheard.is_empty() && wording.unheard.len() * STRANGE >= said
}

impl Way {
    /// This is what was meant.
    fn taken(&self, context: &mut Context) -> (Understanding, f32) {
        *context = self.context.clone();
        let is_said = self.probability < SURELY && self.steps().is_some();
        let understanding = self.understanding.clone();
        (if is_said { understanding.after(UNSURE) } else { understanding }, self.probability)
    }

    /// Whether it would change anything, or asks which thing is meant.
    fn changes_or_asks_which(&self) -> bool {
        matches!(self.understanding, Understanding::Question { kind: Clarification::Reference, .. })
            || self.steps().is_some() && !self.only_looks()
    }

    /// How likely it must be meant to be carried out, or said.
    fn least(&self) -> f32 {
        match &self.understanding {
            Understanding::Plan { .. } if self.is_lasting() => TO_CHANGE,
            Understanding::Plan { .. } if self.only_looks() => TO_LOOK,
            Understanding::Plan { .. } | Understanding::Stop { .. } => TO_MOVE,
            // That it does not know what to do with a thing is worth saying only where there is no guess.
            Understanding::Question { kind: Clarification::Request, .. } => f32::INFINITY,
            _ => TO_REPLY,
        }
    }
}
