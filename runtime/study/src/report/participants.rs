//! Who took part.

use super::{Known, counted, listed, pairs};
use crate::{
    plan::pseudonym,
    progress::{Phase, Progress},
};

pub(super) fn section(known: &Known<'_>) -> String {
    let (all, withdrawn) = (&known.records.progress, known.records.withdrawn.len());
    let of = |phase: &Phase| all.iter().filter(|one| one.phase() == phase).count();
    let (finished, excluded) = (of(&Phase::Finished), of(&Phase::Excluded));
    let under_way = all.len() - finished - excluded - of(&Phase::Withdrawn);
    let consented = all.len() + withdrawn;
    let planned = known.records.study.participants;
    let mut text = format!(
        "{} consented, of {planned} planned: {finished} finished, {under_way} did not come to the end, {excluded} {} excluded, and \
         {withdrawn} withdrew, whose data were removed. Nothing is recorded of people who read about the study and did not consent, so \
         how many they were is not known.",
        counted(consented, "participant"),
        if excluded == 1 { "was" } else { "were" },
    );
    let reasons: Vec<String> = all.iter().filter_map(reason).collect();
    if !reasons.is_empty() {
        text += &format!(" Excluded: {}.", listed(&reasons));
    }
    if let Some(pairs) = pairs::counts(known) {
        text += &format!(" {pairs}");
    }
    if let Some((first, last)) = times(all) {
        text += &format!(" The first consented on {first}, and the last step ended on {last}.");
    }
    text += &match &known.records.study.keep_until {
        Some(day) => format!(" Their data are kept until {day}."),
        None => " Until when their data are kept: **missing, add `keep_until` to the study's file**.".to_owned(),
    };
    text + " Age, gender, experience, recruitment and pay are not known to the program: **missing, add them** (they may be \
            answers to a questionnaire; see `answers.csv`)."
}

/// Who was excluded, and why.
fn reason(one: &Progress) -> Option<String> {
    Some(format!("{} ({})", pseudonym(one.plan().place), one.exclusion()?))
}

/// The days of the first consent and the last step.
fn times(all: &[Progress]) -> Option<(String, String)> {
    let first = all.iter().map(|one| one.done().first().map_or(one.since_ms(), |done| done.began_ms)).min()?;
    let last = all.iter().flat_map(|one| one.done().iter().map(|done| done.ended_ms)).max()?;
    Some((day(first), day(last)))
}

/// The day of a time, ms since 1970, in UTC, such as `2026-11-26` (the algorithm is Howard Hinnant's `civil_from_days`).
#[must_use]
pub fn day(at_ms: u64) -> String {
    const DAY_MS: u64 = 86_400_000;
    let days = at_ms / DAY_MS + 719_468;
    let (era, of_era) = (days / 146_097, days % 146_097);
    let year = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let month = (5 * of_year + 2) / 153;
    let (date, month) = (of_year - (153 * month + 2) / 5 + 1, if month < 10 { month + 3 } else { month - 9 });
    let year = year + era * 400 + u64::from(month <= 2);
    format!("{year:04}-{month:02}-{date:02}")
}
