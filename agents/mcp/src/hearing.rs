//! What was said and told in a session, in words for a client.

use cohabit_bus::message::{DialogHeader, DialogKind, EventKind, EventMessage};

/// What people were told of an event, if anything; of goals only where clients may know them.
pub(crate) fn event(event: &EventMessage, tells_goals: bool) -> Option<String> {
    let text = event.text.as_str();
    let (about, is_of_goals) = match event.kind()? {
        EventKind::Message | EventKind::CameraMovement => ("the mission says", false),
        EventKind::NoteRead => ("a note says", false),
        EventKind::MissionFailed => ("the mission has failed", false),
        EventKind::GoalMet => ("a goal is met", true),
        EventKind::GoalShown => ("there is another goal", true),
        EventKind::MissionComplete => return tells_goals.then(|| "all goals of the mission are met".to_owned()),
        _ => return None,
    };
    let is_told = !text.is_empty() && (tells_goals || !is_of_goals);
    is_told.then(|| format!("{about}: {text}"))
}

/// What somebody else said, if it was said to people or by them: to or by the robot with this body, or another one.
pub(crate) fn dialog(header: &DialogHeader, body: u32) -> Option<String> {
    let is_own = header.body == body;
    let who = match header.kind()? {
        DialogKind::Utterance => {
            let who = if header.person == 0 { "somebody".to_owned() } else { format!("person {}", header.person) };
            let to = if is_own { String::new() } else { format!(", to body {}", header.body) };
            who + &to
        }
        DialogKind::Reply | DialogKind::Question if is_own => "the robot's own mind answers".to_owned(),
        DialogKind::Reply | DialogKind::Question => format!("body {}", header.body),
        _ => return None,
    };
    let text = header.text.as_str();
    (!text.is_empty()).then(|| format!("{who}: {text}"))
}

#[cfg(test)]
mod tests {
    use cohabit_bus::message::DialogMessage;

    use super::*;

    #[test]
    fn events_are_told_in_words_and_goals_only_to_who_may_know_them() {
        let told = |kind, text: &str, tells_goals| event(&EventMessage::new(kind).saying(text), tells_goals);
        assert_eq!(told(EventKind::NoteRead, "Mind the gap", false).as_deref(), Some("a note says: Mind the gap"));
        assert_eq!(told(EventKind::Message, "", true), None);
        assert_eq!(told(EventKind::GoalMet, "Open it", true).as_deref(), Some("a goal is met: Open it"));
        assert_eq!(told(EventKind::GoalMet, "Open it", false), None);
        assert_eq!(told(EventKind::MissionComplete, "", false), None);
        assert!(told(EventKind::MissionComplete, "", true).is_some());
        assert_eq!(told(EventKind::Started, "", true), None);
    }

    #[test]
    fn what_is_said_names_who_said_it() {
        let told = |kind, body, text: &str| dialog(&DialogMessage::new(kind, body, 1, text).header, 0);
        assert_eq!(told(DialogKind::Utterance, 0, "hello").as_deref(), Some("somebody: hello"));
        assert_eq!(told(DialogKind::Utterance, 1, "hello").as_deref(), Some("somebody, to body 1: hello"));
        assert_eq!(told(DialogKind::Reply, 0, "OK.").as_deref(), Some("the robot's own mind answers: OK."));
        assert_eq!(told(DialogKind::Question, 1, "Which?").as_deref(), Some("body 1: Which?"));
        assert_eq!(told(DialogKind::PlanEnded, 0, "x"), None);
        let mut message = DialogMessage::new(DialogKind::Utterance, 0, 1, "hello");
        message.header.person = 3;
        assert_eq!(dialog(&message.header, 0).as_deref(), Some("person 3: hello"));
    }
}
