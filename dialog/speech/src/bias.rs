//! What is likely to be said.

use std::collections::BTreeSet;

/// What is likely to be said, from who knows the scene and the grammar of requests.
///
/// A recogniser makes a small language model of the sentences, and trusts words that stand in neither less.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Bias {
    /// Words that may be said, lower case, without punctuation.
    pub words: BTreeSet<String>,
    /// Sentences that are likely, each as it would be typed. How often one stands here is how likely it is.
    pub sentences: Vec<String>,
}

impl Bias {
    /// A bias of sentences; their words may be said in others.
    #[must_use]
    pub fn of(sentences: impl IntoIterator<Item = impl Into<String>>) -> Self {
        let sentences: Vec<String> = sentences.into_iter().map(Into::into).collect();
        let words = sentences.iter().flat_map(|sentence| words(sentence)).collect();
        Self { words, sentences }
    }

    /// Whether it says nothing.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.sentences.is_empty()
    }
}

/// The words of a text: lower case, what stands between them left out, `don't` as one word.
pub(crate) fn words(text: &str) -> Vec<String> {
    let text = text.to_lowercase().replace('’', "'");
    let words = text.split(|c: char| !c.is_alphanumeric() && c != '\'');
    words.map(|word| word.trim_matches('\'').to_owned()).filter(|word| !word.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_told_apart() {
        let check = |text: &str, expected: &[&str]| assert_eq!(words(text), expected, "{text}");
        check("Open the fridge, please!", &["open", "the", "fridge", "please"]);
        check("Don’t  'drop' it.", &["don't", "drop", "it"]);
        check(" … ", &[]);
    }

    #[test]
    fn a_bias_of_sentences_knows_their_words() {
        let bias = Bias::of(["Take the mug.", "take the bowl"]);
        assert_eq!(bias.words.into_iter().collect::<Vec<_>>(), ["bowl", "mug", "take", "the"]);
        assert!(Bias::default().is_empty());
    }
}
