//! What is wanted of each pixel, once it is known which triangle it sees.
//!
//! Pixels of a row that see the same triangle are a run; what the triangle has in common is worked out once a run. A
//! pixel's place on the triangle follows from its depth, so that nothing has to be interpolated on the screen.

use glam::{Mat3, Vec3};

use super::NOTHING;
use super::draw::{Ambient, Draw};
use super::setup::Triangle;
use crate::camera::View;
use crate::color::{from_srgb, to_srgb};
use crate::mesh::Paint;
use crate::pattern::{Gloss, Level, Pattern, Pictures};
use crate::shadow::{SLANT, ShadowMap};

/// Light from above, and light thrown back from below.
const ABOVE: Vec3 = Vec3::new(0.66, 0.655, 0.64);
const BELOW: Vec3 = Vec3::new(0.44, 0.41, 0.37);
/// Light along the shadows' direction.
const KEY: Vec3 = Vec3::new(0.60, 0.575, 0.52);
/// How far a place is lifted off its surface before its shadow is looked up, m.
const LIFT_M: f32 = 0.03;
/// Pixels between two looks at the shadow map, if both see the same.
const SHADOW_STEP: usize = 4;

/// Everything that shading reads.
pub(super) struct Shader<'a> {
    view: &'a View,
    draws: &'a [Draw<'a>],
    batches: &'a [Vec<Triangle>],
    /// The number of each batch's first triangle.
    firsts: Vec<u32>,
    shadows: &'a ShadowMap,
    pictures: &'static Pictures,
    towards_light: Vec3,
    /// The meshes' rays: through the picture's first pixel, and from pixel to pixel.
    first_ray: Vec3,
    per_x: Vec3,
    per_y: Vec3,
    /// How wide a pixel is, one metre ahead.
    pixel_m: f32,
    fine_shadows: bool,
}

/// A run of pixels that see one triangle.
struct Run<'a> {
    draw: &'a Draw<'a>,
    index: usize,
    from: usize,
    to: usize,
}

/// What some neighbouring pixels of a row have in common.
enum Stretch<'a> {
    /// They see nothing, up to this pixel.
    Nothing(usize),
    /// They see the same triangle.
    Run(Run<'a>),
}

/// A unit vector as signed bytes.
#[inline(always)]
fn to_bytes(normal: Vec3) -> [i8; 4] {
    let scaled = normal * 127.0;
    [scaled.x.round() as i8, scaled.y.round() as i8, scaled.z.round() as i8, 0]
}

/// A triangle's corners, ready to say where on it a place lies.
struct Spread {
    origin: Vec3,
    /// Dot products with these give the shares of the second and the third corner.
    shares: [Vec3; 2],
    /// The outward normal in the mesh's frame, not of unit length.
    face: Vec3,
}

impl Spread {
    #[inline(always)]
    fn new([a, b, c]: [Vec3; 3]) -> Self {
        let (e1, e2) = (b - a, c - a);
        let face = e1.cross(e2);
        let scale = 1.0 / face.length_squared().max(1e-24);
        Self { origin: a, shares: [e2.cross(face) * scale, face.cross(e1) * scale], face }
    }
}

