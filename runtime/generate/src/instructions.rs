//! What people would say for the steps of a plan: one plain sentence each.

use cohabit_cdf::{ActionKind, ObjectId, StateFlag};
use cohabit_world::{BodyId, World};

/// One step of the first body, as people would ask for it before it is done: `open the fridge`.
#[must_use]
pub fn instruction(world: &World, kind: ActionKind, id: ObjectId) -> String {
    let name = |id: ObjectId| {
        let class = world.object(id).map(|view| world.catalog().class(view.class));
        class.map_or_else(|| "thing".to_owned(), |class| class.name.to_lowercase())
    };
    let held = world.body(BodyId(0)).and_then(|body| body.held).map(name);
    let held = held.unwrap_or_else(|| "thing".to_owned());
    let it = name(id);
    let is_on = world.object(id).is_some_and(|view| view.flags.has(StateFlag::Toggled));
    let is_enclosed = world
        .object(id)
        .is_some_and(|view| world.catalog().class(view.class).receptacle.as_ref().is_some_and(|kind| kind.enclosed));
    if let Some(word) = own_word(world, kind, id) {
        return format!("{word} the {it}");
    }
    match kind {
        ActionKind::GoTo => format!("go to the {it}"),
        ActionKind::PickUp => format!("pick up the {it}"),
        ActionKind::Place if is_enclosed => format!("put the {held} in the {it}"),
        ActionKind::Place => format!("put the {held} on the {it}"),
        ActionKind::Open => format!("open the {it}"),
        ActionKind::Close => format!("close the {it}"),
        ActionKind::Break => format!("break the {it}"),
        ActionKind::Scan => format!("scan the {it}"),
        ActionKind::Pour => format!("pour the {held} into the {it}"),
        ActionKind::Toggle if is_on => format!("turn off the {it}"),
        ActionKind::Toggle => format!("turn on the {it}"),
        ActionKind::Throw => format!("throw the {held} at the {it}"),
        ActionKind::Fill => format!("fill the {held}"),
        ActionKind::Clean => format!("clean the {held}"),
        ActionKind::Examine => format!("look at the {it}"),
    }
}

/// What people say where a rule gives an action another meaning: to close a shirt is to fold it, to clean it with an iron is to iron it.
fn own_word(world: &World, kind: ActionKind, id: ObjectId) -> Option<&str> {
    let usual = match kind {
        ActionKind::Open => "open",
        ActionKind::Close => "close",
        ActionKind::Pour => "pour",
        ActionKind::Clean => "clean",
        _ => return None,
    };
    let judgement = world.catalog().table().judge(&world.symbols(BodyId(0)), kind, id)?;
    let words = &judgement.rule.words;
    words.first().filter(|_| words.iter().all(|word| word != usual)).map(String::as_str)
}
