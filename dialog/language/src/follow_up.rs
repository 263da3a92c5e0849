//! What is said with the last request in mind: the same of something else, or said more exactly: `and the blue one?`, `the drawer, I mean`,
//! `water is fine`. Each thing that is named takes the place of one like it in the request, or is added where it may stand.

use std::ops::Range;

use cohabit_cdf::{ClassId, ObjectId, Property};

use crate::{
    alternatives::Alternative,
    asked,
    clause::{self, Clause},
    context::{Consent, Context, Pending, Role, Slot},
    conversation::Conversation,
    evidence::{Evidence, Feature},
    ground::{Ground, Want},
    lexicon::{Naming, Side},
    phrase::{Phrase, Reader},
    reply,
    said::{Named, Said},
    token,
    understanding::{Step, Understanding},
};

/// How many names are followed up, and how many ways to do so are tried.
const MOST_NAMES: usize = 4;
const MOST_TEXTS: usize = 12;
/// How many others may be the one that is meant.
const MOST_OTHERS: usize = 4;

/// What is named, as a request may name it.
struct Name {
    at: Range<usize>,
    kind: Kind,
}

/// A request that was made before, with all that it names.
struct NamedRequest {
    words: Vec<String>,
    names: Vec<Name>,
    /// Where the nouns and colors begin.
    nouns: Vec<usize>,
    /// Whether it asks for one thing.
    is_single: bool,
}

#[derive(PartialEq)]
enum Kind {
    /// What can be carried.
    Item,
    /// What things are put in, or on.
    Container,
    Surface,
    /// What stands in its place and holds nothing.
    Fixture,
    Room,
    Color,
    Fluid,
}

impl Kind {
    /// Whether one may stand in place of the other.
    fn replaces(&self, other: &Self) -> bool {
        let stands = |kind: &Self| matches!(kind, Self::Container | Self::Surface | Self::Fixture);
        match (self, other) {
            (Self::Fluid, Self::Item) => true,
            (one, Self::Room) => *one == Self::Room || stands(one),
            (Self::Room, other) => stands(other),
            (one, other) => one == other || stands(one) && stands(other),
        }
    }

    /// The word before it where it is added to a request.
    const fn joint(&self) -> &'static str {
        match self {
            Self::Item | Self::Fluid => "with",
            Self::Container => "in",
            Self::Surface | Self::Fixture => "on",
            Self::Room => "to",
            Self::Color => "",
        }
    }
}

/// Where a request names things.
fn slots(clauses: &[Clause]) -> Vec<Slot> {
    let of = |(at, clause): (usize, &Clause)| {
        let objects = (0..clause.objects.len()).map(Role::Object);
        let places = (0..clause.places.len()).map(Role::Place);
        objects.chain(places).map(|role| Slot { clause: at, role }).collect::<Vec<_>>()
    };
    clauses.iter().enumerate().flat_map(of).collect()
}

