//! Sessions of a study: each is a `cohabit play` of its own, which ends with the study.

use std::{
    ffi::OsString,
    io::{BufRead as _, BufReader, Read},
    net::SocketAddr,
    os::unix::process::CommandExt as _,
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    sync::mpsc::{self, Receiver, TryRecvError},
    thread,
    time::{Duration, Instant},
};

use anyhow::Context as _;
use cohabit_bus::{
    BusError, Inbox, Session, Shm, Topic,
    message::{self, DialogKind, DialogView, EventKind, EventMessage, TickView},
};
use cohabit_cdf::Status;
use cohabit_dialog::{HostName, SeatState};
use cohabit_record::Log;
use cohabit_study::{Activity, Ending, Happening, Health, Look, PageAddress, Player, Playing, Wanted, address};
use rustix::process::{Pid, Signal, kill_process};

use super::{
    activities::{Activities, Doer, of_inputs, stops},
    health::HealthWatch,
    pausing::Pausing,
    ports::{Ports, Taken},
};
use crate::{terminal::shown, tls::Tls};

/// This very program, also when its file was replaced since it was started.
const THIS_PROGRAM: &str = "/proc/self/exe";
/// How long a session may take to end when asked; then its supervisor is killed, with which all of it ends.
const GRACE: Duration = Duration::from_secs(12);

/// How the pages of the study are served, and those of its sessions beside them.
pub struct Served {
    /// Where the study's own are.
    pub listening: SocketAddr,
    /// The names that both are asked for by, besides those of this machine.
    pub hosts: Vec<HostName>,
    /// What both are served with.
    pub tls: Tls,
    /// The ports of sessions; any, if absent.
    pub ports: Option<Ports>,
    /// The argument of `play` by which pages of sessions are in the language of the study's.
    pub page: String,
}

/// Starts sessions.
pub struct Sessions {
    /// Where names of files in the study start from.
    folder: PathBuf,
    served: Served,
}

impl Sessions {
    /// For a study in that folder whose pages are served there.
    pub fn new(folder: &Path, served: Served) -> anyhow::Result<Self> {
        Ok(Self { folder: folder.canonicalize().with_context(|| folder.display().to_string())?, served })
    }

    fn command(&self, wanted: &Wanted, session: &str, port: u16, point: Option<&Point>) -> Command {
        let Served { listening, hosts, tls, .. } = &self.served;
        let mut command = Command::new(THIS_PROGRAM);
        command
            .arg0("cohabit")
            .args(["play", "--session", session, "--port", &port.to_string()])
            .args(["--supervisor", &std::process::id().to_string()])
            .args(["--listen", &listening.ip().to_string()])
            .args(["--framed-by", &listening.port().to_string()])
            .args(tls.arguments())
            .arg(&self.served.page)
            .args(["--participant", &wanted.participant])
            .args((wanted.seats > 0).then(|| format!("--seats={}", wanted.seats)))
            .arg("--log")
            .arg(&wanted.log)
            // Each page has a port of its own: a name is one at any.
            .args(hosts.iter().map(|host| format!("--host={}", parts(host).0)));
        // What the log that it goes on from has.
        let world =
            |argument: &&String| ["--seed=", "--body=", "--camera="].iter().any(|flag| argument.starts_with(flag));
        match point {
            Some(point) => command.arg(&point.argument).args(wanted.arguments.iter().filter(|one| !world(one))),
            // A seed among the arguments counts, which the study gives none then.
            None if wanted.arguments.iter().any(|one| one.starts_with("--seed=")) => {
                command.args(&wanted.arguments).arg(&wanted.mission)
            }
            None => command.args(&wanted.arguments).args(["--seed", &wanted.seed.to_string(), &wanted.mission]),
        };
        command
            .current_dir(&self.folder)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            // Ctrl-C reaches the study alone, which then ends its sessions in order.
            .process_group(0);
        command
    }
}

/// A host's name, and its port if it has one.
fn parts(host: &HostName) -> (String, Option<u16>) {
    let text = host.to_string();
    let with_port = text.rsplit_once(':').and_then(|(name, port)| Some((name.to_owned(), Some(port.parse().ok()?))));
    with_port.unwrap_or((text, None))
}

impl Served {
    /// The address of the study's own pages, for people: by the first name that they are asked for by, if there is one, since
    /// that is the one of the certificate or of the proxy.
    pub fn site(&self, is_encrypted: bool) -> String {
        const HTTPS: u16 = 443;
        let Some((name, port)) = self.hosts.first().map(parts) else { return address(self.listening, is_encrypted) };
        let port = port.unwrap_or(self.listening.port());
        if is_encrypted || port == HTTPS { format!("https://{name}:{port}") } else { format!("http://{name}:{port}") }
    }
}

