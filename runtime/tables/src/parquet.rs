//! Tables as Parquet files, with the columns and types of the codebook; what columns mean, and their units, are notes of the file:
//! `meaning`, and for each column `<column>.meaning` and `<column>.unit`.
//!
//! Text is as it was said: no spreadsheet program takes a cell of Parquet for a formula.

use std::path::{Path, PathBuf};

use cohabit_parquet::{Column, ParquetError, TableWriter, Values};

use crate::table::{Cell, Field, Kind, Table};

/// Why a table could not be written.
#[derive(Debug, thiserror::Error)]
#[error("write {path}: {source}")]
pub struct ParquetFileError {
    /// The file.
    path: PathBuf,
    /// Why.
    source: ParquetError,
}

/// Writes a table into `folder`, as a file of its name; gives its path.
///
/// # Errors
/// [`ParquetFileError`].
pub fn write_parquet(table: &Table, folder: &Path) -> Result<PathBuf, ParquetFileError> {
    let path = folder.join(format!("{}.parquet", table.name));
    match write(table, &path) {
        Ok(()) => Ok(path),
        Err(source) => Err(ParquetFileError { path, source }),
    }
}

fn write(table: &Table, path: &Path) -> Result<(), ParquetError> {
    let numbered = table.fields.iter().enumerate();
    let columns: Vec<Column<'_>> = numbered.map(|(at, field)| column(field, at, &table.rows)).collect();
    let notes = notes(table);
    let notes: Vec<(&str, &str)> = notes.iter().map(|(key, text)| (key.as_str(), *text)).collect();
    let mut writer = TableWriter::create(path, &columns, &notes)?;
    if !table.rows.is_empty() {
        writer.write(&columns)?;
    }
    writer.close()
}

/// What the file notes of the table and its columns.
fn notes(table: &Table) -> Vec<(String, &str)> {
    let of_columns = table.fields.iter().flat_map(|field| {
        [(format!("{}.meaning", field.name), &*field.meaning), (format!("{}.unit", field.name), field.unit)]
    });
    let all = std::iter::once(("meaning".to_owned(), table.meaning)).chain(of_columns);
    all.filter(|(_, text)| !text.is_empty()).collect()
}

/// The cells of a column; a cell that is none of its kind is nothing.
fn column<'a>(field: &'a Field, at: usize, rows: &[Vec<Cell>]) -> Column<'a> {
    let cells = rows.iter().map(|row| row.get(at).unwrap_or(&Cell::Nothing));
    let values = match field.kind {
        Kind::Text => Values::MaybeText(
            cells.map(|cell| if let Cell::Text(text) = cell { Some(text.clone()) } else { None }).collect(),
        ),
        Kind::Whole => Values::MaybeLong(
            cells.map(|cell| if let Cell::Whole(number) = cell { Some(*number) } else { None }).collect(),
        ),
        Kind::Real => Values::MaybeDouble(cells.map(real).collect()),
        Kind::Flag => {
            Values::MaybeBool(cells.map(|cell| if let Cell::Flag(flag) = cell { Some(*flag) } else { None }).collect())
        }
    };
    Column { name: &field.name, values }
}

fn real(cell: &Cell) -> Option<f64> {
    match cell {
        Cell::Real(number) => Some(*number),
        Cell::Whole(number) => Some(*number as f64),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        let fields = [("who", Kind::Text, ""), ("n", Kind::Whole, ""), ("s", Kind::Real, "s"), ("is", Kind::Flag, "")];
        let fields = fields.map(|(name, kind, unit)| Field::new(name, kind, unit, "m")).to_vec();
        let whole = vec![Cell::Text("=1".to_owned()), Cell::Whole(-3), Cell::Real(0.5), Cell::Flag(true)];
        Table { name: "turns", meaning: "a turn", fields, rows: vec![whole, vec![Cell::Nothing; 4]] }
    }

    #[test]
    fn columns_have_the_types_of_the_codebook() {
        let table = table();
        let values = |at: usize| column(&table.fields[at], at, &table.rows).values;
        assert_eq!(values(0), Values::MaybeText(vec![Some("=1".to_owned()), None]));
        assert_eq!(values(1), Values::MaybeLong(vec![Some(-3), None]));
        assert_eq!(values(2), Values::MaybeDouble(vec![Some(0.5), None]));
        assert_eq!(values(3), Values::MaybeBool(vec![Some(true), None]));
        let notes = notes(&table);
        assert!(notes.contains(&("s.unit".to_owned(), "s")) && notes.contains(&("meaning".to_owned(), "a turn")));
        assert!(!notes.iter().any(|(key, _)| key == "who.unit"));
    }

    #[test]
    fn the_same_table_gives_the_same_bytes_and_one_without_rows_is_a_file_too() {
        let folder = std::env::temp_dir().join(format!("cohabit-tables-parquet-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        let written = |table: &Table| std::fs::read(write_parquet(table, &folder).expect("a file")).expect("its bytes");
        assert_eq!(written(&table()), written(&table()));
        assert!(written(&Table { rows: Vec::new(), ..table() }).starts_with(b"PAR1"));
        let error = write_parquet(&table(), &folder.join("none")).expect_err("no such folder").to_string();
        assert!(error.contains("turns.parquet"), "{error}");
        std::fs::remove_dir_all(&folder).expect("an empty place");
    }
}
