//! Who is asked what: a board of all tasks, those that are taken, and all annotations. It knows no clock; it is told the time.

#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet};

use crate::task::{Annotation, Kind, Reading, Segment, Task, Unit, What};

/// How tasks are given.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Settings {
    /// How many people write an instruction for each segment, how many ask about it, and how many answer each question; of
    /// the latter there are no more than people other than the one who asked.
    pub per_segment: usize,
    /// How long a task is kept for somebody whose page gives no sign of them, in ms.
    pub kept_ms: u64,
}

impl Default for Settings {
    /// Three people, as each mission of Alexa Arena's trajectories has (section 4.1); ten minutes.
    fn default() -> Self {
        Self { per_segment: 3, kept_ms: 10 * 60 * 1000 }
    }
}

/// A task that somebody has taken.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Claim {
    /// Its number: no two are alike while the board is there.
    pub number: u64,
    /// The task.
    pub task: Task,
    /// When it was taken, ms since 1970.
    pub taken_ms: u64,
    /// The last sign of who has taken it, ms since 1970.
    seen_ms: u64,
}

/// All tasks of a data set, and what came of them.
#[derive(Clone, Debug)]
pub struct Board {
    settings: Settings,
    segments: BTreeSet<Segment>,
    /// How many people there are.
    people: usize,
    annotations: BTreeMap<u64, Annotation>,
    tallies: BTreeMap<Unit, Tally>,
    claims: BTreeMap<String, Claim>,
    next_id: u64,
    next_claim: u64,
}

/// What came of a unit.
#[derive(Clone, Debug, Default)]
struct Tally {
    /// The annotations with a text.
    texts: Vec<u64>,
    skipped: usize,
    annotators: BTreeSet<String>,
}

impl Board {
    /// The board of these segments for so many people, of whom nobody has written anything. `first_claim` is the number of the first
    /// task that is taken: it is to be above those of a board before this one, whose pages may still be open.
    #[must_use]
    pub fn new(settings: Settings, segments: BTreeSet<Segment>, people: usize, first_claim: u64) -> Self {
        Self {
            settings,
            segments,
            people,
            annotations: BTreeMap::new(),
            tallies: BTreeMap::new(),
            claims: BTreeMap::new(),
            next_id: 0,
            next_claim: first_claim,
        }
    }

    /// A board with these lines of a journal, by which nobody is asked anything.
    #[must_use]
    pub fn of_record(lines: Vec<Annotation>) -> Self {
        let mut board = Self::new(Settings::default(), BTreeSet::new(), 0, 0);
        lines.into_iter().for_each(|line| board.note(line));
        board
    }

    /// Takes in an annotation, or a correction of one. Whoever wrote it has no task any more, if it was that one.
    pub fn note(&mut self, annotation: Annotation) {
        self.next_id = self.next_id.max(annotation.id + 1);
        if let Some(id) = annotation.corrects {
            if let Some(corrected) = self.annotations.get_mut(&id).filter(|one| one.annotator == annotation.annotator) {
                corrected.what = annotation.what;
            }
            return;
        }
        let unit = annotation.task.unit();
        if self.claims.get(&annotation.annotator).is_some_and(|claim| claim.task.unit() == unit) {
            self.claims.remove(&annotation.annotator);
        }
        let tally = self.tallies.entry(unit).or_default();
        match annotation.what {
            What::Text(_) => tally.texts.push(annotation.id),
            What::Skipped(_) => tally.skipped += 1,
        }
        tally.annotators.insert(annotation.annotator.clone());
        self.annotations.insert(annotation.id, annotation);
    }

    /// The task of an annotator: the one that they have, or the next one; `None` where there is none for them now.
    pub fn take(&mut self, annotator: &str, now_ms: u64) -> Option<Claim> {
        let taken = self.taken(annotator, now_ms);
        if let Some(mut claim) = self.claims.remove(annotator)
            && self.is_open(&claim.task.unit(), annotator, &taken)
        {
            claim.seen_ms = now_ms;
            self.claims.insert(annotator.to_owned(), claim.clone());
            return Some(claim);
        }
        let task = self.next(annotator, &taken)?;
        let claim = Claim { number: self.next_claim, task, taken_ms: now_ms, seen_ms: now_ms };
        self.next_claim += 1;
        self.claims.insert(annotator.to_owned(), claim.clone());
        Some(claim)
    }

    /// The task that an annotator has taken under that number, if it has not gone to somebody else meanwhile.
    #[must_use]
    pub fn claim(&self, annotator: &str, number: u64, now_ms: u64) -> Option<&Claim> {
        let claim = self.claims.get(annotator).filter(|claim| claim.number == number)?;
        self.is_open(&claim.task.unit(), annotator, &self.taken(annotator, now_ms)).then_some(claim)
    }

