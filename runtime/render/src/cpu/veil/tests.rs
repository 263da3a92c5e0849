#![allow(clippy::unwrap_used)]

use std::sync::Arc;

use cohabit_cdf::{Catalog, Color, Fluid, RoomId, StateFlag, StateFlags};

use crate::gallery::stage;
use crate::{Camera, CpuRenderer, Instance, Look, MeshLibrary, Planes, Renderer, Scene};

const OBJECTS: [&str; 4] = ["Block", "Pane", "Cloud", "Ray"];

/// Slabs that face west and east, and a ball of mist.
const MODELS: &str = r##"
[[model]]
id = "Block"
part = [{ shape = "box", size = [0.2, 2.0, 2.0], bevel = 0.0, color = "#8a5040" }]
[[model]]
id = "Pane"
part = [{ shape = "box", size = [0.02, 1.0, 1.0], bevel = 0.0, color = "tint", material = "clear", opacity = 0.5 }]
[[model]]
id = "Cloud"
part = [{ shape = "sphere", radii = [0.4, 0.4, 0.4], at = [0, 0, 0.5], color = "#f0f4f8", material = "mist" }]
[[model]]
id = "Ray"
part = [{ shape = "cylinder", radius = 0.2, height = 1.0, color = "#ff2010", material = "beam" }]
"##;

fn meshes() -> (Catalog, Arc<MeshLibrary>) {
    let object = |id: &str| {
        format!(
            "[[object]]\nid = \"{id}\"\nname = \"{id}\"\nsize_m = [0.2, 1.0, 1.0]\nmass_kg = 1.0\ncolor = \"white\"\n\
             model = \"{id}\"\n"
        )
    };
    let objects: String = OBJECTS.into_iter().map(object).collect();
    let catalog = Catalog::parse(&[("objects", &objects)], &[("models", MODELS)]).unwrap();
    let meshes = Arc::new(MeshLibrary::build(&catalog).unwrap());
    (catalog, meshes)
}

/// What stands there, and at which `x`: numbered from 1.
fn scene(things: &[(&str, f32)]) -> (Scene, Vec<Instance>) {
    let (catalog, meshes) = meshes();
    let of = |(index, (id, x)): (usize, &(&str, f32))| Instance {
        id: index as u32 + 1,
        look: Look::Object(catalog.find(id).unwrap()),
        position_m: [*x, 0.0, 0.0],
        rotation: [0.0, 0.0, 0.0, 1.0],
        scale: [1.0; 3],
        flags: StateFlags::default(),
        fluid: Fluid::None,
        color: Color::Original,
        opened: 0.0,
        running: 0.0,
        room: RoomId::LAB1,
        visible: true,
    };
    let instances: Vec<Instance> = things.iter().enumerate().map(of).collect();
    let mut scene = stage(&meshes);
    scene.set_instances(&instances);
    (scene, instances)
}

/// From the west, level with the middle of everything.
fn camera() -> Camera {
    Camera {
        position_m: [-3.0, 0.02, 0.52],
        yaw_rad: 0.0,
        pitch_rad: 0.0,
        fov_y_rad: 0.7,
        width: 121,
        height: 101,
        hide: None,
        for_people: false,
        ceiling: false,
    }
}

#[derive(Clone, Debug, PartialEq)]
struct Picture {
    color: Vec<u8>,
    depth_m: Vec<f32>,
    normals: Vec<i8>,
    ids: Vec<u32>,
}

impl Picture {
    fn of(renderer: &mut CpuRenderer, scene: &Scene, camera: &Camera) -> Self {
        let pixels = camera.pixels();
        let mut all = Self {
            color: vec![0; pixels * 4],
            depth_m: vec![0.0; pixels],
            normals: vec![0; pixels * 4],
            ids: vec![0; pixels],
        };
        let mut planes = Planes {
            color: Some(&mut all.color),
            depth_m: Some(&mut all.depth_m),
            normals: Some(&mut all.normals),
            ids: Some(&mut all.ids),
        };
        renderer.render(scene, camera, &mut planes);
        all
    }

    fn seen(things: &[(&str, f32)]) -> Self {
        Self::of(&mut CpuRenderer::new(1), &scene(things).0, &camera())
    }

    /// The middle of the picture: colour, depth, normal, id.
    fn middle(&self) -> ([u8; 3], f32, [i8; 3], u32) {
        let at = self.ids.len() / 2;
        let (color, normal) = (&self.color[at * 4..], &self.normals[at * 4..]);
        ([color[0], color[1], color[2]], self.depth_m[at], [normal[0], normal[1], normal[2]], self.ids[at])
    }
}

