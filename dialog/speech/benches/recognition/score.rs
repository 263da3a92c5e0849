//! What is counted.

use std::fmt;

use cohabit_speech::word_distance;

use crate::{Outcome, Turn, cases::Command};

/// Over commands of one voice.
#[derive(Default)]
pub struct Score {
    commands: usize,
    words: usize,
    wrong: usize,
    exact: usize,
    same: usize,
    same_after_yes: usize,
    other: usize,
    /// Of commands about the missions: the same, after a yes or without, and all.
    of_missions: [usize; 2],
    cut: usize,
    delays_s: Vec<f64>,
    cpu_s: f64,
    sound_s: f64,
}

impl Score {
    pub const HEAD: &str = "| voice | words wrong | exact | same action | after a yes | other action | of missions, same | cut in two | end of speech → text, s p50 / p95 | CPU s a second |\n|---|---|---|---|---|---|---|---|---|---|";

    pub fn note(&mut self, command: &Command, turn: &Turn, delays_s: &[f64], is_cut: bool) {
        let (said, heard) = (words(command.text), words(&turn.heard));
        let wrong = word_distance(&said, &heard);
        self.commands += 1;
        self.words += said.len();
        self.wrong += wrong;
        self.exact += usize::from(wrong == 0);
        self.cut += usize::from(is_cut);
        self.delays_s.extend(delays_s.last());
        let is_same = matches!(turn.outcome, Outcome::Same | Outcome::SameAfterYes);
        match turn.outcome {
            Outcome::Same => self.same += 1,
            Outcome::SameAfterYes => self.same_after_yes += 1,
            Outcome::Other => self.other += 1,
            Outcome::Nothing => {}
        }
        if command.is_of_mission {
            self.of_missions[0] += usize::from(is_same);
            self.of_missions[1] += 1;
        }
    }

    pub fn note_cpu(&mut self, cpu_s: f64, sound_s: f64) {
        self.cpu_s += cpu_s;
        self.sound_s += sound_s;
    }

    pub fn sum(scores: &[Self]) -> Self {
        let mut sum = Self::default();
        scores.iter().for_each(|score| sum.add(score));
        sum
    }

    pub fn add(&mut self, other: &Self) {
        self.commands += other.commands;
        self.words += other.words;
        self.wrong += other.wrong;
        self.exact += other.exact;
        self.same += other.same;
        self.same_after_yes += other.same_after_yes;
        self.other += other.other;
        self.of_missions[0] += other.of_missions[0];
        self.of_missions[1] += other.of_missions[1];
        self.cut += other.cut;
        self.delays_s.extend(&other.delays_s);
        self.note_cpu(other.cpu_s, other.sound_s);
    }
}

impl fmt::Display for Score {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let share = |part: usize, of: usize| 100.0 * part as f64 / of.max(1) as f64;
        let of_all = |part: usize| share(part, self.commands);
        let mut delays_s = self.delays_s.clone();
        delays_s.sort_by(f64::total_cmp);
        let delay_s =
            |share: f64| delays_s.get(((delays_s.len() as f64 - 1.0) * share) as usize).copied().unwrap_or(0.0);
        write!(
            f,
            "{:.1} % | {:.0} % | {:.1} % | {:.1} % | {:.1} % | {:.1} % | {} | {:.2} / {:.2} | {:.2}",
            share(self.wrong, self.words),
            of_all(self.exact),
            of_all(self.same),
            of_all(self.same_after_yes),
            of_all(self.other),
            share(self.of_missions[0], self.of_missions[1]),
            self.cut,
            delay_s(0.5),
            delay_s(0.95),
            self.cpu_s / self.sound_s.max(1e-9)
        )
    }
}

/// Numbers, as they are spoken and as they are written.
const NUMBERS: &[(&str, &str)] = &[
    ("1", "one"),
    ("2", "two"),
    ("3", "three"),
    ("4", "four"),
    ("5", "five"),
    ("6", "six"),
    ("10", "ten"),
    ("20", "twenty"),
    ("30", "thirty"),
    ("45", "forty five"),
    ("90", "ninety"),
    ("180", "one eighty"),
    ("ok", "okay"),
    ("3d", "three d"),
];

/// Words heard wrong, of a hundred.
pub fn wrong(said: &str, heard: &str) -> f64 {
    let (said, heard) = (words(said), words(heard));
    100.0 * word_distance(&said, &heard) as f64 / said.len().max(1) as f64
}

/// The words of a text, as they sound.
fn words(text: &str) -> Vec<String> {
    let text = text.to_lowercase().replace(['-', '’'], " ").replace('\'', "");
    let words = text.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    let spoken =
        words.map(|word| NUMBERS.iter().find(|(written, _)| *written == word).map_or(word, |(_, spoken)| spoken));
    spoken.flat_map(str::split_whitespace).map(str::to_owned).collect()
}

/// What this process takes, from `/proc`.
pub mod machine {
    /// Ticks a second of the counts of the kernel, on all Linux machines.
    const TICKS: f64 = 100.0;

    pub fn memory_mb() -> u64 {
        status("VmRSS:")
    }

    pub fn most_memory_mb() -> u64 {
        status("VmHWM:")
    }

    fn status(name: &str) -> u64 {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix(name)).unwrap_or_default();
        line.split_whitespace().next().and_then(|kb| kb.parse::<u64>().ok()).unwrap_or(0) / 1024
    }

    /// CPU time of all threads so far.
    pub fn cpu_s() -> f64 {
        let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
        let fields: Vec<&str> = stat.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
        let ticks = |at: usize| fields.get(at).and_then(|ticks| ticks.parse::<f64>().ok()).unwrap_or(0.0);
        (ticks(11) + ticks(12)) / TICKS
    }
}