impl<'a> Shader<'a> {
    pub(super) fn new(
        view: &'a View,
        draws: &'a [Draw<'a>],
        batches: &'a [Vec<Triangle>],
        shadows: &'a ShadowMap,
        for_people: bool,
    ) -> Self {
        let mut firsts = Vec::with_capacity(batches.len());
        let mut next = 0;
        for batch in batches {
            firsts.push(next);
            next += batch.len() as u32;
        }
        Self {
            view,
            draws,
            batches,
            firsts,
            shadows,
            pictures: Pictures::get(),
            towards_light: Vec3::new(-SLANT[0], -SLANT[1], 1.0).normalize(),
            first_ray: view.ray(0.5, 0.5),
            per_x: view.right / view.focal,
            per_y: view.down / view.focal,
            pixel_m: 1.0 / view.focal,
            fine_shadows: for_people,
        }
    }

    pub(super) fn batches(&self) -> &[Vec<Triangle>] {
        self.batches
    }

    pub(super) fn triangle(&self, number: u32) -> &Triangle {
        let batch = self.firsts.partition_point(|first| *first <= number) - 1;
        &self.batches[batch][(number - self.firsts[batch]) as usize]
    }

    pub(super) fn id(&self, number: u32) -> u32 {
        self.draws[self.triangle(number).draw as usize].id
    }

    /// The next run of a row from pixel `from` on, or how many pixels see nothing.
    #[inline(always)]
    fn next_run(&self, seen: &[u32], from: usize) -> Stretch<'_> {
        let number = seen[from];
        let length = seen[from..].iter().take_while(|other| **other == number).count();
        if number == NOTHING {
            return Stretch::Nothing(from + length);
        }
        let triangle = self.triangle(number);
        let draw = &self.draws[triangle.draw as usize];
        Stretch::Run(Run { draw, index: triangle.index as usize, from, to: from + length })
    }

    pub(super) fn ids(&self, seen: &[u32], out: &mut [u32]) {
        let (mut known, mut id) = (NOTHING, 0);
        for (number, out) in seen.iter().zip(out) {
            if *number != known {
                known = *number;
                id = if known == NOTHING { 0 } else { self.id(known) };
            }
            *out = id;
        }
    }

    #[inline(always)]
    pub(super) fn normals(&self, y: usize, seen: &[u32], nearness: &[f32], out: &mut [[i8; 4]]) {
        let mut from = 0;
        while from < seen.len() {
            match self.next_run(seen, from) {
                Stretch::Nothing(to) => {
                    out[from..to].fill([0; 4]);
                    from = to;
                }
                Stretch::Run(run) => {
                    self.normal_run(y, &run, nearness, out);
                    from = run.to;
                }
            }
        }
    }

    #[inline(always)]
    fn normal_run(&self, y: usize, run: &Run<'_>, nearness: &[f32], out: &mut [[i8; 4]]) {
        let ground = Ground::new(self, run, y, None);
        if ground.flat {
            out[run.from..run.to].fill(to_bytes(ground.normal[0]));
            return;
        }
        for x in run.from..run.to {
            let place = ground.place(x, 1.0 / nearness[x]);
            out[x] = to_bytes(ground.normal_at(ground.shares(place)));
        }
    }

    #[inline(always)]
    pub(super) fn color(&self, table: &[u8; 4096], y: usize, seen: &[u32], nearness: &[f32], out: &mut [[u8; 4]]) {
        let mut from = 0;
        while from < seen.len() {
            match self.next_run(seen, from) {
                Stretch::Nothing(to) => {
                    for (x, out) in out.iter_mut().enumerate().take(to).skip(from) {
                        let ray = (self.first_ray + self.per_y * y as f32 + self.per_x * x as f32).normalize();
                        let [r, g, b] = to_srgb(table, outside(ray));
                        *out = [r, g, b, 255];
                    }
                    from = to;
                }
                Stretch::Run(run) => {
                    self.color_run(table, y, &run, nearness, out);
                    from = run.to;
                }
            }
        }
    }

    #[inline(always)]
    fn color_run(&self, table: &[u8; 4096], y: usize, run: &Run<'_>, nearness: &[f32], out: &mut [[u8; 4]]) {
        let ground = Ground::new(self, run, y, Some(run.draw.ambient));
        let surface = &run.draw.mesh.surfaces[usize::from(run.draw.mesh.surface_of[run.index])];
        let paint = match surface.paint {
            Paint::Fixed(color) => color,
            Paint::Tint => run.draw.tint,
            Paint::Fluid => run.draw.fluid,
        };
        match surface.pattern {
            Pattern::Sky => {
                for (x, out) in out.iter_mut().enumerate().take(run.to).skip(run.from) {
                    let [r, g, b] = to_srgb(table, outside(ground.ray(x).normalize()));
                    *out = [r, g, b, 255];
                }
                return;
            }
            Pattern::Glow | Pattern::Lamp => {
                let strength = match (surface.pattern, run.draw.lit) {
                    (Pattern::Lamp, true) => 1.9,
                    (Pattern::Lamp, false) => 0.12,
                    _ => 1.15,
                };
                let [r, g, b] = to_srgb(table, paint * strength);
                out[run.from..run.to].fill([r, g, b, 255]);
                return;
            }
            _ => {}
        }
        let gloss = surface.pattern.gloss();
        // Every pixel of a run is about as far away; its middle decides how coarse the pattern is.
        let middle = (run.from + run.to) / 2;
        let depth = 1.0 / nearness[middle];
        let ray = ground.ray(middle);
        let slope = (-ray.dot(ground.face)).max(0.08 * ray.length()) / ray.length();
        let footprint = self.pixel_m * depth / slope.sqrt();
        let level = self.pictures.of(surface.pattern).map(|picture| picture.level(footprint));
        let look = Look { paint, gloss, level, u: surface.u, v: surface.v };
        let mut shade = Shadow::new(run.draw.room, self, &ground);
        if ground.flat && !run.draw.weather.any() {
            self.flat_run(table, run, &ground, &look, &mut shade, nearness, out);
            return;
        }
        for x in run.from..run.to {
            let depth = 1.0 / nearness[x];
            let place = ground.place(x, depth);
            let shares = ground.shares(place);
            let normal = ground.normal_at(shares);
            let lit = shade.at(x, depth, normal, run.to, nearness);
            let light = self.light(run.draw, &ground, &look, place, normal, ground.ambient(shares), lit, x);
            let [r, g, b] = to_srgb(table, light);
            out[x] = [r, g, b, 255];
        }
    }

    /// A run on a plane, where all but texture and shadow changes evenly: most of an office.
    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "the innermost loop takes plain values")]
    fn flat_run(
        &self,
        table: &[u8; 4096],
        run: &Run<'_>,
        ground: &Ground<'_>,
        look: &Look<'_>,
        shade: &mut Shadow<'_>,
        nearness: &[f32],
        out: &mut [[u8; 4]],
    ) {
        let normal = ground.normal[0];
        let slope = ground.spread.shares[0] * ground.ambient[1] + ground.spread.shares[1] * ground.ambient[2];
        let ambient = ground.evenly(slope, ground.ambient[0] - ground.spread.origin.dot(slope));
        let (u, v) = (ground.evenly(look.u.0, look.u.1), ground.evenly(look.v.0, look.v.1));
        let around = surroundings(normal);
        let facing = normal.dot(self.towards_light).max(0.0);
        let paint = look.paint * run.draw.light;
        let mut glint = Glint::default();
        for x in run.from..run.to {
            let depth = 1.0 / nearness[x];
            let lit = if facing > 0.0 { shade.at(x, depth, normal, run.to, nearness) } else { 0.0 };
            let ambient = ambient.at(x, depth).clamp(0.0, 1.4);
            let mut light = paint * illumination(around, facing, ambient, lit);
            if let Some(level) = &look.level {
                light *= Vec3::from_array(level.at(u.at(x, depth), v.at(x, depth)));
            }
            if look.gloss.shine > 0.0 {
                let look_up =
                    |x: usize| shine(&look.gloss, look.paint, ground.ray(x), normal, self.towards_light, lit, ambient);
                light += glint.at(x, run.to, look_up) * run.draw.light;
            }
            let [r, g, b] = to_srgb(table, light);
            out[x] = [r, g, b, 255];
        }
    }

    #[expect(clippy::too_many_arguments, reason = "the innermost loop takes plain values")]
    #[inline(always)]
    fn light(
        &self,
        draw: &Draw<'_>,
        ground: &Ground<'_>,
        look: &Look<'_>,
        place: Vec3,
        normal: Vec3,
        ambient: f32,
        lit: f32,
        x: usize,
    ) -> Vec3 {
        let mut albedo = look.paint;
        if let Some(level) = &look.level {
            let (u, v) = (place.dot(look.u.0) + look.u.1, place.dot(look.v.0) + look.v.1);
            albedo *= Vec3::from_array(level.at(u, v));
        }
        if draw.weather.any() {
            albedo = self.weathered(draw, albedo, place, normal);
        }
        let facing = normal.dot(self.towards_light).max(0.0);
        let mut light = albedo * illumination(surroundings(normal), facing, ambient, lit);
        if look.gloss.shine > 0.0 {
            light += shine(&look.gloss, albedo, ground.ray(x), normal, self.towards_light, lit, ambient);
        }
        light * draw.light
    }

    /// Frost, dirt and slime over any surface.
    fn weathered(&self, draw: &Draw<'_>, albedo: Vec3, place: Vec3, normal: Vec3) -> Vec3 {
        let mut albedo = albedo;
        let spots = |scale: f32| {
            let picture = self.pictures.of(Pattern::Concrete);
            let at = place * scale;
            picture.map_or(1.0, |picture| picture.level(0.0).at(at.x + at.z * 0.71, at.y + at.z * 0.53)[0])
        };
        if draw.weather.dirty {
            let amount = ((spots(14.0) - 0.985) * 14.0).clamp(0.0, 0.85);
            albedo = albedo.lerp(from_srgb([96, 74, 48]), amount);
        }
        if draw.weather.infected {
            let amount = ((spots(10.0) - 0.99) * 12.0).clamp(0.0, 0.8);
            albedo = albedo.lerp(from_srgb([96, 200, 70]), amount);
        }
        if draw.weather.cold {
            let amount = 0.38 + 0.3 * normal.z.max(0.0) + ((spots(18.0) - 1.0) * 3.0).clamp(-0.2, 0.25);
            albedo = albedo.lerp(from_srgb([206, 228, 244]), amount);
        }
        albedo
    }
}

