//! LeRobot data sets, read back by the Parquet crate, pandas and, where it is installed, `lerobot` itself.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use cohabit_bus::message::Plane;
use cohabit_convert::Format;
use cohabit_tests::{output, python_with};
use parquet::{
    file::{reader::FileReader as _, serialized_reader::SerializedFileReader},
    record::{Field, Row},
};
use serde_json::{Value, json};

use crate::{LARGE, Native, json as read_json};

/// Rows of a table, by the names of columns.
type Rows = Vec<BTreeMap<String, Field>>;

/// All rows of the files of a folder, in the order of their names, and how many files there are.
fn rows(folder: &Path) -> (Rows, usize) {
    let mut paths: Vec<PathBuf> = Vec::new();
    for chunk in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        paths.extend(fs::read_dir(chunk).unwrap().map(|entry| entry.unwrap().path()));
    }
    paths.sort();
    let mut rows = Rows::new();
    for path in &paths {
        rows.extend(table(path));
    }
    (rows, paths.len())
}

fn table(path: &Path) -> Rows {
    let reader = SerializedFileReader::try_from(path).unwrap();
    reader.get_row_iter(None).unwrap().map(|row| fields(&row.unwrap())).collect()
}

fn fields(row: &Row) -> BTreeMap<String, Field> {
    row.get_column_iter().map(|(name, field)| (name.clone(), field.clone())).collect()
}

fn long(field: &Field) -> i64 {
    if let Field::Long(number) = field { *number } else { panic!("{field:?}") }
}

fn text(field: &Field) -> &str {
    if let Field::Str(text) = field { text } else { panic!("{field:?}") }
}

fn numbers(field: &Field) -> Vec<f32> {
    let Field::ListInternal(list) = field else { panic!("{field:?}") };
    list.elements().iter().map(|one| if let Field::Float(number) = one { *number } else { panic!("{one:?}") }).collect()
}

/// The bytes of a picture.
fn png(field: &Field) -> &[u8] {
    let Field::Group(row) = field else { panic!("{field:?}") };
    match row.get_column_iter().find(|(name, _)| *name == "bytes") {
        Some((_, Field::Bytes(bytes))) => bytes.data(),
        other => panic!("{other:?}"),
    }
}

/// The numbers of a vector that are not zero, by their names.
fn named(info: &Value, feature: &str, numbers: &[f32]) -> BTreeMap<String, f32> {
    let names = info["features"][feature]["names"].as_array().unwrap();
    assert_eq!(info["features"][feature]["shape"], json!([numbers.len()]));
    let names = names.iter().map(|name| name.as_str().unwrap().to_owned());
    names.zip(numbers.iter().copied()).filter(|(_, number)| *number != 0.0).collect()
}

#[test]
fn frames_are_the_steps_of_the_data_set() {
    let native = Native::new("lerobot", &["make_cereal", "cold_soda"], [32, 24], &[Plane::Color, Plane::Depth]);
    let (folder, counts) = native.convert("lerobot", Format::LeRobot, LARGE).unwrap();
    let info = read_json(&folder.join("meta/info.json"));
    let (frames, files) = rows(&folder.join("data"));
    assert_eq!((files, counts.files, counts.samples), (1, 1, frames.len()));
    assert_eq!((&info["codebase_version"], &info["total_frames"]), (&json!("v3.0"), &json!(frames.len())));
    let columns: Vec<&String> = frames[0].keys().collect();
    let mut features: Vec<&String> = info["features"].as_object().unwrap().keys().collect();
    features.sort();
    assert_eq!(columns, features);
    let classes = read_json(&folder.join("meta/classes.json"));
    let mut all = frames.iter();
    for episode in 0..2 {
        let lines = native.lines(episode);
        for (place, (line, step)) in lines.iter().enumerate() {
            let frame = all.next().unwrap();
            assert_eq!(text(&frame["step.line"]), line);
            assert_eq!(
                (long(&frame["episode_index"]), long(&frame["frame_index"])),
                (episode as i64, place as i64),
                "{step}"
            );
            assert_eq!(frame["timestamp"], Field::Float(place as f32));
            assert_eq!(frame["next.done"], Field::Bool(step["action"].is_null()));
            assert_eq!(step["tick"], long(&frame["step.tick"]));
            assert!(png(&frame["observation.images.color"]) == native.picture(episode, step, "color"));
            assert!(png(&frame["observation.images.depth"]) == native.picture(episode, step, "depth"));
            let state = named(&info, "observation.state", &numbers(&frame["observation.state"]));
            let x_m = step["pose"]["position_m"][0].as_f64().unwrap() as f32;
            assert_eq!(state.get("x_m"), Some(&x_m));
            assert_eq!(state.get(&format!("is_in_{}", step["pose"]["room"].as_str().unwrap())), Some(&1.0));
            let action = named(&info, "action", &numbers(&frame["action"]));
            let kind = step["action"]["kind"].as_str().unwrap_or("stop");
            assert_eq!(action.get(&format!("is_{kind}")), Some(&1.0), "{action:?}");
            if !step["action"].is_null() {
                let class = usize::try_from(long(&frame["step.class"])).unwrap();
                assert_eq!(classes[class], step["action"]["class"]);
                assert_eq!(step["action"]["object"], text(&frame["step.object"]));
                assert_eq!(action.contains_key("is_seen"), step["action"]["is_seen"] == true, "{step}");
            }
        }
    }
    assert!(all.next().is_none());
    let indices: Vec<i64> = frames.iter().map(|frame| long(&frame["index"])).collect();
    assert_eq!(indices, (0..frames.len() as i64).collect::<Vec<_>>());
    let stats = read_json(&folder.join("meta/stats.json"));
    assert_eq!(stats["index"]["max"], json!([(frames.len() - 1) as f64]));
    assert_eq!(stats["observation.images.color"]["mean"].as_array().unwrap().len(), 3);
    assert_eq!(stats["action"]["count"], json!([frames.len()]));
}

