//! The tools, as clients are told of them, and what they are called with.

use cohabit_agent::{ToolArgument, ToolDeed, tools};
use cohabit_bus::message::LONGEST_TEXT_CHARS;
use cohabit_cdf::{ActionKind, ActionTable};
use serde_json::{Map, Value, json};

use crate::limits::{LONGEST_NAME_CHARS, LONGEST_WAIT_S};

/// What clients are told of all tools together.
pub(crate) const INSTRUCTIONS: &str = include_str!("../data/instructions.md");

/// What a tool does.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Kind {
    /// Tells and shows what is in sight.
    Look,
    /// Has the body do something.
    Body(ToolDeed),
    /// Points a thing out to people.
    PointOut,
    /// Says something to people.
    Say,
    /// Asks people something, and waits for what they say.
    Ask,
    /// Tells what was said.
    Listen,
    /// Tells the goals of the mission.
    Goals,
    /// Lets time go by.
    Wait,
    /// Has the body let go of what it is doing.
    Stop,
}

/// A tool.
pub(crate) struct Tool {
    /// What it does.
    pub kind: Kind,
    /// Its name.
    pub name: &'static str,
    about: String,
    arguments: Vec<Argument>,
}

/// What a tool is called with.
#[derive(Clone, Copy, Debug)]
struct Argument {
    name: &'static str,
    about: &'static str,
    takes: Takes,
}

#[derive(Clone, Copy, Debug)]
enum Takes {
    /// A thing, by its number or in words.
    Thing,
    /// What is said to people.
    Text,
    /// A number from the first to the second; the third, if none is given.
    Number(f64, f64, Option<f64>),
}

/// What a tool was called with: words and a number, as far as it takes them.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Given {
    /// The name or the number of a thing, or what is to be said.
    pub words: String,
    /// The number.
    pub number: f64,
}

const OBJECT: Argument = Argument {
    name: "object",
    about: "the object: its number in what `look` lists, such as `12`; its instance id, such as `Bowl_01_1`; or what people \
            call it, such as `the red mug`",
    takes: Takes::Thing,
};
const PLACE: Argument = Argument {
    name: "object",
    about: "the object, by its number, its instance id or what people call it; or a room, such as `break room`",
    takes: Takes::Thing,
};
const TEXT: Argument = Argument { name: "text", about: "what to say, in plain text", takes: Takes::Text };
const ANSWER: Argument = Argument {
    name: "seconds",
    about: "how many seconds to wait for an answer",
    takes: Takes::Number(1.0, LONGEST_WAIT_S, Some(30.0)),
};
const SECONDS: Argument =
    Argument { name: "seconds", about: "how many", takes: Takes::Number(0.1, LONGEST_WAIT_S, None) };

/// The tools that the table of actions does not have: what each does, its name, what it is told to do, and its arguments.
const OWN: [(Kind, &str, &str, &[Argument]); 8] = [
    (
        Kind::Look,
        "look",
        "Tell and show what is in sight: where you are, what you hold, a numbered list of things with names, states, \
         distance and direction, nearest first, and the picture of your camera.",
        &[],
    ),
    (Kind::PointOut, "point_out", "Outline an object for the people who watch.", &[OBJECT]),
    (Kind::Say, "say", "Say something to the people of the session.", &[TEXT]),
    (
        Kind::Ask,
        "ask",
        "Ask the people of the session something, and wait for the first of them to say anything.",
        &[TEXT, ANSWER],
    ),
    (Kind::Listen, "listen", "Tell what was said, and what the mission told people, since this was last called.", &[]),
    (Kind::Goals, "goals", "Tell the goals of the mission: which are met, and which are left.", &[]),
    (
        Kind::Wait,
        "wait",
        "Let so many seconds go by; fewer, if an action under way ends before: then what came of it is told.",
        &[SECONDS],
    ),
    (Kind::Stop, "stop", "Stop whatever the body is doing, now.", &[]),
];

