//! An ear at work: what a page sends becomes turns of speech, and what was said is told.

use std::sync::mpsc::{Receiver, RecvTimeoutError};

use cohabit_bus::monotonic_nanos;
use cohabit_language::{says_stop, says_stop_already};
use cohabit_speech::{Bias, Ear, Heard, RATE, Recognition, SpeechError, Turns, Utterance, errors::Injector, from_pcm};
use serde_json::{Value, json};

use super::{
    EarAt, FromEar, ToEar,
    late::Late,
    microphone::Microphone,
    stops::{StopWatch, may_answer_stop, recognition_of_rest},
};
use crate::{page, spoken::Spoken};

/// How often what was said so far is told, s.
const PARTIAL_EVERY_S: f32 = 0.32;
/// Who speaks again so soon while what they said can be changed yet goes on with it, s.
const JOINS_S: f32 = 1.5;

const TOO_LONG: &str =
    "That was very long: I listened to the first half a minute. Say it in a few short sentences, please.";

/// An ear at work.
struct Listening<'a> {
    at: &'a EarAt,
    ear: Ear,
    stops: StopWatch,
    microphone: Microphone,
    injector: Injector,
    late: Late,
    /// When the newest sample came, ns.
    newest_nanos: u64,
    /// When somebody began to say what they are saying.
    began_nanos: u64,
    /// The number of what was said to be likely last.
    likely: u64,
}

impl EarAt {
    /// Listens to what is sent, until nobody sends any more.
    pub(super) fn listen(&self, sent: &Receiver<ToEar>) {
        let told = self.voice.told();
        let opened = self.voice.opened().recognizer.clone().zip(self.voice.vad());
        self.tell(told);
        let Some((recognizer, vad)) = opened else { return };
        let config = &self.voice.config;
        let joins_s = config.edit.as_secs_f32().min(JOINS_S);
        let turns = Turns { partial_every_s: PARTIAL_EVERY_S, joins_s, ..Turns::default() };
        let stops = StopWatch::new(recognizer);
        let mut listening = Listening {
            at: self,
            ear: Ear::new(vad, stops.attentive(), turns),
            stops,
            microphone: Microphone::new(&*self.voice.bus, self.visitor),
            injector: Injector::new(config.errors, config.seed ^ u64::from(self.visitor)),
            late: Late::new(self.to.clone(), config.delay),
            newest_nanos: monotonic_nanos(),
            began_nanos: 0,
            likely: 0,
        };
        listening.expect();
        listening.listen(sent);
    }

    fn tell(&self, message: Value) {
        // A page that is gone need not be told.
        let _ = self.to.send(FromEar::Page(message));
    }
}

impl Listening<'_> {
    /// Takes what is sent, and tells what is due meanwhile.
    fn listen(&mut self, sent: &Receiver<ToEar>) {
        loop {
            match sent.recv_timeout(self.late.pause()) {
                Ok(next) => self.take(next),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
            self.late.tell_due();
        }
        self.late.tell_rest();
    }

    fn take(&mut self, next: ToEar) {
        let heard = self.pass_on(next);
        // Of a piece in which somebody begins, what was heard is theirs already.
        for heard in heard.iter().flatten() {
            if let Heard::Began { began, .. } = heard {
                self.stops.begin(*began);
            }
        }
        // What was said up to a pause, which may be in the middle of a sentence.
        for text in self.stops.take_readings() {
            self.stop_if(says_stop(&text));
        }
        match heard {
            Ok(heard) => heard.into_iter().for_each(|heard| self.hear(heard)),
            Err(error) => {
                tracing::warn!("{error}");
                self.tell(page::error(&format!("I could not hear that: {error}. You can type it.")));
                self.tell_state("nothing", "");
            }
        }
    }

    fn tell(&mut self, message: Value) {
        self.late.tell(FromEar::Page(message));
    }

    /// What becomes of what somebody says.
    fn tell_state(&mut self, state: &str, text: &str) {
        self.tell(json!({ "type": "hearing", "state": state, "text": text }));
    }

    /// Passes it on to the ear, after it was listened to for a stop.
    fn pass_on(&mut self, next: ToEar) -> Result<Vec<Heard>, SpeechError> {
        let EarAt { voice, talk, .. } = self.at;
        match next {
            ToEar::Sound(samples, nanos) => {
                self.newest_nanos = nanos;
                self.microphone.publish(&samples);
                let samples = from_pcm(&samples);
                let is_of_use = || voice.mouth.is_speaking() || talk.is_at_work();
                let stops = self.stops.hears(&samples, &self.ear, is_of_use);
                self.stop_if(stops);
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
        }
    }

    fn hear(&mut self, heard: Heard) {
        match heard {
            Heard::Began { began, joins } => {
                self.began_nanos = self.nanos_of(began);
                self.microphone.begin_saying();
                self.tell(json!({ "type": "hearing", "state": "began", "text": "", "joins": joins }));
                self.expect();
            }
            Heard::Partial { text } => {
                self.stop_if(says_stop_already(&text));
                if !self.stops.has_stopped() {
                    self.tell_state("partial", &text);
                }
            }
            Heard::Said(utterance) => self.said(utterance),
        }
    }

    /// Stop is done before anything is made of what else is said.
    fn stop_if(&mut self, stops: bool) {
        if stops && self.stops.is_first() {
            self.stop();
        }
    }

    /// Has all robots stop, and say no more.
    fn stop(&mut self) {
        let now = monotonic_nanos();
        let is_own_word = self.at.voice.mouth.says(self.began_nanos, may_answer_stop);
        if !self.stops.is_to_be_done(is_own_word, now) {
            return;
        }
        let after_ms = now.saturating_sub(self.began_nanos) / 1_000_000;
        tracing::info!("page {} says stop, heard {after_ms} ms after its first sound", self.at.visitor);
        self.at.talk.stop(self.at.visitor, now);
        // What was heard before and can be changed yet is not done either.
        self.late.forget();
        self.tell_state("stopped", "");
    }

    fn said(&mut self, utterance: Utterance) {
        let [began_nanos, ended_nanos] = [utterance.began, utterance.ended].map(|sample| self.nanos_of(sample));
        let Utterance { recognition, is_cut, .. } = utterance;
        if is_cut {
            self.at.tell(page::error(TOO_LONG));
        }
        let mouth = &self.at.voice.mouth;
        let is_echo = |text: &str| mouth.is_echo(text, [began_nanos, ended_nanos]);
        let is_own = is_echo(recognition.best()) || is_echo(&recognition.raw);
        // Its own words stop it where they say stop, lest somebody's are taken for them.
        let stops = recognition.likely().any(says_stop);
        self.stop_if(stops);
        if stops || is_own {
            self.ear.part();
        }
        let request = if is_own { None } else { self.request(recognition, stops) };
        let Some(request) = request else {
            self.tell_state(if stops { "stopped" } else { "nothing" }, "");
            return;
        };
        let heard = self.injector.garble_recognition(&request);
        let spoken = Spoken { began_nanos, ended_nanos, heard, ..Spoken::default() };
        if spoken.first().is_none() {
            self.tell_state("nothing", "");
            return;
        }
        self.late.tell(FromEar::Said(Box::new(spoken)));
    }

    /// What of it the robots are to hear: all, or what is said besides a stop.
    fn request(&self, recognition: Recognition, stops: bool) -> Option<Recognition> {
        if stops {
            return recognition_of_rest(&recognition, |text| self.at.talk.is_whole(text));
        }
        Some(recognition).filter(|recognition| !recognition.best().is_empty())
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
}
