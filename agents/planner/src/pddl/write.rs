//! Domain and problem files.

use std::{collections::BTreeSet, fmt::Write as _};

use cohabit_cdf::{Color, Fluid, StateFlag};

use super::facts::{Facts, all, flag_name};
use crate::problem::{Assign, Deed, Index, Operator};

/// The places that are no things.
const PLACES: &str = "in-hand nowhere elsewhere behind-glass";

/// The domain file.
pub(super) fn domain(name: &str, facts: &Facts<'_>) -> String {
    let mut text = format!("(define (domain {name})\n  (:requirements :adl :derived-predicates)\n");
    text.push_str("  (:types place fluid color - object thing - place)\n");
    let _ = writeln!(text, "  (:constants\n    {PLACES} - place");
    let fluids: Vec<String> = Fluid::ALL.iter().map(|fluid| format!("fluid-{}", fluid.name().to_lowercase())).collect();
    let colors: Vec<String> = Color::ALL.iter().map(|color| format!("color-{}", color.name().to_lowercase())).collect();
    let _ = writeln!(text, "    {} - fluid\n    {} - color", fluids.join(" "), colors.join(" "));
    let _ = writeln!(text, "    {} - thing)", facts.things.join("\n    "));
    predicates(facts, &mut text);
    derived(facts, &mut text);
    for index in 0..facts.problem.operators.len() {
        operator(facts, index, &mut text);
    }
    goals(facts, &mut text);
    text.push_str(")\n");
    text
}

/// The problem file.
pub(super) fn problem(name: &str, facts: &Facts<'_>) -> String {
    let mut text = format!("(define (problem {name})\n  (:domain {name})\n  (:objects)\n  (:init\n    (idle)\n");
    let problem = facts.problem;
    for (var, (kind, value)) in (0_u32..).zip(problem.vars.iter().zip(&problem.initial)) {
        let is_false = Facts::is_switch(*kind) && *value == 0;
        if !is_false && !facts.follows(*kind) {
            let _ = writeln!(text, "    {}", facts.atom(var, *value));
        }
    }
    text.push_str("  )\n  (:goal (and");
    for number in 0..problem.goals.len() {
        let _ = write!(text, " ({}-{number})", if problem.can_reset[number] { "holding" } else { "met" });
    }
    text.push_str("))\n)\n");
    text
}

fn predicates(facts: &Facts<'_>, text: &mut String) {
    text.push_str("  (:predicates\n    (idle)\n    (hand-full)\n    (at ?thing - thing ?place - place)\n");
    text.push_str("    (near ?place - place)\n    (holds ?thing - thing ?fluid - fluid)\n");
    text.push_str("    (colored ?thing - thing ?color - color)\n    (is-fed ?thing - thing)\n");
    for flag in StateFlag::ALL {
        let _ = writeln!(text, "    ({} ?thing - thing)", flag_name(flag));
    }
    for (number, can_reset) in facts.problem.can_reset.iter().enumerate() {
        let _ = writeln!(text, "    ({}-{number})", if *can_reset { "holding" } else { "met" });
    }
    for number in 0..facts.problem.derived.len() {
        let _ = writeln!(text, "    (derived-{number})");
    }
    for receptacle in crowded(facts) {
        let (name, places) = (facts.thing(receptacle), facts.may_be_on(receptacle).len());
        for (among, count) in counts(places, capacity(facts, receptacle)) {
            let _ = writeln!(text, "    (holds-{name}-{among}-{count})");
        }
    }
    for (index, operator) in facts.problem.operators.iter().enumerate().filter(|(_, operator)| is_machine(operator)) {
        if is_possible(facts, operator) {
            let _ = writeln!(text, "    (on-{index})\n    (worked-{index})");
        }
    }
    text.push_str("  )\n");
}

/// What follows from other facts.
fn derived(facts: &Facts<'_>, text: &mut String) {
    for (number, (_, formulas)) in facts.problem.derived.iter().enumerate() {
        let parts: Vec<String> = formulas.iter().map(|formula| facts.formula(formula)).collect();
        let _ = writeln!(text, "  (:derived (derived-{number}) (or {}))", parts.join(" "));
    }
    let goals = facts.problem.goals.iter().zip(&facts.problem.can_reset).enumerate();
    for (number, (goal, _)) in goals.filter(|(_, (goal, can_reset))| **can_reset && !goal.is_false()) {
        let _ = writeln!(text, "  (:derived (holding-{number}) {})", facts.formula(goal));
    }
    for receptacle in crowded(facts) {
        let (name, places) = (facts.thing(receptacle), facts.may_be_on(receptacle));
        // At least so many of the first so many things are there.
        for (among, count) in counts(places.len(), capacity(facts, receptacle)) {
            let here = facts.is_on(places[among - 1], receptacle);
            let with = match (among - 1, count - 1) {
                (_, 0) => here,
                (fewer, less) => format!("(and {here} (holds-{name}-{fewer}-{less}))"),
            };
            let without = if among > count { format!(" (holds-{name}-{}-{count})", among - 1) } else { String::new() };
            let _ = writeln!(text, "  (:derived (holds-{name}-{among}-{count}) (or {with}{without}))");
        }
    }
}

