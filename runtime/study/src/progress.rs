//! Where one participant is: a pure state machine, which a journal of its events restores.
//!
//! Information → consent → the steps of their plan → finished; or withdrawn, or excluded. A mission is first ready, then
//! queued until a session is free, then played. Nothing here reads a clock: events come with their time.
//!
//! Of a pair each has a progress of their own, which knows the other one only by what happens: that a session is played together, and
//! that the partner skips, goes alone or leaves.

mod event;

use cohabit_dialog::Given;

pub use event::{Ending, Event};

use crate::{
    plan::{Plan, PlannedMission, Step},
    probe::Probed,
    tutorial::Tried,
};

/// Where a participant is.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    plan: Plan,
    phase: Phase,
    /// What was done so far, a step each.
    done: Vec<Done>,
    /// When the present step began, ms since 1970.
    since_ms: u64,
    /// How long the present mission was played, s.
    played_s: f64,
    /// How often its session was started.
    attempts: u32,
    /// The last of these times at which it was played with their partner; 0 if at none.
    together: u32,
    /// Whether they go on without their partner.
    is_alone: bool,
    /// Why the experimenter excluded them, if they did.
    exclusion: Option<String>,
    /// Whether they agreed to be heard by a microphone.
    agrees_to_audio: bool,
    /// What they have filled in of the present questionnaire so far: no answers yet.
    draft: Vec<Option<Given>>,
    /// How often they have changed it.
    drafts: usize,
    /// What they were asked during the present mission.
    probed: Vec<Probed>,
    /// What they have tried in the present tutorial.
    tried: Vec<Tried>,
}

/// A questionnaire's draft is kept so often: more changes than a person makes, and a bound for a page that runs wild.
const MOST_DRAFTS: usize = 2000;

/// What a participant is about.
#[derive(Clone, Debug, PartialEq)]
pub enum Phase {
    /// Reads what the study is about.
    Information,
    /// Is asked to agree.
    Consent,
    /// Waits for a condition, which is assigned at once.
    Assigning,
    /// Does a step of the plan.
    At(usize, Doing),
    /// Has done all.
    Finished,
    /// Takes no part any more.
    Withdrawn,
    /// Was excluded by the experimenter.
    Excluded,
    /// Has no partner any more, without whom the study does not go on.
    Parted,
}

impl Phase {
    /// Whether they take no part any more, and have not done all.
    #[must_use]
    pub const fn is_out(&self) -> bool {
        matches!(self, Self::Withdrawn | Self::Excluded | Self::Parted)
    }
}

/// How far a step has come.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Doing {
    /// It waits for the participant: a questionnaire, a break, or a mission that can begin.
    Ready,
    /// A mission waits for a session; first in line, if its session had ended too early.
    Queued {
        /// Whether it was played before.
        again: bool,
    },
    /// A mission is played.
    Playing,
}

/// What follows from an event, once it is written down.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Effect {
    /// The session of the present mission is started, for the so-manieth time.
    StartSession {
        /// Which time, from 1.
        attempt: u32,
    },
    /// A condition is assigned.
    Assign,
    /// The session that runs is ended.
    EndSession,
    /// All that is kept of the participant is removed.
    RemoveData,
}

/// A step that was done.
#[derive(Clone, Debug, PartialEq)]
pub struct Done {
    /// Which.
    pub step: usize,
    /// When it began, ms since 1970.
    pub began_ms: u64,
    /// When it ended, ms since 1970.
    pub ended_ms: u64,
    /// Of a mission: how it ended.
    pub ending: Option<Ending>,
    /// Of a mission: how long it was played, s.
    pub played_s: f64,
    /// Of a mission: how often its session was started.
    pub attempts: u32,
    /// Of these, the last one at which it was played with their partner; 0 if none was.
    pub together: u32,
    /// Of a questionnaire: the answers.
    pub answers: Vec<Option<Given>>,
    /// Of a mission: what was asked meanwhile.
    pub probed: Vec<Probed>,
    /// Of a tutorial: what was tried, in order.
    pub tried: Vec<Tried>,
}

