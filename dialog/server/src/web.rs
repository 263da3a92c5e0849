//! The page's server: a handful of files, a WebSocket, and the newest frame as a picture.

use std::{
    collections::HashMap,
    io,
    net::TcpListener,
    sync::Arc,
    time::{Duration, Instant},
};

use axum::{
    Router,
    extract::{
        Query, State, WebSocketUpgrade,
        ws::{Message, WebSocket},
    },
    http::{HeaderMap, StatusCode, header},
    response::{IntoResponse, Response},
    routing::get,
};
use cohabit_bus::{message::Thing, monotonic_nanos};
use serde::Deserialize;
use serde_json::Value;
use tokio::sync::broadcast::error::RecvError;

use crate::{
    hub::Hub,
    limits::{LONGEST_MESSAGE, LONGEST_TEXT, MOST_PAGES, Throttle},
    page,
    talk::Talk,
    token,
    view::View,
};

const INDEX: &str = include_str!("../../web/index.html");
const SCRIPT: &str = include_str!("../../web/app.js");
const STYLE: &str = include_str!("../../web/style.css");
const ICON: &str = include_str!("../../web/favicon.svg");
const POLICY: &str = "default-src 'self'; img-src 'self' blob:; style-src 'self'; connect-src 'self' ws: wss:";

#[derive(Clone)]
struct Service {
    hub: Arc<Hub>,
    talk: Arc<Talk>,
    token: Option<Arc<str>>,
}

impl Service {
    fn view(&self, camera: &str) -> Result<Arc<View>, String> {
        let is_meant = |view: &&Arc<View>| view.camera.to_string() == camera;
        self.hub.views.iter().find(is_meant).cloned().ok_or_else(|| format!("There is no camera {camera}."))
    }
}

/// What a page sends.
#[derive(Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
enum FromPage {
    /// Somebody said something.
    Say { text: String },
    /// The page has shown its first frame.
    Shown,
    /// Somebody wants to look through another camera.
    View { camera: String },
    /// Somebody points at something in the picture: how far from the left and from the top, 0 to 1.
    Point { camera: String, tick: u64, x: f32, y: f32 },
}

/// Serves on `listener` until `over`.
pub fn serve(
    listener: TcpListener,
    token: Option<String>,
    hub: Arc<Hub>,
    talk: Arc<Talk>,
    over: &dyn Fn() -> bool,
) -> io::Result<()> {
    let service = Service { hub, talk, token: token.map(Arc::from) };
    let router = Router::new()
        .route("/", get(index))
        .route("/app.js", get(|| file("text/javascript; charset=utf-8", SCRIPT)))
        .route("/style.css", get(|| file("text/css; charset=utf-8", STYLE)))
        .route("/favicon.svg", get(|| file("image/svg+xml", ICON)))
        .route("/frame.jpg", get(frame))
        .route("/ws", get(socket))
        .with_state(service);
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build()?;
    let served = runtime.block_on(async {
        listener.set_nonblocking(true)?;
        let listener = tokio::net::TcpListener::from_std(listener)?;
        tokio::select! {
            served = axum::serve(listener, router) => served,
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
    upgrade.max_message_size(LONGEST_MESSAGE).on_upgrade(|socket| async move { converse(service, socket).await })
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

async fn converse(service: Service, mut socket: WebSocket) {
    let Some((first, mut messages, _visit)) = service.hub.join() else {
        let text = format!("{MOST_PAGES} pages are open already; close one and reload.");
        let _ = socket.send(Message::text(page::error(&text).to_string())).await;
        return;
    };
    for message in first {
        if socket.send(Message::text(message)).await.is_err() {
            return;
        }
    }
    let Some(view) = service.hub.views.first() else { return };
    let (mut frames, mut _viewing) = view.join();
    frames.mark_changed();
    let mut throttle = Throttle::new(Instant::now());
    loop {
        let sent = tokio::select! {
            message = messages.recv() => match message {
                Ok(message) => socket.send(Message::text(message.to_string())).await,
                // It fell behind: closing makes it connect again and be told all anew.
                Err(RecvError::Lagged(_) | RecvError::Closed) => return,
            },
            changed = frames.changed() => {
                if changed.is_err() {
                    return;
                }
                let frame = frames.borrow_and_update().clone();
                match frame {
                    Some(frame) => socket.send(Message::binary(frame.to_vec())).await,
                    None => Ok(()),
                }
            }
            received = socket.recv() => match received {
                Some(Ok(Message::Text(text))) => match take(&service, &text, &mut throttle).await {
                    Ok(Answer::Nothing) => Ok(()),
                    Ok(Answer::Tell(message)) => socket.send(Message::text(message.to_string())).await,
                    Ok(Answer::View(view)) => {
                        (frames, _viewing) = view.join();
                        frames.mark_changed();
                        Ok(())
                    }
                    Err(problem) => socket.send(Message::text(page::error(&problem).to_string())).await,
                },
                Some(Ok(Message::Close(_)) | Err(_)) | None => return,
                Some(Ok(_)) => Ok(()),
            },
        };
        if sent.is_err() {
            return;
        }
    }
}

/// What a page gets for a message at once.
enum Answer {
    /// Nothing; what comes of it comes by the hub.
    Nothing,
    /// The frames of another view, from now on.
    View(Arc<View>),
    /// A message.
    Tell(Value),
}

/// Takes a message of a page; says what is wrong with it, if anything.
async fn take(service: &Service, text: &str, throttle: &mut Throttle) -> Result<Answer, String> {
    let received_nanos = monotonic_nanos();
    if !throttle.admits(Instant::now()) {
        return Err("That was a lot at once; wait a moment, please.".to_owned());
    }
    let message: FromPage = serde_json::from_str(text).map_err(|error| format!("The page sent nonsense: {error}"))?;
    match message {
        FromPage::Shown => service.hub.note_shown(),
        FromPage::View { camera } => return service.view(&camera).map(Answer::View),
        FromPage::Point { camera, tick, x, y } => {
            let view = service.view(&camera)?;
            let Some(id) = view.id_at(tick, [x, y]) else { return Ok(Answer::Nothing) };
            let seen = service.talk.seen(Thing::of_id(id), [x, y]).map_err(|error| error.to_string())?;
            return Ok(seen.map_or(Answer::Nothing, Answer::Tell));
        }
        FromPage::Say { text } => {
            let text = text.trim().to_owned();
            if text.is_empty() {
                return Ok(Answer::Nothing);
            }
            if text.len() > LONGEST_TEXT {
                return Err(format!("That is too long for me: {} characters at most, please.", LONGEST_TEXT));
            }
            let talk = Arc::clone(&service.talk);
            let heard = tokio::task::spawn_blocking(move || talk.hear(&text, received_nanos)).await;
            if let Ok(Err(error)) = heard {
                tracing::error!("{error}");
                return Err("The robot cannot be reached.".to_owned());
            }
        }
    }
    Ok(Answer::Nothing)
}
