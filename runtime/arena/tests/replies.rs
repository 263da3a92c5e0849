//! What clients send, and what they are answered.

#![allow(clippy::unwrap_used)]

mod support;

use std::{collections::BTreeSet, sync::Arc};

use cohabit_cdf::Catalog;
use proptest::prelude::*;
use serde_json::{Value, json};
use support::{Client, Folder, arena, builtin, command, mission, object};

const OK: &str = "ActionSuccessful";

/// The pictures of a reply, decoded: `[picture][pixel]`.
fn pictures(reply: &Value, field: &str) -> Vec<Vec<[u8; 4]>> {
    use base64::{Engine as _, engine::general_purpose::STANDARD};
    let decode = |picture: &Value| {
        let bytes = STANDARD.decode(picture.as_str().unwrap()).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let info = reader.info();
        assert_eq!((info.width, info.height, info.color_type), (300, 300, png::ColorType::Rgba));
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        pixels.as_chunks().0.to_vec()
    };
    reply[field].as_array().unwrap().iter().map(decode).collect()
}

#[test]
fn an_arena_that_ends_carries_out_no_more_of_a_batch() {
    let mut client = Client::new();
    let stop = Arc::new(std::sync::atomic::AtomicBool::new(false));
    client.arena = client.arena.ending_at(Arc::clone(&stop));
    assert!(client.send(mission(json!([])).as_bytes()).is_none());
    client.must(&["rotate 10"]);
    stop.store(true, std::sync::atomic::Ordering::Relaxed);
    client.check("room Lab1", "ArenaUnavailable");
}

fn find<'a>(reply: &'a Value, instance: &str) -> &'a Value {
    let objects = reply["objects"].as_array().unwrap();
    objects.iter().find(|object| object["objectID"] == instance).unwrap_or_else(|| panic!("no {instance}"))
}

fn color(object: &Value) -> [u8; 4] {
    let channels = &object["instanceSegmentationColor"];
    ["r", "g", "b", "a"].map(|channel| u8::try_from(channels[channel].as_u64().unwrap()).unwrap())
}

/// The last command that was carried out, as a client reads it: a text that is JSON itself.
fn last_action(reply: &Value) -> Value {
    serde_json::from_str(reply["lastAction"].as_str().unwrap()).unwrap()
}

/// Whether every field is there, of the right type, also where there is no game.
fn check_form(reply: &Value) {
    let texts = |value: &Value| value.as_array().unwrap().iter().all(Value::is_string);
    assert!(reply["lastActionSuccess"].is_string() && reply["message"].is_string());
    let last = last_action(reply);
    assert!(last["commandNum"].is_i64() && last["commandType"].is_string(), "{last}");
    for field in ["colorImage", "depthImage", "normalsImage", "instanceSegmentationImage"] {
        assert!(texts(&reply[field]), "{field}");
    }
    let place = |value: &Value| ["x", "y", "z"].iter().all(|axis| value[axis].is_number());
    let mut colors = BTreeSet::new();
    for object in reply["objects"].as_array().unwrap() {
        for field in ["objectID", "objectType", "currentRoom", "parentReceptacle"] {
            assert!(object[field].is_string(), "{field} of {object}");
        }
        assert!(place(&object["position"]) && place(&object["rotation"]) && object["rotation"]["w"].is_number());
        for field in ["supportedVerbs", "supportedStates", "currentStates"] {
            assert!(texts(&object[field]), "{field} of {object}");
        }
        let supported = object["supportedStates"].as_array().unwrap();
        assert!(object["currentStates"].as_array().unwrap().iter().all(|state| supported.contains(state)), "{object}");
        assert!(colors.insert(color(object)), "two have the colour of {object}");
    }
    assert!(reply["agent"]["rightHandHeldObject"].is_string());
    assert!(reply["sceneMetadata"]["GoToPoints"].as_object().unwrap().values().all(place));
    for goal in reply["challengeProgress"]["ChallengeGoals"].as_array().unwrap() {
        assert!(goal["goal_id"].is_i64() && goal["isFinished"].is_boolean() && goal["description"].is_string());
    }
}

