//! Commands that go on until they are ended: what they are ready by, and what they are started with.

use std::{fs, path::Path};

use super::started::Started;
use crate::shell::Call;

/// What is printed last of all by what serves pages, or clients, as soon as they can come.
const READY: &str = "Ctrl-C";
/// A file of a session's shared memory, as it is mapped by its processes.
const MEMORY: &str = "/dev/shm/cohabit_";

/// The options that name a port, that of pages first.
const PORTS: [&str; 2] = ["--port", "--arena-port"];
/// The port that stands for any that is free.
const FREE: &str = "0";

/// A command that goes on until it is ended.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Service {
    /// It serves pages, or clients, and begins with nothing else there.
    Site,
    /// It joins a session that is there.
    Peer,
}

impl Service {
    /// What a call starts, if that goes on.
    pub fn of(call: &Call) -> Option<Self> {
        let words: Vec<&str> = call.arguments.iter().map(String::as_str).take(2).collect();
        let is_site = match words.as_slice() {
            ["agent", ..] => return Some(Self::Peer),
            ["play" | "edit", ..] | ["study", "run"] => true,
            ["guide", ..] => !call.has("--text"),
            ["annotate", ..] => !call.has("--agreement") && !call.has("--export"),
            ["host", ..] => !call.has("--measure"),
            ["replay", ..] => call.has("--page") || call.has("--branch"),
            ["sim", ..] => call.has("--arena-port"),
            _ => false,
        };
        (is_site && !call.has("--help")).then_some(Self::Site)
    }

    /// Whether it does what it is for; `folder` is the one that it runs in.
    pub fn is_ready(self, call: &Call, folder: &Path, started: &Started) -> bool {
        match self {
            Self::Site => {
                // A session is recorded a moment after its page is served.
                started.said().contains(READY) && call.value("--log").is_none_or(|log| folder.join(log).is_file())
            }
            Self::Peer => {
                let mapped = fs::read_to_string(format!("/proc/{}/maps", started.pid()));
                mapped.is_ok_and(|mapped| mapped.contains(MEMORY))
            }
        }
    }

    /// The arguments of a call, but at ports that are free.
    pub fn arguments(self, call: &Call) -> Vec<String> {
        let mut arguments = call.arguments.clone();
        for option in PORTS {
            let at = arguments.iter().position(|argument| argument.split('=').next() == Some(option));
            let Some(at) = at else { continue };
            if arguments[at] != option {
                arguments[at] = format!("{option}={FREE}");
            } else if let Some(port) = arguments.get_mut(at + 1) {
                FREE.clone_into(port);
            }
        }
        if self == Self::Site && !PORTS.iter().any(|option| call.has(option)) {
            // Behind two dashes stand the options of `play`.
            let is_branched = call.arguments.first().is_some_and(|word| word == "replay") && call.has("--branch");
            let lacks_dashes = is_branched && !arguments.contains(&"--".to_owned());
            arguments.extend(lacks_dashes.then(|| "--".to_owned()));
            arguments.extend([PORTS[0], FREE].map(str::to_owned));
        }
        arguments
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::shell::commands;

    fn call(line: &str) -> Call {
        Call::of(&commands(line)[0]).unwrap()
    }

    #[test]
    fn what_goes_on_is_told_from_what_ends() {
        for (line, expected) in [
            ("cohabit play", Some(Service::Site)),
            ("cohabit play --help", None),
            ("cohabit study run study.toml --folder data", Some(Service::Site)),
            ("cohabit study check study.toml", None),
            ("cohabit edit my-lab/layouts/Workshop.toml", Some(Service::Site)),
            ("cohabit guide", Some(Service::Site)),
            ("cohabit guide --text study", None),
            ("cohabit annotate demonstrations/", Some(Service::Site)),
            ("cohabit annotate demonstrations/ --export", None),
            ("cohabit host --sessions 2", Some(Service::Site)),
            ("cohabit host --measure", None),
            ("cohabit replay a.mcap", None),
            ("cohabit replay a.mcap --page --at 0:20", Some(Service::Site)),
            ("cohabit replay a.mcap --branch 0:20 -- --participant P08", Some(Service::Site)),
            ("cohabit sim --arena-port 5000", Some(Service::Site)),
            ("cohabit agent random --session a --body 1", Some(Service::Peer)),
            ("cohabit top", None),
        ] {
            assert_eq!(Service::of(&call(line)), expected, "{line}");
        }
    }

    #[test]
    fn ports_are_free_ones() {
        for (line, expected) in [
            ("cohabit play --seed 7", "play --seed 7 --port 0"),
            ("cohabit play --port 8765 --seed 7", "play --port 0 --seed 7"),
            ("cohabit play --port=8765", "play --port=0"),
            ("cohabit sim cold_soda --arena-port 5000", "sim cold_soda --arena-port 0"),
            ("cohabit replay a --branch 1 -- --participant P08", "replay a --branch 1 -- --participant P08 --port 0"),
            ("cohabit replay a --branch 1", "replay a --branch 1 -- --port 0"),
            ("cohabit replay a --page", "replay a --page --port 0"),
        ] {
            assert_eq!(Service::Site.arguments(&call(line)).join(" "), expected, "{line}");
        }
        let agent = call("cohabit agent random --session a");
        assert_eq!(Service::Peer.arguments(&agent), agent.arguments);
    }
}
