//! Calls of tools, from a client's line to the answer: several may be under way at once, and nobody waits for another's.

use std::{
    sync::{
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, RecvTimeoutError, TryRecvError},
    },
    time::{Duration, Instant},
};

use cohabit_agent::{Eyes, Glance, Outcome, PeerError, ToolDeed};
use cohabit_bus::message::{DialogKind, GoalRecord};
use cohabit_cdf::{Action, ActionKind, ObjectId};
use serde_json::{Map, Value};

use crate::{
    error::BridgeError,
    limits::{ACTION_PATIENCE, CLAIM_PATIENCE, MOST_CALLS, PICTURE_PATIENCE},
    lines::Line,
    outlet::Outlet,
    peer::Peer,
    protocol::{Heard, Protocol, answer},
    said::Said,
    sight,
    things::Things,
    tools::{self, Given, INSTRUCTIONS, Kind, Tool},
};

/// How long it sleeps while calls are under way, and while none is.
const NAP: Duration = Duration::from_millis(10);
const DOZE: Duration = Duration::from_millis(100);
/// Why nothing can be done for now.
const NOWHERE: &str = "the body is between two rooms: try again in a moment";
/// The same, for ever.
const OVER: &str = "the session has ended: ask people to start one of this name again, and then this server of tools";

/// A client, and the body that it plays.
pub(crate) struct Bridge<'a> {
    peer: Peer<'a>,
    things: Things,
    tools: Vec<Tool>,
    protocol: Protocol,
    outlet: Outlet,
    waiting: Vec<Waiting>,
    /// The command of the latest action; 0 before the first.
    latest: u64,
    /// The latest action, if it was not waited for to its end.
    unanswered: Option<u64>,
}

/// A call that is under way.
struct Waiting {
    id: Value,
    until: Instant,
    wait: Wait,
}

/// What a call waits for.
enum Wait {
    /// That the body is its own, to do something then.
    Claim { command: u64, then: Action },
    /// The end of an action; then a picture, where it is one of looking.
    Action { command: u64, is_look: bool },
    /// A picture of that tick, or a later one.
    Picture { eyes: Eyes, tick: u64 },
    /// What people say from then on.
    Answer { from: u64 },
    /// That time goes by, or the action under way ends.
    Time,
}

/// What comes of a call.
enum Next {
    /// It is answered.
    Said(Said),
    /// It waits for this, so long at most.
    Waits(Wait, Duration),
}

/// What came from the client since it was last looked.
enum Came {
    Line(Line),
    Nothing,
    /// It has no more to say.
    End,
}

impl<'a> Bridge<'a> {
    /// A client that has not said anything yet, and is answered by `outlet`.
    pub fn new(peer: Peer<'a>, tells_goals: bool, outlet: Outlet) -> Self {
        let tools = tools::all(peer.catalog().table(), tells_goals);
        Self {
            things: Things::new(peer.catalog()),
            protocol: Protocol::new(tools.iter().map(Tool::json).collect(), INSTRUCTIONS.trim_end()),
            peer,
            tools,
            outlet,
            waiting: Vec::new(),
            latest: 0,
            unanswered: None,
        }
    }

    /// Takes calls, until there are no more lines, nobody reads the answers, or `stop`.
    ///
    /// # Errors
    /// [`BridgeError`].
    pub fn run(&mut self, lines: &Receiver<Line>, stop: &AtomicBool) -> Result<(), BridgeError> {
        while !stop.load(Ordering::Relaxed) {
            let came = self.next(lines)?;
            if matches!(came, Came::End) {
                break;
            }
            match self.go_on(&came) {
                Err(BridgeError::Closed) => break,
                done => done?,
            }
        }
        Ok(())
    }

    /// Lets go of the body, and waits until what was answered has been written.
    pub fn close(self) {
        let Self { peer, outlet, .. } = self;
        drop(peer);
        outlet.close();
    }

