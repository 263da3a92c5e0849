//! What missions ask for beside objects and goals, read into values; and what of it makes no sense.

#![allow(clippy::unwrap_used)]

use std::sync::LazyLock;

use cohabit_cdf::{
    Catalog, Mission, Predicate, Relation, RoomId, StateFlag,
    mission::{CameraView, DinoFood, Era, MessageTime, Portal, Problem, RobotRequest, read_mission},
};
use serde_json::{Value, json};

static CATALOG: LazyLock<Catalog> = LazyLock::new(Catalog::builtin);

/// A mission with everything in it that the format has.
fn full() -> Value {
    json!({
        "game_id": 3,
        "experimental": "true",
        "scene": {
            "floor_plan": 7,
            "roomLocation": ["Lab2"],
            "completelyRandomVisual": true,
            "blacklisted_layouts": ["OfficeLayout1"],
            "simbot_init": [{
                "name": "TAM_1", "roomLocation": ["Lab1"], "position": {"x": 1.5, "y": "-2"}, "yaw": 90,
                "heldObject": "Hammer_1", "state": [{"isHappy": "true"}]
            }],
            "required_objects": [
                {"name": "Hammer_1", "state": [{"isSad": "true"}], "condition": "BowlBroken"},
                {
                    "name": "Bowl_01_1", "associatedPastPortals": ["past"], "currentPortal": "future",
                    "associatedFuturePortals": [{"PortalName": "future"}], "dinoFood": "Apple",
                    "condition": {"isToggledOn": {"target": "FuseBox_01_Lever_1"}}
                },
                {"name": "FuseBox_01_Lever_1", "dinoFood": "Bowl_01_1", "condition": {"object": "Bowl_01_1", "state": "isHot"}},
                {"name": "Printer_3D_1", "state": [{"generateCircuitId": 9}, {"generatePower": "false"}, {"circuitId": "9"}]},
                {"name": "StickyNote_1", "state": [{"text": "Hello"}]}
            ]
        },
        "pastPortals": [{"PortalName": "past", "PortalStatus": false}],
        "futurePortals": [{"PortalName": "future", "PortalStatus": "Open"}],
        "task_goals": [
            {"goal_id": 0, "object_states": [{"Bowl_01_1": "isFilled=true"}, {"Hammer_1": "isScared=true"}],
             "visibility": {"isHidden": true, "activationInteractable": "StickyNote", "stickyNoteIndex": "0"}}
        ],
        "stateconditions": [{"stateName": "BowlBroken", "context": "Bowl_01_1", "expression": {"isBroken": {"target": "Bowl_01_1"}}}],
        "game_interactions": {
            "camera_movements": {
                "task_beginning": [{"target": "Bowl_01_1", "duration": "2.5"}, {"officeRoom": "Lab1", "message": "The lab"}],
                "task_procedure": [{"goal_id": 0, "goToPoint": "Lab1_3", "durationMs": 1500}],
                "task_ending": ["Reception"],
                "object_conditions": [{"stateName": "BowlBroken", "position": [1, 2, 0.5]}]
            },
            "game_messages": {
                "object_conditions": [
                    {"message": "Mind the heat", "object_states": [{"Bowl_01_1": "isHot=true"}, {"Bowl_01_1": "isFilled=Milk"}], "relation": "or"},
                    {"message": "Cold", "Bowl_01_1": "isCold=true"},
                    {"message": "Cut off", "expression": {"NOT": {"expression": {"isToggledOn": {"target": "FuseBox_01_Lever_1"}}}}}
                ]
            }
        }
    })
}

fn read(value: &Value) -> Result<(Mission, Vec<String>), Vec<String>> {
    let unplaced = |problem: &Problem| Problem { position: None, ..problem.clone() }.to_string();
    match read_mission("m.json", &value.to_string(), &CATALOG) {
        Ok(checked) => Ok((checked.mission, checked.warnings.iter().map(unplaced).collect())),
        Err(problems) => Err(problems.iter().map(unplaced).collect()),
    }
}

fn mission() -> Mission {
    let (mission, warnings) = read(&full()).unwrap();
    assert_eq!(warnings, Vec::<String>::new());
    mission
}

