//! What comes of a study, all at once: beside its tables, the summary by condition, plots, a script, and the methods sheet.

use std::{collections::BTreeSet, path::Path};

use cohabit_study::{Progress, is_of_excluded, is_practice, settings::OF_PAGES};
use cohabit_tables::Played;

use super::report::Report;
use crate::summing::write_summary;

/// The methods sheet's file.
const SHEET: &str = "methods.md";

/// What sessions are compared by: the settings that make the levels of factors; their missions, if there are none.
fn compared_by(study: &cohabit_study::Study) -> Vec<String> {
    let levels = study.factors.iter().flat_map(|factor| &factor.levels);
    let names = levels.flat_map(|level| level.settings.keys()).filter(|name| !OF_PAGES.contains(&name.as_str()));
    let names: BTreeSet<String> = names.map(|name| name.replace('-', "_")).collect();
    if names.is_empty() { vec!["mission".to_owned()] } else { names.into_iter().collect() }
}

/// Writes it into the folder `out`, of the sessions that were read from a study's `folder`, without those for practice and those of
/// participants who were excluded.
pub fn write(
    study: &cohabit_study::Study,
    progress: &[Progress],
    mut played: Vec<Played>,
    folder: &Path,
    out: &Path,
) -> anyhow::Result<()> {
    played.retain(|one| !is_practice(progress, &one.name) && !is_of_excluded(progress, &one.name));
    if played.is_empty() {
        println!("note: no session was played yet, so there is no summary");
    } else {
        write_summary(&played, &compared_by(study), out)?;
    }
    Report { folder: folder.to_owned(), out: Some(out.join(SHEET)) }.run()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn studies_are_compared_by_their_factors_or_by_missions() {
        let by = |name: &str| {
            let path = format!("{}/../study/studies/{name}.toml", env!("CARGO_MANIFEST_DIR"));
            compared_by(&crate::study::read(path.as_ref()).expect("a study that ships").1)
        };
        assert_eq!(by("search"), ["ask", "knows"]);
        assert_eq!(by("wizard"), ["wizard"]);
        assert_eq!(by("paper"), ["mission"]);
    }
}
