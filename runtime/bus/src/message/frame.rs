//! A camera's frame: a header, up to four planes and a table of what is seen, all of the same tick, in one sample.
//!
//! A frame holds one picture or, of a panorama, four: every plane then has the pictures one after the other. The
//! header says where in the payload each part begins.

use bytemuck::{Pod, Zeroable};
use cohabit_cdf::{BodyId, ObjectId, room::MOST_ROOMS};

use super::Malformed;

/// One kind of picture.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Plane {
    /// `[views, height, width, 4]` `u8`: red, green, blue, 255.
    Color,
    /// `[views, height, width]` `f32`: metres along the camera's z.
    Depth,
    /// `[views, height, width, 4]` `i8`: the surface's normal in the world, x, y, z times 127, and 0.
    Normals,
    /// `[views, height, width]` `u32`: 0 is nothing; all else is read by [`Thing::of_id`].
    Ids,
}

impl Plane {
    /// All planes, in the order of the bits of [`FrameHeader::planes`] and of their place in the sample.
    pub const ALL: [Self; 4] = [Self::Color, Self::Depth, Self::Normals, Self::Ids];

    /// Bytes a pixel: the same for all.
    pub const BYTES: usize = 4;

    /// As options call it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Color => "color",
            Self::Depth => "depth",
            Self::Normals => "normals",
            Self::Ids => "ids",
        }
    }
}

/// What stands before the planes: two cache lines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct FrameHeader {
    /// Pixels across, of one picture.
    pub width: u32,
    /// Pixels down, of one picture.
    pub height: u32,
    /// Which planes follow: bit `i` for `Plane::ALL[i]`.
    pub planes: u32,
    /// The body it belongs to, or [`NONE`](super::NONE).
    pub body: u32,
    /// The camera's position in the world, m.
    pub position_m: [f32; 3],
    /// Its yaw in the world, rad; that of the first picture. Each further one looks 90 degrees more to the right.
    pub yaw_rad: f32,
    /// Its pitch, rad, up positive.
    pub pitch_rad: f32,
    /// Its vertical field of view, rad.
    pub fov_y_rad: f32,
    /// What it took to render, together with what was rendered along with it, ns of wall time.
    pub render_nanos: u64,
    /// The latest command that had begun to move the body when this was seen; 0 is none.
    pub command: u64,
    /// When the world was in this state, [`monotonic_nanos`](crate::monotonic_nanos).
    pub seen_nanos: u64,
    /// Pictures: 1, or 4 of a panorama: ahead, to the right, back, to the left.
    pub views: u32,
    /// Things seen, in all pictures together.
    pub seen: u32,
    /// Where each plane begins in the payload, bytes; 0 where it is absent.
    pub plane_at: [u32; 4],
    /// Where the table of what is seen begins in the payload, bytes; 0 where there is none.
    pub seen_at: u32,
    /// How many records the table has room for.
    pub seen_room: u32,
    /// Zero.
    pub reserved: [u64; 4],
}

const _: () = assert!(size_of::<FrameHeader>() == 128);

/// A thing that is seen in a picture.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct SeenRecord {
    /// Its id in the id plane.
    pub id: u32,
    /// Pixels that show it.
    pub pixels: u32,
    /// Its `SemanticClass`'s index.
    pub class: u16,
    /// The picture, counted from 0.
    pub view: u16,
    /// The first column that shows it.
    pub left: u16,
    /// The first row.
    pub top: u16,
    /// The column after the last.
    pub right: u16,
    /// The row after the last.
    pub bottom: u16,
    /// Zero.
    pub reserved: u32,
}

const _: () = assert!(size_of::<SeenRecord>() == 24);

/// What an id of the id plane stands for.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Thing {
    /// An object.
    Object(ObjectId),
    /// A robot or a person.
    Body(BodyId),
    /// A floor, a wall or another part of the room with this index.
    Surface(u32),
    /// Nothing that is known.
    Nothing,
}

impl Thing {
    /// The id of the first body; those of objects are below.
    pub const FIRST_BODY: u32 = 1 << 20;
    /// The id of the first room's surface: 256 a room; those of bodies are below.
    pub const FIRST_SURFACE: u32 = 1 << 24;

    /// The thing with this id.
    #[must_use]
    pub fn of_id(id: u32) -> Self {
        match id {
            0 => Self::Nothing,
            _ if id < Self::FIRST_BODY => Self::Object(ObjectId(id - 1)),
            _ if id < Self::FIRST_SURFACE => Self::Body(BodyId(id - Self::FIRST_BODY)),
            _ => match (id - Self::FIRST_SURFACE) >> 8 {
                room if (room as usize) < MOST_ROOMS => Self::Surface(room),
                _ => Self::Nothing,
            },
        }
    }
}

