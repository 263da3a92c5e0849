//! Synthesis by a Piper voice: a model that makes samples of phonemes, which espeak-ng makes of text.

use std::{
    collections::BTreeMap,
    fs,
    ops::ControlFlow,
    path::{Path, PathBuf},
};

use ort::{
    session::{Session, SessionInputValue},
    value::Tensor,
};
use serde::Deserialize;

use crate::{SpeechError, Synthesizer, espeak, model_file::INSTALL, onnx, sentences};

/// The voice's folder, within the data folder.
pub(crate) const FOLDER: &str = "piper";

const NAME: &str = "Piper";
/// Phonemes that begin, part and end what is spoken.
const BEGIN: &str = "^";
const PAD: &str = "_";
const END: &str = "$";
/// Marks that are spoken as pauses and melody.
const MARKS: &str = ".,;:!?";
/// What the first sound waits for is at most so long, and what comes after it: letters. Making it takes a tenth of the time
/// that it lasts, and memory.
const FIRST: usize = 32;
const LONGEST: usize = 80;
/// What is shorter is not parted from what comes after it: letters.
const SHORTEST: usize = 8;
/// Words that a sentence is parted before, where it has no mark to part it at.
const LINKS: [&str; 22] = [
    "after", "and", "at", "because", "before", "but", "by", "for", "from", "in", "into", "of", "on", "or", "that",
    "then", "to", "where", "which", "while", "with", "without",
];
/// So much silence is left where a sentence was parted, s.
const BREATH_S: f32 = 0.04;
/// What is quieter than this is silence, of the loudest.
const SILENT: i16 = i16::MAX / 100;
/// The quietest speech that is made as loud as the loudest.
const QUIETEST: f32 = 0.05;

/// What stands beside a voice, in its `.onnx.json`.
#[derive(Debug, Deserialize)]
struct Voice {
    audio: Audio,
    espeak: Language,
    #[serde(default)]
    inference: Inference,
    phoneme_id_map: BTreeMap<String, Vec<i64>>,
    #[serde(default = "one")]
    num_speakers: i64,
}

#[derive(Debug, Deserialize)]
struct Audio {
    sample_rate: u32,
}

#[derive(Debug, Deserialize)]
struct Language {
    voice: String,
}

/// How lively, how slow and how even it speaks.
#[derive(Debug, Deserialize)]
#[serde(default)]
struct Inference {
    noise_scale: f32,
    length_scale: f32,
    noise_w: f32,
}

impl Default for Inference {
    /// What Piper itself takes.
    fn default() -> Self {
        Self { noise_scale: 0.667, length_scale: 1.0, noise_w: 0.8 }
    }
}

fn one() -> i64 {
    1
}

/// An opened voice.
pub(crate) struct Piper {
    session: Session,
    voice: Voice,
    name: String,
}

impl Piper {
    /// Opens the voice in a folder; `library` is the runtime's.
    pub(crate) fn open(folder: &Path, library: &Path, threads: usize) -> Result<Self, SpeechError> {
        let model = voice_in(folder)?;
        let described = model.with_extension("onnx.json");
        let voice = Voice::read(&described)?;
        espeak::find()?;
        onnx::load(library)?;
        let session = onnx::open(&model, threads)?;
        let name = format!("{NAME} ({})", voice.espeak.voice);
        let mut piper = Self { session, voice, name };
        piper.samples("a").map_err(|error| SpeechError::Broken {
            why: format!("it cannot be run: {error}"),
            remedy: onnx::remedy(&model),
            path: model,
        })?;
        Ok(piper)
    }

    /// What a sequence of phonemes and marks is to the model.
    fn ids(&self, phonemes: &str) -> Vec<i64> {
        let ids = |phoneme: &str| self.voice.phoneme_id_map.get(phoneme).cloned().unwrap_or_default();
        let mut all = [ids(BEGIN), ids(PAD)].concat();
        for phoneme in phonemes.chars() {
            let known = ids(phoneme.encode_utf8(&mut [0; 4]));
            if !known.is_empty() {
                all.extend(known);
                all.extend(ids(PAD));
            }
        }
        all.extend(ids(END));
        all
    }

