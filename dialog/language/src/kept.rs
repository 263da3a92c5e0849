//! What was found out about texts, kept in mind for when they are asked about again.

use std::{
    collections::{HashMap, hash_map::Entry},
    sync::{PoisonError, RwLock},
};

/// The most texts that are kept in mind.
const MOST_KEPT: usize = 4096;

/// What is known of texts; all is forgotten when it gets too much.
pub(crate) struct Kept<V> {
    by_text: RwLock<HashMap<String, V>>,
}

impl<V> Default for Kept<V> {
    fn default() -> Self {
        Self { by_text: RwLock::default() }
    }
}

impl<V: Clone> Kept<V> {
    /// What is known of a text, or else what is now found out.
    pub(crate) fn get(&self, text: &str, find_out: impl FnOnce() -> V) -> V {
        if let Some(known) = self.by_text.read().unwrap_or_else(PoisonError::into_inner).get(text) {
            return known.clone();
        }
        let found = find_out();
        let mut by_text = self.by_text.write().unwrap_or_else(PoisonError::into_inner);
        if by_text.len() >= MOST_KEPT {
            by_text.clear();
        }
        match by_text.entry(text.to_owned()) {
            Entry::Occupied(known) => known.get().clone(),
            Entry::Vacant(place) => place.insert(found).clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_looked_into_once_until_too_much_is_known() {
        let kept = Kept::default();
        assert_eq!(kept.get("one", || 1), 1);
        assert_eq!(kept.get("one", || 2), 1);
        for number in 0..MOST_KEPT {
            kept.get(&number.to_string(), || 0);
        }
        assert_eq!(kept.get("one", || 3), 3);
    }
}
