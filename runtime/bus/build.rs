//! Tells the tests of this crate whether they may make files of other users: only root may.

use std::{fs, os::unix::fs::MetadataExt as _};

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-check-cfg=cfg(root)");
    if fs::metadata("/proc/self").is_ok_and(|process| process.uid() == 0) {
        println!("cargo::rustc-cfg=root");
    }
}
