//! What a client asks by JSON-RPC 2.0, and how it is answered: the part of the Model Context Protocol that a server of tools needs.

use serde_json::{Map, Value, json};

use crate::{limits::LONGEST_LINE, lines::Line};

/// The versions of the protocol that are spoken, the newest first. That of 2025-03-26 alone has several messages in one, so who
/// asks for it is answered with the one before.
const VERSIONS: [&str; 3] = ["2025-11-25", "2025-06-18", "2024-11-05"];

// The codes of errors, as JSON-RPC has them.
const PARSE_ERROR: i32 = -32700;
const INVALID_REQUEST: i32 = -32600;
const METHOD_NOT_FOUND: i32 = -32601;
const INVALID_PARAMS: i32 = -32602;

/// What is to be done about a line.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Heard {
    /// Nothing.
    Nothing,
    /// This is to be answered at once.
    Answer(Value),
    /// The connection begins.
    Begun {
        /// What is to be answered at once.
        answer: Value,
        /// What the client is called, if it says so.
        client: Option<String>,
    },
    /// A tool is to be used.
    Call {
        /// The number of the request, by which it is answered.
        id: Value,
        /// The tool's name: one of those that are listed.
        name: String,
        /// What it is called with.
        arguments: Map<String, Value>,
    },
    /// The client no longer wants the request of this number answered.
    Cancelled(Value),
}

/// One client's connection.
pub(crate) struct Protocol {
    /// The tools, as clients are told of them.
    tools: Vec<Value>,
    /// What clients are told of all of them together.
    instructions: &'static str,
    is_begun: bool,
}

/// Why a request is not answered: a code, and a sentence.
type Fault = (i32, String);

impl Protocol {
    /// A connection that has not begun yet, with these tools.
    pub fn new(tools: Vec<Value>, instructions: &'static str) -> Self {
        Self { tools, instructions, is_begun: false }
    }

    /// Takes in a line.
    pub fn hear(&mut self, line: &Line) -> Heard {
        let Line::Whole(bytes) = line else {
            let why = format!("a message has at most {LONGEST_LINE} bytes");
            return Heard::Answer(refusal(&Value::Null, (INVALID_REQUEST, why)));
        };
        if bytes.iter().all(u8::is_ascii_whitespace) {
            return Heard::Nothing;
        }
        match serde_json::from_slice::<Value>(bytes) {
            Ok(message) => self.take(&message),
            Err(error) => {
                let why = format!("the line is no JSON: {error}");
                Heard::Answer(refusal(&Value::Null, (PARSE_ERROR, why)))
            }
        }
    }

    fn take(&mut self, message: &Value) -> Heard {
        let id = message.get("id").filter(|id| id.is_string() || id.is_number());
        let refused = |why: &str| {
            let why = (INVALID_REQUEST, why.to_owned());
            Heard::Answer(refusal(id.unwrap_or(&Value::Null), why))
        };
        if !message.is_object() {
            return refused("a message is one JSON object");
        }
        if message.get("jsonrpc").and_then(Value::as_str) != Some("2.0") {
            return refused("a message has the member `jsonrpc`, which is `2.0`");
        }
        let Some(method) = message.get("method").and_then(Value::as_str) else {
            // This server asks clients for nothing.
            let is_answer = message.get("result").or_else(|| message.get("error")).is_some();
            return if is_answer { Heard::Nothing } else { refused("a message has the member `method`") };
        };
        let nothing = Map::new();
        let parameters = match message.get("params") {
            None => Ok(&nothing),
            Some(parameters) => parameters.as_object().ok_or("`params` is an object"),
        };
        match (message.get("id"), id, parameters) {
            (None, _, Ok(parameters)) => notified(method, parameters),
            (None, _, Err(_)) => Heard::Nothing,
            (Some(_), None, _) => refused("an `id` is a string or a number"),
            (Some(_), Some(id), Err(why)) => Heard::Answer(refusal(id, (INVALID_PARAMS, why.to_owned()))),
            (Some(_), Some(id), Ok(parameters)) => {
                let heard = self.request(id, method, parameters);
                heard.unwrap_or_else(|fault| Heard::Answer(refusal(id, fault)))
            }
        }
    }

    fn request(&mut self, id: &Value, method: &str, parameters: &Map<String, Value>) -> Result<Heard, Fault> {
        match method {
            "initialize" => self.begin(id, parameters),
            "ping" => Ok(Heard::Answer(answer(id, json!({})))),
            "tools/list" | "tools/call" if !self.is_begun => {
                Err((INVALID_REQUEST, "`initialize` comes before anything else".to_owned()))
            }
            "tools/list" => Ok(Heard::Answer(answer(id, json!({ "tools": self.tools })))),
            "tools/call" => self.call(id, parameters),
            _ => Err((METHOD_NOT_FOUND, format!("there is no method `{method}`"))),
        }
    }

