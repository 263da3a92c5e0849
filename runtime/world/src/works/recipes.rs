//! What becomes of what, by the recipes of the table: what is cut off, printed, restored.

use cohabit_cdf::{ActionTable, Catalog, ClassId};

/// The class of a slice cut off something.
pub(crate) fn slice(catalog: &Catalog, whole: ClassId) -> Option<ClassId> {
    made(catalog, whole, ActionTable::slice)
}

/// The class that a cartridge prints by itself; none for what is no cartridge.
pub(crate) fn printed(catalog: &Catalog, cartridge: ClassId) -> Option<ClassId> {
    made(catalog, cartridge, ActionTable::prints)
}

/// The class that something was of yesterday, by its own class.
pub(crate) fn yesterday(catalog: &Catalog, today: ClassId) -> Option<ClassId> {
    made(catalog, today, ActionTable::yesterday)
}

fn made(
    catalog: &Catalog,
    from: ClassId,
    recipe: for<'t> fn(&'t ActionTable, &str) -> Option<&'t str>,
) -> Option<ClassId> {
    recipe(catalog.table(), &catalog.class(from).id).and_then(|class| catalog.find(class))
}
