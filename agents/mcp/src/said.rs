//! What a call of a tool is answered: a sentence, perhaps a picture, and whether it was refused.

use cohabit_agent::Outcome;
use serde_json::{Value, json};

/// What a call is answered.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Said {
    text: String,
    /// JPEG in base64.
    picture: Option<String>,
    is_refusal: bool,
}

impl Said {
    /// It was done, or this is what was asked for.
    pub fn done(text: impl Into<String>) -> Self {
        Self { text: text.into(), picture: None, is_refusal: false }
    }

    /// It was refused, or made no sense: why.
    pub fn refused(why: impl AsRef<str>) -> Self {
        Self { text: format!("Refused: {}.", why.as_ref().trim_end_matches('.')), picture: None, is_refusal: true }
    }

    /// What came of a command.
    pub fn of(outcome: &Outcome) -> Self {
        let detail = outcome.detail.trim_end_matches('.');
        if outcome.status.is_success() {
            return Self::done(if detail.is_empty() { "Done.".to_owned() } else { format!("{detail}.") });
        }
        let why = if detail.is_empty() { "nothing came of it" } else { detail };
        Self { text: format!("Refused ({:?}): {why}.", outcome.status), picture: None, is_refusal: true }
    }

    /// The same with a picture: JPEG in base64.
    pub fn with_picture(self, picture: String) -> Self {
        Self { picture: Some(picture), ..self }
    }

    /// As the protocol has the result of a call.
    pub fn json(self) -> Value {
        let mut content = vec![json!({ "type": "text", "text": self.text })];
        let picture = self.picture.map(|data| json!({ "type": "image", "data": data, "mimeType": "image/jpeg" }));
        content.extend(picture);
        json!({ "content": content, "isError": self.is_refusal })
    }
}

#[cfg(test)]
mod tests {
    use cohabit_cdf::Status;

    use super::*;

    #[test]
    fn outcomes_are_sentences() {
        for (status, detail, text, is_refusal) in [
            (Status::ActionSuccessful, "I am holding the bowl", "I am holding the bowl.", false),
            (Status::ActionSuccessful, "", "Done.", false),
            (Status::TargetOutOfRange, "it is too far away", "Refused (TargetOutOfRange): it is too far away.", true),
            (Status::Interrupted, "", "Refused (Interrupted): nothing came of it.", true),
        ] {
            let outcome = Outcome { command: 1, status, detail: detail.to_owned(), tick: 1 };
            let told = Said::of(&outcome).json();
            assert_eq!(told["content"], json!([{ "type": "text", "text": text }]));
            assert_eq!(told["isError"], is_refusal, "{text}");
        }
    }

    #[test]
    fn a_picture_stands_behind_the_text() {
        let told = Said::done("In sight.").with_picture("AAAA".to_owned()).json();
        assert_eq!(told["content"][1], json!({ "type": "image", "data": "AAAA", "mimeType": "image/jpeg" }));
        assert_eq!(Said::refused("why.").json()["content"][0]["text"], "Refused: why.");
    }
}
