//! One session as its log tells it: who said what, what was done about it, and which goals were met.

use std::{
    collections::BTreeMap,
    fmt::Display,
    path::{Component, Path, PathBuf},
};

use cohabit_cdf::{Action, BodyKind, Catalog, Mission, PackId, Status, mission};
use cohabit_record::{Branch, DialogEntry, EventEntry, Log, LogError, Movement};
use cohabit_world::DT_NANOS;

/// The body that is spoken to, where nothing else was noted.
pub(crate) const ROBOT: u32 = 0;

/// A session that was played.
#[derive(Clone, Debug)]
pub struct Played {
    /// What its rows are found by: the name of the log's file, without its ending.
    pub name: String,
    pub(crate) log: Log,
    pub(crate) mission: Mission,
    pub(crate) turns: Vec<Turn>,
    pub(crate) actions: Vec<Deed>,
    pub(crate) goals: Vec<Reached>,
    /// How its bodies moved, if that was worked out.
    pub(crate) movement: Option<Movement>,
    /// Whether another one that was read with it goes on from its end.
    pub(crate) is_continued: bool,
}

/// Why a log has no tables.
#[derive(Debug, thiserror::Error)]
pub enum PlayedError {
    /// It cannot be read.
    #[error(transparent)]
    Log(#[from] LogError),
    /// This program does not know its mission.
    #[error("{name}: its mission cannot be read: {problems}")]
    Mission {
        /// The log.
        name: String,
        /// What is wrong.
        problems: mission::Problems,
    },
    /// Its mission is one of a world pack that is not there.
    #[error(
        "{name}: it was played with the world pack {pack}, which is not given in this version: name its folder by `--world`"
    )]
    NoPack {
        /// The log.
        name: String,
        /// The pack.
        pack: PackId,
    },
}

/// Something that a person said, and what came of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Turn {
    /// Its number, from 1.
    pub number: u64,
    /// The body that was spoken to.
    pub body: u32,
    /// The number of the page at which it was said; 0 where that was not noted.
    pub person: u32,
    /// The newest tick when it was said.
    pub tick: u64,
    /// What was said.
    pub said: String,
    /// What the robot said to it.
    pub replies: Vec<String>,
    /// What the robot asked.
    pub questions: Vec<String>,
    /// The steps of the plans that were made of it.
    pub plan: Vec<Action>,
    /// How the last of its plans ended.
    pub ended: Option<Status>,
    /// Received, understood, first motion, first changed frame, shown by a page: ns of one clock, 0 where it did not happen.
    pub stamps: [u64; 5],
    /// Speech began, speech ended, its words, understood, first sound of an answer: of the same clock.
    pub spoken: [u64; 5],
    /// What it sounded like.
    pub heard: String,
    /// When it was told, and when it was first answered, ns of the same clock.
    told: (u64, Option<u64>),
}

/// A command.
#[derive(Clone, Debug, PartialEq)]
pub struct Deed {
    /// Its number, unlike that of any other of the session.
    pub number: u64,
    /// The turn it belongs to; 0 is none.
    pub turn: u64,
    /// The body that was told.
    pub body: u32,
    /// What to do.
    pub action: Action,
    /// The tick that took it in.
    pub began: u64,
    /// When it ended, how, and what was said of that.
    pub outcome: Option<(u64, Status, String)>,
}

/// A goal, and what came of it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Reached {
    pub number: i64,
    pub description: String,
    pub met: bool,
    pub first_met: Option<u64>,
    pub resets: usize,
}

/// Simulated time of a tick, s.
pub(crate) fn seconds(tick: u64) -> f64 {
    tick as f64 * (DT_NANOS as f64 * 1e-9)
}

impl Played {
    /// Reads a log.
    ///
    /// # Errors
    /// [`PlayedError`].
    pub fn open(path: &Path, catalog: &Catalog) -> Result<Self, PlayedError> {
        let name = path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy();
        Self::new(&name, Log::open(path)?, catalog)
    }

    /// Reads several logs. Where several files have one name, sessions are called by file and as many of the folders around it as
    /// tell them apart.
    ///
    /// # Errors
    /// [`PlayedError`].
    pub fn open_all(paths: &[PathBuf], catalog: &Catalog) -> Result<Vec<Self>, PlayedError> {
        let (all, unread) = Self::open_readable(paths, catalog);
        unread.into_iter().next().map_or(Ok(all), |(_, error)| Err(error))
    }

