//! What people say at home, to a robot that knows the classes and rooms of the world pack `homes`.
use crate::support::{Talk, means, neighbours};

const KITCHEN: &[&str] = &[
    "plan House_Family Kitchen",
    "add Tomato on Kitchen_Island",
    "add Chef_Knife on Kitchen_Island",
    "add Dinner_Plate on Kitchen_Island",
    "Dinner_Plate dirty",
];

/// In the living room of a house where no lights are on but those of the kitchen.
fn with_lights_in_the_kitchen_alone() -> Talk {
    let mut talk = Talk::new(&["plan House_Family LivingRoom"]);
    for switch in talk.scene.objects.iter_mut().filter(|one| one.instance == "LightSwitch_01") {
        switch.flags.set(cohabit_cdf::StateFlag::Toggled, switch.room.id() == "Kitchen");
    }
    talk
}

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
    means(
        KITCHEN,
        &["wash the plate"],
        "take Dinner_Plate, toggle Kitchen_Sink_Double, clean Kitchen_Sink_Double, toggle Kitchen_Sink_Double",
    );
    means(
        KITCHEN,
        &["fill the kettle"],
        "take Kettle, toggle Kitchen_Sink_Double, fill Kitchen_Sink_Double, toggle Kitchen_Sink_Double",
    );
}

#[test]
fn what_is_poured_is_the_vessel_that_somebody_says_it_is_in() {
    let marks =
        &["plan House_Family Kitchen", "add Teapot on Kitchen_Island", "Teapot water", "add Teacup on Kitchen_Island"];
    for told in ["its in the teapot, the one you just filled", "It's in the teapot.", "in the teapot"] {
        let mut talk = Talk::new(marks);
        let asked = talk.say("pour the tea into the teacup");
        assert!(asked.starts_with("? I have not seen any tea."), "{asked}");
        assert_eq!(talk.say(told), "take Teapot, pour Teacup", "{told}");
    }
}

