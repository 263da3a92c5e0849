//! What people say for a mission of the generator to be done: where to go, what to take, and what its goals ask for.

use cohabit_cdf::{
    ActionKind, RoomId,
    goal::{GoalState, Predicate},
};
use cohabit_generate::PlannedStep;
use cohabit_world::World;

use crate::meaning::Meaning;

/// What is wanted, one thing at a time, in a world as it begins; none where there are no words for a goal. `plan` is one that meets
/// all goals: it says with what.
pub(super) fn script(world: &World, plan: &[PlannedStep]) -> Option<Vec<Meaning>> {
    let mut script = Script { world, plan, at: Some(world.mission().start_room), held: None, lines: Vec::new() };
    for state in world.mission().goals.iter().flat_map(|goal| &goal.states) {
        let meaning = Meaning::of_goal(state, world.mission(), world.catalog()).or_else(|| script.pour(state))?;
        script.add(meaning)?;
    }
    Some(script.lines)
}

struct Script<'a> {
    world: &'a World,
    plan: &'a [PlannedStep],
    /// Where people last sent the robot; none where it went by itself since.
    at: Option<RoomId>,
    held: Option<String>,
    lines: Vec<Meaning>,
}

impl<'a> Script<'a> {
    /// A fluid that no sink has comes out of something else.
    fn pour(&self, state: &GoalState) -> Option<Meaning> {
        let Predicate::Filled(_) = &state.predicate else { return None };
        let (from, into) = (self.tool(ActionKind::Pour)?.to_owned(), state.instance.0.clone());
        Some(Meaning::Pour { from, into })
    }

    fn add(&mut self, meaning: Meaning) -> Option<()> {
        match &meaning {
            Meaning::GoTo { .. } => {}
            Meaning::PickUp { object } => return self.take(object),
            Meaning::Scan { object } | Meaning::TurnOn { device: object } => self.go(object)?,
            Meaning::Break { object } => {
                self.take(self.tool(ActionKind::Break)?)?;
                self.go(object)?;
            }
            Meaning::Pour { from, into } => {
                self.take(from)?;
                self.go(into)?;
            }
            Meaning::Place { object, receptacle } | Meaning::Insert { object, device: receptacle } => {
                self.take(object)?;
                self.go(receptacle)?;
                self.held = None;
            }
            Meaning::Clean { object }
            | Meaning::Fill { object }
            | Meaning::Heat { object }
            | Meaning::Cool { object }
            | Meaning::Repair { object }
            | Meaning::Color { object, .. } => {
                self.take(object)?;
                // It goes to the machine by itself.
                self.at = None;
            }
        }
        self.lines.push(meaning);
        Some(())
    }

    /// Sends the robot to the room of a thing, where it is not there.
    fn go(&mut self, instance: &str) -> Option<()> {
        let room = self.world.object(self.world.find(instance)?)?.room;
        if self.at.replace(room) != Some(room) {
            let name = room.name_in(self.world.catalog()).to_owned();
            self.lines.push(Meaning::GoTo { room, name });
        }
        Some(())
    }

    /// Has a thing taken, where it is not in its hand.
    fn take(&mut self, instance: &str) -> Option<()> {
        if self.held.as_deref() != Some(instance) {
            self.go(instance)?;
            self.lines.push(Meaning::PickUp { object: instance.to_owned() });
            self.held = Some(instance.to_owned());
        }
        Some(())
    }

    /// What the plan has in its hand for an action of that kind.
    fn tool(&self, kind: ActionKind) -> Option<&'a str> {
        let at = self.plan.iter().position(|step| step.action == kind.name())?;
        let taken = self.plan[..at].iter().rfind(|step| step.action == ActionKind::PickUp.name())?;
        Some(&taken.object)
    }
}
