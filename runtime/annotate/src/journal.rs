//! The journal of annotations: a JSON line each, on the disk before its page hears that it is saved. A line that was cut off by a
//! crash was never said to be saved, and is dropped.

use std::{
    fs::{DirBuilder, OpenOptions, TryLockError},
    io,
    os::unix::fs::{DirBuilderExt as _, OpenOptionsExt as _},
    path::{Path, PathBuf},
};

use cohabit_durable::{LineFile, sync_folder, whole_lines};

use crate::{
    error::{AnnotateError, at},
    task::Annotation,
};

/// An open journal, held by this process alone.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    lines: LineFile,
}

impl Journal {
    /// Opens a journal, or begins it, with its folder; gives what is in it.
    ///
    /// # Errors
    /// [`AnnotateError::File`], [`AnnotateError::Busy`], [`AnnotateError::Line`].
    pub fn open(path: &Path) -> Result<(Self, Vec<Annotation>), AnnotateError> {
        if let Some(folder) = path.parent() {
            DirBuilder::new().recursive(true).mode(0o700).create(folder).map_err(at(folder))?;
        }
        let opened = OpenOptions::new().read(true).write(true).create(true).truncate(false).mode(0o600).open(path);
        let file = opened.map_err(at(path))?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(AnnotateError::Busy { path: path.to_owned() }),
            Err(TryLockError::Error(source)) => return Err(at(path)(source)),
        }
        sync_folder(path).map_err(at(path))?;
        let (mut lines, bytes) = LineFile::new(path.to_owned(), file).map_err(at(path))?;
        let annotations = parsed(path, &bytes)?;
        lines.drop_rest().map_err(at(path))?;
        Ok((Self { path: path.to_owned(), lines }, annotations))
    }

    /// What is in a journal that somebody else may be writing; nothing, where there is none.
    ///
    /// # Errors
    /// [`AnnotateError::File`], [`AnnotateError::Line`].
    pub fn read(path: &Path) -> Result<Vec<Annotation>, AnnotateError> {
        match std::fs::read(path) {
            Ok(bytes) => parsed(path, whole_lines(&bytes)),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
            Err(error) => Err(at(path)(error)),
        }
    }

    /// Writes an annotation down; it is on the disk when this is back.
    ///
    /// # Errors
    /// [`AnnotateError::File`]; the annotation is not in it then.
    pub fn append(&mut self, annotation: &Annotation) -> Result<(), AnnotateError> {
        self.lines.append(annotation).map_err(at(&self.path))
    }
}

fn parsed(path: &Path, bytes: &[u8]) -> Result<Vec<Annotation>, AnnotateError> {
    let line = |(number, line): (usize, &[u8])| {
        serde_json::from_slice(line).map_err(|error| AnnotateError::Line {
            path: path.to_owned(),
            line: number,
            reason: error.to_string(),
        })
    };
    (1..).zip(bytes.split_inclusive(|byte| *byte == b'\n')).map(line).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::fs;

    use cohabit_tests::Scratch;

    use super::*;
    use crate::task::{Reading, Reason, Segment, Task, What};

    fn annotation(id: u64, what: What, corrects: Option<u64>) -> Annotation {
        let segment = Segment { episode: "episodes/000000".to_owned(), first_step: 0, end_step: 4 };
        let instruction = Reading { id: 0, text: "get \"it\"".to_owned() };
        let task = Task::Question { segment, moment_step: 2, instruction };
        Annotation { id, annotator: "A01".to_owned(), task, what, taken_ms: 7, at_ms: 9, corrects }
    }

    #[test]
    fn who_is_killed_loses_no_more_than_a_line_that_was_cut_off() {
        let scratch = Scratch::new("annotate-journal");
        let path = scratch.path("annotations/journal.jsonl");
        let path = Path::new(&path);
        let all = [
            annotation(0, What::Text("Which one?\u{2028}".to_owned()), None),
            annotation(1, What::Skipped(Reason::CannotTell), None),
            annotation(2, What::Text("Which red one?".to_owned()), Some(0)),
        ];
        let (mut journal, before) = Journal::open(path).unwrap();
        assert!(before.is_empty());
        all.iter().for_each(|one| journal.append(one).unwrap());
        assert!(matches!(Journal::open(path), Err(AnnotateError::Busy { .. })), "one writes at a time");
        assert_eq!(Journal::read(path).unwrap(), all);
        drop(journal);
        let bytes = fs::read(path).unwrap();
        let last = whole_lines(&bytes[..bytes.len() - 1]).len();
        for end in last..=bytes.len() {
            fs::write(path, &bytes[..end]).unwrap();
            let (mut journal, known) = Journal::open(path).unwrap();
            let count = if end == bytes.len() { 3 } else { 2 };
            assert_eq!(known, all[..count], "{end}");
            journal.append(&all[2]).unwrap();
            assert_eq!(Journal::read(path).unwrap().len(), count + 1);
        }
    }

    #[test]
    fn a_line_that_cannot_be_is_named() {
        let scratch = Scratch::new("annotate-journal-wrong");
        let path = scratch.path("journal.jsonl");
        let path = Path::new(&path);
        let (mut journal, _) = Journal::open(path).unwrap();
        journal.append(&annotation(0, What::Skipped(Reason::Unclear), None)).unwrap();
        drop(journal);
        let line = fs::read_to_string(path).unwrap();
        fs::write(path, format!("{line}nonsense\n{line}")).unwrap();
        let error = Journal::open(path).map(drop).unwrap_err().to_string();
        assert!(error.contains("journal.jsonl:2: expected"), "{error}");
        assert!(Journal::read(&path.with_extension("none")).unwrap().is_empty());
    }
}
