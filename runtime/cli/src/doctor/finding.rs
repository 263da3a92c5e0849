//! What a check finds.

use serde_json::{Value, json};

/// How it stands.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum State {
    /// As it should be.
    Good,
    /// A session runs, at a cost.
    Costs,
    /// No session runs.
    Broken,
}

impl State {
    /// As people read it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Good => "ok",
            Self::Costs => "costs",
            Self::Broken => "broken",
        }
    }
}

/// What a check finds, what that costs, and what can be done about it.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Finding {
    pub state: State,
    /// What there is.
    pub found: String,
    /// What is not to be had therefore; nothing where all is good.
    pub costs: String,
    /// What to do about it, where something can be done.
    pub remedy: String,
}

impl Finding {
    /// All is as it should be.
    pub fn good(found: impl Into<String>) -> Self {
        Self { state: State::Good, found: found.into(), costs: String::new(), remedy: String::new() }
    }

    /// A session runs, at a cost.
    pub fn costs(found: impl Into<String>, costs: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { state: State::Costs, found: found.into(), costs: costs.into(), remedy: remedy.into() }
    }

    /// No session runs.
    pub fn broken(found: impl Into<String>, costs: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self { state: State::Broken, ..Self::costs(found, costs, remedy) }
    }

    /// As one line.
    pub fn as_line(&self, check: &str) -> String {
        let told = [&self.found, &self.costs, &self.remedy].into_iter().filter(|text| !text.is_empty());
        let told: Vec<&str> = told.map(String::as_str).collect();
        format!("{:7} {check:17} {}", self.state.name(), told.join("; "))
    }

    /// As JSON.
    pub fn value(&self, check: &str) -> Value {
        let some = |text: &str| (!text.is_empty()).then(|| text.to_owned());
        json!({
            "check": check,
            "state": self.state.name(),
            "found": self.found,
            "costs": some(&self.costs),
            "remedy": some(&self.remedy),
        })
    }
}

/// A size as people say it.
pub fn size(bytes: u64) -> String {
    const UNITS: [(u64, &str); 3] = [(1 << 30, "GiB"), (1 << 20, "MiB"), (1 << 10, "KiB")];
    let unit = UNITS.iter().find(|(unit, _)| bytes >= *unit);
    unit.map_or_else(|| format!("{bytes} B"), |(unit, name)| format!("{:.1} {name}", bytes as f64 / *unit as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_has_what_there_is_to_say() {
        for (finding, expected) in [
            (Finding::good("4"), "ok      cores             4"),
            (Finding::costs("none", "slow", ""), "costs   cores             none; slow"),
            (Finding::broken("none", "slow", "buy one"), "broken  cores             none; slow; buy one"),
        ] {
            assert_eq!(finding.as_line("cores"), expected);
        }
    }
}
