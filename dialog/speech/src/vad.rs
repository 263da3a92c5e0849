//! Voice activity: how likely somebody is speaking, window by window.

use crate::SpeechError;

/// Samples of a window: 32 ms.
pub const WINDOW: usize = 512;

/// Tells speech from all else.
pub trait Vad: Send {
    /// How likely there is speech in the window that follows the one before, from 0 to 1.
    ///
    /// # Errors
    /// [`SpeechError::Engine`] if its engine fails.
    fn speech(&mut self, window: &[f32; WINDOW]) -> Result<f32, SpeechError>;

    /// Forgets what it heard: what comes next does not follow it.
    fn reset(&mut self);

    /// What it is, for people.
    fn name(&self) -> &str;
}
