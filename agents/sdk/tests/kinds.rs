//! The kinds of agents at work: the same wherever they run, and each worth its name.
#![allow(clippy::unwrap_used)]

mod cast;

use std::{
    process::{Command, Stdio},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
};

use cast::{Played, catalog, plan, play};
use cohabit_agent::{
    Agent, Crowd, Deed, Expert, Floor, Heard, Helper, PlanFollower, Random, Schedule, Script, Scripted,
    TICKS_PER_SECOND,
};
use cohabit_bus::{
    Local, Session, Shm,
    message::{DialogKind, DialogMessage, PlanStep},
};
use cohabit_cdf::{Action, BodyId, GoToTarget, Property, RoomId, StateFlag};
use cohabit_engine::SessionPlan;
use cohabit_world::Vec2;
use rand_chacha::{
    ChaCha8Rng,
    rand_core::{Rng, SeedableRng},
};

/// Set for a process that is to run an agent for the session of that name.
const SESSION: &str = "COHABIT_TEST_SESSION";
const SEED: u64 = 5;

fn scripted(body: u32, text: &str) -> Box<dyn Agent + Send> {
    Box::new(Scripted::new(body, Script::parse("test", text, &catalog()).unwrap()))
}

/// A session in shared memory that is wiped away when it goes out of scope.
struct InShared {
    session: Session,
    end: Option<Box<dyn FnOnce()>>,
}

impl InShared {
    fn new(name: &str) -> Self {
        let session = Session::new(&format!("{name}-{}", std::process::id())).unwrap();
        let lock = session.supervise().unwrap();
        let ended = session.clone();
        Self { session, end: Some(Box::new(move || ended.end(lock))) }
    }

    fn join(&self) -> Shm {
        Shm::join(&self.session).unwrap()
    }
}

impl Drop for InShared {
    fn drop(&mut self) {
        if let Some(end) = self.end.take() {
            end();
        }
    }
}

fn assert_same(one: &Played, other: &Played) {
    let differs = one.digests.iter().find(|(tick, digest)| other.digests.get(tick) != Some(digest));
    let at = differs.map(|(tick, _)| *tick);
    let about = |played: &Played| {
        let ended: Vec<_> = played.outcomes.iter().filter(|ended| at.is_some_and(|at| ended.tick <= at)).collect();
        format!("{} time-outs, {:#?}", played.timeouts, ended.iter().rev().take(4).collect::<Vec<_>>())
    };
    assert_eq!(at, None, "the first tick that differs\n{}\n{}", about(one), about(other));
}

#[test]
fn a_second_has_so_many_ticks() {
    assert_eq!((1e9 / cohabit_world::DT_NANOS as f64).round() as u64, TICKS_PER_SECOND);
}

/// Not a test by itself: what the next one runs in another process.
#[test]
#[ignore = "a process that other tests start"]
fn works_as_a_process() {
    let name = std::env::var(SESSION).unwrap();
    let bus = Shm::join(&Session::new(&name).unwrap()).unwrap();
    // The session's end kills it.
    cohabit_agent::run(&mut Random::new(SEED), 0, &bus, &AtomicBool::new(false)).unwrap();
}

#[test]
fn an_agent_acts_the_same_in_a_thread_over_shared_memory_and_in_a_process_of_its_own() {
    const TICKS: u64 = 900;
    let agent = || vec![(0, Box::new(Random::new(SEED)) as Box<dyn Agent + Send>)];
    let local = play(plan(0, 3, &[]), &Local::new(1), agent(), 0, TICKS);
    let acted = local.outcomes.iter().filter(|ended| ended.status.is_success()).count();
    assert!(acted >= 2, "{:?}", local.outcomes);
    let shared = InShared::new("thread");
    assert_same(&local, &play(plan(0, 3, &[]), &shared.join(), agent(), 0, TICKS));
    let shared = InShared::new("process");
    let mut process = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "works_as_a_process", "--ignored"])
        .env(SESSION, shared.session.name())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let apart = play(plan(0, 3, &[]), &shared.join(), Vec::new(), 1, TICKS);
    process.kill().unwrap();
    process.wait().unwrap();
    assert_same(&local, &apart);
    assert_eq!((local.timeouts, apart.timeouts), (0, 0));
}

#[test]
fn another_seed_leads_elsewhere() {
    let digest = |seed| {
        let agent = vec![(0, Box::new(Random::new(seed)) as Box<dyn Agent + Send>)];
        play(plan(0, 3, &[]), &Local::new(1), agent, 0, 300).digests[&300]
    };
    assert_eq!(digest(1), digest(1));
    assert_ne!(digest(1), digest(2));
}

