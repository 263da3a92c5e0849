//! Whether who connects from this machine is the user of this process: the kernel's table of sockets tells.

use std::{
    fs,
    net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr},
    os::unix::fs::MetadataExt as _,
};

/// The kernel's tables of TCP sockets, for IPv4 and IPv6 (`man 5 proc`).
const TABLES: [&str; 2] = ["/proc/net/tcp", "/proc/net/tcp6"];
/// Columns of such a table: a socket's own address, that of its peer, its user, and its inode.
const LOCAL: usize = 1;
const REMOTE: usize = 2;
const USER: usize = 7;
const INODE: usize = 9;
/// The inode of a socket that no process holds any more: the kernel then says that it is root's, whoever's it was.
const CLOSED: &str = "0";

/// Whether the connection from `client` to `server` stays on this machine and was made by the user of this process, or by root,
/// who may read its memory anyway. What cannot be told counts as no.
pub fn is_same_user(client: SocketAddr, server: SocketAddr) -> bool {
    let [client, server] = [client, server].map(canonical);
    if !client.ip().is_loopback() || !server.ip().is_loopback() {
        return false;
    }
    let Ok(own) = fs::metadata("/proc/self").map(|process| process.uid()) else { return false };
    let tables = TABLES.iter().filter_map(|table| fs::read_to_string(table).ok());
    let user = tables.into_iter().find_map(|table| user_of(&table, client, server));
    user.is_some_and(|user| user == own || user == 0)
}

/// The user whose socket at `client` is connected to `server`.
fn user_of(table: &str, client: SocketAddr, server: SocketAddr) -> Option<u32> {
    table.lines().skip(1).find_map(|line| {
        let columns: Vec<&str> = line.split_ascii_whitespace().collect();
        let is = |column: usize, address| columns.get(column).and_then(|text| self::address(text)) == Some(address);
        let is_held = columns.get(INODE).is_some_and(|inode| *inode != CLOSED);
        (is_held && is(LOCAL, client) && is(REMOTE, server)).then(|| columns.get(USER)?.parse().ok())?
    })
}

/// An address of the table: hexadecimal, each 32 bits in the order of this machine's bytes, and the port.
fn address(text: &str) -> Option<SocketAddr> {
    let (ip, port) = text.split_once(':')?;
    let words = ip.as_bytes().chunks(8).map(|word| u32::from_str_radix(std::str::from_utf8(word).ok()?, 16).ok());
    let bytes: Vec<u8> = words.collect::<Option<Vec<u32>>>()?.into_iter().flat_map(u32::to_ne_bytes).collect();
    let ip: IpAddr = match bytes.len() {
        4 => Ipv4Addr::from(<[u8; 4]>::try_from(bytes).ok()?).into(),
        16 => Ipv6Addr::from(<[u8; 16]>::try_from(bytes).ok()?).into(),
        _ => return None,
    };
    Some(canonical(SocketAddr::new(ip, u16::from_str_radix(port, 16).ok()?)))
}

/// An IPv4 address that is written as one of IPv6 is that of IPv4.
fn canonical(address: SocketAddr) -> SocketAddr {
    SocketAddr::new(address.ip().to_canonical(), address.port())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::net::{TcpListener, TcpStream};

    use super::*;

    #[test]
    fn a_connection_of_this_process_is_of_its_user() {
        for listen in ["127.0.0.1:0", "[::1]:0"] {
            // A machine without IPv6 has no such address.
            let Ok(listener) = TcpListener::bind(listen) else { continue };
            let _client = TcpStream::connect(listener.local_addr().unwrap()).unwrap();
            let (server, client) = listener.accept().unwrap();
            assert!(is_same_user(client, server.local_addr().unwrap()), "{listen}");
            // Nobody is connected the other way round from another port.
            let other = SocketAddr::new(client.ip(), client.port() ^ 1);
            assert!(!is_same_user(other, server.local_addr().unwrap()), "{listen}");
        }
    }

    #[test]
    fn the_table_names_the_user_of_the_clients_socket() {
        let word = u32::from_ne_bytes([127, 0, 0, 1]);
        let row = |local: u16, remote: u16, user: u32| {
            format!(
                "   1: {word:08X}:{local:04X} {word:08X}:{remote:04X} 01 00000000:00000000 00:00000000 00000000  {user}  0 5 1\n"
            )
        };
        let table = format!("  sl  local_address rem_address\n{}{}", row(80, 4000, 1), row(4000, 80, 1000));
        let at = |port: u16| SocketAddr::from(([127, 0, 0, 1], port));
        assert_eq!(user_of(&table, at(4000), at(80)), Some(1000));
        assert_eq!(user_of(&table, at(4001), at(80)), None);
        assert_eq!(user_of("", at(4000), at(80)), None);
        let closed = format!("head\n{}", row(4000, 80, 0).replace("0 5 1", "0 0 1"));
        assert_eq!(user_of(&closed, at(4000), at(80)), None, "nobody holds it: it is nobody's");
    }

    #[test]
    fn who_comes_from_elsewhere_is_nobody_known() {
        let there = SocketAddr::from(([192, 0, 2, 1], 4000));
        assert!(!is_same_user(there, SocketAddr::from(([127, 0, 0, 1], 80))));
    }
}
