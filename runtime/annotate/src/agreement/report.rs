//! The agreement as a table, and as people read it.

use std::fmt::Write as _;

use super::{KindAgreement, UnitAgreement};
use crate::task::Unit;

/// The columns of the table.
const COLUMNS: &str = "scope,kind,episode,first_step,end_step,question,texts,skipped,token_f1,skip_alpha";

/// A table (CSV) with a row for each unit, and one for each kind, whose `scope` is `all`. `question` is the number of the question
/// that is answered. Shares have four decimals; what cannot be told is empty.
#[must_use]
pub fn csv(units: &[UnitAgreement], kinds: &[KindAgreement]) -> String {
    let mut text = format!("{COLUMNS}\n");
    for UnitAgreement { unit, segment, texts, skipped, token_f1 } in units {
        let question = match unit {
            Unit::Answer(id) => id.to_string(),
            Unit::Instruction(_) | Unit::Question(_) => String::new(),
        };
        let (kind, episode) = (unit.kind().name(), quoted(&segment.episode));
        let (first, end, f1) = (segment.first_step, segment.end_step, share(*token_f1));
        let _ = writeln!(text, "unit,{kind},{episode},{first},{end},{question},{texts},{skipped},{f1},");
    }
    for KindAgreement { kind, texts, skipped, token_f1, skip_alpha } in kinds {
        let (kind, f1, alpha) = (kind.name(), share(*token_f1), share(*skip_alpha));
        let _ = writeln!(text, "all,{kind},,,,,{texts},{skipped},{f1},{alpha}");
    }
    text
}

/// A line for each kind, as it is printed.
#[must_use]
pub fn lines(kinds: &[KindAgreement]) -> String {
    let told = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.2}"));
    kinds.iter().fold(String::new(), |mut text, one| {
        let (kind, texts, skipped) = (one.kind.name(), one.texts, one.skipped);
        let (f1, alpha) = (told(one.token_f1), told(one.skip_alpha));
        let _ = writeln!(text, "{kind}s: {texts} texts, {skipped} skipped; token F1 {f1}, alpha of skipping {alpha}");
        text
    })
}

fn share(value: Option<f64>) -> String {
    value.map(|value| format!("{value:.4}")).unwrap_or_default()
}

/// A field of the table that may hold anything.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}
