//! A table in many files of bounded size, as LeRobot names them: `chunk-000/file-000.parquet`.

use cohabit_parquet::{Column, TableWriter};

use crate::{
    error::{ConvertError, in_table},
    output::Output,
};

/// Files in a chunk.
pub(crate) const FILES_IN_CHUNK: i64 = 1000;

/// Which file something is in.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub(crate) struct Place {
    pub chunk: i64,
    pub file: i64,
}

impl Place {
    const fn next(self) -> Self {
        if self.file + 1 == FILES_IN_CHUNK {
            Self { chunk: self.chunk + 1, file: 0 }
        } else {
            Self { chunk: self.chunk, file: self.file + 1 }
        }
    }
}

/// A table that goes on in the next file when one is full.
pub(crate) struct Rolling<'a> {
    output: &'a Output,
    folder: &'static str,
    /// Bytes in a file, unless a single group of rows is larger.
    limit: usize,
    place: Place,
    open: Option<TableWriter>,
    files: usize,
}

impl<'a> Rolling<'a> {
    pub const fn new(output: &'a Output, folder: &'static str, limit: usize) -> Self {
        Self { output, folder, limit, place: Place { chunk: 0, file: 0 }, open: None, files: 0 }
    }

    /// The file that the next rows go into, if they take so many bytes.
    pub fn room_for(&mut self, bytes: usize) -> Result<Place, ConvertError> {
        if self.open.as_ref().is_some_and(|table| table.bytes() + bytes > self.limit) {
            self.end()?;
            self.place = self.place.next();
        }
        Ok(self.place)
    }

    /// Adds rows to the file that `room_for` has named.
    pub fn write(&mut self, columns: &[Column<'_>]) -> Result<(), ConvertError> {
        let Place { chunk, file } = self.place;
        let path = self.output.path(&format!("{}/chunk-{chunk:03}/file-{file:03}.parquet", self.folder))?;
        let table = match &mut self.open {
            Some(table) => table,
            None => {
                self.files += 1;
                let table = TableWriter::create(&path, columns, &[]).map_err(in_table(&path))?;
                self.open.insert(table)
            }
        };
        table.write(columns).map_err(in_table(&path))
    }

    /// Ends the last file; gives how many there are.
    pub fn finish(mut self) -> Result<usize, ConvertError> {
        self.end()?;
        Ok(self.files)
    }

    fn end(&mut self) -> Result<(), ConvertError> {
        let Some(table) = self.open.take() else { return Ok(()) };
        let path = self.output.path(self.folder)?;
        table.close().map_err(in_table(&path))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chunk_has_so_many_files() {
        assert_eq!(Place { chunk: 0, file: 0 }.next(), Place { chunk: 0, file: 1 });
        assert_eq!(Place { chunk: 3, file: FILES_IN_CHUNK - 1 }.next(), Place { chunk: 4, file: 0 });
    }
}
