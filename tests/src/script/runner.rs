//! Runs pages.

use std::{
    fs::{self, OpenOptions},
    io::{self, Write as _},
    path::{Path, PathBuf},
    time::Duration,
};

use super::{
    blocks::{Block, Role, blocks},
    part,
    place::Place,
    service::Service,
    started::Started,
};
use crate::shell::{self, Call};

/// The longest that a command may take.
const LIMIT: Duration = Duration::from_secs(120);
/// The longest that what goes on may take to end when asked.
const END_LIMIT: Duration = Duration::from_secs(30);

/// What pages are run with.
#[derive(Clone, Copy, Debug)]
pub struct Runner<'a> {
    /// The program, which commands find as `cohabit`.
    pub binary: &'a Path,
    /// The root of the repository, whose folders commands find in their own.
    pub repository: &'a Path,
    /// What blocks may need besides, such as `python`.
    pub has: &'a [&'a str],
    /// Folders with programs that come before those of the machine.
    pub path: &'a [PathBuf],
}

/// What came of a page.
#[derive(Clone, Debug, Default, Eq, PartialEq)]
pub struct Told {
    /// How many commands were typed.
    pub typed: usize,
    /// The blocks that were not run.
    pub not_run: Vec<NotRun>,
}

/// A block that was not run.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct NotRun {
    /// The line of the page that begins it.
    pub line: usize,
    /// Why.
    pub reason: String,
}

impl Runner<'_> {
    /// Runs a page, from top to bottom. What a command starts and goes on until it is ended, such as a session, is ended when
    /// another such command begins, or the block ends, and has to end well. What joins a session ends before that one.
    ///
    /// # Errors
    /// The first thing that goes wrong: its file and line, what was typed, and what was said.
    pub fn run(&self, file: &str, markdown: &str) -> Result<Told, String> {
        let blocks = blocks(markdown).map_err(|wrong| format!("{file}: {wrong}"))?;
        if let Some(block) = blocks.iter().find(|block| !is_used(block, &blocks)) {
            let name = block.file().unwrap_or_default();
            return Err(format!("{file}:{}: no command, and no other file of the page, names `{name}`", block.line));
        }
        let name = Path::new(file).file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let place = Place::new(&name, self.binary, self.repository, self.path);
        let place = place.map_err(|error| format!("{file}: a folder for it: {error}"))?;
        let mut typist = Typist { runner: self, file, going_on: Vec::new(), told: Told::default(), place };
        blocks.iter().try_for_each(|block| typist.block(block))?;
        Ok(typist.told)
    }
}

/// Whether a file that a page writes is used in it.
fn is_used(block: &Block, blocks: &[Block]) -> bool {
    let Role::File(name) = &block.role else { return true };
    // A command may be given the folder that the file is in.
    let name = name.split('/').next().unwrap_or(name);
    let others = blocks.iter().filter(|other| !std::ptr::eq(*other, block));
    let mut used = others.filter(|other| !matches!(other.role, Role::NotRun(_) | Role::Shown));
    used.any(|other| other.text.contains(name))
}

/// Something that goes on.
struct GoingOn {
    line: usize,
    typed: String,
    started: Started,
}

/// Types the commands of a page.
struct Typist<'a> {
    runner: &'a Runner<'a>,
    file: &'a str,
    going_on: Vec<GoingOn>,
    told: Told,
    // The last one to be dropped: it kills what is left.
    place: Place,
}

