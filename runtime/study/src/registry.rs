//! All participants of a study that runs: who they are, where they are, and what happens to them, written down first.

use std::{
    collections::{BTreeMap, BTreeSet, VecDeque},
    time::{Duration, Instant, SystemTime, UNIX_EPOCH},
};

use cohabit_dialog::token;

use crate::{
    assign::{assign_among, assign_instead, begin},
    design::{ConsentBox, CovariateSource, Minimisation, Study},
    folder::{Consent, Folder, FolderError, Note},
    journal::{Journal, JournalError},
    links::Links,
    minimise::level_of,
    pair::{partner_of, seat_of},
    plan::{Plan, Step, place_of, pseudonym},
    progress::{Doing, Effect, Ending, Event, Phase, Progress, Refused},
    session::{PageAddress, Playing},
};

/// People who opened the sign-up link and have not agreed yet; the oldest go first.
const MOST_NEWCOMERS: usize = 1000;
/// Whose page was not heard of for so long is away: five times what a page waits between two questions.
pub(crate) const AWAY_AFTER: Duration = Duration::from_secs(10);

/// Why something did not happen, for the person who asked for it.
#[derive(Debug, thiserror::Error)]
pub enum StudyFault {
    /// It cannot happen now.
    #[error(transparent)]
    Refused(#[from] Refused),
    /// It cannot happen, with what to tell the person.
    #[error("{0}")]
    NotNow(String),
    /// It could not be written down.
    #[error("This could not be saved; please try again, or tell the experimenter.")]
    Journal(#[from] JournalError),
    /// The folder failed.
    #[error("This could not be saved; please try again, or tell the experimenter.")]
    Folder(#[from] FolderError),
}

/// Somebody who has agreed to take part.
pub(crate) struct Participant {
    pub progress: Progress,
    journal: Journal,
    /// When their page was last heard of.
    pub seen: Option<Instant>,
    /// What the pages that were opened by their link call themselves, the newest last.
    pub pages: Vec<String>,
    /// The session that they play.
    pub live: Option<Live>,
    /// When a session may be started for them again.
    pub retry_at: Option<Instant>,
    /// How many sessions of theirs in a row ended before they had a page, and why the last one did.
    pub failed: Option<(u32, String)>,
    /// When they came into the queue: a count.
    pub queued: u64,
    /// Since when they have waited for their partner, while they are here.
    pub waits_since: Option<Instant>,
    /// The step of the mission that they want to skip, which their partner has not agreed to yet.
    pub skip_wanted: Option<usize>,
    /// The step of the mission that the experimenter has paused.
    pub paused: Option<usize>,
    /// What the experimenter told them last, and how many messages of theirs that makes.
    pub told: Option<(u32, String)>,
}

/// A session that is played.
pub(crate) struct Live {
    pub playing: Box<dyn Playing>,
    /// Their seat in it, from 0; 0 if they play by themselves.
    pub seat: usize,
    /// Where its page is, once there is one.
    pub page: Option<PageAddress>,
    /// Whether all who play it agreed to be heard, so that they have a microphone.
    pub is_heard: bool,
    /// When it was last looked at.
    pub looked: Instant,
    /// Time played that is not written down yet, s.
    pub unsaved_s: f64,
    /// How its mission ended, and when.
    pub over: Option<(Ending, Instant)>,
    /// Whether something was asked about the goal that ended it.
    pub is_asked_last: bool,
}

/// Somebody who has not agreed yet: nothing of theirs is written down.
pub(crate) struct Newcomer {
    pub token: String,
    /// The place of the link, if it is one that the experimenter gave out.
    place: Option<u32>,
    pub reading: Reading,
    /// The parameters of their link that the study asks for.
    pub parameters: BTreeMap<String, String>,
}

/// What a newcomer's page shows.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Reading {
    /// What the study is about.
    Information,
    /// The consent form.
    Consent,
    /// That nothing of theirs was recorded, since they do not agree.
    Declined,
}

/// Who has a token.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Who {
    /// A participant, by place.
    Participant(u32),
    /// Somebody who has not agreed yet, by index.
    Newcomer(usize),
    /// Somebody whose data were removed.
    Withdrawn,
}

/// Where the times of events are from.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Clock {
    /// This machine.
    Wall,
    /// A dry run, ms since 1970.
    Simulated(u64),
}

