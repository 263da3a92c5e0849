//! A client of a session's page: speaks its WebSocket, without a browser.

use std::{
    thread,
    time::{Duration, Instant},
};

use anyhow::{Context as _, bail};
use serde_json::{Value, json};
use tungstenite::Message;

use crate::socket::{Sender, Socket, WATCHDOG};

/// An open page.
pub struct Page {
    socket: Socket,
    /// All chat so far: who, and what.
    pub chat: Vec<(String, String)>,
    /// The newest state.
    pub state: Value,
    /// What the eyes of the body that it drives are on, and what can be done with it.
    pub aim: Value,
    /// Frames seen.
    pub frames: u64,
    /// Samples heard of what robots say.
    pub heard_samples: u64,
}

/// Binary messages that are pieces of what robots say begin with this, and so many bytes stand before their samples.
const SPEECH: u8 = 2;
const SPEECH_HEADER: usize = 24;

/// What comes to a page.
#[derive(Clone, Debug)]
pub enum Received {
    /// A message.
    Message(Value),
    /// A piece of what a robot says.
    Sound(Sound),
    /// A picture.
    Frame,
}

/// A piece of what a robot says.
#[derive(Clone, Copy, Debug)]
pub struct Sound {
    /// The turn that it answers.
    pub turn: u64,
    /// Which saying it belongs to.
    pub saying: u64,
    /// Whether it is the last piece of it.
    pub is_last: bool,
    /// How many samples it has.
    pub samples: usize,
    /// Samples a second.
    pub rate_hz: u32,
}

impl Sound {
    fn read(bytes: &[u8]) -> Option<Self> {
        let number = |at: usize| Some(u64::from_le_bytes(bytes.get(at..at + 8)?.try_into().ok()?));
        Some(Self {
            turn: number(8)?,
            saying: number(16)?,
            is_last: bytes[1] == 1,
            samples: (bytes.len() - SPEECH_HEADER) / 2,
            rate_hz: (number(0)? >> 32) as u32,
        })
    }
}

/// What sends on a page's socket, while another thread reads what comes to the page.
pub struct Pen(Sender);

impl Pen {
    /// Sends a message.
    ///
    /// # Errors
    /// When the socket is gone.
    pub fn send(&mut self, message: &Value) -> anyhow::Result<()> {
        self.0.send(Message::text(message.to_string()))
    }

    /// Sends samples of 16 kHz, as of a microphone.
    ///
    /// # Errors
    /// When the socket is gone.
    pub fn send_sound(&mut self, samples: &[i16]) -> anyhow::Result<()> {
        self.0.send(Message::binary(samples.iter().flat_map(|sample| sample.to_le_bytes()).collect::<Vec<u8>>()))
    }
}

impl Page {
    /// Opens the page at `authority`: `host:port`, and behind it `/?token=…`.
    ///
    /// # Errors
    /// When it cannot be reached.
    pub fn open(authority: &str) -> anyhow::Result<Self> {
        Self::at(authority, None)
    }

    /// The same as the page of that key, by which the session knows it again.
    ///
    /// # Errors
    /// When it cannot be reached.
    pub fn open_as(authority: &str, key: u32) -> anyhow::Result<Self> {
        Self::at(authority, Some(key))
    }

    /// Opens one anew where who served it was killed: as soon as another serves it.
    ///
    /// # Errors
    /// When nobody serves it for long.
    pub fn once_served(open: impl Fn() -> anyhow::Result<Self>) -> anyhow::Result<Self> {
        let deadline = Instant::now() + WATCHDOG;
        loop {
            match open() {
                Ok(page) => return Ok(page),
                Err(error) if Instant::now() > deadline => return Err(error),
                Err(_) => thread::park_timeout(Duration::from_millis(20)),
            }
        }
    }

    fn at(authority: &str, key: Option<u32>) -> anyhow::Result<Self> {
        let (host, token) = authority.split_once("/?token=").unwrap_or((authority, ""));
        let key = key.map(|key| format!("&visitor={key}")).unwrap_or_default();
        let socket = Socket::open(&format!("ws://{host}/ws?token={token}{key}"))?;
        Ok(Self { socket, chat: Vec::new(), state: Value::Null, aim: Value::Null, frames: 0, heard_samples: 0 })
    }

    /// Types a sentence.
    ///
    /// # Errors
    /// When the socket is gone.
    pub fn say(&mut self, text: &str) -> anyhow::Result<()> {
        self.send(&json!({ "type": "say", "text": text }))
    }

