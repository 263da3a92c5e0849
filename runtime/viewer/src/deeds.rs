//! What bodies did and what came of it: actions, goals, score, states of things, and what is pointed out.

use std::collections::BTreeMap;

use cohabit_bus::message::{ObjectRecord, StateView};
use cohabit_cdf::{Action, Catalog, ClassId, GoToTarget, ObjectId, Status};
use cohabit_engine::HIGHLIGHT_TICKS;
use cohabit_record::{EventEntry, InputEntry};
use cohabit_render::MeshLibrary;
use re_sdk_types::{
    archetypes::{Boxes3D, Scalars, SeriesLines, StateChange, StateConfiguration, TextLog},
    components::{FillMode, InterpolationMode, ShowLabels, TextLogLevel},
    datatypes::{Bool, Quaternion},
};

use crate::{
    looks,
    office::name_of,
    recording::{Recording, part},
};

/// What is pointed out, and what is asked about.
const POINTED: [u8; 3] = [255, 196, 61];
const ASKED: [u8; 3] = [236, 64, 122];
/// So much larger than things are their outlines, m.
const AROUND_M: f32 = 0.03;

/// Plots are told at least so often.
const PLOT_EVERY_TICKS: u64 = 60;
/// Lines of plots.
const PLOTS: [(&str, &str, [u8; 3]); 3] = [
    ("goals/met", "goals met", [140, 215, 150]),
    ("goals/all", "goals", [150, 150, 150]),
    ("score", "score", [255, 196, 61]),
];

/// What goals may be, and the colours of that.
const GOALS: [(&str, [u8; 3]); 3] = [("open", [70, 78, 88]), ("hidden", [38, 42, 48]), ("met", [60, 150, 80])];

/// Lanes in which what may be has these colours.
pub fn colored(states: &[(&str, [u8; 3])]) -> StateConfiguration {
    let (values, colors): (Vec<_>, Vec<_>) = states.iter().copied().unzip();
    StateConfiguration::new().with_values(values).with_colors(colors)
}

/// What happened so far in one session.
#[derive(Debug, Default)]
pub struct Deeds {
    /// What each body does: the command, and its name.
    doing: BTreeMap<u32, u64>,
    /// What plots show, and the tick at which it was told.
    numbers: [u32; 3],
    plotted: u64,
    goals: BTreeMap<i64, &'static str>,
    states: BTreeMap<u32, String>,
    /// What is pointed out, and until when.
    pointed: Vec<(ObjectId, u64)>,
    marked: Vec<Mark>,
}

/// An outline.
#[derive(Clone, Debug, PartialEq)]
struct Mark {
    object: ObjectId,
    asked: bool,
    at_m: [f32; 3],
}

impl Deeds {
    /// Nothing has happened yet; tells how its plots look.
    pub fn new(recording: &Recording) -> anyhow::Result<Self> {
        for (path, name, color) in PLOTS {
            let line = SeriesLines::new().with_widths([2.0]).with_interpolation_mode(InterpolationMode::StepAfter);
            recording.log_line(path, name, color, line)?;
        }
        Ok(Self::default())
    }

    /// Tells what a body is told to do.
    pub fn begin(&mut self, recording: &Recording, input: &InputEntry, state: &StateView<'_>) -> anyhow::Result<()> {
        // Held keys command nine times a second.
        if matches!(input.action, Action::Drive { .. }) {
            return Ok(());
        }
        self.doing.insert(input.body, input.command);
        recording.log(&lane(state, input.body), &StateChange::single(told(&input.action, state.objects)))
    }

    /// Tells an event.
    pub fn note(&mut self, recording: &Recording, event: &EventEntry, state: &StateView<'_>) -> anyhow::Result<()> {
        match (event.kind.as_str(), event.body, event.object) {
            ("Outcome", Some(body), _) => self.end(recording, event, body, state)?,
            ("Highlighted", _, Some(object)) => {
                self.pointed.retain(|(other, _)| other.0 != object);
                self.pointed.push((ObjectId(object), event.tick + HIGHLIGHT_TICKS));
            }
            _ => {}
        }
        let Some((text, level)) = happening(event, state.objects) else { return Ok(()) };
        recording.log("happenings", &TextLog::new(text).with_level(level))
    }

