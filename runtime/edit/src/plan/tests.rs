//! Each edit of a floor plan, and a whole plan that is drawn by edits alone.
#![allow(clippy::unwrap_used)]

use cohabit_cdf::layout::LayoutFault;
use serde_json::json;

use super::*;

fn document() -> PlanDocument {
    PlanDocument::new("my-lab/layouts/Flat.toml", Arc::new(Catalog::builtin())).unwrap()
}

/// The text after edits as the page sends them.
fn edited(text: &str, edits: &[Value]) -> String {
    let plan = document();
    let apply =
        |text: String, edit: &Value| plan.edited(&text, edit.clone()).unwrap_or_else(|why| panic!("{edit}: {why}"));
    edits.iter().fold(text.to_owned(), apply)
}

fn layout(text: &str) -> Layout {
    document().draft(text).layout.unwrap()
}

/// Two rooms with a door between them.
fn flat() -> String {
    let edits = [
        json!({ "do": "add_room", "room": "Lab1", "rect_m": [0.0, 0.0, 5.02, 4.0] }),
        json!({ "do": "add_room", "room": "Hallway", "rect_m": [5.1, 0.1, 8.0, 4.04] }),
        json!({ "do": "add_opening", "kind": "door", "at_m": [5.1, 2.0] }),
    ];
    edited(PlanDocument::empty(), &edits)
}

#[test]
fn a_flat_that_is_drawn_is_a_plan_without_faults() {
    let lacking = document().draft(&flat());
    let is_lack =
        |fault: &LayoutFault| matches!(fault, LayoutFault::NoViewpoint { .. } | LayoutFault::NotePlaces { .. });
    assert!(!lacking.faults.is_empty() && lacking.faults.iter().all(is_lack), "{:?}", lacking.faults);
    let edits = [
        json!({ "do": "complete" }),
        json!({ "do": "add_thing", "class": "Desk_01", "at_m": [0.6, 2.0] }),
        json!({ "do": "add_thing", "class": "CoffeeMug_Boss", "at_m": [0.6, 2.0] }),
        json!({ "do": "add_opening", "kind": "window", "at_m": [2.5, 0.2] }),
    ];
    let text = edited(&flat(), &edits);
    let plan = layout(&text);
    let mug = plan.placements.iter().find(|thing| thing.instance.starts_with("CoffeeMug_Boss")).unwrap();
    assert_eq!((mug.on.as_deref(), mug.anchor, mug.room), (Some("Desk_01_10000"), true, RoomId::LAB1));
    assert_eq!((plan.viewpoints.len(), plan.note_places.len(), plan.openings.len()), (16, 8, 2));
    let draft = document().draft(&text);
    // Furniture may have come to stand in viewpoints, and nowhere else.
    let others = draft.faults.iter().filter(|fault| !matches!(fault, LayoutFault::Viewpoint { .. }));
    assert_eq!(others.collect::<Vec<_>>(), [] as [&LayoutFault; 0], "{text}");
    let mission = document().mission(&text);
    assert!(
        mission.contains("\"layoutOverride\":\"Flat\"") && mission.contains("\"roomLocation\":[\"Lab1\"]"),
        "{mission}"
    );
}

#[test]
fn what_stands_on_furniture_goes_with_it() {
    let edits = [
        json!({ "do": "add_thing", "class": "Desk_01", "at_m": [0.6, 2.0] }),
        json!({ "do": "add_thing", "class": "Bowl_01", "at_m": [2.5, 2.0] }),
        json!({ "do": "drop_thing", "instance": "Bowl_01_10000", "at_m": [0.5, 2.0] }),
        json!({ "do": "drop_thing", "instance": "Desk_01_10000", "at_m": [6.5, 2.0] }),
        json!({ "do": "set_thing", "instance": "Desk_01_10000", "at_m": [6.5, 2.5, 0.0], "yaw_deg": 270.0 }),
    ];
    let text = edited(&flat(), &edits);
    let plan = layout(&text);
    let (desk, bowl) = (plan.placement("Desk_01_10000").unwrap(), plan.placement("Bowl_01_10000").unwrap());
    assert_eq!((desk.room, bowl.room), (RoomId::HALLWAY, RoomId::HALLWAY));
    assert_eq!((desk.at_m, desk.yaw_deg, bowl.on.as_deref()), ([6.5, 2.5, 0.0], -90.0, Some("Desk_01_10000")));
    let dropped = edited(&text, &[json!({ "do": "drop_thing", "instance": "Bowl_01_10000", "at_m": [1.0, 1.0] })]);
    let bowl = layout(&dropped).placement("Bowl_01_10000").unwrap().clone();
    assert_eq!((bowl.on, bowl.at_m, bowl.room), (None, [1.0, 1.0, 0.0], RoomId::LAB1));
    let gone = layout(&edited(&text, &[json!({ "do": "remove", "what": "thing", "instance": "Desk_01_10000" })]));
    assert!(gone.placements.iter().all(|thing| thing.instance.starts_with("Door_01")), "{:?}", gone.placements);
}

