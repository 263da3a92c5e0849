//! What a world pack has is drawn, and known by its ids.

#![allow(clippy::unwrap_used)]

mod twenty_rooms;

use std::{collections::BTreeSet, sync::Arc};

use cohabit_bus::message::Thing;
use cohabit_cdf::{
    Action, BodyId, Fluid, GoToTarget, PackFile, RoomId, StateFlag, Verb, WorldData, WorldPack, world_pack::template,
};
use cohabit_engine::{SessionPlan, furnishings, report};
use cohabit_render::{
    Camera, CpuRenderer, Lens, MeshLibrary, Planes, Renderer as _, RoomSurface, Scene, minimap, room_surface_id,
};
use cohabit_world::{Input, Vec2, World};

/// Pixels a metre of the floor plan: a wrench is some ten pixels long.
const PX_M: f32 = 50.0;
/// Height at which it is to scale, m.
const LEVEL_M: f32 = 0.8;

#[test]
fn objects_and_rooms_of_a_pack_are_drawn_with_their_ids() {
    let files = template("my-lab").into_iter();
    let files = files.map(|(path, text)| PackFile { path: path.to_owned(), bytes: text.into_bytes() });
    let world = WorldData::layered(vec![WorldPack::parse("my-lab", files.collect()).unwrap()]).unwrap();
    let (name, text) = world.packs()[0].missions().next().unwrap();
    let plan = SessionPlan::new(name, text, Arc::clone(world.catalog()), 1).unwrap();
    let session = plan.build().unwrap();
    let meshes = Arc::new(MeshLibrary::build(&plan.catalog).unwrap());
    let mut scene = Scene::new(meshes, &plan.layout);
    scene.set_instances(&furnishings(&session).collect::<Vec<_>>());
    let camera = Camera::above(plan.layout.bounds_m(), LEVEL_M, PX_M);
    let mut ids = vec![0; camera.pixels()];
    let mut planes = Planes { color: None, depth_m: None, normals: None, ids: Some(&mut ids) };
    CpuRenderer::new(1).render(&scene, &camera, &mut planes);
    let seen: BTreeSet<u32> = ids.iter().copied().collect();
    for instance in ["Wrench_01_1", "Degreaser_01_1", "Desk_01_1"] {
        let object = session.find(instance).unwrap();
        assert!(seen.iter().any(|id| Thing::of_id(*id) == Thing::Object(object)), "{instance} is not to be seen");
    }
    for room in plan.layout.rooms.iter().map(|room| room.id) {
        let index = plan.catalog.room_index(room).unwrap();
        assert!(seen.iter().any(|id| Thing::of_id(*id) == Thing::Surface(index.into())), "{room:?} is not to be seen");
    }
}

/// Has the first body do something, to its end.
fn carry_out(world: &mut World, command: u64, action: Action) {
    const LONGEST_TICKS: u32 = 60 * 120;
    let input = Input { command, body: BodyId(0), action };
    let mut report = world.step(std::slice::from_ref(&input));
    for _ in 0..LONGEST_TICKS {
        if let Some(outcome) = report.outcomes.iter().find(|outcome| outcome.command == command) {
            assert!(outcome.status.is_success(), "{action:?}: {}", outcome.detail);
            return;
        }
        report = world.step(&[]);
    }
    panic!("{action:?} did not end");
}

/// Has the first body do something, as far as it gets.
fn attempt(world: &mut World, command: u64, action: Action) {
    let mut report = world.step(&[Input { command, body: BodyId(0), action }]);
    while !report.outcomes.iter().any(|outcome| outcome.command == command) {
        report = world.step(&[]);
    }
}

