//! Least, greatest, mean and standard deviation of each feature, for `meta/stats.json`.

use std::collections::BTreeMap;

use cohabit_parquet::{Column, Values};
use serde_json::{Value, json};

use crate::picture::Pixels;

/// The sums of one number of a feature.
#[derive(Clone, Copy, Debug)]
struct Sums {
    least: f64,
    greatest: f64,
    sum: f64,
    squares: f64,
}

impl Sums {
    const NONE: Self = Self { least: f64::INFINITY, greatest: f64::NEG_INFINITY, sum: 0.0, squares: 0.0 };

    fn add(&mut self, value: f64) {
        self.least = self.least.min(value);
        self.greatest = self.greatest.max(value);
        self.sum += value;
        self.squares += value * value;
    }
}

/// The sums of a feature, number by number.
#[derive(Debug)]
struct Feature {
    sums: Vec<Sums>,
    /// How many values each number had.
    values: u64,
    /// How many frames they are of.
    frames: u64,
    is_picture: bool,
}

/// What is known of all features so far.
#[derive(Debug, Default)]
pub(crate) struct Stats(BTreeMap<String, Feature>);

impl Stats {
    /// Takes in the numbers of some rows; text has none, and pictures are taken in one by one.
    pub fn add_columns(&mut self, columns: &[Column<'_>]) {
        for column in columns {
            match &column.values {
                Values::Bool(values) => self.add_numbers(column.name, values.iter().map(|value| f64::from(*value))),
                Values::Long(values) => self.add_numbers(column.name, values.iter().map(|value| *value as f64)),
                Values::Float(values) => self.add_numbers(column.name, values.iter().map(|value| f64::from(*value))),
                Values::Vector(values) => values.iter().for_each(|value| self.add_vector(column.name, value)),
                // Frames have all of their values.
                Values::Text(_)
                | Values::Texts(_)
                | Values::Picture(_)
                | Values::MaybeBool(_)
                | Values::MaybeLong(_)
                | Values::MaybeDouble(_)
                | Values::MaybeText(_) => {}
            }
        }
    }

    /// Takes in a picture: shares of the full range for 8 bits, the numbers themselves for 16, as PyTorch's `ToTensor` has them.
    pub fn add_picture(&mut self, name: &str, pixels: &Pixels) {
        let (feature, count) = match pixels {
            Pixels::Rgb(pixels) => {
                let feature = self.feature(name, 3, true);
                for pixel in pixels {
                    feature.sums.iter_mut().zip(pixel).for_each(|(sums, side)| sums.add(f64::from(*side) / 255.0));
                }
                (feature, pixels.len())
            }
            Pixels::Gray(pixels) => {
                let feature = self.feature(name, 1, true);
                for pixel in pixels {
                    feature.sums.iter_mut().for_each(|sums| sums.add(f64::from(*pixel)));
                }
                (feature, pixels.len())
            }
        };
        feature.values += count as u64;
        feature.frames += 1;
    }

    fn add_numbers(&mut self, name: &str, values: impl Iterator<Item = f64>) {
        let feature = self.feature(name, 1, false);
        for value in values {
            feature.sums.iter_mut().for_each(|sums| sums.add(value));
            feature.values += 1;
            feature.frames += 1;
        }
    }

    fn add_vector(&mut self, name: &str, value: &[f32]) {
        let feature = self.feature(name, value.len(), false);
        feature.sums.iter_mut().zip(value).for_each(|(sums, number)| sums.add(f64::from(*number)));
        feature.values += 1;
        feature.frames += 1;
    }

    fn feature(&mut self, name: &str, width: usize, is_picture: bool) -> &mut Feature {
        let none = || Feature { sums: vec![Sums::NONE; width], values: 0, frames: 0, is_picture };
        self.0.entry(name.to_owned()).or_insert_with(none)
    }

    /// As LeRobot has them: a number for each of a vector's, `[[[number]]]` for each channel of a picture.
    pub fn json(&self) -> Value {
        let features = self.0.iter().map(|(name, feature)| (name.clone(), feature.json()));
        Value::Object(features.collect())
    }
}

impl Feature {
    fn json(&self) -> Value {
        let values = self.values as f64;
        let told = |number: &dyn Fn(&Sums) -> f64| -> Value {
            let one = |sums: &Sums| if self.is_picture { json!([[number(sums)]]) } else { json!(number(sums)) };
            self.sums.iter().map(one).collect()
        };
        let deviation = |sums: &Sums| {
            let mean = sums.sum / values;
            (sums.squares / values - mean * mean).max(0.0).sqrt()
        };
        json!({
            "min": told(&|sums| sums.least),
            "max": told(&|sums| sums.greatest),
            "mean": told(&|sums| sums.sum / values),
            "std": told(&deviation),
            "count": [self.frames],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stats_are_those_of_all_rows() {
        let mut stats = Stats::default();
        for rows in [vec![vec![1.0, 5.0]], vec![vec![2.0, 5.0], vec![3.0, 5.0]]] {
            stats.add_columns(&[Column { name: "action", values: Values::Vector(rows) }]);
        }
        let told = stats.json();
        assert_eq!(told["action"]["min"], json!([1.0, 5.0]));
        assert_eq!(told["action"]["max"], json!([3.0, 5.0]));
        assert_eq!(told["action"]["mean"], json!([2.0, 5.0]));
        assert_eq!(told["action"]["count"], json!([3]));
        let deviation = told["action"]["std"][0].as_f64().unwrap();
        assert!((deviation - (2.0_f64 / 3.0).sqrt()).abs() < 1e-12, "{told}");
    }

    #[test]
    fn pictures_have_a_number_for_each_channel() {
        let mut stats = Stats::default();
        stats.add_picture("color", &Pixels::Rgb(vec![[0, 255, 51], [255, 255, 51]]));
        stats.add_picture("depth", &Pixels::Gray(vec![1000, 3000]));
        let told = stats.json();
        assert_eq!(told["color"]["mean"], json!([[[0.5]], [[1.0]], [[0.2]]]));
        assert_eq!(told["depth"]["max"], json!([[[3000.0]]]));
        assert_eq!(told["depth"]["count"], json!([1]));
    }
}
