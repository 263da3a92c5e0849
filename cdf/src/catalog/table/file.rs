//! The table's files as they are written, and how their texts become conditions and changes.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::{
    ActionKind, Device, Need, Rule, Site, TableError, Work,
    change::{Change, Effect},
    condition::{Condition, Kinds, read_word},
};
use crate::{
    action::Status,
    nearest::{aside, nearest},
};

/// One file: any part of the table.
#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TableFile {
    #[serde(default)]
    pub kinds: Kinds,
    pub power_work: Option<String>,
    #[serde(default)]
    shared: BTreeMap<String, Vec<RawNeed>>,
    #[serde(default, rename = "rule")]
    rules: Vec<RawRule>,
    #[serde(default, rename = "device")]
    devices: Vec<RawDevice>,
    #[serde(default, rename = "work")]
    works: Vec<RawWork>,
    pub times: Option<Times>,
    #[serde(default)]
    pub slice: BTreeMap<String, String>,
    #[serde(default)]
    pub prints: BTreeMap<String, String>,
    #[serde(default)]
    pub yesterday: BTreeMap<String, String>,
}

/// How long machines run, unless their entry says so.
#[derive(Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Times {
    pub work_s: f32,
    pub moment_s: f32,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum RawNeed {
    Shared(String),
    One(OneOrMany, String, String),
}

#[derive(Deserialize)]
#[serde(untagged)]
enum OneOrMany {
    One(String),
    Many(Vec<String>),
}

#[derive(Deserialize)]
#[serde(untagged)]
enum RawEffect {
    Always(String),
    If {
        #[serde(rename = "if")]
        when: Vec<String>,
        #[serde(rename = "do")]
        changes: Vec<String>,
    },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawRule {
    name: String,
    action: ActionKind,
    #[serde(default)]
    when: Vec<String>,
    #[serde(default)]
    words: Vec<String>,
    #[serde(default)]
    needs: Vec<RawNeed>,
    #[serde(default)]
    effects: Vec<RawEffect>,
    #[serde(default = "plainly_done")]
    done: String,
    #[serde(default)]
    but: Vec<RawNeed>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(clippy::struct_excessive_bools)]
struct RawDevice {
    class: Vec<String>,
    #[serde(default)]
    works: Vec<String>,
    #[serde(default)]
    aims: Vec<String>,
    #[serde(default)]
    worked_by: Vec<String>,
    #[serde(default)]
    needs: Vec<RawNeed>,
    #[serde(default)]
    press: Vec<RawEffect>,
    work: Option<String>,
    #[serde(default)]
    at: Site,
    shut_work: Option<String>,
    #[serde(default)]
    always: bool,
    #[serde(default)]
    stays: bool,
    #[serde(default)]
    dangerous: bool,
    #[serde(default)]
    alarm: bool,
    #[serde(default)]
    ray: bool,
    #[serde(default)]
    slots: bool,
    work_s: Option<f32>,
    moment_s: Option<f32>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawWork {
    name: String,
    over: super::Over,
    effects: Vec<RawEffect>,
    #[serde(default)]
    then: Vec<RawEffect>,
}

fn plainly_done() -> String {
    "done".to_owned()
}

/// Reads one file's text.
pub(super) fn read(file: &str, text: &str) -> Result<TableFile, TableError> {
    toml::from_str(text).map_err(|source| TableError::Syntax { file: file.to_owned(), source: Box::new(source) })
}

impl TableFile {
    /// What its works are called.
    pub fn work_names(&self) -> impl Iterator<Item = &str> {
        self.works.iter().map(|work| work.name.as_str())
    }
}

/// What is read of one file, with its name for errors. What is wrong with an entry is noted, and the others are read.
pub(super) struct Reader<'a> {
    pub file: &'a str,
    pub times: Times,
    /// The kinds of all files.
    pub kinds: &'a Kinds,
}

/// The entries that can be read; what is wrong with the others goes to `errors`.
fn each<R, T>(raw: &[R], errors: &mut Vec<TableError>, read: impl FnMut(&R) -> Result<T, TableError>) -> Vec<T> {
    raw.iter().map(read).filter_map(|one| one.map_err(|error| errors.push(error)).ok()).collect()
}

impl Reader<'_> {
    pub fn rules(&self, read: &TableFile, errors: &mut Vec<TableError>) -> Vec<Rule> {
        let rule = |raw: &RawRule| {
            Ok(Rule {
                name: raw.name.clone(),
                action: raw.action,
                when: self.conditions(&raw.when)?,
                words: raw.words.clone(),
                needs: self.needs(&raw.needs, &read.shared, 0, &mut 0)?,
                effects: self.effects(&raw.effects)?,
                done: raw.done.clone(),
                but: self.needs(&raw.but, &read.shared, 0, &mut 0)?,
            })
        };
        each(&read.rules, errors, rule)
    }

