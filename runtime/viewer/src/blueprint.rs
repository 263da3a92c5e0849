//! How a recording looks when it is first opened: views, where they lie, and what each shows.
//!
//! The builders of rerun's SDK know neither eyes nor time ranges, so the blueprint's entities are written here.

use std::fmt::Write as _;

use anyhow::Context as _;
use re_sdk::{AsComponents, RecordingStream, RecordingStreamBuilder, external::re_log_types};
use re_sdk_types::{
    blueprint::{
        archetypes::{
            ContainerBlueprint, EyeControls3D, LineGrid3D, PanelBlueprint, PlotLegend, TimeAxis, TimePanelBlueprint,
            ViewBlueprint, ViewContents, ViewportBlueprint,
        },
        components::{
            AutoLayout, AutoViews, ColumnShare, ContainerKind, Corner2D, IncludedContent, LinkAxis, PanelState,
            PlayState, PlaybackSpeed, RootContainer, RowShare, TimelineName, ViewClass,
        },
    },
    components::{Name, Visible},
    datatypes::{Bool, Float32, Float64, Uuid},
};

use crate::recording::SIMULATED;

/// A part of the window.
pub enum Pane {
    /// Panes beside each other, each with its share of the width.
    Row(Vec<(f32, Pane)>),
    /// Panes below each other, each with its share of the height.
    Column(Vec<(f32, Pane)>),
    /// Panes of which one is shown at a time, the first at first.
    Tabs(Vec<Pane>),
    /// A view.
    View(View),
}

/// One view.
pub struct View {
    class: &'static str,
    name: String,
    origin: String,
    contents: Vec<String>,
    /// Properties of the view, each under its archetype's name.
    properties: Vec<(&'static str, Box<dyn AsComponents>)>,
}

impl View {
    /// A view of this class on all that lies below `origin`.
    pub fn new(class: &'static str, name: &str, origin: &str) -> Self {
        let (name, origin) = (name.to_owned(), format!("/{origin}"));
        Self { class, name, origin, contents: vec!["$origin/**".to_owned()], properties: Vec::new() }
    }

    /// The same under another name and origin.
    pub fn called(self, name: &str, origin: &str) -> Self {
        Self { name: name.to_owned(), origin: format!("/{origin}"), ..self }
    }

    /// The same on these entities, by rerun's query expressions.
    pub fn on(self, contents: &[&str]) -> Self {
        Self { contents: contents.iter().map(|one| (*one).to_owned()).collect(), ..self }
    }

    /// The same on these entities besides.
    pub fn and(mut self, contents: impl Into<String>) -> Self {
        self.contents.push(contents.into());
        self
    }

    /// The same seen from there, looking at that.
    pub fn seen_from(mut self, eye_m: [f32; 3], target_m: [f32; 3]) -> Self {
        let eye = EyeControls3D::new().with_position(eye_m).with_look_target(target_m).with_eye_up([0.0, 0.0, 1.0]);
        self.properties.push(("EyeControls3D", Box::new(eye)));
        self.properties.push(("LineGrid3D", Box::new(LineGrid3D::new().with_visible(Visible(Bool(false))))));
        self
    }

    /// The same with a time axis that it shares with all others of its kind: the whole recording, at first.
    pub fn linked(mut self) -> Self {
        self.properties.push(("TimeAxis", Box::new(TimeAxis::new().with_link(LinkAxis::LinkToGlobal))));
        self
    }

