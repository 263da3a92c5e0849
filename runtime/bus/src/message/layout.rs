//! Lists of records, one behind the other in one payload.

use bytemuck::Pod;

use super::Malformed;

/// Writes parts one behind the other, each on an 8-byte boundary.
pub(super) struct Writer<'a> {
    rest: &'a mut [u8],
}

/// Reads what [`Writer`] wrote, in place.
pub(super) struct Reader<'a> {
    rest: &'a [u8],
}

/// Bytes that `count` records take.
pub(super) const fn space<T>(count: usize) -> usize {
    (size_of::<T>() * count).next_multiple_of(8)
}

impl<'a> Writer<'a> {
    pub(super) const fn new(bytes: &'a mut [u8]) -> Self {
        Self { rest: bytes }
    }

    pub(super) fn put<T: Pod>(&mut self, records: &[T]) {
        let (here, rest) = std::mem::take(&mut self.rest).split_at_mut(space::<T>(records.len()));
        let bytes = bytemuck::cast_slice(records);
        here[..bytes.len()].copy_from_slice(bytes);
        here[bytes.len()..].fill(0);
        self.rest = rest;
    }
}

impl<'a> Reader<'a> {
    pub(super) const fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    pub(super) fn take<T: Pod>(&mut self, count: u32) -> Result<&'a [T], Malformed> {
        let bytes = (count as usize).checked_mul(size_of::<T>()).ok_or(Malformed("a count too large"))?;
        let padded = bytes.next_multiple_of(8);
        let here = self.rest.get(..padded).ok_or(Malformed("shorter than its counts say"))?;
        self.rest = &self.rest[padded..];
        bytemuck::try_cast_slice(&here[..bytes]).map_err(|_| Malformed("records off their boundary"))
    }

    pub(super) fn one<T: Pod>(&mut self) -> Result<&'a T, Malformed> {
        self.take(1).map(|records| &records[0])
    }
}
