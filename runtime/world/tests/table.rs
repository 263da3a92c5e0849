//! The table of actions and devices against the world: in missions, floor plans and states drawn at random, and for every action
//! on every class of things, whatever is tried comes to the status that the table predicts, and changes what it predicts and nothing
//! else.
//!
//! `COHABIT_TABLE_WORLDS=1000` tries more worlds, `PROPTEST_CASES=100` more states of each class, `COHABIT_TABLE_SEED=7` others.

#![allow(clippy::unwrap_used)]

mod bare;
mod support;

use std::{
    cell::RefCell,
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
};

use cohabit_cdf::{
    ActionKind, Catalog, Layout, Mission, ObjectClass, ObjectId, Property, RoomId, StateFlag, Status,
    catalog::table::{View as _, takes},
    symbolic::{Place, Successor, SymbolicState},
};
use cohabit_world::{Action, BodyId, GoToTarget, Input, World};
use proptest::{
    prelude::*,
    sample::Index,
    test_runner::{Config, RngAlgorithm, TestCaseError, TestRng, TestRunner},
};
use support::chance::{self, Chance};

const ME: BodyId = BodyId(0);
const WORLDS: usize = 50;
const VISITS: usize = 24;
const TRIES: usize = 16;
/// Encounters with each class.
const ENCOUNTERS: u32 = 4;
/// A command that takes longer hangs: one simulated minute.
const LONGEST_TICKS: u32 = 3600;
/// From an outcome until the machine that it set going has done its work, and until all is over.
const WORK_TICKS: u32 = 20;
const MOMENT_TICKS: u32 = 130;
const FLIGHT_TICKS: u32 = 300;
/// Doors and hands come to rest.
const SETTLE_TICKS: u32 = 60;

#[derive(Default)]
struct Coverage {
    tried: usize,
    rules: BTreeMap<(String, String), usize>,
    pressed: BTreeMap<String, [usize; 2]>,
    worlds: usize,
}

/// Runs a command to its outcome.
fn play(world: &mut World, action: Action) -> Status {
    let command = world.tick() + 1;
    let mut inputs = vec![Input { command, body: ME, action }];
    for _ in 0..LONGEST_TICKS {
        let report = world.step(&inputs);
        inputs.clear();
        if let Some(outcome) = report.outcomes.iter().find(|outcome| outcome.command == command) {
            return outcome.status;
        }
    }
    panic!("{action:?} never came to an outcome");
}

fn wait(world: &mut World, ticks: u32) {
    for _ in 0..ticks {
        world.step(&[]);
    }
}

/// What two states differ in, in words; what is thrown may knock other things about.
fn differences(before: &SymbolicState, predicted: &SymbolicState, found: &SymbolicState, thrown: bool) -> Vec<String> {
    // What stood on something that was taken away falls, and knocks others about, too.
    let places = || predicted.things.iter().zip(&found.things).map(|(one, other)| (&one.place, &other.place));
    let thrown = thrown || places().any(|(one, other)| *one == Place::Own && *other != Place::Own);
    let mut all = Vec::new();
    let mut say = |what: String| all.push(what);
    if predicted.things.len() != found.things.len() {
        say(format!("{} things predicted, {} found", predicted.things.len(), found.things.len()));
    }
    for (index, (one, other)) in predicted.things.iter().zip(&found.things).enumerate() {
        let name = &other.instance;
        if (one.class, &one.instance, &one.aliases) != (other.class, &other.instance, &other.aliases) {
            say(format!("{name}: {} predicted", one.instance));
        }
        if one.flags != other.flags {
            let list = |flags: cohabit_cdf::StateFlags| flags.iter().collect::<BTreeSet<StateFlag>>();
            say(format!("{name}: {:?} predicted, {:?} found", list(one.flags), list(other.flags)));
        }
        if (one.fluid, one.color, one.touched) != (other.fluid, other.color, other.touched) {
            say(format!(
                "{name}: {:?} predicted, {:?} found",
                (one.fluid, one.color, one.touched),
                (other.fluid, other.color, other.touched)
            ));
        }
        if one.was != other.was {
            say(format!("{name}: it was something else"));
        }
        if one.scale.iter().zip(other.scale).any(|(one, other)| (one - other).abs() > 1e-3) {
            say(format!("{name}: another size"));
        }
        let was = before.things.get(index).map(|thing| &thing.place);
        if !thrown && !is_same_place(was, &one.place, &other.place) {
            say(format!("{name}: {:?} predicted, {:?} found", one.place, other.place));
        }
    }
    if predicted.held != found.held || predicted.alive != found.alive {
        say(format!("held {:?} predicted, {:?} found", predicted.held, found.held));
    }
    if predicted.circuits != found.circuits {
        say("other circuits".to_owned());
    }
    all
}

