//! Voice: how a session hears and speaks.

use std::time::Duration;

use cohabit_dialog::{VoiceConfig, VoiceSettings};

/// How people are heard, and how what they say is kept: settings of a session.
#[derive(clap::Args, Clone, Copy, Debug)]
pub struct VoiceOptions {
    /// How long what was heard can be changed on the page before the robot hears it, in seconds; 0 has it hear at once
    #[arg(long, value_name = "SECONDS", default_value_t = 1.2, value_parser = seconds)]
    edit_heard: f32,
    /// Have this share of the words heard wrong on purpose, 0 to 1: for studies of what that does
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, value_parser = share)]
    voice_errors: f32,
    /// Have what is said understood so many seconds later than it could be: for studies. Stop is never later
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0, value_parser = seconds)]
    voice_delay: f32,
    /// Record what people and robots say aloud in the log, which people agreed to; without this no sound is kept
    #[arg(long)]
    pub record_audio: bool,
}

/// The longest that anything is put off, s.
const LONGEST_S: f32 = 60.0;

fn share(text: &str) -> Result<f32, String> {
    let share = text.parse().ok().filter(|share| (0.0..=1.0).contains(share));
    share.ok_or_else(|| "a share of all words, from 0 to 1, such as 0.1".to_owned())
}

fn seconds(text: &str) -> Result<f32, String> {
    let seconds = text.parse().ok().filter(|seconds| (0.0..=LONGEST_S).contains(seconds));
    seconds.ok_or_else(|| format!("seconds, from 0 to {LONGEST_S}, such as 1.5"))
}

impl VoiceOptions {
    /// The same as arguments of another process.
    pub fn arguments(self) -> Vec<String> {
        let named = [
            ("--edit-heard", self.edit_heard),
            ("--voice-errors", self.voice_errors),
            ("--voice-delay", self.voice_delay),
        ];
        let named = named.into_iter().flat_map(|(name, value)| [name.to_owned(), value.to_string()]);
        named.chain(self.record_audio.then(|| "--record-audio".to_owned())).collect()
    }

    /// The same as the log has it.
    pub fn settings(self) -> [(&'static str, String); 4] {
        let yes_or_no = |is: bool| if is { "yes" } else { "no" }.to_owned();
        [
            ("edit_heard_s", self.edit_heard.to_string()),
            ("record_audio", yes_or_no(self.record_audio)),
            ("voice_delay_s", self.voice_delay.to_string()),
            ("voice_errors", self.voice_errors.to_string()),
        ]
    }

    /// The same as the dialog service has it, with the engines that the environment names.
    pub fn config(self, seed: u64) -> VoiceConfig {
        VoiceConfig {
            errors: self.voice_errors,
            seed,
            delay: Duration::from_secs_f32(self.voice_delay),
            edit: Duration::from_secs_f32(self.edit_heard),
            is_recorded: self.record_audio,
            ..VoiceConfig::new(VoiceSettings::from_env().map_err(|error| error.to_string()))
        }
    }
}
