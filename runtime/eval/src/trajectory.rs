//! Commands as the reference's models emit them and its data set keeps them.

use std::f32::consts::PI;

use cohabit_cdf::{Action, GoToTarget, ObjectId, Verb};
use cohabit_world::World;
use serde_json::Value;

/// The command that `value` stands for in `world`; `None` where it changes nothing here (a camera, something said).
///
/// # Errors
/// What is wrong with it, for people.
pub fn action(value: &Value, world: &World) -> Result<Option<Action>, String> {
    let kind = value["type"].as_str().ok_or("it has no \"type\"")?;
    let fields = &value[kind.to_lowercase()];
    let object = || object(&fields["object"], world);
    let interact = |verb| object().map(|object| Some(Action::Interact { verb, object }));
    let magnitude = || number(&fields["magnitude"]);
    let backwards = |words: &[&str]| fields["direction"].as_str().is_some_and(|word| words.contains(&word));
    let signed = |amount: f32, negative: bool| if negative { -amount } else { amount };
    match kind {
        "Goto" => place(&fields["object"], world).map(|target| Some(Action::GoTo { target })),
        "Move" => {
            Ok(Some(Action::Move { distance_m: signed(magnitude()?, backwards(&["Backward", "Backwards", "Back"])) }))
        }
        "Rotate" => {
            let yaw_rad = signed(magnitude()? * PI / 180.0, !backwards(&["Left", "CounterClockwise"]));
            Ok(Some(Action::Rotate { yaw_rad }))
        }
        "Look" if backwards(&["Around"]) => Ok(Some(Action::LookAround)),
        "Look" => Ok(Some(Action::Look { pitch_rad: signed(magnitude()? * PI / 180.0, backwards(&["Down"])) })),
        "Pickup" => object().map(|object| Some(Action::PickUp { object })),
        "Place" => object().map(|receptacle| Some(Action::Place { receptacle })),
        "Highlight" => object().map(|object| Some(Action::Highlight { object })),
        "Open" => interact(Verb::Open),
        "Close" => interact(Verb::Close),
        "Break" => interact(Verb::Break),
        "Scan" => interact(Verb::Scan),
        "Examine" => interact(Verb::Examine),
        "Pour" => interact(Verb::Pour),
        "Toggle" => interact(Verb::Toggle),
        "Fill" => interact(Verb::Fill),
        "Clean" => interact(Verb::Clean),
        "Throw" => interact(Verb::Throw),
        "CameraChange" | "Dialog" => Ok(None),
        other => Err(format!("there is no action \"{other}\"")),
    }
}

fn number(value: &Value) -> Result<f32, String> {
    let number = value.as_f64().or_else(|| value.as_str().and_then(|text| text.parse().ok()));
    number.map(|number| number as f32).ok_or_else(|| "it has no \"magnitude\"".to_owned())
}

fn place(value: &Value, world: &World) -> Result<GoToTarget, String> {
    let text = |key: &str| value[key].as_str();
    if let Some(room) = text("officeRoom") {
        let found = world.catalog().rooms().find(room).ok_or_else(|| format!("there is no room \"{room}\""))?;
        return Ok(GoToTarget::Room(found));
    }
    if let Some(point) = text("goToPoint") {
        let viewpoint = point.rsplit_once('_').and_then(|(room, number)| {
            Some(GoToTarget::Viewpoint(world.catalog().rooms().find(room)?, number.parse().ok()?))
        });
        return viewpoint.ok_or_else(|| format!("there is no viewpoint \"{point}\""));
    }
    object(value, world).map(GoToTarget::Object)
}

/// An object by its instance id, or the first of a class by the class's id or name.
fn object(value: &Value, world: &World) -> Result<ObjectId, String> {
    let named = ["id", "instanceId", "name"].iter().find_map(|key| value[*key].as_str());
    let name = named.ok_or("it names no object (\"id\" or \"name\")")?;
    let of_class = || {
        let catalog = world.catalog();
        world.objects().filter(|view| world.exists(view.id)).find_map(|view| {
            let class = catalog.class(view.class);
            (class.id == name || class.name.eq_ignore_ascii_case(name)).then_some(view.id)
        })
    };
    world.find(name).or_else(of_class).ok_or_else(|| format!("there is no object \"{name}\""))
}
