//! What people say to a robot, in; what it means in plain requests, out (utterance rewriting).
//!
//! Pure: no I/O, no clock, no randomness, and the same bits on every machine. Of the world it knows what a few lines of text say. A language model of
//! some hundred million parameters (SmolLM2-135M, fitted to labelled dialogs by `train/fit.py`) reads what is around the robot, the lines before an
//! utterance, and the utterance. It resolves `it` and `the other one`, says things by their usual names, and leaves out remarks and reasons.
//!
//! ```
//! let rewritings = cohabit_rewriter::builtin().rewrite("pick up the mug", &[], "");
//! assert_eq!(rewritings[0].text, "pick up the mug");
//! ```

mod matrix;
mod read_before;
mod sums;
mod tensors;
mod tokens;
mod transformer;

use std::sync::{Arc, LazyLock};

use crate::{
    read_before::ReadBefore,
    tensors::Tensors,
    tokens::{Token, Tokens},
    transformer::{Memory, Transformer},
};

static MODEL: &[u8] = include_bytes!("../rewriter.safetensors");
/// What is added to it for people at home.
static HOUSEHOLD: &[u8] = include_bytes!("../household.safetensors");

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
}

/// The rewriter that comes with the project; it takes some tenths of a second to load, once.
///
/// # Panics
/// Never: its model is checked by a test.
#[must_use]
pub fn builtin() -> &'static Rewriter {
    static BUILTIN: LazyLock<Rewriter> = LazyLock::new(|| {
        Rewriter::new(MODEL).unwrap_or_else(|error| panic!("dialog/rewriter/rewriter.safetensors: {error}"))
    });
    &BUILTIN
}

/// The same, adapted to how people at home speak.
///
/// # Panics
/// Never: its adapter is checked by a test.
#[must_use]
pub fn household() -> &'static Rewriter {
    static ADAPTED: LazyLock<Rewriter> = LazyLock::new(|| {
        Rewriter::adapted(MODEL, HOUSEHOLD)
            .unwrap_or_else(|error| panic!("dialog/rewriter/household.safetensors: {error}"))
    });
    &ADAPTED
}

/// What an utterance may mean, as the rewriter that comes with the project has it: plain requests with their probabilities, best first. Behind
/// `social` stands of what kind the talk is, where that is known: `social: thanks`.
#[must_use]
pub fn rewrite(utterance: &str, before: &[Line], around: &str) -> Vec<(String, f32)> {
    builtin().meanings(utterance, before, around)
}

/// The same of what somebody says at home.
#[must_use]
pub fn rewrite_at_home(utterance: &str, before: &[Line], around: &str) -> Vec<(String, f32)> {
    household().meanings(utterance, before, around)
}

/// The most tokens that are read of what is around the robot, the last ones.
const MOST_AROUND: usize = 260;
/// The most lines before the utterance that are read, the words of one, the tokens of all, and those of the utterance.
const MOST_LINES: usize = 4;
const MOST_LINE_WORDS: usize = 30;
const MOST_CONTEXT: usize = 110;
const MOST_READ: usize = 150;
/// The most tokens that are written.
const MOST_WRITTEN: usize = 70;
/// How many ways to go on are followed at once.
const BEAM: usize = 6;
/// Ways this much less likely than the best are given up.
const LEAST_LOG_RATIO: f32 = -4.0;

/// What stands before a line of the robot, before one of the person, before the utterance, where the requests begin, in plain words or in the
/// person's own, and before what is around.
const MARKS: usize = 6;
const ROBOT: usize = 0;
const PERSON: usize = 1;
const NOW: usize = 2;
const REQUESTS: usize = 3;
const OWN_WORDS: usize = 4;
const AROUND: usize = 5;
/// Talk that asks for nothing.
const TALK: &str = "social";

/// A line of the dialog: whether the robot said it, and what.
pub type Line = (bool, String);

/// Plain requests that an utterance may mean.
#[derive(Clone, Debug, PartialEq)]
pub struct Rewriting {
    /// The requests, in the order in which they are to be done, with `; ` between them; `social` for talk that asks for nothing, `none` for what
    /// is nothing to a robot, `?` for what nobody could tell.
    pub text: String,
    /// How likely this is what is meant, by the model: 0 to 1.
    pub probability: f32,
}

