//! What a question asks for, and what it is about.

use serde::{Deserialize, Serialize};

use crate::{
    read::{
        asked_about::{at_start, first_named, named, owned, owner, which_holds, which_is_so, which_works},
        phrase::{Phrase, Place},
        reader::Reader,
        segments,
    },
    words::{
        lexicon::{Lexicon, Preposition},
        lists::Whereabouts,
        question_kind::{QuestionKind, Shape},
        table::PhraseTable,
        token,
    },
};

impl Shape {
    /// What stands between its beginning and its end, if the words are of this shape.
    fn between<'w>(&self, lexicon: &Lexicon, words: &'w [String]) -> Option<&'w [String]> {
        let (begin, ()) = self.begins.longest(words)?;
        let rest = &words[begin..];
        let has = |at: usize| self.has.longest(&rest[at..]).is_some();
        if !self.has.is_empty() && !(0..rest.len()).any(has) {
            return None;
        }
        let is_spare =
            |word: &String| token::is_punctuation(word) || lexicon.trail.exact(std::slice::from_ref(word)).is_some();
        let counts = |word: &String| {
            token::digits(word).is_some() || lexicon.numbers.exact(std::slice::from_ref(word)).is_some()
        };
        if self.ends.is_empty() {
            return (!self.is_whole || rest.iter().all(|word| is_spare(word) || counts(word))).then_some(rest);
        }
        let cut = |end: &String| {
            let end = token::words(end);
            let mut rest = rest;
            loop {
                if let Some(between) = rest.strip_suffix(end.as_slice()) {
                    return Some(between);
                }
                rest = rest.split_last().filter(|(last, _)| is_spare(last)).map(|(_, before)| before)?;
            }
        };
        self.ends.iter().find_map(cut)
    }
}

/// A question, and what it is about.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(crate) struct Question {
    pub(crate) kind: QuestionKind,
    pub(crate) about: Option<Phrase>,
    /// What follows the start.
    pub(crate) rest: Vec<String>,
    /// Whether it wants a yes or a no.
    pub(crate) is_whether: bool,
}

impl Question {
    pub(crate) const fn new(kind: QuestionKind, about: Option<Phrase>, rest: Vec<String>) -> Self {
        Self { kind, about, rest, is_whether: false }
    }

    /// Whether it asks for safety, and not for danger.
    pub(crate) fn asks_for_safety(&self) -> bool {
        self.rest.iter().any(|word| matches!(word.as_str(), "safe" | "harmless"))
    }
}

/// Words by which a question about anything begins, and what follows them there.
const ASKING: [&str; 6] = ["what", "where", "how", "who", "why", "which"];
const HELPING: [&str; 15] =
    ["is", "are", "was", "were", "do", "does", "did", "can", "could", "will", "would", "has", "have", "many", "much"];
/// Up to how many words stand before a comma that only say how somebody feels: `oh well, why not`.
const EXCLAIMED: usize = 2;
/// Up to where in a question why it is said whose doing is asked about.
const ABOUT_WHOM: usize = 5;

/// The pieces of a sentence in each of which something is asked, as `what is it, and where is it` has two; one piece, if there are no more.
pub(crate) fn several(words: &[String]) -> Vec<&[String]> {
    let is_joint = |word: &String| matches!(word.as_str(), "," | "and");
    let begins = |at: usize| {
        let is_of = |at: usize, list: &[&str]| words.get(at).is_some_and(|word| list.contains(&word.as_str()));
        at > 0 && is_joint(&words[at - 1]) && is_of(at, &ASKING) && is_of(at + 1, &HELPING)
    };
    let starts: Vec<usize> = std::iter::once(0).chain((0..words.len()).filter(|at| begins(*at))).collect();
    let ends = starts.iter().skip(1).copied().chain([words.len()]);
    let pieces = starts.iter().zip(ends).map(|(start, end)| {
        let piece = &words[*start..end];
        let said = piece.iter().rposition(|word| !is_joint(word)).map_or(0, |last| last + 1);
        &piece[..said]
    });
    pieces.collect()
}

