//! Files of lines that are appended one after the other.

use std::{
    fs::File,
    io::{self, Read as _, Seek as _, SeekFrom, Write as _},
    path::PathBuf,
};

use serde::Serialize;

/// A file of JSON lines, each on the disk before anything follows from it.
#[derive(Debug)]
pub struct LineFile {
    path: PathBuf,
    file: File,
    /// How long its whole lines are, in bytes.
    length: u64,
}

impl LineFile {
    /// Goes on with a file that was opened to be read and written; gives its whole lines. What a crash left of a line behind them
    /// has to be dropped before another is appended: [`Self::drop_rest`].
    ///
    /// # Errors
    /// Of the file system.
    pub fn new(path: PathBuf, mut file: File) -> io::Result<(Self, Vec<u8>)> {
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes)?;
        bytes.truncate(whole_lines(&bytes).len());
        Ok((Self { path, file, length: bytes.len() as u64 }, bytes))
    }

    /// Appends a value as a line; it is on the disk when this is back.
    ///
    /// # Errors
    /// Of the file system, such as a full disk; the line is not in the file then.
    pub fn append(&mut self, value: &impl Serialize) -> io::Result<()> {
        let written = serde_json::to_vec(value).map_err(io::Error::from).and_then(|mut bytes| {
            bytes.push(b'\n');
            self.file.write_all(&bytes)?;
            self.file.sync_data()?;
            Ok(bytes.len() as u64)
        });
        match written {
            Ok(bytes) => {
                self.length += bytes;
                Ok(())
            }
            Err(source) => {
                // What came of a part of it is taken back.
                if let Err(error) = self.drop_rest() {
                    tracing::error!("{}: {error}", self.path.display());
                }
                Err(source)
            }
        }
    }

    /// Drops what is behind the last whole line.
    ///
    /// # Errors
    /// Of the file system.
    pub fn drop_rest(&mut self) -> io::Result<()> {
        self.file.set_len(self.length)?;
        self.file.seek(SeekFrom::Start(self.length)).map(drop)
    }
}

/// The lines that were not cut off.
#[must_use]
pub fn whole_lines(bytes: &[u8]) -> &[u8] {
    &bytes[..bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |last| last + 1)]
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::{fs, fs::OpenOptions, path::Path};

    use cohabit_tests::Scratch;

    use super::*;

    fn open(path: &Path) -> (LineFile, Vec<u8>) {
        let file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path).unwrap();
        LineFile::new(path.to_owned(), file).unwrap()
    }

    #[test]
    fn wherever_it_is_cut_off_whole_lines_stay_and_more_follow() {
        let scratch = Scratch::new("durable-lines");
        let path = scratch.path("lines.jsonl");
        let path = Path::new(&path);
        let (mut lines, before) = open(path);
        assert!(before.is_empty());
        ["one", "two"].iter().for_each(|value| lines.append(value).unwrap());
        let whole = fs::read(path).unwrap();
        assert_eq!(whole, b"\"one\"\n\"two\"\n");
        for end in 0..=whole.len() {
            fs::write(path, &whole[..end]).unwrap();
            let (mut lines, known) = open(path);
            assert_eq!(known, whole_lines(&whole[..end]), "{end}");
            lines.drop_rest().unwrap();
            lines.append(&3).unwrap();
            assert_eq!(fs::read(path).unwrap(), [&known[..], b"3\n"].concat(), "{end}");
        }
    }
}
