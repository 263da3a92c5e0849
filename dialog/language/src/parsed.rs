//! What the learned parser makes of an utterance, beside what the grammar makes of it.

use std::sync::LazyLock;

use cohabit_cdf::Property;
use cohabit_parser::{
    Reading,
    request::{Act, Answer, Command, Condition, Relation, Request, Social},
};

use crate::{
    alternatives::lines,
    cache::Cache,
    clause,
    context::Context,
    conversation::Conversation,
    describe,
    known::KnownObject,
    likeness::{Likeness, SHARPNESS, UNLIKE_THING},
    phrase::{Phrase, Place, Reader},
    stop_likeness, token,
    understanding::{Clarification, Understanding},
};

/// How it says what it leaves out.
pub(crate) const LEAVES_OUT: &str = "I do not know how to do this:";

/// How likely a stop must be for the robot to stop, by the parser and by what is meant.
const STOPS: f32 = 0.5;
const MEANS_STOP: f32 = 0.3;

impl Conversation<'_> {
    /// What else is asked for, if an utterance is likely a stop by the parser, or by what it means.
    pub(crate) fn likely_stop(&self, utterance: &str, context: &Context) -> Option<String> {
        self.parser?;
        let means_stop = |text: &str| stop_likeness::probability(&Likeness::builtin().of(text)) > MEANS_STOP;
        let others = || {
            let (words, _) = self.lexicon.normalise(utterance);
            let parts = clause::between_breaks(&words).into_iter().map(token::sentence);
            parts.filter(|part| !means_stop(part)).collect::<Vec<_>>().join(". ")
        };
        self.parsed_stop(utterance, context).or_else(|| means_stop(utterance).then(others))
    }

    fn parsed_stop(&self, utterance: &str, context: &Context) -> Option<String> {
        let readings = self.readings(utterance, context);
        let stopping = readings.iter().filter(|reading| reading.requests.iter().any(stops));
        if stopping.clone().map(|reading| reading.probability).sum::<f32>() < STOPS {
            return None;
        }
        let others = stopping.clone().next()?.requests.iter().filter(|request| asks(request) && !stops(request));
        Some(others.filter_map(sentence).collect::<Vec<_>>().join(". "))
    }

    pub(crate) fn readings(&self, utterance: &str, context: &Context) -> Vec<Reading> {
        // Parts of an utterance are read more than once.
        static READ: LazyLock<Cache<Vec<Reading>>> = LazyLock::new(Cache::default);
        let Some(parser) = self.parser else { return Vec::new() };
        let lines = lines(context);
        READ.get_or_insert_with(&transcript(utterance, &lines), || parser.parse(utterance, &lines))
    }

    /// Whether the parser rather sees something that is asked for, or asked.
    pub(crate) fn parser_sees_request(&self, utterance: &str, context: &Context) -> bool {
        self.likely_request(utterance, context) >= 0.5
    }

    /// How likely the parser takes it for a request; 1, where it takes it for nothing.
    pub(crate) fn likely_request(&self, utterance: &str, context: &Context) -> f32 {
        let readings = self.readings(utterance, context);
        let sum =
            |readings: &mut dyn Iterator<Item = &Reading>| readings.map(|reading| reading.probability).sum::<f32>();
        let all = sum(&mut readings.iter());
        let asking = sum(&mut readings.iter().filter(|reading| reading.requests.iter().any(asks)));
        if all > 0.0 { asking / all } else { 1.0 }
    }

    /// What a reading means; nothing, where it makes no sense in the scene and conversation. What the robot cannot do of it is said.
    pub(crate) fn understand_reading(
        &self,
        reading: &Reading,
        utterance: &str,
        context: &mut Context,
    ) -> Option<(Understanding, f32)> {
        let asked: Vec<&Request> = reading.requests.iter().filter(|request| asks(request)).collect();
        if let ([], Some(Act::Social(social))) = (asked.as_slice(), reading.requests.last().map(|last| &last.act)) {
            // `aye, that's the very one`
            if matches!(social, Social::Agreement | Social::Praise) && context.asks_whether() {
                return Some((self.understand_said("yes", context), 1.0));
            }
            return Some((self.reply_to_talk(utterance, *social, context), 1.0));
        }
        if let [Request { act: Act::Goal(wish), conditions, .. }] = asked.as_slice()
            && conditions.is_empty()
        {
            return self.wished(wish, context).map(|understanding| (understanding, 1.0));
        }
        let told: Vec<(Request, f32)> = asked.iter().map(|request| self.with_names(request)).collect();
        let sentences: Vec<String> = told.iter().filter_map(|(request, _)| sentence(request)).collect();
        if sentences.is_empty() {
            return None;
        }
        let certainty = told.iter().map(|(_, certainty)| certainty).product();
        let understanding = self.understand_said(&sentences.join(". "), context);
        let unknown = asked.iter().find_map(|request| unknown_words(request));
        let is_lost = matches!(understanding, Understanding::Refusal { is_lost: true, .. });
        let understanding = match unknown {
            Some(words) => understanding.after(&format!("{LEAVES_OUT} \"{words}\", so I leave that out.")),
            None => understanding,
        };
        (!is_lost).then_some((understanding, certainty))
    }

    /// What is said to who asks for nothing: what the grammar knows to say, or what suits such talk.
    pub(crate) fn reply_to_talk(&self, utterance: &str, social: Social, context: &Context) -> Understanding {
        let said = self.understand_said(utterance, &mut context.clone());
        let is_answer = matches!(said, Understanding::Answer { .. });
        if is_answer { said } else { Understanding::answer(small_talk(social)) }
    }

    /// A request with names for what the grammar cannot read of its descriptions, and how certain these names are.
    fn with_names(&self, request: &Request) -> (Request, f32) {
        let mut request = request.clone();
        let mut certainty = 1.0;
        let (Act::Do(command) | Act::Refrain(command) | Act::Inquire(_, command)) = &mut request.act else {
            return (request, certainty);
        };
        if let Command::Known { form, arguments } = command {
            for (place, argument) in arguments.iter_mut().enumerate() {
                if let Some((name, probability)) = self.named(argument, wanted(form.text(), place)) {
                    *argument = name;
                    certainty *= probability;
                }
            }
        }
        (request, certainty)
    }

    /// The name of what a description means that the grammar cannot read, and how probable that is.
    fn named(&self, description: &str, affordances: &[Property]) -> Option<(String, f32)> {
        let (words, _) = self.lexicon.normalise(description);
        if words.is_empty() || self.reads(&words) {
            return None;
        }
        let likeness = Likeness::builtin();
        let start = self.lexicon.articles.longest(&words).map_or(0, |(length, ())| length);
        let said = likeness.of(&words[start.min(words.len() - 1)..].join(" "));
        let affords = |object: &KnownObject| {
            let class = self.catalog.class(object.class);
            affordances.is_empty() || affordances.iter().any(|property| class.has(*property))
        };
        let mut things = self.things_by_name();
        if things.iter().any(|(_, objects)| objects.iter().any(|object| affords(object))) {
            things.retain(|(_, objects)| objects.iter().any(|object| affords(object)));
        }
        let utility = |objects: &[&KnownObject]| {
            let like = |object: &&KnownObject| likeness.to_class(&said, self.catalog, object.class);
            objects.iter().map(like).fold(-1.0, f32::max) / SHARPNESS + self.nearness(objects)
        };
        let ranked: Vec<(f32, &(&str, Vec<&KnownObject>))> =
            things.iter().map(|thing| (utility(&thing.1), thing)).collect();
        let (highest, (name, objects)) = *ranked.iter().max_by(|(one, _), (other, _)| one.total_cmp(other))?;
        let whole: f32 = ranked.iter().map(|(utility, _)| (utility - highest).exp()).sum();
        let colors = words.iter().filter_map(|word| self.lexicon.colors.exact(std::slice::from_ref(word)));
        let is_colored =
            |color: &&String| objects.iter().any(|object| describe::color(self.catalog, object) == **color);
        let color = colors.filter(|_| objects.len() > 1).find(is_colored);
        let name = color.map_or_else(|| format!("the {name}"), |color| format!("the {color} {name}"));
        let unlike = (UNLIKE_THING / SHARPNESS - highest).exp();
        Some((name, 1.0 / (whole + unlike)))
    }

    /// Whether the grammar reads a description to its last word.
    fn reads(&self, words: &[String]) -> bool {
        let mut reader = Reader::new(self.lexicon, words);
        let Some(place) = reader.destination() else { return false };
        let Place::Object(mut phrase) = place else { return reader.is_done() };
        while let Some((preposition, place)) = reader.place() {
            phrase.attach(preposition, place);
        }
        let is_known = |phrase: &Phrase| phrase.unknown.is_empty();
        reader.is_done() && is_known(&phrase) && phrase.relations.iter().all(|relation| is_known(&relation.to))
    }

    /// What brings a wish about: what the grammar makes of it, or else the goals of the mission that speak of the same things.
    fn wished(&self, wish: &str, context: &mut Context) -> Option<Understanding> {
        let open: Vec<&str> = self.scene.goals.iter().filter(|goal| !goal.met).map(|goal| goal.text.as_str()).collect();
        let wanted = self.content(wish);
        let is_goal = open.iter().any(|goal| self.content(goal).iter().any(|word| wanted.contains(word)));
        let goals = is_goal.then(|| open.join(". "));
        let first = is_goal.then(|| open.first().map(|goal| (*goal).to_owned())).flatten();
        let wishes = WISHES.map(|(before, after)| Some(format!("{before}{wish}{after}")));
        let said = [goals, first].into_iter().chain(wishes).flatten();
        said.filter(|said| !said.is_empty()).find_map(|said| {
            let mut then = context.clone();
            let understanding = self.understand_said(&said, &mut then);
            let is_done = matches!(understanding, Understanding::Plan { .. } | Understanding::Question { .. });
            (is_done && worth(&understanding) > Worth::None).then(|| {
                *context = then;
                understanding
            })
        })
    }

    /// The words of a text that name things.
    fn content(&self, text: &str) -> Vec<String> {
        let (mut words, _) = self.lexicon.normalise(text);
        words.retain(|word| {
            let word = std::slice::from_ref(word);
            self.lexicon.classes.exact(word).is_some() || self.lexicon.fluids.exact(word).is_some()
        });
        words
    }
}

