//! Times of a session, as people write them.

use std::{fmt, str::FromStr};

use cohabit_engine::replay::TICK_S;

/// A moment of a session: so many ticks after its beginning.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub struct SessionTime {
    /// The tick.
    pub tick: u64,
}

/// Why a text is no time of a session.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct NoTime;

impl fmt::Display for NoTime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("seconds of the session, such as 83.5, or 1:23.5, or 1:02:03; or a tick, such as tick:4980")
    }
}

impl std::error::Error for NoTime {}

impl FromStr for SessionTime {
    type Err = NoTime;

    fn from_str(text: &str) -> Result<Self, NoTime> {
        /// Weeks; what is beyond was mistyped.
        const LONGEST_S: f64 = 1e7;
        if let Some(tick) = text.strip_prefix("tick:") {
            return tick.parse().map(|tick| Self { tick }).map_err(|_| NoTime);
        }
        let mut seconds = 0.0;
        let parts: Vec<&str> = text.split(':').collect();
        if parts.len() > 3 {
            return Err(NoTime);
        }
        for (place, part) in parts.iter().enumerate() {
            let number: f64 = part.parse().map_err(|_| NoTime)?;
            // Only seconds have parts, and only what comes first may be more than an hour or a minute has.
            let is_last = place + 1 == parts.len();
            if !(0.0..LONGEST_S).contains(&number)
                || (!is_last && number.fract() != 0.0)
                || (place > 0 && number >= 60.0)
            {
                return Err(NoTime);
            }
            seconds = seconds * 60.0 + number;
        }
        Ok(Self { tick: (seconds / TICK_S).round() as u64 })
    }
}

impl fmt::Display for SessionTime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let seconds = self.tick as f64 * TICK_S;
        let minutes = (seconds / 60.0).floor();
        write!(f, "{minutes}:{:04.1}", (seconds - minutes * 60.0).min(59.9))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read_as_people_write_them() {
        let check = |text: &str, tick: Option<u64>| {
            assert_eq!(text.parse::<SessionTime>().ok().map(|time| time.tick), tick, "{text}");
        };
        check("0", Some(0));
        check("83.5", Some(5010));
        check("1:23.5", Some(5010));
        check("1:00:00", Some(216_000));
        check("tick:77", Some(77));
        for nonsense in ["", "-1", "x", "1:60", "1.5:00", "1:2:3:4", "tick:", "tick:1.5", "nan", "inf"] {
            check(nonsense, None);
        }
        assert_eq!("1:23.5".parse::<SessionTime>().unwrap().to_string(), "1:23.5");
    }
}
