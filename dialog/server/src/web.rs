//! The page's server: a handful of files, a WebSocket, and the newest frame as a picture.

use std::{collections::HashMap, io, net::TcpListener, sync::Arc};

use axum::{
    Extension, Router,
    extract::{Query, State, WebSocketUpgrade},
    http::{StatusCode, header},
    response::{IntoResponse, Response},
    routing::get,
};
use serde_json::Value;

use crate::{
    connections::Ends,
    hosts::HostName,
    hub::Hub,
    limits::{LONGEST_MESSAGE, ServerLimits},
    page,
    person_seats::PersonSeats,
    same_user::is_same_user,
    screening::Screening,
    seat,
    site::{Framing, Site, file, file_routes, media},
    texts::{PagePart, PageTexts},
    tls::Identity,
    token, viewer,
    visit::{self, Live},
    wizard::Holding,
};

const INDEX: &str = include_str!("../../web/index.html");
const SEAT: &str = include_str!("../../web/wizard.html");
/// The page's other files: path, media type, text.
const FILES: [(&str, &str, &str); 21] = [
    ("/app.js", media::SCRIPT, include_str!("../../web/app.js")),
    ("/dom.js", media::SCRIPT, include_str!("../../web/dom.js")),
    ("/driving.js", media::SCRIPT, include_str!("../../web/driving.js")),
    ("/face.js", media::SCRIPT, include_str!("../../web/face.js")),
    ("/floor.js", media::SCRIPT, include_str!("../../web/floor.js")),
    ("/goals.js", media::SCRIPT, include_str!("../../web/goals.js")),
    ("/page.js", media::SCRIPT, include_str!("../../web/page.js")),
    ("/replay.js", media::SCRIPT, include_str!("../../web/replay.js")),
    ("/socket.js", media::SCRIPT, include_str!("../../web/socket.js")),
    ("/survey.js", media::SCRIPT, include_str!("../../web/survey.js")),
    ("/sound.js", media::SCRIPT, include_str!("../../web/sound.js")),
    ("/talk.js", media::SCRIPT, include_str!("../../web/talk.js")),
    ("/texts.js", media::SCRIPT, include_str!("../../web/texts.js")),
    ("/view.js", media::SCRIPT, include_str!("../../web/view.js")),
    ("/microphone.js", media::SCRIPT, include_str!("../../web/microphone.js")),
    ("/voice.js", media::SCRIPT, include_str!("../../web/voice.js")),
    ("/style.css", media::STYLE, include_str!("../../web/style.css")),
    ("/access.css", media::STYLE, include_str!("../../web/access.css")),
    // They are there in every session, so that nobody learns from them whether a wizard takes part.
    ("/wizard.css", media::STYLE, include_str!("../../web/wizard.css")),
    ("/menu.js", media::SCRIPT, include_str!("../../web/menu.js")),
    ("/wizard.js", media::SCRIPT, include_str!("../../web/wizard.js")),
];
const ICON: &str = include_str!("../../web/favicon.svg");

/// What every page has to do with.
#[derive(Clone)]
pub struct Service {
    /// What all pages share.
    pub hub: Arc<Hub>,
    /// What pages see.
    pub host: Host,
    /// What lets a page in.
    pub token: Arc<str>,
    /// The wizard's seat, if a wizard takes part.
    pub seat: Option<Seat>,
    /// The seats of people who have a page of their own, if any do.
    pub people: Arc<PersonSeats>,
    /// Whether the user who runs the session is let in on this machine without the token, too.
    pub admits_own_user: bool,
    /// The hosts that it is served as, besides those of this machine.
    pub hosts: Vec<HostName>,
    /// How long anybody may keep a place, and how many there are.
    pub limits: ServerLimits,
    /// What it is served with by HTTPS, if it is.
    pub identity: Option<Identity>,
    /// Whose pages may show the page within them.
    pub framing: Framing,
    /// What participants read on it.
    pub texts: Arc<PageTexts>,
}

/// The wizard's seat of a session.
#[derive(Clone)]
pub struct Seat {
    /// What lets a wizard in, and nobody else, the user who runs the session neither.
    token: Arc<str>,
    /// What their page is told of how they take part.
    told: Arc<Value>,
}

impl Seat {
    /// A seat behind that token.
    pub fn new(token: &str, holding: &Holding) -> Self {
        Self { token: token.into(), told: Arc::new(page::seat(holding)) }
    }
}

/// Whose page somebody asks for, or opens.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Role {
    /// That of somebody who speaks with the robot, or looks at what was recorded.
    Participant,
    /// The same of somebody with a seat, by its number.
    Seated(usize),
    /// The wizard's.
    Wizard,
}

/// What pages see: a session that goes on, or one that was recorded.
#[derive(Clone)]
pub enum Host {
    /// People speak, and drive.
    Live(Live),
    /// People look.
    Recorded(Arc<Screening>),
}

