//! The way of two simulated people who play their missions together, from where both are to the end of it. Nothing is written down
//! here.

use super::{
    SimulateError,
    walk::{Setting, SimulatedMission, Walk},
};
use crate::{
    pair::{Pairing, PartnerAbsent, pair_label, pair_of},
    progress::{Event, Phase},
    session::{Whose, session_name},
};

/// What happens to two people; to one, if no other one came.
pub(super) struct PairWalk<'a> {
    setting: &'a Setting<'a>,
    pairing: Pairing,
    walks: Vec<Walk<'a>>,
}

impl<'a> PairWalk<'a> {
    /// The ways of these, the first at the first seat.
    pub fn new(setting: &'a Setting<'a>, pairing: Pairing, walks: Vec<Walk<'a>>) -> Self {
        Self { setting, pairing, walks }
    }

    /// Goes on to the end, or until one of them leaves, and what follows from that; gives what happens to each.
    pub fn run(mut self) -> Result<Vec<Vec<(u64, Event)>>, SimulateError> {
        loop {
            let ready = self.walks.iter_mut().map(|walk| walk.go_on(true)).collect::<Result<Vec<bool>, _>>()?;
            if ready != [true, true] {
                self.part(&ready)?;
                return Ok(self.walks.into_iter().map(Walk::into_events).collect());
            }
            self.mission()?;
        }
    }

    /// Both play the mission that they are at.
    fn mission(&mut self) -> Result<(), SimulateError> {
        self.walks.iter_mut().try_for_each(Walk::gets_ready)?;
        let at_ms = self.walks.iter().map(|walk| walk.at_ms).max().unwrap_or(0);
        let index = self.walks.iter().find_map(|walk| walk.progress.step_now()).map_or(0, |(index, ..)| index);
        for walk in &mut self.walks {
            walk.at_ms = at_ms;
            walk.happens(Event::StartedTogether { attempt: 1 })?;
        }
        let Some(wanted) = self.wanted(index) else { return Ok(()) };
        let session = self.setting.play(&wanted)?;
        self.walks.iter_mut().try_for_each(|walk| walk.lives_through(index, &session))
    }

    /// The session of both.
    fn wanted(&self, index: usize) -> Option<SimulatedMission> {
        let [first, second] = &self.walks[..] else { return None };
        let (own, others) = (first.wanted(index)?, second.wanted(index)?);
        let pair = pair_of(first.progress.plan().place);
        let name = session_name(Whose::Pair(pair), index, 1);
        let mut speaking = own.speaking;
        // They speak in turn.
        speaking.line_s = f64::midpoint(speaking.line_s, others.speaking.line_s);
        Some(SimulatedMission {
            participant: pair_label(pair),
            speaking,
            partner: Some(others.seeds[1]),
            is_heard: own.is_heard && others.is_heard,
            gives_up: own.gives_up || others.gives_up,
            log: self.setting.logs.log_path(&name),
            name,
            ..own
        })
    }

    /// One of them does not go on, or both have come to the end.
    fn part(&mut self, ready: &[bool]) -> Result<(), SimulateError> {
        let at_ms = self.walks.iter().map(|walk| walk.at_ms).max().unwrap_or(0);
        let has_left = |walk: &Walk<'_>| matches!(walk.progress.phase(), Phase::Withdrawn | Phase::Excluded);
        if self.walks.iter().any(has_left) {
            let mut others = self.walks.iter_mut().filter(|walk| walk.progress.is_under_way());
            return others.try_for_each(|walk| happens_at(walk, at_ms, Event::PartnerLeft));
        }
        let Some(waiting) = ready.iter().position(|is_ready| *is_ready) else { return Ok(()) };
        self.waits_in_vain(waiting)
    }

    /// One of them waits, and the other one does not come.
    fn waits_in_vain(&mut self, waiting: usize) -> Result<(), SimulateError> {
        let wait_s = self.pairing.wait_s;
        let walk = &mut self.walks[waiting];
        let Some((index, ..)) = walk.progress.step_now() else { return Ok(()) };
        walk.gets_ready()?;
        walk.passes(wait_s);
        let at_ms = walk.at_ms;
        let (own, others) = match self.pairing.partner_absent {
            PartnerAbsent::Wait => return Ok(()),
            PartnerAbsent::Alone => (Event::GoesAlone, Event::PartnerGoesAlone),
            PartnerAbsent::End => (Event::StopsWaiting, Event::PartnerLeft),
        };
        walk.happens(own)?;
        if walk.progress.is_alone() {
            walk.plays_alone(index)?;
            walk.go_on(false)?;
        }
        let partner = self.walks.iter_mut().enumerate().find(|(number, _)| *number != waiting);
        partner.map_or(Ok(()), |(_, partner)| happens_at(partner, at_ms, others))
    }
}

/// Something happens to somebody, at that time or later.
fn happens_at(walk: &mut Walk<'_>, at_ms: u64, event: Event) -> Result<(), SimulateError> {
    walk.at_ms = walk.at_ms.max(at_ms);
    walk.happens(event)
}