/// Which of several free anchors a hand takes is geometry, as is where something comes to lie that flew or fell.
fn is_same_place(was: Option<&Place>, predicted: &Place, found: &Place) -> bool {
    match (predicted, found) {
        (Place::On { parent, within, .. }, Place::On { parent: other, within: inner, .. }) => {
            parent == other && within == inner
        }
        (Place::Loose, Place::Own | Place::On { .. } | Place::Loose) => true,
        (Place::Own, Place::Loose | Place::On { .. }) => was == Some(&Place::Own),
        _ => predicted == found,
    }
}

/// Tries one action, and compares.
fn check(world: &mut World, action: ActionKind, it: ObjectId, coverage: &mut Coverage) -> Result<Status, String> {
    let before = world.symbols(ME);
    let Some(Successor { status, rule, lack, running, state }) = before.successor(action, it) else {
        return Err(format!("no rule for {action:?}"));
    };
    let found = play(world, action.on(it));
    let name = &before.thing(it).instance;
    let held = before.held.map_or("nothing", |held| &before.thing(held).instance);
    let what = format!(
        "{action:?} {name} ({:?}) with {held}, rule `{rule}` {lack}",
        before.thing(it).flags.iter().collect::<Vec<_>>()
    );
    if found != status {
        return Err(format!("{what}: {status:?} predicted, {found:?} found"));
    }
    coverage.tried += 1;
    *coverage.rules.entry((rule, format!("{found:?}"))).or_default() += 1;
    if action == ActionKind::Toggle {
        let class = before.class(it).id.clone();
        if before.catalog.table().is_device(&class) {
            coverage.pressed.entry(class).or_default()[usize::from(!found.is_success())] += 1;
        }
    }
    if let Some(running) = running {
        wait(world, WORK_TICKS);
        let wrong = differences(&before, &running, &world.symbols(ME), false);
        if !wrong.is_empty() {
            return Err(format!("{what}, while it runs: {wrong:#?}"));
        }
        wait(world, MOMENT_TICKS);
    }
    if found.is_success() {
        wait(world, if action == ActionKind::Throw { FLIGHT_TICKS } else { SETTLE_TICKS });
    }
    let after = world.symbols(ME);
    if state.alive && !after.alive {
        // What is live on the floor kills whoever steps on it: that is no action.
        return Ok(found);
    }
    let wrong = differences(&before, &state, &after, action == ActionKind::Throw);
    if wrong.is_empty() { Ok(found) } else { Err(format!("{what}: {wrong:#?}")) }
}

/// What somebody would try who stands here: mostly what is at hand, and what makes some sense.
fn choose(state: &SymbolicState, chance: &mut Chance) -> Option<(ActionKind, ObjectId)> {
    use ActionKind as Kind;
    let reachable = state.existing().filter(|id| state.thing(*id).access.reach_m < 2.0);
    let near: Vec<ObjectId> = reachable.filter(|id| state.held != Some(*id)).collect();
    let all: Vec<ObjectId> = state.existing().collect();
    let of = |property: Property| near.iter().copied().filter(|id| state.class(*id).has(property)).collect::<Vec<_>>();
    let is_basin = |id: &ObjectId| state.catalog.table().is_basin(&state.class(*id).id);
    let fitting: &[Kind] = if state.held.is_some() {
        &[Kind::Place, Kind::Pour, Kind::Fill, Kind::Clean, Kind::Break, Kind::Toggle]
    } else {
        &[Kind::PickUp, Kind::Open, Kind::Close, Kind::Toggle]
    };
    let kind = match chance.below(40) {
        0 => Kind::Throw,
        1..14 => ActionKind::ALL[1 + chance.below(ActionKind::ALL.len() - 1)],
        _ => chance.pick(fitting)?,
    };
    let likely = match kind {
        Kind::PickUp => of(Property::Pickupable),
        Kind::Place => of(Property::Receptacle),
        Kind::Open | Kind::Close => of(Property::Openable),
        Kind::Toggle => of(Property::Toggleable),
        Kind::Break => [of(Property::Breakable), of(Property::Cuttable)].concat(),
        Kind::Pour => of(Property::Fillable),
        Kind::Clean | Kind::Fill => near.iter().copied().filter(is_basin).collect(),
        _ => near.clone(),
    };
    let id = match chance.below(20) {
        0 => chance.pick(&all),
        1..4 => chance.pick(&near),
        4 => state.held,
        _ => chance.pick(&likely),
    };
    Some((kind, id?))
}

