//! What pedestrians do and when: a schedule from a file. Pure: text in, checked entries out.

use std::collections::BTreeMap;

use cohabit_cdf::{Catalog, Layout, RoomId};
use serde::Deserialize;

use crate::agent::TICKS_PER_SECOND;

/// A schedule is no longer than this, and names no later time, s: a day.
const MOST_ENTRIES: usize = 10_000;
const LONGEST_S: f64 = 86_400.0;
/// Nobody goes further from the middle of a floor plan, m.
const FURTHEST_M: f32 = 1e3;
/// Viewpoints of a room.
const VIEWPOINTS: u8 = 8;

/// Who does what, in which order.
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule {
    entries: BTreeMap<u32, Vec<Entry>>,
}

/// One thing that a person does.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Entry {
    /// Its number in the file, from 1.
    pub number: usize,
    /// The first tick of it, counted from the beginning of the round.
    pub not_before: u64,
    pub errand: Errand,
    /// Whether the person begins again after it.
    pub repeat: bool,
}

/// What there is to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Errand {
    /// Walk there.
    GoTo(Place),
    /// Stand for so many ticks.
    Stay(u64),
    /// Walk up to somebody, by the number of their body.
    Meet(u32),
}

/// Where to walk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Place {
    /// A viewpoint of a room, whichever.
    Room(RoomId),
    /// That one, from 1.
    Viewpoint(RoomId, u8),
    /// A point of the floor, m.
    Point([f32; 2]),
}

/// Why a file is no schedule.
#[derive(Debug, thiserror::Error)]
pub enum ScheduleError {
    /// It is not the TOML expected.
    #[error("{file}: {source}")]
    Syntax {
        /// Which file.
        file: String,
        /// Where and what.
        source: Box<toml::de::Error>,
    },
    /// An entry asks for what there is not.
    #[error("{file}: entry {entry}: {what}")]
    Entry {
        /// Which file.
        file: String,
        /// The entry, counted from 1.
        entry: usize,
        /// What is wrong, and the remedy.
        what: String,
    },
    /// It has no entry, or too many.
    #[error("{file}: a schedule has 1 to {MOST_ENTRIES} entries, and this one has {count}: write each as [[entry]]")]
    Count {
        /// Which file.
        file: String,
        /// How many.
        count: usize,
    },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    #[serde(default)]
    entry: Vec<WrittenEntry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenEntry {
    person: u32,
    #[serde(default)]
    at_s: f64,
    go_to: Option<String>,
    stay_s: Option<f64>,
    meet: Option<u32>,
    #[serde(default)]
    repeat: bool,
}

impl Schedule {
    /// Reads a schedule that comes from `file`; its rooms are those of the catalogue.
    ///
    /// # Errors
    /// [`ScheduleError`] names the file, the entry, what is wrong and what would be right.
    pub fn parse(file: &str, text: &str, catalog: &Catalog) -> Result<Self, ScheduleError> {
        let read: Result<Written, _> = toml::from_str(text);
        let written =
            read.map_err(|source| ScheduleError::Syntax { file: file.to_owned(), source: Box::new(source) })?;
        let count = written.entry.len();
        if !(1..=MOST_ENTRIES).contains(&count) {
            return Err(ScheduleError::Count { file: file.to_owned(), count });
        }
        let mut entries = BTreeMap::<u32, Vec<Entry>>::new();
        for (index, written) in written.entry.into_iter().enumerate() {
            let wrong = |what: String| ScheduleError::Entry { file: file.to_owned(), entry: index + 1, what };
            let own = entries.entry(written.person).or_default();
            if own.last().is_some_and(|before| before.repeat) {
                let person = written.person;
                let remedy = "repeat = true belongs to the last entry of a person";
                return Err(wrong(format!("person {person} begins again before it: {remedy}")));
            }
            own.push(Entry::of(index + 1, &written, catalog).map_err(wrong)?);
        }
        Ok(Self { entries })
    }

    /// The bodies of the people who have something to do, in order.
    pub fn people(&self) -> impl Iterator<Item = u32> + '_ {
        self.entries.keys().copied()
    }

