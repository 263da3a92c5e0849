//! The table of encounters: how a robot and a person moved around each other, a row a session and pair of them.
//!
//! Measures are those of SEAN 2.0 (Tsoi et al., "SEAN 2.0: Formalizing and Generating Social Situations for Robot Navigation",
//! IEEE Robotics and Automation Letters 7(4), 2022) and of Francis et al. ("Principles and Guidelines for Evaluating Social
//! Robot Navigation Algorithms", arXiv:2306.16740, 2023); spaces around people are those of Hall ("The Hidden Dimension",
//! 1966).

mod measures;

use cohabit_cdf::BodyKind;
use cohabit_record::{Movement, Trail};

use crate::{
    played::{Played, ROBOT},
    table::{
        Cell, Field,
        Kind::{Real, Text, Whole},
        Table,
    },
};
use measures::{Near, Walk};

const FIELDS: [Field; 21] = [
    Field::new("session", Text, "", "the session, as in the table of sessions"),
    Field::new("robot", Whole, "", "the robot's body"),
    Field::new("person", Whole, "", "the person's body"),
    Field::new("watched_s", Real, "s", "simulated time for which it is known where both were"),
    Field::new("min_distance_m", Real, "m", "the least that was between their outlines (cylinders of their radii)"),
    Field::new("intimate_s", Real, "s", "time for which that was less than 0.45 m (intimate space, Hall 1966)"),
    Field::new(
        "personal_s",
        Real,
        "s",
        "time for which it was less than 1.2 m (personal space), intimate space included",
    ),
    Field::new(
        "contacts",
        Whole,
        "",
        "how often they touched: came closer than 0.05 m, which two bodies cover in a tick; the world lets none overlap",
    ),
    Field::new("near_s", Real, "s", "time for which it was less than 3.6 m (social space)"),
    Field::new("speed_near_m_s", Real, "m/s", "the robot's mean speed in that time"),
    Field::new("path_m", Real, "m", "length of the robot's whole path"),
    Field::new(
        "irregularity_rad_m",
        Real,
        "rad/m",
        "path irregularity: how far the direction of the robot's motion turned, left or right, per metre of path",
    ),
    Field::new("travels", Whole, "", "commands to go somewhere that ended, but for those where it was there already"),
    Field::new("arrived", Whole, "", "those of them after which it was there; the next five are about these"),
    Field::new("time_to_goal_s", Real, "s", "simulated time that one took, mean"),
    Field::new(
        "path_efficiency",
        Real,
        "",
        "the shortest way as a share of the way that was gone, mean: the shortest way knows walls, furniture and doors as they are at \
         the arrival, and no bodies, so a detour around a person makes it less, as one without a reason does",
    ),
    Field::new(
        "shortest",
        Text,
        "",
        "what the shortest way is: over the `floor`, around what stands there; a `straight line`, where the floor has none; \
         or `both`",
    ),
    Field::new("gone_m", Real, "m", "length of the way that was gone, mean"),
    Field::new(
        "possible_m",
        Real,
        "m",
        "length of the shortest way, other bodies left out, as the floor was when the robot was sent, mean: what was possible had \
         nobody been there, and nothing changed",
    ),
    Field::new(
        "stalled_s",
        Real,
        "s",
        "time in which the robot was to go somewhere and neither moved (0.05 m/s) nor turned (0.1 rad/s)",
    ),
    Field::new(
        "problem",
        Text,
        "",
        "why a part of the session is missing here: its log lacks it, or replays otherwise",
    ),
];

/// All encounters of these sessions.
pub fn table(played: &[Played]) -> Table {
    let of_one = |played: &Played| {
        let rows = |movement| rows(&played.name, movement);
        played.movement.as_ref().map_or_else(Vec::new, rows)
    };
    Table {
        name: "social",
        meaning: "a robot and a person in a session, and how they moved around each other",
        fields: FIELDS.into(),
        rows: played.iter().flat_map(of_one).collect(),
    }
}

fn rows(session: &str, movement: &Movement) -> Vec<Vec<Cell>> {
    let problem = || Cell::text(movement.problem.as_deref().unwrap_or_default());
    if movement.trails.is_empty() {
        let known = [Cell::text(session)].into_iter();
        let nothing = std::iter::repeat_n(Cell::Nothing, FIELDS.len() - 2);
        return vec![known.chain(nothing).chain([problem()]).collect()];
    }
    let row = |(robot, person): (&Trail, &Trail)| {
        let who = [Cell::text(session), Cell::whole(robot.body), Cell::whole(person.body)];
        let cells = who.into_iter().chain(near_cells(&Near::new(robot, person)));
        cells.chain(walk_cells(&Walk::new(robot, &movement.travels))).chain([problem()]).collect()
    };
    pairs(movement).map(row).collect()
}

