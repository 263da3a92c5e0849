//! Numbers of a document: every offset, length and count is checked before it is followed.

use std::{borrow::Cow, cell::Cell};

use gltf_json::{
    Index, Root,
    accessor::{Accessor, ComponentType, sparse::Sparse},
    buffer::View,
    validation::Checked,
};

use crate::{container::Document, error::GltfError, files::Files};

/// The most values that are read in all.
const MOST_VALUES: u64 = 24_000_000;
/// The most values of one accessor.
const MOST_OF_ONE: u64 = 3_000_000;
const SIMPLIFY: &str = "simplify the model in the program that made it";

/// The accessors of a document, with the bytes behind them.
pub(crate) struct Accessors<'a> {
    root: &'a Root,
    buffers: Vec<Cow<'a, [u8]>>,
    read: Cell<u64>,
}

/// Where the values of an accessor lie.
struct Values<'a> {
    bytes: &'a [u8],
    stride: usize,
    component: ComponentType,
    normalized: bool,
}

impl<'a> Accessors<'a> {
    /// Reads all buffers.
    pub(crate) fn new(document: &'a Document<'_>, files: &Files<'_>) -> Result<Self, GltfError> {
        let mut buffers = Vec::with_capacity(document.root.buffers.len());
        for (index, buffer) in document.root.buffers.iter().enumerate() {
            let at = format!("buffers[{index}]");
            let bytes = match (&buffer.uri, document.binary) {
                (Some(uri), _) => files.uri(uri, &at)?,
                (None, Some(binary)) if index == 0 => Cow::Borrowed(binary),
                (None, _) => return Err(GltfError::at(at, "it has no data: export the model as .glb")),
            };
            let (says, has) = (buffer.byte_length.0, bytes.len() as u64);
            if says > has {
                let reason = format!("it says that it has {says} bytes, and has {has}: the file is cut off");
                return Err(GltfError::at(at, reason));
            }
            buffers.push(bytes);
        }
        Ok(Self { root: &document.root, buffers, read: Cell::new(0) })
    }

    /// The bytes of a part of a buffer.
    pub(crate) fn view(&self, index: Index<View>) -> Result<&[u8], GltfError> {
        let at = format!("bufferViews[{}]", index.value());
        let view = self.root.get(index).ok_or_else(|| GltfError::at(&at, "there is none"))?;
        let buffer = self.buffers.get(view.buffer.value());
        let buffer = buffer.ok_or_else(|| GltfError::at(&at, format!("there is no buffer {}", view.buffer.value())))?;
        let start = view.byte_offset.map_or(0, |offset| offset.0);
        let end = start.checked_add(view.byte_length.0);
        let range = usize::try_from(start).ok().zip(end.and_then(|end| usize::try_from(end).ok()));
        let bytes = range.and_then(|(start, end)| buffer.get(start..end));
        bytes.ok_or_else(|| GltfError::at(at, format!("it reaches beyond its buffer of {} bytes", buffer.len())))
    }

    /// How many values an accessor has.
    pub(crate) fn count(&self, index: Index<Accessor>) -> Result<u64, GltfError> {
        Ok(self.accessor(index)?.count.0)
    }

    fn accessor(&self, index: Index<Accessor>) -> Result<&Accessor, GltfError> {
        self.root.get(index).ok_or_else(|| GltfError::at(named(index), "there is none"))
    }

    /// The indices that an accessor has.
    pub(crate) fn indices(&self, index: Index<Accessor>) -> Result<Vec<u32>, GltfError> {
        let values = self.numbers(index, &[1])?;
        let is_whole = self.component(index)? != ComponentType::F32;
        if !is_whole {
            return Err(GltfError::at(named(index), "indices are whole numbers"));
        }
        Ok(values.1.into_iter().map(|value| value as u32).collect())
    }

    /// Vectors of so many numbers.
    pub(crate) fn vectors<const N: usize>(&self, index: Index<Accessor>) -> Result<Vec<[f32; N]>, GltfError> {
        let (_, numbers) = self.numbers(index, &[N])?;
        Ok(numbers.as_chunks::<N>().0.iter().map(|vector| vector.map(|number| number as f32)).collect())
    }

    /// Colours, with what they hide where that is given.
    pub(crate) fn colors(&self, index: Index<Accessor>) -> Result<Vec<[f32; 4]>, GltfError> {
        let (width, numbers) = self.numbers(index, &[3, 4])?;
        let color = |vector: &[f64]| [0, 1, 2, 3].map(|at| vector.get(at).map_or(1.0, |number| *number as f32));
        Ok(numbers.chunks_exact(width).map(color).collect())
    }

    fn component(&self, index: Index<Accessor>) -> Result<ComponentType, GltfError> {
        match self.accessor(index)?.component_type {
            Checked::Valid(component) => Ok(component.0),
            Checked::Invalid => Err(GltfError::at(named(index), "`componentType` is none of glTF 2.0")),
        }
    }

