//! Recognition and synthesis by a server that speaks the Wyoming protocol (of Home Assistant), over TCP.
//!
//! An event is a line of JSON (`type`, and how long what follows is), then its data as JSON, then a payload of samples:
//!
//! ```text
//! {"type": "audio-chunk", "data_length": 42, "payload_length": 3200}\n{"rate": 16000, "width": 2, "channels": 1}…
//! ```

use std::{
    io::{BufRead as _, BufReader, Read as _, Write as _},
    net::{TcpStream, ToSocketAddrs as _},
    ops::ControlFlow,
    time::Duration,
};

use serde_json::{Map, Value, json};

use crate::{Bias, RATE, Recognition, Recognizer, Resampler, SpeechError, Synthesizer, from_pcm, sentences, to_pcm};

/// How long a server may take to answer at all, and to do its work.
const CONNECT: Duration = Duration::from_secs(2);
const WORK: Duration = Duration::from_secs(20);
/// The longest line and the most bytes of an event; more is no answer.
const LONGEST_LINE: u64 = 1 << 20;
const MOST_BYTES: u64 = 64 << 20;
/// Samples sent at once.
const CHUNK: usize = RATE as usize / 10;

/// A server. It is connected to anew for every utterance.
pub(crate) struct Wyoming {
    address: String,
    name: String,
}

/// One event.
#[derive(Debug)]
struct Event {
    kind: String,
    data: Map<String, Value>,
    payload: Vec<u8>,
}

struct Connection<'a> {
    address: &'a str,
    stream: BufReader<TcpStream>,
}

impl Wyoming {
    /// A server at `host:port`, if it answers.
    pub(crate) fn open(address: &str) -> Result<Self, SpeechError> {
        let mut connection = Connection::open(address)?;
        connection.send("describe", &json!({}), &[])?;
        connection.until("info")?;
        Ok(Self { address: address.to_owned(), name: format!("the speech server at {address}") })
    }

    fn connect(&self) -> Result<Connection<'_>, SpeechError> {
        Connection::open(&self.address)
    }
}

impl<'a> Connection<'a> {
    fn open(address: &'a str) -> Result<Self, SpeechError> {
        let failed = |error: std::io::Error| SpeechError::Server { address: address.into(), why: error.to_string() };
        let mut last = std::io::Error::new(std::io::ErrorKind::NotFound, "there is no such host");
        for place in address.to_socket_addrs().map_err(failed)? {
            match TcpStream::connect_timeout(&place, CONNECT) {
                Ok(stream) => {
                    stream
                        .set_read_timeout(Some(WORK))
                        .and_then(|()| stream.set_write_timeout(Some(WORK)))
                        .map_err(failed)?;
                    return Ok(Self { address, stream: BufReader::new(stream) });
                }
                Err(error) => last = error,
            }
        }
        Err(failed(last))
    }

    fn failed(&self, why: impl std::fmt::Display) -> SpeechError {
        SpeechError::Server { address: self.address.into(), why: why.to_string() }
    }

    fn send(&mut self, kind: &str, data: &Value, payload: &[u8]) -> Result<(), SpeechError> {
        let data = data.to_string();
        let header = json!({"type": kind, "data_length": data.len(), "payload_length": payload.len()});
        let event = [header.to_string().as_bytes(), b"\n", data.as_bytes(), payload].concat();
        self.stream.get_mut().write_all(&event).map_err(|error| self.failed(error))
    }

    /// The next event of a kind; none if the stream ends there. An `error` of the server is one.
    fn until(&mut self, kind: &str) -> Result<Event, SpeechError> {
        loop {
            let event = self.next()?;
            if event.kind == kind {
                return Ok(event);
            }
        }
    }

