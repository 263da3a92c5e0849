//! Recognition by a Moonshine model (MIT): an encoder, a decoder that spells one token after the other, and a table of tokens.
//!
//! What was heard is spelt twice in one batch: greedily, and by a beam that a language model of what is likely has a say in
//! (`score = ln p(sound) + λ ln p(words)`). The [gate](crate::gate) chooses.

use std::path::{Path, PathBuf};

use ort::{
    session::{Session, SessionInputValue},
    value::{DynValue, Tensor, TensorRef, ValueType},
};

use crate::{
    Bias, Hypothesis, RATE, Recognition, Recognizer, SpeechError,
    audio::tame,
    bias,
    engines::file,
    gate::{self, Heard},
    ngram::{NGram, Place},
    onnx,
    tokens::{BEGIN, END, Tokens},
};

/// The model's folder, within the data folder.
pub(crate) const FOLDER: &str = "moonshine";
pub(crate) const TOKENS: &str = "tokenizer.bin";

const NAME: &str = "Moonshine";
/// Shorter sounds are filled up with silence: the model makes nothing of them otherwise.
const SHORTEST: usize = RATE as usize / 2;
/// Longer ones are parted, where they are quietest.
const LONGEST: usize = 30 * RATE as usize;
/// The model repeats itself where it is lost; nobody says more tokens a second than this.
const TOKENS_EACH_SECOND: f32 = 6.5;
/// How many spellings are followed at once, and how many tokens each may go on with.
const BEAM: usize = 5;
const BRANCHES: usize = 16;
/// What is longer is no request, and spelt greedily alone: a beam takes six times as long.
const REQUEST: usize = 12 * RATE as usize;
/// What fits the sound less well is listened to once more, with so much silence around it.
const CLEAR: f32 = 0.6;
const AROUND: usize = RATE as usize / 5;
/// How much say the language model has.
const LAMBDA: f32 = 0.35;

/// An opened model.
pub(crate) struct Moonshine {
    encoder: Session,
    decoder: Session,
    tokens: Tokens,
    /// Names of what the decoder remembers of its own words, and of the sound; for each the name it is given back by.
    own: Vec<[String; 2]>,
    sound: Vec<[String; 2]>,
    heads: usize,
    width: usize,
    model: Option<NGram>,
    name: String,
}

/// One way to spell what was heard.
#[derive(Clone, Debug)]
struct Spelling {
    tokens: Vec<i64>,
    /// Logarithm of how likely it is by the sound.
    by_sound: f32,
    place: Place,
    /// `by_sound` with the language model's say.
    score: f32,
    /// Which row of the batch it goes on from.
    row: usize,
}

/// What the decoder remembers for each row: `[rows, heads, length, width]` each.
struct Memory {
    own: Vec<Vec<f32>>,
    /// Alike in all rows, with as many of them as are ever needed.
    sound: Vec<Vec<f32>>,
    length: usize,
    sound_length: usize,
}

/// What an utterance was spelt as.
struct Spelt {
    greedy: Spelling,
    /// By the beam, the likeliest first.
    others: Vec<Spelling>,
}