    /// The same with its legend out of the way of its newest values.
    pub fn with_legend(mut self) -> Self {
        self.properties.push(("PlotLegend", Box::new(PlotLegend::new().with_corner(Corner2D::LeftTop))));
        self
    }
}

impl From<View> for Pane {
    fn from(view: View) -> Self {
        Self::View(view)
    }
}

/// Sends the layout that viewers begin with.
pub fn send(recording: &RecordingStream, root: &Pane) -> anyhow::Result<()> {
    let info = recording.store_info().context("a recording without a store")?;
    let builder = RecordingStreamBuilder::new(info.application_id().clone()).blueprint();
    let (stream, storage) = builder.memory().context("begin a blueprint")?;
    stream.set_time_sequence("blueprint", 0);
    let mut writer = Writer { stream, panes: 0 };
    let root = writer.container(root)?;
    let viewport = ViewportBlueprint::new()
        .with_root_container(RootContainer(root))
        .with_auto_layout(AutoLayout(Bool(false)))
        .with_auto_views(AutoViews(Bool(false)));
    writer.log("viewport", &viewport)?;
    for panel in ["blueprint_panel", "selection_panel"] {
        writer.log(panel, &PanelBlueprint::new().with_state(PanelState::Collapsed))?;
    }
    let time = TimePanelBlueprint::new()
        .with_state(PanelState::Collapsed)
        .with_timeline(TimelineName::from(SIMULATED))
        // At the end one sees all that was said and all ways that were gone.
        .with_play_state(PlayState::Following)
        .with_playback_speed(PlaybackSpeed(Float64(1.0)));
    writer.log("time_panel", &time)?;
    let messages = storage.take();
    let blueprint_id = messages.first().context("an empty blueprint")?.store_id().clone();
    let command = re_log_types::BlueprintActivationCommand { blueprint_id, make_active: true, make_default: true };
    recording.send_blueprint(messages, command);
    Ok(())
}

struct Writer {
    stream: RecordingStream,
    panes: u128,
}

impl Writer {
    fn log(&self, path: &str, what: &dyn AsComponents) -> anyhow::Result<()> {
        self.stream.log(path, what).with_context(|| format!("log `{path}` of the blueprint"))
    }

    /// An id for one more pane: layouts of this program are told apart by their recordings.
    fn id(&mut self) -> Uuid {
        self.panes += 1;
        Uuid { bytes: self.panes.to_be_bytes() }
    }

    fn container(&mut self, pane: &Pane) -> anyhow::Result<Uuid> {
        let (kind, shared): (_, Vec<(f32, &Pane)>) = match pane {
            Pane::Row(panes) => (ContainerKind::Horizontal, panes.iter().map(|(share, pane)| (*share, pane)).collect()),
            Pane::Column(panes) => {
                (ContainerKind::Vertical, panes.iter().map(|(share, pane)| (*share, pane)).collect())
            }
            Pane::Tabs(panes) => (ContainerKind::Tabs, panes.iter().map(|pane| (1.0, pane)).collect()),
            Pane::View(_) => (ContainerKind::Tabs, vec![(1.0, pane)]),
        };
        let mut contents = Vec::new();
        for (_, pane) in &shared {
            contents.push(IncludedContent(self.pane(pane)?.into()));
        }
        let shares = shared.iter().map(|(share, _)| *share);
        let container = ContainerBlueprint::new(kind).with_contents(contents);
        let container = match kind {
            ContainerKind::Horizontal => container.with_col_shares(shares.map(|share| ColumnShare(Float32(share)))),
            ContainerKind::Vertical => container.with_row_shares(shares.map(|share| RowShare(Float32(share)))),
            _ => container,
        };
        let id = self.id();
        self.log(&format!("container/{}", text(id)), &container)?;
        Ok(id)
    }

    fn pane(&mut self, pane: &Pane) -> anyhow::Result<String> {
        match pane {
            Pane::View(view) => self.view(view),
            other => Ok(format!("container/{}", text(self.container(other)?))),
        }
    }

    fn view(&mut self, view: &View) -> anyhow::Result<String> {
        let path = format!("view/{}", text(self.id()));
        let contents = view.contents.iter().map(String::as_str);
        self.log(&format!("{path}/ViewContents"), &ViewContents::new(contents))?;
        let blueprint = ViewBlueprint::new(ViewClass(view.class.into()))
            .with_display_name(Name(view.name.as_str().into()))
            .with_space_origin(view.origin.as_str());
        self.log(&path, &blueprint)?;
        for (name, property) in &view.properties {
            self.log(&format!("{path}/{name}"), property.as_ref())?;
        }
        Ok(path)
    }
}

/// An id as paths have it.
fn text(id: Uuid) -> String {
    let mut text = String::with_capacity(36);
    for (place, byte) in id.bytes.iter().enumerate() {
        if [4, 6, 8, 10].contains(&place) {
            text.push('-');
        }
        let _ = write!(text, "{byte:02x}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_written_as_the_standard_has_it() {
        let id = Uuid { bytes: 0x0123_4567_89ab_cdef_0123_4567_89ab_cdef_u128.to_be_bytes() };
        assert_eq!(text(id), "01234567-89ab-cdef-0123-456789abcdef");
    }
}
