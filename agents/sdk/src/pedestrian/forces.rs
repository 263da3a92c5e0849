//! How pedestrians walk: the social force model. Pure: who is where goes in, a velocity comes out.
//!
//! The model is that of Helbing and Molnár ("Social force model for pedestrian dynamics", Physical Review E 51, 1995): a
//! pedestrian accelerates towards a desired velocity, away from others and away from walls. How others act on one is taken
//! from Moussaïd et al. ("Experimental study of the behavioural mechanisms underlying self-organization in human crowds",
//! Proceedings of the Royal Society B 276, 2009), with the parameters that they measured: people slow down and turn aside, to
//! the right rather than to the left. Robots act as people do.
//!
//! Forces alone do not keep bodies apart at every length of a step, so a velocity is cut down at last to what leads into
//! nobody and nothing: of what is between two bodies each takes half at most.

use glam::Vec2;

/// Somebody on the floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Walker {
    /// The middle, m.
    pub at_m: Vec2,
    /// How it moves now, m/s.
    pub velocity_m_s: Vec2,
    /// The radius of its outline, m.
    pub radius_m: f32,
}

/// The corners of something that stands in the way, m: convex, counter-clockwise.
pub(crate) type Outline = [Vec2; 4];

/// Relaxation time of the desired velocity, s (Moussaïd et al.: 0.54 ± 0.05).
pub(crate) const RELAXATION_S: f32 = 0.54;
/// Strength of what others do, m/s² (A).
const STRENGTH_M_S2: f32 = 4.5;
/// Range of what others do, a metre for each m of the interaction vector (γ).
const RANGE: f32 = 0.35;
/// Weight of relative velocity against direction in the interaction vector (λ).
const VELOCITY_WEIGHT: f32 = 2.0;
/// How narrow the angles are in which one slows down (n′) and turns aside (n).
const SLOWING: f32 = 3.0;
const TURNING: f32 = 2.0;
/// How far people prefer to pass on the right (ε).
const RIGHT: f32 = 0.005;
/// Strength, m/s², and range, m, of walls and of what stands like them.
const WALL_M_S2: f32 = 3.0;
const WALL_M: f32 = 0.1;

/// Nobody pays heed to who is further away, m, and to walls that are.
const HEED_M: f32 = 8.0;
const HEED_WALL_M: f32 = 2.0;
/// What is left between bodies, and between bodies and what stands, m.
const BERTH_M: f32 = 0.05;
const WALL_BERTH_M: f32 = 0.01;
/// A velocity that leads into somebody by less than this does so by rounding alone, m/s.
const ROUNDING_M_S: f32 = 1e-4;

/// How `own` is to move for the next `dt_s` seconds, m/s: no faster than `most_m_s`. `wanted_m_s` is how it would move were it
/// alone.
pub(crate) fn velocity(
    own: &Walker,
    wanted_m_s: Vec2,
    most_m_s: f32,
    others: &[Walker],
    obstacles: &[Outline],
    dt_s: f32,
) -> Vec2 {
    let near: Vec<&Walker> = others.iter().filter(|other| other.at_m.distance(own.at_m) < HEED_M).collect();
    let points: Vec<Vec2> = obstacles
        .iter()
        .filter(|outline| !is_inside(outline, own.at_m))
        .map(|outline| nearest_of(outline, own.at_m))
        .filter(|point| point.distance(own.at_m) < HEED_WALL_M)
        .collect();
    let drive = (wanted_m_s - own.velocity_m_s) / RELAXATION_S;
    let of_others: Vec2 = near.iter().map(|other| interaction(own, other)).sum();
    let force = drive + of_others + of_walls(own, &points);
    let wished = (own.velocity_m_s + force * dt_s).clamp_length_max(most_m_s);
    let limits = near.iter().map(|other| Limit::of_body(own, other, dt_s));
    let limits: Vec<Limit> = limits.chain(points.iter().map(|point| Limit::of_wall(own, *point, dt_s))).collect();
    within(wished, &limits)
}

