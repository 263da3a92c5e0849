//! Recordings and Parquet tables, made by this very program of sessions that are played here, and read by rerun's own
//! tools and pyarrow, which the tests install.
#![allow(clippy::unwrap_used)]

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Child, Command},
    sync::{Arc, OnceLock},
    time::{Duration, Instant},
};

use cohabit_bus::{
    Inbox, Session, Shm, Topic,
    message::{self, PulseMessage},
};
use cohabit_cdf::{Catalog, mission};
use cohabit_engine::{Engine, SessionPlan};
use cohabit_eval::{Settings, play, read_tasks};
use cohabit_language::Language;
use cohabit_record::Log;
use cohabit_tests::{output, python_with};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;

/// The program under test.
const PROGRAM: &str = env!("CARGO_BIN_EXE_cohabit-rerun");
const HERE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/recordings");
const MISSIONS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../cdf/missions");

/// A folder of a test's own, empty.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// A Python with rerun's package.
fn python() -> &'static Path {
    static PYTHON: OnceLock<PathBuf> = OnceLock::new();
    PYTHON.get_or_init(|| {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("rerun-python");
        python_with(&Path::new(HERE).join("requirements.txt"), &folder).unwrap()
    })
}

fn read(python: &Path, what: &str, path: &Path) -> Value {
    let script = Path::new(HERE).join("read.py");
    let read = output(Command::new(python).arg(script).arg(what).arg(path)).unwrap();
    serde_json::from_slice(&read.stdout).unwrap()
}

/// Rerun's command line passes the recording.
fn verify(python: &Path, recording: &Path) {
    let rerun = python.with_file_name("rerun");
    output(Command::new(&rerun).args(["rrd", "verify"]).arg(recording)).unwrap();
    let stats = output(Command::new(&rerun).args(["rrd", "stats"]).arg(recording)).unwrap();
    assert!(String::from_utf8_lossy(&stats.stdout).contains("num_chunks"), "{stats:?}");
}

/// The logs of two built-in missions, played by the words of their scripts.
fn logs(folder: &Path) -> [PathBuf; 2] {
    let language = Language::new(Arc::new(Catalog::builtin()));
    let settings = Settings { record: Some(folder.to_owned()), ..Settings::expert(1) };
    ["cold_soda", "warm_coffee"].map(|name| {
        let task = read_tasks(&Path::new(MISSIONS).join(format!("{name}.json")), None).unwrap().remove(0);
        let played = play(&task, &settings, &language).unwrap();
        assert!(played.success, "{:?}", played.first_trouble);
        played.log.unwrap()
    })
}

fn run(arguments: &[&Path]) {
    output(Command::new(PROGRAM).args(arguments)).unwrap();
}

fn entity<'a>(read: &'a Value, path: &str) -> &'a Value {
    let found = &read["entities"][path];
    assert!(found.is_object(), "there is no `{path}`: {:?}", read["entities"].as_object().unwrap().keys());
    found
}

fn rows(read: &Value, path: &str) -> u64 {
    entity(read, path)["rows"].as_u64().unwrap()
}

/// The last value of an entity's column.
fn last<'a>(read: &'a Value, path: &str, column: &str) -> &'a str {
    entity(read, path)["columns"][column].as_str().unwrap_or_else(|| panic!("`{path}` has no `{column}`: {read}"))
}

/// What a recording of `log` below `root` must hold.
fn check(read: &Value, root: &str, log: &Log) {
    let at = |path: &str| format!("/{root}{path}");
    let said = |kinds: &[&str]| log.dialog.iter().filter(|entry| kinds.contains(&entry.kind.as_str())).count() as u64;
    assert_eq!(rows(read, &at("dialog/person")), said(&["Utterance"]));
    assert_eq!(rows(read, &at("dialog/robot")), said(&["Reply", "Question"]));
    let (met, all) = (last(read, &at("goals/met"), "Scalars:scalars"), last(read, &at("goals/all"), "Scalars:scalars"));
    assert_eq!(met, all, "all goals were met");
    assert!(rows(read, &at("states/actions/robot_0")) > 4);
    assert!(rows(read, &at("world/bodies/robot_0")) > 50, "it went about");
    assert!(last(read, &at("world/plan/BreakRoom/floor"), "Mesh3D:vertex_positions").contains("characters"));
    for timeline in ["tick", "sim_time", "wall_time"] {
        let own = entity(read, &at("world/bodies/robot_0"))["timelines"].as_array().unwrap();
        assert!(own.iter().any(|name| name == timeline), "{own:?}");
    }
    let camera = at("world/cameras/egocentric_0");
    let most = log.ticks.len() as u64 / 6 + 1;
    for (plane, column) in [
        ("color", "EncodedImage:blob"),
        ("normals", "EncodedImage:blob"),
        ("depth", "EncodedDepthImage:blob"),
        ("ids", "SegmentationImage:buffer"),
    ] {
        let path = format!("{camera}/{plane}");
        assert!((10..=most).contains(&rows(read, &path)), "{path}: {} of {most}", rows(read, &path));
        last(read, &path, column);
    }
    assert_eq!(last(read, &format!("{camera}/depth"), "EncodedDepthImage:meter"), "[1000.0]");
    last(read, &at("world/cameras"), "AnnotationContext:context");
}

