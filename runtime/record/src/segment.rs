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

/// How often, on average, a byte of a log is looked at to find its segments. A log that is whole or was damaged needs two or
/// three; one that was made so that few of its seals belong to segments would need as many as it has seals.
const MOST_LOOKS: usize = 16;

/// Goes through the segments of a log.
pub(crate) struct Segments<'a> {
    bytes: &'a [u8],
    at: usize,
    seal: Seal,
    over: bool,
    /// Where the last seal begins, once that was needed.
    last_seal: Option<Option<usize>>,
    /// How many bytes may still be looked at; what is left of the log then counts as damaged.
    looks_left: usize,
}

impl<'a> Segments<'a> {
    /// The segments of a log's bytes.
    pub const fn new(bytes: &'a [u8]) -> Self {
        let seal = Seal { check: 0, number: 0 };
        let looks_left = bytes.len().saturating_mul(MOST_LOOKS);
        Self { bytes, at: 0, seal, over: false, last_seal: None, looks_left }
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
    fn whole(&mut self, at: usize, before: Seal) -> Option<(usize, Seal)> {
        let end = self.next_seal(at)?;
        let found = Seal::read(&self.bytes[end.clone()])?;
        let start = end.start - RECORD_HEADER;
        self.look_at(start.checked_sub(at)?)?;
        (start > at && before.next(&self.bytes[at..start]) == found).then_some((start, found))
    }

    /// The body of the next seal among the records from `at` on.
    fn next_seal(&mut self, at: usize) -> Option<Range<usize>> {
        for (kind, body) in records(self.bytes, at) {
            self.look_at(RECORD_HEADER)?;
            if kind == SEAL {
                return Some(body);
            }
        }
        None
    }

    fn look_at(&mut self, bytes: usize) -> Option<()> {
        self.looks_left = self.looks_left.saturating_sub(bytes);
        (self.looks_left > 0).then_some(())
    }

    /// The next seal that a whole segment follows, or the end of what happened: what is before it is lost.
    fn resume(&mut self) -> Option<(usize, Seal)> {
        let mut from = self.at;
        loop {
            let header = find(&self.bytes[from..], &SEAL_HEADER)? + from;
            let body = header + RECORD_HEADER;
            let after = body + SEAL_BYTES;
            let seal = Seal::read(self.bytes.get(body..after)?)?;
            if self.whole(after, seal).is_some() || self.ends(after) {
                return Some((after, seal));
            }
            if self.looks_left == 0 {
                return None;
            }
            from = header + 1;
        }
    }

    /// Whether what happened ends at `at`, and the file with its index.
    fn ends(&mut self, at: usize) -> bool {
        let bytes = self.bytes;
        let last_seal =
            *self.last_seal.get_or_insert_with(|| bytes.windows(RECORD_HEADER).rposition(|part| part == SEAL_HEADER));
        bytes.get(at) == Some(&DATA_END) && last_seal.is_none_or(|last| last < at)
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

/// What is wrong with the index behind `at`, where what happened ends; nothing if nothing is. Its sum of all that happened is
/// checked if that is whole.
pub(crate) fn index_problem(bytes: &[u8], at: usize, is_whole: bool) -> Option<&'static str> {
    let [torn, damaged] = if is_whole {
        [
            "its index at the end is torn; what happened is all there",
            "its index at the end is damaged; what happened is all there",
        ]
    } else {
        ["its index at the end is torn", "its index at the end is damaged, or no longer fits what is there"]
    };
    if !bytes.ends_with(mcap::MAGIC) {
        return Some(torn);
    }
    let number = |body: &[u8], at: usize| Some(u64::from_le_bytes(body.get(at..at + 8)?.try_into().ok()?));
    let check = |body: &[u8], at: usize| Some(u32::from_le_bytes(body.get(at..at + 4)?.try_into().ok()?));
    let is_sound = || {
        let (_, end) = records(bytes, at).next()?;
        let (_, footer) = records(bytes, at).find(|(kind, _)| *kind == FOOTER)?;
        let summary = usize::try_from(number(&bytes[footer.clone()], 0)?).ok()?;
        let checked = bytes.get(summary..footer.start + 16)?;
        let is_last = footer.end + mcap::MAGIC.len() == bytes.len() && summary == end.end;
        let sums = (!is_whole || crc32fast::hash(&bytes[..at]) == check(&bytes[end], 0)?)
            && crc32fast::hash(checked) == check(&bytes[footer], 16)?;
        Some(is_last && sums)
    };
    if is_sound() == Some(true) { None } else { Some(damaged) }
}

fn find(bytes: &[u8], part: &[u8]) -> Option<usize> {
    bytes.windows(part.len()).position(|window| window == part)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(kind: u8, body: &[u8]) -> Vec<u8> {
        [&[kind][..], &(body.len() as u64).to_le_bytes(), body].concat()
    }

    fn sealed(before: Seal, bytes: &[u8], out: &mut Vec<u8>) -> Seal {
        // The first seal is of the magic, too.
        let start = if before == Seal::default() { 0 } else { out.len() };
        out.extend_from_slice(bytes);
        let seal = before.next(&out[start..]);
        out.extend(record(SEAL, &seal.body()));
        seal
    }

    /// How often a byte of a log was looked at on average, and the pieces found.
    fn looks(bytes: &[u8]) -> (usize, Vec<Piece>) {
        let mut segments = Segments::new(bytes);
        let pieces = segments.by_ref().collect();
        let looks = MOST_LOOKS * bytes.len() - segments.looks_left;
        (looks.div_ceil(bytes.len()), pieces)
    }

    #[test]
    fn a_whole_log_is_looked_at_twice() {
        let mut bytes = mcap::MAGIC.to_vec();
        let mut seal = Seal::default();
        for number in 0..100_u8 {
            seal = sealed(seal, &record(5, &[number; 300]), &mut bytes);
        }
        let (looks, pieces) = looks(&bytes);
        assert_eq!(pieces.len(), 100);
        assert!(pieces.iter().all(|piece| matches!(piece, Piece::Whole(_))));
        assert!(looks <= 2, "{looks}");
    }

    /// However many seals there are that no segment follows, the work is bounded by the length.
    #[test]
    fn seals_without_segments_are_passed_over_in_linear_time() {
        const SEALS: usize = 80_000;
        let fake = record(SEAL, &[7; SEAL_BYTES]);
        let bare = fake.repeat(SEALS);
        let before_the_end = [[&fake[..], &[DATA_END]].concat().repeat(SEALS), fake.clone()].concat();
        // From each of them it seems to go on to the seal at the very end.
        let far = |at: usize, end: usize| [&fake[..], &[5], &((end - at - 26) as u64).to_le_bytes()].concat();
        let each = fake.len() + RECORD_HEADER;
        let far: Vec<u8> = (0..SEALS).flat_map(|index| far(index * each, SEALS * each)).collect();
        for (what, fakes) in [("bare", bare), ("end", before_the_end), ("far", [far, fake.clone()].concat())] {
            let mut bytes = mcap::MAGIC.to_vec();
            sealed(Seal::default(), &record(5, b"first"), &mut bytes);
            let begun = bytes.len();
            bytes.extend_from_slice(&fakes);
            let (_, pieces) = looks(&bytes);
            assert_eq!(pieces, [Piece::Whole(8..begun - 17), Piece::Rest(begun..bytes.len())], "{what}");
        }
    }

    /// Sound segments with damaged ones between them, each of which seems to reach to the end.
    #[test]
    fn damage_that_reaches_far_is_passed_over_in_linear_time() {
        const SEGMENTS: usize = 20_000;
        const LENGTH: usize = SEGMENTS * 80;
        let mut bytes = mcap::MAGIC.to_vec();
        let mut seal = Seal::default();
        for _ in 0..SEGMENTS {
            seal = sealed(seal, &record(5, b"sound"), &mut bytes);
            let rest = (LENGTH - bytes.len() - RECORD_HEADER) as u64;
            bytes.extend([&[5][..], &rest.to_le_bytes()].concat());
            seal = Seal { number: seal.number + 5, ..seal };
            bytes.extend(record(SEAL, &seal.body()));
        }
        bytes.resize(LENGTH, 0);
        bytes.extend(record(SEAL, &[1; SEAL_BYTES]));
        let (_, pieces) = looks(&bytes);
        assert!(pieces.len() > 2, "{}", pieces.len());
        assert!(matches!(pieces.last(), Some(Piece::Rest(_))));
    }
}
