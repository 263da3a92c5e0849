//! Nothing that is built in lies in the plane of anything else.

use std::fmt::Write as _;
use std::sync::Arc;

use cohabit_cdf::catalog::Stands;
use cohabit_cdf::layout::Layout;
use cohabit_cdf::model::{Model, Part};
use cohabit_cdf::{Catalog, ClassId};

use super::*;
use crate::gallery::{self, Cell};
use crate::kit::Detail;
use crate::library::MeshLibrary;
use crate::{Instance, Look, furnish, model_mesh};

/// Surfaces are at least this far apart, m.
const GAP_M: f64 = 0.0004;

/// From where objects are looked at: yaw and pitch, the front ones first. Nobody sees the back of what hangs on a wall.
fn sides(stands: Stands) -> &'static [[f32; 2]] {
    const ALL: [[f32; 2]; 7] =
        [[2.5, -0.4], [3.9, -0.3], [3.3, -1.35], [2.9, 0.5], [0.62, -0.42], [5.4, -0.3], [0.4, 0.5]];
    if stands == Stands::OnWall { &ALL[..4] } else { &ALL }
}

/// A camera around a cell's box.
fn around(cell: &Cell, yaw_rad: f32, pitch_rad: f32, side_px: u32) -> Camera {
    let front = cell.camera(side_px);
    let [min, max] = cell.around.map(Vec3::from_array);
    let middle = (min + max) * 0.5;
    let away = (Vec3::from_array(front.position_m) - middle).length();
    let (sin, cos) = libm::sincosf(yaw_rad);
    let (rise, flat) = libm::sincosf(pitch_rad);
    let position_m = (middle - Vec3::new(cos * flat, sin * flat, rise) * away).to_array();
    Camera { position_m, yaw_rad, pitch_rad, ceiling: true, for_people: false, ..front }
}

/// The part, from 0, of each triangle of a model.
fn parts_of(model: &Model, level: usize) -> Vec<usize> {
    let precision = model_mesh::precision(model, Detail::ALL[level]).unwrap();
    let mut parts = Vec::new();
    model_mesh::build_and_tell(model, &precision, |index, end| parts.resize(end, index)).unwrap();
    parts
}

/// What stands in the id plane, in words.
fn name(catalog: &Catalog, instances: &[Instance], id: u32) -> String {
    match instances.iter().find(|instance| instance.id == id).map(|instance| instance.look) {
        Some(Look::Object(class)) => format!("{} (id {id})", catalog.class(class).id),
        _ if id >= 1 << 24 => format!("room {} surface {}", id >> 8 & 0xFF, id & 0xFF),
        _ => format!("id {id}"),
    }
}

/// All fights of a scene from some cameras, one for each pair of parts and direction.
struct Report<'a> {
    catalog: &'a Catalog,
    parts: BTreeMap<(usize, usize), Vec<usize>>,
    all: BTreeMap<[String; 3], (u32, f64, String)>,
}

impl<'a> Report<'a> {
    fn new(catalog: &'a Catalog) -> Self {
        Self { catalog, parts: BTreeMap::new(), all: BTreeMap::new() }
    }

    fn add(
        &mut self,
        scene: &Scene,
        instances: &[Instance],
        cameras: &[Camera],
        level: usize,
        gap_m: f64,
        label: &str,
    ) {
        let faces = faces(scene, level, true);
        for camera in cameras {
            // Nobody sees what things stand on.
            let seen = |fight: &Fight| camera.pitch_rad < 0.0 || fight.place[2] > 0.001;
            for fight in fights(&faces, camera, gap_m).into_iter().filter(seen) {
                let [a, b] = fight.owners.map(|owner| self.name(instances, owner, level));
                let facing = format!("facing {:.1?}", fight.outward.map(|value| value + 0.0));
                let at = || format!("{label} at {:.3?} {facing}", fight.place);
                let entry = self.all.entry([a, b, facing.clone()]).or_insert_with(|| (0, f64::MAX, at()));
                entry.0 += fight.count;
                entry.1 = entry.1.min(fight.gap_m);
            }
        }
    }

