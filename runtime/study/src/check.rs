//! Reads `study.toml`, and says all that is wrong in it.

mod blocks;
mod codes;
mod language;
mod minimisation;
mod pairs;
mod probes;
mod tutorial;
mod whole;
mod wizard;
mod worlds;

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    ops::Range,
    path::{Component, Path, PathBuf},
};

use cohabit_cdf::{
    PackFile, WorldData,
    mission::{Pointer, Problems},
};
use cohabit_dialog::{PageTexts, Questionnaire};
use serde::Deserialize as _;
use toml::{
    Spanned,
    de::{DeTable, Deserializer},
};

use crate::{
    design::{Completion, ConsentBox, Factor, Level, Sheet, Study},
    findings::Findings,
    instrument::Instrument,
    parameters::places,
    settings::{self, OF_PAGES, RECORD_AUDIO, Setting, Settings, WIZARD, arguments},
    shape::STUDY,
    written::{self, Words, Written, WrittenBox, WrittenFactor, WrittenSettings, WrittenSheet},
};

/// What only the program knows of what a study names.
pub trait Program {
    /// Finds out whether `cohabit play` takes these arguments.
    ///
    /// # Errors
    /// What is wrong with them.
    fn check_arguments(&self, arguments: &[String]) -> Result<(), String>;

    /// Finds out whether there is such a mission, and it can be played in the world of the study's packs, if it has any.
    ///
    /// # Errors
    /// What is wrong with it.
    fn check_mission(&self, name: &str, world: Option<&WorldData>) -> Result<(), String>;

    /// Finds out whether a mission can be played with these arguments of `cohabit play`: its bodies, cameras and agents, with the files
    /// in `folder` that they name. Of a mission that cannot be played at all it says nothing.
    ///
    /// # Errors
    /// What is wrong with them.
    fn check_session(
        &self,
        arguments: &[String],
        mission: &str,
        folder: &Path,
        world: Option<&WorldData>,
    ) -> Result<(), String>;

    /// The files of the world pack in a folder.
    ///
    /// # Errors
    /// Why there is none.
    fn pack_files(&self, folder: &Path) -> Result<Vec<PackFile>, String>;
}

/// Why a study cannot be run.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// Its file cannot be read.
    #[error("{file}: {source}")]
    File {
        /// The file.
        file: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// Things are wrong in it.
    #[error("{0}")]
    Problems(Problems),
}

/// Flags of `play` that the study's server itself sets for each session, or that would part its page from the study's.
const OWN_FLAGS: [&str; 18] = [
    "branch",
    "framed-by",
    "hide",
    "host",
    "listen",
    "log",
    "page-language",
    "page-texts",
    "participant",
    "port",
    "seats",
    "session",
    "supervisor",
    "tls",
    "tls-certificate",
    "tls-key",
    "world",
    "world-hash",
];

/// What to do instead of setting one of these: a few follow from a key of the file.
fn instead_of(flag: &str) -> &'static str {
    match flag {
        "page-language" => "it follows from `language`, a key above all tables",
        "page-texts" => "it follows from `page_texts`, a key above all tables",
        "seats" => "it follows from `participants_per_session`, a key above all tables",
        "world" => "it follows from `world`, a key above all tables",
        _ => "leave it out",
    }
}

/// A study's file with its text.
#[derive(Clone, Debug)]
pub struct StudyFile {
    /// As its user named it.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
}

impl StudyFile {
    /// Reads a file.
    ///
    /// # Errors
    /// [`StudyError::File`].
    pub fn read(path: &Path) -> Result<Self, StudyError> {
        let failed = |source| StudyError::File { file: path.to_owned(), source };
        Ok(Self { path: path.to_owned(), text: fs::read_to_string(path).map_err(failed)? })
    }

    /// The folder that names of files in it start from.
    #[must_use]
    pub fn folder(&self) -> &Path {
        self.path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."))
    }

