//! The texts of the pages that participants read: a table for each language, and those that a lab writes itself.
//!
//! A table is a TOML file: its `language`, a tag such as `de`, and by their keys the texts of the page of a session
//! (`[session]`) and of the pages of a study (`[study]`). Names in braces in a text stand for values. A table has the keys
//! of the English one and no others, and each text has the names in braces that the English one has: what is missing is
//! told when the table is read, and never to participants.
//!
//! What the session and the robot say is no part of it: that is English.

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt, fs,
    path::Path,
};

use serde::Deserialize;
use serde_json::json;
use toml::Spanned;

/// Tables that ship, by language.
const BUILT_IN: [(&str, &str); 3] = [
    ("en", include_str!("../../web/texts/en.toml")),
    ("de", include_str!("../../web/texts/de.toml")),
    ("es", include_str!("../../web/texts/es.toml")),
];
/// The language of the session and of the robot.
const ENGLISH: &str = "en";
/// The longest tag of a language, in bytes.
const LONGEST_TAG: usize = 35;
/// What stands in pages for the tag of their language, and for their whole table.
const LANGUAGE: &str = "language";
const TABLE: &str = "texts";

/// Texts by their keys.
type Texts = BTreeMap<String, String>;

/// The texts of all pages that participants read, in one language.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct PageTexts {
    language: String,
    session: Texts,
    study: Texts,
}

/// Whose page it is.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum PagePart {
    /// The session's.
    Session,
    /// A study's.
    Study,
}

impl PagePart {
    const ALL: [Self; 2] = [Self::Session, Self::Study];

    /// What its table is called in files.
    const fn name(self) -> &'static str {
        match self {
            Self::Session => "session",
            Self::Study => "study",
        }
    }
}

/// Why pages cannot be had in a language.
#[derive(Debug, thiserror::Error)]
pub enum PageTextsError {
    /// No such table ships.
    #[error(
        "there is no page in the language `{language}`: choose {}, or write its texts into a file of your own, as \
         `dialog/web/texts/en.toml` has the English ones",
        languages().join(", ")
    )]
    NoLanguage {
        /// What was asked for.
        language: String,
    },
    /// The file cannot be read.
    #[error("{file}: {source}")]
    File {
        /// The file.
        file: String,
        /// Why.
        source: std::io::Error,
    },
    /// Things are wrong in it.
    #[error("{}", listed(.file, .problems))]
    Problems {
        /// The file.
        file: String,
        /// All that is wrong in it.
        problems: Vec<TextProblem>,
    },
}

/// What is wrong in a table, where, and what to do about it.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct TextProblem {
    /// The line, from 1; none, where something is missing.
    pub line: Option<usize>,
    /// What is wrong.
    pub problem: String,
    /// What to do about it.
    pub remedy: String,
}

impl fmt::Display for TextProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        write!(f, ": {}; {}", self.problem, self.remedy)
    }
}

fn listed(file: &str, problems: &[TextProblem]) -> String {
    problems.iter().map(|problem| format!("{file}{problem}")).collect::<Vec<_>>().join("\n")
}

/// The languages of the tables that ship.
#[must_use]
pub fn languages() -> Vec<&'static str> {
    BUILT_IN.map(|(language, _)| language).to_vec()
}

/// As it stands in its file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    language: Spanned<String>,
    session: WrittenTexts,
    study: WrittenTexts,
}

type WrittenTexts = BTreeMap<Spanned<String>, Spanned<String>>;

impl Written {
    const fn part(&self, part: PagePart) -> &WrittenTexts {
        match part {
            PagePart::Session => &self.session,
            PagePart::Study => &self.study,
        }
    }

    fn into_texts(self) -> PageTexts {
        let plain = |texts: WrittenTexts| -> Texts {
            texts.into_iter().map(|(key, text)| (key.into_inner(), text.into_inner())).collect()
        };
        PageTexts { language: self.language.into_inner(), session: plain(self.session), study: plain(self.study) }
    }
}

impl Default for PageTexts {
    /// The English ones.
    fn default() -> Self {
        let [(_, english), ..] = BUILT_IN;
        let written: Written =
            toml::from_str(english).expect("invariant: the built-in texts parse, which a test holds");
        written.into_texts()
    }
}

impl PageTexts {
    /// Those that ship in a language.
    ///
    /// # Errors
    /// [`PageTextsError::NoLanguage`], if none do.
    pub fn of(language: &str) -> Result<Self, PageTextsError> {
        let found = BUILT_IN.into_iter().find(|(name, _)| *name == language);
        let (name, text) = found.ok_or_else(|| PageTextsError::NoLanguage { language: language.to_owned() })?;
        Self::parse(name, text)
    }

    /// Those of a lab's own file.
    ///
    /// # Errors
    /// All others of [`PageTextsError`].
    pub fn read(path: &Path) -> Result<Self, PageTextsError> {
        let file = path.display().to_string();
        match fs::read_to_string(path) {
            Ok(text) => Self::parse(&file, &text),
            Err(source) => Err(PageTextsError::File { file, source }),
        }
    }

