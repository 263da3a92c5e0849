//! The log of a session that a simulated person played, as the study keeps it: marked as synthetic, with the times that it would have
//! had, and cut off where they left.

use std::{collections::BTreeMap, path::Path};

use cohabit_engine::replay::TICK_S;
use cohabit_record::{
    DecisionOutcome, DialogEntry, EventEntry, Log, LogError, LogWriter, SessionEntry, TickEntry, WizardDecision,
};
use cohabit_study::{Ending, Happening, SimulatedSession};

/// The name under which a log notes that nobody took part.
const SYNTHETIC: &str = "synthetic";
const NANOS: f64 = 1e9;

/// A session as it was played in no time of anybody's.
pub struct SyntheticLog {
    log: Log,
    /// At which ticks something was said.
    said: Vec<u64>,
    pace: Pace,
    /// What would come after that is cut off, s.
    ends_by_s: f64,
}

/// How time goes by in it.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    /// From one line to its answer, beside what the world takes: how long the person takes for it, and how long it is held back, s.
    pub line_s: f64,
    /// How many times as fast as real time the world goes.
    pub speed: f64,
}

/// What the study's log notes of it.
pub struct Facts {
    pub session: String,
    pub participant: String,
    pub mission_file: String,
    pub settings: BTreeMap<String, String>,
    /// Whether a wizard takes part: then each answer counts as a proposal that was accepted.
    pub has_wizard: bool,
    /// How many people speak in turn, at a page each; 0 if one does, of whom no page is noted.
    pub people: u32,
    /// When it began, ms since 1970.
    pub began_ms: u64,
}

impl SyntheticLog {
    /// That of a session in which time goes by so.
    pub fn new(log: Log, pace: Pace, ends_by_s: Option<f64>) -> Self {
        let said = log.dialog.iter().filter(|entry| entry.kind == "Utterance").map(|entry| entry.tick).collect();
        Self { log, said, pace, ends_by_s: ends_by_s.unwrap_or(f64::INFINITY) }
    }

    /// When something is, s, to the millisecond: what the world took, and what the person took for all that was said so far.
    fn time_s(&self, tick: u64) -> f64 {
        let lines = self.said.partition_point(|at| *at <= tick);
        let time_s = tick as f64 * TICK_S / self.pace.speed + lines as f64 * self.pace.line_s;
        (time_s * 1000.0).round() / 1000.0
    }

    fn is_kept(&self, tick: u64) -> bool {
        self.time_s(tick) <= self.ends_by_s
    }

    /// What came of it.
    pub fn session(&self) -> SimulatedSession {
        let last = self.log.ticks.iter().map(|entry| entry.tick).rfind(|tick| self.is_kept(*tick)).unwrap_or(0);
        let events = self.log.events.iter().filter(|event| self.is_kept(event.tick));
        let end = events.clone().find_map(|event| {
            let ending = match event.kind.as_str() {
                "MissionComplete" => Ending::Complete,
                "MissionFailed" => Ending::Failed,
                _ => return None,
            };
            Some((self.time_s(event.tick), ending))
        });
        let asked = self.log.dialog.iter().filter(|entry| entry.kind == "Question" && self.is_kept(entry.tick));
        let asked = asked.map(|entry| (self.time_s(entry.tick), Happening::QuestionAsked));
        let mut happened: Vec<_> =
            events.filter_map(|event| Some((self.time_s(event.tick), happening(event)?))).chain(asked).collect();
        happened.sort_by(|(one, _), (other, _)| one.total_cmp(other));
        let cut = self.time_s(self.log.ticks.last().map_or(0, |entry| entry.tick)) > self.ends_by_s;
        let played_s = match end {
            Some((at, _)) => at,
            None if cut => self.ends_by_s,
            None => self.time_s(last),
        };
        SimulatedSession { played_s, ending: end.map(|(_, ending)| ending), happened }
    }

