//! How a page is heard: a thread that takes its sound, and tells what is said in it.

use std::{
    collections::VecDeque,
    sync::{
        Arc, Mutex, PoisonError,
        mpsc::{Receiver, SyncSender, TrySendError, sync_channel},
    },
    thread,
};

use cohabit_bus::{
    Publisher, Topic,
    message::{AudioHeader, AudioView},
    monotonic_nanos,
};
use cohabit_language::{find_stop, mentions_stop, says_stop, says_stop_already};
use cohabit_speech::{
    Bias, Ear, Heard, RATE, Recognition, Recognizer, Scene, SpeechError, Turns, Utterance, errors::Injector, from_pcm,
};
use serde_json::{Value, json};
use tokio::sync::mpsc::UnboundedSender;

use super::{Shared, Voice};
use crate::spoken::Spoken;

/// The most bytes of one piece of sound: a second.
const LONGEST_PIECE: usize = 2 * RATE as usize;
/// The most pieces that wait to be listened to: some come while the engines are opened.
const MOST_WAITING: usize = 256;
/// How often what was said so far is told, s.
const PARTIAL_EVERY_S: f32 = 0.32;
/// While a robot is at work, what was said last is listened to for a stop so often, and so much of it, s: a word, and what it may
/// stand in.
const WATCH_EVERY_S: f32 = 0.128;
const WATCHED_S: f32 = 1.4;
/// Who speaks again so soon while what they said can be changed yet goes on with it, s.
const JOINS_S: f32 = 1.5;
/// So long it takes until the robots' own answer to a stop has sounded, ns; and it has no more words.
const OWN_STOP_NANOS: u64 = 5_000_000_000;
const OWN_STOP_WORDS: usize = 4;
/// Sound that comes so much faster than it lasts is not of the rate that the page says.
const FASTEST: f64 = 1.4;
/// So much sound must have come before that is told, s.
const TOLD_AFTER_S: f64 = 3.0;

const BEHIND: &str = "I cannot listen as fast as you speak; some of that was lost.";

/// Where a page's sound goes. Its thread ends when this is dropped.
pub struct Hearing {
    to: SyncSender<ToEar>,
    /// When it began, and how many samples came since.
    began_nanos: u64,
    samples: u64,
    is_behind: bool,
}

/// What an ear is sent.
enum ToEar {
    /// Samples, and when they came.
    Sound(Vec<i16>, u64),
    /// A key is held: no pause ends what is said.
    Hold,
    /// It was released, or the microphone is gone: what was said is all.
    Finish,
    /// What was told last is done, or forgotten: nothing joins it.
    Part,
}

/// What an ear tells its page's visit.
pub enum FromEar {
    /// To the page.
    Page(Value),
    /// Somebody said this.
    Said(Box<Spoken>),
}

/// Who makes sense of what an ear hears.
pub trait Audience: Send + Sync {
    /// Whether what was said so far is a whole sentence.
    fn is_whole(&self, text: &str) -> bool;

    /// Whether a robot does anything that somebody may want to stop.
    fn is_at_work(&self) -> bool;

    /// What there is to speak of, if that is other than what had this number before; with its number.
    fn likely(&self, before: u64) -> Option<(u64, Scene)>;

    /// Somebody at a page says stop.
    fn stop(&self, visitor: u32, heard_nanos: u64);
}

/// Whose ear it is.
pub struct EarAt {
    /// Voice of the session.
    pub voice: Arc<Voice>,
    /// The conversation.
    pub talk: Arc<dyn Audience>,
    /// The page's number.
    pub visitor: u32,
    /// Who is told.
    pub to: UnboundedSender<FromEar>,
}

impl Hearing {
    /// Listens to a page that sends so many samples a second.
    ///
    /// # Errors
    /// In a sentence for people, if that is another rate than is needed.
    pub fn begin(at: EarAt, rate: u32) -> Result<Self, String> {
        check(rate)?;
        let (to, sent) = sync_channel(MOST_WAITING);
        thread::spawn(move || at.listen(&sent));
        Ok(Self { to, began_nanos: monotonic_nanos(), samples: 0, is_behind: false })
    }

    /// The page sends sound again, after a while or not.
    ///
    /// # Errors
    /// As [`Hearing::begin`].
    pub fn begin_again(&mut self, rate: u32) -> Result<(), String> {
        check(rate)?;
        (self.began_nanos, self.samples) = (monotonic_nanos(), 0);
        Ok(())
    }