/// Where somebody goes next: to a thing with an empty hand, else to what takes or suits what is held, or to a device.
fn next_goal(state: &SymbolicState, last: Option<ObjectId>, chance: &mut Chance) -> Option<ObjectId> {
    let table = state.catalog.table();
    let all: Vec<ObjectId> = state.existing().filter(|id| !state.is(*id, StateFlag::Sparking)).collect();
    let that = |fits: &dyn Fn(ObjectId) -> bool| all.iter().copied().filter(|id| fits(*id)).collect::<Vec<_>>();
    let has = |id: ObjectId, property: Property| state.class(id).has(property);
    // Whoever has put something into a machine presses its button.
    let buttons = that(&|id| last.is_some() && state.thing(id).works == last && has(id, Property::Toggleable));
    if !buttons.is_empty() && !chance.one_in(3) {
        return chance.pick(&buttons);
    }
    let devices = that(&|id| table.is_device(&state.class(id).id) || has(id, Property::Toggleable));
    let Some(held) = state.held else {
        let things = that(&|id| has(id, Property::Pickupable) && !state.thing(id).touched);
        let pool = if chance.one_in(3) || things.is_empty() { &devices } else { &things };
        return chance.pick(pool);
    };
    let class = &state.class(held).id;
    let keyed = that(&|id| state.class(id).receptacle.as_ref().is_some_and(|kind| kind.keys.contains(class)));
    let machines = that(&|id| {
        let holds = has(id, Property::Receptacle) && takes(state.class(id), class);
        holds && (has(id, Property::Powerable) || has(id, Property::Toggleable))
    });
    let suits = that(&|id| match class.as_str() {
        "Hammer" => has(id, Property::Breakable),
        "Knife_01" => has(id, Property::Cuttable),
        "CoffeeBeans_01" => state.class(id).id == "CoffeeMaker_01",
        "Cereal_Box_01" => state.class(id).id == "Bowl_01",
        _ => {
            let fills = table.affords(ActionKind::Fill, state.class(id), Some(state.class(held)));
            fills
                || table.is_basin(&state.class(id).id)
                || (has(held, Property::Fillable) && has(id, Property::Fillable))
        }
    });
    let gates = that(&|id| state.gate(id).is_some() && state.is(id, StateFlag::Toggled));
    let pools = [keyed, machines, suits, gates, that(&|id| has(id, Property::Receptacle))];
    let pools: Vec<&Vec<ObjectId>> = pools.iter().filter(|pool| !pool.is_empty()).collect();
    chance.pick(&pools).and_then(|pool| chance.pick(pool))
}

/// What is done first where somebody went on purpose.
fn purpose(state: &SymbolicState, goal: ObjectId) -> Vec<(ActionKind, ObjectId)> {
    use ActionKind as Kind;
    let has = |property: Property| state.class(goal).has(property);
    let mut steps = Vec::new();
    match state.held {
        None if has(Property::Pickupable) => steps.push((Kind::PickUp, goal)),
        None => {}
        Some(held) if state.catalog.table().is_basin(&state.class(goal).id) => {
            let running = state.is(goal, StateFlag::Toggled);
            steps.extend((!running).then_some((Kind::Toggle, goal)));
            steps.extend([
                (Kind::Clean, held),
                (Kind::Clean, goal),
                (Kind::Fill, held),
                (Kind::Fill, goal),
                (Kind::Pour, goal),
            ]);
            steps.extend([(Kind::Fill, goal), (Kind::Place, goal), (Kind::Clean, held), (Kind::Fill, held)]);
        }
        Some(_) => {
            steps.extend([Kind::Break, Kind::Pour, Kind::Fill, Kind::Open, Kind::Place].map(|kind| (kind, goal)))
        }
    }
    steps.extend(has(Property::Openable).then_some((Kind::Close, goal)));
    steps.extend(has(Property::Toggleable).then_some((Kind::Toggle, goal)));
    steps
}

