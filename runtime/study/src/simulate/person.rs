//! One simulated person: what they do, and what they answer.

use cohabit_dialog::{Form, Given, Item, Scale};
use cohabit_tables::Chance;

use super::people::{People, Shift};
use crate::{
    chance::{Purpose, chance},
    design::{Choice, Study},
};

/// A simulated person.
#[derive(Clone, Debug)]
pub(crate) struct Person<'a> {
    people: &'a People,
    seed: u64,
    /// Which of those who come, from 1.
    number: u32,
    /// Whether they consent.
    pub consents: bool,
    /// How they leave, and after which share of their steps.
    leaves: Option<(Leaves, f64)>,
    /// How fast they are: how long they take for something, as a multiple of what is usual.
    pace: f64,
}

/// How somebody leaves.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Leaves {
    Withdraws,
    Stops,
    IsExcluded,
}

/// Numbers of draws beyond those of steps: what somebody tends to in each questionnaire, how they speak in each mission, and how
/// they come.
const DISPOSITIONS: usize = 1 << 20;
const SPEAKERS: usize = 1 << 21;
const COMING: usize = 1 << 22;

/// How long people read and answer an item on average, s.
const ITEM_S: f64 = 6.0;
/// The standard deviation of the logarithm of people's pace: a third of them is slower or faster by a fifth or more.
const PACE_SD: f64 = 0.2;

impl<'a> Person<'a> {
    /// The person of that number. The same seed makes the same person.
    pub fn new(people: &'a People, seed: u64, number: u32) -> Self {
        let mut drawn = chance(seed, Purpose::Person, u64::from(number));
        let leaving = &people.leaving;
        let consents = !drawn.is(leaving.declines);
        let (share, after) = (drawn.share(), drawn.share());
        let ends = [
            (leaving.withdraws, Leaves::Withdraws),
            (leaving.stops, Leaves::Stops),
            (leaving.excluded, Leaves::IsExcluded),
        ];
        let mut below = 0.0;
        let leaves = ends.into_iter().find_map(|(own, how)| {
            below += own;
            (share < below).then_some((how, after))
        });
        Self { people, seed, number, consents, leaves, pace: (PACE_SD * drawn.normal()).exp() }
    }

    /// How they leave at a step, of so many, if they do.
    pub fn leaves_at(&self, step: usize, steps: usize) -> Option<Leaves> {
        let (how, after) = self.leaves?;
        (step == (after * steps as f64) as usize).then_some(how)
    }

    /// Draws for how they come: by which link, and which boxes of the consent form they tick.
    pub fn coming(&self) -> Chance {
        self.draws(COMING)
    }

    /// Draws for one step of theirs, or for something else, by a number beyond those of steps.
    fn draws(&self, step: usize) -> Chance {
        chance(self.seed, Purpose::Answers, u64::from(self.number) << 24 | (step as u64 + 1))
    }

    /// Whether they give a mission up halfway.
    pub fn gives_up(&self, step: usize) -> bool {
        self.draws(step).is(self.people.leaving.gives_up)
    }

    /// The seed of how they speak in a mission.
    pub fn speaker(&self, step: usize) -> u64 {
        self.draws(SPEAKERS + step).seed()
    }

    /// How long they take for a line to the robot, s.
    pub fn line_s(&self) -> f64 {
        self.people.speaking.line_s * self.pace
    }

    /// How long they take for so many questions, s.
    pub fn answering_s(&self, items: usize) -> f64 {
        ITEM_S * self.pace * items as f64
    }

    /// What they answer to a questionnaire at a step, under these levels.
    pub fn answers(&self, study: &Study, name: &str, step: usize, under: &[Choice]) -> Vec<Option<Given>> {
        let items = study.questionnaire(name).map_or(&[][..], |asked| asked.items.as_slice());
        let right = |item: usize| study.instrument(name).and_then(|known| known.attention.get(&item).copied());
        let which = study.questionnaires.iter().position(|one| one.name == name).unwrap_or(0);
        // Of their own for each questionnaire, wherever it is asked.
        let own = self.draws(DISPOSITIONS + which).normal();
        let People { answering, effects, .. } = self.people;
        let is_of = |effect: &&Shift| {
            let is_asked = effect.questionnaire.as_ref().is_none_or(|one| one == name);
            is_asked && under.iter().any(|choice| choice.factor == effect.factor && choice.level == effect.level)
        };
        let shift: f64 = effects.iter().filter(is_of).map(|effect| effect.shift).sum();
        let measured = answering.mean + answering.participant_sd * own + shift;
        let mut drawn = self.draws(step);
        items.iter().enumerate().map(|(number, item)| self.answer(item, right(number), measured, &mut drawn)).collect()
    }

