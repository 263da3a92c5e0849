//! Somebody who talks to the robot.

use std::time::{Duration, Instant};

use anyhow::{Context as _, ensure};
use cohabit_tests::Page;
use serde_json::Value;

/// What the robot is asked to do: some seconds of work of several kinds.
pub const WORK: &str =
    "turn left 90 degrees, turn right 90 degrees, pick up the soda can and put it on the round table";
/// The longest that anything is waited for.
const WATCHDOG: Duration = Duration::from_secs(60);

/// A person at the page, who opens it again when it fails, and asks again what nobody heard.
pub struct Person {
    /// Where the page is.
    pub authority: String,
    /// The page.
    pub page: Page,
}

impl Person {
    /// A person who opens the page there as soon as it is served.
    pub fn at(authority: &str) -> anyhow::Result<Self> {
        Ok(Self { authority: authority.to_owned(), page: open(authority)? })
    }

    /// Asks for [`WORK`].
    pub fn ask_for_work(&mut self) -> anyhow::Result<()> {
        match self.page.say(WORK) {
            Ok(()) => Ok(()),
            Err(_) => self.come_back(),
        }
    }

    /// Waits until [`WORK`] is done, which was asked for.
    pub fn have_done(&mut self) -> anyhow::Result<()> {
        let is_done = |page: &Page| {
            let met = page.goals().first().is_some_and(|(_, met)| *met);
            let replies = page.chat.iter().filter(|(from, _)| from == "robot").count();
            met && replies >= 2 && page.state["robot"]["holding"].is_null() && page.state["robot"]["busy"] == false
        };
        let deadline = Instant::now() + WATCHDOG;
        loop {
            match self.page.wait("the work to be done", |page, _| is_done(page)) {
                Ok(_) => return Ok(()),
                Err(error) if Instant::now() > deadline => return Err(error),
                Err(_) => self.come_back()?,
            }
        }
    }

    /// Opens the page again, and asks again what nobody heard.
    fn come_back(&mut self) -> anyhow::Result<()> {
        self.page = self.open()?;
        // The chat comes before the state.
        if self.page.wait("the past", |page, _| page.state.is_object()).is_ok()
            && !self.page.chat.iter().any(|(from, text)| from == "person" && text == WORK)
        {
            self.page.say(WORK)?;
        }
        Ok(())
    }

    /// Asks something, which must be a turn after that one: none is forgotten.
    pub fn ask(&mut self, text: &str, after: u64) -> anyhow::Result<()> {
        let turn = match self.say(text) {
            Ok(turn) => turn,
            // Who served the page was killed after all that it was waited for.
            Err(_) => {
                self.come_back()?;
                self.say(text)?
            }
        };
        ensure!(turn > after, "turn {turn} is not after turn {after}");
        self.page.wait("its end", |_, message| message["type"] == "turn" && message["turn"] == turn)?;
        Ok(())
    }

    /// Says something; gives the number of its turn.
    fn say(&mut self, text: &str) -> anyhow::Result<u64> {
        self.page.say(text)?;
        let is_heard = |message: &Value| message["from"] == "person" && message["text"] == text;
        let found = self.page.wait("what was said", |_, message| is_heard(message))?;
        found["turn"].as_u64().context("a turn")
    }

    /// Opens the page again, as soon as it is served.
    pub fn open(&self) -> anyhow::Result<Page> {
        open(&self.authority)
    }
}

fn open(authority: &str) -> anyhow::Result<Page> {
    Page::once_served(|| Page::open(authority))
}
