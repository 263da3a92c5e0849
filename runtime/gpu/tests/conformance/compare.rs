//! Two pictures, pixel by pixel.

use cohabit_render::{Camera, Planes};

/// Share of pixels that may show something else: those on edges.
const MOST_OTHER_IDS: f64 = 0.005;
/// How far depths may be apart where ids are the same, m.
const MOST_DEPTH_M: f32 = 0.01;
/// Share of such pixels that may be farther apart: edges between surfaces of one thing.
const MOST_OTHER_DEPTHS: f64 = 0.002;
/// How far normals' bytes may be apart where ids and depths are the same, on average.
const MOST_NORMAL: f64 = 0.5;
/// How far colours may be apart, on average.
const MOST_COLOR: f64 = 3.0;

/// All planes of one picture.
#[derive(Debug, PartialEq)]
pub struct Picture {
    pub color: Vec<u8>,
    pub depth_m: Vec<f32>,
    pub normals: Vec<i8>,
    pub ids: Vec<u32>,
}

/// How two pictures differ.
#[derive(Clone, Copy, Debug, Default)]
pub struct Difference {
    /// Share of pixels with different ids.
    pub other_ids: f64,
    /// Share of the others that are deeper or less deep.
    pub other_depths: f64,
    /// Mean difference of normals.
    pub normal: f64,
    /// Mean difference of colours.
    pub color: f64,
}

impl Difference {
    pub fn is_small(&self) -> bool {
        self.other_ids <= MOST_OTHER_IDS
            && self.other_depths <= MOST_OTHER_DEPTHS
            && self.normal <= MOST_NORMAL
            && self.color <= MOST_COLOR
    }

    pub fn max(self, other: Self) -> Self {
        Self {
            other_ids: self.other_ids.max(other.other_ids),
            other_depths: self.other_depths.max(other.other_depths),
            normal: self.normal.max(other.normal),
            color: self.color.max(other.color),
        }
    }
}

impl Picture {
    pub fn new(camera: &Camera) -> Self {
        let pixels = camera.pixels();
        Self {
            color: vec![0; pixels * 4],
            depth_m: vec![0.0; pixels],
            normals: vec![0; pixels * 4],
            ids: vec![0; pixels],
        }
    }

    pub fn planes(&mut self) -> Planes<'_> {
        Planes {
            color: Some(&mut self.color),
            depth_m: Some(&mut self.depth_m),
            normals: Some(&mut self.normals),
            ids: Some(&mut self.ids),
        }
    }

    pub fn compare(&self, expected: &Self) -> Difference {
        let pixels = self.ids.len();
        let (mut other_ids, mut other_depths, mut normal, mut same) = (0_u32, 0_u32, 0_u32, 0_u32);
        for at in 0..pixels {
            if self.ids[at] != expected.ids[at] {
                other_ids += 1;
                continue;
            }
            if (self.depth_m[at] - expected.depth_m[at]).abs() > MOST_DEPTH_M {
                other_depths += 1;
                continue;
            }
            let four = at * 4..at * 4 + 4;
            let pairs = self.normals[four.clone()].iter().zip(&expected.normals[four]);
            normal += pairs.map(|(a, b)| u32::from(a.abs_diff(*b))).sum::<u32>();
            same += 1;
        }
        let color: u64 = self.color.iter().zip(&expected.color).map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
        Difference {
            other_ids: f64::from(other_ids) / pixels as f64,
            other_depths: f64::from(other_depths) / pixels as f64,
            normal: f64::from(normal) / f64::from(same.max(1)) / 3.0,
            color: color as f64 / pixels as f64 / 3.0,
        }
    }
}
