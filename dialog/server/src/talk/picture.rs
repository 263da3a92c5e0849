//! What is in the pictures that pages show, and when they show what.

use cohabit_bus::message::{StateView, Thing};
use cohabit_cdf::{Catalog, ObjectId};
use serde_json::Value;

use super::Talk;
use crate::{
    DialogError,
    affordances::{self, Affordance},
    frames::Shown,
    latency::Moments,
    page,
};

impl Talk {
    /// What a thing is that somebody points at, at a place of the picture; `None` if it is gone.
    pub fn seen(&self, thing: Thing, place: [f32; 2]) -> Result<Option<Value>, DialogError> {
        let mut newest = self.state();
        newest.refresh()?;
        Ok(newest.view()?.and_then(|state| page::seen(thing, place, state, &self.catalog)))
    }

    /// What a driven body has before it: the first of `things`, the nearest to the middle first, that it can do most with.
    pub fn aim(&self, things: &[Thing], body: u32) -> Result<Value, DialogError> {
        let mut newest = self.state();
        newest.refresh()?;
        let Some(state) = newest.view()? else { return Ok(page::aim(None, &[], false)) };
        Ok(aimed(things, body, state, &self.catalog))
    }

    /// A frame was shown.
    pub fn note_frame(&self, Shown { tick, sent_nanos }: Shown) -> Result<(), DialogError> {
        let mut delivery = self.delivery();
        let Some(moments) = delivery.latency.shown(tick, sent_nanos) else { return Ok(()) };
        self.hub.tell(&page::latency(&moments, Some(tick)));
        log_latency(&moments);
        delivery.publish_latency(&moments)
    }

    /// A page has shown the frame in which the robot first moved in a turn.
    pub fn note_drawn(&self, turn: u64, nanos: u64) -> Result<(), DialogError> {
        let mut delivery = self.delivery();
        match delivery.latency.drawn(turn, nanos) {
            Some(moments) => delivery.publish_latency(&moments),
            None => Ok(()),
        }
    }
}

fn aimed(things: &[Thing], body: u32, state: StateView<'_>, catalog: &Catalog) -> Value {
    let objects = things.iter().filter_map(|thing| match thing {
        Thing::Object(id) => state.objects.iter().find(|record| record.object == id.0),
        _ => None,
    });
    let seen: Vec<_> = objects
        .map(|record| {
            let (afforded, far) = affordances::afforded(state, body, ObjectId(record.object), catalog);
            (record, afforded, far)
        })
        .collect();
    let is_handled = |afforded: &[Affordance]| afforded.iter().any(|one| affordances::is_of_the_hand(one.deed));
    let best = seen.iter().find(|(_, afforded, _)| is_handled(afforded)).or_else(|| seen.first());
    match best {
        Some((record, afforded, far)) => {
            let far = *far && !is_handled(afforded);
            page::aim(Some((record.object, page::name(record, catalog))), afforded, far)
        }
        None => page::aim(None, &[], false),
    }
}

fn log_latency(moments: &Moments) {
    let [understood, moved, shown] = moments.milliseconds().map(Option::unwrap_or_default);
    tracing::info!(
        "turn {}: understood after {understood:.1} ms, moving after {moved:.1} ms, seen after {shown:.1} ms",
        moments.turn
    );
}
