//! The server as its clients meet it: hosts, origins, headers, and who is slow or silent.

use std::{
    io::{self, Read as _, Write as _},
    net::{SocketAddr, TcpStream},
    sync::atomic::{AtomicBool, Ordering},
    thread,
    time::{Duration, Instant},
};

use cohabit_bus::{CameraId, Local};
use cohabit_cdf::Catalog;
use serde_json::{Value, json};
use tungstenite::{Message, WebSocket};

use super::*;
use crate::view::View;

const NEVER: Duration = Duration::from_secs(3600);
const AT_ONCE: Duration = Duration::from_millis(50);
/// The longest that anything is waited for.
const WATCHDOG: Duration = Duration::from_secs(30);
const TOKEN: &str = "secret";

/// Nothing ends for being slow.
const PATIENT: ServerLimits = ServerLimits {
    head: NEVER,
    handshake: NEVER,
    send: NEVER,
    ping_every: AT_ONCE,
    silence: NEVER,
    first_word: NEVER,
    most_connections: 128,
    most_pages: 3,
};

/// A server while it lives.
struct Served {
    address: SocketAddr,
    hub: Arc<Hub>,
    over: Arc<AtomicBool>,
    thread: Option<thread::JoinHandle<io::Result<()>>>,
}

impl Served {
    /// One that asks everybody for the token.
    fn new(limits: ServerLimits) -> Self {
        Self::admitting(false, limits)
    }

    fn admitting(admits_own_user: bool, limits: ServerLimits) -> Self {
        Self::with_seat(admits_own_user, limits, None)
    }

    fn with_seat(admits_own_user: bool, limits: ServerLimits, seat: Option<Seat>) -> Self {
        let (bus, listener) = (Local::new(1), TcpListener::bind("127.0.0.1:0").unwrap());
        let address = listener.local_addr().unwrap();
        let hub = Arc::new(Hub::new(json!({}), vec![View::new(CameraId::Spectator(0))], Box::new(|| ())));
        let screening = Screening::new(&bus, Arc::clone(&hub), Arc::new(Catalog::builtin()), Vec::new()).unwrap();
        let host = Host::Recorded(Arc::new(screening));
        let hosts = if admits_own_user { Vec::new() } else { vec!["tunnel.example".parse().unwrap()] };
        let service = Service {
            hub: Arc::clone(&hub),
            host,
            token: TOKEN.into(),
            seat,
            people: Arc::default(),
            admits_own_user,
            hosts,
            limits,
            identity: None,
            framing: Framing::default(),
            texts: Arc::default(),
        };
        let over = Arc::new(AtomicBool::new(false));
        let is_over = Arc::clone(&over);
        let thread = thread::spawn(move || serve(listener, service, &|| is_over.load(Ordering::Relaxed)));
        Self { address, hub, over, thread: Some(thread) }
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(self.address).unwrap();
        stream.set_read_timeout(Some(WATCHDOG)).unwrap();
        stream
    }

    /// The answer to a request with these headers.
    fn answer(&self, request: &str, headers: &[&str]) -> String {
        let mut stream = self.connect();
        let headers: String = headers.iter().map(|header| format!("{header}\r\n")).collect();
        stream.write_all(format!("{request} HTTP/1.1\r\n{headers}Connection: close\r\n\r\n").as_bytes()).unwrap();
        let mut text = Vec::new();
        stream.read_to_end(&mut text).unwrap();
        String::from_utf8_lossy(&text).into_owned()
    }

    fn own_host(&self) -> String {
        format!("Host: {}", self.address)
    }

    /// Opens a page, which is greeted or told why not.
    fn open(&self) -> (WebSocket<TcpStream>, Value) {
        let address = format!("ws://{}/ws?token={TOKEN}", self.address);
        let (mut page, _) = tungstenite::client(address, self.connect()).unwrap();
        let told = read(&mut page).unwrap();
        (page, told)
    }

    /// Opens pages until one is greeted.
    fn open_at_last(&self) -> WebSocket<TcpStream> {
        let deadline = Instant::now() + WATCHDOG;
        loop {
            let (page, told) = self.open();
            if told == json!({}) {
                return page;
            }
            assert!(Instant::now() < deadline, "there is no room: {told}");
            // Pages that are there and well take what is told.
            self.hub.tell(&json!("x".repeat(1 << 20)));
        }
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
        let ended = self.thread.take().map(thread::JoinHandle::join);
        assert!(thread::panicking() || matches!(ended, Some(Ok(Ok(())))));
    }
}

/// The next message of a page; `None`, if it was closed.
fn read(page: &mut WebSocket<TcpStream>) -> Option<Value> {
    loop {
        match page.read() {
            Ok(Message::Text(text)) => return Some(serde_json::from_str(&text).unwrap()),
            Ok(_) => {}
            Err(tungstenite::Error::Io(error)) if error.kind() == io::ErrorKind::WouldBlock => panic!("nothing comes"),
            Err(_) => return None,
        }
    }
}