impl Moonshine {
    /// Opens a folder with a Moonshine model; `library` is the runtime's.
    pub(crate) fn open(folder: &Path, library: &Path, threads: usize) -> Result<Self, SpeechError> {
        let [encoder, decoder] = [part(folder, "encoder_model")?, part(folder, "decoder_model_merged")?];
        let table = file(folder, TOKENS)?;
        onnx::load(library)?;
        let tokens = Tokens::open(&table)?;
        let (encoder, opened) = (onnx::open(&encoder, threads)?, onnx::open(&decoder, threads)?);
        let other = |why: String| SpeechError::Broken { remedy: onnx::remedy(&decoder), why, path: decoder.clone() };
        let names = |whose: &str| -> Vec<[String; 2]> {
            let inputs = opened.inputs().iter().map(|input| input.name());
            let remembered = inputs.filter(|name| name.starts_with("past_key_values") && name.contains(whose));
            remembered.map(|name| [name.to_owned(), name.replace("past_key_values", "present")]).collect()
        };
        let (own, sound) = (names(".decoder."), names(".encoder."));
        let shape = own.first().and_then(|[name, _]| shape(&opened, name));
        let Some([_, heads, _, width]) = shape.as_deref() else {
            return Err(other("it is no decoder of a Moonshine model".into()));
        };
        let (heads, width) = (*heads as usize, *width as usize);
        let name = format!("{NAME} ({})", folder.file_name().unwrap_or_default().to_string_lossy());
        let mut moonshine = Self { encoder, decoder: opened, tokens, own, sound, heads, width, model: None, name };
        // A model that is none is found out now, not when somebody speaks.
        moonshine.spell(&[0.0; SHORTEST], false).map_err(|error| other(format!("it cannot be run: {error}")))?;
        Ok(moonshine)
    }

    fn spell(&mut self, samples: &[f32], with_beam: bool) -> ort::Result<Spelt> {
        let mut sound: Vec<f32> = samples.iter().map(|sample| tame(*sample)).collect();
        sound.resize(sound.len().max(SHORTEST), 0.0);
        let most = (samples.len().max(SHORTEST) as f32 / RATE as f32 * TOKENS_EACH_SECOND).ceil() as usize;
        let mut steps = Steps::new(self, sound)?;
        steps.run(most, with_beam)
    }

    fn text(&self, spelling: &Spelling) -> String {
        self.tokens.text(&spelling.tokens)
    }

    /// What is said in a sound that is short enough. Where that is in doubt, it is listened to once more, with silence around it:
    /// the model is then lost at other places.
    fn listen(&mut self, samples: &[f32]) -> ort::Result<Recognition> {
        let is_short = self.model.is_some() && samples.len() <= REQUEST;
        let spelt = self.spell(samples, is_short)?;
        let heard = self.recognition(&spelt);
        let is_doubtful = |first: &Hypothesis| first.strange > 0 || first.confidence < CLEAR;
        if !is_short || !heard.hypotheses.first().is_some_and(is_doubtful) {
            return Ok(heard);
        }
        let spelt = self.spell(&[&[0.0; AROUND], samples, &[0.0; AROUND]].concat(), true)?;
        let again = self.recognition(&spelt);
        let hypotheses = ordered(heard.hypotheses.into_iter().chain(again.hypotheses));
        Ok(Recognition { hypotheses, ..heard })
    }

    fn recognition(&self, spelt: &Spelt) -> Recognition {
        let raw = self.text(&spelt.greedy);
        if bias::words(&raw).is_empty() {
            return Recognition::default();
        }
        let heard = Heard { text: &raw, by_sound: spelt.greedy.by_sound };
        let is_open =
            |(text, other): &(String, &Spelling)| gate::is_open(Heard { text, by_sound: other.by_sound }, heard);
        let others = spelt.others.iter().map(|other| (self.text(other), other)).filter(is_open);
        let readings = others.chain([(raw.clone(), &spelt.greedy)]).map(|(text, spelling)| Hypothesis {
            score: if self.model.is_some() { spelling.score } else { spelling.by_sound },
            confidence: spelling.each().exp(),
            strange: self.model.as_ref().map_or(0, |model| model.strange(&text)),
            // `break-room` is said like `break room`.
            text: text.replace('-', " "),
        });
        Recognition { hypotheses: ordered(readings), raw }
    }
}

/// Readings, the likeliest first; of those that differ in marks alone, the likeliest.
fn ordered(readings: impl Iterator<Item = Hypothesis>) -> Vec<Hypothesis> {
    let mut readings: Vec<Hypothesis> = readings.collect();
    readings.sort_by(|one, other| other.score.total_cmp(&one.score));
    let mut known: Vec<Vec<String>> = Vec::new();
    readings.retain(|reading| {
        let words = bias::words(&reading.text);
        let is_new = !known.contains(&words);
        known.push(words);
        is_new
    });
    readings
}

