//! The items that a Wizard of Oz study in human-robot interaction is to report, by L. D. Riek: Wizard of Oz studies in HRI: a systematic
//! review and new reporting guidelines, Journal of Human-Robot Interaction 1(1), 2012; in our words. Each is present, or named as
//! missing.

use super::{Known, counted, rows};
use crate::design::FactorKind;

/// Where an item's answer is from.
#[derive(Clone, Copy)]
enum Source {
    Robots,
    Autonomy,
    Participants,
    Instructions,
    Scenarios,
    Wizard,
    /// Only the experimenter knows.
    Experimenter,
}

const ITEMS: [(&str, &str, Source); 22] = [
    ("robot", "how many robots", Source::Robots),
    ("robot", "what kind of robot", Source::Robots),
    ("robot", "level of autonomy", Source::Autonomy),
    ("robot", "capabilities and hardware", Source::Robots),
    ("participants", "how many, in all and by condition", Source::Participants),
    ("participants", "demographics", Source::Experimenter),
    ("participants", "sampling and incentives", Source::Experimenter),
    ("participants", "instructions", Source::Instructions),
    ("participants", "hypotheses about their behaviour", Source::Experimenter),
    ("participants", "whether they were simulated", Source::Participants),
    ("wizard", "how many wizards", Source::Wizard),
    ("wizard", "demographics, and relation to the research", Source::Wizard),
    ("wizard", "what they knew of the hypotheses", Source::Wizard),
    ("wizard", "what they controlled, and how", Source::Wizard),
    ("wizard", "what they perceived, and how", Source::Wizard),
    ("wizard", "training", Source::Wizard),
    ("wizard", "errors, and how they were measured", Source::Wizard),
    ("wizard", "instructions, and constraints of response time", Source::Wizard),
    ("general", "place and environment", Source::Experimenter),
    ("general", "scenarios", Source::Scenarios),
    ("general", "part of an iterative design", Source::Experimenter),
    ("general", "limits of Wizard of Oz, discussed", Source::Experimenter),
];

pub(super) fn section(known: &Known<'_>) -> String {
    let row = |(category, item, source): (&str, &str, Source)| {
        let (state, what) = answer(known, source);
        vec![category.to_owned(), item.to_owned(), state.to_owned(), what]
    };
    let missing = ITEMS.iter().filter(|(.., source)| matches!(source, Source::Experimenter)).count();
    format!(
        "After Riek (2012): of {} items {missing} are missing, which only the experimenter knows.\n\n{}",
        ITEMS.len(),
        rows(&["about", "item", "state", "what is known"], ITEMS.into_iter().map(row))
    )
}

fn answer(known: &Known<'_>, source: Source) -> (&'static str, String) {
    let study = &known.records.study;
    match source {
        Source::Robots => ("present", "simulated, one in each session unless `body` is set; see Apparatus".to_owned()),
        Source::Autonomy => ("present", "it acts on its own on what participants say: no wizard takes part".to_owned()),
        Source::Participants => {
            let who = if known.records.is_synthetic { "simulated participants" } else { "people" };
            let conditions = study.conditions(FactorKind::Between).len() * study.conditions(FactorKind::Within).len();
            let all = known.records.progress.len() + known.records.withdrawn.len();
            ("present", format!("{all} {who}, {}; see Participants, and Design", counted(conditions, "condition")))
        }
        Source::Instructions => {
            let version = &study.information.version;
            ("present", format!("information sheet, version {version}; texts before missions are in `study/`"))
        }
        Source::Scenarios => {
            ("present", format!("{}; see Apparatus", counted(known.apparatus.missions.len(), "mission")))
        }
        Source::Wizard => ("does not apply", "no wizard took part".to_owned()),
        Source::Experimenter => ("missing", "**add it**".to_owned()),
    }
}
