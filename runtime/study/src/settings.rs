//! Settings: what makes a condition. Most are flags of `cohabit play`; a few are of the study's own pages.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

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
/// The flag of `cohabit play` that keeps what people say.
pub const RECORD_AUDIO: &str = "record-audio";

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

/// The arguments of a participant's session under these settings. Who did not agree to be heard has no microphone, and no
/// sound is kept; figures for developers are shown to nobody.
#[must_use]
pub fn session_arguments(settings: &Settings, agrees_to_audio: bool) -> Vec<String> {
    let mut allowed = settings.clone();
    allowed.retain(|name, _| agrees_to_audio || name != RECORD_AUDIO);
    let hidden = [("figures", true), ("microphone", !agrees_to_audio), ("score", !is_on(settings, SCORE))];
    let hidden = hidden.into_iter().filter(|(_, is_hidden)| *is_hidden).map(|(part, _)| format!("--hide={part}"));
    arguments(&allowed).into_iter().chain(hidden).collect()
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
    fn participants_see_and_are_heard_by_no_more_than_the_study_and_they_agreed_to() {
        let check = |settings: &[(&str, bool)], agrees: bool, expected: &[&str]| {
            let switch = |(name, is_on): &(&str, bool)| ((*name).to_owned(), Setting::Switch(*is_on));
            let settings = settings.iter().map(switch).collect();
            assert_eq!(session_arguments(&settings, agrees), expected, "{settings:?}");
        };
        check(&[], false, &["--hide=figures", "--hide=microphone", "--hide=score"]);
        check(&[("score", true), ("clock", true)], false, &["--hide=figures", "--hide=microphone"]);
        check(&[("score", false)], true, &["--hide=figures", "--hide=score"]);
        check(&[("record-audio", true)], false, &["--hide=figures", "--hide=microphone", "--hide=score"]);
        check(&[("record-audio", true)], true, &["--record-audio", "--hide=figures", "--hide=score"]);
    }
}
