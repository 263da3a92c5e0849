//! Assignments are balanced, and follow from seed and place.

use std::collections::BTreeMap;

use proptest::prelude::*;

use super::*;
use crate::{
    cycle::Cycle,
    design::{Factor, Level, Limits},
    pair::{Pairing, PartnerAbsent, SkippedBy, partner_of},
    settings::{Setting, merged},
};

fn factor(name: &str, kind: FactorKind, levels: usize) -> Factor {
    let level = |number: usize| Level {
        name: format!("{name}{number}"),
        settings: Settings::from([(name.to_owned(), Setting::Value(number.to_string()))]),
    };
    Factor { name: name.to_owned(), kind, levels: (0..levels).map(level).collect() }
}

fn study(seed: u64, assignment: Assignment, [between, within, each]: [usize; 3], order: MissionOrder) -> Study {
    Study {
        title: "T".to_owned(),
        contact: "C".to_owned(),
        seed,
        participants: 1,
        assignment,
        block_size: between,
        missions: (0..within * each).map(|number| format!("m{number}")).collect(),
        factors: vec![factor("b", FactorKind::Between, between), factor("w", FactorKind::Within, within)],
        blocks: vec![Block::Missions(Missions {
            order,
            after_mission: vec!["tlx".to_owned()],
            after_condition: vec!["sus".to_owned()],
            ..Missions::default()
        })],
        ..Study::default()
    }
}

fn played(plan: &Plan) -> Vec<(String, String)> {
    let of_step = |step: &Step| match step {
        Step::Mission(mission) => Some((mission.mission.clone(), mission.within[0].level.clone())),
        _ => None,
    };
    plan.steps.iter().filter_map(of_step).collect()
}

fn count<T: Ord>(all: impl IntoIterator<Item = T>) -> BTreeMap<T, usize> {
    all.into_iter().fold(BTreeMap::new(), |mut counts, one| {
        *counts.entry(one).or_default() += 1;
        counts
    })
}

fn is_even<T: Ord>(counts: &BTreeMap<T, usize>, entries: usize) -> bool {
    counts.len() == entries && counts.values().max() == counts.values().min()
}

const SQUARES: [Assignment; 2] = [Assignment::LatinSquare, Assignment::BalancedLatinSquare];

proptest! {
    #[test]
    fn between_conditions_differ_by_one_at_most(seed: u64, between in 1_usize..6, people in 1_u32..40) {
        let study = study(seed, Assignment::BlockRandom, [between, 1, 1], MissionOrder::Fixed);
        let counts = count((1..=people).map(|place| assign(&study, place).between));
        let fewest = if counts.len() < between { 0 } else { counts.values().copied().min().unwrap_or(0) };
        prop_assert!(counts.values().all(|found| found - fewest <= 1), "{counts:?}");
    }

    #[test]
    fn larger_blocks_have_each_condition_as_often(seed: u64, between in 2_usize..5, each in 1_usize..5) {
        let mut study = study(seed, Assignment::BlockRandom, [between, 1, 1], MissionOrder::Fixed);
        study.block_size = between * each;
        let people = u32::try_from(study.block_size * 2).unwrap();
        let counts = count((1..=people).map(|place| assign(&study, place).between));
        prop_assert!(is_even(&counts, between), "{counts:?}");
    }

    #[test]
    fn each_participant_meets_each_condition_and_mission_as_often(
        seed: u64, place in 1_u32..500, within in 1_usize..6, each in 1_usize..4, order in 0_usize..3
    ) {
        let order = [MissionOrder::Fixed, MissionOrder::Random, MissionOrder::Balanced][order];
        for assignment in SQUARES.into_iter().chain([Assignment::BlockRandom]) {
            let study = study(seed, assignment, [2, within, each], order);
            let plan = assign(&study, place);
            let played = played(&plan);
            prop_assert!(is_even(&count(played.iter().map(|(mission, _)| mission)), within * each));
            prop_assert!(is_even(&count(played.iter().map(|(_, level)| level)), within));
            // A condition's missions are played one after the other.
            prop_assert!(played.chunks(each).all(|chunk| chunk.iter().all(|one| one.1 == chunk[0].1)));
            let questions = plan.steps.iter().filter(|step| matches!(step, Step::Questionnaire { .. })).count();
            prop_assert_eq!(questions, within * each + within);
            prop_assert_eq!(&plan, &assign(&study, place));
        }
    }

    #[test]
    fn squares_are_balanced_within_each_between_condition(
        seed: u64, between in 1_usize..4, within in 2_usize..6, groups in 1_usize..3
    ) {
        for assignment in SQUARES {
            let study = study(seed, assignment, [between, within, 1], MissionOrder::Balanced);
            let rows = if assignment == Assignment::LatinSquare { within } else { square::balanced(within).len() };
            let people = u32::try_from(between * rows * groups).unwrap();
            let plans: Vec<_> = (1..=people).map(|place| assign(&study, place)).collect();
            let positions = plans.iter().flat_map(|plan| {
                let levels = played(plan).into_iter().map(|(_, level)| level).enumerate();
                levels.map(|at| (plan.between.clone(), at))
            });
            prop_assert!(is_even(&count(positions), between * within * within));
            // Each mission meets each condition as often.
            prop_assert!(is_even(&count(plans.iter().flat_map(played)), within * within));
            if assignment == Assignment::BalancedLatinSquare {
                let pairs = plans.iter().flat_map(|plan| {
                    let levels: Vec<_> = played(plan).into_iter().map(|(_, level)| level).collect();
                    levels.windows(2).map(|pair| (pair[0].clone(), pair[1].clone())).collect::<Vec<_>>()
                });
                prop_assert!(is_even(&count(pairs), within * (within - 1)));
            }
        }
    }
}

