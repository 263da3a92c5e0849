//! Reads the goals of a mission.

use serde_json::Value;

use super::{
    NoteRequest,
    problem::Pointer,
    raw::{Loose, Scalar, TaskGoal, Visibility},
    reader::{GoalPlaces, Reader, shape},
};
use crate::{
    flag_key::{flag_keys, flag_of_key},
    goal::{Goal, GoalState, InstancePattern, Predicate, Relation, StateCondition},
    nearest::did_you_mean,
    state::StateFlag,
};

/// What `activationInteractable` says of a goal that nothing unlocks.
pub(super) const ALWAYS_UNLOCKED: &str = "ALWAYS UNLOCKED";

/// The class of notes, and what `activationInteractable` says of a goal that one of them unlocks.
const NOTE: &str = "StickyNote";

/// The keys of goals that are no flags.
pub(super) const KEYS: [&str; 5] = ["isFilled", "isEmpty", "Contains", "ContainsFluid", "ColorMetaDataChange"];

/// What goals may name.
pub(super) struct Named<'a> {
    pub conditions: &'a [StateCondition],
    pub notes: &'a [NoteRequest],
}

impl Reader<'_> {
    /// Reads `task_goals`; those without a number are left out.
    pub fn goals(&mut self, at: &Pointer, list: &Loose<Vec<Loose<TaskGoal>>>, named: &Named<'_>) -> Vec<Goal> {
        let mut goals: Vec<Goal> = Vec::new();
        for (at, raw) in self.items(at, list, "a goal") {
            let Some((goal, states)) = self.goal(&at, raw, named) else { continue };
            if goals.iter().any(|known| known.id == goal.id) {
                self.error(&at.key("goal_id"), format!("there is already a goal {}", goal.id), None);
                continue;
            }
            goals.push(goal);
            self.places.goals.push(GoalPlaces { goal: at, states });
        }
        if goals.is_empty() && list.misfit().is_none() {
            self.warn(at, "the mission has no goals: it never ends", None);
        }
        self.preconditions(&goals);
        goals
    }

    fn goal(&mut self, at: &Pointer, goal: &TaskGoal, named: &Named<'_>) -> Option<(Goal, Vec<Pointer>)> {
        self.extras(at, goal);
        let id = self.integer(&at.key("goal_id"), &goal.goal_id);
        if id.is_none() && goal.goal_id.misfit().is_none() && goal.goal_id.known().is_none() {
            self.error(&at.key("goal_id"), "the goal has no number", None);
        }
        let (places, states) = self.goal_states(&at.key("object_states"), goal, named).into_iter().unzip();
        let (hidden, unlocked_by) = self.visibility(&at.key("visibility"), &goal.visibility, named);
        let goal = Goal {
            description: self.text(&at.key("description"), &goal.description).unwrap_or_default(),
            states,
            relation: self.relation(&at.key("object_states_relation"), &goal.object_states_relation),
            preconditions: self.numbers(&at.key("preconditions"), &goal.preconditions),
            hidden,
            unlocked_by,
            can_reset: self.truth(&at.key("canReset"), &goal.can_reset, false),
            id: id?,
        };
        Some((goal, places))
    }

    fn goal_states(&mut self, at: &Pointer, goal: &TaskGoal, named: &Named<'_>) -> Vec<(Pointer, GoalState)> {
        let entries = self.items(at, &goal.object_states, "a state such as {\"Bowl_01_1\": \"isHot=true\"}");
        let mut states = Vec::new();
        for (at, entry) in &entries {
            for (instance, value) in *entry {
                let at = at.key(instance);
                states.extend(self.goal_state(&at, instance, value, named).map(|state| (at, state)));
            }
        }
        if states.is_empty() && entries.is_empty() && goal.object_states.misfit().is_none() {
            self.warn(at, "the goal asks for nothing", None);
        }
        states
    }

    pub(super) fn goal_state(
        &mut self,
        at: &Pointer,
        instance: &str,
        value: &Value,
        named: &Named<'_>,
    ) -> Option<GoalState> {
        self.reference(at, instance);
        let Some(text) = value.as_str() else {
            let remedy = Some("write a text such as `isHot=true`".to_owned());
            self.error(at, format!("expected `key=value`, found {}", shape(value)), remedy);
            return None;
        };
        let Some((key, value)) = text.split_once('=') else {
            self.error(at, format!("expected `key=value`, found `{text}`"), Some(format!("write `{text}=true`")));
            return None;
        };
        let predicate = self.predicate(at, key.trim(), &Scalar::Text(value.trim().to_owned()), named)?;
        Some(GoalState { instance: InstancePattern(instance.to_owned()), predicate })
    }

    pub(super) fn predicate(
        &mut self,
        at: &Pointer,
        key: &str,
        value: &Scalar,
        named: &Named<'_>,
    ) -> Option<Predicate> {
        if named.conditions.iter().any(|condition| condition.name == key) {
            self.named_conditions.insert(key.to_owned());
            return Some(Predicate::Condition(key.to_owned(), self.truth_of(at, value)?));
        }
        if self.unreadable.iter().any(|name| name == key) {
            return None;
        }
        match (key, flag_of_key(key)) {
            ("isFilled" | "ContainsFluid", _) if value.truth() == Some(true) => Some(Predicate::FilledWithAny),
            ("isFilled" | "ContainsFluid", _) => Some(Predicate::Filled(self.fluid(at, &value.text())?)),
            ("isEmpty", _) => Some(Predicate::Empty(self.truth_of(at, value)?)),
            ("ColorMetaDataChange", _) => Some(Predicate::Color(self.color(at, &value.text())?)),
            ("Contains", _) => {
                let contained = value.text();
                self.reference(at, &contained);
                Some(Predicate::Contains(InstancePattern(contained)))
            }
            (_, Some(StateFlag::Cereal)) => Some(Predicate::ContainsCereal(self.truth_of(at, value)?)),
            (_, Some(flag)) => Some(Predicate::Flag(flag, self.truth_of(at, value)?)),
            (_, None) => {
                let conditions = named.conditions.iter().map(|condition| condition.name.as_str());
                let keys: Vec<&str> = KEYS.into_iter().chain(flag_keys()).collect();
                let remedy = did_you_mean(key, conditions.chain(keys));
                self.error(at, format!("unknown key or condition `{key}`"), remedy);
                None
            }
        }
    }

    pub(super) fn relation(&mut self, at: &Pointer, field: &Loose<Scalar>) -> Relation {
        let text = self.text(at, field).unwrap_or_else(|| "and".to_owned());
        match text.to_ascii_lowercase().as_str() {
            "and" => Relation::And,
            "or" => Relation::Or,
            _ => {
                self.unknown(at, "relation", &text, ["and", "or"]);
                Relation::And
            }
        }
    }

    fn numbers(&mut self, at: &Pointer, list: &Loose<Vec<Scalar>>) -> Vec<i64> {
        let numbers = self.field(at, list, "a list of goal numbers").map_or(&[][..], Vec::as_slice);
        let mut firm = Vec::new();
        for (index, number) in numbers.iter().enumerate() {
            firm.extend(self.integer_of(&at.item(index), number));
        }
        firm
    }

    /// Whether a goal is hidden, and what unlocks it.
    fn visibility(&mut self, at: &Pointer, field: &Loose<Visibility>, named: &Named<'_>) -> (bool, Option<String>) {
        let Some(visibility) = self.field(at, field, "an object") else { return (false, None) };
        self.extras(at, visibility);
        let hidden = self.truth(&at.key("isHidden"), &visibility.is_hidden, false);
        let index = self.integer(&at.key("stickyNoteIndex"), &visibility.sticky_note_index).unwrap_or(0);
        let key_at = at.key("activationInteractable");
        let activation = self.text(&key_at, &visibility.activation_interactable);
        if !hidden {
            return (false, None);
        }
        let unlocked_by = match activation {
            Some(key) if key.eq_ignore_ascii_case(ALWAYS_UNLOCKED) => None,
            // The class alone: the note is told by its index.
            Some(key) if key.eq_ignore_ascii_case(NOTE) => self.note_of_index(&at.key("stickyNoteIndex"), index, named),
            Some(key) => {
                self.reference(&key_at, &key);
                Some(key)
            }
            None if visibility.sticky_note_index.known().is_some() => {
                self.note_of_index(&at.key("stickyNoteIndex"), index, named)
            }
            None => {
                let remedy = format!("name an object, `{NOTE}` with a `stickyNoteIndex`, or `{ALWAYS_UNLOCKED}`");
                self.error(&key_at, "nothing unlocks this hidden goal", Some(remedy));
                None
            }
        };
        (hidden, unlocked_by)
    }

    /// The note of that number: those of `sticky_notes` are counted first, then those among the objects.
    fn note_of_index(&mut self, at: &Pointer, index: i64, named: &Named<'_>) -> Option<String> {
        let stuck = named.notes.iter().map(|note| note.instance.as_str());
        let listed = self.listed.iter().map(String::as_str).filter(|name| name.starts_with(NOTE));
        let others = listed.filter(|name| named.notes.iter().all(|note| note.instance != **name));
        let notes: Vec<&str> = stuck.chain(others).collect();
        let note = usize::try_from(index).ok().and_then(|index| notes.get(index)).map(|note| (*note).to_owned());
        if note.is_none() {
            let message = format!("nothing unlocks this hidden goal: the mission has no sticky note of number {index}");
            let remedy = match notes.len() {
                0 => "add one to `sticky_notes`".to_owned(),
                1 => "the only one is number 0".to_owned(),
                count => format!("they are numbered from 0 to {}", count - 1),
            };
            self.error(at, message, Some(remedy));
        }
        note
    }

    /// Preconditions must be other goals, and must not wait for each other.
    fn preconditions(&mut self, goals: &[Goal]) {
        let places: Vec<_> = self.places.goals.iter().map(|places| places.goal.key("preconditions")).collect();
        for (at, goal) in places.iter().zip(goals) {
            for (index, wanted) in goal.preconditions.iter().enumerate() {
                if goals.iter().all(|goal| goal.id != *wanted) {
                    let ids: Vec<_> = goals.iter().map(|goal| goal.id.to_string()).collect();
                    let remedy = Some(format!("there are {}", ids.join(", ")));
                    self.error(&at.item(index), format!("there is no goal {wanted}"), remedy);
                }
            }
            if waits_for_itself(goal.id, goals) {
                self.error(at, format!("goal {} waits for itself", goal.id), None);
            }
        }
    }
}

fn waits_for_itself(id: i64, goals: &[Goal]) -> bool {
    let waits_for = |id: i64| goals.iter().find(|goal| goal.id == id).map_or(&[][..], |goal| &goal.preconditions);
    let mut open = waits_for(id).to_vec();
    let mut seen = Vec::new();
    while let Some(next) = open.pop() {
        if next == id {
            return true;
        }
        if !seen.contains(&next) {
            seen.push(next);
            open.extend(waits_for(next));
        }
    }
    false
}