#[test]
fn a_thing_may_be_put_on_what_was_added_after_it() {
    let edits = [
        json!({ "do": "add_thing", "class": "Bowl_01", "at_m": [2.5, 2.0] }),
        json!({ "do": "add_thing", "class": "Desk_01", "at_m": [0.6, 2.0] }),
        json!({ "do": "drop_thing", "instance": "Bowl_01_10000", "at_m": [0.5, 2.0] }),
    ];
    let plan = layout(&edited(&flat(), &edits));
    assert_eq!(plan.placement("Bowl_01_10000").unwrap().on.as_deref(), Some("Desk_01_10000"));
}

#[test]
fn a_room_moves_with_what_is_in_it_and_goes_with_it() {
    let edits = [
        json!({ "do": "complete" }),
        json!({ "do": "add_thing", "class": "Desk_01", "at_m": [2.0, 2.0] }),
        json!({ "do": "add_opening", "kind": "window", "at_m": [0.1, 2.0] }),
    ];
    let text = edited(&flat(), &edits);
    let before = layout(&text);
    let moved = layout(&edited(&text, &[json!({ "do": "move_room", "room": "Lab1", "by_m": [-1.0, 0.5] })]));
    let by =
        |one: [f32; 2], other: [f32; 2]| [one[0] - other[0], one[1] - other[1]].map(|at| (at * 10.0).round() / 10.0);
    let desk = |plan: &Layout| plan.placement("Desk_01_10000").map(|desk| [desk.at_m[0], desk.at_m[1]]).unwrap();
    assert_eq!(by(desk(&moved), desk(&before)), [-1.0, 0.5]);
    assert_eq!(by(moved.openings[1].at_m, before.openings[1].at_m), [-1.0, 0.5]);
    assert_eq!(moved.openings[0].at_m, before.openings[0].at_m, "the door to another room stays");
    assert_eq!(by(moved.viewpoints[0].at_m, before.viewpoints[0].at_m), [-1.0, 0.5]);
    let gone = layout(&edited(&text, &[json!({ "do": "remove", "what": "room", "room": "Lab1" })]));
    assert_eq!((gone.rooms.len(), gone.openings.len(), gone.placements.len()), (1, 0, 0));
    assert!(gone.viewpoints.iter().all(|view| view.room == RoomId::HALLWAY));
}

#[test]
fn rooms_openings_and_viewpoints_are_changed_one_by_one() {
    let edits = [
        json!({ "do": "complete" }),
        json!({ "do": "height", "wall_height_m": 2.5 }),
        json!({ "do": "set_room", "room": "Lab1", "rects_m": [[0.0, -1.0, 5.0, 4.0]] }),
        json!({ "do": "finish", "room": "Lab1", "surface": "floor", "material": "tile", "color": "#112233" }),
        json!({ "do": "set_opening", "index": 0, "at_m": [5.0, 3.0], "width_m": 0.9 }),
        json!({ "do": "set_view", "room": "Lab1", "number": 1, "at_m": [2.0, 2.0], "yaw_deg": 450.0 }),
        json!({ "do": "remove", "what": "view", "room": "Lab1", "number": 2 }),
        json!({ "do": "remove", "what": "note", "index": 0 }),
    ];
    let plan = layout(&edited(&flat(), &edits));
    let room = plan.room(RoomId::LAB1).unwrap();
    assert_eq!(
        (plan.wall_height_m, room.rects_m[0], room.floor.color.as_str()),
        (2.5, [0.0, -1.0, 5.0, 4.0], "#112233")
    );
    assert_eq!((plan.openings[0].at_m, plan.openings[0].width_m), ([5.0, 3.0], 0.9));
    let view = plan.viewpoints.iter().find(|view| view.number == 1 && view.room == RoomId::LAB1).unwrap();
    assert_eq!((view.at_m, view.yaw_deg, plan.viewpoints.len(), plan.note_places.len()), ([2.0, 2.0], 90.0, 15, 7));
}

