//! What recognisers of speech must know of the language: what there is to speak of, whether a sentence is complete, and
//! whether it says stop.

use std::{collections::BTreeSet, sync::Arc};

use cohabit_cdf::Property;

use crate::{
    Language,
    context::Context,
    known::Known,
    read::tidy::{self, plain},
    stop,
    understanding::{Clarification, Understanding},
    words::{
        lexicon::Small,
        token::{self, is_punctuation},
    },
};

/// What there is to speak of, by all the names that people have for it, in small letters.
#[derive(Clone, Debug, Default, Eq, PartialEq)]
pub struct SpokenNames {
    /// What can be taken.
    pub things: BTreeSet<String>,
    /// All other things.
    pub places: BTreeSet<String>,
    /// Rooms.
    pub rooms: BTreeSet<String>,
    /// All other words that the robot knows.
    pub words: Arc<BTreeSet<String>>,
}

/// Whether words heard so far say stop: then it is done at once, whatever else is said. Pure, and quick: it is asked of every
/// piece of what is heard.
#[must_use]
pub fn says_stop(text: &str) -> bool {
    stop::find_stop(text).is_some()
}

/// The same of what was heard in the midst of speech, which goes on: "wait" may yet become "where is", and "freeze" is said
/// of things, too.
#[must_use]
pub fn says_stop_already(text: &str) -> bool {
    stop::find_stop(text).is_some_and(|stop| stop.is_plain)
}

fn plain_words(text: &str) -> Vec<String> {
    token::words(text).into_iter().filter(|word| !is_punctuation(word)).collect()
}

impl Language {
    /// What there is to speak of in `scene`.
    #[must_use]
    pub fn spoken_names(&self, scene: &Known) -> SpokenNames {
        let mut names = SpokenNames::default();
        let classes: BTreeSet<_> = scene.objects.iter().map(|object| object.class).collect();
        for class in classes.into_iter().map(|class| self.catalog().class(class)) {
            let into = if class.has(Property::Pickupable) { &mut names.things } else { &mut names.places };
            into.extend(std::iter::once(&class.name).chain(&class.words).map(|name| name.to_lowercase()));
        }
        names.rooms = scene.room_names(&self.catalog).map(str::to_lowercase).collect();
        names.words = Arc::clone(&self.lexicon.known);
        names
    }

    /// Whether what was said so far is a whole sentence, after which nothing need be waited for.
    #[must_use]
    pub fn is_whole(&self, text: &str, scene: &Known, context: &Context) -> bool {
        let words = plain_words(text);
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
        match self.clone().without_rewriter().understand(text, scene, &mut context.clone()) {
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

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::sync::Arc;

    use cohabit_cdf::{Catalog, ObjectId, RoomId};

    use super::*;
    use crate::known::{KnownObject, KnownRobot};

    fn language() -> Language {
        Language::new(Arc::new(Catalog::builtin()))
    }

    fn scene() -> Known {
        let robot = KnownRobot { position_m: [0.0; 3], yaw_rad: 0.0, room: RoomId::BREAK_ROOM, held: None };
        Known::new(robot, vec![])
    }

    #[test]
    fn stop_is_heard_wherever_it_stands() {
        let check = |text: &str, expected: bool| assert_eq!(says_stop(text), expected, "{text}");
        check("Stop!", true);
        check("no, stop, not there", true);
        check("go to the kitchen and stop", false);
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
    fn what_may_yet_become_another_word_does_not_say_stop_already() {
        let check = |text: &str, expected: bool| assert_eq!(says_stop_already(text), expected, "{text}");
        check("Please stop", true);
        check("halt", true);
        check("Wait 'em", false);
        check("freeze", false);
        check("wait, don't stop", false);
        check("", false);
    }

    #[test]
    fn things_are_spoken_of_by_all_their_names() {
        let language = language();
        let thing = |class: &str| {
            let class = language.catalog().find(class).unwrap();
            let object = KnownObject::new(ObjectId(1), String::new(), class, RoomId::BREAK_ROOM, [0.0; 3]);
            KnownObject { visible: true, ..object }
        };
        let scene = Known { objects: vec![thing("Bowl_01"), thing("FridgeLower_02"), thing("Bowl_01")], ..scene() };
        let names = language.spoken_names(&scene);
        assert!(names.things.contains("bowl") && !names.places.contains("bowl"), "{names:?}");
        assert!(names.places.contains("fridge") && names.places.contains("refrigerator"), "{names:?}");
        assert!(names.rooms.contains("break room"), "{names:?}");
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
