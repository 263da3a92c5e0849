//! From a model's parts to a mesh: placed, mirrored, repeated, painted, and gathered into pieces.

use cohabit_cdf::model::{Axis, Material, Model, Part, Shape, When};
use glam::{Mat3, Vec3};

use crate::color;
use crate::hidden::{self, Cover};
use crate::kit::{self, Detail, Precision, Solid};
use crate::mesh::{Aabb, Mesh, Paint, Surface, is_usual};
use crate::model_error::ModelError;
use crate::pattern::Pattern;
use crate::veil::{self, Veil};

/// Most parts of a model.
const MOST_PARTS: usize = 500;
/// Most copies of one part.
const MOST_COPIES: u32 = 200;
/// The size of models as whose parts shapes are divided to learn how large a model is, m.
const ROUGH_M: f32 = 0.2;

/// The mesh of `model` at this precision.
pub(crate) fn build(model: &Model, precision: &Precision) -> Result<Mesh, ModelError> {
    build_and_tell(model, precision, |_, _| ())
}

/// The same; says of each part, in the order of the mesh, which it is and how many triangles the mesh has with it.
pub(crate) fn build_and_tell(
    model: &Model,
    precision: &Precision,
    mut tell: impl FnMut(usize, usize),
) -> Result<Mesh, ModelError> {
    let too_many = |what, count, most| ModelError::TooMany { model: model.id.clone(), what, count, most };
    if model.parts.len() > MOST_PARTS {
        return Err(too_many("parts", model.parts.len(), MOST_PARTS));
    }
    if model.joints.len() > 64 {
        return Err(too_many("joints", model.joints.len(), 64));
    }
    let mut groups: Vec<Group> = Vec::new();
    let mut group_of = Vec::with_capacity(model.parts.len());
    let mut shaped = Vec::with_capacity(model.parts.len());
    let mut covers = Vec::new();
    for (index, part) in model.parts.iter().enumerate() {
        if let Some(repeat) = part.repeat.filter(|repeat| repeat.count > MOST_COPIES) {
            return Err(too_many("copies of a part", repeat.count as usize, MOST_COPIES as usize));
        }
        let key = (part.when, joint_of(model, part, index)?, veil::of(pattern(part)));
        let group = groups.iter().position(|known| *known == key).unwrap_or_else(|| {
            groups.push(key);
            groups.len() - 1
        });
        group_of.push(group);
        let own = Shaped::new(model, part, index, precision)?;
        if own.shows {
            covers.extend(own.covers(part, index, precision).map(|cover| (key, cover)));
        }
        shaped.push(own);
    }
    let mut mesh = Mesh::default();
    for (group, (when, joint, veil)) in groups.iter().copied().enumerate() {
        let over: Vec<&Cover> = covers
            .iter()
            .filter(|(own, _)| own.1 == joint && (own.0.is_none() || own.0 == when))
            .map(|own| &own.1)
            .collect();
        mesh.begin_piece(when, joint, veil);
        let mut members = shaped.iter().zip(&model.parts).enumerate().filter(|(index, _)| group_of[*index] == group);
        members.try_for_each(|(index, (own, part))| {
            own.push(&mut mesh, model, part, index, &over, precision)?;
            tell(index, mesh.triangles.len());
            Ok(())
        })?;
        mesh.end_piece();
    }
    Ok(mesh)
}

/// How finely shapes of `model` are divided.
pub(crate) fn precision(model: &Model, detail: Detail) -> Result<Precision, ModelError> {
    let radii = model.parts.iter().filter_map(|part| kit::radius_of(&part.shape)).collect();
    Ok(Precision::of(detail, radius(model)?).with_radii(radii))
}

