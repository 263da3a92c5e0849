//! The table of sessions: how each was played, and what came of it.

use std::{borrow::Cow, collections::BTreeSet};

use crate::{
    answers,
    played::{Played, seconds},
    table::{
        Cell, Field,
        Kind::{Flag, Real, Text, Whole},
        Table,
    },
};

const FIELDS: [Field; 24] = [
    Field::new("session", Text, "", "the session, by the name of its log"),
    Field::new("participant", Text, "", "what the participant is called in the study, or the pair that plays together"),
    Field::new("mission", Text, "", "the mission's file"),
    Field::new("layout", Text, "", "the mission's floor plan"),
    Field::new("seed", Text, "", "the seed of all that was random"),
    Field::new("program", Text, "", "the version of the program that recorded it"),
    Field::new("began_ns", Whole, "ns", "wall time of its first tick, since 1970"),
    Field::new("duration_s", Real, "s", "simulated time; a session that goes on from another one contains its time"),
    Field::new("branched_s", Real, "s", "simulated time at which it goes on from another one; nothing if from none"),
    Field::new("problems", Text, "", "what its log lacks, line by line: what follows is then of what is left"),
    Field::new("success", Flag, "", "whether every goal was met"),
    Field::new("goals", Whole, "", "goals of the mission"),
    Field::new("goals_met", Whole, "", "those of them that were met in the end"),
    Field::new("turns", Whole, "", "what people said"),
    Field::new("questions", Whole, "", "what the robot asked"),
    Field::new("actions", Whole, "", "commands that the robot was given; of several those that are spoken to"),
    Field::new("failed_actions", Whole, "", "those of them that failed"),
    Field::new("other_actions", Whole, "", "commands that other bodies were given, but for those of held keys"),
    Field::new("answered_ms", Real, "ms", "wall time from words to the first answer or question, mean over turns"),
    Field::new("understood_ms", Real, "ms", "wall time from words to the plan, mean over turns with one"),
    Field::new("moved_ms", Real, "ms", "wall time from words to the first motion, mean over turns with one"),
    Field::new("framed_ms", Real, "ms", "wall time from words to the first frame with it, mean over turns with one"),
    Field::new("shown_ms", Real, "ms", "wall time from words until a page showed it, mean over turns with one"),
    Field::new("bodies", Whole, "", "bodies beside those of the mission"),
];

/// All settings that any of these sessions notes.
pub fn settings(played: &[Played]) -> BTreeSet<&str> {
    played.iter().flat_map(|played| played.log.session.settings.keys().map(String::as_str)).collect()
}

/// All of these sessions.
pub fn table(played: &[Played]) -> Table {
    let settings = settings(played);
    let setting = |name: &&str| Field {
        name: Cow::Owned(format!("setting_{name}")),
        kind: Text,
        unit: "",
        meaning: Cow::Owned(format!("how it was played: what its log notes as `{name}`")),
    };
    let scored = answers::scored(played);
    let score = |name: &&str| Field {
        name: Cow::Owned(format!("score_{name}")),
        kind: Real,
        unit: "",
        meaning: Cow::Owned(format!("what the questionnaire {name} amounts to, 0 to 100, mean over persons")),
    };
    let row = |played: &Played| {
        let own = |name: &&str| Cell::maybe(played.log.session.settings.get(*name), Cell::text);
        let score = |name: &&str| Cell::maybe(played.score(name), Cell::Real);
        row(played).into_iter().chain(settings.iter().map(own)).chain(scored.iter().map(score)).collect()
    };
    Table {
        name: "sessions",
        meaning: "a session, as its log tells it",
        fields: FIELDS.into_iter().chain(settings.iter().map(setting)).chain(scored.iter().map(score)).collect(),
        rows: played.iter().map(row).collect(),
    }
}

fn row(played: &Played) -> Vec<Cell> {
    let session = &played.log.session;
    let others = played.actions.len() - played.robots_actions().count();
    let latency = |which: Latency| Cell::maybe(played.mean_ms(which), Cell::Real);
    vec![
        Cell::text(&played.name),
        Cell::maybe(session.participant.as_ref(), Cell::text),
        Cell::text(&session.mission_file),
        Cell::text(&played.mission.layout),
        // More bits than programs of statistics read exactly.
        Cell::text(session.seed.to_string()),
        Cell::text(&session.program),
        Cell::maybe(played.log.ticks.first(), |tick| Cell::whole(tick.wall_nanos)),
        Cell::Real(seconds(played.ticks())),
        Cell::maybe(session.branched.as_ref(), |branch| Cell::Real(seconds(branch.tick))),
        Cell::text(played.log.problems().join("\n")),
        Cell::maybe(played.success(), Cell::Flag),
        Cell::whole(played.goals.len()),
        Cell::whole(played.goals_met()),
        Cell::whole(played.turns.len()),
        Cell::whole(played.questions()),
        Cell::whole(played.robots_actions().count()),
        Cell::whole(played.failed_actions()),
        Cell::whole(others),
        latency(Latency::Answered),
        latency(Latency::Understood),
        latency(Latency::Moved),
        latency(Latency::Framed),
        latency(Latency::Shown),
        Cell::whole(session.bodies.len()),
    ]
}

/// A moment after a person's words.
#[derive(Clone, Copy, Debug)]
pub enum Latency {
    /// The first answer or question.
    Answered,
    /// The plan.
    Understood,
    /// The first motion.
    Moved,
    /// The first frame in which that is seen.
    Framed,
    /// A page shows it.
    Shown,
}

impl Played {
    /// How long it took on average, over the turns in which it came about, ms.
    pub(crate) fn mean_ms(&self, which: Latency) -> Option<f64> {
        let of_turn = |turn: &crate::played::Turn| {
            let [understood, moved, framed, shown] = turn.latencies_ms();
            match which {
                Latency::Answered => turn.answered_ms(),
                Latency::Understood => understood,
                Latency::Moved => moved,
                Latency::Framed => framed,
                Latency::Shown => shown,
            }
        };
        let all: Vec<f64> = self.turns.iter().filter_map(of_turn).collect();
        (!all.is_empty()).then(|| all.iter().sum::<f64>() / all.len() as f64)
    }

    /// How many of its goals were met in the end.
    #[must_use]
    pub fn goals_met(&self) -> usize {
        self.goals.iter().filter(|goal| goal.met).count()
    }

    pub(crate) fn questions(&self) -> usize {
        self.turns.iter().map(|turn| turn.questions.len()).sum()
    }

    pub(crate) fn failed_actions(&self) -> usize {
        let failed =
            |deed: &&crate::played::Deed| deed.outcome.as_ref().is_some_and(|(_, status, _)| status.is_failure());
        self.robots_actions().filter(failed).count()
    }
}