impl Spelling {
    /// Whether it is at its end.
    fn is_done(&self) -> bool {
        self.tokens.last() == Some(&END)
    }

    /// Logarithm of how likely a token of it is by the sound.
    fn each(&self) -> f32 {
        self.by_sound / self.tokens.len().max(1) as f32
    }
}

impl Recognizer for Moonshine {
    fn bias(&mut self, bias: &Bias) {
        self.model = NGram::of(bias);
    }

    fn recognize(&mut self, samples: &[f32]) -> Result<Recognition, SpeechError> {
        let mut parts = Vec::new();
        for part in parted(samples) {
            parts.push(self.listen(part).map_err(failed)?);
        }
        Ok(joined(parts))
    }

    fn partial(&mut self, samples: &[f32]) -> Result<Option<String>, SpeechError> {
        let part = &samples[samples.len().saturating_sub(LONGEST)..];
        let spelt = self.spell(part, false).map_err(failed)?;
        Ok(Some(self.text(&spelt.greedy)))
    }

    fn name(&self) -> &str {
        &self.name
    }
}

fn failed(error: ort::Error) -> SpeechError {
    SpeechError::Engine { engine: NAME, why: error.to_string() }
}

/// A part of the model, as `.ort` or `.onnx`.
fn part(folder: &Path, name: &str) -> Result<PathBuf, SpeechError> {
    file(folder, &format!("{name}.onnx")).or_else(|_| file(folder, &format!("{name}.ort")))
}

fn shape(session: &Session, input: &str) -> Option<Vec<i64>> {
    let input = session.inputs().iter().find(|other| other.name() == input)?;
    match input.dtype() {
        ValueType::Tensor { shape, .. } => Some(shape.to_vec()),
        _ => None,
    }
}

/// Parts of a long sound that are short enough, cut where it is quietest in the last third of each.
fn parted(samples: &[f32]) -> Vec<&[f32]> {
    const WINDOW: usize = RATE as usize / 10;
    let (mut parts, mut rest) = (Vec::new(), samples);
    while rest.len() > LONGEST {
        let loudness = |at: &usize| {
            let loud: f32 = rest[*at..*at + WINDOW].iter().map(|sample| tame(*sample).abs()).sum();
            (loud * 1e3) as u64
        };
        let quietest = (LONGEST * 2 / 3..LONGEST - WINDOW).step_by(WINDOW).min_by_key(loudness);
        let (part, behind) = rest.split_at(quietest.unwrap_or(LONGEST) + WINDOW / 2);
        parts.push(part);
        rest = behind;
    }
    if !rest.is_empty() {
        parts.push(rest);
    }
    parts
}

/// What was heard in parts, as one.
fn joined(mut parts: Vec<Recognition>) -> Recognition {
    if parts.len() <= 1 {
        return parts.pop().unwrap_or_default();
    }
    let text = |of: &dyn Fn(&Recognition) -> String| {
        parts.iter().map(of).filter(|text| !text.is_empty()).collect::<Vec<_>>().join(" ")
    };
    let (best, raw) = (text(&|part| part.best().to_owned()), text(&|part| part.raw.clone()));
    let confidence = parts.iter().map(Recognition::confidence).fold(1.0, f32::min);
    let strange = parts.iter().filter_map(|part| part.hypotheses.first()).map(|first| first.strange).sum();
    let mut whole = Recognition { raw, ..Recognition::trusted(best, confidence) };
    whole.hypotheses.iter_mut().for_each(|reading| reading.strange = strange);
    whole
}

/// The decoder at work on one utterance.
struct Steps<'m> {
    moonshine: &'m mut Moonshine,
    /// What the encoder made of the sound, for as many rows as are ever needed: `[rows, length, features]`.
    encoded: Vec<f32>,
    encoded_length: usize,
    features: usize,
    /// How many samples there are.
    samples: usize,
    memory: Memory,
    /// Logits of the last step: `[rows, tokens]`.
    logits: Vec<f32>,
}

