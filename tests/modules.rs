//! Which modules at the top of a crate use which others, as the paths in their text say.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

/// Each module with those that it uses.
pub type Uses = BTreeMap<String, BTreeSet<String>>;

/// All Rust files below a folder but those of tests.
pub fn sources(folder: &Path) -> Vec<PathBuf> {
    let (mut files, mut open) = (Vec::new(), vec![folder.to_owned()]);
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(folder).into_iter().flatten() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if path.is_dir() {
                open.extend((name != "tests" && name != "target" && !name.starts_with('.')).then_some(path));
            } else if name.ends_with(".rs") && !name.ends_with("tests.rs") {
                files.push(path);
            }
        }
    }
    files
}

/// Of the crate whose sources are in a folder. A name that the crate's root hands out is its module's.
pub fn uses(src: &Path) -> Uses {
    let Some(root) = ["lib.rs", "main.rs"].map(|name| src.join(name)).into_iter().find(|path| path.is_file()) else {
        return Uses::new();
    };
    let root = code(&root);
    let modules = modules(&root);
    let owners = owners(&root, &modules);
    let used = |module: &str| {
        let (file, folder) = (src.join(format!("{module}.rs")), src.join(module));
        let mut used = BTreeSet::new();
        for path in sources(&folder).into_iter().chain([file.clone()]).filter(|path| path.is_file()) {
            let text = code(&path);
            let mut heads = heads_of_paths(&text, "crate::");
            if path == file || path == folder.join("mod.rs") {
                heads.extend(heads_of_paths(&text, "\nuse super::"));
            }
            used.extend(heads.into_iter().filter_map(|head| owners.get(head)).map(|owner| (*owner).to_owned()));
        }
        used.remove(module);
        used
    };
    modules.iter().map(|&module| (module.to_owned(), used(module))).collect()
}

/// The uses by which modules use themselves, by way of others.
pub fn circular(uses: &Uses) -> BTreeSet<(String, String)> {
    let pairs = uses.iter().flat_map(|(from, all)| all.iter().map(move |to| (from, to)));
    pairs.filter(|(from, to)| leads(uses, to, from)).map(|(from, to)| (from.clone(), to.clone())).collect()
}

fn leads(uses: &Uses, from: &str, to: &str) -> bool {
    let (mut seen, mut open) = (BTreeSet::new(), vec![from]);
    while let Some(next) = open.pop() {
        if next == to {
            return true;
        }
        if seen.insert(next) {
            open.extend(uses.get(next).into_iter().flatten().map(String::as_str));
        }
    }
    false
}

/// The text of a file without comments, and without its unit tests.
fn code(path: &Path) -> String {
    let text = fs::read_to_string(path).unwrap();
    let text = text.split("\nmod tests {").next().unwrap_or_default();
    text.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

/// The modules that a crate's root declares.
fn modules(root: &str) -> BTreeSet<&str> {
    let lines = root.lines().filter_map(|line| {
        let line = line.trim_end();
        let line = line.strip_prefix("pub(crate) ").or_else(|| line.strip_prefix("pub ")).unwrap_or(line);
        line.strip_prefix("mod ")?.strip_suffix(';')
    });
    lines.collect()
}

/// The module of each name that a crate's root knows.
fn owners<'a>(root: &'a str, modules: &BTreeSet<&'a str>) -> BTreeMap<&'a str, &'a str> {
    let mut owners: BTreeMap<&str, &str> = modules.iter().map(|module| (*module, *module)).collect();
    for statement in ["\npub use ", "\npub(crate) use "].into_iter().flat_map(|begin| root.split(begin).skip(1)) {
        let statement = statement.split(';').next().unwrap_or_default();
        let module = head(statement);
        if modules.contains(module) {
            for name in statement.split(|c: char| !is_of_name(c)).filter(|name| !name.is_empty()) {
                owners.entry(name).or_insert(module);
            }
        }
    }
    owners
}

/// The first names of all paths that go on after such a beginning.
fn heads_of_paths<'a>(text: &'a str, begin: &str) -> BTreeSet<&'a str> {
    let paths = text.match_indices(begin).filter(|(at, _)| !text[..*at].ends_with(is_of_name));
    paths.flat_map(|(at, _)| heads(&text[at + begin.len()..])).collect()
}

/// The first name of a path, or those of a list of paths in braces.
fn heads(paths: &str) -> Vec<&str> {
    let Some(list) = paths.strip_prefix('{') else { return vec![head(paths)] };
    let (mut heads, mut depth) = (vec![head(list)], 0_u32);
    for (at, c) in list.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            ',' if depth == 0 => heads.push(head(&list[at + 1..])),
            _ => {}
        }
    }
    heads
}

fn head(path: &str) -> &str {
    let path = path.trim_start();
    &path[..path.find(|c: char| !is_of_name(c)).unwrap_or(path.len())]
}

fn is_of_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

#[test]
fn paths_are_read_as_they_are_written() {
    let text = "use crate::{\n    RATE, engines::{file, INSTALL},\n    vocabulary::Vocabulary,\n};\n\
                let a = crate::page::name(b);\nsubcrate::c();";
    let heads: Vec<_> = heads_of_paths(text, "crate::").into_iter().filter(|head| !head.is_empty()).collect();
    assert_eq!(heads, ["RATE", "engines", "page", "vocabulary"]);
    assert_eq!(modules("mod a;\npub mod b;\npub(crate) mod c;\nmod d {\n"), BTreeSet::from(["a", "b", "c"]));
    let root = "mod a;\nmod b;\npub use a::{X, y as Y};\npub use other::Z;\n";
    let owners = owners(root, &modules(root));
    assert_eq!((owners.get("X"), owners.get("Y"), owners.get("Z")), (Some(&"a"), Some(&"a"), None));
}

#[test]
fn what_is_used_by_way_of_others_is_found() {
    let uses = |pairs: &[(&str, &str)]| {
        let mut uses = Uses::new();
        for (from, to) in pairs {
            uses.entry((*from).to_owned()).or_default().insert((*to).to_owned());
        }
        uses
    };
    assert!(circular(&uses(&[("a", "b"), ("b", "c"), ("a", "c")])).is_empty());
    let found = circular(&uses(&[("a", "b"), ("b", "c"), ("c", "a"), ("c", "d")]));
    assert_eq!(found.iter().map(|(from, to)| format!("{from}{to}")).collect::<Vec<_>>(), ["ab", "bc", "ca"]);
}
