//! The table of answers to questionnaires, and what they amount to.

use std::collections::{BTreeMap, BTreeSet};

use cohabit_record::AnswerEntry;

use crate::{
    played::{Played, seconds},
    table::{
        Cell, Field,
        Kind::{Flag, Real, Text, Whole},
        Table,
    },
};

const FIELDS: [Field; 13] = [
    Field::new("session", Text, "", "the session, as in the table of sessions"),
    Field::new("participant", Text, "", "what the participant is called in the study, or the pair that plays together"),
    Field::new("person", Whole, "", "the number of the person's page, as in the table of turns"),
    Field::new("questionnaire", Text, "", "the questionnaire"),
    Field::new("item", Whole, "", "which of its questions, from 1"),
    Field::new("question", Text, "", "what was asked"),
    Field::new("kind", Text, "", "how it was answered: on a Scale, by a Choice, or in Words"),
    Field::new("value", Whole, "", "the number on the scale, or that of the choice, from 1"),
    Field::new("least", Whole, "", "the scale's lowest number"),
    Field::new("most", Whole, "", "the scale's highest number"),
    Field::new("reversed", Flag, "", "whether a high number means little of what the questionnaire measures"),
    Field::new("text", Text, "", "the words, or what was chosen says"),
    Field::new("tick_s", Real, "s", "simulated time at which it was answered"),
];

/// All answers of these sessions; of several to one question by one person the first, which the page's server took.
pub fn table(played: &[Played]) -> Table {
    let rows =
        played.iter().flat_map(|played| first(&played.log.answers).into_values().map(|entry| row(played, entry)));
    Table {
        name: "questionnaires",
        meaning: "a person's answer to a question of a questionnaire",
        fields: FIELDS.into(),
        rows: rows.collect(),
    }
}

/// By person, questionnaire and question.
fn first(answers: &[AnswerEntry]) -> BTreeMap<(u32, &str, u32), &AnswerEntry> {
    let keyed = answers.iter().map(|entry| ((entry.person, entry.questionnaire.as_str(), entry.item), entry));
    // Of equal keys the last one stays.
    keyed.rev().collect()
}

fn row(played: &Played, entry: &AnswerEntry) -> Vec<Cell> {
    vec![
        Cell::text(&played.name),
        Cell::maybe(played.log.session.participant.as_ref(), Cell::text),
        Cell::whole(entry.person),
        Cell::text(&entry.questionnaire),
        Cell::whole(entry.item),
        Cell::text(&entry.question),
        Cell::text(&entry.kind),
        Cell::maybe(entry.value, Cell::whole),
        Cell::maybe(entry.scale, |[least, _]| Cell::whole(least)),
        Cell::maybe(entry.scale, |[_, most]| Cell::whole(most)),
        Cell::maybe(entry.scale, |_| Cell::Flag(entry.reversed)),
        Cell::text(&entry.text),
        Cell::Real(seconds(entry.tick)),
    ]
}

/// The questionnaires of these sessions that have scales.
pub fn scored(played: &[Played]) -> BTreeSet<&str> {
    let answers = played.iter().flat_map(|played| &played.log.answers);
    answers.filter(|entry| entry.scale.is_some()).map(|entry| entry.questionnaire.as_str()).collect()
}

impl Played {
    /// What a questionnaire's scales amount to, 0 to 100: their mean, each as a part of its scale, from its other end if
    /// it is reversed; over several persons their mean. So the System Usability Scale and the NASA Task Load Index without
    /// weights are scored.
    pub(crate) fn score(&self, questionnaire: &str) -> Option<f64> {
        let mut persons = BTreeMap::<u32, Vec<f64>>::new();
        for ((person, name, _), entry) in first(&self.log.answers) {
            if let (true, Some(part)) = (name == questionnaire, part(entry)) {
                persons.entry(person).or_default().push(part);
            }
        }
        let means: Vec<f64> = persons.values().map(|parts| mean(parts)).collect();
        (!means.is_empty()).then(|| 100.0 * mean(&means))
    }
}

fn part(entry: &AnswerEntry) -> Option<f64> {
    let ([least, most], value) = (entry.scale?, entry.value?);
    let length = f64::from(most) - f64::from(least);
    let part = (f64::from(value) - f64::from(least)) / length;
    (length > 0.0).then_some(if entry.reversed { 1.0 - part } else { part })
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}