    fn begin(&mut self, id: &Value, parameters: &Map<String, Value>) -> Result<Heard, Fault> {
        let asked = parameters.get("protocolVersion").and_then(Value::as_str);
        let asked = asked.ok_or_else(|| (INVALID_PARAMS, "`protocolVersion` is missing".to_owned()))?;
        self.is_begun = true;
        let spoken = json!({
            "protocolVersion": version(asked),
            "capabilities": { "tools": {} },
            "serverInfo": { "name": "cohabit", "title": "Cohabit", "version": env!("CARGO_PKG_VERSION") },
            "instructions": self.instructions,
        });
        Ok(Heard::Begun { answer: answer(id, spoken), client: client_name(parameters) })
    }

    fn call(&self, id: &Value, parameters: &Map<String, Value>) -> Result<Heard, Fault> {
        let fault = |why: String| Err((INVALID_PARAMS, why));
        let Some(name) = parameters.get("name").and_then(Value::as_str) else {
            return fault("`name` is missing: that of a tool".to_owned());
        };
        if !self.tools.iter().any(|tool| tool["name"] == name) {
            return fault(format!("there is no tool `{name}`"));
        }
        let arguments = match parameters.get("arguments") {
            None => Map::new(),
            Some(Value::Object(arguments)) => arguments.clone(),
            Some(_) => return fault("`arguments` is an object".to_owned()),
        };
        Ok(Heard::Call { id: id.clone(), name: name.to_owned(), arguments })
    }
}

/// What a client is called: its title for people, or else its name.
fn client_name(parameters: &Map<String, Value>) -> Option<String> {
    let about = parameters.get("clientInfo")?;
    let named = |member: &str| {
        let name: String = about.get(member)?.as_str()?.chars().filter(|letter| !letter.is_control()).collect();
        Some(name.trim().to_owned()).filter(|name| !name.is_empty())
    };
    named("title").or_else(|| named("name"))
}

/// What a notification is about, which nobody answers.
fn notified(method: &str, parameters: &Map<String, Value>) -> Heard {
    match (method, parameters.get("requestId")) {
        ("notifications/cancelled", Some(id)) => Heard::Cancelled(id.clone()),
        _ => Heard::Nothing,
    }
}

/// The version that is spoken with who asks for one: that one, or the newest before it; the newest of all with who asks for an
/// older one than there is.
fn version(asked: &str) -> &'static str {
    VERSIONS.into_iter().find(|known| *known <= asked).unwrap_or(VERSIONS[0])
}

/// The answer to a request.
pub(crate) fn answer(id: &Value, result: Value) -> Value {
    json!({ "jsonrpc": "2.0", "id": id, "result": result })
}

