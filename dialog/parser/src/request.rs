//! Requests: what an utterance asks for, as typed frames, and their notation as text.
//!
//! ```text
//! pick up the red mug
//! also: if the fridge is open: close it {gently}
//! answer: the one nearest the sink
//! can you open the safe?
//! ```
//!
//! Descriptions are the person's own words; what they refer to is found later, in a scene. The notation is that of the
//! corpus (`dialog/parser/corpus/README.md`); [`Request::parse`] reads what [`Display`](std::fmt::Display) writes.

use std::{fmt, str::FromStr, sync::LazyLock};

/// One request of an utterance.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Request {
    /// How it relates to what was asked before.
    pub relation: Relation,
    /// All of these must hold; in the order in which they were said.
    pub conditions: Vec<Condition>,
    /// What is asked.
    pub act: Act,
    /// How, or how much: `gently`, `halfway`.
    pub manner: Option<String>,
}

/// How a request relates to what was asked before.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Relation {
    /// It stands by itself.
    New,
    /// It continues what was asked before.
    Also,
    /// It replaces what was asked or done before.
    Instead,
}

/// What must hold; statements are the person's words.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum Condition {
    /// Only if this holds.
    If(String),
    /// Only if this does not hold.
    Unless(String),
    /// As soon as this holds.
    When(String),
    /// Repeated or kept up until this holds.
    Until(String),
    /// Only if the condition of the request before does not hold.
    Otherwise,
}

/// What is asked.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum Act {
    /// To do this, or to answer this question.
    Do(Command),
    /// Not to do this.
    Refrain(Command),
    /// A question about a command.
    Inquire(Inquiry, Command),
    /// The answer to a question of the robot.
    Answer(Answer),
    /// A state or a thing that is wanted.
    Goal(String),
    /// Something to know.
    Tell(String),
    /// Social talk.
    Social(Social),
    /// Nothing for a robot.
    None,
}

/// What is asked about a command.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Inquiry {
    /// `can you …?`
    Can,
    /// `how do I …?`
    How,
    /// `did you …?`
    Did,
    /// `why did you …?`
    Why,
}

/// A command or a question, with its descriptions.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum Command {
    /// One of the known forms, with a description for each of its places.
    Known {
        /// Which one.
        form: Form,
        /// One for each X, Y and number of the form, in their order.
        arguments: Vec<String>,
    },
    /// An imperative that fits none of them, in the person's words.
    Unknown(String),
}

/// An answer to a question of the robot.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum Answer {
    /// Yes.
    Yes,
    /// No.
    No,
    /// Whichever.
    Any,
    /// Both, or all.
    Both,
    /// None of those that were offered.
    NoneOfThem,
    /// The person does not know.
    Unknown,
    /// In other words.
    Words(String),
}

/// Kinds of social talk.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Social {
    /// `hello`
    Greeting,
    /// `thanks`
    Thanks,
    /// `well done`
    Praise,
    /// `this takes ages`
    Complaint,
    /// `sorry`
    Apology,
    /// `see you`
    Bye,
    /// `right you are`
    Agreement,
    /// Anything else.
    SmallTalk,
}

/// A form of plain requests: `put X in Y`. All of them stand in `data/forms.txt`.
#[derive(Clone, Copy, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub struct Form(u16);

/// Why a text is no request.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum RequestError {
    /// It is empty.
    Empty,
    /// It has none of the forms.
    NoForm(String),
    /// There is no such social talk.
    NoSocial(String),
    /// `if` and its like lack `: REQUEST`.
    NoConsequence(String),
}

struct Pattern {
    text: &'static str,
    pieces: Vec<Piece>,
}

enum Piece {
    Word(&'static str),
    /// Punctuation that follows a word without a space.
    Mark(char),
    Description,
    Number,
}

static FORMS: LazyLock<Vec<Pattern>> = LazyLock::new(|| {
    let lines = include_str!("../data/forms.txt").lines().map(str::trim);
    lines.filter(|line| !line.is_empty() && !line.starts_with("# ")).map(Pattern::new).collect()
});

/// Makes a condition of its statement.
type MakeCondition = fn(String) -> Condition;

const CONDITIONS: [(&str, MakeCondition); 4] =
    [("if ", Condition::If), ("unless ", Condition::Unless), ("when ", Condition::When), ("until ", Condition::Until)];

const ANSWERS: [(&str, Answer); 6] = [
    ("yes", Answer::Yes),
    ("no", Answer::No),
    ("any", Answer::Any),
    ("both", Answer::Both),
    ("none of them", Answer::NoneOfThem),
    ("I do not know", Answer::Unknown),
];

const SOCIAL: [(&str, Social); 8] = [
    ("greeting", Social::Greeting),
    ("thanks", Social::Thanks),
    ("praise", Social::Praise),
    ("complaint", Social::Complaint),
    ("apology", Social::Apology),
    ("bye", Social::Bye),
    ("agreement", Social::Agreement),
    ("small talk", Social::SmallTalk),
];

const INQUIRIES: [(&str, Inquiry); 4] = [
    ("can you ", Inquiry::Can),
    ("how do I ", Inquiry::How),
    ("did you ", Inquiry::Did),
    ("why did you ", Inquiry::Why),
];

impl Request {
    /// Reads requests that are joined by `; `.
    ///
    /// # Errors
    /// The first that is no request.
    pub fn parse_all(text: &str) -> Result<Vec<Self>, RequestError> {
        text.split("; ").map(Self::parse).collect()
    }

