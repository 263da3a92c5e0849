//! The Python package: packed as a wheel around the native module and the program of this very build, installed where nothing else is,
//! and tried by the guide's page on it and by its own tests, against sessions of this very binary.
#![allow(clippy::unwrap_used)]

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use cohabit_tests::{Runner, output, python_with};

/// The binary under test.
const COHABIT: &str = env!("CARGO_BIN_EXE_cohabit");
/// The package's sources.
const PACKAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../agents/python");
/// The root of the repository, and the page of the guide that needs the package.
const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
const PAGE: &str = "runtime/guide/src/python.md";
/// Where all of it happens.
const FOLDER: &str = concat!(env!("CARGO_TARGET_TMPDIR"), "/python");

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap().map(Result::unwrap) {
        let (path, name) = (entry.path(), entry.file_name());
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
        if ["py", "pyi", "typed"].contains(&ending) || name == "py.typed" {
            fs::copy(&path, to.join(name)).unwrap();
        }
    }
}

/// The wheel, as maturin describes it, with the native module that cargo has built for these tests.
fn pack(python: &Path) -> Result<PathBuf, String> {
    let wheels = Path::new(FOLDER).join("wheels");
    let tree = Path::new(FOLDER).join("tree");
    for folder in [&wheels, &tree] {
        let _ = fs::remove_dir_all(folder);
        fs::create_dir_all(folder).unwrap();
    }
    let maturin = python.with_file_name("maturin");
    let describe = ["pep517", "write-dist-info", "--compatibility", "linux", "--metadata-directory"];
    output(Command::new(maturin).args(describe).arg(&tree).current_dir(PACKAGE))?;
    copy(&Path::new(PACKAGE).join("python/cohabit"), &tree.join("cohabit"));
    let native = Path::new(COHABIT).with_file_name("deps").join("lib_native.so");
    fs::copy(native, tree.join("cohabit/_native.abi3.so")).map_err(|error| format!("the native module: {error}"))?;
    let scripts = data_folder(&tree).join("scripts");
    fs::create_dir_all(&scripts).unwrap();
    output(Command::new("strip").arg("-o").arg(scripts.join("cohabit")).arg(COHABIT))?;
    output(Command::new(python).args(["-m", "wheel", "pack"]).arg(&tree).arg("--dest-dir").arg(&wheels))?;
    let mut packed = fs::read_dir(&wheels).unwrap().map(|entry| entry.unwrap().path());
    packed.next().ok_or_else(|| "no wheel was packed".to_owned())
}

/// Where a wheel keeps what is installed elsewhere than beside its modules.
fn data_folder(tree: &Path) -> PathBuf {
    let mut names = fs::read_dir(tree).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let described = names.find_map(|name| name.strip_suffix(".dist-info").map(str::to_owned)).unwrap();
    tree.join(format!("{described}.data"))
}

#[test]
#[cfg_attr(not(python), ignore = "needs Python 3.10 or later with venv")]
fn the_package_passes_its_own_tests() {
    let python = python_with(&Path::new(PACKAGE).join("requirements.txt"), Path::new(FOLDER)).unwrap();
    let wheel = pack(&python).unwrap();
    let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps", "--force-reinstall"];
    output(Command::new(&python).args(install).arg(&wheel)).unwrap();
    let version = output(Command::new(python.with_file_name("cohabit")).arg("--version")).unwrap();
    assert_eq!(version.stdout, output(Command::new(COHABIT).arg("--version")).unwrap().stdout);
    let shown = output(Command::new(python.with_file_name("auditwheel")).arg("show").arg(&wheel)).unwrap();
    assert!(String::from_utf8_lossy(&shown.stdout).contains("manylinux_2_"), "{shown:?}");
    let examples = Path::new(PACKAGE).join("examples");
    for example in fs::read_dir(examples).unwrap().map(|entry| entry.unwrap().path()) {
        output(Command::new(&python).arg(example)).unwrap();
    }
    let page = fs::read_to_string(Path::new(ROOT).join(PAGE)).unwrap();
    let programs = [python.parent().unwrap().to_owned()];
    let (binary, repository) = (Path::new(COHABIT), Path::new(ROOT));
    let runner = Runner { binary, repository, has: &["python"], path: &programs };
    runner.run(PAGE, &page).unwrap_or_else(|problem| panic!("{problem}"));
    let tests = ["-m", "pytest", "--quiet", "-p", "no:cacheprovider", "tests"];
    let tested = output(Command::new(&python).args(tests).current_dir(PACKAGE));
    println!("{}", String::from_utf8_lossy(&tested.unwrap().stdout));
    let types = ["-m", "mypy", "--no-incremental", "--cache-dir", "/dev/null", "-p", "cohabit"];
    output(Command::new(&python).args(types).current_dir(FOLDER).arg("--strict")).unwrap();
}
