//! Tutorials: missions in which a participant tries one thing after the other, and goes on once each was tried.
//!
//! What is to be tried is data: the list of a tutorial's block, or the usual one, in the language of the study. Whether something was tried
//! is told by the session, never by the page.

use cohabit_dialog::PageTexts;
use serde::{Deserialize, Serialize};

/// Something that a tutorial has its participants try.
#[derive(Clone, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub struct Exercise {
    /// What counts as tried.
    pub what: Activity,
    /// What they read.
    pub text: String,
}

/// What a participant does in a session, as far as tutorials go.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Activity {
    /// Sends a message that the robot takes.
    Say,
    /// Clicks on a thing in the picture.
    Point,
    /// Answers a question of the robot.
    Answer,
    /// Stops the robot.
    Stop,
    /// Meets a goal of the mission.
    Goal,
    /// Walks as an avatar.
    Move,
    /// Turns, or looks up or down, as an avatar.
    Look,
}

/// An exercise that was tried.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Tried {
    /// Which of the tutorial's, from 0.
    pub exercise: usize,
    /// When, ms since 1970.
    pub at_ms: u64,
}

impl Activity {
    const ALL: [Self; 7] = [Self::Say, Self::Point, Self::Answer, Self::Stop, Self::Goal, Self::Move, Self::Look];

    /// Their names.
    pub const NAMES: [&'static str; 7] = [
        Self::ALL[0].name(),
        Self::ALL[1].name(),
        Self::ALL[2].name(),
        Self::ALL[3].name(),
        Self::ALL[4].name(),
        Self::ALL[5].name(),
        Self::ALL[6].name(),
    ];

    /// As a study's file and tables have it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Say => "say",
            Self::Point => "point",
            Self::Answer => "answer",
            Self::Stop => "stop",
            Self::Goal => "goal",
            Self::Move => "move",
            Self::Look => "look",
        }
    }

    /// The one that is called so.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|one| one.name() == name)
    }

    /// Whether it takes an avatar.
    #[must_use]
    pub const fn needs_avatar(self) -> bool {
        matches!(self, Self::Move | Self::Look)
    }
}

/// The exercises of a tutorial that has no list of its own: what every mission allows, under all settings.
#[must_use]
pub fn usual(texts: &PageTexts) -> Vec<Exercise> {
    let all = [
        (Activity::Say, texts.study_text("exercise_say")),
        (Activity::Point, texts.study_text("exercise_point")),
        (Activity::Stop, texts.study_text("exercise_stop")),
        (Activity::Goal, texts.study_text("exercise_goal")),
    ];
    all.into_iter().map(|(what, text)| Exercise { what, text: text.to_owned() }).collect()
}

/// The exercises, by number, that these activities tick and that were not tried before.
#[must_use]
pub fn ticked(exercises: &[Exercise], tried: &[Tried], activities: &[Activity]) -> Vec<usize> {
    let is_new = |number: &usize| !tried.iter().any(|one| one.exercise == *number);
    let is_done = |number: &usize| activities.contains(&exercises[*number].what);
    (0..exercises.len()).filter(is_new).filter(is_done).collect()
}

#[cfg(test)]
mod tests {
    use cohabit_dialog::languages;

    use super::*;

    #[test]
    fn the_usual_exercises_need_nothing_of_a_study() {
        for language in languages() {
            let all = usual(&PageTexts::of(language).expect("it ships"));
            let named: Vec<&str> = all.iter().map(|one| one.what.name()).collect();
            assert_eq!(named, ["say", "point", "stop", "goal"]);
            assert!(all.iter().all(|one| !one.text.trim().is_empty() && !one.what.needs_avatar()));
        }
    }

    #[test]
    fn names_are_read_as_they_are_written() {
        for activity in Activity::ALL {
            assert_eq!(Activity::named(activity.name()), Some(activity));
            assert_eq!(serde_json::to_value(activity).expect("JSON"), activity.name());
        }
        assert_eq!((Activity::named("jump"), Activity::NAMES[6]), (None, "look"));
    }

    #[test]
    fn an_exercise_is_ticked_once() {
        let exercise = |what| Exercise { what, text: "Try.".to_owned() };
        let exercises = [Activity::Say, Activity::Stop, Activity::Goal].map(exercise);
        let check = |tried: &[usize], activities: &[Activity], expected: &[usize]| {
            let tried: Vec<Tried> = tried.iter().map(|exercise| Tried { exercise: *exercise, at_ms: 5 }).collect();
            assert_eq!(ticked(&exercises, &tried, activities), expected, "{tried:?} {activities:?}");
        };
        check(&[], &[], &[]);
        check(&[], &[Activity::Say, Activity::Say], &[0]);
        check(&[], &[Activity::Goal, Activity::Say], &[0, 2]);
        check(&[0], &[Activity::Say, Activity::Stop], &[1]);
        check(&[], &[Activity::Point, Activity::Move], &[]);
    }
}
