//! The search for what a decoder spells: greedily, and by a beam that a language model of what is likely has a say in
//! (`score = ln p(sound) + λ ln p(words) + β · words`), in one batch.

use crate::{
    decoder::Steps,
    ngram::{NGram, Place},
    tokens::Tokens,
};

/// How many spellings are followed at once, and how many tokens each may go on with.
const BEAM: usize = 8;
const BRANCHES: usize = 16;
/// How much say the language model has, λ.
const LAMBDA: f32 = 0.35;
/// What speaks for each word, β: without it the language model has the short win, as each of their words costs.
const WORD: f32 = 1.0;
/// What goes on is followed until it is so much less likely than the best that is done.
const FALLEN: f32 = 2.0;

/// One way to spell what was heard.
#[derive(Clone, Debug)]
pub(crate) struct Spelling {
    pub(crate) tokens: Vec<i64>,
    /// Logarithm of how likely it is by the sound.
    pub(crate) by_sound: f32,
    /// `by_sound` with the language model's say, and what speaks for each word.
    pub(crate) score: f32,
    place: Place,
    /// Which row of the batch it goes on from.
    row: usize,
}

/// What an utterance was spelt as.
pub(crate) struct Spelt {
    pub(crate) greedy: Spelling,
    /// By the beam, the likeliest first.
    pub(crate) others: Vec<Spelling>,
}

/// The search in one utterance.
pub(crate) struct Search<'s> {
    /// The decoder, after its first step.
    pub(crate) steps: Steps<'s>,
    pub(crate) tokens: &'s Tokens,
    /// What is likely to be said.
    pub(crate) model: Option<&'s NGram>,
}

impl Spelling {
    /// Logarithm of how likely a token of it is by the sound.
    pub(crate) fn each(&self) -> f32 {
        self.by_sound / self.tokens.len().max(1) as f32
    }
}

impl Search<'_> {
    /// What it is spelt as, with at most so many tokens.
    pub(crate) fn run(mut self, most: usize, with_beam: bool) -> ort::Result<Spelt> {
        let first = Spelling { tokens: Vec::new(), by_sound: 0.0, place: Place::default(), score: 0.0, row: 0 };
        let mut greedy = first.clone();
        let mut beam = if with_beam { vec![first] } else { Vec::new() };
        let mut done: Vec<Spelling> = Vec::new();
        self.steps.widen(if with_beam { BEAM + 1 } else { 1 });
        let mut is_greedy_done = false;
        for step in 0..most {
            let rows = self.likely(step == 0);
            if !is_greedy_done {
                let (token, chance) = rows[greedy.row][0];
                greedy.by_sound += chance;
                greedy.tokens.push(token);
                if let Some(model) = self.model {
                    self.judge(model, &mut greedy);
                }
                is_greedy_done = token == self.tokens.end();
            }
            beam = self.branch(&beam, &rows, &mut done);
            let best = done.iter().map(|spelling| spelling.score).fold(f32::NEG_INFINITY, f32::max);
            beam.retain(|spelling| spelling.score > best - FALLEN);
            if step + 1 == most || (is_greedy_done && beam.is_empty()) {
                break;
            }
            let greedy_row = (!is_greedy_done).then_some(greedy.row);
            let from: Vec<usize> = greedy_row.into_iter().chain(beam.iter().map(|spelling| spelling.row)).collect();
            self.steps.gather(&from);
            greedy.row = 0;
            let before = from.len() - beam.len();
            beam.iter_mut().enumerate().for_each(|(at, spelling)| spelling.row = before + at);
            let last = |spelling: &Spelling| spelling.tokens.last().copied().expect("invariant: a step was taken");
            let greedy_token = greedy_row.map(|_| last(&greedy));
            let tokens: Vec<i64> = greedy_token.into_iter().chain(beam.iter().map(last)).collect();
            self.steps.step(&tokens)?;
        }
        done.extend(beam);
        done.sort_by(|one, other| other.score.total_cmp(&one.score));
        Ok(Spelt { greedy, others: done })
    }

    /// The likeliest tokens of each row, with the logarithms of their chances.
    fn likely(&self, is_first: bool) -> Vec<Vec<(i64, f32)>> {
        let may_come = |token: usize| self.tokens.may_come(token, is_first);
        self.steps.rows().map(|logits| likeliest(logits, may_come)).collect()
    }

    /// Whether a spelling of the beam may go on with a token.
    fn may_follow(&self, token: i64) -> bool {
        token == self.tokens.end() || self.tokens.get(token).is_some_and(|spelt| spelt.is_plain)
    }

    fn is_done(&self, spelling: &Spelling) -> bool {
        spelling.tokens.last() == Some(&self.tokens.end())
    }

    /// What the language model has to say about the last token.
    fn judge(&self, model: &NGram, spelling: &mut Spelling) {
        let Some(token) = spelling.tokens.last() else { return };
        let by_model = if *token == self.tokens.end() {
            model.end(&mut spelling.place)
        } else {
            let spelt = self.tokens.get(*token).expect("invariant: what has no spelling does not come");
            model.spell(&mut spelling.place, spelt.begins_word, &spelt.letters, spelt.ends_word);
            model.so_far(&spelling.place)
        };
        let words = spelling.place.words().split_whitespace().count() as f32;
        spelling.score = spelling.by_sound + LAMBDA * by_model + WORD * words;
    }

    /// The best spellings that go on from those of the beam; what ends goes to those that are done.
    fn branch(&self, beam: &[Spelling], rows: &[Vec<(i64, f32)>], done: &mut Vec<Spelling>) -> Vec<Spelling> {
        let Some(model) = self.model else { return Vec::new() };
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
            let says = (spelling.place.words().to_owned(), self.is_done(spelling));
            let is_new = said.len() < BEAM && !said.contains(&says);
            if is_new {
                said.push(says);
            }
            is_new
        });
        let (ended, next) = next.into_iter().partition(|spelling| self.is_done(spelling));
        done.extend::<Vec<_>>(ended);
        next
    }
}