impl<'m> Steps<'m> {
    /// Encodes the sound, and takes the first step.
    fn new(moonshine: &'m mut Moonshine, sound: Vec<f32>) -> ort::Result<Self> {
        let samples = sound.len();
        let inputs: Vec<(&str, SessionInputValue<'_>)> = vec![
            ("input_values", Tensor::from_array(([1, samples], sound))?.into()),
            ("attention_mask", Tensor::from_array(([1, samples], vec![1i64; samples]))?.into()),
        ];
        let wanted = moonshine.encoder.inputs().len();
        let outputs = moonshine.encoder.run(inputs.into_iter().take(wanted).collect::<Vec<_>>())?;
        let (shape, encoded) = outputs[0].try_extract_tensor::<f32>()?;
        let [_, encoded_length, features] = shape[..] else {
            return Err(ort::Error::new(format!("the encoder gives {shape:?}")));
        };
        let (encoded, layers) = (encoded.to_vec(), moonshine.own.len());
        drop(outputs);
        let memory =
            Memory { own: vec![Vec::new(); layers], sound: vec![Vec::new(); layers], length: 0, sound_length: 0 };
        let (encoded_length, features) = (encoded_length as usize, features as usize);
        let mut steps = Self { moonshine, encoded, encoded_length, features, samples, memory, logits: Vec::new() };
        steps.step(&[BEGIN])?;
        Ok(steps)
    }

    /// Each row goes on with a token.
    fn step(&mut self, tokens: &[i64]) -> ort::Result<()> {
        let Self { moonshine, memory, .. } = self;
        let (rows, is_first) = (tokens.len(), memory.length == 0);
        let (heads, width) = (moonshine.heads, moonshine.width);
        let mask = vec![1i64; rows * self.samples];
        let mut inputs: Vec<(&str, SessionInputValue<'_>)> = vec![
            ("input_ids", Tensor::from_array(([rows, 1], tokens.to_vec()))?.into()),
            (
                "encoder_hidden_states",
                TensorRef::from_array_view((
                    [rows, self.encoded_length, self.features],
                    &self.encoded[..rows * self.encoded_length * self.features],
                ))?
                .into(),
            ),
            ("encoder_attention_mask", Tensor::from_array(([rows, self.samples], mask))?.into()),
            ("use_cache_branch", Tensor::from_array(([1], vec![!is_first]))?.into()),
        ];
        for ([name, _], kept) in moonshine.own.iter().zip(&memory.own) {
            inputs.push((name, TensorRef::from_array_view(([rows, heads, memory.length, width], &kept[..]))?.into()));
        }
        for ([name, _], kept) in moonshine.sound.iter().zip(&memory.sound) {
            let used = &kept[..rows * heads * memory.sound_length * width];
            inputs.push((name, TensorRef::from_array_view(([rows, heads, memory.sound_length, width], used))?.into()));
        }
        let known: Vec<&str> = moonshine.decoder.inputs().iter().map(|input| input.name()).collect();
        inputs.retain(|(name, _)| known.contains(name));
        let outputs = moonshine.decoder.run(inputs)?;
        let values = |name: &str| -> ort::Result<Vec<f32>> {
            let value: Option<&DynValue> = outputs.get(name);
            let value = value.ok_or_else(|| ort::Error::new(format!("the decoder gives no {name}")))?;
            Ok(value.try_extract_tensor::<f32>()?.1.to_vec())
        };
        let logits = values("logits")?;
        let own = moonshine.own.iter().map(|[_, name]| values(name)).collect::<ort::Result<Vec<_>>>()?;
        if is_first {
            memory.sound = moonshine.sound.iter().map(|[_, name]| values(name)).collect::<ort::Result<_>>()?;
            memory.sound_length = memory.sound.first().map_or(0, |kept| kept.len() / (heads * width));
        }
        memory.own = own;
        memory.length += 1;
        self.logits = logits;
        if self.logits.len() != rows * moonshine.tokens.len() {
            return Err(ort::Error::new("the decoder's tokens are not those of the table"));
        }
        Ok(())
    }