#[test]
fn scenes_and_games() {
    let mission = mission();
    assert_eq!((mission.game_id.as_deref(), mission.experimental, mission.random_looks), (Some("3"), true, true));
    assert_eq!(mission.blacklisted_layouts, ["OfficeLayout1"]);
    assert_ne!(mission.layout, "OfficeLayout1");
    let expected = RobotRequest {
        name: Some("TAM_1".into()),
        room: Some(RoomId::LAB1),
        at_m: Some([1.5, -2.0]),
        yaw_deg: Some(90.0),
        holds: Some("Hammer_1".into()),
        flags: vec![(StateFlag::Happy, true)],
        ..RobotRequest::default()
    };
    assert_eq!(mission.robots, [expected]);
}

#[test]
fn portals_dinosaurs_circuits_and_moods() {
    let mission = mission();
    let portal = |name: &str, era, open| Portal { name: name.into(), era, open };
    assert_eq!(mission.portals, [portal("past", Era::Past, false), portal("future", Era::Future, true)]);
    let [hammer, bowl, lever, printer, _] = mission.objects.as_slice() else { panic!("five objects") };
    assert_eq!((&*bowl.past_portals, &*bowl.future_portals), (&["past".to_owned()][..], &["future".to_owned()][..]));
    assert_eq!(bowl.current_portal.as_deref(), Some("future"));
    assert_eq!(bowl.dino_food, Some(DinoFood::Class("Apple".into())));
    assert_eq!(lever.dino_food, Some(DinoFood::Instance("Bowl_01_1".into())));
    assert_eq!((printer.generates_circuit, printer.generates_power, printer.circuit), (Some(9), Some(false), Some(9)));
    assert_eq!(hammer.flags, [(StateFlag::Sad, true)]);
    let goal = &mission.goals[0];
    assert_eq!(goal.states[0].predicate, Predicate::FilledWithAny);
    assert_eq!(goal.states[1].predicate, Predicate::Flag(StateFlag::Scared, true));
    assert_eq!((goal.hidden, goal.unlocked_by.as_deref()), (true, Some("StickyNote_1")));
}