/// What may stand around the words of a wish for it to be one that the grammar reads.
const WISHES: [(&str, &str); 4] = [("", ""), ("i want ", ""), ("make ", ""), ("i want it so that ", "")];

/// What a thing must afford to stand at a place of a form.
fn wanted(form: &str, place: usize) -> &'static [Property] {
    let begins = |verbs: &[&str]| verbs.iter().any(|verb| form.starts_with(verb));
    match place {
        0 if begins(&["open ", "close "]) => &[Property::Openable],
        0 if begins(&["turn on ", "turn off ", "press "]) => &[Property::Toggleable],
        0 if begins(&[
            "pick up ", "put ", "bring ", "give ", "throw ", "drop ", "heat ", "cool ", "cook ", "eat ", "cut ",
        ]) =>
        {
            &[Property::Pickupable]
        }
        0 if begins(&["break "]) => &[Property::Breakable],
        0 if begins(&["fill ", "empty "]) => &[Property::Fillable],
        1 if begins(&["put X in Y", "put X on Y", "pour ", "heat X in", "cool X in", "cook X in"]) => {
            &[Property::Receptacle, Property::Fillable]
        }
        1 if begins(&["break ", "cut ", "repair ", "clean "]) => &[Property::Pickupable],
        _ => &[],
    }
}