/// Why something cannot happen now. Pages tell it in the language of the study; this is how the terminal does.
#[derive(Clone, Copy, Debug, Eq, PartialEq, thiserror::Error)]
pub enum Refused {
    /// It belongs to another place of the study.
    #[error("the study is at another place by now")]
    OutOfTurn,
    /// Who has left the study does nothing in it.
    #[error("who has withdrawn takes no part any more")]
    Withdrawn,
    /// What is filled in was changed too often to be kept.
    #[error("what is filled in is no longer kept before it is sent")]
    TooManyDrafts,
    /// A text is too long to be kept.
    #[error("the text is too long")]
    TooLong,
    /// Not all of a tutorial was tried, and it may not be left yet.
    #[error("there is something left to try")]
    LeftToTry,
    /// A mission was not played for so long that it may be skipped.
    #[error("the mission cannot be skipped yet")]
    NotSkippable,
    /// The partner is waited for, and nothing else may be done instead.
    #[error("the partner is waited for")]
    PartnerAwaited,
}

impl Progress {
    /// Somebody who has just come.
    #[must_use]
    pub fn new(plan: Plan) -> Self {
        Self {
            plan,
            phase: Phase::Information,
            done: Vec::new(),
            since_ms: 0,
            played_s: 0.0,
            attempts: 0,
            together: 0,
            is_alone: false,
            exclusion: None,
            agrees_to_audio: false,
            draft: Vec::new(),
            drafts: 0,
            probed: Vec::new(),
            tried: Vec::new(),
        }
    }

    /// What they do.
    #[must_use]
    pub const fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Where they are.
    #[must_use]
    pub const fn phase(&self) -> &Phase {
        &self.phase
    }

    /// What they have done.
    #[must_use]
    pub fn done(&self) -> &[Done] {
        &self.done
    }

    /// When the present step began, ms since 1970.
    #[must_use]
    pub const fn since_ms(&self) -> u64 {
        self.since_ms
    }

    /// How long the present mission was played, s.
    #[must_use]
    pub const fn played_s(&self) -> f64 {
        self.played_s
    }

    /// How often the session of the present mission was started.
    #[must_use]
    pub const fn attempts(&self) -> u32 {
        self.attempts
    }

    /// Of these times, the last one at which it was played with their partner; 0 if at none.
    #[must_use]
    pub const fn together(&self) -> u32 {
        self.together
    }

    /// Whether they go on without their partner from now on.
    #[must_use]
    pub const fn is_alone(&self) -> bool {
        self.is_alone
    }

    /// Whether they are under way: have agreed, and are not at the end.
    #[must_use]
    pub const fn is_under_way(&self) -> bool {
        matches!(self.phase, Phase::At(..) | Phase::Assigning)
    }

    /// Whether they play a session with their partner, and which step it is.
    #[must_use]
    pub const fn plays_together(&self) -> Option<usize> {
        match self.phase {
            Phase::At(index, Doing::Playing) if self.together == self.attempts && self.together > 0 => Some(index),
            _ => None,
        }
    }

    /// Why the experimenter excluded them, if they did.
    #[must_use]
    pub fn exclusion(&self) -> Option<&str> {
        self.exclusion.as_deref()
    }

    /// Whether they agreed to be heard by a microphone.
    #[must_use]
    pub const fn agrees_to_audio(&self) -> bool {
        self.agrees_to_audio
    }

    /// What stands in each question of the present questionnaire so far; nothing, if they have not begun.
    #[must_use]
    pub fn draft(&self) -> &[Option<Given>] {
        &self.draft
    }

    /// What they were asked during the present mission.
    #[must_use]
    pub fn probed(&self) -> &[Probed] {
        &self.probed
    }

    /// What they have tried in the present tutorial, in order.
    #[must_use]
    pub fn tried(&self) -> &[Tried] {
        &self.tried
    }

    /// Whether they have tried all of the present tutorial; no, if they are at none.
    #[must_use]
    pub fn has_tried_all(&self) -> bool {
        let has_all = |mission: &PlannedMission| mission.is_tutorial() && self.tried.len() >= mission.exercises.len();
        self.mission().is_some_and(|(_, mission, _)| has_all(mission))
    }

    /// The present step.
    #[must_use]
    pub fn step_now(&self) -> Option<(usize, &Step, Doing)> {
        match self.phase {
            Phase::At(index, doing) => Some((index, self.plan.steps.get(index)?, doing)),
            _ => None,
        }
    }

    /// The mission that they are at.
    #[must_use]
    pub fn mission(&self) -> Option<(usize, &PlannedMission, Doing)> {
        match self.step_now()? {
            (index, Step::Mission(mission), doing) => Some((index, mission, doing)),
            _ => None,
        }
    }

    /// Whether anything of theirs may be written down.
    #[must_use]
    pub const fn has_consented(&self) -> bool {
        !matches!(self.phase, Phase::Information | Phase::Consent)
    }

