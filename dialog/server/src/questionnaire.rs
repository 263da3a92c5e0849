//! Questionnaires: what people are asked about a session on its page, before they play or after.
//!
//! A questionnaire is a TOML file: a `title`, what it is `about`, `when` it is asked (`"before"` or `"after"`), and an
//! `[[item]]` a question. What an item asks (`ask`) is answered on a `scale`, by a `choice` of several, or in `words =
//! true`; one without any of them has the `scale` of the file. An item may be `optional`, and one on a scale `reversed`:
//! a high number then means little of what the questionnaire measures. Its `citation`, `licence` and `[[score]]`s, and an
//! item's `label` and `attention`, are for the tables of studies, which score answers; pages pass them over.

use std::{fmt, fs, path::Path};

use cohabit_bus::{
    Text,
    message::{AnswerKind, AnswerMessage},
};
use serde::{Deserialize, Serialize, de::IgnoredAny};

use crate::{limits::LONGEST_TEXT_CHARS, text};

/// Those that ship, by name.
const BUILT_IN: [(&str, &str); 7] = [
    ("sus", include_str!("../data/questionnaires/sus.toml")),
    ("tlx", include_str!("../data/questionnaires/tlx.toml")),
    ("tlx_weighted", include_str!("../data/questionnaires/tlx_weighted.toml")),
    ("rosas", include_str!("../data/questionnaires/rosas.toml")),
    ("trust", include_str!("../data/questionnaires/trust.toml")),
    ("ueq_s", include_str!("../data/questionnaires/ueq_s.toml")),
    ("pssuq", include_str!("../data/questionnaires/pssuq.toml")),
];

/// Those that do not ship, since not everybody may pass them on, and what to do about it.
const NOT_SHIPPED: [(&str, &str); 1] = [(
    "godspeed",
    "Godspeed (Bartneck and others 2009) does not ship: its paper is under a licence for noncommercial use alone. Where that covers your \
     study, write its items into a file of your own, and name that",
)];

/// The most questions of one, the most places of a scale, and the most that can be chosen from.
const MOST_ITEMS: usize = 100;
const MOST_PLACES: i64 = 101;
const MOST_CHOICES: usize = 20;
/// The longest name of one, and the longest question, in bytes.
const LONGEST_NAME: usize = 62;
const LONGEST_QUESTION: usize = 510;

/// What people are asked.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Questionnaire {
    /// What it is found by in tables.
    pub name: String,
    /// What people read above it.
    pub title: String,
    /// What they read of it.
    pub about: String,
    /// When it is asked.
    pub when: When,
    /// Its questions.
    pub items: Vec<Item>,
}

/// When a questionnaire is asked.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum When {
    /// When a page opens.
    Before,
    /// When the mission is over.
    #[default]
    After,
}

/// A question.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Item {
    /// What it asks.
    pub ask: String,
    /// How it is answered.
    #[serde(flatten)]
    pub form: Form,
    /// Whether it may stay without an answer.
    pub optional: bool,
    /// Whether a high number means little of what is measured.
    #[serde(skip)]
    pub reversed: bool,
}

/// How a question is answered.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Form {
    /// By a place on a scale.
    Scale(Scale),
    /// By one of these.
    Choice(Vec<String>),
    /// In words.
    Words(bool),
}

/// A scale of whole numbers.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Scale {
    /// Its lowest number.
    pub least: i32,
    /// Its highest.
    pub most: i32,
    /// From one place to the next.
    #[serde(default = "one")]
    pub step: i32,
    /// What its lowest number means.
    #[serde(default)]
    pub left: String,
    /// What its highest means.
    #[serde(default)]
    pub right: String,
}

const fn one() -> i32 {
    1
}

/// Why a questionnaire cannot be asked.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
#[error("{file}: {reason}")]
pub struct QuestionnaireError {
    /// The file, or what was asked for.
    pub file: String,
    /// What is wrong, where, and what would be right.
    pub reason: String,
}

