//! What the robot knows as symbols, and what a step changes about it by the table of actions and devices.

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
};

use cohabit_cdf::{
    ActionKind, Catalog, ObjectId, Property,
    state::{StateFlag, StateFlags},
    symbolic::{Place, SymbolicState, Thing},
    table::Need,
};

use crate::known::{Known, KnownObject};

/// Changes `scene` as an action on an object is meant to, once it and all that it sets going is over. What machines make or take
/// away is left out: only the world knows under which id a product comes.
pub(crate) fn act(scene: &mut Known, kind: ActionKind, object: ObjectId, catalog: &Arc<Catalog>) {
    let Some(it) = number(scene, object) else { return };
    let before = symbols(scene, catalog);
    let Some(after) = before.expected(kind, it) else { return };
    scene.robot.held = after.held.and_then(|held| scene.objects.get(held.0 as usize)).map(|held| held.id);
    for (index, (was, is)) in before.things.iter().zip(&after.things).enumerate() {
        if was != is {
            note(scene, index, was, is);
        }
    }
}

/// What an action on an object lacks by the table, as far as is known; nothing, where nothing of it is known to be lacking.
pub(crate) fn lack<'c>(
    scene: &Known,
    kind: ActionKind,
    object: ObjectId,
    catalog: &'c Arc<Catalog>,
) -> Option<&'c Need> {
    let it = number(scene, object)?;
    catalog.table().judge(&symbols(scene, catalog), kind, it)?.lack
}

/// Takes over what is other than it was about the object at that place in the list.
fn note(scene: &mut Known, index: usize, was: &Thing, is: &Thing) {
    let holder = match &is.place {
        Place::On { parent, .. } => scene.objects.get(parent.0 as usize),
        _ => None,
    };
    let holder = holder.map(|holder| (holder.id, holder.position_m, holder.room));
    let Some(object) = scene.objects.get_mut(index) else { return };
    let turned = was.flags.0 ^ is.flags.0;
    object.flags = StateFlags((object.flags.0 & !turned) | (is.flags.0 & turned));
    (object.fluid, object.color) = (is.fluid, is.color);
    if was.place == is.place || is.place == Place::Gone {
        return;
    }
    object.parent = None;
    if let Some((id, position_m, room)) = holder {
        (object.parent, object.position_m, object.room) = (Some(id), position_m, room);
    }
}

/// The things in the order of the scene's list. Distances are left out: the robot goes to what it acts on.
fn symbols(scene: &Known, catalog: &Arc<Catalog>) -> SymbolicState {
    SymbolicState {
        catalog: Arc::clone(catalog),
        things: scene.objects.iter().map(|object| thing(scene, object, catalog)).collect(),
        held: scene.robot.held.and_then(|held| number(scene, held)),
        alive: true,
        circuits: BTreeMap::new(),
        doors: Vec::new(),
        gates: BTreeMap::new(),
        passes: BTreeMap::new(),
        eaters: BTreeMap::new(),
        fed: BTreeSet::new(),
    }
}

fn thing(scene: &Known, object: &KnownObject, catalog: &Catalog) -> Thing {
    let class = catalog.class(object.class);
    // What is in itself by way of others is the world's mistake; it must not hang the conversation.
    let is_circular = || scene.ancestors(object.id).any(|outer| outer.id == object.id);
    let place = match object.parent.and_then(|parent| number(scene, parent)) {
        _ if scene.robot.held == Some(object.id) => Place::Held,
        // A machine that cannot be carried stands on its parent.
        Some(parent) if !is_circular() => {
            Place::On { parent, anchors: Vec::new(), within: class.has(Property::Pickupable) }
        }
        _ => Place::Own,
    };
    let mut flags = object.flags;
    // The robot counts on power that it does not know to be cut.
    if class.has(Property::Powerable) {
        flags.set(StateFlag::Powered, true);
    }
    let works = object.works.and_then(|machine| number(scene, machine));
    let (fluid, color) = (object.fluid, object.color);
    Thing { flags, fluid, color, works, ..Thing::new(String::new(), object.class, object.room, place) }
}

