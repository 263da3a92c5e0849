//! What a page was told in a recorded session, from its log.

use std::collections::BTreeSet;

use cohabit_bus::message::{DialogKind, EventKind};
use cohabit_cdf::ObjectId;
use cohabit_record::{DialogEntry, EventEntry, Log};
use serde_json::{Value, json};

use crate::{
    expression::FacialExpression,
    latency::Moments,
    page::{self, Answer, Line, LineKind, Speaker},
};

/// What several robots are told at once is told to the last of them within this time of the first; nobody says the same to another one so
/// soon.
const AT_ONCE_NANOS: u64 = 2_000_000_000;

/// Something that pages were told.
#[derive(Clone, Debug, PartialEq)]
pub enum Told {
    /// A line of chat.
    Line(Line),
    /// Something that is not kept.
    Page(Value),
    /// What the face of a body's robot shows from then on.
    Face(u32, FacialExpression),
    /// An object was pointed out.
    Highlight(u32),
    /// An object could be heard: which, and what kind of sound.
    Sound(u32, String),
}

/// All that pages were told, in order, each with its tick; and of `several` robots by which.
pub fn told(log: &Log, several: bool) -> Vec<(u64, Told)> {
    let people: BTreeSet<u32> = log.dialog.iter().map(|entry| entry.person).filter(|person| *person != 0).collect();
    let names = Names { robots: several, people: people.len() > 1 };
    let mut saying = Saying::default();
    let is_shown =
        |entry: &&DialogEntry| kind(&entry.kind) != Some(DialogKind::Utterance) || !saying.is_repeated_by(entry);
    let said = log.dialog.iter().filter(is_shown).filter_map(|entry| Some((entry.tick, said(entry, names)?)));
    let happened = log.events.iter().filter_map(|entry| Some((entry.tick, happened(entry)?)));
    let mut told: Vec<_> = said.chain(happened).collect();
    told.sort_by_key(|(tick, _)| *tick);
    told
}

/// What somebody said last, and to which robots.
#[derive(Default)]
struct Saying {
    person: u32,
    text: String,
    sent_nanos: u64,
    bodies: BTreeSet<u32>,
}

impl Saying {
    /// Takes in what is said next. Whether it is the same once more, for another robot that was spoken to at once: pages showed it once.
    fn is_repeated_by(&mut self, entry: &DialogEntry) -> bool {
        let is_at_once = entry.sent_nanos.saturating_sub(self.sent_nanos) < AT_ONCE_NANOS;
        let is_same = is_at_once && self.person == entry.person && self.text == entry.text;
        if is_same && self.bodies.insert(entry.body) {
            return true;
        }
        let DialogEntry { person, sent_nanos, body, .. } = *entry;
        *self = Self { person, text: entry.text.clone(), sent_nanos, bodies: BTreeSet::from([body]) };
        false
    }
}

/// Who is to be told apart.
#[derive(Clone, Copy)]
struct Names {
    robots: bool,
    people: bool,
}

fn said(entry: &DialogEntry, names: Names) -> Option<Told> {
    let body = names.robots.then_some(entry.body);
    let visitor = (names.people && entry.person != 0).then_some(entry.person);
    let answers =
        || entry.offers.iter().map(|offer| Answer { text: offer.text.clone(), object: offer.object }).collect();
    let line = |from, kind| {
        let line = Line::new(from, kind, entry.turn, entry.text.as_str());
        Some(Told::Line(Line { body, visitor, answers: answers(), ..line }))
    };
    match kind(&entry.kind)? {
        DialogKind::Utterance => line(Speaker::Person, LineKind::Say),
        DialogKind::Reply => line(Speaker::Robot, LineKind::Say),
        DialogKind::Question => line(Speaker::Robot, LineKind::Question),
        DialogKind::Expressed => FacialExpression::of(&entry.text).map(|shown| Told::Face(entry.body, shown)),
        DialogKind::Latency => {
            let [received, understood, moved, shown, drawn] = entry.stamps;
            let moments = Moments { turn: entry.turn, received, understood, moved, shown, drawn, ..Moments::default() };
            Some(Told::Page(page::latency(&moments, None)))
        }
        DialogKind::Plan
        | DialogKind::StepStarted
        | DialogKind::StepEnded
        | DialogKind::PlanEnded
        | DialogKind::Spoken
        | DialogKind::Interpreted
        | DialogKind::Decided
        | DialogKind::Pointed
        | DialogKind::Seat => None,
    }
}

