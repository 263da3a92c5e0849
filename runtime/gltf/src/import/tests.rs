#![allow(clippy::unwrap_used)]

mod files;
mod hostile;

use cohabit_cdf::{Catalog, ClassId};
use cohabit_render::MeshLibrary;

use super::*;
use crate::{Front, Size, Up, text};
use files::{Builder, cube, quad};

fn read(bytes: &[u8], options: &Options) -> Imported {
    import(bytes, None, options).unwrap()
}

fn options() -> Options {
    Options::new("Thing_Lab")
}

/// What the files say is what was imported, and can be drawn.
fn check_files(imported: &Imported) -> Catalog {
    let (objects, models) = (text::object(&imported.class), text::model(&imported.model));
    let catalog = Catalog::parse(&[("imported.toml", &objects)], &[("Thing_Lab.toml", &models)]).unwrap();
    assert_eq!((&catalog.classes()[0], &catalog.models()[0]), (&imported.class, &imported.model), "{objects}{models}");
    let meshes = MeshLibrary::build(&catalog).unwrap();
    let bounds = meshes.bounds(ClassId(0));
    let (size, low) = (bounds.size().to_array(), bounds.min);
    for axis in 0..3 {
        assert!((size[axis] - imported.class.size_m[axis]).abs() < 1.1e-3, "{size:?} {:?}", imported.class.size_m);
    }
    assert!(
        low.z.abs() < 1e-4 && (low.x + size[0] / 2.0).abs() < 1e-3 && (low.y + size[1] / 2.0).abs() < 1e-3,
        "{low}"
    );
    assert!(meshes.triangles(ClassId(0)) <= imported.triangles);
    catalog
}

/// The colours of the parts, with how many triangles each has.
fn colors(imported: &Imported) -> Vec<(&str, usize)> {
    let triangles = |part: &Part| match &part.shape {
        Shape::Mesh { triangles, .. } => triangles.len(),
        _ => 0,
    };
    imported.model.parts.iter().map(|part| (part.color.as_str(), triangles(part))).collect()
}