    fn samples(&mut self, phonemes: &str) -> ort::Result<Vec<i16>> {
        let ids = self.ids(phonemes);
        let Inference { noise_scale, length_scale, noise_w } = self.voice.inference;
        let mut inputs: Vec<(&str, SessionInputValue<'_>)> = vec![
            ("input_lengths", Tensor::from_array(([1], vec![ids.len() as i64]))?.into()),
            ("input", Tensor::from_array(([1, ids.len()], ids))?.into()),
            ("scales", Tensor::from_array(([3], vec![noise_scale, length_scale, noise_w]))?.into()),
        ];
        if self.voice.num_speakers > 1 {
            inputs.push(("sid", Tensor::from_array(([1], vec![0i64]))?.into()));
        }
        let outputs = self.session.run(inputs)?;
        Ok(loud(outputs[0].try_extract_tensor::<f32>()?.1))
    }
}

/// 16-bit samples, as loud as they may be.
fn loud(samples: &[f32]) -> Vec<i16> {
    let peak = samples.iter().filter(|sample| sample.is_finite()).fold(QUIETEST, |peak, sample| peak.max(sample.abs()));
    crate::to_pcm(&samples.iter().map(|sample| sample / peak * 0.9).collect::<Vec<_>>())
}

impl Voice {
    fn read(path: &Path) -> Result<Self, SpeechError> {
        let broken = |why: String| SpeechError::Broken { path: path.into(), why, remedy: onnx::remedy(path) };
        let text = fs::read_to_string(path).map_err(|error| broken(error.to_string()))?;
        let voice: Self =
            serde_json::from_str(&text).map_err(|error| broken(format!("it describes no voice: {error}")))?;
        match [BEGIN, PAD, END].into_iter().find(|mark| !voice.phoneme_id_map.contains_key(*mark)) {
            Some(mark) => Err(broken(format!("`phoneme_id_map` has no {mark:?}"))),
            None => Ok(voice),
        }
    }
}

/// The first voice in a folder, by name.
fn voice_in(folder: &Path) -> Result<PathBuf, SpeechError> {
    let missing = || SpeechError::Missing { path: folder.join("voice.onnx"), remedy: INSTALL.into() };
    let files = fs::read_dir(folder).map_err(|_| missing())?;
    let files = files.flatten().map(|entry| entry.path());
    files.filter(|path| path.extension().is_some_and(|extension| extension == "onnx")).min().ok_or_else(missing)
}

impl Synthesizer for Piper {
    fn rate(&self) -> u32 {
        self.voice.audio.sample_rate
    }

    fn speak(&mut self, text: &str, chunk: &mut dyn FnMut(&[i16]) -> ControlFlow<()>) -> Result<(), SpeechError> {
        for part in parts(text) {
            let mut phonemes = String::new();
            for (clause, mark) in clauses(&part.text) {
                phonemes += &espeak::phonemes(&clause, &self.voice.espeak.voice)?;
                phonemes.extend(mark);
                phonemes.push(' ');
            }
            let samples = self.samples(phonemes.trim_end());
            let samples = samples.map_err(|error| SpeechError::Engine { engine: NAME, why: error.to_string() })?;
            let samples = if part.goes_on { without_pause(&samples, self.rate()) } else { &samples };
            for samples in samples.chunks(self.rate() as usize / 10) {
                if chunk(samples).is_break() {
                    return Ok(());
                }
            }
        }
        Ok(())
    }

    fn name(&self) -> &str {
        &self.name
    }
}

/// What is made at once.
#[derive(Debug, PartialEq)]
struct Part {
    text: String,
    /// Whether its sentence goes on without a mark.
    goes_on: bool,
}

/// Sentences in parts that are short enough, the first of which is heard soon.
fn parts(text: &str) -> Vec<Part> {
    let mut parts: Vec<Part> = Vec::new();
    for sentence in sentences(text) {
        let mut rest = sentence.as_str();
        while !rest.is_empty() {
            let (part, behind) = rest.split_at(cut(rest, if parts.is_empty() { FIRST } else { LONGEST }));
            let text = part.trim().to_owned();
            rest = behind.trim_start();
            parts.push(Part { goes_on: !rest.is_empty() && !text.ends_with(is_mark), text });
        }
    }
    parts
}

fn is_mark(c: char) -> bool {
    MARKS.contains(c)
}

/// Where a text is parted that is longer than that: behind its last mark, before its last word that links, before its last
/// word; not at all where its first word is that long.
fn cut(text: &str, longest: usize) -> usize {
    let is_within = |at: &usize| (SHORTEST..=longest).contains(at) && text.len() - at >= SHORTEST;
    if text.chars().count() <= longest {
        return text.len();
    }
    let spaces = || text.match_indices(' ').map(|(at, _)| at).filter(is_within);
    let is_behind_mark = |at: &usize| text[..*at].ends_with(is_mark);
    let links = |at: &usize| text[at + 1..].split(' ').next().is_some_and(|word| LINKS.contains(&word));
    spaces()
        .rfind(is_behind_mark)
        .or_else(|| spaces().rfind(links))
        .or_else(|| spaces().next_back())
        .unwrap_or(text.len())
}

