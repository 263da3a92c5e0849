//! How people say what they want: templates. `{o}` stands for the object, `{t}` for the other one, `{r}` for a room or a
//! colour.

use crate::meaning::Meaning;

/// The ways to say it.
pub(super) const fn ways(meaning: &Meaning) -> &'static [&'static str] {
    match meaning {
        Meaning::GoTo { .. } => &[
            "go to the {r}",
            "head over to the {r}",
            "please walk to the {r}",
            "can you go to the {r}?",
            "now go into the {r}",
            "move to the {r}",
        ],
        Meaning::PickUp { .. } => &[
            "pick up {o}",
            "grab {o}",
            "take {o}",
            "could you pick {o} up?",
            "get {o} please",
            "I need you to pick up {o}",
        ],
        Meaning::Place { .. } => &[
            "put {o} on {t}",
            "place {o} on {t}",
            "set {o} down on {t}",
            "please put {o} onto {t}",
            "leave {o} on {t}",
        ],
        Meaning::Insert { .. } => {
            &["put {o} in {t}", "insert {o} into {t}", "place {o} inside {t}", "please put {o} into {t}"]
        }
        Meaning::TurnOn { .. } => {
            &["turn on {o}", "switch {o} on", "start {o}", "can you activate {o}?", "please turn {o} on"]
        }
        Meaning::Scan { .. } => &["scan {o}", "please scan {o}", "go and scan {o}", "I want you to scan {o}"],
        Meaning::Break { .. } => {
            &["break {o}", "smash {o}", "please break {o} with the hammer", "use the hammer to break {o}"]
        }
        Meaning::Clean { .. } => &["clean {o}", "wash {o}", "wash {o} in the sink", "please clean {o}", "rinse {o}"],
        Meaning::Fill { .. } => {
            &["fill {o} with water", "fill {o} at the sink", "get some water into {o}", "fill up {o} with water"]
        }
        Meaning::Pour { .. } => &["pour {o} into {t}", "pour {o} in {t}", "empty {o} into {t}"],
        Meaning::Heat { .. } => {
            &["heat {o}", "warm up {o}", "heat {o} up in the microwave", "make {o} hot", "microwave {o}"]
        }
        Meaning::Cool { .. } => &["cool {o} down", "make {o} cold", "chill {o} in the freezer", "freeze {o}"],
        Meaning::Repair { .. } => &["repair {o}", "fix {o}", "mend {o} with the time machine", "make {o} whole again"],
        Meaning::Color { .. } => &["make {o} {r}", "color {o} {r}", "turn {o} {r}", "change the color of {o} to {r}"],
    }
}

/// What some people say before it.
pub(super) const OPENERS: [&str; 8] = ["ok ", "now ", "hey robot, ", "alright, ", "so ", "great, ", "well, ", "next, "];

/// The same in the words that mean one thing alone.
pub(super) fn exact(meaning: &Meaning) -> String {
    match meaning {
        Meaning::GoTo { name, .. } => format!("go to the {name}"),
        Meaning::PickUp { object } => format!("pick up {object}"),
        Meaning::Place { object, receptacle } => format!("put {object} on {receptacle}"),
        Meaning::Insert { object, device } => format!("put {object} in {device}"),
        Meaning::TurnOn { device } => format!("turn on {device}"),
        Meaning::Scan { object } => format!("scan {object}"),
        Meaning::Break { object } => format!("break {object}"),
        Meaning::Clean { object } => format!("clean {object}"),
        Meaning::Fill { object } => format!("fill {object} with water"),
        Meaning::Pour { from, into } => format!("pour {from} into {into}"),
        Meaning::Heat { object } => format!("heat {object}"),
        Meaning::Cool { object } => format!("cool {object}"),
        Meaning::Repair { object } => format!("repair {object}"),
        Meaning::Color { object, color } => format!("color {object} {}", color.name().to_lowercase()),
    }
}
