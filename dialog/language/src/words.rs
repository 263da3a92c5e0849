//! What words are, before anybody has said anything: the tables of `data`, the names of the catalogue's classes, spelling, sound and
//! English. Knows no utterance and no scene.

pub(crate) mod address;
mod files;
pub(crate) mod inflect;
pub(crate) mod intent;
pub(crate) mod lexicon;
pub(crate) mod lists;
mod misheard;
mod naming;
mod normalise;
pub(crate) mod prose;
pub(crate) mod question_kind;
pub(crate) mod sound;
pub(crate) mod spelling;
pub(crate) mod table;
pub(crate) mod token;