    /// Checks all of it, and tells all that is wrong at once: what is none of its key's values is left out, and the rest looked
    /// at.
    ///
    /// # Errors
    /// [`StudyError::Problems`], each with its place.
    pub fn check(&self, program: &dyn Program) -> Result<Study, StudyError> {
        let name = self.path.display().to_string();
        let mut findings = Findings::new(&name, &self.text);
        let (mut document, errors) = DeTable::parse_recoverable(&self.text);
        for error in &errors {
            findings.add_syntax(error.span().unwrap_or_default(), error.message());
        }
        findings.check_table(document.get_mut(), &(0..0), STUDY, &Pointer::default());
        let written = Written::deserialize(Deserializer::from(document)).unwrap_or_else(|error| {
            findings.add_syntax(error.span().unwrap_or_default(), error.message());
            Written::default()
        });
        let study = Checking::new(&mut findings, program, self.folder()).study(&written);
        if findings.is_empty() { Ok(study) } else { Err(StudyError::Problems(findings.into_problems())) }
    }
}

struct Checking<'a, 'f> {
    findings: &'a mut Findings<'f>,
    program: &'a dyn Program,
    folder: &'a Path,
    /// The questionnaires that were found so far.
    asked: Vec<Questionnaire>,
    /// What is known of them, by name.
    instruments: BTreeMap<String, Instrument>,
    /// The files that were read so far.
    files: BTreeMap<String, String>,
    /// Where the study keeps what people say, if it does.
    keeps_audio: Option<(Range<usize>, Pointer)>,
    /// Whether each setting could be read that says whether a wizard takes part.
    knows_wizards: bool,
    /// What participants read on their pages.
    texts: PageTexts,
    /// What missions are checked in, if it is not what is built in alone.
    world: Option<WorldData>,
}

impl<'a, 'f> Checking<'a, 'f> {
    fn new(findings: &'a mut Findings<'f>, program: &'a dyn Program, folder: &'a Path) -> Self {
        Self {
            findings,
            program,
            folder,
            asked: Vec::new(),
            instruments: BTreeMap::new(),
            files: BTreeMap::new(),
            keeps_audio: None,
            knows_wizards: true,
            texts: PageTexts::default(),
            world: None,
        }
    }
}

impl Checking<'_, '_> {
    fn study(&mut self, written: &Written) -> Study {
        let root = Pointer::default();
        let (page_texts, page_texts_file) = self.page_texts(written).unwrap_or_default();
        // The usual exercises of tutorials are in the same language.
        self.texts = page_texts.clone();
        let worlds = self.worlds(written.world.as_ref());
        let blocks = self.blocks(&written.block, &root.key("block"));
        let participants = written.participants.as_ref();
        if let Some(none) = participants.filter(|count| *count.get_ref() == 0) {
            self.findings.add(none.span(), &root.key("participants"), "nobody takes part", "plan one at least");
        }
        let probes = self.probes(&written.probe, &root.key("probe"));
        let pairing = self.pairing(written);
        let factors = self.factors(&written.factor, pairing.is_some(), &root.key("factor"));
        let wizard = self.wizard(written.wizard.as_ref());
        let codes = self.codes(&written.code, &root.key("code"));
        let minimisation = self.minimisation(written.minimisation.as_ref(), &factors, &blocks);
        let mut study = Study {
            pairing,
            probes,
            worlds,
            wizard,
            codes,
            minimisation,
            page_texts,
            page_texts_file,
            information: self.sheet(&written.information, &root.key("information")),
            consent: self.sheet(&written.consent, &root.key("consent")),
            consents: boxes(&written.consent),
            settings: self.settings(&written.settings, &root.key("settings")),
            factors,
            keep_until: self.keep_until(written.keep_until.as_ref()),
            completion: self.completion(written),
            missions: written.missions.as_ref().map(|missions| words(missions.get_ref())).unwrap_or_default(),
            assignment: written.assignment.as_ref().map(|assignment| *assignment.get_ref()).unwrap_or_default(),
            block_size: 1,
            debriefing: blocks.debriefing,
            blocks: blocks.all,
            questionnaires: std::mem::take(&mut self.asked),
            instruments: std::mem::take(&mut self.instruments),
            files: BTreeMap::new(),
            participants: participants.map_or(1, |count| *count.get_ref()),
            title: written.title.clone(),
            contact: written.contact.clone(),
            seed: written.seed,
        };
        self.whole(&mut study, written, &blocks.places);
        study.files = std::mem::take(&mut self.files);
        study
    }

