//! What can be wrong with a model.

use crate::kit::ShapeError;

/// Why a model has no mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ModelError {
    /// A part's shape has no surface.
    #[error("model `{model}`, part {part}: {source}")]
    Shape {
        /// The model.
        model: String,
        /// The part, from 1.
        part: usize,
        /// What is wrong.
        source: ShapeError,
    },
    /// A colour is not one.
    #[error("model `{model}`, part {part}: `{color}` is no colour; write `#rrggbb`, `tint` or `fluid`")]
    Color {
        /// The model.
        model: String,
        /// The part, from 1.
        part: usize,
        /// What stands there.
        color: String,
    },
    /// A class's tint is not a colour.
    #[error("object `{class}`: its tint `{color}` is no colour; write `#rrggbb`")]
    Tint {
        /// The class.
        class: String,
        /// What stands there.
        color: String,
    },
    /// A part names a joint that its model lacks.
    #[error("model `{model}`, part {part}: there is no joint `{joint}`")]
    NoJoint {
        /// The model.
        model: String,
        /// The part, from 1.
        part: usize,
        /// The joint it names.
        joint: String,
    },
    /// A joint is carried by none that comes before it.
    #[error("model `{model}`: joint `{joint}` is carried by `{parent}`, which is no joint before it")]
    NoParent {
        /// The model.
        model: String,
        /// The joint.
        joint: String,
        /// What it names.
        parent: String,
    },
    /// A model has more than a mesh can hold.
    #[error("model `{model}` has {count} {what}; {most} at most")]
    TooMany {
        /// The model.
        model: String,
        /// Parts, joints, or copies of a part.
        what: &'static str,
        /// How many.
        count: usize,
        /// How many are allowed.
        most: usize,
    },
}
