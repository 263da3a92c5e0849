//! The data card of a converted set: how it was made, what it has, and what its files and fields are.

use std::fs;

use crate::{Counts, native::Dataset};

/// The card of a set in a format, with what its files are; the card of the set that it was made from follows.
pub(crate) fn text(dataset: &Dataset, counts: &Counts, format: &str, files: &str) -> String {
    let recipe = &dataset.recipe;
    let ([width, height], program) = (recipe.size, env!("CARGO_PKG_VERSION"));
    let pictures = if recipe.modalities.is_empty() {
        "none".to_owned()
    } else {
        format!("{width}x{height} pixels, {}", recipe.modalities.join(", "))
    };
    let rows = [
        ("format", format.to_owned()),
        ("made by", format!("`cohabit demonstrate` {}, and `cohabit convert` {program}", recipe.program)),
        ("seed", recipe.seed.to_string()),
        ("missions", format!("{}, of which {} are left out", recipe.missions, dataset.left_out)),
        ("BLAKE3 of the missions", format!("`{}`", recipe.missions_blake3)),
        ("episodes", counts.episodes.to_string()),
        ("samples", counts.samples.to_string()),
        ("files of samples", counts.files.to_string()),
        ("pictures", pictures),
        ("licence", "that of the missions; what is drawn are the program's own models".to_owned()),
    ];
    let rows: String = rows.iter().map(|(name, value)| format!("| {name} | {value} |\n")).collect();
    // The card is no part of what is converted: a data set is whole without it.
    let native = fs::read_to_string(dataset.folder.join("README.md")).unwrap_or_default();
    format!(
        "# Demonstrations as {format}\n\n| | |\n|---|---|\n{rows}\n{files}\n# The data set that this was made from\n\n{native}"
    )
}