/// The radius of the least ball about the box around what is drawn of `model` while nothing has happened, m.
fn radius(model: &Model) -> Result<f32, ModelError> {
    let rough = Precision::of(Detail::Coarse, ROUGH_M);
    let mut bounds = Aabb::EMPTY;
    for (index, part) in model.parts.iter().enumerate().filter(|(_, part)| part.when.is_none_or(is_usual)) {
        let own = Shaped::new(model, part, index, &rough)?;
        for copy in [0, own.copies.saturating_sub(1)] {
            for corner in &own.solid.positions {
                let corner = *corner + own.step * copy as f32;
                bounds = bounds.with(corner);
                if let Some(axis) = own.mirror {
                    let mut twin = corner;
                    twin[axis] = -twin[axis];
                    bounds = bounds.with(twin);
                }
            }
        }
    }
    Ok(bounds.size().length() * 0.5)
}

/// Where a part belongs: the state in which it is drawn, its joint, and how one sees through it.
type Group = (Option<When>, Option<u8>, Option<Veil>);

fn joint_of(model: &Model, part: &Part, index: usize) -> Result<Option<u8>, ModelError> {
    let Some(name) = &part.joint else { return Ok(None) };
    match model.joints.iter().position(|joint| joint.id == *name) {
        Some(joint) => Ok(Some(joint as u8)),
        None => Err(ModelError::NoJoint { model: model.id.clone(), part: index + 1, joint: name.clone() }),
    }
}

/// A part's shape, placed; its copies lie elsewhere.
struct Shaped {
    solid: Solid,
    frame: Mat3,
    /// The axis along which the pattern's grain runs.
    grain: usize,
    step: Vec3,
    copies: u32,
    mirror: Option<usize>,
    /// Whether it is large enough to be seen.
    shows: bool,
}

impl Shaped {
    fn new(model: &Model, part: &Part, index: usize, precision: &Precision) -> Result<Self, ModelError> {
        let shape = |source| ModelError::Shape { model: model.id.clone(), part: index + 1, source };
        // What fades at its edges shows no corners there.
        let fades = veil::of(pattern(part)) == Some(Veil::Airy);
        let mut solid =
            if fades { kit::build(&part.shape, &precision.coarser()) } else { kit::build(&part.shape, precision) }
                .map_err(shape)?;
        let frame = turned(part.turn_deg);
        let size = size_of(&solid);
        solid.transform(frame, Vec3::from_array(part.at));
        let mirror = part.mirror.map(|axis| match axis {
            Axis::X => 0,
            Axis::Y => 1,
            Axis::Z => 2,
        });
        Ok(Self {
            solid,
            frame,
            grain: longest_axis(size),
            step: part.repeat.map_or(Vec3::ZERO, |repeat| Vec3::from_array(repeat.step)),
            copies: part.repeat.map_or(1, |repeat| repeat.count),
            mirror,
            shows: precision.shows(size),
        })
    }

    /// What its copies hide.
    fn covers<'a>(
        &'a self,
        part: &'a Part,
        index: usize,
        precision: &'a Precision,
    ) -> impl Iterator<Item = Cover> + 'a {
        let twins = if self.mirror.is_some() { 2 } else { 1 };
        (0..self.copies * twins).filter_map(move |copy| {
            let at = Vec3::from_array(part.at) + self.step * (copy / twins) as f32;
            let mirror = self.mirror.filter(|_| copy % twins == 1);
            Cover::new(part, (index, copy), self.frame, at, mirror, precision.tolerance_m)
        })
    }

    fn push(
        &self,
        mesh: &mut Mesh,
        model: &Model,
        part: &Part,
        index: usize,
        covers: &[&Cover],
        precision: &Precision,
    ) -> Result<(), ModelError> {
        let paint = paint_of(model, part, index)?;
        if !self.shows {
            return Ok(());
        }
        // Each part has its own place in the pattern, so that two boards never show the same knot.
        let offset = index as f32 * 0.3719;
        let pattern = pattern(part);
        let own = veil::look(pattern).map_or(1.0, |look| look.squarely);
        let opacity = part.opacity.unwrap_or(own).clamp(0.0, 1.0);
        let twins = if self.mirror.is_some() { 2 } else { 1 };
        for copy in 0..self.copies * twins {
            let mut solid = self.solid.clone();
            solid.transform(Mat3::IDENTITY, self.step * (copy / twins) as f32);
            if let Some(axis) = self.mirror.filter(|_| copy % twins == 1) {
                solid.mirror(axis);
            }
            let others: Vec<&Cover> = covers.iter().filter(|cover| cover.copy != (index, copy)).copied().collect();
            hidden::remove(&mut solid, &others, precision.flat_m());
            mesh.push(&solid, |outward| Surface {
                opacity,
                ..surface(paint, pattern, self.frame, self.grain, outward, offset)
            });
        }
        Ok(())
    }
}

