//! What was said, line by line in a file of the session's folder, so that a dialog service that takes a dead one's place
//! goes on where that was.
//!
//! What follows from a message is written before it is told, and that it was told after. One that dies in between is
//! followed by one that tells it.

use std::{
    collections::{BTreeMap, BTreeSet, VecDeque},
    fs::{self, File},
    io::{self, Write as _},
    net::SocketAddr,
    os::unix::fs::OpenOptionsExt as _,
    path::{Path, PathBuf},
};

use cohabit_bus::Envelope;
use cohabit_language::Lessons;
use cohabit_record::Log;
use serde::{Deserialize, Serialize};

use crate::{conversation, hub::LINES_KEPT, page::Line, recorded};

/// The file is written anew when it has grown by so much.
const MOST_GROWTH: u64 = 4 << 20;
/// The most visitors that are known again.
pub const MOST_VISITORS: usize = 1000;
/// The most publishers' runs of which is known how far they were followed.
const MOST_RUNS: usize = 256;

/// Where the page is served.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Place {
    /// The address.
    pub address: SocketAddr,
    /// The word that lets a page in.
    pub token: String,
    /// The word that lets a wizard's page in.
    pub wizard: String,
    /// The words that let in the pages of people who have a seat each.
    #[serde(default)]
    pub seats: Vec<String>,
}

/// What follows from one message.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct Deed {
    /// The message: its publisher's run and its number there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub heard: Option<(u64, u64)>,
    /// What is said.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub lines: Vec<Line>,
    /// The conversations that changed, each of one body, as they are then.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub conversations: BTreeMap<u32, conversation::Memory>,
}

/// All that is known of the past.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
pub struct Past {
    /// Where the page is served.
    pub place: Option<Place>,
    /// The chat, of which so many lines are kept as pages are shown.
    pub lines: VecDeque<Line>,
    /// The conversations, each of one body.
    pub conversations: BTreeMap<u32, conversation::Memory>,
    /// What each robot knows, as far as it saw it.
    pub lessons: BTreeMap<u32, Lessons>,
    /// The keys of the pages by the numbers of their visitors.
    pub visitors: BTreeMap<u32, u64>,
    /// The number of the newest visitor.
    #[serde(default)]
    newest_visitor: u32,
    /// The questionnaires that each visitor has answered.
    #[serde(default)]
    pub answered: BTreeMap<u32, BTreeSet<String>>,
    /// What may not have been told.
    pub untold: Vec<Line>,
    /// How far the publishers were followed, by their runs.
    heard: BTreeMap<u64, u64>,
}

/// One line of the file.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Entry {
    /// The first.
    Past(Past),
    Place(Place),
    Deed(Deed),
    /// What a body's robot learnt.
    Lessons(u32, Lessons),
    /// A visitor who was not there before, and the key of the page.
    Visitor(u32, u64),
    /// A visitor who is not known again.
    Forgotten(u32),
    /// A visitor has answered a questionnaire.
    Answered(u32, String),
    /// The deed before was told.
    Told,
}

/// An open journal.
pub struct Journal {
    file: Option<(PathBuf, File)>,
    past: Past,
    bytes: u64,
    bytes_at_first: u64,
}

impl Past {
    fn take(&mut self, entry: Entry) {
        match entry {
            Entry::Past(past) => *self = past,
            Entry::Place(place) => self.place = Some(place),
            Entry::Lessons(body, lessons) => self.lessons.entry(body).or_default().add(lessons),
            Entry::Visitor(number, key) => {
                self.visitors.insert(number, key);
                self.newest_visitor = number;
            }
            Entry::Forgotten(number) => drop(self.visitors.remove(&number)),
            Entry::Answered(visitor, questionnaire) => {
                self.answered.entry(visitor).or_default().insert(questionnaire);
            }
            Entry::Told => self.untold.clear(),
            Entry::Deed(Deed { heard, lines, conversations }) => {
                self.lines.extend(lines.iter().cloned());
                self.lines.drain(..self.lines.len().saturating_sub(LINES_KEPT));
                self.untold = lines;
                self.heard.extend(heard);
                while self.heard.len() > MOST_RUNS {
                    self.heard.pop_first();
                }
                self.conversations.extend(conversations);
            }
        }
    }
}

/// Begins the journal of a session that goes on from a point of another one: its pages know what was said up to there.
/// Its robots remember nothing of it.
///
/// # Errors
/// When the file cannot be written.
pub fn begin_after(path: &Path, log: &Log, tick: u64, several_robots: bool) -> io::Result<()> {
    let told = recorded::told(log, several_robots);
    let lines = told.into_iter().filter(|(at, _)| *at <= tick).filter_map(|(_, told)| match told {
        // Nobody waits for an answer any more.
        recorded::Told::Line(line) => Some(Line { answers: Vec::new(), ..line }),
        _ => None,
    });
    let mut lines: VecDeque<_> = lines.collect();
    lines.drain(..lines.len().saturating_sub(LINES_KEPT));
    let past = Past { lines, ..Past::default() };
    Journal::new(None, past).write_anew(path)
}

