//! What is said: commands about the things of the missions that ship, and some of the language's own utterances, each with
//! the office that it is said in.

use cohabit_speech::Scene;

use crate::office::Talk;

// The commands.
/// Commands that were written to be typed, or to test what is no speech, are left out.
const UNSPOKEN: &[&str] = &[
    "typos",
    "hurried student",
    "dictation",
    "speech slips",
    "very short",
    "whole stories",
    "speech",
    "conversations",
];
/// Of the language's own utterances, every so many are spoken: they are many.
const EVERY_OTHER: usize = 4;
/// Longer ones are none that are spoken in one breath: words.
const LONGEST: usize = 18;
/// Which of two halves a text belongs to, by its letters (FNV-1a): numbers were chosen on half 0, and hold if half 1 agrees.
pub fn half(text: &str) -> u8 {
    let hash = text
        .bytes()
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3));
    (hash >> 32) as u8 & 1
}

/// A command, and the office that it is said in.
pub struct Command {
    pub marks: Vec<&'static str>,
    pub text: &'static str,
    /// Whether it is about a mission that ships.
    pub is_of_mission: bool,
}

/// All that can be spoken of in an office, as people call it.
pub fn scene(talk: &Talk) -> Scene {
    let names = talk.language.spoken_names(&talk.scene);
    let [things, places, rooms] = [names.things, names.places, names.rooms].map(|names| names.into_iter().collect());
    Scene { things, places, rooms, words: Vec::new(), known: names.words }
}

/// Those of the missions, and some of the language's own.
pub fn commands() -> Vec<Command> {
    let own = cases(include_str!("commands.txt"), true);
    let others = [
        include_str!("../../../language/tests/utterances/seen.txt"),
        include_str!("../../../language/tests/utterances/voices.txt"),
    ];
    let others = others.into_iter().flat_map(|set| cases(set, false)).step_by(EVERY_OTHER);
    let every = std::env::var("EVERY").ok().and_then(|every| every.parse().ok()).unwrap_or(1);
    own.into_iter().chain(others).step_by(every).collect()
}

fn cases(set: &'static str, is_of_mission: bool) -> Vec<Command> {
    let (mut kind, mut marks, mut commands) = ("", Vec::new(), Vec::new());
    for line in set.lines().map(str::trim).filter(|line| !line.is_empty()) {
        let said = line.split_once(" -> ").map_or(line, |(said, _)| said);
        if let Some(named) = line.strip_prefix("# kind:") {
            kind = named.trim();
        } else if let Some(list) = line.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
            let list = list.strip_prefix("marks:").unwrap_or(list);
            marks = list.split(';').map(str::trim).filter(|mark| !mark.is_empty()).collect();
        } else if !line.starts_with('#') && !said.contains(" / ") && is_spoken(kind, said) {
            commands.push(Command { marks: marks.clone(), text: said, is_of_mission });
        }
    }
    commands
}

fn is_spoken(kind: &str, said: &str) -> bool {
    !UNSPOKEN.contains(&kind) && said.split(' ').count() <= LONGEST
}
