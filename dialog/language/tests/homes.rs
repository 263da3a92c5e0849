//! What people say at home, to a robot that knows the classes and rooms of the world pack `homes`.
use crate::support::{Talk, means};

const KITCHEN: &[&str] = &[
    "plan House_Family Kitchen",
    "add Tomato on Kitchen_Island",
    "add Chef_Knife on Kitchen_Island",
    "add Dinner_Plate on Kitchen_Island",
    "Dinner_Plate dirty",
];

/// Asks, and finds that answers begin like this.
#[track_caller]
fn answers(talk: &mut Talk, expected: &[(&str, &str)]) {
    for (asked, begins) in expected {
        let told = talk.say(asked);
        assert!(told.starts_with(begins), "{asked} {told}");
    }
}

#[test]
fn any_knife_cuts_and_any_basin_washes() {
    means(KITCHEN, &["cut the tomato"], "take Chef_Knife, break Tomato");
    means(KITCHEN, &["slice up the tomato with the knife"], "take Chef_Knife, break Tomato");
    means(KITCHEN, &["wash the plate"], "take Dinner_Plate, toggle Kitchen_Sink_Double, clean Kitchen_Sink_Double");
    means(KITCHEN, &["fill the kettle"], "take Kettle, toggle Kitchen_Sink_Double, fill Kitchen_Sink_Double");
}

#[test]
fn rubbish_goes_into_a_bin_of_the_home() {
    means(KITCHEN, &["throw away the tomato"], "take Tomato, open Pedal_Bin, put Pedal_Bin");
    means(KITCHEN, &["throw the tomato on the kitchen island away"], "take Tomato, open Pedal_Bin, put Pedal_Bin");
    let mut talk = Talk::new(KITCHEN);
    answers(&mut talk, &[("did you throw away the tomato?", "= No")]);
    talk.say_and_do("throw away the tomato");
    answers(&mut talk, &[("did you throw it away?", "= Yes")]);
}

#[test]
fn machines_of_a_pack_are_switched_and_opened() {
    means(&["plan House_Family LivingRoom"], &["turn on the telly"], "toggle Television");
    means(&["plan House_Family UtilityRoom"], &["open the washing machine"], "open Washing_Machine");
}

#[test]
fn several_rooms_are_called_together_what_no_room_of_the_plan_is_called_alone() {
    let mut talk = Talk::new(&["plan Shared_House Kitchen"]);
    let found = talk.say("go to the bedroom");
    assert!(found.starts_with("? ") && found.contains("blue room"), "{found}");
    assert_eq!(talk.say("the green one"), "go GreenRoom");
}

#[test]
fn what_is_asked_of_a_thing_is_asked_of_the_one_that_was_named() {
    let two_plates = [
        "plan House_Family Kitchen",
        "add Dinner_Plate on Kitchen_Sink_Double",
        "add Dinner_Plate on Kitchen_Island",
        "Dinner_Plate dirty",
    ];
    let mut talk = Talk::new(&two_plates);
    for (asked, begins) in
        [("is the plate in the sink dirty?", "= No"), ("is the plate on the kitchen island dirty?", "= Yes")]
    {
        let told = talk.say(asked);
        assert!(told.starts_with(begins), "{asked} {told}");
    }
}

#[test]
fn what_it_did_is_told_of_what_it_did_alone() {
    let mut talk = Talk::new(KITCHEN);
    talk.say_and_do("put the tomato on the dining table");
    let asked = [
        ("did you put the tomato in the fridge?", "= No"),
        ("did you put the tomato on the dining table?", "= Yes"),
        ("did you put the dining table on the tomato?", "= No"),
        ("did you cut the tomato?", "= No"),
    ];
    answers(&mut talk, &asked);
    talk.say_and_do("wash the plate on the kitchen island");
    answers(&mut talk, &[("did you wash the plate?", "= Yes"), ("did you wash it?", "= Yes")]);
    talk.say_and_do("fill the kettle");
    let told = talk.say("did you fill it?");
    assert!(told.starts_with("= Yes") && told.contains("kettle"), "{told}");
}

#[test]
fn what_was_stopped_before_it_was_done_is_not_undone() {
    let mut talk = Talk::new(&["plan House_Family LivingRoom"]);
    assert_eq!(talk.say("turn on the telly"), "toggle Television");
    talk.say("stop");
    assert_eq!(talk.say("undo that"), "= There is nothing to undo yet.");
    assert_eq!(talk.say_and_do("turn on the telly"), "toggle Television");
    assert_eq!(talk.say("undo that"), "toggle Television");
}

#[test]
fn what_is_left_to_list_is_nothing_where_all_was_listed() {
    let mut talk = Talk::new(KITCHEN);
    talk.say_and_do("open the fridge");
    talk.say("what is in the fridge?");
    let told = talk.say("what else?");
    assert!(told.ends_with("there is nothing else."), "{told}");
}

#[test]
fn what_is_undone_goes_back_to_where_it_was() {
    let mut talk = Talk::new(KITCHEN);
    talk.say_and_do("put the tomato on the dining table");
    let steps = talk.say("undo that");
    assert!(steps.ends_with("put Kitchen_Island"), "{steps}");
}

#[test]
fn again_is_asked_of_things_as_they_are() {
    let mut talk = Talk::new(&["plan House_Family LivingRoom"]);
    talk.say_and_do("turn on the telly");
    let told = talk.say("do it again");
    assert!(told.starts_with("= ") && told.contains("already on"), "{told}");
}

#[test]
fn what_is_to_be_left_is_left_whatever_is_in_the_hand() {
    means(KITCHEN, &["pick up the tomato but leave the plate"], "take Tomato");
}

#[test]
fn several_things_are_washed_and_put_back() {
    let scene = [
        "plan House_Family Kitchen",
        "add Tomato on Kitchen_Island",
        "add Teacup on Kitchen_Island",
        "Tomato dirty",
        "Teacup dirty",
    ];
    let mut talk = Talk::new(&scene);
    talk.say_and_do("put the tomato and the teacup on the dining table");
    let back = talk.say("put them back");
    assert_eq!(back.matches("put Kitchen_Island").count(), 2, "{back}");
    let washed = talk.say("wash them");
    assert_eq!(washed.matches("clean Kitchen_Sink_Double").count(), 2, "{washed}");
}
