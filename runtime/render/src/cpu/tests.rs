#![allow(clippy::unwrap_used)]

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use cohabit_cdf::layout::{Finish, Layout, Opening, OpeningKind, Room};
use cohabit_cdf::model::{Axis, Material};
use cohabit_cdf::{Catalog, Color, Fluid, RoomId, StateFlag, StateFlags};

use super::*;
use crate::{FAR_M, Highlight, Instance, Look, MeshLibrary, RoomSurface, room_surface_id};

const OBJECTS: &str = r##"
[[object]]
id = "Box_01"
name = "Box"
size_m = [0.5, 0.5, 0.5]
mass_kg = 1.0
color = "brown"
model = "box"
tint = "#a07040"
[[object]]
id = "Vase_01"
name = "Vase"
size_m = [0.2, 0.2, 0.4]
mass_kg = 1.0
color = "white"
model = "vase"
"##;

const MODELS: &str = r##"
[[model]]
id = "box"
[[model.part]]
shape = "box"
size = [0.5, 0.5, 0.5]
color = "tint"
material = "wood"
[[model.part]]
shape = "box"
size = [0.5, 0.5, 0.02]
at = [0.0, 0.0, 0.5]
color = "#404040"
joint = "lid"
[[model.joint]]
id = "lid"
driven_by = "open"
at = [-0.25, 0.0, 0.5]
axis = [0.0, 1.0, 0.0]
turn_deg = -90.0
[[model]]
id = "vase"
[[model.part]]
shape = "lathe"
profile = [[0.0, 0.0], [0.08, 0.0], [0.1, 0.2], [0.06, 0.4], [0.05, 0.4], [0.08, 0.2], [0.0, 0.02]]
color = "#e0e0e0"
material = "ceramic"
when = "whole"
[[model.part]]
shape = "sphere"
radii = [0.1, 0.1, 0.03]
color = "#e0e0e0"
when = "broken"
"##;

const ROBOT: Look = Look::Robot { head_pitch_rad: 0.2, arm: 0.5, holds: false, rolled_m: 0.0 };
const PERSON: Look = Look::Person { outfit: 0, head_pitch_rad: 0.0, arm: 0.0, holds: false, walked_m: 0.0, pace: 0.0 };

/// Two rooms side by side, a door between them, a window to the outside.
fn layout() -> Layout {
    let finish = |material, color: &str| Finish { material, color: color.to_owned() };
    let room = |id, rect| Room {
        id,
        rects_m: vec![rect],
        floor: finish(Material::Wood, "#a08060"),
        wall: finish(Material::Brick, "#8c5040"),
        wainscot: Some(finish(Material::Plain, "#e8e4da")),
        circuit: 1,
    };
    let opening = |kind, between, at_m, wall_runs| Opening { kind, door: None, between, at_m, width_m: 1.0, wall_runs };
    Layout {
        id: "two rooms".to_owned(),
        wall_height_m: 2.8,
        rooms: vec![
            room(RoomId::LAB1, [0.0, 0.0, 5.0, 4.0]),
            room(RoomId::LAB2, [5.0, 0.0, 9.0, 4.0]),
            room(RoomId::HALLWAY, [0.0, 4.0, 9.0, 6.0]),
        ],
        openings: vec![
            opening(OpeningKind::Door, [RoomId::LAB1, RoomId::LAB2], [5.0, 2.0], Axis::Y),
            opening(OpeningKind::Passage, [RoomId::LAB2, RoomId::HALLWAY], [7.0, 4.0], Axis::X),
            opening(OpeningKind::Window, [RoomId::LAB1, RoomId::LAB1], [0.0, 2.0], Axis::Y),
        ],
        placements: Vec::new(),
        viewpoints: Vec::new(),
        note_places: Vec::new(),
    }
}