/// The place of an object in the scene's list.
fn number(scene: &Known, id: ObjectId) -> Option<ObjectId> {
    scene.place(id).and_then(|at| u32::try_from(at).ok()).map(ObjectId)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use cohabit_cdf::{Fluid, RoomId};

    use super::*;
    use crate::known::KnownRobot;

    /// A scene of classes, each in or on the one of that number.
    fn scene(catalog: &Catalog, things: &[(&str, Option<u32>)], held: Option<u32>) -> Known {
        let held = held.map(ObjectId);
        let robot = KnownRobot { position_m: [0.0; 3], yaw_rad: 0.0, room: RoomId::BREAK_ROOM, held };
        let objects = (0_u32..).zip(things).map(|(id, (class, parent))| {
            let (instance, kind) = (format!("{class}_1"), catalog.find(class).unwrap());
            let object = KnownObject::new(ObjectId(id), instance, kind, RoomId::BREAK_ROOM, [id as f32, 0.0, 0.0]);
            KnownObject { parent: parent.map(ObjectId), visible: true, ..object }
        });
        let objects = objects.collect();
        Known::new(robot, objects)
    }

    #[test]
    fn steps_change_what_the_table_says() {
        let catalog = Arc::new(Catalog::builtin());
        let things = [("Microwave_01", None), ("Bowl_01", None), ("KitchenCounterSink_01", None)];
        let mut scene = scene(&catalog, &things, None);
        let [microwave, bowl, sink] = [0, 1, 2].map(ObjectId);
        let mut act = |kind, id| act(&mut scene, kind, id, &catalog);
        act(ActionKind::PickUp, bowl);
        act(ActionKind::Toggle, sink);
        act(ActionKind::Fill, sink);
        act(ActionKind::Open, microwave);
        act(ActionKind::Place, microwave);
        act(ActionKind::Close, microwave);
        act(ActionKind::Toggle, microwave);
        let known = scene.object(bowl).unwrap();
        assert_eq!((known.parent, known.fluid, known.position_m), (Some(microwave), Fluid::Water, [0.0; 3]));
        assert!(known.has(StateFlag::Hot) && !known.has(StateFlag::PickedUp) && scene.robot.held.is_none());
        let machine = scene.object(microwave).unwrap();
        let flags = [StateFlag::Toggled, StateFlag::Opened, StateFlag::Powered];
        assert!(flags.into_iter().all(|flag| !machine.has(flag)));
        assert!(scene.object(sink).unwrap().has(StateFlag::Toggled));
    }

    #[test]
    fn what_is_poured_leaves_the_hand_and_what_becomes_another_thing_stays_known() {
        let catalog = Arc::new(Catalog::builtin());
        let things = [("CoffeeMug_Boss", None), ("Bowl_01", None), ("EAC_Machine", None), ("Apple", Some(2))];
        let mut scene = scene(&catalog, &things, Some(0));
        scene.objects[0].fluid = Fluid::Milk;
        act(&mut scene, ActionKind::Pour, ObjectId(1), &catalog);
        assert_eq!([0, 1].map(|at: usize| scene.objects[at].fluid), [Fluid::None, Fluid::Milk]);
        act(&mut scene, ActionKind::Toggle, ObjectId(2), &catalog);
        assert_eq!(scene.objects.len(), 4);
        assert_eq!(scene.objects[3].parent, Some(ObjectId(2)));
    }

    #[test]
    fn a_circle_of_parents_ends() {
        let catalog = Arc::new(Catalog::builtin());
        let mut scene = scene(&catalog, &[("FoodPlate_01", Some(1)), ("Bowl_01", Some(0)), ("Apple", Some(1))], None);
        act(&mut scene, ActionKind::PickUp, ObjectId(2), &catalog);
        assert_eq!(scene.robot.held, Some(ObjectId(2)));
        assert!(scene.objects[2].parent.is_none());
    }
}
