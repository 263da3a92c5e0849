//! One simulated person's way through a study: everything that happens to them, with its time. Nothing is written down here.

use std::path::PathBuf;

use crate::{
    design::{Limits, Study},
    folder::Folder,
    plan::{Plan, PlannedMission, Step, pseudonym},
    probe::{self, Happening},
    progress::{Ending, Event, Progress},
    session::{Whose, name_of_try},
    settings::Settings,
    simulate::{
        SimulateError,
        people::Speaking,
        person::{Leaves, Person},
    },
    tutorial::{Activity, Exercise},
};

/// So long somebody sees the end of a mission.
const ENDING_SEEN_S: f64 = 4.0;
/// So long somebody rests, if nothing says how long.
const REST_S: f64 = 30.0;
/// So long somebody takes to notice that they are stuck, and to find the button that skips.
const GIVES_UP_AFTER_S: f64 = 10.0;

/// A mission that a simulated person plays.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulatedMission {
    /// What its session is called.
    pub name: String,
    /// What the participant is called; in a study of pairs, what the pair is.
    pub participant: String,
    /// The mission, as the study names it.
    pub mission: String,
    /// The settings of its session.
    pub settings: Settings,
    /// The seed of its world, and of who speaks in it.
    pub seeds: [u64; 2],
    /// How they speak, with the time that this person takes for a line.
    pub speaking: Speaking,
    /// The seed of how their partner speaks, if two people play it; they speak in turn, about one goal after the other.
    pub partner: Option<u64>,
    /// Whether they speak aloud, as those do who agreed to be heard, rather than write.
    pub is_heard: bool,
    /// Whether they give it up halfway.
    pub gives_up: bool,
    /// The longest that it is played, s: what would come after that is cut off.
    pub ends_by_s: Option<f64>,
    /// When it begins, ms since 1970.
    pub began_ms: u64,
    /// Where it is recorded.
    pub log: PathBuf,
}

/// What came of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SimulatedSession {
    /// For how long it was played, s.
    pub played_s: f64,
    /// How it ended, if it did before the person gave up.
    pub ending: Option<Ending>,
    /// What happened, and after how long, s; in order.
    pub happened: Vec<(f64, Happening)>,
}

/// Plays missions with simulated people.
pub trait SimulatedPlayer: Sync {
    /// Plays one, as fast as it can; the same one comes out the same. Its log has the times that it would have.
    ///
    /// # Errors
    /// Why it cannot be played.
    fn play(&self, wanted: &SimulatedMission) -> Result<SimulatedSession, String>;
}

/// What everybody's way has in common.
pub(super) struct Setting<'a> {
    pub study: &'a Study,
    pub speaking: &'a Speaking,
    pub logs: &'a Folder,
    pub player: &'a dyn SimulatedPlayer,
}

impl Setting<'_> {
    /// What comes of a session.
    pub fn play(&self, wanted: &SimulatedMission) -> Result<SimulatedSession, SimulateError> {
        let failed = |reason| SimulateError::Session { session: wanted.name.clone(), reason };
        self.player.play(wanted).map_err(failed)
    }
}

/// What happens to one person.
pub(super) struct Walk<'a> {
    setting: &'a Setting<'a>,
    person: &'a Person<'a>,
    pub(super) progress: Progress,
    /// The time that they have come to, ms since 1970.
    pub(super) at_ms: u64,
    events: Vec<(u64, Event)>,
}

impl<'a> Walk<'a> {
    /// The way of somebody from where they are.
    pub fn new(setting: &'a Setting<'a>, person: &'a Person<'a>, progress: Progress) -> Self {
        let at_ms = progress.since_ms();
        Self { setting, person, progress, at_ms, events: Vec::new() }
    }

    /// Goes on to the end, or until they leave, or until a condition has to be assigned.
    pub fn run(mut self) -> Result<Vec<(u64, Event)>, SimulateError> {
        self.go_on(false)?;
        Ok(self.events)
    }

