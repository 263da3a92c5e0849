//! A decoder as exporters merge it of one without and one with a memory (`decoder_model_merged`): which tokens may come next, by
//! what an encoder made of the sound and by the tokens before.

use std::path::Path;

use ort::{
    session::{Session, SessionInputValue},
    value::{DynValue, Tensor, TensorRef},
};

use crate::{SpeechError, onnx};

/// Logits that differ by no more are the same.
const ALIKE: f32 = 1e-2;

/// An opened decoder.
pub(crate) struct Decoder {
    session: Session,
    /// Names of what it remembers of its own words, and of the sound; for each the name it is given back by.
    own: Vec<[String; 2]>,
    sound: Vec<[String; 2]>,
    heads: usize,
    width: usize,
    /// Whether all rows can look at one sound, or each needs its own copy.
    shares_sound: bool,
}

/// What an encoder made of a sound.
pub(crate) struct Encoded {
    /// `[length, features]`.
    values: Vec<f32>,
    length: usize,
    features: usize,
    /// How many samples there were.
    samples: usize,
}

/// What the decoder remembers for each row: `[rows, heads, length, width]` each.
struct Memory {
    own: Vec<Vec<f32>>,
    /// Alike in all rows, with as many of them as are ever needed, or one that they share.
    sound: Vec<Vec<f32>>,
    length: usize,
    sound_length: usize,
}

/// The decoder at work on one utterance.
pub(crate) struct Steps<'d> {
    decoder: &'d mut Decoder,
    /// With as many rows as are ever needed, or one that they share: `[rows, length, features]`.
    encoded: Encoded,
    memory: Memory,
    /// Logits of the last step: `[rows, places, tokens]`, where all but the first step are of one place.
    logits: Vec<f32>,
    tokens: usize,
    places: usize,
}

impl Decoder {
    /// Opens a decoder, on so many threads; the runtime is loaded.
    ///
    /// # Errors
    /// [`SpeechError::Missing`] or [`SpeechError::Broken`].
    pub(crate) fn open(path: &Path, threads: usize) -> Result<Self, SpeechError> {
        let session = onnx::open(path, threads)?;
        let names = |whose: &str| -> Vec<[String; 2]> {
            let inputs = session.inputs().iter().map(|input| input.name());
            let remembered = inputs.filter(|name| name.starts_with("past_key_values") && name.contains(whose));
            remembered.map(|name| [name.to_owned(), name.replace("past_key_values", "present")]).collect()
        };
        let (own, sound) = (names(".decoder."), names(".encoder."));
        let shape = own.first().and_then(|[name, _]| onnx::shape(&session, name));
        match shape.as_deref() {
            Some(&[_, heads, _, width]) if heads > 0 && width > 0 => {
                let (heads, width) = (heads as usize, width as usize);
                Ok(Self { session, own, sound, heads, width, shares_sound: false })
            }
            _ => Err(SpeechError::Broken {
                path: path.into(),
                why: "it is no decoder that remembers, as `decoder_model_merged` does".into(),
                remedy: onnx::remedy(path),
            }),
        }
    }

    /// Begins with the tokens that stand before all that is said.
    pub(crate) fn begin(&mut self, encoded: Encoded, before: &[i64]) -> ort::Result<Steps<'_>> {
        let layers = self.own.len();
        let memory =
            Memory { own: vec![Vec::new(); layers], sound: vec![Vec::new(); layers], length: 0, sound_length: 0 };
        let mut steps = Steps { decoder: self, encoded, memory, logits: Vec::new(), tokens: 0, places: 0 };
        steps.run(before, 1)?;
        Ok(steps)
    }
}

impl Encoded {
    /// What an encoder gives, `[1, length, features]`, of so many samples.
    pub(crate) fn of(value: &DynValue, samples: usize) -> ort::Result<Self> {
        let (shape, values) = value.try_extract_tensor::<f32>()?;
        let [1, length, features] = shape[..] else {
            return Err(ort::Error::new(format!("the encoder gives {shape:?}")));
        };
        Ok(Self { values: values.to_vec(), length: length as usize, features: features as usize, samples })
    }
}

