//! The categories of annotations: all classes of the catalogue, and groups of those that people call by one name.

use cohabit_cdf::{Catalog, ClassId, ObjectClass};
use serde::Serialize;
use serde_json::{Value, json};

/// One class, as COCO has it.
#[derive(Clone, Debug, Eq, PartialEq, Serialize)]
pub(crate) struct Category {
    pub id: u32,
    /// The id of its class, such as `AP_Prop_Desk_Blue`.
    pub name: String,
    /// What people call it: the name of its group, such as `Desk`.
    pub supercategory: String,
}

/// Where the groups are from.
const ORIGIN: &str = "classes that the catalogue of this project calls by one name; the 86 semantic classes that Alexa Arena's vision \
                      model was trained on are not published by name";

/// The category of a class: 0 is the background, as COCO has it.
pub(crate) fn category_id(class: ClassId) -> u32 {
    u32::from(class.0) + 1
}

/// All categories, by their ids.
pub(crate) fn categories(catalog: &Catalog) -> Vec<Category> {
    let classes = (0_u16..).zip(catalog.classes());
    let category = |(index, class): (u16, &ObjectClass)| Category {
        id: category_id(ClassId(index)),
        name: class.id.clone(),
        supercategory: if class.name.is_empty() { class.id.clone() } else { class.name.clone() },
    };
    classes.map(category).collect()
}

/// The groups as a document: of each its number, its name and its categories, in the order of their first categories.
pub(crate) fn groups(categories: &[Category]) -> Value {
    let mut groups: Vec<(&str, Vec<u32>)> = Vec::new();
    for Category { id, supercategory, .. } in categories {
        match groups.iter().position(|(name, _)| name == supercategory) {
            Some(known) => groups[known].1.push(*id),
            None => groups.push((supercategory.as_str(), vec![*id])),
        }
    }
    let groups = (1_u32..).zip(&groups);
    let groups: Vec<Value> =
        groups.map(|(id, (name, categories))| json!({ "id": id, "name": name, "categories": categories })).collect();
    json!({ "origin": ORIGIN, "groups": groups })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_class_is_a_category_of_one_group() {
        let categories = categories(&Catalog::builtin());
        assert_eq!(categories.len(), 336);
        assert!((1_u32..).zip(&categories).all(|(id, category)| category.id == id));
        let groups = groups(&categories);
        let groups = groups["groups"].as_array().unwrap();
        let members = |group: &Value| group["categories"].as_array().unwrap().clone();
        let mut all: Vec<u64> = groups.iter().flat_map(members).map(|id| id.as_u64().unwrap()).collect();
        all.sort_unstable();
        assert_eq!(all, (1..=336).collect::<Vec<u64>>());
        let desk = groups.iter().find(|group| group["name"] == "Desk").unwrap();
        assert!(desk["categories"].as_array().unwrap().len() > 1);
    }
}