#[test]
fn things_are_called_what_all_of_their_kind_are() {
    let mut talk = Talk::new(&["plan House_Family Kitchen", "add Tumbler on Kitchen_Island"]);
    for asked in ["where are the glasses?", "is there something to drink from?"] {
        let told = talk.say(asked);
        assert!(told.contains("tumbler"), "{asked} {told}");
    }
    let told =
        Talk::new(&["plan Flat_One_Bed LivingRoom", "add Drying_Rack on Coffee_Table"]).say("where is the rack?");
    assert!(told.contains(" rack "), "{told}");
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
fn what_is_neither_opened_nor_closed_is_refused_at_once() {
    let mut talk = Talk::new(&["plan House_Family LivingRoom"]);
    answers(
        &mut talk,
        &[("close the piano", "! I cannot close the piano"), ("open the piano", "! I cannot open the piano")],
    );
    assert_eq!(talk.say("turn on the telly and close the piano"), "toggle Television");
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
fn what_is_put_next_to_a_thing_is_put_beside_it() {
    for (said, wanted, other) in [
        ("put the tomato next to the plate", "take Tomato, put Kitchen_Island", "Dinner_Plate"),
        ("set the knife beside the kettle", "take Chef_Knife, put Counter_Short", "Kettle"),
        ("put the tomato on the kitchen island by the plate", "take Tomato, put Kitchen_Island", "Dinner_Plate"),
    ] {
        let mut talk = Talk::new(KITCHEN);
        let understood = talk.language.understand(said, &talk.scene, &mut talk.context);
        assert_eq!(crate::support::text(&understood, &talk.scene), wanted, "{said}");
        assert_eq!(neighbours(&understood, &talk.scene), [other], "{said}");
    }
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
fn what_is_so_already_is_passed_over_and_the_rest_done() {
    let filled = |mug: &str, sink: &str| format!("take {mug}, toggle {sink}, fill {sink}, toggle {sink}");
    let office = filled("CoffeeMug_Yellow_1", "KitchenCounterSink_01_1");
    means(&[], &["wash the yellow mug and then fill it"], &office);
    let home = ["plan House_Family Kitchen", "add Teacup on Kitchen_Island"];
    means(&home, &["wash the teacup and then fill it"], &filled("Teacup", "Kitchen_Sink_Double"));
    let mut talk = Talk::new(&home);
    let replied = talk.language.understand("wash the teacup and then fill it", &talk.scene, &mut talk.context);
    assert!(replied.reply().starts_with("The teacup is clean already. OK, "), "{}", replied.reply());
    let told = Talk::new(&[]).say("wash the yellow mug");
    assert!(told.starts_with("= ") && told.ends_with("is clean already."), "{told}");
    means(&["plan House_Family Kitchen", "Kettle water"], &["fill the kettle"], "= The kettle is full already.");
}

#[test]
fn a_tap_that_is_needed_again_next_is_left_running() {
    let home = ["plan House_Family Kitchen", "add Teacup on Kitchen_Island", "Teacup dirty"];
    let sink = "Kitchen_Sink_Double";
    let washed = format!("take Teacup, toggle {sink}, clean {sink}, fill {sink}, toggle {sink}");
    means(&home, &["wash the teacup and then fill it"], &washed);
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

const LAUNDRY: &[&str] = &[
    "plan House_Family UtilityRoom",
    "add Shirt on Laundry_Basket",
    "add Iron on Storage_Shelf",
    "Shirt wet",
    "Shirt creased",
];

#[test]
fn laundry_is_dried_ironed_and_folded_by_what_the_pack_says() {
    let dries = "take Shirt, open Tumble_Dryer, put Tumble_Dryer, close Tumble_Dryer, toggle Tumble_Dryer";
    means(LAUNDRY, &["dry the shirt"], &format!("{dries}, open Tumble_Dryer, take Shirt"));
    means(LAUNDRY, &["iron the shirt"], "take Iron, toggle Iron, clean Shirt, toggle Iron");
    means(LAUNDRY, &["fold the shirt up"], "close Shirt");
    let mut talk = Talk::new(LAUNDRY);
    answers(
        &mut talk,
        &[("is the shirt dry?", "= No"), ("is it creased?", "= Yes"), ("did you fold the shirt?", "= No")],
    );
    talk.say_and_do("dry the shirt");
    talk.say_and_do("fold it");
    answers(
        &mut talk,
        &[("is the shirt wet?", "= No"), ("did you fold the shirt?", "= Yes"), ("is it folded?", "= Yes")],
    );
    answers(&mut talk, &[("did you close the shirt?", "= No")]);
    means(LAUNDRY, &["iron the shirt", "now fold it up"], "close Shirt");
    means(LAUNDRY, &["fold the laundry basket"], "! I cannot fold the laundry basket.");
}

#[test]
fn what_hands_did_to_laundry_and_plants_is_remembered_and_undone_as_that() {
    let utility =
        ["plan House_Family UtilityRoom", "add Shirt on Laundry_Basket", "add Iron on Storage_Shelf", "Shirt creased"];
    let mut talk = Talk::new(&utility);
    talk.say_and_do("iron the shirt");
    answers(&mut talk, &[("did you iron the shirt?", "= Yes"), ("did you wash the shirt?", "= No")]);
    let mut talk = Talk::new(&["plan House_Family LivingRoom", "add Tumbler on Coffee_Table", "Tumbler water"]);
    talk.say_and_do("water the plant");
    let told = talk.say("did you water it?");
    assert!(told.starts_with("= Yes") && told.contains("plant"), "{told}");
    let mut talk = Talk::new(&utility);
    talk.say_and_do("fold the shirt");
    let undone = talk.language.understand("undo that", &talk.scene, &mut talk.context);
    assert!(undone.reply().contains("unfolding the shirt"), "{}", undone.reply());
}

#[test]
fn what_was_done_to_a_thing_is_told_whoever_is_named_as_its_subject() {
    let mut talk = Talk::new(&["plan House_Family LivingRoom", "add Tumbler on Coffee_Table", "Tumbler water"]);
    talk.say_and_do("water the plant");
    for asked in ["did the plant get its water?", "has the plant been watered?", "did the plant get watered yet?"] {
        let told = talk.say(asked);
        assert!(told.starts_with("= Yes") && told.contains("plant"), "{asked} {told}");
    }
    let mut talk = Talk::new(KITCHEN);
    talk.say_and_do("put the tomato in the fridge");
    let asked = [
        ("has the tomato been put in the fridge?", "= Yes, I did: the tomato is in the"),
        ("is the tomato back?", "= No, the tomato is in the"),
    ];
    answers(&mut talk, &asked);
    talk.say_and_do("put the tomato on the kitchen island");
    let back = "= Yes, the tomato is on the kitchen island";
    answers(&mut talk, &[("is the tomato back?", back), ("has the tomato been put back?", back)]);
}

#[test]
fn what_hangs_on_a_drying_rack_dries() {
    let flat =
        ["plan Flat_One_Bed LivingRoom", "add Drying_Rack on Coffee_Table", "add Towel on Coffee_Table", "Towel wet"];
    means(&flat, &["dry the towel"], "take Towel, put Drying_Rack");
    let mut talk = Talk::new(&flat);
    talk.say_and_do("hang the towel on the drying rack");
    answers(&mut talk, &[("is the towel dry?", "= Yes")]);
}

#[test]
fn what_hangs_there_and_is_wet_is_hung_up_again() {
    let flat =
        ["plan Flat_One_Bed LivingRoom", "add Drying_Rack on Coffee_Table", "add Towel on Drying_Rack", "Towel wet"];
    means(&flat, &["dry the towel"], "take Towel, put Drying_Rack");
}

#[test]
fn plants_are_watered_with_what_carries_water() {
    let room = ["plan House_Family LivingRoom", "add Tumbler on Coffee_Table", "Tumbler water"];
    means(&room, &["water the plant"], "take Tumbler, pour Houseplant_Tall");
    let dry = ["plan Bungalow Patio"];
    let fetched = "take Watering_Can, toggle Washbasin, fill Washbasin, toggle Washbasin, pour Plant_Pot_Large";
    let mut talk = Talk::new(&dry);
    let done = talk.say("water the big plant pot by the table");
    assert!(done == fetched || done.starts_with("take Watering_Can, "), "{done}");
}

#[test]
fn plants_are_watered_with_what_was_named_for_it() {
    let room = [
        "plan House_Family LivingRoom",
        "add Watering_Can on Coffee_Table",
        "Watering_Can water",
        "add Tumbler on Coffee_Table",
        "Tumbler water",
    ];
    means(&room, &["water the plant with the watering can"], "take Watering_Can, pour Houseplant_Tall");
    means(&room, &["water the plant with the tumbler"], "take Tumbler, pour Houseplant_Tall");
}

#[test]
fn water_is_boiled_in_what_boils_it_and_tea_made_with_it() {
    let kitchen = ["plan House_Family Kitchen", "add Teacup on Kitchen_Island", "Kettle water"];
    means(&kitchen, &["boil the water in the kettle"], "toggle Kettle");
    means(&kitchen, &["make me a cup of tea"], "toggle Kettle, take Kettle, pour Teacup");
    let filled = "take Kettle, toggle Kitchen_Sink_Double, fill Kitchen_Sink_Double, toggle Kitchen_Sink_Double";
    means(KITCHEN, &["boil the kettle"], &format!("{filled}, put Counter_Short, toggle Kettle"));
    means(
        &kitchen,
        &["heat the milk"],
        "open Fridge_Freezer, take MilkCarton_01, put Stove, toggle Stove, take MilkCarton_01",
    );
}

#[test]
fn what_a_kettle_needs_is_done_first() {
    let filled = "take Kettle, toggle Kitchen_Sink_Double, fill Kitchen_Sink_Double, toggle Kitchen_Sink_Double";
    let boiled = format!("{filled}, put Counter_Short, toggle Kettle");
    for said in ["turn on the kettle", "switch the kettle on", "boil some water", "set the water boiling"] {
        means(KITCHEN, &[said], &boiled);
    }
    let mut talk = Talk::new(KITCHEN);
    let both = talk.say("turn on the kettle and put the tomato on the dining table");
    assert!(both.starts_with(&boiled) && both.contains("take Tomato"), "{both}");
    means(&["plan House_Family Kitchen", "Kettle water"], &["turn on the kettle"], "toggle Kettle");
}

#[test]
fn what_is_full_is_emptied_first_if_somebody_says_so() {
    let kitchen = ["plan House_Family Kitchen", "add Teacup on Kitchen_Island", "Teacup milk", "Kettle water"];
    let mut talk = Talk::new(&kitchen);
    assert_eq!(talk.say("pour the kettle into the teacup"), "? The teacup is full already. Shall I empty it first?");
    let emptied = "take Teacup, pour Kitchen_Sink_Double, put Kitchen_Island";
    assert_eq!(talk.say("yes"), format!("{emptied}, take Kettle, pour Teacup"));
    let mut talk = Talk::new(&kitchen);
    talk.say("pour the kettle into the teacup");
    assert!(talk.say("no").starts_with("= "));
}

#[test]
fn tea_is_made_in_what_was_named_for_it() {
    for (said, poured) in [("make tea in the teapot", "pour Teapot"), ("make some tea in the teacup", "pour Teacup")] {
        let done = Talk::new(&["plan House_Family Kitchen"]).say(said);
        assert!(done.ends_with(poured), "{said}: {done}");
    }
}

#[test]
fn laundry_is_washed_in_the_machine_that_is_made_for_it() {
    let dirty = ["plan House_Family UtilityRoom", "add Shirt on Laundry_Basket", "Shirt dirty"];
    let washed = "take Shirt, open Washing_Machine, put Washing_Machine, close Washing_Machine, toggle Washing_Machine";
    means(&dirty, &["wash the shirt"], &format!("{washed}, open Washing_Machine, take Shirt"));
    let mut talk = Talk::new(&dirty);
    answers(&mut talk, &[("what is dirty?", "= The shirt on the laundry basket.")]);
    talk.say_and_do("wash the shirt");
    answers(&mut talk, &[("what is dirty?", "= None that I know of."), ("what is wet?", "= The shirt in my hand.")]);
}

#[test]
fn whether_it_is_ready_is_told_by_the_machine_that_makes_it() {
    let mut talk = Talk::new(&["plan House_Family UtilityRoom", "add Shirt on Laundry_Basket", "Shirt dirty"]);
    talk.say_and_do("wash the shirt");
    answers(&mut talk, &[("is the washing machine finished?", "= Yes, the washing machine is done.")]);
    let mut talk = Talk::new(&["plan House_Family Kitchen", "Kettle water"]);
    let asked =
        [("is the water ready?", "= No, the water in the kettle is not hot."), ("is dinner ready?", "= No, I have")];
    answers(&mut talk, &asked);
    talk.say_and_do("boil the water in the kettle");
    answers(&mut talk, &[("is the water ready?", "= Yes, the water in the kettle is hot.")]);
    let boiled = "= Yes, the water in the kettle is hot.";
    answers(&mut talk, &[("has the kettle boiled?", boiled), ("is it boiled yet", boiled)]);
}

const CHILDREN: &[&str] = &["plan Flat_Two_Bed ChildrensRoom", "add Teddy_Bear on Bunk_Bed", "add Toy_Car on Bunk_Bed"];

#[test]
fn what_is_put_away_goes_where_such_things_are_kept_and_doors_are_shut_again() {
    means(CHILDREN, &["put the toy car away"], "take Toy_Car, open Toy_Box, put Toy_Box, close Toy_Box");
    let all = Talk::new(CHILDREN).say_and_do("tidy up the toys");
    assert!(all.contains("take Teddy_Bear, put Toy_Box") && all.contains("take Toy_Car, put Toy_Box"), "{all}");
    assert!(all.matches("open Toy_Box").count() == 1 && all.ends_with("close Toy_Box"), "{all}");
    let food = [KITCHEN, &["add Juice_Carton on Kitchen_Island"]].concat();
    let chilled = "take Juice_Carton, open Fridge_Freezer, put Fridge_Freezer, close Fridge_Freezer";
    means(&food, &["put the juice away"], chilled);
    means(
        KITCHEN,
        &["put the plate away"],
        "take Dinner_Plate, open Wall_Cupboard, put Wall_Cupboard, close Wall_Cupboard",
    );
    // Where it is to go was said.
    means(
        &food,
        &["put the juice away in the wall cupboard"],
        "take Juice_Carton, open Wall_Cupboard, put Wall_Cupboard",
    );
}

#[test]
fn a_table_is_cleared_of_all_that_stands_on_it() {
    let cleared = Talk::new(KITCHEN).say_and_do("put away everything on the kitchen island");
    assert!(cleared.contains("take Dinner_Plate, open Wall_Cupboard, put Wall_Cupboard"), "{cleared}");
    assert!(cleared.contains("take Tomato") && !cleared.contains("put Kitchen_Island"), "{cleared}");
    // More than it is sure of is asked about first.
    let asked = Talk::new(KITCHEN).say("clear the kitchen island");
    assert!(asked == cleared || asked.starts_with("? I understand: picking up the apple"), "{asked}");
    let mut talk = Talk::new(KITCHEN);
    // Whatever it takes to be the table, it asks.
    let asked = talk.say("clear the table");
    assert!(asked.starts_with("? "), "{asked}");
}

#[test]
fn of_two_tables_the_one_that_is_more_so_is_told_by_its_size_and_weight() {
    let told = |answer: &str| {
        let mut talk = Talk::new(KITCHEN);
        let asked = talk.say("bring the remote to the table");
        assert!(asked.starts_with("? Which one do you mean: the dining table"), "{asked}");
        talk.say(answer)
    };
    for answer in ["the shorter one", "the smaller one", "the lighter one", "the small one please"] {
        let steps = told(answer);
        assert!(steps.ends_with("put Coffee_Table"), "{answer}: {steps}");
    }
    for answer in ["the longer one", "the taller one", "the heavier one", "the big one"] {
        let steps = told(answer);
        assert!(steps.ends_with("put Dining_Table"), "{answer}: {steps}");
    }
}

/// Lets a thing lie on the floor where it is.
fn drop_on_floor(talk: &mut Talk, instance: &str) {
    let object = talk.scene.objects.iter_mut().rfind(|one| one.instance == instance).unwrap();
    (object.parent, object.position_m[2]) = (None, 0.0);
}

#[test]
fn of_a_kind_those_are_told_that_are_there() {
    for asked in ["what toys are lying around", "which toys are there?", "hey, which toys can you see"] {
        let told = Talk::new(CHILDREN).say(asked);
        assert!(told.contains("teddy bear") && told.contains("toy car") && !told.contains("I see"), "{asked} {told}");
    }
    let mut talk = Talk::new(KITCHEN);
    let asked = [
        ("what toys are in here?", "= I know of no toy here: the"),
        ("any toys in here?", "= No, I know of no toy here: the"),
        ("any tomato in here?", "= Yes, the tomato"),
    ];
    answers(&mut talk, &asked);
    let told = talk.say("which plates are on the kitchen island?");
    assert!(told.contains("plate is on the kitchen island"), "{told}");
    let told = Talk::new(&["plan House_Family Kitchen", "add Apple on Kitchen_Island"]).say("any fruit in here?");
    assert!(told.starts_with("= Yes, ") && told.contains("apple"), "{told}");
}

#[test]
fn what_lies_under_a_thing_is_not_what_stands_on_it() {
    let mut talk = Talk::new(CHILDREN);
    drop_on_floor(&mut talk, "Toy_Car");
    let asked = [
        ("is there anything under the bunk bed?", "= Yes, on the floor by the bunk bed there"),
        ("what is under the bunk bed?", "= On the floor by the bunk bed there"),
    ];
    answers(&mut talk, &asked);
    let told = talk.say("what is behind the bunk bed?");
    assert!(told.contains("toy car") && !told.contains("teddy"), "{told}");
}

#[test]
fn the_floor_is_no_floor_lamp() {
    let mut talk = Talk::new(KITCHEN);
    drop_on_floor(&mut talk, "Tomato");
    for (asked, begins) in
        [("what is on the floor?", "= On the floor"), ("is there anything on the floor?", "= Yes, on the")]
    {
        let told = talk.say(asked);
        assert!(told.starts_with(begins) && told.contains("tomato"), "{asked} {told}");
    }
    talk.say_and_do("pick up the tomato");
    let told = talk.say("what is on the floor?");
    assert!(told.contains("on the floor") || told.contains("On the floor"), "{told}");
    assert!(!told.contains("tomato"), "{told}");
}

#[test]
fn what_lies_on_the_floor_is_described_by_that() {
    for said in
        ["pick up the tomato on the floor", "take the tomato that lies on the floor", "get the tomato off the floor"]
    {
        let mut talk = Talk::new(KITCHEN);
        drop_on_floor(&mut talk, "Tomato");
        assert_eq!(talk.say(said), "take Tomato", "{said}");
    }
    let mut talk = Talk::new(KITCHEN);
    drop_on_floor(&mut talk, "Tomato");
    answers(&mut talk, &[("is there anything on the floor in here?", "= Yes, on the")]);
    let mut talk = Talk::new(KITCHEN);
    answers(&mut talk, &[("put the tomato on the floor", "? I cannot put things on the floor, only on or into")]);
    let steps = talk.say("yes please");
    assert!(steps.starts_with("take Tomato, put ") && !steps.contains("Lamp"), "{steps}");
}

#[test]
fn what_was_taken_from_the_floor_is_remembered_as_that() {
    let mut talk = Talk::new(KITCHEN);
    talk.say_and_do("put the tomato on the dining table");
    drop_on_floor(&mut talk, "Tomato");
    assert_eq!(talk.say_and_do("pick up the tomato"), "take Tomato");
    let asked = [
        ("where did you get it?", "= I took the tomato from the floor of the"),
        ("put it back", "! I took the tomato from the floor, and"),
    ];
    answers(&mut talk, &asked);
}

#[test]
fn rooms_are_those_of_the_home() {
    let mut talk = Talk::new(CHILDREN);
    let told = talk.say("which rooms are there in the house?");
    assert!(told.starts_with("= I am in the children's room. Besides, there are the hallway"), "{told}");
    let rooms =
        format!("= I know of {} rooms. I am in the children's room. Besides, there are ", talk.scene.rooms.len());
    for asked in
        ["how many rooms are there?", "How many rooms do you know?", "can you tell me how many rooms there are"]
    {
        let told = talk.say(asked);
        assert!(told.starts_with(&rooms) && told.contains("and the bathroom"), "{asked} {told}");
    }
    assert_eq!(talk.say("go to the break room"), "! There is no break room here.");
    assert_eq!(talk.say("bring the teddy to the break room"), "! There is no break room here.");
    let lost = talk.say("what is the meaning of it all?");
    assert!(!lost.contains("break room"), "{lost}");
}

#[test]
fn of_two_states_the_one_that_is_so_is_told() {
    let mut talk = Talk::new(KITCHEN);
    let asked = [
        ("is the fridge open or shut?", "= The fridge freezer is shut."),
        ("is the dinner plate on the kitchen island clean or dirty", "= The dinner plate is dirty."),
    ];
    answers(&mut talk, &asked);
    talk.say_and_do("open the fridge");
    let told = talk.say("where is the fridge, open or shut?");
    assert!(!told.contains("Yes") && !told.contains("No,"), "{told}");
    answers(&mut with_lights_in_the_kitchen_alone(), &[("is the light on or off now?", "= The light switch is off.")]);
}

#[test]
fn what_is_kept_somewhere_is_put_there() {
    means(KITCHEN, &["pick up the tomato", "keep it on the dining table"], "put Dining_Table");
}

#[test]
fn what_should_stay_so_is_made_so_and_nothing_is_forbidden() {
    means(KITCHEN, &["open the fridge", "it should stay closed"], "close Fridge_Freezer");
    means(KITCHEN, &["open the fridge", "the fridge should remain closed"], "close Fridge_Freezer");
    let mut talk = Talk::new(KITCHEN);
    talk.say_and_do("open the fridge");
    talk.say_and_do("close it");
    let told = talk.say("Did you close the fridge again? There are medicines inside, it should stay closed.");
    assert!(told.starts_with("= Yes") && !told.contains("will not"), "{told}");
    let grammar = talk.language.clone().without_rewriter();
    for said in ["it should stay there", "The tomato has to stay where it is, please."] {
        let found = grammar.understand(said, &talk.scene, &mut talk.context.clone());
        assert_eq!(found.reply(), "All right, I leave it as it is.", "{said}");
    }
}

#[test]
fn a_state_is_asked_for_where_it_is_said_to_be() {
    let mut talk = with_lights_in_the_kitchen_alone();
    let asked = [
        ("are there any lights on?", "= Yes: the light switch in the kitchen."),
        ("is the light on in the kitchen?", "= Yes, the light switch"),
        ("is the light on in the living room?", "= No, the light switch"),
        ("how many lights are on in the living room?", "= I know of no light"),
    ];
    answers(&mut talk, &asked);
}

#[test]
fn a_bare_machine_is_the_one_that_is_there() {
    let laundry = &["plan House_Family UtilityRoom"];
    means(laundry, &["open the washing machine", "shut the machine"], "close Washing_Machine");
}

#[test]
fn more_of_a_list_is_told_by_what_was_not_mentioned() {
    for asked in ["and which are the six further things you did not mention?", "which are the other six?"] {
        let mut talk = Talk::new(KITCHEN);
        let first = talk.say("what can you see?");
        let more = talk.say(asked);
        assert!(more.starts_with("= I see") && more != first, "{asked} {more}");
    }
}

#[test]
fn what_is_asked_of_several_is_asked_of_each_of_them_wherever_it_is() {
    let mut talk = with_lights_in_the_kitchen_alone();
    let on = "= No, the light switch in the kitchen is not off.";
    answers(&mut talk, &[("are all the lights off?", on), ("are the lights off?", on)]);
    let plates = [
        "plan House_Family Kitchen",
        "add Dinner_Plate on Kitchen_Sink_Double",
        "add Dinner_Plate on Kitchen_Island",
        "Dinner_Plate dirty",
    ];
    let asked = [
        ("is any plate dirty?", "= Yes: the"),
        ("is any plate clean?", "= Yes: the"),
        ("is any plate broken?", "= No, I"),
    ];
    answers(&mut Talk::new(&plates), &asked);
    let cups = [&plates[..3], &["add Teacup on Kitchen_Island", "Teacup dirty"]].concat();
    let they =
        [("how many plates are there?", "= I know of 3 plates."), ("are they clean?", "= Yes, they are all clean.")];
    answers(&mut Talk::new(&cups), &they);
}

#[test]
fn where_several_things_are_is_told_of_each_of_them() {
    let mut talk = Talk::new(KITCHEN);
    let grammar = talk.language.clone().without_rewriter();
    for asked in ["where are the tomato and the chef knife?", "where do we keep the tomato n the chef knife"] {
        let found = grammar.understand(asked, &talk.scene, &mut talk.context.clone());
        let told = found.reply();
        assert!(told.contains("tomato is on the") && told.contains("chef's knife is on the"), "{asked} {told}");
    }
    let told = talk.say("is there a tomato or a plate in the kitchen?");
    assert!(told.contains("tomato") && told.contains("plate"), "{told}");
}

#[test]
fn what_it_did_to_several_is_told_of_each_of_them() {
    let mut talk = Talk::new(KITCHEN);
    talk.say_and_do("put the tomato on the dining table");
    let both = "did you put the tomato and the chef knife on the dining table?";
    answers(&mut talk, &[(both, "= No, I left out the chef's knife")]);
    talk.say_and_do("put the chef knife on the dining table");
    answers(
        &mut talk,
        &[(both, "= Yes, I did: the tomato"), ("did you wash the tomato and the chef knife?", "= No, not")],
    );
    let mut talk = Talk::new(CHILDREN);
    talk.say_and_do("put the toy car away");
    answers(&mut talk, &[("did you put the toy car and the teddy away?", "= No, I left out the teddy bear")]);
}

#[test]
fn what_it_did_with_a_thing_is_all_that_it_did_with_it() {
    let mut talk = Talk::new(KITCHEN);
    talk.say_and_do("wash the plate");
    let told = talk.say("what did you do with the plate?");
    assert!(told.contains("picked up the dinner plate") && told.contains("washed it"), "{told}");
    let mut talk = Talk::new(LAUNDRY);
    talk.say_and_do("dry the shirt");
    let told = talk.say("what did you do with the shirt?");
    assert!(told.contains("put the shirt in the tumble dryer") && told.contains("turned on"), "{told}");
}

#[test]
fn which_of_them_are_switched_on_is_told() {
    let mut talk = with_lights_in_the_kitchen_alone();
    let on = "= The light switch in the kitchen.";
    answers(&mut talk, &[("which lights are on?", on), ("which lights are still on?", on)]);
    answers(&mut talk, &[("did you leave the lights on?", "= Yes: the light switch in the kitchen.")]);
}

#[test]
fn of_two_cupboards_the_other_one_is_opened_then() {
    for said in ["the other one", "no, the other cupboard", "not that one, the other one"] {
        let mut talk = Talk::new(KITCHEN);
        assert_eq!(talk.say_and_do("open the wall cupboard"), "open Wall_Cupboard");
        assert_eq!(talk.say(said), "open Wall_Cupboard", "{said}");
    }
}

#[test]
fn a_tap_is_closed_by_turning_it_off() {
    let mut talk = Talk::new(KITCHEN);
    assert_eq!(talk.say_and_do("open the tap"), "toggle Kitchen_Sink_Double");
    assert_eq!(talk.say_and_do("close the tap please"), "toggle Kitchen_Sink_Double");
}

#[test]
fn curtains_are_drawn_and_drawn_back() {
    const ROOM: &[&str] = &["plan Care_Room CareRoom"];
    for said in [
        "close the curtains in the care room",
        "draw the curtains in the care room",
        "pull the curtains in the care room",
        "shut the curtains in the care room",
        "pull the curtains shut in the care room",
        "close the blinds in the care room",
    ] {
        means(ROOM, &[said], "close Curtains");
    }
    let mut talk = Talk::new(ROOM);
    answers(&mut talk, &[("are the curtains in the care room open?", "= Yes")]);
    assert_eq!(talk.say_and_do("draw the curtains in the care room"), "close Curtains");
    answers(&mut talk, &[("are the curtains in the care room open?", "= No")]);
    for said in [
        "pull back the curtains in the care room",
        "draw back the curtains in the care room",
        "open the curtains in the care room, it's dark",
    ] {
        assert_eq!(talk.say_and_do(said), "open Curtains", "{said}");
        assert_eq!(talk.say_and_do("close the curtains in the care room"), "close Curtains");
    }
}

#[test]
fn who_draws_or_pulls_what_is_no_curtain_does_not_close_it() {
    let mut talk = Talk::new(KITCHEN);
    for said in ["draw the fridge", "pull the fridge", "draw a picture"] {
        assert!(!talk.say(said).starts_with("close"), "{said}");
    }
}

#[test]
fn whether_the_water_runs_is_asked_of_the_tap_and_of_no_glass_of_water() {
    let mut talk = Talk::new(&["plan House_Family Kitchen", "add Tumbler on Kitchen_Island", "Tumbler water"]);
    talk.say_and_do("turn on the tap");
    let on = [("is the water on?", "= Yes, the "), ("is the water still running?", "= Yes, the ")];
    answers(&mut talk, &on);
    talk.say_and_do("turn off the tap");
    for asked in ["is the water off now?", "is the water off?"] {
        let told = talk.say(asked);
        assert!(
            told.starts_with("= Yes, the ") && told.contains("sink") && !told.contains("tumbler"),
            "{asked} {told}"
        );
    }
    let told = talk.say("is the tumbler off?");
    assert_eq!(told, "= The tumbler cannot be switched on or off.");
}

/// In a room with a table lamp on a desk, where that lamp and the room's own light are on.
fn with_a_lamp_on_the_desk() -> Talk {
    let mut talk = Talk::new(&["plan House_Family ChildrensRoom"]);
    let is_light = |instance: &str| matches!(instance, "LightSwitch_01" | "Table_Lamp");
    for light in talk.scene.objects.iter_mut().filter(|one| one.room.id() == "ChildrensRoom" && is_light(&one.instance))
    {
        light.flags.set(cohabit_cdf::StateFlag::Toggled, true);
    }
    talk
}

#[test]
fn a_lamp_that_is_there_is_the_lamp_and_the_big_light_is_the_room_s() {
    let turned_off = [
        ("turn the lamp off", "toggle Table_Lamp"),
        ("switch off the lamp on the desk", "toggle Table_Lamp"),
        ("turn off the big light", "toggle LightSwitch_01"),
        ("turn off the main light", "toggle LightSwitch_01"),
        ("turn off the ceiling light", "toggle LightSwitch_01"),
        ("turn off the light", "toggle LightSwitch_01"),
    ];
    for (said, steps) in turned_off {
        let mut talk = with_a_lamp_on_the_desk();
        assert_eq!(talk.say_and_do(said), steps, "{said}");
    }
    let mut talk = with_a_lamp_on_the_desk();
    talk.say_and_do("turn off the big light");
    answers(
        &mut talk,
        &[("is the lamp on?", "= Yes, the table lamp"), ("is the big light on?", "= No, the light switch")],
    );
    assert_eq!(talk.say("open the wardrobe, and switch the lamp off"), "open Wardrobe, toggle Table_Lamp");
}

#[test]
fn furniture_is_called_by_the_last_word_of_its_name() {
    // Other racks, for wine and on shelves, have that word for their own: none of them is here.
    let flat = ["plan Flat_One_Bed LivingRoom"];
    means(&flat, &["go to the rack"], "go Shoe_Rack");
    means(&flat, &["put the remote control on the rack"], "take Remote_Control, put Shoe_Rack");
    // What is called so in full is meant before it.
    means(&["plan Flat_One_Bed LivingRoom", "add Wine_Rack on Coffee_Table"], &["go to the rack"], "go Wine_Rack");
}

#[test]
fn of_several_one_is_tall_or_little_beside_the_others() {
    // Lamps that are called so as much stand on tables.
    for room in ["LivingRoom", "Bedroom"] {
        means(&[format!("plan House_Family {room}").as_str()], &["go to the tall lamp"], "go Floor_Lamp");
    }
    means(&["plan House_Family DiningRoom"], &["go to the little table"], "go Coffee_Table");
}

#[test]
fn what_is_in_a_corner_or_on_a_wall_is_in_the_room() {
    for (said, wanted) in [
        ("go to the floor lamp in the corner", "go Floor_Lamp"),
        ("turn on the telly on the wall", "toggle Television"),
        ("pick up the remote control from the corner of the living room", "take Remote_Control"),
        ("go to the plant in the far corner", "go Houseplant_Tall"),
    ] {
        means(&["plan House_Family LivingRoom"], &[said], wanted);
    }
    // What has such a word in its name is a thing.
    means(&["plan House_Family Kitchen"], &["go to the wall cupboard"], "go Wall_Cupboard");
}

#[test]
fn a_thing_for_something_is_not_that() {
    let room = ["plan House_Family LivingRoom"];
    means(&room, &["pick up the thing for the television"], "take Remote_Control");
    means(&room, &["pick up the thing to change the channels"], "take Remote_Control");
    means(KITCHEN, &["go to the thing that boils the water"], "go Kettle");
}

#[test]
fn things_of_a_home_are_for_something() {
    let mut talk = Talk::new(&["plan House_Family LivingRoom"]);
    answers(
        &mut talk,
        &[
            ("what is the remote control for?", "= The remote control switches the television on and off"),
            ("what is the shoe rack for?", "= The shoe rack is where shoes are kept"),
        ],
    );
}

#[test]
fn milk_is_the_carton_of_it_rather_than_a_glass_that_has_some() {
    let marks = [
        "plan House_Family Kitchen",
        "add MilkCarton_01 on Kitchen_Island",
        "add Tumbler on Kitchen_Island",
        "Tumbler milk",
    ];
    means(&marks, &["put the milk on the dining table"], "take MilkCarton_01, put Dining_Table");
    means(
        &["plan House_Family Kitchen", "add Teapot on Kitchen_Island"],
        &["put the teapot in the teapot"],
        "! There is nothing in the teapot to pour.",
    );
}
