//! What people say, in; what they ask for, as typed requests with probabilities, out.
//!
//! Pure: no I/O, no clock, no randomness, and the same bits on every machine. It knows nothing of the world: descriptions of things
//! stay the person's own words. A small network reads the utterance and the lines before it, and *marks*: it writes acts, forms and
//! relations of a closed alphabet, and points to the words of their descriptions; a grammar keeps what it writes whole.
//! Its weights are fitted to the corpus in `dialog/parser/corpus` by `dialog/parser/train`.
//!
//! ```
//! use cohabit_parser::Parser;
//!
//! let readings = Parser::builtin().parse("could you pick up the red mug, please?", &[]);
//! assert_eq!(readings[0].requests[0].to_string(), "pick up the red mug");
//! ```

mod assemble;
pub mod corpus;
mod encoder;
mod grammar;
mod layers;
mod matrix;
mod meaning;
mod network;
pub mod request;
mod reranker;
mod rewriter;
mod search;
mod source;
mod symbol;
mod tensors;
mod words;

use std::sync::LazyLock;

pub use crate::{
    meaning::{Direction, Directions, Meaning, NUMBERS},
    reranker::Reranker,
    rewriter::{Rewriter, Rewriting},
};
use crate::{network::Network, request::Request, source::Source, symbol::Symbol, tensors::Tensors, words::Vocabulary};

/// A line of the dialog before an utterance.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Said<'a> {
    /// Whether the robot said it.
    pub by_robot: bool,
    /// What was said.
    pub text: &'a str,
}

/// One way to understand an utterance.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// What is asked for, in the order in which it is to be done; never empty.
    pub requests: Vec<Request>,
    /// How likely this is what is meant, by the network: 0 to 1.
    pub probability: f32,
}

/// Why a model cannot be used.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
pub enum ModelError {
    /// It is no file of tensors.
    #[error("the model is no safetensors file: {0}")]
    File(String),
    /// A tensor or a note is not there.
    #[error("the model lacks `{0}`")]
    Missing(String),
    /// A tensor has another type or size than it must have.
    #[error("`{0}` of the model has a wrong type or shape")]
    Shape(String),
    /// A symbol has no meaning.
    #[error("`{0}` is no symbol that the parser knows")]
    Symbol(String),
}

/// How many ways to go on are followed at once.
const BEAM: usize = 4;

static MODEL: &[u8] = include_bytes!("../model/parser.safetensors");
static VOCABULARY: &str = include_str!("../model/vocabulary.txt");

/// Understands utterances.
#[derive(Debug)]
pub struct Parser {
    network: Network,
    vocabulary: Vocabulary,
    alphabet: Vec<Symbol>,
}

impl Parser {
    /// The parser that comes with the crate; it takes some ten milliseconds to load, once.
    ///
    /// # Panics
    /// Never: its model is checked by a test.
    #[must_use]
    pub fn builtin() -> &'static Self {
        static BUILTIN: LazyLock<Parser> = LazyLock::new(|| {
            Parser::new(MODEL).unwrap_or_else(|error| panic!("dialog/parser/model/parser.safetensors: {error}"))
        });
        &BUILTIN
    }

    /// With the weights of a safetensors file that `dialog/parser/train` has written.
    ///
    /// # Errors
    /// What is wrong with the file.
    pub fn new(model: &[u8]) -> Result<Self, ModelError> {
        let tensors = Tensors::new(model)?;
        let symbol = |name: &str| Symbol::parse(name).ok_or_else(|| ModelError::Symbol(name.to_owned()));
        let alphabet: Vec<Symbol> = tensors.note("symbols")?.lines().map(symbol).collect::<Result<_, _>>()?;
        let (network, vocabulary) = (Network::new(&tensors)?, Vocabulary::new(VOCABULARY));
        if network.symbols() != alphabet.len() {
            return Err(ModelError::Shape("symbols".to_owned()));
        }
        if network.pieces() != vocabulary.len() {
            return Err(ModelError::Shape("words".to_owned()));
        }
        Ok(Self { network, vocabulary, alphabet })
    }

    /// Whether a word is one of those that the network met as a whole, in all that its encoder was trained on.
    #[must_use]
    pub fn knows(&self, word: &str) -> bool {
        self.vocabulary.pieces(word).len() == 1
    }

    /// The likeliest ways to understand an utterance, best first, given the lines of the dialog before it, the latest last.
    ///
    /// Any text is taken. An utterance of more than 120 words, or without any, is not read: there is no reading of it.
    #[must_use]
    pub fn parse(&self, utterance: &str, before: &[Said<'_>]) -> Vec<Reading> {
        let Some(source) = Source::new(&self.vocabulary, utterance, before) else { return Vec::new() };
        let memory = self.network.encode(&source);
        let outputs = search::search(&self.network, &memory, &self.alphabet, BEAM);
        let readings = outputs.into_iter().filter_map(|output| {
            let requests = assemble::requests(&output.letters, &self.alphabet, &source)?;
            Some(Reading { requests, probability: libm::expf(output.log_probability) })
        });
        readings.collect()
    }
}
