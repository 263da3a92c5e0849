//! The robots that people speak to: each with a conversation and a knowledge of its own, and whom of them is meant.

use std::{collections::BTreeMap, sync::Arc, time::Duration};

use cohabit_bus::{
    Text,
    message::{BodyRecord, StateView},
};
use cohabit_cdf::{BodyId, Catalog, Layout, ObjectId};
use cohabit_language::{Addressed, Consulting, Knows, Language, Lessons, Roster, find_stop};

use crate::{
    conversation::{Conversation, Manner, Memory, Thought},
    known::Knowledge,
    page::RobotName,
    wizard::Holding,
};

/// Who spoke to a robot so lately still speaks to it, wherever it went.
const SAME_TALK: Duration = Duration::from_secs(45);
/// A robot is near who speaks if it is not further off, m.
const NEAR_M: f32 = 6.0;

/// One of them.
pub struct Robot {
    pub body: BodyId,
    pub conversation: Conversation,
    pub knowledge: Knowledge,
}

/// Who speaks.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct Visitor {
    /// The number of their page; 0 is nobody's.
    pub number: u32,
    /// The body that they drive, if any.
    pub body: Option<BodyId>,
}

/// All of them.
pub struct Robots {
    robots: Vec<Robot>,
    roster: Roster,
    called: Vec<String>,
    /// How the world calls those that were given names.
    pub names: BodyNames,
    /// Who of the visitors spoke to which last, and when, ns.
    spoken: BTreeMap<u32, (usize, u64)>,
    /// Which asked last.
    asked_last: usize,
}

/// What the world calls the bodies that were given names, and these.
#[derive(Default)]
pub struct BodyNames(Vec<(String, String)>);

impl BodyNames {
    /// The world counts bodies of a kind from 1, where there are several.
    pub fn new(bodies: &[BodyRecord], names: &BTreeMap<u32, String>) -> Self {
        const TOLD: &str = "is in my way";
        let called = |at: usize| {
            let kind = bodies[at].kind()?.name();
            let count = |bodies: &[BodyRecord]| bodies.iter().filter(|body| body.kind == bodies[at].kind).count();
            let own = match count(bodies) {
                1 => format!("the {kind} {TOLD}"),
                _ => format!("{kind} {} {TOLD}", count(&bodies[..=at])),
            };
            Some((own, format!("{} {TOLD}", names.get(&bodies[at].body)?)))
        };
        Self((0..bodies.len()).filter_map(called).collect())
    }

    /// What the world tells of them, by their names: `Rosie is in my way`.
    pub fn told<const N: usize>(&self, text: &Text<N>) -> Text<N> {
        let told = self.0.iter().fold(text.as_str().to_owned(), |told, (kind, name)| told.replace(kind, name));
        Text::new(&told)
    }
}

/// Those of `bodies` that there are, with their names.
pub fn named(bodies: &[u32], names: &[String]) -> Vec<RobotName> {
    let named = |body: &u32| Some(RobotName { body: BodyId(*body), name: names.get(*body as usize)?.clone() });
    bodies.iter().filter_map(named).collect()
}

impl Robots {
    /// Robots of these names that have seen nothing yet.
    pub fn new(
        names: &[RobotName],
        knows: Knows,
        language: &Language,
        catalog: &Arc<Catalog>,
        layout: &Layout,
        told: BodyNames,
        consulting: Consulting,
    ) -> Self {
        let conversation = |body| Conversation::new(language.clone(), body).consulting(consulting);
        let robot = |RobotName { body, .. }: &RobotName| Robot {
            body: *body,
            conversation: conversation(body.0),
            knowledge: Knowledge::new(knows, Arc::clone(catalog), layout, *body),
        };
        Self {
            robots: names.iter().map(robot).collect(),
            roster: Roster::new(names.iter().map(|one| one.name.as_str())),
            called: names.iter().map(|one| one.name.clone()).collect(),
            names: told,
            spoken: BTreeMap::new(),
            asked_last: 0,
        }
    }

    /// The same, with their answers held back so.
    pub fn holding(mut self, holding: &Holding) -> Self {
        let held = |robot: Robot| Robot { conversation: robot.conversation.holding(holding.clone()), ..robot };
        self.robots = self.robots.into_iter().map(held).collect();
        self
    }