    /// How many numbers each value has, one of `widths`, and all numbers.
    fn numbers(&self, index: Index<Accessor>, widths: &[usize]) -> Result<(usize, Vec<f64>), GltfError> {
        let at = named(index);
        let accessor = self.accessor(index)?;
        let width = match accessor.type_ {
            Checked::Valid(kind) => kind.multiplicity(),
            Checked::Invalid => return Err(GltfError::at(at, "`type` is none of glTF 2.0")),
        };
        if !widths.contains(&width) {
            return Err(GltfError::at(at, format!("its values have {width} numbers, where {widths:?} are meant")));
        }
        let count = self.spend(accessor.count.0)?;
        let component = self.component(index)?;
        let offset = accessor.byte_offset.map_or(0, |offset| offset.0);
        let mut numbers = match accessor.buffer_view {
            Some(view) => {
                let stride = self.root.get(view).and_then(|view| view.byte_stride).map(|stride| stride.0);
                let values = self.values(view, offset, stride, component, width, count, &at)?;
                values.with_norm(accessor.normalized).read(width, count)
            }
            None => vec![0.0; width * count],
        };
        if let Some(sparse) = &accessor.sparse {
            self.replace(sparse, component, accessor.normalized, width, &mut numbers, &at)?;
        }
        if numbers.iter().any(|number| !number.is_finite()) {
            return Err(GltfError::at(at, "a number in it is none (NaN) or infinite: export the model anew"));
        }
        Ok((width, numbers))
    }

    /// Counts what is read.
    fn spend(&self, count: u64) -> Result<usize, GltfError> {
        let all = self.read.get().saturating_add(count);
        self.read.set(all);
        let too_many = |have, most| GltfError::TooMany { what: "values of points", have, most, remedy: SIMPLIFY };
        if count > MOST_OF_ONE {
            return Err(too_many(count, MOST_OF_ONE));
        }
        if all > MOST_VALUES {
            return Err(too_many(all, MOST_VALUES));
        }
        usize::try_from(count).map_err(|_| too_many(count, MOST_OF_ONE))
    }

    /// The bytes of so many values, all of which are there.
    #[allow(clippy::too_many_arguments, reason = "each is a number of the document, of which all are needed at once")]
    fn values(
        &self,
        view: Index<View>,
        offset: u64,
        stride: Option<usize>,
        component: ComponentType,
        width: usize,
        count: usize,
        at: &str,
    ) -> Result<Values<'_>, GltfError> {
        let bytes = self.view(view)?;
        let size = width * component.size();
        let stride = stride.unwrap_or(size);
        let beyond = || GltfError::at(at, format!("its {count} values reach beyond bufferViews[{}]", view.value()));
        if stride < size {
            return Err(GltfError::at(at, format!("its values of {size} bytes overlap: byteStride is {stride}")));
        }
        let bytes = usize::try_from(offset).ok().and_then(|offset| bytes.get(offset..)).ok_or_else(beyond)?;
        let needed = match count {
            0 => Some(0),
            _ => stride.checked_mul(count - 1).and_then(|before| before.checked_add(size)),
        };
        if needed.is_none_or(|needed| needed > bytes.len()) {
            return Err(beyond());
        }
        Ok(Values { bytes, stride, component, normalized: false })
    }

    /// Puts the values of a sparse accessor into their places.
    fn replace(
        &self,
        sparse: &Sparse,
        component: ComponentType,
        normalized: bool,
        width: usize,
        numbers: &mut [f64],
        at: &str,
    ) -> Result<(), GltfError> {
        let count = self.spend(sparse.count.0)?;
        let Checked::Valid(of_places) = sparse.indices.component_type else {
            return Err(GltfError::at(at, "its sparse indices are of no type of glTF 2.0"));
        };
        let (view, offset) = (sparse.indices.buffer_view, sparse.indices.byte_offset.0);
        let places = self.values(view, offset, None, of_places.0, 1, count, at)?.read(1, count);
        let (view, offset) = (sparse.values.buffer_view, sparse.values.byte_offset.0);
        let values = self.values(view, offset, None, component, width, count, at)?;
        let values = values.with_norm(normalized).read(width, count);
        for (place, value) in places.iter().zip(values.chunks_exact(width)) {
            let start = *place as usize * width;
            let target = numbers.get_mut(start..start + width);
            let beyond = || GltfError::at(at, format!("its sparse index {place} is of no value"));
            target.ok_or_else(beyond)?.copy_from_slice(value);
        }
        Ok(())
    }
}

impl Values<'_> {
    fn with_norm(self, normalized: bool) -> Self {
        Self { normalized, ..self }
    }

    /// All numbers; whole ones without loss.
    fn read(&self, width: usize, count: usize) -> Vec<f64> {
        let size = self.component.size();
        let mut numbers = Vec::with_capacity(width * count);
        for value in 0..count {
            let value = &self.bytes[value * self.stride..];
            numbers.extend(value[..width * size].chunks_exact(size).map(|bytes| self.number(bytes)));
        }
        numbers
    }

    fn number(&self, bytes: &[u8]) -> f64 {
        let (number, largest) = match (self.component, bytes) {
            (ComponentType::I8, [byte]) => (f64::from(byte.cast_signed()), 127.0),
            (ComponentType::U8, [byte]) => (f64::from(*byte), 255.0),
            (ComponentType::I16, [a, b]) => (f64::from(i16::from_le_bytes([*a, *b])), 32_767.0),
            (ComponentType::U16, [a, b]) => (f64::from(u16::from_le_bytes([*a, *b])), 65_535.0),
            (ComponentType::U32, [a, b, c, d]) => (f64::from(u32::from_le_bytes([*a, *b, *c, *d])), 1.0),
            (ComponentType::F32, [a, b, c, d]) => (f64::from(f32::from_le_bytes([*a, *b, *c, *d])), 1.0),
            // The bytes of a value are as many as its type has.
            _ => (f64::NAN, 1.0),
        };
        if self.normalized { (number / largest).max(-1.0) } else { number }
    }
}

fn named(index: Index<Accessor>) -> String {
    format!("accessors[{}]", index.value())
}
