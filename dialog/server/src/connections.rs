//! Connections to the page's server: each has a bounded time for each thing it does, and all have a bounded number of
//! places. Where all are taken, whoever comes gets that of the oldest connection of the peer that has most: nobody can
//! lock others out by being slow.
//!
//! A connection that became an open page (a WebSocket) has no place here any more: pages are counted by the hub.

use std::{
    collections::BTreeMap,
    io,
    net::{IpAddr, SocketAddr},
    pin::Pin,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    task::{Context, Poll},
    time::Duration,
};

use axum::{Extension, Router};
use hyper::server::conn::http1;
use hyper_util::{
    rt::{TokioIo, TokioTimer},
    service::TowerToHyperService,
};
use tokio::{
    io::{AsyncRead, AsyncWrite, ReadBuf},
    net::{TcpListener, TcpStream},
    task::AbortHandle,
    time::{Instant, Sleep, sleep, timeout},
};
use tokio_rustls::TlsAcceptor;

use crate::{limits::ServerLimits, tls::Identity};

/// After this a listener that failed, such as for want of open files, is tried again.
const AGAIN_AFTER: Duration = Duration::from_millis(100);

/// The two ends of the connection that a request came by.
#[derive(Clone, Copy, Debug)]
pub struct Ends {
    /// Where it came from.
    pub client: SocketAddr,
    /// Where it came to.
    pub server: SocketAddr,
}

/// Answers all who connect to `listener`, by HTTPS if there is an identity to show.
pub async fn serve(listener: TcpListener, identity: Option<Identity>, router: Router, limits: ServerLimits) {
    let places = Arc::new(Places::new(limits.most_connections));
    let acceptor = identity.map(|identity| TlsAcceptor::from(identity.config()));
    loop {
        let Ok((stream, from)) = listener.accept().await else {
            sleep(AGAIN_AFTER).await;
            continue;
        };
        let Ok(server) = stream.local_addr() else { continue };
        let place = places.take(from.ip());
        let number = place.number;
        let router = router.clone().layer(Extension(Ends { client: from, server }));
        let acceptor = acceptor.clone();
        let task = tokio::spawn(async move {
            attend(stream, acceptor, router, limits).await;
            drop(place);
        });
        places.note(number, task.abort_handle());
    }
}

/// Answers what one client asks, until it has asked all, is too slow, or has become an open page.
async fn attend(stream: TcpStream, acceptor: Option<TlsAcceptor>, router: Router, limits: ServerLimits) {
    // Pictures are wanted at once; what cannot be set makes them late, no more.
    let _ = stream.set_nodelay(true);
    let stream = Sending::new(stream, limits.send);
    match acceptor {
        None => answer(stream, router, limits).await,
        Some(acceptor) => match timeout(limits.handshake, acceptor.accept(stream)).await {
            Ok(Ok(stream)) => answer(stream, router, limits).await,
            Ok(Err(error)) => tracing::debug!("a client did not agree on keys: {error}"),
            Err(_) => tracing::debug!("a client took too long to agree on keys"),
        },
    }
}

async fn answer(stream: impl AsyncRead + AsyncWrite + Send + Unpin + 'static, router: Router, limits: ServerLimits) {
    let answered = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(limits.head)
        .serve_connection(TokioIo::new(stream), TowerToHyperService::new(router))
        .with_upgrades()
        .await;
    if let Err(error) = answered {
        tracing::debug!("a connection ended: {error}");
    }
}

/// The places for connections.
struct Places {
    most: usize,
    taken: Mutex<Taken>,
}

#[derive(Default)]
struct Taken {
    count: u64,
    /// The peer at each place, the oldest first, and what ends it.
    places: BTreeMap<u64, (IpAddr, Option<AbortHandle>)>,
}

/// A place, which is free when this is dropped.
struct Place {
    number: u64,
    places: Arc<Places>,
}

impl Drop for Place {
    fn drop(&mut self) {
        self.places.lock().places.remove(&self.number);
    }
}

impl Places {
    fn new(most: usize) -> Self {
        Self { most, taken: Mutex::default() }
    }

    fn lock(&self) -> MutexGuard<'_, Taken> {
        self.taken.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A place for a connection of `peer`. Where all are taken, another one ends.
    fn take(self: &Arc<Self>, peer: IpAddr) -> Place {
        let mut taken = self.lock();
        let ends = if taken.places.len() < self.most { None } else { taken.gives_way() };
        let ends = ends.and_then(|number| taken.places.remove(&number));
        taken.count += 1;
        let number = taken.count;
        taken.places.insert(number, (peer, None));
        drop(taken);
        if let Some((_, Some(task))) = ends {
            task.abort();
        }
        Place { number, places: Arc::clone(self) }
    }

    /// Notes what ends the connection at a place, if it has not ended yet.
    fn note(&self, number: u64, task: AbortHandle) {
        if let Some((_, ends)) = self.lock().places.get_mut(&number) {
            *ends = Some(task);
        }
    }
}

impl Taken {
    /// The oldest place of the peer that has most.
    fn gives_way(&self) -> Option<u64> {
        let mut counts = BTreeMap::<IpAddr, usize>::new();
        self.places.values().for_each(|(peer, _)| *counts.entry(*peer).or_default() += 1);
        let most = counts.values().copied().max()?;
        let is_of_most = |(peer, _): &(IpAddr, Option<AbortHandle>)| counts.get(peer) == Some(&most);
        self.places.iter().find(|(_, place)| is_of_most(place)).map(|(number, _)| *number)
    }
}

/// A stream whose other end must take what is sent to it: one that takes nothing for too long fails.
struct Sending<S> {
    stream: S,
    longest: Duration,
    /// Runs while the other end takes nothing.
    stalled: Option<Pin<Box<Sleep>>>,
}

impl<S> Sending<S> {
    fn new(stream: S, longest: Duration) -> Self {
        Self { stream, longest, stalled: None }
    }

    fn bound<T>(&mut self, context: &mut Context<'_>, sent: Poll<io::Result<T>>) -> Poll<io::Result<T>> {
        if sent.is_ready() {
            self.stalled = None;
            return sent;
        }
        let longest = self.longest;
        let stalled = self.stalled.get_or_insert_with(|| Box::pin(tokio::time::sleep_until(Instant::now() + longest)));
        stalled.as_mut().poll(context).map(|()| Err(io::ErrorKind::TimedOut.into()))
    }
}

impl<S: AsyncRead + Unpin> AsyncRead for Sending<S> {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_read(context, buffer)
    }
}

impl<S: AsyncWrite + Unpin> AsyncWrite for Sending<S> {
    fn poll_write(mut self: Pin<&mut Self>, context: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        let sent = Pin::new(&mut self.stream).poll_write(context, bytes);
        self.bound(context, sent)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        pieces: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        let sent = Pin::new(&mut self.stream).poll_write_vectored(context, pieces);
        self.bound(context, sent)
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }

    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        let flushed = Pin::new(&mut self.stream).poll_flush(context);
        self.bound(context, flushed)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        let ended = Pin::new(&mut self.stream).poll_shutdown(context);
        self.bound(context, ended)
    }
}
