//! Any bytes as a glTF file, whole or behind the head of a GLB: the file is refused in words, or becomes files that can be read back.

#![no_main]

use cohabit_cdf::Catalog;
use cohabit_gltf::{Options, Size, import, text};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Some((kind, rest)) = bytes.split_first() else { return };
    let mut options = Options::new("Fuzzed_01");
    options.triangles = 200;
    options.tint = kind & 2 != 0;
    options.size = if kind & 4 != 0 { Size::Height(0.3) } else { Size::OfFile };
    let file = if kind & 1 != 0 { glb(rest) } else { rest.to_vec() };
    match import(&file, None, &options) {
        Ok(imported) => {
            assert!(imported.triangles <= 200);
            let (objects, models) = (text::object(&imported.class), text::model(&imported.model));
            let read = Catalog::parse(&[("imported.toml", &objects)], &[("Fuzzed_01.toml", &models)]);
            let catalog = read.expect("what was written is read");
            assert_eq!((&catalog.classes()[0], &catalog.models()[0]), (&imported.class, &imported.model));
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});

/// The JSON up to the first byte that is 0, and what is behind it as a binary chunk, with lengths that fit.
fn glb(bytes: &[u8]) -> Vec<u8> {
    let end = bytes.iter().position(|byte| *byte == 0).unwrap_or(bytes.len());
    let (json, binary) = bytes.split_at(end);
    let length = |bytes: &[u8]| (bytes.len() as u32).to_le_bytes();
    let chunks = [&length(json)[..], b"JSON", json, &length(binary), b"BIN\0", binary].concat();
    [b"glTF\x02\0\0\0", &(chunks.len() as u32 + 12).to_le_bytes()[..], &chunks].concat()
}