/// What is the same for every pixel of a run.
struct Look<'a> {
    paint: Vec3,
    gloss: Gloss,
    level: Option<Level<'a>>,
    u: (Vec3, f32),
    v: (Vec3, f32),
}

/// A run's triangle under the row's rays.
struct Ground<'a> {
    draw: &'a Draw<'a>,
    /// Rays in the world and in the mesh's frame, at the row's first pixel and from pixel to pixel.
    ray: [Vec3; 2],
    own_ray: [Vec3; 2],
    eye: Vec3,
    spread: Spread,
    /// Normals in the world at the first corner, and by how much the others differ; not of unit length.
    normal: [Vec3; 3],
    ambient: [f32; 3],
    /// The unit outward normal in the world.
    face: Vec3,
    flat: bool,
}

impl<'a> Ground<'a> {
    #[inline(always)]
    fn new(shader: &Shader<'a>, run: &Run<'a>, y: usize, ambient: Option<Ambient<'_>>) -> Self {
        let draw = run.draw;
        let mesh = draw.mesh;
        let corners = mesh.triangles[run.index].map(|corner| corner as usize);
        let spread = Spread::new(corners.map(|corner| mesh.positions[corner]));
        let to_world = draw.transform.inverse.transpose();
        let [a, b, c] = corners.map(|corner| mesh.normals[corner]);
        let flat = a == b && b == c;
        let first = to_world * a;
        let normal = if flat {
            [first.normalize_or(Vec3::Z), Vec3::ZERO, Vec3::ZERO]
        } else {
            [first, to_world * b - first, to_world * c - first]
        };
        let ambient = ambient.map(Ambient::corners);
        let [d, e, f] = corners.map(|corner| ambient.map_or(1.0, |ambient| ambient[corner]));
        let row = shader.first_ray + shader.per_y * y as f32;
        let inverse: Mat3 = draw.transform.inverse;
        Self {
            draw,
            ray: [row, shader.per_x],
            own_ray: [inverse * row, inverse * shader.per_x],
            eye: shader.view.eye,
            normal,
            ambient: [d, e - d, f - d],
            face: (to_world * spread.face).normalize_or(Vec3::Z),
            flat,
            spread,
        }
    }

