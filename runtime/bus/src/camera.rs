//! The names of cameras, as topics have them.

use std::{fmt, str::FromStr};

/// A camera of the simulator.
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub enum CameraId {
    /// A body's own eyes, as a robot's mind gets them: all modalities.
    Egocentric(u8),
    /// A body's own eyes, as people like to see them: larger.
    Eyes(u8),
    /// Behind a body, for people who watch it.
    Spectator(u8),
    /// Above a body, for people.
    Overhead(u8),
    /// One that whoever started the session has asked for.
    Named(CameraName),
}

/// The name of a camera: lower-case letters, digits and hyphens.
#[derive(Clone, Copy, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub struct CameraName {
    /// Filled up with zeros.
    bytes: [u8; Self::LONGEST],
}

/// Why a text is no camera's name.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
#[error(
    "`{0}` cannot be a camera's name: 1 to {most} lower-case letters, digits and hyphens, such as `door`",
    most = CameraName::LONGEST
)]
pub struct CameraNameError(pub String);

impl CameraName {
    /// The most characters of a name.
    pub const LONGEST: usize = 24;

    /// The name as text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        let length = self.bytes.iter().position(|byte| *byte == 0).unwrap_or(Self::LONGEST);
        std::str::from_utf8(&self.bytes[..length]).unwrap_or("")
    }
}

impl FromStr for CameraName {
    type Err = CameraNameError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let allowed = |byte: u8| byte.is_ascii_lowercase() || byte.is_ascii_digit() || byte == b'-';
        if text.is_empty() || text.len() > Self::LONGEST || !text.bytes().all(allowed) {
            return Err(CameraNameError(text.to_owned()));
        }
        let mut bytes = [0; Self::LONGEST];
        bytes[..text.len()].copy_from_slice(text.as_bytes());
        Ok(Self { bytes })
    }
}

impl fmt::Debug for CameraName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self.as_str(), f)
    }
}

impl fmt::Display for CameraName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

impl fmt::Display for CameraId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Egocentric(body) => write!(f, "egocentric/{body}"),
            Self::Eyes(body) => write!(f, "eyes/{body}"),
            Self::Spectator(body) => write!(f, "spectator/{body}"),
            Self::Overhead(body) => write!(f, "overhead/{body}"),
            Self::Named(name) => name.fmt(f),
        }
    }
}

impl FromStr for CameraId {
    type Err = CameraNameError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let Some((kind, body)) = text.split_once('/') else { return text.parse().map(Self::Named) };
        let wrong = || CameraNameError(text.to_owned());
        let body: u8 = body.parse().map_err(|_| wrong())?;
        match kind {
            "egocentric" => Ok(Self::Egocentric(body)),
            "eyes" => Ok(Self::Eyes(body)),
            "spectator" => Ok(Self::Spectator(body)),
            "overhead" => Ok(Self::Overhead(body)),
            _ => Err(wrong()),
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn ids_read_as_they_print() {
        for text in ["egocentric/0", "eyes/3", "spectator/255", "overhead/1", "door", "a-2", &"x".repeat(24)] {
            assert_eq!(text.parse::<CameraId>().unwrap().to_string(), text);
        }
        for text in ["", "Door", "two words", "a/b/c", "eyes/256", "lens/1", "ä", &"x".repeat(25)] {
            assert_eq!(text.parse::<CameraId>(), Err(CameraNameError(text.to_owned())));
        }
    }
}