fn instance(id: u32, look: Look, x: f32, y: f32, room: RoomId) -> Instance {
    Instance {
        id,
        look,
        position_m: [x, y, 0.0],
        rotation: [0.0, 0.0, 0.247_404, 0.968_912],
        scale: [1.0; 3],
        flags: StateFlags::default(),
        fluid: Fluid::None,
        color: Color::Original,
        opened: 0.0,
        running: 0.0,
        room,
        visible: true,
    }
}

fn scene() -> (Scene, Vec<Instance>) {
    let catalog = Catalog::parse(&[("objects", OBJECTS)], &[("models", MODELS)]).unwrap();
    let (crate_box, vase) =
        (Look::Object(catalog.find("Box_01").unwrap()), Look::Object(catalog.find("Vase_01").unwrap()));
    let instances = vec![
        instance(1, crate_box, 3.0, 2.2, RoomId::LAB1),
        Instance { opened: 0.5, ..instance(2, crate_box, 7.0, 1.4, RoomId::LAB2) },
        instance(3, vase, 2.4, 1.4, RoomId::LAB1),
        instance(4, ROBOT, 4.2, 1.2, RoomId::LAB1),
        instance(5, PERSON, 6.4, 2.6, RoomId::LAB2),
        instance(6, crate_box, 5.0, 2.1, RoomId::LAB1),
        instance(7, vase, 7.2, 5.0, RoomId::HALLWAY),
    ];
    let mut scene = Scene::new(Arc::new(MeshLibrary::build(&catalog).unwrap()), &layout());
    scene.set_instances(&instances);
    (scene, instances)
}

fn camera() -> Camera {
    Camera {
        position_m: [0.6, 1.6, 1.4],
        yaw_rad: 0.02,
        pitch_rad: -0.2,
        fov_y_rad: 1.1,
        width: 200,
        height: 150,
        hide: None,
        for_people: false,
        ceiling: true,
    }
}

/// All planes of one picture.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Picture {
    pub color: Vec<u8>,
    pub depth_m: Vec<f32>,
    pub normals: Vec<i8>,
    pub ids: Vec<u32>,
}

impl Picture {
    /// What no renderer has drawn on.
    fn blank(pixels: usize) -> Self {
        Self {
            color: vec![1; pixels * 4],
            depth_m: vec![-1.0; pixels],
            normals: vec![1; pixels * 4],
            ids: vec![77; pixels],
        }
    }

    fn planes(&mut self) -> Planes<'_> {
        Planes {
            color: Some(&mut self.color),
            depth_m: Some(&mut self.depth_m),
            normals: Some(&mut self.normals),
            ids: Some(&mut self.ids),
        }
    }
}

pub(super) fn picture(renderer: &mut CpuRenderer, scene: &Scene, camera: &Camera) -> Picture {
    let mut all = Picture::blank(camera.pixels());
    renderer.render(scene, camera, &mut all.planes());
    all
}

/// FNV-1a over all planes.
fn digest(picture: &Picture) -> u64 {
    let mut hash = 0xCBF2_9CE4_8422_2325_u64;
    let bytes = picture
        .color
        .iter()
        .copied()
        .chain(picture.depth_m.iter().flat_map(|depth| depth.to_le_bytes()))
        .chain(picture.normals.iter().map(|value| *value as u8))
        .chain(picture.ids.iter().flat_map(|id| id.to_le_bytes()));
    for byte in bytes {
        hash = (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01B3);
    }
    hash
}

/// Cameras all over the place.
fn cameras() -> Vec<Camera> {
    let places = [
        ([0.6, 1.6, 1.4], 0.02, -0.2),
        ([4.6, 3.4, 1.1], -0.6, -0.1),
        ([5.0, 2.0, 1.2], 0.0, 0.0),
        ([8.4, 0.5, 1.6], 2.2, -0.3),
        ([7.0, 5.2, 1.2], -1.6, -0.1),
        ([3.0, 2.2, 1.2], 1.0, -1.2),
    ];
    places.map(|(position_m, yaw_rad, pitch_rad)| Camera { position_m, yaw_rad, pitch_rad, ..camera() }).to_vec()
}

