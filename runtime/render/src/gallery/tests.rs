#![allow(clippy::unwrap_used)]

use std::fmt::Write as _;

use super::*;
use crate::CpuRenderer;
use crate::signs::SIGNS;

/// Side of a picture that is compared.
const SIDE: u32 = 96;
/// Pixels that must differ for a state to be seen.
const LEAST_PX: usize = 12;
/// By how much, of 255, a channel differs then.
const LEAST_STEP: u8 = 8;
/// The most triangles of an object that are drawn at once.
const MOST_TRIANGLES: usize = 1500;
/// An object with more than this has well under half of them at the coarse level.
const MANY_TRIANGLES: usize = 400;
/// What may have more, and how many. Machines of which an office has one, as large as a person and looked at from near:
const LARGE: [(&str, usize); 10] = [
    ("FreezeRay", 4300),
    ("PortalGenerator", 4000),
    ("Embiggenator", 3600),
    ("TeslaCoil", 3300),
    ("Laser", 3000),
    ("ForkLift", 2800),
    ("ColorChangerStation", 2500),
    ("GravityPad", 2500),
    ("YesterdayMachine_01", 2000),
    ("EAC_Machine", 1800),
];
/// Cables and coils, each turn of which is round, and what is written all over or finely woven.
const FINE: [(&str, usize); 9] = [
    ("SM_Prop_Powercable_02", 2600),
    ("TeslaCoil_Small", 2500),
    ("SM_Prop_Plastic_Pipe_Spool_01", 2700),
    ("SM_Prop_NetCable_03", 2200),
    ("SM_Prop_Wirespool_01", 2200),
    ("SM_Prop_Wirespool_Small_01", 1800),
    ("PieFruit_01", 1700),
    ("Jar_PeanutButter_01", 1700),
    ("CoffeeUnMaker_01", 1700),
];
/// What is nothing but sheets, boards and lumps, which no level makes simpler.
const BOXES: [&str; 15] = [
    "AP_Prop_Plant_01",
    "AP_Prop_PaperTray_01_Full_01",
    "SM_Prop_PaperTray_01_Full_01",
    "SM_Prop_Book_Phone_Open_01",
    "SM_Prop_Warehouse_Boxes_Stacked_04",
    "SM_Prop_Crate_Stack_01",
    "SM_Prop_PalletStack_02",
    "SM_Tool_Drill_Chuck_01",
    "Bookshelf_Wooden_01",
    "CandyJar_01",
    "Deembiggenator_Crates",
    "Donut_01",
    "WaterPuddle_01",
    "Laser_CircuitBoard",
    "PBJ_Sandwich",
];

fn library() -> (Catalog, Arc<MeshLibrary>) {
    let catalog = Catalog::builtin();
    let meshes = Arc::new(MeshLibrary::build(&catalog).unwrap());
    (catalog, meshes)
}

fn picture(renderer: &mut CpuRenderer, scene: &Scene, camera: &Camera) -> (Vec<u8>, Vec<u32>) {
    let (mut color, mut ids) = (vec![0; camera.pixels() * 4], vec![0; camera.pixels()]);
    let mut planes = Planes { color: Some(&mut color), ids: Some(&mut ids), ..Planes::default() };
    renderer.render(scene, camera, &mut planes);
    (color, ids)
}

fn classes(catalog: &Catalog) -> impl Iterator<Item = ClassId> {
    (0..catalog.classes().len() as u16).map(ClassId)
}

