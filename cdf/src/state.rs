//! What can change about an object: flags, what fills it, its colour.

use serde::{Deserialize, Serialize};

/// One yes-or-no state of an object.
#[derive(Clone, Copy, Debug, Deserialize, Eq, Hash, Ord, PartialEq, PartialOrd, Serialize)]
#[repr(u8)]
pub enum StateFlag {
    /// In some body's hand now.
    PickedUp,
    /// Door, lid or drawer open.
    Opened,
    /// Broken.
    Broken,
    /// Switched on.
    Toggled,
    /// Fed by its circuit.
    Powered,
    /// Its terminal is locked until the room's power is cycled.
    Overloaded,
    /// Throws sparks: electrocutes who touches it.
    Sparking,
    /// Wants cleaning.
    Dirty,
    /// Only the time machine undoes this.
    Eaten,
    /// Heated.
    Hot,
    /// Chilled.
    Cold,
    /// Cooked: toast.
    Cooked,
    /// Cut with a knife.
    Cut,
    /// Carries a virus.
    Infected,
    /// Was scanned at least once.
    Scanned,
    /// Was examined at least once.
    Examined,
    /// Was used as a tool or machine at least once.
    Used,
    /// Made large by the embiggenator.
    Embiggenated,
    /// Does not open.
    Locked,
    /// Holds cereal.
    Cereal,
    /// Shows a face without feeling.
    Neutral,
    /// Shows a happy face.
    Happy,
    /// Shows a sad face.
    Sad,
    /// Shows an angry face.
    Angry,
    /// Shows a scared face.
    Scared,
    /// Wet through: laundry as it comes out of the wash.
    Wet,
    /// Creased: laundry that wants ironing.
    Creased,
    /// Folded.
    Folded,
}

impl StateFlag {
    /// All flags, in the order of their bits.
    pub const ALL: [Self; 28] = [
        Self::PickedUp,
        Self::Opened,
        Self::Broken,
        Self::Toggled,
        Self::Powered,
        Self::Overloaded,
        Self::Sparking,
        Self::Dirty,
        Self::Eaten,
        Self::Hot,
        Self::Cold,
        Self::Cooked,
        Self::Cut,
        Self::Infected,
        Self::Scanned,
        Self::Examined,
        Self::Used,
        Self::Embiggenated,
        Self::Locked,
        Self::Cereal,
        Self::Neutral,
        Self::Happy,
        Self::Sad,
        Self::Angry,
        Self::Scared,
        Self::Wet,
        Self::Creased,
        Self::Folded,
    ];

    /// The faces that are shown; an object shows one at a time.
    pub const MOODS: [Self; 5] = [Self::Neutral, Self::Happy, Self::Sad, Self::Angry, Self::Scared];

    /// Whether it is one of [`Self::MOODS`].
    #[must_use]
    pub fn is_mood(self) -> bool {
        Self::MOODS.contains(&self)
    }
}

/// A set of [`StateFlag`]s.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, Hash, PartialEq, Serialize)]
#[serde(transparent)]
#[repr(transparent)]
pub struct StateFlags(pub u32);

impl StateFlags {
    /// Whether `flag` is in the set.
    #[must_use]
    pub const fn has(self, flag: StateFlag) -> bool {
        self.0 & (1 << flag as u32) != 0
    }

    /// Puts `flag` in or takes it out.
    pub const fn set(&mut self, flag: StateFlag, value: bool) {
        if value {
            self.0 |= 1 << flag as u32;
        } else {
            self.0 &= !(1 << flag as u32);
        }
    }

    /// The set with `flag` in it.
    #[must_use]
    pub const fn with(mut self, flag: StateFlag) -> Self {
        self.set(flag, true);
        self
    }

    /// The flags of the set, in the order of their bits.
    pub fn iter(self) -> impl Iterator<Item = StateFlag> {
        StateFlag::ALL.into_iter().filter(move |flag| self.has(*flag))
    }
}

/// What a fillable object is filled with.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, Hash, PartialEq, Serialize)]
#[repr(u8)]
pub enum Fluid {
    /// Nothing.
    #[default]
    None,
    /// From a sink.
    Water,
    /// From the carton.
    Milk,
    /// From the coffee maker.
    Coffee,
}

impl Fluid {
    /// All fluids, `None` first.
    pub const ALL: [Self; 4] = [Self::None, Self::Water, Self::Milk, Self::Coffee];

    /// Its name in a mission file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "None",
            Self::Water => "Water",
            Self::Milk => "Milk",
            Self::Coffee => "Coffee",
        }
    }

    /// The fluid of that name, in any case.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|fluid| fluid.name().eq_ignore_ascii_case(name))
    }
}

/// A colour given by a mission or by the colour changer.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, Hash, PartialEq, Serialize)]
#[repr(u8)]
pub enum Color {
    /// As the catalogue has it.
    #[default]
    Original,
    /// Red.
    Red,
    /// Green.
    Green,
    /// Blue.
    Blue,
}

impl Color {
    /// All colours, `Original` first.
    pub const ALL: [Self; 4] = [Self::Original, Self::Red, Self::Green, Self::Blue];

    /// Its name in a mission file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Original => "Original",
            Self::Red => "Red",
            Self::Green => "Green",
            Self::Blue => "Blue",
        }
    }

    /// The colour of that name, in any case.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|color| color.name().eq_ignore_ascii_case(name))
    }
}
