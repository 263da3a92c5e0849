//! Questions about instructions: what is asked is open, and what is answered is true.

#![allow(clippy::unwrap_used)]

use std::{
    collections::{BTreeMap, BTreeSet},
    f32::consts::{FRAC_PI_4, PI, TAU},
    fs,
    path::Path,
};

use cohabit_cdf::{Catalog, Layout, RoomId, Rooms, mission};
use cohabit_demonstrate::{MissionText, Recipe, demonstrate};
use cohabit_tests::Scratch;
use proptest::prelude::*;
use serde_json::Value;

/// So near a border between two directions rounding decides, rad and m.
const BORDER: f32 = 0.01;
/// Who goes less far need not have moved, m.
const STEP_M: f32 = 0.3;

/// A state of an episode: the line of a step, and all objects as they are before it.
struct Before<'a> {
    line: &'a Value,
    objects: &'a BTreeMap<String, Value>,
    /// Where the robot stands before the next step.
    end_m: [f32; 2],
    catalog: &'a Catalog,
    layout: &'a Layout,
}

/// A data set without pictures.
fn make(folder: &Path, missions: &[(&str, &str)], recipe: &Recipe) {
    let mission = |(name, text): &(&str, &str)| MissionText { id: (*name).to_owned(), cdf: (*text).to_owned() };
    let missions: Vec<MissionText> = missions.iter().map(mission).collect();
    demonstrate(&missions, folder, recipe, 2, &|| {}).unwrap();
}

fn json(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

/// The lines of each episode, with the id of its floor plan.
fn episodes(folder: &Path) -> Vec<(String, Vec<Value>)> {
    let manifest = json(&folder.join("manifest.json"));
    let episode = |entry: &Value| {
        let text = fs::read_to_string(folder.join(entry["folder"].as_str().unwrap()).join("steps.jsonl")).unwrap();
        let lines: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        let count = lines.iter().map(|line| questions(line).len()).sum::<usize>();
        assert_eq!(entry["questions"].as_u64().unwrap() as usize, count);
        (entry["floor_plan"].as_str().unwrap().to_owned(), lines)
    };
    manifest["episodes"].as_array().unwrap().iter().map(episode).collect()
}

fn questions(line: &Value) -> &[Value] {
    line["questions"].as_array().map_or(&[], Vec::as_slice)
}

fn at_m(value: &Value) -> [f32; 2] {
    [0, 1].map(|axis| value["position_m"][axis].as_f64().unwrap() as f32)
}

/// Where a place is for who stands in a pose; nothing near a border.
fn side(pose: &Value, to_m: [f32; 2]) -> Option<&'static str> {
    let [x, y] = at_m(pose);
    let yaw_rad = pose["yaw_rad"].as_f64().unwrap() as f32;
    let turned = ((to_m[1] - y).atan2(to_m[0] - x) - yaw_rad).rem_euclid(TAU);
    let bearing_rad = if turned > PI { turned - TAU } else { turned };
    match bearing_rad.abs() {
        away if (away - FRAC_PI_4).abs() < BORDER || (away - 3.0 * FRAC_PI_4).abs() < BORDER => None,
        away if away < FRAC_PI_4 => Some("in front of you"),
        away if away > 3.0 * FRAC_PI_4 => Some("behind you"),
        _ if bearing_rad > 0.0 => Some("to your left"),
        _ => Some("to your right"),
    }
}

