//! How a body moves that a person drives: it picks up speed as one that walks, brakes harder, and slides along what it
//! runs into. Never knows who drives.

use glam::Vec2;

use crate::{
    body::{Body, Controls},
    geometry::{direction, wrap},
    kinematics::{DT_S, PITCH_LIMIT_RAD, PITCH_RAD_S, Progress, TURN_RAD_S2, WALK_M_S2, approach, done_if},
};

/// How long a body does what it was told last: half a second, so that it stops if nobody drives it any more.
pub(crate) const HELD_TICKS: u32 = 30;
/// Twice as hard as it picks up speed: who lets go of the keys means to stand.
const BRAKE_M_S2: f32 = 2.0 * WALK_M_S2;
/// How far off its heading a body may slide, as shares of a right angle: the least that is free.
const SLIDES: u8 = 16;

impl Controls {
    /// The same within what `body` can do.
    pub fn within(self, body: &Body) -> Self {
        let figure = body.figure();
        Self {
            forward_m_s: self.forward_m_s.clamp(-figure.walk_m_s, figure.walk_m_s),
            turn_rad_s: self.turn_rad_s.clamp(-figure.turn_rad_s, figure.turn_rad_s),
            pitch_rad_s: self.pitch_rad_s.clamp(-PITCH_RAD_S, PITCH_RAD_S),
        }
    }
}

/// Moves `body` one tick as `controls` ask, or to a halt once no tick is left; `is_free` says whether its middle may be
/// at a point. It is done when it stands and nothing is asked of it.
pub(crate) fn drive(
    body: &mut Body,
    controls: &Controls,
    ticks_left: &mut u32,
    is_free: &dyn Fn(Vec2) -> bool,
) -> Progress {
    let asked = if *ticks_left > 0 { *controls } else { Controls::default() };
    *ticks_left = ticks_left.saturating_sub(1);
    body.turn_rad_s = approach(body.turn_rad_s, asked.turn_rad_s, TURN_RAD_S2 * DT_S);
    body.yaw_rad = wrap(body.yaw_rad + body.turn_rad_s * DT_S);
    let pitch_rad = body.head_pitch_rad + asked.pitch_rad_s * DT_S;
    body.head_pitch_rad = pitch_rad.clamp(-PITCH_LIMIT_RAD, PITCH_LIMIT_RAD);
    let slower = asked.forward_m_s * body.speed_m_s <= 0.0 || asked.forward_m_s.abs() < body.speed_m_s.abs();
    let rate = if slower && body.speed_m_s != 0.0 { BRAKE_M_S2 } else { WALK_M_S2 };
    body.speed_m_s = approach(body.speed_m_s, asked.forward_m_s, rate * DT_S);
    let most_m_s = asked.forward_m_s.abs().max(body.speed_m_s.abs());
    body.speed_m_s = slide(body, most_m_s, is_free);
    done_if(asked == Controls::default() && body.speed_m_s == 0.0 && body.turn_rad_s == 0.0)
}

/// Goes on by a tick along the heading or, where that is not free, along what is in the way; gives back the speed at
/// which it did: what is left of `most_m_s` in that direction, at most.
fn slide(body: &mut Body, most_m_s: f32, is_free: &dyn Fn(Vec2) -> bool) -> f32 {
    if body.speed_m_s == 0.0 {
        return 0.0;
    }
    let aside = (1..SLIDES).flat_map(|share| {
        let angle = f32::from(share) * (std::f32::consts::FRAC_PI_2 / f32::from(SLIDES));
        [angle, -angle]
    });
    let found = std::iter::once(0.0).chain(aside).find_map(|angle| {
        let speed = body.speed_m_s.signum() * body.speed_m_s.abs().min(most_m_s * libm::cosf(angle));
        let next = body.position + direction(body.yaw_rad + angle) * (speed * DT_S);
        is_free(next).then_some((next, speed))
    });
    let (next, speed) = found.unwrap_or((body.position, 0.0));
    body.position = next;
    speed
}

#[cfg(test)]
mod tests {
    use cohabit_cdf::{BodyKind, RoomId};

    use super::*;

    const RUN: Controls = Controls { forward_m_s: 1.3, turn_rad_s: 0.0, pitch_rad_s: 0.0 };

    fn person(yaw_rad: f32) -> Body {
        Body::new(BodyKind::Person, Vec2::ZERO, yaw_rad, RoomId::LAB1)
    }

    /// Ticks until it is done, with so many ticks of these controls.
    fn run(body: &mut Body, controls: Controls, ticks: u32, is_free: &dyn Fn(Vec2) -> bool) -> u32 {
        let mut left = ticks;
        (1..1000).find(|_| drive(body, &controls, &mut left, is_free) == Progress::Done).unwrap()
    }

    #[test]
    fn it_holds_for_as_long_as_told_and_halts() {
        let mut body = person(0.0);
        let ticks = run(&mut body, RUN, 30, &|_| true);
        assert!(ticks > 30 && ticks < 50, "{ticks}");
        assert!((0.4..0.6).contains(&body.position.x), "{}", body.position);
        assert_eq!((body.speed_m_s, body.turn_rad_s), (0.0, 0.0));
    }

    #[test]
    fn nothing_asked_of_who_stands_is_done_at_once() {
        assert_eq!(run(&mut person(0.0), Controls::default(), 30, &|_| true), 1);
    }

    #[test]
    fn it_asks_no_more_than_the_body_can() {
        let wild = Controls { forward_m_s: 1e30, turn_rad_s: -1e30, pitch_rad_s: 50.0 };
        let body = person(0.0);
        let tame = wild.within(&body);
        assert_eq!((tame.forward_m_s, tame.turn_rad_s), (body.figure().walk_m_s, -body.figure().turn_rad_s));
        assert_eq!(tame.pitch_rad_s, PITCH_RAD_S);
    }

    #[test]
    fn it_slides_along_a_wall_at_what_is_left_of_its_pace() {
        for degrees in [10.0_f32, 30.0, 45.0, 60.0, 80.0] {
            let mut body = person(degrees.to_radians());
            let mut left = 600;
            let wall = |point: Vec2| point.y <= 0.0;
            for _ in 0..600 {
                drive(&mut body, &RUN, &mut left, &wall);
            }
            let pace = body.position.x / 10.0;
            let expected = RUN.forward_m_s * libm::cosf(degrees.to_radians());
            assert!((pace - expected).abs() < 0.12, "{degrees} degrees: {pace} m/s, not {expected}");
        }
    }

    #[test]
    fn it_stops_head_on() {
        let mut body = person(0.0);
        run(&mut body, RUN, 120, &|point| point.x < 0.5);
        assert!(body.position.x > 0.45 && body.position.y.abs() < 0.2, "{}", body.position);
    }

    #[test]
    fn looking_stops_at_the_limit() {
        let mut body = person(0.0);
        run(&mut body, Controls { pitch_rad_s: -PITCH_RAD_S, ..Controls::default() }, 90, &|_| true);
        assert_eq!(body.head_pitch_rad, -PITCH_LIMIT_RAD);
    }
}
