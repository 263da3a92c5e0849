//! The codes of the experimenter: what is noted by a key.

use std::collections::BTreeSet;

use cohabit_cdf::mission::Pointer;
use toml::Spanned;

use super::Checking;
use crate::{design::Code, written::WrittenCode};

impl Checking<'_, '_> {
    pub(super) fn codes(&mut self, written: &[Spanned<WrittenCode>], at: &Pointer) -> Vec<Code> {
        let mut keys = BTreeSet::new();
        let mut all = Vec::new();
        for (index, code) in written.iter().enumerate() {
            let place = at.item(index).key("key");
            let WrittenCode { key: Some(key), text: Some(text) } = code.get_ref() else { continue };
            let mut letters = key.get_ref().chars();
            match (letters.next(), letters.next()) {
                (Some(letter @ ('a'..='z' | '0'..='9')), None) if keys.insert(letter) => {
                    all.push(Code { key: letter, text: text.get_ref().trim().to_owned() });
                }
                (Some('a'..='z' | '0'..='9'), None) => {
                    let message = format!("two codes have the key `{}`", key.get_ref());
                    self.findings.add(key.span(), &place, message, "give one of them another key");
                }
                _ => {
                    let message = format!("`{}` is no key for a code", key.get_ref());
                    self.findings.add(
                        key.span(),
                        &place,
                        message,
                        "write a small letter or a digit, such as key = \"h\"",
                    );
                }
            }
        }
        all
    }
}
