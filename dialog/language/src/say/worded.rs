//! What the robot says while it does a single action, in the words of its own plans.

use cohabit_cdf::{Action, Catalog, GoToTarget, ObjectId, Verb};

use crate::known::{Known, describe};

/// `picking up the milk`; nothing of a stop, which is not told.
pub(crate) fn says(catalog: &Catalog, scene: &Known, action: &Action) -> String {
    let the = |object: ObjectId| describe::short(catalog, scene, object);
    let held = || scene.robot.held.map_or_else(|| "it".to_owned(), &the);
    match *action {
        Action::Move { distance_m } => {
            let (way, meters) = (if distance_m < 0.0 { "back" } else { "forward" }, distance_m.abs());
            let unit = if (meters - 1.0).abs() < 1e-3 { "meter" } else { "meters" };
            format!("moving {way} {meters} {unit}")
        }
        Action::Rotate { yaw_rad } => format!("turning {}", if yaw_rad > 0.0 { "left" } else { "right" }),
        Action::Look { pitch_rad } => format!("looking {}", if pitch_rad > 0.0 { "up" } else { "down" }),
        Action::LookAround => "looking around".to_owned(),
        Action::GoTo { target: GoToTarget::Object(object) } => format!("going to {}", the(object)),
        Action::GoTo { target: GoToTarget::Room(room) } => format!("going to the {}", room.name_in(catalog)),
        Action::GoTo { target: GoToTarget::Viewpoint(room, number) } => {
            format!("going to viewpoint {number} in the {}", room.name_in(catalog))
        }
        Action::GoTo { target: GoToTarget::Point(_) } => "going there".to_owned(),
        Action::PickUp { object } => format!("picking up {}", the(object)),
        Action::Place { receptacle } => {
            let preposition = describe::preposition(catalog, scene, receptacle);
            format!("putting {} {preposition} {}", held(), the(receptacle))
        }
        Action::PlaceBeside { beside, .. } => format!("putting {} next to {}", held(), the(beside)),
        Action::Interact { verb: Verb::Pour, object } => format!("pouring {} into {}", held(), the(object)),
        Action::Interact { verb: Verb::Throw, object } => format!("throwing {} at {}", held(), the(object)),
        Action::Interact { verb: Verb::Fill, object } => format!("filling {} at {}", held(), the(object)),
        Action::Interact { verb: Verb::Clean, object } => match scene.robot.held {
            Some(held) => format!("cleaning {} in {}", the(held), the(object)),
            None => format!("cleaning {}", the(object)),
        },
        Action::Interact { verb, object } => format!("{} {}", participle(verb), the(object)),
        Action::Highlight { object } => format!("pointing at {}", the(object)),
        Action::Drive { .. } => "moving".to_owned(),
        Action::Stop => String::new(),
    }
}

const fn participle(verb: Verb) -> &'static str {
    match verb {
        Verb::Open => "opening",
        Verb::Close => "closing",
        Verb::Break => "breaking",
        Verb::Scan => "scanning",
        Verb::Pour => "pouring into",
        Verb::Toggle => "switching",
        Verb::Throw => "throwing at",
        Verb::Fill => "filling",
        Verb::Clean => "cleaning",
        Verb::Examine => "looking at",
    }
}
