//! Reads the folder of a world pack. What it holds is `cohabit_cdf`'s to say; here are the bounds of what is read.

use std::{
    fs::{self, File},
    io::{self, Read as _},
    path::{Path, PathBuf},
};

use cohabit_cdf::{PackErrors, PackFile, WorldPack, world_pack};

/// How deep its folders lie within each other.
const DEEPEST: usize = 4;
/// The most files.
const MOST_FILES: usize = 1000;
/// The most bytes of a file.
const LARGEST_FILE: u64 = 8 << 20;
/// The most bytes of all files.
const LARGEST_PACK: u64 = 64 << 20;

/// Why a folder is not read as a world pack.
#[derive(Debug, thiserror::Error)]
pub enum WorldFolderError {
    /// It, or something in it, cannot be read.
    #[error("{}: {source}", .path.display())]
    Read {
        /// What.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// It is no folder.
    #[error("{}: no folder: a world pack is a folder", .0.display())]
    NoFolder(PathBuf),
    /// The name of a file is no text.
    #[error("{}: its name is no UTF-8 text: give the file another name", .0.display())]
    Name(PathBuf),
    /// A link leads elsewhere.
    #[error("{}: a link that leads out of the world pack: put a copy in its place", .0.display())]
    LeadsOut(PathBuf),
    /// Folders lie in each other too deep, or a link leads back to one of them.
    #[error(
        "{}: folders within each other are too deep, or lead back to themselves: at most {DEEPEST} in a pack",
        .0.display()
    )]
    Deep(PathBuf),
    /// Something that is neither a file nor a folder.
    #[error("{}: neither a file nor a folder: take it away", .0.display())]
    Kind(PathBuf),
    /// There are too many files; the first one that is too many.
    #[error("{}: the world pack has too many files: at most {MOST_FILES}", .0.display())]
    Files(PathBuf),
    /// A file is too large.
    #[error("{}: the file is too large: at most {LARGEST_FILE} bytes in a world pack", .0.display())]
    LargeFile(PathBuf),
    /// All files together are too large; the first one that is too much.
    #[error("{}: the world pack is too large by this file: at most {LARGEST_PACK} bytes in all", .0.display())]
    LargePack(PathBuf),
    /// What was read is no world pack.
    #[error(transparent)]
    Pack(#[from] PackErrors),
}

/// The world pack in a folder, or the one that is built in, where there is no such folder and it is called so. Files and folders whose names begin with a dot are no part of it.
///
/// # Errors
/// [`WorldFolderError`] names the file or the folder, and what is wrong with it.
pub fn read_world_folder(folder: &Path) -> Result<WorldPack, WorldFolderError> {
    let name = folder.display().to_string();
    Ok(WorldPack::parse(name.trim_end_matches('/'), world_folder_files(folder)?)?)
}

/// The files of the pack in a folder, or of the one that is built in, as [`read_world_folder`] finds it. Files and folders whose names begin with a dot are no part of it.
///
/// # Errors
/// [`WorldFolderError`] names the file or the folder, and what is wrong with it.
pub fn world_folder_files(folder: &Path) -> Result<Vec<PackFile>, WorldFolderError> {
    let root = match fs::canonicalize(folder) {
        Ok(root) => root,
        Err(source) => {
            let builtin = folder.to_str().and_then(world_pack::builtin_files);
            return builtin.ok_or_else(|| failed(folder, source));
        }
    };
    if !root.is_dir() {
        return Err(WorldFolderError::NoFolder(folder.to_owned()));
    }
    let mut reading = Reading { root: &root, files: Vec::new(), bytes: 0 };
    reading.take(folder, "", DEEPEST)?;
    Ok(reading.files)
}

fn failed(path: &Path, source: io::Error) -> WorldFolderError {
    WorldFolderError::Read { path: path.to_owned(), source }
}

struct Reading<'a> {
    /// The pack's folder, without links in its path.
    root: &'a Path,
    files: Vec<PackFile>,
    bytes: u64,
}

