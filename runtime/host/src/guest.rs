//! A client that takes what the page of a session takes, without a browser: for measurements.

use std::{
    io::ErrorKind,
    net::TcpStream,
    sync::{
        Arc,
        atomic::{AtomicBool, AtomicU64, Ordering},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use serde_json::json;
use tungstenite::{Error, Message, WebSocket, stream::MaybeTlsStream};

use crate::board::Door;

/// Binary messages that are pictures begin with this.
const PICTURE: u8 = 1;
/// So long nothing is waited for before it is seen whether to go on.
const PATIENCE: Duration = Duration::from_millis(100);
/// How often something is said, as often as people do who are in a hurry: then the robot moves, and pictures change.
const SAYS_EVERY: Duration = Duration::from_secs(4);
/// What is said in turn; any robot can do it in any room.
const SAYINGS: [&str; 2] = ["turn left 90 degrees", "turn right 90 degrees"];

/// An open page of a session of this machine. Dropping it closes it.
#[derive(Debug)]
pub struct Guest {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Debug, Default)]
struct Shared {
    pictures: AtomicU64,
    leaves: AtomicBool,
    is_lost: AtomicBool,
}

impl Guest {
    /// Opens the page behind that door.
    ///
    /// # Errors
    /// When it cannot be opened, in words.
    pub fn open(door: &Door) -> Result<Self, String> {
        let address = format!("ws://127.0.0.1:{}/ws?token={}", door.port, door.token);
        let told = |error: &dyn std::fmt::Display| format!("open the page of a session: {error}");
        let (socket, _) = tungstenite::connect(address).map_err(|error| told(&error))?;
        if let MaybeTlsStream::Plain(stream) = socket.get_ref() {
            stream.set_read_timeout(Some(PATIENCE)).map_err(|error| told(&error))?;
        }
        let shared = Arc::new(Shared::default());
        let its = Arc::clone(&shared);
        let thread = thread::spawn(move || {
            visit(socket, &its);
            its.is_lost.store(true, Ordering::Relaxed);
        });
        Ok(Self { shared, thread: Some(thread) })
    }

    /// How many pictures have come.
    #[must_use]
    pub fn pictures(&self) -> u64 {
        self.shared.pictures.load(Ordering::Relaxed)
    }

    /// Whether the session has closed the connection.
    #[must_use]
    pub fn is_lost(&self) -> bool {
        self.shared.is_lost.load(Ordering::Relaxed)
    }
}

impl Drop for Guest {
    fn drop(&mut self) {
        self.shared.leaves.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // That it panicked shows in its pictures.
            let _ = thread.join();
        }
    }
}

/// Takes what comes, and says something now and then, until it is to leave or the connection is gone.
fn visit(mut socket: WebSocket<MaybeTlsStream<TcpStream>>, shared: &Shared) {
    let mut says_at = Instant::now() + SAYS_EVERY;
    let mut sayings = SAYINGS.iter().cycle();
    while !shared.leaves.load(Ordering::Relaxed) {
        match socket.read() {
            Ok(Message::Binary(bytes)) if bytes.first() == Some(&PICTURE) => {
                let is_first = shared.pictures.fetch_add(1, Ordering::Relaxed) == 0;
                if is_first && socket.send(Message::text(json!({ "type": "shown" }).to_string())).is_err() {
                    return;
                }
            }
            Ok(Message::Close(_)) => return,
            Ok(_) => {}
            Err(Error::Io(error)) if is_silence(error.kind()) => {}
            Err(_) => return,
        }
        if says_at <= Instant::now() {
            says_at += SAYS_EVERY;
            let text = sayings.next().copied().unwrap_or_default();
            if socket.send(Message::text(json!({ "type": "say", "text": text }).to_string())).is_err() {
                return;
            }
        }
    }
    let _ = socket.close(None);
    let _ = socket.flush();
}

/// Whether a read that ended so has found nothing to read.
fn is_silence(kind: ErrorKind) -> bool {
    matches!(kind, ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
}

#[cfg(test)]
mod tests {
    use std::net::TcpListener;

    use super::*;

    #[test]
    fn pictures_are_counted_and_a_page_that_is_closed_is_lost() {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let port = listener.local_addr().expect("its address").port();
        let server = thread::spawn(move || {
            let (stream, _) = listener.accept().expect("a page");
            let mut socket = tungstenite::accept(stream).expect("a socket");
            for bytes in [vec![PICTURE, 0, 9], vec![2, 0, 9], vec![PICTURE, 0, 9]] {
                socket.send(Message::binary(bytes)).expect("a page that reads");
            }
            let said = socket.read().expect("that it has shown one");
            assert_eq!(said, Message::text(r#"{"type":"shown"}"#));
            socket.close(None).expect("a page that is there");
            while socket.read().is_ok() {}
        });
        let guest = Guest::open(&Door { port, token: "t".to_owned() }).expect("a page");
        server.join().expect("a server");
        while !guest.is_lost() {
            thread::park_timeout(Duration::from_millis(1));
        }
        assert_eq!(guest.pictures(), 2);
    }

    #[test]
    fn a_page_that_is_not_there_cannot_be_opened() {
        let port = TcpListener::bind("127.0.0.1:0").and_then(|one| one.local_addr()).expect("a port").port();
        let said = Guest::open(&Door { port, token: String::new() }).expect_err("nobody listens");
        assert!(said.starts_with("open the page of a session: "), "{said}");
    }
}
