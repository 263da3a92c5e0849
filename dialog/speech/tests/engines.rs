//! The real engines, where they are installed (`cohabit voice install`).

#![allow(clippy::unwrap_used)]

use std::{
    fs,
    ops::ControlFlow,
    path::{Path, PathBuf},
};

use cohabit_speech::{
    Bias, Ear, Engines, Heard, Part, RATE, Scene, Source, SpeechError, Turns, VoiceSettings, WINDOW, from_pcm, resample,
};

/// The user's data folder, with all that belongs in it.
fn installed() -> VoiceSettings {
    let settings = VoiceSettings::from_env().unwrap();
    let lacks = Engines::open(&settings).lacks;
    assert!(lacks.is_empty(), "voice is incomplete: {lacks:?}");
    settings
}

/// A text, spoken by the engines' own voice, between silences.
fn spoken(engines: &mut Engines, text: &str) -> Vec<f32> {
    let synthesizer = engines.synthesizer.as_mut().unwrap();
    let (rate, mut samples) = (synthesizer.rate(), Vec::new());
    let take = &mut |chunk: &[i16]| {
        samples.extend(from_pcm(chunk));
        ControlFlow::Continue(())
    };
    synthesizer.speak(text, take).unwrap();
    let silence = vec![0.0; RATE as usize];
    [silence.clone(), resample(&samples, rate, RATE).unwrap(), silence].concat()
}

fn office() -> Bias {
    let names = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
    Bias::of_scene(&Scene {
        things: names(&["bowl", "mug", "milk", "cereal box"]),
        places: names(&["table", "fridge", "microwave", "sink"]),
        rooms: names(&["break room", "main office", "quantum lab"]),
        ..Scene::default()
    })
}