impl Before<'_> {
    fn name(&self, object: &Value) -> String {
        let class = self.catalog.find(object["class"].as_str().unwrap()).unwrap();
        self.catalog.class(class).name.to_lowercase()
    }

    /// What the robot calls a thing, at least.
    fn plain(&self, object: &Value) -> &str {
        &self.catalog.names(self.catalog.find(object["class"].as_str().unwrap()).unwrap()).plain
    }

    fn color(&self, object: &Value) -> String {
        let class = self.catalog.find(object["class"].as_str().unwrap()).unwrap();
        object["color"].as_str().unwrap_or(&self.catalog.class(class).color).to_lowercase()
    }

    /// Checks a question and its answer; gives its type.
    fn check(&self, asked: &Value) -> String {
        let kind = asked["type"].as_str().unwrap();
        let action = &self.line["action"];
        let object = &self.objects[asked["object"].as_str().unwrap()];
        let (question, answer) = (asked["question"].as_str().unwrap(), asked["answer"].as_str().unwrap());
        let noun = self.name(object);
        let why = format!("{asked} about {object} at {}", self.line["pose"]);
        assert_eq!(asked["object"], action["object"], "{why}");
        assert!(self.line["instructions"]["plain"].as_str().unwrap().contains(&noun), "{why}");
        if kind == "reference" {
            let namesakes = self.objects.values().filter(|other| self.name(other) == noun).count();
            assert!(namesakes > 1, "only one is called so: {why}");
        } else {
            let pose = &self.line["pose"];
            let is_far = object["room"] != pose["room"] || object["hidden"] == true;
            let is_in_front = side(pose, at_m(object)) == Some("in front of you");
            assert!(is_far || !is_in_front, "it is before the robot's eyes: {why}");
        }
        match kind {
            "location" => {
                assert_eq!(question, format!("Where is the {noun}?"));
                self.check_location(object, answer, &why);
            }
            "appearance" => {
                assert_eq!(question, format!("What does the {noun} look like?"));
                assert!(answer.starts_with(&format!("The {} is ", self.plain(object))), "{why}");
                assert!(answer.contains(&format!("{}.", self.color(object))), "{why}");
            }
            "direction" => {
                assert_eq!(question, "Which direction should I turn to?");
                assert_eq!(action["kind"], "go_to", "{why}");
                self.check_direction(answer, &why);
            }
            "reference" => {
                assert_eq!(question, format!("Which {noun} are you referring to?"));
                let parts = [self.plain(object).to_owned(), self.color(object), room_of(object)];
                assert!(parts.iter().all(|part| answer.contains(part)), "{parts:?}: {why}");
            }
            _ => panic!("there is no such type: {why}"),
        }
        kind.to_owned()
    }

    fn check_location(&self, object: &Value, answer: &str, why: &str) {
        const SIDES: [&str; 4] = ["in front of you", "behind you", "to your left", "to your right"];
        let pose = &self.line["pose"];
        assert!(answer.contains(&format!("in the {}.", room_of(object))), "{why}");
        let is_here = object["room"] == pose["room"];
        assert_eq!(SIDES.iter().any(|side| answer.contains(side)), is_here, "{why}");
        if let Some(side) = side(pose, at_m(object)).filter(|_| is_here) {
            assert!(answer.contains(side), "{side}: {why}");
        }
        if let Some(parent) = object["parent"].as_str() {
            assert!(answer.contains(self.plain(&self.objects[parent])), "{parent}: {why}");
        }
        let told: u8 = answer.trim_end_matches('.').rsplit_once("viewpoint ").unwrap().1.parse().unwrap();
        let [x, y] = at_m(object);
        let room = object["room"].as_str().unwrap();
        let views = self.layout.viewpoints.iter().filter(|view| view.room.id() == room);
        let away: BTreeMap<u8, f32> =
            views.map(|view| (view.number, (view.at_m[0] - x).hypot(view.at_m[1] - y))).collect();
        assert!(away.values().all(|other| away[&told] <= *other + BORDER), "{away:?}: {why}");
    }

    fn check_direction(&self, answer: &str, why: &str) {
        let pose = &self.line["pose"];
        let ([x, y], [end_x, end_y]) = (at_m(pose), self.end_m);
        let gone_m = (end_x - x).hypot(end_y - y);
        let expected = match side(pose, self.end_m) {
            _ if (gone_m - STEP_M).abs() < BORDER => return,
            _ if gone_m < STEP_M => "You don't need to move.",
            None => return,
            Some("to your left") => "You should turn left.",
            Some("to your right") => "You should turn right.",
            Some("behind you") => "You should turn around.",
            Some(_) => "You should go straight ahead.",
        };
        assert_eq!(answer, expected, "{why}");
    }
}