/// Where the parts of a frame lie.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct FrameLayout {
    width: u32,
    height: u32,
    views: u32,
    planes: u32,
    seen_room: u32,
}

/// The parts of a frame, to be written.
#[derive(Debug)]
pub struct FrameParts<'a> {
    /// What stands before the planes; its width, height, planes and places are set.
    pub header: &'a mut FrameHeader,
    /// The planes in the order of [`Plane::ALL`]; those that are not there are `None`.
    pub planes: [Option<&'a mut [u8]>; 4],
    /// Room for what is seen, zeroed.
    pub seen: &'a mut [SeenRecord],
}

impl FrameLayout {
    /// The layout of a frame of `views` pictures of that size with those planes, and a table of at most `seen_room`
    /// things seen.
    #[must_use]
    pub fn new(width: u32, height: u32, views: u32, planes: &[Plane], seen_room: u32) -> Self {
        let planes = planes.iter().fold(0, |bits, plane| bits | 1 << (*plane as u32));
        Self { width, height, views, planes, seen_room }
    }

    const fn of(header: &FrameHeader) -> Self {
        let FrameHeader { width, height, views, planes, seen_room, .. } = *header;
        Self { width, height, views, planes: planes & 0b1111, seen_room }
    }

    const fn pixels(self) -> usize {
        self.width as usize * self.height as usize * self.views as usize
    }

    const fn plane_bytes(self) -> usize {
        (self.pixels() * Plane::BYTES).next_multiple_of(64)
    }

    const fn seen_at(self) -> usize {
        size_of::<FrameHeader>() + self.plane_bytes() * self.planes.count_ones() as usize
    }

    /// Bytes of the whole payload.
    #[must_use]
    pub const fn bytes(self) -> usize {
        self.seen_at() + size_of::<SeenRecord>() * self.seen_room as usize
    }

    fn plane_at(self) -> [u32; 4] {
        std::array::from_fn(|index| {
            let before = (self.planes & ((1 << index) - 1)).count_ones() as usize;
            let at = size_of::<FrameHeader>() + before * self.plane_bytes();
            if self.planes & 1 << index == 0 { 0 } else { u32::try_from(at).unwrap_or(0) }
        })
    }

    /// Splits a payload into its parts.
    ///
    /// # Panics
    /// When `payload` is not [`Self::bytes`] long.
    pub fn split_mut(self, payload: &mut [u8]) -> FrameParts<'_> {
        let (header, mut rest) = payload.split_at_mut(size_of::<FrameHeader>());
        let planes = std::array::from_fn(|index| {
            if self.planes & (1 << index) == 0 {
                return None;
            }
            let (plane, after) = std::mem::take(&mut rest).split_at_mut(self.plane_bytes());
            rest = after;
            Some(&mut plane[..self.pixels() * Plane::BYTES])
        });
        let seen: &mut [SeenRecord] = bytemuck::cast_slice_mut(rest);
        seen.fill(SeenRecord::default());
        let header: &mut FrameHeader = bytemuck::from_bytes_mut(header);
        let at = u32::try_from(self.seen_at()).unwrap_or(0);
        *header = FrameHeader {
            width: self.width,
            height: self.height,
            planes: self.planes,
            views: self.views,
            plane_at: self.plane_at(),
            seen_at: if self.seen_room == 0 { 0 } else { at },
            seen_room: self.seen_room,
            ..FrameHeader::default()
        };
        FrameParts { header, planes, seen }
    }
}

/// A frame as received.
#[derive(Clone, Copy, Debug)]
pub struct FrameView<'a> {
    /// What stands before the planes: a copy, so that what was checked stays as it was whatever is written there later.
    pub header: FrameHeader,
    payload: &'a [u8],
}

impl<'a> FrameView<'a> {
    /// Views a payload in place.
    ///
    /// # Errors
    /// [`Malformed`].
    pub fn new(payload: &'a [u8]) -> Result<Self, Malformed> {
        let header = payload.get(..size_of::<FrameHeader>()).ok_or(Malformed("no frame header"))?;
        let header: &FrameHeader = bytemuck::try_from_bytes(header).map_err(|_| Malformed("off its boundary"))?;
        // Read once and for all: another process may write there meanwhile.
        let header = *header;
        if header.width > 16_384 || header.height > 16_384 || header.views > 16 {
            return Err(Malformed("a frame of more than 16384 pixels a side, or of more than 16 pictures"));
        }
        let layout = FrameLayout::of(&header);
        if payload.len() != layout.bytes() {
            return Err(Malformed("not the length of its parts"));
        }
        let seen_at = if header.seen_room == 0 { 0 } else { layout.seen_at() };
        if header.plane_at != layout.plane_at() || header.seen_at as usize != seen_at {
            return Err(Malformed("its parts are not where they should be"));
        }
        if header.seen > header.seen_room {
            return Err(Malformed("more things seen than there is room for"));
        }
        Ok(Self { header, payload })
    }

