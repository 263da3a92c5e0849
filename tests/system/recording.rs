//! Recorded sessions: missions played to their end through the page, replayed to the bit here and in another process,
//! shown again on the page, filmed, damaged, and gone on with.

use std::{
    fs,
    io::{BufRead as _, BufReader},
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    sync::Arc,
};

use cohabit_cdf::Catalog;
use cohabit_engine::Replayer;
use cohabit_record::Log;
use cohabit_tests::{Browser, Page, Play, run};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::json;

use crate::{COHABIT, accessibility};

/// What `cohabit replay` says of a log, which it must find to be the same.
fn replayed(log: &Path, options: &[&str]) -> String {
    let arguments = [&["replay", log.to_str().unwrap()], options].concat();
    let output = run(COHABIT, &arguments).unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{text}{}", String::from_utf8_lossy(&output.stderr));
    text
}

/// Plays a built-in mission to its end by the sentences of its script.
fn play(mission: &str, options: &[&str]) -> Play {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cdf/missions").join(format!("{mission}.script"));
    let sentences = fs::read_to_string(script).unwrap();
    let play = Play::start(COHABIT, &[&[mission, "--speed", "3"], options].concat()).unwrap();
    let mut page = Page::open(play.authority()).unwrap();
    for sentence in sentences.lines() {
        page.do_and_wait(sentence).unwrap();
    }
    page.wait("every goal", |page, _| page.state["ending"] == "complete").unwrap();
    drop(page);
    play.end().unwrap()
}

/// The log of a mission agrees at every tick, in this process and in another one.
fn check_mission(mission: &str) {
    let ended = play(mission, &["--participant", "P 07"]);
    let log = Log::open(&ended.log).unwrap();
    assert_eq!(log.problems(), [] as [&str; 0]);
    let session = &log.session;
    assert_eq!(session.participant.as_deref(), Some("P 07"));
    assert!(!session.catalog.is_empty() && !session.layout.is_empty() && session.messages > 0);
    assert_eq!(session.settings["knows"], "seen");
    let mut replayer = Replayer::new(&log, Arc::new(Catalog::builtin())).unwrap();
    let mut ticks = 0;
    while let Some(replayed) = replayer.step() {
        assert_eq!(replayed.difference, None);
        ticks += 1;
    }
    assert_eq!((replayer.gap(), ticks), (None, log.ticks.len()));
    assert!(replayer.world().goals().iter().all(|goal| goal.met));
    let text = replayed(&ended.log, &[]);
    assert!(text.contains("no tick differs") && text.contains(&format!("{ticks} ticks")), "{text}");
    // A turn's latency is followed to the screen of a page; this one has none.
    let latencies: Vec<_> = log.dialog.iter().filter(|entry| entry.kind == "Latency").collect();
    assert!(!latencies.is_empty() && latencies.iter().all(|entry| entry.stamps[..4].is_sorted()), "{latencies:?}");
}

#[test]
fn making_cereal_is_recorded_and_replayed() {
    check_mission("make_cereal");
}

#[test]
fn warming_coffee_is_recorded_and_replayed() {
    check_mission("warm_coffee");
}

#[test]
fn cooling_soda_is_recorded_and_replayed() {
    check_mission("cold_soda");
}

#[test]
fn a_log_tells_where_everybody_was_and_is_filmed_anew() {
    let door = "door=fixed,x=4,y=10,yaw=90,rate=2";
    let ended = play("cold_soda", &["--camera", door, "--record-frames", "door"]);
    assert_eq!(Log::open(&ended.log).unwrap().session.frames, ["door"]);
    let bytes = fs::read(&ended.log).unwrap();
    let recorded = bytes.windows(20).filter(|part| part == b"\"frame_id\":\"door\",\"f").count();
    assert!(recorded > 2, "{recorded} frames");
    let folder = ended.folder.join("frames");
    let video = ended.folder.join("film.y4m");
    let (to, film) = (folder.to_str().unwrap(), video.to_str().unwrap());
    let options =
        ["--at", "1.5", "--until", "2.5", "--frames", to, "--camera", "door", "--size", "64x48", "--rate", "5"];
    let text = replayed(&ended.log, &[&options[..], &["--modality", "color,depth,normals,ids"]].concat());
    assert!(text.contains("At 0:01.5 (tick 90):") && text.contains("body 0 in "), "{text}");
    let mut names: Vec<_> =
        fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort_unstable();
    assert_eq!(names.len(), 6 * 4 + 1, "{names:?}");
    assert_eq!(names[..4], ["0000090-color.png", "0000090-depth.png", "0000090-ids.png", "0000090-normals.png"]);
    let ids = fs::read_to_string(folder.join("ids.csv")).unwrap();
    assert!(ids.starts_with("color,id,name\n") && ids.lines().count() > 3, "{ids}");
    replayed(&ended.log, &["--until", "1", "--video", film, "--camera", "top=top-down,size=80", "--rate", "10"]);
    let bytes = fs::read(&video).unwrap();
    let header = b"YUV4MPEG2 W80 H80 F10000:1000 Ip A1:1 C420jpeg\n";
    assert!(bytes.starts_with(header));
    // A picture at the beginning, and ten after.
    assert_eq!(bytes.len(), header.len() + 11 * (b"FRAME\n".len() + 80 * 80 * 3 / 2));
    let wrong = run(COHABIT, &["replay", ended.log.to_str().unwrap(), "--video", film, "--camera", "nowhere"]).unwrap();
    let text = String::from_utf8_lossy(&wrong.stderr).into_owned();
    assert!(wrong.status.code() == Some(2) && text.contains("door") && text.contains("spectator/0"), "{text}");
}

