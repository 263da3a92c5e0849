//! What people say at home, to a robot that knows the classes and rooms of the world pack `homes`.
use crate::support::{Talk, means};

const KITCHEN: &[&str] = &[
    "plan House_Family Kitchen",
    "add Tomato on Kitchen_Island",
    "add Chef_Knife on Kitchen_Island",
    "add Dinner_Plate on Kitchen_Island",
    "Dinner_Plate dirty",
];

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
