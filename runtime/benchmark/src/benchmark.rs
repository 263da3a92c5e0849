//! A benchmark's file, and the missions that follow from it.

use std::{collections::BTreeMap, path::Path, sync::Arc};

use cohabit_cdf::Catalog;
use cohabit_generate::{
    GenerateError, Generated, GivenUp, Order, Part, Parted, Spec, SpecError, generate, part, world_of,
};
use cohabit_world::World;
use serde::Deserialize;

use crate::{
    episode::Caps,
    kept::Kept,
    mission::{Instruction, Mission, Split, digest},
};

/// The name and the text of the project's own benchmark.
const BUILTIN: (&str, &str) = ("benchmark-1.toml", include_str!("../data/benchmark-1.toml"));

/// Why a benchmark cannot be played.
#[derive(Debug, thiserror::Error)]
pub enum BenchmarkError {
    /// Its file is not the TOML expected.
    #[error("{file}: {source}")]
    Syntax {
        /// Which file.
        file: String,
        /// Where and what.
        source: Box<toml::de::Error>,
    },
    /// Its file asks for what there is not.
    #[error("{file}: {reason}")]
    Wrong {
        /// Which file.
        file: String,
        /// What is wrong, and what would be right.
        reason: String,
    },
    /// Its specification of missions is wrong.
    #[error(transparent)]
    Spec(#[from] SpecError),
    /// Its missions cannot be made.
    #[error("{file}: {source}")]
    Generate {
        /// Which file.
        file: String,
        /// Why.
        source: GenerateError,
    },
    /// It has other missions here than where it was made.
    #[error(
        "{file}: its missions have the digest {found} here, and {expected} in the file: this program makes other missions \
         than the one that the benchmark was made with; play it with that one"
    )]
    OtherMissions {
        /// Which file.
        file: String,
        /// The digest in the file.
        expected: String,
        /// The digest here.
        found: String,
    },
}

/// A benchmark with its missions.
#[derive(Clone, Debug)]
pub struct Benchmark {
    /// Its version.
    pub version: u32,
    /// The seed of what its missions leave to chance.
    pub seed: u64,
    /// When a mission is given up.
    pub caps: Caps,
    /// The digest of its missions (BLAKE3, in hexadecimal).
    pub digest: String,
    /// All missions, in order.
    pub missions: Vec<Mission>,
    /// What they are made of.
    pub catalog: Arc<Catalog>,
}

/// The file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    version: u32,
    seed: u64,
    count: usize,
    share: f64,
    digest: Option<String>,
    caps: Caps,
    missions: toml::Table,
}

/// How missions are made; it changes nothing of them.
#[derive(Clone, Copy)]
pub struct Making<'a> {
    /// Threads.
    pub workers: usize,
    /// The folder where they are kept for the next time, if they are.
    pub kept_in: Option<&'a Path>,
    /// What tells this build of the program from others: missions of a file that names no digest are not taken over from another one.
    pub build: &'a str,
    /// Told of each mission that is made: how many are, of how many.
    pub made: &'a dyn Fn(usize, usize),
}

impl Making<'_> {
    /// By so many threads; nothing is kept, and nobody told.
    #[must_use]
    pub fn by(workers: usize) -> Self {
        Self { workers, kept_in: None, build: "", made: &|_, _| {} }
    }
}

impl Benchmark {
    /// The project's own.
    ///
    /// # Errors
    /// [`BenchmarkError`].
    pub fn builtin(catalog: &Arc<Catalog>, making: Making<'_>) -> Result<Self, BenchmarkError> {
        let (file, text) = BUILTIN;
        Self::parse(file, text, catalog, making)
    }