    /// The world ray through a pixel of the row.
    #[inline(always)]
    fn ray(&self, x: usize) -> Vec3 {
        self.ray[0] + self.ray[1] * x as f32
    }

    /// What a pixel sees, in the mesh's frame.
    #[inline(always)]
    fn place(&self, x: usize, depth: f32) -> Vec3 {
        self.draw.eye + (self.own_ray[0] + self.own_ray[1] * x as f32) * depth
    }

    /// The same in the world.
    #[inline(always)]
    fn world(&self, x: usize, depth: f32) -> Vec3 {
        self.eye + self.ray(x) * depth
    }

    #[inline(always)]
    fn shares(&self, place: Vec3) -> [f32; 2] {
        let from = place - self.spread.origin;
        // Pixels' centres lie inside, but for rounding.
        [from.dot(self.spread.shares[0]).clamp(0.0, 1.0), from.dot(self.spread.shares[1]).clamp(0.0, 1.0)]
    }

    #[inline(always)]
    fn normal_at(&self, [b, c]: [f32; 2]) -> Vec3 {
        if self.flat {
            return self.normal[0];
        }
        let normal = self.normal[0] + self.normal[1] * b + self.normal[2] * c;
        normal * (1.0 / normal.length_squared().max(1e-12).sqrt())
    }

