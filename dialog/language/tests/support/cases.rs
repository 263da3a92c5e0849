//! Sets of utterances with what should come of them: the files of `tests/utterances`.

use cohabit_cdf::Status;
use cohabit_language::{Known, Understanding};

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
        } else if let Some((said, expected)) = line.split_once(" -> ").filter(|_| !line.starts_with('#')) {
            let (said, expected) = (said.split(" / ").collect(), expected.split(" || ").map(str::trim).collect());
            cases.push(Case { kind, marks: marks.clone(), said, expected });
        }
    }
    cases
}

/// The conversation before the last utterance of a case, with all done that was asked for.
pub fn before(case: &Case<'_>) -> Talk {
    let mut talk = Talk::new(&case.marks);
    let Some((_, earlier)) = case.said.split_last() else { return talk };
    for said in earlier {
        let understanding = talk.language.understand(said, &talk.scene, &mut talk.context);
        if let Understanding::Plan { steps, .. } = &understanding {
            for step in steps {
                talk.context.note_outcome(step, Status::ActionSuccessful);
            }
            talk.scene = talk.language.expected(&talk.scene, steps);
        }
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
