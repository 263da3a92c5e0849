//! Looks after sessions: starts those that are due, ends those that are over, starts dead ones again, and keeps the tables.

use std::{
    path::PathBuf,
    sync::{
        Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use crate::{
    design::StudyWorld,
    pair::partner_of,
    plan::{PlannedMission, Step, pseudonym},
    probe::{self, Happening},
    progress::{Doing, Ending, Event, Phase, Progress},
    registry::{Live, Participant, Registry, StudyFault},
    session::{Look, Player, Wanted, Whose, name_of_try},
    settings::session_arguments,
    shared, tables,
    tutorial::{self, Activity},
};

/// How often everything is looked at.
const LOOK_EVERY: Duration = Duration::from_millis(100);
/// How often time played is written down, s: so much of it is lost with a killed server.
const SAVE_EVERY_S: f64 = 5.0;
/// Whose page was not heard of for so long has left. Their session makes room for others, and goes on when they come back.
const LEFT_AFTER: Duration = Duration::from_secs(600);
/// So long the end of a mission is seen before the participant goes on.
const ENDING_SEEN: Duration = Duration::from_secs(4);
/// So long the end of a mission waits at most for the answer to what was asked about the goal that completed it.
const LAST_ANSWER: Duration = Duration::from_secs(60);
/// How often tables are written anew.
const TABLES_EVERY: Duration = Duration::from_secs(1);
/// After this a session that could not be started, or died, is started again; after twice as long each time in a row that it came to
/// no page, but for no longer than that.
const RETRY_AFTER: Duration = Duration::from_secs(1);
const LONGEST_RETRY: Duration = Duration::from_secs(30);
/// A session whose page is not there by then is started anew.
const LONGEST_START: Duration = Duration::from_secs(120);
/// A session goes on from where one of so many tries before it was: what the machine lacks for a minute takes no mission along.
const TRIES_BEFORE: usize = 8;
/// How long sessions may take to end when the study ends.
const GRACE: Duration = Duration::from_secs(15);

/// Looks after the sessions of a study until `stop`; then ends them. It has to be the thread that starts them.
pub fn keep(registry: &Mutex<Registry>, player: &mut dyn Player, most_sessions: usize, stop: &AtomicBool) {
    let mut tables_at = Instant::now();
    while !stop.load(Ordering::Relaxed) {
        let mut state = lock(registry);
        state.look_after(player, most_sessions);
        if state.has_news && tables_at <= Instant::now() {
            state.has_news = false;
            tables_at = Instant::now() + TABLES_EVERY;
            write_tables(&state);
        }
        drop(state);
        thread::sleep(LOOK_EVERY);
    }
    let mut state = lock(registry);
    state.interrupt_all();
    write_tables(&state);
    let deadline = Instant::now() + GRACE;
    while !state.ending.is_empty() && Instant::now() < deadline {
        state.bury();
        drop(state);
        thread::sleep(LOOK_EVERY);
        state = lock(registry);
    }
    // Whoever does not end is ended.
    state.ending.clear();
    // Who has withdrawn is removed now: the study may never go on.
    for place in state.participants.keys().copied().collect::<Vec<_>>() {
        state.remove_withdrawn(place);
    }
    write_tables(&state);
}

/// A study's state; what a panic left of it is whole, since changes are written down before they are made.
pub(crate) fn lock(registry: &Mutex<Registry>) -> MutexGuard<'_, Registry> {
    registry.lock().unwrap_or_else(PoisonError::into_inner)
}

fn write_tables(state: &Registry) {
    let all = state.participants.values().map(|participant| participant.progress.clone());
    let written = tables::write(&state.study, &all.collect::<Vec<_>>(), &state.folder);
    if let Err(error) = written {
        tracing::error!("{error}");
    }
}

/// Tells the experimenter's terminal why something did not happen to a participant.
fn tell(place: u32, fault: &StudyFault) {
    match fault {
        StudyFault::Journal(error) => tracing::error!("{error}"),
        StudyFault::Folder(error) => tracing::error!("{error}"),
        StudyFault::Refused(_) | StudyFault::NotNow(_) => tracing::error!("{}: {fault}", pseudonym(place)),
    }
}

/// What was told of a participant's session.
enum News {
    Over(Ending),
    Interrupted(String),
}

impl Registry {
    fn look_after(&mut self, player: &mut dyn Player, most_sessions: usize) {
        self.bury();
        let places: Vec<u32> = self.participants.keys().copied().collect();
        places.iter().for_each(|place| self.follow_partner(*place));
        for place in places {
            if let Some(news) = self.look_at(place) {
                self.take(place, news);
            }
            self.end_break(place);
            self.assign_late(place);
            self.remove_withdrawn(place);
        }
        for party in self.queue() {
            let is_ready = |one: &Participant| one.is_here() && one.retry_at.is_none_or(|at| at <= Instant::now());
            let may_start = party.iter().all(|place| self.participants.get(place).is_some_and(is_ready));
            let starting = self.to_start.iter().filter(|(place, _)| self.stands_for_session(*place)).count();
            if may_start && self.running() + starting + self.ending.len() < most_sessions {
                self.note_started(&party);
            }
        }
        for (place, attempt) in std::mem::take(&mut self.to_start) {
            self.start(place, attempt, player);
        }
    }

    /// Notes that a session is started for one participant, or for a pair.
    fn note_started(&mut self, party: &[u32]) {
        if let [place] = party {
            return self.note(*place, &Event::Started);
        }
        let before = party.iter().filter_map(|place| Some(self.participants.get(place)?.progress.attempts())).max();
        let attempt = before.unwrap_or(0) + 1;
        party.iter().for_each(|place| self.note(*place, &Event::StartedTogether { attempt }));
    }

    /// Drops sessions that have ended.
    fn bury(&mut self) {
        self.ending.retain_mut(|playing| !matches!(playing.look(), Look::Gone(_)));
    }

    /// What is new of a participant's session. Time counts while its page is there, and the participant's too, and it does not stand still.
    fn look_at(&mut self, place: u32) -> Option<News> {
        if self.is_left(place) {
            return Some(News::Interrupted("nobody has been at its page for a long time".to_owned()));
        }
        let stands_still = self.stands_still(place);
        let participant = self.participants.get_mut(&place)?;
        let (is_here, left_s) = (participant.is_here(), participant.progress.left_s());
        let live = participant.live.as_mut()?;
        let now = Instant::now();
        match live.playing.look() {
            Look::Starting if live.looked.elapsed() > LONGEST_START => {
                return Some(News::Interrupted("its page does not come".to_owned()));
            }
            Look::Starting => return None,
            Look::Gone(reason) => return Some(News::Interrupted(reason)),
            Look::Over(ending) => {
                live.over.get_or_insert((ending, now));
            }
            Look::Open(page) => {
                participant.failed = None;
                let is_new = live.page.replace(page).is_none();
                live.looked = if is_new { now } else { live.looked };
                live.playing.hold(stands_still);
            }
        }
        if is_here && !stands_still && live.over.is_none() {
            live.unsaved_s += (now - live.looked).min(LOOK_EVERY * 10).as_secs_f64();
        }
        live.looked = now;
        if let Some((ending, at)) = live.over {
            // The goal that completes a mission is met in it, too; nothing else that happens then is asked about.
            let mut met = live.playing.happened();
            met.retain(|what| *what == Happening::GoalMet);
            return self.has_seen_ending(place, &met, at).then_some(News::Over(ending));
        }
        if left_s.is_some_and(|left| left <= live.unsaved_s) {
            return Some(News::Over(Ending::TimeUp));
        }
        let (unsaved_s, happened) = (live.unsaved_s, live.playing.happened());
        let tried = live.playing.tried(live.seat);
        if unsaved_s >= SAVE_EVERY_S {
            self.save_played(place);
        }
        self.ask_probe(place, &happened);
        self.tick_exercises(place, &tried);
        None
    }

    /// Whether a participant has left the session that they play; of a pair's, whether both have.
    fn is_left(&self, place: u32) -> bool {
        let is_away = |place: u32| {
            let seen = self.participants.get(&place).and_then(|one| one.seen);
            seen.is_some_and(|seen| seen.elapsed() >= LEFT_AFTER)
        };
        let live = self.participants.get(&place).and_then(|one| one.live.as_ref());
        live.is_some_and(|live| live.over.is_none()) && is_away(place) && self.playmate(place).is_none_or(is_away)
    }

    /// Notes which exercises of a tutorial a participant has tried.
    fn tick_exercises(&mut self, place: u32, activities: &[Activity]) {
        let Some(participant) = self.participants.get(&place) else { return };
        let Some((_, mission, _)) = participant.progress.mission() else { return };
        for exercise in tutorial::ticked(&mission.exercises, participant.progress.tried(), activities) {
            self.note(place, &Event::Tried { exercise });
        }
    }

    /// Whether a participant has seen long enough that their mission is over since `over_at`, and has answered what they were asked about the
    /// goal that was just met in it, if there is one.
    fn has_seen_ending(&mut self, place: u32, met: &[Happening], over_at: Instant) -> bool {
        let is_asked = !met.is_empty() && self.ask_probe(place, met);
        let Some(participant) = self.participants.get_mut(&place) else { return true };
        let is_open = participant.progress.probed().iter().any(|one| one.answer.is_none());
        let Some(live) = participant.live.as_mut() else { return true };
        live.is_asked_last |= is_asked;
        over_at.elapsed() >= if live.is_asked_last && is_open { LAST_ANSWER } else { ENDING_SEEN }
    }

    /// Asks a participant what is due now, if something is; whether it is. Nothing is asked during practice.
    fn ask_probe(&mut self, place: u32, happened: &[Happening]) -> bool {
        let Some(participant) = self.participants.get(&place).filter(|one| one.is_here()) else { return false };
        let progress = &participant.progress;
        let played_s = progress.played_s() + participant.live.as_ref().map_or(0.0, |live| live.unsaved_s);
        let is_practice = progress.mission().is_none_or(|(_, mission, _)| mission.is_practice);
        let due = probe::due(&self.study.probes, progress.probed(), happened, played_s).filter(|_| !is_practice);
        if let Some(probe) = due {
            self.note(place, &Event::Probed { probe });
        }
        due.is_some()
    }

    /// Writes down how long a participant has played.
    pub(crate) fn save_played(&mut self, place: u32) {
        let live = self.participants.get_mut(&place).and_then(|participant| participant.live.as_mut());
        let seconds = live.map_or(0.0, |live| std::mem::take(&mut live.unsaved_s));
        if seconds > 0.0 {
            self.note(place, &Event::Played { seconds });
        }
    }

    fn take(&mut self, place: u32, news: News) {
        self.save_played(place);
        match news {
            News::Over(ending) => self.note(place, &Event::Over { ending }),
            News::Interrupted(reason) => {
                tracing::warn!("{}: the session ended before its time: {reason}", pseudonym(place));
                self.retry_later(place, &reason);
                self.note(place, &Event::Interrupted { reason });
            }
        }
    }

    /// Has a session be started again after a while. What cannot be started at all is not tried over and over.
    fn retry_later(&mut self, place: u32, reason: &str) {
        let Some(participant) = self.participants.get_mut(&place) else { return };
        let had_page = participant.live.as_ref().is_some_and(|live| live.page.is_some());
        let before = participant.failed.take().map_or(0, |(times, _)| times);
        let wait = RETRY_AFTER * 2_u32.saturating_pow(before);
        if !had_page {
            participant.failed = Some((before.saturating_add(1), reason.to_owned()));
        }
        participant.retry_at = Some(Instant::now() + wait.min(LONGEST_RETRY));
    }

    /// Has something happen to a participant; that it cannot is told to the experimenter's terminal.
    pub(crate) fn note(&mut self, place: u32, event: &Event) {
        if let Err(fault) = self.apply(place, event) {
            tell(place, &fault);
        }
    }

    /// Assigns a condition that could not be written down when it was due, such as on a full disk; it is tried every second.
    fn assign_late(&mut self, place: u32) {
        let Some(participant) = self.participants.get_mut(&place) else { return };
        let is_due = participant.retry_at.is_none_or(|at| at <= Instant::now());
        if *participant.progress.phase() == Phase::Assigning && is_due {
            participant.retry_at = Some(Instant::now() + RETRY_AFTER);
            if let Err(fault) = self.assign(place) {
                tell(place, &fault);
            }
        }
    }

    /// Starts the session of a participant; that of a pair for both, when the first of them is to get one.
    fn start(&mut self, place: u32, attempt: u32, player: &mut dyn Player) {
        let Some(participant) = self.participants.get(&place).filter(|one| one.live.is_none()) else { return };
        let progress = &participant.progress;
        let Some((step, mission, Doing::Playing)) = progress.mission() else { return };
        let is_shared = progress.plays_together().is_some();
        let party = match self.playmate(place) {
            Some(partner) => vec![place.min(partner), place.max(partner)],
            None => vec![place],
        };
        if is_shared && party.len() == 1 {
            // That it is started could not be written down for the partner.
            self.take(place, News::Interrupted("it could not be started for both".to_owned()));
            return;
        }
        // Whoever does not want to be heard is not: the microphone of a session is there for all who play it, or for nobody.
        let agrees = |place: &u32| self.participants.get(place).is_some_and(|one| one.progress.agrees_to_audio());
        let is_heard = party.iter().all(agrees);
        let own = session_arguments(&mission.settings, is_heard, &self.study.wizard);
        let worlds = self.study.worlds.iter().flat_map(StudyWorld::arguments);
        let arguments = own.into_iter().chain(worlds).collect();
        let wanted = self.wanted(&party, progress, (step, mission, attempt), arguments);
        match player.start(&wanted) {
            Ok(playing) => {
                let parts = if is_shared { shared::parts(playing, party.len()) } else { vec![playing] };
                for (seat, (place, playing)) in party.iter().zip(parts).enumerate() {
                    let looked = Instant::now();
                    let (page, over, is_asked_last) = (None, None, false);
                    let live = Live { playing, seat, page, is_heard, looked, unsaved_s: 0.0, over, is_asked_last };
                    if let Some(participant) = self.participants.get_mut(place) {
                        participant.live = Some(live);
                    }
                }
            }
            Err(reason) => party.into_iter().for_each(|place| self.take(place, News::Interrupted(reason.clone()))),
        }
    }

    /// What is wanted of the player for a mission of these, the progress of one of whom this is.
    fn wanted(
        &self,
        party: &[u32],
        progress: &Progress,
        (step, mission, attempt): (usize, &PlannedMission, u32),
        arguments: Vec<String>,
    ) -> Wanted {
        let (place, together) = (progress.plan().place, progress.together());
        let name = name_of_try(place, step, attempt, together);
        Wanted {
            participant: Whose::of(&self.study, place).label(),
            seats: if party.len() > 1 { self.study.session_size() } else { 0 },
            mission: mission.mission.clone(),
            arguments,
            log: self.folder.log_path(&name),
            before: self.before(place, step, attempt, together),
            seed: self.study.seed,
            is_tutorial: mission.is_tutorial(),
            name,
        }
    }

    /// The logs of the last tries. One that cannot be gone on from leaves none, so after several a mission begins anew.
    fn before(&self, place: u32, step: usize, attempt: u32, together: u32) -> Vec<PathBuf> {
        let tries = (1..attempt).rev().take(TRIES_BEFORE);
        let logs = tries.map(|attempt| self.folder.log_path(&name_of_try(place, step, attempt, together)));
        logs.filter(|log| log.is_file()).collect()
    }

    fn end_break(&mut self, place: u32) {
        let Some(participant) = self.participants.get(&place) else { return };
        let progress = &participant.progress;
        if let Some((_, Step::Break { limit_s: Some(limit), .. }, _)) = progress.step_now() {
            let rested_s = self.clock.now_ms().saturating_sub(progress.since_ms()) as f64 / 1000.0;
            if rested_s >= *limit {
                self.note(place, &Event::GoesOn);
            }
        }
    }

    /// Removes what is kept of somebody who has withdrawn, once no session is left that could write.
    fn remove_withdrawn(&mut self, place: u32) {
        let is_withdrawn = |one: &Participant| *one.progress.phase() == Phase::Withdrawn;
        let plays_on = |one: &Participant| one.live.is_some() && one.progress.plays_together().is_some();
        if self.ending.is_empty()
            && !self.participants.get(&partner_of(place)).is_some_and(plays_on)
            && self.participants.get(&place).is_some_and(is_withdrawn)
            && let Err(error) = self.remove(place)
        {
            tracing::error!("{error}");
        }
    }

    /// The study ends: sessions are asked to, and are started again when it goes on.
    fn interrupt_all(&mut self) {
        for place in self.participants.keys().copied().collect::<Vec<_>>() {
            self.save_played(place);
            if self.participants.get(&place).is_some_and(|one| one.live.is_some()) {
                self.note(place, &Event::Interrupted { reason: "the study's server ended".to_owned() });
            }
        }
    }
}

#[cfg(test)]
mod tests;
