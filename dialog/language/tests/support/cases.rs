//! Sets of utterances with what should come of them: the files of `tests/utterances`.
//!
//! A line is `said / said next -> outcome || another`, an outcome being steps (`take Apple_1, put TrashCan_01_1`), `? CANDIDATES`, `= words` or
//! `! words`; or `said => plain request || another`, where what the grammar makes of a plain request in the same scene should come of it
//! (`?` any question, `social` a reply, `none` nothing to be done).

use cohabit_cdf::{Action, GoToTarget, Verb};
use cohabit_language::{Clarification, Known, KnownObject, Step, Understanding};

use super::{Talk, text};

/// One line of a set.
pub struct Case<'a> {
    pub kind: &'a str,
    /// What is other than usual in the office.
    pub marks: Vec<&'a str>,
    /// What is said, one utterance after the other.
    pub said: Vec<&'a str>,
    /// What may come of the last of them.
    pub expected: Vec<&'a str>,
    /// Whether that is told by plain requests.
    pub is_plain: bool,
}

/// All cases of a set.
pub fn cases(set: &str) -> Vec<Case<'_>> {
    let (mut kind, mut marks, mut cases) = ("", Vec::new(), Vec::new());
    for line in set.lines().map(str::trim) {
        if let Some(named) = line.strip_prefix("# kind:") {
            kind = named.trim();
        } else if let Some(list) = line.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
            let list = list.strip_prefix("marks:").unwrap_or(list);
            marks = list.split(';').map(str::trim).filter(|mark| !mark.is_empty()).collect();
        } else if let Some((said, expected)) = line.split_once(" -> ").or(line.split_once(" => "))
            && !line.starts_with('#')
        {
            let is_plain = !line.contains(" -> ");
            let (said, expected) = (said.split(" / ").collect(), expected.split(" || ").map(str::trim).collect());
            cases.push(Case { kind, marks: marks.clone(), said, expected, is_plain });
        }
    }
    cases
}

/// What should come of an utterance.
pub enum Expected<'a> {
    /// One of these outcomes, as text.
    Outcome(Vec<&'a str>),
    /// What comes of one of these plain requests.
    Requests(Vec<Wanted>),
}

/// What comes of a plain request.
pub enum Wanted {
    /// These steps, which leave the scene like this.
    Plan(Vec<Step>, Known),
    /// Any question that is no guess.
    Question,
    /// That this is asked.
    Asked(String),
    /// An answer that says and points out this.
    Answer(String, Vec<cohabit_cdf::ObjectId>),
    /// That it cannot be done.
    Refusal,
    /// Any reply.
    Reply,
    /// That it stops.
    Stop,
    /// Anything but that something is done.
    Nothing,
}

impl<'a> Expected<'a> {
    /// What should come of the last utterance of a case after what was said before; nothing, where the grammar does not read its plain requests.
    pub fn new(case: &Case<'a>, talk: &Talk) -> Option<Self> {
        if !case.is_plain {
            return Some(Self::Outcome(case.expected.clone()));
        }
        let wanted: Vec<Wanted> = case.expected.iter().filter_map(|request| Wanted::new(request, talk)).collect();
        (!wanted.is_empty()).then_some(Self::Requests(wanted))
    }

    /// Whether that came of it.
    pub fn is_met(&self, understanding: &Understanding, talk: &Talk) -> bool {
        match self {
            Self::Outcome(expected) => {
                let found = found(understanding, &talk.scene);
                expected.iter().any(|expected| is_as(expected, understanding, &found))
            }
            Self::Requests(wanted) => wanted.iter().any(|wanted| wanted.is_met(understanding, talk)),
        }
    }
}

impl Wanted {
    /// What comes of a plain request; nothing, where the grammar does not read it.
    pub fn new(request: &str, talk: &Talk) -> Option<Self> {
        match request {
            "?" => return Some(Self::Question),
            "social" => return Some(Self::Reply),
            "none" => return Some(Self::Nothing),
            _ => {}
        }
        let mut context = talk.context.clone();
        match talk.language.understand_plain(request, &talk.scene, &mut context)? {
            Understanding::Plan { steps, .. } => {
                let end = talk.language.expected(&talk.scene, &steps);
                Some(Self::Plan(steps, end))
            }
            Understanding::Question { kind: Clarification::Request | Clarification::Appearance, .. }
            | Understanding::Refusal { is_lost: true, .. } => None,
            Understanding::Question { kind: Clarification::Confirmation, text, .. } => Some(Self::Asked(text)),
            Understanding::Question { .. } => Some(Self::Question),
            Understanding::Answer { text, highlight, .. } => Some(Self::Answer(text, highlight)),
            Understanding::Refusal { .. } => Some(Self::Refusal),
            Understanding::Stop { .. } => Some(Self::Stop),
        }
    }

