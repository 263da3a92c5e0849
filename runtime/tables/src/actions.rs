//! The table of actions: what bodies were told to do, and what came of it.

use cohabit_cdf::{Action, GoToTarget};

use crate::{
    played::{Deed, Played, seconds},
    table::{
        Cell, Field,
        Kind::{Flag, Real, Text, Whole},
        Table,
    },
};

const FIELDS: [Field; 16] = [
    Field::new("session", Text, "", "the session, as in the table of sessions"),
    Field::new("command", Whole, "", "the command's number, unlike that of any other of the session"),
    Field::new("turn", Whole, "", "the turn it belongs to; nothing where nobody asked for it"),
    Field::new("body", Whole, "", "the body that was told; 0 is the robot that is spoken to"),
    Field::new("tick", Whole, "", "the tick that took it in"),
    Field::new("time_s", Real, "s", "simulated time of that tick"),
    Field::new("duration_s", Real, "s", "simulated time from there to its end; nothing if it had not ended"),
    Field::new("action", Text, "", "what to do; what held keys command is left out"),
    Field::new("object", Whole, "", "the object that it is about, by its number in the session"),
    Field::new("place", Text, "", "where to go, if no object: room, viewpoint, or point in metres; or beside what"),
    Field::new("distance_m", Real, "m", "how far to move; negative is backwards"),
    Field::new("angle_deg", Real, "deg", "how far to turn to the left, or to look up"),
    Field::new("status", Text, "", "how it ended"),
    Field::new("success", Flag, "", "whether it did what was asked"),
    Field::new("failure", Flag, "", "whether it failed; what was interrupted neither did nor failed"),
    Field::new("detail", Text, "", "what the world said about its end"),
];

/// All actions of these sessions.
pub fn table(played: &[Played]) -> Table {
    let rows = played.iter().flat_map(|played| played.actions.iter().map(|deed| row(played, deed)));
    Table { name: "actions", meaning: "a command to a body", fields: FIELDS.into(), rows: rows.collect() }
}

fn row(played: &Played, deed: &Deed) -> Vec<Cell> {
    let Told { action, object, place, distance_m, angle_deg } = told(&deed.action);
    let (ended, status, detail) = match &deed.outcome {
        Some((tick, status, detail)) => (Some(*tick), Some(*status), detail.as_str()),
        None => (None, None, ""),
    };
    vec![
        Cell::text(&played.name),
        Cell::whole(deed.number),
        if deed.turn == 0 { Cell::Nothing } else { Cell::whole(deed.turn) },
        Cell::whole(deed.body),
        Cell::whole(deed.began),
        Cell::Real(seconds(deed.began)),
        Cell::maybe(ended, |ended| Cell::Real(seconds(ended.saturating_sub(deed.began)))),
        Cell::text(action),
        Cell::maybe(object, Cell::whole),
        Cell::maybe(place, Cell::Text),
        Cell::maybe(distance_m, |distance| Cell::Real(f64::from(distance))),
        Cell::maybe(angle_deg, |angle| Cell::Real(f64::from(angle))),
        Cell::maybe(status, |status| Cell::text(format!("{status:?}"))),
        Cell::maybe(status, |status| Cell::Flag(status.is_success())),
        Cell::maybe(status, |status| Cell::Flag(status.is_failure())),
        Cell::text(detail),
    ]
}

/// An action in columns.
#[derive(Default)]
struct Told {
    action: String,
    object: Option<u32>,
    place: Option<String>,
    distance_m: Option<f32>,
    angle_deg: Option<f32>,
}

fn told(action: &Action) -> Told {
    let named = |action: &str| Told { action: action.to_owned(), ..Told::default() };
    match action {
        Action::Move { distance_m } => Told { distance_m: Some(*distance_m), ..named("Move") },
        Action::Rotate { yaw_rad } => Told { angle_deg: Some(yaw_rad.to_degrees()), ..named("Rotate") },
        Action::Look { pitch_rad } => Told { angle_deg: Some(pitch_rad.to_degrees()), ..named("Look") },
        Action::LookAround => named("LookAround"),
        Action::GoTo { target } => match target {
            GoToTarget::Object(object) => Told { object: Some(object.0), ..named("GoTo") },
            GoToTarget::Room(room) => Told { place: Some(room.id().to_owned()), ..named("GoTo") },
            GoToTarget::Viewpoint(room, number) => {
                Told { place: Some(format!("{}_{number}", room.id())), ..named("GoTo") }
            }
            GoToTarget::Point([x, y]) => Told { place: Some(format!("{x:.3} {y:.3}")), ..named("GoTo") },
        },
        Action::PickUp { object } => Told { object: Some(object.0), ..named("PickUp") },
        Action::Place { receptacle } => Told { object: Some(receptacle.0), ..named("Place") },
        Action::PlaceBeside { receptacle, beside } => {
            Told { object: Some(receptacle.0), place: Some(format!("beside {}", beside.0)), ..named("Place") }
        }
        Action::Interact { verb, object } => Told { object: Some(object.0), ..named(&format!("{verb:?}")) },
        Action::Highlight { object } => Told { object: Some(object.0), ..named("Highlight") },
        Action::Stop => named("Stop"),
        Action::Drive { .. } => named("Drive"),
    }
}
