//! What is asked of an import.

use cohabit_cdf::{Property, catalog::Stands};

use crate::{
    error::GltfError,
    frame::{Front, Size, Up},
};

/// The most triangles that may be asked for: as many as world packs allow.
pub const MOST_TRIANGLES: usize = 20_000;
/// How many triangles an object has at most, unless told otherwise: as many as nearly all built-in ones.
pub const USUAL_TRIANGLES: usize = 1500;

/// What is asked of an import.
#[derive(Clone, Debug)]
pub struct Options {
    /// The id of the new class.
    pub id: String,
    /// The name that people read; made from the id, if absent.
    pub name: Option<String>,
    /// What people say besides.
    pub words: Vec<String>,
    /// What it affords.
    pub properties: Vec<Property>,
    /// How large it is.
    pub size: Size,
    /// Which axis of the file points up.
    pub up: Up,
    /// Where its front looks.
    pub front: Front,
    /// Its mass, kg; from its volume, if absent.
    pub mass_kg: Option<f32>,
    /// Where it is found; from its properties and its height, if absent.
    pub stands: Option<Stands>,
    /// How many triangles it has at most.
    pub triangles: usize,
    /// Where triangles meet at less than this, degrees, they look round; what meshes have, if absent.
    pub smooth_deg: Option<f32>,
    /// Whether the colour that covers the most can be changed.
    pub tint: bool,
}

impl Options {
    /// The usual ones for a class of this id.
    #[must_use]
    pub fn new(id: &str) -> Self {
        Self {
            id: id.to_owned(),
            name: None,
            words: Vec::new(),
            properties: Vec::new(),
            size: Size::OfFile,
            up: Up::Y,
            front: Front::MinusY,
            mass_kg: None,
            stands: None,
            triangles: USUAL_TRIANGLES,
            smooth_deg: None,
            tint: false,
        }
    }

    /// Whether all of it can be.
    pub(crate) fn check(&self) -> Result<(), GltfError> {
        let refused = |reason: String| Err(GltfError::Options(reason));
        let is_id = |c: char| c.is_ascii_alphanumeric() || c == '_';
        if self.id.is_empty() || self.id.len() > 64 || !self.id.chars().all(is_id) {
            return refused(format!("`{}` is no id: write letters, digits and `_`, 64 at most", self.id));
        }
        let is_line = |text: &str| !text.trim().is_empty() && text.len() <= 128 && !text.chars().any(char::is_control);
        if let Some(text) = self.name.iter().chain(&self.words).find(|text| !is_line(text)) {
            return refused(format!("`{}` is no name: write one line of at most 128 bytes", text.escape_debug()));
        }
        if !(4..=MOST_TRIANGLES).contains(&self.triangles) {
            return refused(format!("{} triangles: write from 4 to {MOST_TRIANGLES}", self.triangles));
        }
        let lengths = match self.size {
            Size::OfFile => Vec::new(),
            Size::Sides(sides) => sides.to_vec(),
            Size::Height(height) => vec![height],
        };
        if let Some(length) = lengths.iter().find(|length| !(0.001..=10.0).contains(*length)) {
            return refused(format!("{length} m is no length of an object: write from 0.001 to 10"));
        }
        if let Some(mass) = self.mass_kg.filter(|mass| !(0.001..=5000.0).contains(mass)) {
            return refused(format!("{mass} kg is no mass of an object: write from 0.001 to 5000"));
        }
        if let Some(angle) = self.smooth_deg.filter(|angle| !(0.0..=180.0).contains(angle)) {
            return refused(format!("{angle} is no angle: write degrees from 0 to 180"));
        }
        Ok(())
    }

    /// The name that people read.
    pub(crate) fn shown_name(&self) -> String {
        let from_id = || {
            let words = self.id.split('_').filter(|word| !word.is_empty() && !word.chars().all(|c| c.is_ascii_digit()));
            let name = words.collect::<Vec<_>>().join(" ");
            if name.is_empty() { self.id.clone() } else { name }
        };
        self.name.as_deref().map_or_else(from_id, |name| name.trim().to_owned())
    }
}
