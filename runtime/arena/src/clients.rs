//! The clients that are connected, what each is about, and what their unfinished messages take of memory.

use std::{
    net::{Shutdown, SocketAddr, TcpStream},
    sync::{
        Mutex, MutexGuard, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    time::Instant,
};

use crate::limits::ClientLimits;

/// What a client is about.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Phase {
    /// It has sent no whole message yet.
    New,
    /// It is answered.
    Answered,
    /// It has been answered, and thinks.
    Thinking,
}

/// All clients that are connected.
pub struct Clients {
    limits: ClientLimits,
    seats: Mutex<Seats>,
    shared_bytes: AtomicUsize,
}

#[derive(Default)]
struct Seats {
    count: u64,
    /// The oldest first.
    taken: Vec<Seat>,
}

struct Seat {
    number: u64,
    from: SocketAddr,
    /// By which the connection is ended where it gives way.
    stream: TcpStream,
    phase: Phase,
    /// Since when.
    since: Instant,
}

/// A client's seat, which is free when this is dropped.
pub struct Client<'a> {
    clients: &'a Clients,
    number: u64,
    shared_bytes: usize,
}

impl Drop for Client<'_> {
    fn drop(&mut self) {
        self.clients.lock().taken.retain(|seat| seat.number != self.number);
        self.clients.shared_bytes.fetch_sub(self.shared_bytes, Ordering::Relaxed);
    }
}

impl Clients {
    /// Nobody yet.
    pub fn new(limits: ClientLimits) -> Self {
        Self { limits, seats: Mutex::default(), shared_bytes: AtomicUsize::new(0) }
    }

    fn lock(&self) -> MutexGuard<'_, Seats> {
        self.seats.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A seat for whoever has connected, if there is one, or somebody gives way.
    pub fn seat(&self, stream: &TcpStream, from: SocketAddr) -> Option<Client<'_>> {
        let stream = stream.try_clone().ok()?;
        let mut seats = self.lock();
        if seats.taken.len() >= self.limits.most_clients {
            let at = seats.gives_way(&self.limits)?;
            let gone = seats.taken.remove(at);
            tracing::warn!("{} was sent away for {from}: all {} places are taken", gone.from, self.limits.most_clients);
            // What is lost already need not be ended.
            let _ = gone.stream.shutdown(Shutdown::Both);
        }
        seats.count += 1;
        let number = seats.count;
        seats.taken.push(Seat { number, from, stream, phase: Phase::New, since: Instant::now() });
        Some(Client { clients: self, number, shared_bytes: 0 })
    }
}

impl Seats {
    /// Who gives way to somebody else: the oldest that has not sent a message, or else who thinks for longest, if that is
    /// very long.
    fn gives_way(&self, limits: &ClientLimits) -> Option<usize> {
        let is_new = |seat: &Seat| seat.phase == Phase::New;
        let thinks_long = |seat: &Seat| seat.phase == Phase::Thinking && seat.since.elapsed() >= limits.gives_way_after;
        self.taken.iter().position(is_new).or_else(|| {
            let thinking = self.taken.iter().enumerate().filter(|(_, seat)| thinks_long(seat));
            thinking.min_by_key(|(_, seat)| seat.since).map(|(at, _)| at)
        })
    }
}

impl Client<'_> {
    /// Notes what it is about from now on.
    pub fn note(&self, phase: Phase) {
        let mut seats = self.clients.lock();
        if let Some(seat) = seats.taken.iter_mut().find(|seat| seat.number == self.number) {
            (seat.phase, seat.since) = (phase, Instant::now());
        }
    }

    /// Notes how many bytes of unfinished messages are held for it; whether they may be.
    pub fn takes(&mut self, bytes: usize) -> bool {
        let ClientLimits { own_bytes, shared_bytes, .. } = self.clients.limits;
        let wanted = bytes.saturating_sub(own_bytes);
        let before = std::mem::take(&mut self.shared_bytes);
        let change = |all: usize| Some(all - before + wanted).filter(|all| *all <= shared_bytes || wanted <= before);
        let taken = self.clients.shared_bytes.fetch_update(Ordering::Relaxed, Ordering::Relaxed, change);
        self.shared_bytes = if taken.is_ok() { wanted } else { before };
        taken.is_ok()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::net::TcpListener;

    use super::*;

    #[test]
    fn what_is_held_beyond_each_ones_own_is_shared() {
        let limits = ClientLimits { own_bytes: 10, shared_bytes: 100, ..ClientLimits::default() };
        let clients = Clients::new(limits);
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let streams = [0; 3].map(|_| TcpStream::connect(listener.local_addr().unwrap()).unwrap());
        let [mut one, mut two, mut three] =
            [0, 1, 2].map(|at| clients.seat(&streams[at], streams[at].local_addr().unwrap()).unwrap());
        assert!(one.takes(70) && two.takes(50));
        assert!(!three.takes(11) && three.takes(10));
        assert!(!two.takes(51) && two.takes(50));
        assert!(one.takes(0) && three.takes(70));
        drop((two, three));
        assert!(one.takes(110) && !one.takes(111));
        drop(one);
        assert_eq!(clients.shared_bytes.load(Ordering::Relaxed), 0);
    }
}
