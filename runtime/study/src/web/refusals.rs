//! What people read where something did not happen, in the language of the study.

use cohabit_dialog::{NotAnswered, PageTexts};
use serde_json::{Value, json};

use crate::{progress::Refused, registry::StudyFault};

/// What did not happen, for the page; what the experimenter must know of it goes to the terminal.
pub(crate) fn told(fault: &StudyFault, texts: &PageTexts) -> Value {
    match fault {
        StudyFault::Journal(error) => tracing::error!("{error}"),
        StudyFault::Folder(error) => tracing::error!("{error}"),
        StudyFault::Refused(refused) => return json!(refusal(*refused, texts)),
        StudyFault::NotNow(text) => return json!(text),
    }
    json!(texts.study_text("not_saved"))
}

/// What people read where something cannot happen now.
fn refusal(refused: Refused, texts: &PageTexts) -> &str {
    match refused {
        Refused::OutOfTurn => texts.study_text("out_of_turn"),
        Refused::Withdrawn => texts.study_text("withdrawn"),
        Refused::TooManyDrafts => texts.study_text("drafts_full"),
        Refused::TooLong => texts.study_text("text_too_long"),
        Refused::LeftToTry => texts.study_text("left_to_try"),
        Refused::NotSkippable => texts.study_text("not_skippable"),
        Refused::PartnerAwaited => texts.study_text("partner_waiting"),
    }
}

/// What a participant reads of answers that cannot be taken.
pub(crate) fn not_answered(problem: &NotAnswered, texts: &PageTexts) -> StudyFault {
    StudyFault::NotNow(match problem {
        NotAnswered::Missing { question } => {
            texts.study_text("question_unanswered").replace("{number}", &question.to_string())
        }
        NotAnswered::TooLong { question, characters, most } => {
            let numbers = [("{number}", *question as usize), ("{count}", *characters), ("{most}", *most)];
            let text = texts.study_text("answer_too_long").to_owned();
            numbers.iter().fold(text, |text, (name, number)| text.replace(name, &number.to_string()))
        }
        NotAnswered::Other(_) => texts.study_text("out_of_turn").to_owned(),
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn refusals_are_in_the_language_of_the_study() {
        let all = [
            Refused::OutOfTurn,
            Refused::Withdrawn,
            Refused::TooManyDrafts,
            Refused::TooLong,
            Refused::LeftToTry,
            Refused::NotSkippable,
            Refused::PartnerAwaited,
        ];
        let english = PageTexts::default();
        for texts in ["de", "es"].map(|language| PageTexts::of(language).unwrap()) {
            for refused in all {
                let fault = StudyFault::from(refused);
                let (own, model) = (told(&fault, &texts), told(&fault, &english));
                assert!(own != model && own != "" && model != "", "{refused:?}: {own}");
            }
        }
        let german = PageTexts::of("de").unwrap();
        let answer = |problem| not_answered(&problem, &german).to_string();
        assert_eq!(answer(NotAnswered::Missing { question: 3 }), "Frage 3 ist noch nicht beantwortet.");
        let long = answer(NotAnswered::TooLong { question: 3, characters: 2345, most: 2000 });
        assert!(["Frage 3", "2345", "2000"].iter().all(|part| long.contains(part)) && !long.contains('{'), "{long}");
    }
}