    /// Reads one request.
    ///
    /// # Errors
    /// Where it has none of the known forms.
    pub fn parse(text: &str) -> Result<Self, RequestError> {
        let mut rest = text.trim();
        let mut manner = None;
        if let Some((before, inside)) = rest.strip_suffix('}').and_then(|text| text.rsplit_once(" {")) {
            (rest, manner) = (before, Some(inside.to_owned()));
        }
        let (mut relation, mut conditions) = (Relation::New, Vec::new());
        loop {
            if let Some(after) = rest.strip_prefix("also: ") {
                (relation, rest) = (Relation::Also, after);
            } else if let Some(after) = rest.strip_prefix("instead: ") {
                (relation, rest) = (Relation::Instead, after);
            } else if let Some(after) = rest.strip_prefix("otherwise: ") {
                conditions.push(Condition::Otherwise);
                rest = after;
            } else if let Some((word, condition)) = CONDITIONS.iter().find(|(word, _)| rest.starts_with(word)) {
                let (statement, after) =
                    rest[word.len()..].split_once(": ").ok_or_else(|| RequestError::NoConsequence(rest.to_owned()))?;
                conditions.push(condition(statement.to_owned()));
                rest = after;
            } else {
                break;
            }
        }
        Ok(Self { relation, conditions, act: Act::parse(rest)?, manner })
    }
}

impl Act {
    fn parse(text: &str) -> Result<Self, RequestError> {
        if text.is_empty() {
            return Err(RequestError::Empty);
        }
        if text == "none" {
            return Ok(Self::None);
        }
        if let Some(words) = text.strip_prefix("answer: ") {
            return Ok(Self::Answer(words.parse().unwrap_or_else(|_| Answer::Words(words.to_owned()))));
        }
        if let Some(words) = text.strip_prefix("goal: ") {
            return Ok(Self::Goal(words.to_owned()));
        }
        if let Some(words) = text.strip_prefix("tell: ") {
            return Ok(Self::Tell(words.to_owned()));
        }
        if let Some(kind) = text.strip_prefix("social: ") {
            return kind.parse().map(Self::Social);
        }
        if let Some(words) = text.strip_prefix("do not ") {
            return Ok(Self::Refrain(Command::inner(words)));
        }
        if let Ok(command) = Command::parse(text) {
            return Ok(Self::Do(command));
        }
        let inquiry = INQUIRIES.iter().find_map(|(words, inquiry)| {
            Some(Self::Inquire(*inquiry, Command::inner(text.strip_prefix(words)?.strip_suffix('?')?)))
        });
        inquiry.ok_or_else(|| RequestError::NoForm(text.to_owned()))
    }
}

impl Command {
    fn parse(text: &str) -> Result<Self, RequestError> {
        if let Some(words) = text.strip_prefix('*').filter(|words| !words.trim().is_empty()) {
            return Ok(Self::Unknown(words.trim().to_owned()));
        }
        let known = FORMS.iter().zip(0..).find_map(|(pattern, form)| {
            let mut arguments = Vec::new();
            pattern.matches(text, &mut arguments).then_some(Self::Known { form: Form(form), arguments })
        });
        known.ok_or_else(|| RequestError::NoForm(text.to_owned()))
    }

    /// A command inside another act, where one that fits no form needs no star.
    fn inner(text: &str) -> Self {
        Self::parse(text).unwrap_or_else(|_| Self::Unknown(text.to_owned()))
    }
}

impl Form {
    /// All forms, in the order of their table.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..FORMS.len()).filter_map(|form| u16::try_from(form).ok()).map(Self)
    }

    /// Its text: `put X in Y`.
    #[must_use]
    pub fn text(self) -> &'static str {
        FORMS[usize::from(self.0)].text
    }

    /// How many descriptions and numbers it has.
    #[must_use]
    pub fn places(self) -> usize {
        let pieces = &FORMS[usize::from(self.0)].pieces;
        pieces.iter().filter(|piece| matches!(piece, Piece::Description | Piece::Number)).count()
    }
}

