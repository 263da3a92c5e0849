//! The robot of a recorded session, as it was: it hears again what was heard, and knows what it saw.

use std::{collections::BTreeMap, str::FromStr, sync::Arc};

use cohabit_agent::{Agent as _, Deed, Heard, PlanFollower};
use cohabit_bus::message::{DialogKind, DialogMessage, PlanStep};
use cohabit_cdf::{Action, ObjectId, Status};
use cohabit_dialog::{Conversation, Insight, Knowledge, Language, Outgoing};
use cohabit_engine::Replayer;
use cohabit_language::{Alternative, Roster, Understanding};
use cohabit_record::{DialogEntry, EventEntry, Log};
use cohabit_world::{Input, World};

use super::{Reading, Referent, Understood};
use crate::lock_step::{BODY, with_state};

/// The mind of that body which does what the dialog plans, as logs note it.
const FOLLOWER: &str = "dialog@0";

/// A session's robot, as far as its log was followed.
pub(super) struct Retold<'a> {
    log: &'a Log,
    /// Whether it tells how it understands.
    explains: bool,
    /// Its name, if it is called by one.
    name: Option<Roster>,
    /// Whether its mind does what the dialog plans: then it can go on by itself.
    pub follows: bool,
    pub conversation: Conversation,
    pub knowledge: Knowledge,
    pub agent: PlanFollower,
    /// What its mind has decided that the log did not tell yet.
    pub deeds: Vec<Deed>,
    /// Its newest command.
    pub newest: u64,
    /// The tick that it began at.
    began: u64,
    /// How far the log's dialog and events were followed.
    dialog: usize,
    events: usize,
    understood: BTreeMap<u64, Understood>,
}

impl<'a> Retold<'a> {
    /// The robot as the session began.
    pub fn new(replayer: &Replayer<'a>, language: &Language) -> Self {
        let (log, layout) = (replayer.log(), replayer.world().layout());
        let (knows, catalog) = (setting(log, "knows"), Arc::clone(language.catalog()));
        let knowledge = Knowledge::new(knows, catalog, layout, BODY).with_mission(&replayer.plan().mission.goal_text);
        let conversation = Conversation::new(language.clone().asking(setting(log, "ask")), BODY.0);
        let name = log.session.settings.get("name.0").map(|name| Roster::new([name.as_str()]));
        let agents = log.session.settings.get("agents");
        let follows = agents.is_none_or(|agents| agents.split(' ').any(|agent| agent == FOLLOWER));
        Self {
            log,
            explains: false,
            name,
            follows,
            conversation,
            knowledge,
            agent: PlanFollower::new(BODY.0),
            deeds: Vec::new(),
            newest: 0,
            began: replayer.world().tick(),
            dialog: 0,
            events: 0,
            understood: BTreeMap::new(),
        }
    }

    /// The same, telling how it understands what is said.
    pub fn explaining(self) -> Self {
        Self { explains: true, ..self }
    }

    /// How it understood what was said in a turn to a body, once.
    pub fn take_understood(&mut self, turn: u64, body: u32) -> Option<Understood> {
        if body == BODY.0 { self.understood.remove(&turn) } else { None }
    }

    /// What is said to it without its name.
    pub fn without_name(&self, said: &str) -> String {
        self.name.as_ref().map_or_else(|| said.to_owned(), |roster| roster.addressed(said).text)
    }

    /// Takes in the commands of the tick that just passed.
    pub fn note(&mut self, inputs: &[Input]) {
        for input in inputs.iter().filter(|input| input.body == BODY) {
            self.newest = input.command;
            self.has_come(|deed| matches!(deed, Deed::Act { action, .. } if *action == input.action));
        }
    }

    /// Follows what the log has up to the world's tick, and of its dialog no more than so many entries.
    pub fn follow(&mut self, world: &World, dialog: usize) {
        let (log, tick) = (self.log, world.tick());
        if tick > self.began {
            self.glance(world);
        }
        while let Some(event) = log.events.get(self.events).filter(|event| event.tick <= tick) {
            self.events += 1;
            self.end_command(event);
        }
        while let Some(entry) = log.dialog[..dialog].get(self.dialog).filter(|entry| entry.tick <= tick) {
            self.dialog += 1;
            if entry.body == BODY.0 {
                self.hear(entry, world);
            }
        }
    }

    fn hear(&mut self, entry: &DialogEntry, world: &World) {
        match entry.kind.as_str() {
            "Utterance" => self.hear_utterance(entry, world),
            "Plan" if self.follows => {
                let step = |action: &Action| PlanStep { action: (*action).into(), ..PlanStep::default() };
                let steps: Vec<PlanStep> = entry.steps.iter().map(step).collect();
                self.agent.hear(&Heard::Plan { turn: entry.turn, steps: &steps }, &mut self.deeds);
            }
            "StepStarted" => self.follow_plan(DialogKind::StepStarted, entry, world),
            "StepEnded" => self.follow_plan(DialogKind::StepEnded, entry, world),
            "PlanEnded" => self.follow_plan(DialogKind::PlanEnded, entry, world),
            _ => {}
        }
    }

