//! `cohabit import-house`: houses of ProcTHOR as floor plans, as a world pack.

use std::{
    fmt::Write as _,
    fs::File,
    io::{BufRead as _, BufReader, Read as _},
    path::{Path, PathBuf},
};

use cohabit_houses::{
    HouseError, Importer, MOST_BYTES, Report,
    pack::{HousePack, MOST_HOUSES, check_prefix, plan_id},
};
use serde_json::{Value, json};

use crate::{
    failure::{bad_input, environment},
    pack_folder,
    terminal::{print, shown, shown_json},
};

/// Makes floor plans of houses of ProcTHOR (the JSON of houses of AI2-THOR), and writes them as a world pack, which goes with the pack
/// `homes`: --world homes --world FOLDER. Classes of `homes` stand for the objects of a house; what is left out is named with its count.
#[derive(clap::Args)]
pub struct ImportHouse {
    /// A house (.json), or many as JSON lines (.jsonl)
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// The folder of the world pack, which is made
    #[arg(long, value_name = "FOLDER")]
    into: PathBuf,
    /// The name of the world pack; that of its folder, if not given
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// How many houses of JSON lines to import, from the first on; at most 990, which is also what is taken if not given
    #[arg(long, value_name = "N")]
    count: Option<usize>,
    /// What the ids of floor plans begin with; the number of the house in its file follows
    #[arg(long, value_name = "PREFIX", default_value = "Thor")]
    prefix: String,
    /// Print what became of each house as JSON
    #[arg(long)]
    json: bool,
}

/// What became of one house.
struct Outcome {
    /// The house, as messages name it.
    place: String,
    result: Result<(String, Report), HouseError>,
}

/// The houses of a file, one by one.
enum Houses {
    One { file: Option<BufReader<File>> },
    Lines { file: BufReader<File>, line: usize },
}

impl ImportHouse {
    /// Imports all of them, then writes the pack.
    pub fn run(&self) -> anyhow::Result<()> {
        check_prefix(&self.prefix).map_err(bad_input)?;
        let count = self.count.unwrap_or(MOST_HOUSES);
        if !(1..=MOST_HOUSES).contains(&count) {
            return Err(bad_input(format!("a world pack of {count} houses cannot be made: from 1 to {MOST_HOUSES}")));
        }
        pack_folder::check_is_new(&self.into)?;
        let importer = Importer::default();
        let name = pack_folder::name(&self.into, self.name.as_deref());
        pack_folder::check_is_own(&self.into, &name)?;
        let mut pack = HousePack::new(&name, importer.world()).map_err(|error| self.refused(&error))?;
        let outcomes = self.import(&importer, &mut pack, count)?;
        if pack.count() == 0 {
            return Err(bad_input(self.without_houses(&outcomes)));
        }
        pack_folder::write(&self.into, &pack.files())?;
        if self.json {
            let all = Value::Array(outcomes.iter().map(told_as_json).collect());
            return print(&format!("{}\n", shown_json(format_args!("{all:#}"))));
        }
        self.tell(&name, pack.count(), &outcomes)
    }

    fn refused(&self, error: &HouseError) -> anyhow::Error {
        match &self.name {
            // The name is that of a folder, which may be called as it is.
            None => bad_input(format!("{error}; or give a name by --name")),
            Some(_) => bad_input(error),
        }
    }

    fn import(&self, importer: &Importer, pack: &mut HousePack, count: usize) -> anyhow::Result<Vec<Outcome>> {
        let mut houses = Houses::open(&self.file)?;
        let mut outcomes = Vec::new();
        while outcomes.len() < count
            && let Some((place, bytes)) = houses.next(&self.file)?
        {
            let id = plan_id(&self.prefix, outcomes.len());
            let text = String::from_utf8(bytes).map_err(|_| bad_input(format!("{place}: it is no UTF-8 text")))?;
            let result = importer.plan(&id, &text).and_then(|plan| {
                pack.add(&plan)?;
                Ok((plan.id, plan.report))
            });
            outcomes.push(Outcome { place, result });
        }
        Ok(outcomes)
    }

