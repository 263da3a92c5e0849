//! Voices that speak the commands: Piper, espeak-ng and Flite, as far as they are there.

use std::{
    collections::hash_map::DefaultHasher,
    fs,
    hash::{Hash, Hasher},
    ops::ControlFlow,
    path::{Path, PathBuf},
    process::Command,
};

use cohabit_speech::{RATE, Synthesizer, resample, to_pcm};

use crate::sound::{read_wav, write_wav};

/// One voice; what it says is kept in a folder of its own.
pub struct Voice {
    name: &'static str,
    engine: Engine,
    folder: PathBuf,
}

enum Engine {
    Own(Box<dyn Synthesizer>),
    /// A program, which is given the file to write and the text.
    Program(&'static str, &'static [&'static str]),
}

/// All voices that there are; says which there are not.
pub fn all(own: Option<Box<dyn Synthesizer>>) -> Vec<Voice> {
    let piper = own.filter(|own| own.name().starts_with("Piper")).map(Engine::Own);
    let espeak = Engine::Program("espeak-ng", &["-v", "en-us", "-w", "FILE", "TEXT"]);
    let flite = Engine::Program("flite", &["-voice", "slt", "-o", "FILE", "-t", "TEXT"]);
    let engines = [("Piper", piper), ("espeak-ng", Some(espeak)), ("Flite", Some(flite))];
    let mut voices = Vec::new();
    for (name, engine) in engines {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("voices").join(name);
        fs::create_dir_all(&folder).unwrap();
        let mut voice = engine.map(|engine| Voice { name, engine, folder });
        match voice.as_mut().and_then(|voice| voice.say("go to the break room")) {
            Some(_) => voices.extend(voice),
            None => println!("without the voice of {name}: it is not installed"),
        }
    }
    voices
}

impl Voice {
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// What it says, at [`RATE`].
    pub fn say(&mut self, text: &str) -> Option<Vec<f32>> {
        let mut hasher = DefaultHasher::new();
        text.hash(&mut hasher);
        let path = self.folder.join(format!("{:016x}.wav", hasher.finish()));
        if !path.exists() {
            self.make(text, &path)?;
        }
        read_wav(&path)
    }

    fn make(&mut self, text: &str, path: &Path) -> Option<()> {
        let made = path.with_extension("part.wav");
        match &mut self.engine {
            Engine::Own(own) => {
                let mut samples = Vec::new();
                let rate = own.rate();
                let take = &mut |chunk: &[i16]| {
                    samples.extend(cohabit_speech::from_pcm(chunk));
                    ControlFlow::Continue(())
                };
                own.speak(text, take).ok()?;
                write_wav(&made, &to_pcm(&resample(&samples, rate, RATE).ok()?));
            }
            Engine::Program(program, arguments) => {
                let arguments = arguments.iter().map(|argument| match *argument {
                    "FILE" => made.as_os_str().to_owned(),
                    "TEXT" => text.into(),
                    other => other.into(),
                });
                Command::new(program).args(arguments).status().ok().filter(|status| status.success())?;
            }
        }
        fs::rename(made, path).ok()
    }
}
