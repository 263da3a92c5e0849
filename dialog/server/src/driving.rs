//! People at the controls: each page that drives a body commands it in its own name, and gives it back when it leaves.
//!
//! Who commands a body is ruled by the simulator alone; what it says comes back as news.

use std::{
    collections::BTreeSet,
    fmt,
    str::FromStr,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
    time::{Duration, Instant},
};

use cohabit_bus::{
    BusError, CameraId, Publisher, Topic, Transport,
    message::{BodyRecord, CommandKind, CommandMessage, EventKind, EventMessage},
    monotonic_nanos,
};
use cohabit_cdf::{Action, BodyKind, ObjectId, Status};
use tokio::sync::broadcast;

use crate::affordances::{Deed, addressed};

/// News kept for a page that is slow; each page that drives makes a few a second.
const NEWS_KEPT: usize = 512;
/// What kind of peer the others are told that a page is.
const PEER: &str = "page";
/// How long an answer to a claim is waited for.
const CLAIM_PATIENCE: Duration = Duration::from_secs(5);
/// How the simulator ends the refusal of a claim of a body that somebody else commands.
const TAKEN: &str = "it has to be taken over";
/// How long a deed may take before the keys move the body again.
const DEED_PATIENCE: Duration = Duration::from_secs(8);

/// Which bodies people may drive from the page.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum Drivable {
    /// The avatars of people.
    #[default]
    People,
    /// Robots too: their own minds wait until they are given back.
    All,
    /// None.
    None,
}

impl Drivable {
    const ALL: [Self; 3] = [Self::People, Self::All, Self::None];

    const fn name(self) -> &'static str {
        match self {
            Self::People => "people",
            Self::All => "all",
            Self::None => "none",
        }
    }

    const fn includes(self, kind: BodyKind) -> bool {
        match self {
            Self::People => matches!(kind, BodyKind::Person),
            Self::All => true,
            Self::None => false,
        }
    }
}

impl fmt::Display for Drivable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// There is no such choice of bodies.
#[derive(Debug, thiserror::Error)]
#[error("`{0}` is none of `people`, `all` and `none`")]
pub struct NotDrivable(String);

impl FromStr for Drivable {
    type Err = NotDrivable;

    fn from_str(text: &str) -> Result<Self, NotDrivable> {
        Self::ALL.into_iter().find(|one| one.name() == text).ok_or_else(|| NotDrivable(text.to_owned()))
    }
}

/// A body that people may drive.
#[derive(Clone, Debug)]
pub struct DrivableBody {
    /// Its number.
    pub body: u32,
    /// What people call it.
    pub name: String,
    /// The camera in its head, for people.
    pub camera: CameraId,
}

/// What the bus told that may concern somebody who drives.
#[derive(Clone, Debug)]
pub struct News {
    kind: EventKind,
    command: u64,
    body: u32,
    number: i64,
    status: Option<Status>,
    text: String,
}

/// Who drives, of all pages of a service, and what they may drive.
pub struct Drivers {
    bus: Arc<dyn Transport>,
    drivable: Drivable,
    bodies: Vec<DrivableBody>,
    driven: Mutex<BTreeSet<u32>>,
    news: broadcast::Sender<News>,
    next_command: AtomicU64,
}

impl Drivers {
    /// Nobody drives yet any of `bodies`, of which those may be driven that `drivable` includes.
    pub fn new(bus: Arc<dyn Transport>, drivable: Drivable, bodies: &[BodyRecord], names: &[String]) -> Self {
        let may = |record: &BodyRecord| record.kind().is_some_and(|kind| drivable.includes(kind));
        let bodies = bodies.iter().zip(names).filter(|(record, _)| may(record)).filter_map(|(record, name)| {
            let camera = CameraId::Eyes(u8::try_from(record.body).ok()?);
            Some(DrivableBody { body: record.body, name: name.clone(), camera })
        });
        Self {
            bodies: bodies.collect(),
            bus,
            drivable,
            driven: Mutex::default(),
            news: broadcast::Sender::new(NEWS_KEPT),
            next_command: AtomicU64::new(first_command()),
        }
    }

    /// The bodies that people may drive.
    pub fn bodies(&self) -> &[DrivableBody] {
        &self.bodies
    }

    /// Those that somebody drives now, in the order of their numbers.
    pub fn driven(&self) -> Vec<u32> {
        self.lock().iter().copied().collect()
    }

