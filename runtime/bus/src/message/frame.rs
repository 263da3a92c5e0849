//! A camera's frame: a header and up to four planes, all of the same tick, in one sample.

use bytemuck::{Pod, Zeroable};

use super::Malformed;

/// One kind of picture.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Plane {
    /// `[height, width, 4]` `u8`: red, green, blue, 255.
    Color,
    /// `[height, width]` `f32`: metres along the camera's z.
    Depth,
    /// `[height, width, 4]` `i8`: the surface's normal in the world, x, y, z times 127, and 0.
    Normals,
    /// `[height, width]` `u32`: the instance's id + 1; 0 is nothing, from `1 << 24` on it is a room's floor or walls.
    Ids,
}

impl Plane {
    /// All planes, in the order of the bits of [`FrameHeader::planes`] and of their place in the sample.
    pub const ALL: [Self; 4] = [Self::Color, Self::Depth, Self::Normals, Self::Ids];

    /// Bytes a pixel: the same for all.
    pub const BYTES: usize = 4;
}

/// What stands before the planes; one cache line and a half, padded to two.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct FrameHeader {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Which planes follow: bit `i` for `Plane::ALL[i]`.
    pub planes: u32,
    /// The body it belongs to.
    pub body: u32,
    /// The camera's position in the world, m.
    pub position_m: [f32; 3],
    /// Its yaw in the world, rad.
    pub yaw_rad: f32,
    /// Its pitch, rad, up positive.
    pub pitch_rad: f32,
    /// Its vertical field of view, rad.
    pub fov_y_rad: f32,
    /// What it took to render, ns of wall time.
    pub render_nanos: u64,
    /// The latest command that had begun to move the body when this was seen; 0 is none.
    pub command: u64,
    /// When the world was in this state, [`monotonic_nanos`](crate::monotonic_nanos).
    pub seen_nanos: u64,
    /// Zero.
    pub reserved: [u64; 8],
}

const _: () = assert!(size_of::<FrameHeader>() == 128);

/// Where the planes of a frame lie.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct FrameLayout {
    width: u32,
    height: u32,
    planes: u32,
}

impl FrameLayout {
    /// The layout of a frame of that size with those planes.
    #[must_use]
    pub fn new(width: u32, height: u32, planes: &[Plane]) -> Self {
        let planes = planes.iter().fold(0, |bits, plane| bits | 1 << (*plane as u32));
        Self { width, height, planes }
    }

    const fn plane_bytes(self) -> usize {
        (self.width as usize * self.height as usize * Plane::BYTES).next_multiple_of(64)
    }

    /// Bytes of the whole payload.
    #[must_use]
    pub const fn bytes(self) -> usize {
        size_of::<FrameHeader>() + self.plane_bytes() * self.planes.count_ones() as usize
    }

    /// The bits of [`FrameHeader::planes`].
    #[must_use]
    pub const fn plane_bits(self) -> u32 {
        self.planes
    }

    /// Splits a payload into its header and its planes, in the order of [`Plane::ALL`]; those that are not there are
    /// `None`.
    ///
    /// # Panics
    /// When `payload` is not [`Self::bytes`] long.
    pub fn split_mut(self, payload: &mut [u8]) -> (&mut FrameHeader, [Option<&mut [u8]>; 4]) {
        let (header, mut rest) = payload.split_at_mut(size_of::<FrameHeader>());
        let pixels = self.width as usize * self.height as usize * Plane::BYTES;
        let planes = std::array::from_fn(|index| {
            if self.planes & (1 << index) == 0 {
                return None;
            }
            let (plane, after) = std::mem::take(&mut rest).split_at_mut(self.plane_bytes());
            rest = after;
            Some(&mut plane[..pixels])
        });
        (bytemuck::from_bytes_mut(header), planes)
    }
}

/// A frame as received.
#[derive(Clone, Copy, Debug)]
pub struct FrameView<'a> {
    /// What stands before the planes.
    pub header: &'a FrameHeader,
    planes: &'a [u8],
}

impl<'a> FrameView<'a> {
    /// Views a payload in place.
    ///
    /// # Errors
    /// [`Malformed`].
    pub fn new(payload: &'a [u8]) -> Result<Self, Malformed> {
        let header = payload.get(..size_of::<FrameHeader>()).ok_or(Malformed("no frame header"))?;
        let header: &FrameHeader = bytemuck::try_from_bytes(header).map_err(|_| Malformed("off its boundary"))?;
        if header.width > 16_384 || header.height > 16_384 {
            return Err(Malformed("a frame of more than 16384 pixels a side"));
        }
        let layout = FrameLayout { width: header.width, height: header.height, planes: header.planes & 0b1111 };
        if payload.len() != layout.bytes() {
            return Err(Malformed("not the length of its planes"));
        }
        Ok(Self { header, planes: &payload[size_of::<FrameHeader>()..] })
    }

    /// The bytes of a plane, row-major, if the frame has it.
    #[must_use]
    pub fn plane(&self, plane: Plane) -> Option<&'a [u8]> {
        let bits = self.header.planes;
        let bit = 1 << plane as u32;
        if bits & bit == 0 {
            return None;
        }
        let layout = FrameLayout { width: self.header.width, height: self.header.height, planes: bits };
        let start = (bits & (bit - 1)).count_ones() as usize * layout.plane_bytes();
        let pixels = self.header.width as usize * self.header.height as usize * Plane::BYTES;
        Some(&self.planes[start..start + pixels])
    }

    /// Depths, m.
    #[must_use]
    pub fn depth_m(&self) -> Option<&'a [f32]> {
        self.plane(Plane::Depth).map(bytemuck::cast_slice)
    }

    /// Instance ids.
    #[must_use]
    pub fn ids(&self) -> Option<&'a [u32]> {
        self.plane(Plane::Ids).map(bytemuck::cast_slice)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Block;

    #[test]
    fn planes_are_found_where_they_were_written() {
        let layout = FrameLayout::new(5, 3, &[Plane::Color, Plane::Ids]);
        let mut blocks = vec![Block::default(); Block::count_for(layout.bytes())];
        let payload = &mut bytemuck::cast_slice_mut(&mut blocks)[..layout.bytes()];
        let (header, [color, depth, normals, ids]) = layout.split_mut(payload);
        *header = FrameHeader { width: 5, height: 3, planes: layout.plane_bits(), ..FrameHeader::default() };
        assert!(depth.is_none() && normals.is_none());
        color.unwrap().fill(7);
        bytemuck::cast_slice_mut::<u8, u32>(ids.unwrap()).fill(9);
        let view = FrameView::new(payload).unwrap();
        assert_eq!(view.plane(Plane::Color).unwrap(), [7; 60]);
        assert_eq!(view.ids().unwrap(), [9; 15]);
        assert!(view.depth_m().is_none());
        assert!(FrameView::new(&payload[..payload.len() - 64]).is_err());
    }
}
