//! The engines that a machine has.

use std::{
    fmt,
    path::{Path, PathBuf},
};

use crate::{
    Recognizer, SpeechError, Synthesizer, Vad,
    earshot::Earshot,
    espeak::Espeak,
    install, model, moonshine, onnx,
    piper::{self, Piper},
    silero::Silero,
    wyoming::Wyoming,
};

/// Where an engine comes from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Source {
    /// What is installed in the data folder.
    #[default]
    Installed,
    /// A folder with another model: of recognisers a Moonshine or a Whisper, which is told by what lies in it.
    Folder(PathBuf),
    /// A server that speaks the Wyoming protocol: host and port.
    Wyoming(String),
    /// Nothing.
    Off,
}

impl Source {
    /// Reads `installed`, `off`, `wyoming://host:port`, or a folder.
    ///
    /// # Errors
    /// [`SpeechError::Setting`] for an address without a port.
    pub fn parse(text: &str) -> Result<Self, SpeechError> {
        match text.split_once("://") {
            Some(("wyoming" | "tcp", address)) if has_port(address) => Ok(Self::Wyoming(address.to_owned())),
            Some(_) => Err(SpeechError::Setting {
                given: text.to_owned(),
                remedy: "an address is wyoming://host:port, as in wyoming://127.0.0.1:10300",
            }),
            None => Ok(match text {
                "" | "installed" => Self::Installed,
                "off" => Self::Off,
                folder => Self::Folder(PathBuf::from(folder)),
            }),
        }
    }
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Installed => f.write_str("installed"),
            Self::Folder(folder) => write!(f, "{}", folder.display()),
            Self::Wyoming(address) => write!(f, "wyoming://{address}"),
            Self::Off => f.write_str("off"),
        }
    }
}

fn has_port(address: &str) -> bool {
    address.rsplit_once(':').is_some_and(|(host, port)| !host.is_empty() && port.parse::<u16>().is_ok())
}

/// Which engines are to be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VoiceSettings {
    /// Where models are installed.
    pub folder: PathBuf,
    /// What turns speech into text.
    pub recognizer: Source,
    /// What turns text into speech.
    pub synthesizer: Source,
}

impl VoiceSettings {
    /// What is installed in a folder.
    #[must_use]
    pub fn installed(folder: impl Into<PathBuf>) -> Self {
        Self { folder: folder.into(), recognizer: Source::Installed, synthesizer: Source::Installed }
    }

    /// What the environment says: `COHABIT_VOICE` (the data folder), `COHABIT_RECOGNIZER` and `COHABIT_SYNTHESIZER`, as
    /// [`Source::parse`] reads them.
    ///
    /// # Errors
    /// [`SpeechError::Setting`] for a source that means nothing, or where no folder can be told.
    pub fn from_env() -> Result<Self, SpeechError> {
        let source = |name: &str| Source::parse(&std::env::var(name).unwrap_or_default());
        Ok(Self {
            folder: folder_from_env()?,
            recognizer: source("COHABIT_RECOGNIZER")?,
            synthesizer: source("COHABIT_SYNTHESIZER")?,
        })
    }
}

/// `$COHABIT_VOICE`, else `$XDG_DATA_HOME/cohabit/voice`, else `~/.local/share/cohabit/voice`.
fn folder_from_env() -> Result<PathBuf, SpeechError> {
    let named = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    let data = || named("XDG_DATA_HOME").or_else(|| named("HOME").map(|home| home.join(".local/share")));
    named("COHABIT_VOICE").or_else(|| data().map(|data| data.join("cohabit/voice"))).ok_or(SpeechError::Setting {
        given: "COHABIT_VOICE".into(),
        remedy: "name a folder for the models; there is no HOME either",
    })
}

/// A part of voice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Telling speech from all else.
    VoiceActivity,
    /// Speech to text.
    Recognition,
    /// Text to speech.
    Synthesis,
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::VoiceActivity => "voice activity",
            Self::Recognition => "speech recognition",
            Self::Synthesis => "speech synthesis",
        })
    }
}

/// What is not there, or not as good as it could be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lack {
    /// Of what.
    pub part: Part,
    /// Why it could not be opened, and the remedy.
    pub why: String,
    /// The remedy alone.
    pub remedy: String,
    /// What there is instead.
    pub instead: String,
}

impl Lack {
    fn of(part: Part, error: &SpeechError, instead: &str) -> Self {
        let [remedy, instead] = [error.remedy(), instead].map(str::to_owned);
        Self { part, why: error.to_string(), remedy, instead }
    }
}

impl fmt::Display for Lack {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: failed to {}. Instead: {}", self.part, self.why, self.instead)
    }
}

/// The engines that could be opened.
pub struct Engines {
    /// Tells speech from all else; there is always one.
    pub vad: Box<dyn Vad>,
    /// Turns speech into text, if anything can.
    pub recognizer: Option<Box<dyn Recognizer>>,
    /// Turns text into speech, if anything can.
    pub synthesizer: Option<Box<dyn Synthesizer>>,
    /// What could not be opened, and why.
    pub lacks: Vec<Lack>,
}

