//! A mission file as it was written: every field of the format, in the shapes that real files have.
//!
//! Nothing here judges a file. A field that is absent, null or of an unexpected shape is kept as it is, and so is a
//! field that the format does not know, so that writing what was read gives the same values.

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, Serializer, de::DeserializeOwned};
use serde_json::{Map, Number, Value};

use super::schema;

/// An object with keys that the mission chose: `{"Bowl_01_1": "isHot=true"}`, `{"isOpen": "true"}`.
pub type Entry = Map<String, Value>;

/// A field that may be absent, of the expected shape, or something else.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Loose<T> {
    /// The field is not there.
    #[default]
    Absent,
    /// It has the expected shape.
    As(T),
    /// It is null, or of another shape.
    Else(Value),
}

impl<T> Loose<T> {
    /// Whether the field is not there.
    #[must_use]
    pub fn is_absent(&self) -> bool {
        matches!(self, Self::Absent)
    }

    /// Its value, if it has the expected shape.
    #[must_use]
    pub fn known(&self) -> Option<&T> {
        match self {
            Self::As(value) => Some(value),
            Self::Absent | Self::Else(_) => None,
        }
    }

    /// What was written, if it has an unexpected shape; null counts as absent.
    #[must_use]
    pub fn misfit(&self) -> Option<&Value> {
        match self {
            Self::Else(value) if !value.is_null() => Some(value),
            _ => None,
        }
    }
}

impl<'de, T: DeserializeOwned> Deserialize<'de> for Loose<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let value = Value::deserialize(deserializer)?;
        Ok(T::deserialize(&value).map_or_else(|_| Self::Else(value.clone()), Self::As))
    }
}

impl<T: Serialize> Serialize for Loose<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Absent => serializer.serialize_none(),
            Self::As(value) => value.serialize(serializer),
            Self::Else(value) => value.serialize(serializer),
        }
    }
}

/// A yes or no, a number or a text: files write `true`, `"true"`, `-1` and `"-1"` alike.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Scalar {
    /// Yes or no.
    Bool(bool),
    /// A number.
    Number(Number),
    /// A text.
    Text(String),
}

impl Scalar {
    /// The scalar in `value`, if it is one.
    #[must_use]
    pub fn of(value: &Value) -> Option<Self> {
        Self::deserialize(value).ok()
    }

    /// What it says, as text: `true`, `-1`, `Milk`.
    #[must_use]
    pub fn text(&self) -> String {
        match self {
            Self::Bool(value) => value.to_string(),
            Self::Number(value) => value.to_string(),
            Self::Text(value) => value.trim().to_owned(),
        }
    }

    /// Its truth: of `true`, `"True"`, `1` and `"1"`, and of their opposites.
    #[must_use]
    pub fn truth(&self) -> Option<bool> {
        match self.text().to_ascii_lowercase().as_str() {
            "true" | "1" | "1.0" => Some(true),
            "false" | "0" | "0.0" => Some(false),
            _ => None,
        }
    }

    /// Its value as a whole number.
    #[must_use]
    pub fn integer(&self) -> Option<i64> {
        match self {
            Self::Bool(_) => None,
            Self::Number(value) => value.as_i64().or_else(|| whole(value.as_f64()?)),
            Self::Text(value) => value.trim().parse().ok(),
        }
    }

    /// Its value as a finite number.
    #[must_use]
    pub fn number(&self) -> Option<f64> {
        let number = match self {
            Self::Bool(_) => None,
            Self::Number(value) => value.as_f64(),
            Self::Text(value) => value.trim().parse().ok(),
        };
        number.filter(|number: &f64| number.is_finite())
    }
}

/// `1.0` is the whole number 1; what has a fraction or exceeds 2^53 is none.
fn whole(value: f64) -> Option<i64> {
    const EXACT: f64 = 9_007_199_254_740_992.0;
    #[allow(clippy::cast_possible_truncation, reason = "bounded in the condition")]
    (value.fract() == 0.0 && value.abs() < EXACT).then_some(value as i64)
}

/// A struct of loose fields that keeps unknown ones, and knows the names of its own.
pub(super) trait Fields {
    /// The fields' names in the file.
    const NAMES: &'static [&'static str];

    /// What the format does not know.
    fn extra(&self) -> &Entry;
}

