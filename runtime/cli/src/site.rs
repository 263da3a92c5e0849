//! Where the sites of this program are served, such as that of a study; sessions have options of their own.

use std::{
    ffi::OsString,
    net::{IpAddr, SocketAddr, TcpListener},
    sync::atomic::{AtomicBool, Ordering},
};

use anyhow::Context as _;
use cohabit_dialog::{HostName, Identity};

use crate::{failure::environment, tls::Tls};

/// Where a site is served, besides its port.
#[derive(clap::Args, Clone)]
pub struct SiteOptions {
    /// The address the pages listen on, such as 0.0.0.0 for other machines
    #[arg(long, default_value = "127.0.0.1")]
    listen: IpAddr,
    /// A name by which browsers may ask for the pages besides those of this machine; as often as needed
    #[arg(long = "host", value_name = "NAME[:PORT]")]
    pub hosts: Vec<HostName>,
    #[command(flatten)]
    pub tls: Tls,
}

impl SiteOptions {
    /// What it is served with by HTTPS, if it is.
    pub fn identity(&self) -> anyhow::Result<Option<Identity>> {
        self.tls.identity(self.listen)
    }

    /// The same as arguments of another process, which may run in another folder.
    pub fn arguments(&self) -> Vec<OsString> {
        let listen = ["--listen".into(), self.listen.to_string().into()];
        // Each page has a port of its own: a name is one at any.
        let hosts = self.hosts.iter().map(|host| format!("--host={}", without_port(&host.to_string())).into());
        listen.into_iter().chain(hosts).chain(self.tls.arguments()).collect()
    }

    /// Listens for who asks for `what`, such as "the study", at a port, and says what has to be known of its encryption.
    pub fn listen(
        &self,
        what: &str,
        port: u16,
        identity: Option<&Identity>,
    ) -> anyhow::Result<(TcpListener, SocketAddr)> {
        let listened = listen(what, SocketAddr::new(self.listen, port))?;
        if let Some(notice) = self.tls.notice(self.listen, identity) {
            println!("{notice}");
        }
        Ok(listened)
    }
}

/// Ends what a site is of when it is dropped: without its pages nobody looks after that any longer.
pub struct Ending<'a>(pub &'a AtomicBool);

impl Drop for Ending<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// A host's name alone.
fn without_port(host: &str) -> &str {
    match host.rsplit_once(':') {
        Some((name, port)) if port.parse::<u16>().is_ok() => name,
        _ => host,
    }
}

/// Listens at an address for who asks for `what`, such as "the guide"; gives the address with the port that it has.
pub fn listen(what: &str, asked: SocketAddr) -> anyhow::Result<(TcpListener, SocketAddr)> {
    let listener = TcpListener::bind(asked).map_err(|error| {
        environment(format!(
            "serve {what} on {asked}: {error}; choose another with `--port` (0 takes any that is free)"
        ))
    })?;
    let listening = listener.local_addr().with_context(|| format!("the address of {what}"))?;
    Ok((listener, listening))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_hosts_at_any_port() {
        for (host, name) in
            [("lab", "lab"), ("lab.example:8443", "lab.example"), ("[::1]", "[::1]"), ("[::1]:80", "[::1]")]
        {
            assert_eq!(without_port(host), name, "{host}");
        }
    }
}
