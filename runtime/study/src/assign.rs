//! Who meets which conditions, in which order, with which missions: a function of the study and a participant's place.
//!
//! In a study of pairs all of it is assigned to pairs, so that both of one do the same; but for conditions of their own, which are of
//! their pages alone.

use std::collections::BTreeMap;

use crate::{
    chance::{Purpose, chance},
    design::{Assignment, Block, Condition, FactorKind, Minimisation, MissionOrder, Missions, Study},
    minimise::minimise,
    pair::{PAIR_SIZE, pair_of, seat_of},
    plan::{Plan, PlannedMission, Step},
    settings::{Settings, merged},
    square,
};

/// What the participant at a place, from 1, does. The same study and place give the same plan.
///
/// - A block of participants (`block_size`) has each between-participants condition equally often, in random order.
/// - Of those with one between-participants condition, each consecutive group of as many as a square has rows takes all
///   rows of a Latin square, in random order, its conditions labelled at random.
/// - Missions stand in the order that the block of missions says; the first ones are played under the first condition, and
///   so on.
/// - Of a study of pairs, this holds of pairs. Conditions of participants' own are as frequent in each group of participants, pair after
///   pair, as there are such conditions, in random order.
#[must_use]
pub fn assign(study: &Study, place: u32) -> Plan {
    let between = study.conditions(FactorKind::Between);
    let unit = if study.pairing.is_some() { pair_of(place) } else { place };
    plan(study, &between, place, &Position::new(study, unit, between.len()))
}

/// The same of one who comes instead of somebody who has left, with that one's place in the order of all.
#[must_use]
pub fn assign_instead(study: &Study, place: u32, order: u32) -> Plan {
    Plan { place, stands_for: (order != place).then_some(order), ..assign(study, order) }
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
    let position = Position { unit: u64::from(place), condition, before };
    Plan { covariates, ..plan(study, &between, place, &position) }
}

fn plan(study: &Study, between: &[Condition], place: u32, position: &Position) -> Plan {
    let condition = &with_own(study, &between[position.condition], place, position);
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
                add_missions(&mut steps, study, (number, missions), position, &settings);
            }
            Block::Break { limit_s, .. } => steps.push(Step::Break { block: number, limit_s: *limit_s }),
        }
    }
    Plan { place, between: condition.choices.clone(), steps, world: study.world_ids(), ..Plan::default() }
}

/// A condition between participants with the one that a participant of a pair has by themselves.
fn with_own(study: &Study, condition: &Condition, place: u32, position: &Position) -> Condition {
    let all = study.conditions(FactorKind::Own);
    let index = position.before * PAIR_SIZE as usize + seat_of(place) as usize;
    let (group, within) = (index / all.len(), index % all.len());
    let order = chance(study.seed, Purpose::Own, position.group(group)).order(all.len());
    let own = &all[order[within]];
    Condition {
        choices: [condition.choices.clone(), own.choices.clone()].concat(),
        settings: merged(&[&condition.settings, &own.settings]),
    }
}

fn asked(name: &str, about: Option<usize>) -> Step {
    Step::Questionnaire { name: name.to_owned(), about }
}

/// Where a participant, or a pair, is in the design.
struct Position {
    /// Their place in the order of all, from 1.
    unit: u64,
    /// The number of the between-participants condition.
    condition: usize,
    /// How many before have the same one.
    before: usize,
}

impl Position {
    fn new(study: &Study, unit: u32, conditions: usize) -> Self {
        let index = unit.max(1) as usize - 1;
        let each = (study.block_size / conditions).max(1);
        let size = each * conditions;
        let (block, within) = (index / size, index % size);
        let order = chance(study.seed, Purpose::Between, block as u64).order(size);
        let condition = |slot: &usize| slot / each;
        let own = condition(&order[within]);
        let before = block * each + order[..within].iter().filter(|slot| condition(slot) == own).count();
        Self { unit: u64::from(unit), condition: own, before }
    }

    /// A number for what is drawn once for the `group`-th group with this between-participants condition.
    fn group(&self, group: usize) -> u64 {
        (self.condition as u64) << 32 | group as u64
    }
}

/// The order of the within-participant conditions, and the number of the group that shares a square.
fn order(study: &Study, position: &Position, conditions: usize) -> (Vec<usize>, usize) {
    let rows = match study.assignment {
        Assignment::LatinSquare => square::latin(conditions),
        Assignment::BalancedLatinSquare => square::balanced(conditions),
        Assignment::BlockRandom => {
            return (chance(study.seed, Purpose::Conditions, position.unit).order(conditions), position.before);
        }
    };
    let (group, row) = (position.before / rows.len(), position.before % rows.len());
    let mut drawn = chance(study.seed, Purpose::Conditions, position.group(group));
    let (labels, order) = (drawn.order(conditions), drawn.order(rows.len()));
    (rows[order[row]].iter().map(|condition| labels[*condition]).collect(), group)
}

/// The missions in the order in which they are played.
fn sequence<'a>(study: &'a Study, order: MissionOrder, position: &Position, group: usize) -> Vec<&'a str> {
    let mut missions: Vec<&str> = study.missions.iter().map(String::as_str).collect();
    match order {
        MissionOrder::Fixed => {}
        MissionOrder::Random => chance(study.seed, Purpose::Missions, position.unit).shuffle(&mut missions),
        // Within a group each mission keeps its position, and meets all conditions; over as many groups as
        // there are missions it moves through all positions.
        MissionOrder::Balanced => {
            let count = missions.len().max(1);
            chance(study.seed, Purpose::Missions, position.group(group / count)).shuffle(&mut missions);
            missions.rotate_left(group % count);
        }
    }
    missions
}

fn add_missions(
    steps: &mut Vec<Step>,
    study: &Study,
    (block, asked_for): (usize, &Missions),
    position: &Position,
    settings: &dyn Fn(&Condition) -> Settings,
) {
    let within = study.conditions(FactorKind::Within);
    let (order, group) = order(study, position, within.len());
    let missions = sequence(study, asked_for.order, position, group);
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
