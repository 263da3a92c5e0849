//! The scene in three dimensions: floor plan, objects and bodies as meshes, the ways that bodies went.

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
};

use cohabit_bus::message::{BodyRecord, ObjectRecord, StateView};
use cohabit_cdf::{BodyId, Catalog, Layout, ObjectId, RoomId, layout::Room};
use cohabit_engine::{body_instance_id, object_instance_id};
use cohabit_render::{Figure, MeshLibrary, RoomSurface, Scene, Shape, Soup, room_surface_of_id};
use re_sdk_types::{
    archetypes::{LineStrips3D, Mesh3D, Points3D, Transform3D, ViewCoordinates},
    components::{MeshFaceRendering, ShowLabels},
    datatypes::Bool,
};

use crate::{
    looks::{self, Gaits},
    recording::{Recording, part},
};

/// The level of detail of what is shown: the finest is 0.
const LEVEL: usize = 1;
/// What moved less than this did not move.
const STILL: f32 = 1e-4;
/// A way is told in legs of so many points, so far from each other, m.
const LEG_POINTS: usize = 64;
const STRIDE_M: f32 = 0.1;
/// Ways lie so far above the floor, m.
const ABOVE_FLOOR_M: f32 = 0.03;
const WAY_RADIUS_M: f32 = 0.025;
/// Names hang so high above bodies, m.
const NAME_M: f32 = 2.05;

/// The colour of rooms' names.
const PLAN_NAMES: [u8; 3] = [235, 235, 235];
/// Colours of bodies' ways and names, over and over.
const BODY_COLORS: [[u8; 3]; 4] = [[125, 180, 255], [255, 140, 120], [130, 220, 150], [215, 150, 255]];

/// Nine numbers of a matrix, column by column, then the offset.
type Pose = [f32; 12];

/// One session's office.
pub struct Office {
    catalog: Arc<Catalog>,
    scene: Scene,
    gaits: Gaits,
    /// By instance and part: what was logged.
    known: BTreeMap<(u32, u32), Known>,
    /// Where each instance is logged.
    paths: BTreeMap<u32, String>,
    ways: BTreeMap<u32, Way>,
}

struct Known {
    shape: Shape,
    pose: Pose,
}

/// The newest leg of a body's way.
#[derive(Default)]
struct Way {
    leg: usize,
    points: Vec<[f32; 3]>,
}

impl Office {
    /// The office of a floor plan; tells what never changes.
    pub fn new(
        recording: &Recording,
        layout: &Layout,
        catalog: Arc<Catalog>,
        meshes: Arc<MeshLibrary>,
    ) -> anyhow::Result<Self> {
        let scene = Scene::new(meshes, layout);
        recording.log_always("world", &ViewCoordinates::RIGHT_HAND_Z_UP())?;
        for (room, surfaces) in surfaces(&scene, &catalog) {
            for (name, soup) in surfaces {
                // Walls look into their room alone: one sees in from outside.
                let mesh = mesh(&soup).with_face_rendering(MeshFaceRendering::Front);
                recording.log_always(&format!("world/plan/{}/{name}", room.id()), &mesh)?;
            }
        }
        let named = |room: &Room| Some((middle(room.rects_m.first()?), room.id.name_in(&catalog).to_owned()));
        let names = layout.rooms.iter().filter_map(named);
        let (places, names): (Vec<_>, Vec<_>) = names.unzip();
        let labels = Points3D::new(places).with_labels(names).with_radii([0.0_f32]).with_colors([PLAN_NAMES]);
        recording.log_always("world/plan/names", &labels.with_show_labels(ShowLabels(Bool(true))))?;
        Ok(Self {
            catalog,
            scene,
            gaits: Gaits::default(),
            known: BTreeMap::new(),
            paths: BTreeMap::new(),
            ways: BTreeMap::new(),
        })
    }

