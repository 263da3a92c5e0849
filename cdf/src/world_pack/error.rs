//! Why a world pack is refused.

use std::fmt;

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

/// All that is wrong with world packs, as far as it can be read: one error at least. Each begins a line when printed.
#[derive(Debug)]
pub struct PackErrors(Vec<PackError>);

impl PackErrors {
    /// The value, if nothing is wrong.
    pub(super) fn none_or<T>(value: T, errors: Vec<PackError>) -> Result<T, Self> {
        if errors.is_empty() { Ok(value) } else { Err(Self(errors)) }
    }

    /// The errors.
    pub fn iter(&self) -> std::slice::Iter<'_, PackError> {
        self.0.iter()
    }
}

impl From<PackError> for PackErrors {
    fn from(error: PackError) -> Self {
        Self(vec![error])
    }
}

impl fmt::Display for PackErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // What is said of a file that is no TOML shows its line, and ends with the end of one.
        let texts: Vec<String> = self.0.iter().map(|error| error.to_string().trim_end().to_owned()).collect();
        f.write_str(&texts.join("\n"))
    }
}

impl std::error::Error for PackErrors {}
