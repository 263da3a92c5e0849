//! espeak-ng (GPL, so only ever a program of its own): the sounds of a text, and a plain voice.

use std::{
    io::{Read as _, Write as _},
    ops::ControlFlow,
    process::{Child, ChildStdout, Command, Stdio},
};

use crate::{SpeechError, Synthesizer, sentences};

const PROGRAM: &str = "espeak-ng";
const REMEDY: &str = "install espeak-ng with the system's package manager";
/// What it speaks where nobody says otherwise.
const VOICE: &str = "en-us";
/// Bytes before the samples of what it writes, and where among them the rate stands.
const HEADER: usize = 44;
const RATE_AT: usize = 24;
/// Samples a second that it speaks with, in all of its English voices.
const VOICE_RATE: u32 = 22_050;
/// Chunks of a tenth of a second.
const CHUNK: usize = VOICE_RATE as usize / 10;

/// Whether the program is there.
///
/// # Errors
/// [`SpeechError::Program`].
pub(crate) fn find() -> Result<(), SpeechError> {
    phonemes("a", VOICE).map(|_| ())
}

/// How a clause sounds, in the International Phonetic Alphabet.
///
/// # Errors
/// [`SpeechError::Program`].
pub(crate) fn phonemes(clause: &str, voice: &str) -> Result<String, SpeechError> {
    let mut running = Running::start(clause, voice, &["-q", "--ipa"])?;
    let mut spelt = String::new();
    running.output.read_to_string(&mut spelt).map_err(failed)?;
    running.end()?;
    Ok(without_remarks(&spelt).split_whitespace().collect::<Vec<_>>().join(" "))
}

/// It remarks in brackets where a word is in another language.
fn without_remarks(spelt: &str) -> String {
    let mut depth = 0;
    spelt
        .chars()
        .filter(|c| {
            match c {
                '(' => depth += 1,
                ')' => depth -= 1,
                _ => return depth == 0,
            }
            false
        })
        .collect()
}

fn failed(error: impl std::fmt::Display) -> SpeechError {
    SpeechError::Program { program: PROGRAM, why: error.to_string(), remedy: REMEDY }
}

/// The program at work on a text; dropping it ends it.
struct Running {
    child: Child,
    output: ChildStdout,
}

impl Running {
    fn start(text: &str, voice: &str, options: &[&str]) -> Result<Self, SpeechError> {
        let mut command = Command::new(PROGRAM);
        command.args(["-v", voice]).args(options).arg("--stdin");
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
        let mut child = command.spawn().map_err(failed)?;
        let (input, output) = (child.stdin.take(), child.stdout.take());
        let (Some(mut input), Some(output)) = (input, output) else {
            return Err(failed("it has no input or output"));
        };
        let running = Self { child, output };
        // It reads all before it speaks, so that what is written never waits for what is read.
        input.write_all(text.as_bytes()).map_err(failed)?;
        Ok(running)
    }

    fn end(mut self) -> Result<(), SpeechError> {
        let status = self.child.wait().map_err(failed)?;
        if status.success() { Ok(()) } else { Err(failed(format!("it ended with {status}"))) }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // Both fail where it has ended, which is as well.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Its own voice.
pub(crate) struct Espeak;

impl Espeak {
    /// The voice, if the program is there.
    pub(crate) fn open() -> Result<Self, SpeechError> {
        find().map(|()| Self)
    }

    /// Speaks one sentence; whether it is to go on.
    fn sentence(text: &str, chunk: &mut dyn FnMut(&[i16]) -> ControlFlow<()>) -> Result<ControlFlow<()>, SpeechError> {
        let mut running = Running::start(text, VOICE, &["--stdout"])?;
        let mut header = [0; HEADER];
        running.output.read_exact(&mut header).map_err(failed)?;
        let rate = u32::from_le_bytes([0, 1, 2, 3].map(|at| header[RATE_AT + at]));
        if rate != VOICE_RATE {
            return Err(failed(format!("its voice has {rate} samples a second, not {VOICE_RATE}")));
        }
        let mut bytes = vec![0; CHUNK * 2];
        loop {
            let length = fill(&mut running.output, &mut bytes).map_err(failed)?;
            let samples: Vec<i16> =
                bytes[..length].chunks_exact(2).map(|pair| i16::from_le_bytes([pair[0], pair[1]])).collect();
            if !samples.is_empty() && chunk(&samples).is_break() {
                return Ok(ControlFlow::Break(()));
            }
            if length < bytes.len() {
                running.end()?;
                return Ok(ControlFlow::Continue(()));
            }
        }
    }
}

/// Reads until the bytes are full or there are no more.
fn fill(from: &mut impl std::io::Read, bytes: &mut [u8]) -> std::io::Result<usize> {
    let mut length = 0;
    while length < bytes.len() {
        match from.read(&mut bytes[length..])? {
            0 => break,
            more => length += more,
        }
    }
    Ok(length)
}

impl Synthesizer for Espeak {
    fn rate(&self) -> u32 {
        VOICE_RATE
    }

    fn speak(&mut self, text: &str, chunk: &mut dyn FnMut(&[i16]) -> ControlFlow<()>) -> Result<(), SpeechError> {
        for sentence in sentences(text) {
            if Self::sentence(&sentence, chunk)?.is_break() {
                break;
            }
        }
        Ok(())
    }

    fn name(&self) -> &str {
        "espeak-ng"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn remarks_are_left_out() {
        let check = |spelt: &str, expected: &str| assert_eq!(without_remarks(spelt), expected);
        check("ðə (fr)ʒ(en) fɹˈɪdʒ", "ðə ʒ fɹˈɪdʒ");
        check("fɹˈɪdʒ", "fɹˈɪdʒ");
    }

    #[test]
    fn bytes_are_read_until_there_are_no_more() {
        let mut bytes = [0; 4];
        let mut from: &[u8] = &[1, 2, 3, 4, 5];
        assert_eq!(fill(&mut from, &mut bytes).ok(), Some(4));
        assert_eq!(fill(&mut from, &mut bytes).ok(), Some(1));
        assert_eq!(fill(&mut from, &mut bytes).ok(), Some(0));
    }
}
