//! The token that lets a page in: who was given the address may use the session, and no other user of this machine.

use std::{
    fmt::Write as _,
    fs::File,
    io,
    io::Read as _,
    net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, UdpSocket},
};

/// A fresh token: 128 bits by chance.
///
/// # Errors
/// When the system gives no chance.
pub fn fresh() -> io::Result<String> {
    let mut bytes = [0u8; 16];
    File::open("/dev/urandom")?.read_exact(&mut bytes)?;
    Ok(bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    }))
}

/// The address to open.
#[must_use]
pub fn page_address(address: SocketAddr, encrypted: bool, token: &str) -> String {
    format!("{}/?token={token}", site_address(address, encrypted))
}

/// The address that a wizard opens.
#[must_use]
pub fn wizard_address(address: SocketAddr, encrypted: bool, token: &str) -> String {
    format!("{}/wizard?token={token}", site_address(address, encrypted))
}

/// Where others reach what listens at `address`, without a path.
#[must_use]
pub fn site_address(address: SocketAddr, encrypted: bool) -> String {
    let scheme = if encrypted { "https" } else { "http" };
    format!("{scheme}://{}", reachable(address))
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
#[must_use]
pub fn admits(token: &str, given: Option<&str>) -> bool {
    let given = given.unwrap_or_default();
    given.len() == token.len() && given.bytes().zip(token.bytes()).fold(0, |differ, (a, b)| differ | (a ^ b)) == 0
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn the_token_alone_lets_in() {
        let token = fresh().unwrap();
        assert_eq!(token.len(), 32);
        assert_ne!(token, fresh().unwrap());
        assert!(admits(&token, Some(&token)));
        for wrong in [None, Some(""), Some("x"), Some("00000000000000000000000000000000")] {
            assert!(!admits(&token, wrong), "{wrong:?}");
        }
    }

    #[test]
    fn the_printed_address_is_one_that_leads_here() {
        let address = |listen: &str| page_address(listen.parse().unwrap(), false, "abc");
        assert_eq!(address("127.0.0.1:80"), "http://127.0.0.1:80/?token=abc");
        assert!(!address("0.0.0.0:80").contains("0.0.0.0"));
    }
}