    fn is_met(&self, understanding: &Understanding, talk: &Talk) -> bool {
        match (self, understanding) {
            (Self::Plan(wanted, end), Understanding::Plan { steps, .. }) => {
                deeds(wanted) == deeds(steps) && is_same_end(end, &talk.language.expected(&talk.scene, steps))
            }
            (Self::Question, Understanding::Question { kind, candidates, .. }) => {
                *kind != Clarification::Confirmation || !candidates.is_empty()
            }
            (Self::Asked(wanted), Understanding::Question { text, .. }) => wanted == text,
            (Self::Answer(wanted, pointed), Understanding::Answer { text, highlight, .. }) => {
                bare(wanted) == bare(text) || !pointed.is_empty() && pointed == highlight
            }
            (Self::Refusal, Understanding::Refusal { is_lost, .. }) => !is_lost,
            (Self::Reply, Understanding::Answer { .. }) | (Self::Stop, Understanding::Stop { .. }) => true,
            (Self::Nothing, understanding) => {
                !matches!(understanding, Understanding::Plan { .. } | Understanding::Stop { .. })
            }
            _ => false,
        }
    }
}

/// Without a yes or a no before it, which says the same.
fn bare(answer: &str) -> String {
    let rest = answer.strip_prefix("Yes, ").or_else(|| answer.strip_prefix("No, ")).unwrap_or(answer);
    rest.to_lowercase()
}

/// What is done that the scene does not show: steps that only bring the robot there, open and close things left out.
fn deeds(steps: &[Step]) -> Vec<String> {
    let is_deed = |step: &&Step| match step.action {
        Action::Interact { verb, .. } => !matches!(verb, Verb::Open | Verb::Close),
        Action::GoTo { .. } | Action::PickUp { .. } | Action::Place { .. } | Action::PlaceBeside { .. } => false,
        _ => true,
    };
    let mut deeds: Vec<String> = steps.iter().filter(is_deed).map(|step| format!("{:?}", step.action)).collect();
    // Whoever only goes somewhere does that.
    if deeds.is_empty() && steps.iter().all(|step| matches!(step.action, Action::GoTo { .. })) {
        let target = steps.last().map(|step| match step.action {
            Action::GoTo { target: GoToTarget::Object(object) } => format!("{object:?}"),
            other => format!("{other:?}"),
        });
        deeds.extend(target);
    }
    deeds.sort_unstable();
    deeds
}

fn is_same_end(one: &Known, other: &Known) -> bool {
    let states = |known: &Known| -> Vec<_> {
        let state = |object: &KnownObject| (object.id, object.parent, object.flags, object.fluid, object.color);
        known.objects.iter().map(state).collect()
    };
    one.robot.held == other.robot.held && states(one) == states(other)
}

/// The conversation before the last utterance of a case, with all done that was asked for.
pub fn before(case: &Case<'_>) -> Talk {
    let mut talk = Talk::new(&case.marks);
    let Some((_, earlier)) = case.said.split_last() else { return talk };
    for said in earlier {
        talk.say_and_do(said);
    }
    talk
}

/// What was understood as text, with the candidates of a question.
pub fn found(understanding: &Understanding, scene: &Known) -> String {
    let text = text(understanding, scene);
    let Understanding::Question { candidates, .. } = understanding else { return text };
    let names = candidates.iter().filter_map(|id| scene.object(*id)).map(|object| object.instance.as_str());
    let mut names: Vec<&str> = names.collect();
    names.sort_unstable();
    format!("{text} {names:?}")
}

/// Whether what was understood, as text, is what was expected.
pub fn is_as(expected: &str, understanding: &Understanding, found: &str) -> bool {
    let words =
        |text: &str| text.to_lowercase().split(|c: char| !c.is_alphanumeric()).map(str::to_owned).collect::<Vec<_>>();
    let has_all = |list: &str| {
        let found = words(found).join(" ");
        list.split(';').all(|part| {
            format!(" {found} ").contains(&format!(" {} ", words(part).join(" ").trim())) || part.trim().is_empty()
        })
    };
    match (expected.chars().next(), understanding) {
        (Some('?'), Understanding::Question { .. }) => {
            let mut wanted: Vec<&str> = expected[1..].split_whitespace().collect();
            wanted.sort_unstable();
            wanted.is_empty() || found.ends_with(&format!("{wanted:?}"))
        }
        (Some('='), Understanding::Answer { .. }) => has_all(&expected[1..]),
        (Some('!'), Understanding::Refusal { .. }) => has_all(&expected[1..]),
        (Some('?' | '=' | '!'), _) => false,
        _ => match expected.strip_suffix('…') {
            Some(start) => found.starts_with(start.trim_end()),
            None => found == expected,
        },
    }
}
