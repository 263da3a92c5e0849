//! Voice at the pages: who speaks there is heard, and what robots say is said aloud.
//!
//! Every page that speaks has a thread of its own ([`ear`]), and so has what is said aloud ([`mouth`]): nothing of the
//! page's server waits for recognition. The engines are opened once somebody speaks or wants to hear, and all pages share
//! them. Where there are none, text goes on, and pages are told how to get them.

mod ear;
mod echo;
mod mouth;

use std::{
    sync::{
        Arc, Mutex, MutexGuard, OnceLock, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    time::Duration,
};

use cohabit_bus::{Inbox, Topic, Transport, Wake, message::AudioView, process_of};
use cohabit_speech::{Bias, Engines, Recognition, Recognizer, SpeechError, Vad, VoiceSettings};
use serde_json::{Value, json};

pub use ear::{Audience, EarAt, FromEar, Hearing};
pub use mouth::Mouth;

use crate::{DialogError, page::Line};

/// The most ears at once: those of all pages, and some that are still at what a page sent before it left. Each has a place on
/// the bus.
const MOST_EARS: usize = 24;

/// Settings of voice.
#[derive(Clone, Debug)]
pub struct VoiceConfig {
    /// Which engines; why there are none, if not even that can be told.
    pub settings: Result<VoiceSettings, String>,
    /// The share of words that are heard wrong on purpose, 0 to 1, for studies.
    pub errors: f32,
    /// The seed of those errors.
    pub seed: u64,
    /// How much later than it could each turn is understood, for studies. Stop is never later.
    pub delay: Duration,
    /// How long what was heard can be changed before the robot hears it; zero where it hears it at once.
    pub edit: Duration,
    /// Whether the session's log holds what people say aloud: they are told.
    pub is_recorded: bool,
    /// Whether pages have a microphone.
    pub has_microphone: bool,
}

impl VoiceConfig {
    /// As a session has it if nothing is said, with these engines.
    #[must_use]
    pub fn new(settings: Result<VoiceSettings, String>) -> Self {
        Self {
            settings,
            errors: 0.0,
            seed: 0,
            delay: Duration::ZERO,
            edit: Duration::ZERO,
            is_recorded: false,
            has_microphone: true,
        }
    }

    /// What pages are told of it.
    pub fn json(&self) -> Value {
        json!({
            "edit_ms": self.edit.as_millis() as u64,
            "is_recorded": self.is_recorded,
            "has_microphone": self.has_microphone,
        })
    }
}

/// Voice of a session.
pub struct Voice {
    /// How it is set.
    pub config: VoiceConfig,
    bus: Arc<dyn Transport>,
    engines: OnceLock<Opened>,
    opening: Mutex<()>,
    /// How robots speak.
    mouth: Arc<Mouth>,
    /// Pages that want to hear robots.
    hearers: Arc<AtomicUsize>,
    /// Ears at work.
    ears: Arc<AtomicUsize>,
}

/// The engines that could be opened.
struct Opened {
    recognizer: Option<Shared>,
    /// One that nobody took yet; who comes later has one made.
    vad: Mutex<Option<Box<dyn Vad>>>,
    lacks: Vec<String>,
    speaks: bool,
}

/// One that is counted while it lives: a page that hears what robots say, or an ear.
pub struct Hearer(Arc<AtomicUsize>);

impl Drop for Hearer {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

/// A recogniser that all pages share, one turn at a time, with what is likely to be said as it was told last.
#[derive(Clone)]
struct Shared(Arc<Mutex<Told>>);

struct Told {
    recognizer: Box<dyn Recognizer>,
    bias: Option<Bias>,
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, Told> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Recognizer for Shared {
    fn bias(&mut self, bias: &Bias) {
        let mut told = self.lock();
        if told.bias.as_ref() != Some(bias) {
            told.recognizer.bias(bias);
            told.bias = Some(bias.clone());
        }
    }

    fn recognize(&mut self, samples: &[f32]) -> Result<Recognition, SpeechError> {
        self.lock().recognizer.recognize(samples)
    }

    fn partial(&mut self, samples: &[f32]) -> Result<Option<String>, SpeechError> {
        self.lock().recognizer.partial(samples)
    }

    fn name(&self) -> &str {
        "the session's recogniser"
    }
}

impl Voice {
    /// Voice that nobody has used yet; `tell` has all pages hear a message, `play` a piece of sound.
    pub fn new(
        bus: Arc<dyn Transport>,
        config: VoiceConfig,
        tell: impl Fn(&Value) + Send + Sync + 'static,
        play: impl Fn(Vec<u8>) + Send + Sync + 'static,
    ) -> Arc<Self> {
        let mouth = Mouth::new(Box::new(tell), Box::new(play));
        Arc::new(Self {
            config,
            bus,
            engines: OnceLock::new(),
            opening: Mutex::default(),
            mouth,
            hearers: Arc::default(),
            ears: Arc::default(),
        })
    }

    /// One more ear, unless there are too many.
    fn ear(&self) -> Option<Hearer> {
        let more = |ears: usize| (ears < MOST_EARS).then_some(ears + 1);
        self.ears.fetch_update(Ordering::Relaxed, Ordering::Relaxed, more).ok()?;
        Some(Hearer(Arc::clone(&self.ears)))
    }

    /// Opens the engines, if nobody has: that takes a second.
    fn opened(&self) -> &Opened {
        let _opening = self.opening.lock().unwrap_or_else(PoisonError::into_inner);
        self.engines.get_or_init(|| self.open())
    }

    fn open(&self) -> Opened {
        let settings = match &self.config.settings {
            Ok(settings) => settings,
            Err(why) => {
                return Opened { recognizer: None, vad: Mutex::default(), lacks: vec![why.clone()], speaks: false };
            }
        };
        let Engines { vad, recognizer, synthesizer, lacks } = Engines::open(settings);
        let lacks: Vec<String> = lacks.iter().map(ToString::to_string).collect();
        for lack in &lacks {
            tracing::info!("{lack}");
        }
        let speaks = synthesizer.is_some();
        if let Some(synthesizer) = synthesizer {
            self.mouth.open(synthesizer, &*self.bus);
        }
        let recognizer = recognizer.map(|recognizer| Shared(Arc::new(Mutex::new(Told { recognizer, bias: None }))));
        Opened { recognizer, vad: Mutex::new(Some(vad)), lacks, speaks }
    }

    /// Voice activity for one more page.
    fn vad(&self) -> Option<Box<dyn Vad>> {
        let opened = self.opened();
        let first = opened.vad.lock().unwrap_or_else(PoisonError::into_inner).take();
        first.or_else(|| {
            use cohabit_speech::Source::Off;
            let settings = self.config.settings.as_ref().ok()?;
            let alone = VoiceSettings { recognizer: Off, synthesizer: Off, folder: settings.folder.clone() };
            Some(Engines::open(&alone).vad)
        })
    }

    /// What pages are told of the engines: whether the service hears, whether it speaks, and what it lacks.
    pub fn told(&self) -> Value {
        let Opened { recognizer, lacks, speaks, .. } = self.opened();
        json!({ "type": "voice", "hears": recognizer.is_some(), "speaks": speaks, "lacks": lacks })
    }

    /// A page that wants to hear robots.
    pub fn hearer(&self) -> Hearer {
        self.hearers.fetch_add(1, Ordering::Relaxed);
        Hearer(Arc::clone(&self.hearers))
    }

    /// Says a line of a robot's aloud, if anybody hears it; what comes of that comes later.
    pub fn say(&self, line: &Line, body: u32) {
        if self.hearers.load(Ordering::Relaxed) > 0 {
            self.mouth.say(body, line.turn, &line.text);
        }
    }

    /// Passes on what others on the bus say aloud to the pages that hear robots, until `over`.
    pub fn pass_on(&self, over: &dyn Fn() -> bool) -> Result<(), DialogError> {
        let (mut listener, mut speech) = (self.bus.listener(Wake::Audio)?, Inbox::new(&*self.bus, Topic::Speech)?);
        while !over() {
            listener.wait(Duration::from_millis(200))?;
            while let Some((sample, ())) = speech.next(|sample| AudioView::new(sample.payload()).map(drop))? {
                let is_own = process_of(sample.envelope().run) == std::process::id();
                if !is_own && self.hearers.load(Ordering::Relaxed) > 0 {
                    self.mouth.pass_on(AudioView::new(sample.payload())?);
                }
            }
        }
        Ok(())
    }

    /// Has robots say no more of what they are saying.
    pub fn hush(&self) {
        self.mouth.hush();
    }

    /// A page says a text with a voice of its own, from now or until now.
    pub fn note_own_voice(&self, text: Option<&str>, nanos: u64) {
        self.mouth.note_own_voice(text, nanos);
    }
}

#[cfg(test)]
impl Voice {
    /// Voice with these engines.
    fn with(engines: Engines, config: VoiceConfig, bus: Arc<dyn Transport>) -> Arc<Self> {
        let voice = Self::new(bus, config, |_| (), |_| ());
        let Engines { vad, recognizer, synthesizer, .. } = engines;
        let speaks = synthesizer.is_some();
        if let Some(synthesizer) = synthesizer {
            voice.mouth.open(synthesizer, &*voice.bus);
        }
        let recognizer = recognizer.map(|recognizer| Shared(Arc::new(Mutex::new(Told { recognizer, bias: None }))));
        let opened = Opened { recognizer, vad: Mutex::new(Some(vad)), lacks: Vec::new(), speaks };
        assert!(voice.engines.set(opened).is_ok());
        voice
    }
}