fn live(world: &mut World, chance: &mut Chance, coverage: &mut Coverage) -> Result<(), String> {
    let mut last = None;
    for _ in 0..VISITS {
        let state = world.symbols(ME);
        let Some(goal) = next_goal(&state, last, chance) else { continue };
        last = Some(goal);
        play(world, Action::GoTo { target: GoToTarget::Object(goal) });
        wait(world, SETTLE_TICKS);
        let planned = purpose(&world.symbols(ME), goal);
        for attempt in 0..TRIES {
            let state = world.symbols(ME);
            if !state.alive || world.finished().is_some() {
                return Ok(());
            }
            // What was put into a machine by purpose stays there until its button is pressed.
            if attempt >= planned.len() && state.held.is_none() && chance.one_in(6) {
                break;
            }
            let chosen = planned.get(attempt).copied().or_else(|| choose(&state, chance));
            let Some((kind, id)) = chosen else { continue };
            check(world, kind, id, coverage)?;
        }
    }
    Ok(())
}

#[test]
fn whatever_is_tried_comes_to_what_the_table_says() {
    let (worlds, seed) = (number("COHABIT_TABLE_WORLDS", WORLDS), number("COHABIT_TABLE_SEED", 1));
    let catalog = Arc::new(Catalog::builtin());
    let mut coverage = Coverage::default();
    let mut wrong = Vec::new();
    for index in 0..worlds {
        let mut chance = Chance((seed * 1_000_003 + index) as u64);
        let Some(mut world) = chance::world(&catalog, &mut chance) else { continue };
        coverage.worlds += 1;
        if let Err(fault) = live(&mut world, &mut chance, &mut coverage) {
            wrong.push(format!("world {index}, {}: {fault}", world.layout().id));
        }
    }
    print(&coverage, &catalog);
    assert!(wrong.is_empty(), "{} of {} worlds went otherwise:\n{}", wrong.len(), coverage.worlds, wrong.join("\n"));
    let reached: BTreeSet<&String> = coverage.rules.keys().map(|(rule, _)| rule).collect();
    let missed: Vec<&String> =
        catalog.table().rules().iter().map(|rule| &rule.name).filter(|name| !reached.contains(name)).collect();
    let missed: Vec<_> = missed.into_iter().filter(|name| *name != "go to").collect();
    assert!(missed.is_empty() || worlds < WORLDS, "no world ever came to these rules: {missed:?}");
}

fn number(name: &str, default: usize) -> usize {
    std::env::var(name).map_or(default, |text| text.parse().unwrap())
}

/// A room with a thing of a class in it, and one that may be taken in hand before, both in states drawn at random.
fn room(catalog: &Arc<Catalog>, class: &ObjectClass, tool: &ObjectClass, chance: &mut Chance) -> Option<World> {
    let mut objects = vec![chance::request(class, 7, chance), chance::request(tool, 8, chance)];
    objects.iter_mut().for_each(|object| object.room = Some(RoomId::RECEPTION));
    let placed = objects.iter().zip([[4.5, 2.5], [1.5, 1.0]]).map(|(object, [x, y])| {
        format!("  {{ instance = \"{}\", room = \"Reception\", at_m = [{x:?}, {y:?}, 0.0] }},\n", object.instance)
    });
    let text = format!("{}\nplacement = [\n{}]\n", bare::TWO_ROOMS, placed.collect::<String>());
    let layout = Layout::parse("Bare", &[("Bare.toml", &text)]).unwrap();
    let mission = Mission {
        name: "encounter".to_owned(),
        layout: "Bare".to_owned(),
        seed: Some(0),
        start_room: RoomId::RECEPTION,
        objects,
        ..Mission::default()
    };
    World::new(Arc::clone(catalog), Arc::new(layout), Arc::new(mission), 1).ok()
}

