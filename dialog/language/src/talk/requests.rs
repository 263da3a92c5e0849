//! Requests, one after the other: what is asked first is answered first, then what is to be done is done; what follows that waits until then.

use crate::{
    context::{Context, Pending},
    read::clause::Clause,
    say::ask,
    talk::{conversation::Conversation, room_kind, wording::Wording},
    understanding::Understanding,
};

impl Conversation<'_> {
    /// What plain requests mean, with `; ` between them; nothing, where the grammar does not read all words of one of them.
    pub(crate) fn requested(&self, requests: &str, context: &mut Context) -> Option<Understanding> {
        let room = room_kind::beside(self.lexicon, &self.lexicon.normalise(requests).0);
        let said: Vec<Wording<'_>> = requests.split("; ").map(|request| self.wording(request)).collect();
        let named: Vec<Option<String>> = said.iter().map(|request| self.with_room_named(request, room)).collect();
        let requests: Vec<Wording<'_>> = (said.into_iter().zip(&named))
            .map(|(request, named)| named.as_deref().map_or(request, |named| self.wording(named)))
            .collect();
        let reads: Vec<bool> = requests.iter().map(|request| self.reads_all(request)).collect();
        let is_lost = |(request, is_read): (&Wording<'_>, &bool)| !is_read && !is_question(request.utterance);
        // A question that it cannot answer takes nothing from what else was said.
        if !reads.contains(&true) || requests.iter().zip(&reads).any(is_lost) {
            return None;
        }
        let mut then = context.at_new_utterance();
        let understand = |text: &str, context: &mut Context| Some(self.understand_said(text, context));
        let understanding = self.one_after_the_other(self.together(&requests), &mut then, understand)?;
        (!understanding.is_lost()).then(|| {
            *context = then;
            understanding
        })
    }

    /// What texts mean, each where those before it lead to; what `understand` makes nothing of is passed over.
    pub(crate) fn one_after_the_other(
        &self,
        texts: Vec<String>,
        context: &mut Context,
        understand: impl Fn(&str, &mut Context) -> Option<Understanding>,
    ) -> Option<Understanding> {
        let mut said: Vec<String> = Vec::new();
        let mut sought: Vec<Clause> = Vec::new();
        let mut texts = texts.into_iter();
        while let Some(text) = texts.next() {
            let mut then = Context { later: Vec::new(), ..context.clone() };
            let Some(understanding) = understand(&text, &mut then) else { continue };
            let is_last = texts.len() == 0;
            match &understanding {
                // Whether to look for what was only asked about is not worth a question where more is asked for.
                Understanding::Question { text: asked, .. } if !is_last && is_question(&text) => {
                    said.push(without_offer(asked));
                    if let Some(Pending::Search { clauses }) = then.pending {
                        sought.extend(clauses);
                    }
                }
                Understanding::Refusal { is_lost: true, .. }
                    if is_question(&text) && (!is_last || !said.is_empty()) =>
                {
                    said.push(format!("I do not know the answer to \"{text}\"."));
                }
                // What follows waits, too.
                Understanding::Answer { .. } if then.awaits() && then.awaited != context.awaited => {
                    *context = then;
                    context.awaited.last_mut().into_iter().for_each(|awaited| awaited.then.extend(texts.by_ref()));
                    let is_first = said.is_empty();
                    return Some(if is_first { understanding } else { understanding.after(&said.join(" ")) });
                }
                Understanding::Answer { text: reply, .. } | Understanding::Refusal { text: reply, is_lost: false }
                    if !is_last || said.contains(reply) =>
                {
                    if !said.contains(reply) {
                        said.push(reply.clone());
                    }
                    *context = then;
                }
                _ => {
                    // `I have not seen it yet`, of each of two questions.
                    if let Understanding::Question { text: asked, .. } = &understanding {
                        said.retain(|known| *known != without_offer(asked));
                    }
                    *context = then;
                    context.later.extend(texts);
                    context.answered = said.join(" ");
                    let understanding = with_all_sought(understanding, sought, context);
                    let is_first = said.is_empty();
                    return Some(if is_first { understanding } else { understanding.after(&context.answered) });
                }
            }
        }
        (!said.is_empty()).then(|| Understanding::answer(said.join(" ")))
    }

    /// Requests of which those that follow each other are one text; questions, and what is no request by itself (`undo`), stay alone.
    fn together(&self, requests: &[Wording<'_>]) -> Vec<String> {
        let mut texts: Vec<String> = Vec::new();
        let mut may_go_on = false;
        for Wording { utterance: request, tidied: words, .. } in requests {
            let is_deed = !is_question(request) && self.small(words).is_empty() && self.chat(words).is_none();
            match texts.last_mut().filter(|_| may_go_on && is_deed) {
                Some(last) => *last = format!("{last}. {request}"),
                None => texts.push((*request).to_owned()),
            }
            may_go_on = is_deed;
        }
        texts
    }
}

fn is_question(text: &str) -> bool {
    text.ends_with('?')
}

/// The same question, where it offers to look for a thing, of those as well that were asked about before and are to be looked for.
fn with_all_sought(understanding: Understanding, sought: Vec<Clause>, context: &mut Context) -> Understanding {
    let (Understanding::Question { text, .. }, Some(Pending::Search { clauses })) =
        (&understanding, &mut context.pending)
    else {
        return understanding;
    };
    // Each once: `where is the milk, and is there any milk?`
    let names = |clause: &Clause| clause.objects.first().map(|phrase| phrase.namings.clone());
    let others: Vec<Clause> =
        sought.into_iter().filter(|other| clauses.iter().all(|clause| names(clause) != names(other))).collect();
    if others.is_empty() {
        return understanding;
    }
    clauses.splice(0..0, others);
    let offer = format!("{} Shall I look for them?", without_offer(text));
    ask::confirmation(offer)
}

/// `I have not seen a can yet. Shall I look for it?` without the offer.
fn without_offer(text: &str) -> String {
    let end = text.trim_end_matches('?').rfind(". ").map_or(text.len(), |at| at + 1);
    text[..end].to_owned()
}
