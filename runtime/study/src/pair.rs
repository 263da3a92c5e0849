//! Pairs: two participants who play their missions together, each at their own page. Which pair somebody belongs to, and which seat
//! they have in it, follows from their place alone.

use serde::{Deserialize, Serialize};

/// How many participants a pair has.
pub const PAIR_SIZE: u32 = 2;
/// How labels of pairs begin.
const LABEL: &str = "pair";

/// How the two participants of a session go together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pairing {
    /// How long somebody waits for their partner before the experimenter is alarmed, and something else may follow, s.
    pub wait_s: f64,
    /// What may follow then.
    pub partner_absent: PartnerAbsent,
    /// Who has to agree that a mission is skipped.
    pub skip: SkippedBy,
}

/// What may follow when somebody has waited for their partner in vain.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PartnerAbsent {
    /// They wait on, until the experimenter decides.
    #[default]
    Wait,
    /// They may go on alone, from then on.
    Alone,
    /// They may stop, and the study ends for both.
    End,
}

/// Who has to agree that a mission is skipped.
#[derive(Clone, Copy, Debug, Default, Deserialize, Eq, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SkippedBy {
    /// Both of a pair.
    #[default]
    Both,
    /// Either of them, for both.
    Either,
}

/// The number of the pair, from 1, of the participant at a place, from 1.
#[must_use]
pub const fn pair_of(place: u32) -> u32 {
    place.saturating_sub(1) / PAIR_SIZE + 1
}

/// Their seat in it, from 0.
#[must_use]
pub const fn seat_of(place: u32) -> u32 {
    place.saturating_sub(1) % PAIR_SIZE
}

/// The place of the other one.
#[must_use]
pub const fn partner_of(place: u32) -> u32 {
    if seat_of(place) == 0 { place + 1 } else { place - 1 }
}

/// What a pair is called.
#[must_use]
pub fn pair_label(pair: u32) -> String {
    format!("{LABEL}{pair:02}")
}

/// The number of a pair that is called so.
#[must_use]
pub fn pair_called(label: &str) -> Option<u32> {
    let pair = label.strip_prefix(LABEL)?.parse().ok().filter(|pair| *pair > 0)?;
    (pair_label(pair) == label).then_some(pair)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_of_pairs_and_seats() {
        for (place, pair, seat, partner) in [(1, 1, 0, 2), (2, 1, 1, 1), (3, 2, 0, 4), (40, 20, 1, 39)] {
            assert_eq!((pair_of(place), seat_of(place), partner_of(place)), (pair, seat, partner), "{place}");
            assert_eq!((pair_of(partner), partner_of(partner)), (pair, place));
        }
    }

    #[test]
    fn labels_read_as_they_are_written() {
        for (pair, label) in [(1, "pair01"), (20, "pair20"), (100, "pair100")] {
            assert_eq!((pair_label(pair).as_str(), pair_called(label)), (label, Some(pair)));
        }
        for wrong in ["", "pair", "pair0", "pair00", "pair1", "P01", "pair+1"] {
            assert_eq!(pair_called(wrong), None, "{wrong}");
        }
    }
}