    /// The bytes of a plane, row-major, if the frame has it.
    #[must_use]
    pub fn plane(&self, plane: Plane) -> Option<&'a [u8]> {
        let at = self.header.plane_at[plane as usize] as usize;
        (at > 0).then(|| &self.payload[at..at + FrameLayout::of(&self.header).pixels() * Plane::BYTES])
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

    /// What is seen, by picture, then by id; nothing where the frame has no ids.
    #[must_use]
    pub fn seen(&self) -> &'a [SeenRecord] {
        let records = &self.payload[FrameLayout::of(&self.header).seen_at()..];
        bytemuck::cast_slice(&records[..self.header.seen as usize * size_of::<SeenRecord>()])
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::Block;

    #[test]
    fn parts_are_found_where_they_were_written() {
        let layout = FrameLayout::new(5, 3, 2, &[Plane::Color, Plane::Ids], 4);
        let mut blocks = vec![Block([0xAA; 64]); Block::count_for(layout.bytes())];
        let payload = &mut bytemuck::cast_slice_mut(&mut blocks)[..layout.bytes()];
        let FrameParts { header, planes: [color, depth, normals, ids], seen } = layout.split_mut(payload);
        assert!(depth.is_none() && normals.is_none());
        color.unwrap().fill(7);
        bytemuck::cast_slice_mut::<u8, u32>(ids.unwrap()).fill(9);
        let record = SeenRecord { id: 9, pixels: 15, view: 1, right: 5, bottom: 3, ..SeenRecord::default() };
        assert_eq!(seen.len(), 4);
        seen[0] = record;
        header.seen = 1;
        let view = FrameView::new(payload).unwrap();
        assert_eq!(view.plane(Plane::Color).unwrap(), [7; 120]);
        assert_eq!(view.ids().unwrap(), [9; 30]);
        assert_eq!(view.seen(), [record]);
        assert!(view.depth_m().is_none());
        assert!(FrameView::new(&payload[..payload.len() - 64]).is_err());
    }

    /// What programs in other languages read by: a change of any of these needs a new version of the messages.
    #[test]
    fn records_lie_as_they_always_did() {
        use std::mem::offset_of;
        let header = [
            offset_of!(FrameHeader, width),
            offset_of!(FrameHeader, planes),
            offset_of!(FrameHeader, body),
            offset_of!(FrameHeader, position_m),
            offset_of!(FrameHeader, fov_y_rad),
            offset_of!(FrameHeader, render_nanos),
            offset_of!(FrameHeader, seen_nanos),
            offset_of!(FrameHeader, views),
            offset_of!(FrameHeader, seen),
            offset_of!(FrameHeader, plane_at),
            offset_of!(FrameHeader, seen_at),
            offset_of!(FrameHeader, seen_room),
        ];
        assert_eq!(header, [0, 8, 12, 16, 36, 40, 56, 64, 68, 72, 88, 92]);
        let seen = [
            offset_of!(SeenRecord, id),
            offset_of!(SeenRecord, pixels),
            offset_of!(SeenRecord, class),
            offset_of!(SeenRecord, view),
            offset_of!(SeenRecord, left),
            offset_of!(SeenRecord, bottom),
        ];
        assert_eq!(seen, [0, 4, 8, 10, 12, 18]);
    }

    #[test]
    fn nonsense_is_refused() {
        let layout = FrameLayout::new(4, 4, 1, &Plane::ALL, 2);
        let mut blocks = vec![Block::default(); Block::count_for(layout.bytes())];
        let payload = &mut bytemuck::cast_slice_mut(&mut blocks)[..layout.bytes()];
        let spoil = |payload: &mut [u8], change: fn(&mut FrameHeader)| {
            change(layout.split_mut(payload).header);
            FrameView::new(payload).is_err()
        };
        assert!(!spoil(payload, |_| ()));
        assert!(spoil(payload, |header| header.plane_at[1] += 64));
        assert!(spoil(payload, |header| header.seen_at = 64));
        assert!(spoil(payload, |header| header.seen = 3));
        assert!(spoil(payload, |header| header.seen_room = u32::MAX));
        assert!(spoil(payload, |header| header.views = 2));
        assert!(spoil(payload, |header| header.planes = 1));
    }
}
