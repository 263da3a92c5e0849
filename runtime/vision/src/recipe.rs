//! What a data set follows from, but for how many images it has.

use std::sync::Arc;

use cohabit_cdf::{Catalog, Layout};
use cohabit_render::Lens;
use serde_json::json;

use crate::error::VisionError;

/// What this format is called, with its version.
pub(crate) const FORMAT: &str = "cohabit vision 1";
/// The angle between the upper and the lower edge of pictures: that of robots' eyes, degrees.
const FOV_Y_DEG: f32 = 60.0;
/// The most bits of 64 that may differ in images that count as the same: images that have nothing to do with each other differ in
/// 32 of them, give or take 4.
const MOST_NEAR_BITS: u32 = 16;

/// What is left out.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Filters {
    /// Things of fewer visible pixels have no annotation.
    pub min_pixels: u32,
    /// Images with fewer annotations are drawn anew.
    pub min_things: usize,
    /// Images are drawn anew that look like an earlier one of the same room, but for so many of 64 bits.
    pub near_bits: u32,
}

/// Pixels below which nobody recognises a thing; three things; and what a small change of the camera makes of an image.
impl Default for Filters {
    fn default() -> Self {
        Self { min_pixels: 50, min_things: 3, near_bits: 4 }
    }
}

/// How images are made.
#[derive(Clone, Debug)]
pub struct Recipe {
    seed: u64,
    lens: Lens,
    plans: Vec<String>,
    filters: Filters,
    catalog: Arc<Catalog>,
}

impl Recipe {
    /// Image `i` follows from `seed + i`; pictures have `size` pixels across and down; floor plans are these of the world, or all
    /// if none is named.
    ///
    /// # Errors
    /// [`VisionError::Lens`], [`VisionError::NoSuchPlan`], [`VisionError::Near`].
    pub fn new(
        seed: u64,
        size: [u32; 2],
        plans: &[String],
        filters: Filters,
        catalog: &Arc<Catalog>,
    ) -> Result<Self, VisionError> {
        let lens = Lens::new(size[0], size[1], FOV_Y_DEG)?;
        let known = Layout::ids(catalog);
        if let Some(plan) = plans.iter().find(|plan| !known.contains(plan)) {
            return Err(VisionError::NoSuchPlan { plan: plan.clone(), known });
        }
        if filters.near_bits > MOST_NEAR_BITS {
            return Err(VisionError::Near { bits: filters.near_bits, most: MOST_NEAR_BITS });
        }
        // In the order of the world's plans, whatever order they were named in.
        let plans = known.into_iter().filter(|plan| plans.is_empty() || plans.contains(plan)).collect();
        Ok(Self { seed, lens, plans, filters, catalog: Arc::clone(catalog) })
    }

    /// The seed of an image.
    pub(crate) const fn seed_of(&self, index: usize) -> u64 {
        self.seed.wrapping_add(index as u64)
    }

    pub(crate) const fn seed(&self) -> u64 {
        self.seed
    }

    pub(crate) const fn lens(&self) -> Lens {
        self.lens
    }

    pub(crate) fn plans(&self) -> &[String] {
        &self.plans
    }

    pub(crate) const fn filters(&self) -> Filters {
        self.filters
    }

    pub(crate) const fn catalog(&self) -> &Arc<Catalog> {
        &self.catalog
    }

    /// What must be the same for two data sets to be the same, as far as the shorter one goes.
    pub(crate) fn text(&self) -> String {
        let Filters { min_pixels, min_things, near_bits } = self.filters;
        let mut recipe = json!({
            "format": FORMAT,
            "program": env!("CARGO_PKG_VERSION"),
            "seed": self.seed,
            "size": self.lens.size(),
            "fov_y_deg": self.lens.fov_y_deg(),
            "floor_plans": self.plans,
            "min_pixels": min_pixels,
            "min_things": min_things,
            "near_bits": near_bits,
        });
        if !self.catalog.packs().is_empty() {
            recipe["world"] = json!(self.catalog.packs());
        }
        format!("{recipe:#}\n")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_settings_are_named() {
        let plans = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
        let near = |near_bits| Filters { near_bits, ..Filters::default() };
        for (size, names, filters, expected) in [
            ([64, 64], &["OfficeLayout9"][..], near(4), "`OfficeLayout9`; there are OfficeLayout1,"),
            ([8, 64], &[], near(4), "8x64"),
            ([64, 64], &[], near(40), "at most 16"),
        ] {
            let error = Recipe::new(1, size, &plans(names), filters, &Arc::new(Catalog::builtin())).unwrap_err();
            assert!(error.to_string().contains(expected) && error.is_bad_input(), "{error}");
        }
    }

    #[test]
    fn plans_have_one_order() {
        let catalog = Arc::new(Catalog::builtin());
        let made = |names: [&str; 2]| {
            let recipe = Recipe::new(1, [64, 64], &names.map(str::to_owned), Filters::default(), &catalog);
            recipe.unwrap().text()
        };
        assert_eq!(made(["OfficeLayout3", "OfficeLayout1"]), made(["OfficeLayout1", "OfficeLayout3"]));
    }
}
