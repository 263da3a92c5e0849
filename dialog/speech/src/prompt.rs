//! What a recogniser is told that takes what was said before for a hint: sentences, as if they had been.

use std::collections::HashMap;

use crate::{Bias, bias};

/// Up to so many sentences of a bias that have most of its words, those that are said most often first, in the fewest.
pub(crate) fn prompt(bias: &Bias, most: usize) -> String {
    let mut numbers: HashMap<String, usize> = HashMap::new();
    let mut number = |word: String| {
        let next = numbers.len();
        *numbers.entry(word).or_insert(next)
    };
    let sentences: Vec<Vec<usize>> =
        bias.sentences.iter().map(|sentence| bias::words(sentence).into_iter().map(&mut number).collect()).collect();
    let mut worth = vec![0.0f32; numbers.len()];
    sentences.iter().flatten().for_each(|word| worth[*word] += 1.0);
    worth.iter_mut().for_each(|count| *count = count.ln_1p());
    let mut text = String::new();
    for _ in 0..most {
        // One more word, for what a sentence takes by itself.
        let value = |words: &[usize]| words.iter().map(|word| worth[*word]).sum::<f32>() / (words.len() + 1) as f32;
        let values = sentences.iter().map(|words| value(words)).enumerate();
        let best = values.reduce(|best, other| if other.1 > best.1 { other } else { best });
        let Some((at, _)) = best.filter(|(_, value)| *value > 0.0) else { break };
        sentences[at].iter().for_each(|word| worth[*word] = 0.0);
        text.push_str(&written(&bias.sentences[at]));
    }
    text
}

/// A sentence as it stands in a text.
fn written(sentence: &str) -> String {
    let mut letters = sentence.chars();
    let first: String = letters.next().into_iter().flat_map(char::to_uppercase).collect();
    format!(" {first}{}.", letters.as_str().trim_end_matches('.'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_few_sentences_have_most_words() {
        let said = ["go to the lab", "take the mug", "take the bowl", "take the mug to the lab", "stop"];
        let check = |most: usize, expected: &str| assert_eq!(prompt(&Bias::of(said), most), expected, "{most}");
        check(0, "");
        check(1, " Take the mug.");
        check(9, " Take the mug. Go to the lab. Take the bowl. Stop.");
        assert_eq!(prompt(&Bias::default(), 9), "");
        assert_eq!(prompt(&Bias::of(["…", "éclair."]), 9), " Éclair.");
    }
}
