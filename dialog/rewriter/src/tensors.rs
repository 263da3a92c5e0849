//! The numbers of a model, out of its file.

use std::collections::HashMap;

use safetensors::{Dtype, SafeTensors};

use crate::{
    ModelError,
    matrix::{Linear, to_whole},
    sums::add,
};

/// How many embedded numbers share a scale.
const GROUP: usize = 48;
/// The largest rounded weight.
const LARGEST_WEIGHT: f32 = 127.0;

/// The tensors of a model by their names, as an adapter changes them.
pub(crate) struct Tensors<'a> {
    tensors: SafeTensors<'a>,
    notes: HashMap<String, String>,
    adapter: Option<SafeTensors<'a>>,
}

impl<'a> Tensors<'a> {
    pub(crate) fn new(file: &'a [u8]) -> Result<Self, ModelError> {
        let (_, head) = SafeTensors::read_metadata(file).map_err(|error| ModelError::File(error.to_string()))?;
        let tensors = SafeTensors::deserialize(file).map_err(|error| ModelError::File(error.to_string()))?;
        Ok(Self { tensors, notes: head.metadata().clone().unwrap_or_default(), adapter: None })
    }

    /// The same with what `adapter`, a file of tensors, adds (low-rank adaptation, Hu et al. 2021): to each matrix the product of
    /// `NAME.up` `[outputs, rank]` and `NAME.down` `[rank, inputs]`, and to other numbers those of the same name.
    pub(crate) fn adapted(self, adapter: &'a [u8]) -> Result<Self, ModelError> {
        let adapter = SafeTensors::deserialize(adapter).map_err(|error| ModelError::File(error.to_string()))?;
        Ok(Self { adapter: Some(adapter), ..self })
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
        let mut numbers: Vec<f32> = bytes.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
        if let Some(added) = self.added(name)? {
            if added.len() != numbers.len() {
                return Err(ModelError::Shape(name.to_owned()));
            }
            add(&mut numbers, &added);
        }
        Ok(numbers)
    }

    /// Rows of `width` numbers of 4 bits.
    pub(crate) fn embedding(&self, name: &str, width: usize) -> Result<Embedding, ModelError> {
        let packed = self.bytes(&format!("{name}.packed"), Dtype::U8)?.to_vec();
        let scales = halves(self.bytes(&format!("{name}.scale"), Dtype::BF16)?);
        if packed.len() * 2 != scales.len() * GROUP || !(packed.len() * 2).is_multiple_of(width) {
            return Err(ModelError::Shape(name.to_owned()));
        }
        Ok(Embedding { packed, scales, width })
    }

    /// A matrix of numbers of 4 bits, without biases: its rows are rounded again, to 8 bits with one scale.
    pub(crate) fn packed_linear(&self, name: &str, inputs: usize) -> Result<Linear, ModelError> {
        let rows = self.embedding(name, inputs)?;
        let change = self.change(name, rows.rows(), inputs)?;
        let mut weights = Vec::with_capacity(rows.rows() * inputs);
        let mut scales = Vec::with_capacity(rows.rows());
        for row in 0..rows.rows() {
            let mut values: Vec<f32> = rows.row(row).collect();
            change.add_to(row, &mut values);
            let largest = values.iter().fold(1e-9_f32, |largest, value| largest.max(value.abs()));
            let factor = LARGEST_WEIGHT / largest;
            weights.extend(values.iter().map(|value| to_whole(value * factor) as i8));
            scales.push(largest / LARGEST_WEIGHT);
        }
        Ok(Linear::new(&weights, scales))
    }

    /// What the adapter adds to a matrix; an empty change, where it leaves it.
    fn change(&self, name: &str, outputs: usize, inputs: usize) -> Result<Change, ModelError> {
        let (up, down) = (self.added(&format!("{name}.up"))?, self.added(&format!("{name}.down"))?);
        let (up, down) = (up.unwrap_or_default(), down.unwrap_or_default());
        let rank = up.len() / outputs.max(1);
        let fits = up.len() == rank * outputs && down.len() == rank * inputs;
        if fits { Ok(Change { up, down, rank }) } else { Err(ModelError::Shape(name.to_owned())) }
    }

    /// Numbers of the adapter.
    fn added(&self, name: &str) -> Result<Option<Vec<f32>>, ModelError> {
        let Some(tensor) = self.adapter.as_ref().and_then(|adapter| adapter.tensor(name).ok()) else { return Ok(None) };
        if tensor.dtype() == Dtype::BF16 {
            Ok(Some(halves(tensor.data())))
        } else {
            Err(ModelError::Shape(name.to_owned()))
        }
    }

    fn bytes(&self, name: &str, kind: Dtype) -> Result<&'a [u8], ModelError> {
        let tensor = self.tensors.tensor(name).map_err(|_| ModelError::Missing(name.to_owned()))?;
        if tensor.dtype() == kind { Ok(tensor.data()) } else { Err(ModelError::Shape(name.to_owned())) }
    }
}

/// Numbers of 16 bits: the first half of those of 32.
fn halves(bytes: &[u8]) -> Vec<f32> {
    let numbers = bytes.as_chunks::<2>().0.iter();
    numbers.map(|bytes| f32::from_bits(u32::from(u16::from_le_bytes(*bytes)) << 16)).collect()
}

/// A change of a matrix, `up` `[outputs, rank]` times `down` `[rank, inputs]`.
struct Change {
    up: Vec<f32>,
    down: Vec<f32>,
    rank: usize,
}

impl Change {
    fn add_to(&self, row: usize, values: &mut [f32]) {
        let weights = &self.up[row * self.rank..(row + 1) * self.rank];
        for (weight, down) in weights.iter().zip(self.down.chunks_exact(values.len())) {
            for (value, down) in values.iter_mut().zip(down) {
                *value += weight * down;
            }
        }
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
