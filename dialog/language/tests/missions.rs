//! The utterances of real missions, understood in the built-in office.

use std::{path::Path, sync::Arc};

use crate::support::text;
use cohabit_cdf::{Catalog, Layout, Mission, ObjectId, RoomId};
use cohabit_language::{Context, Known, KnownObject, KnownRobot, Language, Understanding};

/// A few less than led to a plan when this was written: 1,318 of 1,331.
const FEWEST_PLANNED: usize = 1_315;

/// What the robot would know who had seen all of the office at the start of `mission`.
fn known(catalog: &Catalog, layout: &Layout, mission: &Mission) -> Known {
    let robot = KnownRobot {
        position_m: room_middle(layout, mission.start_room),
        yaw_rad: 0.0,
        room: mission.start_room,
        held: None,
    };
    let objects = KnownObject::furniture(catalog, layout);
    let mut known = Known::new(robot, objects);
    for request in mission.objects.iter().filter(|request| request.remove_initial_contents) {
        let class = catalog.class_of_instance(&request.instance);
        let emptied: Vec<ObjectId> =
            known.objects.iter().filter(|object| Some(object.class) == class).map(|object| object.id).collect();
        known.objects.retain(|object| object.parent.is_none_or(|parent| !emptied.contains(&parent)));
    }
    for request in &mission.objects {
        let Some(class) = catalog.class_of_instance(&request.instance) else { continue };
        let same: Vec<ObjectId> =
            known.objects.iter().filter(|object| object.class == class).map(|object| object.id).collect();
        let id = match find(&known, Some(&request.instance)) {
            Some(id) => id,
            None if !same.is_empty() && request.inside.is_none() => same[0],
            None => add(
                &mut known,
                catalog,
                &request.instance,
                request.room.unwrap_or(mission.start_room),
                room_middle(layout, mission.start_room),
            ),
        };
        if request.unique {
            known.objects.retain(|object| object.class != class || object.id == id);
        }
        let inside = request.inside.as_deref().and_then(|inside| {
            let class = catalog.class_of_instance(inside);
            find(&known, Some(inside))
                .or_else(|| known.objects.iter().find(|object| Some(object.class) == class).map(|object| object.id))
        });
        let place = inside.and_then(|id| known.object(id)).map(|parent| (parent.room, parent.position_m));
        let object = object(&mut known, id).unwrap();
        request.flags.iter().for_each(|(flag, value)| object.flags.set(*flag, *value));
        object.in_mission = true;
        object.color = request.color.unwrap_or_default();
        object.fluid = request.fluid.unwrap_or_default();
        if let Some((room, position_m)) = place {
            (object.parent, object.room, object.position_m) = (inside, room, position_m);
        }
    }
    let room = known.robot.room;
    known.objects.iter_mut().for_each(|object| object.visible = object.room == room);
    known
}

fn room_middle(layout: &Layout, room: RoomId) -> [f32; 3] {
    let [west, south, east, north] = layout.room(room).unwrap().rects_m[0];
    [(west + east) / 2.0, (south + north) / 2.0, 0.0]
}

fn find(known: &Known, instance: Option<&str>) -> Option<ObjectId> {
    known.objects.iter().find(|object| Some(object.instance.as_str()) == instance).map(|object| object.id)
}

fn object(known: &mut Known, id: ObjectId) -> Option<&mut KnownObject> {
    known.objects.iter_mut().find(|object| object.id == id)
}

fn add(known: &mut Known, catalog: &Catalog, instance: &str, room: RoomId, position_m: [f32; 3]) -> ObjectId {
    let id = ObjectId(known.objects.last().map_or(0, |object| object.id.0 + 1));
    let class = catalog.class_of_instance(instance).unwrap();
    known.objects.push(KnownObject::new(id, instance.to_owned(), class, room, position_m));
    id
}

/// The strings of the list `"key":[…]` in a line of JSON without escapes.
fn strings(line: &str, key: &str) -> Vec<String> {
    let start = format!("\"{key}\":[");
    let Some(at) = line.find(&start) else { return Vec::new() };
    let list = &line[at + start.len()..];
    let list = &list[..list.find(']').unwrap_or(list.len())];
    list.split('"').skip(1).step_by(2).map(str::to_owned).collect()
}