    /// The value that is `slope . place + offset`, for any pixel of the row.
    #[inline(always)]
    fn evenly(&self, slope: Vec3, offset: f32) -> Even {
        Even {
            at_eye: self.draw.eye.dot(slope) + offset,
            first: self.own_ray[0].dot(slope),
            per_x: self.own_ray[1].dot(slope),
        }
    }

    #[inline(always)]
    fn ambient(&self, [b, c]: [f32; 2]) -> f32 {
        self.ambient[0] + self.ambient[1] * b + self.ambient[2] * c
    }
}

/// A value that changes evenly over a plane, ready to be had for any pixel of a row.
#[derive(Clone, Copy)]
struct Even {
    at_eye: f32,
    first: f32,
    per_x: f32,
}

impl Even {
    #[inline(always)]
    fn at(&self, x: usize, depth: f32) -> f32 {
        self.at_eye + depth * (self.first + self.per_x * x as f32)
    }
}

/// A highlight along a run on a plane: looked up every few pixels, and even between them.
#[derive(Default)]
struct Glint {
    from: Vec3,
    step: Vec3,
    left: usize,
}

impl Glint {
    const PIXELS: usize = 6;

    #[inline(always)]
    fn at(&mut self, x: usize, end: usize, look: impl Fn(usize) -> Vec3) -> Vec3 {
        if self.left == 0 {
            self.left = Self::PIXELS.min(end - x);
            self.from = look(x);
            self.step = (look(x + self.left) - self.from) / self.left as f32;
        }
        let here = self.from;
        self.from += self.step;
        self.left -= 1;
        here
    }
}

/// Light from all around on a surface that faces this way.
#[inline(always)]
fn surroundings(normal: Vec3) -> Vec3 {
    // Walls that face different ways are never quite as bright as each other.
    let aside = 1.0 + 0.07 * normal.x - 0.05 * normal.y;
    (BELOW + (ABOVE - BELOW) * (normal.z * 0.5 + 0.5)) * aside
}

