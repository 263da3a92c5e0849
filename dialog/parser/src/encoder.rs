//! An encoder of word pieces in context: layers of MiniLM.

use crate::{
    ModelError,
    layers::{Layer, Norm, add},
    tensors::{Embedding, Tensors},
};

/// Numbers that stand for a piece.
pub(crate) const WIDTH: usize = 384;
const HEADS: usize = 12;

#[derive(Debug)]
pub(crate) struct Encoder {
    words: Embedding,
    positions: Vec<f32>,
    speakers: Vec<f32>,
    norm: Norm,
    layers: Vec<Layer>,
}

impl Encoder {
    /// Of a model, and of one that has the embeddings of its pieces.
    pub(crate) fn new(tensors: &Tensors<'_>, words: &Tensors<'_>) -> Result<Self, ModelError> {
        Ok(Self {
            words: words.embedding("words", WIDTH)?,
            positions: tensors.floats("positions")?,
            speakers: tensors.floats("speakers")?,
            norm: Norm::new(tensors, "norm")?,
            layers: (0..tensors.count("encoder")?)
                .map(|layer| Layer::new(tensors, &format!("encoder.{layer}")))
                .collect::<Result<_, _>>()?,
        })
    }

    /// How many pieces it knows.
    pub(crate) fn pieces(&self) -> usize {
        self.words.rows()
    }

    /// How many pieces it can read at once.
    pub(crate) fn positions(&self) -> usize {
        self.positions.len() / WIDTH
    }

    /// What each piece means where it stands, given who says it: `[pieces, WIDTH]`.
    pub(crate) fn read(&self, pieces: &[u32], speakers: &[u8]) -> Vec<f32> {
        let mut rows: Vec<f32> = Vec::with_capacity(pieces.len() * WIDTH);
        for ((piece, speaker), position) in pieces.iter().zip(speakers).zip(self.positions.chunks_exact(WIDTH)) {
            let speaker = &self.speakers[usize::from(*speaker) * WIDTH..];
            let sum = self.words.row(*piece as usize).zip(position).zip(speaker);
            rows.extend(sum.map(|((word, position), speaker)| word + position + speaker));
        }
        self.norm.apply(&mut rows, WIDTH);
        self.layers.iter().fold(rows, |rows, layer| layer.apply(rows, WIDTH, HEADS))
    }
}

/// The mean of rows of [`WIDTH`] numbers.
pub(crate) fn mean(rows: &[f32]) -> [f32; WIDTH] {
    let mut sum = [0.0; WIDTH];
    rows.chunks_exact(WIDTH).for_each(|row| add(&mut sum, row));
    sum.map(|sum| sum / (rows.len() / WIDTH) as f32)
}
