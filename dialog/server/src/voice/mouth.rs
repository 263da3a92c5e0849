//! How robots speak: a thread that makes sound of what they say, piece by piece, and can be broken off at any piece.

use std::{
    collections::VecDeque,
    ops::ControlFlow,
    sync::{
        Arc, Condvar, Mutex, MutexGuard, PoisonError, Weak,
        atomic::{AtomicU64, Ordering},
    },
    thread,
    time::Duration,
};

use cohabit_bus::{
    Publisher, Topic, Transport,
    message::{AudioHeader, AudioView},
    monotonic_nanos,
};
use cohabit_speech::Synthesizer;
use serde_json::{Value, json};

use super::echo::Echo;

/// More than this does not wait to be said; what waited longest is left out.
const MOST_WAITING: usize = 6;
/// What is longer than this is not said to its end, characters: it can be read.
const LONGEST: usize = 400;
/// The longest that a page's browser may take to say that, ns: a page that goes meanwhile does not tell that it ended.
const LONGEST_NANOS: u64 = 60_000_000_000;
/// Sayings of others are numbered beyond its own.
const PASSED_ON: u64 = 1 << 48;
/// What is said is made no more than so long before it sounds: who is hushed has then not been made in vain, and whoever
/// listens meanwhile has the processor.
const AHEAD: Duration = Duration::from_secs(2);
/// How often an idle mouth looks whether there still is a session.
const LOOK_EVERY: Duration = Duration::from_millis(500);
/// What most plans are answered with; its sound is made beforehand, so that it comes at once.
const AT_ONCE: &str = "OK";

/// What all pages are told, and hear.
type Tell = Box<dyn Fn(&Value) + Send + Sync>;
type Play = Box<dyn Fn(Vec<u8>) + Send + Sync>;

/// How robots speak.
pub struct Mouth {
    waiting: Mutex<VecDeque<Saying>>,
    more: Condvar,
    /// Counts what was said.
    sayings: AtomicU64,
    /// Counts how often everybody was hushed: what was said before is not said to its end.
    hushed: AtomicU64,
    echo: Mutex<Echo>,
    tell: Tell,
    play: Play,
}

/// Something to be said aloud.
struct Saying {
    body: u32,
    turn: u64,
    text: String,
    hushed: u64,
}

