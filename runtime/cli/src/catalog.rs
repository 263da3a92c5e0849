//! `cohabit catalog`: what missions, floor plans and scripts may name.

use std::collections::BTreeMap;

use clap::ValueEnum;
use cohabit_cdf::{
    ActionKind, Catalog, Layout, ObjectClass, PackEntry, Property, RoomId, WorldData,
    mission::{GoalForm, goal_kinds},
    table::{change_forms, condition_forms, placeholders},
};
use cohabit_tables::{Align, columns};
use serde_json::{Map, Value, json};

use crate::{
    failure::bad_input,
    terminal::{print, shown_json, shown_lines},
    world::WorldPacks,
};

/// Lists what missions may name: classes of objects with what can be done with them, devices with what they need, rooms, goals with
/// an example of each, and floor plans; and what the tables of world packs may say: conditions, changes, and the words in them
#[derive(clap::Args)]
pub struct List {
    /// What to list, one or several; all of it, if absent
    #[arg(value_name = "classes|devices|rooms|goals|plans|conditions|changes|words", hide_possible_values = true)]
    kinds: Vec<Kind>,
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
    /// What tables can ask of things.
    Conditions,
    /// What tables can change about things.
    Changes,
    /// What the words in capitals in conditions and changes stand for.
    Words,
}

impl Kind {
    fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }

    fn sheet(self, world: &WorldData) -> anyhow::Result<Sheet> {
        let catalog = world.catalog();
        Ok(match self {
            Self::Classes => classes(catalog).of_packs(world, PackEntry::Class),
            Self::Devices => devices(catalog).of_packs(world, PackEntry::Device),
            Self::Rooms => rooms(catalog, &plans_of(catalog)?).of_packs(world, PackEntry::Room),
            Self::Goals => goals(),
            Self::Plans => plans(&plans_of(catalog)?).of_packs(world, PackEntry::Plan),
            Self::Conditions => conditions(),
            Self::Changes => changes(),
            Self::Words => words(),
        })
    }
}

/// A list: the names of its columns, and what stands in them.
struct Sheet {
    head: Vec<&'static str>,
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
        let kinds = if self.kinds.is_empty() { Kind::value_variants() } else { self.kinds.as_slice() };
        let text = match (kinds, self.json) {
            ([kind], true) => format!("{}\n", shown_json(format_args!("{:#}", kind.sheet(&world)?.value()))),
            ([kind], false) => shown_lines(kind.sheet(&world)?.text()).to_string(),
            (kinds, true) => {
                let mut all = Map::new();
                for kind in kinds {
                    all.insert(kind.name(), kind.sheet(&world)?.value());
                }
                format!("{}\n", shown_json(format_args!("{:#}", Value::Object(all))))
            }
            (kinds, false) => {
                let sheets = kinds.iter().map(|kind| Ok(format!("{}\n{}", kind.name(), kind.sheet(&world)?.text())));
                shown_lines(sheets.collect::<anyhow::Result<Vec<_>>>()?.join("\n")).to_string()
            }
        };
        print(&text)
    }
}

impl Sheet {
    /// The same with the pack that each entry is from, if there are packs, behind the ids; what is built in is from none.
    fn of_packs(mut self, world: &WorldData, entry: PackEntry) -> Self {
        if world.packs().is_empty() {
            return self;
        }
        self.head.insert(1, "pack");
        for row in &mut self.rows {
            let pack = match row.first() {
                Some(Cell::Text(id)) => world.pack_of(entry, id),
                _ => None,
            };
            let name = pack.map_or_else(String::new, |pack| pack.id().name.clone());
            row.insert(1, Cell::Text(name));
        }
        self
    }

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
    Sheet { head: vec!["id", "name", "properties", "actions", "words"], rows }
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
    Sheet { head: vec!["id", "name", "work", "works_on", "worked_by", "refuses_if"], rows }
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
    Sheet { head: vec!["id", "name", "words", "plans"], rows: known.into_iter().map(row).collect() }
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
    Sheet { head: vec!["key", "place", "needs", "meaning", "example"], rows: rows.collect() }
}

