//! The missions in a text: one alone, one a line, or many by name.

use std::{collections::BTreeMap, ops::ControlFlow};

use serde::de::IgnoredAny;

use super::{
    Checked, Problems,
    position::{Lines, Span, walk_while},
    problem::Pointer,
    read_mission,
};
use crate::catalog::Catalog;

/// Keys under which a record of a mission has the mission.
const MISSION_KEYS: [&str; 3] = ["cdf", "CDF", "mission"];

/// One mission in a text that may hold many.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Source<'t> {
    /// The file, as its reader names it.
    pub file: String,
    /// What the file calls the mission: its `id` or its key; none if the file is one mission.
    pub id: Option<String>,
    /// The mission alone.
    pub text: &'t str,
    /// Where it is in the file, or in its line of a file of lines.
    pub pointer: Pointer,
    /// Line and column of its beginning in the file, from 1.
    pub position: (usize, usize),
}

impl Source<'_> {
    /// Reads and checks the mission; problems point into the file.
    ///
    /// # Errors
    /// As [`read_mission`].
    pub fn read(&self, catalog: &Catalog) -> Result<Checked, Problems> {
        match read_mission(&self.file, self.text, catalog) {
            Ok(mut checked) => {
                self.place(&mut checked.warnings);
                Ok(checked)
            }
            Err(mut problems) => {
                self.place(&mut problems.0);
                Err(problems)
            }
        }
    }

    fn place(&self, problems: &mut [super::Problem]) {
        for problem in problems {
            problem.pointer = self.pointer.join(&problem.pointer);
            problem.position = problem.position.map(|(line, column)| {
                let before = if line == 1 { self.position.1 - 1 } else { 0 };
                (self.position.0 + line - 1, column + before)
            });
        }
    }
}

/// Finds the missions in a text: a mission file; records `{"cdf": {..}}`, one a line; or an object or list of records.
///
/// What is none of these is taken as one mission, so that reading it says what is wrong.
#[must_use]
pub fn sources<'t>(file: &str, text: &'t str) -> Vec<Source<'t>> {
    let body = text.trim_start_matches('\u{feff}');
    let whole = || vec![one(file, body, (1, 1))];
    if is_json(body) {
        return in_value(file, body, (1, 1)).unwrap_or_else(whole);
    }
    let lines: Vec<_> = body.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()).collect();
    // A mission with a slip in it has many lines, but not one that is JSON by itself and an object.
    let by_line = file.ends_with(".jsonl") || lines.iter().any(|(_, line)| line.starts_with('{') && is_json(line));
    if !by_line || lines.len() < 2 && !file.ends_with(".jsonl") {
        return whole();
    }
    let in_line = |(index, line): (usize, &'t str)| {
        let at = (index + 1, 1);
        let found = if is_json(line) { in_value(file, line, at) } else { None };
        found.unwrap_or_else(|| vec![one(file, line, at)])
    };
    lines.into_iter().flat_map(in_line).collect()
}

fn is_json(text: &str) -> bool {
    serde_json::from_str::<IgnoredAny>(text).is_ok()
}

fn one<'t>(file: &str, text: &'t str, position: (usize, usize)) -> Source<'t> {
    Source { file: file.to_owned(), id: None, text, pointer: Pointer::default(), position }
}

/// The missions in a JSON text that is a record of one, or holds such records; none if it is something else.
fn in_value<'t>(file: &str, text: &'t str, at: (usize, usize)) -> Option<Vec<Source<'t>>> {
    let mut has_scene = false;
    let mut own_id = None;
    let mut found: Vec<(String, Span)> = Vec::new();
    let mut ids: BTreeMap<String, String> = BTreeMap::new();
    walk_while(text, |path, depth, span| {
        // A mission may be of any size; that it is one is known as soon as its scene begins.
        has_scene |= path == "/scene" || path.starts_with("/scene/");
        if has_scene {
            return ControlFlow::Break(());
        }
        let (parent, key) = path.rsplit_once('/').unwrap_or_default();
        if depth <= 2 && MISSION_KEYS.contains(&key) && text[span.value.clone()].starts_with('{') {
            found.push((path.to_owned(), span));
        } else if depth <= 2 && key == "id" {
            let id = text[span.value].trim_matches('"').to_owned();
            if depth == 1 {
                own_id = Some(id);
            } else {
                ids.entry(parent.to_owned()).or_insert(id);
            }
        }
        ControlFlow::Continue(())
    });
    if has_scene || found.is_empty() {
        return None;
    }
    let lines = Lines::of(text);
    let sources = found.into_iter().map(|(path, span)| {
        let (parent, _) = path.rsplit_once('/').unwrap_or_default();
        let listed = ids.get(parent).cloned();
        let key = Pointer::of(parent.to_owned()).last();
        let id = if parent.is_empty() { own_id.clone() } else { listed.or(Some(key)) };
        let (line, column) = lines.position(span.value.start);
        let column = if line == 1 { column + at.1 - 1 } else { column };
        Source {
            file: file.to_owned(),
            id,
            text: &text[span.value],
            pointer: Pointer::of(path),
            position: (at.0 + line - 1, column),
        }
    });
    Some(sources.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Id, text, pointer and position of a source.
    type Found<'t> = (Option<&'t str>, &'t str, &'t str, (usize, usize));

    #[track_caller]
    fn check(file: &str, text: &str, expected: &[Found<'_>]) {
        let sources = sources(file, text);
        let found: Vec<_> = sources
            .iter()
            .map(|source| (source.id.as_deref(), source.text, source.pointer.as_str(), source.position))
            .collect();
        assert_eq!(found, expected);
    }

    #[test]
    fn missions_are_found_in_all_kinds_of_files() {
        let mission = "{\"scene\": {}}";
        check("m.json", mission, &[(None, mission, "", (1, 1))]);
        check("m.json", "{\"cdf\": 1}", &[(None, "{\"cdf\": 1}", "", (1, 1))]);
        check("m.json", "{\n \"oops\n}", &[(None, "{\n \"oops\n}", "", (1, 1))]);
        check("m.json", "", &[(None, "", "", (1, 1))]);
        let record = "{\"id\": \"a\", \"cdf\": {\"scene\": {}}}";
        check("m.json", record, &[(Some("a"), mission, "/cdf", (1, 20))]);
        check(
            "m.jsonl",
            &format!("{record}\n\n{mission}\n{{oops}}\n"),
            &[(Some("a"), mission, "/cdf", (1, 20)), (None, mission, "", (3, 1)), (None, "{oops}", "", (4, 1))],
        );
        check(
            "m.json",
            &format!("{{\"one\": {{\"x\": [],\n \"CDF\": {mission}}},\n\"two\": {{\"CDF\": {mission}}}}}"),
            &[(Some("one"), mission, "/one/CDF", (2, 9)), (Some("two"), mission, "/two/CDF", (3, 16))],
        );
        check("m.json", &format!("[{record}]"), &[(Some("a"), mission, "/0/cdf", (1, 21))]);
    }
}
