//! Files that are broken or meant to do harm: each is refused in words, at once and without much memory.

use super::{
    files::{Builder, cube, quad},
    *,
};

fn said(bytes: &[u8]) -> String {
    import(bytes, None, &options()).unwrap_err().to_string()
}

#[track_caller]
fn check(bytes: &[u8], expected: &[&str]) {
    let said = said(bytes);
    assert!(expected.iter().all(|part| said.contains(part)), "{said}");
}

/// A cube whose document was changed.
fn changed(from: &str, to: &str) -> Vec<u8> {
    let mut file = Builder::default();
    let cube = file.primitive(&cube([0.1, 0.1, 0.1]), None);
    file.node(&format!(r#"{{"mesh":{}}}"#, file.mesh(&[cube])));
    let text = String::from_utf8(file.json()).unwrap();
    assert!(text.contains(from), "{from}: {text}");
    text.replacen(from, to, 1).into_bytes()
}

#[test]
fn a_file_that_is_cut_anywhere_is_refused() {
    let mut file = Builder::default();
    let image = file.png([2, 1], &[0, 160, 0, 0, 0, 255]);
    file.texture(&format!(r#"{{"source":{image}}}"#));
    let material = file.material(r#"{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}"#);
    let square =
        file.textured(&quad([0.0; 3], [0.1, 0.1, 0.0]), [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], material);
    file.node(&format!(r#"{{"mesh":{}}}"#, file.mesh(&[square])));
    let whole = file.glb();
    assert!(import(&whole, None, &options()).is_ok());
    for length in 0..whole.len() {
        assert!(!said(&whole[..length]).is_empty(), "{length}");
    }
    // Each byte changed: it is read or refused.
    for place in 0..whole.len() {
        for value in [0, 0x7f, 0xff] {
            let mut bytes = whole.clone();
            bytes[place] = value;
            if let Err(error) = import(&bytes, None, &options()) {
                assert!(!error.to_string().is_empty());
            }
        }
    }
}

#[test]
fn what_is_no_gltf_is_refused() {
    check(b"", &["no glTF"]);
    check(b"glTF", &["cut off"]);
    check(b"glTF\x01\0\0\0\x0c\0\0\0", &["glTF 1"]);
    check(b"glTF\x02\0\0\0\x04\0\0\0", &["cut off"]);
    check(b"glTF\x02\0\0\0\xff\xff\xff\xff", &["4294967295"]);
    check(b"glTF\x02\0\0\0\x14\0\0\0\0\0\0\0BIN\0", &["not JSON"]);
    check(br#"{"asset":{"version":"1.0"}}"#, &["glTF 1.0", "export"]);
    check(br#"{"asset":{"version":"2.0"}}"#, &["no scene"]);
    check(br#"{"asset":{"version":"2.0"},"scene":7}"#, &["scenes[7]", "there is none"]);
    check(format!("{}1{}", "[".repeat(100_000), "]".repeat(100_000)).as_bytes(), &["no glTF"]);
}

#[test]
fn json_that_would_take_much_memory_is_refused_before_it_is_read() {
    let head = r#"{"asset":{"version":"2.0"},"nodes":["#;
    check(format!("{head}{}{{}}]}}", "{},".repeat(700_000)).as_bytes(), &["700003 objects", "at most 600000"]);
    check(format!("{head}{{}}{}]}}", ",{}".repeat(200_000)).as_bytes(), &["200001 nodes", "at most 100000"]);
    let many = ",0".repeat(4_000_000);
    let children = format!(r#"{head}{{"children":[0{many}]}}],"scene":0,"scenes":[{{"nodes":[0]}}]}}"#);
    check(children.as_bytes(), &["nodes[0]", "its own child"]);
    check(format!("{head}{}]}}", ",".repeat(6_000_000)).as_bytes(), &["commas", "at most 5000000"]);
}

#[test]
fn required_extensions_are_named() {
    let bytes = changed(r#""scene":0"#, r#""extensionsRequired":["KHR_draco_mesh_compression"],"scene":0"#);
    check(&bytes, &["`KHR_draco_mesh_compression`", "export"]);
    assert!(
        import(
            &changed(r#""scene":0"#, r#""extensionsRequired":["KHR_mesh_quantization"],"scene":0"#),
            None,
            &options()
        )
        .is_ok()
    );
}

#[test]
fn counts_offsets_and_lengths_that_reach_beyond_are_refused() {
    check(&changed(r#""count":8"#, r#""count":9"#), &["accessors[0]", "9 values reach beyond bufferViews[0]"]);
    check(&changed(r#""count":8"#, r#""count":2999999"#), &["accessors[0]", "reach beyond"]);
    check(&changed(r#""count":8"#, r#""count":18446744073709551615"#), &["18446744073709551615 values", "at most"]);
    check(&changed(r#""count":36"#, r#""count":4000000000"#), &["1333333333 triangles", "at most 1000000"]);
    check(
        &changed(r#""count":8"#, r#""byteOffset":18446744073709551615,"count":8"#),
        &["accessors[0]", "reach beyond"],
    );
    check(
        &changed(r#""byteOffset":0"#, r#""byteOffset":18446744073709551615"#),
        &["bufferViews[0]", "beyond its buffer"],
    );
    check(&changed(r#""byteLength":96"#, r#""byteLength":10000000000"#), &["bufferViews[0]", "beyond its buffer"]);
    check(&changed(r#""byteOffset":0"#, r#""byteStride":4,"byteOffset":0"#), &["accessors[0]", "overlap"]);
    check(
        &changed(r#""byteOffset":0"#, r#""byteStride":18446744073709551615,"byteOffset":0"#),
        &["accessors[0]", "beyond"],
    );
    check(&changed(r#""buffer":0"#, r#""buffer":3"#), &["bufferViews[0]", "no buffer 3"]);
    check(&changed(r#""POSITION":0"#, r#""POSITION":9"#), &["accessors[9]", "there is none"]);
    check(&changed(r#""POSITION":0"#, r#""NORMAL":0"#), &["meshes[0].primitives[0]", "POSITION"]);
    check(&changed(r#""POSITION":0"#, r#""POSITION":1"#), &["accessors[1]", "1 numbers"]);
    check(&changed(r#""indices":1"#, r#""indices":0"#), &["accessors[0]", "3 numbers"]);
    check(&changed(r#""componentType":5125"#, r#""componentType":5126"#), &["accessors[1]"]);
    check(&changed(r#""componentType":5125"#, r#""componentType":77"#), &["accessors[1]", "componentType"]);
    check(&changed(r#""mesh":0"#, r#""mesh":5"#), &["meshes[5]"]);
    check(&changed(r#""nodes":[0]"#, r#""nodes":[4]"#), &["nodes[4]"]);
    check(&changed(r#""indices":1"#, r#""indices":1,"material":2"#), &["materials[2]"]);
    check(&changed(r#""indices":1"#, r#""indices":1,"mode":99"#), &["mode"]);
}

#[test]
fn claims_of_many_values_without_bytes_are_bounded() {
    let mut file = Builder::default();
    let huge = file.raw_accessor(r#"{"componentType":5126,"count":2999999,"type":"VEC3"}"#);
    let primitive = format!(r#"{{"attributes":{{"POSITION":{huge}}}}}"#);
    file.node(&format!(r#"{{"mesh":{}}}"#, file.mesh(&vec![primitive; 5000])));
    check(&file.glb(), &["triangles or more", "at most 1000000"]);
    // Few triangles of many points, again and again.
    let indices = file.indices(5121, &[0, 1, 2]);
    let primitive = format!(r#"{{"attributes":{{"POSITION":{huge}}},"indices":{indices}}}"#);
    let mut again = file.clone();
    again.node(&format!(r#"{{"mesh":{}}}"#, again.mesh(&vec![primitive; 5000])));
    let text = String::from_utf8(again.json()).unwrap().replacen(r#""nodes":[0,1]"#, r#""nodes":[1]"#, 1);
    check(text.as_bytes(), &["values of points", "at most 24000000"]);
}

#[test]
fn buffers_that_claim_more_than_there_is_are_refused() {
    let mut file = Builder::default();
    let cube = file.primitive(&cube([0.1, 0.1, 0.1]), None);
    file.node(&format!(r#"{{"mesh":{}}}"#, file.mesh(&[cube])));
    check(&file.glb_of(r#"{"byteLength":10000000000}"#), &["buffers[0]", "10000000000 bytes"]);
    check(&file.glb_of(r#"{"byteLength":10000000000},{"byteLength":10}"#), &["buffers[0]"]);
    check(&file.glb_of(r#"{"byteLength":10},{"byteLength":10}"#), &["buffers[1]", "no data"]);
    check(&file.glb_of(r#"{"byteLength":10,"uri":"data:x;base64,AA=A"}"#), &["buffers[0]", "base64 is broken"]);
    check(&file.glb_of(r#"{"byteLength":10,"uri":"data:,abc"}"#), &["buffers[0]", "not in base64"]);
}

#[test]
fn files_outside_of_the_folder_are_not_read() {
    let mut file = Builder::default();
    let cube = file.primitive(&cube([0.1, 0.1, 0.1]), None);
    file.node(&format!(r#"{{"mesh":{}}}"#, file.mesh(&[cube])));
    let folder = std::env::temp_dir().join(format!("cohabit-gltf-import-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("the cube.bin"), &file.binary).unwrap();
    let read = |uri: &str| import(&file.json_beside(uri), Some(&folder), &options()).map_err(|error| error.to_string());
    let results: Vec<_> = [
        "the%20cube.bin",
        "../the%20cube.bin",
        "%2e%2e/x",
        "/etc/passwd",
        "https://example.org/cube.bin",
        "file:///etc/passwd",
        "no.bin",
    ]
    .map(|uri| (uri, read(uri)))
    .into();
    std::fs::remove_dir_all(folder).unwrap();
    for (uri, result) in results {
        match result {
            Ok(imported) => assert_eq!((uri, imported.triangles), ("the%20cube.bin", 12)),
            Err(error) => assert!(uri != "the%20cube.bin" && error.contains("buffers[0]"), "{uri}: {error}"),
        }
    }
    check(&file.json_beside("the%20cube.bin"), &["buffers[0]", "no folder"]);
}

#[test]
fn numbers_that_are_none_are_refused() {
    for number in [f32::NAN, f32::INFINITY] {
        let mut file = Builder::default();
        let (mut points, triangles) = cube([0.1, 0.1, 0.1]);
        points[3][1] = number;
        let cube = file.primitive(&(points, triangles), None);
        file.node(&format!(r#"{{"mesh":{}}}"#, file.mesh(&[cube])));
        check(&file.glb(), &["accessors[0]", "NaN"]);
    }
    check(&changed(r#""mesh":0"#, r#""mesh":0,"scale":[1e38,1e38,1e38],"translation":[3e38,0,0]"#), &["m large"]);
    check(&changed(r#""mesh":0"#, r#""mesh":0,"scale":[0,0,0]"#), &["0 × 0 × 0 m", "at least 3 mm"]);
    let far = changed(r#""mesh":0"#, r#""mesh":0,"matrix":[1e38,0,0,1e38,0,1,0,0,0,0,1,0,3e38,3e38,3e38,1]"#);
    assert!(!said(&far).is_empty());
    check(&changed(r#""mesh":0"#, r#""mesh":0,"rotation":[1e300,0,0,1]"#), &["no glTF", "out of range"]);
    let mut file = Builder::default();
    let cube = file.primitive(&cube([0.1, 0.1, 0.1]), None);
    file.json_node(&format!(r#"{{"mesh":{},"scale":[3e38,3e38,3e38]}}"#, file.mesh(&[cube])));
    file.node(r#"{"children":[0],"scale":[3e38,3e38,3e38]}"#);
    check(&file.glb(), &["nodes[0]", "NaN"]);
}

#[test]
fn a_node_that_is_its_own_child_is_refused() {
    check(&changed(r#""mesh":0"#, r#""mesh":0,"children":[0]"#), &["nodes[0]", "its own child"]);
    check(&changed(r#""nodes":[0]"#, r#""nodes":[0,0]"#), &["nodes[0]", "twice"]);
    // A long chain is followed without recursion.
    let mut file = Builder::default();
    let cube = file.primitive(&cube([0.1, 0.1, 0.1]), None);
    let mesh = file.mesh(&[cube]);
    for next in 1..50_000 {
        file.json_node(&format!(r#"{{"children":[{next}]}}"#));
    }
    file.json_node(&format!(r#"{{"mesh":{mesh}}}"#));
    file.node(r#"{"children":[0]}"#);
    assert_eq!(read(&file.glb(), &options()).triangles, 12);
}

#[test]
fn files_without_triangles_are_refused() {
    let mut file = Builder::default();
    file.node("{}");
    check(&file.glb(), &["no triangle"]);
    let flat = file.primitive(&(vec![[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]], vec![[0, 1, 2], [0, 0, 1]]), None);
    file.node(&format!(r#"{{"mesh":{}}}"#, file.mesh(&[flat])));
    check(&file.glb(), &["no triangle"]);
    let mut unseen = Builder::default();
    let glass = unseen.material(r#"{"alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0]}}"#);
    let cube = unseen.primitive(&cube([0.1, 0.1, 0.1]), Some(glass));
    unseen.node(&format!(r#"{{"mesh":{}}}"#, unseen.mesh(&[cube])));
    check(&unseen.glb(), &["no triangle"]);
}

#[test]
fn pictures_are_bounded_and_may_be_absent() {
    let with_image = |image: &str, texture: &str| {
        let mut file = Builder::default();
        file.image(image);
        file.texture(texture);
        let material = file.material(r#"{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}"#);
        let cube = file.primitive(&cube([0.1, 0.1, 0.1]), Some(material));
        file.node(&format!(r#"{{"mesh":{}}}"#, file.mesh(&[cube])));
        file.glb()
    };
    let first = r#"{"source":0}"#;
    check(&with_image(r#"{"uri":"../secret.png"}"#, first), &["images[0]", "leads out"]);
    check(&with_image(r#"{"bufferView":99}"#, first), &["bufferViews[99]"]);
    check(&with_image(r#"{"bufferView":0}"#, first), &["images[0]", "neither PNG nor JPEG"]);
    check(&with_image("{}", first), &["images[0]", "no data"]);
    let webp = with_image("{}", r#"{"extensions":{"EXT_texture_webp":{"source":0}}}"#);
    assert!(read(&webp, &options()).left_out[0].contains("neither PNG nor JPEG"));
}

#[test]
fn what_is_asked_for_must_be_possible() {
    let bytes = changed(r#""mesh":0"#, r#""mesh":0"#);
    let check = |options: Options, expected: &str| {
        let error = import(&bytes, None, &options).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    };
    check(Options::new("../Mug"), "`../Mug` is no id");
    check(Options { triangles: 3, ..options() }, "3 triangles");
    check(Options { triangles: 20_001, ..options() }, "20001 triangles");
    check(Options { size: Size::Height(f32::NAN), ..options() }, "no length");
    check(Options { mass_kg: Some(-1.0), ..options() }, "no mass");
    check(Options { name: Some("a\u{1b}b".to_owned()), ..options() }, "no name");
    check(Options { smooth_deg: Some(200.0), ..options() }, "no angle");
}