    /// What has happened to them.
    pub fn into_events(self) -> Vec<(u64, Event)> {
        self.events
    }

    /// Goes on so far; if missions wait for a partner, to the next one. Whether there is one.
    pub(super) fn go_on(&mut self, waits: bool) -> Result<bool, SimulateError> {
        let steps = self.progress.plan().steps.len();
        while let Some((index, step, _)) = self.progress.step_now() {
            let step = step.clone();
            match self.person.leaves_at(index, steps).filter(|_| !self.progress.plan().awaits_assignment) {
                Some(Leaves::Stops) => return Ok(false),
                Some(Leaves::Withdraws) => self.happens(Event::Withdrew)?,
                Some(Leaves::IsExcluded) => self.happens(Event::Excluded { reason: "as simulated".to_owned() })?,
                None if waits && matches!(step, Step::Mission(_)) => return Ok(true),
                None => self.step(index, &step)?,
            }
        }
        Ok(false)
    }

    pub(super) fn happens(&mut self, event: Event) -> Result<(), SimulateError> {
        let participant = pseudonym(self.progress.plan().place);
        let refused = |refused| SimulateError::Refused { participant, event: format!("{event:?}"), refused };
        self.progress.step(&event, self.at_ms).map_err(refused)?;
        self.events.push((self.at_ms, event));
        Ok(())
    }

    pub(super) fn passes(&mut self, seconds: f64) {
        self.at_ms += (seconds * 1000.0).round() as u64;
    }

    fn step(&mut self, index: usize, step: &Step) -> Result<(), SimulateError> {
        match step {
            Step::Questionnaire { name, .. } => self.questionnaire(index, name),
            Step::Break { limit_s, .. } => {
                self.passes(limit_s.map_or(REST_S, |limit| limit.min(REST_S)));
                self.happens(Event::GoesOn)
            }
            Step::Mission(_) => {
                self.gets_ready()?;
                self.plays_alone(index)
            }
        }
    }

    fn questionnaire(&mut self, index: usize, name: &str) -> Result<(), SimulateError> {
        let under = self.progress.plan().choices(index);
        let answers = self.person.answers(self.setting.study, name, index, &under);
        self.passes(self.person.answering_s(answers.len()));
        self.happens(Event::Answered { questionnaire: name.to_owned(), answers })
    }

    /// They read what is said before a mission, and want to begin.
    pub(super) fn gets_ready(&mut self) -> Result<(), SimulateError> {
        self.passes(self.person.answering_s(1));
        self.happens(Event::GoesOn)
    }

    /// They play the mission of a step, for which they wait, in a session of their own.
    pub(super) fn plays_alone(&mut self, index: usize) -> Result<(), SimulateError> {
        self.happens(Event::Started)?;
        let Some(wanted) = self.wanted(index) else { return Ok(()) };
        let session = self.setting.play(&wanted)?;
        self.lives_through(index, &session)
    }

    /// What comes of a session for them.
    pub(super) fn lives_through(&mut self, index: usize, session: &SimulatedSession) -> Result<(), SimulateError> {
        let Some(Step::Mission(mission)) = self.progress.plan().steps.get(index).cloned() else { return Ok(()) };
        if mission.is_tutorial() {
            return self.tutorial(index, &mission, session);
        }
        let (ending, played_s) = ending(session, mission.limits);
        self.probes(index, &mission, session, (ending, played_s))?;
        let left_s = played_s - self.progress.played_s();
        self.plays(left_s)?;
        self.passes(if matches!(ending, Ending::Complete | Ending::Failed) { ENDING_SEEN_S } else { 0.0 });
        self.happens(Event::Over { ending })
    }

