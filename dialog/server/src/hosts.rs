//! The hosts that the page's server answers for, and the origins that it answers to.
//!
//! A page of another site can have its own name lead to this machine (DNS rebinding). To the browser that page and this
//! server are then of one origin, so a server that compares the origin with the host alone lets it in. Only the name in
//! the request tells: what is not a known name of this server is refused. An address cannot be rebound, a name can.

use std::{
    fmt, fs,
    net::{IpAddr, SocketAddr},
    str::FromStr,
};

use axum::http::{HeaderMap, HeaderName, Uri, header, uri::Authority};

/// A host that the page may be asked for by, besides those of this machine, such as that of a proxy.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct HostName {
    name: String,
    /// The port of the page, if absent.
    port: Option<u16>,
}

/// Why a host cannot be one.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
#[error(
    "`{0}` is no host: write a name or an address, and a port if it is not the page's, such as `lab.example.org:443`"
)]
pub struct NoHost(String);

impl FromStr for HostName {
    type Err = NoHost;

    fn from_str(text: &str) -> Result<Self, NoHost> {
        let authority = authority(text).ok_or_else(|| NoHost(text.to_owned()))?;
        Ok(Self { name: authority.host().to_ascii_lowercase(), port: authority.port_u16() })
    }
}

impl fmt::Display for HostName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)?;
        self.port.map_or(Ok(()), |port| write!(f, ":{port}"))
    }
}

/// The hosts that a server answers for.
#[derive(Clone, Debug)]
pub struct Hosts {
    /// Where it listens.
    address: SocketAddr,
    is_encrypted: bool,
    /// What this machine is called in its network, where other machines reach the server.
    machine: Option<String>,
    added: Vec<HostName>,
}

/// Why a request is refused, for the person who made it.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// It names no host, several, or one that cannot be.
    #[error("This request names no host that can be read.")]
    NoHost,
    /// It asks for a host that the page is not served as.
    #[error(
        "The page is not served as `{0}`. Open the address that was printed when the session started, or start it with \
         `--host {0}`."
    )]
    OtherHost(String),
    /// A page of another site made it.
    #[error("Pages of other sites cannot use a session.")]
    OtherOrigin,
}

impl Hosts {
    /// The hosts of a server that listens at `address`: its own, those of this machine, and those that were `added`.
    pub fn new(address: SocketAddr, is_encrypted: bool, added: Vec<HostName>) -> Self {
        let machine = if address.ip().is_loopback() { None } else { machine_name() };
        Self { address, is_encrypted, machine, added }
    }

    /// Finds out whether a request may be answered; gives the host that it asks for.
    pub fn check(&self, uri: &Uri, headers: &HeaderMap) -> Result<Authority, Refusal> {
        let host = only(headers, &header::HOST).ok_or(Refusal::NoHost)?;
        let host = authority(host).ok_or(Refusal::NoHost)?;
        let is_same_target = uri.authority().is_none_or(|target| is_same(target, &host));
        let schemes = self.schemes(&host).filter(|_| is_same_target);
        let schemes = schemes.ok_or_else(|| Refusal::OtherHost(host.to_string()))?;
        if headers.contains_key(header::ORIGIN) {
            let origin = only(headers, &header::ORIGIN).and_then(|origin| origin.split_once("://"));
            let is_own = |(scheme, site): (&str, &str)| {
                schemes.contains(&scheme) && authority(site).is_some_and(|site| is_same(&site, &host))
            };
            if !origin.is_some_and(is_own) {
                return Err(Refusal::OtherOrigin);
            }
        }
        Ok(host)
    }

    /// The schemes by which browsers may have got a page of this host; `None`, if it is none of this server's.
    fn schemes(&self, host: &Authority) -> Option<&'static [&'static str]> {
        let name = host.host();
        let own: &[&str] = if self.is_encrypted { &["https"] } else { &["http"] };
        let usual_port = if self.is_encrypted { 443 } else { 80 };
        if self.is_own_name(name) && host.port_u16().unwrap_or(usual_port) == self.address.port() {
            return Some(own);
        }
        let is_added = |added: &HostName| {
            let port = added.port.unwrap_or(self.address.port());
            name.eq_ignore_ascii_case(&added.name)
                && host.port_u16().map_or([80, 443].contains(&port), |asked| asked == port)
        };
        // A proxy may serve by HTTPS what it gets by HTTP.
        self.added.iter().any(is_added).then_some(&["http", "https"])
    }

    fn is_own_name(&self, name: &str) -> bool {
        if name.eq_ignore_ascii_case("localhost") {
            return true;
        }
        let bare = name.strip_prefix('[').and_then(|name| name.strip_suffix(']')).unwrap_or(name);
        match bare.parse::<IpAddr>() {
            Ok(ip) if self.address.ip().is_unspecified() => ip.is_loopback() || !ip.is_unspecified(),
            Ok(ip) => ip.is_loopback() || ip == self.address.ip(),
            Err(_) => self.machine.as_deref().is_some_and(|machine| {
                name.eq_ignore_ascii_case(machine) || name.eq_ignore_ascii_case(&format!("{machine}.local"))
            }),
        }
    }
}

/// What this machine is called by others in its network.
fn machine_name() -> Option<String> {
    let name = fs::read_to_string("/proc/sys/kernel/hostname").ok()?;
    Some(name.trim().to_owned()).filter(|name| !name.is_empty())
}

/// A host and its port, if that is what `text` is.
fn authority(text: &str) -> Option<Authority> {
    let is_plain = !text.contains('@') && !text.ends_with(':');
    text.parse().ok().filter(|authority: &Authority| is_plain && !authority.host().is_empty())
}

fn is_same(one: &Authority, other: &Authority) -> bool {
    one.as_str().eq_ignore_ascii_case(other.as_str())
}

