//! What recognisers of speech must know of the language: what is likely to be said, whether a sentence is complete, and
//! whether it says stop.

use std::{collections::BTreeSet, sync::LazyLock};

use cohabit_cdf::{Catalog, ClassId, Property, RoomId};
use serde::Deserialize;

use crate::{
    Language,
    asked::plain,
    context::Context,
    describe,
    known::{Known, KnownObject},
    lexicon::Small,
    tidy,
    token::{self, is_punctuation},
    understanding::{Clarification, Understanding},
};

/// What is likely to be said in a scene.
#[derive(Clone, Debug, Default, Eq, PartialEq)]
pub struct SpokenForms {
    /// All words that are understood, lower case.
    pub words: BTreeSet<String>,
    /// Sentences, lower case and without punctuation; the likelier, the more often one stands here.
    pub sentences: Vec<String>,
}

/// Templates, as in `data/spoken.toml`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Templates {
    plain: Vec<String>,
    joins: Vec<String>,
    form: Vec<Form>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Form {
    of: Kind,
    says: Vec<String>,
}

/// What fills the first slot of a template.
#[derive(Clone, Copy, Deserialize, Eq, PartialEq)]
#[serde(rename_all = "lowercase")]
enum Kind {
    Pickupable,
    Receptacle,
    Openable,
    Toggleable,
    Usable,
    Breakable,
    Dirtyable,
    Heatable,
    Chillable,
    Fillable,
    Room,
}

static TEMPLATES: LazyLock<Templates> = LazyLock::new(|| {
    toml::from_str(include_str!("../data/spoken.toml")).expect("invariant: the built-in table parses, a test loads it")
});

/// A thing is called by at most so many words.
const MOST_NAMES: usize = 4;
/// What can be carried and was not seen may be named too; what is there, so many times as likely.
const SEEN_TIMES: usize = 3;
/// Every so many sentences, two are joined.
const JOINED_EVERY: usize = 7;
/// A step between one pair of thing and place and the next, so that all come together with many.
const STRIDE: usize = 7;

/// Words that say stop wherever they stand, and those that do first, or in few words.
const STOPS: [&str; 3] = ["stop", "halt", "stopp"];
const STOPS_FIRST: [&str; 1] = ["wait"];
const FEW: usize = 4;
/// Says stop alone: with more words it is what the freeze ray does.
const STOPS_ALONE: [&str; 1] = ["freeze"];
/// What before them says the contrary.
const NOT: [&str; 4] = ["not", "dont", "never", "without"];

impl Kind {
    const fn property(self) -> Option<Property> {
        Some(match self {
            Self::Pickupable => Property::Pickupable,
            Self::Receptacle => Property::Receptacle,
            Self::Openable => Property::Openable,
            Self::Toggleable => Property::Toggleable,
            Self::Usable => Property::Usable,
            Self::Breakable => Property::Breakable,
            Self::Dirtyable => Property::Dirtyable,
            Self::Heatable => Property::Heatable,
            Self::Chillable => Property::Chillable,
            Self::Fillable => Property::Fillable,
            Self::Room => return None,
        })
    }
}

/// Whether words heard so far say stop: then it is done at once, whatever else is said. Pure, and quick: it is asked of every
/// piece of what is heard.
#[must_use]
pub fn says_stop(text: &str) -> bool {
    let words: Vec<String> = token::words(text).into_iter().filter(|word| !is_punctuation(word)).collect();
    let is_meant = |at: usize| at == 0 || !NOT.contains(&words[at - 1].as_str());
    words.iter().enumerate().any(|(at, word)| {
        let word = word.as_str();
        let is_first = STOPS_FIRST.contains(&word) && (at == 0 || words.len() <= FEW);
        let is_alone = STOPS_ALONE.contains(&word) && words.len() == 1;
        is_meant(at) && (STOPS.contains(&word) || is_first || is_alone)
    })
}

