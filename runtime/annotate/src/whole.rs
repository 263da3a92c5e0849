//! Files that are whole or not there, also after a crash.

use std::{
    fs::{self, File, OpenOptions},
    io::Write as _,
    os::unix::fs::{OpenOptionsExt as _, PermissionsExt as _},
    path::Path,
};

use crate::error::{AnnotateError, at};

/// What a file may be read by that was not there before.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Readers {
    /// This user alone.
    Owner,
    /// Whoever may read the data set.
    All,
}

impl Readers {
    const fn mode(self) -> u32 {
        match self {
            Self::Owner => 0o600,
            Self::All => 0o666,
        }
    }
}

/// Writes a file, whole or not at all. One that is there before keeps its mode.
pub(crate) fn write(path: &Path, bytes: &[u8], readers: Readers) -> Result<(), AnnotateError> {
    let mut new = path.as_os_str().to_owned();
    new.push(".new");
    let new = Path::new(&new);
    let written = || {
        let mut file = OpenOptions::new().write(true).create(true).truncate(true).mode(readers.mode()).open(new)?;
        if let Ok(before) = fs::metadata(path) {
            file.set_permissions(fs::Permissions::from_mode(before.permissions().mode()))?;
        }
        file.write_all(bytes)?;
        file.sync_all()?;
        fs::rename(new, path)?;
        // The name, too, outlasts a crash.
        path.parent().map_or(Ok(()), |folder| File::open(folder)?.sync_all())
    };
    written().map_err(|source| {
        // What came of a part of it, such as on a full disk, is of no use.
        let _ = fs::remove_file(new);
        at(path)(source)
    })
}
