//! The word that lets a page from another machine in.

use std::{
    fmt::Write as _,
    fs::File,
    io,
    io::Read as _,
    net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, UdpSocket},
};

/// A fresh token where `address` can be reached from other machines; none on loopback.
pub fn for_address(address: SocketAddr) -> io::Result<Option<String>> {
    if address.ip().is_loopback() {
        return Ok(None);
    }
    let mut bytes = [0u8; 16];
    File::open("/dev/urandom")?.read_exact(&mut bytes)?;
    Ok(Some(bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })))
}

/// The address to open.
pub fn page_address(address: SocketAddr, encrypted: bool, token: Option<&str>) -> String {
    let scheme = if encrypted { "https" } else { "http" };
    let address = reachable(address);
    match token {
        Some(token) => format!("{scheme}://{address}/?token={token}"),
        None => format!("{scheme}://{address}/"),
    }
}

/// The address at which others reach what listens at `address`, where that is any of this machine's; a machine without a
/// network is reached from itself alone.
fn reachable(address: SocketAddr) -> SocketAddr {
    let ip = match address.ip() {
        IpAddr::V4(ip) if ip.is_unspecified() => {
            own_ip("0.0.0.0:0", "192.0.2.1:9").unwrap_or(Ipv4Addr::LOCALHOST.into())
        }
        IpAddr::V6(ip) if ip.is_unspecified() => {
            own_ip("[::]:0", "[2001:db8::1]:9").unwrap_or(Ipv6Addr::LOCALHOST.into())
        }
        ip => ip,
    };
    SocketAddr::new(ip, address.port())
}

/// The address that this machine has on the way to `there`, an address for examples. Nothing is sent.
fn own_ip(here: &str, there: &str) -> Option<IpAddr> {
    let socket = UdpSocket::bind(here).ok()?;
    socket.connect(there).ok()?;
    Some(socket.local_addr().ok()?.ip())
}

/// Whether `given` is the token, compared in constant time.
pub fn admits(token: Option<&str>, given: Option<&str>) -> bool {
    let Some(token) = token else { return true };
    let given = given.unwrap_or_default();
    given.len() == token.len() && given.bytes().zip(token.bytes()).fold(0, |differ, (a, b)| differ | (a ^ b)) == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_token_is_asked_for_beyond_this_machine_alone() {
        assert_eq!(for_address("127.0.0.1:1".parse().unwrap()).unwrap(), None);
        let token = for_address("0.0.0.0:1".parse().unwrap()).unwrap().unwrap();
        assert_eq!(token.len(), 32);
        assert!(admits(Some(&token), Some(&token)));
        for wrong in [None, Some(""), Some("x"), Some("00000000000000000000000000000000")] {
            assert!(!admits(Some(&token), wrong), "{wrong:?}");
        }
        assert!(admits(None, None));
    }
}
