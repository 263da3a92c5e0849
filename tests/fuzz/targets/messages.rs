//! Any bytes as a message in shared memory: what a reader sees of it, whole or malformed, never panics.

#![no_main]

use cohabit_bus::{
    Envelope,
    message::{
        CommandMessage, Control, ControlMessage, DialogView, EventMessage, FrameView, MissionMessage, Plane,
        PulseMessage, StateView, StepView, Thing, TickView, read,
    },
};
use cohabit_cdf::Action;
use cohabit_record::entry::{EventEntry, InputEntry};
use libfuzzer_sys::fuzz_target;

/// Memory as a transport lends it.
#[repr(align(64))]
struct Sample([u8; 8192]);

fuzz_target!(|bytes: &[u8]| {
    let Some((kind, payload)) = bytes.split_first() else { return };
    let mut sample = Sample([0; 8192]);
    let length = payload.len().min(sample.0.len());
    sample.0[..length].copy_from_slice(&payload[..length]);
    look(*kind, &sample.0[..length]);
    // The same where no transport would put it.
    look(*kind, payload);
});

fn look(kind: u8, payload: &[u8]) {
    match kind % 10 {
        0 => {
            let Ok(command) = read::<CommandMessage>(payload) else { return };
            if let Some(input) = InputEntry::new(&command) {
                let _ = serde_json::to_string(&input);
            }
            let _ = (command.kind(), command.peer().as_str().len(), Action::try_from(command.action));
        }
        1 => {
            let Ok(event) = read::<EventMessage>(payload) else { return };
            let _ = (event.kind(), event.status(), event.text.as_str().len());
            if let Some(entry) = EventEntry::new(&Envelope::default(), &event) {
                let _ = serde_json::to_string(&entry);
            }
        }
        2 => {
            let Ok(view) = DialogView::new(payload) else { return };
            let _ = format!("{:?} {:?} {view:?}", view.header.kind(), view.header.status());
        }
        3 => {
            let Ok(view) = StateView::new(payload) else { return };
            let _ = format!("{view:?}");
        }
        4 => {
            let Ok(view) = FrameView::new(payload) else { return };
            for plane in [Plane::Color, Plane::Depth, Plane::Normals, Plane::Ids] {
                let _ = view.plane(plane).map(|bytes| bytes.iter().map(|byte| u64::from(*byte)).sum::<u64>());
            }
            let _ = (view.depth_m().map(<[f32]>::len), view.ids().map(<[u32]>::len));
            let _ = view.seen().iter().map(|record| Thing::of_id(record.id)).count();
        }
        5 => {
            let Ok(view) = TickView::new(payload) else { return };
            let _ = format!("{view:?}");
        }
        6 => {
            let Ok(control) = read::<ControlMessage>(payload) else { return };
            let _ = Control::try_from(control);
        }
        7 => {
            let Ok(view) = StepView::new(payload) else { return };
            let _ = view.due.iter().fold(0, |all, run| all ^ run);
        }
        8 => {
            let Ok(pulse) = read::<PulseMessage>(payload) else { return };
            let _ = pulse.peer.as_str().len();
        }
        _ => {
            let Ok(mission) = MissionMessage::read(payload) else { return };
            let _ = mission.text.len();
        }
    }
}
