//! The messages of a session, as they lie in shared memory: fixed records, and lists of them behind a header.

mod action;
mod answer;
mod audio;
mod camera;
mod command;
mod control;
mod dialog;
mod event;
mod frame;
mod layout;
mod mission;
mod pulse;
mod room;
mod snapshot;
mod state;
mod step;
mod tick;

pub use action::ActionRecord;
pub use answer::{AnswerKind, AnswerMessage};
pub use audio::{AudioHeader, AudioView};
pub use camera::{CameraKind, CameraRecord};
pub use command::{CommandKind, CommandMessage};
pub use control::{Control, ControlMessage};
pub use dialog::{DialogHeader, DialogKind, DialogMessage, DialogView, PlanStep};
pub use event::{EventKind, EventMessage};
pub use frame::{FrameHeader, FrameLayout, FrameParts, FrameView, Plane, SeenRecord, Thing};
pub use mission::{MissionHeader, MissionMessage};
pub use pulse::PulseMessage;
pub use snapshot::{SnapshotHeader, SnapshotView};
pub use state::{BodyRecord, GoalRecord, NoteRecord, ObjectRecord, StateHeader, StateParts, StateView};
pub use step::{StepHeader, StepView};
pub use tick::{Stage, TickHeader, TickMessage, TickView};

pub use crate::text::LONGEST_TEXT_CHARS;

/// Stands for "no object", "no body" and "no command" in records.
pub const NONE: u32 = u32::MAX;

/// Why bytes are not the message they should be.
#[derive(Clone, Copy, Debug, Eq, PartialEq, thiserror::Error)]
#[error("malformed message: {0}")]
pub struct Malformed(pub &'static str);

/// Reads one fixed record.
///
/// # Errors
/// [`Malformed`], when the length is not the record's.
pub fn read<T: bytemuck::Pod>(payload: &[u8]) -> Result<T, Malformed> {
    bytemuck::try_pod_read_unaligned(payload).map_err(|_| Malformed("not the length of its record"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_text_is_kept_whole_in_any_script() {
        for letter in ["a", "я", "語", "😀"] {
            let text = letter.repeat(LONGEST_TEXT_CHARS);
            let said = DialogMessage::new(DialogKind::Utterance, 0, 1, &text);
            let mut answer = AnswerMessage::new(AnswerKind::Words);
            answer.text = crate::Text::new(&text);
            assert_eq!((said.header.text.as_str(), answer.text.as_str()), (text.as_str(), text.as_str()), "{letter}");
        }
    }
}
