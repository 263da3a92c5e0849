//! A transformer that reads from left to right (the network of Llama): grouped-query attention, rotary positions, gated hidden layers.
//!
//! The same to the bit on every machine: products of matrices are sums of integers, the rest plain sums in a fixed order.

use std::sync::LazyLock;

use crate::{
    ModelError,
    matrix::Linear,
    sums::{add, dot, softmax},
    tensors::{Embedding, Tensors},
    tokens::Token,
};

/// Numbers that stand for a token.
const WIDTH: usize = 576;
/// Heads of attention, those of keys and values, and the numbers of each.
const HEADS: usize = 9;
const KEY_HEADS: usize = 3;
const HEAD: usize = 64;
const KEYS: usize = KEY_HEADS * HEAD;
const HIDDEN: usize = 1536;
/// The base of the rotary positions' wavelengths.
const LONGEST_WAVE: f32 = 100_000.0;

#[derive(Debug)]
pub(crate) struct Transformer {
    embedding: Embedding,
    marks: Vec<f32>,
    layers: Vec<Layer>,
    norm: Norm,
    /// The score of each token.
    scores: Linear,
}

#[derive(Debug)]
struct Layer {
    norm: Norm,
    query_key_value: Linear,
    attended: Linear,
    hidden_norm: Norm,
    gate_and_hidden: Linear,
    output: Linear,
}

/// What was read or written, as each layer remembers it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Memory {
    layers: Vec<KeysAndValues>,
    length: usize,
}

#[derive(Clone, Debug, Default)]
struct KeysAndValues {
    keys: Vec<f32>,
    values: Vec<f32>,
}

impl Memory {
    /// How many tokens were read.
    pub(crate) const fn length(&self) -> usize {
        self.length
    }

    /// The same of the first tokens alone.
    pub(crate) fn beginning(&self, length: usize) -> Self {
        let first = |layer: &KeysAndValues| KeysAndValues {
            keys: layer.keys[..length * KEYS].to_vec(),
            values: layer.values[..length * KEYS].to_vec(),
        };
        Self { layers: self.layers.iter().map(first).collect(), length }
    }
}

impl Transformer {
    pub(crate) fn new(tensors: &Tensors<'_>) -> Result<Self, ModelError> {
        Ok(Self {
            embedding: tensors.embedding("embedding", WIDTH)?,
            marks: tensors.floats("marks")?,
            layers: (0..tensors.count("layers")?)
                .map(|layer| Layer::new(tensors, &format!("layers.{layer}")))
                .collect::<Result<_, _>>()?,
            norm: Norm::new(tensors, "norm")?,
            scores: tensors.packed_linear("embedding", WIDTH)?,
        })
    }

    /// How many tokens it knows.
    pub(crate) const fn tokens(&self) -> usize {
        self.scores.outputs()
    }

    /// How many marks it knows.
    pub(crate) fn marks(&self) -> usize {
        self.marks.len() / WIDTH
    }

    /// Nothing read yet.
    pub(crate) fn begin(&self) -> Memory {
        Memory { layers: vec![KeysAndValues::default(); self.layers.len()], length: 0 }
    }

    /// Reads tokens, each behind what its owner among `memories` has read, which is behind what `all` have. The scores of all tokens as the next:
    /// for each owner behind its last token, in their order.
    pub(crate) fn next(&self, tokens: &[Token], owners: &[usize], memories: &mut [Memory], all: &Memory) -> Vec<f32> {
        let mut rows = Vec::with_capacity(tokens.len() * WIDTH);
        let mut positions = Vec::with_capacity(tokens.len());
        for (token, owner) in tokens.iter().zip(owners) {
            match *token {
                Token::Text(token) => rows.extend(self.embedding.row(token)),
                Token::Mark(mark) => rows.extend_from_slice(&self.marks[mark * WIDTH..(mark + 1) * WIDTH]),
            }
            positions.push(all.length + memories[*owner].length);
            memories[*owner].length += 1;
        }
        for (at, layer) in self.layers.iter().enumerate() {
            let none = KeysAndValues::default();
            let before = all.layers.get(at).unwrap_or(&none);
            layer.apply(&mut rows, &positions, |row, keys_and_values, queries| {
                let own = &mut memories[owners[row]].layers[at];
                own.push(keys_and_values);
                attend(queries, [before, own])
            });
        }
        let last = (0..memories.len()).filter_map(|owner| owners.iter().rposition(|of| *of == owner));
        let mut last: Vec<f32> = last.flat_map(|row| rows[row * WIDTH..(row + 1) * WIDTH].to_vec()).collect();
        self.norm.apply(&mut last);
        self.scores.apply(&last)
    }
}

