//! The triangles of the default scene, where its nodes put them, with the colour that each shows.

use std::{collections::BTreeMap, rc::Rc};

use glam::{Mat4, Quat, Vec3};
use gltf_json::{
    Index, Mesh, Node, Root, Scene,
    accessor::Accessor,
    mesh::{Mode, Primitive, Semantic},
    validation::Checked,
};

use crate::{
    accessor::Accessors,
    container::Document,
    error::GltfError,
    files::Files,
    surface::{Finish, Surfaces},
};

/// The most triangles that are read.
const MOST_TRIANGLES: u64 = 1_000_000;
const SIMPLIFY: &str = "simplify the model in the program that made it, such as by Blender's modifier Decimate";

/// A triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Face {
    /// Counter-clockwise seen from outside.
    pub corners: [Vec3; 3],
    /// In linear light.
    pub color: [f32; 3],
    pub finish: Finish,
    /// Whether its back is seen, too.
    pub two_sided: bool,
}

/// All triangles, and how many primitives are none.
pub(crate) struct Read {
    pub faces: Vec<Face>,
    pub left_out: Vec<String>,
}

/// Reads the default scene; its first one, if none is the default.
pub(crate) fn read(document: &Document<'_>, files: &Files<'_>) -> Result<Read, GltfError> {
    let accessors = Accessors::new(document, files)?;
    let root = &document.root;
    let mut reading = Reading {
        root,
        accessors: &accessors,
        surfaces: Surfaces::new(root, &accessors, files),
        meshes: BTreeMap::new(),
        triangles: 0,
        lines: 0,
    };
    let mut faces = Vec::new();
    for (node, transform) in placed(root)? {
        let Some(mesh) = root.get(node).and_then(|node| node.mesh) else { continue };
        let own = reading.mesh(mesh)?;
        reading.count(own.len() as u64)?;
        let turns = transform.determinant() < 0.0;
        for face in own.iter() {
            let [a, b, c] = face.corners.map(|corner| transform.transform_point3(corner));
            if !(a.is_finite() && b.is_finite() && c.is_finite()) {
                let reason = "its transform moves a point to nowhere (NaN): export the model anew";
                return Err(GltfError::at(format!("nodes[{}]", node.value()), reason));
            }
            faces.push(Face { corners: if turns { [a, c, b] } else { [a, b, c] }, ..*face });
        }
    }
    let mut left_out = reading.surfaces.left_out();
    if reading.lines > 0 {
        left_out.push(format!("{} × primitive of points or lines", reading.lines));
    }
    Ok(Read { faces, left_out })
}

/// All nodes of the scene with where they are; each is there once.
fn placed(root: &Root) -> Result<Vec<(Index<Node>, Mat4)>, GltfError> {
    let scene = root.scene.unwrap_or(Index::<Scene>::new(0));
    let scene_at = format!("scenes[{}]", scene.value());
    let nodes = match root.get(scene) {
        Some(scene) => scene.nodes.clone(),
        None if root.scene.is_none() => return Err(GltfError::Empty("it has no scene: export the model anew")),
        None => return Err(GltfError::at(scene_at, "there is none")),
    };
    let mut seen = vec![false; root.nodes.len()];
    let mut open: Vec<(Index<Node>, Mat4)> = nodes.iter().rev().map(|node| (*node, Mat4::IDENTITY)).collect();
    let mut placed = Vec::new();
    while let Some((index, parent)) = open.pop() {
        let at = format!("nodes[{}]", index.value());
        let (Some(node), Some(seen)) = (root.get(index), seen.get_mut(index.value())) else {
            return Err(GltfError::at(at, "there is none"));
        };
        if std::mem::replace(seen, true) {
            return Err(GltfError::at(at, "it is in the scene twice, or its own child: export the model anew"));
        }
        let transform = parent * local(node);
        placed.push((index, transform));
        open.extend(node.children.iter().flatten().rev().map(|child| (*child, transform)));
    }
    Ok(placed)
}

fn local(node: &Node) -> Mat4 {
    if let Some(matrix) = &node.matrix {
        return Mat4::from_cols_array(matrix);
    }
    let [x, y, z, w] = node.rotation.unwrap_or_default().0;
    let rotation = Quat::from_xyzw(x, y, z, w);
    // A rotation that is none stays one, and is refused where it moves something.
    let rotation = if rotation.length_squared() > 1e-12 { rotation.normalize() } else { Quat::IDENTITY };
    let (scale, at) = (node.scale.unwrap_or([1.0; 3]), node.translation.unwrap_or_default());
    Mat4::from_scale_rotation_translation(Vec3::from_array(scale), rotation, Vec3::from_array(at))
}

struct Reading<'a> {
    root: &'a Root,
    accessors: &'a Accessors<'a>,
    surfaces: Surfaces<'a>,
    /// Those that were read, by index.
    meshes: BTreeMap<usize, Rc<Vec<Face>>>,
    triangles: u64,
    lines: usize,
}

