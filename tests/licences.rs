//! Each large data or model file has its origin and licence in `runtime/DATA.md`.
#![allow(clippy::unwrap_used)]

use std::{
    fs,
    path::{Path, PathBuf},
};

/// Files above this size are listed, bytes.
const LARGE: u64 = 100_000;
/// Where data lie, from the root of the repository.
const FOLDERS: [&str; 5] = ["agents", "cdf", "dialog", "runtime", "tests"];
/// What is no data: source, what is written about it, and what is built.
const OTHER_ENDINGS: [&str; 5] = ["rs", "md", "lock", "so", "pyc"];
/// Folders that are not in the repository, beside hidden ones: what is built, and what fits are worked out from.
const NOT_KEPT: [&str; 4] = ["target", "contexts", "node_modules", "__pycache__"];
/// Licences that data of the repository may have.
const LICENCES: [&str; 2] = ["Project", "Apache-2.0"];

/// A row of the table.
#[derive(Debug)]
struct Row<'a> {
    path: &'a str,
    origin: &'a str,
    licence: &'a str,
}

impl Row<'_> {
    /// Whether a file, by its path from the root, is meant.
    fn covers(&self, file: &str) -> bool {
        if self.path.ends_with('/') { file.starts_with(self.path) } else { file == self.path }
    }
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The rows of a table of four columns, whose first cell is a path.
fn rows(text: &str) -> Vec<Row<'_>> {
    text.lines()
        .filter(|line| line.starts_with("| `"))
        .map(|line| {
            let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
            let [path, _, origin, licence] = cells[..] else { panic!("not four columns: {line}") };
            Row { path: path.trim_matches('`'), origin, licence }
        })
        .collect()
}

/// Data files above a size, by their paths from the root, in their order.
fn large_files(above: u64) -> Vec<String> {
    let root = root();
    let mut open: Vec<PathBuf> = FOLDERS.iter().map(|folder| root.join(folder)).collect();
    let mut files = Vec::new();
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(&folder).unwrap() {
            let entry = entry.unwrap();
            let (path, kind) = (entry.path(), entry.file_type().unwrap());
            let name = entry.file_name().to_string_lossy().into_owned();
            if kind.is_dir() {
                let is_kept = !name.starts_with('.') && !NOT_KEPT.contains(&name.as_str());
                open.extend(is_kept.then_some(path));
            } else if kind.is_file() && entry.metadata().unwrap().len() > above {
                let ending = path.extension().unwrap_or_default().to_string_lossy().into_owned();
                let path = path.strip_prefix(&root).unwrap().to_str().unwrap().to_owned();
                files.extend((!OTHER_ENDINGS.contains(&ending.as_str())).then_some(path));
            }
        }
    }
    files.sort();
    files
}

#[test]
fn each_large_file_has_its_origin_and_licence() {
    let text = fs::read_to_string(root().join("runtime/DATA.md")).unwrap();
    let rows = rows(&text);
    for file in large_files(LARGE) {
        let covering = rows.iter().filter(|row| row.covers(&file)).count();
        assert_eq!(covering, 1, "{file}: give it one row in runtime/DATA.md, with its origin and licence");
    }
}

#[test]
fn each_row_is_of_something_and_says_all() {
    let text = fs::read_to_string(root().join("runtime/DATA.md")).unwrap();
    let rows = rows(&text);
    assert!(!rows.is_empty());
    for row in &rows {
        let path = root().join(row.path);
        let is_there = if row.path.ends_with('/') { path.is_dir() } else { path.is_file() };
        assert!(is_there, "{row:?}: there is no such path");
        assert!(!row.origin.is_empty() && LICENCES.contains(&row.licence), "{row:?}");
    }
}

#[test]
fn a_row_covers_a_file_or_a_folder() {
    let head = "| path | what | origin | licence |\n|---|---|---|---|\n";
    let text = format!("{head}| `a/` | x | here | Project |\n| `b.txt` | x | there | Apache-2.0 |\n");
    let rows = rows(&text);
    assert_eq!(rows.len(), 2);
    assert_eq!((rows[1].path, rows[1].origin, rows[1].licence), ("b.txt", "there", "Apache-2.0"));
    for (file, expected) in [("a/b/c", [true, false]), ("b.txt", [false, true]), ("ab", [false, false])] {
        assert_eq!([0, 1].map(|row: usize| rows[row].covers(file)), expected, "{file}");
    }
}