#[test]
fn a_damaged_log_is_replayed_around_what_is_lost() {
    let ended = play("cold_soda", &[]);
    let whole = Log::open(&ended.log).unwrap();
    let mut bytes = fs::read(&ended.log).unwrap();
    let middle = bytes.len() / 3;
    bytes[middle] ^= 0x55;
    let damaged = ended.folder.join("damaged.mcap");
    fs::write(&damaged, &bytes).unwrap();
    let text = replayed(&damaged, &[]);
    assert!(text.contains("are damaged, and lost: "), "{text}");
    assert!(text.contains("no tick differs"), "{text}");
    bytes.truncate(middle);
    fs::write(&damaged, &bytes).unwrap();
    let text = replayed(&damaged, &[]);
    assert!(text.contains("it ends early: its last ") && text.contains("no tick differs"), "{text}");
    assert!(Log::open(&damaged).unwrap().ticks.len() < whole.ticks.len());
}

/// A recorder that could not keep up ends with an exit code of its own, whoever stops it.
#[test]
fn a_recorder_that_missed_something_does_not_end_well() {
    let play = Play::start(COHABIT, &["cold_soda", "--speed", "20"]).unwrap();
    let log = play.folder.join("second.mcap");
    let mut recorder = Command::new(COHABIT)
        .args(["record", "--session", &play.session, "--log", log.to_str().unwrap()])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut said = BufReader::new(recorder.stdout.take().unwrap()).lines().map_while(Result::ok);
    assert!(said.any(|line| line.starts_with("recording ")));
    let pid = Pid::from_child(&recorder);
    kill_process(pid, Signal::STOP).unwrap();
    let mut page = Page::open(play.authority()).unwrap();
    let at = |page: &Page| page.state["tick"].as_u64().unwrap_or_default();
    page.wait("a state", |page, _| at(page) > 0).unwrap();
    let began = at(&page);
    // The bus keeps 2048 ticks.
    page.wait("more ticks than the bus keeps", |page, _| at(page) > began + 4000).unwrap();
    kill_process(pid, Signal::TERM).unwrap();
    kill_process(pid, Signal::CONT).unwrap();
    let ended = recorder.wait_with_output().unwrap();
    let told = String::from_utf8_lossy(&ended.stderr).into_owned();
    assert_eq!(ended.status.code(), Some(3), "{told}");
    assert!(told.contains("second.mcap is incomplete: ") && told.contains("messages are missing"), "{told}");
    let found = Log::open(&log).unwrap();
    assert!(found.missing() > 0 && !found.gaps.is_empty() && found.cut.is_none(), "{:?}", found.problems());
    drop(page);
    play.end().unwrap();
}

/// `cohabit replay --page`, which is ended when this is dropped.
struct Screening {
    child: Child,
    address: String,
}

impl Screening {
    fn start(log: &Path) -> Self {
        let mut child = Command::new(COHABIT)
            .args(["replay", log.to_str().unwrap(), "--page", "--port", "0"])
            .stdout(Stdio::piped())
            .stdin(Stdio::null())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines().map_while(Result::ok);
        let line = lines.find(|line| line.contains("http://")).unwrap();
        let address = line.split_whitespace().find(|word| word.starts_with("http://")).unwrap().to_owned();
        Self { child, address }
    }

    fn authority(&self) -> &str {
        self.address.trim_start_matches("http://").trim_end_matches('/')
    }
}