proptest! {
    #[test]
    fn a_full_cycle_balances_conditions_missions_and_their_positions(
        seed: u64, between in 1_usize..3, within in 1_usize..4, each in 1_usize..3, blocks in 1_usize..4
    ) {
        for assignment in SQUARES {
            let mut study = study(seed, assignment, [between, within, each], MissionOrder::Balanced);
            study.block_size = between * blocks;
            let missions = within * each;
            let people = u32::try_from(Cycle::of(&study).participants()).unwrap();
            let met = (1..=people).flat_map(|place| {
                let plan = assign(&study, place);
                let played = played(&plan).into_iter().enumerate();
                played.map(move |at| (plan.between.clone(), at)).collect::<Vec<_>>()
            });
            prop_assert!(is_even(&count(met), between * missions * missions * within));
        }
    }
}

const PAIRING: Pairing = Pairing { wait_s: 60.0, partner_absent: PartnerAbsent::Wait, skip: SkippedBy::Both };

/// The plans of all pairs, the first participant's alone: the other one's is the same.
fn pairs(study: &Study, pairs: u32) -> Vec<Plan> {
    (0..pairs).map(|pair| assign(study, pair * PAIR_SIZE + 1)).collect()
}

proptest! {
    #[test]
    fn both_of_a_pair_do_the_same(
        seed: u64, place in 1_u32..200, between in 1_usize..4, within in 1_usize..4, order in 0_usize..3
    ) {
        let order = [MissionOrder::Fixed, MissionOrder::Random, MissionOrder::Balanced][order];
        for assignment in SQUARES.into_iter().chain([Assignment::BlockRandom]) {
            let study = Study { pairing: Some(PAIRING), ..study(seed, assignment, [between, within, 2], order) };
            let (plan, partners) = (assign(&study, place), assign(&study, partner_of(place)));
            prop_assert_eq!((&plan.between, &plan.steps), (&partners.between, &partners.steps));
            prop_assert_eq!(plan.place, place);
            // What a pair does is what a participant at its place would do.
            let alone = assign(&Study { pairing: None, ..study.clone() }, pair_of(place));
            prop_assert_eq!(Plan { place, ..alone }, plan);
        }
    }

    #[test]
    fn squares_and_blocks_are_balanced_over_pairs(
        seed: u64, between in 1_usize..3, within in 1_usize..4, each in 1_usize..3, blocks in 1_usize..3
    ) {
        for assignment in SQUARES {
            let study = Study {
                pairing: Some(PAIRING),
                block_size: between * blocks,
                ..study(seed, assignment, [between, within, each], MissionOrder::Balanced)
            };
            let (cycle, missions) = (Cycle::of(&study), within * each);
            let plans = pairs(&study, u32::try_from(cycle.participants()).unwrap() / PAIR_SIZE);
            let counts = count(plans.iter().map(|plan| plan.between.clone()));
            prop_assert!(is_even(&counts, between), "{counts:?}");
            let met = plans.iter().flat_map(|plan| {
                let played = played(plan).into_iter().enumerate();
                played.map(|at| (plan.between.clone(), at)).collect::<Vec<_>>()
            });
            prop_assert!(is_even(&count(met), between * missions * missions * within));
        }
    }

    #[test]
    fn own_conditions_of_a_pair_are_balanced_over_participants(
        seed: u64, own in 1_usize..4, between in 1_usize..3, groups in 1_usize..4
    ) {
        let mut study = study(seed, Assignment::BlockRandom, [between, 1, 1], MissionOrder::Fixed);
        study.pairing = Some(PAIRING);
        study.factors.push(factor("o", FactorKind::Own, own));
        // Each group takes as many participants of one condition as there are own ones, and whole pairs of them.
        let people = u32::try_from(between * own * groups * 2).unwrap();
        let plans: Vec<_> = (1..=people).map(|place| assign(&study, place)).collect();
        prop_assert!(is_even(&count(plans.iter().map(|plan| plan.between.clone())), between * own));
        for pair in plans.chunks(2) {
            let (first, second) = (&pair[0].between, &pair[1].between);
            prop_assert_eq!(&first[0], &second[0], "the condition of the session is the pair's");
            prop_assert!(own != 2 || first[1] != second[1], "of two, each has one");
        }
    }
}

