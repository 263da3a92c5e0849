//! What may follow what in the network's output, so that whatever it writes is a list of requests.
//!
//! ```text
//! output      = request+ End
//! request     = (Also | Instead)? condition* (Refrain | Inquire)? act (Manner description)?
//! condition   = Otherwise | (If | Unless | When | Until) description
//! act         = form description* | Answer | Social | …
//! description = part (Continued part)*        part = Word | Start End
//! ```

use crate::symbol::Symbol;

/// One letter of the output: a symbol, or a word of the input where a description begins or ends.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Letter {
    /// By its place in the alphabet.
    Symbol(usize),
    Start(usize),
    End(usize),
}

/// How far a request has been written.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Progress {
    /// Nothing, or the act of the request before.
    Begun { after_act: bool, may_have_manner: bool },
    /// A relation or a condition.
    Condition,
    /// What only a command may follow.
    Prefix,
}

/// What has been written so far, as far as it decides on what may follow.
#[derive(Clone, Copy, Debug)]
pub(crate) struct State {
    progress: Progress,
    /// How many parts of descriptions are to follow.
    needed: usize,
    /// The word where a part began that has no end yet.
    start: Option<usize>,
    /// Whether a part has just ended.
    after_part: bool,
}

impl State {
    pub(crate) const fn new() -> Self {
        Self {
            progress: Progress::Begun { after_act: false, may_have_manner: false },
            needed: 0,
            start: None,
            after_part: false,
        }
    }

    /// Whether a symbol may be next.
    pub(crate) fn allows(&self, symbol: &Symbol) -> bool {
        if self.start.is_some() {
            return false;
        }
        if *symbol == Symbol::Continued {
            return self.after_part;
        }
        if self.needed > 0 {
            return matches!(symbol, Symbol::Word(_));
        }
        let begins = symbol.is_condition() || symbol.is_prefix() || symbol.is_act() || *symbol == Symbol::Otherwise;
        match self.progress {
            Progress::Prefix => symbol.is_command(),
            Progress::Condition => begins,
            Progress::Begun { after_act, may_have_manner } => {
                begins
                    || symbol.is_relation()
                    || after_act && *symbol == Symbol::End
                    || may_have_manner && *symbol == Symbol::Manner
            }
        }
    }

    /// Whether a description may begin with a word next.
    pub(crate) const fn allows_start(&self) -> bool {
        self.start.is_none() && self.needed > 0
    }

    /// The first word that a description may end with next.
    pub(crate) const fn first_end(&self) -> Option<usize> {
        self.start
    }

    /// The state after an allowed letter.
    pub(crate) fn after(mut self, letter: Letter, alphabet: &[Symbol]) -> Self {
        let symbol = match letter {
            Letter::Start(word) => return Self { start: Some(word), ..self },
            Letter::End(_) => {
                return Self { start: None, needed: self.needed.saturating_sub(1), after_part: true, ..self };
            }
            Letter::Symbol(symbol) => &alphabet[symbol],
        };
        self.after_part = matches!(symbol, Symbol::Word(_));
        match symbol {
            Symbol::Word(_) => self.needed = self.needed.saturating_sub(1),
            Symbol::Continued => self.needed += 1,
            _ => {
                self.needed = symbol.places();
                self.progress = if symbol.is_relation() || symbol.is_condition() || *symbol == Symbol::Otherwise {
                    Progress::Condition
                } else if symbol.is_prefix() {
                    Progress::Prefix
                } else {
                    Progress::Begun { after_act: true, may_have_manner: *symbol != Symbol::Manner }
                };
            }
        }
        self
    }
}