/// What a mouth speaks with.
struct Tongue {
    rate_hz: u32,
    bus: Option<Box<dyn Publisher>>,
    /// The sound of [`AT_ONCE`].
    at_once: Vec<i16>,
    /// Until when what was sent so far sounds, ns.
    until: u64,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Mouth {
    /// A mouth that cannot speak yet.
    pub fn new(tell: Tell, play: Play) -> Arc<Self> {
        Arc::new(Self {
            waiting: Mutex::default(),
            more: Condvar::new(),
            sayings: AtomicU64::new(0),
            hushed: AtomicU64::new(0),
            echo: Mutex::default(),
            tell,
            play,
        })
    }

    /// Has it speak from now on, as long as there is anybody who may have it say something.
    pub fn open(self: &Arc<Self>, mut synthesizer: Box<dyn Synthesizer>, bus: &dyn Transport) {
        let publisher = bus.publisher(Topic::Speech);
        let bus = publisher.inspect_err(|error| tracing::warn!("robots are not heard on the bus: {error}")).ok();
        let mouth = Arc::downgrade(self);
        thread::spawn(move || {
            let mut tongue = Tongue { rate_hz: synthesizer.rate().max(1), bus, at_once: Vec::new(), until: 0 };
            tongue.prepare(&mut *synthesizer);
            while let Some(next) = next(&mouth) {
                let (Some(saying), Some(mouth)) = (next, mouth.upgrade()) else { continue };
                tongue.say(&mut *synthesizer, &mouth, &saying);
            }
        });
    }

    /// Says something after what waits.
    pub fn say(&self, body: u32, turn: u64, text: &str) {
        let text = spoken(text);
        if text.is_empty() {
            return;
        }
        let mut waiting = lock(&self.waiting);
        if waiting.len() == MOST_WAITING {
            waiting.pop_front();
        }
        waiting.push_back(Saying { body, turn, text, hushed: self.hushed.load(Ordering::Relaxed) });
        self.more.notify_all();
    }

    /// Breaks off what is said, and forgets what waits.
    pub fn hush(&self) {
        let mut waiting = lock(&self.waiting);
        waiting.clear();
        self.hushed.fetch_add(1, Ordering::Relaxed);
        let saying = self.sayings.load(Ordering::Relaxed);
        self.more.notify_all();
        drop(waiting);
        lock(&self.echo).cut(monotonic_nanos());
        // A page may get a piece that was sent before this after it.
        (self.tell)(&json!({ "type": "hush", "saying": saying }));
    }

    /// Begins to say something, unless everybody was hushed since. Who hushes everybody after that tells of it by its number.
    fn begin(&self, saying: &Saying) -> bool {
        let _waiting = lock(&self.waiting);
        let begins = !self.is_hushed(saying);
        if begins {
            self.sayings.fetch_add(1, Ordering::Relaxed);
        }
        begins
    }

    /// Whether what was heard from then until then is what a robot was saying.
    pub fn is_echo(&self, heard: &str, from_until_nanos: [u64; 2]) -> bool {
        lock(&self.echo).is_echo(heard, from_until_nanos)
    }

    /// Whether what robots were saying then was such a text.
    pub fn says(&self, began_nanos: u64, is_such: impl Fn(&str) -> bool) -> bool {
        lock(&self.echo).says(began_nanos, is_such)
    }

    /// Whether anything sounds that robots say.
    pub fn is_speaking(&self) -> bool {
        self.says(monotonic_nanos(), |_| true)
    }

    /// A page says a text with its browser's voice, from now or until now.
    pub fn note_own_voice(&self, text: Option<&str>, nanos: u64) {
        let mut echo = lock(&self.echo);
        match text {
            // It is told when it ends.
            Some(text) => echo.note(&spoken(text), nanos, nanos.saturating_add(LONGEST_NANOS)),
            None => echo.cut(nanos),
        }
    }

    /// Has the pages hear what somebody else on the bus says aloud.
    pub fn pass_on(&self, view: AudioView<'_>) {
        (self.play)(frame(&AudioHeader { saying: view.header.saying | PASSED_ON, ..*view.header }, view.samples));
    }

    /// Waits so long, or until that is hushed.
    fn rest(&self, saying: &Saying, lasting: Duration) {
        let rests = self.more.wait_timeout_while(lock(&self.waiting), lasting, |_| !self.is_hushed(saying));
        drop(rests.unwrap_or_else(PoisonError::into_inner));
    }

    fn is_hushed(&self, saying: &Saying) -> bool {
        self.hushed.load(Ordering::Relaxed) != saying.hushed
    }
}

/// The next thing to be said; nothing for now, or `None` where nobody is left who may have it said.
fn next(mouth: &Weak<Mouth>) -> Option<Option<Saying>> {
    let mouth = mouth.upgrade()?;
    let mut waiting = lock(&mouth.waiting);
    if waiting.is_empty() {
        (waiting, _) = mouth.more.wait_timeout(waiting, LOOK_EVERY).unwrap_or_else(PoisonError::into_inner);
    }
    Some(waiting.pop_front())
}

impl Tongue {
    /// Makes the sound that is to come at once; that also has the engine warm.
    fn prepare(&mut self, synthesizer: &mut dyn Synthesizer) {
        let made = synthesizer.speak(&format!("{AT_ONCE}."), &mut |piece| {
            self.at_once.extend(piece);
            ControlFlow::Continue(())
        });
        if let Err(error) = made {
            tracing::warn!("{error}");
            self.at_once.clear();
        }
    }

