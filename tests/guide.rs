//! README and the pages of the guide are scripts: each is run from top to bottom in a folder of its own, as `cohabit_tests` says
//! in its module `script`. What is not run is printed, with the reason.
#![allow(clippy::unwrap_used)]

use std::{
    collections::BTreeSet,
    fs,
    io::{self, Write as _},
    path::Path,
    sync::{Condvar, Mutex},
};

use cohabit_tests::Runner;

/// The binary under test.
const COHABIT: &str = env!("CARGO_BIN_EXE_cohabit");
/// The root of the repository.
const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
/// The pages of the guide.
const GUIDE: &str = "runtime/guide/src";

/// How many pages are run side by side at most: sessions that cannot keep up with time would take still longer.
const MOST_AT_A_TIME: usize = 2;

static RUNNING: Mutex<usize> = Mutex::new(0);
static ENDED: Condvar = Condvar::new();

/// A page's turn to be run.
struct Turn;

impl Turn {
    fn wait() -> Self {
        let running = RUNNING.lock().unwrap();
        *ENDED.wait_while(running, |running| *running >= MOST_AT_A_TIME).unwrap() += 1;
        Self
    }
}

impl Drop for Turn {
    fn drop(&mut self) {
        *RUNNING.lock().unwrap() -= 1;
        ENDED.notify_one();
    }
}

fn check(file: &str) {
    let _turn = Turn::wait();
    let root = Path::new(ROOT);
    let text = fs::read_to_string(root.join(file)).unwrap();
    let runner = Runner { binary: Path::new(COHABIT), repository: root, has: &[], path: &[] };
    let told = runner.run(file, &text).unwrap_or_else(|problem| panic!("{problem}"));
    let not_run = told.not_run.iter().map(|one| format!("{file}:{}: not run: {}\n", one.line, one.reason));
    let whole: String = not_run.chain([format!("{file}: {} commands were run\n", told.typed)]).collect();
    // Tests print nothing else when they pass.
    io::stderr().write_all(whole.as_bytes()).unwrap();
}

/// A test for each page.
macro_rules! pages {
    ($($test:ident: $file:literal,)*) => {
        $(
            #[test]
            fn $test() {
                check($file);
            }
        )*

        const PAGES: &[&str] = &[$($file),*];
    };
}

pages! {
    readme: "README.md",
    summary: "runtime/guide/src/SUMMARY.md",
    agents: "runtime/guide/src/agents.md",
    arena: "runtime/guide/src/arena.md",
    benchmark: "runtime/guide/src/benchmark.md",
    deploy: "runtime/guide/src/deploy.md",
    development: "runtime/guide/src/development.md",
    dry_run: "runtime/guide/src/dry-run.md",
    editors: "runtime/guide/src/editors.md",
    evaluation: "runtime/guide/src/evaluation.md",
    expert: "runtime/guide/src/expert.md",
    first_session: "runtime/guide/src/first-session.md",
    goals: "runtime/guide/src/goals.md",
    host: "runtime/guide/src/host.md",
    how_it_works: "runtime/guide/src/how-it-works.md",
    language_model: "runtime/guide/src/language-model.md",
    latency: "runtime/guide/src/latency.md",
    limits: "runtime/guide/src/limits.md",
    mcp: "runtime/guide/src/mcp.md",
    missions: "runtime/guide/src/missions.md",
    pedestrians: "runtime/guide/src/pedestrians.md",
    performance: "runtime/guide/src/performance.md",
    python: "runtime/guide/src/python.md",
    questionnaires: "runtime/guide/src/questionnaires.md",
    replay: "runtime/guide/src/replay.md",
    rerun: "runtime/guide/src/rerun.md",
    security: "runtime/guide/src/security.md",
    stability: "runtime/guide/src/stability.md",
    steps: "runtime/guide/src/steps.md",
    study: "runtime/guide/src/study.md",
    tables: "runtime/guide/src/tables.md",
    talk: "runtime/guide/src/talk.md",
    together: "runtime/guide/src/together.md",
    troubleshooting: "runtime/guide/src/troubleshooting.md",
    understanding: "runtime/guide/src/understanding.md",
    vision: "runtime/guide/src/vision.md",
    voice: "runtime/guide/src/voice.md",
    wizard: "runtime/guide/src/wizard.md",
    worlds: "runtime/guide/src/worlds.md",
}

#[test]
fn every_page_is_run() {
    let entries = fs::read_dir(Path::new(ROOT).join(GUIDE)).unwrap();
    let pages = entries.map(|entry| format!("{GUIDE}/{}", entry.unwrap().file_name().to_string_lossy()));
    let there: BTreeSet<String> = pages.chain(["README.md".to_owned()]).collect();
    let run: BTreeSet<String> = PAGES.iter().map(|page| (*page).to_owned()).collect();
    assert_eq!(run, there);
}