#[test]
fn the_same_bits_as_ever() {
    let (scene, _) = scene();
    let seen = digest(&picture(&mut CpuRenderer::new(1), &scene, &camera()));
    assert_eq!(seen, GOLDEN, "the picture changed: look at it, then write {seen:#X} here");
}

/// What the picture of [`scene`] from [`camera`] adds up to.
const GOLDEN: u64 = 0x5E74_D5DA_4245_FE97;

#[test]
fn the_same_bits_with_any_number_of_threads() {
    let (scene, _) = scene();
    for for_people in [false, true] {
        let camera = Camera { for_people, ..camera() };
        let one = picture(&mut CpuRenderer::new(1), &scene, &camera);
        for threads in [2, 3, 8] {
            assert!(one == picture(&mut CpuRenderer::new(threads), &scene, &camera), "{threads} threads");
        }
    }
}

#[test]
fn the_same_bits_whether_drawn_together_or_one_by_one() {
    let (scene, _) = scene();
    // Of different sizes and kinds, and some for people.
    let mut cameras = cameras();
    for (index, camera) in (0_u32..).zip(&mut cameras) {
        camera.width += index * 7;
        camera.height -= index * 5;
        camera.for_people = index % 2 == 1;
    }
    let alone: Vec<_> = cameras.iter().map(|camera| picture(&mut CpuRenderer::new(1), &scene, camera)).collect();
    for (threads, count) in [(1, 6), (2, 6), (3, 2), (4, 1), (8, 3), (2, 0)] {
        let mut renderer = CpuRenderer::new(threads);
        let mut together: Vec<_> = cameras[..count].iter().map(|camera| Picture::blank(camera.pixels())).collect();
        for turn in 0..2 {
            let shots = cameras.iter().zip(&mut together);
            let mut shots: Vec<_> = shots.map(|(camera, own)| Shot { camera: *camera, planes: own.planes() }).collect();
            renderer.render_all(&scene, &mut shots);
            assert!(together == alone[..count], "{threads} threads, {count} pictures, turn {turn}");
        }
    }
}

#[test]
fn the_same_bits_on_any_processor() {
    let (scene, _) = scene();
    for camera in cameras() {
        let people = Camera { for_people: true, ..camera };
        for camera in [camera, people] {
            let wide = picture(&mut CpuRenderer::new(1), &scene, &camera);
            assert!(wide == picture(&mut CpuRenderer::without_wide_vectors(), &scene, &camera), "{camera:?}");
        }
    }
}

#[test]
fn the_same_bits_whether_baked_before_or_when_seen() {
    let (when_seen, _) = scene();
    let (before, _) = scene();
    before.meshes.bake_all(&AtomicBool::new(false));
    let people = Camera { for_people: true, ..camera() };
    let mut renderer = CpuRenderer::new(2);
    assert!(picture(&mut renderer, &when_seen, &people) == picture(&mut renderer, &before, &people));
}

#[test]
fn baking_stops_when_told_and_goes_on_later() {
    let (scene, _) = scene();
    let robot = scene.meshes.model(scene.meshes.bodies().robot);
    scene.meshes.bake_all(&AtomicBool::new(true));
    assert!(!robot.is_baked());
    scene.meshes.bake_all(&AtomicBool::new(false));
    assert!(robot.is_baked());
}

#[test]
fn the_same_bits_whether_the_scene_was_built_or_changed() {
    let (built, instances) = scene();
    let (mut changed, _) = scene();
    let mut other = instances.clone();
    other[3].position_m[1] += 1.0;
    other[1].visible = false;
    other.pop();
    changed.set_instances(&other);
    let mut renderer = CpuRenderer::new(1);
    assert!(picture(&mut renderer, &built, &camera()) != picture(&mut renderer, &changed, &camera()));
    changed.set_instances(&instances);
    assert!(picture(&mut renderer, &built, &camera()) == picture(&mut renderer, &changed, &camera()));
}