/// Asks a body for a plan, once.
struct Director {
    for_body: u32,
    told: bool,
}

impl Agent for Director {
    fn hear(&mut self, heard: &Heard<'_>, deeds: &mut Vec<Deed>) {
        if let Heard::Now(now) = heard
            && now.tick >= 20
            && !std::mem::replace(&mut self.told, true)
        {
            let actions = [
                Action::GoTo { target: GoToTarget::Room(RoomId::BREAK_ROOM) },
                Action::LookAround,
                Action::GoTo { target: GoToTarget::Room(RoomId::MAIN_OFFICE) },
            ];
            let mut plan = DialogMessage::new(DialogKind::Plan, self.for_body, 1, "");
            plan.steps = actions.iter().map(|act| PlanStep { action: (*act).into(), ..PlanStep::default() }).collect();
            deeds.push(Deed::Tell(Box::new(plan)));
        }
        deeds.push(Deed::Rest(TICKS_PER_SECOND));
    }
}

#[test]
fn many_at_once_act_the_same_in_every_run() {
    const TICKS: u64 = 900;
    let script = "on-failure continue\ngoto class Desk_01\nlook-around\nwait 1\nsay hey\nrotate 90\nmove 0.5\nloop";
    let agents = || -> Vec<(u32, Box<dyn Agent + Send>)> {
        vec![
            (0, Box::new(PlanFollower::new(0))),
            (1, Box::new(Random::new(SEED))),
            (2, scripted(2, script)),
            (3, Box::new(Helper::new(3, SEED))),
            (4, Box::new(Director { for_body: 0, told: false })),
        ]
    };
    let plan = || plan(2, 3, &["robot@BreakRoom", "person@Lab1", "robot@MainOffice", "person@Warehouse"]);
    let first = play(plan(), &Local::new(1), agents(), 0, TICKS);
    for body in 0..4 {
        let done = first.outcomes.iter().filter(|ended| ended.body == body && ended.status.is_success()).count();
        assert!(done >= 1, "body {body}: {:?}", first.outcomes);
    }
    assert!(first.said.contains(&(2, "hey".to_owned())));
    let shared = InShared::new("many");
    assert_same(&first, &play(plan(), &shared.join(), agents(), 0, TICKS));
}

#[test]
fn a_script_is_done_line_by_line_and_stops_at_a_failure() {
    let script = "goto class Desk_01\nhighlight class Desk_01\nrotate 90\npickup Bowl_01_99\nsay never";
    let played = play(plan(2, 3, &[]), &Local::new(1), vec![(0, scripted(0, script))], 0, 3000);
    let done: Vec<_> = played.outcomes.iter().map(|ended| ended.status.is_success()).collect();
    assert_eq!(done, [true, true, true], "{:?}", played.outcomes);
    let said: Vec<_> = played.said.iter().map(|(_, words)| words.as_str()).collect();
    assert_eq!(said, ["I stop at line 4 of my script: there is no `Bowl_01_99` here."]);
}

/// What a rowdy does: opens some things, switches some on, and throws some around.
fn mess(plan: &SessionPlan, seed: u64) -> String {
    let world = plan.build().unwrap();
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut some = |most: usize, mut of: Vec<String>| {
        let mut chosen = Vec::new();
        while chosen.len() < most && !of.is_empty() {
            chosen.push(of.swap_remove((rng.next_u64() % of.len() as u64) as usize));
        }
        chosen
    };
    let all = |property: Property, classes: &[&str]| -> Vec<String> {
        let objects = world.objects().filter(|object| {
            let class = catalog().class(object.class).clone();
            let is_meant = classes.iter().any(|meant| class.id.starts_with(meant));
            let free = !object.hidden && object.held_by.is_none() && !object.flags.has(StateFlag::Opened);
            class.has(property) && is_meant && free && !object.flags.has(StateFlag::Locked)
        });
        objects.map(|object| object.instance.to_owned()).collect()
    };
    let opened = some(4, all(Property::Openable, &["Fridge", "KitchenCounter", "KitchenCabinet", "Microwave"]));
    let on = some(2, all(Property::Toggleable, &["KitchenCounterSink", "Radio", "ForkLift", "V_Monitor_Gravity"]));
    let thrown = some(2, all(Property::Pickupable, &[""]));
    let mut script = "on-failure continue\n".to_owned();
    opened.iter().for_each(|name| script += &format!("open {name}\n"));
    on.iter().for_each(|name| script += &format!("toggle {name}\n"));
    thrown.iter().for_each(|name| script += &format!("pickup {name}\nlook-around\nthrow class Door_01\n"));
    script + "goto room Reception\n"
}