    /// Reads a benchmark's file, makes its missions, or takes those that were kept, and compares their digest with the file's, if
    /// that names one.
    ///
    /// # Errors
    /// [`BenchmarkError`].
    pub fn parse(file: &str, text: &str, catalog: &Arc<Catalog>, making: Making<'_>) -> Result<Self, BenchmarkError> {
        let wrong = |reason: String| BenchmarkError::Wrong { file: file.to_owned(), reason };
        let written: Result<Written, _> = toml::from_str(text);
        let written =
            written.map_err(|source| BenchmarkError::Syntax { file: file.to_owned(), source: Box::new(source) })?;
        if !(0.01..=0.2).contains(&written.share) {
            return Err(wrong(format!("share = {}: a number from 0.01 to 0.2", written.share)));
        }
        let spec = toml::to_string(&written.missions).map_err(|error| wrong(format!("missions: {error}")))?;
        let spec = Spec::parse(file, &spec, catalog)?;
        let kept = making.kept_in.map(|folder| kept(folder, text, &written, catalog, making.build));
        let missions = match kept.as_ref().and_then(|kept| kept.read(written.digest.as_deref())) {
            Some(missions) => missions,
            None => {
                let order = Order { count: written.count, seed: written.seed, workers: making.workers.max(1) };
                let mut made = Vec::new();
                let mut take = |mission: Generated| {
                    made.push(mission);
                    (making.made)(made.len(), written.count);
                };
                let given_up = generate(&spec, catalog, order, &mut take)
                    .map_err(|source| BenchmarkError::Generate { file: file.to_owned(), source })?;
                // Whoever named a digest has looked at the missions.
                if written.digest.is_none() {
                    check_types(&given_up, &made).map_err(wrong)?;
                }
                let missions = parted(made, written.share, written.seed, catalog).map_err(wrong)?;
                let found = digest(&missions);
                if let Some(expected) = written.digest.as_ref().filter(|expected| **expected != found) {
                    let expected = expected.clone();
                    return Err(BenchmarkError::OtherMissions { file: file.to_owned(), expected, found });
                }
                if let Some(kept) = &kept {
                    kept.write(&missions);
                }
                missions
            }
        };
        Ok(Self {
            version: written.version,
            seed: written.seed,
            caps: written.caps,
            digest: digest(&missions),
            missions,
            catalog: Arc::clone(catalog),
        })
    }

    /// The missions of these splits, in order.
    pub fn of<'a>(&'a self, splits: &'a [Split]) -> impl Iterator<Item = &'a Mission> {
        self.missions.iter().filter(move |mission| splits.contains(&mission.split))
    }

    /// The mission of that name.
    #[must_use]
    pub fn mission(&self, id: &str) -> Option<&Mission> {
        self.missions.iter().find(|mission| mission.id == id)
    }
}

/// Where the missions of a benchmark's file are kept. Those that have a digest there are the same whatever program made them.
fn kept(folder: &Path, text: &str, written: &Written, catalog: &Catalog, build: &str) -> Kept {
    let packs: Vec<String> = catalog.packs().iter().map(ToString::to_string).collect();
    let build = if written.digest.is_some() { "" } else { build };
    Kept::of(folder, &[text, &packs.join("\n"), build])
}

/// Whether each type that was tried has missions; which one has none, and why, in words.
fn check_types(given_up: &BTreeMap<String, GivenUp>, made: &[Generated]) -> Result<(), String> {
    let has_none = |(kind, _): &(&String, &GivenUp)| !made.iter().any(|mission| mission.kind == **kind);
    given_up.iter().find(has_none).map_or(Ok(()), |(kind, GivenUp { count, reason })| {
        Err(format!(
            "the type `{kind}` has no mission: {count} were given up, the last because {reason}; mend it, leave it out, or \
             raise `count`"
        ))
    })
}

