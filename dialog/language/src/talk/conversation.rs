//! The type of a turn, which knows all that stays the same during it. Each module beside it adds what it makes of an utterance.

use cohabit_cdf::Catalog;

use crate::{
    ground::{Ground, focus::Focus, judge::Judge},
    known::{Known, habits::Habits, process::Devices},
    plan::Planner,
    say::ask::Ask,
    words::lexicon::Lexicon,
};

/// Writes what an utterance may mean, given the lines before it (whether the robot said one, and what), the latest last, and what is around the robot
/// ([`crate::Language::surroundings`]): plain requests with `; ` between them, each with its probability, best first. `social` is talk that asks for
/// nothing, `none` what is nothing to a robot, `?` what nobody could tell.
pub type Rewrite = fn(&str, &[(bool, String)], &str) -> Vec<(String, f32)>;

/// All that stays the same during a turn.
#[derive(Clone, Copy)]
pub(crate) struct Conversation<'a> {
    pub(crate) catalog: &'a Catalog,
    pub(crate) lexicon: &'a Lexicon,
    pub(crate) devices: &'a Devices,
    pub(crate) habits: &'a Habits,
    pub(crate) scene: &'a Known,
    pub(crate) judge: Judge<'a>,
    pub(crate) rewriter: Option<Rewrite>,
}

impl Conversation<'_> {
    pub(crate) fn ask(&self) -> Ask<'_> {
        Ask { catalog: self.catalog, scene: self.scene }
    }

    pub(crate) fn planner(&self, focus: Focus) -> Planner<'_> {
        Planner::new(self.catalog, self.devices, self.habits, self.judge, self.scene, focus)
    }

    pub(crate) fn ground<'c>(&'c self, focus: &'c Focus) -> Ground<'c> {
        Ground { catalog: self.catalog, scene: self.scene, focus, judge: self.judge }
    }
}
