//! A server of speech for tests: hears texts that are hidden in sound, or tells sounds apart by their length, and beeps.

use std::{
    io::{BufRead as _, BufReader, Read as _, Write as _},
    net::{TcpListener, TcpStream},
    sync::{Arc, Mutex, PoisonError},
    thread,
};

use anyhow::Context as _;
use cohabit_speech::{Recognizer as _, Synthesizer as _, fake, from_pcm};
use serde_json::{Value, json};

/// A server that speaks the Wyoming protocol, for as long as the test runs.
pub struct SpeechServer {
    /// `wyoming://host:port`.
    pub address: String,
    said: Arc<Mutex<Vec<String>>>,
}

impl SpeechServer {
    /// Hears what is hidden in sound; where nothing is, by how many tenths of a second it lasts at least.
    ///
    /// # Errors
    /// When no port is to be had.
    pub fn start(by_length: &[(usize, &str)]) -> anyhow::Result<Self> {
        let listener = TcpListener::bind("127.0.0.1:0").context("a port")?;
        let address = format!("wyoming://{}", listener.local_addr()?);
        let by_length = by_length.iter().map(|(tenths, text)| (*tenths, (*text).to_owned())).collect::<Vec<_>>();
        let said = Arc::new(Mutex::new(Vec::new()));
        let noted = Arc::clone(&said);
        thread::spawn(move || {
            for stream in listener.incoming().map_while(Result::ok) {
                let (by_length, noted) = (by_length.clone(), Arc::clone(&noted));
                // Who hangs up in the middle wants no more.
                thread::spawn(move || drop(answer(stream, by_length, &noted)));
            }
        });
        Ok(Self { address, said })
    }

