//! Voices that speak to the robot: Piper's, and espeak-ng's.

use std::ops::ControlFlow;

use anyhow::{Context as _, bail};
use cohabit_speech::{Engines, RATE, Synthesizer, VoiceSettings, from_pcm, resample};

/// What is quieter than this share of the loudest is no speech.
const QUIET: f32 = 0.03;

/// A voice, and its name.
pub struct Voice {
    pub name: &'static str,
    synthesizer: Box<dyn Synthesizer>,
}

/// Something spoken.
#[derive(Clone)]
pub struct Saying {
    pub voice: &'static str,
    pub text: &'static str,
    /// At 16 kHz.
    pub samples: Vec<f32>,
    /// Where speech begins and ends in them.
    pub first: usize,
    pub last: usize,
}

/// All voices; an error where voice is not installed.
pub fn all() -> anyhow::Result<Vec<Voice>> {
    let installed = Engines::open(&VoiceSettings::from_env()?);
    if let Some(lack) = installed.lacks.first() {
        bail!("no voice is installed here (`cohabit voice install`): {lack}");
    }
    let piper = installed.synthesizer.context("nothing is installed that speaks")?;
    // Where there is no model, espeak-ng speaks with its own voice.
    let espeak = Engines::open(&VoiceSettings::installed(std::env::temp_dir().join("cohabit-no-voice"))).synthesizer;
    let espeak = espeak.context("espeak-ng is not installed")?;
    Ok(vec![Voice { name: "Piper", synthesizer: piper }, Voice { name: "espeak-ng", synthesizer: espeak }])
}

impl Voice {
    /// Speaks a text.
    pub fn say(&mut self, text: &'static str) -> anyhow::Result<Saying> {
        let mut pcm = Vec::new();
        self.synthesizer.speak(text, &mut |chunk| {
            pcm.extend(chunk);
            ControlFlow::Continue(())
        })?;
        let samples = resample(&from_pcm(&pcm), self.synthesizer.rate(), RATE)?;
        let peak = samples.iter().fold(0.0f32, |peak, sample| peak.max(sample.abs()));
        let is_loud = |sample: &f32| sample.abs() > peak * QUIET;
        let first = samples.iter().position(is_loud).unwrap_or(0);
        let last = samples.iter().rposition(is_loud).unwrap_or(0);
        Ok(Saying { voice: self.name, text, samples, first, last })
    }
}
