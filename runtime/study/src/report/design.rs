//! What was compared, how it was assigned, what participants did, and with what.

use std::collections::BTreeMap;

use super::{Known, counted, listed, pairs, rows};
use crate::{
    design::{Assignment, Block, Choice, FactorKind, Limits, Minimisation, MissionOrder, Study},
    plan::Step,
    progress::Ending,
    settings::{OF_PAGES, Settings, arguments, is_on},
    tables::levels,
};

pub(super) fn assignment(known: &Known<'_>) -> String {
    let study = &known.records.study;
    if study.factors.is_empty() {
        return "All participants took part under the same condition.".to_owned();
    }
    let factor = |kind: FactorKind, how: &str| {
        let of_kind = study.factors.iter().filter(|factor| factor.kind == kind);
        let one = |factor: &crate::design::Factor| {
            let level = |level: &crate::design::Level| format!("`{}` ({})", level.name, settings(&level.settings));
            let all: Vec<String> = factor.levels.iter().map(level).collect();
            format!("- `{}` varied {how} participants: {}", factor.name, listed(&all))
        };
        of_kind.map(one).collect::<Vec<_>>()
    };
    let factors = [
        factor(FactorKind::Between, if study.pairing.is_some() { "between pairs of" } else { "between" }),
        factor(FactorKind::Own, "between single"),
        factor(FactorKind::Within, "within"),
    ]
    .concat();
    let analysis = pairs::analysis(known).map(|text| format!("\n\n{text}")).unwrap_or_default();
    format!("{}\n\n{}\n\n{}{analysis}", factors.join("\n"), methods(study), counts(known))
}

/// Settings as flags, and what participants are shown.
fn settings(settings: &Settings) -> String {
    let shown = OF_PAGES.iter().filter(|name| is_on(settings, name)).map(|name| format!("{name} shown"));
    let all: Vec<String> = arguments(settings).into_iter().chain(shown).collect();
    if all.is_empty() { "no setting of its own".to_owned() } else { all.join(", ") }
}

/// How conditions were assigned.
fn methods(study: &Study) -> String {
    let (between, within) = (study.conditions(FactorKind::Between).len(), study.conditions(FactorKind::Within).len());
    let mut said = Vec::new();
    if let Some(Minimisation { covariates, certainty }) = &study.minimisation {
        let names: Vec<String> = covariates.iter().map(|covariate| format!("`{}`", covariate.name)).collect();
        said.push(format!(
            "The {between} between-participants conditions were assigned by minimisation (Pocock & Simon, 1975) over {}, with the range \
             as the measure of imbalance; the best condition was taken with a probability of {certainty}.",
            listed(&names)
        ));
    } else if between > 1 {
        said.push(format!(
            "The {between} between-participants conditions were assigned in random order within blocks of {}.",
            counted(study.block_size, study.unit())
        ));
    }
    if within > 1 {
        let order = match study.assignment {
            Assignment::LatinSquare => "by the rows of Latin squares, taken in random order",
            Assignment::BalancedLatinSquare => {
                "by the rows of Latin squares balanced for first-order carry-over (Williams, 1949), taken in random order"
            }
            Assignment::BlockRandom if study.pairing.is_some() => "in a random order for each pair",
            Assignment::BlockRandom => "in a random order for each participant",
        };
        said.push(format!("The {within} within-participant conditions were met {order}."));
    }
    if let Some(missions) = study.missions_block() {
        let order = match missions.order {
            MissionOrder::Fixed => "in the same order by all",
            MissionOrder::Random if study.pairing.is_some() => "in a random order for each pair",
            MissionOrder::Random => "in a random order for each participant",
            MissionOrder::Balanced if within > 1 && study.assignment == Assignment::BlockRandom => {
                "in orders in which each stands at each position as often; the condition under which each was played was random"
            }
            MissionOrder::Balanced => {
                "in orders in which each meets each condition, and stands at each position, as often"
            }
        };
        said.push(format!("The {} were played {order}.", counted(study.missions.len(), "mission")));
    }
    let (from, when) = match study.minimisation {
        Some(_) => {
            (", the order in which participants came and their covariates", "when it was assigned, and never changed")
        }
        None => (" and the order in which participants came", "when a participant consented, and never changed"),
    };
    said.push(format!("All of it follows from the seed {}{from}; it was written down {when}.", study.seed));
    said.join(" ")
}

/// How many participants met each condition, and what came of their missions.
fn counts(known: &Known<'_>) -> String {
    #[derive(Default)]
    struct Count {
        participants: usize,
        played: usize,
        complete: usize,
        skipped: usize,
    }
    let mut counts = BTreeMap::<String, Count>::new();
    for progress in &known.records.progress {
        let plan = progress.plan();
        let mut met: Vec<String> = Vec::new();
        for done in progress.done() {
            let (Some(Step::Mission(mission)), Some(ending)) = (plan.steps.get(done.step), done.ending) else {
                continue;
            };
            if mission.is_practice {
                continue;
            }
            let condition = condition(&plan.choices(done.step));
            let count = counts.entry(condition.clone()).or_default();
            count.played += 1;
            count.complete += usize::from(ending == Ending::Complete);
            count.skipped += usize::from(ending == Ending::Skipped);
            if !met.contains(&condition) {
                count.participants += 1;
                met.push(condition);
            }
        }
    }
    let row = |(condition, count): (String, Count)| {
        let numbers =
            [count.participants, count.played, count.complete, count.skipped].map(|number| number.to_string());
        [vec![condition], numbers.to_vec()].concat()
    };
    rows(&["condition", "participants", "missions played", "completed", "skipped"], counts.into_iter().map(row))
}

