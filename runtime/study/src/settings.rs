//! Settings: what makes a condition. Most are flags of `cohabit play`; a few are of the study's own pages.

use std::collections::BTreeMap;

use cohabit_dialog::{OnTimeout, questionnaire_text};
use serde::{Deserialize, Serialize};

use crate::wizard::Wizard;

/// Settings, by name.
pub type Settings = BTreeMap<String, Setting>;

/// The value of a setting.
#[derive(Clone, Debug, Deserialize, Eq, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Setting {
    /// Whether it is there.
    Switch(bool),
    /// Its value.
    Value(String),
    /// Its values, one after the other.
    Values(Vec<String>),
}

/// Shows the score while a mission is played.
pub const SCORE: &str = "score";
/// Shows how much of a mission's time is left.
pub const CLOCK: &str = "clock";
/// The settings that are of the study's pages and no flags of `cohabit play`: true or false, false if absent.
pub const OF_PAGES: [&str; 2] = [SCORE, CLOCK];
/// Those of these in which the two of a pair can differ: their session is the same.
pub const OF_OWN_PAGE: [&str; 1] = [CLOCK];
/// The setting by which a wizard takes part: `yes`, or `no`.
pub const WIZARD: &str = "wizard";
/// The setting by which answers are delayed, ms, and how it may be written, too.
pub const RESPONSE_DELAY: [&str; 2] = ["response-delay-ms", "response_delay_ms"];
/// The setting by which there are further bodies.
pub const BODY: &str = "body";
/// The setting that says whom people may drive.
pub const DRIVE: &str = "drive";
/// The setting that says when the robot asks.
pub const ASK: &str = "ask";
/// The flag of `cohabit play` that keeps what people say.
pub const RECORD_AUDIO: &str = "record-audio";

/// The setting by which bodies get minds, some of which go by a file: `scripted@1=walk.txt`.
const AGENT: &str = "agent";
/// The setting by which the page of a session asks something: questionnaires that ship, or files.
const QUESTIONNAIRE: &str = "questionnaire";

/// The files that a setting names.
#[must_use]
pub fn files(name: &str, setting: &Setting) -> Vec<String> {
    let values: &[String] = match setting {
        Setting::Switch(_) => &[],
        Setting::Value(value) => std::slice::from_ref(value),
        Setting::Values(values) => values,
    };
    let file = |value: &String| match name {
        AGENT => value.split_once('=').map(|(_, file)| file.to_owned()),
        QUESTIONNAIRE => questionnaire_text(value).is_none().then(|| value.clone()),
        _ => None,
    };
    values.iter().filter_map(file).collect()
}

/// These settings with others on top.
#[must_use]
pub fn merged(all: &[&Settings]) -> Settings {
    all.iter().flat_map(|settings| settings.iter().map(|(name, value)| (name.clone(), value.clone()))).collect()
}

/// Whether a switch is on.
#[must_use]
pub fn is_on(settings: &Settings, name: &str) -> bool {
    settings.get(name) == Some(&Setting::Switch(true))
}

/// Whether a wizard takes part.
#[must_use]
pub fn has_wizard(settings: &Settings) -> bool {
    settings.get(WIZARD) == Some(&Setting::Value("yes".to_owned()))
}

/// How many avatars there are.
#[must_use]
pub fn avatars(settings: &Settings) -> usize {
    let is_person = |body: &&String| body.split('@').next() == Some("person");
    match settings.get(BODY) {
        Some(Setting::Value(body)) => usize::from(is_person(&body)),
        Some(Setting::Values(bodies)) => bodies.iter().filter(is_person).count(),
        _ => 0,
    }
}

/// Whether people may drive all bodies.
#[must_use]
pub fn drives_all(settings: &Settings) -> bool {
    settings.get(DRIVE) == Some(&Setting::Value("all".to_owned()))
}

/// Whether participants have a body to walk with: an avatar, or any, where people may drive all.
#[must_use]
pub fn has_avatar(settings: &Settings) -> bool {
    match settings.get(DRIVE) {
        Some(Setting::Value(whom)) if whom == "none" => false,
        _ => drives_all(settings) || avatars(settings) > 0,
    }
}

/// Whether the robot asks anything at all.
#[must_use]
pub fn may_ask(settings: &Settings) -> bool {
    settings.get(ASK) != Some(&Setting::Value("never".to_owned()))
}

/// How long after they were received words are answered at the earliest, ms.
#[must_use]
pub fn response_delay_ms(settings: &Settings) -> u64 {
    let set = RESPONSE_DELAY.iter().find_map(|name| settings.get(*name));
    match set {
        Some(Setting::Value(value)) => value.parse().unwrap_or(0),
        _ => 0,
    }
}

/// How a wizard takes part, as arguments of `cohabit play`.
fn wizard_arguments(wizard: &Wizard) -> Vec<String> {
    let Wizard { timeout_s, on_timeout, moment, phrases, errors } = wizard;
    let timeout = timeout_s.map(|seconds| format!("--wizard-timeout-s={seconds}"));
    let follows = timeout_s.map(|_| format!("--wizard-on-timeout={on_timeout}"));
    let moment =
        moment.as_ref().filter(|_| *on_timeout == OnTimeout::Say).map(|text| format!("--wizard-moment={text}"));
    let phrases = phrases.iter().map(|phrase| format!("--wizard-phrase={phrase}"));
    let errors = errors.iter().map(|error| format!("--wizard-error={error}"));
    timeout.into_iter().chain(follows).chain(moment).chain(phrases).chain(errors).collect()
}

