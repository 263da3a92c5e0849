//! What is said goes in, what follows comes out.

use std::sync::Arc;

use cohabit_bus::message::{BodyRecord, NONE, ObjectRecord, StateParts, StateView};
use cohabit_cdf::{BodyId, Catalog, Layout, RoomId};
use cohabit_language::Knows;
use cohabit_speech::Recognition;

use super::*;
use crate::spoken::Spoken;

/// What a robot knows that stands in an empty break room.
pub(super) fn knowledge() -> Knowledge {
    knowledge_with(&[])
}

/// The same of a break room with things of these classes, a metre before the robot.
fn knowledge_with(classes: &[&str]) -> Knowledge {
    let (catalog, layout) = (Arc::new(Catalog::builtin()), Layout::builtin("OfficeLayout1").unwrap());
    let room = RoomId::BUILTIN.iter().position(|room| *room == RoomId::BREAK_ROOM).unwrap() as u32;
    let body = BodyRecord { room, held: NONE, position_m: [4.0, 10.0, 0.0], ..BodyRecord::default() };
    let thing = |(object, class): (u32, &&str)| ObjectRecord {
        object,
        class: catalog.find(class).unwrap().0,
        room: room as u8,
        parent: NONE,
        held_by: NONE,
        works: NONE,
        position_m: [5.0, 10.0, 0.0],
        rotation: [0.0, 0.0, 0.0, 1.0],
        ..ObjectRecord::default()
    };
    let objects = (0..).zip(classes).map(thing).collect();
    let parts = StateParts { bodies: vec![body], objects, ..StateParts::default() };
    let mut bytes = vec![0_u64; parts.bytes().div_ceil(8)];
    let bytes = &mut bytemuck::cast_slice_mut(&mut bytes)[..parts.bytes()];
    parts.write(bytes);
    let mut knowledge = Knowledge::new(Knows::Everything, catalog, &layout, BodyId(0));
    knowledge.look(StateView::new(bytes).unwrap(), 1);
    knowledge
}

pub(super) fn conversation() -> Conversation {
    Conversation::new(Language::new(Arc::new(Catalog::builtin())), 0)
}

pub(super) fn says(outbox: &[Outgoing]) -> String {
    let lines = outbox.iter().filter_map(Outgoing::line).filter(|line| line.from == Speaker::Robot);
    lines.map(|line| line.text.clone()).collect::<Vec<_>>().join(" ")
}

pub(super) fn plans(outbox: &[Outgoing]) -> bool {
    outbox.iter().any(|item| matches!(item, Outgoing::Plan { .. }))
}

const DOUBTED: Aloud<'_> = Aloud { raw: "go to the main office", is_doubtful: true };

#[test]
fn what_is_doubted_is_asked_about_and_a_yes_means_it() {
    let (mut conversation, knowledge) = (conversation(), knowledge());
    let said = "go to the main office";
    let (_, outbox) = conversation.hear_aloud(said, said, DOUBTED, 0, &knowledge);
    assert!(!plans(&outbox));
    assert!(says(&outbox).contains("\"go to the main office\". Shall I do that?"), "{}", says(&outbox));
    let question = outbox.iter().filter_map(Outgoing::line).find(|line| line.kind == LineKind::Question).unwrap();
    assert_eq!(question.answers.iter().map(|answer| answer.text.as_str()).collect::<Vec<_>>(), ["yes", "no"]);
    // A yes that is heard makes sense, though no question of the language's waits for it.
    let yes = Spoken { heard: Recognition::trusted("yes", 0.3), ..Spoken::default() };
    let reading = conversation.reading(&yes, &str::to_owned, &knowledge).unwrap();
    assert!(!reading.is_doubtful);
    let (_, outbox) = conversation.hear("yes", &knowledge);
    assert!(plans(&outbox), "{}", says(&outbox));
}

#[test]
fn what_was_not_said_is_not_done() {
    let (mut conversation, knowledge) = (conversation(), knowledge());
    let said = "go to the main office";
    conversation.hear_aloud(said, said, DOUBTED, 0, &knowledge);
    let (_, outbox) = conversation.hear("no", &knowledge);
    assert!(!plans(&outbox) && says(&outbox).contains("once more"), "{}", says(&outbox));
    // Nor later.
    let (_, outbox) = conversation.hear("yes", &knowledge);
    assert!(!plans(&outbox), "{}", says(&outbox));
    // Something else is what it is.
    conversation.hear_aloud(said, said, DOUBTED, 0, &knowledge);
    let (_, outbox) = conversation.hear("go to the reception", &knowledge);
    assert!(plans(&outbox) && says(&outbox).contains("reception"), "{}", says(&outbox));
}