/// The words in which a sentence asks for the reason of what the robot does, if it does so: `well, why do you need it`, `why not`.
pub(crate) fn asked_why<'w>(lexicon: &Lexicon, sentence: &'w [String]) -> Option<&'w [String]> {
    let comma = sentence.iter().take(EXCLAIMED + 1).position(|word| word == ",");
    [0, comma.map_or(0, |at| at + 1)].into_iter().find_map(|from| {
        let said = &sentence[from..];
        let begins = |(at, polite): &(usize, usize)| {
            let longest = lexicon.questions.longest(&said[*at..]);
            longest.is_some_and(|(length, kind)| *kind == QuestionKind::Why && length > *polite)
        };
        let (at, _) = starts(lexicon, said).into_iter().find(begins)?;
        let asked = &said[at..];
        let is_of_robot = asked.iter().take(ABOUT_WHOM).any(|word| matches!(word.as_str(), "you" | "we"));
        let is_bare = matches!(asked, [_] | [_, _]) && asked.iter().skip(1).all(|word| word == "not" || word == "?");
        (is_of_robot || is_bare).then_some(asked)
    })
}

/// The question that these words ask, if they ask one.
pub(crate) fn read(lexicon: &Lexicon, words: &[String]) -> Option<Question> {
    let segments = segments::segments(lexicon, words);
    let first = segments.first()?;
    let question = read_sentence(lexicon, first)?;
    let is_whether = |(at, _): (usize, usize)| {
        first.get(at).is_some_and(|word| {
            matches!(word.as_str(), "is" | "are" | "was" | "were" | "have" | "has" | "did" | "does" | "any")
        })
    };
    let is_whether = starts(lexicon, first).into_iter().any(is_whether);
    // `any mug on the table` answers, too.
    if question.kind == QuestionKind::OfKind && is_whether && !words.iter().any(|word| word == "?") {
        return None;
    }
    Some(Question { is_whether, ..question })
}

/// `where are the teapot and the tea bags`, `are there cups or plates in the kitchen`: each of several things whose place is asked for;
/// nothing, where that is of one. The place that the last one is said to be at is that of all.
pub(crate) fn each_of(lexicon: &Lexicon, question: &Question) -> Option<Vec<Phrase>> {
    if question.kind != QuestionKind::Where {
        return None;
    }
    let mut reader = Reader::new(lexicon, &question.rest);
    let mut each = vec![reader.phrase_with_place()?];
    while ["and", "or", "nor"].iter().any(|joint| reader.next_is(joint)) {
        reader.at += 1;
        each.push(reader.phrase_with_place()?);
    }
    let is_named = |phrase: &Phrase| !phrase.namings.is_empty() && phrase.unknown.is_empty();
    let is_each = each.len() > 1 && each.iter().all(is_named) && lexicon.yes_no.is_filler(reader.rest());
    let last = each.last().filter(|_| is_each).cloned()?;
    for phrase in &mut each {
        if phrase.room.is_none() && !phrase.is_here && phrase.relations.is_empty() {
            phrase.relations.clone_from(&last.relations);
            (phrase.room, phrase.is_here) = (last.room, last.is_here);
        }
    }
    Some(each)
}

