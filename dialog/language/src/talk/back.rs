//! What goes back to where it was: who does not know where that is names some place, as a rewriter does.

use std::collections::BTreeSet;

use cohabit_cdf::ClassId;

use crate::{
    context::Context,
    talk::{
        conversation::Conversation,
        source::{Source, things_of},
        wording::Wording,
    },
    words::token,
};

/// How words say so once they are read, and how a plain request does.
const BACK: &str = "back";
/// How a plain request begins to put something somewhere, and what stands before that place.
const PUT: &str = "put ";
const PLACES: [&str; 6] = ["on", "in", "into", "onto", "at", "inside"];

impl Conversation<'_> {
    /// Plain requests that put things back, where that was said, and to no place that nobody spoke of. Where they were the robot knows that
    /// took them, or takes them for what is to be done before.
    pub(crate) fn with_back(&self, text: &str, wording: &Wording<'_>, source: &Source, context: &Context) -> String {
        let Some(at) = wording.words.iter().position(|word| word == BACK) else { return text.to_owned() };
        let named: BTreeSet<ClassId> = things_of(self.lexicon, &wording.words[..at]).collect();
        let taken = context.focus.origins.iter().filter_map(|(taken, _)| self.scene.object(*taken));
        let mut handled: BTreeSet<ClassId> = taken.map(|object| object.class).collect();
        let mut requests: Vec<String> = Vec::new();
        for request in text.split("; ") {
            let is_meant = |thing: &BTreeSet<ClassId>| {
                !thing.is_disjoint(&handled) && (named.is_empty() || !thing.is_disjoint(&named))
            };
            let back = self.put_back_instead(request, source, &is_meant);
            if !request.ends_with('?') {
                handled.extend(things_of(self.lexicon, &token::words(request)));
            }
            requests.push(back.unwrap_or_else(|| request.to_owned()));
        }
        requests.join("; ")
    }

    /// A plain request that puts such a thing back, if it puts it to a place that was not said.
    fn put_back_instead(
        &self,
        request: &str,
        source: &Source,
        is_meant: &dyn Fn(&BTreeSet<ClassId>) -> bool,
    ) -> Option<String> {
        let words = token::words(request.strip_prefix(PUT)?);
        let at = words.iter().position(|word| PLACES.contains(&word.as_str()))?;
        let (thing, place) = (&words[..at], &words[at..]);
        let classes = |words: &[String]| -> BTreeSet<ClassId> { things_of(self.lexicon, words).collect() };
        let place = classes(place);
        let goes_elsewhere = source.things.iter().any(|(_, said)| !said.is_disjoint(&place));
        let thing = thing.strip_suffix(&[BACK.to_owned()]).unwrap_or(thing);
        (is_meant(&classes(thing)) && !goes_elsewhere).then(|| format!("{PUT}{} {BACK}", thing.join(" ")))
    }
}
