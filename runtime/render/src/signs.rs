//! Signs of states: shapes that are drawn around an object because of a state that its own model does not show.

use cohabit_cdf::StateFlag;
use cohabit_cdf::model::When;
use glam::{Mat3, Vec3};

use crate::mesh::Aabb;
use crate::rig::phase;

/// Where a sign is, and how large, in the box of its object. Signs are modelled in a box that is 1 m wide and high.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Fit {
    /// As large as the box, along each of the object's axes, but never flat.
    Around,
    /// Upon the box, about as wide as it.
    Above,
    /// On the floor around the box, as wide as it.
    Foot,
    /// Hovers above the box, of a size that can be read.
    Badge,
    /// Hangs on the front of the box, of the same size; through it, if it is as thin as a door.
    Front,
}

/// One state and what shows it.
#[derive(Debug)]
pub(crate) struct Sign {
    pub flag: StateFlag,
    /// Models that show the state in this way need no sign.
    pub unless: Option<When>,
    /// Models of `signs.toml`, one after the other.
    pub frames: &'static [&'static str],
    /// How many of them a second.
    pub per_s: f32,
    pub fit: Fit,
}

const STILL: Sign = Sign { flag: StateFlag::Hot, unless: None, frames: &[], per_s: 0.0, fit: Fit::Around };

/// All signs.
pub(crate) const SIGNS: [Sign; 14] = [
    Sign { flag: StateFlag::Hot, unless: Some(When::Hot), frames: &["steam"], fit: Fit::Above, ..STILL },
    Sign { flag: StateFlag::Cold, unless: Some(When::Cold), frames: &["frost"], ..STILL },
    Sign { flag: StateFlag::Sparking, frames: &["bolts_1", "bolts_2", "bolts_3", "bolts_4"], per_s: 11.0, ..STILL },
    Sign { flag: StateFlag::Overloaded, frames: &["overload_1", "overload_2"], per_s: 2.5, fit: Fit::Badge, ..STILL },
    Sign { flag: StateFlag::Infected, unless: Some(When::Infected), frames: &["virus"], fit: Fit::Badge, ..STILL },
    Sign { flag: StateFlag::Broken, unless: Some(When::Broken), frames: &["cracks"], ..STILL },
    Sign { flag: StateFlag::Dirty, unless: Some(When::Dirty), frames: &["grime"], fit: Fit::Foot, ..STILL },
    Sign { flag: StateFlag::Eaten, unless: Some(When::Eaten), frames: &["crumbs"], fit: Fit::Foot, ..STILL },
    Sign { flag: StateFlag::Toggled, unless: Some(When::On), frames: &["lamp"], fit: Fit::Badge, ..STILL },
    Sign { flag: StateFlag::Embiggenated, frames: &["growth"], fit: Fit::Foot, ..STILL },
    Sign { flag: StateFlag::Wet, frames: &["drops"], fit: Fit::Foot, ..STILL },
    Sign { flag: StateFlag::Creased, frames: &["creases"], ..STILL },
    Sign { flag: StateFlag::Folded, frames: &["folds"], ..STILL },
    Sign { flag: StateFlag::Locked, frames: &["padlock"], fit: Fit::Front, ..STILL },
];

impl Sign {
    /// Which of its frames is shown at a time.
    pub(crate) fn frame(&self, nanos: u64) -> usize {
        if self.frames.len() < 2 {
            return 0;
        }
        let each = self.per_s / self.frames.len() as f32;
        ((phase(nanos, each) * self.frames.len() as f32) as usize).min(self.frames.len() - 1)
    }
}

impl Fit {
    /// From the sign's frame to the world. `own` is the object's box in its own frame, turned by `rotation` (which may
    /// scale it) and moved by `offset`; `over` is a box around that in the world.
    pub(crate) fn place(self, own: Aabb, rotation: Mat3, offset: Vec3, over: Aabb) -> (Mat3, Vec3) {
        let wide = over.size().x.max(over.size().y);
        let top = over.center().with_z(over.max.z);
        match self {
            Self::Around => {
                let size = own.size();
                let least = size.max_element() * 0.22;
                let scale = size.max(Vec3::splat(least.max(0.02)));
                let foot = own.center().with_z(own.min.z);
                (rotation * Mat3::from_diagonal(scale), rotation * foot + offset)
            }
            Self::Above => {
                let wide = wide.clamp(0.06, 0.6);
                let scale = Vec3::new(wide, wide, (wide * 1.1).clamp(0.1, 0.45));
                (Mat3::from_diagonal(scale), top)
            }
            Self::Foot => {
                let foot = own.center().with_z(own.min.z);
                let wide = own.size().x.max(own.size().y);
                (rotation * Mat3::from_diagonal(Vec3::splat(wide)), rotation * foot + offset)
            }
            Self::Badge => {
                let wide = (wide * 0.5).clamp(0.07, 0.22);
                (Mat3::from_diagonal(Vec3::splat(wide)), top + Vec3::Z * (wide * 0.25))
            }
            Self::Front => {
                const THIN_M: f32 = 0.25;
                let size = own.size();
                let side = (size.y.min(size.z) * 0.3).clamp(0.04, 0.16);
                let (deep, x) = if size.x < THIN_M {
                    (size.x + side * 0.5, own.center().x)
                } else {
                    (side * 0.4, own.max.x + side * 0.2)
                };
                let place = Vec3::new(x, own.center().y, own.min.z + size.z * 0.5 - side * 0.5);
                (rotation * Mat3::from_diagonal(Vec3::new(deep, side, side)), rotation * place + offset)
            }
        }
    }
}
