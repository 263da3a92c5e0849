//! Missions made up at random, of the twelve types of Alexa Arena's trajectory data set, each solved once by the expert
//! before anybody else plays it.

mod draft;

use cohabit_cdf::{Color, Layout, LayoutError, Property, RoomId};
use cohabit_language::Language;

use crate::{
    chance::Chance,
    generate::draft::{Draft, Wanted},
    meaning::Meaning,
    play::{Settings, play},
    simulated::expert,
    task::{Line, Task},
};

/// Drafts of one mission that are tried before its type is given up.
const MOST_DRAFTS: usize = 40;

/// Makes a draft of a mission; none where chance has chosen what does not go together.
type Drafting = fn(&mut Draft<'_>) -> Option<()>;

/// The types, by the names of the paper.
const TYPES: [(&str, Drafting); 12] = [
    ("breakObject", break_object),
    ("clean&deliver", clean),
    ("color&deliver", color),
    ("fill&deliver", fill),
    ("freeze&deliver", freeze),
    ("heat&deliver", heat),
    ("insertInDevice", insert),
    ("pickup&deliver", deliver),
    ("pourContainer", pour),
    ("repair&deliver", repair),
    ("scanObject", scan),
    ("toggleDevice", toggle),
];

/// Why no missions could be made.
#[derive(Debug, thiserror::Error)]
pub enum GenerateError {
    /// A floor plan cannot be had.
    #[error("make missions: {0}")]
    Layout(#[from] LayoutError),
    /// The expert solves none of a type.
    #[error("make missions: none of {MOST_DRAFTS} drafts of `{0}` with the seed {1} can be solved; try another seed")]
    Unsolved(&'static str, u64),
    /// The expert's session failed.
    #[error("make missions: {0}")]
    Play(#[from] cohabit_record::LogError),
}

/// So many missions, all types in turn, with the expert's plan as their script. The same seed makes the same missions.
///
/// # Errors
/// [`GenerateError`].
pub fn generate(count: usize, seed: u64, language: &Language) -> Result<Vec<Task>, GenerateError> {
    let layouts = Layout::builtin_ids().iter().map(|id| Layout::builtin(id)).collect::<Result<Vec<_>, _>>()?;
    (0..count).map(|number| one(number, seed, &layouts, language)).collect()
}

fn one(number: usize, seed: u64, layouts: &[Layout], language: &Language) -> Result<Task, GenerateError> {
    let (name, drafting) = TYPES[number % TYPES.len()];
    let mut chance = Chance::new(seed.wrapping_mul(1_000_003).wrapping_add(number as u64));
    for _ in 0..MOST_DRAFTS {
        let layout = &layouts[chance.below(layouts.len())];
        let mut draft = Draft::new(language.catalog(), layout, &mut chance);
        if drafting(&mut draft).is_none() {
            continue;
        }
        let (cdf, plan) = draft.finish(name);
        let task = |script: Vec<Line>| Task {
            id: format!("{name}-{number:04}"),
            family: Some(name.to_owned()),
            cdf: cdf.to_string(),
            preparation: Vec::new(),
            script,
        };
        let exact = plan.iter().map(|meaning| Line::utterance(&expert(meaning))).collect();
        if play(&task(exact), &Settings::expert(seed), language)?.success {
            return Ok(task(plan.into_iter().map(Line::Meant).collect()));
        }
    }
    Err(GenerateError::Unsolved(name, seed))
}

fn break_object(draft: &mut Draft<'_>) -> Option<()> {
    let object = draft.thing(Property::Breakable, &[])?;
    let hammer = draft.put("Hammer", &[])?;
    draft.go(&hammer);
    draft.want(Meaning::PickUp { object: hammer.instance.clone() });
    draft.go(&object);
    draft.want(Meaning::Break { object: object.instance.clone() });
    draft.goal(&object.instance, "isBroken=true");
    Some(())
}

fn clean(draft: &mut Draft<'_>) -> Option<()> {
    let object = draft.thing(Property::Dirtyable, &[("isDirty", "true")])?;
    draft.treat(&object, Meaning::Clean { object: object.instance.clone() }, "isDirty=false")
}

fn color(draft: &mut Draft<'_>) -> Option<()> {
    let object = draft.thing(Property::Pickupable, &[])?;
    let color = *draft.chance.pick(&[Color::Red, Color::Green, Color::Blue])?;
    draft.take(&object);
    draft.want(Meaning::Color { object: object.instance.clone(), color });
    draft.color_goal(&object.instance, color);
    draft.deliver(&object)
}

fn fill(draft: &mut Draft<'_>) -> Option<()> {
    let object = draft.one_of(&["Bowl_01", "CoffeeMug_Boss", "CoffeeMug_Yellow", "CoffeePot_01"])?;
    draft.treat(&object, Meaning::Fill { object: object.instance.clone() }, "isFilled=Water")
}

fn freeze(draft: &mut Draft<'_>) -> Option<()> {
    let object = draft.thing(Property::Chillable, &[])?;
    draft.treat(&object, Meaning::Cool { object: object.instance.clone() }, "isCold=true")
}

fn heat(draft: &mut Draft<'_>) -> Option<()> {
    let object = draft.thing(Property::Heatable, &[])?;
    draft.treat(&object, Meaning::Heat { object: object.instance.clone() }, "isHot=true")
}

fn insert(draft: &mut Draft<'_>) -> Option<()> {
    let device = draft.device(|class| class.receptacle.as_ref().is_some_and(|place| !place.keys.is_empty()))?;
    let keys = draft.class(&device)?.receptacle.as_ref()?.keys.clone();
    let key = draft.chance.pick(&keys)?.clone();
    let object = draft.put(&key, &[])?;
    draft.take(&object);
    draft.go(&device);
    draft.want(Meaning::Insert { object: object.instance.clone(), device: device.instance.clone() });
    draft.goal(&device.instance, &format!("Contains={}", object.instance));
    Some(())
}

fn deliver(draft: &mut Draft<'_>) -> Option<()> {
    let object = draft.thing(Property::Pickupable, &[])?;
    draft.take(&object);
    draft.deliver(&object)
}

fn pour(draft: &mut Draft<'_>) -> Option<()> {
    let fluid = *draft.chance.pick(&["Water", "Milk", "Coffee"])?;
    let from =
        if fluid == "Milk" { "MilkCarton_01" } else { *draft.chance.pick(&["CoffeePot_01", "CoffeeMug_Boss"])? };
    let from = draft.put(from, &[("isFilled", fluid)])?;
    let into = draft.one_of(&["Bowl_01", "CoffeeMug_Yellow"])?;
    draft.take(&from);
    draft.go(&into);
    draft.want(Meaning::Pour { from: from.instance.clone(), into: into.instance.clone() });
    draft.goal(&into.instance, &format!("isFilled={fluid}"));
    Some(())
}

fn repair(draft: &mut Draft<'_>) -> Option<()> {
    let object = draft.thing(Property::Breakable, &[("isBroken", "true")])?;
    draft.treat(&object, Meaning::Repair { object: object.instance.clone() }, "isBroken=false")
}

fn scan(draft: &mut Draft<'_>) -> Option<()> {
    let object: Wanted = if draft.chance.is(0.5) {
        draft.thing(Property::Pickupable, &[])?
    } else {
        draft.device(|class| class.has(Property::Usable) || class.has(Property::Powerable))?
    };
    draft.go(&object);
    draft.want(Meaning::Scan { object: object.instance.clone() });
    draft.goal(&object.instance, "isScanned=true");
    Some(())
}

fn toggle(draft: &mut Draft<'_>) -> Option<()> {
    let device = draft.device(|class| class.has(Property::Toggleable) && !class.has(Property::Pickupable))?;
    draft.go(&device);
    draft.want(Meaning::TurnOn { device: device.instance.clone() });
    draft.goal(&device.instance, "isToggledOn=true");
    Some(())
}

/// Where people leave and look for things: not in the way of every door.
const ROOMS: [RoomId; 7] = [
    RoomId::BreakRoom,
    RoomId::MainOffice,
    RoomId::SmallOffice,
    RoomId::Lab1,
    RoomId::Lab2,
    RoomId::Reception,
    RoomId::Warehouse,
];
