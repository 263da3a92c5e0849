//! Settings of a session that are named in one word.

/// Gives a setting its values and their names, and reads and writes these.
macro_rules! named_in_a_word {
    ($setting:ident: $($value:ident = $name:literal),+ $(,)?) => {
        impl $setting {
            /// All settings.
            pub const ALL: [Self; [$($name),+].len()] = [$(Self::$value),+];

            /// The setting in one word.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$value => $name,)+
                }
            }
        }

        impl std::fmt::Display for $setting {
            fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                formatter.write_str(self.name())
            }
        }

        impl std::str::FromStr for $setting {
            type Err = String;

            fn from_str(text: &str) -> Result<Self, Self::Err> {
                let names = || Self::ALL.map(Self::name).join("`, `");
                Self::ALL.into_iter().find(|one| one.name() == text).ok_or_else(|| format!("one of `{}`", names()))
            }
        }
    };
}

pub(crate) use named_in_a_word;
