//! Voice live, beside the simulator: `cargo bench -p cohabit --bench voice [-- PART..]`.
//!
//! A session in real time, at whose page somebody speaks with an open microphone, and watches and hears the robot. The
//! parts, all of them if none is named: `quiet` (nobody speaks, but the microphone is open), `commands` (from the end of
//! speech to text, understanding, motion and the first sound of the answer), `drive` and `speech` ("stop" while the robot
//! drives, and while it says something long). `times=N` has all be said so many times. Prints the machine, the version, the
//! times, how late ticks began in each part, and what memory the dialog service held. Needs `cohabit voice install` and
//! espeak-ng.

mod measures;
mod person;
mod voices;
mod witness;

use std::{
    fs,
    sync::atomic::{AtomicBool, AtomicU64, Ordering},
    thread,
    time::Duration,
};

use anyhow::Context as _;
use cohabit_bus::{message::DialogKind, monotonic_nanos};
use cohabit_tests::{Lateness, Play, Received, Resident, machine};

use crate::{
    measures::Measures,
    person::{Person, message},
    voices::{Saying, Voice},
    witness::Witness,
};

const COHABIT: &str = env!("CARGO_BIN_EXE_cohabit");
const MIB: f64 = 1_048_576.0;
/// The robot hears at once: the moment in which what was heard can be changed comes on top.
const ARGUMENTS: [&str; 5] = ["make_cereal", "--knows", "everything", "--edit-heard", "0"];
const PARTS: [&str; 4] = ["quiet", "commands", "drive", "speech"];
const QUIET_S: f64 = 40.0;
const COMMANDS: [&str; 12] = [
    "Go to the break room.",
    "Turn left ninety degrees.",
    "Where is the milk?",
    "Look around.",
    "What are you holding?",
    "Go to the main office.",
    "Where is the bowl?",
    "Turn around.",
    "What can you do?",
    "Go to the robotics lab.",
    "What is left?",
    "Turn right.",
];
/// Where it drives, to and fro, and what it answers at length.
const DRIVES: [&str; 2] = ["go to the break room", "go to the robotics lab"];
const QUESTION: &str = "what can you do?";
/// How it is told to stop.
const STOPS: [&str; 4] = ["Stop!", "Stop.", "Please stop.", "No no, that is not what I meant, stop."];
/// What is put down for whoever says it, in whatever words.
const STOP: &str = "stop";
/// What takes longer is given up, s.
const LONGEST_S: f64 = 4.0;

fn main() {
    if let Err(error) = run() {
        println!("it failed: {error:#}");
    }
}

fn run() -> anyhow::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    let times = arguments.iter().find_map(|argument| argument.strip_prefix("times=")?.parse().ok());
    let is_wanted = |part: &&str| {
        PARTS.iter().all(|any| !arguments.contains(&(*any).to_owned())) || arguments.iter().any(|one| one == part)
    };
    println!("cohabit {}, {}", env!("CARGO_PKG_VERSION"), machine());
    let (commands, stops) = sayings(&mut voices::all()?)?;
    let play = Play::start_in(COHABIT, &ARGUMENTS, &[("RUST_LOG", "warn")])?;
    let dialog = play.processes("dialog").first().copied().context("no dialog service")?;
    let before = held(dialog);
    let mut scene = Scene {
        person: Person::come(play.authority())?,
        witness: Witness::new(&play.session)?,
        measures: Measures::default(),
    };
    scene.person.listen()?;
    let most = AtomicU64::new(0);
    for part in PARTS.into_iter().filter(is_wanted) {
        println!("\n## {part}");
        let lateness = beside(&play.session, dialog, &most, || match part {
            "quiet" => scene.person.pause(QUIET_S),
            "commands" => scene.commands(&commands, times.unwrap_or(1)),
            "drive" => scene.drives(&stops, times.unwrap_or(3)),
            _ => scene.answers(&stops, times.unwrap_or(3)),
        })?;
        scene.measures.print();
        scene.measures = Measures::default();
        lateness.print();
    }
    let most = most.load(Ordering::Relaxed);
    println!(
        "\nmemory of the dialog service and what it starts, MiB: {:.0} before anybody spoke, {:.0} at most; voice: {:.0}",
        before as f64 / MIB,
        most as f64 / MIB,
        most.saturating_sub(before) as f64 / MIB
    );
    drop(scene);
    play.end().map(drop)
}

