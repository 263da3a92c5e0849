//! With whom participants play: who waits for whom in a study of pairs, and what one of a pair does that concerns the other.

use std::time::Instant;

use crate::{
    pair::{PartnerAbsent, SkippedBy, partner_of},
    plan::pseudonym,
    progress::{Doing, Ending, Event, Phase, Refused},
    registry::{Registry, StudyFault},
};

/// With whom somebody plays the mission that they are at.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Company {
    /// Nobody: there are no pairs, they go alone, or their partner has done it already.
    Nobody,
    /// Their partner, who waits for it, too.
    Partner(u32),
    /// Their partner, who is not ready for it, or not there.
    Awaited,
}

impl Registry {
    /// The place of somebody's partner, as long as they go on together.
    pub(crate) fn partner(&self, place: u32) -> Option<u32> {
        self.study.pairing.as_ref()?;
        let partner = partner_of(place);
        (!self.goes_alone(place) && !self.goes_alone(partner)).then_some(partner)
    }

    fn goes_alone(&self, place: u32) -> bool {
        self.participants.get(&place).is_some_and(|one| one.progress.is_alone())
    }

    /// Whether somebody takes no part any more who did.
    pub(crate) fn has_left(&self, place: u32) -> bool {
        self.gone.contains(&place) || self.participants.get(&place).is_some_and(|one| one.progress.phase().is_out())
    }

    /// With whom somebody plays the mission that they are at.
    pub(crate) fn company(&self, place: u32) -> Company {
        let own = self.participants.get(&place).and_then(|one| one.progress.step_now());
        let (Some(partner), Some((own, ..))) = (self.partner(place), own) else { return Company::Nobody };
        let Some(other) = self.participants.get(&partner) else { return Company::Awaited };
        match other.progress.phase() {
            Phase::Finished => Company::Nobody,
            Phase::At(step, _) if *step > own => Company::Nobody,
            Phase::At(step, Doing::Queued { .. }) if *step == own && other.is_here() => Company::Partner(partner),
            _ => Company::Awaited,
        }
    }

    /// Those who wait for a session, each with whom they play it, in the order in which they get one: whose session had ended too early
    /// comes first. Who waits for their partner is not among them.
    pub(crate) fn queue(&self) -> Vec<Vec<u32>> {
        let waits = |place: u32| {
            let one = self.participants.get(&place)?;
            match one.progress.phase() {
                Phase::At(_, Doing::Queued { again }) => Some((!again, one.queued)),
                _ => None,
            }
        };
        let party = |place: &u32| {
            let (is_new, queued) = waits(*place)?;
            match self.company(*place) {
                Company::Nobody => Some((is_new, queued, vec![*place])),
                // Once, for both.
                Company::Partner(partner) if *place < partner => {
                    let (is_partner_new, partner_queued) = waits(partner)?;
                    Some((is_new && is_partner_new, queued.max(partner_queued), vec![*place, partner]))
                }
                Company::Partner(_) | Company::Awaited => None,
            }
        };
        let mut waiting: Vec<_> = self.participants.keys().filter_map(party).collect();
        waiting.sort_unstable();
        waiting.into_iter().map(|(.., places)| places).collect()
    }

    /// Who plays the same session as somebody.
    pub(crate) fn playmate(&self, place: u32) -> Option<u32> {
        let step = |place: u32| self.participants.get(&place)?.progress.plays_together();
        let partner = partner_of(place);
        (self.study.pairing.is_some() && step(place).is_some() && step(place) == step(partner)).then_some(partner)
    }

    /// Whether somebody stands for the session that they play: of two, the first.
    pub(crate) fn stands_for_session(&self, place: u32) -> bool {
        self.playmate(place).is_none_or(|partner| place < partner)
    }

    /// How many sessions are played; one of two counts once.
    pub(crate) fn running(&self) -> usize {
        let playing = self.participants.iter().filter(|(_, one)| one.live.is_some());
        playing.filter(|(place, _)| self.stands_for_session(**place)).count()
    }

