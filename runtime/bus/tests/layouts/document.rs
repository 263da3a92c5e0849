//! The document: what programs in other languages read by.

use std::{collections::BTreeMap, fmt::Write as _};

use cohabit_bus::Envelope;
use cohabit_cdf::{BodyKind, Color, Fluid, RoomId, StateFlag, Status, Verb};

use crate::{
    payload::Payload,
    source::{Field, Kinds, Record, Source},
};

const PREFACE: &str = "# Layouts of the messages

What lies in shared memory, byte by byte, for programs that do not use this crate. Written from the source by
`BLESS=1 cargo test -p cohabit-bus --test layouts`; a test fails where this page and the code differ.

Numbers are little-endian. A sample is 64-byte blocks on a 64-byte boundary: the first is the `Envelope`, the payload
begins with the second, and `payload_bytes` says where it ends. Records lie one behind the other without padding; a list
begins on an 8-byte boundary from the payload's start, and what is between is zero. `Text<N>` is a `u16` length, then
`N` bytes of UTF-8 of which so many count; the rest is zero.
";

/// The unit that a field's name ends in.
const UNITS: [(&str, &str); 6] =
    [("_m", "m"), ("_rad", "rad"), ("_nanos", "ns"), ("_bytes", "bytes"), ("_at", "bytes"), ("pixels", "pixels")];

/// The whole page.
pub fn write(source: &Source, payloads: &[Payload]) -> String {
    let mut page = PREFACE.to_owned();
    let _ =
        writeln!(page, "\nVersion {} of the messages, which every envelope names.\n\n## Payloads\n", Envelope::VERSION);
    page += "| topic | payload |\n|---|---|\n";
    for payload in payloads {
        let lists: String =
            payload.lists.iter().map(|(record, count)| format!(", then {record} × `{count}`")).collect();
        let _ = writeln!(page, "| `{}` | {}{lists}{} |", payload.topic, payload.header, payload.note);
    }
    page += "\n## Records\n";
    source.records.iter().for_each(|record| write_record(&mut page, record));
    page += "\n## Kinds and constants\n";
    source.kinds.iter().for_each(|kinds| write_kinds(&mut page, kinds));
    page += "\n## Numbers that the mission format gives names to\n\n| what | numbers |\n|---|---|\n";
    for (what, numbers) in shared_numbers() {
        let _ = writeln!(page, "| `{what}` | {numbers} |");
    }
    page
}

fn write_record(page: &mut String, record: &Record) {
    let _ = write!(page, "\n### {}\n{} {} bytes.\n\n", record.name, record.doc, record.bytes());
    *page += "| offset | bytes | field | type | unit | meaning |\n|---:|---:|---|---|---|---|\n";
    for field in &record.fields {
        let Field { name, doc, type_name, offset, bytes } = field;
        let _ = writeln!(page, "| {offset} | {bytes} | `{name}` | `{type_name}` | {} | {doc} |", unit(name));
    }
}

fn unit(field: &str) -> &'static str {
    UNITS.iter().find(|(ending, _)| field.ends_with(ending)).map_or("", |(_, unit)| unit)
}

fn write_kinds(page: &mut String, kinds: &Kinds) {
    let _ = write!(page, "\n### {}\n{}\n\n| value | name | meaning |\n|---:|---|---|\n", kinds.name, kinds.doc);
    for (value, name, doc) in &kinds.values {
        let _ = writeln!(page, "| {value} | `{name}` | {doc} |");
    }
}

fn shared_numbers() -> Vec<(&'static str, String)> {
    fn list<T: std::fmt::Debug>(all: &[T]) -> String {
        all.iter().enumerate().map(|(number, name)| format!("{number} {name:?}")).collect::<Vec<_>>().join(", ")
    }
    vec![
        ("Status", list(&Status::ALL)),
        ("Verb", list(&Verb::ALL)),
        ("RoomId", list(&RoomId::BUILTIN)),
        ("BodyKind", list(&BodyKind::ALL)),
        ("Color", list(&Color::ALL)),
        ("Fluid", list(&Fluid::ALL)),
        ("StateFlags, by bit", list(&StateFlag::ALL)),
    ]
}

/// By record, what a page says of offset, bytes, field and type.
pub fn layouts(page: &str) -> BTreeMap<String, Vec<String>> {
    let mut layouts = BTreeMap::<String, Vec<String>>::new();
    let mut record = String::new();
    let records = page.split("\n## ").find(|part| part.starts_with("Records")).unwrap_or_default();
    for line in records.lines() {
        if let Some(name) = line.strip_prefix("### ") {
            name.clone_into(&mut record);
        } else if line.starts_with("| ") && line.contains('`') {
            let cells: Vec<_> = line.split('|').skip(1).take(4).map(str::trim).collect();
            layouts.entry(record.clone()).or_default().push(cells.join(" "));
        }
    }
    layouts
}

/// The version that a page names.
pub fn version(page: &str) -> Option<u32> {
    page.lines().find_map(|line| line.strip_prefix("Version ")?.split(' ').next()?.parse().ok())
}

/// Lines of one page that the other lacks, both ways.
pub fn difference(old: &str, new: &str) -> String {
    let lacks = |here: &str, there: &str, sign: char| -> String {
        here.lines()
            .filter(|line| !there.lines().any(|other| other == *line))
            .map(|line| format!("{sign} {line}\n"))
            .collect()
    };
    lacks(old, new, '-') + &lacks(new, old, '+')
}
