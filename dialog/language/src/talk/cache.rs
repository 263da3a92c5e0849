//! A cache by text.

use std::{
    collections::{HashMap, hash_map::Entry},
    sync::{PoisonError, RwLock},
};

/// The most texts that it holds.
const CAPACITY: usize = 4096;

/// Values by text; it is emptied when it is full.
pub(crate) struct Cache<V> {
    by_text: RwLock<HashMap<String, V>>,
}

impl<V> Default for Cache<V> {
    fn default() -> Self {
        Self { by_text: RwLock::default() }
    }
}

impl<V: Clone> Cache<V> {
    /// The value of a text, computed if it is not there.
    pub(crate) fn get_or_insert_with(&self, text: &str, compute: impl FnOnce() -> V) -> V {
        if let Some(known) = self.by_text.read().unwrap_or_else(PoisonError::into_inner).get(text) {
            return known.clone();
        }
        let value = compute();
        let mut by_text = self.by_text.write().unwrap_or_else(PoisonError::into_inner);
        if by_text.len() >= CAPACITY {
            by_text.clear();
        }
        match by_text.entry(text.to_owned()) {
            Entry::Occupied(known) => known.get().clone(),
            Entry::Vacant(place) => place.insert(value).clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_computed_once_until_the_cache_is_full() {
        let cache = Cache::default();
        assert_eq!(cache.get_or_insert_with("one", || 1), 1);
        assert_eq!(cache.get_or_insert_with("one", || 2), 1);
        for number in 0..CAPACITY {
            cache.get_or_insert_with(&number.to_string(), || 0);
        }
        assert_eq!(cache.get_or_insert_with("one", || 3), 3);
    }
}