/// As it stands in its file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    title: String,
    #[serde(default)]
    about: String,
    #[serde(default)]
    when: When,
    #[serde(rename = "citation")]
    _citation: Option<IgnoredAny>,
    #[serde(rename = "licence")]
    _licence: Option<IgnoredAny>,
    #[serde(rename = "score")]
    _scores: Option<IgnoredAny>,
    scale: Option<Scale>,
    #[serde(default)]
    item: Vec<WrittenItem>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenItem {
    ask: String,
    #[serde(rename = "label")]
    _label: Option<IgnoredAny>,
    #[serde(rename = "attention")]
    _attention: Option<IgnoredAny>,
    scale: Option<Scale>,
    choice: Option<Vec<String>>,
    #[serde(default)]
    words: bool,
    #[serde(default)]
    optional: bool,
    #[serde(default)]
    reversed: bool,
}

/// The text of the questionnaire of that name, if one ships.
#[must_use]
pub fn questionnaire_text(name: &str) -> Option<&'static str> {
    BUILT_IN.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}

impl Questionnaire {
    /// The questionnaire of that name, or of that file.
    ///
    /// # Errors
    /// [`QuestionnaireError`].
    pub fn find(name: &str) -> Result<Self, QuestionnaireError> {
        if let Some(text) = questionnaire_text(name) {
            return Self::read(name, name, text);
        }
        let failed = |reason| QuestionnaireError { file: name.to_owned(), reason };
        let path = Path::new(name);
        let text = fs::read_to_string(path).map_err(|error| {
            if let Some((_, why)) = NOT_SHIPPED.iter().find(|(known, _)| *known == name) {
                return failed((*why).to_owned());
            }
            let known: Vec<_> = BUILT_IN.iter().map(|(known, _)| *known).collect();
            failed(format!("{error}; name a file, or one of those that ship: {}", known.join(", ")))
        })?;
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        Self::read(&stem, name, &text)
    }

    pub(crate) fn read(name: &str, file: &str, text: &str) -> Result<Self, QuestionnaireError> {
        let failed = |reason: String| QuestionnaireError { file: file.to_owned(), reason };
        let written: Written = toml::from_str(text).map_err(|error| failed(error.to_string().trim_end().to_owned()))?;
        written.named(name).map_err(failed)
    }
}

impl Written {
    fn named(self, name: &str) -> Result<Questionnaire, String> {
        let Self { title, about, when, scale, item, .. } = self;
        if name.is_empty() || name.len() > LONGEST_NAME {
            return Err(format!("its file's name is what it is called in tables: 1 to {LONGEST_NAME} bytes, please"));
        }
        if item.is_empty() || item.len() > MOST_ITEMS {
            return Err(format!("it has {} questions: write 1 to {MOST_ITEMS}, each below an `[[item]]`", item.len()));
        }
        let numbered = |(index, item): (usize, WrittenItem)| {
            item.checked(scale.as_ref()).map_err(|reason| format!("item {}: {reason}", index + 1))
        };
        let items = item.into_iter().enumerate().map(numbered).collect::<Result<_, _>>()?;
        Ok(Questionnaire { name: name.to_owned(), title, about, when, items })
    }
}

impl WrittenItem {
    fn checked(self, usual: Option<&Scale>) -> Result<Item, String> {
        let Self { ask, scale, choice, words, optional, reversed, .. } = self;
        if ask.trim().is_empty() || ask.len() > LONGEST_QUESTION {
            return Err(format!("`ask` is {} bytes long: 1 to {LONGEST_QUESTION}, please", ask.len()));
        }
        let form = match (scale, choice, words) {
            (Some(scale), None, false) => Form::Scale(scale.checked()?),
            (None, Some(choice), false) if (2..=MOST_CHOICES).contains(&choice.len()) => Form::Choice(choice),
            (None, Some(choice), false) => {
                return Err(format!("a choice of {}: 2 to {MOST_CHOICES}, please", choice.len()));
            }
            (None, None, true) => Form::Words(true),
            (None, None, false) => {
                let usual =
                    usual.ok_or("it has no `scale`, `choice` or `words = true`, and the file has no `scale`")?;
                Form::Scale(usual.clone().checked()?)
            }
            _ => return Err("only one of `scale`, `choice` and `words`, please".to_owned()),
        };
        if reversed && !matches!(form, Form::Scale(_)) {
            return Err("only what is answered on a `scale` can be `reversed`".to_owned());
        }
        Ok(Item { ask, form, optional, reversed })
    }
}

