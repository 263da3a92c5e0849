//! The page of all sessions: who has its link sees how they are, and starts and ends them.

use std::{
    io,
    net::TcpListener,
    sync::{Arc, Mutex},
};

use axum::{
    Json, Router,
    extract::{Path, State},
    http::{StatusCode, header},
    response::{IntoResponse, Response},
    routing::{get, post},
};
use cohabit_dialog::{Framing, HostName, Identity, ServerLimits, Site, file_routes, media, token};
use serde_json::{Value, json};

use crate::{
    board::{Board, Command},
    keeper::lock,
};

/// The page's files: path, media type, text. It looks like those of studies.
const FILES: [(&str, &str, &str); 4] = [
    ("/host.js", media::SCRIPT, include_str!("../web/host.js")),
    ("/dom.js", media::SCRIPT, include_str!("../../study/web/dom.js")),
    ("/study.css", media::STYLE, include_str!("../../study/web/study.css")),
    ("/favicon.svg", media::SVG, include_str!("../../../dialog/web/favicon.svg")),
];
const PAGE: &str = include_str!("../web/host.html");
const STRANGERS_PAGE: &str = include_str!("../web/stranger.html");

/// What the server has to do with.
#[derive(Clone, Debug)]
pub struct HostService {
    board: Arc<Mutex<Board>>,
    token: Arc<str>,
}

impl HostService {
    /// A page for this board, whose link has a token of its own.
    ///
    /// # Errors
    /// When the system gives no chance.
    pub fn new(board: Arc<Mutex<Board>>) -> io::Result<Self> {
        Ok(Self { board, token: token::fresh()?.into() })
    }

    /// The path of the page.
    #[must_use]
    pub fn door(&self) -> String {
        format!("/h/{}", self.token)
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

    fn admits(&self, given: &str) -> bool {
        token::admits(&self.token, Some(given))
    }
}

fn router(service: HostService) -> Router {
    file_routes(FILES)
        .route("/h/{token}", get(page))
        .route("/h/{token}/state", get(state))
        .route("/h/{token}/command", post(command))
        .fallback(stranger)
        .with_state(service)
}

/// The page of those whose link is not known.
async fn stranger() -> Response {
    (StatusCode::NOT_FOUND, [(header::CONTENT_TYPE, media::HTML)], STRANGERS_PAGE).into_response()
}

async fn page(State(service): State<HostService>, Path(given): Path<String>) -> Response {
    if service.admits(&given) {
        ([(header::CONTENT_TYPE, media::HTML)], PAGE).into_response()
    } else {
        stranger().await
    }
}

async fn state(State(service): State<HostService>, Path(given): Path<String>) -> Response {
    if service.admits(&given) {
        Json(lock(&service.board).page()).into_response()
    } else {
        StatusCode::NOT_FOUND.into_response()
    }
}

async fn command(
    State(service): State<HostService>,
    Path(given): Path<String>,
    Json(command): Json<Command>,
) -> Response {
    if service.admits(&given) {
        Json(obeyed(&mut lock(&service.board), command)).into_response()
    } else {
        StatusCode::NOT_FOUND.into_response()
    }
}

/// What the page shows after a command, with what is wrong with it.
fn obeyed(board: &mut Board, command: Command) -> Value {
    let problem = board.obey(command).err();
    let mut page = board.page();
    page["problem"] = json!(problem);
    page
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::admission::Needs;

    #[test]
    fn commands_are_read_as_the_page_sends_them() {
        let mut board = Board::new(["a".to_owned()], Needs::default(), "");
        for (sent, state, problem) in [
            (json!({ "stop": 1 }), "stopped", Value::Null),
            (json!({ "start": 1 }), "waiting", Value::Null),
            (json!({ "stop": 9 }), "waiting", json!("There is no session 9.")),
        ] {
            let command = serde_json::from_value(sent).expect("a command");
            let page = obeyed(&mut board, command);
            assert_eq!((&page["sessions"][0]["state"], &page["problem"]), (&json!(state), &problem));
        }
        assert!(serde_json::from_value::<Command>(json!({ "wipe": 1 })).is_err());
    }

    #[test]
    fn only_who_has_the_link_gets_in() {
        let board = Arc::new(Mutex::new(Board::new(["a".to_owned()], Needs::default(), "")));
        let service = HostService::new(board).expect("a token");
        let given = service.door().trim_start_matches("/h/").to_owned();
        assert!(service.admits(&given) && !service.admits("") && !service.admits(&given[1..]));
    }
}
