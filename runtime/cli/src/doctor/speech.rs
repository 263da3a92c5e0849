//! What a session hears and speaks with.

use cohabit_speech::{Engines, Lack, Part, VoiceSettings};

use super::{finding::Finding, machine::Machine};

const COSTS: &str = "people type what they could say, or read what could be heard";

/// Whether speech is turned into text, and text into speech. The engines are opened for that: what is broken shows.
pub fn voice(machine: &Machine) -> Finding {
    match &machine.voice {
        Ok(settings) => judge(&Engines::open(settings), settings),
        Err(problem) => Finding::costs(problem.as_str(), COSTS, "set the variable that it names, or unset it"),
    }
}

fn judge(engines: &Engines, settings: &VoiceSettings) -> Finding {
    let hears = engines.recognizer.as_ref().map(|recognizer| format!("hears with {}", recognizer.name()));
    let speaks = engines.synthesizer.as_ref().map(|synthesizer| format!("speaks with {}", synthesizer.name()));
    let found = match (hears, speaks) {
        (None, None) => "neither hears nor speaks".to_owned(),
        (Some(one), None) | (None, Some(one)) => one,
        (Some(hears), Some(speaks)) => format!("{hears}, {speaks}"),
    };
    // What matters most is told: without text there is no speech to tell from noise.
    let matters = |lack: &&Lack| lack.part != Part::VoiceActivity;
    match engines.lacks.iter().find(matters).or(engines.lacks.first()) {
        None => Finding::good(format!("{found} ({})", settings.folder.display())),
        Some(lack) => {
            let costs = if matters(&lack) { COSTS } else { "noise is more often taken for speech" };
            Finding::costs(format!("{found}; {lack}"), costs, lack.remedy.as_str())
        }
    }
}
