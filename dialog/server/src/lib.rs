//! The dialog service: serves the page, understands what people say there, plans, and tells them what happens.
//!
//! It is a peer of the session's bus like any other: it reads state and frames, and what it says and plans is heard,
//! and recorded, by all. It never knows the world's insides.

mod affordances;
mod connections;
mod conversation;
mod drafts;
mod driving;
mod expression;
mod feed;
mod frames;
mod hidden;
mod hosts;
mod hub;
mod interpreter;
mod journal;
pub mod known;
mod latency;
mod limits;
mod page;
mod peers;
mod person_seats;
mod presence;
mod questionnaire;
mod recorded;
mod replay;
mod robots;
mod same_user;
mod screening;
mod seat;
mod site;
mod spoken;
mod survey;
mod talk;
mod text;
mod texts;
mod tls;
pub mod token;
mod view;
mod viewer;
mod visit;
mod voice;
mod web;
mod wizard;
mod world_state;

use std::{
    collections::BTreeMap,
    net::{SocketAddr, TcpListener},
    path::PathBuf,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::Duration,
};

use cohabit_bus::{BusError, Pauses, Transport, message::CameraRecord};
use cohabit_cdf::{Catalog, Layout, Mission, catalog::Speech};
use cohabit_language::Rewrite;
use serde_json::{Value, json};

pub use cohabit_language::{Asking, Consulting, Effort, Interpreter, Knows, Language};
pub use cohabit_speech::VoiceSettings;
pub use conversation::{Asked, Conversation, Insight, Manner, Outgoing, Politeness, TurnEnd, Verbosity};
pub use driving::{Drivable, NotDrivable};
pub use expression::FacialExpression;
pub use frames::encode_jpeg;
pub use hidden::{Hidden, NotHidden};
pub use hosts::{HostName, NoHost};
pub use interpreter::{Endpoint, EndpointError};
pub use journal::begin_after;
pub use known::Knowledge;
pub use limits::ServerLimits;
pub use questionnaire::{
    Form, Given, Item, NotAnswered, Questionnaire, QuestionnaireError, Scale, When, questionnaire_text,
};
pub use replay::{ScreeningConfig, screen};
pub use site::{Framing, Site, SiteFile, file, file_routes, media, site_of_files};
pub use spoken::meaning;
pub use texts::{PagePart, PageTexts, PageTextsError, TextProblem, languages};
pub use tls::{Identity, TlsError};
pub use voice::VoiceConfig;
pub use wizard::{Holding, MOMENT, NotOfWizard, OnTimeout, Phrase, PlannedError, SeatState, WizardSettings};

use crate::{
    driving::Drivers,
    hub::Hub,
    journal::{Journal, Place},
    page::RobotName,
    person_seats::PersonSeats,
    robots::{BodyNames, Robots},
    survey::Survey,
    talk::{Conversations, Ears, Pages, Talk},
    view::View,
    visit::Live,
    voice::Voice,
    web::{Host, Seat, Service},
};

