//! The guide is served from the program itself, to this machine alone, and printed.

use std::{
    io::{BufRead as _, BufReader, Read as _, Write as _},
    net::TcpStream,
    process::{Child, Command, Stdio},
    time::Duration,
};

use cohabit_tests::{Browser, Tab, run};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::{Value, json};

use crate::{COHABIT, accessibility};

/// The longest that an answer is waited for.
const WATCHDOG: Duration = Duration::from_secs(60);

/// A guide that is served, and where; killed when dropped.
struct Served {
    child: Child,
    address: String,
}

impl Served {
    fn start() -> Self {
        let mut child = Command::new(COHABIT)
            .args(["guide", "--port", "0", "--open", "no"])
            .stdout(Stdio::piped())
            .stdin(Stdio::null())
            .spawn()
            .unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let address = line.split_whitespace().find_map(|word| word.strip_prefix("http://"));
        let address = address.unwrap_or_else(|| panic!("no address in {line}")).trim_end_matches('/').to_owned();
        Self { child, address }
    }

    /// The status and the whole answer to who asks for a path of this host.
    fn get(&self, host: &str, path: &str) -> (String, String) {
        let mut stream = TcpStream::connect(&self.address).unwrap();
        stream.set_read_timeout(Some(WATCHDOG)).unwrap();
        let request = format!("GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n");
        stream.write_all(request.as_bytes()).unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        let answer = String::from_utf8_lossy(&answer).into_owned();
        (answer.split(' ').nth(1).unwrap_or_default().to_owned(), answer)
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A page of the guide in a browser.
fn open(browser: &Browser, served: &Served, path: &str) -> Tab {
    let mut tab = browser.open(&format!("http://{}{path}", served.address), 1280, 800).unwrap();
    tab.wait_until("document.readyState === 'complete' && document.querySelector('main h1') !== null").unwrap();
    tab
}

/// Addresses of this site that a page refers to, without headings.
fn addresses(html: &str) -> Vec<String> {
    let parts = ["href=\"/", "src=\"/"].into_iter().flat_map(|mark| html.split(mark).skip(1));
    parts.map(|part| format!("/{}", part.split(['"', '#']).next().unwrap_or_default())).collect()
}

#[test]
fn each_page_and_all_that_it_refers_to_is_served_and_nothing_to_other_sites() {
    let mut served = Served::start();
    assert!(served.address.starts_with("127.0.0.1:"), "{}", served.address);
    let own = served.address.clone();
    let mut open = vec!["/".to_owned()];
    let mut seen = std::collections::BTreeSet::new();
    while let Some(path) = open.pop() {
        if seen.insert(path.clone()) {
            let (status, answer) = served.get(&own, &path);
            assert_eq!(status, "200", "{path}");
            assert!(answer.to_lowercase().contains("content-security-policy: default-src 'self'"), "{path}");
            if answer.contains("text/html") {
                assert!(answer.contains("<html lang=\"en\">") && !answer.contains("<script"), "{path}");
                open.extend(addresses(&answer));
            }
        }
    }
    for path in ["/guide.css", "/study", "/pictures/page.jpg"] {
        assert!(seen.contains(path), "{path} of {seen:?}");
    }
    let (status, answer) = served.get(&own, "/nowhere");
    assert!(status == "404" && answer.contains("href=\"/study\""), "{answer}");
    for path in ["/", "/study", "/nowhere"] {
        assert_eq!(served.get("evil.example", path).0, "403", "{path}");
    }
    kill_process(Pid::from_raw(i32::try_from(served.child.id()).unwrap()).unwrap(), Signal::INT).unwrap();
    assert!(served.child.wait().unwrap().success());
}

#[test]
#[cfg_attr(not(all(browser, python)), ignore = "needs a browser, and Python 3.10 or later with venv")]
fn everybody_can_use_the_guide() {
    let served = Served::start();
    let browser = Browser::start().unwrap();
    for path in ["/", "/study", "/nowhere"] {
        let mut tab = open(&browser, &served, path);
        for scheme in ["dark", "light"] {
            accessibility::wish(&mut tab, "prefers-color-scheme", scheme);
            accessibility::check(&mut tab, &format!("{path}, {scheme}"));
        }
        accessibility::check_with_more_contrast(&mut tab, path);
        accessibility::check_keyboard(&mut tab, path);
    }
    // All others are looked over at one size.
    let mut tab = open(&browser, &served, "/");
    let list = "[...document.querySelectorAll('.contents a')].map((one) => one.pathname)";
    let paths = tab.evaluate(list).unwrap();
    let paths: Vec<&str> = paths.as_array().unwrap().iter().filter_map(Value::as_str).collect();
    assert!(paths.contains(&"/study"), "{paths:?}");
    for path in paths {
        tab.call("Page.navigate", &json!({ "url": format!("http://{}{path}", served.address) })).unwrap();
        tab.wait_until(&format!("location.pathname === '{path}' && document.readyState === 'complete'")).unwrap();
        accessibility::check_here(&mut tab, path);
    }
}

#[test]
fn a_page_is_printed_and_an_unknown_one_is_refused_with_those_that_there_are() {
    let output = run(COHABIT, &["guide", "--text", "study"]).unwrap();
    assert!(output.status.success() && output.stdout.starts_with(b"# "), "{output:?}");
    let output = run(COHABIT, &["guide", "--text", "studies"]).unwrap();
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{told}");
    assert!(told.contains("no page `studies`") && told.contains("first-session, "), "{told}");
    assert!(told.lines().count() == 1 && output.stdout.is_empty(), "{told}");
}
