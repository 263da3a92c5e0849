//! One page's visit: what it sends and is sent, from its first greeting to its last word.

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use axum::extract::ws::{Message, WebSocket};
use cohabit_bus::{message::Thing, monotonic_nanos};
use cohabit_cdf::{BodyId, ObjectId};
use cohabit_speech::Recognition;
use serde::Deserialize;
use serde_json::Value;
use tokio::sync::{
    broadcast::{self, error::RecvError},
    mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel},
};

use crate::{
    DialogError,
    affordances::Deed,
    driving::{Driver, News, Told},
    feed::Feed,
    hub::{self, Hub},
    journal::MOST_VISITORS,
    limits::{Limits, ServerLimits},
    page,
    presence::Presence,
    questionnaire::Given,
    robots::Visitor,
    spoken::{Reading, Spoken},
    survey::Form,
    talk::Talk,
    text,
    view::View,
    voice::{Audience, EarAt, FromEar, Hearer, Hearing},
    web::Live,
};

/// Time between two looks at what is before a driven body.
const AIM_EVERY: Duration = Duration::from_millis(90);
/// How fast a page may ask anything to move or turn, m/s and rad/s; the body's own limits are narrower.
const FASTEST: f32 = 20.0;

/// What a page sends.
#[derive(Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
enum FromPage {
    /// Somebody said something.
    Say { text: String },
    /// Somebody has typed this so far. It counts for nothing until it is said.
    Typing { text: String },
    /// The page has shown its first frame.
    Shown,
    /// The page has shown a frame in which the robot first moves as it was told to in this turn.
    Drawn { turn: u64 },
    /// Somebody wants to look through another camera.
    View { camera: String },
    /// Somebody chose one of the objects that a question offers.
    Choose { object: u32 },
    /// Somebody points at something in the picture: how far from the left and from the top, 0 to 1.
    Point { camera: String, tick: u64, x: f32, y: f32 },
    /// Somebody wants to drive a body.
    DriveBody { body: u32 },
    /// Somebody gives the body back.
    Release,
    /// The keys as they are held now, as speeds: along the heading, turning, and the head's pitch.
    Drive { forward_m_s: f32, turn_rad_s: f32, pitch_rad_s: f32 },
    /// Somebody answers a questionnaire: an answer a question; `finished`, if they say that they have done what they could
    /// of a mission that is not over.
    Answer {
        questionnaire: String,
        answers: Vec<Option<Given>>,
        #[serde(default)]
        finished: bool,
    },
    /// Somebody does something to an object with the body's hand.
    Act { deed: Deed, object: u32 },
    /// Sound comes from a microphone, as binary messages of so many 16-bit samples a second; while `held`, no pause ends what
    /// is said.
    Listen { rate: u32, held: bool },
    /// What was said is all.
    Listened,
    /// What was heard is meant, perhaps in other words, or is to be forgotten; `sure`, if somebody read it and said so.
    Heard { number: u64, text: Option<String>, sure: bool },
    /// Somebody wants to hear what robots say, or not.
    Aloud { on: bool },
    /// The page plays the first sound of an answer.
    Sounded { turn: u64 },
    /// The page says a text with its browser's voice, from now on; or no more.
    OwnVoice { text: Option<String> },
}