/// Whether it is more than social talk.
pub(crate) const fn asks(request: &Request) -> bool {
    !matches!(request.act, Act::Social(_) | Act::None)
}

/// Whether it tells the robot to stop at once.
pub(crate) fn stops(request: &Request) -> bool {
    let is_stop = matches!(&request.act, Act::Do(Command::Known { form, .. }) if form.text() == "stop");
    is_stop && request.conditions.is_empty()
}

/// What is asked for, if it is nothing that the robot knows.
pub(crate) fn unknown_words(request: &Request) -> Option<&str> {
    match &request.act {
        Act::Do(Command::Unknown(words)) => Some(words),
        _ => None,
    }
}

/// An utterance behind the lines before it, as text.
pub(crate) fn transcript(utterance: &str, lines: &[cohabit_parser::Said<'_>]) -> String {
    let before = lines.iter().map(|line| format!("{}{}\n", if line.by_robot { '<' } else { '>' }, line.text));
    before.chain([utterance.to_owned()]).collect()
}

/// How much was made of an utterance.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub(crate) enum Worth {
    /// Nothing, or only something without its verb.
    None,
    /// That it cannot be done.
    Refused,
    /// Nothing is to be done.
    Answered,
    /// What is to be done, or what is to be known first.
    Asked,
}

