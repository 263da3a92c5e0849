//! From a file to a class of objects and its model.

use std::path::Path;

use cohabit_cdf::{
    Model, ObjectClass, Property,
    catalog::{Receptacle, Stands, Surface},
    model::{MOST_POINTS, MOST_TRIANGLES, Material, Part, Shape},
};
use glam::Vec3;

use crate::{
    container,
    error::GltfError,
    files::Files,
    frame,
    options::Options,
    palette,
    reduce::reduce,
    scene,
    surface::Finish,
    weld::{Welded, weld},
};

/// The most colours of a model.
const MOST_COLORS: usize = 12;
/// Points nearer to each other than this share of the longest side are one.
const WELD: f32 = 1e-5;
/// Coordinates are written as multiples of this, m.
const GRID_M: f32 = 1e-4;
/// What an object weighs, kg a cubic metre: about as much as wood, or as hollow things of plastic or metal.
pub const DENSITY_KG_M3: f32 = 500.0;
/// Of the box around an object, what its surface encloses at least: one with holes encloses less than is meant.
const LEAST_FILLED: f32 = 0.05;
/// What is higher stands on the floor, if nobody carries it, m.
const ON_FLOOR_M: f32 = 0.45;
/// An anchor of a receptacle takes about as much room along each side, m.
const ANCHOR_M: f32 = 0.3;
/// How often it is tried to get under the wanted number of triangles.
const TRIES: usize = 8;

/// What was made of a file.
#[derive(Clone, Debug)]
pub struct Imported {
    /// The class of objects.
    pub class: ObjectClass,
    /// What it looks like.
    pub model: Model,
    /// How many triangles the file's scene has.
    pub triangles_read: usize,
    /// How many the model has.
    pub triangles: usize,
    /// How many colours the model has.
    pub colors: usize,
    /// How much room it takes, m³, which its mass follows from.
    pub volume_m3: f32,
    /// What of the file was not imported, in words.
    pub left_out: Vec<String>,
}

/// Triangles that look alike.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Group {
    color: usize,
    finish: Finish,
    two_sided: bool,
}

/// Reads a model; `folder` is where its file lies, in which buffers and textures are looked for.
///
/// # Errors
/// [`GltfError`] says what is wrong, where in the file, and what would be right.
pub fn import(bytes: &[u8], folder: Option<&Path>, options: &Options) -> Result<Imported, GltfError> {
    options.check()?;
    let document = container::open(bytes)?;
    let files = Files::new(folder);
    let read = scene::read(&document, &files)?;
    let mut left_out = container::left_out(&document.root);
    left_out.extend(read.left_out);
    let rotation = frame::rotation(options.up, options.front);
    let turned = |corners: [Vec3; 3]| corners.map(|corner| rotation * corner);
    let corners = read.faces.iter().flat_map(|face| turned(face.corners));
    let bounds = frame::bounds(corners).ok_or(GltfError::Empty("export the object as a mesh of triangles"))?;
    let (scale, offset) = frame::placement(bounds, options.size)?;
    let placed = |corners: [Vec3; 3]| turned(corners).map(|corner| corner * scale + offset);
    let area = |[a, b, c]: [Vec3; 3]| (b - a).cross(c - a).length() / 2.0;
    let weighed: Vec<([f32; 3], f32)> =
        read.faces.iter().map(|face| (face.color, area(placed(face.corners)))).collect();
    let (colors, color_of) = palette::reduce(&weighed, MOST_COLORS);
    let mut groups: Vec<Group> = Vec::new();
    let mut group_of = Vec::with_capacity(read.faces.len());
    for (face, color) in read.faces.iter().zip(color_of) {
        let group = Group { color, finish: face.finish, two_sided: face.two_sided };
        group_of.push(groups.iter().position(|known| *known == group).unwrap_or_else(|| {
            groups.push(group);
            groups.len() - 1
        }));
    }
    let longest = ((bounds[1] - bounds[0]) * scale).max_element();
    let faces = read.faces.iter().map(|face| placed(face.corners)).zip(group_of);
    let whole = weld(faces, (longest * WELD).max(1e-6));
    let placed_bounds = bounds.map(|corner| corner * scale + offset);
    let mesh = simplified(&whole, placed_bounds, &groups, options.triangles)?;
    let [low, high] = frame::bounds(mesh.points.iter().copied()).unwrap_or_default();
    let size_m = (high - low).max(Vec3::splat(0.001)).to_array().map(rounded);
    let volume_m3 = volume(&mesh, size_m);
    let mut parts = Parts { mesh: &mesh, groups: &groups, colors: &colors, smooth_deg: options.smooth_deg };
    let (parts, largest) = parts.all(options.tint);
    let class = class_of(options, size_m, volume_m3, colors[largest]);
    let mut used: Vec<usize> = mesh.groups.iter().map(|group| groups[*group].color).collect();
    used.sort_unstable();
    used.dedup();
    Ok(Imported {
        class,
        model: Model { id: options.id.clone(), parts, joints: Vec::new() },
        triangles_read: read.faces.len(),
        triangles: mesh.triangles.len(),
        colors: used.len(),
        volume_m3,
        left_out,
    })
}

