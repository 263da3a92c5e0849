//! What all open pages share: the chat so far, the newest state and frame, and who is watching.

use std::{
    collections::VecDeque,
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
};

use serde_json::Value;
use tokio::sync::{broadcast, watch};

use crate::page::Line;

/// Lines of chat kept for a page that opens or reconnects.
const LINES_KEPT: usize = 500;
/// Messages kept for a page that is slow; then it is told to reload what it missed.
const MESSAGES_KEPT: usize = 256;

/// A frame as pages get it: JPEG behind a header of one kind byte (1), seven zero bytes, and the tick, little-endian.
pub type Frame = Arc<Vec<u8>>;

/// Where the service's parts and the pages meet.
pub struct Hub {
    hello: String,
    lines: Mutex<VecDeque<String>>,
    state: Mutex<Option<String>>,
    messages: broadcast::Sender<Arc<str>>,
    frame: watch::Sender<Option<Frame>>,
    viewers: AtomicUsize,
    first_frame_shown: AtomicBool,
    on_first_frame: Box<dyn Fn() + Send + Sync>,
}

/// Counts a page as a viewer while it lives.
pub struct Viewing(Arc<Hub>);

impl Drop for Viewing {
    fn drop(&mut self) {
        self.0.viewers.fetch_sub(1, Ordering::Relaxed);
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Hub {
    /// A hub whose pages are greeted with `hello`.
    pub fn new(hello: Value, on_first_frame: Box<dyn Fn() + Send + Sync>) -> Self {
        Self {
            hello: hello.to_string(),
            lines: Mutex::default(),
            state: Mutex::default(),
            messages: broadcast::Sender::new(MESSAGES_KEPT),
            frame: watch::Sender::new(None),
            viewers: AtomicUsize::new(0),
            first_frame_shown: AtomicBool::new(false),
            on_first_frame,
        }
    }

    /// Takes a page in, if there is room: what it is to be told first, and what comes after.
    pub fn join(self: &Arc<Self>) -> Option<(Vec<String>, broadcast::Receiver<Arc<str>>, Viewing)> {
        if self.viewers.fetch_add(1, Ordering::Relaxed) >= crate::limits::MOST_PAGES {
            self.viewers.fetch_sub(1, Ordering::Relaxed);
            return None;
        }
        let viewing = Viewing(Arc::clone(self));
        // The lines stay locked until the page listens, so that none is missed or told twice.
        let lines = lock(&self.lines);
        let receiver = self.messages.subscribe();
        let mut first = vec![self.hello.clone()];
        first.extend(lines.iter().cloned());
        first.extend(lock(&self.state).clone());
        Some((first, receiver, viewing))
    }

    /// How many pages are open.
    pub fn viewers(&self) -> usize {
        self.viewers.load(Ordering::Relaxed)
    }

    /// Tells all pages a line of chat, and keeps it.
    pub fn say(&self, line: &Line) {
        let text = serde_json::to_string(line).expect("invariant: a line is plain JSON");
        let mut lines = lock(&self.lines);
        if lines.len() == LINES_KEPT {
            lines.pop_front();
        }
        lines.push_back(text.clone());
        let _ = self.messages.send(text.into());
    }

    /// Tells all pages something that need not be kept.
    pub fn tell(&self, message: &Value) {
        let _ = self.messages.send(message.to_string().into());
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

    /// Gives all pages a frame.
    pub fn show_frame(&self, frame: Frame) {
        self.frame.send_replace(Some(frame));
    }

    /// The newest frame, and those to come.
    pub fn frames(&self) -> watch::Receiver<Option<Frame>> {
        self.frame.subscribe()
    }

    /// A page has shown a frame.
    pub fn note_shown(&self) {
        if !self.first_frame_shown.swap(true, Ordering::Relaxed) {
            (self.on_first_frame)();
        }
    }
}
