//! What a mission tells, shows and holds back: messages and camera movements when they are due, and objects that are
//! not there yet.

use cohabit_cdf::{
    Mission, ObjectId,
    mission::{CameraMovement, CameraView, Message, MessageTime},
};

use crate::{
    anchors::free_anchors,
    effect::{Effect, Spot},
    entity::Support,
    facts::Facts,
    goals,
    mission_state::{Away, Until},
    report::{CameraTarget, Event},
    works::portal::{foot, open_gate},
};

/// What is told and shown as `now` comes, messages first.
pub(crate) fn due(facts: &Facts<'_>, mission: &Mission, now: &MessageTime) -> Vec<Event> {
    let messages = mission.messages.iter().filter(|message| message.when == *now).map(told);
    let movements = mission.camera_movements.iter().filter(|movement| movement.when == *now);
    messages.chain(movements.filter_map(|movement| shown(facts, movement))).collect()
}

/// What is told and shown because its occasion has come with this tick, and which occasions hold now.
pub(crate) fn on_occasions(facts: &Facts<'_>, mission: &Mission) -> (Vec<Event>, Vec<bool>) {
    let mut before = facts.state.occasions.iter().copied();
    let mut begins = |when: &MessageTime, now: &mut Vec<bool>| {
        let MessageTime::Occasion(occasion) = when else { return false };
        let holds = goals::occurs(facts, mission, occasion);
        now.push(holds);
        // Taken also where it does not hold: each is compared with what it was itself.
        let held = before.next().unwrap_or(false);
        holds && !held
    };
    let (mut events, mut now) = (Vec::new(), Vec::new());
    for message in &mission.messages {
        events.extend(begins(&message.when, &mut now).then(|| told(message)));
    }
    for movement in &mission.camera_movements {
        events.extend(begins(&movement.when, &mut now).then(|| shown(facts, movement)).flatten());
    }
    (events, now)
}

fn told(message: &Message) -> Event {
    Event::Message { text: message.text.clone() }
}

/// A movement as it can be played here; none, if what it shows is not there.
fn shown(facts: &Facts<'_>, movement: &CameraMovement) -> Option<Event> {
    let target = match &movement.view {
        CameraView::Object(pattern) => {
            let those = goals::Meant::new(facts.catalog, pattern);
            let mut meant = facts.state.existing().map(|(id, _)| id).filter(|id| those.is(facts, *id));
            CameraTarget::Object(meant.next()?)
        }
        CameraView::Room(room) => CameraTarget::Room(*room),
        CameraView::Viewpoint(room, number) => CameraTarget::Viewpoint(*room, *number),
        CameraView::Point(point_m) => CameraTarget::Point(*point_m),
    };
    let text = movement.text.clone().unwrap_or_default();
    Some(Event::CameraMovement { target, duration_s: movement.duration_s, text })
}

/// What comes into the world now: from behind a portal that is open, because its condition holds, or with what it is in.
pub(crate) fn arrivals(facts: &Facts<'_>, mission: &Mission) -> Vec<ObjectId> {
    let comes = |away: &Away| {
        // What it is in comes first, or it would come to stand in mid-air.
        let there = away.support.parent().is_none_or(|carrier| !facts.state.away.contains_key(&carrier));
        match &away.until {
            Until::Portal(name) => leading_to(facts, name).is_some(),
            Until::Condition(index) => {
                let condition = mission.objects.get(*index).and_then(|request| request.condition.as_ref());
                there && condition.is_some_and(|condition| goals::occurs(facts, mission, condition))
            }
            Until::Carrier => there,
        }
    };
    facts.state.away.iter().filter(|(_, away)| comes(away)).map(|(object, _)| *object).collect()
}

/// How it comes: to where room is left now.
pub(crate) fn arrival(facts: &Facts<'_>, object: ObjectId) -> Option<Effect> {
    let away = facts.state.away.get(&object)?;
    let spot = match &away.until {
        Until::Portal(name) => Spot::Floor(foot(facts, leading_to(facts, name)?)),
        Until::Condition(_) | Until::Carrier => own_place(facts, away),
    };
    Some(Effect::Return { object, spot })
}

/// The generator whose portal is open and of that name.
fn leading_to(facts: &Facts<'_>, name: &str) -> Option<ObjectId> {
    let mut generators = facts.state.portals.keys();
    generators.find(|generator| open_gate(facts, **generator).is_some_and(|gate| gate.way().name == name)).copied()
}

/// The place that the mission gave it; at the foot of what it should stand on, if that was taken since.
fn own_place(facts: &Facts<'_>, away: &Away) -> Spot {
    match away.support {
        Support::On { parent, anchor, .. } if facts.object(parent).exists() => {
            let free = anchor.filter(|anchor| free_anchors(facts, parent).iter().any(|free| free.index == *anchor));
            free.map_or_else(|| Spot::Floor(foot(facts, parent)), |anchor| Spot::Anchor { parent, anchor })
        }
        _ => Spot::Floor(away.pose.position),
    }
}
