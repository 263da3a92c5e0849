//! Finds tasks in the files that people have.

use std::{
    collections::BTreeSet,
    io,
    path::{Path, PathBuf},
};

use serde::Deserialize;
use serde_json::Value;

use crate::{
    dataset, script,
    task::{Line, Task},
};

/// Why tasks could not be read.
#[derive(Debug, thiserror::Error)]
pub enum SourceError {
    /// A file or folder cannot be read.
    #[error("{path}: {source}")]
    File {
        /// Which.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A line is not what it should be.
    #[error("{path}:{line}: {reason}")]
    Line {
        /// Which file.
        path: PathBuf,
        /// Which line, from 1.
        line: usize,
        /// What is wrong.
        reason: String,
    },
    /// There is nothing to play.
    #[error(
        "{path}: no missions in it; give a .jsonl of missions, a data set of sessions, a mission (CDF) or a folder of missions, each with a .script"
    )]
    Empty {
        /// Which.
        path: PathBuf,
    },
    /// A mission has no script.
    #[error("{path}: nothing says what to do in it; put {} beside it, or name one with `--script`", .script.display())]
    NoScript {
        /// Which.
        path: PathBuf,
        /// What would be read.
        script: PathBuf,
    },
    /// Two tasks have one name.
    #[error("{path}: two missions are named {id}")]
    Twice {
        /// Where.
        path: PathBuf,
        /// The name.
        id: String,
    },
}

/// One line of a `.jsonl`.
#[derive(Deserialize)]
struct MissionLine {
    id: String,
    #[serde(default)]
    preparation_utterances: Vec<String>,
    utterances: Option<Vec<String>>,
    /// What a person answers who is asked about each of these, in their order; nobody answers, if it is absent.
    answers: Option<Vec<String>>,
    cdf: Value,
}

/// What is to be said in missions.
#[derive(Clone, Copy)]
enum Scripts<'a> {
    /// A mission has this script, or else its own; missions of a folder have their own, or else this one.
    Needed(Option<&'a Path>),
    /// Nothing is said.
    Ignored,
}

/// The tasks of `path`: a `.jsonl` of missions with their utterances, the reference's data set of sessions, a mission
/// (CDF) with its script, or a folder of missions with scripts. `script` takes the place of a mission's own; in a folder it is for
/// missions that have none.
///
/// # Errors
/// [`SourceError`].
pub fn read_tasks(path: &Path, script: Option<&Path>) -> Result<Vec<Task>, SourceError> {
    read_with(path, Scripts::Needed(script))
}

/// The same without what is said in them, for who plays them from their goals alone: missions need neither scripts nor
/// utterances, and one for which several people have words is one task.
///
/// # Errors
/// [`SourceError`].
pub fn read_missions(path: &Path) -> Result<Vec<Task>, SourceError> {
    read_with(path, Scripts::Ignored)
}

fn read_with(path: &Path, script: Scripts<'_>) -> Result<Vec<Task>, SourceError> {
    let tasks = if path.is_dir() {
        missions_in(path)?
            .iter()
            .map(|mission| with_script(mission, of_folder(mission, script)))
            .collect::<Result<_, _>>()?
    } else if path.extension().is_some_and(|extension| extension == "jsonl") {
        lines(path, &read(path)?, script)?
    } else {
        let text = read(path)?;
        match serde_json::from_str::<Value>(&text) {
            Ok(value) if value.get("scene").is_some() || !value.is_object() => vec![with_script(path, script)?],
            Ok(_) => match script {
                Scripts::Needed(_) => dataset::read(&text),
                Scripts::Ignored => dataset::missions(&text),
            }
            .map_err(|error| at_line(path, error.line(), &error))?,
            Err(error) => return Err(at_line(path, error.line(), &error)),
        }
    };
    if tasks.is_empty() {
        return Err(SourceError::Empty { path: path.to_owned() });
    }
    let mut ids = BTreeSet::new();
    match tasks.iter().find(|task| !ids.insert(&task.id)) {
        Some(task) => Err(SourceError::Twice { path: path.to_owned(), id: task.id.clone() }),
        None => Ok(tasks),
    }
}

fn at_line(path: &Path, line: usize, reason: &impl ToString) -> SourceError {
    SourceError::Line { path: path.to_owned(), line, reason: reason.to_string() }
}

fn read(path: &Path) -> Result<String, SourceError> {
    std::fs::read_to_string(path).map_err(|source| SourceError::File { path: path.to_owned(), source })
}

