//! What is told of each of many worlds: the arrays that there are, and what is written into their rows.

use bytemuck::NoUninit;
use cohabit_bus::message::Plane;
use cohabit_cdf::StateFlag;

use crate::{
    choice::Choice,
    frame::{Frame, item_of},
    senses::Sensed,
};

/// Goals that an observation tells of.
pub const MOST_GOALS: usize = 16;

/// One array, of a row for each world.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Part {
    Plane(Plane),
    Position,
    Heading,
    Room,
    Held,
    Busy,
    Goals,
    SlotIds,
    SlotClasses,
    SlotPositions,
    SlotStates,
    Masks,
    Affordances,
    Tick,
    Score,
    Reward,
    Terminated,
    Truncated,
}

/// The sizes of rows.
#[derive(Clone, Copy, Debug)]
pub struct Sizes {
    /// Pictures of a frame: 1, or 4 of a panorama.
    pub views: usize,
    /// Pixels down.
    pub height: usize,
    /// Pixels across.
    pub width: usize,
    /// Slots of a body.
    pub slots: usize,
}

/// What came of a world's turn, besides what its body senses.
#[derive(Clone, Debug, Default)]
pub struct Told {
    pub tick: u64,
    pub score: u32,
    pub reward: f64,
    pub terminated: bool,
    pub truncated: bool,
    /// Whether each goal is met.
    pub goals: Vec<bool>,
    /// What came of the command, if it ended.
    pub status: String,
    pub detail: String,
    pub ending: &'static str,
}

/// All that rows are written from.
#[derive(Clone, Copy)]
pub struct Shown<'a> {
    pub frame: Option<&'a Frame>,
    pub sensed: &'a Sensed,
    pub told: &'a Told,
}

impl Part {
    /// All but planes.
    pub const SMALL: [Self; 17] = [
        Self::Position,
        Self::Heading,
        Self::Room,
        Self::Held,
        Self::Busy,
        Self::Goals,
        Self::SlotIds,
        Self::SlotClasses,
        Self::SlotPositions,
        Self::SlotStates,
        Self::Masks,
        Self::Affordances,
        Self::Tick,
        Self::Score,
        Self::Reward,
        Self::Terminated,
        Self::Truncated,
    ];

    /// What Python calls it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Plane(plane) => plane.name(),
            Self::Position => "position",
            Self::Heading => "heading",
            Self::Room => "room",
            Self::Held => "held",
            Self::Busy => "busy",
            Self::Goals => "goals",
            Self::SlotIds => "slot_ids",
            Self::SlotClasses => "slot_classes",
            Self::SlotPositions => "slot_positions",
            Self::SlotStates => "slot_states",
            Self::Masks => "action_masks",
            Self::Affordances => "affordances",
            Self::Tick => "tick",
            Self::Score => "score",
            Self::Reward => "reward",
            Self::Terminated => "terminated",
            Self::Truncated => "truncated",
        }
    }

    /// The type of an item, as numpy writes it.
    pub const fn item(self) -> &'static str {
        match self {
            Self::Plane(plane) => item_of(plane),
            Self::Position | Self::Heading | Self::SlotPositions => "<f4",
            Self::Room | Self::Held | Self::Busy | Self::SlotClasses | Self::Tick | Self::Score => "<i8",
            Self::Goals | Self::SlotStates | Self::Affordances => "|i1",
            Self::SlotIds => "<u4",
            Self::Masks | Self::Terminated | Self::Truncated => "|b1",
            Self::Reward => "<f8",
        }
    }

    /// The shape of a row.
    pub fn row(self, sizes: Sizes) -> Vec<usize> {
        let Sizes { views, height, width, slots } = sizes;
        let choices = Choice::all().count();
        match self {
            Self::Plane(plane) => {
                let mut shape = if views == 1 { vec![height, width] } else { vec![views, height, width] };
                if matches!(plane, Plane::Color | Plane::Normals) {
                    shape.push(4);
                }
                shape
            }
            Self::Position => vec![3],
            Self::Heading => vec![2],
            Self::Goals => vec![MOST_GOALS],
            Self::SlotIds | Self::SlotClasses => vec![slots],
            Self::SlotPositions => vec![slots, 3],
            Self::SlotStates => vec![slots, StateFlag::ALL.len()],
            Self::Masks => vec![choices + slots],
            Self::Affordances => vec![choices, slots],
            _ => Vec::new(),
        }
    }

    /// The bytes of a row.
    pub fn bytes(self, sizes: Sizes) -> usize {
        // The last character says how many an item has.
        let item = self.item().bytes().last().map_or(0, |digit| usize::from(digit - b'0'));
        self.row(sizes).into_iter().product::<usize>() * item
    }

    /// Writes a row, which is as long as [`Self::bytes`] says.
    pub fn write(self, row: &mut [u8], shown: Shown<'_>) {
        let Shown { frame, sensed, told } = shown;
        let body = &sensed.body;
        match self {
            Self::Plane(plane) => {
                if let Some(frame) = frame {
                    frame.copy_plane(plane, row);
                }
            }
            Self::Position => put(row, &body.position_m),
            Self::Heading => put(row, &[body.yaw_rad, body.head_pitch_rad]),
            Self::Room => put(row, &[i64::from(body.room)]),
            Self::Held => put(row, &[sensed.held_class]),
            Self::Busy => put(row, &[i64::from(body.busy)]),
            Self::Goals => fill(row, told.goals.iter().copied()),
            Self::SlotIds => put(row, &sensed.ids),
            Self::SlotClasses => put(row, &sensed.classes),
            Self::SlotPositions => put(row, &sensed.positions_m),
            Self::SlotStates => put(row, &sensed.flags),
            Self::Masks => fill(row, sensed.choices().chain(sensed.slots())),
            Self::Affordances => put(row, &sensed.afforded),
            Self::Tick => put(row, &[told.tick.cast_signed()]),
            Self::Score => put(row, &[i64::from(told.score)]),
            Self::Reward => put(row, &[told.reward]),
            Self::Terminated => fill(row, [told.terminated]),
            Self::Truncated => fill(row, [told.truncated]),
        }
    }
}

fn put<T: NoUninit>(row: &mut [u8], items: &[T]) {
    row.copy_from_slice(bytemuck::cast_slice(items));
}

/// A byte each; what there is more room for is 0.
fn fill(row: &mut [u8], truths: impl IntoIterator<Item = bool>) {
    row.fill(0);
    row.iter_mut().zip(truths).for_each(|(byte, truth)| *byte = u8::from(truth));
}
