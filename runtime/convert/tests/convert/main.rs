//! Data sets that are made here, converted, and read back.
#![allow(clippy::unwrap_used)]

mod arena;
mod lerobot;
mod shards;

use std::{
    fs,
    path::{Path, PathBuf},
};

use cohabit_bus::message::Plane;
use cohabit_cdf::{Catalog, mission};
use cohabit_convert::{ConvertError, Counts, Format, convert};
use cohabit_demonstrate::{MissionText, Recipe, demonstrate};
use cohabit_tests::{Scratch, files};
use serde_json::Value;

/// What files may have, where a test does not care.
const LARGE: usize = 100 << 20;

/// A data set of built-in missions, in a folder of the test's.
struct Native {
    scratch: Scratch,
    folder: PathBuf,
}

impl Native {
    fn new(test: &str, missions: &[&str], size: [u32; 2], planes: &[Plane]) -> Self {
        let scratch = Scratch::new(&format!("convert-{test}"));
        let folder = PathBuf::from(scratch.path("native"));
        let named = |name: &&str| {
            let (_, text) = mission::builtin().iter().find(|(file, _)| file.starts_with(*name)).unwrap();
            MissionText { id: (*name).to_owned(), cdf: (*text).to_owned() }
        };
        let missions: Vec<MissionText> = missions.iter().map(named).collect();
        let recipe = Recipe::new(5, size, planes).unwrap();
        let summary = demonstrate(&missions, &folder, &recipe, 2, &|| {}).unwrap();
        assert_eq!(summary.episodes, missions.len(), "{summary:?}");
        Self { scratch, folder }
    }

    fn convert(&self, out: &str, format: Format, limit: usize) -> Result<(PathBuf, Counts), ConvertError> {
        let out = PathBuf::from(self.scratch.path(out));
        let counts = convert(&self.folder, &out, format, limit, &Catalog::builtin(), &|_, _| {})?;
        Ok((out, counts))
    }

    fn text(&self, episode: usize, name: &str) -> String {
        fs::read_to_string(self.folder.join(format!("episodes/{episode:06}/{name}"))).unwrap()
    }

    /// The lines of an episode, as they stand there and as they are read.
    fn lines(&self, episode: usize) -> Vec<(String, Value)> {
        let text = self.text(episode, "steps.jsonl");
        text.lines().map(|line| (line.to_owned(), serde_json::from_str(line).unwrap())).collect()
    }

    fn picture(&self, episode: usize, line: &Value, modality: &str) -> Vec<u8> {
        let name = line["frames"][modality].as_str().unwrap();
        fs::read(self.folder.join(format!("episodes/{episode:06}/{name}"))).unwrap()
    }
}

fn json(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
fn each_format_is_made_once_and_alike_and_has_a_card() {
    let native = Native::new("alike", &["make_cereal"], [32, 24], &[]);
    for format in Format::ALL {
        let (one, counts) = native.convert(&format!("{}-1", format.name()), format, LARGE).unwrap();
        let (other, _) = native.convert(&format!("{}-2", format.name()), format, LARGE).unwrap();
        assert!(files(&one) == files(&other), "{format:?}");
        let card = fs::read_to_string(one.join("README.md")).unwrap();
        for expected in ["| seed | 5 |", "| pictures | none |", "| licence |", "# The data set that this was made from"]
        {
            assert!(card.contains(expected), "{format:?}: {expected}: {card}");
        }
        assert!(card.contains(&format!("| samples | {} |", counts.samples)), "{card}");
        let error = native.convert(&format!("{}-1", format.name()), format, LARGE).unwrap_err();
        assert!(matches!(error, ConvertError::Exists { .. }) && error.is_bad_input(), "{error}");
    }
}

#[test]
fn what_is_wrong_with_a_data_set_is_named_and_nothing_is_left() {
    let native = Native::new("wrong", &["make_cereal"], [32, 24], &[Plane::Color]);
    let refused = |format: Format, expected: &[&str]| {
        let error = native.convert("out", format, LARGE).unwrap_err();
        let text = error.to_string();
        assert!(error.is_bad_input(), "{text}");
        expected.iter().for_each(|part| assert!(text.contains(part), "{part}: {text}"));
        for name in ["out", "out.part"] {
            assert!(!Path::new(&native.scratch.path(name)).exists(), "{name}: {text}");
        }
    };
    refused(Format::Arena, &["32x24", "--size 300x300"]);
    let recipe = native.folder.join("recipe.json");
    let plain = fs::read_to_string(&recipe).unwrap();
    let pack = "\"world\": [{ \"name\": \"my-lab\", \"version\": \"1\", \"digest\": \"12ab\" }], \"seed\":";
    fs::write(&recipe, plain.replacen("\"seed\":", pack, 1)).unwrap();
    refused(Format::LeRobot, &["the world pack `my-lab` 1 with hash 12ab", "no world packs"]);
    fs::write(&recipe, plain).unwrap();
    let steps = native.folder.join("episodes/000000/steps.jsonl");
    let whole = fs::read_to_string(&steps).unwrap();
    fs::write(&steps, whole.replacen("\"kind\":\"", "\"kind\":\"un", 1)).unwrap();
    refused(Format::LeRobot, &["steps.jsonl, line 1", "kind of action"]);
    fs::write(&steps, whole.replacen("\"tick\":", "\"tock\":", 1)).unwrap();
    refused(Format::Shards, &["steps.jsonl, line 1", "tick", "makes it anew"]);
    let (short, _) = whole.trim_end().rsplit_once('\n').unwrap();
    fs::write(&steps, short).unwrap();
    refused(Format::Shards, &["steps.jsonl", "lines instead of"]);
    fs::write(&steps, whole.replacen("frames/0000-color.png", "../../../recipe.json", 1)).unwrap();
    refused(Format::Shards, &["is no file inside"]);
    fs::write(&steps, &whole).unwrap();
    fs::remove_file(native.folder.join("episodes/000000/frames/0000-color.png")).unwrap();
    refused(Format::LeRobot, &["0000-color.png"]);
    fs::remove_file(native.folder.join("manifest.json")).unwrap();
    refused(Format::LeRobot, &["no finished data set", "manifest.json"]);
}
