//! What classes of things are for.

use cohabit_cdf::{Catalog, ClassId};
use serde::Deserialize;

/// What classes are for: `data/uses.toml`.
#[derive(Clone, Debug)]
pub(crate) struct Uses(Vec<(ClassId, String)>);

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(rename = "use")]
    uses: Vec<Use>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Use {
    classes: Vec<String>,
    does: String,
}

impl Uses {
    /// The built-in table, as far as the catalogue has its classes.
    pub(crate) fn new(catalog: &Catalog) -> Self {
        let file: File = toml::from_str(include_str!("../../data/uses.toml"))
            .expect("invariant: the built-in table parses, the tests load it");
        let of_class = |entry: &Use| {
            let known = entry.classes.iter().filter_map(|id| catalog.find(id));
            known.map(|class| (class, entry.does.clone())).collect::<Vec<_>>()
        };
        Self(file.uses.iter().flat_map(of_class).collect())
    }

    pub(crate) fn of(&self, class: ClassId) -> Option<&str> {
        self.0.iter().find(|(used, _)| *used == class).map(|(_, does)| does.as_str())
    }
}
