//! The visit of a wizard's page: it sees what participants' pages see, is told what is held back, and decides. It takes no number and no
//! seat from participants, so nothing that they are sent depends on it.

use std::{sync::Arc, time::Instant};

use axum::extract::ws::{Message, WebSocket};
use cohabit_bus::message::Thing;
use cohabit_cdf::BodyId;
use serde::Deserialize;
use serde_json::Value;
use tokio::sync::broadcast;

use crate::{
    feed::Feed,
    hub::Hub,
    limits::{Limits, ServerLimits},
    page,
    presence::Presence,
    talk::Talk,
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
    Point { camera: String, tick: u64, x: f32, y: f32 },
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
}

/// Serves a wizard's page until it goes; `seat` is what it is told of how a wizard takes part.
pub async fn decide(hub: Arc<Hub>, talk: Arc<Talk>, seat: Arc<Value>, mut socket: WebSocket, server: ServerLimits) {
    let own = hub.for_wizards();
    let (first, messages) = hub.attend();
    let held = talk.proposals();
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
    Visit { hub, talk, feed, limits, presence }.run(socket, messages, own).await;
}

impl Visit {
    async fn run(
        mut self,
        mut socket: WebSocket,
        mut messages: broadcast::Receiver<Arc<str>>,
        mut own: broadcast::Receiver<Arc<str>>,
    ) {
        loop {
            let answers = tokio::select! {
                biased;
                received = socket.recv() => {
                    self.presence.note_word();
                    match received {
                        Some(Ok(Message::Text(text))) => self.answer(&text).await.into_iter().collect(),
                        Some(Ok(Message::Close(_)) | Err(_)) | None => return,
                        Some(Ok(_)) => Vec::new(),
                    }
                }
                () = self.presence.wait() => match self.presence.ask() {
                    Some(ping) => vec![ping],
                    None => return,
                },
                // A page that fell behind is closed: it connects again, and is told all anew.
                message = own.recv() => match message {
                    Ok(message) => vec![Message::text(message.to_string())],
                    Err(_) => return,
                },
                message = messages.recv() => match message {
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

    async fn answer(&mut self, text: &str) -> Option<Message> {
        let answer = self.take(text).await.unwrap_or_else(|problem| Some(page::error(&problem)))?;
        Some(Message::text(answer.to_string()))
    }

    /// Takes a message of the page; says what is wrong with it, if anything.
    async fn take(&mut self, text: &str) -> Result<Option<Value>, String> {
        let now = Instant::now();
        if !self.limits.all.admits(now) || !self.limits.others.admits(now) {
            return Err("That was a lot at once; wait a moment, please.".to_owned());
        }
        let message: FromSeat =
            serde_json::from_str(text).map_err(|error| format!("The page sent nonsense: {error}"))?;
        match message {
            FromSeat::Shown => Ok(None),
            FromSeat::View { camera } => {
                self.feed.turn_to(Arc::clone(self.hub.view_of(&camera)?));
                Ok(None)
            }
            FromSeat::Point { camera, tick, x, y } => {
                let Some(id) = self.hub.view_of(&camera)?.id_at(tick, [x, y]) else { return Ok(None) };
                self.talk.seen(Thing::of_id(id), [x, y]).map_err(|error| error.to_string())
            }
            FromSeat::Decide { body, decision } => self.decide(body.map(BodyId), decision).await.map(Some),
        }
    }

    /// What is understood takes its time, so that is done where nothing waits for it.
    async fn decide(&self, body: Option<BodyId>, decision: Decision) -> Result<Value, String> {
        let talk = Arc::clone(&self.talk);
        match tokio::task::spawn_blocking(move || talk.decide(body, decision)).await {
            Ok(Ok(decided)) => Ok(page::decided(decided.err().as_deref())),
            Ok(Err(error)) => {
                tracing::error!("{error}");
                Err("The robot cannot be reached.".to_owned())
            }
            Err(_) => Err("The robot did not answer.".to_owned()),
        }
    }
}