/// Tries all actions on a thing of a class, one after the other; in most worlds with something in the hand.
fn encounter(
    catalog: &Arc<Catalog>,
    class: &ObjectClass,
    tool: &ObjectClass,
    chance: &mut Chance,
    tried: &mut BTreeSet<(String, ActionKind)>,
) -> Result<(), String> {
    let Some(mut world) = room(catalog, class, tool, chance) else { return Ok(()) };
    let find = |world: &World, class: &ObjectClass, number: u32| world.find(&format!("{}_{number}", class.id));
    let Some(it) = find(&world, class, 7) else { return Ok(()) };
    if let Some(tool) = find(&world, tool, 8).filter(|_| !chance.one_in(4)) {
        play(&mut world, Action::GoTo { target: GoToTarget::Object(tool) });
        play(&mut world, Action::PickUp { object: tool });
    }
    play(&mut world, Action::GoTo { target: GoToTarget::Object(it) });
    wait(&mut world, SETTLE_TICKS);
    // Where a body can walk is no rule of the table. What is thrown is gone, and what is pressed may be live.
    let last = [ActionKind::Throw, ActionKind::Toggle];
    let mut kinds: Vec<ActionKind> = ActionKind::ALL.into_iter().filter(|kind| !last.contains(kind)).collect();
    kinds.retain(|kind| *kind != ActionKind::GoTo);
    for index in (1..kinds.len()).rev() {
        kinds.swap(index, chance.below(index + 1));
    }
    let mut coverage = Coverage::default();
    for kind in kinds.into_iter().chain(last) {
        if !world.symbols(ME).alive || world.finished().is_some() || !world.exists(it) {
            break;
        }
        check(&mut world, kind, it, &mut coverage)?;
        tried.insert((class.id.clone(), kind));
    }
    Ok(())
}

#[test]
fn every_action_on_every_class_comes_to_what_the_table_says() {
    let catalog = Arc::new(Catalog::builtin());
    let tools: Vec<&ObjectClass> = catalog.classes().iter().filter(|class| class.has(Property::Pickupable)).collect();
    let cases = u32::try_from(number("PROPTEST_CASES", ENCOUNTERS as usize)).unwrap();
    let mut seed = [0; 32];
    seed[..8].copy_from_slice(&(number("COHABIT_TABLE_SEED", 1) as u64).to_le_bytes());
    let config = Config { cases, failure_persistence: None, max_shrink_iters: 0, ..Config::default() };
    let tried = RefCell::new(BTreeSet::new());
    let mut wrong = Vec::new();
    // Notes hang at places of their own, which a bare room does not have.
    let classes: Vec<&ObjectClass> = catalog.classes().iter().filter(|class| class.id != "StickyNote").collect();
    for (index, class) in (0_u32..).zip(&classes) {
        // A runner counts its cases for all that it runs.
        seed[8..12].copy_from_slice(&index.to_le_bytes());
        let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &seed);
        let mut runner = TestRunner::new_with_rng(config.clone(), rng);
        let result = runner.run(&(any::<u64>(), any::<Index>()), |(states, tool)| {
            let tool = *tool.get(&tools);
            let found = encounter(&catalog, class, tool, &mut Chance(states), &mut tried.borrow_mut());
            found.map_err(TestCaseError::fail)
        });
        wrong.extend(result.err().map(|error| format!("{}: {error}", class.id)));
    }
    assert!(wrong.is_empty(), "{} of {} classes went otherwise:\n{}", wrong.len(), classes.len(), wrong.join("\n"));
    let tried = tried.into_inner();
    println!("{} actions on {} classes", tried.len(), classes.len());
    let kinds = ActionKind::ALL.into_iter().filter(|kind| *kind != ActionKind::GoTo);
    let all = kinds.flat_map(|kind| classes.iter().map(move |class| (class.id.clone(), kind)));
    let missed: Vec<_> = all.filter(|pair| !tried.contains(pair)).collect();
    assert!(missed.is_empty() || cases < ENCOUNTERS, "never tried: {missed:?}");
}

fn print(coverage: &Coverage, catalog: &Catalog) {
    println!("{} actions in {} worlds", coverage.tried, coverage.worlds);
    for ((rule, status), count) in &coverage.rules {
        println!("{rule:28} {status:24} {count:6}");
    }
    for (class, [done, refused]) in &coverage.pressed {
        println!("{class:32} pressed {done:5}, refused {refused:5}");
    }
    let all = catalog.table().devices().iter().flat_map(|device| &device.classes);
    let never: Vec<_> = all.filter(|class| !coverage.pressed.contains_key(*class)).collect();
    println!("never pressed: {never:?}");
}