/// The value of a header that is there once.
fn only<'a>(headers: &'a HeaderMap, name: &HeaderName) -> Option<&'a str> {
    let mut values = headers.get_all(name).iter();
    let first = values.next()?;
    values.next().is_none().then(|| first.to_str().ok())?
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// What becomes of a request for `host`, made by a page of `origin`.
    fn asked(hosts: &Hosts, host: &str, origin: Option<&str>) -> Result<String, Refusal> {
        let mut headers = HeaderMap::new();
        headers.insert(header::HOST, host.parse().unwrap());
        if let Some(origin) = origin {
            headers.insert(header::ORIGIN, origin.parse().unwrap());
        }
        hosts.check(&Uri::from_static("/"), &headers).map(|host| host.to_string())
    }

    fn hosts(address: &str, is_encrypted: bool, added: &[&str]) -> Hosts {
        let added = added.iter().map(|name| name.parse().unwrap()).collect();
        Hosts { machine: Some("Labor".to_owned()), ..Hosts::new(address.parse().unwrap(), is_encrypted, added) }
    }

    #[test]
    fn only_names_of_this_server_are_answered() {
        let local = hosts("127.0.0.1:8765", false, &["tunnel.example", "lab.example:443"]);
        let local = Hosts { machine: None, ..local };
        let outside = hosts("192.0.2.7:8765", false, &[]);
        let all = hosts("0.0.0.0:8765", true, &[]);
        let check = |hosts: &Hosts, host: &str, is_answered: bool| {
            assert_eq!(asked(hosts, host, None).is_ok(), is_answered, "{host} of {hosts:?}");
        };
        for host in ["127.0.0.1:8765", "127.1.2.3:8765", "localhost:8765", "LocalHost:8765", "[::1]:8765"] {
            [&local, &outside, &all].into_iter().for_each(|hosts| check(hosts, host, true));
        }
        for host in
            ["evil.example:8765", "localhost.evil.example:8765", "127.0.0.1.evil.example:8765", "localhost:8766"]
        {
            [&local, &outside, &all].into_iter().for_each(|hosts| check(hosts, host, false));
        }
        for host in ["localhost", "me@localhost:8765", "localhost:8765:8765", "localhost:", ":8765", "2130706433:8765"]
        {
            [&local, &outside, &all].into_iter().for_each(|hosts| check(hosts, host, false));
        }
        check(&local, "tunnel.example:8765", true);
        check(&local, "tunnel.example:80", false);
        check(&local, "lab.example", true);
        check(&local, "lab.example:443", true);
        check(&local, "lab.example:8765", false);
        check(&local, "192.0.2.7:8765", false);
        check(&local, "labor:8765", false);
        check(&outside, "192.0.2.7:8765", true);
        check(&outside, "192.0.2.8:8765", false);
        check(&outside, "labor:8765", true);
        check(&outside, "labor.local:8765", true);
        check(&outside, "labor.evil.example:8765", false);
        check(&all, "192.0.2.8:8765", true);
        check(&all, "[2001:db8::1]:8765", true);
        check(&hosts("127.0.0.1:80", false, &[]), "localhost", true);
        check(&hosts("127.0.0.1:443", true, &[]), "localhost", true);
    }

    #[test]
    fn a_page_of_another_origin_is_refused() {
        let plain = hosts("127.0.0.1:8765", false, &["lab.example:443"]);
        let encrypted = hosts("127.0.0.1:8765", true, &[]);
        let check = |hosts: &Hosts, host: &str, origin: &str, is_answered: bool| {
            let answered = asked(hosts, host, Some(origin));
            assert_eq!(answered.is_ok(), is_answered, "{origin} of {host}: {answered:?}");
        };
        check(&plain, "localhost:8765", "http://localhost:8765", true);
        check(&plain, "localhost:8765", "http://LOCALHOST:8765", true);
        check(&plain, "lab.example", "https://lab.example", true);
        check(&encrypted, "localhost:8765", "https://localhost:8765", true);
        check(&encrypted, "localhost:8765", "http://localhost:8765", false);
        for origin in
            ["http://evil.example:8765", "http://127.0.0.1:8765", "http://localhost:8766", "null", "file://", ""]
        {
            check(&plain, "localhost:8765", origin, false);
        }
        // The rebinding page: both are its own.
        check(&plain, "evil.example:8765", "http://evil.example:8765", false);
    }

    #[test]
    fn what_can_be_read_in_two_ways_is_refused() {
        let local = hosts("127.0.0.1:8765", false, &[]);
        let mut headers = HeaderMap::new();
        assert_eq!(local.check(&Uri::from_static("/"), &headers), Err(Refusal::NoHost));
        headers.append(header::HOST, "localhost:8765".parse().unwrap());
        assert!(local.check(&Uri::from_static("/"), &headers).is_ok());
        assert!(local.check(&Uri::from_static("http://evil.example:8765/"), &headers).is_err());
        headers.append(header::HOST, "evil.example:8765".parse().unwrap());
        assert_eq!(local.check(&Uri::from_static("/"), &headers), Err(Refusal::NoHost));
    }

    #[test]
    fn a_host_that_cannot_be_one_is_named() {
        for text in ["", "a b", "http://lab.example", "me@lab.example", "lab.example/page", "lab.example:"] {
            let problem = text.parse::<HostName>().map_err(|error| error.to_string());
            assert!(problem.as_ref().is_err_and(|problem| problem.contains("is no host")), "{text}: {problem:?}");
        }
        for text in ["lab.example", "lab.example:443", "[2001:db8::1]:80"] {
            assert_eq!(text.parse::<HostName>().unwrap().to_string(), text);
        }
    }
}
