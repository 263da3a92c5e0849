//! Missions solved from their goals alone: nothing is said, and the plan is carried out in a world.

#![allow(clippy::unwrap_used)]

mod support;

use std::{path::PathBuf, sync::Arc, time::Instant};

use cohabit_cdf::{ActionKind, Catalog, Layout, mission::read_mission};
use cohabit_planner::{Executor, Limits, Next, Plan, PlanError, plan};
use cohabit_world::{Action, BodyId, GoToTarget, Input, Status, World};
use serde_json::{Value, json};
use support::{mission, object};

const ME: BodyId = BodyId(0);
/// No command takes longer: one simulated minute.
const LONGEST_TICKS: u32 = 3600;
const TICKS_A_SECOND: f32 = 60.0;

fn reference(file: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/arena").join(file)
}

fn world(catalog: &Arc<Catalog>, id: &str, text: &str) -> World {
    let checked = read_mission(id, text, catalog).unwrap_or_else(|problems| panic!("{id}: {}", problems.0[0]));
    let mission = checked.mission;
    let layout = Layout::builtin(&mission.layout).unwrap_or_else(|_| Layout::builtin("OfficeLayout1").unwrap());
    World::new(Arc::clone(catalog), Arc::new(layout), Arc::new(mission), 11).unwrap()
}

fn planned(world: &World) -> Result<Plan, PlanError> {
    let met: Vec<bool> = world.goals().iter().map(|goal| goal.met).collect();
    plan(&world.symbols(ME), world.mission(), &met, &Limits::default())
}

fn run(world: &mut World, action: Action) -> (Status, String) {
    let command = world.tick() + 1;
    let mut inputs = vec![Input { command, body: ME, action }];
    for _ in 0..LONGEST_TICKS {
        let report = world.step(&inputs);
        inputs.clear();
        if let Some(outcome) = report.outcomes.into_iter().find(|outcome| outcome.command == command) {
            return (outcome.status, outcome.detail);
        }
    }
    panic!("{action:?} never came to an outcome");
}

/// Carries a plan out; what went wrong, if anything.
fn carry_out(world: &mut World, plan: &Plan) -> Result<(), String> {
    for step in &plan.steps {
        let (status, detail) = run(world, step.action);
        if !status.is_success() {
            return Err(format!("{}: {status:?}: {detail}", told(world, step.action)));
        }
        for _ in 0..step.wait_ticks(TICKS_A_SECOND) {
            world.step(&[]);
        }
    }
    world.step(&[]);
    let open: Vec<i64> = world.goals().iter().filter(|goal| !goal.met).map(|goal| goal.id).collect();
    let steps: Vec<String> = plan.steps.iter().map(|step| told(world, step.action)).collect();
    if open.is_empty() { Ok(()) } else { Err(format!("goals {open:?} are not met after {steps:?}")) }
}

fn told(world: &World, action: Action) -> String {
    let name = |id| world.object(id).map_or("?", |view| view.instance).to_owned();
    ActionKind::of(&action).map_or_else(|| format!("{action:?}"), |(kind, id)| format!("{} {}", kind.name(), name(id)))
}

/// Plans, and carries that out.
fn solve(world: &mut World) -> Result<Plan, String> {
    let plan = planned(world).map_err(|error| error.to_string())?;
    carry_out(world, &plan)?;
    Ok(plan)
}

#[test]
fn nothing_is_done_in_vain() {
    let catalog = Arc::new(Catalog::builtin());
    let (name, text) = cohabit_cdf::mission::builtin().iter().find(|(name, _)| name.starts_with("cold_soda")).unwrap();
    let world = world(&catalog, name, text);
    let plan = planned(&world).unwrap();
    let kinds = plan.steps.iter().filter_map(|step| ActionKind::of(&step.action)).map(|(kind, _)| kind);
    let deeds: Vec<ActionKind> = kinds.filter(|kind| *kind != ActionKind::GoTo).collect();
    assert_eq!(deeds, [ActionKind::PickUp, ActionKind::Place, ActionKind::Toggle]);
}

