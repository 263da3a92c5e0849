//! Tables as Parquet files, whose columns carry their unit and meaning.

use std::{
    collections::HashMap,
    fs::File,
    path::{Path, PathBuf},
    sync::Arc,
};

use anyhow::Context as _;
use arrow::{
    array::{ArrayRef, BooleanArray, Float64Array, Int64Array, RecordBatch, StringArray},
    datatypes::{DataType, Field, Schema},
};
use cohabit_tables::{Cell, Kind, Table};
use parquet::arrow::ArrowWriter;

/// Writes a table into `folder`, as a file of its name; gives its path.
pub fn write(table: &Table, folder: &Path) -> anyhow::Result<PathBuf> {
    let path = folder.join(format!("{}.parquet", table.name));
    let batch = batch(table).with_context(|| format!("table `{}`", table.name))?;
    let file = File::create(&path).with_context(|| path.display().to_string())?;
    let mut writer = ArrowWriter::try_new(file, batch.schema(), None).with_context(|| path.display().to_string())?;
    writer.write(&batch).and_then(|()| writer.close()).with_context(|| format!("write {}", path.display()))?;
    Ok(path)
}

fn batch(table: &Table) -> anyhow::Result<RecordBatch> {
    let metadata = HashMap::from([("meaning".to_owned(), table.meaning.to_owned())]);
    let fields: Vec<Field> = table.fields.iter().map(field).collect();
    let columns = table.fields.iter().enumerate().map(|(at, field)| column(field.kind, at, &table.rows));
    Ok(RecordBatch::try_new(Arc::new(Schema::new_with_metadata(fields, metadata)), columns.collect())?)
}

fn field(field: &cohabit_tables::Field) -> Field {
    let kind = match field.kind {
        Kind::Text => DataType::Utf8,
        Kind::Whole => DataType::Int64,
        Kind::Real => DataType::Float64,
        Kind::Flag => DataType::Boolean,
    };
    let metadata = [("unit", field.unit), ("meaning", field.meaning.as_ref())];
    let metadata = metadata.map(|(name, value)| (name.to_owned(), value.to_owned()));
    Field::new(field.name.as_ref(), kind, true).with_metadata(HashMap::from(metadata))
}

fn column(kind: Kind, at: usize, rows: &[Vec<Cell>]) -> ArrayRef {
    let cells = rows.iter().map(|row| &row[at]);
    match kind {
        Kind::Text => {
            let text = |cell: &Cell| if let Cell::Text(text) = cell { Some(text.clone()) } else { None };
            Arc::new(cells.map(text).collect::<StringArray>())
        }
        Kind::Whole => {
            let whole = |cell: &Cell| if let Cell::Whole(number) = cell { Some(*number) } else { None };
            Arc::new(cells.map(whole).collect::<Int64Array>())
        }
        Kind::Real => {
            let real = |cell: &Cell| if let Cell::Real(number) = cell { Some(*number) } else { None };
            Arc::new(cells.map(real).collect::<Float64Array>())
        }
        Kind::Flag => {
            let flag = |cell: &Cell| if let Cell::Flag(flag) = cell { Some(*flag) } else { None };
            Arc::new(cells.map(flag).collect::<BooleanArray>())
        }
    }
}
