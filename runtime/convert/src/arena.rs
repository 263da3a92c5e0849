//! The trajectory files of Alexa Arena: missions with an expert's actions, masks, and instructions for them.
//!
//! `trajectories.json` is one object: for each mission its `CDF`, `actions`, `human_annotations` (none yet) and
//! `synthetic_annotations` (one for each style of instructions). Missions are written one by one, so any number fits into memory.
//! What the format has no place for is named in the card.

mod mask;

use std::{
    collections::BTreeSet,
    fs::File,
    io::{BufWriter, Write as _},
};

use cohabit_cdf::ActionKind;
use serde_json::{Map, Value, json};

use crate::{
    Counts, card,
    error::{ConvertError, at},
    native::{Action, Dataset, Episode, Question, Step},
    output::Output,
    picture::{self, Pixels},
};

/// Width and height of the pictures that masks are over.
const SIZE: [u32; 2] = [300, 300];
/// What is said of the files.
const CARD: &str = include_str!("../data/arena.md");

/// Writes a data set into a folder.
pub(crate) fn write(dataset: &Dataset, output: &Output, done: &dyn Fn(usize, usize)) -> Result<Counts, ConvertError> {
    check(dataset)?;
    let path = output.path("trajectories.json")?;
    let mut file = BufWriter::new(File::create(&path).map_err(at(&path))?);
    let mut samples = 0;
    for (number, episode) in dataset.episodes.iter().enumerate() {
        let trajectory = trajectory(dataset, output, episode)?;
        samples += trajectory["actions"].as_array().map_or(0, Vec::len);
        let begin = if number == 0 { "{" } else { "," };
        let name = Value::String(episode.id.clone());
        write!(file, "{begin}\n{name}: {trajectory}").map_err(at(&path))?;
        done(number + 1, dataset.episodes.len());
    }
    file.write_all(b"\n}\n").and_then(|()| file.flush()).map_err(at(&path))?;
    let counts = Counts { episodes: dataset.episodes.len(), samples, files: 1 };
    output.write("README.md", card::text(dataset, &counts, "trajectories of Alexa Arena", CARD))?;
    Ok(counts)
}

/// Whether pictures have the size that masks are over, and each mission a name of its own.
fn check(dataset: &Dataset) -> Result<(), ConvertError> {
    let unfit = |reason: String| Err(ConvertError::Unfit { path: dataset.folder.clone(), reason });
    let [width, height] = dataset.recipe.size;
    if !dataset.recipe.modalities.is_empty() && dataset.recipe.size != SIZE {
        return unfit(format!(
            "its pictures have {width}x{height} pixels, and the masks of this format are over 300x300; make it anew with `--size 300x300`"
        ));
    }
    let mut names = BTreeSet::new();
    match dataset.episodes.iter().find(|episode| !names.insert(&episode.id)) {
        Some(episode) => {
            unfit(format!("two missions are called `{}`; give one another name, and make it anew", episode.id))
        }
        None => Ok(()),
    }
}

/// What is said of a mission; its pictures are copied.
fn trajectory(dataset: &Dataset, output: &Output, episode: &Episode) -> Result<Value, ConvertError> {
    let text = dataset.text(episode, "mission.json")?;
    let cdf: Value = serde_json::from_str(text.trim_start_matches('\u{feff}')).map_err(|error| {
        ConvertError::Damaged { path: dataset.path(episode, "mission.json"), reason: error.to_string() }
    })?;
    let lines = dataset.lines(episode)?;
    let mut actions = Vec::new();
    let mut done = Vec::new();
    for step in lines.iter().map(|line| &line.step).filter(|step| step.has_succeeded()) {
        let Some(action) = &step.action else { continue };
        let pictures = copy_picture(dataset, output, episode, step, actions.len() + 1)?;
        let mask = mask(dataset, episode, step)?;
        actions.push(told(action, actions.len(), mask, pictures).ok_or_else(|| ConvertError::Damaged {
            path: dataset.path(episode, "steps.jsonl"),
            reason: format!("there is no action `{}`", action.kind),
        })?);
        done.push(step);
    }
    Ok(json!({
        "human_annotations": [],
        "actions": actions,
        "CDF": cdf,
        "synthetic_annotations": annotations(&done),
    }))
}

/// An action as models emit it, or none where there is no such kind.
fn told(action: &Action, id: usize, mask: Option<Vec<[usize; 2]>>, pictures: Vec<String>) -> Option<Value> {
    let kind = ActionKind::ALL.into_iter().find(|kind| kind.name() == action.kind)?;
    let kind = type_name(kind);
    let mut object = Map::new();
    object.insert("id".to_owned(), json!(action.object));
    match mask {
        Some(mask) => {
            object.insert("colorImageIndex".to_owned(), json!(0));
            object.insert("mask".to_owned(), json!(mask));
        }
        None => drop(object.insert("name".to_owned(), json!(action.class))),
    }
    let mut told = Map::new();
    told.insert("id".to_owned(), json!(id));
    told.insert("type".to_owned(), json!(kind));
    told.insert("colorImages".to_owned(), json!(pictures));
    told.insert(kind.to_lowercase(), json!({ "object": object }));
    Some(Value::Object(told))
}