impl Scale {
    fn checked(self) -> Result<Self, String> {
        let Self { least, most, step, .. } = self;
        let (length, step_length) = (i64::from(most) - i64::from(least), i64::from(step));
        let goes_up = length > 0 && step > 0 && length % step_length == 0;
        match goes_up.then(|| length / step_length + 1) {
            Some(places) if places <= MOST_PLACES => Ok(self),
            Some(places) => Err(format!("a scale of {places} places: {MOST_PLACES} at most, please")),
            None => Err(format!("a scale from {least} to {most} in steps of {step}: it must go up in whole steps")),
        }
    }

    fn has(&self, value: i32) -> bool {
        (self.least..=self.most).contains(&value)
            && (i64::from(value) - i64::from(self.least)) % i64::from(self.step) == 0
    }
}

/// What a page answers to a question.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Given {
    /// A number on a scale, or that of a choice, from 1.
    Value(i32),
    /// Words.
    Text(String),
}

/// Why answers cannot be taken, for the person who gave them.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum NotAnswered {
    /// A question has no answer, or one that is none of its own.
    Missing {
        /// Its number, from 1.
        question: u32,
    },
    /// The words that answer a question are too many.
    TooLong {
        /// Its number, from 1.
        question: u32,
        /// How long they are, in characters.
        characters: usize,
        /// How long they may be.
        most: usize,
    },
    /// Another reason.
    Other(String),
}

impl NotAnswered {
    pub(crate) const fn new(reason: String) -> Self {
        Self::Other(reason)
    }
}

impl fmt::Display for NotAnswered {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Missing { question } => write!(f, "Question {question} has no answer yet."),
            Self::TooLong { question, characters, most } => {
                write!(f, "Question {question}: It has {characters} characters; {most} at most, please.")
            }
            Self::Other(reason) => f.write_str(reason),
        }
    }
}

impl Questionnaire {
    /// The messages of a person's answers, one for each that was given.
    ///
    /// # Errors
    /// [`NotAnswered`], when one is missing or is none.
    pub fn answered(&self, person: u32, given: &[Option<Given>]) -> Result<Vec<AnswerMessage>, NotAnswered> {
        if given.len() != self.items.len() {
            return Err(NotAnswered::new(format!("{} answers to {} questions.", given.len(), self.items.len())));
        }
        let mut messages = Vec::new();
        for (number, (item, given)) in (1_u32..).zip(self.items.iter().zip(given)) {
            if given.is_none() && item.optional {
                continue;
            }
            if let Some(Given::Text(text)) = given
                && !text::is_within_limit(text.trim())
            {
                let characters = text.trim().chars().count();
                return Err(NotAnswered::TooLong { question: number, characters, most: LONGEST_TEXT_CHARS });
            }
            let answer = given.as_ref().and_then(|given| item.answered(given));
            let mut message = answer.ok_or(NotAnswered::Missing { question: number })?;
            message.person = person;
            message.item = number;
            message.questionnaire = Text::new(&self.name);
            message.question = Text::new(&item.ask);
            messages.push(message);
        }
        Ok(messages)
    }
}