    /// Those that `text` has, which stands in a file of that name.
    ///
    /// # Errors
    /// [`PageTextsError::Problems`].
    pub fn parse(file: &str, text: &str) -> Result<Self, PageTextsError> {
        let refused = |problems| PageTextsError::Problems { file: file.to_owned(), problems };
        let line_of = |at: usize| text.as_bytes().iter().take(at).filter(|byte| **byte == b'\n').count() + 1;
        let written: Written = toml::from_str(text).map_err(|error| {
            let problem = error.message().replace('\n', " ");
            let remedy = "write a `language`, and texts by their keys into `[session]` and `[study]`".to_owned();
            refused(vec![TextProblem { line: error.span().map(|span| line_of(span.start)), problem, remedy }])
        })?;
        let mut problems = Vec::new();
        let tag = written.language.get_ref();
        if !is_tag(tag) {
            problems.push(TextProblem {
                line: Some(line_of(written.language.span().start)),
                problem: format!("`{}` is no tag of a language", tag.escape_debug()),
                remedy: "write one such as \"fr\" or \"pt-BR\"".to_owned(),
            });
        }
        let english = Self::default();
        for part in PagePart::ALL {
            problems.extend(compare(part, written.part(part), english.part(part), tag, &line_of));
        }
        if problems.is_empty() { Ok(written.into_texts()) } else { Err(refused(problems)) }
    }

    /// The text of a key for a study's server itself, of which tests know that it is there.
    #[must_use]
    pub fn study_text(&self, key: &str) -> &str {
        self.study.get(key).map_or("", String::as_str)
    }

    /// The tag of their language.
    #[must_use]
    pub fn language(&self) -> &str {
        &self.language
    }

    const fn part(&self, part: PagePart) -> &Texts {
        match part {
            PagePart::Session => &self.session,
            PagePart::Study => &self.study,
        }
    }

    /// A page with its texts: `html` has their keys in braces, `{language}` where the tag stands, and `{texts}` where the
    /// whole table does, for its scripts. Other names in braces stay.
    #[must_use]
    pub fn page(&self, part: PagePart, html: &str) -> String {
        let texts = self.part(part);
        let mut filled = String::with_capacity(html.len() * 2);
        let mut rest = html;
        while let Some((before, after)) = rest.split_once('{') {
            filled.push_str(before);
            let Some((name, behind)) = after.split_once('}') else {
                filled.push('{');
                rest = after;
                continue;
            };
            match (name, texts.get(name)) {
                (LANGUAGE, _) => filled.push_str(&escaped(&self.language)),
                // Within a script no letter may begin a tag.
                (TABLE, _) => filled.push_str(&json!(texts).to_string().replace('<', "\\u003c")),
                (_, Some(text)) => filled.push_str(&escaped(text)),
                (_, None) => filled.extend(["{", name, "}"]),
            }
            rest = behind;
        }
        filled.push_str(rest);
        filled
    }
}

/// What one part of a table lacks, or has too much.
fn compare(
    part: PagePart,
    written: &WrittenTexts,
    english: &Texts,
    tag: &str,
    line_of: &dyn Fn(usize) -> usize,
) -> Vec<TextProblem> {
    let name = part.name();
    let mut problems = Vec::new();
    for (key, text) in written {
        let line = Some(line_of(key.span().start));
        let told = |problem: String, remedy: String| TextProblem { line, problem, remedy };
        let (key, text) = (key.get_ref(), text.get_ref());
        let Some(model) = english.get(key) else {
            problems.push(told(format!("`{key}` is no key of `[{name}]`"), "leave it out".to_owned()));
            continue;
        };
        if text.trim().is_empty() && model.is_empty() {
            if !is_english(tag) {
                let remedy = "say there, in your language, that the robot understands and speaks English alone";
                problems.push(told(format!("`{key}` of `[{name}]` is empty"), remedy.to_owned()));
            }
        } else if text.trim().is_empty() {
            problems.push(told(format!("`{key}` of `[{name}]` is empty"), format!("translate {model:?}")));
        } else if values(text) != values(model) {
            let remedy = format!("write the names in braces of {model:?}, and no others");
            problems.push(told(format!("`{key}` of `[{name}]` has other values than the English text"), remedy));
        }
    }
    let own: BTreeSet<&str> = written.keys().map(|key| key.get_ref().as_str()).collect();
    let missing = english.iter().filter(|(key, _)| !own.contains(key.as_str()));
    problems.extend(missing.map(|(key, model)| TextProblem {
        line: None,
        problem: format!("`[{name}]` has no `{key}`"),
        remedy: format!("add it with a translation of {model:?}"),
    }));
    problems
}

fn is_english(tag: &str) -> bool {
    tag.split('-').next() == Some(ENGLISH)
}

/// Whether a text has the form of a tag of a language (BCP 47).
fn is_tag(text: &str) -> bool {
    let is_part = |part: &str| (1..=8).contains(&part.len()) && part.chars().all(|c| c.is_ascii_alphanumeric());
    let is_first = |part: &str| (2..=8).contains(&part.len()) && part.chars().all(|c| c.is_ascii_alphabetic());
    text.len() <= LONGEST_TAG && text.split('-').next().is_some_and(is_first) && text.split('-').all(is_part)
}

/// The names in braces of a text.
fn values(text: &str) -> BTreeSet<&str> {
    text.split('{').skip(1).filter_map(|rest| rest.split_once('}')).map(|(name, _)| name).collect()
}

/// A text as HTML shows it, in its text and in its attributes.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
