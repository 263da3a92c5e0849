//! What a session draws, sounds and is looked at with.

use std::{
    fs, io,
    net::TcpListener,
    process::{Command, Stdio},
    thread,
    time::{Duration, Instant},
};

use cohabit_gpu::{Adapter, GpuError, Wanted};

use super::{finding::Finding, machine::Machine};

/// How long drivers may take to load.
const PATIENCE: Duration = Duration::from_secs(15);
const BROWSERS: [&str; 8] = [
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
    "firefox",
    "firefox-esr",
    "microsoft-edge",
    "brave-browser",
];
/// What the process that looks for a GPU says of a driver in software.
const SOFTWARE: &str = "software ";
/// And of a GPU.
const REAL: &str = "gpu ";

/// Looks for a GPU and prints it. A process of its own does this: drivers may end the one that loads them.
pub fn print_gpu() {
    match Adapter::find(Wanted::Any) {
        Ok(adapter) => println!("{}{}", if adapter.is_software() { SOFTWARE } else { REAL }, adapter.describe()),
        Err(GpuError::NoAdapter { .. }) => {}
        Err(error) => println!("error {error}"),
    }
}

/// Whether there is a GPU.
pub fn gpu(machine: &Machine) -> Finding {
    judge_gpu(ask_for_gpu(machine))
}

fn ask_for_gpu(machine: &Machine) -> io::Result<String> {
    let mut child = Command::new(&machine.program)
        .args(["doctor", "--print-gpu"])
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()?;
    let deadline = Instant::now() + PATIENCE;
    while child.try_wait()?.is_none() {
        if Instant::now() > deadline {
            child.kill()?;
            child.wait()?;
            return Err(io::Error::other("its driver does not answer"));
        }
        thread::sleep(Duration::from_millis(5));
    }
    let output = child.wait_with_output()?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned());
    }
    Err(io::Error::other(format!("a driver ended the process that loaded it ({})", output.status)))
}

fn judge_gpu(answer: io::Result<String>) -> Finding {
    const COSTS: &str =
        "frames are drawn on the CPU: a robot's 300x300 planes in some milliseconds, large cameras less often";
    let text = match answer {
        Ok(text) => text,
        Err(error) => {
            return Finding::costs(format!("{error}"), COSTS, "mend the driver; `--renderer cpu` leaves it alone");
        }
    };
    if let Some(name) = text.strip_prefix(REAL) {
        return Finding::good(name);
    }
    let found = text.strip_prefix(SOFTWARE).map(|name| format!("none but a driver in software, {name}"));
    let found = found.or_else(|| text.strip_prefix("error ").map(|error| format!("none that can be used: {error}")));
    Finding::costs(found.unwrap_or_else(|| "none".to_owned()), COSTS, "")
}

/// Whether there is something to hear and speak with: for the browser on this machine.
pub fn audio(machine: &Machine) -> Finding {
    let names = fs::read_dir(machine.at("dev/snd")).into_iter().flatten().flatten();
    let names: Vec<_> = names.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    // `pcmC0D0c` captures, `pcmC0D0p` plays.
    let count = |ending: char| names.iter().filter(|name| name.starts_with("pcm") && name.ends_with(ending)).count();
    let found = match (count('c'), count('p')) {
        (0, 0) => "none".to_owned(),
        (microphones, speakers) => format!("{microphones} to record, {speakers} to play"),
    };
    Finding::good(format!("{found}, for a page that is open here"))
}

/// Whether the page's port is free.
pub fn port(machine: &Machine) -> Finding {
    let page = machine.page;
    match TcpListener::bind(page) {
        Ok(_) => Finding::good(format!("{page} is free")),
        Err(error) => Finding::costs(
            format!("{page}: {error}"),
            "`cohabit play` cannot serve its page there",
            "`--port 0` takes any that is free",
        ),
    }
}

/// Whether there is something to look at the page with.
pub fn browser(machine: &Machine) -> Finding {
    if let Some(program) = machine.program(&BROWSERS) {
        return Finding::good(program.display().to_string());
    }
    let costs = "the page cannot be seen on this machine";
    Finding::costs("none", costs, "install one, or open the page from another machine: `cohabit play --listen 0.0.0.0`")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::doctor::finding::State;

    #[test]
    fn software_is_no_gpu() {
        let judge = |text: &str| judge_gpu(Ok(text.to_owned()));
        assert_eq!(judge("gpu Big Chip (discrete)"), Finding::good("Big Chip (discrete)"));
        let found = judge("software llvmpipe");
        assert_eq!((found.state, found.found.as_str()), (State::Costs, "none but a driver in software, llvmpipe"));
        assert_eq!(judge("").found, "none");
        let broken = judge_gpu(Err(io::Error::other("a driver ended it")));
        assert_eq!((broken.state, broken.found.as_str()), (State::Costs, "a driver ended it"));
    }
}
