//! The crates, and the modules within them, know each other only as the architecture allows; and files are short.
#![allow(clippy::unwrap_used)]

mod modules;

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use modules::{circular, sources, uses};
use serde_json::Value;

/// Each package, its level, and the heavy dependencies that it alone may name.
const LEVELS: &[(&str, u8, &[&str])] = &[
    ("cohabit-cdf", 0, &["serde_json", "schemars"]),
    ("cohabit-durable", 0, &[]),
    ("cohabit-parquet", 0, &["parquet"]),
    ("cohabit-world", 1, &["rapier3d", "polyanya"]),
    ("cohabit-bus", 1, &["iceoryx2"]),
    ("cohabit-floorplans", 1, &[]),
    ("cohabit-gltf", 1, &["gltf"]),
    ("cohabit-planner", 1, &[]),
    ("cohabit-rewriter", 1, &["safetensors"]),
    ("cohabit-render", 2, &[]),
    ("cohabit-record", 2, &["mcap", "crc32fast", "flate2"]),
    ("cohabit-agent", 2, &[]),
    ("cohabit-generate", 2, &[]),
    ("cohabit-houses", 2, &[]),
    ("cohabit-language", 2, &[]),
    ("cohabit-speech", 2, &["ort", "earshot", "rustfft", "sha2", "zip"]),
    ("cohabit-gpu", 3, &["wgpu"]),
    ("cohabit-engine", 3, &[]),
    ("cohabit-tables", 3, &["csv", "faer", "statrs"]),
    ("cohabit-arena", 4, &[]),
    ("cohabit-benchmark", 4, &[]),
    ("cohabit-convert", 4, &[]),
    ("cohabit-demonstrate", 4, &[]),
    ("cohabit-rerun", 4, &["re_sdk", "re_sdk_types", "arrow"]),
    ("cohabit-dialog", 4, &["tokio", "axum", "hyper", "hyper-util", "rustls", "tokio-rustls", "rcgen"]),
    ("cohabit-annotate", 5, &[]),
    ("cohabit-edit", 5, &[]),
    ("cohabit-eval", 5, &[]),
    ("cohabit-host", 5, &[]),
    ("cohabit-mcp", 5, &[]),
    ("cohabit-study", 5, &[]),
    ("cohabit-vision", 5, &[]),
    ("cohabit-python", 5, &["pyo3", "numpy"]),
    ("cohabit", 6, &["clap", "clap_complete", "clap_mangen", "anyhow", "indicatif"]),
];

/// Dependencies that others may name too: the log, pages, existing clients and those of tools speak JSON, tests report errors of all
/// kinds, there are two programs, data sets are tables too, and studies, annotators, editors and hosts have routes of their own.
const SHARED: &[(&str, &[&str])] = &[
    (
        "serde_json",
        &[
            "cohabit-record",
            "cohabit-speech",
            "cohabit-annotate",
            "cohabit-arena",
            "cohabit-benchmark",
            "cohabit-dialog",
            "cohabit-durable",
            "cohabit-edit",
            "cohabit-eval",
            "cohabit-convert",
            "cohabit-demonstrate",
            "cohabit-generate",
            "cohabit-host",
            "cohabit-houses",
            "cohabit-mcp",
            "cohabit-study",
            "cohabit-vision",
            "cohabit",
            "cohabit-tests",
        ],
    ),
    ("anyhow", &["cohabit-rerun", "cohabit-tests"]),
    ("clap", &["cohabit-rerun"]),
    ("parquet", &["cohabit-rerun"]),
    ("axum", &["cohabit-annotate", "cohabit-edit", "cohabit-host", "cohabit-study"]),
    ("tokio", &["cohabit-annotate", "cohabit-edit", "cohabit-study"]),
];

/// The most lines of a file. Tests do not count, nor does what is made while building.
const MOST_LINES: usize = 500;

fn metadata() -> Value {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--no-deps", "--format-version", "1", "--offline"])
        .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// `(package, dependency)` for all that is built into the product.
fn dependencies() -> Vec<(String, String)> {
    let text = |value: &Value| value.as_str().unwrap().to_owned();
    let metadata = metadata();
    let packages = metadata["packages"].as_array().unwrap();
    packages
        .iter()
        .flat_map(|package| {
            let built_in = |dependency: &&Value| dependency["kind"].is_null();
            let dependencies = package["dependencies"].as_array().unwrap().iter().filter(built_in);
            dependencies.map(move |dependency| (text(&package["name"]), text(&dependency["name"])))
        })
        .collect()
}

/// The folders of the packages below a root, by name.
fn packages() -> (PathBuf, Vec<(String, PathBuf)>) {
    let metadata = metadata();
    let folder = |package: &Value| Path::new(package["manifest_path"].as_str().unwrap()).parent().unwrap().to_owned();
    let packages = metadata["packages"].as_array().unwrap().iter();
    let packages = packages.map(|package| (package["name"].as_str().unwrap().to_owned(), folder(package))).collect();
    (metadata["workspace_root"].as_str().unwrap().into(), packages)
}

fn level(package: &str) -> Option<u8> {
    LEVELS.iter().find(|(name, ..)| *name == package).map(|(_, level, _)| *level)
}

#[test]
fn a_crate_depends_on_lower_levels_alone() {
    let wrong: Vec<_> = dependencies()
        .into_iter()
        .filter(|(package, _)| package != "cohabit-tests")
        .filter(|(package, dependency)| match (level(package), level(dependency)) {
            (Some(above), Some(below)) => below >= above,
            (None, _) => true,
            _ => false,
        })
        .collect();
    assert!(wrong.is_empty(), "dependencies against the levels (or packages without one): {wrong:?}");
}

#[test]
fn a_heavy_dependency_has_one_owner() {
    let shared = |package: &str, dependency: &str| {
        SHARED.iter().any(|(name, packages)| *name == dependency && packages.contains(&package))
    };
    let wrong: Vec<_> = dependencies()
        .into_iter()
        .filter(|(package, dependency)| {
            let owner = LEVELS.iter().find(|(_, _, owned)| owned.contains(&dependency.as_str()));
            owner.is_some_and(|(owner, ..)| owner != package) && !shared(package, dependency)
        })
        .collect();
    assert!(wrong.is_empty(), "dependencies that belong to another crate: {wrong:?}");
}

#[test]
fn a_file_is_one_thing_and_no_longer_than_that() {
    let (root, packages) = packages();
    let folders = packages.iter().filter(|(package, _)| package != "cohabit-tests").map(|(_, folder)| folder);
    let lines = |path: &PathBuf| fs::read_to_string(path).unwrap().lines().count();
    let longer: Vec<PathBuf> =
        folders.flat_map(|folder| sources(folder)).filter(|path| lines(path) > MOST_LINES).collect();
    assert!(longer.is_empty(), "files of more than {MOST_LINES} lines below {}: {longer:#?}", root.display());
}

#[test]
fn modules_know_each_other_in_no_circle() {
    let mut wrong = Vec::new();
    for (package, folder) in packages().1 {
        let circles = circular(&uses(&folder.join("src")));
        wrong.extend(circles.into_iter().map(|(from, to)| format!("{package}: {from} uses {to}")));
    }
    assert!(wrong.is_empty(), "modules that know each other in circles: {wrong:#?}");
}