#[test]
fn a_game_is_launched_and_seen() {
    let mut client = Client::launched(builtin("warm_coffee"));
    let reply = client.batch(&[command("rotate 0")]);
    check_form(&reply);
    assert_eq!(reply["lastActionSuccess"], OK);
    assert_eq!(reply["objects"][0]["objectID"], "TAM_1");
    assert_eq!(find(&reply, "CoffeeMug_Boss_1")["currentRoom"], "BreakRoom");
    assert!(find(&reply, "CoffeeMug_Boss_1")["currentStates"].as_array().unwrap().contains(&json!("FILLED")));
    assert_eq!(find(&reply, "CoffeeMug_Boss_1")["parentReceptacle"], "KitchenCounterTop_02_1");
    assert_eq!(reply["sceneMetadata"]["GoToPoints"].as_object().unwrap().len(), 64);
    assert_eq!(reply["challengeProgress"]["ChallengeGoals"].as_array().unwrap().len(), 3);
    for field in ["colorImage", "depthImage", "normalsImage", "instanceSegmentationImage"] {
        assert_eq!(pictures(&reply, field).len(), 1, "{field}");
    }
    // A plain wire: all that is sent to be looked at is opaque; depths are of rooms, not of miles.
    assert!(pictures(&reply, "colorImage")[0].iter().all(|pixel| pixel[3] == 255));
    assert!(pictures(&reply, "depthImage")[0].iter().all(|pixel| pixel[0] < 8 && pixel[3] == 0));
}

#[test]
fn what_is_looked_at_is_found_by_its_colour() {
    let mut client = Client::launched(builtin("warm_coffee"));
    client.must(&["goto CoffeeMug_Boss_1"]);
    let reply = client.batch(&[]);
    assert_eq!(reply["lastActionSuccess"], OK);
    let mug = color(find(&reply, "CoffeeMug_Boss_1"));
    let pixels: Vec<usize> = pictures(&reply, "instanceSegmentationImage")[0]
        .iter()
        .enumerate()
        .filter(|(_, pixel)| **pixel == mug)
        .map(|(place, _)| place)
        .collect();
    assert!(pixels.len() > 100, "{} pixels show the mug", pixels.len());
    // The same by a pixel of it.
    let place = pixels[pixels.len() / 2];
    client.must(&["room Reception", "goto KitchenCounterTop_02_1", "goto CoffeeMug_Boss_1"]);
    let raycast = json!({"commandType": "GoTo", "goToCommand": {"raycast": {"x": place % 300, "y": place / 300}}});
    assert_eq!(client.batch(&[raycast])["lastActionSuccess"], OK);
}

#[test]
fn a_look_around_gives_four_pictures_until_the_next_command() {
    let mut client = Client::launched(builtin("warm_coffee"));
    for turns in [false, true] {
        let around =
            json!({"commandType": "LookAround", "lookAroundCommand": {"fieldOfView": 100, "shouldRotate": turns}});
        let reply = client.batch(std::slice::from_ref(&around));
        for field in ["colorImage", "depthImage", "normalsImage", "instanceSegmentationImage"] {
            let four = pictures(&reply, field);
            assert_eq!(four.len(), 4, "{field}");
            assert!(four.iter().skip(1).all(|picture| *picture != four[0]), "{field}");
        }
        let after = client.batch(&[around, command("rotate 90")]);
        assert_eq!(pictures(&after, "colorImage").len(), 1);
        client.must(&["rotate -90"]);
    }
    // To the right of where one looks is what one sees after a turn to the right.
    let seen = |reply: &Value, index: usize| -> BTreeSet<[u8; 4]> {
        pictures(reply, "instanceSegmentationImage")[index].iter().copied().collect()
    };
    let around = client.batch(&[json!({"commandType": "LookAround"})]);
    client.must(&["rotate 90"]);
    let right = client.batch(&[]);
    let wide = seen(&around, 1);
    let (common, all) = (seen(&right, 0).intersection(&wide).count(), seen(&right, 0).len());
    // All 11 when this was written.
    assert!(common + 1 >= all, "{common} of {all}");
}

