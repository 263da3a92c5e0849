//! Tar shards, as WebDataset reads them: a sample for each step, its files side by side under one key.

use std::{
    fs::File,
    io::{self, BufWriter, Write},
    path::PathBuf,
};

use serde_json::{Value, json};

use crate::{
    Counts, card,
    error::{ConvertError, at},
    native::{Dataset, Episode, Line},
    output::Output,
    tar::{END, Tar, size_in_archive},
};

/// What is said of the files.
const CARD: &str = include_str!("../data/shards.md");

/// A file of a sample: what follows its key, and its bytes.
type Member = (String, Vec<u8>);

/// Writes a data set into a folder; a shard has `limit` bytes at most, unless one sample has more.
pub(crate) fn write(
    dataset: &Dataset,
    output: &Output,
    limit: usize,
    done: &dyn Fn(usize, usize),
) -> Result<Counts, ConvertError> {
    let mut shards = Shards { output, limit, open: None, told: Vec::new() };
    let mut samples = 0;
    for (number, episode) in dataset.episodes.iter().enumerate() {
        for (step, line) in dataset.lines(episode)?.iter().enumerate() {
            shards.add(&format!("{number:06}-{step:04}"), &members(dataset, episode, step, line)?)?;
            samples += 1;
        }
        done(number + 1, dataset.episodes.len());
    }
    let told = shards.finish()?;
    let counts = Counts { episodes: dataset.episodes.len(), samples, files: told.len() };
    let index = json!({ "samples": samples, "episodes": counts.episodes, "shards": told });
    output.write("index.json", format!("{index:#}\n"))?;
    output.write("README.md", card::text(dataset, &counts, "tar shards (WebDataset)", CARD))?;
    Ok(counts)
}

/// The files of a sample; the first of an episode has what is said of the whole episode, too.
fn members(dataset: &Dataset, episode: &Episode, step: usize, line: &Line) -> Result<Vec<Member>, ConvertError> {
    let mut members = Vec::new();
    for modality in &dataset.recipe.modalities {
        let (_, bytes) = dataset.picture(episode, &line.step, modality)?;
        members.push((format!("{modality}.png"), bytes));
    }
    if step == 0 {
        for name in ["episode.json", "mission.json"] {
            members.push((name.to_owned(), dataset.text(episode, name)?.into_bytes()));
        }
    }
    members.push(("json".to_owned(), line.text.clone().into_bytes()));
    Ok(members)
}

/// A shard that is being written.
struct Shard {
    name: String,
    path: PathBuf,
    tar: Tar<Digested<BufWriter<File>>>,
    samples: usize,
    bytes: usize,
}

struct Shards<'a> {
    output: &'a Output,
    limit: usize,
    open: Option<Shard>,
    /// What the index says of those that are whole.
    told: Vec<Value>,
}

impl Shards<'_> {
    fn add(&mut self, key: &str, members: &[Member]) -> Result<(), ConvertError> {
        let bytes = members.iter().map(|(_, bytes)| size_in_archive(bytes.len())).sum::<usize>();
        if self.open.as_ref().is_some_and(|shard| shard.bytes + bytes > self.limit) {
            self.end()?;
        }
        let mut shard = match self.open.take() {
            Some(shard) => shard,
            None => self.begin()?,
        };
        for (ending, bytes) in members {
            shard.tar.append(&format!("{key}.{ending}"), bytes).map_err(at(&shard.path))?;
        }
        shard.bytes += bytes;
        shard.samples += 1;
        self.open = Some(shard);
        Ok(())
    }

    fn begin(&self) -> Result<Shard, ConvertError> {
        let name = format!("shard-{:06}.tar", self.told.len());
        let path = self.output.path(&name)?;
        let file = BufWriter::new(File::create(&path).map_err(at(&path))?);
        let tar = Tar::new(Digested { out: file, hasher: blake3::Hasher::new(), bytes: 0 });
        Ok(Shard { name, path, tar, samples: 0, bytes: END })
    }

    fn end(&mut self) -> Result<(), ConvertError> {
        let Some(shard) = self.open.take() else { return Ok(()) };
        let digested = shard.tar.finish().map_err(at(&shard.path))?;
        self.told.push(json!({
            "file": shard.name,
            "samples": shard.samples,
            "bytes": digested.bytes,
            "blake3": digested.hasher.finalize().to_hex().as_str(),
        }));
        Ok(())
    }

    fn finish(mut self) -> Result<Vec<Value>, ConvertError> {
        self.end()?;
        Ok(self.told)
    }
}

/// Counts and digests what is written.
struct Digested<W> {
    out: W,
    hasher: blake3::Hasher,
    bytes: u64,
}

impl<W: Write> Write for Digested<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.out.write(bytes)?;
        self.hasher.update(&bytes[..written]);
        self.bytes += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}