#[test]
fn rooms_out_of_sight_change_nothing() {
    let (scene, _) = scene();
    for camera in cameras() {
        let with = picture(&mut CpuRenderer::new(1), &scene, &camera);
        let without = picture(&mut CpuRenderer::without_portals(), &scene, &camera);
        let different = with.ids.iter().zip(&without.ids).filter(|(a, b)| a != b).count();
        assert_eq!(different, 0, "{different} pixels differ from {:?}", camera.position_m);
        assert!(with == without, "{:?}", camera.position_m);
    }
}

#[test]
fn every_pixel_inside_sees_a_surface_that_faces_it() {
    let (scene, instances) = scene();
    for camera in cameras() {
        let view = View::new(&camera);
        let all = picture(&mut CpuRenderer::new(1), &scene, &camera);
        for (index, id) in all.ids.iter().enumerate() {
            let (x, y) = (index % camera.width as usize, index / camera.width as usize);
            let known = *id >= 1 << 24 || instances.iter().any(|instance| instance.id == *id);
            assert!(known, "pixel {x} {y} from {:?} sees {id}", camera.position_m);
            let depth = all.depth_m[index];
            assert!(depth > 0.0 && depth < FAR_M, "{depth}");
            let place = view.eye + view.ray(x as f32 + 0.5, y as f32 + 0.5) * depth;
            let inside = place.x > -0.3 && place.x < 9.3 && place.y > -0.3 && place.y < 6.3;
            assert!(inside && place.z > -0.01 && place.z < 2.81, "pixel {x} {y} sees {place}");
            if *id == room_surface_id(3, RoomSurface::Floor) {
                assert!(place.z.abs() < 0.01, "the floor at {place}");
                assert_eq!(all.normals[index * 4..index * 4 + 3], [0, 0, 127]);
            }
        }
    }
}

#[test]
fn an_instance_is_where_it_was_put() {
    let (scene, _) = scene();
    let camera = camera();
    let view = View::new(&camera);
    let all = picture(&mut CpuRenderer::new(1), &scene, &camera);
    let places: Vec<_> = (0..camera.pixels())
        .filter(|index| all.ids[*index] == 1)
        .map(|index| {
            let (x, y) = (index % camera.width as usize, index / camera.width as usize);
            view.eye + view.ray(x as f32 + 0.5, y as f32 + 0.5) * all.depth_m[index]
        })
        .collect();
    assert!(places.len() > 100);
    for place in places {
        let beside = (place.x - 3.0).hypot(place.y - 2.2);
        assert!(beside < 0.36 && place.z > -0.01 && place.z < 0.53, "{place}");
    }
}

#[test]
fn what_is_hidden_is_not_seen() {
    let (mut scene, mut instances) = scene();
    let mut renderer = CpuRenderer::new(1);
    assert!(picture(&mut renderer, &scene, &camera()).ids.contains(&4));
    let own_eyes = Camera { hide: Some(4), ..camera() };
    assert!(!picture(&mut renderer, &scene, &own_eyes).ids.contains(&4));
    instances[3].visible = false;
    scene.set_instances(&instances);
    assert!(!picture(&mut renderer, &scene, &camera()).ids.contains(&4));
}

#[test]
fn highlights_show_to_people_alone_and_never_in_other_planes() {
    let (mut scene, _) = scene();
    let mut renderer = CpuRenderer::new(2);
    let people = Camera { for_people: true, ..camera() };
    let (plain, smooth) = (picture(&mut renderer, &scene, &camera()), picture(&mut renderer, &scene, &people));
    scene.set_highlights(&[Highlight { id: 3, color: [255, 0, 255] }]);
    let lit = picture(&mut renderer, &scene, &people);
    assert!(picture(&mut renderer, &scene, &camera()) == plain);
    assert!(lit.color != smooth.color && smooth.color != plain.color);
    assert!(lit.ids == plain.ids && lit.depth_m == plain.depth_m && lit.normals == plain.normals);
    let bright = lit.color.chunks(4).filter(|pixel| pixel[0] > 240 && pixel[1] < 30 && pixel[2] > 240).count();
    assert!(bright > 20, "{bright}");
    let mut color = vec![0; people.pixels() * 4];
    renderer.render(&scene, &people, &mut Planes { color: Some(&mut color), ..Planes::default() });
    assert!(color == lit.color, "the outline needs no id plane");
}

