//! What the other peers of the session are called, by their heartbeats, for people who want to know who speaks to them.

use std::collections::BTreeMap;

use cohabit_bus::{
    Inbox, Text, Topic, Transport,
    message::{self, PulseMessage},
    process_of,
};

use crate::{DialogError, text::in_one_line};

/// The peers that speak as the robot itself: its own mind, and this service.
const OWN: [&str; 2] = ["agent", "dialog"];
/// The most peers that are known: a session has some ten.
const MOST_PEERS: usize = 256;

/// The names of peers.
pub struct Peers {
    pulses: Inbox,
    /// By the process, and the body that it speaks for.
    names: BTreeMap<(u32, u32), String>,
}

impl Peers {
    /// None yet: they come with [`Self::refresh`].
    pub fn new(bus: &dyn Transport) -> Result<Self, DialogError> {
        Ok(Self { pulses: Inbox::new(bus, Topic::Pulses)?, names: BTreeMap::new() })
    }

    /// Takes in what was published since.
    pub fn refresh(&mut self) -> Result<(), DialogError> {
        while let Some((sample, pulse)) = self.pulses.next(|sample| message::read::<PulseMessage>(sample.payload()))? {
            let process = process_of(sample.envelope().run);
            self.names.insert((process, pulse.body), in_one_line(pulse.peer.as_str()));
            if self.names.len() > MOST_PEERS {
                self.names.pop_first();
            }
        }
        Ok(())
    }

    /// What the peer of this run is called that speaks for a body, if it is not the robot's own mind.
    pub fn name(&self, run: u64, body: u32) -> Option<&str> {
        let name = self.names.get(&(process_of(run), body))?.as_str();
        (!name.is_empty() && !OWN.contains(&name)).then_some(name)
    }
}

/// What the world says, for people: where another peer commands the robot, who that is and what they can do.
pub fn for_people<const N: usize>(text: &Text<N>) -> Text<N> {
    commander(text.as_str()).map_or(*text, |peer| Text::new(&commanded_by(peer)))
}

/// Who commands the body, if the world refuses a command for that reason.
fn commander(text: &str) -> Option<&str> {
    let told = text.strip_prefix("the ")?.strip_suffix(": it has to be taken over")?;
    told.rsplit_once(" commands body ").map(|(peer, _)| peer)
}

/// The cause, and behind a colon the remedy, as the world has both.
fn commanded_by(peer: &str) -> String {
    let who = match peer {
        "page" => "somebody at a page".to_owned(),
        "agent" => "another agent".to_owned(),
        // A colon ends the cause.
        peer => format!("the program \"{}\"", in_one_line(peer).replace(": ", " ")),
    };
    format!("{who} commands me now, so I cannot do that: ask me again once I am free, or ask me something meanwhile")
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use cohabit_bus::{Heart, Local};

    use super::*;

    #[test]
    fn peers_are_known_by_their_heartbeats_and_the_own_mind_has_no_name() {
        let bus = Local::new(1);
        let mut peers = Peers::new(&bus).unwrap();
        let run = bus.publisher(Topic::Dialog).unwrap().run();
        assert_eq!(peers.name(run, 0), None);
        let mut heart = Heart::new(&bus, "mcp", 0).unwrap();
        for (name, expected) in [("mcp", Some("mcp")), ("Claude", Some("Claude")), ("agent", None), ("", None)] {
            heart.rename(name);
            heart.beat(1, 0).unwrap();
            peers.refresh().unwrap();
            assert_eq!(peers.name(run, 0), expected, "{name}");
            assert_eq!(peers.name(run, 1), None, "another body");
        }
    }

    #[test]
    fn people_are_told_who_commands_the_robot_and_what_they_can_do() {
        for (text, expected) in [
            (
                "the Claude commands body 0: it has to be taken over",
                "the program \"Claude\" commands me now, so I cannot do that: ask me again",
            ),
            ("the page commands body 1: it has to be taken over", "somebody at a page commands me now"),
            ("the a: b commands body 12: it has to be taken over", "the program \"a b\" commands me now"),
            ("the fridge is closed: it has to be opened first", "the fridge is closed: it has to be opened first"),
            ("", ""),
        ] {
            let told = for_people(&Text::<502>::new(text));
            assert!(told.as_str().starts_with(expected), "{text}: {told:?}");
            assert!(!told.as_str().contains(" body "), "{told:?}");
        }
    }
}
