//! How an object looks, as data: a list of parts made from a small kit of shapes.
//!
//! A model is written in the object's own frame (see the crate's docs), in metres. The renderer turns it into a mesh
//! once; nothing here knows about triangles but those of meshes that are written out.

mod mesh;

use serde::{Deserialize, Serialize};

pub use mesh::{FARTHEST_M, MOST_POINTS, MOST_TRIANGLES, MeshError, check_mesh};

/// The looks of one class of object.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Model {
    /// The name by which objects refer to it.
    pub id: String,
    /// What it is made of, drawn in order.
    #[serde(rename = "part")]
    pub parts: Vec<Part>,
    /// The axes about which, or along which, its moving parts move.
    #[serde(default, rename = "joint", skip_serializing_if = "Vec::is_empty")]
    pub joints: Vec<Joint>,
}

/// One shape, placed, coloured, perhaps moving and perhaps shown in certain states alone.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Part {
    /// Its geometry.
    #[serde(flatten)]
    pub shape: Shape,
    /// Where the shape's own origin lies, in metres in the object's frame.
    #[serde(default)]
    pub at: [f32; 3],
    /// Rotation about x, then y, then z, in degrees, applied before `at`.
    #[serde(default)]
    pub turn_deg: [f32; 3],
    /// `#rrggbb`, or `tint`: the colour of the instance (what a colour changer changes).
    #[serde(default = "Part::default_color")]
    pub color: String,
    /// What it is made of: decides pattern and gloss.
    #[serde(default)]
    pub material: Material,
    /// How much of what is behind it a see-through material hides where it is looked at squarely, 0 to 1; the
    /// material's own, if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub opacity: Option<f32>,
    /// The joint that moves it, by name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joint: Option<String>,
    /// The state in which alone it is drawn; always, if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub when: Option<When>,
    /// Also drawn mirrored through the plane where this coordinate is zero.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mirror: Option<Axis>,
    /// Drawn `count` times in all, each moved on by `step` metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub repeat: Option<Repeat>,
}

impl Part {
    fn default_color() -> String {
        "#b0b0b0".to_owned()
    }
}

/// The kit. Every shape has its origin at the centre of its base, and its height along `z`, unless it says otherwise.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(tag = "shape", rename_all = "snake_case")]
pub enum Shape {
    /// A box of `size` `[x, y, z]` whose edges are rounded with radius `bevel`.
    Box {
        /// Full lengths, m.
        size: [f32; 3],
        /// Radius of the rounded edges, m; a sensible one is chosen if absent.
        #[serde(default)]
        bevel: Option<f32>,
    },
    /// A cylinder, or a cone frustum when `top_radius` is given.
    Cylinder {
        /// Radius at the base, m.
        radius: f32,
        /// Radius at the top, m.
        #[serde(default)]
        top_radius: Option<f32>,
        /// Length along z, m.
        height: f32,
        /// Radius of the rounded rims, m.
        #[serde(default)]
        bevel: Option<f32>,
    },
    /// An ellipsoid with its origin at its centre.
    Sphere {
        /// Half lengths along x, y, z, m.
        radii: [f32; 3],
    },
    /// A profile of `[radius, z]` points turned about z; the outline runs so that the outside lies to its right going up.
    Lathe {
        /// `[radius, z]`, m.
        profile: Vec<[f32; 2]>,
    },
    /// A round tube along a path through the points, open or closed.
    Tube {
        /// Points in the part's frame, m.
        path: Vec<[f32; 3]>,
        /// Radius of the tube, m.
        radius: f32,
        /// Whether the last point joins the first.
        #[serde(default)]
        closed: bool,
    },
    /// A simple polygon in the xy plane, counter-clockwise, pulled up along z by `height`.
    Extrude {
        /// `[x, y]`, m.
        outline: Vec<[f32; 2]>,
        /// Length along z, m.
        height: f32,
        /// Chamfer of the top and bottom edges, m.
        #[serde(default)]
        bevel: Option<f32>,
    },
    /// Letters standing on a vertical plane that faces `+x`; the origin is the middle of the text, unless it is written around
    /// something.
    Text {
        /// What it says; `\n` starts a new line.
        text: String,
        /// Height of a capital letter, m.
        height: f32,
        /// Written around an upright cylinder of this radius, m, whose axis passes through the origin.
        #[serde(default)]
        around: Option<f32>,
    },
    /// A flat line as a pen draws it, on a vertical plane that faces `+x`.
    Line {
        /// `[y, z]`, m.
        path: Vec<[f32; 2]>,
        /// How wide, m.
        width: f32,
        /// Whether the last point joins the first.
        #[serde(default)]
        closed: bool,
    },
    /// Triangles as they are, such as those of an imported model: see [`check_mesh`] for what they may be.
    Mesh {
        /// `[x, y, z]` in the part's frame, m.
        points: Vec<[f32; 3]>,
        /// Three indices of `points` each, from 0, counter-clockwise seen from outside.
        triangles: Vec<[u32; 3]>,
        /// Where triangles meet at less than this angle, degrees, they look round; 40, if absent.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        smooth_deg: Option<f32>,
    },
}