impl Typist<'_> {
    fn block(&mut self, block: &Block) -> Result<(), String> {
        let (file, line) = (self.file, block.line);
        let at_block = |error: String| format!("{file}:{line}: {error}");
        match &block.role {
            Role::Typed { needs: Some(need) } if !self.runner.has.contains(&need.as_str()) => {
                self.pass_over(block, &format!("needs {need}"));
                Ok(())
            }
            Role::Typed { .. } => {
                for (line, text) in block.commands() {
                    self.command(line, &text)?;
                }
                self.end_all()?;
                match self.place.left_behind() {
                    left if left.is_empty() => Ok(()),
                    left => Err(at_block(format!("left behind: {}", left.join("; ")))),
                }
            }
            Role::NotRun(reason) => {
                self.pass_over(block, reason);
                Ok(())
            }
            Role::File(name) => self.write(name, &block.text, false).map_err(at_block),
            Role::AddedTo(name) => self.write(name, &block.text, true).map_err(at_block),
            Role::PartOf(name) => self.compare(name, &block.text).map_err(at_block),
            Role::Shown => Ok(()),
        }
    }

    fn pass_over(&mut self, block: &Block, reason: &str) {
        self.told.not_run.push(NotRun { line: block.line, reason: reason.to_owned() });
    }

    fn write(&self, name: &str, text: &str, is_added: bool) -> Result<(), String> {
        let path = self.place.file(name)?;
        if is_added && !path.is_file() {
            return Err(format!("`{name}` is not there yet: write its first part before"));
        }
        let mut options = OpenOptions::new();
        let options = if is_added { options.append(true) } else { options.write(true).create(true).truncate(true) };
        let written = options.open(&path).and_then(|mut file| file.write_all(text.as_bytes()));
        written.map_err(|error| format!("`{name}`: {error}"))
    }

    fn compare(&self, name: &str, text: &str) -> Result<(), String> {
        let whole = fs::read_to_string(self.place.folder().join(name)).map_err(|error| format!("`{name}`: {error}"))?;
        part::check(text, &whole).map_err(|problem| format!("`{name}`: {problem}"))
    }

    /// Types one line, and waits until its command has ended, or goes on.
    fn command(&mut self, line: usize, text: &str) -> Result<(), String> {
        let commands = shell::commands(text);
        if commands.is_empty() {
            return Ok(());
        }
        self.told.typed += 1;
        let call = if let [words] = commands.as_slice() { Call::of(words) } else { None };
        let done = match call.as_ref().and_then(|call| Some((call, Service::of(call)?))) {
            Some((call, service)) => self.start(line, text, call, service),
            None => self.run_to_end(text),
        };
        done.map_err(|problem| format!("{}:{line}: `{}`: {problem}", self.file, text.trim()))
    }

    fn run_to_end(&self, text: &str) -> Result<(), String> {
        let mut command = self.place.command("sh");
        command.arg("-c").arg(shell::installed(text));
        self.started(&mut command)?.finish(LIMIT)
    }

    fn start(&mut self, line: usize, text: &str, call: &Call, service: Service) -> Result<(), String> {
        if service == Service::Site {
            self.end_all()?;
        }
        let mut command = self.place.command(self.place.program());
        command.args(service.arguments(call)).envs(call.variables.iter().cloned());
        let mut started = self.started(&mut command)?;
        let folder = self.place.folder();
        started.wait_until(|started| service.is_ready(call, &folder, started), LIMIT)?;
        self.going_on.push(GoingOn { line, typed: text.trim().to_owned(), started });
        Ok(())
    }

    fn started(&self, command: &mut std::process::Command) -> Result<Started, String> {
        let started: io::Result<Started> = Started::new(command, self.place.said(self.told.typed));
        started.map_err(|error| format!("it cannot be started: {error}"))
    }

    /// Ends what goes on, the last one first.
    fn end_all(&mut self) -> Result<(), String> {
        while let Some(GoingOn { line, typed, started }) = self.going_on.pop() {
            let ended = started.interrupt(END_LIMIT);
            ended.map_err(|problem| format!("{}:{line}: `{typed}`, at Ctrl-C: {problem}", self.file))?;
        }
        Ok(())
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    const REPOSITORY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

    /// What comes of a page, with `true` as the program.
    fn run(name: &str, page: &str) -> Result<Told, String> {
        let (binary, repository) = (Path::new("/bin/true"), Path::new(REPOSITORY));
        Runner { binary, repository, has: &["sh"], path: &[] }.run(&format!("{name}.md"), page)
    }

    #[test]
    fn a_page_is_run_from_top_to_bottom() {
        let page = [
            "```toml a.toml\na = 1\n```\n",
            "```toml added-to: a.toml\nb = 2  # two\n```\n",
            "```sh\ngrep -q 'b = 2' a.toml\ncohabit check a.toml   # says nothing\n\ncat a.toml \\\n  > b.toml\n```\n",
            "```toml part-of: b.toml\nb = 2\n```\n",
            "```toml part-of: cdf/Cargo.toml\n[package]\n```\n",
            "```sh not-run: needs a network\nfalse\n```\n",
            "```sh needs: python\nfalse\n```\n",
            "```sh needs: sh\ntrue\n```\n",
        ]
        .concat();
        let told = run("whole", &page).unwrap();
        assert_eq!(told.typed, 4);
        let reasons: Vec<_> = told.not_run.iter().map(|one| (one.line, one.reason.as_str())).collect();
        assert_eq!(reasons, [(20, "needs a network"), (23, "needs python")]);
    }

    #[test]
    fn what_goes_wrong_is_told_with_its_place() {
        let check = |name: &str, page: &str, expected: &str| {
            let problem = run(name, page).unwrap_err();
            assert!(problem.contains(expected), "{problem}");
        };
        check("fails", "```sh\ntrue\necho no >&2; false\n```\n", "fails.md:3: `echo no >&2; false`: it ended with");
        check("says", "```sh\necho loud; false\n```\n", "\nloud");
        check("ends", "```sh\ncohabit play\n```\n", "ends.md:2: `cohabit play`: it ended with exit status: 0 before");
        check("leaves", "```sh\nsleep 60 > /dev/null 2>&1 &\n```\n", "left behind: process");
        check("unused", "```toml a.toml\n```\n", "unused.md:1: no command, and no other file of the page, names");
        check("outside", "```toml ../a.toml\n```\n```sh\ncat ../a.toml\n```\n", "outside.md:1: `../a.toml` lies");
        check("owned", "```toml cdf/a.toml\n```\n```sh\ncat cdf/a.toml\n```\n", "owned.md:1: `cdf/a.toml` lies");
        check("early", "```toml added-to: a.toml\n```\n", "early.md:1: `a.toml` is not there yet");
        check("other", "```toml part-of: cdf/Cargo.toml\n[packages]\n```\n", "has no line `[packages]`");
    }
}