    /// Passes on what the bus told to those that drive.
    pub fn note(&self, event: &EventMessage) {
        let Some(kind @ (EventKind::Outcome | EventKind::Commander)) = event.kind() else { return };
        if self.news.receiver_count() > 0 {
            let text = event.text.as_str().to_owned();
            let EventMessage { command, body, number, .. } = *event;
            let _ = self.news.send(News { kind, command, body, number, status: event.status(), text });
        }
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, BTreeSet<u32>> {
        self.driven.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A number unlike that of other commanders, in the upper bits of what JSON can hold exactly.
fn first_command() -> u64 {
    let mixed = monotonic_nanos() ^ (u64::from(std::process::id()) << 7) ^ 0x5_5555;
    (mixed & 0xf_ffff) << 32
}

/// The one place at a body's controls; free again when it is dropped.
struct Seat {
    drivers: Arc<Drivers>,
    body: u32,
}

impl Drop for Seat {
    fn drop(&mut self) {
        self.drivers.lock().remove(&self.body);
    }
}

/// How somebody stands with the body they drive.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Phase {
    /// Asked for it, by this command.
    Claiming { command: u64, since: Instant, takes_over: bool },
    /// Commands it.
    Driving,
}

/// What comes of news for who drives.
#[derive(Clone, Debug, PartialEq)]
pub enum Told {
    /// The body is theirs.
    Begun,
    /// A deed came to its end: whether it was done, and a sentence.
    Acted(bool, String),
    /// The body is not, or no longer, theirs; why.
    Over(String),
}

/// A page at the controls of a body. Dropping it gives the body back.
pub struct Driver {
    seat: Seat,
    name: String,
    /// The camera in the body's head.
    pub camera: CameraId,
    commands: Box<dyn Publisher>,
    news: broadcast::Receiver<News>,
    phase: Phase,
    /// The deed under way, during which the keys rest.
    acting: Option<(u64, Instant)>,
}

impl Driver {
    /// Asks for a body; an answer comes as news. Says why not, where that is known at once.
    pub fn claim(drivers: &Arc<Drivers>, body: u32) -> Result<Self, String> {
        let known = drivers.bodies.iter().find(|one| one.body == body);
        let known = known.ok_or_else(|| "Nobody may drive that here.".to_owned())?;
        if !drivers.lock().insert(body) {
            return Err(format!("Somebody else drives {} already.", known.name));
        }
        let seat = Seat { drivers: Arc::clone(drivers), body };
        let failed = |error: BusError| {
            tracing::error!("{error}");
            "The session cannot be reached.".to_owned()
        };
        let mut driver = Self {
            commands: drivers.bus.publisher(Topic::Commands).map_err(failed)?,
            news: drivers.news.subscribe(),
            seat,
            name: known.name.clone(),
            camera: known.camera,
            phase: Phase::Driving,
            acting: None,
        };
        driver.ask(false).map_err(failed)?;
        Ok(driver)
    }

    /// The body.
    pub const fn body(&self) -> u32 {
        self.seat.body
    }

    /// Whether the body is theirs.
    pub fn is_driving(&self) -> bool {
        self.phase == Phase::Driving
    }

    /// The next news; pends for ever if there is none.
    pub async fn news(&mut self) -> Option<News> {
        loop {
            match self.news.recv().await {
                Ok(news) => return Some(news),
                // What was missed is outlived by the patience of who waits for it.
                Err(broadcast::error::RecvError::Lagged(_)) => {}
                Err(broadcast::error::RecvError::Closed) => return None,
            }
        }
    }

    /// Moves the body as held keys ask, unless its hand is at work.
    pub fn drive(&mut self, forward_m_s: f32, turn_rad_s: f32, pitch_rad_s: f32) -> Result<(), BusError> {
        let at_work = self.acting.is_some_and(|(_, since)| since.elapsed() < DEED_PATIENCE);
        if self.is_driving() && !at_work {
            self.acting = None;
            self.act_on(Action::Drive { forward_m_s, turn_rad_s, pitch_rad_s })?;
        }
        Ok(())
    }

    /// Does something to an object.
    pub fn act(&mut self, deed: Deed, object: ObjectId) -> Result<(), BusError> {
        // Pages walk by keys.
        if self.is_driving() && deed != Deed::GoTo {
            let command = self.act_on(deed.on(object))?;
            self.acting = Some((command, Instant::now()));
        }
        Ok(())
    }

    /// What news mean to them, if anything.
    pub fn note(&mut self, news: &News) -> Result<Option<Told>, BusError> {
        if news.kind == EventKind::Commander {
            return Ok(self.note_commander(news));
        }
        let success = news.status.is_some_and(Status::is_success);
        if let Phase::Claiming { command, takes_over, .. } = self.phase
            && command == news.command
        {
            if success {
                self.phase = Phase::Driving;
                return Ok(Some(Told::Begun));
            }
            // Whose own mind commands it gives way where the session lets people drive everybody.
            if self.seat.drivers.drivable == Drivable::All && !takes_over {
                self.ask(true)?;
                return Ok(None);
            }
            return Ok(Some(Told::Over(self.refused(&news.text))));
        }
        if self.acting.is_some_and(|(command, _)| command == news.command) {
            self.acting = None;
            let text =
                if news.status == Some(Status::Interrupted) { "Stopped.".to_owned() } else { addressed(&news.text) };
            return Ok(Some(Told::Acted(success, text)));
        }
        Ok(None)
    }

    /// Why the body is not theirs, for people: where a mind of its own keeps it, also what lets people take it over.
    fn refused(&self, text: &str) -> String {
        if text.ends_with(TAKEN) {
            let remedy = "in a session with `--drive all` people can take it over";
            return format!("A program of the session moves {} and does not hand it over: {remedy}.", self.name);
        }
        addressed(text)
    }

    /// The body changed hands.
    fn note_commander(&self, news: &News) -> Option<Told> {
        let lost = self.is_driving() && news.body == self.body() && news.number as u64 != self.commands.run();
        lost.then(|| Told::Over(format!("You no longer drive {}: {}.", self.name, news.text)))
    }

    /// Whether an answer is overdue.
    pub fn gave_up(&self) -> bool {
        matches!(self.phase, Phase::Claiming { since, .. } if since.elapsed() > CLAIM_PATIENCE)
    }

    fn ask(&mut self, takes_over: bool) -> Result<(), BusError> {
        let command = self.next_command();
        self.send(&CommandMessage::claim(command, self.body(), PEER, takes_over))?;
        self.phase = Phase::Claiming { command, since: Instant::now(), takes_over };
        Ok(())
    }

    fn act_on(&mut self, action: Action) -> Result<u64, BusError> {
        let command = self.next_command();
        self.send(&CommandMessage::act(command, 0, self.body(), action))?;
        Ok(command)
    }

    fn next_command(&self) -> u64 {
        self.seat.drivers.next_command.fetch_add(1, Ordering::Relaxed)
    }

    fn send(&mut self, message: &CommandMessage) -> Result<(), BusError> {
        self.commands.send_record(0, message).map(drop)
    }
}

impl Drop for Driver {
    fn drop(&mut self) {
        if let Err(error) = self.send(&CommandMessage::new(CommandKind::Release, self.body())) {
            tracing::warn!("{} was not given back: {error}", self.name);
        }
    }
}

#[cfg(test)]
mod tests {
    use cohabit_bus::{Local, Subscriber, message};

    use super::*;

    /// A robot and two people, and what the simulator hears.
    fn session(drivable: Drivable) -> (Arc<Drivers>, Box<dyn Subscriber>) {
        let bus = Arc::new(Local::new(1));
        let heard = bus.subscriber(Topic::Commands).unwrap();
        let kinds = [BodyKind::Robot, BodyKind::Person, BodyKind::Person];
        let bodies =
            (0..).zip(kinds).map(|(body, kind)| BodyRecord { body, kind: kind as u32, ..BodyRecord::default() });
        let bodies: Vec<BodyRecord> = bodies.collect();
        let names = crate::page::body_names(&bodies, &std::collections::BTreeMap::new());
        (Arc::new(Drivers::new(bus, drivable, &bodies, &names)), heard)
    }

    fn hear(heard: &mut dyn Subscriber) -> Option<CommandMessage> {
        let sample = heard.receive().unwrap()?;
        Some(message::read(sample.payload()).unwrap())
    }

    fn outcome(command: u64, status: Status) -> News {
        let text = "the agent commands body 1".to_owned();
        News { kind: EventKind::Outcome, command, body: 1, number: 0, status: Some(status), text }
    }

    /// Somebody who drives body 1.
    fn driver(drivers: &Arc<Drivers>, heard: &mut dyn Subscriber) -> Driver {
        let mut driver = Driver::claim(drivers, 1).unwrap();
        let claim = hear(heard).unwrap();
        assert_eq!((claim.kind(), claim.body, claim.peer().as_str()), (Ok(CommandKind::Claim), 1, PEER));
        let news = outcome(claim.command, Status::ActionSuccessful);
        assert_eq!(driver.note(&news).unwrap(), Some(Told::Begun));
        driver
    }

    #[test]
    fn the_session_says_who_may_be_driven() {
        let names = |drivable| session(drivable).0.bodies().iter().map(|one| one.name.clone()).collect::<Vec<_>>();
        assert_eq!(names(Drivable::People), ["person 1", "person 2"]);
        assert_eq!(names(Drivable::All), ["robot", "person 1", "person 2"]);
        assert!(names(Drivable::None).is_empty());
        let (drivers, _heard) = session(Drivable::People);
        assert!(Driver::claim(&drivers, 0).is_err() && Driver::claim(&drivers, 9).is_err());
        for one in Drivable::ALL {
            assert_eq!(one.to_string().parse::<Drivable>().unwrap(), one);
        }
        assert!("everybody".parse::<Drivable>().is_err());
    }

    #[test]
    fn a_body_is_claimed_driven_and_given_back() {
        let (drivers, mut heard) = session(Drivable::People);
        let mut driver = driver(&drivers, &mut *heard);
        let refused = Driver::claim(&drivers, 1).err().unwrap();
        assert!(refused.contains("person 1") && drivers.driven() == [1], "{refused}");
        driver.drive(1.0, 0.5, 0.0).unwrap();
        let told = Action::try_from(hear(&mut *heard).unwrap().action).unwrap();
        assert_eq!(told, Action::Drive { forward_m_s: 1.0, turn_rad_s: 0.5, pitch_rad_s: 0.0 });
        drop(driver);
        assert_eq!(hear(&mut *heard).unwrap().kind(), Ok(CommandKind::Release));
        assert!(drivers.driven().is_empty());
    }

    #[test]
    fn keys_rest_while_the_hand_works() {
        let (drivers, mut heard) = session(Drivable::People);
        let mut driver = driver(&drivers, &mut *heard);
        driver.act(Deed::PickUp, ObjectId(7)).unwrap();
        let deed = hear(&mut *heard).unwrap();
        driver.drive(1.0, 0.0, 0.0).unwrap();
        assert_eq!(hear(&mut *heard), None);
        assert_eq!(
            driver.note(&outcome(deed.command + 100, Status::ActionSuccessful)).unwrap(),
            None,
            "of another one"
        );
        let told = driver.note(&outcome(deed.command, Status::TargetOutOfRange)).unwrap();
        assert_eq!(told, Some(Told::Acted(false, "The agent commands body 1".to_owned())));
        driver.drive(1.0, 0.0, 0.0).unwrap();
        assert!(hear(&mut *heard).is_some());
    }

    #[test]
    fn minds_give_way_where_all_may_be_driven() {
        for drivable in [Drivable::People, Drivable::All] {
            let (drivers, mut heard) = session(drivable);
            let mut driver = Driver::claim(&drivers, 1).unwrap();
            let claim = hear(&mut *heard).unwrap();
            let told = driver.note(&outcome(claim.command, Status::InvalidCommand)).unwrap();
            let Some(again) = hear(&mut *heard) else {
                assert!(drivable == Drivable::People && matches!(told, Some(Told::Over(_))), "{told:?}");
                continue;
            };
            assert_eq!((drivable, told, again.kind()), (Drivable::All, None, Ok(CommandKind::TakeOver)));
            // Refused again, it gives up.
            let told = driver.note(&outcome(again.command, Status::InvalidCommand)).unwrap();
            assert!(matches!(told, Some(Told::Over(_))), "{told:?}");
        }
    }

    #[test]
    fn who_may_not_take_a_body_from_a_mind_is_told_what_would_let_them() {
        let (drivers, mut heard) = session(Drivable::People);
        let mut driver = Driver::claim(&drivers, 1).unwrap();
        let claim = hear(&mut *heard).unwrap();
        let text = "the pedestrians commands body 1: it has to be taken over".to_owned();
        let refused = News { text, ..outcome(claim.command, Status::InvalidCommand) };
        let Some(Told::Over(why)) = driver.note(&refused).unwrap() else { panic!("it is refused") };
        assert!(why.contains("person 1") && why.contains("`--drive all`") && !why.contains("body 1"), "{why}");
    }

    #[test]
    fn whose_body_is_taken_hears_of_it() {
        let (drivers, mut heard) = session(Drivable::People);
        let mut driver = driver(&drivers, &mut *heard);
        let run = driver.commands.run();
        let changed = |number: u64| News {
            kind: EventKind::Commander,
            number: number as i64,
            ..outcome(0, Status::ActionSuccessful)
        };
        assert_eq!(driver.note(&changed(run)).unwrap(), None);
        assert!(matches!(driver.note(&changed(run + 1)).unwrap(), Some(Told::Over(_))));
    }
}
