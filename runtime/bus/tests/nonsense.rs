//! Whatever bytes a peer writes: a reader sees a message or is told that it is none.
#![allow(clippy::unwrap_used, missing_docs)]

#[allow(dead_code, reason = "the layouts' test uses the rest")]
#[path = "layouts/payload.rs"]
mod payload;

use cohabit_bus::{
    Topic,
    message::{
        AnswerMessage, AudioView, CommandMessage, Control, ControlMessage, DialogView, EventMessage, FrameView,
        Malformed, MissionMessage, Plane, PulseMessage, SnapshotView, StateView, StepView, Thing, TickView, read,
    },
};
use cohabit_cdf::Action;
use proptest::{prelude::*, sample::Index};

use payload::{example, topics};

/// Reads all that a payload holds.
fn look(topic: Topic, payload: &[u8]) -> Result<(), Malformed> {
    match topic {
        Topic::Mission => drop(format!("{:?}", MissionMessage::read(payload)?)),
        Topic::State => drop(format!("{:?}", StateView::new(payload)?)),
        Topic::Ticks => drop(format!("{:?}", TickView::new(payload)?)),
        Topic::Snapshots => drop(format!("{:?}", SnapshotView::new(payload)?)),
        Topic::Events => {
            let event: EventMessage = read(payload)?;
            drop(format!("{event:?} {:?} {:?}", event.kind(), event.status()));
        }
        Topic::Commands => drop(format!("{:?}", Action::try_from(read::<CommandMessage>(payload)?.action)?)),
        Topic::Control => drop(format!("{:?}", Control::try_from(read::<ControlMessage>(payload)?)?)),
        Topic::Steps => drop(format!("{:?}", StepView::new(payload)?)),
        Topic::Pulses => drop(format!("{:?}", read::<PulseMessage>(payload)?)),
        Topic::Dialog => {
            let view = DialogView::new(payload)?;
            drop(format!("{view:?} {:?} {:?}", view.header.kind(), view.header.status()));
        }
        Topic::Answers => {
            let answer: AnswerMessage = read(payload)?;
            drop(format!("{answer:?} {:?}", answer.kind()));
        }
        Topic::Microphone | Topic::Speech => drop(format!("{:?}", AudioView::new(payload)?)),
        Topic::Frames(_) => {
            let view = FrameView::new(payload)?;
            let sums = Plane::ALL.map(|plane| view.plane(plane).map(|bytes| bytes.iter().map(|b| u64::from(*b)).sum()));
            let _: [Option<u64>; 4] = sums;
            view.seen().iter().for_each(|record| drop(format!("{:?}", Thing::of_id(record.id))));
        }
    }
    Ok(())
}

#[test]
fn whole_messages_are_read() {
    for topic in topics() {
        let found = look(topic, example(topic).bytes());
        // A command of nothing but zeros is none.
        let is_empty = topic == Topic::Commands;
        assert_eq!(found.is_err(), is_empty, "{topic}: {found:?}");
    }
}

proptest! {
    #[test]
    fn messages_with_some_bytes_changed_are_read_or_refused(
        changes in proptest::collection::vec((any::<Index>(), any::<u8>()), 1..8),
        cut in any::<Index>(),
    ) {
        for topic in topics() {
            let mut example = example(topic);
            let bytes = example.bytes();
            for (place, value) in &changes {
                bytes[place.index(bytes.len())] = *value;
                // Counts and places lie in the first bytes.
                bytes[place.index(128.min(bytes.len()))] = *value;
            }
            let _ = look(topic, bytes);
            let _ = look(topic, &bytes[..cut.index(bytes.len() + 1)]);
        }
    }

    #[test]
    fn any_bytes_are_read_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..3000)) {
        for topic in topics() {
            let _ = look(topic, &bytes);
        }
    }
}
