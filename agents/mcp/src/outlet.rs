//! Where messages to the client go out, one a line; a thread of its own writes them, so nobody waits for a client that reads slowly.

use std::{
    io::Write,
    sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel},
    thread,
};

use serde_json::Value;

use crate::{
    error::BridgeError,
    limits::{CLOSE_PATIENCE, MOST_UNREAD},
};

/// The way out to a client.
pub(crate) struct Outlet {
    messages: SyncSender<String>,
    /// Ends when all was written, or nothing can be written any more.
    written: Receiver<()>,
}

impl Outlet {
    /// The way out that writes to `output`, and nothing else does.
    pub fn new(mut output: impl Write + Send + 'static) -> Self {
        let (messages, waiting) = sync_channel::<String>(MOST_UNREAD);
        let (writes, written) = sync_channel::<()>(0);
        thread::spawn(move || {
            let _writes = writes;
            for message in waiting {
                let line = message + "\n";
                // Whoever sends next learns that nobody reads any more.
                if output.write_all(line.as_bytes()).and_then(|()| output.flush()).is_err() {
                    return;
                }
            }
        });
        Self { messages, written }
    }

    /// Sends a message.
    ///
    /// # Errors
    /// [`BridgeError::NotRead`], [`BridgeError::Closed`].
    pub fn send(&self, message: &Value) -> Result<(), BridgeError> {
        self.messages.try_send(message.to_string()).map_err(|error| match error {
            TrySendError::Full(_) => BridgeError::NotRead(MOST_UNREAD),
            TrySendError::Disconnected(_) => BridgeError::Closed,
        })
    }

    /// Waits until all was written, for a moment at most.
    pub fn close(self) {
        let Self { messages, written } = self;
        drop(messages);
        // It ends without a word.
        let _ = written.recv_timeout(CLOSE_PATIENCE);
    }
}

#[cfg(test)]
mod tests {
    use std::{
        io,
        sync::{Arc, Mutex},
    };

    use serde_json::json;

    use super::*;

    #[derive(Clone, Default)]
    struct Shared(Arc<Mutex<Vec<u8>>>);

    impl Write for Shared {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.lock().unwrap().write(bytes)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn messages_are_lines_and_all_are_written_at_the_end() {
        let output = Shared::default();
        let outlet = Outlet::new(output.clone());
        for number in [1, 2] {
            outlet.send(&json!({ "text": "two\nlines", "number": number })).unwrap();
        }
        outlet.close();
        let written = String::from_utf8(output.0.lock().unwrap().clone()).unwrap();
        let lines: Vec<&str> = written.lines().collect();
        assert_eq!(lines, [r#"{"text":"two\nlines","number":1}"#, r#"{"text":"two\nlines","number":2}"#]);
    }

    #[test]
    fn a_client_that_is_gone_is_noticed() {
        struct Gone;
        impl Write for Gone {
            fn write(&mut self, _: &[u8]) -> io::Result<usize> {
                Err(io::ErrorKind::BrokenPipe.into())
            }

            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        let outlet = Outlet::new(Gone);
        outlet.send(&json!({})).unwrap();
        let _ = outlet.written.recv();
        assert!(matches!(outlet.send(&json!({})), Err(BridgeError::Closed)));
    }
}
