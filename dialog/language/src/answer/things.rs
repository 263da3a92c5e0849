//! Answers about what things are, look like, say and are for.

use cohabit_cdf::{Fluid, ObjectId, state::StateFlag};

use crate::{
    answer::{Answerer, claim::asked_state},
    ground::want::Want,
    known::{KnownObject, contents, describe},
    read::{
        phrase::{Phrase, RelationKind},
        question::Question,
        saying,
    },
    say::report,
    understanding::Understanding,
    words::{intent::Intent, prose},
};

impl Answerer<'_> {
    pub(crate) fn filling(&self, id: ObjectId) -> String {
        self.fillings(id).map_or_else(String::new, |filling| format!(" with {filling} in it"))
    }

    /// What was poured into a thing, if anything.
    pub(crate) fn fillings(&self, id: ObjectId) -> Option<String> {
        let object = self.scene.object(id)?;
        let mut filling: Vec<String> = Vec::new();
        if contents::has_cereal(self.catalog, object) {
            filling.push("cereal".to_owned());
        }
        if object.fluid != Fluid::None {
            filling.push(object.fluid.name().to_lowercase());
        }
        (!filling.is_empty()).then(|| prose::list(&filling, "and"))
    }

    /// `is there any thing in the fridge`.
    pub(crate) fn is_about_any_thing(&self, question: &Question) -> bool {
        question.is_whether && self.lexicon.generic.longest(&question.rest).is_some()
    }

    /// What a thing is for; of what was not seen yet, what its kind is for.
    pub(crate) fn purpose(&self, phrase: &Phrase) -> Understanding {
        match self.purpose_of_unseen(phrase) {
            Some(text) => Understanding::answer(text),
            None => {
                self.with_known(phrase, |object| Understanding::about(self.facts().purpose(object), vec![object.id]))
            }
        }
    }

    /// What the kind of a thing is for, of which none is known yet.
    fn purpose_of_unseen(&self, phrase: &Phrase) -> Option<String> {
        let is_known = self.ground().one(phrase, &Want::place(Intent::Find, &[], None)).is_ok();
        let of_kind = || phrase.namings.iter().find_map(|naming| self.facts().purpose_of_kind(naming.class));
        of_kind().filter(|_| !is_known)
    }

    /// How things are, and what they are for.
    pub(crate) fn looks(&self, phrase: &Phrase) -> Understanding {
        let want = Want::place(Intent::Find, &[], None);
        match self.ground().plausible(phrase, &want) {
            Ok(found) if found.len() > 1 => self.place_of(phrase),
            Ok(_) => self.with_known(phrase, |object| {
                let facts = self.facts();
                let purpose = if facts.has_use(object) { facts.purpose(object) } else { String::new() };
                let text = prose::sentence(&facts.description(object));
                Understanding::about(format!("{text} {purpose}").trim(), vec![object.id])
            }),
            Err(_) => self.purpose(phrase),
        }
    }

    /// What is known of a thing, where that is not what was asked: what it does, too, which may be what was meant.
    pub(crate) fn unknown_of(&self, phrase: &Phrase) -> Understanding {
        if let Some(kind) = self.purpose_of_unseen(phrase) {
            return self.unseen(phrase).after(&kind);
        }
        self.with_known(phrase, |object| {
            let known = self.all_known(object, "I do not know that");
            match self.facts().use_of(object) {
                Some(does) => known.before(&prose::sentence(&does)),
                None => known,
            }
        })
    }

    pub(crate) fn danger(&self, about: Option<&Phrase>, question: &Question) -> Understanding {
        let want = Want::place(Intent::Find, &[], None);
        let object =
            about.and_then(|phrase| self.ground().one(phrase, &want).ok()).and_then(|id| self.scene.object(id));
        let facts = self.facts();
        let sparking = || self.scene.objects.iter().find(|object| object.has(StateFlag::Sparking));
        let (danger, object) = match object.or_else(sparking) {
            Some(object) => (facts.danger(object), Some(object)),
            None => (None, None),
        };
        let is_so = danger.is_some() != question.asks_for_safety();
        let of = object.map_or_else(|| "here".to_owned(), |object| format!("about {}", self.short(object.id)));
        let danger = danger.unwrap_or_else(|| format!("I know of nothing dangerous {of}"));
        let told = object.and_then(|object| facts.written_of(object)).unwrap_or_default();
        let text = format!("{} {told}", prose::sentence(&danger));
        Understanding::whether(is_so, text.trim(), object.map(|object| object.id).into_iter().collect())
    }

    pub(crate) fn trouble(&self, id: ObjectId) -> Understanding {
        let Some(object) = self.scene.object(id) else { return self.hint() };
        let failed = self.context.failed.as_ref().filter(|failure| failure.step.object() == Some(id));
        // `what is the problem with the paper`, of who has just refused to do something with it.
        let the = self.short(id);
        let refused = self.context.refused.as_ref().filter(|why| says_name(why, &the));
        let text = match (self.facts().trouble(object), failed, refused) {
            (Some(wrong), _, _) => wrong,
            (None, Some(failure), _) => {
                format!("I did not finish {}: {}", failure.step.says, report::cause(failure.status))
            }
            (None, None, Some(why)) => why.clone(),
            (None, None, None) => format!("nothing that I can see: {}", self.facts().description(object)),
        };
        Understanding::about(prose::sentence(&text), vec![id])
    }

    /// Whose a thing is, where its name tells that.
    pub(crate) fn owner(&self, id: ObjectId) -> Understanding {
        let words = self.scene.object(id).map(|object| &self.catalog.class(object.class).words);
        let owner = words.into_iter().flatten().find_map(|name| Some(name.split_once("'s ")?.0));
        let text = owner.map_or_else(
            || format!("I do not know whose it is. {}", prose::sentence(&self.place_sentence(id))),
            |owner| prose::sentence(&format!("{} is the {owner}'s", self.short(id))),
        );
        Understanding::about(text, vec![id])
    }

    /// Which of several are as was asked.
    pub(crate) fn which(&self, phrase: &Phrase, question: &Question) -> Understanding {
        let all: Vec<ObjectId> = self.scene.objects.iter().map(|object| object.id).collect();
        let mut found = self.ground().narrow(phrase, &all);
        // `what is closed`: of what opens.
        if phrase.namings.is_empty() {
            let can_be = |object: &KnownObject| phrase.states.iter().all(|state| self.can_be(object, *state));
            found.retain(|id| self.scene.object(*id).is_some_and(can_be));
        }
        // `which shelves do you see there?`
        let is_here = question.rest.iter().any(|word| matches!(word.as_str(), "see" | "here" | "there"));
        if is_here {
            found.retain(|id| self.scene.object(*id).is_some_and(|object| object.room == self.scene.robot.room));
        }
        if phrase.relations.iter().any(|relation| relation.kind == RelationKind::For) {
            found.retain(|id| self.scene.object(*id).is_some_and(|object| object.works.is_some()));
        }
        if phrase.side.is_some()
            && let Ok(nearest) = self.ground().one(phrase, &Want::place(Intent::Find, &[], None))
        {
            found = vec![nearest];
        }
        match found {
            found if found.is_empty() => {
                let text =
                    if is_here { "None that I have seen here. I can look around." } else { "None that I know of." };
                Understanding::whether(false, text, Vec::new())
            }
            found => {
                let names: Vec<String> = found.iter().take(contents::LIST).map(|id| self.full(*id)).collect();
                Understanding::about(prose::sentence(&prose::list(&names, "and")), found)
            }
        }
    }

    pub(crate) fn read_out(&self, note: &KnownObject) -> Understanding {
        let the = prose::sentence(&self.full(note.id));
        let text = format!("{} says: \"{}\"", the.trim_end_matches('.'), note.text);
        Understanding::whether(true, text, vec![note.id])
    }

    pub(crate) fn text(&self, phrase: Option<&Phrase>) -> Understanding {
        let notes = || self.scene.objects.iter().filter(|object| !object.text.is_empty());
        let of_phrase = phrase.filter(|phrase| !phrase.is_empty()).and_then(|phrase| {
            let want = Want::place(Intent::Find, &[], None);
            self.ground().one(phrase, &want).ok().and_then(|id| self.scene.object(id))
        });
        if let Some(object) = of_phrase.filter(|object| object.text.is_empty()) {
            // `what does the scale show?`
            if self.scene.contents(object.id).next().is_some() {
                return self.contents(object.id);
            }
            let text = format!("I see nothing written on {} that I could read.", self.short(object.id));
            return Understanding::whether(false, text, vec![object.id]);
        }
        let nearest = || {
            notes().min_by(|a, b| self.scene.distance_m(a).total_cmp(&self.scene.distance_m(b)).then(a.id.cmp(&b.id)))
        };
        match of_phrase.or_else(nearest) {
            Some(note) => self.read_out(note),
            None => {
                let text = "I know of nothing written here. I can look at a note if you point me to one.";
                Understanding::whether(false, text, Vec::new())
            }
        }
    }

    /// The colour of a thing, or of each that may be meant.
    pub(crate) fn colors(&self, phrase: &Phrase) -> Understanding {
        let want = Want::place(Intent::Find, &[], None);
        let Ok(found) = self.ground().plausible(phrase, &want) else {
            return self
                .with_object(phrase, |id| Understanding::about(prose::sentence(&self.color_sentence(id)), vec![id]));
        };
        let mut said: Vec<String> = found.iter().take(contents::LIST).map(|id| self.color_sentence(*id)).collect();
        said.dedup();
        Understanding::about(prose::sentence(&prose::list(&said, "and")), found)
    }

    fn color_sentence(&self, id: ObjectId) -> String {
        let Some(object) = self.scene.object(id) else { return String::new() };
        let name = describe::name(self.catalog, object.class);
        format!("the {name} {} {}", prose::is(&name), describe::color(self.catalog, object))
    }

    pub(crate) fn count(&self, phrase: &Phrase, question: &Question) -> Understanding {
        let is_them = phrase.is_many() || phrase.is_one_of_kind();
        if is_them && self.context.focus.group.is_empty() {
            return Understanding::lost(saying::unresolved(phrase));
        }
        let all: Vec<ObjectId> = match is_them {
            true => self.context.focus.group.clone(),
            false => self.scene.objects.iter().map(|object| object.id).collect(),
        };
        let bare = Phrase { pronoun: None, ..phrase.clone() };
        let mut found = self.ground().narrow(if is_them { &bare } else { phrase }, &all);
        // `how many mugs are empty`
        let state = asked_state(self.lexicon, &question.rest).filter(|(state, _)| !phrase.states.contains(state));
        if let Some((state, _)) = state {
            found.retain(|id| self.scene.object(*id).is_some_and(|object| self.is_so(object, state)));
        }
        let noun = saying::noun_or_thing(phrase);
        let text = match found.len() {
            0 => format!("I know of no {noun}."),
            1 => format!("I know of one: {}.", self.full(found[0])),
            count if noun.contains(' ') => format!("I know of {count}."),
            count => format!("I know of {count} {}.", prose::plural(noun)),
        };
        Understanding::whether(!found.is_empty(), text, found)
    }
}

/// Whether a sentence speaks of a thing by this name, and not by a longer one that begins so.
pub(super) fn says_name(text: &str, name: &str) -> bool {
    let ends = |(at, found): (usize, &str)| {
        text[at + found.len()..].chars().next().is_none_or(|next| !next.is_alphanumeric() && next != '-')
    };
    text.match_indices(name).any(ends)
}
