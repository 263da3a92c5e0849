//! How answers are held back: for a constant delay, and for a wizard.

use std::{fmt, time::Duration};

use clap::ValueEnum;
use cohabit_dialog::{Holding, MOMENT, OnTimeout, Phrase, PlannedError, WizardSettings};

/// The longest that anything is waited for, s.
const LONGEST_S: f64 = 600.0;

/// How answers are held back.
#[derive(clap::Args, Clone)]
pub struct WizardOptions {
    /// Whether a wizard (Wizard of Oz) decides what the robot answers, at a page of their own whose address is printed:
    /// what people say is understood as ever, and proposed
    #[arg(long, value_name = "YES|NO", default_value_t)]
    pub wizard: TakesPart,
    /// How long a wizard may take to decide, s; as long as they like, if absent
    #[arg(long, alias = "wizard_timeout_s", value_name = "SECONDS", value_parser = seconds)]
    pub wizard_timeout_s: Option<f64>,
    /// What follows when a wizard has not decided in time: the robot does what it proposed (`act`), says that it takes a
    /// moment (`say`) and goes on waiting, or only goes on waiting (`wait`)
    #[arg(long, alias = "wizard_on_timeout", value_name = "WHAT", requires = "wizard_timeout_s")]
    pub wizard_on_timeout: Option<OnTimeout>,
    /// What the robot says at a time-out with `say`
    #[arg(long, value_name = "TEXT", default_value = MOMENT)]
    pub wizard_moment: String,
    /// What a wizard can have the robot say by a key, such as `h=Hello!`; with `h:wait=` what was proposed waits on; as often as
    /// needed
    #[arg(long = "wizard-phrase", value_name = "KEY=TEXT")]
    pub wizard_phrases: Vec<Phrase>,
    /// An error that a wizard can have the robot make, as JSON, such as `{"name": "wrong object", "do": "pick up the apple"}`: with
    /// `say`, what it says; with `step`, the step of the proposed plan, from 1, that is replaced; as often as needed
    #[arg(long = "wizard-error", value_name = "JSON")]
    pub wizard_errors: Vec<PlannedError>,
    /// How long after they were received words are answered, ms, with a wizard and without: a constant delay; a stop is never
    /// delayed
    #[arg(long, alias = "response_delay_ms", value_name = "MILLISECONDS", default_value_t = 0, value_parser = clap::value_parser!(u64).range(0..=60_000))]
    pub response_delay_ms: u64,
}

/// Whether a wizard takes part.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq, ValueEnum)]
pub enum TakesPart {
    /// The robot answers by itself.
    #[default]
    No,
    /// A wizard decides.
    Yes,
}

impl fmt::Display for TakesPart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::No => "no",
            Self::Yes => "yes",
        })
    }
}

fn seconds(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|seconds: &f64| *seconds > 0.0 && *seconds <= LONGEST_S);
    seconds.ok_or_else(|| format!("a number of seconds above 0, up to {LONGEST_S}"))
}

impl WizardOptions {
    /// What robots hold back, and who decides of it.
    pub fn holding(&self) -> Holding {
        let wizard = (self.wizard == TakesPart::Yes).then(|| WizardSettings {
            timeout: self.wizard_timeout_s.map(Duration::from_secs_f64),
            on_timeout: self.wizard_on_timeout.unwrap_or_default(),
            moment: self.wizard_moment.clone(),
            phrases: self.wizard_phrases.clone(),
            errors: self.wizard_errors.clone(),
        });
        Holding { delay: Duration::from_millis(self.response_delay_ms), wizard }
    }

    /// The same as arguments of another process.
    pub fn arguments(&self) -> impl Iterator<Item = String> {
        let timeout = self.wizard_timeout_s.map(|seconds| format!("--wizard-timeout-s={seconds}"));
        let on_timeout = self.wizard_on_timeout.map(|what| format!("--wizard-on-timeout={what}"));
        let phrases: Vec<String> =
            self.wizard_phrases.iter().map(|phrase| format!("--wizard-phrase={phrase}")).collect();
        let errors: Vec<String> = self.wizard_errors.iter().map(|error| format!("--wizard-error={error}")).collect();
        let whole = [
            format!("--wizard={}", self.wizard),
            format!("--wizard-moment={}", self.wizard_moment),
            format!("--response-delay-ms={}", self.response_delay_ms),
        ];
        whole.into_iter().chain(timeout).chain(on_timeout).chain(phrases).chain(errors)
    }

    /// The same, for the log.
    pub fn settings(&self) -> impl Iterator<Item = (&'static str, String)> {
        let takes_part = self.wizard == TakesPart::Yes;
        let both = [("response_delay_ms", self.response_delay_ms.to_string()), ("wizard", self.wizard.to_string())];
        let timeout = self.wizard_timeout_s.filter(|_| takes_part);
        let timeout = timeout.map(|seconds| {
            [
                ("wizard_timeout_s", seconds.to_string()),
                ("wizard_on_timeout", self.wizard_on_timeout.unwrap_or_default().to_string()),
            ]
        });
        both.into_iter().chain(timeout.into_iter().flatten())
    }
}
