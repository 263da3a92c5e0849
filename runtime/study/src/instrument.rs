//! What a questionnaire's file says of it besides its questions: where it is from, and how its answers are scored.

use std::{collections::BTreeMap, fs};

use cohabit_dialog::{Form, Given, Item, Questionnaire, QuestionnaireError, Scale, questionnaire_text};
use serde::Deserialize;

/// What is known of a questionnaire.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Instrument {
    /// Where it is from, as a paper cites it.
    pub citation: Option<String>,
    /// Under which conditions it may be used.
    pub licence: Option<String>,
    /// What its answers amount to.
    pub scores: Vec<Score>,
    /// The right answers of its attention checks, by item, from 0.
    pub attention: BTreeMap<usize, i32>,
    /// What items are called in pairs, by item, from 0.
    pub labels: BTreeMap<usize, String>,
}

/// One number that answers amount to.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Score {
    /// What it is called in tables.
    pub name: String,
    /// How it is worked out.
    pub of: Scoring,
    /// What it means, with its range.
    pub meaning: String,
    /// Of which items, from 1.
    pub items: Vec<usize>,
    /// The items that compare these in pairs, from 1.
    #[serde(default)]
    pub pairs: Vec<usize>,
}

/// How answers amount to a number. Items that are reversed are taken from the other end of their scale, and those without an
/// answer are left out.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq)]
#[serde(rename_all = "snake_case")]
pub enum Scoring {
    /// The mean.
    Mean,
    /// The sum.
    Sum,
    /// The mean, as a part of the scale's length, 0 to 100.
    Percent,
    /// The same, each item weighted by how often it was chosen in pairs; nothing, if a pair has no answer.
    Weighted,
}

/// As it stands in a questionnaire's file.
#[derive(Default, Deserialize)]
struct Written {
    citation: Option<String>,
    licence: Option<String>,
    #[serde(default)]
    score: Vec<Score>,
    #[serde(default)]
    item: Vec<WrittenItem>,
}

#[derive(Deserialize)]
struct WrittenItem {
    label: Option<String>,
    attention: Option<i32>,
}

impl Instrument {
    /// Finds a questionnaire, one that ships or a file, with what is known of it.
    ///
    /// # Errors
    /// [`QuestionnaireError`].
    pub fn find(name: &str) -> Result<(Questionnaire, Self), QuestionnaireError> {
        let asked = Questionnaire::find(name)?;
        let failed = |reason: String| QuestionnaireError { file: name.to_owned(), reason };
        let text = match questionnaire_text(name) {
            Some(text) => text.to_owned(),
            None => fs::read_to_string(name).map_err(|error| failed(error.to_string()))?,
        };
        let instrument = Self::read(&text, &asked).map_err(failed)?;
        Ok((asked, instrument))
    }

    fn read(text: &str, asked: &Questionnaire) -> Result<Self, String> {
        let Written { citation, licence, score: scores, item } =
            toml::from_str(text).map_err(|error| error.to_string().trim_end().to_owned())?;
        let (mut attention, mut labels) = (BTreeMap::new(), BTreeMap::new());
        for (number, item) in item.into_iter().enumerate() {
            attention.extend(item.attention.map(|right| (number, right)));
            labels.extend(item.label.map(|label| (number, label)));
        }
        let instrument = Self { citation, licence, scores, attention, labels };
        instrument.check(asked)?;
        Ok(instrument)
    }

