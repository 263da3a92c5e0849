//! Files of missions parted for training and for tests, with their manifest.

use std::{
    collections::BTreeMap,
    fs::{self, File},
    io::{self, BufRead as _, BufReader, BufWriter, Write as _},
    path::{Path, PathBuf},
};

use cohabit_generate::{Facets, Part, Parted, part};
use serde_json::{Value, json};

use crate::{failure::environment, terminal::shown};

/// What was asked for, as the manifest notes it.
#[derive(Clone, Copy)]
pub struct Asked<'a> {
    /// The specification.
    pub spec: &'a str,
    /// The seed.
    pub seed: u64,
    /// The share of each part.
    pub share: f64,
}

/// One file that is being written.
struct Set {
    path: PathBuf,
    out: BufWriter<File>,
    hasher: blake3::Hasher,
    missions: usize,
}

/// Writes the lines of a file of missions into one file for each part of a folder, in their order, and a `manifest.json` that says
/// what is held out; the manifest comes last, so that what has one is whole.
pub fn write(missions: &Path, facets: &[Facets], folder: &Path, asked: Asked<'_>) -> anyhow::Result<()> {
    let Parted { held_out, parts } = part(facets, asked.share, asked.seed);
    fs::create_dir_all(folder).map_err(|error| failed(folder, &error))?;
    let manifest = folder.join("manifest.json");
    if manifest.exists() {
        fs::remove_file(&manifest).map_err(|error| failed(&manifest, &error))?;
    }
    let mut sets = BTreeMap::new();
    for part in Part::ALL {
        sets.insert(part, Set::create(folder.join(format!("{}.jsonl", part.name())))?);
    }
    let lines = BufReader::new(File::open(missions).map_err(|error| failed(missions, &error))?).lines();
    for (line, part) in lines.zip(parts) {
        let line = line.map_err(|error| failed(missions, &error))?;
        if let Some(set) = sets.get_mut(&part) {
            set.push(&line)?;
        }
    }
    let mut files = BTreeMap::new();
    for (part, set) in sets {
        println!("{}: {} missions: {}", part.name(), set.missions, shown(set.path.display()));
        files.insert(part.name(), set.finish()?);
    }
    let text = json!({
        "program": env!("CARGO_PKG_VERSION"),
        "specification": asked.spec,
        "seed": asked.seed,
        "share": asked.share,
        "missions": facets.len(),
        "held_out": held_out,
        "files": files,
    });
    fs::write(&manifest, format!("{text:#}\n")).map_err(|error| failed(&manifest, &error))
}

impl Set {
    fn create(path: PathBuf) -> anyhow::Result<Self> {
        let out = BufWriter::new(File::create(&path).map_err(|error| failed(&path, &error))?);
        Ok(Self { path, out, hasher: blake3::Hasher::new(), missions: 0 })
    }

    fn push(&mut self, line: &str) -> anyhow::Result<()> {
        let line = format!("{line}\n");
        self.hasher.update(line.as_bytes());
        self.missions += 1;
        self.out.write_all(line.as_bytes()).map_err(|error| failed(&self.path, &error))
    }

    /// What the manifest says of it, once it is whole.
    fn finish(mut self) -> anyhow::Result<Value> {
        self.out.flush().map_err(|error| failed(&self.path, &error))?;
        let name = self.path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(json!({ "file": name, "missions": self.missions, "blake3": self.hasher.finalize().to_hex().as_str() }))
    }
}

fn failed(path: &Path, error: &io::Error) -> anyhow::Error {
    environment(format!("{}: {error}", path.display()))
}
