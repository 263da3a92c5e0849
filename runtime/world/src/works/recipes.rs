//! What becomes of what, as tables of classes: what is cut off, printed, restored.

use cohabit_cdf::{Catalog, ClassId};

/// What comes off when something is cut.
const SLICES: &[(&str, &str)] =
    &[("BreadLoaf", "BreadSlice_01"), ("Cake_02", "CakeSlice_02"), ("PieFruit_01", "PieFruitSlice_01")];

/// What a cartridge prints, where the mission does not say.
const PRINTS: &[(&str, &str)] = &[
    ("Printer_Cartridge", "CoffeeMug_Yellow"),
    ("Printer_Cartridge_Figure", "ActionFigure"),
    ("Printer_Cartridge_Hammer", "Hammer"),
    ("Printer_Cartridge_Lever", "FuseBox_01_Lever"),
    ("Printer_Cartridge_Mug", "CoffeeMug_Yellow"),
];

/// What broken, used up and cooked kinds of things were yesterday, where the mission does not say.
const YESTERDAY: &[(&str, &str)] = &[
    ("CanSodaNew_Crushed_01", "CanSodaNew_01"),
    ("CanSodaNew_Open_01", "CanSodaNew_01"),
    ("Computer_Monitor_Broken", "Computer_Monitor_New"),
    ("DeskFan_Broken_01", "DeskFan_New_01"),
    ("Floppy_AntiVirus_Broken", "Floppy_AntiVirus"),
    ("Floppy_Virus_Broken", "Floppy_Virus"),
    ("Laser_Tip_Broken", "Laser_Tip"),
    ("PaperCup_Crushed_01", "PaperCup_01"),
    ("Radio_01_Broken", "Radio_01"),
    ("Toast_01", "BreadSlice_01"),
    ("Toast_02", "BreadSlice_01"),
    ("Toast_03", "BreadSlice_01"),
    ("Toast_04", "BreadSlice_01"),
];

fn made(table: &[(&str, &str)], catalog: &Catalog, from: ClassId) -> Option<ClassId> {
    let from = &catalog.class(from).id;
    table.iter().find(|(known, _)| known == from).and_then(|(_, product)| catalog.find(product))
}

/// The class of a slice cut off something.
pub(crate) fn slice(catalog: &Catalog, whole: ClassId) -> Option<ClassId> {
    made(SLICES, catalog, whole)
}

/// The class that a cartridge prints by itself; none for what is no cartridge.
pub(crate) fn printed(catalog: &Catalog, cartridge: ClassId) -> Option<ClassId> {
    made(PRINTS, catalog, cartridge)
}

/// The class that something was of yesterday, by its own class.
pub(crate) fn yesterday(catalog: &Catalog, today: ClassId) -> Option<ClassId> {
    made(YESTERDAY, catalog, today)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tables_name_classes_of_the_catalogue() {
        let catalog = Catalog::builtin();
        for (from, to) in SLICES.iter().chain(PRINTS).chain(YESTERDAY) {
            assert!(catalog.find(from).is_some(), "{from}");
            assert!(catalog.find(to).is_some(), "{to}");
        }
    }
}