impl Language {
    /// What is likely to be said of what is in `scene`, and all words that are understood.
    #[must_use]
    pub fn spoken_forms(&self, scene: &Known) -> SpokenForms {
        let Templates { plain, joins, form } = &*TEMPLATES;
        let things = Things::new(self.catalog(), scene);
        let mut sentences: Vec<String> = plain.clone();
        for Form { of, says } in form {
            for (nth, template) in says.iter().enumerate() {
                things.fill(*of, template, nth, &mut sentences);
            }
        }
        let joined: Vec<String> = sentences
            .chunks(JOINED_EVERY)
            .enumerate()
            .filter_map(|(nth, some)| match some {
                [one, .., other] => Some(format!("{one} {} {other}", joins[nth % joins.len()])),
                _ => None,
            })
            .collect();
        sentences.extend(joined);
        let mut words: BTreeSet<String> = self.lexicon.vocabulary.words().map(str::to_owned).collect();
        words.extend(sentences.iter().flat_map(|sentence| token::words(sentence)));
        words.retain(|word| word.chars().all(char::is_alphanumeric));
        SpokenForms { words, sentences }
    }

    /// Whether what was said so far is a whole sentence, after which nothing need be waited for.
    #[must_use]
    pub fn is_whole(&self, text: &str, scene: &Known, context: &Context) -> bool {
        let words: Vec<String> = token::words(text).into_iter().filter(|word| !is_punctuation(word)).collect();
        let Some(last) = words.last() else { return false };
        let one = std::slice::from_ref(last);
        let lexicon = &self.lexicon;
        let goes_on = lexicon.articles.exact(one).is_some()
            || matches!(
                last.as_str(),
                "and" | "then" | "or" | "but" | "my" | "your" | "to" | "from" | "of" | "with" | "into"
            );
        if goes_on {
            return false;
        }
        match self.understand(text, scene, &mut context.clone()) {
            Understanding::Plan { .. } => words.len() > 1 || context.pending.is_some(),
            Understanding::Stop { .. } | Understanding::Answer { .. } => true,
            Understanding::Question { kind, .. } => {
                words.len() > 2 && matches!(kind, Clarification::Reference | Clarification::Confirmation)
            }
            Understanding::Refusal { .. } => false,
        }
    }

    /// Whether a text is a yes, or a no; `None` if it is something else.
    #[must_use]
    pub fn consent(&self, text: &str, scene: &Known) -> Option<bool> {
        let (words, _) = self.lexicon.normalise(text);
        let words = tidy::tidied(&self.lexicon, &words);
        let smalls = self.conversation(scene).small(&plain(&words));
        if smalls.contains(&Small::Yes) {
            return Some(true);
        }
        (smalls.contains(&Small::No) || smalls.contains(&Small::Neither)).then_some(false)
    }
}

/// What slots are filled with: names, each as often as it is likely.
struct Things<'a> {
    catalog: &'a Catalog,
    /// Class and name.
    named: Vec<(ClassId, String)>,
    places: Vec<String>,
    rooms: Vec<String>,
}

impl<'a> Things<'a> {
    fn new(catalog: &'a Catalog, scene: &Known) -> Self {
        let mut named = Vec::new();
        let seen: BTreeSet<ClassId> = scene.objects.iter().map(|object| object.class).collect();
        for _ in 0..SEEN_TIMES {
            named.extend(seen.iter().flat_map(|class| names(catalog, *class)));
        }
        named.extend(scene.objects.iter().filter_map(|object| called_by_color(catalog, scene, object)));
        let others = (0..catalog.classes().len()).filter_map(|index| u16::try_from(index).ok()).map(ClassId);
        let others = others.filter(|class| !seen.contains(class) && catalog.class(*class).has(Property::Pickupable));
        named.extend(others.flat_map(|class| names(catalog, class)));
        let takes = |class: &ClassId| {
            let class = catalog.class(*class);
            class.has(Property::Receptacle) && !class.has(Property::Decor)
        };
        let places: Vec<String> = seen
            .iter()
            .filter(|class| takes(class))
            .flat_map(|class| names(catalog, *class))
            .map(|(_, name)| name)
            .collect();
        let rooms = RoomId::ALL.iter().map(|room| room.name().to_lowercase()).collect();
        Self { catalog, named, places, rooms }
    }

