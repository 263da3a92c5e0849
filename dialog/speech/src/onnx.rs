//! The runtime of models, loaded from where it is installed, and models in it.

use std::{
    path::{Path, PathBuf},
    sync::Mutex,
};

use ort::{
    environment::Environment,
    ep::CPU,
    logging::LogLevel,
    session::{Session, builder::GraphOptimizationLevel},
    value::ValueType,
};

use crate::{SpeechError, model_file::INSTALL};

/// The runtime's library, within the data folder.
pub(crate) const LIBRARY: &str = "runtime/libonnxruntime.so";

/// The runtime of this process. It cannot be unloaded, so whoever asks with another library gets the first one.
static RUNTIME: Mutex<Option<Environment>> = Mutex::new(None);

/// Loads the runtime from its library, once a process.
///
/// # Errors
/// [`SpeechError::Missing`] or [`SpeechError::Broken`].
pub(crate) fn load(library: &Path) -> Result<(), SpeechError> {
    let mut runtime = RUNTIME.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    if runtime.is_some() {
        return Ok(());
    }
    if !library.is_file() {
        return Err(SpeechError::Missing { path: library.into(), remedy: INSTALL.into() });
    }
    whole_library(library)?;
    let builder = ort::init_from(library).map_err(|error| broken(library, error))?;
    let environment = builder.with_name("cohabit").with_telemetry(false).build();
    let environment = environment.map_err(|error| broken(library, error))?;
    environment.set_log_level(LogLevel::Fatal);
    *runtime = Some(environment);
    Ok(())
}

/// Whether a runtime is loaded.
pub(crate) fn is_loaded() -> bool {
    RUNTIME.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).is_some()
}

/// A model, on so many threads.
///
/// # Errors
/// [`SpeechError::Missing`] or [`SpeechError::Broken`], which name it.
pub(crate) fn open(model: &Path, threads: usize) -> Result<Session, SpeechError> {
    if !model.is_file() {
        return Err(SpeechError::Missing { path: model.into(), remedy: INSTALL.into() });
    }
    let runtime = RUNTIME.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
    let environment = runtime.as_ref().expect("invariant: engines load the runtime before their models");
    let session = || -> ort::Result<Session> {
        // Neither arena nor patterns: they would keep what the longest utterance took.
        let mut builder = Session::builder(environment)?
            .with_optimization_level(GraphOptimizationLevel::Level3)?
            .with_intra_threads(threads)?
            .with_inter_threads(1)?
            .with_intra_op_spinning(false)?
            .with_memory_pattern(false)?
            .with_execution_providers([CPU::default().with_arena_allocator(false).build()])?;
        builder.commit_from_file(model)
    };
    session().map_err(|error| broken(model, error))
}

/// The shape of what a model takes by a name, -1 where any length will do.
pub(crate) fn shape(session: &Session, input: &str) -> Option<Vec<i64>> {
    let input = session.inputs().iter().find(|other| other.name() == input)?;
    match input.dtype() {
        ValueType::Tensor { shape, .. } => Some(shape.to_vec()),
        _ => None,
    }
}

fn broken(path: &Path, error: impl std::fmt::Display) -> SpeechError {
    let why = error.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
    SpeechError::Broken { path: path.into(), why, remedy: remedy(path) }
}

/// What to do about a broken file.
pub(crate) fn remedy(path: &Path) -> String {
    let folder: PathBuf = path.parent().map(Path::to_path_buf).unwrap_or_default();
    format!("delete {} and run `cohabit voice install`", folder.display())
}

/// A library that was cut off would not be refused when it is loaded, but end the process when its code is reached.
fn whole_library(path: &Path) -> Result<(), SpeechError> {
    use std::io::{Read as _, Seek as _};
    let read = || -> std::io::Result<(u64, [u8; 64])> {
        let mut file = std::fs::File::open(path)?;
        let mut header = [0; 64];
        file.read_exact(&mut header)?;
        Ok((file.seek(std::io::SeekFrom::End(0))?, header))
    };
    let (length, header) = read().map_err(|error| broken(path, error))?;
    if &header[..5] != b"\x7fELF\x02" {
        return Err(broken(path, "it is no library for a 64-bit Linux machine"));
    }
    let number =
        |at: usize, bytes: usize| (0..bytes).rev().fold(0u64, |sum, byte| sum << 8 | u64::from(header[at + byte]));
    // The table of sections stands at the end: its place, the size of an entry, and how many there are.
    let end = number(0x28, 8).saturating_add(number(0x3A, 2) * number(0x3C, 2));
    if end > length {
        return Err(broken(path, format!("it has {length} bytes of {end}: it was cut off")));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use std::fs;

    use super::*;

    #[test]
    fn a_library_that_is_none_is_refused_before_it_is_loaded() {
        let path = std::env::temp_dir().join(format!("cohabit-library-{}.so", std::process::id()));
        let mut whole = vec![0; 4_096];
        whole[..5].copy_from_slice(b"\x7fELF\x02");
        whole[0x28..0x30].copy_from_slice(&2_048u64.to_le_bytes());
        whole[0x3A..0x3E].copy_from_slice(&[64, 0, 32, 0]);
        let check = |bytes: &[u8], expected: &str| {
            fs::write(&path, bytes).unwrap();
            let error = whole_library(&path).err().map(|error| error.to_string()).unwrap_or_default();
            assert!(error.contains(expected) && (expected.is_empty() || error.contains("cohabit-library")), "{error}");
        };
        check(&whole, "");
        check(&whole[..3_000], "it has 3000 bytes of 4096: it was cut off");
        check(b"MZ", "cohabit voice install");
        check(&[0; 100], "no library");
        fs::remove_file(&path).unwrap();
    }
}
