//! What is counted.

use std::fmt;

use cohabit_speech::word_distance;

/// Over commands of one voice.
#[derive(Default)]
pub struct Score {
    commands: usize,
    words: usize,
    wrong: usize,
    exact: usize,
    /// The same action as typed, and all: of commands about the missions, and others.
    same: [[usize; 2]; 2],
    /// Another action than what was typed, and how many of them were trusted.
    other_acts: [usize; 2],
    cut: usize,
    delays_s: Vec<f64>,
    cpu_s: f64,
    sound_s: f64,
}

/// What is trusted less is asked about before it is acted on.
pub const TRUSTED: f32 = 0.6;

impl Score {
    pub const HEAD: &str = "| voice | words wrong | exact command | same action | of missions | other action | trusted | turns cut | end of speech → text, s p50 / p95 | CPU s a second |\n|---|---|---|---|---|---|---|---|---|---|";

    pub fn note(&mut self, said: &str, heard: &str, delays_s: &[f64], is_cut: bool) {
        let (said, heard) = (words(said), words(heard));
        let wrong = word_distance(&said, &heard);
        self.commands += 1;
        self.words += said.len();
        self.wrong += wrong;
        self.exact += usize::from(wrong == 0);
        self.cut += usize::from(is_cut);
        self.delays_s.extend(delays_s.last());
    }

    pub fn note_action(&mut self, is_of_mission: bool, is_same: bool, is_act: bool, confidence: f32) {
        let [same, all] = &mut self.same[usize::from(!is_of_mission)];
        *same += usize::from(is_same);
        *all += 1;
        let is_other = is_act && !is_same;
        self.other_acts[0] += usize::from(is_other);
        self.other_acts[1] += usize::from(is_other && confidence >= TRUSTED);
    }

    pub fn note_cpu(&mut self, cpu_s: f64, sound_s: f64) {
        self.cpu_s += cpu_s;
        self.sound_s += sound_s;
    }

    pub fn add(&mut self, other: &Self) {
        self.commands += other.commands;
        self.words += other.words;
        self.wrong += other.wrong;
        self.exact += other.exact;
        let add =
            |into: &mut [usize; 2], more: &[usize; 2]| into.iter_mut().zip(more).for_each(|(into, more)| *into += more);
        self.same.iter_mut().zip(&other.same).for_each(|(into, more)| add(into, more));
        add(&mut self.other_acts, &other.other_acts);
        self.cut += other.cut;
        self.delays_s.extend(&other.delays_s);
        self.note_cpu(other.cpu_s, other.sound_s);
    }
}

impl fmt::Display for Score {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let share = |part: usize, of: usize| 100.0 * part as f64 / of.max(1) as f64;
        let mut delays_s = self.delays_s.clone();
        delays_s.sort_by(f64::total_cmp);
        let delay_s =
            |share: f64| delays_s.get(((delays_s.len() as f64 - 1.0) * share) as usize).copied().unwrap_or(0.0);
        write!(
            f,
            "{:.1} % | {:.0} % | {:.1} % | {:.1} % | {} | {} | {} | {:.2} / {:.2} | {:.2}",
            share(self.wrong, self.words),
            share(self.exact, self.commands),
            share(self.same[0][0] + self.same[1][0], self.commands),
            share(self.same[0][0], self.same[0][1]),
            self.other_acts[0],
            self.other_acts[1],
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
