//! Answers are true: of everything that stands in the built-in floor plans, in states drawn at random, questions that want a yes or a
//! no get the right one, and conditions hold where they do.

use crate::support::Talk;
use cohabit_cdf::{Fluid, ObjectId, Property, state::StateFlag};
use cohabit_language::{Known, KnownObject, Understanding};

const ROOMS: [&str; 4] = [
    "plan OfficeLayout1 BreakRoom",
    "plan OfficeLayout2 MainOffice",
    "plan OfficeLayout3 Lab2",
    "plan OfficeLayout1B Reception",
];
const ADDED: [&str; 12] = [
    "CoffeeMug_Yellow",
    "Bowl_01",
    "FoodPlate_01",
    "Trophy01",
    "Radio_01",
    "Donut_01",
    "Apple",
    "MilkCarton_01",
    "Hammer",
    "CoffeePot_01",
    "ActionFigure",
    "Banana_01",
];

/// Numbers that look random and are the same every time.
struct Draws(u64);

impl Draws {
    fn next(&mut self, below: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % below
    }
}

/// What can be claimed of a thing, in words, and whether it is so.
fn claims(talk: &Talk, object: &KnownObject) -> Vec<(String, bool)> {
    let class = talk.language.catalog().class(object.class);
    let mut claims = Vec::new();
    let mut may = |property: Property, flag: StateFlag, yes: &str, no: &str| {
        if class.has(property) {
            claims.push((yes.to_owned(), object.flags.has(flag)));
            if !no.is_empty() {
                claims.push((no.to_owned(), !object.flags.has(flag)));
            }
        }
    };
    may(Property::Openable, StateFlag::Opened, "open", "closed");
    may(Property::Toggleable, StateFlag::Toggled, "on", "off");
    may(Property::Toggleable, StateFlag::Toggled, "turned on", "switched off");
    may(Property::Breakable, StateFlag::Broken, "broken", "intact");
    may(Property::Dirtyable, StateFlag::Dirty, "dirty", "clean");
    may(Property::Heatable, StateFlag::Hot, "hot", "");
    if class.has(Property::Fillable) && class.has(Property::Pickupable) {
        claims.push(("empty".to_owned(), object.fluid == Fluid::None));
        claims.push(("full".to_owned(), object.fluid != Fluid::None));
        claims.push(("full of coffee".to_owned(), object.fluid == Fluid::Coffee));
    }
    claims
}

/// The things that one name alone is for, with that name.
fn named(talk: &Talk) -> Vec<(ObjectId, String)> {
    let catalog = talk.language.catalog();
    let plain = |object: &KnownObject| catalog.names(object.class).plain.clone();
    // `control panel` and `machine panel` may both be called the panel.
    let last = |object: &KnownObject| plain(object).rsplit(' ').next().unwrap().to_owned();
    let is_alone =
        |object: &&KnownObject| talk.scene.objects.iter().filter(|other| last(other) == last(object)).count() == 1;
    talk.scene.objects.iter().filter(is_alone).map(|object| (object.id, plain(object))).collect()
}

fn disturbed(scene: &mut Known, talk: &Talk, draws: &mut Draws) {
    const FLAGS: [(StateFlag, Property); 5] = [
        (StateFlag::Opened, Property::Openable),
        (StateFlag::Toggled, Property::Toggleable),
        (StateFlag::Broken, Property::Breakable),
        (StateFlag::Dirty, Property::Dirtyable),
        (StateFlag::Hot, Property::Heatable),
    ];
    for object in &mut scene.objects {
        let class = talk.language.catalog().class(object.class);
        object.visible = true;
        for (flag, property) in FLAGS {
            if class.has(property) {
                object.flags.set(flag, draws.next(2) == 1);
            }
        }
        if class.has(Property::Fillable) && class.has(Property::Pickupable) {
            object.fluid = [Fluid::None, Fluid::Coffee, Fluid::Water][draws.next(3) as usize];
        }
    }
}

fn answer(talk: &Talk, said: &str) -> Understanding {
    let language = talk.language.clone().without_rewriter();
    language.understand(said, &talk.scene, &mut cohabit_language::Context::default())
}

/// A room with things of missions on what carries them.
fn talk(room: &str, draws: &mut Draws) -> Talk {
    let empty = Talk::new(&[room]);
    let catalog = empty.language.catalog();
    let carries = |object: &&KnownObject| {
        let class = catalog.class(object.class);
        object.visible
            && class.has(Property::Receptacle)
            && class.receptacle.as_ref().is_some_and(|one| one.keys.is_empty())
    };
    let places: Vec<String> = empty.scene.objects.iter().filter(carries).map(|one| one.instance.clone()).collect();
    let marks: Vec<String> = std::iter::once(room.to_owned())
        .chain(ADDED.iter().map(|class| format!("add {class} on {}", places[draws.next(places.len() as u64) as usize])))
        .collect();
    let mut talk = Talk::new(&marks.iter().map(String::as_str).collect::<Vec<_>>());
    let mut scene = talk.scene.clone();
    disturbed(&mut scene, &talk, draws);
    talk.scene = scene;
    talk
}

