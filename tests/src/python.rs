//! A Python with the packages that a test needs.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
};

/// Runs a command; its output, or why it failed with all that it said.
pub fn output(command: &mut Command) -> Result<Output, String> {
    let output = command.output().map_err(|error| format!("{command:?}: {error}"))?;
    let text = || [&output.stdout[..], &output.stderr[..]].map(String::from_utf8_lossy).concat();
    if output.status.success() { Ok(output) } else { Err(format!("{command:?}: {}\n{}", output.status, text())) }
}

/// A Python in `folder` with all that the file `requirements` names, or why there is none. It is kept for the next run.
pub fn python_with(requirements: &Path, folder: &Path) -> Result<PathBuf, String> {
    let told = |path: &Path, error| format!("{}: {error}", path.display());
    let wanted = fs::read_to_string(requirements).map_err(|error| told(requirements, error))?;
    let (venv, done) = (folder.join("venv"), folder.join("installed.txt"));
    let python = venv.join("bin/python");
    if fs::read_to_string(&done).is_ok_and(|installed| installed == wanted) && python.exists() {
        return Ok(python);
    }
    fs::create_dir_all(folder).map_err(|error| told(folder, error))?;
    output(Command::new("python3").args(["-c", "import sys, venv; assert sys.version_info >= (3, 10), sys.version"]))?;
    output(Command::new("python3").args(["-m", "venv", "--clear"]).arg(&venv))?;
    let pip = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--only-binary", ":all:", "-r"];
    output(Command::new(&python).args(pip).arg(requirements))?;
    fs::write(&done, wanted).map_err(|error| told(&done, error))?;
    Ok(python)
}