#[test]
fn cycles_are_of_what_is_balanced() {
    let check = |assignment, counts, order, block_size, expected| {
        let study = Study { block_size, ..study(1, assignment, counts, order) };
        assert_eq!(Cycle::of(&study).participants(), expected, "{assignment:?} {counts:?} {order:?} {block_size}");
    };
    check(Assignment::BalancedLatinSquare, [1, 3, 1], MissionOrder::Balanced, 1, 18);
    check(Assignment::BalancedLatinSquare, [1, 3, 1], MissionOrder::Fixed, 1, 6);
    check(Assignment::LatinSquare, [2, 3, 2], MissionOrder::Balanced, 2, 36);
    check(Assignment::LatinSquare, [2, 2, 1], MissionOrder::Random, 6, 12);
    check(Assignment::BlockRandom, [2, 3, 1], MissionOrder::Fixed, 4, 4);
    let pairs = study(1, Assignment::LatinSquare, [2, 3, 2], MissionOrder::Balanced);
    assert_eq!(Cycle::of(&Study { pairing: Some(PAIRING), ..pairs }).participants(), 72);
}

#[test]
fn settings_follow_from_conditions() {
    let study = study(3, Assignment::LatinSquare, [2, 3, 1], MissionOrder::Fixed);
    for place in 1..7 {
        let plan = assign(&study, place);
        for step in &plan.steps {
            let Step::Mission(mission) = step else { continue };
            for choice in plan.between.iter().chain(&mission.within) {
                let value = choice.level.trim_start_matches(&*choice.factor);
                assert_eq!(mission.settings[&choice.factor], Setting::Value(value.to_owned()));
            }
        }
    }
    assert_ne!(assign(&study, 1), assign(&Study { seed: 4, ..study.clone() }, 1));
}

#[test]
fn a_practice_is_under_no_condition_and_a_blocks_settings_give_way_to_levels_alone() {
    let mut study = study(3, Assignment::LatinSquare, [2, 2, 1], MissionOrder::Fixed);
    let own = |name: &str, value: &str| Settings::from([(name.to_owned(), Setting::Value(value.to_owned()))]);
    let one = |is_practice: bool| Block::Mission {
        mission: "m0".to_owned(),
        is_practice,
        exercises: Vec::new(),
        settings: own("common", "own"),
        limits: Limits::default(),
        text: String::new(),
    };
    study.settings = merged(&[&own("common", "all"), &own("knows", "seen")]);
    if let Block::Missions(missions) = &mut study.blocks[0] {
        missions.settings = merged(&[&own("w", "block"), &own("common", "block")]);
    }
    study.blocks = [vec![one(true), one(false)], study.blocks].concat();
    let plan = assign(&study, 1);
    let [Step::Mission(practice), Step::Mission(mission), Step::Mission(compared), ..] = &plan.steps[..] else {
        panic!("three missions")
    };
    assert_eq!(practice.settings, merged(&[&own("common", "own"), &own("knows", "seen")]));
    assert_eq!((plan.choices(0), plan.choices(1)), (Vec::new(), plan.between.clone()));
    assert!(mission.settings.contains_key("b") && mission.settings["common"] == own("common", "own")["common"]);
    assert_eq!(compared.settings["common"], own("common", "block")["common"]);
    assert_ne!(compared.settings["w"], own("w", "block")["w"]);
    assert!(plan.is_practice(0) && !plan.is_practice(1) && !plan.is_practice(2));
}
