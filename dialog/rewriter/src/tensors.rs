//! The numbers of a model, out of its file.

use std::collections::HashMap;

use safetensors::{Dtype, SafeTensors};

use crate::{
    ModelError,
    matrix::{Linear, to_whole},
};

/// How many embedded numbers share a scale.
const GROUP: usize = 48;
/// The largest rounded weight.
const LARGEST_WEIGHT: f32 = 127.0;

/// The tensors of a model by their names.
pub(crate) struct Tensors<'a> {
    tensors: SafeTensors<'a>,
    notes: HashMap<String, String>,
}

impl<'a> Tensors<'a> {
    pub(crate) fn new(file: &'a [u8]) -> Result<Self, ModelError> {
        let (_, head) = SafeTensors::read_metadata(file).map_err(|error| ModelError::File(error.to_string()))?;
        let tensors = SafeTensors::deserialize(file).map_err(|error| ModelError::File(error.to_string()))?;
        Ok(Self { tensors, notes: head.metadata().clone().unwrap_or_default() })
    }

    /// A text that belongs to the model.
    pub(crate) fn note(&self, name: &str) -> Result<&str, ModelError> {
        self.notes.get(name).map(String::as_str).ok_or_else(|| ModelError::Missing(name.to_owned()))
    }

    /// A number that belongs to the model.
    pub(crate) fn count(&self, name: &str) -> Result<usize, ModelError> {
        self.note(name)?.parse().map_err(|_| ModelError::Shape(name.to_owned()))
    }

    pub(crate) fn floats(&self, name: &str) -> Result<Vec<f32>, ModelError> {
        let bytes = self.bytes(name, Dtype::F32)?;
        let numbers = bytes.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes));
        Ok(numbers.collect())
    }

    /// Rows of `width` numbers of 4 bits.
    pub(crate) fn embedding(&self, name: &str, width: usize) -> Result<Embedding, ModelError> {
        let packed = self.bytes(&format!("{name}.packed"), Dtype::U8)?.to_vec();
        let scales: Vec<f32> = self
            .bytes(&format!("{name}.scale"), Dtype::BF16)?
            .as_chunks::<2>()
            .0
            .iter()
            .map(|bytes| f32::from_bits(u32::from(u16::from_le_bytes(*bytes)) << 16))
            .collect();
        if packed.len() * 2 != scales.len() * GROUP || !(packed.len() * 2).is_multiple_of(width) {
            return Err(ModelError::Shape(name.to_owned()));
        }
        Ok(Embedding { packed, scales, width })
    }

    /// A matrix of numbers of 4 bits, without biases: its rows are rounded again, to 8 bits with one scale.
    pub(crate) fn packed_linear(&self, name: &str, inputs: usize) -> Result<Linear, ModelError> {
        let rows = self.embedding(name, inputs)?;
        let mut weights = Vec::with_capacity(rows.rows() * inputs);
        let mut scales = Vec::with_capacity(rows.rows());
        for row in 0..rows.rows() {
            let values: Vec<f32> = rows.row(row).collect();
            let largest = values.iter().fold(1e-9_f32, |largest, value| largest.max(value.abs()));
            let factor = LARGEST_WEIGHT / largest;
            weights.extend(values.iter().map(|value| to_whole(value * factor) as i8));
            scales.push(largest / LARGEST_WEIGHT);
        }
        Ok(Linear::new(&weights, scales))
    }

    fn bytes(&self, name: &str, kind: Dtype) -> Result<&'a [u8], ModelError> {
        let tensor = self.tensors.tensor(name).map_err(|_| ModelError::Missing(name.to_owned()))?;
        if tensor.dtype() == kind { Ok(tensor.data()) } else { Err(ModelError::Shape(name.to_owned())) }
    }
}

/// Rows of numbers of 4 bits, with a scale for each 48.
#[derive(Debug)]
pub(crate) struct Embedding {
    packed: Vec<u8>,
    scales: Vec<f32>,
    width: usize,
}

impl Embedding {
    pub(crate) fn rows(&self) -> usize {
        self.packed.len() * 2 / self.width
    }

    /// Row `row`, its numbers in order.
    pub(crate) fn row(&self, row: usize) -> impl Iterator<Item = f32> {
        let packed = &self.packed[row * self.width / 2..(row + 1) * self.width / 2];
        let scales = &self.scales[row * self.width / GROUP..];
        let numbers = packed.iter().flat_map(|byte| [byte & 15, byte >> 4]);
        numbers.enumerate().map(|(at, number)| (f32::from(number) - 8.0) * scales[at / GROUP])
    }
}
