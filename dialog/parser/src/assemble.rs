//! From the network's letters to requests.

use crate::{
    grammar::Letter,
    request::{Act, Answer, Command, Condition, Relation, Request},
    source::Source,
    symbol::Symbol,
};

/// The requests that a whole output stands for; nothing, where a description has no words.
pub(crate) fn requests(letters: &[Letter], alphabet: &[Symbol], source: &Source<'_>) -> Option<Vec<Request>> {
    let mut reader = Reader { letters, alphabet, source };
    let mut requests: Vec<Request> = Vec::new();
    while let Some(symbol) = reader.symbol() {
        if *symbol == Symbol::Manner {
            requests.last_mut()?.manner = Some(reader.description()?);
        } else {
            requests.push(reader.request(symbol)?);
        }
    }
    (!requests.is_empty()).then_some(requests)
}

struct Reader<'a> {
    letters: &'a [Letter],
    alphabet: &'a [Symbol],
    source: &'a Source<'a>,
}

impl<'a> Reader<'a> {
    /// The next symbol, before the end.
    fn symbol(&mut self) -> Option<&'a Symbol> {
        let (Letter::Symbol(symbol), rest) = self.letters.split_first()? else { return None };
        self.letters = rest;
        Some(&self.alphabet[*symbol]).filter(|symbol| **symbol != Symbol::End)
    }

    fn request(&mut self, first: &'a Symbol) -> Option<Request> {
        let mut request = Request { relation: Relation::New, conditions: Vec::new(), act: Act::None, manner: None };
        let mut symbol = first;
        loop {
            match symbol {
                Symbol::Also => request.relation = Relation::Also,
                Symbol::Instead => request.relation = Relation::Instead,
                Symbol::If => request.conditions.push(Condition::If(self.description()?)),
                Symbol::Unless => request.conditions.push(Condition::Unless(self.description()?)),
                Symbol::When => request.conditions.push(Condition::When(self.description()?)),
                Symbol::Until => request.conditions.push(Condition::Until(self.description()?)),
                Symbol::Otherwise => request.conditions.push(Condition::Otherwise),
                act => {
                    request.act = self.act(act)?;
                    return Some(request);
                }
            }
            symbol = self.symbol()?;
        }
    }

    fn act(&mut self, symbol: &Symbol) -> Option<Act> {
        Some(match symbol {
            Symbol::Refrain => Act::Refrain(self.command()?),
            Symbol::Inquire(inquiry) => Act::Inquire(*inquiry, self.command()?),
            Symbol::Goal => Act::Goal(self.description()?),
            Symbol::Tell => Act::Tell(self.description()?),
            Symbol::Answer(answer) => Act::Answer(answer.clone()),
            Symbol::AnswerWords => Act::Answer(Answer::Words(self.description()?)),
            Symbol::Social(social) => Act::Social(*social),
            Symbol::Nothing => Act::None,
            command => Act::Do(self.command_of(command)?),
        })
    }

    fn command(&mut self) -> Option<Command> {
        let symbol = self.symbol()?;
        self.command_of(symbol)
    }

    fn command_of(&mut self, symbol: &Symbol) -> Option<Command> {
        match symbol {
            Symbol::Unknown => Some(Command::Unknown(self.description()?)),
            Symbol::Do(form) => {
                let arguments = (0..form.places()).map(|_| self.description()).collect::<Option<_>>()?;
                Some(Command::Known { form: *form, arguments })
            }
            _ => None,
        }
    }

    /// A description of one part or several.
    fn description(&mut self) -> Option<String> {
        let mut parts: Vec<&str> = Vec::new();
        loop {
            match self.letters {
                [Letter::Start(first), Letter::End(last), rest @ ..] => {
                    parts.push(self.source.text(*first, *last));
                    self.letters = rest;
                }
                [Letter::Symbol(symbol), rest @ ..] => {
                    let Symbol::Word(word) = &self.alphabet[*symbol] else { return None };
                    parts.push(word);
                    self.letters = rest;
                }
                _ => return None,
            }
            let [Letter::Symbol(symbol), rest @ ..] = self.letters else { break };
            if self.alphabet[*symbol] != Symbol::Continued {
                break;
            }
            self.letters = rest;
        }
        let description = parts.join(" ");
        (!description.trim().is_empty()).then_some(description)
    }
}
