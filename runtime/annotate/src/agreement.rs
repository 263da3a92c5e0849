//! How alike people's annotations are.
//!
//! Texts of one unit are compared in pairs by the F1 of their words (Rajpurkar et al. 2016, "SQuAD", section 6.1, without its list of
//! articles). It is not corrected for chance: there is no model of what two people would write by chance. Whether people wrote
//! anything at all is a judgement of two categories, for which Krippendorff's alpha is given (Krippendorff 2011, "Computing
//! Krippendorff's Alpha-Reliability", nominal data).

mod report;
#[cfg(test)]
mod tests;

use std::{collections::BTreeMap, path::Path};

use cohabit_convert::native::Dataset;
use cohabit_durable::{Readers, write_whole};

use crate::{
    agreement_path,
    assign::Board,
    error::{AnnotateError, at},
    journal::Journal,
    journal_path,
    task::{Annotation, Kind, Segment, Unit},
};

pub use report::{csv, lines};

/// How alike the annotations of a unit are.
#[derive(Clone, Debug, PartialEq)]
pub struct UnitAgreement {
    /// What people were asked.
    pub unit: Unit,
    /// What it is about.
    pub segment: Segment,
    /// How many wrote a text.
    pub texts: usize,
    /// How many skipped it.
    pub skipped: usize,
    /// The mean F1 of all pairs of texts, 0 to 1; none of fewer than two texts.
    pub token_f1: Option<f64>,
}

/// How alike all annotations of a kind are.
#[derive(Clone, Debug, PartialEq)]
pub struct KindAgreement {
    /// The kind.
    pub kind: Kind,
    /// How many wrote a text.
    pub texts: usize,
    /// How many skipped one.
    pub skipped: usize,
    /// The mean of those of its units that have one; each unit counts once.
    pub token_f1: Option<f64>,
    /// Krippendorff's alpha of whether people wrote a text; none where all did, or nobody, or no two were asked the same.
    pub skip_alpha: Option<f64>,
}

/// Measures the agreement of a data set's annotations, and writes it into its table; gives that of each kind.
///
/// # Errors
/// [`AnnotateError`], also where nobody has written anything yet.
pub fn measure(folder: &Path) -> Result<Vec<KindAgreement>, AnnotateError> {
    Dataset::open(folder)?;
    let board = Board::of_record(Journal::read(&journal_path(folder))?);
    let units = by_unit(board.annotations());
    if units.is_empty() {
        let reason =
            "nobody has annotated it yet: call `cohabit annotate` without `--agreement`, and give people their links";
        return Err(AnnotateError::Unfit { path: folder.to_owned(), reason: reason.to_owned() });
    }
    let kinds = by_kind(&units);
    let path = agreement_path(folder);
    write_whole(&path, csv(&units, &kinds).as_bytes(), Readers::All).map_err(at(&path))?;
    Ok(kinds)
}

/// The agreement by unit, in their order.
#[must_use]
pub fn by_unit<'a>(annotations: impl IntoIterator<Item = &'a Annotation>) -> Vec<UnitAgreement> {
    let mut units: BTreeMap<Unit, (Segment, Vec<Option<&str>>)> = BTreeMap::new();
    for annotation in annotations {
        let unit = units.entry(annotation.task.unit());
        unit.or_insert_with(|| (annotation.task.segment().clone(), Vec::new())).1.push(annotation.text());
    }
    let agreement = |(unit, (segment, texts)): (Unit, (Segment, Vec<Option<&str>>))| {
        let written: Vec<&str> = texts.iter().copied().flatten().collect();
        let skipped = texts.len() - written.len();
        UnitAgreement { unit, segment, texts: written.len(), skipped, token_f1: mean_pairwise_f1(&written) }
    };
    units.into_iter().map(agreement).collect()
}

/// The agreement by kind.
#[must_use]
pub fn by_kind(units: &[UnitAgreement]) -> Vec<KindAgreement> {
    let of_kind = |kind: Kind| {
        let own: Vec<&UnitAgreement> = units.iter().filter(|one| one.unit.kind() == kind).collect();
        let judged: Vec<[usize; 2]> = own.iter().map(|one| [one.texts, one.skipped]).collect();
        KindAgreement {
            kind,
            texts: own.iter().map(|one| one.texts).sum(),
            skipped: own.iter().map(|one| one.skipped).sum(),
            token_f1: mean(own.iter().filter_map(|one| one.token_f1)),
            skip_alpha: alpha(&judged),
        }
    };
    Kind::ALL.into_iter().map(of_kind).collect()
}

/// The mean F1 of all pairs of texts; none of fewer than two.
#[must_use]
pub fn mean_pairwise_f1(texts: &[&str]) -> Option<f64> {
    let words: Vec<BTreeMap<String, usize>> = texts.iter().map(|text| counted_words(text)).collect();
    let pairs =
        words.iter().enumerate().flat_map(|(number, one)| words[number + 1..].iter().map(move |other| (one, other)));
    mean(pairs.map(|(one, other)| f1(one, other)))
}

/// Krippendorff's alpha of judgements of two categories: how many judged a unit each way, unit by unit. Units with fewer than two
/// judgements do not count. None where all judgements are the same, since then nothing could have differed.
#[must_use]
pub fn alpha(units: &[[usize; 2]]) -> Option<f64> {
    let (mut totals, mut differing) = ([0.0; 2], 0.0);
    for [one, other] in units.iter().map(|unit| unit.map(|count| count as f64)) {
        let judged = one + other;
        if judged >= 2.0 {
            totals[0] += one;
            totals[1] += other;
            // Pairs of judgements that differ; each unit counts by how many judgements it has.
            differing += one * other / (judged - 1.0);
        }
    }
    let expected = totals[0] * totals[1];
    (expected > 0.0).then(|| 1.0 - (totals[0] + totals[1] - 1.0) * differing / expected)
}

/// Words without case and punctuation, and how often each is there.
fn counted_words(text: &str) -> BTreeMap<String, usize> {
    let mut words = BTreeMap::new();
    let lower = text.to_lowercase();
    for word in lower.split(|letter: char| !letter.is_alphanumeric()).filter(|word| !word.is_empty()) {
        *words.entry(word.to_owned()).or_default() += 1;
    }
    words
}

/// Twice the words that both have, over the words of both; of two texts without words it is 1.
fn f1(one: &BTreeMap<String, usize>, other: &BTreeMap<String, usize>) -> f64 {
    let shared: usize =
        one.iter().map(|(word, count)| (*count).min(other.get(word).copied().unwrap_or_default())).sum();
    let all: usize = one.values().sum::<usize>() + other.values().sum::<usize>();
    if all == 0 { 1.0 } else { 2.0 * shared as f64 / all as f64 }
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) = values.fold((0_usize, 0.0), |(count, sum), value| (count + 1, sum + value));
    (count > 0).then(|| sum / count as f64)
}