/// Settings of a dialog service.
pub struct DialogConfig {
    /// The session's name.
    pub session: String,
    /// Where the page is served; port 0 takes any that is free.
    pub listen: SocketAddr,
    /// The hosts that the page is served as, besides those of this machine.
    pub hosts: Vec<HostName>,
    /// What the page is served with by HTTPS, if it is to be.
    pub identity: Option<Identity>,
    /// The port of the server of the same host whose pages may show the page within them, if there is one.
    pub framed_by: Option<u16>,
    /// Where what is said is written down, for the service that takes a dead one's place; nowhere, if absent.
    pub journal: Option<PathBuf>,
    /// The session's cameras.
    pub cameras: Vec<CameraRecord>,
    /// Which bodies people may drive from the page.
    pub drivable: Drivable,
    /// How many people have a page of their own, each at an address of its own.
    pub seats: usize,
    /// What the robot may know.
    pub knows: Knows,
    /// When it asks.
    pub asking: Asking,
    /// How it words what it says.
    pub manner: Manner,
    /// How much work goes into what people say.
    pub effort: Effort,
    /// Who else says what people mean, if anybody.
    pub interpreter: Option<Box<dyn Interpreter>>,
    /// When it is asked.
    pub consulting: Consulting,
    /// The bodies that people speak to.
    pub robots: Vec<u32>,
    /// Those whose minds act on their own, whatever people tell them.
    pub on_their_own: Vec<u32>,
    /// What bodies are called, if not by what they are.
    pub names: BTreeMap<u32, String>,
    /// What people are asked about the session.
    pub questionnaires: Vec<Questionnaire>,
    /// How people are heard, and robots speak.
    pub voice: VoiceConfig,
    /// What the page leaves out.
    pub hidden: Vec<Hidden>,
    /// What people read on the page, beside what the session and the robot say.
    pub texts: PageTexts,
    /// What robots hold back, and who decides of it.
    pub holding: Holding,
    /// Called once, when a page says that it has shown a frame.
    pub on_first_frame: Box<dyn Fn() + Send + Sync>,
}