impl Player for Sessions {
    fn start(&mut self, wanted: &Wanted) -> Result<Box<dyn Playing>, String> {
        let session = format!("s{}-{}", std::process::id(), wanted.name);
        let point = wanted.before.iter().find_map(|log| Point::at_end_of(log));
        let port = self.served.ports.as_ref().map(|ports| ports.take(self.served.listening.ip())).transpose()?;
        let number = port.as_ref().map_or(0, Taken::number);
        let spawned = self.command(wanted, &session, number, point.as_ref()).spawn();
        let mut child = spawned.map_err(|error| format!("start a session: {error}"))?;
        let (sender, lines) = mpsc::channel();
        if let Some(out) = child.stdout.take() {
            let sender = sender.clone();
            relay(out, move |line| drop(sender.send(line)));
        }
        if let Some(errors) = child.stderr.take() {
            let name = wanted.name.clone();
            relay(errors, move |line| {
                eprintln!("{name}: {}", shown(&line));
                drop(sender.send(line));
            });
        }
        // A tutorial goes on when its goals are met, and so it does from there.
        let over = point.and_then(|point| point.over).filter(|over| !wanted.is_tutorial || *over != Ending::Complete);
        let last_line = String::new();
        Ok(Box::new(PlayedSession {
            child,
            session,
            _port: port,
            lines,
            last_line,
            page: None,
            wizard: None,
            seats: Vec::new(),
            wizards_seat: SeatState::default(),
            heard: None,
            happened: Vec::new(),
            activities: wanted.is_tutorial.then(|| Activities::new(wanted.seats as usize)),
            health: HealthWatch::default(),
            is_held: false,
            over,
            ends_by: None,
        }))
    }
}

/// Where a session goes on from.
struct Point {
    /// The argument of `play` that says so.
    argument: OsString,
    /// How its mission had ended there, if it had.
    over: Option<Ending>,
}

impl Point {
    /// The end of what a log holds, if it can be read.
    fn at_end_of(log: &Path) -> Option<Self> {
        let read = Log::open(log).ok()?;
        let tick = read.ticks.last()?.tick;
        let mut argument = OsString::from("--branch=");
        argument.push(log);
        argument.push(format!("@tick:{tick}"));
        let over = read.events.iter().find_map(|event| match event.kind.as_str() {
            "MissionComplete" => Some(Ending::Complete),
            "MissionFailed" => Some(Ending::Failed),
            _ => None,
        });
        Some(Self { argument, over })
    }
}

/// Hands on what a process says, line by line.
fn relay(out: impl Read + Send + 'static, tell: impl Fn(String) + Send + 'static) {
    thread::spawn(move || BufReader::new(out).lines().map_while(Result::ok).for_each(tell));
}

/// A session that is played.
struct PlayedSession {
    child: Child,
    session: String,
    /// The port of its page, which is nobody else's meanwhile.
    _port: Option<Taken>,
    lines: Receiver<String>,
    /// What it said last, which says why it ended.
    last_line: String,
    page: Option<PageAddress>,
    /// What lets a wizard in, once it was told.
    wizard: Option<String>,
    /// The seats of people that were told so far.
    seats: Vec<ToldSeat>,
    /// Whether somebody sits at the wizard's seat.
    wizards_seat: SeatState,
    /// What its bus tells of the world, and of what is said.
    heard: Option<Heard>,
    /// What has happened and was not asked for yet.
    happened: Vec<Happening>,
    /// What participants do, if it is a tutorial.
    activities: Option<Activities>,
    /// How well it runs.
    health: HealthWatch,
    /// Whether its world is to stand still.
    is_held: bool,
    /// How its mission had ended before it began, if it goes on from such a point.
    over: Option<Ending>,
    /// When it is killed, if it was asked to end.
    ends_by: Option<Instant>,
}

/// What a session's bus tells.
struct Heard {
    events: Inbox,
    dialog: Inbox,
    /// Whether ticks begin in time; and what bodies are commanded, which counts in tutorials alone.
    ticks: Inbox,
    pausing: Pausing,
}

impl Heard {
    fn new(bus: &Shm) -> Result<Self, BusError> {
        Ok(Self {
            events: Inbox::new(bus, Topic::Events)?,
            dialog: Inbox::new(bus, Topic::Dialog)?,
            ticks: Inbox::new(bus, Topic::Ticks)?,
            pausing: Pausing::new(bus)?,
        })
    }
}

impl PlayedSession {
    fn hear(&mut self) {
        loop {
            match self.lines.try_recv() {
                Ok(line) => {
                    self.wizard = wizards_token(&line).or_else(|| self.wizard.take());
                    if let Some(seat) = told_seat(&line) {
                        self.note_seat(seat);
                    } else if let Some(page) = page_address(&line) {
                        let seats = self.seats.iter().map(|seat| seat.token.clone()).collect();
                        self.page = Some(PageAddress { wizard: self.wizard.clone(), seats, ..page });
                    }
                    self.last_line = line;
                }
                Err(TryRecvError::Empty | TryRecvError::Disconnected) => return,
            }
        }
    }

