//! The data card: how the set was made, what it has, and what its files and fields are.

use crate::{recipe::Recipe, summary::Summary};

/// What the files and fields are.
const FILES: &str = include_str!("../data/card.md");

/// How much there is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Counts<'a> {
    pub missions: usize,
    pub left_out: usize,
    /// Episodes, steps, questions and frames.
    pub summary: &'a Summary,
}

/// The card of a data set.
pub(crate) fn text(recipe: &Recipe, counts: Counts<'_>) -> String {
    let [width, height] = recipe.lens().size();
    let modalities: Vec<&str> = recipe.planes().iter().map(|plane| plane.name()).collect();
    let pictures = if modalities.is_empty() {
        "none".to_owned()
    } else {
        format!("{width}x{height} pixels, {}", modalities.join(", "))
    };
    let rows = [
        ("made by", format!("`cohabit demonstrate` {}", env!("CARGO_PKG_VERSION"))),
        ("seed", recipe.seed().to_string()),
        ("missions", format!("{}, of which {} are left out", counts.missions, counts.left_out)),
        ("episodes", counts.summary.episodes.to_string()),
        ("steps", counts.summary.steps.to_string()),
        ("questions", counts.summary.questions.to_string()),
        ("frames", counts.summary.frames.to_string()),
        ("pictures", pictures),
        ("licence", "that of the missions; what is drawn are the program's own models".to_owned()),
    ];
    let rows: String = rows.iter().map(|(name, value)| format!("| {name} | {value} |\n")).collect();
    format!("# Demonstrations\n\n| | |\n|---|---|\n{rows}\n{FILES}")
}
