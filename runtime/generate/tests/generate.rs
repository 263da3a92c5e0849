//! Missions of all types, made and certified.

#![allow(clippy::unwrap_used)]

use std::{collections::BTreeMap, sync::Arc};

use cohabit_cdf::Catalog;
use cohabit_generate::{GenerateError, Order, Spec, certify, generate};
use serde_json::Value;

fn lines(spec: &Spec, count: usize, seed: u64, workers: usize) -> Vec<Value> {
    let catalog = Arc::new(Catalog::builtin());
    let mut lines = Vec::new();
    generate(spec, &catalog, Order { count, seed, workers }, &mut |mission| lines.push(mission.as_line())).unwrap();
    lines
}

#[test]
fn every_type_has_missions_that_are_solved() {
    let catalog = Arc::new(Catalog::builtin());
    let spec = Spec::builtin(&catalog);
    let count = 2 * spec.types().count();
    let (mut made, order) = (BTreeMap::<String, usize>::new(), Order { count, seed: 1, workers: 2 });
    let given_up = generate(&spec, &catalog, order, &mut |mission| {
        assert!(!mission.certificate.digest.is_empty());
        *made.entry(mission.kind).or_default() += 1;
    })
    .unwrap();
    let never: Vec<_> = spec.types().filter(|kind| !made.contains_key(*kind)).collect();
    assert!(never.is_empty(), "{never:?} of {given_up:#?}");
}

#[test]
fn the_same_seed_makes_the_same_missions_with_any_number_of_workers() {
    let spec = Spec::builtin(&Catalog::builtin());
    assert_eq!(lines(&spec, 12, 7, 1), lines(&spec, 12, 7, 3));
    assert_ne!(lines(&spec, 4, 7, 2), lines(&spec, 4, 8, 2));
}

#[test]
fn a_certificate_holds_for_whoever_plays_again() {
    let spec = Spec::builtin(&Catalog::builtin());
    let catalog = Arc::new(Catalog::builtin());
    for line in lines(&spec, 3, 5, 2) {
        let seed = line["certificate"]["seed"].as_u64().unwrap();
        let again = certify("again", &line["cdf"].to_string(), &catalog, seed).unwrap();
        assert_eq!(line["certificate"]["digest"], again.digest);
    }
}

#[test]
fn what_cannot_be_made_is_said() {
    let catalog = Arc::new(Catalog::builtin());
    let text =
        "[[type]]\nname = \"sparks\"\nvars = [{ name = \"a\", class = [\"Apple\"] }]\ngoals = [\"a isSparking=true\"]";
    let spec = Spec::parse("spec.toml", text, &catalog).unwrap();
    let order = Order { count: 2, seed: 1, workers: 1 };
    let error = generate(&spec, &catalog, order, &mut |_| ()).unwrap_err();
    assert!(matches!(&error, GenerateError::Exhausted { made: 0, kind, .. } if kind == "sparks"), "{error}");
}