/// With so many triangles at most, within the same bounds, on the grid on which coordinates are written, backs included.
fn simplified(whole: &Welded, bounds: [Vec3; 2], groups: &[Group], most: usize) -> Result<Welded, GltfError> {
    let mut target = most;
    let mut have = 0;
    for _ in 0..TRIES {
        let fewer = reduce(whole, target);
        // Round things lose a little of their size.
        let [low, high] = frame::bounds(fewer.points.iter().copied()).unwrap_or(bounds);
        let grown = grown(high - low, bounds[1] - bounds[0]);
        let on_grid = |corner: Vec3| Vec3::from_array(((corner - low) * grown + bounds[0]).to_array().map(rounded));
        let fewer = weld(fewer.faces().map(|(corners, group)| (corners.map(on_grid), group)), GRID_M);
        if fewer.triangles.is_empty() {
            return Err(GltfError::Empty("export the object as a mesh of triangles, or ask for more by --triangles"));
        }
        let shown = fewer.with_backs(|group| groups[group].two_sided);
        have = shown.triangles.len();
        if have <= most {
            return Ok(shown);
        }
        target = (target * most / have).min(target - 1);
        if target < 4 {
            break;
        }
    }
    Err(GltfError::Reduce { have, most })
}

/// By how much each side has to grow; one of which most was lost stays as it is.
fn grown(have: Vec3, wanted: Vec3) -> Vec3 {
    let ratio = |axis: usize| if have[axis] > 0.5 * wanted[axis] { wanted[axis] / have[axis] } else { 1.0 };
    Vec3::new(ratio(0), ratio(1), ratio(2))
}

/// The nearest number that is written with four decimals.
fn rounded(value: f32) -> f32 {
    let steps = (f64::from(value) / f64::from(GRID_M)).round();
    // Not the float nearest to so many steps, but the one that is read from its text.
    (steps / 10_000.0) as f32 + 0.0
}

fn volume(mesh: &Welded, size_m: [f32; 3]) -> f32 {
    let around: f32 = size_m.iter().product();
    mesh.volume().clamp(around * LEAST_FILLED, around)
}

fn class_of(options: &Options, size_m: [f32; 3], volume_m3: f32, color: [u8; 3]) -> ObjectClass {
    let carried = options.properties.contains(&Property::Pickupable);
    let usual = if !carried && size_m[2] > ON_FLOOR_M { Stands::OnFloor } else { Stands::OnSurface };
    let mass_kg = options.mass_kg.unwrap_or_else(|| {
        let mass_kg = volume_m3 * DENSITY_KG_M3;
        ((mass_kg * 1000.0).round() / 1000.0).clamp(0.01, 5000.0)
    });
    let mut properties: Vec<Property> = Vec::new();
    for property in &options.properties {
        if !properties.contains(property) {
            properties.push(*property);
        }
    }
    let receptacle = properties.contains(&Property::Receptacle).then(|| on_top(size_m));
    ObjectClass {
        id: options.id.clone(),
        name: options.shown_name(),
        words: options.words.iter().map(|word| word.trim().to_lowercase()).collect(),
        properties,
        size_m,
        mass_kg,
        color: palette::word(color).to_owned(),
        model: None,
        tint: options.tint.then(|| hex(color)),
        receptacle,
        handle_m: None,
        as_built: Vec::new(),
        stands: options.stands.unwrap_or(usual),
    }
}