    pub fn devices(&self, read: &TableFile, errors: &mut Vec<TableError>) -> Vec<Device> {
        let device = |raw: &RawDevice| {
            let work_s = raw.work_s.unwrap_or(self.times.work_s);
            Ok(Device {
                classes: raw.class.clone(),
                works: raw.works.clone(),
                aims: raw.aims.clone(),
                worked_by: raw.worked_by.clone(),
                needs: self.needs(&raw.needs, &read.shared, 0, &mut 0)?,
                press: self.effects(&raw.press)?,
                work: raw.work.clone(),
                at: raw.at,
                shut_work: raw.shut_work.clone(),
                answers_always: raw.always,
                stays_without_power: raw.stays,
                dangerous: raw.dangerous,
                alarm: raw.alarm,
                ray: raw.ray,
                slots: raw.slots,
                work_s,
                // What is off before its work is due would never do it.
                moment_s: raw.moment_s.unwrap_or(self.times.moment_s).max(work_s),
            })
        };
        each(&read.devices, errors, device)
    }

    pub fn works(&self, read: &TableFile, errors: &mut Vec<TableError>) -> Vec<Work> {
        let work = |raw: &RawWork| {
            Ok(Work {
                name: raw.name.clone(),
                over: raw.over,
                effects: self.effects(&raw.effects)?,
                then: self.effects(&raw.then)?,
            })
        };
        each(&read.works, errors, work)
    }

    fn needs(
        &self,
        raw: &[RawNeed],
        shared: &BTreeMap<String, Vec<RawNeed>>,
        depth: u32,
        count: &mut u32,
    ) -> Result<Vec<Need>, TableError> {
        /// Shared needs of shared needs; more is a circle.
        const DEEPEST: u32 = 8;
        /// The most needs of an entry, shared ones and their names counted wherever they stand.
        const MOST: u32 = 1000;
        let mut needs = Vec::new();
        for need in raw {
            *count += 1;
            if *count > MOST {
                return Err(self.text(format!("an entry has more than {MOST} needs, shared ones counted each time")));
            }
            match need {
                RawNeed::Shared(name) => {
                    let list = shared.get(name).filter(|_| depth < DEEPEST);
                    let list = list.ok_or_else(|| self.text(format!("there are no shared needs `{name}`")))?;
                    needs.extend(self.needs(list, shared, depth + 1, count)?);
                }
                RawNeed::One(conditions, status, words) => {
                    let texts = match conditions {
                        OneOrMany::One(text) => std::slice::from_ref(text),
                        OneOrMany::Many(texts) => texts,
                    };
                    let (any, status) = (self.conditions(texts)?, self.status(status)?);
                    needs.push(Need { any, status, words: words.clone() });
                }
            }
        }
        Ok(needs)
    }

    /// A status by its name. One that is misspelt is told by itself: TOML would say no more than that nothing fits.
    fn status(&self, name: &str) -> Result<Status, TableError> {
        let unknown = || {
            let names: Vec<String> = Status::ALL.iter().map(|status| format!("{status:?}")).collect();
            let near = nearest(name, names.iter().map(String::as_str)).map(str::to_owned);
            self.text(format!("`{name}` is no status{}", aside(&near)))
        };
        read_word(name).ok_or_else(unknown)
    }

    fn effects(&self, raw: &[RawEffect]) -> Result<Vec<Effect>, TableError> {
        let effect = |raw: &RawEffect| match raw {
            RawEffect::Always(text) => Ok(Effect { when: Vec::new(), changes: vec![self.change(text)?] }),
            RawEffect::If { when, changes } => Ok(Effect {
                when: self.conditions(when)?,
                changes: changes.iter().map(|text| self.change(text)).collect::<Result<_, _>>()?,
            }),
        };
        raw.iter().map(effect).collect()
    }

    fn conditions(&self, texts: &[String]) -> Result<Vec<Condition>, TableError> {
        let one = |text: &String| match text.parse::<Condition>() {
            Ok(condition) => Ok(condition.of_kinds(self.kinds)),
            Err(reason) => Err(self.text(reason)),
        };
        texts.iter().map(one).collect()
    }

    fn change(&self, text: &str) -> Result<Change, TableError> {
        text.parse().map_err(|reason| self.text(reason))
    }

    fn text(&self, reason: String) -> TableError {
        TableError::Text { file: self.file.to_owned(), reason }
    }
}