fn happened(entry: &EventEntry) -> Option<Told> {
    let line = |kind, text: String| (!text.is_empty()).then(|| Told::Line(Line::new(Speaker::Game, kind, 0, text)));
    let text = || entry.text.clone();
    match event_kind(&entry.kind)? {
        EventKind::GoalMet => line(LineKind::Goal, text()),
        EventKind::NoteRead => line(LineKind::Note, text()),
        EventKind::Message | EventKind::CameraMovement => line(LineKind::Say, text()),
        EventKind::GoalShown => line(LineKind::Goal, page::new_goal(&entry.text)),
        EventKind::MissionComplete => line(LineKind::Ending, page::COMPLETE.to_owned()),
        EventKind::MissionFailed => line(LineKind::Ending, page::failed(&entry.text)),
        EventKind::Highlighted => entry.object.map(Told::Highlight),
        EventKind::Sound => entry.object.map(|object| Told::Sound(object, text())),
        _ => None,
    }
}

/// The objects that are numbered after these lines: those that the last question offers, if nothing was said since.
pub fn numbered<'a>(lines: impl DoubleEndedIterator<Item = &'a Line>) -> Vec<ObjectId> {
    let newest = lines.rev().find(|line| line.from != Speaker::Game);
    let objects: Vec<_> = newest.iter().flat_map(|line| &line.answers).filter_map(|answer| answer.object).collect();
    objects.into_iter().map(ObjectId).filter(|_| newest.is_some_and(|line| line.answers.len() > 1)).collect()
}

/// A log has kinds by name.
fn kind(name: &str) -> Option<DialogKind> {
    DialogKind::ALL.into_iter().find(|kind| format!("{kind:?}") == name)
}

fn event_kind(name: &str) -> Option<EventKind> {
    EventKind::ALL.into_iter().find(|kind| format!("{kind:?}") == name)
}

/// What a time bar marks: sentences of people, goals and how it ended.
pub fn marks(told: &[(u64, Told)]) -> Vec<Value> {
    let marked = told.iter().filter_map(|(tick, told)| {
        let Told::Line(line) = told else { return None };
        let kind = match (line.from, line.kind) {
            (Speaker::Person, _) => "said",
            (Speaker::Game, LineKind::Goal) => "goal",
            (Speaker::Game, LineKind::Ending) => "ending",
            _ => return None,
        };
        Some(json!({ "tick": tick, "kind": kind, "text": line.text }))
    });
    marked.collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use cohabit_bus::{
        Envelope,
        message::{DialogMessage, DialogView, EventMessage},
    };
    use cohabit_record::{SessionEntry, SessionFacts};

    use super::*;

    fn spoken(tick: u64, kind: DialogKind, text: &str) -> DialogEntry {
        let message = DialogMessage::new(kind, 0, 1, text);
        DialogEntry::new(tick, &Envelope::default(), DialogView { header: &message.header, steps: &[] }).unwrap()
    }

    fn log(dialog: Vec<DialogEntry>, events: Vec<EventEntry>) -> Log {
        let session = SessionEntry::new(&SessionFacts::named("s"), &cohabit_bus::message::MissionMessage::default());
        Log {
            session,
            ticks: Vec::new(),
            events,
            dialog,
            answers: Vec::new(),
            snapshots: Vec::new(),
            gaps: Vec::new(),
            lost: Vec::new(),
            cut: None,
        }
    }

    #[test]
    fn what_was_said_to_several_robots_at_once_is_told_once() {
        let to = |body: u32, second: u64| DialogEntry {
            body,
            sent_nanos: second * 1_000_000_000,
            ..spoken(60 * second, DialogKind::Utterance, "stop")
        };
        let between = spoken(60, DialogKind::Reply, "OK, I stop.");
        // To both, to both again, and later to the second one alone.
        let log = log(vec![to(0, 1), between, to(1, 1), to(0, 2), to(1, 2), to(1, 9)], Vec::new());
        let told = told(&log, true);
        let lines = told.iter().filter_map(|(tick, told)| match told {
            Told::Line(line) if line.from == Speaker::Person => Some((*tick, line.body)),
            _ => None,
        });
        assert_eq!(lines.collect::<Vec<_>>(), [(60, Some(0)), (120, Some(0)), (540, Some(1))]);
    }

    #[test]
    fn the_chat_is_told_as_it_was() {
        let goal = EventMessage::new(EventKind::GoalMet).saying("A goal");
        let goal = EventEntry::new(&Envelope { tick: 20, ..Envelope::default() }, &goal).unwrap();
        let dialog = vec![
            spoken(10, DialogKind::Utterance, "open the fridge"),
            spoken(10, DialogKind::Plan, ""),
            spoken(30, DialogKind::Reply, "Done."),
        ];
        let log = log(dialog, vec![goal]);
        let told = told(&log, false);
        let expected = [
            (10, Line::new(Speaker::Person, LineKind::Say, 1, "open the fridge")),
            (20, Line::new(Speaker::Game, LineKind::Goal, 0, "A goal")),
            (30, Line::new(Speaker::Robot, LineKind::Say, 1, "Done.")),
        ];
        assert_eq!(told, expected.map(|(tick, line)| (tick, Told::Line(line))));
        let marked: Vec<_> = marks(&told).iter().map(|mark| mark["kind"].as_str().unwrap().to_owned()).collect();
        assert_eq!(marked, ["said", "goal"]);
    }
}