impl FromStr for Form {
    type Err = RequestError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Self::all().find(|form| form.text() == text).ok_or_else(|| RequestError::NoForm(text.to_owned()))
    }
}

impl FromStr for Answer {
    type Err = RequestError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let known = ANSWERS.iter().find(|(answer, _)| *answer == text).map(|(_, answer)| answer.clone());
        known.ok_or_else(|| RequestError::NoForm(text.to_owned()))
    }
}

impl FromStr for Social {
    type Err = RequestError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let known = SOCIAL.iter().find(|(name, _)| *name == text);
        known.map(|(_, social)| *social).ok_or_else(|| RequestError::NoSocial(text.to_owned()))
    }
}

impl Pattern {
    fn new(text: &'static str) -> Self {
        let mut pieces = Vec::new();
        for word in text.split(' ') {
            let bare = word.trim_end_matches(['?', ':']);
            pieces.push(match bare {
                "X" | "Y" => Piece::Description,
                "#" => Piece::Number,
                _ => Piece::Word(bare),
            });
            pieces.extend(word[bare.len()..].chars().map(Piece::Mark));
        }
        Self { text, pieces }
    }

    fn matches(&self, text: &str, arguments: &mut Vec<String>) -> bool {
        matches(&self.pieces, text, arguments)
    }
}

/// Whether `text` is `pieces`; each description is as short as it can be. The descriptions are appended to `arguments`.
fn matches(pieces: &[Piece], text: &str, arguments: &mut Vec<String>) -> bool {
    let Some((piece, rest)) = pieces.split_first() else { return text.is_empty() };
    match piece {
        Piece::Word(word) => {
            let Some(after) = text.strip_prefix(word) else { return false };
            match rest.first() {
                None => after.is_empty(),
                Some(Piece::Mark(_)) => matches(rest, after, arguments),
                Some(_) => after.strip_prefix(' ').is_some_and(|after| matches(rest, after, arguments)),
            }
        }
        Piece::Mark(mark) => {
            let Some(after) = text.strip_prefix(*mark) else { return false };
            if rest.is_empty() {
                return after.is_empty();
            }
            after.strip_prefix(' ').is_some_and(|after| matches(rest, after, arguments))
        }
        Piece::Description | Piece::Number => {
            let is_number = matches!(piece, Piece::Number);
            let begun = arguments.len();
            let ends = text.match_indices(' ').map(|(at, _)| at).chain([text.len()]);
            for end in ends.chain(text.rfind(['?', ':'])) {
                let (said, after) = text.split_at(end);
                if said.is_empty() || is_number && said.parse::<f32>().is_err() {
                    continue;
                }
                arguments.truncate(begun);
                arguments.push(said.to_owned());
                let goes_on = match rest.first() {
                    None => after.is_empty(),
                    Some(Piece::Mark(_)) => matches(rest, after, arguments),
                    Some(_) => after.strip_prefix(' ').is_some_and(|after| matches(rest, after, arguments)),
                };
                if goes_on {
                    return true;
                }
            }
            arguments.truncate(begun);
            false
        }
    }
}

impl fmt::Display for Request {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.relation {
            Relation::New => {}
            Relation::Also => formatter.write_str("also: ")?,
            Relation::Instead => formatter.write_str("instead: ")?,
        }
        for condition in &self.conditions {
            match condition {
                Condition::If(statement) => write!(formatter, "if {statement}: ")?,
                Condition::Unless(statement) => write!(formatter, "unless {statement}: ")?,
                Condition::When(statement) => write!(formatter, "when {statement}: ")?,
                Condition::Until(statement) => write!(formatter, "until {statement}: ")?,
                Condition::Otherwise => formatter.write_str("otherwise: ")?,
            }
        }
        write!(formatter, "{}", self.act)?;
        self.manner.iter().try_for_each(|manner| write!(formatter, " {{{manner}}}"))
    }
}

