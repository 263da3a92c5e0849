//! The likeliest outputs of the network, by beam search.

use crate::{
    grammar::{Letter, State},
    network::{Input, MOST_LETTERS, Memory, Network, Scores, Written},
    symbol::Symbol,
};

/// A whole output and the logarithm of its probability.
pub(crate) struct Output {
    pub(crate) letters: Vec<Letter>,
    pub(crate) log_probability: f32,
}

struct Hypothesis {
    letters: Vec<Letter>,
    state: State,
    written: Written,
    log_probability: f32,
}

/// Outputs this much less likely than the best are given up.
const LEAST_LOG_RATIO: f32 = -6.0;

/// The likeliest outputs, best first; of each length the `width` best beginnings are followed.
pub(crate) fn search(network: &Network, memory: &Memory, alphabet: &[Symbol], width: usize) -> Vec<Output> {
    let begin = Hypothesis { letters: Vec::new(), state: State::new(), written: network.begin(), log_probability: 0.0 };
    let mut live = vec![begin];
    let mut finished: Vec<Output> = Vec::new();
    for _ in 0..MOST_LETTERS {
        let mut next: Vec<(f32, usize, Letter)> = Vec::new();
        let written = live.iter_mut().map(|one| (input(one.letters.last()), &mut one.written)).collect();
        let scores = network.next(written, memory);
        for (at, (hypothesis, scores)) in live.iter().zip(&scores).enumerate() {
            let likely = allowed(scores, &hypothesis.state, alphabet);
            next.extend(likely.into_iter().map(|(letter, log)| (hypothesis.log_probability + log, at, letter)));
        }
        next.sort_by(|a, b| b.0.total_cmp(&a.0));
        next.truncate(width);
        let mut followed = Vec::with_capacity(width);
        for (log_probability, at, letter) in next {
            let before = &live[at];
            let letters: Vec<Letter> = before.letters.iter().copied().chain([letter]).collect();
            if matches!(letter, Letter::Symbol(symbol) if alphabet[symbol] == Symbol::End) {
                finished.push(Output { letters, log_probability });
                continue;
            }
            let state = before.state.after(letter, alphabet);
            followed.push(Hypothesis { letters, state, written: before.written.clone(), log_probability });
        }
        finished.sort_by(|a, b| b.log_probability.total_cmp(&a.log_probability));
        let best = finished.first().map_or(f32::NEG_INFINITY, |output| output.log_probability);
        followed.retain(|hypothesis| hypothesis.log_probability > best + LEAST_LOG_RATIO);
        live = followed;
        if live.is_empty() || finished.len() >= width {
            break;
        }
    }
    finished
}

const fn input(last: Option<&Letter>) -> Input {
    match last {
        None => Input::Begin,
        Some(Letter::Symbol(symbol)) => Input::Symbol(*symbol),
        Some(Letter::Start(word)) => Input::Start(*word),
        Some(Letter::End(word)) => Input::End(*word),
    }
}

/// The letters that may follow, with the logarithms of their probabilities.
fn allowed(scores: &Scores, state: &State, alphabet: &[Symbol]) -> Vec<(Letter, f32)> {
    let mut letters: Vec<(Letter, f32)> = Vec::new();
    let symbols = scores.symbols.iter().enumerate().filter(|(at, _)| state.allows(&alphabet[*at]));
    letters.extend(symbols.map(|(at, score)| (Letter::Symbol(at), *score)));
    if state.allows_start() {
        letters.extend(scores.starts.iter().enumerate().map(|(word, score)| (Letter::Start(word), *score)));
    }
    if let Some(first) = state.first_end() {
        letters.extend(scores.ends.iter().enumerate().skip(first).map(|(word, score)| (Letter::End(word), *score)));
    }
    let largest = letters.iter().map(|(_, score)| *score).fold(f32::NEG_INFINITY, f32::max);
    let total: f32 = letters.iter().map(|(_, score)| libm::expf(score - largest)).sum();
    let normaliser = largest + libm::logf(total);
    letters.iter_mut().for_each(|(_, score)| *score -= normaliser);
    letters
}
