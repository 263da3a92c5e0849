//! Columns of values → Parquet files, a group of rows at a time. The same columns give the same bytes.
//!
//! ```text
//! let columns = [Column { name: "turn", values: Values::Long(vec![1, 2]) }];
//! let mut table = TableWriter::create(path, &columns, &[])?;
//! table.write(&columns)?;
//! table.close()?;
//! ```
//!
//! This crate never knows what the columns mean, nor Arrow.

use std::{fs::File, path::Path, sync::Arc};

pub use parquet::errors::ParquetError;
use parquet::{
    basic::{LogicalType, Repetition, Type as PhysicalType},
    data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, FloatType, Int64Type},
    file::{
        metadata::KeyValue,
        properties::{EnabledStatistics, WriterProperties},
        writer::{SerializedFileWriter, SerializedRowGroupWriter},
    },
    schema::types::Type,
};

/// A column's name, and its values in some rows.
#[derive(Debug, PartialEq)]
pub struct Column<'a> {
    /// Its name.
    pub name: &'a str,
    /// A value for each row.
    pub values: Values,
}

/// A picture in a table.
#[derive(Debug, PartialEq)]
pub struct Picture {
    /// The PNG file.
    pub bytes: Vec<u8>,
    /// Its name.
    pub path: String,
}

/// A value for each row.
#[derive(Debug, PartialEq)]
pub enum Values {
    /// True or false.
    Bool(Vec<bool>),
    /// Whole numbers.
    Long(Vec<i64>),
    /// Numbers.
    Float(Vec<f32>),
    /// Text.
    Text(Vec<String>),
    /// Several texts in each row.
    Texts(Vec<Vec<String>>),
    /// Numbers, as many in each row.
    Vector(Vec<Vec<f32>>),
    /// `struct<bytes, path>`: what Hugging Face's `datasets.Image` reads.
    Picture(Vec<Picture>),
    /// True or false, or nothing.
    MaybeBool(Vec<Option<bool>>),
    /// Whole numbers, or nothing.
    MaybeLong(Vec<Option<i64>>),
    /// Numbers, or nothing.
    MaybeDouble(Vec<Option<f64>>),
    /// Text, or nothing.
    MaybeText(Vec<Option<String>>),
}

impl Values {
    /// About how many bytes they take in a file.
    #[must_use]
    pub fn bytes(&self) -> usize {
        match self {
            Self::Bool(values) => values.len(),
            Self::Long(values) => values.len() * 8,
            Self::Float(values) => values.len() * 4,
            Self::Text(values) => values.iter().map(String::len).sum(),
            Self::Texts(values) => values.iter().flatten().map(String::len).sum(),
            Self::Vector(values) => values.iter().map(|value| value.len() * 4).sum(),
            Self::Picture(values) => values.iter().map(|picture| picture.bytes.len() + picture.path.len()).sum(),
            Self::MaybeBool(values) => values.len(),
            Self::MaybeLong(values) => values.len() * 8,
            Self::MaybeDouble(values) => values.len() * 8,
            Self::MaybeText(values) => values.iter().flatten().map(String::len).sum(),
        }
    }
}

/// A table that is being written.
pub struct TableWriter(SerializedFileWriter<File>);