#[test]
fn cameras_change() {
    let mut client = Client::launched(builtin("warm_coffee"));
    let change = |mode: &str| json!({"commandType": "CameraChange", "camChangeCommand": {"mode": mode}});
    let robot = color(&client.batch(&[])["objects"][0]);
    let shows = |reply: &Value| pictures(reply, "instanceSegmentationImage")[0].contains(&robot);
    assert!(!shows(&client.batch(&[change("Camera_TAM")])));
    assert!(shows(&client.batch(&[change("Camera_Regular")])));
    assert!(shows(&client.batch(&[])));
    assert!(!shows(&client.batch(&[change("Camera_TAM")])));
}

#[test]
fn a_robot_moves_as_it_is_told() {
    let mut client = Client::launched(builtin("warm_coffee"));
    let pose = |reply: &Value| {
        let robot = &reply["objects"][0];
        let of = |value: &Value| value.as_f64().unwrap();
        let (y, w) = (of(&robot["rotation"]["y"]), of(&robot["rotation"]["w"]));
        ([of(&robot["position"]["x"]), of(&robot["position"]["z"])], (2.0 * y.atan2(w)).to_degrees().rem_euclid(360.0))
    };
    let (_, before) = pose(&client.batch(&[]));
    let (from, after) = pose(&client.check("rotate 90", OK));
    assert!(((after - before).rem_euclid(360.0) - 90.0).abs() < 0.5, "{before} to {after} degrees");
    // Heading from north, clockwise: what is ahead lies there.
    let (sin, cos) = after.to_radians().sin_cos();
    let (to, _) = pose(&client.batch(&[command("forward 0.3")]));
    let gone = (to[0] - from[0]) * sin + (to[1] - from[1]) * cos;
    assert!((gone - 0.3).abs() < 0.01, "{gone} m");
    let look = |kind: &str| json!({"commandType": kind, "panAndLookCommand": {"magnitude": 20}});
    let (level, down) = (client.batch(&[]), client.batch(&[look("LookDown")]));
    assert_ne!(level["colorImage"], down["colorImage"]);
    assert_eq!(level["colorImage"], client.batch(&[look("LookUp")])["colorImage"]);
    let back = json!({"commandType": "MoveBackward", "magnitude": 0.3});
    let (again, _) = pose(&client.batch(&[back]));
    assert!((again[0] - from[0]).hypot(again[1] - from[1]) < 0.01);
    let points = client.batch(&[])["sceneMetadata"]["GoToPoints"].clone();
    let reply = client.check("point BreakRoom_3", OK);
    let (at, _) = pose(&reply);
    assert!((at[0] - points["BreakRoom_3"]["x"].as_f64().unwrap()).abs() < 0.01);
    let position = json!({"commandType": "GoTo", "goToCommand": {"position": points["BreakRoom_5"]}});
    let (at, _) = pose(&client.batch(&[position]));
    assert!((at[1] - points["BreakRoom_5"]["z"].as_f64().unwrap()).abs() < 0.01);
}

