//! Which body of a session is meant.

use std::{fmt, str::FromStr};

use cohabit_bus::message::BodyRecord;
use cohabit_cdf::BodyKind;

/// A body: that of a number, or the first of a kind.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum BodyChoice {
    /// That of this number.
    Number(u32),
    /// The first of this kind.
    First(BodyKind),
}

impl BodyChoice {
    /// The number of the body among those of a session, if it is there.
    pub(crate) fn among(self, bodies: &[BodyRecord]) -> Option<u32> {
        let is_meant = |record: &&BodyRecord| match self {
            Self::Number(number) => record.body == number,
            Self::First(kind) => record.kind() == Some(kind),
        };
        bodies.iter().find(is_meant).map(|record| record.body)
    }
}

/// The numbers and kinds of bodies, in words.
pub(crate) fn listed(bodies: &[BodyRecord]) -> String {
    let named = |record: &BodyRecord| {
        let kind = record.kind().map_or("unknown", BodyKind::name);
        format!("{} ({kind})", record.body)
    };
    bodies.iter().map(named).collect::<Vec<_>>().join(", ")
}

impl FromStr for BodyChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if let Some(kind) = BodyKind::ALL.into_iter().find(|kind| kind.name() == text) {
            return Ok(Self::First(kind));
        }
        let remedy = "write its number, such as `0`, or `robot` or `person` for the first one";
        text.parse().map(Self::Number).map_err(|_| format!("`{text}` is no body: {remedy}"))
    }
}

impl fmt::Display for BodyChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => write!(f, "body {number}"),
            Self::First(kind) => f.write_str(kind.name()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_is_chosen_by_number_or_by_kind() {
        let kinds = [BodyKind::Person, BodyKind::Robot, BodyKind::Robot];
        let records = (0..).zip(kinds);
        let bodies: Vec<BodyRecord> =
            records.map(|(body, kind)| BodyRecord { body, kind: kind as u32, ..BodyRecord::default() }).collect();
        for (text, expected) in [("0", Some(0)), ("robot", Some(1)), ("person", Some(0)), ("2", Some(2)), ("3", None)] {
            let choice: BodyChoice = text.parse().unwrap();
            assert_eq!(choice.among(&bodies), expected, "{text}");
        }
        assert_eq!(listed(&bodies), "0 (person), 1 (robot), 2 (robot)");
        let refused = "butler".parse::<BodyChoice>().unwrap_err();
        assert!(refused.contains("`butler` is no body"), "{refused}");
    }
}
