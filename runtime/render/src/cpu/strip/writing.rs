//! What of a strip goes into the planes.

use super::{
    Out, Run, Strip,
    values::{LONG, rounded},
};
use crate::color;

impl Strip {
    #[inline(always)]
    pub(super) fn write_color(&self, out: &mut [[u8; 4]]) {
        let table = color::srgb_table();
        let mut steps = [[0_u32; LONG]; 3];
        for (steps, light) in steps.iter_mut().zip(&self.light) {
            for i in 0..LONG {
                steps[i] = color::step(light.0[i]);
            }
        }
        for (i, out) in out.iter_mut().enumerate().take(LONG) {
            let channel = |c: usize| table[steps[c][i] as usize & (table.len() - 1)];
            *out = [channel(0), channel(1), channel(2), 255];
        }
    }

    #[inline(always)]
    pub(super) fn write_normals(&self, out: &mut [[i8; 4]]) {
        let mut bytes = [0_u32; LONG];
        for i in 0..LONG {
            let byte = |value: f32| rounded(value * 127.0) & 0xFF;
            bytes[i] = byte(self.normal[0].0[i]) | byte(self.normal[1].0[i]) << 8 | byte(self.normal[2].0[i]) << 16;
        }
        for (out, bytes) in out.iter_mut().zip(bytes) {
            *out = bytes.to_le_bytes().map(|byte| byte as i8);
        }
    }
}

/// Says of pixels whose id they show.
#[inline(always)]
pub(super) fn write_id(out: &mut Out<'_>, run: Run, id: u32) {
    if let Some(ids) = &mut out.ids {
        ids[run.from..run.to].fill(id);
    }
}