#[test]
fn a_batch_stops_at_the_first_failure() {
    let mut client = Client::launched(builtin("warm_coffee"));
    let reply = client.batch(&[
        command("goto CoffeeMug_Boss_1"),
        command("pickup CoffeeMug_Boss_1"),
        command("pickup KitchenCounterTop_02_1"),
        command("place KitchenCounterTop_02_1"),
    ]);
    assert_eq!(reply["lastActionSuccess"], "AlreadyHoldingObject");
    assert!(reply["message"].as_str().unwrap().starts_with("/2: I am already holding"), "{}", reply["message"]);
    assert_eq!(reply["agent"]["rightHandHeldObject"], "CoffeeMug_Boss_1");
    assert_eq!(reply["challengeProgress"]["ChallengeGoals"][0]["isFinished"], true);
    // What comes before a malformed command is done all the same.
    let reply = client.batch(&[command("place KitchenCounterTop_02_1"), json!({"commandType": 7})]);
    assert_eq!(reply["lastActionSuccess"], "IncorrectActionFormat");
    assert_eq!(reply["agent"]["rightHandHeldObject"], "");
    let many = vec![command("rotate 0"); 1001];
    let reply = client.batch(&many);
    assert!(reply["message"].as_str().unwrap().contains("at most 1000"), "{}", reply["message"]);
}

#[test]
fn a_reply_names_the_last_command_that_was_carried_out() {
    let check = |reply: &Value, number: i64, kind: &str, status: &str| {
        let last = last_action(reply);
        let found = (&last["commandNum"], &last["commandType"], &reply["lastActionSuccess"]);
        assert_eq!(found, (&json!(number), &json!(kind), &json!(status)), "{}", reply["message"]);
    };
    let early = Client::new().batch(&[command("rotate 0")]);
    check(&early, -1, "", "ArenaUnavailable");
    let mut client = Client::launched(builtin("warm_coffee"));
    let [turn, unknown] = [command("rotate 0"), command("goto Unicorn_01_1")];
    let jump = json!({"commandType": "Jump"});
    let around = json!({"commandType": "LookAround"});
    let fails = "InvalidObjectClass";
    let cases: [(&[&Value], i64, &str, &str); 8] = [
        (&[], -1, "", OK),
        (&[&turn], 0, "Rotate", OK),
        (&[&turn, &turn, &around], 2, "LookAround", OK),
        (&[&unknown, &turn], 0, "GoTo", fails),
        (&[&turn, &around, &unknown, &turn, &turn], 2, "GoTo", fails),
        (&[&turn, &jump, &turn], 1, "Jump", "InvalidCommand"),
        (&[&turn, &json!({"commandType": 7})], 1, "", "IncorrectActionFormat"),
        (&[&turn, &json!(7)], 1, "", "IncorrectActionFormat"),
    ];
    for (batch, number, kind, status) in cases {
        let batch: Vec<Value> = batch.iter().map(|command| (*command).clone()).collect();
        check(&client.batch(&batch), number, kind, status);
    }
    // What else the client wrote is told too, and it cannot give a command another number.
    let sent = json!({"commandType": "Rotate", "magnitude": 15.0, "rotationSpeed": 45, "commandNum": 9});
    let reply = client.batch(&[turn.clone(), sent]);
    let expected = json!({"commandType": "Rotate", "magnitude": 15.0, "rotationSpeed": 45, "commandNum": 1});
    assert_eq!(last_action(&reply), expected);
    // None of a batch that is too long is carried out, nor anything of what is no batch.
    check(&client.batch(&vec![turn; 1001]), -1, "", "IncorrectActionFormat");
    check(&client.send(b"7").unwrap(), -1, "", "IncorrectActionFormat");
}