fn read_sentence(lexicon: &Lexicon, first: &[String]) -> Option<Question> {
    if let Some(question) = shaped(lexicon, first) {
        return Some(question);
    }
    if let Some(question) = starts(lexicon, first).into_iter().find_map(|(at, _)| kind_asked(lexicon, &first[at..])) {
        return Some(question);
    }
    let asked = put_plainly(lexicon, first);
    if let Some(question) = asked.as_ref().and_then(|asked| shaped(lexicon, asked)) {
        return Some(question);
    }
    let asked = asked.filter(|asked| {
        start(lexicon, asked).is_some_and(|(kind, _)| !matches!(kind, QuestionKind::Unknown | QuestionKind::Look))
    });
    let first = asked.as_deref().unwrap_or(first);
    let (kind, start) = start(lexicon, first)?;
    let mut rest: Vec<String> = first[start..].to_vec();
    rest.retain(|word| !token::is_punctuation(word));
    if kind == QuestionKind::Abilities && rest.len() > 2 {
        return None;
    }
    if matches!(kind, QuestionKind::Unknown | QuestionKind::Look) && lexicon.goal_words.occurs_in(&rest) {
        return Some(Question::new(QuestionKind::Goals, None, rest));
    }
    let has = |table: &PhraseTable<()>| table.occurs_in(&rest);
    if matches!(kind, QuestionKind::Unknown | QuestionKind::Look)
        && has(&lexicon.hand_words)
        && first.iter().any(|word| word == "you" || word == "your")
    {
        return Some(Question::new(QuestionKind::Holding, None, rest));
    }
    if matches!(kind, QuestionKind::Unknown | QuestionKind::Look | QuestionKind::Where) && has(&lexicon.text_words) {
        let about = named(lexicon, &rest);
        return Some(Question::new(QuestionKind::Text, about, rest));
    }
    if kind == QuestionKind::Unknown
        && let Some(about) = which_holds(lexicon, &rest)
    {
        return Some(Question::new(QuestionKind::Where, Some(about), rest));
    }
    // `show me where is the mug`
    if kind == QuestionKind::Where {
        let skipped =
            rest.iter().take_while(|word| matches!(word.as_str(), "is" | "are" | "it" | "was" | "exactly")).count();
        let is_named = Reader { at: skipped, ..Reader::new(lexicon, &rest) }.starts_noun();
        rest.drain(..if is_named { skipped } else { 0 });
    }
    if kind == QuestionKind::Count {
        rest = without_existence(&rest);
    }
    if matches!(kind, QuestionKind::State | QuestionKind::Where | QuestionKind::Count) {
        rest = with_state_last(lexicon, &rest);
    }
    // `are the lights off`: all of them.
    let is_of_several = kind == QuestionKind::State && matches!(first[start - 1].as_str(), "are" | "were");
    let kind = told_by_words(&rest, kind);
    let first = || at_start(lexicon, &rest);
    let about = match kind {
        // `why did you open the fridge`
        QuestionKind::Why => named(lexicon, &rest),
        _ => {
            // `is the blue computer the one for the laser`
            let works = which_works(lexicon, &rest).filter(|_| kind == QuestionKind::State);
            let first_said = || first().filter(|phrase| !phrase.is_empty());
            works.or_else(first_said).or_else(|| named(lexicon, &rest)).or_else(|| owner(&rest)).or_else(first)
        }
    };
    let with_all = |phrase: Phrase| {
        let is_named = !phrase.namings.is_empty() && phrase.side.is_none() && phrase.ordinal.is_none();
        Phrase { is_all: phrase.is_all || is_of_several && is_named, ..phrase }
    };
    Some(Question::new(kind, about.map(with_all), rest))
}

/// The question that words ask by their shape.
fn shaped(lexicon: &Lexicon, words: &[String]) -> Option<Question> {
    starts(lexicon, words).into_iter().find_map(|(at, _)| {
        lexicon.question_shapes.iter().find_map(|shape| {
            let between = shape.between(lexicon, &words[at..])?;
            let rest: Vec<String> = between.iter().filter(|word| !token::is_punctuation(word)).cloned().collect();
            let about = match shape.kind {
                QuestionKind::Which => which_is_so(lexicon, &rest),
                QuestionKind::Owner => owned(lexicon, &rest).or_else(|| first_named(lexicon, &rest)),
                _ => first_named(lexicon, &rest),
            };
            (about.is_some() || shape.kind.stands_alone()).then_some(Question::new(shape.kind, about, rest))
        })
    })
}