fn words(text: &str) -> String {
    let kept: String = text.to_lowercase().chars().filter(|c| c.is_alphanumeric() || *c == ' ').collect();
    kept.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
#[cfg_attr(not(voice), ignore = "optional: `cohabit voice install`, and espeak-ng")]
fn what_is_spoken_is_heard() {
    let settings = installed();
    let mut engines = Engines::open(&settings);
    let sound = spoken(&mut engines, "Go to the break room and pick up the bowl.");
    let mut ear = Ear::new(engines.vad, engines.recognizer.unwrap(), Turns::default());
    ear.bias(&office());
    let mut heard = Vec::new();
    for piece in sound.chunks(320) {
        heard.extend(ear.push(piece, &mut |text| words(text).ends_with("bowl")).unwrap());
    }
    assert!(matches!(heard[0], Heard::Began { began, .. } if began > RATE as u64 / 2));
    assert!(heard.iter().any(|heard| matches!(heard, Heard::Partial { text } if words(text).starts_with("go to"))));
    let Some(Heard::Said(said)) = heard.last() else { panic!("{heard:?}") };
    assert_eq!(words(said.recognition.best()), "go to the break room and pick up the bowl");
    assert!(said.recognition.confidence() > 0.5, "{}", said.recognition.confidence());
    assert!(said.ended < said.told && said.began < said.ended);
}

#[test]
#[cfg_attr(not(voice), ignore = "optional: `cohabit voice install`, and espeak-ng")]
fn speech_is_told_from_silence_and_noise() {
    let settings = installed();
    let nowhere = VoiceSettings { synthesizer: Source::Installed, ..VoiceSettings::installed("/nowhere") };
    let mut engines = Engines::open(&settings);
    let speech = spoken(&mut engines, "Please open the fridge and take the milk.");
    // The same for what stands in where nothing is installed.
    for mut vad in [engines.vad, Engines::open(&nowhere).vad] {
        let mut share = |sound: &[f32]| {
            vad.reset();
            let windows = sound.chunks_exact(WINDOW).map(|window| window.try_into().unwrap());
            let likely = windows.filter(|window| vad.speech(window).unwrap() > 0.5).count();
            likely as f32 / (sound.len() / WINDOW) as f32
        };
        let hum: Vec<f32> = (0..RATE * 3).map(|at| 0.1 * (at as f32 * 0.0196).sin()).collect();
        assert!(share(&speech) > 0.3);
        assert!(share(&vec![0.0; RATE as usize * 3]) < 0.02);
        assert!(share(&hum) < 0.1);
    }
}

#[test]
#[cfg_attr(not(voice), ignore = "optional: `cohabit voice install`, and espeak-ng")]
fn what_is_no_speech_fails_nothing() {
    let settings = installed();
    let mut recognizer = Engines::open(&settings).recognizer.unwrap();
    recognizer.bias(&office());
    assert!(recognizer.recognize(&[]).unwrap().hypotheses.is_empty());
    for odd in [f32::NAN, f32::INFINITY, f32::MIN, 0.0, 1e-40] {
        recognizer.recognize(&[odd; 2_000]).unwrap();
    }
    recognizer.partial(&[f32::NAN]).unwrap();
    // More than the model takes at once is heard in parts.
    let long: Vec<f32> = (0..RATE * 32).map(|at| 0.3 * ((at as f32) * 0.05 + ((at / 900) as f32)).sin()).collect();
    recognizer.recognize(&long).unwrap();
}

#[test]
#[cfg_attr(not(voice), ignore = "optional: `cohabit voice install`, and espeak-ng")]
fn a_bias_may_change_and_go() {
    let settings = installed();
    let mut engines = Engines::open(&settings);
    let sound = spoken(&mut engines, "Pick up the bowl.");
    let mut recognizer = engines.recognizer.unwrap();
    let plain = recognizer.recognize(&sound).unwrap();
    assert_eq!(plain.best(), plain.raw);
    recognizer.bias(&office());
    let biased = recognizer.recognize(&sound).unwrap();
    assert_eq!(biased.raw, plain.raw);
    assert_eq!(words(biased.best()), "pick up the bowl");
    recognizer.bias(&Bias::default());
    assert_eq!(recognizer.recognize(&sound).unwrap(), plain);
}

#[test]
#[cfg_attr(not(voice), ignore = "optional: `cohabit voice install`, and espeak-ng")]
fn speaking_can_be_stopped() {
    let settings = installed();
    let mut synthesizer = Engines::open(&settings).synthesizer.unwrap();
    let mut chunks = Vec::new();
    let mut stop = |chunk: &[i16]| {
        chunks.push(chunk.len());
        if chunks.len() == 2 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    synthesizer.speak("This is a sentence. This is another one. And a third.", &mut stop).unwrap();
    assert_eq!(chunks.len(), 2);
    assert!(chunks.iter().all(|length| *length <= synthesizer.rate() as usize / 10));
    synthesizer.speak("", &mut |_| panic!("nothing to speak")).unwrap();
    synthesizer.speak("… ♪ 🙂", &mut |_| ControlFlow::Continue(())).unwrap();
}

/// A copy of what is installed, one file of which is changed.
struct Copy(PathBuf);

impl Copy {
    fn of(settings: &VoiceSettings, name: &str, changed: &str, change: impl Fn(&mut Vec<u8>)) -> Self {
        let folder = std::env::temp_dir().join(format!("cohabit-engines-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        for part in ["runtime", "moonshine", "silero", "piper"] {
            fs::create_dir_all(folder.join(part)).unwrap();
            for file in fs::read_dir(settings.folder.join(part)).unwrap().flatten() {
                let to = folder.join(part).join(file.file_name());
                if to == folder.join(changed) {
                    let mut bytes = fs::read(file.path()).unwrap();
                    change(&mut bytes);
                    fs::write(to, bytes).unwrap();
                } else {
                    std::os::unix::fs::symlink(file.path(), to).unwrap();
                }
            }
        }
        Self(folder)
    }
}

impl Drop for Copy {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

#[test]
#[cfg_attr(not(voice), ignore = "optional: `cohabit voice install`, and espeak-ng")]
fn a_broken_model_is_named_and_costs_its_part_alone() {
    let settings = installed();
    let check = |file: &str, part: Part, change: &dyn Fn(&mut Vec<u8>)| {
        let copy = Copy::of(&settings, "broken", file, change);
        let engines = Engines::open(&VoiceSettings::installed(&copy.0));
        let [lack] = &engines.lacks[..] else { panic!("{file}: {:?}", engines.lacks) };
        assert!(lack.part == part && lack.why.contains(file) && lack.why.contains("cohabit voice install"), "{lack}");
        assert_eq!(engines.recognizer.is_some(), part != Part::Recognition);
    };
    let cut: &dyn Fn(&mut Vec<u8>) = &|bytes| bytes.truncate(bytes.len() / 2);
    let nothing: &dyn Fn(&mut Vec<u8>) = &|bytes| bytes.clear();
    let other: &dyn Fn(&mut Vec<u8>) = &|bytes| *bytes = b"this is no model".repeat(99);
    let damaged: &dyn Fn(&mut Vec<u8>) = &|bytes| {
        let length = bytes.len();
        (0..64).for_each(|at| bytes[at * (length / 64)] ^= 0x55);
    };
    for change in [cut, nothing, other, damaged] {
        check("moonshine/encoder_model.ort", Part::Recognition, change);
        check("moonshine/decoder_model_merged.ort", Part::Recognition, change);
        check("moonshine/tokenizer.bin", Part::Recognition, change);
        check("silero/silero_vad.onnx", Part::VoiceActivity, change);
        check("piper/voice.onnx", Part::Synthesis, change);
        check("piper/voice.onnx.json", Part::Synthesis, change);
    }
}

/// A Whisper model of one layer and random weights, as `optimum` 1.23 exports it: it hears nothing right, but runs.
const WHISPER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/whisper");
const ENCODER: &str = "encoder_model.onnx";
const DECODER: &str = "decoder_model_merged.onnx";
const TOKENIZER: &str = "tokenizer.json";

/// A folder with these files, gone when it is done with.
struct Folder(PathBuf);

impl Folder {
    fn of(name: &str, files: &[(&str, Vec<u8>)]) -> Self {
        let folder = std::env::temp_dir().join(format!("cohabit-whisper-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        for (name, bytes) in files {
            let path = folder.join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, bytes).unwrap();
        }
        Self(folder)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn heard_with(settings: &VoiceSettings, folder: impl Into<PathBuf>) -> Engines {
    Engines::open(&VoiceSettings { recognizer: Source::Folder(folder.into()), ..settings.clone() })
}

#[test]
#[cfg_attr(not(voice), ignore = "optional: `cohabit voice install`, and espeak-ng")]
fn a_folder_with_whisper_is_opened_and_fails_on_nothing() {
    let settings = installed();
    let file = |name: &str| fs::read(Path::new(WHISPER).join(name)).unwrap();
    // As it is, and as whole repositories of such models are laid out.
    let (encoder, decoder) = (file(ENCODER), file(DECODER));
    let files = [
        ("onnx/encoder_model_quantized.onnx", encoder),
        ("onnx/decoder_model_merged_quantized.onnx", decoder),
        (TOKENIZER, file(TOKENIZER)),
    ];
    let laid_out = Folder::of("laid-out", &files);
    let noise: Vec<f32> = (0..RATE * 2).map(|at| 0.3 * ((at * at % 977) as f32 / 977.0 - 0.5)).collect();
    let mut found = Vec::new();
    for folder in [Path::new(WHISPER), &laid_out.0] {
        let engines = heard_with(&settings, folder);
        assert!(engines.lacks.is_empty(), "{:?}", engines.lacks);
        let mut recognizer = engines.recognizer.unwrap();
        assert!(recognizer.name().starts_with("Whisper ("), "{}", recognizer.name());
        for odd in [f32::NAN, f32::INFINITY, f32::MIN, 0.0, 1e-40] {
            recognizer.recognize(&[odd; 2_000]).unwrap();
        }
        assert!(recognizer.recognize(&[]).unwrap().hypotheses.is_empty());
        recognizer.recognize(&[0.1; RATE as usize * 31]).unwrap();
        let plain = recognizer.recognize(&noise).unwrap();
        assert!(!plain.raw.is_empty() && !plain.raw.contains("<|"), "{}", plain.raw);
        recognizer.bias(&office());
        let biased = recognizer.recognize(&noise).unwrap();
        assert_eq!(recognizer.recognize(&noise).unwrap(), biased);
        recognizer.bias(&Bias::default());
        assert_eq!(recognizer.recognize(&noise).unwrap(), plain);
        found.push((plain, biased));
    }
    assert_eq!(found[0], found[1]);
}

#[test]
#[cfg_attr(not(voice), ignore = "optional: `cohabit voice install`, and espeak-ng")]
fn what_is_wrong_with_a_folder_is_named() {
    let settings = installed();
    let file = |name: &str| fs::read(Path::new(WHISPER).join(name)).unwrap();
    let check = |changed: &str, bytes: Option<Vec<u8>>, named: &str, expected: &str| {
        let mut files = [ENCODER, DECODER, TOKENIZER].map(|name| (name, file(name))).to_vec();
        files.retain(|(name, _)| *name != changed);
        files.extend(bytes.map(|bytes| (changed, bytes)));
        let folder = Folder::of("wrong", &files);
        let engines = heard_with(&settings, &folder.0);
        let [lack] = &engines.lacks[..] else { panic!("{changed}: {:?}", engines.lacks) };
        let path = folder.0.join(named).display().to_string();
        assert!(lack.part == Part::Recognition && engines.recognizer.is_none(), "{lack}");
        assert!(lack.why.contains(&path) && lack.why.contains("COHABIT_RECOGNIZER names a folder"), "{lack}");
        assert!(lack.why.contains(expected), "{lack}");
    };
    let cut = |name: &str| Some(file(name).split_off(99));
    for name in [ENCODER, DECODER] {
        check(name, None, name, "there is no such file");
        check(name, cut(name), name, "");
        check(name, Some(Vec::new()), name, "");
    }
    check(ENCODER, Some(file(DECODER)), ENCODER, "the encoder of neither a Moonshine nor a Whisper model");
    check(DECODER, Some(file(ENCODER)), DECODER, "no decoder that remembers");
    check(TOKENIZER, None, TOKENIZER, "there is no such file");
    check(TOKENIZER, cut(TOKENIZER), TOKENIZER, "it holds no tokens");
    let text = String::from_utf8(file(TOKENIZER)).unwrap();
    let other = text.replace("<|startoftranscript|>", "<s>");
    check(TOKENIZER, Some(other.into_bytes()), TOKENIZER, "are not those of a Whisper model");
    // Of a model with more languages.
    let larger = text.replace(r#""id": 274"#, r#""id": 275"#);
    assert_ne!(text, larger);
    check(TOKENIZER, Some(larger.into_bytes()), DECODER, "are of a model with");
}

#[test]
#[cfg_attr(
    not(all(voice, whisper)),
    ignore = "optional: COHABIT_WHISPER names a folder with a Whisper model; and voice"
)]
fn what_is_spoken_is_heard_by_whisper() {
    let folder = std::env::var_os("COHABIT_WHISPER").unwrap();
    let settings = installed();
    let mut engines = heard_with(&settings, folder);
    assert!(engines.lacks.is_empty(), "{:?}", engines.lacks);
    let said = "go to the break room and pick up the bowl";
    let sound = spoken(&mut engines, said);
    let mut recognizer = engines.recognizer.unwrap();
    for bias in [Bias::default(), office()] {
        recognizer.bias(&bias);
        let heard = recognizer.recognize(&sound).unwrap();
        assert_eq!(words(heard.best()), said);
        assert!(heard.confidence() > 0.5, "{}", heard.confidence());
    }
    assert_eq!(recognizer.recognize(&vec![0.0; RATE as usize * 2]).unwrap().best(), "");
}

#[test]
fn what_is_wrong_with_a_voice_of_ones_own_is_not_mended_by_installing() {
    let folder = Folder::of("voice", &[("other.onnx", Vec::new())]);
    for (own, expected) in [(folder.0.as_path(), "other.onnx.json"), (Path::new("/nowhere/voices"), "voice.onnx")] {
        let synthesizer = Source::Folder(own.into());
        let settings = VoiceSettings { recognizer: Source::Off, synthesizer, ..VoiceSettings::installed("/nowhere") };
        let lacks = Engines::open(&settings).lacks;
        let lack = lacks.iter().find(|lack| lack.part == Part::Synthesis).unwrap();
        assert!(lack.why.contains(&own.join(expected).display().to_string()), "{lack}");
        assert!(lack.why.contains("COHABIT_SYNTHESIZER names a folder"), "{lack}");
        assert!(!lack.why.contains("delete") && !lack.why.contains("cohabit voice install"), "{lack}");
    }
}

#[test]
fn where_nothing_is_installed_that_is_said_and_how_to_mend_it() {
    let engines = Engines::open(&VoiceSettings::installed("/nowhere"));
    assert!(engines.recognizer.is_none());
    for part in [Part::VoiceActivity, Part::Recognition, Part::Synthesis] {
        let lack = engines.lacks.iter().find(|lack| lack.part == part).unwrap().to_string();
        assert!(
            lack.contains("/nowhere") && lack.contains("cohabit voice install") && lack.contains("Instead"),
            "{lack}"
        );
    }
    let off =
        VoiceSettings { recognizer: Source::Off, synthesizer: Source::Off, ..VoiceSettings::installed("/nowhere") };
    let engines = Engines::open(&off);
    assert!(engines.recognizer.is_none() && engines.synthesizer.is_none() && engines.lacks.len() == 1);
    let folder = Source::Folder(Path::new("/nowhere/model").into());
    let other = VoiceSettings { recognizer: folder, ..VoiceSettings::installed("/nowhere") };
    assert!(Engines::open(&other).lacks.iter().any(|lack| lack.why.contains("/nowhere/model/encoder_model")));
    let error = SpeechError::Sound("none".into()).to_string();
    assert_eq!(error, "read the sound: none");
}
