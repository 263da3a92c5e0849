//! How well something that the robot could do or say fits what was said: both are read together (a cross-encoder).

use std::sync::LazyLock;

use crate::{
    MODEL, ModelError, Said, VOCABULARY,
    encoder::{self, Encoder},
    matrix::Linear,
    source::{MOST_PIECES, Source},
    tensors::Tensors,
    words::{Vocabulary, words},
};

static RERANKER: &[u8] = include_bytes!("../model/reranker.safetensors");

/// The most pieces of a candidate that are read.
const MOST_CANDIDATE: usize = 70;
/// Who says a candidate, beside those of the [`Source`].
const CANDIDATE: u8 = 3;

/// Scores candidates for what an utterance means.
#[derive(Debug)]
pub struct Reranker {
    encoder: Encoder,
    score: Linear,
    vocabulary: Vocabulary,
}

impl Reranker {
    /// The model that comes with the crate; it takes some ten milliseconds to load, once.
    ///
    /// # Panics
    /// Never: its model is checked by a test.
    #[must_use]
    pub fn builtin() -> &'static Self {
        static BUILTIN: LazyLock<Reranker> = LazyLock::new(|| {
            Reranker::new(RERANKER, MODEL)
                .unwrap_or_else(|error| panic!("dialog/parser/model/reranker.safetensors: {error}"))
        });
        &BUILTIN
    }

    /// With the weights of a safetensors file that `dialog/parser/train` has written, and the embeddings of the parser's.
    fn new(model: &[u8], parser: &[u8]) -> Result<Self, ModelError> {
        let (tensors, words) = (Tensors::new(model)?, Tensors::new(parser)?);
        let (encoder, score) = (Encoder::new(&tensors, &words)?, tensors.linear("score")?);
        if score.outputs() != 1 {
            return Err(ModelError::Shape("score".to_owned()));
        }
        Ok(Self { encoder, score, vocabulary: Vocabulary::new(VOCABULARY) })
    }

    /// The score of each candidate, a text in plain words, given the lines of the dialog before, the latest last: the logarithm of how much
    /// likelier it is what is meant than that none of them is. All are 0 for an utterance that is too long to be read.
    #[must_use]
    pub fn scores(&self, utterance: &str, before: &[Said<'_>], candidates: &[&str]) -> Vec<f32> {
        let Some(source) = Source::new(&self.vocabulary, utterance, before) else { return vec![0.0; candidates.len()] };
        candidates.iter().map(|candidate| self.score(&source, candidate)).collect()
    }

    fn score(&self, source: &Source<'_>, candidate: &str) -> f32 {
        let told = words(candidate).into_iter().flat_map(|word| self.vocabulary.pieces(&candidate[word]));
        let mut last = vec![self.vocabulary.piece("[SEP]")];
        last.extend(told.take(MOST_CANDIDATE));
        let keep = source.pieces.len().min(MOST_PIECES - last.len());
        let pieces = [&source.pieces[..keep], &last].concat();
        let speakers = [&source.speakers[..keep], &vec![CANDIDATE; last.len()]].concat();
        self.score.apply(&encoder::mean(&self.encoder.read(&pieces, &speakers)))[0]
    }
}
