//! Missions for other planners, and their plans back in the world.

use std::{
    path::{Path, PathBuf},
    process::Command,
};

use cohabit_tests::{Scratch, run};

use crate::COHABIT;

const MISSIONS: [&str; 4] = ["cold_soda", "laser_lab", "make_cereal", "warm_coffee"];

/// What `cohabit pddl` prints, and its exit code.
fn pddl(arguments: &[&str]) -> (String, Option<i32>) {
    let output = run(COHABIT, &[&["pddl"], arguments].concat()).unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    (text, output.status.code())
}

#[test]
fn the_plan_of_an_exported_mission_is_accepted_by_the_world() {
    let scratch = Scratch::new("pddl");
    for mission in MISSIONS {
        let folder = scratch.path(mission);
        let (text, code) = pddl(&[mission, "--out", &folder]);
        assert_eq!(code, Some(0), "{text}");
        let (text, code) = pddl(&[mission, "--plan", &format!("{folder}/plan")]);
        assert!(code == Some(0) && text.contains("the world accepts the plan"), "{mission}: {text}");
    }
}

#[test]
fn a_plan_that_the_world_refuses_is_named_with_its_line() {
    let scratch = Scratch::new("pddl-refused");
    for (plan, expected) in [
        ("(pick_up unicorn_1)\n", "line 1: there is no `unicorn_1` in the world"),
        ("; a remark\n(fly moon)\n", "line 2: `fly moon` is no action"),
        ("(pick_up tableround_02_1)\n", "line 1: the world refuses `pick_up` on TableRound_02_1"),
        ("(go_to tableround_02_1)\n", "the plan ends, and goals are not met"),
        ("", "there is no action in it"),
    ] {
        let file = scratch.write("plan", plan);
        let (text, code) = pddl(&["make_cereal", "--plan", &file]);
        assert!(code == Some(2) && text.contains(expected), "{text}");
    }
}

/// Where Fast Downward is.
fn fast_downward() -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    let names = ["fast-downward", "fast-downward.py"];
    std::env::split_paths(&path).flat_map(|folder| names.map(|name| folder.join(name))).find(|file| file.is_file())
}

#[test]
#[cfg_attr(not(fast_downward), ignore = "optional: Fast Downward")]
fn fast_downward_finds_plans_that_the_world_accepts() {
    let program = fast_downward().unwrap();
    let scratch = Scratch::new("pddl-downward");
    for mission in MISSIONS {
        let folder = scratch.path(mission);
        let (text, code) = pddl(&[mission, "--out", &folder]);
        assert_eq!(code, Some(0), "{text}");
        let plan = Path::new(&folder).join("found");
        let output = Command::new(&program)
            .args(["--plan-file", plan.to_str().unwrap(), "--sas-file", &format!("{folder}/output.sas")])
            .args(["--alias", "lama-first", &format!("{folder}/domain.pddl"), &format!("{folder}/problem.pddl")])
            .current_dir(&folder)
            .output()
            .unwrap();
        assert!(plan.is_file(), "{mission}: {}", String::from_utf8_lossy(&output.stdout));
        let (text, code) = pddl(&[mission, "--plan", plan.to_str().unwrap()]);
        assert!(code == Some(0) && text.contains("the world accepts the plan"), "{mission}: {text}");
    }
}
