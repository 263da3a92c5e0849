//! The server of annotators' pages, by plain HTTP: a page, what it shows, the pictures, and what people send.

use std::{
    io,
    net::TcpListener,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::{SystemTime, UNIX_EPOCH},
};

use axum::{
    Json, Router,
    extract::{Path, State},
    http::{StatusCode, header},
    response::{IntoResponse, Response},
    routing::{get, post},
};
use cohabit_dialog::{Framing, HostName, Identity, ServerLimits, Site, file, file_routes, media};
use serde_json::{Value, json};

use crate::{
    desk::{Desk, Refused, Sent},
    film::Films,
};

/// The pages' files: path, media type, text. Pages look like those of studies.
const FILES: [(&str, &str, &str); 5] = [
    ("/annotate.js", media::SCRIPT, include_str!("../web/annotate.js")),
    ("/dom.js", media::SCRIPT, include_str!("../../study/web/dom.js")),
    ("/study.css", media::STYLE, include_str!("../../study/web/study.css")),
    ("/annotate.css", media::STYLE, include_str!("../web/annotate.css")),
    ("/favicon.svg", media::SVG, include_str!("../../../dialog/web/favicon.svg")),
];
const PAGE: &str = include_str!("../web/annotate.html");
const STRANGERS_PAGE: &str = include_str!("../web/stranger.html");

/// What the server has to do with.
#[derive(Clone, Debug)]
pub struct AnnotateService {
    desk: Arc<Mutex<Desk>>,
}

impl AnnotateService {
    /// Pages for this desk.
    #[must_use]
    pub fn new(desk: Desk) -> Self {
        Self { desk: Arc::new(Mutex::new(desk)) }
    }

    /// The pseudonym of each annotator, and the path of their page.
    #[must_use]
    pub fn doors(&self) -> Vec<(String, String)> {
        let desk = lock(&self.desk);
        let doors = desk.links().annotators.iter();
        doors.map(|(name, token)| (name.clone(), format!("/a/{token}"))).collect()
    }

    /// Serves on `listener` until `over`, also as `hosts` besides those of this machine; by HTTPS with an `identity`.
    ///
    /// # Errors
    /// Of the network.
    pub fn serve(
        self,
        listener: TcpListener,
        hosts: Vec<HostName>,
        identity: Option<Identity>,
        over: &dyn Fn() -> bool,
    ) -> io::Result<()> {
        let (limits, framing) = (ServerLimits::default(), Framing::default());
        Site { router: router(self), hosts, identity, limits, framing }.serve(listener, over)
    }
}

fn router(service: AnnotateService) -> Router {
    file_routes(FILES)
        .route("/a/{token}", get(page))
        .route("/a/{token}/task", get(task))
        .route("/a/{token}/send", post(send))
        .route("/a/{token}/picture/{episode}/{step}", get(picture))
        .fallback(stranger)
        .with_state(service)
}

fn lock(desk: &Mutex<Desk>) -> MutexGuard<'_, Desk> {
    desk.lock().unwrap_or_else(PoisonError::into_inner)
}

fn now_ms() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since.as_millis()).unwrap_or(u64::MAX)
}

/// The page of those whose link is not known.
async fn stranger() -> Response {
    (StatusCode::NOT_FOUND, [(header::CONTENT_TYPE, media::HTML)], STRANGERS_PAGE).into_response()
}

/// Does something for the annotator with that token, away from the threads that serve: what is written down takes its time. `None`
/// where nobody has it.
async fn for_annotator<T: Send + 'static>(
    service: AnnotateService,
    token: String,
    work: impl FnOnce(&mut Desk, &str) -> T + Send + 'static,
) -> Result<Option<T>, StatusCode> {
    let work = move || {
        let mut desk = lock(&service.desk);
        let annotator = desk.links().annotator(&token)?.to_owned();
        Some(work(&mut desk, &annotator))
    };
    tokio::task::spawn_blocking(work).await.map_err(|_| StatusCode::INTERNAL_SERVER_ERROR)
}

async fn page(State(service): State<AnnotateService>, Path(token): Path<String>) -> Response {
    match for_annotator(service, token, |_, _| ()).await {
        Ok(Some(())) => ([(header::CONTENT_TYPE, media::HTML)], PAGE).into_response(),
        Ok(None) => stranger().await,
        Err(status) => status.into_response(),
    }
}

/// Some JSON for an annotator; for nobody, that there is nothing.
fn answered(answer: Result<Option<Value>, StatusCode>) -> Response {
    match answer {
        Ok(Some(value)) => Json(value).into_response(),
        Ok(None) => StatusCode::NOT_FOUND.into_response(),
        Err(status) => status.into_response(),
    }
}

async fn task(State(service): State<AnnotateService>, Path(token): Path<String>) -> Response {
    answered(for_annotator(service, token, |desk, annotator| desk.page(annotator, now_ms())).await)
}

async fn send(State(service): State<AnnotateService>, Path(token): Path<String>, Json(sent): Json<Sent>) -> Response {
    let receive = move |desk: &mut Desk, annotator: &str| {
        let problem = desk.receive(annotator, sent, now_ms()).err();
        let mut page = desk.page(annotator, now_ms());
        page["problem"] = problem.as_ref().map_or(Value::Null, told);
        page
    };
    answered(for_annotator(service, token, receive).await)
}

/// What is not saved, for the page; what those who serve it must know of that goes to the terminal.
fn told(refused: &Refused) -> Value {
    if let Refused::NotSaved(error) = refused {
        tracing::error!("{error}");
    }
    json!(refused.to_string())
}

async fn picture(
    State(service): State<AnnotateService>,
    Path((token, episode, step)): Path<(String, usize, usize)>,
) -> Response {
    match for_annotator(service, token, move |desk, _| desk.picture_path(episode, step)).await {
        Ok(Some(Some(path))) => {
            let read = tokio::task::spawn_blocking(move || Films::read(&path)).await;
            match read {
                Ok(Ok(bytes)) => file("image/png", bytes).await,
                Ok(Err(error)) => {
                    tracing::error!("{error}");
                    StatusCode::NOT_FOUND.into_response()
                }
                Err(_) => StatusCode::INTERNAL_SERVER_ERROR.into_response(),
            }
        }
        Ok(_) => StatusCode::NOT_FOUND.into_response(),
        Err(status) => status.into_response(),
    }
}
