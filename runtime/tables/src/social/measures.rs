//! Measures of social navigation, from where bodies were tick by tick.

use cohabit_record::{Stop, Trail, Travel};

use crate::played::seconds;

/// Spaces around people, m between outlines: intimate, personal, social (Hall 1966).
const INTIMATE_M: f64 = 0.45;
const PERSONAL_M: f64 = 1.2;
const SOCIAL_M: f64 = 3.6;
/// Two bodies at 1.4 and 1.3 m/s come 0.045 m nearer in a tick, and the world halts them before they overlap.
const CONTACT_M: f64 = 0.05;
/// A contact is over when this is between them: 0.06 m is what bodies leave between them in passing.
const PARTED_M: f64 = 0.055;
/// Slower than this it does not move, and does not turn.
const STALLED_M_S: f64 = 0.05;
const STALLED_RAD_S: f64 = 0.1;
/// The direction of motion is that over so much way: what is shorter is shorter than a step.
const STRIDE_M: f64 = 0.05;
/// Who is sent no further was there already.
const NOWHERE_M: f64 = 0.1;

/// How near a robot and a person were to each other.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Near {
    pub watched_s: f64,
    pub min_distance_m: Option<f64>,
    pub intimate_s: f64,
    pub personal_s: f64,
    pub social_s: f64,
    pub contacts: usize,
    /// The robot's mean speed within social space.
    pub speed_m_s: Option<f64>,
}

impl Near {
    /// Of two trails of one session.
    pub fn new(robot: &Trail, person: &Trail) -> Self {
        let apart = |(one, other): (&Stop, &Stop)| distance(one, other) - robot.radius_m - person.radius_m;
        let apart_m: Vec<f64> = robot.stops.iter().zip(&person.stops).map(apart).collect();
        let within_s = |space_m: f64| ticks_s(apart_m.iter().filter(|apart| **apart < space_m).count());
        Self {
            watched_s: ticks_s(apart_m.len()),
            min_distance_m: apart_m.iter().copied().reduce(f64::min).map(|least| least.max(0.0)),
            intimate_s: within_s(INTIMATE_M),
            personal_s: within_s(PERSONAL_M),
            social_s: within_s(SOCIAL_M),
            contacts: contacts(&apart_m),
            speed_m_s: speed_within(robot, &apart_m),
        }
    }
}

fn contacts(apart_m: &[f64]) -> usize {
    let (mut count, mut touch) = (0, false);
    for apart in apart_m {
        count += usize::from(!touch && *apart < CONTACT_M);
        let limit_m = if touch { PARTED_M } else { CONTACT_M };
        touch = *apart < limit_m;
    }
    count
}

/// The mean speed over the ticks that ended in social space.
fn speed_within(robot: &Trail, apart_m: &[f64]) -> Option<f64> {
    let near = robot.stops.windows(2).zip(&apart_m[apart_m.len().min(1)..]);
    let near = near.filter(|(pair, apart)| is_step(&pair[0], &pair[1]) && **apart < SOCIAL_M);
    mean(&near.map(|(pair, _)| distance(&pair[0], &pair[1]) / seconds(1)).collect::<Vec<_>>())
}

/// How a robot went where it was sent.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Walk {
    pub path_m: f64,
    pub irregularity_rad_m: Option<f64>,
    pub travels: usize,
    pub arrived: usize,
    pub time_to_goal_s: Option<f64>,
    pub efficiency: Option<f64>,
    pub shortest: Option<&'static str>,
    /// The way that was gone, and the one that was possible when it began.
    pub gone_m: Option<f64>,
    pub possible_m: Option<f64>,
    pub stalled_s: f64,
}

impl Walk {
    /// Of a robot, among the travels of a session.
    pub fn new(robot: &Trail, travels: &[Travel]) -> Self {
        let path_m: f64 = steps(&robot.stops).map(|(from, to)| distance(from, to)).sum();
        let own: Vec<Leg<'_>> = travels.iter().filter_map(|travel| Leg::of(robot, travel)).collect();
        let arrived: Vec<&Leg<'_>> = own.iter().filter(|leg| leg.travel.success).collect();
        let of_arrived = |of: fn(&Leg<'_>) -> f64| mean(&arrived.iter().map(|leg| of(leg)).collect::<Vec<_>>());
        Self {
            path_m,
            irregularity_rad_m: (path_m > STRIDE_M).then(|| turned_rad(&robot.stops) / path_m),
            travels: own.len(),
            arrived: arrived.len(),
            time_to_goal_s: of_arrived(|leg| seconds(leg.travel.to - leg.travel.from)),
            efficiency: of_arrived(efficiency),
            shortest: shortest(&arrived),
            gone_m: of_arrived(|leg| leg.gone_m),
            possible_m: mean(&arrived.iter().filter_map(|leg| leg.travel.possible_m).collect::<Vec<_>>()),
            stalled_s: own.iter().map(|leg| stalled_s(leg.stops)).sum(),
        }
    }
}

/// A travel, and where it led.
struct Leg<'a> {
    travel: &'a Travel,
    stops: &'a [Stop],
    gone_m: f64,
}

