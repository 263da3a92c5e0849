//! The page's server: a handful of files, a WebSocket, and the newest frame as a picture.

use std::{collections::HashMap, io, net::TcpListener, sync::Arc, time::Duration};

use axum::{
    Router,
    extract::{Query, State, WebSocketUpgrade},
    http::{HeaderMap, StatusCode, header},
    response::{IntoResponse, Response},
    routing::get,
};

use crate::{
    driving::Drivers,
    hub::Hub,
    limits::LONGEST_MESSAGE,
    screening::Screening,
    survey::Survey,
    talk::Talk,
    tls::{Encrypted, Identity},
    token, viewer, visit,
    voice::Voice,
};

const INDEX: &str = include_str!("../../web/index.html");
const SCRIPT_TYPE: &str = "text/javascript; charset=utf-8";
/// The page's other files: path, media type, text.
const FILES: [(&str, &str, &str); 14] = [
    ("/app.js", SCRIPT_TYPE, include_str!("../../web/app.js")),
    ("/dom.js", SCRIPT_TYPE, include_str!("../../web/dom.js")),
    ("/driving.js", SCRIPT_TYPE, include_str!("../../web/driving.js")),
    ("/floor.js", SCRIPT_TYPE, include_str!("../../web/floor.js")),
    ("/goals.js", SCRIPT_TYPE, include_str!("../../web/goals.js")),
    ("/replay.js", SCRIPT_TYPE, include_str!("../../web/replay.js")),
    ("/socket.js", SCRIPT_TYPE, include_str!("../../web/socket.js")),
    ("/survey.js", SCRIPT_TYPE, include_str!("../../web/survey.js")),
    ("/sound.js", SCRIPT_TYPE, include_str!("../../web/sound.js")),
    ("/talk.js", SCRIPT_TYPE, include_str!("../../web/talk.js")),
    ("/view.js", SCRIPT_TYPE, include_str!("../../web/view.js")),
    ("/microphone.js", SCRIPT_TYPE, include_str!("../../web/microphone.js")),
    ("/voice.js", SCRIPT_TYPE, include_str!("../../web/voice.js")),
    ("/style.css", "text/css; charset=utf-8", include_str!("../../web/style.css")),
];
const ICON: &str = include_str!("../../web/favicon.svg");
const POLICY: &str = "default-src 'self'; img-src 'self' blob:; style-src 'self'; connect-src 'self' ws: wss:";

/// What every page has to do with.
#[derive(Clone)]
pub struct Service {
    /// What all pages share.
    pub hub: Arc<Hub>,
    /// What pages see.
    pub host: Host,
    /// What lets a page in.
    pub token: Option<Arc<str>>,
    /// What it is served with by HTTPS, if it is.
    pub identity: Option<Identity>,
}

/// What pages see: a session that goes on, or one that was recorded.
#[derive(Clone)]
pub enum Host {
    /// People speak, and drive.
    Live(Live),
    /// People look.
    Recorded(Arc<Screening>),
}

/// What pages of a session that goes on have to do with.
#[derive(Clone)]
pub struct Live {
    /// The conversation.
    pub talk: Arc<Talk>,
    /// Who drives.
    pub drivers: Arc<Drivers>,
    /// What people are asked.
    pub survey: Arc<Survey>,
    /// Voice.
    pub voice: Arc<Voice>,
}

/// Serves on `listener` until `over`.
pub fn serve(listener: TcpListener, service: Service, over: &dyn Fn() -> bool) -> io::Result<()> {
    let identity = service.identity.clone();
    let files = FILES
        .into_iter()
        .fold(Router::new(), |router, (path, kind, text)| router.route(path, get(move || file(kind, text))));
    let router = files
        .route("/", get(index))
        .route("/favicon.svg", get(|| file("image/svg+xml", ICON)))
        .route("/frame.jpg", get(frame))
        .route("/ws", get(socket))
        .with_state(service);
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build()?;
    let served = runtime.block_on(async {
        listener.set_nonblocking(true)?;
        let listener = tokio::net::TcpListener::from_std(listener)?;
        let served = async {
            match identity {
                Some(identity) => axum::serve(Encrypted::new(listener, &identity)?, router).await,
                None => axum::serve(listener, router).await,
            }
        };
        tokio::select! {
            served = served => served,
            () = until(over) => Ok(()),
        }
    });
    runtime.shutdown_timeout(Duration::from_millis(100));
    served
}

async fn until(over: &dyn Fn() -> bool) {
    while !over() {
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
}

async fn file(kind: &'static str, text: &'static str) -> Response {
    ([(header::CONTENT_TYPE, kind), (header::CACHE_CONTROL, "no-cache")], text).into_response()
}

type Parameters = Query<HashMap<String, String>>;

fn refused(service: &Service, parameters: &Parameters) -> Option<Response> {
    let given = parameters.get("token").map(String::as_str);
    let admitted = token::admits(service.token.as_deref(), given);
    (!admitted).then(|| {
        (StatusCode::FORBIDDEN, "This session asks for its token: open the address that was printed when it started.\n")
            .into_response()
    })
}

async fn index(State(service): State<Service>, parameters: Parameters) -> Response {
    if let Some(refusal) = refused(&service, &parameters) {
        return refusal;
    }
    let kind = "text/html; charset=utf-8";
    let headers = [
        (header::CONTENT_TYPE, kind),
        (header::CACHE_CONTROL, "no-cache"),
        (header::CONTENT_SECURITY_POLICY, POLICY),
        (header::REFERRER_POLICY, "no-referrer"),
    ];
    (headers, INDEX).into_response()
}

async fn frame(State(service): State<Service>, parameters: Parameters) -> Response {
    if let Some(refusal) = refused(&service, &parameters) {
        return refusal;
    }
    match service.hub.views.first().and_then(|view| view.newest()) {
        Some(frame) => {
            let headers = [(header::CONTENT_TYPE, "image/jpeg"), (header::CACHE_CONTROL, "no-store")];
            (headers, frame[16..].to_vec()).into_response()
        }
        None => (StatusCode::SERVICE_UNAVAILABLE, "There is no frame yet.\n").into_response(),
    }
}

async fn socket(
    State(service): State<Service>,
    parameters: Parameters,
    headers: HeaderMap,
    upgrade: WebSocketUpgrade,
) -> Response {
    if let Some(refusal) = refused(&service, &parameters) {
        return refusal;
    }
    if !same_origin(&headers) {
        return (StatusCode::FORBIDDEN, "Pages of other sites cannot speak to a session.\n").into_response();
    }
    // A page keeps its key when it connects again; one that has none is somebody new.
    let key = parameters.get("visitor").and_then(|key| key.parse().ok()).unwrap_or_else(cohabit_bus::monotonic_nanos);
    let Service { hub, host, .. } = service;
    upgrade.max_message_size(LONGEST_MESSAGE).on_upgrade(move |socket| async move {
        match host {
            Host::Live(live) => visit::converse(hub, live, socket, key).await,
            Host::Recorded(screening) => viewer::watch(hub, screening, socket).await,
        }
    })
}

/// A browser names the site that opens a socket; only our own page may. Other programs name none.
fn same_origin(headers: &HeaderMap) -> bool {
    let text = |name| headers.get(name).and_then(|value| value.to_str().ok());
    match (text(header::ORIGIN), text(header::HOST)) {
        (None, _) => true,
        (Some(origin), Some(host)) => origin.split_once("://").is_some_and(|(_, site)| site == host),
        (Some(_), None) => false,
    }
}
