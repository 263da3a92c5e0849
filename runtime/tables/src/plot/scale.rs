//! The scale of an axis, with ticks at round numbers.

/// A scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    low: f64,
    high: f64,
    /// The distance of ticks.
    step: f64,
}

/// How many distances of ticks there are at most.
const TICKS: f64 = 6.0;

impl Scale {
    /// That of shares.
    pub const SHARE: Self = Self { low: 0.0, high: 1.0, step: 0.25 };

    /// The scale that these values fit on; `None` of no values. Ticks are 1, 2 or 5 times a power of ten apart. It begins at 0
    /// where that costs no more than half of it.
    pub fn of(values: impl Iterator<Item = f64>) -> Option<Self> {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.filter(|value| value.is_finite()) {
            (low, high) = (low.min(value), high.max(value));
        }
        if low > high {
            return None;
        }
        if low > 0.0 && low <= high / 2.0 {
            low = 0.0;
        }
        if high - low <= 1e-9 * high.abs().max(low.abs()) {
            let room = if high == 0.0 { 1.0 } else { high.abs() / 2.0 };
            (low, high) = (low - room, high + room);
        }
        let step = round_step((high - low) / TICKS);
        Some(Self { low: (low / step).floor() * step, high: (high / step).ceil() * step, step })
    }

    /// How far up the axis a value is, 0 to 1.
    pub fn share(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }

    /// Values at ticks, and their text.
    pub fn ticks(&self) -> Vec<(f64, String)> {
        let count = ((self.high - self.low) / self.step).round() as usize;
        let digits = (-self.step.log10().floor()).max(0.0) as usize + usize::from(*self == Self::SHARE);
        let tick = |number: usize| {
            let value = self.low + self.step * number as f64;
            let text = format!("{value:.digits$}");
            let plain = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
            (value, if plain == "-0" { "0".to_owned() } else { plain.to_owned() })
        };
        (0..=count).map(tick).collect()
    }
}

/// The least of 1, 2 and 5 times a power of ten that is no less.
fn round_step(least: f64) -> f64 {
    let power = 10_f64.powf(least.log10().floor());
    let rounds = |factor: &f64| factor * power >= least * (1.0 - 1e-9);
    power * [1.0, 2.0, 5.0].into_iter().find(rounds).unwrap_or(10.0)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_hold_all_values() {
        for (values, wanted) in [
            (&[3.0, 17.0][..], &["0", "5", "10", "15", "20"][..]),
            (&[251.4, 466.0], &["250", "300", "350", "400", "450", "500"]),
            (&[-0.12, 0.3], &["-0.2", "-0.1", "0", "0.1", "0.2", "0.3"]),
            (&[0.0], &["-1", "-0.5", "0", "0.5", "1"]),
            (&[4.0, 4.0], &["2", "3", "4", "5", "6"]),
        ] {
            let scale = Scale::of(values.iter().copied()).unwrap();
            let ticks: Vec<String> = scale.ticks().into_iter().map(|(_, text)| text).collect();
            assert_eq!(ticks, wanted);
            assert!(values.iter().all(|value| (0.0..=1.0).contains(&scale.share(*value))));
        }
        assert_eq!(Scale::of([f64::NAN].into_iter()), None);
        assert_eq!(
            Scale::SHARE.ticks().iter().map(|(_, text)| text.as_str()).collect::<Vec<_>>(),
            ["0", "0.25", "0.5", "0.75", "1"]
        );
    }
}