impl Reading<'_> {
    /// Takes in all of a folder; `prefix` is its path from the pack's, with a `/` behind it.
    fn take(&mut self, folder: &Path, prefix: &str, deeper: usize) -> Result<(), WorldFolderError> {
        for entry in fs::read_dir(folder).map_err(|source| failed(folder, source))? {
            let path = entry.map_err(|source| failed(folder, source))?.path();
            let name = path.file_name().unwrap_or_default().to_str();
            let name = name.ok_or_else(|| WorldFolderError::Name(path.clone()))?;
            if name.starts_with('.') {
                continue;
            }
            let real = fs::canonicalize(&path).map_err(|source| failed(&path, source))?;
            if !real.starts_with(self.root) {
                return Err(WorldFolderError::LeadsOut(path));
            }
            let inner = format!("{prefix}{name}");
            if real.is_dir() {
                if deeper == 0 {
                    return Err(WorldFolderError::Deep(path));
                }
                self.take(&path, &format!("{inner}/"), deeper - 1)?;
            } else if real.is_file() {
                self.add(&path, inner)?;
            } else {
                return Err(WorldFolderError::Kind(path));
            }
        }
        Ok(())
    }

    fn add(&mut self, path: &Path, inner: String) -> Result<(), WorldFolderError> {
        if self.files.len() == MOST_FILES {
            return Err(WorldFolderError::Files(path.to_owned()));
        }
        let mut bytes = Vec::new();
        let read = File::open(path).and_then(|file| file.take(LARGEST_FILE + 1).read_to_end(&mut bytes));
        read.map_err(|source| failed(path, source))?;
        let length = bytes.len() as u64;
        self.bytes += length;
        if length > LARGEST_FILE {
            return Err(WorldFolderError::LargeFile(path.to_owned()));
        }
        if self.bytes > LARGEST_PACK {
            return Err(WorldFolderError::LargePack(path.to_owned()));
        }
        self.files.push(PackFile { path: inner, bytes });
        Ok(())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::os::unix::fs::symlink;

    use cohabit_cdf::world_pack::template;

    use super::*;

    /// A folder of this test's own with the template in it.
    fn pack(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("cohabit-world-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        for (path, text) in template("my-lab") {
            let path = folder.join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        folder
    }

    #[test]
    fn a_folder_is_read_with_its_files_below_it() {
        let folder = pack("whole");
        let read_once = read_world_folder(&folder).unwrap();
        fs::create_dir(folder.join(".git")).unwrap();
        fs::write(folder.join(".git/config"), "x").unwrap();
        assert_eq!(read_world_folder(&folder).unwrap().id(), read_once.id());
        symlink("missions/clean_wrench.json", folder.join("link.json")).unwrap();
        assert_ne!(read_world_folder(&folder).unwrap().id(), read_once.id());
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn what_does_not_belong_into_a_pack_is_refused_in_words() {
        let check = |name: &str, spoil: &dyn Fn(&Path), expected: &str| {
            let folder = pack(name);
            spoil(&folder);
            let error = read_world_folder(&folder).unwrap_err().to_string();
            fs::remove_dir_all(folder).unwrap();
            assert!(error.contains(expected), "{name}: {error}");
        };
        check("out", &|folder| symlink("/etc/passwd", folder.join("objects/more.toml")).unwrap(), "leads out of");
        check("up", &|folder| symlink("..", folder.join("more")).unwrap(), "leads out of");
        check("circle", &|folder| symlink(".", folder.join("more")).unwrap(), "lead back to themselves");
        check("dangling", &|folder| symlink("nowhere", folder.join("more")).unwrap(), "more: ");
        let large = |folder: &Path| {
            File::create(folder.join("large.bin")).unwrap().set_len(LARGEST_FILE + 1).unwrap();
        };
        check("large", &large, "too large");
        check("headless", &|folder| fs::remove_file(folder.join("world.toml")).unwrap(), "there is no `world.toml`");
    }

    #[test]
    fn what_is_no_folder_is_refused() {
        let error = read_world_folder(Path::new("/nowhere/at/all")).unwrap_err().to_string();
        assert!(error.contains("/nowhere/at/all: "), "{error}");
    }
}
