//! The network: an encoder of word pieces in context (the lower layers of MiniLM), and a decoder that writes symbols and points
//! to words.

use std::sync::LazyLock;

use crate::{
    ModelError,
    matrix::Linear,
    source::Source,
    tensors::{Embedding, Tensors},
};

/// Numbers that stand for a piece, and in the decoder for a letter.
const WIDTH: usize = 384;
const HEADS: usize = 12;
pub(crate) const DECODER_WIDTH: usize = 256;
const DECODER_HEADS: usize = 4;
/// The most letters of an output.
pub(crate) const MOST_LETTERS: usize = 39;
/// What the pointers' scores are divided by.
const POINTER_SCALE: f32 = 16.0;

#[derive(Debug)]
pub(crate) struct Network {
    words: Embedding,
    positions: Vec<f32>,
    speakers: Vec<f32>,
    norm: Norm,
    encoder: Vec<Layer>,
    memory: Linear,
    starts: Linear,
    ends: Linear,
    symbols: Vec<f32>,
    letter_positions: Vec<f32>,
    kinds: Vec<f32>,
    letter_norm: Norm,
    decoder: Vec<DecoderLayer>,
    to_symbols: Linear,
    to_start: Linear,
    to_end: Linear,
}

#[derive(Debug)]
struct Norm {
    weight: Vec<f32>,
    bias: Vec<f32>,
}

/// Attention of a sequence to itself, then a network of one hidden layer.
#[derive(Debug)]
struct Layer {
    query_key_value: Linear,
    attended: Linear,
    norm: Norm,
    hidden: Linear,
    output: Linear,
    last_norm: Norm,
}

/// The same, with attention to the words in between.
#[derive(Debug)]
struct DecoderLayer {
    layer: Layer,
    query: Linear,
    key_value: Linear,
    attended: Linear,
    norm: Norm,
}

/// What the decoder knows of the words.
pub(crate) struct Memory {
    words: Vec<f32>,
    starts: Vec<f32>,
    ends: Vec<f32>,
    /// Keys and values of each layer.
    attended: Vec<KeysAndValues>,
}

#[derive(Clone, Debug, Default)]
struct KeysAndValues {
    keys: Vec<f32>,
    values: Vec<f32>,
}

/// What has been written, as the decoder remembers it.
#[derive(Clone, Debug)]
pub(crate) struct Written {
    layers: Vec<KeysAndValues>,
    length: usize,
}

/// The letter before.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Input {
    Begin,
    Symbol(usize),
    Start(usize),
    End(usize),
}

/// How likely each next letter is, before they are normalised.
pub(crate) struct Scores {
    pub(crate) symbols: Vec<f32>,
    pub(crate) starts: Vec<f32>,
    pub(crate) ends: Vec<f32>,
}

impl Network {
    pub(crate) fn new(tensors: &Tensors<'_>) -> Result<Self, ModelError> {
        let layers = |kind: &str| tensors.note(kind)?.parse::<usize>().map_err(|_| ModelError::Shape(kind.to_owned()));
        let network = Self {
            words: tensors.embedding("words", WIDTH)?,
            positions: tensors.floats("positions")?,
            speakers: tensors.floats("speakers")?,
            norm: Norm::new(tensors, "norm")?,
            encoder: (0..layers("encoder")?)
                .map(|layer| Layer::new(tensors, &format!("encoder.{layer}")))
                .collect::<Result<_, _>>()?,
            memory: tensors.linear("memory")?,
            starts: tensors.linear("starts")?,
            ends: tensors.linear("ends")?,
            symbols: tensors.floats("symbols")?,
            letter_positions: tensors.floats("letter_positions")?,
            kinds: tensors.floats("kinds")?,
            letter_norm: Norm::new(tensors, "letter_norm")?,
            decoder: (0..layers("decoder")?)
                .map(|layer| DecoderLayer::new(tensors, &format!("decoder.{layer}")))
                .collect::<Result<_, _>>()?,
            to_symbols: tensors.linear("to_symbols")?,
            to_start: tensors.linear("to_start")?,
            to_end: tensors.linear("to_end")?,
        };
        Ok(network)
    }

    /// How many symbols it can write.
    pub(crate) fn symbols(&self) -> usize {
        self.to_symbols.outputs()
    }

    /// How many pieces it knows.
    pub(crate) fn pieces(&self) -> usize {
        self.words.rows()
    }