pub(crate) const fn worth(understanding: &Understanding) -> Worth {
    match understanding {
        Understanding::Refusal { is_lost: true, .. }
        | Understanding::Question { kind: Clarification::Request | Clarification::Appearance, .. } => Worth::None,
        Understanding::Refusal { .. } => Worth::Refused,
        Understanding::Answer { .. } => Worth::Answered,
        Understanding::Plan { .. } | Understanding::Question { .. } | Understanding::Stop { .. } => Worth::Asked,
    }
}

/// A request in plain words; nothing, if it is none that the robot knows.
pub(crate) fn sentence(request: &Request) -> Option<String> {
    let mut sentence = match &request.act {
        Act::Do(Command::Unknown(_)) => return None,
        Act::Answer(Answer::Any) => "any of them".to_owned(),
        Act::Answer(Answer::Words(words)) | Act::Goal(words) | Act::Tell(words) => words.clone(),
        Act::Answer(answer) => Act::Answer(answer.clone()).to_string().replacen("answer: ", "", 1),
        act => act.to_string(),
    };
    if let Some(manner) = &request.manner {
        sentence = format!("{sentence} {manner}");
    }
    if request.relation == Relation::Instead {
        sentence = format!("{sentence} instead");
    }
    for condition in request.conditions.iter().rev() {
        sentence = match condition {
            Condition::If(statement) => format!("if {statement}, {sentence}"),
            Condition::Unless(statement) => format!("unless {statement}, {sentence}"),
            Condition::When(statement) => format!("when {statement}, {sentence}"),
            Condition::Until(statement) => format!("{sentence} until {statement}"),
            Condition::Otherwise => format!("otherwise {sentence}"),
        };
    }
    Some(sentence)
}

/// The kind of social talk that a word of the labels names.
pub(crate) fn social(kind: &str) -> Option<Social> {
    match Request::parse(&format!("social: {kind}")).ok()?.act {
        Act::Social(social) => Some(social),
        _ => None,
    }
}

pub(crate) const fn small_talk(social: Social) -> &'static str {
    match social {
        Social::Greeting => "Hello! What can I do for you?",
        Social::Thanks => "You are welcome!",
        Social::Praise => "Thank you! What is next?",
        Social::Complaint => "I am sorry. Tell me in a few words what you want, and I will try.",
        Social::Apology => "No problem! What shall I do?",
        Social::Bye => "Goodbye! I stay here in case you need me.",
        Social::Agreement => "OK.",
        Social::SmallTalk => "I see. Tell me when there is something to do.",
    }
}
