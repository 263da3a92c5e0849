//! The things that matter for the goals of a mission: what they name, what may change it, and where things can be put.

use std::collections::BTreeSet;

use cohabit_cdf::{
    ClassId, Mission, ObjectClass, ObjectId, Property, StateFlag,
    catalog::{
        Stands,
        table::{Change, Need, View as _, takes},
    },
    goal::{InstancePattern, Predicate},
    symbolic::{Place, SymbolicState},
};

/// Most things that one pattern of a goal brings in.
const MOST_MEANT: usize = 24;
/// Things of a class that a rule or a machine needs.
const MOST_OF_A_CLASS: usize = 3;
/// Surfaces where anything can be put down meanwhile.
const TABLES: usize = 3;

/// A thing that matters: one of the world, or one that a machine would make.
#[derive(Clone, Debug)]
pub(crate) struct Matter {
    /// What it is in the world, if it is there.
    pub id: Option<ObjectId>,
    pub class: ClassId,
    pub names: Vec<String>,
}

/// All that a mission's goals name, with the conditions that they name.
pub(crate) fn named(mission: &Mission) -> BTreeSet<String> {
    let mut all = BTreeSet::new();
    let goals = mission.goals.iter().flat_map(|goal| &goal.states);
    for state in goals {
        all.insert(state.instance.0.clone());
        match &state.predicate {
            Predicate::Contains(what) => {
                all.insert(what.0.clone());
            }
            Predicate::Condition(name, _) => {
                if let Some(condition) = mission.condition(name, &state.instance.0) {
                    condition.expression.for_each_named(&mut |pattern| {
                        all.insert(pattern.0.clone());
                    });
                }
            }
            _ => {}
        }
    }
    all
}

/// Whether a pattern means something of these names and that class: any carrot is meant by `Carrot_01_*`.
pub(crate) fn is_meant(pattern: &InstancePattern, names: &[String], class: &str) -> bool {
    match pattern.0.strip_suffix('*') {
        Some(prefix) => names.iter().any(|name| name.starts_with(prefix)) || class == prefix.trim_end_matches('_'),
        None => names.contains(&pattern.0),
    }
}

/// The things of the world that matter.
pub(crate) fn of_the_world(state: &SymbolicState, mission: &Mission) -> Vec<ObjectId> {
    let table = state.catalog.table();
    let mut chosen = BTreeSet::new();
    for pattern in named(mission) {
        let pattern = InstancePattern(pattern);
        let meant = (0..).map(ObjectId).take(state.things.len()).filter(|id| {
            let thing = state.thing(*id);
            let names: Vec<String> = std::iter::once(&thing.instance).chain(&thing.aliases).cloned().collect();
            is_meant(&pattern, &names, &state.class(*id).id)
        });
        chosen.extend(meant.take(MOST_MEANT));
    }
    // Devices, and what rules and machines speak of.
    let classes = classes_spoken_of(state);
    let mut count = std::collections::HashMap::<ClassId, usize>::new();
    for id in state.existing() {
        let class = state.class(id);
        let is_device = table.is_device(&class.id) || is_machine(class);
        let is_spoken_of = classes.contains(&class.id);
        if is_spoken_of && !is_device {
            let known = count.entry(state.thing(id).class).or_default();
            *known += 1;
            if *known > MOST_OF_A_CLASS {
                continue;
            }
        }
        if is_device || is_spoken_of || is_filled_vessel(state, id) {
            chosen.insert(id);
        }
    }
    // What something that is named comes of.
    let patterns: Vec<InstancePattern> = named(mission).into_iter().map(InstancePattern).collect();
    for id in state.existing() {
        let class = &state.class(id).id;
        let said = state.thing(id).yesterday.map(|class| state.catalog.class(class).id.as_str());
        let mut makes = [table.slice(class), table.yesterday(class), said].into_iter().flatten();
        if makes.any(|made| patterns.iter().any(|pattern| is_meant(pattern, &[], made))) {
            chosen.insert(id);
        }
    }
    // Keys of what matters, and what is in it.
    let keys: BTreeSet<String> = chosen
        .iter()
        .filter_map(|id| state.class(*id).receptacle.as_ref())
        .flat_map(|kind| kind.keys.clone())
        .collect();
    let wanted = |id: &ObjectId| {
        let inside = state.parent(*id).is_some_and(|parent| chosen.contains(&parent));
        let class = state.class(*id);
        class.has(Property::Pickupable) && (inside || keys.contains(&class.id))
    };
    let more: Vec<ObjectId> = state.existing().filter(wanted).collect();
    chosen.extend(more);
    chosen.extend(state.held);
    // What they are in, outwards, and what is worked.
    let mut todo: Vec<ObjectId> = chosen.iter().copied().collect();
    while let Some(id) = todo.pop() {
        for next in [state.parent(id), state.thing(id).works, state.thing(id).was].into_iter().flatten() {
            if chosen.insert(next) {
                todo.push(next);
            }
        }
    }
    chosen.extend(tables(state));
    chosen.into_iter().collect()
}

fn is_machine(class: &ObjectClass) -> bool {
    class.has(Property::Toggleable) && !class.has(Property::Pickupable)
}

/// What holds a fluid and can be carried.
fn is_filled_vessel(state: &SymbolicState, id: ObjectId) -> bool {
    state.class(id).has(Property::Pickupable)
        && state.thing(id).fluid != cohabit_cdf::Fluid::None
        && !state.is(id, StateFlag::Broken)
}