#[test]
fn states_change_the_picture() {
    let (mut scene, instances) = scene();
    let mut renderer = CpuRenderer::new(1);
    let before = picture(&mut renderer, &scene, &camera()).color;
    let changes: [fn(&mut [Instance]); 6] = [
        |all| all[2].flags.set(StateFlag::Broken, true),
        |all| all[0].color = Color::Blue,
        |all| all[0].opened = 1.0,
        |all| all[0].flags.set(StateFlag::Dirty, true),
        |all| all[2].flags.set(StateFlag::Hot, true),
        |all| all[3].look = Look::Robot { head_pitch_rad: -0.4, arm: 1.0, holds: false, rolled_m: 0.0 },
    ];
    for (index, change) in changes.into_iter().enumerate() {
        let mut changed = instances.clone();
        change(&mut changed);
        scene.set_instances(&changed);
        assert!(picture(&mut renderer, &scene, &camera()).color != before, "change {index}");
    }
    scene.set_instances(&instances);
    assert!(picture(&mut renderer, &scene, &camera()).color == before);
    scene.set_lights(RoomId::LAB1, false);
    let dark = picture(&mut renderer, &scene, &camera()).color;
    let sum = |color: &[u8]| color.iter().map(|byte| u64::from(*byte)).sum::<u64>();
    assert!(sum(&dark) < sum(&before) * 3 / 4);
}

#[test]
fn from_above_the_rooms_lie_open() {
    let (scene, _) = scene();
    let above = Camera { position_m: [4.5, 3.0, 14.0], pitch_rad: -1.55, ceiling: false, ..camera() };
    let ids = picture(&mut CpuRenderer::new(1), &scene, &above).ids;
    for id in [1, 2, 3, 4, 5, 6, 7, room_surface_id(7, RoomSurface::Floor)] {
        assert!(ids.contains(&id), "{id}");
    }
    assert!(!ids.contains(&room_surface_id(3, RoomSurface::Ceiling)));
}

#[test]
fn odd_cameras_do_no_harm() {
    let (scene, _) = scene();
    let mut renderer = CpuRenderer::new(2);
    let odd = [
        Camera { width: 0, ..camera() },
        Camera { width: 1, height: 1, for_people: true, ..camera() },
        Camera { width: 3, height: 70, for_people: true, ..camera() },
        Camera { position_m: [3.0, 2.2, 0.2], ..camera() },
        Camera { position_m: [1e6, -1e6, 50.0], ..camera() },
        Camera { fov_y_rad: 3.1, ..camera() },
        Camera { pitch_rad: 1.6, yaw_rad: 1e4, ..camera() },
        Camera { position_m: [f32::NAN; 3], ..camera() },
    ];
    for camera in odd {
        let all = picture(&mut renderer, &scene, &camera);
        assert!(all.depth_m.iter().all(|depth| *depth > 0.0 && *depth <= FAR_M * 1.001), "{camera:?}");
    }
}

#[test]
#[should_panic(expected = "pixels long")]
fn planes_of_the_wrong_length_are_refused() {
    let (scene, _) = scene();
    let mut ids = vec![0; 3];
    CpuRenderer::new(1).render(&scene, &camera(), &mut Planes { ids: Some(&mut ids), ..Planes::default() });
}

#[test]
fn scenes_and_renderers_go_to_other_threads() {
    fn check<T: Send>() {}
    check::<Scene>();
    check::<CpuRenderer>();
}