    /// Takes a piece of sound: 16-bit samples, little-endian. Gives what people are to be told, if anything.
    ///
    /// # Errors
    /// In a sentence for people, if it is none, and there is no use in more.
    pub fn take(&mut self, bytes: &[u8], received_nanos: u64) -> Result<Option<&'static str>, String> {
        if bytes.len() % 2 == 1 || bytes.len() > LONGEST_PIECE {
            return Err(format!(
                "The microphone sends {} bytes at once, which are no samples of 16 bits, a second at most: text still works.",
                bytes.len()
            ));
        }
        self.samples += bytes.len() as u64 / 2;
        let (came_s, lasts_s) =
            (received_nanos.saturating_sub(self.began_nanos) as f64 * 1e-9, self.samples as f64 / f64::from(RATE));
        if lasts_s > TOLD_AFTER_S && lasts_s > came_s * FASTEST + 1.0 {
            return Err(format!(
                "The microphone sends {:.0} samples a second, where {RATE} are needed: reload the page, or type.",
                self.samples as f64 / came_s.max(0.1)
            ));
        }
        let samples = bytes.chunks_exact(2).map(|pair| i16::from_le_bytes([pair[0], pair[1]])).collect();
        match self.to.try_send(ToEar::Sound(samples, received_nanos)) {
            Ok(()) => {
                self.is_behind = false;
                Ok(None)
            }
            // Told once, until it has caught up.
            Err(TrySendError::Full(_)) if self.is_behind => Ok(None),
            Err(TrySendError::Full(_)) => {
                self.is_behind = true;
                Ok(Some(BEHIND))
            }
            Err(TrySendError::Disconnected(_)) => Err("I cannot hear any more: text still works.".to_owned()),
        }
    }

    /// A key is held.
    pub fn hold(&self) {
        let _ = self.to.send(ToEar::Hold);
    }

    /// It is released.
    pub fn finish(&self) {
        let _ = self.to.send(ToEar::Finish);
    }

    /// What was told last is done, or forgotten: what is said next does not go on with it.
    pub fn part(&self) {
        let _ = self.to.send(ToEar::Part);
    }
}

fn check(rate: u32) -> Result<(), String> {
    let refusal =
        || format!("The microphone sends {rate} samples a second, where {RATE} are needed: reload the page, or type.");
    if rate == RATE { Ok(()) } else { Err(refusal()) }
}

/// An ear at work.
struct Listening<'a> {
    at: &'a EarAt,
    ear: Ear,
    recognizer: Shared,
    injector: Injector,
    bus: Option<Box<dyn Publisher>>,
    sayings: u64,
    /// When the newest sample came, ns.
    newest_nanos: u64,
    /// When somebody began to say what they are saying.
    began_nanos: u64,
    /// All that was recognised since it was last asked whether that says stop.
    readings: Readings,
    /// What came last, and how many samples came since it was listened to for a stop.
    last: VecDeque<f32>,
    unwatched: usize,
    /// The first sample of what is being said.
    first: u64,
    /// Whether what is being said has said stop already, and when somebody last did.
    has_stopped: bool,
    stopped_nanos: u64,
    /// What was said to be likely last.
    likely: u64,
}

impl EarAt {
    fn listen(&self, sent: &Receiver<ToEar>) {
        let told = self.voice.told();
        let opened = self.voice.opened().recognizer.clone().zip(self.voice.vad());
        self.tell(told);
        let Some((recognizer, vad)) = opened else { return };
        let joins_s = self.voice.config.edit.as_secs_f32().min(JOINS_S);
        let turns = Turns { partial_every_s: PARTIAL_EVERY_S, joins_s, ..Turns::default() };
        let readings = Readings::default();
        let attentive = Attentive { recognizer: recognizer.clone(), readings: Arc::clone(&readings) };
        let microphone = self.voice.bus.publisher(Topic::Microphone);
        let mut listening = Listening {
            at: self,
            ear: Ear::new(vad, Box::new(attentive), turns),
            recognizer,
            readings,
            last: VecDeque::new(),
            unwatched: 0,
            first: 0,
            injector: Injector::new(self.voice.config.errors, self.voice.config.seed ^ u64::from(self.visitor)),
            bus: microphone.inspect_err(|error| tracing::warn!("microphones are not heard on the bus: {error}")).ok(),
            sayings: 0,
            newest_nanos: monotonic_nanos(),
            began_nanos: 0,
            has_stopped: false,
            stopped_nanos: 0,
            likely: 0,
        };
        listening.expect();
        while let Ok(next) = sent.recv() {
            listening.take(next);
        }
    }

    fn tell(&self, message: Value) {
        // A page that is gone need not be told.
        let _ = self.to.send(FromEar::Page(message));
    }
}

