//! Segments and their seals: what stands before a seal is as it was written, or is known not to be.
//!
//! A segment is what was appended between two flushes: whole MCAP records, and behind them one more, the seal, of a kind
//! that MCAP leaves to programs and other tools pass over. A seal holds its number, counted from 1, and the CRC-32 of
//! the seal before, of that seal's number and of the segment's bytes. So each byte and the order of segments are
//! checked, and what follows a damaged segment can still be trusted.

use std::ops::Range;

use crc32fast::Hasher;

/// The kind of record that a seal is.
pub(crate) const SEAL: u8 = 0x80;
/// The kind of the record that ends what happened; an index follows.
const DATA_END: u8 = 0x0f;
/// The kind of the last record.
const FOOTER: u8 = 0x02;
/// What stands before a record's body: its kind, and the body's length.
const RECORD_HEADER: usize = 9;
const SEAL_BYTES: usize = 8;
/// How every seal begins.
const SEAL_HEADER: [u8; RECORD_HEADER] = [SEAL, SEAL_BYTES as u8, 0, 0, 0, 0, 0, 0, 0];

/// The seal of a segment; before the first, zero.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub(crate) struct Seal {
    check: u32,
    number: u32,
}

impl Seal {
    /// The seal of the segment that follows this one's.
    pub fn next(self, segment: &[u8]) -> Self {
        let mut hasher = Hasher::new();
        hasher.update(&self.body());
        hasher.update(segment);
        Self { check: hasher.finalize(), number: self.number.wrapping_add(1) }
    }

    /// As a record's body.
    pub fn body(self) -> [u8; SEAL_BYTES] {
        let mut body = [0; SEAL_BYTES];
        body[..4].copy_from_slice(&self.check.to_le_bytes());
        body[4..].copy_from_slice(&self.number.to_le_bytes());
        body
    }

    fn read(body: &[u8]) -> Option<Self> {
        let (check, number) = body.split_at_checked(4)?;
        Some(Self {
            check: u32::from_le_bytes(check.try_into().ok()?),
            number: u32::from_le_bytes(number.try_into().ok()?),
        })
    }
}

/// A part of a log's bytes.
#[derive(Clone, Debug, Eq, PartialEq)]
pub(crate) enum Piece {
    /// Records as they were written.
    Whole(Range<usize>),
    /// What was changed since; what follows is sound again.
    Damaged(Range<usize>),
    /// What follows the last seal: torn, or damaged to the end.
    Rest(Range<usize>),
    /// What happened ends here, and an index follows.
    End(usize),
}

/// Goes through the segments of a log.
pub(crate) struct Segments<'a> {
    bytes: &'a [u8],
    at: usize,
    seal: Seal,
    over: bool,
}

impl<'a> Segments<'a> {
    /// The segments of a log's bytes.
    pub const fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, seal: Seal { check: 0, number: 0 }, over: false }
    }

    /// Where the newest seal ends.
    pub const fn sealed_to(&self) -> usize {
        self.at
    }

    /// The newest seal.
    pub const fn seal(&self) -> Seal {
        self.seal
    }

    /// The segment at `at` that follows the one sealed so: where its seal stands, and that seal.
    fn whole(&self, at: usize, before: Seal) -> Option<(usize, Seal)> {
        let end = records(self.bytes, at).find(|(kind, _)| *kind == SEAL).map(|(_, body)| body)?;
        let found = Seal::read(&self.bytes[end.clone()])?;
        let start = end.start - RECORD_HEADER;
        (start > at && before.next(&self.bytes[at..start]) == found).then_some((start, found))
    }

    /// The next seal that a whole segment follows, or the end of what happened: what is before it is lost.
    fn resume(&self) -> Option<(usize, Seal)> {
        let mut from = self.at;
        loop {
            let header = find(&self.bytes[from..], &SEAL_HEADER)? + from;
            let body = header + RECORD_HEADER;
            let after = body + SEAL_BYTES;
            let seal = Seal::read(self.bytes.get(body..after)?)?;
            if self.whole(after, seal).is_some() || self.ends(after) {
                return Some((after, seal));
            }
            from = header + 1;
        }
    }

    /// Whether what happened ends at `at`, and the file with its index.
    fn ends(&self, at: usize) -> bool {
        self.bytes.get(at) == Some(&DATA_END)
            && !self.bytes[at..].windows(RECORD_HEADER).any(|part| part == SEAL_HEADER)
    }
}

impl Iterator for Segments<'_> {
    type Item = Piece;

    fn next(&mut self) -> Option<Piece> {
        if self.over || self.at >= self.bytes.len() {
            return None;
        }
        if let Some((end, seal)) = self.whole(self.at, self.seal) {
            let start = if self.at == 0 { mcap::MAGIC.len() } else { self.at };
            (self.at, self.seal) = (end + RECORD_HEADER + SEAL_BYTES, seal);
            return Some(Piece::Whole(start..end));
        }
        if self.ends(self.at) {
            self.over = true;
            return Some(Piece::End(self.at));
        }
        let from = self.at;
        if let Some((after, seal)) = self.resume() {
            (self.at, self.seal) = (after, seal);
            return Some(Piece::Damaged(from..after));
        }
        self.over = true;
        Some(Piece::Rest(from..self.bytes.len()))
    }
}

/// The records from `at` on, after the magic if that is the beginning: the kind of each, and where its body is. Ends
/// where one would go beyond the end.
pub(crate) fn records(bytes: &[u8], at: usize) -> impl Iterator<Item = (u8, Range<usize>)> + '_ {
    let mut at = if at == 0 { mcap::MAGIC.len() } else { at };
    std::iter::from_fn(move || {
        let header = bytes.get(at..at.checked_add(RECORD_HEADER)?)?;
        let length = u64::from_le_bytes(header[1..].try_into().ok()?);
        let start = at + RECORD_HEADER;
        let end = start.checked_add(usize::try_from(length).ok()?).filter(|end| *end <= bytes.len())?;
        at = end;
        Some((header[0], start..end))
    })
}

/// What is wrong with the index behind `at`, where what happened ends; nothing if nothing is.
pub(crate) fn index_problem(bytes: &[u8], at: usize) -> Option<&'static str> {
    const DAMAGED: &str = "its index at the end is damaged; what happened is all there";
    if !bytes.ends_with(mcap::MAGIC) {
        return Some("its index at the end is torn; what happened is all there");
    }
    let number = |body: &[u8], at: usize| Some(u64::from_le_bytes(body.get(at..at + 8)?.try_into().ok()?));
    let check = |body: &[u8], at: usize| Some(u32::from_le_bytes(body.get(at..at + 4)?.try_into().ok()?));
    let is_sound = || {
        let (_, end) = records(bytes, at).next()?;
        let (_, footer) = records(bytes, at).find(|(kind, _)| *kind == FOOTER)?;
        let summary = usize::try_from(number(&bytes[footer.clone()], 0)?).ok()?;
        let checked = bytes.get(summary..footer.start + 16)?;
        let is_last = footer.end + mcap::MAGIC.len() == bytes.len() && summary == end.end;
        let sums = crc32fast::hash(&bytes[..at]) == check(&bytes[end], 0)?
            && crc32fast::hash(checked) == check(&bytes[footer], 16)?;
        Some(is_last && sums)
    };
    if is_sound() == Some(true) { None } else { Some(DAMAGED) }
}

fn find(bytes: &[u8], part: &[u8]) -> Option<usize> {
    bytes.windows(part.len()).position(|window| window == part)
}
