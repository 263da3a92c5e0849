//! Files that are written as a whole.

use std::{
    fs::{self, File, OpenOptions},
    io::{self, Write as _},
    os::unix::fs::{OpenOptionsExt as _, PermissionsExt as _},
    path::Path,
};

/// By whom a file may be read that was not there before.
#[derive(Clone, Copy, Debug)]
pub enum Readers {
    /// This user alone.
    Owner,
    /// Whoever may read the folder.
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

/// Writes a file, whole or not at all, also if the machine stops. One that was there keeps its mode.
///
/// # Errors
/// Of the file system; the file is then as it was.
pub fn write_whole(path: &Path, bytes: &[u8], readers: Readers) -> io::Result<()> {
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
        sync_folder(path)
    };
    // What came of a part of it, such as on a full disk, is of no use.
    written().inspect_err(|_| drop(fs::remove_file(new)))
}

/// Has the name of a file outlast a crash, too.
///
/// # Errors
/// Of the file system.
pub fn sync_folder(path: &Path) -> io::Result<()> {
    path.parent().map_or(Ok(()), |folder| File::open(folder)?.sync_all())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use cohabit_tests::Scratch;

    use super::*;

    #[test]
    fn a_file_is_replaced_keeps_its_mode_and_leaves_nothing_beside_it() {
        let scratch = Scratch::new("durable-whole");
        let path = scratch.path("file.json");
        let path = Path::new(&path);
        let mode = || fs::metadata(path).unwrap().permissions().mode() & 0o777;
        write_whole(path, b"one", Readers::Owner).unwrap();
        assert_eq!(mode(), 0o600);
        fs::set_permissions(path, fs::Permissions::from_mode(0o640)).unwrap();
        write_whole(path, b"two", Readers::Owner).unwrap();
        assert_eq!((fs::read(path).unwrap(), mode()), (b"two".to_vec(), 0o640));
        assert!(write_whole(&path.join("below"), b"", Readers::All).is_err());
        assert_eq!(fs::read_dir(path.parent().unwrap()).unwrap().count(), 1);
    }
}