impl<'a> Leg<'a> {
    /// A travel of this robot, unless it was there already, or what is known of it has a gap.
    fn of(robot: &'a Trail, travel: &'a Travel) -> Option<Self> {
        let place = |tick: u64| robot.stops.binary_search_by_key(&tick, |stop| stop.tick).ok();
        let stops = robot.stops.get(place(travel.from)?..=place(travel.to)?)?;
        let gone_m: f64 = steps(stops).map(|(from, to)| distance(from, to)).sum();
        let is_whole = stops.windows(2).all(|pair| is_step(&pair[0], &pair[1]));
        let is_own = travel.body == robot.body && is_whole;
        let leg = Self { travel, stops, gone_m };
        // One that was to go somewhere and could not has gone nowhere, too.
        (is_own && !(travel.success && gone_m.max(leg.shortest_m()) < NOWHERE_M)).then_some(leg)
    }

    /// The shortest way; the straight line, where the floor has none.
    fn shortest_m(&self) -> f64 {
        let straight = || self.stops.first().zip(self.stops.last()).map_or(0.0, |(from, to)| distance(from, to));
        self.travel.shortest_m.unwrap_or_else(straight)
    }
}

/// The shortest way as a share of that which was gone. A body cuts corners by less than rounding: it is 1 at most.
fn efficiency(leg: &Leg<'_>) -> f64 {
    if leg.gone_m > 0.0 { (leg.shortest_m() / leg.gone_m).min(1.0) } else { 1.0 }
}

/// What the shortest ways are.
fn shortest(legs: &[&Leg<'_>]) -> Option<&'static str> {
    let over_floor = legs.iter().filter(|leg| leg.travel.shortest_m.is_some()).count();
    match (legs.len(), over_floor) {
        (0, _) => None,
        (_, 0) => Some("straight line"),
        (all, some) if some == all => Some("floor"),
        _ => Some("both"),
    }
}

fn stalled_s(stops: &[Stop]) -> f64 {
    let is_stalled = |(from, to): &(&Stop, &Stop)| {
        let turned_rad = wrap(to.yaw_rad - from.yaw_rad).abs();
        distance(from, to) < STALLED_M_S * seconds(1) && turned_rad < STALLED_RAD_S * seconds(1)
    };
    ticks_s(steps(stops).filter(is_stalled).count())
}

/// How far the direction of motion turned in all, rad.
fn turned_rad(stops: &[Stop]) -> f64 {
    let (mut turned, mut direction, mut anchor) = (0.0, None::<f64>, stops.first());
    for pair in stops.windows(2) {
        if !is_step(&pair[0], &pair[1]) {
            (direction, anchor) = (None, Some(&pair[1]));
            continue;
        }
        let Some(from) = anchor.filter(|from| distance(from, &pair[1]) >= STRIDE_M) else { continue };
        let to = &pair[1];
        let new = (to.at_m[1] - from.at_m[1]).atan2(to.at_m[0] - from.at_m[0]);
        turned += direction.map_or(0.0, |old| wrap(new - old).abs());
        (direction, anchor) = (Some(new), Some(to));
    }
    turned
}

/// Stops of two ticks one after the other.
fn steps(stops: &[Stop]) -> impl Iterator<Item = (&Stop, &Stop)> {
    stops.windows(2).map(|pair| (&pair[0], &pair[1])).filter(|(from, to)| is_step(from, to))
}

fn is_step(from: &Stop, to: &Stop) -> bool {
    to.tick == from.tick + 1
}

fn distance(one: &Stop, other: &Stop) -> f64 {
    (one.at_m[0] - other.at_m[0]).hypot(one.at_m[1] - other.at_m[1])
}

/// The same angle in `[-π, π]`.
fn wrap(angle_rad: f64) -> f64 {
    use std::f64::consts::TAU;
    angle_rad - TAU * (angle_rad / TAU).round()
}

fn ticks_s(count: usize) -> f64 {
    seconds(count as u64)
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}