    /// The next line, if one comes soon.
    fn next(&mut self, lines: &Receiver<Line>) -> Result<Came, BridgeError> {
        if self.waiting.is_empty() {
            return Ok(match lines.recv_timeout(DOZE) {
                Ok(line) => Came::Line(line),
                Err(RecvTimeoutError::Timeout) => Came::Nothing,
                Err(RecvTimeoutError::Disconnected) => Came::End,
            });
        }
        self.peer.sleep(NAP)?;
        Ok(match lines.try_recv() {
            Ok(line) => Came::Line(line),
            Err(TryRecvError::Empty) => Came::Nothing,
            Err(TryRecvError::Disconnected) => Came::End,
        })
    }

    fn go_on(&mut self, came: &Came) -> Result<(), BridgeError> {
        // Of a session that has ended there is nothing more to take in.
        if !self.peer.is_over() {
            self.peer.take_in()?;
        }
        if let Came::Line(line) = came {
            self.hear(line)?;
        }
        self.settle()
    }

    fn hear(&mut self, line: &Line) -> Result<(), BridgeError> {
        match self.protocol.hear(line) {
            Heard::Nothing => Ok(()),
            Heard::Answer(answer) => self.outlet.send(&answer),
            Heard::Begun { answer, client } => {
                if let Some(name) = client {
                    self.peer.rename(&name);
                }
                self.outlet.send(&answer)
            }
            Heard::Cancelled(id) => self.cancel(&id),
            Heard::Call { id, name, arguments } => self.call(id, &name, &arguments),
        }
    }

    fn call(&mut self, id: Value, name: &str, arguments: &Map<String, Value>) -> Result<(), BridgeError> {
        let next = if self.waiting.len() >= MOST_CALLS {
            refused(format!("{MOST_CALLS} calls are under way already: wait until one of them is answered"))
        } else {
            self.begin(name, arguments)?
        };
        match next {
            Next::Said(said) => self.outlet.send(&answer(&id, said.json())),
            Next::Waits(wait, patience) => {
                self.waiting.push(Waiting { id, until: Instant::now() + patience, wait });
                Ok(())
            }
        }
    }

    /// The client has given a call up: what the body does about it ends.
    fn cancel(&mut self, id: &Value) -> Result<(), BridgeError> {
        let Some(at) = self.waiting.iter().position(|one| one.id == *id) else { return Ok(()) };
        let given_up = self.waiting.swap_remove(at);
        match given_up.wait {
            Wait::Action { command, .. } if self.latest == command => self.peer.act(Action::Stop).map(drop),
            _ => Ok(()),
        }
    }

    /// Takes a call up.
    fn begin(&mut self, name: &str, arguments: &Map<String, Value>) -> Result<Next, BridgeError> {
        let Some(tool) = self.tools.iter().find(|tool| tool.name == name) else {
            return Ok(refused(format!("there is no tool `{name}`")));
        };
        if self.peer.is_over() {
            return Ok(refused(OVER));
        }
        let kind = tool.kind;
        let given = match tool.read(arguments) {
            Ok(given) => given,
            Err(why) => return Ok(refused(why)),
        };
        match kind {
            Kind::Look => self.look(),
            Kind::Body(deed) => match self.action(deed, &given)? {
                Ok(action) => self.act(action),
                Err(why) => Ok(refused(why)),
            },
            Kind::PointOut => match self.object(&given)? {
                Ok(object) => self.act(Action::Highlight { object }),
                Err(why) => Ok(refused(why)),
            },
            Kind::Say => {
                self.peer.say(DialogKind::Reply, &given.words)?;
                Ok(done("Said."))
            }
            Kind::Ask => {
                let from = self.peer.heard_so_far();
                self.peer.say(DialogKind::Question, &given.words)?;
                Ok(Next::Waits(Wait::Answer { from }, seconds(given.number)))
            }
            Kind::Listen => Ok(done(told(&self.peer.take_heard()))),
            Kind::Goals => self.goals(),
            Kind::Wait => Ok(Next::Waits(Wait::Time, seconds(given.number))),
            Kind::Stop => self.act(Action::Stop),
        }
    }