fn lines(path: &Path, text: &str, scripts: Scripts<'_>) -> Result<Vec<Task>, SourceError> {
    let filled = (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty());
    filled
        .map(|(number, line)| {
            let read: MissionLine = serde_json::from_str(line).map_err(|error| at_line(path, number, &error))?;
            let said = |texts: &[String]| texts.iter().map(|text| Line::utterance(text)).collect();
            let script = match (&read.utterances, scripts) {
                (_, Scripts::Ignored) => Vec::new(),
                (Some(utterances), Scripts::Needed(_)) => {
                    spoken(utterances, read.answers.as_deref()).map_err(|reason| at_line(path, number, &reason))?
                }
                (None, Scripts::Needed(_)) => {
                    return Err(at_line(path, number, &"nothing says what to do in it: it has no \"utterances\""));
                }
            };
            Ok(Task {
                id: read.id,
                family: None,
                cdf: read.cdf.to_string(),
                preparation: said(&read.preparation_utterances),
                script,
            })
        })
        .collect()
}

/// What is said, each with what a person answers who is asked about it; what is wrong with that, in words.
fn spoken(utterances: &[String], answers: Option<&[String]>) -> Result<Vec<Line>, String> {
    let Some(answers) = answers else { return Ok(utterances.iter().map(|text| Line::utterance(text)).collect()) };
    if answers.len() != utterances.len() {
        let (answers, utterances) = (answers.len(), utterances.len());
        return Err(format!("{answers} \"answers\" for {utterances} \"utterances\": one for each"));
    }
    Ok(utterances.iter().zip(answers).map(|(text, answer)| Line::answered(text, answer)).collect())
}

/// The mission files of a folder, by name.
fn missions_in(folder: &Path) -> Result<Vec<PathBuf>, SourceError> {
    let failed = |source| SourceError::File { path: folder.to_owned(), source };
    let entries = std::fs::read_dir(folder).map_err(failed)?;
    let mut paths = entries.map(|entry| Ok(entry.map_err(failed)?.path())).collect::<Result<Vec<_>, _>>()?;
    // What commands write beside the missions that they make is no mission itself.
    let is_manifest = |path: &PathBuf| path.file_name().is_some_and(|name| name == "manifest.json");
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "json") && !is_manifest(path));
    paths.sort();
    Ok(paths)
}

/// What is said in a mission of a folder: its own script counts before the one that is named.
fn of_folder<'a>(mission: &Path, scripts: Scripts<'a>) -> Scripts<'a> {
    match scripts {
        Scripts::Needed(Some(_)) if mission.with_extension("script").is_file() => Scripts::Needed(None),
        scripts => scripts,
    }
}

fn with_script(mission: &Path, scripts: Scripts<'_>) -> Result<Task, SourceError> {
    let id = mission.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let Scripts::Needed(script) = scripts else {
        return Ok(Task { id, family: None, cdf: read(mission)?, preparation: Vec::new(), script: Vec::new() });
    };
    let own = mission.with_extension("script");
    let path = match script {
        Some(script) => script.to_owned(),
        None if own.is_file() => own,
        None => return Err(SourceError::NoScript { path: mission.to_owned(), script: own }),
    };
    let (preparation, script) = script::read(&read(&path)?).map_err(|(line, reason)| at_line(&path, line, &reason))?;
    Ok(Task { id, family: None, cdf: read(mission)?, preparation, script })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn a_line_has_what_its_person_answers() {
        let line =
            |answers: &str| format!("{{\"id\": \"a\", \"utterances\": [\"take the apple\"], {answers}\"cdf\": {{}}}}");
        let read = |answers: &str| lines(Path::new("a.jsonl"), &line(answers), Scripts::Needed(None));
        let script = read("\"answers\": [\"the red one\"], ").unwrap().remove(0).script;
        assert_eq!(script, [Line::answered("take the apple", "the red one")]);
        assert_eq!(read("").unwrap().remove(0).script, [Line::utterance("take the apple")]);
        let error = read("\"answers\": [], ").unwrap_err().to_string();
        assert_eq!(error, "a.jsonl:1: 0 \"answers\" for 1 \"utterances\": one for each");
    }

    #[test]
    fn a_script_that_is_named_counts_for_a_mission_and_in_a_folder_for_those_without_one() {
        let folder = std::env::temp_dir().join(format!("cohabit-scripts-{}", std::process::id()));
        let missions = folder.join("missions");
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&missions).unwrap();
        for (name, text) in [("a.json", "{\"scene\": {}}"), ("b.json", "{\"scene\": {}}"), ("a.script", "own")] {
            fs::write(missions.join(name), text).unwrap();
        }
        let named = folder.join("named.script");
        fs::write(&named, "named").unwrap();
        let said = |path: &Path, script: Option<&Path>| -> Vec<Vec<Line>> {
            read_tasks(path, script).unwrap().into_iter().map(|task| task.script).collect()
        };
        let (own, other) = (vec![Line::utterance("own")], vec![Line::utterance("named")]);
        assert_eq!(said(&missions.join("a.json"), None), std::slice::from_ref(&own));
        assert_eq!(said(&missions.join("a.json"), Some(&named)), std::slice::from_ref(&other));
        assert_eq!(said(&missions, Some(&named)), [own, other]);
        fs::remove_dir_all(folder).unwrap();
    }
}