impl Clock {
    /// The time now, ms since 1970.
    pub(crate) fn now_ms(self) -> u64 {
        match self {
            Self::Wall => {
                let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
                u64::try_from(since.as_millis()).unwrap_or(u64::MAX)
            }
            Self::Simulated(at_ms) => at_ms,
        }
    }
}

/// All participants of a study.
pub struct Registry {
    pub(crate) clock: Clock,
    pub(crate) study: Study,
    pub(crate) folder: Folder,
    pub(crate) links: Links,
    pub(crate) participants: BTreeMap<u32, Participant>,
    pub(crate) newcomers: VecDeque<Newcomer>,
    pub(crate) notes: Vec<Note>,
    /// The tokens of those who have withdrawn since the server started.
    withdrawn: Vec<String>,
    /// The places of all who have withdrawn.
    pub(crate) gone: BTreeSet<u32>,
    /// Sessions that were asked to end.
    pub(crate) ending: Vec<Box<dyn Playing>>,
    /// Sessions that are to be started, with the attempt's number.
    pub(crate) to_start: Vec<(u32, u32)>,
    /// Whether tables are older than what happened.
    pub(crate) has_news: bool,
    queued: u64,
}

impl Registry {
    /// Everybody where the journals of a folder say. Whose session was running waits for another one.
    ///
    /// # Errors
    /// [`FolderError`].
    pub fn new(study: Study, folder: Folder) -> Result<Self, FolderError> {
        let (links, notes, journals) = (folder.links()?, folder.notes()?, folder.journals()?);
        let gone = folder.withdrawals()?.iter().filter_map(|one| place_of(&one.participant)).collect();
        let mut registry = Self {
            clock: Clock::Wall,
            study,
            folder,
            links,
            participants: BTreeMap::new(),
            newcomers: VecDeque::new(),
            notes,
            withdrawn: Vec::new(),
            gone,
            ending: Vec::new(),
            to_start: Vec::new(),
            has_news: true,
            queued: 0,
        };
        let mut unassigned = Vec::new();
        for (journal, progress) in journals {
            let place = progress.plan().place;
            unassigned.extend((*progress.phase() == Phase::Assigning).then_some(place));
            let was_playing = matches!(progress.phase(), Phase::At(_, Doing::Playing));
            registry.participants.insert(place, Participant::new(progress, journal));
            if was_playing {
                let reason = "the study's server was started again".to_owned();
                match registry.apply(place, &Event::Interrupted { reason }) {
                    Err(StudyFault::Journal(error)) => return Err(error.into()),
                    Err(StudyFault::Folder(error)) => return Err(error),
                    // That it was refused cannot be: it was played.
                    Err(StudyFault::Refused(_) | StudyFault::NotNow(_)) | Ok(()) => {}
                }
            }
        }
        for place in unassigned {
            match registry.assign(place) {
                Err(StudyFault::Journal(error)) => return Err(error.into()),
                Err(StudyFault::Folder(error)) => return Err(error),
                Err(StudyFault::Refused(_) | StudyFault::NotNow(_)) | Ok(()) => {}
            }
        }
        Ok(registry)
    }