    /// Notes a seat; it is told again when the service that gives seats is started again.
    fn note_seat(&mut self, seat: ToldSeat) {
        if let (Some(activities), Some(body)) = (&mut self.activities, seat.body) {
            activities.seat(seat.number, body);
        }
        self.seats.retain(|known| known.number != seat.number);
        self.seats.push(seat);
        self.seats.sort_by_key(|seat| seat.number);
    }

    /// How its mission has ended, if it has; what else happened is kept.
    fn ending(&mut self) -> Result<Option<Ending>, BusError> {
        if self.heard.is_none() {
            let Ok(session) = Session::new(&self.session) else { return Ok(None) };
            self.heard = Some(Heard::new(&Shm::join(&session)?)?);
        }
        let Some(Heard { events, dialog, ticks, pausing }) = &mut self.heard else { return Ok(None) };
        pausing.keep(self.is_held)?;
        let is_tutorial = self.activities.is_some();
        let ticked = |view: TickView<'_>| {
            let commanded = if is_tutorial { of_inputs(view.inputs) } else { Vec::new() };
            (view.header.wall_nanos, view.header.late_nanos, commanded)
        };
        while let Some((_, (wall_nanos, late_nanos, commanded))) =
            ticks.next(|sample| TickView::new(sample.payload()).map(ticked))?
        {
            self.health.note_tick(wall_nanos, late_nanos);
            if let Some(activities) = &mut self.activities {
                commanded.into_iter().for_each(|(doer, activity)| activities.note(doer, activity));
            }
        }
        let told = |view: DialogView<'_>| {
            let header = view.header;
            let seat = SeatState::of(header.text.as_str());
            (header.kind(), Doer::at_page(header.person), stops(view.steps), seat, header.stamps)
        };
        while let Some((_, (kind, doer, stops, seat, stamps))) =
            dialog.next(|sample| DialogView::new(sample.payload()).map(told))?
        {
            if let (Some(activities), Some(kind)) = (&mut self.activities, kind) {
                activities.hear(kind, doer, stops);
            }
            match kind {
                Some(DialogKind::Question) => self.happened.push(Happening::QuestionAsked),
                Some(DialogKind::Seat) => self.wizards_seat = seat.unwrap_or_default(),
                Some(DialogKind::Latency) => self.health.note_turn(stamps),
                _ => {}
            }
        }
        while let Some((_, event)) = events.next(|sample| message::read::<EventMessage>(sample.payload()))? {
            match event.kind() {
                Some(EventKind::MissionComplete) if self.activities.is_none() => return Ok(Some(Ending::Complete)),
                Some(EventKind::MissionFailed) => return Ok(Some(Ending::Failed)),
                Some(EventKind::GoalMet) => {
                    self.happened.push(Happening::GoalMet);
                    if let Some(activities) = &mut self.activities {
                        activities.note(Doer::All, Activity::Goal);
                    }
                }
                Some(EventKind::Outcome) if event.turn > 0 && event.status().is_some_and(Status::is_failure) => {
                    self.happened.push(Happening::ActionFailed);
                }
                _ => {}
            }
        }
        Ok(None)
    }

    fn signal(&self, signal: Signal) {
        if let Some(pid) = i32::try_from(self.child.id()).ok().and_then(Pid::from_raw) {
            let _ = kill_process(pid, signal);
        }
    }
}

/// What lets a wizard in, if a line of `play` tells of that: it comes before the page's.
fn wizards_token(line: &str) -> Option<String> {
    let (_, token) = line.strip_prefix("Wizard's seat: ")?.split_once("/wizard?token=")?;
    Some(token.to_owned())
}

/// The page that a line of `play` tells of.
fn page_address(line: &str) -> Option<PageAddress> {
    let address = line.split_whitespace().find(|word| word.starts_with("http"))?;
    let (site, token) = address.split_once("/?token=")?;
    let port = site.rsplit_once(':')?.1.parse().ok()?;
    Some(PageAddress { port, token: token.to_owned(), wizard: None, seats: Vec::new() })
}

/// A person's seat, as `play` tells of it.
#[derive(Clone, Debug, Eq, PartialEq)]
struct ToldSeat {
    /// Its number, from 1.
    number: usize,
    /// The avatar that its page drives, if there is one for it.
    body: Option<u32>,
    /// What lets its page in.
    token: String,
}

