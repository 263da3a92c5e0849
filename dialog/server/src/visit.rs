//! One page's visit: what it sends and is sent, from its first greeting to its last word.

mod controls;
mod hearing;
mod message;
mod telling;

use std::{collections::VecDeque, sync::Arc, time::Instant};

use axum::extract::ws::{Message, WebSocket};
use cohabit_bus::monotonic_nanos;
use cohabit_cdf::ObjectId;
use serde_json::Value;
use tokio::sync::{
    broadcast::{self, error::RecvError},
    mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel},
};

use crate::{
    driving::{Driver, Drivers},
    feed::Feed,
    hub::{self, Hub},
    journal::MOST_VISITORS,
    limits::{A_LOT, Limits, ServerLimits},
    page,
    person_seats::{Comer, PersonSeat},
    presence::Presence,
    spoken::Spoken,
    survey::{Form, Survey},
    talk::Talk,
    text,
    view::View,
    voice::{FromEar, Hearer, Hearing, Voice},
};
use controls::{Aim, next_news};
use hearing::next_sound;
use message::FromPage;

/// What pages of a session that goes on have to do with.
#[derive(Clone)]
pub struct Live {
    /// The conversation.
    pub talk: Arc<Talk>,
    /// Who drives.
    pub drivers: Arc<Drivers>,
    /// What people are asked.
    pub survey: Arc<Survey>,
    /// Voice.
    pub voice: Arc<Voice>,
}

/// Serves a page until it goes.
pub async fn converse(hub: Arc<Hub>, live: Live, mut socket: WebSocket, comer: Comer, server: ServerLimits) {
    let Some((first, messages, seat)) = hub.join(&server) else {
        let _ = socket.send(tell(&page::full(server.most_pages))).await;
        return;
    };
    let Some((number, answered)) = live.talk.enter(comer.key) else {
        let text = format!("{MOST_VISITORS} people have been here; for more, start another session.");
        let _ = socket.send(tell(&page::error(&text))).await;
        return;
    };
    let visitor = Entered { talk: Arc::clone(&live.talk), number, seat: comer.seat };
    for message in std::iter::once(page::you(number, &answered, comer.seat).to_string()).chain(first) {
        if socket.send(Message::text(message)).await.is_err() {
            return;
        }
    }
    let Some(view) = hub.views.first().cloned() else { return };
    Visit::new(hub, live, (seat, Presence::new(server)), view, visitor).run(socket, messages).await;
}

/// A visitor who is there while this lives.
struct Entered {
    talk: Arc<Talk>,
    number: u32,
    /// Their seat, if they have one.
    seat: Option<PersonSeat>,
}

impl Drop for Entered {
    fn drop(&mut self) {
        self.talk.leave(self.number);
    }
}

struct Visit {
    hub: Arc<Hub>,
    live: Live,
    seat: hub::Visit,
    presence: Presence,
    visitor: Entered,
    feed: Feed,
    limits: Limits,
    driver: Option<Driver>,
    aim: Aim,
    /// Where its sound goes, while it sends any.
    hearing: Option<Hearing>,
    ear: (UnboundedSender<FromEar>, UnboundedReceiver<FromEar>),
    /// What was heard and can be changed yet, each with its number.
    heard: VecDeque<(u64, Spoken)>,
    heard_count: u64,
    /// What robots say aloud, where it is wanted.
    sounds: Option<(broadcast::Receiver<Arc<Vec<u8>>>, Hearer)>,
}

/// The page is gone, or is to be.
struct Gone;

impl Visit {
    fn new(
        hub: Arc<Hub>,
        live: Live,
        (seat, presence): (hub::Visit, Presence),
        view: Arc<View>,
        visitor: Entered,
    ) -> Self {
        let now = Instant::now();
        Self {
            hub,
            live,
            seat,
            presence,
            visitor,
            feed: Feed::new(view),
            limits: Limits::new(now),
            driver: None,
            aim: Aim::new(),
            hearing: None,
            ear: unbounded_channel(),
            heard: VecDeque::new(),
            heard_count: 0,
            sounds: None,
        }
    }

    async fn run(mut self, mut socket: WebSocket, mut messages: broadcast::Receiver<Arc<str>>) {
        loop {
            // In order: what a page has sent is read before it is found to be silent.
            let answers = tokio::select! {
                biased;
                received = socket.recv() => {
                    self.presence.note_word();
                    match received {
                        Some(Ok(Message::Text(text))) => Ok(self.answer(&text)),
                        Some(Ok(Message::Binary(bytes))) => Ok(self.listen(&bytes)),
                        Some(Ok(Message::Close(_)) | Err(_)) | None => Err(Gone),
                        Some(Ok(_)) => Ok(Vec::new()),
                    }
                }
                () = self.presence.wait() => self.beat(),
                () = self.seat.given_away() => Err(Gone),
                news = next_news(&mut self.driver) => Ok(self.note(&news)),
                Some(heard) = self.ear.1.recv() => Ok(self.take_heard(heard)),
                piece = next_sound(&mut self.sounds) => Ok(vec![Message::binary(piece.to_vec())]),
                message = messages.recv() => match message {
                    Ok(message) => Ok(vec![Message::text(message.to_string())]),
                    // It fell behind: closing makes it connect again and be told all anew.
                    Err(RecvError::Lagged(_) | RecvError::Closed) => Err(Gone),
                },
                changed = self.feed.changed() => changed.map(|()| self.show()).map_err(|_| Gone),
            };
            let Ok(answers) = answers else { return };
            for answer in answers {
                if socket.send(answer).await.is_err() {
                    return;
                }
            }
        }
    }