/// Has `check` ask in all rooms about every claim of every thing with a name of its own: the name, the verb after it, the claim, and
/// whether it is so. How often it asked, and what was wrong.
fn of_all_claims(
    seed: u64,
    check: impl Fn(&Talk, &str, &str, &str, bool) -> Vec<Result<(), String>>,
) -> (usize, Vec<String>) {
    let mut draws = Draws(seed);
    let mut found = Vec::new();
    for room in ROOMS {
        let talk = talk(room, &mut draws);
        for (id, name) in named(&talk) {
            let be = if name.ends_with('s') && !name.ends_with("ss") { "are" } else { "is" };
            for (claim, is_so) in claims(&talk, talk.scene.object(id).unwrap()) {
                found.extend(check(&talk, &name, be, &claim, is_so));
            }
        }
    }
    (found.len(), found.into_iter().filter_map(Result::err).collect())
}

fn holds(understanding: &Understanding) -> Option<bool> {
    if let Understanding::Answer { holds, .. } = understanding { *holds } else { None }
}

#[test]
fn what_is_asked_of_a_state_is_answered_truly() {
    let (asked, wrong) = of_all_claims(1, |talk, name, be, claim, is_so| {
        let begins = if is_so { "Yes" } else { "No" };
        let check = |said: String| {
            let found = answer(talk, &said);
            let is_right = holds(&found) == Some(is_so) && found.reply().starts_with(begins);
            is_right.then_some(()).ok_or_else(|| format!("{said} wanted {begins}, found {}", found.reply()))
        };
        [format!("{be} the {name} {claim}?"), format!("tell me whether the {name} {be} {claim}")].map(check).into()
    });
    assert!(asked > 500, "only {asked} questions");
    assert!(wrong.is_empty(), "{} of {asked} wrong:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn conditions_hold_where_they_do() {
    let (asked, wrong) = of_all_claims(2, |talk, name, be, claim, is_so| {
        let check = |(said, goes): (String, bool)| {
            let found = answer(talk, &said);
            let is_right = matches!(found, Understanding::Plan { .. }) == goes
                && !matches!(found, Understanding::Question { .. } | Understanding::Refusal { .. });
            let not = if goes { "" } else { "not " };
            is_right.then_some(()).ok_or_else(|| format!("{said} should {not}go: {}", found.reply()))
        };
        let cases = [
            (format!("if the {name} {be} {claim}, go to the warehouse"), is_so),
            (format!("if the {name} {be} not {claim}, go to the warehouse"), !is_so),
            (format!("unless the {name} {be} {claim}, go to the warehouse"), !is_so),
            (format!("go to the warehouse if the {name} {be} {claim}"), is_so),
        ];
        cases.map(check).into()
    });
    assert!(asked > 1000, "only {asked} conditions");
    assert!(wrong.is_empty(), "{} of {asked} wrong:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn where_things_are_is_answered_truly() {
    let mut draws = Draws(3);
    let (mut asked, mut wrong) = (0, Vec::new());
    for room in ROOMS {
        let talk = talk(room, &mut draws);
        let named = named(&talk);
        for (id, name) in &named {
            let Some(parent) = talk.scene.object(*id).unwrap().parent else { continue };
            let (places, others): (Vec<_>, Vec<_>) = named.iter().partition(|(other, _)| *other == parent);
            let Some((_, place)) = places.first() else { continue };
            let is_place = |(other, _): &&&(ObjectId, String)| {
                other != id
                    && talk.language.catalog().class(talk.scene.object(*other).unwrap().class).receptacle.is_some()
            };
            let other = others.iter().filter(is_place).map(|(_, name)| name).nth(draws.next(3) as usize);
            let cases = [(Some(place), true), (other, false)];
            for (place, expected) in cases.into_iter().filter_map(|(place, expected)| Some((place?, expected))) {
                for said in [format!("is the {name} on the {place}?"), format!("is there a {name} in the {place}?")] {
                    asked += 1;
                    let found = answer(&talk, &said);
                    if holds(&found) != Some(expected) {
                        wrong.push(format!("{said} wanted {expected}, found {}", found.reply()));
                    }
                }
            }
            asked += 1;
            let said = format!("what is on the {place}?");
            let found = answer(&talk, &said);
            if !found.reply().contains(name.as_str()) && !found.reply().contains("more") {
                wrong.push(format!("{said} should name the {name}: {}", found.reply()));
            }
        }
    }
    assert!(asked > 50, "only {asked} questions");
    assert!(wrong.is_empty(), "{} of {asked} wrong:\n{}", wrong.len(), wrong.join("\n"));
}
