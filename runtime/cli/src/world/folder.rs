//! Reads the folder of a world pack. What it holds is `cohabit_cdf`'s to say; here are the bounds of what is read.

use std::{
    fs::{self, File},
    io::Read as _,
    path::Path,
};

use cohabit_cdf::{PackFile, WorldPack};

use crate::failure::bad_input;

/// How deep its folders lie within each other.
const DEEPEST: usize = 4;
/// The most files.
const MOST_FILES: usize = 1000;
/// The most bytes of a file.
const LARGEST_FILE: u64 = 8 << 20;
/// The most bytes of all files.
const LARGEST_PACK: u64 = 64 << 20;

/// The pack in a folder.
pub fn read(folder: &Path) -> anyhow::Result<WorldPack> {
    let name = folder.display().to_string();
    WorldPack::parse(name.trim_end_matches('/'), files(folder)?).map_err(bad_input)
}

/// The files of the pack in a folder. Files and folders whose names begin with a dot are no part of it.
pub fn files(folder: &Path) -> anyhow::Result<Vec<PackFile>> {
    let root = fs::canonicalize(folder).map_err(|error| bad_input(format!("{}: {error}", folder.display())))?;
    if !root.is_dir() {
        return Err(bad_input(format!("{}: no folder: `--world` takes the folder of a world pack", folder.display())));
    }
    let mut reading = Reading { root: &root, files: Vec::new(), bytes: 0 };
    reading.take(folder, "", DEEPEST)?;
    Ok(reading.files)
}

struct Reading<'a> {
    /// The pack's folder, without links in its path.
    root: &'a Path,
    files: Vec<PackFile>,
    bytes: u64,
}

impl Reading<'_> {
    /// Takes in all of a folder; `prefix` is its path from the pack's, with a `/` behind it.
    fn take(&mut self, folder: &Path, prefix: &str, deeper: usize) -> anyhow::Result<()> {
        let failed = |path: &Path, error: std::io::Error| bad_input(format!("{}: {error}", path.display()));
        for entry in fs::read_dir(folder).map_err(|error| failed(folder, error))? {
            let path = entry.map_err(|error| failed(folder, error))?.path();
            let name = path.file_name().unwrap_or_default().to_str().ok_or_else(|| {
                bad_input(format!("{}: its name is no UTF-8 text: give the file another name", path.display()))
            })?;
            if name.starts_with('.') {
                continue;
            }
            let real = fs::canonicalize(&path).map_err(|error| failed(&path, error))?;
            if !real.starts_with(self.root) {
                let leads = "leads out of the world pack";
                return Err(bad_input(format!("{}: a link that {leads}: put a copy in its place", path.display())));
            }
            let inner = format!("{prefix}{name}");
            if real.is_dir() {
                if deeper == 0 {
                    let message = "folders within each other are too deep, or lead back to themselves";
                    return Err(bad_input(format!("{}: {message}: at most {DEEPEST} in a pack", path.display())));
                }
                self.take(&path, &format!("{inner}/"), deeper - 1)?;
            } else if real.is_file() {
                self.add(&path, inner)?;
            } else {
                return Err(bad_input(format!("{}: neither a file nor a folder: take it away", path.display())));
            }
        }
        Ok(())
    }

    fn add(&mut self, path: &Path, inner: String) -> anyhow::Result<()> {
        let refused = |what: String| Err(bad_input(format!("{}: {what}", path.display())));
        if self.files.len() == MOST_FILES {
            return refused(format!("the world pack has too many files: at most {MOST_FILES}"));
        }
        let mut bytes = Vec::new();
        let read = File::open(path).and_then(|file| file.take(LARGEST_FILE + 1).read_to_end(&mut bytes));
        read.map_err(|error| bad_input(format!("{}: {error}", path.display())))?;
        let length = bytes.len() as u64;
        self.bytes += length;
        if length > LARGEST_FILE {
            return refused(format!("the file is too large: at most {LARGEST_FILE} bytes in a world pack"));
        }
        if self.bytes > LARGEST_PACK {
            return refused(format!("the world pack is too large by this file: at most {LARGEST_PACK} bytes in all"));
        }
        self.files.push(PackFile { path: inner, bytes });
        Ok(())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::{os::unix::fs::symlink, path::PathBuf};

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
        let read_once = read(&folder).unwrap();
        fs::create_dir(folder.join(".git")).unwrap();
        fs::write(folder.join(".git/config"), "x").unwrap();
        assert_eq!(read(&folder).unwrap().id(), read_once.id());
        symlink("missions/clean_wrench.json", folder.join("link.json")).unwrap();
        assert_ne!(read(&folder).unwrap().id(), read_once.id());
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn what_does_not_belong_into_a_pack_is_refused_in_words() {
        let check = |name: &str, spoil: &dyn Fn(&Path), expected: &str| {
            let folder = pack(name);
            spoil(&folder);
            let error = format!("{:#}", read(&folder).unwrap_err());
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
        let error = format!("{:#}", read(Path::new("/nowhere/at/all")).unwrap_err());
        assert!(error.contains("/nowhere/at/all: "), "{error}");
    }
}
