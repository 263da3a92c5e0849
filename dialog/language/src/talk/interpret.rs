//! What people say as somebody else understands it, such as a language model: plain requests, which are understood, grounded and checked
//! like anybody's, or something to say.

use std::collections::BTreeSet;

use cohabit_cdf::Property;

use crate::{
    Language,
    context::Context,
    known::{Known, describe},
    setting::named_in_a_word,
    understanding::{Clarification, Understanding},
};

/// The most plain requests that are taken for one utterance.
const MOST_REQUESTS: usize = 8;
/// The most characters of one, and of what is said.
const LONGEST_REQUEST: usize = 200;
const LONGEST_REPLY: usize = 600;
/// The most things whose places and looks are told.
const MOST_FACTS: usize = 120;
/// From which sureness on nobody else is asked what was meant, where that is asked in doubt.
const SURE: f32 = 0.85;

/// Says what people mean, such as a language model.
pub trait Interpreter: Send + Sync {
    /// What is meant.
    ///
    /// # Errors
    /// Why it cannot say, in a sentence for logs.
    fn interpret(&self, unclear: &Unclear) -> Result<Interpreted, String>;
}

/// What an interpreter says.
#[derive(Clone, Debug, Default, Eq, PartialEq)]
pub struct Interpreted {
    /// What is meant; nothing, if that is not known.
    pub meant: Option<Meant>,
    /// How it came to that, for the log of the session.
    pub note: String,
}

/// What somebody else takes an utterance for.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum Meant {
    /// That these plain requests are carried out, such as `pick up the red mug`.
    Do(Vec<String>),
    /// That nothing is to be done, but this to be said.
    Say(String),
    /// That this is to be known first.
    Ask(String),
}

/// When an interpreter is asked, where there is one: a setting of a session.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub enum Consulting {
    /// Never.
    Never,
    /// Where the robot itself is not sure what is meant.
    #[default]
    Unsure,
    /// About all that is no stop.
    Always,
}

named_in_a_word!(Consulting: Never = "never", Unsure = "unsure", Always = "always");

impl Consulting {
    /// Whether somebody else is asked about what was understood so.
    #[must_use]
    pub fn is_asked(self, understanding: &Understanding, context: &Context) -> bool {
        match (self, understanding) {
            (Self::Never, _) | (_, Understanding::Stop { .. }) => false,
            (Self::Unsure, _) => context.sureness() < SURE,
            (Self::Always, _) => true,
        }
    }
}

/// What was said, and all that helps to understand it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Unclear {
    /// What was said.
    pub utterance: String,
    /// What was said before, the latest last: whether the robot said it, and what.
    pub before: Vec<(bool, String)>,
    /// What the things are called that the robot knows of, each once.
    pub things: Vec<String>,
    /// Where things are that can be carried, and how: `dirty white plate on the round table in the break room`.
    pub facts: Vec<String>,
    /// The goals of the mission that are not met yet.
    pub goals: Vec<String>,
    /// What the rooms are called.
    pub rooms: Vec<String>,
    /// What is in its hand.
    pub held: Option<String>,
    /// Where it is.
    pub room: String,
}

impl Language {
    /// All that helps to interpret an utterance in `scene`.
    #[must_use]
    pub fn unclear(&self, utterance: &str, scene: &Known, before: Vec<(bool, String)>) -> Unclear {
        let bare = |id| describe::bare(self.catalog(), scene, id);
        let things: BTreeSet<String> = scene.objects.iter().map(|object| bare(object.id)).collect();
        let is_carried = |class| self.catalog().class(class).has(Property::Pickupable);
        let told = scene.objects.iter().filter(|object| is_carried(object.class) && !object.is_hidden).map(|object| {
            let words = [
                describe::look(self.catalog(), object),
                describe::name(self.catalog(), object.class),
                describe::location(self.catalog(), scene, object.id),
            ];
            words.iter().filter(|words| !words.is_empty()).cloned().collect::<Vec<_>>().join(" ")
        });
        Unclear {
            utterance: utterance.to_owned(),
            before,
            things: things.into_iter().collect(),
            facts: told.take(MOST_FACTS).collect(),
            goals: scene.goals.iter().filter(|goal| !goal.met).map(|goal| goal.text.clone()).collect(),
            rooms: scene.room_names(self.catalog()).map(str::to_owned).collect(),
            held: scene.robot.held.map(bare),
            room: scene.robot.room.name_in(self.catalog()).to_owned(),
        }
    }

    /// What comes of what somebody else takes an utterance for; nothing, if even that is not understood whole.
    #[must_use]
    pub fn understand_meant(&self, meant: &Meant, scene: &Known, context: &mut Context) -> Option<Understanding> {
        let is_said = |text: &String| !text.trim().is_empty() && text.chars().count() <= LONGEST_REPLY;
        match meant {
            Meant::Do(requests) => self.understand_requests(requests, scene, context),
            Meant::Say(text) => is_said(text).then(|| Understanding::answer(text.trim())),
            Meant::Ask(text) => is_said(text).then(|| Understanding::Question {
                kind: Clarification::Request,
                about: String::new(),
                text: text.trim().to_owned(),
                candidates: Vec::new(),
                options: Vec::new(),
            }),
        }
    }

    /// What plain requests mean, with `; ` between them, one after the other; nothing, where the grammar does not read all words of one of them.
    #[must_use]
    pub fn understand_plain(&self, requests: &str, scene: &Known, context: &mut Context) -> Option<Understanding> {
        self.conversation(scene).requested(requests, context)
    }

    /// What these plain requests mean, one after the other.
    fn understand_requests(&self, requests: &[String], scene: &Known, context: &mut Context) -> Option<Understanding> {
        let is_plain = |request: &String| !request.trim().is_empty() && request.chars().count() <= LONGEST_REQUEST;
        if requests.is_empty() || requests.len() > MOST_REQUESTS || !requests.iter().all(is_plain) {
            return None;
        }
        let sentences: Vec<&str> = requests.iter().map(|request| request.trim().trim_end_matches('.')).collect();
        let mut then = context.clone();
        let understanding = self.understand(&sentences.join(". "), scene, &mut then);
        let is_clear = !matches!(understanding, Understanding::Refusal { is_lost: true, .. });
        is_clear.then(|| {
            *context = then;
            understanding
        })
    }
}