#[test]
fn every_status_can_be_reached() {
    let on = |name: &str| object(name, json!([{"TableRound_02_1": "on"}]), json!([]));
    let within = |name: &str, place: &str| object(name, json!([{ place: "in" }]), json!([]));
    let is = |name: &str, state: Value| object(name, json!([]), json!([state]));
    let shut = json!([{"isOpen": "false"}, {"isLocked": "true"}]);
    let to_microwave = &["goto Microwave_01_1"][..];
    type Case<'a> = (&'a str, Vec<Value>, &'a [&'a str], &'a str);
    let cases: Vec<Case<'_>> = vec![
        ("UnsupportedAction", vec![], &["goto TableRound_02_1"], "pickup TableRound_02_1"),
        ("UnsupportedNavigation", vec![object("Door_01_3", json!([]), shut)], &[], "room Warehouse"),
        (
            "AlreadyHoldingObject",
            vec![on("Apple_1"), on("Bowl_01_1")],
            &["goto Apple_1", "pickup Apple_1"],
            "pickup Bowl_01_1",
        ),
        (
            "ReceptacleIsFull",
            vec![on("Apple_1"), is("Microwave_01_1", json!({"isOpen": "true"})), within("Bowl_01_1", "Microwave_01_1")],
            &["goto Apple_1", "pickup Apple_1", "goto Microwave_01_1"],
            "place Microwave_01_1",
        ),
        (
            "ReceptacleIsClosed",
            vec![is("FridgeLower_02_1", json!({"isOpen": "false"})), within("Apple_1", "FridgeLower_02_1")],
            &["goto FridgeLower_02_1"],
            "pickup Apple_1",
        ),
        ("TargetInaccessible", vec![], &[], "forward 30"),
        (
            "KilledByHazard",
            vec![is("Microwave_01_1", json!({"isSparking": "true"}))],
            to_microwave,
            "toggle Microwave_01_1",
        ),
        ("TargetOutOfRange", vec![on("Apple_1")], &["room Warehouse"], "pickup Apple_1"),
        (
            "ObjectUnpowered",
            vec![is("Microwave_01_1", json!({"isPowered": "false"}))],
            to_microwave,
            "toggle Microwave_01_1",
        ),
        (
            "ObjectOverloaded",
            vec![is("Microwave_01_1", json!({"isOverloaded": "true"}))],
            to_microwave,
            "toggle Microwave_01_1",
        ),
        (
            "InvalidCommand",
            vec![is("FridgeLower_02_1", json!({"isOpen": "true"}))],
            &["goto FridgeLower_02_1"],
            "open FridgeLower_02_1",
        ),
        ("ObjectNotPickedUp", vec![], &["goto TableRound_02_1"], "place TableRound_02_1"),
        (
            "ObjectNotPickedUp",
            vec![on("Bowl_01_1"), on("MilkCarton_01_1")],
            &["goto Bowl_01_1"],
            "pour MilkCarton_01_1 Bowl_01_1",
        ),
        (
            "ActionExecutionError",
            vec![on("Bowl_01_1"), is("KitchenCounterSink_01_1", json!({"isToggledOn": "false"}))],
            &["goto Bowl_01_1", "pickup Bowl_01_1", "goto KitchenCounterSink_01_1"],
            "fill KitchenCounterSink_01_1 Bowl_01_1",
        ),
        (
            "PostProcessError",
            vec![on("Floppy_Virus_1"), is("V_Monitor_Laser_10000", json!({"isPowered": "false"}))],
            &["goto Floppy_Virus_1", "pickup Floppy_Virus_1", "goto V_Monitor_Laser_10000"],
            "place V_Monitor_Laser_10000",
        ),
        ("InvalidObjectClass", vec![], &[], "goto Unicorn_01_1"),
        ("InvalidObjectClass", vec![], &[], "pickup Unassigned"),
        ("IncorrectActionFormat", vec![], &[], "rotate 100000"),
        ("ActionSuccessful", vec![], &[], "goto TableRound_02_1"),
    ];
    for (status, objects, before, line) in cases {
        let mut client = Client::launched(&mission(Value::from(objects)));
        client.must(before);
        let reply = client.check(line, status);
        check_form(&reply);
        assert!(!reply["message"].as_str().unwrap().is_empty());
    }
    // To where a table stands one comes as near as can be.
    let mut client = Client::launched(builtin("warm_coffee"));
    let table = find(&client.batch(&[]), "TableRound_02_1")["position"].clone();
    let to_table = json!({"commandType": "GoTo", "goToCommand": {"position": table}});
    let reply = client.batch(std::slice::from_ref(&to_table));
    assert_eq!(reply["lastActionSuccess"], "AlternateNavigationUsed", "{}", reply["message"]);
    // That is a success: the batch goes on.
    assert_eq!(client.batch(&[to_table, command("rotate 10")])["lastActionSuccess"], OK);
}

