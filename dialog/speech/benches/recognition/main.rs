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
//! `RECORDINGS=folder` adds recordings of people (16-bit mono WAV) to the talk about other things.

#![allow(missing_docs, clippy::unwrap_used)]

mod cases;
#[path = "../../../language/tests/support/mod.rs"]
mod office;
mod score;
mod sound;
mod voices;

use std::{path::Path, time::Instant};

use cases::{Command, commands, scene};
use cohabit_language::{Clarification, Understanding};
use cohabit_speech::{Bias, Ear, Engines, Heard, RATE, Recognition, Turns, VoiceSettings};
use office::Talk;
use score::{Score, machine};
use sound::Noise;
use voices::Voice;

/// How much louder than the noise the speech is.
const NOISY_DB: f32 = 10.0;
/// Of nothing, noise and other talk, so much is listened to.
const IDLE_S: usize = 600;
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
    let mut ear = Ear::new(vad, recognizer, Turns::default());
    let mut voices = voices::all(engines.synthesizer.take());
    let commands = commands();
    println!("{} commands, {} voices\n", commands.len(), voices.len());
    println!("{}", Score::HEAD);
    let mut totals = [Score::default(), Score::default()];
    for voice in &mut voices {
        for (noisy, total) in totals.iter_mut().enumerate() {
            let score = spoken(&mut ear, voice, &commands, (noisy == 1).then(Noise::new));
            let name = format!("{}{}", voice.name(), if noisy == 1 { ", 10 dB kitchen" } else { "" });
            println!("| {name} | {score} |");
            total.add(&score);
        }
    }
    println!("| all, clean | {} |\n| all, 10 dB kitchen | {} |", totals[0], totals[1]);
    let most = machine::most_memory_mb();
    println!("\nmemory: {idle} MB before, {opened} MB with engines open, at most {most} MB with all of this bench");
    nothing(&mut ear, &mut voices);
}

fn spoken(ear: &mut Ear, voice: &mut Voice, commands: &[Command], mut noise: Option<Noise>) -> Score {
    let mut score = Score::default();
    let mut marks: Option<&[&str]> = None;
    for command in commands {
        let Some(speech) = voice.say(command.text) else { continue };
        let mut talk = Talk::new(&command.marks);
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
        let cpu_s = machine::cpu_s() - before;
        let heard =
            found.recognitions.iter().map(|recognition| sensible(recognition, &talk)).collect::<Vec<_>>().join(" ");
        let raw = found.recognitions.iter().map(|recognition| recognition.raw.clone()).collect::<Vec<_>>().join(" ");
        let meant = talk.say(command.text);
        let understood = if heard.is_empty() { String::new() } else { Talk::new(&command.marks).say(&heard) };
        let is_same = meant == understood;
        let confidence = found.recognitions.iter().map(|recognition| recognition.confidence).fold(1.0, f32::min);
        if std::env::var_os("SHOW").is_some() && !is_same {
            println!("    {confidence:.2} said   {}\n         heard  {heard}\n         raw    {raw}", command.text);
            println!("         meant  {meant}\n         found  {understood}");
        }
        score.note(command.text, &heard, &found.delays_s, found.recognitions.len() > 1);
        score.note_action(command.is_of_mission, is_same, is_act(&understood), confidence);
        score.note_cpu(cpu_s, sound.len() as f64 / f64::from(RATE));
    }
    score
}

/// The reading that is taken: the likeliest that the robot makes sense of.
fn sensible(recognition: &Recognition, talk: &Talk) -> String {
    recognition.sensible(|text| sense(&understood(text, talk))).to_owned()
}

/// Whether something is done: what is understood is no question, answer or refusal.
fn is_act(understood: &str) -> bool {
    !understood.is_empty() && !understood.starts_with(['?', '=', '!'])
}

/// What the robot does not understand makes no sense; what it wonders about may.
fn sense(understanding: &Understanding) -> u8 {
    match understanding {
        Understanding::Refusal { is_lost: true, .. } => 0,
        Understanding::Question { kind: Clarification::Appearance | Clarification::Request, .. } => 1,
        _ => 2,
    }
}

fn understood(text: &str, talk: &Talk) -> Understanding {
    talk.language.understand(text, &talk.scene, &mut talk.context.clone())
}

/// Listens as to an open microphone.
fn listen(ear: &mut Ear, sound: &[f32], ends_at: Option<usize>, talk: &Talk) -> Found {
    let mut found = Found::default();
    let start = ear.position();
    let mut is_complete = |text: &str| {
        matches!(
            understood(text, talk),
            Understanding::Plan { .. } | Understanding::Stop { .. } | Understanding::Answer { .. }
        )
    };
    for piece in sound.chunks(PIECE) {
        let began = Instant::now();
        for heard in ear.push(piece, &mut is_complete).unwrap() {
            let Heard::Said(utterance) = heard else { continue };
            if let Some(ends_at) = ends_at {
                let pause_s = (utterance.told - start) as f64 / f64::from(RATE) - ends_at as f64 / f64::from(RATE);
                found.delays_s.push(pause_s + began.elapsed().as_secs_f64());
            }
            if !utterance.recognition.best().is_empty() {
                found.recognitions.push(utterance.recognition);
            }
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
    let mut other = Vec::new();
    let said = include_str!("../../../language/tests/utterances/off_domain.txt");
    let said: Vec<&str> = said.lines().filter(|line| !line.starts_with('#') && !line.is_empty()).collect();
    for (at, text) in said.iter().cycle().enumerate() {
        if other.len() >= third || voices.is_empty() {
            break;
        }
        let voice = at % voices.len();
        other.extend(voices[voice].say(text).unwrap_or_default());
        other.extend(vec![0.0; RATE as usize]);
    }
    let mut parts =
        vec![("silence".to_owned(), hiss), ("kitchen".to_owned(), kitchen), ("other talk".to_owned(), other)];
    parts.extend(recordings());
    println!("\n| what | minutes | utterances | acted on | acted on, of those trusted |");
    println!("|---|---|---|---|---|");
    for (name, sound) in parts {
        let found = listen(ear, &sound, None, &talk);
        let acts = |recognition: &&Recognition| {
            let text = sensible(recognition, &talk);
            let understanding = understood(&text, &talk);
            let acts = matches!(understanding, Understanding::Plan { .. } | Understanding::Stop { .. });
            if acts && std::env::var_os("SHOW").is_some() {
                println!(
                    "    {:.2} {text} ({}): {}",
                    recognition.confidence,
                    recognition.raw,
                    office::text(&understanding, &talk.scene)
                );
            }
            acts
        };
        let acted: Vec<&Recognition> = found.recognitions.iter().filter(acts).collect();
        let trusted = acted.iter().filter(|recognition| recognition.confidence >= score::TRUSTED).count();
        let minutes = sound.len() as f64 / f64::from(RATE) / 60.0;
        println!("| {name} | {minutes:.1} | {} | {} | {trusted} |", found.recognitions.len(), acted.len());
    }
}

fn recordings() -> Vec<(String, Vec<f32>)> {
    let Some(folder) = std::env::var_os("RECORDINGS") else { return Vec::new() };
    let files = std::fs::read_dir(Path::new(&folder)).unwrap().flatten().map(|entry| entry.path());
    let sounds = files.filter(|path| path.extension().is_some_and(|extension| extension == "wav"));
    sounds
        .filter_map(|path| Some((path.file_stem()?.to_string_lossy().into_owned(), sound::read_wav(&path)?)))
        .collect()
}