    /// They try one thing after the other, and go on as soon as they may.
    fn tutorial(
        &mut self,
        index: usize,
        mission: &PlannedMission,
        session: &SimulatedSession,
    ) -> Result<(), SimulateError> {
        let Limits { limit_s, skip_after_s } = mission.limits;
        let failed_s = session.ending.filter(|ending| *ending == Ending::Failed).map(|_| session.played_s);
        let ends_s = failed_s.into_iter().chain(limit_s).fold(f64::INFINITY, f64::min);
        let count = if self.person.gives_up(index) { mission.exercises.len() / 2 } else { mission.exercises.len() };
        let tries = tries(&mission.exercises, session, self.person.line_s());
        for (at_s, exercise) in tries.into_iter().take(count).filter(|(at_s, _)| *at_s < ends_s) {
            self.plays(at_s - self.progress.played_s())?;
            self.happens(Event::Tried { exercise })?;
        }
        if self.progress.has_tried_all() {
            return self.happens(Event::GoesOn);
        }
        let skips_s = skip_after_s.map(|skip| skip.max(self.progress.played_s()) + GIVES_UP_AFTER_S);
        if let Some(skips_s) = skips_s.filter(|skips_s| *skips_s < ends_s) {
            self.plays(skips_s - self.progress.played_s())?;
            return self.happens(Event::GoesOn);
        }
        let ending = match (failed_s, limit_s) {
            (Some(failed), limit) if limit.is_none_or(|limit| failed < limit) => Ending::Failed,
            (_, Some(_)) => Ending::TimeUp,
            _ => Ending::Stopped,
        };
        if ends_s.is_finite() {
            self.plays(ends_s - self.progress.played_s())?;
        }
        self.happens(Event::Over { ending })
    }

    /// The session in which they play the mission of a step; their first one of it.
    pub(super) fn wanted(&self, index: usize) -> Option<SimulatedMission> {
        let Setting { study, speaking, logs, .. } = self.setting;
        let Plan { place, .. } = *self.progress.plan();
        let Some(Step::Mission(mission)) = self.progress.plan().steps.get(index) else { return None };
        let name = name_of_try(place, index, 1, self.progress.together());
        Some(SimulatedMission {
            participant: Whose::of(study, place).label(),
            mission: mission.mission.clone(),
            settings: mission.settings.clone(),
            seeds: [study.seed, self.person.speaker(index)],
            speaking: Speaking { line_s: self.person.line_s(), ..(*speaking).clone() },
            partner: None,
            is_heard: self.progress.agrees_to_audio(),
            gives_up: self.person.gives_up(index),
            ends_by_s: mission.limits.limit_s,
            began_ms: self.at_ms,
            log: logs.log_path(&name),
            name,
        })
    }

    /// They play on for so long.
    fn plays(&mut self, seconds: f64) -> Result<(), SimulateError> {
        if seconds <= 0.0 {
            return Ok(());
        }
        self.passes(seconds);
        self.happens(Event::Played { seconds })
    }

    /// They are asked what is due, when it is, and answer at once.
    fn probes(
        &mut self,
        index: usize,
        mission: &PlannedMission,
        session: &SimulatedSession,
        (ending, played_s): (Ending, f64),
    ) -> Result<(), SimulateError> {
        let study = self.setting.study;
        if mission.is_practice || study.probes.is_empty() {
            return Ok(());
        }
        let clocks = study.probes.iter().filter_map(|probe| probe.at.played_s()).map(|at| (at, None));
        let happenings = session.happened.iter().map(|(at, what)| (*at, Some(*what)));
        // The goal that completes a mission is met at its very end.
        let is_last = |at: f64, what: Option<Happening>| {
            ending == Ending::Complete && what == Some(Happening::GoalMet) && at <= played_s
        };
        let is_within = |(at, what): &(f64, Option<Happening>)| *at < played_s || is_last(*at, *what);
        let mut moments: Vec<_> = clocks.chain(happenings).filter(is_within).collect();
        moments.sort_by(|(one, _), (other, _)| one.total_cmp(other));
        for (at_s, what) in moments {
            let happened: Vec<Happening> = what.into_iter().collect();
            let Some(probe) = probe::due(&study.probes, self.progress.probed(), &happened, at_s) else { continue };
            self.plays(at_s - self.progress.played_s())?;
            self.happens(Event::Probed { probe })?;
            let name = &study.probes[probe].questionnaire;
            // Another draw than that of the mission itself, and of the other probes.
            let draws = (index + 1) << 8 | probe;
            let answers = self.person.answers(study, name, draws, &self.progress.plan().choices(index));
            self.happens(Event::ProbeAnswered { probe, answer: answers.into_iter().next().flatten() })?;
        }
        Ok(())
    }
}

