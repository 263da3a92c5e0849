//! Tables in Parquet, a group of rows at a time.

use std::{fs::File, path::Path, sync::Arc};

use parquet::{
    basic::{LogicalType, Repetition, Type as PhysicalType},
    data_type::{BoolType, ByteArray, ByteArrayType, DataType, FloatType, Int64Type},
    errors::ParquetError,
    file::{
        metadata::KeyValue,
        properties::{EnabledStatistics, WriterProperties},
        writer::{SerializedFileWriter, SerializedRowGroupWriter},
    },
    schema::types::Type,
};

/// A column's name, and its values in some rows.
#[derive(Debug)]
pub(crate) struct Column {
    pub name: &'static str,
    pub values: Values,
}

/// A picture in a table.
#[derive(Debug)]
pub(crate) struct Picture {
    /// The PNG file.
    pub bytes: Vec<u8>,
    /// Its name.
    pub path: String,
}

/// A value for each row.
#[derive(Debug)]
pub(crate) enum Values {
    Bool(Vec<bool>),
    Long(Vec<i64>),
    Float(Vec<f32>),
    Text(Vec<String>),
    Texts(Vec<Vec<String>>),
    /// Numbers, as many in each row.
    Vector(Vec<Vec<f32>>),
    /// `struct<bytes, path>`: what Hugging Face's `datasets.Image` reads.
    Picture(Vec<Picture>),
}

impl Values {
    /// About how many bytes they take in a file.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Bool(values) => values.len(),
            Self::Long(values) => values.len() * 8,
            Self::Float(values) => values.len() * 4,
            Self::Text(values) => values.iter().map(String::len).sum(),
            Self::Texts(values) => values.iter().flatten().map(String::len).sum(),
            Self::Vector(values) => values.iter().map(|value| value.len() * 4).sum(),
            Self::Picture(values) => values.iter().map(|picture| picture.bytes.len() + picture.path.len()).sum(),
        }
    }
}

/// A table that is being written.
pub(crate) struct Table(SerializedFileWriter<File>);

impl Table {
    /// Begins a table with columns of these names and types; `notes` are kept with its schema.
    pub fn create(path: &Path, columns: &[Column], notes: Vec<KeyValue>) -> Result<Self, ParquetError> {
        let fields = columns.iter().map(field).collect::<Result<Vec<_>, _>>()?;
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
    pub fn write(&mut self, columns: &[Column]) -> Result<(), ParquetError> {
        let mut group = self.0.next_row_group()?;
        for column in columns {
            write_column(&mut group, &column.values)?;
        }
        group.close().map(drop)
    }

    /// Bytes written so far.
    pub fn bytes(&self) -> usize {
        self.0.bytes_written()
    }

    /// Ends it.
    pub fn close(self) -> Result<(), ParquetError> {
        self.0.close().map(drop)
    }
}

fn field(column: &Column) -> Result<Arc<Type>, ParquetError> {
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
        Values::Bool(values) => write_leaf::<BoolType>(group, values, None),
        Values::Long(values) => write_leaf::<Int64Type>(group, values, None),
        Values::Float(values) => write_leaf::<FloatType>(group, values, None),
        Values::Text(values) => {
            let texts: Vec<ByteArray> = values.iter().map(text).collect();
            write_leaf::<ByteArrayType>(group, &texts, None)
        }
        Values::Texts(values) => {
            let texts: Vec<ByteArray> = values.iter().flatten().map(text).collect();
            write_leaf::<ByteArrayType>(group, &texts, Some(levels(values.iter().map(Vec::len))))
        }
        Values::Vector(values) => {
            let numbers: Vec<f32> = values.iter().flatten().copied().collect();
            write_leaf::<FloatType>(group, &numbers, Some(levels(values.iter().map(Vec::len))))
        }
        Values::Picture(values) => {
            let png = |picture: &Picture| ByteArray::from(picture.bytes.as_slice());
            let bytes: Vec<ByteArray> = values.iter().map(png).collect();
            write_leaf::<ByteArrayType>(group, &bytes, None)?;
            let paths: Vec<ByteArray> = values.iter().map(|picture| text(&picture.path)).collect();
            write_leaf::<ByteArrayType>(group, &paths, None)
        }
    }
}

fn write_leaf<T: DataType>(
    group: &mut Group<'_>,
    values: &[T::T],
    levels: Option<(Vec<i16>, Vec<i16>)>,
) -> Result<(), ParquetError> {
    let (definition, repetition) = levels.unzip();
    let missing = || ParquetError::General("there are more columns than the table was begun with".to_owned());
    let mut column = group.next_column()?.ok_or_else(missing)?;
    column.typed::<T>().write_batch(values, definition.as_deref(), repetition.as_deref())?;
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
mod tests {
    use super::*;

    #[test]
    fn levels_say_where_lists_begin_and_which_are_empty() {
        assert_eq!(levels([2, 0, 3].into_iter()), (vec![1, 1, 0, 1, 1, 1], vec![0, 1, 0, 0, 1, 1]));
    }
}
