//! `cohabit benchmark`: the same missions for every agent, submissions that anybody can verify, and a table of them.

mod players;

use std::{
    fs,
    path::{Path, PathBuf},
    str::FromStr,
    sync::Arc,
};

use cohabit_benchmark::{
    Check, Entry, Header, Making, Mission, RunError, Split, Submission, grids, page, run, text, verify,
};
use indicatif::{ProgressBar, ProgressStyle};

use crate::{
    build,
    failure::{bad_input, check_folder_of, environment},
    sessions,
    terminal::{shown, shown_lines},
    world::WorldPacks,
};
use players::{Asked, Player};

/// Plays the fixed missions of the benchmark, verifies what others played, and lays submissions beside each other.
#[derive(clap::Args)]
pub struct Benchmark {
    #[command(subcommand)]
    command: BenchmarkCommand,
}

#[derive(clap::Subcommand)]
enum BenchmarkCommand {
    /// Have an agent play all missions of validation and test, and write a submission
    Run(Box<Run>),
    /// Write the missions, for who trains or plays elsewhere
    Missions(Missions),
    /// Play all episodes of a submission again, and say what differs; exit code 1 if anything does
    Verify(Verify),
    /// Print a table of all submissions of a folder, with what the paper on Alexa Arena reports
    Table(Table),
}

/// Which benchmark, and how much of the machine.
#[derive(clap::Args)]
struct Which {
    /// A benchmark of your own (TOML) instead of the built-in one
    #[arg(long, value_name = "FILE")]
    benchmark: Option<PathBuf>,
    /// Threads; one for each core if not given. They do not change what comes of it
    #[arg(long, value_name = "N")]
    workers: Option<usize>,
    /// Make the missions again, although they were made before
    #[arg(long)]
    anew: bool,
    #[command(flatten)]
    packs: WorldPacks,
}

#[derive(clap::Args)]
struct Run {
    #[command(flatten)]
    which: Which,
    #[command(flatten)]
    asked: Asked,
    /// Play this split alone, `validation` or `test`; both, if absent
    #[arg(long = "split", value_name = "SPLIT")]
    splits: Vec<SplitName>,
    /// The submission to write (.jsonl). A call that was interrupted goes on when it is made again
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

#[derive(clap::Args)]
struct Missions {
    #[command(flatten)]
    which: Which,
    /// Write this split alone, `train`, `validation` or `test`; as often as needed; all, if absent
    #[arg(long = "split", value_name = "SPLIT")]
    splits: Vec<SplitName>,
    /// A file, a mission a line (.jsonl), or a folder, a mission file (CDF) each with a .script of what is said in it
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

#[derive(clap::Args)]
struct Verify {
    /// The submission
    file: PathBuf,
    #[command(flatten)]
    which: Which,
}

#[derive(clap::Args)]
struct Table {
    /// The folder of submissions (.jsonl)
    folder: PathBuf,
    /// Play each of them again, too, to say whether it holds
    #[arg(long)]
    verify: bool,
    /// Write the tables as a page as well
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    #[command(flatten)]
    which: Which,
}

/// A split by its name.
#[derive(Clone, Copy)]
struct SplitName(Split);

impl FromStr for SplitName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let known = || Split::ALL.map(Split::name).join(", ");
        let named = Split::ALL.into_iter().find(|split| split.name() == text);
        named.map(Self).ok_or_else(|| format!("there is no such split: {}", known()))
    }
}

/// The splits of these names, in order; these others, if there is no name.
fn splits(names: &[SplitName], otherwise: &[Split]) -> Vec<Split> {
    let mut splits: Vec<Split> = names.iter().map(|name| name.0).collect();
    splits.sort_unstable();
    splits.dedup();
    if splits.is_empty() { otherwise.to_vec() } else { splits }
}