    fn end(
        &mut self,
        recording: &Recording,
        event: &EventEntry,
        body: u32,
        state: &StateView<'_>,
    ) -> anyhow::Result<()> {
        if event.command.is_none() || self.doing.get(&body).copied() != event.command {
            return Ok(());
        }
        self.doing.remove(&body);
        let failed = event.status.filter(|status| status.is_failure());
        let left = failed.map_or_else(String::new, |status| format!("✗ {status:?}"));
        recording.log(&lane(state, body), &StateChange::single(left))
    }

    /// Tells what is new in the state.
    pub fn show(&mut self, recording: &Recording, tick: u64, state: &StateView<'_>) -> anyhow::Result<()> {
        let met = state.goals.iter().filter(|goal| goal.met == 1).count();
        let numbers = [met, state.goals.len(), state.header.score as usize]
            .map(|number| u32::try_from(number).unwrap_or(u32::MAX));
        // Lines go on to where the session is.
        if numbers != self.numbers || tick >= self.plotted + PLOT_EVERY_TICKS {
            (self.numbers, self.plotted) = (numbers, tick);
            for ((path, ..), number) in PLOTS.into_iter().zip(numbers) {
                recording.log(path, &Scalars::single(f64::from(number)))?;
            }
        }
        for goal in state.goals {
            let now = match (goal.met, goal.hidden) {
                (1, _) => "met",
                (_, 1) => "hidden",
                _ => "open",
            };
            let path = format!("states/goals/{}", goal.number);
            let before = self.goals.insert(goal.number, now);
            if before.is_none() {
                recording.log_always(&path, &colored(&GOALS))?;
            }
            if before != Some(now) {
                recording.log(&path, &StateChange::single(now))?;
            }
        }
        state.objects.iter().try_for_each(|object| self.change(recording, object))
    }

    /// Things have lanes from their first change on.
    fn change(&mut self, recording: &Recording, object: &ObjectRecord) -> anyhow::Result<()> {
        let now = looks::states(object);
        match self.states.insert(object.object, now.clone()) {
            Some(before) if before != now => {
                let path = format!("states/things/{}", part(object.instance.as_str()));
                recording.log(&path, &StateChange::single(if now.is_empty() { "as usual" } else { &now }))
            }
            _ => Ok(()),
        }
    }

    /// Outlines what is pointed out and what is asked about, where that has changed.
    pub fn mark(
        &mut self,
        recording: &Recording,
        tick: u64,
        asked: &[ObjectId],
        state: &StateView<'_>,
        meshes: &MeshLibrary,
        catalog: &Catalog,
    ) -> anyhow::Result<()> {
        self.pointed.retain(|(_, until)| *until > tick);
        let pointed = self.pointed.iter().map(|(object, _)| *object).filter(|object| !asked.contains(object));
        let all = asked.iter().map(|object| (*object, true)).chain(pointed.map(|object| (object, false)));
        let records: Vec<(Mark, &ObjectRecord)> = all
            .filter_map(|(object, asked)| {
                let record = state.objects.iter().find(|record| record.object == object.0)?;
                Some((Mark { object, asked, at_m: record.position_m }, record))
            })
            .collect();
        let marks: Vec<Mark> = records.iter().map(|(mark, _)| mark.clone()).collect();
        if marks == self.marked {
            return Ok(());
        }
        self.marked = marks;
        if records.is_empty() {
            return recording.clear("world/marks");
        }
        let name = |(place, (mark, record)): (usize, &(Mark, &ObjectRecord))| {
            let class = catalog.classes().get(usize::from(record.class)).map_or("", |class| class.name.as_str());
            if mark.asked { format!("{}?", place + 1) } else { class.to_owned() }
        };
        let bounds = |record: &ObjectRecord| meshes.bounds(ClassId(record.class));
        let boxes = Boxes3D::from_centers_and_half_sizes(
            records.iter().map(|(_, record)| middle(record, bounds(record).center().to_array())),
            records.iter().map(|(_, record)| (bounds(record).size() / 2.0 + AROUND_M).to_array()),
        );
        let boxes = boxes
            .with_quaternions(records.iter().map(|(_, record)| Quaternion::from_xyzw(record.rotation)))
            .with_colors(records.iter().map(|(mark, _)| if mark.asked { ASKED } else { POINTED }))
            .with_labels(records.iter().enumerate().map(name))
            .with_fill_mode(FillMode::MajorWireframe)
            .with_show_labels(ShowLabels(Bool(true)))
            .with_radii([0.015]);
        recording.log("world/marks", &boxes)
    }
}

