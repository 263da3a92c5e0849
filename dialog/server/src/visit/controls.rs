//! A page at the controls of a body: what it has before it, what it does, and what comes of that.

use std::time::{Duration, Instant};

use axum::extract::ws::Message;
use cohabit_bus::message::Thing;
use cohabit_cdf::ObjectId;
use serde_json::Value;

use super::{Visit, tell};
use crate::{
    affordances::Deed,
    driving::{Driver, News, Told},
    page,
};

/// Time between two looks at what is before a driven body.
const AIM_EVERY: Duration = Duration::from_millis(90);
/// How fast a page may ask anything to move or turn, m/s and rad/s; the body's own limits are narrower.
const FASTEST: f32 = 20.0;

/// What a driven body has before it, as the page was told.
pub(super) struct Aim {
    told: Value,
    at: Instant,
    /// What was clicked, until the body moves on.
    picked: Option<ObjectId>,
}

impl Aim {
    /// Of a body of which nothing was told yet.
    pub(super) fn new() -> Self {
        Self { told: Value::Null, at: Instant::now(), picked: None }
    }
}

impl Visit {
    /// What is before the driven body, if that is news.
    pub(super) fn look(&mut self, at_once: bool) -> Option<Message> {
        let driver = self.driver.as_ref().filter(|driver| driver.is_driving())?;
        if !at_once && self.aim.at.elapsed() < AIM_EVERY {
            return None;
        }
        self.aim.at = Instant::now();
        let things: Vec<Thing> = match self.aim.picked {
            Some(object) => vec![Thing::Object(object)],
            None if self.feed.view().camera == driver.camera => {
                self.feed.view().ids_in_the_middle().into_iter().map(Thing::of_id).collect()
            }
            None => Vec::new(),
        };
        let aim = self.live.talk.aim(&things, driver.body()).inspect_err(|error| tracing::warn!("{error}")).ok()?;
        (aim != self.aim.told).then(|| {
            self.aim.told = aim;
            Message::text(self.aim.told.to_string())
        })
    }

    /// What the page is told of what the bus told.
    pub(super) fn note(&mut self, news: &News) -> Vec<Message> {
        let Some(driver) = &mut self.driver else { return Vec::new() };
        let body = driver.body();
        match driver.note(news) {
            Ok(None) => Vec::new(),
            Ok(Some(Told::Begun)) => {
                self.aim = Aim::new();
                let begun = tell(&page::driving(Some(body), ""));
                std::iter::once(begun).chain(self.look(true)).collect()
            }
            Ok(Some(Told::Acted(ok, text))) => {
                self.aim.picked = None;
                std::iter::once(tell(&page::acted(ok, &text))).chain(self.look(true)).collect()
            }
            Ok(Some(Told::Over(text))) => self.end(&text),
            Err(error) => {
                tracing::error!("{error}");
                self.end("The session cannot be reached.")
            }
        }
    }

    /// Gives the body back, and says why.
    pub(super) fn end(&mut self, why: &str) -> Vec<Message> {
        self.driver = None;
        vec![tell(&page::driving(None, why))]
    }

    /// Says why a page with a seat may not drive a body: it is not the avatar of that seat.
    pub(super) fn check_seat(&self, body: u32) -> Result<(), String> {
        match self.visitor.seat {
            Some(seat) if seat.body != Some(body) => {
                Err("From this page only your own avatar can be driven.".to_owned())
            }
            _ => Ok(()),
        }
    }

    pub(super) fn drive(&mut self, speeds: [f32; 3]) -> Result<Vec<Message>, String> {
        let Some(driver) = &mut self.driver else { return Ok(Vec::new()) };
        let [forward, turn, pitch] = speeds.map(|speed| speed.clamp(-FASTEST, FASTEST));
        if [forward, turn, pitch] != [0.0; 3] {
            self.aim.picked = None;
        }
        driver.drive(forward, turn, pitch).map_err(|error| error.to_string())?;
        Ok(Vec::new())
    }

    pub(super) fn act(&mut self, deed: Deed, object: ObjectId) -> Result<Vec<Message>, String> {
        if let Some(driver) = &mut self.driver {
            driver.act(deed, object).map_err(|error| error.to_string())?;
        }
        Ok(Vec::new())
    }

    /// Says what somebody points at; who drives may then do something with it.
    pub(super) fn point(
        &mut self,
        camera: &str,
        tick: u64,
        place: [f32; 2],
        received_nanos: u64,
    ) -> Result<Vec<Message>, String> {
        let Some(id) = self.hub.view_of(camera)?.id_at(tick, place) else { return Ok(Vec::new()) };
        let thing = Thing::of_id(id);
        let seen = self.live.talk.seen(thing, place).map_err(|error| error.to_string())?;
        if let (Thing::Object(_) | Thing::Body(_), Some(seen)) = (thing, &seen) {
            let name = seen["name"].as_str().unwrap_or_default();
            self.live.talk.note_pointed(name, self.visitor()).map_err(|error| error.to_string())?;
        }
        if let Thing::Object(object) = thing {
            if may_answer(object, self.driver.is_some(), &self.hub.marked()) {
                self.choose(object, received_nanos, true)?;
            }
            if self.driver.is_some() {
                self.aim.picked = Some(object);
                return Ok(self.look(true).into_iter().collect());
            }
        }
        Ok(seen.iter().map(tell).collect())
    }
}

/// Whether a click on an object may answer what a robot asks. Who drives takes hold of things by clicks, so only what is numbered does.
fn may_answer(object: ObjectId, drives: bool, numbered: &[ObjectId]) -> bool {
    !drives || numbered.contains(&object)
}

/// The next news of who drives; pends where nobody does.
pub(super) async fn next_news(driver: &mut Option<Driver>) -> News {
    if let Some(driver) = driver
        && let Some(news) = driver.news().await
    {
        return news;
    }
    std::future::pending().await
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_drives_answers_by_a_click_on_what_is_numbered() {
        let numbered = [ObjectId(3), ObjectId(5)];
        for (object, drives, expected) in [(5, true, true), (7, true, false), (5, false, true), (7, false, true)] {
            assert_eq!(may_answer(ObjectId(object), drives, &numbered), expected, "{object} {drives}");
        }
    }
}
