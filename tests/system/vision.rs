//! Vision data, and what others read in it.

use cohabit_tests::{Scratch, run};
use serde_json::Value;

use crate::COHABIT;

/// Reads annotations with COCO's own tools, and works out each box and area from its mask.
const READ: &str = r#"
import sys
from pycocotools import mask
from pycocotools.coco import COCO

coco = COCO(sys.argv[1])
annotations = coco.loadAnns(coco.getAnnIds())
assert annotations and len(coco.getCatIds()) == 336
for annotation in annotations:
    image = coco.imgs[annotation["image_id"]]
    pixels, runs = coco.annToMask(annotation), coco.annToRLE(annotation)
    assert pixels.shape == (image["height"], image["width"])
    assert mask.area(runs) == annotation["area"] == pixels.sum(), annotation
    assert list(mask.toBbox(runs)) == annotation["bbox"], annotation
    assert mask.encode(pixels.copy(order="F"))["counts"].decode() == annotation["segmentation"]["counts"]
"#;

/// What `cohabit vision` prints, and its exit code.
fn vision(folder: &str, arguments: &[&str]) -> (String, Option<i32>) {
    let output = run(COHABIT, &[&["vision", "--out", folder], arguments].concat()).unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    (text, output.status.code())
}

#[test]
fn a_set_is_made_gone_on_with_and_summed_up() {
    let scratch = Scratch::new("vision");
    let folder = scratch.path("set");
    let plans = ["--plan", "OfficeLayout1", "OfficeLayout3"];
    let arguments = [&["--images", "2", "--size", "64x48", "--min-pixels", "6"][..], &plans].concat();
    let (text, code) = vision(&folder, &arguments);
    assert!(code == Some(0) && text.contains("660000 images would take"), "{text}");
    let manifest = std::fs::read_to_string(format!("{folder}/manifest.json")).unwrap();
    assert_eq!(serde_json::from_str::<Value>(&manifest).unwrap()["images"], 2);
    let (text, code) = vision(&folder, &arguments);
    assert!(code == Some(0) && text.contains("all of them were there before"), "{text}");
    assert_eq!(std::fs::read_to_string(format!("{folder}/manifest.json")).unwrap(), manifest);
}

#[test]
fn bad_settings_are_said_in_one_message() {
    let scratch = Scratch::new("vision-bad");
    let (folder, file) = (scratch.path("set"), scratch.write("file", ""));
    for (arguments, expected) in [
        (&["--images", "0"][..], "--images 0"),
        (&["--images", "1", "--plan", "OfficeLayout9"], "there is no floor plan `OfficeLayout9`"),
        (&["--images", "1", "--size", "8x8"], "8x8"),
        (&["--images", "1", "--size", "large"], "two numbers with an x"),
        (&["--images", "1", "--near-bits", "40"], "at most 16"),
    ] {
        let (text, code) = vision(&folder, arguments);
        assert!(code == Some(2) && text.contains(expected) && !text.contains("panicked"), "{text}");
    }
    let (text, code) = vision(&file, &["--images", "1"]);
    assert!(code == Some(4) && text.contains(&file), "{text}");
}

#[test]
#[cfg_attr(not(mounts), ignore = "optional: the right to mount a file system (`unshare -rm`)")]
fn a_full_disk_is_said() {
    let scratch = Scratch::new("vision-full");
    let folder = scratch.path("disk");
    std::fs::create_dir(&folder).unwrap();
    let make = format!("{COHABIT} vision --images 60 --size 64x64 --workers 1 --out {folder}/set");
    let script = format!("mount -t tmpfs -o size=256k tmpfs {folder} && exec {make}");
    let output = run("unshare", &["-rm", "sh", "-c", &script]).unwrap();
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(4) && text.contains("the disk is full"), "{text}");
}

#[test]
#[cfg_attr(not(pycocotools), ignore = "optional: pycocotools")]
fn pycocotools_reads_the_annotations() {
    let scratch = Scratch::new("vision-coco");
    let folder = scratch.path("set");
    let (text, code) = vision(&folder, &["--images", "8", "--size", "128x96"]);
    assert_eq!(code, Some(0), "{text}");
    let output = run("python3", &["-c", READ, &format!("{folder}/annotations.json")]).unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}
