//! What a log notes of its session, beside what is told on the bus.

use std::ffi::OsString;

use cohabit_bus::CameraId;
use cohabit_engine::CameraPlan;
use cohabit_record::{Branch, SessionFacts};

use crate::build;

/// What a log notes of its session besides what is told on the bus.
#[derive(clap::Args, Clone, Default)]
pub struct Noted {
    /// What the participant is called in the study, for the log: a label, not a name
    #[arg(long, value_name = "LABEL", value_parser = label)]
    pub participant: Option<String>,
    /// How the session is played, for the log; as often as needed
    #[arg(long = "setting", hide = true, value_name = "NAME=VALUE", value_parser = setting)]
    pub settings: Vec<(String, String)>,
    /// A camera of the session, for the log; as often as needed
    #[arg(long = "camera", hide = true)]
    pub cameras: Vec<CameraPlan>,
    /// A camera whose frames are recorded, too; as often as needed
    #[arg(long = "record-frames", value_name = "CAMERA")]
    pub frames: Vec<CameraId>,
    /// Record what people and robots say aloud
    #[arg(long = "record-audio", hide = true)]
    pub audio: bool,
    /// The session that it goes on from, for the log
    #[arg(long, hide = true, value_parser = branch)]
    pub branched: Option<Branch>,
}

/// How the settings of a log that hold the names of bodies begin; the body's number follows.
pub const NAME_OF: &str = "name.";

/// What a participant may be called.
pub fn label(text: &str) -> Result<String, String> {
    const LONGEST: usize = 64;
    let fits = !text.trim().is_empty() && text.len() <= LONGEST && !text.chars().any(char::is_control);
    if fits { Ok(text.to_owned()) } else { Err(format!("one to {LONGEST} bytes of text on one line")) }
}

fn setting(text: &str) -> Result<(String, String), String> {
    let parts = text.split_once('=').ok_or("NAME=VALUE")?;
    Ok((parts.0.to_owned(), parts.1.to_owned()))
}

/// The end of [`Noted::arguments`]' last argument, read back.
fn branch(text: &str) -> Result<Branch, String> {
    let read = || {
        let (tick, rest) = text.split_once(',')?;
        let (run, session) = rest.split_once(',')?;
        let run = u64::from_str_radix(run, 16).ok()?;
        Some(Branch { session: session.to_owned(), run, tick: tick.parse().ok()? })
    };
    read().ok_or_else(|| "TICK,RUN,SESSION".to_owned())
}

impl Noted {
    /// The same as arguments of another process.
    pub fn arguments(&self) -> Vec<OsString> {
        let participant = self.participant.iter().map(|label| format!("--participant={label}"));
        let settings = self.settings.iter().map(|(name, value)| format!("--setting={name}={value}"));
        let cameras = self.cameras.iter().map(|camera| format!("--camera={camera}"));
        let frames = self.frames.iter().map(|camera| format!("--record-frames={camera}"));
        let branched = self.branched.iter();
        let branched = branched.map(|branch| format!("--branched={},{:x},{}", branch.tick, branch.run, branch.session));
        let audio = self.audio.then(|| "--record-audio".to_owned());
        participant
            .chain(settings)
            .chain(cameras)
            .chain(frames)
            .chain(audio)
            .chain(branched)
            .map(OsString::from)
            .collect()
    }

    /// The same for the log of a session of that name.
    pub fn facts(&self, session: &str) -> SessionFacts {
        SessionFacts {
            session: session.to_owned(),
            build: build::id().unwrap_or_default(),
            participant: self.participant.clone(),
            settings: self.settings.iter().cloned().collect(),
            cameras: self.cameras.iter().map(ToString::to_string).collect(),
            frames: self.frames.clone(),
            audio: self.audio,
            branched: self.branched.clone(),
        }
    }
}