    /// Why there is no house.
    fn without_houses(&self, outcomes: &[Outcome]) -> String {
        /// So many of them are told.
        const TOLD: usize = 10;
        if outcomes.is_empty() {
            return format!("{}: there is no house in it", self.file.display());
        }
        outcomes.iter().take(TOLD).filter_map(Outcome::refused).collect::<Vec<_>>().join("\n")
    }

    fn tell(&self, name: &str, count: usize, outcomes: &[Outcome]) -> anyhow::Result<()> {
        let mut text = String::new();
        for outcome in outcomes {
            match &outcome.result {
                Ok((id, report)) => text.push_str(&told(id, report)),
                Err(error) => {
                    let _ = writeln!(text, "refused: {}", shown(format_args!("{}: {error}", outcome.place)));
                }
            }
        }
        let folder = shown(self.into.display());
        let _ = writeln!(text, "{count} of {} houses are in {folder}", outcomes.len());
        let _ = writeln!(text, "Check them with: cohabit check --world homes --world {folder}");
        let _ =
            writeln!(text, "Look around in the first: cohabit play look_around_{name} --world homes --world {folder}");
        print(&text)
    }
}

impl Outcome {
    fn refused(&self) -> Option<String> {
        self.result.as_ref().err().map(|error| format!("{}: {error}", self.place))
    }
}

impl Houses {
    fn open(file: &Path) -> anyhow::Result<Self> {
        let opened = File::open(file).map_err(|error| bad_input(format!("{}: {error}", file.display())))?;
        let opened = BufReader::new(opened);
        let is_lines = file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("jsonl"));
        Ok(if is_lines { Self::Lines { file: opened, line: 0 } } else { Self::One { file: Some(opened) } })
    }

    /// The next house, and where it is; nothing, after the last.
    fn next(&mut self, path: &Path) -> anyhow::Result<Option<(String, Vec<u8>)>> {
        // One byte more than a house may have tells that it is too long.
        let most = MOST_BYTES as u64 + 1;
        let unread = |error: std::io::Error| environment(format!("{}: {error}", path.display()));
        let mut bytes = Vec::new();
        match self {
            Self::One { file } => {
                let Some(file) = file.take() else { return Ok(None) };
                file.take(most).read_to_end(&mut bytes).map_err(unread)?;
                Ok(Some((path.display().to_string(), bytes)))
            }
            Self::Lines { file, line } => loop {
                bytes.clear();
                *line += 1;
                if file.by_ref().take(most).read_until(b'\n', &mut bytes).map_err(unread)? == 0 {
                    return Ok(None);
                }
                let place = format!("{}:{line}", path.display());
                if bytes.len() > MOST_BYTES {
                    return Err(bad_input(format!("{place}: a line of more than {MOST_BYTES} bytes")));
                }
                if !bytes.trim_ascii().is_empty() {
                    return Ok(Some((place, bytes)));
                }
            },
        }
    }
}

fn told_as_json(outcome: &Outcome) -> Value {
    match &outcome.result {
        Ok((id, report)) => json!({ "house": outcome.place, "plan": id, "report": report }),
        Err(error) => json!({ "house": outcome.place, "refused": error.to_string() }),
    }
}

/// `Thor0000: 4 rooms, 4 doors, 2 windows, 27 objects, 6 of them moved`, and what is left out.
fn told(id: &str, report: &Report) -> String {
    let Report { rooms, doors, windows, placed, moved, left_out, notes } = report;
    let mut text =
        format!("{id}: {rooms} rooms, {doors} doors, {windows} windows, {placed} objects, {moved} of them moved\n");
    for line in left_out.iter().map(|one| format!("left out: {one}")).chain(notes.iter().cloned()) {
        let _ = writeln!(text, "  {}", shown(line));
    }
    text
}
