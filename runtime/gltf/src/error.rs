//! Why a file is not imported.

/// Why a file is not imported.
#[derive(Debug, thiserror::Error)]
pub enum GltfError {
    /// The bytes are no glTF.
    #[error("{reason}: {remedy}")]
    Container {
        /// What is wrong.
        reason: String,
        /// What would be right.
        remedy: &'static str,
    },
    /// A part of the document cannot be.
    #[error("{at}: {reason}")]
    Content {
        /// Where in the document, such as `accessors[3]`.
        at: String,
        /// What is wrong.
        reason: String,
    },
    /// The document needs an extension that is not imported.
    #[error(
        "the file requires the extension `{name}`, which is not imported: export it without that extension, as \
         uncompressed glTF 2.0"
    )]
    Extension {
        /// Which.
        name: String,
    },
    /// There is more of something than is read.
    #[error("{have} {what}: at most {most}: {remedy}")]
    TooMany {
        /// Of what.
        what: &'static str,
        /// How many there are.
        have: u64,
        /// How many are read.
        most: u64,
        /// What would be right.
        remedy: &'static str,
    },
    /// A file beside the document is not read.
    #[error("{at}: `{name}`: {reason}")]
    Beside {
        /// Where in the document.
        at: String,
        /// The name that stands there.
        name: String,
        /// Why.
        reason: String,
    },
    /// There is nothing to draw.
    #[error("there is no triangle in the default scene that has an area: {0}")]
    Empty(&'static str),
    /// The object is too large or too small.
    #[error("the object is {size} m large: {remedy}")]
    Size {
        /// Its sides.
        size: String,
        /// What would be right.
        remedy: &'static str,
    },
    /// Triangles could not be taken away without tearing the surface.
    #[error(
        "{have} triangles were left where at most {most} were asked for: ask for more by --triangles, or simplify the \
         model in the program that made it"
    )]
    Reduce {
        /// How many were left.
        have: usize,
        /// How many were asked for.
        most: usize,
    },
    /// What was asked for cannot be.
    #[error("{0}")]
    Options(String),
}

impl GltfError {
    /// A part of the document cannot be.
    pub(crate) fn at(at: impl Into<String>, reason: impl Into<String>) -> Self {
        Self::Content { at: at.into(), reason: reason.into() }
    }
}
