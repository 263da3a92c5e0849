//! Files and folders that belong to this user alone: made so, and checked before anything in them is trusted.
//!
//! `/dev/shm` and `/tmp` can be written by every user of the machine, so a name there may already be taken by a file,
//! a folder or a symbolic link of somebody else.

use std::{
    fs::{self, DirBuilder, File, Metadata, Permissions},
    io,
    os::unix::fs::{DirBuilderExt as _, FileTypeExt as _, MetadataExt as _, OpenOptionsExt as _, PermissionsExt as _},
    path::{Path, PathBuf},
};

use rustix::fs::{OFlags, RawMode};

/// Why a file or a folder is not used.
#[derive(Debug, thiserror::Error)]
pub enum AccessError {
    /// It belongs to another user.
    #[error("{path} belongs to user {owner}, not to this one: have it removed, or {remedy}")]
    Owner {
        /// Which.
        path: PathBuf,
        /// Whose it is, by number.
        owner: u32,
        /// What else can be done.
        remedy: &'static str,
    },
    /// Other users can reach it.
    #[error("{path} can be reached by other users (mode {mode:04o}): chmod {wanted:o} {path}, or {remedy}")]
    Mode {
        /// Which.
        path: PathBuf,
        /// Its mode.
        mode: u32,
        /// The mode that it should have.
        wanted: u32,
        /// What else can be done.
        remedy: &'static str,
    },
    /// It is something else, such as a symbolic link.
    #[error("{path} is {found}, not {wanted}: remove it")]
    Kind {
        /// Which.
        path: PathBuf,
        /// What it is.
        found: &'static str,
        /// What it should be.
        wanted: &'static str,
    },
    /// The system refused it.
    #[error("{path}: {source}")]
    System {
        /// Which.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
}

const OF_FOLDERS: &str = "set XDG_RUNTIME_DIR to a folder of your own with mode 700";
const OF_FILES: &str = "choose another `--session` name";
const FOLDER: &str = "a folder";
const FILE: &str = "a regular file";
/// Whoever is not the owner.
const OTHERS: RawMode = 0o077;
/// All users, writing. A group that may write is one that the folder's owner trusts.
const OTHERS_WRITE: RawMode = 0o002;
/// Whoever may write to a folder may then rename and remove only what is their own.
const STICKY: RawMode = 0o1000;

/// The user that this process acts as, by number.
pub(crate) fn user() -> u32 {
    rustix::process::geteuid().as_raw()
}

/// Makes a folder for this user alone, unless there is one.
pub(crate) fn make_folder(path: &Path) -> Result<(), AccessError> {
    match DirBuilder::new().mode(0o700).create(path) {
        Err(error) if error.kind() != io::ErrorKind::AlreadyExists => Err(system(path, error)),
        _ => check_folder(path),
    }
}

/// Takes other users' rights to the folders in one of this user alone, which a library has made with them.
pub(crate) fn close_folders(path: &Path) {
    for entry in fs::read_dir(path).into_iter().flatten().flatten() {
        // Others come and go meanwhile, and none of them can be reached through this one.
        let Ok(found) = entry.metadata() else { continue };
        if found.is_dir() {
            if found.mode() & OTHERS != 0 {
                let _ = fs::set_permissions(entry.path(), Permissions::from_mode(0o700));
            }
            close_folders(&entry.path());
        }
    }
}

/// Checks that a folder is there, and this user's alone.
pub(crate) fn check_folder(path: &Path) -> Result<(), AccessError> {
    let found = fs::symlink_metadata(path).map_err(|error| system(path, error))?;
    if !found.is_dir() {
        return Err(AccessError::Kind { path: path.to_owned(), found: kind(&found), wanted: FOLDER });
    }
    check(path, &found, user(), 0o700, OF_FOLDERS)
}

/// Checks that nobody but this user and the system's administrator can rename or remove what this user has in a folder.
pub(crate) fn check_parent(path: &Path) -> Result<(), AccessError> {
    let found = fs::metadata(path).map_err(|error| system(path, error))?;
    let (path, mode, owner) = (path.to_owned(), found.mode() & 0o7777, found.uid());
    if owner != user() && owner != 0 {
        return Err(AccessError::Owner { path, owner, remedy: OF_FOLDERS });
    }
    if mode & OTHERS_WRITE != 0 && mode & STICKY == 0 {
        return Err(AccessError::Mode { path, mode, wanted: mode & !OTHERS_WRITE, remedy: OF_FOLDERS });
    }
    Ok(())
}

/// Opens a file of this user alone; makes it if it is not there.
pub(crate) fn open_or_create(path: &Path) -> Result<File, AccessError> {
    open_checked(path, user(), true)
}

/// Opens a file of this user alone.
pub(crate) fn open(path: &Path) -> Result<File, AccessError> {
    open_checked(path, user(), false)
}

/// Makes a file for this user alone, which is not there yet.
pub(crate) fn create_new(path: &Path) -> Result<File, AccessError> {
    // A symbolic link counts as being there.
    let made = File::options().read(true).write(true).create_new(true).mode(0o600).open(path);
    made.map_err(|error| system(path, error))
}

/// Whether a path still leads to this file.
pub(crate) fn is_at(file: &File, path: &Path) -> bool {
    let same = |one: &Metadata, other: &Metadata| (one.dev(), one.ino()) == (other.dev(), other.ino());
    matches!((file.metadata(), fs::symlink_metadata(path)), (Ok(one), Ok(other)) if same(&one, &other))
}

/// Checks that a file belongs to this user, whatever its mode: who makes it may not have finished yet.
pub(crate) fn check_owner(path: &Path, found: &Metadata) -> Result<(), AccessError> {
    check(path, found, user(), 0o7777, OF_FILES)
}

fn open_checked(path: &Path, owner: u32, create: bool) -> Result<File, AccessError> {
    // Without waiting: the other end of a pipe that somebody has put there may never come.
    let flags = OFlags::NOFOLLOW | OFlags::NONBLOCK;
    let flags = i32::try_from(flags.bits()).unwrap_or_default();
    let opened = File::options()
        .read(true)
        .write(true)
        .create(create)
        .truncate(false)
        .mode(0o600)
        .custom_flags(flags)
        .open(path);
    let file = opened.map_err(|error| why_not_opened(path, owner, error))?;
    let found = file.metadata().map_err(|error| system(path, error))?;
    check_file_of(path, &found, owner)?;
    Ok(file)
}

/// Why a file could not be opened; more than the system says, where it is known.
fn why_not_opened(path: &Path, owner: u32, error: io::Error) -> AccessError {
    let found = fs::symlink_metadata(path).ok().and_then(|found| check_file_of(path, &found, owner).err());
    found.unwrap_or_else(|| system(path, error))
}

fn check_file_of(path: &Path, found: &Metadata, owner: u32) -> Result<(), AccessError> {
    // A file with another name elsewhere may be somebody's who trusts it there.
    if !found.is_file() || found.nlink() > 1 {
        return Err(AccessError::Kind { path: path.to_owned(), found: kind(found), wanted: FILE });
    }
    check(path, found, owner, 0o600, OF_FILES)
}

fn check(path: &Path, found: &Metadata, user: u32, wanted: u32, remedy: &'static str) -> Result<(), AccessError> {
    let (path, owner, mode) = (path.to_owned(), found.uid(), found.mode() & 0o7777);
    if owner != user {
        return Err(AccessError::Owner { path, owner, remedy });
    }
    if mode & OTHERS & !wanted != 0 {
        return Err(AccessError::Mode { path, mode, wanted, remedy });
    }
    Ok(())
}

fn kind(found: &Metadata) -> &'static str {
    let kind = found.file_type();
    if kind.is_symlink() {
        "a symbolic link"
    } else if kind.is_dir() {
        FOLDER
    } else if kind.is_file() && found.nlink() > 1 {
        "a file with a second name"
    } else if kind.is_file() {
        FILE
    } else if kind.is_fifo() {
        "a pipe"
    } else {
        "a device or a socket"
    }
}