/// What is said, by each voice.
fn sayings(voices: &mut [Voice]) -> anyhow::Result<(Vec<Saying>, Vec<Saying>)> {
    let (mut commands, mut stops) = (Vec::new(), Vec::new());
    for text in COMMANDS {
        for voice in &mut *voices {
            commands.push(voice.say(text)?);
        }
    }
    for text in STOPS {
        for voice in &mut *voices {
            stops.push(voice.say(text)?);
        }
    }
    Ok((commands, stops))
}

/// Does something, and watches ticks and memory meanwhile.
fn beside(
    session: &str,
    dialog: i32,
    most: &AtomicU64,
    mut part: impl FnMut() -> anyhow::Result<()>,
) -> anyhow::Result<Lateness> {
    let over = AtomicBool::new(false);
    thread::scope(|scope| {
        let ticks = scope.spawn(|| Lateness::watch(session, &over));
        scope.spawn(|| {
            while !over.load(Ordering::Relaxed) {
                most.fetch_max(held(dialog), Ordering::Relaxed);
                thread::sleep(Duration::from_millis(50));
            }
        });
        let done = part();
        over.store(true, Ordering::Relaxed);
        let lateness = ticks.join().ok().context("who watched the ticks fell over")?;
        done.and(lateness)
    })
}

/// Bytes that a process and the programs that it starts hold, all but the memory that the session shares.
fn held(process: i32) -> u64 {
    let program = |process: i32| fs::read_link(format!("/proc/{process}/exe")).ok();
    let threads = fs::read_dir(format!("/proc/{process}/task")).into_iter().flatten().flatten();
    let children = threads.map(|thread| fs::read_to_string(thread.path().join("children")).unwrap_or_default());
    let children: String = children.collect();
    let children = children.split_whitespace().filter_map(|child| child.parse().ok());
    // One that is about to become another program has its parent's memory until then.
    let others = children.filter(|child| program(*child) != program(process));
    std::iter::once(process).chain(others).map(Resident::of).map(|resident| resident.own + resident.files).sum()
}

struct Scene {
    person: Person,
    witness: Witness,
    measures: Measures,
}

impl Scene {
    fn commands(&mut self, commands: &[Saying], times: usize) -> anyhow::Result<()> {
        for command in (0..times).flat_map(|_| commands) {
            self.command(command)?;
            self.person.calm()?;
        }
        Ok(())
    }

    fn command(&mut self, command: &Saying) -> anyhow::Result<()> {
        let from = self.person.all.len();
        let said = self.person.say(command);
        let lasts_s = command.samples.len() as f64 / f64::from(cohabit_speech::RATE);
        let heard = self.person.wait(lasts_s + LONGEST_S, |received| {
            let line = message(received, "chat").filter(|line| line["from"] == "person")?;
            Some((line["turn"].as_u64()?, line["text"].as_str()?.to_owned()))
        })?;
        let Some((shown, (turn, text))) = heard.filter(|(_, (_, text))| text != STOP) else {
            println!("not heard: {} ({}): {}", command.text, command.voice, self.heard(from));
            return Ok(());
        };
        if !is_same(&text, command.text) {
            println!("heard {text:?}: {} ({})", command.text, command.voice);
        }
        let is_first = |received: &Received| {
            matches!(received, Received::Sound(sound) if sound.turn == turn && sound.samples > 0).then_some(())
        };
        let sounded = self.person.wait(LONGEST_S, is_first)?.map(|(nanos, ())| nanos);
        // By then it moves, if it is to.
        self.person.pause(0.5)?;
        let seen = self.witness.seen();
        let [began, ended, text, understood, _] = seen.spoken(turn).context("how a turn was spoken is not told")?;
        let (measures, end) = (&mut self.measures, said.ended);
        measures.note("speech begun → told so by the service", said.began, Some(began));
        measures.note("speech ended → told so by the service", end, Some(ended));
        measures.note("speech ended → text", end, Some(text));
        measures.note("speech ended → understood", end, Some(understood));
        measures.note("speech ended → shown at the page", end, Some(shown));
        if let Some(moved) = seen.moved(turn) {
            measures.note("speech ended → first motion", end, Some(moved));
        }
        measures.note("understood → first sound at the page", understood, sounded);
        Ok(())
    }