/// Rewrites utterances as plain requests.
#[derive(Debug)]
pub struct Rewriter {
    network: Transformer,
    tokens: Tokens,
    /// What was read of earlier prompts: much of the next one is the same.
    read_before: ReadBefore,
}

impl Rewriter {
    /// With the weights of a safetensors file that `train/fit.py` has written.
    ///
    /// # Errors
    /// What is wrong with the file.
    pub fn new(model: &[u8]) -> Result<Self, ModelError> {
        Self::of(&Tensors::new(model)?)
    }

    /// With the weights of such a file, changed by an adapter that `train/adapt.py` has written.
    ///
    /// # Errors
    /// What is wrong with one of the files.
    pub fn adapted(model: &[u8], adapter: &[u8]) -> Result<Self, ModelError> {
        Self::of(&Tensors::new(model)?.adapted(adapter)?)
    }

    fn of(tensors: &Tensors<'_>) -> Result<Self, ModelError> {
        let tokens = Tokens::new(tensors.note("tokens")?);
        let network = Transformer::new(tensors)?;
        if network.tokens() != tokens.len() || network.marks() < MARKS {
            return Err(ModelError::Shape("tokens".to_owned()));
        }
        Ok(Self { network, tokens, read_before: ReadBefore::default() })
    }

    fn meanings(&self, utterance: &str, before: &[Line], around: &str) -> Vec<(String, f32)> {
        let rewritings = self.rewrite(utterance, before, around).into_iter();
        let told = |text: String| if text == TALK { self.talk_kind(utterance, before).unwrap_or(text) } else { text };
        rewritings.map(|rewriting| (told(rewriting.text), rewriting.probability)).collect()
    }

    /// The likeliest meanings of an utterance, best first, given the lines of the dialog before it, the latest last, and what is around the robot, which
    /// may be empty, such as `break room with sink, 6 stool; main office: hammer; counter top: banana, dirty plate; open fridge; in my hand mug`.
    ///
    /// Any text is taken; of a long one the first 150 tokens are read. There is none of a text without any word.
    #[must_use]
    pub fn rewrite(&self, utterance: &str, before: &[Line], around: &str) -> Vec<Rewriting> {
        self.written(utterance, before, around, REQUESTS)
    }

    /// Of what kind talk is that asks for nothing, as `social: praise`: thanks, praise, greeting, bye, apology, complaint, agreement or small talk.
    #[must_use]
    pub fn talk_kind(&self, utterance: &str, before: &[Line]) -> Option<String> {
        let written = self.written(utterance, before, "", OWN_WORDS).into_iter();
        let first = written.filter_map(|one| one.text.split("; ").next().map(str::to_owned)).next()?;
        first.starts_with(TALK).then_some(first)
    }

    /// What is written behind a mark, the likeliest first.
    fn written(&self, utterance: &str, before: &[Line], around: &str, mark: usize) -> Vec<Rewriting> {
        let said = self.tokens.of(utterance);
        if said.is_empty() {
            return Vec::new();
        }
        let mut read = self.surroundings(around);
        read.extend(self.context(before));
        read.push(Token::Mark(NOW));
        read.extend(said.into_iter().take(MOST_READ).map(Token::Text));
        read.push(Token::Mark(mark));
        let mut rewritings: Vec<Rewriting> = self.search(&read).into_iter().map(|way| self.rewriting(&way)).collect();
        rewritings.retain(|rewriting| !rewriting.text.is_empty());
        rewritings
    }

    fn surroundings(&self, around: &str) -> Vec<Token> {
        let mut tokens = self.tokens.of(around);
        if tokens.is_empty() {
            return Vec::new();
        }
        let last = tokens.split_off(tokens.len().saturating_sub(MOST_AROUND));
        std::iter::once(Token::Mark(AROUND)).chain(last.into_iter().map(Token::Text)).collect()
    }

    /// The last lines before an utterance.
    fn context(&self, before: &[Line]) -> Vec<Token> {
        let mut tokens = Vec::new();
        for (by_robot, text) in &before[before.len().saturating_sub(MOST_LINES)..] {
            let words: Vec<&str> = text.split_whitespace().take(MOST_LINE_WORDS).collect();
            tokens.push(Token::Mark(if *by_robot { ROBOT } else { PERSON }));
            tokens.extend(self.tokens.of(&words.join(" ")).into_iter().map(Token::Text));
        }
        tokens.split_off(tokens.len().saturating_sub(MOST_CONTEXT))
    }

