//! What all open pages share: the chat so far, the newest state, the views, and the seats.

use std::{
    collections::{BTreeMap, VecDeque},
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use cohabit_cdf::ObjectId;
use serde_json::{Value, json};
use tokio::sync::{Notify, broadcast};

use crate::{limits::ServerLimits, page::Line, view::View};

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
    /// What the faces of robots show, by their bodies.
    faces: Mutex<BTreeMap<u32, String>>,
    /// How far the plans under way are, by the bodies of robots, each with its turn.
    progress: Mutex<BTreeMap<u32, (u64, String)>>,
    /// The objects that the robot asks about, in the order of their numbers.
    marked: Mutex<Arc<[ObjectId]>>,
    messages: broadcast::Sender<Arc<str>>,
    /// What the pages of wizards are told besides.
    for_wizards: broadcast::Sender<Arc<str>>,
    /// What robots say aloud, piece by piece, for pages that hear it.
    sounds: broadcast::Sender<Arc<Vec<u8>>>,
    /// The cameras that pages can look through, the usual one first.
    pub views: Vec<Arc<View>>,
    seats: Mutex<Seats>,
    first_frame_shown: AtomicBool,
    on_first_frame: Box<dyn Fn() + Send + Sync>,
}

/// The seats of open pages.
#[derive(Default)]
struct Seats {
    count: u64,
    /// The oldest first.
    taken: VecDeque<Seat>,
}

struct Seat {
    number: u64,
    since: Instant,
    has_spoken: bool,
    /// Told when it is given to somebody else.
    given_away: Arc<Notify>,
}

impl Seats {
    /// A seat of `most`, if there is one. Where all are taken, it is that of the page that came first of those that have
    /// not said a word for so long as `first_word`.
    fn take(&mut self, most: usize, first_word: Duration) -> Option<(u64, Arc<Notify>)> {
        if self.taken.len() >= most {
            let gives_way = |seat: &Seat| !seat.has_spoken && seat.since.elapsed() >= first_word;
            let at = self.taken.iter().position(gives_way)?;
            self.taken.remove(at)?.given_away.notify_one();
        }
        self.count += 1;
        let given_away = Arc::new(Notify::new());
        let seat = Seat { number: self.count, since: Instant::now(), has_spoken: false, given_away };
        let taken = (seat.number, Arc::clone(&seat.given_away));
        self.taken.push_back(seat);
        Some(taken)
    }
}

/// A page's seat while it lives.
pub struct Visit {
    hub: Arc<Hub>,
    number: u64,
    given_away: Arc<Notify>,
}

impl Visit {
    /// The page has said something: its seat is its own as long as it is there.
    pub fn note_word(&self) {
        let mut seats = lock(&self.hub.seats);
        if let Some(seat) = seats.taken.iter_mut().find(|seat| seat.number == self.number) {
            seat.has_spoken = true;
        }
    }

    /// Waits until the seat is given to somebody else.
    pub async fn given_away(&self) {
        self.given_away.notified().await;
    }
}