/// The samples without most of the silence at their end.
fn without_pause(samples: &[i16], rate_hz: u32) -> &[i16] {
    let last = samples.iter().rposition(|sample| sample.saturating_abs() > SILENT).unwrap_or(0);
    &samples[..samples.len().min(last + (rate_hz as f32 * BREATH_S) as usize)]
}

/// Clauses of a sentence, each with the mark behind it.
fn clauses(sentence: &str) -> Vec<(String, Option<char>)> {
    let mut clauses: Vec<(String, Option<char>)> = Vec::new();
    for word in sentence.split_whitespace() {
        if clauses.last().is_none_or(|(_, mark)| mark.is_some()) {
            clauses.push((String::new(), None));
        }
        let Some((clause, mark)) = clauses.last_mut() else { continue };
        let plain = word.trim_end_matches(|c| MARKS.contains(c) || c == '…');
        *mark = word[plain.len()..].chars().next().map(|mark| if mark == '…' { '.' } else { mark });
        clause.push_str(plain);
        clause.push(' ');
    }
    clauses.retain(|(clause, _)| clause.chars().any(char::is_alphanumeric));
    clauses
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sentence_has_clauses_with_marks() {
        let found = clauses("Well, it is 1.5 m away: shall I go?!");
        let expected = [("Well ", Some(',')), ("it is 1.5 m away ", Some(':')), ("shall I go ", Some('?'))];
        assert_eq!(found, expected.map(|(clause, mark)| (clause.to_owned(), mark)));
        assert_eq!(clauses("… !"), []);
    }

    #[test]
    fn the_first_sound_does_not_wait_for_a_long_sentence() {
        let long = "I am going to the break room, where I shall pick up the bowl, and then I come back.";
        let said = |text: &str| parts(text).into_iter().map(|part| (part.text, part.goes_on)).collect::<Vec<_>>();
        let expected = [
            ("I am going to the break room,", false),
            ("where I shall pick up the bowl, and then I come back.", false),
        ];
        let done = ("Done.", false);
        let own = |parts: &[(&str, bool)]| parts.iter().map(|(text, on)| ((*text).to_owned(), *on)).collect::<Vec<_>>();
        assert_eq!(said(&format!("{long} Done.")), own(&[expected[0], expected[1], done]));
        assert_eq!(said("Short, yes."), own(&[("Short, yes.", false)]));
        let unmarked = [("The bowl is on the counter", true), ("in the break room beside the sink.", false)];
        assert_eq!(said("The bowl is on the counter in the break room beside the sink."), own(&unmarked));
        assert_eq!(said(""), []);
        assert_eq!(said(&"x".repeat(500)).len(), 1);
        assert!(said(&"ä ".repeat(500)).iter().all(|(part, _)| part.chars().count() <= LONGEST));
    }

    #[test]
    fn where_a_sentence_was_parted_there_is_no_pause() {
        let sound = [vec![0, 9_000, -9_000], vec![3; 1_000]].concat();
        assert_eq!(without_pause(&sound, 1_000).len(), 2 + 40);
        assert_eq!(without_pause(&[5; 10], 1_000).len(), 10);
    }

    #[test]
    fn a_voice_without_a_description_is_refused() {
        let folder = std::env::temp_dir().join(format!("cohabit-piper-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("a folder");
        let refused = |text: &str| {
            let path = folder.join("voice.onnx.json");
            fs::write(&path, text).expect("a file");
            Voice::read(&path).expect_err("no voice").to_string()
        };
        assert!(refused("{").contains("voice.onnx.json: it describes no voice"));
        let some =
            r#"{"audio": {"sample_rate": 1}, "espeak": {"voice": "en"}, "phoneme_id_map": {"_": [0], "^": [1]}}"#;
        assert!(refused(some).contains("no \"$\""));
        fs::remove_dir_all(&folder).expect("a folder");
    }

    #[test]
    fn speech_is_as_loud_as_it_may_be() {
        assert_eq!(loud(&[0.1, -0.2, f32::NAN]), [14745, -29490, 0]);
        assert!(loud(&[0.001]).iter().all(|sample| *sample < 1_000));
    }
}