impl Journal {
    /// The journal of that file; an empty one where there is none, and one that writes nothing where it cannot be
    /// written, which is said.
    pub fn open(path: Option<&Path>) -> Self {
        let Some(path) = path else { return Self::new(None, Past::default()) };
        match Self::read(path) {
            Ok(journal) => journal,
            Err(error) => {
                tracing::warn!("{}: {error}; if this service is killed, what was said is forgotten", path.display());
                Self::new(None, Past::default())
            }
        }
    }

    fn new(file: Option<(PathBuf, File)>, past: Past) -> Self {
        Self { file, past, bytes: 0, bytes_at_first: 0 }
    }

    fn read(path: &Path) -> io::Result<Self> {
        let text = match fs::read(path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => Vec::new(),
            text => text?,
        };
        let mut past = Past::default();
        // A torn line, and what may follow it, was never told.
        let whole = text.split_inclusive(|byte| *byte == b'\n').filter(|line| line.ends_with(b"\n"));
        for entry in whole.map_while(|line| serde_json::from_slice(line).ok()) {
            past.take(entry);
        }
        let mut journal = Self::new(None, past);
        journal.write_anew(path)?;
        Ok(journal)
    }

    /// What is known of the past.
    pub const fn past(&self) -> &Past {
        &self.past
    }

    /// Whether this message, or a later one of the same publisher, was followed already.
    pub fn has_heard(&self, envelope: &Envelope) -> bool {
        self.past.heard.get(&envelope.run).is_some_and(|newest| *newest >= envelope.sequence)
    }

    /// Writes down where the page is served.
    pub fn serve_at(&mut self, place: Place) {
        self.write(Entry::Place(place));
    }

    /// Writes down what a body's robot learnt.
    pub fn note_lessons(&mut self, body: u32, lessons: Lessons) {
        self.write(Entry::Lessons(body, lessons));
    }

    /// The number of the visitor whose page has this key: visitors are numbered as they come, from 1, and keep their
    /// numbers. Of more than can be known again, the oldest is forgotten who has answered nothing and is not there now;
    /// nobody else gets that number. `None`, if all are there or have answered something.
    pub fn visitor(&mut self, key: u64, is_there: impl Fn(u32) -> bool) -> Option<u32> {
        let Past { visitors, answered, newest_visitor, .. } = &self.past;
        if let Some((number, _)) = visitors.iter().find(|(_, known)| **known == key) {
            return Some(*number);
        }
        let number = newest_visitor + 1;
        if visitors.len() >= MOST_VISITORS {
            let may_go = |number: &u32| !answered.contains_key(number) && !is_there(*number);
            let gone = visitors.keys().copied().find(may_go)?;
            self.write(Entry::Forgotten(gone));
        }
        self.write(Entry::Visitor(number, key));
        Some(number)
    }

    /// Writes down that a visitor has answered a questionnaire.
    pub fn note_answered(&mut self, visitor: u32, questionnaire: &str) {
        self.write(Entry::Answered(visitor, questionnaire.to_owned()));
    }

    /// Writes down what will be told.
    pub fn will_tell(&mut self, deed: Deed) {
        self.write(Entry::Deed(deed));
    }

    /// Writes down that it was told.
    pub fn told(&mut self) {
        if !self.past.untold.is_empty() {
            self.write(Entry::Told);
        }
    }

    fn write(&mut self, entry: Entry) {
        let line = line(&entry);
        self.past.take(entry);
        let Some((path, file)) = &mut self.file else { return };
        let written = if self.bytes + line.len() as u64 > self.bytes_at_first + MOST_GROWTH {
            let path = path.clone();
            self.write_anew(&path)
        } else {
            self.bytes += line.len() as u64;
            file.write_all(line.as_bytes())
        };
        if let Err(error) = written {
            tracing::error!("{error} at writing the journal; if this service is killed, what was said is forgotten");
            self.file = None;
        }
    }

    /// Writes the past into a new file that takes the place of the old one.
    fn write_anew(&mut self, path: &Path) -> io::Result<()> {
        let new = path.with_extension("new");
        let mut file = File::options().write(true).create(true).truncate(true).mode(0o600).open(&new)?;
        let line = line(&Entry::Past(self.past.clone()));
        file.write_all(line.as_bytes())?;
        fs::rename(&new, path)?;
        self.bytes = line.len() as u64;
        self.bytes_at_first = self.bytes;
        self.file = Some((path.to_owned(), file));
        Ok(())
    }
}

