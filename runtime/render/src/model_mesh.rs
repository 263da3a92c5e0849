//! From a model's parts to a mesh: placed, mirrored, repeated, painted, and gathered into pieces.

use cohabit_cdf::model::{Axis, Material, Model, Part, Shape, When};
use glam::{Mat3, Vec3};

use crate::color;
use crate::kit::{self, Detail, Solid};
use crate::library::ModelError;
use crate::mesh::{Mesh, Paint, Surface};
use crate::pattern::Pattern;
use crate::veil::{self, Veil};

/// Most parts of a model.
const MOST_PARTS: usize = 500;
/// Most copies of one part.
const MOST_COPIES: u32 = 200;

/// The mesh of `model` at this level of detail.
pub(crate) fn build(model: &Model, detail: Detail) -> Result<Mesh, ModelError> {
    let too_many = |what, count, most| ModelError::TooMany { model: model.id.clone(), what, count, most };
    if model.parts.len() > MOST_PARTS {
        return Err(too_many("parts", model.parts.len(), MOST_PARTS));
    }
    if model.joints.len() > 64 {
        return Err(too_many("joints", model.joints.len(), 64));
    }
    let mut groups: Vec<(Option<When>, Option<u8>, Option<Veil>)> = Vec::new();
    let mut group_of = Vec::with_capacity(model.parts.len());
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
    }
    let mut mesh = Mesh::default();
    for (group, (when, joint, veil)) in groups.iter().enumerate() {
        mesh.begin_piece(*when, *joint, *veil);
        for (index, part) in model.parts.iter().enumerate().filter(|(index, _)| group_of[*index] == group) {
            push_part(&mut mesh, model, part, index, detail)?;
        }
        mesh.end_piece();
    }
    Ok(mesh)
}

fn joint_of(model: &Model, part: &Part, index: usize) -> Result<Option<u8>, ModelError> {
    let Some(name) = &part.joint else { return Ok(None) };
    match model.joints.iter().position(|joint| joint.id == *name) {
        Some(joint) => Ok(Some(joint as u8)),
        None => Err(ModelError::NoJoint { model: model.id.clone(), part: index + 1, joint: name.clone() }),
    }
}

fn push_part(mesh: &mut Mesh, model: &Model, part: &Part, index: usize, detail: Detail) -> Result<(), ModelError> {
    let shape = |source| ModelError::Shape { model: model.id.clone(), part: index + 1, source };
    let pattern = pattern(part);
    // What fades at its edges shows no corners there.
    let coarser = usize::from(veil::of(pattern) == Some(Veil::Airy));
    let detail = Detail::ALL[(detail as usize + coarser).min(Detail::ALL.len() - 1)];
    let mut solid = kit::build(&part.shape, detail).map_err(shape)?;
    let paint = match part.color.as_str() {
        "tint" => Paint::Tint,
        "fluid" => Paint::Fluid,
        hex => Paint::Fixed(color::parse_hex(hex).ok_or_else(|| ModelError::Color {
            model: model.id.clone(),
            part: index + 1,
            color: hex.to_owned(),
        })?),
    };
    let frame = turned(part.turn_deg);
    let grain = longest_axis(&solid);
    solid.transform(frame, Vec3::from_array(part.at));
    // Each part has its own place in the pattern, so that two boards never show the same knot.
    let offset = index as f32 * 0.3719;
    let own = veil::look(pattern).map_or(1.0, |look| look.squarely);
    let opacity = part.opacity.unwrap_or(own).clamp(0.0, 1.0);
    let surface = |outward| Surface { opacity, ..surface(paint, pattern, frame, grain, outward, offset) };
    let copies = part.repeat.map_or(1, |repeat| repeat.count);
    let step = part.repeat.map_or(Vec3::ZERO, |repeat| Vec3::from_array(repeat.step));
    for _ in 0..copies {
        mesh.push(&solid, surface);
        if let Some(axis) = part.mirror {
            let mut twin = solid.clone();
            twin.mirror(match axis {
                Axis::X => 0,
                Axis::Y => 1,
                Axis::Z => 2,
            });
            mesh.push(&twin, surface);
        }
        solid.transform(Mat3::IDENTITY, step);
    }
    Ok(())
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

fn longest_axis(solid: &Solid) -> usize {
    let bounds = solid.positions.iter().fold(crate::mesh::Aabb::EMPTY, |all, corner| all.with(*corner));
    let size = bounds.size();
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
    let text = matches!(part.shape, Shape::Text { .. });
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
