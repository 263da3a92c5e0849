//! Somebody at a page with an open microphone: sound goes in as fast as it lasts, without a gap, and all that the page is
//! sent is noted with its time.

use std::{
    collections::VecDeque,
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, channel},
    },
    thread,
    time::Duration,
};

use anyhow::{Context as _, ensure};
use cohabit_bus::{go_first, monotonic_nanos};
use cohabit_speech::{RATE, to_pcm};
use cohabit_tests::{Page, Pen, Received};
use serde_json::{Value, json};

use crate::voices::Saying;

/// Samples of a piece: 20 ms.
const PIECE: usize = RATE as usize / 50;
const PIECE_NANOS: u64 = 20_000_000;
/// How loud a room is in which nobody speaks: 60 dB below the loudest.
const HISS: f32 = 1e-3;

/// A person, for as long as the session lasts.
pub struct Person {
    mouth: Arc<Mouth>,
    heard: Receiver<(u64, Received)>,
    /// All that came so far, with when it did, ns.
    pub all: Vec<(u64, Received)>,
    /// Until when what was sent of the robot's voice sounds, ns.
    sounds_until: u64,
    /// Whether the robot does something.
    pub is_busy: bool,
}

struct Mouth {
    pen: Mutex<Pen>,
    /// What is still to be said, and how many samples were said.
    saying: Mutex<(VecDeque<i16>, u64)>,
    began_nanos: u64,
    is_over: AtomicBool,
}

/// When something was said, ns.
#[derive(Clone, Copy, Debug)]
pub struct Said {
    pub began: u64,
    pub ended: u64,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Person {
    /// Opens a page, wants to hear the robot, and opens the microphone.
    pub fn come(authority: &str) -> anyhow::Result<Self> {
        let page = Page::open(authority)?;
        let mouth = Arc::new(Mouth {
            pen: Mutex::new(page.pen()?),
            saying: Mutex::default(),
            began_nanos: monotonic_nanos(),
            is_over: AtomicBool::new(false),
        });
        let (to, heard) = channel();
        let reader = Arc::clone(&mouth);
        thread::spawn(move || read(page, &reader, &|received| to.send(received).is_ok()));
        Ok(Self { mouth, heard, all: Vec::new(), sounds_until: 0, is_busy: false })
    }

    /// Opens the microphone, and waits until it is listened to.
    pub fn listen(&mut self) -> anyhow::Result<()> {
        self.send(&json!({ "type": "aloud", "on": true }))?;
        self.send(&json!({ "type": "listen", "rate": RATE, "held": false }))?;
        let told =
            self.wait(60.0, |received| message(received, "voice").cloned())?.context("the engines are not told of")?.1;
        ensure!(told["hears"] == true && told["speaks"] == true, "it cannot hear and speak: {}", told["lacks"]);
        let mouth = Arc::clone(&self.mouth);
        thread::spawn(move || mouth.sound());
        Ok(())
    }

    /// Sends a message.
    pub fn send(&mut self, message: &Value) -> anyhow::Result<()> {
        lock(&self.mouth.pen).send(message)
    }

    /// Types a sentence; gives when.
    pub fn write(&mut self, text: &str) -> anyhow::Result<u64> {
        self.send(&json!({ "type": "say", "text": text }))?;
        Ok(monotonic_nanos())
    }

    /// Says something as soon as what was said before is; gives when.
    pub fn say(&mut self, saying: &Saying) -> Said {
        let (waiting, said) = &mut *lock(&self.mouth.saying);
        let first = *said + waiting.len() as u64;
        waiting.extend(to_pcm(&saying.samples));
        let at = |sample: usize| self.mouth.began_nanos + (first + sample as u64) * 1_000_000_000 / u64::from(RATE);
        Said { began: at(saying.first), ended: at(saying.last) }
    }

    /// Reads on until `find` finds something, for so many seconds; gives when it came, and what.
    pub fn wait<T>(
        &mut self,
        seconds: f64,
        mut find: impl FnMut(&Received) -> Option<T>,
    ) -> anyhow::Result<Option<(u64, T)>> {
        let until = monotonic_nanos() + (seconds * 1e9) as u64;
        while let Some(received) = self.next(until)? {
            if let Some(found) = find(&received) {
                return Ok(Some((self.all.last().map_or(0, |(nanos, _)| *nanos), found)));
            }
        }
        Ok(None)
    }

    /// What comes next, if anything does until then.
    fn next(&mut self, until: u64) -> anyhow::Result<Option<Received>> {
        let left = Duration::from_nanos(until.saturating_sub(monotonic_nanos()));
        let Ok((nanos, received)) = self.heard.recv_timeout(left) else {
            ensure!(monotonic_nanos() >= until, "the page is gone");
            return Ok(None);
        };
        match &received {
            Received::Sound(sound) => {
                let lasts = sound.samples as u64 * 1_000_000_000 / u64::from(sound.rate_hz.max(1));
                self.sounds_until = self.sounds_until.max(nanos) + lasts;
            }
            Received::Message(message) if message["type"] == "hush" => self.sounds_until = nanos,
            Received::Message(message) if message["type"] == "state" => self.is_busy = message["robot"]["busy"] == true,
            _ => {}
        }
        if !matches!(received, Received::Frame) {
            self.all.push((nanos, received.clone()));
        }
        Ok(Some(received))
    }

    /// Waits so many seconds.
    pub fn pause(&mut self, seconds: f64) -> anyhow::Result<()> {
        self.wait(seconds, |_| None::<()>).map(drop)
    }

    /// Has the robot end what it does, and waits until it neither moves nor speaks for a second.
    pub fn calm(&mut self) -> anyhow::Result<()> {
        self.pause(0.2)?;
        if self.is_busy {
            self.write("stop")?;
            self.pause(0.5)?;
        }
        let deadline = monotonic_nanos() + 40_000_000_000;
        while self.is_busy || monotonic_nanos() < self.sounds_until + 1_000_000_000 {
            self.pause(0.1)?;
            ensure!(monotonic_nanos() < deadline, "the robot does not come to rest");
        }
        Ok(())
    }
}

impl Drop for Person {
    fn drop(&mut self) {
        self.mouth.is_over.store(true, Ordering::Relaxed);
    }
}

/// A message of that type.
pub fn message<'r>(received: &'r Received, kind: &str) -> Option<&'r Value> {
    match received {
        Received::Message(message) if message["type"] == kind => Some(message),
        _ => None,
    }
}

