//! Tables as CSV files (RFC 4180): a head line, then a line a row.

use std::{fs::File, path::Path, path::PathBuf};

use crate::table::{Cell, Table};

/// Why a table could not be written.
#[derive(Debug, thiserror::Error)]
#[error("write {path}: {source}")]
pub struct CsvError {
    /// The file.
    path: PathBuf,
    /// Why.
    source: csv::Error,
}

/// Writes a table into `folder`, as a file of its name; gives its path.
///
/// # Errors
/// [`CsvError`].
pub fn write_csv(table: &Table, folder: &Path) -> Result<PathBuf, CsvError> {
    let path = folder.join(format!("{}.csv", table.name));
    match write(table, &path) {
        Ok(()) => Ok(path),
        Err(source) => Err(CsvError { path, source }),
    }
}

fn write(table: &Table, path: &Path) -> csv::Result<()> {
    let mut writer = csv::Writer::from_writer(File::create(path)?);
    writer.write_record(table.fields.iter().map(|field| field.name.as_bytes()))?;
    for row in &table.rows {
        writer.write_record(row.iter().map(text))?;
    }
    writer.flush()?;
    Ok(())
}

fn text(cell: &Cell) -> String {
    match cell {
        Cell::Nothing => String::new(),
        Cell::Text(text) => text.clone(),
        Cell::Whole(number) => number.to_string(),
        Cell::Real(number) => number.to_string(),
        Cell::Flag(flag) => flag.to_string(),
    }
}