    fn rewriting(&self, way: &Way) -> Rewriting {
        Rewriting { text: self.tokens.text(&way.tokens), probability: libm::expf(way.log_probability) }
    }

    /// The likeliest ways to go on from what was read, best first.
    fn search(&self, read: &[Token]) -> Vec<Way> {
        let known = self.read_before.of(read);
        let mut prompt = [known.unwrap_or_else(|| self.network.begin())];
        let rest = &read[prompt[0].length()..];
        let scores = self.network.next(rest, &vec![0; rest.len()], &mut prompt, &Memory::default());
        let [prompt] = prompt;
        let prompt = Arc::new(prompt);
        self.read_before.keep(read, &prompt);
        let start = Way { tokens: Vec::new(), log_probability: 0.0 };
        let mut finished: Vec<Way> = Vec::new();
        let mut live = self.followed(&[start], &scores, &mut finished);
        let mut memories: Vec<Memory> = live.iter().map(|_| self.network.begin()).collect();
        for _ in 1..MOST_WRITTEN {
            let best = finished.first().map_or(f32::NEG_INFINITY, |way| way.log_probability);
            // The likeliest stand first, so that the last ones go.
            live.retain(|(_, way)| way.log_probability > best + LEAST_LOG_RATIO);
            if live.is_empty() || finished.len() >= BEAM {
                break;
            }
            let last: Vec<Token> =
                live.iter().filter_map(|(_, way)| way.tokens.last().copied().map(Token::Text)).collect();
            memories.truncate(live.len());
            let owners: Vec<usize> = (0..live.len()).collect();
            let scores = self.network.next(&last, &owners, &mut memories, &prompt);
            let ways: Vec<Way> = live.into_iter().map(|(_, way)| way).collect();
            live = self.followed(&ways, &scores, &mut finished);
            memories = live.iter().map(|(from, _)| memories[*from].clone()).collect();
        }
        finished
    }

    /// The likeliest ways that are one token longer, each with the place of that which it goes on from; those that end are finished.
    fn followed(&self, ways: &[Way], scores: &[f32], finished: &mut Vec<Way>) -> Vec<(usize, Way)> {
        let mut next: Vec<(usize, usize, f32)> = Vec::new();
        for (from, (way, scores)) in ways.iter().zip(scores.chunks_exact(self.network.tokens())).enumerate() {
            let likeliest = likeliest(scores, BEAM).into_iter();
            next.extend(likeliest.map(|(token, log)| (from, token, way.log_probability + log)));
        }
        next.sort_by(|one, other| other.2.total_cmp(&one.2));
        let best = next.first().map_or(0.0, |(_, _, log)| *log);
        next.retain(|(_, _, log)| *log > best + LEAST_LOG_RATIO);
        next.truncate(BEAM);
        let mut live = Vec::new();
        for (from, token, log_probability) in next {
            let mut tokens = ways[from].tokens.clone();
            if token == tokens::END {
                finished.push(Way { tokens, log_probability });
            } else {
                tokens.push(token);
                live.push((from, Way { tokens, log_probability }));
            }
        }
        finished.sort_by(|one, other| other.log_probability.total_cmp(&one.log_probability));
        live
    }
}

/// What may be written, and the logarithm of its probability.
#[derive(Clone, Debug)]
struct Way {
    tokens: Vec<usize>,
    log_probability: f32,
}

/// The likeliest tokens with the logarithms of their probabilities.
fn likeliest(scores: &[f32], count: usize) -> Vec<(usize, f32)> {
    /// What is this much less likely than the likeliest counts for nothing.
    const LEAST: f32 = -16.0;
    let largest = scores.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let mut total = 0.0;
    let mut found: Vec<(usize, f32)> = Vec::new();
    for (token, score) in scores.iter().enumerate().filter(|(_, score)| **score - largest > LEAST) {
        total += libm::expf(score - largest);
        found.push((token, *score));
    }
    found.sort_by(|one, other| other.1.total_cmp(&one.1));
    found.truncate(count);
    let normaliser = largest + libm::logf(total);
    found.into_iter().map(|(token, score)| (token, score - normaliser)).collect()
}
