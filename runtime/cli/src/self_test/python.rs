//! Whether the Python package is installed.

use std::{
    io,
    process::{Command, Stdio},
};

use crate::doctor::Finding;

/// The Python that is asked.
const PYTHON: &str = "python3";
/// What it is asked.
const QUESTION: &str = "import cohabit; print(cohabit.__version__)";
/// The version of this program, with which the package shares the messages of a session.
const OWN: &str = env!("CARGO_PKG_VERSION");

/// Whether `python3` has the package, of this version.
pub fn package() -> Finding {
    judge(ask())
}

/// The version that it has; none if it has no such package, or one that cannot be loaded.
fn ask() -> io::Result<Option<String>> {
    let mut python = Command::new(PYTHON);
    // Not where this program was started: a folder of that name is not the package.
    python.args(["-c", QUESTION]).current_dir("/").stdin(Stdio::null());
    let output = python.output()?;
    Ok(output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned()))
}

fn judge(answer: io::Result<Option<String>>) -> Finding {
    const COSTS: &str = "no agents and environments in Python";
    const REMEDY: &str = "`pip install ./agents/python`, in the folder of the source, with the Python that you use";
    match answer {
        Ok(Some(version)) if version == OWN => Finding::good(format!("{version}, for `{PYTHON}`")),
        Ok(Some(version)) => {
            let found = format!("{version}, for `{PYTHON}`; this program is {OWN}");
            Finding::costs(found, "sessions of another version may reject it", REMEDY)
        }
        Ok(None) => Finding::costs(format!("`{PYTHON}` has none that it can load"), COSTS, REMEDY),
        Err(error) => {
            Finding::costs(format!("{PYTHON}: {error}"), COSTS, format!("install Python 3.10 or later, then {REMEDY}"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::doctor::State;

    #[test]
    fn only_the_package_of_this_version_is_good() {
        for (answer, state) in [
            (Ok(Some(OWN.to_owned())), State::Good),
            (Ok(Some("0.0.0".to_owned())), State::Costs),
            (Ok(None), State::Costs),
            (Err(io::Error::from(io::ErrorKind::NotFound)), State::Costs),
        ] {
            let found = judge(answer);
            assert_eq!(found.state, state, "{found:?}");
            assert_eq!(state == State::Good, found.remedy.is_empty(), "{found:?}");
        }
    }
}
