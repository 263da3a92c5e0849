//! What to do with words that the grammar does not understand: somebody else, such as a language model, may put them into
//! plain requests. Those are understood, grounded and checked like anybody's.

use std::collections::BTreeSet;

use cohabit_cdf::RoomId;

use crate::{Language, context::Context, describe, known::Known, understanding::Understanding};

/// The most plain requests that are taken for one utterance.
const MOST_REQUESTS: usize = 8;
/// The most characters of one.
const LONGEST_REQUEST: usize = 200;

/// Puts what was not understood into plain requests, such as `pick up the red mug`.
pub trait Interpreter: Send + Sync {
    /// The requests, in their order; none, if nothing is asked for that a robot could do.
    ///
    /// # Errors
    /// Why it cannot say, in a sentence for logs.
    fn interpret(&self, unclear: &Unclear) -> Result<Vec<String>, String>;
}

/// What was not understood, and all that helps to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Unclear {
    /// What was said.
    pub utterance: String,
    /// What was said before, the latest last: whether the robot said it, and what.
    pub before: Vec<(bool, String)>,
    /// What the things are called that the robot knows of, each once.
    pub things: Vec<String>,
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
        Unclear {
            utterance: utterance.to_owned(),
            before,
            things: things.into_iter().collect(),
            rooms: RoomId::ALL.iter().map(|room| room.name().to_owned()).collect(),
            held: scene.robot.held.map(bare),
            room: scene.robot.room.name().to_owned(),
        }
    }

    /// What these plain requests mean, one after the other; nothing, if even they are not understood whole.
    #[must_use]
    pub fn understand_interpreted(
        &self,
        requests: &[String],
        scene: &Known,
        context: &mut Context,
    ) -> Option<Understanding> {
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
