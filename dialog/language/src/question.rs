//! Kinds of questions people ask the robot.

use serde::{Deserialize, Serialize};

use crate::{
    clause,
    lexicon::Lexicon,
    phrase::{Phrase, Reader},
    table::PhraseTable,
    token,
};

/// What a question asks for.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum QuestionKind {
    Holding,
    #[serde(rename = "self")]
    Robot,
    Where,
    Abilities,
    Doing,
    Goals,
    Seeing,
    Contents,
    /// What is next to it.
    Near,
    Color,
    Distance,
    Text,
    Look,
    Count,
    State,
    Unknown,
    /// What there is to do, and how to ask for it.
    Options,
    HowTo,
    Why,
}

/// A question, and what it is about.
#[derive(Clone, Debug)]
pub(crate) struct Question {
    pub(crate) kind: QuestionKind,
    pub(crate) about: Option<Phrase>,
    /// What follows the start.
    pub(crate) rest: Vec<String>,
}

/// The question that these words ask, if they ask one.
pub(crate) fn read(lexicon: &Lexicon, words: &[String]) -> Option<Question> {
    let segments = clause::segments(lexicon, words);
    let first = segments.first()?;
    let asked = put_plainly(lexicon, first).filter(|asked| {
        start(lexicon, asked).is_some_and(|(kind, _)| !matches!(kind, QuestionKind::Unknown | QuestionKind::Look))
    });
    let first = asked.as_deref().unwrap_or(first);
    let (kind, start) = start(lexicon, first)?;
    let mut rest: Vec<String> = first[start..].to_vec();
    rest.retain(|word| !token::is_punctuation(word));
    if kind == QuestionKind::Abilities && rest.len() > 2 {
        return None;
    }
    if matches!(kind, QuestionKind::Unknown | QuestionKind::Look)
        && (0..rest.len()).any(|at| lexicon.goal_words.longest(&rest[at..]).is_some())
    {
        return Some(Question { kind: QuestionKind::Goals, about: None, rest });
    }
    let has = |table: &PhraseTable<()>| (0..rest.len()).any(|at| table.longest(&rest[at..]).is_some());
    if matches!(kind, QuestionKind::Unknown | QuestionKind::Look)
        && has(&lexicon.hand_words)
        && first.iter().any(|word| word == "you" || word == "your")
    {
        return Some(Question { kind: QuestionKind::Holding, about: None, rest });
    }
    if matches!(kind, QuestionKind::Unknown | QuestionKind::Look | QuestionKind::Where) && has(&lexicon.text_words) {
        let about = named(lexicon, &rest);
        return Some(Question { kind: QuestionKind::Text, about, rest });
    }
    if kind == QuestionKind::Unknown
        && let Some(about) = which_holds(lexicon, &rest)
    {
        return Some(Question { kind: QuestionKind::Where, about: Some(about), rest });
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
    let kind = told_by_words(&rest, kind);
    let at_start = || Reader::new(lexicon, &rest).phrase_with_place();
    let about = match kind {
        // `why did you open the fridge`
        QuestionKind::Why => named(lexicon, &rest),
        _ => at_start().filter(|phrase| !phrase.is_empty()).or_else(|| named(lexicon, &rest)).or_else(at_start),
    };
    Some(Question { kind, about, rest })
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

/// The first thing that the words name.
pub(crate) fn named(lexicon: &Lexicon, words: &[String]) -> Option<Phrase> {
    (0..words.len()).find_map(|at| {
        let mut reader = Reader::new(lexicon, words);
        reader.at = at;
        reader.phrase_with_place().filter(|phrase| !phrase.namings.is_empty() && phrase.unknown.is_empty())
    })
}

/// What a question whose beginning tells nothing asks, by what else is in it.
fn told_by_words(rest: &[String], kind: QuestionKind) -> QuestionKind {
    let has = |any: &[&str]| rest.iter().any(|word| any.contains(&word.as_str()));
    match kind {
        QuestionKind::Unknown if has(&["color"]) => QuestionKind::Color,
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
    let start = clause::leading(lexicon, words);
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

/// `which machine is the bowl on`: where the bowl is.
fn which_holds(lexicon: &Lexicon, words: &[String]) -> Option<Phrase> {
    let mut reader = Reader::new(lexicon, words);
    reader.phrase().filter(|phrase| !phrase.is_empty())?;
    if !reader.next_is("is") && !reader.next_is("are") {
        return None;
    }
    reader.at += 1;
    let about = reader.phrase().filter(|phrase| !phrase.is_empty() && phrase.unknown.is_empty())?;
    let left = reader.rest();
    let (length, _) = lexicon.prepositions.longest(left).filter(|_| !left.is_empty())?;
    (length == left.len()).then_some(about)
}

/// Tries the words as they are, then without each polite word at the start: `can you see` must win over `can you`.
fn start(lexicon: &Lexicon, words: &[String]) -> Option<(QuestionKind, usize)> {
    let mut at = 0;
    loop {
        let rest = &words[at..];
        let lead = lexicon.lead.longest(rest).map_or(0, |(length, ())| length);
        let talk = lexicon.talk.longest(rest).map_or(0, |(length, ())| length);
        let polite = if talk == rest.len() { lead } else { lead.max(talk) };
        if let Some((length, kind)) = lexicon.questions.longest(rest)
            && polite < length
        {
            return (!is_statement(&words[..at], &rest[0])).then_some((*kind, at + length));
        }
        match polite {
            1.. => at += polite,
            0 if rest.first().is_some_and(|word| token::is_punctuation(word)) => at += 1,
            0 => return None,
        }
    }
}

/// `you are driving me mad`: who speaks so says, and does not ask.
fn is_statement(before: &[String], first: &str) -> bool {
    let is_subject = before.last().is_some_and(|word| matches!(word.as_str(), "you" | "i" | "we" | "that" | "there"));
    is_subject && matches!(first, "are" | "am" | "is" | "was" | "were" | "do" | "did" | "have" | "has")
}