fn line(entry: &Entry) -> String {
    let mut line = serde_json::to_string(entry).expect("invariant: an entry is plain JSON");
    line.push('\n');
    line
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::{LineKind, Speaker};

    /// A file that goes when this is dropped.
    struct Scratch(PathBuf);

    impl Scratch {
        fn new(name: &str) -> Self {
            let path = std::env::temp_dir().join(format!("cohabit-journal-{name}-{}", std::process::id()));
            let _ = fs::remove_file(&path);
            Self(path)
        }

        fn open(&self) -> Journal {
            Journal::open(Some(&self.0))
        }
    }

    impl Drop for Scratch {
        fn drop(&mut self) {
            let _ = fs::remove_file(&self.0);
        }
    }

    fn deed(number: u64, text: &str) -> Deed {
        let lines = vec![Line::new(Speaker::Robot, LineKind::Say, number, text)];
        Deed {
            heard: Some((1 << 60, number)),
            lines,
            conversations: BTreeMap::from([(0, conversation::Memory::default())]),
        }
    }

    fn texts(journal: &Journal) -> Vec<&str> {
        journal.past.lines.iter().map(|line| line.text.as_str()).collect()
    }

    #[test]
    fn what_was_written_is_there_again_and_what_was_not_told_is_known() {
        let file = Scratch::new("again");
        let mut journal = file.open();
        let place = Place {
            address: "127.0.0.1:80".parse().unwrap(),
            token: "secret".to_owned(),
            wizard: "other".to_owned(),
            seats: vec!["one".to_owned(), "two".to_owned()],
        };
        journal.serve_at(place.clone());
        journal.will_tell(deed(3, "one"));
        journal.told();
        journal.will_tell(deed(4, "two"));
        drop(journal);
        for _ in 0..2 {
            let journal = file.open();
            assert_eq!(texts(&journal), ["one", "two"]);
            assert_eq!(journal.past.place, Some(place.clone()));
            assert_eq!(journal.past.untold.len(), 1);
            let heard = |sequence| journal.has_heard(&Envelope { run: 1 << 60, sequence, ..Envelope::default() });
            assert_eq!([3, 4, 5].map(heard), [true, true, false]);
        }
    }

    #[test]
    fn a_torn_line_never_was() {
        let file = Scratch::new("torn");
        let mut journal = file.open();
        (1..4).for_each(|number| journal.will_tell(deed(number, &format!("line {number}"))));
        drop(journal);
        let bytes = fs::read(&file.0).unwrap();
        let lines = bytes.iter().filter(|byte| **byte == b'\n').count();
        for length in 0..=bytes.len() {
            fs::write(&file.0, &bytes[..length]).unwrap();
            let whole = bytes[..length].iter().filter(|byte| **byte == b'\n').count();
            assert_eq!(texts(&file.open()).len(), whole.saturating_sub(1), "{length}");
        }
        assert_eq!(lines, 4);
    }

    #[test]
    fn a_visitors_number_is_nobody_elses() {
        let file = Scratch::new("visitors");
        let mut journal = file.open();
        let most = MOST_VISITORS as u64;
        let nobody = |_| false;
        for key in 0..most {
            assert_eq!(u64::from(journal.visitor(key, nobody).unwrap()), key + 1);
        }
        journal.note_answered(1, "sus");
        let is_there = |number| number == 2;
        let newcomer = journal.visitor(most, is_there);
        assert_eq!(newcomer, Some(MOST_VISITORS as u32 + 1));
        drop(journal);
        let mut journal = file.open();
        assert_eq!(journal.visitor(0, nobody), Some(1), "who has answered is known again");
        assert_eq!(journal.visitor(1, nobody), Some(2), "so is who was there");
        assert_eq!(journal.visitor(most, nobody), newcomer);
        assert_eq!(journal.visitor(2, is_there), Some(MOST_VISITORS as u32 + 2), "the third was forgotten");
        assert_eq!(journal.past().visitors.len(), MOST_VISITORS);
        assert_eq!(journal.visitor(most + 1, |_| true), None);
    }

    #[test]
    fn it_is_bounded() {
        let file = Scratch::new("bounded");
        let mut journal = file.open();
        let text = "x".repeat(2000);
        for number in 0..5000 {
            journal.will_tell(deed(number, &text));
            journal.told();
        }
        let kept = 2100 * LINES_KEPT as u64;
        assert!(fs::metadata(&file.0).unwrap().len() < MOST_GROWTH + 2 * kept);
        assert_eq!(texts(&file.open()).len(), LINES_KEPT);
    }

    #[test]
    fn where_it_cannot_be_written_the_talk_goes_on() {
        let mut journal = Journal::open(Some(Path::new("/nowhere/journal")));
        journal.will_tell(deed(1, "one"));
        assert_eq!(texts(&journal), ["one"]);
    }
}
