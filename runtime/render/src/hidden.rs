//! What of a model is never seen: faces inside other parts, or flat upon them, and the sides of what is nearly flat.
//!
//! Only parts that are convex, cannot be seen through and move along hide anything.

use cohabit_cdf::model::{Material, Part, Shape};
use glam::{Mat3, Vec2, Vec3};

use crate::kit::Solid;
use crate::mesh::Aabb;

/// Nobody looks into a gap narrower than this, m.
const GAP_M: f32 = 0.002_5;
/// How far inside a triangle must lie, m: rounding moves corners by less.
const INSIDE_M: f32 = 0.000_2;

/// One copy of a part that hides what it covers.
pub(crate) struct Cover {
    /// The part, and which copy of it.
    pub copy: (usize, u32),
    frame: Mat3,
    at: Vec3,
    mirror: Option<usize>,
    bounds: Aabb,
    body: Body,
}

/// A convex body in its shape's own frame.
enum Body {
    Box {
        half: Vec3,
        shy: f32,
    },
    Ball {
        radii: Vec3,
        shy: f32,
    },
    /// The polygon, counter-clockwise, of radius and height that is turned about z.
    Turned {
        outline: Vec<Vec2>,
        shy: f32,
    },
    Prism {
        outline: Vec<Vec2>,
        height: f32,
    },
}

/// Where a point lies to a body: how far outside, and the direction that leads out the shortest way.
type Outside = (f32, Vec3);

impl Cover {
    /// What `part` hides, if anything, where it stands; it is drawn no farther off than `slack_m` from its true shape.
    pub(crate) fn new(
        part: &Part,
        copy: (usize, u32),
        frame: Mat3,
        at: Vec3,
        mirror: Option<usize>,
        slack_m: f32,
    ) -> Option<Self> {
        let opaque = match part.material {
            Material::Plain | Material::Plastic | Material::Metal | Material::Wood | Material::Ceramic => true,
            Material::Fabric | Material::Paper | Material::Brick | Material::Tile | Material::Carpet => true,
            Material::Leaf | Material::Food => true,
            // What shines, or is seen through, may show what is in it.
            _ => false,
        };
        let body = Body::new(&part.shape, slack_m).filter(|_| opaque)?;
        let mut cover = Self { copy, frame, at, mirror, bounds: Aabb::EMPTY, body };
        let own = cover.body.bounds();
        cover.bounds = own.corners().into_iter().fold(Aabb::EMPTY, |all, corner| all.with(cover.outwards(corner)));
        cover.bounds.min -= Vec3::splat(GAP_M);
        cover.bounds.max += Vec3::splat(GAP_M);
        Some(cover)
    }

    fn outwards(&self, point: Vec3) -> Vec3 {
        mirrored(self.frame * point + self.at, self.mirror)
    }

    fn outside(&self, point: Vec3) -> Outside {
        let (depth, out) = self.body.outside(self.frame.transpose() * (mirrored(point, self.mirror) - self.at));
        (depth, mirrored(self.frame * out, self.mirror))
    }

    fn may_touch(&self, bounds: Aabb) -> bool {
        self.bounds.min.cmple(bounds.max).all() && bounds.min.cmple(self.bounds.max).all()
    }

    fn hides(&self, corners: [Vec3; 3]) -> bool {
        if !corners.iter().all(|corner| self.bounds.min.cmple(*corner).all() && corner.cmple(self.bounds.max).all()) {
            return false;
        }
        let depths = corners.map(|corner| self.outside(corner).0);
        if depths.iter().all(|depth| *depth < -INSIDE_M) {
            return true;
        }
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let out = self.outside((a + b + c) / 3.0).1;
        depths.iter().all(|depth| *depth < GAP_M) && normal.dot(out) < -0.95
    }
}

fn mirrored(mut point: Vec3, axis: Option<usize>) -> Vec3 {
    if let Some(axis) = axis {
        point[axis] = -point[axis];
    }
    point
}

