//! Submissions beside each other, and beside the paper.

use std::collections::{BTreeMap, BTreeSet};

use cohabit_tables::{Align, columns};

use crate::{
    mission::Split,
    paper::{Paper, PaperMethod},
    submission::Header,
    totals::{SplitTotals, Tally},
};

/// Whether a submission holds.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Check {
    /// It was played again: nothing differs.
    Verified,
    /// It was played again: so many things differ.
    Differs(usize),
    /// It was not played again.
    NotVerified,
}

/// A submission in the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// The name of its file.
    pub file: String,
    /// Its header.
    pub header: Header,
    /// Whether it holds.
    pub check: Check,
}

/// One table.
#[derive(Clone, Debug, Default, Eq, PartialEq)]
pub struct Grid {
    /// What it is of.
    pub title: String,
    /// The names of its columns.
    pub head: Vec<String>,
    /// Its rows, each with a cell for each column.
    pub rows: Vec<Vec<String>>,
    /// What is to be known of it; may be empty.
    pub note: String,
}

/// All tables: the submissions by what they solve in tests, best first; by what is held out and by type of mission; who they are;
/// and the figures of the paper.
#[must_use]
pub fn grids(entries: &[Entry]) -> Vec<Grid> {
    let mut sorted: Vec<&Entry> = entries.iter().collect();
    let rates = |entry: &Entry| [Split::Test, Split::Validation].map(|split| msr(entry, split));
    sorted.sort_by(|one, other| {
        let ([test, validation], [next_test, next_validation]) = (rates(one), rates(other));
        let by_rate = next_test.total_cmp(&test).then(next_validation.total_cmp(&validation));
        by_rate.then_with(|| one.file.cmp(&other.file))
    });
    let mut grids = vec![overall(&sorted)];
    for split in [Split::Test, Split::Validation] {
        let of = |by: &str| format!("MSR by {by} ({})", split.name());
        grids.push(by(&of("what training does not have"), &sorted, split, |totals| &totals.parts));
        grids.push(by(&of("type of mission"), &sorted, split, |totals| &totals.types));
    }
    grids.push(agents(&sorted));
    grids.extend(of_paper(&Paper::builtin()));
    grids.retain(|grid| !grid.rows.is_empty());
    grids
}

fn totals(entry: &Entry, split: Split) -> Option<&SplitTotals> {
    entry.header.totals.as_ref()?.get(&split)
}

/// What orders submissions; those without a figure come last.
fn msr(entry: &Entry, split: Split) -> f64 {
    totals(entry, split).map_or(-1.0, |totals| totals.all.msr)
}

fn overall(entries: &[&Entry]) -> Grid {
    let rows = entries.iter().map(|entry| {
        let figures = [Split::Test, Split::Validation].into_iter().flat_map(|split| {
            let tally = totals(entry, split).map(|totals| &totals.all);
            [rate(tally), tally.map_or_else(String::new, |tally| format!("{:.1}", tally.nra))]
        });
        let first = [entry.header.agent.name.clone(), yes(entry.header.agent.questions)];
        first.into_iter().chain(figures).chain([verified(entry.check)]).collect()
    });
    Grid {
        title: "Submissions".to_owned(),
        head: words(&["agent", "questions", "test MSR %", "NRA", "validation MSR %", "NRA", "verified"]),
        rows: rows.collect(),
        note: format!(
            "MSR: mission success rate, with its 95 % interval (Wilson). NRA: number of robot actions, mean of all missions.{}",
            apart(entries)
        ),
    }
}

/// That submissions are of several benchmarks, and how to tell which, if they are: a version alone does not tell them apart.
fn apart(entries: &[&Entry]) -> String {
    let mut files = BTreeMap::<&str, Vec<&str>>::new();
    for entry in entries {
        files.entry(&entry.header.missions).or_default().push(&entry.file);
    }
    if files.len() < 2 {
        return String::new();
    }
    let groups: Vec<String> = files.values().map(|files| files.join(", ")).collect();
    format!(
        " These are of {} benchmarks with other missions each, and cannot be compared: {}. Put those of each in a folder of their own.",
        groups.len(),
        groups.join("; ")
    )
}

