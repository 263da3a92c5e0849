//! `cohabit catalog`: what missions, floor plans and scripts may name.

use std::collections::BTreeMap;

use clap::ValueEnum;
use cohabit_cdf::{
    ActionKind, Catalog, Layout, ObjectClass, Property, RoomId, WorldData,
    mission::{GoalForm, goal_kinds},
};
use cohabit_tables::{Align, columns};
use serde_json::{Map, Value, json};

use crate::{
    failure::bad_input,
    terminal::{print, shown_json, shown_lines},
    world::WorldPacks,
};

/// Lists what missions may name: classes of objects with what can be done with them, devices with what they need, rooms, goals with
/// an example of each, and floor plans
#[derive(clap::Args)]
pub struct List {
    /// What to list; all of it, if absent
    #[arg(value_name = "classes|devices|rooms|goals|plans", hide_possible_values = true)]
    kind: Option<Kind>,
    #[command(flatten)]
    packs: WorldPacks,
    /// Print one JSON document
    #[arg(long)]
    json: bool,
}

/// What can be listed.
#[derive(Clone, Copy, Debug, Eq, PartialEq, ValueEnum)]
enum Kind {
    /// Classes of objects.
    Classes,
    /// Devices.
    Devices,
    /// Rooms.
    Rooms,
    /// What goals can ask for.
    Goals,
    /// Floor plans.
    Plans,
}

impl Kind {
    fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }

    fn sheet(self, world: &WorldData) -> anyhow::Result<Sheet> {
        let catalog = world.catalog();
        Ok(match self {
            Self::Classes => classes(catalog),
            Self::Devices => devices(catalog),
            Self::Rooms => rooms(catalog, &plans_of(catalog)?),
            Self::Goals => goals(),
            Self::Plans => plans(world, &plans_of(catalog)?),
        })
    }
}

/// A list: the names of its columns, and what stands in them.
struct Sheet {
    head: &'static [&'static str],
    rows: Vec<Vec<Cell>>,
}

/// What stands in a column.
enum Cell {
    Text(String),
    Several(Vec<String>),
}

impl List {
    /// Prints it.
    pub fn run(&self) -> anyhow::Result<()> {
        let world = self.packs.read()?;
        let text = match (self.kind, self.json) {
            (Some(kind), true) => format!("{}\n", shown_json(format_args!("{:#}", kind.sheet(&world)?.value()))),
            (Some(kind), false) => shown_lines(kind.sheet(&world)?.text()).to_string(),
            (None, true) => {
                let mut all = Map::new();
                for kind in Kind::value_variants() {
                    all.insert(kind.name(), kind.sheet(&world)?.value());
                }
                format!("{}\n", shown_json(format_args!("{:#}", Value::Object(all))))
            }
            (None, false) => {
                let sheets = Kind::value_variants().iter();
                let sheets = sheets.map(|kind| Ok(format!("{}\n{}", kind.name(), kind.sheet(&world)?.text())));
                shown_lines(sheets.collect::<anyhow::Result<Vec<_>>>()?.join("\n")).to_string()
            }
        };
        print(&text)
    }
}

impl Sheet {
    /// A line for each row, its columns one below the other.
    fn text(&self) -> String {
        let cell = |cell: &Cell| match cell {
            Cell::Text(text) => text.clone(),
            Cell::Several(several) => several.join(", "),
        };
        let head = self.head.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
        let rows = self.rows.iter().map(|row| row.iter().map(cell).collect::<Vec<_>>());
        let lines: Vec<Vec<String>> = std::iter::once(head).chain(rows).collect();
        columns(&lines, Align::Left)
    }

    /// A list of objects, each with the columns as its members.
    fn value(&self) -> Value {
        let value = |cell: &Cell| match cell {
            Cell::Text(text) => json!(text),
            Cell::Several(several) => json!(several),
        };
        let row = |row: &Vec<Cell>| {
            let members = self.head.iter().zip(row).map(|(name, cell)| ((*name).to_owned(), value(cell)));
            Value::Object(members.collect())
        };
        Value::Array(self.rows.iter().map(row).collect())
    }
}

/// Classes, with what people call them and what can be done with them.
fn classes(catalog: &Catalog) -> Sheet {
    let carried: Vec<&ObjectClass> = catalog.classes().iter().filter(|class| class.has(Property::Pickupable)).collect();
    let row = |class: &ObjectClass| {
        let table = catalog.table();
        let is_afforded = |action: &ActionKind| {
            let with = |held: &&ObjectClass| table.affords(*action, class, Some(*held));
            *action != ActionKind::GoTo && (table.affords(*action, class, None) || carried.iter().any(with))
        };
        let actions = ActionKind::ALL.into_iter().filter(is_afforded).map(|action| action.name().to_owned());
        vec![
            Cell::Text(class.id.clone()),
            Cell::Text(class.name.clone()),
            Cell::Several(class.properties.iter().map(|property| property_name(*property)).collect()),
            Cell::Several(actions.collect()),
            Cell::Several(class.words.clone()),
        ]
    };
    let rows = catalog.classes().iter().map(row).collect();
    Sheet { head: &["id", "name", "properties", "actions", "words"], rows }
}

/// As files write it: `PICKUPABLE`.
fn property_name(property: Property) -> String {
    format!("{property:?}").to_uppercase()
}