    /// Has the body do something, once it is its own.
    fn act(&mut self, action: Action) -> Result<Next, BridgeError> {
        if self.peer.commands_body() {
            return self.do_now(action);
        }
        let command = self.peer.claim()?;
        Ok(Next::Waits(Wait::Claim { command, then: action }, CLAIM_PATIENCE))
    }

    fn do_now(&mut self, action: Action) -> Result<Next, BridgeError> {
        let command = self.peer.act(action)?;
        (self.latest, self.unanswered) = (command, None);
        let is_look = matches!(action, Action::LookAround);
        Ok(Next::Waits(Wait::Action { command, is_look }, ACTION_PATIENCE))
    }

    /// The action that a call means; why there is none.
    fn action(&self, deed: ToolDeed, given: &Given) -> Result<Result<Action, String>, BridgeError> {
        let number = given.number as f32;
        match deed {
            ToolDeed::Move => Ok(Ok(Action::Move { distance_m: number })),
            ToolDeed::Turn => Ok(Ok(Action::Rotate { yaw_rad: number })),
            ToolDeed::LookAround => Ok(Ok(Action::LookAround)),
            ToolDeed::Handle(ActionKind::GoTo) => {
                let Some(scene) = self.peer.scene()? else { return Ok(Err(NOWHERE.to_owned())) };
                Ok(self.things.place(&given.words, &scene).map(|target| Action::GoTo { target }))
            }
            ToolDeed::Handle(kind) => Ok(self.object(given)?.map(|object| kind.on(object))),
        }
    }

    /// The object that a call means; why there is none.
    fn object(&self, given: &Given) -> Result<Result<ObjectId, String>, BridgeError> {
        let Some(scene) = self.peer.scene()? else { return Ok(Err(NOWHERE.to_owned())) };
        Ok(self.things.object(&given.words, &scene))
    }

    fn look(&self) -> Result<Next, BridgeError> {
        let (eyes, tick) = (self.peer.open_eyes()?, self.peer.tick());
        Ok(Next::Waits(Wait::Picture { eyes, tick }, PICTURE_PATIENCE))
    }

    /// What the body sees in a picture.
    fn seen(&self, glance: &Glance) -> Result<Said, BridgeError> {
        let Some(scene) = self.peer.scene()? else { return Ok(Said::refused(NOWHERE)) };
        let (catalog, bodies) = (self.peer.catalog(), self.peer.state()?.bodies);
        let place = sight::place(catalog, &scene);
        let things = sight::things_in_sight(&self.things, catalog, &scene, bodies, glance);
        let said = Said::done(format!("{place}\n{things}"));
        Ok(match sight::picture(glance) {
            Ok(picture) => said.with_picture(picture),
            Err(error) => {
                tracing::warn!("{error}");
                said
            }
        })
    }

    fn goals(&self) -> Result<Next, BridgeError> {
        let state = self.peer.state()?;
        let (shown, hidden): (Vec<_>, Vec<_>) = state.goals.iter().partition(|goal| goal.hidden == 0);
        let mut lines: Vec<String> = shown
            .iter()
            .map(|goal: &GoalRecord| {
                format!("{}: {}", if goal.met == 1 { "met" } else { "open" }, goal.description.as_str())
            })
            .collect();
        if !hidden.is_empty() {
            lines.push(format!("and {} that are not known yet", hidden.len()));
        }
        lines.push(match state.header.ending {
            0 => "The mission goes on.".to_owned(),
            1 => "The mission is complete.".to_owned(),
            _ => "The mission has failed.".to_owned(),
        });
        Ok(done(lines.join("\n")))
    }