#[test]
fn a_sink_fills_and_a_carton_pours() {
    let on = |name: &str| object(name, json!([{"TableRound_02_1": "on"}]), json!([]));
    let sink = object("KitchenCounterSink_01_1", json!([]), json!([{"isToggledOn": "false"}]));
    let mut client = Client::launched(&mission(json!([on("Bowl_01_1"), on("CoffeeMug_Boss_1"), sink])));
    client.must(&["goto Bowl_01_1", "pickup Bowl_01_1", "goto KitchenCounterSink_01_1"]);
    client.must(&["toggle KitchenCounterSink_01_1"]);
    client.must(&["fill KitchenCounterSink_01_1 Bowl_01_1", "goto CoffeeMug_Boss_1"]);
    let states = |reply: &Value, instance: &str| find(reply, instance)["currentStates"].to_string();
    let reply = client.check("pour Bowl_01_1 CoffeeMug_Boss_1", OK);
    assert!(states(&reply, "CoffeeMug_Boss_1").contains("FILLED") && !states(&reply, "Bowl_01_1").contains("FILLED"));
    client.check("throw Bowl_01_1 CoffeeMug_Boss_1", OK);
    client.check("scan TAM_1 CoffeeMug_Boss_1", OK);
    let reply = client.check("examine CoffeeMug_Boss_1", OK);
    assert!(states(&reply, "CoffeeMug_Boss_1").contains("SCANNED"));
    let highlight = json!({"commandType": "Highlight", "highlightCommand": {"instanceID": "CoffeeMug_Boss_1",
        "shouldRotateToObject": true, "shouldRotateBack": true}});
    let robot = |reply: &Value| reply["objects"][0]["rotation"]["y"].as_f64().unwrap();
    client.must(&["rotate 120"]);
    let before = client.batch(&[]);
    let after = client.batch(&[highlight]);
    assert_eq!(after["lastActionSuccess"], OK);
    assert!((robot(&before) - robot(&after)).abs() < 1e-3, "it does not turn back");
}