    /// What the one of a pair does is followed by the other: whoever is left without a partner comes to an end, or goes on alone.
    pub(crate) fn follow_partner(&mut self, place: u32) {
        if self.study.pairing.is_none() {
            return;
        }
        let (partner, own) = (partner_of(place), self.participants.get(&place).map(|one| &one.progress));
        if own.is_some_and(|own| own.is_under_way() && !own.is_alone()) {
            if self.goes_alone(partner) {
                self.note(place, &Event::PartnerGoesAlone);
            } else if self.has_left(partner) {
                self.note(place, &Event::PartnerLeft);
            }
        }
        let is_awaited = self.company(place) == Company::Awaited;
        if let Some(participant) = self.participants.get_mut(&place) {
            let is_queued = matches!(participant.progress.phase(), Phase::At(_, Doing::Queued { .. }));
            let waits = is_queued && is_awaited && participant.is_here();
            participant.waits_since = waits.then(|| participant.waits_since.unwrap_or_else(Instant::now));
        }
    }

    /// How long somebody has waited for their partner, s, if they do.
    pub(crate) fn waited_s(&self, place: u32) -> Option<f64> {
        Some(self.participants.get(&place)?.waits_since?.elapsed().as_secs_f64())
    }

    /// What somebody may do who has waited for their partner for so long that the experimenter is alarmed.
    pub(crate) fn may_instead(&self, place: u32) -> Option<PartnerAbsent> {
        let pairing = self.study.pairing.as_ref()?;
        (self.waited_s(place)? >= pairing.wait_s).then_some(pairing.partner_absent)
    }

    /// Says why somebody may not do that instead of waiting for their partner.
    pub(crate) fn check_may(&self, place: u32, wanted: PartnerAbsent) -> Result<(), StudyFault> {
        if self.may_instead(place) == Some(wanted) {
            return Ok(());
        }
        Err(Refused::PartnerAwaited.into())
    }

    /// Somebody wants to skip their mission: it is over for both of a pair, at once, or when both want to.
    pub(crate) fn skip(&mut self, place: u32) -> Result<(), StudyFault> {
        let (by, partner) = (self.study.pairing.as_ref().map(|pairing| pairing.skip), self.playmate(place));
        if let (Some(SkippedBy::Both), Some(partner)) = (by, partner)
            && !self.wants_to_skip(partner)
        {
            let Some(participant) = self.participants.get_mut(&place) else { return Ok(()) };
            if participant.progress.skip_in_s() != Some(0.0) {
                return Err(Refused::NotSkippable.into());
            }
            participant.skip_wanted = participant.progress.plays_together();
            return Ok(());
        }
        self.apply(place, &Event::Over { ending: Ending::Skipped })?;
        if let Some(partner) = partner {
            self.save_played(partner);
            self.apply(partner, &Event::PartnerSkipped)?;
        }
        Ok(())
    }

    /// Whether somebody wants to skip the mission that they play with their partner.
    pub(crate) fn wants_to_skip(&self, place: u32) -> bool {
        let wanted = |one: &crate::registry::Participant| {
            one.skip_wanted.is_some() && one.skip_wanted == one.progress.plays_together()
        };
        self.participants.get(&place).is_some_and(wanted)
    }

    /// Whose mission the experimenter ends when they end somebody's: that of both of a pair, so that these stay together.
    ///
    /// # Errors
    /// [`StudyFault::NotNow`], if the partner has yet to come to it.
    pub(crate) fn ended_with(&self, place: u32) -> Result<Vec<u32>, StudyFault> {
        let step = |place: u32| self.participants.get(&place)?.progress.step_now().map(|(index, ..)| index);
        let Some(partner) = self.partner(place) else { return Ok(vec![place]) };
        let has_finished = self.participants.get(&partner).is_some_and(|one| *one.progress.phase() == Phase::Finished);
        match (step(place), step(partner)) {
            (Some(own), Some(other)) if own == other => Ok(vec![place, partner]),
            (Some(own), Some(other)) if own > other => Err(not_at_it(partner)),
            (Some(_), None) if !has_finished => Err(not_at_it(partner)),
            _ => Ok(vec![place]),
        }
    }
}

fn not_at_it(partner: u32) -> StudyFault {
    let text = format!("{} is not at this mission yet: it can be ended once both are.", pseudonym(partner));
    StudyFault::NotNow(text)
}