/// Classes of devices, with what their switch needs beyond what all switches need, and what they do.
fn devices(catalog: &Catalog) -> Sheet {
    let mut rows = Vec::new();
    for class in catalog.classes().iter().filter(|class| catalog.table().is_device(&class.id)) {
        let device = catalog.table().device(&class.id);
        let needs = device.needs.iter().map(|need| need.words.replace("{it}", "it").replace("{held}", "what is held"));
        let works = [&device.work, &device.shut_work].into_iter().flatten().cloned();
        rows.push(vec![
            Cell::Text(class.id.clone()),
            Cell::Text(class.name.clone()),
            Cell::Several(works.collect()),
            Cell::Several(device.works.iter().chain(&device.aims).cloned().collect()),
            Cell::Several(device.worked_by.clone()),
            Cell::Several(needs.collect()),
        ]);
    }
    Sheet { head: &["id", "name", "work", "works_on", "worked_by", "refuses_if"], rows }
}

/// All floor plans but their mirror images.
fn plans_of(catalog: &Catalog) -> anyhow::Result<Vec<Layout>> {
    let ids = Layout::ids(catalog);
    let own = ids.iter().filter(|id| !id.ends_with("_mirror"));
    own.map(|id| Layout::find(id, catalog).map_err(bad_input)).collect()
}

/// Rooms, with what people call them and the floor plans that have them.
fn rooms(catalog: &Catalog, plans: &[Layout]) -> Sheet {
    let mut known = BTreeMap::<RoomId, Vec<String>>::new();
    for plan in plans {
        for room in &plan.rooms {
            known.entry(room.id).or_default().push(plan.id.clone());
        }
    }
    let row = |(room, plans): (RoomId, Vec<String>)| {
        let words = catalog.rooms().get(room).map(|entry| entry.words.clone()).unwrap_or_default();
        let name = room.name_in(catalog).to_owned();
        vec![Cell::Text(room.id().to_owned()), Cell::Text(name), Cell::Several(words), Cell::Several(plans)]
    };
    Sheet { head: &["id", "name", "words", "plans"], rows: known.into_iter().map(row).collect() }
}

/// What goals can ask for.
fn goals() -> Sheet {
    let rows = goal_kinds().map(|kind| {
        let place = match kind.form {
            GoalForm::State => "object_states",
            GoalForm::Expression => "stateconditions",
        };
        let needs = kind.needs.map(property_name).into_iter().collect();
        let [key, place, meaning] = [kind.key, place, kind.meaning].map(|text| Cell::Text(text.to_owned()));
        vec![key, place, Cell::Several(needs), meaning, Cell::Text(kind.example)]
    });
    Sheet { head: &["key", "place", "needs", "meaning", "example"], rows: rows.collect() }
}

/// Floor plans, each of which there is mirrored, too.
fn plans(world: &WorldData, plans: &[Layout]) -> Sheet {
    let row = |plan: &Layout| {
        let of_pack = world.packs().iter().find(|pack| pack.plan_file(&plan.id).is_some());
        let pack = of_pack.map_or_else(|| "built in".to_owned(), |pack| pack.id().name.clone());
        let rooms = plan.rooms.iter().map(|room| room.id.id().to_owned());
        vec![
            Cell::Text(plan.id.clone()),
            Cell::Text(pack),
            Cell::Text(plan.placements.len().to_string()),
            Cell::Several(rooms.collect()),
        ]
    };
    Sheet { head: &["id", "pack", "things", "rooms"], rows: plans.iter().map(row).collect() }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn listed(kind: Kind) -> Vec<Value> {
        let Value::Array(rows) = kind.sheet(&WorldData::builtin()).unwrap().value() else { panic!("no list") };
        rows
    }

    fn row(kind: Kind, id: &str) -> Value {
        listed(kind).into_iter().find(|row| row["id"] == id).unwrap()
    }

    #[test]
    fn each_list_has_what_there_is() {
        let catalog = Catalog::builtin();
        assert_eq!(listed(Kind::Classes).len(), catalog.classes().len());
        assert_eq!(listed(Kind::Goals).len(), goal_kinds().count());
        assert_eq!(listed(Kind::Plans).len() * 2, Layout::builtin_ids().len());
        let actions = |id: &str| row(Kind::Classes, id)["actions"].as_array().unwrap().clone();
        assert!(actions("Bowl_01").contains(&json!("pick_up")) && !actions("Desk_01").contains(&json!("pick_up")));
        assert!(actions("Desk_01").contains(&json!("place")) && !actions("Apple").contains(&json!("place")));
        assert!(row(Kind::Devices, "Microwave_01")["work"].as_array().is_some_and(|works| !works.is_empty()));
        let office = row(Kind::Rooms, "Lab1");
        assert_eq!(office["name"], "robotics lab");
        assert!(office["plans"].as_array().unwrap().contains(&json!("OfficeLayout1")));
    }

    #[test]
    fn lines_have_their_columns_one_below_the_other() {
        let cells = |id: &str, several: &[&str]| {
            vec![Cell::Text(id.to_owned()), Cell::Several(several.iter().map(|one| (*one).to_owned()).collect())]
        };
        let sheet = Sheet { head: &["id", "rooms"], rows: vec![cells("a-long-one", &["x", "y"]), cells("b", &[])] };
        assert_eq!(sheet.text(), "id          rooms\na-long-one  x, y\nb\n");
    }
}
