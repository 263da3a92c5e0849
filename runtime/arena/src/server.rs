//! Clients on TCP: several may be connected, one message is taken at a time.

use std::{
    io::{self, ErrorKind, Read as _, Write as _},
    net::{Shutdown, SocketAddr, TcpListener, TcpStream},
    sync::{
        Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    thread,
    time::Duration,
};

use crate::{
    arena::Arena,
    wire::{Inbox, framed},
};

/// The most clients at once. One is usual; those that lost their connection may not know it yet.
const MOST_CLIENTS: usize = 16;
/// How often somebody who waits looks whether to stop.
const LOOK_UP: Duration = Duration::from_millis(50);
/// How long a client may take to read its answer.
const READ_WITHIN: Duration = Duration::from_secs(30);
/// How long a client that is sent away may take to read why.
const LINGER: Duration = Duration::from_secs(1);

/// Answers all who connect to `listener`, until `stop`; then ends the game.
///
/// # Errors
/// When `listener` has no address.
pub fn serve(listener: &TcpListener, arena: Arena, stop: &AtomicBool) -> io::Result<()> {
    let address = listener.local_addr()?;
    let office = Office { arena: Mutex::new(arena), clients: AtomicUsize::new(0), stop };
    let office = &office;
    thread::scope(|scope| {
        scope.spawn(move || {
            while let Some(client) = office.next_client(listener) {
                scope.spawn(move || office.attend(client));
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
    clients: AtomicUsize,
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
    fn next_client(&self, listener: &TcpListener) -> Option<(TcpStream, SocketAddr)> {
        loop {
            let accepted = listener.accept();
            if self.stops() {
                return None;
            }
            match accepted {
                Ok((stream, from)) if self.clients.load(Ordering::Relaxed) >= MOST_CLIENTS => {
                    tracing::warn!("{from} was sent away: {MOST_CLIENTS} clients are connected");
                    drop(stream);
                }
                Ok(client) => {
                    self.clients.fetch_add(1, Ordering::Relaxed);
                    return Some(client);
                }
                Err(error) => {
                    tracing::warn!("a client could not be let in: {error}");
                    thread::sleep(LOOK_UP);
                }
            }
        }
    }

    fn attend(&self, (stream, from): (TcpStream, SocketAddr)) {
        tracing::info!("{from} connected");
        match self.converse(stream) {
            Ok(()) => tracing::info!("{from} left"),
            Err(error) => tracing::info!("{from} was lost: {error}"),
        }
        self.clients.fetch_sub(1, Ordering::Relaxed);
    }

    /// Takes in what a client sends, and answers, until it leaves.
    fn converse(&self, mut stream: TcpStream) -> io::Result<()> {
        stream.set_nodelay(true)?;
        stream.set_read_timeout(Some(LOOK_UP))?;
        stream.set_write_timeout(Some(READ_WITHIN))?;
        let (mut inbox, mut first) = (Inbox::default(), true);
        let mut bytes = vec![0; 64 << 10];
        while !self.stops() {
            match stream.read(&mut bytes) {
                Ok(0) => return Ok(()),
                Ok(count) => inbox.push(&bytes[..count]),
                Err(error) if is_no_end(&error) => continue,
                Err(error) => return Err(error),
            }
            loop {
                match inbox.next() {
                    Ok(Some(message)) => {
                        let answer = self.arena().answer(&message, std::mem::take(&mut first));
                        if let Some(answer) = answer {
                            stream.write_all(&framed(&answer))?;
                        }
                    }
                    Ok(None) => break,
                    Err(error) => {
                        stream.write_all(&framed(&Arena::answer_to_too_long(error)))?;
                        return send_away(&mut stream);
                    }
                }
            }
        }
        Ok(())
    }
}

fn is_no_end(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
}

/// Ends a connection so that the last answer still arrives: what the client sends meanwhile is thrown away.
fn send_away(stream: &mut TcpStream) -> io::Result<()> {
    const MOST_READS: usize = 1000;
    stream.shutdown(Shutdown::Write)?;
    stream.set_read_timeout(Some(LINGER))?;
    let mut bytes = vec![0; 64 << 10];
    for _ in 0..MOST_READS {
        if stream.read(&mut bytes).is_ok_and(|count| count > 0) {
            continue;
        }
        break;
    }
    Ok(())
}
