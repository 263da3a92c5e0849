//! A recorded session on the page: to be looked at, not to be spoken with.

use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    thread,
    time::Duration,
};

use cohabit_bus::{
    Listener, Publisher, Topic, Transport,
    message::{Control, ControlMessage, ObjectRecord, StateView, Thing},
};
use cohabit_cdf::Catalog;
use serde_json::{Value, json};

use crate::{
    DialogError,
    expression::FacialExpression,
    hub::Hub,
    page,
    recorded::{self, Told},
    world_state::NewestState,
};

/// How often the page learns where it is.
const STATE_EVERY: Duration = Duration::from_millis(50);
/// Who goes on by more ticks than that at once has not seen what was between: ten seconds.
const LEAP_TICKS: u64 = 600;

/// What the pages of a recorded session have to do with.
pub struct Screening {
    inner: Mutex<Inner>,
    hub: Arc<Hub>,
    catalog: Arc<Catalog>,
    told: Vec<(u64, Told)>,
}

struct Inner {
    state: NewestState,
    controls: Box<dyn Publisher>,
    speed: f32,
    /// Up to where pages were told what was told.
    tick: u64,
}

impl Screening {
    /// What is shown to the pages of `hub`: what `bus` tells, and what was `told` at which tick.
    pub fn new(
        bus: &dyn Transport,
        hub: Arc<Hub>,
        catalog: Arc<Catalog>,
        told: Vec<(u64, Told)>,
    ) -> Result<Self, DialogError> {
        let (state, controls) = (NewestState::new(bus)?, bus.publisher(Topic::Control)?);
        let inner = Inner { state, controls, speed: 1.0, tick: 0 };
        Ok(Self { inner: Mutex::new(inner), hub, catalog, told })
    }

    fn lock(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Shows it to the pages, until `over`.
    pub fn run(&self, mut bell: Box<dyn Listener>, over: &dyn Fn() -> bool) -> Result<(), DialogError> {
        while !over() {
            self.show()?;
            thread::sleep(STATE_EVERY);
            bell.wait(STATE_EVERY)?;
        }
        Ok(())
    }

    /// Tells all pages where it is, and what was told since they last heard of it.
    fn show(&self) -> Result<(), DialogError> {
        let mut inner = self.lock();
        inner.state.refresh()?;
        let Some(state) = inner.state.view()? else { return Ok(()) };
        let (now, before) = (inner.state.tick(), inner.tick);
        if now < before || now > before + LEAP_TICKS {
            self.hub.rewind(&self.lines_to(now).cloned().collect::<Vec<_>>());
            self.show_faces(now);
        } else {
            self.told
                .iter()
                .filter(|(tick, _)| before < *tick && *tick <= now)
                .for_each(|(_, told)| self.tell(told, state));
        }
        if now != before {
            self.hub.mark(&recorded::numbered(self.lines_to(now)));
        }
        let mut message = page::state(now, state, &[], &self.catalog);
        message["player"] = json!({ "paused": state.header.paused == 1, "speed": inner.speed });
        self.hub.show_state(&message);
        inner.tick = now;
        Ok(())
    }

    fn lines_to(&self, now: u64) -> impl DoubleEndedIterator<Item = &page::Line> {
        let told = &self.told[..self.told.partition_point(|(tick, _)| *tick <= now)];
        told.iter().filter_map(|(_, told)| if let Told::Line(line) = told { Some(line) } else { None })
    }

    /// Shows what the faces of robots show at that time: nothing in particular, as long as they have not shown anything.
    fn show_faces(&self, now: u64) {
        let mut faces = BTreeMap::<u32, FacialExpression>::new();
        for (tick, told) in &self.told {
            if let Told::Face(body, shown) = told {
                let face = faces.entry(*body).or_default();
                if *tick <= now {
                    *face = *shown;
                }
            }
        }
        faces.into_iter().for_each(|(body, shown)| self.hub.show_face(body, &page::expression(body, shown)));
    }

    fn tell(&self, told: &Told, state: StateView<'_>) {
        let about = |object: u32, message: &dyn Fn(&ObjectRecord) -> Value| {
            if let Some(record) = state.objects.iter().find(|record| record.object == object) {
                self.hub.tell(&message(record));
            }
        };
        match told {
            Told::Line(line) => self.hub.say(line),
            Told::Page(message) => self.hub.tell(message),
            Told::Face(body, shown) => self.hub.show_face(*body, &page::expression(*body, *shown)),
            Told::Highlight(object) => about(*object, &|record| page::highlight(record, None, &self.catalog)),
            Told::Sound(object, kind) => about(*object, &|record| page::sound(record, kind, &self.catalog)),
        }
    }

    /// Asks for another time, or pace.
    pub fn ask(&self, control: Control) -> Result<(), DialogError> {
        let mut inner = self.lock();
        if let Control::Speed(speed) = control {
            inner.speed = speed;
        }
        inner.controls.send_record(0, &ControlMessage::from(control))?;
        Ok(())
    }

    /// What a thing is that somebody points at, at a place of the picture; `None` if it is not there now.
    pub fn seen(&self, thing: Thing, place: [f32; 2]) -> Result<Option<Value>, DialogError> {
        let mut inner = self.lock();
        inner.state.refresh()?;
        Ok(inner.state.view()?.and_then(|state| page::seen(thing, place, state, &self.catalog)))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use cohabit_bus::{Local, message::StateParts};

    use super::*;

    #[test]
    fn faces_are_those_of_the_time_that_is_shown() {
        let bus = Local::new(1);
        let hub = Arc::new(Hub::new(json!({}), Vec::new(), Box::new(|| ())));
        let told = vec![(700, Told::Face(0, FacialExpression::Sorry)), (2000, Told::Face(0, FacialExpression::Happy))];
        let screening = Screening::new(&bus, Arc::clone(&hub), Arc::new(Catalog::builtin()), told).unwrap();
        let mut states = bus.publisher(Topic::State).unwrap();
        // A leap, what goes by, and a leap back.
        for (tick, shown) in [(1500, "sorry"), (2100, "happy"), (10, "neutral")] {
            let parts = StateParts::default();
            states.send(tick, parts.bytes(), &mut |bytes| parts.write(bytes)).unwrap();
            screening.show().unwrap();
            let known = hub.attend().0;
            assert!(known.iter().any(|message| message.contains(shown)), "{shown}: {known:?}");
        }
    }
}
