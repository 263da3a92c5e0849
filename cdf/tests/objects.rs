//! Every class of the catalogue has what its properties demand; ids, names and properties agree with the reference.

#![allow(clippy::unwrap_used)]

mod support;

use std::{collections::BTreeSet, fs, sync::LazyLock};

use cohabit_cdf::{
    Catalog, ClassId, Layout, Model, ObjectClass, Property,
    catalog::{Receptacle, Stands, Surface},
    layout::Placement,
    model::{Drive, When},
};

static CATALOG: LazyLock<Catalog> = LazyLock::new(Catalog::builtin);

/// Classes that a catalogue of this format has.
const CLASSES: usize = 336;

/// What a robot lifts with one hand, kg.
const LIFTED_KG: f32 = 8.0;

/// The longest thing that a hand can carry through a door, m.
const CARRIED_M: f32 = 1.2;

/// How far data may be off, m.
const SLACK_M: f32 = 0.011;

/// Collects what `wrong` says of each class, and fails with all of it.
#[track_caller]
fn check(wrong: impl Fn(&ObjectClass, &Model) -> Vec<String>) {
    let mut said = Vec::new();
    for (index, class) in CATALOG.classes().iter().enumerate() {
        let model = CATALOG.model(ClassId(u16::try_from(index).unwrap()));
        said.extend(wrong(class, model).into_iter().map(|wrong| format!("{}: {wrong}", class.id)));
    }
    assert!(said.is_empty(), "{}", said.join("\n"));
}

fn unless(holds: bool, wrong: &str) -> Vec<String> {
    if holds { Vec::new() } else { vec![wrong.to_owned()] }
}

/// Whether some part is drawn in that state alone.
fn shows(model: &Model, when: &[When]) -> bool {
    model.parts.iter().any(|part| part.when.is_some_and(|state| when.contains(&state)))
}

/// Whether some part is moved by that drive.
fn moves(model: &Model, drive: Drive) -> bool {
    let driven = |id: &str| model.joints.iter().any(|joint| joint.id == id && joint.driven_by == drive);
    model.parts.iter().any(|part| part.joint.as_deref().is_some_and(driven))
}

/// Fields of a line of the reference: some names are in quotes and have commas.
fn fields(line: &str) -> Vec<String> {
    let mut fields = vec![String::new()];
    let mut quoted = false;
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(String::new()),
            c => fields.last_mut().unwrap().push(c),
        }
    }
    fields
}