    /// Asks the page whether it is there, and sees whether the session still answers who drives.
    fn beat(&mut self) -> Result<Vec<Message>, Gone> {
        let mut answers = vec![self.presence.ask().ok_or(Gone)?];
        if self.driver.as_ref().is_some_and(Driver::gave_up) {
            answers.extend(self.end("The session does not answer."));
        }
        Ok(answers)
    }

    /// The newest frame, and what is marked in it and in its middle.
    fn show(&mut self) -> Vec<Message> {
        let marks = self.feed.marks(&self.hub.marked());
        self.feed.frame().into_iter().chain(marks).chain(self.look(false)).collect()
    }

    /// What a page gets at once for what it sent; what else comes of it comes by the hub.
    fn answer(&mut self, text: &str) -> Vec<Message> {
        match self.take(text) {
            Ok(answers) => answers,
            Err(problem) => vec![tell(&page::error(&problem))],
        }
    }

    /// Takes a message of the page; says what is wrong with it, if anything.
    fn take(&mut self, text: &str) -> Result<Vec<Message>, String> {
        let (received_nanos, now) = (monotonic_nanos(), Instant::now());
        let a_lot = || A_LOT.to_owned();
        if !self.limits.all.admits(now) {
            return Err(a_lot());
        }
        let message: FromPage =
            serde_json::from_str(text).map_err(|error| format!("The page sent nonsense: {error}"))?;
        self.seat.note_word();
        if let FromPage::Drive { forward_m_s, turn_rad_s, pitch_rad_s } = message {
            // One too many is left out: the next one says all anew.
            return if self.limits.drives.admits(now) {
                self.drive([forward_m_s, turn_rad_s, pitch_rad_s])
            } else {
                Ok(Vec::new())
            };
        }
        if let FromPage::Typing { text } = message {
            let text = text::in_one_line(text.trim());
            if text::is_within_limit(&text) && self.limits.drafts.admits(now) {
                self.live.talk.note_draft(&text, self.visitor());
            }
            return Ok(Vec::new());
        }
        if !self.limits.others.admits(now) {
            return Err(a_lot());
        }
        match message {
            FromPage::Shown => self.hub.note_shown(),
            FromPage::Drawn { turn } => self.note_drawn(turn, received_nanos)?,
            FromPage::View { camera } => self.look_through(&camera)?,
            FromPage::Point { camera, tick, x, y } => {
                return self.point(&camera, tick, [x, y], received_nanos);
            }
            FromPage::DriveBody { body } => {
                self.check_seat(body)?;
                self.driver = None;
                self.driver = Some(Driver::claim(&self.live.drivers, body)?);
            }
            FromPage::Release => self.driver = None,
            FromPage::Answer { questionnaire, answers, finished } => {
                let form = Form { questionnaire: &questionnaire, given: &answers, finished };
                return Ok(vec![self.survey(&form)]);
            }
            FromPage::Act { deed, object } => return self.act(deed, ObjectId(object)),
            FromPage::Say { text } => self.say(&text, received_nanos)?,
            FromPage::Choose { object } => self.choose(ObjectId(object), received_nanos, false)?,
            FromPage::Listen { rate, held } => self.begin_listening(rate, held)?,
            FromPage::Listened => return Ok(self.end_listening()),
            FromPage::Heard { number, text, sure } => self.say_heard(number, text, sure, received_nanos)?,
            FromPage::Aloud { on } => return Ok(self.hear_robots(on)),
            FromPage::Sounded { turn } => {
                self.live.talk.note_sounded(turn, received_nanos).map_err(|error| error.to_string())?;
            }
            FromPage::OwnVoice { text } => {
                let text = text.filter(|text| text::is_within_limit(text));
                self.live.voice.note_own_voice(text.as_deref(), received_nanos);
            }
            FromPage::Drive { .. } | FromPage::Typing { .. } => {}
        }
        Ok(Vec::new())
    }

    fn note_drawn(&self, turn: u64, received_nanos: u64) -> Result<(), String> {
        self.live.talk.note_drawn(turn, received_nanos).map_err(|error| error.to_string())
    }

    fn look_through(&mut self, camera: &str) -> Result<(), String> {
        self.feed.turn_to(Arc::clone(self.hub.view_of(camera)?));
        Ok(())
    }

    fn survey(&self, form: &Form<'_>) -> Message {
        let problem = self.live.survey.answer(self.visitor.number, form, &*self.live.talk).err();
        tell(&page::answered(form.questionnaire, problem.map(|problem| problem.to_string()).as_deref()))
    }
}

fn tell(message: &Value) -> Message {
    Message::text(message.to_string())
}
