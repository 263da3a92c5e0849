//! The exercises of tutorials: what participants are to try, and whether they can.

use std::ops::Range;

use cohabit_cdf::mission::Pointer;
use toml::Spanned;

use super::Checking;
use crate::{
    design::{Block, Condition, Study},
    settings::{has_avatar, may_ask},
    tutorial::{Activity, Exercise, usual},
    written::{WrittenBlock, WrittenExercise},
};

impl Checking<'_, '_> {
    /// Those of a tutorial: its own, or the usual ones.
    pub(super) fn exercises(&mut self, block: &WrittenBlock, at: &Pointer) -> Vec<Exercise> {
        let Some(written) = &block.exercise else { return usual(&self.texts) };
        let mut found: Vec<Exercise> = Vec::new();
        for (index, exercise) in written.iter().enumerate() {
            let Some((exercise, span)) = exercise_of(exercise.get_ref()) else { continue };
            if found.iter().any(|one| one.what == exercise.what) {
                let message = format!("`{}` is there twice, and one try ticks both", exercise.what.name());
                let place = at.key("exercise").item(index).key("what");
                self.findings.add(span, &place, message, "make one exercise of them");
            } else {
                found.push(exercise);
            }
        }
        found
    }

    /// Says which exercises nobody can try under the settings of their block.
    pub(super) fn can_be_tried(&mut self, study: &Study, blocks: &[(Range<usize>, Pointer)]) {
        for (block, (span, at)) in study.blocks.iter().zip(blocks) {
            let Block::Mission { exercises, .. } = block else { continue };
            let settings = study.settings_of(block, &Condition::default(), &Condition::default());
            for exercise in exercises {
                let (message, remedy) = match exercise.what {
                    what if what.needs_avatar() && !has_avatar(&settings) => (
                        "and participants have no body",
                        "add `body = \"person\"` to the settings of this block, or leave the exercise out",
                    ),
                    Activity::Answer if !may_ask(&settings) => (
                        "and the robot asks nothing",
                        "add `ask = \"unsure\"` to the settings of this block, or leave the exercise out",
                    ),
                    _ => continue,
                };
                let message = format!("`{}` is to be tried, {message}", exercise.what.name());
                self.findings.add(span.clone(), &at.key("exercise"), message, remedy);
            }
        }
    }
}

/// An exercise that is whole, and where it says what is tried.
fn exercise_of(written: &WrittenExercise) -> Option<(Exercise, Range<usize>)> {
    let (what, text): (&Spanned<String>, &Spanned<String>) = (written.what.as_ref()?, written.text.as_ref()?);
    let activity = Activity::named(what.get_ref())?;
    Some((Exercise { what: activity, text: text.get_ref().clone() }, what.span()))
}
