//! What people answer to questionnaires, told to the bus.

use std::sync::{Mutex, MutexGuard, PoisonError};

use cohabit_bus::{BusError, Publisher, Topic, Transport};

use crate::{
    questionnaire::{Given, NotAnswered, Questionnaire, When},
    text::in_one_line,
};

/// What is known of who has answered what, and of the mission.
pub trait Register {
    /// Whether a visitor has answered a questionnaire.
    fn has_answered(&self, visitor: u32, questionnaire: &str) -> bool;
    /// Notes that a visitor has.
    fn note_answered(&self, visitor: u32, questionnaire: &str);
    /// Whether there is a mission that is not over.
    fn is_mission_running(&self) -> bool;
}

/// What a page answers.
pub struct Form<'a> {
    /// The questionnaire.
    pub questionnaire: &'a str,
    /// An answer to each question.
    pub given: &'a [Option<Given>],
    /// Whether the person says that they have finished, though the mission is not over.
    pub finished: bool,
}

/// The questionnaires of a session, with their end on the bus.
pub struct Survey {
    questionnaires: Vec<Questionnaire>,
    answers: Mutex<Box<dyn Publisher>>,
}

impl Survey {
    /// Asks these.
    pub fn new(bus: &dyn Transport, questionnaires: Vec<Questionnaire>) -> Result<Self, BusError> {
        Ok(Self { questionnaires, answers: Mutex::new(bus.publisher(Topic::Answers)?) })
    }

    /// Tells the bus what a visitor answers to a questionnaire, all at once or nothing. Each visitor answers each
    /// questionnaire once. One that is asked after the mission is answered when that is over, or when the visitor says
    /// that they have finished.
    ///
    /// # Errors
    /// [`NotAnswered`], with what to tell the visitor.
    pub fn answer(&self, visitor: u32, form: &Form<'_>, register: &dyn Register) -> Result<(), NotAnswered> {
        let name = form.questionnaire;
        let asked = self.questionnaires.iter().find(|one| one.name == name);
        let asked =
            asked.ok_or_else(|| NotAnswered::new(format!("There is no questionnaire {}.", in_one_line(name))))?;
        // Held to the end: of two answers at once one is the first.
        let mut answers = self.lock();
        if register.has_answered(visitor, name) {
            return Err(NotAnswered::new("You have answered this already; your first answers count.".to_owned()));
        }
        if asked.when == When::After && !form.finished && register.is_mission_running() {
            return Err(NotAnswered::new("The mission is not over yet: this is asked afterwards.".to_owned()));
        }
        let messages = asked.answered(visitor, form.given)?;
        messages.iter().try_for_each(|message| answers.send_record(0, message).map(drop)).map_err(|error| {
            tracing::error!("answers to {name}: {error}");
            NotAnswered::new("The session cannot be reached; please try again.".to_owned())
        })?;
        register.note_answered(visitor, name);
        Ok(())
    }

    /// Tells what was answered to peers that joined.
    pub fn update(&self) -> Result<(), BusError> {
        self.lock().update()
    }

    fn lock(&self) -> MutexGuard<'_, Box<dyn Publisher>> {
        self.answers.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::{
        cell::{Cell, RefCell},
        collections::BTreeSet,
    };

    use cohabit_bus::{Inbox, Local, message, message::AnswerMessage};

    use super::*;

    #[derive(Default)]
    struct Noted {
        answered: RefCell<BTreeSet<(u32, String)>>,
        is_running: Cell<bool>,
    }

    impl Register for Noted {
        fn has_answered(&self, visitor: u32, questionnaire: &str) -> bool {
            self.answered.borrow().contains(&(visitor, questionnaire.to_owned()))
        }

        fn note_answered(&self, visitor: u32, questionnaire: &str) {
            self.answered.borrow_mut().insert((visitor, questionnaire.to_owned()));
        }

        fn is_mission_running(&self) -> bool {
            self.is_running.get()
        }
    }

    fn questionnaire(name: &str, when: &str) -> Questionnaire {
        let text = format!("title = 'T'\nwhen = '{when}'\n[[item]]\nask = 'Why?'\nwords = true");
        Questionnaire::read(name, name, &text).unwrap()
    }

    #[test]
    fn the_first_answers_count_and_afterwards_is_not_before() {
        let bus = Local::new(1);
        let mut inbox = Inbox::new(&bus, Topic::Answers).unwrap();
        let survey = Survey::new(&bus, vec![questionnaire("first", "before"), questionnaire("last", "after")]).unwrap();
        let noted = Noted::default();
        noted.is_running.set(true);
        let answer = |visitor: u32, questionnaire: &str, text: &str, finished: bool| {
            let given = [Some(Given::Text(text.to_owned()))];
            let form = Form { questionnaire, given: &given, finished };
            survey.answer(visitor, &form, &noted).map_err(|problem| problem.to_string())
        };
        let refused =
            |told: Result<(), String>, part: &str| assert!(told.is_err_and(|told| told.contains(part)), "{part}");
        refused(answer(1, "none", "x", false), "no questionnaire none");
        assert_eq!(answer(1, "first", "one", false), Ok(()));
        refused(answer(1, "first", "two", false), "already");
        assert_eq!(answer(2, "first", "three", false), Ok(()));
        refused(answer(1, "last", "four", false), "not over");
        assert_eq!(answer(1, "last", "five", true), Ok(()), "who has finished says so");
        noted.is_running.set(false);
        refused(answer(1, "last", "six", false), "already");
        refused(answer(2, "last", " ", false), "no answer yet");
        assert_eq!(answer(2, "last", "seven", false), Ok(()));
        let mut told = Vec::new();
        while let Some((_, answer)) = inbox.next(|sample| message::read::<AnswerMessage>(sample.payload())).unwrap() {
            told.push((answer.person, answer.text.as_str().to_owned()));
        }
        let expected = [(1, "one"), (2, "three"), (1, "five"), (2, "seven")];
        assert_eq!(told, expected.map(|(visitor, text)| (visitor, text.to_owned())));
    }
}