    /// One sentence for each thing of a kind; other slots are filled in turn, beginning elsewhere in each template.
    fn fill(&self, of: Kind, template: &str, nth: usize, sentences: &mut Vec<String>) {
        let Some(property) = of.property() else {
            sentences.extend(self.rooms.iter().map(|room| template.replace("{room}", room)));
            return;
        };
        if template.contains("{place}") && self.places.is_empty() {
            return;
        }
        let fit = self.named.iter().filter(|(class, _)| self.catalog.class(*class).has(property));
        for (at, (_, name)) in fit.enumerate() {
            let turn = at * STRIDE + nth;
            let mut sentence = template.replace("{thing}", name);
            if let Some(place) = self.places.get(turn % self.places.len().max(1)) {
                sentence = sentence.replace("{place}", place);
            }
            sentences.push(sentence.replace("{room}", &self.rooms[turn % self.rooms.len()]));
        }
    }
}

/// What people call a class, the most usual first.
fn names(catalog: &Catalog, class: ClassId) -> Vec<(ClassId, String)> {
    let own = describe::name(catalog, class).to_lowercase();
    let words = catalog.class(class).words.iter().filter(|word| **word != own).take(MOST_NAMES - 1).cloned();
    std::iter::once(own.clone()).chain(words).map(|name| (class, name)).collect()
}

/// `red mug`, where somebody gave it that colour, or there is another that looks otherwise.
fn called_by_color(catalog: &Catalog, scene: &Known, object: &KnownObject) -> Option<(ClassId, String)> {
    let color = describe::color(catalog, object);
    let bare = describe::bare(catalog, scene, object.id);
    let is_told = object.in_mission || bare.starts_with(&color);
    (is_told && !color.is_empty()).then(|| {
        let name = describe::name(catalog, object.class).to_lowercase();
        (object.class, if name.contains(&color) { name } else { format!("{color} {name}") })
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::known::KnownRobot;

    fn language() -> Language {
        Language::new(Arc::new(Catalog::builtin()))
    }

    fn scene() -> Known {
        let robot = KnownRobot { position_m: [0.0; 3], yaw_rad: 0.0, room: RoomId::BreakRoom, held: None };
        Known { robot, objects: vec![], goals: vec![], floor: None, person: None }
    }

    #[test]
    fn stop_is_heard_wherever_it_stands() {
        let check = |text: &str, expected: bool| assert_eq!(says_stop(text), expected, "{text}");
        check("Stop!", true);
        check("no, stop, not there", true);
        check("go to the kitchen and stop", true);
        check("Halt.", true);
        check("wait", true);
        check("Wait a moment", true);
        check("hey wait", true);
        check("freeze", true);
        check("go to the break room and wait", false);
        check("freeze the apple", false);
        check("the kitchen where people wait is nice", false);
        check("don't stop", false);
        check("do not stop", false);
        check("the stopper", false);
        check("", false);
    }

    #[test]
    fn all_that_is_likely_to_be_said_has_a_meaning_and_known_words() {
        let (language, scene) = (language(), scene());
        let forms = language.spoken_forms(&scene);
        assert!(forms.sentences.contains(&"go to the break room".to_owned()));
        assert!(forms.sentences.contains(&"pick up the bowl".to_owned()));
        for sentence in &forms.sentences {
            assert!(!sentence.contains('{'), "{sentence}");
            let words = token::words(sentence);
            assert!(
                words.iter().all(|word| forms.words.contains(word) || !word.chars().all(char::is_alphanumeric)),
                "{sentence}"
            );
        }
        for sentence in &TEMPLATES.plain {
            let meant = language.understand(sentence, &scene, &mut Context::default());
            assert!(!matches!(meant, Understanding::Refusal { is_lost: true, .. }), "{sentence}: {meant:?}");
        }
    }

    #[test]
    fn a_sentence_is_whole_or_goes_on() {
        let (language, scene) = (language(), scene());
        let check = |text: &str, expected: bool| {
            assert_eq!(language.is_whole(text, &scene, &Context::default()), expected, "{text}");
        };
        check("go to the break room", true);
        check("go to the", false);
        check("go to the break room and", false);
        check("pick up", false);
        check("turn left", true);
        check("stop", true);
        check("what is left?", true);
        check("", false);
    }

    #[test]
    fn yes_and_no_are_told_from_all_else() {
        let (language, scene) = (language(), scene());
        assert_eq!(language.consent("Yes, please.", &scene), Some(true));
        assert_eq!(language.consent("no", &scene), Some(false));
        assert_eq!(language.consent("go to the break room", &scene), None);
    }
}