/// Serves on `listener` until `over`.
pub fn serve(listener: TcpListener, service: Service, over: &dyn Fn() -> bool) -> io::Result<()> {
    let (identity, limits, framing) = (service.identity.clone(), service.limits, service.framing);
    let hosts = service.hosts.clone();
    Site { router: router(service), hosts, identity, limits, framing }.serve(listener, over)
}

fn router(service: Service) -> Router {
    file_routes(FILES)
        .route("/", get(index))
        .route("/wizard", get(wizard))
        .route("/favicon.svg", get(|| file(media::SVG, ICON)))
        .route("/frame.jpg", get(frame))
        .route("/ws", get(socket))
        .with_state(service)
}

type Parameters = Query<HashMap<String, String>>;

/// Whose page a token opens, if any; without one, the user who runs the session is a participant.
fn role(service: &Service, parameters: &Parameters, ends: Ends) -> Option<Role> {
    let given = parameters.get("token").map(String::as_str);
    if service.seat.as_ref().is_some_and(|seat| token::admits(&seat.token, given)) {
        return Some(Role::Wizard);
    }
    if let Some(number) = service.people.find(given) {
        return Some(Role::Seated(number));
    }
    // What comes by a proxy or a tunnel comes from a program of this user, or of root, whoever sent it.
    let is_direct = service.hosts.is_empty();
    let is_own_user = || service.admits_own_user && is_direct && is_same_user(ends.client, ends.server);
    (token::admits(&service.token, given) || given.is_none() && is_own_user()).then_some(Role::Participant)
}

/// The refusal of who asks for the page of a role and has another one or none: the same, whether a wizard takes part or not.
fn refused(service: &Service, parameters: &Parameters, ends: Ends, wanted: Role) -> Option<Response> {
    let wanted_page = |found: Role| match found {
        Role::Seated(_) => wanted == Role::Participant,
        other => other == wanted,
    };
    (!role(service, parameters, ends).is_some_and(wanted_page)).then(refusal)
}

fn refusal() -> Response {
    (StatusCode::FORBIDDEN, "This session asks for its token: open the address that was printed when it started.\n")
        .into_response()
}

async fn index(State(service): State<Service>, Extension(ends): Extension<Ends>, parameters: Parameters) -> Response {
    if let Some(refusal) = refused(&service, &parameters, ends, Role::Participant) {
        return refusal;
    }
    ([(header::CONTENT_TYPE, media::HTML)], service.texts.page(PagePart::Session, INDEX)).into_response()
}

async fn wizard(State(service): State<Service>, Extension(ends): Extension<Ends>, parameters: Parameters) -> Response {
    if let Some(refusal) = refused(&service, &parameters, ends, Role::Wizard) {
        return refusal;
    }
    // The seat's scripts are those of the session's page; the seat is in English.
    ([(header::CONTENT_TYPE, media::HTML)], PageTexts::default().page(PagePart::Session, SEAT)).into_response()
}

async fn frame(State(service): State<Service>, Extension(ends): Extension<Ends>, parameters: Parameters) -> Response {
    if let Some(refusal) = refused(&service, &parameters, ends, Role::Participant) {
        return refusal;
    }
    match service.hub.views.first().and_then(|view| view.newest()) {
        Some(frame) => ([(header::CONTENT_TYPE, "image/jpeg")], frame[16..].to_vec()).into_response(),
        None => (StatusCode::SERVICE_UNAVAILABLE, "There is no frame yet.\n").into_response(),
    }
}

async fn socket(
    State(service): State<Service>,
    Extension(ends): Extension<Ends>,
    parameters: Parameters,
    upgrade: WebSocketUpgrade,
) -> Response {
    let Some(role) = role(&service, &parameters, ends) else { return refusal() };
    // A page keeps its key when it connects again; one that has none is somebody new.
    let key = parameters.get("visitor").and_then(|key| key.parse().ok()).unwrap_or_else(cohabit_bus::monotonic_nanos);
    let comer = match role {
        Role::Seated(number) => service.people.comer(number),
        Role::Participant | Role::Wizard => PersonSeats::stranger(key),
    };
    let Service { hub, host, limits, seat, .. } = service;
    // A frame is read as a whole before its message is found too long.
    upgrade.max_frame_size(LONGEST_MESSAGE).max_message_size(LONGEST_MESSAGE).on_upgrade(move |socket| async move {
        match (host, role, seat) {
            (Host::Live(live), Role::Wizard, Some(seat)) => {
                seat::decide(hub, live.talk, seat.told, socket, limits).await;
            }
            (Host::Live(live), ..) => visit::converse(hub, live, socket, comer, limits).await,
            (Host::Recorded(screening), ..) => viewer::watch(hub, screening, socket, limits).await,
        }
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