impl Reading<'_> {
    fn count(&mut self, more: u64) -> Result<(), GltfError> {
        self.triangles = self.triangles.saturating_add(more);
        if self.triangles > MOST_TRIANGLES { Err(too_many(self.triangles)) } else { Ok(()) }
    }

    /// The triangles of a mesh in its own frame.
    fn mesh(&mut self, index: Index<Mesh>) -> Result<Rc<Vec<Face>>, GltfError> {
        if let Some(known) = self.meshes.get(&index.value()) {
            return Ok(Rc::clone(known));
        }
        let at = format!("meshes[{}]", index.value());
        let mesh = self.root.get(index).ok_or_else(|| GltfError::at(&at, "there is none"))?;
        let mut faces = Vec::new();
        for (number, primitive) in mesh.primitives.iter().enumerate() {
            self.primitive(primitive, &format!("{at}.primitives[{number}]"), &mut faces)?;
        }
        let faces = Rc::new(faces);
        self.meshes.insert(index.value(), Rc::clone(&faces));
        Ok(faces)
    }

    fn primitive(&mut self, primitive: &Primitive, at: &str, faces: &mut Vec<Face>) -> Result<(), GltfError> {
        let mode = match primitive.mode {
            Checked::Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) => mode,
            Checked::Valid(_) => {
                self.lines += 1;
                return Ok(());
            }
            Checked::Invalid => return Err(GltfError::at(at, "`mode` is none of glTF 2.0")),
        };
        let attribute = |semantic: Semantic| primitive.attributes.get(&Checked::Valid(semantic)).copied();
        let Some(positions) = attribute(Semantic::Positions) else {
            return Err(GltfError::at(at, "it has no `POSITION`: export the model anew"));
        };
        // Counted before anything is read.
        let corners = self.accessors.count(primitive.indices.unwrap_or(positions))?;
        let own = if mode == Mode::Triangles { corners / 3 } else { corners.saturating_sub(2) };
        let all = own.saturating_add(faces.len() as u64);
        if all > MOST_TRIANGLES {
            return Err(too_many(all));
        }
        let points: Vec<Vec3> = self.accessors.vectors(positions)?.into_iter().map(Vec3::from_array).collect();
        let corners = match primitive.indices {
            Some(indices) => self.accessors.indices(indices)?,
            None => (0..u32::try_from(points.len()).unwrap_or(u32::MAX)).collect(),
        };
        if let Some(index) = corners.iter().find(|index| **index as usize >= points.len()) {
            return Err(GltfError::at(at, format!("it names point {index} of {}", points.len())));
        }
        let same = |index: Index<Accessor>, have: usize| match have == points.len() {
            true => Ok(()),
            false => Err(GltfError::at(
                at,
                format!("accessors[{}] has {have} values for {} points", index.value(), points.len()),
            )),
        };
        let surface = self.surfaces.surface(primitive.material)?;
        let places = match surface.tex_coord.and_then(|set| attribute(Semantic::TexCoords(set))) {
            Some(index) => {
                let places = self.accessors.vectors::<2>(index)?;
                same(index, places.len())?;
                Some(places)
            }
            None => None,
        };
        let colors = match attribute(Semantic::Colors(0)) {
            Some(index) => {
                let colors = self.accessors.colors(index)?;
                same(index, colors.len())?;
                Some(colors)
            }
            None => None,
        };
        for triangle in triangles(mode, &corners) {
            let triangle = triangle.map(|corner| corner as usize);
            let places = places.as_ref().map(|places| triangle.map(|corner| places[corner]));
            let colors = colors.as_ref().map(|colors| triangle.map(|corner| colors[corner]));
            if let Some((color, finish)) = surface.shown(places, colors) {
                let corners = triangle.map(|corner| points[corner]);
                faces.push(Face { corners, color, finish, two_sided: surface.two_sided });
            }
        }
        Ok(())
    }
}

fn too_many(have: u64) -> GltfError {
    GltfError::TooMany { what: "triangles or more", have, most: MOST_TRIANGLES, remedy: SIMPLIFY }
}

/// The corners of each triangle.
fn triangles(mode: Mode, corners: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleStrip => {
            let turned = |(number, three): (usize, &[u32])| match number % 2 {
                0 => [three[0], three[1], three[2]],
                _ => [three[1], three[0], three[2]],
            };
            corners.windows(3).enumerate().map(turned).collect()
        }
        Mode::TriangleFan => match corners.split_first() {
            Some((first, rest)) => rest.windows(2).map(|two| [*first, two[0], two[1]]).collect(),
            None => Vec::new(),
        },
        _ => corners.as_chunks::<3>().0.to_vec(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_their_outside() {
        assert_eq!(triangles(Mode::Triangles, &[4, 5, 6, 7, 8]), [[4, 5, 6]]);
        assert_eq!(triangles(Mode::TriangleStrip, &[0, 1, 2, 3, 4]), [[0, 1, 2], [2, 1, 3], [2, 3, 4]]);
        assert_eq!(triangles(Mode::TriangleFan, &[0, 1, 2, 3]), [[0, 1, 2], [0, 2, 3]]);
        for short in [&[][..], &[1], &[1, 2]] {
            assert!(triangles(Mode::TriangleStrip, short).is_empty() && triangles(Mode::TriangleFan, short).is_empty());
        }
    }
}