    fn sheet(&mut self, sheet: &WrittenSheet, at: &Pointer) -> Sheet {
        Sheet { version: sheet.version.clone(), text: self.text(sheet.file.as_ref(), at).unwrap_or_default() }
    }

    /// The text of a Markdown file.
    fn text(&mut self, file: Option<&Spanned<String>>, at: &Pointer) -> Option<String> {
        let file = file?;
        let text = self.file(file, &at.key("file"))?;
        if text.trim().is_empty() {
            let remedy = "write what participants are to read into that file";
            self.findings.add(file.span(), &at.key("file"), format!("`{}` is empty", file.get_ref()), remedy);
        }
        Some(text)
    }

    /// The text of a file in the study's folder, which is kept with the study's data.
    fn file(&mut self, name: &Spanned<String>, at: &Pointer) -> Option<String> {
        let is_within = |name: &str| Path::new(name).components().all(|part| matches!(part, Component::Normal(_)));
        let problem = match fs::read_to_string(self.folder.join(name.get_ref())) {
            Ok(text) if is_within(name.get_ref()) => {
                self.files.insert(name.get_ref().clone(), text.clone());
                return Some(text);
            }
            Ok(_) => "it lies outside the folder of the study".to_owned(),
            Err(error) => error.to_string(),
        };
        let remedy = format!("name a file that lies in {}, or in a folder in there", self.folder.display());
        self.findings.add(name.span(), at, format!("`{}`: {problem}", name.get_ref()), remedy);
        None
    }

    /// Those of the settings that can be.
    fn settings(&mut self, written: &WrittenSettings, at: &Pointer) -> Settings {
        let mut all = Settings::new();
        for (name, value) in written {
            let (place, setting) = (at.key(name.get_ref()), written::setting(value.get_ref()));
            if self.is_setting(name, &setting, &place) {
                // Sessions are played where the study's files are kept.
                for file in settings::files(name.get_ref(), &setting) {
                    self.file(&Spanned::new(value.span(), file), &place);
                }
                all.insert(name.get_ref().clone(), setting);
            }
        }
        all
    }

    fn is_setting(&mut self, name: &Spanned<String>, setting: &Setting, at: &Pointer) -> bool {
        let text = name.get_ref().as_str();
        let (problem, remedy) = if OWN_FLAGS.contains(&text) {
            (format!("`{text}` is not a study's to set"), instead_of(text))
        } else if text.starts_with("wizard-") || text.starts_with("wizard_") {
            (format!("`{text}` is the same in all sessions"), "write it into `[wizard]`, without its first word")
        } else if OF_PAGES.contains(&text) {
            if matches!(setting, Setting::Switch(_)) {
                return true;
            }
            (format!("`{text}` is shown to participants, or is not"), "write true or false")
        } else {
            if text == RECORD_AUDIO && *setting == Setting::Switch(true) {
                self.keeps_audio.get_or_insert((name.span(), at.clone()));
            }
            let own = Settings::from([(text.to_owned(), setting.clone())]);
            let Err(problem) = self.program.check_arguments(&arguments(&own)) else { return true };
            self.knows_wizards &= text != WIZARD;
            (
                problem,
                "write flags of `cohabit play` without their dashes (`cohabit play --help` lists them), or `score` or `clock`",
            )
        };
        self.findings.add(name.span(), at, problem, remedy);
        false
    }

    fn factors(&mut self, factors: &[Spanned<WrittenFactor>], has_pairs: bool, at: &Pointer) -> Vec<Factor> {
        let mut names = BTreeSet::new();
        let mut all = Vec::new();
        for (index, factor) in factors.iter().enumerate() {
            let (place, span) = (at.item(index), factor.span());
            let kind = self.kind(factor, has_pairs, &place);
            let factor = factor.get_ref();
            let name = self.name(factor.name.as_ref(), &mut names, &place);
            if (1..2).contains(&factor.level.len()) {
                let remedy = "add another `[[factor.level]]`, or move its settings to `[settings]`";
                self.findings.add(span, &place, "a factor with one level", remedy);
            }
            let mut levels = BTreeSet::new();
            let level = |(index, level): (usize, &Spanned<written::WrittenLevel>)| {
                let place = place.key("level").item(index);
                let name = self.name(level.get_ref().name.as_ref(), &mut levels, &place);
                Level { name, settings: self.settings(&level.get_ref().settings, &place.key("settings")) }
            };
            let levels = factor.level.iter().enumerate().map(level).collect();
            all.push(Factor { name, kind, levels });
        }
        all
    }