#[test]
fn nonsense_is_answered_with_what_is_wrong() {
    let mut client = Client::new();
    let early = client.batch(&[command("rotate 0")]);
    check_form(&early);
    assert_eq!(early["lastActionSuccess"], "ArenaUnavailable");
    assert!(early["message"].as_str().unwrap().contains("send a CDF"));
    let mut check = |message: &[u8], part: &str| {
        let reply = client.send(message).unwrap();
        check_form(&reply);
        assert_eq!(reply["lastActionSuccess"], "IncorrectActionFormat", "{reply}");
        assert!(reply["message"].as_str().unwrap().contains(part), "{reply}");
    };
    check(b"[{", "not JSON: EOF while parsing an object at line 1 column 2");
    check(b"[\xff]", "UTF-8 text from byte 1");
    check(b"7", "found a number");
    check(br#"{"commandType": "Rotate"}"#, "expected an array of commands");
    check("[".repeat(10_000).as_bytes(), "recursion limit");
    // Where there is a game, it goes on, and is shown.
    client.send(builtin("warm_coffee").as_bytes());
    let reply = client.send(b"7").unwrap();
    assert_eq!(reply["lastActionSuccess"], "IncorrectActionFormat");
    assert!(reply["colorImage"].as_array().unwrap().len() == 1 && !reply["objects"].as_array().unwrap().is_empty());
    client.check("rotate 10", OK);
}

#[test]
fn a_mission_that_cannot_be_launched_is_named() {
    let mut client = Client::launched(builtin("warm_coffee"));
    let mut check = |message: &str, part: &str| {
        assert!(client.send(message.as_bytes()).is_none());
        let reply = client.batch(&[command("rotate 0")]);
        assert_eq!(reply["lastActionSuccess"], "ArenaUnavailable");
        assert!(reply["message"].as_str().unwrap().contains(part), "{}", reply["message"]);
    };
    check(r#"{"scene": 1}"#, "CDF:1:");
    check(&mission(json!([object("Bowl_1", json!([]), json!([]))])), "Bowl_01");
    // One that opens a connection is meant as a mission, whatever it is.
    for (message, part) in [(r#"{"mission": {}}"#, "/scene"), (r#"{"scene": {"#, "CDF:1:11")] {
        let mut client = Client::new();
        assert!(client.send(message.as_bytes()).is_none());
        let reply = client.batch(&[]);
        assert!(reply["message"].as_str().unwrap().contains(part), "{}", reply["message"]);
    }
    // A log that cannot be written is no game either.
    let folder = Folder::new();
    let mut arena = arena(&folder.0.join("nowhere"));
    arena.launch("CDF", builtin("warm_coffee"));
    let reply: Value = serde_json::from_slice(&arena.answer(b"[]", false).unwrap()).unwrap();
    assert!(reply["message"].as_str().unwrap().contains("nowhere"), "{}", reply["message"]);
}

#[test]
fn what_is_left_to_chance_is_arranged_anew_in_each_game() {
    let apples = json!([object("Apple_1", json!([]), json!([]))]);
    let mut client = Client::new();
    let mut places = |floor_plan: &str| -> BTreeSet<String> {
        let cdf = mission(apples.clone()).replace(r#""floor_plan":"0""#, &format!(r#""floor_plan":"{floor_plan}""#));
        let place = |_| {
            assert!(client.send(cdf.as_bytes()).is_none());
            find(&client.batch(&[]), "Apple_1")["position"].to_string()
        };
        (0..4).map(place).collect()
    };
    assert!(places("-1").len() > 1);
    assert_eq!(places("7").len(), 1, "a mission with a seed is the same each time");
}

#[test]
fn each_game_has_a_log_that_replays() {
    let mut client = Client::launched(builtin("warm_coffee"));
    client.must(&["goto CoffeeMug_Boss_1", "pickup CoffeeMug_Boss_1", "room SmallOffice"]);
    client.arena.launch("CDF", builtin("laser_lab"));
    client.must(&["rotate 30"]);
    client.arena.finish();
    let catalog = Arc::new(Catalog::builtin());
    let ticks = client.folder.logs().into_iter().map(|path| {
        let log = cohabit_record::Log::open(&path).unwrap();
        let replay = cohabit_engine::replay::replay(&log, Arc::clone(&catalog)).unwrap();
        assert_eq!(replay.difference, None, "{}", path.display());
        replay.ticks
    });
    let ticks: Vec<u64> = ticks.collect();
    assert!(ticks.len() == 2 && ticks[0] > 300 && ticks[1] > 10, "{ticks:?}");
}

/// Every so many missions of the reference data are launched.
const EVERY: usize = 24;

#[test]
#[cfg_attr(not(reference_data), ignore = "needs the reference data in ../shared/arena")]
fn missions_of_the_reference_are_launched() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/arena/missions-dev.jsonl");
    let missions = std::fs::read_to_string(path).unwrap();
    let mut client = Client::new();
    for line in missions.lines().step_by(EVERY) {
        let task: Value = serde_json::from_str(line).unwrap();
        assert!(client.send(task["cdf"].to_string().as_bytes()).is_none());
        let reply = client.check("rotate 0", OK);
        check_form(&reply);
        let goals = reply["challengeProgress"]["ChallengeGoals"].as_array().unwrap().len();
        assert_eq!(goals, task["cdf"]["task_goals"].as_array().unwrap().len(), "{}", task["id"]);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn no_bytes_upset_it(messages in prop::collection::vec(prop::collection::vec(any::<u8>(), 1..60), 1..6)) {
        let mut client = Client::new();
        for message in messages {
            if let Some(reply) = client.send(&message) {
                check_form(&reply);
            }
        }
    }
}