/// A helper and a rowdy for some minutes: much is tidied, and the helper gets about.
fn tidies(mission: usize) {
    const MINUTES: u64 = 3;
    let plan = plan(mission, SEED, &["robot"]);
    let script = mess(&plan, SEED);
    let agents: Vec<(u32, Box<dyn Agent + Send>)> =
        vec![(0, Box::new(Helper::new(0, SEED))), (1, scripted(1, &script))];
    let played = play(plan, &Local::new(1), agents, 0, MINUTES * 60 * TICKS_PER_SECOND);
    let of = |body: u32, words: &[&str]| {
        let is = |detail: &str| words.iter().any(|word| detail.contains(word));
        let done = played.outcomes.iter().filter(|ended| ended.body == body && ended.status.is_success());
        done.filter(|ended| is(&ended.detail)).count()
    };
    let (made, tidied) = (of(1, &["I opened", "on", "I threw"]), of(0, &["I closed", "off", "I put"]));
    let (done, failed): (Vec<_>, Vec<_>) =
        played.outcomes.iter().filter(|ended| ended.body == 0).partition(|ended| !ended.status.is_failure());
    let rooms = played.rooms[&0].len();
    println!(
        "mission {mission}: {made} made a mess, {tidied} tidied; {} done, {} failed, {rooms} rooms; {:?}",
        done.len(),
        failed.len(),
        played.said
    );
    for ended in &failed {
        println!("  {ended:?}");
    }
    let gaps = done.windows(2).map(|two| two[1].tick - two[0].tick).max().unwrap_or(0);
    // When this was written, of 8 or 9 things all were tidied but one, with no failure, in 7 rooms. A cabinet that is built open is left open.
    assert!(made >= 7, "{made} things were messed up: {:#?}", played.outcomes);
    assert!(tidied + 3 >= made, "{tidied} of {made} tidied: {:#?}", played.outcomes);
    assert!(failed.len() <= 1 && done.len() >= 30, "{} failed, {} done", failed.len(), done.len());
    assert!(rooms >= 6 && gaps < 60 * TICKS_PER_SECOND, "{rooms} rooms, {gaps} ticks without anything done");
}

#[test]
fn a_helper_tidies_up_in_the_first_mission() {
    tidies(0);
}

#[test]
fn a_helper_tidies_up_in_the_second_mission() {
    tidies(1);
}

#[test]
fn a_helper_tidies_up_in_the_third_mission() {
    tidies(2);
}

#[test]
fn a_helper_tidies_up_in_the_fourth_mission() {
    tidies(3);
}

/// A person takes a robot over and hands it back: the agent pauses meanwhile, and goes on.
#[test]
fn an_agent_waits_while_another_commands_its_body() {
    use cohabit_agent::Client;
    let bus = Local::new(1);
    let over = AtomicBool::new(false);
    let agents = vec![(0, scripted(0, "wait 0.1\nrotate 10\nloop"))];
    thread::scope(|scope| {
        let person = scope.spawn(|| {
            // Nobody hears what is said before there is a simulator.
            cohabit_agent::wait_for_mission(&bus, &over).unwrap();
            let mut person = Client::join(&bus, 0, "person").unwrap();
            let second = std::time::Duration::from_secs(30);
            let claimed = person.claim(true).unwrap();
            assert!(person.outcome(claimed, second).unwrap().unwrap().status.is_success());
            let act = person.act(0, Action::Rotate { yaw_rad: 2.0 }).unwrap();
            let outcome = person.outcome(act, second).unwrap().unwrap();
            person.release().unwrap();
            over.store(true, Ordering::Relaxed);
            outcome
        });
        let played = play(plan(2, 3, &[]), &bus, agents, 0, 6000);
        assert!(person.join().unwrap().status.is_success());
        assert!(over.load(Ordering::Relaxed));
        let refused = played.outcomes.iter().filter(|ended| ended.detail.contains("taken over")).count();
        assert!(refused <= 1, "{refused} commands in vain: {:?}", played.outcomes);
        assert!(played.outcomes.len() > 20);
    });
}

#[test]
fn an_expert_plays_a_mission_to_its_goals() {
    const TICKS: u64 = 15_000;
    let plan = plan(0, 3, &[]);
    let first = plan.build().unwrap().symbols(BodyId(0));
    let expert = Expert::new(0, Arc::clone(&plan.mission), first);
    let played = play(plan, &Local::new(1), vec![(0, Box::new(expert) as Box<dyn Agent + Send>)], 0, TICKS);
    let is_done = played.said.iter().any(|(body, words)| *body == 0 && words == "All goals are met.");
    assert!(is_done, "{:?}, {:#?}", played.said, played.outcomes);
    assert!(played.outcomes.iter().all(|ended| ended.status.is_success()), "{:#?}", played.outcomes);
}

