#![allow(clippy::unwrap_used)]

use proptest::prelude::*;

use super::*;
use crate::task::Reason;

const KEPT_MS: u64 = 100;

fn segments(count: usize) -> BTreeSet<Segment> {
    let segment = |number| Segment { episode: format!("episodes/{number:06}"), first_step: 2, end_step: 8 };
    (0..count).map(segment).collect()
}

fn board(per_segment: usize, count: usize, people: usize) -> Board {
    Board::new(Settings { per_segment, kept_ms: KEPT_MS }, segments(count), people, 1)
}

fn name(person: usize) -> String {
    format!("A{person:02}")
}

/// Has somebody finish a task that they have taken.
fn finish(board: &mut Board, annotator: &str, claim: &Claim, what: What, at_ms: u64) {
    let annotation = Annotation {
        id: board.next_id(),
        annotator: annotator.to_owned(),
        task: claim.task.clone(),
        what,
        taken_ms: claim.taken_ms,
        at_ms,
        corrects: None,
    };
    board.note(annotation);
}

fn text(annotator: &str) -> What {
    What::Text(format!("words of {annotator}"))
}

/// Has all people work until there is nothing for anybody.
fn work(board: &mut Board, people: usize, at_ms: u64) {
    loop {
        let mut is_idle = true;
        for annotator in (0..people).map(name) {
            if let Some(claim) = board.take(&annotator, at_ms) {
                finish(board, &annotator, &claim, text(&annotator), at_ms);
                is_idle = false;
            }
        }
        if is_idle {
            return;
        }
    }
}

/// What must hold of all annotations, whatever happened.
fn check(board: &Board, per_segment: usize) {
    let mut people = BTreeSet::new();
    let mut texts = BTreeMap::<Unit, usize>::new();
    for annotation in board.annotations() {
        let unit = annotation.task.unit();
        assert!(people.insert((unit.clone(), annotation.annotator.clone())), "twice the same: {annotation:?}");
        *texts.entry(unit).or_default() += usize::from(annotation.text().is_some());
        match &annotation.task {
            Task::Instruction { .. } => {}
            Task::Question { segment, moment_step, instruction } => {
                assert!((segment.first_step..segment.end_step).contains(moment_step), "{annotation:?}");
                assert_ne!(board.annotation(instruction.id).unwrap().annotator, annotation.annotator);
            }
            Task::Answer { question, .. } => {
                assert_ne!(board.annotation(question.id).unwrap().annotator, annotation.annotator);
            }
        }
    }
    assert!(texts.values().all(|count| *count <= per_segment), "{texts:?}");
}

#[derive(Clone, Debug)]
enum Happens {
    Takes(usize),
    Finishes(usize),
    Skips(usize),
    Passes(u64),
}

fn happens() -> impl Strategy<Value = Happens> {
    prop_oneof![
        3 => (0..5_usize).prop_map(Happens::Takes),
        3 => (0..5_usize).prop_map(Happens::Finishes),
        1 => (0..5_usize).prop_map(Happens::Skips),
        1 => (0..2 * KEPT_MS).prop_map(Happens::Passes),
    ]
}

proptest! {
    #[test]
    fn nobody_is_asked_twice_or_for_more_than_is_wanted(
        (per_segment, count, people) in (1..4_usize, 1..4_usize, 1..6_usize),
        story in prop::collection::vec(happens(), 0..120),
    ) {
        let mut board = board(per_segment, count, people);
        let mut held = BTreeMap::<String, Claim>::new();
        let mut now_ms = 0;
        for event in story {
            match event {
                Happens::Takes(person) if person < people => {
                    let annotator = name(person);
                    if let Some(claim) = board.take(&annotator, now_ms) {
                        held.insert(annotator, claim);
                    }
                }
                Happens::Finishes(person) | Happens::Skips(person) => {
                    let annotator = name(person);
                    let Some(claim) = held.remove(&annotator) else { continue };
                    if board.claim(&annotator, claim.number, now_ms).is_some() {
                        let is_skip = matches!(event, Happens::Skips(_));
                        let what = if is_skip { What::Skipped(Reason::CannotTell) } else { text(&annotator) };
                        finish(&mut board, &annotator, &claim, what, now_ms);
                        prop_assert!(board.claim(&annotator, claim.number, now_ms).is_none());
                    }
                }
                Happens::Takes(_) => {}
                Happens::Passes(ms) => now_ms += ms,
            }
            check(&board, per_segment);
        }
    }

    #[test]
    fn every_segment_gets_as_many_as_there_are_people_for(
        (per_segment, count, people) in (1..4_usize, 1..4_usize, 1..6_usize),
    ) {
        let mut board = board(per_segment, count, people);
        // Somebody takes a task, and never comes back.
        let lost = board.take(&name(0), 0);
        prop_assert!(lost.is_some());
        work(&mut board, people, KEPT_MS);
        check(&board, per_segment);
        let count_of = |unit: &Unit| board.texts(unit).count();
        for segment in segments(count) {
            prop_assert_eq!(count_of(&Unit::Instruction(segment.clone())), per_segment.min(people));
            let askers = if people > 1 { per_segment.min(people) } else { 0 };
            prop_assert_eq!(count_of(&Unit::Question(segment)), askers);
        }
        for asked in board.annotations().filter(|one| one.task.unit().kind() == Kind::Question) {
            prop_assert_eq!(count_of(&Unit::Answer(asked.id)), per_segment.min(people - 1));
        }
    }
}

#[test]
fn a_task_goes_to_somebody_else_once_its_page_gives_no_sign() {
    let mut board = board(1, 1, 3);
    let first = board.take("A00", 0).unwrap();
    assert_eq!(board.take("A00", KEPT_MS - 1).unwrap().number, first.number, "a reload goes on with it");
    assert!(board.take("A01", KEPT_MS).is_none(), "it was seen a moment ago");
    let second = board.take("A01", 2 * KEPT_MS).unwrap();
    assert_eq!(second.task, first.task);
    assert!(board.claim("A00", first.number, 2 * KEPT_MS).is_none(), "it is somebody else's now");
    // That one is lost, too: who comes back first has it.
    assert!(board.claim("A00", first.number, 4 * KEPT_MS).is_some());
}

#[test]
fn what_nobody_can_tell_is_asked_of_no_more_people_than_a_text() {
    let mut board = board(2, 1, 4);
    for person in 0..2 {
        let claim = board.take(&name(person), 0).unwrap();
        finish(&mut board, &name(person), &claim, What::Skipped(Reason::CannotTell), 0);
    }
    assert!(board.take(&name(2), 0).is_none());
}

#[test]
fn a_correction_is_of_ones_own_and_keeps_its_place() {
    let mut board = board(2, 1, 2);
    work(&mut board, 2, 0);
    let (first, count) = (board.annotations().next().unwrap().clone(), board.annotations().count());
    let correction = |annotator: &str, text: &str, id| Annotation {
        id,
        annotator: annotator.to_owned(),
        what: What::Text(text.to_owned()),
        corrects: Some(first.id),
        ..first.clone()
    };
    board.note(correction(&first.annotator, "better", 90));
    board.note(correction("somebody", "worse", 91));
    assert_eq!(board.annotation(first.id).unwrap().text(), Some("better"));
    assert_eq!((board.annotations().count(), board.next_id()), (count, 92));
}