impl Layer {
    fn new(tensors: &Tensors<'_>, name: &str) -> Result<Self, ModelError> {
        Ok(Self {
            norm: Norm::new(tensors, &format!("{name}.norm"))?,
            query_key_value: tensors.packed_linear(&format!("{name}.query_key_value"), WIDTH)?,
            attended: tensors.packed_linear(&format!("{name}.attended"), WIDTH)?,
            hidden_norm: Norm::new(tensors, &format!("{name}.hidden_norm"))?,
            gate_and_hidden: tensors.packed_linear(&format!("{name}.gate_and_hidden"), WIDTH)?,
            output: tensors.packed_linear(&format!("{name}.output"), HIDDEN)?,
        })
    }

    /// `attend` gives what a row attends to, of its number, its key and value, and its queries.
    fn apply(&self, rows: &mut [f32], positions: &[usize], mut attend: impl FnMut(usize, &[f32], &[f32]) -> Vec<f32>) {
        let mut all = self.query_key_value.apply(&self.norm.of(rows));
        let mut attended = Vec::with_capacity(rows.len());
        for (row, (all, position)) in all.chunks_exact_mut(WIDTH + 2 * KEYS).zip(positions).enumerate() {
            all[..WIDTH + KEYS].chunks_exact_mut(HEAD).for_each(|head| rotate(head, *position));
            let (queries, keys_and_values) = all.split_at(WIDTH);
            attended.extend(attend(row, keys_and_values, queries));
        }
        add(rows, &self.attended.apply(&attended));
        let both = self.gate_and_hidden.apply(&self.hidden_norm.of(rows));
        let mut hidden = Vec::with_capacity(both.len() / 2);
        for both in both.chunks_exact(2 * HIDDEN) {
            let (gates, values) = both.split_at(HIDDEN);
            hidden.extend(gates.iter().zip(values).map(|(gate, value)| silu(*gate) * value));
        }
        add(rows, &self.output.apply(&hidden));
    }
}

impl KeysAndValues {
    /// Adds a key and, behind it, a value.
    fn push(&mut self, both: &[f32]) {
        let (key, value) = both.split_at(KEYS);
        self.keys.extend_from_slice(key);
        self.values.extend_from_slice(value);
    }
}

/// The values, weighted by how well their keys fit the queries: several heads of queries share one of keys and values.
fn attend(queries: &[f32], memories: [&KeysAndValues; 2]) -> Vec<f32> {
    let scale = 1.0 / (HEAD as f32).sqrt();
    let mut attended = vec![0.0; WIDTH];
    for (head, (query, attended)) in queries.chunks_exact(HEAD).zip(attended.chunks_exact_mut(HEAD)).enumerate() {
        let begin = head * KEY_HEADS / HEADS * HEAD;
        let part = begin..begin + HEAD;
        let keys = memories.iter().flat_map(|memory| memory.keys.chunks_exact(KEYS));
        let mut weights: Vec<f32> = keys.map(|key| dot(query, &key[part.clone()]) * scale).collect();
        softmax(&mut weights);
        let values = memories.iter().flat_map(|memory| memory.values.chunks_exact(KEYS));
        for (weight, value) in weights.iter().zip(values) {
            attended.iter_mut().zip(&value[part.clone()]).for_each(|(sum, value)| *sum += weight * value);
        }
    }
    attended
}

/// Turns the pairs of a head's numbers (one of each half) by angles that grow with the position.
fn rotate(head: &mut [f32], position: usize) {
    static FREQUENCIES: LazyLock<Vec<f32>> = LazyLock::new(|| {
        let exponent = |at: usize| 2.0 * at as f32 / HEAD as f32;
        (0..HEAD / 2).map(|at| 1.0 / libm::powf(LONGEST_WAVE, exponent(at))).collect()
    });
    let (first, second) = head.split_at_mut(HEAD / 2);
    for ((one, other), frequency) in first.iter_mut().zip(second).zip(FREQUENCIES.iter()) {
        let (sine, cosine) = libm::sincosf(position as f32 * frequency);
        (*one, *other) = (*one * cosine - *other * sine, *other * cosine + *one * sine);
    }
}

/// `x σ(x)`
fn silu(x: f32) -> f32 {
    x / (1.0 + libm::expf(-x))
}

/// Scales each row to a mean square of 1, then by the learned numbers.
#[derive(Debug)]
struct Norm {
    weight: Vec<f32>,
}

impl Norm {
    fn new(tensors: &Tensors<'_>, name: &str) -> Result<Self, ModelError> {
        Ok(Self { weight: tensors.floats(name)? })
    }

    fn of(&self, rows: &[f32]) -> Vec<f32> {
        let mut rows = rows.to_vec();
        self.apply(&mut rows);
        rows
    }

    fn apply(&self, rows: &mut [f32]) {
        for row in rows.chunks_exact_mut(WIDTH) {
            let factor = 1.0 / (dot(row, row) / WIDTH as f32 + 1e-5).sqrt();
            row.iter_mut().zip(&self.weight).for_each(|(value, weight)| *value *= factor * weight);
        }
    }
}
