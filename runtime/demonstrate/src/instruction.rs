//! Instructions for steps, from templates.

use std::collections::BTreeMap;

use cohabit_cdf::{ActionKind, ObjectId};
use cohabit_world::World;

/// Ways to ask for a step: `{}` is the step in plain words, such as `open the fridge`.
const STYLES: [(&str, &str); 4] =
    [("plain", "{}"), ("polite", "please {}"), ("question", "could you {}?"), ("need", "I need you to {}")];

/// A step in all styles, by the style's name. It is as people would say it before it is done.
pub(crate) fn in_all_styles(world: &World, kind: ActionKind, id: ObjectId) -> BTreeMap<&'static str, String> {
    let plain = cohabit_generate::instruction(world, kind, id);
    STYLES.iter().map(|(name, template)| (*name, template.replace("{}", &plain))).collect()
}