#[test]
#[cfg_attr(not(reference_data), ignore = "needs the reference data in ../shared/arena")]
fn real_missions_are_solved_from_their_goals() {
    let catalog = Arc::new(Catalog::builtin());
    let text = std::fs::read_to_string(reference("missions-dev.jsonl")).unwrap();
    let (mut times, mut unsolved, mut deeds) = (Vec::new(), Vec::new(), 0);
    for line in text.lines() {
        let mission: Value = serde_json::from_str(line).unwrap();
        let id = mission["id"].as_str().unwrap();
        let mut world = world(&catalog, id, &mission["cdf"].to_string());
        let started = Instant::now();
        let plan = planned(&world);
        times.push(started.elapsed());
        let result = plan.map_err(|error| error.to_string()).and_then(|plan| {
            deeds += plan.deeds();
            carry_out(&mut world, &plan)
        });
        unsolved.extend(result.err().map(|why| format!("{id}: {why}")));
    }
    times.sort();
    let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize];
    println!(
        "{} of {} missions solved, {deeds} deeds; planning: median {:?}, p99 {:?}, longest {:?}",
        times.len() - unsolved.len(),
        times.len(),
        at(0.5),
        at(0.99),
        at(1.0)
    );
    assert!(unsolved.is_empty(), "unsolved:\n{}", unsolved.join("\n"));
}

#[test]
#[cfg_attr(not(reference_data), ignore = "needs the reference data in ../shared/arena")]
fn the_missions_of_the_reference_are_solved() {
    let catalog = Arc::new(Catalog::builtin());
    let mut solved = 0;
    for entry in std::fs::read_dir(reference("cdf")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let mut world = world(&catalog, &name, &std::fs::read_to_string(&path).unwrap());
        let result = solve(&mut world);
        assert!(result.is_ok(), "{name}: {}", result.unwrap_err());
        solved += 1;
    }
    assert!(solved > 0);
}

#[test]
fn the_missions_of_the_project_are_solved() {
    let catalog = Arc::new(Catalog::builtin());
    for (name, text) in cohabit_cdf::mission::builtin() {
        let mut world = world(&catalog, name, text);
        let result = solve(&mut world);
        assert!(result.is_ok(), "{name}: {}", result.unwrap_err());
    }
}

#[test]
fn goals_of_many_kinds_are_reached() {
    let catalog = Arc::new(Catalog::builtin());
    for (objects, instance, state) in [
        (vec![object("CoffeeMug_Boss_1", &[])], "CoffeeMug_Boss_1", "isHot=true"),
        (vec![object("Bowl_01_1", &[])], "Bowl_01_1", "isFilled=Water"),
        (vec![object("Bowl_01_1", &[("isBroken", "true")])], "Bowl_01_1", "isBroken=false"),
        (vec![object("FoodPlate_01_1", &[("isDirty", "true")])], "FoodPlate_01_1", "isDirty=false"),
        (vec![object("BreadLoaf_1", &[]), object("Knife_01_1", &[])], "BreadSlice_01_*", "isPickedUp=true"),
        (vec![object("Apple_1", &[])], "Carrot_01_*", "isPickedUp=true"),
        (vec![object("CoffeeMug_Boss_1", &[])], "CoffeeMug_Boss_1", "isEmbiggenated=true"),
        (vec![object("CoffeeMug_Boss_1", &[])], "CoffeeMug_Boss_1", "isCold=true"),
        (vec![object("Bowl_01_1", &[]), object("Cereal_Box_01_1", &[])], "Bowl_01_1", "ContainsCereal=true"),
        (vec![object("CoffeeMug_Boss_1", &[]), object("CoffeeBeans_01_1", &[])], "CoffeeMug_Boss_1", "isFilled=Coffee"),
        (vec![], "Computer_Monitor_01_1", "isScanned=true"),
        (vec![], "VendingMachine_01_B4_Button_*", "isUsed=true"),
        (vec![object("Floppy_Virus_1", &[])], "Computer_Monitor_01_1", "isInfected=true"),
        (vec![object("Bowl_01_1", &[]), object("Hammer_1", &[])], "Bowl_01_1", "isBroken=true"),
    ] {
        let mut world = world(&catalog, instance, &mission(&objects, instance, state, false));
        let result = solve(&mut world);
        assert!(result.is_ok(), "{instance} {state}: {}", result.unwrap_err());
    }
}