impl Drop for Screening {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn a_session_is_played_again_on_the_page() {
    let ended = play("cold_soda", &[]);
    let log = Log::open(&ended.log).unwrap();
    let last = log.ticks.last().unwrap().tick;
    let screening = Screening::start(&ended.log);
    let mut page = Page::open(screening.authority()).unwrap();
    let at = |page: &Page| page.state["tick"].as_u64().unwrap_or_default();
    page.wait("its beginning", |page, _| page.state["player"]["paused"] == true && at(page) == 0).unwrap();
    page.send(&json!({ "type": "speed", "factor": 20.0 })).unwrap();
    page.send(&json!({ "type": "resume" })).unwrap();
    page.wait("its end", |page, _| at(page) == last && page.state["player"]["paused"] == true).unwrap();
    assert_eq!(page.state["ending"], "complete");
    assert!(page.goals().iter().all(|(_, met)| *met), "{:?}", page.goals());
    let said = |page: &Page| page.chat.iter().filter(|(from, _)| from == "person").count();
    let utterances = log.dialog.iter().filter(|entry| entry.kind == "Utterance").count();
    assert_eq!(said(&page), utterances, "{:?}", page.chat);
    // Back: what was said later is not said yet.
    page.send(&json!({ "type": "seek", "tick": 5 })).unwrap();
    let rewound = page.wait("what was said until then", |_, message| message["type"] == "rewind").unwrap();
    assert!(rewound["lines"].as_array().unwrap().iter().all(|line| line["from"] != "person"), "{rewound}");
    page.wait("that time", |page, _| at(page) == 5 && page.state["ending"] == "running").unwrap();
    // Nobody can speak in it.
    page.say("pick up the soda can").unwrap();
    page.wait("a refusal", |_, message| message["type"] == "error").unwrap();
    assert!(page.frames > 0);
}

#[test]
#[cfg_attr(not(all(browser, python)), ignore = "needs a browser, and Python 3.10 or later with venv")]
fn a_browser_plays_a_session_again() {
    let ended = play("cold_soda", &[]);
    let last = Log::open(&ended.log).unwrap().ticks.last().unwrap().tick;
    let screening = Screening::start(&ended.log);
    let browser = Browser::start().unwrap();
    let mut tab = browser.open(&screening.address, 1280, 720).unwrap();
    tab.wait_until("window.cohabit?.frames > 0 && document.body.classList.contains('replay')").unwrap();
    let hidden = "['#composer', '#walk', '#chips'].every((part) => document.querySelector(part).offsetParent === null)";
    assert_eq!(tab.evaluate(hidden).unwrap(), json!(true));
    tab.evaluate("{ const track = document.querySelector('#track'); track.value = track.max; track.dispatchEvent(new Event('input')); }")
        .unwrap();
    tab.wait_until(&format!("window.cohabit.state.tick === {last}")).unwrap();
    tab.wait_until("document.querySelectorAll('#chat .from-person').length > 0").unwrap();
    accessibility::check(&mut tab, "a recorded session");
    let key = |key: &str| format!("document.dispatchEvent(new KeyboardEvent('keydown', {{ key: '{key}' }}))");
    tab.evaluate(&key("Home")).unwrap();
    tab.wait_until("window.cohabit.state.tick === 0 && document.querySelectorAll('#chat .from-person').length === 0")
        .unwrap();
    tab.evaluate(&key(" ")).unwrap();
    tab.wait_until("window.cohabit.state.tick > 10 && document.querySelector('#play').classList.contains('playing')")
        .unwrap();
}

#[test]
fn a_session_goes_on_from_a_point_of_another_one() {
    let ended = play("cold_soda", &["--body", "person"]);
    let first = Log::open(&ended.log).unwrap();
    let at = first.ticks.len() as u64 / 2;
    let point = format!("{}@tick:{at}", ended.log.display());
    let again = Play::start(COHABIT, &["--branch", &point]).unwrap();
    let mut page = Page::open(again.authority()).unwrap();
    page.wait("what was said before", |page, _| page.chat.iter().any(|(from, _)| from == "person")).unwrap();
    page.do_and_wait("look around").unwrap();
    assert!(page.state["others"].as_array().is_some_and(|others| others.len() == 1), "{}", page.state);
    drop(page);
    let again = again.end().unwrap();
    let second = Log::open(&again.log).unwrap();
    let branched = second.session.branched.clone().unwrap();
    assert_eq!((branched.session, branched.tick), (first.session.session.clone(), at));
    assert_eq!(second.ticks[0].tick, at + 1);
    let text = replayed(&again.log, &[]);
    assert!(text.contains("no tick differs") && text.contains("goes on from"), "{text}");
    let beyond = format!("{}@9:00:00", ended.log.display());
    let wrong = run(COHABIT, &["play", "--branch", &beyond]).unwrap();
    let text = String::from_utf8_lossy(&wrong.stderr).into_owned();
    assert!(wrong.status.code() == Some(2) && text.contains("it goes from 0:00.0 to "), "{text}");
}

/// What is not a session's is refused with its reason.
#[test]
fn what_is_no_log_is_refused() {
    let path: PathBuf = std::env::temp_dir().join(format!("cohabit-no-log-{}.mcap", std::process::id()));
    let check = |bytes: &[u8], part: &str| {
        fs::write(&path, bytes).unwrap();
        let output = run(COHABIT, &["replay", path.to_str().unwrap()]).unwrap();
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && text.contains(part), "{text}");
    };
    check(b"", "no MCAP file");
    check(b"{}", "no MCAP file");
    check(b"\x89MCAP0\r\n", "no session entry");
    fs::remove_file(&path).unwrap();
}