#[test]
fn what_gets_too_heavy_to_be_pushed_stands_fast_before_a_snapshot_as_after_it() {
    let homes = WorldData::layered(vec![WorldPack::builtin("homes").unwrap()]).unwrap();
    let (name, text) = homes.packs()[0].missions().find(|(_, text)| text.contains("Care_Room")).unwrap();
    let plan = SessionPlan::new(name, text, Arc::clone(homes.catalog()), 1).unwrap();
    let mut world = plan.build().unwrap();
    let [tumbler, wheelchair] = ["Tumbler_10000", "Wheelchair_10000"].map(|instance| world.find(instance).unwrap());
    let loading = [
        Action::GoTo { target: GoToTarget::Object(tumbler) },
        Action::PickUp { object: tumbler },
        Action::GoTo { target: GoToTarget::Object(wheelchair) },
        Action::Place { receptacle: wheelchair },
    ];
    for (command, action) in (1..).zip(loading) {
        carry_out(&mut world, command, action);
    }
    let mut again = plan.build().unwrap();
    again.restore(&world.snapshot()).unwrap();
    let before = world.object(wheelchair).unwrap().position_m;
    for one in [&mut world, &mut again] {
        attempt(one, 9, Action::Move { distance_m: 2.0 });
    }
    assert_eq!(again.differences(&world), Vec::<String>::new());
    assert_eq!(world.object(wheelchair).unwrap().position_m, before);
}

#[test]
fn of_two_basins_at_hand_it_is_the_one_that_runs() {
    let homes = WorldData::layered(vec![WorldPack::builtin("homes").unwrap()]).unwrap();
    let text = r#"{"scene": {"layoutOverride": "Flat_One_Bed", "roomLocation": ["Bathroom"], "required_objects": [
        {"name": "Tumbler_1", "location": [{"Washbasin_10000": "in"}]}]}, "task_goals": []}"#;
    let mut world = SessionPlan::new("fill.json", text, Arc::clone(homes.catalog()), 1).unwrap().build().unwrap();
    let [tumbler, basin, bathtub] = ["Tumbler_1", "Washbasin_10000", "Bathtub_10000"].map(|id| world.find(id).unwrap());
    let filling = [
        Action::GoTo { target: GoToTarget::Object(basin) },
        Action::PickUp { object: tumbler },
        Action::Interact { verb: Verb::Toggle, object: basin },
        Action::Interact { verb: Verb::Fill, object: tumbler },
    ];
    for (command, action) in (1..).zip(filling) {
        carry_out(&mut world, command, action);
    }
    assert_eq!(world.object(tumbler).unwrap().fluid, Fluid::Water);
    assert_eq!(world.object(bathtub).unwrap().fluid, Fluid::None);
}

#[test]
fn most_curtains_of_homes_are_drawn_and_drawn_aside() {
    let homes = WorldData::layered(vec![WorldPack::builtin("homes").unwrap()]).unwrap();
    let class = homes.catalog().find("Curtains").unwrap();
    let (mut all, mut worked) = (0, 0);
    for plan in homes.packs()[0].plans() {
        let text = format!(
            r#"{{"scene": {{"layoutOverride": "{plan}", "roomLocation": ["Bathroom"], "required_objects": []}}, "task_goals": []}}"#
        );
        let mut world =
            SessionPlan::new("curtains.json", &text, Arc::clone(homes.catalog()), 1).unwrap().build().unwrap();
        let curtains: Vec<_> = world.objects().filter(|view| view.class == class).map(|view| view.id).collect();
        assert!(!curtains.is_empty(), "{plan}");
        let mut command = 0;
        for object in curtains {
            let is_open = |world: &World| world.object(object).unwrap().flags.has(StateFlag::Opened);
            let mut is_left = [Verb::Close, Verb::Open].into_iter().map(|verb| {
                for action in [Action::GoTo { target: GoToTarget::Object(object) }, Action::Interact { verb, object }] {
                    command += 1;
                    attempt(&mut world, command, action);
                }
                is_open(&world)
            });
            all += 1;
            worked += usize::from(is_left.next() == Some(false) && is_left.next() == Some(true));
        }
    }
    // Some hang over furniture that nobody reaches over.
    println!("{worked} of {all}");
    assert!(worked * 2 > all, "{worked} of {all}");
}

fn plan_of_twenty() -> SessionPlan {
    let world = twenty_rooms::world();
    let (name, text) = world.packs()[0].missions().next().unwrap();
    SessionPlan::new(name, text, Arc::clone(world.catalog()), 1).unwrap()
}