    /// All that it was asked to say aloud.
    #[must_use]
    pub fn said(&self) -> Vec<String> {
        self.said.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// The variables that have a session use it.
    #[must_use]
    pub fn environment(&self) -> [(&str, &str); 2] {
        [("COHABIT_RECOGNIZER", &self.address), ("COHABIT_SYNTHESIZER", &self.address)]
    }
}

fn answer(stream: TcpStream, by_length: Vec<(usize, String)>, said: &Mutex<Vec<String>>) -> anyhow::Result<()> {
    let mut reader = BufReader::new(stream);
    let (kind, data, _) = next(&mut reader)?;
    match kind.as_str() {
        "describe" => send(&mut reader, "info", &json!({ "asr": [], "tts": [] }), &[]),
        "transcribe" => {
            let mut samples = Vec::new();
            loop {
                let (kind, _, payload) = next(&mut reader)?;
                samples.extend(payload.chunks_exact(2).map(|pair| i16::from_le_bytes([pair[0], pair[1]])));
                if kind == "audio-stop" {
                    break;
                }
            }
            let mut ear = fake::Reader { by_length, ..fake::Reader::default() };
            let heard = ear.recognize(&from_pcm(&samples))?;
            send(&mut reader, "transcript", &json!({ "text": heard.best() }), &[])
        }
        _ => {
            let text = data["text"].as_str().unwrap_or_default();
            said.lock().unwrap_or_else(PoisonError::into_inner).push(text.to_owned());
            let format = json!({ "rate": fake::Beeper.rate(), "width": 2, "channels": 1 });
            send(&mut reader, "audio-start", &format, &[])?;
            let mut pieces = Vec::new();
            fake::Beeper.speak(text, &mut |piece| {
                pieces.push(piece.iter().flat_map(|sample| sample.to_le_bytes()).collect::<Vec<u8>>());
                std::ops::ControlFlow::Continue(())
            })?;
            for piece in pieces {
                send(&mut reader, "audio-chunk", &format, &piece)?;
            }
            send(&mut reader, "audio-stop", &json!({}), &[])
        }
    }
}

/// Syllables of nobody's: a voice of 130 Hz in the formants of `ah` and `ee`, four a second, at 16 kHz. Voice activity takes
/// it for speech.
#[must_use]
pub fn babble(seconds: f32) -> Vec<f32> {
    const FORMANTS: [[(f32, f32); 3]; 2] =
        [[(730.0, 90.0), (1090.0, 110.0), (2440.0, 160.0)], [(300.0, 60.0), (2300.0, 120.0), (3000.0, 170.0)]];
    let rate = cohabit_speech::RATE as f32;
    let mut resonators = [[[0.0_f32; 2]; 3]; 2];
    let (mut phase, mut out) = (0.0_f32, Vec::new());
    for at in 0..(seconds * rate) as usize {
        let time = at as f32 / rate;
        // It rises and falls as a sentence does.
        phase += (130.0 + 18.0 * (time * 2.1).sin()) / rate;
        phase -= phase.floor();
        let pulse = if phase < 0.4 { (std::f32::consts::PI * phase / 0.4).sin() } else { 0.0 } - 0.25;
        let syllable = time * 4.0;
        let loud = (std::f32::consts::PI * syllable.fract()).sin().powf(0.6);
        let vowel = syllable as usize % 2;
        let mut sum = 0.0;
        for ((centre, width), state) in FORMANTS[vowel].iter().zip(&mut resonators[vowel]) {
            let radius = (-std::f32::consts::PI * width / rate).exp();
            let angle = 2.0 * std::f32::consts::PI * centre / rate;
            let value = pulse * (1.0 - radius) + 2.0 * radius * angle.cos() * state[0] - radius * radius * state[1];
            *state = [value, state[0]];
            sum += value;
        }
        out.push(sum * loud);
    }
    let loudest = out.iter().fold(f32::MIN_POSITIVE, |loudest: f32, sample| loudest.max(sample.abs()));
    out.iter().map(|sample| 0.5 * sample / loudest).collect()
}

/// A WAV file of 16 kHz mono.
#[must_use]
pub fn wav(samples: &[f32]) -> Vec<u8> {
    let pcm: Vec<u8> = cohabit_speech::to_pcm(samples).iter().flat_map(|sample| sample.to_le_bytes()).collect();
    let (rate, bytes) = (cohabit_speech::RATE, pcm.len() as u32);
    let mut file = b"RIFF".to_vec();
    file.extend((36 + bytes).to_le_bytes());
    file.extend(b"WAVEfmt \x10\0\0\0\x01\0\x01\0");
    file.extend(rate.to_le_bytes());
    file.extend((rate * 2).to_le_bytes());
    file.extend(b"\x02\0\x10\0data");
    file.extend(bytes.to_le_bytes());
    file.extend(pcm);
    file
}

/// The next event: its kind, data and payload.
fn next(reader: &mut BufReader<TcpStream>) -> anyhow::Result<(String, Value, Vec<u8>)> {
    let mut line = String::new();
    reader.read_line(&mut line)?;
    let header: Value = serde_json::from_str(&line)?;
    let mut bytes = |name: &str| -> anyhow::Result<Vec<u8>> {
        let mut bytes = vec![0; usize::try_from(header[name].as_u64().unwrap_or(0))?];
        reader.read_exact(&mut bytes)?;
        Ok(bytes)
    };
    let data = bytes("data_length")?;
    let payload = bytes("payload_length")?;
    let data = if data.is_empty() { header["data"].clone() } else { serde_json::from_slice(&data)? };
    Ok((header["type"].as_str().unwrap_or_default().to_owned(), data, payload))
}

fn send(reader: &mut BufReader<TcpStream>, kind: &str, data: &Value, payload: &[u8]) -> anyhow::Result<()> {
    let data = data.to_string();
    let header = json!({ "type": kind, "data_length": data.len(), "payload_length": payload.len() });
    let event = [header.to_string().as_bytes(), b"\n", data.as_bytes(), payload].concat();
    reader.get_mut().write_all(&event).context("answer")
}
