//! What was read lately: most of a prompt is the same as of the one before it, and need not be read again.

use std::sync::{Arc, Mutex, PoisonError};

use crate::{tokens::Token, transformer::Memory};

/// How many prompts are kept, of some 10 MB each.
const KEPT: usize = 3;

/// The last prompts, the latest last.
#[derive(Debug, Default)]
pub(crate) struct ReadBefore {
    prompts: Mutex<Vec<(Vec<Token>, Arc<Memory>)>>,
}

impl ReadBefore {
    /// What a prompt that began alike is remembered by, up to where it differs or to the last token; nothing, where none began alike.
    pub(crate) fn of(&self, read: &[Token]) -> Option<Memory> {
        let shared =
            |kept: &[Token]| kept.iter().zip(&read[..read.len() - 1]).take_while(|(one, other)| one == other).count();
        let (length, memory) = {
            let prompts = self.prompts.lock().unwrap_or_else(PoisonError::into_inner);
            let (length, memory) =
                prompts.iter().map(|(kept, memory)| (shared(kept), memory)).max_by_key(|(length, _)| *length)?;
            (length, memory.clone())
        };
        (length > 0).then(|| memory.beginning(length))
    }

    /// Keeps a prompt instead of the oldest.
    pub(crate) fn keep(&self, read: &[Token], memory: &Arc<Memory>) {
        let mut prompts = self.prompts.lock().unwrap_or_else(PoisonError::into_inner);
        if prompts.len() >= KEPT {
            prompts.remove(0);
        }
        prompts.push((read.to_vec(), memory.clone()));
    }
}