    /// Answers the calls whose time has come: all of them, once nobody is there who could do anything about them.
    fn settle(&mut self) -> Result<(), BridgeError> {
        let is_over = !self.waiting.is_empty() && self.peer.is_over();
        for mut one in std::mem::take(&mut self.waiting) {
            let is_late = Instant::now() >= one.until;
            let next = if is_over { Some(refused(OVER)) } else { self.progress(&mut one.wait, is_late)? };
            match next {
                Some(Next::Said(said)) => self.outlet.send(&answer(&one.id, said.json()))?,
                Some(Next::Waits(wait, patience)) => {
                    self.waiting.push(Waiting { id: one.id, until: Instant::now() + patience, wait });
                }
                None => self.waiting.push(one),
            }
        }
        Ok(())
    }

    /// What comes of a call that is under way, if anything yet; `is_late` says that it is not waited for any longer.
    fn progress(&mut self, wait: &mut Wait, is_late: bool) -> Result<Option<Next>, BridgeError> {
        match wait {
            Wait::Claim { command, then } => match self.peer.take_outcome(*command) {
                Some(outcome) if outcome.status.is_success() => self.do_now(*then).map(Some),
                Some(outcome) => Ok(Some(Next::Said(Said::of(&outcome)))),
                None => Ok(is_late.then(|| refused("the simulator does not answer: tell whoever runs the session"))),
            },
            Wait::Action { command, is_look } => match self.ended(*command) {
                Some(outcome) if *is_look && outcome.status.is_success() => self.look().map(Some),
                Some(outcome) => Ok(Some(Next::Said(Said::of(&outcome)))),
                None if is_late => {
                    self.unanswered = Some(*command);
                    let patience = ACTION_PATIENCE.as_secs();
                    let told = "`wait` tells its end, `stop` ends it";
                    Ok(Some(done(format!("It is still under way after {patience} s: {told}."))))
                }
                None => Ok(None),
            },
            Wait::Picture { eyes, tick } => match newest(eyes, *tick)? {
                Some(glance) => Ok(Some(Next::Said(self.seen(&glance)?))),
                None => Ok(is_late.then(|| refused("the camera delivers no picture: tell whoever runs it"))),
            },
            Wait::Answer { from } => {
                let said = self.peer.take_said_since(*from);
                Ok(match (said.is_empty(), is_late) {
                    (false, _) => Some(done(told(&said))),
                    (true, true) => Some(done("Nobody has answered yet: `listen` tells what is said later.")),
                    (true, false) => None,
                })
            }
            Wait::Time => {
                let ended = self.unanswered.and_then(|command| self.ended(command));
                let ended = ended.map(|outcome| Next::Said(Said::of(&outcome)));
                Ok(ended.or_else(|| is_late.then(|| done("The time has gone by."))))
            }
        }
    }

    /// What came of an action, if it has ended.
    fn ended(&mut self, command: u64) -> Option<Outcome> {
        let outcome = self.peer.take_outcome(command)?;
        if self.unanswered == Some(command) {
            self.unanswered = None;
        }
        Some(outcome)
    }
}

fn done(text: impl Into<String>) -> Next {
    Next::Said(Said::done(text))
}

fn refused(why: impl AsRef<str>) -> Next {
    Next::Said(Said::refused(why))
}

/// The newest picture of that tick or a later one, if it has come. What a peer has spoilt is passed over: another one comes soon.
fn newest(eyes: &mut Eyes, tick: u64) -> Result<Option<Glance>, BridgeError> {
    match eyes.look() {
        Err(PeerError::Malformed(_)) => Ok(None),
        looked => Ok(looked?.filter(|glance| glance.tick() >= tick)),
    }
}

/// A time that was checked to be one.
fn seconds(seconds: f64) -> Duration {
    Duration::try_from_secs_f64(seconds).unwrap_or_default()
}

/// What was said, a line each.
fn told(lines: &[String]) -> String {
    if lines.is_empty() { "Nothing was said.".to_owned() } else { lines.join("\n") }
}
