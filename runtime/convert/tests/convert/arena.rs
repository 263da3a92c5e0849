//! Trajectory files, read back by what reads the public ones.

use cohabit_bus::message::Plane;
use cohabit_convert::Format;
use cohabit_eval::{Line, read_tasks};

use crate::{LARGE, Native, json};

#[test]
fn trajectories_are_read_as_the_public_ones_are() {
    let native = Native::new("arena", &["make_cereal"], [300, 300], &[Plane::Color, Plane::Ids]);
    let (folder, counts) = native.convert("arena", Format::Arena, LARGE).unwrap();
    let path = folder.join("trajectories.json");
    let trajectory = &json(&path)["make_cereal"];
    assert_eq!(trajectory["CDF"], serde_json::from_str::<serde_json::Value>(&native.text(0, "mission.json")).unwrap());
    let actions = trajectory["actions"].as_array().unwrap();
    let steps: Vec<_> =
        native.lines(0).into_iter().map(|(_, line)| line).filter(|line| !line["action"].is_null()).collect();
    assert_eq!((actions.len(), counts.samples), (steps.len(), steps.len()), "the expert does not fail here");
    for (action, step) in actions.iter().zip(&steps) {
        let name = action["type"].as_str().unwrap().to_lowercase();
        let object = &action[&name]["object"];
        assert_eq!(name, step["action"]["kind"].as_str().unwrap().replace('_', ""));
        assert_eq!(object["id"], step["action"]["object"]);
        assert_eq!(object["mask"].is_array(), step["action"]["is_seen"] == true, "{step}");
        assert_eq!(
            std::fs::read(folder.join("images").join(action["colorImages"][0].as_str().unwrap())).unwrap(),
            native.picture(0, step, "color")
        );
        if let Some(runs) = object["mask"].as_array() {
            let pixels: u64 = runs.iter().map(|run| run[1].as_u64().unwrap()).sum();
            let seen = step["seen"].as_array().unwrap().iter().find(|seen| seen["id"] == step["action"]["id"]).unwrap();
            assert_eq!(pixels, seen["pixels"].as_u64().unwrap(), "{step}");
        }
    }
    let questions: usize = steps.iter().map(|step| step["questions"].as_array().map_or(0, Vec::len)).sum();
    assert!(questions > 0, "the expert has far to go here");
    for annotation in trajectory["synthetic_annotations"].as_array().unwrap() {
        for (instruction, step) in annotation["instructions"].as_array().unwrap().iter().zip(&steps) {
            let told = instruction["question_answers"].as_array().into_iter().flatten();
            let told: Vec<_> = told.map(|pair| (&pair["question"], &pair["answer"])).collect();
            let asked = step["questions"].as_array().into_iter().flatten();
            assert_eq!(told, asked.map(|pair| (&pair["question"], &pair["answer"])).collect::<Vec<_>>());
        }
    }
    let tasks = read_tasks(&path, None).unwrap();
    let ids: Vec<&str> = tasks.iter().map(|task| task.id.as_str()).collect();
    assert_eq!(
        ids,
        [
            "make_cereal#synthetic1",
            "make_cereal#synthetic2",
            "make_cereal#synthetic3",
            "make_cereal#synthetic4",
            "make_cereal#expert",
        ]
    );
    let is_action = |line: &Line| matches!(line, Line::Action(_));
    assert!(tasks[4].script.len() == actions.len() && tasks[4].script.iter().all(is_action));
}