    /// The same, with what they say worded so.
    pub fn speaking(mut self, manner: Manner) -> Self {
        let worded = |robot: Robot| Robot { conversation: robot.conversation.speaking(manner), ..robot };
        self.robots = self.robots.into_iter().map(worded).collect();
        self
    }

    /// The same; those of these bodies act on their own, whatever they are told.
    pub fn on_their_own(mut self, bodies: &[u32]) -> Self {
        let minded = |robot: Robot| {
            let is_alone = bodies.contains(&robot.body.0);
            Robot { conversation: robot.conversation.alone(is_alone), ..robot }
        };
        self.robots = self.robots.into_iter().map(minded).collect();
        self
    }

    /// The same, told what people are asked to get done.
    pub fn with_mission(mut self, mission: &str) -> Self {
        for robot in &mut self.robots {
            robot.knowledge.be_told_mission(mission);
        }
        self
    }

    /// Goes on with these conversations, and knows this again, each of one body.
    pub fn restore(&mut self, conversations: &BTreeMap<u32, Memory>, lessons: &BTreeMap<u32, Lessons>) {
        for robot in &mut self.robots {
            if let Some(memory) = conversations.get(&robot.body.0) {
                robot.conversation.restore(memory.clone());
            }
            if let Some(lessons) = lessons.get(&robot.body.0) {
                robot.knowledge.study(lessons);
            }
        }
    }

    pub fn iter(&self) -> impl Iterator<Item = &Robot> {
        self.robots.iter()
    }

    pub fn iter_mut(&mut self) -> impl Iterator<Item = &mut Robot> {
        self.robots.iter_mut()
    }

    /// The robot of a body, to hear something next: turns are numbered in the order of all conversations.
    pub fn of_body(&mut self, body: BodyId) -> Option<&mut Robot> {
        let newest = self.robots.iter().map(|robot| robot.conversation.turns()).max().unwrap_or(0);
        let robot = self.robots.iter_mut().find(|robot| robot.body == body)?;
        robot.conversation.count_from(newest);
        Some(robot)
    }

    /// The robot that waits for an answer, the last that asked first.
    pub fn asking(&self) -> Option<&Robot> {
        let asks = |robot: &&Robot| robot.conversation.asked().is_some();
        self.robots.get(self.asked_last).filter(asks).or_else(|| self.robots.iter().find(asks))
    }

    /// The robot to which pointing at an object is an answer.
    pub fn answered_by(&self, object: ObjectId) -> Option<BodyId> {
        let is_answered = |robot: &&Robot| robot.conversation.asked().is_some_and(|asked| asked.is_answered_by(object));
        self.asking().filter(is_answered).or_else(|| self.robots.iter().find(is_answered)).map(|robot| robot.body)
    }

    /// What is asked of which the answers are numbered: these objects, in the order of their numbers.
    pub fn numbered(&self) -> &[ObjectId] {
        let asked = self.asking().and_then(|robot| robot.conversation.asked());
        asked.map(|asked| asked.candidates.as_slice()).filter(|all| all.len() > 1).unwrap_or_default()
    }

    /// Notes that one has spoken.
    pub fn note_speech(&mut self, body: BodyId) {
        let at = self.robots.iter().position(|robot| robot.body == body);
        if let Some(at) = at.filter(|at| self.robots[*at].conversation.asked().is_some()) {
            self.asked_last = at;
        }
    }

    /// What people call them, if there are several.
    pub fn called_by(&self) -> &[String] {
        if self.robots.len() > 1 { &self.called } else { &[] }
    }

    /// What is said to whom is called by name.
    pub fn called(&self, text: &str) -> String {
        self.roster.addressed(text).text
    }

    /// The robot of a body, to look at.
    pub fn look_at(&self, body: BodyId) -> Option<&Robot> {
        self.robots.iter().find(|robot| robot.body == body)
    }

    /// Whom a visitor speaks to, by name, or else by what came before and by who is near, and what is said to them. Who
    /// calls nobody and says no more than `stop`, in whatever words, says it to all.
    pub fn addressed(
        &mut self,
        text: &str,
        visitor: Visitor,
        state: Option<StateView<'_>>,
        nanos: u64,
    ) -> (Vec<BodyId>, String) {
        let (robots, text) = self.would_be_addressed(text, visitor, state, nanos);
        let bodies = robots.iter().map(|at| self.robots[*at].body).collect();
        if let [one] = robots[..] {
            self.spoken.insert(visitor.number, (one, nanos));
        }
        (bodies, text)
    }