#[test]
#[cfg_attr(not(reference_data), ignore = "needs the reference data in ../shared/arena")]
fn ids_names_and_properties_agree_with_the_reference() {
    let text = fs::read_to_string(support::arena().join("objects.csv")).unwrap();
    let mut wrong = Vec::new();
    let mut ids = BTreeSet::new();
    for line in text.lines().skip(1).filter(|line| !line.trim().is_empty()) {
        let fields = fields(line.trim());
        let [id, name, properties] = fields.as_slice() else { panic!("{line}") };
        ids.insert(id.clone());
        let Some(class) = CATALOG.find(id).map(|class| CATALOG.class(class)) else {
            wrong.push(format!("{id} is missing"));
            continue;
        };
        let expected: BTreeSet<_> = properties.split('|').filter(|name| !name.is_empty()).map(str::to_owned).collect();
        let found: BTreeSet<_> = class.properties.iter().map(|name| format!("{name:?}").to_uppercase()).collect();
        // The reference leaves a few names blank.
        if !name.is_empty() && class.name != *name {
            wrong.push(format!("{id} is called `{}`, not `{name}`", class.name));
        }
        if expected != found {
            wrong.push(format!("{id} is {found:?}, not {expected:?}"));
        }
    }
    wrong.extend(
        CATALOG
            .classes()
            .iter()
            .filter(|class| !ids.contains(&class.id))
            .map(|class| format!("{} is too many", class.id)),
    );
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_class_is_described() {
    assert_eq!(CATALOG.classes().len(), CLASSES);
    check(|class, model| {
        let plain = |text: &str| !text.trim().is_empty() && text.trim() == text && text.to_lowercase() == text;
        let words: BTreeSet<_> = class.words.iter().collect();
        let properties: BTreeSet<_> = class.properties.iter().map(|property| format!("{property:?}")).collect();
        [
            unless(!class.name.trim().is_empty(), "it has no name"),
            unless(
                !class.words.is_empty() && class.words.iter().all(|word| plain(word)),
                "its words are not lower case",
            ),
            unless(words.len() == class.words.len(), "a word is there twice"),
            unless(properties.len() == class.properties.len(), "a property is there twice"),
            unless(class.size_m.iter().all(|side| (0.001..=6.0).contains(side)), "its size is not one of an object"),
            unless((0.001..=2000.0).contains(&class.mass_kg), "its mass is not one of an object"),
            unless(plain(&class.color), "its colour is no plain word"),
            unless(class.tint.as_deref().is_none_or(is_color), "its tint is no #rrggbb"),
            unless(!model.parts.is_empty(), "its model has no parts"),
        ]
        .concat()
    });
}

fn is_color(text: &str) -> bool {
    text.strip_prefix('#').is_some_and(|hex| hex.len() == 6 && hex.chars().all(|c| c.is_ascii_hexdigit()))
}

#[test]
fn models_are_whole() {
    check(|_, model| {
        let joints: BTreeSet<_> = model.joints.iter().map(|joint| joint.id.as_str()).collect();
        let mut wrong = unless(joints.len() == model.joints.len(), "two joints have one id");
        for part in &model.parts {
            let known = part.joint.as_deref().is_none_or(|joint| joints.contains(joint));
            wrong.extend(unless(known, "a part names a joint that is not there"));
            let words = ["tint", "fluid"];
            wrong.extend(unless(is_color(&part.color) || words.contains(&part.color.as_str()), "a part has no colour"));
        }
        for joint in &model.joints {
            let length: f32 = joint.axis.iter().map(|along| along * along).sum();
            wrong.extend(unless(length > 0.5, "a joint has no axis"));
            wrong.extend(unless(joint.turn_deg != 0.0 || joint.slide_m != 0.0, "a joint moves nothing"));
            let used = model.parts.iter().any(|part| part.joint.as_ref() == Some(&joint.id));
            wrong.extend(unless(used, "no part is at a joint"));
        }
        wrong
    });
}

/// What is wrong with a place in an object.
fn surface(class: &ObjectClass, receptacle: &Receptacle, surface: &Surface) -> Vec<String> {
    let inside =
        |axis: usize| surface.center_m[axis].abs() + surface.size_m[axis] / 2.0 <= class.size_m[axis] / 2.0 + SLACK_M;
    let [_, _, height] = class.size_m;
    let z = surface.center_m[2];
    let below_top = !receptacle.enclosed || z + surface.clearance_m <= height + SLACK_M;
    [
        unless(surface.anchors[0] * surface.anchors[1] > 0, "a surface has no anchors"),
        unless(surface.size_m.iter().all(|side| *side >= 0.0), "a surface has no size"),
        unless(inside(0) && inside(1), &format!("a surface at z = {z} sticks out of its box")),
        unless((-SLACK_M..=height + SLACK_M).contains(&z), &format!("a surface at z = {z} is outside its box")),
        unless(surface.clearance_m > 0.0, "a surface has no room above it"),
        unless(below_top, &format!("the room above a surface at z = {z} reaches out of its lid")),
    ]
    .concat()
}

#[test]
fn receptacles_have_anchors_in_their_boxes() {
    check(|class, _| {
        let Some(receptacle) = &class.receptacle else {
            return unless(!class.has(Property::Receptacle), "it is a receptacle without anchors");
        };
        let mut wrong: Vec<_> =
            receptacle.surfaces.iter().flat_map(|place| surface(class, receptacle, place)).collect();
        wrong.extend(unless(!receptacle.surfaces.is_empty(), "it has no surfaces"));
        let classes = receptacle.keys.iter().chain(&receptacle.refuses);
        wrong.extend(classes.filter(|id| CATALOG.find(id).is_none()).map(|id| format!("it names `{id}`")));
        let enclosed = receptacle.enclosed && !class.has(Property::Openable);
        wrong.extend(unless(!enclosed || !class.has(Property::Pickupable), "what is in it is never reached"));
        wrong
    });
}

#[test]
fn keys_fit_into_what_they_are_for() {
    check(|class, _| {
        let Some(receptacle) = &class.receptacle else { return Vec::new() };
        let clearance = receptacle.surfaces.iter().map(|surface| surface.clearance_m).fold(0.0, f32::max);
        let keys = receptacle.keys.iter().filter_map(|id| CATALOG.find(id)).map(|id| CATALOG.class(id));
        keys.filter(|key| !key.has(Property::Pickupable) || key.size_m[2] > clearance + SLACK_M)
            .map(|key| format!("its key {} is no thing that fits", key.id))
            .collect()
    });
}

#[test]
fn what_is_picked_up_fits_a_hand() {
    check(|class, _| {
        if !class.has(Property::Pickupable) {
            return Vec::new();
        }
        let longest = class.size_m.iter().copied().fold(0.0, f32::max);
        [
            unless(class.mass_kg <= LIFTED_KG, &format!("{} kg are too heavy", class.mass_kg)),
            unless(longest <= CARRIED_M, &format!("{longest} m are too long")),
            unless(class.stands == Stands::OnSurface, "it is fixed to a wall, or stands on the floor"),
        ]
        .concat()
    });
}

/// Filled things into which nobody looks.
const SEALED: [&str; 2] = ["CoffeeBeans_01", "MilkCarton_01"];

/// Whether something of a class shows whether it is on; a fuse box shows it by the lever that it takes.
fn shows_on(class: &ObjectClass, model: &Model) -> bool {
    let keys = class.receptacle.iter().flat_map(|receptacle| &receptacle.keys).filter_map(|id| CATALOG.find(id));
    let shown = |model: &Model| shows(model, &[When::On, When::Off]) || moves(model, Drive::On);
    shown(model)
        || keys.filter(|key| CATALOG.class(*key).has(Property::Toggleable)).any(|key| shown(CATALOG.model(key)))
}

/// What of a model must show or move, for an object to have a property.
#[test]
fn properties_can_be_seen() {
    check(|class, model| {
        let demand = |property: Property, holds: bool, wrong: &str| {
            if class.has(property) { unless(holds, wrong) } else { Vec::new() }
        };
        let on = shows_on(class, model);
        let filled = shows(model, &[When::Filled]) || SEALED.contains(&class.id.as_str());
        [
            demand(Property::Openable, moves(model, Drive::Open), "nothing moves as it opens"),
            demand(Property::Toggleable, on, "nothing shows whether it is on"),
            demand(Property::Breakable, shows(model, &[When::Broken, When::Whole]), "nothing shows that it is broken"),
            demand(Property::Dirtyable, shows(model, &[When::Dirty]), "nothing shows that it is dirty"),
            demand(Property::Fillable, filled, "nothing shows what fills it"),
            demand(Property::Eatable, shows(model, &[When::Eaten, When::Uneaten]), "nothing shows that it is eaten"),
            demand(Property::Cookable, shows(model, &[When::Cooked, When::Raw]), "nothing shows that it is cooked"),
            demand(Property::Infectable, shows(model, &[When::Infected]), "nothing shows that it is infected"),
        ]
        .concat()
    });
}

#[test]
fn what_decorates_does_nothing_else() {
    check(|class, _| {
        let only = class.properties.len() == 1;
        unless(!class.has(Property::Decor) || only, "decoration has another property")
    });
}

#[test]
fn handles_are_at_their_objects() {
    check(|class, _| {
        let Some([x, y, z]) = class.handle_m else { return Vec::new() };
        let near = |at: f32, side: f32| at.abs() <= side / 2.0 + 0.1;
        let holds = near(x, class.size_m[0]) && near(y, class.size_m[1]) && (-0.1..=class.size_m[2] + 0.1).contains(&z);
        unless(holds, "its handle is elsewhere")
    });
}

/// Layouts put things where their classes are found: on walls, floors or surfaces.
#[test]
fn spawn_rules_agree_with_the_floor_plans() {
    for id in Layout::builtin_ids() {
        let layout = Layout::builtin(&id).unwrap();
        for placement in &layout.placements {
            let class = CATALOG.class_of_instance(&placement.instance);
            assert!(class.is_some(), "{id}: {} has no class", placement.instance);
            let class = CATALOG.class(class.unwrap());
            let above = |below: &Placement| {
                let [dx, dy] = [0, 1].map(|axis| (below.at_m[axis] - placement.at_m[axis]).abs());
                below.on.is_none() && below.at_m[2] < placement.at_m[2] && dx < 0.3 && dy < 0.3
            };
            let floats = class.stands == Stands::OnFloor && placement.on.is_none() && placement.at_m[2] > 0.05;
            let stands = !floats || layout.placements.iter().any(above);
            assert!(stands, "{id}: {} stands in the air", placement.instance);
        }
    }
}
