//! The study's server: a page for participants, a page for the experimenter, and what they ask for, by plain HTTP.

mod refusals;

use std::{
    collections::BTreeMap,
    io,
    net::{SocketAddr, TcpListener},
    sync::{Arc, Mutex},
    time::Instant,
};

use axum::{
    Json, Router,
    extract::{Path, Query, State},
    http::{StatusCode, header},
    response::{IntoResponse, Redirect, Response},
    routing::{get, post},
};
use cohabit_dialog::{
    Framing, Given, HostName, Identity, PagePart, PageTexts, ServerLimits, Site, file_routes, media, token,
};
use serde::Deserialize;
use serde_json::{Value, json};

use crate::{
    design::Study,
    keeper::lock,
    markdown::escaped,
    pair::PartnerAbsent,
    plan::place_of,
    progress::{Ending, Event, Refused},
    registry::{Reading, Registry, StudyFault, Who},
    web::refusals::{not_answered, told},
};

/// The pages' files: path, media type, text.
const FILES: [(&str, &str, &str); 9] = [
    ("/study.js", media::SCRIPT, include_str!("../web/study.js")),
    ("/forms.js", media::SCRIPT, include_str!("../web/forms.js")),
    ("/server.js", media::SCRIPT, include_str!("../web/server.js")),
    ("/dom.js", media::SCRIPT, include_str!("../web/dom.js")),
    ("/texts.js", media::SCRIPT, include_str!("../../../dialog/web/texts.js")),
    ("/experimenter.js", media::SCRIPT, include_str!("../web/experimenter.js")),
    ("/wizard.js", media::SCRIPT, include_str!("../web/wizard.js")),
    ("/study.css", media::STYLE, include_str!("../web/study.css")),
    ("/favicon.svg", media::SVG, include_str!("../../../dialog/web/favicon.svg")),
];
const STUDY_PAGE: &str = include_str!("../web/study.html");
const EXPERIMENTER_PAGE: &str = include_str!("../web/experimenter.html");
const WIZARD_PAGE: &str = include_str!("../web/wizard.html");
const STRANGER_PAGE: &str = include_str!("../web/stranger.html");
/// The longest note of the experimenter's, and the longest reason, in characters.
const LONGEST_NOTE: usize = 2000;
/// The longest text that is kept of a questionnaire before it is sent: the longest answer in any script, and a half more.
const LONGEST_DRAFT_BYTES: usize = 12_000;

/// What the server has to do with.
#[derive(Clone)]
pub struct StudyService {
    /// The participants.
    pub registry: Arc<Mutex<Registry>>,
    /// How many sessions there may be at a time.
    pub most_sessions: usize,
}

/// Where a study is found: paths behind the server's address.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Doors {
    /// The experimenter's page.
    pub experimenter: String,
    /// The observers' page, from which nothing can be changed.
    pub observer: String,
    /// Where participants sign up.
    pub sign_up: String,
    /// The wizard's page, if a wizard takes part in any session.
    pub wizard: Option<String>,
}

impl StudyService {
    /// Where its pages are.
    #[must_use]
    pub fn doors(&self) -> Doors {
        let registry = lock(&self.registry);
        let links = &registry.links;
        Doors {
            wizard: registry.study.has_wizard().then(|| format!("/wizard/{}", links.wizard)),
            experimenter: format!("/experimenter/{}", links.experimenter),
            observer: format!("/observer/{}", links.observer),
            sign_up: format!("/sign-up/{}", links.sign_up),
        }
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
        let framing = Framing { frames_ports: true, ..Framing::default() };
        let router = router(self);
        Site { router, hosts, identity, limits: ServerLimits::default(), framing }.serve(listener, over)
    }
}

/// The address of what listens there, for people.
#[must_use]
pub fn address(listening: SocketAddr, is_encrypted: bool) -> String {
    token::site_address(listening, is_encrypted)
}

fn router(service: StudyService) -> Router {
    file_routes(FILES)
        .route("/sign-up/{token}", get(sign_up))
        .route("/p/{token}", get(participant))
        .route("/p/{token}/state", get(state))
        .route("/p/{token}/event", post(event))
        .route("/wizard/{token}", get(wizard))
        .route("/wizard/{token}/state", get(wizard_sessions))
        .route("/experimenter/{token}", get(experimenter))
        .route("/experimenter/{token}/state", get(overview))
        .route("/experimenter/{token}/command", post(command))
        .route("/observer/{token}", get(observer))
        .route("/observer/{token}/state", get(observed))
        .fallback(nowhere)
        .with_state(service)
}

