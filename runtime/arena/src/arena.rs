//! What answers clients: at most one game, which any of them can start anew. Knows no sockets.

use std::{
    path::PathBuf,
    sync::{Arc, atomic::AtomicBool},
};

use cohabit_cdf::{BodyRequest, Catalog, Status};
use cohabit_engine::SessionPlan;
use cohabit_render::{MeshLibrary, Renderer};
use serde_json::Value;

use crate::{
    command,
    game::{Game, GameError},
    renderer::SharedRenderer,
    reply::Reply,
};

/// What all games have in common.
pub struct Settings {
    /// The objects there can be.
    pub catalog: Arc<Catalog>,
    /// How they look.
    pub meshes: Arc<MeshLibrary>,
    /// The seed of the first game, where its mission leaves it to chance; each next game has the one after it, so that whoever
    /// launches a mission anew finds it arranged anew.
    pub seed: u64,
    /// Bodies beside those of the missions.
    pub bodies: Vec<BodyRequest>,
    /// The folder of the games' logs.
    pub logs: PathBuf,
    /// What their names begin with; a number follows.
    pub name: String,
}

/// Takes in messages, and answers those that are to be answered.
pub struct Arena {
    settings: Settings,
    renderer: SharedRenderer,
    state: State,
    games: u32,
    /// Becomes true when no more commands are to be carried out.
    stop: Arc<AtomicBool>,
}

/// What there is to play.
enum State {
    /// Nothing; and why.
    Idle(String),
    /// A game.
    Playing(Box<Game>),
}

/// What a message asks for.
enum Message {
    /// A new game.
    Launch(String),
    /// Commands in order.
    Batch(Vec<Value>),
    /// Nothing that can be done.
    Malformed(String),
}

impl Arena {
    /// Without a game; `renderer` draws for all.
    #[must_use]
    pub fn new(settings: Settings, renderer: Box<dyn Renderer>) -> Self {
        let why = "no mission was launched yet: send a CDF first".to_owned();
        Self {
            settings,
            renderer: SharedRenderer::new(renderer),
            state: State::Idle(why),
            games: 0,
            stop: Arc::default(),
        }
    }

    /// The same, which carries out no more commands once `stop` is true.
    #[must_use]
    pub fn ending_at(self, stop: Arc<AtomicBool>) -> Self {
        Self { stop, ..self }
    }

    /// Answers a message; a mission has no answer. `first` says whether it is the first of its connection.
    pub fn answer(&mut self, message: &[u8], first: bool) -> Option<Vec<u8>> {
        match read(message, first) {
            Message::Launch(cdf) => {
                self.launch("CDF", &cdf);
                None
            }
            Message::Batch(batch) => {
                let stop = Arc::clone(&self.stop);
                Some(self.reply(|game| game.play(&batch, &stop)).json())
            }
            Message::Malformed(problem) => {
                tracing::warn!("a message was refused: {problem}");
                let status = Status::IncorrectActionFormat;
                Some(match self.state {
                    State::Idle(_) => Reply::without_game(status, problem).json(),
                    State::Playing(_) => self.reply(|game| game.refuse(status, problem)).json(),
                })
            }
        }
    }

    /// The answer to a message that is not taken in.
    #[must_use]
    pub fn refusal(why: String) -> Vec<u8> {
        tracing::warn!("a message was refused: {why}");
        Reply::without_game(Status::IncorrectActionFormat, why).json()
    }

    /// Starts a game of a mission's text, which `file` is called where it is wrong; the one before ends. That it cannot
    /// be started is logged, and said to whoever sends a batch next.
    pub fn launch(&mut self, file: &str, cdf: &str) {
        self.finish();
        self.state = match self.begin(file, cdf) {
            Ok(game) => State::Playing(Box::new(game)),
            Err(error) => {
                let why = format!("the mission could not be launched: {error}");
                tracing::error!("{why}");
                State::Idle(why)
            }
        };
    }

    /// Ends the game, if there is one, and its log.
    pub fn finish(&mut self) {
        let before = std::mem::replace(&mut self.state, State::Idle("the game is over: send a CDF".to_owned()));
        if let State::Playing(game) = before {
            let goals = game.world().goals();
            let met = goals.iter().filter(|goal| goal.met).count();
            tracing::info!("game {} is over: {met} of {} goals met", self.games, goals.len());
            game.end();
        }
    }

    fn begin(&mut self, file: &str, cdf: &str) -> Result<Game, GameError> {
        let Settings { catalog, meshes, seed, bodies, logs, name } = &self.settings;
        self.games += 1;
        let session = format!("{name}-{}", self.games);
        let log = logs.join(format!("{session}.mcap"));
        let seed = seed.wrapping_add(u64::from(self.games - 1));
        let plan = SessionPlan::new(file, cdf, Arc::clone(catalog), seed)?.with_bodies(bodies.clone());
        let game = Game::new(&plan, Arc::clone(meshes), Box::new(self.renderer.clone()), &session, &log)?;
        tracing::info!("game {}: \"{}\", recorded in {}", self.games, plan.mission.goal_text, log.display());
        Ok(game)
    }

    /// What the game replies, if there is one.
    fn reply(&mut self, ask: impl FnOnce(&mut Game) -> Result<Reply, GameError>) -> Reply {
        let error = match &mut self.state {
            State::Idle(why) => {
                tracing::warn!("a batch was refused: {why}");
                return Reply::without_game(Status::ArenaUnavailable, why.clone());
            }
            State::Playing(game) => match ask(game) {
                Ok(reply) => return reply,
                Err(error) => error,
            },
        };
        let why = format!("the game broke off: {error}; a CDF launches another");
        tracing::error!("{why}");
        self.finish();
        self.state = State::Idle(why.clone());
        Reply::without_game(Status::ArenaUnavailable, why)
    }
}

/// What a message asks for. What is neither commands nor a mission is one all the same if it opens a connection: it was
/// meant as one, and what is wrong with it is to be said.
fn read(message: &[u8], first: bool) -> Message {
    let text = match std::str::from_utf8(message) {
        Ok(text) => text,
        Err(error) => return Message::Malformed(format!("not UTF-8 text from byte {}", error.valid_up_to())),
    };
    match serde_json::from_str(text) {
        Ok(Value::Array(batch)) => Message::Batch(batch),
        Ok(Value::Object(fields)) if fields.contains_key("scene") => Message::Launch(text.to_owned()),
        Ok(Value::Object(fields)) if first && !fields.contains_key("commandType") => Message::Launch(text.to_owned()),
        Ok(other) => {
            let found = command::kind(&other);
            Message::Malformed(format!("expected an array of commands, or a CDF with a `scene`; found {found}"))
        }
        Err(_) if first && text.trim_start().starts_with('{') => Message::Launch(text.to_owned()),
        Err(error) => Message::Malformed(format!("not JSON: {error}")),
    }
}