    /// Who has a token. The holder of a link that was given out is a newcomer from now on, until they agree.
    pub(crate) fn who(&mut self, given: &str) -> Option<Who> {
        if self.withdrawn.iter().any(|token| token::admits(token, Some(given))) {
            return Some(Who::Withdrawn);
        }
        let place = self.links.place(given);
        if let Some(place) = place.filter(|place| self.participants.contains_key(place)) {
            return Some(Who::Participant(place));
        }
        let known = self.newcomers.iter().position(|one| token::admits(&one.token, Some(given)));
        known.or_else(|| place.map(|_| self.add_newcomer(given.to_owned(), place))).map(Who::Newcomer)
    }

    /// A token for somebody who signs up.
    pub(crate) fn sign_up(&mut self) -> Result<String, StudyFault> {
        self.check_room()?;
        let token = token::fresh().map_err(|error| StudyFault::NotNow(error.to_string()))?;
        self.add_newcomer(token.clone(), None);
        Ok(token)
    }

    fn add_newcomer(&mut self, token: String, place: Option<u32>) -> usize {
        if self.newcomers.len() >= MOST_NEWCOMERS {
            self.newcomers.pop_front();
        }
        self.newcomers.push_back(Newcomer { token, place, reading: Reading::Information, parameters: BTreeMap::new() });
        self.newcomers.len() - 1
    }

    /// What somebody does who agrees, as far as it can be known.
    fn plan(&self, place: u32, parameters: &BTreeMap<String, String>) -> Plan {
        let plan = match &self.study.minimisation {
            None => assign_instead(&self.study, place, self.order(place)),
            Some(minimisation) => {
                let covariates = minimisation.told_by_link(parameters);
                if minimisation.questionnaires().next().is_some() {
                    Plan { covariates, ..begin(&self.study, place) }
                } else {
                    assign_among(&self.study, minimisation, place, covariates, &self.assigned())
                }
            }
        };
        Plan { is_synthetic: self.folder.is_synthetic(), ..plan }
    }

    /// The place in the order of all of who agrees at a place: their own, as long as it is planned. Who comes beyond the plan takes that of
    /// the first who has left and whom nobody stands for yet, so that squares and blocks are whole once all planned have taken part. Both of
    /// a pair stand for one pair.
    pub(crate) fn order(&self, place: u32) -> u32 {
        let (size, planned) = (self.study.session_size(), self.study.participants);
        if place <= planned {
            return place;
        }
        let unit_of = |place: u32| place.saturating_sub(1) / size;
        let in_unit = |unit: u32| unit * size + place.saturating_sub(1) % size + 1;
        let partner = self.participants.get(&partner_of(place)).filter(|_| self.study.pairing.is_some());
        if let Some(partner) = partner {
            return in_unit(unit_of(partner.progress.plan().order()));
        }
        let is_free = |unit: &u32| {
            let is_of_it = |progress: &Progress| unit_of(progress.plan().order()) == *unit;
            let has_it = |one: &Participant| !one.progress.phase().is_out() && is_of_it(&one.progress);
            let mut own = unit * size + 1..=(unit + 1) * size;
            own.any(|place| self.has_left(place)) && !self.participants.values().any(has_it)
        };
        (0..planned / size).find(is_free).map_or(place, in_unit)
    }

    /// The plans of all who have a condition.
    fn assigned(&self) -> Vec<&Plan> {
        self.participants.values().map(|one| one.progress.plan()).filter(|plan| !plan.awaits_assignment).collect()
    }

    /// Assigns a condition to somebody who has answered what it depends on.
    pub(crate) fn assign(&mut self, place: u32) -> Result<(), StudyFault> {
        let (Some(minimisation), Some(participant)) = (&self.study.minimisation, self.participants.get(&place)) else {
            return Ok(());
        };
        let covariates = self.covariates(minimisation, &participant.progress);
        let plan = assign_among(&self.study, minimisation, place, covariates, &self.assigned());
        let plan = Box::new(Plan { is_synthetic: self.folder.is_synthetic(), ..plan });
        self.apply(place, &Event::Assigned { plan })
    }