    /// Writes it as the study keeps it.
    ///
    /// # Errors
    /// [`LogError`].
    pub fn write(&self, path: &Path, facts: Facts) -> Result<(), LogError> {
        let Facts { session, participant, mission_file, mut settings, has_wizard, people, began_ms } = facts;
        let mut turns = Turns::new(people);
        settings.insert(SYNTHETIC.to_owned(), true.to_string());
        let entry = SessionEntry {
            session,
            mission_file,
            settings,
            participant: Some(participant),
            ..self.log.session.clone()
        };
        let began_nanos = began_ms * 1_000_000;
        let nanos = |tick: u64| (self.time_s(tick) * NANOS) as u64;
        let mut out = LogWriter::create(path, &entry, began_nanos)?;
        let mut events = self.log.events.iter().peekable();
        let mut dialog = self.log.dialog.iter().peekable();
        // What was said before the first tick stands before it.
        for tick in std::iter::once(None).chain(self.log.ticks.iter().map(Some)) {
            let number = tick.map_or(0, |entry| entry.tick);
            if !self.is_kept(number) {
                break;
            }
            let at = nanos(number);
            if let Some(entry) = tick {
                out.tick(&TickEntry { wall_nanos: began_nanos + at, ..entry.clone() })?;
            }
            while let Some(event) = events.next_if(|event: &&EventEntry| event.tick <= number) {
                out.event(event, began_nanos + at)?;
            }
            while let Some(entry) = dialog.next_if(|entry: &&DialogEntry| entry.tick <= number) {
                let person = turns.person(&entry.kind).unwrap_or(entry.person);
                let entry = DialogEntry { sent_nanos: at, person, ..entry.clone() };
                out.dialog(&entry, began_nanos + at)?;
                if has_wizard && entry.kind == "Utterance" {
                    out.dialog(&accepted(&entry), began_nanos + at)?;
                }
            }
        }
        out.finish()
    }
}

/// Whose turn it is to speak: one asks after the other, and whoever asked answers what the robot asks.
struct Turns {
    people: u32,
    /// How many things were asked for so far.
    asked: u32,
    /// Whether the robot waits for an answer.
    is_questioned: bool,
}

impl Turns {
    const fn new(people: u32) -> Self {
        Self { people, asked: 0, is_questioned: false }
    }

    /// The number of the page at which the next message of that kind is said, if it is said at one of several.
    fn person(&mut self, kind: &str) -> Option<u32> {
        match kind {
            "Question" => self.is_questioned = true,
            "Reply" => self.is_questioned = false,
            "Utterance" if self.people > 0 => {
                if !std::mem::take(&mut self.is_questioned) || self.asked == 0 {
                    self.asked += 1;
                }
                return Some((self.asked - 1) % self.people + 1);
            }
            _ => {}
        }
        None
    }
}

/// That what the robot made of what somebody said counts as accepted by a wizard.
fn accepted(said: &DialogEntry) -> DialogEntry {
    let decision = WizardDecision {
        said: said.text.clone(),
        synthetic: true,
        ..WizardDecision::of_outcome(DecisionOutcome::Accepted)
    };
    DialogEntry { kind: WizardDecision::KIND.to_owned(), text: decision.text(), ..said.clone() }
}

/// What probes are asked at.
fn happening(event: &EventEntry) -> Option<Happening> {
    let is_asked_for = event.turn.is_some_and(|turn| turn > 0);
    match event.kind.as_str() {
        "GoalMet" => Some(Happening::GoalMet),
        "Outcome" if is_asked_for && event.status.is_some_and(cohabit_cdf::Status::is_failure) => {
            Some(Happening::ActionFailed)
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_asked_for_something_answers_what_the_robot_asks_about_it() {
        let mut turns = Turns::new(2);
        let said = ["Utterance", "Question", "Utterance", "Reply", "Utterance", "Question", "Utterance", "Utterance"];
        let people: Vec<u32> = said.into_iter().filter_map(|kind| turns.person(kind)).collect();
        assert_eq!(people, [1, 1, 2, 2, 1]);
        assert_eq!(Turns::new(0).person("Utterance"), None);
    }
}