/// A page with these texts.
fn page(html: &str, texts: &PageTexts) -> Response {
    ([(header::CONTENT_TYPE, media::HTML)], texts.page(PagePart::Study, html)).into_response()
}

/// A page of the study's staff: those are in English.
fn staff_page(html: &str) -> Response {
    page(html, &PageTexts::default())
}

/// The page of those whose link is not known, with whom to ask.
fn stranger(study: &Study) -> Response {
    (StatusCode::NOT_FOUND, [(header::CONTENT_TYPE, media::HTML)], strangers_page(study)).into_response()
}

fn strangers_page(Study { page_texts, contact, .. }: &Study) -> String {
    page_texts.page(PagePart::Study, STRANGER_PAGE).replace("{contact}", &escaped(contact))
}

async fn nowhere(State(service): State<StudyService>) -> Response {
    with_study(service, |registry, _| stranger(&registry.study)).await
}

/// Does something with the study, away from the threads that serve: what is written down takes its time.
async fn with_study(
    service: StudyService,
    work: impl FnOnce(&mut Registry, usize) -> Response + Send + 'static,
) -> Response {
    let most = service.most_sessions;
    let done = tokio::task::spawn_blocking(move || work(&mut lock(&service.registry), most)).await;
    done.unwrap_or_else(|_| StatusCode::INTERNAL_SERVER_ERROR.into_response())
}

/// The parameters of a link, such as a site that recruits people passes them.
type Parameters = Query<BTreeMap<String, String>>;

async fn sign_up(
    State(service): State<StudyService>,
    Path(given): Path<String>,
    Query(parameters): Parameters,
) -> Response {
    with_study(service, move |registry, _| {
        if !token::admits(&registry.links.sign_up, Some(&given)) {
            return stranger(&registry.study);
        }
        match registry.sign_up() {
            Ok(token) => {
                if let Some(Who::Newcomer(index)) = registry.who(&token) {
                    registry.tell(index, &parameters);
                }
                Redirect::to(&format!("/p/{token}")).into_response()
            }
            Err(fault) => (StatusCode::CONFLICT, format!("{fault}\n")).into_response(),
        }
    })
    .await
}

async fn participant(
    State(service): State<StudyService>,
    Path(given): Path<String>,
    Query(parameters): Parameters,
) -> Response {
    with_study(service, move |registry, _| match registry.who(&given) {
        Some(who) => {
            if let Who::Newcomer(index) = who {
                registry.tell(index, &parameters);
            }
            page(STUDY_PAGE, &registry.study.page_texts)
        }
        None => stranger(&registry.study),
    })
    .await
}

/// What a page calls itself; nothing, if it does not.
#[derive(Default, Deserialize)]
struct Asking {
    #[serde(default)]
    page: String,
}

/// The longest name of a page that counts, in bytes.
const LONGEST_PAGE: usize = 64;

async fn state(
    State(service): State<StudyService>,
    Path(given): Path<String>,
    Query(asking): Query<Asking>,
) -> Response {
    with_study(service, move |registry, _| match registry.who(&given) {
        Some(who) => Json(seen(registry, who, &asking)).into_response(),
        None => StatusCode::NOT_FOUND.into_response(),
    })
    .await
}

/// What a page shows, which was just heard of.
fn seen(registry: &mut Registry, who: Who, Asking { page }: &Asking) -> Value {
    if let Who::Participant(place) = who
        && (1..=LONGEST_PAGE).contains(&page.len())
        && registry.is_elsewhere(place, page)
    {
        let Study { title, contact, .. } = &registry.study;
        return json!({ "page": "elsewhere", "title": title, "contact": contact });
    }
    if let Who::Participant(place) = who
        && let Some(participant) = registry.participants.get_mut(&place)
    {
        participant.seen = Some(Instant::now());
    }
    registry.page(who)
}

/// What a participant's page may cause. `step` is the one that it showed, so that what is sent twice counts once.
#[derive(Deserialize)]
pub(crate) struct Sent {
    pub step: Option<usize>,
    pub event: Event,
}

