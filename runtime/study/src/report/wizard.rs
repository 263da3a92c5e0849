//! What a wizard decided: how often the robot did something else than it would have by itself, and how long it took.

use std::collections::BTreeMap;

use cohabit_dialog::OnTimeout;
use cohabit_tables::Cell;

use super::{
    Known, counted,
    latencies::{conditions, quantile},
    listed, rows,
};
use crate::{
    settings::{has_wizard, response_delay_ms},
    wizard::Wizard,
};

/// The columns of counts: a head, and the outcomes that it counts.
const COUNTS: [(&str, &str); 8] = [
    ("accepted", "accepted"),
    ("edited", "edited"),
    ("replaced", "replaced"),
    ("dismissed", "dismissed"),
    ("timed out", "timed_out"),
    ("stopped by the participant", "stopped"),
    ("unprompted", "unprompted"),
    ("undecided at the end", "undecided"),
];

/// What was decided under one condition.
#[derive(Default)]
struct Count {
    outcomes: BTreeMap<String, usize>,
    interventions: usize,
    late: usize,
    decided_ms: Vec<f64>,
}

pub(super) fn section(known: &Known<'_>) -> String {
    if !known.records.study.has_wizard() {
        return "No wizard took part.".to_owned();
    }
    let Some(decisions) = known.table("decisions").filter(|table| !table.rows.is_empty()) else {
        return format!("{} Nothing was decided in any session yet, so interventions are **missing**.", setting(known));
    };
    let text = |cell: &Cell| if let Cell::Text(text) = cell { text.clone() } else { String::new() };
    let is_true = |cell: &Cell| *cell == Cell::Flag(true);
    let mut counts = BTreeMap::<String, Count>::new();
    let columns = decisions.column("outcome").zip(decisions.column("intervention"));
    let columns = columns.zip(decisions.column("late")).zip(decisions.column("decided_ms"));
    for (condition, (((outcome, intervention), late), decided)) in conditions(decisions).into_iter().zip(columns) {
        for group in [String::from("all"), condition].into_iter().filter(|group| !group.is_empty()) {
            let count = counts.entry(group).or_default();
            *count.outcomes.entry(text(outcome)).or_default() += 1;
            count.interventions += usize::from(is_true(intervention));
            count.late += usize::from(is_true(late));
            if let Cell::Real(ms) = decided {
                count.decided_ms.push(*ms);
            }
        }
    }
    let head = ["condition", "decisions"].into_iter().chain(COUNTS.map(|(head, _)| head));
    let head: Vec<&str> = head.chain(["interventions", "late", "median time to decide"]).collect();
    let injected = decisions.column("injected").filter(|cell| is_true(cell)).count();
    let summary = format!("{}{}", summary(&counts), of_errors(injected));
    format!("{}\n\n{summary}\n\n{}", setting(known), rows(&head, counts.iter().map(row)))
}

/// The sentence that a paper needs.
fn summary(counts: &BTreeMap<String, Count>) -> String {
    let Some(all) = counts.get("all") else { return String::new() };
    let total: usize = all.outcomes.values().sum();
    let share = 100.0 * all.interventions as f64 / total.max(1) as f64;
    format!(
        "Of {}, {} were interventions ({share:.1} %): the robot did something else than it would have done by itself.",
        counted(total, "decision"),
        all.interventions
    )
}

fn of_errors(injected: usize) -> String {
    let were = if injected == 1 { "was" } else { "were" };
    if injected == 0 { String::new() } else { format!(" {} {were} injected.", counted(injected, "planned error")) }
}

fn row((condition, count): (&String, &Count)) -> Vec<String> {
    let total: usize = count.outcomes.values().sum();
    let of = |outcome: &str| count.outcomes.get(outcome).copied().unwrap_or(0).to_string();
    let mut times = count.decided_ms.clone();
    times.sort_by(f64::total_cmp);
    let median = if times.is_empty() { "–".to_owned() } else { format!("{:.0} ms", quantile(&times, 0.5)) };
    [condition.clone(), total.to_string()]
        .into_iter()
        .chain(COUNTS.map(|(_, outcome)| of(outcome)))
        .chain([count.interventions.to_string(), count.late.to_string(), median])
        .collect()
}

/// How the wizard took part.
fn setting(known: &Known<'_>) -> String {
    let study = &known.records.study;
    let Wizard { timeout_s, on_timeout, phrases, errors, .. } = &study.wizard;
    let keys: Vec<String> = phrases.iter().map(|phrase| format!("`{}` \"{}\"", phrase.key, phrase.text)).collect();
    let phrases =
        if keys.is_empty() { "no canned phrases".to_owned() } else { format!("canned phrases {}", listed(&keys)) };
    let names: Vec<String> = errors.iter().map(|error| format!("\"{}\"", error.name)).collect();
    let injects = || format!(", and injects planned errors: {}", listed(&names));
    let errors = if names.is_empty() { String::new() } else { injects() };
    let who = if known.records.is_synthetic {
        "No wizard decided anything: the dry run took each proposal for accepted. In the study "
    } else {
        ""
    };
    format!(
        "{who}a wizard decides of each answer in sessions with the setting `wizard` = `yes`. What participants say is understood by the \
         robot as ever, and held back; the wizard sees the robot's own interpretation, and accepts it, has another request \
         understood in its place, or replaces it. {} The wizard has {phrases}{errors}. {}",
        time(*timeout_s, *on_timeout),
        delays(known)
    )
}

fn time(timeout_s: Option<f64>, on_timeout: OnTimeout) -> String {
    let Some(seconds) = timeout_s else { return "There is no limit to how long a decision takes.".to_owned() };
    let follows = match on_timeout {
        OnTimeout::Act => "the robot does what it proposed",
        OnTimeout::Say => "it says that it takes a moment, and waits on",
        OnTimeout::Wait => "it waits on",
    };
    format!("A decision may take {seconds} s; after that {follows}.")
}

fn delays(known: &Known<'_>) -> String {
    let all = known.records.study.all_settings();
    let of = |wizard: bool| {
        let mut all: Vec<u64> =
            all.iter().filter(|settings| has_wizard(settings) == wizard).map(response_delay_ms).collect();
        all.sort_unstable();
        all.dedup();
        let all: Vec<String> = all.iter().map(|ms| format!("{ms} ms")).collect();
        listed(&all)
    };
    format!("Nothing is answered sooner than {} after it was said with a wizard, and {} without.", of(true), of(false))
}
