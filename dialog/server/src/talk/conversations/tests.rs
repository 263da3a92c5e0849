//! What goes out: in its order, written down before it is told; what is held back does not, and a stop does.

use std::{
    fs,
    path::{Path, PathBuf},
    sync::Mutex,
};

use cohabit_bus::{
    BusError, Heart, Inbox, Local, Publisher, Sample, Topic,
    message::{BodyRecord, DialogMessage, DialogView, NONE, StateParts},
};
use cohabit_cdf::{Catalog, Layout, RoomId};
use cohabit_language::{Consulting, Knows, Language};
use serde_json::json;
use tokio::sync::broadcast;

use super::*;
use crate::{
    drafts::drafts,
    driving::{Drivable, Drivers},
    hub::Hub,
    journal::Journal,
    page::RobotName,
    robots::BodyNames,
    talk::{Pages, Said, Utterance, mailbox},
    voice::{Voice, VoiceConfig},
    wizard::Holding,
};

const SAID: &str = "go to the main office";
const HOUR: Duration = Duration::from_secs(3600);

/// A robot in an empty break room, with whoever hears of it.
struct Stage {
    bus: Arc<dyn Transport>,
    conversations: Conversations,
    thoughts: Thoughts,
    dialog: Inbox,
    pages: broadcast::Receiver<Arc<str>>,
    journal: PathBuf,
    _state: Box<dyn Publisher>,
    _mail: Mail,
}

impl Drop for Stage {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.journal);
    }
}

fn language() -> Language {
    Language::new(Arc::new(Catalog::builtin()))
}

fn held(delay: Duration) -> Holding {
    Holding { delay, wizard: None }
}

impl Stage {
    /// One whose journal has that name.
    fn new(name: &str, language: &Language, holding: &Holding) -> Self {
        let bus: Arc<dyn Transport> = Arc::new(Local::new(1));
        let catalog = Arc::clone(language.catalog());
        let layout = Arc::new(Layout::builtin("OfficeLayout1").unwrap());
        let room = RoomId::BUILTIN.iter().position(|room| *room == RoomId::BREAK_ROOM).unwrap() as u32;
        let body = BodyRecord { room, held: NONE, position_m: [4.0, 10.0, 0.0], ..BodyRecord::default() };
        let names = [RobotName { body: BodyId(0), name: "robot".to_owned() }];
        let (knows, told) = (Knows::Everything, BodyNames::default());
        let robots = Robots::new(&names, knows, language, &catalog, &layout, told, Consulting::Never).holding(holding);
        let hub = Arc::new(Hub::new(json!({}), Vec::new(), Box::new(|| ())));
        let pages = hub.attend().1;
        let drivers = Arc::new(Drivers::new(Arc::clone(&bus), Drivable::None, &[body], &["robot".to_owned()]));
        let config = VoiceConfig::new(Err("there are no engines".to_owned()));
        let voice = Voice::new(Arc::clone(&bus), config, |_| (), |_| ());
        let (mailbox, mail) = mailbox();
        let ends = Pages { hub, drivers, voice, mailbox, drafts: drafts().0, layout };
        let journal = std::env::temp_dir().join(format!("cohabit-outbox-{name}-{}", std::process::id()));
        let _ = fs::remove_file(&journal);
        let talk = Talk::new(&*bus, catalog, &robots, None, ends, Journal::open(Some(&journal))).unwrap();
        let (mut conversations, thoughts) = Conversations::begin(&*bus, talk, robots).unwrap();
        let mut state = bus.publisher(Topic::State).unwrap();
        let parts = StateParts { bodies: vec![body], ..StateParts::default() };
        state.send(1, parts.bytes(), &mut |bytes| parts.write(bytes)).unwrap();
        conversations.wait_until_they_see(&*bus, &|| false).unwrap();
        let dialog = Inbox::new(&*bus, Topic::Dialog).unwrap();
        Self { bus, conversations, thoughts, dialog, pages, journal, _state: state, _mail: mail }
    }

    /// Somebody at page 1 says something that was received then.
    fn say(&mut self, text: &str, received_nanos: u64) {
        let said = Said::Text { text: text.to_owned(), received_nanos };
        let visitor = Visitor { number: 1, body: None };
        self.conversations.take(Message::Utterance(Utterance { visitor, said, page: None })).unwrap();
    }

    /// What the bus was told since: its kinds, and what was said.
    fn told(&mut self) -> Vec<(DialogKind, String)> {
        let read = |sample: &Sample| {
            DialogView::new(sample.payload())
                .map(|view| (view.header.kind().unwrap(), view.header.text.as_str().to_owned()))
        };
        std::iter::from_fn(|| Some(self.dialog.next(read).unwrap()?.1)).collect()
    }

    fn kinds(&mut self) -> Vec<DialogKind> {
        self.told().into_iter().map(|(kind, _)| kind).collect()
    }

    /// What the pages were told since.
    fn pages(&mut self) -> Vec<Value> {
        std::iter::from_fn(|| self.pages.try_recv().ok()).map(|text| serde_json::from_str(&text).unwrap()).collect()
    }

    /// The turns that ended so, as the pages were told.
    fn ended(&mut self, status: &str) -> Vec<Value> {
        let is_it = |message: &Value| message["type"] == "turn" && message["status"] == status;
        self.pages().into_iter().filter(is_it).map(|message| message["turn"].clone()).collect()
    }

    fn newest_entry(&self) -> String {
        newest_entry(&self.journal)
    }
}

fn newest_entry(journal: &Path) -> String {
    fs::read_to_string(journal).unwrap().lines().last().unwrap_or_default().to_owned()
}