/// All tools of a body in a world with this table; that which tells goals only where clients may know them.
pub(crate) fn all(table: &ActionTable, tells_goals: bool) -> Vec<Tool> {
    let own = OWN.into_iter().filter(|(kind, ..)| tells_goals || *kind != Kind::Goals);
    let own = own.map(|(kind, name, about, arguments)| Tool {
        kind,
        name,
        about: about.to_owned(),
        arguments: arguments.to_vec(),
    });
    let of_body = tools(table).into_iter().map(|tool| Tool {
        kind: Kind::Body(tool.deed),
        name: name(tool.deed),
        about: about(tool.deed, tool.description),
        arguments: argument(tool.deed).into_iter().collect(),
    });
    own.chain(of_body).collect()
}

/// What clients call it.
const fn name(deed: ToolDeed) -> &'static str {
    match deed {
        // The word that people, and so language models, have for it.
        ToolDeed::Handle(ActionKind::Place) => "put",
        deed => deed.name(),
    }
}

/// What clients are told of it: what the body does, and what they learn by it.
fn about(deed: ToolDeed, description: String) -> String {
    match deed {
        ToolDeed::LookAround => description + " The answer tells and shows what is in sight then, as `look` does.",
        _ => description,
    }
}

fn argument(deed: ToolDeed) -> Option<Argument> {
    match deed.argument()? {
        ToolArgument::Object if deed == ToolDeed::Handle(ActionKind::GoTo) => Some(PLACE),
        ToolArgument::Object => Some(OBJECT),
        ToolArgument::Number { name, low, high } => {
            let about = match deed {
                ToolDeed::Turn => "how far, in radians: degrees divided by 57.3; positive is to the left",
                _ => "how far, in metres; negative is backwards",
            };
            Some(Argument { name, about, takes: Takes::Number(low, high, None) })
        }
    }
}

impl Tool {
    /// As clients are told of it.
    pub fn json(&self) -> Value {
        let properties: Map<String, Value> =
            self.arguments.iter().map(|argument| (argument.name.to_owned(), argument.schema())).collect();
        let needed: Vec<&str> =
            self.arguments.iter().filter(|argument| argument.is_needed()).map(|argument| argument.name).collect();
        let only_tells = matches!(self.kind, Kind::Look | Kind::Listen | Kind::Goals | Kind::Wait);
        json!({
            "name": self.name,
            "description": self.about,
            "inputSchema": {
                "type": "object",
                "properties": properties,
                "required": needed,
                "additionalProperties": false,
            },
            "annotations": { "readOnlyHint": only_tells },
        })
    }

    /// What it was called with; why not, if that makes no sense.
    pub fn read(&self, arguments: &Map<String, Value>) -> Result<Given, String> {
        let is_known = |name: &&String| self.arguments.iter().any(|argument| argument.name == name.as_str());
        if let Some(unknown) = arguments.keys().find(|name| !is_known(name)) {
            let names: Vec<&str> = self.arguments.iter().map(|argument| argument.name).collect();
            let taken = if names.is_empty() { "no arguments".to_owned() } else { names.join(" and ") };
            return Err(format!("`{}` takes {taken}, not `{unknown}`", self.name));
        }
        let mut given = Given::default();
        for argument in &self.arguments {
            argument.read(arguments.get(argument.name), &mut given)?;
        }
        Ok(given)
    }
}

impl Argument {
    const fn is_needed(&self) -> bool {
        !matches!(self.takes, Takes::Number(.., Some(_)))
    }

    fn schema(&self) -> Value {
        let text = |most: usize| json!({ "type": "string", "minLength": 1, "maxLength": most });
        let mut schema = match self.takes {
            Takes::Thing => text(LONGEST_NAME_CHARS),
            Takes::Text => text(LONGEST_TEXT_CHARS),
            Takes::Number(low, high, _) => json!({ "type": "number", "minimum": low, "maximum": high }),
        };
        if let Takes::Number(.., Some(usual)) = self.takes {
            schema["default"] = json!(usual);
        }
        schema["description"] = json!(self.about);
        schema
    }

    fn read(&self, value: Option<&Value>, given: &mut Given) -> Result<(), String> {
        match self.takes {
            Takes::Thing => given.words = self.words(value, LONGEST_NAME_CHARS)?,
            Takes::Text => given.words = self.words(value, LONGEST_TEXT_CHARS)?,
            Takes::Number(low, high, usual) => {
                let number = if value.is_none() { usual } else { value.and_then(Value::as_f64) };
                let number = number.filter(|number| (low..=high).contains(number));
                let problem = || format!("`{}` is a number from {low} to {high}: {}", self.name, self.about);
                given.number = number.ok_or_else(problem)?;
            }
        }
        Ok(())
    }