    fn say(&mut self, synthesizer: &mut dyn Synthesizer, mouth: &Mouth, saying: &Saying) {
        if !mouth.begin(saying) {
            return;
        }
        let began = monotonic_nanos();
        self.until = self.until.max(began);
        lock(&mouth.echo).note(&saying.text, self.until.min(began + 1), self.until);
        let mut text = saying.text.as_str();
        if let Some(rest) = text.strip_prefix(AT_ONCE).filter(|_| !self.at_once.is_empty())
            && let Some(rest) = rest.strip_prefix(", ").or_else(|| rest.strip_prefix(". "))
        {
            text = rest;
            let at_once = self.at_once.clone();
            // Whether it is hushed by then is seen below.
            let _ = self.send(mouth, saying, &at_once);
        }
        let said = if mouth.is_hushed(saying) {
            Ok(())
        } else {
            synthesizer.speak(text, &mut |piece| self.send(mouth, saying, piece))
        };
        if let Err(error) = said {
            tracing::warn!("{error}");
            (mouth.tell)(&json!({ "type": "error", "text": format!("The robot has lost its voice: {error}") }));
        }
        if mouth.is_hushed(saying) {
            self.until = monotonic_nanos();
        }
        self.send_piece(mouth, saying, &[], true);
    }

    /// Sends more of a saying, unless it is hushed, and waits where that is far ahead of what sounds.
    fn send(&mut self, mouth: &Mouth, saying: &Saying, samples: &[i16]) -> ControlFlow<()> {
        if mouth.is_hushed(saying) {
            return ControlFlow::Break(());
        }
        for piece in samples.chunks(AudioHeader::MOST_SAMPLES) {
            self.send_piece(mouth, saying, piece, false);
        }
        let lasts = samples.len() as u64 * 1_000_000_000 / u64::from(self.rate_hz);
        self.until = self.until.max(monotonic_nanos()) + lasts;
        lock(&mouth.echo).lasts_until(self.until);
        let ahead = Duration::from_nanos(self.until.saturating_sub(monotonic_nanos()));
        mouth.rest(saying, ahead.saturating_sub(AHEAD));
        ControlFlow::Continue(())
    }