    /// The levels of somebody's covariates, by their link and by what they have answered.
    fn covariates(&self, minimisation: &Minimisation, progress: &Progress) -> BTreeMap<String, String> {
        let mut levels = progress.plan().covariates.clone();
        for covariate in &minimisation.covariates {
            let CovariateSource::Answer { questionnaire, item, cuts } = &covariate.from else { continue };
            let is_it = |step: usize| matches!(progress.plan().steps.get(step), Some(Step::Questionnaire { name, .. }) if name == questionnaire);
            let done = progress.done().iter().find(|done| is_it(done.step));
            let given = done.and_then(|done| done.answers.get(*item)?.as_ref());
            let asked = self.study.questionnaire(questionnaire).and_then(|asked| asked.items.get(*item));
            levels.extend(asked.map(|asked| (covariate.name.clone(), level_of(asked, cuts, given))));
        }
        levels
    }

    /// Says when all planned places are taken: those of people who take part, and of links that were given out.
    fn check_room(&self) -> Result<(), StudyFault> {
        let is_out = |place: &u32| self.participants.get(place).is_some_and(|one| one.progress.phase().is_out());
        let taken = self.links.participants.keys().filter(|place| !is_out(place)).count();
        if taken < self.study.participants as usize {
            return Ok(());
        }
        let Study { page_texts, contact, .. } = &self.study;
        Err(StudyFault::NotNow(page_texts.study_text("study_full").replace("{contact}", contact)))
    }

    /// A place for the next participant, with a link of its own: of a pair that somebody waits in, if there is one. Nobody comes into a
    /// pair that somebody has left, or in which somebody goes alone.
    pub(crate) fn reserve(&mut self, token: Option<String>) -> Result<u32, StudyFault> {
        let taken = self.links.participants.keys().chain(self.participants.keys()).chain(&self.gone);
        let next = taken.max().copied().unwrap_or(0) + 1;
        let is_second = self.study.pairing.is_some() && seat_of(next) > 0;
        let place = if is_second && !self.is_open(partner_of(next)) { next + 1 } else { next };
        let token = match token {
            Some(token) => token,
            None => token::fresh().map_err(|error| StudyFault::NotNow(error.to_string()))?,
        };
        let mut links = self.links.clone();
        links.participants.insert(place, token);
        let path = self.folder.links_path();
        links.save(&path).map_err(|source| FolderError::File { path, source })?;
        self.links = links;
        self.has_news = true;
        Ok(place)
    }

    /// Whether the pair of somebody can be joined.
    fn is_open(&self, place: u32) -> bool {
        !self.has_left(place) && self.partner(place).is_some()
    }