#[test]
fn all_of_twenty_rooms_are_walked_to_and_lit_by_themselves() {
    let plan = plan_of_twenty();
    let mut world = plan.build().unwrap();
    let rooms: Vec<RoomId> = plan.layout.rooms.iter().map(|room| room.id).collect();
    assert_eq!(rooms.len(), 20);
    assert_eq!(world.body(BodyId(0)).unwrap().room, RoomId::new("SunLounge").unwrap());
    for from in &plan.layout.viewpoints {
        for to in &plan.layout.viewpoints {
            let way = world.path(Vec2::from(from.at_m), Vec2::from(to.at_m));
            assert!(way.is_some(), "from {} to {}", from.room, to.room);
        }
    }
    let mut command = 0;
    let mut dark = BTreeSet::new();
    for switched in plan.layout.placements.iter().filter(|thing| thing.instance.starts_with("LightSwitch_01_")) {
        let switch = world.find(&switched.instance).unwrap();
        for action in [
            Action::GoTo { target: GoToTarget::Room(switched.room) },
            Action::GoTo { target: GoToTarget::Object(switch) },
            Action::Interact { verb: Verb::Toggle, object: switch },
        ] {
            command += 1;
            carry_out(&mut world, command, action);
        }
        assert_eq!(world.body(BodyId(0)).unwrap().room, switched.room);
        dark.insert(switched.room);
        let lit = report::state(&world).header.lit_rooms;
        for room in &rooms {
            let index = plan.catalog.room_index(*room).unwrap();
            assert_eq!(world.room_lit(*room), !dark.contains(room), "{room}");
            assert_eq!(lit >> index & 1 == 1, world.room_lit(*room), "{room}");
        }
    }
    assert_eq!(dark.len(), rooms.len());
    let mut again = plan.build().unwrap();
    again.restore(&world.snapshot()).unwrap();
    assert_eq!(again.digest(), world.digest());
    assert_eq!(again.body(BodyId(0)).unwrap().room, world.body(BodyId(0)).unwrap().room);
}

#[test]
fn the_twentieth_room_is_drawn_and_is_on_the_map() {
    let plan = plan_of_twenty();
    let lounge = RoomId::new("SunLounge").unwrap();
    let index = plan.catalog.room_index(lounge).unwrap();
    assert_eq!(index, 27);
    let mut scene = Scene::new(Arc::new(MeshLibrary::build(&plan.catalog).unwrap()), &plan.layout);
    scene.set_instances(&furnishings(&plan.build().unwrap()).collect::<Vec<_>>());
    let view = plan.layout.viewpoints.iter().find(|view| view.room == lounge).unwrap();
    let lens = Lens::new(120, 90, 90.0).unwrap();
    let [x, y] = view.at_m;
    let camera = Camera::fixed(lens, [x, y, 1.6], view.yaw_deg.to_radians(), -0.5);
    let (mut lit, mut dark) = (vec![0; camera.pixels() * 4], vec![0; camera.pixels() * 4]);
    let mut ids = vec![0; camera.pixels()];
    let mut renderer = CpuRenderer::new(1);
    let mut shoot = |scene: &Scene, color: &mut [u8]| {
        let mut planes = Planes { color: Some(color), depth_m: None, normals: None, ids: Some(&mut ids) };
        renderer.render(scene, &camera, &mut planes);
    };
    shoot(&scene, &mut lit);
    scene.set_lights(lounge, false);
    shoot(&scene, &mut dark);
    assert_ne!(lit, dark);
    assert!(ids.contains(&room_surface_id(index, RoomSurface::Floor)));
    let map = minimap(&plan.layout, &plan.catalog, 16.0);
    let [west, south, ..] = plan.layout.room(lounge).unwrap().rects_m[0];
    let [x, y] = map.pixel_of([west + 0.3, south + 0.3]).map(|place| place as usize);
    let start = (y * map.picture.width as usize + x) * 4;
    assert_eq!(map.picture.rgba[start..start + 3], twenty_rooms::LOUNGE_COLOR);
}