/// The likeliest of the tokens that may come, the best first, with the logarithms of their chances among those.
fn likeliest(logits: &[f32], may_come: impl Fn(usize) -> bool) -> Vec<(i64, f32)> {
    let those = || logits.iter().copied().enumerate().filter(|(token, _)| may_come(*token));
    let highest = those().map(|(_, logit)| logit).fold(f32::NEG_INFINITY, f32::max);
    let total = highest + those().map(|(_, logit)| (logit - highest).exp()).sum::<f32>().ln();
    let mut best: Vec<(i64, f32)> = Vec::with_capacity(BRANCHES + 1);
    for (token, logit) in those() {
        if best.len() == BRANCHES && best[BRANCHES - 1].1 >= logit {
            continue;
        }
        let at = best.partition_point(|(_, other)| *other >= logit);
        best.insert(at, (token as i64, logit));
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
        let best = likeliest(&logits, |_| true);
        assert_eq!(best.len(), BRANCHES);
        let mut expected: Vec<f32> = logits.clone();
        expected.sort_by(|one, other| other.total_cmp(one));
        for ((token, chance), logit) in best.iter().zip(expected) {
            assert_eq!(logits[*token as usize], logit);
            assert!(*chance < 0.0);
        }
    }

    #[test]
    fn tokens_that_may_not_come_have_no_chance() {
        let sum = |best: &[(i64, f32)]| best.iter().map(|(_, chance)| chance.exp()).sum::<f32>();
        let all = likeliest(&[1.0, 2.0, 3.0], |_| true);
        assert!(all[0].0 == 2 && (sum(&all) - 1.0).abs() < 1e-6);
        let some = likeliest(&[1.0, 2.0, 3.0], |token| token != 2);
        assert!(some.len() == 2 && some[0].0 == 1 && (sum(&some) - 1.0).abs() < 1e-6);
    }
}
