//! Whatever is typed, in whatever scene: an understanding, never a panic, and always the same one.

use crate::support::{Talk, catalog, scene};
use cohabit_cdf::Status;
use cohabit_language::{Context, Language, Understanding};
use proptest::prelude::*;

/// Words that mean something, to be put together in any order.
const WORDS: &str = "pick up put down the a it mug bowl red yellow on in into from to next with and then , . ? go room break lab 1 2 \
    left right turn forward meters degrees open close fridge microwave heat clean fill water milk pour table desk hammer \
    break one other all second where is what are you holding stop yes no do not use print make green computer laser viewpoint \
    there here them of that which Lab1_3 Bowl_01_1 half couple around behind full broken any again";

fn jumble() -> impl Strategy<Value = String> {
    let words: Vec<&'static str> = WORDS.split_whitespace().collect();
    prop::collection::vec(prop::sample::select(words), 0..24).prop_map(|words| words.join(" "))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn arbitrary_text_never_panics(text in any::<String>()) {
        let _ = Talk::new(&[]).say(&text);
    }
}

// Most of these are rewritten, which takes a while.
proptest! {
    #![proptest_config(ProptestConfig { cases: 25, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn jumbled_words_never_panic(first in jumble(), second in jumble(), third in jumble()) {
        let mut talk = Talk::new(&["held Bowl_01_1"]);
        let said = [talk.say(&first), talk.say(&second), talk.say(&third)];
        let mut again = Talk::new(&["held Bowl_01_1"]);
        prop_assert_eq!(said, [again.say(&first), again.say(&second), again.say(&third)]);
    }

    #[test]
    fn every_outcome_can_be_reported(text in jumble(), answer in jumble(), status in 0_usize..20) {
        let mut talk = Talk::new(&[]);
        if let Understanding::Plan { steps, reply } = talk.language.understand(&text, &talk.scene, &mut talk.context) {
            prop_assert!(!steps.is_empty() && !reply.is_empty());
            let status = STATUSES[status];
            talk.context.note_outcome(&steps[0], status);
            prop_assert!(!talk.language.report(&steps[0], status, "", &talk.scene).is_empty());
            let _ = talk.say("yes");
        }
        let _ = talk.say(&answer);
    }
}

const STATUSES: [Status; 20] = [
    Status::ActionSuccessful,
    Status::UnsupportedAction,
    Status::UnsupportedNavigation,
    Status::AlreadyHoldingObject,
    Status::ReceptacleIsFull,
    Status::ReceptacleIsClosed,
    Status::TargetInaccessible,
    Status::KilledByHazard,
    Status::TargetOutOfRange,
    Status::AlternateNavigationUsed,
    Status::ObjectUnpowered,
    Status::ObjectOverloaded,
    Status::InvalidCommand,
    Status::ObjectNotPickedUp,
    Status::ArenaUnavailable,
    Status::IncorrectActionFormat,
    Status::InvalidObjectClass,
    Status::ActionExecutionError,
    Status::PostProcessError,
    Status::Interrupted,
];

#[test]
fn long_and_strange_texts_are_refused_politely() {
    let catalog = catalog();
    let language = Language::new(catalog.clone());
    let known = scene(&catalog, &[]);
    for text in
        ["a ".repeat(5_000), "pick up the mug ".repeat(700), "\u{1b}[31m\u{0}\u{7f}".to_owned(), "🤖🤖🤖".to_owned()]
    {
        let understanding = language.understand(&text, &known, &mut Context::default());
        let is_polite = matches!(understanding, Understanding::Refusal { .. } | Understanding::Question { .. });
        assert!(is_polite, "{text:.40}: {understanding:?}");
    }
}

#[test]
fn an_empty_world_is_no_trouble() {
    let catalog = catalog();
    let language = Language::new(catalog.clone());
    let mut known = scene(&catalog, &[]);
    known.objects.clear();
    known.goals.clear();
    let texts = [
        "pick up the mug",
        "heat the mug",
        "make coffee",
        "where is the mug",
        "what do you see",
        "drop it",
        "open it",
        "break it with the hammer",
    ];
    for text in texts {
        let understanding = language.understand(text, &known, &mut Context::default());
        assert!(!matches!(understanding, Understanding::Plan { .. }), "{text}: {understanding:?}");
    }
}