    /// Tells what has changed since the last time.
    pub fn show(&mut self, recording: &Recording, tick: u64, state: &StateView<'_>) -> anyhow::Result<()> {
        for body in state.bodies {
            self.meet(recording, body)?;
            self.walk(recording, body)?;
        }
        for object in state.objects {
            let path = || format!("world/objects/{}", part(object.instance.as_str()));
            self.paths.entry(object_instance_id(ObjectId(object.object))).or_insert_with(path);
        }
        self.scene.set_instances(&looks::instances(tick, state, &mut self.gaits, &self.catalog));
        let figures = self.scene.figures();
        self.forget(recording, &figures)?;
        let mut base = None;
        for figure in &figures {
            if base.is_none_or(|(id, _)| id != figure.id) {
                base = Some((figure.id, figure));
            }
            let Some((_, carrier)) = base else { continue };
            self.place(recording, figure, carrier)?;
        }
        Ok(())
    }

    fn meet(&mut self, recording: &Recording, body: &BodyRecord) -> anyhow::Result<()> {
        let id = body_instance_id(BodyId(body.body));
        if self.paths.contains_key(&id) {
            return Ok(());
        }
        let path = format!("world/bodies/{}", looks::body_name(body));
        let name = Points3D::new([[0.0, 0.0, NAME_M]]).with_labels([looks::body_name(body).replace('_', " ")]);
        let name = name.with_radii([0.0_f32]).with_colors([color(body)]).with_show_labels(ShowLabels(Bool(true)));
        recording.log_always(&format!("{path}/name"), &name)?;
        self.paths.insert(id, path);
        Ok(())
    }

    /// Goes on with the way of a body.
    fn walk(&mut self, recording: &Recording, body: &BodyRecord) -> anyhow::Result<()> {
        let [x, y, _] = body.position_m;
        let way = self.ways.entry(body.body).or_default();
        let here = [x, y, ABOVE_FLOOR_M];
        match way.points.last() {
            Some([west, south, _]) if (x - west).hypot(y - south) < STRIDE_M => return Ok(()),
            _ => way.points.push(here),
        }
        if way.points.len() > 1 {
            let strip = LineStrips3D::new([way.points.clone()]);
            let strip = strip.with_colors([color(body)]).with_radii([WAY_RADIUS_M]);
            recording.log(&format!("world/ways/{}/leg_{}", looks::body_name(body), way.leg), &strip)?;
        }
        if way.points.len() >= LEG_POINTS {
            *way = Way { leg: way.leg + 1, points: vec![here] };
        }
        Ok(())
    }

    /// Clears what is not there any more.
    fn forget(&mut self, recording: &Recording, figures: &[Figure]) -> anyhow::Result<()> {
        let there: BTreeSet<(u32, u32)> = figures.iter().map(|figure| (figure.id, figure.part)).collect();
        let gone: Vec<(u32, u32)> = self.known.keys().filter(|key| !there.contains(key)).copied().collect();
        for (id, figure) in gone {
            if self.known.remove(&(id, figure)).is_none() {
                continue;
            }
            let Some(path) = self.paths.get(&id) else { continue };
            let is_whole = there.range((id, 0)..=(id, u32::MAX)).next().is_none();
            if is_whole {
                recording.clear(path)?;
                self.known.retain(|(other, _), _| *other != id);
            } else {
                recording.clear(&part_path(path, figure))?;
            }
        }
        Ok(())
    }

    /// Tells of a figure what is new of it. The first of an instance carries the others.
    fn place(&mut self, recording: &Recording, figure: &Figure, carrier: &Figure) -> anyhow::Result<()> {
        let Some(path) = self.paths.get(&figure.id) else { return Ok(()) };
        let is_carrier = figure.part == carrier.part;
        let path = if is_carrier { path.clone() } else { part_path(path, figure.part) };
        let pose = if is_carrier { pose(figure) } else { pose_on(figure, carrier) };
        let known = self.known.get_mut(&(figure.id, figure.part));
        if known.as_ref().is_none_or(|known| known.shape != figure.shape) {
            recording.log(&path, &mesh(&self.scene.soup(figure, LEVEL)))?;
        }
        if known.as_ref().is_none_or(|known| moved(&known.pose, &pose)) {
            recording.log(&path, &transform(&pose))?;
        }
        match known {
            Some(known) => *known = Known { shape: figure.shape.clone(), pose },
            None => {
                self.known.insert((figure.id, figure.part), Known { shape: figure.shape.clone(), pose });
            }
        }
        Ok(())
    }
}