impl Drop for Visit {
    fn drop(&mut self) {
        lock(&self.hub.seats).taken.retain(|seat| seat.number != self.number);
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
            faces: Mutex::default(),
            progress: Mutex::default(),
            marked: Mutex::default(),
            messages: broadcast::Sender::new(MESSAGES_KEPT),
            for_wizards: broadcast::Sender::new(MESSAGES_KEPT),
            sounds: broadcast::Sender::new(SOUNDS_KEPT),
            views: views.into_iter().map(Arc::new).collect(),
            seats: Mutex::default(),
            first_frame_shown: AtomicBool::new(false),
            on_first_frame,
        }
    }

    /// Takes a page in, if there is room: what it is to be told first, and what comes after.
    pub fn join(
        self: &Arc<Self>,
        limits: &ServerLimits,
    ) -> Option<(Vec<String>, broadcast::Receiver<Arc<str>>, Visit)> {
        let (number, given_away) = lock(&self.seats).take(limits.most_pages, limits.first_word)?;
        let visit = Visit { hub: Arc::clone(self), number, given_away };
        let (first, receiver) = self.attend();
        Some((first, receiver, visit))
    }

    /// What a page is to be told first, and what comes after. A wizard's page, which takes no seat from others, is told no less.
    pub fn attend(&self) -> (Vec<String>, broadcast::Receiver<Arc<str>>) {
        // Lines and progress stay locked until the page listens, so that nothing is missed or told twice.
        let (lines, progress) = (lock(&self.lines), lock(&self.progress));
        let receiver = self.messages.subscribe();
        let mut first = vec![self.hello.clone()];
        first.extend(lines.iter().cloned());
        first.extend(lock(&self.faces).values().cloned());
        first.extend(progress.values().map(|(_, told)| told.clone()));
        first.extend(lock(&self.state).clone());
        (first, receiver)
    }

    /// The camera of that name, for a page that asks for it.
    ///
    /// # Errors
    /// There is none; in words for the page.
    pub fn view_of(&self, camera: &str) -> Result<&Arc<View>, String> {
        let is_meant = |view: &&Arc<View>| view.camera.to_string() == camera;
        self.views.iter().find(is_meant).ok_or_else(|| format!("There is no camera {camera}."))
    }

    /// What the pages of wizards are told besides, from now on.
    pub fn for_wizards(&self) -> broadcast::Receiver<Arc<str>> {
        self.for_wizards.subscribe()
    }

    /// Tells wizards something that nobody else learns.
    pub fn tell_wizards(&self, message: &Value) {
        let _ = self.for_wizards.send(message.to_string().into());
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

    /// Tells all pages what the face of a robot shows, and keeps it.
    pub fn show_face(&self, body: u32, message: &Value) {
        let text = message.to_string();
        lock(&self.faces).insert(body, text.clone());
        let _ = self.messages.send(text.into());
    }

    /// Tells all pages how far a robot's plan is, and keeps it until its turn is over.
    pub fn show_progress(&self, body: u32, turn: u64, message: &Value) {
        let text = message.to_string();
        let mut progress = lock(&self.progress);
        progress.insert(body, (turn, text.clone()));
        let _ = self.messages.send(text.into());
    }

    /// Tells all pages that a turn of a robot's is over.
    pub fn end_turn(&self, body: u32, turn: u64, message: &Value) {
        let mut progress = lock(&self.progress);
        if progress.get(&body).is_some_and(|(under_way, _)| *under_way == turn) {
            progress.remove(&body);
        }
        self.tell(message);
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

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    const NEVER: Duration = Duration::from_secs(3600);

    fn hub() -> Arc<Hub> {
        Arc::new(Hub::new(json!({}), Vec::new(), Box::new(|| ())))
    }

    fn join(hub: &Arc<Hub>, first_word: Duration) -> Option<Visit> {
        let limits = ServerLimits { most_pages: 3, first_word, ..ServerLimits::default() };
        hub.join(&limits).map(|(_, _, visit)| visit)
    }

    #[test]
    fn a_seat_is_free_when_its_page_is_gone() {
        let hub = hub();
        let mut visits: Vec<_> = (0..3).map(|_| join(&hub, NEVER).unwrap()).collect();
        assert!(join(&hub, NEVER).is_none());
        visits.pop();
        assert!(join(&hub, NEVER).is_some());
    }

    #[test]
    fn who_comes_later_is_told_what_faces_show_by_now() {
        let hub = hub();
        for shown in ["sorry", "happy"] {
            hub.show_face(1, &json!(shown));
        }
        assert_eq!(hub.attend().0, ["{}", "\"happy\""]);
    }

    #[test]
    fn who_comes_later_is_told_how_far_a_plan_is_until_its_turn_is_over() {
        let hub = hub();
        hub.show_progress(1, 3, &json!("going"));
        hub.end_turn(1, 4, &json!("answered"));
        hub.end_turn(0, 3, &json!("another robot's"));
        assert_eq!(hub.attend().0, ["{}", "\"going\""]);
        hub.end_turn(1, 3, &json!("done"));
        assert_eq!(hub.attend().0, ["{}"]);
    }

    #[test]
    fn a_page_that_never_said_a_word_gives_way_and_no_other_does() {
        let hub = hub();
        let visits: Vec<_> = (0..3).map(|_| join(&hub, Duration::ZERO).unwrap()).collect();
        visits[0].note_word();
        visits[2].note_word();
        let newcomer = join(&hub, Duration::ZERO).unwrap();
        let seats = |hub: &Hub| lock(&hub.seats).taken.iter().map(|seat| seat.number).collect::<Vec<_>>();
        assert_eq!(seats(&hub), [1, 3, 4]);
        let runtime = tokio::runtime::Builder::new_current_thread().build().unwrap();
        runtime.block_on(visits[1].given_away());
        newcomer.note_word();
        assert!(join(&hub, Duration::ZERO).is_none());
        // Who gave way frees nobody's seat when it goes.
        drop(visits);
        assert_eq!(seats(&hub), [4]);
    }
}