fn by(title: &str, entries: &[&Entry], split: Split, groups: fn(&SplitTotals) -> &BTreeMap<String, Tally>) -> Grid {
    let played: Vec<(&Entry, &BTreeMap<String, Tally>)> =
        entries.iter().filter_map(|entry| Some((*entry, groups(totals(entry, split)?)))).collect();
    let names: BTreeSet<&String> = played.iter().flat_map(|(_, groups)| groups.keys()).collect();
    let count = |name: &String| {
        let tally = played.iter().find_map(|(_, groups)| groups.get(name));
        tally.map_or(0, |tally| tally.missions)
    };
    let rows = names.into_iter().map(|name| {
        let figures = played.iter().map(|(_, groups)| rate(groups.get(name)));
        [name.clone(), count(name).to_string()].into_iter().chain(figures).collect()
    });
    let rows = rows.collect();
    let agents = played.iter().map(|(entry, _)| named(&entry.header.agent.name, entry.header.agent.questions));
    let head = words(&["", "missions"]).into_iter().chain(agents).collect();
    Grid { title: title.to_owned(), head, rows, note: String::new() }
}

fn agents(entries: &[&Entry]) -> Grid {
    let rows = entries.iter().map(|entry| {
        let Header { agent, program, machine, benchmark, .. } = &entry.header;
        let settings: Vec<String> = agent.settings.iter().map(|(name, value)| format!("{name}={value}")).collect();
        let [name, version, description] = [&agent.name, &agent.version, &agent.description].map(Clone::clone);
        let played = [benchmark.to_string(), program.clone(), machine.clone(), entry.file.clone()];
        [name, version, description, settings.join(", ")].into_iter().chain(played).collect()
    });
    Grid {
        title: "Agents".to_owned(),
        head: words(&["agent", "version", "what it is", "settings", "benchmark", "program", "machine", "file"]),
        rows: rows.collect(),
        note: "What is said of an agent is its author's word; what it did can be verified: `cohabit benchmark verify FILE`."
            .to_owned(),
    }
}

/// The tables of the paper.
fn of_paper(paper: &Paper) -> [Grid; 3] {
    let note = format!("{} {}", paper.caution, paper.source);
    let overall = paper.methods.iter().map(|method| {
        vec![method.name.clone(), yes(method.questions), format!("{:.2}", method.msr), format!("{:.2}", method.nra)]
    });
    let types: BTreeSet<&String> = paper.methods.iter().flat_map(|method| method.types.keys()).collect();
    let rate = |method: &PaperMethod, name: &String| {
        method.types.get(name).map_or_else(String::new, |rate| format!("{rate:.2}"))
    };
    let by_type = types.into_iter().map(|name| {
        std::iter::once(name.clone()).chain(paper.methods.iter().map(|method| rate(method, name))).collect()
    });
    let vision = paper.vision.iter().map(|vision| {
        let [from, to] = vision.area_px2;
        let area = format!("{from} – {to}");
        vec![vision.category.clone(), area, format!("{:.2}", vision.map), format!("{:.2}", vision.t_map)]
    });
    let methods = paper.methods.iter().map(|method| named(&method.name, method.questions));
    [
        Grid {
            title: "The paper on Alexa Arena: agents".to_owned(),
            head: words(&["agent", "questions", "validation MSR %", "NRA"]),
            rows: overall.collect(),
            note: note.clone(),
        },
        Grid {
            title: "The paper on Alexa Arena: MSR by type of mission (validation)".to_owned(),
            head: words(&[""]).into_iter().chain(methods).collect(),
            rows: by_type.collect(),
            note: note.clone(),
        },
        Grid {
            title: "The paper on Alexa Arena: vision model".to_owned(),
            head: words(&["size", "area px²", "COCO mAP %", "t-mAP %"]),
            rows: vision.collect(),
            note,
        },
    ]
}