impl Steps<'_> {
    /// Each row goes on with a token.
    pub(crate) fn step(&mut self, tokens: &[i64]) -> ort::Result<()> {
        self.run(tokens, tokens.len())
    }

    /// What comes next: for each row the logits of all tokens.
    pub(crate) fn rows(&self) -> impl Iterator<Item = &[f32]> {
        self.logits.chunks_exact(self.tokens * self.places).map(|row| &row[(self.places - 1) * self.tokens..])
    }

    /// How many tokens there are.
    pub(crate) fn tokens(&self) -> usize {
        self.tokens
    }

    /// After the first step: the logits of what comes after the first token of those that it began with.
    pub(crate) fn after_first(&self) -> &[f32] {
        &self.logits[..self.tokens]
    }

    /// Tries whether rows can look at one sound, with two that go on with these tokens. Of some exports they cannot: that
    /// fails, or gives something else.
    pub(crate) fn try_sharing(mut self, tokens: [i64; 2]) -> ort::Result<()> {
        self.widen(2);
        self.gather(&[0, 0]);
        let (own, length) = (self.memory.own.clone(), self.memory.length);
        self.step(&tokens)?;
        let expected = std::mem::take(&mut self.logits);
        (self.memory.own, self.memory.length, self.decoder.shares_sound) = (own, length, true);
        let is_same = self.step(&tokens).is_ok()
            && expected.len() == self.logits.len()
            && expected.iter().zip(&self.logits).all(|(one, other)| (one - other).abs() < ALIKE);
        self.decoder.shares_sound = is_same;
        Ok(())
    }

    /// Makes room for more rows, alike in what they know of the sound.
    pub(crate) fn widen(&mut self, rows: usize) {
        if self.decoder.shares_sound {
            return;
        }
        self.encoded.values = self.encoded.values.repeat(rows);
        self.memory.sound.iter_mut().for_each(|kept| *kept = kept.repeat(rows));
    }

    /// The rows become those that they go on from.
    pub(crate) fn gather(&mut self, from: &[usize]) {
        let row = self.decoder.heads * self.memory.length * self.decoder.width;
        for kept in &mut self.memory.own {
            *kept = from.iter().flat_map(|from| &kept[from * row..(from + 1) * row]).copied().collect();
        }
    }

    /// Each of the rows goes on with as many tokens.
    fn run(&mut self, tokens: &[i64], rows: usize) -> ort::Result<()> {
        let Self { decoder, memory, encoded, .. } = self;
        let (places, is_first) = (tokens.len() / rows, memory.length == 0);
        let (heads, width) = (decoder.heads, decoder.width);
        let looking = if decoder.shares_sound { 1 } else { rows };
        let at: Vec<i64> = (0..places).map(|place| (memory.length + place) as i64).collect();
        let mut inputs: Vec<(&str, SessionInputValue<'_>)> = vec![
            ("input_ids", Tensor::from_array(([rows, places], tokens.to_vec()))?.into()),
            (
                "encoder_hidden_states",
                TensorRef::from_array_view((
                    [looking, encoded.length, encoded.features],
                    &encoded.values[..looking * encoded.length * encoded.features],
                ))?
                .into(),
            ),
            (
                "encoder_attention_mask",
                Tensor::from_array(([rows, encoded.samples], vec![1i64; rows * encoded.samples]))?.into(),
            ),
            ("cache_position", Tensor::from_array(([places], at))?.into()),
            ("use_cache_branch", Tensor::from_array(([1], vec![!is_first]))?.into()),
        ];
        for ([name, _], kept) in decoder.own.iter().zip(&memory.own) {
            inputs.push((name, TensorRef::from_array_view(([rows, heads, memory.length, width], &kept[..]))?.into()));
        }
        for ([name, _], kept) in decoder.sound.iter().zip(&memory.sound) {
            let used = &kept[..looking * heads * memory.sound_length * width];
            let shape = [looking, heads, memory.sound_length, width];
            inputs.push((name, TensorRef::from_array_view((shape, used))?.into()));
        }
        let known: Vec<&str> = decoder.session.inputs().iter().map(|input| input.name()).collect();
        inputs.retain(|(name, _)| known.contains(name));
        let outputs = decoder.session.run(inputs)?;
        let values = |name: &str| -> ort::Result<Vec<f32>> {
            let value: Option<&DynValue> = outputs.get(name);
            let value = value.ok_or_else(|| ort::Error::new(format!("the decoder gives no {name}")))?;
            Ok(value.try_extract_tensor::<f32>()?.1.to_vec())
        };
        let logits = values("logits")?;
        let own = decoder.own.iter().map(|[_, name]| values(name)).collect::<ort::Result<Vec<_>>>()?;
        if is_first {
            memory.sound = decoder.sound.iter().map(|[_, name]| values(name)).collect::<ort::Result<_>>()?;
            memory.sound_length = memory.sound.first().map_or(0, |kept| kept.len() / (heads * width));
        }
        memory.own = own;
        memory.length += places;
        (self.tokens, self.places) = (logits.len() / (rows * places), places);
        self.logits = logits;
        Ok(())
    }
}
