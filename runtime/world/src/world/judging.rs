//! Goals, the story, and what comes and goes through time.

use std::sync::Arc;

use cohabit_cdf::mission::MessageTime;

use super::World;
use crate::{
    goals::{self, GoalChange},
    report::{Ending, Event},
    story,
    works::portal,
};

impl World {
    /// Takes down which goals are met, and whether the mission is over.
    pub(super) fn judge(&mut self, events: &mut Vec<Event>) {
        let mission = Arc::clone(&self.mission);
        for change in goals::judge(&self.facts(), &mission) {
            match change {
                GoalChange::Met(index) => {
                    let id = mission.goals[index].id;
                    self.state.goals[index].met = true;
                    events.push(Event::GoalMet { id });
                    self.say(&MessageTime::GoalMet(id), events);
                }
                GoalChange::Reset(index) => {
                    self.state.goals[index].met = false;
                    events.push(Event::GoalReset { id: mission.goals[index].id });
                }
                GoalChange::Shown(index) => {
                    self.state.goals[index].shown = true;
                    events.push(Event::GoalShown { id: mission.goals[index].id });
                }
            }
        }
        let all_met = !self.state.goals.is_empty() && self.state.goals.iter().all(|goal| goal.met);
        if all_met && self.state.ended.is_none() {
            self.state.ended = Some((self.state.tick, Ending::AllGoalsMet));
            events.push(Event::MissionEnded { ending: Ending::AllGoalsMet });
            self.say(&MessageTime::Ending, events);
        }
    }

    /// Tells what the mission has to say then.
    pub(super) fn say(&self, when: &MessageTime, events: &mut Vec<Event>) {
        events.extend(story::due(&self.facts(), &self.mission, when));
    }

    /// What flies into portals goes through, dinosaurs eat, what was away comes, and what waits for that is told.
    pub(super) fn cross_times(&mut self, events: &mut Vec<Event>) {
        if !self.state.portals.is_empty() && self.state.physics.moving().next().is_some() {
            let effects = portal::swallowed(&self.facts());
            self.changes(events).apply(effects);
        }
        let hungry = self.state.dinosaurs.keys().any(|dino| !self.state.portals.contains_key(dino));
        if hungry {
            let effects = portal::meals(&self.facts());
            self.changes(events).apply(effects);
        }
        if !self.state.away.is_empty() {
            let coming = story::arrivals(&self.facts(), &self.mission);
            for object in coming {
                // What came before it has its place by now.
                let effect = story::arrival(&self.facts(), object);
                self.changes(events).apply(effect.into_iter().collect());
            }
        }
        let (due, now) = story::on_occasions(&self.facts(), &self.mission);
        events.extend(due);
        self.state.occasions = now;
    }
}
