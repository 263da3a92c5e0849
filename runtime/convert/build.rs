//! Tells the tests of this crate what of their needs is there.

#[path = "../../tests/needs.rs"]
mod needs;

fn main() {
    needs::tell(&[needs::PYTHON, needs::LEROBOT]);
}
