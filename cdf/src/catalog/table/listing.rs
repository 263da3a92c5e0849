//! Lists all that the table's files may say of conditions and changes, from the forms by which they are read.

use super::{
    change::{self, Change, SoundKind},
    condition::{self, Term},
};
use crate::{
    action::Status,
    catalog::Property,
    state::{Color, Fluid, StateFlag},
};

/// How a condition is written; words in capitals are those of [`placeholders`]. Before each of them may be `not`.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct ConditionForm {
    /// As files have it, such as `TERM is FLAG`.
    pub text: String,
    /// When it holds.
    pub meaning: &'static str,
}

/// How a change is written; words in capitals are those of [`placeholders`].
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct ChangeForm {
    /// As files have it, such as `set TERM FLAG`.
    pub text: &'static str,
    /// What it does.
    pub meaning: &'static str,
    /// Whether a `press` of a device may have it.
    pub is_of_a_press: bool,
    /// Whether a `work` may have it.
    pub is_of_a_work: bool,
}

/// A word in capitals in the forms of conditions and changes.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Placeholder {
    /// The word.
    pub name: &'static str,
    /// What it stands for.
    pub meaning: &'static str,
    /// What may stand in its place; empty where that is no closed list.
    pub values: Vec<String>,
}

/// All conditions.
pub fn condition_forms() -> impl Iterator<Item = ConditionForm> {
    let of_terms = condition::TESTS.iter().map(|(form, meaning, _)| (format!("TERM {form}"), *meaning));
    let whole = condition::WHOLE.iter().map(|(form, meaning, _)| ((*form).to_owned(), *meaning));
    of_terms.chain(whole).map(|(text, meaning)| ConditionForm { text, meaning })
}

/// All changes.
pub fn change_forms() -> impl Iterator<Item = ChangeForm> {
    let places = placeholders();
    change::FORMS.iter().map(move |&(text, meaning, _)| {
        let example = example(text, &places);
        ChangeForm {
            text,
            meaning,
            is_of_a_press: example.as_ref().is_some_and(Change::is_of_a_press),
            is_of_a_work: example.as_ref().is_some_and(Change::is_of_a_work),
        }
    })
}

/// A change that is written so.
fn example(form: &str, places: &[Placeholder]) -> Option<Change> {
    let filled = |word: &str| match places.iter().find(|place| place.name == word) {
        // A number is read as one, and as the id of a class.
        Some(place) => place.values.first().cloned().unwrap_or_else(|| "1".to_owned()),
        None => word.to_owned(),
    };
    form.split(' ').map(filled).collect::<Vec<_>>().join(" ").parse().ok()
}

/// All words in capitals; `STATUS` stands in `needs`, as the second of three texts.
#[must_use]
pub fn placeholders() -> Vec<Placeholder> {
    let place = |name, meaning, values| Placeholder { name, meaning, values };
    vec![
        place(
            "TERM",
            "It: what the action is done to; held: what is in the hand; holder: what it is in or on; machine: what it works; \
             basin: a sink at hand; thing: each of those that a work is done to",
            Term::ALL.iter().map(|term| term.name().to_owned()).collect(),
        ),
        place("FLAG", "A state that is true or false", StateFlag::ALL.iter().map(|flag| format!("{flag:?}")).collect()),
        place(
            "PROPERTY",
            "What a class affords",
            Property::ALL.iter().map(|property| format!("{property:?}").to_uppercase()).collect(),
        ),
        place("FLUID", "A fluid", Fluid::ALL.iter().map(|fluid| fluid.name().to_owned()).collect()),
        place("COLOR", "A colour", Color::ALL.iter().map(|color| color.name().to_owned()).collect()),
        place("SOUND", "A sound", SoundKind::ALL.iter().map(|kind| format!("{kind:?}")).collect()),
        place("CLASS", "A class; in conditions also all whose ids begin so, such as Floppy_*, or a kind, such as basin", Vec::new()),
        place("N", "The number of a slot", Vec::new()),
        place(
            "STATUS",
            "What is answered where a need does not hold",
            Status::ALL.iter().map(|status| format!("{status:?}")).collect(),
        ),
    ]
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::catalog::table::{Condition, condition::read_word, form::is_place};

    /// The form with each value in the places of its words in capitals.
    fn filled(form: &str) -> Vec<String> {
        let places = placeholders();
        let mut texts = vec![String::new()];
        for word in form.split(' ') {
            let place = places.iter().find(|place| place.name == word);
            assert_eq!(place.is_some(), is_place(word), "{form}: {word}");
            let values = match place {
                None => vec![word.to_owned()],
                Some(place) if place.values.is_empty() => vec!["1".to_owned()],
                Some(place) => place.values.clone(),
            };
            texts = texts.iter().flat_map(|text| values.iter().map(move |value| format!("{text} {value}"))).collect();
        }
        texts
    }

    #[test]
    fn all_that_is_listed_is_read() {
        for form in condition_forms() {
            assert!(!form.meaning.is_empty(), "{}", form.text);
            for text in filled(&form.text) {
                text.parse::<Condition>().unwrap();
                format!("not {text}").parse::<Condition>().unwrap();
            }
        }
        for form in change_forms() {
            assert!(!form.meaning.is_empty(), "{}", form.text);
            for text in filled(form.text) {
                let change: Change = text.parse().unwrap();
                let of = (change.is_of_a_press(), change.is_of_a_work());
                assert_eq!(of, (form.is_of_a_press, form.is_of_a_work), "{text}");
            }
        }
        let places = placeholders();
        let statuses = places.iter().find(|place| place.name == "STATUS").unwrap();
        assert!(statuses.values.iter().all(|status| read_word::<Status>(status).is_some()));
    }
}