    /// Makes room for more rows, alike in what they know of the sound.
    fn widen(&mut self, rows: usize) {
        self.encoded = self.encoded.repeat(rows);
        self.memory.sound.iter_mut().for_each(|kept| *kept = kept.repeat(rows));
    }

    /// The rows become those that they go on from.
    fn gather(&mut self, from: &[usize]) {
        let row = self.moonshine.heads * self.memory.length * self.moonshine.width;
        for kept in &mut self.memory.own {
            *kept = from.iter().flat_map(|from| &kept[from * row..(from + 1) * row]).copied().collect();
        }
    }

    fn run(&mut self, most: usize, with_beam: bool) -> ort::Result<Spelt> {
        let first = Spelling { tokens: Vec::new(), by_sound: 0.0, place: Place::default(), score: 0.0, row: 0 };
        let mut greedy = first.clone();
        let mut beam = if with_beam { vec![first] } else { Vec::new() };
        let mut done: Vec<Spelling> = Vec::new();
        self.widen(if with_beam { BEAM + 1 } else { 1 });
        let mut is_greedy_done = false;
        for step in 0..most {
            let rows = self.likely();
            if !is_greedy_done {
                let (token, chance) = rows[greedy.row][0];
                greedy.by_sound += chance;
                greedy.tokens.push(token);
                if let Some(model) = &self.moonshine.model {
                    self.judge(model, &mut greedy);
                }
                is_greedy_done = token == END;
            }
            beam = self.branch(&beam, &rows, &mut done);
            let best = done.iter().map(|spelling| spelling.score).fold(f32::NEG_INFINITY, f32::max);
            // Going on never makes a spelling likelier.
            beam.retain(|spelling| spelling.score > best);
            if step + 1 == most || (is_greedy_done && beam.is_empty()) {
                break;
            }
            let greedy_row = (!is_greedy_done).then_some(greedy.row);
            let from: Vec<usize> = greedy_row.into_iter().chain(beam.iter().map(|spelling| spelling.row)).collect();
            self.gather(&from);
            greedy.row = 0;
            let before = from.len() - beam.len();
            beam.iter_mut().enumerate().for_each(|(at, spelling)| spelling.row = before + at);
            let last = |spelling: &Spelling| spelling.tokens.last().copied().unwrap_or(BEGIN);
            let greedy_token = greedy_row.map(|_| last(&greedy));
            let tokens: Vec<i64> = greedy_token.into_iter().chain(beam.iter().map(last)).collect();
            self.step(&tokens)?;
        }
        done.extend(beam);
        done.sort_by(|one, other| other.score.total_cmp(&one.score));
        Ok(Spelt { greedy, others: done })
    }

    /// The likeliest tokens of each row, with the logarithms of their chances.
    fn likely(&self) -> Vec<Vec<(i64, f32)>> {
        self.logits.chunks_exact(self.moonshine.tokens.len()).map(likeliest).collect()
    }

    /// Whether a spelling of the beam may go on with a token.
    fn may_follow(&self, token: i64) -> bool {
        token == END || self.moonshine.tokens.get(token).is_some_and(|spelt| spelt.is_plain)
    }

    /// What the language model has to say about the last token.
    fn judge(&self, model: &NGram, spelling: &mut Spelling) {
        let Some(token) = spelling.tokens.last() else { return };
        let by_model = if *token == END {
            model.end(&mut spelling.place)
        } else {
            let spelt = self.moonshine.tokens.get(*token).expect("invariant: as many logits as tokens");
            model.spell(&mut spelling.place, spelt.begins_word, &spelt.letters, spelt.ends_word);
            model.so_far(&spelling.place)
        };
        spelling.score = spelling.by_sound + LAMBDA * by_model;
    }