/// Open furniture with room, on which anything can be put.
pub(crate) fn tables(state: &SymbolicState) -> Vec<ObjectId> {
    let is_table = |id: &ObjectId| {
        let class = state.class(*id);
        let kind = class.receptacle.as_ref();
        kind.is_some_and(|kind| !kind.enclosed && kind.keys.is_empty() && kind.surfaces.len() == 1)
            && class.stands == Stands::OnFloor
            && !class.has(Property::Powerable)
            && !class.has(Property::Toggleable)
            && class.size_m[2] > 0.5
            && state.has_room(*id)
    };
    let mut found: Vec<ObjectId> = state.existing().filter(is_table).collect();
    let far = |id: &ObjectId| state.thing(*id).access.reach_m;
    found.sort_by(|one, two| far(one).total_cmp(&far(two)));
    found.truncate(TABLES);
    found
}

/// Small things that conditions of rules, devices and works name, such as tools.
fn classes_spoken_of(state: &SymbolicState) -> BTreeSet<String> {
    let catalog = &state.catalog;
    let table = catalog.table();
    let of_needs = |needs: &[Need]| needs.iter().flat_map(|need| need.any.clone()).collect::<Vec<_>>();
    let mut conditions = Vec::new();
    for rule in table.rules() {
        conditions.extend(of_needs(&rule.needs));
        conditions.extend(rule.when.clone());
    }
    for device in table.devices() {
        conditions.extend(of_needs(&device.needs));
    }
    let mut patterns: Vec<String> = conditions
        .into_iter()
        .flat_map(|condition| condition.test.pattern().map(|classes| classes.0.clone()).unwrap_or_default())
        .collect();
    patterns.extend(table.cartridges().map(|(cartridge, _)| cartridge.to_owned()));
    let is_small = |class: &&ObjectClass| class.has(Property::Pickupable) && patterns.contains(&class.id);
    catalog.classes().iter().filter(is_small).map(|class| class.id.clone()).collect()
}

/// What machines and knives could make of the things that matter: the class, and the machine that it is named after.
pub(crate) fn products(state: &SymbolicState, chosen: &[ObjectId], mission: &Mission) -> Vec<Matter> {
    let catalog = &state.catalog;
    let table = catalog.table();
    let mut made: BTreeSet<(u16, Option<ObjectId>)> = BTreeSet::new();
    for id in chosen {
        let class = state.class(*id);
        let slice = table.slice(&class.id).into_iter();
        let yesterday = table.yesterday(&class.id).into_iter();
        for product in slice.chain(yesterday).filter_map(|class| catalog.find(class)) {
            made.insert((product.0, None));
        }
        made.extend(state.thing(*id).yesterday.map(|class| (class.0, None)));
        let device = table.device(&class.id);
        let work = device.work.as_ref().and_then(|work| table.work(work));
        for change in work.iter().flat_map(|work| work.changes()) {
            match change {
                Change::Become(_, class) | Change::Spawn(_, class) => {
                    made.extend(catalog.find(class).map(|class| (class.0, Some(*id))));
                }
                Change::Print(_) => {
                    let printed = chosen.iter().filter_map(|id| {
                        let by_class = table.prints(&state.class(*id).id)?;
                        state.thing(*id).prints.or_else(|| catalog.find(by_class))
                    });
                    made.extend(printed.map(|class| (class.0, Some(*id))));
                }
                _ => {}
            }
        }
    }
    // Only what a goal may mean, or what somebody may work with.
    let patterns: Vec<InstancePattern> = named(mission).into_iter().map(InstancePattern).collect();
    let spoken_of = classes_spoken_of(state);
    let products = made.into_iter().map(|(class, maker)| matter(state, ClassId(class), maker));
    products
        .filter(|product| {
            let class = &catalog.class(product.class).id;
            let by_yesterday = chosen.iter().any(|id| state.thing(*id).yesterday == Some(product.class));
            // What machines make takes room in them.
            product.names[0].contains("_Spawned_")
                || spoken_of.contains(class)
                || by_yesterday
                || patterns.iter().any(|pattern| is_meant(pattern, &product.names, class))
        })
        .collect()
}

fn matter(state: &SymbolicState, class: ClassId, maker: Option<ObjectId>) -> Matter {
    let id = &state.catalog.class(class).id;
    let is_free =
        |name: &String| !state.things.iter().any(|thing| thing.instance == *name || thing.aliases.contains(name));
    let numbered = |stem: String| {
        let number = (1..100).find(|number| is_free(&format!("{stem}_{number}"))).unwrap_or(100);
        format!("{stem}_{number}")
    };
    let names = match maker.map(|maker| state.thing(maker)) {
        Some(maker) => {
            let names = std::iter::once(&maker.instance).chain(&maker.aliases);
            names.map(|name| numbered(format!("{name}_Spawned_{id}"))).collect()
        }
        None => vec![numbered(id.clone())],
    };
    Matter { id: None, class, names }
}

/// Whether a thing can be moved about.
pub(crate) fn moves(state: &SymbolicState, id: ObjectId) -> bool {
    let in_slot = matches!(&state.thing(id).place, Place::On { .. }) && state.is_behind_glass(id);
    state.class(id).has(Property::Pickupable) || in_slot
}

/// Whether a receptacle takes a thing of a class at all.
pub(crate) fn may_hold(receptacle: &ObjectClass, class: &ObjectClass) -> bool {
    takes(receptacle, &class.id)
}