    /// Sends a message.
    ///
    /// # Errors
    /// When the socket is gone.
    pub fn send(&mut self, message: &Value) -> anyhow::Result<()> {
        self.socket.send(message)
    }

    /// Sends bytes, as of a microphone.
    ///
    /// # Errors
    /// When the socket is gone.
    pub fn send_bytes(&mut self, bytes: Vec<u8>) -> anyhow::Result<()> {
        self.socket.send_bytes(bytes)
    }

    /// Says something into the page's microphone: samples of 16 kHz, as fast as they last.
    ///
    /// # Errors
    /// When the socket is gone.
    pub fn speak(&mut self, samples: &[f32]) -> anyhow::Result<()> {
        const PIECE: usize = 1024;
        for piece in cohabit_speech::to_pcm(samples).chunks(PIECE) {
            self.send_bytes(piece.iter().flat_map(|sample| sample.to_le_bytes()).collect())?;
            std::thread::sleep(Duration::from_secs_f64(piece.len() as f64 / f64::from(cohabit_speech::RATE)));
        }
        Ok(())
    }

    /// What sends on the same socket, while another thread reads.
    ///
    /// # Errors
    /// When the socket is gone.
    pub fn pen(&self) -> anyhow::Result<Pen> {
        Ok(Pen(self.socket.sender()?))
    }

    /// The next message that is not a frame.
    ///
    /// # Errors
    /// When the socket is gone or silent for too long.
    pub fn next_message(&mut self) -> anyhow::Result<Value> {
        loop {
            if let Received::Message(message) = self.next_received()? {
                return Ok(message);
            }
        }
    }

    /// Whatever comes next.
    ///
    /// # Errors
    /// When the socket is gone or silent for too long.
    pub fn next_received(&mut self) -> anyhow::Result<Received> {
        loop {
            match self.socket.read()? {
                Message::Text(text) => {
                    let message: Value = serde_json::from_str(&text)?;
                    self.note(&message);
                    return Ok(Received::Message(message));
                }
                Message::Binary(bytes) if bytes.first() == Some(&SPEECH) => {
                    let sound = Sound::read(&bytes).context("a piece of sound that is too short")?;
                    self.heard_samples += sound.samples as u64;
                    return Ok(Received::Sound(sound));
                }
                Message::Binary(_) => {
                    self.frames += 1;
                    return Ok(Received::Frame);
                }
                Message::Close(_) => bail!("the page's socket was closed"),
                _ => {}
            }
        }
    }

    fn note(&mut self, message: &Value) {
        match message["type"].as_str() {
            Some("state") => self.state = message.clone(),
            Some("aim") => self.aim = message.clone(),
            Some("chat") => {
                let part = |key: &str| message[key].as_str().unwrap_or_default().to_owned();
                self.chat.push((part("from"), part("text")));
            }
            _ => {}
        }
    }

    /// Reads on until `done` holds of the page or a message.
    ///
    /// # Errors
    /// When it does not come to hold in time; tells what was said.
    pub fn wait(&mut self, what: &str, mut done: impl FnMut(&Self, &Value) -> bool) -> anyhow::Result<Value> {
        let deadline = Instant::now() + WATCHDOG;
        if done(self, &Value::Null) {
            return Ok(Value::Null);
        }
        while Instant::now() < deadline {
            let message = self.next_message()?;
            if done(self, &message) {
                return Ok(message);
            }
        }
        bail!("waited in vain for {what}; said so far: {:#?}; state: {}", self.chat, self.state)
    }

    /// Types a sentence and waits until its turn is over: the robot has done it, asked, refused or failed.
    ///
    /// # Errors
    /// When the turn does not end.
    pub fn do_and_wait(&mut self, text: &str) -> anyhow::Result<()> {
        self.say(text)?;
        self.wait(&format!("the end of `{text}`"), |_, message| message["type"] == "turn" && message["ended"] == true)?;
        Ok(())
    }

    /// The goals of the newest state: description, and whether it is met.
    #[must_use]
    pub fn goals(&self) -> Vec<(String, bool)> {
        let goals = self.state["goals"].as_array().cloned().unwrap_or_default();
        goals.iter().map(|goal| (goal["text"].as_str().unwrap_or_default().to_owned(), goal["met"] == true)).collect()
    }
}
