//! Whether plain requests keep to what was said: a rewriter that has read of many red mugs may write of one that nobody spoke of, and a
//! condition may lose its `not`.

use std::collections::BTreeSet;

use cohabit_cdf::{ClassId, ObjectClass, Property};

use crate::{
    answer::claim::{asked_either, asked_state},
    ground::focus::Focus,
    read::{question, whether},
    talk::{
        condition,
        conversation::Conversation,
        source::{HERE, Source, name_length, rooms, things, things_of},
    },
    words::{lexicon::Naming, question_kind::QuestionKind, token},
};

/// Talk that asks for nothing; behind it stands of what kind it is, where that is known.
pub(crate) const TALK: &str = "social";
/// What is said of all of a kind.
const ALL: [&str; 3] = ["all", "every", "everything"];
/// What is said of the one of two that was not spoken of.
const OTHER: &str = "other";
/// How what is around the robot says what is in a thing: `mug with coffee`.
const HOLDING: &str = "with";
/// What stands before what something is done with.
const MEANS: [&str; 4] = ["in", "with", "on", "from"];
/// Of these, where it goes is what is asked for.
const PUTS: [&str; 4] = ["put", "bring", "pour", "move"];

impl Conversation<'_> {
    /// Plain requests without the colours and kinds of things that nobody named, and that nothing around is called by: `the red mug` where no red
    /// was spoken of, `the blue desk` where `the desk` was said and something else was blue. Devices may be called by theirs.
    pub(crate) fn without_invention(&self, text: &str, source: &Source) -> String {
        let words: Vec<&str> = text.split(' ').collect();
        let lexicon = self.lexicon;
        let is_all = |rest: &[String], fits: &dyn Fn(&ObjectClass) -> bool| {
            let named = lexicon.classes.longest(rest).map(|(_, namings)| namings);
            named.is_some_and(|namings| namings.iter().all(|naming| fits(self.catalog.class(naming.class))))
        };
        // `the coffee cup` where `the cup` was said: which kind is at hand the rewriter does not know.
        let is_kind = |word: &String, rest: &[String]| {
            let of_kind: Vec<String> = std::iter::once(word).chain(rest).cloned().collect();
            !source.words.contains(word)
                && source.said.contains(&rest[0])
                && name_length(lexicon, &of_kind) == name_length(lexicon, rest) + 1
                && is_all(rest, &|class| class.has(Property::Pickupable))
        };
        let is_color = |word: &String, rest: &[String]| {
            if !source.words.contains(word) {
                return is_all(rest, &|class| class.has(Property::Pickupable));
            }
            let is_of_another = source.said.contains(&rest[0])
                && !source.said.contains(word)
                && !source.pairs.contains(&[word.clone(), rest[0].clone()]);
            is_of_another && is_all(rest, &|class| !class.has(Property::Toggleable))
        };
        let is_invented = |at: usize| {
            let word = words[at].to_owned();
            let rest: Vec<String> = words[at + 1..].iter().flat_map(|word| token::words(word)).collect();
            // `that mug`, of which only a yellow one is there.
            if rest.first().is_some_and(|next| source.pairs_around.contains(&[word.clone(), next.clone()])) {
                return false;
            }
            let names_color = lexicon.colors.exact(std::slice::from_ref(&word)).is_some();
            !rest.is_empty() && if names_color { is_color(&word, &rest) } else { is_kind(&word, &rest) }
        };
        // Which is `the other mug` the rewriter does not see.
        let is_other = source.said.contains(OTHER) && !words.contains(&OTHER);
        let kept = (0..words.len()).filter_map(|at| match is_invented(at) {
            true => is_other.then_some(OTHER),
            false => Some(words[at]),
        });
        kept.collect::<Vec<_>>().join(" ")
    }

    /// Plain requests with the thing that was said, where they name another one of which nobody spoke and that is not around: who has read of
    /// coffee pots alone takes a teapot for one.
    pub(crate) fn with_things_said(&self, text: &str, source: &Source) -> String {
        let said = self.only_unnamed(text, source);
        let requests = text.split("; ").map(|request| {
            let request = self.with_color_said(self.without_unheard(request, source), source);
            let renamed = said.and_then(|said| self.with_thing(&request, said, &|classes| is_nowhere(classes, source)));
            renamed.unwrap_or(request)
        });
        requests.collect::<Vec<_>>().join("; ")
    }

    /// Plain requests with the thing that was said, where they name what is only taken for that, and such a one is around: who says lamp means
    /// no light switch, where there is a lamp.
    pub(crate) fn with_things_meant(&self, text: &str, source: &Source) -> String {
        let written = things(self.lexicon, &token::words(text));
        let named: BTreeSet<ClassId> = written.iter().flat_map(|(_, classes)| classes.iter().copied()).collect();
        let is_written = |said: &String| written.iter().any(|(name, _)| name == said);
        source.things.iter().filter(|(said, _)| !is_written(said)).fold(text.to_owned(), |text, (said, may_mean)| {
            let called: BTreeSet<ClassId> =
                may_mean.iter().copied().filter(|class| is_called(self.catalog.class(*class), said)).collect();
            if called.is_disjoint(&source.around) || !called.is_disjoint(&named) {
                return text;
            }
            let is_said_besides = |classes: &BTreeSet<ClassId>| {
                source.things.iter().any(|(other, may_mean)| other != said && !may_mean.is_disjoint(classes))
            };
            let is_stand_in = |classes: &BTreeSet<ClassId>| {
                !classes.is_disjoint(may_mean) && classes.is_disjoint(&called) && !is_said_besides(classes)
            };
            let meant =
                |request: &str| self.with_thing(request, said, &is_stand_in).unwrap_or_else(|| request.to_owned());
            text.split("; ").map(meant).collect::<Vec<_>>().join("; ")
        })
    }

    /// The same where what they name first is around, but nobody spoke of it.
    pub(crate) fn with_thing_swapped(&self, text: &str, source: &Source) -> Option<String> {
        let said = self.only_unnamed(text, source)?;
        let swapped = |request: &str| {
            let words = token::words(request);
            let (_, first) = things(self.lexicon, &words).into_iter().next()?;
            let is_it = |classes: &BTreeSet<ClassId>| *classes == first && classes.is_disjoint(&source.spoken);
            self.with_thing(request, said, &is_it)
        };
        let requests: Vec<&str> = text.split("; ").collect();
        let (at, swapped) = requests.iter().enumerate().find_map(|(at, request)| Some((at, swapped(request)?)))?;
        let all = requests.iter().enumerate().map(|(other, request)| if other == at { &swapped } else { *request });
        Some(all.collect::<Vec<_>>().join("; "))
    }

    /// The one thing that was said and is not named; of several nobody knows which is meant.
    fn only_unnamed<'s>(&self, text: &str, source: &'s Source) -> Option<&'s str> {
        let named: BTreeSet<ClassId> = things_of(self.lexicon, &token::words(text)).collect();
        let mut unnamed = source.things.iter().filter(|(_, classes)| classes.is_disjoint(&named));
        unnamed.next().map(|(said, _)| said.as_str()).filter(|_| unnamed.next().is_none())
    }

    /// Plain requests that forbid nothing, of who forbade nothing: `do not open the cabinet`, of who said that it should stay closed, is to close it.
    pub(crate) fn without_invented_denial(&self, text: &str, source: &Source) -> String {
        if source.has_denial {
            return text.to_owned();
        }
        let wishes = &self.lexicon.wishes;
        let is_to_stay = source.said.iter().any(|word| wishes.stayers.contains(word));
        let as_wished = |forbidden: &str| {
            wishes.undoes.iter().filter(|_| is_to_stay).find_map(|(verb, other)| {
                let thing = forbidden.strip_prefix(verb.as_str())?.strip_prefix(' ')?;
                Some(format!("{other} {thing}"))
            })
        };
        let meant = |request: &str| match request.strip_prefix("do not ") {
            Some(forbidden) => as_wished(forbidden),
            None => Some(request.to_owned()),
        };
        let requests: Vec<String> = text.split("; ").filter_map(meant).collect();
        if requests.is_empty() { text.to_owned() } else { requests.join("; ") }
    }

    /// Plain requests without what they would be done with, where nobody spoke of that, and it is not around: `heat the milk in the microwave`, at
    /// home.
    pub(crate) fn without_means(&self, text: &str, source: &Source) -> String {
        let names_absent = |words: &[String]| {
            let named = self.lexicon.classes.longest(words).filter(|(length, _)| *length == words.len());
            let classes = |namings: &[Naming]| namings.iter().map(|naming| naming.class).collect();
            named.is_some_and(|(_, namings)| is_nowhere(&classes(namings), source))
        };
        let without = |request: &str| {
            let words: Vec<String> = request.split(' ').map(str::to_owned).collect();
            if PUTS.contains(&words[0].as_str()) {
                return request.to_owned();
            }
            let means = (2..words.len().saturating_sub(2)).find(|at| {
                MEANS.contains(&words[*at].as_str()) && words[at + 1] == "the" && names_absent(&words[at + 2..])
            });
            means.map_or_else(|| request.to_owned(), |at| words[..at].join(" "))
        };
        text.split("; ").map(without).collect::<Vec<_>>().join("; ")
    }

    /// Plain requests that ask where both of two things are, where both were said and only one of them is named.
    pub(crate) fn with_both_things(&self, text: &str, source: &Source) -> String {
        let classes = |name: &str| -> BTreeSet<ClassId> { things_of(self.lexicon, &token::words(name)).collect() };
        let asks_where = |request: &str| {
            request.ends_with('?')
                && question::read(self.lexicon, &token::words(request))
                    .is_some_and(|one| one.kind == QuestionKind::Where)
        };
        source.joined.iter().fold(text.to_owned(), |text, [first, joint, second]| {
            let (named, of_first, of_second) = (classes(&text), classes(first), classes(second));
            let has = [!of_first.is_disjoint(&named), !of_second.is_disjoint(&named)];
            if has[0] == has[1] || !of_first.is_disjoint(&of_second) {
                return text;
            }
            let said = if has[0] { of_first } else { of_second };
            let both = format!("{first} {joint} {second}");
            let is_it = |classes: &BTreeSet<ClassId>| !classes.is_disjoint(&said);
            let meant = |request: &str| {
                let with_both = asks_where(request).then(|| self.with_thing(request, &both, &is_it)).flatten();
                with_both.unwrap_or_else(|| request.to_owned())
            };
            text.split("; ").map(meant).collect::<Vec<_>>().join("; ")
        })
    }

    /// A plain request with the thing of the colour that was said, where it names one of another: `the yellow fruit`, taken for an apple.
    fn with_color_said(&self, request: String, source: &Source) -> String {
        let names_color = |word: &str| self.lexicon.colors.exact(&[word.to_owned()]).is_some();
        if request.split(' ').any(names_color) {
            return request;
        }
        let focus = Focus::default();
        let ground = self.ground(&focus);
        let is_so = |class: ClassId, color: &str| {
            self.scene.objects.iter().any(|object| object.class == class && ground.has_color(object, color))
        };
        let meant = source.colored.iter().find_map(|said| {
            let fits = |class: &ClassId| is_so(*class, &said.color);
            let is_it = |classes: &BTreeSet<ClassId>| !classes.iter().any(fits) && !classes.is_disjoint(&said.classes);
            said.classes.iter().any(fits).then(|| self.with_thing(&request, &said.thing, &is_it)).flatten()
        });
        meant.unwrap_or(request)
    }

    /// How many things were said that plain requests do not name.
    pub(crate) fn unnamed(&self, text: &str, source: &Source) -> usize {
        let named: BTreeSet<ClassId> = things_of(self.lexicon, &token::words(text)).collect();
        source.things.iter().filter(|(_, classes)| classes.is_disjoint(&named)).count()
    }

    /// How many things they name of which nobody spoke and that are not around.
    pub(crate) fn invented(&self, text: &str, source: &Source) -> usize {
        let named = things(self.lexicon, &token::words(text));
        named.iter().filter(|(_, classes)| is_nowhere(classes, source)).count()
    }

    /// How many things they name of which nobody spoke.
    pub(crate) fn unspoken(&self, text: &str, source: &Source) -> usize {
        let named = things(self.lexicon, &token::words(text));
        named.iter().filter(|(_, classes)| classes.is_disjoint(&source.spoken)).count()
    }

    /// `is it hot?`, where that was taken for the coffee that it mostly is of.
    fn without_unheard(&self, request: &str, source: &Source) -> String {
        let words: Vec<&str> = request.split(' ').collect();
        let is_unheard = |word: &str| {
            let is_fluid = self.lexicon.fluids.exact(&[word.to_owned()]).is_some();
            let is_around = source.pairs_around.contains(&[HOLDING.to_owned(), word.to_owned()]);
            is_fluid && !source.words.contains(word) && !is_around
        };
        let at = words.windows(2).position(|pair| pair[0] == "the" && is_unheard(pair[1]));
        match at.filter(|_| request.ends_with('?')) {
            Some(at) => [&words[..at], &["it"], &words[at + 2..]].concat().join(" "),
            None => request.to_owned(),
        }
    }

    /// A plain request with another thing instead of the first that is such a one.
    fn with_thing(&self, request: &str, thing: &str, is_it: &dyn Fn(&BTreeSet<ClassId>) -> bool) -> Option<String> {
        let words: Vec<&str> = request.split(' ').collect();
        let bare: Vec<String> = words.iter().map(|word| word.trim_end_matches('?').to_owned()).collect();
        let found = (0..bare.len()).find_map(|at| {
            let (length, namings) = self.lexicon.classes.longest(&bare[at..])?;
            is_it(&namings.iter().map(|naming| naming.class).collect()).then_some((at, at + length))
        });
        let (at, end) = found?;
        let mark = if words[end - 1].ends_with('?') { "?" } else { "" };
        let thing = format!("{thing}{mark}");
        Some([&words[..at], &[thing.as_str()], &words[end..]].concat().join(" "))
    }

    /// Plain requests of which those that count things do so in this room, where that was said.
    pub(crate) fn with_this_room(&self, text: &str, source: &Source) -> String {
        let counts_anywhere = |request: &str| {
            let asked = question::read(self.lexicon, &token::words(request));
            let about = asked.filter(|asked| asked.kind == QuestionKind::Count).and_then(|asked| asked.about);
            about.is_some_and(|about| about.room.is_none() && about.relations.is_empty())
        };
        let here = |request: &str| match request.strip_suffix('?') {
            Some(asked) if source.is_here && counts_anywhere(request) => format!("{asked} {}?", HERE[0]),
            _ => request.to_owned(),
        };
        text.split("; ").map(here).collect::<Vec<_>>().join("; ")
    }

    /// Plain requests that ask for one of two states where that was asked: `is the fridge open?`, of `open or shut?`, would be answered with
    /// a yes.
    pub(crate) fn with_either(&self, text: &str, source: &Source) -> String {
        let Some((states, both)) = &source.either else { return text.to_owned() };
        let of_both = |request: &str| {
            let asked = token::words(request.strip_suffix('?')?);
            let (_, said) = asked_state(self.lexicon, &asked).filter(|(state, _)| states.contains(state))?;
            let about = asked.strip_suffix(said).filter(|about| whether::asked_at(self.lexicon, about).is_some())?;
            asked_either(self.lexicon, &asked).is_none().then(|| format!("{} {both}?", about.join(" ")))
        };
        text.split("; ")
            .map(|request| of_both(request).unwrap_or_else(|| request.to_owned()))
            .collect::<Vec<_>>()
            .join("; ")
    }

    /// Whether it is rather not what was said, by what its conditions deny, and by whether it asks what was asked.
    pub(crate) fn is_unfaithful(&self, text: &str, source: &Source) -> bool {
        let conditions: Vec<Vec<String>> = text
            .split("; ")
            .filter_map(|request| request.strip_prefix("if "))
            .map(|request| token::words(request.split(',').next().unwrap_or(request)))
            .collect();
        let denies = |words: &Vec<String>| words.iter().any(|word| self.lexicon.ifs.negations.contains(word));
        let is_said = |words: &Vec<String>| words.last().is_some_and(|last| source.words.contains(last));
        let (denied, claimed): (Vec<_>, Vec<_>) = conditions.into_iter().partition(denies);
        let asks = |request: &str| request.ends_with('?') || request.starts_with("if ");
        let turns_to_deed =
            source.only_asks && !text.split("; ").any(asks) && !is_talk(text) && !matches!(text, "none" | "?");
        let is_free = |request: &str| {
            let is_deed = !request.ends_with('?') && !is_talk(request) && !matches!(request, "none" | "stop");
            let words = token::words(request);
            is_deed && !condition::has_condition(self.lexicon, &words) && !self.is_wait(&words)
        };
        let loses = source.has_condition && text.split("; ").all(is_free);
        let adds = !source.has_denial && !denied.is_empty();
        let drops = source.is_denied && denied.is_empty() && claimed.iter().any(is_said);
        adds || drops || loses || turns_to_deed || self.lists_all(text, source) || self.goes_elsewhere(text, source)
    }

    /// Whether it goes to a room that nobody named: `go to Paris`.
    fn goes_elsewhere(&self, text: &str, source: &Source) -> bool {
        let trips = text.split("; ").filter(|request| request.starts_with("go to "));
        let named = |request| rooms(self.lexicon, &token::words(request));
        trips.flat_map(named).any(|room| !source.rooms.contains(&room))
    }

    /// Whether things that nobody named stand for all of a kind: which there are the rewriter does not know.
    fn lists_all(&self, text: &str, source: &Source) -> bool {
        let words = token::words(text);
        let says_all = |word: &String| ALL.contains(&word.as_str());
        let is_unnamed = |at: usize| {
            let named = name_length(self.lexicon, &words[at..]);
            named > 0 && words[at..at + named].iter().all(|word| !source.words.contains(word))
        };
        source.said.iter().any(says_all) && !words.iter().any(says_all) && (0..words.len()).any(is_unnamed)
    }
}

/// Whether the catalogue itself calls a thing so that is more than furnishing.
fn is_called(class: &ObjectClass, said: &str) -> bool {
    let mut names = std::iter::once(&class.name).chain(&class.words);
    !class.has(Property::Decor) && names.any(|name| name.eq_ignore_ascii_case(said))
}

fn is_nowhere(classes: &BTreeSet<ClassId>, source: &Source) -> bool {
    classes.is_disjoint(&source.spoken) && classes.is_disjoint(&source.around)
}

/// The share of the words that were said now which plain requests have, too.
pub(crate) fn covered(text: &str, source: &Source) -> f32 {
    let written: BTreeSet<String> = token::words(text).into_iter().collect();
    let said = || source.said.iter().filter(|word| !token::is_punctuation(word));
    said().filter(|word| written.contains(*word)).count() as f32 / said().count().max(1) as f32
}

/// Whether it is talk that asks for nothing.
pub(crate) fn is_talk(request: &str) -> bool {
    request.strip_prefix(TALK).is_some_and(|kind| kind.is_empty() || kind.starts_with(": "))
}