    fn name(&mut self, instances: &[Instance], owner: Owner, level: usize) -> String {
        let name = name(self.catalog, instances, owner.id);
        let Some((index, model)) = owner.model.and_then(|index| Some((index, self.catalog.models().get(index)?)))
        else {
            return format!("{name} surface {}", owner.surface);
        };
        let parts = self.parts.entry((index, level)).or_insert_with(|| parts_of(model, level));
        let part = parts[owner.triangle as usize];
        let Part { at, shape, color, .. } = &model.parts[part];
        let shape: String = format!("{shape:?}").chars().take(90).collect();
        format!("{name} {} part {} at {at:?} {shape} {color:?} surface {}", model.id, part + 1, owner.surface)
    }

    fn text(&self) -> String {
        let mut lines: Vec<_> = self.all.iter().collect();
        lines.sort_by_key(|(_, fight)| std::cmp::Reverse(fight.0));
        let mut text = String::new();
        for ([a, b, _], (count, gap_m, at)) in lines {
            writeln!(text, "{count} px, {:.3} mm apart, {at}:\n    {a}\n    {b}", gap_m * 1e3).unwrap();
        }
        text
    }
}

#[test]
#[ignore = "thorough: for whoever changes models"]
fn models_thoroughly() {
    let catalog = Catalog::builtin();
    let meshes = Arc::new(MeshLibrary::build(&catalog).unwrap());
    let gap_m = std::env::var("GAP_MM").ok().and_then(|text| text.parse::<f64>().ok()).map_or(GAP_M, |gap| gap / 1e3);
    let mut report = Report::new(&catalog);
    let mut stage = gallery::stage(&meshes);
    for index in 0..catalog.classes().len() {
        let class = ClassId(index as u16);
        for cell in gallery::cells(&meshes, &catalog, class) {
            let plain = cell.instances[0].color == cohabit_cdf::Color::Original && cell.instances[0].scale == [1.0; 3];
            if !plain {
                continue;
            }
            cell.enter(&mut stage);
            let cameras: Vec<Camera> = sides(catalog.class(class).stands)
                .iter()
                .map(|[yaw, pitch]| around(&cell, *yaw, *pitch, 160))
                .collect();
            for level in 0..3 {
                report.add(&stage, &cell.instances, &cameras, level, gap_m, &format!("{} level {level}", cell.label));
            }
        }
    }
    println!("{}", report.text());
}

#[test]
#[ignore = "thorough: for whoever changes floor plans"]
fn layouts_thoroughly() {
    let catalog = Catalog::builtin();
    let meshes = Arc::new(MeshLibrary::build(&catalog).unwrap());
    let gap_m = std::env::var("GAP_MM").ok().and_then(|text| text.parse::<f64>().ok()).map_or(GAP_M, |gap| gap / 1e3);
    for id in Layout::builtin_ids().iter().filter(|id| !id.ends_with("_mirror")) {
        let mut report = Report::new(&catalog);
        let layout = Layout::builtin(id).unwrap();
        let mut scene = Scene::new(Arc::clone(&meshes), &layout);
        let instances = furnish(&catalog, &layout);
        for (level, opened, step) in [(0, 0.0, 1), (0, 1.0, 3), (1, 0.0, 3), (2, 0.0, 3)] {
            let opened: Vec<Instance> = instances.iter().map(|own| Instance { opened, ..own.clone() }).collect();
            scene.set_instances(&opened);
            let cameras: Vec<Camera> = layout
                .viewpoints
                .iter()
                .step_by(step)
                .map(|at| Camera {
                    position_m: [at.at_m[0], at.at_m[1], 1.3],
                    yaw_rad: at.yaw_deg.to_radians(),
                    pitch_rad: -0.2,
                    fov_y_rad: 1.2,
                    width: 320,
                    height: 240,
                    hide: None,
                    for_people: false,
                    ceiling: true,
                })
                .collect();
            report.add(&scene, &opened, &cameras, level, gap_m, &format!("{id} level {level}"));
        }
        // Within one instance is the models' own business.
        report.all.retain(|[a, b, _], _| a.split(')').next() != b.split(')').next() || a.starts_with("room"));
        println!("{id}\n{}", report.text());
    }
}