#[test]
#[cfg_attr(not(reference_data), ignore = "needs the reference data in ../shared/arena")]
fn utterances_of_real_missions_are_understood() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/arena/missions-dev.jsonl");
    let file = std::fs::read_to_string(&path).unwrap();
    let catalog = Arc::new(Catalog::builtin());
    let layout = Layout::builtin("OfficeLayout1").unwrap();
    let language = Language::new(catalog.clone());
    let (mut said, mut planned, mut rest) = (0, 0_usize, std::collections::BTreeMap::<String, usize>::new());
    for line in file.lines() {
        let cdf = line.find("\"cdf\":").map_or("", |at| &line[at + 6..line.len() - 1]);
        let mission = cohabit_cdf::mission::read_mission("mission", cdf, &catalog).unwrap().mission;
        let scene = known(&catalog, &layout, &mission);
        let mut talk = Played { language: &language, scene, context: Context::default() };
        for utterance in strings(line, "preparation_utterances").into_iter().chain(strings(line, "utterances")) {
            said += 1;
            let understanding = talk.play(&utterance);
            // The warehouse's cabinets stand open.
            let is_met = text(&understanding, &talk.scene).ends_with("is already open.");
            if is_met || matches!(understanding, Understanding::Plan { .. }) {
                planned += 1;
            } else {
                *rest.entry(format!("{utterance}: {}", text(&understanding, &talk.scene))).or_default() += 1;
            }
        }
    }
    eprintln!("{planned} of {said} planned; the rest:\n{rest:#?}");
    assert!(planned >= FEWEST_PLANNED, "only {planned} of {said} utterances led to a plan: {rest:#?}");
}

/// A conversation whose plans are carried out as far as language can tell: positions, hand, doors.
struct Played<'a> {
    language: &'a Language,
    scene: Known,
    context: Context,
}

impl Played<'_> {
    fn play(&mut self, utterance: &str) -> Understanding {
        let understanding = self.language.understand(utterance, &self.scene, &mut self.context);
        if std::env::var_os("COHABIT_SHOW_PLANS").is_some() {
            eprintln!("{utterance} -> {}", text(&understanding, &self.scene));
        }
        if let Understanding::Plan { steps, .. } = &understanding {
            for step in steps {
                self.carry_out(&step.action);
            }
        }
        understanding
    }

    fn carry_out(&mut self, action: &cohabit_cdf::Action) {
        use cohabit_cdf::{Action, GoToTarget, StateFlag, Verb};
        match *action {
            Action::GoTo { target: GoToTarget::Object(id) } => self.walk(id),
            Action::GoTo { target: GoToTarget::Room(room) } => self.scene.robot.room = room,
            Action::PickUp { object: id } => {
                self.walk(id);
                self.scene.robot.held = Some(id);
                object(&mut self.scene, id).unwrap().parent = None;
            }
            Action::Place { receptacle } | Action::PlaceBeside { receptacle, .. } => {
                self.walk(receptacle);
                if let Some(held) = self.scene.robot.held.take() {
                    let place = self.scene.object(receptacle).unwrap().clone();
                    let held = object(&mut self.scene, held).unwrap();
                    (held.parent, held.room, held.position_m) = (Some(receptacle), place.room, place.position_m);
                }
            }
            Action::Interact { verb, object: id } => {
                self.walk(id);
                let known = object(&mut self.scene, id).unwrap();
                match verb {
                    Verb::Open => known.flags.set(StateFlag::Opened, true),
                    Verb::Close => known.flags.set(StateFlag::Opened, false),
                    _ => {}
                }
            }
            _ => {}
        }
        let room = self.scene.robot.room;
        self.scene.objects.iter_mut().for_each(|object| object.visible = object.room == room);
    }

    fn walk(&mut self, id: ObjectId) {
        let target = self.scene.object(id).unwrap();
        (self.scene.robot.room, self.scene.robot.position_m) = (target.room, target.position_m);
    }
}