    /// Reads an utterance.
    pub(crate) fn encode(&self, source: &Source<'_>) -> Memory {
        let mut pieces: Vec<f32> = Vec::with_capacity(source.pieces.len() * WIDTH);
        for (at, (piece, speaker)) in source.pieces.iter().zip(&source.speakers).enumerate() {
            let position = &self.positions[at * WIDTH..(at + 1) * WIDTH];
            let speaker = &self.speakers[usize::from(*speaker) * WIDTH..];
            let sum = self.words.row(*piece as usize).zip(position).zip(speaker);
            pieces.extend(sum.map(|((word, position), speaker)| word + position + speaker));
        }
        self.norm.apply(&mut pieces, WIDTH);
        for layer in &self.encoder {
            pieces = layer.apply(pieces);
        }
        // Each word is the mean of its pieces.
        let mut words = Vec::with_capacity(source.words.len() * WIDTH);
        for span in &source.spans {
            let mut sum = [0.0; WIDTH];
            for piece in pieces[span.start * WIDTH..span.end * WIDTH].chunks_exact(WIDTH) {
                sum.iter_mut().zip(piece).for_each(|(sum, value)| *sum += value);
            }
            words.extend(sum.map(|sum| sum / span.len() as f32));
        }
        let memory = self.memory.apply(&words);
        let attended = self.decoder.iter().map(|layer| {
            let both = layer.key_value.apply(&memory);
            let mut attended = KeysAndValues::default();
            both.chunks_exact(2 * DECODER_WIDTH).for_each(|row| attended.push(row));
            attended
        });
        Memory {
            attended: attended.collect(),
            starts: self.starts.apply(&words),
            ends: self.ends.apply(&words),
            words: memory,
        }
    }

    /// Nothing written yet.
    pub(crate) fn begin(&self) -> Written {
        Written { layers: vec![KeysAndValues::default(); self.decoder.len()], length: 0 }
    }

    /// How likely each letter is after each of these inputs, which are written behind what was.
    pub(crate) fn next(&self, mut written: Vec<(Input, &mut Written)>, memory: &Memory) -> Vec<Scores> {
        let row = |rows: &[f32], at: usize| -> Vec<f32> { rows[at * DECODER_WIDTH..(at + 1) * DECODER_WIDTH].to_vec() };
        let mut states = Vec::with_capacity(written.len() * DECODER_WIDTH);
        for (input, written) in &mut written {
            let (mut state, kind) = match *input {
                Input::Begin => (row(&self.symbols, self.symbols()), 0),
                Input::Symbol(symbol) => (row(&self.symbols, symbol), 0),
                Input::Start(word) => (row(&memory.words, word), 1),
                Input::End(word) => (row(&memory.words, word), 2),
            };
            add(&mut state, &row(&self.kinds, kind));
            add(&mut state, &row(&self.letter_positions, written.length));
            written.length += 1;
            states.extend(state);
        }
        self.letter_norm.apply(&mut states, DECODER_WIDTH);
        for (at, layer) in self.decoder.iter().enumerate() {
            let before = written.iter_mut().map(|(_, written)| &mut written.layers[at]);
            states = layer.apply(states, before, &memory.attended[at]);
        }
        let symbols = self.to_symbols.apply(&states);
        let starts = self.to_start.apply(&states);
        let ends = self.to_end.apply(&states);
        let pointed = |query: &[f32], words: &[f32]| -> Vec<f32> {
            words.chunks_exact(DECODER_WIDTH).map(|word| dot(query, word) / POINTER_SCALE).collect()
        };
        let queries = starts.chunks_exact(DECODER_WIDTH).zip(ends.chunks_exact(DECODER_WIDTH));
        let scores = symbols.chunks_exact(self.symbols()).zip(queries).map(|(symbols, (start, end))| Scores {
            symbols: symbols.to_vec(),
            starts: pointed(start, &memory.starts),
            ends: pointed(end, &memory.ends),
        });
        scores.collect()
    }
}

impl Layer {
    fn new(tensors: &Tensors<'_>, name: &str) -> Result<Self, ModelError> {
        Ok(Self {
            query_key_value: tensors.linear(&format!("{name}.query_key_value"))?,
            attended: tensors.linear(&format!("{name}.attended"))?,
            norm: Norm::new(tensors, &format!("{name}.norm"))?,
            hidden: tensors.linear(&format!("{name}.hidden"))?,
            output: tensors.linear(&format!("{name}.output"))?,
            last_norm: Norm::new(tensors, &format!("{name}.last_norm"))?,
        })
    }