    /// What the page was told of what was heard from then on.
    fn heard(&self, from: usize) -> String {
        let heard = self.person.all[from..].iter().filter_map(|(_, received)| message(received, "hearing"));
        let heard = heard.map(|told| format!("{} {}", told["state"].as_str().unwrap_or_default(), told["text"]));
        heard.collect::<Vec<_>>().join(", ")
    }

    /// "Stop" while it drives.
    fn drives(&mut self, stops: &[Saying], times: usize) -> anyhow::Result<()> {
        for (nth, stop) in (0..times).flat_map(|_| stops).enumerate() {
            self.person.write(DRIVES[nth % DRIVES.len()])?;
            self.person.pause(2.5)?;
            if self.witness.seen().is_moving() {
                self.stop(stop, true)?;
            } else {
                println!("it has arrived already");
            }
            self.person.calm()?;
        }
        Ok(())
    }

    /// "Stop" while it says something long.
    fn answers(&mut self, stops: &[Saying], times: usize) -> anyhow::Result<()> {
        for stop in (0..times).flat_map(|_| stops) {
            self.person.write(QUESTION)?;
            let is_sound = |received: &Received| matches!(received, Received::Sound(_)).then_some(());
            self.person.wait(LONGEST_S, is_sound)?.context("no answer aloud")?;
            self.person.pause(1.0)?;
            self.stop(stop, false)?;
            self.person.calm()?;
        }
        Ok(())
    }

    fn stop(&mut self, stop: &Saying, is_driving: bool) -> anyhow::Result<()> {
        let from = self.person.all.len();
        let said = self.person.say(stop);
        let lasts_s = stop.samples.len() as f64 / f64::from(cohabit_speech::RATE);
        let is_told = |received: &Received| {
            let line = message(received, "chat").filter(|line| line["from"] == "person" && line["text"] == STOP)?;
            Some(line.is_object())
        };
        // Whoever is heard hushes the robot: the last time before the line, it was this.
        let told = self.person.wait(lasts_s + LONGEST_S, is_told)?;
        let hushes = self.person.all[from..].iter().filter(|(_, received)| message(received, "hush").is_some());
        let hushed = told.and(hushes.map(|(nanos, _)| *nanos).next_back());
        self.person.pause(1.0)?;
        let deadline = monotonic_nanos() + (LONGEST_S * 1e9) as u64;
        while is_driving && self.witness.seen().stood(0).is_none() && monotonic_nanos() < deadline {
            self.person.pause(0.1)?;
        }
        let name = |what: &str| format!("{} \"{}\": {what}", stop.voice, stop.text);
        if hushed.is_none() {
            println!("not stopped by {}", name(&self.heard(from)));
        }
        if is_driving && monotonic_nanos() > deadline {
            println!("it moves on after {}", name(&self.heard(from)));
        }
        let seen = self.witness.seen();
        let is_order =
            |told: &&witness::Told| told.kind == DialogKind::Utterance && told.text == STOP && told.nanos > said.began;
        let ordered = seen.dialog.iter().find(is_order).map(|told| told.nanos);
        let last = seen.speech.iter().rfind(|nanos| hushed.is_some_and(|hushed| **nanos < hushed)).copied();
        let stood = is_driving.then(|| seen.stood(said.began));
        for (what, to) in [("order", ordered), ("page is hushed", hushed)]
            .into_iter()
            .chain(stood.map(|stood| ("body stands", stood)))
        {
            self.measures.note(&format!("word ended → {what}"), said.ended, to);
            self.measures.note(&format!("word begun → {what}"), said.began, to);
            if what == "order" {
                self.measures.note(&name("ended → order"), said.ended, to);
            }
        }
        if let (false, Some(last)) = (is_driving, last) {
            self.measures.note("word ended → last sound sent", said.ended, Some(last.max(said.ended)));
        }
        Ok(())
    }
}

/// Whether two texts are of the same words.
fn is_same(one: &str, other: &str) -> bool {
    let words = |text: &str| -> Vec<String> {
        let text = text.to_lowercase().replace("90", "ninety");
        text.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).map(str::to_owned).collect()
    };
    words(one) == words(other)
}
