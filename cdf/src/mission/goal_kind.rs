//! All that goals can ask for, with an example of each: for lists and guides.

use super::{expression::KINDS, goals::KEYS};
use crate::{
    catalog::Property,
    flag_key::{flag_key, property_of},
    state::StateFlag,
};

/// Where a mission file says it.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum GoalForm {
    /// In a goal's `object_states`.
    State,
    /// In the `expression` of one of its `stateconditions`.
    Expression,
}

/// One thing that goals can ask for.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct GoalKind {
    /// Its key.
    pub key: &'static str,
    /// Where it stands.
    pub form: GoalForm,
    /// As a mission file writes it (JSON).
    pub example: String,
    /// When it holds, in a sentence.
    pub meaning: &'static str,
    /// What an object must afford for it to hold at any time, if anything.
    pub needs: Option<Property>,
}

/// All of them: states of objects first, then kinds of expressions. Each state that is true or false is a kind of expression,
/// too: `{"isHot": {"target": "Bowl_01_1", "value": true}}`.
pub fn goal_kinds() -> impl Iterator<Item = GoalKind> {
    let flags = StateFlag::ALL.into_iter().map(of_flag);
    let states = KEYS.into_iter().map(|key| {
        let (text, meaning, needs) = of_key(key);
        GoalKind { key, form: GoalForm::State, example: text.to_owned(), meaning, needs }
    });
    let expressions = KINDS.into_iter().map(|key| {
        let (text, meaning) = of_kind(key);
        GoalKind { key, form: GoalForm::Expression, example: text.to_owned(), meaning, needs: None }
    });
    flags.chain(states).chain(expressions)
}

fn of_flag(flag: StateFlag) -> GoalKind {
    let (instance, meaning) = match flag {
        StateFlag::PickedUp => ("Apple_1", "A robot or a person holds it."),
        StateFlag::Opened => ("FridgeLower_02_1", "It is open."),
        StateFlag::Broken => ("Bowl_01_1", "It is broken."),
        StateFlag::Toggled => ("Microwave_01_1", "It is switched on."),
        StateFlag::Powered => ("Microwave_01_1", "Its circuit feeds it."),
        StateFlag::Overloaded => ("V_Monitor_Laser_1", "It is locked until the room's power was off and on again."),
        StateFlag::Sparking => ("Broken_Cord_01_1", "It throws sparks, and electrocutes who touches it."),
        StateFlag::Dirty => ("FoodPlate_01_1", "It is dirty."),
        StateFlag::Eaten => ("Apple_1", "It was eaten."),
        StateFlag::Hot => ("Bowl_01_1", "It was heated."),
        StateFlag::Cold => ("Bowl_01_1", "It was cooled."),
        StateFlag::Cooked => ("BreadSlice_01_1", "It was cooked."),
        StateFlag::Cut => ("BreadLoaf_1", "It was cut."),
        StateFlag::Infected => ("V_Monitor_Laser_1", "It has a virus."),
        StateFlag::Scanned => ("Bowl_01_1", "A robot scanned it."),
        StateFlag::Examined => ("Bowl_01_1", "Somebody examined it."),
        StateFlag::Used => ("Hammer_1", "Somebody used it as a tool or machine."),
        StateFlag::Embiggenated => ("Apple_1", "The embiggenator made it large."),
        StateFlag::Locked => ("FridgeLower_02_1", "It does not open."),
        StateFlag::Cereal => ("Bowl_01_1", "Cereal is in it."),
        StateFlag::Neutral => ("TAMPrototypeHead_01_1", "Its face shows no feeling."),
        StateFlag::Happy => ("TAMPrototypeHead_01_1", "Its face is happy."),
        StateFlag::Sad => ("TAMPrototypeHead_01_1", "Its face is sad."),
        StateFlag::Angry => ("TAMPrototypeHead_01_1", "Its face is angry."),
        StateFlag::Scared => ("TAMPrototypeHead_01_1", "Its face is scared."),
        StateFlag::Wet => ("Towel_1", "It is wet through: laundry and plants of the pack `homes`."),
        StateFlag::Creased => ("Shirt_1", "It is creased: laundry of the pack `homes`."),
        StateFlag::Folded => ("Shirt_1", "It is folded: laundry of the pack `homes`."),
    };
    let key = flag_key(flag);
    let example = format!("{{\"{instance}\": \"{key}=true\"}}");
    GoalKind { key, form: GoalForm::State, example, meaning, needs: property_of(flag) }
}