#[test]
fn a_pane_is_what_is_pointed_at_and_what_is_behind_shows_through() {
    let (bare, paned) = (Picture::seen(&[("Block", 1.0)]), Picture::seen(&[("Block", 1.0), ("Pane", 0.0)]));
    let ((behind, far, ..), (through, near, normal, id)) = (bare.middle(), paned.middle());
    assert_eq!((id, normal), (2, [-127, 0, 0]));
    assert!((far - 3.9).abs() < 0.01 && (near - 2.99).abs() < 0.01, "{far} {near}");
    // Half the pane's own grey, half of what is behind: the red of the block still shows.
    assert!(through != behind && through[0] > through[1] + 8, "{through:?} over {behind:?}");
    let nothing = Picture::seen(&[("Pane", 0.0)]);
    assert!(nothing.middle().0 != through, "what is behind matters");
}

#[test]
fn mist_and_beams_change_colour_alone() {
    for airy in ["Cloud", "Ray"] {
        let (bare, misty) = (Picture::seen(&[("Block", 1.0)]), Picture::seen(&[("Block", 1.0), (airy, 0.0)]));
        assert!(bare.color != misty.color, "{airy}");
        assert!(bare.ids == misty.ids && bare.depth_m == misty.depth_m && bare.normals == misty.normals, "{airy}");
    }
}

#[test]
fn what_is_nearer_hides_what_is_seen_through() {
    for veil in ["Pane", "Cloud", "Ray"] {
        let (bare, hidden) = (Picture::seen(&[("Block", -1.0)]), Picture::seen(&[("Block", -1.0), (veil, 0.0)]));
        assert_eq!(bare.middle(), hidden.middle(), "{veil}");
    }
}

#[test]
fn the_farther_pane_is_laid_down_first() {
    let (mut stage, mut panes) = scene(&[("Pane", -0.5), ("Pane", 0.5)]);
    (panes[0].color, panes[1].color) = (Color::Red, Color::Blue);
    let mut picture = |panes: &[Instance]| {
        stage.set_instances(panes);
        Picture::of(&mut CpuRenderer::new(1), &stage, &camera()).middle()
    };
    let (red_first, ..) = picture(&panes);
    (panes[0].color, panes[1].color) = (Color::Blue, Color::Red);
    let (blue_first, ..) = picture(&panes);
    assert!(red_first[0] > blue_first[0] && red_first[2] < blue_first[2], "{red_first:?} {blue_first:?}");
    // Nor does it matter in which order they are told.
    panes.swap(0, 1);
    assert_eq!(picture(&panes).0, blue_first);
}

#[test]
fn the_same_bits_for_any_threads_processor_and_planes() {
    let (mut scene, mut instances) =
        scene(&[("Block", 1.2), ("Cloud", 0.6), ("Pane", 0.3), ("Pane", -0.2), ("Ray", -0.4), ("Cloud", -0.6)]);
    instances[2].rotation = [0.0, 0.13, 0.25, 0.959];
    instances[3].flags.set(StateFlag::Cold, true);
    scene.set_instances(&instances);
    for position_m in [[-3.0, 0.3, 0.8], [-0.4, 0.1, 0.5], [0.1, -1.4, 1.2]] {
        for for_people in [false, true] {
            let camera = Camera { position_m, for_people, ..camera() };
            let one = Picture::of(&mut CpuRenderer::new(1), &scene, &camera);
            for mut other in [CpuRenderer::new(2), CpuRenderer::new(5), CpuRenderer::without_wide_vectors()] {
                assert!(one == Picture::of(&mut other, &scene, &camera), "{camera:?}");
            }
            let mut ids = vec![0; camera.pixels()];
            let mut planes = Planes { ids: Some(&mut ids), ..Planes::default() };
            CpuRenderer::new(2).render(&scene, &camera, &mut planes);
            assert!(ids == one.ids);
        }
    }
}

#[test]
fn panes_throw_shadows_and_mist_does_not() {
    let above = Camera { position_m: [0.0, 0.0, 6.0], pitch_rad: -1.55, hide: Some(1), ..camera() };
    let picture = |things: &[(&str, f32)]| Picture::of(&mut CpuRenderer::new(1), &scene(things).0, &above).color;
    let empty = picture(&[]);
    assert!(picture(&[("Pane", 0.0)]) != empty);
    for airy in ["Cloud", "Ray"] {
        assert!(picture(&[(airy, 0.0)]) == empty, "{airy}");
    }
}
