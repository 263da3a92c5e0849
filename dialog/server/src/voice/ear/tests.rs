//! What is said to an ear, and what it tells of that.

use std::{
    sync::Mutex,
    time::{Duration, Instant},
};

use cohabit_bus::Local;
use cohabit_speech::{Engines, VoiceSettings, fake, to_pcm};
use tokio::sync::mpsc::{UnboundedReceiver, error::TryRecvError, unbounded_channel};

use super::*;
use crate::voice::VoiceConfig;

#[derive(Default)]
struct Room(Mutex<Vec<u32>>);

impl Audience for Room {
    fn is_whole(&self, text: &str) -> bool {
        text.ends_with("office")
    }

    fn is_at_work(&self) -> bool {
        true
    }

    fn likely(&self, _: u64) -> Option<(u64, Scene)> {
        None
    }

    fn stop(&self, visitor: u32, _: u64) {
        self.0.lock().unwrap().push(visitor);
    }
}

/// An ear at work, with what it tells, and its room.
struct Hall {
    hearing: Hearing,
    told: UnboundedReceiver<FromEar>,
    room: Arc<Room>,
    voice: Arc<Voice>,
    /// The time of the next piece: sound comes as fast as it lasts.
    nanos: u64,
}

const LONG: Duration = Duration::from_secs(30);
const PIECE: usize = 8_000;

impl Hall {
    fn new(reader: fake::Reader, config: impl FnOnce(&mut VoiceConfig)) -> Self {
        let mut settings = VoiceConfig::new(Ok(VoiceSettings::installed("nowhere")));
        config(&mut settings);
        let engines = Engines {
            vad: Box::new(fake::Loudness),
            recognizer: Some(Box::new(reader)),
            synthesizer: Some(Box::new(fake::Beeper)),
            lacks: Vec::new(),
        };
        let (voice, room) = (Voice::with(engines, settings, Arc::new(Local::new(1))), Arc::new(Room::default()));
        let (to, told) = unbounded_channel();
        let at = EarAt { voice: Arc::clone(&voice), talk: Arc::clone(&room) as _, visitor: 7, to };
        let hearing = Hearing::begin(at, RATE).unwrap();
        let nanos = hearing.began_nanos;
        Self { hearing, told, room, voice, nanos }
    }

    fn speak(&mut self, samples: &[f32]) {
        for piece in to_pcm(samples).chunks(PIECE) {
            let bytes: Vec<u8> = piece.iter().flat_map(|sample| sample.to_le_bytes()).collect();
            self.nanos += piece.len() as u64 * 1_000_000_000 / u64::from(RATE);
            // The queue is shorter than what is said at once here.
            while self.hearing.take(&bytes, self.nanos).unwrap().is_some() {
                self.hearing.samples -= piece.len() as u64;
                self.hearing.is_behind = false;
                thread::sleep(Duration::from_millis(5));
            }
        }
    }

    /// The next thing told of which `find` makes something.
    fn next<T>(&mut self, mut find: impl FnMut(FromEar) -> Option<T>) -> T {
        let began = Instant::now();
        loop {
            match self.told.try_recv() {
                Ok(told) => {
                    if let Some(found) = find(told) {
                        return found;
                    }
                }
                Err(TryRecvError::Empty) => thread::sleep(Duration::from_millis(2)),
                Err(TryRecvError::Disconnected) => panic!("the ear is gone"),
            }
            assert!(began.elapsed() < LONG, "nothing more was told");
        }
    }

    fn said(&mut self) -> Spoken {
        self.next(|told| if let FromEar::Said(spoken) = told { Some(*spoken) } else { None })
    }

    fn state(&mut self, state: &str) -> Value {
        self.next(|told| match told {
            FromEar::Page(message) if message["state"] == state => Some(message),
            _ => None,
        })
    }

    /// Waits until a turn that says stop was done, and is over.
    fn stopped(&mut self) {
        (0..2).for_each(|_| drop(self.state("stopped")));
    }

    fn stops(&self) -> usize {
        self.room.0.lock().unwrap().len()
    }
}

fn silence(seconds: f32) -> Vec<f32> {
    vec![0.0; (seconds * RATE as f32) as usize]
}

fn loud(seconds: f32) -> Vec<f32> {
    vec![0.4; (seconds * RATE as f32) as usize]
}