impl Engines {
    /// Opens what there is; it takes a second where models are loaded.
    #[must_use]
    pub fn open(settings: &VoiceSettings) -> Self {
        let mut lacks = Vec::new();
        let vad = vad(settings, &mut lacks);
        let recognizer = recognizer(settings).unwrap_or_else(|error| {
            lacks.push(Lack::of(Part::Recognition, &error, "text alone"));
            None
        });
        let synthesizer = synthesizer(settings, &mut lacks);
        Self { vad, recognizer, synthesizer, lacks }
    }
}

/// That what is installed of a part is what was installed; of the runtime too, before it is loaded.
fn whole(folder: &Path, part: &str) -> Result<(), SpeechError> {
    let runtime = if onnx::is_loaded() { None } else { install::damaged(folder, "runtime/") };
    match runtime.or_else(|| install::damaged(folder, part)) {
        Some(path) => Err(SpeechError::Broken {
            why: "it is damaged, or another file than was installed".into(),
            remedy: onnx::remedy(&path),
            path,
        }),
        None => Ok(()),
    }
}

fn vad(settings: &VoiceSettings, lacks: &mut Vec<Lack>) -> Box<dyn Vad> {
    match whole(&settings.folder, "silero/").and_then(|()| Silero::open(&settings.folder)) {
        Ok(silero) => Box::new(silero),
        Err(error) => {
            let instead = "a simpler detector, which takes more noise for speech";
            lacks.push(Lack::of(Part::VoiceActivity, &error, instead));
            Box::new(Earshot::new())
        }
    }
}

fn recognizer(settings: &VoiceSettings) -> Result<Option<Box<dyn Recognizer>>, SpeechError> {
    let library = settings.folder.join(onnx::LIBRARY);
    match &settings.recognizer {
        Source::Installed => {
            let folder = settings.folder.join(moonshine::FOLDER);
            whole(&settings.folder, "moonshine/")?;
            Ok(Some(model::open(&folder, &library, THREADS)?))
        }
        Source::Folder(folder) => {
            whole(&settings.folder, "runtime/")?;
            Ok(Some(model::open(folder, &library, THREADS).map_err(|error| of_folder(error, folder, EXPORT))?))
        }
        Source::Wyoming(address) => Ok(Some(Box::new(Wyoming::open(address)?))),
        Source::Off => Ok(None),
    }
}

/// What is wrong in a folder of the user's own is not mended by installing, least of all by deleting it.
fn of_folder(error: SpeechError, folder: &Path, remedy: &str) -> SpeechError {
    match error {
        SpeechError::Missing { path, .. } if path.starts_with(folder) => {
            SpeechError::Missing { path, remedy: remedy.into() }
        }
        SpeechError::Broken { path, why, .. } if path.starts_with(folder) => {
            SpeechError::Broken { path, why, remedy: remedy.into() }
        }
        other => other,
    }
}

fn synthesizer(settings: &VoiceSettings, lacks: &mut Vec<Lack>) -> Option<Box<dyn Synthesizer>> {
    let piper = |folder: &Path, part: &str| {
        whole(&settings.folder, part)?;
        Piper::open(folder, &settings.folder.join(onnx::LIBRARY), THREADS)
    };
    let opened: Result<Box<dyn Synthesizer>, SpeechError> = match &settings.synthesizer {
        Source::Off => return None,
        Source::Wyoming(address) => Wyoming::open(address).map(|server| Box::new(server) as _),
        Source::Installed => piper(&settings.folder.join(piper::FOLDER), "piper/").map(|piper| Box::new(piper) as _),
        Source::Folder(folder) => piper(folder, "runtime/")
            .map(|piper| Box::new(piper) as _)
            .map_err(|error| of_folder(error, folder, OWN_VOICE)),
    };
    let error = match opened {
        Ok(synthesizer) => return Some(synthesizer),
        Err(error) => error,
    };
    let espeak = Espeak::open();
    let instead = if espeak.is_ok() { "espeak-ng's own voice" } else { "the browser's own voice, where it has one" };
    lacks.push(Lack::of(Part::Synthesis, &error, instead));
    espeak.ok().map(|espeak| Box::new(espeak) as _)
}

/// A model at work leaves the simulator a core of the two that there are.
const THREADS: usize = 1;

/// How a file is said to be got of a folder with another recogniser.
const EXPORT: &str = "COHABIT_RECOGNIZER names a folder with a Moonshine or Whisper model, as `optimum-cli export onnx` writes \
                      it; without it, what is installed is used";

/// And of one with another voice.
const OWN_VOICE: &str = "COHABIT_SYNTHESIZER names a folder with a Piper voice, its .onnx and its .onnx.json; without it, what \
                         is installed is used";

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn sources_are_read() {
        let check = |text: &str, expected: Source| assert_eq!(Source::parse(text).unwrap(), expected, "{text}");
        check("", Source::Installed);
        check("off", Source::Off);
        check("wyoming://localhost:10300", Source::Wyoming("localhost:10300".into()));
        check("tcp://[::1]:10300", Source::Wyoming("[::1]:10300".into()));
        check("/models/whisper", Source::Folder("/models/whisper".into()));
        for wrong in ["wyoming://localhost", "wyoming://:1", "http://localhost:1", "tcp://a:99999"] {
            assert!(Source::parse(wrong).unwrap_err().to_string().contains(wrong), "{wrong}");
        }
    }
}
