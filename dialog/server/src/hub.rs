//! What all open pages share: the chat so far, the newest state, the views, and how many there are.

use std::{
    collections::VecDeque,
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
};

use cohabit_cdf::ObjectId;
use serde_json::{Value, json};
use tokio::sync::broadcast;

use crate::{page::Line, view::View};

/// Lines of chat kept for a page that opens or reconnects.
pub const LINES_KEPT: usize = 500;
/// Messages kept for a page that is slow; then it is told to reload what it missed.
const MESSAGES_KEPT: usize = 256;

/// Pieces of sound kept for a page that is slow; it then misses some.
const SOUNDS_KEPT: usize = 256;

/// Where the service's parts and the pages meet.
pub struct Hub {
    hello: String,
    lines: Mutex<VecDeque<String>>,
    state: Mutex<Option<String>>,
    /// The objects that the robot asks about, in the order of their numbers.
    marked: Mutex<Arc<[ObjectId]>>,
    messages: broadcast::Sender<Arc<str>>,
    /// What robots say aloud, piece by piece, for pages that hear it.
    sounds: broadcast::Sender<Arc<Vec<u8>>>,
    /// The cameras that pages can look through, the usual one first.
    pub views: Vec<Arc<View>>,
    pages: AtomicUsize,
    first_frame_shown: AtomicBool,
    on_first_frame: Box<dyn Fn() + Send + Sync>,
}

/// Counts a page as open while it lives.
pub struct Visit(Arc<Hub>);

impl Drop for Visit {
    fn drop(&mut self) {
        self.0.pages.fetch_sub(1, Ordering::Relaxed);
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn text(line: &Line) -> String {
    serde_json::to_string(line).expect("invariant: a line is plain JSON")
}

impl Hub {
    /// A hub whose pages are greeted with `hello`.
    pub fn new(hello: Value, views: Vec<View>, on_first_frame: Box<dyn Fn() + Send + Sync>) -> Self {
        Self {
            hello: hello.to_string(),
            lines: Mutex::default(),
            state: Mutex::default(),
            marked: Mutex::default(),
            messages: broadcast::Sender::new(MESSAGES_KEPT),
            sounds: broadcast::Sender::new(SOUNDS_KEPT),
            views: views.into_iter().map(Arc::new).collect(),
            pages: AtomicUsize::new(0),
            first_frame_shown: AtomicBool::new(false),
            on_first_frame,
        }
    }

    /// Takes a page in, if there is room: what it is to be told first, and what comes after.
    pub fn join(self: &Arc<Self>) -> Option<(Vec<String>, broadcast::Receiver<Arc<str>>, Visit)> {
        if self.pages.fetch_add(1, Ordering::Relaxed) >= crate::limits::MOST_PAGES {
            self.pages.fetch_sub(1, Ordering::Relaxed);
            return None;
        }
        let visit = Visit(Arc::clone(self));
        // The lines stay locked until the page listens, so that none is missed or told twice.
        let lines = lock(&self.lines);
        let receiver = self.messages.subscribe();
        let mut first = vec![self.hello.clone()];
        first.extend(lines.iter().cloned());
        first.extend(lock(&self.state).clone());
        Some((first, receiver, visit))
    }

    /// Tells all pages a line of chat, and keeps it.
    pub fn say(&self, line: &Line) {
        let text = text(line);
        let mut lines = lock(&self.lines);
        if lines.len() == LINES_KEPT {
            lines.pop_front();
        }
        lines.push_back(text.clone());
        let _ = self.messages.send(text.into());
    }

    /// What was said before this service began.
    pub fn restore<'a>(&self, past: impl IntoIterator<Item = &'a Line>) {
        lock(&self.lines).extend(past.into_iter().map(text));
    }

    /// Has all pages forget what was said, and know these lines instead.
    pub fn rewind(&self, past: &[Line]) {
        let past = &past[past.len().saturating_sub(LINES_KEPT)..];
        let mut lines = lock(&self.lines);
        *lines = past.iter().map(text).collect();
        let _ = self.messages.send(json!({ "type": "rewind", "lines": past }).to_string().into());
    }

    /// Tells all pages something that need not be kept.
    pub fn tell(&self, message: &Value) {
        let _ = self.messages.send(message.to_string().into());
    }

    /// Has the pages that hear robots play a piece of sound.
    pub fn play(&self, piece: Vec<u8>) {
        let _ = self.sounds.send(Arc::new(piece));
    }

    /// What robots say from now on.
    pub fn sounds(&self) -> broadcast::Receiver<Arc<Vec<u8>>> {
        self.sounds.subscribe()
    }

    /// Tells all pages the state, if it is news, and keeps it.
    pub fn show_state(&self, state: &Value) {
        let text = state.to_string();
        let mut kept = lock(&self.state);
        if kept.as_deref() != Some(text.as_str()) {
            *kept = Some(text.clone());
            let _ = self.messages.send(text.into());
        }
    }

    /// Has these objects numbered in the pictures.
    pub fn mark(&self, objects: &[ObjectId]) {
        let mut marked = lock(&self.marked);
        if **marked != *objects {
            *marked = objects.into();
        }
    }

    /// The objects that are numbered in the pictures, the first first.
    pub fn marked(&self) -> Arc<[ObjectId]> {
        Arc::clone(&lock(&self.marked))
    }

    /// A page has shown a frame.
    pub fn note_shown(&self) {
        if !self.first_frame_shown.swap(true, Ordering::Relaxed) {
            (self.on_first_frame)();
        }
    }
}