    fn answer(&self, item: &Item, right: Option<i32>, measured: f64, drawn: &mut Chance) -> Option<Given> {
        // Drawn whatever the item is, so that another form of one changes no others.
        let (omitted, residual, any) = (drawn.share(), drawn.normal(), drawn.seed());
        let answering = &self.people.answering;
        if let Some(right) = right.filter(|_| omitted >= answering.careless) {
            return Some(Given::Value(right));
        }
        if item.optional && omitted < answering.omits {
            return None;
        }
        Some(match &item.form {
            Form::Scale(scale) => {
                let part = (measured + answering.residual_sd * residual).clamp(0.0, 1.0);
                Given::Value(place(scale, if item.reversed { 1.0 - part } else { part }))
            }
            Form::Choice(choices) => Given::Value(1 + (any % choices.len().max(1) as u64) as i32),
            Form::Words(_) => Given::Text("(a simulated person's answer)".to_owned()),
        })
    }
}

/// The number of a scale that is so far from its lowest, as a part of its length.
fn place(scale: &Scale, part: f64) -> i32 {
    let places = f64::from((scale.most - scale.least) / scale.step);
    scale.least + scale.step * (part * places).round() as i32
}

#[cfg(test)]
mod tests {
    use cohabit_dialog::{Questionnaire, When};

    use super::*;

    /// A study that asks one question.
    fn study(reversed: bool) -> Study {
        let scale = Scale { least: 0, most: 100, step: 5, left: String::new(), right: String::new() };
        let item = Item { ask: "How?".to_owned(), form: Form::Scale(scale), optional: false, reversed };
        let (name, text) = ("one".to_owned(), String::new());
        let asked = Questionnaire { name, title: text.clone(), about: text, when: When::After, items: vec![item] };
        Study { questionnaires: vec![asked], ..Study::default() }
    }

    /// The mean answer of 400 people, from 0 to 100.
    fn mean(people: &People, reversed: bool, under: &[Choice]) -> f64 {
        let study = study(reversed);
        let answers = (1..=400).map(|number| {
            let person = Person::new(people, 3, number);
            match person.answers(&study, "one", 2, under).first() {
                Some(Some(Given::Value(value))) => f64::from(*value),
                other => panic!("{other:?} is no place on a scale"),
            }
        });
        answers.sum::<f64>() / 400.0
    }

    #[test]
    fn answers_have_the_means_that_were_set() {
        let mut people = People::default();
        let always = [Choice { factor: "ask".to_owned(), level: "always".to_owned() }];
        let shift = Shift { factor: "ask".to_owned(), level: "always".to_owned(), questionnaire: None, shift: -0.2 };
        people.effects.push(shift);
        // Four standard errors of a mean of 400.
        let near = |found: f64, wanted: f64| assert!((found - wanted).abs() < 4.0, "{found} is not {wanted}");
        near(mean(&people, false, &[]), 60.0);
        near(mean(&people, true, &[]), 40.0);
        near(mean(&people, false, &always), 40.0);
        assert!((mean(&people, false, &[]) - mean(&people, false, &[])).abs() < f64::EPSILON);
    }

    #[test]
    fn people_leave_as_often_as_they_are_to() {
        let mut people = People::default();
        (people.leaving.withdraws, people.leaving.stops, people.leaving.excluded) = (0.2, 0.3, 0.1);
        let left = |how: Leaves| {
            let of =
                |number: u32| (0..8).find_map(|step| Person::new(&people, 1, number).leaves_at(step, 8)) == Some(how);
            (1..=1000).filter(|number| of(*number)).count()
        };
        for (how, wanted) in [(Leaves::Withdraws, 200), (Leaves::Stops, 300), (Leaves::IsExcluded, 100)] {
            assert!(left(how).abs_diff(wanted) < 60, "{how:?}: {}", left(how));
        }
    }
}
