//! A language model at an OpenAI-compatible address, which puts what the robot did not understand into plain requests. It
//! proposes words alone: they are understood, grounded and checked like anybody's.

use std::{
    env,
    sync::{
        Weak,
        mpsc::{Receiver, SyncSender, sync_channel},
    },
    time::Duration,
};

use cohabit_cdf::BodyId;
use cohabit_language::{Interpreter, Unclear};
use serde_json::{Value, json};

use crate::talk::Talk;

/// How long an answer is waited for.
const PATIENCE: Duration = Duration::from_secs(15);
/// The longest answer that is read, bytes.
const LONGEST_ANSWER: u64 = 64 << 10;
/// The most names of things that a model is told.
const MOST_THINGS: usize = 150;
/// The most puzzles that wait.
const MOST_PUZZLES: usize = 4;

const INSTRUCTIONS: &str = include_str!("../data/interpreter.md");

/// Something that is not understood.
pub struct Asked {
    /// By the robot of this body.
    pub body: BodyId,
    /// In this turn.
    pub turn: u64,
    /// What, and what helps.
    pub unclear: Unclear,
}

/// Where an interpreter is asked.
pub struct Puzzles(SyncSender<Asked>);

impl Puzzles {
    /// Asks; `false` where too much is asked already.
    pub fn ask(&self, asked: Asked) -> bool {
        self.0.try_send(asked).is_ok()
    }
}

/// Where an interpreter is asked, and where it hears.
pub fn puzzles() -> (Puzzles, Receiver<Asked>) {
    let (sender, receiver) = sync_channel(MOST_PUZZLES);
    (Puzzles(sender), receiver)
}

/// Answers what is asked, as long as there is a conversation.
pub fn answer(interpreter: &dyn Interpreter, asked: &Receiver<Asked>, talk: &Weak<Talk>) {
    while let Ok(Asked { body, turn, unclear }) = asked.recv() {
        let requests = interpreter.interpret(&unclear).unwrap_or_else(|error| {
            tracing::warn!("the language model could not be asked: {error}");
            Vec::new()
        });
        let Some(talk) = talk.upgrade() else { return };
        if let Err(error) = talk.note_interpretation(body, turn, &requests) {
            tracing::error!("{error}");
            return;
        }
    }
}

/// A language model behind an OpenAI-compatible address.
pub struct Endpoint {
    agent: ureq::Agent,
    address: String,
    model: String,
    key: Option<String>,
}

/// Why there is no such model.
#[derive(Debug, thiserror::Error)]
pub enum EndpointError {
    /// The address is none.
    #[error("COHABIT_MODEL_URL: `{0}` is no address; write one such as http://127.0.0.1:11434/v1")]
    Address(String),
    /// No model was named.
    #[error("COHABIT_MODEL_URL is set, and COHABIT_MODEL is not: name the model to ask")]
    NoModel,
}

impl Endpoint {
    /// The model that the environment names: `COHABIT_MODEL_URL` (such as `http://127.0.0.1:11434/v1`), `COHABIT_MODEL` and,
    /// if one is needed, `COHABIT_MODEL_KEY`. Nothing, if there is no address.
    ///
    /// # Errors
    /// [`EndpointError`].
    pub fn from_environment() -> Result<Option<Self>, EndpointError> {
        let set = |name: &str| env::var(name).ok().filter(|value| !value.trim().is_empty());
        let Some(address) = set("COHABIT_MODEL_URL") else { return Ok(None) };
        let model = set("COHABIT_MODEL").ok_or(EndpointError::NoModel)?;
        Self::new(&address, model, set("COHABIT_MODEL_KEY")).map(Some)
    }

    fn new(address: &str, model: String, key: Option<String>) -> Result<Self, EndpointError> {
        let address = address.trim().trim_end_matches('/');
        if !address.starts_with("http://") && !address.starts_with("https://") {
            return Err(EndpointError::Address(address.to_owned()));
        }
        let config = ureq::Agent::config_builder().timeout_global(Some(PATIENCE)).build();
        Ok(Self { agent: config.into(), address: format!("{address}/chat/completions"), model, key })
    }