#[test]
fn a_cube_becomes_an_object() {
    let mut file = Builder::default();
    let material = file.material(r#"{"pbrMetallicRoughness":{"baseColorFactor":[1,0,0,1],"metallicFactor":0}}"#);
    let cube = file.primitive(&cube([0.1, 0.2, 0.3]), Some(material));
    file.node(&format!(r#"{{"mesh":{}}}"#, file.mesh(&[cube])));
    let properties = vec![Property::Pickupable, Property::Dirtyable];
    let imported = read(&file.glb(), &Options { properties, ..options() });
    assert_eq!((imported.triangles_read, imported.triangles, imported.colors), (12, 12, 1));
    assert_eq!(colors(&imported), [("#ff0000", 12)]);
    // In the file y is up and z is the front.
    assert_eq!(imported.class.size_m, [0.3, 0.1, 0.2]);
    assert_eq!((imported.class.color.as_str(), imported.class.name.as_str()), ("red", "Thing Lab"));
    assert_eq!((imported.class.mass_kg, imported.class.stands), (3.0, Stands::OnSurface));
    assert!(imported.left_out.is_empty(), "{:?}", imported.left_out);
    let Shape::Mesh { points, .. } = &imported.model.parts[0].shape else { panic!("no mesh") };
    assert_eq!(points.len(), 8);
    let catalog = check_files(&imported);
    assert!(catalog.class(ClassId(0)).has(Property::Dirtyable));
    assert_eq!(read(&file.json(), &options()).model, imported.model);
}

#[test]
fn each_triangle_has_the_colour_that_its_texture_shows_there() {
    let mut file = Builder::default();
    let image = file.png([2, 1], &[0, 160, 0, 0, 0, 255]);
    file.texture(&format!(r#"{{"source":{image}}}"#));
    let material = file.material(
        r#"{"pbrMetallicRoughness":{"baseColorTexture":{"index":0},"metallicFactor":0,"roughnessFactor":0.5}}"#,
    );
    // Two squares, one on the left half of the picture and one on the right half.
    let left = file.textured(
        &quad([0.0, 0.0, 0.0], [0.1, 0.1, 0.0]),
        [[0.1, 0.0], [0.4, 0.0], [0.4, 1.0], [0.1, 1.0]],
        material,
    );
    let right = file.textured(
        &quad([0.1, 0.0, 0.0], [0.3, 0.1, 0.0]),
        [[0.6, 0.0], [0.9, 0.0], [0.9, 1.0], [0.6, 1.0]],
        material,
    );
    file.node(&format!(r#"{{"mesh":{}}}"#, file.mesh(&[left, right])));
    let imported = read(&file.glb(), &options());
    assert_eq!(colors(&imported), [("#0000ff", 2), ("#00a000", 2)]);
    assert!(imported.model.parts.iter().all(|part| part.material == Material::Plastic));
    assert_eq!((imported.class.color.as_str(), &imported.class.tint), ("blue", &None));
    check_files(&imported);
    let tinted = read(&file.glb(), &Options { tint: true, smooth_deg: Some(30.0), ..options() });
    assert_eq!(colors(&tinted), [("tint", 2), ("#00a000", 2)]);
    assert_eq!(tinted.class.tint.as_deref(), Some("#0000ff"));
    check_files(&tinted);
}

#[test]
fn nodes_say_where_meshes_are() {
    let mut file = Builder::default();
    let cube = file.primitive(&cube([0.1, 0.1, 0.1]), None);
    let mesh = file.mesh(&[cube]);
    // A leaf that is turned, below one that is moved, below one that is three times as large and mirrored.
    let half = std::f32::consts::FRAC_1_SQRT_2;
    file.json_node(&format!(r#"{{"mesh":{mesh},"translation":[0.5,0,0],"rotation":[0,0,{half},{half}]}}"#));
    file.json_node(r#"{"children":[0],"matrix":[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0.2,0,1]}"#);
    file.node(r#"{"children":[1],"scale":[-3,3,3]}"#);
    file.node(&format!(r#"{{"mesh":{mesh}}}"#));
    let imported = read(&file.glb(), &Options { up: Up::Z, front: Front::PlusX, ..options() });
    // The one cube goes from -1.65 to -1.35, the other from -0.05 to 0.05; along y from 0.45 to 0.75 and from -0.05 to 0.05.
    assert_eq!(imported.class.size_m, [1.7, 0.8, 0.3]);
    assert!((imported.volume_m3 - 0.028).abs() < 1e-4, "{}: a cube is inside out", imported.volume_m3);
    assert_eq!(imported.triangles, 24);
    check_files(&imported);
}

#[test]
fn sizes_and_directions_are_as_asked_for() {
    let mut file = Builder::default();
    let cube = file.primitive(&cube([100.0, 200.0, 400.0]), None);
    file.node(&format!(r#"{{"mesh":{}}}"#, file.mesh(&[cube])));
    let size = |options: Options| import(&file.glb(), None, &options).map(|imported| imported.class.size_m);
    let high = Options { size: Size::Height(0.2), ..options() };
    assert_eq!(size(high.clone()).unwrap(), [0.4, 0.1, 0.2]);
    assert_eq!(size(Options { front: Front::PlusX, ..high.clone() }).unwrap(), [0.1, 0.4, 0.2]);
    assert_eq!(size(Options { up: Up::Z, ..high }).unwrap(), [0.1, 0.05, 0.2]);
    let sides = [0.05, 0.06, 0.07];
    assert_eq!(size(Options { size: Size::Sides(sides), ..options() }).unwrap(), sides);
    let error = size(options()).unwrap_err().to_string();
    assert!(error.contains("400 × 100 × 200 m") && error.contains("--height-m"), "{error}");
}

#[test]
fn many_triangles_become_few() {
    let mut file = Builder::default();
    let ball = files::ball(60);
    let ball = file.primitive(&ball, None);
    file.node(&format!(r#"{{"mesh":{}}}"#, file.mesh(&[ball])));
    let imported = read(&file.glb(), &options());
    assert!(imported.triangles_read > 14_000 && (1400..=1500).contains(&imported.triangles), "{}", imported.triangles);
    let around: f32 = imported.class.size_m.iter().product();
    assert!((imported.volume_m3 / around - std::f32::consts::FRAC_PI_6).abs() < 0.01);
    check_files(&imported);
    let few = read(&file.glb(), &Options { triangles: 100, ..options() });
    assert!((80..=100).contains(&few.triangles), "{}", few.triangles);
    check_files(&few);
    // More than one part can hold.
    let many = read(&file.glb(), &Options { triangles: 12_000, ..options() });
    assert!((11_000..=12_000).contains(&many.triangles) && colors(&many).len() > 2, "{:?}", colors(&many));
    check_files(&many);
}

#[test]
fn sheets_are_seen_from_both_sides_where_their_material_says_so() {
    let mut file = Builder::default();
    let material = file.material(r#"{"doubleSided":true}"#);
    let sheet = file.primitive(&quad([0.0, 0.0, 0.0], [0.2, 0.3, 0.0]), Some(material));
    let cube = file.primitive(&cube([0.1, 0.1, 0.1]), Some(material));
    file.node(&format!(r#"{{"mesh":{}}}"#, file.mesh(&[sheet])));
    file.node(&format!(r#"{{"mesh":{},"translation":[0,0,1]}}"#, file.mesh(&[cube])));
    assert_eq!(read(&file.glb(), &options()).triangles, 4 + 12);
}

#[test]
fn materials_become_those_of_the_project() {
    for (material, expected, opacity) in [
        (r#"{"pbrMetallicRoughness":{"metallicFactor":1,"roughnessFactor":0.2}}"#, Material::Metal, None),
        (r#"{"pbrMetallicRoughness":{"metallicFactor":0,"roughnessFactor":0.2}}"#, Material::Ceramic, None),
        (r#"{"pbrMetallicRoughness":{"metallicFactor":0}}"#, Material::Plain, None),
        (
            r#"{"alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.35],"metallicFactor":0}}"#,
            Material::Clear,
            Some(0.4),
        ),
        (r#"{"extensions":{"KHR_materials_transmission":{"transmissionFactor":1}}}"#, Material::Clear, Some(0.2)),
        (r#"{"emissiveFactor":[1,0.5,0]}"#, Material::Glow, None),
        (
            r#"{"extensions":{"KHR_materials_pbrSpecularGlossiness":{"diffuseFactor":[0,0,1,1],"glossinessFactor":0.9}}}"#,
            Material::Ceramic,
            None,
        ),
        (r#"{"alphaMode":"MASK","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.6]}}"#, Material::Metal, None),
    ] {
        let mut file = Builder::default();
        let index = file.material(material);
        let cube = file.primitive(&cube([0.1, 0.1, 0.1]), Some(index));
        file.node(&format!(r#"{{"mesh":{}}}"#, file.mesh(&[cube])));
        let imported = read(&file.glb(), &options());
        let part = &imported.model.parts[0];
        assert_eq!((part.material, part.opacity), (expected, opacity), "{material}");
        check_files(&imported);
    }
}

#[test]
fn indices_of_all_kinds_strips_and_none_say_the_same() {
    let points = quad([0.0, 0.0, 0.0], [0.2, 0.1, 0.0]).0;
    let shape = |add: &dyn Fn(&mut Builder) -> String| {
        let mut file = Builder::default();
        let primitive = add(&mut file);
        file.node(&format!(r#"{{"mesh":{}}}"#, file.mesh(&[primitive])));
        let imported = read(&file.glb(), &options());
        (imported.class.size_m, imported.triangles)
    };
    let with = |kind: u32, bytes: &'static [u8], mode: u32| {
        let points = points.clone();
        move |file: &mut Builder| {
            let (positions, indices) = (file.vectors(&points), file.indices(kind, bytes));
            format!(r#"{{"attributes":{{"POSITION":{positions}}},"indices":{indices},"mode":{mode}}}"#)
        }
    };
    let expected = ([0.001, 0.2, 0.1], 2);
    assert_eq!(shape(&with(5121, &[0, 1, 2, 0, 2, 3], 4)), expected);
    assert_eq!(shape(&with(5123, &[0, 0, 1, 0, 2, 0, 0, 0, 2, 0, 3, 0], 4)), expected);
    assert_eq!(shape(&with(5125, &[0, 0, 0, 0, 1, 0, 0, 0, 3, 0, 0, 0, 2, 0, 0, 0], 5)), expected);
    assert_eq!(shape(&with(5121, &[0, 1, 2, 3], 6)), expected);
    let fan = |file: &mut Builder| format!(r#"{{"attributes":{{"POSITION":{}}},"mode":6}}"#, file.vectors(&points));
    assert_eq!(shape(&fan), expected);
    // Whole numbers that stand for shares, as small files have them.
    let small = |file: &mut Builder| {
        let bytes = [0, 0, 0, 0, 255, 0, 0, 0, 255, 255, 0, 0, 0, 255, 0, 0];
        let positions =
            file.accessor(&bytes, Some(4), r#""componentType":5121,"normalized":true,"count":4,"type":"VEC3""#);
        format!(r#"{{"attributes":{{"POSITION":{positions}}},"mode":6}}"#)
    };
    assert_eq!(shape(&small), ([0.001, 1.0, 1.0], 2));
    // The last point lies elsewhere than the buffer says.
    let sparse = |file: &mut Builder| {
        let positions = file.sparse(&points, 3, [0.0, 0.4, 0.0]);
        format!(r#"{{"attributes":{{"POSITION":{positions}}},"mode":6}}"#)
    };
    assert_eq!(shape(&sparse), ([0.001, 0.2, 0.4], 2));
}

#[test]
fn colours_of_points_count() {
    let mut file = Builder::default();
    let (points, _) = quad([0.0, 0.0, 0.0], [0.2, 0.1, 0.0]);
    let positions = file.vectors(&points);
    let colors = file.vectors(&[[0.0, 0.0, 1.0]; 4]);
    let primitive = format!(r#"{{"attributes":{{"POSITION":{positions},"COLOR_0":{colors}}},"mode":6}}"#);
    file.node(&format!(r#"{{"mesh":{}}}"#, file.mesh(&[primitive])));
    let imported = read(&file.glb(), &options());
    assert_eq!((imported.model.parts[0].color.as_str(), imported.class.color.as_str()), ("#0000cb", "blue"));
}

#[test]
fn what_is_not_imported_is_named() {
    let mut file = Builder::default();
    let cube = file.primitive(&cube([0.1, 0.1, 0.1]), None);
    let lines = cube.replace('{', r#"{"mode":1,"#).replacen(r#"{"mode":1,"POSITION"#, r#"{"POSITION"#, 1);
    let morphing = cube.replacen('{', r#"{"targets":[{"POSITION":0}],"#, 1);
    file.node(&format!(r#"{{"mesh":{}}}"#, file.mesh(&[morphing, lines])));
    file.more = concat!(
        r#","cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":0.1}}],"#,
        r#""extensionsUsed":["KHR_lights_punctual","KHR_materials_unlit","KHR_draco_mesh_compression"],"#,
        r#""skins":[{"joints":[0]}],"animations":[{"channels":[],"samplers":[]}]"#
    );
    let left_out = read(&file.glb(), &options()).left_out.join("\n");
    for expected in
        ["1 × animation", "1 × skin", "1 × set of morph", "1 × camera", "lights (", "KHR_draco", "of points or lines"]
    {
        assert!(left_out.contains(expected), "{expected}: {left_out}");
    }
    assert!(!left_out.contains("unlit"), "{left_out}");
}

#[test]
fn a_receptacle_has_places_on_top() {
    let mut file = Builder::default();
    let cube = file.primitive(&cube([0.6, 0.7, 0.4]), None);
    file.node(&format!(r#"{{"mesh":{}}}"#, file.mesh(&[cube])));
    let asked = Options {
        properties: vec![Property::Receptacle, Property::Receptacle],
        name: Some(" Lab table ".to_owned()),
        words: vec!["Bench".to_owned()],
        mass_kg: Some(20.0),
        ..options()
    };
    let imported = read(&file.glb(), &asked);
    let surface = imported.class.receptacle.as_ref().unwrap().surfaces[0];
    assert_eq!((surface.center_m, surface.anchors), ([0.0, 0.0, 0.7], [1, 1]));
    assert_eq!((imported.class.stands, imported.class.mass_kg), (Stands::OnFloor, 20.0));
    assert_eq!((imported.class.name.as_str(), &imported.class.words[..]), ("Lab table", &["bench".to_owned()][..]));
    assert_eq!(imported.class.properties, [Property::Receptacle]);
    check_files(&imported);
}
