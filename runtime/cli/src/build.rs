//! Which build of the program this is: its linker's own name for it.

use std::{fs::File, io::Read as _, path::Path};

/// So much of the program's file holds its headers and notes.
const HEAD_BYTES: u64 = 64 << 10;

/// The build's id, in hexadecimal, where the linker left one (GNU build id).
pub fn id() -> Option<String> {
    let mut head = Vec::new();
    File::open(Path::new("/proc/self/exe")).ok()?.take(HEAD_BYTES).read_to_end(&mut head).ok()?;
    let id = note(&head)?;
    Some(id.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// The build id in the beginning of a 64-bit ELF file.
fn note(head: &[u8]) -> Option<&[u8]> {
    /// A segment of notes, and the kind of the note that is a build id.
    const NOTES: u32 = 4;
    const BUILD_ID: u32 = 3;
    let short = |at: usize| Some(u16::from_le_bytes(head.get(at..at + 2)?.try_into().ok()?));
    let word = |at: usize| Some(u32::from_le_bytes(head.get(at..at + 4)?.try_into().ok()?));
    let long = |at: usize| usize::try_from(u64::from_le_bytes(head.get(at..at + 8)?.try_into().ok()?)).ok();
    if head.get(..6)? != b"\x7fELF\x02\x01" {
        return None;
    }
    let (table, each, count) = (long(32)?, usize::from(short(54)?), usize::from(short(56)?));
    let segments = (0..count).map(|index| table + index * each);
    for segment in segments.filter(|segment| word(*segment) == Some(NOTES)) {
        let (mut at, length) = (long(segment + 8)?, long(segment + 32)?);
        let end = at.checked_add(length)?;
        while at < end {
            let (name, body, kind) = (word(at)? as usize, word(at + 4)? as usize, word(at + 8)?);
            let start = at + 12 + name.next_multiple_of(4);
            if kind == BUILD_ID && head.get(at + 12..at + 16)? == b"GNU\0" {
                return head.get(start..start + body);
            }
            at = start + body.next_multiple_of(4);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_build_has_a_name_or_none() {
        if let Some(id) = id() {
            assert!(id.len() >= 16 && id.bytes().all(|byte| byte.is_ascii_hexdigit()), "{id}");
        }
        assert_eq!(note(b"#!/bin/sh"), None);
    }
}