/// Declares a struct of the format: `field: type = "name in the file"`.
macro_rules! format_struct {
    ($(#[$about:meta])* $name:ident { $($(#[$doc:meta])* $field:ident: $type:ty = $key:literal,)* }) => {
        $(#[$about])*
        #[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
        pub struct $name {
            $(
                $(#[$doc])*
                #[serde(default, rename = $key, skip_serializing_if = "Loose::is_absent")]
                pub $field: Loose<$type>,
            )*
            /// Fields that the format does not know.
            #[serde(flatten)]
            pub extra: Entry,
        }

        impl Fields for $name {
            const NAMES: &'static [&'static str] = &[$($key),*];

            fn extra(&self) -> &Entry {
                &self.extra
            }
        }
    };
}

format_struct! {
    /// A whole mission file.
    Cdf {
        /// The story around the mission.
        task_description: String = "task_description",
        /// What people are asked to get done.
        goal_text: String = "goal_text",
        /// A number of the game.
        #[schemars(schema_with = "schema::text")]
        game_id: Scalar = "game_id",
        /// Whether the game is an experiment.
        #[schemars(schema_with = "schema::truth")]
        experimental: Scalar = "experimental",
        /// Where it takes place, and with what.
        scene: Scene = "scene",
        /// What must be reached.
        task_goals: Vec<Loose<TaskGoal>> = "task_goals",
        /// Messages and camera movements.
        game_interactions: Interactions = "game_interactions",
        /// Conditions that goals name.
        stateconditions: Vec<Loose<Condition>> = "stateconditions",
        /// Portals to the past.
        past_portals: Vec<Loose<PortalEntry>> = "pastPortals",
        /// Portals to the future.
        future_portals: Vec<Loose<PortalEntry>> = "futurePortals",
    }
}

format_struct! {
    /// A portal to the past or to the future.
    PortalEntry {
        /// Its name, by which objects refer to it.
        #[schemars(schema_with = "schema::text")]
        name: Scalar = "PortalName",
        /// Whether it is open from the start.
        #[schemars(schema_with = "schema::portal_status")]
        status: Scalar = "PortalStatus",
    }
}

format_struct! {
    /// Where a mission takes place, and with what.
    Scene {
        /// The seed of what is placed at random; `-1` is random.
        #[schemars(schema_with = "schema::integer")]
        floor_plan: Scalar = "floor_plan",
        /// The mission's name.
        #[schemars(schema_with = "schema::text")]
        scene_id: Scalar = "scene_id",
        /// Settings of the robot.
        simbot_init: Vec<Loose<Entry>> = "simbot_init",
        /// The rooms where the robot may start; the first counts.
        #[schemars(schema_with = "schema::rooms")]
        room_location: Vec<Scalar> = "roomLocation",
        /// What must be there.
        required_objects: Vec<Loose<RequiredObject>> = "required_objects",
        /// Notes stuck to places of rooms.
        sticky_notes: Vec<Loose<StickyNote>> = "sticky_notes",
        /// Layouts that must not be used.
        #[schemars(schema_with = "schema::layouts")]
        blacklisted_layouts: Vec<Scalar> = "blacklisted_layouts",
        /// The layout to use.
        #[schemars(schema_with = "schema::layout")]
        layout_override: Scalar = "layoutOverride",
        /// Whether looks are random.
        #[schemars(schema_with = "schema::truth")]
        completely_random_visual: Scalar = "completelyRandomVisual",
    }
}

format_struct! {
    /// An object that must be there.
    RequiredObject {
        /// Its instance id.
        #[schemars(schema_with = "schema::instance")]
        name: Scalar = "name",
        /// What the time machine turns this carrot back into.
        #[schemars(schema_with = "schema::class")]
        yesterday_state: Scalar = "yesterdayState",
        /// States it starts with, one key an item.
        #[schemars(schema_with = "schema::initial_states")]
        state: Vec<Loose<Entry>> = "state",
        /// At most one `{receptacle: "in"|"on"}`.
        #[schemars(schema_with = "schema::location")]
        location: Vec<Loose<Entry>> = "location",
        /// Its room; the first counts.
        #[schemars(schema_with = "schema::rooms")]
        room_location: Vec<Scalar> = "roomLocation",
        /// Its colour; the first counts.
        #[schemars(schema_with = "schema::colors")]
        colors: Vec<Scalar> = "colors",
        /// A condition for it to be there.
        #[schemars(schema_with = "schema::occasion")]
        condition: Value = "condition",
        /// What a printer cartridge prints.
        #[schemars(schema_with = "schema::class")]
        printing_object: Scalar = "printingObject",
        /// Portals to the past that lead to it.
        #[schemars(schema_with = "schema::portals")]
        associated_past_portals: Vec<Value> = "associatedPastPortals",
        /// Portals to the future that lead to it.
        #[schemars(schema_with = "schema::portals")]
        associated_future_portals: Vec<Value> = "associatedFuturePortals",
        /// The portal it stands behind.
        #[schemars(schema_with = "schema::text")]
        current_portal: Scalar = "currentPortal",
        /// What the dinosaur eats.
        #[schemars(schema_with = "schema::class")]
        dino_food: Scalar = "dinoFood",
    }
}

format_struct! {
    /// A note stuck to a place of a room.
    StickyNote {
        /// Its instance id.
        #[schemars(schema_with = "schema::instance")]
        name: Scalar = "name",
        /// What it says.
        #[schemars(schema_with = "schema::text")]
        text: Scalar = "text",
        /// Its room.
        #[schemars(schema_with = "schema::room")]
        room: Scalar = "room",
        /// The index of its place in the room.
        #[schemars(schema_with = "schema::integer")]
        location: Scalar = "location",
    }
}

format_struct! {
    /// A goal.
    TaskGoal {
        /// Its number.
        #[schemars(schema_with = "schema::integer")]
        goal_id: Scalar = "goal_id",
        /// `{instance: "key=value"}` items.
        #[schemars(schema_with = "schema::goal_states")]
        object_states: Vec<Loose<Entry>> = "object_states",
        /// `and` or `or`.
        #[schemars(schema_with = "schema::relation")]
        object_states_relation: Scalar = "object_states_relation",
        /// Numbers of goals to be met first.
        #[schemars(schema_with = "schema::integers")]
        preconditions: Vec<Scalar> = "preconditions",
        /// What people read.
        #[schemars(schema_with = "schema::text")]
        description: Scalar = "description",
        /// Who sees it when.
        visibility: Visibility = "visibility",
        /// Whether it opens again when its states no longer hold.
        #[schemars(schema_with = "schema::truth")]
        can_reset: Scalar = "canReset",
    }
}

format_struct! {
    /// Who sees a goal when.
    Visibility {
        /// Whether it is hidden until it is unlocked.
        #[schemars(schema_with = "schema::truth")]
        is_hidden: Scalar = "isHidden",
        /// The instance whose examining or use unlocks it, or `ALWAYS UNLOCKED`.
        #[schemars(schema_with = "schema::activation")]
        activation_interactable: Scalar = "activationInteractable",
        /// The index of the sticky note that unlocks it.
        #[schemars(schema_with = "schema::integer")]
        sticky_note_index: Scalar = "stickyNoteIndex",
    }
}

format_struct! {
    /// A condition that goals name.
    Condition {
        /// Its name.
        #[schemars(schema_with = "schema::text")]
        state_name: Scalar = "stateName",
        /// The instance it belongs to.
        #[schemars(schema_with = "schema::instance")]
        context: Scalar = "context",
        /// What must hold.
        #[schemars(schema_with = "schema::expression")]
        expression: Entry = "expression",
    }
}

format_struct! {
    /// What happens beside the goals.
    Interactions {
        /// Movements of the camera.
        camera_movements: Stages = "camera_movements",
        /// What people are told.
        game_messages: Stages = "game_messages",
    }
}

format_struct! {
    /// When people are told or shown something.
    Stages {
        /// As the mission begins.
        #[schemars(schema_with = "schema::items")]
        task_beginning: Vec<Value> = "task_beginning",
        /// As goals are met.
        #[schemars(schema_with = "schema::items")]
        task_procedure: Vec<Value> = "task_procedure",
        /// As the mission ends.
        #[schemars(schema_with = "schema::items")]
        task_ending: Vec<Value> = "task_ending",
        /// As objects change.
        #[schemars(schema_with = "schema::items")]
        object_conditions: Vec<Value> = "object_conditions",
    }
}
