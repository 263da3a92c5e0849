//! What the experimenter has happen while participants play: a mission stands still and goes on, and somebody is told something. It is noted,
//! with its time, before it happens. It does not outlast the server: a session that is started again goes on.

use crate::{
    folder::Note,
    plan::pseudonym,
    probe::Probed,
    progress::Doing,
    registry::{Participant, Registry, StudyFault},
};

impl Registry {
    /// Keeps a note of the experimenter's, about somebody or nobody.
    pub(crate) fn keep_note(&mut self, participant: Option<String>, text: String) -> Result<(), StudyFault> {
        let note = Note { at_ms: self.clock.now_ms(), participant, text };
        self.folder.note(&note)?;
        self.notes.push(note);
        Ok(())
    }

    /// Has the mission that somebody plays stand still or go on, for all who play it.
    pub(crate) fn pause(&mut self, place: u32, is_paused: bool) -> Result<(), StudyFault> {
        let mission = self.participants.get(&place).and_then(|one| one.progress.mission());
        let Some((step, _, Doing::Playing)) = mission else {
            return Err(StudyFault::NotNow(format!("{} plays no mission at the moment.", pseudonym(place))));
        };
        let text = if is_paused { "The mission is paused." } else { "The mission goes on." };
        self.keep_note(Some(pseudonym(place)), text.to_owned())?;
        for place in self.playmate(place).into_iter().chain([place]) {
            if let Some(participant) = self.participants.get_mut(&place) {
                participant.paused = is_paused.then_some(step);
            }
        }
        Ok(())
    }

    /// Shows somebody a message, in place of the one before.
    pub(crate) fn tell_participant(&mut self, place: u32, text: String) -> Result<(), StudyFault> {
        let takes_part = |one: &Participant| !one.progress.phase().is_out();
        let Some(before) = self.participants.get(&place).filter(|one| takes_part(one)).map(|one| one.told.as_ref())
        else {
            return Err(StudyFault::NotNow(format!("{} does not take part at the moment.", pseudonym(place))));
        };
        let number = before.map_or(1, |(number, _)| number + 1);
        self.keep_note(Some(pseudonym(place)), format!("Message: {text}"))?;
        if let Some(participant) = self.participants.get_mut(&place) {
            participant.told = Some((number, text));
        }
        Ok(())
    }

    /// Whether the mission that somebody plays stands still: the experimenter has paused it, or a question is open that has it stand still; of
    /// a pair, one that either is asked.
    pub(crate) fn stands_still(&self, place: u32) -> bool {
        let waits = |probed: &Probed| {
            probed.answer.is_none() && self.study.probes.get(probed.probe).is_some_and(|probe| probe.pauses)
        };
        let holds = |one: &Participant| one.is_paused() || one.progress.probed().iter().any(waits);
        let holds = |place: u32| self.participants.get(&place).is_some_and(holds);
        holds(place) || self.playmate(place).is_some_and(holds)
    }
}

impl Participant {
    /// Whether the experimenter has paused the mission that they play.
    pub(crate) fn is_paused(&self) -> bool {
        let playing = match self.progress.mission() {
            Some((step, _, Doing::Playing)) => Some(step),
            _ => None,
        };
        playing.is_some() && self.paused == playing
    }
}
