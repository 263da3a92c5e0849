//! The visit of a wizard's page: it sees what participants' pages see, is told what is held back, and decides. It takes no number and no
//! seat from participants, so nothing that they are sent depends on it.

use std::{sync::Arc, time::Instant};

use axum::extract::ws::{Message, WebSocket};
use cohabit_bus::message::Thing;
use cohabit_cdf::BodyId;
use serde::Deserialize;
use serde_json::Value;
use tokio::sync::{
    broadcast,
    oneshot::{self, error::RecvError},
};

use crate::{
    feed::Feed,
    hub::Hub,
    limits::{A_LOT, Limits, ServerLimits},
    page,
    presence::Presence,
    talk::{Talk, UNREACHABLE},
    wizard::Decision,
};

/// What a wizard's page sends.
#[derive(Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
enum FromSeat {
    /// The page has shown its first frame.
    Shown,
    /// Somebody wants to look through another camera.
    View { camera: String },
    /// Somebody points at something in the picture: how far from the left and from the top, 0 to 1.
    Point {
        camera: String,
        tick: u64,
        x: f32,
        y: f32,
        #[serde(default)]
        body: Option<u32>,
    },
    /// Somebody points at a place on the floor plan, m, in the world.
    Floor {
        x: f32,
        y: f32,
        #[serde(default)]
        body: Option<u32>,
    },
    /// The wizard decides; of the robot of a body, if there are several.
    Decide {
        #[serde(default)]
        body: Option<u32>,
        decision: Decision,
    },
}

struct Visit {
    hub: Arc<Hub>,
    talk: Arc<Talk>,
    feed: Feed,
    limits: Limits,
    presence: Presence,
    /// When the page was told what can be done with what was clicked last.
    offered: Option<Instant>,
    /// Where comes what came of a decision that was taken, and not answered yet.
    deciding: Option<oneshot::Receiver<Decided>>,
}

/// What is wrong with a decision, if anything.
type Decided = Result<(), String>;

/// Serves a wizard's page until it goes; `seat` is what it is told of how a wizard takes part.
pub async fn decide(hub: Arc<Hub>, talk: Arc<Talk>, seat: Arc<Value>, mut socket: WebSocket, server: ServerLimits) {
    let own = hub.for_wizards();
    let (first, messages) = hub.attend();
    let held = talk.proposals().await;
    let told = std::iter::once(seat.to_string()).chain(held.iter().map(Value::to_string));
    for message in first.into_iter().chain(told) {
        if socket.send(Message::text(message)).await.is_err() {
            return;
        }
    }
    let Some(view) = hub.views.first().cloned() else { return };
    let _seated = match talk.sit_down() {
        Ok(seated) => seated,
        Err(error) => {
            tracing::error!("{error}");
            return;
        }
    };
    let feed = Feed::new(view);
    let (limits, presence) = (Limits::new(Instant::now()), Presence::new(server));
    Visit { hub, talk, feed, limits, presence, offered: None, deciding: None }.run(socket, messages, own).await;
}

impl Visit {
    async fn run(
        mut self,
        mut socket: WebSocket,
        mut messages: broadcast::Receiver<Arc<str>>,
        mut own: broadcast::Receiver<Arc<str>>,
    ) {
        loop {
            // A decision is answered before anything that follows from it is told, and before the next is taken.
            let is_deciding = self.deciding.is_some();
            let answers = tokio::select! {
                biased;
                decided = next_decided(&mut self.deciding) => self.answer_decision(decided),
                received = socket.recv(), if !is_deciding => {
                    self.presence.note_word();
                    match received {
                        Some(Ok(Message::Text(text))) => self.answer(&text),
                        Some(Ok(Message::Close(_)) | Err(_)) | None => return,
                        Some(Ok(_)) => Vec::new(),
                    }
                }
                () = self.presence.wait() => match self.presence.ask() {
                    Some(ping) => vec![ping],
                    None => return,
                },
                // A page that fell behind is closed: it connects again, and is told all anew.
                message = own.recv(), if !is_deciding => match message {
                    Ok(message) => vec![Message::text(message.to_string())],
                    Err(_) => return,
                },
                message = messages.recv(), if !is_deciding => match message {
                    Ok(message) => vec![Message::text(message.to_string())],
                    Err(_) => return,
                },
                changed = self.feed.changed() => match changed {
                    Ok(()) => self.show(),
                    Err(_) => return,
                },
            };
            for answer in answers {
                if socket.send(answer).await.is_err() {
                    return;
                }
            }
        }
    }