    /// The best spellings that go on from those of the beam; what ends goes to those that are done.
    fn branch(&self, beam: &[Spelling], rows: &[Vec<(i64, f32)>], done: &mut Vec<Spelling>) -> Vec<Spelling> {
        let Some(model) = &self.moonshine.model else { return Vec::new() };
        let mut next: Vec<Spelling> = Vec::new();
        for spelling in beam {
            for (token, chance) in &rows[spelling.row] {
                if !self.may_follow(*token) {
                    continue;
                }
                let mut longer = spelling.clone();
                longer.by_sound += chance;
                longer.tokens.push(*token);
                self.judge(model, &mut longer);
                next.push(longer);
            }
        }
        next.sort_by(|one, other| other.score.total_cmp(&one.score));
        // Those that differ in marks and capitals alone say the same: the likeliest stands for all.
        let mut said: Vec<(String, bool)> = Vec::with_capacity(BEAM);
        next.retain(|spelling| {
            let says = (spelling.place.words().to_owned(), spelling.is_done());
            let is_new = said.len() < BEAM && !said.contains(&says);
            if is_new {
                said.push(says);
            }
            is_new
        });
        let (ended, next) = next.into_iter().partition(Spelling::is_done);
        done.extend::<Vec<_>>(ended);
        next
    }
}

/// The likeliest tokens, the best first, with the logarithms of their chances.
fn likeliest(logits: &[f32]) -> Vec<(i64, f32)> {
    let highest = logits.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let total = highest + logits.iter().map(|logit| (logit - highest).exp()).sum::<f32>().ln();
    let mut best: Vec<(i64, f32)> = Vec::with_capacity(BRANCHES + 1);
    for (token, logit) in logits.iter().enumerate() {
        if best.len() == BRANCHES && best[BRANCHES - 1].1 >= *logit {
            continue;
        }
        let at = best.partition_point(|(_, other)| other >= logit);
        best.insert(at, (token as i64, *logit));
        best.truncate(BRANCHES);
    }
    best.iter().map(|(token, logit)| (*token, logit - total)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_likeliest_tokens_are_found() {
        let logits: Vec<f32> = (0..1_000).map(|at| ((at * 7_919) % 1_000) as f32 / 100.0).collect();
        let best = likeliest(&logits);
        assert_eq!(best.len(), BRANCHES);
        let mut expected: Vec<f32> = logits.clone();
        expected.sort_by(|one, other| other.total_cmp(one));
        for ((token, chance), logit) in best.iter().zip(expected) {
            assert_eq!(logits[*token as usize], logit);
            assert!(*chance < 0.0);
        }
        let total: f32 = likeliest(&[1.0, 2.0]).iter().map(|(_, chance)| chance.exp()).sum();
        assert!((total - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_long_sound_is_parted_where_it_is_quiet() {
        let mut sound = vec![0.5; 100 * RATE as usize];
        sound[25 * RATE as usize..26 * RATE as usize].fill(0.0);
        let parts = parted(&sound);
        assert!((parts[0].len() as f32 / RATE as f32 - 25.5).abs() < 0.6, "{}", parts[0].len());
        assert!(parts.iter().all(|part| part.len() <= LONGEST));
        assert_eq!(parts.iter().map(|part| part.len()).sum::<usize>(), sound.len());
        assert!(parted(&[]).is_empty());
    }

    #[test]
    fn what_was_heard_in_parts_is_one() {
        let parts = ["Open the", "", "fridge."].map(Recognition::sure).to_vec();
        let whole = joined(parts);
        assert_eq!(
            (whole.best(), whole.raw.as_str(), whole.confidence()),
            ("Open the fridge.", "Open the fridge.", 0.0)
        );
        assert_eq!(joined(Vec::new()), Recognition::default());
    }
}
