//! How a page is heard: where its sound goes, and what is told of it.
//!
//! A thread of its own listens to each page ([`listening`]), also for a stop within what is being said ([`stops`]), and
//! passes the sound on to the bus ([`microphone`]).

mod late;
mod listening;
mod microphone;
mod stops;

use std::{
    fmt::Display,
    sync::{
        Arc,
        mpsc::{SyncSender, TrySendError, sync_channel},
    },
    thread,
};

use cohabit_bus::monotonic_nanos;
use cohabit_speech::{RATE, Scene};
use serde_json::Value;
use tokio::sync::mpsc::UnboundedSender;

use super::Voice;
use crate::spoken::Spoken;

/// The most bytes of one piece of sound: a second.
const LONGEST_PIECE: usize = 2 * RATE as usize;
/// The most pieces that wait to be listened to: some come while the engines are opened.
const MOST_WAITING: usize = 256;
/// Sound that comes so much faster than it lasts is not of the rate that the page says.
const FASTEST: f64 = 1.4;
/// So much sound must have come before that is told, s.
const TOLD_AFTER_S: f64 = 3.0;

const BEHIND: &str = "I cannot listen as fast as you speak; some of that was lost.";
const TOO_MANY: &str = "I am still at what was said before: try again in a moment, or type.";

/// Where a page's sound goes. Its thread ends when this is dropped.
pub struct Hearing {
    to: SyncSender<ToEar>,
    /// When it began, and how many samples came since.
    began_nanos: u64,
    samples: u64,
    is_behind: bool,
}

/// What an ear is sent.
enum ToEar {
    /// Samples, and when they came.
    Sound(Vec<i16>, u64),
    /// A key is held: no pause ends what is said.
    Hold,
    /// It was released, or the microphone is gone: what was said is all.
    Finish,
    /// What was told last is done, or forgotten: nothing joins it.
    Part,
}

/// What is told to the visit of the page whose ear it is.
pub enum FromEar {
    /// To the page.
    Page(Value),
    /// Somebody said this.
    Said(Box<Spoken>),
    /// What they said, with the reading that is to be shown before robots hear it; nothing, if nobody seems to have said anything.
    Shown(Option<Box<Spoken>>),
}

/// Who makes sense of what an ear hears.
pub trait Audience: Send + Sync {
    /// Whether what was said so far is a whole sentence.
    fn is_whole(&self, text: &str) -> bool;

    /// Whether a robot does anything that somebody may want to stop.
    fn is_at_work(&self) -> bool;

    /// What there is to speak of, if that is other than what had this number before; with its number.
    fn likely(&self, before: u64) -> Option<(u64, Scene)>;

    /// Somebody at a page says stop.
    fn stop(&self, visitor: u32, heard_nanos: u64);
}

/// Whose ear it is.
pub struct EarAt {
    /// Voice of the session.
    pub voice: Arc<Voice>,
    /// The conversation.
    pub talk: Arc<dyn Audience>,
    /// The page's number.
    pub visitor: u32,
    /// Who is told.
    pub to: UnboundedSender<FromEar>,
}

impl Hearing {
    /// Listens to a page that sends so many samples a second.
    ///
    /// # Errors
    /// In a sentence for people, if that is another rate than is needed, or too much is listened to already.
    pub fn begin(at: EarAt, rate: u32) -> Result<Self, String> {
        check(rate)?;
        let ear = at.voice.ear().ok_or(TOO_MANY)?;
        let (to, sent) = sync_channel(MOST_WAITING);
        thread::spawn(move || {
            at.listen(&sent);
            drop(ear);
        });
        Ok(Self { to, began_nanos: monotonic_nanos(), samples: 0, is_behind: false })
    }

    /// The page sends sound again, after a while or not.
    ///
    /// # Errors
    /// As [`Hearing::begin`].
    pub fn begin_again(&mut self, rate: u32) -> Result<(), String> {
        check(rate)?;
        (self.began_nanos, self.samples) = (monotonic_nanos(), 0);
        Ok(())
    }

    /// Takes a piece of sound: 16-bit samples, little-endian. Gives what people are to be told, if anything.
    ///
    /// # Errors
    /// In a sentence for people, if it is none, and there is no use in more.
    pub fn take(&mut self, bytes: &[u8], received_nanos: u64) -> Result<Option<&'static str>, String> {
        if bytes.len() % 2 == 1 || bytes.len() > LONGEST_PIECE {
            return Err(format!(
                "The microphone sends {} bytes at once, which are no samples of 16 bits, a second at most: text still works.",
                bytes.len()
            ));
        }
        self.samples += bytes.len() as u64 / 2;
        self.check_pace(received_nanos)?;
        let samples = bytes.chunks_exact(2).map(|pair| i16::from_le_bytes([pair[0], pair[1]])).collect();
        match self.to.try_send(ToEar::Sound(samples, received_nanos)) {
            Ok(()) => {
                self.is_behind = false;
                Ok(None)
            }
            // Told once, until it has caught up.
            Err(TrySendError::Full(_)) if self.is_behind => Ok(None),
            Err(TrySendError::Full(_)) => {
                self.is_behind = true;
                Ok(Some(BEHIND))
            }
            Err(TrySendError::Disconnected(_)) => Err("I cannot hear any more: text still works.".to_owned()),
        }
    }

    /// Whether sound comes about as fast as it lasts.
    fn check_pace(&self, received_nanos: u64) -> Result<(), String> {
        let came_s = received_nanos.saturating_sub(self.began_nanos) as f64 * 1e-9;
        let lasts_s = self.samples as f64 / f64::from(RATE);
        if lasts_s > TOLD_AFTER_S && lasts_s > came_s * FASTEST + 1.0 {
            return Err(wrong_rate(format_args!("{:.0}", self.samples as f64 / came_s.max(0.1))));
        }
        Ok(())
    }

    /// A key is held.
    ///
    /// # Errors
    /// In a sentence for people, if the ear is so far behind that it cannot be told.
    pub fn hold(&self) -> Result<(), String> {
        self.tell(ToEar::Hold)
    }

    /// It is released.
    ///
    /// # Errors
    /// As [`Hearing::hold`].
    pub fn finish(&self) -> Result<(), String> {
        self.tell(ToEar::Finish)
    }

    /// What was told last is done, or forgotten: what is said next does not go on with it.
    ///
    /// # Errors
    /// As [`Hearing::hold`].
    pub fn part(&self) -> Result<(), String> {
        self.tell(ToEar::Part)
    }

    /// Never waits: whoever waited here for an ear that is behind would have all pages wait.
    fn tell(&self, what: ToEar) -> Result<(), String> {
        match self.to.try_send(what) {
            Err(TrySendError::Full(_)) => Err(BEHIND.to_owned()),
            // An ear that is gone has said why.
            Ok(()) | Err(TrySendError::Disconnected(_)) => Ok(()),
        }
    }
}

fn check(rate: u32) -> Result<(), String> {
    if rate == RATE { Ok(()) } else { Err(wrong_rate(rate)) }
}

fn wrong_rate(rate: impl Display) -> String {
    format!("The microphone sends {rate} samples a second, where {RATE} are needed: reload the page, or type.")
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