    /// Whom a visitor would speak to now.
    pub fn would_hear(&self, text: &str, visitor: Visitor, state: Option<StateView<'_>>, nanos: u64) -> Vec<BodyId> {
        let (robots, _) = self.would_be_addressed(text, visitor, state, nanos);
        robots.into_iter().map(|at| self.robots[at].body).collect()
    }

    /// An utterance as those to whom a visitor would say it would understand it now.
    pub fn thoughts(&self, text: &str, visitor: Visitor, state: Option<StateView<'_>>, nanos: u64) -> Vec<Thought> {
        let (robots, text) = self.would_be_addressed(text, visitor, state, nanos);
        let robots = robots.into_iter().map(|at| &self.robots[at]);
        robots.filter_map(|robot| robot.conversation.thought(&text, &robot.knowledge)).collect()
    }

    fn would_be_addressed(
        &self,
        text: &str,
        visitor: Visitor,
        state: Option<StateView<'_>>,
        nanos: u64,
    ) -> (Vec<usize>, String) {
        let Addressed { robots, text } = self.roster.addressed(text);
        let mut meant = match robots.as_slice() {
            [] if is_stop(&text) => (0..self.robots.len()).collect(),
            [] => vec![self.unnamed(visitor, state, nanos)],
            _ => robots,
        };
        meant.retain(|at| *at < self.robots.len());
        (meant, text)
    }

    /// Whom somebody speaks to who calls no name: who asked; who was spoken to just now; who is near; who was spoken to
    /// before.
    fn unnamed(&self, visitor: Visitor, state: Option<StateView<'_>>, nanos: u64) -> usize {
        let before = self.spoken.get(&visitor.number);
        let is_fresh = |spoken: &&(usize, u64)| nanos.saturating_sub(spoken.1) < SAME_TALK.as_nanos() as u64;
        let asking = self.asking().and_then(|asking| self.robots.iter().position(|robot| robot.body == asking.body));
        asking
            .or_else(|| before.filter(is_fresh).map(|spoken| spoken.0))
            .or_else(|| self.nearest(visitor.body?, state?))
            .or_else(|| before.map(|spoken| spoken.0))
            .unwrap_or(0)
    }

    /// The robot nearest to a body, in its room.
    fn nearest(&self, person: BodyId, state: StateView<'_>) -> Option<usize> {
        let record = |body: BodyId| state.bodies.iter().find(|record: &&BodyRecord| record.body == body.0);
        let person = record(person)?;
        let [x, y, _] = person.position_m;
        let away_m = |robot: &Robot| {
            let robot = record(robot.body).filter(|robot| robot.room == person.room)?;
            Some((robot.position_m[0] - x).hypot(robot.position_m[1] - y)).filter(|away| *away < NEAR_M)
        };
        let near = self.robots.iter().enumerate().filter_map(|(at, robot)| Some((at, away_m(robot)?)));
        near.min_by(|one, other| one.1.total_cmp(&other.1)).map(|(at, _)| at)
    }
}

/// Whether somebody says stop, and asks for nothing after it: `stop it now`. All that was said before is taken back by it.
fn is_stop(text: &str) -> bool {
    find_stop(text).is_some_and(|stop| stop.is_plain && stop.rest.is_empty()) || is_stop_word_by_word(text)
}

fn is_stop_word_by_word(text: &str) -> bool {
    let words = text.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    let mut stops = false;
    for word in words.map(str::to_lowercase) {
        match word.as_str() {
            "stop" | "halt" | "freeze" => stops = true,
            "please" | "now" | "right" | "there" | "moving" => {}
            _ => return false,
        }
    }
    stops
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_says_stop_in_whatever_words_says_it_to_all() {
        for text in ["stop", "Stop! Stop!", "stop it", "stop it now!", "please stop everything", "halt", "freeze"] {
            assert!(is_stop(text), "{text}");
        }
        for text in ["STOP what you're doing", "freeze now", "halt right there please"] {
            assert!(is_stop(text), "{text}");
        }
        for text in ["stop, and go to the lab", "stop by the kitchen", "stop the laser", "don't stop", ""] {
            assert!(!is_stop(text), "{text}");
        }
    }
}
