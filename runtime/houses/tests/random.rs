//! Random outlines, and random houses: whatever is made of them is sound.
#![allow(clippy::unwrap_used)]

use std::sync::LazyLock;

use cohabit_cdf::Layout;
use cohabit_houses::{HouseError, Importer};
use proptest::prelude::*;
use serde_json::{Value, json};

static IMPORTER: LazyLock<Importer> = LazyLock::new(Importer::default);

/// Types that houses have, on the floor, on walls and on other things.
const STANDING: [&str; 14] = [
    "Bed",
    "Sofa",
    "DiningTable",
    "Chair",
    "Desk",
    "ShelvingUnit",
    "Fridge",
    "CounterTop",
    "Toilet",
    "HousePlant",
    "Painting",
    "SideTable",
    "GarbageCan",
    "TVStand",
];
const LYING: [&str; 8] = ["Apple", "Mug", "Laptop", "Book", "Television", "Plate", "Pillow", "Microwave"];
const ROOMS: [&str; 4] = ["Kitchen", "LivingRoom", "Bedroom", "Bathroom"];

/// Something in a share of the house.
#[derive(Clone, Debug)]
struct Object {
    kind: usize,
    at: [f64; 2],
    turn_deg: f64,
    on: Vec<usize>,
}

fn object() -> impl Strategy<Value = Object> {
    let turn = prop_oneof![3 => (0..4).prop_map(|turn| f64::from(turn) * 90.0), 1 => 0.0..360.0];
    (0..STANDING.len(), [0.0..1.0, 0.0..1.0], turn, prop::collection::vec(0..LYING.len(), 0..5))
        .prop_map(|(kind, at, turn_deg, on)| Object { kind, at, turn_deg, on })
}

/// Rooms side by side along z, each with a door to the next.
fn house(widths_m: &[f64], depth_m: f64, objects: &[Object]) -> Value {
    let point = |x: f64, y: f64, z: f64| json!({ "x": x, "y": y, "z": z });
    let (mut rooms, mut walls, mut doors, mut west) = (Vec::new(), Vec::new(), Vec::new(), -3.7);
    for (index, width) in widths_m.iter().enumerate() {
        let east = west + width;
        let corners = [[west, 0.0], [west, depth_m], [east, depth_m], [east, 0.0]].map(|[x, z]| point(x, 0.0, z));
        let id = format!("room|{index}");
        rooms.push(json!({ "id": id, "roomType": ROOMS[index % 4], "floorPolygon": corners }));
        let polygon = [point(east, 0.0, 0.0), point(east, 0.0, depth_m)];
        walls.push(json!({ "id": format!("wall|{index}"), "roomId": id, "polygon": polygon }));
        if index + 1 < widths_m.len() {
            let hole = [point(0.4 * depth_m, 0.0, 0.0), point(0.4 * depth_m + 0.9, 2.0, 0.0)];
            doors.push(json!({ "assetId": "Doorway_1", "room0": id, "room1": format!("room|{}", index + 1),
                "wall0": format!("wall|{index}"), "holePolygon": hole }));
        }
        west = east;
    }
    let whole = west + 3.7;
    let place = |at: [f64; 2], y: f64| point(at[0] * whole - 3.7, y, at[1] * depth_m);
    let object = |object: &Object| {
        let on = |kind: &usize| json!({ "id": format!("{}|1", LYING[*kind]), "position": place(object.at, 0.9) });
        let y = if STANDING[object.kind] == "Painting" { 1.6 } else { 0.5 };
        json!({ "id": format!("{}|1", STANDING[object.kind]), "position": place(object.at, y),
            "rotation": { "y": object.turn_deg }, "children": object.on.iter().map(on).collect::<Vec<_>>() })
    };
    json!({ "rooms": rooms, "walls": walls, "doors": doors, "objects": objects.iter().map(object).collect::<Vec<_>>() })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(32) })]

    #[test]
    fn random_houses_are_sound_and_nothing_is_lost(
        widths_m in prop::collection::vec(2.0..6.0, 1..5),
        depth_m in 2.5..6.0,
        objects in prop::collection::vec(object(), 0..40),
    ) {
        let text = house(&widths_m, depth_m, &objects).to_string();
        let plan = IMPORTER.plan("Thor0000", &text).map_err(|error| TestCaseError::fail(error.to_string()))?;
        let left_out: usize = plan.report.left_out.iter().map(|one| one.count).sum();
        let given: usize = objects.iter().map(|object| 1 + object.on.len()).sum();
        prop_assert_eq!(plan.report.placed + left_out, given);
        prop_assert_eq!(plan.report.rooms, widths_m.len());
        let layout = Layout::parse("Thor0000_mirror", &[("Thor0000.toml", &plan.text)]).unwrap();
        prop_assert!(layout.faults(IMPORTER.world().catalog()).is_empty());
    }

    #[test]
    fn any_value_in_any_place_is_read_or_refused_in_words(place in 0_usize..400, value in 0_usize..8) {
        let mut house: Value = serde_json::from_str(include_str!("data/bedrooms.json")).unwrap();
        let values = [json!(null), json!(-1), json!("x"), json!([]), json!({}), json!(0.05), json!(true), json!(99)];
        let mut pointers = Vec::new();
        collect(&house, String::new(), &mut pointers);
        *house.pointer_mut(&pointers[place % pointers.len()]).unwrap() = values[value].clone();
        match IMPORTER.plan("Thor0000", &house.to_string()) {
            Ok(plan) => prop_assert!(!plan.text.is_empty()),
            Err(HouseError::Faults { faults }) => prop_assert!(false, "{faults:?}"),
            Err(error) => prop_assert!(!error.to_string().is_empty()),
        }
    }
}

/// The pointers of all values.
fn collect(value: &Value, at: String, pointers: &mut Vec<String>) {
    match value {
        Value::Object(members) => {
            members.iter().for_each(|(name, value)| collect(value, format!("{at}/{name}"), pointers));
        }
        Value::Array(items) => {
            (0..).zip(items).for_each(|(index, value): (usize, _)| collect(value, format!("{at}/{index}"), pointers));
        }
        _ => {}
    }
    pointers.push(at);
}
