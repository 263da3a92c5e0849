//! Text of bounded length inside a message.

use bytemuck::{Pod, Zeroable};

/// The most characters (Unicode scalar values) of what a person says or writes at once. The page, its server and the
/// messages have this one limit; 2,000 characters are some minutes of typing, and a page of an answer.
pub const LONGEST_TEXT_CHARS: usize = 2000;

/// At most `N` bytes of UTF-8; longer text is cut at a character's end.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct Text<const N: usize> {
    /// A `u16` in the machine's own order: as bytes, it leaves no padding behind any `N`.
    length: [u8; 2],
    bytes: [u8; N],
}

// SAFETY: `repr(C)` of bytes alone, so that there is no padding; all bit patterns are valid.
unsafe impl<const N: usize> Zeroable for Text<N> {}
// SAFETY: as above.
unsafe impl<const N: usize> Pod for Text<N> {}

impl<const N: usize> Text<N> {
    const FITS: () = assert!(N <= u16::MAX as usize, "a longer text has no length");

    /// Copies `text`, cut to fit.
    #[must_use]
    pub fn new(text: &str) -> Self {
        const { Self::FITS };
        let end = text.floor_char_boundary(N.min(text.len()));
        let mut bytes = [0; N];
        bytes[..end].copy_from_slice(&text.as_bytes()[..end]);
        Self { length: u16::try_from(end).unwrap_or(0).to_ne_bytes(), bytes }
    }

    /// The text; empty if a peer wrote something that is not UTF-8.
    #[must_use]
    pub fn as_str(&self) -> &str {
        self.bytes
            .get(..usize::from(u16::from_ne_bytes(self.length)))
            .and_then(|bytes| std::str::from_utf8(bytes).ok())
            .unwrap_or("")
    }
}

impl<const N: usize> Default for Text<N> {
    fn default() -> Self {
        Self::new("")
    }
}

impl<const N: usize> std::fmt::Debug for Text<N> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:?}", self.as_str())
    }
}

impl<const N: usize> PartialEq for Text<N> {
    fn eq(&self, other: &Self) -> bool {
        self.as_str() == other.as_str()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_cut_at_a_character() {
        assert_eq!(Text::<4>::new("abc").as_str(), "abc");
        assert_eq!(Text::<4>::new("abcdé").as_str(), "abcd");
        assert_eq!(Text::<4>::new("abcé").as_str(), "abc");
    }

    #[test]
    fn nonsense_reads_as_empty() {
        let text: Text<4> = bytemuck::cast([0xffu8; 6]);
        assert_eq!(text.as_str(), "");
    }

    #[test]
    fn no_length_leaves_padding() {
        assert_eq!((size_of::<Text<3>>(), align_of::<Text<3>>()), (5, 1));
        assert_eq!(Text::<3>::zeroed(), Text::<3>::new(""));
        assert_eq!(Text::<3>::new("abcd").as_str(), "abc");
    }
}