impl Conversation<'_> {
    /// What was asked before, of what is named now, and with what is named now.
    pub(crate) fn of_previous(&self, said: &Said<'_>, context: &Context) -> Vec<Alternative> {
        if said.is_conditional || said.is_forbidden {
            return Vec::new();
        }
        let words = &said.wording.words;
        let names: Vec<Name> = self.names_of(words).into_iter().take(MOST_NAMES).collect();
        if names.is_empty() {
            return Vec::new();
        }
        let mut texts: Vec<(Feature, String)> = Vec::new();
        for before in self.requests_before(context) {
            let before = self.named_request(before);
            let found = names.iter().flat_map(|name| {
                let named = words[name.at.clone()].join(" ");
                let replaced = before.replaced(name, &named).into_iter();
                let added = before.added(name, &named).into_iter();
                let added = added.map(|text| (Feature::FollowUpAdded, text));
                replaced.map(|text| (Feature::FollowUpReplaced, text)).chain(added).collect::<Vec<_>>()
            });
            for one in found {
                if texts.iter().all(|(_, text)| *text != one.1) && one.1 != before.words.join(" ") {
                    texts.push(one);
                }
            }
        }
        let ways = texts.into_iter().take(MOST_TEXTS).map(|(feature, text)| {
            let mut evidence = Evidence::default();
            evidence.set(Feature::FollowUp, 1.0);
            evidence.set(feature, 1.0);
            evidence.set(Feature::FollowUpLong, said.length);
            evidence.set(Feature::FollowUpAsks, said.requests.min(1.0));
            evidence.set_if(Feature::FollowUpPending, said.is_pending);
            let mut then = Context { pending: None, ..context.at_new_utterance() };
            Alternative::new(self.understand_said(&text, &mut then), then, evidence)
        });
        ways.filter(|way| matches!(way.understanding, Understanding::Plan { .. } | Understanding::Answer { .. }))
            .collect()
    }

    /// What was done last, with another of the same kind in place of one that it was done with: `no, the other one`.
    pub(crate) fn of_others(&self, said: &Said<'_>, context: &Context) -> Vec<Alternative> {
        if said.is_conditional || !self.names_other(&said.wording.words) {
            return Vec::new();
        }
        let taken: Vec<ObjectId> = context.last_plan.iter().filter_map(Step::object).collect();
        let ground = Ground { catalog: self.catalog, scene: self.scene, focus: &context.focus, judge: self.judge };
        let others = slots(&context.request).into_iter().flat_map(|slot| {
            let intent = context.request[slot.clause].intent;
            let want = match slot.role {
                Role::Object(_) => Want::object(intent),
                Role::Place(_) => Want::place(intent, &[], None),
            };
            let namings = asked::phrase(&context.request, slot).map(|phrase| self.kinds(phrase)).unwrap_or_default();
            let phrase = Phrase { namings, ..Phrase::default() };
            let others =
                if phrase.namings.is_empty() { Vec::new() } else { ground.all(&phrase, &want).unwrap_or_default() };
            others.into_iter().filter(|id| !taken.contains(id)).map(move |id| (slot, id)).collect::<Vec<_>>()
        });
        let others: Vec<(Slot, ObjectId)> = others.collect();
        let share = 1.0 / others.len().max(1) as f32;
        let ways = others.into_iter().take(MOST_OTHERS).map(|(slot, other)| {
            let clauses = asked::with_chosen(context.request.clone(), slot, other);
            let mut evidence = Evidence::default();
            evidence.set(Feature::FollowUp, 1.0);
            evidence.set(Feature::FollowUpOther, share);
            let mut then = Context { pending: None, ..context.at_new_utterance() };
            let consent = Consent { may_put_down: true, ..Consent::default() };
            Alternative::new(self.plan(clauses, consent, &mut then), then, evidence)
        });
        ways.filter(|way| matches!(way.understanding, Understanding::Plan { .. })).collect()
    }

    /// What its last words name without those before them: `the red shelf` is a shelf.
    fn kinds(&self, phrase: &Phrase) -> Vec<Naming> {
        let (words, _) = self.lexicon.normalise(&phrase.text);
        let name = (0..words.len()).rev().find_map(|at| self.lexicon.classes.exact(&words[at..]));
        name.cloned().unwrap_or_else(|| phrase.namings.clone())
    }

    /// Whether another one is named: what was done last is then not what is meant.
    pub(crate) fn names_other(&self, words: &[String]) -> bool {
        (0..words.len()).any(|at| matches!(self.lexicon.sides.longest(&words[at..]), Some((_, Side::Other))))
    }

    /// The request that waits for an answer, what was asked for last, and what was said last.
    fn requests_before(&self, context: &Context) -> Vec<Vec<String>> {
        let waits = match &context.pending {
            Some(
                Pending::Which { clauses, .. }
                | Pending::Where { clauses, .. }
                | Pending::Look { clauses, .. }
                | Pending::PutDown { clauses }
                | Pending::Search { clauses },
            ) => Some(reply::request_in_words(clauses)),
            _ => None,
        };
        let asked = reply::request_in_words(&context.request);
        let said = context.lines.iter().rev().find(|(by_robot, _)| !by_robot).map(|(_, text)| text.clone());
        let mut texts: Vec<Vec<String>> = Vec::new();
        for text in waits.into_iter().chain([asked]).chain(said).chain([context.asked.clone()]) {
            let (mut words, _) = self.lexicon.normalise(&text);
            while words.last().is_some_and(|word| token::is_punctuation(word)) {
                words.pop();
            }
            if !words.is_empty() && !texts.contains(&words) {
                texts.push(words);
            }
        }
        texts
    }

    /// What the words name, each with all that describes it.
    fn names_of(&self, words: &[String]) -> Vec<Name> {
        let mut names: Vec<Name> = Vec::new();
        let mut free = 0;
        let named = self.names_in(words).into_iter().map(|(at, named)| (at, self.kind(&named)));
        let fluids = (0..words.len()).filter_map(|at| {
            let (length, _) = self.lexicon.fluids.longest(&words[at..])?;
            Some((at..at + length, Kind::Fluid))
        });
        let mut all: Vec<(Range<usize>, Kind)> = named.chain(fluids).collect();
        all.sort_by_key(|(at, _)| at.start);
        for (at, kind) in all {
            if at.start < free {
                continue;
            }
            let whole = (free..=at.start).find_map(|start| {
                let mut reader = Reader::new(self.lexicon, words);
                reader.at = start;
                let phrase = reader.phrase()?;
                let is_whole = reader.at >= at.end && phrase.unknown.is_empty() && !phrase.namings.is_empty();
                is_whole.then_some(start..reader.at)
            });
            let at = whole.filter(|_| !matches!(kind, Kind::Color | Kind::Fluid)).unwrap_or(at);
            free = at.end;
            names.push(Name { at, kind });
        }
        names
    }

    fn kind(&self, named: &Named) -> Kind {
        let any = |classes: &[ClassId], property| classes.iter().any(|class| self.catalog.class(*class).has(property));
        match named {
            Named::Room(_) => Kind::Room,
            Named::Color(_) => Kind::Color,
            Named::Thing(classes) if any(classes, Property::Pickupable) => Kind::Item,
            Named::Thing(classes) if !any(classes, Property::Receptacle) => Kind::Fixture,
            Named::Thing(classes) if any(classes, Property::Openable) => Kind::Container,
            Named::Thing(_) => Kind::Surface,
        }
    }

    fn named_request(&self, words: Vec<String>) -> NamedRequest {
        NamedRequest {
            nouns: self.names_in(&words).into_iter().map(|(at, _)| at.start).collect(),
            names: self.names_of(&words),
            is_single: clause::segments(self.lexicon, &words).len() == 1,
            words,
        }
    }
}

impl NamedRequest {
    /// The request with this name in place of each that it may stand for.
    fn replaced(&self, name: &Name, named: &str) -> Vec<String> {
        let replaced = self.names.iter().filter_map(|other| {
            let (start, end) = match (&name.kind, &other.kind) {
                // `the blue one` is the same thing in blue.
                (Kind::Color, Kind::Item | Kind::Container | Kind::Surface | Kind::Fixture) => {
                    let noun = self.nouns.iter().copied().rfind(|at| other.at.contains(at))?;
                    (noun, noun)
                }
                (one, two) if one.replaces(two) => (other.at.start, other.at.end),
                _ => return None,
            };
            let (before, after) = (self.words[..start].join(" "), self.words[end..].join(" "));
            Some([&before, named, &after].join(" ").trim().to_owned())
        });
        replaced.collect()
    }

    /// The request with this name added, where it asks for one thing and has none of the kind.
    fn added(&self, name: &Name, named: &str) -> Option<String> {
        let has_one = self.names.iter().any(|other| other.kind == name.kind);
        let text = [&self.words.join(" "), name.kind.joint(), named].join(" ");
        (self.is_single && !has_one).then(|| text.replace("  ", " "))
    }
}