/// Waits until the other end has closed a connection.
fn wait_for_end(stream: &mut TcpStream) {
    let mut bytes = [0; 4096];
    loop {
        match stream.read(&mut bytes) {
            Ok(1..) => {}
            Ok(0) => return,
            Err(error) => {
                assert_ne!(error.kind(), io::ErrorKind::WouldBlock, "the connection stays open");
                return;
            }
        }
    }
}

/// Every route, and one that does not exist.
fn routes() -> Vec<String> {
    let own = ["/", "/favicon.svg", "/frame.jpg", "/ws", "/nowhere"].map(str::to_owned);
    own.into_iter().chain(FILES.iter().map(|(path, ..)| (*path).to_owned())).collect()
}

#[test]
fn no_route_answers_another_host_or_origin() {
    let served = Served::new(PATIENT);
    let port = served.address.port();
    let [own, site] = [format!("Host: localhost:{port}"), format!("http://localhost:{port}")];
    for route in routes() {
        let request = format!("GET {route}?token={TOKEN}");
        for host in [format!("Host: evil.example:{port}"), "Host: evil.example".to_owned(), "X: y".to_owned()] {
            let answer = served.answer(&request, &[&host]);
            assert!(answer.starts_with("HTTP/1.1 403"), "{route} for {host}: {answer}");
        }
        for origin in ["http://evil.example", "null", &format!("http://127.0.0.1:{port}")] {
            let answer = served.answer(&request, &[&own, &format!("Origin: {origin}")]);
            assert!(answer.starts_with("HTTP/1.1 403"), "{route} from {origin}: {answer}");
        }
        let rebound = [format!("Host: evil.example:{port}"), format!("Origin: http://evil.example:{port}")];
        let answer = served.answer(&request, &[&rebound[0], &rebound[1]]);
        assert!(answer.starts_with("HTTP/1.1 403"), "{route}: {answer}");
        let answer = served.answer(&request, &[&own, &format!("Origin: {site}")]);
        assert!(!answer.starts_with("HTTP/1.1 403"), "{route}: {answer}");
        let answer = served.answer(&request, &[&format!("Host: tunnel.example:{port}")]);
        assert!(!answer.starts_with("HTTP/1.1 403"), "{route}: {answer}");
    }
}

#[test]
fn without_the_token_nobody_sees_the_session() {
    let served = Served::new(PATIENT);
    for route in ["/", "/frame.jpg"] {
        for parameters in ["", "?token=", "?token=wrong!"] {
            let answer = served.answer(&format!("GET {route}{parameters}"), &[&served.own_host()]);
            assert!(answer.starts_with("HTTP/1.1 403"), "{route}{parameters}: {answer}");
        }
    }
    let opened = tungstenite::client(format!("ws://{}/ws", served.address), served.connect());
    assert!(opened.is_err());
    assert_eq!(served.open().1, json!({}));
}

#[test]
fn the_wizards_token_opens_the_seat_alone_and_nobody_else_learns_that_there_is_one() {
    const WIZARD: &str = "89abcdef89abcdef89abcdef89abcdef";
    let seat = Seat::new(WIZARD, &Holding::default());
    let [with, without] = [Some(seat), None].map(|seat| Served::with_seat(true, PATIENT, seat));
    let answer = |served: &Served, request: &str| {
        let answer = served.answer(request, &[&served.own_host()]);
        // When it was answered, and by which port, is no matter.
        let lines = answer.lines().filter(|line| !line.starts_with("date:"));
        lines.collect::<Vec<_>>().join("\n").replace(&served.address.to_string(), "here")
    };
    for parameters in [String::new(), "?token=wrong!".to_owned(), format!("?token={TOKEN}")] {
        let refused = answer(&with, &format!("GET /wizard{parameters}"));
        assert!(refused.starts_with("HTTP/1.1 403"), "{parameters}: {refused}");
        assert_eq!(refused, answer(&without, &format!("GET /wizard{parameters}")));
    }
    let own = format!("?token={WIZARD}");
    assert!(answer(&with, &format!("GET /wizard{own}")).starts_with("HTTP/1.1 200"));
    for route in ["/", "/frame.jpg"] {
        assert!(answer(&with, &format!("GET {route}{own}")).starts_with("HTTP/1.1 403"), "{route}");
    }
    assert!(answer(&without, &format!("GET /wizard{own}")).starts_with("HTTP/1.1 403"));
    for route in ["/".to_owned(), format!("/?token={TOKEN}"), "/wizard.js".to_owned()] {
        assert_eq!(answer(&with, &format!("GET {route}")), answer(&without, &format!("GET {route}")), "{route}");
    }
}

#[test]
fn the_own_user_needs_no_token_and_no_wrong_one_helps() {
    let served = Served::admitting(true, PATIENT);
    let answer = |request: &str| served.answer(request, &[&served.own_host()]);
    assert!(answer("GET /").starts_with("HTTP/1.1 200"));
    assert!(answer("GET /?token=wrong!").starts_with("HTTP/1.1 403"));
    assert!(tungstenite::client(format!("ws://{}/ws", served.address), served.connect()).is_ok());
    let foreign = served.answer("GET /", &[&format!("Host: evil.example:{}", served.address.port())]);
    assert!(foreign.starts_with("HTTP/1.1 403"), "{foreign}");
}