/// Those of the settings that are flags of `cohabit play`, as its arguments.
#[must_use]
pub fn arguments(settings: &Settings) -> Vec<String> {
    let of_flag = |(name, setting): (&String, &Setting)| match setting {
        Setting::Switch(false) => Vec::new(),
        Setting::Switch(true) => vec![format!("--{name}")],
        Setting::Value(value) => vec![format!("--{name}={value}")],
        Setting::Values(values) => values.iter().map(|value| format!("--{name}={value}")).collect(),
    };
    settings.iter().filter(|(name, _)| !OF_PAGES.contains(&name.as_str())).flat_map(of_flag).collect()
}

/// The arguments of a participant's session under these settings, with a wizard who takes part so if one does. Who did not agree
/// to be heard has no microphone, and no sound is kept; figures for developers are shown to nobody.
#[must_use]
pub fn session_arguments(settings: &Settings, agrees_to_audio: bool, wizard: &Wizard) -> Vec<String> {
    let mut allowed = settings.clone();
    allowed.retain(|name, _| agrees_to_audio || name != RECORD_AUDIO);
    let hidden = [("figures", true), ("microphone", !agrees_to_audio), ("score", !is_on(settings, SCORE))];
    let hidden = hidden.into_iter().filter(|(_, is_hidden)| *is_hidden).map(|(part, _)| format!("--hide={part}"));
    let wizard = if has_wizard(settings) { wizard_arguments(wizard) } else { Vec::new() };
    arguments(&allowed).into_iter().chain(hidden).chain(wizard).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> Setting {
        Setting::Value(text.to_owned())
    }

    #[test]
    fn settings_are_flags() {
        let settings = Settings::from([
            ("ask".to_owned(), value("never")),
            ("body".to_owned(), Setting::Values(vec!["person".to_owned(), "robot@Lab1".to_owned()])),
            ("lock-step".to_owned(), Setting::Switch(false)),
            ("tls".to_owned(), Setting::Switch(true)),
            ("clock".to_owned(), Setting::Switch(true)),
        ]);
        assert_eq!(arguments(&settings), ["--ask=never", "--body=person", "--body=robot@Lab1", "--tls"]);
        let over = Settings::from([("ask".to_owned(), value("always"))]);
        assert_eq!(arguments(&merged(&[&settings, &over]))[0], "--ask=always");
    }

    #[test]
    fn who_can_walk_and_be_asked_follows_from_settings() {
        let settings = |all: &[(&str, Setting)]| -> Settings {
            all.iter().map(|(name, setting)| ((*name).to_owned(), setting.clone())).collect()
        };
        let bodies = Setting::Values(vec!["robot".to_owned(), "person@Lab1".to_owned()]);
        for (all, expected) in [
            (settings(&[]), false),
            (settings(&[(BODY, value("person"))]), true),
            (settings(&[(BODY, value("robot"))]), false),
            (settings(&[(BODY, bodies.clone())]), true),
            (settings(&[(BODY, bodies), (DRIVE, value("none"))]), false),
            (settings(&[(DRIVE, value("all"))]), true),
        ] {
            assert_eq!(has_avatar(&all), expected, "{all:?}");
        }
        let two = Setting::Values(["person", "robot", "person@Lab1"].map(str::to_owned).to_vec());
        assert_eq!((avatars(&settings(&[(BODY, two)])), avatars(&settings(&[(DRIVE, value("all"))]))), (2, 0));
        assert!(may_ask(&settings(&[])) && !may_ask(&settings(&[(ASK, value("never"))])));
    }

    #[test]
    fn only_sessions_with_a_wizard_are_told_how_one_takes_part() {
        let phrase = "h=Hello!".parse().expect("a phrase");
        let wizard = Wizard {
            timeout_s: Some(8.0),
            on_timeout: OnTimeout::Say,
            moment: Some("Hm.".to_owned()),
            phrases: vec![phrase],
            errors: vec![r#"{"name":"forgets","say":"Oh."}"#.parse().expect("a planned error")],
        };
        let with = |takes_part: &str| {
            let settings = Settings::from([
                (WIZARD.to_owned(), value(takes_part)),
                ("response_delay_ms".to_owned(), value("1500")),
            ]);
            assert_eq!((has_wizard(&settings), response_delay_ms(&settings)), (takes_part == "yes", 1500));
            session_arguments(&settings, true, &wizard)
        };
        let own = ["--response_delay_ms=1500", "--wizard=no", "--hide=figures", "--hide=score"];
        assert_eq!(with("no"), own);
        let seat = [
            "--wizard-timeout-s=8",
            "--wizard-on-timeout=say",
            "--wizard-moment=Hm.",
            "--wizard-phrase=h=Hello!",
            r#"--wizard-error={"name":"forgets","say":"Oh."}"#,
        ];
        assert_eq!(with("yes")[4..], seat);
    }

    #[test]
    fn participants_see_and_are_heard_by_no_more_than_the_study_and_they_agreed_to() {
        let check = |settings: &[(&str, bool)], agrees: bool, expected: &[&str]| {
            let switch = |(name, is_on): &(&str, bool)| ((*name).to_owned(), Setting::Switch(*is_on));
            let settings = settings.iter().map(switch).collect();
            assert_eq!(session_arguments(&settings, agrees, &Wizard::default()), expected, "{settings:?}");
        };
        check(&[], false, &["--hide=figures", "--hide=microphone", "--hide=score"]);
        check(&[("score", true), ("clock", true)], false, &["--hide=figures", "--hide=microphone"]);
        check(&[("score", false)], true, &["--hide=figures", "--hide=score"]);
        check(&[("record-audio", true)], false, &["--hide=figures", "--hide=microphone", "--hide=score"]);
        check(&[("record-audio", true)], true, &["--record-audio", "--hide=figures", "--hide=score"]);
    }
}
