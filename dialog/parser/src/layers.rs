//! Layers that encoder and decoder are made of, in plain numbers: the same to the bit on every machine.

use std::sync::LazyLock;

use crate::{ModelError, matrix::Linear, tensors::Tensors};

#[derive(Debug)]
pub(crate) struct Norm {
    pub(crate) weight: Vec<f32>,
    pub(crate) bias: Vec<f32>,
}

/// Attention of a sequence to itself, then a network of one hidden layer.
#[derive(Debug)]
pub(crate) struct Layer {
    pub(crate) query_key_value: Linear,
    pub(crate) attended: Linear,
    pub(crate) norm: Norm,
    pub(crate) hidden: Linear,
    pub(crate) output: Linear,
    pub(crate) last_norm: Norm,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct KeysAndValues {
    pub(crate) keys: Vec<f32>,
    pub(crate) values: Vec<f32>,
}

impl Layer {
    pub(crate) fn new(tensors: &Tensors<'_>, name: &str) -> Result<Self, ModelError> {
        Ok(Self {
            query_key_value: tensors.linear(&format!("{name}.query_key_value"))?,
            attended: tensors.linear(&format!("{name}.attended"))?,
            norm: Norm::new(tensors, &format!("{name}.norm"))?,
            hidden: tensors.linear(&format!("{name}.hidden"))?,
            output: tensors.linear(&format!("{name}.output"))?,
            last_norm: Norm::new(tensors, &format!("{name}.last_norm"))?,
        })
    }

    /// Of rows of `width` numbers each, with so many heads of attention.
    pub(crate) fn apply(&self, mut rows: Vec<f32>, width: usize, heads: usize) -> Vec<f32> {
        let both = self.query_key_value.apply(&rows);
        let mut attended = KeysAndValues::default();
        let mut queries = Vec::with_capacity(rows.len());
        for row in both.chunks_exact(3 * width) {
            queries.extend_from_slice(&row[..width]);
            attended.push(&row[width..]);
        }
        let mut values = Vec::with_capacity(rows.len());
        queries.chunks_exact(width).for_each(|query| values.extend(attended.attend(query, heads)));
        add(&mut rows, &self.attended.apply(&values));
        self.norm.apply(&mut rows, width);
        self.finish(rows, width)
    }

    pub(crate) fn finish(&self, mut rows: Vec<f32>, width: usize) -> Vec<f32> {
        let mut hidden = self.hidden.apply(&rows);
        hidden.iter_mut().for_each(|value| *value = gelu(*value));
        add(&mut rows, &self.output.apply(&hidden));
        self.last_norm.apply(&mut rows, width);
        rows
    }
}

impl KeysAndValues {
    /// Adds a key and, behind it, a value.
    pub(crate) fn push(&mut self, both: &[f32]) {
        let (key, value) = both.split_at(both.len() / 2);
        self.keys.extend_from_slice(key);
        self.values.extend_from_slice(value);
    }

    /// The values, weighted by how well their keys fit the query, in each head.
    pub(crate) fn attend(&self, query: &[f32], heads: usize) -> Vec<f32> {
        let (width, size) = (query.len(), query.len() / heads);
        let scale = 1.0 / (size as f32).sqrt();
        let mut attended = vec![0.0; width];
        for (head, attended) in attended.chunks_exact_mut(size).enumerate() {
            let part = head * size..(head + 1) * size;
            let query = &query[part.clone()];
            let mut weights: Vec<f32> =
                self.keys.chunks_exact(width).map(|key| dot(query, &key[part.clone()]) * scale).collect();
            softmax(&mut weights);
            for (weight, value) in weights.iter().zip(self.values.chunks_exact(width)) {
                attended.iter_mut().zip(&value[part.clone()]).for_each(|(sum, value)| *sum += weight * value);
            }
        }
        attended
    }
}

impl Norm {
    pub(crate) fn new(tensors: &Tensors<'_>, name: &str) -> Result<Self, ModelError> {
        Ok(Self { weight: tensors.floats(&format!("{name}.weight"))?, bias: tensors.floats(&format!("{name}.bias"))? })
    }

    /// Shifts and scales each row to mean 0 and variance 1, then by the learned numbers.
    pub(crate) fn apply(&self, rows: &mut [f32], width: usize) {
        for row in rows.chunks_exact_mut(width) {
            let mean = sum(row) / width as f32;
            row.iter_mut().for_each(|value| *value -= mean);
            let factor = 1.0 / (dot(row, row) / width as f32 + 1e-12).sqrt();
            let learned = self.weight.iter().zip(&self.bias);
            row.iter_mut().zip(learned).for_each(|(value, (weight, bias))| *value = *value * factor * weight + bias);
        }
    }
}

/// Numbers that are summed side by side: the order of a sum is part of its result.
const LANES: usize = 16;

pub(crate) fn dot(a: &[f32], b: &[f32]) -> f32 {
    let mut lanes = [0.0; LANES];
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    for (a, b) in a.iter().zip(b) {
        for lane in 0..LANES {
            lanes[lane] += a[lane] * b[lane];
        }
    }
    lanes.iter().sum::<f32>() + a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum::<f32>()
}

pub(crate) fn sum(values: &[f32]) -> f32 {
    let mut lanes = [0.0; LANES];
    let (chunks, rest) = values.as_chunks::<LANES>();
    for chunk in chunks {
        lanes.iter_mut().zip(chunk).for_each(|(lane, value)| *lane += value);
    }
    lanes.iter().sum::<f32>() + rest.iter().sum::<f32>()
}

pub(crate) fn add(rows: &mut [f32], others: &[f32]) {
    rows.iter_mut().zip(others).for_each(|(value, other)| *value += other);
}

/// From scores to weights that sum to 1.
pub(crate) fn softmax(scores: &mut [f32]) {
    let largest = scores.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    scores.iter_mut().for_each(|score| *score = libm::expf(*score - largest));
    let total = sum(scores);
    scores.iter_mut().for_each(|score| *score /= total);
}

/// `x Φ(x)`, from a table between -8 and 8.
pub(crate) fn gelu(x: f32) -> f32 {
    const STEPS: usize = 256;
    static TABLE: LazyLock<Vec<f32>> = LazyLock::new(|| {
        let x = |at: usize| at as f32 / STEPS as f32 - 8.0;
        (0..=16 * STEPS + 1)
            .map(|at| 0.5 * x(at) * (1.0 + libm::erff(x(at) * std::f32::consts::FRAC_1_SQRT_2)))
            .collect()
    });
    if x.abs() >= 8.0 {
        return x.max(0.0);
    }
    let place = (x + 8.0) * STEPS as f32;
    let at = place as usize;
    let part = place - at as f32;
    TABLE[at] * (1.0 - part) + TABLE[at + 1] * part
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_the_function() {
        for at in -1000..1000 {
            let x = at as f32 * 0.009_7;
            let exact = 0.5 * x * (1.0 + libm::erff(x * std::f32::consts::FRAC_1_SQRT_2));
            assert!((gelu(x) - exact).abs() < 1e-5, "{x}");
        }
    }

    #[test]
    fn weights_sum_to_one() {
        let mut scores = vec![3.0, -1.0, 900.0, 899.0];
        softmax(&mut scores);
        assert!((scores.iter().sum::<f32>() - 1.0).abs() < 1e-6);
        assert!((scores[2] / scores[3] - std::f32::consts::E).abs() < 1e-3);
    }
}
