//! How participants took part in pairs, and what that means for the analysis.

use std::collections::BTreeSet;

use super::{Known, counted};
use crate::{
    pair::{PartnerAbsent, SkippedBy, pair_of},
    plan::place_of,
    progress::{Phase, Progress},
};

/// How many pairs there were, and what came of them; nothing of a study without pairs.
pub(super) fn counts(known: &Known<'_>) -> Option<String> {
    known.records.study.pairing?;
    let all = &known.records.progress;
    let gone: Vec<u32> = known.records.withdrawn.iter().filter_map(|name| place_of(name)).collect();
    let places: BTreeSet<u32> = all.iter().map(|one| one.plan().place).chain(gone).collect();
    let pairs: BTreeSet<u32> = places.iter().map(|place| pair_of(*place)).collect();
    let members = |pair: u32| places.iter().filter(move |place| pair_of(**place) == pair).count();
    let of = |pair: u32| all.iter().filter(move |one| pair_of(one.plan().place) == pair).collect::<Vec<&Progress>>();
    let is_single = |pair: &&u32| members(**pair) == 1;
    let went_alone = |pair: &&u32| of(**pair).iter().any(|one| one.is_alone());
    let is_whole = |pair: &&u32| {
        let both = of(**pair);
        both.len() > 1 && both.iter().all(|one| *one.phase() == Phase::Finished && !one.is_alone())
    };
    Some(format!(
        "They took part in {}: {} finished together, in {} somebody went on without their partner, and of {} the second participant \
         never came. The sessions of a pair of whom one withdrew were removed; the other one's answers were kept.",
        counted(pairs.len(), "pair"),
        pairs.iter().filter(is_whole).count(),
        pairs.iter().filter(went_alone).count(),
        pairs.iter().filter(is_single).count(),
    ))
}

/// How they waited for each other; nothing of a study without pairs.
pub(super) fn procedure(known: &Known<'_>) -> Option<String> {
    let pairing = known.records.study.pairing?;
    let absent = match pairing.partner_absent {
        PartnerAbsent::Wait => "waited on",
        PartnerAbsent::Alone => "could go on alone",
        PartnerAbsent::End => "could stop, which ended the study for both",
    };
    let skip = match pairing.skip {
        SkippedBy::Both => "both agreed",
        SkippedBy::Either => "either wanted to",
    };
    Some(format!(
        "Both of a pair played each mission in one session, each at their own page; it began when both were ready. Who had waited for \
         {} min {absent}. A mission was skipped when {skip}. Time limits, questions during missions and questionnaires were each \
         participant's own.",
        pairing.wait_s / 60.0
    ))
}

/// What of the data is a pair's, and how that is analysed; nothing of a study without pairs.
pub(super) fn analysis(known: &Known<'_>) -> Option<String> {
    known.records.study.pairing?;
    Some(
        "What comes of a session is its pair's: `cohabit export --summary` fits it with a random intercept for each pair. What two \
         participants of one pair answer is not independent, and the program fits no model with an intercept for the pair and one for the \
         participant within it: **add one** for `scores.csv` (in lme4, `value ~ condition + (1 | pair/participant)`)."
            .to_owned(),
    )
}