/// Takes from `solid` what the covers hide. Where one hides a face of it, and it stands out no more than `flat_m`, its
/// sides go too.
pub(crate) fn remove(solid: &mut Solid, covers: &[&Cover], flat_m: f32) {
    let bounds = solid.positions.iter().fold(Aabb::EMPTY, |all, corner| all.with(*corner));
    for cover in covers.iter().filter(|cover| cover.may_touch(bounds)) {
        let positions = &solid.positions;
        let corners = |triangle: &[u32; 3]| triangle.map(|corner| positions[corner as usize]);
        let before = solid.triangles.len();
        solid.triangles.retain(|triangle| !cover.hides(corners(triangle)));
        if solid.triangles.len() == before {
            continue;
        }
        let relief = positions.iter().map(|corner| cover.outside(*corner).0).fold(0.0, f32::max);
        if relief < flat_m {
            solid.triangles.retain(|triangle| {
                let [a, b, c] = corners(triangle);
                let out = cover.outside((a + b + c) / 3.0).1;
                (b - a).cross(c - a).normalize_or_zero().dot(out) > 0.5
            });
        }
    }
    if !covers.is_empty() {
        drop_unused(solid);
    }
}

/// Takes away corners of no triangle.
fn drop_unused(solid: &mut Solid) {
    let mut new_of = vec![u32::MAX; solid.positions.len()];
    let (mut positions, mut normals) = (Vec::new(), Vec::new());
    for corner in solid.triangles.as_flattened_mut() {
        let new = &mut new_of[*corner as usize];
        if *new == u32::MAX {
            *new = positions.len() as u32;
            positions.push(solid.positions[*corner as usize]);
            normals.push(solid.normals[*corner as usize]);
        }
        *corner = *new;
    }
    (solid.positions, solid.normals) = (positions, normals);
}

impl Body {
    fn new(shape: &Shape, slack_m: f32) -> Option<Self> {
        match shape {
            Shape::Box { size, bevel } => {
                let size = Vec3::from_array(*size);
                // As far as a rounded corner lies inside of the sharp one.
                let shy = bevel.unwrap_or((size.min_element() * 0.15).min(0.012)) * 0.43;
                Some(Self::Box { half: size * 0.5, shy })
            }
            Shape::Sphere { radii } => Some(Self::Ball { radii: Vec3::from_array(*radii), shy: slack_m }),
            Shape::Cylinder { radius, top_radius, height, .. } => {
                let top = top_radius.unwrap_or(*radius);
                Self::turned(&[[0.0, 0.0], [*radius, 0.0], [top, *height], [0.0, *height]], slack_m)
            }
            Shape::Lathe { profile } => Self::turned(profile, slack_m),
            Shape::Extrude { outline, height, .. } => {
                let outline: Vec<Vec2> = outline.iter().copied().map(Vec2::from_array).collect();
                convex(outline).map(|outline| Self::Prism { outline, height: *height })
            }
            // A mesh need not be convex, nor closed.
            Shape::Tube { .. } | Shape::Text { .. } | Shape::Line { .. } | Shape::Mesh { .. } => None,
        }
    }

    fn turned(profile: &[[f32; 2]], shy: f32) -> Option<Self> {
        let mut outline: Vec<Vec2> = profile.iter().copied().map(Vec2::from_array).collect();
        let (first, last) = (*outline.first()?, *outline.last()?);
        if first.distance_squared(last) < 1e-12 {
            return None;
        }
        for end in [last, first] {
            if end.x > 0.0 {
                outline.push(Vec2::new(0.0, end.y));
            }
        }
        convex(outline).map(|outline| Self::Turned { outline, shy })
    }

