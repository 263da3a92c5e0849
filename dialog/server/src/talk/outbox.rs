//! What follows from what robots hear: on the bus, on the pages, aloud, and in the journal first.

use std::collections::BTreeMap;

use cohabit_bus::{message::DialogKind, monotonic_nanos};
use cohabit_cdf::BodyId;

use super::{Heard, Inner, Talk, held};
use crate::{
    DialogError,
    conversation::Reaction,
    interpreter::Asked,
    journal::Deed,
    page::{self, Speaker},
};

/// Why nothing came of an interpreter, for the log.
const NOT_ASKED: &str = "too much was asked already";

impl Talk {
    /// Does what follows from a message for the robot of a body, once it is written down.
    pub(super) fn carry_out(
        &self,
        inner: &mut Inner,
        body: BodyId,
        heard: Heard<'_>,
        mut reactions: Vec<Reaction>,
    ) -> Result<(), DialogError> {
        let are_several = inner.robots.are_several();
        for reaction in &mut reactions {
            match reaction {
                Reaction::Chat(line) => {
                    line.body = are_several.then_some(body.0);
                    line.visitor = heard.visitor().filter(|_| line.from == Speaker::Person);
                }
                Reaction::Bus(message) if message.header.kind() == Some(DialogKind::Utterance) => {
                    message.header.person = heard.visitor().unwrap_or(0);
                }
                _ => {}
            }
        }
        let Some(robot) = inner.robots.of_body(body) else { return Ok(()) };
        let memory = robot.conversation.memory().clone();
        inner.robots.note_speech(body);
        inner.journal.will_tell(Deed {
            heard: heard.envelope().map(|envelope| (envelope.run, envelope.sequence)),
            lines: reactions.iter().filter_map(Reaction::line).cloned().collect(),
            conversations: BTreeMap::from([(body.0, memory)]),
        });
        let proposes = reactions.contains(&Reaction::Proposes);
        for reaction in reactions {
            match reaction {
                Reaction::Proposes => {}
                Reaction::ForWizard(text) => self.hub.tell_wizards(&page::unsaid(body.0, &text)),
                Reaction::Answers { turn, received_nanos } => {
                    inner.latency.answered(turn, received_nanos, monotonic_nanos());
                }
                Reaction::Bus(message) => inner.publish(&message)?,
                Reaction::Chat(line) => {
                    self.hub.say(&line);
                    if line.from == Speaker::Robot {
                        self.voice.say(&line, body.0);
                    }
                }
                Reaction::Page(message) => self.hub.tell(&message),
                Reaction::Expresses(shown) => self.hub.show_face(body.0, &page::expression(body.0, shown)),
                Reaction::Interpret(turn, unclear) => {
                    let is_asked = self
                        .interpreter
                        .as_ref()
                        .is_some_and(|puzzles| puzzles.ask(Asked { body, turn, unclear: *unclear }));
                    if !is_asked {
                        self.interpreted(inner, body, turn, None, NOT_ASKED)?;
                    }
                }
                Reaction::TurnEnded { turn, end } => {
                    self.show_state(inner)?;
                    self.hub.tell(&page::turn_ended(body.0, turn, end.name()));
                }
            }
        }
        self.hub.mark(inner.numbered().map(|asked| asked.candidates.as_slice()).unwrap_or_default());
        inner.journal.told();
        if let Some(robot) = inner.robots.look_at(body).filter(|_| proposes) {
            self.hub.tell_wizards(&held::proposed(robot, monotonic_nanos()));
        }
        self.alarm.set(inner.due());
        Ok(())
    }
}

/// All that were called hear what somebody said, and it is shown once.
pub(super) fn is_shown_to_all(reaction: &Reaction) -> bool {
    reaction.line().is_none_or(|line| line.from != Speaker::Person)
}
