#![allow(clippy::unwrap_used)]

use cohabit_tests::{Scratch, files};
use serde_json::json;

use super::*;
use crate::task::{Reading, Reason, Segment, What};

const EPISODE: &str =
    "{\n  \"id\": \"a \\\"human\\\" \\n  b\",\n  \"folder\": \"episodes/000000\",\n  \"steps\": 4\n}\n";
const README: &str = "# Demonstrations\n";

fn dataset(scratch: &Scratch) -> PathBuf {
    let folder = PathBuf::from(scratch.path("data"));
    fs::create_dir_all(folder.join("episodes/000000")).unwrap();
    fs::create_dir_all(folder.join("annotations")).unwrap();
    let manifest = json!({
        "format": "cohabit demonstrations 3", "left_out": [],
        "episodes": [{ "id": "a", "folder": "episodes/000000", "floor_plan": "x", "steps": 4 }],
    });
    let recipe = json!({
        "program": "0", "seed": 1, "size": [4, 4], "modalities": ["color"], "missions": 1, "missions_blake3": "",
    });
    for (name, text) in [
        ("manifest.json", manifest.to_string()),
        ("recipe.json", recipe.to_string()),
        ("README.md", README.to_owned()),
        ("episodes/000000/episode.json", EPISODE.to_owned()),
    ] {
        fs::write(folder.join(name), text).unwrap();
    }
    folder
}

fn segment(end_step: usize) -> Segment {
    Segment { episode: "episodes/000000".to_owned(), first_step: 0, end_step }
}

fn annotation(id: u64, task: Task, text: &str) -> Annotation {
    let (annotator, what) = (format!("A{id:02}"), What::Text(text.to_owned()));
    Annotation { id, annotator, task, what, taken_ms: 0, at_ms: 0, corrects: None }
}

/// An instruction, a question about it and its answer.
fn told() -> Vec<Annotation> {
    let read = |id, text: &str| Reading { id, text: text.to_owned() };
    let (instruction, question) = (read(0, "get it"), read(1, "Which one?"));
    let asks = Task::Question { segment: segment(4), moment_step: 2, instruction: instruction.clone() };
    vec![
        annotation(0, Task::Instruction { segment: segment(4) }, "get it"),
        annotation(1, asks, "Which one?"),
        annotation(2, Task::Answer { segment: segment(4), instruction, question }, "the \"red\" one,\u{2028} see"),
        annotation(3, Task::Instruction { segment: segment(9) }, "of another data set"),
    ]
}

fn write(folder: &Path, annotations: &[Annotation]) {
    let lines: Vec<String> = annotations.iter().map(|one| format!("{}\n", json!(one))).collect();
    fs::write(journal_path(folder), lines.concat()).unwrap();
}

#[test]
fn exported_twice_gives_the_same_bytes_and_touches_no_others() {
    let scratch = Scratch::new("annotate-export");
    let folder = dataset(&scratch);
    let path = folder.join("episodes/000000/episode.json");
    let mut annotations = told();
    write(&folder, &annotations);
    let exported = export(&folder).unwrap();
    assert_eq!(exported, Exported { episodes: 1, instructions: 1, questions: 1, answers: 1, left_out: 1 });
    let first = files(&folder);
    assert_eq!(export(&folder).unwrap(), exported);
    assert!(files(&folder) == first);
    let text = fs::read_to_string(&path).unwrap();
    assert!(text.starts_with(EPISODE.strip_suffix(END).unwrap()), "{text}");
    let episode: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(
        episode["human"],
        json!({
            "instructions": [{ "annotator": "A00", "first_step": 0, "end_step": 4, "text": "get it" }],
            "questions": [{
                "annotator": "A01", "first_step": 0, "end_step": 4, "moment_step": 2, "instruction": "get it",
                "text": "Which one?",
                "answers": [{ "annotator": "A02", "question": "Which one?", "text": "the \"red\" one,\u{2028} see" }],
            }],
        })
    );
    let card = fs::read_to_string(folder.join("README.md")).unwrap();
    assert!(card.starts_with(README) && card.contains("| instructions | 1 |"), "{card}");
    // A correction takes the place of what was there.
    annotations.push(Annotation { corrects: Some(0), id: 4, ..annotation(0, annotations[0].task.clone(), "fetch it") });
    write(&folder, &annotations);
    export(&folder).unwrap();
    let text = fs::read_to_string(&path).unwrap();
    assert!(text.contains("fetch it") && text.matches("\"human\":").count() == 1, "{text}");
    // Where nobody wrote anything, all is as it was.
    write(&folder, &[Annotation { what: What::Skipped(Reason::CannotTell), ..told().remove(0) }]);
    assert_eq!(export(&folder).unwrap(), Exported::default());
    assert_eq!(fs::read_to_string(&path).unwrap(), EPISODE);
    assert_eq!(fs::read_to_string(folder.join("README.md")).unwrap(), README);
}

#[test]
fn an_episode_that_somebody_else_wrote_is_left_alone() {
    let scratch = Scratch::new("annotate-export-wrong");
    let folder = dataset(&scratch);
    write(&folder, &told());
    let path = folder.join("episodes/000000/episode.json");
    for text in ["", "{}", "{\"human\": 1}\n", "{\n  \"id\": 1,\n  \"human\": 1,\n  \"mine\": 2\n}\n"] {
        fs::write(&path, text).unwrap();
        let error = export(&folder).unwrap_err();
        assert!(matches!(error, AnnotateError::Damaged { .. }), "{text}: {error}");
        assert_eq!(fs::read_to_string(&path).unwrap(), text);
        assert_eq!(fs::read_to_string(folder.join("README.md")).unwrap(), README);
    }
}
