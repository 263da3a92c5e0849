//! A recorded session on the page: to be looked at, not to be spoken with.

use std::{
    collections::BTreeMap,
    net::{SocketAddr, TcpListener},
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::Duration,
};

use cohabit_bus::{
    Inbox, Listener, Pauses, Publisher, Sample, Topic, Transport, Wake,
    message::{CameraRecord, Control, ControlMessage, ObjectRecord, StateView, Thing},
};
use cohabit_cdf::{Catalog, Layout, Mission};
use cohabit_record::Log;
use serde_json::{Value, json};

use crate::{
    DialogError, frames,
    hosts::HostName,
    hub::Hub,
    limits::ServerLimits,
    page,
    recorded::{self, Told},
    robots,
    site::Framing,
    talk, token, until_ended,
    view::View,
    web::{self, Host, Service},
};

/// How often the page learns where it is.
const STATE_EVERY: Duration = Duration::from_millis(50);
/// Who goes on by more ticks than that at once has not seen what was between: ten seconds.
const LEAP_TICKS: u64 = 600;

/// Settings of a page that shows a recorded session.
pub struct ScreeningConfig<'a> {
    /// What was recorded.
    pub log: &'a Log,
    /// Its mission.
    pub mission: &'a Mission,
    /// Its floor plan.
    pub layout: &'a Layout,
    /// Its objects.
    pub catalog: Arc<Catalog>,
    /// Where the page is served; port 0 takes any that is free.
    pub listen: SocketAddr,
    /// The hosts that the page is served as, besides those of this machine.
    pub hosts: Vec<HostName>,
    /// The session's cameras.
    pub cameras: Vec<CameraRecord>,
    /// The bodies that people spoke to.
    pub robots: Vec<u32>,
    /// What bodies were called, if not by what they are.
    pub names: BTreeMap<u32, String>,
    /// The first tick after which there is a state, and the last.
    pub span: [u64; 2],
    /// Simulated seconds a tick.
    pub tick_s: f64,
}

/// What the pages of a recorded session have to do with.
pub struct Screening {
    inner: Mutex<Inner>,
    hub: Arc<Hub>,
    catalog: Arc<Catalog>,
    told: Vec<(u64, Told)>,
}

struct Inner {
    states: Inbox,
    newest: Option<Sample>,
    controls: Box<dyn Publisher>,
    speed: f32,
    /// Up to where pages were told what was told.
    tick: u64,
}

/// Shows a session that a projector plays on `bus`, until `stop`; `ready` is given the page's address as soon as it can
/// be opened.
///
/// # Errors
/// [`DialogError`].
pub fn screen(
    bus: &dyn Transport,
    config: &ScreeningConfig<'_>,
    stop: &AtomicBool,
    ready: impl FnOnce(&str),
) -> Result<(), DialogError> {
    let ScreeningConfig { log, mission, layout, catalog, .. } = config;
    let bodies = talk::wait_for_world(bus, &|| stop.load(Ordering::Relaxed))?;
    let names = page::body_names(&bodies, &config.names);
    let robots = robots::named(&config.robots, &names);
    let told = recorded::told(log, robots.len() > 1);
    let views = page::views(&config.cameras, &names, robots.len());
    let mut hello = page::hello(&log.session.session, mission, layout, catalog, &views, &[], &robots);
    hello["replay"] = json!({ "span": config.span, "tick_s": config.tick_s, "marks": recorded::marks(&told) });
    let views = views.into_iter().map(|view| View::new(view.camera)).collect();
    let hub = Arc::new(Hub::new(hello, views, Box::new(|| ())));
    let failed = |source| DialogError::Listen { address: config.listen, source };
    let listener = TcpListener::bind(config.listen).map_err(failed)?;
    let token = token::fresh().map_err(DialogError::Serve)?;
    let address = listener.local_addr().map_err(DialogError::Serve)?;
    let screening = Arc::new(Screening::new(bus, Arc::clone(&hub), Arc::clone(catalog), told)?);
    let bell = bus.listener(Wake::State)?;
    let ended = AtomicBool::new(false);
    let over = || stop.load(Ordering::Relaxed) || ended.load(Ordering::Relaxed);
    thread::scope(|scope| {
        let mut workers = vec![scope.spawn(|| until_ended(&ended, || screening.run(bell, &over)))];
        for view in (0..=u8::MAX).zip(&hub.views) {
            let (over, ended) = (&over, &ended);
            workers.push(
                scope.spawn(move || {
                    until_ended(ended, || frames::relay(bus, view, Pauses::default(), &|_| Ok(()), over))
                }),
            );
        }
        ready(&token::page_address(address, false, &token));
        let host = Host::Recorded(Arc::clone(&screening));
        let (hub, hosts, limits) = (Arc::clone(&hub), config.hosts.clone(), ServerLimits::default());
        let (token, framing) = (token.into(), Framing::default());
        let (identity, seat, texts) = (None, None, Arc::default());
        let admits_own_user = true;
        let people = Arc::default();
        let service =
            Service { hub, host, token, seat, people, admits_own_user, identity, hosts, limits, framing, texts };
        let served = web::serve(listener, service, &over).map_err(DialogError::Serve);
        ended.store(true, Ordering::Relaxed);
        workers
            .into_iter()
            .map(|worker| worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
            .fold(served, Result::and)
    })
}

impl Screening {
    /// What is shown to the pages of `hub`: what `bus` tells, and what was `told` at which tick.
    pub fn new(
        bus: &dyn Transport,
        hub: Arc<Hub>,
        catalog: Arc<Catalog>,
        told: Vec<(u64, Told)>,
    ) -> Result<Self, DialogError> {
        let (states, controls) = (Inbox::new(bus, Topic::State)?, bus.publisher(Topic::Control)?);
        let inner = Inner { states, newest: None, controls, speed: 1.0, tick: 0 };
        Ok(Self { inner: Mutex::new(inner), hub, catalog, told })
    }

    fn lock(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn run(&self, mut bell: Box<dyn Listener>, over: &dyn Fn() -> bool) -> Result<(), DialogError> {
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
        inner.refresh()?;
        let Some(sample) = &inner.newest else { return Ok(()) };
        let (now, before) = (sample.envelope().tick, inner.tick);
        let state = StateView::new(sample.payload())?;
        if now < before || now > before + LEAP_TICKS {
            self.hub.rewind(&self.lines_to(now).cloned().collect::<Vec<_>>());
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

    fn tell(&self, told: &Told, state: StateView<'_>) {
        let about = |object: u32, message: &dyn Fn(&ObjectRecord) -> Value| {
            if let Some(record) = state.objects.iter().find(|record| record.object == object) {
                self.hub.tell(&message(record));
            }
        };
        match told {
            Told::Line(line) => self.hub.say(line),
            Told::Page(message) => self.hub.tell(message),
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
        inner.refresh()?;
        let Some(sample) = &inner.newest else { return Ok(None) };
        Ok(page::seen(thing, place, StateView::new(sample.payload())?, &self.catalog))
    }
}

impl Inner {
    fn refresh(&mut self) -> Result<(), DialogError> {
        while let Some((sample, ())) = self.states.next(|sample| StateView::new(sample.payload()).map(drop))? {
            self.newest = Some(sample);
        }
        Ok(())
    }
}