    fn apply(&self, mut rows: Vec<f32>) -> Vec<f32> {
        let both = self.query_key_value.apply(&rows);
        let mut attended = KeysAndValues::default();
        let mut queries = Vec::with_capacity(rows.len());
        for row in both.chunks_exact(3 * WIDTH) {
            queries.extend_from_slice(&row[..WIDTH]);
            attended.push(&row[WIDTH..]);
        }
        let mut values = Vec::with_capacity(rows.len());
        queries.chunks_exact(WIDTH).for_each(|query| values.extend(attended.attend(query, HEADS)));
        add(&mut rows, &self.attended.apply(&values));
        self.norm.apply(&mut rows, WIDTH);
        self.finish(rows, WIDTH)
    }

    fn finish(&self, mut rows: Vec<f32>, width: usize) -> Vec<f32> {
        let mut hidden = self.hidden.apply(&rows);
        hidden.iter_mut().for_each(|value| *value = gelu(*value));
        add(&mut rows, &self.output.apply(&hidden));
        self.last_norm.apply(&mut rows, width);
        rows
    }
}

impl DecoderLayer {
    fn new(tensors: &Tensors<'_>, name: &str) -> Result<Self, ModelError> {
        Ok(Self {
            layer: Layer::new(tensors, name)?,
            query: tensors.linear(&format!("{name}.words.query"))?,
            key_value: tensors.linear(&format!("{name}.words.key_value"))?,
            attended: tensors.linear(&format!("{name}.words.attended"))?,
            norm: Norm::new(tensors, &format!("{name}.words.norm"))?,
        })
    }

    /// Of several outputs at once, each with what was written before it.
    fn apply<'a>(
        &self,
        mut states: Vec<f32>,
        before: impl Iterator<Item = &'a mut KeysAndValues>,
        words: &KeysAndValues,
    ) -> Vec<f32> {
        let both = self.layer.query_key_value.apply(&states);
        let mut values = Vec::with_capacity(states.len());
        for (row, before) in both.chunks_exact(3 * DECODER_WIDTH).zip(before) {
            before.push(&row[DECODER_WIDTH..]);
            values.extend(before.attend(&row[..DECODER_WIDTH], DECODER_HEADS));
        }
        add(&mut states, &self.layer.attended.apply(&values));
        self.layer.norm.apply(&mut states, DECODER_WIDTH);
        let queries = self.query.apply(&states);
        let values: Vec<f32> =
            queries.chunks_exact(DECODER_WIDTH).flat_map(|query| words.attend(query, DECODER_HEADS)).collect();
        add(&mut states, &self.attended.apply(&values));
        self.norm.apply(&mut states, DECODER_WIDTH);
        self.layer.finish(states, DECODER_WIDTH)
    }
}

impl KeysAndValues {
    /// Adds a key and, behind it, a value.
    fn push(&mut self, both: &[f32]) {
        let (key, value) = both.split_at(both.len() / 2);
        self.keys.extend_from_slice(key);
        self.values.extend_from_slice(value);
    }

    /// The values, weighted by how well their keys fit the query, in each head.
    fn attend(&self, query: &[f32], heads: usize) -> Vec<f32> {
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
    fn new(tensors: &Tensors<'_>, name: &str) -> Result<Self, ModelError> {
        Ok(Self { weight: tensors.floats(&format!("{name}.weight"))?, bias: tensors.floats(&format!("{name}.bias"))? })
    }

    /// Shifts and scales each row to mean 0 and variance 1, then by the learned numbers.
    fn apply(&self, rows: &mut [f32], width: usize) {
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

fn dot(a: &[f32], b: &[f32]) -> f32 {
    let mut lanes = [0.0; LANES];
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    for (a, b) in a.iter().zip(b) {
        for lane in 0..LANES {
            lanes[lane] += a[lane] * b[lane];
        }
    }
    lanes.iter().sum::<f32>() + a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum::<f32>()
}

fn sum(values: &[f32]) -> f32 {
    let mut lanes = [0.0; LANES];
    let (chunks, rest) = values.as_chunks::<LANES>();
    for chunk in chunks {
        lanes.iter_mut().zip(chunk).for_each(|(lane, value)| *lane += value);
    }
    lanes.iter().sum::<f32>() + rest.iter().sum::<f32>()
}

fn add(rows: &mut [f32], others: &[f32]) {
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
fn gelu(x: f32) -> f32 {
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
