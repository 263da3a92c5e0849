//! What the robot's state and its actions are as vectors of numbers.

use cohabit_cdf::ActionKind;

use crate::native::Step;

/// The name of the action that ends an episode.
const STOP: &str = "stop";

/// What each number of a state is, where robots may be in these rooms.
pub(crate) fn state_names(rooms: &[String]) -> Vec<String> {
    let pose = ["x_m", "y_m", "z_m", "yaw_rad", "head_pitch_rad", "is_holding"].map(str::to_owned);
    let rooms = rooms.iter().map(|room| format!("is_in_{room}"));
    pose.into_iter().chain(rooms).collect()
}

/// The robot before a step; none where the step does not say where it is.
pub(crate) fn state(step: &Step, rooms: &[String]) -> Option<Vec<f32>> {
    let pose = step.pose.as_ref()?;
    let [x_m, y_m, z_m] = pose.position_m;
    let numbers = [x_m, y_m, z_m, pose.yaw_rad, pose.head_pitch_rad, one_if(pose.held.is_some())];
    let rooms = rooms.iter().map(|room| one_if(*room == pose.room));
    Some(numbers.into_iter().chain(rooms).collect())
}

/// What each number of an action is.
pub(crate) fn action_names() -> Vec<String> {
    let kinds = ActionKind::ALL.map(ActionKind::name).into_iter().chain([STOP]);
    let target = ["is_seen", "left", "top", "right", "bottom"].map(str::to_owned);
    kinds.map(|kind| format!("is_{kind}")).chain(target).collect()
}

/// A step's action: its kind, and the box of its object in the picture, as shares of the picture's width and height; zeros
/// where it is not seen. The last step of an episode is to stop. None where there is no such kind of action.
pub(crate) fn action(step: &Step, size: [u32; 2]) -> Option<Vec<f32>> {
    let kind = step.action.as_ref().map_or(STOP, |action| action.kind.as_str());
    let kinds: Vec<f32> =
        ActionKind::ALL.map(ActionKind::name).into_iter().chain([STOP]).map(|name| one_if(name == kind)).collect();
    if !kinds.contains(&1.0) {
        return None;
    }
    let target = step.target().map_or([0.0; 5], |seen| {
        let [left, top, right, bottom] = seen.r#box.map(f32::from);
        let [width, height] = size.map(|side| side as f32);
        [1.0, left / width, top / height, right / width, bottom / height]
    });
    Some(kinds.into_iter().chain(target).collect())
}

const fn one_if(is_so: bool) -> f32 {
    if is_so { 1.0 } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn named(names: Vec<String>, numbers: Vec<f32>) -> Vec<(String, f32)> {
        assert_eq!(names.len(), numbers.len());
        names.into_iter().zip(numbers).filter(|(_, number)| *number != 0.0).collect()
    }

    #[test]
    fn vectors_say_what_the_step_says() {
        let step: Step = serde_json::from_value(json!({
            "tick": 7,
            "action": {"kind": "pick_up", "object": "Bowl_01_1", "class": "Bowl_01", "id": 9, "is_seen": true},
            "outcome": {"status": "ActionSuccessful"},
            "pose": {"position_m": [1.5, 2.0, 0.0], "yaw_rad": 0.5, "head_pitch_rad": -0.25, "room": "Lab1", "held": "Mug_1"},
            "seen": [{"id": 9, "color": [1, 2, 3], "box": [10, 20, 30, 40]}],
        }))
        .unwrap();
        let told = |expected: &[(&str, f32)]| -> Vec<(String, f32)> {
            expected.iter().map(|(name, number)| ((*name).to_owned(), *number)).collect()
        };
        let rooms = ["BreakRoom", "Lab1", "Attic"].map(str::to_owned);
        let state = [("x_m", 1.5), ("y_m", 2.0), ("yaw_rad", 0.5), ("head_pitch_rad", -0.25), ("is_holding", 1.0)];
        assert_eq!(
            named(state_names(&rooms), super::state(&step, &rooms).unwrap()),
            told(&[&state[..], &[("is_in_Lab1", 1.0)]].concat())
        );
        let action = [("left", 0.1), ("top", 0.1), ("right", 0.3), ("bottom", 0.2)];
        let action = [&[("is_pick_up", 1.0), ("is_seen", 1.0)][..], &action[..]].concat();
        assert_eq!(named(action_names(), super::action(&step, [100, 200]).unwrap()), told(&action));
    }

    #[test]
    fn an_episode_ends_with_a_stop_and_no_action_is_made_up() {
        let mut step: Step =
            serde_json::from_value(json!({"tick": 7, "action": null, "outcome": null, "pose": null})).unwrap();
        assert_eq!(named(action_names(), action(&step, [1, 1]).unwrap()), [("is_stop".to_owned(), 1.0)]);
        assert_eq!(state(&step, &[]), None);
        step.action =
            serde_json::from_value(json!({"kind": "fly", "object": "x", "class": "x", "id": 1, "is_seen": false}))
                .unwrap();
        assert_eq!(action(&step, [1, 1]), None);
    }
}
