//! What became of a house.

use std::{collections::BTreeMap, fmt};

use serde::Serialize;

/// Why an object of a house is not in its floor plan.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Reason {
    /// No class stands for its type.
    NoClass,
    /// It is in no room of the floor plan.
    OutsideRooms,
    /// There is no room for it near its place.
    NoSpace,
    /// Where there is room for it, it would stand in the way.
    InTheWay,
    /// What it is on is not in the floor plan.
    NoHolder,
    /// What it is on has no free place for it.
    HolderFull,
}

/// Objects of one type that are not in a floor plan.
#[derive(Clone, Debug, Eq, PartialEq, Serialize)]
pub struct LeftOut {
    /// Their type in AI2-THOR.
    #[serde(rename = "type")]
    pub kind: String,
    /// Why.
    pub reason: Reason,
    /// How many.
    pub count: usize,
}

/// What became of a house.
#[derive(Clone, Debug, Default, Eq, PartialEq, Serialize)]
pub struct Report {
    /// Rooms.
    pub rooms: usize,
    /// Doors, passages and doors to the outside.
    pub doors: usize,
    /// Windows.
    pub windows: usize,
    /// Objects that are there.
    pub placed: usize,
    /// Those of them that stand elsewhere than in the house, by 0.25 m or a quarter turn.
    pub moved: usize,
    /// Objects that are not there.
    pub left_out: Vec<LeftOut>,
    /// What else differs from the house.
    pub notes: Vec<String>,
}

impl Reason {
    const fn text(self) -> &'static str {
        match self {
            Self::NoClass => "no class stands for it",
            Self::OutsideRooms => "in no room of the floor plan",
            Self::NoSpace => "no room near its place",
            Self::InTheWay => "in the way",
            Self::NoHolder => "what it is on is left out",
            Self::HolderFull => "no free place on what it is on",
        }
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.text())
    }
}

impl fmt::Display for LeftOut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}: {}", self.count, self.kind, self.reason)
    }
}

/// Objects as they are placed and left out.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    pub placed: usize,
    pub moved: usize,
    left_out: BTreeMap<(String, Reason), usize>,
}

impl Tally {
    /// One object is left out.
    pub fn leave_out(&mut self, kind: &str, reason: Reason) {
        *self.left_out.entry((kind.to_owned(), reason)).or_default() += 1;
    }

    /// One object is placed.
    pub fn place(&mut self, is_moved: bool) {
        self.placed += 1;
        self.moved += usize::from(is_moved);
    }

    /// The same with those of another room.
    pub fn add(&mut self, other: Self) {
        self.placed += other.placed;
        self.moved += other.moved;
        for (key, count) in other.left_out {
            *self.left_out.entry(key).or_default() += count;
        }
    }

    /// All that is left out.
    pub fn left_out(&self) -> Vec<LeftOut> {
        let one = |((kind, reason), count): (&(String, Reason), &usize)| LeftOut {
            kind: kind.clone(),
            reason: *reason,
            count: *count,
        };
        self.left_out.iter().map(one).collect()
    }
}
