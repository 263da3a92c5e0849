//! What a session's page leaves out, for studies whose participants are not to see it.

use std::{fmt, str::FromStr};

/// A part of the page that can be left out.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Hidden {
    /// Figures for developers: frames a second, latencies, the session's name.
    Figures,
    /// The microphone. The service then takes no sound from pages.
    Microphone,
    /// The score.
    Score,
}

impl Hidden {
    const ALL: [Self; 3] = [Self::Figures, Self::Microphone, Self::Score];

    /// As people write it, and as pages are told.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Figures => "figures",
            Self::Microphone => "microphone",
            Self::Score => "score",
        }
    }
}

impl fmt::Display for Hidden {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// There is no such part.
#[derive(Debug, thiserror::Error)]
#[error("`{0}` is none of `figures`, `microphone` and `score`")]
pub struct NotHidden(String);

impl FromStr for Hidden {
    type Err = NotHidden;

    fn from_str(text: &str) -> Result<Self, NotHidden> {
        Self::ALL.into_iter().find(|one| one.name() == text).ok_or_else(|| NotHidden(text.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_read_as_they_are_written() {
        for part in Hidden::ALL {
            assert_eq!(part.to_string().parse::<Hidden>().ok(), Some(part));
        }
        let refused = "goals".parse::<Hidden>().map_err(|error| error.to_string());
        assert_eq!(refused, Err("`goals` is none of `figures`, `microphone` and `score`".to_owned()));
    }
}
