//! What somebody thinks of where a thing is, beside what they ask for: where to look first, and which one is rather meant.

use crate::{
    context::{Context, Pending, search::Consent},
    ground::want::Want,
    read::{
        clause::{Clause, Part},
        hint::{self, Hint},
        parts,
        phrase::Phrase,
        slot,
    },
    talk::{conversation::Conversation, search::classes_of},
    understanding::Understanding,
    words::{intent::Intent, token::MAX_CHARS},
};

impl Conversation<'_> {
    /// What is asked for, without the hint beside it, and the hint.
    pub(crate) fn without_hint(&self, utterance: &str) -> Option<(String, Hint)> {
        if utterance.chars().nth(MAX_CHARS).is_some() {
            return None;
        }
        let (rest, hint) = hint::parted(self.lexicon, utterance)?;
        let is_wish = hint.is_owed && !rest.is_empty() && self.leaves_open_where(&rest);
        (!is_wish).then_some((rest, hint))
    }

    /// Whether it asks to put something and does not say where, or is no request that the grammar knows: `bring it back, it should be on the
    /// shelf` says where it is to be.
    fn leaves_open_where(&self, rest: &str) -> bool {
        let tidied = self.wording(rest).tidied;
        let parts = parts::parts(self.lexicon, self.catalog, &tidied);
        let mut clauses = parts.iter().filter_map(|part| match part {
            Part::Clause(clause) => Some(clause),
            _ => None,
        });
        let is_open = |clause: &Clause| {
            clause.places.is_empty()
                && (matches!(clause.intent, Intent::Place | Intent::Drop) || clause.manner.is_some())
        };
        let asks =
            rest.trim_end().ends_with('?') || clauses.clone().next().is_some() || !self.small(&tidied).is_empty();
        !asks || clauses.any(is_open)
    }

    /// A hint and no more: it goes on with what it looks for, or asked about; nothing, where it does neither.
    pub(crate) fn hinted(&self, hint: Hint, context: &mut Context) -> Option<Understanding> {
        let is_looking = context.search.as_ref().is_some_and(|search| search.is_under_way());
        context.hint = Some(hint);
        let understanding = match context.pending.clone() {
            Some(Pending::Search { clauses }) => Some(self.plan(clauses, Consent::default(), context)),
            Some(Pending::Where { clauses, slot, consent }) => Some(self.look_for(clauses, slot, consent, context)),
            None if is_looking => context.search.take().map(|search| self.proceed(search, context).after("All right.")),
            _ => None,
        };
        context.hint = None;
        understanding
    }

    /// What was thought of where a thing is belongs to the first that was named so and is not the only one.
    pub(crate) fn heed_hint(&self, clauses: &mut [Clause], context: &Context) {
        let Some(hint) = &context.hint else { return };
        let ground = self.ground(&context.focus);
        let is_open = |phrase: &&mut Phrase| {
            let known = || ground.everywhere(phrase, &Want::place(Intent::Find, &[], None));
            hint.may_be_about(phrase) && known().map_or(true, |known| known.len() != 1)
        };
        let open = clauses.iter_mut().flat_map(slot::named_mut).find(is_open);
        open.into_iter().for_each(|phrase| phrase.hints.clone_from(&hint.places));
    }

    /// The same of what the robot asks about.
    pub(crate) fn heed_hint_in_question(&self, context: &mut Context) {
        let Some(mut pending) = context.pending.take() else { return };
        if let Pending::Search { clauses } | Pending::Where { clauses, .. } | Pending::Which { clauses, .. } =
            &mut pending
        {
            self.heed_hint(clauses, context);
        }
        context.pending = Some(pending);
    }
}

impl Hint {
    /// Whether a thing that was asked for may be what it is about.
    fn may_be_about(&self, phrase: &Phrase) -> bool {
        let is_named = !phrase.is_empty() && phrase.chosen.is_none() && !phrase.is_bare_pronoun();
        let classes = classes_of(phrase);
        let is_of = |about: &Phrase| classes_of(about).iter().any(|class| classes.contains(class));
        is_named && self.about.as_ref().is_none_or(is_of)
    }
}