#[test]
fn occasions_are_read_in_many_shapes() {
    use cohabit_cdf::Occasion;
    let said = |occasion: &Occasion| match occasion {
        Occasion::States(states, Relation::And) => {
            states.iter().map(ToString::to_string).collect::<Vec<_>>().join(" & ")
        }
        Occasion::States(states, Relation::Or) => {
            states.iter().map(ToString::to_string).collect::<Vec<_>>().join(" | ")
        }
        Occasion::Expression(expression) => expression.to_string(),
    };
    let mission = mission();
    let objects: Vec<_> = mission.objects.iter().filter_map(|object| object.condition.as_ref()).map(said).collect();
    assert_eq!(objects, ["Hammer_1: BowlBroken=true", "FuseBox_01_Lever_1: isToggledOn=true", "Bowl_01_1: isHot=true"]);
    let messages: Vec<_> = mission.messages.iter().map(|message| (&message.when, message.text.as_str())).collect();
    let said: Vec<_> = messages
        .iter()
        .map(|(when, text)| match when {
            MessageTime::Occasion(occasion) => format!("{text} / {}", said(occasion)),
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(
        said,
        [
            "Mind the heat / Bowl_01_1: isHot=true | Bowl_01_1: isFilled=Milk",
            "Cold / Bowl_01_1: isCold=true",
            "Cut off / NOT FuseBox_01_Lever_1: isToggledOn=true"
        ]
    );
}

#[test]
fn camera_movements_are_read_in_many_shapes() {
    let mission = mission();
    let found: Vec<_> = mission
        .camera_movements
        .iter()
        .map(|movement| (movement.view.clone(), movement.duration_s, movement.text.as_deref()))
        .collect();
    let bowl = CameraView::Object(cohabit_cdf::InstancePattern("Bowl_01_1".into()));
    assert_eq!(
        found,
        [
            (bowl, 2.5, None),
            (CameraView::Room(RoomId::LAB1), 3.0, Some("The lab")),
            (CameraView::Viewpoint(RoomId::LAB1, 3), 1.5, None),
            (CameraView::Room(RoomId::RECEPTION), 3.0, None),
            (CameraView::Point([1.0, 2.0, 0.5]), 3.0, None),
        ]
    );
    let times: Vec<_> = mission.camera_movements.iter().map(|movement| &movement.when).collect();
    assert_eq!(
        (times[0], times[2], times[3]),
        (&MessageTime::Beginning, &MessageTime::GoalMet(0), &MessageTime::Ending)
    );
    assert!(matches!(times[4], MessageTime::Occasion(_)));
}

/// What is said of the full mission with `value` at `pointer`, which must be there.
#[track_caller]
fn check(pointer: &str, value: Value, expected: &str) {
    let mut mission = full();
    *mission.pointer_mut(pointer).unwrap() = value;
    let said = match read(&mission) {
        Ok((_, warnings)) => warnings,
        Err(problems) => problems,
    };
    assert_eq!(said.join("\n"), expected, "at {pointer}");
}

#[test]
fn a_portal_without_a_name_is_missed_by_what_names_it() {
    check(
        "/pastPortals/0/PortalName",
        json!(""),
        "m.json: /scene/required_objects/1/associatedPastPortals/0: warning: there is no portal `past`: it never opens; \
         declare it in `pastPortals`\n\
         m.json: /pastPortals/0/PortalName: the portal has no name",
    );
}

#[test]
fn what_makes_no_sense_is_said() {
    for (pointer, value, place, expected) in [
        ("/futurePortals/0/PortalStatus", json!("ajar"), "", ": expected true or false, found `ajar`"),
        (
            "/scene/required_objects/1/associatedPastPortals",
            json!(["pst"]),
            "/0",
            ": warning: there is no portal `pst`: it never opens; did you mean `past`?",
        ),
        ("/scene/required_objects/1/dinoFood", json!("Appel"), "", ": unknown object `Appel`; did you mean `Apple`?"),
        ("/scene/simbot_init/0/yaw", json!("north"), "", ": expected a number, found `north`"),
        ("/scene/simbot_init/0/position", json!({"x": 1}), "/y", ": the point has no y"),
        (
            "/scene/simbot_init/0/heldObject",
            json!("Hamer_1"),
            "",
            ": unknown object `Hamer_1`; did you mean `Hammer_1`?",
        ),
        (
            "/game_interactions/camera_movements/task_procedure/0/goToPoint",
            json!("Lab1_9"),
            "",
            ": unknown viewpoint `Lab1_9`; write a room and a number from 1 to 8, such as `Lab1_3`",
        ),
        (
            "/game_interactions/camera_movements/task_ending/0",
            json!({"duration": 1}),
            "",
            ": warning: it is not said where the camera looks: nothing is shown; \
             write {\"target\": \"Bowl_01_1\"}, or a room or viewpoint",
        ),
        (
            "/game_interactions/game_messages/object_conditions/1",
            json!({"message": "When?"}),
            "",
            ": warning: no state of an object is found: it never comes about; \
             write {\"object_states\": [{\"Bowl_01_1\": \"isHot=true\"}]}",
        ),
        (
            "/task_goals/0/visibility/stickyNoteIndex",
            json!(4),
            "",
            ": nothing unlocks this hidden goal: the mission has no sticky note of number 4; the only one is number 0",
        ),
        (
            "/task_goals/0/visibility",
            json!({"isHidden": true}),
            "/activationInteractable",
            ": nothing unlocks this hidden goal; name an object, `StickyNote` with a `stickyNoteIndex`, or \
             `ALWAYS UNLOCKED`",
        ),
        (
            "/scene/required_objects/3/state",
            json!([{"circuitId": 77}]),
            "",
            ": warning: nothing feeds circuit 77: `Printer_3D_1` has no power; it is one of `1`, `2`, `3`",
        ),
        (
            "/scene/required_objects/0/state",
            json!([{"isSad": true}, {"isHappy": true}]),
            "",
            ": warning: `Hammer_1` shows one mood at a time; the last counts",
        ),
    ] {
        check(pointer, value, &format!("m.json: {pointer}{place}{expected}"));
    }
}