    fn next(&mut self) -> Result<Event, SpeechError> {
        let mut line = String::new();
        let read = (&mut self.stream).take(LONGEST_LINE).read_line(&mut line);
        match read {
            Ok(0) => return Err(self.failed("it hung up")),
            Ok(_) => {}
            Err(error) => return Err(self.failed(error)),
        }
        let header: Map<String, Value> =
            serde_json::from_str(&line).map_err(|error| self.failed(format!("it does not speak Wyoming: {error}")))?;
        let mut data = header.get("data").and_then(Value::as_object).cloned().unwrap_or_default();
        let length = |name: &str| header.get(name).and_then(Value::as_u64).unwrap_or(0);
        let more = self.bytes(length("data_length"))?;
        if !more.is_empty() {
            let more: Map<String, Value> =
                serde_json::from_slice(&more).map_err(|error| self.failed(format!("it sends broken data: {error}")))?;
            data.extend(more);
        }
        let payload = self.bytes(length("payload_length"))?;
        let kind = header.get("type").and_then(Value::as_str).unwrap_or_default().to_owned();
        if kind == "error" {
            let why = data.get("text").and_then(Value::as_str).unwrap_or("it failed");
            return Err(self.failed(why));
        }
        Ok(Event { kind, data, payload })
    }

    fn bytes(&mut self, length: u64) -> Result<Vec<u8>, SpeechError> {
        if length > MOST_BYTES {
            return Err(self.failed(format!("it sends {length} bytes at once")));
        }
        let mut bytes = vec![0; length as usize];
        self.stream.read_exact(&mut bytes).map_err(|error| self.failed(error))?;
        Ok(bytes)
    }
}

fn format_of(rate: u32) -> Value {
    json!({"rate": rate, "width": 2, "channels": 1})
}

impl Recognizer for Wyoming {
    fn bias(&mut self, _: &Bias) {}

    fn recognize(&mut self, samples: &[f32]) -> Result<Recognition, SpeechError> {
        let mut connection = self.connect()?;
        connection.send("transcribe", &json!({"language": "en"}), &[])?;
        connection.send("audio-start", &format_of(RATE), &[])?;
        for chunk in to_pcm(samples).chunks(CHUNK) {
            let payload: Vec<u8> = chunk.iter().flat_map(|sample| sample.to_le_bytes()).collect();
            connection.send("audio-chunk", &format_of(RATE), &payload)?;
        }
        connection.send("audio-stop", &json!({}), &[])?;
        let transcript = connection.until("transcript")?;
        let text = transcript.data.get("text").and_then(Value::as_str).unwrap_or_default();
        Ok(Recognition::sure(text.trim()))
    }

    fn name(&self) -> &str {
        &self.name
    }
}

impl Synthesizer for Wyoming {
    fn rate(&self) -> u32 {
        RATE
    }

    fn speak(&mut self, text: &str, chunk: &mut dyn FnMut(&[i16]) -> ControlFlow<()>) -> Result<(), SpeechError> {
        for sentence in sentences(text) {
            let mut connection = self.connect()?;
            connection.send("synthesize", &json!({"text": sentence}), &[])?;
            let start = connection.until("audio-start")?;
            let (rate, width) = (number(&start, "rate", RATE), number(&start, "width", 2));
            let channels = number(&start, "channels", 1);
            if width != 2 || channels == 0 {
                return Err(connection.failed(format!("it speaks with {width} bytes a sample and {channels} channels")));
            }
            let mut resampler = Resampler::new(rate, RATE)?;
            loop {
                let event = connection.next()?;
                let samples = match event.kind.as_str() {
                    "audio-chunk" => resampler.push(&from_pcm(&mono(&event.payload, channels as usize))),
                    "audio-stop" => resampler.finish(),
                    _ => continue,
                };
                if !samples.is_empty() && chunk(&to_pcm(&samples)).is_break() {
                    return Ok(());
                }
                if event.kind == "audio-stop" {
                    break;
                }
            }
        }
        Ok(())
    }

    fn name(&self) -> &str {
        &self.name
    }
}

fn number(event: &Event, name: &str, usual: u32) -> u32 {
    event.data.get(name).and_then(Value::as_u64).and_then(|number| u32::try_from(number).ok()).unwrap_or(usual)
}

