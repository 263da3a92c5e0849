//! The server of the editor's page, by plain HTTP: what it shows, the pictures, and what is done.

use std::{
    io,
    net::TcpListener,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use axum::{
    Json, Router,
    extract::{Path, State},
    http::{StatusCode, header},
    response::{IntoResponse, Response},
    routing::{get, post},
};
use cohabit_dialog::{Framing, HostName, Identity, ServerLimits, Site, file, file_routes, media, token};
use serde_json::{Value, json};

use crate::{
    desk::{Desk, Sent, Wish},
    picture::{Eye, Studio},
    texts,
};

/// The page's files: path, media type, text. It looks like the pages of studies.
const FILES: [(&str, &str, &str); 9] = [
    ("/edit.js", media::SCRIPT, include_str!("../web/edit.js")),
    ("/plan.js", media::SCRIPT, include_str!("../web/plan.js")),
    ("/mission.js", media::SCRIPT, include_str!("../web/mission.js")),
    ("/drawing.js", media::SCRIPT, include_str!("../web/drawing.js")),
    ("/texts.js", media::SCRIPT, include_str!("../../../dialog/web/texts.js")),
    ("/dom.js", media::SCRIPT, include_str!("../../study/web/dom.js")),
    ("/study.css", media::STYLE, include_str!("../../study/web/study.css")),
    ("/edit.css", media::STYLE, include_str!("../web/edit.css")),
    ("/favicon.svg", media::SVG, include_str!("../../../dialog/web/favicon.svg")),
];
const PAGE: &str = include_str!("../web/edit.html");
const STRANGERS_PAGE: &str = include_str!("../web/stranger.html");

/// Who plays what was edited.
pub trait Player: Send + Sync {
    /// Plays a mission (CDF) in a session of its own, in the place of the one before; gives the address of its page.
    ///
    /// # Errors
    /// Why it cannot be played, in words.
    fn play(&self, mission: &str) -> Result<String, String>;
}

/// What the server has to do with.
#[derive(Clone)]
pub struct EditService {
    desk: Arc<Mutex<Desk>>,
    studio: Arc<Studio>,
    player: Arc<dyn Player>,
    token: Arc<str>,
}

impl EditService {
    /// A page for this desk, for whoever has the token alone.
    #[must_use]
    pub fn new(desk: Desk, studio: Studio, player: Arc<dyn Player>, token: &str) -> Self {
        Self { desk: Arc::new(Mutex::new(desk)), studio: Arc::new(studio), player, token: token.into() }
    }

    /// The path of the page.
    #[must_use]
    pub fn path(&self) -> String {
        format!("/e/{}", self.token)
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

    fn desk(&self) -> MutexGuard<'_, Desk> {
        self.desk.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What the page shows after something was done, with why it was not.
    fn after(&self, work: impl FnOnce(&mut Desk) -> Result<(), String>) -> Value {
        let mut desk = self.desk();
        let problem = work(&mut desk).err();
        let mut state = desk.state();
        state["problem"] = json!(problem);
        state
    }

    /// Saves, plays, and gives the address of the session's page.
    fn play(&self) -> Value {
        let mut state = self.after(|desk| desk.fulfil(Wish::Save));
        if !state["problem"].is_null() {
            return state;
        }
        let (document, text) = self.desk().present();
        let mission = document.is_sound(&text).then(|| document.mission(&text));
        let played =
            mission.ok_or_else(|| "it is saved; mend what is wrong with it before it can be played".to_owned());
        match played.and_then(|mission| self.player.play(&mission)) {
            Ok(address) => state["played"] = json!(address),
            Err(problem) => state["problem"] = json!(problem),
        }
        state
    }

    /// Has the present text tried.
    fn tried(&self) -> Value {
        let (document, text) = self.desk().present();
        match document.tried(&text) {
            None => Value::Null,
            Some(Ok(tried)) => json!({ "tried": tried }),
            Some(Err(why)) => json!({ "why": why }),
        }
    }

    fn picture(&self, eye: &str) -> Option<Vec<u8>> {
        let eye = Eye::named(eye)?;
        let (document, text) = self.desk().present();
        self.studio.picture(&document.drawn(&text)?, eye)
    }
}

fn router(service: EditService) -> Router {
    file_routes(FILES)
        .route("/e/{token}", get(page))
        .route("/e/{token}/choices", get(choices))
        .route("/e/{token}/state", get(state))
        .route("/e/{token}/edit", post(edit))
        .route("/e/{token}/wish", post(wish))
        .route("/e/{token}/play", post(play))
        .route("/e/{token}/try", post(tried))
        .route("/e/{token}/picture/{revision}/{eye}", get(picture))
        .fallback(stranger)
        .with_state(service)
}

/// The page of those whose link is not known.
async fn stranger() -> Response {
    (StatusCode::NOT_FOUND, [(header::CONTENT_TYPE, media::HTML)], texts::filled(STRANGERS_PAGE)).into_response()
}

/// Does something for who has the token, away from the threads that serve: plans are looked over, drawn and written.
async fn for_owner<T: Send + 'static>(
    service: EditService,
    given: &str,
    work: impl FnOnce(&EditService) -> T + Send + 'static,
) -> Result<T, StatusCode> {
    if !token::admits(&service.token, Some(given)) {
        return Err(StatusCode::NOT_FOUND);
    }
    tokio::task::spawn_blocking(move || work(&service)).await.map_err(|_| StatusCode::INTERNAL_SERVER_ERROR)
}

fn answered(answer: Result<Value, StatusCode>) -> Response {
    match answer {
        Ok(value) => Json(value).into_response(),
        Err(status) => status.into_response(),
    }
}

async fn page(State(service): State<EditService>, Path(given): Path<String>) -> Response {
    match for_owner(service, &given, |_| texts::filled(PAGE)).await {
        Ok(page) => ([(header::CONTENT_TYPE, media::HTML)], page).into_response(),
        Err(_) => stranger().await,
    }
}

async fn choices(State(service): State<EditService>, Path(given): Path<String>) -> Response {
    answered(for_owner(service, &given, |service| service.desk().choices()).await)
}

async fn state(State(service): State<EditService>, Path(given): Path<String>) -> Response {
    answered(for_owner(service, &given, |service| service.desk().state()).await)
}

async fn edit(State(service): State<EditService>, Path(given): Path<String>, Json(sent): Json<Sent>) -> Response {
    answered(for_owner(service, &given, |service| service.after(|desk| desk.edit(sent))).await)
}

async fn wish(State(service): State<EditService>, Path(given): Path<String>, Json(wish): Json<Wish>) -> Response {
    answered(for_owner(service, &given, move |service| service.after(|desk| desk.fulfil(wish))).await)
}

async fn play(State(service): State<EditService>, Path(given): Path<String>) -> Response {
    answered(for_owner(service, &given, EditService::play).await)
}

async fn tried(State(service): State<EditService>, Path(given): Path<String>) -> Response {
    answered(for_owner(service, &given, EditService::tried).await)
}

async fn picture(State(service): State<EditService>, Path((given, _, eye)): Path<(String, u64, String)>) -> Response {
    match for_owner(service, &given, move |service| service.picture(&eye)).await {
        Ok(Some(bytes)) => file("image/jpeg", bytes).await,
        Ok(None) => StatusCode::NO_CONTENT.into_response(),
        Err(status) => status.into_response(),
    }
}