/// What a kind of action is called.
const fn type_name(kind: ActionKind) -> &'static str {
    match kind {
        ActionKind::GoTo => "Goto",
        ActionKind::PickUp => "Pickup",
        ActionKind::Place => "Place",
        ActionKind::Open => "Open",
        ActionKind::Close => "Close",
        ActionKind::Break => "Break",
        ActionKind::Scan => "Scan",
        ActionKind::Pour => "Pour",
        ActionKind::Toggle => "Toggle",
        ActionKind::Throw => "Throw",
        ActionKind::Fill => "Fill",
        ActionKind::Clean => "Clean",
        ActionKind::Examine => "Examine",
    }
}

/// The mask of a step's object, where it is seen and the data set has pictures of ids.
fn mask(dataset: &Dataset, episode: &Episode, step: &Step) -> Result<Option<Vec<[usize; 2]>>, ConvertError> {
    let Some(target) = step.target().filter(|_| dataset.recipe.modalities.iter().any(|modality| modality == "ids"))
    else {
        return Ok(None);
    };
    let (file, bytes) = dataset.picture(episode, step, "ids")?;
    let damaged = |reason| ConvertError::Damaged { path: dataset.path(episode, file), reason };
    match picture::decode(&bytes, SIZE).map_err(damaged)? {
        Pixels::Rgb(pixels) => Ok(Some(mask::runs(&pixels, target.color))),
        Pixels::Gray(_) => Err(damaged("the picture of ids has no colours".to_owned())),
    }
}

/// Copies what is seen before the action of that number; gives the names of the pictures.
fn copy_picture(
    dataset: &Dataset,
    output: &Output,
    episode: &Episode,
    step: &Step,
    number: usize,
) -> Result<Vec<String>, ConvertError> {
    if !step.frames.contains_key("color") {
        return Ok(Vec::new());
    }
    let (_, bytes) = dataset.picture(episode, step, "color")?;
    // A mission may be called what no file can be; its folder may not.
    let stem = if is_file_name(&episode.id) { episode.id.clone() } else { episode.folder.replace('/', "-") };
    let name = format!("{stem}-action-num-{number}_colorImage_0.png");
    output.write(&format!("images/{name}"), bytes)?;
    Ok(vec![name])
}

fn is_file_name(text: &str) -> bool {
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-_.&+".contains(&byte);
    text.len() <= 200 && text.bytes().all(is_plain)
}

/// An annotation for each style: an instruction for each action, with the questions about it.
fn annotations(steps: &[&Step]) -> Vec<Value> {
    let styles: BTreeSet<&String> = steps.iter().flat_map(|step| step.instructions.keys()).collect();
    let annotation = |style: &&String| {
        let told = steps
            .iter()
            .enumerate()
            .filter_map(|(id, step)| step.instructions.get(*style).map(|text| instruction(text, id, &step.questions)));
        json!({ "instructions": told.collect::<Vec<_>>() })
    };
    styles.iter().map(annotation).collect()
}

/// An instruction for an action. What is asked about it is what it leaves open, so that is necessary.
fn instruction(text: &str, action: usize, questions: &[Question]) -> Value {
    let mut told = json!({ "instruction": text, "actions": [action] });
    let pair = |Question { question, answer }: &Question| json!({ "question": question, "answer": answer, "question_necessary": true });
    if !questions.is_empty() {
        told["question_answers"] = questions.iter().map(pair).collect();
    }
    told
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_action_names_its_object_by_its_mask_or_by_its_class() {
        let action = Action {
            kind: "pick_up".to_owned(),
            object: "Bowl_01_1".to_owned(),
            class: "Bowl_01".to_owned(),
            id: 7,
            is_seen: true,
        };
        assert_eq!(
            told(&action, 3, Some(vec![[10, 2]]), vec!["a.png".to_owned()]),
            Some(json!({
                "id": 3, "type": "Pickup", "colorImages": ["a.png"],
                "pickup": { "object": { "id": "Bowl_01_1", "colorImageIndex": 0, "mask": [[10, 2]] } },
            }))
        );
        assert_eq!(
            told(&action, 0, None, Vec::new()),
            Some(json!({
                "id": 0, "type": "Pickup", "colorImages": [],
                "pickup": { "object": { "id": "Bowl_01_1", "name": "Bowl_01" } },
            }))
        );
        assert_eq!(told(&Action { kind: "fly".to_owned(), ..action }, 0, None, Vec::new()), None);
    }

    #[test]
    fn names_of_files_are_plain() {
        for (text, expected) in [("clean&deliver-00001", true), ("a/b", false), ("ä", false), ("a b", false)] {
            assert_eq!(is_file_name(text), expected, "{text}");
        }
    }
}
