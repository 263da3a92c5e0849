//! What the learned parser makes of an utterance, beside what the grammar makes of it.

use cohabit_cdf::Action;
use cohabit_parser::{
    Reading, Said,
    request::{Act, Answer, Command, Condition, Relation, Request, Social},
};

use crate::{
    answer::HINT,
    ask, chatter,
    clause::{self, Part},
    context::{Context, Pending},
    conversation::Conversation,
    inquiry,
    question::{self, QuestionKind},
    tidy,
    understanding::{Asking, Clarification, Step, Understanding},
};

/// How likely a reading must be to count: where the grammar makes no sense of the utterance; where it makes some; and where it makes
/// more than the reading does.
const LIKELY: f32 = 0.25;
const SURE: f32 = 0.6;
const CERTAIN: f32 = 0.9;
/// How likely a stop must be for the robot to stop.
const STOPS: f32 = 0.5;

impl Conversation<'_> {
    /// The better of what grammar and parser make of an utterance. What the grammar reads to the last word it knows best; of all else the
    /// parser's readings count, the likeliest first, where they are likely enough and make sense here.
    pub(crate) fn understand_best(&self, utterance: &str, context: &mut Context) -> Understanding {
        let mut read = context.clone();
        let by_grammar = self.understand_said(utterance, &mut read);
        let is_lost = matches!(by_grammar, Understanding::Refusal { is_lost: true, .. });
        if !is_lost && self.is_plain(utterance) {
            *context = read;
            return by_grammar;
        }
        // A question that the grammar answers is not carried out.
        let is_question = worth(&by_grammar) == Worth::Answered && utterance.trim_end().ends_with('?');
        let readings = self.readings(utterance, context);
        let is_foreign = self.has_unheard_word(utterance);
        // Stops were heard before.
        for reading in readings.iter().filter(|reading| !reading.requests.iter().any(stops)) {
            let mut parsed = context.clone();
            let Some(understanding) = self.understand_reading(reading, utterance, &mut parsed) else { continue };
            if matches!(understanding, Understanding::Stop { .. }) {
                continue;
            }
            let is_social = !reading.requests.iter().any(asks);
            let enough = match worth(&by_grammar) {
                _ if is_foreign => CERTAIN,
                Worth::None if is_social => SURE,
                Worth::None => LIKELY,
                worth if worth <= self::worth(&understanding) => SURE,
                _ => CERTAIN,
            };
            let is_fit = !is_question || worth(&understanding) == Worth::Answered;
            if worth(&understanding) == Worth::None || !is_fit || reading.probability < enough {
                continue;
            }
            return match understanding {
                Understanding::Plan { steps, .. } if reading.probability < chance_to_act(&steps) => {
                    self.proposed(steps, context)
                }
                understanding => {
                    *context = parsed;
                    understanding
                }
            };
        }
        *context = read;
        let excuse = readings.first().filter(|reading| is_lost && reading.probability >= LIKELY).and_then(excuse);
        excuse.map_or(by_grammar, Understanding::lost)
    }

    /// Whether there is a word that neither grammar nor parser has ever met: what it means is not guessed.
    fn has_unheard_word(&self, utterance: &str) -> bool {
        let (words, _) = self.lexicon.normalise(utterance);
        let unknown = clause::unknown_words(self.lexicon, &words);
        let knows = |word: &String| self.parser.is_some_and(|parser| parser.knows(word));
        unknown.iter().any(|word| !knows(word))
    }

    /// Asks whether these steps are meant, instead of taking them.
    fn proposed(&self, steps: Vec<Step>, context: &mut Context) -> Understanding {
        if self.judge.asking == Asking::Never {
            return Understanding::lost(format!("I did not understand that. {HINT}"));
        }
        let question = ask::shall_i(&steps, &[]);
        context.pending = Some(Pending::Offer { steps });
        question
    }

    /// What else is asked for, if the parser takes an utterance for a stop.
    pub(crate) fn parsed_stop(&self, utterance: &str, context: &Context) -> Option<String> {
        let readings = self.readings(utterance, context);
        let stopping = readings.iter().filter(|reading| reading.requests.iter().any(stops));
        if stopping.clone().map(|reading| reading.probability).sum::<f32>() < STOPS {
            return None;
        }
        let others = stopping.clone().next()?.requests.iter().filter(|request| asks(request) && !stops(request));
        Some(others.filter_map(sentence).collect::<Vec<_>>().join(". "))
    }

    fn readings(&self, utterance: &str, context: &Context) -> Vec<Reading> {
        let lines: Vec<Said<'_>> =
            context.lines.iter().map(|(by_robot, text)| Said { by_robot: *by_robot, text }).collect();
        self.parser.map(|parser| parser.parse(utterance, &lines)).unwrap_or_default()
    }

    /// Whether the grammar reads an utterance to the last word, as one that it knows: requests, or a question, or small talk.
    fn is_plain(&self, utterance: &str) -> bool {
        let (words, _) = self.lexicon.normalise(utterance);
        let words = tidy::tidied(self.lexicon, &words);
        if !self.small(&words).is_empty() || self.chat(&words).is_some() {
            return true;
        }
        if let Some(question) = question::read(self.lexicon, &words) {
            let is_known = question.about.as_ref().is_none_or(|about| about.unknown.is_empty());
            return question.kind != QuestionKind::Unknown && is_known && inquiry::later_sentences(&words).is_empty();
        }
        let parts = clause::parts(self.lexicon, self.catalog, &words);
        let is_read = |part: &Part| match part {
            Part::Clause(clause) => {
                chatter::is_clear(clause) && clause.unknown.is_empty() && !clause.has_stray_noun && !clause.is_wish
            }
            Part::Forbidden(_) => true,
            // `the microwave`
            Part::Fragment(phrase) => parts.len() == 1 && phrase.unknown.is_empty(),
            _ => false,
        };
        !parts.is_empty() && parts.iter().all(is_read)
    }

    /// What a reading means; nothing, where it makes no sense in the scene and conversation. What the robot cannot do of it is said.
    fn understand_reading(&self, reading: &Reading, utterance: &str, context: &mut Context) -> Option<Understanding> {
        let asked: Vec<&Request> = reading.requests.iter().filter(|request| asks(request)).collect();
        if let ([], Some(Act::Social(social))) = (asked.as_slice(), reading.requests.last().map(|last| &last.act)) {
            let said = self.understand_said(utterance, &mut context.clone());
            let is_answer = matches!(said, Understanding::Answer { .. });
            return Some(if is_answer { said } else { Understanding::answer(small_talk(*social)) });
        }
        if let [Request { act: Act::Goal(wish), conditions, .. }] = asked.as_slice()
            && conditions.is_empty()
        {
            return self.wished(wish, context);
        }
        let sentences: Vec<String> = asked.iter().filter_map(|request| sentence(request)).collect();
        if sentences.is_empty() {
            return None;
        }
        let understanding = self.understand_said(&sentences.join(". "), context);
        let unknown = asked.iter().find_map(|request| unknown_words(request));
        let is_lost = matches!(understanding, Understanding::Refusal { is_lost: true, .. });
        (!is_lost).then(|| match unknown {
            Some(words) => understanding.after(&format!("I do not know how to {words}, so I leave that out.")),
            None => understanding,
        })
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

/// Whether it is more than social talk.
const fn asks(request: &Request) -> bool {
    !matches!(request.act, Act::Social(_) | Act::None)
}

/// Whether it tells the robot to stop at once.
fn stops(request: &Request) -> bool {
    let is_stop = matches!(&request.act, Act::Do(Command::Known { form, .. }) if form.text() == "stop");
    is_stop && request.conditions.is_empty()
}

/// What is asked for, if it is nothing that the robot knows.
fn unknown_words(request: &Request) -> Option<&str> {
    match &request.act {
        Act::Do(Command::Unknown(words)) => Some(words),
        _ => None,
    }
}

/// How much was made of an utterance.
#[derive(Clone, Copy, Eq, Ord, PartialEq, PartialOrd)]
enum Worth {
    /// Nothing, or only something without its verb.
    None,
    /// That it cannot be done.
    Refused,
    /// Nothing is to be done.
    Answered,
    /// What is to be done, or what is to be known first.
    Asked,
}

const fn worth(understanding: &Understanding) -> Worth {
    match understanding {
        Understanding::Refusal { is_lost: true, .. }
        | Understanding::Question { kind: Clarification::Request | Clarification::Appearance, .. } => Worth::None,
        Understanding::Refusal { .. } => Worth::Refused,
        Understanding::Answer { .. } => Worth::Answered,
        Understanding::Plan { .. } | Understanding::Question { .. } | Understanding::Stop { .. } => Worth::Asked,
    }
}

/// How likely a reading must be for its steps to be taken without a question.
fn chance_to_act(steps: &[Step]) -> f32 {
    let changes = steps.iter().any(|step| matches!(step.action, Action::Interact { .. } | Action::Place { .. }));
    if changes { 0.5 } else { 0.4 }
}

/// Why nothing is done about a reading.
fn excuse(reading: &Reading) -> Option<String> {
    if let Some(words) = reading.requests.iter().find_map(unknown_words) {
        return Some(format!("I do not know how to {words}. {HINT}"));
    }
    let is_nothing = reading.requests.iter().all(|request| request.act == Act::None);
    is_nothing.then(|| format!("That is nothing that I can do. {HINT}"))
}

/// A request in plain words; nothing, if it is none that the robot knows.
fn sentence(request: &Request) -> Option<String> {
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

const fn small_talk(social: Social) -> &'static str {
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