/// A point of an object's own frame in the world.
fn middle(record: &ObjectRecord, point: [f32; 3]) -> [f32; 3] {
    let [x, y, z, w] = record.rotation;
    let cross =
        |a: [f32; 3], b: [f32; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    // The point turned by a unit quaternion: p + 2 w (v × p) + 2 v × (v × p).
    let axis = [x, y, z];
    let once = cross(axis, point);
    let twice = cross(axis, once);
    [0, 1, 2].map(|side| record.position_m[side] + point[side] + 2.0 * (w * once[side] + twice[side]))
}

fn lane(state: &StateView<'_>, body: u32) -> String {
    let known = state.bodies.iter().find(|record| record.body == body);
    format!("states/actions/{}", known.map_or_else(|| format!("body_{body}"), looks::body_name))
}

/// An action in a few words.
fn told(action: &Action, objects: &[ObjectRecord]) -> String {
    let with = |verb: &str, object: ObjectId| match name_of(objects, object.0) {
        Some(name) => format!("{verb} {name}"),
        None => verb.to_owned(),
    };
    match action {
        Action::Move { distance_m } => format!("Move {distance_m:.1} m"),
        Action::Rotate { yaw_rad } => format!("Rotate {:.0}°", yaw_rad.to_degrees()),
        Action::Look { pitch_rad } => format!("Look {:.0}°", pitch_rad.to_degrees()),
        Action::LookAround => "LookAround".to_owned(),
        Action::GoTo { target: GoToTarget::Object(object) } => with("GoTo", *object),
        Action::GoTo { target: GoToTarget::Room(room) } => format!("GoTo {}", room.id()),
        Action::GoTo { target: GoToTarget::Viewpoint(room, number) } => format!("GoTo {}_{number}", room.id()),
        Action::GoTo { target: GoToTarget::Point([x, y]) } => format!("GoTo {x:.1} {y:.1}"),
        Action::PickUp { object } => with("PickUp", *object),
        Action::Place { receptacle } => with("Place", *receptacle),
        Action::PlaceBeside { receptacle, beside } => with(&format!("{} beside", with("Place", *receptacle)), *beside),
        Action::Interact { verb, object } => with(&format!("{verb:?}"), *object),
        Action::Highlight { object } => with("Highlight", *object),
        Action::Stop => "Stop".to_owned(),
        Action::Drive { .. } => "Drive".to_owned(),
    }
}

/// An event as a line, if it is one that people would tell.
fn happening(event: &EventEntry, objects: &[ObjectRecord]) -> Option<(String, &'static str)> {
    let thing = || event.object.and_then(|object| name_of(objects, object)).unwrap_or("something");
    let failed = event.status.is_some_and(Status::is_failure);
    Some(match event.kind.as_str() {
        "Outcome" if failed => (format!("{:?}: {}", event.status?, event.text), TextLogLevel::WARN),
        "GoalMet" => (format!("goal {} met: {}", event.goal?, event.text), "GOAL"),
        "GoalReset" => (format!("goal {} open again: {}", event.goal?, event.text), "GOAL"),
        "GoalShown" => (format!("a goal is shown: {}", event.text), "GOAL"),
        "MissionComplete" => ("the mission is complete".to_owned(), "GOAL"),
        "MissionFailed" => (format!("the mission failed: {}", event.text), TextLogLevel::ERROR),
        "NoteRead" => (format!("{} says: {}", thing(), event.text), TextLogLevel::INFO),
        "Sound" => (format!("{}: {}", thing(), event.text), TextLogLevel::TRACE),
        "Message" | "CameraMovement" | "Commander" | "Clock" => (event.text.clone(), TextLogLevel::INFO),
        "TimedOut" | "CutOff" => (event.text.clone(), TextLogLevel::WARN),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_turn_with_their_objects() {
        let quarter = std::f32::consts::FRAC_1_SQRT_2;
        let record = ObjectRecord {
            position_m: [1.0, 2.0, 3.0],
            rotation: [0.0, 0.0, quarter, quarter],
            ..ObjectRecord::default()
        };
        for (found, wanted) in middle(&record, [1.0, 0.0, 0.5]).iter().zip([1.0, 3.0, 3.5]) {
            assert!((found - wanted).abs() < 1e-6, "{found} is not {wanted}");
        }
    }
}