impl Benchmark {
    /// Does what was asked.
    pub fn run(&self) -> anyhow::Result<()> {
        match &self.command {
            BenchmarkCommand::Run(run) => run.run(),
            BenchmarkCommand::Missions(missions) => missions.run(),
            BenchmarkCommand::Verify(verify) => verify.run(),
            BenchmarkCommand::Table(table) => table.run(),
        }
    }
}

impl Which {
    fn workers(&self) -> usize {
        self.workers.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from)).max(1)
    }

    /// The benchmark with its missions: those that were made before, or else they are made now, which is shown.
    fn read(&self) -> anyhow::Result<cohabit_benchmark::Benchmark> {
        let world = self.packs.read()?;
        let (catalog, folder) = (Arc::clone(world.catalog()), sessions::data_folder().join("benchmark"));
        let bar = bar("missions made");
        let made = |done: usize, all: usize| {
            bar.set_length(all as u64);
            bar.set_position(done as u64);
        };
        let build = build::id().unwrap_or_default();
        // Without a name a build cannot be told from another one, whose missions may be others.
        let is_kept = !self.anew && !build.is_empty();
        let kept_in = is_kept.then_some(folder.as_path());
        let making = Making { workers: self.workers(), kept_in, build: &build, made: &made };
        let read = match &self.benchmark {
            None => cohabit_benchmark::Benchmark::builtin(&catalog, making),
            Some(path) => {
                let file = path.display().to_string();
                let text = fs::read_to_string(path).map_err(|error| bad_input(format!("{file}: {error}")))?;
                cohabit_benchmark::Benchmark::parse(&file, &text, &catalog, making)
            }
        };
        bar.finish_and_clear();
        read.map_err(bad_input)
    }
}

impl Run {
    fn run(&self) -> anyhow::Result<()> {
        let splits = splits(&self.splits, &Split::PLAYED);
        if splits.contains(&Split::Train) {
            return Err(bad_input("--split train: nobody is scored by it; `benchmark missions` writes its missions"));
        }
        self.check_places()?;
        let benchmark = self.which.read()?;
        let missions: Vec<&Mission> = benchmark.of(&splits).collect();
        let player = Player::new(&self.asked, &benchmark, &missions)?;
        let header = Header::new(&benchmark, &splits, self.asked.card(), &machine());
        let bar = bar_of(missions.len(), "played");
        let play = |mission: &Mission| player.play(&benchmark, mission);
        let played = run(&benchmark, header, &self.out, self.which.workers(), &play, &|| bar.inc(1));
        bar.finish_and_clear();
        let header =
            played.map_err(|error| if error.is_bad_input() { bad_input(error) } else { environment(error) })?;
        let entry = Entry { file: self.out.display().to_string(), header, check: Check::NotVerified };
        let own: Vec<_> = grids(&[entry]).into_iter().filter(|grid| !grid.title.contains("paper")).collect();
        print!("{}", shown_lines(text(&own)));
        println!("{} missions: {}", missions.len(), shown(self.out.display()));
        Ok(())
    }

    /// What is wrong with where it reads and writes is said before missions are made and played.
    fn check_places(&self) -> anyhow::Result<()> {
        self.asked.check()?;
        check_folder_of(&self.out)?;
        if self.out.exists() && Submission::read(&self.out).is_err() {
            return Err(bad_input(RunError::Exists { path: self.out.clone() }));
        }
        Ok(())
    }
}

impl Missions {
    fn run(&self) -> anyhow::Result<()> {
        let benchmark = self.which.read()?;
        let splits = splits(&self.splits, &Split::ALL);
        let missions: Vec<&Mission> = benchmark.of(&splits).collect();
        if self.out.extension().is_some_and(|extension| extension == "jsonl") {
            let text: Vec<String> = missions.iter().map(|mission| format!("{}\n", mission.as_line())).collect();
            write(&self.out, &text.concat())?;
        } else {
            fs::create_dir_all(&self.out).map_err(|error| environment(format!("{}: {error}", self.out.display())))?;
            for mission in &missions {
                let said: Vec<String> = mission.instructions.iter().map(|said| format!("{}\n", said.text)).collect();
                write(&self.out.join(format!("{}.json", mission.id)), &format!("{:#}\n", mission.cdf))?;
                write(&self.out.join(format!("{}.script", mission.id)), &said.concat())?;
            }
        }
        println!("{} missions: {}", missions.len(), shown(self.out.display()));
        println!(
            "benchmark {}, seed {}; the digest of all its missions: {}",
            benchmark.version, benchmark.seed, benchmark.digest
        );
        Ok(())
    }
}

