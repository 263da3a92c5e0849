//! A floor plan while it is drawn: what of it can be shown, and all that is wrong with it.

use super::{PackError, limits, rooms};
use crate::{
    catalog::Catalog,
    layout::{Layout, LayoutFault},
};

/// A floor plan of a world pack that need not be whole yet.
#[derive(Debug, Default)]
pub struct PlanDraft {
    /// The plan, if its text can be read.
    pub layout: Option<Layout>,
    /// Why no world would take it; of rooms without a way into them `faults` tells.
    pub errors: Vec<PackError>,
    /// What people and robots would miss in it; nothing, while there are errors.
    pub faults: Vec<LayoutFault>,
}

impl PlanDraft {
    /// Looks over the plan `id` as `text` of its `file` has it, whatever the catalogue has of it.
    #[must_use]
    pub fn read(id: &str, file: &str, text: &str, catalog: &Catalog) -> Self {
        // With numbers that are none, the floor would have no end.
        let errors = limits::check_numbers(file, text);
        if !errors.is_empty() {
            return Self { errors, ..Self::default() };
        }
        let layout = match Layout::draft(id, file, text, catalog) {
            Ok(layout) => layout,
            Err(error) => return Self { errors: vec![error.into()], ..Self::default() },
        };
        let mut errors = rooms::check_plan(file, &layout, catalog.rooms());
        errors.extend(limits::check_shape(file, &layout));
        let faults = if errors.is_empty() { layout.faults(catalog) } else { Vec::new() };
        Self { layout: Some(layout), errors, faults }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn a_plan_is_shown_with_what_is_wrong_in_it() {
        let catalog = Catalog::builtin();
        let file = crate::world_pack::template("my-lab").into_iter().find(|(path, _)| *path == "layouts/Workshop.toml");
        // The room of its own is one that is built in, so that no pack is needed.
        let text = file.unwrap().1.replace("Workshop", "Lab1").replace("Degreaser_01_1", "Microwave_01_1");
        let read = |text: &str| PlanDraft::read("Plan", "my-lab/layouts/Plan.toml", text, &catalog);
        let whole = read(&text);
        assert!(whole.errors.is_empty() && whole.faults.is_empty(), "{whole:?}");
        let apart = read(
            &text.replace("door = \"Door_01_1\", between = [\"Lab1\", \"Hallway\"]", "between = [\"Lab1\", \"Lab1\"]"),
        );
        assert!(apart.layout.is_some() && apart.errors.is_empty() && !apart.faults.is_empty(), "{apart:?}");
        for (broken, is_shown, said) in [
            ("room = [", false, "Plan.toml"),
            ("wall_height_m = nan", false, "wall_height_m"),
            ("", true, "room: there is none"),
            ("base = \"OfficeLayout1\"\nwall_height_m = 9.0", true, "from 2 to 6 m"),
        ] {
            let draft = read(broken);
            assert_eq!(draft.layout.is_some(), is_shown, "{broken}");
            assert!(draft.errors[0].to_string().contains(said) && draft.faults.is_empty(), "{draft:?}");
        }
        assert!(read("base = \"OfficeLayout1\"").errors.is_empty());
    }
}