/// Things stand on top of it.
fn on_top(size_m: [f32; 3]) -> Receptacle {
    let side = |axis: usize| rounded(size_m[axis] * 0.8);
    let count = |axis: usize| ((side(axis) / ANCHOR_M) as u32).clamp(1, 32);
    let surface = Surface {
        center_m: [0.0, 0.0, size_m[2]],
        size_m: [side(0), side(1)],
        anchors: [count(0), count(1)],
        clearance_m: 0.6,
    };
    Receptacle { surfaces: vec![surface], ..Receptacle::default() }
}

fn hex([red, green, blue]: [u8; 3]) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// From triangles to parts.
struct Parts<'a> {
    mesh: &'a Welded,
    groups: &'a [Group],
    colors: &'a [[u8; 3]],
    smooth_deg: Option<f32>,
}

impl Parts<'_> {
    /// A part, or several where it takes those, for each colour and material, the largest first; and which colour covers the
    /// most of what is not seen through.
    fn all(&mut self, tint: bool) -> (Vec<Part>, usize) {
        let mut looks: Vec<(usize, Finish, f32, Vec<usize>)> = Vec::new();
        for (triangle, group) in self.mesh.groups.iter().enumerate() {
            let Group { color, finish, .. } = self.groups[*group];
            let area = self.mesh.area(triangle);
            match looks.iter_mut().find(|look| (look.0, look.1) == (color, finish)) {
                Some((_, _, sum, own)) => {
                    *sum += area;
                    own.push(triangle);
                }
                None => looks.push((color, finish, area, vec![triangle])),
            }
        }
        looks.sort_by(|one, other| other.2.total_cmp(&one.2));
        let solid = |look: &&(usize, Finish, f32, Vec<usize>)| is_solid(look.1);
        let largest = looks.iter().find(solid).or(looks.first()).map_or(0, |look| look.0);
        let mut parts = Vec::new();
        for (color, finish, _, triangles) in &looks {
            let tinted = tint && *color == largest && is_solid(*finish);
            let color = if tinted { "tint".to_owned() } else { hex(self.colors[*color]) };
            parts.extend(self.meshes(triangles).into_iter().map(|shape| Part {
                shape,
                at: [0.0; 3],
                turn_deg: [0.0; 3],
                color: color.clone(),
                material: finish.material,
                opacity: finish.opacity_tenths.map(|tenths| f32::from(tenths) / 10.0),
                joint: None,
                when: None,
                mirror: None,
                repeat: None,
            }));
        }
        (parts, largest)
    }

    /// As many meshes as it takes for these triangles.
    fn meshes(&self, triangles: &[usize]) -> Vec<Shape> {
        let mut meshes = Vec::new();
        let (mut points, mut faces, mut known) = (Vec::new(), Vec::new(), std::collections::BTreeMap::new());
        for triangle in triangles {
            if faces.len() == MOST_TRIANGLES || points.len() + 3 > MOST_POINTS {
                meshes.push(self.mesh_of(std::mem::take(&mut points), std::mem::take(&mut faces)));
                known.clear();
            }
            faces.push(self.mesh.triangles[*triangle].map(|corner| {
                *known.entry(corner).or_insert_with(|| {
                    points.push(self.mesh.points[corner as usize].to_array());
                    points.len() as u32 - 1
                })
            }));
        }
        if !faces.is_empty() {
            meshes.push(self.mesh_of(points, faces));
        }
        meshes
    }

    fn mesh_of(&self, points: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>) -> Shape {
        Shape::Mesh { points, triangles, smooth_deg: self.smooth_deg }
    }
}

/// Whether it is neither seen through nor shines.
fn is_solid(finish: Finish) -> bool {
    !matches!(finish.material, Material::Clear | Material::Glow)
}

#[cfg(test)]
mod tests;