fn room_of(object: &Value) -> String {
    let (rooms, id) = (Rooms::builtin(), RoomId::new(object["room"].as_str().unwrap()).unwrap());
    rooms.get(id).unwrap().name.clone()
}

/// Checks all questions of a data set; gives their types.
fn check(folder: &Path) -> BTreeSet<String> {
    let catalog = Catalog::builtin();
    let mut types = BTreeSet::new();
    for (floor_plan, lines) in episodes(folder) {
        let layout = Layout::builtin(&floor_plan).unwrap();
        let (mut objects, mut once) = (BTreeMap::<String, Value>::new(), BTreeSet::new());
        for (line, next) in lines.iter().zip(&lines[1..]) {
            for gone in line["gone"].as_array().into_iter().flatten() {
                objects.remove(gone.as_str().unwrap());
            }
            let changed = line["objects"].as_array().unwrap().iter();
            objects.extend(changed.map(|object| (object["instance"].as_str().unwrap().to_owned(), object.clone())));
            let end_m = at_m(&next["pose"]);
            let before = Before { line, objects: &objects, end_m, catalog: &catalog, layout: &layout };
            for asked in questions(line) {
                let kind = before.check(asked);
                let is_new = once.insert((kind.clone(), asked["object"].as_str().unwrap().to_owned()));
                assert!(is_new || ["location", "direction"].contains(&kind.as_str()), "asked twice: {asked}");
                types.insert(kind);
            }
        }
        assert!(questions(lines.last().unwrap()).is_empty(), "nothing is left to be done");
    }
    types
}

#[test]
fn the_missions_of_the_project_have_questions_of_all_types() {
    let scratch = Scratch::new("demonstrate-questions");
    let folder = scratch.path("data");
    let missions = [mission::builtin(); 3].concat();
    make(Path::new(&folder), &missions, &Recipe::new(1, [64, 48], &[]).unwrap());
    let types: Vec<String> = check(Path::new(&folder)).into_iter().collect();
    assert_eq!(types, ["appearance", "direction", "location", "reference"]);
    let card = fs::read_to_string(Path::new(&folder).join("README.md")).unwrap();
    let count: u64 = episodes(Path::new(&folder)).iter().flat_map(|(_, lines)| lines).map(count).sum();
    assert!(card.contains(&format!("| questions | {count} |")), "{card}");
}

fn count(line: &Value) -> u64 {
    questions(line).len() as u64
}

#[test]
fn without_questions_all_else_is_the_same() {
    let scratch = Scratch::new("demonstrate-no-questions");
    let (with, without) = (scratch.path("with"), scratch.path("without"));
    let recipe = Recipe::new(1, [64, 48], &[]).unwrap();
    make(Path::new(&with), &mission::builtin()[..2], &recipe);
    make(Path::new(&without), &mission::builtin()[..2], &recipe.without_questions());
    let plain = episodes(Path::new(&without));
    assert!(plain.iter().flat_map(|(_, lines)| lines).all(|line| line.get("questions").is_none()));
    let mut asked = episodes(Path::new(&with));
    for line in asked.iter_mut().flat_map(|(_, lines)| lines) {
        line.as_object_mut().unwrap().remove("questions");
    }
    assert!(asked == plain);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 6, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_is_answered_is_true(seed in any::<u64>(), number in 0..mission::builtin().len()) {
        let scratch = Scratch::new("demonstrate-true");
        let folder = scratch.path("data");
        let recipe = Recipe::new(seed, [64, 48], &[]).unwrap();
        make(Path::new(&folder), &mission::builtin()[number..=number], &recipe);
        check(Path::new(&folder));
    }
}
