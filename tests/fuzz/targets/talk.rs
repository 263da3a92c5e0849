//! Any text that people type, line by line in one conversation: the robot always has an answer, the same one each time.

#![no_main]

use std::sync::{Arc, LazyLock};

use cohabit_cdf::{Catalog, Layout, RoomId};
use cohabit_language::{Context, Floor, FloorPlan, Known, KnownObject, KnownRobot, Language, Understanding};
use libfuzzer_sys::fuzz_target;

/// So many lines are one conversation.
const LINES: usize = 6;

/// A search goes on for so many legs before the next line.
const LEGS: usize = 3;

/// A furnished office, to who has seen all of it.
static OFFICE: LazyLock<(Language, Known)> = LazyLock::new(|| {
    let catalog = Arc::new(Catalog::builtin());
    let layout = Layout::builtin("OfficeLayout1").expect("the project's own floor plan");
    let objects = KnownObject::furniture(&catalog, &layout);
    let robot = KnownRobot { position_m: [8.0, 11.5, 0.0], yaw_rad: 0.0, room: RoomId::BREAK_ROOM, held: None };
    let floor = Some(Floor::new(Arc::new(FloorPlan::new(&layout))));
    let (mission, goals, rooms) = (String::new(), Vec::new(), Vec::new());
    (Language::new(catalog), Known { robot, objects, mission, goals, rooms, floor, person: None })
});

fuzz_target!(|text: &str| {
    let (language, known) = &*OFFICE;
    let [mut context, mut again] = [Context::default(), Context::default()];
    for line in text.lines().take(LINES) {
        let understanding = language.understand(line, known, &mut context);
        check(&understanding);
        assert_eq!(understanding, language.understand(line, known, &mut again));
        for _ in 0..LEGS {
            let next = language.carry_on(known, &mut context);
            assert_eq!(next, language.carry_on(known, &mut again));
        }
    }
});

fn check(understanding: &Understanding) {
    let says = match understanding {
        Understanding::Plan { steps, reply } => {
            assert!(!steps.is_empty());
            reply
        }
        Understanding::Question { text, .. }
        | Understanding::Answer { text, .. }
        | Understanding::Refusal { text, .. } => text,
        Understanding::Stop { reply, .. } => reply,
    };
    assert!(!says.is_empty());
}