/// Each robot with each person.
fn pairs(movement: &Movement) -> impl Iterator<Item = (&Trail, &Trail)> {
    let of = move |kind: BodyKind| movement.trails.iter().filter(move |trail| trail.kind == kind);
    of(BodyKind::Robot).flat_map(move |robot| of(BodyKind::Person).map(move |person| (robot, person)))
}

fn near_cells(near: &Near) -> [Cell; 7] {
    [
        Cell::Real(near.watched_s),
        Cell::maybe(near.min_distance_m, Cell::Real),
        Cell::Real(near.intimate_s),
        Cell::Real(near.personal_s),
        Cell::whole(near.contacts),
        Cell::Real(near.social_s),
        Cell::maybe(near.speed_m_s, Cell::Real),
    ]
}

fn walk_cells(walk: &Walk) -> [Cell; 10] {
    [
        Cell::Real(walk.path_m),
        Cell::maybe(walk.irregularity_rad_m, Cell::Real),
        Cell::whole(walk.travels),
        Cell::whole(walk.arrived),
        Cell::maybe(walk.time_to_goal_s, Cell::Real),
        Cell::maybe(walk.efficiency, Cell::Real),
        Cell::maybe(walk.shortest, Cell::text),
        Cell::maybe(walk.gone_m, Cell::Real),
        Cell::maybe(walk.possible_m, Cell::Real),
        Cell::Real(walk.stalled_s),
    ]
}

/// A measure of a whole session: of the robot that is spoken to, and all people.
pub(crate) struct SessionMeasure {
    /// What summaries call it.
    pub name: &'static str,
    /// Its field in the table.
    pub field: &'static str,
    /// Its unit; empty where it has none.
    pub unit: &'static str,
    /// What it means.
    pub meaning: &'static str,
    /// Its value in a session, if it has one.
    pub value: fn(&Movement) -> Option<f64>,
}

/// What summaries compare.
pub(crate) static SESSION_MEASURES: [SessionMeasure; 7] = [
    SessionMeasure {
        name: "minimum distance",
        field: "social_min_distance_m",
        unit: "m",
        meaning: "the least that was between the robot and a person",
        value: |movement| nears(movement).iter().filter_map(|near| near.min_distance_m).reduce(f64::min),
    },
    SessionMeasure {
        name: "intimate space",
        field: "social_intimate_s",
        unit: "s",
        meaning: "time for which the robot was within 0.45 m of a person, summed over people",
        value: |movement| sum(&nears(movement), |near| near.intimate_s),
    },
    SessionMeasure {
        name: "personal space",
        field: "social_personal_s",
        unit: "s",
        meaning: "time for which the robot was within 1.2 m of a person, summed over people",
        value: |movement| sum(&nears(movement), |near| near.personal_s),
    },
    SessionMeasure {
        name: "contacts",
        field: "social_contacts",
        unit: "",
        meaning: "how often the robot and a person touched",
        value: |movement| sum(&nears(movement), |near| near.contacts as f64),
    },
    SessionMeasure {
        name: "time to goal",
        field: "social_time_to_goal_s",
        unit: "s",
        meaning: "simulated time in which the robot arrived where it was sent, mean",
        value: |movement| walk(movement)?.time_to_goal_s,
    },
    SessionMeasure {
        name: "path efficiency",
        field: "social_path_efficiency",
        unit: "",
        meaning: "the shortest way as a share of the way that the robot went, mean",
        value: |movement| walk(movement)?.efficiency,
    },
    SessionMeasure {
        name: "path irregularity",
        field: "social_irregularity_rad_m",
        unit: "rad/m",
        meaning: "how far the direction of the robot's motion turned per metre",
        value: |movement| walk(movement)?.irregularity_rad_m,
    },
];

fn robot(movement: &Movement) -> Option<&Trail> {
    movement.trails.iter().find(|trail| trail.body == ROBOT && trail.kind == BodyKind::Robot)
}

fn walk(movement: &Movement) -> Option<Walk> {
    Some(Walk::new(robot(movement)?, &movement.travels))
}

fn nears(movement: &Movement) -> Vec<Near> {
    pairs(movement).filter(|(robot, _)| robot.body == ROBOT).map(|(robot, person)| Near::new(robot, person)).collect()
}

fn sum(nears: &[Near], of: impl Fn(&Near) -> f64) -> Option<f64> {
    (!nears.is_empty()).then(|| nears.iter().map(of).sum())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests;
