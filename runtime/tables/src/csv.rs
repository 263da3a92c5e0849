//! Tables as CSV files (RFC 4180): a head line, then a line a row.
//!
//! Spreadsheet programs take a cell for a formula that begins with one of a few characters, also when people said so. Text
//! that begins so, or with apostrophes and then so, gets an apostrophe before it; [`plain_text`] takes it away again. Numbers
//! stay numbers. The codebook says so, too.

use std::{
    borrow::Cow,
    fs::File,
    path::{Path, PathBuf},
};

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

/// What spreadsheet programs take for the beginning of a formula, or pass over before one.
const FORMULA: [char; 7] = ['=', '+', '-', '@', '\t', '\r', '\n'];

/// Put before text that a spreadsheet program would take for a formula.
const APOSTROPHE: char = '\'';

fn is_formula(text: &str) -> bool {
    text.trim_start_matches(APOSTROPHE).starts_with(FORMULA)
}

/// `text` as a cell has it.
fn cell_text(text: &str) -> Cow<'_, str> {
    if is_formula(text) { format!("{APOSTROPHE}{text}").into() } else { text.into() }
}

/// The text of a cell of text, as it was before it was written.
#[must_use]
pub fn plain_text(cell: &str) -> &str {
    cell.strip_prefix(APOSTROPHE).filter(|text| is_formula(text)).unwrap_or(cell)
}

fn text(cell: &Cell) -> String {
    match cell {
        Cell::Nothing => String::new(),
        Cell::Text(text) => cell_text(text).into_owned(),
        Cell::Whole(number) => number.to_string(),
        Cell::Real(number) => number.to_string(),
        Cell::Flag(flag) => flag.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_text_is_a_formula_and_all_of_it_is_read_back() {
        for text in ["=1+1", "+31 20", "-", "@SUM(A1)", "\t=1", "\r=1", "\n=1", "'=1", "''-x", "-5"] {
            let written = self::text(&Cell::Text(text.to_owned()));
            assert_eq!(written, format!("'{text}"));
            assert_eq!(plain_text(&written), text);
        }
        for text in ["", "take the red one", "'the red one'", "'", "a=b", "x - y", " =1", "5"] {
            assert_eq!(self::text(&Cell::Text(text.to_owned())), text);
            assert_eq!(plain_text(text), text);
        }
        assert_eq!(self::text(&Cell::Real(-0.5)), "-0.5");
        assert_eq!(self::text(&Cell::Whole(-3)), "-3");
    }
}