#[test]
fn a_stop_is_carried_out_before_what_else_was_said() {
    let (mut conversation, knowledge) = (conversation(), knowledge());
    let actions = |outbox: &[Outgoing]| -> Vec<Vec<Action>> {
        let plans = outbox.iter().filter_map(|item| match item {
            Outgoing::Plan { steps, .. } => Some(steps.iter().map(|step| step.action).collect()),
            _ => None,
        });
        plans.collect()
    };
    conversation.hear("go to the main office", &knowledge);
    let (_, outbox) = conversation.hear("Arre stop stop, go to the reception", &knowledge);
    let [steps] = &actions(&outbox)[..] else { panic!("one plan: {outbox:?}") };
    assert!(matches!(steps[..], [Action::Stop, Action::GoTo { .. }]), "{steps:?}");
    assert!(says(&outbox).starts_with("OK, I stop. OK, going to the reception"), "{}", says(&outbox));
    // What asks for no motion does not keep it from stopping.
    conversation.hear("go to the main office", &knowledge);
    let (_, outbox) = conversation.hear("stop! what are you holding?", &knowledge);
    assert_eq!(actions(&outbox), [[Action::Stop]]);
    assert_eq!(says(&outbox), "OK, I stop. My hand is empty.");
    let ends = outbox.iter().filter(|item| matches!(item, Outgoing::TurnEnded { .. })).count();
    assert_eq!(ends, 1);
}

#[test]
fn a_question_meanwhile_ends_nothing_that_the_robot_is_at() {
    let (mut conversation, knowledge) = (conversation(), knowledge_with(&["Bowl_01"]));
    let (_, outbox) = conversation.hear("where is the bowl?", &knowledge);
    assert!(plans(&outbox) && says(&outbox).contains("bowl"), "at rest it points: {}", says(&outbox));
    let (_, outbox) = conversation.hear("go to the main office", &knowledge);
    assert!(plans(&outbox));
    let (turn, outbox) = conversation.hear("where is the bowl?", &knowledge);
    assert!(!plans(&outbox) && says(&outbox).contains("bowl"), "{}", says(&outbox));
    assert!(outbox.contains(&Outgoing::TurnEnded { turn, end: TurnEnd::Answered }));
}

#[test]
fn who_acts_on_its_own_says_so_and_answers() {
    let knowledge = knowledge_with(&["Bowl_01"]);
    let mut conversation = conversation().alone(true);
    let later = "wait 10 seconds, then go to the main office";
    for told in ["go to the main office", "stop", "stop, and go to the reception", later] {
        let (turn, outbox) = conversation.hear(told, &knowledge);
        assert_eq!(says(&outbox), alone::ALONE, "{told}");
        assert!(!plans(&outbox) && !conversation.awaits(), "{told}: {outbox:?}");
        assert!(outbox.contains(&Outgoing::TurnEnded { turn, end: TurnEnd::Refused }), "{told}: {outbox:?}");
    }
    let (turn, outbox) = conversation.hear("where is the bowl?", &knowledge);
    assert!(!plans(&outbox) && says(&outbox).contains("bowl"), "{}", says(&outbox));
    assert!(outbox.contains(&Outgoing::TurnEnded { turn, end: TurnEnd::Answered }));
}

#[test]
fn what_is_put_off_is_done_when_its_time_has_come() {
    let (mut conversation, knowledge) = (conversation(), knowledge());
    let (_, outbox) = conversation.hear("wait 10 seconds, then go to the main office", &knowledge);
    assert!(!plans(&outbox) && conversation.awaits(), "{}", says(&outbox));
    assert!(conversation.wake(100.0, &knowledge).is_empty() && conversation.wake(109.9, &knowledge).is_empty());
    let outbox = conversation.wake(110.0, &knowledge);
    assert!(plans(&outbox) && !conversation.awaits());
    assert_eq!(says(&outbox), "10 seconds are over. OK, going to the main office.");
    assert!(conversation.wake(500.0, &knowledge).is_empty());
}

#[test]
fn what_is_not_known_is_repeated_as_it_was_heard() {
    let (mut conversation, knowledge) = (conversation(), knowledge());
    let aloud = Aloud { raw: "Blorp the zargle.", is_doubtful: false };
    let (_, outbox) = conversation.hear_aloud("blorp the zargle", "blorp the zargle", aloud, 0, &knowledge);
    assert!(says(&outbox).starts_with("I heard \"Blorp the zargle\". "), "{}", says(&outbox));
    let (_, outbox) = conversation.hear("blorp the zargle", &knowledge);
    assert!(!says(&outbox).contains("I heard"), "who types knows what they typed");
}
