//! Whether what a language model makes of the sound may stand for what was heard without it.
//!
//! Without a gate, whatever is said becomes something likely ("turn down the music" → "turn the computer"). What decides is
//! how much less likely it is by the sound alone; over 411 commands and 39 other things said by three synthetic voices, that
//! let more commands pass, and bent fewer other things, than counting words that differ. It is wide: what passes may yet be
//! asked about, by [`crate::choose`].

use crate::bias;

/// The most that it may be less likely by the sound: logarithm, for one word; for more it grows with the square root, as
/// the sum of errors that have nothing to do with each other.
const UNLIKELIER: f32 = 4.0;
/// The shortest it may be, as a share of the words heard.
const SHORTEST: f32 = 0.6;

/// A text, and the logarithm of how likely it is by the sound.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Heard<'a> {
    pub(crate) text: &'a str,
    pub(crate) by_sound: f32,
}

/// Whether `domain` may stand for `raw`.
pub(crate) fn is_open(domain: Heard<'_>, raw: Heard<'_>) -> bool {
    let [length, heard] = [domain, raw].map(|heard| bias::words(heard.text).len() as f32);
    length > 0.0 && length >= SHORTEST * heard && raw.by_sound - domain.by_sound <= UNLIKELIER * heard.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_near_in_sound_passes() {
        let check = |domain: (&str, f32), raw: (&str, f32), expected: bool| {
            let [domain, raw] = [domain, raw].map(|(text, by_sound)| Heard { text, by_sound });
            assert_eq!(is_open(domain, raw), expected, "{domain:?} for {raw:?}");
        };
        check(("Put the bowl on the shelf.", -4.0), ("But the bowl on the shelf.", -2.0), true);
        check(("Put the bowl on the shelf.", -13.0), ("But the bowl on the shelf.", -2.0), false);
        check(("Stop.", -3.0), ("Top.", -1.0), true);
        check(("Stop.", -6.0), ("Top.", -1.0), false);
        check(("Place.", -3.0), ("Play some jazz music please.", -2.0), false);
        check(("", -1.0), ("", -1.0), false);
        check(("Stop.", -1.0), ("", -1.0), true);
    }
}
