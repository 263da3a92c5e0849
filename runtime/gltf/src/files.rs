//! Bytes of buffers and pictures: embedded, or of files in the document's own folder. Nothing leads out of that.

use std::{
    borrow::Cow,
    cell::Cell,
    fs::{self, File},
    io::Read as _,
    path::{Path, PathBuf},
};

use base64::{Engine as _, engine::general_purpose::STANDARD};

use crate::error::GltfError;

/// The most bytes of a document and of all files that it names.
pub(crate) const LARGEST: u64 = 256 << 20;
const SMALLER: &str = "export fewer or simpler objects, with smaller textures";

/// The folder that a document lies in, if it is a file.
#[derive(Debug)]
pub(crate) struct Files<'a> {
    folder: Option<&'a Path>,
    left: Cell<u64>,
}

/// The bytes of a document's own file.
///
/// # Errors
/// [`GltfError`] says why it is not read.
pub fn read_document(path: &Path) -> Result<Vec<u8>, GltfError> {
    let named = |reason: String| GltfError::at(path.display().to_string(), reason);
    let (bytes, length) = read(path, LARGEST).map_err(named)?;
    if length > LARGEST {
        return Err(GltfError::TooMany { what: "bytes or more", have: length, most: LARGEST, remedy: SMALLER });
    }
    Ok(bytes)
}

/// The bytes of a file, or no more than that many of them and how many there are at least.
fn read(path: &Path, most: u64) -> Result<(Vec<u8>, u64), String> {
    let failed = |error: std::io::Error| error.to_string();
    let metadata = fs::metadata(path).map_err(failed)?;
    if !metadata.is_file() {
        return Err("no file".to_owned());
    }
    let mut bytes = Vec::new();
    File::open(path).and_then(|file| file.take(most.saturating_add(1)).read_to_end(&mut bytes)).map_err(failed)?;
    let length = bytes.len() as u64;
    Ok((bytes, length))
}

impl<'a> Files<'a> {
    pub(crate) fn new(folder: Option<&'a Path>) -> Self {
        Self { folder, left: Cell::new(LARGEST) }
    }

    /// What a URI of the document means; `at` is where it stands.
    pub(crate) fn uri(&self, uri: &str, at: &str) -> Result<Cow<'static, [u8]>, GltfError> {
        let bytes = match uri.strip_prefix("data:") {
            Some(data) => embedded(data).map_err(|reason| GltfError::at(at, reason))?,
            None => self.beside(uri).map_err(|reason| {
                let name: String = uri.chars().take(200).collect();
                GltfError::Beside { at: at.to_owned(), name, reason }
            })?,
        };
        let length = bytes.len() as u64;
        let left = self.left.get().checked_sub(length);
        let too_many =
            || GltfError::TooMany { what: "bytes or more", have: LARGEST + 1, most: LARGEST, remedy: SMALLER };
        self.left.set(left.ok_or_else(too_many)?);
        Ok(Cow::Owned(bytes))
    }

    fn beside(&self, uri: &str) -> Result<Vec<u8>, String> {
        let path = relative(uri)?;
        let folder = self.folder.ok_or("there is no folder to look for it in")?;
        let root = fs::canonicalize(folder).map_err(|error| error.to_string())?;
        let real = fs::canonicalize(root.join(path)).map_err(|error| format!("{error}; put it beside the document"))?;
        if !real.starts_with(&root) {
            return Err("a link that leads out of the document's folder: put a copy in its place".to_owned());
        }
        Ok(read(&real, self.left.get())?.0)
    }
}

/// What stands behind `data:`.
fn embedded(data: &str) -> Result<Vec<u8>, &'static str> {
    let (_, text) = data.split_once(";base64,").ok_or("its data are not in base64: export the model as .glb")?;
    STANDARD.decode(text).map_err(|_| "its base64 is broken: export the model anew")
}

/// The path that a URI means, which leads nowhere but into the folder.
fn relative(uri: &str) -> Result<PathBuf, String> {
    let path = decoded(uri).ok_or("it is no path: name a file in the document's folder")?;
    if path.contains(':') {
        return Err("only files in the document's own folder are read: export the model as .glb".to_owned());
    }
    let leads_out = path.starts_with('/') || path.contains(['\\', '\0']) || path.split('/').any(|part| part == "..");
    if path.is_empty() || leads_out {
        return Err("it leads out of the document's folder: put the file beside the document".to_owned());
    }
    Ok(PathBuf::from(path))
}

/// The text with each `%` and two hexadecimal digits replaced by what they stand for.
fn decoded(uri: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((first, behind)) = rest.split_first() {
        rest = behind;
        if *first == b'%' {
            let (digits, behind) = rest.split_at_checked(2)?;
            let digits = str::from_utf8(digits).ok().filter(|digits| digits.bytes().all(|b| b.is_ascii_hexdigit()))?;
            bytes.push(u8::from_str_radix(digits, 16).ok()?);
            rest = behind;
        } else {
            bytes.push(*first);
        }
    }
    String::from_utf8(bytes).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_paths_within_the_folder_are_followed() {
        for (uri, expected) in [
            ("wheel.bin", Some("wheel.bin")),
            ("./textures/red%20paint.png", Some("./textures/red paint.png")),
            ("../wheel.bin", None),
            ("a/%2e%2e/%2E%2E/wheel.bin", None),
            ("/etc/passwd", None),
            ("%2fetc%2fpasswd", None),
            ("a\\..\\wheel.bin", None),
            ("http://example.org/wheel.bin", None),
            ("file:///etc/passwd", None),
            ("file:wheel.bin", None),
            ("wheel%", None),
            ("wheel%+1", None),
            ("%ff", None),
            ("", None),
        ] {
            assert_eq!(relative(uri).ok(), expected.map(PathBuf::from), "{uri}");
        }
    }

    #[test]
    fn links_that_lead_out_are_refused() {
        let outer = std::env::temp_dir().join(format!("cohabit-gltf-files-{}", std::process::id()));
        let folder = outer.join("model");
        fs::create_dir_all(&folder).unwrap();
        fs::write(outer.join("secret.bin"), "secret").unwrap();
        fs::write(folder.join("own.bin"), "own").unwrap();
        let _ = std::os::unix::fs::symlink("../secret.bin", folder.join("link.bin"));
        let files = Files::new(Some(&folder));
        let said = |uri: &str| files.uri(uri, "buffers[0]").unwrap_err().to_string();
        let read = files.uri("own.bin", "buffers[0]").unwrap();
        let texts = [said("link.bin"), said("absent.bin"), said("."), said("http://localhost/x.bin")];
        fs::remove_dir_all(outer).unwrap();
        assert_eq!(&*read, b"own");
        for (text, expected) in texts.iter().zip(["leads out", "put it beside", "no file", "only files in"]) {
            assert!(text.contains(expected) && text.contains("buffers[0]"), "{text}");
        }
    }
}