    /// Words of at most so many characters; the number of a thing stands for its digits.
    fn words(&self, value: Option<&Value>, most: usize) -> Result<String, String> {
        let words = match value {
            Some(Value::String(words)) => words.trim().to_owned(),
            Some(Value::Number(number)) if matches!(self.takes, Takes::Thing) => number.to_string(),
            _ => String::new(),
        };
        let is_within = !words.is_empty() && words.chars().nth(most).is_none();
        if is_within { Ok(words) } else { Err(format!("`{}` is a text of 1 to {most} characters", self.name)) }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use cohabit_cdf::Catalog;

    use super::*;

    fn tools_with(goals: bool) -> Vec<Tool> {
        all(Catalog::builtin().table(), goals)
    }

    #[test]
    fn each_tool_has_a_name_of_its_own_and_a_schema() {
        let all = tools_with(true);
        let names: BTreeSet<&str> = all.iter().map(|tool| tool.name).collect();
        assert_eq!(names.len(), all.len());
        for name in [
            "look",
            "look_around",
            "go_to",
            "move",
            "turn",
            "pick_up",
            "put",
            "open",
            "close",
            "toggle",
            "pour",
            "point_out",
            "say",
            "ask",
            "listen",
            "goals",
            "wait",
            "stop",
        ] {
            assert!(names.contains(name), "{name}: {names:?}");
        }
        for tool in &all {
            let told = tool.json();
            let schema = &told["inputSchema"];
            assert_eq!((&schema["type"], &schema["additionalProperties"]), (&json!("object"), &json!(false)));
            for needed in schema["required"].as_array().unwrap() {
                assert!(schema["properties"].get(needed.as_str().unwrap()).is_some(), "{told}");
            }
        }
        assert!(tools_with(false).iter().all(|tool| tool.kind != Kind::Goals));
    }

    #[test]
    fn only_what_the_schema_allows_is_taken() {
        let all = tools_with(true);
        let read = |name: &str, arguments: Value| {
            let tool = all.iter().find(|tool| tool.name == name).unwrap();
            tool.read(arguments.as_object().unwrap())
        };
        let words = |words: &str, number: f64| Ok(Given { words: words.to_owned(), number });
        assert_eq!(read("pick_up", json!({ "object": " the bowl " })), words("the bowl", 0.0));
        assert_eq!(read("pick_up", json!({ "object": 12 })), words("12", 0.0));
        assert_eq!(read("move", json!({ "distance_m": -1 })), words("", -1.0));
        assert_eq!(read("ask", json!({ "text": "Which?" })), words("Which?", 30.0));
        assert_eq!(read("ask", json!({ "text": "Which?", "seconds": 2.5 })), words("Which?", 2.5));
        assert_eq!(read("look", json!({})), words("", 0.0));
        for (name, arguments, part) in [
            ("pick_up", json!({}), "`object` is a text"),
            ("pick_up", json!({ "object": "" }), "`object` is a text"),
            ("pick_up", json!({ "object": "x".repeat(201) }), "1 to 200 characters"),
            ("pick_up", json!({ "thing": "bowl" }), "takes object, not `thing`"),
            ("look", json!({ "object": "bowl" }), "takes no arguments"),
            ("move", json!({ "distance_m": "far" }), "a number from -10 to 10"),
            ("move", json!({ "distance_m": 11 }), "a number from -10 to 10"),
            ("move", json!({ "distance_m": null }), "a number from -10 to 10"),
            ("turn", json!({ "yaw_rad": 90 }), "in radians: degrees divided by 57.3"),
            ("say", json!({ "text": 3 }), "`text` is a text"),
            ("ask", json!({ "text": "Which?", "seconds": 3600 }), "a number from 1 to 50"),
            ("wait", json!({}), "`seconds` is a number"),
        ] {
            let refused = read(name, arguments).unwrap_err();
            assert!(refused.contains(part), "{name}: {refused}");
        }
    }
}