#[test]
fn episodes_and_tasks_say_where_frames_are_and_what_was_asked() {
    let missions = ["make_cereal", "cold_soda", "warm_coffee"];
    let native = Native::new("lerobot-episodes", &missions, [32, 24], &[]);
    // A file to each episode.
    let (folder, counts) = native.convert("lerobot", Format::LeRobot, 1).unwrap();
    let (episodes, _) = rows(&folder.join("meta/episodes"));
    let tasks = table(&folder.join("meta/tasks.parquet"));
    assert_eq!((episodes.len(), counts.files), (3, 3));
    let mut first = 0;
    for (number, episode) in episodes.iter().enumerate() {
        let frames = table(&folder.join(format!("data/chunk-000/file-{number:03}.parquet")));
        assert_eq!(long(&episode["episode_index"]), number as i64);
        assert_eq!((long(&episode["data/chunk_index"]), long(&episode["data/file_index"])), (0, number as i64));
        assert_eq!(long(&episode["length"]), frames.len() as i64);
        assert_eq!(long(&episode["dataset_from_index"]), first);
        first += frames.len() as i64;
        assert_eq!(long(&episode["dataset_to_index"]), first);
        assert_eq!(text(&episode["mission"]), missions[number]);
        assert_eq!(text(&episode["mission.json"]), native.text(number, "mission.json"));
        assert_eq!(text(&episode["episode.json"]), native.text(number, "episode.json"));
        let Field::ListInternal(told) = &episode["tasks"] else { panic!("{episode:?}") };
        let task = &tasks[usize::try_from(long(&frames[0]["task_index"])).unwrap()];
        assert_eq!(text(&told.elements()[0]), text(&task["__index_level_0__"]));
        let steps = native.lines(number);
        let instruction = steps[0].1["instructions"]["plain"].as_str().unwrap();
        assert!(text(&task["__index_level_0__"]).starts_with(instruction), "{task:?}");
    }
    let info = read_json(&folder.join("meta/info.json"));
    assert_eq!((&info["total_episodes"], &info["splits"]["train"]), (&json!(3), &json!("0:3")));
    assert!(info["features"].get("observation.images.color").is_none(), "there are no pictures");
}

const HERE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/convert");

fn read_with(python: &Path, how: &str, folder: &Path) -> Value {
    let script = Path::new(HERE).join("read.py");
    let read = output(Command::new(python).arg(script).arg(how).arg(folder)).unwrap();
    serde_json::from_slice(&read.stdout).unwrap()
}

#[test]
#[cfg_attr(not(python), ignore = "needs Python 3.10 or later with venv")]
fn pandas_reads_frames_pictures_and_tasks() {
    let native = Native::new("lerobot-pandas", &["make_cereal"], [32, 24], &[Plane::Color, Plane::Depth]);
    let (folder, counts) = native.convert("lerobot", Format::LeRobot, LARGE).unwrap();
    let venv = Path::new(env!("CARGO_TARGET_TMPDIR")).join("convert-python");
    let python = python_with(&Path::new(HERE).join("requirements.txt"), &venv).unwrap();
    let read = read_with(&python, "pandas", &folder);
    assert_eq!(read["frames"], counts.samples, "{read}");
    assert_eq!(read["color"], json!(["RGB", [32, 24]]));
    assert_eq!(read["depth"][1], json!([32, 24]));
    let first = &native.lines(0)[0].1;
    assert!(read["task"].as_str().unwrap().starts_with(first["instructions"]["plain"].as_str().unwrap()), "{read}");
    assert_eq!(read["object"], first["action"]["object"]);
}

#[test]
#[cfg_attr(not(lerobot), ignore = "optional: the `lerobot` package")]
fn lerobot_loads_it() {
    let native = Native::new("lerobot-itself", &["make_cereal"], [32, 24], &[Plane::Color]);
    let (folder, counts) = native.convert("lerobot", Format::LeRobot, LARGE).unwrap();
    let read = read_with(Path::new("python3"), "lerobot", &folder);
    assert_eq!(read["frames"], counts.samples, "{read}");
    assert_eq!(read["color"], json!([3, 24, 32]));
}