    /// The newest frame, and where what the robot asked about is in it, if that is news.
    fn show(&mut self) -> Vec<Message> {
        self.feed.frame().into_iter().chain(self.feed.marks(&self.hub.marked())).collect()
    }

    fn answer(&mut self, text: &str) -> Vec<Message> {
        let answers = self.take(text).unwrap_or_else(|problem| vec![page::error(&problem)]);
        answers.iter().map(|answer| Message::text(answer.to_string())).collect()
    }

    /// Takes a message of the page; says what is wrong with it, if anything.
    fn take(&mut self, text: &str) -> Result<Vec<Value>, String> {
        let now = Instant::now();
        if !self.limits.all.admits(now) || !self.limits.others.admits(now) {
            return Err(A_LOT.to_owned());
        }
        let message: FromSeat =
            serde_json::from_str(text).map_err(|error| format!("The page sent nonsense: {error}"))?;
        match message {
            FromSeat::Shown => Ok(Vec::new()),
            FromSeat::View { camera } => {
                self.feed.turn_to(Arc::clone(self.hub.view_of(&camera)?));
                Ok(Vec::new())
            }
            FromSeat::Point { camera, tick, x, y, body } => {
                let view = self.hub.view_of(&camera)?;
                let Some(id) = view.id_at(tick, [x, y]) else { return Ok(Vec::new()) };
                let (thing, floor_m) = (Thing::of_id(id), view.floor_at(tick, [x, y]));
                let seen = self.talk.seen(thing, [x, y]).map_err(|error| error.to_string())?;
                let menu = self.talk.menu(body.map(BodyId), thing, floor_m).map_err(|error| error.to_string())?;
                self.offered = menu.is_some().then_some(now);
                Ok(seen.into_iter().chain(menu).collect())
            }
            FromSeat::Floor { x, y, body } => {
                let menu = self.talk.floor_menu(body.map(BodyId), [x, y]).map_err(|error| error.to_string())?;
                self.offered = menu.is_some().then_some(now);
                Ok(menu.into_iter().collect())
            }
            FromSeat::Decide { body, decision } => {
                let decision = self.timed(decision, now);
                self.deciding = Some(self.talk.decide(body.map(BodyId), decision)?);
                Ok(Vec::new())
            }
        }
    }

    /// A decision with how long its choice took, if it is one of those that were offered last.
    fn timed(&mut self, decision: Decision, now: Instant) -> Decision {
        match decision {
            Decision::Click { turn, click, .. } if click.is_of_menu() => {
                let chosen_ms = self.offered.take().map(|offered| (now - offered).as_secs_f64() * 1000.0);
                Decision::Click { turn, click, chosen_ms }
            }
            other => other,
        }
    }

    fn answer_decision(&mut self, decided: Result<Decided, RecvError>) -> Vec<Message> {
        self.deciding = None;
        let answer = match decided {
            Ok(decided) => page::decided(decided.err().as_deref()),
            Err(_) => page::error(UNREACHABLE),
        };
        vec![Message::text(answer.to_string())]
    }
}

/// What came of the decision that was taken; pends where none was.
async fn next_decided(deciding: &mut Option<oneshot::Receiver<Decided>>) -> Result<Decided, RecvError> {
    match deciding {
        Some(decided) => decided.await,
        None => std::future::pending().await,
    }
}