fn system(path: &Path, source: io::Error) -> AccessError {
    AccessError::System { path: path.to_owned(), source }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::os::unix::fs::symlink;

    use super::*;

    /// A folder of a test's own, which goes when this is dropped.
    struct Folder(PathBuf);

    impl Folder {
        fn new(test: &str) -> Self {
            let path = std::env::temp_dir().join(format!("cohabit-private-{}-{test}", std::process::id()));
            let _ = fs::remove_dir_all(&path);
            DirBuilder::new().mode(0o700).create(&path).unwrap();
            Self(path)
        }

        fn at(&self, name: &str) -> PathBuf {
            self.0.join(name)
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    fn set_mode(path: &Path, mode: u32) {
        fs::set_permissions(path, Permissions::from_mode(mode)).unwrap();
    }

    #[test]
    fn files_are_made_for_one_user_and_opened_again() {
        let folder = Folder::new("files");
        let path = folder.at("file");
        assert!(matches!(open(&path), Err(AccessError::System { .. })));
        let file = open_or_create(&path).unwrap();
        assert_eq!(file.metadata().unwrap().mode() & 0o7777, 0o600);
        assert!(is_at(&open_or_create(&path).unwrap(), &path));
        assert!(create_new(&path).is_err());
        fs::remove_file(&path).unwrap();
        assert!(!is_at(&file, &path));
    }

    #[test]
    fn a_planted_file_is_refused_and_left_as_it_is() {
        let folder = Folder::new("planted");
        let (victim, path) = (folder.at("victim"), folder.at("file"));
        fs::write(&victim, "mine").unwrap();
        set_mode(&victim, 0o600);
        symlink(&victim, &path).unwrap();
        let error = open_or_create(&path).unwrap_err();
        assert!(error.to_string().contains("a symbolic link"), "{error}");
        assert!(create_new(&path).is_err());
        fs::remove_file(&path).unwrap();
        fs::hard_link(&victim, &path).unwrap();
        let error = open_or_create(&path).unwrap_err();
        assert!(error.to_string().contains("second name"), "{error}");
        fs::remove_file(&path).unwrap();
        set_mode(&victim, 0o666);
        let error = open_or_create(&victim).unwrap_err();
        assert!(error.to_string().contains("0666") && error.to_string().contains("chmod 600"), "{error}");
        assert!(matches!(open_or_create(&folder.0), Err(AccessError::Kind { .. })));
        assert_eq!(fs::read_to_string(&victim).unwrap(), "mine");
    }

    #[test]
    fn another_users_file_is_refused() {
        let folder = Folder::new("foreign");
        let path = folder.at("file");
        drop(create_new(&path).unwrap());
        let error = open_checked(&path, user() + 1, true).unwrap_err();
        assert!(matches!(error, AccessError::Owner { owner, .. } if owner == user()), "{error}");
    }

    #[test]
    fn folders_are_made_for_one_user_and_others_are_refused() {
        let folder = Folder::new("folders");
        let path = folder.at("own");
        make_folder(&path).unwrap();
        make_folder(&path).unwrap();
        set_mode(&path, 0o755);
        let error = make_folder(&path).unwrap_err();
        assert!(error.to_string().contains("chmod 700") && error.to_string().contains("XDG_RUNTIME_DIR"), "{error}");
        let link = folder.at("link");
        symlink(&folder.0, &link).unwrap();
        assert!(matches!(make_folder(&link), Err(AccessError::Kind { .. })));
        check_parent(&folder.0).unwrap();
        check_parent(&std::env::temp_dir()).unwrap();
        set_mode(&path, 0o777);
        assert!(matches!(check_parent(&path), Err(AccessError::Mode { wanted: 0o775, .. })));
        set_mode(&path, 0o1777);
        check_parent(&path).unwrap();
    }
}