impl Listening<'_> {
    fn take(&mut self, next: ToEar) {
        let talk = Arc::clone(&self.at.talk);
        let heard = match next {
            ToEar::Sound(samples, nanos) => {
                self.newest_nanos = nanos;
                self.publish(&samples);
                let samples = from_pcm(&samples);
                self.watch(&samples);
                self.ear.push(&samples, &mut |text| talk.is_whole(text))
            }
            ToEar::Hold => {
                self.ear.hold();
                Ok(Vec::new())
            }
            ToEar::Finish => self.ear.finish().map(|heard| heard.into_iter().collect()),
            ToEar::Part => {
                self.ear.part();
                Ok(Vec::new())
            }
        };
        // Of a piece in which somebody begins, what was heard is theirs already.
        if heard.iter().flatten().any(|heard| matches!(heard, Heard::Began { .. })) {
            self.has_stopped = false;
        }
        // What was said up to a pause, which may be in the middle of a sentence.
        let readings = std::mem::take(&mut *self.readings.lock().unwrap_or_else(PoisonError::into_inner));
        for text in readings {
            self.stop_if(says_stop(&text));
        }
        match heard {
            Ok(heard) => heard.into_iter().for_each(|heard| self.hear(heard)),
            Err(error) => {
                tracing::warn!("{error}");
                self.at.tell(
                    json!({ "type": "error", "text": format!("I could not hear that: {error}. You can type it.") }),
                );
                self.at.tell(state("nothing", ""));
            }
        }
    }

    /// Listens for a stop in what is being said, whenever a little more of it was said, before anything else is made of it.
    fn watch(&mut self, samples: &[f32]) {
        let [watched, every] = [WATCHED_S, WATCH_EVERY_S].map(|seconds| (seconds * RATE as f32) as usize);
        self.last.extend(samples);
        let surplus = self.last.len().saturating_sub(watched);
        self.last.drain(..surplus);
        self.unwatched += samples.len();
        let is_due = self.ear.is_in_turn() && self.unwatched >= every && !self.has_stopped;
        if !is_due || !(self.at.voice.mouth.is_speaking() || self.at.talk.is_at_work()) {
            return;
        }
        self.unwatched = 0;
        let said = (self.ear.position() + samples.len() as u64).saturating_sub(self.first) as usize;
        let from = self.last.len().saturating_sub(said);
        match self.recognizer.partial(&self.last.make_contiguous()[from..]) {
            Ok(text) => drop(self.stop_if(text.is_some_and(|text| says_stop_already(&text)))),
            // Whoever recognises all of it tells that.
            Err(error) => tracing::warn!("{error}"),
        }
    }

    fn hear(&mut self, heard: Heard) {
        match heard {
            Heard::Began { began, joins } => {
                (self.began_nanos, self.first) = (self.nanos_of(began), began);
                self.sayings += 1;
                self.at.tell(json!({ "type": "hearing", "state": "began", "text": "", "joins": joins }));
                self.expect();
            }
            Heard::Partial { text } => {
                self.stop_if(says_stop_already(&text));
                if !self.has_stopped {
                    self.at.tell(state("partial", &text));
                }
            }
            Heard::Said(utterance) => self.said(utterance),
        }
    }

    /// Stop is done before anything is made of what else is said.
    fn stop_if(&mut self, stops: bool) -> bool {
        if stops && !self.has_stopped {
            self.has_stopped = true;
            self.stop();
        }
        stops
    }

    /// Has all robots stop, and say no more. Where one of them answers to a stop just now, who says that word cannot be told:
    /// then it is done once, lest they stop each other for ever. They have stopped then.
    fn stop(&mut self) {
        let now = monotonic_nanos();
        let is_answer = |said: &str| mentions_stop(said) && said.split(' ').count() <= OWN_STOP_WORDS;
        let is_own_word = self.at.voice.mouth.says(self.began_nanos, is_answer);
        if is_own_word && now.saturating_sub(self.stopped_nanos) < OWN_STOP_NANOS {
            return;
        }
        self.stopped_nanos = now;
        let after_ms = now.saturating_sub(self.began_nanos) / 1_000_000;
        tracing::info!("page {} says stop, heard {after_ms} ms after its first sound", self.at.visitor);
        self.at.talk.stop(self.at.visitor, now);
        // What was heard before and can be changed yet is not done either.
        self.at.tell(state("stopped", ""));
    }

    fn said(&mut self, utterance: Utterance) {
        let [began_nanos, ended_nanos] = [utterance.began, utterance.ended].map(|sample| self.nanos_of(sample));
        let Utterance { recognition, is_cut, .. } = utterance;
        if is_cut {
            let text =
                "That was very long: I listened to the first half a minute. Say it in a few short sentences, please.";
            self.at.tell(json!({ "type": "error", "text": text }));
        }
        let mouth = &self.at.voice.mouth;
        let own = mouth.is_echo(recognition.best(), began_nanos) || mouth.is_echo(&recognition.raw, began_nanos);
        // Its own words stop it where they say stop, lest somebody's are taken for them.
        let stops = recognition.likely().filter(|text| self.stop_if(says_stop(text))).count() > 0;
        if stops || own {
            self.ear.part();
        }
        let rest = recognition_of_rest(&recognition, |text| self.at.talk.is_whole(text)).filter(|_| stops && !own);
        if rest.is_none() && (stops || own || recognition.best().is_empty()) {
            self.at.tell(state(if stops { "stopped" } else { "nothing" }, ""));
            return;
        }
        let recognition = rest.unwrap_or(recognition);
        let recognition = self.injector.garble_recognition(&recognition);
        thread::sleep(self.at.voice.config.delay);
        let spoken =
            Spoken { began_nanos, ended_nanos, text_nanos: monotonic_nanos(), heard: recognition, settled: None };
        if spoken.first().is_none() {
            self.at.tell(state("nothing", ""));
            return;
        }
        let _ = self.at.to.send(FromEar::Said(Box::new(spoken)));
    }

    /// When a sample came, by when the newest did.
    fn nanos_of(&self, sample: u64) -> u64 {
        let before = self.ear.position().saturating_sub(sample);
        self.newest_nanos.saturating_sub(before * 1_000_000_000 / u64::from(RATE))
    }

    /// Has the recogniser know what is likely to be said, if that is news.
    fn expect(&mut self) {
        let Some((likely, scene)) = self.at.talk.likely(self.likely) else { return };
        self.likely = likely;
        self.ear.bias(&Bias::of_scene(&scene));
    }

    fn publish(&mut self, samples: &[i16]) {
        let Some(bus) = &mut self.bus else { return };
        let header = AudioHeader::of_visitor(RATE, self.at.visitor, self.sayings);
        for piece in samples.chunks(AudioHeader::MOST_SAMPLES) {
            let write = &mut |bytes: &mut [u8]| AudioView::write(header, piece, bytes);
            if let Err(error) = bus.send(0, AudioView::bytes(piece.len()), write) {
                tracing::warn!("{error}");
            }
        }
    }
}

