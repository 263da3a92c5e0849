//! How a body moves in one tick: along a path, straight on, turning, looking, reaching; `drive` adds how people drive
//! one. Never knows commands.

use glam::{Vec2, Vec3};

use crate::{
    body::{Body, Step},
    drive::drive,
    geometry::{direction, heading, wrap},
    kinematics::{DT_S, PITCH_LIMIT_RAD, PITCH_RAD_S, Progress, TURN_RAD_S2, WALK_M_S2, approach, done_if},
};

/// The arm takes 0.4 s out and 0.3 s back.
const ARM_OUT_PER_S: f32 = 1.0 / 0.4;
const ARM_BACK_PER_S: f32 = 1.0 / 0.3;

/// Moves `body` one tick along `step`; `is_free` says whether its middle may be at a point.
pub(crate) fn advance(body: &mut Body, step: &mut Step, is_free: &dyn Fn(Vec2) -> bool) -> Progress {
    match step {
        Step::Walk { path, next } => walk(body, path, next, is_free),
        Step::Straight { left_m } => straight(body, left_m, is_free),
        Step::Drive { controls, ticks_left } => drive(body, controls, ticks_left, is_free),
        Step::Turn { left_rad } => done_if(turn(body, left_rad)),
        Step::Head { yaw_rad } => {
            let mut left = wrap(*yaw_rad - body.yaw_rad);
            let level = pitch(body, 0.0);
            done_if(turn(body, &mut left) && level)
        }
        Step::Face { point } => {
            let (yaw, up) = toward(body, *point);
            let mut left = wrap(yaw - body.yaw_rad);
            let looking = pitch(body, up);
            done_if(turn(body, &mut left) && looking)
        }
        Step::Yield { ticks_left, .. } => {
            *ticks_left = ticks_left.saturating_sub(1);
            body.speed_m_s = 0.0;
            done_if(*ticks_left == 0)
        }
        Step::Pitch { to_rad } => done_if(pitch(body, *to_rad)),
        Step::Reach => {
            body.arm = (body.arm + ARM_OUT_PER_S * DT_S).min(1.0);
            done_if(body.arm >= 1.0)
        }
    }
}

/// Draws the arm back by one tick.
pub(crate) fn retract(body: &mut Body) {
    body.arm = (body.arm - ARM_BACK_PER_S * DT_S).max(0.0);
}

/// The yaw and pitch that point at `point`.
fn toward(body: &Body, point: Vec3) -> (f32, f32) {
    let level = point.truncate() - body.position;
    if level.length() < 1e-3 {
        return (body.yaw_rad, 0.0);
    }
    let up = libm::atan2f(point.z - body.figure().eye_height_m, level.length());
    (heading(level), up.clamp(-PITCH_LIMIT_RAD, PITCH_LIMIT_RAD))
}

/// Turns towards an angle that is left; true once it is reached.
fn turn(body: &mut Body, left_rad: &mut f32) -> bool {
    let wanted = left_rad.signum() * body.figure().turn_rad_s.min((2.0 * TURN_RAD_S2 * left_rad.abs()).sqrt());
    body.turn_rad_s = approach(body.turn_rad_s, wanted, TURN_RAD_S2 * DT_S);
    let by = body.turn_rad_s * DT_S;
    if left_rad.abs() <= by.abs().max(2e-3) {
        body.yaw_rad = wrap(body.yaw_rad + *left_rad);
        body.turn_rad_s = 0.0;
        *left_rad = 0.0;
        return true;
    }
    body.yaw_rad = wrap(body.yaw_rad + by);
    *left_rad -= by;
    false
}

fn pitch(body: &mut Body, to_rad: f32) -> bool {
    body.head_pitch_rad = approach(body.head_pitch_rad, to_rad, PITCH_RAD_S * DT_S);
    body.head_pitch_rad == to_rad
}

fn straight(body: &mut Body, left_m: &mut f32, is_free: &dyn Fn(Vec2) -> bool) -> Progress {
    let wanted = left_m.signum() * body.figure().walk_m_s.min((2.0 * WALK_M_S2 * left_m.abs()).sqrt());
    body.speed_m_s = approach(body.speed_m_s, wanted, WALK_M_S2 * DT_S);
    let by = if left_m.abs() <= (body.speed_m_s * DT_S).abs().max(1e-3) { *left_m } else { body.speed_m_s * DT_S };
    let next = body.position + direction(body.yaw_rad) * by;
    if !is_free(next) {
        body.speed_m_s = 0.0;
        return Progress::Blocked;
    }
    body.position = next;
    *left_m -= by;
    if *left_m == 0.0 {
        body.speed_m_s = 0.0;
        return Progress::Done;
    }
    Progress::Going
}

