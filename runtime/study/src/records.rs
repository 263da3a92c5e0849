//! All that a study's folder has of its participants, to be read while the study runs, too.

use std::path::Path;

use crate::{
    design::Study,
    folder::{Folder, FolderError, Note},
    journal::Journal,
    plan::pseudonym,
    progress::{Phase, Progress},
};

/// All that a study's folder has of its participants, but for logs.
#[derive(Clone, Debug, PartialEq)]
pub struct Records {
    /// The study.
    pub study: Study,
    /// Where each participant is, in the order of their places.
    pub progress: Vec<Progress>,
    /// Those whose data were removed.
    pub withdrawn: Vec<String>,
    /// The experimenter's notes.
    pub notes: Vec<Note>,
    /// Whether programs played all of them.
    pub is_synthetic: bool,
}

impl Records {
    /// Reads those of a study from its folder, which somebody else may hold.
    ///
    /// # Errors
    /// [`FolderError`].
    pub fn read(study: Study, folder: &Path) -> Result<Self, FolderError> {
        let journals = Folder::journals_in(folder)?;
        let read = journals.iter().map(|path| Journal::read(path)).collect::<Result<Vec<_>, _>>()?;
        let progress: Vec<Progress> = read.into_iter().flatten().collect();
        if let Some(leaving) = progress.iter().find(|one| *one.phase() == Phase::Withdrawn) {
            return Err(FolderError::Leaving { path: folder.to_owned(), pseudonym: pseudonym(leaving.plan().place) });
        }
        let withdrawn = Folder::withdrawals_in(folder)?;
        Ok(Self {
            study,
            progress,
            withdrawn: withdrawn.into_iter().map(|one| one.participant).collect(),
            notes: Folder::notes_in(folder)?,
            is_synthetic: Folder::is_synthetic_in(folder),
        })
    }
}
