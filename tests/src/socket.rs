//! A WebSocket on which a silent other side is an error, and nothing else is.

use std::{io::ErrorKind, net::TcpStream, time::Duration};

use anyhow::{Context as _, bail};
use serde_json::Value;
use tungstenite::{Error, Message, WebSocket, protocol::Role, stream::MaybeTlsStream};

/// The longest that anything is waited for.
pub(crate) const WATCHDOG: Duration = Duration::from_secs(120);

/// An open socket.
pub(crate) struct Socket(WebSocket<MaybeTlsStream<TcpStream>>);

impl Socket {
    /// Connects to a `ws://` address.
    pub fn open(address: &str) -> anyhow::Result<Self> {
        let (socket, _) = tungstenite::connect(address).with_context(|| format!("open the socket {address}"))?;
        if let MaybeTlsStream::Plain(stream) = socket.get_ref() {
            stream.set_read_timeout(Some(WATCHDOG))?;
        }
        Ok(Self(socket))
    }

    /// Another end that sends on the same connection.
    pub fn sender(&self) -> anyhow::Result<Sender> {
        let MaybeTlsStream::Plain(stream) = self.0.get_ref() else { bail!("only a plain socket has two ends") };
        Ok(Sender(WebSocket::from_raw_socket(stream.try_clone()?, Role::Client, None)))
    }

    /// Sends a message as text.
    pub fn send(&mut self, message: &Value) -> anyhow::Result<()> {
        self.0.send(Message::text(message.to_string())).context("send to the socket")
    }

    /// Sends bytes.
    pub fn send_bytes(&mut self, bytes: Vec<u8>) -> anyhow::Result<()> {
        self.0.send(Message::binary(bytes)).context("send to the socket")
    }

    /// The next message.
    ///
    /// A machine that is halted and goes on ends each read that has a time limit, though nothing came: see signal(7).
    pub fn read(&mut self) -> anyhow::Result<Message> {
        loop {
            match self.0.read() {
                Err(Error::Io(error)) if error.kind() == ErrorKind::Interrupted => {}
                read => return read.context("read from the socket"),
            }
        }
    }
}

/// An end of a connection that only sends: another thread may read meanwhile.
pub(crate) struct Sender(WebSocket<TcpStream>);

impl Sender {
    /// Sends a message.
    pub fn send(&mut self, message: Message) -> anyhow::Result<()> {
        self.0.send(message).context("send to the socket")
    }
}