/// The missions with what they are for, and what is said in them; why one cannot be laid out, in words.
fn parted(made: Vec<Generated>, share: f64, seed: u64, catalog: &Arc<Catalog>) -> Result<Vec<Mission>, String> {
    // By the things that were drawn alone: so the first benchmark was parted, and its digest names what came of it.
    let facets = made.iter().map(|one| cohabit_generate::Facets { things: one.things.clone(), ..one.facets() });
    let facets: Vec<_> = facets.collect();
    let Parted { parts, .. } = part(&facets, share, seed);
    let splits = splits(&parts);
    let missions = made.into_iter().zip(parts.into_iter().zip(splits));
    missions
        .map(|(generated, (part, split))| {
            let world = world_of(&generated.id, &generated.cdf.to_string(), catalog, seed);
            let world = world.map_err(|reason| format!("{}: {reason}", generated.id))?;
            let steps = &generated.certificate.plan;
            let instructions = steps.iter().map(|step| Instruction {
                text: step.said.clone(),
                answer: described(&world, &step.object).unwrap_or_else(|| step.said.clone()),
            });
            let instructions = instructions.collect();
            Ok(Mission { id: generated.id, kind: generated.kind, split, part, instructions, cdf: generated.cdf })
        })
        .collect()
}

/// What missions are for: of each part that is held out, every other one is for validation, and the rest for tests.
fn splits(parts: &[Part]) -> Vec<Split> {
    let mut counts = BTreeMap::<Part, usize>::new();
    let mut split = |part: &Part| {
        let count = counts.entry(*part).or_default();
        *count += 1;
        match part {
            Part::Train => Split::Train,
            _ if *count % 2 == 1 => Split::Validation,
            _ => Split::Test,
        }
    };
    parts.iter().map(&mut split).collect()
}

/// What a person calls a thing as the mission begins: `the apple on the counter in the break room`.
fn described(world: &World, instance: &str) -> Option<String> {
    let thing = world.object(world.find(instance)?)?;
    let catalog = world.catalog();
    let place = thing.parent.and_then(|parent| world.object(parent)).map(|parent| {
        let class = catalog.class(parent.class);
        let is_enclosed = class.receptacle.as_ref().is_some_and(|receptacle| receptacle.enclosed);
        format!(" {} the {}", if is_enclosed { "in" } else { "on" }, class.name.to_lowercase())
    });
    let name = catalog.class(thing.class).name.to_lowercase();
    Some(format!("the {name}{} in the {}", place.unwrap_or_default(), thing.room.name_in(catalog)))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn validation_and_test_share_each_part() {
        let parts = [Part::Train, Part::Seen, Part::UnseenRoom, Part::Seen, Part::Train, Part::UnseenRoom, Part::Seen];
        let expected = [
            Split::Train,
            Split::Validation,
            Split::Validation,
            Split::Test,
            Split::Train,
            Split::Test,
            Split::Validation,
        ];
        assert_eq!(splits(&parts), expected);
    }

    #[test]
    fn what_is_wrong_with_a_file_is_named() {
        let catalog = Arc::new(Catalog::builtin());
        let caps = "[caps]\nactions = 50\nfailed = 10\n";
        let kind = "[[missions.type]]\nname = \"one\"\nvars = [{ name = \"a\", class = [\"Apple\"] }]\ngoals = [\"a isPickedUp=true\"]\n";
        let sparks = kind.replace("one", "sparks").replace("isPickedUp", "isSparking");
        let head = "version = 9\nseed = 1\ncount = 2\nshare = 0.1\n";
        for (text, expected) in [
            ("version = 1".to_owned(), "missing field"),
            (format!("{}{caps}{kind}", head.replace("0.1", "0.9")), "share = 0.9"),
            (format!("{head}{caps}{}", kind.replace("Apple", "Nix")), "`Nix`"),
            (format!("{head}{caps}{kind}{sparks}"), "type `sparks` has no mission"),
            (format!("{head}digest = \"00\"\n{caps}{kind}"), "the digest"),
        ] {
            let error = Benchmark::parse("b.toml", &text, &catalog, Making::by(1)).unwrap_err().to_string();
            assert!(error.starts_with("b.toml") && error.contains(expected), "{error}");
        }
    }
}