/// What else was said with a stop, if that is a whole request or question by itself.
fn recognition_of_rest(recognition: &Recognition, is_whole: impl Fn(&str) -> bool) -> Option<Recognition> {
    let rest = find_stop(recognition.best())?.rest;
    (!rest.is_empty() && is_whole(&rest)).then(|| Recognition::trusted(rest, recognition.confidence()))
}

/// What was recognised.
type Readings = Arc<Mutex<Vec<String>>>;

/// A recogniser that notes all that may well have been said.
struct Attentive {
    recognizer: Shared,
    readings: Readings,
}

impl Recognizer for Attentive {
    fn bias(&mut self, bias: &Bias) {
        self.recognizer.bias(bias);
    }

    fn recognize(&mut self, samples: &[f32]) -> Result<Recognition, SpeechError> {
        let recognition = self.recognizer.recognize(samples)?;
        let mut readings = self.readings.lock().unwrap_or_else(PoisonError::into_inner);
        readings.extend(recognition.likely().map(str::to_owned));
        Ok(recognition)
    }

    fn partial(&mut self, samples: &[f32]) -> Result<Option<String>, SpeechError> {
        self.recognizer.partial(samples)
    }

    fn name(&self) -> &str {
        self.recognizer.name()
    }
}

fn state(state: &str, text: &str) -> Value {
    json!({ "type": "hearing", "state": state, "text": text })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
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
        scene.hearing.part();
        scene.speak(&[second, rest].concat());
        assert_eq!(scene.said().heard.best(), "and open the door");
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

    #[test]
    fn what_is_said_after_a_stop_is_heard_if_it_is_whole() {
        let rest = |said: &str, is_whole: bool| {
            let rest = recognition_of_rest(&Recognition::sure(said), |_| is_whole);
            rest.map(|rest| rest.best().to_owned())
        };
        assert_eq!(rest("stop, come back", true).as_deref(), Some("come back"));
        assert_eq!(rest("stop, there is a cat", false), None);
        assert_eq!(rest("stop", true), None);
        assert_eq!(rest("come back", true), None);
    }
}