/// Reads a page until nobody wants to know.
fn read(mut page: Page, mouth: &Mouth, take: &dyn Fn((u64, Received)) -> bool) {
    while !mouth.is_over.load(Ordering::Relaxed) {
        let Ok(received) = page.next_received() else { break };
        if !take((monotonic_nanos(), received)) {
            break;
        }
    }
}

impl Mouth {
    /// Sends a piece every 20 ms, of what is to be said, or of a quiet room. A browser's microphone has a thread of real
    /// time, too.
    fn sound(&self) {
        go_first();
        let mut noise = 1u32;
        let now = monotonic_nanos();
        // Samples are counted from when the person came.
        lock(&self.saying).1 = (now - self.began_nanos) / PIECE_NANOS * PIECE as u64;
        while !self.is_over.load(Ordering::Relaxed) {
            let piece = {
                let (waiting, said) = &mut *lock(&self.saying);
                let piece: Vec<i16> =
                    (0..PIECE).map(|_| waiting.pop_front().unwrap_or_else(|| hiss(&mut noise))).collect();
                *said += PIECE as u64;
                (piece, *said)
            };
            // It is complete when its last sample was taken.
            let due = self.began_nanos + piece.1 * 1_000_000_000 / u64::from(RATE);
            thread::sleep(Duration::from_nanos(due.saturating_sub(monotonic_nanos())));
            if lock(&self.pen).send_sound(&piece.0).is_err() {
                break;
            }
        }
    }
}

fn hiss(noise: &mut u32) -> i16 {
    *noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    ((*noise >> 16) as i16 as f32 * HISS) as i16
}
