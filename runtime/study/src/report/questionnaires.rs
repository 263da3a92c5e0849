//! What participants were asked, where it is from, and how it is scored.

use cohabit_dialog::{Form, Questionnaire};

use super::{Known, counted, listed};
use crate::{
    instrument::{Instrument, Score, Scoring},
    plan::Step,
};

pub(super) fn section(known: &Known<'_>) -> String {
    let study = &known.records.study;
    if study.questionnaires.is_empty() {
        return "Nothing was asked.".to_owned();
    }
    let none = Instrument::default();
    let one = |asked: &Questionnaire| paragraph(known, asked, study.instrument(&asked.name).unwrap_or(&none));
    study.questionnaires.iter().map(one).collect::<Vec<_>>().join("\n")
}

fn paragraph(known: &Known<'_>, asked: &Questionnaire, instrument: &Instrument) -> String {
    let reversed = asked.items.iter().enumerate().filter(|(_, item)| item.reversed);
    let reversed: Vec<String> = reversed.map(|(number, _)| (number + 1).to_string()).collect();
    let words = asked.items.iter().filter(|item| matches!(item.form, Form::Words(_))).count();
    let mut text = format!("- `{}`: {}", asked.name, counted(asked.items.len(), "item"));
    if !reversed.is_empty() {
        text += &format!(", {} reversed", listed(&reversed));
    }
    if words > 0 {
        text += &format!(", {words} answered in words");
    }
    let score = |score: &Score| format!("`{}`, {} of items ({})", score.name, how(score.of), score.meaning);
    let scores: Vec<String> = instrument.scores.iter().map(score).collect();
    text += &match scores.as_slice() {
        [] => ". Not scored.".to_owned(),
        scores => format!(". Scores: {}.", listed(scores)),
    };
    if !instrument.attention.is_empty() {
        let (failed, answered) = checks(known, &asked.name, instrument);
        text += &format!(
            " {}, failed in {failed} of {answered} answers to it.",
            counted(instrument.attention.len(), "attention check")
        );
    }
    text += &match &instrument.citation {
        Some(citation) => format!(" {citation}"),
        None => " Where it is from: **missing, add `citation` to its file**.".to_owned(),
    };
    if let Some(licence) = &instrument.licence {
        text += &format!(" Licence: {licence}.");
    }
    text
}

const fn how(scoring: Scoring) -> &'static str {
    match scoring {
        Scoring::Mean => "the mean",
        Scoring::Sum => "the sum",
        Scoring::Percent => "the mean, 0 to 100,",
        Scoring::Weighted => "the weighted mean, 0 to 100,",
    }
}

/// How often a questionnaire was answered with an attention check failed, and how often it was answered.
fn checks(known: &Known<'_>, name: &str, instrument: &Instrument) -> (usize, usize) {
    let all = known.records.progress.iter().flat_map(|progress| {
        let is_it = |step: usize| matches!(progress.plan().steps.get(step), Some(Step::Questionnaire { name: own, .. }) if own == name);
        progress.done().iter().filter(move |done| is_it(done.step))
    });
    let fails = |given: &[Option<cohabit_dialog::Given>]| {
        let fails = |(item, given): (usize, &Option<_>)| instrument.is_attentive(item, given.as_ref()) == Some(false);
        given.iter().enumerate().any(fails)
    };
    all.fold((0, 0), |(failed, answered), done| (failed + usize::from(fails(&done.answers)), answered + 1))
}