/// When somebody tries which exercise, s, in order: one a line, but a goal once the session met one, which may be never.
fn tries(exercises: &[Exercise], session: &SimulatedSession, line_s: f64) -> Vec<(f64, usize)> {
    let met = session.happened.iter().find(|(_, what)| *what == Happening::GoalMet).map(|(at_s, _)| *at_s);
    let when = |(number, exercise): (usize, &Exercise)| match exercise.what {
        Activity::Goal => Some((met?, number)),
        _ => Some(((number + 1) as f64 * line_s, number)),
    };
    let mut all: Vec<(f64, usize)> = exercises.iter().enumerate().filter_map(when).collect();
    all.sort_by(|(one, _), (other, _)| one.total_cmp(other));
    all
}

/// How a mission ends, and for how long it was played, s.
fn ending(session: &SimulatedSession, limits: Limits) -> (Ending, f64) {
    let within = |at: f64| limits.limit_s.is_none_or(|limit| at < limit);
    if let Some(ending) = session.ending.filter(|_| within(session.played_s)) {
        return (ending, session.played_s);
    }
    let given_up = session.played_s + GIVES_UP_AFTER_S;
    match (limits.skip_after_s.map(|skip| skip.max(given_up)), limits.limit_s) {
        (Some(skipped), _) if within(skipped) => (Ending::Skipped, skipped),
        (_, Some(limit)) => (Ending::TimeUp, limit),
        _ => (Ending::Stopped, given_up),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exercises_are_tried_one_a_line_and_a_goal_when_it_is_met() {
        let exercise = |what| Exercise { what, text: String::new() };
        let exercises = [Activity::Goal, Activity::Say, Activity::Stop].map(exercise);
        let session = |happened| SimulatedSession { played_s: 90.0, ending: None, happened };
        let met = session(vec![(5.0, Happening::QuestionAsked), (25.0, Happening::GoalMet)]);
        assert_eq!(tries(&exercises, &met, 10.0), [(20.0, 1), (25.0, 0), (30.0, 2)]);
        assert_eq!(tries(&exercises, &session(Vec::new()), 10.0), [(20.0, 1), (30.0, 2)]);
    }

    #[test]
    fn missions_end_as_they_would_for_people() {
        let session = |played_s: f64, ending| SimulatedSession { played_s, ending, happened: Vec::new() };
        let done = Some(Ending::Complete);
        for (session, limit_s, skip_after_s, expected) in [
            (session(50.0, done), Some(60.0), Some(20.0), (Ending::Complete, 50.0)),
            (session(60.0, done), Some(60.0), None, (Ending::TimeUp, 60.0)),
            (session(15.0, None), Some(60.0), Some(20.0), (Ending::Skipped, 25.0)),
            (session(5.0, None), Some(60.0), Some(20.0), (Ending::Skipped, 20.0)),
            (session(55.0, None), Some(60.0), Some(20.0), (Ending::TimeUp, 60.0)),
            (session(15.0, None), Some(60.0), None, (Ending::TimeUp, 60.0)),
            (session(15.0, None), None, None, (Ending::Stopped, 25.0)),
        ] {
            let limits = Limits { limit_s, skip_after_s };
            assert_eq!(ending(&session, limits), expected, "{session:?} {limits:?}");
        }
    }
}