    /// The same of those that can be read; and the others, with the reason.
    #[must_use]
    pub fn open_readable(paths: &[PathBuf], catalog: &Catalog) -> (Vec<Self>, Vec<(PathBuf, PlayedError)>) {
        let (mut all, mut unread) = (Vec::new(), Vec::new());
        for (path, name) in paths.iter().zip(names(paths)) {
            match Self::open(path, catalog) {
                Ok(played) => all.push(Self { name, ..played }),
                Err(error) => unread.push((path.clone(), error)),
            }
        }
        carry_on(&mut all);
        (all, unread)
    }

    /// The session of a log that goes by that name.
    ///
    /// # Errors
    /// [`PlayedError::Mission`], [`PlayedError::NoPack`].
    pub fn new(name: &str, log: Log, catalog: &Catalog) -> Result<Self, PlayedError> {
        let (file, text) = (&log.session.mission_file, &log.session.mission_text);
        let read = mission::read_mission(file, text, catalog);
        let mission = read.map_err(|problems| unread(name, problems, &log.session.packs, catalog))?.mission;
        let (turns, turn_of) = turns(&log.dialog);
        let (actions, goals) = (actions(&log, &turn_of), goals(&mission, &log.events));
        Ok(Self { name: name.to_owned(), log, mission, turns, actions, goals, movement: None, is_continued: false })
    }

    /// The same, knowing how its bodies moved, if there was a person whom a robot could meet. A log has to be played again for that:
    /// `movement` does so, or says why it cannot.
    #[must_use]
    pub fn with_movement<E: Display>(self, movement: impl FnOnce(&Log) -> Result<Movement, E>) -> Self {
        if !self.log.session.bodies.iter().any(|body| body.kind == BodyKind::Person) {
            return self;
        }
        let none = |error: E| Movement { problem: Some(error.to_string()), ..Movement::default() };
        let movement = movement(&self.log).unwrap_or_else(none);
        Self { movement: Some(movement), ..self }
    }

    /// Its log.
    #[must_use]
    pub const fn log(&self) -> &Log {
        &self.log
    }

    /// What people said, in order.
    #[must_use]
    pub fn turns(&self) -> &[Turn] {
        &self.turns
    }

    /// All commands but those of held keys, in order.
    #[must_use]
    pub fn actions(&self) -> &[Deed] {
        &self.actions
    }

    /// Its ticks.
    pub(crate) fn ticks(&self) -> u64 {
        self.log.ticks.last().map_or(0, |entry| entry.tick)
    }

    /// Whether every goal was met in the end; `None` of a mission without goals.
    pub(crate) fn success(&self) -> Option<bool> {
        let complete = self.log.events.iter().any(|event| event.kind == "MissionComplete");
        (!self.goals.is_empty()).then(|| complete || self.goals.iter().all(|goal| goal.met))
    }

    /// Whether a wizard took part.
    pub(crate) fn has_wizard(&self) -> bool {
        self.log.session.settings.get("wizard").is_some_and(|takes_part| takes_part != "no")
    }

    /// What the robots that are spoken to were told to do.
    pub(crate) fn robots_actions(&self) -> impl Iterator<Item = &Deed> {
        let robots = self.robots();
        self.actions.iter().filter(move |deed| robots.contains(&deed.body))
    }

    /// The bodies that are spoken to.
    fn robots(&self) -> Vec<u32> {
        let noted = self.log.session.settings.get("robots").map_or("", String::as_str);
        let robots: Vec<u32> = noted.split(',').filter_map(|body| body.parse().ok()).collect();
        if robots.is_empty() { vec![ROBOT] } else { robots }
    }
}