    fn bounds(&self) -> Aabb {
        let flat = |outline: &[Vec2]| {
            let start = (Vec2::INFINITY, Vec2::NEG_INFINITY);
            outline.iter().fold(start, |(low, high), point| (low.min(*point), high.max(*point)))
        };
        match self {
            Self::Box { half, .. } => {
                Aabb { min: Vec3::new(-half.x, -half.y, 0.0), max: Vec3::new(half.x, half.y, 2.0 * half.z) }
            }
            Self::Ball { radii, .. } => Aabb { min: -*radii, max: *radii },
            Self::Turned { outline, .. } => {
                let (low, high) = flat(outline);
                Aabb { min: Vec3::new(-high.x, -high.x, low.y), max: Vec3::new(high.x, high.x, high.y) }
            }
            Self::Prism { outline, height } => {
                let (low, high) = flat(outline);
                Aabb { min: low.extend(0.0), max: high.extend(*height) }
            }
        }
    }

    fn outside(&self, point: Vec3) -> Outside {
        match self {
            Self::Box { half, shy } => {
                let from_middle = point - Vec3::new(0.0, 0.0, half.z);
                let depth = from_middle.abs() - *half;
                let axis = (0..3).max_by(|a, b| depth[*a].total_cmp(&depth[*b])).unwrap_or(2);
                let mut out = Vec3::ZERO;
                out[axis] = if from_middle[axis] < 0.0 { -1.0 } else { 1.0 };
                // Near an edge, where two sides are near, the rounding counts.
                let near = (0..3).filter(|other| depth[*other] > -*shy).count();
                (depth[axis] + if near > 1 { *shy } else { 0.0 }, out)
            }
            Self::Ball { radii, shy } => {
                let ratio = (point / *radii).length();
                let out = (point / (*radii * *radii)).normalize_or(Vec3::Z);
                ((ratio - 1.0) * radii.min_element() + shy, out)
            }
            Self::Turned { outline, shy } => {
                let around = Vec2::new(point.x, point.y);
                let flat = Vec2::new(around.length(), point.z);
                // The axis, where the outline is closed, is no side.
                let side = |normal: Vec2| match normal.x {
                    ..-0.999 => f32::NEG_INFINITY,
                    -0.05..0.05 => 0.0,
                    _ => *shy,
                };
                let (depth, normal) = from_polygon(outline, flat, side);
                let across = around.normalize_or(Vec2::X) * normal.x;
                (depth, across.extend(normal.y))
            }
            Self::Prism { outline, height } => {
                let (depth, normal) = from_polygon(outline, Vec2::new(point.x, point.y), |_| 0.0);
                let ends = [(depth, normal.extend(0.0)), (-point.z, Vec3::NEG_Z), (point.z - height, Vec3::Z)];
                ends.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or(ends[0])
            }
        }
    }
}

/// The outline, counter-clockwise, if it is convex.
fn convex(mut outline: Vec<Vec2>) -> Option<Vec<Vec2>> {
    outline.dedup_by(|a, b| a.distance_squared(*b) < 1e-12);
    let count = outline.len();
    let turns = |outline: &[Vec2]| -> Vec<f32> {
        let corner = |i: usize| outline[i % count];
        (0..count).map(|i| (corner(i + 1) - corner(i)).perp_dot(corner(i + 2) - corner(i + 1))).collect()
    };
    if count < 3 {
        return None;
    }
    if turns(&outline).iter().sum::<f32>() < 0.0 {
        outline.reverse();
    }
    turns(&outline).iter().all(|turn| *turn > -1e-9).then_some(outline)
}

/// How far outside of a convex polygon a point lies, and the normal of the side that says so. `more` is added for a
/// side.
fn from_polygon(outline: &[Vec2], point: Vec2, more: impl Fn(Vec2) -> f32) -> (f32, Vec2) {
    let mut deepest = (f32::NEG_INFINITY, Vec2::X);
    for (index, from) in outline.iter().copied().enumerate() {
        let to = outline[(index + 1) % outline.len()];
        let along = (to - from).normalize_or_zero();
        let normal = Vec2::new(along.y, -along.x);
        if along == Vec2::ZERO {
            continue;
        }
        let depth = (point - from).dot(normal) + more(normal);
        if depth > deepest.0 {
            deepest = (depth, normal);
        }
    }
    deepest
}
