//! A transformer that reads from left to right (the network of Llama): grouped-query attention, rotary positions, gated hidden layers.
//!
//! The same to the bit on every machine: products of matrices are sums of integers, the rest plain sums in a fixed order.

use std::sync::LazyLock;

use crate::{
    ModelError,
    matrix::Linear,
    sums::{LANES, add, add_weighed, dot, exp, for_widest_registers, scale, softmax},
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
    /// Of as many tokens as fit into a register, side by side: `[tokens / 16, KEYS, 16]`.
    keys: Vec<[f32; LANES]>,
    /// `[tokens, KEYS]`
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
            keys: layer.keys[..length.div_ceil(LANES) * KEYS].to_vec(),
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
        add(rows, &self.output.apply(&gated(&both)));
    }
}

impl KeysAndValues {
    /// How many tokens.
    const fn count(&self) -> usize {
        self.values.len() / KEYS
    }

    /// Adds a key and, behind it, a value.
    fn push(&mut self, both: &[f32]) {
        let (key, value) = both.split_at(KEYS);
        let (block, lane) = (self.count() / LANES * KEYS, self.count() % LANES);
        if lane == 0 {
            self.keys.resize(block + KEYS, [0.0; LANES]);
        }
        for (keys, key) in self.keys[block..].iter_mut().zip(key) {
            keys[lane] = *key;
        }
        self.values.extend_from_slice(value);
    }

    /// How well the keys of a head fit a query.
    #[inline(always)]
    fn fits(&self, begin: usize, query: &[f32; HEAD], fits: &mut Vec<f32>) {
        for block in self.keys.chunks_exact(KEYS) {
            let mut sums = [[0.0; LANES]; 4];
            let keys = block[begin..begin + HEAD].as_chunks::<4>().0;
            for (query, keys) in query.as_chunks::<4>().0.iter().zip(keys) {
                for part in 0..4 {
                    add_weighed(&mut sums[part], query[part], &keys[part]);
                }
            }
            let [mut first, second, mut third, fourth] = sums;
            add(&mut first, &second);
            add(&mut third, &fourth);
            add(&mut first, &third);
            fits.extend_from_slice(&first);
        }
        let beyond = self.keys.len() / KEYS * LANES - self.count();
        fits.truncate(fits.len() - beyond);
    }

    /// The values of a head, weighed and added.
    #[inline(always)]
    fn add_values(&self, begin: usize, weights: &[f32], sums: &mut [[f32; LANES]; HEAD / LANES]) {
        for (value, weight) in self.values.chunks_exact(KEYS).zip(weights) {
            let value = value[begin..begin + HEAD].as_chunks::<LANES>().0;
            for part in 0..HEAD / LANES {
                add_weighed(&mut sums[part], *weight, &value[part]);
            }
        }
    }
}

for_widest_registers! {
    /// The values, weighted by how well their keys fit the queries: several heads of queries share one of keys and values.
    fn attend(queries: &[f32], memories: [&KeysAndValues; 2]) -> Vec<f32> {
        let mut attended = Vec::with_capacity(WIDTH);
        let mut weights = Vec::with_capacity(memories[0].count() + memories[1].count() + LANES);
        for (head, query) in queries.as_chunks::<HEAD>().0.iter().enumerate() {
            let begin = head * KEY_HEADS / HEADS * HEAD;
            weights.clear();
            memories[0].fits(begin, query, &mut weights);
            memories[1].fits(begin, query, &mut weights);
            scale(&mut weights, 1.0 / (HEAD as f32).sqrt());
            softmax(&mut weights);
            let mut sums = [[0.0; LANES]; HEAD / LANES];
            let (first, second) = weights.split_at(memories[0].count());
            memories[0].add_values(begin, first, &mut sums);
            memories[1].add_values(begin, second, &mut sums);
            attended.extend_from_slice(sums.as_flattened());
        }
        attended
    }
}

for_widest_registers! {
    /// `x σ(x)` of each row's first half, times its second.
    fn gated(rows: &[f32]) -> Vec<f32> {
        let mut hidden = Vec::with_capacity(rows.len() / 2);
        for row in rows.chunks_exact(2 * HIDDEN) {
            let (gates, values) = row.split_at(HIDDEN);
            hidden.extend_from_slice(values);
            let begin = hidden.len() - HIDDEN;
            for (value, gate) in hidden[begin..].iter_mut().zip(gates) {
                *value *= gate / (1.0 + exp(-gate));
            }
        }
        hidden
    }
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