    /// A name that columns of tables can have, and that none before has.
    fn name(&mut self, name: Option<&Spanned<String>>, before: &mut BTreeSet<String>, at: &Pointer) -> String {
        let Some(name) = name else { return String::new() };
        let text = name.get_ref();
        if !text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') {
            let message = format!("`{text}` cannot be the name of a column");
            self.findings.add(name.span(), &at.key("name"), message, "write letters, digits and _ alone");
        }
        if !before.insert(text.clone()) {
            let message = format!("`{text}` is there twice");
            self.findings.add(name.span(), &at.key("name"), message, "give it a name of its own");
        }
        text.clone()
    }

    /// The day until which data are kept.
    fn keep_until(&mut self, day: Option<&Spanned<String>>) -> Option<String> {
        let day = day?;
        if !is_day(day.get_ref()) {
            let message = format!("`{}` is no day", day.get_ref());
            let remedy = "write year, month and day, such as \"2031-12-31\"";
            self.findings.add(day.span(), &Pointer::default().key("keep_until"), message, remedy);
        }
        Some(day.get_ref().clone())
    }

    fn completion(&mut self, written: &Written) -> Option<Completion> {
        match (&written.completion_code, &written.return_url) {
            (Some(code), None) => Some(Completion::Code(code.get_ref().clone())),
            (None, Some(url)) => {
                if !["https://", "http://"].iter().any(|scheme| url.get_ref().starts_with(scheme)) {
                    let message = format!("`{}` is no address of a page", url.get_ref());
                    self.findings.add(
                        url.span(),
                        &Pointer::default().key("return_url"),
                        message,
                        "begin it with https://",
                    );
                }
                if let Err(problem) = places(url.get_ref()) {
                    let remedy = "such as https://example.org/back?survey_code={survey_code}";
                    self.findings.add(url.span(), &Pointer::default().key("return_url"), problem, remedy);
                }
                Some(Completion::Return(url.get_ref().clone()))
            }
            (Some(_), Some(url)) => {
                let remedy = "keep one of them";
                let message = "participants get a completion code or a return address, not both";
                self.findings.add(url.span(), &Pointer::default().key("return_url"), message, remedy);
                None
            }
            (None, None) => None,
        }
    }
}

/// The boxes of the consent form, those that have to be ticked first.
fn boxes(consent: &WrittenSheet) -> Vec<ConsentBox> {
    let of = |all: &[WrittenBox], is_required: bool| -> Vec<ConsentBox> {
        let one = |written: &WrittenBox| match written {
            WrittenBox::Sentence(text) => ConsentBox { text: text.clone(), is_required, audio: false },
            WrittenBox::Marked { text, audio } => ConsentBox { text: text.clone(), is_required, audio: *audio },
        };
        all.iter().map(one).collect()
    };
    [of(&consent.required, true), of(&consent.optional, false)].concat()
}

/// Whether a text is a day as `2031-12-31`: such texts are in the order of the days.
fn is_day(text: &str) -> bool {
    let parts: Vec<&str> = text.split('-').collect();
    let [year, month, day] = parts[..] else { return false };
    let number = |part: &str, digits: usize| {
        let is_number = part.len() == digits && part.bytes().all(|byte| byte.is_ascii_digit());
        if is_number { part.parse::<u32>().ok() } else { None }
    };
    let (year, month, day) = (number(year, 4), number(month, 2), number(day, 2));
    year.is_some()
        && month.is_some_and(|month| (1..=12).contains(&month))
        && day.is_some_and(|day| (1..=31).contains(&day))
}

fn words(all: &Words) -> Vec<String> {
    all.iter().map(|word| word.get_ref().clone()).collect()
}

#[cfg(test)]
mod tests;
