//! A real browser without a window, driven through its debugging protocol.

use std::{
    io::{BufRead as _, BufReader},
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    sync::atomic::{AtomicU32, Ordering},
    time::Instant,
};

use anyhow::{Context as _, bail, ensure};
use serde_json::{Value, json};
use tungstenite::Message;

use crate::socket::{Socket, WATCHDOG};

const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

/// A running browser. Dropping it kills it.
pub struct Browser {
    child: Child,
    profile: PathBuf,
    socket: String,
}

/// One open page of it.
pub struct Tab {
    socket: Socket,
    session: String,
    count: u64,
    problems: Vec<String>,
}

impl Browser {
    /// Starts a browser.
    ///
    /// # Errors
    /// When there is none, or it does not start.
    pub fn start() -> anyhow::Result<Self> {
        Self::start_with(&[])
    }

    /// The same, with a microphone that gives the sound of a WAV file once, and is allowed to every page.
    ///
    /// # Errors
    /// When there is none, or it does not start.
    pub fn start_speaking(wav: &Path) -> anyhow::Result<Self> {
        let sound = format!("--use-file-for-fake-audio-capture={}%noloop", wav.display());
        let gestures = "--autoplay-policy=no-user-gesture-required";
        Self::start_with(&["--use-fake-device-for-media-stream", "--use-fake-ui-for-media-stream", &sound, gestures])
    }

    /// The same, which trusts any certificate.
    ///
    /// # Errors
    /// When there is none, or it does not start.
    pub fn start_trusting() -> anyhow::Result<Self> {
        Self::start_with(&["--ignore-certificate-errors"])
    }

    /// The same, for which these names lead to this machine.
    ///
    /// # Errors
    /// When there is none, or it does not start.
    pub fn start_with_names(names: &[&str]) -> anyhow::Result<Self> {
        let rules: Vec<_> = names.iter().map(|name| format!("MAP {name} 127.0.0.1")).collect();
        Self::start_with(&[&format!("--host-resolver-rules={}", rules.join(","))])
    }

    fn start_with(more: &[&str]) -> anyhow::Result<Self> {
        let program = find().with_context(|| format!("there is no browser here ({})", NAMES.join(", ")))?;
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let profile = std::env::temp_dir().join(format!("cohabit-browser-{}-{number}", std::process::id()));
        let mut child = Command::new(program)
            .args([
                "--headless",
                "--no-sandbox",
                "--disable-gpu",
                "--no-first-run",
                "--hide-scrollbars",
                "--mute-audio",
            ])
            .args(["--remote-debugging-port=0", "--window-size=1280,720"])
            .args(more)
            .arg(format!("--user-data-dir={}", profile.display()))
            .stderr(Stdio::piped())
            .stdout(Stdio::null())
            .stdin(Stdio::null())
            .spawn()
            .context("start the browser")?;
        let mut lines = BufReader::new(child.stderr.take().context("the browser's output")?).lines();
        let socket = lines
            .by_ref()
            .map_while(Result::ok)
            .find_map(|line| Some(line.split_once("listening on ")?.1.to_owned()))
            .context("the browser gives no debugging address")?;
        std::thread::spawn(move || lines.for_each(drop));
        Ok(Self { child, profile, socket })
    }

    /// Opens a page of that size, and waits until it is read.
    ///
    /// # Errors
    /// When the browser does not answer.
    pub fn open(&self, address: &str, width: u32, height: u32) -> anyhow::Result<Tab> {
        let socket = Socket::open(&self.socket)?;
        let mut tab = Tab { socket, session: String::new(), count: 0, problems: Vec::new() };
        let target = tab.call("Target.createTarget", &json!({ "url": "about:blank" }))?;
        let attach = json!({ "targetId": target["targetId"], "flatten": true });
        let session = tab.call("Target.attachToTarget", &attach)?;
        session["sessionId"].as_str().context("a session")?.clone_into(&mut tab.session);
        let size = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600 });
        tab.call("Emulation.setDeviceMetricsOverride", &size)?;
        for domain in ["Page.enable", "Log.enable", "Runtime.enable"] {
            tab.call(domain, &json!({}))?;
        }
        tab.call("Page.navigate", &json!({ "url": address }))?;
        tab.wait_until("location.href !== 'about:blank' && document.readyState !== 'loading'")?;
        Ok(tab)
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
        let _ = std::fs::remove_dir_all(&self.profile);
    }
}

