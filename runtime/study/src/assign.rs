//! Who meets which conditions, in which order, with which missions: a function of the study and a participant's place.

use std::collections::BTreeMap;

use crate::{
    chance::{Purpose, chance},
    design::{Assignment, Block, Condition, FactorKind, Minimisation, MissionOrder, Missions, Study},
    minimise::minimise,
    plan::{Plan, PlannedMission, Step},
    settings::Settings,
    square,
};

/// What the participant at a place, from 1, does. The same study and place give the same plan.
///
/// - A block of participants (`block_size`) has each between-participants condition equally often, in random order.
/// - Of those with one between-participants condition, each consecutive group of as many as a square has rows takes all
///   rows of a Latin square, in random order, its conditions labelled at random.
/// - Missions stand in the order that the block of missions says; the first ones are played under the first condition, and
///   so on.
#[must_use]
pub fn assign(study: &Study, place: u32) -> Plan {
    let between = study.conditions(FactorKind::Between);
    plan(study, &between, &Seat::new(study, place, between.len()))
}

/// What a participant does before a condition is assigned that depends on what they answer.
#[must_use]
pub fn begin(study: &Study, place: u32) -> Plan {
    let asks = |block: &Block| {
        let mut questionnaires = study.minimisation.iter().flat_map(Minimisation::questionnaires);
        matches!(block, Block::Questionnaires(names) if questionnaires.any(|asked| names.iter().any(|name| name == asked)))
    };
    let until = study.blocks.iter().rposition(asks).map_or(0, |last| last + 1);
    let mut steps = Vec::new();
    for (number, block) in study.blocks[..until].iter().enumerate() {
        match block {
            Block::Questionnaires(names) => steps.extend(names.iter().map(|name| asked(name, None))),
            Block::Break { limit_s, .. } => steps.push(Step::Break { block: number, limit_s: *limit_s }),
            // None stands there: the study was checked.
            Block::Mission { .. } | Block::Missions(_) => {}
        }
    }
    Plan { place, steps, awaits_assignment: true, world: study.world_ids(), ..Plan::default() }
}

/// What the participant at a place does whose levels of covariates are these, by minimisation among all who have a condition.
#[must_use]
pub fn assign_among(
    study: &Study,
    minimisation: &Minimisation,
    place: u32,
    covariates: BTreeMap<String, String>,
    others: &[&Plan],
) -> Plan {
    let between = study.conditions(FactorKind::Between);
    let choices: Vec<_> = between.iter().map(|condition| condition.choices.clone()).collect();
    let condition = minimise((minimisation, study.seed), &choices, (place, &covariates), others);
    let before = others.iter().filter(|plan| plan.between == choices[condition]).count();
    let seat = Seat { place: u64::from(place), condition, before };
    Plan { covariates, ..plan(study, &between, &seat) }
}

fn plan(study: &Study, between: &[Condition], seat: &Seat) -> Plan {
    let condition = &between[seat.condition];
    let mut steps = Vec::new();
    for (number, block) in study.blocks.iter().enumerate() {
        match block {
            Block::Questionnaires(names) => steps.extend(names.iter().map(|name| asked(name, None))),
            Block::Mission { mission, is_practice, exercises, limits, .. } => {
                steps.push(Step::Mission(PlannedMission {
                    block: number,
                    mission: mission.clone(),
                    is_practice: *is_practice,
                    exercises: exercises.clone(),
                    within: Vec::new(),
                    settings: study.settings_of(block, condition, &Condition::default()),
                    limits: *limits,
                }))
            }
            Block::Missions(missions) => {
                let settings = |within: &Condition| study.settings_of(block, condition, within);
                add_missions(&mut steps, study, (number, missions), seat, &settings);
            }
            Block::Break { limit_s, .. } => steps.push(Step::Break { block: number, limit_s: *limit_s }),
        }
    }
    let place = u32::try_from(seat.place).unwrap_or(u32::MAX);
    Plan { place, between: condition.choices.clone(), steps, world: study.world_ids(), ..Plan::default() }
}

