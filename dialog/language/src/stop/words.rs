//! The words of `data/stop.toml`.

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::OnceLock,
};

use serde::Deserialize;

use crate::words::table::PhraseTable;

/// The words of `data/stop.toml`, whose comments say what they are.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Words {
    pub(crate) core: BTreeSet<String>,
    pub(crate) closed: PhraseTable<()>,
    pub(crate) open: PhraseTable<()>,
    pub(crate) weak: PhraseTable<()>,
    pub(crate) dismissal: PhraseTable<()>,
    pub(crate) drops: PhraseTable<()>,
    pub(crate) pause: PhraseTable<()>,
    pub(crate) lead: PhraseTable<()>,
    pub(crate) closing: PhraseTable<()>,
    pub(crate) spare: PhraseTable<()>,
    pub(crate) reason: BTreeSet<String>,
    pub(crate) grounds: PhraseTable<()>,
    pub(crate) corrections: PhraseTable<()>,
    pub(crate) negations: BTreeSet<String>,
    pub(crate) before_blocks: BTreeSet<String>,
    pub(crate) adverbs: BTreeSet<String>,
    pub(crate) subordinators: PhraseTable<()>,
    pub(crate) questions: BTreeSet<String>,
    pub(crate) auxiliaries: BTreeSet<String>,
    pub(crate) modals: BTreeSet<String>,
    pub(crate) persons: BTreeSet<String>,
    pub(crate) tellers: BTreeSet<String>,
    pub(crate) told: BTreeSet<String>,
    pub(crate) requests: BTreeSet<String>,
    pub(crate) compounds: BTreeSet<String>,
    pub(crate) machines: BTreeSet<String>,
    pub(crate) determiners: BTreeSet<String>,
    pub(crate) own: BTreeSet<String>,
    pub(crate) places: BTreeSet<String>,
    pub(crate) copulas: BTreeSet<String>,
    pub(crate) relatives: BTreeSet<String>,
    pub(crate) not_gerunds: BTreeSet<String>,
    pub(crate) praise: PhraseTable<()>,
    pub(crate) acts: BTreeSet<String>,
    pub(crate) sayers: BTreeSet<String>,
    pub(crate) saying: BTreeSet<String>,
    pub(crate) objects: BTreeSet<String>,
    pub(crate) negated_requests: BTreeSet<String>,
    pub(crate) joints: BTreeSet<String>,
    pub(crate) asking: BTreeSet<String>,
    pub(crate) moves: BTreeSet<String>,
    pub(crate) moves_after: BTreeSet<String>,
    pub(crate) postures: BTreeSet<String>,
    pub(crate) stillness: BTreeSet<String>,
    pub(crate) deictics: BTreeSet<String>,
    pub(crate) subjects: BTreeSet<String>,
    pub(crate) greetings: BTreeSet<String>,
    pub(crate) mistyped: Vec<String>,
    pub(crate) swapped: Vec<String>,
    pub(crate) drawn: Vec<String>,
    pub(crate) words: BTreeSet<String>,
    pub(crate) same: BTreeMap<String, String>,
    pub(crate) joined: BTreeSet<String>,
}

impl Words {
    /// Whether it is a word of one of the phrases, or one that looks like a slip of one.
    pub(crate) fn has(&self, word: &str) -> bool {
        let in_set =
            [&self.core, &self.words, &self.reason, &self.requests, &self.compounds, &self.machines, &self.places]
                .iter()
                .any(|set| set.contains(word));
        in_set || self.known().contains(word)
    }

    fn known(&self) -> &'static BTreeSet<String> {
        static KNOWN: OnceLock<BTreeSet<String>> = OnceLock::new();
        KNOWN.get_or_init(|| {
            let tables =
                [&self.closed, &self.open, &self.weak, &self.dismissal, &self.pause, &self.lead, &self.closing];
            tables.iter().flat_map(|table| table.phrases()).flatten().cloned().collect()
        })
    }
}

pub(crate) fn words() -> &'static Words {
    static WORDS: OnceLock<Words> = OnceLock::new();
    WORDS.get_or_init(|| {
        toml::from_str(include_str!("../../data/stop.toml"))
            .expect("invariant: the built-in table parses, the tests load it")
    })
}