/// A surface's look beyond its colour.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, Hash, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Material {
    /// Matt and plain.
    #[default]
    Plain,
    /// Plastic: plain with a soft highlight.
    Plastic,
    /// Bare or painted metal: a sharper highlight.
    Metal,
    /// Wood, with grain along the longest side.
    Wood,
    /// Glass: bright highlight.
    Glass,
    /// Glazed: mugs, plates, sinks.
    Ceramic,
    /// Cloth and upholstery, with a fine weave.
    Fabric,
    /// Paper and cardboard.
    Paper,
    /// Shines by itself: screens, lamps, beams.
    Glow,
    /// Brick wall.
    Brick,
    /// Floor or wall tiles.
    Tile,
    /// Carpet.
    Carpet,
    /// Leaves.
    Leaf,
    /// Things to eat.
    Food,
    /// Clear glass: what is behind it shows through, tinted by its colour; it is what is pointed at.
    Clear,
    /// A clear fluid: hides more than glass does.
    Liquid,
    /// Steam, cold air, smoke: softest at its edges; what is behind it is what is pointed at.
    Mist,
    /// Light in the air: a beam, a flame, a swirl, with a bright core. As [`Self::Mist`] but for that it shines by itself.
    Beam,
}

/// A state that shows or hides a part.
#[derive(Clone, Copy, Debug, Deserialize, Eq, Hash, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum When {
    /// Toggled on.
    On,
    /// Not toggled on.
    Off,
    /// Broken.
    Broken,
    /// Not broken.
    Whole,
    /// Filled with anything; the part takes the fluid's colour where its `color` is `fluid`.
    Filled,
    /// Holds cereal.
    Cereal,
    /// Dirty.
    Dirty,
    /// Hot.
    Hot,
    /// Cold.
    Cold,
    /// Infected by a virus.
    Infected,
    /// Has power, or needs none.
    Powered,
    /// Without power.
    Unpowered,
    /// Cooked.
    Cooked,
    /// Not cooked.
    Raw,
    /// Eaten: what is left of it.
    Eaten,
    /// Not eaten.
    Uneaten,
    /// Cut with a knife.
    Cut,
    /// Not cut.
    Uncut,
    /// On, and leads to the past, or nowhere in particular.
    Past,
    /// On, and leads to the future.
    Future,
    /// Shows no feeling, or is not asked to show any.
    Neutral,
    /// Shows a happy face.
    Happy,
    /// Shows a sad face.
    Sad,
    /// Shows an angry face.
    Angry,
    /// Shows a scared face.
    Scared,
}

/// How a moving part moves as its object opens (0 closed, 1 open) or runs.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Joint {
    /// The name by which parts refer to it.
    pub id: String,
    /// What drives it.
    pub driven_by: Drive,
    /// A point on the axis, m, object frame.
    pub at: [f32; 3],
    /// Direction of the axis.
    pub axis: [f32; 3],
    /// Turned by this about the axis when fully driven, degrees.
    #[serde(default)]
    pub turn_deg: f32,
    /// Moved by this along the axis when fully driven, m.
    #[serde(default)]
    pub slide_m: f32,
    /// The joint that carries it, which must come before it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub parent: Option<String>,
    /// How it keeps moving while it is driven; it stays where it is driven to, if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cycle: Option<Cycle>,
}

/// A motion that repeats while its joint is driven.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Cycle {
    /// Which.
    pub way: CycleWay,
    /// How often a second.
    pub per_s: f32,
}

/// How a joint repeats its motion.
#[derive(Clone, Copy, Debug, Deserialize, Eq, Hash, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum CycleWay {
    /// Full turns about its axis, the other way round where `turn_deg` is negative.
    Around,
    /// To where it is driven, and back.
    BackAndForth,
    /// To where it is driven, then at once from the start again.
    OverAndOver,
}

/// What drives a joint from 0 to 1.
#[derive(Clone, Copy, Debug, Deserialize, Eq, Hash, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Drive {
    /// Opening and closing.
    Open,
    /// Toggling on and off.
    On,
}

/// A coordinate axis.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Axis {
    /// East, or an object's front.
    X,
    /// North, or an object's left.
    Y,
    /// Up.
    Z,
}

/// A part drawn several times in a row.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Repeat {
    /// How many in all.
    pub count: u32,
    /// From each to the next, m.
    pub step: [f32; 3],
}