#[test]
fn what_is_said_is_told_with_its_times() {
    let mut scene = Hall::new(fake::Reader::default(), |_| ());
    let speech = fake::hidden("go to the main office");
    let [begins, lasts] = [1.0, speech.len() as f64 / f64::from(RATE)];
    let start = scene.nanos;
    scene.speak(&[silence(1.0), speech, silence(1.5)].concat());
    assert_eq!(scene.state("began")["type"], "hearing");
    let spoken = scene.said();
    assert_eq!(spoken.heard.best(), "go to the main office");
    let after = |nanos: u64| nanos.saturating_sub(start) as f64 * 1e-9;
    // The pieces here are half a second long, and so are the doubts.
    assert!((after(spoken.began_nanos) - begins).abs() < 0.6, "{}", after(spoken.began_nanos));
    assert!((after(spoken.ended_nanos) - begins - lasts).abs() < 0.6, "{}", after(spoken.ended_nanos));
    assert_eq!(scene.stops(), 0);
}

#[test]
fn stop_is_done_while_it_is_said_and_not_said_again() {
    let mut scene = Hall::new(fake::Reader::default(), |_| ());
    scene.speak(&[fake::hidden("stop right there you robot"), silence(1.5)].concat());
    scene.stopped();
    assert_eq!(scene.stops(), 1, "once, though it was heard in pieces and whole");
}

#[test]
fn errors_and_delays_are_made_on_purpose_but_never_for_stop() {
    let mut scene = Hall::new(fake::Reader::default(), |config| {
        (config.errors, config.delay, config.seed) = (1.0, Duration::from_millis(40), 3);
    });
    scene.speak(&[fake::hidden("turn right at the light"), silence(1.5)].concat());
    let spoken = scene.said();
    assert_ne!(spoken.heard.best(), "turn right at the light");
    assert!(spoken.text_nanos > 0);
    scene.speak(&[fake::hidden("stop"), silence(1.5)].concat());
    scene.stopped();
    assert_eq!(scene.stops(), 1);
}

#[test]
fn stop_is_done_at_once_while_what_was_said_before_waits() {
    let mut scene = Hall::new(fake::Reader::default(), |config| config.delay = Duration::from_secs(60));
    scene.speak(&[fake::hidden("go to the main office"), silence(1.5), fake::hidden("stop"), silence(1.5)].concat());
    scene.stopped();
    assert_eq!(scene.stops(), 1);
    // Nobody wants that any more.
    let Hall { hearing, mut told, .. } = scene;
    drop(hearing);
    let rest = std::iter::from_fn(|| told.blocking_recv());
    assert_eq!(rest.filter(|told| matches!(told, FromEar::Said(_))).count(), 0);
}

#[test]
fn the_robots_own_voice_is_not_answered_but_stop_is_heard() {
    let mut scene = Hall::new(fake::Reader::default(), |_| ());
    scene.voice.mouth.note_own_voice(Some("OK, going to the main office."), monotonic_nanos());
    scene.speak(&[fake::hidden("going to the main office"), silence(1.5)].concat());
    scene.state("nothing");
    scene.speak(&[fake::hidden("stop"), silence(1.5)].concat());
    scene.stopped();
    assert_eq!(scene.stops(), 1);
    // What it says of stopping is no stop.
    scene.voice.mouth.note_own_voice(None, monotonic_nanos());
    scene.voice.mouth.note_own_voice(Some("OK, I stop."), monotonic_nanos());
    scene.speak(&[fake::hidden("ok i stop"), silence(1.5)].concat());
    scene.state("nothing");
    assert_eq!(scene.stops(), 1);
}

#[test]
fn stop_is_heard_over_a_long_answer_that_speaks_of_it_however_soon_after_another() {
    let mut scene = Hall::new(fake::Reader::default(), |_| ());
    let answer = "I can go to rooms and objects, and pick things up. Say \"stop\" to stop me.";
    for stops in 1..=3 {
        scene.voice.mouth.note_own_voice(Some(answer), monotonic_nanos());
        scene.speak(&[fake::hidden("stop"), silence(1.5)].concat());
        scene.stopped();
        assert_eq!(scene.stops(), stops);
        scene.voice.mouth.note_own_voice(None, monotonic_nanos());
    }
}

