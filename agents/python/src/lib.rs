//! The part of the Python package `cohabit` that is not Python: worlds stepped in lock-step inside the interpreter's
//! process, one or many in a call, and a peer of a running session whose frames are read where the simulator wrote them.
//!
//! Whatever waits or computes lets other Python threads run meanwhile, and whatever waits ends at Ctrl-C. What is handed
//! to Python as memory cannot be written to there. This crate never knows rules: it asks the world and the catalogue.

mod action;
mod around;
mod book;
mod choice;
mod crew;
mod error;
mod frame;
mod known_rooms;
mod library;
mod memory;
mod mission_file;
mod outcome;
mod part;
mod senses;
mod session;
mod stage;
mod state;
mod suite;
mod theatre;
mod vec_stage;

/// What Python imports.
#[pyo3::pymodule]
mod _native {
    #[pymodule_export]
    use crate::{
        action::PyAction,
        choice::choice_action,
        error::Error,
        frame::{Frame, Seen},
        library::{class_ids, pack_missions, room_id, room_ids},
        memory::Memory,
        mission_file::mission_text,
        outcome::Outcome,
        senses::Senses,
        session::{Command, Heard, Session},
        stage::Stage,
        state::{Body, Goal, Object, State},
        suite::{body_tools, builtin_missions, generate_missions, part_missions},
        vec_stage::VecStage,
    };

    use pyo3::prelude::*;

    #[pymodule_init]
    fn tables(module: &Bound<'_, PyModule>) -> PyResult<()> {
        use cohabit_cdf::{BodyKind, Color, Fluid, StateFlag, Status, Verb, world_pack};

        use crate::{choice::Choice, known_rooms};

        module.add("VERSION", env!("CARGO_PKG_VERSION"))?;
        module.add("CHOICES", Choice::all().map(|choice| (choice.name(), choice.takes_slot())).collect::<Vec<_>>())?;
        module.add("ROOMS", known_rooms::builtin().all().iter().map(|room| room.id.id()).collect::<Vec<_>>())?;
        module.add("PACKS", world_pack::builtin_names().collect::<Vec<_>>())?;
        module.add("KINDS", BodyKind::ALL.map(BodyKind::name).to_vec())?;
        module.add("COLORS", Color::ALL.map(Color::name).to_vec())?;
        module.add("FLUIDS", Fluid::ALL.map(Fluid::name).to_vec())?;
        module.add("FLAGS", StateFlag::ALL.map(|flag| format!("{flag:?}")).to_vec())?;
        module.add("VERBS", Verb::ALL.map(|verb| format!("{verb:?}").to_lowercase()).to_vec())?;
        module.add("STATUSES", Status::ALL.map(|status| format!("{status:?}")).to_vec())
    }
}
