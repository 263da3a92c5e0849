//! One session as rerun shows it: whatever it comes from, a log or a running session, goes through here.

use std::{fmt::Write as _, sync::Arc};

use cohabit_bus::{
    CameraId,
    message::{FrameView, StateParts, StateView},
};
use cohabit_engine::SessionPlan;
use cohabit_record::{AnswerEntry, DialogEntry, EventEntry, InputEntry};
use cohabit_render::MeshLibrary;
use re_sdk_types::{
    archetypes::{TextDocument, TextLog},
    components::TextLogLevel,
};

use crate::{
    deeds::Deeds,
    office::Office,
    pictures::Pictures,
    recording::{Recording, When},
    talk::Talk,
};

/// A session that is being shown.
pub struct Showing {
    recording: Recording,
    plan: SessionPlan,
    meshes: Arc<MeshLibrary>,
    office: Office,
    pictures: Pictures,
    talk: Talk,
    deeds: Deeds,
    state: StateParts,
    now: When,
}

impl Showing {
    /// Begins with a session of which nothing has happened yet; `about` says how it is played.
    pub fn new(
        recording: Recording,
        plan: SessionPlan,
        meshes: Arc<MeshLibrary>,
        about: &[(String, String)],
    ) -> anyhow::Result<Self> {
        recording.log_always("mission", &TextDocument::from_markdown(mission(&plan, about)))?;
        Ok(Self {
            office: Office::new(&recording, &plan.layout, Arc::clone(&plan.catalog), Arc::clone(&meshes))?,
            pictures: Pictures::default(),
            talk: Talk::new(&recording)?,
            deeds: Deeds::new(&recording)?,
            state: StateParts::default(),
            now: When::default(),
            recording,
            plan,
            meshes,
        })
    }

    /// What is told next belongs to this moment.
    pub fn at(&mut self, when: When) {
        self.now = when;
        self.recording.at(when);
    }

    /// The world is like this now.
    pub fn state(&mut self, state: StateParts) -> anyhow::Result<()> {
        self.state = state;
        let Self { recording, plan, office, pictures, deeds, state, now, .. } = self;
        let view = view(state);
        office.show(recording, now.tick, &view)?;
        pictures.name(recording, &plan.catalog, &view)?;
        deeds.show(recording, now.tick, &view)?;
        self.mark()
    }

    /// A body was told to do something.
    pub fn input(&mut self, input: &InputEntry) -> anyhow::Result<()> {
        self.deeds.begin(&self.recording, input, &view(&self.state))
    }

    /// Something happened.
    pub fn event(&mut self, event: &EventEntry) -> anyhow::Result<()> {
        self.deeds.note(&self.recording, event, &view(&self.state))?;
        self.mark()
    }

    /// Something was said.
    pub fn dialog(&mut self, entry: &DialogEntry) -> anyhow::Result<()> {
        if self.talk.hear(&self.recording, entry)? { self.mark() } else { Ok(()) }
    }

    /// Somebody answered a question of a questionnaire.
    pub fn answer(&self, entry: &AnswerEntry) -> anyhow::Result<()> {
        Talk::answered(&self.recording, entry)
    }

    /// A camera saw this.
    pub fn frame(&mut self, camera: CameraId, frame: &FrameView<'_>) -> anyhow::Result<()> {
        self.pictures.show(&self.recording, camera, frame)
    }

    /// Something is wrong with what is shown.
    pub fn problem(&self, problem: &str) -> anyhow::Result<()> {
        self.recording.log("happenings", &TextLog::new(problem).with_level(TextLogLevel::ERROR))
    }

    fn mark(&mut self) -> anyhow::Result<()> {
        let Self { recording, plan, meshes, talk, deeds, state, now, .. } = self;
        deeds.mark(recording, now.tick, talk.asked(), &view(state), meshes, &plan.catalog)
    }
}

const fn view(parts: &StateParts) -> StateView<'_> {
    let StateParts { header, bodies, objects, goals, notes } = parts;
    StateView {
        header,
        bodies: bodies.as_slice(),
        objects: objects.as_slice(),
        goals: goals.as_slice(),
        notes: notes.as_slice(),
    }
}

/// What was to be done, and how it was played.
fn mission(plan: &SessionPlan, about: &[(String, String)]) -> String {
    let mission = &plan.mission;
    let mut text = format!("# {}\n\n{}\n\n", mission.goal_text, mission.description);
    for goal in mission.goals.iter().filter(|goal| !goal.hidden) {
        let _ = writeln!(text, "- **{}** {}", goal.id, goal.description);
    }
    let _ = writeln!(
        text,
        "\n| | |\n|---|---|\n| mission | {} |\n| floor plan | {} |\n| seed | {} |",
        plan.file, plan.layout.id, plan.seed
    );
    for (name, value) in about {
        let _ = writeln!(text, "| {name} | {value} |");
    }
    text
}