impl Tab {
    /// Calls a method of the debugging protocol.
    ///
    /// # Errors
    /// When it fails, or no answer comes.
    pub fn call(&mut self, method: &str, parameters: &Value) -> anyhow::Result<Value> {
        self.count += 1;
        let mut request = json!({ "id": self.count, "method": method, "params": parameters });
        if !self.session.is_empty() {
            request["sessionId"] = json!(self.session);
        }
        self.socket.send(&request)?;
        loop {
            let Message::Text(text) = self.socket.read().with_context(|| format!("no answer to {method}"))? else {
                continue;
            };
            let answer: Value = serde_json::from_str(&text)?;
            self.problems.extend(problem(&answer));
            if answer["id"] == json!(self.count) {
                ensure!(answer["error"].is_null(), "{method}: {}", answer["error"]);
                return Ok(answer["result"].clone());
            }
        }
    }

    /// What its console told of errors so far, such as that a policy forbade something.
    #[must_use]
    pub fn problems(&self) -> &[String] {
        &self.problems
    }

    /// The value of a JavaScript expression.
    ///
    /// # Errors
    /// When it throws.
    pub fn evaluate(&mut self, expression: &str) -> anyhow::Result<Value> {
        let parameters = json!({ "expression": expression, "returnByValue": true, "awaitPromise": true });
        let answer = self.call("Runtime.evaluate", &parameters)?;
        ensure!(answer["exceptionDetails"].is_null(), "{expression}: {}", answer["exceptionDetails"]);
        Ok(answer["result"]["value"].clone())
    }

    /// Waits until a JavaScript expression holds.
    ///
    /// # Errors
    /// When it does not come to hold.
    pub fn wait_until(&mut self, expression: &str) -> anyhow::Result<()> {
        let deadline = Instant::now() + WATCHDOG;
        while Instant::now() < deadline {
            if self.evaluate(expression)? == json!(true) {
                return Ok(());
            }
            // A frame of the page, so that it can go on.
            self.evaluate("new Promise(done => setTimeout(done, 30))")?;
        }
        bail!("waited in vain for {expression}; the page says: {}", self.evaluate("document.body.innerText")?)
    }

    /// Types text into the element that has the focus, and presses Enter.
    ///
    /// # Errors
    /// When the browser does not answer.
    pub fn type_and_enter(&mut self, text: &str) -> anyhow::Result<()> {
        self.call("Input.insertText", &json!({ "text": text }))?;
        for kind in ["keyDown", "keyUp"] {
            let key =
                json!({ "type": kind, "key": "Enter", "code": "Enter", "windowsVirtualKeyCode": 13, "text": "\r" });
            self.call("Input.dispatchKeyEvent", &key)?;
        }
        Ok(())
    }

    /// A picture of the page, PNG in base64.
    ///
    /// # Errors
    /// When the browser does not answer.
    pub fn screenshot(&mut self) -> anyhow::Result<String> {
        let answer = self.call("Page.captureScreenshot", &json!({ "format": "png" }))?;
        Ok(answer["data"].as_str().context("a picture")?.to_owned())
    }
}

/// What an event of the debugging protocol says is wrong.
fn problem(event: &Value) -> Option<String> {
    let parameters = &event["params"];
    match event["method"].as_str()? {
        "Log.entryAdded" if parameters["entry"]["level"] == "error" => {
            let entry = &parameters["entry"];
            Some(format!("{} {}", entry["text"].as_str()?, entry["url"].as_str().unwrap_or_default()))
        }
        "Runtime.exceptionThrown" => Some(parameters["exceptionDetails"].to_string()),
        _ => None,
    }
}

fn find() -> Option<PathBuf> {
    let paths = std::env::var_os("PATH")?;
    std::env::split_paths(&paths).flat_map(|folder| NAMES.map(|name| folder.join(name))).find(|path| path.is_file())
}
