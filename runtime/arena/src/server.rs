//! Clients on TCP: several may be connected, one message is taken at a time.

use std::{
    io::{self, ErrorKind, Read as _, Write as _},
    net::{Shutdown, SocketAddr, TcpListener, TcpStream},
    sync::{
        Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use crate::{
    arena::Arena,
    clients::{Client, Clients, Phase},
    limits::ClientLimits,
    wire::{Inbox, framed},
};

/// How often somebody who waits looks whether to stop.
const LOOK_UP: Duration = Duration::from_millis(50);
/// How long a client that is sent away may be silent before its connection ends; also what is left for an answer as the arena ends.
const LINGER: Duration = Duration::from_secs(1);
/// How long a client that is sent away may go on to send until it reads why.
const PARTING: Duration = Duration::from_secs(10);

/// Answers all who connect to `listener`, until `stop`; then ends the game.
///
/// # Errors
/// When `listener` has no address.
pub fn serve(listener: &TcpListener, arena: Arena, stop: &AtomicBool) -> io::Result<()> {
    serve_within(ClientLimits::default(), listener, arena, stop)
}

/// The same, with other bounds for clients.
///
/// # Errors
/// When `listener` has no address.
pub fn serve_within(limits: ClientLimits, listener: &TcpListener, arena: Arena, stop: &AtomicBool) -> io::Result<()> {
    let address = listener.local_addr()?;
    let office = Office { arena: Mutex::new(arena), clients: Clients::new(limits), limits, stop };
    let office = &office;
    thread::scope(|scope| {
        scope.spawn(move || {
            while let Some((stream, from, client)) = office.next_client(listener) {
                scope.spawn(move || office.attend(stream, from, client));
            }
        });
        while !stop.load(Ordering::Relaxed) {
            thread::sleep(LOOK_UP);
        }
        // Whoever waits for a client gets one, and sees that it is time to go.
        drop(TcpStream::connect_timeout(&address, LINGER));
    });
    office.arena().finish();
    Ok(())
}

/// Where clients are attended to.
struct Office<'a> {
    arena: Mutex<Arena>,
    clients: Clients,
    limits: ClientLimits,
    stop: &'a AtomicBool,
}

impl Office<'_> {
    fn arena(&self) -> MutexGuard<'_, Arena> {
        self.arena.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn stops(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Waits for a client; `None` is the end.
    fn next_client(&self, listener: &TcpListener) -> Option<(TcpStream, SocketAddr, Client<'_>)> {
        loop {
            let accepted = listener.accept();
            if self.stops() {
                return None;
            }
            match accepted {
                Ok((stream, from)) => match self.clients.seat(&stream, from) {
                    Some(client) => return Some((stream, from, client)),
                    None => tracing::warn!("{from} was sent away: {} clients are at work", self.limits.most_clients),
                },
                Err(error) => {
                    tracing::warn!("a client could not be let in: {error}");
                    thread::sleep(LOOK_UP);
                }
            }
        }
    }

    fn attend(&self, stream: TcpStream, from: SocketAddr, client: Client<'_>) {
        tracing::info!("{from} connected");
        match self.converse(stream, client) {
            Ok(()) => tracing::info!("{from} left"),
            Err(error) => tracing::info!("{from} was lost: {error}"),
        }
    }

    /// Takes in what a client sends, and answers, until it leaves.
    fn converse(&self, mut stream: TcpStream, mut client: Client<'_>) -> io::Result<()> {
        stream.set_nodelay(true)?;
        stream.set_read_timeout(Some(LOOK_UP))?;
        let mut inbox = Inbox::default();
        // Until when a message must be whole: the first, or one that has begun.
        let (mut first, mut whole_by) = (true, Some(Instant::now() + self.limits.first_message));
        let mut bytes = vec![0; 64 << 10];
        while !self.stops() {
            if whole_by.is_some_and(|by| Instant::now() > by) {
                return Err(io::Error::new(ErrorKind::TimedOut, "its message took too long"));
            }
            match stream.read(&mut bytes) {
                Ok(0) => return Ok(()),
                Ok(count) => inbox.push(&bytes[..count]),
                Err(error) if is_no_end(&error) => continue,
                Err(error) => return Err(error),
            }
            if !client.takes(inbox.held()) {
                let all = self.limits.shared_bytes;
                let why = format!("unfinished messages of all clients have more than {all} bytes: try again later");
                return self.refuse(&mut stream, why);
            }
            let came = Instant::now();
            loop {
                match inbox.next() {
                    Ok(Some(message)) => {
                        client.note(Phase::Answered);
                        let answer = self.arena().answer(&message, std::mem::take(&mut first));
                        // Before it can see the answer, so that who was answered first also thinks for longest.
                        client.note(Phase::Thinking);
                        if let Some(answer) = answer {
                            self.send(&mut stream, &answer)?;
                        }
                        whole_by = None;
                    }
                    Ok(None) => break,
                    Err(error) => return self.refuse(&mut stream, error.to_string()),
                }
            }
            client.takes(inbox.held());
            whole_by = match (inbox.has_begun(), first, whole_by) {
                (false, false, _) => None,
                (true, false, None) => Some(came + self.limits.message),
                (_, _, by) => by,
            };
        }
        Ok(())
    }

    /// Tells a client why it is not heard, and ends its connection.
    fn refuse(&self, stream: &mut TcpStream, why: String) -> io::Result<()> {
        self.send(stream, &Arena::refusal(why))?;
        self.send_away(stream)
    }

    /// Ends a connection so that the last answer still arrives: what the client sends meanwhile is thrown away.
    fn send_away(&self, stream: &mut TcpStream) -> io::Result<()> {
        stream.shutdown(Shutdown::Write)?;
        stream.set_read_timeout(Some(LINGER))?;
        let by = Instant::now() + PARTING;
        let mut bytes = vec![0; 64 << 10];
        while !self.stops() && Instant::now() < by && stream.read(&mut bytes).is_ok_and(|count| count > 0) {}
        Ok(())
    }

    /// Sends an answer, all of which must be taken in time. Who does not read keeps nobody who ends the arena waiting.
    fn send(&self, stream: &mut TcpStream, answer: &[u8]) -> io::Result<()> {
        let mut by = Instant::now() + self.limits.answer;
        let answer = framed(answer);
        let mut rest = &answer[..];
        while !rest.is_empty() {
            if self.stops() {
                by = by.min(Instant::now() + LINGER);
            }
            let left = by.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Err(io::Error::new(ErrorKind::TimedOut, "it took too long to take an answer"));
            }
            stream.set_write_timeout(Some(left.min(LOOK_UP)))?;
            match stream.write(rest) {
                Ok(0) => return Err(ErrorKind::WriteZero.into()),
                Ok(count) => rest = &rest[count..],
                Err(error) if is_no_end(&error) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }
}

fn is_no_end(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
}
