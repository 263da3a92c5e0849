//! The network: an encoder of word pieces in context (the lower layers of MiniLM), and a decoder that writes symbols and points
//! to words.

use crate::{
    ModelError,
    encoder::{self, Encoder, WIDTH},
    layers::{KeysAndValues, Layer, Norm, add, dot},
    matrix::Linear,
    source::Source,
    tensors::Tensors,
};

/// Numbers that stand for a letter.
pub(crate) const DECODER_WIDTH: usize = 256;
const DECODER_HEADS: usize = 4;
/// The most letters of an output.
pub(crate) const MOST_LETTERS: usize = 39;
/// What the pointers' scores are divided by.
const POINTER_SCALE: f32 = 16.0;

#[derive(Debug)]
pub(crate) struct Network {
    encoder: Encoder,
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
        let network = Self {
            encoder: Encoder::new(tensors, tensors)?,
            memory: tensors.linear("memory")?,
            starts: tensors.linear("starts")?,
            ends: tensors.linear("ends")?,
            symbols: tensors.floats("symbols")?,
            letter_positions: tensors.floats("letter_positions")?,
            kinds: tensors.floats("kinds")?,
            letter_norm: Norm::new(tensors, "letter_norm")?,
            decoder: (0..tensors.count("decoder")?)
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
        self.encoder.pieces()
    }

    /// Reads an utterance.
    pub(crate) fn encode(&self, source: &Source<'_>) -> Memory {
        let pieces = self.encoder.read(&source.pieces, &source.speakers);
        // Each word is the mean of its pieces.
        let mut words = Vec::with_capacity(source.words.len() * WIDTH);
        for span in &source.spans {
            words.extend(encoder::mean(&pieces[span.start * WIDTH..span.end * WIDTH]));
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
