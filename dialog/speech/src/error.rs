//! What goes wrong with speech. None of it stops text.

use std::path::PathBuf;

/// Why an engine could not be opened, or could not do its work.
#[derive(Debug, thiserror::Error)]
pub enum SpeechError {
    /// A file of an engine is not there.
    #[error("find {path}: there is no such file; {remedy}", path = path.display())]
    Missing {
        /// The file.
        path: PathBuf,
        /// What to do about it.
        remedy: String,
    },
    /// A file of an engine is not what it should be.
    #[error("use {path}: {why}; {remedy}", path = path.display())]
    Broken {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        why: String,
        /// What to do about it.
        remedy: String,
    },
    /// A program that an engine needs did not do its work.
    #[error("run {program}: {why}; {remedy}")]
    Program {
        /// Its name.
        program: &'static str,
        /// What it said, or the system said of it.
        why: String,
        /// What to do about it.
        remedy: &'static str,
    },
    /// A server of speech did not do its work.
    #[error("use the speech server at {address}: {why}; see that it runs, or name another")]
    Server {
        /// Host and port.
        address: String,
        /// What went wrong.
        why: String,
    },
    /// An engine failed on what it was given.
    #[error("run {engine}: {why}")]
    Engine {
        /// Its name.
        engine: &'static str,
        /// What it said.
        why: String,
    },
    /// The sound is none that can be worked with.
    #[error("read the sound: {0}")]
    Sound(String),
    /// A setting means nothing.
    #[error("understand the voice setting {given:?}: {remedy}")]
    Setting {
        /// What it was set to.
        given: String,
        /// What it may be set to.
        remedy: &'static str,
    },
}

impl SpeechError {
    /// What to do about it; nothing, where nothing is known to help.
    #[must_use]
    pub fn remedy(&self) -> &str {
        match self {
            Self::Missing { remedy, .. } | Self::Broken { remedy, .. } => remedy,
            Self::Program { remedy, .. } | Self::Setting { remedy, .. } => remedy,
            Self::Server { .. } => "see that the speech server runs, or name another",
            Self::Engine { .. } | Self::Sound(_) => "",
        }
    }
}
