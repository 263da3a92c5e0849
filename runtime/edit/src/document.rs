//! What can be edited.

use cohabit_cdf::Layout;
use cohabit_render::Instance;
use serde::Serialize;
use serde_json::Value;

/// What a picture shows.
#[derive(Debug)]
pub struct Drawn {
    /// The floor plan.
    pub layout: Layout,
    /// What stands in it.
    pub instances: Vec<Instance>,
}

/// How a mission is solved.
#[derive(Clone, Debug, Serialize)]
pub struct Tried {
    /// What is done, as people say it.
    pub steps: Vec<String>,
    /// How long that takes in the world, s.
    pub seconds: u64,
}

/// A kind of file: how edits change its text, what the page shows of it, and what is drawn. All of it follows from the text alone.
pub trait Document: Send + Sync {
    /// What the page takes it for.
    fn kind(&self) -> &'static str;

    /// The text after an edit of the page.
    ///
    /// # Errors
    /// Why that cannot be, in words.
    fn edited(&self, text: &str, edit: Value) -> Result<String, String>;

    /// What the page shows of a text, with what is wrong in it.
    fn shown(&self, text: &str) -> Value;

    /// What the page offers whatever the text is.
    fn choices(&self) -> Value;

    /// What is drawn, if it can be.
    fn drawn(&self, text: &str) -> Option<Drawn>;

    /// Whether nothing is wrong in a text.
    fn is_sound(&self, text: &str) -> bool;

    /// The mission that is played to look at it (CDF).
    fn mission(&self, text: &str) -> String;

    /// How the planner solves it, or why it does not, in words; nothing for what has nothing to be solved.
    fn tried(&self, _text: &str) -> Option<Result<Tried, String>> {
        None
    }
}