#[test]
fn every_answer_has_its_headers() {
    let served = Served::new(PATIENT);
    let requests = routes()
        .into_iter()
        .flat_map(|route| ["", "?token=secret"].into_iter().map(move |token| (format!("GET {route}{token}"), true)));
    let others = [("POST /".to_owned(), true), ("OPTIONS *".to_owned(), true), ("GET /".to_owned(), false)];
    for (request, is_own) in requests.chain(others) {
        let host = if is_own { served.own_host() } else { "Host: evil.example".to_owned() };
        let answer = served.answer(&request, &[&host]).to_ascii_lowercase();
        let head = answer.split("\r\n\r\n").next().unwrap();
        for part in [
            "x-content-type-options: nosniff",
            "referrer-policy: no-referrer",
            "x-frame-options: deny",
            "cross-origin-resource-policy: same-origin",
            "cache-control: no-",
            "content-security-policy: default-src 'self'; ",
            "frame-ancestors 'none'",
            "connect-src 'self'",
        ] {
            assert_eq!(head.matches(part).count(), 1, "{request}: `{part}` in {head}");
        }
        let socket = format!("ws://{} ", served.address);
        assert_eq!(head.contains(&socket), is_own, "{request}: {head}");
    }
}

#[test]
fn a_request_that_does_not_come_ends_its_connection() {
    let served = Served::new(ServerLimits { head: AT_ONCE, ..PATIENT });
    let mut slow: Vec<_> = (0..50).map(|_| served.connect()).collect();
    for stream in slow.iter_mut().skip(10) {
        stream.write_all(b"GET / HTTP/1.1\r\nHost: loc").unwrap();
    }
    slow.iter_mut().for_each(wait_for_end);
    // Also after a whole one.
    let mut kept = served.connect();
    kept.write_all(format!("GET /app.js HTTP/1.1\r\n{}\r\n\r\n", served.own_host()).as_bytes()).unwrap();
    wait_for_end(&mut kept);
}

#[test]
fn silent_connections_lock_nobody_out() {
    let served = Served::new(ServerLimits { most_connections: 8, ..PATIENT });
    let mut silent: Vec<_> = (0..100).map(|_| served.connect()).collect();
    let answer = served.answer("GET /app.js", &[&served.own_host()]);
    assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
    wait_for_end(&mut silent[0]);
}

#[test]
fn pages_that_answer_nothing_lose_their_seats() {
    let served = Served::new(ServerLimits { silence: AT_ONCE, ..PATIENT });
    let mut deaf: Vec<_> = (0..3).map(|_| served.open()).collect();
    assert!(deaf.iter().all(|(_, told)| *told == json!({})));
    deaf.iter_mut().for_each(|(page, _)| wait_for_end(page.get_mut()));
    drop(served.open_at_last());
}

#[test]
fn pages_that_answer_pings_keep_theirs() {
    let served = Served::new(ServerLimits { silence: AT_ONCE * 4, ..PATIENT });
    let (mut page, _) = served.open();
    let mut pings = 0;
    while pings < 12 {
        // Reading answers them.
        match page.read().unwrap() {
            Message::Ping(_) => pings += 1,
            other => assert!(!other.is_close(), "{other}"),
        }
    }
}

#[test]
fn where_all_seats_are_taken_a_page_that_never_said_a_word_gives_way() {
    let served = Served::new(ServerLimits { first_word: Duration::ZERO, ..PATIENT });
    let mut pages: Vec<_> = (0..3).map(|_| served.open().0).collect();
    for page in [0, 2] {
        pages[page]
            .send(Message::text(json!({ "type": "point", "camera": "none", "tick": 0, "x": 0, "y": 0 }).to_string()))
            .unwrap();
        assert_eq!(read(&mut pages[page]).unwrap()["type"], "error");
    }
    let (mut newcomer, told) = served.open();
    assert_eq!(told, json!({}));
    assert_eq!(read(&mut pages[1]), None);
    newcomer.send(Message::text(json!({ "type": "nonsense" }).to_string())).unwrap();
    assert_eq!(read(&mut newcomer).unwrap()["type"], "error");
}

#[test]
fn keys_of_offers_are_labelled_alike_on_german_and_french_keyboards() {
    let script = include_str!("../../../web/driving.js");
    let after = script.split_once("const OFFER_KEYS = [").expect("the page has such keys").1;
    let keys = after.split_once(']').expect("they are a list").0;
    assert!(keys.contains("\"E\"") && !keys.contains(['A', 'M', 'Q', 'W', 'Y', 'Z']), "{keys}");
}

#[test]
fn a_page_that_takes_nothing_loses_its_seat() {
    let served = Served::new(ServerLimits { send: AT_ONCE, most_pages: 1, ..PATIENT });
    let (mut deaf, _) = served.open();
    drop(served.open_at_last());
    wait_for_end(deaf.get_mut());
}
