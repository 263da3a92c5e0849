//! The table of turns: what people said, and what came of it.

use crate::{
    played::{Played, Turn, seconds},
    table::{
        Cell, Field,
        Kind::{Real, Text, Whole},
        Table,
    },
};

const FIELDS: [Field; 23] = [
    Field::new("session", Text, "", "the session, as in the table of sessions"),
    Field::new("turn", Whole, "", "the turn: counts what people said in the session, from 1"),
    Field::new("body", Whole, "", "the body that was spoken to"),
    Field::new("person", Whole, "", "the number of the page at which it was said; 0 where that was not noted"),
    Field::new("tick", Whole, "", "the newest tick when it was said"),
    Field::new("time_s", Real, "s", "simulated time when it was said"),
    Field::new("said", Text, "", "what was said"),
    Field::new("replies", Text, "", "what the robot said to it, line by line"),
    Field::new("questions", Text, "", "what the robot asked, line by line"),
    Field::new("question_count", Whole, "", "how many questions the robot asked"),
    Field::new("steps", Whole, "", "steps of the plans that were made of it"),
    Field::new("actions", Whole, "", "commands that the robot was given for it"),
    Field::new("failed_actions", Whole, "", "those of them that failed"),
    Field::new("ended", Text, "", "the status that its last plan ended with; nothing where no plan was made"),
    Field::new("answered_ms", Real, "ms", "wall time from its words to the first answer or question"),
    Field::new("understood_ms", Real, "ms", "wall time from its words to its plan"),
    Field::new("moved_ms", Real, "ms", "wall time from its words to the robot's first motion"),
    Field::new("framed_ms", Real, "ms", "wall time from its words to the first frame in which that motion is seen"),
    Field::new("shown_ms", Real, "ms", "wall time from its words until a page showed that frame, or a later one"),
    Field::new("heard", Text, "", "what it sounded like before it was made sense of; nothing where it was typed"),
    Field::new("speech_s", Real, "s", "how long it took to say; nothing where it was typed"),
    Field::new("heard_ms", Real, "ms", "wall time from the end of speech to its words; nothing where it was typed"),
    Field::new(
        "sounded_ms",
        Real,
        "ms",
        "wall time from its words to the first sound of an answer that was said aloud",
    ),
];

/// All turns of these sessions.
pub fn table(played: &[Played]) -> Table {
    let rows = played.iter().flat_map(|played| played.turns.iter().map(|turn| row(played, turn)));
    Table {
        name: "turns",
        meaning: "something that a person said to the robot",
        fields: FIELDS.into(),
        rows: rows.collect(),
    }
}

fn row(played: &Played, turn: &Turn) -> Vec<Cell> {
    let own = || played.robots_actions().filter(|deed| deed.turn == turn.number);
    let failed = own().filter(|deed| deed.outcome.as_ref().is_some_and(|(_, status, _)| status.is_failure()));
    let [understood, moved, framed, shown] = turn.latencies_ms().map(|ms| Cell::maybe(ms, Cell::Real));
    vec![
        Cell::text(&played.name),
        Cell::whole(turn.number),
        Cell::whole(turn.body),
        Cell::whole(turn.person),
        Cell::whole(turn.tick),
        Cell::Real(seconds(turn.tick)),
        Cell::text(&turn.said),
        Cell::text(turn.replies.join("\n")),
        Cell::text(turn.questions.join("\n")),
        Cell::whole(turn.questions.len()),
        Cell::whole(turn.plan.len()),
        Cell::whole(own().count()),
        Cell::whole(failed.count()),
        Cell::maybe(turn.ended, |status| Cell::text(format!("{status:?}"))),
        Cell::maybe(turn.answered_ms(), Cell::Real),
        understood,
        moved,
        framed,
        shown,
        Cell::text(&turn.heard),
        Cell::maybe(turn.speech_s(), Cell::Real),
        Cell::maybe(turn.heard_ms(), Cell::Real),
        Cell::maybe(turn.sounded_ms(), Cell::Real),
    ]
}
