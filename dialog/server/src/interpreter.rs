//! A language model at an OpenAI-compatible address, which says what people mean. It proposes words alone: requests are understood,
//! grounded and checked like anybody's.

use std::{
    env,
    sync::mpsc::{Receiver, SyncSender, sync_channel},
    time::{Duration, Instant},
};

use cohabit_cdf::BodyId;
use cohabit_language::{Interpreted, Interpreter, Meant, Unclear};
use serde::Deserialize;
use serde_json::{Value, json};

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

/// What an interpreter made of it.
pub struct Interpretation {
    /// For the robot of this body.
    pub body: BodyId,
    /// Of what was said in this turn.
    pub turn: u64,
    /// What it takes for meant, if it knows.
    pub meant: Option<Meant>,
    /// How it came to that, for the log.
    pub note: String,
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

/// Answers what is asked, as long as anybody asks and is told.
pub fn answer(interpreter: &dyn Interpreter, asked: &Receiver<Asked>, is_told: impl Fn(Interpretation) -> bool) {
    while let Ok(Asked { body, turn, unclear }) = asked.recv() {
        let begun = Instant::now();
        let Interpreted { meant, note } = interpreter.interpret(&unclear).unwrap_or_else(|error| {
            tracing::warn!("the language model could not be asked: {error}");
            Interpreted { meant: None, note: error }
        });
        let note = format!("{} ms: {note}", begun.elapsed().as_millis());
        if !is_told(Interpretation { body, turn, meant, note }) {
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

    /// The model's name.
    #[must_use]
    pub fn model(&self) -> &str {
        &self.model
    }

    /// Where it is asked, without a name, a password and a query that the address may hold.
    #[must_use]
    pub fn public_address(&self) -> String {
        let address = self.address.split(['?', '#']).next().unwrap_or_default();
        let Some((scheme, rest)) = address.split_once("://") else { return String::new() };
        let (host, path) = rest.split_once('/').unwrap_or((rest, ""));
        let host = host.rsplit_once('@').map_or(host, |(_, host)| host);
        format!("{scheme}://{host}/{path}")
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
    fn interpret(&self, unclear: &Unclear) -> Result<Interpreted, String> {
        let answer = self.ask(&question(&self.model, unclear)).map_err(|error| error.to_string())?;
        let answer: Answer =
            serde_json::from_slice(&answer).map_err(|error| format!("its answer is no chat completion: {error}"))?;
        let message = answer.choices.into_iter().next().ok_or("its answer has no `choices`")?.message;
        let note = json!({
            "model": self.model,
            "content": message.content,
            "calls": message.tool_calls.iter().map(|call| &call.function.name).zip(message.arguments()).collect::<Vec<_>>(),
            "usage": answer.usage,
        });
        Ok(Interpreted { meant: message.meant(), note: note.to_string() })
    }
}

/// The part of a chat completion that is read.
#[derive(Deserialize)]
struct Answer {
    choices: Vec<Choice>,
    #[serde(default)]
    usage: Value,
}

#[derive(Deserialize)]
struct Choice {
    message: Message,
}

#[derive(Deserialize)]
struct Message {
    #[serde(default)]
    content: Option<String>,
    #[serde(default, deserialize_with = "or_none")]
    tool_calls: Vec<Call>,
}

#[derive(Deserialize)]
struct Call {
    function: Function,
}

#[derive(Deserialize)]
struct Function {
    name: String,
    /// JSON as text; some servers send it as it is.
    #[serde(default)]
    arguments: Value,
}

/// Servers write no calls as `null` too.
fn or_none<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Vec<Call>, D::Error> {
    Ok(Option::deserialize(deserializer)?.unwrap_or_default())
}

impl Message {
    /// What each call is made with.
    fn arguments(&self) -> impl Iterator<Item = Value> {
        self.tool_calls.iter().map(|Call { function: Function { arguments, .. } }| match arguments {
            Value::String(text) => serde_json::from_str(text).unwrap_or_default(),
            value => value.clone(),
        })
    }

    /// What it says by calls, or else in JSON, whatever stands around that: the calls as an object, or an array of requests.
    fn meant(&self) -> Option<Meant> {
        let called = self.tool_calls.iter().zip(self.arguments()).flat_map(|(call, arguments)| {
            let name = call.function.name.as_str();
            parts(name, &arguments[if name == DO { "requests" } else { "text" }])
        });
        joined(called).or_else(|| {
            let content = self.content.as_deref()?;
            let object = between(content, '{', '}').unwrap_or_default();
            let in_object = [DO, SAY, ASK].into_iter().flat_map(|name| parts(name, &object[name]));
            joined(in_object).or_else(|| joined(parts(DO, &between(content, '[', ']')?).into_iter()))
        })
    }
}

/// What a model may call.
const DO: &str = "do";
const SAY: &str = "say";
const ASK: &str = "ask";

/// A part of what a model wants.
enum Part {
    Request(String),
    Say(String),
    Ask(String),
}

/// What a call of that name with these texts wants.
fn parts(name: &str, texts: &Value) -> Vec<Part> {
    let part = match name {
        DO => Part::Request,
        SAY => Part::Say,
        ASK => Part::Ask,
        _ => return Vec::new(),
    };
    strings(texts).into_iter().map(part).collect()
}

/// What these come to: what is to be done counts most, what is to be known first more than what is said.
fn joined(parts: impl Iterator<Item = Part>) -> Option<Meant> {
    let (mut requests, mut said, mut asked) = (Vec::new(), Vec::new(), Vec::new());
    for part in parts {
        match part {
            Part::Request(request) => requests.push(request),
            Part::Say(text) => said.push(text),
            Part::Ask(text) => asked.push(text),
        }
    }
    match (requests.is_empty(), asked.is_empty(), said.is_empty()) {
        (false, ..) => Some(Meant::Do(requests)),
        (_, false, _) => Some(Meant::Ask(asked.join(" "))),
        (.., false) => Some(Meant::Say(said.join(" "))),
        _ => None,
    }
}

/// A text, or several.
fn strings(value: &Value) -> Vec<String> {
    match value {
        Value::String(text) if !text.trim().is_empty() => vec![text.clone()],
        Value::Array(texts) => texts.iter().filter_map(|text| text.as_str().map(str::to_owned)).collect(),
        _ => Vec::new(),
    }
}

/// The JSON between the first of one character and the last of another.
fn between(content: &str, first: char, last: char) -> Option<Value> {
    let (from, to) = content.find(first).zip(content.rfind(last))?;
    serde_json::from_str(content.get(from..=to)?).ok()
}

/// What a model is asked.
fn question(model: &str, unclear: &Unclear) -> Value {
    let Unclear { utterance, before, things, facts, goals, rooms, held, room } = unclear;
    let things: Vec<&str> = things.iter().take(MOST_THINGS).map(String::as_str).collect();
    let facts = format!(
        "Rooms: {}. Things: {}. What can be carried, and where it is: {}. You are in the {room}. In your hand: {}. Goals of the mission \
         that are not met: {}.",
        rooms.join(", "),
        things.join(", "),
        facts.join("; "),
        held.as_deref().unwrap_or("nothing"),
        if goals.is_empty() { "none that you know of".to_owned() } else { goals.join("; ") },
    );
    let line = |(is_robot, text): &(bool, String)| json!({ "role": if *is_robot { "assistant" } else { "user" }, "content": text });
    let system = json!({ "role": "system", "content": format!("{INSTRUCTIONS}\n{facts}") });
    let utterance = json!({ "role": "user", "content": utterance });
    let messages: Vec<Value> = std::iter::once(system).chain(before.iter().map(line)).chain([utterance]).collect();
    json!({ "model": model, "messages": messages, "tools": tools(), "temperature": 0, "max_tokens": 300 })
}

/// These as an OpenAI-compatible server is told of them.
fn tools() -> Value {
    let tool = |name: &str, about: &str, argument: &str, schema: Value| {
        json!({ "type": "function", "function": {
            "name": name,
            "description": about,
            "parameters": { "type": "object", "properties": { argument: schema }, "required": [argument] },
        } })
    };
    let text = json!({ "type": "string" });
    json!([
        tool(
            DO,
            "Carry out plain requests, one after the other",
            "requests",
            json!({ "type": "array", "items": text })
        ),
        tool(SAY, "Say something to the person, where nothing is to be done", "text", text.clone()),
        tool(ASK, "Ask the person what you must know first", "text", text.clone()),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn meant(message: Value) -> Option<Meant> {
        serde_json::from_value::<Message>(message).unwrap().meant()
    }

    fn requests(all: &[&str]) -> Option<Meant> {
        Some(Meant::Do(all.iter().map(|request| (*request).to_owned()).collect()))
    }

    #[test]
    fn what_is_meant_is_read_from_whatever_stands_around_it() {
        for (content, expected) in [
            (r#"["go to the kitchen", "pick up the mug"]"#, requests(&["go to the kitchen", "pick up the mug"])),
            ("Sure!\n```json\n[\"stop\"]\n```", requests(&["stop"])),
            (r#"{"do": ["open the fridge"]}"#, requests(&["open the fridge"])),
            (r#"Here: {"say": "It is cold."}"#, Some(Meant::Say("It is cold.".to_owned()))),
            (r#"{"ask": "Which one?", "say": "Hm."}"#, Some(Meant::Ask("Which one?".to_owned()))),
            ("[]", None),
            ("{}", None),
            ("go to the kitchen", None),
            ("] [", None),
            ("} {", None),
            ("[1, 2]", None),
        ] {
            assert_eq!(meant(json!({ "content": content })), expected, "{content}");
        }
    }

    #[test]
    fn calls_are_read_as_text_and_as_they_are() {
        let call = |name: &str, arguments: Value| json!({ "id": "1", "type": "function", "function": { "name": name, "arguments": arguments } });
        let calls = |calls: &[Value]| meant(json!({ "role": "assistant", "content": null, "tool_calls": calls }));
        let open = call("do", json!(r#"{"requests": ["open the fridge"]}"#));
        let close = call("do", json!({ "requests": ["close the fridge"] }));
        assert_eq!(calls(&[open.clone(), close]), requests(&["open the fridge", "close the fridge"]));
        assert_eq!(calls(&[call("say", json!(r#"{"text": "Hello."}"#)), open]), requests(&["open the fridge"]));
        assert_eq!(calls(&[call("ask", json!({ "text": "Which one?" }))]), Some(Meant::Ask("Which one?".to_owned())));
        assert_eq!(calls(&[call("fly", json!("{"))]), None);
        assert_eq!(meant(json!({ "content": "[]", "tool_calls": null })), None);
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
    fn the_address_that_is_noted_holds_no_secret() {
        let noted = |address: &str| Endpoint::new(address, "any".to_owned(), None).ok().unwrap().public_address();
        assert_eq!(noted("http://127.0.0.1:11434/v1/"), "http://127.0.0.1:11434/v1/chat/completions");
        assert_eq!(noted("https://me:secret@host/v1"), "https://host/v1/chat/completions");
        assert!(!noted("https://host/v1?key=secret").contains("secret"));
    }

    #[test]
    fn an_address_must_be_one() {
        assert!(Endpoint::new("localhost", "m".to_owned(), None).is_err());
        let endpoint = Endpoint::new("http://localhost:1/v1/", "m".to_owned(), None).ok().unwrap();
        assert_eq!(endpoint.address, "http://localhost:1/v1/chat/completions");
    }
}