/// What counts how full a thing is: for so many things, so many of them.
fn counts(things: usize, capacity: usize) -> impl Iterator<Item = (usize, usize)> {
    (1..=things).flat_map(move |among| (1..=capacity.min(among)).map(move |count| (among, count)))
}

fn capacity(facts: &Facts<'_>, receptacle: Index) -> usize {
    facts.problem.capacity.get(&receptacle).copied().unwrap_or(usize::MAX)
}

/// The things that actions may find full.
fn crowded(facts: &Facts<'_>) -> BTreeSet<Index> {
    let rooms = facts.problem.operators.iter().filter_map(|operator| operator.room);
    rooms.filter(|room| may_be_full(facts, *room)).collect()
}

fn may_be_full(facts: &Facts<'_>, receptacle: Index) -> bool {
    (1..=facts.may_be_on(receptacle).len()).contains(&capacity(facts, receptacle))
}

/// Whether anything could ever do it.
fn is_possible(facts: &Facts<'_>, operator: &Operator) -> bool {
    let never_has_room = operator.room.is_some_and(|room| capacity(facts, room) == 0);
    operator.deed != Deed::Nothing && !operator.needs.is_false() && !never_has_room
}

/// Whether it sets a machine going, whose work comes after it.
fn is_machine(operator: &Operator) -> bool {
    !operator.runs.is_empty() || operator.effects.iter().any(|assign| assign.is_work)
}

/// An action; and, if it sets a machine going, what follows from that.
fn operator(facts: &Facts<'_>, index: usize, text: &mut String) {
    let operator = &facts.problem.operators[index];
    if !is_possible(facts, operator) {
        return;
    }
    let mut needs = vec!["(idle)".to_owned()];
    needs.extend(facts.clauses(&operator.needs));
    if let Some(room) = operator.room.filter(|room| may_be_full(facts, *room)) {
        let (name, places) = (facts.thing(room), facts.may_be_on(room).len());
        needs.push(format!("(not (holds-{name}-{places}-{}))", capacity(facts, room)));
    }
    let assigns: Vec<&Assign> = operator.effects.iter().collect();
    let effects = facts.effects(&assigns);
    if !is_machine(operator) {
        action(&facts.action(index), &needs, &effects, text);
        return;
    }
    // The work is of what was there before: what is set at once, such as that the machine is on, comes with it.
    let started = ["(not (idle))".to_owned(), format!("(on-{index})")];
    action(&facts.action(index), &needs, &started, text);
    let ended = [format!("(not (on-{index}))"), format!("(worked-{index})")];
    action(&format!("work-{index}"), &[format!("(on-{index})")], &[effects, ended.into()].concat(), text);
    let off = operator.runs.iter().map(|var| format!("(not {})", facts.atom(*var, 1)));
    let mut effects: Vec<String> = off.collect();
    effects.extend([format!("(not (worked-{index}))"), "(idle)".to_owned()]);
    action(&format!("rest-{index}"), &[format!("(worked-{index})")], &effects, text);
}

/// That goals are met, and stay so.
fn goals(facts: &Facts<'_>, text: &mut String) {
    let goals = facts.problem.goals.iter().zip(&facts.problem.can_reset).enumerate();
    for (number, (goal, _)) in goals.filter(|(_, (goal, can_reset))| !**can_reset && !goal.is_false()) {
        let mut needs = facts.clauses(goal);
        needs.push(format!("(not (met-{number}))"));
        action(&format!("meet-{number}"), &needs, &[format!("(met-{number})")], text);
    }
}

fn action(name: &str, needs: &[String], effects: &[String], text: &mut String) {
    let _ = writeln!(text, "  (:action {name}\n    :parameters ()\n    :precondition {}", all(needs));
    let _ = writeln!(text, "    :effect {})", all(effects));
}
