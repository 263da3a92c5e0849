//! The conversations on the bus: what pages say goes in, what agents and the world tell comes back.
//!
//! One thread owns the conversations ([`Conversations`]) and hears one message of its mailbox after the other, so that language is
//! understood without a lock. What they let happen is delivered in one place ([`Talk::deliver`]). The locks of [`Talk`] are held for
//! no more than a delivery or a look at the newest state: pages and bus never wait for language.

mod audience;
mod conversations;
mod delivery;
mod mailbox;
mod menu;
mod picture;
mod seated;
mod unheard;
mod world;

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use cohabit_bus::Transport;
use cohabit_cdf::{BodyId, Catalog, Layout};
use serde_json::Value;
use tokio::sync::oneshot;

use crate::{
    DialogError,
    conversation::Thought,
    drafts::{Drafted, Drafts},
    driving::Drivers,
    hub::Hub,
    interpreter::{Interpretation, Puzzles},
    journal::{Journal, Place},
    page,
    robots::{Robots, Visitor},
    voice::Voice,
    wizard::Decision,
    world_state::NewestState,
};
use delivery::Delivery;
use mailbox::Message;
use world::pass_over;

pub use conversations::Conversations;
pub use mailbox::{Mailbox, Said, UNREACHABLE, Utterance, mailbox};
pub use world::{Ears, listen, show_state};

/// Where pages, the bus and the conversations meet. Who holds several of its locks takes them in the order in which they stand here.
pub struct Talk {
    /// What the conversations hear.
    mailbox: Mailbox,
    delivery: Mutex<Delivery>,
    /// The world, as pages are shown it.
    state: Mutex<NewestState>,
    hub: Arc<Hub>,
    drivers: Arc<Drivers>,
    catalog: Arc<Catalog>,
    layout: Arc<Layout>,
    /// Who makes something of what is not understood, if anybody.
    interpreter: Option<Puzzles>,
    /// How robots speak, and who is heard.
    voice: Arc<Voice>,
    /// The bodies of the robots.
    robots: Vec<BodyId>,
    /// What pages may say next.
    drafts: Drafts,
}

/// All by which a conversation has to do with pages.
pub struct Pages {
    /// What they share.
    pub hub: Arc<Hub>,
    /// Who drives.
    pub drivers: Arc<Drivers>,
    /// How they are heard, and hear.
    pub voice: Arc<Voice>,
    /// Where they leave what they say.
    pub mailbox: Mailbox,
    /// Where they leave what they may say next.
    pub drafts: Drafts,
    /// The floor plan that they show.
    pub layout: Arc<Layout>,
}

impl Talk {
    /// Of these robots on `bus`, shown to the pages, which know what the journal knows.
    pub fn new(
        bus: &dyn Transport,
        catalog: Arc<Catalog>,
        robots: &Robots,
        interpreter: Option<Puzzles>,
        pages: Pages,
        journal: Journal,
    ) -> Result<Arc<Self>, DialogError> {
        let Pages { hub, drivers, voice, mailbox, drafts, layout } = pages;
        let robots = robots.iter().map(|robot| robot.body).collect();
        hub.restore(&journal.past().lines);
        let delivery = Mutex::new(Delivery::new(bus, journal)?);
        let state = Mutex::new(NewestState::new(bus)?);
        Ok(Arc::new(Self {
            mailbox,
            delivery,
            state,
            hub,
            drivers,
            catalog,
            layout,
            interpreter,
            voice,
            robots,
            drafts,
        }))
    }

    /// The tick of the state that it knows.
    fn newest_tick(&self) -> u64 {
        self.state().tick()
    }

    fn delivery(&self) -> MutexGuard<'_, Delivery> {
        self.delivery.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn state(&self) -> MutexGuard<'_, NewestState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A page of this key is open from now on: the number of its visitor, and what they have answered; `None`, if no
    /// more visitors can be told apart.
    pub fn enter(&self, key: u64) -> Option<(u32, Vec<String>)> {
        let Delivery { journal, present, .. } = &mut *self.delivery();
        let number = journal.visitor(key, |number| present.contains_key(&number))?;
        *present.entry(number).or_default() += 1;
        Some((number, journal.past().answered.get(&number).into_iter().flatten().cloned().collect()))
    }

    /// A page of that visitor is gone.
    pub fn leave(&self, number: u32) {
        let present = &mut self.delivery().present;
        if let Some(pages) = present.get_mut(&number) {
            *pages -= 1;
            if *pages == 0 {
                present.remove(&number);
            }
        }
    }

    /// Somebody at a page has typed this so far, and says it perhaps.
    pub fn note_draft(&self, text: &str, visitor: Visitor) {
        self.drafts.leave(visitor, text);
    }

    /// Understands what pages may say next, until `over`.
    pub fn read_ahead(&self, drafted: Drafted, over: &dyn Fn() -> bool) -> Result<(), DialogError> {
        for draft in drafted.until(over) {
            let thoughts = self.mailbox.ask(|to| Message::Draft(draft.visitor, draft.text, to));
            thoughts.into_iter().flatten().for_each(Thought::think);
        }
        Ok(())
    }

    /// Somebody tells the robots something; what comes of that comes later.
    ///
    /// # Errors
    /// In a sentence for people, if it cannot be taken.
    pub fn hear(&self, utterance: Utterance) -> Result<(), String> {
        if let Said::Text { .. } | Said::Choice { is_answer: false, .. } = utterance.said {
            // What was being said is the answer to something else.
            self.voice.hush();
        }
        self.mailbox.leave(Message::Utterance(utterance))
    }

    /// A page plays the first sound of an answer.
    pub fn note_sounded(&self, turn: u64, nanos: u64) -> Result<(), DialogError> {
        let mut delivery = self.delivery();
        let Some(moments) = delivery.latency.sounded(turn, nanos) else { return Ok(()) };
        self.hub.tell(&page::latency(&moments, None));
        delivery.publish_spoken(&moments)
    }

    /// Somebody at a page pointed at a thing that is called so.
    pub fn note_pointed(&self, name: &str, visitor: Visitor) -> Result<(), DialogError> {
        self.delivery().publish_pointed(name, visitor.number)
    }

    /// An interpreter has answered; `false`, if nobody needs it any more.
    pub fn note_interpretation(&self, interpretation: Interpretation) -> bool {
        self.mailbox.leave_in_time(Message::Interpreted(interpretation))
    }

    /// A wizard decides what is answered: the robot of a body, or else the one that holds something back. What comes of it is answered
    /// later: why it cannot be, if it cannot.
    ///
    /// # Errors
    /// In a sentence for people, if it cannot be taken.
    pub fn decide(
        &self,
        body: Option<BodyId>,
        decision: Decision,
    ) -> Result<oneshot::Receiver<Result<(), String>>, String> {
        let (to, decided) = oneshot::channel();
        self.mailbox.leave(Message::Decision(body, decision, to))?;
        Ok(decided)
    }

    /// What the robots hold back, for a wizard's page.
    pub async fn proposals(&self) -> Vec<Value> {
        let (to, proposals) = oneshot::channel();
        match self.mailbox.leave(Message::Proposals(to)) {
            Ok(()) => proposals.await.unwrap_or_default(),
            Err(_) => Vec::new(),
        }
    }

    /// Notes where the page is served.
    pub fn serve_at(&self, place: Place) {
        self.delivery().journal.serve_at(place);
    }
}