fn words(words: &[&str]) -> Vec<String> {
    words.iter().map(|word| (*word).to_owned()).collect()
}

fn named(name: &str, questions: bool) -> String {
    if questions { format!("{name}, with questions") } else { name.to_owned() }
}

fn yes(is_so: bool) -> String {
    let word = if is_so { "yes" } else { "no" };
    word.to_owned()
}

fn verified(check: Check) -> String {
    match check {
        Check::Verified => "yes".to_owned(),
        Check::Differs(1) => "no: 1 difference".to_owned(),
        Check::Differs(count) => format!("no: {count} differences"),
        Check::NotVerified => "not checked".to_owned(),
    }
}

/// `70.8 (66.6 – 74.7)`; nothing, where nothing was played.
fn rate(tally: Option<&Tally>) -> String {
    tally.map_or_else(String::new, |tally| {
        let [low, high] = tally.interval_95;
        format!("{:.1} ({:.1} – {:.1})", tally.msr * 100.0, low * 100.0, high * 100.0)
    })
}

/// Tables as plain text, their columns one below the other.
#[must_use]
pub fn text(grids: &[Grid]) -> String {
    let mut text = String::new();
    for grid in grids {
        let lines: Vec<Vec<String>> = std::iter::once(&grid.head).chain(&grid.rows).cloned().collect();
        text.push_str(&grid.title);
        text.push('\n');
        text.push_str(&columns(&lines, Align::Left));
        if !grid.note.is_empty() {
            text.push_str(&grid.note);
            text.push('\n');
        }
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::submission::AgentCard;

    fn entry(name: &str, solved: usize, check: Check) -> Entry {
        let msr = solved as f64 / 4.0;
        let tally = Tally { missions: 4, solved, msr, interval_95: [0.1, 0.9], ..Tally::default() };
        let parts = BTreeMap::from([("seen".to_owned(), tally)]);
        let types = BTreeMap::from([("clean&deliver".to_owned(), tally)]);
        let totals = BTreeMap::from([(Split::Test, SplitTotals { all: tally, parts, types })]);
        let header = Header {
            format: Header::FORMAT,
            benchmark: 1,
            missions: String::new(),
            world: Vec::new(),
            splits: vec![Split::Test],
            agent: AgentCard { name: name.to_owned(), ..AgentCard::default() },
            program: "0".to_owned(),
            machine: String::new(),
            totals: Some(totals),
        };
        Entry { file: format!("{name}.jsonl"), header, check }
    }

    #[test]
    fn the_best_comes_first_and_what_was_not_played_is_left_out() {
        let entries = [entry("low", 1, Check::NotVerified), entry("high", 3, Check::Differs(2))];
        let grids = grids(&entries);
        let first: Vec<&str> = grids[0].rows.iter().map(|row| row[0].as_str()).collect();
        assert_eq!(first, ["high", "low"]);
        assert_eq!(grids[0].rows[0][2], "75.0 (10.0 – 90.0)");
        assert_eq!(grids[0].rows[0].last().map(String::as_str), Some("no: 2 differences"));
        assert!(grids.iter().all(|grid| !grid.title.ends_with("(validation)") || grid.title.contains("paper")));
        for grid in &grids {
            assert!(grid.rows.iter().all(|row| row.len() == grid.head.len()), "{grid:?}");
        }
        let text = text(&grids);
        assert!(text.contains("clean&deliver") && text.contains("arXiv:2303.01586"), "{text}");
    }

    #[test]
    fn without_submissions_there_is_the_paper() {
        assert!(grids(&[]).iter().all(|grid| grid.title.contains("paper")));
    }
}