    fn hear_utterance(&mut self, entry: &DialogEntry, world: &World) {
        self.look(world);
        let text = self.without_name(&entry.text);
        let insight = if self.explains { self.conversation.insight(&text, &self.knowledge) } else { None };
        self.conversation.count_from(entry.turn.saturating_sub(1));
        let (_, outbox) = self.conversation.hear_called(&entry.text, &text, 0, &self.knowledge);
        let Some(insight) = insight else { return };
        let planned = outbox.iter().find_map(|item| match item {
            Outgoing::Plan { steps, .. } => Some(steps.iter().map(|step| step.action).collect::<Vec<_>>()),
            _ => None,
        });
        let is_plan =
            |other: &&DialogEntry| other.kind == "Plan" && other.turn == entry.turn && other.body == entry.body;
        let recorded = self.log.dialog[self.dialog..].iter().find(is_plan).map(|plan| plan.steps.clone());
        self.understood.insert(entry.turn, understood(insight, planned == recorded));
    }

    /// Follows what was told about a plan.
    fn follow_plan(&mut self, kind: DialogKind, entry: &DialogEntry, world: &World) {
        self.has_come(|deed| {
            let Deed::Tell(message) = deed else { return false };
            let header = &message.header;
            header.kind() == Some(kind) && header.turn == entry.turn && header.step == entry.step
        });
        if kind != DialogKind::StepStarted {
            self.look(world);
        }
        let status = entry.status.unwrap_or(Status::ActionSuccessful);
        let message = DialogMessage::new(kind, entry.body, entry.turn, &entry.text).at_step(entry.step, status);
        if let Some(action) = self.conversation.deed(&message.header) {
            self.knowledge.note_deed(&action);
        }
        drop(self.conversation.follow(&message.header, &mut self.knowledge));
    }

    fn end_command(&mut self, event: &EventEntry) {
        let is_own = event.kind == "Outcome" && event.body == Some(BODY.0) && event.command == Some(self.newest);
        if let (true, Some(_), Some(status)) = (is_own && self.follows, event.turn, event.status) {
            self.agent.hear(&Heard::Outcome { status, detail: &event.text }, &mut self.deeds);
        }
    }

    /// The log tells what its mind decided: this, and what was decided before it.
    fn has_come(&mut self, is_it: impl Fn(&Deed) -> bool) {
        if let Some(at) = self.deeds.iter().position(is_it) {
            self.deeds.drain(..=at);
        }
    }

    /// Looks around, if it is time to.
    fn glance(&mut self, world: &World) {
        let body = world.body(BODY).map(|body| (body.position_m.to_array(), body.yaw_rad));
        if body.is_some_and(|(position_m, yaw_rad)| self.knowledge.is_due(world.tick(), position_m, yaw_rad)) {
            self.look(world);
        }
    }

    fn look(&mut self, world: &World) {
        with_state(world, |state| self.knowledge.look(state, world.tick()));
    }
}

/// A setting that a log notes; the usual one, where it notes none.
fn setting<T: Default + FromStr>(log: &Log, name: &str) -> T {
    log.session.settings.get(name).and_then(|text| text.parse().ok()).unwrap_or_default()
}

fn understood(insight: Insight, as_recorded: bool) -> Understood {
    let Insight { understanding, sureness, alternatives, referents } = insight;
    let reading = |one: Alternative| Reading {
        text: one.text,
        by: if one.by_grammar { "grammar" } else { "rewriter" },
        meaning: in_words(&one.understanding),
        probability: one.probability,
    };
    let referent = |(object, name, probability): (ObjectId, String, f32)| {
        let object = object.0;
        Referent { object, name, probability }
    };
    Understood {
        meaning: in_words(&understanding),
        sureness,
        readings: alternatives.into_iter().map(reading).collect(),
        referents: referents.into_iter().map(referent).collect(),
        as_recorded,
    }
}

/// What an utterance means, in words.
fn in_words(understanding: &Understanding) -> String {
    match understanding {
        Understanding::Plan { steps, .. } => {
            let says: Vec<&str> = steps.iter().map(|step| step.says.as_str()).filter(|says| !says.is_empty()).collect();
            if says.is_empty() { "nothing to do".to_owned() } else { says.join(", ") }
        }
        Understanding::Question { text, .. } => format!("asks: {text}"),
        Understanding::Answer { text, .. } => format!("answers: {text}"),
        Understanding::Refusal { text, .. } => format!("refuses: {text}"),
        Understanding::Stop { then: Some(then), .. } => format!("stops, then {}", in_words(then)),
        Understanding::Stop { then: None, .. } => "stops".to_owned(),
    }
}
