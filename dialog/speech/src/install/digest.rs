//! What files are, to the last bit.

use std::{
    fs::File,
    io::{self, Read as _},
    path::Path,
};

use sha2::{Digest as _, Sha256};

use super::InstallError;

/// That a file, told of by that name, has the SHA-256 that it should have.
pub fn check(name: &str, path: &Path, expected: &str) -> Result<(), InstallError> {
    let found = of(path).map_err(InstallError::at(path))?;
    if found == expected {
        return Ok(());
    }
    Err(InstallError::Digest { file: name.to_owned(), expected: expected.to_owned(), found })
}

/// The SHA-256 of a file, in hexadecimal.
pub fn of(path: &Path) -> io::Result<String> {
    let (mut file, mut hasher, mut bytes) = (File::open(path)?, Sha256::new(), vec![0; 1 << 16]);
    loop {
        match file.read(&mut bytes)? {
            0 => break,
            length => hasher.update(&bytes[..length]),
        }
    }
    Ok(hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
}