#[test]
fn what_cannot_be_is_said_in_words() {
    let plan = document();
    for (edit, said) in [
        (json!({ "do": "add_room", "room": "Lab1", "rect_m": [0.0, 10.0, 5.0, 14.0] }), "has a room `Lab1` already"),
        (
            json!({ "do": "add_room", "room": "Attic", "rect_m": [0.0, 10.0, 5.0, 14.0] }),
            "this world has no room `Attic`",
        ),
        (json!({ "do": "add_room", "room": "Lab2", "rect_m": [1.0, 1.0, 3.0, 3.0] }), "would lie on `Lab1`"),
        (json!({ "do": "add_room", "room": "Lab2", "rect_m": [9.0, 9.0, 9.1, 9.1] }), "at least 0.5 m"),
        (json!({ "do": "add_opening", "kind": "door", "at_m": [0.0, 2.0] }), "none behind this wall"),
        (json!({ "do": "set_opening", "index": 7, "at_m": [0.0, 2.0], "width_m": 1.0 }), "no such opening"),
        (json!({ "do": "add_thing", "class": "Dsk_01", "at_m": [1.0, 1.0] }), "did you mean"),
        (json!({ "do": "add_thing", "class": "Desk_01", "at_m": [-5.0, 1.0] }), "no room here"),
        (json!({ "do": "drop_thing", "instance": "Door_01_1", "at_m": [1.0, 1.0] }), "where its opening is"),
        (json!({ "do": "remove", "what": "thing", "instance": "Cake_1" }), "there is no `Cake_1`"),
        (json!({ "do": "height", "wall_height_m": 1e30 }), "out of range"),
        (json!({ "do": "dance" }), "no edit of a floor plan"),
    ] {
        let told = plan.edited(&flat(), edit).unwrap_err();
        assert!(told.contains(said), "`{said}` is not in {told}");
    }
    let broken = plan.edited(&flat(), json!({ "do": "text", "text": "room = [" })).unwrap();
    assert!(plan.edited(&broken, json!({ "do": "complete" })).unwrap_err().contains("mend it first"));
    let shown = plan.shown(&broken);
    assert!(shown["layout"].is_null() && shown["faults"][0]["message"].is_string(), "{shown}");
    let catalog = Arc::new(Catalog::builtin());
    for (file, said) in [("x/layouts/OfficeLayout1.toml", "already"), ("x/layouts/Flat_mirror.toml", "mirror image")] {
        assert!(PlanDocument::new(file, Arc::clone(&catalog)).unwrap_err().contains(said), "{file}");
    }
}

#[test]
fn a_variant_says_what_differs_from_its_base() {
    let edits = [
        json!({ "do": "drop_thing", "instance": "AP_Prop_Desk_Red_10000", "at_m": [1.0, 1.0] }),
        json!({ "do": "remove", "what": "thing", "instance": "Toaster_02" }),
    ];
    let base = Layout::builtin("OfficeLayout1").unwrap();
    let [x, y, _] = base.placement("AP_Prop_Desk_Red_10000").unwrap().at_m;
    let mut edits = edits.to_vec();
    edits[0]["at_m"] = json!([x + 0.2, y]);
    let text = edited("# Mine.\nbase = \"OfficeLayout1\"\n", &edits);
    assert!(
        text.starts_with("# Mine.\nbase = \"OfficeLayout1\"\n") && text.contains("remove = [\n  \"Toaster_02\","),
        "{text}"
    );
    let plan = layout(&text);
    assert!(plan.placement("Toaster_02").is_none());
    let plan_x = plan.placement("AP_Prop_Desk_Red_10000").unwrap().at_m[0];
    assert!((plan_x - x).abs() > 0.05, "{plan_x} {x}");
}

#[test]
fn comments_of_a_file_outlast_edits() {
    let text = "# Mine.\nbase = \"OfficeLayout1\"\n# Higher than that.\nwall_height_m = 2.85\n";
    let plan = PlanDocument::new("my-lab/layouts/Mine.toml", Arc::new(Catalog::builtin())).unwrap();
    let edit = json!({ "do": "height", "wall_height_m": 2.9 });
    let edited = plan.edited(text, edit).unwrap();
    let comments = |text: &str| text.lines().filter(|line| line.trim_start().starts_with('#')).count();
    assert!(comments(text) > 0 && comments(text) == comments(&edited));
    let changed = text.lines().zip(edited.lines()).filter(|(one, other)| one != other).count();
    assert!(changed <= 1, "{changed} lines are others");
}