fn paint_of(model: &Model, part: &Part, index: usize) -> Result<Paint, ModelError> {
    match part.color.as_str() {
        "tint" => Ok(Paint::Tint),
        "fluid" => Ok(Paint::Fluid),
        hex => color::parse_hex(hex).map(Paint::Fixed).ok_or_else(|| ModelError::Color {
            model: model.id.clone(),
            part: index + 1,
            color: hex.to_owned(),
        }),
    }
}

/// Rotation about x, then y, then z.
fn turned(degrees: [f32; 3]) -> Mat3 {
    let turn = |axis: usize, angle: f32| {
        let (sin, cos) = libm::sincosf(angle.to_radians());
        match axis {
            0 => Mat3::from_cols(Vec3::X, Vec3::new(0.0, cos, sin), Vec3::new(0.0, -sin, cos)),
            1 => Mat3::from_cols(Vec3::new(cos, 0.0, -sin), Vec3::Y, Vec3::new(sin, 0.0, cos)),
            _ => Mat3::from_cols(Vec3::new(cos, sin, 0.0), Vec3::new(-sin, cos, 0.0), Vec3::Z),
        }
    };
    turn(2, degrees[2]) * turn(1, degrees[1]) * turn(0, degrees[0])
}

fn size_of(solid: &Solid) -> Vec3 {
    solid.positions.iter().fold(Aabb::EMPTY, |all, corner| all.with(*corner)).size()
}

fn longest_axis(size: Vec3) -> usize {
    (0..3).max_by(|a, b| size[*a].total_cmp(&size[*b]).then(b.cmp(a))).unwrap_or(0)
}

/// Lays the pattern on the side of the part that `outward` looks out of, grain along `u`.
fn surface(paint: Paint, pattern: Pattern, frame: Mat3, grain: usize, outward: Vec3, offset: f32) -> Surface {
    if !pattern.is_textured() {
        return Surface { paint, pattern, u: (Vec3::X, 0.0), v: (Vec3::Y, 0.0), opacity: 1.0 };
    }
    let inside = frame.transpose() * outward;
    let side = (0..3).max_by(|a, b| inside[*a].abs().total_cmp(&inside[*b].abs()).then(b.cmp(a))).unwrap_or(2);
    let along = if side == grain { (side + 1) % 3 } else { grain };
    let across = 3 - side - along;
    Surface { paint, pattern, u: (frame.col(along), offset), v: (frame.col(across), offset * 1.7), opacity: 1.0 }
}

fn pattern(part: &Part) -> Pattern {
    let text = matches!(part.shape, Shape::Text { .. } | Shape::Line { .. });
    match part.material {
        _ if text => {
            if part.material == Material::Glow {
                Pattern::Glow
            } else {
                Pattern::Ink
            }
        }
        Material::Plain => Pattern::Plain,
        Material::Plastic => Pattern::Plastic,
        Material::Metal => Pattern::Metal,
        Material::Wood => Pattern::Wood,
        Material::Glass => Pattern::Glass,
        Material::Ceramic => Pattern::Ceramic,
        Material::Fabric => Pattern::Fabric,
        Material::Paper => Pattern::Paper,
        Material::Glow => Pattern::Glow,
        Material::Brick => Pattern::Brick,
        Material::Tile => Pattern::Tile,
        Material::Carpet => Pattern::Carpet,
        Material::Leaf => Pattern::Leaf,
        Material::Food => Pattern::Food,
        Material::Clear => Pattern::Clear,
        Material::Liquid => Pattern::Liquid,
        Material::Mist => Pattern::Mist,
        Material::Beam => Pattern::Beam,
    }
}
