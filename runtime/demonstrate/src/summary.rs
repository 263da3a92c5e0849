//! How much there is in a data set that was made.

/// What came of making a data set.
#[derive(Clone, Debug, Default, Eq, PartialEq)]
pub struct Summary {
    /// Episodes in the data set.
    pub episodes: usize,
    /// Their steps.
    pub steps: usize,
    /// The questions about them.
    pub questions: usize,
    /// Their frames; each has a picture in each modality.
    pub frames: usize,
    /// Missions that were left out, and why.
    pub left_out: Vec<(String, String)>,
}
