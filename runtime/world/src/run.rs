//! A machine at work for a moment: what it does, where, since when and for how long.

use cohabit_cdf::{Catalog, Color, ObjectId, catalog::table::Device};
use serde::{Deserialize, Serialize};

const TICKS_A_SECOND: f32 = 60.0;

/// Ticks from the start of a machine to its effect, and to its end.
pub(crate) fn ticks(device: &Device) -> [u64; 2] {
    [device.work_s, device.moment_s].map(|seconds| (seconds * TICKS_A_SECOND).round() as u64)
}

/// What a machine does.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub(crate) enum Work {
    /// Nothing but being on.
    Nothing,
    /// What can be heated gets hot.
    Heat,
    /// As [`Self::Heat`], and what can be cooked is cooked.
    Toast,
    /// What can be chilled gets cold.
    Chill,
    /// What is in it becomes what it was yesterday.
    Yesterday,
    /// What is in it becomes a carrot.
    Carrot,
    /// A cartridge makes its product, beside it.
    Print,
    /// What holds fluids gets hot coffee.
    Brew,
    /// Coffee becomes beans.
    Unbrew,
    /// What is in it takes a colour.
    Paint(Color),
    /// What is in it grows, or shrinks back.
    Embiggen,
    /// The object at this slot falls into the tray.
    Vend(u16),
    /// The work of this number in the table, which is none of those above.
    Listed(u16),
}

impl Work {
    /// The work of that name in the table.
    pub fn named(catalog: &Catalog, name: &str) -> Self {
        match name {
            "heat" => Self::Heat,
            "toast" => Self::Toast,
            "chill" => Self::Chill,
            "yesterday" => Self::Yesterday,
            "carrot" => Self::Carrot,
            "print" => Self::Print,
            "brew" => Self::Brew,
            "unbrew" => Self::Unbrew,
            "paint red" => Self::Paint(Color::Red),
            "paint green" => Self::Paint(Color::Green),
            "paint blue" => Self::Paint(Color::Blue),
            "embiggen" => Self::Embiggen,
            _ => {
                let slot = name.strip_prefix("vend ").and_then(|slot| slot.parse().ok());
                let listed = || catalog.table().works().iter().position(|work| work.name == name);
                let listed = || listed().and_then(|index| u16::try_from(index).ok());
                slot.map(Self::Vend).or_else(|| listed().map(Self::Listed)).unwrap_or(Self::Nothing)
            }
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
