//! What is for practice, and what participants are not to see.

use std::{fs, thread, time::Duration};

use cohabit_tests::run;
use serde_json::json;

use super::{Person, STUDY, Server, study};
use crate::COHABIT;

const PRACTICE: &str = r#"
[[block]]
kind = "practice"
mission = "laser_lab"
skip_after_minutes = 0.01
settings = { name = "0=Robin" }

[[block]]
kind = "questionnaire"
questionnaires = ["short.toml"]

[[block]]
kind = "missions"
"#;

#[test]
fn practice_is_plain_and_left_out_of_tables_and_nobody_is_heard_who_was_not_asked() {
    let scratch = study("study-practice");
    let _ = scratch.write("study.toml", &STUDY.replacen("[[block]]\nkind = \"missions\"\n", PRACTICE, 1));
    let server = Server::start(&scratch, "0");
    let person = Person::sign_up(&server);
    person.agree(&server);
    person.tell(&server, &json!("goes_on"));
    let mut page = person.session(&server);
    let hello = page.wait("the greeting", |_, message| message["type"] == "hello").unwrap();
    assert_eq!(hello["hidden"], json!(["figures", "microphone", "score"]));
    page.send(&json!({ "type": "listen", "rate": 16_000, "held": false })).unwrap();
    page.wait("that nothing is heard", |_, message| {
        message["type"] == "error" && message["text"].as_str().is_some_and(|text| text.contains("please type"))
    })
    .unwrap();
    assert!(person.state(&server)["left_s"].is_null());
    while person.state(&server)["skip_in_s"] != 0.0 {
        thread::park_timeout(Duration::from_millis(50));
    }
    person.tell(&server, &json!({ "over": { "ending": "skipped" } }));
    person.wait_for(&server, "questionnaire");
    // A draft is there again, and is no answer.
    let drafted = json!({ "drafted": { "questionnaire": "short", "answers": [{ "value": 2 }, { "text": "hm" }] } });
    assert_eq!(person.tell(&server, &drafted)["page"], "questionnaire");
    drop(page);
    server.end();
    let server = Server::start(&scratch, "0");
    let draft = person.wait_for(&server, "questionnaire")["draft"].clone();
    assert_eq!(draft, json!([{ "value": 2 }, { "text": "hm" }]));
    server.end();

    let (data, out) = (scratch.path("data"), scratch.path("tables"));
    let log = format!("{data}/logs/P01-01-1.mcap");
    let settings = cohabit_record::Log::open(log.as_ref()).unwrap().session.settings;
    let noted = ["figures", "microphone", "score", "name.0"].map(|name| settings[name].as_str());
    assert_eq!(noted, ["hidden", "hidden", "hidden", "Robin"]);
    // No level of a factor counts: the robot asks and knows as it does if nothing is said.
    assert_eq!((settings["ask"].as_str(), settings["knows"].as_str()), ("unsure", "seen"));
    let rows = |arguments: &[&str], name: &str| {
        let arguments = [&["study", "export", "--folder", &data, "--out", &out], arguments].concat();
        let done = run(COHABIT, &arguments).unwrap();
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        fs::read_to_string(format!("{out}/{name}.csv")).unwrap().lines().skip(1).map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!((rows(&[], "sessions").len(), rows(&[], "missions").len(), rows(&[], "answers").len()), (0, 0, 0));
    let (sessions, missions) = (rows(&["--practice"], "sessions"), rows(&["--practice"], "missions"));
    assert!(
        sessions.len() == 1 && sessions[0].starts_with("P01-01-1,") && sessions[0].contains("true"),
        "{sessions:?}"
    );
    assert!(missions.len() == 1 && missions[0].contains("laser_lab"), "{missions:?}");
    assert!(rows(&[], "participants")[0].contains("laser_lab (practice)"));
}
