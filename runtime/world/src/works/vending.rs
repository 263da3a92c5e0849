//! Vending machines: slots behind glass, one a button, and a tray behind a flap.
//!
//! The slots are the anchors of the machine's last surface, in the order of its buttons; the tray is its first.

use std::ops::Range;

use cohabit_cdf::ObjectId;

use crate::{
    anchors::{anchors, free_anchors},
    effect::{Effect, Spot},
    entity::Support,
    facts::Facts,
};

/// The anchors of a machine that are slots; none for what does not vend.
fn slots(facts: &Facts<'_>, machine: ObjectId) -> Range<usize> {
    let class = facts.class(machine);
    let surfaces = class.receptacle.as_ref().map_or(&[][..], |kind| &kind.surfaces);
    match surfaces {
        [_, .., last] if facts.catalog.table().device(&class.id).slots => {
            let total = anchors(facts, machine).len();
            total.saturating_sub((last.anchors[0] * last.anchors[1]) as usize)..total
        }
        _ => 0..0,
    }
}

/// Whether an anchor is behind the glass of a vending machine.
pub(crate) fn is_slot(facts: &Facts<'_>, machine: ObjectId, anchor: u16) -> bool {
    slots(facts, machine).contains(&usize::from(anchor))
}

/// The vending machine in whose slot an object stands: no hand gets at it there.
pub(crate) fn behind_glass(facts: &Facts<'_>, id: ObjectId) -> Option<ObjectId> {
    let whole = std::iter::once(id).chain(facts.state.ancestors(id));
    whole.into_iter().find_map(|id| match facts.object(id).support {
        Support::On { parent, anchor: Some(anchor), .. } => is_slot(facts, parent, anchor).then_some(parent),
        _ => None,
    })
}

/// What is in a slot.
pub(crate) fn vended(facts: &Facts<'_>, machine: ObjectId, slot: u16) -> Option<ObjectId> {
    let wanted = slots(facts, machine).nth(usize::from(slot))?;
    facts.state.children(machine).find(|child| {
        matches!(facts.object(*child).support, Support::On { anchor: Some(anchor), .. } if usize::from(anchor) == wanted)
    })
}

/// What is in the slot falls into the tray, if that has room.
pub(crate) fn vend(facts: &Facts<'_>, machine: ObjectId, slot: u16) -> Option<Effect> {
    let object = vended(facts, machine, slot)?;
    let free = free_anchors(facts, machine).into_iter();
    let tray = free.map(|anchor| anchor.index).find(|anchor| !is_slot(facts, machine, *anchor))?;
    Some(Effect::Put { object, spot: Spot::Anchor { parent: machine, anchor: tray } })
}
