//! Messages on a stream of bytes: four bytes of length, little-endian, then so many bytes. Never knows what they mean.

/// The longest message that is taken in, bytes.
pub const LONGEST: usize = 64 << 20;

/// Bytes of the length before a message.
const PREFIX: usize = 4;

/// Why no more can be read from a stream: where its next message begins is not known.
#[derive(Clone, Copy, Debug, Eq, PartialEq, thiserror::Error)]
#[error(
    "a message of {bytes} bytes: at most {LONGEST} are taken; the first 4 bytes are the length, little-endian, of the \
     JSON that follows"
)]
pub struct TooLong {
    /// What its length says.
    pub bytes: usize,
}

/// Puts messages together again from the pieces in which they come.
///
/// ```
/// use cohabit_arena::{Inbox, framed};
///
/// let mut inbox = Inbox::default();
/// let bytes = framed(b"[]");
/// inbox.push(&bytes[..3]);
/// assert_eq!(inbox.next(), Ok(None));
/// inbox.push(&bytes[3..]);
/// assert_eq!(inbox.next(), Ok(Some(b"[]".to_vec())));
/// ```
#[derive(Debug, Default)]
pub struct Inbox {
    bytes: Vec<u8>,
    /// Where the next message begins in them.
    start: usize,
}

impl Inbox {
    /// Takes in what came. Memory follows what was sent, not what a length promises: it grows to twice that at most.
    pub fn push(&mut self, bytes: &[u8]) {
        let needed = self.bytes.len() + bytes.len();
        if needed > self.bytes.capacity() {
            let whole = self.length().filter(|length| *length <= LONGEST).map(|length| self.start + PREFIX + length);
            let grown = (2 * needed).min(whole.unwrap_or(usize::MAX)).max(needed);
            self.bytes.reserve_exact(grown - self.bytes.len());
        }
        self.bytes.extend_from_slice(bytes);
    }

    /// The next message that is complete. Empty ones, by which clients find out whether anybody listens, are left out.
    ///
    /// # Errors
    /// [`TooLong`], and again for ever after.
    #[expect(clippy::should_implement_trait, reason = "it ends only for now")]
    pub fn next(&mut self) -> Result<Option<Vec<u8>>, TooLong> {
        loop {
            let Some(length) = self.length() else {
                self.forget_read();
                return Ok(None);
            };
            if length > LONGEST {
                return Err(TooLong { bytes: length });
            }
            let (from, end) = (self.start + PREFIX, self.start + PREFIX + length);
            if self.bytes.len() < end {
                self.forget_read();
                return Ok(None);
            }
            if length == 0 {
                self.start = end;
                continue;
            }
            if self.bytes.len() - end > length {
                self.start = end;
                return Ok(Some(self.bytes[from..end].to_vec()));
            }
            // The memory of a long message goes with it.
            let rest = self.bytes.split_off(end);
            let mut message = std::mem::replace(&mut self.bytes, rest);
            self.start = 0;
            message.drain(..from);
            return Ok(Some(message));
        }
    }

    /// Whether a message has begun that is not complete.
    #[must_use]
    pub fn has_begun(&self) -> bool {
        self.bytes.len() > self.start
    }

    /// What it holds, bytes; it takes twice that of memory at most.
    #[must_use]
    pub fn held(&self) -> usize {
        self.bytes.len()
    }

    /// What the next message says of its length.
    fn length(&self) -> Option<usize> {
        self.bytes[self.start..].first_chunk::<PREFIX>().map(|prefix| u32::from_le_bytes(*prefix) as usize)
    }

    fn forget_read(&mut self) {
        self.bytes.drain(..self.start);
        self.start = 0;
    }
}

/// A message as it is sent.
///
/// # Panics
/// When it is 4 GiB long or longer.
#[must_use]
pub fn framed(message: &[u8]) -> Vec<u8> {
    let length = u32::try_from(message.len()).expect("invariant: messages are far shorter than 4 GiB");
    let mut bytes = Vec::with_capacity(PREFIX + message.len());
    bytes.extend_from_slice(&length.to_le_bytes());
    bytes.extend_from_slice(message);
    bytes
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// All messages in `bytes`, which come in pieces of these lengths, over and over.
    fn read(bytes: &[u8], pieces: &[usize]) -> Result<Vec<Vec<u8>>, TooLong> {
        let (mut inbox, mut found, mut rest) = (Inbox::default(), Vec::new(), bytes);
        for piece in pieces.iter().cycle() {
            let (now, later) = rest.split_at((*piece).clamp(1, rest.len().max(1)).min(rest.len()));
            inbox.push(now);
            while let Some(message) = inbox.next()? {
                found.push(message);
            }
            if later.is_empty() {
                break;
            }
            rest = later;
        }
        Ok(found)
    }

    proptest! {
        #[test]
        fn what_is_sent_in_pieces_comes_whole(
            messages in prop::collection::vec(prop::collection::vec(any::<u8>(), 0..40), 0..8),
            pieces in prop::collection::vec(1_usize..17, 1..5),
        ) {
            let bytes: Vec<u8> = messages.iter().flat_map(|message| framed(message)).collect();
            let sent: Vec<Vec<u8>> = messages.into_iter().filter(|message| !message.is_empty()).collect();
            prop_assert_eq!(read(&bytes, &pieces), Ok(sent));
        }

        #[test]
        fn no_bytes_upset_it(bytes in prop::collection::vec(any::<u8>(), 0..200), pieces in prop::collection::vec(1_usize..17, 1..5)) {
            if let Err(TooLong { bytes }) = read(&bytes, &pieces) {
                prop_assert!(bytes > LONGEST);
            }
        }
    }

    #[test]
    fn memory_follows_what_was_sent() {
        let mut inbox = Inbox::default();
        inbox.push(&u32::try_from(LONGEST).unwrap().to_le_bytes());
        let piece = vec![b' '; 64 << 10];
        for sent in 1..=LONGEST / piece.len() {
            assert!(inbox.bytes.capacity() <= 2 * sent * piece.len(), "{sent}");
            inbox.push(&piece);
        }
        assert!(inbox.bytes.capacity() <= LONGEST + PREFIX);
        inbox.push(&[1, 0, 0, 0]);
        assert_eq!(inbox.next().map(|message| message.map(|message| message.len())), Ok(Some(LONGEST)));
        assert!(inbox.has_begun() && inbox.bytes.capacity() < 100, "{}", inbox.bytes.capacity());
    }

    #[test]
    fn many_empty_messages_are_passed_over_at_once() {
        let mut inbox = Inbox::default();
        inbox.push(&vec![0; 4 << 20]);
        inbox.push(&framed(b"[]"));
        assert_eq!(inbox.next(), Ok(Some(b"[]".to_vec())));
        assert!(!inbox.has_begun());
    }

    #[test]
    fn a_length_is_bounded() {
        let length = |bytes: u32| read(&bytes.to_le_bytes(), &[4]);
        assert_eq!(length(64 << 20), Ok(Vec::new()));
        assert_eq!(length((64 << 20) + 1), Err(TooLong { bytes: (64 << 20) + 1 }));
        let text = length(u32::from_le_bytes(*b"GET ")).map_err(|error| error.to_string());
        assert!(text.is_err_and(|text| text.contains("542393671 bytes") && text.contains("little-endian")));
    }
}