async fn event(
    State(service): State<StudyService>,
    Path(given): Path<String>,
    Query(asking): Query<Asking>,
    Json(sent): Json<Sent>,
) -> Response {
    with_study(service, move |registry, _| {
        let Some(who) = registry.who(&given) else { return StatusCode::NOT_FOUND.into_response() };
        let problem = match who {
            Who::Withdrawn => None,
            Who::Newcomer(index) => newcomers_event(registry, index, &sent.event).err(),
            Who::Participant(place) => participants_event(registry, place, &sent).err(),
        };
        let who = registry.who(&given).unwrap_or(Who::Withdrawn);
        let mut page = seen(registry, who, &asking);
        let texts = &registry.study.page_texts;
        page["problem"] = problem.as_ref().map_or(Value::Null, |fault| told(fault, texts));
        Json(page).into_response()
    })
    .await
}

pub(crate) fn newcomers_event(registry: &mut Registry, index: usize, event: &Event) -> Result<(), StudyFault> {
    let reading = match event {
        Event::Consented { version, ticked, .. } => return registry.enrol(index, version, ticked),
        Event::Read => Reading::Consent,
        Event::Declined => Reading::Declined,
        // Of people who have not agreed nothing is kept that could be removed.
        _ => return Ok(()),
    };
    if let Some(newcomer) = registry.newcomers.get_mut(index) {
        newcomer.reading = reading;
    }
    Ok(())
}

pub(crate) fn participants_event(registry: &mut Registry, place: u32, sent: &Sent) -> Result<(), StudyFault> {
    let Some(participant) = registry.participants.get(&place) else { return Ok(()) };
    let now = participant.progress.step_now().map(|(index, ..)| index + 1);
    if !matches!(sent.event, Event::Withdrew) && sent.step != now {
        // It was sent twice, or from another window.
        return Ok(());
    }
    match &sent.event {
        Event::Answered { questionnaire, answers } => {
            let asked = registry.study.questionnaire(questionnaire);
            let checked = asked.map(|asked| asked.answered(place, answers));
            if let Some(Err(problem)) = checked {
                return Err(not_answered(&problem, &registry.study.page_texts));
            }
        }
        Event::Drafted { questionnaire, answers } => {
            let items = registry.study.questionnaire(questionnaire).map(|asked| asked.items.len());
            if items != Some(answers.len()) || participant.progress.draft() == answers.as_slice() {
                return Ok(());
            }
            check_draft(answers)?;
        }
        Event::ProbeAnswered { probe, answer } => {
            let asked =
                registry.study.probes.get(*probe).and_then(|probe| registry.study.questionnaire(&probe.questionnaire));
            let Some(asked) = asked else { return Ok(()) };
            asked
                .answered(place, std::slice::from_ref(answer))
                .map_err(|problem| not_answered(&problem, &registry.study.page_texts))?;
        }
        Event::Withdrew => {}
        Event::GoesAlone => registry.check_may(place, PartnerAbsent::Alone)?,
        Event::StopsWaiting => registry.check_may(place, PartnerAbsent::End)?,
        // A tutorial may be left once it was played for so long.
        Event::GoesOn => registry.save_played(place),
        Event::Over { ending: Ending::Skipped } => {
            registry.save_played(place);
            return registry.skip(place);
        }
        // All else happens without their doing.
        _ => return Ok(()),
    }
    registry.apply(place, &sent.event)
}

/// Finds out whether what somebody has filled in so far is short enough to be kept.
fn check_draft(answers: &[Option<Given>]) -> Result<(), StudyFault> {
    let bytes = |given: &Given| match given {
        Given::Text(text) => text.len(),
        Given::Value(_) => 0,
    };
    if answers.iter().flatten().all(|given| bytes(given) <= LONGEST_DRAFT_BYTES) {
        return Ok(());
    }
    Err(Refused::TooLong.into())
}

async fn experimenter(State(service): State<StudyService>, Path(given): Path<String>) -> Response {
    with_study(service, move |registry, _| {
        if token::admits(&registry.links.experimenter, Some(&given)) {
            staff_page(EXPERIMENTER_PAGE)
        } else {
            stranger(&registry.study)
        }
    })
    .await
}

