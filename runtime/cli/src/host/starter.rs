//! Starts the sessions of `cohabit host`, and measures them.

use std::{
    ffi::OsString,
    net::IpAddr,
    path::PathBuf,
    time::{Duration, Instant},
};

use cohabit_bus::monotonic_nanos;
use cohabit_host::{Figures, Hosted, Look, Starter};

use crate::{
    capacity::{ChildSession, used_by},
    sessions,
    site::SiteOptions,
    study::{Ports, Taken},
};

/// How far back missed ticks are counted, ns.
const REACH_NANOS: u64 = 10_000_000_000;
/// How often the memory of a session is looked at, which takes the kernel longer than all else.
const MEMORY_EVERY: Duration = Duration::from_secs(10);

/// Starts sessions, each a `cohabit play` of its own.
pub struct HostStarter {
    /// Where their pages listen.
    pub listen: IpAddr,
    /// How the page of all of them is served, and theirs beside it.
    pub site: SiteOptions,
    /// Their ports; any, if absent.
    pub ports: Option<Ports>,
    /// Where they are recorded.
    pub logs: PathBuf,
    /// With how many threads each draws, if its options do not say so.
    pub threads: Option<usize>,
    /// What else they are played by.
    pub options: Vec<OsString>,
    /// How many were started.
    pub tries: usize,
}

impl HostStarter {
    /// The arguments of `play` for a session of that name.
    fn arguments(&self, name: &str, port: u16, mission: &str) -> Vec<OsString> {
        let Self { listen, site, logs, threads, options, .. } = self;
        let log = logs.join(format!("{}_{name}.mcap", sessions::time())).into_os_string();
        let own = [("--port", port.to_string()), ("--listen", listen.to_string())];
        let own = own.into_iter().flat_map(|(flag, value)| [OsString::from(flag), OsString::from(value)]);
        // Each page has a port of its own: a name is one at any.
        let hosts = site.hosts.iter().map(|host| OsString::from(format!("--host={}", name_of(&host.to_string()))));
        let threads = threads.map(|threads| OsString::from(format!("--threads={threads}")));
        own.chain([OsString::from("--log"), log])
            .chain(hosts)
            .chain(site.tls.arguments())
            .chain(threads)
            .chain(options.iter().cloned())
            .chain([OsString::from(mission)])
            .collect()
    }
}

/// A host's name without its port.
fn name_of(host: &str) -> &str {
    match host.rsplit_once(':') {
        Some((name, port)) if port.parse::<u16>().is_ok() => name,
        _ => host,
    }
}

impl Starter for HostStarter {
    fn start(&mut self, place: usize, mission: &str) -> Result<Box<dyn Hosted>, String> {
        self.tries += 1;
        let name = format!("h{}-{}-{}", std::process::id(), place + 1, self.tries);
        let port = self.ports.as_ref().map(|ports| ports.take(self.listen)).transpose()?;
        let arguments = self.arguments(&name, port.as_ref().map_or(0, Taken::number), mission);
        let session = ChildSession::start(&name, &arguments, Some(format!("session {}", place + 1)))?;
        Ok(Box::new(HostSession { session, _port: port, last: None, memory: None }))
    }
}

/// A session that is played.
struct HostSession {
    session: ChildSession,
    /// The port of its page, which is nobody else's meanwhile.
    _port: Option<Taken>,
    /// When it was last measured, and the processor time that it had used, s.
    last: Option<(Instant, f64)>,
    /// When its memory was looked at, and what it was, bytes.
    memory: Option<(Instant, u64)>,
}

impl Hosted for HostSession {
    fn look(&mut self) -> Look {
        self.session.look()
    }

    fn figures(&mut self) -> Figures {
        self.session.note_ticks();
        let ticked = self.session.ticked_since(monotonic_nanos().saturating_sub(REACH_NANOS));
        let is_due = self.memory.is_none_or(|(at, _)| at.elapsed() >= MEMORY_EVERY);
        let (now, used) = (Instant::now(), used_by(self.session.process(), is_due));
        if is_due {
            self.memory = Some((now, used.memory_bytes));
        }
        let before = self.last.replace((now, used.processor_s));
        let cores = before.map(|(at, before_s)| (used.processor_s - before_s) / (now - at).as_secs_f64().max(1e-3));
        Figures {
            cores: cores.map(|cores| cores.max(0.0)),
            memory_bytes: self.memory.map_or(0, |(_, bytes)| bytes),
            ticks: ticked.ticks,
            missed: ticked.late,
        }
    }

    fn end(&mut self) {
        self.session.end();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_hosts_are_those_of_sessions_at_other_ports() {
        for (host, name) in
            [("lab", "lab"), ("lab.example.org:443", "lab.example.org"), ("[::1]:9", "[::1]"), ("[::1]", "[::1]")]
        {
            assert_eq!(name_of(host), name);
        }
    }
}