/// Serves a page until it goes.
pub async fn converse(hub: Arc<Hub>, live: Live, mut socket: WebSocket, key: u64, server: ServerLimits) {
    let Some((first, messages, seat)) = hub.join(&server) else {
        let _ = socket.send(tell(&page::full(server.most_pages))).await;
        return;
    };
    let Some((number, answered)) = live.talk.enter(key) else {
        let text = format!("{MOST_VISITORS} people have been here; for more, start another session.");
        let _ = socket.send(tell(&page::error(&text))).await;
        return;
    };
    let visitor = Entered { talk: Arc::clone(&live.talk), number };
    for message in std::iter::once(page::you(number, &answered).to_string()).chain(first) {
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
    /// What was heard and can be changed yet, with its number.
    heard: Option<(u64, Spoken)>,
    heard_count: u64,
    /// What robots say aloud, where it is wanted.
    sounds: Option<(broadcast::Receiver<Arc<Vec<u8>>>, Hearer)>,
}

/// What a driven body has before it, as the page was told.
struct Aim {
    told: Value,
    at: Instant,
    /// What was clicked, until the body moves on.
    picked: Option<ObjectId>,
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
        let aim = Aim { told: Value::Null, at: now, picked: None };
        Self {
            hub,
            live,
            seat,
            presence,
            visitor,
            feed: Feed::new(view),
            limits: Limits::new(now),
            driver: None,
            aim,
            hearing: None,
            ear: unbounded_channel(),
            heard: None,
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
                        Some(Ok(Message::Text(text))) => Ok(self.answer(&text).await),
                        Some(Ok(Message::Binary(bytes))) => Ok(self.listen(&bytes)),
                        Some(Ok(Message::Close(_)) | Err(_)) | None => Err(Gone),
                        Some(Ok(_)) => Ok(Vec::new()),
                    }
                }
                () = self.presence.wait() => self.beat(),
                () = self.seat.given_away() => Err(Gone),
                news = next_news(&mut self.driver) => Ok(self.note(&news)),
                Some(heard) = self.ear.1.recv() => Ok(self.take_heard(heard).await),
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

    /// What is before the driven body, if that is news.
    fn look(&mut self, at_once: bool) -> Option<Message> {
        let driver = self.driver.as_ref().filter(|driver| driver.is_driving())?;
        if !at_once && self.aim.at.elapsed() < AIM_EVERY {
            return None;
        }
        self.aim.at = Instant::now();
        let things: Vec<Thing> = match self.aim.picked {
            Some(object) => vec![Thing::Object(object)],
            None if self.feed.view().camera == driver.camera => {
                self.feed.view().ids_in_the_middle().into_iter().map(Thing::of_id).collect()
            }
            None => Vec::new(),
        };
        let aim = self.live.talk.aim(&things, driver.body()).inspect_err(|error| tracing::warn!("{error}")).ok()?;
        (aim != self.aim.told).then(|| {
            self.aim.told = aim;
            Message::text(self.aim.told.to_string())
        })
    }

    /// What the page is told of what the bus told.
    fn note(&mut self, news: &News) -> Vec<Message> {
        let Some(driver) = &mut self.driver else { return Vec::new() };
        let body = driver.body();
        match driver.note(news) {
            Ok(None) => Vec::new(),
            Ok(Some(Told::Begun)) => {
                self.aim = Aim { told: Value::Null, at: Instant::now(), picked: None };
                let begun = tell(&page::driving(Some(body), ""));
                std::iter::once(begun).chain(self.look(true)).collect()
            }
            Ok(Some(Told::Acted(ok, text))) => {
                self.aim.picked = None;
                std::iter::once(tell(&page::acted(ok, &text))).chain(self.look(true)).collect()
            }
            Ok(Some(Told::Over(text))) => self.end(&text),
            Err(error) => {
                tracing::error!("{error}");
                self.end("The session cannot be reached.")
            }
        }
    }

    /// Gives the body back, and says why.
    fn end(&mut self, why: &str) -> Vec<Message> {
        self.driver = None;
        vec![tell(&page::driving(None, why))]
    }

    /// What a page gets at once for what it sent; what else comes of it comes by the hub.
    async fn answer(&mut self, text: &str) -> Vec<Message> {
        match self.take(text).await {
            Ok(answers) => answers,
            Err(problem) => vec![tell(&page::error(&problem))],
        }
    }

    /// Takes a message of the page; says what is wrong with it, if anything.
    async fn take(&mut self, text: &str) -> Result<Vec<Message>, String> {
        let (received_nanos, now) = (monotonic_nanos(), Instant::now());
        let a_lot = || "That was a lot at once; wait a moment, please.".to_owned();
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
                return self.point(&camera, tick, [x, y], received_nanos).await;
            }
            FromPage::DriveBody { body } => {
                self.driver = None;
                self.driver = Some(Driver::claim(&self.live.drivers, body)?);
            }
            FromPage::Release => self.driver = None,
            FromPage::Answer { questionnaire, answers, finished } => {
                let form = Form { questionnaire: &questionnaire, given: &answers, finished };
                return Ok(vec![self.survey(&form)]);
            }
            FromPage::Act { deed, object } => return self.act(deed, ObjectId(object)),
            FromPage::Say { text } => self.say(&text, received_nanos).await?,
            FromPage::Choose { object } => self.choose(ObjectId(object), received_nanos).await?,
            FromPage::Listen { rate, held } => self.begin_listening(rate, held)?,
            FromPage::Listened => self.end_listening(),
            FromPage::Heard { number, text, sure } => self.say_heard(number, text, sure, received_nanos).await?,
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

    fn drive(&mut self, speeds: [f32; 3]) -> Result<Vec<Message>, String> {
        let Some(driver) = &mut self.driver else { return Ok(Vec::new()) };
        let [forward, turn, pitch] = speeds.map(|speed| speed.clamp(-FASTEST, FASTEST));
        if [forward, turn, pitch] != [0.0; 3] {
            self.aim.picked = None;
        }
        driver.drive(forward, turn, pitch).map_err(|error| error.to_string())?;
        Ok(Vec::new())
    }

    fn act(&mut self, deed: Deed, object: ObjectId) -> Result<Vec<Message>, String> {
        if let Some(driver) = &mut self.driver {
            driver.act(deed, object).map_err(|error| error.to_string())?;
        }
        Ok(Vec::new())
    }

    fn look_through(&mut self, camera: &str) -> Result<(), String> {
        self.feed.turn_to(Arc::clone(self.hub.view_of(camera)?));
        Ok(())
    }

    /// Says what somebody points at; who drives may then do something with it.
    async fn point(
        &mut self,
        camera: &str,
        tick: u64,
        place: [f32; 2],
        received_nanos: u64,
    ) -> Result<Vec<Message>, String> {
        let Some(id) = self.hub.view_of(camera)?.id_at(tick, place) else { return Ok(Vec::new()) };
        let thing = Thing::of_id(id);
        let seen = self.live.talk.seen(thing, place).map_err(|error| error.to_string())?;
        if let (Thing::Object(_) | Thing::Body(_), Some(seen)) = (thing, &seen) {
            let name = seen["name"].as_str().unwrap_or_default();
            self.live.talk.note_pointed(name, self.visitor()).map_err(|error| error.to_string())?;
        }
        if let (Thing::Object(object), Some(_)) = (thing, &self.driver) {
            self.aim.picked = Some(object);
            return Ok(self.look(true).into_iter().collect());
        }
        if let Thing::Object(object) = thing
            && self.live.talk.is_answer(object)
        {
            self.choose(object, received_nanos).await?;
        }
        Ok(seen.iter().map(tell).collect())
    }

    async fn say(&mut self, text: &str, received_nanos: u64) -> Result<(), String> {
        let text = text::in_one_line(text.trim());
        if text.is_empty() {
            return Ok(());
        }
        if !text::is_within_limit(&text) {
            return Err(format!("That is too long for me. {}", text::too_long(&text)));
        }
        let visitor = self.visitor();
        self.tell_robot(move |talk| talk.hear(&text, visitor, received_nanos)).await
    }

    /// Listens to the page's microphone from now on.
    fn begin_listening(&mut self, rate: u32, held: bool) -> Result<(), String> {
        if !self.live.voice.config.has_microphone {
            return Err("This session hears no microphone: please type.".to_owned());
        }
        if self.hearing.is_none() {
            let Live { voice, talk, .. } = &self.live;
            let at = EarAt {
                voice: Arc::clone(voice),
                talk: Arc::clone(talk) as Arc<dyn Audience>,
                visitor: self.visitor.number,
                to: self.ear.0.clone(),
            };
            self.hearing = Some(Hearing::begin(at, rate)?);
        }
        let Some(hearing) = &mut self.hearing else { return Ok(()) };
        hearing.begin_again(rate)?;
        if held {
            hearing.hold();
        }
        Ok(())
    }

    /// What was said is all. The ear stays, should more be said.
    fn end_listening(&mut self) {
        if let Some(hearing) = &self.hearing {
            hearing.finish();
        }
    }

    /// Takes a piece of sound; what cannot be listened to ends the listening, and says why.
    fn listen(&mut self, bytes: &[u8]) -> Vec<Message> {
        let (received_nanos, now) = (monotonic_nanos(), Instant::now());
        // What comes after the end, or before it was begun, was on its way.
        let Some(hearing) = &mut self.hearing else { return Vec::new() };
        let taken = if self.limits.sounds.admits(now) {
            hearing.take(bytes, received_nanos)
        } else {
            Err("The microphone sends more than can be listened to: reload the page, or type.".to_owned())
        };
        match taken {
            Ok(note) => note.map(|note| tell(&page::error(note))).into_iter().collect(),
            Err(problem) => {
                self.hearing = None;
                vec![tell(&page::error(&problem)), tell(&page::deaf())]
            }
        }
    }

    /// What the page's ear heard.
    async fn take_heard(&mut self, heard: FromEar) -> Vec<Message> {
        match heard {
            FromEar::Page(message) => vec![tell(&message)],
            FromEar::Said(spoken) => {
                let said = self.take_spoken(*spoken).await;
                said.unwrap_or_else(|problem| vec![tell(&page::error(&problem))])
            }
        }
    }

    /// Shows what was heard for a moment, if it can be changed, or has the robot hear it.
    async fn take_spoken(&mut self, spoken: Spoken) -> Result<Vec<Message>, String> {
        let edit = self.live.voice.config.edit;
        if edit.is_zero() {
            let meant_nanos = spoken.text_nanos;
            return self.say_aloud(spoken, meant_nanos).await;
        }
        let read = self.live.talk.read(&spoken, self.visitor()).map_err(|error| error.to_string())?;
        let Some(reading) = read else { return Ok(vec![tell(&page::hearing("nothing"))]) };
        self.heard_count += 1;
        let told = tell(&page::heard(self.heard_count, &reading.text, edit.as_millis()));
        self.heard = Some((self.heard_count, Spoken { settled: Some(reading), ..spoken }));
        Ok(vec![told])
    }

    async fn say_aloud(&mut self, spoken: Spoken, meant_nanos: u64) -> Result<Vec<Message>, String> {
        let (visitor, talk) = (self.visitor(), Arc::clone(&self.live.talk));
        match tokio::task::spawn_blocking(move || talk.hear_aloud(&spoken, visitor, meant_nanos)).await {
            Ok(Ok(is_heard)) => Ok(vec![tell(&page::hearing(if is_heard { "said" } else { "nothing" }))]),
            Ok(Err(error)) => {
                tracing::error!("{error}");
                Err("The robot cannot be reached.".to_owned())
            }
            Err(_) => Ok(Vec::new()),
        }
    }

    /// What was heard is meant, perhaps in other words; or is to be forgotten.
    async fn say_heard(
        &mut self,
        number: u64,
        text: Option<String>,
        sure: bool,
        received_nanos: u64,
    ) -> Result<(), String> {
        let Some((_, spoken)) = self.heard.take_if(|(heard, _)| *heard == number) else { return Ok(()) };
        if let Some(hearing) = &self.hearing {
            hearing.part();
        }
        let Some(text) = text.as_deref().map(text::in_one_line) else { return Ok(()) };
        if text.trim().is_empty() || !text::is_within_limit(&text) {
            return self.say(&text, received_nanos).await;
        }
        let shown = spoken.settled.filter(|reading| reading.text == text);
        let heard = if shown.is_some() { spoken.heard } else { Recognition::sure(text.as_str()) };
        let is_doubtful = !sure && shown.is_some_and(|reading| reading.is_doubtful);
        let spoken = Spoken { heard, settled: Some(Reading { text, is_doubtful }), ..spoken };
        self.say_aloud(spoken, received_nanos).await.map(drop)
    }

    /// Has the page hear what robots say, or not; gives what it is told of the engines.
    fn hear_robots(&mut self, on: bool) -> Vec<Message> {
        if !on {
            self.sounds = None;
        } else if self.sounds.is_none() {
            self.sounds = Some((self.hub.sounds(), self.live.voice.hearer()));
            let (voice, to) = (Arc::clone(&self.live.voice), self.ear.0.clone());
            // Opening the engines takes a second.
            std::thread::spawn(move || drop(to.send(FromEar::Page(voice.told()))));
        }
        Vec::new()
    }

    async fn choose(&mut self, object: ObjectId, received_nanos: u64) -> Result<(), String> {
        let visitor = self.visitor();
        self.tell_robot(move |talk| talk.choose(object, visitor, received_nanos)).await
    }

    fn survey(&self, form: &Form<'_>) -> Message {
        let problem = self.live.survey.answer(self.visitor.number, form, &*self.live.talk).err();
        tell(&page::answered(form.questionnaire, problem.map(|problem| problem.to_string()).as_deref()))
    }

    fn visitor(&self) -> Visitor {
        let driven = self.driver.as_ref().filter(|driver| driver.is_driving());
        Visitor { number: self.visitor.number, body: driven.map(|driver| BodyId(driver.body())) }
    }

    async fn tell_robot(
        &mut self,
        tell: impl FnOnce(&Talk) -> Result<(), DialogError> + Send + 'static,
    ) -> Result<(), String> {
        let talk = Arc::clone(&self.live.talk);
        if let Ok(Err(error)) = tokio::task::spawn_blocking(move || tell(&talk)).await {
            tracing::error!("{error}");
            return Err("The robot cannot be reached.".to_owned());
        }
        Ok(())
    }
}

fn tell(message: &Value) -> Message {
    Message::text(message.to_string())
}

/// The next piece of what robots say; pends where that is not wanted.
async fn next_sound(sounds: &mut Option<(broadcast::Receiver<Arc<Vec<u8>>>, Hearer)>) -> Arc<Vec<u8>> {
    if let Some((sounds, _)) = sounds {
        loop {
            match sounds.recv().await {
                Ok(piece) => return piece,
                // It misses some.
                Err(RecvError::Lagged(_)) => {}
                Err(RecvError::Closed) => break,
            }
        }
    }
    std::future::pending().await
}

/// The next news of who drives; pends where nobody does.
async fn next_news(driver: &mut Option<Driver>) -> News {
    if let Some(driver) = driver
        && let Some(news) = driver.news().await
    {
        return news;
    }
    std::future::pending().await
}
