//! Serves the page of a recorded session.

use std::{
    collections::BTreeMap,
    net::{SocketAddr, TcpListener},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
};

use cohabit_bus::{Pauses, Transport, Wake, message::CameraRecord};
use cohabit_cdf::{Catalog, Layout, Mission};
use cohabit_record::Log;
use serde_json::json;

use crate::{
    DialogError, frames,
    hosts::HostName,
    hub::Hub,
    limits::ServerLimits,
    page, recorded, robots,
    screening::Screening,
    site::Framing,
    token, until_ended,
    view::View,
    web::{self, Host, Service},
    world_state::wait_for_world,
};

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
    let bodies = wait_for_world(bus, &|| stop.load(Ordering::Relaxed))?;
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
