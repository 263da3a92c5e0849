//! The places of receptacles: which are free, and what fits there.

use super::{Place, SymbolicState};
use crate::{
    action::ObjectId,
    catalog::{
        Surface,
        table::{View, takes},
    },
};

/// How much larger a thing may be than its place, m.
const SLACK_M: f32 = 1e-3;

/// One anchor of a receptacle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Anchor {
    pub index: u16,
    clearance_m: f32,
    width_m: f32,
}

impl SymbolicState {
    fn anchors(&self, receptacle: ObjectId) -> Vec<Anchor> {
        let Some(kind) = &self.class(receptacle).receptacle else { return Vec::new() };
        // What is behind a door fits in whole, or the door would not shut.
        let width = |surface: &Surface| {
            if kind.enclosed { surface.size_m[0].max(surface.size_m[1]) } else { f32::INFINITY }
        };
        let places = kind.surfaces.iter().flat_map(|surface| (0..count(surface)).map(move |_| surface));
        (0_u16..)
            .zip(places)
            .map(|(index, surface)| Anchor { index, clearance_m: surface.clearance_m, width_m: width(surface) })
            .collect()
    }

    /// The anchors where nothing stands.
    pub(super) fn free_anchors(&self, receptacle: ObjectId) -> Vec<Anchor> {
        let mut free = self.anchors(receptacle);
        for thing in &self.things {
            if let Place::On { parent, anchors, .. } = &thing.place
                && *parent == receptacle
            {
                free.retain(|anchor| !anchors.contains(&anchor.index));
            }
        }
        free
    }

    fn fits(&self, receptacle: ObjectId, size_m: [f32; 3], anchor: &Anchor) -> bool {
        let scale = self.thing(receptacle).scale;
        size_m[2] <= anchor.clearance_m * scale[2] + SLACK_M
            && size_m[0].min(size_m[1]) <= anchor.width_m * scale[0] + SLACK_M
    }

    /// A free anchor that fits something of that size, also such as hands do not reach.
    pub(super) fn any_place_for(&self, receptacle: ObjectId, size_m: [f32; 3]) -> Option<u16> {
        let free = self.free_anchors(receptacle);
        free.into_iter().find(|anchor| self.fits(receptacle, size_m, anchor)).map(|anchor| anchor.index)
    }

    /// The anchor at which a hand can put a thing: one of its own, where a receptacle is keyed.
    pub(super) fn place_for(&self, receptacle: ObjectId, thing: ObjectId) -> Option<u16> {
        let kind = self.class(receptacle).receptacle.as_ref()?;
        let class = &self.class(thing).id;
        if !takes(self.class(receptacle), class) {
            return None;
        }
        let mut free = self.free_anchors(receptacle);
        if kind.keys.is_empty() {
            let size = self.size_m(thing);
            free.retain(|anchor| !self.is_slot(receptacle, anchor.index) && self.fits(receptacle, size, anchor));
        } else if kind.keys.len() == self.anchors(receptacle).len() {
            free.retain(|anchor| kind.keys.get(usize::from(anchor.index)) == Some(class));
        }
        free.first().map(|anchor| anchor.index)
    }

    /// Notes that a thing was found in or on a receptacle. Which place it takes is not told: the first free one that fits.
    pub fn found_on(&mut self, thing: ObjectId, parent: ObjectId) {
        let anchors = self.place_for(parent, thing).into_iter().collect();
        self.things[thing.0 as usize].place = Place::On { parent, anchors, within: true };
    }

    /// How many things a hand can put into a receptacle while it is empty.
    #[must_use]
    pub fn capacity(&self, receptacle: ObjectId) -> usize {
        self.anchors(receptacle).iter().filter(|anchor| !self.is_slot(receptacle, anchor.index)).count()
    }

    /// Whether a hand could put a thing somewhere into a receptacle, were it empty.
    #[must_use]
    pub fn fits_anywhere(&self, receptacle: ObjectId, thing: ObjectId) -> bool {
        let keyed = self.class(receptacle).receptacle.as_ref().is_some_and(|kind| !kind.keys.is_empty());
        let size = self.size_m(thing);
        let fits = |anchor: &Anchor| keyed || self.fits(receptacle, size, anchor);
        self.anchors(receptacle).iter().any(|anchor| !self.is_slot(receptacle, anchor.index) && fits(anchor))
    }

    fn size_m(&self, id: ObjectId) -> [f32; 3] {
        let (size, scale) = (self.class(id).size_m, self.thing(id).scale);
        [0, 1, 2].map(|axis| size[axis] * scale[axis])
    }

    /// Whether an anchor is a slot behind glass.
    pub(super) fn is_slot(&self, receptacle: ObjectId, anchor: u16) -> bool {
        self.slots(receptacle).is_some_and(|first| anchor >= first)
    }

    /// The first slot of what has slots: its last surface has them all.
    fn slots(&self, receptacle: ObjectId) -> Option<u16> {
        let class = self.class(receptacle);
        let surfaces = &class.receptacle.as_ref()?.surfaces;
        match surfaces.as_slice() {
            [tray @ .., _] if !tray.is_empty() && self.catalog.table().device(&class.id).slots => {
                u16::try_from(tray.iter().map(count).sum::<u32>()).ok()
            }
            _ => None,
        }
    }

    /// Whether a thing stands in a slot.
    pub(super) fn is_in_slot(&self, id: ObjectId) -> bool {
        match &self.thing(id).place {
            Place::On { parent, anchors, .. } => anchors.iter().any(|anchor| self.is_slot(*parent, *anchor)),
            _ => false,
        }
    }

    /// What is in a slot of a vending machine.
    #[must_use]
    pub fn in_slot(&self, machine: ObjectId, slot: u16) -> Option<ObjectId> {
        let wanted = self.slots(machine)?.checked_add(slot)?;
        self.existing().find(|id| match &self.thing(*id).place {
            Place::On { parent, anchors, .. } => *parent == machine && anchors.contains(&wanted),
            _ => false,
        })
    }
}

fn count(surface: &Surface) -> u32 {
    surface.anchors[0] * surface.anchors[1]
}