    fn send_piece(&mut self, mouth: &Mouth, saying: &Saying, piece: &[i16], is_last: bool) {
        let header =
            AudioHeader::of_body(self.rate_hz, saying.body, saying.turn, mouth.sayings.load(Ordering::Relaxed));
        let header = if is_last { header.last() } else { header };
        (mouth.play)(frame(&header, piece));
        if let Some(bus) = &mut self.bus {
            let write = &mut |bytes: &mut [u8]| AudioView::write(header, piece, bytes);
            if let Err(error) = bus.send(0, AudioView::bytes(piece.len()), write) {
                tracing::warn!("{error}");
            }
        }
    }
}

/// A piece of sound as pages get it: a kind byte (2), 1 if it is the last of its saying, two zero bytes, the rate (u32), the
/// turn and the saying (u64), and the samples, all little-endian.
fn frame(header: &AudioHeader, samples: &[i16]) -> Vec<u8> {
    let mut frame = vec![2, u8::from(header.is_last == 1), 0, 0];
    frame.extend(header.rate_hz.to_le_bytes());
    frame.extend(header.turn.to_le_bytes());
    frame.extend(header.saying.to_le_bytes());
    frame.extend(samples.iter().flat_map(|sample| sample.to_le_bytes()));
    frame
}

/// A text as it is said: what cannot be pronounced left out, and no longer than is listened to.
fn spoken(text: &str) -> String {
    let words: String = text.chars().map(|c| if matches!(c, '"' | '*' | '_' | '`' | '\n') { ' ' } else { c }).collect();
    let words = words.split_whitespace().collect::<Vec<_>>().join(" ");
    match words.char_indices().nth(LONGEST) {
        Some((at, _)) => words[..words[..at].rfind(['.', '!', '?', ',', ' ']).unwrap_or(at)].to_owned(),
        None => words,
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::sync::mpsc::{self, Receiver, RecvTimeoutError};

    use cohabit_bus::Local;
    use cohabit_speech::fake::Beeper;

    use super::*;

    /// A mouth that beeps, with what pages are told and hear; it may be so many pieces ahead of them.
    fn mouth_ahead(pieces: usize) -> (Arc<Mouth>, Receiver<Value>, Receiver<Vec<u8>>) {
        let ((tell, told), (play, played)) = (mpsc::channel(), mpsc::sync_channel(pieces));
        let tell = move |message: &Value| tell.send(message.clone()).unwrap();
        let mouth = Mouth::new(Box::new(tell), Box::new(move |piece| drop(play.send(piece))));
        mouth.open(Box::new(Beeper), &Local::new(1));
        (mouth, told, played)
    }

    fn mouth() -> (Arc<Mouth>, Receiver<Value>, Receiver<Vec<u8>>) {
        mouth_ahead(1000)
    }

    const LONG: Duration = Duration::from_secs(20);

    fn turn(piece: &[u8]) -> u64 {
        u64::from_le_bytes(piece[8..16].try_into().unwrap())
    }

    #[test]
    fn what_is_said_sounds_in_pieces_the_last_of_which_says_so() {
        let (mouth, _told, played) = mouth();
        mouth.say(0, 7, "OK, going to the break room.");
        let mut samples = 0;
        loop {
            let piece = played.recv_timeout(LONG).unwrap();
            assert_eq!((piece[0], turn(&piece)), (2, 7));
            assert_eq!(u32::from_le_bytes(piece[4..8].try_into().unwrap()), cohabit_speech::RATE);
            samples += (piece.len() - 24) / 2;
            if piece[1] == 1 {
                break;
            }
        }
        // A beep lasts 50 ms a letter: two before, and the rest.
        assert_eq!(samples, (2 + "goingtothebreakroom".len()) * 800);
        assert!(mouth.is_echo("going to the break room", [monotonic_nanos(); 2]));
    }

    #[test]
    fn who_is_hushed_says_no_more() {
        // It is still at the first when it is hushed: what it says next waits until that was heard.
        let (mouth, told, played) = mouth_ahead(0);
        for turn in 1..=3 {
            mouth.say(0, turn, &"a long sentence ".repeat(20));
        }
        played.recv_timeout(LONG).unwrap();
        mouth.hush();
        assert_eq!(told.recv_timeout(LONG).unwrap()["type"], "hush");
        mouth.say(0, 9, "Done.");
        let pieces = std::iter::from_fn(|| match played.recv_timeout(LONG) {
            Ok(piece) => (!(turn(&piece) == 9 && piece[1] == 1)).then_some(piece),
            Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => {
                panic!("what was said after is not heard")
            }
        });
        let turns: Vec<u64> = pieces.map(|piece| turn(&piece)).collect();
        assert!(!turns.contains(&2) && !turns.contains(&3), "{turns:?}");
    }

    #[test]
    fn what_comes_after_a_hush_has_the_number_of_what_was_hushed() {
        let (mouth, told, played) = mouth();
        let mut pieces = Vec::new();
        for turn in 1..=200 {
            mouth.say(0, turn, "OK, going.");
            // At any moment of it: before it began, or after.
            if turn % 2 == 0 {
                pieces.push(played.recv_timeout(LONG).unwrap());
            }
            mouth.hush();
        }
        mouth.say(0, 1_000, "Done.");
        let hushed: Vec<u64> = told.try_iter().map(|message| message["saying"].as_u64().unwrap()).collect();
        assert_eq!(hushed.len(), 200);
        let last = |piece: &Vec<u8>| turn(piece) == 1_000 && piece[1] == 1;
        pieces.extend(std::iter::from_fn(|| Some(played.recv_timeout(LONG).unwrap()).filter(|piece| !last(piece))));
        for piece in pieces.iter().filter(|piece| turn(piece) <= 200) {
            let saying = u64::from_le_bytes(piece[16..24].try_into().unwrap());
            let hushed = hushed[turn(piece) as usize - 1];
            assert!(saying <= hushed, "turn {} is heard as saying {saying}, after {hushed}", turn(piece));
        }
    }

    #[test]
    fn what_cannot_be_pronounced_is_left_out() {
        assert_eq!(spoken("I heard \"open\nit\"."), "I heard open it .");
        let long = spoken(&"word ".repeat(200));
        assert!(long.chars().count() <= LONGEST && long.ends_with("word"), "{long}");
        assert_eq!(spoken(" \n"), "");
    }
}
