//! The layouts of one session, and of two beside each other.

use cohabit_bus::{CameraId, message::Plane};

use crate::{
    blueprint::{Pane, View},
    pictures::camera_path,
    recording::Side,
};

/// The eye stands so much south of the office's middle and so high, in lengths of its longer side.
const EYE_SOUTH: f32 = 0.5;
const EYE_HEIGHT: f32 = 0.7;

/// What a session's layout needs to know.
pub struct Contents<'a> {
    /// Which session of the recording it is.
    pub side: Side,
    /// `[west, south, east, north]` of its floor plan, m.
    pub bounds_m: [f32; 4],
    /// The camera that is shown.
    pub camera: CameraId,
    /// What of it is shown.
    pub planes: &'a [Plane],
}

impl Contents<'_> {
    /// The layout of one session.
    pub fn pane(&self) -> Pane {
        Pane::Column(vec![
            (
                2.1,
                Pane::Row(vec![
                    (2.0, self.office().into()),
                    (1.35, self.pictures()),
                    (1.0, Pane::Column(vec![(1.5, self.dialog().into()), (1.0, self.papers())])),
                ]),
            ),
            (1.0, Pane::Row(vec![(1.9, self.states().into()), (1.0, self.numbers()), (1.0, self.latency().into())])),
        ])
    }

    /// Two sessions beside each other.
    pub fn beside(&self, other: &Self) -> Pane {
        let half = |own: &Self| {
            let eyes = Pane::Tabs(own.planes.iter().map(|plane| own.picture(*plane).into()).collect());
            Pane::Column(vec![
                (
                    2.0,
                    Pane::Row(vec![
                        (1.6, own.office().into()),
                        (1.0, Pane::Column(vec![(1.0, eyes), (1.0, own.dialog().into())])),
                    ]),
                ),
                (1.0, own.states().into()),
            ])
        };
        let both = |plot: fn(&Self) -> View, name: &str, below: &str| {
            let all = [self, other].map(|own| format!("/{}/**", own.path(below)));
            Pane::View(plot(self).on(&all.each_ref().map(String::as_str)).called(name, ""))
        };
        Pane::Column(vec![
            (3.0, Pane::Row(vec![(1.0, half(self)), (1.0, half(other))])),
            (
                1.0,
                Pane::Row(vec![
                    (1.0, both(Self::goals, "Goals", "goals")),
                    (1.0, both(Self::latency, "Answer after (ms)", "latency")),
                ]),
            ),
        ])
    }

    fn name(&self, name: &str) -> String {
        self.side.name(name)
    }

    fn path(&self, path: &str) -> String {
        format!("{}{path}", self.side.root())
    }

    fn office(&self) -> View {
        let [west, south, east, north] = self.bounds_m;
        let (x, y) = (f32::midpoint(west, east), f32::midpoint(south, north));
        let length = (east - west).max(north - south);
        let view = View::new("3D", &self.name("Office"), &self.path("world"));
        let view = view.seen_from([x, y - length * EYE_SOUTH, length * EYE_HEIGHT], [x, y - length * 0.04, 0.0]);
        // In the scene a camera shows its colours alone.
        let others = self.planes.iter().filter(|plane| **plane != Plane::Color);
        others.fold(view, |view, plane| view.and(self.without(*plane)))
    }

    /// Leaves a plane of the camera out.
    fn without(&self, plane: Plane) -> String {
        format!("- /{}", self.path(&format!("{}/{}", camera_path(self.camera), plane.name())))
    }

    fn pictures(&self) -> Pane {
        let of = |planes: &[Plane]| {
            let shown = planes.iter().filter(|plane| self.planes.contains(plane));
            let panes: Vec<_> = shown.map(|plane| (1.0, self.picture(*plane).into())).collect();
            (!panes.is_empty()).then_some((1.0, Pane::Row(panes)))
        };
        let rows = [of(&[Plane::Color, Plane::Ids]), of(&[Plane::Depth, Plane::Normals])];
        Pane::Column(rows.into_iter().flatten().collect())
    }

    fn picture(&self, plane: Plane) -> View {
        let name = match plane {
            Plane::Color => "Robot's eyes",
            Plane::Depth => "Depth",
            Plane::Normals => "Normals",
            Plane::Ids => "Classes",
        };
        View::new("2D", &self.name(name), &self.path(&format!("{}/{}", camera_path(self.camera), plane.name())))
    }

    fn dialog(&self) -> View {
        View::new("TextLog", &self.name("Dialog"), &self.path("dialog"))
    }

    fn papers(&self) -> Pane {
        Pane::Tabs(vec![
            View::new("TextDocument", &self.name("Mission"), &self.path("mission")).into(),
            View::new("TextLog", &self.name("Happenings"), &self.path("happenings")).into(),
        ])
    }

    fn states(&self) -> View {
        View::new("StateTimeline", &self.name("Actions, goals and things"), &self.path("states")).linked()
    }

    fn numbers(&self) -> Pane {
        Pane::Tabs(vec![self.goals().into(), self.score().into()])
    }

    fn goals(&self) -> View {
        View::new("TimeSeries", &self.name("Goals"), &self.path("goals")).linked().with_legend()
    }

    fn score(&self) -> View {
        View::new("TimeSeries", &self.name("Score"), &self.path("score")).linked()
    }

    fn latency(&self) -> View {
        View::new("TimeSeries", &self.name("Answer after (ms)"), &self.path("latency")).linked().with_legend()
    }
}