async fn overview(State(service): State<StudyService>, Path(given): Path<String>) -> Response {
    with_study(service, move |registry, most| {
        if !token::admits(&registry.links.experimenter, Some(&given)) {
            return StatusCode::NOT_FOUND.into_response();
        }
        Json(registry.overview(most)).into_response()
    })
    .await
}

async fn observer(State(service): State<StudyService>, Path(given): Path<String>) -> Response {
    with_study(service, move |registry, _| {
        if token::admits(&registry.links.observer, Some(&given)) {
            staff_page(EXPERIMENTER_PAGE)
        } else {
            stranger(&registry.study)
        }
    })
    .await
}

async fn observed(State(service): State<StudyService>, Path(given): Path<String>) -> Response {
    with_study(service, move |registry, most| {
        if token::admits(&registry.links.observer, Some(&given)) {
            Json(registry.observed(most)).into_response()
        } else {
            StatusCode::NOT_FOUND.into_response()
        }
    })
    .await
}

async fn wizard(State(service): State<StudyService>, Path(given): Path<String>) -> Response {
    with_study(service, move |registry, _| {
        if token::admits(&registry.links.wizard, Some(&given)) {
            staff_page(WIZARD_PAGE)
        } else {
            stranger(&registry.study)
        }
    })
    .await
}

async fn wizard_sessions(State(service): State<StudyService>, Path(given): Path<String>) -> Response {
    with_study(service, move |registry, _| {
        if token::admits(&registry.links.wizard, Some(&given)) {
            Json(registry.wizard_sessions()).into_response()
        } else {
            StatusCode::NOT_FOUND.into_response()
        }
    })
    .await
}

/// What the experimenter may cause.
#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum Command {
    /// A link for the next participant.
    Reserve,
    /// A note, about somebody or nobody.
    Note { participant: Option<String>, text: String },
    /// The mission that somebody plays stands still, or goes on.
    Pause { participant: String, is_paused: bool },
    /// Somebody is shown a message.
    Tell { participant: String, text: String },
    /// Somebody's mission is over.
    EndMission { participant: String },
    /// Somebody takes no part any more; their data stay.
    Exclude { participant: String, reason: String },
    /// Somebody's data are removed.
    Withdraw { participant: String },
}

async fn command(
    State(service): State<StudyService>,
    Path(given): Path<String>,
    Json(command): Json<Command>,
) -> Response {
    with_study(service, move |registry, most| {
        if !token::admits(&registry.links.experimenter, Some(&given)) {
            return StatusCode::NOT_FOUND.into_response();
        }
        let problem = registry.obey(command).err();
        let mut page = registry.overview(most);
        let texts = PageTexts::default();
        page["problem"] = problem.as_ref().map_or(Value::Null, |fault| told(fault, &texts));
        Json(page).into_response()
    })
    .await
}

impl Registry {
    fn obey(&mut self, command: Command) -> Result<(), StudyFault> {
        let place = |name: &str| {
            place_of(name).ok_or_else(|| StudyFault::NotNow(format!("Nobody is called {}.", name.escape_debug())))
        };
        match command {
            Command::Reserve => self.reserve(None).map(drop),
            Command::Note { participant, text } => {
                if let Some(name) = &participant {
                    place(name)?;
                }
                self.keep_note(participant, short(&text)?)
            }
            Command::Pause { participant, is_paused } => self.pause(place(&participant)?, is_paused),
            Command::Tell { participant, text } => self.tell_participant(place(&participant)?, short(&text)?),
            Command::EndMission { participant } => {
                for place in self.ended_with(place(&participant)?)? {
                    self.save_played(place);
                    self.apply(place, &Event::Over { ending: Ending::Stopped })?;
                }
                Ok(())
            }
            Command::Exclude { participant, reason } => {
                self.apply(place(&participant)?, &Event::Excluded { reason: short(&reason)? })
            }
            Command::Withdraw { participant } => self.apply(place(&participant)?, &Event::Withdrew),
        }
    }
}

fn short(text: &str) -> Result<String, StudyFault> {
    let text = text.trim();
    if (1..=LONGEST_NOTE).contains(&text.chars().count()) {
        return Ok(text.to_owned());
    }
    Err(StudyFault::NotNow(format!("Please write 1 to {LONGEST_NOTE} characters.")))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
