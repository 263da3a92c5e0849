//! A simulated person: wants something done to an object, and says so in templates, vaguely and with slips.
//!
//! What people mean is drawn first, what they say after it. They mean the mission's things rather than the furniture,
//! what is near and in sight rather than what is not, and what was spoken of again. They describe it until nothing else
//! that they think of fits, but not always; and they misspeak and mistype.

use cohabit_cdf::{Catalog, ObjectId, Property, state::StateFlag};
use cohabit_language::{Known, KnownObject};

use crate::chance::Chance;

/// How people are.
#[derive(Clone, Copy)]
pub struct Habits {
    /// The share of utterances that are left ambiguous.
    pub vagueness: f32,
    /// The share with a typing slip.
    pub typos: f32,
    /// The share with a wrong attribute or a wrong name.
    pub mistakes: f32,
    /// The share about the mission's own things.
    pub about_mission: f32,
}

/// What is said of which objects.
struct Template {
    /// What the object must afford, all of it.
    affords: &'static [Property],
    /// The state in which it is mostly said.
    state: Option<(StateFlag, bool)>,
    of: Of,
    says: &'static [&'static str],
}

/// What it is mostly said of.
#[derive(Clone, Copy, PartialEq)]
enum Of {
    Any,
    /// Of what is not in the hand.
    Free,
    /// Of what is in the hand, if anything is.
    Held,
    /// Of what is not in sight.
    Unseen,
}

const fn template(
    of: Of,
    affords: &'static [Property],
    state: Option<(StateFlag, bool)>,
    says: &'static [&'static str],
) -> Template {
    Template { affords, state, of, says }
}

const TEMPLATES: &[Template] = &[
    template(
        Of::Free,
        &[Property::Pickupable],
        None,
        &["pick up {}", "grab {}", "take {}", "get {}", "can you fetch {}"],
    ),
    template(
        Of::Held,
        &[Property::Pickupable],
        None,
        &["bring {} to the break room", "put {} on the table", "heat {}", "put {} in the fridge"],
    ),
    template(
        Of::Any,
        &[Property::Toggleable],
        Some((StateFlag::Toggled, false)),
        &["turn on {}", "switch on {}", "start {}"],
    ),
    template(Of::Any, &[Property::Toggleable], Some((StateFlag::Toggled, true)), &["turn off {}", "switch off {}"]),
    template(Of::Any, &[Property::Openable], Some((StateFlag::Opened, false)), &["open {}", "open {} please"]),
    template(Of::Any, &[Property::Openable], Some((StateFlag::Opened, true)), &["close {}", "shut {}"]),
    template(Of::Any, &[Property::Breakable], Some((StateFlag::Broken, false)), &["break {}", "smash {}"]),
    template(Of::Held, &[Property::Dirtyable], Some((StateFlag::Dirty, true)), &["clean {}", "wash {}"]),
    template(Of::Held, &[Property::Fillable, Property::Pickupable], None, &["fill {}", "fill {} with water"]),
    template(Of::Free, &[], None, &["go to {}", "walk to {}", "go over to {}", "approach {}"]),
    template(Of::Unseen, &[], None, &["find {}", "look for {}"]),
    template(Of::Any, &[], None, &["scan {}", "show me {}"]),
];

/// The share of requests that make no sense of the object's state, or of where it is.
const SENSELESS: f32 = 0.15;

/// A wish in words: the object meant, and what is said.
pub fn wish(
    catalog: &Catalog,
    scene: &Known,
    recent: &[ObjectId],
    habits: Habits,
    chance: &mut Chance,
) -> (ObjectId, String) {
    let target = meant(catalog, scene, recent, habits, chance);
    let object = scene.object(target).expect("the target is in the scene");
    let fitting: Vec<&Template> =
        TEMPLATES.iter().filter(|template| template.fits(catalog, scene, object, chance)).collect();
    // Whatever a draw leaves, it can be shown.
    let fitting = if fitting.is_empty() { vec![&TEMPLATES[TEMPLATES.len() - 1]] } else { fitting };
    let says = chance.pick(&fitting).says;
    let template = *chance.pick(says);
    let said = refer(catalog, scene, object, habits, chance);
    let text = template.replace("{}", &said);
    (target, if chance.happens(habits.typos) { slip(&text, chance) } else { text })
}

impl Template {
    fn fits(&self, catalog: &Catalog, scene: &Known, object: &KnownObject, chance: &mut Chance) -> bool {
        let class = catalog.class(object.class);
        let is_so = self.state.is_none_or(|(flag, value)| object.flags.has(flag) == value);
        let is_held = scene.robot.held == Some(object.id);
        let is_there = match self.of {
            Of::Any => true,
            Of::Free => !is_held,
            Of::Held => is_held || scene.robot.held.is_none(),
            Of::Unseen => !object.visible && !is_held,
        };
        self.affords.iter().all(|property| class.has(*property)) && (is_so && is_there || chance.happens(SENSELESS))
    }
}

/// How much rather people speak of what the robot holds.
const HELD: f32 = 8.0;

fn distance_m(scene: &Known, object: &KnownObject) -> f32 {
    let [dx, dy] = [0, 1].map(|axis| object.position_m[axis] - scene.robot.position_m[axis]);
    dx.hypot(dy)
}