#[test]
fn stop_is_heard_at_the_end_of_a_long_sentence_before_that_ends() {
    let mut scene = Hall::new(fake::Reader::default(), |_| ());
    // Nothing ends it: it is heard in what was said last.
    scene.speak(&[fake::hidden("no that is not at all what I meant to say"), fake::hidden("stop")].concat());
    scene.speak(&loud(1.0));
    scene.state("stopped");
    assert_eq!(scene.stops(), 1);
}

#[test]
fn ten_minutes_without_a_pause_are_cut_told_and_survived() {
    let by_length = vec![(3, "go to the main office".to_owned()), (200, "a long story".to_owned())];
    let mut scene = Hall::new(fake::Reader { by_length, ..fake::Reader::default() }, |_| ());
    scene.speak(&loud(600.0));
    let text = scene.next(|told| match told {
        FromEar::Page(message) if message["type"] == "error" => Some(message["text"].to_string()),
        _ => None,
    });
    assert!(text.contains("That was very long"), "{text}");
    assert_eq!(scene.said().heard.best(), "a long story");
    // What comes after is heard as ever.
    scene.speak(&[silence(2.0), loud(1.0), silence(2.0)].concat());
    while scene.said().heard.best() != "go to the main office" {}
}

#[test]
fn who_goes_on_before_it_was_done_has_said_one_thing() {
    let mut scene = Hall::new(fake::Reader::default(), |config| config.edit = Duration::from_secs(1));
    let parts =
        || [fake::hidden("go to the main office"), silence(0.7), fake::hidden("and open the door"), silence(1.5)];
    scene.speak(&parts().concat());
    assert_eq!(scene.said().heard.best(), "go to the main office");
    assert_eq!(scene.state("began")["joins"], true);
    assert_eq!(scene.said().heard.best(), "go to the main office and open the door");
    // What is done is not said again.
    let [first, pause, second, rest] = parts();
    scene.speak(&[rest.clone(), first, pause].concat());
    assert_eq!(scene.said().heard.best(), "go to the main office");
    scene.hearing.part().unwrap();
    scene.speak(&[second, rest].concat());
    assert_eq!(scene.said().heard.best(), "and open the door");
}

#[test]
fn there_are_so_many_ears_and_no_more() {
    let scene = Hall::new(fake::Reader::default(), |_| ());
    let (to, _told) = unbounded_channel();
    let at =
        || EarAt { voice: Arc::clone(&scene.voice), talk: Arc::clone(&scene.room) as _, visitor: 1, to: to.clone() };
    let others: Vec<Hearing> = std::iter::from_fn(|| Hearing::begin(at(), RATE).ok()).collect();
    assert_eq!(others.len() + 1, crate::voice::MOST_EARS);
    drop(others);
    let again = std::iter::repeat_with(|| {
        thread::sleep(Duration::from_millis(5));
        Hearing::begin(at(), RATE).is_ok()
    });
    assert!(again.take(2_000).any(|begun| begun), "an ear that has ended makes room");
}

#[test]
fn silence_is_nothing() {
    let mut scene = Hall::new(fake::Reader::default(), |_| ());
    scene.speak(&silence(20.0));
    scene.speak(&[loud(0.5), silence(1.5)].concat());
    scene.state("nothing");
    while let Ok(told) = scene.told.try_recv() {
        assert!(!matches!(told, FromEar::Said(_)));
    }
}

#[test]
fn what_is_no_sound_of_the_rate_is_refused() {
    let mut scene = Hall::new(fake::Reader::default(), |_| ());
    let now = scene.nanos;
    assert!(scene.hearing.take(&[0; 7], now).unwrap_err().contains("7 bytes"));
    assert!(scene.hearing.take(&vec![0; LONGEST_PIECE + 2], now).is_err());
    scene.hearing.take(&[], now).unwrap();
    let second = vec![0; LONGEST_PIECE];
    let refused = (1..=30_u64).find_map(|third| scene.hearing.take(&second, now + third * 333_000_000).err());
    assert!(refused.unwrap().contains("where 16000 are needed"));
    let (to, _told) = unbounded_channel();
    let at = EarAt { voice: Arc::clone(&scene.voice), talk: Arc::clone(&scene.room) as _, visitor: 1, to };
    let problem = Hearing::begin(at, 44_100).err().unwrap();
    assert!(problem.contains("44100 samples a second"), "{problem}");
}
