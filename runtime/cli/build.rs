//! Tells the tests of this crate what of their needs is there.

#[path = "../../tests/needs.rs"]
mod needs;

fn main() {
    needs::tell(&[
        needs::REFERENCE_DATA,
        needs::BROWSER,
        needs::PYTHON,
        needs::VOICE,
        needs::MOUNTS,
        needs::FAST_DOWNWARD,
        needs::PYCOCOTOOLS,
    ]);
}