impl Verify {
    fn run(&self) -> anyhow::Result<()> {
        let submission = Submission::read(&self.file).map_err(bad_input)?;
        let benchmark = self.which.read()?;
        let bar = bar_of(submission.lines.len(), "played again");
        let differences = verify(&benchmark, &submission, self.which.workers(), &|| bar.inc(1));
        bar.finish_and_clear();
        for difference in &differences {
            println!("{}", shown(difference));
        }
        let (file, program) = (self.file.display(), &submission.header.program);
        if !differences.is_empty() && program != env!("CARGO_PKG_VERSION") {
            println!("note: it was made by version {} of the program", shown(program));
        }
        anyhow::ensure!(differences.is_empty(), "{file}: not verified: {} differences", differences.len());
        let count = submission.lines.len();
        println!("{}: verified: {count} episodes were played again, and nothing differs", shown(file));
        Ok(())
    }
}

impl Table {
    fn run(&self) -> anyhow::Result<()> {
        let benchmark = self.verify.then(|| self.which.read()).transpose()?;
        let mut entries = Vec::new();
        for path in files(&self.folder)? {
            let submission = match Submission::read(&path) {
                Ok(submission) => submission,
                Err(error) => {
                    println!("left out: {}", shown(error));
                    continue;
                }
            };
            let check = benchmark.as_ref().map_or(Check::NotVerified, |benchmark| self.check(benchmark, &submission));
            let file = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            entries.push(Entry { file, header: submission.header, check });
        }
        let grids = grids(&entries);
        print!("{}", shown_lines(text(&grids)));
        if let Some(path) = &self.html {
            write(path, &page(&grids))?;
            println!("{} submissions: {}", entries.len(), shown(path.display()));
        }
        Ok(())
    }

    fn check(&self, benchmark: &cohabit_benchmark::Benchmark, submission: &Submission) -> Check {
        let bar = bar_of(submission.lines.len(), "played again");
        let differences = verify(benchmark, submission, self.which.workers(), &|| bar.inc(1));
        bar.finish_and_clear();
        if differences.is_empty() { Check::Verified } else { Check::Differs(differences.len()) }
    }
}

/// The submissions of a folder, by name.
fn files(folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let failed = |error| bad_input(format!("{}: {error}", folder.display()));
    let entries = fs::read_dir(folder).map_err(failed)?;
    let mut paths = entries.map(|entry| Ok(entry.map_err(failed)?.path())).collect::<anyhow::Result<Vec<_>>>()?;
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "jsonl"));
    paths.sort();
    Ok(paths)
}

fn write(path: &Path, text: &str) -> anyhow::Result<()> {
    fs::write(path, text).map_err(|error| environment(format!("{}: {error}", path.display())))
}

/// Where it is played, as a submission notes it.
fn machine() -> String {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    format!("{} {}, {cores} cores", std::env::consts::OS, std::env::consts::ARCH)
}

/// A bar that says what was done so often; it is shown once something was.
fn bar(done: &'static str) -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:30} {pos}/{len} {msg}, {elapsed} ({eta} left)");
    ProgressBar::no_length().with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar())).with_message(done)
}

/// The same of so many.
fn bar_of(count: usize, done: &'static str) -> ProgressBar {
    let bar = bar(done);
    bar.set_length(count as u64);
    bar
}