impl Item {
    fn answered(&self, given: &Given) -> Option<AnswerMessage> {
        match (&self.form, given) {
            (Form::Scale(scale), Given::Value(value)) if scale.has(*value) => {
                let mut message = AnswerMessage::new(AnswerKind::Scale);
                message.value = *value;
                (message.least, message.most) = (scale.least, scale.most);
                message.reversed = u32::from(self.reversed);
                Some(message)
            }
            (Form::Choice(choices), Given::Value(value)) => {
                let mut message = AnswerMessage::new(AnswerKind::Choice);
                message.value = *value;
                message.text = Text::new(value.checked_sub(1).and_then(|at| choices.get(usize::try_from(at).ok()?))?);
                Some(message)
            }
            (Form::Words(_), Given::Text(text)) if !text.trim().is_empty() => {
                let mut message = AnswerMessage::new(AnswerKind::Words);
                message.text = Text::new(&text::in_lines(text.trim()));
                Some(message)
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Questionnaire, String> {
        Questionnaire::read("after", "after.toml", text).map_err(|error| error.to_string())
    }

    #[test]
    fn those_that_ship_can_be_asked() {
        let items = BUILT_IN.map(|(name, _)| Questionnaire::find(name).map(|found| found.items.len()));
        assert_eq!(items, [10, 6, 21, 18, 12, 8, 16].map(Ok));
    }

    #[test]
    fn what_is_wrong_is_said_with_its_place() {
        let refused = [
            ("title = 1", "line 1"),
            ("title = \"T\"\nitem = [{ ask = \"How?\", answer = 1 }]", "unknown field `answer`"),
            ("title = \"T\"", "0 questions: write 1 to 100"),
            ("title = \"T\"\n[[item]]\nask = \"How?\"", "item 1: it has no `scale`"),
            ("title = \"T\"\n[[item]]\nask = \"\"\nwords = true", "item 1: `ask` is 0 bytes"),
            ("title = \"T\"\n[[item]]\nask = \"?\"\nchoice = [\"a\"]", "item 1: a choice of 1: 2 to 20"),
            ("title = \"T\"\n[[item]]\nask = \"?\"\nwords = true\nchoice = [\"a\", \"b\"]", "item 1: only one of"),
            ("title = \"T\"\n[[item]]\nask = \"?\"\nwords = true\nreversed = true", "item 1: only what is answered"),
            ("title = \"T\"\nscale = { least = 3, most = 1 }\n[[item]]\nask = \"?\"", "whole steps"),
            ("title = \"T\"\nscale = { least = -2147483648, most = 2147483647 }\n[[item]]\nask = \"?\"", "101 at most"),
        ];
        for (text, reason) in refused {
            let error = read(text).expect_err(text);
            assert!(error.starts_with("after.toml: ") && error.contains(reason), "{error}");
        }
        let error = Questionnaire::find("nowhere.toml").expect_err("there is none").to_string();
        assert!(error.starts_with("nowhere.toml: ") && error.contains("sus, tlx"), "{error}");
        let error = Questionnaire::find("godspeed").expect_err("it does not ship").to_string();
        assert!(error.contains("noncommercial use alone") && error.contains("a file of your own"), "{error}");
    }

    #[test]
    fn answers_are_taken_or_refused() {
        let text = "title = \"T\"\nscale = { least = 0, most = 10, step = 5 }\n[[item]]\nask = \"How?\"\nreversed = true\n\
                    [[item]]\nask = \"Which?\"\nchoice = [\"one\", \"two\"]\n[[item]]\nask = \"Why?\"\nwords = true\noptional = true";
        let asked = read(text).expect("a questionnaire");
        let words = Some(Given::Text(" Because. ".to_owned()));
        let messages = asked.answered(3, &[Some(Given::Value(5)), Some(Given::Value(2)), words]).expect("answers");
        let told: Vec<_> = messages.iter().map(|one| (one.kind(), one.item, one.value, one.text.as_str())).collect();
        let expected =
            [(AnswerKind::Scale, 1, 5, ""), (AnswerKind::Choice, 2, 2, "two"), (AnswerKind::Words, 3, 0, "Because.")];
        assert_eq!(told, expected.map(|(kind, item, value, text)| (Some(kind), item, value, text)));
        assert!(messages.iter().all(|one| one.person == 3 && one.questionnaire.as_str() == "after"));
        assert_eq!((messages[0].least, messages[0].most, messages[0].reversed), (0, 10, 1));
        let refused = |given: &[Option<Given>]| asked.answered(3, given).expect_err("no answers").to_string();
        assert_eq!(refused(&[Some(Given::Value(7)), Some(Given::Value(2)), None]), "Question 1 has no answer yet.");
        assert_eq!(refused(&[Some(Given::Value(0)), Some(Given::Value(3)), None]), "Question 2 has no answer yet.");
        assert_eq!(refused(&[Some(Given::Value(0)), None, None]), "Question 2 has no answer yet.");
        assert_eq!(refused(&[None]), "1 answers to 3 questions.");
        let long =
            |letters: usize| [Some(Given::Value(0)), Some(Given::Value(1)), Some(Given::Text("я".repeat(letters)))];
        assert_eq!(refused(&long(2001)), "Question 3: It has 2001 characters; 2000 at most, please.");
        let whole = asked.answered(3, &long(2000)).expect("answers");
        assert_eq!(whole[2].text.as_str().chars().count(), 2000);
        let optional = asked.answered(3, &[Some(Given::Value(0)), Some(Given::Value(1)), None]);
        assert_eq!(optional.map(|messages| messages.len()), Ok(2));
    }
}