#[test]
#[cfg_attr(not(python), ignore = "needs Python 3.10 or later with venv")]
fn a_recording_holds_what_was_played_and_two_lie_beside_each_other() {
    let folder = folder("recordings");
    let [soda, coffee] = logs(&folder);
    let (one, both) = (folder.join("one.rrd"), folder.join("both.rrd"));
    run(&["replay".as_ref(), &soda, "--out".as_ref(), &one]);
    run(&["compare".as_ref(), &soda, &coffee, "--out".as_ref(), &both]);
    for recording in [&one, &both] {
        assert!(fs::read(recording).unwrap().starts_with(b"RRF2"));
    }
    let python = python();
    let [soda, coffee] = [soda, coffee].map(|log| Log::open(&log).unwrap());
    verify(python, &one);
    verify(python, &both);
    let read_one = read(python, "recording", &one);
    check(&read_one, "", &soda);
    assert_eq!(read_one["blueprints"], 1);
    let is_can = |path: &&String| path.contains("/world/objects/CanSoda") && !path.contains("/part_");
    let can = read_one["entities"].as_object().unwrap().keys().find(is_can);
    assert!(rows(&read_one, can.unwrap()) > 10, "it was carried");
    let read_both = read(python, "recording", &both);
    check(&read_both, "a/", &soda);
    check(&read_both, "b/", &coffee);
}

#[test]
#[cfg_attr(not(python), ignore = "needs Python 3.10 or later with venv")]
fn tables_are_read_with_their_units_and_meanings() {
    let folder = folder("tables");
    let [soda, coffee] = logs(&folder);
    let out = folder.join("out");
    run(&["tables".as_ref(), &soda, &coffee, "--out".as_ref(), &out]);
    let python = python();
    let sessions = read(python, "table", &out.join("sessions.parquet"));
    let all = |name: &str| sessions["rows"].as_array().unwrap().iter().map(|row| row[name].clone()).collect::<Vec<_>>();
    assert_eq!(all("session"), ["cold_soda", "warm_coffee"]);
    assert_eq!(all("success"), [true, true]);
    assert_eq!(all("setting_ask"), ["never", "never"]);
    assert_eq!(sessions["fields"]["duration_s"]["unit"], "s");
    let turns = read(python, "table", &out.join("turns.parquet"));
    let log = Log::open(&soda).unwrap();
    let said: Vec<&str> =
        log.dialog.iter().filter(|entry| entry.kind == "Utterance").map(|entry| entry.text.as_str()).collect();
    let rows = turns["rows"].as_array().unwrap().iter().filter(|row| row["session"] == "cold_soda");
    assert_eq!(rows.map(|row| row["said"].as_str().unwrap()).collect::<Vec<_>>(), said);
    let codebook = read(python, "table", &out.join("codebook.parquet"));
    let fields: usize = ["sessions", "turns", "actions", "goals", "questionnaires"]
        .map(|name| read(python, "table", &out.join(format!("{name}.parquet")))["fields"].as_object().unwrap().len())
        .iter()
        .sum();
    assert_eq!(codebook["rows"].as_array().unwrap().len(), fields + 5, "each column, and each table");
}

/// The program as it watches a session; ended when dropped.
struct Watcher(Child);

impl Watcher {
    fn end(mut self) {
        let pid = Pid::from_raw(i32::try_from(self.0.id()).unwrap()).unwrap();
        kill_process(pid, Signal::TERM).unwrap();
        assert!(self.0.wait().unwrap().success());
    }
}

impl Drop for Watcher {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
#[cfg_attr(not(python), ignore = "needs Python 3.10 or later with venv")]
fn a_running_session_is_shown_through_the_same_conversion() {
    let folder = folder("live");
    let session = Session::new(&format!("rerun-{}", std::process::id())).unwrap();
    let lock = session.supervise().unwrap();
    let bus = Shm::join(&session).unwrap();
    let (file, text) = mission::builtin()[0];
    let plan = SessionPlan::new(file, text, Arc::new(Catalog::builtin()), 1).unwrap();
    let mut engine = Engine::new(&plan, plan.build().unwrap(), &[], &bus).unwrap();
    let mut pulses = Inbox::new(&bus, Topic::Pulses).unwrap();
    let out = folder.join("live.rrd");
    let watcher = Command::new(PROGRAM).args(["live", "--session", session.name(), "--out"]).arg(&out).spawn().unwrap();
    let watcher = Watcher(watcher);
    let began = Instant::now();
    let mut seen = 0;
    while seen < 30 {
        assert!(began.elapsed() < Duration::from_secs(120), "nobody watched");
        engine.tick(cohabit_bus::wall_nanos()).unwrap();
        engine.greet().unwrap();
        while let Some((_, pulse)) = pulses.next(|sample| message::read::<PulseMessage>(sample.payload())).unwrap() {
            if pulse.peer.as_str() == "viewer" {
                seen = pulse.tick;
            }
        }
        std::thread::sleep(Duration::from_millis(16));
    }
    watcher.end();
    session.end(lock);
    let python = python();
    verify(python, &out);
    let read = read(python, "recording", &out);
    for path in ["/world/bodies/robot_0", "/world/plan/BreakRoom/floor", "/goals/all", "/mission", "/world/cameras"] {
        entity(&read, path);
    }
    let wall = entity(&read, "/goals/all")["timelines"].as_array().unwrap();
    assert!(wall.iter().any(|name| name == "wall_time"), "{wall:?}");
}