/// The seat that a line of `play` tells of, such as `Seat 1 (body 2): http://…/?token=ab`: it comes before the page.
fn told_seat(line: &str) -> Option<ToldSeat> {
    let (seat, address) = line.strip_prefix("Seat ")?.split_once(": ")?;
    let (number, body) = match seat.split_once(" (body ") {
        Some((number, body)) => (number, Some(body.strip_suffix(')')?.parse().ok()?)),
        None => (seat, None),
    };
    let (_, token) = address.split_once("/?token=")?;
    Some(ToldSeat { number: number.parse().ok()?, body, token: token.to_owned() })
}

impl Playing for PlayedSession {
    fn look(&mut self) -> Look {
        self.hear();
        match self.child.try_wait() {
            Ok(None) => {}
            Ok(Some(status)) => return Look::Gone(format!("{status}: {}", self.last_line)),
            Err(error) => return Look::Gone(error.to_string()),
        }
        if self.ends_by.is_some_and(|at| at <= Instant::now()) {
            self.signal(Signal::KILL);
        }
        let Some(page) = self.page.clone() else { return Look::Starting };
        if let Some(ending) = self.over {
            return Look::Over(ending);
        }
        match self.ending() {
            Ok(Some(ending)) => {
                self.over = Some(ending);
                Look::Over(ending)
            }
            Ok(None) => Look::Open(page),
            Err(error) => {
                eprintln!("cohabit: {}: {}", self.session, shown(error));
                self.heard = None;
                Look::Open(page)
            }
        }
    }

    fn happened(&mut self) -> Vec<Happening> {
        std::mem::take(&mut self.happened)
    }

    fn tried(&mut self, seat: usize) -> Vec<Activity> {
        self.activities.as_mut().map(|activities| activities.take(seat)).unwrap_or_default()
    }

    fn lacks_wizard(&self) -> bool {
        let has_seat = self.page.as_ref().is_some_and(|page| page.wizard.is_some());
        has_seat && self.over.is_none() && self.wizards_seat == SeatState::Empty
    }

    fn hold(&mut self, stands_still: bool) {
        self.is_held = stands_still;
    }

    fn health(&self) -> Health {
        self.health.health()
    }

    fn end(&mut self) {
        // What is left on its bus keeps it from being wiped.
        self.heard = None;
        self.signal(Signal::TERM);
        self.ends_by = Some(Instant::now() + GRACE);
    }
}

impl Drop for PlayedSession {
    fn drop(&mut self) {
        if matches!(self.child.try_wait(), Ok(None)) {
            let _ = self.child.kill();
            let _ = self.child.wait();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn people_are_told_the_name_that_the_certificate_is_for() {
        let site = |hosts: &[&str], is_encrypted: bool| {
            let hosts = hosts.iter().map(|host| host.parse().expect("a host")).collect();
            let listening = SocketAddr::from(([127, 0, 0, 1], 8700));
            Served { listening, hosts, tls: Tls::default(), ports: None, page: String::new() }.site(is_encrypted)
        };
        assert_eq!(site(&[], false), "http://127.0.0.1:8700");
        assert_eq!(site(&["study.example.org", "lab"], true), "https://study.example.org:8700");
        assert_eq!(site(&["study.example.org:443"], false), "https://study.example.org:443");
        assert_eq!(site(&["[::1]"], false), "http://[::1]:8700");
    }

    #[test]
    fn pages_are_read_from_what_play_says() {
        let page =
            |port, token: &str| Some(PageAddress { port, token: token.to_owned(), wizard: None, seats: Vec::new() });
        for (line, expected) in [
            (
                "Open http://127.0.0.1:40123/?token=ab12  (ready after 0.50 s; Ctrl-C ends the session)",
                page(40123, "ab12"),
            ),
            ("The page is back at http://[::1]:9/?token=x", page(9, "x")),
            ("Playing \"Make cereal\" (make_cereal.json)", None),
            ("see http://example.org", None),
            ("Wizard's seat: http://127.0.0.1:40123/wizard?token=cd34", None),
        ] {
            assert_eq!(page_address(line), expected, "{line}");
        }
        let seat = wizards_token("Wizard's seat: http://127.0.0.1:40123/wizard?token=cd34");
        assert_eq!((seat.as_deref(), wizards_token("Open http://127.0.0.1:9/?token=x")), (Some("cd34"), None));
        let seat = |number, body| Some(ToldSeat { number, body, token: "ef56".to_owned() });
        assert_eq!(told_seat("Seat 2 (body 3): http://[::1]:9/?token=ef56"), seat(2, Some(3)));
        assert_eq!(told_seat("Seat 1: http://127.0.0.1:9/?token=ef56"), seat(1, None));
        for other in ["Open http://127.0.0.1:9/?token=x", "Seat one: http://127.0.0.1:9/?token=x", "Seat 1"] {
            assert_eq!(told_seat(other), None, "{other}");
        }
    }
}