/// What somebody else does to `own`, m/s².
fn interaction(own: &Walker, other: &Walker) -> Vec2 {
    let apart = other.at_m - own.at_m;
    let toward = apart.normalize_or_zero();
    let vector = (own.velocity_m_s - other.velocity_m_s) * VELOCITY_WEIGHT + toward;
    let (length, along) = (vector.length(), vector.normalize_or_zero());
    if toward == Vec2::ZERO || along == Vec2::ZERO {
        return Vec2::ZERO;
    }
    let range_m = RANGE * length;
    let angle_rad = libm::atan2f(along.perp_dot(toward), along.dot(toward)) + range_m * RIGHT;
    let strength = |narrow: f32| {
        let off = narrow * range_m * angle_rad;
        STRENGTH_M_S2 * libm::expf(-apart.length() / range_m - off * off)
    };
    // Who is on the left is passed on the right.
    -along * strength(SLOWING) - along.perp() * (strength(TURNING) * angle_rad.signum())
}

/// What the nearest of what stands does, m/s².
fn of_walls(own: &Walker, points: &[Vec2]) -> Vec2 {
    let nearest =
        points.iter().min_by(|one, other| one.distance_squared(own.at_m).total_cmp(&other.distance_squared(own.at_m)));
    nearest.map_or(Vec2::ZERO, |point| {
        let away = own.at_m - *point;
        away.normalize_or_zero() * (WALL_M_S2 * libm::expf(-away.length() / WALL_M))
    })
}

/// How fast one may come nearer to something.
struct Limit {
    /// The direction in which that is.
    toward: Vec2,
    most_m_s: f32,
}

impl Limit {
    /// Where both keep to it, two bodies never touch: each goes half the way at most towards the other.
    fn of_body(own: &Walker, other: &Walker, dt_s: f32) -> Self {
        let apart = other.at_m - own.at_m;
        let between_m = apart.length() - own.radius_m - other.radius_m - BERTH_M;
        Self { toward: apart.normalize_or_zero(), most_m_s: between_m.max(0.0) / 2.0 / dt_s }
    }

    /// What is convex lies beyond the line through its nearest point, across the direction to that.
    fn of_wall(own: &Walker, point: Vec2, dt_s: f32) -> Self {
        let apart = point - own.at_m;
        let between_m = apart.length() - own.radius_m - WALL_BERTH_M;
        Self { toward: apart.normalize_or_zero(), most_m_s: between_m.max(0.0) / dt_s }
    }

    fn closing_m_s(&self, velocity: Vec2) -> f32 {
        velocity.dot(self.toward)
    }
}

/// The velocity within all limits: along what it leads into, as far as it can, and slower where that is not enough.
fn within(wished: Vec2, limits: &[Limit]) -> Vec2 {
    let along = limits.iter().fold(wished, |velocity, limit| {
        velocity - limit.toward * (limit.closing_m_s(velocity) - limit.most_m_s).max(0.0)
    });
    let share = limits
        .iter()
        .filter(|limit| limit.closing_m_s(along) > limit.most_m_s + ROUNDING_M_S)
        .map(|limit| limit.most_m_s / limit.closing_m_s(along))
        .fold(1.0, f32::min);
    along * share
}

/// The point of a convex outline that is nearest to one outside.
fn nearest_of(outline: &Outline, point: Vec2) -> Vec2 {
    edges(outline).map(|(from, to)| nearest_on(from, to, point)).fold(outline[0], |nearest, next| {
        if next.distance_squared(point) < nearest.distance_squared(point) { next } else { nearest }
    })
}

fn is_inside(outline: &Outline, point: Vec2) -> bool {
    edges(outline).all(|(from, to)| (to - from).perp_dot(point - from) > 0.0)
}

fn edges(outline: &Outline) -> impl Iterator<Item = (Vec2, Vec2)> {
    (0..outline.len()).map(move |at| (outline[at], outline[(at + 1) % outline.len()]))
}

/// The point of a stretch that is nearest to another one.
pub(crate) fn nearest_on(from: Vec2, to: Vec2, point: Vec2) -> Vec2 {
    let along = to - from;
    let length = along.length_squared();
    if length > 0.0 { from + along * ((point - from).dot(along) / length).clamp(0.0, 1.0) } else { from }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
