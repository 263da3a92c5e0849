//! How well speech is recognised: commands spoken by synthetic voices, clean and in the noise of a kitchen, heard as from an
//! open microphone, and understood; then silence, noise and talk about other things, of which nothing should come.
//!
//! ```text
//! cohabit voice install
//! cargo bench -p cohabit-speech --bench recognition
//! ```
//!
//! It needs the engines in the data folder, and Flite for the third voice; it says what it goes without. What the voices
//! say is kept between runs, in the target folder. `EVERY=5` takes every fifth command alone, `SHOW=1` prints what went wrong,
//! `RECORDINGS=folder` adds recordings of people (16-bit mono WAV) to the talk about other things, and tells how many words were
//! heard wrong of those with their words beside them (`a.txt` for `a.wav`).

#![allow(missing_docs, clippy::unwrap_used)]

mod cases;
#[path = "../../../language/tests/support/mod.rs"]
mod office;
mod score;
mod sound;
mod voices;

use std::{path::Path, time::Instant};

use cases::{Command, commands, half, scene};
use cohabit_dialog::meaning;
use cohabit_language::{Understanding, says_stop};
use cohabit_speech::{Bias, Ear, Engines, Heard, RATE, Recognition, Turns, VoiceSettings, choose};
use office::Talk;
use score::{Score, machine};
use sound::Noise;
use voices::Voice;

const NOISES: [&str; 2] = ["", ", 10 dB kitchen"];
/// How much louder than the noise the speech is.
const NOISY_DB: f32 = 10.0;
/// Of nothing, noise and other talk, so much is listened to.
const IDLE_S: usize = 600;
/// What comes of what says stop, before anything is made of it.
const STOP: &str = "stop!";
/// What comes in at once: 20 ms.
const PIECE: usize = RATE as usize / 50;

/// What came of a sound.
#[derive(Default)]
struct Found {
    recognitions: Vec<Recognition>,
    /// From the last sound of speech to the text of it.
    delays_s: Vec<f64>,
}

fn main() {
    let settings = VoiceSettings::from_env().unwrap();
    let idle = machine::memory_mb();
    let mut engines = Engines::open(&settings);
    engines.lacks.iter().for_each(|lack| println!("{lack}"));
    let opened = machine::memory_mb();
    let (Some(recognizer), vad) = (engines.recognizer.take(), engines.vad) else {
        println!("skipped: there is no recogniser; `cohabit voice install` fetches one");
        return;
    };
    println!("{}, {}\n", vad.name(), recognizer.name());
    // As in a session where what was heard can be changed for a moment.
    let mut ear = Ear::new(vad, recognizer, Turns { joins_s: 1.0, ..Turns::default() });
    let mut voices = voices::all(engines.synthesizer.take());
    let commands = commands();
    println!("{} commands, {} voices\n", commands.len(), voices.len());
    println!("{}", Score::HEAD);
    let mut totals: [[Score; 2]; 2] = Default::default();
    for voice in &mut voices {
        for (noisy, total) in totals.iter_mut().enumerate() {
            let scores = spoken(&mut ear, voice, &commands, (noisy == 1).then(Noise::new));
            println!("| {}{} | {} |", voice.name(), NOISES[noisy], Score::sum(&scores));
            total.iter_mut().zip(&scores).for_each(|(total, score)| total.add(score));
        }
    }
    for (name, halves) in NOISES.iter().zip(&totals) {
        println!("| all{name} | {} |", Score::sum(halves));
        println!("| all{name}, looked at | {} |\n| all{name}, kept | {} |", halves[0], halves[1]);
    }
    let most = machine::most_memory_mb();
    println!("\nmemory: {idle} MB before, {opened} MB with engines open, at most {most} MB with all of this bench");
    nothing(&mut ear, &mut voices);
}