/// Floor plans, each of which there is mirrored, too.
fn plans(plans: &[Layout]) -> Sheet {
    let row = |plan: &Layout| {
        let rooms = plan.rooms.iter().map(|room| room.id.id().to_owned());
        let things = plan.placements.len().to_string();
        vec![Cell::Text(plan.id.clone()), Cell::Text(things), Cell::Several(rooms.collect())]
    };
    Sheet { head: vec!["id", "things", "rooms"], rows: plans.iter().map(row).collect() }
}

/// What tables can ask of things.
fn conditions() -> Sheet {
    let rows = condition_forms().map(|form| vec![Cell::Text(form.text), Cell::Text(form.meaning.to_owned())]);
    Sheet { head: vec!["condition", "meaning"], rows: rows.collect() }
}

/// What tables can change about things, and where they can.
fn changes() -> Sheet {
    let rows = change_forms().map(|form| {
        let places = [(true, "rule"), (form.is_of_a_press, "press"), (form.is_of_a_work, "work")];
        let places = places.into_iter().filter(|(is_of, _)| *is_of).map(|(_, place)| place.to_owned());
        let [text, meaning] = [form.text, form.meaning].map(|text| Cell::Text(text.to_owned()));
        vec![text, Cell::Several(places.collect()), meaning]
    });
    Sheet { head: vec!["change", "in", "meaning"], rows: rows.collect() }
}

/// What the words in capitals stand for.
fn words() -> Sheet {
    let rows = placeholders().into_iter().map(|place| {
        let [name, meaning] = [place.name, place.meaning].map(|text| Cell::Text(text.to_owned()));
        vec![name, meaning, Cell::Several(place.values)]
    });
    Sheet { head: vec!["word", "meaning", "values"], rows: rows.collect() }
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
    fn tables_are_listed_with_all_that_they_may_say() {
        let has = |kind, key: &str, text: &str| listed(kind).iter().any(|row| row[key] == text);
        assert!(has(Kind::Conditions, "condition", "TERM is FLAG") && has(Kind::Conditions, "condition", "never"));
        let takes = listed(Kind::Changes).into_iter().find(|row| row["change"] == "take TERM").unwrap();
        assert_eq!(takes["in"], json!(["rule"]));
        let runs = listed(Kind::Changes).into_iter().find(|row| row["change"] == "run TERM").unwrap();
        assert_eq!(runs["in"], json!(["rule", "press"]));
        let flags = listed(Kind::Words).into_iter().find(|row| row["word"] == "FLAG").unwrap();
        assert!(flags["values"].as_array().unwrap().contains(&json!("Dirty")));
    }

    #[test]
    fn entries_say_from_which_pack_they_are() {
        let files = cohabit_cdf::world_pack::template("my-lab").into_iter();
        let files = files.map(|(path, text)| cohabit_cdf::PackFile { path: path.to_owned(), bytes: text.into_bytes() });
        let pack = cohabit_cdf::WorldPack::parse("my-lab", files.collect()).unwrap();
        let world = WorldData::layered(vec![pack]).unwrap();
        for (kind, own, built_in) in [
            (Kind::Classes, "Wrench_01", "Bowl_01"),
            (Kind::Devices, "Degreaser_01", "Microwave_01"),
            (Kind::Rooms, "Workshop", "Lab1"),
            (Kind::Plans, "Workshop", "OfficeLayout1"),
        ] {
            let Value::Array(rows) = kind.sheet(&world).unwrap().value() else { panic!("no list") };
            let pack = |id: &str| rows.iter().find(|row| row["id"] == id).map(|row| row["pack"].clone()).unwrap();
            assert_eq!((pack(own), pack(built_in)), (json!("my-lab"), json!("")), "{}", kind.name());
            assert!(listed(kind).iter().all(|row| row.get("pack").is_none()));
        }
    }

    #[test]
    fn lines_have_their_columns_one_below_the_other() {
        let cells = |id: &str, several: &[&str]| {
            vec![Cell::Text(id.to_owned()), Cell::Several(several.iter().map(|one| (*one).to_owned()).collect())]
        };
        let sheet = Sheet { head: vec!["id", "rooms"], rows: vec![cells("a-long-one", &["x", "y"]), cells("b", &[])] };
        assert_eq!(sheet.text(), "id          rooms\na-long-one  x, y\nb\n");
    }
}