    /// How long until the mission may be skipped, s; `None` if it may not, 0 if it may now.
    #[must_use]
    pub fn skip_in_s(&self) -> Option<f64> {
        let (_, mission, _) = self.mission()?;
        Some((mission.limits.skip_after_s? - self.played_s).max(0.0))
    }

    /// How long the mission may still be played, s.
    #[must_use]
    pub fn left_s(&self) -> Option<f64> {
        let (_, mission, _) = self.mission()?;
        Some((mission.limits.limit_s? - self.played_s).max(0.0))
    }

    /// Takes an event in; gives what follows from it. `at_ms` is its time, ms since 1970.
    ///
    /// # Errors
    /// [`Refused`]; nothing has changed then.
    pub fn step(&mut self, event: &Event, at_ms: u64) -> Result<Vec<Effect>, Refused> {
        match (&self.phase, event) {
            (Phase::Information, Event::Read) => self.phase = Phase::Consent,
            (Phase::Consent, Event::Declined) => self.phase = Phase::Information,
            (Phase::Consent, Event::Consented { audio, .. }) => {
                self.agrees_to_audio = *audio;
                self.begin(0, at_ms);
            }
            (Phase::Withdrawn, _) => return Err(Refused::Withdrawn),
            (_, Event::Withdrew) => {
                let effects = self.end_session();
                self.phase = Phase::Withdrawn;
                return Ok([effects, vec![Effect::RemoveData]].concat());
            }
            (Phase::Assigning, Event::Assigned { plan })
                if plan.place == self.plan.place && plan.steps.starts_with(&self.plan.steps) =>
            {
                let step = self.plan.steps.len();
                self.plan = (**plan).clone();
                self.begin(step, at_ms);
            }
            (Phase::At(..) | Phase::Assigning | Phase::Finished, Event::Excluded { reason }) => {
                let effects = self.end_session();
                self.phase = Phase::Excluded;
                self.exclusion = Some(reason.clone());
                return Ok(effects);
            }
            (Phase::At(..) | Phase::Assigning, Event::PartnerLeft) if !self.is_alone => {
                let effects = self.end_session();
                self.phase = Phase::Parted;
                return Ok(effects);
            }
            (Phase::At(..) | Phase::Assigning, Event::PartnerGoesAlone) if !self.is_alone => self.is_alone = true,
            (Phase::At(index, doing), event) => return self.step_at(*index, *doing, event, at_ms),
            _ => return Err(Refused::OutOfTurn),
        }
        Ok(Vec::new())
    }

