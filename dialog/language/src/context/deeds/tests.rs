use super::*;

fn step(action: Action, says: &str) -> Step {
    Step { action, says: says.to_owned() }
}

#[test]
fn what_was_done_for_the_last_request_is_told() {
    let (fridge, milk) = (ObjectId(1), ObjectId(2));
    let mut deeds = Deeds::default();
    assert_eq!(deeds.told(), None);
    deeds.add(&step(Action::Interact { verb: Verb::Open, object: ObjectId(9) }, "opening the door"), "open the door");
    deeds.add(&step(Action::Interact { verb: Verb::Open, object: fridge }, "opening the fridge"), "get the milk");
    deeds.add(&step(Action::LookAround, "looking around"), "get the milk");
    deeds.add(&step(Action::PickUp { object: milk }, "picking up the milk"), "get the milk");
    deeds.credit(["Take the milk."].into_iter());
    deeds.credit(["Take the milk."].into_iter());
    let told = "I opened the fridge and picked up the milk. Before that I opened the door";
    assert_eq!(deeds.told().as_deref(), Some(told));
    let why = "I picked up the milk, since get the milk. The mission wanted it: Take the milk";
    assert_eq!(deeds.why(Some(Intent::PickUp), Some(milk), None).as_deref(), Some(why));
    assert_eq!(deeds.why(Some(Intent::Pour), None, None), None);
    assert!(deeds.did(Intent::PickUp, milk));
    assert!(!deeds.did(Intent::Place, milk));
    assert!(deeds.did(Intent::GoTo, fridge), "who opened it was there");
    assert_eq!(deeds.to(fridge).map(|deed| deed.reason.as_str()), Some("get the milk"));
}

#[test]
fn all_that_was_done_is_told_in_its_order_and_by_name() {
    let (tap, tumbler, table, blanket) = (ObjectId(1), ObjectId(2), ObjectId(3), ObjectId(4));
    let toggle = Action::Interact { verb: Verb::Toggle, object: tap };
    let mut deeds = Deeds::default();
    deeds.add(&step(Action::PickUp { object: tumbler }, "picking up the tumbler"), "fill the tumbler");
    deeds.add(&step(toggle, "turning on the tap"), "fill the tumbler");
    let fill = Action::Interact { verb: Verb::Fill, object: tap };
    deeds.add(&step(fill, "filling it at the tap"), "fill the tumbler");
    let few = "So far I picked up the tumbler, turned on the tap and filled it at the tap";
    assert_eq!(deeds.all_told().as_deref(), Some(few));
    deeds.add(&step(toggle, "turning off the tap"), "fill the tumbler");
    deeds.add(&step(Action::Place { receptacle: table }, "putting the tumbler on the table"), "put it down");
    deeds.add(&step(Action::PickUp { object: blanket }, "picking up the blanket"), "fetch the blanket");
    deeds.add(&step(Action::Place { receptacle: table }, "putting the blanket on the table"), "fetch the blanket");
    let open = Action::Interact { verb: Verb::Open, object: ObjectId(5) };
    deeds.add(&step(open, "opening the door"), "open the door");
    deeds.add(&step(Action::PickUp { object: tumbler }, "picking up the tumbler"), "take the tumbler");
    let much = "So far I filled the tumbler at the tap, put the tumbler on the table, put the blanket on the table, \
                opened the door and picked up the tumbler";
    assert_eq!(deeds.all_told().as_deref(), Some(much));
}

#[test]
fn what_was_done_for_what_was_never_finished_is_told() {
    let (mug, counter, fridge) = (ObjectId(1), ObjectId(2), ObjectId(3));
    let open = |object| Action::Interact { verb: Verb::Open, object };
    let mut deeds = Deeds::default();
    deeds.add(&step(Action::PickUp { object: mug }, "picking up the mug"), "wash the mug");
    deeds.add(&step(open(fridge), "opening the fridge"), "wash the mug");
    deeds.cut_short("wash the mug");
    deeds.add(&step(Action::Place { receptacle: counter }, "putting the mug on the counter"), "put it down");
    let open_more = |deeds: &mut Deeds, number| {
        deeds.add(&step(open(ObjectId(number)), &format!("opening cupboard {number}")), "open them");
    };
    (10..17).for_each(|number| open_more(&mut deeds, number));
    let told = deeds.all_told().unwrap_or_default();
    let begin = "So far I picked up the mug, opened the fridge, put the mug on the counter, opened cupboard 10";
    assert!(told.starts_with(begin), "{told}");
    (17..22).for_each(|number| open_more(&mut deeds, number));
    let much = "So far I picked up the mug, opened the fridge, put the mug on the counter and opened cupboard 21";
    assert_eq!(deeds.all_told().as_deref(), Some(much));
}

#[test]
fn what_was_in_the_hand_is_named_where_nothing_told_before_names_it() {
    let tap = ObjectId(1);
    let mut deeds = Deeds::default();
    let fill = Action::Interact { verb: Verb::Fill, object: tap };
    deeds.add(&step(Action::PickUp { object: ObjectId(2) }, "picking up the tumbler"), "take the tumbler");
    deeds.add(&step(fill, "filling it at the tap"), "fill it");
    deeds.add(&step(Action::GoTo { target: GoToTarget::Object(tap) }, "going to the tap"), "go to the tap");
    let told = "I went to the tap. Before that I picked up the tumbler and filled it at the tap";
    assert_eq!(deeds.told().as_deref(), Some(told));
    let mut deeds = Deeds::default();
    deeds.add(&step(fill, "filling it at the tap"), "fill it");
    assert_eq!(deeds.told().as_deref(), Some("I filled what I held at the tap"));
}

#[test]
fn only_so_much_is_remembered() {
    let mut deeds = Deeds::default();
    for number in 0..200 {
        deeds.add(&step(Action::PickUp { object: ObjectId(number) }, "picking it up"), "");
    }
    assert_eq!(deeds.0.len(), MEMORY);
}