fn asked(name: &str, about: Option<usize>) -> Step {
    Step::Questionnaire { name: name.to_owned(), about }
}

/// Where a participant is in the design.
struct Seat {
    place: u64,
    /// The number of the between-participants condition.
    condition: usize,
    /// How many participants before have the same one.
    before: usize,
}

impl Seat {
    fn new(study: &Study, place: u32, conditions: usize) -> Self {
        let index = place.max(1) as usize - 1;
        let each = (study.block_size / conditions).max(1);
        let size = each * conditions;
        let (block, within) = (index / size, index % size);
        let order = chance(study.seed, Purpose::Between, block as u64).order(size);
        let condition = |slot: &usize| slot / each;
        let own = condition(&order[within]);
        let before = block * each + order[..within].iter().filter(|slot| condition(slot) == own).count();
        Self { place: u64::from(place), condition: own, before }
    }

    /// A number for what is drawn once for the `group`-th group of participants with this between-participants condition.
    fn group(&self, group: usize) -> u64 {
        (self.condition as u64) << 32 | group as u64
    }
}

/// The order of the within-participant conditions, and the number of the group of participants that share a square.
fn order(study: &Study, seat: &Seat, conditions: usize) -> (Vec<usize>, usize) {
    let rows = match study.assignment {
        Assignment::LatinSquare => square::latin(conditions),
        Assignment::BalancedLatinSquare => square::balanced(conditions),
        Assignment::BlockRandom => {
            return (chance(study.seed, Purpose::Conditions, seat.place).order(conditions), seat.before);
        }
    };
    let (group, row) = (seat.before / rows.len(), seat.before % rows.len());
    let mut drawn = chance(study.seed, Purpose::Conditions, seat.group(group));
    let (labels, order) = (drawn.order(conditions), drawn.order(rows.len()));
    (rows[order[row]].iter().map(|condition| labels[*condition]).collect(), group)
}

/// The missions in the order in which they are played.
fn sequence<'a>(study: &'a Study, order: MissionOrder, seat: &Seat, group: usize) -> Vec<&'a str> {
    let mut missions: Vec<&str> = study.missions.iter().map(String::as_str).collect();
    match order {
        MissionOrder::Fixed => {}
        MissionOrder::Random => chance(study.seed, Purpose::Missions, seat.place).shuffle(&mut missions),
        // Within a group of participants each mission keeps its position, and meets all conditions; over as many groups as
        // there are missions it moves through all positions.
        MissionOrder::Balanced => {
            let count = missions.len().max(1);
            chance(study.seed, Purpose::Missions, seat.group(group / count)).shuffle(&mut missions);
            missions.rotate_left(group % count);
        }
    }
    missions
}

fn add_missions(
    steps: &mut Vec<Step>,
    study: &Study,
    (block, asked_for): (usize, &Missions),
    seat: &Seat,
    settings: &dyn Fn(&Condition) -> Settings,
) {
    let within = study.conditions(FactorKind::Within);
    let (order, group) = order(study, seat, within.len());
    let missions = sequence(study, asked_for.order, seat, group);
    let each = (missions.len() / within.len()).max(1);
    for (index, mission) in missions.iter().enumerate() {
        let condition = &within[order[(index / each).min(order.len() - 1)]];
        let step = steps.len();
        steps.push(Step::Mission(PlannedMission {
            block,
            mission: (*mission).to_owned(),
            is_practice: false,
            exercises: Vec::new(),
            within: condition.choices.clone(),
            settings: settings(condition),
            limits: asked_for.limits,
        }));
        steps.extend(asked_for.after_mission.iter().map(|name| asked(name, Some(step))));
        if (index + 1).is_multiple_of(each) {
            steps.extend(asked_for.after_condition.iter().map(|name| asked(name, Some(step))));
        }
    }
}

#[cfg(test)]
mod tests;