/// The example, the meaning, and what an object must afford, of one of [`KEYS`].
fn of_key(key: &str) -> (&'static str, &'static str, Option<Property>) {
    match key {
        "isFilled" => (
            r#"{"Bowl_01_1": "isFilled=Milk"}"#,
            "This fluid is in it: `Water`, `Milk` or `Coffee`, `None` for nothing, `true` for any.",
            Some(Property::Fillable),
        ),
        "ContainsFluid" => {
            (r#"{"Bowl_01_1": "ContainsFluid=Water"}"#, "The same as `isFilled`.", Some(Property::Fillable))
        }
        "isEmpty" => (r#"{"Bowl_01_1": "isEmpty=true"}"#, "Nothing is in or on it, neither things nor a fluid.", None),
        "Contains" => (
            r#"{"FridgeLower_02_1": "Contains=Apple_1"}"#,
            "That thing is in or on it, also within something else there. `Apple_*` means any apple.",
            Some(Property::Receptacle),
        ),
        "ColorMetaDataChange" => (
            r#"{"Bowl_01_1": "ColorMetaDataChange=Red"}"#,
            "It was given this colour: `Red`, `Green` or `Blue`, `Original` for none of them.",
            None,
        ),
        _ => ("", "", None),
    }
}

/// The example and the meaning of one of [`KINDS`].
fn of_kind(kind: &str) -> (&'static str, &'static str) {
    match kind {
        "AND" => (
            r#"{"AND": {"expressions": [{"isHot": {"target": "Bowl_01_1"}}, {"isDirty": {"target": "FoodPlate_01_1"}}]}}"#,
            "All of these hold.",
        ),
        "OR" => (
            r#"{"OR": {"expressions": [{"isHot": {"target": "Bowl_01_1"}}, {"isCold": {"target": "Bowl_01_1"}}]}}"#,
            "Any of these holds.",
        ),
        "NOT" => (r#"{"NOT": {"expression": {"isOpen": {"target": "FridgeLower_02_1"}}}}"#, "This does not hold."),
        "Contains" => (
            r#"{"Contains": {"target": "FridgeLower_02_1", "contains": "Apple_1"}}"#,
            "The target contains that thing, at any depth.",
        ),
        "isFilledWith" => {
            (r#"{"isFilledWith": {"target": "Bowl_01_1", "fluid": "Milk"}}"#, "This fluid is in the target.")
        }
        "isFilled" => (
            r#"{"isFilled": {"target": "Bowl_01_1", "value": true}}"#,
            "Some fluid is in the target; or the one named.",
        ),
        "CanBeSeen" => (
            r#"{"CanBeSeen": {"target": "Apple_1", "distance": 2.0}}"#,
            "A robot or a person sees the target from no more than so many metres.",
        ),
        "IsInRange" => (
            r#"{"IsInRange": {"target": "Apple_1", "value": 1.5}}"#,
            "A robot or a person is no more than so many metres from the target.",
        ),
        "ColorMetaDataChange" => (
            r#"{"ColorMetaDataChange": {"target": "Bowl_01_1", "colorvalue": "Red"}}"#,
            "The target was given this colour.",
        ),
        "DinoFed" => (
            r#"{"DinoFed": {"target": "ActionFigure_1", "isFed": true}}"#,
            "What this dinosaur eats (its `dinoFood`) was given to it.",
        ),
        "IsReceptacle" => (
            r#"{"IsReceptacle": {"target": "FridgeLower_02_1", "value": true}}"#,
            "Other things can be put into or onto the target.",
        ),
        "isFullOfItems" => {
            (r#"{"isFullOfItems": {"target": "FridgeLower_02_1", "value": true}}"#, "Each place in or on it is taken.")
        }
        _ => ("", ""),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use serde_json::{Value, json};

    use super::*;
    use crate::{WorldData, WorldPack, mission::read_mission};

    /// The things that examples name.
    const THINGS: [&str; 14] = [
        "ActionFigure_1",
        "Apple_1",
        "Bowl_01_1",
        "BreadLoaf_1",
        "BreadSlice_01_1",
        "Broken_Cord_01_1",
        "FoodPlate_01_1",
        "FridgeLower_02_1",
        "Hammer_1",
        "Microwave_01_1",
        "Shirt_1",
        "TAMPrototypeHead_01_1",
        "Towel_1",
        "V_Monitor_Laser_1",
    ];

    #[test]
    fn every_example_can_be_read_as_a_goal() {
        // Some states are of things of that pack alone.
        let world = WorldData::layered(vec![WorldPack::builtin("homes").unwrap()]).unwrap();
        for GoalKind { key, form, example, meaning, .. } in goal_kinds() {
            assert!(!meaning.is_empty(), "{key} is not explained");
            let written: Value = serde_json::from_str(&example).unwrap();
            let objects: Vec<Value> = THINGS.iter().map(|name| json!({ "name": name })).collect();
            let (states, conditions) = match form {
                GoalForm::State => (written, json!([])),
                GoalForm::Expression => {
                    let condition = json!({ "stateName": "Own", "context": "Apple_1", "expression": written });
                    (json!({ "Apple_1": "Own=true" }), json!([condition]))
                }
            };
            let mission = json!({
                "scene": { "required_objects": objects },
                "task_goals": [{ "goal_id": 0, "object_states": [states] }],
                "stateconditions": conditions,
            });
            let read = read_mission("m.json", &mission.to_string(), world.catalog());
            let checked = read.unwrap_or_else(|problems| panic!("{key}: {problems}"));
            assert_eq!(checked.mission.goals[0].states.len(), 1, "{key}");
        }
    }

    #[test]
    fn each_key_is_there_once_in_each_form() {
        let kinds: Vec<_> = goal_kinds().map(|kind| (kind.key, kind.form)).collect();
        assert_eq!(kinds.len(), StateFlag::ALL.len() + KEYS.len() + KINDS.len());
        for (index, kind) in kinds.iter().enumerate() {
            assert!(!kinds[..index].contains(kind), "{kind:?}");
        }
    }
}
