//! What a body sees, in words and as a picture.

use base64::{Engine as _, engine::general_purpose::STANDARD};
use cohabit_agent::Glance;
use cohabit_bus::message::{BodyRecord, Malformed, Plane, Thing};
use cohabit_cdf::{Catalog, Fluid, ObjectId, Property, StateFlag};
use cohabit_dialog::encode_jpeg;
use cohabit_language::{Known, KnownObject, within_half_turn};
use jpeg_encoder::EncodingError;

use crate::{limits::MOST_SEEN, things::Things};

/// What shows fewer pixels is overlooked, as agents do.
const LEAST_PIXELS: u32 = 12;
/// What is nearer to straight ahead than this is called so, degrees.
const AHEAD_DEG: f32 = 8.0;

/// States that are told of things, in words.
const STATES: [(StateFlag, &str); 16] = [
    (StateFlag::Opened, "open"),
    (StateFlag::Locked, "locked"),
    (StateFlag::Toggled, "switched on"),
    (StateFlag::Broken, "broken"),
    (StateFlag::Dirty, "dirty"),
    (StateFlag::Hot, "hot"),
    (StateFlag::Cold, "cold"),
    (StateFlag::Cooked, "cooked"),
    (StateFlag::Cut, "cut"),
    (StateFlag::Eaten, "eaten"),
    (StateFlag::Cereal, "with cereal in it"),
    (StateFlag::Infected, "infected"),
    (StateFlag::Embiggenated, "enlarged"),
    (StateFlag::Overloaded, "overloaded"),
    (StateFlag::Sparking, "throwing sparks"),
    (StateFlag::Scanned, "scanned"),
];

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
pub(crate) enum PictureError {
    /// A peer has spoilt the frame.
    #[error(transparent)]
    Malformed(#[from] Malformed),
    /// The camera delivers no colours.
    #[error("the camera delivers no colours")]
    NoColors,
    /// It cannot be encoded.
    #[error("the picture could not be encoded: {0}")]
    Encode(#[from] EncodingError),
}

/// Where a body is and what it holds, in a sentence.
pub(crate) fn place(catalog: &Catalog, scene: &Known) -> String {
    let robot = &scene.robot;
    let held = robot.held.map_or_else(|| "nothing".to_owned(), |held| in_hand(catalog, scene, held));
    let [x_m, y_m, _] = robot.position_m;
    let room = robot.room.name_in(catalog);
    format!("You are in the {room}, at x {x_m:.1} m, y {y_m:.1} m, and hold {held}.")
}

fn in_hand(catalog: &Catalog, scene: &Known, held: ObjectId) -> String {
    let name = scene.object(held).map_or("thing", |object| catalog.names(object.class).plain.as_str());
    format!("the {name} (number {})", held.0)
}

/// The things that a picture shows, each in a line, the nearest first.
pub(crate) fn things_in_sight(
    things: &Things,
    catalog: &Catalog,
    scene: &Known,
    bodies: &[BodyRecord],
    glance: &Glance,
) -> String {
    let in_sight = glance.things().filter(|seen| seen.pixels >= LEAST_PIXELS);
    let mut lines: Vec<(f32, String)> = in_sight
        .filter_map(|seen| match seen.thing {
            Thing::Object(id) => scene.object(id).map(|object| object_line(things, catalog, scene, object)),
            Thing::Body(id) => {
                let body = bodies.iter().find(|record| record.body == id.0)?;
                Some(body_line(scene, body))
            }
            Thing::Surface(_) | Thing::Nothing => None,
        })
        .collect();
    lines.sort_by(|(one, _), (other, _)| one.total_cmp(other));
    let rest = lines.len().saturating_sub(MOST_SEEN);
    let mut told: Vec<String> = lines.into_iter().take(MOST_SEEN).map(|(_, line)| line).collect();
    if told.is_empty() {
        return "There is nothing in sight but floor and walls.".to_owned();
    }
    if rest > 0 {
        told.push(format!("and {rest} more, farther away"));
    }
    format!("In sight:\n{}", told.join("\n"))
}

/// A thing with its distance, m.
fn object_line(things: &Things, catalog: &Catalog, scene: &Known, object: &KnownObject) -> (f32, String) {
    let (distance_m, place) = direction(scene, object.position_m);
    let name = things.name(object.id, scene);
    let states = states(catalog, object);
    let states = if states.is_empty() { String::new() } else { format!("; {}", states.join(", ")) };
    (distance_m, format!("{}: {name} [{}]; {place}{states}", object.id.0, object.instance))
}

fn body_line(scene: &Known, body: &BodyRecord) -> (f32, String) {
    let (distance_m, place) = direction(scene, body.position_m);
    let kind = body.kind().map_or("somebody", |kind| kind.name());
    (distance_m, format!("body {}, a {kind}; {place}", body.body))
}

/// How far a point is from the robot, m, and the same in words with the direction.
fn direction(scene: &Known, position_m: [f32; 3]) -> (f32, String) {
    let [dx, dy] = [0, 1].map(|axis| position_m[axis] - scene.robot.position_m[axis]);
    let distance_m = dx.hypot(dy);
    let off_deg = within_half_turn(dy.atan2(dx) - scene.robot.yaw_rad).to_degrees();
    let side = if off_deg.abs() < AHEAD_DEG {
        "straight ahead".to_owned()
    } else {
        format!("{:.0} degrees to the {}", off_deg.abs(), if off_deg > 0.0 { "left" } else { "right" })
    };
    (distance_m, format!("{distance_m:.1} m, {side}"))
}

/// The states of a thing that are worth telling.
fn states(catalog: &Catalog, object: &KnownObject) -> Vec<String> {
    let class = catalog.class(object.class);
    let mut told: Vec<String> =
        STATES.iter().filter(|(flag, _)| object.flags.has(*flag)).map(|(_, words)| (*words).to_owned()).collect();
    if class.has(Property::Openable) && !object.flags.has(StateFlag::Opened) {
        told.push("closed".to_owned());
    }
    if class.has(Property::Powerable) && !object.flags.has(StateFlag::Powered) {
        told.push("without power".to_owned());
    }
    if object.fluid != Fluid::None {
        told.push(format!("filled with {}", object.fluid.name().to_lowercase()));
    }
    if !object.text.is_empty() {
        told.push("with something written on it".to_owned());
    }
    told
}

/// The picture that a camera delivered: JPEG in base64.
///
/// # Errors
/// [`PictureError`].
pub(crate) fn picture(glance: &Glance) -> Result<String, PictureError> {
    let frame = glance.frame()?;
    let colors = frame.plane(Plane::Color).ok_or(PictureError::NoColors)?;
    // The pictures of a panorama stand one above the other.
    let size = [frame.header.width, frame.header.height * frame.header.views];
    let mut bytes = Vec::new();
    encode_jpeg(&mut bytes, size, colors)?;
    Ok(STANDARD.encode(bytes))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::scene::scene;

    #[test]
    fn a_thing_is_told_with_its_number_its_place_and_its_states() {
        let catalog = Arc::new(Catalog::builtin());
        let (things, mut scene) = (Things::new(&catalog), scene(&catalog));
        scene.objects[2].flags.set(StateFlag::Broken, true);
        scene.objects[2].fluid = Fluid::Milk;
        let line = |scene: &Known, at: usize| object_line(&things, &catalog, scene, &scene.objects[at]).1;
        let first = line(&scene, 0);
        let is_whole = first.starts_with("0: the ") && first.ends_with(" [CoffeeMug_Boss_1]; 1.0 m, straight ahead");
        assert!(is_whole, "{first}");
        let second = line(&scene, 1);
        assert!(second.ends_with("; 2.8 m, 45 degrees to the left"), "{second}");
        let third = line(&scene, 2);
        assert!(third.ends_with("; 3.0 m, 90 degrees to the right; broken, filled with milk"), "{third}");
    }

    #[test]
    fn a_body_is_told_where_it_is_and_what_it_holds() {
        let catalog = Catalog::builtin();
        let mut scene = scene(&catalog);
        let empty = place(&catalog, &scene);
        assert_eq!(empty, "You are in the break room, at x 0.0 m, y 0.0 m, and hold nothing.");
        scene.robot.held = Some(ObjectId(2));
        let full = place(&catalog, &scene);
        assert!(full.ends_with("and hold the bowl (number 2)."), "{full}");
    }
}