/// Sends, and takes down what the journal ends with by then.
struct Watching {
    to: Box<dyn Publisher>,
    journal: PathBuf,
    entries: Arc<Mutex<Vec<String>>>,
}

impl Publisher for Watching {
    fn send(&mut self, tick: u64, bytes: usize, write: &mut dyn FnMut(&mut [u8])) -> Result<u64, BusError> {
        self.entries.lock().unwrap().push(newest_entry(&self.journal));
        self.to.send(tick, bytes, write)
    }

    fn run(&self) -> u64 {
        self.to.run()
    }

    fn subscribers(&self) -> usize {
        self.to.subscribers()
    }

    fn update(&mut self) -> Result<(), BusError> {
        self.to.update()
    }
}

#[test]
fn what_follows_is_told_in_order_and_nothing_before_it_is_written_down() {
    let mut stage = Stage::new("order", &language(), &Holding::default());
    let entries = Arc::new(Mutex::new(Vec::new()));
    let to = stage.bus.publisher(Topic::Dialog).unwrap();
    let watching = Watching { to, journal: stage.journal.clone(), entries: Arc::clone(&entries) };
    stage.conversations.talk.delivery().dialog = Box::new(watching);
    stage.say(SAID, 0);
    assert_eq!(stage.kinds(), [DialogKind::Utterance, DialogKind::Reply, DialogKind::Plan]);
    let pages = stage.pages();
    let from: Vec<_> = pages.iter().map(|message| (&message["type"], &message["from"])).collect();
    assert_eq!(from, [(&json!("chat"), &json!("person")), (&json!("chat"), &json!("robot"))]);
    let entries = entries.lock().unwrap();
    assert_eq!(entries.len(), 3);
    for entry in entries.iter() {
        assert!(entry.starts_with("{\"deed\":") && entry.contains(SAID) && entry.contains("going to"), "{entry}");
    }
    assert_eq!(stage.newest_entry(), "\"told\"");
}

#[test]
fn what_a_client_says_is_shown_with_its_name_and_what_the_own_mind_says_without() {
    let mut stage = Stage::new("names", &language(), &Holding::default());
    let run = stage.bus.publisher(Topic::Dialog).unwrap().run();
    let message = DialogMessage::new(DialogKind::Reply, 0, 0, "Here I am.");
    for (sequence, peer, name) in [(1, "Claude", json!("Claude")), (2, "agent", Value::Null)] {
        Heart::new(&*stage.bus, peer, 0).unwrap().beat(1, 0).unwrap();
        let envelope = Envelope { run, sequence, ..Envelope::default() };
        stage.conversations.take(Message::FromAgent(envelope, Box::new(message.header))).unwrap();
        let shown = stage.pages();
        assert_eq!(shown.len(), 1, "{shown:?}");
        assert_eq!((&shown[0]["text"], &shown[0]["name"]), (&json!("Here I am."), &name));
        assert_eq!(shown[0]["body"], Value::Null, "there is one robot");
    }
}

#[test]
fn what_is_held_back_goes_out_when_its_time_has_come() {
    let mut stage = Stage::new("held", &language(), &held(Duration::from_millis(1)));
    stage.say(SAID, 0);
    assert_eq!(stage.kinds(), [DialogKind::Utterance]);
    assert_eq!(stage.conversations.pause(), Duration::ZERO);
    stage.conversations.elapse().unwrap();
    assert_eq!(stage.kinds(), [DialogKind::Reply, DialogKind::Plan]);
    stage.conversations.elapse().unwrap();
    assert!(stage.told().is_empty());
}

#[test]
fn a_stop_passes_what_is_held_back_and_ends_it() {
    let mut stage = Stage::new("stop", &language(), &held(HOUR));
    stage.say(SAID, monotonic_nanos());
    assert_eq!(stage.kinds(), [DialogKind::Utterance]);
    stage.say("stop", monotonic_nanos());
    assert_eq!(stage.kinds(), [DialogKind::Utterance, DialogKind::Reply, DialogKind::Plan]);
    assert_eq!(stage.ended("interrupted"), [json!(1)]);
    assert_eq!(stage.conversations.due(monotonic_nanos()), None);
}

#[test]
fn what_is_said_is_heard_in_order_but_a_stop_at_once() {
    let language = language().with_rewriter(|_, _, _| Vec::new());
    let mut stage = Stage::new("unheard", &language, &Holding::default());
    let utterance = |text: &str| (DialogKind::Utterance, text.to_owned());
    stage.say(SAID, 0);
    stage.say("where are you?", 0);
    assert!(stage.told().is_empty(), "the language model thinks of the first");
    let (number, thoughts) = stage.thoughts.0.try_recv().unwrap();
    assert_eq!(thoughts.len(), 1);
    stage.conversations.take(Message::Considered(number)).unwrap();
    assert_eq!(stage.told()[0], utterance(SAID));
    let (number, _) = stage.thoughts.0.try_recv().unwrap();
    stage.say("go to the reception", 0);
    stage.pages();
    stage.say("stop", 0);
    let told = stage.told();
    assert_eq!(told[..3], ["where are you?", "go to the reception", "stop"].map(utterance));
    assert_eq!(told[3..].iter().map(|(kind, _)| *kind).collect::<Vec<_>>(), [DialogKind::Reply, DialogKind::Plan]);
    assert_eq!(stage.ended("interrupted"), [json!(2), json!(3)]);
    stage.conversations.take(Message::Considered(number)).unwrap();
    assert!(stage.told().is_empty(), "it is over");
}