fn meant(catalog: &Catalog, scene: &Known, recent: &[ObjectId], habits: Habits, chance: &mut Chance) -> ObjectId {
    let about_mission = chance.happens(habits.about_mission);
    let weight = |object: &KnownObject| {
        let class = catalog.class(object.class);
        let is_decor = class.properties.is_empty();
        if object.in_mission != about_mission || is_decor && !object.in_mission {
            return 0.0;
        }
        let mut weight = (-distance_m(scene, object) / 8.0).exp();
        weight *= if object.room == scene.robot.room { 3.0 } else { 1.0 };
        weight *= if object.visible { 2.0 } else { 1.0 };
        weight *= match recent.iter().position(|id| *id == object.id) {
            Some(0) => 4.0,
            Some(1) => 2.5,
            Some(2) => 1.5,
            _ => 1.0,
        };
        let is_on_recent = object.parent.is_some_and(|parent| recent.first() == Some(&parent));
        weight *= if is_on_recent { 4.0 } else { 1.0 };
        weight * if scene.robot.held == Some(object.id) { HELD } else { 1.0 }
    };
    let weights: Vec<f32> = scene.objects.iter().map(weight).collect();
    scene.objects[chance.weighted(&weights)].id
}

fn color(catalog: &Catalog, object: &KnownObject) -> String {
    match object.color {
        cohabit_cdf::Color::Original => catalog.class(object.class).color.to_lowercase(),
        painted => painted.name().to_lowercase(),
    }
}

fn noun(catalog: &Catalog, object: &KnownObject, chance: &mut Chance) -> String {
    let class = catalog.class(object.class);
    let name = if class.name.is_empty() { class.id.clone() } else { class.name.to_lowercase() };
    if class.words.is_empty() || chance.happens(0.6) { name } else { chance.pick(&class.words).clone() }
}

/// A referring expression.
fn refer(catalog: &Catalog, scene: &Known, object: &KnownObject, habits: Habits, chance: &mut Chance) -> String {
    let errs = chance.happens(habits.mistakes);
    let named = if errs && chance.happens(0.4) { chance.pick(&scene.objects) } else { object };
    let mut noun = noun(catalog, named, chance);
    // What people think of when they speak: what is in the mission, and what is in the room.
    let is_thought_of = |other: &&KnownObject| {
        other.id != object.id
            && catalog.class(other.class).name == catalog.class(object.class).name
            && (other.in_mission || other.room == scene.robot.room)
    };
    let mut rivals: Vec<&KnownObject> = scene.objects.iter().filter(is_thought_of).collect();
    let is_vague = chance.happens(habits.vagueness);
    let mut place = String::new();
    let order = if chance.happens(0.6) { ["color", "place", "room"] } else { ["place", "room", "color"] };
    for attribute in order {
        let needed = !rivals.is_empty() && !is_vague;
        // Some say more than is needed.
        if !needed && !chance.happens(0.12) {
            continue;
        }
        match attribute {
            "color" => {
                let mut said = color(catalog, object);
                rivals.retain(|rival| color(catalog, rival) == said);
                if errs {
                    said = (*chance.pick(&["red", "blue", "green", "white"])).to_owned();
                }
                if !said.is_empty() && !noun.contains(&said) {
                    noun = format!("{said} {noun}");
                }
            }
            "place" => {
                let Some(parent) = object.parent.and_then(|parent| scene.object(parent)) else { continue };
                if !place.is_empty() {
                    continue;
                }
                rivals.retain(|rival| {
                    rival
                        .parent
                        .and_then(|parent| scene.object(parent))
                        .is_some_and(|other| other.class == parent.class)
                });
                let parent = if errs { chance.pick(&scene.objects) } else { parent };
                place = format!(" on the {}", catalog.class(parent.class).name.to_lowercase());
            }
            _ => {
                if !place.is_empty() {
                    continue;
                }
                rivals.retain(|rival| rival.room == object.room);
                let room = if errs { *chance.pick(&cohabit_cdf::RoomId::BUILTIN) } else { object.room };
                place = format!(" in the {}", room.name_in(catalog));
            }
        }
    }
    let article = if chance.happens(0.9) { "the" } else { "a" };
    let broken = object.flags.has(StateFlag::Broken) && chance.happens(0.4);
    let dirty = object.flags.has(StateFlag::Dirty) && chance.happens(0.4);
    let state = if broken {
        "broken "
    } else if dirty {
        "dirty "
    } else {
        ""
    };
    format!("{article} {state}{noun}{place}")
}

/// One slip of the fingers in a word of four letters or more: two letters swapped, one doubled, left out or wrong.
fn slip(text: &str, chance: &mut Chance) -> String {
    let mut words: Vec<String> = text.split(' ').map(str::to_owned).collect();
    let long: Vec<usize> = (0..words.len()).filter(|at| words[*at].len() > 3 && words[*at].is_ascii()).collect();
    if long.is_empty() {
        return text.to_owned();
    }
    let word = &mut words[*chance.pick(&long)];
    let mut letters: Vec<char> = word.chars().collect();
    let at = chance.within(1..letters.len() - 1);
    match chance.within(0..4) {
        0 => letters.swap(at, at + 1),
        1 => letters.insert(at, letters[at]),
        2 => drop(letters.remove(at)),
        _ => letters[at] = (b'a' + chance.within(0..26) as u8) as char,
    }
    *word = letters.into_iter().collect();
    words.join(" ")
}