    /// How many segments there are.
    #[must_use]
    pub fn segments(&self) -> usize {
        self.segments.len()
    }

    /// The number of the next annotation.
    #[must_use]
    pub const fn next_id(&self) -> u64 {
        self.next_id
    }

    /// An annotation, with its newest text.
    #[must_use]
    pub fn annotation(&self, id: u64) -> Option<&Annotation> {
        self.annotations.get(&id)
    }

    /// All annotations with their newest texts, in the order in which they were first written.
    pub fn annotations(&self) -> impl DoubleEndedIterator<Item = &Annotation> + Clone {
        self.annotations.values()
    }

    /// How many units others hold now.
    fn taken(&self, annotator: &str, now_ms: u64) -> BTreeMap<Unit, usize> {
        let mut taken = BTreeMap::new();
        for (name, claim) in &self.claims {
            if name != annotator && now_ms.saturating_sub(claim.seen_ms) < self.settings.kept_ms {
                *taken.entry(claim.task.unit()).or_default() += 1;
            }
        }
        taken
    }

    /// Whether an annotator may be asked for a unit, while others hold those that are `taken`.
    fn is_open(&self, unit: &Unit, annotator: &str, taken: &BTreeMap<Unit, usize>) -> bool {
        let wanted = match unit.kind() {
            Kind::Instruction | Kind::Question => self.settings.per_segment,
            Kind::Answer => self.settings.per_segment.min(self.people.saturating_sub(1)),
        };
        let held = taken.get(unit).copied().unwrap_or_default();
        self.tallies.get(unit).map_or(held < wanted, |tally| {
            tally.texts.len() + held < wanted && tally.skipped < wanted && !tally.annotators.contains(annotator)
        })
    }

    /// Instructions first, then questions about them, then answers; of each, the first segments first, so that some are whole soon.
    fn next(&self, annotator: &str, taken: &BTreeMap<Unit, usize>) -> Option<Task> {
        let instruction = || {
            let segment = self
                .segments
                .iter()
                .find(|segment| self.is_open(&Unit::Instruction((*segment).clone()), annotator, taken))?;
            Some(Task::Instruction { segment: segment.clone() })
        };
        let question = || self.segments.iter().find_map(|segment| self.question(segment, annotator, taken));
        instruction().or_else(question).or_else(|| self.answer(annotator, taken))
    }

    /// To ask about a segment, by an instruction of somebody else. One person stands before its first step, the others further on.
    fn question(&self, segment: &Segment, annotator: &str, taken: &BTreeMap<Unit, usize>) -> Option<Task> {
        let unit = Unit::Question(segment.clone());
        if !self.is_open(&unit, annotator, taken) {
            return None;
        }
        let asked = self.tallies.get(&unit).map_or(0, |tally| tally.texts.len())
            + taken.get(&unit).copied().unwrap_or_default();
        let read: Vec<Reading> = self
            .texts(&Unit::Instruction(segment.clone()))
            .filter(|one| one.annotator != annotator)
            .filter_map(reading)
            .collect();
        let instruction = read.get(asked.checked_rem(read.len())?)?.clone();
        let steps = segment.end_step - segment.first_step;
        let moment_step = segment.first_step + asked * steps / self.settings.per_segment;
        Some(Task::Question { segment: segment.clone(), moment_step, instruction })
    }

    /// To answer the first question of somebody else that lacks answers.
    fn answer(&self, annotator: &str, taken: &BTreeMap<Unit, usize>) -> Option<Task> {
        self.annotations.values().filter(|asked| asked.annotator != annotator).find_map(|asked| {
            let Task::Question { segment, instruction, .. } = &asked.task else { return None };
            let question = reading(asked)?;
            let is_asked = self.segments.contains(segment) && self.is_open(&Unit::Answer(asked.id), annotator, taken);
            is_asked.then(|| Task::Answer { segment: segment.clone(), instruction: instruction.clone(), question })
        })
    }

    /// The annotations of a unit that have a text.
    fn texts(&self, unit: &Unit) -> impl Iterator<Item = &Annotation> {
        let ids = self.tallies.get(unit).map(|tally| tally.texts.as_slice()).unwrap_or_default();
        ids.iter().filter_map(|id| self.annotations.get(id))
    }
}

/// An annotation as somebody else reads it.
fn reading(annotation: &Annotation) -> Option<Reading> {
    annotation.text().map(|text| Reading { id: annotation.id, text: text.to_owned() })
}