#[test]
fn what_cannot_be_is_said_with_its_reason() {
    let catalog = Arc::new(Catalog::builtin());
    let without = |class: &str| object(&format!("{class}_1"), &[("Blacklist", "true")]);
    for (objects, instance, state, reason) in [
        (vec![object("Bowl_01_1", &[])], "Bowl_01_1", "isSparking=true", "nothing here makes the bowl be sparking"),
        (
            vec![
                object("CoffeeMug_Boss_1", &[]),
                object("FridgeUpper_02_1", &[("isLocked", "true")]),
                object("V_Monitor_FreezeRay_1", &[("Blacklist", "true")]),
                without("FuseBox_01"),
            ],
            "CoffeeMug_Boss_1",
            "isCold=true",
            "is locked: it does not open by hand",
        ),
    ] {
        let world = world(&catalog, instance, &mission(&objects, instance, state, false));
        match planned(&world) {
            Err(PlanError::Unreachable { goal: 4, description, reason: found }) => {
                assert_eq!(description, "Get it done");
                assert!(found.contains(reason), "{found}");
            }
            other => panic!("{instance} {state}: {other:?}"),
        }
    }
}

/// A bin that dirties what is in it, if it is not empty: no code knows of it.
const LAB: &str = r#"
[[device]]
class = ["TrashCan_01"]
always = true
needs = [["it is occupied", "ActionExecutionError", "{it} is empty: something has to be put in first"]]
press = ["run it"]
work = "soil"
moment_s = 4.0

[[work]]
name = "soil"
over = "contents"
effects = [{ if = ["thing affords DIRTYABLE"], do = ["set thing Dirty"] }]
"#;

#[test]
fn a_device_of_the_table_alone_is_planned_with_and_works() {
    let files: Vec<_> = Catalog::builtin_table().iter().copied().chain([("lab.toml", LAB)]).collect();
    let catalog = Arc::new(Catalog::builtin().with_table(&files).unwrap());
    let text = mission(
        &[object("FoodPlate_01_1", &[("isDirty", "false"), ("Unique", "true")])],
        "FoodPlate_01_1",
        "isDirty=true",
        false,
    );
    let mut world = world(&catalog, "soil", &text);
    let plan = solve(&mut world).unwrap();
    let last = plan.steps.last().map(|step| told(&world, step.action)).unwrap();
    assert!(last.starts_with("toggle TrashCan_01"), "{last}");
}

/// Has an executor play, and does something between its actions.
fn play(world: &mut World, executor: &mut Executor, mut between: impl FnMut(&mut World, Action)) {
    const MOST_STEPS: usize = 400;
    for _ in 0..MOST_STEPS {
        let met: Vec<bool> = world.goals().iter().map(|goal| goal.met).collect();
        match executor.next(&world.symbols(ME), &met) {
            Next::Act(action) => {
                let (status, detail) = run(world, action);
                executor.outcome(status, &detail);
                between(world, action);
            }
            Next::Wait(ticks) => {
                for _ in 0..ticks {
                    world.step(&[]);
                }
            }
            Next::Over => return,
        }
    }
    panic!("it never came to an end");
}

fn executor(world: &World) -> Executor {
    Executor::new(Arc::clone(world.mission()), Limits::default(), TICKS_A_SECOND)
}

fn is_done(world: &World) -> bool {
    world.goals().iter().all(|goal| goal.met)
}

#[test]
fn an_executor_plays_the_missions_of_the_project_with_one_plan_each() {
    let catalog = Arc::new(Catalog::builtin());
    for (name, text) in cohabit_cdf::mission::builtin() {
        let mut world = world(&catalog, name, text);
        let mut executor = executor(&world);
        play(&mut world, &mut executor, |_, _| {});
        assert!(is_done(&world), "{name}: {:?}, {:?}", executor.given_up(), executor.failures());
        assert!(executor.failures().is_empty(), "{name}: {:?}", executor.failures());
        assert!(executor.plans() <= 3, "{name}: {} plans", executor.plans());
    }
}