/// What the sessions of these logs are called. Statistics take sessions that are called the same, and name no participant, for those of
/// one participant, so each has a name of its own.
fn names(paths: &[PathBuf]) -> Vec<String> {
    let parts: Vec<Vec<String>> = paths.iter().map(|path| parts(path)).collect();
    let named = |own: &[String], folders: usize| own[own.len().saturating_sub(folders + 1)..].join("/");
    let deepest = parts.iter().map(Vec::len).max().unwrap_or(0);
    let mut names: Vec<String> = parts.iter().map(|own| named(own, 0)).collect();
    for folders in 1..deepest {
        let mut count = BTreeMap::<String, usize>::new();
        for name in &names {
            *count.entry(name.clone()).or_default() += 1;
        }
        for (name, own) in names.iter_mut().zip(&parts) {
            if count[name.as_str()] > 1 {
                *name = named(own, folders);
            }
        }
    }
    names
}

/// The folders that a log is in, the outermost first, and behind them its file's name without the ending.
fn parts(path: &Path) -> Vec<String> {
    let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_owned()).with_extension("");
    let text = |part: Component<'_>| match part {
        Component::Normal(name) => Some(name.to_string_lossy().into_owned()),
        _ => None,
    };
    whole.components().filter_map(text).collect()
}

/// Why a mission cannot be read. Where a pack is missing, all that is said of rooms and classes follows from that.
fn unread(name: &str, problems: mission::Problems, packs: &[PackId], catalog: &Catalog) -> PlayedError {
    let name = name.to_owned();
    let missing = packs.iter().find(|pack| !catalog.packs().contains(pack));
    match missing.cloned() {
        Some(pack) => PlayedError::NoPack { name, pack },
        None => PlayedError::Mission { name, problems },
    }
}

impl Turn {
    /// Milliseconds from the words to: understood, first motion, first changed frame, shown by a page.
    pub fn latencies_ms(&self) -> [Option<f64>; 4] {
        let [received, later @ ..] = self.stamps;
        later.map(|stamp| (received != 0 && stamp != 0).then(|| stamp.saturating_sub(received) as f64 * 1e-6))
    }

    /// How long it took to say, s.
    pub fn speech_s(&self) -> Option<f64> {
        between_ms(self.spoken[0], self.spoken[1]).map(|ms| ms * 1e-3)
    }

    /// Milliseconds from the end of speech to its words.
    pub fn heard_ms(&self) -> Option<f64> {
        between_ms(self.spoken[1], self.spoken[2])
    }

    /// Milliseconds from the words to the first sound of an answer.
    pub fn sounded_ms(&self) -> Option<f64> {
        between_ms(self.spoken[2], self.spoken[4])
    }

    /// Milliseconds from the words to the first answer or question.
    pub fn answered_ms(&self) -> Option<f64> {
        let (told, answered) = self.told;
        answered.map(|answered| answered.saturating_sub(told) as f64 * 1e-6)
    }
}

/// Milliseconds between two stamps, if both are there.
fn between_ms(from: u64, to: u64) -> Option<f64> {
    (from != 0 && to != 0).then(|| to.saturating_sub(from) as f64 * 1e-6)
}

/// Turns, and the turn that each plan's number belongs to: those of a search count on in the series of turns.
fn turns(dialog: &[DialogEntry]) -> (Vec<Turn>, BTreeMap<u64, u64>) {
    let (mut turns, mut turn_of) = (Vec::<Turn>::new(), BTreeMap::new());
    for entry in dialog {
        if entry.kind == "Utterance" {
            let (number, body, person, tick) = (entry.turn, entry.body, entry.person, entry.tick);
            let (said, told) = (entry.text.clone(), (entry.sent_nanos, None));
            turns.push(Turn { number, body, person, tick, said, told, ..Turn::default() });
            turn_of.insert(number, number);
            continue;
        }
        // It is part of no turn.
        if entry.kind == "Pointed" {
            continue;
        }
        // What a mind says of its own accord can answer only what its own body was told, and what nobody asked for is of no turn.
        let is_asked = entry.turn > 0;
        let newest = turns.iter().rfind(|turn| is_asked || turn.body == entry.body).map(|turn| turn.number);
        let Some(number) = turn_of.get(&entry.turn).copied().or(newest) else { continue };
        if is_asked {
            turn_of.entry(entry.turn).or_insert(number);
        }
        if let Some(turn) = turns.iter_mut().rfind(|turn| turn.number == number) {
            note(turn, entry);
        }
    }
    (turns, turn_of)
}