/// The answer to a request that makes no sense.
fn refusal(id: &Value, (code, why): Fault) -> Value {
    json!({ "jsonrpc": "2.0", "id": id, "error": { "code": code, "message": why } })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn protocol() -> Protocol {
        Protocol::new(vec![json!({ "name": "look" })], "Look first.")
    }

    fn line(message: &Value) -> Line {
        Line::Whole(message.to_string().into_bytes())
    }

    fn request(method: &str, parameters: Value) -> Line {
        line(&json!({ "jsonrpc": "2.0", "id": 7, "method": method, "params": parameters }))
    }

    /// What a connection that has begun answers.
    fn begun() -> Protocol {
        let mut protocol = protocol();
        let _ = protocol.hear(&request("initialize", json!({ "protocolVersion": "2025-06-18" })));
        protocol
    }

    fn answered(heard: Heard) -> Value {
        match heard {
            Heard::Answer(answer) | Heard::Begun { answer, .. } => answer,
            other => panic!("not answered: {other:?}"),
        }
    }

    fn check_error(protocol: &mut Protocol, line: &Line, id: &Value, code: i32, part: &str) {
        let answer = answered(protocol.hear(line));
        assert_eq!((&answer["jsonrpc"], &answer["id"]), (&json!("2.0"), id), "{answer}");
        assert_eq!(answer["error"]["code"], code, "{answer}");
        assert!(answer["error"]["message"].as_str().unwrap().contains(part), "{answer}");
    }

    #[test]
    fn a_connection_begins_with_a_version_that_both_speak() {
        for (asked, spoken) in [
            ("2025-11-25", "2025-11-25"),
            ("2025-06-18", "2025-06-18"),
            ("2025-03-26", "2024-11-05"),
            ("2024-11-05", "2024-11-05"),
            ("2099-01-01", "2025-11-25"),
            ("2020-01-01", "2025-11-25"),
        ] {
            let answer = answered(protocol().hear(&request("initialize", json!({ "protocolVersion": asked }))));
            assert_eq!((&answer["id"], &answer["result"]["protocolVersion"]), (&json!(7), &json!(spoken)), "{asked}");
            assert_eq!(answer["result"]["capabilities"], json!({ "tools": {} }));
            assert_eq!(answer["result"]["serverInfo"]["name"], "cohabit");
            assert_eq!(answer["result"]["instructions"], "Look first.");
        }
        let nothing = request("initialize", json!({}));
        check_error(&mut protocol(), &nothing, &json!(7), INVALID_PARAMS, "`protocolVersion`");
    }

    #[test]
    fn a_client_is_called_by_its_title_or_else_by_its_name() {
        for (about, expected) in [
            (json!({ "name": "claude-ai", "title": "Claude", "version": "1" }), Some("Claude")),
            (json!({ "name": " claude-ai\n", "title": " " }), Some("claude-ai")),
            (json!({ "name": 3 }), None),
            (json!({}), None),
            (Value::Null, None),
        ] {
            let parameters = json!({ "protocolVersion": "2025-06-18", "clientInfo": &about });
            let Heard::Begun { client, .. } = protocol().hear(&request("initialize", parameters)) else {
                panic!("it does not begin: {about}");
            };
            assert_eq!(client.as_deref(), expected, "{about}");
        }
    }

    #[test]
    fn tools_are_listed_and_called_once_a_connection_has_begun() {
        let list = request("tools/list", json!({}));
        check_error(&mut protocol(), &list, &json!(7), INVALID_REQUEST, "`initialize`");
        assert_eq!(answered(begun().hear(&list))["result"], json!({ "tools": [{ "name": "look" }] }));
        for (parameters, expected) in [
            (json!({ "name": "look", "arguments": { "far": true } }), json!({ "far": true })),
            (json!({ "name": "look" }), json!({})),
        ] {
            let arguments = expected.as_object().cloned().unwrap_or_default();
            let call = Heard::Call { id: json!(7), name: "look".to_owned(), arguments };
            assert_eq!(begun().hear(&request("tools/call", parameters)), call);
        }
        for (parameters, part) in [
            (json!({}), "`name`"),
            (json!({ "name": "fly" }), "no tool `fly`"),
            (json!({ "name": "look", "arguments": 3 }), "`arguments` is an object"),
            (json!([1]), "`params` is an object"),
        ] {
            check_error(&mut begun(), &request("tools/call", parameters), &json!(7), INVALID_PARAMS, part);
        }
    }

    #[test]
    fn a_ping_is_answered_at_any_time() {
        let ping = line(&json!({ "jsonrpc": "2.0", "id": "p", "method": "ping" }));
        assert_eq!(answered(protocol().hear(&ping)), json!({ "jsonrpc": "2.0", "id": "p", "result": {} }));
    }

    #[test]
    fn what_makes_no_sense_is_answered_as_the_protocol_says() {
        let mut protocol = begun();
        let unknown = request("resources/list", json!({}));
        check_error(&mut protocol, &unknown, &json!(7), METHOD_NOT_FOUND, "no method `resources/list`");
        for (text, id, code, part) in [
            ("{", Value::Null, PARSE_ERROR, "no JSON"),
            ("[]", Value::Null, INVALID_REQUEST, "one JSON object"),
            ("3", Value::Null, INVALID_REQUEST, "one JSON object"),
            (r#"{"id": 3, "method": "ping"}"#, json!(3), INVALID_REQUEST, "`jsonrpc`"),
            (r#"{"jsonrpc": "2.0", "id": 3}"#, json!(3), INVALID_REQUEST, "`method`"),
            (r#"{"jsonrpc": "2.0", "id": null, "method": "ping"}"#, Value::Null, INVALID_REQUEST, "`id`"),
            (r#"{"jsonrpc": "2.0", "id": {}, "method": "ping"}"#, Value::Null, INVALID_REQUEST, "`id`"),
        ] {
            check_error(&mut protocol, &Line::Whole(text.as_bytes().to_vec()), &id, code, part);
        }
        check_error(&mut protocol, &Line::Whole(vec![0xff, 0xfe]), &Value::Null, PARSE_ERROR, "no JSON");
        check_error(&mut protocol, &Line::TooLong, &Value::Null, INVALID_REQUEST, "1048576 bytes");
        // It goes on.
        assert_eq!(answered(protocol.hear(&request("ping", json!({}))))["result"], json!({}));
    }

    #[test]
    fn what_is_deeply_nested_is_no_json_that_is_read() {
        let deep = Line::Whole(vec![b'['; 100_000]);
        check_error(&mut begun(), &deep, &Value::Null, PARSE_ERROR, "no JSON");
    }

    #[test]
    fn notifications_and_answers_are_not_answered() {
        let mut protocol = begun();
        for message in [
            json!({ "jsonrpc": "2.0", "method": "notifications/initialized" }),
            json!({ "jsonrpc": "2.0", "method": "notifications/unheard_of", "params": {} }),
            json!({ "jsonrpc": "2.0", "method": "tools/list" }),
            json!({ "jsonrpc": "2.0", "method": "notifications/cancelled", "params": [] }),
            json!({ "jsonrpc": "2.0", "id": 1, "result": {} }),
            json!({ "jsonrpc": "2.0", "id": 1, "error": { "code": 1, "message": "no" } }),
        ] {
            assert_eq!(protocol.hear(&line(&message)), Heard::Nothing, "{message}");
        }
        assert_eq!(protocol.hear(&Line::Whole(b" \r".to_vec())), Heard::Nothing);
        let cancelled = json!({ "jsonrpc": "2.0", "method": "notifications/cancelled", "params": { "requestId": 7 } });
        assert_eq!(protocol.hear(&line(&cancelled)), Heard::Cancelled(json!(7)));
    }
}
