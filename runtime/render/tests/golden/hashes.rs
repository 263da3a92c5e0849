//! The file of hashes: a line a view, a hash a modality.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

/// What is hashed of a view, in the file's order.
pub const MODALITIES: [&str; 4] = ["colour", "depth", "normals", "ids"];

const HEAD: &str = "# view, then FNV-1a of its colour, depth, normals and ids; written by BLESS=1, see main.rs\n";

/// By view.
#[derive(Default)]
pub struct Hashes(BTreeMap<String, [u64; 4]>);

impl Hashes {
    /// What the file says; nothing where there is none.
    pub fn read(path: &Path) -> Self {
        let text = fs::read_to_string(path).unwrap_or_default();
        let lines = text.lines().filter(|line| !line.starts_with('#') && !line.is_empty());
        Self(lines.map(|line| parse(line).unwrap_or_else(|| panic!("{}: `{line}`", path.display()))).collect())
    }

    pub fn write(&self, path: &Path) {
        let mut text = HEAD.to_owned();
        for (name, hashes) in &self.0 {
            let [color, depth, normals, ids] = hashes;
            writeln!(text, "{name} {color:016x} {depth:016x} {normals:016x} {ids:016x}").unwrap();
        }
        fs::write(path, text).unwrap();
    }

    pub fn get(&self, name: &str) -> Option<[u64; 4]> {
        self.0.get(name).copied()
    }

    pub fn set(&mut self, name: &str, hashes: [u64; 4]) {
        let twin = self.0.insert(name.to_owned(), hashes);
        assert!(twin.is_none(), "two views are called {name}");
    }

    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.0.keys().map(String::as_str)
    }
}

fn parse(line: &str) -> Option<(String, [u64; 4])> {
    let (name, rest) = line.split_once(' ')?;
    let hashes: Option<Vec<u64>> = rest.split(' ').map(|text| u64::from_str_radix(text, 16).ok()).collect();
    Some((name.to_owned(), hashes?.try_into().ok()?))
}

/// FNV-1a.
pub fn fnv(bytes: impl Iterator<Item = u8>) -> u64 {
    bytes.fold(0xCBF2_9CE4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01B3))
}