impl fmt::Display for Act {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Do(Command::Unknown(words)) => write!(formatter, "*{words}"),
            Self::Do(command) => write!(formatter, "{command}"),
            Self::Refrain(command) => write!(formatter, "do not {command}"),
            Self::Inquire(inquiry, command) => {
                let words = INQUIRIES.iter().find(|(_, known)| known == inquiry).map_or("", |(words, _)| words);
                write!(formatter, "{words}{command}?")
            }
            Self::Answer(Answer::Words(words)) => write!(formatter, "answer: {words}"),
            Self::Answer(answer) => {
                let words = ANSWERS.iter().find(|(_, known)| known == answer).map_or("", |(words, _)| words);
                write!(formatter, "answer: {words}")
            }
            Self::Goal(words) => write!(formatter, "goal: {words}"),
            Self::Tell(words) => write!(formatter, "tell: {words}"),
            Self::Social(social) => {
                let name = SOCIAL.iter().find(|(_, known)| known == social).map_or("", |(name, _)| name);
                write!(formatter, "social: {name}")
            }
            Self::None => formatter.write_str("none"),
        }
    }
}

impl fmt::Display for Command {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self::Known { form, arguments } = self else {
            let Self::Unknown(words) = self else { return Ok(()) };
            return formatter.write_str(words);
        };
        let mut arguments = arguments.iter();
        for (at, piece) in FORMS[usize::from(form.0)].pieces.iter().enumerate() {
            if at > 0 && !matches!(piece, Piece::Mark(_)) {
                formatter.write_str(" ")?;
            }
            match piece {
                Piece::Word(word) => formatter.write_str(word)?,
                Piece::Mark(mark) => write!(formatter, "{mark}")?,
                Piece::Description | Piece::Number => {
                    formatter.write_str(arguments.next().map_or("", String::as_str))?
                }
            }
        }
        Ok(())
    }
}

impl fmt::Debug for Form {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Form({})", self.text())
    }
}

impl fmt::Display for RequestError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => formatter.write_str("a request is empty"),
            Self::NoForm(text) => write!(formatter, "`{text}` has none of the forms of data/forms.txt"),
            Self::NoSocial(kind) => {
                let names: Vec<&str> = SOCIAL.iter().map(|(name, _)| *name).collect();
                write!(formatter, "`{kind}` is no kind of social talk (there are: {})", names.join(", "))
            }
            Self::NoConsequence(text) => write!(formatter, "`{text}` lacks `: REQUEST` after its condition"),
        }
    }
}

impl std::error::Error for RequestError {}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(text: &str, act: Act) {
        let request = Request::parse(text).unwrap();
        assert_eq!(request.act, act, "{text}");
        assert_eq!(request.to_string(), text);
    }

    fn known(form: &str, arguments: &[&str]) -> Command {
        Command::Known { form: form.parse().unwrap(), arguments: arguments.iter().map(|&one| one.to_owned()).collect() }
    }

    #[test]
    fn commands_have_their_descriptions() {
        check("pick up the red mug", Act::Do(known("pick up X", &["the red mug"])));
        check("put it back", Act::Do(known("put X back", &["it"])));
        check("put the mug next to it", Act::Do(known("put X next to Y", &["the mug", "it"])));
        check("turn left 45 degrees", Act::Do(known("turn left # degrees", &["45"])));
        check("name the round table: lunch table", Act::Do(known("name X: Y", &["the round table", "lunch table"])));
        check("is the fridge in the kitchen open?", Act::Do(known("is X in Y?", &["the fridge", "the kitchen open"])));
        check("what is it for?", Act::Do(known("what is X for?", &["it"])));
        check("*water the fern", Act::Do(Command::Unknown("water the fern".to_owned())));
    }

    #[test]
    fn other_acts() {
        check("do not open it", Act::Refrain(known("open X", &["it"])));
        check("do not touch it", Act::Refrain(Command::Unknown("touch it".to_owned())));
        check("can you open the safe?", Act::Inquire(Inquiry::Can, known("open X", &["the safe"])));
        check("why did you do that?", Act::Do(known("why did you do that?", &[])));
        check("answer: any", Act::Answer(Answer::Any));
        check("answer: the one there", Act::Answer(Answer::Words("the one there".to_owned())));
        check("social: small talk", Act::Social(Social::SmallTalk));
    }

    #[test]
    fn relations_conditions_and_manner() {
        let request = Request::parse("also: if the fridge is open: close it {gently}").unwrap();
        assert_eq!(request.relation, Relation::Also);
        assert_eq!(request.conditions, [Condition::If("the fridge is open".to_owned())]);
        assert_eq!(request.manner.as_deref(), Some("gently"));
        assert_eq!(request.to_string(), "also: if the fridge is open: close it {gently}");
    }

    #[test]
    fn what_is_no_request_is_named() {
        for (text, why) in [
            ("", RequestError::Empty),
            ("frobnicate", RequestError::NoForm("frobnicate".to_owned())),
            ("social: dance", RequestError::NoSocial("dance".to_owned())),
            ("if it rains", RequestError::NoConsequence("if it rains".to_owned())),
        ] {
            assert_eq!(Request::parse(text), Err(why));
        }
    }
}