/// `which cups are on the table`, `what toys are lying around`, `any fruit in here`: which things of a kind there are.
fn kind_asked(lexicon: &Lexicon, words: &[String]) -> Option<Question> {
    let (asks, rest) = words.split_first()?;
    let is_any = asks == "any";
    if !is_any && asks != "what" && asks != "which" {
        return None;
    }
    let mut reader = Reader::new(lexicon, rest);
    let kind = reader.phrase().filter(|phrase| !phrase.namings.is_empty() && phrase.unknown.is_empty())?;
    if kind.pronoun.is_some() || kind.side.is_some() || kind.ordinal.is_some() {
        return None;
    }
    let (noun, after) = rest.split_at(reader.at);
    let ways = if is_any { vec![(0, Whereabouts::Told)] } else { lexicon.yes_no.asks_which(after) };
    let about = ways.into_iter().find_map(|(length, whereabouts)| {
        let spare = |word: &&String| !token::is_punctuation(word);
        let said: Vec<String> = noun.iter().chain(&after[length..]).filter(spare).cloned().collect();
        let mut reader = Reader::new(lexicon, &said);
        let phrase = reader.phrase_with_place()?;
        let is_placed = phrase.is_here || phrase.room.is_some() || !phrase.relations.is_empty();
        if phrase.relations.iter().any(|relation| relation.to.is_empty() || !relation.to.unknown.is_empty()) {
            return None;
        }
        let is_told = is_placed || whereabouts != Whereabouts::Told;
        let is_here = phrase.is_here || !is_placed && whereabouts == Whereabouts::Here;
        let is_whole = lexicon.yes_no.is_filler(reader.rest());
        (is_told && is_whole).then(|| Phrase { is_here, text: kind.text.clone(), ..phrase })
    })?;
    let rest = rest.iter().filter(|word| !token::is_punctuation(word)).cloned().collect();
    Some(Question::new(QuestionKind::OfKind, Some(about), rest))
}

/// `mugs there are on the table`, of `how many`: the mugs on the table.
fn without_existence(words: &[String]) -> Vec<String> {
    const SAYS: [&[&str]; 6] =
        [&["there", "are"], &["there", "is"], &["are", "there"], &["is", "there"], &["do", "you", "see"], &["are"]];
    let found = (0..words.len()).find_map(|at| {
        let says =
            |said: &&&[&str]| words[at..].len() >= said.len() && said.iter().zip(&words[at..]).all(|(a, b)| a == b);
        SAYS.iter().find(says).map(|said| (at, said.len()))
    });
    match found {
        Some((at, length)) => words[..at].iter().chain(&words[at + length..]).cloned().collect(),
        None => words.to_vec(),
    }
}

/// `the light on in the kitchen`: the light there, and its state.
fn with_state_last(lexicon: &Lexicon, words: &[String]) -> Vec<String> {
    let mut reader = Reader::new(lexicon, words);
    let is_named = reader.phrase().is_some_and(|phrase| !phrase.namings.is_empty());
    let (thing, rest) = words.split_at(reader.at);
    let switched = usize::from(rest.first().is_some_and(|word| matches!(word.as_str(), "on" | "off")));
    let length = lexicon.states.longest(rest).map_or(switched, |(length, _)| length);
    let (state, place) = rest.split_at(length);
    let mut reader = Reader::new(lexicon, place);
    let is_there = |place: &Place| !matches!(place, Place::Object(phrase) if phrase.namings.is_empty());
    let is_placed = !lexicon.yes_no.is_filler(place)
        && matches!(reader.place(), Some((Preposition::In | Preposition::On | Preposition::At, place)) if is_there(&place));
    if is_named && length > 0 && is_placed && lexicon.yes_no.is_filler(reader.rest()) {
        return [thing, place, state].concat();
    }
    words.to_vec()
}

/// What a question whose beginning tells nothing asks, by what else is in it.
fn told_by_words(rest: &[String], kind: QuestionKind) -> QuestionKind {
    let has = |any: &[&str]| rest.iter().any(|word| any.contains(&word.as_str()));
    match kind {
        QuestionKind::Unknown | QuestionKind::Look if has(&["color", "colors"]) => QuestionKind::Color,
        QuestionKind::Unknown if has(&["seen", "see", "find", "left", "lies", "stands", "located"]) => {
            QuestionKind::Where
        }
        QuestionKind::Unknown
            if has(&["i", "we"])
                && has(&["do", "doing", "done"])
                && has(&["have", "supposed", "must", "should", "need", "left", "still", "next", "meant", "ought"]) =>
        {
            QuestionKind::Goals
        }
        kind => kind,
    }
}

