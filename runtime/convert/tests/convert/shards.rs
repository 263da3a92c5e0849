//! Tar shards, read back.

use std::fs;

use cohabit_bus::message::Plane;
use cohabit_convert::Format;

use crate::{LARGE, Native, json};

/// The files of a tar archive: names and bytes.
fn read(mut archive: &[u8]) -> Vec<(String, Vec<u8>)> {
    let mut files = Vec::new();
    while archive[0] != 0 {
        let (header, rest) = archive.split_at(512);
        let text = |field: &[u8]| -> String {
            field.iter().take_while(|byte| **byte != 0).map(|byte| char::from(*byte)).collect()
        };
        let size = usize::from_str_radix(&text(&header[124..136]), 8).unwrap();
        files.push((text(&header[..100]), rest[..size].to_vec()));
        archive = &rest[size.next_multiple_of(512)..];
    }
    files
}

#[test]
fn shards_have_all_that_the_data_set_has() {
    let native = Native::new("shards", &["make_cereal", "cold_soda"], [32, 24], &[Plane::Color, Plane::Depth]);
    let (folder, counts) = native.convert("shards", Format::Shards, 40 << 10).unwrap();
    let index = json(&folder.join("index.json"));
    let shards = index["shards"].as_array().unwrap();
    assert!(shards.len() > 1 && shards.len() == counts.files, "{index}");
    let mut told = Vec::new();
    for shard in shards {
        let archive = fs::read(folder.join(shard["file"].as_str().unwrap())).unwrap();
        assert_eq!(shard["bytes"], archive.len());
        assert_eq!(shard["blake3"], blake3::hash(&archive).to_hex().as_str());
        let files = read(&archive);
        let samples = files.iter().filter(|(name, _)| name.split_once('.').unwrap().1 == "json").count();
        assert_eq!(shard["samples"], samples);
        assert!(archive.len() <= 40 << 10 || samples == 1, "{shard}");
        told.extend(files);
    }
    let mut expected = Vec::new();
    for episode in 0..2 {
        for (step, (text, line)) in native.lines(episode).into_iter().enumerate() {
            let mut add = |name: &str, bytes: Vec<u8>| expected.push((format!("{episode:06}-{step:04}.{name}"), bytes));
            add("color.png", native.picture(episode, &line, "color"));
            add("depth.png", native.picture(episode, &line, "depth"));
            if step == 0 {
                add("episode.json", native.text(episode, "episode.json").into_bytes());
                add("mission.json", native.text(episode, "mission.json").into_bytes());
            }
            add("json", text.into_bytes());
        }
    }
    let names = |files: &[(String, Vec<u8>)]| files.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
    assert_eq!(names(&told), names(&expected));
    assert!(told == expected);
    let (_, whole) = native.convert("whole", Format::Shards, LARGE).unwrap();
    assert_eq!((whole.files, whole.samples), (1, counts.samples));
}