impl TableWriter {
    /// Begins a table with columns of these names and types; `notes`, each with its key, are kept with its schema.
    ///
    /// # Errors
    /// [`ParquetError`], of the file too.
    pub fn create(path: &Path, columns: &[Column<'_>], notes: &[(&str, &str)]) -> Result<Self, ParquetError> {
        let fields = columns.iter().map(field).collect::<Result<Vec<_>, _>>()?;
        let notes = notes.iter().map(|(key, text)| KeyValue::new((*key).to_owned(), (*text).to_owned())).collect();
        let schema = Type::group_type_builder("schema").with_fields(fields).build()?;
        // Pictures are packed already. Whole row groups are skipped by their statistics; pages are not.
        let properties = WriterProperties::builder()
            .set_dictionary_enabled(false)
            .set_statistics_enabled(EnabledStatistics::Chunk)
            .set_key_value_metadata(Some(notes))
            .build();
        SerializedFileWriter::new(File::create(path)?, Arc::new(schema), Arc::new(properties)).map(Self)
    }

    /// Adds a group of rows, with the columns that it was begun with.
    ///
    /// # Errors
    /// [`ParquetError`], of the file too.
    pub fn write(&mut self, columns: &[Column<'_>]) -> Result<(), ParquetError> {
        let mut group = self.0.next_row_group()?;
        for column in columns {
            write_column(&mut group, &column.values)?;
        }
        group.close().map(drop)
    }

    /// Bytes written so far.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.0.bytes_written()
    }

    /// Ends it.
    ///
    /// # Errors
    /// [`ParquetError`], of the file too.
    pub fn close(self) -> Result<(), ParquetError> {
        self.0.close().map(drop)
    }
}

fn field(column: &Column<'_>) -> Result<Arc<Type>, ParquetError> {
    let name = column.name;
    let text = || Some(LogicalType::String);
    match &column.values {
        Values::Bool(_) => leaf(name, PhysicalType::BOOLEAN, None, Repetition::REQUIRED),
        Values::Long(_) => leaf(name, PhysicalType::INT64, None, Repetition::REQUIRED),
        Values::Float(_) => leaf(name, PhysicalType::FLOAT, None, Repetition::REQUIRED),
        Values::Text(_) => leaf(name, PhysicalType::BYTE_ARRAY, text(), Repetition::REQUIRED),
        Values::Texts(_) => list(name, leaf("element", PhysicalType::BYTE_ARRAY, text(), Repetition::REQUIRED)?),
        Values::Vector(_) => list(name, leaf("element", PhysicalType::FLOAT, None, Repetition::REQUIRED)?),
        Values::Picture(_) => {
            let bytes = leaf("bytes", PhysicalType::BYTE_ARRAY, None, Repetition::REQUIRED)?;
            let path = leaf("path", PhysicalType::BYTE_ARRAY, text(), Repetition::REQUIRED)?;
            group(name, Repetition::REQUIRED, None, vec![bytes, path])
        }
        Values::MaybeBool(_) => leaf(name, PhysicalType::BOOLEAN, None, Repetition::OPTIONAL),
        Values::MaybeLong(_) => leaf(name, PhysicalType::INT64, None, Repetition::OPTIONAL),
        Values::MaybeDouble(_) => leaf(name, PhysicalType::DOUBLE, None, Repetition::OPTIONAL),
        Values::MaybeText(_) => leaf(name, PhysicalType::BYTE_ARRAY, text(), Repetition::OPTIONAL),
    }
}

fn leaf(
    name: &str,
    physical: PhysicalType,
    logical: Option<LogicalType>,
    repetition: Repetition,
) -> Result<Arc<Type>, ParquetError> {
    let builder = Type::primitive_type_builder(name, physical).with_repetition(repetition).with_logical_type(logical);
    builder.build().map(Arc::new)
}

fn list(name: &str, element: Arc<Type>) -> Result<Arc<Type>, ParquetError> {
    let items = group("list", Repetition::REPEATED, None, vec![element])?;
    group(name, Repetition::REQUIRED, Some(LogicalType::List), vec![items])
}

fn group(
    name: &str,
    repetition: Repetition,
    logical: Option<LogicalType>,
    fields: Vec<Arc<Type>>,
) -> Result<Arc<Type>, ParquetError> {
    let builder = Type::group_type_builder(name).with_repetition(repetition);
    builder.with_logical_type(logical).with_fields(fields).build().map(Arc::new)
}

type Group<'a> = SerializedRowGroupWriter<'a, File>;

fn write_column(group: &mut Group<'_>, values: &Values) -> Result<(), ParquetError> {
    let text = |text: &String| ByteArray::from(text.as_str());
    match values {
        Values::Bool(values) => write_leaf::<BoolType>(group, values, None, None),
        Values::Long(values) => write_leaf::<Int64Type>(group, values, None, None),
        Values::Float(values) => write_leaf::<FloatType>(group, values, None, None),
        Values::Text(values) => {
            let texts: Vec<ByteArray> = values.iter().map(text).collect();
            write_leaf::<ByteArrayType>(group, &texts, None, None)
        }
        Values::Texts(values) => {
            let texts: Vec<ByteArray> = values.iter().flatten().map(text).collect();
            let (definition, repetition) = levels(values.iter().map(Vec::len));
            write_leaf::<ByteArrayType>(group, &texts, Some(&definition), Some(&repetition))
        }
        Values::Vector(values) => {
            let numbers: Vec<f32> = values.iter().flatten().copied().collect();
            let (definition, repetition) = levels(values.iter().map(Vec::len));
            write_leaf::<FloatType>(group, &numbers, Some(&definition), Some(&repetition))
        }
        Values::Picture(values) => {
            let png = |picture: &Picture| ByteArray::from(picture.bytes.as_slice());
            let bytes: Vec<ByteArray> = values.iter().map(png).collect();
            write_leaf::<ByteArrayType>(group, &bytes, None, None)?;
            let paths: Vec<ByteArray> = values.iter().map(|picture| text(&picture.path)).collect();
            write_leaf::<ByteArrayType>(group, &paths, None, None)
        }
        Values::MaybeBool(values) => write_maybe::<BoolType>(group, values.iter().copied()),
        Values::MaybeLong(values) => write_maybe::<Int64Type>(group, values.iter().copied()),
        Values::MaybeDouble(values) => write_maybe::<DoubleType>(group, values.iter().copied()),
        Values::MaybeText(values) => {
            write_maybe::<ByteArrayType>(group, values.iter().map(|value| value.as_ref().map(text)))
        }
    }
}

/// Writes values that may be missing: which are there, and those.
fn write_maybe<T: DataType>(
    group: &mut Group<'_>,
    values: impl Iterator<Item = Option<T::T>>,
) -> Result<(), ParquetError> {
    let values: Vec<Option<T::T>> = values.collect();
    let definition: Vec<i16> = values.iter().map(|value| i16::from(value.is_some())).collect();
    let there: Vec<T::T> = values.into_iter().flatten().collect();
    write_leaf::<T>(group, &there, Some(&definition), None)
}

fn write_leaf<T: DataType>(
    group: &mut Group<'_>,
    values: &[T::T],
    definition: Option<&[i16]>,
    repetition: Option<&[i16]>,
) -> Result<(), ParquetError> {
    let missing = || ParquetError::General("there are more columns than the table was begun with".to_owned());
    let mut column = group.next_column()?.ok_or_else(missing)?;
    column.typed::<T>().write_batch(values, definition, repetition)?;
    column.close()
}

/// Definition and repetition levels of lists of these lengths: which are empty, and where each begins.
fn levels(lengths: impl Iterator<Item = usize>) -> (Vec<i16>, Vec<i16>) {
    let (mut definition, mut repetition) = (Vec::new(), Vec::new());
    for length in lengths {
        let slots = length.max(1);
        definition.extend(std::iter::repeat_n(i16::from(length > 0), slots));
        repetition.extend((0..slots).map(|place| i16::from(place > 0)));
    }
    (definition, repetition)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use parquet::{
        file::{reader::FileReader as _, serialized_reader::SerializedFileReader},
        record::{Field, Row},
    };

    use super::*;

    #[test]
    fn values_that_are_missing_are_read_back_as_nothing() {
        let path = std::env::temp_dir().join(format!("cohabit-parquet-{}.parquet", std::process::id()));
        let columns = [
            Column { name: "flag", values: Values::MaybeBool(vec![Some(true), None, Some(false)]) },
            Column { name: "whole", values: Values::MaybeLong(vec![None, Some(-3), None]) },
            Column { name: "real", values: Values::MaybeDouble(vec![None, None, Some(0.25)]) },
            Column { name: "text", values: Values::MaybeText(vec![Some("=1".to_owned()), None, Some(String::new())]) },
        ];
        let mut table = TableWriter::create(&path, &columns, &[("meaning", "a row")]).unwrap();
        table.write(&columns).and_then(|()| table.close()).unwrap();
        let reader = SerializedFileReader::try_from(path.as_path()).unwrap();
        let notes = reader.metadata().file_metadata().key_value_metadata().unwrap();
        assert_eq!((notes[0].key.as_str(), notes[0].value.as_deref()), ("meaning", Some("a row")));
        let cells = |row: Row| row.get_column_iter().map(|(_, field)| field.clone()).collect::<Vec<_>>();
        let rows: Vec<Vec<Field>> = reader.get_row_iter(None).unwrap().map(|row| cells(row.unwrap())).collect();
        let text = |text: &str| Field::Str(text.to_owned());
        assert_eq!(
            rows,
            [
                [Field::Bool(true), Field::Null, Field::Null, text("=1")],
                [Field::Null, Field::Long(-3), Field::Null, Field::Null],
                [Field::Bool(false), Field::Null, Field::Double(0.25), text("")],
            ]
        );
        std::fs::remove_file(path).unwrap();
    }

    #[test]
    fn levels_say_where_lists_begin_and_which_are_empty() {
        assert_eq!(levels([2, 0, 3].into_iter()), (vec![1, 1, 0, 1, 1, 1], vec![0, 1, 0, 0, 1, 1]));
    }
}
