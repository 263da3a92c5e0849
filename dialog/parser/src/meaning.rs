//! What texts mean, as directions in a space: texts that mean much the same point the same way.

use std::{collections::HashMap, sync::LazyLock};

use safetensors::{Dtype, tensor::TensorView};

use crate::{
    MODEL, ModelError, VOCABULARY,
    encoder::{self, Encoder, WIDTH},
    tensors::Tensors,
    words::{Vocabulary, words},
};

static MEANING: &[u8] = include_bytes!("../model/meaning.safetensors");

/// The most words of a text that are read.
const MOST_WORDS: usize = 60;

/// Numbers of a [`Direction`].
pub const NUMBERS: usize = WIDTH;

/// The direction of a text.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Direction {
    numbers: Vec<i8>,
}

impl Direction {
    /// Of [`NUMBERS`] whole numbers, as [`Self::numbers`] gives them.
    ///
    /// # Errors
    /// Where there are more or fewer.
    pub fn from_numbers(numbers: &[i8]) -> Result<Self, ModelError> {
        let numbers = numbers.to_vec();
        if numbers.len() == NUMBERS { Ok(Self { numbers }) } else { Err(ModelError::Shape("direction".to_owned())) }
    }

    /// Its numbers, the largest of them 127 or -127.
    #[must_use]
    pub fn numbers(&self) -> &[i8] {
        &self.numbers
    }

    /// How alike two directions are: their cosine, -1 to 1.
    #[must_use]
    pub fn likeness(&self, other: &Self) -> f32 {
        let product = |one: &[i8], other: &[i8]| -> i32 {
            one.iter().zip(other).fold(0_i32, |sum, (a, b)| sum.wrapping_add(i32::from(*a).wrapping_mul(i32::from(*b))))
        };
        let lengths =
            f64::from(product(&self.numbers, &self.numbers)) * f64::from(product(&other.numbers, &other.numbers));
        if lengths > 0.0 { (f64::from(product(&self.numbers, &other.numbers)) / lengths.sqrt()) as f32 } else { 0.0 }
    }

    fn new(values: &[f32]) -> Self {
        let largest = values.iter().fold(0.0_f32, |largest, value| largest.max(value.abs()));
        let factor = if largest > 0.0 { 127.0 / largest } else { 0.0 };
        Self { numbers: values.iter().map(|value| libm::rintf(value * factor) as i8).collect() }
    }
}

/// Tells what texts mean.
#[derive(Debug)]
pub struct Meaning {
    encoder: Encoder,
    vocabulary: Vocabulary,
}

impl Meaning {
    /// The model that comes with the crate; it takes some ten milliseconds to load, once.
    ///
    /// # Panics
    /// Never: its model is checked by a test.
    #[must_use]
    pub fn builtin() -> &'static Self {
        static BUILTIN: LazyLock<Meaning> = LazyLock::new(|| {
            Meaning::new(MEANING, MODEL)
                .unwrap_or_else(|error| panic!("dialog/parser/model/meaning.safetensors: {error}"))
        });
        &BUILTIN
    }

    /// With the weights of a safetensors file that `dialog/parser/train` has written, and the embeddings of the parser's.
    fn new(model: &[u8], parser: &[u8]) -> Result<Self, ModelError> {
        let (tensors, words) = (Tensors::new(model)?, Tensors::new(parser)?);
        Ok(Self { encoder: Encoder::new(&tensors, &words)?, vocabulary: Vocabulary::new(VOCABULARY) })
    }

    /// The direction of a text; of a long one, that of its first 60 words.
    #[must_use]
    pub fn of(&self, text: &str) -> Direction {
        let mut pieces = vec![self.vocabulary.piece("[CLS]")];
        for word in words(text).into_iter().take(MOST_WORDS) {
            pieces.extend(self.vocabulary.pieces(&text[word]));
        }
        pieces.truncate(self.encoder.positions() - 1);
        pieces.push(self.vocabulary.piece("[SEP]"));
        Direction::new(&encoder::mean(&self.encoder.read(&pieces, &vec![0; pieces.len()])))
    }
}

/// Texts whose directions were found before.
#[derive(Debug, Default)]
pub struct Directions {
    known: HashMap<String, Direction>,
}

/// The tensor of the directions, and the note with their texts, a line each.
const ROWS: &str = "directions";
const TEXTS: &str = "texts";

impl Directions {
    /// Those of a file that [`Self::file`] made.
    ///
    /// # Errors
    /// What is wrong with the file.
    pub fn new(file: &[u8]) -> Result<Self, ModelError> {
        let tensors = Tensors::new(file)?;
        let numbers = tensors.whole_numbers(ROWS)?;
        let rows = numbers.chunks(NUMBERS).map(Direction::from_numbers);
        let texts: Vec<&str> = tensors.note(TEXTS)?.lines().collect();
        if texts.len() * NUMBERS != numbers.len() {
            return Err(ModelError::Shape(ROWS.to_owned()));
        }
        let known = texts.into_iter().map(str::to_owned).zip(rows);
        Ok(Self { known: known.map(|(text, row)| Ok((text, row?))).collect::<Result<_, ModelError>>()? })
    }

    /// The direction of a text that is known.
    #[must_use]
    pub fn get(&self, text: &str) -> Option<&Direction> {
        self.known.get(text)
    }

    /// Each text with its direction, in no order.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &Direction)> {
        self.known.iter().map(|(text, direction)| (text.as_str(), direction))
    }

    /// A safetensors file of texts, none of which has a line break, with their directions.
    ///
    /// # Errors
    /// What the format cannot hold.
    pub fn file(texts: &[String]) -> Result<Vec<u8>, ModelError> {
        let meaning = Meaning::builtin();
        let numbers: Vec<u8> = texts.iter().flat_map(|text| meaning.of(text).numbers).map(i8::cast_unsigned).collect();
        let failed = |error: safetensors::SafeTensorError| ModelError::File(error.to_string());
        let view = TensorView::new(Dtype::I8, vec![texts.len(), NUMBERS], &numbers).map_err(failed)?;
        let notes = HashMap::from([(TEXTS.to_owned(), texts.join("\n"))]);
        safetensors::serialize([(ROWS, view)], Some(notes)).map_err(failed)
    }
}