    fn step_at(&mut self, index: usize, doing: Doing, event: &Event, at_ms: u64) -> Result<Vec<Effect>, Refused> {
        match (self.plan.steps.get(index), doing, event) {
            (Some(Step::Questionnaire { name, .. }), _, Event::Drafted { questionnaire, answers })
                if name == questionnaire =>
            {
                if self.drafts >= MOST_DRAFTS {
                    return Err(Refused::TooManyDrafts);
                }
                self.drafts += 1;
                self.draft.clone_from(answers);
            }
            (Some(Step::Questionnaire { name, .. }), _, Event::Answered { questionnaire, answers })
                if name == questionnaire =>
            {
                self.complete(index, None, answers.clone(), at_ms);
            }
            (Some(Step::Break { .. }), _, Event::GoesOn) => self.complete(index, None, Vec::new(), at_ms),
            (Some(Step::Mission(_)), Doing::Ready, Event::GoesOn) => {
                self.phase = Phase::At(index, Doing::Queued { again: false });
            }
            (Some(Step::Mission(_)), Doing::Queued { .. }, Event::Started) => {
                self.attempts += 1;
                self.phase = Phase::At(index, Doing::Playing);
                return Ok(vec![Effect::StartSession { attempt: self.attempts }]);
            }
            (Some(Step::Mission(_)), Doing::Queued { .. }, Event::StartedTogether { attempt })
                if *attempt > self.attempts && !self.is_alone =>
            {
                (self.attempts, self.together) = (*attempt, *attempt);
                self.phase = Phase::At(index, Doing::Playing);
                return Ok(vec![Effect::StartSession { attempt: *attempt }]);
            }
            (Some(Step::Mission(_)), Doing::Queued { .. }, Event::GoesAlone) if !self.is_alone => self.is_alone = true,
            (Some(Step::Mission(_)), Doing::Queued { .. }, Event::StopsWaiting) if !self.is_alone => {
                self.phase = Phase::Parted;
            }
            (Some(Step::Mission(_)), Doing::Playing, Event::Played { seconds }) => self.played_s += seconds,
            (Some(Step::Mission(_)), Doing::Playing, Event::Probed { probe }) => {
                if self.probed.iter().any(|one| one.probe == *probe || one.answer.is_none()) {
                    return Err(Refused::OutOfTurn);
                }
                self.probed.push(Probed { probe: *probe, asked_ms: at_ms, answer: None });
            }
            (Some(Step::Mission(_)), Doing::Playing, Event::ProbeAnswered { probe, answer }) => {
                let is_open = |one: &&mut Probed| one.probe == *probe && one.answer.is_none();
                let open = self.probed.iter_mut().find(is_open).ok_or(Refused::OutOfTurn)?;
                open.answer = Some((at_ms, answer.clone()));
            }
            (Some(Step::Mission(mission)), Doing::Playing, Event::Tried { exercise }) => {
                let is_new = !self.tried.iter().any(|one| one.exercise == *exercise);
                if *exercise >= mission.exercises.len() || !is_new {
                    return Err(Refused::OutOfTurn);
                }
                self.tried.push(Tried { exercise: *exercise, at_ms });
            }
            (Some(Step::Mission(mission)), Doing::Playing, Event::GoesOn) if mission.is_tutorial() => {
                return self.leave_tutorial(index, at_ms);
            }
            (Some(Step::Mission(_)), Doing::Playing, Event::Interrupted { .. }) => {
                self.phase = Phase::At(index, Doing::Queued { again: true });
                return Ok(vec![Effect::EndSession]);
            }
            (Some(Step::Mission(_)), Doing::Playing, Event::Over { ending }) => {
                return self.over(index, *ending, at_ms);
            }
            (Some(Step::Mission(_)), Doing::Playing, Event::PartnerSkipped) if self.plays_together().is_some() => {
                self.complete(index, Some(Ending::Skipped), Vec::new(), at_ms);
                return Ok(vec![Effect::EndSession]);
            }
            // The experimenter may end what has not begun.
            (Some(Step::Mission(_)), _, Event::Over { ending: Ending::Stopped }) => {
                self.complete(index, Some(Ending::Stopped), Vec::new(), at_ms);
            }
            _ => return Err(Refused::OutOfTurn),
        }
        Ok(if self.phase == Phase::Assigning { vec![Effect::Assign] } else { Vec::new() })
    }

    fn leave_tutorial(&mut self, index: usize, at_ms: u64) -> Result<Vec<Effect>, Refused> {
        let ending = if self.has_tried_all() { Ending::Complete } else { Ending::Skipped };
        if ending == Ending::Skipped && self.skip_in_s() != Some(0.0) {
            return Err(Refused::LeftToTry);
        }
        self.complete(index, Some(ending), Vec::new(), at_ms);
        Ok(vec![Effect::EndSession])
    }

    fn over(&mut self, index: usize, ending: Ending, at_ms: u64) -> Result<Vec<Effect>, Refused> {
        if ending == Ending::Skipped && self.skip_in_s() != Some(0.0) {
            return Err(Refused::NotSkippable);
        }
        self.complete(index, Some(ending), Vec::new(), at_ms);
        Ok(vec![Effect::EndSession])
    }

    fn end_session(&self) -> Vec<Effect> {
        if matches!(self.phase, Phase::At(_, Doing::Playing)) { vec![Effect::EndSession] } else { Vec::new() }
    }

    fn complete(&mut self, step: usize, ending: Option<Ending>, answers: Vec<Option<Given>>, at_ms: u64) {
        let (played_s, attempts, together) = (self.played_s, self.attempts, self.together);
        let (probed, tried) = (std::mem::take(&mut self.probed), std::mem::take(&mut self.tried));
        let (began_ms, ended_ms) = (self.since_ms, at_ms);
        let done = Done { step, began_ms, ended_ms, ending, played_s, attempts, together, answers, probed, tried };
        self.done.push(done);
        self.begin(step + 1, at_ms);
    }

    fn begin(&mut self, step: usize, at_ms: u64) {
        (self.since_ms, self.played_s, self.attempts, self.together) = (at_ms, 0.0, 0, 0);
        (self.draft, self.drafts) = (Vec::new(), 0);
        self.phase = match self.plan.awaits_assignment {
            _ if step < self.plan.steps.len() => Phase::At(step, Doing::Ready),
            true => Phase::Assigning,
            false => Phase::Finished,
        };
    }
}

#[cfg(test)]
mod tests;