/// By which half the commands are of.
fn spoken(ear: &mut Ear, voice: &mut Voice, commands: &[Command], mut noise: Option<Noise>) -> [Score; 2] {
    let mut scores = [Score::default(), Score::default()];
    let mut marks: Option<&[&str]> = None;
    for command in commands {
        let Some(speech) = voice.say(command.text) else { continue };
        let talk = Talk::new(&command.marks);
        if marks != Some(&command.marks) {
            ear.bias(&Bias::of_scene(&scene(&talk)));
            marks = Some(&command.marks);
        }
        let mut sound = [vec![0.0; RATE as usize / 2], speech.clone(), vec![0.0; RATE as usize * 3 / 2]].concat();
        let ends_at = RATE as usize / 2 + sound::last_loud(&speech);
        if let Some(noise) = &mut noise {
            noise.add(&mut sound, sound::loudness(&speech), NOISY_DB);
        }
        let before = machine::cpu_s();
        let found = listen(ear, &sound, Some(ends_at), &talk);
        let score = &mut scores[usize::from(half(command.text))];
        score.note_cpu(machine::cpu_s() - before, sound.len() as f64 / f64::from(RATE));
        let turn = Turn::of(command, &found);
        if std::env::var_os("SHOW").is_some() && turn.outcome != Outcome::Same {
            println!(
                "    {:?} said   {}\n         heard  {}\n         raw    {}",
                turn.outcome, command.text, turn.heard, turn.raw
            );
            println!("         meant  {}\n         found  {}", turn.meant, turn.found);
        }
        score.note(command, &turn, &found.delays_s, found.recognitions.len() > 1);
    }
    scores
}

/// What came of a command, as it would in a session that acts without delay.
pub struct Turn {
    pub heard: String,
    pub raw: String,
    pub meant: String,
    pub found: String,
    pub outcome: Outcome,
}

/// Beside what comes of the same words typed.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Outcome {
    /// The same.
    Same,
    /// The same, after a yes.
    SameAfterYes,
    /// Nothing is done: the robot asks, or says that it did not understand.
    Nothing,
    /// Something else is done.
    Other,
}

impl Turn {
    fn of(command: &Command, found: &Found) -> Self {
        let meant = if says_stop(command.text) { STOP.to_owned() } else { Talk::new(&command.marks).say(command.text) };
        let mut talk = Talk::new(&command.marks);
        let (mut heard, mut texts, mut is_doubted) = (Vec::new(), Vec::new(), false);
        for recognition in &found.recognitions {
            // What may say stop stops.
            if let Some(stop) = recognition.likely().find(|text| says_stop(text)) {
                texts.push(STOP.to_owned());
                heard.push(stop.to_owned());
                continue;
            }
            let Some(choice) = choose(recognition, |text| meaning(understood(text, &talk))) else { continue };
            is_doubted |= choice.is_doubtful;
            texts.push(talk.say(&choice.text));
            heard.push(choice.text);
        }
        let raw = found.recognitions.iter().map(|recognition| recognition.raw.clone()).collect::<Vec<_>>().join(" ");
        // What was cut in two is done one after the other.
        let acts: Vec<&str> = texts.iter().map(String::as_str).filter(|text| is_act(text)).collect();
        let acted = !acts.is_empty();
        let found = if acted { acts.join(", ") } else { texts.last().cloned().unwrap_or_default() };
        let outcome = match (found == meant, is_doubted) {
            (true, false) => Outcome::Same,
            (true, true) => Outcome::SameAfterYes,
            (false, false) if acted => Outcome::Other,
            (false, _) => Outcome::Nothing,
        };
        Self { heard: heard.join(" "), raw, meant, found, outcome }
    }
}

/// Whether something is done: what is understood is no question, answer or refusal.
fn is_act(understood: &str) -> bool {
    !understood.is_empty() && !understood.starts_with(['?', '=', '!'])
}

fn understood(text: &str, talk: &Talk) -> Understanding {
    talk.language.understand(text, &talk.scene, &mut talk.context.clone())
}