/// The acceptance of the whole catalogue: a class is seen, and each of its states looks unlike its usual one.
#[test]
fn every_class_and_every_state_can_be_seen() {
    let (catalog, meshes) = library();
    let (mut renderer, mut stage) = (CpuRenderer::new(2), stage(&meshes));
    let mut failures = String::new();
    for class in classes(&catalog) {
        let id = &catalog.class(class).id;
        let cells = cells(&meshes, &catalog, class);
        for cell in &cells[1..] {
            let camera = Camera { for_people: false, ..cell.camera(SIDE) };
            cell.enter(&mut stage);
            let changed = picture(&mut renderer, &stage, &camera).0;
            cells[0].enter(&mut stage);
            let usual = picture(&mut renderer, &stage, &camera).0;
            let differs = |(a, b): &(&[u8], &[u8])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) >= LEAST_STEP);
            let count = changed.chunks(4).zip(usual.chunks(4)).filter(differs).count();
            if count < LEAST_PX {
                writeln!(failures, "{id}: `{}` changes {count} pixels", cell.label).unwrap();
            }
        }
        cells[0].enter(&mut stage);
        let ids = picture(&mut renderer, &stage, &cells[0].camera(SIDE)).1;
        if ids.iter().filter(|id| **id == 1).count() < LEAST_PX {
            writeln!(failures, "{id} is not seen").unwrap();
        }
    }
    assert!(failures.is_empty(), "\n{failures}");
}

#[test]
fn people_and_faces_differ() {
    let (catalog, meshes) = library();
    let (mut renderer, mut stage) = (CpuRenderer::new(2), stage(&meshes));
    let sheet = sheets(&meshes, &catalog).next().unwrap();
    let mut seen: Vec<(String, Vec<u8>)> = Vec::new();
    for cell in &sheet.cells {
        cell.enter(&mut stage);
        let (color, ids) = picture(&mut renderer, &stage, &cell.camera(SIDE));
        assert!(ids.iter().filter(|id| **id == 1).count() > 40, "{}", cell.label);
        let twin = seen.iter().find(|(_, known)| *known == color);
        assert!(twin.is_none(), "`{}` looks like `{}`", cell.label, twin.unwrap().0);
        seen.push((cell.label.clone(), color));
    }
}

#[test]
fn classes_keep_to_their_triangles() {
    let (catalog, meshes) = library();
    let mut failures = String::new();
    for class in classes(&catalog) {
        let id = catalog.class(class).id.as_str();
        let levels = meshes.triangles_at_once(class);
        let named = LARGE.iter().chain(&FINE).find(|(known, _)| *known == id);
        let most = named.map_or(MOST_TRIANGLES, |(_, most)| *most);
        let falling = levels[2] <= levels[0].min(levels[1]);
        if levels[0] > most || !falling {
            writeln!(failures, "{id}: {levels:?} triangles, not {most} at most, fewest at the coarse level").unwrap();
        }
        if named.is_some() && levels[0] <= MOST_TRIANGLES {
            writeln!(failures, "{id}: {levels:?} triangles: needs no exception").unwrap();
        }
        if levels[0] > MANY_TRIANGLES && levels[2] * 20 > levels[0] * 9 && !BOXES.contains(&id) {
            writeln!(failures, "{id}: {levels:?} triangles: the coarse level is not coarse").unwrap();
        }
    }
    assert!(failures.is_empty(), "\n{failures}");
}

/// Everything that can be in a state, in all states at once.
fn crowd(catalog: &Catalog) -> Vec<Instance> {
    let names = ["FreezeRay", "PortalGenerator", "CoffeeMug_Yellow", "V_Monitor_Laser", "Desk_01", "Printer_3D"];
    let every = StateFlag::ALL.into_iter().fold(StateFlags::default(), StateFlags::with);
    let mut all = Vec::new();
    for (index, name) in names.into_iter().enumerate() {
        let look = Look::Object(catalog.find(name).unwrap());
        let instance = Instance { running: 1.0, flags: every, fluid: Fluid::Coffee, ..plain(look) };
        let x = index as f32 * 2.0 - 5.0;
        all.push(Instance { id: index as u32 + 1, position_m: [x, 0.0, 0.0], ..instance });
    }
    all
}