    /// All bodies that it names, also those that are only met.
    #[must_use]
    pub fn bodies(&self) -> Vec<u32> {
        let met = self.entries.values().flatten().filter_map(|entry| match entry.errand {
            Errand::Meet(other) => Some(other),
            Errand::GoTo(_) | Errand::Stay(_) => None,
        });
        let mut all: Vec<u32> = self.people().chain(met).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// What is wrong with the first entry that leads to no place of a floor plan; nothing, if all lead to one.
    #[must_use]
    pub fn misplaced(&self, layout: &Layout) -> Option<String> {
        let all = self.entries.values().flatten();
        let wrong = all.filter_map(|entry| match entry.errand {
            Errand::GoTo(place) => Some((entry.number, place.fault(layout)?)),
            Errand::Stay(_) | Errand::Meet(_) => None,
        });
        let (number, fault) = wrong.min_by_key(|(number, _)| *number)?;
        Some(format!("entry {number}: {fault}"))
    }

    /// What one of them does.
    pub(crate) fn entries(&self, person: u32) -> &[Entry] {
        self.entries.get(&person).map_or(&[], Vec::as_slice)
    }
}

impl Place {
    /// Why nobody can go there on a floor plan; nothing, if it is a place of that.
    fn fault(self, layout: &Layout) -> Option<String> {
        let plan = &layout.id;
        match self {
            Self::Room(room) | Self::Viewpoint(room, _) => layout.room(room).is_none().then(|| {
                let rooms = layout.rooms.iter().map(|room| room.id.id()).collect::<Vec<_>>().join(", ");
                format!("the floor plan {plan} has no room {}: write one of its own ({rooms})", room.id())
            }),
            Self::Point([x, y]) => {
                let [west, south, east, north] = layout.bounds_m();
                let is_within = (west..=east).contains(&x) && (south..=north).contains(&y);
                (!is_within).then(|| {
                    let reach = format!("{west} to {east} along x, and from {south} to {north} along y");
                    format!("{x} {y} is outside of the floor plan {plan}: write a point from {reach}")
                })
            }
        }
    }
}

impl Entry {
    fn of(number: usize, written: &WrittenEntry, catalog: &Catalog) -> Result<Self, String> {
        let errand = match (&written.go_to, written.stay_s, written.meet) {
            (Some(place), None, None) => Errand::GoTo(place_of(place, catalog)?),
            (None, Some(stay_s), None) => Errand::Stay(ticks("stay_s", stay_s)?),
            (None, None, Some(other)) if other == written.person => {
                return Err(format!("meet = {other}: nobody meets themselves, name another body"));
            }
            (None, None, Some(other)) => Errand::Meet(other),
            _ => return Err("write one of go_to, stay_s and meet, such as go_to = \"BreakRoom\"".to_owned()),
        };
        Ok(Self { number, not_before: ticks("at_s", written.at_s)?, errand, repeat: written.repeat })
    }
}

/// A length of time in ticks.
fn ticks(name: &str, seconds: f64) -> Result<u64, String> {
    if !(0.0..=LONGEST_S).contains(&seconds) {
        return Err(format!("{name} = {seconds}: write seconds, from 0 to {LONGEST_S}"));
    }
    Ok((seconds * TICKS_PER_SECOND as f64).round() as u64)
}

/// A room, a viewpoint such as `BreakRoom_3`, or a point such as `4.0 10.5`.
fn place_of(text: &str, catalog: &Catalog) -> Result<Place, String> {
    let (text, rooms) = (text.trim(), catalog.rooms());
    if let Some(room) = rooms.find(text) {
        return Ok(Place::Room(room));
    }
    let viewpoint = text.rsplit_once('_').and_then(|(room, number)| {
        let number = number.parse().ok().filter(|number| (1..=VIEWPOINTS).contains(number))?;
        Some(Place::Viewpoint(rooms.find(room)?, number))
    });
    let coordinate = |text: &str| text.trim().parse::<f32>().ok().filter(|own| own.abs() <= FURTHEST_M);
    let point = || {
        let (x, y) = text.split_once(char::is_whitespace)?;
        Some(Place::Point([coordinate(x)?, coordinate(y)?]))
    };
    viewpoint.or_else(point).ok_or_else(|| {
        let rooms = rooms.listed();
        format!(
            "go_to = \"{text}\": write a room ({rooms}), a viewpoint such as \"BreakRoom_3\" (1 to {VIEWPOINTS} of each \
             room), or a point in metres such as \"4.0 10.5\""
        )
    })
}

/// Where somebody is in their entries.
#[derive(Clone, Debug)]
pub(crate) struct Diary {
    entries: Vec<Entry>,
    next: usize,
    round_began: u64,
}

impl Diary {
    pub fn new(entries: &[Entry]) -> Self {
        Self { entries: entries.to_vec(), next: 0, round_began: 0 }
    }

