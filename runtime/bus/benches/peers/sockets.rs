//! Carriers that copy: a stream socket for each subscriber, written in turn and read into a buffer that is kept.

use std::io::{self, ErrorKind, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::os::unix::net::{UnixListener, UnixStream};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::board::Board;
use crate::case::Case;
use crate::work::{Failure, Inlet, Look, Outlet};

const MEETING: Duration = Duration::from_secs(20);

struct Streams<S> {
    streams: Vec<S>,
    message: Vec<u8>,
}

impl<S: Write> Outlet for Streams<S> {
    fn send(&mut self, write: &mut dyn FnMut(&mut [u8])) -> Result<(), Failure> {
        write(&mut self.message);
        for stream in &mut self.streams {
            stream.write_all(&self.message)?;
        }
        Ok(())
    }
}

impl<S: Read> Inlet for Streams<S> {
    fn listen(mut self: Box<Self>, mut look: Look, _: &'static Board) -> Result<(), Failure> {
        let stream = self.streams.first_mut().ok_or("no stream")?;
        loop {
            match stream.read_exact(&mut self.message) {
                Ok(()) => look(&[&self.message]),
                Err(error) if error.kind() == ErrorKind::UnexpectedEof => return Ok(()),
                Err(error) => return Err(error.into()),
            }
        }
    }
}

fn streams<S>(streams: Vec<S>, case: &Case) -> Box<Streams<S>> {
    Box::new(Streams { streams, message: vec![1; case.bytes] })
}

/// Over a Unix stream socket.
pub fn unix_outlet(case: &Case) -> Result<Box<dyn Outlet>, Failure> {
    let listener = UnixListener::bind(case.file("socket"))?;
    let accepted: io::Result<Vec<UnixStream>> = listener.incoming().take(case.subscribers).collect();
    Ok(streams(accepted?, case))
}

/// Over a Unix stream socket.
pub fn unix_inlet(case: &Case) -> Result<Box<dyn Inlet>, Failure> {
    Ok(streams(vec![meet(|| UnixStream::connect(case.file("socket")))?], case))
}

/// Over TCP on the loopback interface, without Nagle's delay.
pub fn tcp_outlet(case: &Case, board: &Board) -> Result<Box<dyn Outlet>, Failure> {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?;
    board.set_port(listener.local_addr()?.port());
    let accepted: io::Result<Vec<TcpStream>> = listener.incoming().take(case.subscribers).collect();
    let accepted = accepted?;
    accepted.iter().try_for_each(|stream| stream.set_nodelay(true))?;
    Ok(streams(accepted, case))
}

/// Over TCP on the loopback interface.
pub fn tcp_inlet(case: &Case, board: &Board) -> Result<Box<dyn Inlet>, Failure> {
    let connect = || {
        let port = board.port().ok_or(ErrorKind::AddrNotAvailable)?;
        TcpStream::connect((Ipv4Addr::LOCALHOST, port))
    };
    Ok(streams(vec![meet(connect)?], case))
}

/// Tries until it succeeds.
fn meet<S>(connect: impl Fn() -> io::Result<S>) -> io::Result<S> {
    let began = Instant::now();
    loop {
        match connect() {
            Err(_) if began.elapsed() < MEETING => sleep(Duration::from_millis(5)),
            done => return done,
        }
    }
}