#[test]
fn the_same_moment_looks_the_same_however_it_is_reached() {
    let (catalog, meshes) = library();
    let camera = Camera {
        position_m: [5.0, -7.0, 3.0],
        yaw_rad: 2.2,
        pitch_rad: -0.25,
        fov_y_rad: 1.0,
        width: 160,
        height: 120,
        hide: None,
        for_people: false,
        ceiling: false,
    };
    let crowd = crowd(&catalog);
    let mut stage = stage(&meshes);
    stage.set_instances(&crowd);
    let first = picture(&mut CpuRenderer::new(1), &stage, &camera);
    stage.set_time(NANOS + 333_000_000);
    let later = picture(&mut CpuRenderer::new(1), &stage, &camera);
    assert!(first != later, "what runs moves");
    stage.set_time(NANOS);
    assert!(first == picture(&mut CpuRenderer::new(3), &stage, &camera));
    let mut other = super::stage(&meshes);
    other.set_time(7);
    other.set_instances(&crowd[..2]);
    other.set_time(NANOS);
    other.set_instances(&crowd);
    assert!(first == picture(&mut CpuRenderer::new(2), &other, &camera));
}

#[test]
fn what_rests_does_not_change_with_time() {
    let (catalog, meshes) = library();
    let mut stage = stage(&meshes);
    let resting: Vec<Instance> = classes(&catalog).map(|class| plain(Look::Object(class))).collect();
    stage.set_instances(&resting);
    assert!(!stage.moves());
    stage.set_instances(&crowd(&catalog));
    assert!(stage.moves());
}

#[test]
fn signs_show_one_frame_after_the_other() {
    for sign in &SIGNS {
        let shown: std::collections::BTreeSet<_> = (0..200).map(|step| sign.frame(step * 20_000_000)).collect();
        assert_eq!(shown.len(), sign.frames.len(), "{:?}", sign.flag);
    }
}

#[test]
fn every_sheet_has_pictures_and_a_name_of_its_own() {
    let (catalog, meshes) = library();
    let sheets: Vec<Sheet> = sheets(&meshes, &catalog).collect();
    let shown: usize = sheets.iter().map(|sheet| sheet.cells.len()).sum();
    assert!(shown > catalog.classes().len());
    for (index, sheet) in sheets.iter().enumerate() {
        assert!(!sheet.cells.is_empty() && sheets[..index].iter().all(|other| other.name != sheet.name));
    }
    let small = Sheet { name: "x".to_owned(), cells: sheets[0].cells[..2].to_vec() };
    let picture = small.paint(&mut CpuRenderer::new(1), &meshes, 40);
    assert_eq!(picture.rgba.len(), (picture.width * picture.height * 4) as usize);
    assert_eq!((picture.width, picture.height), (80, 40 + LABEL_PX as u32));
}

/// Where each state is seen.
fn shown_by(flag: StateFlag) -> Option<When> {
    Some(match flag {
        StateFlag::Toggled => When::On,
        StateFlag::Powered => When::Powered,
        StateFlag::Cooked => When::Cooked,
        StateFlag::Cut => When::Cut,
        StateFlag::Cereal => When::Cereal,
        StateFlag::Neutral => When::Neutral,
        StateFlag::Happy => When::Happy,
        StateFlag::Sad => When::Sad,
        StateFlag::Angry => When::Angry,
        StateFlag::Scared => When::Scared,
        _ => return None,
    })
}

#[test]
fn every_state_has_a_look_but_what_only_tells_of_the_past() {
    // By place: in a hand, or by how far it stands open. And what was once done to a thing leaves no trace on it: a
    // picture must not tell what no eye could know.
    let elsewhere = [StateFlag::PickedUp, StateFlag::Opened];
    let past = [StateFlag::Scanned, StateFlag::Examined, StateFlag::Used];
    let (catalog, meshes) = library();
    let models = classes(&catalog).filter_map(|class| meshes.class(class)).map(|look| look.model);
    let models: Vec<usize> = models.chain([meshes.bodies().robot, meshes.bodies().people[0]]).collect();
    for flag in StateFlag::ALL {
        let sign = SIGNS.iter().any(|sign| sign.flag == flag);
        let model = |when| models.iter().any(|model| meshes.model(*model).shows(when));
        let seen = sign || elsewhere.contains(&flag) || shown_by(flag).is_some_and(model);
        assert_eq!(seen, !past.contains(&flag), "{flag:?}");
    }
}