fn walk(body: &mut Body, path: &[Vec2], next: &mut usize, is_free: &dyn Fn(Vec2) -> bool) -> Progress {
    while path.get(*next).is_some_and(|point| point.distance(body.position) < 1e-3) {
        *next += 1;
    }
    let Some(goal) = path.get(*next).copied() else {
        body.speed_m_s = 0.0;
        return Progress::Done;
    };
    let ahead = goal - body.position;
    let walk_m_s = body.figure().walk_m_s;
    let mut left = wrap(heading(ahead) - body.yaw_rad);
    let off_course = left;
    turn(body, &mut left);
    pitch(body, 0.0);
    // Facing it decides how fast it may go, and the corner ahead how soon it must slow down.
    let facing = libm::cosf(off_course).max(0.0);
    let corner = path.get(*next + 1).map_or(0.0, |after| {
        let bend = libm::cosf(wrap(heading(*after - goal) - heading(ahead))).max(0.0);
        walk_m_s * bend * bend
    });
    let brake = (corner * corner + 2.0 * WALK_M_S2 * ahead.length()).sqrt();
    let wanted = (walk_m_s * facing * facing * facing).min(brake);
    // Turning away on the spot stops it at once, or it would slide sideways.
    let rate = if facing < 0.5 { 10.0 } else { WALK_M_S2 } * DT_S;
    body.speed_m_s = approach(body.speed_m_s.max(0.0), wanted, rate);
    let by = (body.speed_m_s * DT_S).min(ahead.length());
    if by <= 0.0 {
        return Progress::Going;
    }
    let point = if by >= ahead.length() { goal } else { body.position + ahead * (by / ahead.length()) };
    if !is_free(point) {
        body.speed_m_s = 0.0;
        return Progress::Blocked;
    }
    body.position = point;
    Progress::Going
}

#[cfg(test)]
mod tests {
    use cohabit_cdf::RoomId;

    use super::*;
    use cohabit_cdf::BodyKind;

    fn run(step: Step) -> (Body, usize) {
        let (mut body, mut step) = (Body::new(BodyKind::Robot, Vec2::ZERO, 0.0, RoomId::LAB1), step);
        for tick in 1..2000 {
            if advance(&mut body, &mut step, &|_| true) == Progress::Done {
                return (body, tick);
            }
        }
        panic!("{step:?} never ended");
    }

    #[test]
    fn a_straight_stretch_ends_where_it_should() {
        for distance in [1.0, -0.5, 0.01, 3.0] {
            let (body, _) = run(Step::Straight { left_m: distance });
            assert!((body.position.x - distance).abs() < 1e-4, "{distance}: {}", body.position);
        }
    }

    #[test]
    fn a_turn_ends_where_it_should() {
        for angle in [1.0, -2.0, 3.0, 0.001, std::f32::consts::TAU] {
            let (body, _) = run(Step::Turn { left_rad: angle });
            assert!(wrap(body.yaw_rad - angle).abs() < 1e-4, "{angle}: {}", body.yaw_rad);
        }
    }

    #[test]
    fn a_walk_ends_at_the_last_point() {
        let path = vec![Vec2::new(2.0, 0.0), Vec2::new(2.0, 2.0), Vec2::new(-1.0, 2.0)];
        let (body, ticks) = run(Step::Walk { path: path.clone(), next: 0 });
        assert!(body.position.distance(path[2]) < 2e-3);
        assert!(ticks > 7 * 60 / 2 && ticks < 12 * 60, "{ticks} ticks for 7 m");
    }

    #[test]
    fn facing_looks_down_at_what_is_low() {
        let (body, _) = run(Step::Face { point: Vec3::new(0.0, 1.0, 0.3) });
        assert!((body.yaw_rad - std::f32::consts::FRAC_PI_2).abs() < 1e-2);
        assert!(body.head_pitch_rad < -0.7);
    }
}