#[test]
fn an_executor_plans_anew_when_what_it_held_is_put_elsewhere() {
    let catalog = Arc::new(Catalog::builtin());
    let text = mission(&[object("CoffeeMug_Boss_1", &[])], "CoffeeMug_Boss_1", "isHot=true", false);
    let mut world = world(&catalog, "taken", &text);
    let mug = world.find("CoffeeMug_Boss_1").unwrap();
    let table = world.find("TableRound_02_1").unwrap();
    let mut executor = executor(&world);
    let mut taken = 0;
    play(&mut world, &mut executor, |world, action| {
        if action == (Action::PickUp { object: mug }) && taken == 0 {
            taken += 1;
            run(world, Action::GoTo { target: GoToTarget::Object(table) });
            assert!(run(world, Action::Place { receptacle: table }).0.is_success());
        }
    });
    assert_eq!(taken, 1);
    assert!(is_done(&world), "{:?}", executor.given_up());
    assert!(executor.plans() >= 2, "{} plans", executor.plans());
}

#[test]
fn an_executor_reaches_what_it_can_and_says_what_it_cannot() {
    let catalog = Arc::new(Catalog::builtin());
    let objects = [object("Bowl_01_1", &[]), object("CoffeeMug_Boss_1", &[])];
    let mut text: Value = serde_json::from_str(&mission(&objects, "Bowl_01_1", "isSparking=true", false)).unwrap();
    let goal = |number: i64, state: Value, before: &[i64]| {
        let mut goal = text["task_goals"][0].clone();
        goal["goal_id"] = json!(number);
        goal["object_states"] = json!([state]);
        goal["preconditions"] = json!(before);
        goal
    };
    let hot = goal(5, json!({ "CoffeeMug_Boss_1": "isHot=true" }), &[]);
    let filled = goal(6, json!({ "Bowl_01_1": "isFilled=Water" }), &[4]);
    let goals = json!([text["task_goals"][0].clone(), hot, filled]);
    text["task_goals"] = goals;
    let mut world = world(&catalog, "half", &text.to_string());
    let mut executor = executor(&world);
    play(&mut world, &mut executor, |_, _| {});
    let met: Vec<i64> = world.goals().iter().filter(|goal| goal.met).map(|goal| goal.id).collect();
    assert_eq!(met, [5], "{:?}", executor.given_up());
    let given_up: Vec<_> = executor.given_up().iter().map(|one| (one.goal, one.to_string())).collect();
    assert_eq!(given_up.len(), 2, "{given_up:?}");
    assert!(given_up[0].0 == Some(4) && given_up[0].1.contains("nothing here makes the bowl be sparking"));
    assert!(given_up[1].0 == Some(6) && given_up[1].1.contains("only after goal 4"));
}

#[test]
fn what_the_world_refuses_twice_is_done_without() {
    let catalog = Arc::new(Catalog::builtin());
    let text = mission(&[object("CoffeeMug_Boss_1", &[])], "CoffeeMug_Boss_1", "isHot=true", false);
    let mut world = world(&catalog, "refused", &text);
    let mut executor = executor(&world);
    // All that is done with the mug is refused: it cannot be got at.
    let mug = world.find("CoffeeMug_Boss_1").unwrap();
    let mut asked = 0;
    loop {
        match executor.next(&world.symbols(ME), &[false]) {
            Next::Act(action) if ActionKind::of(&action).is_some_and(|(_, id)| id == mug) => {
                asked += 1;
                executor.outcome(Status::UnsupportedNavigation, "there is no way there");
            }
            Next::Act(action) => {
                let (status, detail) = run(&mut world, action);
                executor.outcome(status, &detail);
            }
            Next::Wait(_) => {}
            Next::Over => break,
        }
    }
    assert_eq!(asked, 2);
    let reason = executor.given_up()[0].to_string();
    let tried = "(tried: go_to CoffeeMug_Boss_1: UnsupportedNavigation: there is no way there)";
    assert!(reason.contains(tried), "{reason}");
}
