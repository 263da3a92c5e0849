//! A folder that is there once it is whole.

use std::{
    ffi::OsString,
    fs,
    path::{Path, PathBuf},
};

use crate::error::{ConvertError, at};

/// What shows that a folder was left by an interrupted call, and is nobody else's.
const MARK: &str = ".unfinished";

/// A folder that is being written, under another name.
#[derive(Debug)]
pub(crate) struct Output {
    part: PathBuf,
    whole: PathBuf,
}

impl Output {
    /// Begins a folder that is not there; what an interrupted call has left is begun anew.
    pub fn begin(whole: &Path) -> Result<Self, ConvertError> {
        let exists = |path: &Path| Err(ConvertError::Exists { path: path.to_owned() });
        let Some(name) = whole.file_name() else { return exists(whole) };
        if whole.symlink_metadata().is_ok() {
            return exists(whole);
        }
        let mut part_name = OsString::from(name);
        part_name.push(".part");
        let part = whole.with_file_name(part_name);
        if part.join(MARK).is_file() {
            fs::remove_dir_all(&part).map_err(at(&part))?;
        } else if part.symlink_metadata().is_ok() {
            return exists(&part);
        }
        fs::create_dir_all(&part).map_err(at(&part))?;
        let mark = part.join(MARK);
        fs::write(&mark, "").map_err(at(&mark))?;
        Ok(Self { part, whole: whole.to_owned() })
    }

    /// Where a file is written; the folders that it is in are made.
    pub fn path(&self, name: &str) -> Result<PathBuf, ConvertError> {
        let path = self.part.join(name);
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(at(folder))?;
        }
        Ok(path)
    }

    /// Writes a file.
    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> Result<(), ConvertError> {
        let path = self.path(name)?;
        fs::write(&path, bytes).map_err(at(&path))
    }

    /// Removes what was written: it will not be whole. What cannot be removed is begun anew the next time.
    pub fn discard(self) {
        let _ = fs::remove_dir_all(&self.part);
    }

    /// Gives the folder its name: all of it is there.
    pub fn finish(self) -> Result<(), ConvertError> {
        fs::rename(&self.part, &self.whole).map_err(at(&self.whole))?;
        let mark = self.whole.join(MARK);
        fs::remove_file(&mark).map_err(at(&mark))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_there_once_it_is_whole_and_nothing_is_overwritten() {
        let scratch = std::env::temp_dir().join(format!("cohabit-convert-output-{}", std::process::id()));
        let _ = fs::remove_dir_all(&scratch);
        let whole = scratch.join("set");
        let output = Output::begin(&whole).unwrap();
        output.write("a/b.txt", "first").unwrap();
        // An interrupted call: what it has left is begun anew.
        drop(output);
        assert!(!whole.exists());
        let output = Output::begin(&whole).unwrap();
        output.write("c.txt", "second").unwrap();
        output.finish().unwrap();
        let names: Vec<_> = fs::read_dir(&whole).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        assert_eq!(names, ["c.txt"]);
        assert!(matches!(Output::begin(&whole), Err(ConvertError::Exists { .. })));
        // A folder of that name that is somebody else's.
        fs::create_dir(scratch.join("other.part")).unwrap();
        assert!(matches!(Output::begin(&scratch.join("other")), Err(ConvertError::Exists { .. })));
        fs::remove_dir_all(&scratch).unwrap();
    }
}