/// `check whether the fridge is open`: `is the fridge open`. `state your location`: `what is your location`.
fn put_plainly(lexicon: &Lexicon, words: &[String]) -> Option<Vec<String>> {
    let start = segments::leading(lexicon, words);
    let asked = &words[start..];
    // `tell me, where is it?`
    let told = ["tell me ,", "say ,", "look ,", "listen ,"].iter().map(|start| token::words(start));
    if let Some(rest) = told.into_iter().find_map(|start| asked.strip_prefix(start.as_slice())) {
        return Some(rest.to_vec());
    }
    let (length, ()) = lexicon.reports.longest(asked).unwrap_or((0, &()));
    if length > 0 && asked.get(length).is_some_and(|word| matches!(word.as_str(), "the" | "your" | "its" | "our")) {
        let what_is = ["what", "is"].map(str::to_owned);
        return Some(what_is.iter().chain(&asked[length..]).cloned().collect());
    }
    // `what is dirty?`: which things are.
    if let [what, is, state @ ..] = asked
        && what == "what"
        && matches!(is.as_str(), "is" | "are")
        && let Some((length, _)) = lexicon.states.longest(state)
        && state[length..].iter().all(|word| token::is_punctuation(word))
    {
        let which = ["which", "things", "are"].map(str::to_owned);
        return Some(which.iter().chain(state).cloned().collect());
    }
    // `show me how many mugs there are`
    let is_wh = |word: &String| matches!(word.as_str(), "how" | "what" | "where" | "which" | "who" | "why");
    let shown = lexicon.tells.longest(asked).map(|(length, ())| &asked[length..]);
    if let Some(rest) = shown.filter(|rest| rest.first().is_some_and(is_wh)) {
        return Some(rest.to_vec());
    }
    // `list all objects on the table`
    let spare =
        |word: &String| matches!(word.as_str(), "all" | "every" | "the" | "any" | "contents" | "content" | "of");
    let skipped = asked[length..]
        .iter()
        .take_while(|word| spare(word) || lexicon.generic.exact(std::slice::from_ref(*word)).is_some())
        .count();
    let linked = &asked[length + skipped..];
    let named = &linked[lexicon.link.longest(linked).map_or(0, |(link, ())| link)..];
    if length > 0 && skipped > 0 && lexicon.prepositions.longest(named).is_some() {
        let what_is = ["what", "is"].map(str::to_owned);
        return Some(what_is.iter().chain(named).cloned().collect());
    }
    let at = asked.iter().take(2).position(|word| word == "check").filter(|at| *at == 0 || asked[0] == "go")?;
    let asked = asked[at + 1..].strip_prefix(&["whether".to_owned()])?;
    let verb = asked.iter().position(|word| matches!(word.as_str(), "is" | "are"))?;
    Some(asked[verb..=verb].iter().chain(&asked[..verb]).chain(&asked[verb + 1..]).cloned().collect())
}

/// Where a question may begin: at the words as they are, then after each polite word at the start, each with the length of the next
/// polite words.
fn starts(lexicon: &Lexicon, words: &[String]) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    let mut at = 0;
    while at < words.len() {
        let rest = &words[at..];
        let lead = lexicon.lead.longest(rest).map_or(0, |(length, ())| length);
        let talk = lexicon.talk.longest(rest).map_or(0, |(length, ())| length);
        let polite = if talk == rest.len() { lead } else { lead.max(talk) };
        found.push((at, polite));
        match polite {
            1.. => at += polite,
            0 if token::is_punctuation(&rest[0]) => at += 1,
            0 => break,
        }
    }
    found
}

/// What the beginning of a question says of it: `can you see` must win over the polite `can you`.
fn start(lexicon: &Lexicon, words: &[String]) -> Option<(QuestionKind, usize)> {
    let longer = |(at, polite): (usize, usize)| {
        let (length, kind) = lexicon.questions.longest(&words[at..]).filter(|(length, _)| polite < *length)?;
        Some((at, length, *kind))
    };
    let (at, length, kind) = starts(lexicon, words).into_iter().find_map(longer)?;
    (!is_statement(&words[..at], &words[at])).then_some((kind, at + length))
}

/// `you are driving me mad`: who speaks so says, and does not ask.
fn is_statement(before: &[String], first: &str) -> bool {
    let is_subject = before.last().is_some_and(|word| matches!(word.as_str(), "you" | "i" | "we" | "that" | "there"));
    is_subject && matches!(first, "are" | "am" | "is" | "was" | "were" | "do" | "did" | "have" | "has")
}