/// Two people who swap rooms, and meet; in a session that is played for so many ticks.
fn pedestrians(ticks: u64) -> Played {
    const SCHEDULE: &str = "[[entry]]\nperson = 1\ngo_to = \"MainOffice\"\n[[entry]]\nperson = 1\nmeet = 2\n\
                            [[entry]]\nperson = 2\ngo_to = \"BreakRoom\"\n[[entry]]\nperson = 2\nmeet = 1";
    let plan = plan(2, 3, &["person@BreakRoom", "person@MainOffice"]);
    let world = plan.build().unwrap();
    let at_m = |at_m: [f32; 2]| Vec2::from(at_m);
    let floor = Floor {
        obstacles: world.obstacles(),
        viewpoints: plan.layout.viewpoints.iter().map(|own| (own.room, own.number, at_m(own.at_m))).collect(),
        doors: plan.layout.openings.iter().filter_map(|own| Some((own.door.clone()?, at_m(own.at_m)))).collect(),
        path: Box::new(move |from: Vec2, to: Vec2| world.path(from, to).map(|(way, _)| way)),
    };
    let mut crowd = Crowd::new(&Schedule::parse("test", SCHEDULE, &catalog()).unwrap(), floor, SEED);
    let (bus, stop) = (Local::new(1), AtomicBool::new(false));
    thread::scope(|scope| {
        scope.spawn(|| crowd.run(&bus, &stop).unwrap());
        let played = play(plan, &bus, Vec::new(), 1, ticks);
        stop.store(true, Ordering::Relaxed);
        played
    })
}

#[test]
fn pedestrians_get_where_they_are_to_go_and_walk_the_same_in_every_run() {
    const TICKS: u64 = 3600;
    let played = pedestrians(TICKS);
    let was_in = |body: u32, room: RoomId| {
        let index = room.builtin_index().map(u32::from).unwrap();
        played.rooms[&body].contains(&index)
    };
    assert!(was_in(1, RoomId::MAIN_OFFICE) && was_in(2, RoomId::BREAK_ROOM), "{:?}", played.rooms);
    assert_same(&played, &pedestrians(TICKS));
    assert_eq!(played.timeouts, 0);
}

#[test]
fn bodies_are_as_wide_as_pedestrians_take_them_for() {
    let world = plan(2, 3, &["person"]).build().unwrap();
    let radii: Vec<f32> = world.bodies().map(|body| body.radius_m).collect();
    assert_eq!(radii, [0.25, 0.22]);
}

/// Hears whether it commands its body, and does nothing.
#[derive(Default)]
struct Idler(Vec<bool>);

impl Agent for Idler {
    fn hear(&mut self, heard: &Heard<'_>, _: &mut Vec<Deed>) {
        if let Heard::Commands(commands) = heard {
            self.0.push(*commands);
        }
    }
}

#[test]
fn an_agent_whose_body_is_not_to_be_had_hears_that() {
    use cohabit_agent::{Client, PeerError};
    let (bus, over, moment) = (Local::new(1), AtomicBool::new(false), std::time::Duration::from_secs(30));
    let simulator = cast::simulator(&plan(2, 3, &[]), &bus);
    // What an agent of that body hears within two seconds, and how it ended.
    let hears = |body: u32| {
        let (mut idler, stop) = (Idler::default(), AtomicBool::new(false));
        let ended = thread::scope(|scope| {
            let running = scope.spawn(|| cohabit_agent::run(&mut idler, body, &bus, &stop));
            thread::sleep(std::time::Duration::from_secs(2));
            stop.store(true, Ordering::Relaxed);
            running.join().unwrap()
        });
        (idler.0, ended)
    };
    let (nowhere, taken) = thread::scope(|scope| {
        scope.spawn(|| simulator.run(&over));
        let nowhere = hears(7).1;
        let [mut first, mut other] = ["first", "other"].map(|peer| Client::join(&bus, 0, peer).unwrap());
        let claimed = first.claim(false).unwrap();
        first.outcome(claimed, moment).unwrap();
        // That somebody commands the body was told so long ago that who joins late does not hear it any more.
        for _ in 0..6 {
            let refused: Vec<u64> = (0..100).map(|_| other.act(0, Action::Stop).unwrap()).collect();
            other.outcome(refused[99], moment).unwrap();
        }
        let taken = hears(0).0;
        over.store(true, Ordering::Relaxed);
        (nowhere, taken)
    });
    assert!(matches!(nowhere, Err(PeerError::NoBody { body: 7, last: 0 })), "{nowhere:?}");
    assert_eq!(taken, [false]);
}
