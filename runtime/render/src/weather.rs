//! Dirt, frost and slime.

/// What states do to every surface of an instance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Weather {
    pub dirty: bool,
    pub cold: bool,
    pub infected: bool,
}

impl Weather {
    pub(crate) fn any(self) -> bool {
        self != Self::default()
    }
}