/// Listens as to an open microphone, in real time as far as what is listened to goes: a piece waits until the one before is done.
fn listen(ear: &mut Ear, sound: &[f32], ends_at: Option<usize>, talk: &Talk) -> Found {
    let mut found = Found::default();
    let seconds = |samples: usize| samples as f64 / f64::from(RATE);
    let mut is_complete = |text: &str| talk.language.is_whole(text, &talk.scene, &talk.context);
    let mut done_s = 0.0f64;
    for (at, piece) in sound.chunks(PIECE).enumerate() {
        let began = Instant::now();
        let heard = ear.push(piece, &mut is_complete).unwrap();
        done_s = done_s.max(seconds((at + 1) * PIECE)) + began.elapsed().as_secs_f64();
        for heard in heard {
            let Heard::Said(utterance) = heard else { continue };
            if utterance.joins {
                found.recognitions.pop();
            }
            found.delays_s.extend(ends_at.map(|ends_at| done_s - seconds(ends_at)));
            found.recognitions.extend(Some(utterance.recognition).filter(|recognition| !recognition.best().is_empty()));
        }
    }
    ear.reset();
    found
}

/// Silence, noise, and talk about other things.
fn nothing(ear: &mut Ear, voices: &mut [Voice]) {
    let talk = Talk::new(&[]);
    ear.bias(&Bias::of_scene(&scene(&talk)));
    let third = IDLE_S / 3 * RATE as usize;
    let mut noise = Noise::new();
    let (mut hiss, mut kitchen) = (vec![0.0; third], vec![0.0; third]);
    noise.add(&mut hiss, 1e-3, 0.0);
    noise.add(&mut kitchen, 0.05, 0.0);
    let mut parts = vec![
        ("silence".to_owned(), hiss),
        ("kitchen".to_owned(), kitchen),
        ("other talk".to_owned(), other(voices, third)),
    ];
    parts.extend(recordings());
    println!("\n| what | minutes | utterances | asked about | acted on |\n|---|---|---|---|---|");
    for (name, sound) in parts {
        let found = listen(ear, &sound, None, &talk);
        if let Some(said) = written(&name) {
            let heard =
                found.recognitions.iter().map(|recognition| recognition.raw.as_str()).collect::<Vec<_>>().join(" ");
            println!("    {name}: {:.1} % of words wrong", score::wrong(&said, &heard));
        }
        let (mut asked, mut acted) = (0, 0);
        for recognition in &found.recognitions {
            let Some(choice) = choose(recognition, |text| meaning(understood(text, &talk))) else { continue };
            let Some(deed) = &choice.meaning.deed else { continue };
            *(if choice.is_doubtful { &mut asked } else { &mut acted }) += 1;
            if std::env::var_os("SHOW").is_some() {
                println!("    {} {} ({}): {deed:?}", choice.is_doubtful, choice.text, recognition.raw);
            }
        }
        let minutes = sound.len() as f64 / f64::from(RATE) / 60.0;
        println!("| {name} | {minutes:.1} | {} | {asked} | {acted} |", found.recognitions.len());
    }
}

/// At least so much talk about other things, of all voices in turn.
fn other(voices: &mut [Voice], length: usize) -> Vec<f32> {
    let said = include_str!("../../../language/tests/utterances/off_domain.txt");
    let said: Vec<&str> = said.lines().filter(|line| !line.starts_with('#') && !line.is_empty()).collect();
    let mut talk = Vec::new();
    for (at, text) in said.iter().cycle().enumerate() {
        if voices.is_empty() || talk.len() >= length {
            break;
        }
        let voice = at % voices.len();
        talk.extend(voices[voice].say(text).unwrap_or_default());
        talk.extend(vec![0.0; RATE as usize * 2]);
    }
    talk
}

/// What is said in a recording, if that stands beside it.
fn written(name: &str) -> Option<String> {
    let folder = std::env::var_os("RECORDINGS")?;
    std::fs::read_to_string(Path::new(&folder).join(format!("{name}.txt"))).ok()
}

fn recordings() -> Vec<(String, Vec<f32>)> {
    let Some(folder) = std::env::var_os("RECORDINGS") else { return Vec::new() };
    let files = std::fs::read_dir(Path::new(&folder)).unwrap().flatten().map(|entry| entry.path());
    let sounds = files.filter(|path| path.extension().is_some_and(|extension| extension == "wav"));
    sounds
        .filter_map(|path| Some((path.file_stem()?.to_string_lossy().into_owned(), sound::read_wav(&path)?)))
        .collect()
}
