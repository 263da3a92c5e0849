//! What people answer to questionnaires, told to the bus.

use std::sync::{Mutex, MutexGuard, PoisonError};

use cohabit_bus::{BusError, Publisher, Topic, Transport};

use crate::questionnaire::{Given, NotAnswered, Questionnaire};

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

    /// Tells the bus what a person answers to the questionnaire of that name, all at once or nothing.
    pub fn answer(&self, person: u32, name: &str, given: &[Option<Given>]) -> Result<(), NotAnswered> {
        let asked = self.questionnaires.iter().find(|one| one.name == name);
        let asked = asked.ok_or_else(|| NotAnswered::new(format!("There is no questionnaire {name}.")))?;
        let messages = asked.answered(person, given)?;
        let mut answers = self.lock();
        messages.iter().try_for_each(|message| answers.send_record(0, message).map(drop)).map_err(|error| {
            tracing::error!("answers to {name}: {error}");
            NotAnswered::new("The session cannot be reached; please try again.".to_owned())
        })
    }

    /// Tells what was answered to peers that joined.
    pub fn update(&self) -> Result<(), BusError> {
        self.lock().update()
    }

    fn lock(&self) -> MutexGuard<'_, Box<dyn Publisher>> {
        self.answers.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
