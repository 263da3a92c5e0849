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
    /// Who the wizards were, which only the experimenter knows.
    Wizards,
    /// What they could do.
    Controls,
    /// What they saw.
    Perceives,
    /// What they did otherwise than the robot.
    Interventions,
    /// How long they might take.
    Time,
    /// Only the experimenter knows.
    Experimenter,
}

const NO_WIZARD: &str = "no wizard took part";

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
    ("wizard", "how many wizards", Source::Wizards),
    ("wizard", "demographics, and relation to the research", Source::Wizards),
    ("wizard", "what they knew of the hypotheses", Source::Wizards),
    ("wizard", "what they controlled, and how", Source::Controls),
    ("wizard", "what they perceived, and how", Source::Perceives),
    ("wizard", "training", Source::Wizards),
    ("wizard", "errors, and how they were measured", Source::Interventions),
    ("wizard", "instructions, and constraints of response time", Source::Time),
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
    let missing = ITEMS.iter().filter(|(.., source)| answer(known, *source).0 == MISSING).count();
    format!(
        "After Riek (2012): of {} items {missing} are missing, which only the experimenter knows.\n\n{}",
        ITEMS.len(),
        rows(&["about", "item", "state", "what is known"], ITEMS.into_iter().map(row))
    )
}

/// The state of what only the experimenter knows.
const MISSING: &str = "missing";

fn answer(known: &Known<'_>, source: Source) -> (&'static str, String) {
    let study = &known.records.study;
    let has_wizard = study.has_wizard();
    let of_wizard =
        |what: &str| if has_wizard { ("present", what.to_owned()) } else { ("does not apply", NO_WIZARD.to_owned()) };
    match source {
        Source::Robots => ("present", "simulated, one in each session unless `body` is set; see Apparatus".to_owned()),
        Source::Autonomy if has_wizard => (
            "present",
            "it acts on its own on what participants say, but where a wizard takes part, who decides of each answer; see Wizard".to_owned(),
        ),
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
        Source::Wizards if has_wizard => (MISSING, "**add it**".to_owned()),
        Source::Wizards => ("does not apply", NO_WIZARD.to_owned()),
        Source::Controls => of_wizard("each answer of the robot: what it says and does, in words and by plain requests; see Wizard"),
        Source::Perceives => of_wizard(
            "at a page of their own: what the robot sees, the conversation as participants see it, and the robot's own interpretation",
        ),
        Source::Interventions => {
            of_wizard("each decision is recorded beside what the robot proposed (`decisions.csv`); counts are in Wizard")
        }
        Source::Time => of_wizard("the time-out and the delay of answers are in Wizard; **add** the protocol that wizards followed"),
        Source::Experimenter => (MISSING, "**add it**".to_owned()),
    }
}