    fn ask(&self, question: &Value) -> Result<Vec<u8>, ureq::Error> {
        let mut request = self.agent.post(&self.address).header("Content-Type", "application/json");
        if let Some(key) = &self.key {
            request = request.header("Authorization", format!("Bearer {key}"));
        }
        let mut answer = request.send(question.to_string())?;
        answer.body_mut().with_config().limit(LONGEST_ANSWER).read_to_vec()
    }
}

impl Interpreter for Endpoint {
    fn interpret(&self, unclear: &Unclear) -> Result<Vec<String>, String> {
        let answer = self.ask(&question(&self.model, unclear)).map_err(|error| error.to_string())?;
        let answer: Value = serde_json::from_slice(&answer).map_err(|error| format!("it answers no JSON: {error}"))?;
        let content = answer["choices"][0]["message"]["content"].as_str();
        content.map(requests).ok_or_else(|| "its answer has no `choices[0].message.content`".to_owned())
    }
}

/// What a model is asked.
fn question(model: &str, unclear: &Unclear) -> Value {
    let Unclear { utterance, before, things, rooms, held, room } = unclear;
    let things: Vec<&str> = things.iter().take(MOST_THINGS).map(String::as_str).collect();
    let facts = format!(
        "Rooms: {}. Things: {}. You are in the {room}. In your hand: {}.",
        rooms.join(", "),
        things.join(", "),
        held.as_deref().unwrap_or("nothing"),
    );
    let line = |(is_robot, text): &(bool, String)| json!({ "role": if *is_robot { "assistant" } else { "user" }, "content": text });
    let system = json!({ "role": "system", "content": format!("{INSTRUCTIONS}\n{facts}") });
    let utterance = json!({ "role": "user", "content": utterance });
    let messages: Vec<Value> = std::iter::once(system).chain(before.iter().map(line)).chain([utterance]).collect();
    json!({ "model": model, "messages": messages, "temperature": 0, "max_tokens": 200 })
}

/// The requests in what a model wrote: a JSON array of sentences, whatever it wrote around that.
fn requests(content: &str) -> Vec<String> {
    let array = content.find('[').zip(content.rfind(']')).and_then(|(from, to)| content.get(from..=to));
    array.and_then(|array| serde_json::from_str(array).ok()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_are_read_from_whatever_stands_around_them() {
        for (content, expected) in [
            (r#"["go to the kitchen", "pick up the mug"]"#, &["go to the kitchen", "pick up the mug"][..]),
            ("Sure!\n```json\n[\"stop\"]\n```", &["stop"]),
            ("[]", &[]),
            ("go to the kitchen", &[]),
            ("] [", &[]),
            ("[1, 2]", &[]),
        ] {
            assert_eq!(requests(content), expected, "{content}");
        }
    }

    #[test]
    fn a_model_is_told_what_there_is_and_no_key() {
        let unclear = Unclear {
            utterance: "gimme some joe".to_owned(),
            before: vec![(false, "hi".to_owned()), (true, "Hello!".to_owned())],
            things: vec!["mug".to_owned()],
            rooms: vec!["break room".to_owned()],
            ..Unclear::default()
        };
        let question = question("some-model", &unclear);
        let messages = question["messages"].as_array().unwrap();
        let roles: Vec<&str> = messages.iter().filter_map(|message| message["role"].as_str()).collect();
        assert_eq!(roles, ["system", "user", "assistant", "user"]);
        assert!(messages[0]["content"].as_str().unwrap().contains("Things: mug."));
        assert_eq!(messages[3]["content"], "gimme some joe");
    }

    #[test]
    fn an_address_must_be_one() {
        assert!(Endpoint::new("localhost", "m".to_owned(), None).is_err());
        let endpoint = Endpoint::new("http://localhost:1/v1/", "m".to_owned(), None).ok().unwrap();
        assert_eq!(endpoint.address, "http://localhost:1/v1/chat/completions");
    }
}