    fn check(&self, asked: &Questionnaire) -> Result<(), String> {
        let mut names: Vec<&str> = Vec::new();
        for score in &self.scores {
            let Score { name, .. } = score;
            if name.is_empty() || !name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') {
                return Err(format!("the score `{name}`: write letters, digits and _ alone"));
            }
            if names.contains(&name.as_str()) {
                return Err(format!("the score `{name}` is there twice: give it a name of its own"));
            }
            names.push(name);
            self.check_score(score, asked).map_err(|reason| format!("the score `{name}`: {reason}"))?;
        }
        let takes = |(item, right): (&usize, &i32)| match asked.items.get(*item).map(|item| &item.form) {
            Some(Form::Scale(scale)) => (scale.least..=scale.most).contains(right),
            Some(Form::Choice(choices)) => {
                usize::try_from(*right).is_ok_and(|right| (1..=choices.len()).contains(&right))
            }
            Some(Form::Words(_)) | None => false,
        };
        match self.attention.iter().find(|one| !takes(*one)) {
            Some((item, right)) => Err(format!(
                "item {}: `attention = {right}` is none of its answers; write the number of the right one",
                item + 1
            )),
            None => Ok(()),
        }
    }

    fn check_score(&self, score: &Score, asked: &Questionnaire) -> Result<(), String> {
        if score.items.is_empty() {
            return Err("it is of no items: name some, from 1".to_owned());
        }
        if let Some(none) = score.items.iter().find(|number| scale(asked, **number).is_none()) {
            return Err(format!("item {none} is no scale: there are {} items, from 1", asked.items.len()));
        }
        let chosen = |number: &usize| {
            choices(asked, *number).is_some_and(|all| all.iter().all(|one| self.item_of(score, one).is_some()))
        };
        match (score.of, score.pairs.iter().find(|number| !chosen(number))) {
            (Scoring::Weighted, Some(pair)) => {
                Err(format!("item {pair} is no choice between two labels of its items: give these a `label`"))
            }
            (Scoring::Weighted, None) if score.pairs.is_empty() => Err("it has no `pairs` to weight it by".to_owned()),
            (Scoring::Weighted, None) => Ok(()),
            _ if score.pairs.is_empty() => Ok(()),
            _ => Err("`pairs` are for scores that are `weighted`".to_owned()),
        }
    }

    /// The item of a score that is called so in pairs.
    fn item_of(&self, score: &Score, label: &str) -> Option<usize> {
        score.items.iter().copied().find(|number| self.labels.get(&(number - 1)).is_some_and(|own| own == label))
    }

    /// What answers amount to; nothing if none was given.
    #[must_use]
    pub fn score(&self, score: &Score, asked: &Questionnaire, given: &[Option<Given>]) -> Option<f64> {
        let places = score.items.iter().filter_map(|number| Some((*number, place(asked, given, *number)?)));
        let places: Vec<(usize, Place)> = places.collect();
        let count = places.len() as f64;
        if places.is_empty() {
            return None;
        }
        let sum = |of: &dyn Fn(&(usize, Place)) -> f64| places.iter().map(of).sum::<f64>();
        match score.of {
            Scoring::Mean => Some(sum(&|(_, place)| place.value) / count),
            Scoring::Sum => Some(sum(&|(_, place)| place.value)),
            Scoring::Percent => Some(100.0 * sum(&|(_, place)| place.part) / count),
            Scoring::Weighted => {
                let weights = self.weights(score, asked, given)?;
                let weight = |number: usize| f64::from(weights.get(&number).copied().unwrap_or(0));
                let whole = sum(&|(number, _)| weight(*number));
                (whole > 0.0).then(|| 100.0 * sum(&|(number, place)| weight(*number) * place.part) / whole)
            }
        }
    }

    /// How often each item was chosen in pairs.
    fn weights(&self, score: &Score, asked: &Questionnaire, given: &[Option<Given>]) -> Option<BTreeMap<usize, u32>> {
        let mut weights = BTreeMap::new();
        for pair in &score.pairs {
            let Some(Some(Given::Value(chosen))) = given.get(pair - 1) else { return None };
            let label = choices(asked, *pair)?.get(usize::try_from(*chosen).ok()?.checked_sub(1)?)?;
            *weights.entry(self.item_of(score, label)?).or_default() += 1;
        }
        Some(weights)
    }

    /// Whether an item was answered as somebody does who reads it; nothing if it is no attention check.
    #[must_use]
    pub fn is_attentive(&self, item: usize, given: Option<&Given>) -> Option<bool> {
        let right = self.attention.get(&item)?;
        Some(given == Some(&Given::Value(*right)))
    }
}

/// A place on a scale, from its other end if it is reversed.
struct Place {
    value: f64,
    /// From 0 to 1.
    part: f64,
}

fn item(asked: &Questionnaire, number: usize) -> Option<&Item> {
    asked.items.get(number.checked_sub(1)?)
}

fn scale(asked: &Questionnaire, number: usize) -> Option<&Scale> {
    match &item(asked, number)?.form {
        Form::Scale(scale) => Some(scale),
        _ => None,
    }
}

fn choices(asked: &Questionnaire, number: usize) -> Option<&[String]> {
    match &item(asked, number)?.form {
        Form::Choice(choices) => Some(choices),
        _ => None,
    }
}

fn place(asked: &Questionnaire, given: &[Option<Given>], number: usize) -> Option<Place> {
    let scale = scale(asked, number)?;
    let Some(Given::Value(value)) = given.get(number - 1)? else { return None };
    let (least, most, value) = (f64::from(scale.least), f64::from(scale.most), f64::from(*value));
    let value = if item(asked, number)?.reversed { least + most - value } else { value };
    Some(Place { value, part: (value - least) / (most - least) })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