/// Why the dialog service could not start or go on.
#[derive(Debug, thiserror::Error)]
pub enum DialogError {
    /// The page's address cannot be had.
    #[error("serve the page on {address}: {source}; choose another with `--port` (0 takes any that is free)")]
    Listen {
        /// Which.
        address: SocketAddr,
        /// Why.
        source: std::io::Error,
    },
    /// The page's server failed.
    #[error("serve the page: {0}")]
    Serve(std::io::Error),
    /// The bus failed.
    #[error(transparent)]
    Bus(#[from] BusError),
    /// A peer sent nonsense.
    #[error(transparent)]
    Malformed(#[from] cohabit_bus::message::Malformed),
}

/// How often the page learns of the world's state.
const STATE_EVERY: Duration = Duration::from_millis(100);

/// The robot's language.
#[must_use]
pub fn language(catalog: Arc<Catalog>, effort: Effort) -> Language {
    let rewriter = rewriter(&catalog);
    let language = Language::new(catalog);
    match effort {
        Effort::Fast => language,
        Effort::Full => language.with_rewriter(rewriter),
    }
}

/// The rewriter that is fitted to how people speak in this world.
fn rewriter(catalog: &Catalog) -> Rewrite {
    match catalog.speech() {
        Speech::Office => cohabit_rewriter::rewrite,
        Speech::Household => cohabit_rewriter::rewrite_at_home,
    }
}

/// Where the pages of a session can be opened.
pub struct Addresses {
    /// That of the people who speak with the robot.
    pub page: String,
    /// That of the wizard, if one takes part.
    pub wizard: Option<String>,
    /// Those of people who have a page of their own, in the order of their seats.
    pub seats: Vec<SeatAddress>,
}

/// Where the page of a seat can be opened.
pub struct SeatAddress {
    /// The address.
    pub page: String,
    /// The avatar that it drives, if there is one for it.
    pub body: Option<u32>,
}

/// Serves a session until `stop`; `ready` is given the pages' addresses as soon as they can be opened.
///
/// # Errors
/// [`DialogError`].
pub fn serve(
    bus: Arc<dyn Transport>,
    mission: Arc<Mission>,
    layout: Arc<Layout>,
    catalog: Arc<Catalog>,
    config: DialogConfig,
    stop: &AtomicBool,
    ready: impl FnOnce(&Addresses),
) -> Result<(), DialogError> {
    let bodies = world_state::wait_for_world(&*bus, &|| stop.load(Ordering::Relaxed))?;
    let told = BodyNames::new(&bodies, &config.names);
    let names = page::body_names(&bodies, &config.names);
    let drivers = Arc::new(Drivers::new(Arc::clone(&bus), config.drivable, &bodies, &names));
    let views = page::views(&config.cameras, &names, config.robots.len());
    let robots: Vec<RobotName> = robots::named(&config.robots, &names);
    let mut hello = page::hello(&config.session, &mission, &layout, &catalog, &views, drivers.bodies(), &robots);
    hello["questionnaires"] = json!(config.questionnaires);
    hello["longest_text"] = json!(limits::LONGEST_TEXT_CHARS);
    hello["hidden"] = json!(config.hidden.iter().map(|part| part.name()).collect::<Vec<_>>());
    let has_microphone = !config.hidden.contains(&Hidden::Microphone);
    let voice = VoiceConfig { has_microphone, ..config.voice };
    hello["voice"] = voice.json();
    let views = views.into_iter().map(|view| View::new(view.camera)).collect();
    let hub = Arc::new(Hub::new(hello, views, config.on_first_frame));
    let journal = Journal::open(config.journal.as_deref());
    let (listener, place) = listen(config.listen, config.seats, journal.past().place.as_ref())?;
    if config.effort == Effort::Full {
        // It takes some tenths of a second to load: who speaks first need not wait for that.
        let rewriter = rewriter(&catalog);
        std::thread::spawn(move || rewriter("", &[], ""));
    }
    let language = language(Arc::clone(&catalog), config.effort).asking(config.asking);
    let consulting = if config.interpreter.is_some() { config.consulting } else { Consulting::Never };
    let robots = Robots::new(&robots, config.knows, &language, &catalog, &layout, told, consulting)
        .holding(&config.holding)
        .speaking(config.manner)
        .on_their_own(&config.on_their_own)
        .with_mission(&mission.goal_text);
    let (puzzles, asked) = config.interpreter.is_some().then(interpreter::puzzles).unzip();
    let survey = Arc::new(Survey::new(&*bus, config.questionnaires)?);
    let (tells, plays) = (Arc::clone(&hub), Arc::clone(&hub));
    let (tell, play) = (move |message: &Value| tells.tell(message), move |piece| plays.play(piece));
    let voice = Voice::new(Arc::clone(&bus), voice, tell, play);
    let (mailbox, mail) = talk::mailbox();
    let (drafts, drafted) = drafts::drafts();
    let (its_hub, its_drivers, its_voice) = (Arc::clone(&hub), Arc::clone(&drivers), Arc::clone(&voice));
    let pages = Pages { hub: its_hub, drivers: its_drivers, voice: its_voice, mailbox, drafts, layout };
    let talk = Talk::new(&*bus, catalog, &robots, puzzles, pages, journal)?;
    let (mut conversations, thoughts) = Conversations::begin(&*bus, Arc::clone(&talk), robots)?;
    let ears = Ears::new(&*bus)?;
    talk.serve_at(place.clone());
    let Place { address, token, wizard, seats } = place;
    let people = Arc::new(PersonSeats::new(seats, &bodies));
    for number in 0..config.seats {
        // So people have the numbers of their seats, whoever comes first.
        if let Some((visitor, _)) = talk.enter(people.comer(number).key) {
            talk.leave(visitor);
        }
    }
    let seat = config.holding.wizard.as_ref().map(|_| Seat::new(&wizard, &config.holding));
    let ended = AtomicBool::new(false);
    let over = || stop.load(Ordering::Relaxed) || ended.load(Ordering::Relaxed);
    conversations.wait_until_they_see(&*bus, &over)?;
    conversations.leave_puzzles()?;
    if seat.is_some() {
        talk.offer_seat()?;
    }
    let served = thread::scope(|scope| {
        if let (Some(interpreter), Some(asked)) = (config.interpreter, asked) {
            // It may take long to answer; nobody waits for it at the end.
            let talk = Arc::downgrade(&talk);
            let is_told = move |answer| talk.upgrade().is_some_and(|talk| talk.note_interpretation(answer));
            thread::spawn(move || interpreter::answer(&*interpreter, &asked, is_told));
        }
        let mut workers = vec![
            scope.spawn(|| until_ended(&ended, || talk::listen(ears, &talk, &over))),
            scope.spawn(|| until_ended(&ended, || talk::show_state(&talk, &survey, STATE_EVERY, &over))),
            scope.spawn(|| until_ended(&ended, || voice.pass_on(&over))),
            scope.spawn(|| until_ended(&ended, || talk.read_ahead(drafted, &over))),
            scope.spawn(|| until_ended(&ended, || talk.think(thoughts, &over))),
            scope.spawn(|| until_ended(&ended, || conversations.run(mail, &over))),
        ];
        for view in (0..=u8::MAX).zip(&hub.views) {
            let (bus, talk, over, ended) = (&*bus, &talk, &over, &ended);
            let shown = move |shown| talk.note_frame(shown);
            workers.push(
                scope.spawn(move || until_ended(ended, || frames::relay(bus, view, Pauses::default(), &shown, over))),
            );
        }
        let is_encrypted = config.identity.is_some();
        ready(&Addresses {
            page: token::page_address(address, is_encrypted, &token),
            wizard: seat.as_ref().map(|_| token::wizard_address(address, is_encrypted, &wizard)),
            seats: people
                .all()
                .map(|(token, seat)| SeatAddress {
                    page: token::page_address(address, is_encrypted, token),
                    body: seat.body,
                })
                .collect(),
        });
        let (hub, limits) = (Arc::clone(&hub), ServerLimits::default());
        let (survey, voice) = (Arc::clone(&survey), Arc::clone(&voice));
        let host = Host::Live(Live { talk: Arc::clone(&talk), drivers, survey, voice });
        let (token, identity, hosts) = (token.into(), config.identity, config.hosts);
        let framing = Framing { framed_by: config.framed_by, frames_ports: false };
        let texts = Arc::new(config.texts);
        let admits_own_user = true;
        let service =
            Service { hub, host, token, seat, people, admits_own_user, identity, hosts, limits, framing, texts };
        let ending = Ending(&ended);
        let served = web::serve(listener, service, &over).map_err(DialogError::Serve);
        drop(ending);
        workers
            .into_iter()
            .map(|worker| worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
            .fold(served, Result::and)
    });
    served.and_then(|()| conversations.close())
}

/// Listens where the service before this one did, as open pages know it; where there was none, at that address.
fn listen(address: SocketAddr, seats: usize, before: Option<&Place>) -> Result<(TcpListener, Place), DialogError> {
    let is_as_asked = |place: &&Place| address.port() == 0 || place.address.port() == address.port();
    if let Some(place) = before.filter(|place| place.address.ip() == address.ip()).filter(is_as_asked) {
        match TcpListener::bind(place.address) {
            Ok(listener) => return Ok((listener, place.clone())),
            Err(error) => tracing::warn!("serve the page on {} again: {error}", place.address),
        }
    }
    let listener = TcpListener::bind(address).map_err(|source| DialogError::Listen { address, source })?;
    let (token, wizard) = (token::fresh().map_err(DialogError::Serve)?, token::fresh().map_err(DialogError::Serve)?);
    let seats = PersonSeats::tokens(seats).map_err(DialogError::Serve)?;
    let address = listener.local_addr().map_err(DialogError::Serve)?;
    Ok((listener, Place { address, token, wizard, seats }))
}

/// Runs one of the service's loops; if it fails or panics, all end.
fn until_ended(ended: &AtomicBool, work: impl FnOnce() -> Result<(), DialogError>) -> Result<(), DialogError> {
    let _ending = Ending(ended);
    work()
}

/// Ends all of the service's loops when it is dropped.
struct Ending<'a>(&'a AtomicBool);

impl Drop for Ending<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use std::panic::{catch_unwind, resume_unwind};

    use super::*;

    #[test]
    fn a_loop_that_panics_ends_all() {
        let ended = AtomicBool::new(false);
        let panicked = catch_unwind(|| until_ended(&ended, || resume_unwind(Box::new("as a panic does"))));
        assert!(panicked.is_err() && ended.load(Ordering::Relaxed));
    }
}