/// The surfaces of each room that are seen from above, by name.
fn surfaces(scene: &Scene, catalog: &Catalog) -> BTreeMap<RoomId, BTreeMap<&'static str, Soup>> {
    let mut rooms = BTreeMap::<RoomId, BTreeMap<&'static str, Soup>>::new();
    for soup in scene.soups(0) {
        let Some((room, surface)) = room_surface_of_id(soup.id) else { continue };
        let Some(room) = catalog.room_at(u32::from(room)) else { continue };
        let name = match surface {
            RoomSurface::Floor => "floor",
            RoomSurface::EastWall | RoomSurface::NorthWall | RoomSurface::WestWall | RoomSurface::SouthWall => "walls",
            RoomSurface::Frame => "frames",
            RoomSurface::Ceiling | RoomSurface::Lamp => continue,
        };
        join(rooms.entry(room).or_default().entry(name).or_default(), soup);
    }
    rooms
}

fn join(all: &mut Soup, more: Soup) {
    let first = all.positions.len() as u32;
    all.positions.extend(more.positions);
    all.normals.extend(more.normals);
    all.triangles.extend(more.triangles.iter().map(|triangle| triangle.map(|corner| corner + first)));
    all.colors.extend(more.colors);
}

/// A soup as a mesh, whose colours belong to corners: those of a part share one.
fn mesh(soup: &Soup) -> Mesh3D {
    let mut colors = vec![[128_u8; 3]; soup.positions.len()];
    for (triangle, color) in soup.triangles.iter().zip(&soup.colors) {
        for corner in triangle {
            colors[*corner as usize] = *color;
        }
    }
    Mesh3D::new(soup.positions.iter().copied())
        .with_triangle_indices(soup.triangles.iter().copied())
        .with_vertex_normals(soup.normals.iter().copied())
        .with_vertex_colors(colors)
}

fn pose(figure: &Figure) -> Pose {
    flat(figure.rotation.to_cols_array(), figure.offset.to_array())
}

/// Where a figure is in the frame of the one that carries it.
fn pose_on(figure: &Figure, carrier: &Figure) -> Pose {
    let back = carrier.rotation.inverse();
    flat((back * figure.rotation).to_cols_array(), (back * (figure.offset - carrier.offset)).to_array())
}

fn flat(matrix: [f32; 9], offset: [f32; 3]) -> Pose {
    std::array::from_fn(|place| if place < 9 { matrix[place] } else { offset[place - 9] })
}

fn transform(pose: &Pose) -> Transform3D {
    let matrix: [f32; 9] = std::array::from_fn(|place| pose[place]);
    Transform3D::from_translation_mat3x3([pose[9], pose[10], pose[11]], matrix)
}

fn moved(before: &Pose, now: &Pose) -> bool {
    before.iter().zip(now).any(|(before, now)| (before - now).abs() > STILL)
}

fn part_path(path: &str, figure: u32) -> String {
    format!("{path}/part_{figure}")
}

fn middle([west, south, east, north]: &[f32; 4]) -> [f32; 3] {
    [f32::midpoint(*west, *east), f32::midpoint(*south, *north), 0.1]
}

fn color(body: &BodyRecord) -> [u8; 3] {
    BODY_COLORS[body.body as usize % BODY_COLORS.len()]
}

/// The name of an object of a state.
pub fn name_of(objects: &[ObjectRecord], object: u32) -> Option<&str> {
    objects.iter().find(|record| record.object == object).map(|record| record.instance.as_str())
}
