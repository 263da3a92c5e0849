//! From a wizard's click to the robot's plan: `cargo bench -p cohabit --bench wizard [-- ROUNDS]`, sixty if nothing is said.
//!
//! Somebody says something, the wizard has another request understood in its place, and accepts what comes of it. Prints how long
//! after the click the plan is sent to the robot; and, with a delay of half a second, how long after the words that it should be.

use cohabit_bus::{
    Inbox, Session, Shm, Topic,
    message::{DialogKind, DialogView},
    monotonic_nanos,
};
use cohabit_tests::{Page, Play, machine};
use serde_json::{Value, json};

const BINARY: &str = env!("CARGO_BIN_EXE_cohabit");
const DELAY_MS: u64 = 500;
const ROOMS: [&str; 2] = ["the main office", "the reception"];

fn main() -> anyhow::Result<()> {
    let rounds = std::env::args().skip(1).find_map(|argument| argument.parse().ok()).unwrap_or(60);
    println!("cohabit {}, {}; {rounds} edited plans each", env!("CARGO_PKG_VERSION"), machine());
    print("after the click", &measured(rounds, 0)?);
    print("after words and delay", &measured(rounds, DELAY_MS)?);
    Ok(())
}

fn print(what: &str, all: &[f64]) {
    let at = |share: f64| all[((all.len() - 1) as f64 * share) as usize];
    println!("plan sent, ms {what}: median {:.2}, p95 {:.2}, most {:.2}", at(0.5), at(0.95), at(1.0));
}

/// How late plans were sent, ms, in order: after the click, or after the words and that delay.
fn measured(rounds: usize, delay_ms: u64) -> anyhow::Result<Vec<f64>> {
    let delay = delay_ms.to_string();
    let arguments = ["make_cereal", "--knows", "everything", "--wizard", "yes", "--response-delay-ms", &delay];
    let mut play = Play::spawn(BINARY, &arguments)?;
    let seat = play.wait_for_line("Wizard's seat: ")?;
    let seat = seat.split_once("://").unwrap_or_default().1.replace("/wizard?", "/?");
    play.wait_until_ready()?;
    let bus = Shm::join(&Session::new(&play.session)?)?;
    let mut dialog = Inbox::new(&bus, Topic::Dialog)?;
    let (mut wizard, mut page) = (Page::open(&seat)?, Page::open(play.authority())?);
    let mut all = Vec::new();
    for round in 0..rounds {
        let (room, other) = (ROOMS[round % 2], ROOMS[(round + 1) % 2]);
        let said = monotonic_nanos();
        page.say(&format!("go to {room}"))?;
        let turn = proposed(&mut wizard, 0)?["turn"].clone();
        decide(&mut wizard, &json!({ "type": "edit", "turn": turn, "text": format!("go to {other}") }))?;
        proposed(&mut wizard, 1)?;
        let clicked = monotonic_nanos();
        decide(&mut wizard, &json!({ "type": "accept", "turn": turn, "revision": 1 }))?;
        let is_answer =
            |message: &Value| message["type"] == "chat" && message["from"] == "robot" && message["turn"] == turn;
        page.wait("the answer", |_, message| is_answer(message))?;
        let from = if delay_ms == 0 { clicked } else { said + delay_ms * 1_000_000 };
        all.push(plan_sent(&mut dialog)?.saturating_sub(from) as f64 * 1e-6);
    }
    all.sort_by(f64::total_cmp);
    // What is left on its bus keeps it from being wiped.
    drop((dialog, bus, wizard, page));
    play.end()?;
    Ok(all)
}

fn proposed(wizard: &mut Page, revision: u64) -> anyhow::Result<Value> {
    let is_it = |message: &Value| {
        let proposal = &message["proposal"];
        message["type"] == "proposal" && proposal["revision"] == revision && proposal["is_decided"] == false
    };
    Ok(wizard.wait("a proposal", |_, message| is_it(message))?["proposal"].clone())
}

fn decide(wizard: &mut Page, decision: &Value) -> anyhow::Result<()> {
    wizard.send(&json!({ "type": "decide", "decision": decision }))?;
    Ok(())
}

/// When the newest plan was sent.
fn plan_sent(dialog: &mut Inbox) -> anyhow::Result<u64> {
    let mut sent = 0;
    let deadline = std::time::Instant::now() + std::time::Duration::from_secs(10);
    while sent == 0 && std::time::Instant::now() < deadline {
        while let Some((sample, kind)) = dialog.next(|sample| Ok(DialogView::new(sample.payload())?.header.kind()))? {
            if kind == Some(DialogKind::Plan) {
                sent = sample.envelope().sent_nanos;
            }
        }
    }
    Ok(sent)
}
