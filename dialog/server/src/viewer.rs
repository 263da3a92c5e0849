//! One page's visit to a recorded session: it looks, points, and says where to go.

use std::{sync::Arc, time::Instant};

use axum::extract::ws::{Message, WebSocket};
use cohabit_bus::message::{Control, Thing};
use serde::Deserialize;
use tokio::sync::broadcast;

use crate::{
    feed::Feed,
    hub::{Hub, Visit},
    limits::{A_LOT, Limits, ServerLimits},
    page,
    presence::Presence,
    screening::Screening,
};

/// What a page sends.
#[derive(Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
enum FromPage {
    /// The page has shown its first frame.
    Shown,
    /// Somebody wants to look through another camera.
    View { camera: String },
    /// Somebody points at something in the picture: how far from the left and from the top, 0 to 1.
    Point { camera: String, tick: u64, x: f32, y: f32 },
    /// It is to stand still.
    Pause,
    /// It is to go on.
    Resume,
    /// It is to go so many times as fast as it was played.
    Speed { factor: f32 },
    /// It is to go to this tick.
    Seek { tick: u32 },
}

struct Viewer {
    hub: Arc<Hub>,
    screening: Arc<Screening>,
    feed: Feed,
    limits: Limits,
    visit: Visit,
    presence: Presence,
}

/// Serves a page until it goes.
pub async fn watch(hub: Arc<Hub>, screening: Arc<Screening>, mut socket: WebSocket, server: ServerLimits) {
    let Some((first, messages, visit)) = hub.join(&server) else {
        let _ = socket.send(Message::text(page::full(server.most_pages).to_string())).await;
        return;
    };
    for message in first {
        if socket.send(Message::text(message)).await.is_err() {
            return;
        }
    }
    let Some(view) = hub.views.first().cloned() else { return };
    let feed = Feed::new(view);
    let (limits, presence) = (Limits::new(Instant::now()), Presence::new(server));
    Viewer { hub, screening, feed, limits, visit, presence }.run(socket, messages).await;
}

impl Viewer {
    async fn run(mut self, mut socket: WebSocket, mut messages: broadcast::Receiver<Arc<str>>) {
        loop {
            let answers = tokio::select! {
                biased;
                received = socket.recv() => {
                    self.presence.note_word();
                    match received {
                        Some(Ok(Message::Text(text))) => self.answer(&text).into_iter().collect(),
                        Some(Ok(Message::Close(_)) | Err(_)) | None => return,
                        Some(Ok(_)) => Vec::new(),
                    }
                }
                () = self.presence.wait() => match self.presence.ask() {
                    Some(ping) => vec![ping],
                    None => return,
                },
                () = self.visit.given_away() => return,
                message = messages.recv() => match message {
                    Ok(message) => vec![Message::text(message.to_string())],
                    // It fell behind: closing makes it connect again and be told all anew.
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

    fn answer(&mut self, text: &str) -> Option<Message> {
        let answer = self.take(text).unwrap_or_else(|problem| Some(page::error(&problem)))?;
        Some(Message::text(answer.to_string()))
    }

    /// Takes a message of the page; says what is wrong with it, if anything.
    fn take(&mut self, text: &str) -> Result<Option<serde_json::Value>, String> {
        if !self.limits.all.admits(Instant::now()) {
            return Err(A_LOT.to_owned());
        }
        let message: FromPage =
            serde_json::from_str(text).map_err(|error| format!("The page sent nonsense: {error}"))?;
        self.visit.note_word();
        match message {
            FromPage::Shown => {
                self.hub.note_shown();
                Ok(None)
            }
            FromPage::View { camera } => {
                self.feed.turn_to(Arc::clone(self.hub.view_of(&camera)?));
                Ok(None)
            }
            FromPage::Point { camera, tick, x, y } => {
                let Some(id) = self.hub.view_of(&camera)?.id_at(tick, [x, y]) else { return Ok(None) };
                self.screening.seen(Thing::of_id(id), [x, y]).map_err(|error| error.to_string())
            }
            FromPage::Pause => self.ask(Control::Pause),
            FromPage::Resume => self.ask(Control::Resume),
            FromPage::Speed { factor } if Control::SPEEDS.contains(&factor) => self.ask(Control::Speed(factor)),
            FromPage::Speed { factor } => Err(format!("It cannot go {factor} times as fast.")),
            FromPage::Seek { tick } => self.ask(Control::Seek(tick)),
        }
    }

    fn ask(&self, control: Control) -> Result<Option<serde_json::Value>, String> {
        self.screening.ask(control).map(|()| None).map_err(|error| error.to_string())
    }
}
