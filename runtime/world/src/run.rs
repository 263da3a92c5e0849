//! A machine at work for a moment: what it does, where, since when and for how long.

use cohabit_cdf::{
    ActionTable, Catalog, Color, ObjectId,
    catalog::table::{Device, Work as Entry},
};
use serde::{Deserialize, Serialize};

const TICKS_A_SECOND: f32 = 60.0;

/// Ticks from the start of a machine to its effect, and to its end.
pub(crate) fn ticks(device: &Device) -> [u64; 2] {
    [device.work_s, device.moment_s].map(|seconds| (seconds * TICKS_A_SECOND).round() as u64)
}

/// Which work a machine does, as snapshots and digests write it down. What it changes is the table's to say, by its name.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub(crate) enum Work {
    /// None: it is on, and that is all.
    Nothing,
    Heat,
    Toast,
    Chill,
    Yesterday,
    Carrot,
    Print,
    Brew,
    Unbrew,
    Paint(Color),
    Embiggen,
    /// `vend` of the slot of this number.
    Vend(u16),
    /// The work of this number in the table, which is none of those above.
    Listed(u16),
}

impl Work {
    /// The names of those that have a number of their own.
    const NAMES: [(Self, &'static str); 12] = [
        (Self::Heat, "heat"),
        (Self::Toast, "toast"),
        (Self::Chill, "chill"),
        (Self::Yesterday, "yesterday"),
        (Self::Carrot, "carrot"),
        (Self::Print, "print"),
        (Self::Brew, "brew"),
        (Self::Unbrew, "unbrew"),
        (Self::Paint(Color::Red), "paint red"),
        (Self::Paint(Color::Green), "paint green"),
        (Self::Paint(Color::Blue), "paint blue"),
        (Self::Embiggen, "embiggen"),
    ];

    /// The work of that name in the table.
    pub fn named(catalog: &Catalog, name: &str) -> Self {
        let known = Self::NAMES.iter().find(|(_, known)| *known == name).map(|(work, _)| *work);
        let slot = || name.strip_prefix("vend ").and_then(|slot| slot.parse().ok()).map(Self::Vend);
        let listed = || {
            let index = catalog.table().works().iter().position(|work| work.name == name)?;
            u16::try_from(index).ok().map(Self::Listed)
        };
        known.or_else(slot).or_else(listed).unwrap_or(Self::Nothing)
    }

    /// Its entry in the table.
    pub fn entry(self, table: &ActionTable) -> Option<&Entry> {
        match self {
            Self::Nothing => None,
            Self::Vend(slot) => table.work(&format!("vend {slot}")),
            Self::Listed(index) => table.works().get(usize::from(index)),
            _ => Self::NAMES.iter().find(|(work, _)| *work == self).and_then(|(_, name)| table.work(name)),
        }
    }
}

/// A machine at work for a moment.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct Run {
    /// The tick in which it came on.
    pub since: u64,
    pub work: Work,
    /// Where the work is done: the machine itself, or what it is aimed at.
    pub site: ObjectId,
    /// What is on for as long.
    pub drives: Option<ObjectId>,
}