/// A condition in words.
pub(super) fn condition(choices: &[Choice]) -> String {
    if choices.is_empty() { "all".to_owned() } else { levels(choices) }
}

pub(super) fn procedure(known: &Known<'_>) -> String {
    let study = &known.records.study;
    let boxes = study.consents.iter().filter(|one| one.is_required).count();
    let mut steps = vec![format!(
        "They read the information sheet (version {}) and consented (version {}, {}).",
        study.information.version,
        study.consent.version,
        counted(boxes, "required checkbox").replace("boxs", "boxes"),
    )];
    steps.extend(study.blocks.iter().map(|block| match block {
        Block::Questionnaires(names) => format!("They answered {}.", listed(&quoted(names))),
        Block::Mission { mission, is_practice, exercises, limits, settings: own, .. } => {
            let named: Vec<String> = exercises.iter().map(|one| format!("`{}`", one.what.name())).collect();
            let how = match (is_practice, named.as_slice()) {
                (false, _) => "once".to_owned(),
                (true, []) => "for practice, under no condition".to_owned(),
                (true, all) => {
                    format!("as a tutorial, under no condition, which waited until they had tried {}", listed(all))
                }
            };
            let own = if own.is_empty() { String::new() } else { format!("; {}", settings(own)) };
            format!("They played `{mission}` {how}{}{own}.", limited(*limits))
        }
        Block::Missions(missions) => {
            let after = |names: &[String], when: &str| match names {
                [] => String::new(),
                names => format!("; after each {when}, {}", listed(&quoted(names))),
            };
            format!(
                "They played {}{}{}{}.",
                listed(&quoted(&study.missions)),
                limited(missions.limits),
                after(&missions.after_mission, "mission"),
                after(&missions.after_condition, "condition")
            )
        }
        Block::Break { limit_s: Some(limit), .. } => format!("They could rest for up to {} min.", limit / 60.0),
        Block::Break { limit_s: None, .. } => "They could rest.".to_owned(),
    }));
    steps.extend(study.debriefing.as_ref().map(|_| "They were debriefed.".to_owned()));
    let probe = |probe: &crate::probe::Probe| format!("`{}` ({})", probe.questionnaire, probe.at.name());
    let probes =
        |pauses: bool| -> Vec<String> { study.probes.iter().filter(|one| one.pauses == pauses).map(probe).collect() };
    let numbered = steps.iter().enumerate().map(|(number, step)| format!("{}. {step}", number + 1));
    let mut text = numbered.collect::<Vec<_>>().join("\n");
    if let Some(pairs) = pairs::procedure(known) {
        text += &format!("\n\n{pairs}");
    }
    for (pauses, how) in [(false, "went on"), (true, "stood still")] {
        let asked = probes(pauses);
        if !asked.is_empty() {
            text += &format!("\n\nDuring each mission, which {how} meanwhile, they were asked {}.", listed(&asked));
        }
    }
    text
}

fn quoted(names: &[String]) -> Vec<String> {
    names.iter().map(|name| format!("`{name}`")).collect()
}

fn limited(limits: Limits) -> String {
    let minutes = |seconds: f64| seconds / 60.0;
    let limit = limits.limit_s.map(|limit| format!("at most {} min", minutes(limit)));
    let skip = limits.skip_after_s.map(|skip| format!("to be skipped after {} min", minutes(skip)));
    let all: Vec<String> = limit.into_iter().chain(skip).collect();
    if all.is_empty() { String::new() } else { format!(", {}", all.join(", ")) }
}

pub(super) fn apparatus(known: &Known<'_>) -> String {
    let (apparatus, study) = (known.apparatus, &known.records.study);
    let programs: Vec<String> = apparatus.programs.iter().cloned().collect();
    let versions = if programs.is_empty() {
        "No session was played yet, so the version of the program is **missing**.".to_owned()
    } else {
        format!("Sessions were played with Cohabit {}.", listed(&programs))
    };
    let catalogs: Vec<String> = apparatus.catalogs.iter().map(|one| format!("`{one}`")).collect();
    let missions = apparatus.missions.iter().map(|(name, prints)| {
        let prints: Vec<String> = prints.iter().map(|print| format!("`{print}`")).collect();
        vec![format!("`{name}`"), prints.join(", ")]
    });
    let varied = |(name, values): (&String, &std::collections::BTreeSet<String>)| {
        vec![format!("`{name}`"), values.iter().cloned().collect::<Vec<_>>().join(", ")]
    };
    let packs: Vec<String> = study.world_ids().iter().map(ToString::to_string).collect();
    let packs = if packs.is_empty() { String::new() } else { format!(" World packs: {}.", listed(&packs)) };
    format!(
        "{versions} All sessions have: {}. The seed of all worlds is {}. Fingerprint of the object catalogue: {}.{packs}\n\n{}\n\n{}",
        settings(&study.settings),
        study.seed,
        listed(&catalogs),
        rows(&["mission", "fingerprint of its text"], missions),
        rows(&["setting, as logs note it", "values"], apparatus.settings.iter().map(varied)),
    )
}