/// All light on a surface: what shades a place from the lamps also keeps some of the room's light from it.
#[inline(always)]
fn illumination(around: Vec3, facing: f32, ambient: f32, lit: f32) -> Vec3 {
    around * (ambient * (0.8 + 0.2 * lit)) + KEY * (facing * lit * (0.4 + 0.6 * ambient))
}

/// Shadow along a run: looked up every few pixels, and between them only where it changes.
struct Shadow<'a> {
    room: u16,
    shader: &'a Shader<'a>,
    ground: &'a Ground<'a>,
    step: usize,
    /// The last look, where the next is due, and what both saw if it was the same.
    last: f32,
    next: usize,
    same: bool,
    /// What the look ahead saw; it holds there where the normal is the same all over the run.
    ahead: Option<f32>,
}

impl<'a> Shadow<'a> {
    fn new(room: u16, shader: &'a Shader<'a>, ground: &'a Ground<'a>) -> Self {
        let step = if shader.fine_shadows { SHADOW_STEP - 1 } else { SHADOW_STEP };
        Self { room, shader, ground, step, last: 1.0, next: 0, same: false, ahead: None }
    }

    #[inline(always)]
    fn look(&self, x: usize, depth: f32, normal: Vec3) -> f32 {
        if normal.dot(self.shader.towards_light) <= 0.0 {
            return 0.0;
        }
        let place = self.ground.world(x, depth);
        self.shader.shadows.light(place + normal * LIFT_M + Vec3::Z * 0.008, self.room)
    }

    #[inline(always)]
    fn at(&mut self, x: usize, depth: f32, normal: Vec3, end: usize, nearness: &[f32]) -> f32 {
        if x < self.next && self.same {
            return self.last;
        }
        let known = if x == self.next { self.ahead.take() } else { None };
        let here = known.unwrap_or_else(|| self.look(x, depth, normal));
        if x >= self.next {
            self.next = (x + self.step).min(end - 1).max(x + 1);
            // On a curved surface the normal at the far end differs a little; the light fades with it anyway.
            let ahead = if self.next < end { self.look(self.next, 1.0 / nearness[self.next], normal) } else { here };
            self.ahead = self.ground.flat.then_some(ahead);
            self.same = (here - ahead).abs() < 0.004;
            self.last = here;
        }
        here
    }
}

/// A highlight, and what the surface mirrors of the room.
#[inline(always)]
fn shine(gloss: &Gloss, albedo: Vec3, ray: Vec3, normal: Vec3, towards_light: Vec3, lit: f32, ambient: f32) -> Vec3 {
    let ray = ray * (1.0 / ray.length());
    let reflected = ray - normal * (2.0 * ray.dot(normal));
    let mut power = reflected.dot(towards_light).max(0.0);
    for _ in 0..gloss.squarings {
        power *= power;
    }
    let grazing = (1.0 + ray.dot(normal)).clamp(0.0, 1.0);
    let edge = grazing * grazing * grazing;
    let highlight = gloss.shine * power * (0.35 + 0.65 * lit);
    let room = 0.22 + 0.75 * (reflected.z * 0.7 + 0.45).clamp(0.0, 1.0);
    let mirror = (gloss.mirror + 0.25 * gloss.shine * edge) * room * ambient;
    let tint = if gloss.colored { albedo * 1.1 } else { Vec3::ONE };
    tint * (highlight + mirror)
}

/// What is seen where there is no building: a pale sky over distant ground.
fn outside(ray: Vec3) -> Vec3 {
    let (horizon, zenith, ground) =
        (Vec3::new(0.80, 0.87, 0.94), Vec3::new(0.36, 0.56, 0.86), Vec3::new(0.30, 0.33, 0.26));
    if ray.z >= 0.0 {
        horizon.lerp(zenith, (ray.z * 2.2).min(1.0))
    } else {
        horizon.lerp(ground, (-ray.z * 9.0).min(1.0))
    }
}
