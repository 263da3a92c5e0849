//! Why a world pack is refused.

use super::MOST_PACKS;
use crate::{
    catalog::{CatalogError, table::TableError},
    layout::LayoutError,
};

/// Why a world pack is refused.
#[derive(Debug, thiserror::Error)]
pub enum PackError {
    /// The folder is no pack.
    #[error(
        "{root}: there is no `world.toml` in it: write one with name, version, licence and description; `cohabit new \
         world NAME` writes a whole pack"
    )]
    NoHead {
        /// The folder.
        root: String,
    },
    /// A file is not the TOML expected.
    #[error("{file}: {source}")]
    Syntax {
        /// Which file.
        file: String,
        /// Where and what.
        source: Box<toml::de::Error>,
    },
    /// Something in a file cannot be.
    #[error("{file}{at}: {reason}: {remedy}")]
    Content {
        /// Which file.
        file: String,
        /// Where in it, behind a colon; empty for the file itself.
        at: String,
        /// What is wrong.
        reason: String,
        /// What would be right.
        remedy: String,
    },
    /// Two files have something of one name.
    #[error("{second}: the {kind} `{id}` is in {first} already: give it another id; a pack adds, and replaces nothing")]
    Twice {
        /// What it is.
        kind: &'static str,
        /// Its id.
        id: String,
        /// The file that had it first.
        first: String,
        /// The other file.
        second: String,
    },
    /// There are too many packs.
    #[error("{packs} world packs: at most {MOST_PACKS}")]
    TooMany {
        /// How many.
        packs: usize,
    },
    /// Classes or models do not fit together.
    #[error(transparent)]
    Catalog(#[from] CatalogError),
    /// A device or a rule does not fit.
    #[error(transparent)]
    Table(#[from] TableError),
    /// A floor plan cannot be put together.
    #[error(transparent)]
    Layout(#[from] LayoutError),
}

impl PackError {
    /// Something in a file cannot be; `at` says where, and is empty for the file itself.
    pub(super) fn at(file: &str, at: &str, reason: String, remedy: &str) -> Self {
        let at = if at.is_empty() { String::new() } else { format!(": {at}") };
        Self::Content { file: file.to_owned(), at, reason, remedy: remedy.to_owned() }
    }
}
