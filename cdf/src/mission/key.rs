//! The keys by which mission files name the initial states of objects.

use crate::{
    flag_key::{flag_keys, flag_of_key},
    state::StateFlag,
};

/// What a key of `required_objects[].state` says.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum InitialKey {
    /// A flag.
    Flag(StateFlag),
    /// What fills it.
    Filled,
    /// Nothing is in it.
    Empty,
    /// What the layout put in it is taken out.
    RemoveContents,
    /// Its class does not spawn by itself.
    Blacklist,
    /// No other of its class exists.
    Unique,
    /// It is taken out of the world.
    Removed,
    /// The circuit it belongs to.
    Circuit,
    /// The circuit it feeds.
    GeneratesCircuit,
    /// Whether it feeds that circuit.
    GeneratesPower,
    /// What a note says.
    Text,
}

/// The keys of initial states that are no flags.
const INITIAL: [(&str, InitialKey); 10] = [
    ("isFilled", InitialKey::Filled),
    ("isEmpty", InitialKey::Empty),
    ("removeInitialContainedItems", InitialKey::RemoveContents),
    ("Blacklist", InitialKey::Blacklist),
    ("Unique", InitialKey::Unique),
    ("Removed", InitialKey::Removed),
    ("circuitId", InitialKey::Circuit),
    ("generateCircuitId", InitialKey::GeneratesCircuit),
    ("generatePower", InitialKey::GeneratesPower),
    ("text", InitialKey::Text),
];

impl InitialKey {
    /// What `key` says, in any case.
    pub(super) fn of(key: &str) -> Option<Self> {
        let named = INITIAL.iter().find(|(known, _)| known.eq_ignore_ascii_case(key)).map(|(_, initial)| *initial);
        named.or_else(|| flag_of_key(key).map(Self::Flag))
    }

    /// All keys.
    pub(super) fn names() -> impl Iterator<Item = &'static str> {
        INITIAL.iter().map(|(key, _)| *key).chain(flag_keys())
    }
}
