//! How a page is heard, and hears: its microphone, what was made of it, and what robots say aloud.

use std::{sync::Arc, time::Instant};

use axum::extract::ws::Message;
use cohabit_bus::monotonic_nanos;
use cohabit_speech::Recognition;
use tokio::sync::broadcast::{self, error::RecvError};

use super::{Live, Visit, tell};
use crate::{
    page,
    spoken::{Reading, Spoken},
    talk::Said,
    text,
    voice::{Audience, EarAt, FromEar, Hearer, Hearing},
};

/// So much of what was heard can be changed yet; the page forgets without a word what somebody went on with.
const MOST_HEARD: usize = 8;

impl Visit {
    /// Listens to the page's microphone from now on.
    pub(super) fn begin_listening(&mut self, rate: u32, held: bool) -> Result<(), String> {
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
            hearing.hold()?;
        }
        Ok(())
    }

    /// What was said is all. The ear stays, should more be said.
    pub(super) fn end_listening(&mut self) -> Vec<Message> {
        let told = self.hearing.as_ref().map_or(Ok(()), Hearing::finish);
        told.map_or_else(|problem| self.deafen(&problem), |()| Vec::new())
    }

    /// Listens no more, and says why.
    fn deafen(&mut self, why: &str) -> Vec<Message> {
        self.hearing = None;
        vec![tell(&page::error(why)), tell(&page::deaf())]
    }

    /// Takes a piece of sound; what cannot be listened to ends the listening, and says why.
    pub(super) fn listen(&mut self, bytes: &[u8]) -> Vec<Message> {
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
            Err(problem) => self.deafen(&problem),
        }
    }

    /// What the page's ear heard.
    pub(super) fn take_heard(&mut self, heard: FromEar) -> Vec<Message> {
        match heard {
            FromEar::Page(message) => vec![tell(&message)],
            FromEar::Said(spoken) => {
                let told = self.take_spoken(spoken).err();
                told.map(|problem| tell(&page::error(&problem))).into_iter().collect()
            }
            FromEar::Shown(spoken) => vec![self.show_heard(spoken)],
        }
    }

    /// Has the robots hear what was heard, once it was shown for a moment if it can be changed.
    fn take_spoken(&self, spoken: Box<Spoken>) -> Result<(), String> {
        if self.live.voice.config.edit.is_zero() {
            let meant_nanos = spoken.text_nanos;
            self.tell_robot(Said::Aloud { spoken, meant_nanos })
        } else {
            self.tell_robot(Said::Shown(spoken))
        }
    }

    /// Shows what was heard, which can be changed for a moment.
    fn show_heard(&mut self, spoken: Option<Box<Spoken>>) -> Message {
        let Some(spoken) = spoken else { return tell(&page::hearing("nothing")) };
        self.heard_count += 1;
        let text = spoken.first().unwrap_or_default();
        let told = tell(&page::heard(self.heard_count, text, self.live.voice.config.edit.as_millis()));
        self.heard.push_back((self.heard_count, *spoken));
        if self.heard.len() > MOST_HEARD {
            self.heard.pop_front();
        }
        told
    }

    /// What was heard is meant, perhaps in other words; or is to be forgotten.
    pub(super) fn say_heard(
        &mut self,
        number: u64,
        text: Option<String>,
        sure: bool,
        received_nanos: u64,
    ) -> Result<(), String> {
        let place = self.heard.iter().position(|(heard, _)| *heard == number);
        let Some((_, spoken)) = place.and_then(|place| self.heard.remove(place)) else { return Ok(()) };
        if let Some(hearing) = &self.hearing {
            // Where it cannot be told, what is said next joins this.
            let _ = hearing.part();
        }
        let Some(text) = text.as_deref().map(text::in_one_line) else { return Ok(()) };
        if text.trim().is_empty() || !text::is_within_limit(&text) {
            return self.say(&text, received_nanos);
        }
        let shown = spoken.settled.filter(|reading| reading.text == text);
        let heard = if shown.is_some() { spoken.heard } else { Recognition::sure(text.as_str()) };
        let is_doubtful = !sure && shown.is_some_and(|reading| reading.is_doubtful);
        let spoken = Box::new(Spoken { heard, settled: Some(Reading { text, is_doubtful }), ..spoken });
        self.tell_robot(Said::Aloud { spoken, meant_nanos: received_nanos })
    }

    /// Has the page hear what robots say, or not; gives what it is told of the engines.
    pub(super) fn hear_robots(&mut self, on: bool) -> Vec<Message> {
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
}

/// The next piece of what robots say; pends where that is not wanted.
pub(super) async fn next_sound(sounds: &mut Option<(broadcast::Receiver<Arc<Vec<u8>>>, Hearer)>) -> Arc<Vec<u8>> {
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