/// The first channel of samples.
fn mono(payload: &[u8], channels: usize) -> Vec<i16> {
    payload.chunks_exact(2 * channels).map(|frame| i16::from_le_bytes([frame[0], frame[1]])).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use std::{net::TcpListener, thread};

    use super::*;
    use crate::fake;

    /// What a server answers to an event, and to sound.
    type Answer = fn(&Event, &[u8]) -> Vec<(&'static str, Value, Vec<u8>)>;

    /// A server that answers each connection by `answer` of the first event that is no description, and of all samples.
    fn serve(answer: Answer) -> String {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap().to_string();
        thread::spawn(move || {
            for stream in listener.incoming() {
                let mut connection = Connection { address: "client", stream: BufReader::new(stream.unwrap()) };
                let Ok(asked) = connection.next() else { continue };
                if asked.kind == "describe" {
                    connection.send("info", &json!({"asr": []}), &[]).unwrap();
                    continue;
                }
                let mut sound = Vec::new();
                let mut goes_on = asked.kind == "transcribe";
                while goes_on {
                    let Ok(event) = connection.next() else { break };
                    sound.extend(&event.payload);
                    goes_on = event.kind != "audio-stop";
                }
                for (kind, data, payload) in answer(&asked, &sound) {
                    if connection.send(kind, &data, &payload).is_err() {
                        break;
                    }
                }
            }
        });
        address
    }

    fn read(_: &Event, sound: &[u8]) -> Vec<(&'static str, Value, Vec<u8>)> {
        let heard = fake::Reader::default().recognize(&from_pcm(&mono(sound, 1))).unwrap();
        vec![("transcript", json!({"text": format!(" {} ", heard.best())}), vec![])]
    }

    fn beep(asked: &Event, _: &[u8]) -> Vec<(&'static str, Value, Vec<u8>)> {
        let letters = asked.data["text"].as_str().unwrap().len();
        let data = json!({"rate": 22_050, "width": 2, "channels": 1});
        let chunk = vec![7u8; 2 * 2_205];
        let chunks = (0..letters).map(|_| ("audio-chunk", data.clone(), chunk.clone()));
        let start = ("audio-start", data.clone(), vec![]);
        [start].into_iter().chain(chunks).chain([("audio-stop", json!({}), vec![])]).collect()
    }

    #[test]
    fn a_server_recognises() {
        let mut server = Wyoming::open(&serve(read)).unwrap();
        let heard = server.recognize(&fake::hidden("open the fridge")).unwrap();
        assert_eq!((heard.best(), heard.raw.as_str()), ("open the fridge", "open the fridge"));
        assert_eq!(server.recognize(&[0.0; 800]).unwrap().best(), "");
    }

    #[test]
    fn a_server_speaks_and_can_be_stopped() {
        let mut server = Wyoming::open(&serve(beep)).unwrap();
        let mut spoken = 0;
        let mut count = |samples: &[i16]| {
            spoken += samples.len();
            ControlFlow::Continue(())
        };
        server.speak("Hello there.", &mut count).unwrap();
        assert!(spoken.abs_diff(12 * 1_600) <= 2, "{spoken}");
        let mut chunks = 0;
        let mut stop = |_: &[i16]| {
            chunks += 1;
            ControlFlow::Break(())
        };
        server.speak("Hello there. And more.", &mut stop).unwrap();
        assert_eq!(chunks, 1);
    }

    #[test]
    fn what_is_wrong_with_a_server_is_said() {
        let closed = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().to_string();
        assert!(Wyoming::open(&closed).err().unwrap().to_string().contains(&closed));
        let check = |answer: Answer, expected: &str| {
            let mut server = Wyoming::open(&serve(answer)).unwrap();
            let error = server.recognize(&[0.1; 100]).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        };
        check(|_, _| vec![("error", json!({"text": "no model"}), vec![])], "no model");
        check(|_, _| vec![], "it hung up");
        let mut odd = Wyoming::open(&serve(|_, _| vec![("audio-start", json!({"width": 4}), vec![])])).unwrap();
        let error = odd.speak("Hello", &mut |_| ControlFlow::Continue(())).unwrap_err().to_string();
        assert!(error.contains("4 bytes a sample"), "{error}");
    }

    #[test]
    fn who_speaks_something_else_is_told_from_a_server() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap().to_string();
        thread::spawn(move || {
            let mut stream = listener.accept().unwrap().0;
            let _ = stream.write_all(b"HTTP/1.1 400 Bad Request\r\n\r\n");
        });
        assert!(Wyoming::open(&address).err().unwrap().to_string().contains("does not speak Wyoming"));
    }
}