    /// What there is to do at a tick, if there is anything.
    pub fn now(&self, tick: u64) -> Option<Errand> {
        let entry = self.entries.get(self.next)?;
        (tick >= self.round_began + entry.not_before).then_some(entry.errand)
    }

    /// It is done.
    pub fn done(&mut self, tick: u64) {
        let repeat = self.entries.get(self.next).is_some_and(|entry| entry.repeat);
        self.next += 1;
        if repeat {
            (self.next, self.round_began) = (0, tick);
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    const OFFICE: &str = r#"
        [[entry]]
        person = 1
        go_to = "MainOffice_2"

        [[entry]]
        person = 2
        meet = 1

        [[entry]]
        person = 1
        at_s = 10
        stay_s = 2.5

        [[entry]]
        person = 1
        go_to = "4.0 -1.5"
        repeat = true
    "#;

    #[test]
    fn people_do_one_thing_after_the_other_and_begin_again() {
        let schedule = Schedule::parse("a.toml", OFFICE, &Catalog::builtin()).unwrap();
        assert_eq!(schedule.people().collect::<Vec<_>>(), [1, 2]);
        assert_eq!(schedule.entries(2)[0].errand, Errand::Meet(1));
        let mut diary = Diary::new(schedule.entries(1));
        let first = Some(Errand::GoTo(Place::Viewpoint(RoomId::MAIN_OFFICE, 2)));
        assert_eq!(diary.now(0), first);
        diary.done(60);
        assert_eq!((diary.now(599), diary.now(600)), (None, Some(Errand::Stay(150))));
        diary.done(750);
        assert_eq!(diary.now(750), Some(Errand::GoTo(Place::Point([4.0, -1.5]))));
        diary.done(1000);
        assert_eq!(diary.now(1000), first);
        diary.done(1001);
        assert_eq!((diary.now(1599), diary.now(1600)), (None, Some(Errand::Stay(150))));
        let mut once = Diary::new(schedule.entries(2));
        once.done(5);
        assert_eq!(once.now(10_000), None);
    }

    #[test]
    fn what_is_wrong_is_named_with_its_place_and_a_remedy() {
        let catalog = Catalog::builtin();
        for (text, part) in [
            ("", "a.toml: a schedule has 1 to 10000 entries, and this one has 0"),
            ("[[entry]]\nperson = 1", "a.toml: entry 1: write one of go_to, stay_s and meet"),
            ("[[entry]]\nperson = 1\nmeet = 2\nstay_s = 1", "entry 1: write one of"),
            ("[[entry]]\nperson = 1\nmeet = 1", "nobody meets themselves"),
            ("[[entry]]\nperson = 1\nstay_s = -1", "stay_s = -1: write seconds, from 0 to 86400"),
            ("[[entry]]\nperson = 1\nstay_s = nan", "stay_s = NaN"),
            ("[[entry]]\nperson = 1\nat_s = 1e9\nmeet = 2", "at_s = 1000000000"),
            ("[[entry]]\nperson = 1\ngo_to = \"Attic\"", "go_to = \"Attic\": write a room (BreakRoom,"),
            ("[[entry]]\nperson = 1\ngo_to = \"Lab1_9\"", "go_to = \"Lab1_9\""),
            ("[[entry]]\nperson = 1\ngo_to = \"nan 1\"", "go_to = \"nan 1\""),
            ("[[entry]]\nwho = 1", "unknown field `who`"),
        ] {
            let found = Schedule::parse("a.toml", text, &catalog).unwrap_err().to_string();
            assert!(found.contains(part), "`{part}` is not in {found}");
        }
        let twice = "[[entry]]\nperson = 1\nstay_s = 1\nrepeat = true\n[[entry]]\nperson = 1\nstay_s = 1";
        let found = Schedule::parse("a.toml", twice, &catalog).unwrap_err().to_string();
        assert!(found.contains("entry 2: person 1 begins again before it"), "{found}");
    }
}