    /// A newcomer agrees: they get their place, and their plan. All of this is written down before they go on, their
    /// consent first, so that there are no data without it.
    pub(crate) fn enrol(&mut self, index: usize, version: &str, ticked: &[usize]) -> Result<(), StudyFault> {
        let Some(newcomer) = self.newcomers.get(index) else { return Ok(()) };
        let numbered = self.study.consents.iter().enumerate();
        let (agreed, declined): (Vec<_>, Vec<_>) = numbered.partition(|(number, _)| ticked.contains(number));
        if version != self.study.consent.version || declined.iter().any(|(_, one)| one.is_required) {
            return Err(StudyFault::NotNow(self.study.page_texts.study_text("boxes_open").to_owned()));
        }
        let audio = agreed.iter().any(|(_, one)| one.audio);
        let ticked = agreed.iter().map(|(number, _)| *number).collect();
        let text = |(_, one): (usize, &ConsentBox)| one.text.clone();
        let texts = |boxes: Vec<(usize, &ConsentBox)>| boxes.into_iter().map(text).collect::<Vec<_>>();
        let (agreed, declined) = (texts(agreed), texts(declined));
        let parameters = newcomer.parameters.clone();
        let place = match newcomer.place {
            Some(place) if self.study.pairing.is_some() && self.has_left(partner_of(place)) => {
                let Study { page_texts, contact, .. } = &self.study;
                let text = page_texts.study_text("partner_gone").replace("{contact}", contact);
                return Err(StudyFault::NotNow(text));
            }
            Some(place) => place,
            None => {
                self.check_room()?;
                let place = self.reserve(Some(newcomer.token.clone()))?;
                // It is theirs, also if what follows cannot be written down and they agree again.
                if let Some(newcomer) = self.newcomers.get_mut(index) {
                    newcomer.place = Some(place);
                }
                place
            }
        };
        let at_ms = self.clock.now_ms();
        let participant = pseudonym(place);
        let consent = Consent { participant, at_ms, version: version.to_owned(), agreed, declined };
        self.folder.keep_consent(place, &consent)?;
        self.keep_way_back(place, &parameters)?;
        let plan = self.plan(place, &parameters);
        let agreed = Event::Consented { version: version.to_owned(), ticked, audio };
        let journal = Journal::begin(&self.folder.journal_path(place), &plan, &agreed, at_ms)?;
        let mut progress = Progress::new(plan);
        progress.step(&Event::Read, at_ms)?;
        progress.step(&agreed, at_ms)?;
        let seen = Some(Instant::now());
        self.participants.insert(place, Participant { seen, ..Participant::new(progress, journal) });
        self.newcomers.remove(index);
        self.has_news = true;
        Ok(())
    }

    /// Has something happen to a participant: it is written down, and then what follows from it is done.
    ///
    /// # Errors
    /// [`StudyFault`]; nothing has changed then.
    pub(crate) fn apply(&mut self, place: u32, event: &Event) -> Result<(), StudyFault> {
        let Some(participant) = self.participants.get_mut(&place) else {
            return Err(StudyFault::NotNow("Nobody of that name takes part.".to_owned()));
        };
        let (mut next, at_ms) = (participant.progress.clone(), self.clock.now_ms());
        let effects = next.step(event, at_ms)?;
        participant.journal.append(event, at_ms)?;
        participant.progress = next;
        self.has_news = true;
        if matches!(participant.progress.phase(), Phase::At(_, Doing::Queued { .. })) {
            self.queued += 1;
            participant.queued = self.queued;
        }
        for effect in effects {
            match effect {
                Effect::StartSession { attempt } => self.to_start.push((place, attempt)),
                Effect::EndSession => self.end_session(place),
                Effect::Assign => self.assign(place)?,
                // As soon as the session has ended, which may still write.
                Effect::RemoveData => {}
            }
        }
        Ok(())
    }

    fn end_session(&mut self, place: u32) {
        self.to_start.retain(|(waiting, _)| *waiting != place);
        let live = self.participants.get_mut(&place).and_then(|participant| participant.live.take());
        if let Some(mut live) = live {
            live.playing.end();
            self.ending.push(live.playing);
        }
    }

    /// Removes all data of a participant who has withdrawn, and whose session has ended.
    pub(crate) fn remove(&mut self, place: u32) -> Result<(), StudyFault> {
        self.folder.withdraw(&pseudonym(place), self.clock.now_ms())?;
        self.participants.remove(&place);
        self.withdrawn.extend(self.links.participants.remove(&place));
        self.links.back.remove(&place);
        self.gone.insert(place);
        self.notes = self.folder.notes()?;
        self.has_news = true;
        Ok(())
    }
}

impl Participant {
    fn new(progress: Progress, journal: Journal) -> Self {
        Self {
            progress,
            journal,
            seen: None,
            pages: Vec::new(),
            live: None,
            retry_at: None,
            failed: None,
            queued: 0,
            waits_since: None,
            skip_wanted: None,
            paused: None,
            told: None,
        }
    }

    /// Whether their page was heard of a moment ago.
    pub(crate) fn is_here(&self) -> bool {
        self.seen.is_some_and(|seen| seen.elapsed() < AWAY_AFTER)
    }
}
