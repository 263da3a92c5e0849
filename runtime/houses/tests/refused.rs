//! Files that are no houses are refused in words, with the place of what is wrong.
#![allow(clippy::unwrap_used)]

use std::sync::LazyLock;

use cohabit_houses::{Importer, MOST_BYTES};
use serde_json::{Value, json};

const FLAT: &str = include_str!("data/flat.json");

static IMPORTER: LazyLock<Importer> = LazyLock::new(Importer::default);

fn check(text: &str, expected: &str) {
    let said = IMPORTER.plan("Thor0000", text).unwrap_err().to_string();
    assert!(said.contains(expected), "`{expected}` is not in `{said}`");
}

/// The flat with something else in one place.
fn with(pointer: &str, value: Value) -> String {
    let mut house: Value = serde_json::from_str(FLAT).unwrap();
    *house.pointer_mut(pointer).unwrap() = value;
    house.to_string()
}

fn point(x: f64, z: f64) -> Value {
    json!({ "x": x, "y": 0, "z": z })
}

/// A house of one room with these corners.
fn room(corners: &[[f64; 2]]) -> String {
    let corners: Vec<Value> = corners.iter().map(|[x, z]| point(*x, *z)).collect();
    json!({ "rooms": [{ "id": "room|1", "roomType": "Kitchen", "floorPolygon": corners }] }).to_string()
}

#[test]
fn what_is_no_house_is_refused() {
    check("", "it is no JSON");
    check("{\"rooms\": [NaN]}", "it is no JSON: expected value at line 1");
    check("{\"rooms\": 1e999}", "it is no JSON: number out of range");
    check(&"[".repeat(100_000), "it is no JSON: recursion limit");
    check(&" ".repeat(MOST_BYTES + 1), "a house has at most 8388608");
    check("[]", "the house: it is no object");
    check("{}", "the house: it has no `rooms`");
    check("{\"rooms\": []}", "/rooms: there is none");
    check("{\"rooms\": [7]}", "/rooms/0: it is no object");
}

#[test]
fn the_place_of_what_is_wrong_is_said() {
    check(&with("/rooms/1/roomType", json!("Moat")), "/rooms/1/roomType: there is no type of rooms `Moat`");
    check(&with("/rooms/1/id", json!("room|2")), "/rooms/1/id: `room|2` is the id of an earlier room");
    check(&with("/rooms/2/floorPolygon/1/x", json!("NaN")), "/rooms/2/floorPolygon/1/x: it is no number");
    check(&with("/rooms/2/floorPolygon/1/x", json!(1e9)), "/rooms/2/floorPolygon/1/x: 1000000000 is out of range");
    check(&with("/rooms/2/floorPolygon/1/x", json!(500)), "/rooms: the house is");
    check(&with("/doors/1/wall0", json!("wall|9")), "/doors/1/wall0: there is no wall `wall|9`");
    check(&with("/doors/1/holePolygon", json!("wide")), "/doors/1/holePolygon: it is no list");
    check(
        &with("/doors/2/room0", json!("room|9")).replace("\"room1\":\"room|2\"", "\"room1\":\"x\""),
        "/doors/2/room0",
    );
    check(&with("/objects/3/position", json!({ "x": 1 })), "/objects/3/position: it has no `z`");
    check(&with("/objects/0/id", json!("x".repeat(1000))), "/objects/0/id: a text of 1000 bytes");
    check(&with("/objects", json!(vec![0; 1501])), "/objects: 1501 items: at most 1500");
}

#[test]
fn objects_that_lie_on_each_other_without_end_are_refused() {
    let mut object = json!({ "id": "Box|1", "position": point(4.0, 4.0) });
    for _ in 0..20 {
        object = json!({ "id": "Box|1", "position": point(4.0, 4.0), "children": [object] });
    }
    check(&with("/objects/0", object), "more than 8 objects lie on each other");
    // As many as may be on each of them are too many in all.
    let shelf = json!({ "id": "Shelf|1", "position": point(4.0, 4.0), "children": vec![json!({ "id": "Cup|1", "position": point(4.0, 4.0) }); 800] });
    check(&with("/objects", json!([shelf.clone(), shelf])), "/objects/1/children: there are too many objects");
}

#[test]
fn a_room_that_is_no_floor_is_refused_at_its_corner() {
    check(
        &room(&[[0.0, 0.0], [4.0, 0.0], [5.0, 4.0], [0.0, 4.0]]),
        "/rooms/0/floorPolygon/1: the side of `room|1` that begins here",
    );
    check(
        &room(&[[0.0, 0.0], [8.0, 0.0], [8.0, 8.0], [4.0, 8.0], [4.0, -4.0], [0.0, -4.0]]),
        "/rooms/0/floorPolygon/3: the outline of `room|1` meets itself here",
    );
    check(&room(&[[0.0, 0.0], [4.0, 0.0]]), "/rooms/0/floorPolygon");
    check(&room(&[]), "/rooms/0/floorPolygon: `room|1` has no floor");
    check(&room(&[[0.0, 0.0], [0.01, 0.0], [0.01, 4.0], [0.0, 4.0]]), "/rooms/0/floorPolygon");
    check(&room(&[[0.0, 0.0], [0.8, 0.0], [0.8, 4.0], [0.0, 4.0]]), "has no room to walk");
    let twice =
        with("/rooms/1/floorPolygon", serde_json::from_str::<Value>(FLAT).unwrap()["rooms"][2]["floorPolygon"].take());
    check(&twice, "shares floor with");
}

#[test]
fn fields_that_nobody_knows_are_ignored() {
    let mut house: Value = serde_json::from_str(FLAT).unwrap();
    let plain = IMPORTER.plan("Thor0000", FLAT).unwrap();
    house["secrets"] = json!([1, { "deep": null }]);
    house["rooms"][0]["mood"] = json!("cosy");
    house["objects"][0]["smell"] = json!({});
    assert_eq!(IMPORTER.plan("Thor0000", &house.to_string()).unwrap().text, plain.text);
}
