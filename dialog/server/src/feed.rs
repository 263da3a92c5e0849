//! What one page sees through the camera that it chose: the frames, and where in them the answers to an open question are.

use std::sync::Arc;

use axum::extract::ws::Message;
use cohabit_cdf::ObjectId;
use serde_json::Value;
use tokio::sync::watch;

use crate::{
    page,
    view::{Frame, View, Viewing},
};

/// One page's feed of a camera.
pub struct Feed {
    view: Arc<View>,
    frames: watch::Receiver<Option<Frame>>,
    _viewing: Viewing,
    marks: Marks,
}

/// Where the numbered answers to an open question are in the picture, as a page was told.
#[derive(Default)]
struct Marks(Vec<(usize, [f32; 2])>);

impl Feed {
    /// The feed of a camera, the newest frame first.
    pub fn new(view: Arc<View>) -> Self {
        let (frames, viewing) = joined(&view);
        Self { view, frames, _viewing: viewing, marks: Marks::default() }
    }

    /// The camera.
    pub const fn view(&self) -> &Arc<View> {
        &self.view
    }

    /// Goes over to another camera.
    pub fn turn_to(&mut self, view: Arc<View>) {
        (self.frames, self._viewing) = joined(&view);
        self.view = view;
    }

    /// Waits for a frame that was not taken yet.
    ///
    /// # Errors
    /// When the camera is gone.
    pub async fn changed(&mut self) -> Result<(), watch::error::RecvError> {
        self.frames.changed().await
    }

    /// The newest frame.
    pub fn frame(&mut self) -> Option<Message> {
        let frame = self.frames.borrow_and_update().clone();
        frame.map(|frame| Message::binary(frame.to_vec()))
    }

    /// Where these objects, the answers to an open question, are in the newest frame, if that is news to the page.
    pub fn marks(&mut self, numbered: &[ObjectId]) -> Option<Message> {
        self.marks.news(&self.view, numbered).map(|marks| Message::text(marks.to_string()))
    }
}

impl Marks {
    fn news(&mut self, view: &View, numbered: &[ObjectId]) -> Option<Value> {
        if numbered.is_empty() && self.0.is_empty() {
            return None;
        }
        let places = (1..).zip(view.places(numbered));
        let marks: Vec<_> = places.filter_map(|(number, place)| Some((number, place?))).collect();
        (marks != self.0).then(|| {
            self.0 = marks;
            page::marks(view.camera, &self.0)
        })
    }
}

fn joined(view: &Arc<View>) -> (watch::Receiver<Option<Frame>>, Viewing) {
    let (mut frames, viewing) = view.join();
    frames.mark_changed();
    (frames, viewing)
}
