//! Pedestrians on bare floors.

use proptest::prelude::*;

use super::*;

const DT_S: f32 = 0.1;
const PACE_M_S: f32 = 1.3;
const RADIUS_M: f32 = 0.22;
/// Rounding adds up, m.
const TOLERANCE_M: f32 = 0.01;

fn standing(at_m: Vec2) -> Walker {
    Walker { at_m, velocity_m_s: Vec2::ZERO, radius_m: RADIUS_M }
}

/// All of them walk to their goals for so many steps; gives where each was after each.
fn walk(starts: &[Vec2], goals: &[Vec2], obstacles: &[Outline], steps: usize) -> Vec<Vec<Vec2>> {
    let mut all: Vec<Walker> = starts.iter().map(|at| standing(*at)).collect();
    let mut stops = vec![starts.to_vec()];
    for _ in 0..steps {
        let next = |(own, goal): (usize, &Vec2)| {
            let others: Vec<Walker> =
                all.iter().enumerate().filter(|(other, _)| *other != own).map(|(_, walker)| *walker).collect();
            let ahead = *goal - all[own].at_m;
            let wanted = ahead.normalize_or_zero() * PACE_M_S.min(ahead.length() / RELAXATION_S);
            velocity(&all[own], wanted, PACE_M_S, &others, obstacles, DT_S)
        };
        let velocities: Vec<Vec2> = goals.iter().enumerate().map(next).collect();
        for (walker, velocity_m_s) in all.iter_mut().zip(velocities) {
            *walker = Walker { at_m: walker.at_m + velocity_m_s * DT_S, velocity_m_s, ..*walker };
        }
        stops.push(all.iter().map(|walker| walker.at_m).collect());
    }
    stops
}

fn square(middle: Vec2, half: Vec2) -> Outline {
    let corners = [Vec2::new(-1.0, -1.0), Vec2::new(1.0, -1.0), Vec2::new(1.0, 1.0), Vec2::new(-1.0, 1.0)];
    corners.map(|corner| middle + corner * half)
}

proptest! {
    /// Two who face each other, straight on or nearly, pass, and touch nobody.
    #[test]
    fn two_who_meet_pass_without_contact(apart_m in 4.0_f32..12.0, aside_m in -0.3_f32..0.3) {
        let (left, right) = (Vec2::new(0.0, 0.0), Vec2::new(apart_m, aside_m));
        let stops = walk(&[left, right], &[right, left], &[], 400);
        for both in &stops {
            prop_assert!(both[0].distance(both[1]) >= 2.0 * RADIUS_M - TOLERANCE_M, "{both:?}");
        }
        let last = &stops[stops.len() - 1];
        prop_assert!(last[0].distance(right) < 0.5 && last[1].distance(left) < 0.5, "{last:?}");
    }

    /// A crowd of any kind does not push its members into each other, whatever stands around.
    #[test]
    fn nobody_is_touched_in_a_crowd(
        turns in prop::collection::vec(0.0_f32..std::f32::consts::TAU, 6),
        middle in (-1.0_f32..1.0, -1.0_f32..1.0),
    ) {
        let on_circle = |at: usize| Vec2::from_angle(at as f32 * std::f32::consts::TAU / 6.0) * 4.0;
        let starts: Vec<Vec2> = (0..6).map(on_circle).collect();
        let goals: Vec<Vec2> = turns.iter().map(|turn| Vec2::from_angle(*turn) * 3.0).collect();
        let block = square(Vec2::new(middle.0, middle.1), Vec2::splat(0.5));
        for all in walk(&starts, &goals, &[block], 200) {
            for (at, one) in all.iter().enumerate() {
                prop_assert!(nearest_of(&block, *one).distance(*one) >= RADIUS_M - TOLERANCE_M, "{one} in {block:?}");
                for other in &all[at + 1..] {
                    prop_assert!(one.distance(*other) >= 2.0 * RADIUS_M - TOLERANCE_M, "{one} {other}");
                }
            }
        }
    }

    /// A wall is not crossed, however the goal lies behind it.
    #[test]
    fn walls_are_not_crossed(start in -2.0_f32..2.0, goal in -2.0_f32..2.0, turned_rad in 0.0_f32..1.5) {
        let turn = Vec2::from_angle(turned_rad);
        let wall = square(Vec2::ZERO, Vec2::new(0.06, 10.0)).map(|corner| turn.rotate(corner));
        let (start, goal) = (turn.rotate(Vec2::new(-2.0, start)), turn.rotate(Vec2::new(2.0, goal)));
        for own in walk(&[start], &[goal], &[wall], 150) {
            let side_m = -turn.dot(own[0]) - 0.06;
            prop_assert!(side_m >= RADIUS_M - TOLERANCE_M, "{} is {side_m} m before the wall", own[0]);
        }
    }

    /// The same state gives the same path.
    #[test]
    fn the_same_walk_is_the_same_path(apart_m in 2.0_f32..6.0) {
        let (left, right) = (Vec2::ZERO, Vec2::new(apart_m, 0.1));
        let path = || walk(&[left, right], &[right, left], &[square(Vec2::new(apart_m, 2.0), Vec2::ONE)], 100);
        prop_assert_eq!(path(), path());
    }
}

#[test]
fn who_is_alone_walks_straight_and_at_their_pace() {
    let goal = Vec2::new(6.0, 0.0);
    let stops = walk(&[Vec2::ZERO], &[goal], &[], 150);
    assert!(stops.iter().all(|own| own[0].y == 0.0));
    // After some relaxation times the pace is that which was wanted.
    let pace = (stops[30][0].x - stops[29][0].x) / DT_S;
    assert!((pace - PACE_M_S).abs() < 0.05, "{pace}");
    assert!(stops[150][0].distance(goal) < 0.1, "{}", stops[150][0]);
}

#[test]
fn who_comes_from_ahead_is_passed_on_the_right() {
    let own = Walker { velocity_m_s: Vec2::new(1.3, 0.0), ..standing(Vec2::ZERO) };
    let other = Walker { velocity_m_s: Vec2::new(-1.3, 0.0), ..standing(Vec2::new(3.0, 0.0)) };
    let force = interaction(&own, &other);
    assert!(force.x < 0.0 && force.y < 0.0, "{force}");
    // Who is behind does nothing.
    let behind = Walker { velocity_m_s: Vec2::new(1.3, 0.0), ..standing(Vec2::new(-1.0, 0.0)) };
    let leaving = Walker { velocity_m_s: Vec2::new(1.3, 0.0), ..standing(Vec2::new(9.0, 0.0)) };
    assert!(interaction(&leaving, &behind).length() < 0.01);
}

#[test]
fn what_is_between_is_not_overrun() {
    let own = standing(Vec2::ZERO);
    let wall = square(Vec2::new(1.0, 0.0), Vec2::new(0.5, 3.0));
    let fast = Walker { velocity_m_s: Vec2::new(30.0, 5.0), ..own };
    let velocity = velocity(&fast, Vec2::new(30.0, 0.0), 30.0, &[], &[wall], DT_S);
    assert!(velocity.x * DT_S <= 0.5 - RADIUS_M && velocity.y > 0.0, "{velocity}");
}
