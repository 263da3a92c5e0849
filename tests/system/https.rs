//! The page by HTTPS, as other machines need it.

use cohabit_tests::{Browser, Play};

use crate::COHABIT;

#[test]
#[cfg_attr(not(browser), ignore = "needs a browser")]
fn a_page_by_https_may_hear_and_is_talked_to_like_any_other() {
    let browser = Browser::start_trusting().unwrap();
    let data = std::env::temp_dir().join(format!("cohabit-https-{}", std::process::id()));
    let environment = [("XDG_DATA_HOME", data.to_str().unwrap())];
    let play = Play::start_in(COHABIT, &["--tls", "--listen", "0.0.0.0"], &environment).unwrap();
    assert!(play.address.starts_with("https://") && play.address.contains("token="), "{}", play.address);
    assert!(!play.address.contains("0.0.0.0"), "nobody can go there: {}", play.address);
    // Whatever stands between this machine and others, it reaches itself.
    let (host, _) = play.authority().split_once(':').unwrap();
    let mut tab = browser.open(&play.address.replace(host, "127.0.0.1"), 1280, 720).unwrap();
    tab.wait_until("document.querySelector('#chat-input') !== null && window.cohabit?.frames > 0").unwrap();
    assert_eq!(tab.evaluate("isSecureContext && navigator.mediaDevices !== undefined").unwrap(), true);
    tab.evaluate("document.querySelector('#chat-input').focus()").unwrap();
    tab.type_and_enter("what can you see?").unwrap();
    tab.wait_until("document.querySelectorAll('#chat .from-robot').length > 0").unwrap();
    drop((tab, browser));
    play.end().unwrap();
    std::fs::remove_dir_all(data).unwrap();
}