fn note(turn: &mut Turn, entry: &DialogEntry) {
    match entry.kind.as_str() {
        "Reply" | "Question" => {
            turn.told.1.get_or_insert(entry.sent_nanos);
            let lines = if entry.kind == "Reply" { &mut turn.replies } else { &mut turn.questions };
            lines.push(entry.text.clone());
        }
        "Plan" => turn.plan.extend_from_slice(&entry.steps),
        "PlanEnded" => turn.ended = entry.status,
        "Latency" => {
            for (known, stamp) in turn.stamps.iter_mut().zip(entry.stamps) {
                *known = if stamp == 0 { *known } else { stamp };
            }
        }
        "Spoken" => {
            turn.spoken = entry.stamps;
            turn.heard.clone_from(&entry.text);
        }
        _ => {}
    }
}

/// All commands but those of held keys, which are told anew nine times a second.
fn actions(log: &Log, turn_of: &BTreeMap<u64, u64>) -> Vec<Deed> {
    let outcomes = log.events.iter().filter(|event| event.kind == "Outcome");
    let mut outcomes: BTreeMap<u64, &EventEntry> = outcomes.filter_map(|event| Some((event.command?, event))).collect();
    let inputs = log.ticks.iter().flat_map(|tick| tick.inputs.iter().map(|input| (tick.tick, input)));
    let told = inputs.filter(|(_, input)| !matches!(input.action, Action::Drive { .. }));
    told.map(|(began, input)| {
        let outcome = outcomes.remove(&input.command);
        Deed {
            number: input.command,
            turn: turn_of.get(&input.turn).copied().unwrap_or(input.turn),
            body: input.body,
            action: input.action,
            began,
            outcome: outcome.and_then(|event| Some((event.tick, event.status?, event.text.clone()))),
        }
    })
    .collect()
}

/// A session that goes on from the end of another one of the same participant has what came about there: its log does not tell it again.
fn carry_on(all: &mut [Played]) {
    let mut order: Vec<usize> = (0..all.len()).collect();
    order.sort_by_key(|at| all[*at].log.session.branched.as_ref().map_or(0, |from| from.tick));
    for at in order {
        let session = &all[at].log.session;
        let Some(Branch { run, tick, .. }) = session.branched.clone() else { continue };
        let is_before = |one: &Played| {
            let own = &one.log.session;
            run != 0
                && own.run == run
                && one.ticks() == tick
                && own.participant.is_some()
                && own.participant == session.participant
        };
        let Some(before) = all.iter().position(is_before) else { continue };
        all[before].is_continued = true;
        let mut events = all[before].log.events.clone();
        events.append(&mut all[at].log.events);
        all[at].goals = goals(&all[at].mission, &events);
        all[at].log.events = events;
    }
}

fn goals(mission: &Mission, events: &[EventEntry]) -> Vec<Reached> {
    let reached = |goal: &cohabit_cdf::goal::Goal| {
        let of_goal =
            |kind: &'static str| events.iter().filter(move |event| event.goal == Some(goal.id) && event.kind == kind);
        let (met, resets) = (of_goal("GoalMet").count(), of_goal("GoalReset").count());
        Reached {
            number: goal.id,
            description: goal.description.clone(),
            met: met > resets,
            first_met: of_goal("GoalMet").next().map(|event| event.tick),
            resets,
        }
    };
    mission.goals.iter().map(reached).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn what_nobody_asked_for_is_of_no_turn() {
        let entry = |kind: &str, turn: u64, body: u32, sent_nanos: u64| -> DialogEntry {
            let entry = json!({"kind": kind, "turn": turn, "body": body, "step": 0, "sent_nanos": sent_nanos,
                "stamps": [0, 0, 0, 0, 0], "text": "words"});
            serde_json::from_value(entry).unwrap()
        };
        // A helper speaks of its own accord before the robot that was spoken to answers.
        let dialog = [entry("Utterance", 1, 0, 10), entry("Reply", 0, 2, 20), entry("Reply", 1, 0, 60)];
        let (turns, turn_of) = turns(&dialog);
        assert_eq!((turns[0].told, turns[0].replies.len()), ((10, Some(60)), 1));
        assert_eq!(turn_of, BTreeMap::from([(1, 1)]));
    }
}
